"""Base classes of dataclasses that contain arrays: a short repr, read-only arrays, pickling."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sized
from copy import deepcopy
from dataclasses import fields
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

FEW = 4
"""Largest number of entries of an array or mapping that a repr shows."""


class Brief:
    """Base class of frozen dataclasses with ``repr=False``: a short repr and read-only arrays.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> import numpy as np
    >>> @dataclass(frozen=True, repr=False)
    ... class Field(Brief):
    ...     name: str
    ...     values: np.ndarray
    ...     extremes: tuple[float, float]
    ...     by_name: dict[str, float]
    >>> Field("moment", np.ones((400, 3)), (0.0, 1 / 3), dict.fromkeys("abcdef", 1.0))
    Field(name='moment', values=array(400, 3), extremes=(0, 0.333333), by_name={'a', 'b', 'c', 'd', ... 6 in all})
    """

    def __post_init__(self) -> None:
        """Make all arrays of the object read-only."""
        self._close_arrays()

    def _close_arrays(self) -> None:
        """Make all arrays of the object read-only: changes would contradict values already computed from the arrays."""
        for value in self.__dict__.values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def __repr__(self) -> str:
        """Show every public field, except fields with ``repr=False``."""
        named = [field.name for field in fields(self) if field.repr]  # type: ignore[arg-type]  # Each subclass is a dataclass.
        shown = ", ".join(f"{name}={short(getattr(self, name))}" for name in named if name[0] != "_")
        return f"{type(self).__name__}({shown})"


def short(value: Any) -> str:
    """Return a short text for a value, such as the shape of an array or the first names of a mapping."""
    match value:
        case np.ndarray():
            return f"array{value.shape}" if value.size > FEW else f"array({value.tolist()})"
        case bool() | int() | str() | None:
            return repr(value)
        case float() | np.number():
            return f"{value:.6g}"
        case Mapping():
            named = [repr(name) for name in list(value)[:FEW]]
            more = f", ... {len(value)} in all" if len(value) > FEW else ""
            return f"{{{', '.join(named)}{more}}}"
        case tuple() | list() if len(value) <= FEW and all(isinstance(item, int | float | str) for item in value):
            return f"({', '.join(map(short, value))})"
        case tuple() | list():
            return f"{len(value)} {type(value[0]).__name__}" if value else "()"
        case Sized() if hasattr(value, "shape"):
            # len() of a sparse array raises a TypeError.
            return f"{type(value).__name__}{value.shape}"
        case Sized() if not hasattr(value, "__dataclass_fields__"):
            return f"{type(value).__name__} of {len(value)}"
        case _:
            return f"{type(value).__name__}(...)"


class Remade(Brief):
    """Base class of immutable dataclasses that are pickled by their fields, without cached properties.

    Fields in ``_made`` are not pickled: on access they are recomputed from the other fields, bit-identically. Shallow
    and deep copies share the fields in ``_made`` with the original.
    """

    _made: ClassVar[Mapping[str, Callable[[Any], object]]] = {}

    def __getstate__(self) -> dict[str, Any]:
        """Return the fields to be pickled."""
        return {name: getattr(self, name) for name in self._names() if name not in self._made}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Restore the pickled fields, and make arrays read-only."""
        self.__dict__.update(state)
        self._close_arrays()

    def __copy__(self) -> Self:
        """Make a shallow copy, which shares every field with the original."""
        return self._with(dict(self.__dict__))

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """Make a deep copy: fields that are pickled are copied, the other fields are shared."""
        copy = self._with({})
        memo[id(self)] = copy
        copy.__setstate__({name: deepcopy(value, memo) for name, value in self.__getstate__().items()})
        copy.__dict__.update({name: self.__dict__[name] for name in self._made if name in self.__dict__})
        return copy

    def _with(self, state: dict[str, Any]) -> Self:
        made = object.__new__(type(self))
        made.__dict__.update(state)
        return made

    def _names(self) -> list[str]:
        return [field.name for field in fields(self)]  # type: ignore[arg-type]  # Each subclass is a dataclass.

    if not TYPE_CHECKING:  # Hide ``__getattr__`` from type checkers, which would otherwise accept any attribute.

        def __getattr__(self, name: str) -> Any:
            """Recompute a field in ``_made``; Python calls this method only for missing attributes."""
            if name not in type(self)._made:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}", name=name, obj=self)
            value = self.__dict__[name] = type(self)._made[name](self)
            return value
