"""What is written of combinations that are rows of a table: their summary, and the envelope over them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import numpy as np

from signorini.analysis.combinations import Combined
from signorini.analysis.solve import Results
from signorini.analysis.twins.compared import Meshes, compared
from signorini.analysis.twins.leaves import with_numbers
from signorini.discretise.rows import Floats
from signorini.formats.vtk import write_vtu
from signorini.mesh import Mesh
from signorini.results.columns import Layout
from signorini.results.envelope import NONE, Extremes
from signorini.results.result import FIELDS
from signorini.results.warnings import model_warnings, too_far
from signorini.singularities.named import singularities

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
    mesh, others = results.discretisation.mesh, dict((mesh, combined) for combined, mesh in results.others)
    own = _envelope(results.combined, mesh)
    plus_minus = None
    if others:
        meshes = Meshes.of(mesh, list(others))
        trees = [own if one is mesh else _envelope(others[one], one) for one in meshes.every]
        numbers, _ = compared(
            trees, meshes, results.model, singularities(results.discretisation), lambda path, value: abs(value)
        )
        plus_minus = with_numbers({key: own[key] for key in ("fields", "supports", "probes")}, numbers)
    return own | {"plus_minus": plus_minus}


def _envelope(combined: Combined, mesh: Mesh) -> dict[str, Any]:
    envelope, layout, nodes = combined.envelope, combined.layout, combined.layout.nodes
    fields = {}
    for name, extremes in envelope.fields.items():
        high, low = envelope.peaks(name)
        fields[name] = {
            **_side(combined, "max", extremes, high),
            "max_at": nodes[high].tolist(),
            **_side(combined, "min", extremes, low),
            "min_at": nodes[low].tolist(),
        }
    for name, (places, extremes) in envelope.pressures.items():
        elastic = name == "contact_pressure"
        at = mesh.points[places] if elastic else mesh.points[mesh.elements[places]].mean(axis=1)
        high, low = int(extremes.largest.argmax()), int(extremes.smallest.argmin())
        fields[name] = {
            **_side(combined, "max", extremes, high),
            "max_at": at[high].tolist(),
            **_side(combined, "min", extremes, low),
            "min_at": at[low].tolist(),
        }
    return {
        "file": ENVELOPE if envelope.fields else None,
        "fields": fields,
        "supports": [_support(combined, index) for index in range(len(layout.supports))],
        "probes": [_probe(combined, layout, index) for index in range(len(layout.probes))],
    }


def write_envelope(results: Results, path: str | os.PathLike[str]) -> None:
    """Write a .vtu file: of every field its extremes, and the numbers of the rows that they come from."""
    found, envelope = results.discretisation, results.envelope
    mesh, nodes = found.mesh, found.stress_nodes
    at_nodes: dict[str, Floats] = {}
    of_elements: dict[str, Floats] = {}
    fields = {name: (np.arange(len(of.largest)), of) for name, of in envelope.fields.items()}
    for name, (places, extremes) in (fields | envelope.pressures).items():
        rigid = name == "rigid_contact_pressure"
        for side, value, by in (
            ("max", extremes.largest, extremes.largest_by),
            ("min", extremes.smallest, extremes.smallest_by),
        ):
            for ending, values, elsewhere in (("", value, 0.0), ("_row", by, NONE)):
                count = len(mesh.elements) if rigid else max(mesh.node_count, len(values))
                data = np.full(count, float(elsewhere))
                data[places] = values
                (of_elements if rigid else at_nodes)[f"{name}_{side}{ending}"] = data
    at_nodes = {name: nodes.spread(data) for name, data in at_nodes.items()}
    write_vtu(path, found.stress_points, nodes.elements, at_nodes, of_elements)


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
    elif asked.area is not None or (len(points.positions) and not len(points.nodes)):
        area = asked.area is not None
        per = support.pressure.largest if area else support.points.largest / points.weights
        by = support.pressure.largest_by if area else support.points.largest_by
        places = support.places if area else points.positions
        at = int(per.argmax())
        out["largest"] = {
            "per": "area" if area else "length",
            "max": float(per[at]),
            "max_by": combined.name(int(by[at])),
            "max_at": places[at].tolist(),
        }
    return out


def _probe(combined: Combined, layout: Layout, index: int) -> dict[str, Any]:
    first = index * len(FIELDS)
    values = {name: _both(combined, combined.envelope.probes, first + i) for i, name in enumerate(FIELDS)}
    return {"at": layout.probes[index].tolist(), **values}
