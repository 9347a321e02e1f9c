"""Random stacks of two plates with holes, a contact and a bolt: both plates read the same contact, in balance."""

from __future__ import annotations

from typing import Any

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import signorini

LOWER, UPPER = (0.0, 0.0, 4.0, 3.0), (0.4, 0.3, 3.6, 2.7)
BOLT = (1.9, 1.6)


def disc(x: float, y: float, radius: float) -> tuple[dict[str, Any], shapely.Polygon]:
    """Return a circle as a table of the input and as a polygon."""
    return {"circle": {"center": [x, y], "radius": radius}}, shapely.Point(x, y).buffer(radius, quad_segs=200)


def rectangle(x: float, y: float, a: float, b: float) -> tuple[dict[str, Any], shapely.Polygon]:
    """Return a rectangle with its middle at (x, y) as a table of the input and as a polygon."""
    box = x - 0.5 * a, y - 0.5 * b, x + 0.5 * a, y + 0.5 * b
    return {"rectangle": list(box)}, shapely.box(*box)


PLACES = st.floats(1.3, 2.7), st.floats(1.0, 2.0)
HOLES = st.one_of(
    st.builds(disc, *PLACES, st.floats(0.03, 0.3)),
    st.builds(rectangle, *PLACES, st.floats(0.1, 0.5), st.floats(0.1, 0.5)),
    st.just(disc(*BOLT, 0.05)),
)
AREAS = st.one_of(
    st.just(("all", shapely.box(*UPPER))),
    st.builds(disc, st.just(2.0), st.just(1.5), st.floats(0.8, 1.1)),
    st.builds(rectangle, st.just(2.0), st.just(1.5), st.floats(1.5, 3.0), st.floats(1.5, 2.2)),
)


@settings(max_examples=15)
@given(st.none() | HOLES, st.none() | HOLES, AREAS, st.sampled_from([0.35, 0.5]), st.booleans())
def test_both_plates_read_the_contact_in_balance(below: Any, above: Any, area: Any, size: float, bolted: bool) -> None:
    where, shared = area
    plates = {}
    for name, (x0, y0, x1, y1), hole in (("lower", LOWER, below), ("upper", UPPER, above)):
        plate = {"shape": "rectangle", "size": [x1 - x0, y1 - y0], "origin": [x0, y0], "thickness": 0.2}
        plates[name] = plate | ({"holes": [hole[0]]} if hole else {})
        shared = shared - hole[1] if hole else shared
    between = {"between": ["upper", "lower"]}
    bolt = {"name": "bolt", **between, "at": BOLT, "radius": 0.5, "resists": "up", "stiffness": 1e4, "preload": 5}
    tables = {
        "material": {"E": 3e7, "nu": 0.2, "unit_weight": 25},
        "mesh": {"size": size},
        "plates": plates,
        "contact": [{"name": "layer", **between, "area": where, "stiffness": 1e5}],
        "support": [
            {"name": "soil", "plate": "lower", "area": "all", "resists": "down", "stiffness": 2e4},
            *([bolt] if bolted else []),
        ],
        "load": [{"plate": name, "self_weight": True} for name in plates],
    }
    try:
        result = signorini.solve(signorini.Model(**tables))["all"]
    except signorini.InputError as error:
        assert "middle" in str(error) or "separate areas" in str(error), error  # washer over a hole beside the bolt
        return
    weights = [
        5 * (shapely.box(*box).area - (hole[1].area if hole else 0.0)) for box, hole in ((LOWER, below), (UPPER, above))
    ]
    pull = result.supports["bolt"].reaction if bolted else 0.0
    assert result.reactions["soil"] == pytest.approx(sum(weights), rel=1e-4)
    assert result.reactions["layer"] + pull == pytest.approx(weights[1], rel=1e-4)
    for plate in result.plates.values():
        (layer,) = (one for one in plate.supports if one.name == "layer")
        assert layer.weights.sum() == pytest.approx(shared.area, rel=2e-4)
