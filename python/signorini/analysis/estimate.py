"""Estimate the mesh error of results and load paths by solving the plate on other meshes."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import overload

import numpy as np

from signorini.accuracy.comparison import Estimate, Meshes, PathEstimate, compare, known
from signorini.accuracy.half_width import half_widths, rounded
from signorini.analysis.other_meshes import ENDING, EstimatedTable, OtherMeshes, ends_of, without
from signorini.analysis.results import Results
from signorini.analysis.sampler import LINEAR, SMOOTH, PathLoads, Sampler, State, Watch, root
from signorini.analysis.single import solve_one
from signorini.analysis.tightening import tightened_by
from signorini.base.arguments import checked, index, key_of, watching
from signorini.base.progress import Progress, Watcher
from signorini.base.remade import Brief
from signorini.contact.problem import ContactProblem
from signorini.discretise.rows import Floats
from signorini.errors import InputError, SignoriniError
from signorini.mesh import Mesh
from signorini.model import Check
from signorini.results.exact_path import ExactPath
from signorini.results.load_path import AT_LIMIT, LoadPath, factors_named
from signorini.results.path_events import Threshold
from signorini.results.result import Result

_NEAR = 0.02
"""First distance from an event's load factor t at which the same event is searched on another mesh, relative to the
path's largest t.
"""
_FARTHER = 4.0
"""Ratio of successive distances from an event's t in the search for this event on another mesh."""


def estimate_asked(path: LoadPath, watcher: Watcher | None = None) -> PathEstimate | None:
    """Estimate a path if its model requests it and the path can be estimated; otherwise return None."""
    return estimate_path(path, watching(watcher, "")) if path.model.estimated and _has_estimate(path) else None


def _has_estimate(path: LoadPath) -> bool:
    """Whether a path can be estimated: it is sampled and was not interrupted."""
    return not (isinstance(path, ExactPath) or path.interrupted)


def estimate_path(path: LoadPath, watcher: Watcher) -> PathEstimate:
    """Find the events of a path on other meshes and estimate the error of their t.

    An event that does not occur on one of the meshes has no half-width.
    """
    asked = [(Watch(None, number), one.t, _falls(path, one)) for number, one in enumerate(path.thresholds) if one.t]
    names = [support.name for support in path.model.support]
    watches = [
        (Watch(names.index(event.support), event.number), event.t, event.opening) for event in path.support_events
    ]
    count, wanted = len(watches), len(path.thresholds)
    if not _has_estimate(path):
        why = "the path was interrupted." if path.interrupted else 'paths with events = "all" are solved on one mesh.'
        return PathEstimate.nothing(count, wanted, (without(0, why),))

    def found(problem: ContactProblem, watch: Watcher) -> tuple[Mesh, list[float]]:
        problem = tightened_by(problem, factors_named(problem.discretisation, path.start), watch)
        sampler = Sampler(problem, loads := PathLoads.of(problem, path.start, path.add), path.thresholds, watch)
        return problem.mesh, [*_same_events(sampler, [*watches, *asked], path.stops[-1].t), loads.limits[0]]

    others, warning = OtherMeshes(path.model, path.mesh, watcher).solved_for_path(found)
    if not others:
        return PathEstimate.nothing(count, wanted, (warning,))
    meshes = Meshes.of(path.mesh, [mesh for mesh, _ in others])
    own = [*(t for _, t, _ in [*watches, *asked]), path.limit]
    of = [(path.mesh, own), *others]
    values = np.array([next(t for mesh, t in of if mesh is one) for one in meshes.every])
    values[np.isinf(values)] = np.nan
    none = np.full(values.shape[1], np.nan)
    size = np.abs(values[meshes.own])
    widths = half_widths(values, meshes.sizes, meshes.own, none, size, np.isnan(none))[0]
    loads = PathLoads((path.start, path.add), path._loads, (0, 0))
    sampler = Sampler(path.problem, loads, path.thresholds, watching(None, ""))
    known_to = [*(LINEAR if sampler.exact(watch) else SMOOTH for watch, _, _ in [*watches, *asked]), LINEAR]
    widths = np.fmax(widths, np.where(np.isnan(widths), np.nan, np.array(known_to) * path.stops[-1].t))
    widths[widths > size] = np.nan
    found_widths = [known(width) for width in rounded(widths).tolist()]
    of_asked = iter(found_widths[count:])
    of_thresholds = tuple(next(of_asked) if one.t else None for one in path.thresholds)
    # The t at which equilibrium ends depends on the mesh only if supports have limits, else on outlines of supports.
    end = 0.0 if path.ending in ("no_equilibrium", "until") else None
    limited = path.problem.freedom.outline.limited
    if path.ending == "no_equilibrium" and limited and not widths[-1] <= LINEAR * path.limit:
        end = found_widths[-1]
    warnings = (warning,) if warning else ()
    return PathEstimate(end, tuple(found_widths[:count]), of_thresholds, meshes.elements, warnings)


def _falls(path: LoadPath, one: Threshold) -> bool:
    """Whether the quantity of a threshold falls to the threshold's value; otherwise it rises to this value."""
    row = next(row for row, stop in enumerate(path.stops) if stop.t == one.t)
    return path.stops[row - 1].number(one.quantity) >= one.value


def _same_events(sampler: Sampler, wanted: Sequence[tuple[Watch, float, bool]], span: float) -> list[float]:
    """Find, for each ``(watch, t, falls)``, the t of this event on the sampler's mesh, near the given t; NaN if none.

    If ``falls``, the function of the watch becomes negative, as where a point opens; otherwise it becomes positive.
    """
    state = sampler.state(0.0)
    result = [math.nan] * len(wanted)
    for number in sorted(range(len(wanted)), key=lambda number: wanted[number][1]):
        watch, t, falls = wanted[number]
        try:
            state = _same_event(sampler, state, watch, t, falls, span)
        except SignoriniError:
            continue
        result[number] = state.t
    return result


def _same_event(sampler: Sampler, near: State, watch: Watch, t: float, falls: bool, span: float) -> State:
    """Find an event before or after t, as the sign of its function at t says, at distances that grow fourfold."""
    end = sampler.path.end * (1 - AT_LIMIT)
    state = sampler.state(min(t, end), near)
    beyond = (sampler.value(state, watch) >= 0) != falls
    distance, known = min(_NEAR * span, t / _FARTHER), [state]
    while distance <= t:
        last = known[0].t <= 0 if beyond else known[-1].t >= end
        if last:
            break
        next_t = max(t - distance, 0.0) if beyond else min(t + distance, end)
        other = sampler.state(next_t, known[0 if beyond else -1])
        known.insert(0 if beyond else len(known), other)
        if ((sampler.value(other, watch) >= 0) == falls) == beyond:
            return root(sampler, watch, known, known[0].t, span)
        distance *= _FARTHER
    raise SignoriniError("the event does not occur on this mesh.")


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Estimates(Brief, Mapping[str, Estimate]):
    """Half-widths of results, by combination.

    Parameters
    ----------
    results : Results
    full : mapping of Estimate
        Estimate of every result in ``results.full``, by combination.
    of_table : EstimatedTable or None
        Half-widths of the table, if combinations are rows of a table.
    """

    results: Results
    full: Mapping[str, Estimate]
    of_table: EstimatedTable | None

    def __getitem__(self, name: str) -> Estimate:
        """Return the estimate of a combination in ``full``.

        Raises
        ------
        UnknownNameError
            If ``full`` has no such name; it is also a KeyError.
        """
        return self.full[key_of(name, self.full, "combination", "This mapping of estimates")]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the combinations."""
        return iter(self.full)

    def __len__(self) -> int:
        """Number of the combinations that have an estimate."""
        return len(self.full)

    @property
    def table(self) -> Mapping[str, Floats]:
        """Half-widths (k,) of columns of ``results.table``, by ``<column>:plus_minus``; empty without other meshes."""
        if self.of_table is not None:
            return self.of_table.widths
        catalogue = self.results.combined.layout.catalogue
        if not any(one.elements for one in self.full.values()):
            return {}
        return {
            one.column + ENDING: widths
            for one, widths in zip(catalogue, self._listed.T, strict=True)
            if one.quantity.kind != "count"
        }

    @cached_property
    def _listed(self) -> Floats:
        """Half-widths (k, n) of the table's n numbers in k combinations, if all combinations have an estimate."""
        catalogue, rows = self.results.combined.layout.catalogue, []
        for name in self.results:
            by_path = self.full[name].result.catalogue.by_path
            rows.append(self.full[name].widths[[by_path[one.path] for one in catalogue]])
        return np.array(rows)

    def half_width(self, column: str, row: int | str) -> float | None:
        """Return the half-width of a number of the table; None if it is unknown.

        Parameters
        ----------
        column : str
            Name of a column with half-widths, such as "reaction:soil".
        row : int or str
            Number of a combination, from 0, or its name.

        Raises
        ------
        UnknownNameError
            If there is no such column or combination; it is also a KeyError.
        InputError
            If the number is too large.
        """
        results = self.results
        by_column = results.combined.layout.catalogue.by_column
        key_of(column, by_column, "column", "This table of half-widths")
        row = results.number_of(row) if isinstance(row, str) else index(row, len(results), "combination", "row")
        if self.of_table is not None:
            return self.of_table.width(column, row)
        return known(float(self._listed[row, by_column[column]]))

    def reach(self, check: Check) -> tuple[float, float]:
        """Largest utilisation − ± and utilisation + ± of a check over all combinations; −∞ without half-widths."""
        column = f"utilisation:{check.name}"
        if self.of_table is not None:
            return self.of_table.reach.get(column, (-math.inf, -math.inf))
        widths = self.table.get(column + ENDING)
        return (-math.inf, -math.inf) if widths is None else ends_of(np.asarray(self.results.table[column]), widths)

    @property
    def no_others(self) -> str:
        """Reason why the table is compared with fewer than two other meshes; empty if with two, or without table."""
        return "" if self.of_table is None else self.of_table.why


@overload
def estimate(results: Results, progress: Watcher | None = None) -> Estimates: ...
@overload
def estimate(results: Result, progress: Watcher | None = None) -> Estimate: ...
@overload
def estimate(results: LoadPath, progress: Watcher | None = None) -> PathEstimate: ...
@checked
def estimate(
    results: Results | Result | LoadPath, progress: Watcher | None = None
) -> Estimates | Estimate | PathEstimate:
    """Solve the plate on other meshes, and estimate how far refining the mesh will move every number.

    Parameters
    ----------
    results : Results, Result or LoadPath
        Return value of `signorini.solve` or `signorini.path`, or one of its results.
    progress : callable, optional
        Called with a `Progress`; an exception in it ends the estimate and reaches the caller.

    Returns
    -------
    Estimates, Estimate or PathEstimate
        Half-widths. They are missing if no other mesh could be solved, if there is no equilibrium, or if reactions
        were given; ``warnings`` then give the reason.

    Examples
    --------
    >>> from signorini import Model, estimate, solve
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     support=[{"name": "walls", "edge": ["left", "right"], "resists": "down"}],
    ...     load=[{"pressure": 5e3, "area": {"rectangle": [0, 0, 1, 1]}}],
    ... )
    >>> results = solve(model)
    >>> width = estimate(results)["all"].plus_minus["deflection"]["max"]
    >>> print(f"{1e6 * results['all'].deflection.max():.1f} ± {1e6 * width:.1f}")
    61.9 ± 0.3
    """
    watcher = watching(progress, "progress")
    match results:
        case Results():
            return estimates_of(results, watcher)
        case Result():
            return _estimate(results, OtherMeshes(results.model, results.mesh, watcher))
        case LoadPath():
            return estimate_path(results, watcher)
    raise InputError(
        f"found {type(results).__name__}; it must be a return value of signorini.solve or signorini.path.",
        place="results",
    )


def estimates_of(results: Results, watcher: Watcher, table: str | os.PathLike[str] | None = None) -> Estimates:
    """Estimate the mesh errors of results; half-widths are also added to the Parquet file ``table``, if given."""
    calls = 1 if results.model.tabulated else max(1, len(results.full))
    meshes = OtherMeshes(results.model, results.discretisation.mesh, watcher, results.seconds["total"], calls)
    full = estimated(results, meshes) if results.estimates is None else results.estimates
    of_table = EstimatedTable.of(results, meshes, table) if results.model.tabulated else None
    return Estimates(results, full, of_table)


def estimated(results: Results, meshes: OtherMeshes) -> dict[str, Estimate]:
    """Return the estimates of all results in ``results.full``, by name of the combination."""
    return {name: _estimate(result, meshes) for name, result in results.full.items()}


def _estimate(result: Result, meshes: OtherMeshes) -> Estimate:
    """Solve the combination of a result on other meshes, and compare the results."""
    nothing, combination = np.full(len(result.catalogue), np.nan), result.combination
    if result.status != "solved" or combination is None:
        why = "there is no equilibrium." if result.status != "solved" else "the reactions were given."
        return Estimate(result, nothing, None, (), (without(0, why),))

    def solved(problem: ContactProblem, watch: Watcher) -> Result:
        watch(Progress(combination.name))
        result = solve_one(problem, combination, watch)
        if result.status != "solved":
            raise SignoriniError(result.message)
        return result

    others, warning = meshes.solved(solved)
    return compare(result, others, warning) if others else Estimate(result, nothing, None, (), (warning,))
