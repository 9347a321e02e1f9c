"""Rigid lines and points that all but touch an edge or each other, which they then do."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Self, TypeAlias

import numpy as np

from signorini.discretise.rows import Floats
from signorini.mesh import Mesh
from signorini.mesh.sides import Sides
from signorini.model import Model, OutlinedPlate
from signorini.model.curve import curve
from signorini.model.footprint import KEYS as FOOTPRINT
from signorini.shapes import Ring
from signorini.shapes.contours import Contour
from signorini.shapes.nearest import Targets, sides_of
from signorini.shapes.outlines import Point

TOUCHING = 2e-4
"""Part of the plate's size within which things touch: coordinates are written to four digits, drawings are made to a
millimetre in ten metres. Held rigidly at such distances a plate is pried apart by 1e5 times its load."""
_ON = 1e-10
"""Part of it within which they do already."""

Line: TypeAlias = tuple[Point, ...]


@dataclass(frozen=True, eq=False)
class _Outline:
    """What of a plate's outline there is to touch: its corners, its sides, those of some edges, and its circles."""

    extent: float
    corners: Targets
    sides: Targets | Sides
    held: Targets | Sides
    circles: Sequence[tuple[Point, float]]

    @classmethod
    def drawn(cls, contours: Sequence[Contour], held: set[str]) -> Self:
        """Take contours."""
        x0, y0, x1, y1 = contours[0].bounds
        corners = Targets.of(points=[corner for contour in contours for corner in contour.corners])
        straight, arcs = sides_of(contours)
        circles = [((x, y), radius) for x, y, radius, *_ in arcs]
        sides, of_held = Targets.of((), straight, arcs), Targets.of((), *sides_of(contours, held))
        return cls(max(x1 - x0, y1 - y0), corners, sides, of_held, circles)

    @classmethod
    def meshed(cls, mesh: Mesh, held: set[str], rings: Iterable[Ring]) -> Self:
        """Take the boundary of a mesh, of whose nodes any may be a corner, and those of its circles that are sought."""
        near = TOUCHING * mesh.size
        named = [np.zeros((0, 3), np.int64), *(mesh.edges[name] for name in held & mesh.edges.keys())]
        sides, of_held = (Sides(mesh.points[of], near) for of in (mesh.boundary, np.concatenate(named)))
        corners = Targets.of(points=mesh.points[mesh.boundary[:, 0]])
        found = (_circle_through(sides.nodes, ring, near) for ring in rings)
        return cls(mesh.size, corners, sides, of_held, [circle for circle in found if circle is not None])


def touching(model: Model, mesh: Mesh | None = None) -> Model:
    """Move corners and ends of rigid lines, and rigid points, onto what they all but touch.

    Lines go to corners and sides of the outline, and to each other; points to edges and lines that hold rigidly; a
    circle becomes the one of the outline, or of another support, that it all but is. Of a plate from a file the outline
    is that of its mesh.

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
    if all(one.place in ("edge", "area") for one in rigid.values()):
        return model
    names = {name for one in rigid.values() for name in one.edge or ()}
    rings = {i: ring for i, one in rigid.items() if isinstance(ring := curve(one), Ring)}
    if isinstance(model.plate, OutlinedPlate):
        outline = _Outline.drawn(model.plate.contours, names)
    else:
        assert mesh is not None
        outline = _Outline.meshed(mesh, names, rings.values())
    extent = outline.extent
    lines = {i: one.line for i, one in rigid.items() if one.line is not None}
    points = {i: one.at for i, one in rigid.items() if one.at is not None and not one.given(FOOTPRINT)}
    circles = _circles(rings, outline)
    drawn = [(*center, radius, 0.0, math.tau) for center, radius in circles.values()]
    for index in lines:
        before = Targets.of(points=[point for other in lines if other < index for point in lines[other]])
        lines[index] = _moved(lines[index], (outline.corners, outline.sides, before), extent)
    for index in lines:
        others = [piece for other in lines if other != index for piece in pairwise(lines[other])]
        onto = outline.corners, outline.sides, Targets.of((), others, drawn)
        lines[index] = _moved(lines[index], onto, extent)
    pieces = [piece for line in lines.values() for piece in pairwise(line)]
    moved: dict[int, dict[str, object]] = {
        index: {"line": line} for index, line in lines.items() if line != rigid[index].line
    }
    for index, (center, radius) in circles.items():
        if (was := rigid[index].circle) is not None and (was.center, was.radius) != (center, radius):
            moved[index] = {"circle": was.model_copy(update={"center": center, "radius": radius})}
    for index, at in points.items():
        if (places := _onto(at, (outline.held, Targets.of((), pieces, drawn)), extent)) != at:
            moved[index] = {"at": places}
    if not moved:
        return model
    support = (one.model_copy(update=moved.get(index, {})) for index, one in enumerate(model.support))
    return model.model_copy(update={"support": tuple(support)})


def _circles(rings: Mapping[int, Ring], outline: _Outline) -> dict[int, tuple[Point, float]]:
    """Circles of supports: each is that of the outline, or of a support before it, that it all but is."""
    known = list(outline.circles)
    found = {}
    for index, ring in rings.items():
        apart = (
            (math.dist(center, ring.center) + abs(radius - ring.radius), center, radius) for center, radius in known
        )
        least = min(apart, default=(math.inf, ring.center, ring.radius))
        near = _ON * outline.extent < least[0] <= TOUCHING * outline.extent
        found[index] = (least[1], least[2]) if near else (ring.center, ring.radius)
        known.append(found[index])
    return found


def _circle_through(sides: Floats, ring: Ring, near: float) -> tuple[Point, float] | None:
    """The circle (Kåsa 1976) through the nodes of sides (k, 3, 2) that are all but on another one, if there are any."""
    off = sides - ring.center
    on = (np.abs(np.hypot(*np.moveaxis(off, 2, 0)) - ring.radius) <= near).all(axis=1)
    if not on.any():
        return None
    x, y = off[on].reshape(-1, 2).T
    rows = np.column_stack([2.0 * x, 2.0 * y, np.ones(len(x))])
    (across, up, rest), *_ = np.linalg.lstsq(rows, x**2 + y**2, rcond=None)
    center = ring.center[0] + float(across), ring.center[1] + float(up)
    return center, math.sqrt(max(rest + across**2 + up**2, 0.0))


def _moved(line: Line, targets: Sequence[Targets | Sides], extent: float) -> Line:
    """Move the points of a line; as it is where two of them would coincide."""
    moved = _onto(line, targets, extent)
    return line if any(a == b for a, b in pairwise(moved)) else moved


def _onto(at: Line, targets: Sequence[Targets | Sides], extent: float) -> Line:
    """The nearest places of the first of the targets that has one near."""
    places = np.array(at, dtype=float)
    open_ = np.ones(len(places), np.bool_)
    for those in targets:
        found, apart = those.nearest(places)
        near = open_ & (apart <= TOUCHING * extent)
        places = np.where((near & (apart > _ON * extent))[:, None], found, places)
        open_ &= ~near
    return tuple((float(x), float(y)) for x, y in places)
