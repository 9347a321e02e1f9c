"""Read what a DXF drawing has on its layers: closed lines, open ones, filled areas and points."""

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
from signorini.formats.drawing import GAP, Corner, Loop, about

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document
    from ezdxf.entities.dxfentity import DXFEntity
    from ezdxf.math import Vec2


def whole_lines(edges: Sequence[Any], gap: float) -> list[Any]:
    """Edges of a drawing; of straight ones that overlap, and end alone where they do, one from end to end.

    Ends less than a gap apart, in the drawing's unit, are one place.
    """
    straight = [i for i, edge in enumerate(edges) if edge.payload is not None and edge.payload.dxftype() == "LINE"]
    if len(straight) < 2:
        return list(edges)
    ends = np.array([[(edge.start.x, edge.start.y), (edge.end.x, edge.end.y)] for edge in edges])
    alone = _alone(ends.reshape(-1, 2), gap).reshape(-1, 2)[straight]
    ends = ends[straight]
    gone, grown = np.zeros(len(straight), bool), np.zeros(len(straight), bool)
    waiting = [(int(i), int(side)) for i, side in np.argwhere(alone)]
    while waiting:
        i, side = waiting.pop()
        other = None if gone[i] else _beneath(i, side, ends, alone, gone, gap)
        if other is None:
            continue
        j, (a, b) = other, ends[other].copy()
        along = b - a
        part = (ends[i, 1 - side] - a) @ along / (along @ along)
        gone[i] = True
        if not 0.0 <= part <= 1.0:
            far = int(part > 1.0)
            ends[j, far], alone[j, far] = ends[i, 1 - side], alone[i, 1 - side]
            grown[j] = True
            waiting += [(j, k) for k in (0, 1) if alone[j, k]]
    dropped = {straight[i] for i in np.flatnonzero(gone)}
    made = [_line(edges[straight[i]], ends[i]) for i in np.flatnonzero(grown & ~gone)]
    renewed = {straight[i] for i in np.flatnonzero(grown)}
    return [edge for i, edge in enumerate(edges) if i not in dropped | renewed] + made


def _alone(ends: Any, gap: float) -> Any:
    """Whether no other end is at an end."""
    from scipy.spatial import cKDTree

    return np.array([len(near) for near in cKDTree(ends).query_ball_point(ends, gap)]) == 1


def _beneath(i: int, side: int, ends: Any, alone: Any, gone: Any, gap: float) -> int | None:
    """A line on which an end of another is, and that other within it, or beyond an end that is alone too."""
    at, back = ends[i, side], ends[i, 1 - side]
    a, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    length = np.maximum(np.hypot(along[:, 0], along[:, 1]), gap)

    def local(point: Any) -> tuple[Any, Any]:
        off = point - a
        across = (along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]) / length
        return (off * along).sum(axis=1) / length, abs(across)

    (here, off_here), (there, off_there) = local(at), local(back)
    on = ~gone & (off_here < gap) & (off_there < gap) & (here > gap) & (here < length - gap)
    on[i] = False
    for j in np.flatnonzero(on):
        within = gap < there[j] < length[j] - gap
        passed = int(there[j] > 0.5 * length[j])
        at_end = min(abs(there[j]), abs(there[j] - length[j])) <= gap
        if at_end or (alone[i, 1 - side] if within else alone[j, passed]):
            return int(j)
    return None


def _line(edge: Any, ends: Any) -> Any:
    """An edge between other ends."""
    from ezdxf import edgesmith
    from ezdxf.entities.line import Line

    line = Line.new(dxfattribs={"layer": edge.payload.dxf.layer, "start": tuple(ends[0]), "end": tuple(ends[1])})
    return next(iter(edgesmith.edges_from_entities_2d([line])))


_HEADER_UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 14: "dm"}
"""Units by the number that the header of a drawing gives, $INSUNITS."""
_OFF = 1 / 20000
"""Part of the drawing's size by which arcs may leave a spline or an ellipse: they meet at less than 1° then."""
_HALVED = 8
"""Times that a spline may be halved for arcs: what bends more sharply has a corner there."""
_FLAT = 1e-6
"""Rise over chord of an arc that is a line."""
_CLOSE = 0.1
"""Part of a gap by which chords may leave a line that is compared with others."""
_DEEPEST = 16
"""Blocks within blocks; more are blocks within themselves."""


@dataclass
class Layer:
    """What is on one layer, in metres, and the kinds of what is none of it; each role takes what it uses."""

    loops: list[Loop] = field(default_factory=list)
    fills: list[Loop] = field(default_factory=list)
    lines: list[tuple[Corner, ...]] = field(default_factory=list)
    points: list[tuple[float, float]] = field(default_factory=list)
    slivers: list[Loop] = field(default_factory=list)
    others: Counter[str] = field(default_factory=Counter)

    @property
    def places(self) -> list[list[tuple[float, float]]]:
        """Points [m] of each thing that is drawn."""
        lines = [[corner[:2] for corner in line] for line in self.lines]
        return (
            [[*one.points] for one in (*self.loops, *self.fills, *self.slivers)] + lines + [[at] for at in self.points]
        )

    def __str__(self) -> str:
        """Count what is there, and say where."""
        result = (
            ("closed line", [loop.middle for loop in self.loops]),
            ("filled area", [fill.middle for fill in self.fills]),
            ("open line", [line[0][:2] for line in self.lines]),
            ("point", self.points),
            ("sliver", [sliver.middle for sliver in self.slivers]),
        )
        placed = [f"{len(at)} {kind}{'s' if len(at) > 1 else ''}{about(at)}" for kind, at in result if at]
        return "; ".join([*placed, *(f"{count} {kind}" for kind, count in sorted(self.others.items()))])


def layers_in(path: str | os.PathLike[str], unit: str | None) -> dict[str, Layer]:
    """Read every layer that has something, by name; what is not shown counts as other things."""
    document = _opened(path)
    return _layers(document, _metres(document, unit))


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


def _layers(document: Document, metres: float) -> dict[str, Layer]:
    """All layers that have something, by name; what is not shown counts as other things."""
    from ezdxf.bbox import extents
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
    box = extents(chain.from_iterable(by_layer.values()), fast=True)
    extent = float(max(box.size.x, box.size.y)) if box.has_data else 0.0
    result = {name: _layer(entities, metres, extent * _OFF) for name, entities in by_layer.items()}
    for name, kinds in hidden.items():
        result.setdefault(name, Layer()).others.update(kinds)
    return result


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


_DRAWN = {"LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE", "POINT", "SOLID", "TRACE", "HATCH"}


def _layer(entities: Sequence[Any], metres: float, off: float) -> Layer:
    """Sort the entities of a layer; lengths are the drawing's until they are put into metres here."""
    from ezdxf import edgeminer, edgesmith

    def corners(points: Iterable[tuple[float, float, float]]) -> tuple[Corner, ...]:
        kept: list[Corner] = []
        for x, y, bulge in points:
            corner = Corner(float(x) * metres, float(y) * metres, float(bulge))
            if kept and corner.is_at(kept[-1]):
                # One place drawn twice: the side that goes on is the later one's.
                kept[-1] = kept[-1]._replace(bulge=corner.bulge)
            else:
                kept.append(corner)
        return tuple(kept)

    loops, fills, points, others = [], [], [], Counter[str]()
    open_ones: list[Any] = []
    for entity in entities:
        kind = entity.dxftype()
        if kind in ("ELLIPSE", "SPLINE"):
            entity = _in_arcs(entity, off)
        if kind == "POINT":
            points.append((entity.dxf.location.x * metres, entity.dxf.location.y * metres))
        elif kind == "CIRCLE" or (kind == "ARC" and edgesmith.is_closed_entity(entity)):
            center = Corner(entity.dxf.center.x * metres, entity.dxf.center.y * metres)
            loops.append(Loop((center,), entity.dxf.radius * metres))
        elif kind in ("SOLID", "TRACE", "HATCH"):
            fills += [_closed(corners((v.x, v.y, 0.0) for v in ring)) for ring in _rings(entity, off)]
        elif kind not in _DRAWN or (kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline)):
            others[kind] += 1
        elif edgesmith.is_closed_entity(entity):
            loops.append(_closed(corners(_vertices(entity))))
        else:
            open_ones.append(entity)
    edges = _once(edgesmith.edges_from_entities_2d(open_ones, gap_tol=GAP / metres), GAP / metres)
    edges = whole_lines(edges, GAP / metres)
    lines = []
    chains = edgeminer.find_all_simple_chains(edgeminer.Deposit(edges, gap_tol=GAP / metres)) if edges else ()
    # They come in the order of a set.
    for some in sorted(chains, key=lambda edges: min(edge.id for edge in edges)):
        whole = edgesmith.polyline2d_from_chain(some, max_sagitta=off)
        joined = corners((v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0)) for v in whole.vertices)
        if edgeminer.is_loop(some, gap_tol=GAP / metres):
            loops.append(_closed(joined))
        elif len(joined) > 1:
            lines.append(joined)
    thin = [loop for loop in (*loops, *fills) if loop.is_thin]
    loops, fills = ([loop for loop in part if loop not in thin] for part in (loops, fills))
    return Layer(loops, fills, lines, points, thin, others)


def _closed(corners: tuple[Corner, ...]) -> Loop:
    """Leave out the last corner if it is the first again; arcs of one circle are that."""
    from ezdxf.math import bulge_center, bulge_radius

    again = len(corners) > 1 and corners[0].is_at(corners[-1])
    loop = Loop(corners[:-1] if again else corners)
    bulges = [corner.bulge for corner in loop.corners]
    if len(bulges) < 2 or not (all(bulge > 0 for bulge in bulges) or all(bulge < 0 for bulge in bulges)):
        return loop
    arcs = [(a[:2], b[:2], a.bulge) for a, b in loop]
    circles = [(*bulge_center(*arc), bulge_radius(*arc)) for arc in arcs]
    turned = sum(4 * math.atan(abs(bulge)) for bulge in bulges)
    if abs(turned - math.tau) > 0.1 or any(math.dist(one, circles[0]) > GAP for one in circles):
        return loop
    return Loop((Corner(*circles[0][:2]),), circles[0][2])


def _rings(entity: Any, off: float) -> Iterator[Any]:
    """Yield what bounds a filled area, of curves points."""
    from ezdxf.path import from_hatch

    if entity.dxftype() == "HATCH":
        yield from (list(path.flattening(off)) for path in from_hatch(entity))
    else:
        yield entity.wcs_vertices()


def _in_arcs(entity: Any, off: float) -> Any:
    """A spline or an ellipse as a polyline of arcs that leave it by little."""
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

    made = LWPolyline.new(dxfattribs={"layer": entity.dxf.layer})
    # A closed curve has no chord from end to end.
    parts = [part for i in range(4) for part in _arcs(at, 0.25 * i, 0.25 * (i + 1), off)]
    last = at(1.0)
    made.set_points([*((p.x, p.y, bulge) for p, bulge in parts), (last.x, last.y, 0.0)], format="xyb")
    made.closed = last.distance(parts[0][0]) <= off
    return made


def _arcs(
    at: Callable[[float], Vec2], begin: float, end: float, off: float, depth: int = 0
) -> list[tuple[Vec2, float]]:
    """Where arcs along a part of a curve begin, with their bulges."""
    p, q, half = at(begin), at(end), (begin + end) / 2
    bulge = _bulge(p, at(half), q)
    between = (at(begin + part * (end - begin)) for part in (0.125, 0.25, 0.75, 0.875))
    if depth == _HALVED or all(_off_arc(z, p, q, bulge) <= off for z in between):
        return [(p, bulge)]
    return _arcs(at, begin, half, off, depth + 1) + _arcs(at, half, end, off, depth + 1)


def _bulge(p: Vec2, middle: Vec2, q: Vec2) -> float:
    """Bulge of the arc through three points; 0 where they are on a line, or two of them are one."""
    from ezdxf.math import bulge_3_points

    half = 0.5 * p.distance(q)
    if min(half, middle.distance(p), middle.distance(q)) <= _FLAT * max(half, middle.distance(p)):
        return 0.0
    bulge = bulge_3_points(p, q, middle)
    return bulge if abs(bulge) >= _FLAT else 0.0


def _off_arc(z: Vec2, p: Vec2, q: Vec2, bulge: float) -> float:
    """Distance of a point from the circle, or line, of an arc."""
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


def _once(edges: Iterable[Any], gap: float) -> list[Any]:
    """Leave out what is drawn twice, in either sense."""
    kept: list[Any] = []
    near: dict[tuple[int, int], list[list[Vec2]]] = defaultdict(list)
    for edge in edges:
        way = _way(edge.payload, gap)
        x, y = math.floor(way[2].x / gap), math.floor(way[2].y / gap)
        others = [other for i in (-1, 0, 1) for j in (-1, 0, 1) for other in near[x + i, y + j]]
        if any(_same(way, other, gap) or _same(way[::-1], other, gap) for other in others):
            continue
        near[x, y].append(way)
        kept.append(edge)
    return kept


def _same(way: list[Vec2], other: list[Vec2], gap: float) -> bool:
    return all(a.isclose(b, rel_tol=0.0, abs_tol=gap) for a, b in zip(way, other, strict=True))


def _way(entity: Any, gap: float) -> list[Vec2]:
    """Points of a line at quarters of its length; of its ends alone its mirror image has the same."""
    from ezdxf.math import Vec2
    from ezdxf.path import make_path

    points = [Vec2(at) for at in make_path(entity).flattening(_CLOSE * gap)]
    far = [0.0, *accumulate(a.distance(b) for a, b in pairwise(points))]
    way = [points[0]]
    for part in (0.25, 0.5, 0.75):
        i = min(bisect_right(far, part * far[-1]), len(points) - 1)
        step = far[i] - far[i - 1]
        way.append(points[i - 1].lerp(points[i], (part * far[-1] - far[i - 1]) / step if step else 0.0))
    return [*way, points[-1]]
