"""The axes along which a plate is meshed, so that mirrored and turned plates have mirrored and turned meshes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Axes: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
"""Two unit vectors, along x and y in either order and sense."""

ALONG_X: Axes = ((1.0, 0.0), (0.0, 1.0))
_AXES: tuple[Axes, ...] = tuple(
    axes for u, v in product((1.0, -1.0), repeat=2) for axes in (((u, 0.0), (0.0, v)), ((0.0, u), (v, 0.0)))
)
_GRID = 2.0**-30
"""Part of the plate's extent below which coordinates are the same: far more than rounding of numbers in any unit."""


def axes_of(places: Sequence[Floats]) -> Axes:
    """Choose the axes along which places reach farthest, by the second coordinate and then the first.

    Parameters
    ----------
    places : sequence of (k, 2) float array
        Points of the outline, then of each thing on the plate, those of the first thing first. Points of one thing have
        no order.

    Returns
    -------
    Axes
        Of equals the first, x and y before all others: along either of them the plate is the same.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    >>> axes_of([square]), axes_of([square, np.array([[1.0, 2.0]])])
    (((1.0, 0.0), (0.0, 1.0)), ((0.0, 1.0), (-1.0, 0.0)))
    """
    low, high = places[0].min(axis=0), places[0].max(axis=0)
    points = np.rint((np.concatenate(places) - 0.5 * (low + high)) / (_GRID * (high - low).max()))
    thing = np.repeat(np.arange(len(places)), [len(some) for some in places])

    def along(axes: Axes) -> list[list[float]]:
        first, second = np.array(axes) @ points.T
        order = np.lexsort((-first, -second, thing))
        return np.column_stack([second[order], first[order]]).tolist()  # type: ignore[no-any-return]

    return max(_AXES, key=along)
