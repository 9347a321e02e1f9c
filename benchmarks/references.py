"""Check that ± covers the error of known answers: closed forms, series, and results of other programs.

For each number the table has, on a coarse and a fine mesh, value, ±, reference, and whether the error exceeds ±. A
number without limit (a moment under a point force) has no ± and is reported as singular. Tests check all cases.
Number.rounding is half a unit of a reference's last digit, or the error of the reference for the modelled plate, which
has finite thickness and extent.

    python benchmarks/references.py [--only WORDS] [--check]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import pi, sqrt
from typing import Any

import numpy as np
import tensionless

from signorini import Model, estimate, solve
from signorini.results.figures import figures

Path = tuple[str | int, ...]
EDGES = ["left", "right", "bottom", "top"]
NU = 0.3


@dataclass(frozen=True)
class Number:
    """A number of results.json: its path, its reference value, and the reference's error for the modelled plate."""

    name: str
    path: Path
    reference: float
    rounding: float = 0.0


@dataclass(frozen=True)
class Case:
    """A plate with known answers, with its models on a coarse and on a fine mesh."""

    title: str
    models: tuple[Callable[[], Model], Callable[[], Model]]
    numbers: Sequence[Number]


@dataclass(frozen=True)
class Row:
    """A number on a mesh with its half-width."""

    case: str
    elements: int
    number: Number
    value: float
    width: float | None

    @property
    def difference(self) -> float:
        return abs(self.value - self.number.reference)

    @property
    def covered(self) -> bool:
        return self.width is None or self.difference <= self.width + self.number.rounding


def rows(case: Case, mesh: int) -> list[Row]:
    """Solve a case on its coarse mesh (``mesh`` = 0) or its fine mesh (1)."""
    result = solve(case.models[mesh]())["all"]
    tree, widths = figures(result), estimate(result).plus_minus
    assert widths is not None
    of = (case.title, len(result.mesh.elements))
    return [Row(*of, one, at(tree, one.path), at(widths, one.path)) for one in case.numbers]


def at(tree: Any, path: Path) -> Any:
    for part in path:
        tree = tree[part]
    return tree


def rigidity(young: float, thickness: float, nu: float = NU) -> float:
    return young * thickness**3 / 12 / (1 - nu**2)


def probe(number: int, key: str, *component: int) -> Path:
    return ("probes", number, key, *component)


def support(index: int, *key: str | int) -> Path:
    return ("supports", index, *key)


def both(model: Callable[[Any], Model], coarse: Any, fine: Any) -> tuple[Callable[[], Model], Callable[[], Model]]:
    return lambda: model(coarse), lambda: model(fine)


def square(held: Mapping[str, object], thickness: float, references: Sequence[Number], what: str) -> Case:
    """Unit square under q = 1 with D = 1; probes are in the middle, in the middle of a side, and in a corner."""

    def model(n: int) -> Model:
        return Model(
            material={"E": 1 / rigidity(1.0, thickness), "nu": NU},
            plate={"shape": "rectangle", "size": [1, 1], "thickness": thickness},
            mesh={"divisions": [n, n]},
            support=[{"name": "edges", "edge": EDGES, **held}],
            load=[{"pressure": 1.0}],
            probe=[{"at": [[0.5, 0.5], [0.0, 0.5], [0.0, 0.0]]}],
        )

    return Case(f"{what} square, h/a = {thickness:g}", both(model, 10, 20), references)


W, MX, MXY = probe(0, "deflection"), probe(0, "moment", 0), probe(2, "moment", 2)
REACTION = Number("total reaction", support(0, "reaction"), 1.0, 1e-9)


def squares() -> list[Case]:
    found = []
    for what, fix, deflections in (
        ("Hard", "hard", {1e-4: 0.00406235, 0.01: 0.00406446, 0.1: 0.00427284, 0.2: 0.00490431}),
        ("Soft", "simple", {0.001: 0.00406585, 0.01: 0.00409930, 0.1: 0.00461691, 0.2: 0.00554504}),
        ("Clamped", "clamped", {0.001: 0.00126534, 0.01: 0.00126786, 0.1: 0.00150463, 0.2: 0.00217216}),
    ):
        for h, w in deflections.items():
            numbers = [Number("deflection", W, w, 5e-9), REACTION]
            if what == "Hard":
                numbers.append(Number("half the corner force, mxy", MXY, -0.0649646 / 2, 5e-8))
            if what == "Clamped":
                moment = {0.001: 0.05133, 0.01: 0.05131, 0.1: 0.04937, 0.2: 0.04625}[h]
                numbers.append(Number("moment at the edge", probe(1, "moment", 0), -moment, 5e-6))
            found.append(square({"fix": fix}, h, numbers, what))
    for h, w, moment, uplift in ((0.1, 0.004805, 0.05275, 6.62e-4), (0.01, 0.004402, 0.05103, 7.43e-4)):
        numbers = [Number("deflection", W, w, 5e-7), Number("moment", MX, moment, 5e-6)]
        numbers.append(Number("deflection of the corner", probe(2, "deflection"), -uplift, 5e-7))
        found.append(square({"resists": "down"}, h, [*numbers, REACTION], "One-sided"))
    return found


def circles() -> list[Case]:
    """Code_Aster SSLS101 and SSLS100, each as a mapped disc and as a polygon of arcs."""

    def model(mesh: Mapping[str, object], fix: str, plate: Mapping[str, object], edges: list[str]) -> Model:
        return Model(
            material={"E": 1.0, "nu": NU},
            plate={"thickness": 0.1, **plate},
            mesh=mesh,
            support=[{"edge": edges, "fix": fix}],
            load=[{"pressure": 1.0}],
            probe=[{"at": [0, 0]}],
        )

    disc: dict[str, object] = {"shape": "disc", "radius": 1}
    arcs = {"shape": "polygon", "points": [[1, 0], arc([0, 1], [-1, 0]), arc([0, -1], [1, 0])]}
    found = []
    for title, fix, w, moment in (("SSLS101", "simple", 703.425, 3.3 / 16), ("SSLS100", "clamped", 178.425, 1.3 / 16)):
        numbers = [Number("deflection", W, w, 5e-4), Number("moment", MX, moment)]
        numbers.append(Number("reaction", support(0, "reaction"), pi))
        for outline, plate, edges, meshes in (
            ("", disc, ["rim"], ({"divisions": [5, 16]}, {"divisions": [10, 32]})),
            (", of two arcs", arcs, ["edge 1", "edge 2"], ({"size": 0.2}, {"size": 0.1})),
        ):
            models = [lambda mesh=mesh, of=(fix, plate, edges): model(mesh, *of) for mesh in meshes]
            found.append(Case(title + outline, (models[0], models[1]), numbers))
    return found


def arc(through: list[float], to: list[float]) -> dict[str, list[float]]:
    return {"through": through, "to": to}


def polygon(points: Sequence[Any], thickness: float, material: Mapping[str, float], at: Any, supports: Any) -> Any:
    """Return a function of the element size that makes the model of a polygon under p = 1."""
    return lambda size: Model(
        material=material,
        plate={"shape": "polygon", "points": points, "thickness": thickness},
        mesh={"size": size},
        support=supports,
        load=[{"pressure": material.get("pressure", 1.0)}],
        probe=[{"at": at}],
    )


def skew() -> list[Case]:
    """NAFEMS LE6, whose soft Mindlin plate converges to 0.8214 MPa, and Razzaque's plate, to 7.936e-3 qL⁴/D."""

    def corners(side: float, degrees: float) -> tuple[list[list[float]], list[float]]:
        a = np.radians(degrees)
        x, y = side * np.array([[1, 0], [np.cos(a), np.sin(a)]])
        return [[0.0, 0.0], x.tolist(), (x + y).tolist(), y.tolist()], ((x + y) / 2).tolist()

    points, middle = corners(1.0, 30)
    simple = [{"edge": [f"edge {i}" for i in (1, 2, 3, 4)], "fix": "simple"}]
    le6 = polygon(points, 0.01, {"E": 210e9, "nu": NU}, middle, simple)
    moment = 0.8214e6 * 0.01**2 / 6 / 700
    numbers = [Number("principal moment", probe(0, "principal_moment", 0), moment, moment * 0.5 / 8214)]
    found = [Case("NAFEMS LE6", both(le6, 0.05, 0.025), numbers)]
    points, middle = corners(100.0, 60)
    simple = [{"edge": ["edge 1", "edge 3"], "fix": "simple"}]
    razzaque = polygon(points, 0.1, {"E": 1085.0, "nu": 0.31}, middle, simple)
    w = 7.936e-3 * 100**4 / rigidity(1085.0, 0.1, 0.31)
    numbers = [Number("deflection", W, w, w * 0.5 / 7936)]
    return [*found, Case("Razzaque's skew plate", both(razzaque, 10.0, 5.0), numbers)]


def closed_forms() -> list[Case]:
    """An equilateral triangle on hard edges, and a clamped ellipse (Timoshenko, Woinowsky-Krieger 1959)."""
    a, h, young = 3.0, 0.15, 1e7
    angles = np.radians([0.0, 120.0, 240.0])
    points = (2 * a / 3 * np.column_stack([np.cos(angles), np.sin(angles)])).tolist()
    d = rigidity(young, h)
    w = a**4 / (972 * d) + a**2 / (27 * 5 / 6 * young / (2 * (1 + NU)) * h)
    moment = (1 + NU) * a**2 / 54
    hard = [{"edge": [f"edge {i}" for i in (1, 2, 3)], "fix": "hard"}]
    triangle = polygon(points, h, {"E": young, "nu": NU}, [0, 0], hard)
    numbers = [Number("deflection", W, w), Number("moment", MX, moment)]
    found = [Case("Equilateral triangle", both(triangle, 0.3, 0.15), numbers)]
    a, b, h = 2.0, 1.2, 0.005
    turn = np.linspace(0, 2 * pi, 65)
    at = np.column_stack([a * np.cos(turn), b * np.sin(turn)]).tolist()
    points = [at[0], *(arc(m, to) for m, to in zip(at[1::2], at[2::2], strict=True))]
    points[-1] = arc(at[-2], at[0])
    d = rigidity(young, h)
    w = 1 / (d * (24 / a**4 + 24 / b**4 + 16 / (a * b) ** 2))
    moment = 8 * d * w * (1 / a**2 + NU / b**2) / 2
    clamped = [{"edge": [f"edge {i}" for i in range(1, 33)], "fix": "clamped"}]
    ellipse = polygon(points, h, {"E": young, "nu": NU}, [0, 0], clamped)
    # The reference's error: the outline is 32 arcs, and the thickness is 0.005.
    numbers = [Number("deflection", W, w, 1e-4 * w), Number("moment", MX, moment, 1e-4 * moment)]
    return [*found, Case("Clamped ellipse", both(ellipse, 0.3, 0.15), numbers)]


def tensionless_cases() -> list[Case]:
    """The cases of `tensionless`; their quantities are numbers of results.json."""
    area, pressed = support(0, "contact_area"), support(0, "max_pressure")
    strip = [
        Number("contact area", area, 0.5 * sqrt(2) * pi),
        Number("deflection", W, tensionless.STRIP.exact["deflection"], 3e-6),
        Number("moment", MX, tensionless.STRIP.exact["moment"]),
    ]
    found = [Case("Strip, line load", both(tensionless.STRIP.model, 40, 80), strip)]
    for radius, case in ((3, tensionless.DISC_3), (5, tensionless.DISC_5)):
        r, w, rim = (case.exact[name] for name in ("contact radius", "deflection", "rim uplift"))
        numbers = [
            Number("contact area", area, pi * r**2, 2 * pi * r * 5e-7),
            # The reference is a thin plate's. With h = 0.01 the deflection under a point force grows without limit.
            Number("deflection under the force", W, w, 2e-3 * w),
            Number("deflection of the rim", probe(1, "deflection"), -rim, 5e-7),
        ]
        found.append(Case(f"Disc, R = {radius} ℓ", both(case.model, 8, 16), numbers))
    ssnl130 = [
        Number("deflection at 0", W, 4 / 1125, 1e-9),
        Number("deflection at 2", probe(1, "deflection"), -4 / 3375, 1e-9),
        Number("contact area", area, 1.5, 1e-6),
        Number("reaction", support(0, "reaction"), 40 / 3, 1e-9),
    ]
    found.append(Case("SSNL130, continuous bed", both(tensionless.SSNL130.model, 10, 21), ssnl130))
    footing = [Number("contact area", area, 3.0, 1e-5), Number("pressure", pressed, 8 / 3 * 250, 1e-2)]
    found.append(Case("Rigid footing, e = B/4", both(tensionless.FOOTING.model, 10, 21), footing))
    base = [
        Number("contact area", area, 0.362679 * 0.4, 0.2e-6),
        Number("bolts", support(1, "reaction"), -199.126e3, 0.5),
        Number("pressure", pressed, 9.638e6, 0.5e3),
    ]
    found.append(Case("Base plate with bolts", both(tensionless.BASE_PLATE.model, 12, 24), base))
    exact = tensionless.SLAB_A.exact
    slab = [
        Number("settlement", ("deflection", "max"), exact["settlement"], 1e-8),
        Number("uplift", ("deflection", "min"), -1.475e-5, 0.025e-5),
        Number("contact area", area, 100 * exact["contact"], 2e-4),
        Number("pressure", pressed, exact["pressure"], 0.5),
    ]
    found.append(Case("Slab A", both(tensionless.slab_a, 20, 40), slab))
    return found


def ssnl130_on_lines() -> Case:
    """Springs on 17 lines y = i/8, half as stiff at the ends."""

    def model(along: int) -> Model:
        stiffness = [1e4 / 16 / (2 if i in (0, 16) else 1) for i in range(17)]
        return Model(
            material={"E": 2e13, "nu": NU},
            plate={"shape": "rectangle", "size": [1, 2], "thickness": 0.3},
            mesh={"divisions": [along, 16 * along]},
            support=[
                {"line": [[0, i / 8], [1, i / 8]], "resists": "down", "stiffness": k} for i, k in enumerate(stiffness)
            ],
            load=[{"pressure": "5*(y-2)**2"}],
            probe=[{"at": [[0.5, 0], [0.5, 2]]}],
        )

    numbers = [
        Number("deflection at 0", W, 208 / 58875, 1e-11),
        Number("deflection at 2", probe(1, "deflection"), -176 / 153075, 1e-11),
        Number(
            "reaction of line 12",
            support(12, "reaction"),
            625 * (208 - 0.75 * (208 + 58875 * 176 / 153075)) / 58875,
            1e-6,
        ),
    ]
    return Case("SSNL130, on 17 lines", both(model, 1, 2), numbers)


def slab_b() -> Case:
    """16 rigid points that only push; the reference is MITC4 on 160 × 160 elements, as points have no limit."""
    rows_ = [333.96, 93.67, 0, 5.85, 93.67, 71.92, 7.92, 14.01, 0, 7.92, 21.46, 11.79, 5.85, 14.01, 11.79, 6.17]

    def model(n: int) -> Model:
        points = [[x, y] for y in (0.5, 3.5, 6.5, 9.5) for x in (0.5, 3.5, 6.5, 9.5)]
        return Model(
            material={"E": 30e9, "nu": 0.2},
            plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
            mesh={"divisions": [n, n]},
            support=[{"at": points, "resists": "down"}],
            load=[{"pressure": 2e3}, {"pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}}],
        )

    points = [
        Number(f"reaction of point {i}", support(0, "points", i - 1, "reaction"), 1e3 * kilo, 5.0)
        for i, kilo in enumerate(rows_, 1)
    ]
    return Case("Slab B", both(model, 20, 40), points)


def next_storey() -> list[Case]:
    """A point load on an infinite plate on soil (Weitsman 1970), and a disc over an obstacle (Brenner et al. 2012)."""
    h, far = 0.01, 200.0

    def infinite(size: float) -> Model:
        points = [[far, 0], arc([0, far], [-far, 0]), arc([0, -far], [far, 0])]
        return Model(
            material={"E": 1 / rigidity(1.0, h), "nu": NU},
            plate={"shape": "polygon", "points": points, "thickness": h},
            mesh={"size": 40.0, "refine": [{"area": {"circle": {"center": [0, 0], "radius": 3.5}}, "size": size}]},
            support=[{"area": "all", "resists": "down", "stiffness": 1.0}],
            load=[{"force": 1.0, "at": [0, 0]}],
            probe=[{"at": [0, 0]}],
        )

    # With R = 200 ℓ the contact radius is 5e-5 smaller. With h = 0.01 the point force adds to the thin plate's
    # deflection.
    weitsman = [
        Number("contact area", support(0, "contact_area"), pi * 2.848918**2, 2 * pi * 2.85 * 6e-5),
        Number("deflection under the force", W, 0.1311657, 2e-3 * 0.1311657),
    ]

    def obstacle(n: int) -> Model:
        return Model(
            material={"E": 1.0, "nu": NU},
            plate={"shape": "disc", "radius": 2, "thickness": 0.01},
            mesh={"divisions": [n, 2 * n]},
            support=[
                {"name": "obstacle", "area": "all", "resists": "down", "settlement": "x**2 + y**2 - 1"},
                {"edge": ["rim"], "fix": "clamped"},
            ],
            load=[{"pressure": 0.0}],
            probe=[{"at": [[0, 0], [0.5, 0], [1, 0], [1.5, 0]]}],
        )

    def free(r: float) -> float:
        return 0.5250406303 * r * r * np.log(r) - 0.6286090479 * r * r + 0.01726640079 * np.log(r) + 1.046746304

    numbers = [Number("deflection at 0", W, -1.0)]
    # Error of the reference, because the modelled plate has the thickness 0.01.
    numbers += [
        Number(f"deflection at {r}", probe(i, "deflection"), -free(r), 2e-5) for i, r in ((1, 0.5), (2, 1), (3, 1.5))
    ]
    return [
        Case("Point load on an infinite plate", both(infinite, 0.25, 0.125), weitsman),
        Case("Clamped disc over an obstacle", both(obstacle, 12, 24), numbers),
    ]


def prop() -> Case:
    """The paper's first example: a quarter of a clamped square that closes a gap at half of its load, on 32 × 32
    elements.
    """

    def model(n: int) -> Model:
        return Model(
            material={"E": 218564.54444273014, "nu": NU},
            plate={"shape": "rectangle", "size": [100, 100], "thickness": 20},
            mesh={"divisions": [n, n]},
            support=[
                {"edge": ["bottom", "left"], "fix": "clamped"},
                {"edge": ["right", "top"], "fix": "symmetry"},
                {"at": [100, 100], "resists": "down", "gap": 0.48e-4},
            ],
            load=[{"pressure": 64e-4}],
        )

    numbers = [
        Number("reaction of the edges", support(0, "reaction"), 58.372066, 5e-6),
        Number("reaction of the prop", support(2, "points", 0, "reaction"), 5.627934, 5e-6),
    ]
    return Case("Clamped quarter over a prop", both(model, 2, 4), numbers)


def cases() -> list[Case]:
    found = [*squares(), *circles(), *skew(), *closed_forms(), *tensionless_cases()]
    return [*found, ssnl130_on_lines(), slab_b(), *next_storey(), prop()]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="cases whose titles have these words")
    parser.add_argument("--check", action="store_true", help="one case, to test the script")
    asked = parser.parse_args()
    chosen = [case for case in cases() if asked.only.lower() in case.title.lower()]
    print("| case | elements | number | value | ± | reference | difference | covered |")
    print("|---|---|---|---|---|---|---|---|")
    for case in chosen[:1] if asked.check else chosen:
        for mesh in (0, 1):
            for row in rows(case, mesh):
                width = "no limit" if row.width is None else f"{row.width:.3g}"
                numbers = f"{row.value:.7g} | {width} | {row.number.reference:.7g} | {row.difference:.2g}"
                verdict = "yes" if row.covered else "NO"
                print(f"| {row.case} | {row.elements} | {row.number.name} | {numbers} | {verdict} |", flush=True)


if __name__ == "__main__":
    main()
