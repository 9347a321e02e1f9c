"""Strips in torsion: Saint-Venant's stiffness, and the twisted plate of SSLS27."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt, tanh

from signorini.validation.case import Case, Number, Tables
from signorini.validation.theory import KAPPA

_NU = 0.25


def cases() -> Iterator[Case]:
    """Yield the validation cases of this module."""
    for ratio, printed in ((5, 0.291), (10, 0.312)):
        yield _strip(ratio, printed)
    w = "probe[1].deflection"
    yield _ssls27(
        "bending",
        (1.0, 1.0),
        0.5,
        Number(w, "w of the end [m]", 1.1059e-3, 1.2e-2, uncertainty=1.1e-5),
        "The reference is the beam's PL³/3EI. The clamped edge prevents curvature along it, which stiffens the plate.",
    )
    yield _ssls27(
        "torsion",
        (-1.0, 1.0),
        1.0,
        Number(
            w,
            "w of the corner [m]",
            3.537e-6,
            1e-2,
            differs="The reference is a thin plate's, without boundary layers along free edges. With Saint-Venant's "
            "J = bh³/3 · (1 − 0.63 h/b) in place of bh³/3 it would be 3.2 % larger.",
        ),
        "w under a point force grows with refinement; the meshes do not resolve the layers of 0.016 m at free edges.",
    )


def _strip(ratio: int, printed: float) -> Case:
    """Return the case of a strip of width 1 under a torque of 1."""
    h, length = 1 / ratio, 6.0
    layer = h / sqrt(12 * KAPPA)
    closed = (1 - 2 * layer * tanh(0.5 / layer)) / 3

    def tables(n: int) -> Tables:
        return {
            "material": {"E": 2 * (1 + _NU) / h**3, "nu": _NU},
            "plate": {"shape": "rectangle", "size": [length, 1], "origin": [0, -0.5], "thickness": h},
            "mesh": {"divisions": [3 * n, n]},
            "support": [{"edge": "left", "fix": "hard"}, {"at": [length, 0], "resists": "both"}],
            "load": [{"line_load": "12*y", "edge": "right"}],
            "probe": [{"at": [[length / 2, 0.5]]}],
        }

    name, factor = "probe[1].deflection", 4 / length
    return Case(
        f"strip-torsion-{ratio}",
        f"Strip in torsion, b/h = {ratio}",
        ("strip", "free edges", "hard edges", "line load"),
        f"Strip 6 × 1, h = 1/{ratio}, G h³ = 1, ν = 0.25; one end is hard, a line load on the other end has the torque "
        "T = 1. w at half the length on the free edge gives the twist θ'.",
        "B. de Saint-Venant (1855); S. Timoshenko, J. N. Goodier, *Theory of Elasticity*, 1951, section 94, table of "
        "k₁ = T/θ'Gbh³. Reissner–Mindlin plate: k₁ = (1 − 2λ/b · tanh(b/2λ))/3, λ = h/√12κ.",
        "analytical",
        tables,
        (8, 16, 32),
        (
            Number(name, "1/k₁, Reissner–Mindlin", 1 / closed, 2e-3, factor),
            Number(name, "1/k₁, Saint-Venant", 1 / printed, 4e-3, factor, 0.0005 / printed**2),
        ),
        "Along free edges twisting moments fall to 0 in a layer as wide as λ. The thin plate has none: k₁ = 1/3.",
    )


def _ssls27(name: str, forces: tuple[float, float], at: float, number: Number, remark: str) -> Case:
    """Return a case of SSLS27: cantilever plate under forces at the corners of its free end; w there at y = ``at``."""

    def tables(n: int) -> Tables:
        return {
            "material": {"E": 1e11, "nu": _NU},
            "plate": {"shape": "rectangle", "size": [12, 1], "thickness": 0.05},
            "mesh": {"divisions": [12 * n, 2 * n]},
            "support": [{"edge": "left", "fix": "clamped"}],
            "load": [{"force": force, "at": [12, y]} for y, force in enumerate(forces)],
            "probe": [{"at": [[12, at]]}],
        }

    return Case(
        f"ssls27-{name}",
        f"SSLS27, cantilever plate in {name}",
        ("strip", "clamped edges", "free edges", "point load"),
        "Cantilever 12 m × 1 m, h = 0.05 m, E = 1e11 Pa, ν = 0.25; forces of "
        f"{forces[0]:g} N and {forces[1]:g} N at the corners of the free end.",
        "Société Française des Mécaniciens, *Guide de validation des progiciels de calcul de structures* (VPCS), "
        "SSLS27/89, after J. Robinson (1978); Code_Aster validation manual V3.03.027, ssls27a.comm.",
        "analytical",
        tables,
        (2, 4, 8),
        (number,),
        remark,
    )
