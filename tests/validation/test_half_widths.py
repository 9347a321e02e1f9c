"""Half-widths cover the differences from known answers, number by number: every case of benchmarks/references.py."""

from functools import cache

import numpy as np
import pytest
import references

CASES = {case.title: case for case in references.cases()}


@cache
def rows(title: str) -> list[references.Row]:
    return references.rows(CASES[title], 1)


@pytest.mark.parametrize("title", CASES)
def test_a_reference_is_within_its_half_width(title: str) -> None:
    for row in rows(title):
        assert row.width is not None, row
        assert row.covered, row


def test_half_widths_are_narrow() -> None:
    of = [row for title in CASES for row in rows(title) if row.number.reference and "total" not in row.number.name]
    parts = [row.width / abs(row.number.reference) for row in of if row.width is not None]
    assert np.median(parts) < 0.005
    assert np.quantile(parts, 0.9) < 0.05
