"""Read what a DXF drawing says about a plate: its outline, holes, and points and lines where it may stand."""

from __future__ import annotations

import math
import os
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations, pairwise
from typing import TYPE_CHECKING, Any, TypeVar

from signorini.base.units import METRES
from signorini.errors import InputError, SignoriniError, point
from signorini.formats.drawing import GAP, Corner, Drawing, Loop, flattened

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document
    from ezdxf.entities.dxfentity import DXFEntity

_T = TypeVar("_T")

ROLES = ("outline", "holes", "zones", "points", "lines")
"""What a layer may hold; the layer of this name does where no other is named."""
_HEADER_UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 14: "dm"}
"""Units by the number that the header of a drawing gives, $INSUNITS."""
_OFF = 1 / 20000
"""Part of the drawing's size by which arcs may leave a spline or an ellipse: they meet at less than 1° then."""
_HALVED = 8
"""Times that a spline may be halved for arcs: what bends more sharply has a corner there."""
_FLAT = 1e-6
"""Rise over chord of an arc that is a line."""
_ROUND = 12
"""Corners from which on a filled area may be a circle."""
_TURN = math.radians(4)
"""Turn of the chords of arcs that are asked whether they are on the plate."""
_STEP = 0.1
"""Metres between points at which lines are asked whether they are on the plate."""
_WALLS = (0.05, 0.6)
"""Metres between the faces of walls."""
_MATCHED, _SHARED = 0.75, 0.25
"""Part of the longer of two faces that both have: of those taken for one wall, and of those that may be."""
_LONG = 3.0
"""Length over distance from which on two lines are a wall."""
_ASKEW = 0.01
"""Slope to each other of parallel lines: half a degree, that of a careless drawing."""
_MOST_PLACES = 3
"""Places that a line of what is left names."""
_DEEPEST = 16
"""Blocks within blocks; more are blocks within themselves."""


@dataclass
class _Layer:
    """What is on one layer, in metres, and the kinds of what is none of it; each role takes what it uses."""

    loops: list[Loop] = field(default_factory=list)
    fills: list[Loop] = field(default_factory=list)
    lines: list[tuple[Corner, ...]] = field(default_factory=list)
    points: list[tuple[float, float]] = field(default_factory=list)
    others: Counter[str] = field(default_factory=Counter)

    def __str__(self) -> str:
        found = [
            (len(self.loops), "closed line"),
            (len(self.fills), "filled area"),
            (len(self.lines), "open line"),
            (len(self.points), "point"),
            *((count, kind) for kind, count in sorted(self.others.items())),
        ]
        return ", ".join(
            f"{count} {kind}{'s' if count > 1 and kind.islower() else ''}" for count, kind in found if count
        )


def read_dxf(path: str | os.PathLike[str], layers: Mapping[str, str], unit: str | None = None) -> Drawing:
    """Read a drawing.

    Arcs and circles stay what they are; splines and ellipses become arcs that leave them by at most 1/20000 of the
    drawing's size. Blocks are taken apart. Ends less than a millimetre apart are joined.

    Parameters
    ----------
    path : path
    layers : dict
        Layer of each role, any of `ROLES`, in upper or lower case. Without a layer the outline is the largest closed
        line of the drawing, and the holes are the closed lines within it on the outline's layer.
    unit : str, optional
        Of the drawing, any of `signorini.base.units.METRES`; by default what its header says.

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
    left: list[str] = []
    own = found[names["holes"] or layer].loops
    holes, off = _parted(own, outline.holds)
    own[:] = [] if names["holes"] else off
    left += _told(off if names["holes"] else [], "holes", "not inside the outline; an opening at an edge is part of it")
    zones: list[Loop] = []
    if names["zones"]:
        zones, off = _parted(_all_of(found[names["zones"]].loops), lambda zone: outline.covers(zone.points))
        left += _told(off, "zones", "not within the outline")

    def on_plate(*points: tuple[float, float]) -> bool:
        return outline.covers(points) and not any(
            hole.has(*at) and not hole.near(*at) for hole in holes for at in points
        )

    points = _points(found[names["points"]], on_plate, left) if names["points"] else {}
    lines = _lines(found[names["lines"]], on_plate, left) if names["lines"] else []
    took = [
        f"outline: {_sides(outline)}, {outline.area:.6g} m², layer {layer}",
        *(f"hole {i}: {_sides(hole)} about {point(hole.middle)}" for i, hole in enumerate(holes, 1)),
        *(f"zone {i}: {_sides(zone)} about {point(zone.middle)}" for i, zone in enumerate(zones, 1)),
        *(f"points: {len(at)}{_footprint(footprint)}" for footprint, at in points.items()),
        *([f"lines: {len(lines)}"] if lines else []),
    ]
    left += [f"layer {name}: {rest}" for name, rest in sorted(found.items()) if str(rest)]
    if inside := sum(map(outline.holds, found[layer].loops)):
        left.append(
            f"{inside} of the closed lines of layer {layer} are inside the outline: if they are holes, put them on "
            f"layer {names['holes']}"
        )
    return Drawing(outline, tuple(holes), tuple(zones), points, tuple(lines), tuple(took), tuple(left))


def _parted(loops: Iterable[Loop], kept: Callable[[Loop], bool]) -> tuple[list[Loop], list[Loop]]:
    """Those that are kept, and the others."""
    sorts: tuple[list[Loop], list[Loop]] = ([], [])
    for loop in loops:
        sorts[not kept(loop)].append(loop)
    return sorts


def _told(loops: Iterable[Loop], what: str, why: str) -> Iterator[str]:
    """Say where loops are that were left, and why."""
    middles = [loop.middle for loop in loops]
    if middles:
        yield f"{what}: {len(middles)}{_about(middles)}: {why}"


def _about(places: Sequence[tuple[float, float]]) -> str:
    more = ", …" if len(places) > _MOST_PLACES else ""
    return f", at {', '.join(map(point, places[:_MOST_PLACES]))}{more}"


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
    found = {name: _layer(entities, metres, extent * _OFF) for name, entities in by_layer.items()}
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


_DRAWN = {"LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE", "POINT", "SOLID", "TRACE", "HATCH"}


def _extent(entities: Iterable[Any]) -> float:
    from ezdxf.bbox import extents

    box = extents(entities, fast=True)
    return float(max(box.size.x, box.size.y)) if box.has_data else 0.0


def _layer(entities: Sequence[Any], metres: float, off: float) -> _Layer:
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
        elif kind == "CIRCLE":
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
    lines = []
    chains = edgeminer.find_all_simple_chains(edgeminer.Deposit(edges, gap_tol=GAP / metres)) if edges else ()
    for chain in chains:
        whole = edgesmith.polyline2d_from_chain(chain, max_sagitta=off)
        joined = corners((v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0)) for v in whole.vertices)
        if edgeminer.is_loop(chain, gap_tol=GAP / metres):
            loops.append(_closed(joined))
        elif len(joined) > 1:
            lines.append(joined)
    thin = [loop for loop in (*loops, *fills) if loop.area < GAP**2]
    others.update({"sliver": len(thin)} if thin else {})
    loops, fills = ([loop for loop in part if loop not in thin] for part in (loops, fills))
    return _Layer(loops, fills, lines, points, others)


def _closed(corners: tuple[Corner, ...]) -> Loop:
    """Leave out the last corner if it is the first again."""
    again = len(corners) > 1 and corners[0].is_at(corners[-1])
    return Loop(corners[:-1] if again else corners)


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

    curve = entity.construction_tool()
    if entity.dxftype() == "ELLIPSE":
        begin, end = entity.dxf.start_param, entity.dxf.end_param
        end += 0.0 if end > begin else math.tau

        def at(t: float) -> complex:
            (v,) = curve.vertices([begin + t * (end - begin)])
            return complex(v.x, v.y)
    else:

        def at(t: float) -> complex:
            v = curve.point(t * curve.max_t)
            return complex(v.x, v.y)

    made = LWPolyline.new(dxfattribs={"layer": entity.dxf.layer})
    # A closed curve has no chord from end to end.
    parts = [part for i in range(4) for part in _arcs(at, 0.25 * i, 0.25 * (i + 1), off)]
    last = at(1.0)
    made.set_points([*((p.real, p.imag, bulge) for p, bulge in parts), (last.real, last.imag, 0.0)], format="xyb")
    made.closed = abs(last - parts[0][0]) <= off
    return made


def _arcs(
    at: Callable[[float], complex], begin: float, end: float, off: float, depth: int = 0
) -> list[tuple[complex, float]]:
    """Where arcs along a part of a curve begin, with their bulges."""
    p, q, half = at(begin), at(end), (begin + end) / 2
    bulge = _bulge(p, at(half), q)
    between = (at(begin + part * (end - begin)) for part in (0.125, 0.25, 0.75, 0.875))
    if depth == _HALVED or all(_off_arc(z, p, q, bulge) <= off for z in between):
        return [(p, bulge)]
    return _arcs(at, begin, half, off, depth + 1) + _arcs(at, half, end, off, depth + 1)


def _bulge(p: complex, middle: complex, q: complex) -> float:
    """Bulge of the arc through three points; 0 where they are on a line, or two of them are one."""
    if abs(q - p) <= _FLAT * abs(middle - p):
        return 0.0
    # Where the chord reaches from −1 to 1, the centre is above 0.
    m = (middle - (p + q) / 2) / ((q - p) / 2)
    if abs(m.imag) < _FLAT:
        return 0.0
    height = (abs(m) ** 2 - 1) / (2 * m.imag)
    return -height - math.copysign(math.hypot(1.0, height), m.imag)


def _off_arc(z: complex, p: complex, q: complex, bulge: float) -> float:
    """Distance of a point from the circle, or line, of an arc."""
    half = (q - p) / 2
    if not half:
        return abs(z - p)
    local = (z - (p + q) / 2) / half
    if not bulge:
        return abs(local.imag) * abs(half)
    height = (1.0 - bulge * bulge) / (2.0 * bulge)
    return abs(abs(local - 1j * height) - math.hypot(1.0, height)) * abs(half)


def _vertices(entity: Any) -> Iterator[tuple[float, float, float]]:
    if entity.dxftype() == "LWPOLYLINE":
        yield from entity.get_points("xyb")
    else:
        yield from ((v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0)) for v in entity.vertices)


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


def _points(
    layer: _Layer, on_plate: Callable[..., bool], left: list[str]
) -> dict[tuple[float, ...], list[tuple[float, float]]]:
    """Places by their footprints; what is left, of them or of their shape, is told.

    An area that is filled and outlined is one place.
    """
    shapes: list[tuple[Loop | None, tuple[float, float]]] = [(None, at) for at in _all_of(layer.points)]
    for loop in _all_of(layer.loops) + [_as_circle(fill) for fill in _all_of(layer.fills)]:
        if not any(one is not None and math.dist(at, loop.middle) < GAP for one, at in shapes):
            shapes.append((loop, loop.middle))
    found: dict[tuple[float, ...], list[tuple[float, float]]] = defaultdict(list)
    off: list[tuple[float, float]] = []
    over, loose = off.copy(), off.copy()
    for shape, at in shapes:
        footprint: tuple[float, ...] = ()
        if not on_plate(at):
            off.append(at)
            continue
        if shape is not None:
            size = (shape.radius,) if shape.radius else shape.sides or shape.turned_sides
            if size is None:
                loose.append(at)
            elif not on_plate(*shape.points):
                over.append(at)
            else:
                footprint = tuple(round(part, 3) for part in size)
        found[footprint].append(at)
    for places, why in (
        (off, "not on the plate; left"),
        (over, "their shape reaches beyond the plate; points without footprint"),
        (loose, "neither circles nor rectangles; points without footprint"),
    ):
        left += [f"points: {len(places)}{_about(places)}: {why}"] if places else []
    return dict(found)


def _as_circle(loop: Loop) -> Loop:
    """A closed line of many corners at one distance from its middle as a circle."""
    x, y = loop.middle
    radii = [math.dist(corner[:2], (x, y)) for corner in loop.corners]
    if len(radii) < _ROUND or max(radii) - min(radii) > GAP + 0.01 * max(radii):
        return loop
    return Loop((Corner(x, y),), max(radii))


def _lines(layer: _Layer, on_plate: Callable[..., bool], left: list[str]) -> list[tuple[Corner, ...]]:
    """Open lines, and of long rectangles the lines along their middles; what leaves the plate is told."""
    walls = [(loop, loop.middle_line) for loop in layer.loops]
    layer.loops[:] = [loop for loop, middle in walls if middle is None]
    middles = [tuple(Corner(*at) for at in middle) for _, middle in walls if middle is not None]
    if middles:
        left.append(f"lines: {len(middles)} closed rectangles became the lines along their middles")
    drawn, pairs = _walls(_all_of(layer.lines))
    if pairs:
        apart = f"{pairs[0][0]:.3g} m apart" if len(pairs) == 1 else f"{pairs[0][0]:.3g} to {pairs[-1][0]:.3g} m apart"
        left.append(
            f"lines: {len(pairs)} pair{'s' * (len(pairs) > 1)} side by side, {apart}{_about([at for _, at in pairs])}: "
            "taken for the faces of walls, which became the lines along their middles"
        )
    if beside := _beside_others([*drawn, *middles]):
        left.append(
            f"lines: {len(beside)}{_about(beside)}: beside another, less than {_WALLS[1]:g} m apart; both are "
            "supports. Keep one where they are the faces of one wall"
        )
    lines: list[tuple[Corner, ...]] = []
    off: list[tuple[float, float]] = []
    for line in (*drawn, *middles):
        chords = flattened(line, _TURN)
        between = [at for a, b in pairwise(chords) for at in _spaced(a, b)]
        if on_plate(*chords, *between):
            lines.append(line)
        else:
            off.append(chords[0])
    left += [f"lines: {len(off)}{_about(off)}: not on the plate; left"] if off else []
    return lines


def _walls(
    lines: Sequence[tuple[Corner, ...]],
) -> tuple[list[tuple[Corner, ...]], list[tuple[float, tuple[float, float]]]]:
    """Lines, of straight ones that are two faces of a wall the middle; distances of those, and where they begin."""
    sides = {i: (line[0], line[1]) for i, line in enumerate(lines) if len(line) == 2 and not line[0].bulge}
    pairs = sorted(
        (apart, i, j)
        for (i, one), (j, other) in combinations(sides.items(), 2)
        if (apart := _apart(one, other, _MATCHED)) is not None
    )
    middle: dict[int, tuple[Corner, ...]] = {}
    found: list[tuple[float, tuple[float, float]]] = []
    for apart, i, j in pairs:
        (a, b), (c, d) = sides[i], sides[j]
        if i in middle or j in middle or math.dist(a[:2], b[:2]) < _LONG * apart:
            continue
        if math.dist(a[:2], c[:2]) > math.dist(a[:2], d[:2]):
            c, d = d, c
        ends = [Corner((p.x + q.x) / 2, (p.y + q.y) / 2) for p, q in ((a, c), (b, d))]
        middle |= {i: tuple(ends), j: ()}
        found.append((apart, (ends[0].x, ends[0].y)))
    return [one for i, line in enumerate(lines) if (one := middle.get(i, line))], found


def _beside_others(lines: Sequence[tuple[Corner, ...]]) -> list[tuple[float, float]]:
    """Where lines begin of which a straight side is beside one of an earlier line."""
    sides = [[(a, b) for a, b in pairwise(line) if not a.bulge] for line in lines]
    return [
        (line[0].x, line[0].y)
        for i, line in enumerate(lines)
        if any(_apart(one, other, _SHARED) is not None for one in sides[i] for of in sides[:i] for other in of)
    ]


def _apart(one: tuple[Corner, Corner], other: tuple[Corner, Corner], share: float) -> float | None:
    """Distance [m] of parallel sides as far apart as the faces of a wall, with a share of the longer one in common."""
    (a, b), (c, d) = one, other
    length, along = math.dist(a[:2], b[:2]), (b.x - a.x, b.y - a.y)
    if length < math.dist(c[:2], d[:2]):
        return _apart(other, one, share)

    def local(p: Corner) -> tuple[float, float]:
        x, y = p.x - a.x, p.y - a.y
        return (x * along[0] + y * along[1]) / length, (x * along[1] - y * along[0]) / length

    (u, v), (s, t) = local(c), local(d)
    apart, common = abs(v + t) / 2, min(max(u, s), length) - max(min(u, s), 0.0)
    parallel = abs(v - t) < 2 * GAP + _ASKEW * abs(u - s)
    return apart if parallel and _WALLS[0] <= apart <= _WALLS[1] and common >= share * length else None


def _spaced(a: tuple[float, float], b: tuple[float, float]) -> list[tuple[float, float]]:
    """Points between two."""
    count = math.ceil(math.dist(a, b) / _STEP)
    return [(a[0] + i / count * (b[0] - a[0]), a[1] + i / count * (b[1] - a[1])) for i in range(1, count)]


def _sides(loop: Loop) -> str:
    if loop.radius:
        return f"circle of radius {loop.radius:.6g} m"
    arcs = sum(corner.bulge != 0 for corner in loop.corners)
    return f"{len(loop.corners)} sides{f', {arcs} of them curved' if arcs else ''}"


def _footprint(footprint: tuple[float, ...]) -> str:
    if not footprint:
        return ""
    if len(footprint) == 1:
        return f", radius {footprint[0]:g} m"
    turned = f", turned by {footprint[2]:g}°" if len(footprint) > 2 else ""
    return f", {footprint[0]:g} m × {footprint[1]:g} m{turned}"
