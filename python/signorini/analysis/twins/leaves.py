"""Numbers of a result by what they are of: support, point, probe; never by a node of the mesh."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from signorini.discretise.rows import Floats
from signorini.errors import point
from signorini.model import Load, Model, Support
from signorini.model.footprint import footprints
from signorini.results.result import Result
from signorini.shapes.distances import distances
from signorini.singularities.named import Singularity

Path = tuple[str | int, ...]

_OF_THE_MESH = {"nodes", "contact_boundary", "max_at", "min_at"}
"""Lists as long as the mesh is fine, and places, of which there may be others as good."""
_OF_VECTOR, _OF_POINTS = 0.5, 0.1
"""Part of the largest change in a vector, and among the points of a support."""
_BENT = 0.01
_GIVEN = {"at"}
_COUNTS = {"closed", "open", "lifted", "lifted_in"}
_FIELD_OF = dict.fromkeys(("mx", "my", "mxy"), "moment") | dict.fromkeys(("qx", "qy"), "shear")
_FIELD_OF |= dict.fromkeys(("rotation_x", "rotation_y"), "rotation")
_OF_MOMENTS = ("principal_moment", "design_moment")
_ANGLE = "principal_moment", 2
"""Turns by 180° where both principal moments are equal, however fine the mesh."""
_FIELD_OF |= dict.fromkeys(_OF_MOMENTS, "moment")
_FIELD_OF |= dict.fromkeys(("contact_pressure", "rigid_contact_pressure"), "pressure")


def leaves(figures: Mapping[str, Any]) -> dict[Path, float]:
    """Find every number that another mesh has too, by the keys and indices that lead to it."""
    found: dict[Path, float] = {}
    points = [support["name"] for support in figures["supports"] if "points" in support]
    for path, value in _every(figures, ()):
        at_points = path[0] != "supports" or figures["supports"][path[1]]["name"] in points
        told = path[-2:] != _ANGLE and (path[-1] not in _COUNTS or at_points)
        if told and not (_OF_THE_MESH | _GIVEN) & set(path):
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
    if names[0] == "fields" or names[1] in _OF_MOMENTS:
        return _FIELD_OF.get(names[1], names[1])
    return "deflection" if names[-1] in ("max", "min", "gap") else names[-1]


def acts_at_points(model: Model) -> bool:
    """Whether a force, a couple or a support acts at a point, not on a footprint."""
    items: tuple[Load | Support, ...] = (*model.load, *model.support)
    points = any(item.at is not None and not footprints(item) for item in items)
    return points or any(moving.patch is None for moving in model.moving)


def may_grow(path: Path, figures: Mapping[str, Any], singular: Sequence[Singularity], reach: float) -> bool:
    """Whether a number may grow for ever as the mesh is refined: it is of what a singularity within reach is named for.

    Of supports it is one of their own, of envelopes one anywhere. Where supports at points give way the whole plate
    moves, and extremes of the deflection are wherever they are.
    """
    supports = {support["name"] for support in figures["supports"]}
    kind = "pressure" if {"max_pressure", "max_tension"} & set(path) else kind_of(path)
    if path[0] == "probes" and isinstance(path[2], str):
        kind = _FIELD_OF.get(path[2], kind)
    for one in singular:
        if "deflection" in one.numbers and one.source in supports and kind in ("deflection", "rotation"):
            return True
        if kind not in one.numbers:
            continue
        if path[0] in ("fields", "deflection") or (
            path[0] == "supports" and one.source == figures["supports"][path[1]]["name"]
        ):
            return True
        if path[0] == "probes" and away(figures["probes"][path[1]]["at"], one) <= max(reach, one.within):
            return True
    return False


def away(at: Sequence[float], singularity: Singularity) -> float:
    """Distance of a point from a singularity."""
    where = np.array(singularity.where).reshape(-1, 2)
    begin, end = (where[:-1], where[1:]) if singularity.line else (where, where)
    return float(distances(np.array([at]), begin, end).min(initial=math.inf))


def largest_of(result: Result, gaps: float = 0.0) -> dict[str, float]:
    """The largest number of every field, in each of which rounding and growth are judged.

    A plate that only moves has moments by rounding: a hundredth of what bending to its deflection takes counts too. So
    does a hundredth of gaps as movement where rounding is judged, since deflections are told beside them.
    """

    def size(values: Floats) -> float:
        return float(np.abs(values).max(initial=0.0))

    model, span, moved = result.model, result.mesh.size, max(size(result.deflection), _BENT * gaps)
    points = result.mesh.points
    for zone in model.zone:
        # The plate's own thickness need not be one where zones have another.
        points = points[~zone.region.contains(points)] if zone.thickness is not None else points
    rigidity = model.young * size(model.plate.thickness(*points.T)) ** 3 / 12
    pressed = [size(np.array([s.max_pressure, s.max_tension])) for s in result.supports if s.area is not None]
    pressure = max(pressed, default=0.0)
    return {
        "deflection": moved,
        "rotation": max(size(result.rotation), _BENT * moved / span),
        "moment": max(size(result.moment), _BENT * rigidity * moved / span**2),
        "shear": max(size(result.shear), _BENT * rigidity * moved / span**3),
        "reaction": float(sum(np.abs(support.reactions).sum() for support in result.supports)),
        **dict.fromkeys(("pressure", "max_pressure", "max_tension"), pressure),
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
                what = " ".join(str(part) for part in (key, *rest)).replace("_", " ")
                if key in _COMPONENTS:
                    what = _COMPONENTS[str(key)][int(str(rest[0]))]
            case ("supports", int(index), *rest):
                whose = figures["supports"][index]["name"]
                what = " ".join(f"of point {part + 1}" if isinstance(part, int) else str(part) for part in rest[::-1])
                what = what.replace("_", " ").removesuffix(" points")
            case _:
                whose, what = "the plate", f"{path[-1]} {path[-2]}"
        said.setdefault(whose, []).append(what)
    return "; ".join(f"of {whose} {', '.join(what)}" for whose, what in said.items())


_COMPONENTS = {"rotation": ("θx", "θy"), "moment": ("mx", "my", "mxy"), "shear": ("qx", "qy")}
