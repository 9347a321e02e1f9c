"""Many combinations on one factor: solved in blocks, each block's columns passed on, envelopes kept.

Memory does not grow with the number of combinations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from signorini import _core
from signorini.analysis.combinations.block import Block, Column, Layout
from signorini.analysis.combinations.envelope import Envelope, Extremes, SupportEnvelope
from signorini.analysis.combinations.terms import Terms, terms_of
from signorini.base.brief import Brief
from signorini.contact.certificate import FIGURES, TOLERANCE
from signorini.contact.dependence import Dependence
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import doubtful
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.model import Combination, Combinations
from signorini.results.contact_field import AreaContact, Pressures
from signorini.results.result import FIELDS, Result
from signorini.results.support_points import SupportPoints
from signorini.results.support_result import area_contact

__all__ = ["Combined", "Envelope", "Extremes", "Layout", "SupportEnvelope", "combine"]

_MOST_ROWS = 4096
_MOST_NUMBERS = 4_000_000
"""Combinations, and numbers of theirs, that are in memory at once."""
_FEW_POINTS = 100
_MOST_POINTS = 500
"""Contact points whose responses are always worth their time, and at most have the memory."""
_BALANCED = 1e-10
"""Balance from which on a combination is solved by itself, where it is asked too whether equilibrium exists."""
_EXPLAINED = 100
"""Combinations without equilibrium of which is said why."""
_GOVERNING = 12
"""Combinations at most that count as governing."""

Single = Callable[[Combination], Result]
Several = Callable[[Sequence[Combination], Single], Iterable[Result]]
Sink = Callable[[Iterable[tuple[str, Column]]], None]


@dataclass(frozen=True, eq=False, repr=False)
class Combined(Brief):
    """What is known of all combinations together.

    Parameters
    ----------
    combinations : Combinations
    layout : Layout
    envelope : Envelope
        Over those that were solved.
    solved : int
        How many have an equilibrium.
    alone : int
        How many of them were solved by themselves, because what was found together was not certain enough.
    not_unique : int
        How many have other answers that are as right; of each the least is in the table.
    certificate : dict of float
        The worst of each figure.
    unbalanced : dict of str
        Why the first of those without equilibrium have none, by name.
    """

    combinations: Combinations
    layout: Layout
    envelope: Envelope
    solved: int
    alone: int
    not_unique: int
    certificate: Mapping[str, float]
    unbalanced: Mapping[str, str]

    def name(self, number: int) -> str:
        """Name of a combination, given its number."""
        return self.combinations[number].name

    @property
    def governing(self) -> tuple[str, ...]:
        """Combinations with an extreme of some field or support's reaction, in that order, some at most."""
        found = self.envelope.governing().values()
        numbers = dict.fromkeys(by for _, high, _, low in found for by in (high, low) if by >= 0)
        return tuple(self.name(number) for number in list(numbers)[:_GOVERNING])


def combine(
    problem: ContactProblem,
    single: Single,
    several: Several,
    begin: Callable[[str], None],
    sink: Sink | None = None,
) -> Combined:
    """Solve every combination of a model.

    Parameters
    ----------
    problem : ContactProblem
    single : callable
        Solves one combination by itself; used where a sum of responses is not certain.
    several : callable
        Solves combinations of an active set side by side, and those it is not certain of by the function it is given.
    begin : callable
        Called with the name of the first combination of each block as it begins; what it raises ends the run.
    sink : callable, optional
        Takes the columns of each block, see `Block.columns`.
    """
    found = problem.discretisation
    asked = found.model.output.envelope
    layout = Layout.of(found, [name for name in FIELDS if name in asked])
    run = _Run(problem, layout, single, several)
    combinations = found.model.effective_combinations
    width = (
        layout.point_count * 3 + 2 * len(run.pressures.nodes) + len(FIELDS) * len(layout.probes) + len(run.cases) + 20
    )
    rows = int(np.clip(_MOST_NUMBERS // width, 16, _MOST_ROWS))
    for first in range(0, len(combinations), rows):
        begin(combinations[first].name)
        block = Block.empty(layout, first, combinations[first : first + rows])
        run.solve(block)
        if sink is not None:
            sink(block.columns(layout, found.mesh.points))
    worst = {name: float(value) for name, value in zip(FIGURES, run.worst, strict=True)}
    return Combined(combinations, layout, run.envelope, run.solved, run.alone, run.not_unique, worst, run.unbalanced)


class _Run:
    """What grows from block to block."""

    def __init__(self, problem: ContactProblem, layout: Layout, single: Single, several: Several) -> None:
        found = problem.discretisation
        self.problem, self.layout, self.single, self.several = problem, layout, single, several
        used = found.model.effective_combinations.cases
        self.cases = tuple(case for case in found.cases if case in used)
        self.terms: Terms | None = None
        # Where nodes are held together their forces are shared alike in every combination.
        self._always = "reactions" if Dependence.of(found).held_together else ""
        every = [index for index, support in enumerate(found.model.support) if support.area is not None]
        self.areas = {index: _at_rest(found, index) for index in every}
        self.pressures = Pressures(list(self.areas.values()))
        if problem.method == "lemke" and _worth_while(problem, len(found.model.effective_combinations)):
            self.terms = terms_of(problem, self.cases, layout.fields, self.pressures.nodes)
        nodes = found.mesh.node_count
        names = list(layout.fields)
        if names and len(self.areas) < len(found.model.support):
            names.append("reaction")
        on = {"contact_pressure": self.pressures.nodes, "rigid_contact_pressure": self.pressures.elements}
        self.envelope = Envelope(
            {name: Extremes.none(nodes) for name in names},
            {name: (places, Extremes.none(len(places))) for name, places in on.items() if len(places) and names},
            tuple(map(self._none, range(len(found.model.support)))),
            Extremes.none(len(FIELDS) * len(layout.probes)),
        )
        self.solved = self.alone = self.not_unique = 0
        self.worst = np.zeros(len(FIGURES))
        self.unbalanced: dict[str, str] = {}
        self._without_equilibrium = 0

    def _none(self, index: int) -> SupportEnvelope:
        """Nothing met yet by a support."""
        p, area, places = len(self.layout.supports[index].positions), self.areas.get(index), np.zeros((0, 2))
        if area is not None:
            places = area.measured(area.deflection[area.on_nodes], area.reactions)[1]
        lifted = np.zeros(p, dtype=np.int64)
        pressure = Extremes.none(len(places))
        return SupportEnvelope(Extremes.none(1), Extremes.none(p), Extremes.none(p), lifted, pressure, places)

    def solve(self, block: Block) -> None:
        """Fill a block, and widen the envelope by it."""
        on_areas = np.full((len(block.combinations), len(self.pressures.nodes)), np.nan)
        rows = self._sums(block, self.terms, on_areas) if self.terms is not None else range(len(block.combinations))
        left = [block.combinations[row] for row in rows]
        together = self.problem.method == "active_set"
        for row, result in zip(
            rows, self.several(left, self._alone) if together else map(self._alone, left), strict=True
        ):
            block.put(row, self.layout, result)
            if block.solved[row]:
                self._take_fields(result, block.numbers[row : row + 1])
                on_areas[row] = result.deflection[self.pressures.nodes]
            else:
                self._unbalanced(result.name, result.message)
        self.solved += int(block.solved.sum())
        self.not_unique += sum(map(bool, block.not_unique))
        self.worst = np.maximum(self.worst, block.certificate[block.solved].max(axis=0, initial=0.0))
        who = block.numbers[block.solved]
        self.envelope.probes.take(block.probes[block.solved], who)
        for where, support in zip(self.layout.slices, self.envelope.supports, strict=True):
            reaction = block.reaction[block.solved, where]
            support.reaction.take(reaction.sum(axis=1)[:, None], who)
            support.points.take(reaction, who)
            support.gap.take(block.gap[block.solved, where], who)
            support.lifted[:] += (~block.closed[block.solved, where]).sum(axis=0)
        if self.areas and block.solved.any():
            self._take_pressures(block, on_areas[block.solved])

    def _take_pressures(self, block: Block, deflection: Floats) -> None:
        """Widen the envelope by the pressures of areas, whose nodes have deflections (solved, k)."""
        who, slices = block.numbers[block.solved], self.layout.slices
        forces = [block.reaction[block.solved, slices[index]] for index in self.areas]
        for (index, area), force in zip(self.areas.items(), forces, strict=True):
            own = np.searchsorted(self.pressures.nodes, np.flatnonzero(area.on_nodes))
            at = deflection[:, own] if area.support.stiffness is not None else deflection[:, :0]
            self.envelope.supports[index].pressure.take(area.measured(at, force)[0], who)
        for name, (_, extremes) in self.envelope.pressures.items():
            elastic = name == "contact_pressure"
            pressures = self.pressures
            extremes.take(pressures.at_nodes(deflection, forces) if elastic else pressures.on_elements(forces), who)

    def _alone(self, combination: Combination) -> Result:
        result = self.single(combination)
        self.alone += result.status == "solved"
        return result

    def _sums(self, block: Block, terms: Terms, on_areas: Floats) -> Sequence[int]:
        """Solve what sums of responses are certain of; return the rows that are left.

        Fill the deflections (k, n) on elastic areas.
        """
        factors = _factors(block.combinations, terms.cases)
        verdict, pushes, reaction, gap, closed, pivots = _core.combine(self.problem.core, terms.shared, factors)
        rows = np.flatnonzero(verdict == 0)
        coefficients = np.ascontiguousarray(np.hstack([np.ones((len(rows), 1)), factors[rows], pushes[rows]]))
        figures = terms.proof.figures(coefficients, np.ascontiguousarray(reaction[rows]))
        certain = _certain(figures)
        certain &= ~doubtful(self.problem.discretisation, self.problem.freedom, reaction[rows], gap[rows])
        rows, coefficients = rows[certain], np.ascontiguousarray(coefficients[certain])
        block.solved[rows] = True
        block.certificate[rows] = figures[certain]
        block.probes[rows] = _core.superpose(coefficients, terms.probes)
        on_areas[rows] = _core.superpose(coefficients, terms.on_areas)
        self._put_supports(block, rows, _core.superpose(coefficients, terms.fixed), reaction[rows], gap, closed)
        who = block.numbers[rows]
        for name, vectors in terms.fields.items():
            peaks, places = self.envelope.fields[name].take_sums(coefficients, vectors, who)
            if name in self.layout.fields:
                at = self.layout.fields.index(name)
                block.peaks[rows, at], block.places[rows, at] = peaks, places
        block.iterations[:] = pivots
        for row in rows:
            block.method[row] = "lemke"
            block.not_unique[row] = self._always
        without = np.flatnonzero(verdict == 1)
        explained = without[: max(0, _EXPLAINED - self._without_equilibrium)]
        self._without_equilibrium += len(without) - len(explained)
        done = block.solved.copy()
        done[np.setdiff1d(without, explained)] = True
        return np.flatnonzero(~done).tolist()

    def _put_supports(
        self, block: Block, rows: Ints, fixed: Floats, reaction: Floats, gap: Floats, closed: Bools
    ) -> None:
        first = 0
        for where, points in zip(self.layout.slices, self.layout.supports, strict=True):
            held = fixed[:, first : first + points.fixed]
            first += points.fixed
            block.reaction[rows, where] = points.forces(held, reaction)
            block.gap[rows, where] = points.gaps(gap[rows])
            block.closed[rows, where] = points.closed(closed[rows])

    def _take_fields(self, result: Result, who: Ints) -> None:
        for name, extremes in self.envelope.fields.items():
            field = result.nodal_reaction if name == "reaction" else result.fields[name]
            extremes.take(field[None], who)

    def _unbalanced(self, name: str, message: str) -> None:
        self._without_equilibrium += 1
        if len(self.unbalanced) < _EXPLAINED:
            self.unbalanced[name] = message


def _at_rest(found: Discretisation, index: int) -> AreaContact:
    """Build an area that nothing presses yet: where it is, and its law."""
    points = SupportPoints.of(found, index)
    nothing = np.zeros(len(points.positions))
    return area_contact(found, index, np.zeros(found.mesh.node_count), points.positions, nothing > 0, nothing)


def _worth_while(problem: ContactProblem, count: int) -> bool:
    """Whether so many combinations are worth a response of every contact point, and memory holds these."""
    found = problem.discretisation
    points = len(found.contacts)
    return not len(found.repeated) and points <= min(_MOST_POINTS, max(_FEW_POINTS, 2 * count))


def _certain(figures: Floats) -> Bools:
    """Whether certificates (k, 5) pass, and leave no doubt that equilibrium exists."""
    balance = figures[:, FIGURES.index("balance")]
    return np.asarray((figures <= TOLERANCE).all(axis=1) & (balance <= _BALANCED))


def _factors(combinations: Sequence[Combination], cases: Sequence[str]) -> Floats:
    """Factors (k, c) of the cases."""
    column = {case: index for index, case in enumerate(cases)}
    out = np.zeros((len(combinations), len(cases)))
    for row, combination in enumerate(combinations):
        for case, factor in (combination.factors or {}).items():
            out[row, column[case]] = factor
    return out
