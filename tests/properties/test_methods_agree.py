"""Lemke's algorithm and the active set, on K and as a saddle-point system, give one solution."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

import signorini
from signorini import Model, NoEquilibriumError

PLATES = range(30)


def load_benchmark() -> ModuleType:
    path = Path(__file__).parents[2] / "benchmarks" / "methods_agree.py"
    spec = importlib.util.spec_from_file_location("methods_agree", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


benchmark = load_benchmark()


def table(method: str, **changes) -> dict:
    """A slab on soil, bearings that push and anchors that pull; some of each let go."""
    return {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [10, 6], "thickness": 0.25},
        "mesh": {"divisions": [8, 5]},
        "support": [
            {"name": "soil", "area": "all", "resists": "down", "stiffness": 2e6, "gap": "1e-4 * x"},
            {"name": "pads", "at": [[2, 2], [8, 2], [5.13, 4.77]], "resists": "down", "gap": 5e-4},
            {"name": "anchors", "at": [[0.5, 5.5], [9.5, 5.5]], "resists": "up"},
        ],
        "load": [{"pressure": 3e3}, {"force": 4e5, "at": [8.2, 1.1]}],
        "solver": {"method": method},
        **changes,
    }


def test_random_plates_are_solved_alike_by_every_method() -> None:
    found = [benchmark.compare(plate) for plate in PLATES]
    assert [c for c in found for method in benchmark.METHODS if not c.agrees(method)] == []


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_every_method_says_that_supports_contradict_each_other(method: str) -> None:
    """On a side of an element, a parabola cannot zigzag between pads 10 mm high and anchors 10 mm deep."""
    first, second, third, last = ([3.75 + 1.25 * t / 3, 2.4] for t in range(4))
    supports = [
        {"at": [[1, 1], [9, 1], [5, 5]], "resists": "down"},
        {"at": [first, third], "resists": "down", "settlement": -0.01},
        {"at": [second, last], "resists": "up", "settlement": 0.01},
    ]
    with pytest.raises(NoEquilibriumError, match="contradict each other"):
        signorini.solve(Model(**table(method, support=supports)))
