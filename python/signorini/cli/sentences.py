"""What tables do not say, in sentences: where the plate rests, which corners lift, where half-widths are wide."""

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
from signorini.discretise.laws import can_let_go
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

_SAME = 1e-9
"""Part of the plate's size within which a point of a support is at a corner: far above rounding."""
_MOST_CORNERS = 6
SEVERAL = 3
"""Combinations from which on a summary is shown in place of each one's tables."""
_SHORT_NAME, _LOOKED_AT = 12, 1000
"""Letters of a name that needs no number, and names that are looked at."""
MOST_KINDS = 6
"""Kinds of places without a limit that are named."""
_PLACES = re.compile(r" at \[.*")
"""The places in the words about a singularity."""


class Labels:
    """Numbers of combinations with long names: "C7", counted from 1 in the order of the input.

    In cells of tables the number stands before the name, alone where there is no room. In sentences it stands behind
    the name. ``named`` collects the combinations that were told.
    """

    def __init__(self, results: Results) -> None:
        self._number_of, self.named = results.number_of, dict[int, str]()
        several = len(results) >= SEVERAL
        self.numbered = several and any(len(name) > _SHORT_NAME for name in islice(results, _LOOKED_AT))

    def code(self, name: str) -> str:
        """Give the number of a combination, or its name where names are short."""
        if not self.numbered:
            return name
        number = self._number_of(name) + 1
        self.named[number] = name
        return f"C{number}"

    def cell(self, name: str) -> str:
        """Write a combination in a column that is coded."""
        return f"{self.code(name)}: {name}" if self.numbered else name

    def said(self, name: str) -> str:
        """Write a combination in a sentence."""
        return f"{name} ({self.code(name)})" if self.numbered else name

    def listed(self) -> Iterator[str]:
        """Say what the numbers stand for."""
        yield from (f"C{number}: {name}" for number, name in sorted(self.named.items()))


def excluded(singular: Mapping[str, Iterable[Singularity]], units: Units) -> Iterator[str]:
    """Say around which singularities extremes of moments and shears leave out nodes."""
    numbers: dict[tuple[str, float], list[str]] = {}
    for name, those in singular.items():
        for one in those:
            kind = f"{one.plate}: {kind_of(one)}" if one.plate else kind_of(one)
            told = numbers.setdefault((kind, one.within), [])
            told += [f"{name}s"] if f"{name}s" not in told else []
    alike: dict[tuple[str, float], list[str]] = {}
    for (kind, within), told in numbers.items():
        alike.setdefault((" and ".join(told), within), []).append(kind)
    unit = unit_of(units.length)
    for (what, within), kinds in alike.items():
        where = f"within {length(within)}{unit} of" if within else "at"
        more = f" and {len(kinds) - MOST_KINDS} more kinds" if len(kinds) > MOST_KINDS else ""
        listed = "; ".join(kinds[:MOST_KINDS])
        yield f"Excluded from extremes (singular): {what} {where} {listed}{more}"


def kind_of(one: Singularity) -> str:
    """Say what a singularity is, without its places."""
    return _PLACES.sub("", one.what)


def resting(result: Result, widths: Mapping[str, Any] | None, pressure: float) -> Iterator[str]:
    """Say of areas, and of lines that can let go, on which part they hold; ``pressure`` is the largest of all."""
    units = result.model.units
    for index, (support, values) in enumerate(zip(result.model.support, result.supports, strict=True)):
        whole, of_support = float(values.weights.sum()), place_of(result.model, index)
        if values.contact_area is not None and values.max_pressure is not None:
            area = cell(values.contact_area, widths, (*of_support, "contact_area"), whole)
            said = in_contact(values.name, area, values.contact_area, whole, "area", unit_of(units.length, 2))
            unit = unit_of(units.force_by_length(-2))
            largest = cell(values.max_pressure, widths, (*of_support, "max_pressure"), pressure)
            said += f"; largest pressure {largest}{unit}"
            if values.max_pressure and values.max_pressure_at is not None:
                said += f" at {point(values.max_pressure_at, result.mesh.size)}"
            if values.max_tension:
                pulled = cell(values.max_tension, widths, (*of_support, "max_tension"), pressure)
                said += f", largest tension {pulled}{unit}"
            if values.yielded_area:
                said += f"; it yields on {cell(values.yielded_area, widths, (*of_support, 'yielded_area'), whole)}"
                said += unit_of(units.length, 2)
            yield said
        elif values.place != "at" and can_let_go(support):
            touching = values.closed_part * whole
            yield in_contact(values.name, f"{touching:.6g}", touching, whole, "length", unit_of(units.length))


def of_bolts(result: Result, widths: Mapping[str, Any] | None) -> Iterator[str]:
    """Say the sums of bolts' forces, and how these compare with the pull of the loads."""
    unit = unit_of(result.model.units.force)
    for joint in joints(result):
        size = max(abs(joint["preload"]), abs(joint["reaction"]))
        sums = (f"{name} {number(joint[name], size)}{unit}" for name in ("preload", "reaction"))
        yield f"{' + '.join(joint['supports'])}: {joint['bolts']} bolts, sum of {', of '.join(sums)}"
    for index, values in enumerate(result.supports):
        if values.preloads is not None and not np.isnan(values.prying):
            times = cell(values.prying, widths, ("supports", index, "prying"))
            yield f"{values.name}: their force is {times} times the pull of the loads"


def lifted(result: Result) -> str:
    """Say which corners of the plate have lifted off what they touched at rest, and how far; empty if none has.

    From w = 0, or from where the support has raised it: a support that settles from the plate lifts nothing.
    """
    if result.plates:
        each = {name: lifted(plate) for name, plate in result.plates.items()}
        return "; ".join(f"{name}: {sentence}" for name, sentence in each.items() if sentence)
    nodes = _corners(result)
    at, down = result.mesh.points[nodes], result.deflection[nodes]
    lifts = np.full(len(nodes), np.inf)
    for support, values in zip(result.model.support, result.supports, strict=True):
        if support.resists == "down" and support.between is None:
            free = np.minimum(support.settlement(*at.T), 0.0) - down
            touching = _holds(result, support, values, at) & (support.gap(*at.T) == 0.0)
            lifts = np.where(touching, np.minimum(lifts, free), lifts)
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
        return support.where.covers(at)
    places = [result.mesh.points[result.mesh.edges[name][:, (0, 2)].ravel()] for name in support.where.edges]
    every = np.concatenate([values.positions, *places])
    away = np.hypot(*(at[:, None] - every).transpose(2, 0, 1))
    return np.asarray((away <= _SAME * result.mesh.size).any(axis=1))


_WIDE = 0.5
"""Half-width over its number from which on it is wide."""
_BESIDE = 4.0
"""Elements beside a place without a limit in which other meshes have other values: two of those twice as large."""
_LITTLE = 0.25
"""Part of the largest moment or shear, of any direction, up to which it is not worth a finer mesh."""
_STRIP = 1e-3
"""Part of the plate's size: moments p ℓ² and shears p ℓ of a strip so wide, under the mean pressure p, are nothing."""


def too_wide(results: Results, estimates: Estimates | None) -> Iterator[str]:
    """Say of which largest moments and shears the half-width is more than half of the number, and what helps."""
    result: dict[str, tuple[float, str]] = {}
    size = results.discretisation.mesh.size
    for fields, widths, force in _fields(results, estimates):
        nothing = {"moment": _STRIP**2 * force, "shear": _STRIP * force / size}
        ends = {name: max(SIDES, key=lambda end: abs(fields[name][end])) for name in RESULTANTS if name in fields}
        for name in ends:
            value, width = abs(fields[name][ends[name]]), widths[name][ends[name]]
            alike = [abs(fields[one][ends[one]]) for one in ends if FIELDS[one].kind == FIELDS[name].kind]
            place = fields[name][f"{ends[name]}_at"]
            if width is None or any(_near(one, place) for one in results.discretisation.each):
                continue
            if width > max(_WIDE * value, _LITTLE * max(alike), nothing[FIELDS[name].kind]):
                part = width / value if value else float("inf")
                result[name] = max(result.get(name, (0.0, "")), (part, point(place, size)))
    if not result:
        return
    where = ", ".join(f"{name} at {at}" for name, (_, at) in result.items())
    helps = "Take smaller elements there (mesh.refine), or put a probe there and give mesh.accuracy = 0.05."
    if results.model.plates or isinstance(results.model.plate, MeshPlate):
        helps = "Make the mesh finer there."
    yield f"± is more than half of the largest {where}: the mesh leaves open what it is. {helps}"


def _near(discretisation: Discretisation, at: Sequence[float]) -> bool:
    """Whether a place is beside one where moments or shears have no limit, which is named by itself."""
    place = np.array([at])
    where = discretisation.mesh.locate(place)
    if not where.inside.all():
        return False
    reach = _BESIDE * float(np.sqrt(discretisation.mesh.element_area[where.elements[0]]))
    named = [one for one in singularities(discretisation) if {"moment", "shear"} & set(one.numbers) and not one.limited]
    return any(away(place, one)[0] <= one.within + reach for one in named)


def _fields(
    results: Results, estimates: Estimates | None
) -> Iterator[tuple[Mapping[str, Any], Mapping[str, Any], float]]:
    """Largest and smallest moments and shears, their half-widths and the force that acts, of a combination or table."""
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
    """The largest sum of the reactions of all supports over the rows of a table, from above."""
    of, catalogue = results.combined.envelope.values, results.combined.layout.catalogue
    most = np.fmax(np.abs(of.largest), np.abs(of.smallest))
    if results.model.plates:
        return float(most[catalogue.at("support", "reaction")].sum())
    return float(sizes_of(most[:, None], catalogue.numbers, results.model, results.discretisation.mesh)["reaction"][0])
