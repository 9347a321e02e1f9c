"""Pictures of combinations: deflection, contact pressure, moments and shears."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from signorini.analysis.accuracy import ORDER
from signorini.analysis.solve import Results
from signorini.output.names import MOMENTS, PRESSURE, REFINEMENT, SHEARS, has_areas
from signorini.results.panels import field_range, panel, support_marks
from signorini.results.result import Result

if TYPE_CHECKING:
    from signorini.plot import Panel

_PICTURES = {"": ("deflection",), MOMENTS: ("mx", "my", "mxy"), SHEARS: ("qx", "qy"), PRESSURE: ("pressure",)}
"""Fields of a picture, by the ending of its name."""


def caption(result: Result, ending: str) -> str:
    """Title of a picture: its heading and, where they are known, the half-width of what it shows the extremes of."""
    widths, units = result.asked_estimate.plus_minus, result.model.units
    told, unit = list[float | None](), ""
    if widths is not None and ending == "":
        told, unit = [widths["deflection"]["max"], widths["deflection"]["min"]], units.length
    elif widths is not None and ending == PRESSURE:
        told = [
            width["max_pressure"] for width, one in zip(widths["supports"], result.supports, strict=True) if one.area
        ]
        unit = f"{units.force}/{units.length}²" if units.force and units.length else ""
    known = [width for width in told if width is not None]
    return f"{result.heading}, extremes ± {max(known):.2g} {unit}".rstrip() if known else result.heading


def write_refinement(results: Results, directory: Path) -> None:
    """Draw the meshes on the way to the accuracy that was asked for."""
    # Only this function needs matplotlib.
    from signorini.plot import refinement_picture, save

    steps, asked = results.refinement, results.model.mesh.accuracy
    if steps and asked is not None:
        dofs, worst = [step.dofs for step in steps], [step.worst for step in steps]
        save(refinement_picture(dofs, worst, asked, ORDER, results.model.title), directory / REFINEMENT)


def write_pictures(results: Results, named: Iterable[tuple[Result, str]], directory: Path) -> None:
    """Draw combinations, each field in one scale over all of them."""
    # Only this function needs matplotlib.
    from signorini.plot import Picture, Plan, save_pictures

    found = results.discretisation
    mesh, model, nodes = found.mesh, found.model, found.stress_nodes
    drawn = [(*pair, support_marks(mesh, model.support, pair[0].supports)) for pair in named]
    plan = Plan.of(found.stress_nodes.points, nodes.elements)
    for ending, fields in _PICTURES.items():
        if ending == PRESSURE and not has_areas(results):
            continue
        limits = {}
        for field in fields if drawn else ():
            ranges = [field_range(field, result.fields, result.supports) for result, *_ in drawn]
            limits[field] = min(low for low, _ in ranges), max(high for _, high in ranges)

        def panels(result: Result, limits: dict[str, tuple[float, float]] = limits) -> list[Panel]:
            parts = (nodes, result.fields, result.supports, model.units)
            return [panel(field, *parts, limit, result.extremes) for field, limit in limits.items()]

        pictures = [
            Picture(directory / f"{slug}{ending}.png", partial(panels, result), marks, caption(result, ending))
            for result, slug, marks in drawn
        ]
        save_pictures(plan, pictures, model.units.length)
