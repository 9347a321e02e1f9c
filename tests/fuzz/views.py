"""Solve a random plate also in other units, moved, mirrored and rotated by 90°: mesh and answer must be the same.

python tests/fuzz/views.py [--count 1000] [--first 0] [--seconds 600] [--processes 2]
python tests/fuzz/views.py --show SEED     the model of a seed, and its differences in the views
"""

from __future__ import annotations

import functools
import itertools
import json
import math
import sys
from collections import Counter
from dataclasses import dataclass
from random import Random
from typing import Any

import campaign
import numpy as np
from scipy.spatial import cKDTree

from signorini import InputError, Model, NoEquilibriumError, solve
from signorini.discretise import discretise
from signorini.discretise.meshing import mesh_of
from signorini.mesh import Mesh

Tables = dict[str, Any]
Point = tuple[float, float]

_SAME = 1e-9
"""Tolerance for nodes, relative to the plate's size: coordinates are rounded to 2⁻⁴⁰ of it."""
_ALIKE = 1e-3
"""Tolerance for a number on the same mesh, relative to the largest of its kind. Elements cut by outlines are integrated
in strips along y, and elements cut by zones are laminates; both are accurate to about 1e-4."""


@dataclass(frozen=True)
class View:
    """Description of a plate in other axes, another origin and another unit of length."""

    axes: tuple[Point, Point] = ((1, 0), (0, 1))
    shift: Point = (0.0, 0.0)
    unit: float = 1.0

    def at(self, x: float, y: float) -> list[float]:
        """Coordinates of a point in the view."""
        return [self.unit * (u * x + v * y + s) for (u, v), s in zip(self.axes, self.shift, strict=True)]

    def box(self, x0: float, y0: float, x1: float, y1: float) -> list[float]:
        """Smallest and largest coordinates in the view of a rectangle parallel to the axes."""
        return [*map(min, *(ends := [self.at(x0, y0), self.at(x1, y1)])), *map(max, *ends)]

    def sides(self, a: Any, b: Any) -> list[Any]:
        """Order two values along x and y by the axes of the view."""
        return [a, b] if self.axes[0][0] else [b, a]

    def edge(self, name: str) -> str:
        """Name of an edge of a rectangle in the view."""
        outward = {"left": (-1, 0), "right": (1, 0), "bottom": (0, -1), "top": (0, 1)}
        x, y = outward[name]
        seen = tuple(u * x + v * y for u, v in self.axes)
        return next(other for other, way in outward.items() if way == seen)


VIEWS = {
    "feet": View(unit=0.3048),
    "millimetres": View(unit=1000.0),
    "thousandths": View(unit=1e-3),
    "halves": View(unit=0.5),
    "moved": View(shift=(37.3, -11.9)),
    "mirrored": View(((-1, 0), (0, 1))),
    "mirrored up": View(((1, 0), (0, -1)), (0.0, 4.1)),
    "turned": View(((0, -1), (1, 0))),
    "transposed in feet": View(((0, 1), (1, 0)), (3.3, 1.7), 0.3048),
}


def tables(rng: Random, view: View) -> Tables:
    """Draw a plate with supports and loads in a view; random choices do not depend on the view."""
    nice = rng.random() < 0.6
    width, height = rng.choice([(8.0, 8.0), (8.0, 6.0), (10.0, 4.0), (6.0, 9.0)])

    def number(low: float, high: float) -> float:
        drawn = rng.uniform(low, high)
        return round(2 * drawn, 1) / 2 if nice else drawn

    def spot() -> Point:
        return number(0.08 * width, 0.92 * width), number(0.08 * height, 0.92 * height)

    def circle(center: Point, radius: float) -> Tables:
        return {"center": view.at(*center), "radius": view.unit * radius}

    def area() -> Tables:
        (x, y), a, b = spot(), number(0.2, 1.5), number(0.2, 1.5)
        match rng.choice(["rectangle", "circle", "polygon"]):
            case "rectangle":
                return {"rectangle": view.box(x, y, x + a, y + b)}
            case "circle":
                return {"circle": circle((x, y), a)}
            case _:
                return {"polygon": [view.at(x, y), view.at(x + a, y + 0.3), view.at(x + 0.2, y + b)]}

    def place(kinds: list[str]) -> Tables:
        match rng.choice(kinds):
            case "at":
                return {"at": [view.at(*spot()) for _ in range(rng.choice([1, 2, 4]))]}
            case "pad":
                return {"at": [view.at(*spot())], "radius": view.unit * number(0.1, 0.4)}
            case "line":
                (x, y), b = spot(), spot()
                return {"line": [view.at(x, y), view.at(*rng.choice([b, (x, y + 1.0), (x + 1.0, y)]))]}
            case "circle":
                return {"circle": circle(spot(), number(0.3, 2.0))}
            case "edge":
                return {"edge": [rng.choice(edges)]}
            case _:
                return {"area": area()}

    match rng.choice(["rectangle", "rectangle", "steps", "star", "disc", "annulus"]):
        case "rectangle":
            x0, y0, x1, y1 = view.box(0.0, 0.0, width, height)
            plate = {"shape": "rectangle", "origin": [x0, y0], "size": [x1 - x0, y1 - y0]}
            edges, rows = [view.edge(name) for name in ("left", "right", "bottom", "top")], (rng.randint(3, 9), 5)
            divisions = view.sides(*rows)
        case "disc":
            plate = {"shape": "disc", **circle((0.5 * width, 0.5 * height), 0.5 * min(width, height))}
            edges, divisions = ["rim"], [rng.randint(3, 6), rng.randint(9, 24)]
        case "annulus":
            inner, outer = 0.15 * min(width, height), 0.5 * min(width, height)
            plate = {"shape": "annulus", "inner": view.unit * inner, "outer": view.unit * outer}
            plate |= {"center": view.at(0.5 * width, 0.5 * height)}
            edges, divisions = ["inner", "outer"], [rng.randint(2, 5), rng.randint(9, 20)]
        case "steps":
            x, y = number(0.3 * width, 0.7 * width), number(0.3 * height, 0.7 * height)
            corners = [(0, 0), (width, 0), (width, y), (x, y), (x, height), (0, height)]
            plate, edges, divisions = {"shape": "polygon", "points": [view.at(*p) for p in corners]}, ["edge 4"], None
        case _:
            turns = sorted(rng.uniform(0.0, math.tau) for _ in range(rng.randint(5, 9)))
            radii = [rng.uniform(0.7, 1.0) for _ in turns]
            corners = [
                (0.5 * width * (1 + r * math.cos(t)), 0.5 * height * (1 + r * math.sin(t)))
                for r, t in zip(radii, turns, strict=True)
            ]
            points: list[Any] = [view.at(*corner) for corner in corners]
            if rng.random() < 0.5:
                (a, b), (c, d), bend = corners[-1], corners[0], rng.uniform(-0.1, 0.2)
                through = 0.5 * (a + c) + bend * (d - b), 0.5 * (b + d) - bend * (c - a)
                points.append({"through": view.at(*through), "to": view.at(*corners[0])})
            plate, edges, divisions = {"shape": "polygon", "points": points}, ["edge 1", "edge 2"], None
    if rng.random() < 0.4:
        x, y = rng.choice([(0.5 * width, 0.5 * height), spot()])
        holes = [{"rectangle": view.box(x - 0.5, y - 0.4, x + 0.5, y + 0.4)}, {"circle": circle((x, y), 0.6)}]
        plate["holes"], divisions = [rng.choice(holes)], None
    refine = []
    if rng.random() < 0.3:
        refine.append({**rng.choice([{"at": view.at(*spot())}, {"area": area()}]), "size": view.unit * 0.2})
        divisions = divisions if plate["shape"] == "rectangle" else None
    size = rng.choice([0.4, 0.5, 0.7, 1.0])
    mesh: Tables = {"refine": refine}
    mesh |= {"size": view.unit * size} if divisions is None or rng.random() < 0.5 else {"divisions": divisions}
    u, young, thickness = view.unit, 3e7, 0.2
    stiff = young * thickness**3 / 12
    # Soil under the whole plate keeps it from tipping.
    supports: list[Tables] = [{"area": "all", "stiffness": stiff * 0.1 / u**3}]
    supports[0]["resists"] = rng.choice(["down", "both"])
    for _ in range(rng.randint(1, 4)):
        where = place(["at", "pad", "line", "line", "circle", "edge", "area"])
        power = 2 if "at" in where else 4 if "area" in where else 3
        supports.append(where | {"stiffness": stiff * rng.choice([1.0, 30.0]) * u ** -(power - 1)})
        supports[-1] |= {"resists": rng.choice(["down", "down", "both"]), "gap": u * rng.choice([0.0, 0.0, 1e-4])}
    loads: list[Tables] = [{"pressure": 30.0 / u**2}]
    for _ in range(rng.randint(0, 3)):
        match rng.choice(["force", "pressure", "line_load"]):
            case "force":
                loads.append({"force": 100.0, **place(["at", "pad"])})
            case "pressure":
                loads.append({"pressure": 50.0 / u**2, "area": area()})
            case _:
                loads.append({"line_load": 70.0 / u, **place(["line", "circle", "edge"])})
    found: Tables = {
        "material": {"E": young / u**2, "nu": 0.2},
        "plate": {**plate, "thickness": u * thickness},
        "mesh": mesh,
        "support": supports,
        "load": loads,
    }
    if rng.random() < 0.4:
        found["zone"] = [{"area": area(), "thickness": u * 1.5 * thickness}]
    if rng.random() < 0.2:
        found["section"] = [{"line": [view.at(*spot()), view.at(*spot())]}]
    return found


@functools.cache
def refused(seed: int) -> frozenset[tuple[str, int]] | None:
    """Tables of a seed, as (key, index), that are off the plate; None if the seed gives no plate."""
    gone: frozenset[tuple[str, int]] = frozenset()
    while True:
        try:
            discretise(Model.model_validate(_without(tables(Random(seed), View()), gone)))
        except InputError as error:
            more = {part.path[:2] for part in error.parts if part.path}
            if not more or not all(len(path) == 2 for path in more) or more <= gone:
                return None
            gone |= more  # type: ignore[assignment]
        else:
            return gone


def _without(found: Tables, gone: frozenset[tuple[str, Any]]) -> Tables:
    holes = {"holes": []} if ("plate", "holes") in gone else {}
    lists = {
        key: [item for index, item in enumerate(items) if (key, index) not in gone]
        for key, items in found.items()
        if isinstance(items, list)
    }
    return {**found, **lists, "plate": {**found["plate"], **holes}}


def seen(seed: int, view: View) -> Model | None:
    """The plate of a seed in a view, with all tables that are on it."""
    gone = refused(seed)
    return None if gone is None else Model.model_validate(_without(tables(Random(seed), view), gone))


def same_mesh(mesh: Mesh, other: Mesh, unit: float) -> bool:
    """Whether a mesh equals another in other units, mirrored or rotated: same elements, same node positions.

    If a plate is symmetric with all its tables, any mirror image counts as equal.
    """
    if (mesh.node_count, len(mesh.elements)) != (other.node_count, len(other.elements)):
        return False
    tree, points = cKDTree((other.points - other.middle) / unit), mesh.points - mesh.middle
    for axes in itertools.product([1.0, -1.0], [1.0, -1.0], [[0, 1], [1, 0]]):
        away, node = tree.query((points * axes[:2])[:, axes[2]])
        one, two = (np.sort(elements, axis=1) for elements in (node[mesh.elements], other.elements))
        if away.max() <= _SAME * mesh.size and (one[np.lexsort(one.T)] == two[np.lexsort(two.T)]).all():
            return True
    return False


def answer(model: Model, view: View) -> dict[str, np.ndarray] | str:
    """Numbers of a solve in the plate's own axes: an array of each kind, compared relative to its largest entry."""
    try:
        (result,) = solve(model).values()
    except NoEquilibriumError:
        return "no equilibrium"
    assert result.certificate.passed
    u, most = view.unit, {name: max(abs(e.min), abs(e.max)) for name, e in result.extremes.items()}
    parts = result.supports
    return {
        "reactions": np.array([part.reaction for part in parts]),
        "deflections": np.array([most["deflection"]]) / u,
        "moments": np.array([*view.sides(most["mx"], most["my"]), most["mxy"]]),
        "shears": np.array(view.sides(most["qx"], most["qy"])) * u,
        "contact areas": np.array([part.contact_area or 0.0 for part in parts]) / u**2,
    }


def differing(seed: int, name: str, solved: bool) -> list[str]:
    """Differences between the plate of a seed and its view."""
    view = VIEWS[name]
    model, other = (seen(seed, one) for one in (View(), view))
    if model is None or other is None:
        return []
    if not same_mesh(mesh_of(model)[0], mesh_of(other)[0], view.unit):
        return [f"{name}: another mesh"]
    if not solved:
        return []
    one, two = _first(seed), answer(other, view)
    if isinstance(one, str) or isinstance(two, str):
        return [] if one == two else [f"{name}: another outcome"]
    wrong = []
    for kind, values in one.items():
        # If a plate hardly bends, its moments are rounding.
        scale = max(
            np.abs(values).max(initial=0.0), 1e-3 * np.abs(one["reactions"]).max() * (kind in ("moments", "shears"))
        )
        off = np.abs(two[kind] - values).max(initial=0.0)
        wrong += [f"{name}: {kind} by {off / scale:.1e}"] if off > _ALIKE * scale else []
    return wrong


@functools.lru_cache(1)
def _first(seed: int) -> dict[str, np.ndarray] | str:
    model = seen(seed, View())
    assert model is not None
    return answer(model, View())


def one(seed: int) -> tuple[Counter[str], list[str]]:
    """Mesh and solve the plate of a seed in every view; return outcomes and differences."""
    if refused(seed) is None:
        return Counter({"no plate": 1}), []
    wrong = [text for name in VIEWS for text in differing(seed, name, solved=True)]
    return Counter({"plates": 1}) + Counter(" ".join(text.split()[:3]) for text in wrong), wrong


def show(seed: int) -> None:
    """Print the model of a seed."""
    print(json.dumps(_without(tables(Random(seed), View()), refused(seed) or frozenset()), indent=1))


if __name__ == "__main__":
    sys.exit(campaign.main(__doc__, one, show, count=1000))
