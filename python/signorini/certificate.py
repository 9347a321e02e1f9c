"""The certificate: how far an answer is from a solution, computed by code that did not solve it.

It takes the displacements, reactions and the statement of the problem, and recomputes gaps, nodal forces and the
three global balances from them. It reads no factor, no condensed matrix, and no status.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats
from signorini.problem import spring_arrays

TOLERANCE = 1e-8
_ROUNDINGS = 4.0
"""Units of rounding, of the internal forces that cancel at a node, below which no imbalance can be seen."""
_NIL = 1e-6
"""Deflections below this part of F a²/D are rounding of the elimination."""

_BLOCK = 1 << 12
"""Rows in extended precision at a time."""

FIGURES = ("penetration", "tension", "complementarity", "equilibrium", "balance")


@dataclass(frozen=True)
class Certificate:
    """Errors of an answer, each relative to a size stated here; ``passed`` means all are within tolerance.

    Parameters
    ----------
    penetration : float
        Deepest penetration, or largest violation of a held deflection, over the largest deflection or gap, or, where
        supports leave none, a millionth of the deflection F a²/D by which the load F scales on a plate of size a.
    tension : float
        Largest reaction of the wrong sign over the largest reaction or nodal load.
    complementarity : float
        Largest product of a reaction and its gap over the product of the sizes these two are judged by.
    equilibrium : float
        Largest nodal force out of balance over the largest nodal load (couples over the element size).
    balance : float
        Largest of the three global resultants out of balance over the sum of the load's magnitudes.
    equilibrium_limit, balance_limit : float
        What double precision can show of the two for this plate: thin plates' internal forces are so much larger than
        their loads that their rounding counts. A figure over the tolerance is judged by its limit; 0 where none is.
    """

    penetration: float
    tension: float
    complementarity: float
    equilibrium: float
    balance: float
    equilibrium_limit: float = 0.0
    balance_limit: float = 0.0

    @property
    def limited(self) -> bool:
        """Whether arithmetic limits a figure that passed."""
        return self.passed and max(self.equilibrium, self.balance) > TOLERANCE

    @property
    def passed(self) -> bool:
        """Whether every figure is within tolerance."""
        limits = {"equilibrium": self.equilibrium_limit, "balance": self.balance_limit}
        return all(getattr(self, name) <= max(TOLERANCE, limits.get(name, TOLERANCE)) for name in FIGURES)

    def __str__(self) -> str:
        """Say it in a line."""
        figures = ", ".join(f"{name} {getattr(self, name):.1e}" for name in FIGURES)
        limits = f"equilibrium to {self.equilibrium_limit:.0e}, balance to {self.balance_limit:.0e}"
        note = f"; arithmetic limits {limits}" if self.limited else ""
        return f"{'passed' if self.passed else 'failed'}: {figures}{note}"


def certify(found: Discretisation, load: CaseLoad, hi: Floats, lo: Floats, reaction: Floats) -> Certificate:
    """Judge displacements ``hi + lo`` (3n,) and the contact points' reactions (m,) under a load.

    Examples
    --------
    >>> from signorini import Model
    >>> from signorini.problem import contact_problem
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     mesh={"divisions": [4, 4]},
    ...     support=[{"edge": ["left"], "fix": "clamped"}, {"at": [4, 2], "resists": "down"}],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> problem = contact_problem(model)
    >>> found, load = problem.discretisation, problem.discretisation.cases["load"]
    >>> answer = problem.solve(load)
    >>> certify(found, load, answer.hi, answer.lo, answer.reaction).passed
    True
    >>> certify(found, load, answer.hi, answer.lo, -answer.reaction).passed
    False
    """
    contacts, held = found.contacts, found.held
    with np.errstate(invalid="ignore"):
        imbalance = found.plate.residual(spring_arrays(found), load.nodal, hi, lo)
        imbalance = imbalance - found.contact_rows.T @ reaction
        at_holds = np.where(held.dofs, imbalance, 0.0)
        at_free = np.where(held.dofs, 0.0, imbalance).reshape(-1, 3)

        gap = _gap(found, hi, lo, reaction)
        length = max(
            _largest(hi[::3]), _largest(contacts.distance), _largest(held.values), _nil_deflection(found, load)
        )
        slip = np.abs(np.where(held.dofs, hi + lo - held.values, 0.0))[::3]
        open_by = np.where(contacts.two_sided, np.abs(gap), -gap)
        one_sided = np.where(contacts.two_sided, 0.0, reaction)

        across = float(np.sqrt(found.mesh.element_area.mean()))
        forces = _nodal_size(load.nodal, across)
        # Under no load every force is rounding: at least that of a deflection carried over the plate.
        rigidity = found.model.material.E * found.thickness.max() ** 3 / 12
        rest = float(np.finfo(float).eps * rigidity * length / found.mesh.size**2)
        scale = max(forces or _nodal_size(at_holds, across) or _largest(reaction), rest)
        pressing = max(scale, _largest(reaction))
        figures = {
            "penetration": _ratio(max(_largest(np.maximum(open_by, 0.0)), _largest(slip)), length),
            "tension": _ratio(_largest(np.maximum(-one_sided, 0.0)), pressing),
            "complementarity": _ratio(_largest(one_sided * np.where(contacts.two_sided, 0.0, gap)), pressing * length),
            "equilibrium": _ratio(_nodal_size(at_free.ravel(), across), scale),
            "balance": _balance(found, load.nodal, hi + lo, at_holds, reaction, rest),
        }
    if max(figures["equilibrium"], figures["balance"]) <= TOLERANCE:
        return Certificate(**figures)
    rounding = _ROUNDINGS * np.finfo(float).eps * found.plate.internal_magnitude(held.dofs, hi, lo)
    # Roundings of the dofs add up as in a random walk.
    resultant = rounding * np.sqrt(found.dof_count)
    total = float(np.abs(load.nodal[::3]).sum()) or float(np.abs(at_holds[::3]).sum())
    return Certificate(**figures, equilibrium_limit=_ratio(rounding, scale), balance_limit=_ratio(resultant, total))


def _gap(found: Discretisation, hi: Floats, lo: Floats, reaction: Floats) -> Floats:
    """Gaps (m,) in extended precision, a block of rows at a time: of all of them a copy would outweigh the plate."""
    contacts, displacement = found.contacts, hi.astype(np.longdouble) + lo
    gap = contacts.compliance * reaction
    for first in range(0, len(gap), _BLOCK):
        block = slice(first, first + _BLOCK)
        rows = found.contact_rows[block]
        extended = csr_array((rows.data.astype(np.longdouble), rows.indices, rows.indptr), shape=rows.shape)
        gap[block] += contacts.distance[block] - extended @ displacement
    return gap


def _balance(
    found: Discretisation, nodal: Floats, displacement: Floats, at_holds: Floats, reaction: Floats, rest: float
) -> float:
    """The three resultants of load and reactions, from the supports' forces alone."""
    springs, size = found.springs, found.mesh.size
    pull = springs.stiffness * (found.spring_rows @ displacement - springs.base)
    against = at_holds + found.spring_rows.T @ pull + found.contact_rows.T @ reaction
    motions = found.rigid_motions / np.array([1.0, size, size])
    total = max(np.abs(nodal) @ np.abs(motions).max(axis=1), np.abs(against) @ np.abs(motions).max(axis=1))
    return _ratio(_largest(motions.T @ (nodal - against)), max(float(total), rest))


def _nil_deflection(found: Discretisation, load: CaseLoad) -> float:
    """Deflection that counts as none under a load."""
    forces, *couples = np.abs(load.nodal.reshape(-1, 3)).sum(axis=0)
    size, material = found.mesh.size, found.model.material
    rigidity = material.E * float(found.thickness.min()) ** 3 / 12
    return _NIL * float(forces + sum(couples) / size) * size**2 / rigidity


def _nodal_size(nodal: Floats, across: float) -> float:
    """Largest nodal force; couples count by the force they are at an element's size apart."""
    forces, *couples = nodal.reshape(-1, 3).T
    return max(_largest(forces), *(_largest(couple) / across for couple in couples))


def _largest(values: Floats) -> float:
    """Largest magnitude; NaN where there is one."""
    return float(np.abs(values).max(initial=0.0))


def _ratio(error: float, size: float) -> float:
    return 0.0 if error == 0.0 else error / size if size > 0.0 else float("inf")
