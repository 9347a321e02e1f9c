"""Square plates under uniform pressure on hard, simple, clamped and one-sided edges, at several thicknesses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from signorini.validation.case import Case, Number, Tables
from signorini.validation.theory import TIMOSHENKO, Navier, rigidity, shear_factor, uniform

_NU = 0.3
_EDGES = ["left", "right", "bottom", "top"]
_SPECTRAL = (
    "High-order spectral solution of the Reissner–Mindlin plate with κ = 5/6; all printed digits have converged."
)
_CORNER = 0.0649646
"""Corner force R/qa² of the thin plate; Timoshenko and Woinowsky-Krieger (1959), art. 30."""


def _model(held: Mapping[str, Any], thickness: float) -> Callable[[int], Tables]:
    """Unit square with D = 1 and q = 1; probes in the middle, in the middle of a side and in a corner."""
    return lambda n: {
        "material": {"E": 1 / rigidity(1.0, thickness, _NU), "nu": _NU},
        "plate": {"shape": "rectangle", "size": [1, 1], "thickness": thickness},
        "mesh": {"divisions": [n, n]},
        "support": [{"name": "edges", "edge": _EDGES, **held}],
        "load": [{"pressure": 1.0}],
        "probe": [{"at": [[0.5, 0.5], [0.0, 0.5], [0.0, 0.0]]}],
    }


def _case(edges: str, held: Mapping[str, Any], h: float, numbers: list[Number], source: str, remark: str = "") -> Case:
    analytical = edges == "hard"
    return Case(
        f"square-{edges}-{1 / h:.0f}",
        f"Square on {edges} edges, h/a = {h:g}",
        ("uniform pressure", {"one-sided": "one-sided edges"}.get(edges, f"{edges} edges"), "rectangle"),
        f"Square plate of side a = 1 and thickness {h:g} with D = 1, ν = 0.3, under uniform pressure q = 1. All edges: "
        f'`{next(iter(held))} = "{next(iter(held.values()))}"`.',
        source,
        "analytical" if analytical else "numerical",
        _model(held, h),
        (8, 16, 32),
        tuple(numbers),
        remark,
    )


def cases() -> Iterator[Case]:
    """Yield the validation cases of this module."""
    deflection, moment, edge, corner = ("probe[1].deflection", "probe[1].mx", "probe[2].mx", "probe[3].deflection")
    for h in (1e-4, 0.01, 0.1, 0.2):
        w, m, _ = Navier(1, 1, _NU, uniform, shear_factor(h, _NU)).at(0.5, 0.5)
        yield _case(
            "hard",
            {"fix": "hard"},
            h,
            [
                Number(deflection, "w D/qa⁴, middle", w, 1e-3),
                Number(moment, "mx/qa², middle", m, 1e-2),
                Number("probe[3].mxy", "corner force 2 mxy/qa²", _CORNER, 2e-2, factor=-2, uncertainty=5e-8),
            ],
            "Double sine series of Navier with the shear strain of Mindlin (1951, J. Appl. Mech. 18, 31–38); corner "
            f"force: {TIMOSHENKO}, art. 30.",
            "On hard edges moments do not depend on the thickness, so that all thicknesses have the same corner force.",
        )
    for h, w in ((0.001, 0.00406585), (0.01, 0.00409930), (0.1, 0.00461691), (0.2, 0.00554504)):
        yield _case(
            "soft",
            {"fix": "simple"},
            h,
            [Number(deflection, "w D/qa⁴, middle", w, 3e-3, uncertainty=5e-9)],
            _SPECTRAL,
            "Soft edges have a boundary layer as wide as the thickness, so that thin plates converge from the hard "
            "plate's 0.00406 towards the reference only when elements are as small as the layer.",
        )
    for h, w, m in (
        (0.001, 0.00126534, 0.05133),
        (0.01, 0.00126786, 0.05131),
        (0.1, 0.00150463, 0.04937),
        (0.2, 0.00217216, 0.04625),
    ):
        yield _case(
            "clamped",
            {"fix": "clamped"},
            h,
            [
                Number(deflection, "w D/qa⁴, middle", w, 3e-3, uncertainty=5e-9),
                Number(edge, "edge moment −mx/qa²", m, 3e-3, factor=-1, uncertainty=5e-6),
            ],
            f"{_SPECTRAL} Thin plate, Timoshenko and Woinowsky-Krieger (1959): w = 0.00126 qa⁴/D, m = 0.0513 qa².",
        )
    for h, w, m, up in ((0.1, 0.004805, 0.05275, 6.62e-4), (0.01, 0.004402, 0.05103, 7.43e-4)):
        yield _case(
            "one-sided",
            {"resists": "down"},
            h,
            [
                Number(deflection, "w D/qa⁴, middle", w, 5e-3, uncertainty=5e-7),
                Number(moment, "mx/qa², middle", m, 5e-3, uncertainty=5e-6),
                Number(corner, "corner uplift −w D/qa⁴", up, 2e-2, factor=-1, uncertainty=5e-7),
                Number("edges.reaction", "reaction/qa²", 1.0, 1e-9, uncertainty=1e-9),
            ],
            _SPECTRAL,
            "Edges only push up, and the corners lift. Keer and Mak (1981) and Dempster (1988) treat the thin plate.",
        )
