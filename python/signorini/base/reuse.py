"""Reuse of objects, such as meshes and factors, in calls with equal arguments, for a series of similar models."""

from __future__ import annotations

import hashlib
import pickle
import threading
from collections import OrderedDict
from collections.abc import Callable
from contextvars import ContextVar, Token
from functools import update_wrapper
from typing import Any, ParamSpec, Self, TypeVar

_P = ParamSpec("_P")
_V = TypeVar("_V")

_OBJECTS = 6
"""Largest number of objects stored for each function; a solution with ± needs one object for each of three meshes."""
_ARGUMENTS = 100
"""Largest number of calls whose hashed arguments are remembered for each function."""


class Reuse(threading.local):
    """Context in which `shared` functions return the same object for equal arguments; each thread has its own objects.

    The object of a call is stored when the same arguments occur for the second time. So objects of arguments that occur
    once take no memory.

    Examples
    --------
    >>> @shared
    ... def ones(count: int) -> list[int]:
    ...     return [1] * count
    >>> with Reuse():
    ...     first, second, third = ones(3), ones(3), ones(3)
    >>> first is second, second is third
    (False, True)
    """

    def __init__(self) -> None:
        self._objects = dict[object, OrderedDict[bytes, tuple[Any, dict[str, Any]] | None]]()
        self._tokens = list[Token[Reuse | None]]()

    def __enter__(self) -> Self:
        """Activate the reuse of objects in this thread."""
        self._tokens.append(_active.set(self))
        return self

    def __exit__(self, *_: object) -> None:
        """Deactivate the reuse of objects; stored objects are kept for the next activation."""
        _active.reset(self._tokens.pop())

    def made(self, make: Callable[_P, _V], *args: _P.args, **kwargs: _P.kwargs) -> _V:
        """Return the stored object of ``make`` for these arguments; if there is none, make the object."""
        known = self._objects.setdefault(make, OrderedDict())
        key = hashlib.sha256(pickle.dumps((args, kwargs))).digest()
        is_new = key not in known
        if not (stored := known.pop(key, None)):
            value = make(*args, **kwargs)
            stored = None if is_new else (value, {})
        known[key] = stored
        for least_recent in [key for key, entry in known.items() if entry][:-_OBJECTS]:
            del known[least_recent]
        while len(known) > _ARGUMENTS:
            known.popitem(last=False)
        return stored[0] if stored else value

    def beside(self, owner: object) -> dict[str, Any]:
        """Return a dict for values that are kept as long as ``owner`` is stored; a new dict if it is not stored."""
        entries = (entry for known in self._objects.values() for entry in known.values() if entry)
        return next((values for stored, values in entries if stored is owner), {})


_active: ContextVar[Reuse | None] = ContextVar("_active", default=None)


def shared(make: Callable[_P, _V]) -> Callable[_P, _V]:
    """Decorate a function so that it reuses objects in the context of a `Reuse`; its arguments must be picklable."""

    def get(*args: _P.args, **kwargs: _P.kwargs) -> _V:
        reuse = _active.get()
        return make(*args, **kwargs) if reuse is None else reuse.made(make, *args, **kwargs)

    return update_wrapper(get, make, updated=())


def beside(owner: object) -> dict[str, Any]:
    """Return `Reuse.beside` of the active `Reuse`; without an active `Reuse` a new dict."""
    reuse = _active.get()
    return {} if reuse is None else reuse.beside(owner)
