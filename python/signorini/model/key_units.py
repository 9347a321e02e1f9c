"""Units of keys of the input, as exponents of force and length."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from signorini.model.whole import Units

_FORCES = {
    **dict.fromkeys(("E", "Ex", "Ey", "Gxy", "Gxz", "Gyz", "pressure", "fck", "fyk"), -2),
    **dict.fromkeys(("line_load", "Sx", "Sy"), -1),
    **dict.fromkeys(("unit_weight",), -3),
    **dict.fromkeys(("force", "preload", "preload_force"), 0),
    **dict.fromkeys(("couple", "moment", "couple_about", "Dx", "Dy", "D1", "Dxy"), 1),
}
"""Map from each key whose unit contains a force to the exponent n of its unit force × length^n."""
_OF_PLACES = {"stiffness": -1, "limit": 0, "rotational_stiffness": 1}
"""Exponent n of the unit force × length^n of keys of a point support; for lines and areas add `_PER` to n."""
_PER = {"edge": -1, "line": -1, "circle": -1, "area": -2}
_LENGTHS = frozenset(
    (
        *("thickness", "gap", "settlement", "radius", "size", "inner", "outer", "d", "bar", "column", "diameter"),
        *("patch", "top", "bottom", "d_top", "d_bottom"),
    )
)

_COORDINATES = frozenset(("at", "center", "origin", "line", "points", "rectangle", "polygon"))
"""Keys whose values are coordinates of points, circles or outlines."""


def dimension(key: str, table: Mapping[str, Any] | None = None) -> tuple[int, int]:
    """Exponents of force and length in the unit of a key; (0, 0) for a key without a unit.

    The unit of a stiffness or limit depends on the place (at, line, area) that ``table`` gives.

    Examples
    --------
    >>> dimension("pressure"), dimension("stiffness", {"area": "all"}), dimension("nu")
    ((1, -2), (1, -3), (0, 0))
    """
    if key in _FORCES:
        return 1, _FORCES[key]
    if table is not None and key in _OF_PLACES:
        return 1, _OF_PLACES[key] + next((_PER[place] for place in _PER if place in table), 0)
    return 0, int(key in _LENGTHS) - (key == "curvature")


def unit_of(key: str, units: Units, table: Mapping[str, Any] | None = None) -> str:
    """Label of the unit of a key; empty if the key has no unit, or if the model does not name its units."""
    force, length = dimension(key, table)
    if force:
        return units.force_by_length(length)
    return {1: units.length, -1: f"1/{units.length}" if units.length else ""}.get(length, "")


def unit_at(place: Sequence[str | int], units: Units, tables: Any) -> str:
    """Label of the unit of a number in the input; ``place`` is its path, of keys and of list indices from 0.

    Examples
    --------
    >>> tables = {"load": [{"couple_about": {"y": -5e5}, "at": [2.0, 1.5]}]}
    >>> [unit_at(("load", 0, *key), Units(length="m", force="N"), tables) for key in (("couple_about", "y"), ("at", 0))]
    ['N m', 'm']
    """
    unit = ""
    for key in place:
        if isinstance(key, str):
            table = tables if isinstance(tables, Mapping) else None
            unit = units.length if key in _COORDINATES else unit_of(key, units, table) or unit
        try:
            tables = tables[key]
        except (KeyError, IndexError, TypeError):
            tables = None
    return unit
