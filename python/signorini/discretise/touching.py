"""Rigid lines and points that all but touch an edge or each other, or run along it, which they then do."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Self, TypeAlias

import numpy as np

from signorini.discretise.courses import Followed
from signorini.discretise.rows import Floats
from signorini.mesh import Mesh
from signorini.mesh.sides import Sides
from signorini.model import Model, OutlinedPlate
from signorini.model.footprint import KEYS as FOOTPRINT
from signorini.shapes import Curve, Polyline, Ring
from signorini.shapes.contours import Contour
from signorini.shapes.hull import diameter
from signorini.shapes.nearest import Targets, sides_of
from signorini.shapes.outlines import Point, Side

TOUCHING = 2e-4
"""Part of the plate's diameter within which things touch: coordinates are written to four digits, drawings are made to
a millimetre in ten metres, of plates that are long and narrow too. Held rigidly at such distances a plate is pried
apart by 1e5 times its load."""
_ON = 1e-10
"""Part of it within which they do already."""

Line: TypeAlias = tuple[Point, ...]


@dataclass(frozen=True, eq=False)
class _Outline:
    """What of a plate's outline there is to touch: its corners, its sides, those of some edges, and its circles.

    ``along`` are the sides once more, one after the other.
    """

    extent: float
    along: Sequence[Side]
    corners: Targets
    sides: Targets | Sides
    held: Targets | Sides
    circles: Sequence[Ring]

    @classmethod
    def drawn(cls, contours: Sequence[Contour], held: set[str]) -> Self:
        """Take contours."""
        extent = diameter(contours[0].points())
        along = [side for contour in contours for side in contour.sides]
        corners = Targets.of(points=[corner for contour in contours for corner in contour.corners])
        straight, arcs = sides_of(contours)
        circles = [Ring((x, y), radius) for x, y, radius, *_ in arcs]
        sides, of_held = Targets.of((), straight, arcs), Targets.of((), *sides_of(contours, held))
        return cls(extent, along, corners, sides, of_held, circles)

    @classmethod
    def meshed(cls, mesh: Mesh, held: set[str], rings: Iterable[Ring]) -> Self:
        """Take the boundary of a mesh, of whose nodes any may be a corner, and those of its circles that are sought."""
        near = TOUCHING * mesh.diameter
        named = [np.zeros((0, 3), np.int64), *(mesh.edges[name] for name in held & mesh.edges.keys())]
        sides, of_held = (Sides(mesh.points[of], near) for of in (mesh.boundary, np.concatenate(named)))
        corners = Targets.of(points=mesh.points[mesh.boundary[:, 0]])
        along = [(tuple(a), tuple(m), tuple(b)) for a, m, b in mesh.points[mesh.boundary].tolist()]
        found = (_circle_through(sides.nodes, ring, near) for ring in rings)
        return cls(mesh.diameter, along, corners, sides, of_held, [circle for circle in found if circle is not None])


def touching(model: Model, mesh: Mesh | None = None) -> Model:
    """Move corners and ends of rigid lines, and rigid points, onto what they all but touch.

    Lines go to corners and sides of the outline, and to each other; points to edges and lines that hold rigidly; a
    circle becomes the one of the outline, or of another support, that it all but is. Lines and circles that run along
    the outline, or along circles and lines before them, have a course on these (`Support.course`). Of a plate from a
    file the outline is that of its mesh.

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
    drawn = {i: Ring(one.circle.center, one.circle.radius) for i, one in rigid.items() if one.circle is not None}
    if isinstance(model.plate, OutlinedPlate):
        outline = _Outline.drawn(model.plate.contours, names)
    else:
        assert mesh is not None
        outline = _Outline.meshed(mesh, names, drawn.values())
    near, on = TOUCHING * outline.extent, _ON * outline.extent
    rings = _rings(drawn, outline.circles, near, on)
    followed = Followed(outline.along)
    curves: dict[int, Curve] = {i: followed.course(ring.sides, near, on) or ring for i, ring in rings.items()}
    lines = {i: Polyline(one.line) for i, one in rigid.items() if one.line is not None}
    curves |= _lines(lines, outline, list(curves.values()), near, on)
    every = Targets.along(curves.values())
    support = list(model.support)
    for index, one in rigid.items():
        along, ring = curves.get(index), rings.get(index)
        if one.at is not None and not one.given(FOOTPRINT):
            support[index] = one.model_copy(update={"at": _onto(one.at, (outline.held, every), near, on)})
        elif ring is not None and one.circle is not None and ring != drawn[index]:
            moved = one.circle.model_copy(update={"center": ring.center, "radius": ring.radius})
            support[index] = one.model_copy(update={"circle": moved})
        if isinstance(along, Polyline) and ring is None and not any(along.through):
            support[index] = one.model_copy(update={"line": along.points})
        elif along is not None and along != ring:
            support[index] = support[index].following(along)
    return model.model_copy(update={"support": tuple(support)})


def _rings(rings: Mapping[int, Ring], circles: Sequence[Ring], near: float, on: float) -> dict[int, Ring]:
    """Circles of supports: each is that of the outline, or of a support before it, that it all but is."""
    known, found = list(circles), dict[int, Ring]()
    for index, ring in rings.items():
        apart = [_apart(one, ring) for one in known]
        least = int(np.argmin(apart)) if apart else 0
        found[index] = known[least] if apart and on < apart[least] <= near else ring
        known.append(found[index])
    return found


def _lines(
    lines: Mapping[int, Polyline], outline: _Outline, rings: Sequence[Curve], near: float, on: float
) -> dict[int, Curve]:
    """Lines of supports on what they run along, and their corners and ends on what they all but touch."""
    followed, found = Followed(outline.along).and_along(rings), dict(lines)
    circles = [*(one for one in rings if isinstance(one, Ring)), *outline.circles]
    for index in lines:
        before = Targets.of(points=[point for other in lines if other < index for point in found[other].points])
        found[index] = _moved(found[index], (outline.corners, outline.sides, before), near, on)
    # Ends on lines after them are moved once it is known which of these run along their own.
    placed: dict[int, Curve] = {}
    for _ in range(min(2, len(lines))):
        beyond = followed
        for index, line in lines.items():
            before = Targets.along([*rings, *(placed[other] for other in lines if other < index)])
            after = Targets.along([placed[other] for other in lines if other > index and other in placed])
            course = beyond.course(line.sides, near, on) or found[index]
            if isinstance(course, Ring):
                placed[index] = next((one for one in circles if _apart(one, course) <= on), course)
            else:
                placed[index] = _moved(course, (outline.corners, outline.sides, before, after), near, on)
            beyond = beyond.and_along([placed[index]])
    return placed


def _apart(one: Ring, other: Ring) -> float:
    """How far a circle is from another one at most."""
    return math.dist(one.center, other.center) + abs(one.radius - other.radius)


def _circle_through(sides: Floats, ring: Ring, near: float) -> Ring | None:
    """The circle (Kåsa 1976) through the nodes of sides (k, 3, 2) that are all but on another one, if there are any."""
    off = sides - ring.center
    on = (np.abs(np.hypot(*np.moveaxis(off, 2, 0)) - ring.radius) <= near).all(axis=1)
    if not on.any():
        return None
    x, y = off[on].reshape(-1, 2).T
    rows = np.column_stack([2.0 * x, 2.0 * y, np.ones(len(x))])
    (across, up, rest), *_ = np.linalg.lstsq(rows, x**2 + y**2, rcond=None)
    center = ring.center[0] + float(across), ring.center[1] + float(up)
    squared = float(rest + across**2 + up**2)
    return Ring(center, math.sqrt(squared)) if squared > 0.0 else None


def _moved(line: Polyline, targets: Sequence[Targets | Sides], near: float, on: float) -> Polyline:
    """Move the points of a line, those that coincide once; as it is if it comes to nothing."""
    moved = _onto(line.points, targets, near, on)
    sides = [(a, m, b) for a, m, b in zip(moved, line.through, moved[1:], strict=False) if a != b]
    return Polyline((sides[0][0], *(b for *_, b in sides)), tuple(m for _, m, _ in sides)) if sides else line


def _onto(at: Line, targets: Sequence[Targets | Sides], near: float, on: float) -> Line:
    """The nearest places of the first of the targets that has one near; what is on it stays as it is."""
    places = np.array(at, dtype=float)
    open_ = np.ones(len(places), np.bool_)
    for those in targets:
        found, apart = those.nearest(places)
        takes = open_ & (apart <= near)
        places = np.where((takes & (apart > on))[:, None], found, places)
        open_ &= ~takes
    return tuple((float(x), float(y)) for x, y in places)
