"""Random plates that once ended without an answer: rounding decided between supports nearly alike, or was all."""

import json
from pathlib import Path

import pytest

from signorini import solve, validate

PLATES = sorted((Path(__file__).parent / "hard_plates").glob("*.json"))


@pytest.mark.parametrize("path", PLATES, ids=lambda path: path.stem)
def test_plates_that_rounding_made_hard_are_certified(path: Path) -> None:
    results = solve(validate(json.loads(path.read_text())))
    solved = [result for result in results.values() if result.status == "solved"]
    assert solved and all(result.certificate.passed for result in solved)
