"""Models that tests and benchmarks share: slab A, and a quarter of a square."""

from __future__ import annotations

from collections.abc import Mapping

from signorini import Model, Result

SOIL = {"name": "soil", "area": "all", "resists": "down"}


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
