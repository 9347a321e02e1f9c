"""Which held nodes, springs and contact points are each support's, in the order of the input."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signorini.discretise.frames import Held
from signorini.discretise.rows import Ints
from signorini.discretise.supports import ContactPoints, Springs


@dataclass(frozen=True, eq=False)
class Parts:
    """What is one support's, by number.

    Parameters
    ----------
    nodes, springs : (h,) and (s,) arrays
        Nodes whose deflection it holds, and its springs.
    rows : (ways, c) array
        Its contact points that hold no slope; a point with travel both ways has two, the first pushing the plate up.
    order : (h + s + c,) array
        From nodes, springs and contact points, one behind the other, to the order of the input.
    """

    nodes: Ints
    springs: Ints
    rows: Ints
    order: Ints


def parts_of(count: int, held: Held, springs: Springs, points: ContactPoints) -> tuple[Parts, ...]:
    """Part what acts among so many supports."""
    columns = zip(
        _grouped(held.holders[:, 1], count),
        _grouped(springs.support, count),
        _grouped(np.where(points.slope, count, points.support), count),
        strict=True,
    )
    result = []
    for holding, own, mine in columns:
        rows = _by_ways(mine, points)
        given = np.concatenate([held.numbers[holding], springs.numbers[own], points.numbers[rows[0]]])
        result.append(Parts(held.holders[holding, 0], own, rows, np.argsort(given, kind="stable")))
    return tuple(result)


def _by_ways(mine: Ints, points: ContactPoints) -> Ints:
    """Rows (ways, c) of a support: where it has travel both ways, one behind the other those of one point."""
    up = points.direction[mine] > 0
    if up.all() or not up.any():
        return mine.reshape(1, -1)
    return np.stack([mine[up], mine[~up]])


def _grouped(owner: Ints, count: int) -> list[Ints]:
    """Numbers of the entries of each of so many owners, in order; of any others none."""
    order = np.argsort(owner, kind="stable")
    return np.split(order, np.searchsorted(owner[order], np.arange(1, count + 1)))[:count]
