"""Write a load path as files: path.json, path.csv and path.png."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from signorini.accuracy.comparison import PathEstimate
from signorini.base.files import replacing_together
from signorini.output.directory import cannot_write, former_path
from signorini.output.names import PATH_CSV, PATH_JSON, PATH_PICTURE, csv_text, name_cell
from signorini.output.tables import snapped_json
from signorini.results.figures import check_names, columns_named, line_places, put
from signorini.results.load_path import LoadPath
from signorini.results.local_results import section_results
from signorini.results.path_stop import PathStop
from signorini.results.quantities import EXTREMES, OF_AREAS, OF_RESULTANTS, OF_SUPPORTS, Number
from signorini.results.support_points import SupportPoints

SCHEMA = 1


def path_json(path: LoadPath, estimate: PathEstimate | None = None) -> dict[str, Any]:
    """Return a load path in the form of ``path.json``; docs/results.md describes every key."""
    model = path.model
    return {
        "schema": SCHEMA,
        **model.provenance.json(path.options),
        "title": model.title,
        "units": {"length": model.units.length, "force": model.units.force},
        "snapped": snapped_json(path.problem.discretisation.snapped),
        "from": path.start,
        "add": path.add,
        "method": path.method,
        "ending": path.ending,
        "end": path.end,
        "limit": None if np.isinf(path.limit) else path.limit,
        "mechanism": path.mechanism or None,
        "certificate": {**asdict(path.certificate), "passed": path.certificate.passed},
        "not_unique": [{"begin": begin, "end": end, **asdict(one)} for begin, end, one in path.not_unique],
        "events": [
            {"t": stop.t, "support": switch.support, "at": list(switch.at), "change": switch.change}
            for stop in path.events
            for switch in stop.switched
        ],
        "support_events": [
            {
                "t": event.t,
                "support": event.support,
                "at": None if event.at is None else list(event.at),
                "change": event.change,
                "closed": event.closed,
            }
            for event in path.support_events
        ],
        "thresholds": [
            {"when": one.when, "t": one.t, "plus_minus": width}
            for one, width in zip(
                path.thresholds, estimate.thresholds if estimate else (None,) * len(path.thresholds), strict=True
            )
        ],
        "interrupted": path.interrupted,
        "stops": [_stop(path, stop) for stop in path.stops],
        "warnings": [*path.warnings, *(estimate.warnings if estimate else ())],
        "plus_minus": None if estimate is None else _half_widths(path, estimate),
    }


def _half_widths(path: LoadPath, estimate: PathEstimate) -> dict[str, Any]:
    """Half-widths of the t at which the path ends, and of the t of every named event."""
    return {
        "end": estimate.end,
        "events": [],
        "support_events": [
            {"t": width, "support": event.support, "at": None, "change": event.change, "closed": None}
            for event, width in zip(path.support_events, estimate.events, strict=True)
        ],
    }


def _stop(path: LoadPath, stop: PathStop) -> dict[str, Any]:
    discretisation, model = path.discretisation, path.model
    supports: list[dict[str, Any]] = [
        {"name": support.name, "contact_area": None, "max_pressure": None} for support in model.support
    ]
    first = len(supports) - len(model.contact)
    tree: dict[str, Any] = {
        "t": stop.t,
        "deflection": {"max_at": list(stop.largest_at), "min_at": list(stop.smallest_at)},
        "supports": supports[:first],
        **({"contacts": supports[first:]} if model.plates else {}),
        "probes": [{"at": list(at)} for probe in model.probe for at in probe.at],
        **line_places(**section_results(discretisation, stop.through)),
        **({"punching": named} if (named := columns_named(model)) else {}),
        **check_names(model.check),
    }
    for one in stop.catalogue:
        if one.home == "point" and one.what == "reaction":
            at = SupportPoints.of(discretisation, one.owner).positions[one.part].tolist()
            supports[one.owner].setdefault("points", []).append({"at": at})
    return put(tree, stop.catalogue, stop.values)


def path_csv(path: LoadPath, estimate: PathEstimate | None = None) -> str:
    """Return the stops of a load path as comma-separated values: a row for each stop, a column for each number.

    Every support has the columns of areas; for points and lines these cells are empty.
    """
    numbers = {one.column: one for one in path.stops[0].catalogue}
    of_supports = [one.name for one in (*OF_SUPPORTS, *OF_AREAS, *OF_RESULTANTS) if one.along_paths]
    columns = [f"{what}:{support.name}" for support in path.model.support for what in of_supports]
    columns += [of for of, one in numbers.items() if one.home not in ("support", *EXTREMES) and one.what != "gap"]
    rows = []
    for index, stop in enumerate(path.stops):
        width = None if estimate is None else estimate.half_width(path, index)
        row = [stop.t, width, name_cell(path.words(index)), stop.largest, stop.smallest]
        rows.append([*row, *(_cell(stop, numbers.get(of)) for of in columns)])
    return csv_text(["t", "t_plus_minus", "event", "deflection_max", "deflection_min", *columns], rows)


def _cell(stop: PathStop, one: Number | None) -> float | None:
    if one is None:
        return None
    value = stop.number(one.name)
    return None if np.isnan(value) else int(value) if one.quantity.kind == "count" else value


def write_path(
    path: LoadPath, directory: str | os.PathLike[str], estimate: PathEstimate | None = None
) -> list[FilePath]:
    """Write ``path.json``, ``path.csv`` and ``path.png``: all files or none; other files in the directory are kept.

    Files of an earlier path are replaced. If another program wrote files with these names, they are not overwritten:
    `InputError` is raised.
    """
    # matplotlib is imported only when a picture is drawn.
    from signorini.plot.files import save

    target = FilePath(directory)
    figure = path.plot()
    try:
        with replacing_together(target, former_path, PATH_JSON, path.model.provenance.read) as beside:
            save(figure, beside / PATH_PICTURE, path.model.provenance.metadata)
            (beside / PATH_CSV).write_text(path_csv(path, estimate), "utf-8")
            text = json.dumps(path_json(path, estimate), indent=1, ensure_ascii=False, allow_nan=False)
            (beside / PATH_JSON).write_text(text + "\n", "utf-8")
    except OSError as error:
        raise cannot_write(target, error) from None
    return [target / name for name in (PATH_JSON, PATH_CSV, PATH_PICTURE)]
