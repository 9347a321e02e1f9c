"""Give what is on the layers of a DXF drawing its role: outline, holes, zones, points and lines where it may stand."""

from __future__ import annotations

import math
import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from typing import TypeVar

from signorini.errors import InputError
from signorini.formats.drawing import GAP, Corner, Drawing, Loop, about, flattened, place
from signorini.formats.drawing_checked import checked
from signorini.formats.dxf_entities import Layer, layers_in

_T = TypeVar("_T")

ROLES = ("outline", "holes", "zones", "points", "lines")
"""What a layer may hold; the layer of this name does where no other is named."""
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
    found = layers_in(path, unit)
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
    left += [f"layer {name}: {rest}" for name, rest in sorted(found.items()) if str(rest)]
    if inside := sum(map(outline.holds, found[layer].loops)):
        left.append(
            f"{inside} of the closed lines of layer {layer} are inside the outline: if they are holes, put them on "
            f"layer {names['holes']}"
        )
    drawing = checked(Drawing(outline, tuple(holes), tuple(zones), points, tuple(lines), (), tuple(left)))
    took = [
        f"outline: {_sides(drawing.outline)}, {drawing.outline.area:.6g} m², layer {layer}",
        *(f"hole {i}: {_sides(hole)} about {place(hole.middle)}" for i, hole in enumerate(drawing.holes, 1)),
        *(f"zone {i}: {_sides(zone)} about {place(zone.middle)}" for i, zone in enumerate(drawing.zones, 1)),
        *(f"points: {len(at)}{_footprint(footprint)}" for footprint, at in drawing.points.items()),
        *([f"lines: {len(drawing.lines)}"] if drawing.lines else []),
    ]
    return replace(drawing, took=tuple(took))


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
        yield f"{what}: {len(middles)}{about(middles)}: {why}"


def _all_of(things: list[_T]) -> list[_T]:
    """Take everything out of a list."""
    taken = things.copy()
    things.clear()
    return taken


def _named(role: str, wanted: str | None, found: Mapping[str, Layer]) -> str | None:
    """The drawing's own spelling of a layer."""
    by_name = {name.lower(): name for name in found}
    if wanted is not None and wanted.lower() not in by_name:
        there = ", ".join(sorted(found)) or "none"
        raise InputError(f"the drawing has nothing on a layer {wanted!r}. Its layers are: {there}.", place=role)
    return by_name.get((role if wanted is None else wanted).lower())


def _outline(layer: str | None, found: Mapping[str, Layer]) -> tuple[Loop, str]:
    candidates = [(loop, name) for name, one in found.items() if layer in (None, name) for loop in one.loops]
    if candidates:
        return max(candidates, key=lambda pair: _size(pair[0]))
    where = "the drawing" if layer is None else f"layer {layer}"
    ends = [line for name, one in found.items() if layer in (None, name) for line in one.lines]
    if not ends:
        raise InputError(f"{where} has no closed line for the outline. Name another layer.", place="outline")
    longest = max(ends, key=len)
    first, last = longest[0], longest[-1]
    raise InputError(
        f"no line of {where} is closed. The longest has {len(longest) - 1} sides and ends at {place(first[:2])} and "
        f"{place(last[:2])} m. Join these ends in the drawing.",
        place="outline",
    )


def _size(loop: Loop) -> float:
    """Area; of a line that crosses itself parts of it cancel, so that of its box."""
    left, bottom, right, top = loop.box
    return loop.area if loop.is_simple else (right - left) * (top - bottom)


def _points(
    layer: Layer, on_plate: Callable[..., bool], left: list[str]
) -> dict[tuple[float, ...], list[tuple[float, float]]]:
    """Places by their footprints; what is left, of them or of their shape, is told.

    An area that is filled and outlined is one place.
    """
    shapes: list[tuple[Loop | None, tuple[float, float]]] = []
    twice: list[tuple[float, float]] = []
    for loop in _all_of(layer.loops) + [_as_circle(fill) for fill in _all_of(layer.fills)]:
        if not any(math.dist(at, loop.middle) < GAP for _, at in shapes):
            shapes.append((loop, loop.middle))
    for one in _all_of(layer.points):
        if any(math.dist(at, one) < GAP for _, at in shapes):
            twice.append(one)
        else:
            shapes.append((None, one))
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
        (twice, "drawn twice; taken once"),
        (off, "not on the plate; left"),
        (over, "their shape reaches beyond the plate; points without footprint"),
        (loose, "neither circles nor rectangles; points without footprint"),
    ):
        left += [f"points: {len(places)}{about(places)}: {why}"] if places else []
    return dict(found)


def _as_circle(loop: Loop) -> Loop:
    """A closed line of many corners at one distance from its middle as a circle."""
    x, y = loop.middle
    radii = [math.dist(corner[:2], (x, y)) for corner in loop.corners]
    if len(radii) < _ROUND or max(radii) - min(radii) > GAP + 0.01 * max(radii):
        return loop
    return Loop((Corner(x, y),), max(radii))


def _lines(layer: Layer, on_plate: Callable[..., bool], left: list[str]) -> list[tuple[Corner, ...]]:
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
            f"lines: {len(pairs)} pair{'s' * (len(pairs) > 1)} side by side, {apart}{about([at for _, at in pairs])}: "
            "taken for the faces of walls, which became the lines along their middles"
        )
    if beside := _beside_others([*drawn, *middles]):
        left.append(
            f"lines: {len(beside)}{about(beside)}: beside another, less than {_WALLS[1]:g} m apart; both are "
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
    left += [f"lines: {len(off)}{about(off)}: not on the plate; left"] if off else []
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
