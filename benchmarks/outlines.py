"""Convergence of plates of many outlines, on quadrilaterals and triangles, to closed forms and another program.

Meshes are those of the program: quadrilaterals and a few triangles. In "mixed" half of the quadrilaterals, chosen at
random, are divided into triangles, in "triangles" all. The element size is halved from mesh to mesh.

python benchmarks/outlines.py             prints the table of docs/validation.md
python benchmarks/outlines.py --check     exits with 1 unless every result on the finest meshes is within tolerance

References without closed form are GetFEM's, with 256 elements along a side: `peers/getfem_outlines.py`.
"""

import argparse
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from halving import halved

from signorini import Model, Result, contact_problem
from signorini.analysis.single import solve_one
from signorini.discretise import discretise

E, NU, PRESSURE = 1e7, 0.3, 1.0
PARTS = {"quadrilaterals": 0.0, "mixed": 0.5, "triangles": 1.0}
DEFLECTION, MOMENT = "deflection", "moment"
TOLERANCES = {DEFLECTION: 2e-3, MOMENT: 1e-2}
"""Largest allowed relative errors of deflections and moments on the finest meshes."""


GETFEM = {"L": 1.3009e-5, "hole": 2.2716e-5}
"""Deflections extrapolated by `peers/getfem_outlines.py`, with an error of about 2e-4."""


@dataclass(frozen=True)
class Outline:
    """A plate with its exact deflection and larger moment at one point, and the element sizes of three meshes."""

    title: str
    reference: str
    plate: Mapping[str, object]
    support: list[dict[str, object]]
    at: tuple[float, float]
    exact: Mapping[str, float]
    sizes: tuple[float, float, float]
    nu: float = NU
    corners: tuple[tuple[float, float], ...] = ()
    """corners at which moments grow without limit; elements there have an eighth of the size"""

    def model(self, size: float) -> Model:
        return Model(
            material={"E": E, "nu": self.nu},
            plate=self.plate,
            mesh={"size": size, "refine": [{"at": list(self.corners), "size": size / 8}] if self.corners else []},
            support=self.support,
            load=[{"pressure": PRESSURE}],
            probe=[{"at": self.at}],
        )

    def errors(self, size: float, part: float) -> dict[str, float]:
        """Relative errors on a mesh of this element size, in which a fraction ``part`` of quadrilaterals is divided."""
        model = self.model(size)
        mesh = halved(discretise(model).mesh, part)
        (combination,) = model.effective_combinations
        result = solve_one(contact_problem(discretise(model, mesh)), combination)
        assert result.certificate.passed
        found = figures(result)
        return {name: abs(found[name] / value - 1.0) for name, value in self.exact.items()}


def figures(result: Result) -> dict[str, float]:
    (probe,) = result.probes
    mx, my, mxy = probe.moment
    largest = 0.5 * (mx + my) + np.hypot(0.5 * (mx - my), mxy)
    return {DEFLECTION: probe.deflection, MOMENT: float(largest)}


def rigidity(thickness: float, nu: float = NU) -> float:
    return E * thickness**3 / 12.0 / (1.0 - nu**2)


def shear(thickness: float) -> float:
    return 5.0 / 6.0 * E / 2.0 / (1.0 + NU) * thickness


def polygon(points: object, thickness: float, **given: object) -> dict[str, object]:
    return {"shape": "polygon", "points": points, "thickness": thickness, **given}


def arcs(places: np.ndarray) -> list[object]:
    """Corners and arcs of a closed polygon through points; every second point is the middle of an arc."""
    closed = [*places.tolist(), places[0].tolist()]
    return [closed[0], *({"through": m, "to": b} for m, b in zip(closed[1::2], closed[2::2], strict=True))]


def edges(count: int) -> list[str]:
    return [f"edge {i}" for i in range(1, count + 1)]


def triangle() -> Outline:
    """Hard edges (Timoshenko and Woinowsky-Krieger 1959): w = qa⁴/972D, m = (1 + ν)qa²/54, shear adds qa²/27S."""
    a, h = 3.0, 0.15
    turn = 0.4 + np.radians([0.0, 120.0, 240.0])
    corners = (2.0 * a / 3.0 * np.column_stack([np.cos(turn), np.sin(turn)])).tolist()
    exact = {DEFLECTION: a**4 / 972.0 / rigidity(h) + a**2 / 27.0 / shear(h), MOMENT: (1.0 + NU) * a**2 / 54.0}
    support = [{"edge": edges(3), "fix": "hard"}]
    return Outline(
        "Equilateral triangle, hard", "closed form", polygon(corners, h), support, (0, 0), exact, (0.4, 0.2, 0.1)
    )


def ellipse() -> Outline:
    """Clamped and thin (the same book): w₀ = q/(D(24/a⁴ + 24/b⁴ + 16/a²b²)), w = w₀(1 − x²/a² − y²/b²)²."""
    a, b, h = 2.0, 1.2, 0.005
    turn = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    points = arcs(np.column_stack([a * np.cos(turn), b * np.sin(turn)]))
    rigid = 24.0 / a**4 + 24.0 / b**4 + 16.0 / (a * b) ** 2
    exact = {DEFLECTION: 1.0 / rigidity(h) / rigid, MOMENT: 4.0 / rigid * (1.0 / b**2 + NU / a**2)}
    support = [{"edge": edges(32), "fix": "clamped"}]
    return Outline(
        "Ellipse of arcs, clamped", "closed form", polygon(points, h), support, (0, 0), exact, (0.4, 0.2, 0.1)
    )


def disc() -> Outline:
    """Code_Aster SSLS101, in the middle: w = (5 + ν)/(1 + ν) qR⁴/64D + qR²/4S, m = (3 + ν) qR²/16."""
    h = 0.1
    points = arcs(np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]))
    bending = (5.0 + NU) / (1.0 + NU) / 64.0 / rigidity(h)
    exact = {DEFLECTION: bending + 1.0 / 4.0 / shear(h), MOMENT: (3.0 + NU) / 16.0}
    support = [{"edge": edges(2), "fix": "simple"}]
    return Outline(
        "Disc of arcs, simply supported",
        "closed form",
        polygon(points, h),
        support,
        (0, 0),
        exact,
        (0.25, 0.125, 0.0625),
    )


def pierced() -> Outline:
    """A disc with a round hole, simply supported at the rim: deflection and tangential moment at the hole.

    With Q = −q(r² − b²)/2r the slope is φ = q/2D (r³/8 − b²(r ln r/2 − r/4)) + C r + B/r, Mr = −D(φ' + νφ/r) = 0 at
    both edges, and w(b) = −∫φ + q/2S ((1 − b²)/2 − b² ln(1/b)) from b to the radius 1.
    """
    b, h = 0.4, 0.05
    d, s = rigidity(h), shear(h)

    def own(r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        slope = (r**3 / 8.0 - b**2 * (r * np.log(r) / 2.0 - r / 4.0)) / 2.0 / d
        return slope, (3.0 * r**2 / 8.0 - b**2 * (np.log(r) / 2.0 + 1.0 / 4.0)) / 2.0 / d

    ends = np.array([b, 1.0])
    slope, bend = own(ends)
    rows = np.column_stack([np.full(2, 1.0 + NU), (NU - 1.0) / ends**2])
    linear, inverse = np.linalg.solve(rows, -(bend + NU * slope / ends))
    nodes, weights = np.polynomial.legendre.leggauss(40)
    r = 0.5 * (1.0 + b) + 0.5 * (1.0 - b) * nodes
    bending = -0.5 * (1.0 - b) * weights @ (own(r)[0] + linear * r + inverse / r)
    sheared = ((1.0 - b**2) / 2.0 - b**2 * np.log(1.0 / b)) / 2.0 / s
    at_hole = slope[0] + linear * b + inverse / b
    curved = bend[0] + linear - inverse / b**2
    exact = {DEFLECTION: float(bending + sheared), MOMENT: float(-d * (at_hole / b + NU * curved))}
    plate = {"shape": "disc", "radius": 1.0, "thickness": h, "holes": [{"circle": {"radius": b}}]}
    support = [{"edge": "rim", "fix": "simple"}]
    return Outline("Disc with a round hole", "closed form", plate, support, (0.0, b), exact, (0.2, 0.1, 0.05))


def skew() -> Outline:
    """Razzaque (1973): 60°, two opposite edges simply supported, two free; the soft Mindlin plate of h/L = 0.001."""
    side, h, nu = 100.0, 0.1, 0.31
    along, up = 0.5 * side, np.sqrt(0.75) * side
    corners = [[0.0, 0.0], [side, 0.0], [side + along, float(up)], [along, float(up)]]
    exact = {DEFLECTION: 7.936e-3 * side**4 / rigidity(h, nu)}
    support = [{"edge": ["edge 1", "edge 3"], "fix": "simple"}]
    middle = (0.5 * (side + along), 0.5 * float(up))
    return Outline(
        "Skew plate, 60°",
        "spectral Mindlin solver",
        polygon(corners, h),
        support,
        middle,
        exact,
        (12.5, 6.25, 3.125),
        nu,
    )


def ell() -> Outline:
    corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
    support = [{"edge": edges(6), "fix": "simple"}]
    exact = {DEFLECTION: GETFEM["L"]}
    return Outline(
        "L, simply supported",
        "GetFEM",
        polygon(corners, 0.1),
        support,
        (0.5, 0.5),
        exact,
        (0.2, 0.1, 0.05),
        corners=((1, 1),),
    )


def holed() -> Outline:
    plate = {
        "shape": "rectangle",
        "size": [2, 2],
        "thickness": 0.1,
        "holes": [{"rectangle": [0.75, 0.75, 1.25, 1.25]}],
    }
    support = [{"edge": ["left", "right", "bottom", "top"], "fix": "clamped"}]
    corners = tuple((x, y) for x in (0.75, 1.25) for y in (0.75, 1.25))
    exact = {DEFLECTION: GETFEM["hole"]}
    return Outline(
        "Square with a square hole, clamped",
        "GetFEM",
        plate,
        support,
        (0.75, 1.0),
        exact,
        (0.2, 0.1, 0.05),
        corners=corners,
    )


OUTLINES: tuple[Callable[[], Outline], ...] = (triangle, ellipse, disc, pierced, skew, ell, holed)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    check = parser.parse_args().check
    good = True
    if not check:
        print("| plate | reference | figure | elements | coarse | middle | fine | order |")
        print("|---|---|---|---|---|---|---|---|")
    for case in (make() for make in OUTLINES):
        for kind, part in PARTS.items():
            found = [case.errors(size, part) for size in (case.sizes[2:] if check else case.sizes)]
            for name in case.exact:
                errors = np.array([each[name] for each in found])
                good &= bool(errors[-1] <= TOLERANCES[name])
                if check:
                    print(f"{case.title}, {kind}: error of the {name} {errors[-1]:.1e}")
                    continue
                order = -np.polyfit(range(len(errors)), np.log2(errors), 1)[0]
                values = " | ".join(f"{error:.1e}" for error in errors)
                print(f"| {case.title} | {case.reference} | {name} | {kind} | {values} | {order:.1f} |")
    if check:
        sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
