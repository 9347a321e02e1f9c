"""Give what is on the layers of a DXF drawing its role: outline, holes, zones, points and lines where it may stand."""

from __future__ import annotations

import math
import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TypeVar

from signorini.errors import InputError
from signorini.formats.drawing import (
    GAP,
    THICKNESSES,
    Corner,
    Drawing,
    Loop,
    about,
    beside_others,
    flattened,
    middles_of_lines,
    middles_of_loops,
    place,
)
from signorini.formats.drawing_toml import checked
from signorini.formats.dxf_entities import Layer, layers_in

_T = TypeVar("_T")

ROLES = ("outline", "holes", "zones", "points", "lines")
"""What a layer may hold; the layer of this name does where no other is named."""
_FRAME = 0.1
"""Part of the outline's area from which on a closed line of another layer may be the slab, and the outline a frame."""
_ROUND = 12
"""Corners from which on a filled area may be a circle."""
_TURN = math.radians(4)
"""Turn of the chords of arcs that are asked whether they are on the plate."""
_STEP = 0.1
"""Metres between points at which lines are asked whether they are on the plate."""


def read_dxf(path: str | os.PathLike[str], layers: Mapping[str, Sequence[str]], unit: str | None = None) -> Drawing:
    """Read a drawing.

    Arcs and circles stay what they are; splines and ellipses become arcs that leave them by at most 1/20000 of the
    drawing's size. Blocks are taken apart. Ends less than a millimetre apart are joined. ``layers`` are those of each
    role, any of `ROLES`, in upper or lower case. Without a layer the outline is the largest closed line of the drawing,
    and the holes are the closed lines within it on the outline's layer. ``unit`` is any of
    `signorini.base.units.METRES`; by default what the drawing's header says.
    """
    result = layers_in(path, unit)
    names = {role: _named(role, layers.get(role, ()), result) for role in ROLES}
    roles = {role: [result[name] for name in named] for role, named in names.items()}
    others = {name for role, named in names.items() if role != "outline" for name in named}
    among = {name: one for name, one in result.items() if name in (names["outline"] or result.keys() - others)}
    outline, layer = _outline(among, "the drawing" if not names["outline"] else _layers(names["outline"]))
    frame = "" if names["outline"] else _maybe_frame(outline, layer, among)
    left = _beyond(outline, among[layer], layer)
    result[layer].loops.remove(outline)
    own = [one.loops for one in roles["holes"] or [result[layer]]]
    closed = _all_of(own)
    holes = [loop for loop in closed if outline.holds(loop)]
    off = [loop for loop in closed if loop not in holes]
    if names["holes"]:
        left += _left(off, "holes", "not inside the outline; an opening at an edge is part of it")
    else:
        result[layer].loops += off
    closed = _all_of(one.loops for one in roles["zones"])
    zones = [zone for zone in closed if outline.covers(zone.points)]
    left += _left((zone for zone in closed if zone not in zones), "zones", "not within the outline")

    def on_plate(*points: tuple[float, float]) -> bool:
        return outline.covers(points) and not any((hole.has(points) & ~hole.near(points)).any() for hole in holes)

    middles: list[str] = []
    points = _points(roles["points"], on_plate, left)
    lines = _lines(roles["lines"], on_plate, middles, left)
    left += [f"layer {name}: {rest}" for name, rest in sorted(result.items()) if str(rest)]
    if names["holes"] and (inside := sum(map(outline.holds, result[layer].loops))):
        left.append(
            f"{inside} of the closed lines of layer {layer} are inside the outline: if they are holes, put them on "
            f"{_layers(names['holes'])}"
        )
    drawing = checked(Drawing(outline, tuple(holes), tuple(zones), points, tuple(lines), (), tuple(left)))
    took = [
        f"outline: {_sides(drawing.outline)}, {drawing.outline.area:.6g} m², layer {layer}{frame}",
        *(f"hole {i}: {_sides(hole)} about {place(hole.middle)}" for i, hole in enumerate(drawing.holes, 1)),
        *(f"zone {i}: {_sides(zone)} about {place(zone.middle)}" for i, zone in enumerate(drawing.zones, 1)),
        *(f"points: {len(at)}{_footprint(footprint)}" for footprint, at in drawing.points.items()),
        *([f"lines: {len(drawing.lines)}"] if drawing.lines else []),
        *middles,
    ]
    return replace(drawing, took=tuple(took))


def _left(loops: Iterable[Loop], what: str, why: str) -> list[str]:
    """Say where loops are that were left, and why."""
    middles = [loop.middle for loop in loops]
    return [f"{what}: {len(middles)}{about(middles)}: {why}"] if middles else []


def _all_of(lists: Iterable[list[_T]]) -> list[_T]:
    """Take everything out of lists."""
    taken = []
    for things in lists:
        taken += things
        things.clear()
    return taken


def _named(role: str, wanted: Sequence[str], result: Mapping[str, Layer]) -> list[str]:
    """The drawing's own spelling of layers, each once."""
    by_name = {name.lower(): name for name in result}
    for name in wanted:
        if name.lower() not in by_name:
            there = ", ".join(sorted(result)) or "none"
            raise InputError(f"the drawing has nothing on a layer {name!r}. Its layers are: {there}.", place=role)
    asked = dict.fromkeys(name.lower() for name in wanted or (role,))
    return [by_name[name] for name in asked if name in by_name]


def _layers(names: Sequence[str]) -> str:
    return f"layer{'s' * (len(names) > 1)} {', '.join(names)}"


def _outline(among: Mapping[str, Layer], where: str) -> tuple[Loop, str]:
    """The largest closed line and its layer; open lines that reach over more are an outline that does not close."""
    ends = [line for one in among.values() for line in one.lines]
    candidates = [(loop, name) for name, one in among.items() for loop in one.loops]
    if not candidates and not ends:
        raise InputError(f"{where} has no closed line for the outline. Name another layer.", place="outline")
    if not candidates:
        longest = max(ends, key=len)
        first, last = longest[0], longest[-1]
        raise InputError(
            f"no line of {where} is closed. The longest has {len(longest) - 1} sides and ends at {place(first[:2])} "
            f"and {place(last[:2])} m. Join these ends in the drawing.",
            place="outline",
        )
    largest, layer = max(candidates, key=lambda pair: _size(pair[0]))
    for name, one in among.items():
        for group in _connected(one.lines):
            box = Loop(tuple(Corner(*at) for line in group for at in flattened(line, _TURN))).box
            width, height = box[2] - box[0], box[3] - box[1]
            if width * height > _size(largest) + GAP * (width + height):
                raise InputError(
                    f"the largest closed line of {where} has {largest.area:.6g} m², but open lines of layer {name} "
                    f"reach over {width:.6g} m × {height:.6g} m: they do not close{_loose(group)}. Join them in the "
                    "drawing; if they are not the outline, name its layer or put them on another.",
                    place="outline",
                )
    return largest, layer


def _connected(lines: Sequence[tuple[Corner, ...]]) -> list[list[tuple[Corner, ...]]]:
    """Groups of open lines that meet at their ends."""
    groups: list[list[tuple[Corner, ...]]] = []
    for line in lines:
        ends = line[0], line[-1]
        meeting = [one for one in groups if any(p.is_at(q) for of in one for p in (of[0], of[-1]) for q in ends)]
        groups = [one for one in groups if one not in meeting]
        groups.append([line, *(of for one in meeting for of in one)])
    return groups


def _loose(group: Sequence[tuple[Corner, ...]]) -> str:
    """Say where open lines end alone, or if they do nowhere, where more than two meet."""
    ends = sorted(end for line in group for end in (line[0], line[-1]))
    meet = {end[:2]: sum(end.is_at(other) for other in ends) for end in ends}
    alone = [at for at, count in meet.items() if count == 1]
    if alone:
        return f"; they end{about(alone)}"
    many = [at for at, count in meet.items() if count > 2]
    once = [at for i, at in enumerate(many) if not any(math.dist(at, other) < 2 * GAP for other in many[:i])]
    return f"; more than two meet{about(once)}"


def _beyond(outline: Loop, layer: Layer, name: str) -> list[str]:
    """Say where open lines of the outline's layer reach beyond it."""
    places = [line[0][:2] for line in layer.lines if not outline.covers(flattened(line, _TURN))]
    lines = f"{len(places)} open line{'s' * (len(places) > 1)} of layer {name}{about(places)}"
    advice = "If the slab reaches there, join them to its outline"
    return [f"outline: {lines}: beyond it. {advice}"] if places else []


def _maybe_frame(outline: Loop, layer: str, among: Mapping[str, Layer]) -> str:
    """Name the largest closed line of another layer that may be the slab."""
    rest = [(loop, name) for name, one in among.items() if name != layer for loop in one.loops]
    other, name = max(rest, key=lambda pair: _size(pair[0]), default=(None, ""))
    if other is None or _size(other) < _FRAME * _size(outline):
        return ""
    return (
        f", the largest closed line of the drawing. If it is a frame, name the slab's layer with --outline: layer "
        f"{name} has one of {other.area:.6g} m²"
    )


def _size(loop: Loop) -> float:
    """Area; of a line that crosses itself parts of it cancel, so that of its box."""
    left, bottom, right, top = loop.box
    return loop.area if loop.is_simple else (right - left) * (top - bottom)


def _points(
    layers: Sequence[Layer], on_plate: Callable[..., bool], left: list[str]
) -> dict[tuple[float, ...], list[tuple[float, float]]]:
    """Places by their footprints; what is left, of them or of their shape, is told.

    An area that is filled and outlined is one place.
    """
    shapes: list[tuple[Loop | None, tuple[float, float]]] = []
    twice: list[tuple[float, float]] = []
    fills = _all_of(one.fills for one in layers)
    for loop in _all_of(one.loops for one in layers) + [_as_circle(fill) for fill in fills]:
        if not any(math.dist(at, loop.middle) < GAP for _, at in shapes):
            shapes.append((loop, loop.middle))
    for point in _all_of(one.points for one in layers):
        if any(math.dist(at, point) < GAP for _, at in shapes):
            twice.append(point)
        else:
            shapes.append((None, point))
    result: dict[tuple[float, ...], list[tuple[float, float]]] = defaultdict(list)
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
        result[footprint].append(at)
    for places, why in (
        (twice, "drawn twice; taken once"),
        (off, "not on the plate; left"),
        (over, "their shape reaches beyond the plate; points without footprint"),
        (loose, "neither circles nor rectangles; points without footprint"),
    ):
        left += [f"points: {len(places)}{about(places)}: {why}"] if places else []
    return dict(result)


def _as_circle(loop: Loop) -> Loop:
    """A closed line of many corners at one distance from its middle as a circle."""
    x, y = loop.middle
    radii = [math.dist(corner[:2], (x, y)) for corner in loop.corners]
    if len(radii) < _ROUND or max(radii) - min(radii) > GAP + 0.01 * max(radii):
        return loop
    return Loop((Corner(x, y),), max(radii))


def _lines(
    layers: Sequence[Layer], on_plate: Callable[..., bool], middles: list[str], left: list[str]
) -> list[tuple[Corner, ...]]:
    """Open lines, and of walls drawn with their faces the lines along their middles; what leaves the plate is told."""
    closed = _all_of(one.loops for one in layers)
    whole = [(loop, loop.middle_line) for loop in closed]
    along = [tuple(Corner(*at) for at in middle) for _, middle in whole if middle is not None]
    rings, rest = middles_of_loops([loop for loop, middle in whole if middle is None])
    if along or rings:
        middles.append(
            f"lines: walls drawn as closed lines, {len(along) + len(rings)}"
            f"{about([line[0][:2] for line in (*along, *rings)])}: the lines along their middles"
        )
    if rest:
        left.append(
            f"lines: {len(rest)} closed{about([loop.middle for loop in rest])}: no wall of one thickness. Draw its "
            "middle, or a rectangle of each straight part"
        )
    drawn, pairs = middles_of_lines(_all_of(one.lines for one in layers))
    if pairs:
        apart = f"{pairs[0][0]:.3g} m apart" if len(pairs) == 1 else f"{pairs[0][0]:.3g} to {pairs[-1][0]:.3g} m apart"
        middles.append(
            f"lines: {len(pairs)} pair{'s' * (len(pairs) > 1)} side by side, {apart}{about([at for _, at in pairs])}: "
            "faces of walls, the lines along their middles"
        )
    drawn += [*along, *rings]
    if beside := beside_others(drawn):
        middles.append(
            f"lines: {len(beside)}{about(beside)}: beside another, less than {THICKNESSES[1]:g} m apart; both are "
            "supports. Keep one where they are the faces of one wall"
        )
    lines: list[tuple[Corner, ...]] = []
    off: list[tuple[float, float]] = []
    for line in drawn:
        chords = flattened(line, _TURN)
        between = [at for a, b in pairwise(chords) for at in _spaced(a, b)]
        if on_plate(*chords, *between):
            lines.append(line)
        else:
            off.append(chords[0])
    left += [f"lines: {len(off)}{about(off)}: not on the plate; left"] if off else []
    return lines


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
