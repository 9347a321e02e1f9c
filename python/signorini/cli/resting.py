"""Where the plate rests, and which of its corners have lifted, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from signorini.base.numbers import ROUNDING, size_of
from signorini.cli.grid import cell, in_contact, unit_of
from signorini.discretise.rows import Bools, Floats
from signorini.discretise.supports import can_let_go
from signorini.errors import point
from signorini.model import Area, Support
from signorini.results.result import Result
from signorini.results.support_result import SupportResult

_SAME = 1e-9
"""Part of the plate's size within which a point of a support is at a corner: far above rounding."""
_MOST_CORNERS = 6


def resting(result: Result, widths: Mapping[str, Any] | None, pressure: float) -> Iterator[str]:
    """Say of areas, and of lines that can let go, on which part they hold; ``pressure`` is the largest of all."""
    units = result.model.units
    for index, (support, values) in enumerate(zip(result.model.support, result.supports, strict=True)):
        whole, of_support = float(values.weights.sum()), ("supports", index)
        if values.contact_area is not None and values.max_pressure is not None:
            area = cell(values.contact_area, widths, (*of_support, "contact_area"), whole)
            said = in_contact(values.name, area, values.contact_area, whole, "area", unit_of(units.length, 2))
            unit = unit_of(units.force_by_length(-2))
            said += (
                f"; largest pressure {cell(values.max_pressure, widths, (*of_support, 'max_pressure'), pressure)}{unit}"
            )
            if values.max_pressure and values.max_pressure_at is not None:
                said += f" at {point(values.max_pressure_at, result.mesh.size)}"
            if values.max_tension:
                pulled = cell(values.max_tension, widths, (*of_support, "max_tension"), pressure)
                said += f", largest tension {pulled}{unit}"
            yield said
        elif values.place != "at" and can_let_go(support):
            touching = values.closed_part * whole
            yield in_contact(values.name, f"{touching:.6g}", touching, whole, "length", unit_of(units.length))


def lifted(result: Result) -> str:
    """Say which corners of the plate have lifted off what holds them from below, and how far; empty if none has."""
    nodes = _corners(result)
    at, down = result.mesh.points[nodes], result.deflection[nodes]
    lifts = np.full(len(nodes), np.inf)
    for support, values in zip(result.model.support, result.supports, strict=True):
        if support.resists == "down":
            free = support.gap(*at.T) + support.settlement(*at.T) - down
            lifts = np.where(_holds(result, support, values, at), np.minimum(lifts, free), lifts)
    least = ROUNDING * size_of(result.deflection)
    those = sorted(((float(lifts[i]), i) for i in np.flatnonzero((lifts > least) & np.isfinite(lifts))), reverse=True)
    if not those:
        return ""
    unit, scale = ("mm", 1e3) if result.model.units.length == "m" else (result.model.units.length, 1.0)
    said = [f"{point(at[i].tolist(), result.mesh.size)} by {scale * lift:.3g}{unit_of(unit)}" for lift, i in those]
    more = f" and {len(said) - _MOST_CORNERS} more" if len(said) > _MOST_CORNERS else ""
    corners = "corners" if len(said) > 1 else "corner"
    return f"the plate has lifted at its {corners} {', '.join(said[:_MOST_CORNERS])}{more}"


def _corners(result: Result) -> list[int]:
    """Nodes at the ends of the plate's edges; one that is closed has none."""
    ends = [(int(triples[0, 0]), int(triples[-1, 2])) for triples in result.mesh.edges.values() if len(triples)]
    return sorted({node for first, last in ends if first != last for node in (first, last)})


def _holds(result: Result, support: Support, values: SupportResult, at: Floats) -> Bools:
    """Which places (k, 2) are on a support."""
    if support.place == "area":
        on = support.area.region.contains(at) if isinstance(support.area, Area) else np.ones(len(at), np.bool_)
        return np.asarray(on)
    places = [result.mesh.points[result.mesh.edges[name][:, (0, 2)].ravel()] for name in support.edge or ()]
    every = np.concatenate([values.positions, *places])
    away = np.hypot(*(at[:, None] - every).transpose(2, 0, 1))
    return np.asarray((away <= _SAME * result.mesh.size).any(axis=1))
