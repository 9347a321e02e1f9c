"""What is written of combinations that are rows of a table: their summary, and the envelope over them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import numpy as np

from signorini.analysis.combinations import Combined
from signorini.analysis.solve import Results
from signorini.discretise.rows import Floats
from signorini.formats.vtk import write_vtu
from signorini.results.columns import Layout
from signorini.results.envelope import Extremes
from signorini.results.result import FIELDS
from signorini.results.warnings import model_warnings, too_far

TABLE, ENVELOPE = "combinations.parquet", "envelope.vtu"


def table_json(results: Results) -> dict[str, Any]:
    """Give the key "table" of results.json."""
    combined = results.combined
    return {
        "file": TABLE,
        "combinations": len(combined.combinations),
        "solved": combined.solved,
        "no_equilibrium": len(combined.combinations) - combined.solved,
        "solved_alone": combined.alone,
        "not_unique": combined.not_unique,
        "governing": list(results.governing),
        "certificate": {**combined.certificate, "passed": True},
        "warnings": list(table_warnings(results)),
        "unbalanced": [{"name": name, "message": message} for name, message in combined.unbalanced.items()],
    }


def table_warnings(results: Results) -> Iterator[str]:
    """Say what of the model, and of the largest deflections where these are enveloped, is seldom meant."""
    yield from model_warnings(results.discretisation)
    extremes = results.envelope.fields.get("deflection")
    if extremes is not None:
        down = extremes.largest >= -extremes.smallest
        yield from too_far(results.discretisation, np.where(down, extremes.largest, extremes.smallest))


def envelope_json(results: Results) -> dict[str, Any]:
    """Give the key "envelope" of results.json."""
    found, combined = results.discretisation, results.combined
    envelope, layout = combined.envelope, combined.layout
    fields = {}
    for name, extremes in envelope.fields.items():
        high, low = int(extremes.largest.argmax()), int(extremes.smallest.argmin())
        fields[name] = {
            **_side(combined, "max", extremes, high),
            "max_at": found.mesh.points[high].tolist(),
            **_side(combined, "min", extremes, low),
            "min_at": found.mesh.points[low].tolist(),
        }
    return {
        "file": ENVELOPE if envelope.fields else None,
        "fields": fields,
        "supports": [_support(combined, index) for index in range(len(layout.supports))],
        "probes": [_probe(combined, layout, index) for index in range(len(layout.probes))],
    }


def write_envelope(results: Results, path: str | os.PathLike[str]) -> None:
    """Write a .vtu file: of every field its extremes at the nodes, and the numbers of the rows that they come from."""
    data: dict[str, Floats] = {}
    for name, extremes in results.envelope.fields.items():
        data[f"{name}_max"], data[f"{name}_min"] = extremes.largest, extremes.smallest
        data[f"{name}_max_row"] = extremes.largest_by.astype(np.float64)
        data[f"{name}_min_row"] = extremes.smallest_by.astype(np.float64)
    mesh = results.discretisation.mesh
    write_vtu(path, mesh.points, mesh.elements, data)


def _side(combined: Combined, side: str, extremes: Extremes, at: int) -> dict[str, Any]:
    largest = side == "max"
    value = (extremes.largest if largest else extremes.smallest)[at]
    by = (extremes.largest_by if largest else extremes.smallest_by)[at]
    return {side: float(value), f"{side}_by": combined.name(int(by))}


def _both(combined: Combined, extremes: Extremes, at: int) -> dict[str, Any]:
    return {**_side(combined, "max", extremes, at), **_side(combined, "min", extremes, at)}


def _support(combined: Combined, index: int) -> dict[str, Any]:
    support, points = combined.envelope.supports[index], combined.layout.supports[index]
    asked = combined.layout.model.support[index]
    out: dict[str, Any] = {
        "name": asked.name,
        "reaction": _both(combined, support.reaction, 0),
        "lifted": int((support.lifted > 0).sum()),
    }
    if support.pressed is not None:
        out |= {
            "max_pressure": _both(combined, support.pressed, 0),
            "contact_area": _both(combined, support.pressed, 1),
        }
    if asked.place == "at":
        out["points"] = [
            {
                "at": points.positions[p].tolist(),
                "reaction": _both(combined, support.points, p),
                "gap": _side(combined, "max", support.gap, p) if support.lifted[p] else None,
                "lifted_in": int(support.lifted[p]),
            }
            for p in range(len(points.positions))
        ]
    elif len(points.positions) and not len(points.nodes):
        pressure = support.points.largest / points.weights
        at = int(pressure.argmax())
        name = combined.name(int(support.points.largest_by[at]))
        out["largest"] = {"per": "area" if asked.area is not None else "length", "max": float(pressure[at])} | {
            "max_by": name,
            "max_at": points.positions[at].tolist(),
        }
    return out


def _probe(combined: Combined, layout: Layout, index: int) -> dict[str, Any]:
    first = index * len(FIELDS)
    values = {name: _both(combined, combined.envelope.probes, first + i) for i, name in enumerate(FIELDS)}
    return {"at": layout.probes[index].tolist(), **values}
