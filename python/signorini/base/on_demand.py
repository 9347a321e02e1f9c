"""Mappings whose values are computed when they are asked for."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import TypeVar

from signorini.base.brief import short

_V = TypeVar("_V")


class OnDemand(Mapping[str, _V]):
    """Values by name, each computed when it is first asked for; ``most`` of them, the latest, are kept.

    Examples
    --------
    >>> squares = OnDemand(["2", "3"], lambda name: int(name) ** 2)
    >>> squares["3"], list(squares), dict(squares)
    (9, ['2', '3'], {'2': 4, '3': 9})
    >>> squares
    OnDemand({'2', '3'})
    """

    def __init__(self, names: Collection[str], compute: Callable[[str], _V], most: int | None = None) -> None:
        self._names, self._compute, self._most = names, compute, most
        self._kept: dict[str, _V] = {}

    def __getitem__(self, name: str) -> _V:
        """Compute a value, or find it."""
        if name not in self._kept:
            if name not in self._names:
                raise KeyError(name)
            self._kept[name] = self._compute(name)
            if self._most is not None and len(self._kept) > self._most:
                del self._kept[next(iter(self._kept))]
        return self._kept[name]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(self._names)

    def __repr__(self) -> str:
        """Name the first; their values are not computed."""
        return f"OnDemand({short(dict.fromkeys(self._names))})"

    def __len__(self) -> int:
        """Count the names."""
        return len(self._names)
