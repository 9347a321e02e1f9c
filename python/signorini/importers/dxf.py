"""Assign roles to the layers of a DXF drawing: outline, holes, zones, points and lines."""

from __future__ import annotations

import math
import os
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TypeVar

from signorini.errors import InputError
from signorini.importers.drawing import (
    GAP,
    THICKNESSES,
    Corner,
    Drawing,
    Footprint,
    Loop,
    Lost,
    Slab,
    Spot,
    about,
    beside_others,
    flattened,
    footprint_at,
    middles_of_lines,
    middles_of_loops,
    place,
)
from signorini.importers.drawing_toml import checked, snap
from signorini.importers.dxf_entities import Layer, layers_in

_T = TypeVar("_T")

ROLES = ("outline", "holes", "zones", "points", "lines")
"""Roles of layers in the model. Unless an option names the layers of a role, the layer with the role's name has it."""
_FRAME = 0.1
"""Closed lines on other layers are mentioned as possible slab from this fraction of the outline's area on.

The outline, the largest closed line, may be the frame of the drawing.
"""
_ROUND = 12
"""Smallest number of corners of a filled area that is imported as a circle if its corners are on a circle."""
_TURN = math.radians(4)
"""Largest angle [rad] between the points of an arc at which it is tested whether the arc is on the plate."""
_STEP = 0.1
"""Largest distance [m] between the points of a line at which it is tested whether the line is on the plate."""


def read_dxf(path: str | os.PathLike[str], layers: Mapping[str, Sequence[str]], unit: str | None = None) -> Drawing:
    """Read a DXF drawing and sort its shapes by roles; all lengths are converted to metres.

    Arcs and circles are exact; splines and ellipses are approximated by arcs within 1/20000 of the drawing's size.
    Blocks are replaced by their entities. Ends less than a millimetre apart are joined. ``layers`` are the layer names
    of each role in `ROLES`, in upper or lower case. If no layer has the role "outline", the outline is the largest
    closed line of the drawing. If no layer has the role "holes", the holes are the closed lines inside the outline on
    its layer. ``unit`` is a key of `signorini.base.units.METRES`; the default is the unit in the drawing's header.
    """
    result = layers_in(path, unit)
    names = {role: _named(role, layers.get(role, ()), result) for role in ROLES}
    roles = {role: [result[name] for name in named] for role, named in names.items()}
    others = {name for role, named in names.items() if role != "outline" for name in named}
    among = {name: one for name, one in result.items() if name in (names["outline"] or result.keys() - others)}
    outline, layer = _outline(among, "the drawing" if not names["outline"] else _layers(names["outline"]))
    frame = "" if names["outline"] else _maybe_frame(outline, layer, among)
    said = _Said(_beyond(outline, among[layer], layer))
    result[layer].loops.remove(outline)
    symbols = {role: [loop for one in those for loop in (*one.loops, *one.fills)] for role, those in roles.items()}
    closed = _all_of(one.loops for one in roles["holes"] or [result[layer]])
    holes = [loop for loop in closed if outline.holds(loop)]
    off = [loop for loop in closed if loop not in holes]
    apart = [] if names["holes"] else [loop for loop in off if not any(outline.has(loop.points))]
    result[layer].loops += apart
    crossing = [loop for loop in off if loop not in apart]
    said.lose(
        "holes",
        [loop.middle for loop in crossing],
        "not inside the outline; an opening at an edge must be part of the outline",
    )
    around, slab, within = Slab(outline, ()), Slab(outline, holes), snap(outline)
    zones = [_inside(zone, around, within) for zone in _all_of(one.loops for one in roles["zones"])]
    off = [zone for zone in zones if not around.covers(zone.points, within)]
    said.lose("zones", [loop.middle for loop in off], "not within the outline")
    points = _points(roles["points"], slab, within, said)
    lines = _lines(roles["lines"], slab, within, said)
    for name, rest in sorted(result.items()):
        said.left += [f"layer {name}: {rest}"] if str(rest) else []
        for role in ROLES[1:] if name not in names["outline"] else ():
            # No message is needed for a hatch or cross inside an imported shape, because it is a symbol of that shape.
            within_none = [at for at in rest.places if not any(one.covers(at) for one in symbols[role])]
            if name in names[role] and within_none:
                said.lost.append(Lost(role, len(within_none), f"layer {name}: {rest}"))
    if names["holes"] and (inside := sum(map(outline.holds, result[layer].loops))):
        said.left.append(
            f"{inside} of the closed lines of layer {layer} are inside the outline: if they are holes, put them on "
            f"{_layers(names['holes'])}"
        )
    zones = [zone for zone in zones if zone not in off]
    taken = Drawing(outline, tuple(holes), tuple(zones), points, tuple(lines), (), tuple(said.left), tuple(said.lost))
    drawing = checked(taken)
    took = [
        f"outline: {_sides(drawing.outline)}, {drawing.outline.area:.6g} m², layer {layer}{frame}",
        *drawing.counts,
        *(f"hole {i}: {_sides(hole)} about {place(hole.middle)}" for i, hole in enumerate(drawing.holes, 1)),
        *(f"zone {i}: {_sides(zone)} about {place(zone.middle)}" for i, zone in enumerate(drawing.zones, 1)),
        *(f"points: {len(at)}{_footprint(footprint)}" for footprint, at in drawing.points.items()),
        *said.changed,
    ]
    return replace(drawing, took=tuple(took))


class _Said:
    """Collects messages about shapes that were changed, and about shapes that were not imported.

    ``lost`` has role, number and message of shapes that could not be imported.
    """

    def __init__(self, left: list[str]) -> None:
        self.changed, self.left, self.lost = list[str](), left, list[Lost]()

    def lose(self, role: str, places: Sequence[Spot], why: str, what: str = "") -> None:
        """Add a message about shapes of a role that could not be imported; ``why`` is the reason.

        If only a part of each shape was not imported, such as the footprint of a point, ``what`` names this part.
        """
        for line in _line(role, places, why):
            self.left.append(line)
            self.lost.append(Lost(what or role, len(places), line))


def _line(role: str, places: Sequence[Spot], why: str) -> list[str]:
    return [f"{role}: {len(places)}{about(places)}: {why}"] if places else []


def _inside(zone: Loop, slab: Slab, most: float) -> Loop:
    """Return a circular or rectangular zone moved onto the slab by at most √2 ``most`` [m]; other zones unchanged."""
    size = zone.footprint
    at = None if size is None else slab.moved(zone.middle, size, most)
    return zone if size is None or at in (None, zone.middle) else footprint_at(at, size)


def _all_of(lists: Iterable[list[_T]]) -> list[_T]:
    """Return the items of all lists in one list, and empty the given lists."""
    taken = []
    for things in lists:
        taken += things
        things.clear()
    return taken


def _named(role: str, wanted: Sequence[str], result: Mapping[str, Layer]) -> list[str]:
    """Names of the layers that have a role, without repetition and spelled as in the drawing."""
    by_name = {name.lower(): name for name in result}
    for name in wanted:
        if name.lower() not in by_name:
            there = ", ".join(sorted(result)) or "none"
            raise InputError(f"the drawing has no layer {name!r} with shapes. Its layers are: {there}.", place=role)
    asked = dict.fromkeys(name.lower() for name in wanted or (role,))
    return [by_name[name] for name in asked if name in by_name]


def _layers(names: Sequence[str]) -> str:
    return f"layer{'s' * (len(names) > 1)} {', '.join(names)}"


def _outline(among: Mapping[str, Layer], where: str) -> tuple[Loop, str]:
    """Return the largest closed line and the name of its layer.

    Open lines that extend over a larger area are refused with a message, as an outline that is not closed.
    """
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
    """Return groups of open lines; the lines of a group are connected by common end points."""
    groups: list[list[tuple[Corner, ...]]] = []
    for line in lines:
        ends = line[0], line[-1]
        meeting = [one for one in groups if any(p.is_at(q) for of in one for p in (of[0], of[-1]) for q in ends)]
        groups = [one for one in groups if one not in meeting]
        groups.append([line, *(of for one in meeting for of in one)])
    return groups


def _loose(group: Sequence[tuple[Corner, ...]]) -> str:
    """Return a part of a message with the free ends of open lines or, without any, points where over two lines meet."""
    ends = sorted(end for line in group for end in (line[0], line[-1]))
    meet = {end[:2]: sum(end.is_at(other) for other in ends) for end in ends}
    alone = [at for at, count in meet.items() if count == 1]
    if alone:
        return f"; they end{about(alone)}"
    many = [at for at, count in meet.items() if count > 2]
    once = [at for i, at in enumerate(many) if not any(math.dist(at, other) < 2 * GAP for other in many[:i])]
    return f"; more than two meet{about(once)}"


def _beyond(outline: Loop, layer: Layer, name: str) -> list[str]:
    """Return messages about open lines of the outline's layer that extend outside the outline."""
    places = [line[0][:2] for line in layer.lines if not outline.covers(flattened(line, _TURN))]
    lines = f"{len(places)} open line{'s' * (len(places) > 1)} of layer {name}{about(places)}"
    advice = "If the slab reaches there, join these lines to its outline"
    return [f"outline: {lines}: beyond it. {advice}"] if places else []


def _maybe_frame(outline: Loop, layer: str, among: Mapping[str, Layer]) -> str:
    """Return a hint with the largest closed line of another layer, in case the outline is the frame of the drawing."""
    rest = [(loop, name) for name, one in among.items() if name != layer for loop in one.loops]
    other, name = max(rest, key=lambda pair: _size(pair[0]), default=(None, ""))
    if other is None or _size(other) < _FRAME * _size(outline):
        return ""
    return (
        f", the largest closed line of the drawing. If it is a frame, name the slab's layer with --outline: layer "
        f"{name} has one of {other.area:.6g} m²"
    )


def _size(loop: Loop) -> float:
    """Area [m²] of a closed line, or of its bounding box if the line crosses itself, since parts of its area cancel."""
    left, bottom, right, top = loop.box
    return loop.area if loop.is_simple else (right - left) * (top - bottom)


_TWICE, _OFF, _CROSS = (
    "drawn twice; taken once",
    "not on the plate; left out",
    "shapes that cross at one place; none is imported",
)
_OVER = "their shape reaches beyond the plate; imported as points without footprint"
_LOOSE = "neither circles nor rectangles; imported as points without footprint"
_TUBE, _CUT, _MOVED = (
    "tubes, their outer shapes",
    "cut by the edge of the plate",
    "moved flush with the edge, by mesh.snap at most",
)


def _points(layers: Sequence[Layer], slab: Slab, within: float, said: _Said) -> dict[Footprint, list[Spot]]:
    """Return the positions of point supports on the plate, grouped by the size of their footprints.

    Several shapes with a common center, such as a filled area with its outline or the two circles of a tube, are one
    support with the footprint of the largest shape.
    """
    places: dict[str, list[Spot]] = defaultdict(list)
    groups: list[list[Loop]] = []
    for loop in [*_all_of(one.loops for one in layers), *map(_as_circle, _all_of(one.fills for one in layers))]:
        same = [group for group in groups if math.dist(group[0].middle, loop.middle) < GAP]
        same[0].append(loop) if same else groups.append([loop])
    shapes: list[tuple[Loop | None, Spot]] = []
    for group in groups:
        largest = max(group, key=lambda loop: loop.area)
        if not all(largest.covers(loop.points) for loop in group):
            places[_CROSS] += [largest.middle] * len(group)
            continue
        places[_TUBE] += [largest.middle] * any(map(largest.holds, group))
        shapes.append((largest, largest.middle))
    for point in _all_of(one.points for one in layers):
        if any(math.dist(at, point) < GAP for _, at in shapes):
            places[_TWICE].append(point)
        else:
            shapes.append((None, point))
    result: dict[Footprint, list[Spot]] = defaultdict(list)
    for shape, at in shapes:
        drawn, why = None if shape is None else shape.footprint, ""
        fits: tuple[Spot, Footprint] = at, ()
        if drawn is not None and (moved := slab.moved(at, drawn, within)) is not None:
            fits, why = (moved, drawn), _MOVED if moved != at else ""
        elif drawn is not None and (cut := slab.cut(at, drawn)) is not None:
            fits, why = cut, _CUT
        elif not slab.covers([at], within):
            places[_OFF].append(at)
            continue
        elif shape is not None:
            why = _LOOSE if drawn is None else _OVER
        places[why] += [at] * bool(why)
        result[fits[1]].append(fits[0])
    for why in (_TUBE, _CUT, _MOVED):
        said.changed += _line("points", places[why], why)
    said.left += _line("points", places[_TWICE], _TWICE)
    for why in (_OFF, _OVER, _LOOSE, _CROSS):
        said.lose("points", places[why], why, "footprints" * (why in (_OVER, _LOOSE)))
    return dict(result)


def _as_circle(loop: Loop) -> Loop:
    """Return a circle for a closed line of at least 12 corners on a circle; otherwise return the line itself."""
    x, y = loop.middle
    radii = [math.dist(corner[:2], (x, y)) for corner in loop.corners]
    if len(radii) < _ROUND or max(radii) - min(radii) > GAP + 0.01 * max(radii):
        return loop
    return Loop((Corner(x, y),), max(radii))


def _lines(layers: Sequence[Layer], slab: Slab, within: float, said: _Said) -> list[tuple[Corner, ...]]:
    """Return open lines and center lines of walls drawn with two faces; add messages about lines off the plate."""
    closed = _all_of(one.loops for one in layers)
    whole = [(loop, loop.middle_line) for loop in closed]
    along = [tuple(Corner(*at) for at in middle) for _, middle in whole if middle is not None]
    rings, rest = middles_of_loops([loop for loop, middle in whole if middle is None])
    if along or rings:
        said.changed.append(
            f"lines: walls drawn as closed lines, {len(along) + len(rings)}"
            f"{about([line[0][:2] for line in (*along, *rings)])}: imported as the center lines"
        )
    if rest:
        why = "not a wall of constant thickness. Draw its center line, or a rectangle of each straight part"
        said.left.append(f"lines: {len(rest)} closed{about([loop.middle for loop in rest])}: {why}")
        said.lost.append(Lost("lines", len(rest), said.left[-1]))
    drawn, pairs = middles_of_lines(_all_of(one.lines for one in layers))
    if pairs:
        apart = f"{pairs[0][0]:.3g} m apart" if len(pairs) == 1 else f"{pairs[0][0]:.3g} to {pairs[-1][0]:.3g} m apart"
        said.changed.append(
            f"lines: {len(pairs)} pair{'s' * (len(pairs) > 1)} side by side, {apart}{about([at for _, at in pairs])}: "
            "faces of walls, imported as the center lines"
        )
    drawn += [*along, *rings]
    if beside := beside_others(drawn):
        said.changed.append(
            f"lines: {len(beside)}{about(beside)}: beside another, less than {THICKNESSES[1]:g} m apart; both are "
            "supports. If they are the faces of one wall, keep only one"
        )
    lines: list[tuple[Corner, ...]] = []
    off: list[tuple[float, float]] = []
    for line in drawn:
        chords = flattened(line, _TURN)
        between = [at for a, b in pairwise(chords) for at in _spaced(a, b)]
        if slab.covers([*chords, *between], within):
            lines.append(line)
        else:
            off.append(chords[0])
    said.lose("lines", off, "not on the plate; left out")
    return lines


def _spaced(a: tuple[float, float], b: tuple[float, float]) -> list[tuple[float, float]]:
    """Return points that divide the segment from a to b into parts of at most `_STEP`, without its end points."""
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
