"""Fields and supports of a result as pictures show them: quantities with their units, colours, ranges and extremes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from signorini.base.numbers import estimated
from signorini.base.plain import plain
from signorini.discretise.rows import Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.mesh import Mesh
from signorini.model import Model, Support
from signorini.model.whole import Units
from signorini.plot.picture import Panel, SupportMark
from signorini.results.extremes import FieldExtremes
from signorini.results.marks import pressure_layer, support_mark
from signorini.results.quantities import KINDS, PICTURED, PRESSURE
from signorini.results.support_result import SupportResult


class Shown(Protocol):
    """A result, as far as pictures show it."""

    @property
    def model(self) -> Model:
        """What was asked."""

    @property
    def stress_nodes(self) -> StressNodes:
        """Nodes (m,) of the fields' pictures."""

    @property
    def fields(self) -> Mapping[str, Floats]:
        """Values (n,) by name."""

    @property
    def extremes(self) -> Mapping[str, FieldExtremes]:
        """Of the fields that have them."""

    @property
    def supports(self) -> Sequence[SupportResult]:
        """What was found of each support."""


def support_marks(mesh: Mesh, asked: Sequence[Support], supports: Sequence[SupportResult]) -> list[SupportMark]:
    """Marks of the supports, open or closed."""
    pairs = zip(asked, supports, strict=True)
    return [support_mark(mesh, one, result.positions, result.closed, result.contact_boundary) for one, result in pairs]


def field_range(field: str, result: Shown) -> tuple[float, float]:
    """Smallest and largest value of a field away from where it has no limit; of the pressure with 0."""
    if field != PRESSURE.name:
        ends = _ends(field, result)
        return ends.min, ends.max
    ranges = [support.area.range for support in result.supports if support.area is not None]
    return min(low for low, _ in ranges), max(high for _, high in ranges)


def panel(
    field: str, result: Shown, widths: Mapping[str, Any] | None = None, limits: tuple[float, float] | None = None
) -> Panel:
    """Draw a field, or the pressure, in the colours of its quantity, with its extremes and, if known, half-widths."""
    label, map_of = quantity(field, result.model.units), colours(field)
    limits = limits or field_range(field, result)
    if field == PRESSURE.name:
        areas = [(index, one.area) for index, one in enumerate(result.supports) if one.area is not None]
        index, most = max(areas, key=lambda result: result[1].largest[0])
        value, at = most.largest
        width = None if widths is None else widths["supports"][index]["max_pressure"]
        words = extreme("max", value, widths is not None, width)
        layers = [pressure_layer(area) for _, area in areas]
        return Panel(layers, limits, label, map_of, [(words, at.tolist())] if value > 0 else [])
    ends, values = _ends(field, result), None
    if widths is not None and field in result.extremes:
        values = widths["deflection"] if field == "deflection" else widths["fields"][field]
    named = [
        (extreme(name, value, values is not None, values and values[name]), at)
        for name, value, at in (("max", ends.max, ends.max_at), ("min", ends.min, ends.min_at))
    ]
    return Panel(result.stress_nodes.spread(result.fields[field]), limits, label, map_of, named)


def extreme(name: str, value: float, told: bool, width: float | None) -> str:
    """Say what stands at an extreme: its value and, where they are told, its half-width.

    Examples
    --------
    >>> extreme("min", -21.3412, True, 0.25), extreme("max", 21.3412, False, None), extreme("max", 21.3412, True, None)
    ('min −21.34 ± 0.25', 'max 21.34', 'max 21.34 ± ?')
    """
    shown = estimated(value, width).replace("-", "−") if told else plain(value, 4)
    return f"{name} {shown}"


def _ends(field: str, result: Shown) -> FieldExtremes:
    nodes = result.stress_nodes
    everywhere = np.ones(nodes.mesh.node_count, np.bool_)
    return result.extremes.get(field) or FieldExtremes.of(result.fields[field], nodes, everywhere)


def colours(field: str) -> str:
    """Name the colours of a field, a map whose middle is zero."""
    return KINDS[PICTURED[field].kind].colours


def quantity(field: str, units: Units) -> str:
    """Say what a field is, with its unit."""
    return PICTURED[field].label(units)
