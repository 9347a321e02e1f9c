"""Compute results from contact solutions: fields, reactions of supports, and numbers."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from signorini.base.on_demand import Listed
from signorini.contact.certificate import Certificate
from signorini.contact.selection import Answer
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats
from signorini.model import Combination
from signorini.results.catalogue import catalogue_of
from signorini.results.checks import overturned
from signorini.results.extremes import Means
from signorini.results.local_results import ProbeResult, probe_results, section_results
from signorini.results.of_plates import said_of
from signorini.results.punching import ColumnResult, column_results
from signorini.results.quantities import with_extremes
from signorini.results.readings import Readings, SupportForces
from signorini.results.result import Result
from signorini.results.support_result import support_result
from signorini.results.warnings import model_warnings, result_warnings, sentences
from signorini.singularities.beside import at_faces
from signorini.singularities.named import singularities


def recovered(
    discretisation: Discretisation,
    load_of: Combination | str,
    methods: Sequence[str],
    load: CaseLoad,
    answer: Answer,
    certificate: Certificate,
    stress: Floats | None = None,
    beneath: Mapping[int, Floats] | None = None,
    upon: Collection[int] = (),
) -> Result:
    """Compute a result from the contact solution ``answer``, which the last of ``methods`` found.

    ``load_of`` is the combination, or a name if the load is no combination. ``stress`` (s, 5) are the moments and
    shears at stress nodes, if known. ``beneath`` are the deflections (n,) of plates below, by index of the support
    between. ``upon`` are the indices of supports through which another plate rests on this one.
    """
    if discretisation.plates:
        return _of_plates(discretisation, load_of, methods, load, answer, certificate)
    *unsettled, method = methods
    begun = time.perf_counter()
    hi, lo = answer.hi, answer.lo
    nodal = (hi + lo).reshape(-1, 3)
    rotation = discretisation.held.to_global(nodal[:, 1:])
    if stress is None:
        stress, _ = discretisation.plate.stresses(hi, lo, tuple(load.curvature), load.couples)
    forces = SupportForces.of(discretisation, load.nodal, hi, lo, discretisation.point_rows.T @ answer.shared)
    points, springs = discretisation.off_areas
    nodal_reaction = forces.held + discretisation.point_rows.T @ (points * answer.shared)
    nodal_reaction += discretisation.spring_rows.T @ (springs * forces.springs)
    nodes, thickness = discretisation.stress_nodes, discretisation.node_thickness
    fields = np.column_stack([nodes.spread(nodal[:, 0]), nodes.spread(rotation), stress])
    readings = Readings.of(discretisation, [load], [answer], [forces], [fields], [beneath or {}], upon)
    supports = Listed(
        (support_result(readings, index, forces) for index in range(len(discretisation.model.support))), "support"
    )
    model, at, thick = discretisation.model, discretisation.probe_positions, discretisation.probe_thickness
    catalogue = catalogue_of(discretisation, with_extremes(model))
    means = Means.of(discretisation, stress[:, :3], stress[:, 3:], load.acting)
    of_bars = at_faces(means.faces, stress[:, :3], stress[:, :3], nodes.points)
    return Result(
        name=load_of if isinstance(load_of, str) else load_of.name,
        status="solved",
        message="",
        method=method,
        unsettled=tuple(unsettled),
        iterations=answer.pivots if method == "lemke" else answer.iterations,
        not_unique=answer.not_unique,
        mesh=discretisation.mesh,
        model=discretisation.model,
        certificate=certificate,
        deflection=nodal[:, 0],
        rotation=rotation,
        stress_nodes=nodes,
        moment=stress[:, :3],
        shear=stress[:, 3:],
        nodal_reaction=nodal_reaction[::3],
        supports=supports,
        probes=probe_results(at, readings.probes[0], readings.pressures[0], thick, model.bars, readings.of_bars[0]),
        **section_results(discretisation, readings.linear.through[0]),
        seconds=time.perf_counter() - begun,
        warnings=result_warnings(discretisation, load, nodal[:, 0], supports, answer.not_unique, of_bars, means),
        singular=singularities(discretisation, load.acting),
        thickness=thickness,
        catalogue=catalogue,
        _read=overturned(discretisation, catalogue, readings.numbers(catalogue), [load_of])[0],
        combination=None if isinstance(load_of, str) else load_of,
        means=means,
        moment_of_bars=of_bars if model.at_faces else None,
        punching=Listed(column_results(discretisation, readings.punching), "punching"),
    )


def _of_plates(
    discretisation: Discretisation,
    load_of: Combination | str,
    methods: Sequence[str],
    load: CaseLoad,
    answer: Answer,
    certificate: Certificate,
) -> Result:
    """Compute the result of each of several plates, and combine these results."""
    begun, each = time.perf_counter(), discretisation.plates
    deflections = [(answer.hi + answer.lo)[one.dofs][::3] for one in each]
    plates: dict[str, Result] = {}
    for one, own in zip(each, load.plates, strict=True):
        beneath = one.deflections_beneath(np.concatenate(deflections))
        part = answer.on(one), certificate, None
        plates[one.name] = recovered(one.own, load_of, methods, own, *part, beneath, one.upon)

    def in_order(key: str, of: Callable[[Result], Sequence[Any]]) -> Listed[Any]:
        """Results of all plates in the order of table ``key``; a support between plates has that of the upper plate."""
        result: dict[int, Any] = {}
        for one in each:
            for which, value in zip(one.numbers[key], of(plates[one.name]), strict=True):
                between = key == "support" and discretisation.model.support[which].between
                if not between or between[0] == one.name:
                    result[which] = value
        return Listed((result[which] for which in sorted(result)), key)

    nodes = discretisation.stress_nodes
    stress, of_bars = np.empty((nodes.count, 5)), np.empty((nodes.count, 3))
    for one in each:
        of = plates[one.name]
        stress[one.stress_nodes] = np.column_stack([of.moment, of.shear])
        of_bars[one.stress_nodes] = of.moment if of.moment_of_bars is None else of.moment_of_bars
    first, alike = plates[each[0].name], list(plates.values())
    catalogue = catalogue_of(discretisation, with_extremes(discretisation.model))
    return replace(
        first,
        not_unique=answer.not_unique,
        mesh=discretisation.mesh,
        model=discretisation.model,
        deflection=np.concatenate(deflections),
        rotation=np.concatenate([of.rotation for of in alike]),
        stress_nodes=nodes,
        moment=stress[:, :3],
        shear=stress[:, 3:],
        moment_of_bars=of_bars if discretisation.model.at_faces else None,
        nodal_reaction=np.concatenate([of.nodal_reaction for of in alike]),
        supports=in_order("support", lambda of: of.supports),
        probes=tuple(one for of in in_order("probe", _by_table) for one in of),
        sections=in_order("section", lambda of: of.sections),
        strips=in_order("strip", lambda of: of.strips),
        punching=Listed((one for of in in_order("punching", _columns_by_table) for one in of), "punching"),
        seconds=time.perf_counter() - begun,
        warnings=said_of({name: of.warnings for name, of in plates.items()}) + sentences(answer.not_unique),
        singular=singularities(discretisation, load.acting),
        thickness=discretisation.node_thickness,
        catalogue=catalogue,
        _read=overturned(discretisation, catalogue, np.full((1, len(catalogue)), np.nan), [load_of])[0],
        plates=plates,
    )


def _by_table(result: Result) -> list[tuple[ProbeResult, ...]]:
    """Group the probe results of a plate by the tables [[probe]] of its model."""
    ends = np.cumsum([0, *(len(probe.at) for probe in result.model.probe)]).tolist()
    return [result.probes[a:b] for a, b in pairwise(ends)]


def _columns_by_table(result: Result) -> list[tuple[ColumnResult, ...]]:
    """Group the column results of a plate by the tables [[punching]] of its model."""
    tables = [column.column.column.table for column in result.punching]
    every = list(zip(tables, result.punching, strict=True))
    return [tuple(one for at, one in every if at == table) for table in range(len(result.model.punching))]


def unsolved_result(discretisation: Discretisation, combination: Combination, message: str) -> Result:
    """Build the result of a combination without equilibrium, for the reason ``message``; its arrays are NaN."""
    nan = float("nan")
    count, of_stress = discretisation.mesh.node_count, discretisation.stress_nodes.count
    nothing = np.full(count, nan)
    catalogue = catalogue_of(discretisation, with_extremes(discretisation.model))
    return Result(
        name=combination.name,
        status="no_equilibrium",
        message=message,
        method="equilibrium check",
        unsettled=(),
        iterations=0,
        not_unique=(),
        mesh=discretisation.mesh,
        model=discretisation.model,
        certificate=Certificate(nan, nan, nan, nan, nan),
        deflection=nothing,
        rotation=np.full((count, 2), nan),
        stress_nodes=discretisation.stress_nodes,
        moment=np.full((of_stress, 3), nan),
        shear=np.full((of_stress, 2), nan),
        nodal_reaction=nothing,
        supports=Listed((), "support"),
        probes=(),
        sections=Listed((), "section"),
        strips=Listed((), "strip"),
        seconds=0.0,
        warnings=model_warnings(discretisation, combination.acting),
        singular=(),
        thickness=discretisation.node_thickness,
        catalogue=catalogue,
        _read=overturned(discretisation, catalogue, np.full((1, len(catalogue)), nan), [combination])[0],
        combination=combination,
    )
