"""A load path as files: path.json and path.png."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from signorini.errors import InputError
from signorini.files import replacing_together
from signorini.path import Path
from signorini.path_stop import PathStop

PATH_JSON, PATH_PICTURE = "path.json", "path.png"
SCHEMA = 1


def path_json(path: Path) -> dict[str, Any]:
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
    >>> found["ending"], round(found["end"], 9), found["events"]
    ('no_equilibrium', 16.0, [])
    """
    model = path.model
    return {
        "schema": SCHEMA,
        "title": model.title,
        "units": {"length": model.units.length, "force": model.units.force},
        "from": path.start,
        "add": path.add,
        "method": path.problem.method,
        "ending": path.ending,
        "end": path.end,
        "limit": None if np.isinf(path.limit) else path.limit,
        "certificate": {**asdict(path.certificate), "passed": path.certificate.passed},
        "events": [
            {"t": stop.t, "support": switch.support, "at": list(switch.at), "change": switch.change}
            for stop in path.events
            for switch in stop.switched
        ],
        "stops": [_stop(path, stop) for stop in path.stops],
    }


def _stop(path: Path, stop: PathStop) -> dict[str, Any]:
    supports = zip(path.model.support, stop.reactions.tolist(), stop.closed.tolist(), stop.counts.tolist(), strict=True)
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
            {"name": support.name, "reaction": reaction, "closed": closed, "open": count - closed}
            for support, reaction, closed, count in supports
        ],
        "probes": [{"at": at, "deflection": w} for at, w in zip(positions, stop.deflections.tolist(), strict=True)],
    }


def write_path(path: Path, directory: str | os.PathLike[str]) -> None:
    """Write ``path.json`` and ``path.png``, both or none; other files in the directory stay.

    Raises
    ------
    InputError
        If the directory cannot be made or written to.
    """
    # Only this function needs matplotlib.
    from signorini.plot import load_path_picture, save

    model, target = path.model, FilePath(directory)
    t = np.array([stop.t for stop in path.stops])
    positions = path.problem.discretisation.probe_positions.tolist()
    at_probes = np.array([stop.deflections for stop in path.stops])
    curves = {f"at [{x:.6g}, {y:.6g}]": at_probes[:, i] for i, (x, y) in enumerate(positions)}
    if not curves:
        curves = {"largest": np.array([stop.largest for stop in path.stops])}
    parts = np.array([stop.closed / np.maximum(stop.counts, 1) for stop in path.stops[:-1]]).reshape(
        -1, len(model.support)
    )
    figure = load_path_picture(
        t,
        curves,
        {support.name: parts[:, i] for i, support in enumerate(model.support)},
        limit=path.end if path.ending == "no_equilibrium" else None,
        title=", ".join(part for part in (model.title, path.name) if part),
        factor=f"t, the factor of {path.add}",
        length=model.units.length,
    )
    try:
        with replacing_together(target, [PATH_JSON, PATH_PICTURE], seal=PATH_JSON) as beside:
            save(figure, beside / PATH_PICTURE)
            text = json.dumps(path_json(path), indent=1, ensure_ascii=False, allow_nan=False)
            (beside / PATH_JSON).write_text(text + "\n", "utf-8")
    except OSError as error:
        why = error.strerror or str(error)
        raise InputError(f"the path cannot be written there: {why}. Name another directory.", str(target)) from None
