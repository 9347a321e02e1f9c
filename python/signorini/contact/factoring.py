"""Factor the core problem of a discretisation: choice of the method, memory, stiffness included in the factor."""

from __future__ import annotations

import math
from typing import Literal, cast

import numpy as np

from signorini import _core
from signorini.base.memory import (
    available,
    fits,
    needed,
    needed_by_points,
    require_memory_for_footprints,
    require_memory_for_points,
)
from signorini.base.reuse import beside
from signorini.discretise import ContactPoints, Discretisation
from signorini.discretise.rows import Floats
from signorini.equilibrium.balance import RigidFreedom, restraining_points
from signorini.errors import InputError, SignoriniError

Method = Literal["lemke", "active_set", "saddle"]
"""Names of the methods; each method has its own factor. "saddle" is the active set on the saddle-point system."""

MOST_POINTS = 6000
"""Largest number of contact points for Lemke's algorithm: its dense matrices must fit into memory beside the factor."""

_FEW = 300
"""Largest number of elastic contact points for which Lemke's algorithm is faster than the active set."""

_FEW_IN_AREAS = 500
"""Largest number of contact points of area supports, elastic or rigid, for which Lemke's algorithm is faster."""

_FEW_RIGID = 3000
"""Largest total number of contact points for which Lemke's algorithm is faster; most are rigid points on lines."""

_CARRIED = 100.0
"""Stiffness in the factor of each contact point that has to restrain rigid motions of the plate, relative to D/a².

It is about the stiffness of a plate under a point load.
"""


def method_of(discretisation: Discretisation) -> Method:
    """Return the method that the input prescribes, or for "auto" the faster method.

    Without one-sided points the input's method is ignored: for few points it is "lemke", without any pivot.
    """
    asked, contacts = discretisation.model.solver.method, discretisation.contacts
    one_sided = ~contacts.two_sided
    if not one_sided.any():
        return "lemke" if len(contacts) <= _FEW_RIGID else "active_set"
    if asked != "auto":
        return asked
    in_areas = np.array([support.area is not None for support in discretisation.model.support])[contacts.support]
    elastic, areal = contacts.compliance[one_sided] > 0, in_areas[one_sided]
    many = elastic.sum() > _FEW or areal.sum() > _FEW_IN_AREAS or len(areal) > _FEW_RIGID
    return "active_set" if many else "lemke"


def can_be_factored(discretisation: Discretisation, method: Method) -> bool:
    """Whether a method's problem fits into the free memory and, for "lemke", has few enough contact points."""
    if method != "lemke":
        # Each contact point is an unknown of the saddle-point system; a mesh has about nine dofs for each element.
        more = len(discretisation.contacts) // 9 if method == "saddle" else 0
        return fits(needed(len(discretisation.mesh.elements) + more))
    points = len(discretisation.contacts)
    return points <= MOST_POINTS and fits(needed(len(discretisation.mesh.elements)) + needed_by_points(points))


def factored(discretisation: Discretisation, freedom: RigidFreedom, method: Method) -> _core.ContactProblem:
    """Order the dofs and factor the matrix of a method; for Lemke's algorithm, condense the plate as well."""
    if method == "lemke":
        points, advice = len(discretisation.contacts), "Take a coarser mesh, or give long lines and areas a stiffness."
        if discretisation.model.solver.method == "lemke":
            advice = 'Leave solver.method at "auto", which condenses fewer points.'
        if points > MOST_POINTS:
            raise InputError(
                f"Found {points} contact points to be condensed; at most {MOST_POINTS} can be condensed. {advice}",
                place=("support",),
            )
        require_memory_for_points(points, advice, ("support",))
        footprints = len(np.unique(discretisation.contacts.rows.further.owners))
        require_memory_for_footprints(footprints, discretisation.dof_count, ("support",))
    return core_problem(
        discretisation, discretisation.contacts, regularization(discretisation, freedom), freedom.motions, method
    )


def core_problem(
    discretisation: Discretisation, contacts: ContactPoints, carried: Floats, motions: Floats, method: Method
) -> _core.ContactProblem:
    """Order and factor a problem for a method; ``carried`` (m,) is δ, the stiffness of each condensed point in K̃.

    In the context of a `Reuse`, the ordering is that of the latest problem of the same plate if its supports are the
    same except for laws, gaps and stiffnesses. The factor is reused too if these do not change it.
    """
    free = available()
    elements, rows, further = contacts.rows.arrays
    others = beside(discretisation.plate)
    try:
        others[method] = _core.ContactProblem(
            discretisation.plate,
            discretisation.held.dofs,
            discretisation.springs.arrays,
            {
                "elements": elements,
                "rows": rows,
                "further": further,
                "distance": contacts.distance,
                "law": contacts.law,
                "scale": contacts.scale,
                "unit": contacts.unit,
                "regularization": carried,
            },
            [(law.vertices, law.ends) for law in contacts.laws],
            motions.T @ discretisation.scaled_motions.T,
            method,
            room=None if math.isinf(free) else int(free),
            like=others.get(method),
        )
        return cast(_core.ContactProblem, others[method])
    except RuntimeError as error:
        if discretisation.zones.element == "q8r":
            raise InputError(
                "The element q8r bends in some shapes without resistance, and here the supports do not prevent this. "
                'Take element = "mitc9" or a finer mesh.',
                place=("plate", "element"),
            ) from None
        why = (
            "The parts of the plate differ too much for double precision. Reduce the differences of the thickness, of "
            "the elements' sides and of the stiffnesses of supports."
        )
        raise InputError(f"The stiffness matrix cannot be factored: {error}. {why}", place=("plate",)) from None
    except MemoryError as error:
        why = str(error)
        raise SignoriniError(f"{why[0].upper()}{why[1:]}. Take a coarser mesh.") from None


def regularization(discretisation: Discretisation, freedom: RigidFreedom) -> Floats:
    """Stiffness (m,) of each contact point that is included in the factor.

    Compliant points have their own stiffness, or 0 if they are stiffer than the plate in shear or have footprints. If
    held dofs and springs alone do not restrain the plate's rigid motions firmly, some more points are included, about
    as stiff as a plate under a point load.
    """
    contacts, thickness = discretisation.contacts, discretisation.thickness.max()
    shear = max(rigidity.in_shear for rigidity in discretisation.zones.rigidities) * thickness
    with np.errstate(divide="ignore"):
        stiffness = np.where(contacts.compliance > 0, 1.0 / contacts.compliance, np.inf)
    carried = np.where(stiffness <= shear, stiffness, 0.0)
    carried[np.unique(contacts.rows.further.owners)] = 0.0
    rigidity = _CARRIED * discretisation.model.young * thickness**3 / 12
    own = rigidity / discretisation.mesh.size**2
    restraining = restraining_points(discretisation, freedom, np.minimum(stiffness, own), own)
    needed = np.zeros(len(contacts))
    needed[restraining] = rigidity
    needed[~contacts.slope] /= discretisation.mesh.size**2
    carried = np.maximum(carried, np.minimum(needed, stiffness))
    return np.asarray(carried)
