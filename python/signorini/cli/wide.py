"""What to do where half-widths are wide, in a sentence."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from signorini.accuracy.half_width import away
from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.discretise import Discretisation
from signorini.errors import point
from signorini.model import MeshPlate
from signorini.output.envelope_json import envelope_json
from signorini.results.figures import figures
from signorini.results.quantities import FIELDS, RESULTANTS, SIDES
from signorini.singularities.named import singularities

_WIDE = 0.5
"""Half-width over its number from which on it is wide."""
_BESIDE = 4.0
"""Elements beside a place without a limit in which other meshes have other values: two of those twice as large."""
_LITTLE = 0.25
"""Part of the largest moment or shear, of any direction, up to which it is not worth a finer mesh."""


def too_wide(results: Results, estimates: Estimates | None) -> Iterator[str]:
    """Say of which largest moments and shears the half-width is more than half of the number, and what helps."""
    result: dict[str, tuple[float, str]] = {}
    for fields, widths in _fields(results, estimates):
        ends = {name: max(SIDES, key=lambda end: abs(fields[name][end])) for name in RESULTANTS if name in fields}
        for name in (name for name in RESULTANTS if name in ends):
            value, width = abs(fields[name][ends[name]]), widths[name][ends[name]]
            alike = [
                abs(fields[one][ends[one]])
                for one in ends
                if one in RESULTANTS and FIELDS[one].kind == FIELDS[name].kind
            ]
            if width is None or _near(results.discretisation, fields[name][f"{ends[name]}_at"]):
                continue
            if width > max(_WIDE * value, _LITTLE * max(alike)):
                part = width / value if value else float("inf")
                at = point(fields[name][f"{ends[name]}_at"], results.discretisation.mesh.size)
                result[name] = max(result.get(name, (0.0, "")), (part, at))
    if not result:
        return
    where = ", ".join(f"{name} at {at}" for name, (_, at) in result.items())
    helps = "Take smaller elements there (mesh.refine), or put a probe there and give mesh.accuracy = 0.05."
    if isinstance(results.model.plate, MeshPlate):
        helps = "Make the mesh finer there."
    yield f"± is more than half of the largest {where}: the mesh leaves open what it is. {helps}"


def _near(discretisation: Discretisation, at: Sequence[float]) -> bool:
    """Whether a place is beside one where moments or shears have no limit, which is named by itself."""
    place = np.array([at])
    reach = _BESIDE * float(np.sqrt(discretisation.mesh.element_area[discretisation.mesh.locate(place).elements[0]]))
    named = [one for one in singularities(discretisation) if {"moment", "shear"} & set(one.numbers) and not one.limited]
    return any(away(place, one)[0] <= one.within + reach for one in named)


def _fields(results: Results, estimates: Estimates | None) -> Iterator[tuple[Mapping[str, Any], Mapping[str, Any]]]:
    """Largest and smallest moments and shears with their half-widths, of every combination or of a table."""
    if results.model.tabulated:
        values = envelope_json(results, estimates)
        if values is not None and values["plus_minus"] is not None:
            yield (
                {name: values["fields"][name] for name in RESULTANTS if name in values["fields"]},
                values["plus_minus"]["fields"],
            )
        return
    for result in results.full.values():
        widths = None if estimates is None else estimates[result.name].plus_minus
        if result.status == "solved" and widths is not None:
            yield figures(result)["fields"], widths["fields"]
