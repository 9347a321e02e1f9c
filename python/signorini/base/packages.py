"""Import of optional packages, and lazy import of modules."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any

from signorini.errors import SignoriniError


def package(name: str) -> Any:
    """Import a package; raise an error with the command to install it if it is missing."""
    try:
        return import_module(name)
    except ImportError:
        raise SignoriniError(f"{name} is not installed. Install it: pip install {name}.") from None


def lazily(package: str, names_of: Mapping[str, Sequence[str]]) -> Callable[[str], Any]:
    """Return a ``__getattr__`` for a package: it imports a module when a name of that module is first accessed.

    Examples
    --------
    >>> lazily("signorini.base", {"numbers": ("number", "size_of")})("number")(8109.0)
    '8109'
    """
    module_of = {name: module for module, names in names_of.items() for name in names}

    def get(name: str) -> Any:
        if name not in module_of:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(f"{package}.{module_of[name]}"), name)

    return get
