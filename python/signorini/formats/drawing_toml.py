"""Write an input file from a drawing, of what a model accepts, for an engineer to go on with."""

from __future__ import annotations

import json
import math
import tomllib
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

from signorini.discretise import discretise
from signorini.errors import InputError, Place
from signorini.formats.drawing import Corner, Drawing, Loop, Lost, flattened, place, through
from signorini.model import validate

_DIGITS = 6
"""Decimals of a length in metres: to the micrometre, finer than anything is built."""
_TURN = math.pi / 8
"""Turn of the chords that stand for arcs where there are none."""
_SNAP, _SNAP_PART = 0.005, 5e-4
"""What drawings are exact to: 5 mm or, of a small slab, this part of it."""
_ELEMENTS = 30
"""Elements along the longer side of the mesh to begin with."""


def drawing_as_toml(drawing: Drawing, title: str) -> str:
    """Write what a drawing says as an input file in metres and newtons; what it does not say is assumed and marked."""
    left, bottom, right, top = drawing.outline.box
    blocks = [
        f"title = {json.dumps(title, ensure_ascii=False)}",
        '[units]\nlength = "m"\nforce = "N"',
        "# Assumed, the drawing does not say: concrete C30/37.\n[material]\nE = 33e9\nnu = 0.2\nunit_weight = 25e3",
        _plate(drawing),
        *(
            "# Assumed, the drawing does not say how it is made: its thickness.\n"
            f"[[zone]]\narea = {_area(zone)}\nthickness = 0.4"
            for zone in drawing.zones
        ),
        f"[mesh]\nsize = {_size(max(right - left, top - bottom))}\nsnap = {_number(snap(drawing.outline))}",
    ]
    points = [
        "at = [\n" + "".join(f"    {_list(place)},\n" for place in at) + "]" + _footprint(footprint)
        for footprint, at in drawing.points.items()
    ]
    lines = [f"line = [{', '.join(_list(at) for at in flattened(line, _TURN))}]" for line in drawing.lines]
    for name, unit, places in (("points", "N/m", points), ("lines", "N/m²", lines)):
        for number, where in enumerate(places, 1):
            blocks.append(
                '# Rigid, both ways, as it stands. Add resists = "down" where it only pushes up, '
                f"stiffness = … [{unit}] where it yields.\n"
                f'[[support]]\nname = "{name if len(places) == 1 else f"{name} {number}"}"\n{where}'
            )
    if not points and not lines:
        blocks.append("# Add supports: [[support]] with at, edge, line, circle or area.")
    blocks.append('# Add loads to these, with their cases.\n[[load]]\ncase = "self-weight"\nself_weight = true')
    return "\n\n".join(blocks) + "\n"


def snap(outline: Loop) -> float:
    """How far [m] things may be drawn beside an edge that they are on."""
    left, bottom, right, top = outline.box
    return min(_SNAP, _SNAP_PART * max(right - left, top - bottom))


def _plate(drawing: Drawing) -> str:
    outline = drawing.outline
    if outline.radius:
        shape = f'shape = "disc"\nradius = {_number(outline.radius)}\ncenter = {_list(outline.corners[0][:2])}'
        points = ""
    else:
        shape = 'shape = "polygon"'
        points = "\npoints = [\n" + "".join(f"    {corner},\n" for corner in _corners(outline)) + "]"
    holes = "\nholes = [\n" + "".join(f"    {_area(hole)},\n" for hole in drawing.holes) + "]"
    return f"[plate]\n{shape}\nthickness = 0.25  # assumed{points}{holes if drawing.holes else ''}"


def _area(loop: Loop) -> str:
    if loop.radius:
        center = _list(loop.corners[0][:2])
        return f"{{ circle = {{ center = {center}, radius = {_number(loop.radius)} }} }}"
    if loop.sides:
        return f"{{ rectangle = {_list(loop.box)} }}"
    return f"{{ polygon = [{', '.join(_corners(loop))}] }}"


def _corners(loop: Loop) -> list[str]:
    """Corners from one that a straight side leads to, where there is one; an arc names its middle and its end."""
    sides = list(loop)
    # Of an arc and its chord the arc is last: it names the first corner again, and three are needed.
    straight = [i for i, (a, _) in enumerate(sides[-1:] + sides[:-1]) if (a.bulge == 0) == (len(sides) > 2)]
    begin = straight[0] if straight else 0
    sides = sides[begin:] + sides[:begin]
    result = [_list(sides[0][0][:2])]
    result += [_to(a, b) for a, b in sides[:-1]]
    return result + ([_to(*sides[-1])] if sides[-1][0].bulge else [])


def _to(a: Corner, b: Corner) -> str:
    return f"{{ through = {_list(through(a, b))}, to = {_list(b[:2])} }}" if a.bulge else _list(b[:2])


def _footprint(footprint: tuple[float, ...]) -> str:
    if len(footprint) < 2:
        return f"\nradius = {_number(footprint[0])}" if footprint else ""
    turned = f"\nangle = {_number(footprint[2])}" if len(footprint) > 2 else ""
    return f"\npatch = {_list(footprint[:2])}{turned}"


def _size(extent: float) -> str:
    """A round size of elements."""
    size = extent / _ELEMENTS
    unit = 10.0 ** math.floor(math.log10(size))
    return _number(max(step * unit for step in (1, 2, 5) if step * unit <= size * 1.001))


def _list(values: Sequence[float]) -> str:
    return f"[{', '.join(_number(value) for value in values)}]"


def _number(value: float) -> str:
    result = round(value, _DIGITS) + 0.0
    return f"{result:.0f}" if result == int(result) else repr(result)


def checked(drawing: Drawing) -> Drawing:
    """Leave out what the input file of a drawing would be refused for, and say it.

    What is wrong with the outline as it is meshed is said alone: another size of elements may mend it. It raises
    `InputError` if the outline crosses or touches itself.
    """
    while True:
        try:
            discretise(validate(tomllib.loads(drawing_as_toml(drawing, ""))))
        except InputError as error:
            result = _without(drawing, {part.path: part.message for part in error.parts})
            if result is None:
                if not drawing.outline.is_simple:
                    raise InputError(f"the outline cannot be taken: {error.message}", place="outline") from None
                return replace(drawing, left=(*drawing.left, f"outline: {error.message}"))
            drawing = result
        else:
            return drawing


def _without(drawing: Drawing, faults: dict[Place, str]) -> Drawing | None:
    """The drawing without what has faults, None if it is no part of it."""
    lost: list[Lost] = []
    off: dict[str, set[int]] = defaultdict(set)
    points = {footprint: at.copy() for footprint, at in drawing.points.items()}
    for path, message in faults.items():
        match path:
            case ("plate", "holes", int(i), *_):
                off["holes"].add(i)
                lost.append(Lost("holes", 1, f"holes: at {place(drawing.holes[i].middle)}: {message}"))
            case ("zone", int(i), *_):
                off["zones"].add(i)
                lost.append(Lost("zones", 1, f"zones: at {place(drawing.zones[i].middle)}: {message}"))
            case ("support", int(i), *rest) if i < len(points):
                footprint, at = list(drawing.points.items())[i]
                those = [at[rest[1]]] if len(rest) > 1 and isinstance(rest[1], int) else at
                points[footprint] = [one for one in points[footprint] if one not in those]
                lost.append(Lost("points", len(those), f"points: at {', '.join(map(place, those))}: {message}"))
            case ("support", int(i), *_):
                off["lines"].add(i - len(points))
                begin = drawing.lines[i - len(points)][0][:2]
                lost.append(Lost("lines", 1, f"lines: at {place(begin)}: {message}"))
    if not lost:
        return None
    return replace(
        drawing,
        holes=tuple(hole for i, hole in enumerate(drawing.holes) if i not in off["holes"]),
        zones=tuple(zone for i, zone in enumerate(drawing.zones) if i not in off["zones"]),
        points={footprint: at for footprint, at in points.items() if at},
        lines=tuple(line for i, line in enumerate(drawing.lines) if i not in off["lines"]),
        left=(*drawing.left, *(one.line for one in lost)),
        lost=(*drawing.lost, *lost),
    )
