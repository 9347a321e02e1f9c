"""Terms of the sums that make combinations, and bounds of certificate figures of sums from figures of the terms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from signorini import _core
from signorini.contact.certificate import FIGURES, off_laws
from signorini.contact.problem import ContactProblem
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats, Ints
from signorini.results.line_reactions import lines_of
from signorini.results.quantities import LINEAR, PEAKING
from signorini.results.support_points import SupportPoints
from signorini.singularities.beside import means_of

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


class Sizes(NamedTuple):
    """Quantities of one term for certificates; with a leading axis (b,) those of all terms."""

    moved: Floats
    """(m,): displacement Gu of every contact point."""
    reaction: Floats
    """(m,)"""
    errors: Floats
    """(2,): largest nodal force out of balance, couples by the force they are at an element's size apart; and largest
    violation of a held deflection, slopes times the plate's size."""
    balance: Floats
    """(3,): the resultants that supports do not balance."""
    resultant: Floats
    """(3,): resultants of the load, excluding parts that balance themselves."""
    deflection: Floats
    """Deflections of the watched nodes."""
    load: Floats
    """On the dofs that are watched."""

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
        """Measure a term: displacements ``hi + lo``, residual forces and forces of the supports (3n,) each."""
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
            np.array([free.max(initial=0.0), slip.max(initial=0.0)]),
            motions.T @ (load.weighing - on_plate),
            motions.T @ load.weighing,
            hi[3 * watch.nodes],
            load.nodal[watch.dofs] / unit[watch.dofs % 3],
        )


def _units(discretisation: Discretisation) -> Floats:
    """Divisors (3,) that convert the three nodal forces of a node to forces, couples by the element size."""
    across = float(np.sqrt(discretisation.mesh.element_area.mean()))
    return np.array([1.0, across, across])


@dataclass(frozen=True, eq=False)
class Proof:
    """Quantities of all terms, rigid motions at the points (m, 3), and the largest coefficient of each row (m, 1)."""

    discretisation: Discretisation
    terms: Sizes
    moves: Floats
    grip: Floats

    @classmethod
    def of(cls, discretisation: Discretisation, sizes: Sequence[Sizes]) -> Proof:
        """Put the terms together."""
        rows = abs(discretisation.contact_rows)
        rows.data /= _units(discretisation)[rows.indices % 3]
        motions = discretisation.rigid_motions / np.array([1.0, discretisation.mesh.size, discretisation.mesh.size])
        return cls(
            discretisation,
            Sizes(*map(np.array, zip(*sizes, strict=True))),
            np.ascontiguousarray(discretisation.contact_rows @ motions),
            np.ascontiguousarray(rows.max(axis=1).toarray().reshape(-1, 1)),
        )

    def figures(self, coefficients: Floats, reaction: Floats) -> Floats:
        """Bounds (k, 5) of the certificates' figures of sums with coefficients (k, b) and reactions (k, m)."""
        contacts, size, terms = self.discretisation.contacts, self.discretisation.mesh.size, self.terms
        carried = _core.superpose(coefficients, terms.reaction) - reaction
        errors = _core.superpose(np.abs(coefficients), terms.errors)
        travel = _core.superpose(coefficients, terms.moved) - contacts.distance
        balance = _core.superpose(coefficients, terms.balance) + _core.superpose(carried, self.moves)
        resultant = np.abs(_core.superpose(coefficients, terms.resultant)).max(axis=1, initial=0.0)
        load = np.abs(_core.superpose(coefficients, terms.load)).max(axis=1, initial=0.0)
        deflection = np.abs(_core.superpose(coefficients, terms.deflection)).max(axis=1, initial=0.0)

        force = np.where(contacts.slope, reaction / size, reaction)
        largest = np.abs(force).max(axis=1, initial=0.0)
        length = np.maximum(deflection, np.abs(self.discretisation.held.values[::3]).max(initial=0.0))
        lengths = np.where(contacts.slope, length[:, None] / size, length[:, None])
        scale = np.maximum(np.where(load > 0, load, largest), np.abs(contacts.preload).max(initial=0.0))
        pressing = np.maximum(scale, largest)
        unit = np.where(contacts.slope, size, 1.0) * np.where(pressing > 0.0, pressing, 1.0)[:, None]
        lengths = np.where(lengths > 0.0, lengths, 1.0)
        too_far, too_near, beyond = off_laws(contacts, travel, reaction, lengths, unit)
        balanced = np.abs(balance).max(axis=1, initial=0.0)
        figures = {
            "penetration": np.maximum(too_far.max(axis=1, initial=0.0), _ratio(errors[:, 1], length)),
            "tension": beyond.max(axis=1, initial=0.0),
            "complementarity": too_near.max(axis=1, initial=0.0),
            "equilibrium": _ratio(errors[:, 0] + _core.superpose(np.abs(carried), self.grip)[:, 0], scale),
            "balance": _ratio(balanced, np.maximum(resultant, largest)),
        }
        return np.column_stack([figures[name] for name in FIGURES])


def _ratio(error: Floats, size: Floats) -> Floats:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(error == 0.0, 0.0, error / size))


_TOGETHER = 32
"""Load cases whose displacements are in memory at once."""


@dataclass(frozen=True, eq=False)
class Terms:
    """The terms (b,) of the sum: one at rest, one a load case, one a contact point."""

    cases: tuple[str, ...]
    """The load cases, in the order of the terms."""
    shared: _core.CombinedCases
    """The contact problem condensed for all of them."""
    fields: dict[str, Floats]
    """Those that envelopes are sought of, "reaction" among them."""
    on_areas: Floats
    """(b, k): deflection of the nodes around elastic areas."""
    probes: Floats
    """(b, 8q): every field at every probe."""
    through: Floats
    """(b, 3s): moment, twist and shear of every section, and their means at every station of a strip."""
    fixed: Floats
    """(b, f): upward force of held nodes and springs, support by support."""
    on_lines: Floats
    """(b, v): contribution of twisting couples of edges at the vertices of their lines, line by line."""
    moments: Floats
    """(b, 2t): couples on θx and θy of points that turn, support by support."""
    means: Floats
    """(b, 10k): means at the places of `Beside`."""
    proof: Proof
    """Data of the certificates."""


def terms_of(problem: ContactProblem, cases: Sequence[str], enveloped: Sequence[str], nodes: Ints) -> Terms:
    """Solve for every term.

    The load cases are those that occur in some combination; ``enveloped`` fields have envelopes; the nodes (k,) are
    around elastic areas.
    """
    result, core = problem.discretisation, problem.core
    names = summed(enveloped)
    reader = _Reader(result, names, Watch.of(result, cases), nodes)
    rest = _core.rest_response(core, result.held.values)
    terms = reader.read([rest], None, at_rest=True)
    responses: list[_core.Response] = []
    for first in range(0, len(cases), _TOGETHER):
        loads = [result.cases[case] for case in cases[first : first + _TOGETHER]]
        solved = _core.load_responses(core, np.array([load.nodal for load in loads]))
        terms += reader.read(solved, loads)
        responses += [response.at_points() for response in solved]
    points: list[_core.Response] = []
    for first in range(0, len(result.contacts), _TOGETHER):
        solved = _core.point_responses(core, first, min(first + _TOGETHER, len(result.contacts)))
        terms += reader.read(solved, None)
        points += [response.at_points() for response in solved]
    shared = _core.combined_cases(core, rest, responses, points)
    fields, on_areas, probes, through, fixed, on_lines, moments, means, sizes = zip(*terms, strict=True)
    by_name = dict(zip([*names, "reaction"] if names else [], map(np.array, zip(*fields, strict=True)), strict=True))
    at_areas, at_probes, cut, held = (np.array(column) for column in (on_areas, probes, through, fixed))
    lines, turned = np.array(on_lines), np.array(moments)
    proof = Proof.of(result, sizes)
    return Terms(tuple(cases), shared, by_name, at_areas, at_probes, cut, held, lines, turned, np.array(means), proof)


def summed(enveloped: Sequence[str]) -> list[str]:
    """Fields that are summed for the enveloped fields: these, and moments and shears of derived fields."""
    derived = any(name not in LINEAR for name in enveloped)
    return [name for name in LINEAR if name in enveloped or (derived and name in PEAKING)]


_Term: TypeAlias = tuple[list[Floats], Floats, Floats, Floats, Floats, Floats, Floats, Floats, Sizes]
"""Fields of a term, then the arrays of `Terms` for it."""


class _Reader:
    """Reads the numbers of terms, so that displacements need not stay in memory."""

    def __init__(self, discretisation: Discretisation, names: list[str], watch: Watch, nodes: Ints) -> None:
        self._found, self._names, self._watch, self._nodes = discretisation, names, watch, nodes
        self._springs = discretisation.springs.arrays
        elements, rows, further, stiffness, base = self._springs
        self._still = (elements, rows, further, stiffness, np.zeros_like(base))
        self._supports = [SupportPoints.of(discretisation, index) for index in range(len(discretisation.model.support))]
        self._lines = lines_of(discretisation)
        self._at = discretisation.probe_sides.where
        self._values: Floats = discretisation.mesh.shape_functions(self._at.elements, self._at.xi)

    def read(self, responses: list[_core.Response], loads: list[CaseLoad] | None, at_rest: bool = False) -> list[_Term]:
        """Read some terms, without loads those of no load."""
        result = self._found
        if loads is None:
            nothing = CaseLoad.none(result.mesh.node_count, len(result.mesh.elements))
            loads = [nothing] * len(responses)
        stresses = np.zeros((len(responses), result.stress_nodes.count, 5))
        if len(self._values) or set(self._names) - {"deflection"}:
            curvatures, couples = (
                np.array([getattr(load, part) for load in loads]) for part in ("curvature", "couples")
            )
            stresses = _core.response_stresses(result.plate, responses, curvatures, couples)
        return [self._term(*one, at_rest) for one in zip(responses, loads, stresses, strict=True)]

    def _term(self, response: _core.Response, load: CaseLoad, stress: Floats, at_rest: bool) -> _Term:
        result, hi, lo, reaction = self._found, response.hi, response.lo, response.reaction
        springs = self._springs if at_rest else self._still
        nodal = (hi + lo).reshape(-1, 3)
        nodes = result.stress_nodes
        every = np.column_stack([nodes.spread(nodal[:, 0]), nodes.spread(result.held.to_global(nodal[:, 1:])), stress])
        spread = result.contact_rows.T @ reaction
        imbalance = result.plate.residual(springs, load.nodal, hi, lo) - spread
        at_holds = np.where(result.held.dofs, imbalance, 0.0)
        pull = result.spring_forces(hi, lo, springs[4])
        on_plate = at_holds + spread + result.spring_rows.T @ pull
        kept = [
            every[: nodes.count if name in PEAKING else len(nodal), place]
            for place, name in enumerate(LINEAR)
            if name in self._names
        ]
        if self._names:
            points, off = result.off_areas
            at_nodes = at_holds + result.contact_rows.T @ (points[: len(reaction)] * reaction)
            kept.append((at_nodes + result.spring_rows.T @ (off * pull))[::3])
        at_probes = np.einsum("qi,qif->qf", self._values, every[nodes.elements[self._at.elements]]).ravel()
        forces = [np.concatenate([at_holds[::3][points.nodes], pull[points.springs]]) for points in self._supports]
        fixed = np.concatenate([np.zeros(0), *forces])
        couples = result.held.to_global(at_holds.reshape(-1, 3)[:, 1:]).ravel()
        turned = [line.couples @ couples for line in self._lines.values() if line.couples is not None]
        on_lines = np.concatenate([np.zeros(0), *turned])
        moments = np.concatenate([np.zeros(0), *(points.moments(pull).ravel() for points in self._supports)])
        sizes = Sizes.of(result, self._watch, load, hi, lo, reaction, imbalance, on_plate, at_rest)
        through = result.through(load, hi, lo, reaction, pull)
        # Fields are sought that have means, or none are read.
        means = means_of(result, stress[:, :3], stress[:, 3:]).ravel() if self._names else np.zeros(0)
        return kept, nodal[self._nodes, 0], at_probes, through, fixed, on_lines, moments, means, sizes
