"""The boundary of a plate: what its edges hold, its corners, and where points are on it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from signorini.discretise import Discretisation
from signorini.discretise.places import quadratic_tangents
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.supports import can_let_go
from signorini.mesh import Mesh
from signorini.mesh.sides import onto
from signorini.model import Load, Support
from signorini.model.places import curve
from signorini.singularities.corners import Slopes, moments_grow, shears_grow, slopes_held

_STRAIGHT = np.radians(1.0)
"""Turning at a node below which an edge runs on smoothly."""
_OF_ROUND = 0.2
"""Part of what two round sides turn themselves by which they may turn between them: parabolas stand for an arc."""
_OFF_ROUND = 0.1
"""Part of a side's rise within which a point of the circle that it stands for is on it."""
_NEAR, _NONE = 1e-4, 1e-6
"""Part of the plate's size over which the slope of a settlement is taken, and of that slope or the prescribed one what
their difference is at least: the first by its square, of curves, stays below the second."""


@dataclass(frozen=True, eq=False)
class Boundary:
    """The sides of elements along the boundary, the plate on their left; rigid zones are no part of it, and clamp it.

    Parameters
    ----------
    sides : (k, 3) array
        Nodes: corner, midside, corner.
    following : (k,) array
        The next side.
    angles : (k,) array
        Angle of the plate between each side and the next; π where they run on smoothly.
    rigid : (k,) array
        Whether the side is a rigid zone's.
    held : (k,) array
        Whether the deflection is held, or may be: by a rigid support of any kind.
    lets_go : (k,) array
        Whether the deflection is held by what may let go only.
    slope, twist : (k,) arrays
        Whether the slopes across and along the side are held.
    sheared : (k, 2) array
        Whether the slope along the side is held to another one than the deflection's, where it begins and ends.
    poisson : (k,) array
        Poisson's ratio of the material beside each side.
    """

    mesh: Mesh
    sides: Ints
    following: Ints
    angles: Floats
    rigid: Bools
    held: Bools
    lets_go: Bools
    slope: Bools
    twist: Bools
    sheared: Bools
    poisson: Floats

    @classmethod
    def of(cls, discretisation: Discretisation) -> Boundary:
        """The boundary with what the model's supports hold along it."""
        mesh, bodies = discretisation.mesh, discretisation.held.bodies
        elastic = np.flatnonzero(~bodies.rigid)
        sides = (mesh.part(elastic) if 0 < len(elastic) < len(bodies.rigid) else mesh).boundary
        tangents = quadratic_tangents(mesh, sides)
        rigid = bodies.inside[sides[:, 1]]
        held, always, slope, twist = np.tile(rigid, (4, 1))
        sheared = np.zeros((len(sides), 2), np.bool_)
        for support in discretisation.model.support:
            on = np.isin(sides[:, 1], middles(mesh, support))
            if support.stiffness is None:
                held |= on & support.holds_w
                always |= on & (not can_let_go(support)) & held
            slope |= on & ("slope" in support.fixed)
            twist |= on & ("twist" in support.fixed)
            for end, node in enumerate((0, 2)):
                sheared[on, end] |= shears_along(support, mesh.points[sides[on, node]], tangents[on, node], mesh.size)
        first = {node: number for number, node in enumerate(sides[:, 0].tolist())}
        following = np.array([first[node] for node in sides[:, 2].tolist()])
        own = _turn(tangents[:, 0], tangents[:, 2])
        turn = _turn(tangents[:, 2], tangents[following, 0])
        slack = np.maximum(_STRAIGHT, _OF_ROUND * np.maximum(np.abs(own), np.abs(own[following])))
        angles = np.pi - np.where(np.abs(turn) > slack, turn, 0.0)
        poisson = discretisation.zones.poisson_of(mesh.find_sides(sides)[0])
        return cls(mesh, sides, following, angles, rigid, held, held & ~always, slope, twist, sheared, poisson)

    def slopes(self, side: int) -> Slopes:
        """What a side holds of the slopes."""
        return slopes_held(bool(self.slope[side]), bool(self.twist[side]))

    def corners(self) -> list[tuple[tuple[float, float], float, bool, tuple[str, ...]]]:
        """Corners without a limit of some number: where, the angle in degrees, if of a rigid zone, and the numbers."""
        result = []
        keys = np.column_stack([self.held, self.slope, self.twist])
        changes = (keys != keys[self.following]).any(axis=1)
        for side in np.flatnonzero(changes | (self.angles != np.pi)).tolist():
            other, angle = int(self.following[side]), float(self.angles[side])
            numbers = []
            if moments_grow(angle, self.slopes(side), self.slopes(other), float(self.poisson[side])):
                numbers.append("moment")
            if any(self._shears_grow(angle, side, other, *held) for held in self._states(side, other)):
                numbers.append("shear")
            if numbers:
                x, y = self.mesh.points[self.sides[side, 2]].tolist()
                result.append(((x, y), float(np.degrees(angle)), bool(self.rigid[side]), tuple(numbers)))
        return result

    def loops(self) -> Iterator[Floats]:
        """Closed lines of edges by their corners (m, 2), the first again at the end; where they are round by nodes."""
        begin, middle, end = (self.mesh.points[self.sides[:, i]] for i in range(3))
        straight = np.hypot(*(0.5 * (begin + end) - middle).T) <= self.mesh.near.written
        turns = (self.angles != np.pi) | ~straight | ~straight[self.following]
        left = set(range(len(self.sides)))
        while left:
            side, loop = min(left), []
            while side in left:
                left.remove(side)
                loop += [end[side]] if turns[side] else []
                side = int(self.following[side])
            yield np.array([*loop, loop[0]])

    def _shears_grow(self, angle: float, side: int, other: int, held: bool, other_held: bool) -> bool:
        # Of the side that holds the deflection, at the end where they meet.
        which, end = (side, 1) if held else (other, 0)
        return shears_grow(angle, held, other_held, bool(self.twist[which] and not self.sheared[which, end]))

    def _states(self, side: int, other: int) -> set[tuple[bool, bool]]:
        """Whether two sides hold the deflection where they meet; both that may let go do at once."""
        mine, beside = bool(self.held[side]), bool(self.held[other])
        first, second = bool(self.lets_go[side]), bool(self.lets_go[other])
        return {(mine, beside), (mine and not first, beside and not second)}

    def at(self, point: Floats) -> Ints:
        """Sides that a point (2,) is on: none inside, two at a node between them."""
        sides = self.mesh.points[self.sides]
        distance = np.hypot(*(point - onto(sides, point)).T)
        rise = np.hypot(*(0.5 * (sides[:, 0] + sides[:, 2]) - sides[:, 1]).T)
        # Ends of lines are on true circles, sides on their parabolas.
        return np.flatnonzero(distance <= np.maximum(self.mesh.near.written, _OFF_ROUND * rise))

    def tangent(self, side: int) -> Floats:
        """Direction (2,) of a side, from end to end."""
        a, b = self.mesh.points[self.sides[side, [0, 2]]]
        return np.asarray((b - a) / np.hypot(*(b - a)))

    def rays(self, point: Floats) -> list[tuple[int, Floats]]:
        """Sides that go on from a point on the boundary, with their directions (2,) from there; none inside."""
        result = []
        for side in self.at(point).tolist():
            tangent = self.tangent(side)
            first, last = (np.hypot(*(self.mesh.points[self.sides[side, k]] - point)) for k in (0, 2))
            slack = self.mesh.near.written
            result += [(side, tangent)] if last > slack else []
            result += [(side, -tangent)] if first > slack else []
        return result


def middles(mesh: Mesh, item: Load | Support) -> Ints:
    """Nodes in the middles of the sides along an edge, a line or a circle; none where the mesh does not follow."""
    if item.edge is not None:
        return np.concatenate([mesh.edges[name] for name in item.edge])[:, 1]
    along = curve(item)
    sides = None if along is None else mesh.edges_along(along)
    return np.zeros(0, np.int64) if sides is None else sides[:, 1]


def boundary_of(discretisation: Discretisation) -> Boundary:
    """The boundary of the plate, found once."""
    if discretisation not in _BOUNDARIES:
        _BOUNDARIES[discretisation] = Boundary.of(discretisation)
    return _BOUNDARIES[discretisation]


def shears_along(support: Support, at: Floats, tangents: Floats, size: float) -> Bools:
    """Whether a support holds slopes along tangents (k, 2) at points (k, 2) that are not those of its settlement."""
    if support.rotation is None or "twist" not in support.fixed or not support.holds_w or not len(at):
        return np.zeros(len(at), np.bool_)
    units = tangents / np.hypot(*tangents.T)[:, None]
    prescribed = sum(one(*at.T) * unit for one, unit in zip(support.rotation, units.T, strict=True))
    step = _NEAR * size * units
    own = (support.settlement(*(at + step).T) - support.settlement(*(at - step).T)) / (2 * _NEAR * size)
    return np.asarray(np.abs(prescribed - own) > _NONE * np.maximum(np.abs(prescribed), np.abs(own)))


def _turn(a: Floats, b: Floats) -> Floats:
    """Angles (k,) from directions (k, 2) to others, to the left."""
    return np.asarray(np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)))


_BOUNDARIES: WeakKeyDictionary[Discretisation, Boundary] = WeakKeyDictionary()
