"""What governs among many combinations, as tables."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
from rich.console import Console
from rich.text import Text

from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.base.numbers import compared, estimated, in_unit, number, size_of
from signorini.cli.grid import (
    UNSETTLED,
    Column,
    Grid,
    cell,
    in_contact,
    in_title,
    numbers,
    say,
    unit_of,
)
from signorini.contact.certificate import FIGURES
from signorini.errors import point
from signorini.output.envelope_json import envelope_json
from signorini.output.governing import governing_reactions
from signorini.output.names import GOVERNING, JSON
from signorini.results.quantities import FIELDS, LINEAR, MEANS, SIDES, THROUGH, on_plate, place_of

Widths = Mapping[str, Any] | None
"""Half-widths of an envelope, as in results.json; None where there are none."""

_MOST_NAMED = 5
"""Combinations without equilibrium that are named; the rest are in the files."""
_MOST_PROBES = 6
"""Probes of which the extremes are listed, eight rows each."""
_MOST_BEARINGS = 12
"""Bearings of which the governing reactions are listed; of more they are in a file alone."""


def print_combined(console: Console, results: Results, estimates: Estimates | None) -> None:
    """Print how many were solved, and the extremes with the combinations that they come from; of groups each apart."""
    combined, model = results.combined, results.model
    total = len(combined.combinations)
    say(console, Text(f"{total} combinations", style="bold") + Text(f": {combined.solved} solved"))
    if combined.solved < total:
        names = list(combined.unbalanced)
        more = total - combined.solved - len(names[:_MOST_NAMED])
        listed = ", ".join(names[:_MOST_NAMED]) + (f" and {more} more" if more else "")
        say(console, f"{total - combined.solved} without equilibrium: {listed}", style="bold red")
    if combined.not_unique:
        say(console, f"{combined.not_unique} not unique: the least of equal answers are given", style="yellow")
    console.print()
    for group, count in model.effective_combinations.groups.items() or (("", total),):
        if group:
            say(console, Text(group, style="bold") + Text(f": {count} combinations"))
        result = envelope_json(results, estimates, group)
        if result is None:
            say(console, "none has an equilibrium", style="bold red")
            console.print()
            continue
        _print_fields(console, results, group, result["plus_minus"])
        _print_supports(console, results, group, result["plus_minus"])
        _print_probes(console, results, result)
        _print_enveloped(console, results, result)
        print_governing(console, results, estimates, group)
    figures = ", ".join(f"{name} {combined.certificate[name]:.1e}" for name in FIGURES)
    say(console, f"worst certificate passed: {figures}")
    others = () if estimates is None or estimates.of_table is None else estimates.of_table.others
    meshes = [results.discretisation.mesh, *(mesh for _, mesh in others)] if others else []
    elements = sorted((len(mesh.elements) for mesh in meshes), reverse=True)
    say(console, f"of the equations; of the mesh: {compared(elements, model.estimated)}")
    if results.full:
        say(console, f"all results of: {', '.join(results.full)}")


def print_governing(console: Console, results: Results, estimates: Estimates | None, group: str = "") -> None:
    """Print the largest and the smallest reaction of each bearing, with those of all others in that combination."""
    model, reactions = results.model, governing_reactions(results, estimates, group)
    if len(reactions) > 2 * _MOST_BEARINGS:
        bearings = f"{f'{group}, ' if group else ''}{len(reactions) // 2} bearings"
        say(console, f"{bearings}: {GOVERNING} has the largest and smallest reaction of each")
        console.print()
    if not 2 < len(reactions) <= 2 * _MOST_BEARINGS:
        return
    points = [one.bearing.support for one in reactions[::2]]
    names = []
    for one in reactions[::2]:
        name = model.support[one.bearing.support].name
        names.append(f"{name}[{one.bearing.point}]" if points.count(one.bearing.support) > 1 else name)
    largest = size_of([one.reactions for one in reactions])
    unit = in_unit(model.units.force)
    columns = [Column("reaction"), Column("of"), *numbers(*(f"{name}{unit}" for name in names))]
    shown = Grid(columns)
    for index, one in enumerate(reactions):
        side = "largest" if one.largest else "smallest"
        told = any(width is not None for width in one.widths)
        pairs = zip(one.reactions, one.widths, strict=True)
        cells = [Text(estimated(value, width, largest) if told else number(value, largest)) for value, width in pairs]
        cells[index // 2].stylize("bold")
        shown.add(f"{side} {names[index // 2]}", one.combination, *cells)
    of = f" in {group}" if group else ""
    say(console, f"largest and smallest reaction of each bearing{of}, beside it what the others do then")
    shown.show(console)
    console.print()


def _print_fields(console: Console, results: Results, group: str, widths: Widths) -> None:
    envelope, units = results.combined.over(group), results.model.units
    if not envelope.fields:
        return
    at = Column(f"at{in_unit(units.length)}", number=True, spare=True)
    columns = [*numbers("largest"), at, Column("of"), *numbers("smallest"), at, Column("of")]
    shown, mesh = Grid([Column("field"), *columns], unknown=UNSETTLED), results.discretisation.mesh
    for plate, name in product(results.model.plates or ("",), envelope.layout.fields):
        of, path = on_plate(name, plate), (*(("plates", plate) if plate else ()), "fields", name)
        ends, places = envelope.field(of), envelope.places_of(of)
        most, least = (
            [cell(value, widths, (*path, side), size_of([ends.max, ends.min])), point(at.tolist(), mesh.size)]
            for side, value, at in (("max", ends.max, places[0]), ("min", ends.min, places[1]))
        )
        label = FIELDS[name].label(units)
        label = f"{plate}: {label}" if plate else label
        shown.add(label, *most, results.key(ends.max_by), *least, results.key(ends.min_by))
    shown.show(console)
    console.print()


def _print_probes(console: Console, results: Results, envelope: Mapping[str, Any]) -> None:
    """Print the extremes of the fields at probes, a row each, and which combinations these are of."""
    probes, units, widths = envelope["probes"], results.model.units, envelope["plus_minus"]
    if not probes:
        return
    if len(probes) > _MOST_PROBES:
        say(console, f"{len(probes)} probes: {JSON} has what is largest and smallest at each")
        console.print()
        return
    where = f"at{in_unit(units.length)}"
    shown = Grid(
        [Column(where), Column("field"), *numbers("largest"), Column("of"), *numbers("smallest"), Column("of")]
    )
    for field in LINEAR:
        size = size_of([[probe[field]["max"], probe[field]["min"]] for probe in probes])
        for index, probe in enumerate(probes):
            of, path = probe[field], ("probes", index, field)
            most, least = (cell(of[end], widths, (*path, end), size, 5) for end in ("max", "min"))
            at = point(probe["at"], results.discretisation.mesh.size)
            shown.add(at, FIELDS[field].label(units), most, of["max_by"], least, of["min_by"])
    shown.show(console)
    console.print()


def _print_supports(console: Console, results: Results, group: str, widths: Widths) -> None:
    whole, model = results.combined.over(group), results.model
    units, layout = model.units, whole.layout
    columns = [Column("support"), *numbers(f"largest reaction{in_unit(units.force)}"), Column("of")]
    shown = Grid([*columns, *numbers("smallest"), Column("of"), Column("points lifted", number=True, spare=True)])
    totals = [whole[f"reaction:{support.name}"] for support in model.support]
    largest = size_of([(ends.max, ends.min) for ends in totals])
    every = list(zip(model.support, layout.supports, whole.open_in, strict=True))
    for index, ((support, points, open_in), ends) in enumerate(zip(every, totals, strict=True)):
        lifted = f"{int((open_in > 0).sum())} of {points.rows.shape[1]}" if points.rows.size else ""
        most = cell(ends.max, widths, (*place_of(model, index), "reaction", "max"), largest)
        least = cell(ends.min, widths, (*place_of(model, index), "reaction", "min"), largest)
        shown.add(support.name, most, results.key(ends.max_by), least, results.key(ends.min_by), lifted)
    shown.show(console)
    console.print()
    _print_lines(console, results, group, widths)
    for index, (support, points, open_in) in enumerate(every):
        of_support = place_of(model, index)
        if support.place == "at" and open_in.any():
            gaps = [whole[f"gap_at:{support.name}[{number}]"] for number in range(1, len(open_in) + 1)]
            at = int(np.where(open_in > 0, [ends.max for ends in gaps], -np.inf).argmax())
            gap = cell(gaps[at].max, widths, (*of_support, "points", at, "gap", "max"))
            opening = f"{gap} {units.length}".rstrip()
            where = point(points.positions[at].tolist())
            say(console, f"{support.name}: widest gap {opening} at {where} in {results.key(gaps[at].max_by)}")
        if (area := layout.at_rest.get(index)) is not None:
            pressed, touching = whole[f"max_pressure:{support.name}"], whole[f"contact_area:{support.name}"]
            pressure = cell(pressed.max, widths, (*of_support, "max_pressure", "max"))
            touching_cell = cell(touching.min, widths, (*of_support, "contact_area", "min"))
            highest = f"{pressure} {units.force_by_length(-2)}".rstrip()
            where = point(area.pressure_places[whole.along[index].ends[0]].tolist(), results.discretisation.mesh.size)
            extent = float(points.weights.sum())
            least = in_contact(support.name, touching_cell, touching.min, extent, "area", unit_of(units.length, 2))
            say(console, f"{support.name}: largest pressure {highest} at {where} in {results.key(pressed.max_by)}")
            say(console, f"{least}, the least, in {results.key(touching.min_by)}")


def _print_lines(console: Console, results: Results, group: str, widths: Widths) -> None:
    """Print the largest and smallest reaction per length of each line, and which combinations these are of."""
    whole, model = results.combined.over(group), results.model
    lines = [(index, model.support[index].name) for index in whole.layout.lines]
    most, least = ([whole[f"{side}_per_length:{name}"] for _, name in lines] for side in SIDES)
    size = size_of([(high.max, low.min) for high, low in zip(most, least, strict=True)])
    titles = f"largest{in_unit(model.units.force_by_length(-1))}", "smallest"
    shown = Grid(
        [Column("reaction per length"), *numbers(titles[0]), Column("of"), *numbers(titles[1]), Column("of")],
    )
    for (index, name), high, low in zip(lines, most, least, strict=True):
        of_support = place_of(model, index)
        largest = cell(high.max, widths, (*of_support, "max_per_length", "max"), size)
        smallest = cell(low.min, widths, (*of_support, "min_per_length", "min"), size)
        shown.add(name, largest, results.key(high.max_by), smallest, results.key(low.min_by))
    if lines:
        shown.show(console)
        console.print()


def _print_enveloped(console: Console, results: Results, envelope: Mapping[str, Any]) -> None:
    """Print the extremes of sections and strips over many combinations, and which these are."""
    units, widths = results.model.units, envelope["plus_minus"]
    if envelope["sections"]:
        shown = Grid([Column("section"), *numbers("largest"), Column("of"), *numbers("smallest"), Column("of")])
        for one in THROUGH:
            size = size_of([[section[one.name]["max"], section[one.name]["min"]] for section in envelope["sections"]])
            for index, section in enumerate(envelope["sections"]):
                of, path = section[one.name], ("sections", index, one.name)
                most, least = (cell(of[end], widths, (*path, end), size) for end in SIDES)
                shown.add(f"{section['name']}, {in_title(one, units)}", most, of["max_by"], least, of["min_by"])
        shown.show(console)
        console.print()
    if envelope["strips"]:
        where = f"at{in_unit(units.length)}"
        columns = [
            *numbers(f"largest mean {in_title(MEANS[0], units)}", where),
            Column("of"),
            *numbers("smallest", where),
            Column("of"),
        ]
        shown = Grid([Column("strip"), *columns])
        for index, strip in enumerate(envelope["strips"]):
            moments = [station["moment"] for station in strip["stations"]]
            size, cells = size_of([[of["max"], of["min"]] for of in moments]), []
            for end in SIDES:
                result = [of[end] for of in moments]
                at = result.index(max(result) if end == "max" else min(result))
                within = ("strips", index, "stations", at, "moment", end)
                cells += [cell(result[at], widths, within, size, 5), point(strip["stations"][at]["at"])]
                cells.append(moments[at][f"{end}_by"])
            shown.add(strip["name"], *cells)
        shown.show(console)
        console.print()
