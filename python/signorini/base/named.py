"""Dicts by name that say of a name they do not have which they have."""

from __future__ import annotations

from typing import TypeVar

from signorini.base.arguments import key_of

_V = TypeVar("_V")


class Named(dict[str, _V]):
    """A dict whose keys are names of some kind of thing.

    Examples
    --------
    >>> reactions = Named({"soil": 3.0}, "support", "This result")
    >>> reactions, reactions.get("soill")
    ({'soil': 3.0}, None)
    >>> reactions["soill"]
    Traceback (most recent call last):
    signorini.errors.UnknownNameError: support: Unknown support 'soill'. This result has: soil. Did you mean 'soil'?
    """

    def __init__(self, values: dict[str, _V], kind: str, owner: str) -> None:
        super().__init__(values)
        self._words = kind, owner

    def __missing__(self, name: object) -> _V:
        """Say that there is nothing of that name."""
        return self[key_of(name, self, *self._words)]
