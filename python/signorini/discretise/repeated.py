"""Redundant contact points, whose rows are linear combinations of other contact points' rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from signorini.base.components import components
from signorini.discretise.held import Held, contradiction, rounding_of
from signorini.discretise.laws import levels_of
from signorini.discretise.points import ContactPoints
from signorini.discretise.rows import Bools, Floats, Ints, null_space
from signorini.errors import InputError
from signorini.mesh import Mesh
from signorini.model import Model

SAME = 1e-12
"""Zero tolerance for entries of rows of unit length.

Entries have rounding errors of 1e-15; rows of two points 1e-9 of an element apart differ by 1e-9.
"""
_CLEAR = 1e-10
"""Least pivot in the elimination of G Gᵀ, with rows G of unit length, at which the rows count as independent."""
_MOST = 10_000
"""Largest number of rigid two-sided points between nodes, since dependent rows are found with a dense matrix."""


@dataclass(frozen=True, eq=False)
class Followers:
    """Dependent rows (r,) of g rows: row i is the sum of the independent rows times ``combinations[i]`` (g,)."""

    rows: Ints
    combinations: csr_array

    @property
    def ties(self) -> csr_array:
        """Independent combinations (r, g) of the g rows; the sum of the rows in each combination is zero."""
        count = len(self.rows)
        own = csr_array((np.ones(count), (np.arange(count), self.rows)), shape=self.combinations.shape)
        return csr_array(own - self.combinations)


def within(rows: csr_array, dofs: Bools) -> csr_array:
    """Rows restricted to the dofs marked in ``dofs``; entries within rounding are removed."""
    rows = csr_array(rows, copy=True)
    rows.data[~dofs[rows.indices] | (np.abs(rows.data) <= SAME)] = 0.0
    rows.eliminate_zeros()
    return rows


def lengths(rows: csr_array) -> Floats:
    """Euclidean norm (m,) of each row."""
    return np.asarray(np.sqrt(rows.multiply(rows).sum(axis=1)))


def times(rows: csr_array, factor: Floats) -> csr_array:
    """Rows, each multiplied by its entry of ``factor`` (m,)."""
    out = csr_array(rows, copy=True)
    out.data *= np.repeat(factor, np.diff(out.indptr))
    return out


def parallel(rows: csr_array) -> tuple[Ints, Floats]:
    """Index (m,) of each row's direction, which parallel rows share, and signed norm (m,) of the row along it."""
    # Two unit rows count as parallel if their products with two random vectors are equal up to a common sign.
    fields = np.random.default_rng(0).normal(size=(rows.shape[1], 2))
    length = lengths(rows)
    said = (rows @ fields) / length[:, None]
    sign = np.where(said[:, 0] < 0, -1.0, 1.0)
    said *= sign[:, None]
    order = np.argsort(said[:, 0], kind="stable")
    new = np.append(True, (np.abs(np.diff(said[order], axis=0)) > SAME).any(axis=1))
    group = np.empty(len(length), np.int64)
    group[order] = np.cumsum(new)[: len(order)] - 1
    return group, sign * length


def followers(rows: csr_array) -> Followers:
    """Find the rows among unit rows (g, n) that are, up to rounding, linear combinations of other rows.

    Examples
    --------
    >>> rows = np.array([[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.0, 1.0, 0.0]])
    >>> result = followers(csr_array(rows))
    >>> result.rows.tolist(), result.combinations.toarray().round(9).tolist()
    ([1], [[0.6, 0.0, 0.8]])

    Rows that nearly follow do not:

    >>> rows[1] = [0.6, 0.8, 1e-9]
    >>> followers(csr_array(rows)).rows.tolist()
    []
    """
    some = _entangled(rows)
    parts = [Followers(np.zeros(0, np.int64), csr_array((0, rows.shape[0])))]
    here = rows[some]
    products = csr_array(here @ here.T)
    if len(some) and not _clearly_independent(products):
        # scipy.linalg takes time to import, and few plates have rows that may be dependent.
        from scipy.linalg import qr, solve_triangular

        near = products.tocoo()
        label = components(len(some), *(at.astype(np.int64) for at in near.coords))
        for part in range(int(label.max()) + 1):
            mine = some[label == part]
            dense = rows[mine][:, np.unique(rows[mine].indices)].toarray()
            r, order = qr(dense.T, mode="r", pivoting=True)
            rank = int((np.abs(np.diagonal(r)) > SAME).sum())
            combination = solve_triangular(r[:rank, :rank], r[:rank, rank:]).T
            combination[np.abs(combination) <= SAME] = 0.0
            of = csr_array(combination).tocoo()
            at = of.coords[0], mine[order[:rank]][of.coords[1]]
            shape = len(order) - rank, rows.shape[0]
            parts.append(Followers(mine[order[rank:]], csr_array((of.data, at), shape=shape)))
    combinations = csr_array(vstack([part.combinations for part in parts]))
    return Followers(np.concatenate([part.rows for part in parts]), combinations)


def _entangled(rows: csr_array) -> Ints:
    """Indices of the rows that may be dependent.

    Rows with a dof that no other row has are removed, repeatedly.
    """
    pattern = csr_array((np.ones(rows.nnz), rows.indices, rows.indptr), shape=rows.shape)
    some = np.arange(rows.shape[0])
    while len(some):
        here = pattern[some]
        alone = np.bincount(here.indices, minlength=rows.shape[1]) == 1
        stay = (here @ alone.astype(np.float64)) == 0
        if stay.all():
            break
        some = some[stay]
    return some


def _clearly_independent(products: csr_array) -> bool:
    """Whether rows G are independent: in elimination, every pivot of ``products`` G Gᵀ is far above rounding."""
    from scipy.sparse.linalg import splu

    try:
        symmetric = {"SymmetricMode": True}
        factor = splu(products.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=symmetric)
    except RuntimeError:
        return False
    return bool((factor.U.diagonal() > _CLEAR).all())


@dataclass(frozen=True, eq=False)
class Repeated:
    """Redundant points (r,): rigid two-sided points whose rows depend on those of the contact points.

    In the equations, only contact points have reactions. ``follows`` (r, m) gives each redundant row as a linear
    combination of the rows of contact points.
    """

    points: ContactPoints
    follows: csr_array

    def __len__(self) -> int:
        """Return the number of redundant points."""
        return len(self.points)


@dataclass(frozen=True, eq=False)
class Shared:
    """Points (p,) whose reactions are not unique; ``ways`` (p, k) is a basis of their reactions λ with Gᵀλ = 0."""

    points: Ints
    ways: Floats


def that_can_act(model: Model, mesh: Mesh, held: Held, contacts: ContactPoints) -> tuple[ContactPoints, Repeated]:
    """Return the contact points that can act, and the redundant points, whose equations depend on others.

    Points whose dofs are all held are left out. So are dependent slopes, and points of a line or area that depend on
    other points of the same support: results do not show their reactions. Rigid points at one place that prescribe
    different deflections are refused.
    """
    contacts = contacts.pick(not_held(mesh, held, contacts))
    _require_agreement(mesh, held, contacts)
    _require_agreement_on_areas(model, mesh, held, contacts)
    rows = _over_dofs(mesh, held, contacts)
    # A row without free dofs depends on no other row.
    equations = np.flatnonzero(contacts.equations & _moves(rows, held))
    if len(equations) > _MOST:
        raise InputError(
            f"Found {len(equations)} rigid points between the mesh's nodes that hold both ways; at most {_MOST} can be "
            "checked for redundancy. Hold an edge, or a line or circle that the mesh follows, or give a stiffness.",
            place=("support", int(contacts.support[equations[0]])),
        )
    points = contacts.pick(equations)
    whole = rows[equations]
    free = within(whole, ~held.dofs)
    scale = lengths(free)
    result = followers(times(free, 1.0 / scale))
    travel = (points.distance - whole @ held.values) / scale
    beyond = np.abs(travel[result.rows] - result.combinations @ travel)
    if (beyond > _rounding(mesh, held, points)[result.rows] / scale[result.rows]).any():
        first = int(np.argmax(beyond))
        others = points.support[result.combinations[[first]].indices]
        row = result.rows[first]
        raise contradiction(points.positions[row], mesh.size, others[0], points.support[row], float(beyond[first]))
    stay = np.ones(len(contacts), np.bool_)
    stay[equations[result.rows]] = False
    # ``combinations`` refers to unit rows; reactions refer to rows of the original length.
    follows = result.combinations.tocoo()
    which, of = follows.coords
    place = (np.cumsum(stay) - 1)[equations[of]]
    shape = len(result.rows), int(stay.sum())
    data = follows.data * scale[result.rows][which] / scale[of]
    repeated = Repeated(points.pick(result.rows), csr_array((data, (which, place)), shape=shape))
    kept = contacts.pick(stay)
    told = np.flatnonzero(_is_told(model, kept, repeated))
    return kept, Repeated(repeated.points.pick(told), repeated.follows[told])


def shared_by(model: Model, mesh: Mesh, held: Held, points: ContactPoints) -> list[Shared]:
    """Groups of rigid points whose rows depend on each other, so that they can share their reactions."""
    rigid = np.flatnonzero((points.compliance == 0) & ~points.slope)
    rows = held.bodies.onto_leaders(points.rows[rigid].matrix(mesh.elements, len(held.dofs)))
    free = within(rows, ~held.dofs)
    group, scale = parallel(free)
    _, first = np.unique(group, return_index=True)
    ties = followers(times(free[first], 1.0 / scale[first])).ties
    tie, of = ties.nonzero()
    # Groups of parallel rows and linear dependences (``ties``) are the two sides of a bipartite graph.
    label = components(len(first) + ties.shape[0], of.astype(np.int64), len(first) + tie.astype(np.int64))
    of_tie, label = label[len(first) :], label[: len(first)][group]
    order = np.argsort(label, kind="stable")
    at_points = np.array([support.at is not None for support in model.support], np.bool_)[points.support[rigid]]
    result = []
    for mine in np.split(order, np.flatnonzero(np.diff(label[order])) + 1):
        # Groups of points of one line or area are omitted: results do not show the reactions of their points.
        if len(mine) < 2 or not (at_points[mine].any() or np.ptp(points.support[rigid[mine]])):
            continue
        groups, own = np.unique(group[mine], return_inverse=True)
        sums = np.zeros((len(groups), len(mine)))
        sums[own, np.arange(len(mine))] = scale[mine]
        zero = ties[np.flatnonzero(of_tie == label[mine[0]])][:, groups].toarray()
        result.append(Shared(rigid[mine], null_space(np.hstack([sums, -zero.T]), SAME)[: len(mine)]))
    return result


def _over_dofs(mesh: Mesh, held: Held, points: ContactPoints) -> csr_array:
    return held.bodies.onto_leaders(points.rows.matrix(mesh.elements, len(held.dofs)))


def _is_told(model: Model, contacts: ContactPoints, repeated: Repeated) -> Bools:
    """Mask (r,) of redundant points whose reactions are shown.

    They are the points that the input lists, and points whose rows depend on points of another support.
    """
    mine = repeated.points.support
    at_points = np.array([support.at is not None for support in model.support], np.bool_)[mine]
    owner, of = repeated.follows.nonzero()
    with_others = np.zeros(len(repeated), np.bool_)
    with_others[owner[contacts.support[of] != mine[owner]]] = True
    return np.asarray(~repeated.points.slope & (at_points | with_others))


def _moves(rows: csr_array, held: Held) -> Bools:
    """Mask (m,) of rows with a nonzero entry at a free dof."""
    return np.asarray((abs(rows) > SAME) @ ~held.dofs)


def not_held(mesh: Mesh, held: Held, contacts: ContactPoints) -> Ints:
    """Indices (k,) of points that can act: points with a free dof, and compliant points loaded by held dofs' values."""
    if not held.dofs.any():
        return np.arange(len(contacts))
    rows = _over_dofs(mesh, held, contacts)
    fixed = ~_moves(rows, held)
    beyond = rows @ held.values - contacts.distance
    both_ways = contacts.limits[0] < 0.0
    beyond[both_ways] = np.abs(beyond[both_ways])
    rigid = contacts.compliance == 0
    pressed = beyond > np.where(rigid, _rounding(mesh, held, contacts), 0.0)
    if (wrong := fixed & pressed & rigid).any():
        first = int(np.argmax(wrong))
        by = held.support[rows[[first]].indices].max()
        raise contradiction(contacts.positions[first], mesh.size, by, contacts.support[first], float(beyond[first]))
    if not (fixed & pressed).any():
        return np.flatnonzero(~fixed)
    # If held dofs load a point, the point of the opposite direction at the same place is kept too.
    spots = np.column_stack([contacts.support, contacts.slope, contacts.positions])
    _, spot = np.unique(spots, axis=0, return_inverse=True)
    return np.flatnonzero(~fixed | np.isin(spot, spot[fixed & pressed]))


def _rounding(mesh: Mesh, held: Held, contacts: ContactPoints) -> Floats:
    """Tolerance (m,) for equal deflections at points, or for equal slopes at points that hold a slope."""
    by_length = np.where(contacts.slope, mesh.size, 1.0)
    at_nodes = np.abs(held.values.reshape(-1, 3) * [1.0, mesh.size, mesh.size]).max()
    rigid = contacts.compliance == 0
    largest = max(at_nodes, np.abs(by_length * contacts.distance)[rigid].max(initial=0.0))
    return np.asarray(rounding_of(float(largest), mesh.points) / by_length)


def _require_agreement(mesh: Mesh, held: Held, contacts: ContactPoints) -> None:
    """Refuse rigid points with parallel rows if one point requires a larger deflection than another point allows."""
    rigid = contacts.pick(contacts.compliance == 0)
    if not len(rigid):
        return
    whole = _over_dofs(mesh, held, rigid)
    group, scale = parallel(within(whole, ~held.dofs))
    level = (rigid.distance - whole @ held.values) / scale
    count = int(group.max()) + 1
    most, least = np.full(count, np.inf), np.full(count, -np.inf)
    above, below = rigid.two_sided | (scale > 0), rigid.two_sided | (scale < 0)
    np.minimum.at(most, group[above], level[above])
    np.maximum.at(least, group[below], level[below])
    slack = np.zeros(count)
    np.maximum.at(slack, group, _rounding(mesh, held, rigid) / np.abs(scale))
    if not (wrong := least - most > slack).any():
        return
    which = int(np.argmax(wrong))
    one = int(np.flatnonzero((group == which) & above & (level == most[which]))[0])
    other = int(np.flatnonzero((group == which) & below & (level == least[which]))[0])
    who = sorted((int(rigid.support[one]), int(rigid.support[other])))
    by = float((least - most)[which] * np.abs(scale[one]))
    raise contradiction(rigid.positions[one], mesh.size, who[0], who[1], by)


def _require_agreement_on_areas(model: Model, mesh: Mesh, held: Held, contacts: ContactPoints) -> None:
    """Refuse rigid points and lines on a rigid area if they prescribe a deflection that the area excludes."""
    on_nodes = np.array([support.on_nodes for support in model.support], np.bool_)
    rigid = contacts.pick((contacts.compliance == 0) & ~contacts.slope)
    points = ContactPoints.join([held.points, rigid.pick(on_nodes[rigid.support])])
    at, value = points.positions, points.direction * points.distance
    above, below = points.two_sided | (points.direction > 0), points.two_sided | (points.direction < 0)
    rounding = float(_rounding(mesh, held, contacts).max(initial=0.0))
    for index in np.unique(rigid.support).tolist():
        support = model.support[index]
        if support.area is None:
            continue
        (inside,) = np.nonzero(support.where.covers(at))
        pushed_from, held_from = levels_of(support, at[inside], ("support", index))
        most = np.where(support.direction == "up", np.inf, pushed_from)
        least = np.where(support.direction == "down", -np.inf, held_from)
        too_low = np.where(above[inside], least - value[inside], -np.inf)
        beyond = np.maximum(too_low, np.where(below[inside], value[inside] - most, -np.inf))
        if (beyond > rounding).any():
            first = int(np.argmax(beyond))
            one, other = sorted((index, int(points.support[inside[first]])))
            raise contradiction(at[inside[first]], mesh.size, one, other, float(beyond[first]))
