"""What points of the plate show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from signorini import _core
from signorini.discretise.rows import Floats
from signorini.mesh import Location, Mesh
from signorini.results.support_result import SupportResult


@dataclass(frozen=True)
class ProbeResult:
    """What a point of the plate shows.

    Parameters
    ----------
    at : (x, y)
    deflection : float
    rotation : (θx, θy)
    moment : (mx, my, mxy)
    shear : (qx, qy)
    pressure : float or None
        Contact pressure of the area supports there, positive up; None where there is none.
    """

    at: tuple[float, float]
    deflection: float
    rotation: tuple[float, float]
    moment: tuple[float, float, float]
    shear: tuple[float, float]
    pressure: float | None


def probe_results(
    fields: Floats, mesh: Mesh, supports: Sequence[SupportResult], where: Location, positions: Floats
) -> list[ProbeResult]:
    """Interpolate nodal fields (n, 8), in the order of `ProbeResult`, to positions (q, 2), and ask for the pressure."""
    if not len(positions):
        return []
    values, _ = _core.serendipity(where.xi)
    at_points = np.einsum("qi,qif->qf", values, fields[mesh.elements[where.elements]])
    return [
        ProbeResult((x, y), v[0], (v[1], v[2]), (v[3], v[4], v[5]), (v[6], v[7]), None if np.isnan(p) else p)
        for (x, y), v, p in zip(
            positions.tolist(), at_points.tolist(), total_pressure(supports, where).tolist(), strict=True
        )
    ]


def total_pressure(supports: Sequence[SupportResult], where: Location) -> Floats:
    """Sum (q,) of the pressures of area supports; NaN where none is."""
    total = np.full(len(where.elements), np.nan)
    for support in supports:
        if support.area is not None:
            found = support.area.pressure(where.elements, where.xi)
            total = np.where(np.isnan(found), total, np.nan_to_num(total) + found)
    return total
