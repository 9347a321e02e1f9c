"""Sentences below the printed tables: contact areas, bolts, lifted corners, places excluded from extremes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from typing import Any

import numpy as np

from signorini.analysis.results import Results
from signorini.base.numbers import ROUNDING, number, size_of
from signorini.cli.grid import cell, in_contact, unit_of
from signorini.discretise.laws import SupportLaw, can_let_go
from signorini.discretise.rows import Bools, Floats
from signorini.errors import length, point
from signorini.model import Support, Units
from signorini.results.figures import joints
from signorini.results.quantities import place_of
from signorini.results.result import Result
from signorini.results.support_result import SupportResult
from signorini.singularities.singularity import Singularity

_SAME_POINT = 1e-9
"""Points up to this distance apart, relative to the plate's size, coincide; rounding errors are far smaller."""
_MAX_CORNERS = 6
"""Largest number of lifted corners that are printed."""
SEVERAL = 3
"""Smallest number of combinations for which a summary replaces the tables of each combination."""
_SHORT_NAME, _EXAMINED = 12, 1000
"""Combinations are numbered C1, C2, ... if a name among the first 1000 is longer than 12 characters."""
MAX_KINDS = 6
"""Largest number of kinds of singularities that are printed."""
_PLACES = re.compile(r" at \[.*")
"""Pattern of the positions at the end of the description of a singularity."""


class Labels:
    """Numbers "C1", "C2", ... of combinations, in the order of the input, if names are long.

    A table cell is "C7: name", or "C7" on a narrow console; a sentence has "name (C7)". ``named`` has the names of
    combinations by their printed numbers.
    """

    def __init__(self, results: Results) -> None:
        self._number_of, self.named = results.number_of, dict[int, str]()
        several = len(results) >= SEVERAL
        self.numbered = several and any(len(name) > _SHORT_NAME for name in islice(results, _EXAMINED))

    def code(self, name: str) -> str:
        """Return "C7" for a combination, or its name if combinations are not numbered."""
        if not self.numbered:
            return name
        number = self._number_of(name) + 1
        self.named[number] = name
        return f"C{number}"

    def cell(self, name: str) -> str:
        """Return "C7: name" for a combination, or its name if combinations are not numbered."""
        return f"{self.code(name)}: {name}" if self.numbered else name

    def in_sentence(self, name: str) -> str:
        """Return "name (C7)" for a combination, or its name if combinations are not numbered."""
        return f"{name} ({self.code(name)})" if self.numbered else name

    def listed(self) -> Iterator[str]:
        """Yield "C7: name" for each number that was printed."""
        yield from (f"C{number}: {name}" for number, name in sorted(self.named.items()))


def excluded(singular: Mapping[str, Iterable[Singularity]], units: Units) -> Iterator[str]:
    """Yield sentences that list singularities near which extremes of moments and shears are not evaluated."""
    quantities: dict[tuple[str, float], list[str]] = {}
    for name, places in singular.items():
        for place in places:
            kind = f"{place.plate}: {kind_of(place)}" if place.plate else kind_of(place)
            names = quantities.setdefault((kind, place.within), [])
            names += [f"{name}s"] if f"{name}s" not in names else []
    kinds_of: dict[tuple[str, float], list[str]] = {}
    for (kind, within), names in quantities.items():
        kinds_of.setdefault((" and ".join(names), within), []).append(kind)
    unit = unit_of(units.length)
    for (excluded_names, within), kinds in kinds_of.items():
        where = f"within {length(within)}{unit} of" if within else "at"
        more = f" and {len(kinds) - MAX_KINDS} more kinds" if len(kinds) > MAX_KINDS else ""
        listed = "; ".join(kinds[:MAX_KINDS])
        yield f"Excluded from extremes (singular): {excluded_names} {where} {listed}{more}"


def kind_of(singularity: Singularity) -> str:
    """Description of a singularity without the positions at the end of the description."""
    return _PLACES.sub("", singularity.what)


def resting(result: Result, widths: Mapping[str, Any] | None, pressure: float) -> Iterator[str]:
    """Yield contact area and pressure of each area support, and the contact length of each line support.

    ``pressure`` is the largest pressure on all area supports; rounding errors relative to it are written as 0.
    """
    units = result.model.units
    for index, (support, values) in enumerate(zip(result.model.support, result.supports, strict=True)):
        total, path = float(values.weights.sum()), place_of(result.model, index)
        if values.contact_area is not None and values.max_pressure is not None:
            area = cell(values.contact_area, widths, (*path, "contact_area"), total)
            sentence = in_contact(values.name, area, values.contact_area, total, "area", unit_of(units.length, 2))
            unit = unit_of(units.force_by_length(-2))
            largest = cell(values.max_pressure, widths, (*path, "max_pressure"), pressure)
            sentence += f"; largest pressure {largest}{unit}"
            if values.max_pressure and values.max_pressure_at is not None:
                sentence += f" at {point(values.max_pressure_at, result.mesh.size)}"
            if values.max_tension:
                tension = cell(values.max_tension, widths, (*path, "max_tension"), pressure)
                sentence += f", largest tension {tension}{unit}"
            if values.yielded_area:
                sentence += f"; it yields on {cell(values.yielded_area, widths, (*path, 'yielded_area'), total)}"
                sentence += unit_of(units.length, 2)
            yield sentence
        elif values.place != "at" and can_let_go(support):
            closed = values.closed_part * total
            yield in_contact(values.name, f"{closed:.6g}", closed, total, "length", unit_of(units.length))


def of_bolts(result: Result, widths: Mapping[str, Any] | None) -> Iterator[str]:
    """Yield sentences with sums of preloads and reactions of bolts, and the ratio of bolt force to applied tension."""
    unit = unit_of(result.model.units.force)
    for joint in joints(result):
        size = max(abs(joint["preload"]), abs(joint["reaction"]))
        sums = (f"{name} {number(joint[name], size)}{unit}" for name in ("preload", "reaction"))
        yield f"{' + '.join(joint['supports'])}: {joint['bolts']} bolts, sum of {', of '.join(sums)}"
    for index, values in enumerate(result.supports):
        if values.preloads is not None and not np.isnan(values.prying):
            times = cell(values.prying, widths, ("supports", index, "prying"))
            yield f"{values.name}: bolt force {times} × the tension that the loads apply"


def lifted(result: Result) -> str:
    """List the plate's corners that have lifted off a support with zero gap, and their lift; empty if none has.

    The lift is measured from w = min(settlement, 0): a support that settles away from the plate does not lift it.
    """
    each = {name: _lifted(plate) for name, plate in result.members.items()}
    return "; ".join(": ".join(filter(None, (name, sentence))) for name, sentence in each.items() if sentence)


def _lifted(result: Result) -> str:
    nodes = _corners(result)
    corners, w = result.mesh.points[nodes], result.deflection[nodes]
    lifts = np.full(len(nodes), np.inf)
    for support, values in zip(result.model.support, result.supports, strict=True):
        if support.direction == "down" and support.between is None:
            settlement, gap = SupportLaw(support).travel(corners)
            lift = np.minimum(settlement, 0.0) - w
            at_rest = _holds(result, support, values, corners) & (gap == 0.0)
            lifts = np.where(at_rest, np.minimum(lifts, lift), lifts)
    least = ROUNDING * size_of(result.deflection)
    lifted_corners = [(float(lifts[i]), i) for i in np.flatnonzero((lifts > least) & np.isfinite(lifts))]
    if not lifted_corners:
        return ""
    unit, scale = ("mm", 1e3) if result.model.units.length == "m" else (result.model.units.length, 1.0)
    listed = [
        f"{point(corners[i].tolist(), result.mesh.size)} by {scale * lift:.3g}{unit_of(unit)}"
        for lift, i in sorted(lifted_corners, reverse=True)
    ]
    more = f" and {len(listed) - _MAX_CORNERS} more" if len(listed) > _MAX_CORNERS else ""
    noun = "corners" if len(listed) > 1 else "corner"
    return f"the plate has lifted at its {noun} {', '.join(listed[:_MAX_CORNERS])}{more}"


def _corners(result: Result) -> list[int]:
    """Numbers of the corner nodes: the ends of the plate's named edges, except edges that are closed curves."""
    ends = [(int(triples[0, 0]), int(triples[-1, 2])) for triples in result.mesh.edges.values() if len(triples)]
    return sorted({node for first, last in ends if first != last for node in (first, last)})


def _holds(result: Result, support: Support, values: SupportResult, points: Floats) -> Bools:
    """Mask (k,) of the points (k, 2) that lie on the support."""
    if support.place == "area":
        return support.where.covers(points)
    nodes = [result.mesh.points[result.mesh.edges[name][:, (0, 2)].ravel()] for name in support.where.edges]
    positions = np.concatenate([values.positions, *nodes])
    distance = np.hypot(*(points[:, None] - positions).transpose(2, 0, 1))
    return np.asarray((distance <= _SAME_POINT * result.mesh.size).any(axis=1))
