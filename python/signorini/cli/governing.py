"""What governs among many combinations, as tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Console
from rich.text import Text

from signorini.analysis.combinations import Combined
from signorini.cli.cells import in_unit, number, per_area, point, size_of
from signorini.cli.grid import Column, Grid, numbers, say
from signorini.contact.certificate import FIGURES
from signorini.model import Model, Units
from signorini.output.governing import Governing

_MOST_NAMED = 5
"""Combinations without equilibrium that are named; the rest are in the files."""
_MOST_BEARINGS = 12
"""Bearings of which the governing reactions are listed; of more there are supports' totals, and results.json."""


def print_combined(
    console: Console, combined: Combined, chosen: Mapping[str, object], reactions: Sequence[Governing]
) -> None:
    """Print how many were solved, and the extremes with the combinations that they come from."""
    model = combined.layout.model
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
    _print_fields(console, combined, model.units)
    _print_supports(console, combined, model.units)
    print_governing(console, model, reactions)
    figures = ", ".join(f"{name} {combined.certificate[name]:.1e}" for name in FIGURES)
    say(console, f"worst certificate passed: {figures}")
    known = "± of rows and extremes in the files" if model.estimated else "not asked, no ± (mesh.error)"
    say(console, f"of the equations; of the mesh: {known}")
    if chosen:
        say(console, f"all results of: {', '.join(chosen)}")


def print_governing(console: Console, model: Model, reactions: Sequence[Governing]) -> None:
    """Print the largest and the smallest reaction of each bearing, with those of all others in that combination."""
    if not 0 < len(reactions) <= 2 * _MOST_BEARINGS:
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
        values = (number(value, largest) for value in one.reactions)
        cells = [Text(value, style="bold" if at == index // 2 else "") for at, value in enumerate(values)]
        shown.add(f"{side} {names[index // 2]}", one.combination, *cells)
    say(console, "largest and smallest reaction of each bearing, beside it what the others do then")
    shown.show(console)
    console.print()


def _print_fields(console: Console, combined: Combined, units: Units) -> None:
    fields = combined.envelope.fields
    if not fields:
        return
    both = units.force and units.length
    moment, shear = (
        (f"{units.force} {units.length}/{units.length}", f"{units.force}/{units.length}") if both else ("", "")
    )
    of = {"deflection": units.length, "reaction": units.force} | dict.fromkeys(("qx", "qy"), shear)
    of |= dict.fromkeys(("mx", "my", "mxy"), moment)
    shown = Grid([Column("field"), *numbers("largest"), Column("of"), *numbers("smallest"), Column("of")])
    for name, (high, high_by, low, low_by) in combined.envelope.governing().items():
        if name in fields:
            title = f"{'nodal reaction' if name == 'reaction' else name}{in_unit(of.get(name, ''))}"
            size = size_of([high, low])
            names = combined.name(high_by), combined.name(low_by)
            shown.add(title, number(high, size), names[0], number(low, size), names[1])
    shown.show(console)
    console.print()


def _print_supports(console: Console, combined: Combined, units: Units) -> None:
    model, governing = combined.layout.model, combined.envelope.governing()
    columns = [Column("support"), *numbers(f"largest reaction{in_unit(units.force)}"), Column("of")]
    shown = Grid([*columns, *numbers("smallest"), Column("of"), Column("points lifted", number=True, spare=True)])
    every = list(zip(model.support, combined.envelope.supports, combined.layout.supports, strict=True))
    largest = size_of([governing[f"reaction:{index}"][::2] for index in range(len(every))])
    for index, (support, envelope, points) in enumerate(every):
        high, high_by, low, low_by = governing[f"reaction:{index}"]
        lifted = f"{int((envelope.lifted > 0).sum())} of {points.rows.shape[1]}" if points.rows.size else ""
        names = combined.name(high_by), combined.name(low_by)
        shown.add(support.name, number(high, largest), names[0], number(low, largest), names[1], lifted)
    shown.show(console)
    console.print()
    for support, envelope, points in every:
        if support.place == "at" and envelope.lifted.any():
            at = int(envelope.gap.largest.argmax())
            name = combined.name(int(envelope.gap.largest_by[at]))
            opening = f"{number(float(envelope.gap.largest[at]))} {units.length}".rstrip()
            where = point(points.positions[at].tolist())
            say(console, f"{support.name}: widest gap {opening} at {where} in {name}")
        if envelope.pressed is not None:
            highest = f"{number(float(envelope.pressed.largest[0]))} {per_area(units)}".rstrip()
            least = f"{number(float(envelope.pressed.smallest[1]))} {units.length and units.length + '²'}".rstrip()
            of_highest = combined.name(int(envelope.pressed.largest_by[0]))
            of_least = combined.name(int(envelope.pressed.smallest_by[1]))
            say(console, f"{support.name}: largest pressure {highest} in {of_highest}")
            say(console, f"{support.name}: least in contact {least} in {of_least}")
