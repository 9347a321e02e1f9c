"""Exceptions of this package, and functions that write places, points and names in messages."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar

Place = tuple[str | int, ...]
"""Path of a value in the model: keys, and list indices from 0, such as ``("support", 1, "stiffness")``."""

_PLACING: ContextVar[Callable[[Place], Place]] = ContextVar("placing", default=lambda place: place)
_MAX_PROBLEMS = 20
"""Largest number of problems that one message lists."""
_MAX_NAMES = 30
"""Largest number of names that a message lists completely; the 26 functions of an expression fit."""
_EXAMPLES = 8
"""Number of known names that a message gives as examples if there are more than `_MAX_NAMES`."""
_COMPARED = 60
"""Number of leading characters of an unknown name that are compared with known names, to find similar names."""
_DIGITS = 15
"""Number of significant decimal digits of a double."""


class SignoriniError(Exception):
    """Base class of the errors of this package; ``exit_code`` is the exit code of the command line."""

    exit_code = 1


class InputError(SignoriniError, ValueError):
    """The model, the input file or an argument is invalid; also a ValueError.

    Parameters
    ----------
    message : str
        The value found, the values allowed, and the remedy.
    place : str or tuple of str and int
        A path in the model such as ``("support", 1, "stiffness")``, or text: an argument, or a file and line.

    Attributes
    ----------
    message, place : str
        The message and the place as text; a path reads ``support[2].stiffness``, with positions counted from 1.
    path : tuple of str and int
        The path in the model; empty if the place was text.

    Examples
    --------
    >>> print(InputError("Thickness is -0.1; it must be positive.", place=("plate", "thickness")))
    plate.thickness: Thickness is -0.1; it must be positive.
    """

    exit_code = 2

    def __init__(self, message: str, place: str | Place = "") -> None:
        super().__init__(message)
        self.message = message
        self.path: Place = () if isinstance(place, str) else _PLACING.get()(place)
        self.place = place if isinstance(place, str) else format_place(place)
        self._parts: tuple[InputError, ...] = ()

    def __str__(self) -> str:
        """Return the error as text: "place: message"."""
        return f"{self.place}: {self.message}" if self.place else self.message

    @property
    def parts(self) -> tuple[InputError, ...]:
        """The single problems of a combined error; otherwise the error itself."""
        return self._parts or (self,)

    @classmethod
    def combined(cls, problems: Sequence[InputError], source: str = "", omitted: int = 0) -> InputError:
        """Combine problems of a source, such as a file, into one error; ``omitted`` counts problems left out."""
        parts = tuple(part for problem in problems for part in problem.parts)
        count = len(parts) + omitted
        if count == 1:
            return parts[0]
        more = [f"and {count - _MAX_PROBLEMS} more."] if count > _MAX_PROBLEMS else []
        error = cls("\n  ".join([f"{count} problems:", *map(str, parts[:_MAX_PROBLEMS]), *more]), place=source)
        error._parts = parts
        return error


class Problems:
    """Collects input errors and raises them as one error that reports all problems.

    Only the first problem at each place is kept, because later problems there follow from the first. Problems without a
    place get the place "plate".
    """

    def __init__(self) -> None:
        self._by_place: dict[str, InputError] = {}

    @contextmanager
    def collected(self) -> Iterator[None]:
        """Context that catches an InputError raised within the context and stores its problems."""
        try:
            yield
        except InputError as error:
            for part in error.parts:
                placed = part if part.place else InputError(part.message, place=("plate",))
                self._by_place.setdefault(placed.place, placed)

    def raise_collected(self) -> None:
        """Raise the collected problems, if any, as one error."""
        if self._by_place:
            raise InputError.combined(list(self._by_place.values()))


class UnknownNameError(InputError, KeyError):
    """Raised if a mapping, such as the results by combination, has no item of the given name."""


class NoEquilibriumError(SignoriniError):
    """Raised if the supports cannot hold the load: no reactions of the allowed signs and sizes balance it."""

    exit_code = 3


class NotCertifiedError(SignoriniError):
    """Raised if no method gives a solution that passes the certificate."""

    exit_code = 4


@contextmanager
def placing(to_whole: Callable[[Place], Place]) -> Iterator[None]:
    """Context in which `format_place` converts paths in a part of a model by ``to_whole`` to paths in the whole."""
    token = _PLACING.set(to_whole)
    try:
        yield
    finally:
        _PLACING.reset(token)


def format_place(path: Place) -> str:
    """Write a path in the model as text, such as ``support[2].stiffness``; list positions count from 1."""
    placed = _PLACING.get()(path)
    return "".join(f"[{key + 1}]" if isinstance(key, int) else f".{key}" for key in placed).removeprefix(".")


def point(coordinates: Iterable[float], size: float = 0.0) -> str:
    """Write a point as "[x, y]"; see `length` for ``size``.

    Examples
    --------
    >>> point([2, 0.5]), point([-5.7985, -1.4e-14], size=10.0)
    ('[2, 0.5]', '[-5.7985, 0]')
    """
    x, y = (length(coordinate, size) for coordinate in coordinates)
    return f"[{x}, {y}]"


def length(value: float, size: float = 0.0) -> str:
    """Write a length, rounded to 1e-9 ``size`` unless ``size`` is 0, with 6 significant digits or, if large, more.

    Examples
    --------
    >>> length(-1.3e-16, 4.0), length(0.1 + 0.2, 4.0), length(-2.5e-6, 1e-5)
    ('0', '0.3', '-2.5e-06')
    >>> length(4500012.3456789, 10.0), length(4500012.3456789)
    ('4500012.3457', '4500012.346')
    """
    rounded = round(float(value) / size, 9) * size if size else float(value)
    # Large coordinates (from 10 times the size on, or 1000 without a size) need more digits to differ from each other.
    ratio = abs(rounded) / (10.0 * size or 1000.0)
    extra = 1 + math.floor(math.log10(ratio)) if math.isfinite(ratio) and ratio >= 1.0 else 0
    return f"{rounded + 0.0:.{min(6 + extra, _DIGITS)}g}"


def unknown(kind: str, name: str, allowed: Iterable[str], owner: str = "This model") -> str:
    """Message for an unknown name, with all known names or, if there are many, the most similar names.

    Examples
    --------
    >>> unknown("edge", "lft", ["bottom", "left", "right", "top"], "This plate")
    "Unknown edge 'lft'. This plate has: bottom, left, right, top. Did you mean 'left'?"
    >>> unknown("case", "Q", [])
    "Unknown case 'Q'. This model has none."
    >>> unknown("case", "truck", ["G", *(f"truck@{place}" for place in range(90))])[:69]
    "Unknown case 'truck'. This model has 91, such as: truck@9, truck@8, t"
    """
    names = sorted(allowed)
    near = difflib.get_close_matches(name[:_COMPARED], names, n=_EXAMPLES)
    if len(names) > _MAX_NAMES:
        examples = list(dict.fromkeys([*near, *names[:_EXAMPLES]]))[:_EXAMPLES]
        has = f"has {len(names)}, such as: {', '.join(examples)}, ..."
    else:
        has = f"has: {', '.join(names)}." if names else "has none."
    return f"Unknown {kind} {name!r}. {owner} {has}" + (f" Did you mean {near[0]!r}?" if near else "")
