"""Points on a border where areas only touch: each belongs to one of them, so that pressures do not count twice."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from signorini.discretise.rows import Bools, Floats
from signorini.results.contact_field.area_contact import AreaContact

_STEP = 1e-6
"""Part of the plate's size by which a look goes beside a point: more than what counts as on an outline."""
_WAYS = np.array([(np.cos(turn), np.sin(turn)) for turn in np.pi / 8 * (2 * np.arange(8) - 6.6)])
"""Directions in which one looks, along no usual outline."""


def without_shared_borders(areas: Sequence[AreaContact], positions: Floats, on: Bools) -> Bools:
    """Which areas (a,) act at positions (q, 2), given those that a position is in or on the border of: (a, q).

    Of areas that have a position on their border those act that are beside it in the first of some directions in which
    there is any. So one acts where two touch, and both where they overlap.
    """
    several = np.flatnonzero(on.sum(axis=0) > 1)
    if not len(several):
        return on
    result, places = on.copy(), positions[several]
    step = _STEP * areas[0].mesh.size
    border = on[:, several] & np.array([area.depth(places) < 0.5 * step for area in areas])
    left = border.sum(axis=0) > 1
    for way in _WAYS:
        if not left.any():
            break
        beside = np.zeros_like(border)
        beside[:, left] = border[:, left] & np.array([area.depth(places[left] + step * way) >= 0 for area in areas])
        settled = beside.any(axis=0)
        result[:, several[settled]] &= beside[:, settled] | ~border[:, settled]
        left &= ~settled
    return result
