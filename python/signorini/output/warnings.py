"""All warnings of results, for the terminal, results.json and the report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from signorini.accuracy.half_width import away, largest_of, sizes_of
from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.discretise import Discretisation
from signorini.errors import point
from signorini.model import MeshPlate
from signorini.output.envelope_json import envelope_json, table_warnings
from signorini.results.figures import figures
from signorini.results.quantities import FIELDS, RESULTANTS, SIDES
from signorini.singularities.named import singularities

_WIDE = 0.5
"""Largest ratio of a half-width to its number for which there is no warning."""
_NEAR = 4.0
"""Distance from a singularity, in element sizes, within which values depend on the mesh. It equals two elements of the
coarser compared mesh, which has elements of double size.
"""
_MINOR = 0.25
"""Largest ratio of a half-width to the largest moment (or shear) of all directions for which there is no warning."""
_STRIP = 1e-3
"""Width ℓ of a strip, relative to the plate's size. Moments up to p ℓ² and shears up to p ℓ under the mean pressure p
count as zero.
"""


def warnings_of(results: Results, estimates: Estimates | None) -> dict[str, list[str]]:
    """Warnings with the names of the combinations to which each applies; an empty list if it applies to all."""
    of_table = [*table_warnings(results, estimates)] if results.model.tabulated else []
    warned: dict[str, list[str]] = {}
    for result in results.full.values():
        of_mesh = () if estimates is None else estimates[result.name].warnings
        for sentence in (*result.warnings, *of_mesh):
            warned.setdefault(sentence, []).append(result.name)
    every = {sentence: [] if len(names) == len(results) else names for sentence, names in warned.items()}
    whole = (*of_table, *_too_wide(results, estimates), *filter(None, (results.accuracy_warning,)))
    return every | {sentence: [] for sentence in whole}


def _too_wide(results: Results, estimates: Estimates | None) -> Iterator[str]:
    """Yield a warning, with a remedy, if half-widths exceed half of the largest moments or shears."""
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
    """Whether a point is near a singularity of moments or shears, which is then reported in place of the half-width."""
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
    """Yield extremes of moments and shears, their half-widths and the largest force: by combination, or of a table."""
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
