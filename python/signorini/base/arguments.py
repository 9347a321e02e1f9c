"""Arguments of functions in Python, checked as an input file's values are."""

from __future__ import annotations

import inspect
import math
import os
import reprlib
from collections.abc import Callable, Collection, Mapping
from functools import wraps
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from signorini.errors import InputError, UnknownNameError, unknown

_T = TypeVar("_T")
_C = TypeVar("_C", bound=Callable[..., Any])


def checked(called: _C) -> _C:
    """Report missing and unknown arguments of a function, or of each public method of a class, as an InputError.

    Examples
    --------
    >>> @checked
    ... def area(width: float, height: float = 1.0) -> float:
    ...     "Area of a rectangle."
    ...     return width * height
    >>> area(2.0), area.__name__
    (2.0, 'area')
    >>> area(2.0, 3.0, 4.0)
    Traceback (most recent call last):
    signorini.errors.InputError: area: too many positional arguments. Call area(width, height=1.0): Area of a rectangle.
    """
    if inspect.isclass(called):
        for name, method in vars(called).items():
            if name[0] != "_" and inspect.isfunction(method):
                setattr(called, name, checked(method))
        return called

    @wraps(called)
    def call(*given: Any, **named: Any) -> Any:
        try:
            return called(*given, **named)
        except TypeError:
            _require_fitting(called, given, named)
            raise

    return cast(_C, call)


def _require_fitting(called: Callable[..., Any], given: tuple[Any, ...], named: Mapping[str, Any]) -> None:
    """Raise an InputError with the signature if the arguments do not fit it."""
    signature = inspect.signature(called)
    try:
        signature.bind(*given, **named)
    except TypeError as error:
        own = [one.replace(annotation=inspect.Parameter.empty) for one in signature.parameters.values()]
        shown = inspect.Signature([one for one in own if one.name != "self"])
        does = (inspect.getdoc(called) or "").partition("\n\n")[0]
        raise InputError(f"{error}. Call {called.__name__}{shown}: {does}", place=called.__name__) from None


def number(value: object, place: str) -> float:
    """A real number as a float, infinite or NaN too."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        raise InputError(f"found {reprlib.repr(value)}; it must be a number.", place=place)
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def interval(value: object, place: str) -> tuple[float, float]:
    """A lower and an upper limit."""
    result = _array(value)
    if result is None or result.shape != (2,) or not np.isfinite(result).all() or result[0] >= result[1]:
        raise InputError(
            f"found {reprlib.repr(value)}; it must be two finite numbers, the lower one first.", place=place
        )
    return float(result[0]), float(result[1])


def path(value: object, what: str, place: str) -> str:
    """The path of something."""
    if not isinstance(value, str | os.PathLike):
        raise InputError(f"found {reprlib.repr(value)}; it must be the path of {what}.", place=place)
    return os.fspath(value)


def points(value: object, place: str = "points") -> NDArray[np.float64]:
    """Positions (q, 2) of a point, or of any number of them."""
    result = _array(value)
    if result is not None and result.shape in ((0,), (2,)):
        result = result.reshape(-1, 2)
    if result is None or result.ndim != 2 or result.shape[1] != 2:
        raise InputError(
            f"found {reprlib.repr(value)}; it must be a point [x, y] or a sequence of them, all numbers.", place=place
        )
    return result


def vector(value: object, length: int, place: str) -> NDArray[np.float64]:
    """A vector of finite numbers of some length."""
    result = _array(value)
    if result is None or result.shape != (length,):
        what = reprlib.repr(value) if result is None else f"an array of shape {result.shape}"
        raise InputError(f"found {what}; it must be {length} numbers, one a dof.", place=place)
    if not np.isfinite(result).all():
        at = int(np.argmin(np.isfinite(result)))
        raise InputError(f"found {result[at]} at index {at}; all numbers must be finite.", place=place)
    return result


def array(value: object, place: str, dimensions: int) -> NDArray[np.float64]:
    """Numbers in so many dimensions."""
    result = _array(value)
    if result is None or result.ndim != dimensions:
        what = reprlib.repr(value) if result is None else f"an array of shape {result.shape}"
        wanted = f"{dimensions} dimension{'s' if dimensions > 1 else ''}"
        raise InputError(f"found {what}; it must be one of numbers in {wanted}.", place=place)
    return result


def name(value: object, kind: str, place: str) -> str:
    """The name of something."""
    if not isinstance(value, str):
        raise InputError(f"found {reprlib.repr(value)}; it must be the name of a {kind}.", place=place)
    return value


def known(value: object, allowed: Collection[str], kind: str, place: str, owner: str = "This model") -> str:
    """One of some names."""
    result = name(value, kind, place)
    if result not in allowed:
        raise InputError(unknown(kind, result, allowed, owner), place=place)
    return result


def key_of(value: object, allowed: Collection[str], kind: str, owner: str) -> str:
    """One of the names of a mapping; others are refused by an error that is a KeyError too."""
    try:
        return known(value, allowed, kind, kind, owner)
    except InputError as error:
        raise UnknownNameError(error.message, error.place) from None


def index(value: object, count: int, kind: str, place: str) -> int:
    """The number of one of so many things, from 0."""
    if isinstance(value, int | np.integer) and not isinstance(value, bool) and 0 <= value < count:
        return int(value)
    allowed = f"0 to {count - 1}"
    raise InputError(f"found {reprlib.repr(value)}; it must be the number of a {kind}, {allowed}.", place=place)


def watching(value: Callable[[_T], object] | None, place: str) -> Callable[[_T], object]:
    """A function that watches, or of None one that sees nothing."""
    if value is None:
        return lambda now: None
    if not callable(value):
        raise InputError(f"found {reprlib.repr(value)}; it must be a function that takes a Progress.", place=place)
    return value


def made_by(value: object, kind: type, advice: str, place: str) -> None:
    """Refuse what is not of a class; the advice says how to come by one."""
    if not isinstance(value, kind):
        raise InputError(f"found {reprlib.repr(value)}; it must be a {kind.__name__}. {advice}", place=place)


def _array(value: object) -> NDArray[np.float64] | None:
    """Real numbers as an array, or None where there are others."""
    try:
        result = np.asarray(value)
        return None if result.dtype.kind == "c" else np.asarray(result, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return None
