"""A plate seen from above at an angle, its deflections exaggerated: places of the picture, without matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from signorini.shapes.arrays import Floats
from signorini.shapes.tessellation import tessellate

_TURNED, _RAISED = np.radians(30.0), np.radians(35.0)
"""By how much the plan is turned, and how far above the plate the eye is."""
AXES: Final = np.array([[np.cos(_TURNED), np.sin(_TURNED)], [-np.sin(_TURNED), np.cos(_TURNED)]]) * [1, np.sin(_RAISED)]
"""Where lengths along x and along y lead in the picture (2, 2)."""
_DOWN = np.array([0.0, -np.cos(_RAISED)])
_TALLEST = 0.15
"""Part of the plate's size that the largest deflection is drawn with."""
_UPRIGHT = 0.9
"""Share of the largest factor, at which a part of the plate hides another."""


def seen(places: Floats, deflection: Floats | float = 0.0, factor: float = 1.0) -> Floats:
    """Where places (k, 2) of the plate are in the picture (k, 2), exaggerated deflections (k,) below where they were.

    Examples
    --------
    >>> seen(np.array([[1.0, 0.0]]), np.array([0.01]), 50.0).round(3).tolist()
    [[0.866, -0.123]]
    """
    return np.asarray(places @ AXES + factor * np.reshape(deflection, (-1, 1)) * _DOWN)


def exaggeration(points: Floats, elements: NDArray[np.int64], deflections: Sequence[Floats]) -> float:
    """Choose one factor for deflections (n,) at nodes (n, 2): no part of the plate is to hide another.

    Examples
    --------
    >>> points = np.array([[0, 0], [4, 0], [4, 2], [0, 2], [2, 0], [4, 1], [2, 2], [0, 1]], float)
    >>> exaggeration(points, np.arange(8)[None], [1e-3 * points[:, 0]])
    150.0
    """
    largest = max(float(np.abs(one).max()) for one in deflections)
    if not largest:
        return 1.0
    factor = _TALLEST * float(np.ptp(points, axis=0).max()) / largest
    cut = tessellate(elements)

    def areas(places: Floats) -> Floats:
        a, b, c = np.moveaxis(cut.interpolate(places)[cut.triangles], 1, 0)
        (x, y), (u, v) = (b - a).T, (c - a).T
        return np.asarray(x * v - y * u)

    level = areas(seen(points))
    for one in deflections:
        # The area of an element in the picture is linear in the factor; it is negative where the element is hidden.
        change = areas(seen(points, one)) - level
        turning = change < 0.0
        factor = min(factor, _UPRIGHT * float((level[turning] / -change[turning]).min(initial=np.inf)))
    return float(f"{factor:.2g}")
