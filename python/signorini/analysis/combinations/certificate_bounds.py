"""Certificates of many sums at once, by linearity from what was measured of their terms.

Like `certificate` this reads no factor, no condensed matrix and no status: errors of the terms are recomputed from
their displacements, and a sum's error is at most the sum of theirs. Sizes that errors are divided by are bounded from
below, so that a figure here is never better than the one `certify` would give.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from signorini import _core
from signorini.contact.certificate import FIGURES
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats, Ints

_WATCHED = 64
"""Nodes whose deflections, and dofs whose loads, bound the largest from below."""


@dataclass(frozen=True, eq=False)
class Watch:
    """Nodes all over the plate, and the dofs (node by node, three each) that some load case loads most."""

    nodes: Ints
    dofs: Ints

    @classmethod
    def of(cls, discretisation: Discretisation, cases: Sequence[str]) -> Watch:
        """Choose them; of many load cases some."""
        unit = np.tile(_units(discretisation), discretisation.mesh.node_count)
        some = cases[:: max(1, len(cases) // _WATCHED)]
        dofs = {int(np.abs(discretisation.cases[case].nodal / unit).argmax()) for case in some}
        nodes = np.unique(np.linspace(0, discretisation.mesh.node_count - 1, _WATCHED).astype(np.int64))
        return cls(nodes, np.array(sorted(dofs), dtype=np.int64))


@dataclass(frozen=True, eq=False)
class Sizes:
    """What certificates need of one term.

    Parameters
    ----------
    moved, reaction : (m,) arrays
        Displacement Gu and reaction of every contact point.
    error : float
        Largest nodal force out of balance; couples count by the force they are at an element's size apart.
    slip : float
        Largest violation of a held deflection; slopes count times the plate's size.
    balance, resultant : (3,) arrays
        The resultants that supports do not balance, and those of the load, of what of it has any.
    deflection, load : arrays
        Deflection of the nodes and load on the dofs that are watched.
    """

    moved: Floats
    reaction: Floats
    error: float
    slip: float
    balance: Floats
    resultant: Floats
    deflection: Floats
    load: Floats

    @classmethod
    def of(
        cls,
        discretisation: Discretisation,
        watch: Watch,
        load: CaseLoad,
        hi: Floats,
        lo: Floats,
        reaction: Floats,
        imbalance: Floats,
        on_plate: Floats,
        at_rest: bool,
    ) -> Sizes:
        """Measure a term: displacements ``hi + lo``, what is out of balance, and the supports' forces (3n,) each."""
        rows, held = discretisation.contacts.rows, discretisation.held
        exact = hi.astype(np.longdouble) + lo
        moved = rows.dot(discretisation.mesh.elements, exact)
        unit = _units(discretisation)
        free = np.abs(np.where(held.dofs, 0.0, imbalance).reshape(-1, 3)) / unit
        values = held.values if at_rest else np.zeros_like(held.values)
        lengths = np.array([1.0, discretisation.mesh.size, discretisation.mesh.size])
        slip = np.abs(np.where(held.dofs, hi + lo - values, 0.0)).reshape(-1, 3) * lengths
        motions = discretisation.rigid_motions / lengths
        return cls(
            moved.astype(np.float64),
            reaction,
            float(free.max(initial=0.0)),
            float(slip.max(initial=0.0)),
            motions.T @ (load.weighing - on_plate),
            motions.T @ load.weighing,
            hi[3 * watch.nodes],
            load.nodal[watch.dofs] / unit[watch.dofs % 3],
        )


def _units(discretisation: Discretisation) -> Floats:
    """What turns the three dofs' forces into forces: couples count by the force at an element's size."""
    across = float(np.sqrt(discretisation.mesh.element_area.mean()))
    return np.array([1.0, across, across])


@dataclass(frozen=True, eq=False)
class Proof:
    """What was measured of all terms (b,), see `Sizes`; how points (m,) move with rigid motions, and how they grip."""

    discretisation: Discretisation
    moved: Floats
    reaction: Floats
    error: Floats
    balance: Floats
    resultant: Floats
    deflection: Floats
    load: Floats
    moves: Floats
    grip: Floats

    @classmethod
    def of(cls, discretisation: Discretisation, sizes: Sequence[Sizes]) -> Proof:
        """Put the terms together."""

        def table(name: str) -> Floats:
            return np.ascontiguousarray(np.array([getattr(size, name) for size in sizes]))

        rows = abs(discretisation.contact_rows)
        rows.data /= _units(discretisation)[rows.indices % 3]
        motions = discretisation.rigid_motions / np.array([1.0, discretisation.mesh.size, discretisation.mesh.size])
        return cls(
            discretisation,
            table("moved"),
            table("reaction"),
            np.array([[size.error, size.slip] for size in sizes]),
            table("balance"),
            table("resultant"),
            table("deflection"),
            table("load"),
            np.ascontiguousarray(discretisation.contact_rows @ motions),
            np.ascontiguousarray(rows.max(axis=1).toarray().reshape(-1, 1)),
        )

    def figures(self, coefficients: Floats, reaction: Floats) -> Floats:
        """Bounds (k, 5) of the certificates' figures of sums with coefficients (k, b) and reactions (k, m)."""
        contacts, size = self.discretisation.contacts, self.discretisation.mesh.size
        carried = _core.superpose(coefficients, self.reaction) - reaction
        errors = _core.superpose(np.abs(coefficients), self.error)
        gap = contacts.distance - _core.superpose(coefficients, self.moved) + contacts.compliance * reaction
        balance = _core.superpose(coefficients, self.balance) + _core.superpose(carried, self.moves)
        resultant = np.abs(_core.superpose(coefficients, self.resultant)).max(axis=1, initial=0.0)
        load = np.abs(_core.superpose(coefficients, self.load)).max(axis=1, initial=0.0)
        deflection = np.abs(_core.superpose(coefficients, self.deflection)).max(axis=1, initial=0.0)

        force = np.where(contacts.slope, reaction / size, reaction)
        largest = np.abs(force).max(axis=1, initial=0.0)
        length = np.maximum(deflection, np.abs(self.discretisation.held.values[::3]).max(initial=0.0))
        lengths = np.where(contacts.slope, length[:, None] / size, length[:, None])
        scale = np.where(load > 0, load, largest)
        pressing = np.maximum(scale, largest)
        one_sided = np.where(contacts.two_sided, 0.0, force)
        open_by = np.maximum(np.where(contacts.two_sided, np.abs(gap), -gap), 0.0)
        both = np.minimum(_ratio(np.abs(one_sided), pressing[:, None]), _ratio(np.abs(gap), lengths))
        balanced = np.abs(balance).max(axis=1, initial=0.0)
        figures = {
            "penetration": np.maximum(_ratio(open_by, lengths).max(axis=1, initial=0.0), _ratio(errors[:, 1], length)),
            "tension": _ratio((-one_sided).max(axis=1, initial=0.0), pressing),
            "complementarity": both.max(axis=1, initial=0.0),
            "equilibrium": _ratio(errors[:, 0] + _core.superpose(np.abs(carried), self.grip)[:, 0], scale),
            "balance": _ratio(balanced, np.maximum(resultant, largest)),
        }
        return np.column_stack([figures[name] for name in FIGURES])


def _ratio(error: Floats, size: Floats) -> Floats:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(error == 0.0, 0.0, error / size))
