"""Supports, zones and loads moved onto edges and onto each other, as ``[mesh] snap`` asks."""

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
"""What moves onto something that moves itself follows it; a pass leaves about the square of what the last one did."""

_Item: TypeAlias = Support | Zone | Load
_Numbers = TypeVar("_Numbers", bound=tuple[float, ...])


class Snapped(NamedTuple):
    """A point, a corner, a circle or a rectangle that was moved.

    ``what`` says where it stands in the input, such as ``support[2].line[1]``; ``begin`` and ``end`` are [x, y] before
    and after, of a circle [x, y, radius], of a rectangle [x0, y0, x1, y1]. ``onto`` is an edge of the plate, or what
    stands elsewhere in the input.
    """

    what: str
    begin: tuple[float, ...]
    end: tuple[float, ...]
    onto: str


class _Target(NamedTuple):
    """What others move onto: its corners, its sides, and its circles (m, 3) as x, y, radius."""

    name: str
    corners: Targets
    sides: Targets | Sides
    circles: Floats


def snapped(model: Model, mesh: Mesh | None = None) -> tuple[Model, tuple[Snapped, ...]]:
    """Move supports, zones and loads onto what they are nearer to than ``mesh.snap``, and say what moved.

    First come the edges of the plate, of a plate from a file those of its mesh, then supports, zones and loads in the
    order of the input. A point or corner moves onto a corner of what comes before it, else onto a side of anything
    else; a circle becomes one that comes before it. Nothing moves farther than ``mesh.snap``, but into a corner of the
    plate from beside both of its sides. A line or an area that comes to nothing is refused.
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
            earlier, later = ([targets[i] for i in those] for those in (near[number][0], near[number][1]))
            onto = _Onto(model.mesh.snap, Tolerances(extent).place, plate, earlier, later, moved)
            items[path] = onto.item(path, item)
            targets[number] = _target(path, items[path])
        if items == before:
            break
    made = {key: tuple(item for path, item in items.items() if path[0] == key) for key in keys}
    return model.varied(**made), tuple(moved.values())


def _plate(model: Model, mesh: Mesh | None) -> tuple[list[_Target], float]:
    """The edges of the plate, each by its own name, and the plate's diameter."""
    if not isinstance(model.plate, OutlinedPlate):
        assert mesh is not None  # such a plate is its mesh
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
    """What of an item others move onto; what stands on an edge adds nothing to the plate."""
    outline = item.where.outline
    corners = [
        *item.where.points,
        *outline.segments.reshape(-1, 2).tolist(),
        *outline.arcs[:, ::2].reshape(-1, 2).tolist(),
    ]
    return _Target(format_place(path), Targets.of((x, y) for x, y in corners), Targets.along(outline), outline.circles)


def _near(targets: Sequence[_Target], reach: float) -> list[tuple[Ints, Ints]]:
    """Numbers of those before and behind each that it may ever be near, since both move."""
    every = [Targets.join([one.corners, one.sides]) for one in targets if isinstance(one.sides, Targets)]
    boxes = np.array([one.bounds if len(one.points) + len(one.arcs) else (np.inf,) * 4 for one in every])
    low, high = boxes[:, :2] - 4.0 * reach, boxes[:, 2:] + 4.0 * reach
    result = []
    for number in range(len(boxes)):
        (those,) = np.nonzero((low[number] <= high).all(axis=1) & (low <= high[number]).all(axis=1))
        result.append((those[those < number], those[those > number]))
    return result


@dataclass(frozen=True, eq=False)
class _Onto:
    """Moves one item within a reach: onto the plate, onto what comes before it, onto sides of what comes behind it."""

    reach: float
    same: float
    plate: Sequence[_Target]
    before: Sequence[_Target]
    behind: Sequence[_Target]
    moved: dict[Place, Snapped]

    def item(self, path: Place, item: _Item) -> _Item:
        """The item where it then is."""
        moves: dict[str, Callable[[Place, Any], object]] = {
            "at": self._points,
            "line": self._line,
            "circle": self._circle,
            "area": self._area,
        }
        given = {key: getattr(item, key, None) for key in moves}
        update = {key: moves[key]((*path, key), it) for key, it in given.items() if it is not None and it != "all"}
        return item.model_copy(update=update)

    def _points(self, path: Place, points: Sequence[Point]) -> tuple[Point, ...]:
        return tuple(self._moved((*path, i), at, self._corner(at)) for i, at in enumerate(points))

    def _line(self, path: Place, points: Sequence[Point]) -> tuple[Point, ...]:
        ends = self._points(path, points)
        line = (ends[0], *(b for a, b in pairwise(ends) if a != b))
        if len(line) < 2:
            raise self._comes_to_nothing(path)
        return line

    def _area(self, path: Place, area: Area) -> Area:
        known = len(self.moved)
        update = self._form(path, area)
        if area.annulus is not None:
            (x, y), inner, outer = area.annulus.center, area.annulus.inner, area.annulus.outer
            rims = [self._ring((*path, "annulus", key), (x, y, r)) for key, r in (("inner", inner), ("outer", outer))]
            center = next((rim[:2] for rim in rims if rim[:2] != (x, y)), (x, y))
            update["annulus"] = Annulus.model_construct(center=center, inner=rims[0][2], outer=rims[1][2])
        update["holes"] = tuple(
            Form.model_construct(**self._form((*path, "holes", i), hole)) for i, hole in enumerate(area.holes)
        )
        if len(self.moved) == known:
            return area
        made = Area.model_construct(**update)
        try:
            _ = made.region
        except InputError:
            raise self._comes_to_nothing(path) from None
        return made

    def _form(self, path: Place, form: Form) -> dict[str, Any]:
        if form.rectangle is not None:
            return {"rectangle": self._rectangle((*path, "rectangle"), form.rectangle)}
        if form.circle is not None:
            return {"circle": self._circle((*path, "circle"), form.circle)}
        corners = list[Point | Arc]()
        for i, corner in enumerate(form.polygon or ()):
            here = (*path, "polygon", i)
            if isinstance(corner, Arc):
                through = self._moved((*here, "through"), corner.through, self._side(corner.through))
                to = self._moved((*here, "to"), corner.to, self._corner(corner.to))
                corners.append(Arc.model_construct(through=through, to=to))
            else:
                corners.append(self._moved(here, corner, self._corner(corner)))
        return {"polygon": tuple(corners)} if corners else {}

    def _rectangle(self, path: Place, box: Box) -> Box:
        """A rectangle stays one: each of its sides goes with the first of its corners that moves it."""
        x0, y0, x1, y1 = box
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        result = [self._corner(at) for at in corners]
        sides = list(box)
        for side, ends in enumerate(((0, 3), (0, 1), (1, 2), (2, 3))):
            at = (result[end][0][side % 2] for end in ends)
            sides[side] = next((one for one in at if one != box[side]), box[side])
        onto = " and ".join(dict.fromkeys(name for _, name in result if name))
        made = sides[0], sides[1], sides[2], sides[3]
        return self._moved(path, box, (made, onto))

    def _circle(self, path: Place, circle: Circle) -> Circle:
        x, y, radius = self._ring(path, (*circle.center, circle.radius))
        return Circle.model_construct(center=(x, y), radius=radius)

    def _ring(self, path: Place, ring: tuple[float, float, float]) -> tuple[float, float, float]:
        """The nearest circle of the plate or of what comes before: the farthest that any point of one is from it."""
        known = [(one, target.name) for target in (*self.plate, *self.before) for one in target.circles.tolist()]
        apart = [math.dist(one[:2], ring[:2]) + abs(one[2] - ring[2]) for one, _ in known]
        least = min(apart, default=math.inf)
        if least > self.reach:
            return ring
        (x, y, radius), name = known[apart.index(least)]
        made: tuple[float, float, float] = x, y, radius
        return self._moved(path, ring, (made, name))

    def _moved(self, path: Place, begin: _Numbers, result: tuple[_Numbers, str]) -> _Numbers:
        end, onto = result
        if max(abs(a - b) for a, b in zip(begin, end, strict=True)) > self.same:
            self.moved[path] = Snapped(format_place(path), begin, end, onto)
        return end

    def _corner(self, at: Point) -> tuple[Point, str]:
        """The corner, or else the place on a side, that a point moves onto, and what has it."""
        # What is near two edges of the plate is near their corner.
        several = len(self._near(at, self.plate, "sides")) > 1
        corners = self._near(at, self.plate, "corners", math.sqrt(2.0) if several else 1.0)
        before = self._near(at, self.before, "corners")
        if not (corners or before):
            return self._side(at)
        _, place, name = min(corners, default=None) or before[0]
        return place, name

    def _side(self, at: Point) -> tuple[Point, str]:
        """The place on a side that a point moves onto, and what has it; the point itself where there is none."""
        behind = [one for one in self.behind if not self._near(at, [one], "corners")]
        edges, others = self._near(at, self.plate, "sides"), self._near(at, [*self.before, *behind], "sides")
        if not (edges or others):
            return at, ""
        _, place, name = min(edges, default=None) or others[0]
        return place, name

    def _near(
        self, at: Point, targets: Iterable[_Target], what: Literal["corners", "sides"], reaches: float = 1.0
    ) -> list[tuple[float, Point, str]]:
        """How far corners or sides of targets within reach of a point are, the nearest place of each, and its name."""
        result = []
        for target in targets:
            (place,), (apart,) = getattr(target, what).nearest(np.array([at]))
            if apart <= self.reach * reaches:
                result.append((float(apart), (float(place[0]), float(place[1])), target.name))
        return result

    def _comes_to_nothing(self, path: Place) -> InputError:
        return InputError(
            f"With mesh.snap = {self.reach:g} it comes to nothing. Take less, or draw it where it is to be.", place=path
        )
