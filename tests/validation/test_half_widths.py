"""Half-widths cover the differences from known answers: series, closed forms, and converged digits."""

from typing import Any

import pytest

from signorini import Model, Result, solve

EDGES = ["left", "right", "bottom", "top"]


def square(h: float, divisions: int, support: dict[str, Any]) -> Result:
    """A unit square under q = 1 with D = 1."""
    model = Model(
        material={"E": 12 * 0.91 / h**3, "nu": 0.3},
        plate={"shape": "rectangle", "size": [1, 1], "thickness": h},
        mesh={"divisions": [divisions, divisions]},
        support=[{"name": "edges", "edge": EDGES} | support],
        load=[{"pressure": 1.0}],
        probe=[{"at": [[0.5, 0.5], [0.0, 0.5], [0.0, 0.0]]}],
    )
    return solve(model)["all"]


def covered(value: float, width: float | None, reference: float, last_digit: float) -> None:
    assert width is not None
    assert abs(value - reference) <= width + last_digit
    assert width <= 0.2 * abs(reference)


@pytest.mark.parametrize("divisions", [10, 20, 36])
@pytest.mark.parametrize(
    ("h", "support", "deflection", "digit"),
    [
        (0.1, {"fix": "hard"}, 0.00427284, 5e-9),
        (0.01, {"fix": "hard"}, 0.00406446, 5e-9),
        (0.1, {"fix": "simple"}, 0.00461691, 5e-9),
        (0.1, {"fix": "clamped"}, 0.00150463, 5e-9),
        (0.1, {"resists": "down"}, 0.004805, 5e-7),
    ],
)
def test_centre_of_a_square(h: float, support: dict[str, Any], deflection: float, digit: float, divisions: int) -> None:
    found = square(h, divisions, support)
    assert found.plus_minus is not None
    covered(found.probes[0].deflection, found.plus_minus["probes"][0]["deflection"], deflection, digit)


@pytest.mark.parametrize("divisions", [12, 24])
def test_moments_and_uplift_of_a_square(divisions: int) -> None:
    lifting, clamped = square(0.1, divisions, {"resists": "down"}), square(0.1, divisions, {"fix": "clamped"})
    for found, probe, kind, reference, digit in (
        (lifting, 0, "moment", 0.05275, 5e-6),
        (clamped, 1, "moment", -0.04937, 5e-6),
    ):
        assert found.plus_minus is not None
        value, width = found.probes[probe].moment[0], found.plus_minus["probes"][probe][kind][0]
        covered(value, width, reference, digit)
    assert lifting.plus_minus is not None
    width = lifting.plus_minus["probes"][2]["deflection"]
    assert abs(lifting.probes[2].deflection + 6.62e-4) <= width + 5e-7


@pytest.mark.parametrize("divisions", [20, 40])
def test_a_slab_on_soil_without_tension(divisions: int) -> None:
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        mesh={"divisions": [divisions, divisions]},
        support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 30e6}],
        load=[{"pressure": 2e3}, {"pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}}],
    )
    found = solve(model)["all"]
    assert found.plus_minus is not None
    soil, widths = found.supports[0], found.plus_minus["supports"][0]
    covered(found.deflection.max(), found.plus_minus["deflection"]["max"], 4.229e-3, 5e-7)
    assert soil.contact_area is not None
    covered(soil.contact_area, widths["contact_area"], 91.6, 0.1)
    assert soil.max_pressure is not None
    covered(soil.max_pressure, widths["max_pressure"], 126.86e3, 5.0)


@pytest.mark.parametrize(("fix", "reference"), [("simple", 703.425), ("clamped", 178.425)])
def test_a_round_plate(fix: str, reference: float) -> None:
    """SSLS101 and SSLS100 of Code_Aster."""
    model = Model(
        material={"E": 1.0, "nu": 0.3},
        plate={"shape": "disc", "radius": 1, "thickness": 0.1},
        mesh={"divisions": [10, 32]},
        support=[{"edge": "rim", "fix": fix}],
        load=[{"pressure": 1.0}],
    )
    found = solve(model)["all"]
    assert found.plus_minus is not None
    covered(found.deflection.max(), found.plus_minus["deflection"]["max"], reference, 5e-4)
