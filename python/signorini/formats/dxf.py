"""Read what a DXF drawing says about a plate: its outline, holes, and points and lines where it may stand."""

from __future__ import annotations

import os
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

from signorini.errors import InputError, SignoriniError, point
from signorini.formats.drawing import GAP, Corner, Drawing, Loop

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document
    from ezdxf.entities.dxfentity import DXFEntity

_T = TypeVar("_T")

ROLES = ("outline", "holes", "points", "lines")
"""What a layer may hold; the layer of this name does where no other is named."""
METRES = {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048, "yd": 0.9144}
"""Length of every unit of a drawing."""
_HEADER_UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 14: "dm"}
"""Units by the number that the header of a drawing gives, $INSUNITS."""
_CHORDS = 1 / 2000
"""Part of the drawing's size by which chords may leave a spline or an ellipse: a side each is about an element long."""
_DEEPEST = 16
"""Blocks within blocks; more are blocks within themselves."""


@dataclass
class _Layer:
    """What is on one layer, in metres, and the kinds of what is none of it; each role takes what it uses."""

    loops: list[Loop] = field(default_factory=list)
    lines: list[tuple[Corner, ...]] = field(default_factory=list)
    points: list[tuple[float, float]] = field(default_factory=list)
    others: Counter[str] = field(default_factory=Counter)

    def __str__(self) -> str:
        found = [
            (len(self.loops), "closed line"),
            (len(self.lines), "open line"),
            (len(self.points), "point"),
            *((count, kind) for kind, count in sorted(self.others.items())),
        ]
        return ", ".join(
            f"{count} {kind}{'s' if count > 1 and kind.islower() else ''}" for count, kind in found if count
        )


def read_dxf(path: str | os.PathLike[str], layers: Mapping[str, str], unit: str | None = None) -> Drawing:
    """Read a drawing.

    Arcs and circles stay what they are; splines and ellipses become chords that leave them by at most 1/2000 of the
    drawing's size. Blocks are taken apart. Ends less than a millimetre apart are joined.

    Parameters
    ----------
    path : path
    layers : dict
        Layer of each role, any of `ROLES`, in upper or lower case. Without a layer the outline is the largest closed
        line of the drawing, and the holes are the closed lines within it on the outline's layer.
    unit : str, optional
        Of the drawing, any of `METRES`; by default what its header says.

    Raises
    ------
    InputError
        If there is no such layer, no closed line for the outline, or no unit.
    SignoriniError
        If the file cannot be read, or ezdxf, which reads it, is not there.
    """
    document = _opened(path)
    metres = _metres(document, unit)
    found = _layers(document, metres)
    names = {role: _named(role, layers.get(role), found) for role in ROLES}
    outline, layer = _outline(names["outline"], found)
    found[layer].loops.remove(outline)
    own = found[names["holes"] or layer].loops
    holes = [loop for loop in own if names["holes"] or (loop.area < outline.area and outline.has(*loop.middle))]
    own[:] = [loop for loop in own if loop not in holes]
    points, loose = _points(found[names["points"]]) if names["points"] else ({}, [])
    lines = _all_of(found[names["lines"]].lines) if names["lines"] else []
    took = [
        f"outline: {_sides(outline)}, {outline.area:.6g} m², layer {layer}",
        *(f"hole {i}: {_sides(hole)} about {point(hole.middle)}" for i, hole in enumerate(holes, 1)),
        *(f"points: {len(at)}{_footprint(footprint)}" for footprint, at in points.items()),
        *([f"lines: {len(lines)}"] if lines else []),
    ]
    left = [f"layer {name}: {rest}" for name, rest in sorted(found.items()) if str(rest)]
    inside = sum(loop.area < outline.area and outline.has(*loop.middle) for loop in found[layer].loops)
    if inside:
        left.append(
            f"{inside} of the closed lines of layer {layer} are inside the outline: if they are holes, put them on"
        )
        left[-1] += f" layer {names['holes']}"
    if loose:
        middles = ", ".join(point(loop.middle) for loop in loose[:3])
        left.append(f"shapes of {len(loose)} points, at {middles}: they are no rectangles parallel to the axes")
    return Drawing(outline, tuple(holes), points, tuple(lines), tuple(took), tuple(left))


def _all_of(things: list[_T]) -> list[_T]:
    """Take everything out of a list."""
    taken = things.copy()
    things.clear()
    return taken


def _opened(path: str | os.PathLike[str]) -> Document:
    try:
        from ezdxf import recover
        from ezdxf.lldxf.const import DXFError
    except ImportError:
        raise SignoriniError(
            "drawings are read by ezdxf, which is not installed: pip install 'signorini[dxf]'."
        ) from None
    try:
        document, _ = recover.readfile(os.fspath(path))
    except OSError as error:
        raise InputError(f"{os.path.basename(path)} cannot be read: {error.strerror or error}.") from None
    except (DXFError, ValueError, KeyError, IndexError, EOFError) as error:
        why = " ".join(str(error).split())
        raise InputError(f"{os.path.basename(path)} is no DXF drawing that can be read: {why}.") from None
    if not len(document.modelspace()):
        raise InputError(f"{os.path.basename(path)} is no DXF drawing, or has nothing in its model space.")
    return document


def _metres(document: Document, unit: str | None) -> float:
    named = _HEADER_UNITS.get(int(document.header.get("$INSUNITS", 0))) if unit is None else unit
    if named is None:
        raise InputError(f"the drawing names no unit of length. Name one of {', '.join(METRES)}.", place="unit")
    if named not in METRES:
        raise InputError(f"found {named!r}; it must be one of {', '.join(METRES)}.", place="unit")
    return METRES[named]


def _layers(document: Document, metres: float) -> dict[str, _Layer]:
    """All layers that have something, by name; what is not shown counts as other things."""
    from ezdxf.upright import upright_all

    by_layer: dict[str, list[Any]] = defaultdict(list)
    hidden: dict[str, Counter[str]] = defaultdict(Counter)
    shown = {layer.dxf.name.lower(): not (layer.is_off() or layer.is_frozen()) for layer in document.layers}
    named: dict[str, str] = {}
    for name, entity in _taken_apart(document.modelspace()):
        name = named.setdefault(name.lower(), name)
        if shown.get(name.lower(), True) and not entity.dxf.get("invisible", 0):
            by_layer[name].append(entity)
        else:
            hidden[name][f"hidden {entity.dxftype()}"] += 1
    for entities in by_layer.values():
        upright_all(entities)
    extent = _extent(entity for entities in by_layer.values() for entity in entities)
    found = {name: _layer(entities, metres, extent * _CHORDS) for name, entities in by_layer.items()}
    for name, kinds in hidden.items():
        found.setdefault(name, _Layer()).others.update(kinds)
    return found


def _taken_apart(entities: Iterable[Any], layer: str | None = None, depth: int = 0) -> Iterator[tuple[str, DXFEntity]]:
    """Every entity with its layer; those of blocks that are drawn on layer 0 are on the layer of their block.

    The place of a block is a point beside what it is made of.
    """
    from ezdxf.entities.point import Point

    for entity in entities:
        on = layer if layer is not None and entity.dxf.layer == "0" else entity.dxf.layer
        if entity.dxftype() != "INSERT":
            yield on, entity
            continue
        for one in entity.multi_insert() if entity.mcount > 1 else (entity,):
            parts = list(_taken_apart(one.virtual_entities(), on, depth + 1)) if depth < _DEEPEST else []
            yield from parts
            if not any(name == on and part.dxftype() in _DRAWN for name, part in parts):
                yield on, Point.new(dxfattribs={"location": one.dxf.insert, "layer": on})


_DRAWN = {"LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE", "POINT"}


def _extent(entities: Iterable[Any]) -> float:
    from ezdxf.bbox import extents

    box = extents(entities, fast=True)
    return float(max(box.size.x, box.size.y)) if box.has_data else 0.0


def _layer(entities: Sequence[Any], metres: float, sagitta: float) -> _Layer:
    """Sort the entities of a layer; lengths are the drawing's until they are put into metres here."""
    from ezdxf import edgeminer, edgesmith

    def corners(points: Iterable[tuple[float, float, float]]) -> tuple[Corner, ...]:
        kept: list[Corner] = []
        for x, y, bulge in points:
            corner = Corner(float(x) * metres, float(y) * metres, float(bulge))
            if kept and max(abs(corner.x - kept[-1].x), abs(corner.y - kept[-1].y)) < GAP:
                # One place drawn twice: the side that goes on is the later one's.
                kept[-1] = kept[-1]._replace(bulge=corner.bulge)
            else:
                kept.append(corner)
        return tuple(kept)

    loops, points, others = [], [], Counter[str]()
    open_ones: list[Any] = []
    for entity in entities:
        kind = entity.dxftype()
        if kind == "POINT":
            points.append((entity.dxf.location.x * metres, entity.dxf.location.y * metres))
        elif kind == "CIRCLE":
            center = Corner(entity.dxf.center.x * metres, entity.dxf.center.y * metres)
            loops.append(Loop((center,), entity.dxf.radius * metres))
        elif kind not in _DRAWN or (kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline)):
            others[kind] += 1
        elif edgesmith.is_closed_entity(entity):
            loops.append(_closed(corners(_vertices(entity, sagitta))))
        else:
            open_ones.append(entity)
    edges = _once(edgesmith.edges_from_entities_2d(open_ones, gap_tol=GAP / metres), GAP / metres)
    lines = []
    chains = edgeminer.find_all_simple_chains(edgeminer.Deposit(edges, gap_tol=GAP / metres)) if edges else ()
    for chain in chains:
        whole = edgesmith.polyline2d_from_chain(chain, max_sagitta=sagitta)
        joined = corners((v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0)) for v in whole.vertices)
        if edgeminer.is_loop(chain, gap_tol=GAP / metres):
            loops.append(_closed(joined))
        elif len(joined) > 1:
            lines.append(joined)
    thin = [loop for loop in loops if loop.area < GAP**2]
    others.update({"sliver": len(thin)} if thin else {})
    return _Layer([loop for loop in loops if loop not in thin], lines, points, others)


def _closed(corners: tuple[Corner, ...]) -> Loop:
    """Leave out the last corner if it is the first again."""
    first, last = corners[0], corners[-1]
    again = len(corners) > 1 and max(abs(first.x - last.x), abs(first.y - last.y)) < GAP
    return Loop(corners[:-1] if again else corners)


def _vertices(entity: Any, sagitta: float) -> Iterator[tuple[float, float, float]]:
    from ezdxf.path import make_path

    match entity.dxftype():
        case "LWPOLYLINE":
            yield from entity.get_points("xyb")
        case "POLYLINE":
            yield from ((v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0)) for v in entity.vertices)
        case _:
            yield from ((v.x, v.y, 0.0) for v in make_path(entity).flattening(sagitta))


def _once(edges: Iterable[Any], gap: float) -> list[Any]:
    """Leave out what is drawn twice: the same ends, kind and length."""
    kept: dict[tuple[object, ...], Any] = {}
    for edge in edges:
        ends = sorted((round(end.x / gap), round(end.y / gap)) for end in (edge.start, edge.end))
        kept.setdefault((*ends, type(edge.payload), round(edge.length / gap)), edge)
    return list(kept.values())


def _named(role: str, wanted: str | None, found: Mapping[str, _Layer]) -> str | None:
    """The drawing's own spelling of a layer."""
    by_name = {name.lower(): name for name in found}
    if wanted is not None and wanted.lower() not in by_name:
        there = ", ".join(sorted(found)) or "none"
        raise InputError(f"the drawing has nothing on a layer {wanted!r}. Its layers are: {there}.", place=role)
    return by_name.get((role if wanted is None else wanted).lower())


def _outline(layer: str | None, found: Mapping[str, _Layer]) -> tuple[Loop, str]:
    candidates = [(loop, name) for name, one in found.items() if layer in (None, name) for loop in one.loops]
    if candidates:
        return max(candidates, key=lambda pair: pair[0].area)
    where = "the drawing" if layer is None else f"layer {layer}"
    ends = [line for name, one in found.items() if layer in (None, name) for line in one.lines]
    if not ends:
        raise InputError(f"{where} has no closed line for the outline. Name another layer.", place="outline")
    longest = max(ends, key=len)
    first, last = longest[0], longest[-1]
    raise InputError(
        f"no line of {where} is closed. The longest has {len(longest) - 1} sides and ends at {point(first[:2])} and "
        f"{point(last[:2])} m. Join these ends in the drawing.",
        place="outline",
    )


def _points(layer: _Layer) -> tuple[dict[tuple[float, ...], list[tuple[float, float]]], list[Loop]]:
    """Places by their footprints, and the closed lines whose shape is none: these count by their middles."""
    found: dict[tuple[float, ...], list[tuple[float, float]]] = defaultdict(list)
    loose = []
    for at in _all_of(layer.points):
        found[()].append(at)
    for loop in _all_of(layer.loops):
        footprint = (loop.radius,) if loop.radius else loop.sides
        if footprint is None:
            loose.append(loop)
        found[tuple(round(size, 3) for size in footprint or ())].append(loop.middle)
    return dict(found), loose


def _sides(loop: Loop) -> str:
    if loop.radius:
        return f"circle of radius {loop.radius:.6g} m"
    arcs = sum(corner.bulge != 0 for corner in loop.corners)
    return f"{len(loop.corners)} sides{f', {arcs} of them curved' if arcs else ''}"


def _footprint(footprint: tuple[float, ...]) -> str:
    if not footprint:
        return ""
    return f", radius {footprint[0]:g} m" if len(footprint) == 1 else f", {footprint[0]:g} m × {footprint[1]:g} m"
