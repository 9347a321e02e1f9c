"""Elements whose shape double precision cannot cope with: which one, why, and what would help."""

from __future__ import annotations

import numpy as np

from signorini.discretise import Discretisation
from signorini.errors import point

_LONG = 1000.0
"""Ratio of an element's sides up to which every ribbon of benchmarks/ribbons.py is certified, whatever its thickness:
bending across is stiffer by its fourth power, and of sixteen digits four are left."""
_THIN = 1e-4
"""Thickness over the plate's size below which forces from the matrices of q8r are rounding."""


def of_shape(found: Discretisation) -> str:
    """Say which element is too long for double precision, and what to do; empty if none is."""
    mesh = found.mesh
    corners = mesh.points[mesh.elements[:, :4]]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    lengths = np.linalg.norm(middles[:, [1, 2]] - middles[:, [3, 0]], axis=2)
    of = mesh.triangles
    longest = np.linalg.norm(corners[of] - np.roll(corners[of], -1, axis=1), axis=2).max(axis=1)
    lengths[of] = np.column_stack([longest, 2.0 * mesh.element_area[of] / longest])
    ratio = lengths.max(axis=1) / lengths.min(axis=1)
    worst = int(ratio.argmax())
    thickness = np.broadcast_to(found.thickness.at_points, (len(mesh.elements), found.thickness.at_points.shape[1]))
    place = point(corners[worst].mean(axis=0))
    if ratio[worst] > _LONG:
        long, short = np.sort(lengths[worst])[::-1]
        # A ratio that only rounding puts past a whole number is that number.
        times = int(np.ceil((1 - 1e-9) * ratio[worst] / _LONG))
        return (
            f"Double precision cannot tell bending of the element at {place}, whose sides are "
            f"{long:.6g} and {short:.6g} ({ratio[worst]:.6g} to 1) at a thickness of {thickness[worst].min():.6g}: "
            "bending across it is stiffer by the fourth power of that ratio. Take elements at most "
            f"{_LONG:g} times as long as they are wide: {times} times as many along "
            "their longer sides, or fewer across; or calculate a beam."
        )
    slenderness = thickness.min(axis=1) / mesh.size
    worst = int(slenderness.argmin())
    place = point(corners[worst].mean(axis=0))
    if found.model.plate.element == "q8r" and slenderness[worst] < _THIN:
        return (
            f"Double precision cannot tell bending of the q8r element at {place}, "
            f"{1 / slenderness[worst]:.7g} times as thin as the plate is long: its matrix is all shear. Take element = "
            f'"mitc9", or a thickness of {_THIN * mesh.size:.6g} or more.'
        )
    return ""
