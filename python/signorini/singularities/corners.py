"""Corners of a Reissner-Mindlin plate: by their angle and edge conditions, which of its numbers have no limit there.

Near a corner the deflection and the slopes part (Rössle & Sändig 2011): w solves Laplace's equation, θ the equations of
plane stress with the plate's ν. Along rays they grow as r^λ, and where some λ < 1, shears or moments as r^(λ - 1).
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import numpy.typing as npt

Complexes = npt.NDArray[np.complex128]
Slopes = Literal["free", "slope", "twist", "clamped"]
"""What is held of the slopes along an edge: nothing, the one across it, the one along it, or both."""

_STRAIGHT = np.radians(1.0)
"""How far an angle may be from one at which the answer changes."""
_LEAST, _MOST, _TALL = 4e-3, 0.98, 2.0
"""Real parts between which exponents are looked for, and their largest imaginary part. At 0 and 1 rigid motions have
theirs; what grows as r^-0.02 shows on no mesh, and a hard corner of 179 degrees has 0.0056."""
_STEPS = 400
"""Points on each side of the box around them, on which the determinant turns by far less than half a circle a step."""


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

    Examples
    --------
    >>> [shears_grow(np.radians(angle), True, False, along=True) for angle in (60, 90, 120, 180)]
    [False, False, True, True]
    >>> [shears_grow(np.radians(angle), True, False, along=False) for angle in (60, 90, 120, 180)]
    [False, True, True, True]
    """
    if held == other_held:
        return bool(angle > np.pi + _STRAIGHT)
    return bool(angle > 0.5 * np.pi + (_STRAIGHT if along else -_STRAIGHT))


def moments_grow(angle: float, one: Slopes, other: Slopes, poisson: float) -> bool:
    """Whether moments have no limit at a corner between edges that hold these slopes.

    Examples
    --------
    A corner inwards, one of a cantilever's root, and an obtuse one of a hard simple support.

    >>> moments_grow(np.radians(270), "free", "free", 0.2), moments_grow(np.radians(90), "free", "free", 0.2)
    (True, False)
    >>> moments_grow(np.radians(90), "clamped", "free", 0.3), moments_grow(np.radians(50), "clamped", "free", 0.3)
    (True, False)
    >>> moments_grow(np.radians(120), "twist", "twist", 0.3), moments_grow(np.radians(90), "twist", "twist", 0.3)
    (True, False)
    """
    if abs(angle - np.pi) <= _STRAIGHT and one == other:
        return False
    return exponents_below_one(angle, one, other, poisson) > 0


def exponents_below_one(angle: float, one: Slopes, other: Slopes, poisson: float) -> int:
    """Count the exponents with real parts between 0 and 1, by the argument principle.

    They are where Williams' functions of plane stress (1952) can meet both edges' conditions: a determinant is zero.
    """
    # Finely beside 0 and 1, where there are exponents just outside the box.
    across, along = np.linspace(_LEAST, _MOST, _STEPS), _TALL * np.linspace(-1.0, 1.0, _STEPS) ** 3
    box = [across - 1j * _TALL, _MOST + 1j * along, across[::-1] + 1j * _TALL, _LEAST + 1j * along[::-1]]
    value = _determinant(np.concatenate(box), angle, one, other, poisson)
    turned = np.angle(np.roll(value, -1) / value)
    return round(float(turned.sum()) / (2 * np.pi))


def _determinant(exponent: Complexes, angle: float, one: Slopes, other: Slopes, poisson: float) -> Complexes:
    rows = _conditions(exponent, 0.0, one, poisson) + _conditions(exponent, angle, other, poisson)
    return np.asarray(np.linalg.det(np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)))


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
