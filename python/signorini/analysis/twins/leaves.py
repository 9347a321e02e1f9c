"""Numbers of a result by what they are of: support, point, probe; never by a node of the mesh."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from signorini.discretise.rows import Floats
from signorini.errors import point
from signorini.model import Load, MeshPlate, Model, Support
from signorini.model.footprint import footprints
from signorini.results.result import Result

Path = tuple[str | int, ...]

_OF_THE_MESH = {"nodes", "contact_boundary", "max_at", "min_at"}
"""Lists as long as the mesh is fine, and places, of which there may be others as good."""
_OF_VECTOR, _OF_POINTS = 0.5, 0.1
"""Part of the largest change in a vector, and among the points of a support."""
_BENT = 0.01
_GIVEN = {"at"}
_COUNTS = {"closed", "open", "lifted", "lifted_in"}
_LOCAL = {"mx", "my", "mxy", "qx", "qy", "rotation_x", "rotation_y"}
_UNLIMITED = {"deflection", "rotation", "moment", "shear", "pressure"} | _LOCAL


def leaves(figures: Mapping[str, Any]) -> dict[Path, float]:
    """Find every number that another mesh has too, by the keys and indices that lead to it."""
    found: dict[Path, float] = {}
    points = [support["name"] for support in figures["supports"] if "points" in support]
    for path, value in _every(figures, ()):
        at_points = path[0] != "supports" or figures["supports"][path[1]]["name"] in points
        if not _OF_THE_MESH & set(path) and not _GIVEN & set(path) and (path[-1] not in _COUNTS or at_points):
            found[path] = value
    return found


def _every(tree: Any, path: Path) -> Iterator[tuple[Path, float]]:
    match tree:
        case Mapping():
            for key, value in tree.items():
                yield from _every(value, (*path, key))
        case list():
            for index, value in enumerate(tree):
                yield from _every(value, (*path, index))
        case int() | float():
            yield path, float(tree)


def with_numbers(tree: Any, numbers: Mapping[Path, float | None], path: Path = ()) -> Any:
    """Put other numbers in the place of those of a tree: 0 for what the input gives, None for what is not there."""
    match tree:
        case Mapping():
            return {key: with_numbers(value, numbers, (*path, key)) for key, value in tree.items()}
        case list():
            return [with_numbers(value, numbers, (*path, index)) for index, value in enumerate(tree)]
        case int() | float():
            # What is the input's own has none.
            given = _GIVEN & set(path) and not _OF_THE_MESH & set(path)
            return 0.0 if given else numbers.get(path)
        case _:
            return tree


def beside(paths: Sequence[Path], changes: Floats) -> Floats:
    """Changes (n,) that numbers count as at least, by the largest of those that were found with them.

    Components of a vector turn into each other; points of one support share what acts on it.
    """
    groups = [
        path[:-1] if isinstance(path[-1], int) else (*path[:3], *path[4:]) if "points" in path else path
        for path in paths
    ]
    most: dict[Path, float] = {}
    for group, change in zip(groups, np.nan_to_num(changes).tolist(), strict=True):
        most[group] = max(most.get(group, 0.0), change)
    return np.array(
        [
            most[group] * (_OF_VECTOR if isinstance(path[-1], int) else _OF_POINTS)
            for path, group in zip(paths, groups, strict=True)
        ]
    )


def kind_of(path: Path) -> str:
    """The field that a number is of."""
    names = [part for part in path if isinstance(part, str)]
    return "deflection" if names[-1] in ("max", "min", "gap") else names[-1]


def acts_at_points(model: Model) -> bool:
    """Whether a force, a couple or a support acts at a point, not on a footprint."""
    items: tuple[Load | Support, ...] = (*model.load, *model.support)
    return any(_points(item) for item in items) or _rolls_on_points(model)


def _points(item: Load | Support) -> Sequence[tuple[float, float]]:
    return () if item.at is None or footprints(item) else item.at


def _rolls_on_points(model: Model) -> bool:
    return any(moving.patch is None for moving in model.moving)


def may_grow(path: Path, figures: Mapping[str, Any], model: Model, reach: float) -> bool:
    """Whether a number may grow for ever as the mesh is refined.

    At probes it may within reach of what acts at a point, and of the ends of a line, or where nobody knows the corners
    of a mesh that was read; the largest pressure of a rigid area may at its edge; envelopes have all of these.
    """
    if "max_pressure" in path:
        return model.support[int(path[1])].stiffness is None
    if path[0] == "fields":
        return acts_at_points(model) and path[1] in _LOCAL
    if path[0] != "probes" or not _UNLIMITED & set(path):
        return False
    if isinstance(model.plate, MeshPlate) or _rolls_on_points(model):
        return True
    items: tuple[Load | Support, ...] = (*model.load, *model.support)
    places = [place for item in items for place in _points(item) or item.line or ()]
    return any(math.dist(figures["probes"][int(path[1])]["at"], place) <= reach for place in places)


def largest_of(result: Result) -> dict[str, float]:
    """The largest number of every field, in each of which rounding and growth are judged.

    A plate that only moves has moments by rounding: a hundredth of what bending to its deflection takes counts too.
    """

    def size(values: Floats) -> float:
        return float(np.abs(values).max(initial=0.0))

    model, span, moved = result.model, result.mesh.size, size(result.deflection)
    rigidity = model.material.young * size(model.plate.thickness(*result.mesh.points.T)) ** 3 / 12
    pressures = [support.max_pressure or 0.0 for support in result.supports]
    return {
        "deflection": moved,
        "rotation": max(size(result.rotation), _BENT * moved / span),
        "moment": max(size(result.moment), _BENT * rigidity * moved / span**2),
        "shear": max(size(result.shear), _BENT * rigidity * moved / span**3),
        "reaction": float(sum(np.abs(support.reactions).sum() for support in result.supports)),
        "pressure": size(np.array(pressures)),
        "max_pressure": size(np.array(pressures)),
        "contact_area": float(result.mesh.element_area.sum()),
        "closed": 0.0,
        "open": 0.0,
    }


def named(paths: Sequence[Path], figures: Mapping[str, Any]) -> str:
    """Name numbers in words."""
    said: dict[str, list[str]] = {}
    for path in paths:
        match path:
            case ("probes", int(index), key, *rest):
                whose = f"the probe at {point(figures['probes'][index]['at'])}"
                what = _COMPONENTS[str(key)][int(str(rest[0]))] if rest else str(key)
            case ("supports", int(index), *rest):
                whose = figures["supports"][index]["name"]
                what = " ".join(f"of point {part + 1}" if isinstance(part, int) else str(part) for part in rest[::-1])
                what = what.replace("_", " ").removesuffix(" points")
            case _:
                whose, what = "the plate", f"{path[-1]} {path[0]}"
        said.setdefault(whose, []).append(what)
    return "; ".join(f"of {whose} {', '.join(what)}" for whose, what in said.items())


_COMPONENTS = {"rotation": ("θx", "θy"), "moment": ("mx", "my", "mxy"), "shear": ("qx", "qy")}
