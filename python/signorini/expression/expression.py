"""Class `Expression`: a formula in x and y. Its text is parsed as arithmetic and never executed as Python code."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini.errors import InputError, Place
from signorini.expression.levels import Level, levels
from signorini.expression.tree import check, evaluate, first_point, parse, short

LARGEST = 1e60
"""Largest allowed magnitude of an input number: a product of five such numbers is below 1e308 and does not overflow."""
LEAST = 1e-60
"""Smallest allowed positive input number: a product of five such numbers is above 1e-308 and does not underflow."""

_Array = NDArray[np.float64]


@dataclass(frozen=True)
class Expression:
    """A number, or a formula in x and y written as text.

    The text may use ``+ - * / **``, parentheses, comparisons (1 where true, 0 where false), ``and``, ``or``,
    ``not``, the constants ``pi`` and ``e``, and the functions ``sqrt exp log log10 sin cos tan asin acos atan
    atan2 sinh cosh tanh abs sign floor ceil hypot min max where``. ``where(condition, a, b)`` evaluates ``a``
    only at points where the condition is true, and ``b`` only where it is false.

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
    signorini.errors.InputError: '1 / x' divides by zero at [0, 3].
    """

    source: float | str
    is_constant: bool = field(init=False, repr=False, compare=False)
    _tree: ast.expr = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Parse the text, and evaluate its constant parts once."""
        if isinstance(self.source, str):
            tree = parse(self.source)
        elif isinstance(self.source, Real) and not isinstance(self.source, bool):
            tree = ast.Constant(self.source)
        else:
            raise InputError(f"Found {short(repr(self.source))}; a number or an expression in x and y is needed.")
        object.__setattr__(self, "_tree", tree)
        object.__setattr__(self, "is_constant", check(tree, depth=0))
        if self.is_constant:
            _ = self.value

    @property
    def value(self) -> float:
        """The value of a constant expression; an expression that varies with x and y raises an InputError."""
        if not self.is_constant:
            raise InputError(f"'{self.source}' varies with x and y; a constant is needed here.")
        return float(self(0.0, 0.0))

    @cached_property
    def levels(self) -> tuple[Level, ...]:
        """Functions of x and y that are zero where the expression jumps or has a kink; see module ``levels``."""
        return levels(self._tree)

    def __call__(
        self,
        x: ArrayLike,
        y: ArrayLike,
        *,
        above: float | None = None,
        at_least: float | None = None,
        place: str | Place = "",
    ) -> _Array:
        """Evaluate the expression at points x and y, arrays of one shape.

        ``place`` is the expression's place in the input, for errors. Values that are not finite, not greater than
        ``above`` or less than ``at_least`` are refused; the message names the first such point.
        """
        px, py = np.broadcast_arrays(np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64))
        try:
            with np.errstate(all="ignore"):
                values = np.array(np.broadcast_to(evaluate(self._tree, px, py), px.shape), dtype=np.float64)
        except InputError as error:
            raise InputError(error.message, place=place) from None
        over, least = (-np.inf if bound is None else bound for bound in (above, at_least))
        bounds = (
            (~(np.abs(values) <= LARGEST), f"but must be finite and at most {LARGEST:g} in size"),
            (values <= over, f"but must be greater than {over:g}"),
            (values < least, f"but must be at least {least:g}"),
        )
        for wrong, why in bounds:
            if wrong.any():
                found = values[wrong].flat[0]
                where = "" if self.is_constant else f" at {first_point(wrong, px, py)}"
                raise InputError(f"'{self.source}' is {found:g}{where}, {why}.", place=place)
        return values

    def __str__(self) -> str:
        """Return the text of the expression."""
        return str(self.source)
