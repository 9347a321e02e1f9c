"""Discontinuities and kinks of an expression, as zeros of level functions taken from its syntax tree.

A comparison jumps where its two sides are equal, ``floor`` and ``ceil`` where their argument is an integer, ``sign``
where its argument is zero. ``abs`` has a kink where its argument is zero, ``min`` and ``max`` where two arguments are
equal. Lines from a branch of ``where`` that is not chosen are harmless. Straight lines and circles among the zeros are
found from polynomials of degree at most two.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import combinations, pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from signorini.expression.tree import evaluate, operands

_ZERO = 1e-14
"""Coefficients of a polynomial below this fraction of the largest coefficient of the same degree count as zero."""

_NAMED = {"pi": math.pi, "e": math.e}


_MAX_LINES = 200
"""Steps of ``floor`` or ``ceil`` give no mesh lines if the argument takes this many integer values on the plate."""
Box = tuple[float, float, float, float]


Polynomial: TypeAlias = NDArray[np.float64]
"""Coefficients (3, 3) of a polynomial of degree two: entry [i, j] belongs to xⁱyʲ, i + j ≤ 2."""
_DEGREE = np.add.outer(np.arange(3), np.arange(3))


def _constant(value: float) -> Polynomial:
    return np.where(_DEGREE == 0, float(value), 0.0)


def _times(a: Polynomial, b: Polynomial) -> Polynomial | None:
    """Product of two polynomials of degree at most two; None if the degree of the product exceeds two."""
    full = np.zeros((5, 5))
    for i, j in np.argwhere(a):
        full[i : i + 3, j : j + 3] += a[i, j] * b
    product = np.where(_DEGREE <= 2, full[:3, :3], 0.0)
    return product if np.count_nonzero(product) == np.count_nonzero(full) else None


def _cleaned(a: Polynomial) -> Polynomial:
    """Set coefficients to zero that are rounding errors relative to the largest coefficient of their degree."""
    largest = [np.abs(a[degree == _DEGREE]).max() for degree in range(5)]
    return np.where(np.abs(a) > _ZERO * np.array(largest)[_DEGREE], a, 0.0)


def _is_constant(a: Polynomial) -> bool:
    return not _cleaned(a)[_DEGREE > 0].any()


def _zeros(a: Polynomial) -> Drawing:
    """Lines x = c, lines y = c and circles on which a polynomial is zero; empty if its zeros are other curves."""
    (constant, y, yy), (x, xy, _), (xx, _, _) = _cleaned(a).tolist()
    if not (xy or yy or y):
        return Drawing(x_lines=_roots(xx, x, constant))
    if not (xy or xx or x):
        return Drawing(y_lines=_roots(yy, y, constant))
    if xy or not xx or abs(xx - yy) > _ZERO * abs(xx):
        return Drawing()
    center = (-0.5 * x / xx, -0.5 * y / xx)
    square = center[0] ** 2 + center[1] ** 2 - constant / xx
    return Drawing(circles=((*center, math.sqrt(square)),) if square > 0.0 else ())


def _roots(square: float, linear: float, constant: float) -> tuple[float, ...]:
    if not square:
        return (-constant / linear,) if linear else ()
    half = -0.5 * linear / square
    spread = half * half - constant / square
    return (half - math.sqrt(spread), half + math.sqrt(spread)) if spread > 0.0 else ()


def polynomial(node: ast.expr) -> Polynomial | None:
    """Convert a checked syntax tree to a polynomial in x and y; None if it is no polynomial of degree at most two."""
    match node:
        case ast.Constant():
            return _constant(float(node.value))  # type: ignore[arg-type]
        case ast.Name(id="x"):
            return np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        case ast.Name(id="y"):
            return np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        case ast.Name(id=name) if name in _NAMED:
            return _constant(_NAMED[name])
        case ast.UnaryOp(op=ast.UAdd() | ast.USub() as op, operand=inner):
            value = polynomial(inner)
            return value if value is None or isinstance(op, ast.UAdd) else -value
        case ast.BinOp(left=left, op=op, right=right):
            a, b = polynomial(left), polynomial(right)
            return None if a is None or b is None else _joined(a, op, b)
    return None


def _joined(a: Polynomial, op: ast.operator, b: Polynomial) -> Polynomial | None:
    base, value = float(a[0, 0]), float(b[0, 0])
    match op:
        case ast.Add():
            return a + b
        case ast.Sub():
            return a - b
        case ast.Mult():
            return _times(a, b)
        case ast.Div() if _is_constant(b) and value != 0.0:
            return _times(a, _constant(1.0 / value))
        case ast.Pow() if _is_constant(b) and value in (1.0, 2.0):
            return a if value == 1.0 else _times(a, a)
        case ast.Pow() if _is_constant(b) and _is_constant(a) and base > 0.0:
            try:
                return _constant(base**value)
            except OverflowError:
                return None
    return None


@dataclass(frozen=True)
class Drawing:
    """Lines x = c, lines y = c and circles (x, y, radius) at which an expression jumps."""

    x_lines: tuple[float, ...] = ()
    y_lines: tuple[float, ...] = ()
    circles: tuple[tuple[float, float, float], ...] = ()

    def radii(self, center: tuple[float, float]) -> tuple[float, ...]:
        """Radii of the circles with the given center."""
        return tuple(r for x, y, r in self.circles if math.dist(center, (x, y)) <= 1e-9 * r)

    def __add__(self, other: Drawing) -> Drawing:
        """Return the lines and circles at which either of two expressions jumps."""
        return Drawing(self.x_lines + other.x_lines, self.y_lines + other.y_lines, self.circles + other.circles)


@dataclass(frozen=True)
class Level:
    """A level function of x and y: where it is zero, an expression jumps or, if ``jumps`` is False, has a kink."""

    jumps: bool
    _tree: ast.expr = field(repr=False)
    _curves: tuple[Polynomial, ...] = field(repr=False)
    """Polynomials that are zero where the level function is, if known; of ``floor`` and ``ceil`` their argument."""
    _whole: bool = field(repr=False)

    def __call__(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values (q,) of the level function at points (q, 2); NaN where the function is undefined."""
        x, y = np.ascontiguousarray(points.T)
        with np.errstate(all="ignore"):
            return np.array(np.broadcast_to(evaluate(self._tree, x, y, strict=False), x.shape), dtype=np.float64)

    def drawing(self, box: Box) -> Drawing:
        """Lines x = c, lines y = c and circles in a box (xmin, ymin, xmax, ymax) at which the expression jumps."""
        drawing = Drawing()
        with np.errstate(all="ignore"):
            for curve in self._curves if self.jumps else ():
                for shifted in _steps(curve, box) if self._whole else (curve,):
                    drawing += _zeros(shifted)
        x0, y0, x1, y1 = box
        x_lines = tuple(x for x in drawing.x_lines if x0 <= x <= x1)
        return Drawing(x_lines, tuple(y for y in drawing.y_lines if y0 <= y <= y1), drawing.circles)


def _steps(inner: Polynomial, box: Box) -> Iterator[Polynomial]:
    """Yield, for each integer that the linear function ``inner`` takes in the box, ``inner`` minus this integer."""
    ends = [float(np.polynomial.polynomial.polyval2d(x, y, inner)) for x in box[::2] for y in box[1::2]]
    if not _cleaned(inner)[_DEGREE > 1].any() and max(ends) - min(ends) < _MAX_LINES:
        for whole in range(math.ceil(min(ends)), math.floor(max(ends)) + 1):
            yield inner - _constant(whole)


def levels(tree: ast.expr) -> tuple[Level, ...]:
    """The distinct level functions of a checked syntax tree; jumps of the expression come before kinks."""
    found: dict[str, Level] = {}
    with np.errstate(all="ignore"):
        for level in _levels(tree):
            key = ast.dump(level._tree)
            if key not in found or level.jumps:
                found[key] = level
    return tuple(sorted(found.values(), key=lambda level: not level.jumps))


def _levels(node: ast.expr) -> Iterator[Level]:
    match node:
        case ast.Compare():
            for left, right in pairwise(operands(node)):
                yield from _level(_difference(left, right), True, _equal(left, right))
        case ast.Call(func=ast.Name(id="floor" | "ceil"), args=[inner]):
            wave = ast.Call(ast.Name("sin"), [ast.BinOp(ast.Name("pi"), ast.Mult(), inner)], [])
            curve = polynomial(inner)
            # The level function asin(sin(πu)) of the argument u is linear near its zeros, so straight steps are exact.
            yield from _level(
                ast.Call(ast.Name("asin"), [wave], []), True, [] if curve is None else [curve], whole=True
            )
        case ast.Call(func=ast.Name(id="sign"), args=[inner]):
            yield from _level(inner, True, _equal(inner, ast.Constant(0)))
        case ast.Call(func=ast.Name(id="abs"), args=[inner]):
            yield from _level(inner, False)
        case ast.Call(func=ast.Name(id="atan2"), args=[inner, _]):
            yield from _level(inner, True)
        case ast.Call(func=ast.Name(id="min" | "max"), args=values):
            for left, right in combinations(values, 2):
                yield from _level(_difference(left, right), False)
    for operand in operands(node):
        yield from _levels(operand)


def _level(tree: ast.expr, jumps: bool, curves: list[Polynomial] | None = None, whole: bool = False) -> Iterator[Level]:
    if any(isinstance(part, ast.Name) and part.id in ("x", "y") for part in ast.walk(tree)):
        yield Level(jumps, tree, tuple(curves or ()), whole)


def _difference(left: ast.expr, right: ast.expr) -> ast.expr:
    return ast.BinOp(left, ast.Sub(), right)


def _equal(left: ast.expr, right: ast.expr) -> list[Polynomial]:
    """Polynomials whose zeros include all points where two syntax trees have equal values; empty if unknown."""
    for side, other in ((left, right), (right, left)):
        match side:
            case ast.Call(func=ast.Name(id="min" | "max"), args=values):
                return [curve for value in values for curve in _equal(value, other)]
            case ast.BinOp(op=ast.Mult(), left=a, right=b) if _is_zero(other):
                return _equal(a, other) + _equal(b, other)
        bound = polynomial(other)
        if bound is None or not _is_constant(bound):
            continue
        match side:
            case ast.Call(func=ast.Name(id="abs"), args=[inner]):
                value = polynomial(inner)
                return [] if value is None else [value - bound, value + bound]
            case (
                ast.Call(func=ast.Name(id="sqrt"), args=[inner])
                | ast.BinOp(left=inner, op=ast.Pow(), right=ast.Constant(value=0.5))
            ):
                value, square = polynomial(inner), _times(bound, bound)
                return [] if value is None or square is None else [value - square]
            case ast.Call(func=ast.Name(id="hypot"), args=[a, b]):
                p, q = polynomial(a), polynomial(b)
                squares = [None if v is None else _times(v, v) for v in (p, q, bound)]
                return [] if any(v is None for v in squares) else [squares[0] + squares[1] - squares[2]]  # type: ignore[operator]
    first, second = polynomial(left), polynomial(right)
    return [] if first is None or second is None else [first - second]


def _is_zero(node: ast.expr) -> bool:
    value = polynomial(node)
    return value is not None and _is_constant(value) and value[0, 0] == 0.0
