"""Where a field is largest, whatever rounding says among places that are alike."""

from __future__ import annotations

import numpy as np

from signorini.discretise.rows import Floats

_ALIKE = 1e-9
"""Part of a field's size, and of the plate's, within which values, and coordinates, differ by rounding."""


def peak(values: Floats, places: Floats) -> int:
    """Which of values (n,) is the largest; of those alike but for rounding that at the least x, and then y.

    Places are (n, 2). Values of minus infinity do not count.

    Examples
    --------
    >>> peak(np.array([1.0, 3.0 - 1e-12, 3.0]), np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 1.0]]))
    1
    """
    size = float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
    near = np.flatnonzero(values >= values.max() - _ALIKE * size)
    x, y = np.round((places[near] - places.min(axis=0)) / max(float(np.ptp(places, axis=0).max()), 1e-300), 9).T
    return int(near[np.lexsort((y, x))[0]])
