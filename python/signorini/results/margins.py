"""How far supports are from the named events of a load path."""

from __future__ import annotations

import numpy as np

from signorini.contact.selection import Answer
from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats
from signorini.results.closed_part import Scales, closed_by_point, in_falling_order
from signorini.results.contact_field.law import free_travel, overlap
from signorini.results.support_points import SupportPoints
from signorini.results.support_result import area_at_rest

LEVELS = (1.0, 0.75, 0.5, 0.25, 0.0)
"""Parts of a line or area that are closed at its events: it begins to open, three quarters, all of it is open."""
WHOLE = 1e-12
"""Part of a support that is none."""
_TOUCHING = 1e-9
"""Part of the largest overlap below which the plate touches and does not part, as for contact areas."""


def margins(discretisation: Discretisation, index: int, answer: Answer, scales: Scales, part: float) -> Floats:
    """How far a support is from each of its events: not negative where it is closed, or its part that is closed enough.

    Of a support at points (p,) one a point; of a line or area (5,) one a level. Continuous in t along a load path.
    ``part`` is its `closed_part`.
    """
    support, points = discretisation.model.support[index], SupportPoints.of(discretisation, index)
    own = closed_by_point(discretisation, points, answer, scales)
    if support.place == "at":
        return own
    if support.area is None or (at_rest := area_at_rest(discretisation, index)).on_means:
        return _of_parts(own, points.weights, between=support.area is None)
    deflection = (answer.hi + answer.lo)[::3]
    nodes = np.flatnonzero(at_rest.on_nodes)
    at_nodes = overlap(support, deflection[nodes], free_travel(support, discretisation.mesh.points[nodes]))
    pressed = np.append(own * scales.length, at_nodes[~np.isnan(at_nodes)])
    touching = _TOUCHING * np.abs(pressed).max(initial=0.0)
    ends = (pressed.min() + touching) / scales.length, (pressed.max() - touching) / scales.length
    return np.array([ends[0], *(part - level for level in LEVELS[1:-1]), ends[1]])


def _of_parts(own: Floats, weights: Floats, between: bool) -> Floats:
    """Margins (5,) at which a part of points (p,) is closed by weight; ``between`` them linear in it, as on a line."""
    if not len(own):
        return np.ones(len(LEVELS))
    if between:
        values, middles = in_falling_order(own, weights)
        amid = np.interp(LEVELS[1:-1], middles, values)
    else:
        order = np.argsort(-own, kind="stable")
        reached = np.cumsum(weights[order]) / weights.sum()
        amid = own[order][np.searchsorted(reached, np.array(LEVELS[1:-1]) - WHOLE).clip(0, len(own) - 1)]
    return np.array([own.min(), *amid, own.max()])
