"""How far supports are closed: their points, and the true length or contact area of lines and areas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signorini.contact.answer import Answer
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats
from signorini.model import Support
from signorini.results.contact_field.law import free_travel, overlap
from signorini.results.support_points import SupportPoints
from signorini.results.support_result import area_at_rest

LEVELS = (1.0, 0.75, 0.5, 0.25, 0.0)
"""Parts of a line or area that are closed at its events: it begins to open, three quarters, all of it is open."""
WHOLE = 1e-12
"""Part of a support that is none."""
_TOUCHING = 1e-9
"""Part of the largest overlap below which the plate touches and does not part, as for contact areas."""


@dataclass(frozen=True)
class Scales:
    """What reactions and lengths are divided by where both are on one scale of how far a point is closed or open."""

    force: float
    length: float

    @classmethod
    def of(cls, answer: Answer) -> Scales:
        """Take the largest reaction and travel of an answer."""
        force = float(np.abs(answer.shared).max(initial=0.0))
        length = max(float(np.abs(one).max(initial=0.0)) for one in (answer.gap, answer.hi[::3]))
        return cls(force or 1.0, length or 1.0)


def margins(found: Discretisation, index: int, answer: Answer, scales: Scales, part: float) -> Floats:
    """How far a support is from each of its events: not negative where it is closed, or its part that is closed enough.

    Of a support at points (p,) one a point; of a line or area (5,) one a level. Continuous in t along a load path.
    ``part`` is its `closed_part`.
    """
    support, points = found.model.support[index], SupportPoints.of(found, index)
    own = _of_points(found, points, answer, scales)
    if support.place == "at":
        return own
    if support.area is None or (at_rest := area_at_rest(found, index)).on_means:
        return _of_parts(own, points.weights, between=support.area is None)
    deflection = (answer.hi + answer.lo)[::3]
    nodes = np.flatnonzero(at_rest.on_nodes)
    at_nodes = overlap(support, deflection[nodes], free_travel(support, found.mesh.points[nodes]))
    pressed = np.append(own * scales.length, at_nodes[~np.isnan(at_nodes)])
    touching = _TOUCHING * np.abs(pressed).max(initial=0.0)
    ends = (pressed.min() + touching) / scales.length, (pressed.max() - touching) / scales.length
    return np.array([ends[0], *(part - level for level in LEVELS[1:-1]), ends[1]])


def closed_part(support: Support, points: SupportPoints, closed: Bools, margin: Floats, area: float) -> float:
    """The part of a support that is closed: of points as many, of lines by length, of areas by contact area."""
    whole = float(points.weights.sum())
    if not len(points.weights) or not whole > 0:
        return 1.0
    if support.area is not None:
        return float(np.clip(area / whole, 0.0, 1.0))
    if support.place == "at":
        return float(points.weights[closed].sum() / whole)
    if (margin >= 0).all() or (margin < 0).all():
        return float(margin[0] >= 0)
    values, middles = _sorted(margin, points.weights)
    last = int(np.flatnonzero(values >= 0)[-1])
    share = values[last] / (values[last] - values[last + 1])
    return float(middles[last] + share * (middles[last + 1] - middles[last]))


def of_points(found: Discretisation, index: int, answer: Answer) -> Floats:
    """How far each point (p,) of a support is closed, or where negative open, on a scale of its own."""
    return _of_points(found, SupportPoints.of(found, index), answer, Scales.of(answer))


def _of_points(found: Discretisation, points: SupportPoints, answer: Answer, scales: Scales) -> Floats:
    """How far each point (p,) is closed: overlap where elastic, reaction where rigid; where negative the gap."""
    contacts = found.contacts
    soft = contacts.compliance > 0
    pressing = np.where(soft, contacts.compliance * answer.reaction / scales.length, answer.reaction / scales.force)
    rows = np.where(answer.closed, np.maximum(pressing, 0.0), np.minimum(-answer.gap / scales.length, -1e-300))
    rows = np.where(contacts.two_sided, 1.0, rows)
    rows = np.append(rows, np.ones(max(0, int(points.rows.max(initial=-1)) + 1 - len(rows))))
    own = rows[points.rows].max(axis=0, initial=-np.inf)
    if points.shares is not None:
        own = np.maximum.reduceat(own[points.shares.indices], points.shares.indptr[:-1])
    return np.asarray(np.concatenate([np.ones(points.fixed), own])[points.order])


def _of_parts(own: Floats, weights: Floats, between: bool) -> Floats:
    """Margins (5,) at which a part of points (p,) is closed by weight; ``between`` them linear in it, as on a line."""
    if not len(own):
        return np.ones(len(LEVELS))
    if between:
        values, middles = _sorted(own, weights)
        amid = np.interp(LEVELS[1:-1], middles, values)
    else:
        order = np.argsort(-own, kind="stable")
        reached = np.cumsum(weights[order]) / weights.sum()
        amid = own[order][np.searchsorted(reached, np.array(LEVELS[1:-1]) - WHOLE).clip(0, len(own) - 1)]
    return np.array([own.min(), *amid, own.max()])


def _sorted(own: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Values in falling order, and the middles of their weights, one behind the other, of the whole."""
    order = np.argsort(-own, kind="stable")
    sorted_weights = weights[order] / weights.sum()
    return own[order], np.cumsum(sorted_weights) - 0.5 * sorted_weights
