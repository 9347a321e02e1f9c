"""The line about which a plate tips: of all motions that its supports allow, the one with most work for its turning.

That work is the moment that is short: by duality the least couple with which reactions would balance the load.
"""

from __future__ import annotations

import numpy as np

from signorini.discretise.rows import Floats

_UP_AND_DOWN = 1e-5
"""What moving up and down counts for beside turning by as much: little, so that of equal turns the nearest is found."""
_HOLDS = 1e-9
"""Part of the largest reaction, and of the motion, that is rounding."""


def steepest(motions: Floats, moves: Floats, work: Floats) -> Floats | None:
    """Find the allowed motion whose work is largest for its turning.

    It minimises ½ turning² - work under moves ≤ 0, whose dual is a nonnegative least-squares problem in the reactions;
    those that act there name the supports it turns about, and these the motion.

    Parameters
    ----------
    motions : (3, d) array
        Basis of the free rigid motions: w, and the slopes times the plate's size.
    moves : (k, d) array
        How far each motion presses the one-sided points into their supports.
    work : (d,) array
        Work of the load on each, over the size of the load.

    Returns
    -------
    (d,) array or None
        Of largest entry one. None where arithmetic does not tell one.

    Examples
    --------
    A force at [3, 1] beside pads at [1, 0], [1, 2] and [0, 1] turns the plate about the line x = 1.

    >>> pads = np.array([[1.0, 1, 0], [1, 1, 2], [1, 0, 1]])
    >>> steepest(np.eye(3), pads, np.array([1.0, 3, 1])).round(9) + 0.0
    array([-1.,  1.,  0.])
    """
    from scipy.linalg import null_space
    from scipy.optimize import nnls

    weighed = np.array([_UP_AND_DOWN, 1.0, 1.0])[:, None] * motions
    metric = weighed.T @ weighed
    half = np.linalg.inv(np.linalg.cholesky(metric))
    try:
        reactions, _ = nnls(half @ moves.T, half @ work)
    except RuntimeError:
        return None
    closed = moves[reactions > _HOLDS * reactions.max(initial=0.0)]
    free = null_space(closed, rcond=_HOLDS) if len(closed) else np.eye(len(work))
    motion = free @ np.linalg.solve(free.T @ metric @ free, free.T @ work)
    motion = motion / max(np.abs(motion).max(initial=0.0), np.finfo(float).tiny)
    return motion if (moves @ motion).max(initial=0.0) <= _HOLDS and work @ motion > 0 else None
