"""Solve many combinations with one factorization, as rows of a table, and extend envelopes by these rows.

Combinations are solved in blocks of consecutive rows; each block is passed on and not stored. Memory does not grow with
the number of combinations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from signorini import _core
from signorini.analysis.combinations.terms import AT_FACES, PlateTerms, Terms, terms_of
from signorini.base.remade import Brief
from signorini.contact.certificate import FIGURES, TOLERANCE
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import doubtful
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.model import Combination, Combinations, Model
from signorini.results.checks import completed, overturned
from signorini.results.envelope import Envelope, Extremes
from signorini.results.extremes import mean_ends
from signorini.results.quantities import ENDS, MEAN_SIDES, PEAKING, SIDES, field_groups
from signorini.results.readings import Reader, Readings
from signorini.results.result import Result
from signorini.results.rows import Block, Column, Hidden, Layout, PlateLayout, together

_MOST_ROWS = 4096
_MOST_NUMBERS = 4_000_000
"""Largest number of combinations in one block, and largest number of values in its columns."""
_DEFLECTIONS = 500_000
"""Largest number of means beside singularities that are in memory at once (4 MB)."""
_FEW_POINTS = 100
_MOST_POINTS = 500
"""Limits for the number of contact points. Up to the first limit, responses to unit forces at all points are always
computed; above the second limit never, since they would need too much memory.
"""
_BALANCED = 1e-10
"""Largest relative error, loads against reactions, of a sum of responses. With a larger error the combination is solved
by itself, after the check of equilibrium.
"""
_EXPLAINED = 100
"""Largest number of combinations without equilibrium for which the reason is stored."""

Single = Callable[[Combination], Result]
Several = Callable[[Sequence[Combination], Single], Iterable[Result]]
Sink = Callable[[Iterable[tuple[str, Column]]], None]


class Ways(NamedTuple):
    """Solvers of the combinations that have the same bolt preloads.

    ``single`` solves one combination by itself. ``several`` solves many combinations with the active set. Its second
    argument is called for each combination whose equilibrium or answer is uncertain. If ``several`` is None, ``single``
    solves every combination.
    """

    problem: ContactProblem
    single: Single
    several: Several | None


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Combined(Brief):
    """Results of all combinations: rows of the table, envelopes, numbers of combinations, largest errors."""

    combinations: Combinations
    layout: Layout
    envelope: Envelope
    """Envelope of all combinations with an equilibrium."""
    groups: Mapping[str, Envelope]
    """Envelope of the combinations with an equilibrium, by name of their group."""
    solved: int
    """Number of combinations with an equilibrium."""
    alone: int
    """Number of combinations solved by themselves, since their sum of unit-load responses was not certified."""
    not_unique: int
    """Number of combinations whose reactions are not unique; the table has their least-norm reactions."""
    certificate: Mapping[str, float]
    """Largest error over all combinations, by the name of the error in a certificate."""
    unsolved: tuple[int, ...]
    """Row numbers of the combinations without equilibrium."""
    unbalanced: Mapping[str, str]
    """Reasons why combinations have no equilibrium, by name of the combination, for the first 100."""
    rows: Mapping[str, Column] | None
    """Columns of the table; None if they have too many values to be stored."""

    def over(self, group: str) -> Envelope:
        """Return the envelope of a group; for ``group=""`` that of all combinations."""
        return self.groups[group] if group else self.envelope

    def any_solved(self, group: str = "") -> bool:
        """Whether at least one combination of a group has an equilibrium; ``group=""`` means all combinations."""
        return group in self.groups if group else self.solved > 0

    @property
    def governing(self) -> list[int]:
        """Row numbers of the combinations that have an extreme: group by group, or over all if there are no groups."""
        envelopes = self.groups.values() or (self.envelope,)
        return list(dict.fromkeys(row for envelope in envelopes for row in envelope.rows))


def combine(
    discretisation: Discretisation,
    ways: Callable[[Combination], Ways],
    begin: Callable[[str], None],
    sink: Sink | None = None,
) -> Combined:
    """Solve every combination of a model.

    ``ways`` is called with the first combination of each set of bolt preloads. ``begin`` is called with the name of the
    first combination of each block; an exception in it ends the run. ``sink`` receives the columns of each block.
    """
    model, layout = discretisation.model, Layout.of(discretisation)
    combinations = model.effective_combinations
    used = combinations.cases
    cases = tuple(case for case in discretisation.cases if case in used)
    runs = dict[tuple[float, ...], _Run]()
    width = layout.point_count * 2 + len(layout.catalogue) + len(cases) + len(layout.around_areas) + 20
    most = int(np.clip(_MOST_NUMBERS // width, 16, _MOST_ROWS))
    kept: list[list[tuple[str, Column]]] = []
    few = True
    for first in range(0, len(combinations), most):
        begin(combinations[first].name)
        rowed = combinations[first : first + most]
        block = Block.empty(layout, first, len(rowed))
        tightenings = [model.round_factors(combination.factors or {}) for combination in rowed]
        for tightening in dict.fromkeys(tightenings):
            rows = np.array([row for row, one in enumerate(tightenings) if one == tightening])
            if tightening not in runs:
                runs[tightening] = _Run(ways(rowed[rows[0]]), layout, cases)
            runs[tightening].solve(block, [rowed[row] for row in rows], rows)
        keys = [("combination", [combination.name for combination in rowed])]
        columns = list(block.columns(layout, keys, _loads(model, rowed)))
        few = few and len(columns) * len(combinations) <= _MOST_NUMBERS
        kept += [columns] if few else []
        if sink is not None:
            sink(columns)
    every = runs.values()
    worst = dict(zip(FIGURES, np.max([run.worst for run in every], axis=0).tolist(), strict=True))
    envelopes = {name: [run.envelopes[name] for run in every if name in run.envelopes] for name in combinations.groups}
    groups = {name: _over(layout, discretisation.mesh, parts) for name, parts in envelopes.items() if parts}
    envelope = _over(layout, discretisation.mesh, [part for run in every for part in run.envelopes.values()])
    return Combined(
        combinations=combinations,
        layout=layout,
        envelope=envelope,
        groups=groups,
        solved=sum(run.solved for run in every),
        alone=sum(run.alone for run in every),
        not_unique=sum(run.not_unique for run in every),
        certificate=worst,
        unsolved=tuple(sorted(row for run in every for row in run.unsolved)),
        unbalanced={name: why for run in every for name, why in run.unbalanced.items()},
        rows=together(kept) if few else None,
    )


def _over(layout: Layout, mesh: Mesh, envelopes: Sequence[Envelope]) -> Envelope:
    """Return one envelope that contains the results of all ``envelopes``."""
    result = Envelope.none(layout, mesh)
    for one in envelopes:
        result.meet(one)
    return result


class _Run:
    """Envelopes, counts and largest certificate errors of combinations with equal bolt preloads, over all blocks."""

    def __init__(self, ways: Ways, layout: Layout, cases: tuple[str, ...]) -> None:
        self.problem, self.single, self.several = ways
        self.layout, discretisation = layout, self.problem.discretisation
        self.terms: Terms | None = None
        # If several supports hold the same nodes, the distribution of reactions among them is never unique.
        self._always = "reactions" if discretisation.held_together else ""
        # Responses to unit forces at all contact points are computed only if they save time and fit into memory.
        most = min(_MOST_POINTS, max(_FEW_POINTS, 2 * len(discretisation.model.effective_combinations)))
        worth_while = not len(discretisation.repeated) and len(discretisation.contacts) <= most
        if self.several is not None and self.problem.method == "lemke" and worth_while:
            self.terms = terms_of(self.problem, cases, layout.fields)
        self.envelopes: dict[str, Envelope] = {}
        self.solved = self.alone = self.not_unique = 0
        self.worst = np.zeros(len(FIGURES))
        self.unbalanced: dict[str, str] = {}
        self.unsolved: list[int] = []
        self._without_equilibrium = 0

    def solve(self, block: Block, combinations: Sequence[Combination], at: Ints) -> None:
        """Solve k combinations, store them in the rows ``at`` (k,) of a block, and extend the envelopes."""
        groups = [combination.group for combination in combinations]
        rows: Sequence[int] = range(len(combinations))
        if self.terms is not None:
            rows = self._sums(block, combinations, at, self.terms, groups)
        left = [combinations[row] for row in rows]
        together = self.several if self.problem.method == "active_set" else None
        results = map(self._alone, left) if together is None else together(left, self._alone)
        for row, result in zip(rows, results, strict=True):
            block.put(place := at[row], self.layout, result)
            if block.solved[place]:
                self._envelope(groups[row]).take_fields(result, block.numbers[[place]])
            else:
                self._unbalanced(result.name, result.message)
        numbers = overturned(self.problem.discretisation, self.layout.catalogue, block.values[at], combinations)
        block.values[at] = completed(self.layout.catalogue, numbers, combinations)
        self.unsolved += block.numbers[at[~block.solved[at]]].tolist()
        solved = np.flatnonzero(block.solved[at])
        self.solved += len(solved)
        self.not_unique += sum(bool(block.not_unique[place]) for place in at)
        self.worst = np.maximum(self.worst, block.certificate[at[solved]].max(axis=0, initial=0.0))
        for group, own in _by_group(groups, solved):
            self._envelope(group).take(block, at[own])

    def _envelope(self, group: str) -> Envelope:
        if group not in self.envelopes:
            self.envelopes[group] = Envelope.none(self.layout, self.problem.discretisation.mesh)
        return self.envelopes[group]

    def _alone(self, combination: Combination) -> Result:
        result = self.single(combination)
        self.alone += result.status == "solved"
        return result

    def _sums(
        self, block: Block, combinations: Sequence[Combination], places: Ints, terms: Terms, groups: Sequence[str]
    ) -> Sequence[int]:
        """Solve combinations as sums of responses; return the indices of combinations without a certified sum."""
        factors = _factors(combinations, terms.cases)
        verdict, pushes, reaction, gap, closed, pivots = _core.combine(self.problem.core, terms.shared, factors)
        rows = np.flatnonzero(verdict == 0)
        coefficients = np.ascontiguousarray(np.hstack([np.ones((len(rows), 1)), factors[rows], pushes[rows]]))
        figures = terms.proof.figures(coefficients, np.ascontiguousarray(reaction[rows]))
        # Keep sums that pass the certificate and whose equilibrium is not in doubt.
        certain = (figures <= TOLERANCE).all(axis=1) & (figures[:, FIGURES.index("balance")] <= _BALANCED)
        certain &= ~doubtful(self.problem.discretisation, self.problem.freedom, reaction[rows], gap[rows])
        rows, coefficients = rows[certain], np.ascontiguousarray(coefficients[certain])
        here = places[rows]
        block.solved[here] = True
        block.certificate[here] = figures[certain]
        numbers, extremes_at = list[Floats](), list[Floats]()
        # Use the plates of the problem, whose bolts are tightened; in the plates of the layout bolts are not tightened.
        plates = self.problem.discretisation.members
        for member, plate, of in zip(self.layout.members, plates, terms.plates, strict=True):
            points = plate.points
            readings = Readings(
                reader=Reader.of(plate.own),
                linear=of.linear.sums(coefficients),
                shared=reaction[rows][:, points],
                gap=np.where(closed[rows], 0.0, gap[rows])[:, points],
                closed=closed[rows][:, points],
                between=tuple(plate.beneath),
            )
            block.put_supports(here, self.layout, member, readings)
            values = readings.numbers(member.catalogue)
            at = np.full((len(here), len(self.layout.fields), len(ENDS), 2), np.nan)
            for group, own in _by_group(groups, rows):
                some = np.searchsorted(rows, own)
                acting, who = factors[own] != 0, block.numbers[places[own]]
                found = self._take_fields(member, of, group, np.ascontiguousarray(coefficients[some]), acting, who)
                for place, (peaks, where) in enumerate(found):
                    ends = [member.catalogue.at("field", side)[place] for side in SIDES]
                    values[np.ix_(some, ends)] = peaks
                    at[some, place, : len(SIDES)] = where
            self._put_means(member, of, values, at, coefficients, factors[rows] != 0)
            numbers.append(values)
            extremes_at.append(at)
        block.put_numbers(here, self.layout, numbers, extremes_at)
        block.iterations[places] = pivots
        for row in here:
            block.method[row], block.not_unique[row] = "lemke", self._always
        without = np.flatnonzero(verdict == 1)
        explained = without[: max(0, _EXPLAINED - self._without_equilibrium)]
        self._without_equilibrium += len(without) - len(explained)
        done = block.solved[places]
        done[np.setdiff1d(without, explained)] = True
        return np.flatnonzero(~done).tolist()

    def _take_fields(
        self, member: PlateLayout, terms: PlateTerms, group: str, shares: Floats, acting: Bools, who: Ints
    ) -> list[tuple[Floats, Floats]]:
        """Extend a group's envelope by the fields of one plate.

        Returns for each field the extremes (k, 2) of k combinations and their positions (k, 2, 2).
        """
        result, places = dict[str, tuple[Floats, Floats]](), member.plate.own.stress_nodes.points
        assert self.terms is not None
        envelope, own = self._envelope(group).fields, member.plate.own
        for those in field_groups(envelope):
            first, nodes = those.names[0], member.nodes_of(those.names[0])
            ending = AT_FACES if those.of_bars and own.model.at_faces else ""
            inputs = [terms.fields[name + ending] for name in those.inputs]
            count = inputs[0].shape[1]
            hidden = member.hidden.get(first, Hidden.nothing(count))
            left_out = hidden.under(acting, self.terms.cases)
            each = [envelope[name].pick(nodes) for name in those.names]
            section = own.node_thickness[:count], own.model.bars
            found = Extremes.take_sums(each, those, shares, inputs, *section, who, hidden.classes, left_out)
            for name, of_plate, peaks, at in zip(those.names, each, *found, strict=True):
                envelope[name].put(nodes, of_plate)
                result[name] = peaks, places[at]
        return [result[name] for name in self.layout.fields]

    def _put_means(
        self,
        member: PlateLayout,
        terms: PlateTerms,
        values: Floats,
        places: Floats,
        coefficients: Floats,
        acting: Bools,
    ) -> None:
        """Store extremes of means beside a plate's singularities; ``acting`` (r, c) marks each row's load cases."""
        assert self.terms is not None
        beside = member.beside
        named = [(name, place) for place, name in enumerate(self.layout.fields) if name in PEAKING]
        if not len(beside) or not named:
            return
        column = {case: place for place, case in enumerate(self.terms.cases)}
        always, known = np.array([(not case, case in column) for case in beside.case]).T
        of_case = np.array([column.get(case, 0) for case in beside.case])
        ends = member.catalogue.at("mean", *MEAN_SIDES)
        for first in range(0, len(values), step := max(1, _DEFLECTIONS // terms.means.shape[1])):
            some = slice(first, first + step)
            share = np.ascontiguousarray(coefficients[some])
            means = _core.superpose(share, terms.means).reshape(len(share), len(beside), -1)
            peaking = always | (known & acting[some][:, of_case])
            for (name, place), columns in zip(named, ends, strict=True):
                found, at = mean_ends(name, means, beside, peaking, self.layout.model.bars)
                values[some, columns] = found
                where = np.where(np.isnan(found)[..., None], np.nan, beside.places[at])
                places[some, place, len(SIDES) :] = where

    def _unbalanced(self, name: str, message: str) -> None:
        self._without_equilibrium += 1
        if len(self.unbalanced) < _EXPLAINED:
            self.unbalanced[name] = message


def _by_group(groups: Sequence[str], rows: Ints) -> Iterator[tuple[str, Ints]]:
    """Yield each group of combinations with those of the rows (k,), in rising order, that belong to it."""
    for group in dict.fromkeys(groups[row] for row in rows):
        yield group, np.array([row for row in rows if groups[row] == group])


def _factors(combinations: Sequence[Combination], cases: Sequence[str]) -> Floats:
    """Factors (k, c) of c load cases in k combinations."""
    column = {case: index for index, case in enumerate(cases)}
    out = np.zeros((len(combinations), len(cases)))
    for row, combination in enumerate(combinations):
        for case, factor in (combination.factors or {}).items():
            out[row, column[case]] = factor
    return out


def _loads(model: Model, combinations: Sequence[Combination]) -> Iterator[tuple[str, Floats]]:
    """Yield columns with the factors of load cases and with the positions of moving loads.

    A value is NaN in a combination that has the moving load at two positions.
    """
    travelled = {at: (load.case, s) for load in model.moving for at, s in load.positions.items()}
    factor = {case: np.zeros(len(combinations)) for case in (*model.load_cases, *(m.case for m in model.moving))}
    position = {load.case: np.full(len(combinations), np.nan) for load in model.moving}
    for row, combination in enumerate(combinations):
        standing: set[str] = set()
        for case, value in (combination.factors or {}).items():
            name, s = travelled.get(case, (case, 0.0))
            factor[name][row] = value
            if name in position:
                position[name][row] = s
            if name in standing:
                factor[name][row] = position[name][row] = np.nan
            standing.add(name)
    for case, values in factor.items():
        yield f"factor:{case}", values
    for case, values in position.items():
        yield f"position:{case}", values
