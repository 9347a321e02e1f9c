"""Sections of a report on the results: summary, equilibrium, reactions, fields, sections, punching, path, warnings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from signorini.accuracy.comparison import t_in_words
from signorini.analysis.checks import judged
from signorini.analysis.results import Results
from signorini.contact.certificate import FIGURES, TOLERANCE
from signorini.output.by_combination import by_combination
from signorini.reports import pictures
from signorini.reports.blocks import Block, Cell, Map, Table, Text, Writer, found, solved
from signorini.reports.diagrams import diagrams
from signorini.reports.maps import fields_of, map_data, map_html
from signorini.reports.punching import figure, sheet
from signorini.reports.sections import Contents
from signorini.results.load_path import LoadPath, motion_of
from signorini.results.quantities import (
    AT_PROBES,
    DESIGN_MOMENTS,
    MEANS,
    OF_AREAS,
    OF_LINES,
    PICTURED,
    REINFORCEMENT,
    SIDES,
    THROUGH,
    Quantity,
    in_model,
)

_ACROSS = 8
"""Largest number of columns of simultaneous reactions, or of quantities at probes, in one table."""
_OF_STATIONS = 4
"""Largest number of columns with extremes along strips in one table, so that the table fits on paper."""
_MOST_REASONS = 20
"""Largest number of combinations without equilibrium whose reason is given."""


def _width(tree: Any, *keys: str | int) -> Any:
    """Half-width at a path of keys in a table "plus_minus" of results.json; ``...`` if no half-widths were computed."""
    return ... if tree is None else found(tree, *keys)


def extremes(of: Contents, name: str, group: str = "") -> Iterator[tuple[str, float, Any, str, Any]]:
    """Yield side, value, half-width, combination and place of the largest and the smallest value of a field.

    The extremes are those over a group of combinations; over all combinations if ``group`` is empty.
    """
    path = (name,) if name == "deflection" else ("fields", name)
    if (envelope := of.over(group).get("envelope")) is not None:
        own, widths = found(envelope, "fields", name), envelope["plus_minus"]
        for side in SIDES if own else ():
            by = own.get(f"{side}_by")
            yield side, own.get(side), _width(widths, "fields", name, side), by, own.get(f"{side}_at")
        return
    told = [(one, found(one, *path)) for one in of.solved(group) if found(one, *path, "max") is not None]
    for side in SIDES if told else ():
        one, own = (max if side == "max" else min)(told, key=lambda pair: pair[1][side])
        yield side, own[side], _width(one["plus_minus"], *path, side), one["name"], own[f"{side}_at"]


class _Check(NamedTuple):
    """A check in the summary; a half-width is None if it is unknown, ``...`` if half-widths were not computed."""

    name: str
    of: str
    value: float | None
    value_width: Any
    limit: float | None
    used: float | None
    width: Any
    by: str | None
    place: Any
    passed: bool | None
    verdict: str


def _checks(of: Contents) -> list[_Check]:
    """Checks of the input and of punched columns, sorted by utilisation, the largest first."""
    result = list[_Check]()
    for one in of.values.get("checks") or ():
        width = ... if of.estimates is None else one["plus_minus"]
        own = width if width in (None, ...) else abs(one["limit"]) * width
        numbers = one["value"], own, one["limit"], one["utilisation"], width, one["governing"]
        result.append(_Check(one["name"], one["of"], *numbers, one["place"], one["passed"], VERDICTS[one["verdict"]]))
    for column in of.punched:
        used, width = column.utilisation
        own = ... if column.widths is None else column.widths["v_ed"]
        value, limit = (column.of.numbers[key] for key in ("v_ed", "v_rd_c"))
        passed, verdict = judged(used, None if width is ... else width, width is not ..., 0)
        told = value, own, limit, used, width, column.combination, list(column.of.at), passed, VERDICTS[verdict]
        result.append(_Check(f"{of.write('punching')} {column.of.name}", "v_ed", *told))
    return sorted(result, key=lambda check: -(math.inf if check.used is None else check.used))


def _verdicts(of: Contents, checks: Sequence[_Check]) -> Iterator[Block]:
    """Yield the number of checks that passed, the names of failed checks, and advice where ± is unknown."""
    write, failed = of.write, [one.name for one in checks if one.passed is False]
    undecided = [one for one in checks if one.passed is None]
    counts = {"passed": len(checks) - len(failed) - len(undecided), "failed": len(failed), "open": len(undecided)}
    names = f" ({', '.join(failed)})" if failed else ""
    words = write("verdicts", all=len(checks), names=names, **counts)
    yield Text(words, "bad" if failed else "warning" if undecided else "good")
    if unknown := ", ".join(one.name for one in undecided if one.verdict == "width_unknown"):
        yield Text(write("unknown_widths", names=unknown), "warning")


VERDICTS = {
    "passed": "passed",
    "failed": "failed",
    "undecided: 1 is within ±": "undecided",
    "± unknown": "width_unknown",
    "no equilibrium": "no_equilibrium",
    "no value": "no_value",
}
"""Key in texts.toml of each verdict on a check, which `judged` returns."""


def verdict_on(of: Contents, used: float, width: Any) -> tuple[bool | None, str]:
    """Whether a utilisation passes, None if undecided, and the verdict in words.

    ``width`` is the half-width of the utilisation; ``...`` if no half-widths were computed.
    """
    passed, verdict = judged(used, None if width is ... else width, width is not ..., 0)
    return passed, of.write(VERDICTS[verdict])


def summary(of: Contents) -> Iterator[Block]:
    """Yield the verdict on all checks, the verdict on equilibrium and certificates, and the table of checks."""
    write, values, checks = of.write, of.values, _checks(of)
    if checks:
        yield from _verdicts(of, checks)
    table = values.get("table") or {}
    count = table.get("solved", sum(1 for _ in solved(values)))
    failed = len(of.results) - count
    passed = all(one["certificate"]["passed"] for one in solved(values))
    yield Text(write("certified", count=count, all=len(of.results)), "good" if passed and not failed else "plain")
    if failed:
        yield Text(write("unbalanced", count=failed), "bad")
        yield from _in_english(write)
        for name, message in islice(of.results.unbalanced.items(), _MOST_REASONS):
            yield Text(f"{of.code(name)}: {message}", "bad", english=True)
    rows = []
    for one in checks:
        quantity = of.checked(one.of) or Quantity("", "part")
        value, limit = write.value(quantity, one.value, one.value_width), write.value(quantity, one.limit)
        cells = [Cell(one.name), value, limit, Cell(write.unit_of(quantity)), write.number(one.used, one.width)]
        governing = [Cell(of.code(one.by) if one.by else ""), write.place(one.place)]
        rows.append([*cells, *governing, Cell(write(one.verdict))])
    head = ("check", "value", "limit", "unit", "utilisation", "governing", "place", "verdict")
    yield Table(write("checks"), [write(key) for key in head], rows) if rows else Text(write("no_checks"))


def extreme_results(of: Contents) -> Iterator[Block]:
    """Yield the extreme deflections, reactions and pressures, a table for each group of combinations."""
    head = [of.write(key) for key in ("quantity", "value", "governing", "place")]
    for group in of.groups:
        rows = [*_field_rows(of, ["deflection"], group), *_reaction_rows(of, group)]
        yield Table(of.captioned("extremes", group), head, rows)


def _in_english(write: Writer) -> Iterator[Text]:
    """Yield, unless the report is in English, the sentence that messages of the program are in English."""
    if write.language != "en":
        yield Text(write("in_english"))


def _field_rows(of: Contents, names: Sequence[str], group: str) -> Iterator[Sequence[Cell]]:
    write = of.write
    for name in names:
        ends = list(extremes(of, name, group))
        size = max((abs(end[1]) for end in ends), default=0.0)
        governing = "min" if DESIGN_MOMENTS.get(name, 1.0) < 0.0 else "max"
        for side, value, width, by, at in ends:
            if side != governing and (name in DESIGN_MOMENTS or name in REINFORCEMENT):
                continue  # the other extreme of design moments and reinforcement is 0
            words = f"{write.label(PICTURED[name])}, {write(side)}"
            yield [Cell(words), write.value(PICTURED[name], value, width, size), Cell(of.code(by)), write.place(at)]


def _reaction_rows(of: Contents, group: str) -> Iterator[Sequence[Cell]]:
    """Yield the largest and smallest reaction of each whole support, and the largest pressures."""
    write, every = of.write, of.over(group)["governing_reactions"]
    unit, largest = write.unit("reaction"), _largest(of)
    for support in dict.fromkeys(one["support"] for one in every):
        own = [one for one in every if one["support"] == support]
        for side, chosen in zip(SIDES, (max, min), strict=True):
            one = chosen(own, key=itemgetter(side))
            words = f"{write('reaction')} {_bearing(one)}{unit}, {write(side)}"
            cells = [Cell(words), write.number(one[side], _width(one["plus_minus"], side), largest)]
            yield [*cells, Cell(of.code(one[f"{side}_by"])), write.place(one["at"])]
    for index, support in enumerate(of.results.model.support):
        value, width, by, at = _largest_pressure(of, index, group)
        if value:
            words = f"{write('pressure')} {support.name}{write.unit('pressure')}, {write('max')}"
            yield [Cell(words), write.number(value, width), Cell(of.code(by)), write.place(at)]


def _largest_pressure(of: Contents, index: int, group: str) -> tuple[float | None, Any, str, Any]:
    """Largest pressure below support number ``index``, half-width, combination and place; None without a pressure."""
    place = of.place_of(index)
    if (envelope := of.over(group).get("envelope")) is not None:
        if (own := found(envelope, *place, "max_pressure")) is None:
            return None, ..., "", None
        width = _width(envelope["plus_minus"], *place, "max_pressure", "max")
        return own["max"], width, own["max_by"], found(envelope, *place, "largest", "max_at")
    every = ((one, _supports(of, one, index)) for one in of.solved(group))
    one, own = max(every, key=lambda pair: pair[1]["max_pressure"] or 0.0, default=({}, None))
    if own is None:
        return None, ..., "", None
    return own["max_pressure"], _width(one["plus_minus"], *place, "max_pressure"), one["name"], own["max_pressure_at"]


def _largest(of: Contents) -> float:
    """Largest reaction of all supports; reactions within rounding of 0, relative to it, are written as 0."""
    return max((abs(one[side]) for one in of.values["governing_reactions"] for side in SIDES), default=0.0)


def _bearing(one: Mapping[str, Any]) -> str:
    """Name of a whole support, or of one of its points with the number of the point."""
    return f"{one['support']}[{one['point']}]" if one["point"] else str(one["support"])


def _supports(of: Contents, one: Mapping[str, Any], index: int) -> Any:
    return found(one, *of.place_of(index))


def equilibrium(of: Contents) -> Iterator[Block]:
    """Yield the sums of loads and of reactions of each combination, and the errors of its certificate."""
    write, discretisation = of.write, of.results.discretisation
    between = [support.between is not None for support in of.results.model.support]
    rows, errors = [], []
    for one in solved(of.values):
        weighing = discretisation.load(
            of.results.model.effective_combinations[of.results.number_of(one["name"])]
        ).weighing
        load = float((discretisation.rigid_motions.T @ weighing).reshape(-1, 3)[:, 0].sum())
        own = [_supports(of, one, index)["reaction"] for index, inner in enumerate(between) if not inner]
        size = max(abs(load), *map(abs, own), float(abs(weighing).sum()))
        numbers = (load, sum(own), sum(own) - load)
        rows.append([Cell(of.code(one["name"])), *(write.number(value, size=size) for value in numbers)])
        found_errors, bounds = one["certificate"], (one["certificate"].get(f"{name}_limit", 0.0) for name in FIGURES)
        cells = [
            Cell(f"{found_errors[name]:.1e} ≤ {max(bound, TOLERANCE):.0e}", found_errors[name])
            for name, bound in zip(FIGURES, bounds, strict=True)
        ]
        passed = write("passed" if found_errors["passed"] else "failed")
        errors.append([Cell(of.short(one["name"])), *cells, Cell(passed)])
    unit = write.unit("reaction")
    head = [write("combination"), *(write(key) + unit for key in ("load_sum", "reaction_sum", "difference"))]
    yield Table(write("balance_table"), head, rows)
    yield Text(write("certificate_words"))
    yield Table(write("certificate"), [write("combination"), *map(write, FIGURES), write("verdict")], errors)


def reactions(of: Contents) -> Iterator[Block]:
    """Yield tables of reactions of supports and of points, and of extreme reactions with the simultaneous ones."""
    write, largest = of.write, _largest(of)
    sizes = {"reaction": largest, "gap": max((abs(end[1]) for end in extremes(of, "deflection")), default=0.0)}
    rows, points = [], []
    for one in solved(of.values):
        for index in range(len(of.results.model.support)):
            own, keys = _supports(of, one, index), of.place_of(index)
            cells = [Cell(of.code(one["name"])), Cell(own["name"]), Cell(own["kind"])]
            cells += [write.number(own["reaction"], _width(one["plus_minus"], *keys, "reaction"), largest)]
            cells += [write.number(own["closed_part"])]
            areas = ((own[area.name], _width(one["plus_minus"], *keys, area.name)) for area in OF_AREAS[:2])
            rows.append([*cells, *(write.number(*pair) for pair in areas)])
            for number, point in enumerate(own.get("points") or ()):
                cells = [Cell(of.short(one["name"])), Cell(f"{own['name']}[{number + 1}]"), write.place(point["at"])]
                for key, size in sizes.items():
                    cells.append(
                        write.number(point[key], _width(one["plus_minus"], *keys, "points", number, key), size)
                    )
                points.append([*cells, Cell(write(point["state"]))])
    head = [write("combination"), write("support"), write("kind"), write("reaction") + write.unit("reaction")]
    head += [write("closed_part"), *(write.label(area) for area in OF_AREAS[:2])]
    yield Table(write("reactions"), head, rows)
    head = [write("combination"), write("support"), write("place"), write("reaction") + write.unit("reaction")]
    yield Table(write("reactions_points"), [*head, write.titled("gap", "deflection"), write("state")], points)
    every = of.values["governing_reactions"]
    names = [_bearing(one) for one in every]
    yield Text(write("simultaneous_words"))
    for first in range(0, len(every), _ACROSS):
        columns = range(first, min(first + _ACROSS, len(every)))
        rows = []
        for name, one in zip(names, every, strict=True):
            for side in SIDES:
                cells = [
                    Cell(f"{name}, {write(side)}"),
                    write.number(one[side], _width(one["plus_minus"], side), largest),
                ]
                together = (write.number(one[f"{side}_with"][at], size=largest) for at in columns)
                rows.append([*cells, Cell(of.short(one[f"{side}_by"])), *together])
        head = [write("extreme"), write("value") + write.unit("reaction"), write("combination")]
        yield Table(
            _part(write("simultaneous"), first, len(every)),
            [*head, *(names[at] for at in columns)],
            rows,
        )
    yield from _by_combination(of)


def _by_combination(of: Contents) -> Iterator[Block]:
    """Yield tables over all combinations: numbers of area supports, utilisations of checks and of punched columns."""
    write, model = of.write, of.results.model
    areas = {support.name for support in model.support if support.area is not None}
    numbers = [pair for pair in by_combination(of.results) if pair[0].home != "support" or pair[0].subject in areas]
    # Numbers of one kind are rounded relative to the largest: one of two eccentricities may be a rounding error.
    sizes = {"length": of.results.discretisation.mesh.size}
    for one, values in numbers:
        kind = one.quantity.kind
        sizes[kind] = float(np.nanmax(np.abs(values), initial=sizes.get(kind, 0.0)))
    for first in range(0, len(numbers), _ACROSS):
        some = numbers[first : first + _ACROSS]
        rows = [
            [
                Cell(of.short(one.name)),
                *(
                    write.number(None if np.isnan(own[row]) else float(own[row]), size=sizes[which.quantity.kind])
                    for which, own in some
                ),
            ]
            for row, one in enumerate(model.effective_combinations)
        ]
        head = [write("combination"), *(f"{one.subject}: {write.label(one.quantity)}" for one, _ in some)]
        yield Table(_part(write("by_combination"), first, len(numbers)), head, rows)


def fields(of: Contents) -> Iterator[Block]:
    """Yield maps or pictures of fields, and a table of their extremes."""
    if any(True for _ in solved(of.values)):
        yield _map(of, of.results, "map")
    head = [of.write(key) for key in ("quantity", "value", "governing", "place")]
    yield Text(of.write("excluded_words"))
    for group in of.groups:
        rows = list(_field_rows(of, fields_of(of.results.model), group))
        yield Table(of.captioned("field_extremes", group), head, rows)
    told = [(one, number, probe) for one in solved(of.values) for number, probe in enumerate(one["probes"])]
    known = [one for one in AT_PROBES if any(found(probe, *one.path) is not None for _, _, probe in told)]
    head = [of.write(key) for key in ("combination", "probe", "place")]
    for first in range(0, len(known), _ACROSS):
        some, rows = known[first : first + _ACROSS], []
        for one, number, probe in told:
            keys = ("probes", number)
            cells = [Cell(of.short(one["name"])), Cell(f"{number + 1}"), of.write.place(probe["at"])]
            values = ((each, found(probe, *each.path), _width(one["plus_minus"], *keys, *each.path)) for each in some)
            rows.append([*cells, *(of.write.value(*one) for one in values)])
        yield Table(_part(of.write("probes"), first, len(known)), [*head, *map(of.write.label, some)], rows)


def _part(caption: str, first: int, count: int, across: int = _ACROSS) -> str:
    """Caption of a table with at most ``across`` of ``count`` columns; numbered if the columns need several tables."""
    return f"{caption} ({first // across + 1})" if count > across else caption


def _map(of: Contents, results: Results | LoadPath, name: str) -> Map:
    """Interactive map of results or of a load path, with its texts in the language of the report."""

    def markup(budget: int) -> str:
        own = results is of.results
        data = map_data(results, of.estimates if own else None, budget=budget, columns=of.punched if own else ())
        words = {field["name"]: of.write.translated(field["words"]) for field in data.header["fields"]}
        checked = (one for one in words if one.startswith("utilisation:"))
        words |= {one: f"{of.write('utilisation')}, {one.removeprefix('utilisation:')}" for one in checked}
        words |= {} if own else {"state": of.write("stop")}
        return map_html(data, name, of.write.language, words)

    return Map(name, markup)


def cuts(of: Contents) -> Iterator[Block]:
    """Yield sections, strips, reactions along walls, and the diagrams of profiles, strips and walls."""
    write = of.write
    sections, walls = [], []
    for one in solved(of.values):
        name, told = Cell(of.short(one["name"])), one["plus_minus"]
        for index, cut in enumerate(one["sections"]):
            cells = (write.number(cut[each.name], _width(told, "sections", index, each.name)) for each in THROUGH)
            sections.append([name, Cell(cut["name"]), write.number(cut["length"]), *cells])
        for index in range(len(of.results.model.support)):
            if (wall := _supports(of, one, index)).get("max_per_length") is not None:
                owner = of.place_of(index)
                ends = (write.number(wall[each.name], _width(told, *owner, each.name)) for each in OF_LINES)
                corners = "; ".join(
                    f"{write.place(c['at']).text}: {write.number(c['reaction']).text}" for c in wall["corners"]
                )
                walls.append([name, Cell(wall["name"]), *ends, Cell(corners)])
    own: Sequence[Quantity] = THROUGH
    head = [write("combination"), write("section")]
    yield Table(write("sections"), [*head, write.titled("length", "deflection"), *map(write.label, own)], sections)
    yield from _strips(of)
    head = [write("combination"), write("support"), *map(write.label, OF_LINES)]
    yield Table(write("walls"), [*head, write.titled("corners", "reaction")], walls)
    yield from diagrams(of)


def _strips(of: Contents) -> Iterator[Block]:
    """Yield tables of the extreme means across strips at every station, each extreme with its combination."""
    write, envelope, ends = of.write, of.results.envelope, []
    for each in (one for one in in_model(of.results.model, MEANS) if one.name != "twist"):
        bars = each.path[-1] if len(each.path) > 1 else ""
        sides = SIDES if not bars else ("min",) if each.name == "moment_top" else ("max",)
        ends += [(each, side) for side in sides]
    places = {(one.owner, one.part, one.what): one for one in envelope.layout.catalogue if one.home == "station"}
    first = next(solved(of.values), {})
    stations = [
        (index, number, strip["name"], station)
        for index, strip in enumerate(first.get("strips", ()))
        for number, station in enumerate(strip["stations"])
    ]
    for begin in range(0, len(ends), _OF_STATIONS):
        some, rows = ends[begin : begin + _OF_STATIONS], []
        for index, number, name, station in stations:
            cells = [Cell(name), write.place(station["at"]), write.number(station["width"])]
            for each, side in some:
                column = places[index, number, each.name].column
                end = envelope[column]
                value, row = (end.max, end.max_by) if side == "max" else (end.min, end.min_by)
                width = ... if of.estimates is None or value == 0.0 else of.estimates.half_width(column, row)
                cell = write.value(each, value, width)
                cells.append(Cell(f"{cell.text} ({of.short(of.results.key(row))})", cell.value))
            rows.append(cells)
        head = [write("strip"), write("place"), write.titled("width", "deflection")]
        titles = (f"{write(side)} {write.label(each)}" for each, side in some)
        yield Table(_part(write("strips"), begin, len(ends), _OF_STATIONS), [*head, *titles], rows)


def load_path(of: Contents) -> Iterator[Block]:
    """Yield a load path: how it ends, its events and thresholds, its picture."""
    if of.along is None:
        return
    write, path = of.write, of.along
    yield Text(write("path_words", start=path.start or "0", add=path.add))
    end = path.limit if path.ending == "no_equilibrium" else path.end
    yield Text(write(f"ends_{path.ending}", t=f"{end:.6g}"))
    yield from _in_english(write)
    if motion := motion_of(path):
        yield Text(f"{motion[:1].upper()}{motion[1:]}.", english=True)
    yield pictures.of_path(path, write)
    yield _map(of, path, "map-path")
    size = max(abs(stop.utmost) for stop in path.stops)
    rows = []
    for index, stop in enumerate(path.stops):
        if event := path.words(index):
            t = Cell(t_in_words(path, index, of.along_estimate), stop.t)
            largest = max(map(abs, stop.reactions.tolist()), default=0.0)
            reactions = (write.number(one, size=largest) for one in stop.reactions.tolist()[:_ACROSS])
            rows.append([t, Cell(event), write.number(stop.utmost, size=size), *reactions])
    head = ["t", write("event"), f"{write.label(PICTURED['deflection'])}, {write('max')}"]
    head += (one.name + write.unit("reaction") for one in path.model.support[:_ACROSS])
    yield Table(write("events"), head, rows, english=True)


def punching(of: Contents) -> Iterator[Block]:
    """Yield a sheet and a figure for each column in its governing combination."""
    write = of.write
    for one in of.punched:
        column = one.of.column
        table = of.results.model.punching[column.column.table]
        place, name = write.place(one.of.at).text, f"{write('combination')} {of.code(one.combination)}"
        yield Text(f"{one.of.name}, {place}, {name}", "heading")
        yield figure(one, write)
        head = [write(key) for key in ("symbol", "meaning", "value", "unit", "clause")]
        yield Table(f"{write('punching')} {one.of.name}, {column.code}", head, [*sheet(one, table, write)], open=True)
        used, width = one.utilisation
        passed, verdict = verdict_on(of, used, width)
        words = f"{write('utilisation')} {write.number(used, width).text}: {verdict}"
        yield Text(words, "plain" if passed is None else "good" if passed else "bad")
        if one.of.numbers["asw"] > 0.0:
            enough = one.of.numbers["with_links"] <= 1.0
            yield Text(write("links" if enough else "no_links"), "warning" if enough else "bad")


def sensitivities(of: Contents) -> Iterator[Block]:
    """Yield a table of the derivatives of each number, in the combination in which the number is extreme."""
    write, each = of.write, of.values.get("sensitivities", ())
    if each:
        yield Text(write("sensitivity_words"))
    pairs = ("value", "unit"), ("derivative", "derivative_unit")
    head = [write(key) for key in ("parameter", "value", "derivative", "elasticity", "valid_from", "valid_to")]
    for one in each:
        rows = [
            [
                Cell(row["path"]),
                *(_with_unit(write, row[key], row[unit]) for key, unit in pairs),
                *map(write.number, (row["elasticity"], *row["valid"])),
            ]
            for row in one["parameters"]
        ]
        value = _with_unit(write, one["value"], one["unit"])
        yield Table(f"{one['name']} = {value.text} ({of.code(one['combination'])})", head, rows)
        yield from (Text(f"{row['path']}: {row['why']}", english=True) for row in one["parameters"] if row["why"])


def _with_unit(write: Writer, value: float | None, unit: str) -> Cell:
    """Cell of a number with its unit."""
    cell = write.number(value)
    return cell if value is None else Cell(f"{cell.text} {unit}".rstrip(), value)


def warnings(of: Contents) -> Iterator[Block]:
    """Yield each warning with its combinations, and the places where results grow without limit with refinement."""
    for one in of.values["warnings"]:
        names = f" ({', '.join(map(of.code, one['combinations']))})" if one["combinations"] else ""
        yield Text(one["text"] + names, "warning", english=True)
    if not of.values["warnings"]:
        yield Text(of.write("no_warnings"))
    singular = {one["what"]: one for combination in of.values["combinations"] for one in combination["singular"]}
    if of.values["warnings"] or singular:
        yield from _in_english(of.write)
    rows = [
        [Cell(one["what"]), Cell(", ".join(one["numbers"])), of.write.number(one["within"]), Cell(one["advice"])]
        for one in singular.values()
    ]
    head = [
        of.write("place"),
        of.write("singular_numbers"),
        of.write.titled("within", "deflection"),
        of.write("advice"),
    ]
    yield Table(of.write("singular"), head, rows, english=True)
