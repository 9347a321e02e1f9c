"""Closed forms and series that several families of cases use."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial import Legendre, Polynomial

KAPPA = 5 / 6
"""Shear correction factor κ."""
TIMOSHENKO = "S. Timoshenko, S. Woinowsky-Krieger, *Theory of Plates and Shells*, 2nd ed., 1959"


def rigidity(young: float, thickness: float, nu: float) -> float:
    """Bending stiffness D = E h³/12(1 − ν²) of a plate."""
    return young * thickness**3 / 12 / (1 - nu**2)


def shear_factor(thickness: float, nu: float) -> float:
    """Factor h²/6κ(1 − ν) of the shear deflection of a hard simply supported plate (Mindlin 1951)."""
    return thickness**2 / (6 * (1 - nu) * KAPPA)


@dataclass(frozen=True)
class Navier:
    """Navier's double sine series of a hard simply supported plate a × b.

    ``pressure`` returns the coefficient of sin αx sin βy from arrays of m and n. ``shear`` is the return value of
    `shear_factor`; 0 gives the thin plate. ``bed`` is k/D.
    """

    a: float
    b: float
    nu: float
    pressure: Callable[[np.ndarray, np.ndarray], np.ndarray]
    shear: float = 0.0
    bed: float = 0.0
    terms: tuple[int, int] = (800, 800)

    def at(self, x: float, y: float) -> tuple[float, float, float]:
        """Return the deflection times D, and the moments mx and my, at (x, y)."""
        m, n = np.arange(1, self.terms[0])[:, None], np.arange(1, self.terms[1])[None, :]
        alpha, beta = m * np.pi / self.a, n * np.pi / self.b
        square = alpha**2 + beta**2
        shape = self.pressure(m, n) * np.sin(alpha * x) * np.sin(beta * y)
        softer = 1 + self.shear * square
        curved = shape / (square**2 + self.bed * softer)
        return (
            float((curved * softer).sum()),
            float((curved * (alpha**2 + self.nu * beta**2)).sum()),
            float((curved * (beta**2 + self.nu * alpha**2)).sum()),
        )


def uniform(m: np.ndarray, n: np.ndarray) -> np.ndarray:
    """Sine coefficients of a uniform pressure of 1; Timoshenko and Woinowsky-Krieger (1959), chapter 5."""
    return np.asarray(16 / np.pi**2 * (m % 2) * (n % 2) / (m * n))


def hydrostatic(m: np.ndarray, n: np.ndarray) -> np.ndarray:
    """Sine coefficients of the pressure x/a; Timoshenko and Woinowsky-Krieger (1959), chapter 5."""
    return np.asarray(8 / np.pi**2 * np.where(m % 2, 1.0, -1.0) * (n % 2) / (m * n))


def patch(u: float, v: float) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Sine coefficients of a force of 1, spread over the middle part u × v of a unit square."""

    def coefficients(m: np.ndarray, n: np.ndarray) -> np.ndarray:
        across = np.sin(m * np.pi / 2) * np.sin(m * np.pi * u / 2) / (m * u)
        along = np.sin(n * np.pi / 2) * np.sin(n * np.pi * v / 2) / (n * v)
        return np.asarray(16 / np.pi**2 * across * along)

    return coefficients


class Levy:
    """Lévy's series of a thin plate under q = 1, simply supported at x = 0 and x = a.

    The sides y = ± b/2 are "simple", "clamped" or "free"; Timoshenko and Woinowsky-Krieger (1959), chapter 6.
    """

    def __init__(self, a: float, b: float, nu: float, lower: str, upper: str, terms: int = 80) -> None:
        self.nu, self._c = nu, b / 2
        self._alpha = np.arange(1, terms, 2) * np.pi / a
        self._particular = 4 / a / self._alpha**5
        rows = {
            "simple": (self._w, self._moment),
            "clamped": (self._w, self._slope),
            "free": (self._moment, self._force),
        }
        y = ((-b / 2, rows[lower]), (b / 2, rows[upper]))
        matrix = np.stack([row(at) for at, kind in y for row in kind], axis=1)[..., :4]
        right = np.stack([row(at)[:, 4] for at, kind in y for row in kind], axis=1) * self._particular[:, None]
        self._constants = np.linalg.solve(matrix, -right[..., None])[..., 0]

    def at(self, x: float, y: float) -> tuple[float, float, float]:
        """Return the deflection times D, and the moments mx and my, at (x, y)."""
        weights = np.concatenate([self._constants, self._particular[:, None]], axis=1)
        shape, curved = (weights * self._basis(y, 0)).sum(axis=1), (weights * self._basis(y, 2)).sum(axis=1)
        sine, own = np.sin(self._alpha * x), self._alpha**2 * shape
        mx, my = sine @ (own - self.nu * curved), sine @ (self.nu * own - curved)
        return float(sine @ shape), float(mx), float(my)

    def _basis(self, y: float, derivative: int) -> np.ndarray:
        """Derivatives (m, 5) along y of e^αy, αy e^αy, e^−αy, αy e^−αy and 1; exponentials are 1 at one side."""
        result = []
        for sign in (1.0, -1.0):
            scaled = np.exp(sign * self._alpha * y - self._alpha * self._c)
            power = (sign * self._alpha) ** derivative
            lower = derivative * (sign * self._alpha) ** max(derivative - 1, 0) * self._alpha
            result += [power * scaled, (self._alpha * y * power + lower) * scaled]
        return np.stack([*result, np.full_like(self._alpha, derivative == 0)], axis=1)

    def _w(self, y: float) -> np.ndarray:
        return self._basis(y, 0)

    def _slope(self, y: float) -> np.ndarray:
        return np.asarray(self._basis(y, 1) / self._alpha[:, None])

    def _moment(self, y: float) -> np.ndarray:
        return np.asarray(self._basis(y, 2) / self._alpha[:, None] ** 2 - self.nu * self._basis(y, 0))

    def _force(self, y: float) -> np.ndarray:
        alpha = self._alpha[:, None]
        return np.asarray(self._basis(y, 3) / alpha**3 - (2 - self.nu) * self._basis(y, 1) / alpha)


def clamped(a: float, b: float, nu: float, x: float, y: float, terms: int = 12) -> tuple[float, float, float]:
    """Return w D, mx and my at (x, y) of a thin clamped plate a × b under q = 1, by Ritz's method.

    The functions are (1 − s²)² P₂ᵢ(s) along each side, with s from −1 to 1; for clamped edges the energy is
    D/2 ∫ (Δw)².
    """
    shapes = [Legendre.basis(2 * i).convert(kind=Polynomial) * Polynomial([1, 0, -2, 0, 1]) for i in range(terms)]
    at, weights = np.polynomial.legendre.leggauss(4 * terms + 8)

    def values(s: np.ndarray, side: float) -> list[np.ndarray]:
        return [np.array([one.deriv(k)(s) * (2 / side) ** k for one in shapes]) for k in range(3)]

    along, across = (values(at, side) for side in (a, b))
    X, Y = ([(of * weights * side / 2) @ of.T for of in part] for part, side in ((along, a), (across, b)))
    matrix = np.kron(X[2], Y[0]) + 2 * np.kron(X[1], Y[1]) + np.kron(X[0], Y[2])
    load = np.kron(along[0] @ weights * a / 2, across[0] @ weights * b / 2)
    c = np.linalg.solve(matrix, load)
    (p, _, pxx), (q, _, qyy) = values(np.array([2 * x / a - 1]), a), values(np.array([2 * y / b - 1]), b)
    w, wxx, wyy = (float(c @ np.kron(one[:, 0], other[:, 0])) for one, other in ((p, q), (pxx, q), (p, qyy)))
    return w, -wxx - nu * wyy, -wyy - nu * wxx


@dataclass(frozen=True)
class Ring:
    """Annulus of a circular plate: radii, D, shear stiffness S = κ G h, pressure, and line load at its inner radius."""

    inner: float
    outer: float
    stiffness: float
    shear: float
    pressure: float = 0.0
    line_load: float = 0.0


class Rings:
    """Axisymmetric Reissner–Mindlin plate of rings; edges: "free", "simple" or "clamped"; "centre" inside a disc.

    w = C₁r²/4 + C₂ ln r + C₃ + B(r²(ln r − 1)/4D − ln r/S) + q(r⁴/64D − r²/4S), with Q = −(B/r + qr/2);
    Timoshenko and Woinowsky-Krieger (1959), chapter 3, and the shear strain Q/S.
    """

    def __init__(self, rings: Sequence[Ring], nu: float, inner: str, outer: str) -> None:
        self.rings, self.nu, count = tuple(rings), nu, 4 * len(rings)
        rows, right = [], []

        def add(*terms: tuple[int, np.ndarray, float], value: float = 0.0) -> None:
            row = np.zeros(count)
            for place, coefficients, sign in terms:
                row[4 * place : 4 * place + 4] += sign * coefficients[:4]
                value -= sign * coefficients[4]
            rows.append(row)
            right.append(value)

        kinds = {"free": (2, 3), "simple": (0, 2), "clamped": (0, 1)}
        first, last = rings[0], len(rings) - 1
        if inner == "centre":
            add((0, np.array([0, 1.0, 0, 0, 0]), 1.0))
            add((0, np.array([0, 0, 0, 1.0, 0]), 1.0))
        else:
            for kind in kinds[inner]:
                load = first.line_load if kind == 3 else 0.0
                add((0, self._terms(0, first.inner)[kind], 1.0), value=load)
        for place, (one, after) in enumerate(pairwise(rings)):
            before, behind = self._terms(place, one.outer), self._terms(place + 1, one.outer)
            for kind in range(4):
                load = after.line_load if kind == 3 else 0.0
                add((place + 1, behind[kind], 1.0), (place, before[kind], -1.0), value=load)
        for kind in kinds[outer]:
            add((last, self._terms(last, rings[-1].outer)[kind], 1.0))
        self._constants = np.linalg.solve(np.array(rows), np.array(right)).reshape(-1, 4)

    def _terms(self, place: int, r: float) -> tuple[np.ndarray, ...]:
        """Coefficients (5,) of C₁, C₂, C₃, B and 1 in deflection w, slope φ, m_r, shear V and m_t at radius ``r``."""
        ring = self.rings[place]
        D, S, q, log = ring.stiffness, ring.shear, ring.pressure, np.log(r)
        w = [r * r / 4, log, 1, r * r * (log - 1) / 4 / D - log / S, q * (r**4 / 64 / D - r * r / 4 / S)]
        slope = np.array([r / 2, 1 / r, 0, r * (2 * log - 1) / 4 / D, q * r**3 / 16 / D])
        second = np.array([0.5, -1 / r**2, 0, (2 * log + 1) / 4 / D, 3 * q * r**2 / 16 / D])
        radial, tangential = -D * (second + self.nu * slope / r), -D * (slope / r + self.nu * second)
        return np.array(w), slope, radial, np.array([0, 0, 0, 1 / r, q * r / 2]), tangential

    def at(self, r: float) -> tuple[float, float, float]:
        """Return w, m_r and m_t at a radius; at a border of two rings they are the values of the inner ring."""
        place = next(i for i, ring in enumerate(self.rings) if r <= ring.outer)
        terms, known = self._terms(place, max(r, 1e-4 * self.rings[0].outer)), np.append(self._constants[place], 1.0)
        return float(terms[0] @ known), float(terms[2] @ known), float(terms[4] @ known)
