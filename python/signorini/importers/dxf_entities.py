"""Read the layers of a DXF drawing: closed lines, open lines, filled areas and points."""

from __future__ import annotations

import math
import os
from bisect import bisect_right
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import accumulate, chain, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from signorini.base.units import METRES
from signorini.errors import InputError, SignoriniError
from signorini.importers.drawing import GAP, Corner, Loop, about

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document
    from ezdxf.entities.dxfentity import DXFEntity
    from ezdxf.math import Vec2


def whole_lines(edges: Sequence[Any], gap: float) -> list[Any]:
    """Merge straight edges of a drawing that overlap; return all edges, merged or not.

    Edges are merged only at a free end. An end is free if no other end is within ``gap``, in the drawing's unit.
    """
    straight = [i for i, edge in enumerate(edges) if edge.payload is not None and edge.payload.dxftype() == "LINE"]
    if len(straight) < 2:
        return list(edges)
    ends = np.array([[(edge.start.x, edge.start.y), (edge.end.x, edge.end.y)] for edge in edges])
    free = _free(ends.reshape(-1, 2), gap).reshape(-1, 2)[straight]
    ends = ends[straight]
    merged, extended = np.zeros(len(straight), bool), np.zeros(len(straight), bool)
    stack = [(int(i), int(side)) for i, side in np.argwhere(free)]
    while stack:
        i, side = stack.pop()
        j = None if merged[i] else _overlapped(i, side, ends, free, merged, gap)
        if j is None:
            continue
        a, b = ends[j].copy()
        along = b - a
        part = (ends[i, 1 - side] - a) @ along / (along @ along)
        merged[i] = True
        if not 0.0 <= part <= 1.0:
            far = int(part > 1.0)
            ends[j, far], free[j, far] = ends[i, 1 - side], free[i, 1 - side]
            extended[j] = True
            stack += [(j, k) for k in (0, 1) if free[j, k]]
    replaced = {straight[i] for i in np.flatnonzero(merged | extended)}
    lines = [_line(edges[straight[i]], ends[i]) for i in np.flatnonzero(extended & ~merged)]
    return [edge for i, edge in enumerate(edges) if i not in replaced] + lines


def _free(ends: Any, gap: float) -> Any:
    """Mask (k,) of the free ends among the ends (k, 2): no other end is within ``gap``."""
    from scipy.spatial import cKDTree

    return np.array([len(near) for near in cKDTree(ends).query_ball_point(ends, gap)]) == 1


def _overlapped(i: int, side: int, ends: Any, free: Any, merged: Any, gap: float) -> int | None:
    """Index of a line that contains the start (side 0) or end (side 1) of line i and can be merged with it, or None."""
    end, other_end = ends[i, side], ends[i, 1 - side]
    a, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    length = np.maximum(np.hypot(along[:, 0], along[:, 1]), gap)

    def local(point: Any) -> tuple[Any, Any]:
        off = point - a
        across = (along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]) / length
        return (off * along).sum(axis=1) / length, abs(across)

    (here, off_here), (there, off_there) = local(end), local(other_end)
    on = ~merged & (off_here < gap) & (off_there < gap) & (here > gap) & (here < length - gap)
    on[i] = False
    for j in np.flatnonzero(on):
        inside = gap < there[j] < length[j] - gap
        passed = int(there[j] > 0.5 * length[j])
        at_end = min(abs(there[j]), abs(there[j] - length[j])) <= gap
        if at_end or (free[i, 1 - side] if inside else free[j, passed]):
            return int(j)
    return None


def _line(edge: Any, ends: Any) -> Any:
    """Copy of a straight edge with the end points ``ends`` (2, 2)."""
    from ezdxf import edgesmith
    from ezdxf.entities.line import Line

    line = Line.new(dxfattribs={"layer": edge.payload.dxf.layer, "start": tuple(ends[0]), "end": tuple(ends[1])})
    return next(iter(edgesmith.edges_from_entities_2d([line])))


_HEADER_UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 14: "dm"}
"""Unit of length for each value of $INSUNITS in the header of a drawing."""
_SAGITTA = 1 / 20000
"""Largest distance of a spline or ellipse from the arcs that approximate it, relative to the drawing's size.

The directions of neighbouring arcs where they meet then differ by less than 1°.
"""
_MAX_BISECTIONS = 8
"""Largest number of bisections when a spline is approximated by arcs; a bend that needs more becomes a corner."""
_FLAT = 1e-6
"""An arc counts as a straight line up to this ratio of its rise to its chord."""
_CHORD_ERROR = 0.1
"""Largest distance of chords from a curve, relative to `GAP`, when repeated curves are sought along their chords."""
_MAX_DEPTH = 16
"""Largest depth of nested blocks of a drawing; deeper nesting means that a block contains itself."""


@dataclass
class Layer:
    """Shapes on a layer, in metres; ``others`` counts, by type, the entities that cannot be imported."""

    loops: list[Loop] = field(default_factory=list)
    fills: list[Loop] = field(default_factory=list)
    lines: list[tuple[Corner, ...]] = field(default_factory=list)
    points: list[tuple[float, float]] = field(default_factory=list)
    slivers: list[Loop] = field(default_factory=list)
    others: Counter[str] = field(default_factory=Counter)

    @property
    def places(self) -> list[list[tuple[float, float]]]:
        """For each shape of the layer the list of its points (x, y) [m]."""
        lines = [[corner[:2] for corner in line] for line in self.lines]
        return (
            [[*loop.points] for loop in (*self.loops, *self.fills, *self.slivers)]
            + lines
            + [[point] for point in self.points]
        )

    def __str__(self) -> str:
        """Return text with the number and the first positions of the layer's shapes of each kind."""
        shapes = (
            ("closed line", [loop.middle for loop in self.loops]),
            ("filled area", [fill.middle for fill in self.fills]),
            ("open line", [line[0][:2] for line in self.lines]),
            ("point", self.points),
            ("sliver", [sliver.middle for sliver in self.slivers]),
        )
        placed = [f"{len(at)} {kind}{'s' if len(at) > 1 else ''}{about(at)}" for kind, at in shapes if at]
        return "; ".join([*placed, *(f"{count} {kind}" for kind, count in sorted(self.others.items()))])


def layers_in(path: str | os.PathLike[str], unit: str | None) -> dict[str, Layer]:
    """Return the layers of a DXF file with their shapes, by name; hidden entities are counted in ``others``."""
    document = _opened(path)
    return _layers(document, _metres(document, unit))


def _opened(path: str | os.PathLike[str]) -> Document:
    try:
        from ezdxf import recover
        from ezdxf.lldxf.const import DXFError
    except ImportError:
        raise SignoriniError(
            "reading drawings needs ezdxf, which is not installed: pip install 'signorini[dxf]'."
        ) from None
    try:
        document, _ = recover.readfile(os.fspath(path))
    except OSError as error:
        raise InputError(f"{os.path.basename(path)} cannot be read: {error.strerror or error}.") from None
    except (DXFError, ValueError, KeyError, IndexError, EOFError) as error:
        why = " ".join(str(error).split())
        raise InputError(f"{os.path.basename(path)} is not a readable DXF drawing: {why}.") from None
    if not len(document.modelspace()):
        raise InputError(f"{os.path.basename(path)} is not a DXF drawing, or its model space is empty.")
    return document


def _metres(document: Document, unit: str | None) -> float:
    named = _HEADER_UNITS.get(int(document.header.get("$INSUNITS", 0))) if unit is None else unit
    if named is None:
        raise InputError(f"the drawing has no unit of length. Give one of {', '.join(METRES)}.", place="unit")
    if named not in METRES:
        raise InputError(f"found {named!r}; it must be one of {', '.join(METRES)}.", place="unit")
    return METRES[named]


def _layers(document: Document, metres: float) -> dict[str, Layer]:
    """Return the layers of an opened drawing with their shapes, by name; hidden entities are counted in ``others``."""
    from ezdxf.bbox import extents
    from ezdxf.upright import upright_all

    by_layer: dict[str, list[Any]] = defaultdict(list)
    hidden: dict[str, Counter[str]] = defaultdict(Counter)
    shown = {layer.dxf.name.lower(): not (layer.is_off() or layer.is_frozen()) for layer in document.layers}
    named: dict[str, str] = {}
    for name, entity in _exploded(document.modelspace()):
        name = named.setdefault(name.lower(), name)
        if shown.get(name.lower(), True) and not entity.dxf.get("invisible", 0):
            by_layer[name].append(entity)
        else:
            hidden[name][f"hidden {entity.dxftype()}"] += 1
    for entities in by_layer.values():
        upright_all(entities)
    box = extents(chain.from_iterable(by_layer.values()), fast=True)
    extent = float(max(box.size.x, box.size.y)) if box.has_data else 0.0
    layers = {name: _layer(entities, metres, extent * _SAGITTA) for name, entities in by_layer.items()}
    for name, kinds in hidden.items():
        layers.setdefault(name, Layer()).others.update(kinds)
    return layers


def _exploded(entities: Iterable[Any], layer: str | None = None, depth: int = 0) -> Iterator[tuple[str, DXFEntity]]:
    """Yield each entity of the drawing with its layer; blocks are replaced by their entities.

    Entities of a block on layer 0 get the layer of the block. A block without drawable entities on its own layer is
    replaced by a point.
    """
    from ezdxf.entities.point import Point

    for entity in entities:
        on = layer if layer is not None and entity.dxf.layer == "0" else entity.dxf.layer
        if entity.dxftype() != "INSERT":
            yield on, entity
            continue
        for block in entity.multi_insert() if entity.mcount > 1 else (entity,):
            parts = list(_exploded(block.virtual_entities(), on, depth + 1)) if depth < _MAX_DEPTH else []
            yield from parts
            if not any(name == on and part.dxftype() in _DRAWN for name, part in parts):
                yield on, Point.new(dxfattribs={"location": block.dxf.insert, "layer": on})


_DRAWN = {"LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE", "POINT", "SOLID", "TRACE", "HATCH"}


def _layer(entities: Sequence[Any], metres: float, sagitta: float) -> Layer:
    """Return the shapes of a layer, sorted by kind, with lengths in metres.

    Splines and ellipses are approximated within ``sagitta``, in the drawing's unit.
    """
    from ezdxf import edgeminer, edgesmith

    def corners(points: Iterable[tuple[float, float, float]]) -> tuple[Corner, ...]:
        kept: list[Corner] = []
        for x, y, bulge in points:
            corner = Corner(float(x) * metres, float(y) * metres, float(bulge))
            if kept and corner.is_at(kept[-1]):
                # Merge coincident points; keep the bulge of the second point, at which the next side begins.
                kept[-1] = kept[-1]._replace(bulge=corner.bulge)
            else:
                kept.append(corner)
        return tuple(kept)

    loops, fills, points, others = [], [], [], Counter[str]()
    open_entities: list[Any] = []
    for entity in entities:
        kind = entity.dxftype()
        if kind in ("ELLIPSE", "SPLINE"):
            entity = _in_arcs(entity, sagitta)
        if kind == "POINT":
            points.append((entity.dxf.location.x * metres, entity.dxf.location.y * metres))
        elif kind == "CIRCLE" or (kind == "ARC" and edgesmith.is_closed_entity(entity)):
            center = Corner(entity.dxf.center.x * metres, entity.dxf.center.y * metres)
            loops.append(Loop((center,), entity.dxf.radius * metres))
        elif kind in ("SOLID", "TRACE", "HATCH"):
            fills += [_closed(corners((v.x, v.y, 0.0) for v in ring)) for ring in _rings(entity, sagitta)]
        elif kind not in _DRAWN or (kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline)):
            others[kind] += 1
        elif edgesmith.is_closed_entity(entity):
            loops.append(_closed(corners(_vertices(entity))))
        else:
            open_entities.append(entity)
    edges = _without_duplicates(edgesmith.edges_from_entities_2d(open_entities, gap_tol=GAP / metres), GAP / metres)
    edges = whole_lines(edges, GAP / metres)
    lines = []
    chains = edgeminer.find_all_simple_chains(edgeminer.Deposit(edges, gap_tol=GAP / metres)) if edges else ()
    # Sort the chains of edges, since ezdxf returns them in the random order of a set.
    for linked in sorted(chains, key=lambda edges: min(edge.id for edge in edges)):
        polyline = edgesmith.polyline2d_from_chain(linked, max_sagitta=sagitta)
        joined = corners((v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0)) for v in polyline.vertices)
        if edgeminer.is_loop(linked, gap_tol=GAP / metres):
            loops.append(_closed(joined))
        elif len(joined) > 1:
            lines.append(joined)
    thin = [loop for loop in (*loops, *fills) if loop.is_thin]
    loops, fills = ([loop for loop in part if loop not in thin] for part in (loops, fills))
    return Layer(loops, fills, lines, points, thin, others)


def _closed(corners: tuple[Corner, ...]) -> Loop:
    """Make a closed line of corners without a repeated last corner, or a circle if all sides are arcs of a circle."""
    from ezdxf.math import bulge_center, bulge_radius

    repeated = len(corners) > 1 and corners[0].is_at(corners[-1])
    loop = Loop(corners[:-1] if repeated else corners)
    bulges = [corner.bulge for corner in loop.corners]
    if len(bulges) < 2 or not (all(bulge > 0 for bulge in bulges) or all(bulge < 0 for bulge in bulges)):
        return loop
    arcs = [(a[:2], b[:2], a.bulge) for a, b in loop]
    circles = [(*bulge_center(*arc), bulge_radius(*arc)) for arc in arcs]
    turned = sum(4 * math.atan(abs(bulge)) for bulge in bulges)
    if abs(turned - math.tau) > 0.1 or any(math.dist(circle, circles[0]) > GAP for circle in circles):
        return loop
    return Loop((Corner(*circles[0][:2]),), circles[0][2])


def _rings(entity: Any, sagitta: float) -> Iterator[Any]:
    """Yield the boundaries of a filled area as points; curves are approximated within ``sagitta``."""
    from ezdxf.path import from_hatch

    if entity.dxftype() == "HATCH":
        yield from (list(path.flattening(sagitta)) for path in from_hatch(entity))
    else:
        yield entity.wcs_vertices()


def _in_arcs(entity: Any, sagitta: float) -> Any:
    """Convert a spline or ellipse to a polyline of arcs that deviates by at most ``sagitta``."""
    from ezdxf.entities.lwpolyline import LWPolyline
    from ezdxf.math import Vec2

    curve = entity.construction_tool()
    if entity.dxftype() == "ELLIPSE":
        begin, end = entity.dxf.start_param, entity.dxf.end_param
        end += 0.0 if end > begin else math.tau

        def at(t: float) -> Vec2:
            return Vec2(*curve.vertices([begin + t * (end - begin)]))
    else:

        def at(t: float) -> Vec2:
            return Vec2(curve.point(t * curve.max_t))

    polyline = LWPolyline.new(dxfattribs={"layer": entity.dxf.layer})
    # The curve is converted in four parts, because the ends of a closed curve coincide.
    arcs = [arc for i in range(4) for arc in _arcs(at, 0.25 * i, 0.25 * (i + 1), sagitta)]
    last = at(1.0)
    polyline.set_points([*((p.x, p.y, bulge) for p, bulge in arcs), (last.x, last.y, 0.0)], format="xyb")
    polyline.closed = last.distance(arcs[0][0]) <= sagitta
    return polyline


def _arcs(
    at: Callable[[float], Vec2], begin: float, end: float, sagitta: float, depth: int = 0
) -> list[tuple[Vec2, float]]:
    """Start points and bulges of arcs that approximate the curve ``at(parameter)`` from ``begin`` to ``end``."""
    p, q, half = at(begin), at(end), (begin + end) / 2
    bulge = _bulge(p, at(half), q)
    between = (at(begin + part * (end - begin)) for part in (0.125, 0.25, 0.75, 0.875))
    if depth == _MAX_BISECTIONS or all(_off_arc(z, p, q, bulge) <= sagitta for z in between):
        return [(p, bulge)]
    return _arcs(at, begin, half, sagitta, depth + 1) + _arcs(at, half, end, sagitta, depth + 1)


def _bulge(p: Vec2, middle: Vec2, q: Vec2) -> float:
    """Bulge of the arc from p through ``middle`` to q; 0 if the three points are collinear or two of them coincide."""
    from ezdxf.math import bulge_3_points

    half = 0.5 * p.distance(q)
    if min(half, middle.distance(p), middle.distance(q)) <= _FLAT * max(half, middle.distance(p)):
        return 0.0
    bulge = bulge_3_points(p, q, middle)
    return bulge if abs(bulge) >= _FLAT else 0.0


def _off_arc(z: Vec2, p: Vec2, q: Vec2, bulge: float) -> float:
    """Distance of the point z from the circle (a line, if the bulge is 0) on which the arc from p to q lies."""
    from ezdxf.math import bulge_center, bulge_radius, distance_point_line_2d

    if p.isclose(q):
        return float(z.distance(p))
    if not bulge:
        return distance_point_line_2d(z, p, q)
    return float(abs(bulge_center(p, q, bulge).distance(z) - bulge_radius(p, q, bulge)))


def _vertices(entity: Any) -> Iterator[tuple[float, float, float]]:
    if entity.dxftype() == "LWPOLYLINE":
        yield from entity.get_points("xyb")
    else:
        yield from ((v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0)) for v in entity.vertices)


def _without_duplicates(edges: Iterable[Any], gap: float) -> list[Any]:
    """Remove edges that repeat another edge, in the same or the opposite direction."""
    kept: list[Any] = []
    near: dict[tuple[int, int], list[list[Vec2]]] = defaultdict(list)
    for edge in edges:
        samples = _samples(edge.payload, gap)
        x, y = math.floor(samples[2].x / gap), math.floor(samples[2].y / gap)
        others = [other for i in (-1, 0, 1) for j in (-1, 0, 1) for other in near[x + i, y + j]]
        if any(_same(samples, other, gap) or _same(samples[::-1], other, gap) for other in others):
            continue
        near[x, y].append(samples)
        kept.append(edge)
    return kept


def _same(samples: list[Vec2], other: list[Vec2], gap: float) -> bool:
    return all(a.isclose(b, rel_tol=0.0, abs_tol=gap) for a, b in zip(samples, other, strict=True))


def _samples(entity: Any, gap: float) -> list[Vec2]:
    """Points at 0, ¼, ½, ¾ and 1 of a line's length, which distinguish different lines with equal ends."""
    from ezdxf.math import Vec2
    from ezdxf.path import make_path

    points = [Vec2(point) for point in make_path(entity).flattening(_CHORD_ERROR * gap)]
    s = [0.0, *accumulate(a.distance(b) for a, b in pairwise(points))]
    samples = [points[0]]
    for part in (0.25, 0.5, 0.75):
        i = min(bisect_right(s, part * s[-1]), len(points) - 1)
        step = s[i] - s[i - 1]
        samples.append(points[i - 1].lerp(points[i], (part * s[-1] - s[i - 1]) / step if step else 0.0))
    return [*samples, points[-1]]
