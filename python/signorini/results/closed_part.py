"""How far the points of a support are closed, and what part of it is: by true length, or contact area."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signorini.contact.selection import Answer
from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats
from signorini.results.support_points import SupportPoints


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


def closed_part(discretisation: Discretisation, index: int, answer: Answer, area: float) -> float:
    """The part of a support that is closed: of points as many, of lines by length, of areas by contact ``area``.

    The edge of contact on a line is between two of its points, where a straight line between them has it.
    """
    support, points = discretisation.model.support[index], SupportPoints.of(discretisation, index)
    whole = float(points.weights.sum())
    if not len(points.weights) or not whole > 0:
        return 1.0
    if support.area is not None:
        return float(np.clip(area / whole, 0.0, 1.0))
    if support.place == "at":
        return float(points.weights[points.closed(answer.closed)].sum() / whole)
    values, middles = in_falling_order(
        closed_by_point(discretisation, points, answer, Scales.of(answer)), points.weights
    )
    if values[0] < 0 or values[-1] >= 0:
        return float(values[0] >= 0)
    last = int(np.flatnonzero(values >= 0)[-1])
    share = values[last] / (values[last] - values[last + 1])
    return float(middles[last] + share * (middles[last + 1] - middles[last]))


def closed_by_point(discretisation: Discretisation, points: SupportPoints, answer: Answer, scales: Scales) -> Floats:
    """How far each point (p,) is closed: overlap where elastic, reaction where rigid; where negative the gap."""
    contacts = discretisation.contacts
    soft = contacts.compliance > 0
    pressing = np.where(soft, contacts.compliance * answer.reaction / scales.length, answer.reaction / scales.force)
    rows = np.where(answer.closed, np.maximum(pressing, 0.0), np.minimum(-answer.gap / scales.length, -1e-300))
    rows = np.where(contacts.two_sided, 1.0, rows)
    rows = np.append(rows, np.ones(max(0, int(points.rows.max(initial=-1)) + 1 - len(rows))))
    own = rows[points.rows].max(axis=0, initial=-np.inf)
    if points.shares is not None:
        own = np.maximum.reduceat(own[points.shares.indices], points.shares.indptr[:-1])
    return np.asarray(np.concatenate([np.ones(points.fixed), own])[points.order])


def in_falling_order(own: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Values in falling order, and the middles of their weights, one behind the other, of the whole."""
    order = np.argsort(-own, kind="stable")
    sorted_weights = weights[order] / weights.sum()
    return own[order], np.cumsum(sorted_weights) - 0.5 * sorted_weights
