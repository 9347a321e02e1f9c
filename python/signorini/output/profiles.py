"""Profiles as a table and as pictures."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from signorini.analysis.results import Results
from signorini.output.cells import name_cell
from signorini.output.names import Pictures, profile_pictures, profiled
from signorini.results.panels import quantity
from signorini.results.profile_result import PRESSURE
from signorini.results.quantities import FIELDS, RESULTANTS

_SHOWN = ("deflection", *RESULTANTS, PRESSURE)


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


def draw_profiles(results: Results, directory: Path, pictures: Pictures = None) -> None:
    """Draw every profile, a picture each, with a curve for each combination."""
    # Only this function needs matplotlib.
    from signorini.plot import profile_picture, save

    units, shown = results.model.units, profiled(results, pictures)
    for profile, file in zip(results.model.profile, profile_pictures(results.model), strict=True) if shown else ():
        curves = {one.name: one.profiles[profile.name] for one in shown}
        panels = {quantity(name, units): {key: one.values[name] for key, one in curves.items()} for name in _SHOWN}
        distance = next(iter(curves.values())).distance
        along = f"{profile.name} [{units.length}]" if units.length else profile.name
        save(profile_picture(distance, panels, along, results.model.title), directory / file)
