"""The forces through sections and the mean moments of strips on the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Console

from signorini.cli.cells import cell, in_unit, point
from signorini.cli.grid import Column, Grid, numbers
from signorini.results.result import Result


def print_through(console: Console, result: Result, largest: Mapping[str, float]) -> None:
    """Print a row each section, and a row each strip with its largest and smallest mean moment and where they are."""
    units, size, widths = result.model.units, result.mesh.size, result.asked_estimate.plus_minus
    couple = in_unit(f"{units.force} {units.length}" if units.force and units.length else "")
    if result.sections:
        console.print()
        titles = (f"moment{couple}", f"twist{couple}", f"shear{in_unit(units.force)}")
        shown = Grid([Column("section"), *numbers(*titles)])
        for index, section in enumerate(result.sections):
            parts = (("moment", "couple"), ("twist", "couple"), ("shear", "force"))
            cells = [
                cell(getattr(section, key), widths, ("sections", index, key), largest[kind]) for key, kind in parts
            ]
            shown.add(section.name, *cells)
        shown.show(console)
    if result.strips:
        console.print()
        where, per = f"at{in_unit(units.length)}", couple.replace("]", f"/{units.length}]")
        shown = Grid([Column("strip"), *numbers(f"largest mean moment{per}", where, "smallest", where)])
        for index, strip in enumerate(result.strips):
            cells = []
            for key, of in (("max_moment", strip.sagging), ("min_moment", strip.hogging)):
                cells.append(cell(of.moment, widths, ("strips", index, key), largest["moment"], 5))
                cells.append(point(of.at, size))
            shown.add(strip.name, *cells)
        shown.show(console)
