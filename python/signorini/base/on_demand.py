"""Values that are computed on first access and cached; mappings whose KeyErrors list the known names."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import wraps
from itertools import islice
from typing import Concatenate, ParamSpec, Self, SupportsIndex, TypeVar, overload
from weakref import WeakKeyDictionary

from signorini.base.arguments import key_of
from signorini.base.remade import FEW

_K = TypeVar("_K")
_P = ParamSpec("_P")
_V = TypeVar("_V")


def kept(compute: Callable[Concatenate[_K, _P], _V]) -> Callable[Concatenate[_K, _P], _V]:
    """Decorate a function of an immutable object and hashable arguments: cache its values as long as the object exists.

    Examples
    --------
    >>> @kept
    ... def length(word: frozenset, times: int) -> int:
    ...     print("computed")
    ...     return len(word) * times
    >>> word = frozenset("abc")
    >>> length(word, 2), length(word, 2)
    computed
    (6, 6)
    """
    cache: WeakKeyDictionary[_K, dict[object, _V]] = WeakKeyDictionary()

    @wraps(compute)
    def get(subject: _K, /, *args: _P.args, **kwargs: _P.kwargs) -> _V:
        values, key = cache.setdefault(subject, {}), (args, *kwargs.values())
        if key not in values:
            values[key] = compute(subject, *args, **kwargs)
        return values[key]

    return get


class OnDemand(Mapping[str, _V]):
    """Mapping whose values are computed on first access; the latest ``most`` values are cached."""

    def __init__(
        self,
        names: Collection[str],
        compute: Callable[[str], _V],
        most: int | None = None,
        kind: str = "name",
        owner: str = "This mapping",
    ) -> None:
        self._names, self._compute, self._most, self._words = names, compute, most, (kind, owner)
        self._kept: dict[str, _V] = {}

    def __getitem__(self, name: str) -> _V:
        """Return the value of a name, computed or cached."""
        if name not in self._kept:
            key_of(name, self._names, *self._words)
            self._kept[name] = self._compute(name)
            if self._most is not None and len(self._kept) > self._most:
                del self._kept[next(iter(self._kept))]
        return self._kept[name]

    def __contains__(self, name: object) -> bool:
        """Whether the mapping has a value of this name; the value is not computed."""
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the mapping."""
        return iter(self._names)

    def __repr__(self) -> str:
        """Show the first names with their values, if cached."""
        shown = islice(self._names, FEW)
        named = [f"{name!r}: {repr(self._kept[name]) if name in self._kept else '...'}" for name in shown]
        more = f", ... {len(self)} in all" if len(self) > FEW else ""
        return f"{{{', '.join(named)}{more}}}"

    def __len__(self) -> int:
        """Return the number of names in the mapping."""
        return len(self._names)


class Listed(tuple[_V, ...]):
    """A tuple whose items can also be accessed by their names.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> feet = Listed([SimpleNamespace(name="west"), SimpleNamespace(name="east")], "support", "This result")
    >>> feet["east"] is feet[1], len(feet)
    (True, 2)
    >>> feet["soil"]
    Traceback (most recent call last):
    signorini.errors.UnknownNameError: support: Unknown support 'soil'. This result has: east, west.
    """

    _words: tuple[str, str]

    def __new__(cls, values: Iterable[_V], kind: str = "name", owner: str = "This result") -> Self:
        """Store the values; ``kind`` and ``owner`` are words for the message about an unknown name."""
        listed = super().__new__(cls, values)
        listed._words = kind, owner
        return listed

    @overload
    def __getitem__(self, which: SupportsIndex | str) -> _V: ...
    @overload
    def __getitem__(self, which: slice) -> tuple[_V, ...]: ...
    def __getitem__(self, which: SupportsIndex | str | slice) -> _V | tuple[_V, ...]:
        """Return the value with a name or an index, or the values of a slice."""
        if isinstance(which, str):
            names = self._ipython_key_completions_()
            return super().__getitem__(names.index(key_of(which, names, *self._words)))
        return super().__getitem__(which)

    def _ipython_key_completions_(self) -> list[str]:
        """Return the names, for completion in a notebook."""
        return [item.name for item in self]  # type: ignore[attr-defined]  # Items of this tuple have a name.


class Named(dict[str, _V]):
    """A dict by name; an unknown name raises an error that lists the names."""

    def __init__(self, values: dict[str, _V], kind: str, owner: str) -> None:
        super().__init__(values)
        self._words = kind, owner

    def __missing__(self, name: object) -> _V:
        """Raise the error for an unknown name."""
        return self[key_of(name, self, *self._words)]
