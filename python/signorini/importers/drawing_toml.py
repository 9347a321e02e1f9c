"""Conversion of a drawing to a valid input file, which the engineer then completes."""

from __future__ import annotations

import json
import math
import tomllib
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

from signorini.discretise import discretise
from signorini.errors import InputError, Place
from signorini.importers.drawing import Corner, Drawing, Loop, Lost, flattened, place, through
from signorini.model import validate

_DIGITS = 6
"""Number of decimals of a length [m]: micrometres, below any building tolerance."""
_TURN = math.pi / 8
"""Largest angle [rad] of the parts of an arc that are replaced by chords, since support lines cannot have arcs."""
_SNAP, _RELATIVE_SNAP = 0.005, 5e-4
"""Value of ``mesh.snap``, the inaccuracy of drawings: the smaller of 5 mm and 5e-4 of the slab's size."""
_ELEMENTS = 30
"""Number of elements along the longer side of the slab, from which the mesh size in the input file follows."""


def drawing_as_toml(drawing: Drawing, title: str) -> str:
    """Write a drawing as an input file in metres and newtons; values not in the drawing are marked as assumed."""
    left, bottom, right, top = drawing.outline.box
    blocks = [
        f"title = {json.dumps(title, ensure_ascii=False)}",
        '[units]\nlength = "m"\nforce = "N"',
        "# Assumed: concrete C30/37.\n[material]\nE = 33e9\nnu = 0.2\nunit_weight = 25e3",
        _plate(drawing),
        *(f"# Assumed: the thickness.\n[[zone]]\narea = {_area(zone)}\nthickness = 0.4" for zone in drawing.zones),
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
                '# Rigid in both directions. Add resists = "down" if it only pushes up, '
                f"stiffness = … [{unit}] if it is elastic.\n"
                f'[[support]]\nname = "{name if len(places) == 1 else f"{name} {number}"}"\n{where}'
            )
    if not points and not lines:
        blocks.append("# Add supports: [[support]] with at, edge, line, circle or area.")
    blocks.append('# Add further loads with their cases.\n[[load]]\ncase = "self-weight"\nself_weight = true')
    return "\n\n".join(blocks) + "\n"


def snap(outline: Loop) -> float:
    """Return ``mesh.snap`` of the input file [m]: points up to this distance from an edge count as on the edge."""
    left, bottom, right, top = outline.box
    return min(_SNAP, _RELATIVE_SNAP * max(right - left, top - bottom))


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
    """Return a closed line as TOML items of the key ``polygon``; if possible the last side is straight."""
    sides = list(loop)
    # If a closed line consists of a chord and an arc, the arc comes last, since a polygon begins with a corner.
    straight = [i for i, (a, _) in enumerate(sides[-1:] + sides[:-1]) if (a.bulge == 0) == (len(sides) > 2)]
    first = straight[0] if straight else 0
    sides = sides[first:] + sides[:first]
    corners = [_list(sides[0][0][:2])]
    corners += [_to(a, b) for a, b in sides[:-1]]
    return corners + ([_to(*sides[-1])] if sides[-1][0].bulge else [])


def _to(a: Corner, b: Corner) -> str:
    return f"{{ through = {_list(through(a, b))}, to = {_list(b[:2])} }}" if a.bulge else _list(b[:2])


def _footprint(footprint: tuple[float, ...]) -> str:
    if len(footprint) < 2:
        return f"\nradius = {_number(footprint[0])}" if footprint else ""
    angle = f"\nangle = {_number(footprint[2])}" if len(footprint) > 2 else ""
    return f"\npatch = {_list(footprint[:2])}{angle}"


def _size(extent: float) -> str:
    """Return the element size for a slab of size ``extent`` [m], rounded down to 1, 2 or 5 times a power of ten."""
    size = extent / _ELEMENTS
    unit = 10.0 ** math.floor(math.log10(size))
    return _number(max(step * unit for step in (1, 2, 5) if step * unit <= size * 1.001))


def _list(values: Sequence[float]) -> str:
    return f"[{', '.join(_number(value) for value in values)}]"


def _number(value: float) -> str:
    rounded = round(value, _DIGITS) + 0.0
    return f"{rounded:.0f}" if rounded == int(rounded) else repr(rounded)


def checked(drawing: Drawing) -> Drawing:
    """Remove shapes of a drawing for which the input file would be refused, and add messages about these shapes.

    If the outline cannot be meshed, only a message is added, since another element size may help. An outline that
    crosses or touches itself raises `InputError`.
    """
    while True:
        try:
            discretise(validate(tomllib.loads(drawing_as_toml(drawing, ""))))
        except InputError as error:
            reduced = _without(drawing, {part.path: part.message for part in error.parts})
            if reduced is None:
                if not drawing.outline.is_simple:
                    raise InputError(f"the outline is invalid: {error.message}", place="outline") from None
                return replace(drawing, left=(*drawing.left, f"outline: {error.message}"))
            drawing = reduced
        else:
            return drawing


def _without(drawing: Drawing, problems: dict[Place, str]) -> Drawing | None:
    """Return the drawing without the shapes that ``problems`` name; None if no problem is about a shape."""
    lost: list[Lost] = []
    removed: dict[str, set[int]] = defaultdict(set)
    points = {footprint: at.copy() for footprint, at in drawing.points.items()}
    for path, message in problems.items():
        match path:
            case ("plate", "holes", int(i), *_):
                removed["holes"].add(i)
                lost.append(Lost("holes", 1, f"holes: at {place(drawing.holes[i].middle)}: {message}"))
            case ("zone", int(i), *_):
                removed["zones"].add(i)
                lost.append(Lost("zones", 1, f"zones: at {place(drawing.zones[i].middle)}: {message}"))
            case ("support", int(i), *rest) if i < len(points):
                footprint, at = list(drawing.points.items())[i]
                invalid = [at[rest[1]]] if len(rest) > 1 and isinstance(rest[1], int) else at
                points[footprint] = [point for point in points[footprint] if point not in invalid]
                lost.append(Lost("points", len(invalid), f"points: at {', '.join(map(place, invalid))}: {message}"))
            case ("support", int(i), *_):
                removed["lines"].add(i - len(points))
                begin = drawing.lines[i - len(points)][0][:2]
                lost.append(Lost("lines", 1, f"lines: at {place(begin)}: {message}"))
    if not lost:
        return None
    return replace(
        drawing,
        holes=tuple(hole for i, hole in enumerate(drawing.holes) if i not in removed["holes"]),
        zones=tuple(zone for i, zone in enumerate(drawing.zones) if i not in removed["zones"]),
        points={footprint: at for footprint, at in points.items() if at},
        lines=tuple(line for i, line in enumerate(drawing.lines) if i not in removed["lines"]),
        left=(*drawing.left, *(shape.line for shape in lost)),
        lost=(*drawing.lost, *lost),
    )
