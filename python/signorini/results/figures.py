"""Numbers of one combination in results.json: deflection, fields, supports, probes, sections, strips."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from signorini.discretise.rows import Floats
from signorini.model import Check, Model
from signorini.results.extremes import least_at
from signorini.results.local_results import ProbeResult, SectionResult, StripResult
from signorini.results.quantities import (
    MEAN_SIDES,
    OF_AREAS,
    OF_LINES,
    PEAKING,
    REINFORCEMENT,
    SIDES,
    Catalogue,
    Path,
)
from signorini.results.result import Result
from signorini.results.support_result import SupportResult


def figures(result: Result) -> dict[str, Any]:
    """Return those parts of a combination's JSON that have numbers of the result, such as "fields" and "supports"."""
    solved = result.status == "solved"
    ends = _all_places(result) if solved else {}
    deflection = ends.pop("deflection", None)
    first = len(result.supports) - len(result.model.contact)
    values: dict[str, Any] = {
        "deflection": deflection and {key: deflection[key] for key in ("max_at", "min_at")},
        "fields": ends,
        "supports": [_support(support) for support in result.supports[:first]],
        "probes": [_probe(probe) for probe in result.probes],
        **line_places(result.sections, result.strips),
        **({"punching": [column.figures() for column in result.punching]} if result.punching else {}),
        **check_names(result.model.check),
    }
    if result.model.plates:
        values["contacts"] = [_support(support) for support in result.supports[first:]]
        values["plates"] = {name: _of_plate(one) for name, one in result.plates.items()}
    return put(values, result.catalogue, result.numbers) if solved else values


def _of_plate(result: Result) -> dict[str, Any]:
    """JSON of one of several plates, with the positions of its extremes; `put` writes the extremes themselves."""
    ends = _all_places(result)
    return {"deflection": ends.pop("deflection"), "fields": ends}


def put(tree: dict[str, Any], catalogue: Catalogue, values: Floats) -> dict[str, Any]:
    """Write the numbers (n,) of a catalogue at their JSON paths into a tree of dicts and lists; None if not finite."""
    for one, value in zip(catalogue, values.tolist(), strict=True):
        shown = None if not np.isfinite(value) else int(value) if one.quantity.kind == "count" else value
        at: Any = tree
        for key, after in zip(one.path, one.path[1:], strict=False):
            at = at.setdefault(key, [] if isinstance(after, int) else {}) if isinstance(key, str) else at[key]
        if isinstance(last := one.path[-1], int):
            at.append(shown)
        else:
            at[last] = shown
    return tree


def with_widths(tree: Any, widths: Mapping[Path, float | None], path: Path = ()) -> Any:
    """Copy a JSON tree with every number replaced by its half-width: 0 for numbers of the input, None if unknown."""
    match tree:
        case dict():
            return {key: with_widths(value, widths, (*path, key)) for key, value in tree.items()}
        case list():
            return [with_widths(value, widths, (*path, index)) for index, value in enumerate(tree)]
        case int() | float():
            given = _GIVEN & set(path[-2:]) and not _OF_THE_MESH & set(path)
            return 0.0 if given else widths.get(path)
        case _:
            return tree


_OF_THE_MESH = {"nodes", "line", "contact_boundary", "max_at", "min_at", "max_pressure_at"}
"""Keys of numbers without half-widths: lists whose length depends on the mesh, and positions of extremes."""
_GIVEN = {"at", "length", "width", "d", "rho", "fck", "fyk", *(f"{side}_width" for side in MEAN_SIDES)}


def _probe(probe: ProbeResult) -> dict[str, Any]:
    """JSON of a probe without its numbers, which `put` writes."""
    least = probe.minimum_governs
    of_bars = {} if least is None else {"minimum_governs": {face: list(of) for face, of in least.items()}}
    return {"at": list(probe.at), "pressure": None, **of_bars}


def _all_places(result: Result) -> dict[str, dict[str, Any]]:
    """JSON of every field's extremes without their values, which `put` writes: positions, widths, `minimum_governs`."""
    ends, bars = {name: _places(name, of) for name, of in result.extremes.items()}, result.model.bars
    for name in ends:
        if name not in REINFORCEMENT or bars is None:
            continue
        of = result.extremes[name]
        ends[name]["minimum_governs"] = least_at(name, of.max, of.max_at, bars, result.stress_nodes, result.thickness)
    return ends


def _places(name: str, ends: Any) -> dict[str, Any]:
    at = {f"{side}_at": [None if np.isnan(x) else x for x in getattr(ends, f"{side}_at")] for side in SIDES}
    at |= {f"{side}_beside": getattr(ends, f"{side}_beside") for side in SIDES}
    if name not in PEAKING:
        return at
    means = {f"{side}_at": list(getattr(ends, f"{side}_at")) for side in MEAN_SIDES}
    means |= {f"{side}_width": getattr(ends, f"{side}_width") for side in MEAN_SIDES}
    return at | {key: None if np.isnan(value).any() else value for key, value in means.items()}


def _support(support: SupportResult) -> dict[str, Any]:
    result: dict[str, Any] = {"name": support.name, "kind": support.kind}
    result |= {one.name: None for one in OF_AREAS}
    result["max_pressure_at"] = support.max_pressure_at and list(support.max_pressure_at)
    result["contact_boundary"] = [line.tolist() for line in support.contact_boundary]
    if support.area is not None:
        return result
    result |= _line(support)
    return result | {"points" if support.place == "at" else "nodes": list(point_figures(support))}


def columns_named(model: Model) -> list[dict[str, Any]]:
    """JSON of the columns of [[punching]]: name and position of each, without numbers."""
    return [{"name": column.subject.removeprefix("punching:"), "at": list(column.at)} for column in model.columns]


def joints(result: Result) -> list[dict[str, Any]]:
    """Sum preloads and reactions over the bolts of each joint.

    Bolts that hold the same plate, or connect the same two plates, are one joint.
    """
    groups: dict[object, list[SupportResult]] = {}
    for support, values in zip(result.model.support, result.supports, strict=False):
        if support.is_bolt:
            groups.setdefault(support.between or support.plate, []).append(values)
    return [
        {
            "supports": [values.name for values in bolts],
            "bolts": sum(len(values.reactions) for values in bolts),
            "preload": sum(values.preload for values in bolts),
            "reaction": sum(values.reaction for values in bolts),
        }
        for bolts in groups.values()
    ]


def _line(support: SupportResult) -> dict[str, Any]:
    """JSON of a support's line: each station has the reaction per length, and the couple of the side that begins there.

    Couples are those of edges that hold the slope. At the last station of a run no side begins; its couple is that of
    the side that ends there.
    """
    edge, line = support.edge, support.line
    couples: dict[tuple[float, ...], dict[str, Any]] = {}
    if edge is not None:
        for (begin, end), couple in zip(edge.sides.tolist(), edge.couples.tolist(), strict=True):
            couples[tuple(begin)] = {"from": begin, "to": end, "couple": couple}
    if line is None:
        return {"line": list(couples.values())} if edge is not None else {}
    stations: list[dict[str, Any]] = []
    columns = line.positions.tolist(), line.s.tolist(), line.lengths.tolist(), line.reactions.tolist()
    last = np.append(line.begins[1:], True).tolist()
    for at, s, length, reaction, ends in zip(*columns, last, strict=True):
        station = {"at": at, "s": s, "length": length, "reaction": reaction}
        if edge is not None:
            before = stations[-1]["couple"] if stations else None
            beside = {"from": at, "to": at, "couple": before if ends else None}
            station |= beside if ends else couples.get(tuple(at), beside)
        stations.append(station)
    return {
        "max_per_length_at": list(line.max_per_length_at),
        "min_per_length_at": list(line.min_per_length_at),
        "line": stations,
        "corners": [{"at": at} for at in line.corners.tolist()],
    }


def total(support: SupportResult) -> dict[str, Any]:
    """JSON of the numbers of a support as a whole, such as its total reaction."""
    return {
        "reaction": support.reaction,
        "closed": support.closed_count,
        "open": support.open_count,
        **{one.name: getattr(support, one.name) for one in OF_AREAS},
        **({} if support.line is None else {one.name: getattr(support.line, one.name) for one in OF_LINES}),
    }


def point_figures(support: SupportResult) -> Iterator[dict[str, Any]]:
    """Yield the JSON of each point of a support; for a held edge the reactions are consistent nodal forces."""
    columns = (support.positions.tolist(), support.reactions.tolist(), support.gaps.tolist(), support.states)
    for at, reaction, gap, state in zip(*columns, strict=True):
        point = {"at": at, "reaction": reaction, "gap": gap, "state": state}
        yield point if support.pieces is None else {**point, "yielded": state == "yields"}


def check_names(checks: Sequence[Check]) -> dict[str, Any]:
    """JSON of checks with value and utilisation null, as `put` fills them in later; empty without checks."""
    return {"checks": [{"name": check.name, "value": None, "utilisation": None} for check in checks]} if checks else {}


def line_places(sections: Sequence[SectionResult], strips: Sequence[StripResult]) -> dict[str, Any]:
    """JSON of the names, lengths and positions of sections and strips; `put` adds their results."""
    lines = [{"name": section.name, "length": section.length} for section in sections]
    return {"sections": lines, "strips": [_strip(strip) for strip in strips]}


def _strip(strip: StripResult) -> dict[str, Any]:
    stations = [
        {
            "at": list(one.at),
            "width": one.width,
            **({"minimum_governs": one.minimum_governs} if one.minimum_governs else {}),
        }
        for one in strip.stations
    ]
    ends = {"max_at": list(strip.sagging.at), "min_at": list(strip.hogging.at)}
    return {"name": strip.name, **ends, "stations": stations}
