"""Whether reactions exist that balance a load: decided on the plate as a rigid body, before anything is factorized.

Reactions of one-sided supports have a sign, so by Farkas' lemma they balance the load exactly if no rigid motion that
every support allows lets the load do work. The motion with the most work is found by a linear program in at most
three unknowns. Supports reach as far as their outlines, whatever the mesh.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass

import numpy as np

from signorini.discretise import Discretisation
from signorini.discretise.outlines import outline
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.equilibrium.tipping import clean, line_in_words, steepest
from signorini.errors import InputError

_RANK = 1e-9
"""Rigid motions of unit size that move a support by less than this part of the plate's size do not move it."""
_MANY = 100
"""Points from which on their hull is taken."""

_MOST_NUMBERS = 1 << 20
"""Numbers in memory at once."""

_COARSE = 1e-5
"""Part of the load below which the tolerances of a linear program, 1e-7, count in an extra load."""

_WORK = 1e-10
"""Work below this part of the load times the motion is rounding."""


@dataclass(frozen=True, eq=False)
class Bearing:
    """Places at which one-sided supports act, of many that act the same way the corners of their hull.

    Parameters
    ----------
    positions : (k, 2) array
    moves : (k, d) array
        How far each of the free rigid motions presses the plate into the support there.
    support : (k,) array
    """

    positions: Floats
    moves: Floats
    support: Ints


@dataclass(frozen=True, eq=False)
class RigidFreedom:
    """What the bilateral supports leave free.

    Parameters
    ----------
    motions : (3, d) array
        Basis of the free rigid motions; components are w, and the slopes times the plate's size, about its middle.
    moves : (m, d) array
        How each contact point's row changes with them; two-sided points are among the bilateral supports.
    outline : Bearing
        The outlines of one-sided supports: they decide whether the plate can be balanced.
    on_mesh : Bearing
        Their contact points: they decide whether the mesh can show it.
    regular : bool
        Whether held dofs and springs alone hold the plate, so that K has an inverse.
    """

    motions: Floats
    moves: Floats
    outline: Bearing
    on_mesh: Bearing
    regular: bool

    @property
    def count(self) -> int:
        """Number of free rigid motions."""
        return int(self.motions.shape[1])


def rigid_freedom(found: Discretisation) -> RigidFreedom:
    """Find the rigid motions that held dofs, springs and two-sided points leave free.

    Raises
    ------
    InputError
        If a motion meets no support at all, one-sided ones included: the plate is a mechanism.
    """
    size = found.mesh.size
    scaled = found.rigid_motions / np.array([1.0, size, size])
    contacts = found.contacts
    at_contacts = found.contact_rows @ scaled
    # A held slope is compared with slopes times the plate's size.
    held = scaled[found.held.dofs] * np.tile([1.0, size, size], found.mesh.node_count)[found.held.dofs, None]
    at_contacts[contacts.slope] *= size
    in_stiffness = np.vstack([held, found.spring_rows @ scaled])
    motions = _null_space(np.vstack([in_stiffness, at_contacts[contacts.two_sided]]))
    moves = at_contacts @ motions
    loose = motions @ _null_space(moves) if motions.size else np.zeros((3, 0))
    if loose.size:
        raise InputError(
            f"Nothing holds the plate against this motion: {_name_motion(loose, found)}. "
            "Add a support that resists it (points that are not all on one line, or an edge or area).",
            place=("support",),
        )
    one_sided = contacts.pick(~contacts.two_sided)
    on_mesh = _bearing(found, motions, one_sided.positions, one_sided.direction, one_sided.support)
    regular = _null_space(in_stiffness).shape[1] == 0
    return RigidFreedom(motions, moves, _outlines(found, motions), on_mesh, regular)


def _outlines(found: Discretisation, motions: Floats) -> Bearing:
    """The outlines of the supports that have one-sided points."""
    contacts = found.contacts
    ways = np.column_stack([contacts.support, contacts.direction])[~contacts.two_sided]
    positions, directions, supports = [np.zeros((0, 2))], [np.zeros(0)], [np.zeros(0, np.int64)]
    for index, direction in np.unique(ways, axis=0):
        reach = outline(found.mesh, found.model.plate, found.model.support[int(index)])
        positions.append(reach)
        directions.append(np.full(len(reach), direction))
        supports.append(np.full(len(reach), int(index)))
    return _bearing(found, motions, np.concatenate(positions), np.concatenate(directions), np.concatenate(supports))


def _bearing(found: Discretisation, motions: Floats, positions: Floats, directions: Floats, supports: Ints) -> Bearing:
    from scipy.spatial import ConvexHull, QhullError

    deciding = []
    for direction in (1.0, -1.0):
        those = np.flatnonzero(directions == direction)
        if len(those) > _MANY:
            # On one line there is no hull, and every point stays.
            with contextlib.suppress(QhullError):
                those = those[np.sort(ConvexHull(positions[those]).vertices)]
        deciding.append(those)
    which = np.concatenate(deciding)
    at = np.column_stack([np.ones(len(which)), (positions[which] - found.middle) / found.mesh.size])
    return Bearing(positions[which], directions[which, None] * (at @ motions), supports[which])


def _null_space(rows: Floats) -> Floats:
    if not len(rows):
        return np.eye(rows.shape[1])
    # The Gram matrix has at most three columns, whatever the number of rows; QR keeps the small singular values.
    _, values, basis = np.linalg.svd(np.linalg.qr(rows, mode="r"))
    rank = int((values > _RANK * max(1.0, values[0])).sum()) if len(values) else 0
    return np.asarray(basis[rank:].T)


def _name_motion(loose: Floats, found: Discretisation) -> str:
    if loose.shape[1] == 3:
        return "any rigid motion, it has no support"
    if loose.shape[1] == 2:
        return "turning about a point in two directions"
    return describe_motion(loose[:, 0], found)


def describe_motion(motion: Floats, found: Discretisation) -> str:
    """Say what a rigid motion (3,) is: of w, and of the slopes times the plate's size, about its middle."""
    w, *slopes = motion / np.array([1.0, found.mesh.size, found.mesh.size])
    turning = np.hypot(*slopes)
    if turning * found.mesh.size < 1e-6 * abs(w):
        return "moving up and down"
    normal = np.array(slopes) / turning
    through = found.middle - w / turning * normal
    along = np.array([-normal[1], normal[0]])
    along *= 1.0 if (along > 1e-9).any() and along[np.abs(along) > 1e-9][0] > 0 else -1.0
    return f"turning about the line through {_point(through, found)} along {_point(along)}"


def _point(at: Floats, found: Discretisation | None = None) -> str:
    """A point of a plate, or a direction, without the digits that are rounding."""
    size = found.mesh.size if found else 1.0
    return f"[{clean(at[0], size)}, {clean(at[1], size)}]"


def restraining_points(freedom: RigidFreedom, stiffness: Floats) -> Ints:
    """Contact points, as few as there are free motions, that hold them when closed; stiff and far apart if possible.

    ``stiffness`` (m,) is that of each point's support, or as much of it as counts.
    """
    from scipy.linalg import qr

    if not freedom.count:
        return np.zeros(0, dtype=np.int64)
    # Each pick is the longest column that is left, and lengths, being convex, are greatest at corners of the hull.
    columns = freedom.moves.T * np.sqrt(stiffness / stiffness.max())
    _, _, order = qr(columns, mode="economic", pivoting=True)
    return np.asarray(order[: freedom.count], dtype=np.int64)


def load_size(found: Discretisation, nodal: Floats) -> float:
    """Sum of a nodal load's magnitudes; couples count by the force they are at the plate's size apart."""
    return float(np.abs(nodal[::3]).sum() + np.abs(nodal.reshape(-1, 3)[:, 1:]).sum() / found.mesh.size)


def work_of(found: Discretisation, freedom: RigidFreedom, nodal: Floats) -> Floats:
    """Work (d,) of a nodal load on the free motions."""
    size = found.mesh.size
    return np.asarray((found.rigid_motions.T @ nodal / np.array([1.0, size, size])) @ freedom.motions)


def allowed_motions(bearing: Bearing) -> Floats:
    """The extreme rays (r, d) of the cone of free rigid motions that a bearing allows, each of unit size.

    Reactions balance a load exactly if it does no work in any of them. With at most three components a ray lies in
    d − 1 of the planes that the points set, and on the allowed side of all others.
    """
    one_sided = bearing.moves
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
    rays = rays[size > _RANK * size.max(initial=0.0)] / size[size > _RANK * size.max(initial=0.0), None]
    rays = np.concatenate([rays, -rays])
    # A few at a time: many points make more pairs than there is memory for all their motions.
    parts = np.array_split(rays, 1 + len(rays) * len(one_sided) // _MOST_NUMBERS)
    return np.concatenate([part[(part @ one_sided.T).max(axis=1, initial=-np.inf) <= _RANK] for part in parts])


def no_equilibrium(found: Discretisation, freedom: RigidFreedom, nodal: Floats) -> str:
    """Say why no reactions balance the nodal load (3n,), or return nothing where they exist.

    Raises
    ------
    InputError
        If they exist, but the contact points of the mesh do not reach as far as they act.
    """
    if way := _lifting(found, freedom, nodal):
        return _explain_lifting(found, freedom, nodal, way)
    best = _tipping(found, freedom, nodal)
    if best is None:
        _require_reach(found, freedom, nodal)
        return ""
    return _explain_tipping(found, freedom, nodal, freedom.motions @ best, freedom.outline.moves @ best)


def tipping_axis(found: Discretisation, freedom: RigidFreedom, nodal: Floats) -> Floats | None:
    """Two points (2, 2) of the line about which a load tips the plate, as far apart as the plate is large."""
    best = None if _lifting(found, freedom, nodal) else _tipping(found, freedom, nodal)
    if best is None:
        return None
    w, *slopes = (freedom.motions @ best) / np.array([1.0, found.mesh.size, found.mesh.size])
    normal = np.array(slopes) / np.hypot(*slopes)
    foot = found.middle - w / np.hypot(*slopes) * normal
    return np.asarray(foot + np.outer([-0.5, 0.5], [-normal[1], normal[0]]) * found.mesh.size)


def _tipping(found: Discretisation, freedom: RigidFreedom, nodal: Floats) -> Floats | None:
    """The motion (d,) that every support allows on which the load does most work for its turning, if there is one."""
    best = _unresisted(found, freedom, freedom.outline, nodal)
    if best is None:
        return None
    most = steepest(freedom.motions, freedom.outline.moves, work_of(found, freedom, nodal) / load_size(found, nodal))
    return np.asarray(best if most is None else most)


def _unresisted(found: Discretisation, freedom: RigidFreedom, bearing: Bearing, nodal: Floats) -> Floats | None:
    """The motion (d,) of at most unit size that a bearing allows on which the load does most work, if there is one."""
    from scipy.optimize import linprog

    total = load_size(found, nodal)
    if not freedom.count or total == 0:
        return None
    work, one_sided = work_of(found, freedom, nodal), bearing.moves
    best = linprog(
        -work / total,
        A_ub=one_sided,
        b_ub=np.zeros(len(one_sided)),
        bounds=(-1, 1),
        method="highs",
        # By default 1e-7 of the load may be overlooked, which a certificate sees.
        options={"primal_feasibility_tolerance": _WORK, "dual_feasibility_tolerance": _WORK},
    )
    return None if best.x is None or work @ best.x <= _WORK * total else np.asarray(best.x)


def _require_reach(found: Discretisation, freedom: RigidFreedom, nodal: Floats) -> None:
    """Refuse a load that the supports can balance on their outlines, but not at the contact points of the mesh."""
    if _unresisted(found, freedom, freedom.on_mesh, nodal) is None:
        return
    down, mx, my = found.rigid_motions.T @ nodal
    where = (
        ""
        if abs(down) <= _WORK * load_size(found, nodal)
        else (f" near {_point(found.middle + np.array([mx, my]) / down, found)}")
    )
    raise InputError(
        f"The load acts{where} so near the outline of the supports that they can balance it, but not at the contact "
        "points of this mesh, which lie within that outline. Take a finer mesh there.",
        place=("mesh",),
    )


def _lifting(found: Discretisation, freedom: RigidFreedom, nodal: Floats) -> str:
    """Which way the plate moves off all its supports without turning, if it does."""
    one_sided, least = freedom.outline.moves, _WORK * load_size(found, nodal)
    work = work_of(found, freedom, nodal)
    for way, w in (("up", -1.0), ("down", 1.0)):
        motion = np.array([w, 0.0, 0.0])
        part = motion @ freedom.motions
        free = np.abs(freedom.motions @ part - motion).max() <= _RANK
        if free and (one_sided @ part).max(initial=0.0) <= _RANK and work @ part > least:
            return way
    return ""


def _holding(found: Discretisation, freedom: RigidFreedom, nodal: Floats, best: Floats, way: str) -> str:
    """What least extra load would hold the plate, at the best point or, if none does there, amid the supports."""
    for at in (best, freedom.outline.positions.mean(axis=0)):
        node = found.mesh.points[((found.mesh.points - at) ** 2).sum(axis=1).argmin()]
        least = _least_holding(found, freedom, nodal, node, way)
        if least is not None:
            unit = f" {found.model.units.force}" if found.model.units.force else ""
            return f" An extra {least:.6g}{unit} {way} at {_point(node, found)} would just hold it."
    return ""


def _least_holding(found: Discretisation, freedom: RigidFreedom, nodal: Floats, at: Floats, way: str) -> float | None:
    """Least extra load at a point with which reactions balance the load, by a linear program in them."""
    from scipy.optimize import linprog

    size = found.mesh.size
    # The conditions of equilibrium over the free motions, forces in units of the load and lengths of the plate.
    scale = np.array([1.0, size, size])
    resultant = (found.rigid_motions.T @ nodal / scale) @ freedom.motions
    total = float(np.abs(resultant).max())
    sign = 1.0 if way == "down" else -1.0
    extra = sign * (np.array([1.0, *(at - found.middle)]) / scale) @ freedom.motions
    one_sided = freedom.outline.moves
    cost = np.zeros(1 + len(one_sided))
    cost[0] = 1.0
    balance = np.column_stack([-extra, one_sided.T])
    least = linprog(cost, A_eq=balance, b_eq=resultant / total, bounds=(0, None), method="highs")
    if least.x is None or least.x[0] > _COARSE:
        return None if least.x is None else total * float(least.x[0])
    # So little is within what the program lets pass: it is told by the motions that the load would win.
    rays = allowed_motions(freedom.outline)
    needed, helped = rays @ resultant / total, -(rays @ extra)
    helping = (helped > _RANK) & (needed > 0.0)
    return total * float((needed[helping] / helped[helping]).max()) if helping.any() else None


def _explain_lifting(found: Discretisation, freedom: RigidFreedom, nodal: Floats, way: str) -> str:
    force_unit = found.model.units.force
    unit = f" {force_unit}" if force_unit else ""
    down, mx, my = found.rigid_motions.T @ nodal
    verb = "lifts off" if way == "up" else "drops away from"
    text = (
        f"The plate {verb} its supports: the load's resultant is {abs(down):.6g}{unit} {way}, and no support resists "
        "that way."
    )
    acting = found.middle + np.array([mx, my]) / down
    return text + _holding(found, freedom, nodal, acting, "down" if way == "up" else "up")


def _explain_tipping(
    found: Discretisation, freedom: RigidFreedom, nodal: Floats, motion: Floats, opening: Floats
) -> str:
    size, middle, force_unit = found.mesh.size, found.middle, found.model.units.force
    length_unit = found.model.units.length
    moment_unit = f" {force_unit} {length_unit}".rstrip() if force_unit else ""
    w, *slopes = motion / np.array([1.0, size, size])
    turning = float(np.hypot(*slopes))
    normal = np.array(slopes) / turning
    offset = w / turning - float(normal @ middle)
    work = found.rigid_motions.T @ nodal
    moment = float(work @ np.array([w, *slopes])) / turning
    names = _hinges(found, freedom, np.abs(opening) <= 1e-7 * np.abs(opening).max(initial=0.0))
    # Weight holds it best where the motion lifts the plate most.
    lift = -(found.mesh.points @ normal + offset)
    farthest = int(lift.argmax())
    axis = f"the line {line_in_words(normal, offset, size)}"
    text = f"The plate tips about {axis}{names}, short by a moment of {moment:.6g}{moment_unit}."
    if lift[farthest] <= 1e-9 * size:
        return text
    return text + _holding(found, freedom, nodal, found.mesh.points[farthest], "down")


def _hinges(found: Discretisation, freedom: RigidFreedom, closed: Bools) -> str:
    positions, supports = freedom.outline.positions[closed], freedom.outline.support[closed]
    if not len(positions):
        return ""
    owners = [found.model.support[i].name for i in np.unique(supports)]
    spots = ", ".join(_point(at, found) for at in positions[:4]) + (", ..." if len(positions) > 4 else "")
    return f" through {spots} of {', '.join(owners)}"
