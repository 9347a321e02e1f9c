"""Pickling without what can be made again: native objects, and what was computed on demand."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import fields
from typing import TYPE_CHECKING, Any, ClassVar, Self

from signorini.base.brief import Brief


class Remade(Brief):
    """Base of immutable dataclasses that are pickled by their fields; cached properties are left behind.

    Fields in ``_made`` are left behind too. They are made again from the others when they are first asked for, with the
    same numbers to the last bit. A copy shares them, also a deep one: nothing changes them.
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
            """Make what was left behind; called only for what is not there."""
            if name not in type(self)._made:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}", name=name, obj=self)
            value = self.__dict__[name] = type(self)._made[name](self)
            return value
