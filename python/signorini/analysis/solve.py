"""Solve a model: a certified result for each of its combinations."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from signorini.accuracy.comparison import Estimate
from signorini.accuracy.meshes import Refined, refined, unknown, worst_of
from signorini.analysis.checks import require_checks
from signorini.analysis.combinations import Combined
from signorini.analysis.estimate import estimated
from signorini.analysis.other_meshes import OtherMeshes
from signorini.analysis.results import Results
from signorini.analysis.single import solve_table, timed
from signorini.base.arguments import checked, watching
from signorini.base.progress import Progress, Watcher
from signorini.contact.problem import contact_problem
from signorini.discretise import discretise
from signorini.errors import NoEquilibriumError
from signorini.model import Combination, Model
from signorini.results.result import Result

_REASONS = 5
"""Largest number of combinations that the message lists if no combination of a table has an equilibrium."""


@checked
def solve(model: Model, progress: Watcher | None = None, table: str | os.PathLike[str] | None = None) -> Results:
    """Solve a model for each of its combinations.

    If no reactions balance a combination, its result has status "no_equilibrium", NaN for every number, and the reason
    in ``message``; the others are solved.

    Many combinations, or any number if ``output.combinations`` is "table", are solved as rows of a table, without
    fields. Fields are computed for the combinations in ``output.fields``, and for others on access.

    Parameters
    ----------
    model : Model
    progress : callable, optional
        Called with a `Progress` before meshing and factoring, at the start of every combination, after every step of
        its active set, and at the end of every mesh of a refinement. An exception in it ends the solve and reaches the
        caller.
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
        If the model is contradictory, or the plate is a mechanism.
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
    results = solve_all(model, watching(progress, "progress"), table)
    if not _any_solved(results):
        raise NoEquilibriumError(_reasons(results))
    return results


def solve_all(model: Model, watcher: Watcher, table: str | os.PathLike[str] | None = None) -> Results:
    """Solve a model as `solve` does; also return results in which no combination has an equilibrium."""
    results = _solved(model, watcher, table)
    if model.mesh.accuracy is None or not _any_solved(results):
        return results
    steps, warning, estimates = list[Refined](), "", dict[str, Estimate]()
    finer: Model | None = model
    watch = watcher
    while finer is not None:
        estimates = estimated(results, OtherMeshes(results.model, results.discretisation.mesh, watch))
        reached = worst_of(estimates, steps)
        if reached is None:
            warning = unknown(model.mesh.accuracy)
            break
        steps.append(reached)
        watcher(Progress(stage="refined", reached=f"mesh {len(steps)}: {reached.said(model.mesh.accuracy)}"))
        finer, warning = refined(results.model, estimates, steps)
        if finer is not None:
            before = f"mesh {len(steps) + 1}, ± {reached.worst:.2g} on {reached.elements} elements"
            watch = partial(_refining, watcher, before)
            results = _solved(finer, watch, table)
    return replace(results, refinement=tuple(steps), estimates=estimates, accuracy_warning=warning)


def _any_solved(results: Results) -> bool:
    """Whether some combination has an equilibrium."""
    if results.model.tabulated:
        return results.combined.any_solved()
    return any(result.status == "solved" for result in results.full.values())


def _reasons(results: Results) -> str:
    """Reasons why no combination has an equilibrium; for a table only the first reasons."""
    if not results.model.tabulated:
        return "\n".join(f"{name}: {result.message}" for name, result in results.full.items())
    some = "\n".join(f"{name}: {message}" for name, message in list(results.unbalanced.items())[:_REASONS])
    return f"None of {len(results)} combinations has an equilibrium. The first reasons:\n{some}"


def _refining(watcher: Watcher, before: str, now: Progress) -> object:
    """Report progress on a finer mesh, with the accuracy reached on the mesh before."""
    return watcher(replace(now, reached=before))


def _solved(model: Model, watcher: Watcher, table: str | os.PathLike[str] | None) -> Results:
    """Solve a model on one mesh, without refinement."""
    begun = time.perf_counter()
    watcher(Progress(stage="mesh"))
    discretisation = discretise(model)
    require_checks(discretisation)
    watcher(Progress(stage="factor"))
    problem = contact_problem(discretisation)
    results: dict[str, Result] = {}
    combined = None
    contact = recover = 0.0
    if model.tabulated:
        combined = solve_table(problem, watcher, table)
        contact = time.perf_counter() - begun - discretisation.seconds["mesh"] - discretisation.seconds["assemble"]
        contact -= sum(problem.seconds.values())
    for combination in _with_all_results(model, combined):
        watcher(Progress(combination.name))
        result, spent = timed(problem, combination, watcher)
        results[combination.name] = result
        contact += spent
        recover += result.seconds
    part = problem.seconds
    seconds = {name: discretisation.seconds[name] for name in ("mesh", "assemble")}
    seconds |= {"order": part["order"], "factor": part["factor"], "contact": part["condense"] + contact}
    seconds |= {"recover": recover, "total": time.perf_counter() - begun}
    # Without a table the results are complete; the factor is dropped to save memory.
    kept = problem if combined is not None else problem.without_factor()
    return Results(kept, results, seconds, _combined=combined)


def _with_all_results(model: Model, combined: Combined | None) -> Iterator[Combination]:
    """Yield the combinations for which the solve computes all results, and not only a row of the table."""
    asked, combinations = model.output.fields, model.effective_combinations
    if combined is None or asked == "all":
        yield from combinations
    elif asked == "governing":
        yield from (combinations[row] for row in sorted(combined.governing))
    elif asked != "none":
        yield from (combination for combination in combinations if combination.name in asked)
