"""The holes of a mesh, by the loops of its boundary."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_MISSED = 1e-4
"""Part of a hole's area that chords of its curved sides may miss."""


def holes(points: Floats, boundary: Ints) -> tuple[Floats, ...]:
    """Points (k, 2) along every hole, of curved sides so many that chords between them are as good.

    ``boundary`` (k, 3) has the plate on its left, loop after loop, so that it runs around holes clockwise.
    """
    return tuple(hole for loop in _loops(boundary) if (hole := _drawn(points[loop])) is not None)


def _loops(boundary: Ints) -> Iterator[Ints]:
    """Divide sides (k, 3) into closed loops; one that passes a corner twice is two."""
    ends = boundary[:, [0, 2]].tolist()
    path: list[int] = []
    at: dict[int, int] = {}
    for side, (begin, end) in enumerate(ends):
        at[begin] = len(path)
        path.append(side)
        if end in at:
            first = at[end]
            yield boundary[path[first:]]
            for gone in path[first:]:
                at.pop(ends[gone][0], None)
            del path[first:]


def _drawn(sides: Floats) -> Floats | None:
    """Points along a loop of sides (k, 3, 2); none where the plate is inside."""
    begin, middle, end = np.moveaxis(sides, 1, 0)
    rise = middle - 0.5 * (begin + end)
    area = 0.5 * float((begin[:, 0] * end[:, 1] - begin[:, 1] * end[:, 0]).sum())
    # A parabola encloses two thirds of its chord times its rise.
    curved = 2.0 / 3.0 * ((end - begin)[:, 0] * rise[:, 1] - (end - begin)[:, 1] * rise[:, 0])
    area -= float(curved.sum())
    if area >= 0.0:
        return None
    chords = max(1, int(np.ceil(np.sqrt(np.abs(curved).sum() / (_MISSED * -area)))))
    t = np.arange(chords)[:, None] / chords
    along = begin[:, None] + t * (end - begin)[:, None] + 4.0 * t * (1.0 - t) * rise[:, None]
    return np.asarray(along.reshape(-1, 2))
