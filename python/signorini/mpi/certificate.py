"""The errors of a certificate over the ranks; formulas and reference sizes are those of `contact.certificate`."""

from __future__ import annotations

import numpy as np

from signorini.contact.certificate import FIGURES, NIL, UNSEEN, off_laws, ratio
from signorini.discretise.rows import Floats
from signorini.mpi.newton import Problem, Solution


def errors(problem: Problem, solution: Solution) -> dict[str, float]:
    """Errors of a solution by the names of `FIGURES`, equal on all ranks."""
    part, contacts, springs = problem.part, problem.part.contacts, problem.part.springs
    size, largest, owned = part.size, problem.largest, problem.owned
    hi, lo, reaction = solution.hi, solution.lo, solution.reaction

    def by_kind(values: Floats) -> tuple[float, float]:
        """Largest magnitudes, over the nodes of all ranks, of values (3n,) at deflections and of values at slopes."""
        of_nodes = np.where(owned, values, 0.0).reshape(-1, 3)
        return largest(of_nodes[:, 0]), largest(of_nodes[:, 1:])

    def by_force(values: Floats) -> float:
        force, couple = by_kind(values)
        return max(force, couple / part.element_size)

    def reach(values: Floats) -> float:
        """Sum Σ |F_i| maxⱼ |R_ij| over all ranks, for nodal forces F (3n,) and rigid motions R."""
        return total((np.abs(values) * np.abs(part.motions).max(axis=1))[owned])

    def total(values: Floats) -> float:
        return float(problem.sum(np.array([values.sum()]))[0])

    imbalance, pushes = problem.residual(hi, lo), problem.rows.T @ reaction
    holding = np.where(part.held, imbalance - pushes, 0.0)
    pull = -springs.stiffness * problem.plate.openings(*springs.rows.arrays, springs.distance, hi, lo)
    supports = holding + springs.rows.matrix(part.elements, len(hi)).T @ pull + pushes

    deflection, slope = by_kind(hi)
    least_rigidity, rigidity = part.bending
    forces = np.abs(part.nodal.reshape(-1, 3)[owned[::3]])
    loads = (total(forces[:, 0]) + total(forces[:, 1:]) / size) * size**2 / least_rigidity
    unloaded = loads == 0.0
    arm = np.where(contacts.slope, size, 1.0)
    travel = UNSEEN * arm * np.abs(contacts.distance)
    prescribed = max(by_kind(part.held_values)[1], largest(contacts.distance[contacts.slope]))
    settled = largest(springs.distance * np.where(springs.slope, size, 1.0))
    most_travel = largest(travel)
    length = max(deflection, NIL * loads, UNSEEN * prescribed * size)
    length = max(length, most_travel, UNSEEN * settled) if unloaded else length
    slope = max(slope, length / size)

    motions, w = part.motions[::3][owned[::3]], hi[::3][owned[::3]]
    coefficients = np.linalg.lstsq(problem.sum(motions.T @ motions), problem.sum(motions.T @ w), rcond=None)[0]
    bent = length if unloaded else min(largest(w - motions @ coefficients), length)
    least = UNSEEN * rigidity * bent / size**2
    least = max(least, part.shear * max(UNSEEN * length, most_travel)) if unloaded else least
    most_reaction = largest(reaction / arm)
    by_load = by_force(part.nodal)
    force_size = max(by_load or max(by_force(holding), most_reaction), least)
    reaction_size = max(force_size, most_reaction)
    resultant = np.abs(problem.sum(part.motions[owned].T @ (part.nodal - supports)[owned])).max()
    resultant_size = max(reach(part.nodal), reach(supports), least)

    lengths = np.where(contacts.slope, slope, np.maximum(travel, length)) + (length == 0.0)
    sizes = arm * (reaction_size or 1.0)
    travels = problem.travel(hi, lo)
    off = off_laws(contacts, *(values[None] for values in (travels, reaction, lengths, sizes)))
    slip = by_kind(np.where(part.held, hi + lo - part.held_values, 0.0))
    found = (
        max(largest(off[0]), float(ratio(slip[0], length)), float(ratio(slip[1], slope))),
        largest(off[2]),
        largest(off[1]),
        float(ratio(by_force(np.where(part.held, 0.0, imbalance - pushes)), force_size)),
        float(ratio(resultant, resultant_size)),
    )
    return dict(zip(FIGURES, found, strict=True))
