"""Common behaviour of objects with arrays: a short repr, read-only arrays, pickling."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sized
from copy import deepcopy
from dataclasses import fields
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

FEW = 4
"""Largest number of entries that are written out."""


class Brief:
    """Base of frozen dataclasses with ``repr=False``, whose own would write out every array; theirs are read only.

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
        """Close the arrays to writing."""
        self._close_arrays()

    def _close_arrays(self) -> None:
        """Let nobody write into arrays that others have been computed from."""
        for value in self.__dict__.values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def __repr__(self) -> str:
        """Name every public field but those with ``repr=False``."""
        named = [field.name for field in fields(self) if field.repr]  # type: ignore[arg-type]  # its heirs are dataclasses
        shown = ", ".join(f"{name}={short(getattr(self, name))}" for name in named if name[0] != "_")
        return f"{type(self).__name__}({shown})"


def short(value: Any) -> str:
    """Write a value in few words: of arrays the shape, of mappings the first names."""
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
        case tuple() | list() if len(value) <= FEW and all(isinstance(one, int | float | str) for one in value):
            return f"({', '.join(map(short, value))})"
        case tuple() | list():
            return f"{len(value)} {type(value[0]).__name__}" if value else "()"
        case Sized() if hasattr(value, "shape"):
            # Sparse arrays have no length.
            return f"{type(value).__name__}{value.shape}"
        case Sized() if not hasattr(value, "__dataclass_fields__"):
            return f"{type(value).__name__} of {len(value)}"
        case _:
            return f"{type(value).__name__}(...)"


class Remade(Brief):
    """Base of immutable dataclasses that are pickled by their fields, without cached properties.

    Fields in ``_made`` are left out, too. They are made again from the others on demand, with the same bits. A copy,
    shallow or deep, shares them, since they are immutable.
    """

    _made: ClassVar[Mapping[str, Callable[[Any], object]]] = {}

    def __getstate__(self) -> dict[str, Any]:
        """Give the fields that are pickled."""
        return {name: getattr(self, name) for name in self._names() if name not in self._made}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Take them back."""
        self.__dict__.update(state)
        self._close_arrays()

    def __copy__(self) -> Self:
        """Share every field."""
        return self._with(dict(self.__dict__))

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """Copy every field but those that can be made again, which are shared."""
        result = self._with({})
        memo[id(self)] = result
        result.__setstate__({name: deepcopy(value, memo) for name, value in self.__getstate__().items()})
        result.__dict__.update({name: self.__dict__[name] for name in self._made if name in self.__dict__})
        return result

    def _with(self, state: dict[str, Any]) -> Self:
        result = object.__new__(type(self))
        result.__dict__.update(state)
        return result

    def _names(self) -> list[str]:
        return [field.name for field in fields(self)]  # type: ignore[arg-type]  # its heirs are dataclasses

    if not TYPE_CHECKING:  # To a type checker every name would be an attribute.

        def __getattr__(self, name: str) -> Any:
            """Make a missing field; called for missing attributes only."""
            if name not in type(self)._made:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}", name=name, obj=self)
            value = self.__dict__[name] = type(self)._made[name](self)
            return value
