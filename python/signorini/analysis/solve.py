"""From a model to certified results, one for each combination."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from signorini.analysis.batch import mean_load, solve_several
from signorini.analysis.combinations import Combined, combine
from signorini.base.arguments import known, made_by, watching
from signorini.base.progress import Progress, Watcher
from signorini.base.remade import Remade
from signorini.contact.problem import ContactProblem, contact_problem
from signorini.contact.refusal import refusal, uncertain
from signorini.contact.strategy import answered
from signorini.discretise import Discretisation, discretise
from signorini.equilibrium.balance import rigid_freedom
from signorini.equilibrium.limits import CONTRADICTION, imbalance_of, nearest_limit
from signorini.equilibrium.words import explain
from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError, UnknownNameError
from signorini.model import Combination, Model
from signorini.results.result import Result, unsolved_result

_REASONS = 5
"""Combinations without equilibrium that a message names where none has one."""


@dataclass(frozen=True, eq=False, repr=False)
class Results(Remade, Mapping[str, Result]):
    """Results by combination, in the order of the model.

    Parameters
    ----------
    discretisation : Discretisation
    by_name : mapping of Result
        All results of every combination; where combinations are rows of a table, of those that were asked for.
    seconds : mapping of float
    combined : Combined or None
        Where combinations are rows of a table: envelopes over all of them, and what governs.
    """

    discretisation: Discretisation
    by_name: Mapping[str, Result]
    seconds: Mapping[str, float]
    combined: Combined | None = None

    def __getitem__(self, name: str) -> Result:
        """Return the result of a combination.

        Raises
        ------
        UnknownNameError
            Which is a KeyError too, if there is none of that name.
        """
        if self.combined is not None and name not in self.by_name and name in self._every_name:
            why = self.unbalanced.get(name, "of a row of a table output.fields asks for it, if it has equilibrium.")
            raise UnknownNameError(f'The combination "{name}" has no result of its own: {why}', "combination")
        try:
            return self.by_name[known(name, self.by_name, "combination", "combination", "This mapping of results")]
        except InputError as error:
            raise UnknownNameError(error.message, error.place) from None

    @cached_property
    def _every_name(self) -> frozenset[str]:
        return frozenset(one.name for one in self.discretisation.model.effective_combinations)

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the combinations."""
        return iter(self.by_name)

    def __len__(self) -> int:
        """Count the combinations."""
        return len(self.by_name)

    @cached_property
    def limits(self) -> Mapping[str, tuple[str, float] | None]:
        """How far each combination is from the end of equilibrium: a case, and the factor on its own that leads there.

        None where no case has one (`signorini.equilibrium.limits.nearest_limit`); not asked of combinations in a table.
        """
        if self.combined is not None:
            return dict.fromkeys(self.by_name)
        found = self.discretisation
        freedom = rigid_freedom(found)
        return {c.name: nearest_limit(found, freedom, c) for c in found.model.effective_combinations}

    @property
    def unbalanced(self) -> Mapping[str, str]:
        """Why combinations have no equilibrium, by name; of many the first."""
        if self.combined is not None:
            return self.combined.unbalanced
        return {name: result.message for name, result in self.by_name.items() if result.message}

    @property
    def unbalanced_count(self) -> int:
        """How many combinations have no equilibrium."""
        if self.combined is not None:
            return len(self.combined.combinations) - self.combined.solved
        return len(self.unbalanced)

    def _repr_html_(self) -> str:
        """Show every combination in a notebook."""
        return "".join(result._repr_html_() for result in self.by_name.values())


def solve(model: Model, progress: Watcher | None = None, table: str | os.PathLike[str] | None = None) -> Results:
    """Solve a model for each of its combinations.

    A combination whose load no reactions can balance gets a result with status "no_equilibrium", NaN for every number,
    and the reason in ``message``; the others are solved.

    More than a few combinations, or where ``output.combinations`` is "table", are rows of a table: the mapping then
    holds those that ``output.fields`` asks for, and ``combined`` what is known of all.

    Parameters
    ----------
    model : Model
    progress : callable, optional
        Called with a `Progress` before meshing and factoring, as every combination begins, and after every step of its
        active set. What it raises ends the solve and reaches the caller.
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
    begun = time.perf_counter()
    watcher = watching(progress, "progress")
    watcher(Progress(stage="mesh"))
    found = discretise(model)
    watcher(Progress(stage="factor"))
    problem = contact_problem(found)
    results: dict[str, Result] = {}
    combined = None
    contact = recover = 0.0
    if model.tabulated:
        combined = _solve_table(problem, watcher, table)
        contact = time.perf_counter() - begun - found.seconds["mesh"] - found.seconds["assemble"]
        contact -= sum(problem.seconds.values())
    for combination in _with_all_results(model, combined):
        watcher(Progress(combination.name))
        result, spent = _solve_one(problem, combination, watcher)
        results[combination.name] = result
        contact += spent
        recover += result.seconds
    if combined is None and all(result.status == "no_equilibrium" for result in results.values()):
        raise NoEquilibriumError("\n".join(f"{name}: {result.message}" for name, result in results.items()))
    part = problem.seconds
    seconds = {
        "mesh": found.seconds["mesh"],
        "assemble": found.seconds["assemble"] + part["assemble"],
        "order": part["order"],
        "factor": part["factor"],
        "contact": part["condense"] + contact,
        "recover": recover,
        "total": time.perf_counter() - begun,
    }
    return Results(found, results, seconds, combined)


def solve_one(problem: ContactProblem, combination: Combination, progress: Watcher | None = None) -> Result:
    """Solve one combination by itself.

    Raises
    ------
    NotCertifiedError
        If the answer fails its certificate; it is refused.

    Examples
    --------
    >>> from signorini import Model, contact_problem
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
    ...     support=[{"name": "bearings", "at": [[1, 1], [9, 1], [1, 9], [9, 9]], "resists": "down"}],
    ...     load=[{"case": "G", "pressure": 2e3}],
    ... )
    >>> (combination,) = model.effective_combinations
    >>> round(solve_one(contact_problem(model), combination).reactions["bearings"], 3)
    200000.0
    """
    made_by(problem, ContactProblem, "Make one with signorini.contact_problem(model).", "problem")
    return _solve_one(problem, combination, watching(progress, "progress"))[0]


def _solve_table(problem: ContactProblem, watcher: Watcher, table: str | os.PathLike[str] | None) -> Combined:
    """Every combination as a row, written to the table if there is one."""
    problem = problem.near(mean_load(problem.discretisation))

    def single(combination: Combination) -> Result:
        return solve_one(problem, combination, watcher)

    def begin(name: str) -> None:
        watcher(Progress(name))

    def several(combinations: Sequence[Combination], alone: Callable[[Combination], Result]) -> Iterator[Result]:
        return solve_several(problem, combinations, alone, begin)

    if table is None:
        combined = combine(problem, single, several, begin)
    else:
        # Only this function needs pyarrow.
        from signorini.formats.parquet import writing

        try:
            with writing(table) as sink:
                combined = combine(problem, single, several, begin, sink)
        except OSError as error:
            why = error.strerror or str(error)
            raise InputError(f"the table cannot be written there: {why}. Name another file.", str(table)) from None
    if not combined.solved:
        reasons = "\n".join(f"{name}: {message}" for name, message in list(combined.unbalanced.items())[:_REASONS])
        raise NoEquilibriumError(
            f"None of {len(combined.combinations)} combinations has one, to begin with:\n{reasons}"
        )
    return combined


def _with_all_results(model: Model, combined: Combined | None) -> Iterator[Combination]:
    """The combinations of which every field is computed."""
    asked = model.output.fields
    if combined is None or asked == "all":
        yield from model.effective_combinations
    elif asked != "none":
        names = set(combined.governing if asked == "governing" else asked)
        yield from (combination for combination in model.effective_combinations if combination.name in names)


def _solve_one(problem: ContactProblem, combination: Combination, watcher: Watcher) -> tuple[Result, float]:
    """One combination, and the seconds its contact problem took."""
    found = problem.discretisation
    load = found.load(combination)

    def steps(step: int, changing: int, residual: float) -> None:
        watcher(Progress(combination.name, step, changing, residual))

    begun = time.perf_counter()
    message = explain(found, imbalance_of(found, problem.freedom, combination))
    if message:
        return unsolved_result(found, combination.name, message), time.perf_counter() - begun
    tried = answered(problem, load, steps)
    spent = time.perf_counter() - begun
    if tried.contradiction:
        # Reactions that balance the load exist, so it is the gaps that cannot be (docs/theory.md, section 5).
        return unsolved_result(found, combination.name, CONTRADICTION), spent
    if tried.certificate is None:
        raise NotCertifiedError(
            f'Combination "{combination.name}" has no answer that could be certified. {uncertain(found)}'
        )
    if not tried.passed:
        why = refusal(combination.name, found, load, tried.answer, tried.certificate)
        raise NotCertifiedError(f"Combination {why}")
    return Result.of(found, combination.name, tried.methods, load, tried.answer, tried.certificate), spent
