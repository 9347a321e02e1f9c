"""Areas with holes: the load is that on the whole less that on the holes."""

import math

import numpy as np
import pytest
from models import rectangular

from signorini import InputError, Model, solve
from signorini.analysis.check import check
from signorini.discretise import discretise

FEET = {"name": "feet", "at": [[0.5, 0.5], [3.5, 0.5], [3.5, 3.5], [0.5, 3.5]], "resists": "both"}
ROUND = {"circle": {"center": [2, 2.1], "radius": 0.7}}
OUTER = {"circle": {"center": [2, 2.1], "radius": 1.3}}
RING = {"annulus": {"center": [2, 2.1], "inner": 0.7, "outer": 1.3}}
SMALL = {"circle": {"center": [2, 3.1], "radius": 0.2}}
BOX = {"rectangle": [1.7, 1.7, 2.2, 2.4]}
PANEL = {"rectangle": [0.8, 0.9, 3.4, 3.2]}
ARCHED = {"polygon": [[1.2, 1.2], [2.6, 1.2], {"through": [1.9, 1.9], "to": [1.2, 1.2]}]}


def model(**changes: object) -> Model:
    data = {"support": [FEET], "load": [{"pressure": 5}], "mesh": {"divisions": [9, 8], "error": False}}
    return rectangular(**data | changes)


@pytest.mark.parametrize(
    ("hollow", "whole", "holes"),
    [
        (RING, OUTER, [ROUND]),
        ({**PANEL, "holes": [ROUND]}, PANEL, [ROUND]),
        ({**OUTER, "holes": [BOX]}, OUTER, [BOX]),
        ({**RING, "holes": [SMALL]}, RING, [SMALL]),
    ],
)
def test_loads_and_beds_of_the_parts_add_up(hollow: dict, whole: dict, holes: list[dict]) -> None:
    def pressed(*areas: dict) -> Model:
        load = [{"pressure": 5, "area": area} for area in areas]
        # The mesh follows all outlines; here it is the same for both.
        return model(load=[*load, *({"pressure": 0, "area": area} for area in (whole, *holes))])

    parts, one = (solve(pressed(*areas))["all"] for areas in ((hollow, *holes), (whole,)))
    assert parts.deflection == pytest.approx(one.deflection, rel=1e-9, abs=1e-12 * np.abs(one.deflection).max())

    def bedded(*areas: dict) -> Model:
        beds = [{"name": f"bed {i}", "area": area, "stiffness": 4e3, "resists": "both"} for i, area in enumerate(areas)]
        return model(
            support=[FEET, *beds], load=[{"pressure": 5}, *({"pressure": 0, "area": area} for area in (whole, *holes))]
        )

    parts, one = (solve(bedded(*areas))["all"] for areas in ((hollow, *holes), (whole,)))
    assert parts.deflection == pytest.approx(one.deflection, rel=1e-8, abs=1e-10 * np.abs(one.deflection).max())


def test_a_ring_of_pressure_has_the_area_of_a_ring() -> None:
    found = discretise(model(load=[{"pressure": 5, "area": RING}]))
    load = found.load(found.model.effective_combinations[0]).nodal[::3].sum()
    assert load == pytest.approx(5 * math.pi * (1.3**2 - 0.7**2), rel=1e-10)


@pytest.mark.parametrize("sector", [90, 180, 360])
def test_a_ring_about_the_centre_of_a_sector(sector: int) -> None:
    plate = {"shape": "disc", "radius": 2, "thickness": 0.2, "sector": sector}
    area = {"annulus": {"inner": 0.5, "outer": 1.5}}
    held = [{"edge": ["rim"], "fix": "clamped"}]
    tables = {"material": {"E": 30e6, "nu": 0.2}, "plate": plate, "mesh": {"size": 0.4}, "support": held}
    found = discretise(Model(**tables, load=[{"pressure": 5, "area": area}]))
    load = found.load(found.model.effective_combinations[0]).nodal[::3].sum()
    assert load == pytest.approx(5 * math.pi * (1.5**2 - 0.5**2) * sector / 360, rel=1e-3)


@pytest.mark.parametrize("area", [RING, {**PANEL, "holes": [ROUND]}, {**PANEL, "holes": [ARCHED]}])
@pytest.mark.parametrize("stiffness", [None, 1e4])
def test_a_slab_stands_on_an_area_with_a_hole(area: dict, stiffness: float | None) -> None:
    soil = {"name": "soil", "area": area, "resists": "down"} | ({"stiffness": stiffness} if stiffness else {})
    given = model(support=[soil], load=[{"pressure": 5}])
    result = solve(given)["all"]
    assert result.certificate.passed
    assert result.reactions["soil"] == pytest.approx(80, rel=1e-9)
    hole = discretise(model(support=[soil])).model.support[0].area.region
    assert 0 < result.supports[0].contact_area <= hole.area * (1 + 1e-9)
    assert check(given).resultants[0].message == ""


def test_a_zone_with_a_hole_is_thick_around_it_alone() -> None:
    zone = {"area": {**PANEL, "holes": [ROUND]}, "thickness": 0.5}
    found = discretise(model(zone=[zone], mesh={"size": 0.4, "error": False}))
    area = found.mesh.element_area[found.zones.inside[0]].sum()
    assert area == pytest.approx(2.6 * 2.3 - math.pi * 0.7**2, rel=2e-3)


@pytest.mark.parametrize(
    ("area", "said"),
    [
        ({"annulus": {"inner": 2, "outer": 1}}, "must be less than outer"),
        ({**RING, **ROUND}, "exactly one of rectangle, circle, polygon, annulus"),
        ({**PANEL, "holes": [{"circle": {"center": [3.2, 2], "radius": 0.5}}]}, "Hole 1 reaches out of the area"),
        ({**PANEL, "holes": [ROUND, {"circle": {"center": [2.2, 2], "radius": 0.5}}]}, "Holes 1 and 2 overlap"),
        ({"holes": [ROUND]}, "exactly one of"),
        ({**PANEL, "holes": [{**ROUND, "holes": []}]}, "holes"),
    ],
)
def test_what_holes_cannot_be(area: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        model(load=[{"pressure": 5, "area": area}])
