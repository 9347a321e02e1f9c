"""Fields and supports of a result as pictures show them: quantities with their units, colours, ranges and extremes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from signorini.discretise.rows import Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.mesh import Mesh
from signorini.model import Support
from signorini.model.whole import Units
from signorini.results.extremes import FieldExtremes
from signorini.results.marks import pressure_layer, support_mark
from signorini.results.support_result import SupportResult

if TYPE_CHECKING:
    from signorini.plot import Panel, SupportMark

PRESSURE = "pressure"
_WORDS = {
    "deflection": "deflection{unit}, positive down",
    "rotation_x": "rotation θx",
    "rotation_y": "rotation θy",
    "mx": "moment mx{unit}",
    "my": "moment my{unit}",
    "mxy": "moment mxy{unit}",
    "qx": "shear qx{unit}",
    "qy": "shear qy{unit}",
    PRESSURE: "contact pressure{unit}, positive up",
}
_COLOURS = {"d": "RdBu", "r": "PiYG", "m": "BrBG", "q": "PRGn", "p": "PuOr"}
"""Maps whose middle is zero, by the first letter of the quantity."""


def support_marks(mesh: Mesh, asked: Sequence[Support], supports: Sequence[SupportResult]) -> list[SupportMark]:
    """Marks of the supports, open or closed."""
    pairs = zip(asked, supports, strict=True)
    return [support_mark(mesh, one, found.positions, found.closed, found.contact_boundary) for one, found in pairs]


def field_range(field: str, fields: Mapping[str, Floats], supports: Sequence[SupportResult]) -> tuple[float, float]:
    """Smallest and largest value of a field; of the pressure with 0."""
    if field != PRESSURE:
        return float(fields[field].min()), float(fields[field].max())
    ranges = [support.area.range for support in supports if support.area is not None]
    return min(low for low, _ in ranges), max(high for _, high in ranges)


def panel(
    field: str,
    nodes: StressNodes,
    fields: Mapping[str, Floats],
    supports: Sequence[SupportResult],
    units: Units,
    limits: tuple[float, float] | None,
    extremes: Mapping[str, FieldExtremes],
) -> Panel:
    """Draw a field, or the pressure, in the colours of its quantity, with its extremes."""
    from signorini.plot import Panel

    label, map_of = quantity(field, units), colours(field)
    limits = limits or field_range(field, fields, supports)
    if field == PRESSURE:
        areas = [support.area for support in supports if support.area is not None]
        value, at = max((area.largest for area in areas), key=lambda found: found[0])
        largest = [("max", value, at.tolist())] if value > 0 else []
        return Panel([pressure_layer(area) for area in areas], label, map_of, limits, largest)
    values = fields[field]
    ends = extremes.get(field) or FieldExtremes.of(values, nodes, np.ones(nodes.mesh.node_count, np.bool_))
    named = [("max", ends.max, ends.max_at), ("min", ends.min, ends.min_at)]
    return Panel(nodes.spread(fields[field]), label, map_of, limits, named)


def colours(field: str) -> str:
    """Name the colours of a field, a map whose middle is zero."""
    return _COLOURS[field[0]]


def quantity(field: str, units: Units) -> str:
    """Say what a field is, with its unit.

    Examples
    --------
    >>> units = Units(length="m", force="kN")
    >>> quantity("mx", units), quantity("qx", units), quantity("mx", Units())
    ('moment mx [kN m/m]', 'shear qx [kN/m]', 'moment mx')
    """
    unit = unit_of(field, units)
    return _WORDS[field].format(unit=f" [{unit}]" if unit else "")


def unit_of(field: str, units: Units) -> str:
    """Unit of a field; empty where the model has none."""
    length, force = units.length, units.force
    if field[0] == "m":
        return f"{force} {length}/{length}" if length and force else ""
    return {"d": length, "q": units.force_by_length(-1), "p": units.force_by_length(-2)}.get(field[0], "")
