"""Results as ``results.json`` and ``reactions.csv``."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.discretise.snapping import Snapped
from signorini.output.checks import checks_json
from signorini.output.envelope_json import envelope_json, table_json
from signorini.output.governing import governing_json
from signorini.output.names import Pictures, csv_text, files, name_cell
from signorini.output.warnings import warnings_of
from signorini.results.figures import figures, joints, point_figures, total
from signorini.results.line_reactions import LineReactions
from signorini.results.result import Result
from signorini.results.sensitivity import Sensitivity
from signorini.results.support_result import SupportResult
from signorini.singularities.singularity import Singularity

SCHEMA = 2
_COLUMNS = (
    *("combination", "support", "kind", "point", "x", "y", "reaction", "gap", "state"),
    *("closed", "open", "contact_area", "max_pressure"),
    *("reaction_plus_minus", "gap_plus_minus", "contact_area_plus_minus", "max_pressure_plus_minus"),
    *("max_tension", "node", "preload", "change", "tightened_to"),
    *("s", "reaction_per_length", "corner_reaction", "max_per_length", "min_per_length"),
    *("corner_reaction_plus_minus", "max_per_length_plus_minus", "min_per_length_plus_minus"),
)
_MOST_PLACES = 20
"""Largest number of points of a singularity that results.json lists: where borders of zones cut elements, there may be
thousands of singular points.
"""
_ESTIMATED = ("reaction", "gap", "contact_area", "max_pressure", "max_per_length", "min_per_length")


def results_json(
    results: Results,
    estimates: Estimates | None = None,
    pictures: Pictures = None,
    xlsx: bool = False,
    ranks: int = 0,
) -> dict[str, Any]:
    """Return the results in the form of ``results.json``; docs/results.md describes every key.

    A combination without equilibrium has no numbers: its lists are empty, its tables are None, and ``message`` gives
    the reason. No number is NaN or infinite. ``ranks`` is the number of processes of the engine petsc, or 0.
    """
    discretisation = results.discretisation
    of_table: dict[str, Any] = {}
    if discretisation.model.tabulated:
        of_table = {"table": table_json(results, estimates), "envelope": envelope_json(results, estimates)}
    options = {"pictures": pictures, "xlsx": xlsx, **({"engine": "petsc", "ranks": ranks} if ranks else {})}
    return {
        "schema": SCHEMA,
        **results.model.provenance.json(options | _asked(results)),
        "title": discretisation.model.title,
        "units": {"length": discretisation.model.units.length, "force": discretisation.model.units.force},
        "model": {
            "nodes": discretisation.mesh.node_count,
            "elements": len(discretisation.mesh.elements),
            "dofs": discretisation.dof_count,
            "contact_points": int((~discretisation.points.two_sided).sum()),
        },
        "snapped": snapped_json(discretisation.snapped),
        "combinations": [_combination(results, result, estimates) for result in results.full.values()],
        "warnings": [{"text": text, "combinations": of} for text, of in warnings_of(results, estimates).items()],
        **({"checks": checks_json(results, estimates)} if results.model.check else {}),
        "governing_reactions": governing_json(results, estimates),
        "groups": [
            _group(results, estimates, *group) for group in discretisation.model.effective_combinations.groups.items()
        ],
        **({"sensitivities": [_sensitivity(one) for one in results.sensitivities]} if results.sensitivities else {}),
        **of_table,
        **({"refinement": [asdict(step) for step in results.refinement]} if results.refinement else {}),
        "seconds": {name: float(spent) for name, spent in results.seconds.items()},
        "files": files(results, pictures, xlsx, ranks),
    }


def reactions_csv(results: Results, estimates: Estimates | None = None) -> str:
    """Return the reactions as comma-separated values.

    Each combination and support has a row with the ``point`` "total". Each point or node of points, edges and lines
    also has a row, with the reaction per length on edges and lines. Names that a spreadsheet would compute begin with
    an apostrophe.
    """
    told = ((one, None if estimates is None else estimates[one.name].plus_minus) for one in results.full.values())
    return csv_text(_COLUMNS, (row for one, plus_minus in told for row in _rows(one, plus_minus)))


def _asked(results: Results) -> dict[str, Any]:
    """Options of the run besides the model: names of sensitivities; the combination if only one result is written."""
    model, names = results.model, [one.name for one in results.sensitivities]
    asked: dict[str, Any] = {"sensitivity": names} if names else {}
    if model.combination != model.original.combination:
        asked["combination"] = model.combination[0].model_dump(include={"name", "group", "factors"})
    return asked


def _sensitivity(of: Sensitivity) -> dict[str, Any]:
    """Return an entry of the key "sensitivities"; missing numbers and infinite ends are None."""

    def finite(value: float) -> float | None:
        return value if math.isfinite(value) else None

    return {
        "name": of.name,
        "combination": of.combination,
        "value": finite(of.value),
        "unit": of.unit,
        "parameters": [
            {
                **{"path": one.path, "value": one.value, "unit": one.unit, "derivative": finite(one.derivative)},
                **{"derivative_unit": one.derivative_unit},
                **{"elasticity": finite(one.elasticity), "valid": [finite(end) for end in one.valid], "why": one.why},
            }
            for one in of.derivatives
        ],
    }


def _combination(results: Results, result: Result, estimates: Estimates | None) -> dict[str, Any]:
    estimate = None if estimates is None else estimates[result.name]
    solved, limit = result.status == "solved", results.limits[result.name]
    accuracy = [results.accuracy_warning] * bool(results.accuracy_warning)
    return {
        "name": result.name,
        "status": result.status,
        "message": result.message,
        "limit": None if limit is None else {"case": limit[0], "factor": limit[1]},
        "method": result.method,
        "unsettled": list(result.unsettled),
        "iterations": result.iterations,
        "not_unique": [asdict(one) | {"supports": list(one.supports)} for one in result.not_unique],
        "warnings": [*result.warnings, *(() if estimate is None else estimate.warnings), *accuracy],
        "singular": singular_json(result.singular, result),
        "certificate": {**asdict(result.certificate), "passed": result.certificate.passed} if solved else None,
        **figures(result),
        **({"joints": of_bolts} if (of_bolts := joints(result)) else {}),
        "profiles": [{"name": one.name, "stations": list(one.rows())} for one in result.profiles.values()],
        "plus_minus": None if estimate is None else estimate.plus_minus,
    }


def _group(results: Results, estimates: Estimates | None, name: str, combinations: int) -> dict[str, Any]:
    governing = governing_json(results, estimates, name)
    result = {"name": name, "combinations": combinations, "governing_reactions": governing}
    return result | ({"envelope": envelope_json(results, estimates, name)} if results.model.tabulated else {})


def snapped_json(snapped: Iterable[Snapped]) -> list[dict[str, Any]]:
    """Return the value of the key "snapped": each moved object, and its positions before and after."""
    return [{"what": one.what, "from": list(one.begin), "to": list(one.end), "onto": one.onto} for one in snapped]


def singular_json(named: Iterable[Singularity], result: Result) -> list[dict[str, Any]]:
    """Return the value of the key "singular" of a combination: its singularities."""
    return [
        {
            "where": [list(at) for at in (one.where if one.line else one.where[:_MOST_PLACES])],
            "count": len(one.where),
            "box": [*np.min(one.where, axis=0).tolist(), *np.max(one.where, axis=0).tolist()] if one.where else None,
            "line": one.line,
            "limited": one.limited,
            "within": one.within,
            "what": one.what,
            "numbers": list(one.numbers),
            "source": one.source,
            "advice": one.advice,
            "means": list(_means(one, result.plates.get(one.plate, result))),
            **({"plate": one.plate} if one.plate else {}),
        }
        for one in named
    ]


def _means(one: Singularity, result: Result) -> Iterator[dict[str, Any]]:
    """Yield the means at the listed points of a singularity; lines, and results with a limit, have no means."""
    by_place = {} if one.line or one.limited or result.means is None else result.means.by_place
    for at in one.where[:_MOST_PLACES]:
        if (mean := by_place.get(at)) is not None:
            yield {"at": list(at)} | {name: None if math.isnan(value) else value for name, value in mean.items()}


def _rows(result: Result, plus_minus: Mapping[str, Any] | None) -> Iterator[dict[str, Any]]:
    if result.status != "solved":
        for asked in result.model.support:
            names = {"combination": name_cell(result.name), "support": name_cell(asked.name)}
            yield names | {"point": "total", "state": result.status}
    told = plus_minus or {"supports": [{}] * len(result.supports)}
    widths = [*told["supports"], *told.get("contacts", ())]
    for support, width in zip(result.supports, widths, strict=True):
        names = {"combination": name_cell(result.name), "support": name_cell(support.name)}
        row = names | {"kind": support.kind}
        bolts = {} if support.preloads is None else {"preload": support.preload}
        yield row | {"point": "total"} | total(support) | bolts | _half_widths(width)
        if support.area is None:
            along = None if support.line is None else _along(support, support.line, width)
            nodes = result.mesh.nodes_at(support.positions).tolist()
            for number, (point, node) in enumerate(zip(point_figures(support), nodes, strict=True), start=1):
                x, y = point.pop("at")
                at_point = width["points"][number - 1] if "points" in width else {}
                place = {"point": number, "x": x, "y": y, "node": node + 1 if node >= 0 else None}
                place |= {name: float(values[number - 1]) for name, values in support.bolt_forces.items()}
                place |= {} if along is None else along[number - 1]
                yield row | place | point | _half_widths(at_point)


def _along(support: SupportResult, line: LineReactions, widths: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return for each point of a line its arc length s, reaction per length and, at corners, concentrated force."""
    per_length = np.interp(line.points_s, line.s, line.reactions)
    pairs = zip(line.points_s.tolist(), per_length.tolist(), strict=True)
    points: list[dict[str, Any]] = [{"s": s, "reaction_per_length": value} for s, value in pairs]
    for number, (corner, force) in enumerate(zip(line.corners, line.corner_reactions.tolist(), strict=True)):
        nearest = points[int(np.hypot(*(support.positions - corner).T).argmin())]
        nearest["corner_reaction"] = nearest.get("corner_reaction", 0.0) + force
        if "corners" in widths:
            nearest["corner_reaction_plus_minus"] = widths["corners"][number]["reaction"]
    return points


def _half_widths(widths: Mapping[str, Any]) -> dict[str, Any]:
    return {f"{name}_plus_minus": widths[name] for name in _ESTIMATED if name in widths}
