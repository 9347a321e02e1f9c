"""Of answers that are equally right, the one with the least reactions and then the least deflection.

Solutions of the contact problem make a convex set: any displacement of one goes with any reactions of another. So the
two are chosen apart, by rules that know no order of supports, points or pivots: reactions by their least sum of squares
and, where the plate may still move between its supports, the deflection by its least integral of w². docs/theory.md,
section 5, has the weights.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from signorini.contact.answer import Answer, NotUnique
from signorini.contact.dependence import Dependence
from signorini.contact.least_norm import least, span_of_cone
from signorini.discretise import Discretisation
from signorini.discretise.quadrature import area_quadrature
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.equilibrium.balance import RigidFreedom, describe_motion

_NIL = 1e-11
"""Part of the largest force, or deflection, below which solvers take one for rounding."""
_HARDLY = 1e-6
"""Part of the deflection by which reactions scale on the plate below which none counts: supports leave it none."""
_STILL = 1e-12
"""Part of a motion by which a pushing point moves that is rounding: points on a line hold nothing about it."""
_MOVED = 1e-9
"""Part of a direction of size one below which a point takes no part in it."""
_ROUNDING = 16 * float(np.finfo(float).eps)
"""What sums of a few products round off."""
_DOUBTFUL = 1e-9
"""As `_NIL`, where all that hangs on it is whether a combination is solved by itself."""


Elsewhere: TypeAlias = Callable[[], Iterable[Floats]]


def chosen(
    found: Discretisation, freedom: RigidFreedom, nodal: Floats, answer: Answer, elsewhere: Elsewhere | None = None
) -> Answer:
    """Return the least of the answers to a nodal load (3n,) that are as right as this one, and say so if there are any.

    On a load path ``elsewhere`` gives reactions (m,) of other loads just before and after: points that push there hold
    the plate here too, so that it moves on without a jump. It is called where the plate could move.

    Examples
    --------
    Of two bearings at one place an LCP would have the first carry all.

    >>> from signorini import Model, contact_problem
    >>> corners = [[0, 0], [4, 0], [4, 4], [0, 4]]
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     mesh={"divisions": [4, 4]},
    ...     support=[{"at": corners, "resists": "down"}, {"name": "twin", "at": [4, 4], "resists": "down"}],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> problem = contact_problem(model)
    >>> answer = problem.solve(problem.discretisation.cases["load"])
    >>> answer.reaction.round(6).tolist(), str(answer.not_unique[0])[:42]
    ([20000.0, 20000.0, 10000.0, 20000.0, 10000.0], 'reactions of support 1, twin could be shar')
    """
    if answer.status != "solved":
        return answer
    least = _with_least_reactions(found, nodal, answer)
    if freedom.count:
        least = _with_least_deflection(found, freedom, nodal, least, elsewhere)
    return least if least is answer else replace(least, somehow=answer)


def doubtful(found: Discretisation, freedom: RigidFreedom, reaction: Floats, gap: Floats) -> Bools:
    """Whether combinations (k,) may have more answers than one, given their reactions and gaps (k, m)."""
    if len(found.repeated):
        return np.ones(len(reaction), np.bool_)
    several = np.zeros(len(reaction), np.bool_)
    dependence = Dependence.of(found)
    if len(dependence.points):
        # Where every point is closed gaps are rounding, of what the reactions bend the plate by.
        travel = np.abs(gap).max(axis=1, initial=0.0) + np.abs(found.contacts.distance).max()
        travel += _bending(found, reaction)
        touching = gap[:, dependence.points] <= _DOUBTFUL * travel[:, None]
        groups = np.zeros((len(dependence.points), len(dependence.even)))
        groups[np.arange(len(groups)), dependence.group] = 1.0
        count = touching.astype(np.float64) @ groups
        several |= (count > np.where(dependence.ties.any(axis=1), 0.5, 1.5)).any(axis=1)
    if freedom.count:
        pushing = ~found.contacts.two_sided & (reaction > _DOUBTFUL * reaction.max(axis=1, initial=0.0)[:, None])
        squares = np.einsum("mi,mj->mij", freedom.moves, freedom.moves).reshape(len(freedom.moves), -1)
        held = (pushing.astype(np.float64) @ squares).reshape(-1, freedom.count, freedom.count)
        values = np.linalg.eigvalsh(held)
        # Of squares.
        several |= values[:, 0] <= _DOUBTFUL**1.5 * values[:, -1]
    return several


def _with_least_reactions(found: Discretisation, nodal: Floats, answer: Answer) -> Answer:
    dependence = Dependence.of(found)
    together: list[Iterable[int]] = list(dependence.held_together)
    if len(dependence.points):
        touching = _touching(found, answer, dependence)
        answer = _closed_together(answer, dependence, touching)
        reaction, which = _shared(found, nodal, answer, dependence, touching)
        if len(which):
            together += _by_tie(found, dependence, which)
            count = len(answer.reaction)
            folded = reaction[:count] + found.repeated.follows.T @ reaction[count:]
            beside = np.isin(dependence.group, dependence.group[np.isin(dependence.points, which)])
            met = dependence.points[beside & touching]
            closed = answer.closed.copy()
            closed[met[met < count]] = True
            gap = np.where(closed, 0.0, answer.gap)
            answer = replace(answer, reaction=folded, shared=reaction, closed=closed, gap=gap)
    names = [support.name for support in found.model.support]
    several = tuple(NotUnique("reactions", tuple(names[i] for i in sorted(who))) for who in _merged(together))
    return replace(answer, not_unique=(*answer.not_unique, *several)) if several else answer


def _touching(found: Discretisation, answer: Answer, dependence: Dependence) -> Bools:
    """Whether the plate is at each point of a dependence (p,)."""
    gap = np.append(answer.gap, np.zeros(len(found.repeated)))[dependence.points]
    distance = np.abs(found.points.distance[dependence.points])
    largest = max(float(np.abs(answer.hi[::3]).max()), _HARDLY * float(_bending(found, answer.reaction)))
    near = gap <= _NIL * np.maximum(largest, distance)
    return np.asarray(near | found.points.two_sided[dependence.points])


def _bending(found: Discretisation, reaction: Floats) -> Floats:
    """Deflections (...,) by which reactions (..., m) scale on the plate."""
    rigidity = found.model.young * found.thickness.max() ** 3 / 12 / found.mesh.size**2
    return np.asarray(np.abs(reaction).sum(axis=-1) / rigidity)


def _closed_together(answer: Answer, dependence: Dependence, touching: Bools) -> Answer:
    """Close the points at which the plate is beside others, at the same place and side, that are closed."""
    one_sided = dependence.points < len(answer.closed)
    points, group = dependence.points[touching & one_sided], dependence.group[touching & one_sided]
    side = (2 * group + (dependence.scale[touching & one_sided] > 0)).astype(np.int64)
    some = np.zeros(2 * len(dependence.even), np.bool_)
    some[side[answer.closed[points]]] = True
    more = points[some[side] & ~answer.closed[points]]
    if not len(more):
        return answer
    closed, gap = answer.closed.copy(), answer.gap.copy()
    closed[more], gap[more] = True, 0.0
    return replace(answer, closed=closed, gap=gap)


def _shared(
    found: Discretisation, nodal: Floats, answer: Answer, dependence: Dependence, touching: Bools
) -> tuple[Floats, Ints]:
    """Least reactions (m + r,), and the points among all whose reactions could be others."""
    reaction, points = answer.shared.copy(), dependence.points
    force = _force(found, nodal, answer)
    here = np.flatnonzero(touching)
    count = np.bincount(dependence.group[here], minlength=len(dependence.even))
    ties = _ties_among(dependence.ties, count > 0)
    tied = (np.abs(ties) > _MOVED).any(axis=1)
    side = np.where(found.points.one_way[points], np.sign(dependence.scale), 0.0)[here]
    group, scale, weight = dependence.group[here], dependence.scale[here], dependence.weights[here]
    plain = dependence.even & ~tied & (count > 1)

    # At one place: what they carry together, by the weights of those that can carry its sign.
    total = np.bincount(group, scale * reaction[points[here]], len(count))
    helps = (side == 0.0) | (side == np.sign(total)[group])
    stiff = np.bincount(group, helps * scale**2 * weight, len(count))
    of_plain = np.flatnonzero(plain[group])
    each = np.divide(total, stiff, out=np.zeros(len(count)), where=stiff > 0.0)
    part = (helps * each[group] * scale * weight)[of_plain]
    reaction[points[here[of_plain]]] = part
    # Those that all push one way share what there is; others may push against each other besides.
    sides = np.zeros((len(count), 3), np.bool_)
    sides[group, side.astype(np.int64)] = True
    against = (sides[:, 0] | (sides[:, 1] & sides[:, -1]))[group[of_plain]]
    several = [points[here[of_plain[against | (np.abs(part) > _NIL * force)]]]]

    rest = np.flatnonzero((tied | ((count > 1) & ~plain))[group])
    if len(rest):
        several.append(_share_among(found, nodal, reaction, dependence, here[rest], ties, force, answer))
    return reaction, np.sort(np.concatenate(several))


def _share_among(
    found: Discretisation,
    nodal: Floats,
    reaction: Floats,
    dependence: Dependence,
    members: Ints,
    ties: Floats,
    force: float,
    answer: Answer,
) -> Ints:
    """Share among members of a dependence, in place; return the points whose reactions could be others."""
    from scipy.linalg import null_space

    points, groups = dependence.points[members], dependence.group[members]
    involved, row = np.unique(groups, return_inverse=True)
    # Forces that add up to nothing on every direction, or to what a tie makes nothing of.
    sums = np.zeros((len(involved), len(members)))
    sums[row, np.arange(len(members))] = dependence.scale[members]
    moving = null_space(np.hstack([sums, -ties[involved]]), rcond=_STILL)[: len(members)]
    if not moving.shape[1]:
        return points[:0]
    moving, _ = np.linalg.qr(moving)
    pushes = found.points.one_way[points]
    reaction[points] = _none_pulling(reaction[points], moving, pushes)
    rows, offset = [moving / np.sqrt(dependence.weights[members])[:, None]], []
    offset.append(reaction[points] / np.sqrt(dependence.weights[members]) / force)
    nodes, count = np.unique(found.held.holders[:, 0], return_counts=True)
    at_holds = dependence.rows[members][:, 3 * nodes]
    if at_holds.nnz:
        imbalance = found.plate.residual(found.springs.arrays, nodal, answer.hi, answer.lo)
        held = (imbalance - found.point_rows.T @ reaction)[3 * nodes]
        rows.append(-(at_holds.T @ moving) / np.sqrt(count)[:, None])
        offset.append(held / np.sqrt(count) / force)
    room = np.maximum(reaction[points[pushes]], 0.0) / force
    change = moving @ least(np.vstack(rows), np.concatenate(offset), -moving[pushes], room)
    least_of_all = reaction[points] + force * change
    least_of_all[pushes] = np.where(least_of_all[pushes] > _NIL * force, least_of_all[pushes], 0.0)
    reaction[points] = least_of_all
    none = pushes & (least_of_all == 0.0)
    others = moving @ span_of_cone(-moving[none])
    return points[(np.abs(others) > _MOVED).any(axis=1)] if others.shape[1] else points[:0]


def _none_pulling(reaction: Floats, moving: Floats, pushes: Bools) -> Floats:
    """Reactions (p,) that are the same but for ``moving`` (p, k), none of which pulls; as they are if there are none.

    Where supports hold the plate from both sides, the equations of a contact set may have each pull at the other.
    """
    size = float(np.abs(reaction).max())
    if (reaction[pushes] >= -_NIL * size).all():
        return reaction
    from scipy.linalg import null_space
    from scipy.optimize import nnls

    fixed = null_space(moving.T).T
    try:
        least, left = nnls(np.hstack([fixed, -fixed[:, ~pushes]]), fixed @ reaction / size)
    except RuntimeError:
        return reaction
    if left > _NIL:
        return reaction
    found = least[: len(reaction)].copy()
    found[~pushes] -= least[len(reaction) :]
    return np.asarray(reaction + moving @ (moving.T @ (size * found - reaction)))


def _ties_among(ties: Floats, present: Bools) -> Floats:
    """Ties (g, e) of the groups that are present alone."""
    from scipy.linalg import null_space

    absent = ties[~present]
    return ties @ null_space(absent, rcond=_STILL) if absent.any() else ties


def _by_tie(found: Discretisation, dependence: Dependence, which: Ints) -> list[set[int]]:
    """Supports of points, one set for each group, and for each tie of groups."""
    row = np.flatnonzero(np.isin(dependence.points, which))
    who, group = found.points.support[dependence.points[row]], dependence.group[row]
    sets: dict[int, set[int]] = {}
    for support, one in zip(who.tolist(), group.tolist(), strict=True):
        sets.setdefault(one, set()).add(support)
    tied = [np.flatnonzero(tie).tolist() for tie in dependence.ties.T]
    across = [set().union(*(sets[one] for one in groups if one in sets)) for groups in tied]
    return [*sets.values(), *(found_there for found_there in across if found_there)]


def _merged(sets: Sequence[Iterable[int]]) -> list[set[int]]:
    """Unite sets that have something in common; in the order of their least."""
    out: list[set[int]] = []
    for one in map(set, sets):
        common = [other for other in out if other & one]
        out = [other for other in out if not other & one] + [one.union(*common)]
    return sorted(out, key=min)


def _force(found: Discretisation, nodal: Floats, answer: Answer) -> float:
    """The largest nodal load or reaction; without load what bends the plate by its deflection.

    Couples count by the force they are at the plate's size apart.
    """
    size = found.mesh.size
    forces = np.abs(nodal.reshape(-1, 3)).max(axis=0) / [1.0, size, size]
    bending = 0.0
    if not nodal.any():
        bending = found.model.young * found.thickness.max() ** 3 / 12 * float(np.abs(answer.hi[::3]).max())
    return max(float(forces.max()), bending / size**2, float(np.abs(answer.reaction).max(initial=0.0))) or 1.0


def _with_least_deflection(
    found: Discretisation, freedom: RigidFreedom, nodal: Floats, answer: Answer, elsewhere: Elsewhere | None
) -> Answer:
    one_sided = ~found.contacts.two_sided
    pushing = one_sided & (answer.reaction > _NIL * _force(found, nodal, answer))
    # Of a load without a resultant the plate's own forces may leave more in its stops than that.
    rounding = np.finfo(float).eps * found.plate.internal_magnitude(found.held.dofs, answer.hi, answer.lo)
    if (answer.reaction[pushing] <= rounding).all():
        pushing[:] = False
    free = _unmoved(freedom.moves[pushing], freedom.count)
    if free.shape[1] and elsewhere is not None:
        for reaction in elsewhere():
            # Where a path begins without load all reactions are rounding.
            pushing |= one_sided & (reaction > max(_NIL * float(np.abs(reaction).max()), rounding))
        free = _unmoved(freedom.moves[pushing], freedom.count)
    if not free.shape[1]:
        return answer
    length = np.maximum(float(np.abs(answer.hi[::3]).max()), np.abs(found.contacts.distance))
    idle = np.flatnonzero(one_sided & ~pushing)
    gap = np.where(answer.gap > _NIL * length, answer.gap, 0.0)
    sides = freedom.moves[idle] @ free
    ways = free @ span_of_cone(sides[gap[idle] == 0.0])
    if not ways.shape[1]:
        return answer
    motions = freedom.motions @ free
    over = area_quadrature(found.mesh)
    values = found.mesh.shape_functions(over.elements, over.xi)
    root = np.sqrt(over.weights)
    at = np.column_stack([np.ones(len(root)), (over.positions - found.middle) / found.mesh.size])
    deflection = (values * (answer.hi + answer.lo)[::3][found.mesh.elements[over.elements]]).sum(axis=1)
    unit = float(np.abs(deflection).max()) or 1.0
    part = least(root[:, None] * (at @ motions), root * deflection / unit, sides, gap[idle] / unit)
    w, *slopes = unit * (motions @ part)
    x, y = found.middle.tolist()
    motion = (float(w), float(slopes[0] / found.mesh.size), float(slopes[1] / found.mesh.size))
    hi, lo = found.plate.moved(answer.hi, answer.lo, (x, y), motion)
    left = found.plate.openings(*found.contacts.rows.arrays, found.contacts.distance, hi, lo)
    length = np.maximum(float(np.abs(hi[::3]).max()), np.abs(found.contacts.distance))
    # Of where the plate was, the motion leaves a rounding.
    nil = np.maximum(_NIL * length, _ROUNDING * float(np.abs(answer.hi[::3]).max()))
    closed = ~one_sided | pushing | (left <= nil)
    # What pushes so little does not push.
    reaction, shared = answer.reaction.copy(), answer.shared.copy()
    reaction[one_sided & ~pushing] = shared[: len(reaction)][one_sided & ~pushing] = 0.0
    several = NotUnique("deflection", motion=_in_words(freedom.motions @ ways, found))
    return replace(
        answer,
        hi=hi,
        lo=lo,
        reaction=reaction,
        shared=shared,
        gap=np.where(closed, 0.0, left),
        closed=closed,
        not_unique=(*answer.not_unique, several),
    )


def _unmoved(moves: Floats, count: int) -> Floats:
    """Motions (d, e) that do not move points, given how these go with each (k, d)."""
    if not len(moves):
        return np.eye(count)
    _, values, basis = np.linalg.svd(np.linalg.qr(moves, mode="r"))
    return np.asarray(basis[int((values > _STILL * max(1.0, values[0])).sum()) :].T)


def _in_words(ways: Floats, found: Discretisation) -> str:
    match ways.shape[1]:
        case 1:
            return describe_motion(ways[:, 0] / np.abs(ways[:, 0]).max(), found)
        case 2:
            return "by two rigid motions and what is between them"
        case _:
            return "by any small rigid motion"
