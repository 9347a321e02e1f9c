"""Join straight lines of a drawing that lie partly on one another, as one line drawn in pieces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


def whole_lines(edges: Sequence[Any], gap: float) -> list[Any]:
    """Edges of a drawing; of straight ones that overlap, and end alone where they do, one from end to end.

    Parameters
    ----------
    edges : of ezdxf.edgeminer.Edge
    gap : float
        Distance of ends that count as one place, in the drawing's unit.
    """
    straight = [i for i, edge in enumerate(edges) if edge.payload is not None and edge.payload.dxftype() == "LINE"]
    if len(straight) < 2:
        return list(edges)
    ends = np.array([[(edge.start.x, edge.start.y), (edge.end.x, edge.end.y)] for edge in edges])
    alone = _alone(ends.reshape(-1, 2), gap).reshape(-1, 2)[straight]
    ends = ends[straight]
    gone, grown = np.zeros(len(straight), bool), np.zeros(len(straight), bool)
    waiting = [(int(i), int(side)) for i, side in np.argwhere(alone)]
    while waiting:
        i, side = waiting.pop()
        other = None if gone[i] else _beneath(i, side, ends, alone, gone, gap)
        if other is None:
            continue
        j, (a, b) = other, ends[other].copy()
        along = b - a
        part = (ends[i, 1 - side] - a) @ along / (along @ along)
        gone[i] = True
        if not 0.0 <= part <= 1.0:
            far = int(part > 1.0)
            ends[j, far], alone[j, far] = ends[i, 1 - side], alone[i, 1 - side]
            grown[j] = True
            waiting += [(j, k) for k in (0, 1) if alone[j, k]]
    dropped = {straight[i] for i in np.flatnonzero(gone)}
    made = [_line(edges[straight[i]], ends[i]) for i in np.flatnonzero(grown & ~gone)]
    renewed = {straight[i] for i in np.flatnonzero(grown)}
    return [edge for i, edge in enumerate(edges) if i not in dropped | renewed] + made


def _alone(ends: Any, gap: float) -> Any:
    """Whether no other end is at an end."""
    from scipy.spatial import cKDTree

    return np.array([len(near) for near in cKDTree(ends).query_ball_point(ends, gap)]) == 1


def _beneath(i: int, side: int, ends: Any, alone: Any, gone: Any, gap: float) -> int | None:
    """A line on which an end of another is, and that other within it, or beyond an end that is alone too."""
    at, back = ends[i, side], ends[i, 1 - side]
    a, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    length = np.maximum(np.hypot(along[:, 0], along[:, 1]), gap)

    def local(point: Any) -> tuple[Any, Any]:
        off = point - a
        across = (along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]) / length
        return (off * along).sum(axis=1) / length, abs(across)

    (here, off_here), (there, off_there) = local(at), local(back)
    on = ~gone & (off_here < gap) & (off_there < gap) & (here > gap) & (here < length - gap)
    on[i] = False
    for j in np.flatnonzero(on):
        within = gap < there[j] < length[j] - gap
        passed = int(there[j] > 0.5 * length[j])
        at_end = min(abs(there[j]), abs(there[j] - length[j])) <= gap
        if at_end or (alone[i, 1 - side] if within else alone[j, passed]):
            return int(j)
    return None


def _line(edge: Any, ends: Any) -> Any:
    """An edge between other ends."""
    from ezdxf import edgesmith
    from ezdxf.entities.line import Line

    line = Line.new(dxfattribs={"layer": edge.payload.dxf.layer, "start": tuple(ends[0]), "end": tuple(ends[1])})
    return next(iter(edgesmith.edges_from_entities_2d([line])))
