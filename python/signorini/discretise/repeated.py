"""Contact points that say again what the plate is held to already."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from signorini.base.components import components
from signorini.discretise.dependence import SAME, followers, lengths, parallel, times, within
from signorini.discretise.frames import Held, contradiction, rounding_of
from signorini.discretise.places import region
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.supports import ContactPoints
from signorini.errors import InputError
from signorini.mesh import Mesh
from signorini.model import Model

_MOST = 10_000
"""Two-sided points between nodes; to tell which follow from others takes a dense matrix of them."""


@dataclass(frozen=True, eq=False)
class Repeated:
    """Two-sided points (r,) that follow from others, which carry the reactions of all in the equations.

    Parameters
    ----------
    points : ContactPoints
    follows : (r, m) array
        Each row as a combination of the rows of contact points.
    """

    points: ContactPoints
    follows: csr_array

    def __len__(self) -> int:
        """Count the points."""
        return len(self.points)


@dataclass(frozen=True, eq=False)
class Shared:
    """Points (p,) whose reactions can be shared in more ways than one, and these ways (p, k): they sum to nothing."""

    points: Ints
    ways: Floats


def that_can_act(model: Model, mesh: Mesh, held: Held, contacts: ContactPoints) -> tuple[ContactPoints, Repeated]:
    """Leave out points that are held at every dof, and set apart two-sided ones that follow from others.

    Of the latter slopes, and points of a line or area that follow from others of the same, are left out too: results
    do not tell their reactions.

    Raises
    ------
    InputError
        If rigid ones at one place ask for different deflections, or contradict a held node.
    """
    contacts = _not_held(mesh, held, contacts)
    _require_agreement(mesh, held, contacts)
    _require_agreement_on_areas(model, mesh, held, contacts)
    equations = np.flatnonzero(contacts.two_sided)
    if len(equations) > _MOST:
        raise InputError(
            f"Found {len(equations)} rigid points between the mesh's nodes that hold both ways; at most {_MOST} can be "
            "told from each other. Hold an edge, or a line or circle that the mesh follows, or give a stiffness.",
            place=("support", int(contacts.support[equations[0]])),
        )
    points = contacts.pick(equations)
    whole = held.bodies.onto_leaders(points.rows.matrix(mesh.elements, len(held.dofs)))
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
    # By unit rows; reactions go by the rows as they are.
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
    """Rigid points that can share their reactions, those that depend on each other together."""
    rigid = np.flatnonzero((points.compliance == 0) & ~points.slope)
    rows = held.bodies.onto_leaders(points.rows[rigid].matrix(mesh.elements, len(held.dofs)))
    free = within(rows, ~held.dofs)
    group, scale = parallel(free)
    _, first = np.unique(group, return_index=True)
    ties = followers(times(free[first], 1.0 / scale[first])).ties
    tie, of = ties.nonzero()
    # Groups, then ties, are the two sides of a graph.
    label = components(len(first) + ties.shape[0], of.astype(np.int64), len(first) + tie.astype(np.int64))
    of_tie, label = label[len(first) :], label[: len(first)][group]
    order = np.argsort(label, kind="stable")
    at_points = np.array([support.at is not None for support in model.support], np.bool_)[points.support[rigid]]
    result = []
    for mine in np.split(order, np.flatnonzero(np.diff(label[order])) + 1):
        # Forces that move within one line or area are nothing that results tell.
        if len(mine) < 2 or not (at_points[mine].any() or np.ptp(points.support[rigid[mine]])):
            continue
        groups, own = np.unique(group[mine], return_inverse=True)
        sums = np.zeros((len(groups), len(mine)))
        sums[own, np.arange(len(mine))] = scale[mine]
        zero = ties[np.flatnonzero(of_tie == label[mine[0]])][:, groups].toarray()
        result.append(Shared(rigid[mine], null_ways(np.hstack([sums, -zero.T]))[: len(mine)]))
    return result


def null_ways(rows: Floats) -> Floats:
    """An orthonormal basis (n, k) of what rows (m, n) make nothing of."""
    _, values, basis = np.linalg.svd(rows)
    return np.asarray(basis[int((values > SAME * values.max(initial=1.0)).sum()) :].T)


def _is_told(model: Model, contacts: ContactPoints, repeated: Repeated) -> Bools:
    """Whether results tell the reaction of a repeated point, or of another support that it may take some from."""
    mine = repeated.points.support
    at_points = np.array([support.at is not None for support in model.support], np.bool_)[mine]
    owner, of = repeated.follows.nonzero()
    with_others = np.zeros(len(repeated), np.bool_)
    with_others[owner[contacts.support[of] != mine[owner]]] = True
    return np.asarray(~repeated.points.slope & (at_points | with_others))


def _not_held(mesh: Mesh, held: Held, contacts: ContactPoints) -> ContactPoints:
    """Leave out points whose every dof is held, unless they are compliant and pressed there."""
    if not held.dofs.any():
        return contacts
    rows = held.bodies.onto_leaders(contacts.rows.matrix(mesh.elements, len(held.dofs)))
    fixed = ~((abs(rows) > SAME) @ ~held.dofs)
    beyond = rows @ held.values - contacts.distance
    beyond[contacts.two_sided] = np.abs(beyond[contacts.two_sided])
    rigid = contacts.compliance == 0
    pressed = beyond > np.where(rigid, _rounding(mesh, held, contacts), 0.0)
    if (wrong := fixed & pressed & rigid).any():
        first = int(np.argmax(wrong))
        by = held.support[rows[[first]].indices].max()
        raise contradiction(contacts.positions[first], mesh.size, by, contacts.support[first], float(beyond[first]))
    return contacts.pick(~fixed | _with_its_other_way(contacts, fixed & pressed))


def _with_its_other_way(contacts: ContactPoints, which: Bools) -> Bools:
    """Mark, beside the rows marked, those of the same points' travel the other way."""
    if not which.any():
        return which
    spots = np.column_stack([contacts.support, contacts.slope, contacts.positions])
    _, spot = np.unique(spots, axis=0, return_inverse=True)
    return np.isin(spot, spot[which])


def _rounding(mesh: Mesh, held: Held, contacts: ContactPoints) -> Floats:
    """By how much deflections, or slopes, at points (m,) may differ that are the same."""
    by_length = np.where(contacts.slope, mesh.size, 1.0)
    at_nodes = np.abs(held.values.reshape(-1, 3) * [1.0, mesh.size, mesh.size]).max()
    rigid = contacts.compliance == 0
    largest = max(at_nodes, np.abs(by_length * contacts.distance)[rigid].max(initial=0.0))
    return np.asarray(rounding_of(float(largest), mesh.points) / by_length)


def _require_agreement(mesh: Mesh, held: Held, contacts: ContactPoints) -> None:
    """Refuse rigid points of which one asks for more deflection than another allows of the same row."""
    rigid = contacts.pick(contacts.compliance == 0)
    if not len(rigid):
        return
    whole = held.bodies.onto_leaders(rigid.rows.matrix(mesh.elements, len(held.dofs)))
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
    """Refuse rigid points and lines within a rigid area that ask for another deflection there than the area does."""
    on_nodes = np.array([support.on_nodes for support in model.support], np.bool_)
    rigid = contacts.pick((contacts.compliance == 0) & ~contacts.slope)
    points = rigid.pick(on_nodes[rigid.support])
    nodes, holders = held.holders.T
    at = np.concatenate([mesh.points[nodes], points.positions])
    who = np.concatenate([holders, points.support])
    value = np.concatenate([held.values[3 * nodes], points.direction * points.distance])
    above = np.concatenate([np.ones(len(nodes), np.bool_), points.two_sided | (points.direction > 0)])
    below = np.concatenate([np.ones(len(nodes), np.bool_), points.two_sided | (points.direction < 0)])
    rounding = float(_rounding(mesh, held, contacts).max(initial=0.0))
    for index in np.unique(rigid.support).tolist():
        support, place = model.support[index], ("support", index)
        if support.area is None:
            continue
        covered = region(support.area)
        (inside,) = np.nonzero(np.ones(len(at), np.bool_) if covered is None else covered.contains(at))
        settlement = support.settlement(*at[inside].T, place=(*place, "settlement"))
        gap = support.gap(*at[inside].T, at_least=0.0, place=(*place, "gap"))
        most = np.where(support.resists == "up", np.inf, settlement + gap)
        least = np.where(support.resists == "down", -np.inf, settlement - gap)
        beyond = np.maximum(
            np.where(above[inside], least - value[inside], -np.inf),
            np.where(below[inside], value[inside] - most, -np.inf),
        )
        if (beyond > rounding).any():
            first = int(np.argmax(beyond))
            one, other = sorted((index, int(who[inside[first]])))
            raise contradiction(at[inside[first]], mesh.size, one, other, float(beyond[first]))
