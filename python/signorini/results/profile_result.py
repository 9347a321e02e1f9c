"""What lines and circles across the plate show."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from signorini.discretise.rows import Bools, Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.mesh import Location, Mesh
from signorini.model.output import Profile
from signorini.results.probe_result import fields_at, total_pressure
from signorini.results.support_result import SupportResult

PRESSURE = "pressure"


@dataclass(frozen=True, eq=False)
class ProfileResult:
    """Fields along a line, at its stations (k,); where moments and shears jump, of each the side where it is larger.

    Parameters
    ----------
    name : str
    distance : (k,) array
        From the beginning of the line.
    at : (k, 2) array
    values : dict of (k,) arrays
        Every field by name, and the pressure of area supports, positive up; NaN off the plate, or where there is none.
    """

    name: str
    distance: Floats
    at: Floats
    values: Mapping[str, Floats]

    def rows(self) -> Iterator[dict[str, Any]]:
        """Give a row a station, by column; None where there is no number."""
        columns = {"distance": self.distance, "x": self.at[:, 0], "y": self.at[:, 1], **self.values}
        for row in zip(*(column.tolist() for column in columns.values()), strict=True):
            yield {name: None if np.isnan(value) else value for name, value in zip(columns, row, strict=True)}


def profile_results(
    profiles: Sequence[Profile],
    fields: Mapping[str, Floats],
    nodes: StressNodes,
    supports: Sequence[SupportResult],
) -> tuple[ProfileResult, ...]:
    """Interpolate fields, (n,) or (s,), to the stations of profiles."""
    table = np.column_stack([nodes.spread(values) for values in fields.values()])
    result = []
    for profile in profiles:
        distance, at = profile.places
        where, on = stations(nodes.mesh, at)
        values = np.full((len(at), len(fields) + 1), np.nan)
        values[on, :-1] = fields_at(table, nodes, where, at[on])
        values[on, -1] = total_pressure(supports, where)
        result.append(ProfileResult(profile.name, distance, at, dict(zip((*fields, PRESSURE), values.T, strict=True))))
    return tuple(result)


def stations(mesh: Mesh, at: Floats) -> tuple[Location, Bools]:
    """Find those of some points (k, 2) that are on the plate, and which these are."""
    where = mesh.locate(at)
    return Location(where.elements[where.inside], where.xi[where.inside]), where.inside
