"""Packages that are not installed with this one."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from signorini.errors import SignoriniError


def package(name: str) -> Any:
    """Import a package; one that is not installed is refused with the way to install it."""
    try:
        return import_module(name)
    except ImportError:
        raise SignoriniError(f"{name} is not installed. Install it: pip install {name}.") from None
