"""Validate arguments of the Python functions; errors have the same form as errors in an input file."""

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


def checked(function: _C) -> _C:
    """Decorate a function or class so that missing or unknown arguments raise an InputError with its signature.

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
    if inspect.isclass(function):
        for name, method in vars(function).items():
            if name[0] != "_" and inspect.isfunction(method):
                setattr(function, name, checked(method))
        return function

    @wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        try:
            return function(*args, **kwargs)
        except TypeError:
            _require_signature(function, args, kwargs)
            raise

    return cast(_C, call)


def _require_signature(function: Callable[..., Any], args: tuple[Any, ...], kwargs: Mapping[str, Any]) -> None:
    """Raise an InputError with the signature of ``function`` if the arguments do not match it."""
    signature = inspect.signature(function)
    try:
        signature.bind(*args, **kwargs)
    except TypeError as error:
        parameters = [each.replace(annotation=inspect.Parameter.empty) for each in signature.parameters.values()]
        shown = inspect.Signature([parameter for parameter in parameters if parameter.name != "self"])
        summary = (inspect.getdoc(function) or "").partition("\n\n")[0]
        raise InputError(f"{error}. Call {function.__name__}{shown}: {summary}", place=function.__name__) from None


def number(value: object, place: str) -> float:
    """Validate a real number and return it; infinity and NaN are allowed."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        raise InputError(f"found {reprlib.repr(value)}; it must be a number.", place=place)
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def interval(value: object, place: str) -> tuple[float, float]:
    """Validate and return two finite limits (lower, upper) with lower < upper."""
    limits = _array(value)
    if limits is None or limits.shape != (2,) or not np.isfinite(limits).all() or limits[0] >= limits[1]:
        raise InputError(
            f"found {reprlib.repr(value)}; it must be two finite numbers, the lower one first.", place=place
        )
    return float(limits[0]), float(limits[1])


def path(value: object, what: str, place: str) -> str:
    """Validate and return the path of a file; an error message calls the file ``what``, such as "an input file"."""
    if not isinstance(value, str | os.PathLike):
        raise InputError(f"found {reprlib.repr(value)}; it must be the path of {what}.", place=place)
    return os.fspath(value)


def points(value: object, place: str = "points") -> NDArray[np.float64]:
    """Validate a point [x, y] or a sequence of points; return their positions (q, 2)."""
    positions = _array(value)
    if positions is not None and positions.shape in ((0,), (2,)):
        positions = positions.reshape(-1, 2)
    if positions is None or positions.ndim != 2 or positions.shape[1] != 2:
        raise InputError(
            f"found {reprlib.repr(value)}; it must be a point [x, y] or a sequence of points.", place=place
        )
    return positions


def vector(value: object, length: int, place: str) -> NDArray[np.float64]:
    """Validate and return a vector of ``length`` finite numbers."""
    entries = _array(value)
    if entries is None or entries.shape != (length,):
        found = reprlib.repr(value) if entries is None else f"an array of shape {entries.shape}"
        raise InputError(f"found {found}; it must be {length} numbers, one per dof.", place=place)
    if not np.isfinite(entries).all():
        i = int(np.argmin(np.isfinite(entries)))
        raise InputError(f"found {entries[i]} at index {i}; all numbers must be finite.", place=place)
    return entries


def array(value: object, place: str, dimensions: int) -> NDArray[np.float64]:
    """Validate and return an array of numbers with ``dimensions`` dimensions."""
    entries = _array(value)
    if entries is None or entries.ndim != dimensions:
        found = reprlib.repr(value) if entries is None else f"an array of shape {entries.shape}"
        allowed = f"{dimensions} dimension{'s' if dimensions > 1 else ''}"
        raise InputError(f"found {found}; it must be an array of numbers with {allowed}.", place=place)
    return entries


def name(value: object, kind: str, place: str) -> str:
    """Validate that a name is text; ``kind`` is the word for the named object in an error message, such as "edge"."""
    if not isinstance(value, str):
        raise InputError(f"found {reprlib.repr(value)}; it must be the name of a {kind}.", place=place)
    return value


def known(value: object, allowed: Collection[str], kind: str, place: str, owner: str = "This model") -> str:
    """Validate that a name is in ``allowed``; error messages use the words ``kind`` ("edge") and ``owner``."""
    text = name(value, kind, place)
    if text not in allowed:
        raise InputError(unknown(kind, text, allowed, owner), place=place)
    return text


def key_of(value: object, allowed: Collection[str], kind: str, owner: str) -> str:
    """Validate a key of a mapping with the keys ``allowed``; an unknown key raises an error that is also a KeyError."""
    try:
        return known(value, allowed, kind, kind, owner)
    except InputError as error:
        raise UnknownNameError(error.message, error.place) from None


def index(value: object, count: int, kind: str, place: str) -> int:
    """Validate and return an index from 0 to ``count`` - 1."""
    if isinstance(value, int | np.integer) and not isinstance(value, bool) and 0 <= value < count:
        return int(value)
    allowed = f"0 to {count - 1}"
    raise InputError(f"found {reprlib.repr(value)}; it must be the number of a {kind}, {allowed}.", place=place)


def watching(value: Callable[[_T], object] | None, place: str) -> Callable[[_T], object]:
    """Validate and return a progress callback; for None return a callback that does nothing."""
    if value is None:
        return lambda now: None
    if not callable(value):
        raise InputError(f"found {reprlib.repr(value)}; it must be a function that takes a Progress.", place=place)
    return value


def made_by(value: object, kind: type, advice: str, place: str) -> None:
    """Require that ``value`` is an instance of the class ``kind``; ``advice`` says how to make an instance."""
    if not isinstance(value, kind):
        raise InputError(f"found {reprlib.repr(value)}; it must be a {kind.__name__}. {advice}", place=place)


def _array(value: object) -> NDArray[np.float64] | None:
    """Convert a value to an array of real numbers; return None if it cannot be converted."""
    try:
        entries = np.asarray(value)
        return None if entries.dtype.kind == "c" else np.asarray(entries, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return None
