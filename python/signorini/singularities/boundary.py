"""The boundary of a plate: dofs held along its edges, and corners with singular moments or shears.

Near a corner the deflection and the slopes decouple (Rössle & Sändig 2011): w solves Laplace's equation, θ the
equations of plane stress with the plate's ν. Along rays they grow as r^λ. If λ < 1, shears or moments grow as r^(λ−1).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
import numpy.typing as npt

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.laws import can_let_go, settlement_at, slopes_at
from signorini.discretise.places import quadratic_tangents
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.mesh.sides import onto
from signorini.model import Support
from signorini.model.where import Where

Complexes = npt.NDArray[np.complex128]
Slopes = Literal["free", "slope", "twist", "clamped"]
"""Slopes that an edge holds: none, the one normal to the edge, the one along the edge, or both."""

_LEAST, _MOST, _TALL = 4e-3, 0.98, 2.0
"""Smallest and largest real part and largest imaginary part of the exponents that are sought (dimensionless). The
exponents 0 and 1 of rigid motions are outside this box. Growth as r^-0.02 is invisible on any mesh; the smallest
exponent of interest, of a hard corner of 179°, is 0.0056."""
_STEPS = 400
"""Number of points on each side of the box in the complex plane: between two points the argument of the determinant
changes by far less than π.
"""
STRAIGHT = np.radians(1.0)
"""Largest angle in radians (1°) between two successive sides of a smooth edge."""
_OF_ROUND = 0.2
"""Largest angle between two successive sides of a round edge, relative to the angle by which a side turns. It is not
zero, since sides are parabolas, not arcs.
"""
_OFF_ROUND = 0.1
"""Largest distance from a curved side at which a point counts as on the side, relative to the side's rise. Points of
the exact circle are off the parabola.
"""
_NEAR, _NONE = 1e-4, 1e-6
"""Step of the difference quotient of a settlement, relative to the plate's size; relative tolerance for equal slopes.

The error of the quotient, of second order, is below the tolerance."""


def slopes_held(across: bool, along: bool) -> Slopes:
    """Name of the held slopes, given whether an edge holds the slope across (normal to) it and along it."""
    if across:
        return "clamped" if along else "slope"
    return "twist" if along else "free"


def shears_grow(angle: float, held: bool, other_held: bool, along: bool) -> bool:
    """Whether shears are singular at a corner between edges that hold the deflection (``held``) or not.

    At a right angle between a held and a free edge, shears grow as the logarithm of the distance. On the held edge the
    shear strain ∂w/∂s − θs is −θs, on the free edge the normal shear strain is 0. Shears do not grow if the held edge
    also holds the slope along itself at ∂w/∂s of its deflection (``along``).
    """
    if held == other_held:
        return bool(angle > np.pi + STRAIGHT)
    return bool(angle > 0.5 * np.pi + (STRAIGHT if along else -STRAIGHT))


def moments_grow(angle: float, first: Slopes, second: Slopes, poisson: float) -> bool:
    """Whether moments are singular at a corner between two edges with the held slopes ``first`` and ``second``."""
    if abs(angle - np.pi) <= STRAIGHT and first == second:
        return False
    return exponents_below_one(angle, first, second, poisson) > 0


@lru_cache(maxsize=1024)
def exponents_below_one(angle: float, first: Slopes, second: Slopes, poisson: float) -> int:
    """Count the exponents λ of a corner with real parts between 0 and 1, by the argument principle.

    The exponents are the zeros of the determinant of both edges' conditions on Williams' functions of plane stress
    (1952).
    """
    # The points are dense near the real axis, since the exponents 0 and 1 lie just outside this box of complex numbers.
    across, along = np.linspace(_LEAST, _MOST, _STEPS), _TALL * np.linspace(-1.0, 1.0, _STEPS) ** 3
    box = [across - 1j * _TALL, _MOST + 1j * along, across[::-1] + 1j * _TALL, _LEAST + 1j * along[::-1]]
    exponents = np.concatenate(box)
    rows = _conditions(exponents, 0.0, first, poisson) + _conditions(exponents, angle, second, poisson)
    value = np.linalg.det(np.stack([np.stack(row, axis=-1) for row in rows], axis=-2))
    turned = np.angle(np.roll(value, -1) / value)
    return round(float(turned.sum()) / (2 * np.pi))


def _conditions(exponent: Complexes, angle: float, slopes: Slopes, poisson: float) -> list[tuple[Complexes, ...]]:
    """Two boundary conditions of an edge at a polar angle: coefficients of Williams' functions, up to a factor.

    The condition is slope = 0 if the edge holds the slope, and moment = 0 if the slope is free.
    """
    more, less = exponent + 1, exponent - 1
    # Airy's stress function is r^(λ + 1) F; ``value`` has four functions F. The last two add terms to both slopes.
    value = np.cos(more * angle), np.sin(more * angle), np.cos(less * angle), np.sin(less * angle)
    slope = -more * value[1], more * value[0], -less * value[3], less * value[2]
    factor = 1 + (3 - poisson) / (1 + poisson)
    none = np.zeros_like(exponent)
    along = tuple(-more * f + factor * g for f, g in zip(value, (none, none, value[2], value[3]), strict=True))
    across = tuple(-f + factor * g for f, g in zip(slope, (none, none, value[3], -value[2]), strict=True))
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
    """Element sides along the boundary of the plate without its rigid zones; the plate is on the left of each side.

    Rigid zones clamp the rest of the plate. ``sides`` (k, 3) are nodes: corner, midside, corner. ``following`` (k,) is
    the next side, ``angles`` (k,) the angle of the plate between a side and the next, π where the edge is smooth.
    ``rigid`` (k,) marks sides of rigid zones, ``held`` (k,) sides whose deflection a rigid support holds or may hold.
    ``lets_go`` (k,) marks held sides that only one-sided supports hold, which can open. ``slope`` and ``twist`` (k,)
    mark held slopes across and along a side. ``sheared`` (k, 2) marks the begin and the end of sides at which the held
    slope along the side differs from the slope of the held deflection. ``poisson`` (k,) is Poisson's ratio beside the
    side.
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
        """Find the boundary of the plate and the dofs that supports hold along it."""
        mesh, bodies = discretisation.mesh, discretisation.held.bodies
        elastic = np.flatnonzero(~bodies.rigid)
        sides = (mesh.part(elastic) if 0 < len(elastic) < len(bodies.rigid) else mesh).boundary
        tangents = quadratic_tangents(mesh, sides)
        rigid = bodies.inside[sides[:, 1]]
        held, always, slope, twist = np.tile(rigid, (4, 1))
        sheared = np.zeros((len(sides), 2), np.bool_)
        for support in discretisation.model.support:
            along = np.isin(sides[:, 1], middles(mesh, support.where))
            if not support.is_elastic:
                held |= along & support.holds_w
                always |= along & (not can_let_go(support)) & held
            slope |= along & ("slope" in support.fixed)
            twist |= along & ("twist" in support.fixed)
            for end, node in enumerate((0, 2)):
                sheared[along, end] |= shears_along(
                    support, mesh.points[sides[along, node]], tangents[along, node], mesh.size
                )
        first = {node: number for number, node in enumerate(sides[:, 0].tolist())}
        following = np.array([first[node] for node in sides[:, 2].tolist()])
        bend = _turn(tangents[:, 0], tangents[:, 2])
        turn = _turn(tangents[:, 2], tangents[following, 0])
        slack = np.maximum(STRAIGHT, _OF_ROUND * np.maximum(np.abs(bend), np.abs(bend[following])))
        angles = np.pi - np.where(np.abs(turn) > slack, turn, 0.0)
        poisson = discretisation.zones.poisson_of(mesh.find_sides(sides)[0])
        return cls(mesh, sides, following, angles, rigid, held, held & ~always, slope, twist, sheared, poisson)

    def slopes(self, side: int) -> Slopes:
        """Held slopes of an element side: none, across it, along it, or both."""
        return slopes_held(bool(self.slope[side]), bool(self.twist[side]))

    def corners(self) -> list[tuple[tuple[float, float], float, bool, tuple[str, ...]]]:
        """Singular corners: position, angle in degrees, whether at a rigid zone, and names of the singular results."""
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
        """Yield a closed polygon (m, 2) for each edge loop: corners, nodes of round parts, the first point again."""
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
        # Whether the slope along the side that holds the deflection is held at ∂w/∂s is read at its end at the corner.
        which, end = (side, 1) if held else (other, 0)
        return shears_grow(angle, held, other_held, bool(self.twist[which] and not self.sheared[which, end]))

    def _states(self, side: int, other: int) -> set[tuple[bool, bool]]:
        """Whether two sides at a corner hold the deflection: with all supports, and with those that cannot open."""
        held, other_held = bool(self.held[side]), bool(self.held[other])
        lets_go, other_lets_go = bool(self.lets_go[side]), bool(self.lets_go[other])
        return {(held, other_held), (held and not lets_go, other_held and not other_lets_go)}

    def at(self, point: Floats) -> Ints:
        """Indices of the sides that contain a point (2,): none for a point inside, two at a common node."""
        sides = self.mesh.points[self.sides]
        distance = np.hypot(*(point - onto(sides, point)).T)
        rise = np.hypot(*(0.5 * (sides[:, 0] + sides[:, 2]) - sides[:, 1]).T)
        # The tolerance is needed because ends of lines lie on exact circles, but sides are parabolas.
        return np.flatnonzero(distance <= np.maximum(self.mesh.near.written, _OFF_ROUND * rise))

    def tangent(self, side: int) -> Floats:
        """Direction (2,) of an element side, from its first to its last node."""
        a, b = self.mesh.points[self.sides[side, [0, 2]]]
        return np.asarray((b - a) / np.hypot(*(b - a)))

    def rays(self, point: Floats) -> list[tuple[int, Floats]]:
        """Sides that leave a point on the boundary, with their directions (2,); an empty list for a point inside."""
        result = []
        for side in self.at(point).tolist():
            tangent = self.tangent(side)
            first, last = (np.hypot(*(self.mesh.points[self.sides[side, k]] - point)) for k in (0, 2))
            slack = self.mesh.near.written
            result += [(side, tangent)] if last > slack else []
            result += [(side, -tangent)] if first > slack else []
        return result


def middles(mesh: Mesh, where: Where) -> Ints:
    """Midside nodes (k,) along an edge, a line or a circle; empty where element sides do not follow the line."""
    if where.edges:
        return np.concatenate([mesh.edges[name] for name in where.edges])[:, 1]
    sides = None if where.curve is None else mesh.edges_along(where.curve)
    return np.zeros(0, np.int64) if sides is None else sides[:, 1]


@kept
def boundary_of(discretisation: Discretisation) -> Boundary:
    """The `Boundary` of the plate, computed once."""
    return Boundary.of(discretisation)


def shears_along(support: Support, points: Floats, tangents: Floats, size: float) -> Bools:
    """Mask (k,): whether slopes prescribed at points (k, 2) along tangents (k, 2) differ from the settlement's."""
    if not support.prescribes_slopes or "twist" not in support.fixed or not support.holds_w or not len(points):
        return np.zeros(len(points), np.bool_)
    units = tangents / np.hypot(*tangents.T)[:, None]
    prescribed = (slopes_at(support, points) * units).sum(axis=1)
    step = _NEAR * size * units
    along = settlement_at(support, points + step) - settlement_at(support, points - step)
    of_settlement = along / (2 * _NEAR * size)
    return np.asarray(
        np.abs(prescribed - of_settlement) > _NONE * np.maximum(np.abs(prescribed), np.abs(of_settlement))
    )


def _turn(a: Floats, b: Floats) -> Floats:
    """Counter-clockwise angles (k,) from directions ``a`` (k, 2) to ``b`` (k, 2)."""
    return np.asarray(np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)))
