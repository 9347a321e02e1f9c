"""Contact points that say again, or against one another, what the plate is held to already."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array, eye_array, vstack

from signorini.discretise.frames import Held
from signorini.discretise.rank import SAME, followers, lengths, parallel, times, within
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.supports import ContactPoints
from signorini.errors import InputError, point
from signorini.mesh import Mesh
from signorini.model import Model

_CONSISTENT = 1e-9
_MOST_MADE = 2_000
"""Two-sided points up to which others are made of one-sided ones."""
_MOST = 10_000
"""Two-sided points between nodes; to tell which follow from others takes a dense matrix of them."""


@dataclass(frozen=True, eq=False)
class Repeated:
    """Points (r,) that follow from two-sided ones, which carry the reactions of all in the equations.

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

    def shares(self, contacts: ContactPoints, reaction: Floats) -> Floats:
        """Reactions (m + r,) of contact points and those that repeat them, of which none with one way pulls.

        Where others hold the plate from the other side, these carry what is negative of a reaction (m,).
        """
        shares = np.concatenate([reaction, np.zeros(len(self))])
        pulling = np.flatnonzero(contacts.two_sided & contacts.one_way & (reaction < 0.0))
        if len(pulling):
            # Those that follow from others, too, would have a part in these.
            alone = np.diff(self.follows.indptr) == 1
            against = csr_array(self.follows[:, pulling] * alone[:, None]).tocsc()
            against.eliminate_zeros()
            for column, leader in enumerate(pulling.tolist()):
                own = slice(*against.indptr[column : column + 2])
                other = int(np.argmin(against.data[own]))
                shares[len(reaction) + against.indices[own][other]] = reaction[leader] / against.data[own][other]
                shares[leader] = 0.0
        return shares

    def by_sign(self, contacts: ContactPoints) -> Ints:
        """Number the equations whose reaction is shared by its sign, since points with one way have part in it."""
        mine = contacts.two_sided & contacts.one_way
        mine[self.follows[np.flatnonzero(self.points.one_way)].indices] = True
        return np.flatnonzero(mine)

    def pick(self, which: Bools) -> Repeated:
        """Keep the points marked."""
        return Repeated(self.points.pick(which), self.follows[np.flatnonzero(which)])


def that_can_act(model: Model, mesh: Mesh, held: Held, contacts: ContactPoints) -> tuple[ContactPoints, Repeated]:
    """Leave out points that can neither open nor close because others hold the plate there.

    Those that are held at every dof carry nothing. One-sided ones at which the plate is held from the other side, too,
    are one equation. Two-sided ones that follow from others are set apart, but those that do nothing to what results
    tell: slopes, and points of a line or area that follow from others of the same.

    Raises
    ------
    InputError
        If rigid ones contradict each other or a held dof.
    """
    kept, opposed = _held_from_both_sides(mesh, _not_held(mesh, held, contacts), held)
    kept, repeated = _independent(mesh, held, kept, opposed)
    return kept, repeated.pick(_is_told(model, kept, repeated))


def _is_told(model: Model, contacts: ContactPoints, repeated: Repeated) -> Bools:
    """Whether results tell the reaction of a repeated point, or of another support that it may take some from."""
    mine = repeated.points.support
    at_points = np.array([support.at is not None for support in model.support], np.bool_)[mine]
    owner, of = repeated.follows.nonzero()
    with_others = np.zeros(len(repeated), np.bool_)
    with_others[owner[contacts.support[of] != mine[owner]]] = True
    return np.asarray(~repeated.points.slope & (at_points | with_others | repeated.points.one_way))


def _held_from_both_sides(mesh: Mesh, contacts: ContactPoints, held: Held) -> tuple[ContactPoints, Repeated]:
    """Make one equation of rigid points that hold the plate from both sides at one place and level."""
    none = Repeated(contacts.pick(np.zeros(0, np.int64)), csr_array((0, len(contacts))))
    up = contacts.direction > 0
    free = (contacts.compliance == 0) & ~contacts.slope
    one_way = contacts.one_way & free
    if not one_way.any() or not ((free & ~one_way).any() or ((one_way & up).any() and (one_way & ~up).any())):
        return contacts, none
    mine = np.flatnonzero(free)
    rows = held.bodies.onto_leaders(contacts.rows[mine].matrix(mesh.elements, len(held.dofs)))
    group, scale = parallel(rows, lengths(rows))
    level, one_way = contacts.distance[mine] / scale, one_way[mine]
    count = int(group.max()) + 1
    most, least = np.full(count, np.inf), np.full(count, -np.inf)
    from_above, from_below = ~one_way | (scale > 0), ~one_way | (scale < 0)
    np.minimum.at(most, group[from_above], level[from_above])
    np.maximum.at(least, group[from_below], level[from_below])
    both = np.abs(most - least) <= SAME * np.minimum(np.abs(most), np.abs(least))
    touching = np.flatnonzero(both[group])
    at = most[group[touching]]
    touching = touching[np.abs(level[touching] - at) <= SAME * np.abs(at)]
    # Equations first, so that no other is made where there is one.
    touching = touching[np.argsort(one_way[touching], kind="stable")]
    leader = np.full(count, -1)
    leader[group[touching[::-1]]] = touching[::-1]
    follow = touching[one_way[touching] & (leader[group[touching]] != touching)]
    follow.sort()
    leads = leader[group[follow]]
    if not len(follow) or np.count_nonzero(contacts.two_sided) + len(np.unique(leads)) > _MOST_MADE:
        return contacts, none
    stay, two_sided = np.ones(len(contacts), np.bool_), contacts.two_sided.copy()
    stay[mine[follow]], two_sided[mine[leads]] = False, True
    place = np.cumsum(stay) - 1
    shape = len(follow), int(stay.sum())
    follows = csr_array((scale[follow] / scale[leads], (np.arange(len(follow)), place[mine[leads]])), shape=shape)
    kept = replace(contacts, two_sided=two_sided).pick(stay)
    return kept, Repeated(contacts.pick(mine[follow]), follows)


def _not_held(mesh: Mesh, held: Held, contacts: ContactPoints) -> ContactPoints:
    """Leave out points whose every dof is held, unless they are compliant and pressed there."""
    if not held.dofs.any():
        return contacts
    rows = held.bodies.onto_leaders(contacts.rows.matrix(mesh.elements, len(held.dofs)))
    fixed = ~((abs(rows) > SAME) @ ~held.dofs)
    moved = rows @ held.values
    beyond = moved - contacts.distance
    beyond[contacts.two_sided] = np.abs(beyond[contacts.two_sided])
    pressed = beyond > _CONSISTENT * np.maximum(np.abs(moved), np.abs(contacts.distance))
    rigid = contacts.compliance == 0
    # Settlements that meet at zero are rounded by their size elsewhere.
    by_length = np.where(contacts.slope, mesh.size, 1.0)
    at_nodes = np.abs(held.values.reshape(-1, 3) * [1.0, mesh.size, mesh.size]).max()
    largest = max(at_nodes, np.abs(by_length * contacts.distance)[rigid].max(initial=0.0))
    rounding = _CONSISTENT * min(largest, mesh.size) / by_length
    pressed &= ~rigid | (beyond > rounding)
    contradicted = fixed & pressed & rigid
    if contradicted.any():
        first = int(np.argmax(contradicted))
        raise _contradiction(mesh, contacts, first, float(beyond[first]))
    return contacts.pick(~fixed | _with_its_other_way(contacts, fixed & pressed))


def _with_its_other_way(contacts: ContactPoints, which: Bools) -> Bools:
    """Mark, beside the rows marked, those of the same points' travel the other way."""
    if not which.any():
        return which
    spots = np.column_stack([contacts.support, contacts.slope, contacts.positions])
    _, spot = np.unique(spots, axis=0, return_inverse=True)
    return np.isin(spot, spot[which])


def _independent(mesh: Mesh, held: Held, contacts: ContactPoints, repeated: Repeated) -> tuple[ContactPoints, Repeated]:
    """Set apart two-sided points that follow from other two-sided ones, beside those that are set apart already."""
    equations = np.flatnonzero(contacts.two_sided)
    if len(equations) < 2:
        return contacts, repeated
    if len(equations) > _MOST:
        raise InputError(
            f"Found {len(equations)} rigid points between the mesh's nodes that hold both ways; at most {_MOST} can be "
            "told apart. Hold an edge, or a line or circle that the mesh follows, or give a stiffness.",
            place=("support", int(contacts.support[equations[0]])),
        )
    points = contacts.pick(equations)
    whole = held.bodies.onto_leaders(points.rows.matrix(mesh.elements, len(held.dofs)))
    free = within(whole, ~held.dofs)
    scale = lengths(free)
    found = followers(times(free, 1.0 / scale))
    if not len(found.rows):
        return contacts, repeated
    # The distance of a row that follows must be the same combination of the others'.
    travel = (points.distance - whole @ held.values) / scale
    apart = np.abs(travel[found.rows] - found.combinations @ travel)
    if (wrong := apart > _CONSISTENT * max(np.abs(travel).max(), np.abs(points.distance).max())).any():
        first = int(np.argmax(wrong))
        raise _contradiction(mesh, points, int(found.rows[first]), float(apart[first]))
    stay = np.ones(len(contacts), np.bool_)
    stay[equations[found.rows]] = False
    # By unit rows; reactions go by the rows as they are.
    follows = found.combinations.tocoo()
    which, of = follows.coords
    follows.data *= scale[found.rows][which] / scale[of]
    place = np.cumsum(stay) - 1
    shape = len(found.rows), int(stay.sum())
    combinations = csr_array((follows.data, (which, place[equations[of]])), shape=shape)
    # Every point as a combination of those that stay.
    order = place.copy()
    order[equations[found.rows]] = shape[1] + np.arange(shape[0])
    of_staying = vstack([eye_array(shape[1], format="csr"), combinations], format="csr")[order]
    apart = ContactPoints.join([repeated.points, points.pick(found.rows)])
    return contacts.pick(stay), Repeated(apart, vstack([repeated.follows @ of_staying, combinations], format="csr"))


def _contradiction(mesh: Mesh, contacts: ContactPoints, which: int, by: float) -> InputError:
    at = point(contacts.positions[which], mesh.size)
    return InputError(
        f"Supports contradict each other at {at}: others hold the plate there, and this rigid one is "
        f"{by:g} in its way. Correct a gap or a settlement, or give a stiffness.",
        place=("support", int(contacts.support[which])),
    )
