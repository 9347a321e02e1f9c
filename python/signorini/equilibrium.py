"""Whether reactions exist that balance a load: decided on the plate as a rigid body, before anything is factorized.

Reactions of one-sided supports have a sign, so by Farkas' lemma they balance the load exactly if no rigid motion that
every support allows lets the load do work. The motion with the most work is found by a linear program in at most
three unknowns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr
from scipy.optimize import linprog

from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats, Ints
from signorini.errors import InputError

_RANK = 1e-9
"""Rigid motions of unit size that move a support by less than this part of the plate's size do not move it."""
_WORK = 1e-10
"""Work below this part of the load times the motion is rounding."""


@dataclass(frozen=True, eq=False)
class RigidFreedom:
    """What the bilateral supports leave free.

    Parameters
    ----------
    motions : (3, d) array
        Basis of the free rigid motions; components are w, and the slopes times the plate's size, about its middle.
    moves : (m, d) array
        How each contact point's row changes with them; two-sided points are among the bilateral supports.
    regular : bool
        Whether held dofs and springs alone hold the plate, so that K has an inverse.
    """

    motions: Floats
    moves: Floats
    regular: bool

    @property
    def count(self) -> int:
        """Number of free rigid motions."""
        return self.motions.shape[1]


def rigid_freedom(found: Discretisation) -> RigidFreedom:
    """Find the rigid motions that held dofs, springs and two-sided points leave free.

    Raises
    ------
    InputError
        If a motion meets no support at all, one-sided ones included: the plate is a mechanism.
    """
    size = found.mesh.size
    scaled = found.rigid_motions / np.array([1.0, size, size])
    elements, contacts = found.mesh.elements, found.contacts

    def moved(rows_of: object) -> Floats:
        return np.column_stack([rows_of.dot(elements, motion) for motion in scaled.T])  # type: ignore[attr-defined]

    at_contacts = moved(contacts.rows)
    # A held slope is compared with slopes times the plate's size.
    held = scaled[found.held.dofs] * np.tile([1.0, size, size], found.mesh.node_count)[found.held.dofs, None]
    at_contacts[contacts.slope] *= size
    in_stiffness = np.vstack([held, moved(found.springs.rows)])
    motions = _null_space(np.vstack([in_stiffness, at_contacts[contacts.two_sided]]))
    moves = at_contacts @ motions
    loose = motions @ _null_space(moves) if motions.size else np.zeros((3, 0))
    if loose.size:
        raise InputError(
            f"Nothing holds the plate against this motion: {_name_motion(loose, found)}. "
            "Add a support that resists it (points that are not all on one line, or an edge or area).",
            place="support",
        )
    return RigidFreedom(motions, moves, regular=_null_space(in_stiffness).shape[1] == 0)


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
    return _describe(loose[:, 0], found)


def _describe(motion: Floats, found: Discretisation) -> str:
    w, *slopes = motion / np.array([1.0, found.mesh.size, found.mesh.size])
    turning = np.hypot(*slopes)
    if turning * found.mesh.size < 1e-6 * abs(w):
        return "moving up and down"
    normal = np.array(slopes) / turning
    through = found.middle - w / turning * normal
    along = np.array([-normal[1], normal[0]])
    return f"turning about the line through {_point(through)} along {_point(along)}"


def _point(at: Floats) -> str:
    x, y = (round(float(value), 6) + 0.0 for value in at)
    return f"[{x:g}, {y:g}]"


def restraining_points(freedom: RigidFreedom) -> Ints:
    """Contact points, as few as there are free motions, that hold them when closed; far apart where they can be."""
    if not freedom.count:
        return np.zeros(0, dtype=np.int64)
    _, _, order = qr(freedom.moves.T, mode="economic", pivoting=True)
    return np.asarray(order[: freedom.count], dtype=np.int64)


def no_equilibrium(found: Discretisation, freedom: RigidFreedom, nodal: Floats) -> str:
    """Say why no reactions balance the nodal load (3n,), or return nothing where they exist."""
    if not freedom.count:
        return ""
    size = found.mesh.size
    work = (found.rigid_motions.T @ nodal / np.array([1.0, size, size])) @ freedom.motions
    total = np.abs(nodal[::3]).sum() + np.abs(nodal.reshape(-1, 3)[:, 1:]).sum() / size
    if total == 0:
        return ""
    one_sided = freedom.moves[~found.contacts.two_sided]
    best = linprog(-work / total, A_ub=one_sided, b_ub=np.zeros(len(one_sided)), bounds=(-1, 1), method="highs")
    if best.status != 0 or -best.fun <= _WORK:
        return ""
    motion = freedom.motions @ best.x
    return _explain(found, freedom, nodal, motion, one_sided @ best.x)


def _explain(found: Discretisation, freedom: RigidFreedom, nodal: Floats, motion: Floats, opening: Floats) -> str:
    size, middle, force_unit = found.mesh.size, found.middle, found.model.units.force
    length_unit = found.model.units.length
    unit = f" {force_unit}" if force_unit else ""
    moment_unit = f" {force_unit} {length_unit}".rstrip() if force_unit else ""
    w, *slopes = motion / np.array([1.0, size, size])
    turning = float(np.hypot(*slopes))
    down = float(nodal[::3].sum())
    if turning * size < 1e-6 * abs(w):
        way = "up" if w < 0 else "down"
        return (
            f"The plate moves {way}, away from its supports: the load's resultant is {abs(down):.6g}{unit} {way}, and no "
            f"support resists it. {abs(down):.6g}{unit} more the other way would balance it."
        )
    normal = np.array(slopes) / turning
    offset = w / turning - float(normal @ middle)
    work = found.rigid_motions.T @ nodal
    moment = float(work @ np.array([w, *slopes])) / turning
    names = _hinges(found, np.abs(opening) <= 1e-7 * np.abs(opening).max(initial=0.0))
    # Weight holds it best where the motion lifts the plate most.
    lift = -(found.mesh.points @ normal + offset)
    farthest = int(lift.argmax())
    axis = f"the line {normal[0]:+.6g} x {normal[1]:+.6g} y {offset:+.6g} = 0"
    text = f"The plate tips about {axis}{names}, short by a moment of {moment:.6g}{moment_unit}."
    if lift[farthest] > 1e-9 * size:
        extra = moment / float(lift[farthest])
        text += f" An extra {extra:.6g}{unit} down at {_point(found.mesh.points[farthest])} would just hold it."
    return text


def _hinges(found: Discretisation, closed: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> str:
    contacts = found.contacts.pick(~found.contacts.two_sided).pick(closed)
    if not len(contacts):
        return ""
    owners = [found.model.support[i].name for i in np.unique(contacts.support)]
    spots = ", ".join(_point(at) for at in contacts.positions[:4]) + (", ..." if len(contacts) > 4 else "")
    return f" through {spots} of {', '.join(owners)}"
