"""Where supports are, drawn as the input has them: points, sides and circles, and what of one is near another."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from signorini.discretise.places import region
from signorini.discretise.quadrature.crossings import evaluate, quadratics, with_circles, with_segments
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.mesh.boxtree import BoxTree
from signorini.model import AnnulusPlate, DiscPlate, Plate, Support
from signorini.model.curve import curve
from signorini.shapes import Region
from signorini.shapes.contours import along_arc
from signorini.shapes.outlines import Point

_MOST = 10_000
"""Points of one curve, or pairs of sides and segments, that are looked at together."""
_CHORDS = 64
"""Straight pieces of a curved side: they leave it by less than 1e-3 of its rise."""
_STRAIGHT = 1e-9


@dataclass(frozen=True, eq=False)
class Drawn:
    """Where a support is: points (q, 2) of it, straight or curved sides (k, 3, 2), circles (m, 3), and a region."""

    points: Floats
    sides: Floats = field(default_factory=lambda: np.zeros((0, 3, 2)))
    circles: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    inside: Region | None = None
    everywhere: bool = False
    only_points: bool = False

    @property
    def box(self) -> Floats:
        """A box xmin, ymin, xmax, ymax that holds all of it."""
        if self.everywhere:
            return np.array([-np.inf, -np.inf, np.inf, np.inf])
        # A curved side is within the triangle of its ends and of where its end tangents cross.
        crossings = 2.0 * self.sides[:, 1] - 0.5 * (self.sides[:, 0] + self.sides[:, 2])
        middle, radius = self.circles[:, :2], self.circles[:, 2:]
        places = np.concatenate([self.points, crossings, middle - radius, middle + radius])
        return np.concatenate([places.min(axis=0), places.max(axis=0)])

    def nearest(self, points: Floats, near: float) -> tuple[Ints, Floats]:
        """Which of some points are within ``near`` of this support, by number, and what of it is nearest to each."""
        every = np.arange(len(points))
        if self.everywhere:
            return every, points
        found = [(every[:0], points[:0])]
        if self.inside is not None:
            within = self.inside.contains(points)
            found.append((every[within], points[within]))
        chords = np.repeat(self.points[:, None], 2, axis=1) if self.only_points else _chords(self.sides)
        if len(chords):
            boxes = np.hstack([chords.min(axis=1) - near, chords.max(axis=1) + near])
            point, chord = BoxTree.build(boxes).pairs(points)
            a, along = chords[chord, 0], chords[chord, 1] - chords[chord, 0]
            length = (along**2).sum(axis=1)
            part = ((points[point] - a) * along).sum(axis=1) / np.where(length > 0, length, 1.0)
            found.append((point, a + np.clip(part, 0.0, 1.0)[:, None] * along))
        for x, y, radius in self.circles:
            out = points - (x, y)
            distance = np.hypot(*out.T)
            off = distance > 0.5 * radius
            found.append((every[off], (x, y) + out[off] * (radius / distance[off])[:, None]))
        which, at = (np.concatenate(parts) for parts in zip(*found, strict=True))
        close = np.hypot(*(points[which] - at).T) <= near
        return which[close], at[close]


def draw(mesh: Mesh, plate: Plate, support: Support, step: float) -> Drawn:
    """Draw a support, curves with points that are so far apart."""
    if support.at is not None:
        return Drawn(np.array(support.at, dtype=np.float64), only_points=True)
    if support.area == "all":
        return Drawn(mesh.points, everywhere=True)
    shape = curve(support) or region(support.area)
    if shape is None:
        return _draw_edges(mesh, plate, support.edge or (), step)
    outline, inside = shape.outline, region(support.area)
    chords = [outline.segments, *(_chords_of(*arc) for arc in outline.arcs.tolist())]
    ends = np.concatenate(chords)
    sides = np.stack([ends[:, 0], ends.mean(axis=1), ends[:, 1]], axis=1)
    points = [_spread(sides, outline.circles, step)]
    if inside is not None:
        points.append(mesh.points[inside.contains(mesh.points)])
    return Drawn(np.concatenate(points), sides, outline.circles, inside)


def _draw_edges(mesh: Mesh, plate: Plate, names: tuple[str, ...], step: float) -> Drawn:
    """Edges of the plate: true circles of discs and annuli, and sides of elements."""
    radii: dict[str, float] = {}
    center = (0.0, 0.0)
    match plate:
        case DiscPlate():
            radii, center = {"rim": plate.radius}, plate.center
        case AnnulusPlate():
            radii, center = {"inner": plate.inner, "outer": plate.outer}, plate.center
    others = [mesh.points[mesh.edges[name]] for name in names if name not in radii]
    sides = np.concatenate([np.zeros((0, 3, 2)), *others])
    circles = np.array([[*center, radii[name]] for name in names if name in radii]).reshape(-1, 3)
    return Drawn(_spread(sides, circles, step), sides, circles)


def _chords_of(a: Point, through: Point, b: Point) -> Floats:
    """Chords (k, 2, 2) of an arc."""
    along = along_arc(a, through, b)
    return np.stack([along[:-1], along[1:]], axis=1)


def _spread(sides: Floats, circles: Floats, step: float) -> Floats:
    """Points all along sides and circles, ends of sides among them."""
    found = [sides[:, [0, 2]].reshape(-1, 2)]
    along = quadratics(sides)
    length = np.hypot(*(sides[:, 2] - sides[:, 0]).T)
    count = np.minimum(np.ceil(length / step), _MOST // max(1, len(sides)) + 1).astype(np.int64)
    which = np.repeat(np.arange(len(sides)), count)
    number = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    found.append(evaluate(along[which], 2.0 * (number + 0.5) / count[which] - 1.0))
    for x, y, radius in circles:
        angle = np.linspace(0.0, 2 * np.pi, min(_MOST, math.ceil(2 * np.pi * radius / step) + 4), endpoint=False)
        found.append((x, y) + radius * np.column_stack([np.cos(angle), np.sin(angle)]))
    return np.concatenate(found)


def _is_straight(sides: Floats) -> Bools:
    bend = np.abs(sides[:, 1] - 0.5 * (sides[:, 0] + sides[:, 2])).max(axis=1, initial=0.0)
    return np.asarray(bend <= _STRAIGHT * np.abs(sides[:, 2] - sides[:, 0]).max(axis=1, initial=0.0))


def _chords(sides: Floats) -> Floats:
    """Straight segments (r, 2, 2) along sides."""
    straight = _is_straight(sides)
    bent = quadratics(sides[~straight])
    ends = [evaluate(bent, np.full(len(bent), t)) for t in np.linspace(-1.0, 1.0, _CHORDS + 1)]
    pieces = [np.stack([a, b], axis=1) for a, b in pairwise(ends)]
    return np.concatenate([sides[straight][:, [0, 2]], *pieces])


def crossings(one: Drawn, other: Drawn) -> Floats:
    """Points (r, 2) at which outlines cross; two curved sides, being a mesh's, meet at nodes only."""
    mine, others = _is_straight(one.sides), _is_straight(other.sides)
    found = [
        *_pairwise(one.sides, other.sides[others][:, [0, 2]], with_segments),
        *_pairwise(other.sides[~others], one.sides[mine][:, [0, 2]], with_segments),
        *_pairwise(one.sides, other.circles, with_circles),
        *_pairwise(other.sides, one.circles, with_circles),
        *(_of_circles(a, b) for a in one.circles for b in other.circles),
    ]
    return np.concatenate([np.zeros((0, 2)), *found])


def _pairwise(
    sides: Floats, others: Floats, crossed: Callable[[Floats, Floats], tuple[Ints, Floats]]
) -> Iterator[Floats]:
    """Cross every side with every segment or circle, some at a time."""
    if not len(sides):
        return
    curves, some = quadratics(sides), max(1, _MOST // len(sides))
    for first in range(0, len(others), some):
        part = others[first : first + some]
        pairs = np.repeat(curves, len(part), axis=0), np.concatenate([part] * len(curves))
        yield crossed(*pairs)[1]


def _of_circles(one: Floats, other: Floats) -> Floats:
    """Points (2, 2) at which two circles cross, or one of the first on the line through their centres."""
    between = other[:2] - one[:2]
    distance = float(np.hypot(*between))
    if distance == 0.0:
        return np.zeros((0, 2))
    along = between / distance
    part = 0.5 * (distance + (one[2] - other[2]) * (one[2] + other[2]) / distance)
    part = float(np.clip(part, -one[2], one[2]))
    up = math.sqrt((one[2] - part) * (one[2] + part)) * np.array([-along[1], along[0]])
    return np.asarray(one[:2] + part * along + np.array([up, -up]))


def feet(one: Drawn, other: Drawn) -> Floats:
    """The points (r, 2) of straight sides of one that are nearest to the centres of circles of the other."""
    sides = one.sides[_is_straight(one.sides)]
    a, along = sides[:, None, 0], (sides[:, 2] - sides[:, 0])[:, None]
    part = ((other.circles[None, :, :2] - a) * along).sum(axis=2) / (along**2).sum(axis=2)
    return np.asarray((a + np.clip(part, 0.0, 1.0)[..., None] * along).reshape(-1, 2))
