"""Connected components of a graph."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Ints = npt.NDArray[np.int64]


def components(count: int, start: Ints, end: Ints) -> Ints:
    """Component number (count,) of each node of a graph with edges ``start``–``end`` (k,).

    Components are numbered in the order of their first nodes. The lowest node number of each component spreads over its
    edges, with pointer jumping, until no number changes. `scipy.sparse.csgraph` gives the same component numbers, but
    its import takes longer.

    Examples
    --------
    >>> components(5, np.array([4, 1]), np.array([1, 3])).tolist()
    [0, 1, 2, 1, 1]
    """
    lowest = np.arange(count)
    while (open_edges := lowest[start] != lowest[end]).any():
        start, end = start[open_edges], end[open_edges]
        lower = np.minimum(lowest[start], lowest[end])
        for nodes in (start, end):
            np.minimum.at(lowest, lowest[nodes], lower)
        while (further := lowest[lowest] != lowest).any():
            lowest[further] = lowest[lowest[further]]
    return np.asarray(np.unique(lowest, return_inverse=True)[1])
