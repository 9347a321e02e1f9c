"""Cases of design codes: punching of a slab on one column, with given column force and moments; reinforcement."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from signorini.design.aci318 import shear_part
from signorini.design.en1992_punching import moment_part
from signorini.validation.case import Case, Number, Tables

_SAFE = "Computers and Structures, *SAFE Software Verification*, example"
_SLAB = "The model is a slab on one column under two forces outside the control perimeter with the example's resultant."


def _slab(
    n: int,
    units: tuple[str, str],
    side: float,
    column: tuple[float, float],
    force: float,
    at: tuple[float, float],
    check: Mapping[str, Any],
) -> Tables:
    """Input of a square slab around a column at the origin; the resultant of its loads is a force at ``at``."""
    x, y = at
    length, of_force = units
    return {
        "units": {"length": length, "force": of_force},
        "material": {"E": 30e3, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [side, side], "origin": [-side / 2, -side / 2], "thickness": side / 16},
        "mesh": {"divisions": [n, n]},
        "support": [
            {"name": "column", "at": [0, 0], "patch": column, "resists": "both", "rotational_stiffness": 1e6 * side**3}
        ],
        "load": [{"force": force / 2, "at": [[x - 0.4 * side, y], [x + 0.4 * side, y]]}],
        "punching": [{"support": "column", **check}],
    }


def _case(
    name: str,
    title: str,
    problem: str,
    source: str,
    numbers: Sequence[Number],
    remark: str,
    *slab: Any,
) -> Case:
    return Case(
        f"punching-{name}",
        title,
        ("punching", "footprints"),
        problem,
        source,
        "analytical",
        lambda n: _slab(n, *slab),
        (4, 8, 16),
        tuple(numbers),
        f"{_SLAB} {remark}".rstrip(),
    )


def cases() -> Iterator[Case]:
    """Yield the validation cases of this module."""
    yield from _punching()
    yield from _reinforcement()


def _punching() -> Iterator[Case]:
    of, newton = "punching:column[1]", ("mm", "N")
    yield _case(
        "concrete-centre",
        "Punching of an inner column (The Concrete Centre)",
        "Column 400 mm × 400 mm, d = 260 mm, VEd = 1204.8 kN, β = 1.15, C30/37.",
        "The Concrete Centre, *How to Design Concrete Structures using Eurocode 2*, flat slabs; EN 1992-1-1, 6.4.3.",
        (
            Number(f"{of}.u1", "u1 [mm]", 4867.0, 2e-4, uncertainty=0.5),
            Number(f"{of}.v_ed", "vEd at u1 [MPa]", 1.09, 5e-3, uncertainty=5e-3),
            Number(f"{of}.v_ed_face", "vEd at u0 [MPa]", 3.33, 2e-3, uncertainty=5e-3),
        ),
        "",
        newton,
        4000.0,
        (400.0, 400.0),
        1204.8e3,
        (0.0, 0.0),
        {"code": "EN 1992-1-1:2004", "d": [260, 260], "rho": [0.0085, 0.0048], "fck": 30, "fyk": 500, "beta": 1.15},
    )
    force, moments = 1112.197e3, (20.576e6, 41.593e6)
    at = moments[0] / moment_part(1 / 3) / force, moments[1] / moment_part(3.0) / force
    yield _case(
        "safe-eurocode",
        "Punching of an inner column with moments about both axes (SAFE, EN 1992)",
        "Column 300 mm × 900 mm, d = 218 mm, C30/37, VEd = 1112.197 kN, k MEd = 20.576 kNm along the short and 41.593 "
        "kNm along the long side, with k of Table 6.1.",
        f"{_SAFE} EUROCODE 2-04 RC-PN-001, hand calculation for column B-2; EN 1992-1-1, 6.4.3.",
        (
            Number(f"{of}.u1", "u1 [mm]", 5139.468, 1e-6, uncertainty=1e-3),
            Number(f"{of}.v_ed", "vEd at u1 [MPa]", 1.099, 5e-4, uncertainty=5e-4),
        ),
        "vRd,c = 0.578 MPa of the example is not compared, since the ratio of its reinforcement is not stated.",
        newton,
        4000.0,
        (300.0, 900.0),
        force,
        at,
        {"code": "EN 1992-1-1:2004", "d": [212, 224], "rho": [0.005, 0.005], "fck": 30, "fyk": 500},
    )
    kips, inch = 189.45, (91.538, 156.39)
    at = inch[0] / shear_part(20.5, 44.5) / kips, inch[1] / shear_part(44.5, 20.5) / kips
    yield _case(
        "safe-aci",
        "Punching of an inner column with moments about both axes (SAFE, ACI 318)",
        "Column 12 in × 36 in, d = 8.5 in, f'c = 4000 psi, Vu = 189.45 kip, γv Mu = 91.538 kip in along the short and "
        "156.39 kip in along the long side.",
        f"{_SAFE} ACI 318-08 RC-PN-001 (also 318-14), hand calculation for column B-2; ACI 318, 8.4.4.2 and 22.6.5.2.",
        (
            Number(f"{of}.u1", "bo [in]", 130.0, 1e-9),
            Number(f"{of}.v_ed", "vu [ksi]", 0.1930, 5e-4, uncertainty=5e-5),
            Number(f"{of}.v_rd_c", "φ vc [ksi]", 0.158, 3e-2, uncertainty=0.158 * (0.17 / 0.16609 - 1) + 5e-4),
        ),
        "The program computes in SI units, ACI 318M. Its factor 0.17 √MPa of vc is 2.4 % larger than the example's "
        "2 √psi = 0.16609 √MPa.",
        ("in", "kip"),
        160.0,
        (12.0, 36.0),
        kips,
        at,
        {"code": "ACI 318-19", "d": [9, 8], "fck": 4.0, "fyk": 60.0},
    )


def _reinforcement() -> Iterator[Case]:
    """Yield cases of required reinforcement: a one-way slab with the moment pL²/8."""
    for name, annex, alpha, printed in (
        ("cen", "recommended values", 1.0, 5.400),
        ("annex", "αcc = 0.85 of national annexes", 0.85, 5.446),
    ):
        check = {"code": "EN 1992-1-1:2004", "fck": 30, "fyk": 460, "alpha_cc": alpha}

        def tables(n: int, check: Mapping[str, Any] = check) -> Tables:
            return {
                "units": {"length": "mm", "force": "N"},
                "material": {"E": 25e3, "nu": 0.0},
                "plate": {"shape": "rectangle", "size": [4000, 1000], "thickness": 150},
                "mesh": {"divisions": [4 * n, n]},
                "support": [{"edge": ["left", "right"], "fix": "simple"}],
                "load": [{"pressure": 12.9e-3}],
                "reinforcement": {**check, "d_top": [25, 25], "d_bottom": [25, 25]},
                "probe": [{"at": [[2000, 500], [200, 500]]}],
            }

        yield Case(
            f"reinforcement-safe-{name}",
            f"Required reinforcement of a one-way slab (SAFE, EN 1992), {annex}",
            ("reinforcement", "rectangle", "uniform pressure"),
            "Simply supported slab of 4 m, h = 150 mm, d = 125 mm, C30/37, fyk = 460 MPa, under 1.35 · 4 + 1.5 · 5 = "
            f"12.9 kPa; {annex}.",
            f"{_SAFE} EN 2-2004 RC-SL-001; EN 1992-1-1, 3.1.7, 6.1 and 9.2.1.1.",
            "analytical",
            tables,
            (2, 4, 8),
            (
                Number("probe[1].mx", "mx, middle [kN]", 25.8, 2e-3, 1e-3),
                Number("probe[1].as_x_bottom", "As, middle [cm²/m]", printed, 3e-3, 10.0, uncertainty=0.009),
                Number(
                    "probe[2].as_x_bottom",
                    "As,min, 0.2 m from the support [mm²/m]",
                    204.642,
                    1e-5,
                    1e3,
                    uncertainty=5e-4,
                ),
            ),
            "The printed areas are for a design moment of 25.8347 kNm in place of 25.8 kNm, which is 0.14 % more.",
        )
