"""Terms whose linear combinations are the answers, and bounds of the certificate errors of such sums.

The terms are the solutions without load, for each load case, and for a unit force at each contact point.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from signorini import _core
from signorini.contact.certificate import FIGURES, off_laws
from signorini.contact.problem import ContactProblem
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats, Ints
from signorini.results.quantities import LINEAR, PEAKING, RESULTANTS
from signorini.results.readings import Linear, Reader, SupportForces
from signorini.singularities.beside import at_faces, faces_of, means_of

_WATCHED = 64
"""Number of nodes, and approximate number of dofs, at which deflection and load of a sum of terms are computed. Their
largest values are lower bounds of the reference sizes of the sum's certificate.
"""


@dataclass(frozen=True, eq=False)
class Watch:
    """Nodes spread over the plate, and for some load cases the dof (3·node + component) with the largest load."""

    nodes: Ints
    dofs: Ints

    @classmethod
    def of(cls, discretisation: Discretisation, cases: Sequence[str]) -> Watch:
        """Choose nodes at equal steps of their numbers, and the most loaded dof of each of at most 127 load cases."""
        unit = np.tile(_units(discretisation), discretisation.mesh.node_count)
        some = cases[:: max(1, len(cases) // _WATCHED)]
        dofs = {int(np.abs(discretisation.cases[case].nodal / unit).argmax()) for case in some}
        nodes = np.unique(np.linspace(0, discretisation.mesh.node_count - 1, _WATCHED).astype(np.int64))
        return cls(nodes, np.array(sorted(dofs), dtype=np.int64))


class Sizes(NamedTuple):
    """Data of one term of the sums that certificates need; with a leading axis (b,), data of b terms."""

    moved: Floats
    """(m,): displacement Gu of every contact point."""
    reaction: Floats
    """(m,): reaction of every contact point."""
    errors: Floats
    """(2,): largest residual force at a node, with couples divided by the element size; largest error of a held
    deflection, or of a held slope times the plate's size."""
    balance: Floats
    """(3p,): force and two moments of the load minus those of the supports, on each of p plates."""
    resultant: Floats
    """(3p,): force and two moments of the load on each plate, excluding self-equilibrated parts."""
    deflection: Floats
    """Deflections of the nodes in `Watch.nodes`."""
    load: Floats
    """Loads on the dofs in `Watch.dofs`; couples are divided by the element size."""

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
        """Compute the data of a term.

        Given are displacements ``hi + lo``, residual ``imbalance`` and support forces ``on_plate``, each (3n,).
        """
        rows, held = discretisation.contacts.rows, discretisation.held
        exact = hi.astype(np.longdouble) + lo
        moved = rows.dot(discretisation.mesh.elements, exact)
        unit = _units(discretisation)
        free = np.abs(np.where(held.dofs, 0.0, imbalance).reshape(-1, 3)) / unit
        values = held.values if at_rest else np.zeros_like(held.values)
        lengths = np.array([1.0, discretisation.mesh.size, discretisation.mesh.size])
        slip = np.abs(np.where(held.dofs, hi + lo - values, 0.0)).reshape(-1, 3) * lengths
        motions = discretisation.scaled_motions
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
    """Divisors (3,) by which a node's two couples become comparable with its force: 1 and the element size."""
    across = float(np.sqrt(discretisation.mesh.element_area.mean()))
    return np.array([1.0, across, across])


@dataclass(frozen=True, eq=False)
class Proof:
    """Data from which the certificate errors of sums of terms are computed.

    ``terms`` are the data of the terms, ``moves`` (m, 3p) the contact rows of G times rigid motions. ``grip`` (m, 1) is
    the largest entry of each contact row, couples divided by the element size.
    """

    discretisation: Discretisation
    terms: Sizes
    moves: Floats
    grip: Floats

    @classmethod
    def of(cls, discretisation: Discretisation, sizes: Sequence[Sizes]) -> Proof:
        """Stack the data of all terms for certificates."""
        rows = abs(discretisation.contact_rows)
        rows.data /= _units(discretisation)[rows.indices % 3]
        motions = discretisation.scaled_motions
        return cls(
            discretisation,
            Sizes(*map(np.array, zip(*sizes, strict=True))),
            np.ascontiguousarray(discretisation.contact_rows @ motions),
            np.ascontiguousarray(rows.max(axis=1).toarray().reshape(-1, 1)),
        )

    def figures(self, coefficients: Floats, reaction: Floats) -> Floats:
        """Upper bounds (k, 5) of the certificate errors of k sums, in the order of `FIGURES`.

        The sums have ``coefficients`` (k, b) of the terms and contact forces ``reaction`` (k, m).
        """
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
"""Largest number of load cases whose displacements are in memory at once."""


AT_FACES = " at faces"


_OfPlate: TypeAlias = tuple[list[Floats], Linear, Floats]
"""Fields, linear readings and means of one plate in one term."""
_Term: TypeAlias = tuple[list[_OfPlate], Sizes]
"""Values of every plate in one term, and the term's data for certificates."""


@dataclass(frozen=True, eq=False)
class PlateTerms:
    """Values of one plate in all b terms of the sums."""

    fields: dict[str, Floats]
    """Fields (b, n) at nodes or (b, s) at stress nodes, by name, for the envelopes; "reaction" is one of these names.

    Names that end in `AT_FACES` are moments for the design of bars, see `Reinforcement.face`.
    """
    linear: Linear
    """Linear readings of the terms; the first axis of each array is (b,)."""
    means: Floats
    """Means (b, 10k) of moments and shears over a width beside the k singular points of `Beside`."""

    @classmethod
    def stacked(cls, names: Sequence[str], each: Sequence[_OfPlate]) -> PlateTerms:
        """Stack the values of one plate in all terms."""
        fields, linear, means = zip(*each, strict=True)
        every = [*names, "reaction", *(f"{name}{AT_FACES}" for name in RESULTANTS[:3])] if names else []
        by_name = dict(zip(every, map(np.array, zip(*fields, strict=True)), strict=False))
        return cls(by_name, Linear.stacked(linear), np.array(means))


@dataclass(frozen=True, eq=False)
class Terms:
    """The terms (b,) of the sums: solutions without load, for each load case, for unit forces at contact points."""

    cases: tuple[str, ...]
    """Names of the load cases, in the order of the terms."""
    shared: _core.CombinedCases
    """Contact problem of all terms, condensed onto the contact points."""
    plates: tuple[PlateTerms, ...]
    """Values of every plate in the terms."""
    proof: Proof
    """Data for the certificates of the sums."""


def terms_of(problem: ContactProblem, cases: Sequence[str], enveloped: Sequence[str]) -> Terms:
    """Compute all terms.

    ``cases`` are the load cases that occur in a combination; ``enveloped`` are the fields that have envelopes.
    """
    result, core = problem.discretisation, problem.core
    names = summed(enveloped)
    reader = _Terms(result, names, Watch.of(result, cases))
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
    of_plates, sizes = zip(*terms, strict=True)
    plates = tuple(PlateTerms.stacked(names, each) for each in zip(*of_plates, strict=True))
    return Terms(tuple(cases), shared, plates, Proof.of(result, sizes))


def summed(enveloped: Sequence[str]) -> list[str]:
    """Names of the fields that are summed.

    These are the linear fields in ``enveloped``, and moments and shears if ``enveloped`` has a derived field.
    """
    derived = any(name not in LINEAR for name in enveloped)
    return [name for name in LINEAR if name in enveloped or (derived and name in PEAKING)]


class _Terms:
    """Reads fields and readings from each response at once, so that the response's displacements need not be stored."""

    def __init__(self, discretisation: Discretisation, names: list[str], watch: Watch) -> None:
        self._found, self._names, self._watch = discretisation, names, watch
        self._springs = discretisation.springs.arrays
        elements, rows, further, stiffness, base = self._springs
        self._still = (elements, rows, further, stiffness, np.zeros_like(base))

    def read(self, responses: list[_core.Response], loads: list[CaseLoad] | None, at_rest: bool = False) -> list[_Term]:
        """Read terms from responses to ``loads``; ``loads`` is None if the responses are to unit forces."""
        if loads is None:
            loads = [self._found.no_load] * len(responses)
        return [self._term(*one, at_rest) for one in zip(responses, loads, strict=True)]

    def _term(self, response: _core.Response, load: CaseLoad, at_rest: bool) -> _Term:
        result, hi, lo, reaction = self._found, response.hi, response.lo, response.reaction
        springs = self._springs if at_rest else self._still
        spread = result.contact_rows.T @ reaction
        forces = SupportForces.of(result, load.nodal, hi, lo, spread, springs)
        on_plate = forces.held + spread + result.spring_rows.T @ forces.springs
        points, off = result.off_areas
        at_nodes = forces.held + result.contact_rows.T @ (points[: len(reaction)] * reaction)
        at_nodes = (at_nodes + result.spring_rows.T @ (off * forces.springs))[::3]
        every = []
        for number, plate in enumerate(result.members):
            own, of_load = forces.on(plate), load.on(number)
            beneath = plate.deflections_beneath((hi + lo)[::3])
            state = of_load, hi[plate.dofs], lo[plate.dofs], reaction[plate.points], own
            every.append(self._of_plate(plate.own, *state, at_nodes[plate.nodes], beneath))
        return every, Sizes.of(result, self._watch, load, hi, lo, reaction, forces.imbalance, on_plate, at_rest)

    def _of_plate(
        self,
        plate: Discretisation,
        load: CaseLoad,
        hi: Floats,
        lo: Floats,
        reaction: Floats,
        forces: SupportForces,
        at_nodes: Floats,
        beneath: Mapping[int, Floats],
    ) -> _OfPlate:
        nodal, nodes = (hi + lo).reshape(-1, 3), plate.stress_nodes
        stress = np.zeros((nodes.count, 5))
        if len(plate.probe_positions) or set(self._names) - {"deflection"}:
            stress, _ = plate.plate.stresses(hi, lo, tuple(load.curvature), load.couples)
        every = np.column_stack([nodes.spread(nodal[:, 0]), nodes.spread(plate.held.to_global(nodal[:, 1:])), stress])
        kept = [
            every[: nodes.count if name in PEAKING else len(nodal), place]
            for place, name in enumerate(LINEAR)
            if name in self._names
        ]
        # Only envelopes of fields need means beside singularities.
        means = means_of(plate, stress[:, :3], stress[:, 3:]).ravel() if self._names else np.zeros(0)
        linear = Reader.of(plate).read(load, hi, lo, reaction, forces, every, beneath)
        moment, of_bars = stress[:, :3], list[Floats]()
        if plate.model.at_faces and set(RESULTANTS[:3]) <= set(self._names):
            of_bars = [*at_faces(faces_of(plate), moment, moment, nodes.points).T]
        return [*kept, at_nodes, *of_bars] if self._names else kept, linear, means
