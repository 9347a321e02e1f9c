"""Random plates that once ended without an answer: rounding decided between supports nearly alike, or was all."""

from random import Random

import pytest
import random_models

from signorini import solve, validate

# What made each hard, as far as one word says it.
SEEDS = {
    "crowded clamps in one element": 30239,
    "lines and points of an element's edge": 32971,
    "a rigid area and its own edge, barely balanced": 301861,
    "a gap without load": 35476,
    "held by slopes and points": 304988,
    "idle pads under a curvature": 818,
    "an idle bed under a curvature": 33262,
    "free but for one point": 309812,
    "many rows on few nodes": 34542,
    "thin and floating": 36648,
    "thin and tilting": 21280,
    "opposed lines": 200341,
}


@pytest.mark.parametrize("seed", SEEDS.values(), ids=SEEDS)
def test_plates_that_rounding_made_hard_are_certified(seed: int) -> None:
    results = solve(validate(random_models.model(Random(seed))))
    assert results and all(result.status == "solved" and result.certificate.passed for result in results.values())
