"""Rigid motions that supports leave free, and the work of loads on them."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from signorini.discretise import Discretisation
from signorini.discretise.laws import field_of
from signorini.discretise.places import outline
from signorini.discretise.rows import RANK, Floats, Ints, null_space
from signorini.errors import InputError, point
from signorini.shapes.extent import hull

NO_FORCE = 1e-6
"""Largest resultant that counts as zero, relative to the sum of the forces. The resultant of a load along an arc has
such an error, since element sides are parabolas.
"""
_HELD = 1e-4
"""Smallest stiffness against a rigid motion at which supports hold this motion, relative to the required stiffness. At
this stiffness the solution loses four of sixteen digits.
"""
_PLANE = np.array([1.0, 1.0j])
"""Vector whose product with a position (x, y) is the complex number x + iy, by which equal positions are found."""
_MANY = 100
"""Largest number of support positions that are all kept. More positions are reduced to corners of their convex hull."""

_MOST_NUMBERS = 1 << 20
"""Largest number of products (ray of rigid motions times displacements of a support position) in memory at once."""


@dataclass(frozen=True, eq=False)
class Bearing:
    """Positions (k, 2) at which one-sided supports act, with bounds of their forces.

    Many positions with one direction are replaced by the corners of their convex hull. ``moves`` (k, d) are the
    displacements into the support in the d free rigid motions. ``support`` (k,) are the numbers of the supports.
    ``least`` and ``most`` (k,) bound the force at each position.
    """

    positions: Floats
    moves: Floats
    support: Ints
    least: Floats
    most: Floats

    @property
    def limited(self) -> bool:
        """Whether any force has a bound other than force ≥ 0."""
        return bool(np.isfinite(self.most).any() or self.least.any())


@dataclass(frozen=True, eq=False)
class RigidFreedom:
    """Rigid motions that held dofs, springs and two-sided points leave free.

    The columns of ``motions`` (3p, d) are a basis of these motions of p plates: for each plate w at the middle of the
    mesh, and two slopes times the mesh's size. ``moves`` (m, d) are the displacements of contact points in these
    motions. Reactions on the ``outline`` of one-sided supports decide whether the load can be balanced. Reactions at
    the contact points ``on_mesh`` decide whether this mesh can represent the balance. ``regular`` says that K is
    regular, since held dofs and springs hold the plate. ``unheld`` (3p, h) are the motions that held dofs leave free.
    ``of_springs`` (s, 3p) and ``at_contacts`` (m, 3p) are displacements of springs and contact points in all 3p rigid
    motions.
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

    Raise `InputError` for a mechanism: a rigid motion with zero displacement at all held dofs, springs and contact
    points.
    """
    contacts = discretisation.contacts
    size = discretisation.mesh.size
    scaled = discretisation.scaled_motions
    at_contacts, of_springs = discretisation.contact_rows @ scaled, discretisation.spring_rows @ scaled
    at_contacts[contacts.slope] *= size
    of_springs[discretisation.springs.slope] *= size
    # Slopes are multiplied by the plate's size, so that they can be compared with deflections.
    held = (
        scaled[discretisation.held.dofs]
        * np.tile([1.0, size, size], discretisation.mesh.node_count)[discretisation.held.dofs, None]
    )
    in_stiffness = np.vstack([held, of_springs])
    motions = null_space(np.vstack([in_stiffness, at_contacts[contacts.holds_both_ways]]))
    moves = at_contacts @ motions
    mechanism = motions @ null_space(moves) if motions.size else np.zeros((len(motions), 0))
    if mechanism.size:
        raise InputError(
            f"Nothing holds the plate against this motion: {_name_motion(mechanism, discretisation)}. "
            "Add a support that resists it (points that are not all on one line, or an edge or area).",
            place=("support",),
        )
    one_sided = contacts.pick(~contacts.two_sided)
    on_mesh = _bearing(discretisation, motions, one_sided.positions, one_sided.direction, one_sided.support)
    outlines = _outlines(discretisation, motions)
    least, most = one_sided.limits
    if least.any() or np.isfinite(most).any():
        # Each contact point has a force limit of its own, so that all points are needed, not only corners of the hull.
        moves_one_sided = moves[~contacts.two_sided]
        on_mesh = outlines = Bearing(one_sided.positions, moves_one_sided, one_sided.support, least, most)
    regular = null_space(in_stiffness).shape[1] == 0
    rows = (null_space(held), of_springs, at_contacts)
    return RigidFreedom(motions, moves, outlines, on_mesh, regular, *rows)


def _outlines(discretisation: Discretisation, motions: Floats) -> Bearing:
    """`Bearing` with positions on the outlines of all supports that have one-sided points."""
    contacts = discretisation.contacts
    # Support number and direction are combined in one integer, which sorts faster than pairs.
    support_and_direction = (2 * contacts.support + (contacts.direction > 0))[~contacts.two_sided]
    positions, directions, supports = [np.zeros((0, 2))], [np.zeros(0)], [np.zeros(0, np.int64)]
    for index, up in zip(*np.divmod(np.unique(support_and_direction), 2), strict=True):
        if field_of(discretisation.model.support[index]) is not None:
            # A stiffness given as a table may be 0 on part of the outline; the contact points exclude this part.
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
    # With several plates, each support has a convex hull of its own, since it may belong to another plate.
    groups = supports if discretisation.plates else np.zeros_like(supports)
    for group, direction in itertools.product(np.unique(groups), (1.0, -1.0)):
        members = np.flatnonzero((groups == group) & (directions == direction))
        if len(members) > _MANY:
            corners = hull(positions[members]) @ _PLANE
            members = members[np.isin(positions[members] @ _PLANE, corners)]
        deciding.append(members)
    which = np.concatenate(deciding)
    arms = _arms(discretisation, positions[which], supports[which])
    zeros = np.zeros(len(which))
    return Bearing(positions[which], directions[which, None] * (arms @ motions), supports[which], zeros, zeros + np.inf)


def _outline(discretisation: Discretisation, index: int) -> Floats:
    """Points (k, 2) with the same convex hull as support number ``index``."""
    plate = next(plate for plate in discretisation.members if index in plate.numbers["support"])
    support = plate.own.model.support[plate.numbers["support"].index(index)]
    return outline(plate.own.mesh, plate.own.model.plate, support.where)


def _arms(discretisation: Discretisation, positions: Floats, supports: Ints) -> Floats:
    """Downward displacements (k, 3p) at positions (k, 2) of supports in each rigid motion of p plates.

    Motions are as in `RigidFreedom`. For a support between two plates the displacement is that of the upper plate minus
    that of the lower plate.
    """
    arms = np.column_stack([np.ones(len(positions)), (positions - discretisation.middle) / discretisation.mesh.size])
    names = [plate.name for plate in discretisation.members]
    result = np.zeros((len(positions), len(names), 3))
    for index in np.unique(supports):
        support, of_support = discretisation.model.support[index], supports == index
        upper, *lower = (support.between or (support.plate or "",)) if discretisation.plates else ("",)
        result[of_support, names.index(upper)] = arms[of_support]
        for name in lower:
            result[of_support, names.index(name)] = -arms[of_support]
    return result.reshape(len(positions), 3 * len(names))


def _name_motion(mechanism: Floats, discretisation: Discretisation) -> str:
    if discretisation.plates:
        return describe_motion(mechanism[:, 0], discretisation)
    if mechanism.shape[1] == 3:
        return "any rigid motion, it has no support"
    if mechanism.shape[1] == 2:
        return "turning about every line through one point"
    return describe_motion(mechanism[:, 0], discretisation)


def describe_motion(motion: Floats, discretisation: Discretisation) -> str:
    """Text for a rigid motion (3p,), which is given as in `RigidFreedom`."""
    if discretisation.plates and len(motion) > 3:
        return " and ".join(
            f'"{plate.name}" {describe_motion(of_plate, discretisation)}'
            for plate, of_plate in zip(discretisation.plates, motion.reshape(-1, 3), strict=True)
            if np.abs(of_plate).max() > RANK * np.abs(motion).max()
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
    """Numbers of contact points that, with held dofs and springs, hold all rigid motions with stiffness ``enough``.

    The array is empty if held dofs and springs suffice. Otherwise it contains the two-sided points and, if these do not
    suffice, at most one further point for each motion, stiff and far from the others. ``stiffness`` (m,) is that of
    each contact point; values above ``enough`` are cut off.
    """
    unheld, two_sided = freedom.unheld, np.flatnonzero(discretisation.contacts.two_sided)
    # A rotational stiffness is divided by the plate's size squared, so that it can be compared with the others.
    spring_stiffness = (
        discretisation.springs.stiffness / np.where(discretisation.springs.slope, discretisation.mesh.size, 1.0) ** 2
    )
    springs = np.sqrt(np.minimum(spring_stiffness, enough))[:, None] * (freedom.of_springs @ unheld)
    points = np.sqrt(np.minimum(stiffness, enough))[:, None] * (freedom.at_contacts @ unheld)

    def is_held(rows: Floats) -> bool:
        return not unheld.shape[1] or bool(np.linalg.eigvalsh(rows.T @ rows)[0] >= _HELD * enough)

    if is_held(springs):
        return two_sided[:0]
    always = np.vstack([springs, points[two_sided]])
    if is_held(always):
        return two_sided
    # Gram-Schmidt with pivoting: each step takes the longest remaining row, whose point is far from those taken before.
    rest, picked = np.vstack([springs, points]), two_sided.tolist()
    for _ in range(unheld.shape[1]):
        lengths = np.linalg.norm(rest, axis=1)
        longest = int(lengths.argmax())
        if longest >= len(springs):
            picked.append(longest - len(springs))
        along = rest[longest] / lengths[longest]
        rest = rest - np.outer(rest @ along, along)
    return np.array(picked, dtype=np.int64)


def load_size(discretisation: Discretisation, nodal: Floats) -> float:
    """Sum of the magnitudes of nodal forces, and of nodal couples divided by the plate's size."""
    return float(np.abs(nodal[::3]).sum() + np.abs(nodal.reshape(-1, 3)[:, 1:]).sum() / discretisation.mesh.size)


def work_of(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats) -> Floats:
    """Work (d,) of nodal loads (3n,) in the d free rigid motions."""
    return np.asarray((discretisation.scaled_motions.T @ nodal) @ freedom.motions)


def allowed_motions(bearing: Bearing) -> Floats | None:
    """Extreme rays (r, d), of unit maximum norm, of the cone of free rigid motions that one-sided supports allow.

    Reactions balance a load exactly if the load does no positive work in any ray. With d ≤ 3 a ray lies in d − 1 of the
    planes that the points of ``bearing`` define, and on the allowed side of all other planes. None if d > 3 or if
    supports have limits: then a linear program decides.
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
    # Rays are tested in several parts, since the products of all rays with all points may exceed the memory.
    parts = np.array_split(rays, 1 + len(rays) * len(one_sided) // _MOST_NUMBERS)
    return np.concatenate([part[(part @ one_sided.T).max(axis=1, initial=-np.inf) <= RANK] for part in parts])
