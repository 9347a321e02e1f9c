"""Numbers of a result by what they are of: support, point, probe, section; never by a node of the mesh."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from signorini.discretise.rigidity import Rigidity
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.zones import Zones
from signorini.errors import point
from signorini.mesh import Mesh
from signorini.model import Load, Model, Support
from signorini.model.footprint import footprints
from signorini.results.result import Result
from signorini.shapes.distances import distances
from signorini.singularities.singularity import Singularity

Path = tuple[str | int, ...]

_OF_THE_MESH = {"nodes", "contact_boundary", "max_at", "min_at", "max_pressure_at"}
"""Lists as long as the mesh is fine, and places, of which there may be others as good."""
_OF_VECTOR, _OF_POINTS = 0.5, 0.1
"""Part of the largest change in a vector, and among the points of a support."""
_BENT = 0.01
_GIVEN = {"at", "length", "width"}
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
        if path[-2:] != _ANGLE and (path[-1] not in _COUNTS or at_points):
            found[path] = value
    return found


def _every(tree: Any, path: Path) -> Iterator[tuple[Path, float]]:
    """Yield what is neither the input's nor the mesh's own, whose lists may be long."""
    match tree:
        case dict():
            for key, value in tree.items():
                if key not in _OF_THE_MESH and key not in _GIVEN:
                    yield from _every(value, (*path, key))
        case list():
            for index, value in enumerate(tree):
                yield from _every(value, (*path, index))
        case int() | float():
            yield path, float(tree)


def with_numbers(tree: Any, numbers: Mapping[Path, float | None], path: Path = ()) -> Any:
    """Put other numbers in the place of those of a tree: 0 for what the input gives, None for what is not there."""
    match tree:
        case dict():
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
    """Changes (n, k) that numbers count as at least, by the largest of those that were found with them.

    Components of a vector turn into each other; points of one support share what acts on it.
    """
    groups: dict[Path, list[int]] = {}
    for place, path in enumerate(paths):
        alike = path[:-1] if isinstance(path[-1], int) else (*path[:3], *path[4:]) if "points" in path else path
        groups.setdefault(alike, []).append(place)
    found, known = np.empty_like(changes), np.nan_to_num(changes)
    for alike, members in groups.items():
        # Principal and design moments are of all components.
        of = groups.get((*alike[:2], "moment"), []) if alike[2:3] and alike[2] in _OF_MOMENTS else []
        found[members] = known[[*members, *of]].max(axis=0)
    parts = [_OF_VECTOR if isinstance(path[-1], int) else _OF_POINTS for path in paths]
    return np.asarray(found * np.array(parts).reshape(-1, 1))


def kind_of(path: Path) -> str:
    """The field that a number is of."""
    names = [part for part in path if isinstance(part, str)]
    if names[0] in ("sections", "strips"):
        summed = {"shear": "force"}.get(names[-1], "couple") if names[0] == "sections" else ""
        return summed or ("shear" if "shear" in names else "moment")
    if names[0] == "fields" or names[1] in _OF_MOMENTS:
        return _FIELD_OF.get(names[1], names[1])
    if "largest" in names:
        return "pressure"
    return "deflection" if names[-1] in ("max", "min", "gap") else names[-1]


def acts_at_points(model: Model) -> bool:
    """Whether a force, a couple or a support acts at a point, not on a footprint."""
    items: tuple[Load | Support, ...] = (*model.load, *model.support)
    points = any(item.at is not None and not footprints(item) for item in items)
    return points or any(moving.patch is None for moving in model.moving)


def may_grow(paths: Sequence[Path], figures: Mapping[str, Any], singular: Sequence[Singularity], reach: float) -> Bools:
    """Which numbers (n,) may grow for ever as the mesh is refined: what a singularity within reach is named for.

    Of supports it is one of their own, of envelopes one anywhere. Where supports at points give way the whole plate
    moves, and extremes of the deflection are wherever they are. ``figures`` name the supports and place the probes.
    """
    supports = [support["name"] for support in figures["supports"]]
    kinds = ["pressure" if {"max_pressure", "max_tension"} & set(path) else kind_of(path) for path in paths]
    found = np.zeros(len(paths), np.bool_)
    probes = np.array([probe["at"] for probe in figures["probes"]]).reshape(-1, 2)
    for one in singular:
        near = (away(probes, one) <= max(reach, one.within)).tolist()
        whole = "deflection" in one.numbers and one.source in supports
        for place, (path, kind) in enumerate(zip(paths, kinds, strict=True)):
            through = path[0] in ("sections", "strips") and "reaction" in one.numbers
            found[place] |= (
                (whole and kind in ("deflection", "rotation"))
                or through
                or (
                    kind in one.numbers
                    and (
                        path[0] in ("fields", "deflection")
                        or (path[0] == "supports" and one.source == supports[int(path[1])])
                        or (path[0] == "probes" and near[int(path[1])])
                    )
                )
            )
    return found


def away(points: Floats, singularity: Singularity) -> Floats:
    """Distances (q,) of points (q, 2) from a singularity."""
    where = np.array(singularity.where).reshape(-1, 2)
    begin, end = (where[:-1], where[1:]) if singularity.line else (where, where)
    return np.asarray(distances(points, begin, end).min(axis=1, initial=math.inf))


def largest_of(result: Result) -> dict[str, float]:
    """The largest number of every field at the nodes, the sum of all reactions, and the largest pressure."""

    def size(values: Floats) -> float:
        return float(np.abs(values).max(initial=0.0))

    areas = [np.array([s.max_pressure, s.max_tension]) for s in result.supports if s.area is not None]
    pressure = max(map(size, areas), default=0.0)
    own = {name: size(getattr(result, name)) for name in ("deflection", "rotation", "moment", "shear")}
    own["reaction"] = float(sum(np.abs(support.reactions).sum() for support in result.supports))
    bent = _bent(result.model, result.mesh, np.array(own["deflection"]), np.array(own["moment"]))
    found = {name: max(value, bent[name].item()) for name, value in own.items()}
    return {
        **found,
        "couple": found["moment"] * result.mesh.size,
        "force": found["shear"] * result.mesh.size,
        **dict.fromkeys(("pressure", "max_pressure", "max_tension"), pressure),
        "contact_area": float(result.mesh.element_area.sum()),
        "closed_part": 1.0,
        **dict.fromkeys(_COUNTS, 0.0),
    }


def sizes_of(numbers: Mapping[Path, Floats], model: Model, mesh: Mesh) -> dict[str, Floats]:
    """The largest of every kind of number, of k results (k,), by which their rounding and growth are judged.

    Of all that is told alike of a combination by itself and of a row of a table. A plate that only moves has moments
    by rounding, one that is bent evenly shears, one that may not bend deflections: a hundredth of what goes with the
    others counts too. So does a hundredth of gaps as movement, since deflections are told beside them.
    """
    points = {path[1] for path in numbers if "points" in path}
    none = np.zeros(max((len(value) for value in numbers.values()), default=0))
    found: dict[str, Floats] = {}
    for path, value in numbers.items():
        kind, size = kind_of(path), np.nan_to_num(np.abs(value))
        part = _BENT if path[-1] == "gap" else 1.0
        if kind == "reaction":
            if "points" in path or path[1] not in points:
                found[kind] = found.get(kind, none) + size
        elif path[0] != "probes" or path[2] not in (*_OF_MOMENTS, "pressure"):
            found[kind] = np.maximum(found.get(kind, none), part * size)
    for kind, least in _bent(model, mesh, found.get("deflection", none), found.get("moment", none)).items():
        found[kind] = np.maximum(found.get(kind, none), least)
    pressed = np.max([found.get(kind, none) for kind in ("pressure", "max_pressure", "max_tension")], axis=0)
    found |= dict.fromkeys(("pressure", "max_tension"), pressed)
    found |= {"contact_area": none + mesh.element_area.sum(), "closed_part": none + 1.0}
    return found | dict.fromkeys(_COUNTS, none)


def _bent(model: Model, mesh: Mesh, deflection: Floats, moment: Floats) -> dict[str, Floats]:
    """A hundredth of what goes with a plate's deflection, bent as a whole, or with its largest moment if that is more.

    Totals may cancel, and a plate may be bent without shears: what its supports hold is no less than this.
    """
    span, (thickness, *_) = mesh.size, sections_at(model, mesh.points)
    rigidity = model.young * float(thickness.max()) ** 3 / 12
    bent = _BENT * np.maximum(deflection, moment * span**2 / rigidity)
    of_bending = {
        "deflection": 1.0,
        "rotation": 1 / span,
        "moment": rigidity / span**2,
        "couple": rigidity / span,
        "shear": rigidity / span**3,
        "force": rigidity / span**2,
        "reaction": rigidity / span**2,
    }
    return {kind: part * bent for kind, part in of_bending.items()}


def sections_at(model: Model, points: Floats) -> tuple[Floats, Sequence[Rigidity], Ints]:
    """The thickness (n,) by which the plate is stiff at points; all rigidities, and whose number (n,) each has."""
    zones, nominal = Zones.anywhere(model), np.empty(len(points))
    made = zones.made_at(points)
    for number in np.unique(made.thickness):
        mine = made.thickness == number
        nominal[mine] = np.abs(zones.formulas[number](*points[mine].T))
    return zones.acting(made.rigidity, nominal), zones.rigidities, made.rigidity


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
            case ("sections", int(index), key):
                whose, what = f"section {figures['sections'][index]['name']}", str(key)
            case ("strips", int(index), *rest):
                strip = figures["strips"][index]
                whose, what = f"strip {strip['name']}", str(rest[-1]).replace("_", " ")
                if rest[0] == "stations":
                    whose += f" at {point(strip['stations'][int(str(rest[1]))]['at'])}"
            case ("supports", int(index), *rest):
                whose = figures["supports"][index]["name"]
                what = " ".join(f"of point {part + 1}" if isinstance(part, int) else str(part) for part in rest[::-1])
                what = what.replace("_", " ").removesuffix(" points")
            case _:
                whose, what = "the plate", f"{path[-1]} {path[-2]}"
        said.setdefault(whose, []).append(what)
    return "; ".join(f"of {whose} {', '.join(what)}" for whose, what in said.items())


_COMPONENTS = {"rotation": ("θx", "θy"), "moment": ("mx", "my", "mxy"), "shear": ("qx", "qy")}
