"""The forces through sections and the mean moments of strips on the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rich.console import Console

from signorini.analysis.results import Results
from signorini.base.numbers import size_of
from signorini.cli.grid import Column, Grid, cell, in_unit, numbers
from signorini.errors import point
from signorini.model import Units
from signorini.results.result import Result

_KINDS = {"moment": "couple", "twist": "couple", "shear": "force"}


def print_through(
    console: Console, result: Result, widths: Mapping[str, Any] | None, largest: Mapping[str, float]
) -> None:
    """Print a row each section, and a row each strip with its largest and smallest mean moment and where they are."""
    units, size = result.model.units, result.mesh.size
    if result.sections:
        console.print()
        shown = Grid([Column("section"), *numbers(*(_summed(key, units) for key in _KINDS))])
        for index, section in enumerate(result.sections):
            cells = [
                cell(getattr(section, key), widths, ("sections", index, key), largest[kind])
                for key, kind in _KINDS.items()
            ]
            shown.add(section.name, *cells)
        shown.show(console)
    if result.strips:
        console.print()
        where = f"at{in_unit(units.length)}"
        shown = Grid([Column("strip"), *numbers(_mean(units), where, "smallest", where)])
        for index, strip in enumerate(result.strips):
            cells = []
            for key, of in (("max_moment", strip.sagging), ("min_moment", strip.hogging)):
                cells.append(cell(of.moment, widths, ("strips", index, key), largest["moment"], 5))
                cells.append(point(of.at, size))
            shown.add(strip.name, *cells)
        shown.show(console)


def print_enveloped(console: Console, results: Results, envelope: Mapping[str, Any]) -> None:
    """Print the extremes of sections and strips over many combinations, and which these are."""
    units, widths = results.model.units, envelope["plus_minus"]
    if envelope["sections"]:
        shown = Grid(
            [Column("section"), *numbers("largest"), Column("of"), *numbers("smallest"), Column("of")], heads=1
        )
        for key in _KINDS:
            size = size_of([[section[key]["max"], section[key]["min"]] for section in envelope["sections"]])
            for index, section in enumerate(envelope["sections"]):
                of, path = section[key], ("sections", index, key)
                ends = (cell(of[end], widths, (*path, end), size) for end in ("max", "min"))
                shown.add(
                    f"{section['name']}, {_summed(key, units)}", next(ends), of["max_by"], next(ends), of["min_by"]
                )
        shown.show(console)
        console.print()
    if envelope["strips"]:
        where = f"at{in_unit(units.length)}"
        columns = [*numbers(_mean(units), where), Column("of"), *numbers("smallest", where), Column("of")]
        shown = Grid([Column("strip"), *columns])
        for index, strip in enumerate(envelope["strips"]):
            moments = [station["moment"] for station in strip["stations"]]
            size, cells = size_of([[of["max"], of["min"]] for of in moments]), []
            for end in ("max", "min"):
                result = [of[end] for of in moments]
                at = result.index(max(result) if end == "max" else min(result))
                within = ("strips", index, "stations", at, "moment", end)
                cells += [cell(result[at], widths, within, size, 5), point(strip["stations"][at]["at"])]
                cells.append(moments[at][f"{end}_by"])
            shown.add(strip["name"], *cells)
        shown.show(console)
        console.print()


def _summed(key: str, units: Units) -> str:
    """Title of what is summed along a line."""
    both = f"{units.force} {units.length}" if units.force and units.length else ""
    return f"{key}{in_unit(units.force if key == 'shear' else both)}"


def _mean(units: Units) -> str:
    both = f"{units.force} {units.length}/{units.length}" if units.force and units.length else ""
    return f"largest mean moment{in_unit(both)}"
