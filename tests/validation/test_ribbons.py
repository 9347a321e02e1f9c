"""Long narrow plates on a few elements: beams, whose bending is almost lost beside shear in double precision."""

from dataclasses import replace

import pytest
from models import rectangular

import signorini
from signorini import Model
from signorini.contact.certificate import CERTIFIABLE, Certificate
from signorini.errors import NotCertifiedError


def ribbon(width: float, thickness: float, divisions: list[int], support: dict, element: str = "mitc9") -> float:
    """Deflection in the middle over that of the beam; length 1000, pressure 1, no lateral contraction."""
    model = Model(
        material={"E": 1e9, "nu": 0.0},
        plate={"shape": "rectangle", "size": [1000, width], "thickness": thickness, "element": element},
        mesh={"divisions": divisions},
        support=[{"edge": ["left", "right"], **support}],
        load=[{"pressure": 1.0}],
        probe=[{"at": [500, width / 2]}],
    )
    result = signorini.solve(model)["all"]
    assert result.certificate.passed and not result.certificate.limited
    shear = 1000**2 / (8 * 5 / 6 * 1e9 * thickness / 2)
    return result.probes[0].deflection / (5 * 1000**4 / (384 * 1e9 * thickness**3 / 12) + shear)


@pytest.mark.parametrize("support", [{"fix": "simple"}, {"resists": "down"}], ids=["held", "one-sided"])
@pytest.mark.parametrize("thickness", [1.0, 1e-3])
@pytest.mark.parametrize("width", [1000.0, 30.0, 1.0])
def test_a_ribbon_is_a_beam_however_thin_and_narrow(width, thickness, support) -> None:
    assert ribbon(width, thickness, [4, 4], support) == pytest.approx(1.0, rel=5e-3)


def test_shear_of_a_thin_ribbon_is_not_lost_either() -> None:
    """A stiff prop in the middle carries five eighths of the load, whatever the thickness."""
    reactions = []
    for thickness in (1.0, 1e-2):
        model = rectangular(
            material={"E": 1e9, "nu": 0.0},
            size=[1000, 2],
            thickness=thickness,
            divisions=[8, 2],
            support=[
                {"name": "ends", "edge": ["left", "right"], "fix": "simple"},
                {"name": "prop", "line": [[500, 0], [500, 2]], "resists": "down"},
            ],
            load=[{"pressure": 1.0}],
        )
        reactions.append(signorini.solve(model)["all"].reactions["prop"])
    assert reactions == pytest.approx([1250.0, 1250.0], rel=1e-3)


def test_a_thin_plate_of_q8r_is_refused_and_told_to_take_the_other_element() -> None:
    with pytest.raises(NotCertifiedError, match='"mitc9"'):
        ribbon(1000.0, 1e-3, [4, 4], {"fix": "simple"}, "q8r")


def test_a_limit_beyond_the_certifiable_excuses_nothing() -> None:
    limited = Certificate(0.0, 0.0, 0.0, 1e-5, 1e-7, 1e-4, 1e-4, 1e-6, CERTIFIABLE)
    assert limited.passed and limited.limited
    excused = replace(limited, equilibrium=3.6e1, equilibrium_limit=2e2, rounding=2e2)
    assert not excused.passed and not excused.limited
    assert "arithmetic limits" in str(excused)
