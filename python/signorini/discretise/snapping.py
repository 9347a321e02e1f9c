"""Snapping of supports, zones and loads to edges and to each other (``[mesh] snap``)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, NamedTuple, TypeAlias, TypeVar

import numpy as np

from signorini.discretise.rows import Floats, Ints
from signorini.errors import InputError, Place, format_place
from signorini.mesh import Mesh
from signorini.mesh.sides import Sides
from signorini.model import Area, Load, Model, OutlinedPlate, Support, Zone
from signorini.model.places import Annulus, Arc, Box, Circle, Form
from signorini.shapes.distances import Targets, edges_of
from signorini.shapes.extent import Tolerances, diameter
from signorini.shapes.outlines import Point

_PASSES = 8
"""Largest number of passes over all supports, zones and loads.

A pass also moves geometry onto which others were moved; the remaining distances converge quadratically.
"""

_Item: TypeAlias = Support | Zone | Load
_Numbers = TypeVar("_Numbers", bound=tuple[float, ...])


class Snapped(NamedTuple):
    """A point, corner, circle or rectangle that was moved.

    ``what`` is the path of this item in the input, such as ``support[2].line[1]``. ``begin`` and ``end`` are its
    coordinates before and after the move: [x, y], for a circle [x, y, radius], for a rectangle [x0, y0, x1, y1].
    ``onto`` names the target: an edge of the plate or a path in the input.
    """

    what: str
    begin: tuple[float, ...]
    end: tuple[float, ...]
    onto: str


class _Target(NamedTuple):
    """Geometry onto which items are moved: corners, sides, and circles (m, 3) as x, y, radius."""

    name: str
    corners: Targets
    sides: Targets | Sides
    circles: Floats


def snapped(model: Model, mesh: Mesh | None = None) -> tuple[Model, tuple[Snapped, ...]]:
    """Move supports, zones and loads onto geometry nearer than ``mesh.snap``; return the model and the moves.

    The edges of the plate come first, then supports, zones and loads in the order of the input. A point or corner moves
    onto a corner of an earlier item, else onto a side of any other item. A circle moves onto an earlier circle. A move
    is at most ``mesh.snap`` long, or √2 times that into a corner of the plate. A line or an area that degenerates is
    refused.
    """
    if not model.mesh.snap:
        return model, ()
    keys = ("support", "zone", "load")
    drawn: dict[Place, _Item] = {(key, i): item for key in keys for i, item in enumerate(getattr(model, key))}
    plate, extent = _plate(model, mesh)
    items, moved = drawn, dict[Place, Snapped]()
    targets = [_target(path, item) for path, item in drawn.items()]
    near = _near(targets, model.mesh.snap)
    for _ in range(_PASSES):
        before, items, moved = items, dict(items), {}
        for number, (path, item) in enumerate(drawn.items()):
            earlier, later = ([targets[i] for i in indices] for indices in (near[number][0], near[number][1]))
            onto = _Snapper(model.mesh.snap, Tolerances(extent).place, plate, earlier, later, moved)
            items[path] = onto.item(path, item)
            targets[number] = _target(path, items[path])
        if items == before:
            break
    updates = {key: tuple(item for path, item in items.items() if path[0] == key) for key in keys}
    return model.varied(**updates), tuple(moved.values())


def _plate(model: Model, mesh: Mesh | None) -> tuple[list[_Target], float]:
    """Edges of the plate onto which geometry is moved, one `_Target` per name, and the plate's diameter."""
    if not isinstance(model.plate, OutlinedPlate):
        assert mesh is not None  # A plate without an outline is read from a file with its mesh.
        nodes = mesh.points[mesh.boundary]
        corners, sides = Targets.of(nodes[:, 0].tolist()), Sides(nodes, model.mesh.snap)
        return [_Target("boundary", corners, sides, np.zeros((0, 3)))], mesh.diameter
    result = []
    for contour in model.plate.contours:
        for name in dict.fromkeys(contour.names):
            along = edges_of([contour], {name})[name]
            is_circle = len(set(contour.names)) == 1 and not len(along.sides)
            ends = [] if is_circle else [end for side in contour.edges[name] for end in contour.sides[side][::2]]
            result.append(_Target(name, Targets.of(ends), along, along.arcs[:, :3]))
    return result, diameter(model.plate.contours[0].points())


def _target(path: Place, item: _Item) -> _Target:
    """Corners, sides and circles of a support, load or zone; empty if it is on edges of the plate."""
    outline = item.where.outline
    corners = [
        *item.where.points,
        *outline.segments.reshape(-1, 2).tolist(),
        *outline.arcs[:, ::2].reshape(-1, 2).tolist(),
    ]
    return _Target(format_place(path), Targets.of((x, y) for x, y in corners), Targets.along(outline), outline.circles)


def _near(targets: Sequence[_Target], reach: float) -> list[tuple[Ints, Ints]]:
    """For each item, the indices of earlier and of later targets within reach, even after both have moved."""
    drawn = [Targets.join([target.corners, target.sides]) for target in targets if isinstance(target.sides, Targets)]
    boxes = np.array([item.bounds if len(item.points) + len(item.arcs) else (np.inf,) * 4 for item in drawn])
    low, high = boxes[:, :2] - 4.0 * reach, boxes[:, 2:] + 4.0 * reach
    result = []
    for number in range(len(boxes)):
        (near,) = np.nonzero((low[number] <= high).all(axis=1) & (low <= high[number]).all(axis=1))
        result.append((near[near < number], near[near > number]))
    return result


@dataclass(frozen=True, eq=False)
class _Snapper:
    """Moves one item by at most ``reach``: onto the plate, onto earlier items ``before``, or onto sides of later items.

    Later items are ``behind``. Moves up to ``same`` are not recorded in ``moved``.
    """

    reach: float
    same: float
    plate: Sequence[_Target]
    before: Sequence[_Target]
    behind: Sequence[_Target]
    moved: dict[Place, Snapped]

    def item(self, path: Place, item: _Item) -> _Item:
        """Return a support, zone or load with its new position."""
        moves: dict[str, Callable[[Place, Any], object]] = {
            "at": self._points,
            "line": self._line,
            "circle": self._circle,
            "area": self._area,
        }
        values = {key: getattr(item, key, None) for key in moves}
        update = {
            key: moves[key]((*path, key), value)
            for key, value in values.items()
            if value is not None and value != "all"
        }
        return item.model_copy(update=update)

    def _points(self, path: Place, points: Sequence[Point]) -> tuple[Point, ...]:
        return tuple(self._moved((*path, i), point, self._corner(point)) for i, point in enumerate(points))

    def _line(self, path: Place, points: Sequence[Point]) -> tuple[Point, ...]:
        ends = self._points(path, points)
        line = (ends[0], *(b for a, b in pairwise(ends) if a != b))
        if len(line) < 2:
            raise self._degenerates(path)
        return line

    def _area(self, path: Place, area: Area) -> Area:
        moved_before = len(self.moved)
        update = self._form(path, area)
        if area.annulus is not None:
            (x, y), inner, outer = area.annulus.center, area.annulus.inner, area.annulus.outer
            rims = [self._ring((*path, "annulus", key), (x, y, r)) for key, r in (("inner", inner), ("outer", outer))]
            center = next((rim[:2] for rim in rims if rim[:2] != (x, y)), (x, y))
            update["annulus"] = Annulus.model_construct(center=center, inner=rims[0][2], outer=rims[1][2])
        update["holes"] = tuple(
            Form.model_construct(**self._form((*path, "holes", i), hole)) for i, hole in enumerate(area.holes)
        )
        if len(self.moved) == moved_before:
            return area
        area_moved = Area.model_construct(**update)
        try:
            _ = area_moved.region
        except InputError:
            raise self._degenerates(path) from None
        return area_moved

    def _form(self, path: Place, form: Form) -> dict[str, Any]:
        if form.rectangle is not None:
            return {"rectangle": self._rectangle((*path, "rectangle"), form.rectangle)}
        if form.circle is not None:
            return {"circle": self._circle((*path, "circle"), form.circle)}
        corners = list[Point | Arc]()
        for i, corner in enumerate(form.polygon or ()):
            corner_path = (*path, "polygon", i)
            if isinstance(corner, Arc):
                through = self._moved((*corner_path, "through"), corner.through, self._side(corner.through))
                end = self._moved((*corner_path, "to"), corner.to, self._corner(corner.to))
                corners.append(Arc.model_construct(through=through, to=end))
            else:
                corners.append(self._moved(corner_path, corner, self._corner(corner)))
        return {"polygon": tuple(corners)} if corners else {}

    def _rectangle(self, path: Place, box: Box) -> Box:
        """Move the sides of a rectangle, which stays a rectangle.

        Each side follows the first of its corners whose coordinate normal to the side changes.
        """
        x0, y0, x1, y1 = box
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        result = [self._corner(coordinates) for coordinates in corners]
        sides = list(box)
        for side, ends in enumerate(((0, 3), (0, 1), (1, 2), (2, 3))):
            coordinates = (result[end][0][side % 2] for end in ends)
            sides[side] = next((coordinate for coordinate in coordinates if coordinate != box[side]), box[side])
        onto = " and ".join(dict.fromkeys(name for _, name in result if name))
        rectangle = sides[0], sides[1], sides[2], sides[3]
        return self._moved(path, box, (rectangle, onto))

    def _circle(self, path: Place, circle: Circle) -> Circle:
        x, y, radius = self._ring(path, (*circle.center, circle.radius))
        return Circle.model_construct(center=(x, y), radius=radius)

    def _ring(self, path: Place, ring: tuple[float, float, float]) -> tuple[float, float, float]:
        """Move a circle onto the nearest circle of the plate or of earlier items.

        The distance of two circles is the distance of their centres plus the difference of their radii.
        """
        circles = [
            (circle, target.name) for target in (*self.plate, *self.before) for circle in target.circles.tolist()
        ]
        apart = [math.dist(circle[:2], ring[:2]) + abs(circle[2] - ring[2]) for circle, _ in circles]
        least = min(apart, default=math.inf)
        if least > self.reach:
            return ring
        (x, y, radius), name = circles[apart.index(least)]
        snapped_ring: tuple[float, float, float] = x, y, radius
        return self._moved(path, ring, (snapped_ring, name))

    def _moved(self, path: Place, begin: _Numbers, result: tuple[_Numbers, str]) -> _Numbers:
        end, onto = result
        if max(abs(a - b) for a, b in zip(begin, end, strict=True)) > self.same:
            self.moved[path] = Snapped(format_place(path), begin, end, onto)
        return end

    def _corner(self, point: Point) -> tuple[Point, str]:
        """Corner onto which a point moves, or else the nearest position on a side; and the target's name."""
        # A point near two edges of the plate moves into the corner between them.
        several = len(self._near(point, self.plate, "sides")) > 1
        corners = self._near(point, self.plate, "corners", math.sqrt(2.0) if several else 1.0)
        before = self._near(point, self.before, "corners")
        if not (corners or before):
            return self._side(point)
        _, place, name = min(corners, default=None) or before[0]
        return place, name

    def _side(self, point: Point) -> tuple[Point, str]:
        """Nearest position on a side within reach, and the target's name; the point and "" if no side is in reach."""
        free = [target for target in self.behind if not self._near(point, [target], "corners")]
        edges, others = self._near(point, self.plate, "sides"), self._near(point, [*self.before, *free], "sides")
        if not (edges or others):
            return point, ""
        _, place, name = min(edges, default=None) or others[0]
        return place, name

    def _near(
        self, point: Point, targets: Iterable[_Target], attribute: Literal["corners", "sides"], reaches: float = 1.0
    ) -> list[tuple[float, Point, str]]:
        """Distance, nearest position and name of each target with corners or sides within ``reaches`` × reach."""
        result = []
        for target in targets:
            (place,), (apart,) = getattr(target, attribute).nearest(np.array([point]))
            if apart <= self.reach * reaches:
                result.append((float(apart), (float(place[0]), float(place[1])), target.name))
        return result

    def _degenerates(self, path: Place) -> InputError:
        return InputError(
            f"With mesh.snap = {self.reach:g} this line or area degenerates. Take a smaller mesh.snap, or draw the "
            "line or area at its final place.",
            place=path,
        )
