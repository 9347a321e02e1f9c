"""Rectangular, triangular, elliptical and skew plates from tables and closed forms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import pi
from typing import Any

import numpy as np

from signorini.validation.case import Case, Number, Tables, given
from signorini.validation.theory import (
    KAPPA,
    TIMOSHENKO,
    Levy,
    Navier,
    clamped,
    hydrostatic,
    patch,
    rigidity,
    shear_factor,
    uniform,
)

_NU = 0.3
_BATISTA = "M. Batista, *Uniformly loaded rectangular thin plates*, arXiv:1001.3016, 2010"
_SAFE = "Computers and Structures, *SAFE Software Verification*, example"
_THIN = "h/a = 1/1000: the shear strain, which the thin plate neglects, is below 2e-5 of the deflection."
_LAYER = "At free edges the modelled plate has a boundary layer as wide as the thickness, which the thin plate lacks."
_W, _MX, _MY = "deflection", "mx", "my"


def _plate(
    size: Sequence[float],
    edges: Mapping[str, str],
    h: float,
    n: int,
    probes: Sequence[Sequence[float]],
    load: Mapping[str, Any],
    **more: Any,
) -> Tables:
    """Input of a rectangle with D = 1 and n elements along x; ``edges`` maps each edge to its ``fix`` or "free"."""
    fixes = {fix: [edge for edge, own in edges.items() if own == fix] for fix in set(edges.values()) - {"free"}}
    return {
        "material": {"E": 1 / rigidity(1.0, h, _NU), "nu": _NU},
        "plate": {"shape": "rectangle", "size": size, "thickness": h},
        "mesh": {"divisions": [n, max(2, round(n * size[1] / size[0]))]},
        "support": [{"edge": names, "fix": fix} for fix, names in sorted(fixes.items())],
        "load": [load],
        "probe": [{"at": probes}],
        **more,
    }


def _edges(left: str, right: str, bottom: str, top: str) -> dict[str, str]:
    return {"left": left, "right": right, "bottom": bottom, "top": top}


_HARD = _edges("hard", "hard", "hard", "hard")


def cases() -> Iterator[Case]:
    """Yield the validation cases of this module."""
    yield from _by_navier()
    yield from _by_levy()
    yield from _clamped()
    yield from _orthotropic()
    yield from _outlines()
    yield from _skew()


def _by_navier() -> Iterator[Case]:
    """Yield cases of hard simply supported plates, by Navier's series."""
    shear = shear_factor(1e-3, _NU)
    for name, title, what, series, size, load, source, at in (
        (
            "rectangle-2",
            "Simply supported rectangle, b/a = 2",
            "q = 1",
            Navier(1, 2, _NU, uniform, shear),
            (1, 2),
            {"pressure": 1.0},
            f"{TIMOSHENKO}, chapter 5.",
            (0.5, 1.0),
        ),
        (
            "square-hydrostatic",
            "Simply supported square under hydrostatic pressure",
            "pressure x",
            Navier(1, 1, _NU, hydrostatic, shear),
            (1, 1),
            {"pressure": "x"},
            f"{TIMOSHENKO}, chapter 5.",
            (0.5, 0.5),
        ),
        (
            "square-patch",
            "Simply supported square under a patch load",
            "force 1 as pressure on the middle 0.25 × 0.25",
            Navier(1, 1, _NU, patch(0.25, 0.25), shear),
            (1, 1),
            {"pressure": 16.0, "area": {"rectangle": [0.375, 0.375, 0.625, 0.625]}},
            f"{TIMOSHENKO}, chapter 5, partially loaded plate.",
            (0.5, 0.5),
        ),
        (
            "square-on-bed",
            "Simply supported square on elastic soil",
            "q = 1, on soil of stiffness k = 500 that acts in both directions",
            Navier(1, 1, _NU, uniform, shear, bed=500.0),
            (1, 1),
            {"pressure": 1.0},
            f"{TIMOSHENKO}, chapter 8.",
            (0.5, 0.5),
        ),
    ):
        w, mx, my = series.at(*at)
        bed = [{"area": "all", "resists": "both", "stiffness": 500.0}] if series.bed else []

        def tables(n: int, size: Any = size, load: Any = load, at: Any = at, bed: Any = bed) -> Tables:
            plate = _plate(size, _HARD, 1e-3, n, [at], load)
            return {**plate, "support": [*plate["support"], *bed]}

        yield Case(
            name,
            title,
            ("rectangle", "hard edges", *(("soil",) if bed else ())),
            f"Plate {size[0]} × {size[1]}, h = 0.001, D = 1, ν = 0.3, hard simply supported edges; {what}.",
            source,
            "analytical",
            tables,
            (8, 16, 32),
            (
                Number(f"probe[1].{_W}", "w D, middle", w, 1e-3),
                Number(f"probe[1].{_MX}", "mx, middle", mx, 2e-2),
                Number(f"probe[1].{_MY}", "my, middle", my, 2e-2),
            ),
            "The series includes the shear strain of Mindlin (1951).",
        )
    h, a, b, line = 8.0, 360.0, 240.0, 1 / 12

    def along(m: np.ndarray, n: np.ndarray) -> np.ndarray:
        return np.asarray(8 * line / b / pi * (m % 2) / m * np.sin(n * pi / 2))

    d = rigidity(3000.0, h, _NU)
    w, mx, my = Navier(a, b, _NU, along, shear_factor(h, _NU), terms=(100, 20000)).at(a / 2, b / 2)
    yield Case(
        "safe-1-line-load",
        "SAFE example 1, line load",
        ("rectangle", "hard edges", "line load"),
        "Plate 360 in × 240 in, h = 8 in, E = 3000 ksi, ν = 0.3, simply supported, line load 1 kip/ft along the "
        "centre line parallel to the long side.",
        f"{_SAFE} 1; Navier's series ({TIMOSHENKO}, chapter 5) with the shear strain of Mindlin (1951).",
        "analytical",
        lambda n: {
            **_plate((a, b), _HARD, h, n, [(a / 2, b / 2)], {"line_load": line, "line": [[0, b / 2], [a, b / 2]]}),
            "material": {"E": 3000.0, "nu": _NU},
            "units": {"length": "in", "force": "kip"},
        },
        (12, 24, 48),
        (
            Number(f"probe[1].{_W}", "w, middle [in]", w / d, 1e-3),
            Number(f"probe[1].{_MX}", "mx, middle [kip]", mx, 2e-2),
            Number(f"probe[1].{_MY}", "my, middle [kip]", my, 5e-2),
        ),
    )


def _by_levy() -> Iterator[Case]:
    """Yield cases of plates with hard edges at x = 0 and x = a, by Lévy's series."""
    for name, title, b, lower, upper, source in (
        ("two-clamped", "two edges clamped", 1.0, "clamped", "clamped", ""),
        ("one-clamped", "one edge clamped", 1.0, "simple", "clamped", ""),
        ("two-free", "two edges free", 1.0, "free", "free", ""),
        ("one-free", "one edge free", 1.0, "simple", "free", ""),
        (
            "safe-3",
            "one edge clamped, one free (SAFE example 3)",
            2 / 3,
            "clamped",
            "free",
            f" {_SAFE} 3.",
        ),
    ):
        series = Levy(1.0, b, _NU, lower, upper)
        (w, mx, _), (w_edge, mx_edge, my_edge) = series.at(0.5, 0.0), series.at(0.5, b / 2)
        free = upper == "free"
        h = 1e-4 if free else 1e-3
        own = 2e-4 if free else 2e-5
        numbers = [
            Number(f"probe[1].{_W}", "w D/qa⁴, middle", w, 2e-3, uncertainty=own * w),
            Number(f"probe[1].{_MX}", "mx/qa², middle", mx, 2e-2, uncertainty=own * mx),
        ]
        if free:
            numbers.append(Number(f"probe[2].{_W}", "w D/qa⁴, free edge", w_edge, 2e-3, uncertainty=own * w_edge))
            numbers.append(Number(f"probe[2].{_MX}", "mx/qa², free edge", mx_edge, 2e-2, uncertainty=own * mx_edge))
        else:
            numbers.append(Number(f"probe[2].{_MY}", "my/qa², clamped edge", my_edge, 2e-2, uncertainty=1e-5))
        fixes = {"simple": "hard", "clamped": "clamped", "free": "free"}
        edges = _edges("hard", "hard", fixes[lower], fixes[upper])
        yield Case(
            f"levy-{name}",
            f"Two edges simply supported, {title}",
            ("rectangle", "hard edges", *(f"{kind} edges" for kind in {lower, upper} - {"simple"})),
            f"Plate 1 × {b:.4g}, D = 1, ν = 0.3, q = 1; edges x = 0, 1 hard, lower edge {lower}, upper {upper}.",
            f"Lévy's series: {TIMOSHENKO}, chapter 6; {_BATISTA}.{source}",
            "analytical",
            given(
                lambda n, b, edges, h: _plate((1, b), edges, h, n, [(0.5, b / 2), (0.5, b)], {"pressure": 1.0}),
                b,
                edges,
                h,
            ),
            (8, 16, 32) if b == 1 else (12, 24, 48),
            tuple(numbers),
            _LAYER if free else _THIN,
        )


def _clamped() -> Iterator[Case]:
    """Yield the clamped rectangle of SAFE example 2."""
    edges = _edges("clamped", "clamped", "clamped", "clamped")
    places = ((0.75, 0.5), (0.75, 0.0), (0.0, 0.5))
    (w, mx, my), (_, _, long), (_, short, _) = (clamped(1.5, 1.0, _NU, *at) for at in places)
    yield Case(
        "safe-2",
        "Clamped rectangle, b/a = 1.5 (SAFE example 2)",
        ("rectangle", "clamped edges", "uniform pressure"),
        "Plate 1.5 × 1, h = 0.001, D = 1, ν = 0.3, q = 1, all edges clamped. SAFE's plate is 360 in × 240 in.",
        f"Ritz's method with 12 × 12 polynomials, converged to 5 digits; {TIMOSHENKO}, chapter 6; {_SAFE} 2.",
        "numerical",
        lambda n: _plate((1.5, 1), edges, 1e-3, n, places, {"pressure": 1.0}),
        (12, 24, 48),
        (
            Number(f"probe[1].{_W}", "w D/qa⁴, middle", w, 2e-3, uncertainty=2e-5 * w),
            Number(f"probe[1].{_MY}", "m across the short span/qa², middle", my, 1e-2, uncertainty=2e-5 * my),
            Number(f"probe[1].{_MX}", "m along the long side/qa², middle", mx, 1e-2, uncertainty=2e-5 * mx),
            Number(f"probe[2].{_MY}", "edge moment m/qa², long side", long, 1e-2, uncertainty=-2e-5 * long),
            Number(f"probe[3].{_MX}", "edge moment m/qa², short side", short, 1e-2, uncertainty=-2e-5 * short),
        ),
        _THIN,
    )


def _orthotropic() -> Iterator[Case]:
    """Yield the case of a ribbed plate, which is given by its orthotropic rigidities."""
    dx, dy, h2, a, b = 10.0, 1.0, 3.0, 1.5, 1.0
    m, n = np.arange(1, 400, 2)[:, None], np.arange(1, 400, 2)[None, :]
    alpha, beta = m * pi / a, n * pi / b
    shape = 16 / pi**2 / (m * n) * np.sin(m * pi / 2) * np.sin(n * pi / 2)
    shape = shape / (dx * alpha**4 + 2 * h2 * alpha**2 * beta**2 + dy * beta**4)
    numbers = (
        Number(f"probe[1].{_W}", "w, middle", float(shape.sum()), 1e-3),
        Number(f"probe[1].{_MX}", "mx, middle", float((shape * dx * alpha**2).sum()), 2e-2),
        Number(f"probe[1].{_MY}", "my, middle", float((shape * dy * beta**2).sum()), 2e-2),
    )
    yield Case(
        "orthotropic",
        "Orthotropic rectangle (Huber)",
        ("rectangle", "orthotropic section", "hard edges"),
        "Plate 1.5 × 1, Dx = 10, Dy = 1, D1 = 0, Dxy = 1.5 (H = D1 + 2 Dxy = 3), q = 1, hard simply supported edges.",
        f"{TIMOSHENKO}, chapter 11, of M. T. Huber (1914).",
        "analytical",
        lambda n: {
            "plate": {
                "shape": "rectangle",
                "size": [a, b],
                "thickness": 0.01,
                "stiffness": {"Dx": dx, "Dy": dy, "D1": 0, "Dxy": h2 / 2, "Sx": 1e9, "Sy": 1e9},
            },
            "mesh": {"divisions": [n, round(n / 1.5)]},
            "support": [{"edge": ["left", "right", "bottom", "top"], "fix": "hard"}],
            "load": [{"pressure": 1.0}],
            "probe": [{"at": [[a / 2, b / 2]]}],
        },
        (12, 24, 48),
        numbers,
    )


def _polygon(
    points: Sequence[Any], h: float, material: Mapping[str, float], fixes: Mapping[str, Sequence[int]], at: Any
) -> Any:
    """Return a function of element size and pressure (by default 1) that makes the input of a polygonal plate."""

    def tables(size: float, pressure: float = 1.0) -> Tables:
        return {
            "material": material,
            "plate": {"shape": "polygon", "points": points, "thickness": h},
            "mesh": {"size": size},
            "support": [{"edge": [f"edge {i}" for i in edges], "fix": fix} for fix, edges in fixes.items()],
            "load": [{"pressure": pressure}],
            "probe": [{"at": [at]}],
        }

    return tables


def _outlines() -> Iterator[Case]:
    """Yield cases of triangular plates and of an elliptical plate."""
    a, h, young = 3.0, 0.15, 1e7
    turns = np.radians([0.0, 120.0, 240.0])
    points = (2 * a / 3 * np.column_stack([np.cos(turns), np.sin(turns)])).tolist()
    d = rigidity(young, h, _NU)
    w = a**4 / (972 * d) + a**2 / (27 * KAPPA * young / (2 * (1 + _NU)) * h)
    triangle = _polygon(points, h, {"E": young, "nu": _NU}, {"hard": (1, 2, 3)}, [0, 0])
    yield Case(
        "triangle-equilateral",
        "Equilateral triangle",
        ("polygon", "hard edges", "uniform pressure"),
        "Equilateral triangle of height a = 3, h = 0.15, E = 1e7, ν = 0.3, q = 1, hard simply supported edges.",
        f"{TIMOSHENKO}, chapter 9: w = qa⁴/972D, m = (1 + ν)qa²/54, and the shear deflection qa²/27κGh.",
        "analytical",
        lambda n: triangle(a / n),
        (8, 16, 32),
        (
            Number(f"probe[1].{_W}", "w, centroid", w, 1e-3),
            Number(f"probe[1].{_MX}", "m, centroid", (1 + _NU) * a**2 / 54, 2e-2),
        ),
    )
    m, n = np.arange(1, 300)[:, None], np.arange(1, 300)[None, :]
    odd = (m % 2 == 1) & (n % 2 == 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        terms = np.where(odd, n / (m * (n**2 - m**2)), np.where(odd.T, m / (n * (m**2 - n**2)), 0.0))
    x = y = 0.25
    shape = 16 / pi**6 * terms / (m**2 + n**2) ** 2 * np.sin(m * pi * x) * np.sin(n * pi * y)
    shape = np.where(odd | odd.T, shape, 0.0)
    w = float(shape.sum())
    right = _polygon(
        [[0, 0], [1, 0], [0, 1]], 1e-3, {"E": 1 / rigidity(1, 1e-3, _NU), "nu": _NU}, {"hard": (1, 2, 3)}, [x, y]
    )
    yield Case(
        "triangle-right",
        "Right-angled isosceles triangle",
        ("polygon", "hard edges", "uniform pressure"),
        "Triangle (0, 0), (1, 0), (0, 1), h = 0.001, D = 1, ν = 0.3, q = 1, hard simply supported edges.",
        f"{TIMOSHENKO}, chapter 9, by the method of images in the square (A. Nadai 1925).",
        "analytical",
        lambda n: right(1 / n),
        (8, 16, 32),
        (Number(f"probe[1].{_W}", "w D/qa⁴ at (a/4, a/4)", w, 2e-3, uncertainty=2e-5 * w),),
        _THIN,
    )
    a, b, h, young = 2.0, 1.2, 0.005, 1e7
    turn = np.linspace(0, 2 * pi, 65)
    at = np.column_stack([a * np.cos(turn), b * np.sin(turn)]).tolist()
    arcs = [{"through": through, "to": to} for through, to in zip(at[1::2], at[2::2], strict=True)]
    arcs[-1]["to"] = at[0]
    d = rigidity(young, h, _NU)
    w = 1 / (d * (24 / a**4 + 24 / b**4 + 16 / (a * b) ** 2))
    moment = 4 * d * w * (1 / a**2 + _NU / b**2)
    ellipse = _polygon([at[0], *arcs], h, {"E": young, "nu": _NU}, {"clamped": range(1, 33)}, [0, 0])
    yield Case(
        "ellipse-clamped",
        "Clamped ellipse",
        ("polygon with arcs", "clamped edges", "uniform pressure"),
        "Ellipse of half-axes 2 and 1.2 as an outline of 32 arcs, h = 0.005, E = 1e7, ν = 0.3, q = 1, clamped.",
        f"{TIMOSHENKO}, chapter 9: w = q/D(24/a⁴ + 24/b⁴ + 16/a²b²).",
        "analytical",
        lambda n: ellipse(2 * a / n),
        (12, 24, 48),
        (
            Number(f"probe[1].{_W}", "w, middle", w, 1e-3, uncertainty=1e-4 * w),
            Number(f"probe[1].{_MX}", "mx, middle", moment, 2e-2, uncertainty=1e-4 * moment),
        ),
        "The outline of arcs and the shear strain change the deflection by less than 1e-4 of its value.",
    )


def _skew() -> Iterator[Case]:
    """Yield the skew plates of NAFEMS and of Razzaque."""

    def rhombus(side: float, degrees: float) -> tuple[list[list[float]], list[float]]:
        angle = np.radians(degrees)
        x, y = side * np.array([[1, 0], [np.cos(angle), np.sin(angle)]])
        return [[0.0, 0.0], x.tolist(), (x + y).tolist(), y.tolist()], ((x + y) / 2).tolist()

    points, middle = rhombus(1.0, 30)
    le6 = _polygon(points, 0.01, {"E": 210e9, "nu": _NU}, {"simple": (1, 2, 3, 4)}, middle)
    yield Case(
        "nafems-le6",
        "NAFEMS LE6, skew plate",
        ("polygon", "soft edges", "uniform pressure"),
        "Rhombus of side 1 m and angle 30°, h = 0.01 m, E = 210 GPa, ν = 0.3, p = 700 Pa, w = 0 on all edges.",
        "NAFEMS, *The Standard NAFEMS Benchmarks*, 1990, LE6: σ1 = 0.802 MPa. High-order spectral solution of the "
        "Reissner–Mindlin plate with soft edges: 0.8214 MPa.",
        "numerical",
        lambda n: le6(1 / n, 700.0),
        (16, 32, 64),
        (
            Number("probe[1].m1", "σ1 at the bottom, middle [MPa]", 0.8214, 3e-2, 6 / 0.01**2 / 1e6, 5e-5),
            Number(
                "probe[1].m1",
                "σ1, printed by NAFEMS [MPa]",
                0.802,
                1.5e-2,
                6 / 0.01**2 / 1e6,
                differs="NAFEMS's value is from coarse meshes of thin plates; the plate of this thickness converges to "
                "0.8214.",
            ),
        ),
        "The obtuse corners are singular, so that convergence is slow.",
    )
    points, middle = rhombus(100.0, 60)
    d = rigidity(1085.0, 0.1, 0.31)
    plate = _polygon(points, 0.1, {"E": 1085.0, "nu": 0.31}, {"simple": (1, 3)}, middle)
    yield Case(
        "razzaque",
        "Skew plate of Razzaque",
        ("polygon", "soft edges", "free edges", "uniform pressure"),
        "Rhombus of side L = 100 and angle 60°, h = 0.1, E = 1085, ν = 0.31, q = 1; two opposite edges simply "
        "supported, two free.",
        "A. Razzaque, *Int. J. Numer. Meth. Eng.* 6 (1973) 333–343: 7.945e-3 qL⁴/D. High-order spectral solution of "
        "the Reissner–Mindlin plate with soft edges: 7.936e-3.",
        "numerical",
        lambda n: plate(100 / n),
        (8, 16, 32),
        (
            Number(f"probe[1].{_W}", "w D/qL⁴, middle", 7.936e-3, 3e-3, d / 1e8, 5e-7),
            Number(f"probe[1].{_W}", "w D/qL⁴, printed by Razzaque", 7.945e-3, 3e-3, d / 1e8, 1e-5),
        ),
    )
