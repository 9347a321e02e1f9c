"""Pictures of combinations: deflection, contact pressure, moments and shears."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from signorini.analysis.solve import Results
from signorini.output.names import MOMENTS, PRESSURE, SHEARS, has_areas
from signorini.results.panels import field_range, panel, support_marks
from signorini.results.result import Result

if TYPE_CHECKING:
    from signorini.plot import Panel

_PICTURES = {"": ("deflection",), MOMENTS: ("mx", "my", "mxy"), SHEARS: ("qx", "qy"), PRESSURE: ("pressure",)}
"""Fields of a picture, by the ending of its name."""


def write_pictures(results: Results, named: Iterable[tuple[Result, str]], directory: Path) -> None:
    """Draw combinations, each field in one scale over all of them."""
    # Only this function needs matplotlib.
    from signorini.plot import Picture, Plan, save_pictures

    mesh, model = results.discretisation.mesh, results.discretisation.model
    drawn = [(*pair, support_marks(mesh, model.support, pair[0].supports)) for pair in named]
    plan = Plan.of(mesh.points, mesh.elements)
    for ending, fields in _PICTURES.items():
        if ending == PRESSURE and not has_areas(results):
            continue
        limits = {}
        for field in fields if drawn else ():
            ranges = [field_range(field, result.fields, result.supports) for result, *_ in drawn]
            limits[field] = min(low for low, _ in ranges), max(high for _, high in ranges)

        def panels(result: Result, limits: dict[str, tuple[float, float]] = limits) -> list[Panel]:
            parts = (mesh, result.fields, result.supports, model.units)
            return [panel(field, *parts, limit, result.singular) for field, limit in limits.items()]

        pictures = [
            Picture(directory / f"{slug}{ending}.png", partial(panels, result), marks, result.heading)
            for result, slug, marks in drawn
        ]
        save_pictures(plan, pictures, model.units.length)
