"""Numbers that may vary over the plate: an expression in x and y, parsed and never executed."""

from __future__ import annotations

import ast
import operator
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import reduce
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini.errors import InputError, unknown

LARGEST = 1e60
"""Magnitudes above this are refused: products of a few of them would overflow."""

_MAX_LENGTH = 2000
_MAX_DEPTH = 80
_CHARACTERS = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_+-*/().,<>=! ")

_Array = NDArray[np.float64]

_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: np.logical_not,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.And: np.logical_and,
    ast.Or: np.logical_or,
}

# name -> (function of arrays, fewest arguments, most arguments)
_FUNCTIONS: dict[str, tuple[Callable[..., Any], int, int]] = {
    **{name: (getattr(np, name), 1, 1) for name in ("sqrt", "exp", "log", "log10", "sin", "cos", "tan")},
    **{name: (getattr(np, name), 1, 1) for name in ("sinh", "cosh", "tanh", "abs", "sign", "floor", "ceil")},
    **{name: (getattr(np, "arc" + name[1:]), 1, 1) for name in ("asin", "acos", "atan")},
    "atan2": (np.arctan2, 2, 2),
    "hypot": (np.hypot, 2, 2),
    "min": (lambda *values: reduce(np.minimum, values), 2, 20),
    "max": (lambda *values: reduce(np.maximum, values), 2, 20),
    "where": (np.where, 3, 3),
}

_CONSTANTS = {"pi": np.pi, "e": np.e}
_NAMES = [*_FUNCTIONS, *_CONSTANTS, "x", "y"]


@dataclass(frozen=True)
class Expression:
    """A number, or a formula in x and y written as text.

    The text may use ``+ - * / **``, parentheses, comparisons (1 where true, 0 where false), ``and``, ``or``,
    ``not``, the constants ``pi`` and ``e``, and the functions ``sqrt exp log log10 sin cos tan asin acos atan
    atan2 sinh cosh tanh abs sign floor ceil hypot min max where``. ``where(condition, a, b)`` evaluates ``a``
    and ``b`` only at the points where each is chosen.

    Parameters
    ----------
    source : float or str
        The number or the text.

    Raises
    ------
    InputError
        If the text is not such a formula, or a constant part of it is not a finite number.

    Examples
    --------
    >>> pressure = Expression("5*(y - 2)**2")
    >>> pressure([0.0, 1.0], [0.0, 2.0])
    array([20.,  0.])
    >>> Expression(0.3).value
    0.3
    >>> Expression("1/x")([0.0], [3.0])
    Traceback (most recent call last):
        ...
    signorini.errors.InputError: '1 / x' divides by zero at x = 0, y = 3.
    """

    source: float | str
    is_constant: bool = field(init=False, repr=False, compare=False)
    _tree: ast.expr = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Parse the source, and evaluate its constant parts once."""
        if isinstance(self.source, str):
            tree = _parse(self.source)
        elif isinstance(self.source, Real) and not isinstance(self.source, bool):
            tree = ast.Constant(self.source)
        else:
            raise InputError(f"Found {_short(repr(self.source))}; a number or an expression in x and y is needed.")
        object.__setattr__(self, "_tree", tree)
        object.__setattr__(self, "is_constant", _check(tree, depth=0))
        if self.is_constant:
            _ = self.value

    @property
    def value(self) -> float:
        """The number, when the expression does not depend on x and y.

        Raises
        ------
        InputError
            If it does.
        """
        if not self.is_constant:
            raise InputError(f"'{self.source}' varies with x and y; a constant is needed here.")
        return float(self(0.0, 0.0))

    def __call__(
        self, x: ArrayLike, y: ArrayLike, *, above: float | None = None, at_least: float | None = None, place: str = ""
    ) -> _Array:
        """Evaluate at points.

        Parameters
        ----------
        x, y : array_like
            Coordinates, of one shape.
        above, at_least : float, optional
            Bounds that every value must keep: greater than ``above``, not less than ``at_least``.
        place : str
            Where the expression was given, for the message of an error.

        Returns
        -------
        ndarray of float64, the shape of x

        Raises
        ------
        InputError
            If a value is not a finite number or breaks a bound; the message names the first such point.
        """
        px, py = np.broadcast_arrays(np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64))
        try:
            with np.errstate(all="ignore"):
                values = np.array(np.broadcast_to(_evaluate(self._tree, px, py), px.shape), dtype=np.float64)
        except InputError as error:
            raise InputError(error.message, place=place) from None
        bounds = (
            (~(np.abs(values) <= LARGEST), f"but must be finite and at most {LARGEST:g} in size"),
            (values <= (-np.inf if above is None else above), f"but must be greater than {above}"),
            (values < (-np.inf if at_least is None else at_least), f"but must be at least {at_least}"),
        )
        for wrong, why in bounds:
            if wrong.any():
                found = values[wrong].flat[0]
                where = "" if self.is_constant else f" at {_first_point(wrong, px, py)}"
                raise InputError(f"'{self.source}' is {found:g}{where}, {why}.", place=place)
        return values

    def __str__(self) -> str:
        """Give the source back."""
        return str(self.source)


def _parse(source: str) -> ast.expr:
    """Read the text into a syntax tree that holds nothing but arithmetic (see `_check`)."""
    text = " ".join(source.split())
    if not text:
        raise InputError("The expression is empty.")
    if len(text) > _MAX_LENGTH:
        raise InputError(f"The expression has {len(text)} characters; at most {_MAX_LENGTH} are allowed.")
    if "^" in text:
        raise InputError(f"'{_short(text)}' uses '^'; write '**' for a power.")
    strange = next((character for character in text if character not in _CHARACTERS), None)
    if strange is not None:
        raise InputError(f"'{_short(text)}' has the character {strange!r}, which no expression in x and y uses.")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text, mode="eval").body
    except SyntaxError as error:
        column = f" near character {error.offset}" if error.offset else ""
        raise InputError(f"'{_short(text)}' is not an expression in x and y: it cannot be read{column}.") from None
    except (ValueError, MemoryError, RecursionError):
        raise InputError(f"'{_short(text)}' is nested too deeply; write it more simply.") from None


def _check(node: ast.expr, depth: int) -> bool:
    """Refuse all but arithmetic; return whether the node is constant, after trying its value if so."""
    if depth > _MAX_DEPTH:
        raise InputError("The expression is nested too deeply; write it more simply.")
    match node:
        case ast.Constant() if isinstance(node.value, Real) and not isinstance(node.value, bool):
            try:
                float(node.value)
            except OverflowError:
                raise InputError("The expression has a number too large to calculate with.") from None
        case ast.Name(id=name):
            if name in _FUNCTIONS:
                raise InputError(f"'{name}' is a function: write its argument in parentheses, as in {name}(x).")
            if name not in _NAMES:
                raise InputError(unknown("name", _short(name), _NAMES, "An expression"))
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
            if name not in _FUNCTIONS:
                raise InputError(unknown("function", _short(name), _FUNCTIONS, "An expression"))
            _, fewest, most = _FUNCTIONS[name]
            if not fewest <= len(arguments) <= most:
                takes = str(fewest) if fewest == most else f"{fewest} to {most}"
                raise InputError(f"{name} takes {takes} argument(s), not {len(arguments)}.")
        case ast.BinOp(op=op) | ast.UnaryOp(op=op) if type(op) in _OPERATORS:
            pass
        case ast.Compare(ops=ops) if all(type(op) in _OPERATORS for op in ops):
            pass
        case ast.BoolOp():
            pass
        case ast.Tuple():
            raise InputError("The expression has a comma outside a function; the decimal sign is a point, as in 0.3.")
        case _:
            raise InputError(f"'{_short(ast.unparse(node))}' is not arithmetic in x and y.")
    parts = [_check(part, depth + 1) for part in _operands(node)]
    constant = all(parts) and not (isinstance(node, ast.Name) and node.id in ("x", "y"))
    if constant:
        with np.errstate(all="ignore"):
            _evaluate(node, np.zeros(()), np.zeros(()))
    return constant


def _operands(node: ast.expr) -> list[ast.expr]:
    match node:
        case ast.Call():
            return node.args
        case ast.BinOp():
            return [node.left, node.right]
        case ast.UnaryOp():
            return [node.operand]
        case ast.Compare():
            return [node.left, *node.comparators]
        case ast.BoolOp():
            return node.values
        case _:
            return []


def _evaluate(node: ast.expr, x: _Array, y: _Array) -> Any:
    """Value of a checked node: an array of x's shape, or a scalar where nothing varies."""
    match node:
        case ast.Constant():
            return np.float64(node.value)  # type: ignore[arg-type]
        case ast.Name(id=name):
            return {"x": x, "y": y, **_CONSTANTS}[name]
        case ast.BoolOp(op=op, values=values):
            result = np.array(np.broadcast_to(_evaluate(values[0], x, y), x.shape)) != 0
            for operand in values[1:]:
                open_ = result if isinstance(op, ast.And) else np.logical_not(result)
                result = _OPERATORS[type(op)](result, _evaluate_where(open_, operand, x, y) != 0)
            return result.astype(np.float64)
        case ast.Call(func=ast.Name(id="where"), args=[condition, yes, no]):
            chosen = np.array(np.broadcast_to(_evaluate(condition, x, y), x.shape)) != 0
            return _evaluate_where(chosen, yes, x, y) + _evaluate_where(np.logical_not(chosen), no, x, y)
    values = [_evaluate(operand, x, y) for operand in _operands(node)]
    match node:
        case ast.Call(func=ast.Name(id=name)):
            result = _FUNCTIONS[name][0](*values)
        case ast.BinOp() | ast.UnaryOp():
            result = _OPERATORS[type(node.op)](*values)
        case ast.Compare(ops=ops):
            pairs = zip(ops, values[:-1], values[1:], strict=True)
            result = reduce(np.logical_and, [_OPERATORS[type(op)](left, right) for op, left, right in pairs])
    result = np.asarray(result, dtype=np.float64)
    wrong = ~np.isfinite(result)
    if wrong.any():
        raise InputError(_not_finite(node, values, np.broadcast_to(wrong, x.shape), x, y))
    return result


def _evaluate_where(mask: NDArray[np.bool_], node: ast.expr, x: _Array, y: _Array) -> _Array:
    """Evaluate at the points of the mask only; zero elsewhere."""
    values = np.zeros(x.shape)
    if mask.any():
        values[mask] = _evaluate(node, x[mask], y[mask])
    return values


def _not_finite(node: ast.expr, values: list[Any], wrong: NDArray[np.bool_], x: _Array, y: _Array) -> str:
    division = isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div)
    zero = division and np.any((np.broadcast_to(values[-1], x.shape) == 0) & wrong)
    says = "divides by zero" if zero else "is not a finite number"
    varies = any(isinstance(part, ast.Name) and part.id in ("x", "y") for part in ast.walk(node))
    where = f" at {_first_point(wrong, x, y)}" if varies else ""
    return f"'{_short(ast.unparse(node))}' {says}{where}."


def _first_point(mask: NDArray[np.bool_], x: _Array, y: _Array) -> str:
    return f"x = {x[mask].flat[0]:g}, y = {y[mask].flat[0]:g}"


def _short(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."
