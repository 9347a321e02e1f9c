"""Results by combination, and results of all combinations together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

from signorini.accuracy.comparison import Estimate
from signorini.accuracy.meshes import Refined
from signorini.analysis.combinations import Combined, Sink, Ways, combine
from signorini.analysis.single import rows_of, solve_one, solve_rows
from signorini.base.arguments import checked, index, key_of, known, watching
from signorini.base.on_demand import Named, OnDemand
from signorini.base.packages import package
from signorini.base.progress import Progress, Watcher
from signorini.base.remade import short
from signorini.contact.problem import ContactProblem, unfactored
from signorini.discretise import discretise
from signorini.equilibrium.imbalance import nearest_limit
from signorini.errors import InputError
from signorini.model import Combination, Model, Output
from signorini.results.envelope import NONE, Envelope, States
from signorini.results.frames import dataframe, dataset
from signorini.results.notebook import in_notebook
from signorini.results.result import Result
from signorini.results.rows import Column
from signorini.results.sensitivity import Sensitivity

_PICTURED = 4
"""Largest number of results with pictures in a notebook."""
_KEPT = 12
"""Largest number of results computed on access that are kept in memory; each has all fields at all nodes."""


def alone(model: Model, combination: Combination) -> Model:
    """Variant of a model with one combination only, for which all results are computed."""
    return model.varied(combination=(combination,), output=Output(combinations="each"))


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Results(States[str], Mapping[str, Result]):
    """Results by combination, in the order of the model. A missing result is computed on access.

    Parameters
    ----------
    problem : ContactProblem
    full : mapping of Result
        Results computed by the solve: of all combinations or, if these are rows of a table, of the combinations in
        ``output.fields``.
    seconds : mapping of float
        Duration of each step of the solve in seconds, by name: "mesh", "assemble", "factor" and so on; "total".
    refinement : tuple of Refined
        Meshes of the refinement to ``mesh.accuracy``, the mesh of these results last; empty without ``mesh.accuracy``.
    estimates : mapping of Estimate
        Half-widths of the results in ``full``, if the input has ``mesh.accuracy``; otherwise empty.
    sensitivities : tuple of Sensitivity
        Derivatives of numbers in the combinations in which they govern, see `with_sensitivities`.
    accuracy_warning : str
        Why ``mesh.accuracy`` is not reached, and the elements and memory that would be needed; empty if it is reached.

    Examples
    --------
    >>> from signorini import Model, solve
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
    >>> results.key(results.envelope["reaction:feet"].max_by)
    'c20'
    """

    problem: ContactProblem
    full: Mapping[str, Result]
    seconds: Mapping[str, float]
    refinement: tuple[Refined, ...] = ()
    estimates: Mapping[str, Estimate] | None = None
    accuracy_warning: str = ""
    sensitivities: tuple[Sensitivity, ...] = ()
    _combined: Combined | None = None

    def __getitem__(self, name: str) -> Result:
        """Return the result of a combination.

        Raises
        ------
        UnknownNameError
            If there is no combination of that name; it is also a KeyError.
        NotCertifiedError
            If it is solved now and its answer fails its certificate.
        """
        self.number_of(name)
        return self.full[name] if name in self.full else self._others[name]

    def __repr__(self) -> str:
        """List the names of the first combinations, without solving any combination."""
        return f"Results({short(self._numbers)})"

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {name: number for number, name in enumerate(self.model.effective_combinations.names())}

    def number_of(self, name: object) -> int:
        """Number of a combination, from 0.

        Raises
        ------
        UnknownNameError
            If there is no combination of that name; it is also a KeyError.
        """
        return self._numbers[key_of(name, self._numbers, "combination", "This mapping of results")]

    @cached_property
    def _others(self) -> Mapping[str, Result]:
        return OnDemand(self._numbers, lambda name: solve_one(self.problem, self._combination(name)), _KEPT)

    def _combination(self, name: str) -> Combination:
        return self.model.effective_combinations[self._numbers[name]]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the combinations."""
        return iter(self._numbers)

    def __contains__(self, name: object) -> bool:
        """Whether there is a combination of that name, without solving it."""
        return name in self._numbers

    def __len__(self) -> int:
        """Number of combinations of the model."""
        return len(self.model.effective_combinations)

    def key(self, row: int) -> str:
        """Name of a combination, given its number from 0."""
        return self.model.effective_combinations[index(row, len(self), "combination", "row")].name

    @cached_property
    def combined(self) -> Combined:
        """Results of all combinations together: rows of the table, envelopes, counts of combinations."""
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
        """Names of combinations with an extreme of a field, reaction or section force, by group if there are groups."""
        return tuple(map(self.key, self.combined.governing))

    @cached_property
    def table(self) -> Mapping[str, Column]:
        """Columns of the table by name, with one row per combination.

        If the table is too large to be stored, all combinations are solved again for it.
        """
        return rows_of(self.combined, self._combine)

    def governing_value(self, name: str) -> tuple[float, int] | None:
        """Value of a number in the combination in which it governs, and the number of the combination from 0.

        For maxima and utilisations the largest value governs, for minima the smallest, and for other numbers the value
        with the largest magnitude. None if no combination has the number.
        """
        catalogue = self.combined.layout.catalogue
        place = catalogue.by_name[name]
        what = catalogue.numbers[place].what
        sides = self.envelope.values.sides
        ends = [(float(values[place]), int(by[place])) for values, by in sides if by[place] != NONE]
        if not ends:
            return None
        largest, smallest = ends[0], ends[-1]
        if what.startswith("min"):
            return smallest
        rises = what.startswith("max") or what == "utilisation" or abs(largest[0]) >= abs(smallest[0])
        return largest if rises else smallest

    def _combine(self, sink: Sink | None) -> Combined:
        if self.model.tabulated:
            return solve_rows(self.problem, watching(None, ""), sink)
        ways = Ways(self.problem, lambda one: self.full[one.name], None)
        return combine(self.discretisation, lambda first: ways, lambda name: None, sink)

    @cached_property
    def limits(self) -> Mapping[str, tuple[str, float] | None]:
        """Nearest limit of equilibrium by combination: a load case, and the multiple of the case's factor.

        The value is None if no load case alone reaches a limit, see `signorini.equilibrium.imbalance.nearest_limit`.
        For rows of a table it is computed on access.
        """
        result, freedom = self.discretisation, self.problem.freedom
        limits = OnDemand(self._numbers, lambda name: nearest_limit(result, freedom, self._combination(name)))
        return limits if self.model.tabulated else Named(dict(limits), "combination", "This mapping of limits")

    @property
    def unbalanced(self) -> Mapping[str, str]:
        """Reasons why combinations have no equilibrium, by name, for the first 100."""
        return self.combined.unbalanced

    @property
    def unbalanced_count(self) -> int:
        """Number of combinations without equilibrium."""
        return len(self) - self.combined.solved

    def to_dataframe(self) -> Any:
        """Return ``table`` as a `pandas.DataFrame` with one row per combination; pandas must be installed.

        Examples
        --------
        >>> from signorini import Model, solve
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        ...     support=[{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}],
        ...     load=[{"case": "G", "pressure": 1e3}],
        ... )
        >>> results = solve(model)
        >>> results.to_dataframe()["reaction:feet"].round(3).to_dict()
        {'all': 16000.0}
        """
        return dataframe(self.table, "combination")

    def to_xarray(self) -> Any:
        """Return fields and reactions of all results in ``full`` as an `xarray.Dataset`; xarray must be installed.

        Fields have the dimensions combination and node, reactions have combination and support.
        """
        return dataset(self.full)

    def to_pyvista(self) -> Any:
        """Return the solved results in ``full`` as a `pyvista.MultiBlock` by combination; PyVista must be installed."""
        blocks = {name: one.to_pyvista() for name, one in self.full.items() if one.status == "solved"}
        return package("pyvista").MultiBlock(blocks)

    @classmethod
    def alone(cls, result: Result) -> Self:
        """Make `Results` that contain one result only; the model is discretised again on the same mesh.

        Raises
        ------
        InputError
            If the result is that of one of several plates.
        """
        if any(one.between for one in result.model.support) and not result.plates:
            raise InputError("found the result of one of several plates; take the result of all.", place="results")
        own = result.combination or Combination(name=result.name, factors={})
        model = alone(result.model.original, own)
        discretisation = discretise(model, None if result.plates else result.mesh)
        return cls(unfactored(discretisation), {result.name: result}, {"total": result.seconds})

    def _repr_html_(self) -> str:
        """Show the results in ``full`` in a notebook; many results have no pictures."""
        pictured = len(self.full) <= _PICTURED
        return "".join(in_notebook(result, None, "", pictured=pictured) for result in self.full.values())


def with_sensitivities(results: Results, names: Sequence[str], watcher: Watcher) -> Results:
    """Copy of the results with derivatives of numbers with respect to all parameters that act.

    Each number is differentiated in the combination in which it governs.

    Raises
    ------
    InputError
        If there is no number of a name, no combination has it, or it has no derivatives.
    """
    found, numbers = list[Sensitivity](), results.combined.layout.catalogue.by_name if names else {}
    for name in names:
        governing = results.governing_value(known(name, numbers, "number", "sensitivity"))
        if governing is None:
            raise InputError(f"no combination has a value of {name}.", "sensitivity")
        found.append(results[results.key(governing[1])].sensitivity(name))
        for path in found[-1]:
            watcher(Progress(stage="sensitivity", reached=f"{name} by {path}"))
            found[-1].derivative(path)
    return replace(results, sensitivities=tuple(found)) if found else results
