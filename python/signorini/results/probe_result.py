"""What points of the plate show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from signorini.discretise.rows import Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.mesh import Location
from signorini.results.contact_field import without_shared_borders
from signorini.results.formulas import design_moments, face_stresses, principal_moments, shear_stresses
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
    thickness : float
        Of a solid plate, where it jumps that of the thinner side; NaN where a stiffness is given in its place.
    """

    at: tuple[float, float]
    deflection: float
    rotation: tuple[float, float]
    moment: tuple[float, float, float]
    shear: tuple[float, float]
    pressure: float | None

    thickness: float

    @property
    def principal_moment(self) -> tuple[float, float, float]:
        """Principal moments m1 ≥ m2, and the angle from x to the direction of m1, in degrees towards y.

        Examples
        --------
        >>> ProbeResult((0, 0), 0, (0, 0), (3.0, 3.0, 1.0), (0, 0), None, 1.0).principal_moment
        (4.0, 2.0, 45.0)
        """
        m1, m2, angle = principal_moments(np.array(self.moment)).tolist()
        return m1, m2, angle

    @property
    def design_moment(self) -> dict[str, tuple[float, float]]:
        """Moments along x and y for which reinforcement along them is designed: bottom ≥ 0, top ≤ 0.

        By `signorini.results.formulas.design_moments` (Wood 1968, Armer 1968).
        """
        bottom_x, bottom_y, top_x, top_y = design_moments(np.array(self.moment)).tolist()
        return {"bottom": (bottom_x, bottom_y), "top": (top_x, top_y)}

    @property
    def stress(self) -> dict[str, tuple[float, ...]]:
        """Stresses of a solid plate, tension positive: σx, σy, τxy at "top" and "bottom", "von_mises" there, "shear".

        Shear is τxz, τyz at mid-depth. All NaN where a stiffness is given in place of a solid section.

        Examples
        --------
        >>> ProbeResult((0, 0), 0, (0, 0), (3.0, 0.0, 0.0), (0, 4.0), None, 2.0).stress["bottom"]
        (4.5, 0.0, 0.0)
        """
        thickness = np.array(self.thickness)
        values = face_stresses(np.array(self.moment), thickness).tolist()
        shear = shear_stresses(np.array(self.shear), thickness).tolist()
        return {
            "top": tuple(values[:3]),
            "bottom": tuple(values[3:6]),
            "von_mises": tuple(values[6:]),
            "shear": tuple(shear),
        }


def probe_results(
    fields: Floats,
    nodes: StressNodes,
    thickness: Floats,
    supports: Sequence[SupportResult],
    where: Location,
    positions: Floats,
) -> list[ProbeResult]:
    """Interpolate fields (s, 8) and the thickness (s,) to positions (q, 2), and ask for the pressure there."""
    if not len(positions):
        return []
    sides = nodes.sides(positions, where)
    values = nodes.mesh.shape_functions(sides.where.elements, sides.where.xi)
    elements = nodes.elements[sides.where.elements]
    at_points = sides.larger(np.einsum("qi,qif->qf", values, fields[elements]))
    pressures = total_pressure(supports, where).tolist()
    return [
        ProbeResult((x, y), v[0], (v[1], v[2]), (v[3], v[4], v[5]), (v[6], v[7]), None if np.isnan(p) else p, h)
        for (x, y), v, p, h in zip(
            positions.tolist(),
            at_points.tolist(),
            pressures,
            sides.least(np.einsum("qi,qi->q", values, thickness[elements])).tolist(),
            strict=True,
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
    result = np.array([area.pressure(where.elements, where.xi) for area in areas])
    positions = areas[0].mesh.map(where.elements, where.xi)
    on = without_shared_borders(areas, positions, ~np.isnan(result))
    return np.where(on.any(axis=0), np.where(on, result, 0.0).sum(axis=0), np.nan)
