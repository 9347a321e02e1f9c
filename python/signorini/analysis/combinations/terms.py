"""What every combination is a sum of: the plate at rest, under each load case, and pushed at each contact point.

Displacements, fields, probes and the supports' forces are linear in the coefficients of this sum; only those of the
points are the answer of a contact problem.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from signorini import _core
from signorini.analysis.combinations.certificate_bounds import Proof, Sizes, Watch
from signorini.contact.problem import ContactProblem
from signorini.discretise import CaseLoad
from signorini.discretise.rows import Floats, Ints
from signorini.results.quantities import LINEAR, PEAKING
from signorini.results.support_points import SupportPoints

_TOGETHER = 32
"""Load cases whose displacements are in memory at once."""


@dataclass(frozen=True, eq=False)
class Terms:
    """The terms (b,) of the sum: one at rest, one a load case, one a contact point.

    Parameters
    ----------
    cases : tuple of str
        The load cases, in the order of the terms.
    shared : _core.CombinedCases
        The contact problem condensed for all of them.
    fields : dict of (b, n) arrays
        Those that envelopes are sought of, "reaction" among them.
    on_areas : (b, k) array
        Deflection of the nodes around elastic areas.
    probes : (b, 8q) array
        Every field at every probe.
    through : (b, 3s) array
        Moment, twist and shear of every section, and their means at every station of a strip.
    fixed : (b, f) array
        Upward force of held nodes and springs, support by support.
    proof : Proof
        What certificates are made of.
    """

    cases: tuple[str, ...]
    shared: _core.CombinedCases
    fields: dict[str, Floats]
    on_areas: Floats
    probes: Floats
    through: Floats
    fixed: Floats
    proof: Proof


def terms_of(problem: ContactProblem, cases: Sequence[str], enveloped: Sequence[str], nodes: Ints) -> Terms:
    """Solve for every term.

    Parameters
    ----------
    problem : ContactProblem
        With every contact point in its LCP.
    cases : sequence of str
        Load cases that occur in some combination.
    enveloped : sequence of str
        Fields that envelopes are sought of.
    nodes : (k,) array
        Around elastic areas.
    """
    result, core = problem.discretisation, problem.core
    names = summed(enveloped)
    measured = _Measured(problem, names, Watch.of(result, cases), nodes)
    rest = _core.rest_response(core, result.held.values)
    measured.add([rest], None, at_rest=True)
    responses: list[_core.Response] = []
    for first in range(0, len(cases), _TOGETHER):
        loads = [result.cases[case] for case in cases[first : first + _TOGETHER]]
        solved = _core.load_responses(core, np.array([load.nodal for load in loads]))
        measured.add(solved, loads)
        responses += [response.at_points() for response in solved]
    points: list[_core.Response] = []
    for first in range(0, len(result.contacts), _TOGETHER):
        solved = _core.point_responses(core, first, min(first + _TOGETHER, len(result.contacts)))
        measured.add(solved, None)
        points += [response.at_points() for response in solved]
    shared = _core.combined_cases(core, rest, responses, points)
    return measured.terms(tuple(cases), shared)


def summed(enveloped: Sequence[str]) -> list[str]:
    """Fields that sums are sought of, for some that envelopes are sought of: those, or what they follow from."""
    derived = any(name not in LINEAR for name in enveloped)
    return [name for name in LINEAR if name in enveloped or (derived and name in PEAKING)]


class _Measured:
    """Collects what is read from each term, so that its displacements can go."""

    def __init__(self, problem: ContactProblem, names: list[str], watch: Watch, nodes: Ints) -> None:
        self._names, self._watch = names, watch
        discretisation = self._found = problem.discretisation
        self._springs = discretisation.springs.arrays
        elements, rows, further, stiffness, base = self._springs
        self._still = (elements, rows, further, stiffness, np.zeros_like(base))
        self._supports = [SupportPoints.of(discretisation, index) for index in range(len(discretisation.model.support))]
        self._at = discretisation.probe_sides.where
        self._values: Floats = discretisation.mesh.shape_functions(self._at.elements, self._at.xi)
        self._fields: list[list[Floats]] = []
        self._nodes = nodes
        self._on_areas: list[Floats] = []
        self._probes: list[Floats] = []
        self._through: list[Floats] = []
        self._fixed: list[Floats] = []
        self._sizes: list[Sizes] = []

    def add(self, responses: list[_core.Response], loads: list[CaseLoad] | None, at_rest: bool = False) -> None:
        """Read some terms."""
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
        for response, load, stress in zip(responses, loads, stresses, strict=True):
            self._add(response, load, stress, at_rest)

    def _add(self, response: _core.Response, load: CaseLoad, stress: Floats, at_rest: bool) -> None:
        result, hi, lo, reaction = self._found, response.hi, response.lo, response.reaction
        springs = self._springs if at_rest else self._still
        displacement = hi + lo
        nodal = displacement.reshape(-1, 3)
        nodes = result.stress_nodes
        every = np.column_stack([nodes.spread(nodal[:, 0]), nodes.spread(result.held.to_global(nodal[:, 1:])), stress])
        spread = result.contact_rows.T @ reaction
        imbalance = result.plate.residual(springs, load.nodal, hi, lo) - spread
        at_holds = np.where(result.held.dofs, imbalance, 0.0)
        pull = result.spring_forces(hi, lo, springs[4])
        on_plate = at_holds + spread + result.spring_rows.T @ pull
        self._on_areas.append(nodal[self._nodes, 0])
        kept = [
            every[: nodes.count if name in PEAKING else len(nodal), place]
            for place, name in enumerate(LINEAR)
            if name in self._names
        ]
        if self._names:
            points, off = result.off_areas
            at_nodes = at_holds + result.contact_rows.T @ (points[: len(reaction)] * reaction)
            kept.append((at_nodes + result.spring_rows.T @ (off * pull))[::3])
        self._fields.append(kept)
        at_probes = np.einsum("qi,qif->qf", self._values, every[nodes.elements[self._at.elements]])
        self._probes.append(at_probes.ravel())
        self._through.append(result.through(load, hi, lo, reaction, pull))
        forces = [np.concatenate([at_holds[::3][points.nodes], pull[points.springs]]) for points in self._supports]
        self._fixed.append(np.concatenate([np.zeros(0), *forces]))
        self._sizes.append(Sizes.of(result, self._watch, load, hi, lo, reaction, imbalance, on_plate, at_rest))

    def terms(self, cases: tuple[str, ...], shared: _core.CombinedCases) -> Terms:
        """Put the terms together."""
        names = [*self._names, "reaction"] if self._names else []
        fields = {name: np.array([field[i] for field in self._fields]) for i, name in enumerate(names)}
        proof = Proof.of(self._found, self._sizes)
        return Terms(
            cases,
            shared,
            fields,
            _table(self._on_areas),
            _table(self._probes),
            _table(self._through),
            _table(self._fixed),
            proof,
        )


def _table(rows: Iterable[Floats]) -> Floats:
    return np.ascontiguousarray(np.array(list(rows)))
