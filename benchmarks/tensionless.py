"""Plates on supports that only push, with known answers, for tests and benchmarks.

Each `Case` makes a model for a mesh of n elements along a side, reads quantities from its result, and has their
reference values. `slab_a` and `quarter_square` are base models of other cases.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from signorini import Model, Result

SOIL = {"name": "soil", "area": "all", "resists": "down"}


@dataclass(frozen=True)
class Case:
    """A model with a known answer.

    Parameters
    ----------
    title, reference : str
        Description of the plate, and source of the answer.
    model : function of n
        Makes the model with n elements along the longer side, or along half or a quarter of it.
    figures : function of a Result
        Returns the compared quantities by name.
    exact : mapping
        Reference values, by the same names.
    rounding : mapping
        Half a unit of the reference's last digit, by the same names; empty for a closed form.
    divisions : tuple of int
        Values of n in the convergence picture, coarse to fine.
    """

    title: str
    reference: str
    model: Callable[[int], Model]
    figures: Callable[[Result], dict[str, float]]
    exact: Mapping[str, float]
    rounding: Mapping[str, float]
    divisions: tuple[int, ...]

    def errors(self, result: Result) -> dict[str, float]:
        """Relative error of each quantity by name."""
        return {name: abs(value / self.exact[name] - 1) for name, value in self.figures(result).items()}

    def floor(self, name: str) -> float:
        """Half a unit of the last digit of a quantity's reference, relative to the reference."""
        return self.rounding.get(name, 0.0) / abs(self.exact[name])


def area(result: Result) -> float:
    """Contact area of the first support."""
    found = result.supports[0].contact_area
    assert found is not None
    return found


def pressure(result: Result) -> float:
    """Largest pressure of the first support."""
    found = result.supports[0].max_pressure
    assert found is not None
    return found


def slab_a(n: int, method: str = "auto", resists: str = "down") -> Model:
    """Concrete slab 10 m × 10 m × 0.3 m on soil, under 2 kPa on the whole slab and 500 kN near a corner."""
    return Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        mesh={"divisions": [n, n]},
        support=[{**SOIL, "resists": resists, "stiffness": 30e6}],
        load=[{"pressure": 2e3}, {"pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}}],
        solver={"method": method},
    )


def slab_a_figures(result: Result) -> dict[str, float]:
    """Settlement [m], fraction of the area in contact, largest pressure [Pa]."""
    return {
        "settlement": float(result.deflection.max()),
        "contact": area(result) / 100,
        "pressure": pressure(result),
    }


def quarter_square(
    support: Mapping[str, object], thickness: float, n: int, element: str = "mitc9", twist_held: bool = False
) -> Model:
    """Quarter of a unit square under p = 1, with E = 1, ν = 0.3 and n × n elements.

    The plate's middle is the corner (0, 0), and its edges are at x = 1/2 and y = 1/2. ``twist_held`` makes them hard
    simple supports.
    """
    edges = {"edge": ["right", "top"]}
    return Model(
        material={"E": 1.0, "nu": 0.3},
        plate={"shape": "rectangle", "size": [0.5, 0.5], "thickness": thickness, "element": element},
        mesh={"divisions": [n, n]},
        support=[
            {"name": "edges", **edges, **support},
            {"name": "middle lines", "edge": ["left", "bottom"], "fix": "symmetry"},
            *([{"name": "hard", **edges, "fix": ["twist"]}] if twist_held else []),
        ],
        load=[{"pressure": 1.0}],
        probe=[{"at": [[0, 0], [0.5, 0.5]]}],
    )


def strip() -> Case:
    """Thin strip on soil with EI = k = 1, so that ℓ = 1, and ν = 0, under a central line load of 1."""
    thickness, width, lam = 0.005, 0.5, 1 / np.sqrt(2)
    peak = 1 / np.tanh(np.pi / 2)

    def model(n: int) -> Model:
        return Model(
            material={"E": 12 / thickness**3, "nu": 0},
            plate={"shape": "rectangle", "size": [12, width], "origin": [-6, 0], "thickness": thickness},
            mesh={"divisions": [n, 2]},
            support=[{**SOIL, "stiffness": 1}],
            load=[{"line_load": 1, "line": [[0, 0], [0, width]]}],
            probe=[{"at": [0, width / 2]}],
        )

    def figures(result: Result) -> dict[str, float]:
        middle = result.probes[0]
        return {
            "contact half-length": area(result) / width / 2,
            "deflection": middle.deflection,
            "moment": middle.moment[0],
        }

    exact = {"contact half-length": np.pi * lam, "deflection": peak * lam / 2, "moment": peak / (4 * lam)}
    return Case("Long strip, line load", "beam, closed form", model, figures, exact, {}, (20, 40, 80, 160, 320))


def disc(radius: float, contact: float, centre: float, rim: float) -> Case:
    """Free thin disc on a one-sided bed under a central force 1; bending stiffness D = 1, bed stiffness k = 1."""

    def model(n: int) -> Model:
        return Model(
            material={"E": 12 * (1 - 0.09) / 0.01**3, "nu": 0.3},
            plate={"shape": "disc", "radius": radius, "thickness": 0.01},
            mesh={"divisions": [n, 4 * n]},
            support=[{**SOIL, "stiffness": 1}],
            load=[{"force": 1, "at": [0, 0]}],
            probe=[{"at": [[0, 0], [radius, 0]]}],
        )

    def figures(result: Result) -> dict[str, float]:
        middle, edge = result.probes
        return {
            "contact radius": float(np.sqrt(area(result) / np.pi)),
            "deflection": middle.deflection,
            "rim uplift": -edge.deflection,
        }

    exact = {"contact radius": contact, "deflection": centre, "rim uplift": -rim}
    rounding = dict.fromkeys(exact, 0.5e-6)
    return Case(f"Disc, R = {radius:g} ℓ", "Kelvin functions", model, figures, exact, rounding, (4, 8, 16, 32, 64))


def square(thickness: float, centre: float, moment: float, uplift: float) -> Case:
    """Square of side 1 under p = 1 on rigid edges that only push up; deflections times D."""
    rigidity = thickness**3 / 12 / (1 - 0.3**2)

    def figures(result: Result) -> dict[str, float]:
        middle, corner = result.probes
        return {
            "deflection": middle.deflection * rigidity,
            "moment": middle.moment[0],
            "corner uplift": -corner.deflection * rigidity,
        }

    exact = {"deflection": centre, "moment": moment, "corner uplift": uplift}
    title = f"Square on one-sided edges, h/a = {thickness:g}"
    return Case(
        title,
        "spectral Mindlin solver",
        lambda n: quarter_square({"resists": "down"}, thickness, n),
        figures,
        exact,
        {"deflection": 0.5e-6, "moment": 0.5e-5, "corner uplift": 0.5e-6},
        (5, 10, 20, 40, 80),
    )


def ssnl130() -> Case:
    """Code_Aster SSNL130 (V6.02.130) on a continuous bed: near-rigid plate 1 m × 2 m × 0.3 m."""

    def model(n: int) -> Model:
        return Model(
            material={"E": 2e11, "nu": 0},
            plate={"shape": "rectangle", "size": [1, 2], "thickness": 0.3},
            mesh={"divisions": [max(1, n // 2), n]},
            support=[{**SOIL, "stiffness": 5e3}],
            load=[{"pressure": "5*(y-2)**2"}],
            probe=[{"at": [[0.5, 0], [0.5, 2]]}],
        )

    def figures(result: Result) -> dict[str, float]:
        near, far = (probe.deflection for probe in result.probes)
        return {"deflection at 0": near, "uplift at 2": -far, "contact length": area(result)}

    exact = {"deflection at 0": 4 / 1125, "uplift at 2": 4 / 3375, "contact length": 1.5}
    return Case("SSNL130, continuous bed", "Code_Aster V6.02.130", model, figures, exact, {}, (2, 5, 10, 21, 42))


def footing() -> Case:
    """Rigid square footing of side 2 under a force whose distance from the middle is a quarter of the side."""

    def model(n: int) -> Model:
        return Model(
            material={"E": 1e12, "nu": 0.2},
            plate={"shape": "rectangle", "size": [2, 2], "thickness": 1},
            mesh={"divisions": [n, n]},
            support=[{**SOIL, "stiffness": 1e6}],
            load=[{"force": 1e3, "at": [1.5, 1]}],
        )

    def figures(result: Result) -> dict[str, float]:
        return {"contact": area(result), "pressure": pressure(result)}

    exact = {"contact": 0.75 * 4, "pressure": 8 / 3 * 1e3 / 4}
    return Case("Rigid footing, e = B/4", "closed form", model, figures, exact, {}, (2, 5, 10, 21, 42))


def base_plate() -> Case:
    """Rigid base plate 0.6 m × 0.4 m on grout that takes no tension, with two anchor bolts."""

    def model(n: int) -> Model:
        return Model(
            material={"E": 2e16, "nu": 0.3},
            plate={"shape": "rectangle", "size": [0.6, 0.4], "origin": [-0.3, -0.2], "thickness": 0.1},
            mesh={"divisions": [n, max(1, 2 * n // 3)]},
            support=[
                {**SOIL, "stiffness": 1e10},
                {"name": "bolts", "at": [[-0.25, -0.1], [-0.25, 0.1]], "resists": "up", "stiffness": 2e8},
            ],
            load=[{"force": 500e3, "at": [0.3, 0]}, {"moment": [500e3 * 0.05, 0], "at": [0, 0]}],
        )

    def figures(result: Result) -> dict[str, float]:
        return {
            "compressed length": area(result) / 0.4,
            "bolt force": -result.reactions["bolts"],
            "pressure": pressure(result),
        }

    exact = {"compressed length": 0.362679, "bolt force": 199.126e3, "pressure": 9.638e6}
    rounding = {"compressed length": 0.5e-6, "bolt force": 0.5, "pressure": 0.5e3}
    return Case("Rigid base plate with bolts", "equilibrium", model, figures, exact, rounding, (3, 6, 12, 24, 48))


def slab() -> Case:
    """Slab A, compared with this program's finest mesh; other programs agree with it to four digits."""
    exact = {"settlement": 4.228876e-3, "contact": 0.9170725, "pressure": 126.8663e3}
    rounding = {name: 2e-6 * value for name, value in exact.items()}
    return Case("Slab A", "our own 320 × 320", slab_a, slab_a_figures, exact, rounding, (10, 20, 40, 80, 160))


STRIP, SSNL130, FOOTING, BASE_PLATE, SLAB_A = strip(), ssnl130(), footing(), base_plate(), slab()
DISC_3 = disc(3, contact=2.672175, centre=0.136545, rim=-0.013917)
DISC_5 = disc(5, contact=2.773571, centre=0.133210, rim=-0.066287)
THICK_SQUARE = square(0.1, centre=0.004805, moment=0.05275, uplift=6.62e-4)
THIN_SQUARE = square(0.01, centre=0.004402, moment=0.05103, uplift=7.43e-4)
CASES = (STRIP, DISC_3, DISC_5, THICK_SQUARE, THIN_SQUARE, SSNL130, FOOTING, BASE_PLATE, SLAB_A)
