"""Positions of points of a plate in an oblique view with magnified deflections, without matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from signorini.shapes.arrays import Floats
from signorini.shapes.tessellation import tessellate

_TURNED, _RAISED = np.radians(30.0), np.radians(35.0)
"""Angle by which the plan is turned, and angle of the line of sight above the plate [rad]."""
AXES: Final = np.array([[np.cos(_TURNED), np.sin(_TURNED)], [-np.sin(_TURNED), np.cos(_TURNED)]]) * [1, np.sin(_RAISED)]
"""Images (2, 2) in the picture of the unit vectors along x and y, a row each."""
_DOWN = np.array([0.0, -np.cos(_RAISED)])
_TALLEST = 0.15
"""Height of the largest deflection in the picture, relative to the plate's size."""
_UPRIGHT = 0.9
"""Largest magnification of deflections, relative to that at which a part of the plate is hidden."""


def seen(places: Floats, deflection: Floats | float = 0.0, factor: float = 1.0) -> Floats:
    """Positions in the picture (k, 2) of points (k, 2) of the plate with their deflections (k,) times ``factor``.

    Examples
    --------
    >>> seen(np.array([[1.0, 0.0]]), np.array([0.01]), 50.0).round(3).tolist()
    [[0.866, -0.123]]
    """
    return np.asarray(places @ AXES + factor * np.reshape(deflection, (-1, 1)) * _DOWN)


def exaggeration(points: Floats, elements: NDArray[np.int64], deflections: Sequence[Floats]) -> float:
    """Common magnification of several deflections (n,) at nodes (n, 2): no part of the plate hides another.

    Examples
    --------
    >>> points = np.array([[0, 0], [4, 0], [4, 2], [0, 2], [2, 0], [4, 1], [2, 2], [0, 1]], float)
    >>> exaggeration(points, np.arange(8)[None], [1e-3 * points[:, 0]])
    150.0
    """
    largest = max(float(np.abs(w).max()) for w in deflections)
    if not largest:
        return 1.0
    factor = _TALLEST * float(np.ptp(points, axis=0).max()) / largest
    cut = tessellate(elements)

    def areas(places: Floats) -> Floats:
        a, b, c = np.moveaxis(cut.interpolate(places)[cut.triangles], 1, 0)
        (x, y), (u, v) = (b - a).T, (c - a).T
        return np.asarray(x * v - y * u)

    level = areas(seen(points))
    for w in deflections:
        # An element's area in the picture is linear in the magnification; it is negative if the element is hidden.
        change = areas(seen(points, w)) - level
        turning = change < 0.0
        factor = min(factor, _UPRIGHT * float((level[turning] / -change[turning]).min(initial=np.inf)))
    return float(f"{factor:.2g}")
