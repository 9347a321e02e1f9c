"""Polynomials in x and y of degree two at most, and the lines and circles that they are zero on."""

from __future__ import annotations

import ast
import math
from dataclasses import dataclass

_ZERO = 1e-14
"""Part of the largest coefficient of a degree below which another is rounding."""

_NAMED = {"pi": math.pi, "e": math.e}


@dataclass(frozen=True)
class Polynomial:
    """The sum of c xⁱyʲ, with c for (i, j)."""

    terms: dict[tuple[int, int], float]

    @classmethod
    def constant(cls, value: float) -> Polynomial:
        """Make a constant."""
        return cls({(0, 0): value})

    def __call__(self, x: float, y: float) -> float:
        """Evaluate at a point."""
        return sum(c * x**i * y**j for (i, j), c in self.terms.items())

    def __add__(self, other: Polynomial) -> Polynomial:
        """Add."""
        terms = dict(self.terms)
        for power, c in other.terms.items():
            terms[power] = terms.get(power, 0.0) + c
        return Polynomial(terms)

    def __sub__(self, other: Polynomial) -> Polynomial:
        """Subtract."""
        return self + Polynomial({power: -c for power, c in other.terms.items()})

    def __mul__(self, other: Polynomial) -> Polynomial | None:
        """Multiply; None if the degree exceeds two."""
        terms: dict[tuple[int, int], float] = {}
        for (i, j), c in self.terms.items():
            for (k, m), d in other.terms.items():
                if c * d != 0.0:
                    terms[i + k, j + m] = terms.get((i + k, j + m), 0.0) + c * d
        if any(i + j > 2 for i, j in terms):
            return None
        return Polynomial(terms)

    def _of(self, i: int, j: int) -> float:
        """Coefficient, without what is rounding beside others of its degree."""
        c = self.terms.get((i, j), 0.0)
        largest = max((abs(d) for (k, m), d in self.terms.items() if k + m == i + j), default=0.0)
        return c if abs(c) > _ZERO * largest else 0.0

    @property
    def is_constant(self) -> bool:
        """Whether it depends on neither x nor y."""
        return not any(self._of(i, j) for i, j in self.terms if i + j > 0)

    @property
    def is_linear(self) -> bool:
        """Whether it has no term of degree two."""
        return not any(self._of(i, j) for i, j in self.terms if i + j > 1)

    def zeros(self) -> tuple[tuple[float, ...], tuple[float, ...], tuple[tuple[float, float, float], ...]]:
        """Lines x = c, lines y = c and circles (x, y, radius) on which it is zero; none if that is another curve.

        Examples
        --------
        >>> Polynomial({(2, 0): 1.0, (0, 0): -4.0}).zeros()
        ((-2.0, 2.0), (), ())
        >>> Polynomial({(2, 0): 1.0, (0, 2): 1.0, (1, 0): -2.0, (0, 0): -8.0}).zeros()
        ((), (), ((1.0, -0.0, 3.0),))
        """
        xx, xy, yy = self._of(2, 0), self._of(1, 1), self._of(0, 2)
        x, y, one = self._of(1, 0), self._of(0, 1), self._of(0, 0)
        if not (xy or yy or y):
            return _roots(xx, x, one), (), ()
        if not (xy or xx or x):
            return (), _roots(yy, y, one), ()
        if xy or not xx or abs(xx - yy) > _ZERO * abs(xx):
            return (), (), ()
        center = (-0.5 * x / xx, -0.5 * y / xx)
        square = center[0] ** 2 + center[1] ** 2 - one / xx
        return (), (), ((*center, math.sqrt(square)),) if square > 0.0 else ()


def _roots(square: float, linear: float, one: float) -> tuple[float, ...]:
    if not square:
        return (-one / linear,) if linear else ()
    half = -0.5 * linear / square
    spread = half * half - one / square
    return (half - math.sqrt(spread), half + math.sqrt(spread)) if spread > 0.0 else ()


def polynomial(node: ast.expr) -> Polynomial | None:
    """The polynomial that a checked syntax tree is, if it is one of degree two at most.

    Examples
    --------
    >>> polynomial(ast.parse("2*(x - 3)", mode="eval").body)
    Polynomial(terms={(1, 0): 2.0, (0, 0): -6.0})
    """
    match node:
        case ast.Constant():
            return Polynomial.constant(float(node.value))  # type: ignore[arg-type]
        case ast.Name(id="x"):
            return Polynomial({(1, 0): 1.0})
        case ast.Name(id="y"):
            return Polynomial({(0, 1): 1.0})
        case ast.Name(id=name) if name in _NAMED:
            return Polynomial.constant(_NAMED[name])
        case ast.UnaryOp(op=ast.UAdd() | ast.USub() as op, operand=inner):
            value = polynomial(inner)
            return value if value is None or isinstance(op, ast.UAdd) else Polynomial({}) - value
        case ast.BinOp(left=left, op=op, right=right):
            a, b = polynomial(left), polynomial(right)
            return None if a is None or b is None else _joined(a, op, b)
    return None


def _joined(a: Polynomial, op: ast.operator, b: Polynomial) -> Polynomial | None:
    value = b(0.0, 0.0)
    match op:
        case ast.Add():
            return a + b
        case ast.Sub():
            return a - b
        case ast.Mult():
            return a * b
        case ast.Div() if b.is_constant and value != 0.0:
            return a * Polynomial.constant(1.0 / value)
        case ast.Pow() if b.is_constant and value in (1.0, 2.0):
            return a if value == 1.0 else a * a
        case ast.Pow() if b.is_constant and a.is_constant and a(0.0, 0.0) > 0.0:
            try:
                return Polynomial.constant(a(0.0, 0.0) ** value)
            except OverflowError:
                return None
    return None
