"""What can go wrong, in words for the engineer."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar

Place = tuple[str | int, ...]
"""Where something stands in the model: keys and, counted from 0, positions in lists."""

_PLACING: ContextVar[Callable[[Place], Place]] = ContextVar("placing", default=lambda place: place)
_MOST_TOLD = 20
"""Problems that are told together."""
_MOST_NAMES = 30
"""Names up to which a message lists all; an expression has 26 functions."""
_NEAREST = 8
"""Names that a message lists of more."""
_LONGEST = 60
"""Characters of a name that are compared with others."""
_DIGITS = 15
"""Of a number that a double keeps."""


class SignoriniError(Exception):
    """Base of every error that this package raises on purpose.

    ``exit_code`` is what the command line returns for it.
    """

    exit_code = 1


class InputError(SignoriniError, ValueError):
    """The model, the input file or an argument says something that cannot be; a ValueError too.

    Parameters
    ----------
    message : str
        What was found, what is allowed and what to do.
    place : str or tuple of str and int
        Where: a path in the model such as ``("support", 1, "stiffness")``, or in words an argument, or a file and line.

    Attributes
    ----------
    message, place : str
        The same in words; a path reads ``support[2].stiffness``, as positions count from 1.
    path : tuple of str and int
        The path in the model, if it was one.

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
        """Put the place before the message."""
        return f"{self.place}: {self.message}" if self.place else self.message

    @property
    def parts(self) -> tuple[InputError, ...]:
        """Each problem by itself."""
        return self._parts or (self,)

    @classmethod
    def combined(cls, problems: Sequence[InputError], source: str = "", omitted: int = 0) -> InputError:
        """Tell problems together, those of a source such as a file, and how many more there are."""
        parts = tuple(part for problem in problems for part in problem.parts)
        count = len(parts) + omitted
        if count == 1:
            return parts[0]
        more = [f"and {count - _MOST_TOLD} more."] if count > _MOST_TOLD else []
        whole = cls("\n  ".join([f"{count} problems:", *map(str, parts[:_MOST_TOLD]), *more]), place=source)
        whole._parts = parts
        return whole


class Problems:
    """Collects what is wrong, so that all of it is told together.

    Of one place the first problem counts: what comes later there follows from it. What has no place is the plate's.
    """

    def __init__(self) -> None:
        self._of: dict[str, InputError] = {}

    @contextmanager
    def collected(self) -> Iterator[None]:
        """Keep what is raised within, and go on behind it."""
        try:
            yield
        except InputError as error:
            for part in error.parts:
                placed = part if part.place else InputError(part.message, place=("plate",))
                self._of.setdefault(placed.place, placed)

    def raise_collected(self) -> None:
        """Raise what was collected, if anything was."""
        if self._of:
            raise InputError.combined(list(self._of.values()))


class UnknownNameError(InputError, KeyError):
    """A mapping has nothing of that name."""


class NoEquilibriumError(SignoriniError):
    """The supports cannot hold the load: no reactions exist that balance it."""

    exit_code = 3


class NotCertifiedError(SignoriniError):
    """A result failed its certificate and is refused."""

    exit_code = 4


@contextmanager
def placing(of: Callable[[Place], Place]) -> Iterator[None]:
    """Say of what is placed within where it stands: a part of a model counts its own tables."""
    token = _PLACING.set(of)
    try:
        yield
    finally:
        _PLACING.reset(token)


def format_place(path: Place) -> str:
    """Write where something stands in the model; positions count from 1."""
    placed = _PLACING.get()(path)
    return "".join(f"[{key + 1}]" if isinstance(key, int) else f".{key}" for key in placed).removeprefix(".")


def point(at: Iterable[float], size: float = 0.0) -> str:
    """Write a point; beside a size, such as the plate's, without the digits that are rounding.

    Examples
    --------
    >>> point([2, 0.5]), point([-5.7985, -1.4e-14], size=10.0)
    ('[2, 0.5]', '[-5.7985, 0]')
    """
    x, y = (length(part, size) for part in at)
    return f"[{x}, {y}]"


def length(value: float, size: float = 0.0) -> str:
    """Write a length; beside a size, such as the plate's, to a millionth of it, without the digits that are rounding.

    Examples
    --------
    >>> length(-1.3e-16, 4.0), length(0.1 + 0.2, 4.0), length(-2.5e-6, 1e-5)
    ('0', '0.3', '-2.5e-06')
    >>> length(4500012.3456789, 10.0), length(4500012.3456789)
    ('4500012.3457', '4500012.346')
    """
    rounded = round(float(value) / size, 9) * size if size else float(value)
    # Far from the origin a place has more digits before those that tell it from others: one at 1000, or at ten sizes.
    far = abs(rounded) / (10.0 * size or 1000.0)
    farther = 1 + math.floor(math.log10(far)) if math.isfinite(far) and far >= 1.0 else 0
    return f"{rounded + 0.0:.{min(6 + farther, _DIGITS)}g}"


def unknown(kind: str, result: str, allowed: Iterable[str], owner: str = "This model") -> str:
    """Say that a name is unknown, which names there are, of many the nearest, and whether one was meant.

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
    near = difflib.get_close_matches(result[:_LONGEST], names, n=_NEAREST)
    if len(names) > _MOST_NAMES:
        some = list(dict.fromkeys([*near, *names[:_NEAREST]]))[:_NEAREST]
        has = f"has {len(names)}, such as: {', '.join(some)}, ..."
    else:
        has = f"has: {', '.join(names)}." if names else "has none."
    return f"Unknown {kind} {result!r}. {owner} {has}" + (f" Did you mean {near[0]!r}?" if near else "")
