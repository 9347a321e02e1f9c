"""A load path as files: path.json, path.csv and path.png."""

from __future__ import annotations

import csv
import io
import itertools
import json
import os
from collections.abc import Iterator
from dataclasses import asdict
from functools import partial
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from signorini.base.files import replacing_together
from signorini.output.cells import name_cell
from signorini.output.directory import cannot_write, former_path
from signorini.output.names import PATH_CSV, PATH_JSON, PATH_PICTURE
from signorini.output.tables import snapped_json
from signorini.results.estimate import PathEstimate
from signorini.results.figures import through_json
from signorini.results.load_path import LoadPath
from signorini.results.path_stop import PathStop, listed_points
from signorini.results.section_result import columns_of, section_results

SCHEMA = 1


def path_json(path: LoadPath) -> dict[str, Any]:
    """Give a load path in the form of ``path.json``; docs/results.md describes every key.

    Examples
    --------
    >>> import signorini
    >>> model = signorini.Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     mesh={"divisions": [4, 4]},
    ...     support=[{"name": "feet", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}],
    ...     load=[{"case": "G", "pressure": 1e3}, {"case": "Q", "force": 1e3, "at": [4, 2]}],
    ... )
    >>> found = path_json(signorini.path(model, start="G", add="Q"))
    >>> found["ending"], round(found["end"], 3), found["events"]
    ('no_equilibrium', 16.0, [])
    """
    model, estimate = path.model, path.asked_estimate
    return {
        "schema": SCHEMA,
        "title": model.title,
        "units": {"length": model.units.length, "force": model.units.force},
        "snapped": snapped_json(path.problem.discretisation.snapped),
        "from": path.start,
        "add": path.add,
        "method": path.method,
        "ending": path.ending,
        "end": path.end,
        "limit": None if np.isinf(path.limit) else path.limit,
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
    """Half-widths of the end and of every named event's t; the limit is of the supports' outlines, and has none."""
    return {
        "end": estimate.end,
        "events": [],
        "support_events": [
            {"t": width, "support": event.support, "at": None, "change": event.change, "closed": None}
            for event, width in zip(path.support_events, estimate.events, strict=True)
        ],
    }


def _stop(path: LoadPath, stop: PathStop) -> dict[str, Any]:
    supports = zip(path.model.support, *_columns(stop), strict=True)
    points: list[list[dict[str, Any]]] = [[] for _ in path.model.support]
    for one, reaction in zip(listed_points(path.problem.discretisation), stop.at_points.tolist(), strict=True):
        points[one.support].append({"at": list(one.at or ()), "reaction": reaction})
    positions = path.problem.discretisation.probe_positions.tolist()
    return {
        "t": stop.t,
        "deflection": {
            "max": stop.largest,
            "max_at": list(stop.largest_at),
            "min": stop.smallest,
            "min_at": list(stop.smallest_at),
        },
        "supports": [
            {"name": support.name} | dict(zip(_OF_SUPPORTS, values, strict=True)) | ({"points": of} if of else {})
            for of, (support, *values) in zip(points, supports, strict=True)
        ],
        "probes": [{"at": at, "deflection": w} for at, w in zip(positions, stop.deflections.tolist(), strict=True)],
        **through_json(*section_results(path.problem.discretisation, stop.through)),
    }


_OF_SUPPORTS = ("reaction", "closed", "open", "closed_part", "contact_area", "max_pressure")


def _columns(stop: PathStop) -> Iterator[list[Any]]:
    """What is said of supports at a stop, each a list (s,); None where a support has no such number."""
    numbers = (stop.reactions, stop.closed, stop.counts - stop.closed, stop.parts)
    yield from (values.tolist() for values in numbers)
    for values in (stop.contact_areas, stop.max_pressures):
        yield [None if np.isnan(value) else value for value in values.tolist()]


def path_csv(path: LoadPath) -> str:
    """Give the stops of a load path as comma-separated values: a row a stop, columns for supports and probes."""
    text = io.StringIO()
    names = [support.name for support in path.model.support]
    positions = path.problem.discretisation.probe_positions.tolist()
    table = csv.writer(text, lineterminator="\n")
    estimate = path.asked_estimate
    table.writerow(
        ["t", "t_plus_minus", "event", "deflection_max", "deflection_min"]
        + [f"{what}:{name}" for name in names for what in _OF_SUPPORTS]
        + [one.column(path.model) for one in listed_points(path.problem.discretisation)]
        + [f"probe[{i}]:deflection" for i in range(1, len(positions) + 1)]
        + columns_of(path.model)
    )
    for index, stop in enumerate(path.stops):
        supports = zip(*_columns(stop), strict=True)
        row = [
            stop.t,
            None if estimate is None else path.half_width(index),
            name_cell(path.words(index)),
            stop.largest,
            stop.smallest,
            *itertools.chain.from_iterable(supports),
        ]
        table.writerow([*row, *stop.at_points.tolist(), *stop.deflections.tolist(), *stop.through.tolist()])
    return text.getvalue()


def write_path(path: LoadPath, directory: str | os.PathLike[str]) -> list[FilePath]:
    """Write ``path.json``, ``path.csv`` and ``path.png``, all or none; other files in the directory stay.

    Those of an earlier path there are replaced.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    InputError
        If the directory cannot be made or written to, or has files of these names that no earlier path wrote.
    """
    # Only this function needs matplotlib.
    from signorini.plot import save

    target = FilePath(directory)
    figure = path.plot()
    try:
        with replacing_together(target, partial(former_path, target), seal=PATH_JSON) as beside:
            save(figure, beside / PATH_PICTURE)
            (beside / PATH_CSV).write_text(path_csv(path), "utf-8")
            text = json.dumps(path_json(path), indent=1, ensure_ascii=False, allow_nan=False)
            (beside / PATH_JSON).write_text(text + "\n", "utf-8")
    except OSError as error:
        raise cannot_write(target, error) from None
    return [target / name for name in (PATH_JSON, PATH_CSV, PATH_PICTURE)]
