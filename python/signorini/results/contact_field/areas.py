"""Build the contact of area supports under load and "at rest", that is without load and deflection."""

from __future__ import annotations

import numpy as np

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.laws import can_let_go
from signorini.discretise.rows import Bools, Floats
from signorini.discretise.supports import STIFFEST_SPRING
from signorini.mesh import Mesh
from signorini.model import Support
from signorini.results.contact_field.area_contact import AreaContact, ground_of
from signorini.results.support_points import SupportPoints


def area_contact(
    discretisation: Discretisation, index: int, deflection: Floats, positions: Floats, closed: Bools, reactions: Floats
) -> AreaContact:
    """Contact of an area support, from the deflection (n,), and positions, states and forces of its points (q,)."""
    support, points = discretisation.model.support[index], SupportPoints.of(discretisation, index)
    on_means = points.shares is not None or not support.is_elastic
    stiff = on_means | _stiff(discretisation, support, points)
    return AreaContact(
        *(discretisation.mesh, support, deflection, positions, points.elements, points.weights),
        *(closed, reactions, on_means, stiff, _ground(discretisation, index)),
    )


@kept
def _ground(discretisation: Discretisation, index: int) -> Mesh:
    return ground_of(discretisation.mesh, SupportPoints.of(discretisation, index).elements)


@kept
def area_at_rest(discretisation: Discretisation, index: int) -> AreaContact:
    """Contact of an area support at w = 0, computed once; its methods take other deflections as arguments."""
    positions, flat = SupportPoints.of(discretisation, index).positions, np.zeros(discretisation.mesh.node_count)
    nothing = np.zeros(len(positions))
    return area_contact(discretisation, index, flat, positions, nothing > 0, nothing)


def _stiff(discretisation: Discretisation, support: Support, points: SupportPoints) -> Bools:
    """Mask (ne,) of the elements in which an area is stiffer than the plate.

    If the support's law is linear in both directions, these are the elements in which the area is practically rigid.
    """
    stiff = np.zeros(len(discretisation.mesh.elements), np.bool_)
    if support.modulus is not None:
        at, of_plate = points.elements, discretisation.plate_stiffness
        stiffness = support.modulus(*points.positions.T)
        limit = (
            of_plate.in_waves[at] if can_let_go(support) else STIFFEST_SPRING * of_plate.in_shear[at] / points.weights
        )
        stiff[at[stiffness >= limit]] = True
    return stiff
