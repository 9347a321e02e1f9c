"""What can go wrong, in words for the engineer."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


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
    place : str
        Where: a key path such as ``support[2].stiffness``, or a file and line.

    Examples
    --------
    >>> print(InputError("Thickness is -0.1; it must be positive.", place="plate.thickness"))
    plate.thickness: Thickness is -0.1; it must be positive.
    """

    exit_code = 2

    def __init__(self, message: str, place: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.place = place

    def __str__(self) -> str:
        """Put the place before the message."""
        return f"{self.place}: {self.message}" if self.place else self.message


class UnknownNameError(InputError, KeyError):
    """A mapping has nothing of that name."""


class NoEquilibriumError(SignoriniError):
    """The supports cannot hold the load: no reactions exist that balance it."""

    exit_code = 3


class NotCertifiedError(SignoriniError):
    """A result failed its certificate and is refused."""

    exit_code = 4


def unknown(kind: str, found: str, allowed: Iterable[str], owner: str = "This model") -> str:
    """Say that a name is unknown, which names there are, and which is nearest.

    Examples
    --------
    >>> unknown("edge", "lft", ["bottom", "left", "right", "top"], "This plate")
    "Unknown edge 'lft'. This plate has: bottom, left, right, top. Did you mean 'left'?"
    >>> unknown("case", "Q", [])
    "Unknown case 'Q'. This model has none."
    """
    names = sorted(allowed)
    has = f"has: {', '.join(names)}." if names else "has none."
    near = difflib.get_close_matches(found, names, n=1)
    return f"Unknown {kind} {found!r}. {owner} {has}" + (f" Did you mean {near[0]!r}?" if near else "")
