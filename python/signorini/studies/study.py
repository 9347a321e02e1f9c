"""Solve a study: every variant of a template, in local processes or on a cluster."""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from functools import cached_property
from itertools import islice, permutations
from pathlib import Path
from typing import Self

from signorini.base.arguments import checked, known, made_by
from signorini.discretise import discretise
from signorini.errors import InputError, Place
from signorini.formats.inputfile import load
from signorini.model import Model
from signorini.model.key_units import unit_at
from signorini.model.study import Design
from signorini.plot.artist import cores
from signorini.results.rows import Layout
from signorini.studies.parameters import MOST_ROWS, Parameter, Value, place_of, variants
from signorini.studies.store import Store, type_of
from signorini.studies.summary import Study
from signorini.studies.variant import OtherProgramError, Row, Variant, program, solved
from signorini.studies.workers import Workers

_TRIES = 5
"""Number of times that a variant is submitted if the executor cancels it, such as a Dask scheduler that restarts."""
_AHEAD = 4
"""Number of variants per worker that are submitted before their results are needed, so that no worker waits."""
_UNKNOWN_WORKERS = 64
"""Assumed number of workers of an executor without an attribute ``count``."""
_BLOCK, _SECONDS = 1000, 2.0
"""Finished rows are written to disk after this number of rows or seconds; a crash loses no more."""


@dataclass(frozen=True)
class StudyProgress:
    """Progress of a study: ``done`` of ``total`` variants are finished, ``unsolved`` of these have no solution.

    ``left`` is the estimated remaining time in seconds, ``row`` the row of the latest variant.
    """

    done: int
    total: int
    unsolved: int
    left: float
    row: Row | None = None


@dataclass(frozen=True, eq=False)
class Plan:
    """A study to solve: template, places of its parameters, values of each variant, names of the recorded results."""

    template: Model
    parameters: tuple[Parameter, ...]
    places: tuple[Place, ...]
    values: tuple[tuple[Value, ...], ...]
    results: tuple[str, ...]

    @classmethod
    def of(
        cls,
        template: Model,
        parameters: Mapping[str, object],
        results: Sequence[str],
        directory: Path,
        design: Design | None,
        samples: int | None,
        seed: int,
    ) -> Self:
        """Make a plan: read parameters (file names are relative to ``directory``), make variants, check all names."""
        if not parameters:
            raise InputError(
                "the study has no parameter. Give at least one parameter with its values.", ("parameters",)
            )
        chosen = tuple(Parameter.of(path, given, directory) for path, given in parameters.items())
        if design is None:
            design = "latin" if any(one.is_random for one in chosen) else "grid"
        if samples is not None and not 2 <= samples <= MOST_ROWS:
            raise InputError(f"found {samples}; it must be from 2 to {MOST_ROWS}.", ("samples",))
        values = tuple(variants(chosen, design, samples, seed))
        tables = json.loads(template.provenance.text)
        places = tuple(place_of(one.path, template, tables) for one in chosen)
        for (one, place), (other, whole) in permutations(zip(chosen, places, strict=True), 2):
            if place[: len(whole)] == whole:
                why = f"the parameter {other.path} sets the same key, or a table that contains this key. Remove one."
                raise InputError(why, ("parameters", one.path))
        if not results:
            raise InputError(
                "the study has no result. Name at least one number, such as check:NAME.utilisation.", ("results",)
            )
        numbers = Layout.of(discretise(template)).catalogue.by_name
        for index, name in enumerate(results):
            known(name, numbers, "number", f"results[{index + 1}]")
        return cls(template, chosen, places, values, tuple(results))

    def variant(self, number: int) -> Variant:
        """Return the variant with this number, counted from 0."""
        names, text = tuple(one.path for one in self.parameters), self.template.provenance.text
        return Variant(number, self._program, text, self.places, names, self.values[number], self.results)

    @cached_property
    def _program(self) -> str:
        return program()

    @cached_property
    def units(self) -> Mapping[str, str]:
        """Units of the parameters (by path) and results (by name); an empty text if there is no unit."""
        tables, labels = json.loads(self.template.provenance.text), self.template.units
        catalogue = Layout.of(discretise(self.template)).catalogue
        numbers = (catalogue.numbers[catalogue.by_name[name]] for name in self.results)
        results = {one.name: one.quantity.unit(labels) for one in numbers}
        paths = zip(self.parameters, self.places, strict=True)
        return results | {one.path: unit_at(place, labels, tables) for one, place in paths}

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of everything on which the rows depend: program, template, its files, parameters, values, results."""
        files = [(one["file"], one["sha256"]) for one in self.template.provenance.json({})["input"]["files"]]
        paths = [one.path for one in self.parameters]
        whole = [self._program, self.template.provenance.text, files, paths, self.values, self.results]
        return hashlib.sha256(json.dumps(whole, default=str).encode()).hexdigest()

    def store(self, directory: Path) -> Store:
        """Return the `Store` of this study's rows in a directory."""
        types: dict[str, type] = {"row": int}
        columns = zip(self.parameters, zip(*self.values, strict=True), strict=True)
        types |= {one.path: type_of(column) for one, column in columns}
        types |= {"status": str, "message": str, "model_sha256": str}
        types |= {"elements": int, "certificate": float}
        for name in self.results:
            types |= {name: float, f"plus_minus:{name}": float, f"combination:{name}": str}
        return Store(directory, self.sha256, self.template.provenance.metadata, types)


@checked
def study(
    template: Model | str | os.PathLike[str],
    parameters: Mapping[str, object],
    results: Sequence[str],
    executor: Executor | None = None,
    *,
    design: Design | None = None,
    samples: int | None = None,
    seed: int = 0,
    output: str | os.PathLike[str] | None = None,
    shard: tuple[int, int] | None = None,
    progress: Callable[[StudyProgress], object] | None = None,
) -> Study:
    """Solve many variants of a model; each variant is a row of a table, with the reason if it has no solution.

    The rows are the same to the last bit for any executor and any number of workers.

    Parameters
    ----------
    template : Model or path-like
        The model, or its input file.
    parameters : mapping
        Values by path in the input, such as ``{"support.soil.stiffness": [2e7, 3e7]}``: a list, ``{"from": a, "to": b,
        "steps": n}``, ``{"file": "table.csv"}``, or a distribution such as ``{"normal": [mean, deviation]}``.
    results : sequence of str
        Names of numbers, as for thresholds of a path: "soil.max_pressure", "check:NAME.utilisation".
    executor : concurrent.futures.Executor, optional
        It solves the variants, such as ``client.get_executor()`` of Dask. Default: local processes, one per core.
    design : {"grid", "list", "latin"}, optional
        How values are combined. Default: "latin" if a parameter is random, else "grid".
    samples : int, optional
        Number of variants of a Latin hypercube.
    seed : int
        Seed of the random numbers of a Latin hypercube.
    output : path-like, optional
        Directory of study.parquet. Rows that it has are not solved again.
    shard : (i, n), optional
        Solve only every n-th variant, beginning with number i from 1; for arrays of jobs that share ``output``.
    progress : callable, optional
        Called with a `StudyProgress` after each variant. An exception in it ends the study; finished rows are kept.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        If the template, a path, a value or a name is invalid, or ``output`` has rows of another study.
    SignoriniError
        If a worker runs another version of the program.

    Examples
    --------
    >>> from signorini import Model
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     mesh={"divisions": [2, 2]},
    ...     support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7}],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> found = study(model, {"load[1].pressure": [5e3, 6e3]}, ["soil.max_pressure"])
    >>> found["soil.max_pressure"].round(6).tolist()
    [5000.0, 6000.0]
    """
    directory = Path()
    if not isinstance(template, Model):
        directory, template = Path(template).parent, load(template)
    made_by(template, Model, "Load the file first: signorini.load(file).", "template")
    plan = Plan.of(template, parameters, results, directory, design, samples, seed)
    return run(plan, executor, None if output is None else Path(output), shard, progress)


def run(
    plan: Plan,
    executor: Executor | None,
    output: Path | None,
    shard: tuple[int, int] | None,
    progress: Callable[[StudyProgress], object] | None,
) -> Study:
    """Solve the variants of a planned study whose rows are not stored yet; arguments as for `study`."""
    store = None if output is None else plan.store(output)
    rows = {} if store is None else store.rows()
    missing = [number for number in _own(plan, shard) if number not in rows]
    if missing:
        solver = Workers(min(cores(), len(missing))) if executor is None else nullcontext(executor)
        with solver as chosen, _kept(store) as keep:
            begun, unsolved = time.perf_counter(), sum(row["status"] != "solved" for row in rows.values())
            for done, row in enumerate(_solved(plan, missing, chosen), 1):
                rows[row["row"]] = row
                keep(row)
                unsolved += row["status"] != "solved"
                if progress is not None:
                    left = (time.perf_counter() - begun) / done * (len(missing) - done)
                    progress(StudyProgress(len(rows), len(plan.values), unsolved, left, row))
    if store is not None:
        rows |= store.rows()
        if len(rows) == len(plan.values):
            store.finish([rows[number] for number in sorted(rows)])
    return Study(
        tuple(rows[number] for number in sorted(rows)),
        tuple(one.path for one in plan.parameters),
        plan.results,
        len(plan.values),
        all(one.is_random for one in plan.parameters),
    )


def _own(plan: Plan, shard: tuple[int, int] | None) -> range:
    """Return the numbers of the variants of a shard (i, n), or of all variants if ``shard`` is None."""
    if shard is None:
        return range(len(plan.values))
    number, count = shard
    if not 1 <= number <= count:
        raise InputError(f"found {number}/{count}; it must be i/n with 1 ≤ i ≤ n, such as 1/8.", "shard")
    return range(number - 1, len(plan.values), count)


@contextmanager
def _kept(store: Store | None) -> Iterator[Callable[[Row], None]]:
    """Context with a function that stores a row; rows are written in blocks, the last block also after an error."""
    waiting, since = list[Row](), time.monotonic()

    def write() -> None:
        nonlocal since
        if store is not None and waiting:
            store.add(waiting)
            waiting.clear()
        since = time.monotonic()

    def keep(row: Row) -> None:
        waiting.append(row)
        if len(waiting) >= _BLOCK or time.monotonic() - since > _SECONDS:
            write()

    try:
        yield keep
    finally:
        write()


def _solved(plan: Plan, numbers: Sequence[int], executor: Executor) -> Iterator[Row]:
    """Solve variants with an executor and yield their rows in the order in which they are finished.

    A call that the executor cancels is submitted again. A variant whose call raises an error has status "failed".
    """
    ahead = _AHEAD * getattr(executor, "count", _UNKNOWN_WORKERS)
    coming, tries = iter(numbers), dict[int, int]()
    running: dict[Future[Row], int] = {}

    def submit(number: int) -> None:
        tries[number] = tries.get(number, 0) + 1
        running[executor.submit(solved, plan.variant(number))] = number

    for number in islice(coming, ahead):
        submit(number)
    try:
        while running:
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                number = running.pop(future)
                try:
                    row = future.result()
                except OtherProgramError:
                    raise
                except CancelledError:
                    if tries[number] < _TRIES:
                        submit(number)
                        continue
                    row = plan.variant(number).failed("the executor cancelled it")
                except Exception as error:
                    row = plan.variant(number).failed(f"{type(error).__name__}: {error}")
                del tries[number]
                for following in islice(coming, 1):
                    submit(following)
                yield row
    finally:
        for future in running:
            future.cancel()
