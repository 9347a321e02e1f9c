"""The linear complementarity problem (LCP) of one load, and Lemke's algorithm on plain arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from signorini import _core
from signorini._core import LcpSolution
from signorini.base.arguments import array, checked
from signorini.discretise.laws import Law
from signorini.discretise.points import ContactPoints
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.errors import InputError


class Lcp(NamedTuple):
    """The LCP w = Mz + q with w, z ≥ 0 and zᵀw = 0, with rows for the vertices of the contact points' laws.

    A point that only pushes has one row; a point with a limit or a law has one row for each vertex. Points with a
    straight law, whose reactions may have either sign, are eliminated.

    Parameters
    ----------
    M : (k, k) array
    q : (k,) array
    points : (k,) array
        Contact point of each row: index of a row of the problem's G.
    gap_is_z : (k,) array
        Rows in which z is the gap and w the reaction; in other rows z is the reaction and w the gap. In a row of a
        limit or a law, w is the distance to the vertex of the law, and z the distance beyond the vertex.
    reaction_from, gap_from : (k, 3) arrays
        Coefficients a, b, c of each row; the reaction and the gap of a point are the sums of a + b z + c w of its rows.
    """

    M: Floats
    q: Floats
    points: Ints
    gap_is_z: Bools
    reaction_from: Floats
    gap_from: Floats

    def contact(self, z: Floats) -> tuple[Floats, Floats]:
        """Reactions λ (k,) and gaps ρ (k,) of ``points`` from z (k,), which need not be a solution.

        Rows of one point have equal values. ρ = g − Gu + Cλ is negative where a point has yielded. `signorini.recover`
        computes a certified result from the reactions.
        """
        terms_of_rows = np.column_stack([np.ones_like(z), z, self.M @ z + self.q])
        sums = ((terms * terms_of_rows).sum(axis=1) for terms in (self.reaction_from, self.gap_from))
        reaction, gap = (np.asarray(np.bincount(self.points, terms), np.float64)[self.points] for terms in sums)
        return reaction, gap


def lcp_of(matrix: Floats, q: Floats, points: Ints, w_is_force: Bools, contacts: ContactPoints) -> Lcp:
    """Make an `Lcp` from the core's arrays: M, q, contact point of each row, and whether w of a row is a force."""
    reaction, gap = np.zeros((2, len(q), 3))
    reaction[np.arange(len(q)), np.where(w_is_force, 2, 1)] = 1.0
    gap[np.arange(len(q)), np.where(w_is_force, 1, 2)] = 1.0
    single = np.array([law.only_pushes for law in contacts.laws], np.bool_)[contacts.law[points]]
    order = np.argsort(points, kind="stable")
    order = order[~single[order]]
    for rows in np.split(order, np.flatnonzero(np.diff(points[order])) + 1) if len(order) else ():
        i = points[rows[0]]
        law, unit, scale = contacts.laws[contacts.law[i]], contacts.unit[i], contacts.scale[i]
        reaction[rows], travel = _along(law, unit, scale, w_is_force[rows])
        gap[rows] = contacts.compliance[i] * reaction[rows] - travel
    return Lcp(matrix, q, points, w_is_force, reaction, gap)


def _along(law: Law, unit: float, scale: float, w_is_force: Bools) -> tuple[Floats, Floats]:
    """Coefficients a, b, c (v, 3) of a point's force and of its travel: sums of a + b z + c w over v vertices.

    w is the distance to a vertex, z the distance beyond it: a force on a piece with a slope, else a travel. Distances
    are counted from a base piece: the first piece with a slope or, if the core's ``w_is_force`` does not fit this, the
    first piece without a slope.
    """
    holds, vertex = law.slopes > 0.0, np.arange(len(law.slopes) - 1)
    for on_holding in (True, False):
        base = int(np.argmax(holds == on_holding))
        upward = vertex >= base
        before, beyond = vertex + ~upward, vertex + upward
        if holds[before].sum() == w_is_force.sum():
            break
    adjoins = (vertex == base) | (vertex + 1 == base)
    gaps = adjoins & ~upward & holds[base] & ~holds[beyond]
    order = np.lexsort((vertex, np.where(gaps, 0, np.where(adjoins & upward & ~holds[base], 1, 2))))
    first = base if base < len(vertex) else base - 1
    with np.errstate(divide="ignore"):
        compliance = unit / (scale * law.slopes)
    sign = np.where(upward, 1.0, -1.0)
    # Increments of travel and force along each piece of the law, per unit of w or z.
    along = np.array([np.where(holds, compliance, 1.0), holds])
    result = np.zeros((2, len(vertex), 3))
    result[:, :, 1] = sign * along[:, beyond]
    result[:, first, 0] = np.array(law.vertices[first]) * [unit, scale]
    result[:, first, 2] = -sign[first] * along[:, base]
    travel, force = result[:, order]
    return force, travel


@checked
def lemke(
    M: ArrayLike,
    q: ArrayLike,
    covering: ArrayLike | None = None,
    start: ArrayLike | None = None,
    max_pivots: int | None = None,
) -> LcpSolution:
    """Solve a linear complementarity problem by Lemke's algorithm, with the lexicographic ratio test.

    Find z and w such that ::

        w = M z + q,   z ≥ 0,   w ≥ 0,   zᵀw = 0.

    In the paper's dual, ``lemke(P, -s)``, z are the reactions and w the gaps. The path is finite for every M [1]_, also
    for degenerate problems [2]_. M and q are scaled by powers of two; z and w are computed again on the last basis.

    Parameters
    ----------
    M : (m, m) array_like
        Any square matrix, in the units of w over those of z.
    q : (m,) array_like
        In the units of w.
    covering : (m,) array_like, optional
        The covering vector d > 0 of w = M z + q + d z₀, in the units of w; ones by default.
    start : (m,) array_like of bool, optional
        Mask of basic z in the solution of a similar problem, `LcpSolution.basis`, at which the path begins. No pivot is
        made if this basis is the solution.
    max_pivots : int, optional
        Largest number of pivots; 50 (m + 100) by default.

    Returns
    -------
    LcpSolution
        ``status``, one of

        - "solved": ``z`` and ``w`` (m,) are a solution, ``basis`` (m,) is True where z is basic;
        - "ray": the path ended in a secondary ray ``ray`` (m,), v ≥ 0. If M is copositive-plus, as every positive
          semidefinite matrix is, Mᵀv ≤ 0 and qᵀv < 0 prove that no solution exists. For other M a ray is no proof;
        - "pivot_limit": the limit was reached, or rounding kept every basis infeasible.

        z and w are NaN unless solved. ``pivots`` is the number of pivots, ``message`` describes the status.

    Raises
    ------
    InputError
        If the shapes do not match, numbers are not finite, or the covering vector is not positive.

    Notes
    -----
    On plates a path takes a few m pivots of O(m²) operations each; the worst case is 2ᵐ pivots (Murty 1978).

    Rows and columns of M are scaled to largest entries of about one. Then numbers below 1e-11 max(−q) count as zero: in
    q = [-1, -1e-12] the second entry does.

    References
    ----------
    .. [1] C. E. Lemke, "Bimatrix equilibrium points and mathematical programming", *Management Science* 11 (1965),
       681-689.
    .. [2] R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, Academic Press, 1992,
       sections 4.4 and 4.9.

    Examples
    --------
    >>> M = [[60, 26, 37], [26, 36, 29], [37, 29, 30]]
    >>> result = lemke(M, [-1, -1, -1])
    >>> result.status, (239 * result.z).round(9).tolist(), result.basis.tolist()
    ('solved', [0.0, 1.0, 7.0], [False, True, True])

    A similar problem starts from this solution:

    >>> lemke(M, [-1, -1, -1.01], start=result.basis).pivots
    0

    A problem without a solution, and the proof:

    >>> M, q = [[1, -1], [-1, 1]], [-1, -1]
    >>> result = lemke(M, q)
    >>> result.status, result.ray.tolist(), (result.ray @ M).tolist(), float(result.ray @ q)
    ('ray', [1.0, 1.0], [0.0, 0.0], -2.0)
    """
    matrix, vector = array(M, "M", 2), array(q, "q", 1)
    covering_vector = None if covering is None else array(covering, "covering", 1)
    if max_pivots is not None and (not isinstance(max_pivots, int | np.integer) or max_pivots < 0):
        raise InputError(f"found {max_pivots!r}; it must be a whole number, 0 or more.", place="max_pivots")
    start_basis = None if start is None else np.asarray(start)
    if start_basis is not None and (start_basis.dtype != np.bool_ or start_basis.ndim != 1):
        raise InputError(
            f"found an array of {start_basis.dtype}, shape {start_basis.shape}; it must be a vector of bool, like "
            "LcpSolution.basis.",
            place="start",
        )
    try:
        return _core.lemke(matrix, vector, covering_vector, max_pivots, start_basis)
    except ValueError as error:
        raise InputError(f"{error}.") from None
