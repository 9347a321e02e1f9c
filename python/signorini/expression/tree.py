"""Syntax trees of expressions in x and y: parse, check and evaluate."""

from __future__ import annotations

import ast
import operator
import warnings
from collections.abc import Callable
from functools import reduce
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from signorini.errors import InputError, point, unknown

_MAX_LENGTH = 2000
"""Largest number of characters of an expression."""
_MAX_DEPTH = 80
"""Largest depth of a syntax tree; recursion over the tree then stays below the recursion limit of Python."""
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

# For each function name of an expression: the NumPy function, its smallest and its largest number of arguments.
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


def parse(source: str) -> ast.expr:
    """Parse the text of an expression into a syntax tree; `check` must then refuse a tree that is not arithmetic."""
    text = " ".join(source.split())
    if not text:
        raise InputError("The expression is empty.")
    if len(text) > _MAX_LENGTH:
        raise InputError(f"The expression has {len(text)} characters; at most {_MAX_LENGTH} are allowed.")
    if "^" in text:
        raise InputError(f"'{short(text)}' uses '^'; write '**' for a power.")
    strange = next((character for character in text if character not in _CHARACTERS), None)
    if strange is not None:
        raise InputError(f"'{short(text)}' has the character {strange!r}, which is not allowed in an expression.")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text, mode="eval").body
    except SyntaxError as error:
        column = f" near character {error.offset}" if error.offset else ""
        raise InputError(f"'{short(text)}' is not an expression in x and y: it cannot be read{column}.") from None
    except (ValueError, MemoryError, RecursionError):
        raise InputError(f"'{short(text)}' is nested too deeply; write it more simply.") from None


def check(node: ast.expr, depth: int) -> bool:
    """Refuse a node that is not arithmetic; return whether the node is constant. Constant nodes are evaluated."""
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
                raise InputError(unknown("name", short(name), _NAMES, "An expression"))
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
            if name not in _FUNCTIONS:
                raise InputError(unknown("function", short(name), _FUNCTIONS, "An expression"))
            _, least, most = _FUNCTIONS[name]
            if not least <= len(arguments) <= most:
                allowed = str(least) if least == most else f"{least} to {most}"
                raise InputError(f"{name} takes {allowed} argument(s), not {len(arguments)}.")
        case ast.BinOp(op=op) | ast.UnaryOp(op=op) if type(op) in _OPERATORS:
            pass
        case ast.Compare(ops=ops) if all(type(op) in _OPERATORS for op in ops):
            pass
        case ast.BoolOp():
            pass
        case ast.Tuple():
            raise InputError("The expression has a comma outside a function; the decimal sign is a point, as in 0.3.")
        case _:
            raise InputError(f"'{short(ast.unparse(node))}' is not arithmetic in x and y.")
    parts = [check(part, depth + 1) for part in operands(node)]
    constant = all(parts) and not (isinstance(node, ast.Name) and node.id in ("x", "y"))
    if constant:
        with np.errstate(all="ignore"):
            evaluate(node, np.zeros(()), np.zeros(()))
    return constant


def operands(node: ast.expr) -> list[ast.expr]:
    """Return the operands of an operator node, or the arguments of a call node."""
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


def evaluate(node: ast.expr, x: _Array, y: _Array, strict: bool = True) -> Any:
    """Value of a checked syntax tree node at points x and y: an array, or a scalar if the node is constant.

    If ``strict`` is True, NaN and infinite values raise an InputError.
    """
    match node:
        case ast.Constant():
            return np.float64(node.value)  # type: ignore[arg-type]
        case ast.Name(id=name):
            return {"x": x, "y": y, **_CONSTANTS}[name]
        case ast.BoolOp(op=op, values=values):
            result = np.array(np.broadcast_to(evaluate(values[0], x, y), x.shape)) != 0
            for operand in values[1:]:
                open_ = result if isinstance(op, ast.And) else np.logical_not(result)
                result = _OPERATORS[type(op)](result, _evaluate_where(open_, operand, x, y, strict) != 0)
            return result.astype(np.float64)
        case ast.Call(func=ast.Name(id="where"), args=[condition, yes, no]):
            chosen = np.array(np.broadcast_to(evaluate(condition, x, y, strict), x.shape)) != 0
            parts = ((chosen, yes), (np.logical_not(chosen), no))
            return sum(_evaluate_where(mask, branch, x, y, strict) for mask, branch in parts)
    values = [evaluate(operand, x, y, strict) for operand in operands(node)]
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
    if strict and wrong.any():
        raise InputError(_not_finite(node, values, np.broadcast_to(wrong, x.shape), x, y))
    return result


def _evaluate_where(mask: NDArray[np.bool_], node: ast.expr, x: _Array, y: _Array, strict: bool) -> _Array:
    """Evaluate a syntax tree node only at the points that the mask marks; the result is zero at other points."""
    values = np.zeros(x.shape)
    if mask.any():
        values[mask] = evaluate(node, x[mask], y[mask], strict)
    return values


def _not_finite(node: ast.expr, values: list[Any], wrong: NDArray[np.bool_], x: _Array, y: _Array) -> str:
    division = isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div)
    zero = division and np.any((np.broadcast_to(values[-1], x.shape) == 0) & wrong)
    problem = "divides by zero" if zero else "is not a finite number"
    varies = any(isinstance(part, ast.Name) and part.id in ("x", "y") for part in ast.walk(node))
    where = f" at {first_point(wrong, x, y)}" if varies else ""
    return f"'{short(ast.unparse(node))}' {problem}{where}."


def first_point(mask: NDArray[np.bool_], x: _Array, y: _Array) -> str:
    """Text "[x, y]" of the first point that the mask marks."""
    return point((x[mask].flat[0], y[mask].flat[0]))


def short(text: str) -> str:
    """Shorten a text of more than 60 characters to its first 57 characters and "...", for a message."""
    return text if len(text) <= 60 else text[:57] + "..."
