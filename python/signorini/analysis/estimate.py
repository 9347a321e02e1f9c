"""How far results are from the plate's: the same plate solved on other meshes."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import overload

import numpy as np

from signorini.accuracy.comparison import compare, known
from signorini.accuracy.estimate import Estimate, PathEstimate
from signorini.analysis.estimated_table import ENDING, EstimatedTable
from signorini.analysis.other_meshes import OtherMeshes
from signorini.analysis.path_estimate import estimate_path
from signorini.analysis.results import Results
from signorini.analysis.single import solve_one
from signorini.base.arguments import index, key_of, watching
from signorini.base.brief import Brief
from signorini.base.progress import Progress, Watcher
from signorini.contact.problem import ContactProblem
from signorini.discretise.rows import Floats
from signorini.errors import InputError, SignoriniError
from signorini.results.load_path import LoadPath
from signorini.results.result import Result


@dataclass(frozen=True, eq=False, repr=False)
class Estimates(Brief, Mapping[str, Estimate]):
    """Half-widths of results, by combination.

    Parameters
    ----------
    results : Results
    full : mapping of Estimate
        Of every result that is in ``results.full``.
    of_table : EstimatedTable or None
        Of combinations that are rows of a table.
    """

    results: Results
    full: Mapping[str, Estimate]
    of_table: EstimatedTable | None

    def __getitem__(self, name: str) -> Estimate:
        """Return the estimate of a combination that has all results.

        Raises
        ------
        UnknownNameError
            Which is a KeyError too, if there is none.
        """
        return self.full[key_of(name, self.full, "combination", "This mapping of estimates")]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the combinations."""
        return iter(self.full)

    def __len__(self) -> int:
        """Count the estimates."""
        return len(self.full)

    @property
    def table(self) -> Mapping[str, Floats]:
        """Half-widths of the columns of ``results.table``, by ``<column>:plus_minus``; none without other meshes."""
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
        """Half-widths (k, n) of the numbers of the table, of combinations that all have an estimate."""
        catalogue, rows = self.results.combined.layout.catalogue, []
        for name in self.results:
            by_path = self.full[name].result.catalogue.by_path
            rows.append(self.full[name].widths[[by_path[one.path] for one in catalogue]])
        return np.array(rows)

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
        results = self.results
        by_column = results.combined.layout.catalogue.by_column
        key_of(column, by_column, "column", "This table of half-widths")
        row = results.number_of(row) if isinstance(row, str) else index(row, len(results), "combination", "row")
        if self.of_table is not None:
            return self.of_table.width(column, row)
        return known(float(self._listed[row, by_column[column]]))

    @property
    def no_others(self) -> str:
        """Of a table why there are no other meshes, or not all; else empty."""
        return "" if self.of_table is None else self.of_table.why


@overload
def estimate(results: Results, progress: Watcher | None = None) -> Estimates: ...
@overload
def estimate(results: Result, progress: Watcher | None = None) -> Estimate: ...
@overload
def estimate(results: LoadPath, progress: Watcher | None = None) -> PathEstimate: ...
def estimate(
    results: Results | Result | LoadPath, progress: Watcher | None = None
) -> Estimates | Estimate | PathEstimate:
    """Solve the plate on other meshes, and say how far refining the mesh is expected to move every number.

    Parameters
    ----------
    results : Results, Result or LoadPath
        What `signorini.solve` or `signorini.path` has returned, or one of its results.
    progress : callable, optional
        Called with a `Progress`; what it raises ends the estimate and reaches the caller.

    Returns
    -------
    Estimates, Estimate or PathEstimate
        Without half-widths where no other mesh could be solved, as ``warnings`` then say, where there is no
        equilibrium, and of reactions that were given.

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
        f"found {type(results).__name__}; it must be what signorini.solve or signorini.path returns.", place="results"
    )


def estimates_of(results: Results, watcher: Watcher, table: str | os.PathLike[str] | None = None) -> Estimates:
    """Estimate results; a table that `signorini.solve` has written gains the half-widths of its columns."""
    meshes = OtherMeshes(results.model, results.discretisation.mesh, watcher)
    full = estimated(results, meshes) if results.estimates is None else results.estimates
    of_table = EstimatedTable.of(results, meshes, table) if results.model.tabulated else None
    return Estimates(results, full, of_table)


def estimated(results: Results, meshes: OtherMeshes) -> dict[str, Estimate]:
    """Estimate every result that is there."""
    return {name: _estimate(result, meshes) for name, result in results.full.items()}


def _estimate(result: Result, meshes: OtherMeshes) -> Estimate:
    """Compare a result with those on other meshes."""
    nothing, combination = np.full(len(result.catalogue), np.nan), result.combination
    if result.status != "solved" or combination is None:
        return Estimate(result, nothing, None, (), ())

    def solved(problem: ContactProblem, watch: Watcher) -> Result:
        watch(Progress(combination.name))
        result = solve_one(problem, combination, watch)
        if result.status != "solved":
            raise SignoriniError(result.message)
        return result

    others, warning = meshes.solved(solved)
    return compare(result, others, warning) if others else Estimate(result, nothing, None, (), (warning,))
