"""From a model to certified results, one for each combination."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from signorini.analysis.accuracy import Refined, refined, unknown, worst_of
from signorini.analysis.combinations import Combined, Sink, combine
from signorini.analysis.single import solve_one, timed
from signorini.analysis.tables import OtherTables, rows_of, solve_rows, solve_table
from signorini.analysis.twins import Twins
from signorini.analysis.twins.columns import ENDING, Rows
from signorini.analysis.twins.leaves import Path
from signorini.base.arguments import index, key_of, watching
from signorini.base.brief import short
from signorini.base.named import Named
from signorini.base.on_demand import OnDemand
from signorini.base.progress import Progress, Watcher
from signorini.contact.problem import ContactProblem, contact_problem
from signorini.discretise import discretise
from signorini.discretise.rows import Floats
from signorini.equilibrium.limits import nearest_limit
from signorini.errors import NoEquilibriumError
from signorini.mesh import Mesh
from signorini.model import Combination, Model
from signorini.results.columns import Column
from signorini.results.envelope import Envelope
from signorini.results.result import Result
from signorini.results.states import States

_KEPT = 12
"""Results computed when they were asked for that are kept: each has every field at every node."""


@dataclass(frozen=True, eq=False, repr=False)
class Results(States[str], Mapping[str, Result]):
    """Results by combination, in the order of the model; what is not there yet is computed when it is asked for.

    Parameters
    ----------
    problem : ContactProblem
    full : mapping of Result
        Results that are there already: of every combination or, where these are rows of a table, of those that
        ``output.fields`` asks for.
    seconds : mapping of float
    twins : Twins
        The plate on other meshes, for half-widths.
    refinement : tuple of Refined
        The meshes on the way to an accuracy that was asked for, this one last; else none.
    accuracy_warning : str
        Why it is not reached, and what it would take.

    Examples
    --------
    >>> from signorini import Model
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     support=[{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}],
    ...     load=[{"case": "G", "pressure": 1e3}],
    ...     combination=[{"name": f"c{i}", "factors": {"G": i}} for i in range(1, 21)],
    ... )
    >>> results = solve(model)
    >>> len(results), round(results["c7"].reactions["feet"]), results.table["reaction:feet"][:3].round().tolist()
    (20, 112000, [16000.0, 32000.0, 48000.0])
    >>> results
    Results({'c1', 'c2', 'c3', 'c4', ... 20 in all})
    >>> results.key(int(results.envelope.supports[0].reaction.largest_by[0]))
    'c20'
    """

    problem: ContactProblem
    full: Mapping[str, Result]
    seconds: Mapping[str, float]
    twins: Twins
    refinement: tuple[Refined, ...] = ()
    accuracy_warning: str = ""
    _combined: Combined | None = None

    def __getitem__(self, name: str) -> Result:
        """Return the result of a combination.

        Raises
        ------
        UnknownNameError
            Which is a KeyError too, if there is none of that name.
        NotCertifiedError
            If it is solved now and its answer fails its certificate.
        """
        self._number_of(name)
        return self.full[name] if name in self.full else self._others[name]

    def __repr__(self) -> str:
        """Name the first combinations; none is solved for it."""
        return f"Results({short(self._numbers)})"

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {name: number for number, name in enumerate(self.model.effective_combinations.names())}

    def _number_of(self, name: object) -> int:
        return self._numbers[key_of(name, self._numbers, "combination", "This mapping of results")]

    @cached_property
    def _others(self) -> Mapping[str, Result]:
        return OnDemand(self._numbers, self._solved, _KEPT)

    def _solved(self, name: str) -> Result:
        combination = self._combination(name)
        return self.twins.follow(solve_one(self.problem, combination), combination)

    def _combination(self, name: str) -> Combination:
        return self.model.effective_combinations[self._numbers[name]]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the combinations."""
        return iter(self._numbers)

    def __len__(self) -> int:
        """Count the combinations."""
        return len(self.model.effective_combinations)

    def key(self, row: int) -> str:
        """Name of a combination, given its number from 0."""
        return self.model.effective_combinations[row].name

    @cached_property
    def combined(self) -> Combined:
        """What is known of all combinations together."""
        return self._combined if self._combined is not None else self._combine(None)

    @property
    def envelope(self) -> Envelope:
        """Extremes over all combinations that were solved."""
        return self.combined.envelope

    @property
    def groups(self) -> Mapping[str, Envelope]:
        """Extremes over the combinations of each group (``combination.group``) that were solved."""
        return self.combined.groups

    @property
    def governing(self) -> tuple[str, ...]:
        """Combinations with an extreme of some field, reaction or section, of each group if there are any."""
        return tuple(map(self.key, self.combined.governing))

    @cached_property
    def table(self) -> Mapping[str, Column]:
        """Every column by name, with a row a combination; where these are many they are solved again for it."""
        return rows_of(self.combined, self._combine)

    @cached_property
    def table_plus_minus(self) -> Mapping[str, Floats]:
        """Half-widths of the table's columns, ``<column>:plus_minus``, from its rows on other meshes; none without."""
        if self.model.tabulated:
            return self._other_tables.widths
        trees = [result.plus_minus for result in self.full.values()]
        columns = self._rows.columns if any(trees) else {}
        return {
            name + ENDING: np.array([_number(tree, path) for tree in trees], np.float64)
            for name, path in columns.items()
            if name in self.table
        }

    def half_width(self, column: str, row: int | str) -> float | None:
        """The half-width of a number of the table; None without.

        Parameters
        ----------
        column : str
            One that has half-widths, such as "reaction:soil".
        row : int or str
            The number of a combination, from 0, or its name.

        Raises
        ------
        UnknownNameError
            Which is a KeyError too, if there is no such column or combination.
        InputError
            If there are not as many combinations.
        """
        key_of(column, self._rows.columns, "column", "This table of half-widths")
        row = self._number_of(row) if isinstance(row, str) else index(row, len(self), "combination", "row")
        if not self.model.estimated:
            return None
        if self.model.tabulated:
            return self._other_tables.width(column, row)
        return _number(self[self.key(row)].plus_minus, self._rows.columns[column])

    @cached_property
    def _rows(self) -> Rows:
        return Rows(self.discretisation, self.combined.layout)

    def _combine(self, sink: Sink | None) -> Combined:
        if self.model.tabulated:
            return solve_rows(self.problem, watching(None, ""), sink)
        return combine(self.problem, lambda one: self.full[one.name], None, lambda name: None, sink)

    @cached_property
    def limits(self) -> Mapping[str, tuple[str, float] | None]:
        """How far each combination is from the end of equilibrium: a case, and the factor on its own that leads there.

        None where no case has one (`signorini.equilibrium.limits.nearest_limit`). Of rows of a table each is found
        when it is asked for.
        """
        found, freedom = self.discretisation, self.problem.freedom
        limits = OnDemand(self._numbers, lambda name: nearest_limit(found, freedom, self._combination(name)))
        return limits if self.model.tabulated else Named(dict(limits), "combination", "This mapping of limits")

    def compare(self, table: str | os.PathLike[str] | None = None) -> None:
        """Solve the plate on other meshes for all results that are there, if the model asks for it (``mesh.error``).

        The table, as `signorini.solve` has written it, gains the half-widths of its columns.
        """
        for result in self.full.values():
            _ = result.asked_estimate
        if self.model.estimated and self.model.tabulated:
            self.__dict__["_other_tables"] = self._on_other_meshes(table)

    @property
    def others(self) -> tuple[tuple[Combined, Mesh], ...]:
        """What is known of all combinations together on other meshes, and these; none where none are asked for."""
        found = self._other_tables.others if self.model.estimated else ()
        return tuple((combined, problem.mesh) for combined, problem in found)

    @property
    def no_others(self) -> str:
        """Why there are no other meshes, or not all, where they are asked for; else empty."""
        return self._other_tables.why if self.model.estimated else ""

    @cached_property
    def _other_tables(self) -> OtherTables:
        return self._on_other_meshes(None)

    def _on_other_meshes(self, table: str | os.PathLike[str] | None) -> OtherTables:
        return OtherTables.solved(self.problem, self.combined, self.twins, table)

    @property
    def unbalanced(self) -> Mapping[str, str]:
        """Why combinations have no equilibrium, by name; of many the first."""
        return self.combined.unbalanced

    @property
    def unbalanced_count(self) -> int:
        """How many combinations have no equilibrium."""
        return len(self) - self.combined.solved

    def _repr_html_(self) -> str:
        """Show the combinations in a notebook, of many those that have all results."""
        return "".join(result._repr_html_() for result in self.full.values())


def solve(model: Model, progress: Watcher | None = None, table: str | os.PathLike[str] | None = None) -> Results:
    """Solve a model for each of its combinations.

    A combination whose load no reactions can balance gets a result with status "no_equilibrium", NaN for every number,
    and the reason in ``message``; the others are solved.

    More than a few combinations, or where ``output.combinations`` is "table", are solved as rows of a table, without
    their fields; these are computed for those that ``output.fields`` asks for, and for others when they are asked for.

    Parameters
    ----------
    model : Model
    progress : callable, optional
        Called with a `Progress` before meshing and factoring, as every combination begins, after every step of its
        active set, and at the end of every mesh on the way to an accuracy. What it raises ends the solve and reaches
        the caller.
    table : path-like, optional
        A Parquet file to write the table to, whole or not at all; docs/results.md describes its columns. Nothing is
        written where every combination has all results.

    Returns
    -------
    Results
        A mapping from the names of the combinations to `Result`.

    Raises
    ------
    InputError
        If the model says something that cannot be, or the plate is a mechanism.
    NoEquilibriumError
        If no combination has an equilibrium.
    NotCertifiedError
        If an answer fails its certificate; it is refused.

    Examples
    --------
    >>> from signorini import Model
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
    ...     support=[{"name": "bearings", "at": [[1, 1], [9, 1], [1, 9], [9, 9]], "resists": "down"}],
    ...     load=[{"pressure": 2e3}],
    ... )
    >>> result = solve(model)["all"]
    >>> result.status, round(result.reactions["bearings"], 3), result.certificate.passed
    ('solved', 200000.0, True)
    """
    watcher = watching(progress, "progress")
    results = _solved(model, watcher, table)
    if model.mesh.accuracy is None:
        return results
    steps, warning = list[Refined](), ""
    finer: Model | None = model
    while finer is not None:
        reached = worst_of(results.full, steps)
        if reached is None:
            warning = unknown(model.mesh.accuracy)
            break
        steps.append(reached)
        watcher(Progress(stage="refined", reached=f"mesh {len(steps)}: {reached.said(model.mesh.accuracy)}"))
        finer, warning = refined(results.model, results.full, steps)
        if finer is not None:
            before = f"mesh {len(steps) + 1}, ± {reached.worst:.2g} on {reached.elements} elements"
            results = _solved(finer, partial(_refining, watcher, before), table)
    return replace(results, refinement=tuple(steps), accuracy_warning=warning)


def _refining(watcher: Watcher, before: str, now: Progress) -> object:
    """Show what is being done on a finer mesh, with how far the mesh before it came."""
    return watcher(replace(now, reached=before))


def _solved(model: Model, watcher: Watcher, table: str | os.PathLike[str] | None) -> Results:
    """Solve a model on its mesh."""
    begun = time.perf_counter()
    watcher(Progress(stage="mesh"))
    found = discretise(model)
    watcher(Progress(stage="factor"))
    problem = contact_problem(found)
    twins = Twins(found.model, found.mesh, watcher)
    results: dict[str, Result] = {}
    combined = None
    contact = recover = 0.0
    if model.tabulated:
        combined = solve_table(problem, watcher, table)
        contact = time.perf_counter() - begun - found.seconds["mesh"] - found.seconds["assemble"]
        contact -= sum(problem.seconds.values())
    for combination in _with_all_results(model, combined):
        watcher(Progress(combination.name))
        result, spent = timed(problem, combination, watcher)
        results[combination.name] = twins.follow(result, combination)
        contact += spent
        recover += result.seconds
    if combined is None and all(result.status == "no_equilibrium" for result in results.values()):
        raise NoEquilibriumError("\n".join(f"{name}: {result.message}" for name, result in results.items()))
    part = problem.seconds
    seconds = {
        "mesh": found.seconds["mesh"],
        "assemble": found.seconds["assemble"],
        "order": part["order"],
        "factor": part["factor"],
        "contact": part["condense"] + contact,
        "recover": recover,
        "total": time.perf_counter() - begun,
    }
    # Without a table no more is to be solved, and whoever keeps many results does not keep as many factors.
    kept = problem if combined is not None else problem.without_factor()
    return Results(kept, results, seconds, twins, _combined=combined)


def _number(tree: Mapping[str, Any] | None, path: Path) -> float | None:
    """A number of a tree; None where there is none."""
    found: Any = tree
    for part in path:
        found = None if found is None else found[part]
    return None if found is None else float(found)


def _with_all_results(model: Model, combined: Combined | None) -> Iterator[Combination]:
    """The combinations of which every field is computed."""
    asked, combinations = model.output.fields, model.effective_combinations
    if combined is None or asked == "all":
        yield from combinations
    elif asked == "governing":
        yield from (combinations[row] for row in sorted(combined.governing))
    elif asked != "none":
        yield from (combination for combination in combinations if combination.name in asked)
