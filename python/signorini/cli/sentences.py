"""Sentences below the tables: contact areas, bolts, lifted corners, excluded extremes, wide half-widths."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np

from signorini.accuracy.half_width import away, largest_of, sizes_of
from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.base.numbers import ROUNDING, number, size_of
from signorini.cli.grid import cell, in_contact, unit_of
from signorini.discretise import Discretisation
from signorini.discretise.laws import SupportLaw, can_let_go
from signorini.discretise.rows import Bools, Floats
from signorini.errors import length, point
from signorini.model import MeshPlate, Support, Units
from signorini.output.envelope_json import envelope_json
from signorini.results.figures import figures, joints
from signorini.results.quantities import FIELDS, RESULTANTS, SIDES, place_of
from signorini.results.result import Result
from signorini.results.support_result import SupportResult
from signorini.singularities.named import singularities
from signorini.singularities.singularity import Singularity

_SAME_POINT = 1e-9
"""Largest distance of points that coincide, relative to the plate's size: far above rounding."""
_MAX_CORNERS = 6
"""Largest number of lifted corners that are listed."""
SEVERAL = 3
"""Smallest number of combinations for which a summary replaces the tables of each combination."""
_SHORT_NAME, _EXAMINED = 12, 1000
"""Combinations get numbers if a name among the first 1000 is longer than 12 characters."""
MAX_KINDS = 6
"""Largest number of kinds of singularities that are listed."""
_PLACES = re.compile(r" at \[.*")
"""Pattern of the positions in the description of a singularity."""


class Labels:
    """Numbers "C1", "C2", ... of combinations, in the order of the input, if names are long.

    A table cell is "C7: name", or "C7" on a narrow console; a sentence has "name (C7)". ``named`` has the names of the
    numbers that were printed.
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
    """Yield sentences on the singularities around which extremes of moments and shears exclude nodes."""
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
    """The description of a singularity without the positions at its end."""
    return _PLACES.sub("", singularity.what)


def resting(result: Result, widths: Mapping[str, Any] | None, pressure: float) -> Iterator[str]:
    """Yield contact area and pressure of each area support, and the contact length of each line support.

    ``pressure`` is the largest of all areas; it sets the digits.
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
    """Yield the sums of preloads and reactions of bolts, and the ratio of bolt force to the tension of the loads."""
    unit = unit_of(result.model.units.force)
    for joint in joints(result):
        size = max(abs(joint["preload"]), abs(joint["reaction"]))
        sums = (f"{name} {number(joint[name], size)}{unit}" for name in ("preload", "reaction"))
        yield f"{' + '.join(joint['supports'])}: {joint['bolts']} bolts, sum of {', of '.join(sums)}"
    for index, values in enumerate(result.supports):
        if values.preloads is not None and not np.isnan(values.prying):
            times = cell(values.prying, widths, ("supports", index, "prying"))
            yield f"{values.name}: bolt force {times} × the tension of the loads"


def lifted(result: Result) -> str:
    """List the plate's corners that have lifted off a support with zero gap, and their lift; empty without any.

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
    """Nodes at both ends of the plate's named edges, except closed edges."""
    ends = [(int(triples[0, 0]), int(triples[-1, 2])) for triples in result.mesh.edges.values() if len(triples)]
    return sorted({node for first, last in ends if first != last for node in (first, last)})


def _holds(result: Result, support: Support, values: SupportResult, points: Floats) -> Bools:
    """Mask (k,) of the points (k, 2) that are on a support."""
    if support.place == "area":
        return support.where.covers(points)
    nodes = [result.mesh.points[result.mesh.edges[name][:, (0, 2)].ravel()] for name in support.where.edges]
    positions = np.concatenate([values.positions, *nodes])
    distance = np.hypot(*(points[:, None] - positions).transpose(2, 0, 1))
    return np.asarray((distance <= _SAME_POINT * result.mesh.size).any(axis=1))


_WIDE = 0.5
"""Largest ratio of a half-width to its number that is not reported."""
_NEAR = 4.0
"""Distance from a singularity, in element sizes, within which values depend on the mesh. It equals two elements of the
coarser compared mesh, which has elements of double size.
"""
_MINOR = 0.25
"""Largest ratio of a half-width to the largest moment, or shear, of any direction that is not reported."""
_STRIP = 1e-3
"""Width ℓ of a strip, relative to the plate's size. Moments up to p ℓ² and shears up to p ℓ under the mean pressure p
count as zero.
"""


def too_wide(results: Results, estimates: Estimates | None) -> Iterator[str]:
    """Yield a sentence if half-widths exceed half of the largest moments and shears, with the remedy."""
    wide: dict[str, tuple[float, str]] = {}
    size = results.discretisation.mesh.size
    for fields, widths, force in _fields(results, estimates):
        zero = {"moment": _STRIP**2 * force, "shear": _STRIP * force / size}
        ends = {name: max(SIDES, key=lambda end: abs(fields[name][end])) for name in RESULTANTS if name in fields}
        for name in ends:
            value, width = abs(fields[name][ends[name]]), widths[name][ends[name]]
            same_kind = [abs(fields[other][ends[other]]) for other in ends if FIELDS[other].kind == FIELDS[name].kind]
            place = fields[name][f"{ends[name]}_at"]
            if width is None or any(_near_singularity(each, place) for each in results.discretisation.each):
                continue
            if width > max(_WIDE * value, _MINOR * max(same_kind), zero[FIELDS[name].kind]):
                ratio = width / value if value else float("inf")
                wide[name] = max(wide.get(name, (0.0, "")), (ratio, point(place, size)))
    if not wide:
        return
    where = ", ".join(f"{name} at {place}" for name, (_, place) in wide.items())
    remedy = "Use smaller elements there (mesh.refine), or put a probe there and give mesh.accuracy = 0.05."
    if results.model.plates or isinstance(results.model.plate, MeshPlate):
        remedy = "Refine the mesh there."
    yield f"± is more than half of the largest {where}: the mesh is too coarse there. {remedy}"


def _near_singularity(discretisation: Discretisation, xy: Sequence[float]) -> bool:
    """Whether a point is so near to a singularity of moments or shears that the latter is reported instead."""
    place = np.array([xy])
    where = discretisation.mesh.locate(place)
    if not where.inside.all():
        return False
    reach = _NEAR * float(np.sqrt(discretisation.mesh.element_area[where.elements[0]]))
    every = (each for each in singularities(discretisation) if not each.limited)
    named = [each for each in every if {"moment", "shear"} & set(each.numbers)]
    return any(away(place, each)[0] <= each.within + reach for each in named)


def _fields(
    results: Results, estimates: Estimates | None
) -> Iterator[tuple[Mapping[str, Any], Mapping[str, Any], float]]:
    """Yield extremes of moments and shears, their half-widths and the largest force, per combination or table."""
    if results.model.tabulated:
        values = envelope_json(results, estimates)
        if values is not None and values["plus_minus"] is not None:
            yield (
                {name: values["fields"][name] for name in RESULTANTS if name in values["fields"]},
                values["plus_minus"]["fields"],
                _force(results),
            )
        return
    for result in results.full.values():
        widths = None if estimates is None else estimates[result.name].plus_minus
        if result.status == "solved" and widths is not None:
            yield figures(result)["fields"], widths["fields"], largest_of(result)["reaction"]


def _force(results: Results) -> float:
    """Upper bound of the total reaction in any combination of a table."""
    values, catalogue = results.combined.envelope.values, results.combined.layout.catalogue
    largest = np.fmax(np.abs(values.largest), np.abs(values.smallest))
    if results.model.plates:
        return float(largest[catalogue.at("support", "reaction")].sum())
    sizes = sizes_of(largest[:, None], catalogue.numbers, results.model, results.discretisation.mesh)
    return float(sizes["reaction"][0])
