"""Modules that are read when they are asked for, of packages that may not be installed too."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any

from signorini.errors import SignoriniError


def package(name: str) -> Any:
    """Import a package; one that is not installed is refused with the way to install it."""
    try:
        return import_module(name)
    except ImportError:
        raise SignoriniError(f"{name} is not installed. Install it: pip install {name}.") from None


def lazily(package: str, homes: Mapping[str, Sequence[str]]) -> Callable[[str], Any]:
    """Give a package's ``__getattr__``, from the names that each of its modules holds.

    Examples
    --------
    >>> lazily("signorini.base", {"numbers": ("number", "size_of")})("number")(8109.0)
    '8109'
    """
    home = {name: module for module, names in homes.items() for name in names}

    def get(name: str) -> Any:
        if name not in home:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(f"{package}.{home[name]}"), name)

    return get
