"""Ask of what a drawing says whether a model accepts it, by the model's own checks."""

from __future__ import annotations

import tomllib
from collections import defaultdict
from dataclasses import replace

from signorini.discretise import discretise
from signorini.errors import InputError, Place
from signorini.formats.drawing import Drawing, place
from signorini.formats.drawing_toml import drawing_as_toml
from signorini.model import validate


def checked(drawing: Drawing) -> Drawing:
    """Leave out what the input file of a drawing would be refused for, and say it.

    What is wrong with the outline as it is meshed is said alone: another size of elements may mend it.

    Raises
    ------
    InputError
        If the outline crosses or touches itself.

    Examples
    --------
    >>> from signorini.formats.drawing import Corner, Loop
    >>> outline = Loop((Corner(0, 0), Corner(6, 0), Corner(6, 4), Corner(0, 4)))
    >>> holes = Loop((Corner(2, 2),), 1), Loop((Corner(2, 2),), 0.5)
    >>> result = checked(Drawing(outline, holes, (), {}, (), (), ()))
    >>> result.holes == holes[:1], result.left
    (True, ('holes: at [2, 2]: hole 2 at [2.5, 2] is inside hole 1. Leave the inner one out.',))
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
    left: list[str] = []
    off: dict[str, set[int]] = defaultdict(set)
    points = {footprint: at.copy() for footprint, at in drawing.points.items()}
    for path, message in faults.items():
        match path:
            case ("plate", "holes", int(i), *_):
                off["holes"].add(i)
                left.append(f"holes: at {place(drawing.holes[i].middle)}: {message}")
            case ("zone", int(i), *_):
                off["zones"].add(i)
                left.append(f"zones: at {place(drawing.zones[i].middle)}: {message}")
            case ("support", int(i), *rest) if i < len(points):
                footprint, at = list(drawing.points.items())[i]
                those = [at[rest[1]]] if len(rest) > 1 and isinstance(rest[1], int) else at
                points[footprint] = [one for one in points[footprint] if one not in those]
                left.append(f"points: at {', '.join(map(place, those))}: {message}")
            case ("support", int(i), *_):
                off["lines"].add(i - len(points))
                left.append(f"lines: at {place(drawing.lines[i - len(points)][0][:2])}: {message}")
    if not left:
        return None
    return replace(
        drawing,
        holes=tuple(hole for i, hole in enumerate(drawing.holes) if i not in off["holes"]),
        zones=tuple(zone for i, zone in enumerate(drawing.zones) if i not in off["zones"]),
        points={footprint: at for footprint, at in points.items() if at},
        lines=tuple(line for i, line in enumerate(drawing.lines) if i not in off["lines"]),
        left=(*drawing.left, *left),
    )
