"""What the figures of a certificate are made of and compared with: resultants, and sizes of forces and deflections."""

from __future__ import annotations

import functools

import numpy as np

from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats


def forces_at_nodes(
    discretisation: Discretisation, hi: Floats, lo: Floats, reaction: Floats, at: Bools | None = None
) -> tuple[float, float]:
    """Largest sum of what cancels at one of the dofs ``at`` (3n,): in the plate, and between its supports.

    Their rounding is what arithmetic leaves out of balance. Without ``at`` the dofs are those that are free. Examples
    are in `signorini.contact.refusal`.
    """
    at = ~discretisation.held.dofs if at is None else at
    across = float(np.sqrt(discretisation.mesh.element_area.mean()))
    internal = discretisation.plate.internal_magnitude(~at, hi, lo)
    pushes = np.where(at, push_magnitudes(discretisation, hi, lo, reaction), 0.0)
    return float(internal), float(by_force(pushes[None], across)[0])


def push_magnitudes(discretisation: Discretisation, hi: Floats, lo: Floats, reaction: Floats) -> Floats:
    """Sums (3n,) of the magnitudes that supports push with.

    Those that nearly repeat each other push against each other, and their forces are carried as doubles.
    """
    pull = np.abs(discretisation.spring_forces(hi, lo))
    return np.asarray(abs(discretisation.contact_rows).T @ np.abs(reaction) + abs(discretisation.spring_rows).T @ pull)


def resultants_and_sizes(discretisation: Discretisation, nodal: Floats, against: Floats) -> tuple[Floats, Floats]:
    """Largest resultants (k,) of loads (k, 3n) and of what supports set against them, and the whole sizes."""
    size = discretisation.mesh.size
    # Threads of a linear algebra library would cost more than these sums.
    resultant = np.einsum("ij,ki->kj", discretisation.rigid_motions, nodal - against) / np.array([1.0, size, size])
    return largest_magnitudes(resultant), maximum(reaching(discretisation, nodal), reaching(discretisation, against))


def scaled_motions(discretisation: Discretisation) -> Floats:
    """Deflections of one (3n, 3) of the rigid motions about the middle, those that turn over the plate's size."""
    return np.asarray(
        discretisation.rigid_motions / np.array([1.0, discretisation.mesh.size, discretisation.mesh.size])
    )


def reaching(discretisation: Discretisation, nodal: Floats) -> Floats:
    """Sums (...,) of the magnitudes that nodal forces (..., 3n) have in a resultant."""
    moves = discretisation.rigid_motions.T
    turning = np.maximum(np.abs(moves[1]), np.abs(moves[2])) / discretisation.mesh.size
    return np.asarray((np.abs(nodal) * np.maximum(np.abs(moves[0]), turning)).sum(axis=-1))


def bending_part(discretisation: Discretisation, deflection: Floats) -> Floats:
    """Deflections (k, n) of the nodes without the rigid motions nearest to them."""
    motions = discretisation.rigid_motions[::3]
    return np.asarray(deflection - (motions @ np.linalg.lstsq(motions, deflection.T)[0]).T)


def loaded_deflection(discretisation: Discretisation, nodal: Floats) -> Floats:
    """Deflections (...,) by which loads (..., 3n) scale on the plate."""
    forces, *couples = np.moveaxis(np.abs(nodal.reshape(*nodal.shape[:-1], -1, 3)).sum(axis=-2), -1, 0)
    size = discretisation.mesh.size
    return np.asarray(
        (forces + sum(couples) / size) * size**2 / rigidity(discretisation, discretisation.thickness.min())
    )


def bending_force(discretisation: Discretisation, hi: Floats) -> float:
    """Force that bends the plate as far as a deflection (3n,) is from a plane."""
    area = float(discretisation.mesh.element_area.sum())
    bent = float(np.abs(bending_part(discretisation, hi[None, ::3])).max())
    return rigidity(discretisation, discretisation.thickness.min()) * bent * area / discretisation.mesh.size**4


def rigidity(discretisation: Discretisation, thickness: float) -> float:
    """Bending stiffness E t³/12 of a thickness, Poisson's ratio left out."""
    return discretisation.model.young * float(thickness) ** 3 / 12


def by_force(nodal: Floats, across: float) -> Floats:
    """Largest of nodal forces (k, 3n); couples count by the force they are at an element's size apart."""
    return largest_magnitudes(nodal.reshape(len(nodal), -1, 3) / [1.0, across, across])


def largest_magnitudes(values: Floats) -> Floats:
    """Largest magnitudes (k,) of values (k, ...); NaN where there is one."""
    return np.asarray(np.abs(values).reshape(len(values), -1).max(axis=1, initial=0.0))


def maximum(*sizes: Floats | float) -> Floats:
    """The largest of each; NaN where there is one."""
    return np.asarray(functools.reduce(np.maximum, sizes))


def ratio(error: Floats | float, size: Floats | float) -> Floats:
    """Errors over sizes: none of no error, infinite of no size."""
    error, size = np.asarray(error), np.asarray(size)
    part = np.where(size > 0.0, error / np.where(size > 0.0, size, 1.0), np.inf)
    return np.asarray(np.where(error == 0.0, 0.0, part))
