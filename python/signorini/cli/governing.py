"""Tables of extremes over combinations, with the governing combinations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
from rich.console import Console
from rich.text import Text

from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.base.numbers import estimated, in_unit, number, size_of
from signorini.cli.grid import (
    UNSETTLED,
    Column,
    Grid,
    cell,
    in_contact,
    in_title,
    numbers,
    say,
    say_checked,
    unit_of,
)
from signorini.cli.sentences import Labels, excluded
from signorini.contact.certificate import FIGURES
from signorini.errors import length, point
from signorini.model import Model, Units
from signorini.output.envelope_json import envelope_json
from signorini.output.governing import Governing, governing_reactions
from signorini.output.names import GOVERNING, JSON
from signorini.results.quantities import FIELDS, LINEAR, MEAN_SIDES, MEANS, PEAKING, SIDES, THROUGH, on_plate, place_of
from signorini.results.rows import Bearing
from signorini.singularities.beside import PEAKS
from signorini.singularities.named import excluding
from signorini.singularities.singularity import Singularity

Widths = Mapping[str, Any] | None
"""Half-widths (±) of an envelope, in the structure of results.json; None if mesh errors are not estimated."""

_MAX_NAMED = 5
"""Largest number of combinations without equilibrium that are printed by name; result files name all of them."""
_MAX_PROBES = 6
"""Largest number of probes whose extremes are printed; a probe takes eight rows of the table."""
_MAX_LISTED, _MAX_COMBINATIONS = 40, 40
"""Largest numbers of bearings and of combinations for which the table of all reactions is printed."""
_MAX_BEARINGS = 12
"""Largest number of bearings for which the table of governing combinations with all reactions is printed."""


def print_combined(console: Console, results: Results, estimates: Estimates | None, labels: Labels) -> None:
    """Print the number of solved combinations, and for each group the extremes with the governing combinations."""
    combined, model = results.combined, results.model
    total = len(combined.combinations)
    say(console, Text(f"{total} combinations", style="bold") + Text(f": {combined.solved} solved"))
    if combined.solved < total:
        names = list(combined.unbalanced)
        more = total - combined.solved - len(names[:_MAX_NAMED])
        listed = ", ".join(names[:_MAX_NAMED]) + (f" and {more} more" if more else "")
        say(console, f"{total - combined.solved} without equilibrium: {listed}", style="bold red")
    if combined.not_unique:
        say(
            console,
            f"{combined.not_unique} combinations have no unique solution: the least-norm solutions are shown",
            style="yellow",
        )
    console.print()
    for group, count in model.effective_combinations.groups.items() or (("", total),):
        if group:
            say(console, Text(group, style="bold") + Text(f": {count} combinations"))
        envelope = envelope_json(results, estimates, group)
        if envelope is None:
            say(console, "no combination has an equilibrium", style="bold red")
            console.print()
            continue
        _print_fields(console, results, group, envelope, labels)
        _print_supports(console, results, group, envelope["plus_minus"], labels)
        _print_probes(console, results, envelope, labels)
        _print_enveloped(console, results, envelope, labels)
        print_governing(console, results, estimates, labels, group)
    print_bearings(console, results, estimates, labels)
    if combined.solved:
        figures = ", ".join(f"{name} {combined.certificate[name]:.1e}" for name in FIGURES)
        say(console, f"worst certificate passed: {figures}")
    others = () if estimates is None or estimates.of_table is None else estimates.of_table.others
    meshes = [results.discretisation.mesh, *(mesh for _, mesh in others)] if others else []
    elements = sorted((len(mesh.elements) for mesh in meshes), reverse=True)
    say_checked(console, elements, model.estimated)
    if results.full:
        say(console, f"all results of: {', '.join(map(labels.code, results.full))}")


MeanRow = tuple[str, Sequence[Sequence[str]]]
"""Name of a field, and the cells of its largest and of its smallest mean: value, position, width and, for several
combinations, the combination.
"""


def print_means(
    console: Console,
    singular: Mapping[str, Iterable[Singularity]],
    rows: Sequence[MeanRow],
    units: Units,
    labels: Labels | None = None,
) -> None:
    """Print places excluded from extremes of moments and shears, and mean moments and shears at these places."""
    for sentence in excluded(singular, units):
        say(console, sentence)
    unit = in_unit(units.length)
    columns = [*numbers(f"at{unit}", f"over{unit}"), *([Column("of", coded=labels.numbered)] if labels else [])]
    shown = Grid([Column("mean there"), *numbers("largest"), *columns, *numbers("smallest"), *columns])
    for name, cells in rows:
        if any(cells):
            largest, smallest = (side or [""] * (1 + len(columns)) for side in cells)
            shown.add(name, *largest, *smallest)
    shown.show(console)


def print_bearings(console: Console, results: Results, estimates: Estimates | None, labels: Labels) -> None:
    """Print a table with the reaction of each bearing in each combination, unless the table would be too large."""
    layout, rows, model = results.combined.layout, results.combined.rows, results.model
    points = any(bearing.point is not None for bearing in layout.bearings)
    few = len(results) <= _MAX_COMBINATIONS and 1 < len(layout.bearings) <= _MAX_LISTED
    if rows is None or not few or not (points or model.tabulated):
        return
    columns, names = [bearing.column(model) for bearing in layout.bearings], _names(model, layout.bearings)
    values = np.array([rows[column] for column in columns])
    largest = size_of(values[~np.isnan(values)])
    unit = in_unit(model.units.force)
    shown = Grid([Column("combination", coded=labels.numbered), *numbers(*(f"{name}{unit}" for name in names))])
    for row, reactions in enumerate(values.T.tolist()):
        widths = [None if estimates is None else estimates.half_width(column, row) for column in columns]
        solved = not np.isnan(reactions).all()
        cells = _cells(reactions, widths, largest) if solved else [""] * len(reactions)
        shown.add(labels.cell(results.key(row)), *cells)
    say(console, "reaction of each bearing")
    shown.show(console, apart=True)


def _cells(values: Sequence[float], widths: Sequence[float | None], largest: float) -> list[str]:
    """Write values with their half-widths (±); if all half-widths are None, write the values alone."""
    if all(width is None for width in widths):
        return [number(value, largest) for value in values]
    return [estimated(value, width, largest) for value, width in zip(values, widths, strict=True)]


def _names(model: Model, bearings: Sequence[Bearing]) -> list[str]:
    """Name of each bearing: the name of its support, with the point's number if the support has several bearings."""
    supports = [bearing.support for bearing in bearings]
    return [
        f"{model.support[bearing.support].name}[{bearing.point}]"
        if supports.count(bearing.support) > 1
        else model.support[bearing.support].name
        for bearing in bearings
    ]


def _print_extreme_reactions(
    console: Console, results: Results, reactions: Sequence[Governing], labels: Labels
) -> None:
    """Print the largest and smallest reaction of each of the 40 bearings with the largest reactions."""
    model, size = results.model, results.discretisation.mesh.size
    pairs = list(zip(reactions[::2], reactions[1::2], strict=True))
    listed = sorted(pairs, key=lambda pair: -max(abs(extreme.own) for extreme in pair))[:_MAX_LISTED]
    largest, by = size_of([extreme.own for extreme in reactions]), Column("of", coded=labels.numbered)
    at, unit = Column(f"at{in_unit(model.units.length)}", number=True, spare=True), in_unit(model.units.force)
    shown = Grid([Column("bearing"), at, *numbers(f"largest reaction{unit}"), by, *numbers("smallest"), by])
    names = _names(model, [high.bearing for high, _ in pairs])
    for name, (high, low) in zip(names, pairs, strict=True):
        if (high, low) in listed:
            place = point(high.bearing.at, size) if high.bearing.at else ""
            (most,), (least,) = (_cells([extreme.own], [extreme.own_width], largest) for extreme in (high, low))
            shown.add(name, place, most, labels.cell(high.combination), least, labels.cell(low.combination))
    shown.show(console)


def print_governing(
    console: Console, results: Results, estimates: Estimates | None, labels: Labels, group: str = ""
) -> None:
    """Print extreme reactions of each bearing, with reactions of the other bearings in the governing combination."""
    model, reactions = results.model, governing_reactions(results, estimates, group)
    if len(reactions) > 2 * _MAX_BEARINGS:
        _print_extreme_reactions(console, results, reactions, labels)
        bearings = f"{f'{group}, ' if group else ''}{len(reactions) // 2} bearings"
        say(console, f"{bearings}: {GOVERNING} has the largest and smallest reaction of each")
        console.print()
    if not 2 < len(reactions) <= 2 * _MAX_BEARINGS:
        return
    names = _names(model, [extreme.bearing for extreme in reactions[::2]])
    largest = size_of([extreme.reactions for extreme in reactions])
    unit = in_unit(model.units.force)
    titles = [f"{name}{unit}" for name in names]
    shown = Grid([Column("reaction"), Column("of", coded=labels.numbered), *numbers(*titles)])
    for index, extreme in enumerate(reactions):
        side = "largest" if extreme.largest else "smallest"
        cells = [*map(Text, _cells(extreme.reactions, extreme.widths, largest))]
        cells[index // 2].stylize("bold")
        shown.add(f"{side} {names[index // 2]}", labels.cell(extreme.combination), *cells)
    in_group = f" in {group}" if group else ""
    others = "with the reactions of the other bearings in that combination"
    say(console, f"largest and smallest reaction of each bearing{in_group}, {others}")
    shown.show(console, apart=True)


def _print_fields(console: Console, results: Results, group: str, enveloped: Mapping[str, Any], labels: Labels) -> None:
    envelope, units = results.combined.over(group), results.model.units
    if not envelope.fields:
        return
    at = Column(f"at{in_unit(units.length)}", number=True, spare=True)
    by, widths, means = Column("of", coded=labels.numbered), enveloped["plus_minus"], list[MeanRow]()
    columns = [*numbers("largest"), at, by, *numbers("smallest"), at, by]
    shown, mesh = Grid([Column("field"), *columns], unknown=UNSETTLED), results.discretisation.mesh
    for plate, name in product(results.model.plates or ("",), envelope.layout.fields):
        field, path = on_plate(name, plate), (*(("plates", plate) if plate else ()), "fields", name)
        ends, places = envelope.field(field), envelope.places_of(field)
        most, least = (
            [cell(value, widths, (*path, side), size_of([ends.max, ends.min])), point(place.tolist(), mesh.size)]
            for side, value, place in (("max", ends.max, places[0]), ("min", ends.min, places[1]))
        )
        label = FIELDS[name].label(units)
        label = f"{plate}: {label}" if plate else label
        shown.add(label, *most, labels.cell(results.key(ends.max_by)), *least, labels.cell(results.key(ends.min_by)))
        values = (enveloped["plates"][plate] if plate else enveloped)["fields"][name]
        if name in PEAKING:
            cells: list[list[str]] = [[], []]
            for side, side_cells in zip(MEAN_SIDES, cells, strict=True):
                if values[side] is not None:
                    side_cells.append(cell(values[side], widths, (*path, side), size_of([ends.max, ends.min])))
                    side_cells += [point(values[f"{side}_at"], mesh.size), length(values[f"{side}_width"])]
                    side_cells.append(labels.cell(values[f"{side}_by"]))
            means.append((label, cells))
    shown.show(console)
    cases = frozenset(results.model.effective_combinations.cases_of(group))
    singular = {number: excluding(results.discretisation, number, cases) for number in PEAKS}
    print_means(console, singular, means, units, labels)
    console.print()


def _print_probes(console: Console, results: Results, envelope: Mapping[str, Any], labels: Labels) -> None:
    """Print the largest and smallest value of each field at each probe, with the governing combinations."""
    probes, units, widths = envelope["probes"], results.model.units, envelope["plus_minus"]
    if not probes:
        return
    if len(probes) > _MAX_PROBES:
        say(console, f"{len(probes)} probes: {JSON} has the extremes of each")
        console.print()
        return
    where = f"at{in_unit(units.length)}"
    by = Column("of", coded=labels.numbered)
    shown = Grid([Column(where), Column("field"), *numbers("largest"), by, *numbers("smallest"), by])
    for field in LINEAR:
        size = size_of([[probe[field]["max"], probe[field]["min"]] for probe in probes])
        for index, probe in enumerate(probes):
            values, path = probe[field], ("probes", index, field)
            most, least = (cell(values[end], widths, (*path, end), size, 5) for end in ("max", "min"))
            place = point(probe["at"], results.discretisation.mesh.size)
            by_most, by_least = labels.cell(values["max_by"]), labels.cell(values["min_by"])
            shown.add(place, FIELDS[field].label(units), most, by_most, least, by_least)
    shown.show(console, apart=True)


def _print_supports(console: Console, results: Results, group: str, widths: Widths, labels: Labels) -> None:
    whole, model = results.combined.over(group), results.model
    units, layout = model.units, whole.layout
    by = Column("of", coded=labels.numbered)
    columns = [Column("support"), *numbers(f"largest reaction{in_unit(units.force)}"), by]
    shown = Grid([*columns, *numbers("smallest"), by, Column("points lifted", number=True, spare=True)])
    totals = [whole[f"reaction:{support.name}"] for support in model.support]
    largest = size_of([(ends.max, ends.min) for ends in totals])
    every = list(zip(model.support, layout.supports, whole.open_in, strict=True))
    for index, ((support, points, _), ends) in enumerate(zip(every, totals, strict=True)):
        lifted = f"{int((whole.lifted_in[index] > 0).sum())} of {points.rows.shape[1]}" if points.rows.size else ""
        most = cell(ends.max, widths, (*place_of(model, index), "reaction", "max"), largest)
        least = cell(ends.min, widths, (*place_of(model, index), "reaction", "min"), largest)
        by_most, by_least = (labels.cell(results.key(row)) for row in (ends.max_by, ends.min_by))
        shown.add(support.name, most, by_most, least, by_least, lifted)
    shown.show(console, apart=True)
    _print_lines(console, results, group, widths)
    for index, (support, points, open_in) in enumerate(every):
        of_support = place_of(model, index)
        if support.place == "at" and open_in.any():
            gaps = [whole[f"gap_at:{support.name}[{number}]"] for number in range(1, len(open_in) + 1)]
            widest = int(np.where(open_in > 0, [ends.max for ends in gaps], -np.inf).argmax())
            gap = cell(gaps[widest].max, widths, (*of_support, "points", widest, "gap", "max"))
            opening = f"{gap} {units.length}".rstrip()
            where = point(points.positions[widest].tolist())
            by_gap = labels.in_sentence(results.key(gaps[widest].max_by))
            say(console, f"{support.name}: widest gap {opening} at {where} in {by_gap}")
        if (area := layout.at_rest.get(index)) is not None:
            pressed, touching = whole[f"max_pressure:{support.name}"], whole[f"contact_area:{support.name}"]
            pressure = cell(pressed.max, widths, (*of_support, "max_pressure", "max"))
            touching_cell = cell(touching.min, widths, (*of_support, "contact_area", "min"))
            highest = f"{pressure} {units.force_by_length(-2)}".rstrip()
            where = point(area.pressure_places[whole.along[index].ends[0]].tolist(), results.discretisation.mesh.size)
            extent = float(points.weights.sum())
            least = in_contact(support.name, touching_cell, touching.min, extent, "area", unit_of(units.length, 2))
            by_pressure, by_area = (labels.in_sentence(results.key(row)) for row in (pressed.max_by, touching.min_by))
            say(console, f"{support.name}: largest pressure {highest} at {where} in {by_pressure}")
            say(console, f"{least}, the smallest, in {by_area}")


def _print_lines(console: Console, results: Results, group: str, widths: Widths) -> None:
    """Print the largest and smallest reaction per length of each line support, with the governing combinations."""
    whole, model = results.combined.over(group), results.model
    lines = [(index, model.support[index].name) for index in whole.layout.lines]
    most, least = ([whole[f"{side}_per_length:{name}"] for _, name in lines] for side in SIDES)
    size = size_of([(high.max, low.min) for high, low in zip(most, least, strict=True)])
    unit, by = in_unit(model.units.force_by_length(-1)), Column("of")
    shown = Grid([Column("reaction per length"), *numbers(f"largest{unit}"), by, *numbers("smallest"), by])
    for (index, name), high, low in zip(lines, most, least, strict=True):
        of_support = place_of(model, index)
        largest = cell(high.max, widths, (*of_support, "max_per_length", "max"), size)
        smallest = cell(low.min, widths, (*of_support, "min_per_length", "min"), size)
        shown.add(name, largest, results.key(high.max_by), smallest, results.key(low.min_by))
    shown.show(console, apart=True)


def _print_enveloped(console: Console, results: Results, envelope: Mapping[str, Any], labels: Labels) -> None:
    """Print the largest and smallest forces of sections and strips, with the governing combinations."""
    units, widths, by = results.model.units, envelope["plus_minus"], Column("of", coded=labels.numbered)
    if envelope["sections"]:
        shown = Grid([Column("section"), *numbers("largest"), by, *numbers("smallest"), by])
        for quantity in THROUGH:
            ends = [section[quantity.name] for section in envelope["sections"]]
            size = size_of([[values["max"], values["min"]] for values in ends])
            for index, (section, values) in enumerate(zip(envelope["sections"], ends, strict=True)):
                path = ("sections", index, quantity.name)
                most, least = (cell(values[end], widths, (*path, end), size) for end in SIDES)
                by_most, by_least = labels.cell(values["max_by"]), labels.cell(values["min_by"])
                shown.add(f"{section['name']}, {in_title(quantity, units)}", most, by_most, least, by_least)
        shown.show(console, apart=True)
    if envelope["strips"]:
        where = f"at{in_unit(units.length)}"
        columns = [*numbers(f"largest mean {in_title(MEANS[0], units)}", where), by, *numbers("smallest", where), by]
        shown = Grid([Column("strip"), *columns])
        for index, strip in enumerate(envelope["strips"]):
            moments = [station["moment"] for station in strip["stations"]]
            size, cells = size_of([[moment["max"], moment["min"]] for moment in moments]), []
            for end in SIDES:
                values = [moment[end] for moment in moments]
                station = values.index(max(values) if end == "max" else min(values))
                strip_path = ("strips", index, "stations", station, "moment", end)
                cells += [cell(values[station], widths, strip_path, size, 5), point(strip["stations"][station]["at"])]
                cells.append(labels.cell(moments[station][f"{end}_by"]))
            shown.add(strip["name"], *cells)
        shown.show(console, apart=True)
    if punched := envelope.get("punching"):
        shown = Grid(
            [Column("column"), *numbers("largest utilisation"), by, *numbers(f"force{in_unit(units.force)}"), by]
        )
        for index, column in enumerate(punched):
            shown_ends: list[Any] = []
            for key in ("utilisation", "force"):
                value, where_in = column[key]["max"], ("punching", index, key, "max")
                shown_ends += [cell(value, widths, where_in, value), labels.cell(column[key]["max_by"])]
            shown.add(column["name"], *shown_ends)
        shown.show(console, apart=True)
