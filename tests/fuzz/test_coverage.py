"""Half-widths cover the change under refinement: a sample of benchmarks/half_widths.py."""

import half_width_coverage


def test_half_widths_cover_numbers_of_random_plates() -> None:
    found = [number for seed in (2001, 2003, 2004, 2007, 2009) for number in half_width_coverage.judged(seed, 10, 18)]
    assert len(found) > 200
    assert sum(number.covered for number in found) >= 0.97 * len(found)
