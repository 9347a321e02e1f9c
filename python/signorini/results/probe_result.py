"""What points of the plate show."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from signorini.discretise.rows import Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.mesh import Location
from signorini.results.contact_field import without_shared_borders
from signorini.results.support_result import SupportResult


@dataclass(frozen=True)
class ProbeResult:
    """What a point of the plate shows; where moments and shears jump, of each the side where it is larger in size.

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

    @property
    def principal_moment(self) -> tuple[float, float, float]:
        """Principal moments m1 ≥ m2, and the angle from x to the direction of m1, in degrees towards y.

        Examples
        --------
        >>> ProbeResult((0, 0), 0, (0, 0), (3.0, 3.0, 1.0), (0, 0), None).principal_moment
        (4.0, 2.0, 45.0)
        """
        mx, my, mxy = self.moment
        middle, radius = 0.5 * (mx + my), math.hypot(0.5 * (mx - my), mxy)
        return middle + radius, middle - radius, math.degrees(0.5 * math.atan2(2 * mxy, mx - my))

    @property
    def design_moment(self) -> dict[str, tuple[float, float]]:
        """Moments along x and y for which reinforcement along them is designed: bottom ≥ 0, top ≤ 0.

        R. H. Wood, *The reinforcement of slabs in accordance with a pre-determined field of moments*, Concrete 2
        (1968); G. S. T. Armer, discussion of it.

        Examples
        --------
        >>> ProbeResult((0, 0), 0, (0, 0), (3.0, 2.0, 1.0), (0, 0), None).design_moment
        {'bottom': (4.0, 3.0), 'top': (0.0, 0.0)}
        >>> ProbeResult((0, 0), 0, (0, 0), (4.0, -5.0, 2.0), (0, 0), None).design_moment
        {'bottom': (4.8, 0.0), 'top': (0.0, -6.0)}
        """
        mx, my, mxy = self.moment
        top = _sagging(-mx, -my, mxy)
        return {"bottom": _sagging(mx, my, mxy), "top": (0.0 - top[0], 0.0 - top[1])}


def _sagging(mx: float, my: float, mxy: float) -> tuple[float, float]:
    """Moments that bars at the bottom are designed for."""
    x, y = mx + abs(mxy), my + abs(mxy)
    if x < 0 and y < 0:
        return 0.0, 0.0
    if x < 0:
        return 0.0, max(0.0, my + mxy**2 / abs(mx))
    if y < 0:
        return max(0.0, mx + mxy**2 / abs(my)), 0.0
    return x, y


def probe_results(
    fields: Floats,
    nodes: StressNodes,
    supports: Sequence[SupportResult],
    where: Location,
    positions: Floats,
) -> list[ProbeResult]:
    """Interpolate fields (s, 8), in the order of `ProbeResult`, to positions (q, 2), and ask for the pressure."""
    if not len(positions):
        return []
    at_points = fields_at(fields, nodes, where, positions)
    return [
        ProbeResult((x, y), v[0], (v[1], v[2]), (v[3], v[4], v[5]), (v[6], v[7]), None if np.isnan(p) else p)
        for (x, y), v, p in zip(
            positions.tolist(), at_points.tolist(), total_pressure(supports, where).tolist(), strict=True
        )
    ]


def fields_at(fields: Floats, nodes: StressNodes, where: Location, positions: Floats) -> Floats:
    """Interpolate fields (s, f) to positions (q, 2): (q, f), of several sides the largest in size."""
    sides = nodes.sides(positions, where)
    values = nodes.mesh.shape_functions(sides.where.elements, sides.where.xi)
    return sides.larger(np.einsum("qi,qif->qf", values, fields[nodes.elements[sides.where.elements]]))


def total_pressure(supports: Sequence[SupportResult], where: Location) -> Floats:
    """Sum (q,) of the pressures of area supports, where they only touch that of one; NaN where none is."""
    areas = [support.area for support in supports if support.area is not None]
    if not areas:
        return np.full(len(where.elements), np.nan)
    found = np.array([area.pressure(where.elements, where.xi) for area in areas])
    positions = areas[0].mesh.map(where.elements, where.xi)
    on = without_shared_borders(areas, positions, ~np.isnan(found))
    return np.where(on.any(axis=0), np.where(on, found, 0.0).sum(axis=0), np.nan)
