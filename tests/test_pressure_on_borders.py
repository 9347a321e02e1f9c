"""Contact pressures on the outline of an area: it belongs to the area, whichever element is looked in."""

import numpy as np
import pytest
from models import rectangular

from signorini import Model, solve

TURN = np.radians(np.arange(0, 360, 30))
ROUND = (2 + 0.9 * np.column_stack([np.cos(TURN), np.sin(TURN)])).tolist()
OUTLINES = {
    "rectangle": (
        {"rectangle": [1.1, 1.1, 2.9, 2.9]},
        [[1.1, 2], [2.9, 2], [2, 1.1], [2, 2.9], [1.1, 1.1], [2.9, 2.9]],
    ),
    "circle": ({"circle": {"center": [2, 2], "radius": 0.9}}, ROUND),
    "polygon": (
        {"polygon": [[2, 1], [3, 2], [2, 3], [1, 2]]},
        [[2, 1], [2.5, 1.5], [2.5, 2.5], [1.5, 2.5], [1.5, 1.5]],
    ),
}


@pytest.mark.parametrize("mesh", [{"divisions": [8, 8]}, {"size": 0.5}])
@pytest.mark.parametrize("bed", [{"resists": "both", "stiffness": 1e7}, {"resists": "down"}])
@pytest.mark.parametrize("name", OUTLINES)
def test_points_on_the_outline_of_a_bed_have_its_pressure(name, bed, mesh):
    area, on = OUTLINES[name]
    model = rectangular(
        thickness=0.3,
        mesh={**mesh, "error": False},
        support=[{"area": area, **bed}, {"at": [[0, 0], [4, 0], [4, 4], [0, 4]]}],
        load=[{"pressure": 1e3}],
        probe=[{"at": [*on, [0.5, 0.5]]}],
        profile=[{"name": "across", "line": [on[0], on[1]], "stations": 2}],
    )
    result = solve(model)["all"]
    pressures = [probe.pressure for probe in result.probes]
    assert None not in pressures[:-1]
    assert pressures[-1] is None
    np.testing.assert_array_equal(result.pressure(on), pressures[:-1])
    np.testing.assert_array_equal(result.profiles["across"].values["pressure"], pressures[:2])
    if "stiffness" in bed:
        np.testing.assert_allclose(pressures[:-1], [1e7 * one.deflection for one in result.probes[:-1]], rtol=1e-9)


def test_points_on_the_outline_of_the_upper_plate_have_its_pressure_on_the_lower():
    shape = {"shape": "rectangle", "thickness": 0.1}
    on = [[1.1, 2], [2.9, 2], [2, 1.1], [2, 2.9]]
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plates={
            "p": {**shape, "origin": [1.1, 1.1], "size": [1.8, 1.8]},
            "z": {**shape, "size": [4, 4]},
        },
        mesh={"divisions": [8, 8], "error": False},
        contact=[{"between": ["p", "z"], "area": "all", "stiffness": 1e8}],
        support=[{"plate": "z", "edge": ["left", "right", "top", "bottom"], "fix": "simple"}],
        load=[{"plate": "p", "pressure": 1e3}],
        probe=[{"plate": "p", "at": on}],
    )
    result = solve(model)["all"]
    assert None not in [probe.pressure for probe in result.probes]
    assert all(pressure is not None and np.isfinite(pressure) for pressure in result.plates["p"].pressure(on))
