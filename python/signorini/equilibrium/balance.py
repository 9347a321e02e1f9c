"""The plate as a rigid body: the motions that its supports leave free, and the work of loads on them."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from signorini.discretise import Discretisation
from signorini.discretise.places import outline
from signorini.discretise.rows import Floats, Ints, null_space
from signorini.errors import InputError, point
from signorini.expression import Field
from signorini.shapes.extent import hull

RANK = 1e-9
"""Rigid motions of unit size that move a support by less than this part of the plate's size do not move it."""
NO_FORCE = 1e-6
"""Relative tolerance for a zero resultant, relative to the acting forces: loads along arcs that cancel leave the error
of parabolas."""
_FIRM = 1e-4
"""Part of a plate's own stiffness with which supports hold all motions firmly: four of sixteen digits."""
_MANY = 100
"""Smallest number of points for which the convex hull is taken."""

_MOST_NUMBERS = 1 << 20
"""Numbers in memory at once."""


@dataclass(frozen=True, eq=False)
class Bearing:
    """Places at which one-sided supports act, of many that act the same way the corners of their hull.

    ``moves`` (k, d) is how far each of the free rigid motions presses the plate into the support there, ``least`` and
    ``most`` (k,) the forces that it can give.
    """

    positions: Floats
    moves: Floats
    support: Ints
    least: Floats
    most: Floats

    @property
    def limited(self) -> bool:
        """Whether a force has an end other than none."""
        return bool(np.isfinite(self.most).any() or self.least.any())


@dataclass(frozen=True, eq=False)
class RigidFreedom:
    """What the bilateral supports leave free.

    ``motions`` (3p, d) are a basis of the free rigid motions of p plates, of each as w and the slopes times the size of
    all, about their middle; ``moves`` (m, d) how each contact point's row changes with them, two-sided points being
    among the bilateral supports. The ``outline`` of one-sided supports decides whether the plate can be balanced, their
    contact points ``on_mesh`` whether the mesh can show it. K is ``regular`` where held dofs and springs alone hold the
    plate; ``unheld`` (3p, h) are motions that held dofs alone leave free. ``of_springs`` (s, 3p) and ``at_contacts``
    (m, 3p) is what springs and contact points do in all motions.
    """

    motions: Floats
    moves: Floats
    outline: Bearing
    on_mesh: Bearing
    regular: bool
    unheld: Floats
    of_springs: Floats
    at_contacts: Floats

    @property
    def count(self) -> int:
        """Number of free rigid motions."""
        return int(self.motions.shape[1])


def rigid_freedom(discretisation: Discretisation) -> RigidFreedom:
    """Find the rigid motions that held dofs, springs and two-sided points leave free.

    A mechanism is refused: a motion that meets no support at all, one-sided ones included.
    """
    contacts = discretisation.contacts
    size = discretisation.mesh.size
    scaled = discretisation.scaled_motions
    at_contacts, of_springs = discretisation.contact_rows @ scaled, discretisation.spring_rows @ scaled
    at_contacts[contacts.slope] *= size
    of_springs[discretisation.springs.slope] *= size
    # A held slope is compared with slopes times the plate's size.
    held = (
        scaled[discretisation.held.dofs]
        * np.tile([1.0, size, size], discretisation.mesh.node_count)[discretisation.held.dofs, None]
    )
    in_stiffness = np.vstack([held, of_springs])
    motions = null_space(np.vstack([in_stiffness, at_contacts[contacts.holds_both_ways]]), RANK)
    moves = at_contacts @ motions
    loose = motions @ null_space(moves, RANK) if motions.size else np.zeros((len(motions), 0))
    if loose.size:
        raise InputError(
            f"Nothing holds the plate against this motion: {_name_motion(loose, discretisation)}. "
            "Add a support that resists it (points that are not all on one line, or an edge or area).",
            place=("support",),
        )
    one_sided = contacts.pick(~contacts.two_sided)
    on_mesh = _bearing(discretisation, motions, one_sided.positions, one_sided.direction, one_sided.support)
    outlines = _outlines(discretisation, motions)
    least, most = one_sided.limits
    if least.any() or np.isfinite(most).any():
        # The capacity of limits depends on the length or area of each point.
        own = moves[~contacts.two_sided]
        on_mesh = outlines = Bearing(one_sided.positions, own, one_sided.support, least, most)
    regular = null_space(in_stiffness, RANK).shape[1] == 0
    rows = (null_space(held, RANK), of_springs, at_contacts)
    return RigidFreedom(motions, moves, outlines, on_mesh, regular, *rows)


def _outlines(discretisation: Discretisation, motions: Floats) -> Bearing:
    """The outlines of the supports that have one-sided points."""
    contacts = discretisation.contacts
    # One number for both: rows of a table are slow to sort.
    ways = (2 * contacts.support + (contacts.direction > 0))[~contacts.two_sided]
    positions, directions, supports = [np.zeros((0, 2))], [np.zeros(0)], [np.zeros(0, np.int64)]
    for index, up in zip(*np.divmod(np.unique(ways), 2), strict=True):
        support = discretisation.model.support[index]
        if isinstance(support.stiffness, Field):
            # Its soil may end within its outline.
            reach = contacts.positions[(contacts.support == index) & ~contacts.two_sided]
        else:
            reach = _outline(discretisation, int(index))
        positions.append(reach)
        directions.append(np.full(len(reach), 2.0 * up - 1.0))
        supports.append(np.full(len(reach), index))
    return _bearing(
        discretisation, motions, np.concatenate(positions), np.concatenate(directions), np.concatenate(supports)
    )


def _bearing(
    discretisation: Discretisation, motions: Floats, positions: Floats, directions: Floats, supports: Ints
) -> Bearing:
    deciding = [np.zeros(0, np.int64)]
    # Supports of one plate depend on places only; supports between plates depend on the pair of plates.
    of = supports if discretisation.plates else np.zeros_like(supports)
    for who, direction in itertools.product(np.unique(of), (1.0, -1.0)):
        those = np.flatnonzero((of == who) & (directions == direction))
        if len(those) > _MANY:
            those = those[np.sort(hull(positions[those]))]
        deciding.append(those)
    which = np.concatenate(deciding)
    at = _arms(discretisation, positions[which], supports[which])
    none = np.zeros(len(which))
    return Bearing(positions[which], directions[which, None] * (at @ motions), supports[which], none, none + np.inf)


def _outline(discretisation: Discretisation, index: int) -> Floats:
    """Points (k, 2) whose hull is that of a support."""
    for plate in discretisation.plates:
        if index in plate.numbers["support"]:
            own = plate.own.model.support[plate.numbers["support"].index(index)]
            return outline(plate.own.mesh, plate.own.model.plate, own.where)
    return outline(discretisation.mesh, discretisation.model.plate, discretisation.model.support[index].where)


def _arms(discretisation: Discretisation, positions: Floats, supports: Ints) -> Floats:
    """Displacements down of supports at positions under rigid motions of p plates, as in `RigidFreedom`: (k, 3p).

    Between two plates it is the displacement of the upper plate relative to the lower one.
    """
    at = np.column_stack([np.ones(len(positions)), (positions - discretisation.middle) / discretisation.mesh.size])
    if not discretisation.plates:
        return at
    result = np.zeros((len(positions), len(discretisation.plates), 3))
    names = [plate.name for plate in discretisation.plates]
    for index in np.unique(supports):
        support, own = discretisation.model.support[index], supports == index
        upper, *lower = support.between or (support.plate or "",)
        result[own, names.index(upper)] = at[own]
        for name in lower:
            result[own, names.index(name)] = -at[own]
    return result.reshape(len(positions), 3 * len(names))


def _name_motion(loose: Floats, discretisation: Discretisation) -> str:
    if discretisation.plates:
        return describe_motion(loose[:, 0], discretisation)
    if loose.shape[1] == 3:
        return "any rigid motion, it has no support"
    if loose.shape[1] == 2:
        return "turning about a point in two directions"
    return describe_motion(loose[:, 0], discretisation)


def describe_motion(motion: Floats, discretisation: Discretisation) -> str:
    """Describe a rigid motion (3p,): w, and the slopes times the size of all plates, about their middle."""
    if discretisation.plates and len(motion) > 3:
        return " and ".join(
            f'"{plate.name}" {describe_motion(own, discretisation)}'
            for plate, own in zip(discretisation.plates, motion.reshape(-1, 3), strict=True)
            if np.abs(own).max() > RANK * np.abs(motion).max()
        )
    w, *slopes = motion / np.array([1.0, discretisation.mesh.size, discretisation.mesh.size])
    turning = np.hypot(*slopes)
    if turning * discretisation.mesh.size < 1e-6 * abs(w):
        return "moving up and down"
    normal = np.array(slopes) / turning
    through = discretisation.middle - w / turning * normal
    along = np.array([-normal[1], normal[0]])
    along *= 1.0 if (along > 1e-9).any() and along[np.abs(along) > 1e-9][0] > 0 else -1.0
    return f"turning about the line through {point(through, discretisation.mesh.size)} along {point(along, 1.0)}"


def restraining_points(discretisation: Discretisation, freedom: RigidFreedom, stiffness: Floats, enough: float) -> Ints:
    """Return contact points that restrain the plate where held dofs and springs do not.

    They are those that act both ways and, if necessary, as few others as there are motions, stiff and far apart.
    ``stiffness`` (m,) is the stiffness of each point, at most ``enough``.
    """
    unheld, two_sided = freedom.unheld, np.flatnonzero(discretisation.contacts.two_sided)
    # A slope is compared with slopes times the plate's size.
    each = discretisation.springs.stiffness / np.where(discretisation.springs.slope, discretisation.mesh.size, 1.0) ** 2
    springs = np.sqrt(np.minimum(each, enough))[:, None] * (freedom.of_springs @ unheld)
    points = np.sqrt(np.minimum(stiffness, enough))[:, None] * (freedom.at_contacts @ unheld)

    def firm(rows: Floats) -> bool:
        return not unheld.shape[1] or bool(np.linalg.eigvalsh(rows.T @ rows)[0] >= _FIRM * enough)

    if firm(springs):
        return two_sided[:0]
    always = np.vstack([springs, points[two_sided]])
    if firm(always):
        return two_sided
    # Each pick is the longest row that is left, and lengths, being convex, are greatest at corners of the hull.
    left, picked = np.vstack([springs, points]), two_sided.tolist()
    for _ in range(unheld.shape[1]):
        lengths = np.linalg.norm(left, axis=1)
        longest = int(lengths.argmax())
        if longest >= len(springs):
            picked.append(longest - len(springs))
        along = left[longest] / lengths[longest]
        left = left - np.outer(left @ along, along)
    return np.array(picked, dtype=np.int64)


def load_size(discretisation: Discretisation, nodal: Floats) -> float:
    """Sum of a nodal load's magnitudes; couples count by the force they are at the plate's size apart."""
    return float(np.abs(nodal[::3]).sum() + np.abs(nodal.reshape(-1, 3)[:, 1:]).sum() / discretisation.mesh.size)


def work_of(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats) -> Floats:
    """Work (d,) of a nodal load on the free motions."""
    return np.asarray((discretisation.scaled_motions.T @ nodal) @ freedom.motions)


def allowed_motions(bearing: Bearing) -> Floats | None:
    """The extreme rays (r, d) of the cone of free rigid motions that a bearing allows, each of unit size.

    Reactions balance a load exactly if it does no work in any of them. With at most three components a ray lies in
    d − 1 of the planes that the points set, and on the allowed side of all others. None of several plates, and where
    supports have limits: there a linear program decides.
    """
    one_sided = bearing.moves
    if bearing.limited or one_sided.shape[1] > 3:
        return None
    match one_sided.shape[1]:
        case 0:
            return np.zeros((0, 0))
        case 1:
            rays = np.ones((1, 1))
        case 2:
            rays = one_sided @ np.array([[0.0, -1.0], [1.0, 0.0]])
        case _:
            first, second = np.triu_indices(len(one_sided), 1)
            rays = np.cross(one_sided[first], one_sided[second])
    size = np.abs(rays).max(axis=1, initial=0.0)
    rays = rays[size > RANK * size.max(initial=0.0)] / size[size > RANK * size.max(initial=0.0), None]
    rays = np.concatenate([rays, -rays])
    # A few at a time: many points make more pairs than there is memory for all their motions.
    parts = np.array_split(rays, 1 + len(rays) * len(one_sided) // _MOST_NUMBERS)
    return np.concatenate([part[(part @ one_sided.T).max(axis=1, initial=-np.inf) <= RANK] for part in parts])
