"""Patch tests, several plates, and the first example of the paper of Bergmann, Carnicer and Sanzi (docs/theory.md)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from signorini.analysis.solve import solve
from signorini.model import Model
from signorini.results.result import Result
from signorini.validation.case import Case, Number, Tables
from signorini.validation.theory import KAPPA, TIMOSHENKO, Navier, rigidity, shear_factor, uniform

_EDGES = ["left", "right", "bottom", "top"]


def cases() -> Iterator[Case]:
    """Yield the validation cases of this module."""
    yield from _patches()
    yield from _two_plates()
    yield _ssnv129()
    yield _cantilevers()
    yield _curled()
    yield _superposition()


def _patches() -> Iterator[Case]:
    """Yield patch tests: unstructured meshes with the displacements of constant moment or shear at the edge nodes."""
    h, nu, young = 0.1, 0.25, 1e6
    d, s = rigidity(young, h, nu), KAPPA * young * h / 2 / (1 + nu)
    # Constant shear 1 along ξ = 0.6x + 0.8y: w = ξ/S − ξ³/6D, m = ξ along ξ; the probe is at ξ = 1.16.
    xi = "(0.6*x + 0.8*y)"
    outline = [[0, 0], [2.4, 0.3], [2.1, 1.6], [0.9, 1.1], [-0.3, 1.4]]
    for name, what, w, slopes, numbers in (
        ("moment", "constant moment", "(x**2 + 0.5*y**2)/2", ("x", "0.5*y"), {"mx": -d * (1 + nu / 2), "mxy": 0.0}),
        ("twist", "constant twist", "x*y", ("y", "x"), {"mxy": -d * (1 - nu), "mx": 0.0}),
        (
            "shear",
            "constant shear",
            f"{1 / s!r}*{xi} - {1 / d!r}*{xi}**3/6",
            (f"-0.6*{1 / d!r}*{xi}**2/2", f"-0.8*{1 / d!r}*{xi}**2/2"),
            {
                "qx": 0.6,
                "qy": 0.8,
                "mx": 1.16 * (0.36 + nu * 0.64),
                "my": 1.16 * (0.64 + nu * 0.36),
                "mxy": 1.16 * (1 - nu) * 0.48,
            },
        ),
    ):

        def tables(n: int, w: str = w, slopes: tuple[str, str] = slopes) -> Tables:
            edges = {"edge": [f"edge {i}" for i in range(1, 6)], "fix": "clamped"}
            return {
                "material": {"E": young, "nu": nu},
                "plate": {"shape": "polygon", "points": outline, "thickness": h},
                "mesh": {"size": 1.2 / n},
                "support": [{**edges, "settlement": w, "rotation": list(slopes)}],
                "load": [{"pressure": 0.0}],
                "probe": [{"at": [[1.0, 0.7]]}],
            }

        yield Case(
            f"patch-{name}",
            f"Patch test, {what}",
            ("patch test", "polygon", "settlement", "prescribed rotations"),
            "Pentagon with an unstructured mesh of quadrilaterals and triangles; its edges have the deflection and "
            f"slopes of a {what}; no load.",
            "B. M. Irons, A. Razzaque (1972); R. H. MacNeal, R. L. Harder, *A proposed standard set of problems*, "
            "Finite Elem. Anal. Des. 1 (1985) 3–20: the state is reproduced exactly.",
            "analytical",
            tables,
            (2, 4, 8),
            tuple(
                Number(f"probe[1].{key}", key, value, 1e-9, size=d if key.startswith("m") and name != "shear" else 1.0)
                for key, value in numbers.items()
            ),
            "Tests of the elements show that constant moments and shears are exact on distorted elements, too.",
        )


def _two_plates() -> Iterator[Case]:
    """Yield cases of two simply supported square plates, one on the other, that touch."""
    thick, thin, young = 0.04, 0.02, 210e9
    part = thin**3 / (thick**3 + thin**3)
    w = Navier(4, 4, 0.0, uniform, shear_factor(thick, 0.0)).at(2, 2)[0] * 1e3 / rigidity(young, thick, 0.0)
    for loaded in ("upper", "lower"):
        above = loaded == "upper"

        def tables(n: int, loaded: str = loaded) -> Tables:
            square = {"shape": "rectangle", "size": [4, 4], "mesh": {"divisions": [n, n]}}
            return {
                "material": {"E": young, "nu": 0.0},
                "plates": {"upper": {**square, "thickness": thick}, "lower": {**square, "thickness": thin}},
                "support": [{"plate": name, "edge": _EDGES, "fix": "hard"} for name in ("upper", "lower")],
                "contact": [{"name": "contact", "between": ["upper", "lower"], "area": "all"}],
                "load": [{"plate": loaded, "pressure": 1e3}],
                "probe": [{"plate": "upper", "at": [[2, 2]]}],
            }

        touching = 16e3 * part if above else 0.0
        yield Case(
            f"plates-{loaded}",
            f"Two plates that touch, load on the {loaded} one",
            ("several plates", "rigid contact", "hard edges"),
            "Two squares of 4 m, h = 0.04 m above 0.02 m, E = 210 GPa, ν = 0, both on hard edges, 1 kPa on the "
            f"{loaded} one.",
            "Thin plates of equal outline share a load on the upper plate in the ratio D₁ : D₂; a load on the lower "
            f"plate separates them. Deflection: {TIMOSHENKO}, chapter 5.",
            "analytical",
            tables,
            (4, 8, 16),
            (
                Number("contact.reaction", "force between the plates [N]", touching, 1e-2, 1.0, 2e-3 * touching, 16e3),
                Number(
                    "probe[1].deflection",
                    "w of the upper plate, middle [mm]",
                    (1 - part) * w * 1e3 if above else 0.0,
                    5e-3,
                    1e3,
                    2e-4 * w * 1e3 * above,
                    (1 - part) * w * 1e3,
                ),
            ),
            "Shear strain and the contact at the edges change the two plates' shares of the load by about h²/a² = 1e-4 "
            "(thickness h, span a).",
        )


def _ssnv129() -> Case:
    """Return Code_Aster's case SSNV129: two equal simply supported plates that touch."""
    young, nu, h, a, b, half = 2e11, 0.3, 0.5, 10.0, 5.0, 1.25e8
    w, _, my = Navier(a, b, nu, uniform, shear_factor(h, nu)).at(a / 2, b / 2)
    w *= half / rigidity(young, h, nu)

    def tables(n: int) -> Tables:
        plate = {"shape": "rectangle", "size": [a, b], "thickness": h, "mesh": {"divisions": [2 * n, n]}}
        return {
            "material": {"E": young, "nu": nu},
            "plates": {"upper": plate, "lower": plate},
            "support": [{"plate": name, "edge": _EDGES, "fix": "hard"} for name in ("upper", "lower")],
            "contact": [{"name": "contact", "between": ["upper", "lower"], "area": "all"}],
            "load": [{"plate": "upper", "pressure": 2 * half}],
            "probe": [{"plate": "lower", "at": [[a / 2, b / 2]]}],
        }

    return Case(
        "ssnv129",
        "SSNV129, two equal plates that touch",
        ("several plates", "rigid contact", "hard edges"),
        "Two rectangles 10 × 5, h = 0.5, E = 2e11, ν = 0.3, one on the other, both on hard edges; pressure 2.5e8 on "
        "the upper one.",
        "P. Massin, R. Fernandes, Code_Aster validation manual V6.04.129 (SSNV129), with the values of ssnv129a.comm "
        "(DKT) and ssnv129b.comm (COQUE_3D). Equal plates share the pressure equally: Navier's series with shear "
        f"strain, {TIMOSHENKO}, chapter 5; R. D. Mindlin (1951).",
        "analytical",
        tables,
        (4, 8, 16),
        (
            Number("contact.reaction", "force between the plates", half * a * b, 1e-3),
            Number("probe[1].deflection", "w of the lower plate, middle", w, 1e-3),
            Number("probe[1].my", "my of the lower plate, middle", half * my, 5e-3),
            Number("probe[1].deflection", "w, computed with COQUE_3D", 0.356759602, 1e-3, uncertainty=5e-5),
            Number("probe[1].sy_bottom", "σy below, printed", 7.6275e9, 5e-3, uncertainty=2e6),
            Number(
                "probe[1].deflection",
                "w, printed",
                0.3426875,
                1e-2,
                differs="The printed value has an extra digit 2: Roark's 0.1110 p b⁴/Eh³ for the thin plate under "
                "p = 1.25e8 is 0.346875. Shear strain adds 3.2 % to the thin plate's exact 0.34564.",
            ),
        ),
    )


def _cantilevers() -> Case:
    """Return the case of two cantilevers, one above the other, that touch at the tip."""
    thick, thin, young = 0.05, 0.04, 210e9
    soft = {h: 4**3 / 3 / rigidity(young, h, 0.0) + 4 / (KAPPA * young * h / 2) for h in (thick, thin)}
    part = soft[thick] / (soft[thick] + soft[thin])

    def tables(n: int) -> Tables:
        strip = {"shape": "rectangle", "size": [4, 0.5], "mesh": {"divisions": [n, 1]}}
        return {
            "material": {"E": young, "nu": 0.0},
            "plates": {"upper": {**strip, "thickness": thick}, "lower": {**strip, "thickness": thin}},
            "support": [{"plate": name, "edge": "left", "fix": "clamped"} for name in ("upper", "lower")],
            "contact": [{"name": "tip", "between": ["upper", "lower"], "line": [[4, 0], [4, 0.5]]}],
            "load": [{"plate": "upper", "line_load": 1e3, "edge": "right"}],
            "probe": [{"plate": "upper", "at": [[4, 0.25]]}],
        }

    return Case(
        "plates-cantilevers",
        "Stacked cantilevers that touch at the tip",
        ("several plates", "strip", "line load", "rigid contact"),
        "Two cantilevers 4 m × 0.5 m, h = 0.05 m above 0.04 m, E = 210 GPa, ν = 0; 1 kN/m on the tip of the upper one, "
        "contact along the tips.",
        "Beam statics: tip compliances c₁ above, c₂ below, c = L³/3EI + L/κGh; the lower tip carries P c₁/(c₁ + c₂).",
        "analytical",
        tables,
        (8, 16, 32),
        (
            Number("tip.reaction", "force between the tips [N]", 500 * part, 1e-3),
            Number("probe[1].deflection", "w of the tip [mm]", 1e6 * part * soft[thin], 1e-3, 1e3),
        ),
    )


def _curled() -> Case:
    """Return the case of a clamped plate that is heated on one face."""
    d, kappa, nu = rigidity(30e9, 0.2, 0.2), 1e-3, 0.2
    return Case(
        "curvature-clamped",
        "Clamped plate with a stress-free curvature",
        ("rectangle", "curvature", "clamped edges"),
        "Plate 4 m × 3 m × 0.2 m, E = 30 GPa, ν = 0.2, clamped, with the stress-free curvature κ = 1e-3/m in both "
        "directions.",
        f"{TIMOSHENKO}, chapter 2: the plate stays flat, m = D(1 + ν)κ.",
        "analytical",
        lambda n: {
            "material": {"E": 30e9, "nu": nu},
            "plate": {"shape": "rectangle", "size": [4, 3], "thickness": 0.2},
            "mesh": {"divisions": [n, n]},
            "support": [{"edge": _EDGES, "fix": "clamped"}],
            "load": [{"curvature": [kappa, kappa, 0]}],
            "probe": [{"at": [[2, 1.5]]}],
        },
        (4, 8, 16),
        (
            Number("probe[1].mx", "mx [N]", d * (1 + nu) * kappa, 1e-9),
            Number("probe[1].deflection", "w [m]", 0.0, 1e-9, size=kappa),
        ),
    )


def _quarter(n: int, load: float, prop: Mapping[str, Any] | None) -> Tables:
    """Quarter of a clamped square plate in N and mm under the force ``load``; ``prop`` supports the square's middle."""
    return {
        "material": {"E": 218564.54444273014, "nu": 0.3},
        "plate": {"shape": "rectangle", "size": [100, 100], "thickness": 20},
        "mesh": {"divisions": [n, n]},
        "support": [
            {"name": "edges", "edge": ["bottom", "left"], "fix": "clamped"},
            {"edge": ["right", "top"], "fix": "symmetry"},
            *([{"name": "prop", "at": [100, 100], **prop}] if prop else []),
        ],
        "load": [{"pressure": load / 1e4}],
    }


def _superposition() -> Case:
    """Return the case that checks the paper's superposition theorem on the paper's first example."""

    def solved(n: int, load: float, prop: Mapping[str, Any] | None) -> Result:
        return solve(Model.model_validate(_quarter(n, load, prop)))["all"]

    def numbers(n: int) -> Mapping[str, float]:
        first, second = solved(n, 32.0, None), solved(n, 32.0, {"resists": "both"})
        whole = solved(n, 64.0, {"resists": "down", "gap": float(first.deflection.max())})
        edges = whole.supports[0].reactions - first.supports[0].reactions - second.supports[0].reactions
        prop = whole.reactions["prop"] - second.reactions["prop"]
        return {"apart": float(max(np.abs(edges).max(), abs(prop))), "sum": sum(whole.reactions.values())}

    return Case(
        "paper-superposition",
        "Two-stage superposition (the paper's first example)",
        ("gap", "one-sided points", "superposition"),
        "Quarter 100 mm × 100 mm of a clamped square, h = 20 mm, E = 218565 MPa, ν = 0.3, on 2 × 2 elements, total "
        "load 64 N; a prop under the middle at a gap that half of the load closes. "
        "First stage: half of the load without the prop; second "
        "stage: the other half with a rigid prop.",
        "Bergmann, Carnicer, Sanzi: one-sided reactions are the sums R¹ + R² of both stages at each node, 64 N in all.",
        "analytical",
        numbers,
        (2,),
        (
            Number("apart", "largest difference of a reaction from R¹ + R² [N]", 0.0, 1e-10, size=64.0),
            Number("sum", "sum of the reactions [N]", 64.0, 1e-10),
        ),
        direct=True,
    )
