"""Profiles as a table and as pictures."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from signorini.analysis.results import Results
from signorini.output.cells import name_cell
from signorini.output.names import PROFILES, slugs
from signorini.results.panels import quantity
from signorini.results.profile_result import PRESSURE
from signorini.results.quantities import FIELDS

_PANELS = (("deflection",), ("mx", "my", "mxy"), ("qx", "qy"), (PRESSURE,))


def profiles_csv(results: Results) -> str:
    """Give the profiles as comma-separated values, a row a combination, profile and station."""
    text = io.StringIO()
    columns = ("combination", "profile", "distance", "x", "y", *FIELDS, PRESSURE)
    table = csv.DictWriter(text, columns, lineterminator="\n")
    table.writeheader()
    for result in results.full.values():
        for one in result.profiles.values():
            names = {"combination": name_cell(result.name), "profile": name_cell(one.name)}
            table.writerows(names | row for row in one.rows())
    return text.getvalue()


def draw_profiles(results: Results, directory: Path) -> None:
    """Draw the profiles of every solved combination, a picture each."""
    # Only this function needs matplotlib.
    from signorini.plot import profiles_picture, save

    units = results.model.units
    for result, slug in slugs(results):
        rows = []
        for one in result.profiles.values():
            shown = [[(name, one.values[name]) for name in names] for names in _PANELS]
            labels = [quantity(names[0], units).replace(f" {names[0]}", "") for names in _PANELS]
            rows.append((one.name, one.distance, list(zip(labels, shown, strict=True))))
        save(profiles_picture(rows, units.length, result.heading), directory / f"{slug}{PROFILES}.png")
