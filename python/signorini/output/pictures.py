"""Pictures of combinations: deflection, contact pressure, moments and shears."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from signorini.analysis.accuracy import ORDER
from signorini.analysis.solve import Results
from signorini.base.plain import plain
from signorini.output.names import MOMENTS, PRESSURE, REFINEMENT, SHEARS, has_areas
from signorini.results.panels import field_range, panel, support_marks, unit_of
from signorini.results.result import Result

if TYPE_CHECKING:
    from signorini.plot import Panel

_PICTURES = {"": ("deflection",), MOMENTS: ("mx", "my", "mxy"), SHEARS: ("qx", "qy"), PRESSURE: ("pressure",)}
"""Fields of a picture, by the ending of its name."""


def caption(result: Result, ending: str) -> str:
    """Title of a picture: its heading and, where they are asked for, the half-widths of the extremes that it shows."""
    widths, said = result.asked_estimate.plus_minus, list[str]()
    if widths is None:
        return result.heading
    for field in _PICTURES[ending]:
        if field == "pressure":
            every = zip(widths["supports"], result.supports, strict=True)
            told = [width["max_pressure"] for width, one in every if one.area]
        else:
            ends = widths["deflection"] if field == "deflection" else widths["fields"][field]
            told = [ends["max"], ends["min"]]
        known = [width for width in told if width is not None]
        half_width = f"± {plain(max(known), 2)} {unit_of(field, result.model.units)}".rstrip() if known else "± ?"
        said.append(half_width if len(_PICTURES[ending]) == 1 else f"{field} {half_width}")
    return f"{result.heading}, extremes {', '.join(said)}"


def write_refinement(results: Results, directory: Path) -> None:
    """Draw the meshes on the way to the accuracy that was asked for."""
    # Only this function needs matplotlib.
    from signorini.plot import refinement_picture, save

    steps, asked = results.refinement, results.model.mesh.accuracy
    if steps and asked is not None:
        dofs, worst = [step.dofs for step in steps], [step.worst for step in steps]
        save(refinement_picture(dofs, worst, asked, ORDER, results.model.title), directory / REFINEMENT)


def write_pictures(results: Results, named: Iterable[tuple[Result, str]], directory: Path) -> None:
    """Draw combinations, each field in one scale over all of a group, or over all that are in none."""
    # Only this function needs matplotlib.
    from signorini.plot import Picture, Plan, save_pictures

    found = results.discretisation
    mesh, model, nodes = found.mesh, found.model, found.stress_nodes
    combinations = model.effective_combinations
    groups = {one.name: one.group for one in combinations} if combinations.groups else {}
    drawn = [
        (result, slug, support_marks(mesh, model.support, result.supports), groups.get(result.name, ""))
        for result, slug in named
    ]
    plan = Plan.of(found.stress_nodes.points, nodes.elements)
    for ending, fields in _PICTURES.items():
        if ending == PRESSURE and not has_areas(results):
            continue
        for group in dict.fromkeys(group for *_, group in drawn):
            those = [one for one in drawn if one[3] == group]
            limits = {}
            for field in fields:
                ranges = [field_range(field, result.fields, result.supports) for result, *_ in those]
                limits[field] = min(low for low, _ in ranges), max(high for _, high in ranges)

            def panels(result: Result, limits: dict[str, tuple[float, float]] = limits) -> list[Panel]:
                parts = (nodes, result.fields, result.supports, model.units)
                return [panel(field, *parts, limit, result.extremes) for field, limit in limits.items()]

            pictures = [
                Picture(directory / f"{slug}{ending}.png", partial(panels, result), marks, caption(result, ending))
                for result, slug, marks, _ in those
            ]
            save_pictures(plan, pictures, model.units.length)
