"""What is written of combinations that are rows of a table: their summary, and the envelope over them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from signorini.analysis.combinations import Combined
from signorini.analysis.solve import Results
from signorini.analysis.tables import rows_named
from signorini.analysis.twins.compared import Meshes, compared, rounded
from signorini.analysis.twins.leaves import Path, leaves, with_numbers
from signorini.discretise.rows import Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.formats.vtk import write_vtu
from signorini.mesh import Mesh
from signorini.output.names import TABLE, envelope_file
from signorini.results.columns import Layout
from signorini.results.envelope import NONE, Envelope, Extremes
from signorini.results.result import FIELDS
from signorini.results.section_result import COMPONENTS
from signorini.results.warnings import idle_cases, model_warnings, too_far
from signorini.singularities.named import singularities

_AT_NODES = ("reaction", "contact_pressure", "rigid_contact_pressure")
"""Fields of which rows have no extremes."""
_ESTIMATED = ("fields", "supports", "probes", "sections", "strips")

Name = Callable[[int], str]
"""Tells the name of a combination, given its number."""


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
    yield from idle_cases(results.model)
    extremes = results.envelope.fields.get("deflection")
    if extremes is not None:
        down = extremes.largest >= -extremes.smallest
        yield from too_far(results.discretisation, np.where(down, extremes.largest, extremes.smallest))
    if results.no_others:
        yield results.no_others


def envelope_json(results: Results, group: str = "") -> dict[str, Any] | None:
    """Give the key "envelope" of results.json, or that of a group; None where no combination of it was solved."""
    mesh, found = results.discretisation.mesh, {results.discretisation.mesh: results.combined}
    found |= {other: combined for combined, other in results.others}
    trees = {one: _envelope(results, combined, one, group) for one, combined in found.items()}
    own, plus_minus = trees[mesh], None
    if own is None:
        return None
    told = [one for one, tree in trees.items() if tree is not None and one is not mesh]
    if told:
        meshes = Meshes.of(mesh, told, bool(results.no_others))
        every = [_without_rows(tree) for one in meshes.every if (tree := trees[one]) is not None]
        named = [(singularities(results.discretisation), np.ones(1, np.bool_))]
        widths, _ = compared(every, meshes, results.model, own, named)
        numbers = {path: rounded(width) for path, (width,) in zip(every[meshes.own], widths.tolist(), strict=True)}
        for path, column, row in rows_named(results.combined.layout, results.combined.over(group)):
            numbers[path] = results.half_width(column, row)
        plus_minus = with_numbers({key: own[key] for key in _ESTIMATED}, numbers)
    return own | {"plus_minus": plus_minus}


def _without_rows(tree: Mapping[str, Any]) -> dict[Path, Floats]:
    """The numbers of an envelope that are no row's: pressures and nodal reactions over all nodes and points."""
    found = {path: np.array([value]) for path, value in leaves(tree).items()}
    return {path: value for path, value in found.items() if path[1] in _AT_NODES or "largest" in path}


def _envelope(results: Results, combined: Combined, mesh: Mesh, group: str) -> dict[str, Any] | None:
    """Give extremes as found on some mesh."""
    if group and group not in combined.groups:
        return None
    envelope, name = combined.over(group), results.key
    fields = {}
    peaks = envelope.peaks
    for at, field in enumerate(envelope.names):
        fields[field] = _ends(name, peaks.extremes, (peaks.largest_at, peaks.smallest_at), at, at)
    over = {"reaction": (mesh.points, envelope.fields["reaction"])} if "reaction" in envelope.fields else {}
    for field, (places, extremes) in envelope.pressures.items():
        elastic = field == "contact_pressure"
        over[field] = (mesh.points[places] if elastic else mesh.points[mesh.elements[places]].mean(axis=1)), extremes
    for field, (points, extremes) in over.items():
        fields[field] = _ends(name, extremes, (points, points), *extremes.ends)
    layout = combined.layout
    return {
        "file": envelope_file(results, group),
        "fields": fields,
        "supports": [_support(name, envelope, layout, index) for index in range(len(layout.supports))],
        "probes": [_probe(name, envelope, layout, index) for index in range(len(layout.probes))],
        **_through(name, envelope, layout),
    }


def write_envelope(nodes: StressNodes, envelope: Envelope, path: str | os.PathLike[str]) -> None:
    """Write a .vtu file: of every field its extremes, and the numbers of the rows that they come from."""
    mesh = nodes.mesh
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
    write_vtu(path, nodes.points, nodes.elements, at_nodes, of_elements)


def _ends(name: Name, extremes: Extremes, places: tuple[Floats, Floats], high: int, low: int) -> dict[str, Any]:
    return {
        **_side(name, "max", extremes, high),
        "max_at": places[0][high].tolist(),
        **_side(name, "min", extremes, low),
        "min_at": places[1][low].tolist(),
    }


def _side(name: Name, side: str, extremes: Extremes, at: int) -> dict[str, Any]:
    largest = side == "max"
    value = (extremes.largest if largest else extremes.smallest)[at]
    by = (extremes.largest_by if largest else extremes.smallest_by)[at]
    return {side: float(value), f"{side}_by": name(int(by))}


def _both(name: Name, extremes: Extremes, at: int) -> dict[str, Any]:
    return {**_side(name, "max", extremes, at), **_side(name, "min", extremes, at)}


def _support(name: Name, envelope: Envelope, layout: Layout, index: int) -> dict[str, Any]:
    support, points = envelope.supports[index], layout.supports[index]
    asked = layout.model.support[index]
    out: dict[str, Any] = {
        "name": asked.name,
        "reaction": _both(name, support.reaction, 0),
        "lifted": int((support.lifted > 0).sum()),
    }
    if support.pressed is not None:
        out |= {
            "max_pressure": _both(name, support.pressed, 0),
            "contact_area": _both(name, support.pressed, 1),
        }
    if asked.place == "at":
        out["points"] = [
            {
                "at": points.positions[p].tolist(),
                "reaction": _both(name, support.points, p),
                "gap": _side(name, "max", support.gap, p) if support.lifted[p] else None,
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
            "max_by": name(int(by[at])),
            "max_at": places[at].tolist(),
        }
    return out


def _probe(name: Name, envelope: Envelope, layout: Layout, index: int) -> dict[str, Any]:
    first = index * len(FIELDS)
    values = {field: _both(name, envelope.probes, first + i) for i, field in enumerate(FIELDS)}
    return {"at": layout.probes[index].tolist(), **values}


def _through(name: Name, envelope: Envelope, layout: Layout) -> dict[str, Any]:
    """Extremes of sections and strips."""
    lines = iter(range(0, len(layout.through), len(COMPONENTS)))

    def line() -> dict[str, Any]:
        first = next(lines)
        return {of: _both(name, envelope.through, first + i) for i, of in enumerate(COMPONENTS)}

    sections = [{"name": section.name, **line()} for section in layout.model.section]
    strips = [
        {"name": strip.name, "stations": [{"at": at, **line()} for at in strip.places[0].tolist()]}
        for strip in layout.model.strip
    ]
    return {"sections": sections, "strips": strips}
