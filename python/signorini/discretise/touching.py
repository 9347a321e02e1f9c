"""Rigid lines and points that all but touch an edge or each other, which they then do."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from signorini.model import Model, OutlinedPlate, Support
from signorini.model.curve import curve
from signorini.model.footprint import KEYS as FOOTPRINT
from signorini.shapes import Ring
from signorini.shapes.contours import Contour
from signorini.shapes.nearest import Targets, sides_of
from signorini.shapes.outlines import Point

_TOUCHING = 2e-4
"""Part of the plate's size within which things touch: coordinates are written to four digits, drawings are made to a
millimetre in ten metres. Held rigidly at such distances a plate is pried apart by 1e5 times its load."""
_ON = 1e-10
"""Part of it within which they do already."""

Line: TypeAlias = tuple[Point, ...]


def touching(model: Model) -> Model:
    """Move corners and ends of rigid lines, and rigid points, onto what they all but touch.

    Lines go to corners and sides of the outline, and to each other; points to edges and lines that hold rigidly; a
    circle becomes the one of the outline, or of another support, that it all but is.

    Examples
    --------
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [6, 4], "thickness": 0.2},
    ...     support=[
    ...         {"edge": "top", "fix": "simple"},
    ...         {"line": [[2, 0.0004], [3, 3.9997]], "fix": "simple"},
    ...         {"at": [5, 3.9995], "resists": "down"},
    ...     ],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> _, wall, pad = touching(model).support
    >>> wall.line, pad.at
    (((2.0, 0.0), (3.0, 4.0)), ((5.0, 4.0),))
    """
    rigid = {i: one for i, one in enumerate(model.support) if one.is_rigid}
    if not isinstance(model.plate, OutlinedPlate) or all(one.place in ("edge", "area") for one in rigid.values()):
        return model
    contours = model.plate.contours
    lines = {i: one.line for i, one in rigid.items() if one.line is not None}
    points = {i: one.at for i, one in rigid.items() if one.at is not None and not one.given(FOOTPRINT)}
    x0, y0, x1, y1 = contours[0].bounds
    extent = max(x1 - x0, y1 - y0)
    corners = Targets.of(points=[corner for contour in contours for corner in contour.corners])
    outline = Targets.of((), *sides_of(contours))
    circles = _circles(rigid, contours, _TOUCHING * extent)
    rings = [(*center, radius, 0.0, math.tau) for center, radius in circles.values()]
    for index in lines:
        before = Targets.of(points=[point for other in lines if other < index for point in lines[other]])
        lines[index] = _moved(lines[index], (corners, outline, before), extent)
    for index in lines:
        others = [piece for other in lines if other != index for piece in pairwise(lines[other])]
        lines[index] = _moved(lines[index], (corners, outline, Targets.of((), others, rings)), extent)
    sides, arcs = sides_of(contours, {name for one in rigid.values() for name in one.edge or ()})
    pieces = [piece for line in lines.values() for piece in pairwise(line)]
    holding = Targets.of((), [*sides, *pieces], [*arcs, *rings])
    moved: dict[int, dict[str, object]] = {
        index: {"line": line} for index, line in lines.items() if line != rigid[index].line
    }
    for index, (center, radius) in circles.items():
        if (was := rigid[index].circle) is not None and (was.center, was.radius) != (center, radius):
            moved[index] = {"circle": was.model_copy(update={"center": center, "radius": radius})}
    for index, at in points.items():
        if (onto := _onto(at, (holding,), extent)) != at:
            moved[index] = {"at": onto}
    if not moved:
        return model
    support = (one.model_copy(update=moved.get(index, {})) for index, one in enumerate(model.support))
    return model.model_copy(update={"support": tuple(support)})


def _circles(rigid: Mapping[int, Support], contours: Sequence[Contour], near: float) -> dict[int, tuple[Point, float]]:
    """Circles of supports: each is that of the outline, or of a support before it, that it all but is."""
    _, arcs = sides_of(contours)
    known: list[tuple[Point, float]] = [((x, y), radius) for x, y, radius, *_ in arcs]
    found = {}
    for index, one in rigid.items():
        if isinstance(ring := curve(one), Ring):
            own = ring.center, ring.radius
            apart = ((math.dist(center, own[0]) + abs(radius - own[1]), center, radius) for center, radius in known)
            least = min(apart, default=(math.inf, *own))
            found[index] = (least[1], least[2]) if least[0] <= near else own
            known.append(found[index])
    return found


def _moved(line: Line, targets: Sequence[Targets], extent: float) -> Line:
    """Move the points of a line; as it is where two of them would coincide."""
    moved = _onto(line, targets, extent)
    return line if any(a == b for a, b in pairwise(moved)) else moved


def _onto(at: Line, targets: Sequence[Targets], extent: float) -> Line:
    """The nearest places of the first of the targets that has one near."""
    places = np.array(at, dtype=float)
    open_ = np.ones(len(places), np.bool_)
    for those in targets:
        found, apart = those.nearest(places)
        near = open_ & (apart <= _TOUCHING * extent)
        places = np.where((near & (apart > _ON * extent))[:, None], found, places)
        open_ &= ~near
    return tuple((float(x), float(y)) for x, y in places)
