"""The boundary of a plate: what its edges hold, and at which corners numbers have no limit.

Near a corner the deflection and the slopes part (Rössle & Sändig 2011): w solves Laplace's equation, θ the equations of
plane stress with the plate's ν. Along rays they grow as r^λ, and where some λ < 1, shears or moments as r^(λ - 1).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.laws import can_let_go
from signorini.discretise.places import quadratic_tangents
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.mesh.sides import onto
from signorini.model import Support
from signorini.model.where import Where

Complexes = npt.NDArray[np.complex128]
Slopes = Literal["free", "slope", "twist", "clamped"]
"""What is held of the slopes along an edge: nothing, the one across it, the one along it, or both."""

_LEAST, _MOST, _TALL = 4e-3, 0.98, 2.0
"""Real parts between which exponents are looked for, and their largest imaginary part. At 0 and 1 rigid motions have
theirs; what grows as r^-0.02 shows on no mesh, and a hard corner of 179 degrees has 0.0056."""
_STEPS = 400
"""Points on each side of the box around them, on which the determinant turns by far less than half a circle a step."""
STRAIGHT = np.radians(1.0)
"""Turning at a node below which an edge runs on smoothly."""
_OF_ROUND = 0.2
"""Part of what two round sides turn themselves by which they may turn between them: parabolas stand for an arc."""
_OFF_ROUND = 0.1
"""Part of a side's rise within which a point of the circle that it stands for is on it."""
_NEAR, _NONE = 1e-4, 1e-6
"""Part of the plate's size over which the slope of a settlement is taken, and of that slope or the prescribed one what
their difference is at least: the first by its square, of curves, stays below the second."""


def slopes_held(across: bool, along: bool) -> Slopes:
    """What is held of the slopes, given whether those across and along an edge are."""
    if across:
        return "clamped" if along else "slope"
    return "twist" if along else "free"


def shears_grow(angle: float, held: bool, other_held: bool, along: bool) -> bool:
    """Whether shears have no limit at a corner between edges that hold the deflection or not.

    Between one that does and one that does not, at a right angle, they grow by the logarithm of the distance: along the
    one there is no shear strain ∂w/∂s - θs but -θs, and along the other none across it. Not so if ``along`` the edge
    that holds the deflection the slope is held too, as that of the deflection.
    """
    if held == other_held:
        return bool(angle > np.pi + STRAIGHT)
    return bool(angle > 0.5 * np.pi + (STRAIGHT if along else -STRAIGHT))


def moments_grow(angle: float, one: Slopes, other: Slopes, poisson: float) -> bool:
    """Whether moments have no limit at a corner between edges that hold these slopes."""
    if abs(angle - np.pi) <= STRAIGHT and one == other:
        return False
    return exponents_below_one(angle, one, other, poisson) > 0


def exponents_below_one(angle: float, one: Slopes, other: Slopes, poisson: float) -> int:
    """Count the exponents with real parts between 0 and 1, by the argument principle.

    They are where Williams' functions of plane stress (1952) can meet both edges' conditions: a determinant is zero.
    """
    # Finely beside 0 and 1, where there are exponents just outside the box.
    across, along = np.linspace(_LEAST, _MOST, _STEPS), _TALL * np.linspace(-1.0, 1.0, _STEPS) ** 3
    box = [across - 1j * _TALL, _MOST + 1j * along, across[::-1] + 1j * _TALL, _LEAST + 1j * along[::-1]]
    at = np.concatenate(box)
    rows = _conditions(at, 0.0, one, poisson) + _conditions(at, angle, other, poisson)
    value = np.linalg.det(np.stack([np.stack(row, axis=-1) for row in rows], axis=-2))
    turned = np.angle(np.roll(value, -1) / value)
    return round(float(turned.sum()) / (2 * np.pi))


def _conditions(exponent: Complexes, at: float, slopes: Slopes, poisson: float) -> list[tuple[Complexes, ...]]:
    """Two rows over the four functions: slopes that are held, and moments that are zero, without common factors."""
    more, less = exponent + 1, exponent - 1
    # Airy's function is r^(λ + 1) F, and both slopes have a part of their own of its last two functions.
    value = np.cos(more * at), np.sin(more * at), np.cos(less * at), np.sin(less * at)
    slope = -more * value[1], more * value[0], -less * value[3], less * value[2]
    own = 1 + (3 - poisson) / (1 + poisson)
    none = np.zeros_like(exponent)
    along = tuple(-more * f + own * g for f, g in zip(value, (none, none, value[2], value[3]), strict=True))
    across = tuple(-f + own * g for f, g in zip(slope, (none, none, value[3], -value[2]), strict=True))
    match slopes:
        case "free":
            return [value, slope]
        case "clamped":
            return [along, across]
        case "twist":
            return [along, value]
        case "slope":
            return [across, slope]


@dataclass(frozen=True, eq=False)
class Boundary:
    """The sides of elements along the boundary, the plate on their left; rigid zones are no part of it, and clamp it.

    ``sides`` (k, 3) are nodes: corner, midside, corner; ``following`` (k,) the next side, ``angles`` (k,) the angle of
    the plate between both, π where they run on smoothly. ``rigid`` marks sides of a rigid zone, ``held`` those whose
    deflection is held, or may be, by a rigid support of any kind, ``lets_go`` by what may let go only. ``slope`` and
    ``twist`` mark slopes held across and along a side, ``sheared`` (k, 2) whether the latter is held to another one
    than the deflection's, where the side begins and ends. ``poisson`` (k,) is that of the material beside it.
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
            on = np.isin(sides[:, 1], middles(mesh, support.where))
            if support.modulus is None:
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
        slack = np.maximum(STRAIGHT, _OF_ROUND * np.maximum(np.abs(own), np.abs(own[following])))
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


def middles(mesh: Mesh, where: Where) -> Ints:
    """Nodes in the middles of the sides along an edge, a line or a circle; none where the mesh does not follow."""
    if where.edges:
        return np.concatenate([mesh.edges[name] for name in where.edges])[:, 1]
    sides = None if where.curve is None else mesh.edges_along(where.curve)
    return np.zeros(0, np.int64) if sides is None else sides[:, 1]


@kept
def boundary_of(discretisation: Discretisation) -> Boundary:
    """The boundary of the plate, found once."""
    return Boundary.of(discretisation)


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
