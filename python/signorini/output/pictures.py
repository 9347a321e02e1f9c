"""Pictures of combinations and of envelopes; profiles as a table and as pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from signorini.accuracy.meshes import ORDER
from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.base.numbers import in_unit
from signorini.discretise.discretisation import OfWhole
from signorini.output.names import (
    DEFORMED,
    REACTIONS,
    REFINEMENT,
    Pictures,
    csv_text,
    envelope_files,
    envelope_pictures,
    enveloped,
    lines_on,
    name_cell,
    pictured,
    pictures_of,
    profile_pictures,
    profiled,
)
from signorini.output.names import PRESSURE as PRESSURE_ENDING
from signorini.plot.picture import Job, Panel, Picture, Sheet, SupportMark
from signorini.plot.view import exaggeration, seen
from signorini.results.envelope import Envelope
from signorini.results.marks import (
    discs,
    drawable,
    enveloped_diagram,
    extreme,
    field_range,
    line_diagram,
    panel,
    pressure_layer,
    support_marks,
    unsolved_marks,
    view_of,
)
from signorini.results.quantities import KINDS, PEAKING, PICTURED, PRESSURE, RESULTANTS, SIDES, on_plate
from signorini.results.result import Result
from signorini.results.support_result import lines_below
from signorini.singularities.named import excluding

_LONGEST = 44
"""Largest number of characters of a combination's name that fit above a panel."""


def jobs_of(results: Results, estimates: Estimates | None, pictures: Pictures = None) -> list[Job]:
    """Plan the pictures of combinations and envelopes of each plate; an empty list if no picture is requested."""
    named = list(pictured(results, pictures)) if pictures != "none" else []
    jobs, plates = [], results.discretisation.members
    for number, plate in enumerate(plates):
        sheets = [*_sheets(results, estimates, named[number :: len(plates)])]
        sheets += _envelope_sheets(results, estimates, plate) if pictures != "none" else ()
        nodes = plate.own.stress_nodes
        if sheets:
            metadata, length = results.model.provenance.metadata, results.model.units.length
            jobs.append(Job(nodes.points, nodes.elements, sheets, metadata, length, nodes.left_out))
    return jobs


def write_refinement(results: Results, directory: Path) -> None:
    """Draw relative half-widths over numbers of dofs, for the meshes of a refinement to a requested accuracy."""
    steps, asked = results.refinement, results.model.mesh.accuracy
    if steps and asked is not None:
        # matplotlib is imported only when a picture is drawn.
        from signorini.plot.curves import refinement_picture
        from signorini.plot.files import save

        dofs, worst = [step.dofs for step in steps], [step.worst for step in steps]
        figure = refinement_picture(dofs, worst, asked, ORDER, results.model.title)
        save(figure, directory / REFINEMENT, results.model.provenance.metadata)


def _sheets(results: Results, estimates: Estimates | None, named: Sequence[tuple[Result, str]]) -> Iterator[Sheet]:
    """Plan the pictures of combinations; each field has the same colour scale in all combinations of a group.

    Combinations without a group also have one common scale.
    """
    combinations = results.model.effective_combinations
    groups = {one.name: one.group for one in combinations} if combinations.groups else {}
    grouped = dict[str, list[tuple[Result, str, list[SupportMark]]]]()
    for one, slug in named:
        marks = support_marks(one)
        grouped.setdefault(groups.get(one.name, ""), []).append((one, slug, marks))
    for ending, fields in pictures_of(named[0][0]).items() if named else ():
        for those in grouped.values():
            if ending == REACTIONS:
                drawn = [_diagrams(one, estimates, marks) for one, _, marks in those]
                yield Sheet([f"{slug}{ending}.png" for _, slug, _ in those], drawn)
                continue
            ranges = {field: [field_range(field, one) for one, *_ in those] for field in fields}
            limits = {field: (min(of)[0], max(high for _, high in of)) for field, of in ranges.items()}
            pictures = []
            for one, _, marks in those:
                widths = None if estimates is None else estimates[one.name].of(one).plus_minus
                panels = [panel(field, one, widths, limit) for field, limit in limits.items()]
                pictures.append(Picture(panels, marks, one.heading))
            files = [f"{slug}{ending}.png" for _, slug, _ in those]
            rows = 1 + (len(fields) > _ACROSS)
            views = ending == DEFORMED
            yield _views(files, pictures, [one for one, *_ in those]) if views else Sheet(files, pictures, rows=rows)


def _diagrams(result: Result, estimates: Estimates | None, marks: Sequence[SupportMark]) -> Picture:
    """Plan the picture of reactions per length along the lines of a plate."""
    told = None if estimates is None else estimates[result.name].of(result).plus_minus
    widths = [None] * len(result.supports) if told is None else [*told["supports"], *told.get("contacts", ())]
    pairs = zip(result.supports, widths, strict=True)
    widths_of = {support.name: width for support, width in pairs}
    units = result.model.units
    diagrams = [line_diagram(one, line, units, widths_of[one.name]) for one, line in lines_below(result.supports)]
    return Picture([], marks, result.heading, diagrams)


def _views(files: list[str], pictures: list[Picture], results: list[Result]) -> Sheet:
    """Plan pictures of deflections as oblique views with equal exaggeration."""
    mesh, nodes = results[0].mesh, results[0].stress_nodes
    factor = exaggeration(mesh.points, mesh.elements, [one.deflection for one in results])
    views = [view_of(picture, mesh, one.deflection, factor) for picture, one in zip(pictures, results, strict=True)]
    places = [seen(nodes.points, nodes.spread(one.deflection), factor) for one in results]
    return Sheet(files, views, seen=places)


def _envelope_sheets(results: Results, estimates: Estimates | None, plate: OfWhole) -> Iterator[Sheet]:
    """Plan pictures of the largest and smallest values of fields, over all combinations and over each group."""
    result = plate.own
    for (group, name_of), file in envelope_files(results).items():
        if name_of != plate.name:
            continue
        what = f"envelope of {group}" if group else f"envelope of {results.combined.solved} combinations"
        words = ", ".join(part for part in (result.model.title, what) if part)
        envelope, marks = results.combined.over(group), unsolved_marks(result)
        at_nodes = envelope.on(plate).fields
        cases = frozenset(results.model.effective_combinations.cases_of(group))
        for ending, name in envelope_pictures(results, file, name_of).items():
            if ending == REACTIONS:
                layout, both = envelope.layout, np.stack([values for values, _ in envelope.on_lines.sides])
                diagrams = [
                    enveloped_diagram(layout.lines[index], both[:, layout.on_lines[index]], results.model.units)
                    for index in lines_on(results, name_of)
                ]
                yield Sheet([name], [Picture([], marks, words, diagrams)])
                continue
            panels = []
            if ending == PRESSURE_ENDING:
                yield Sheet([name], [Picture([_largest_pressure(results, estimates, envelope)], marks, words)])
                continue
            for end, side in enumerate(("largest", "smallest")):
                for field in enveloped(results, ending):
                    of = on_plate(field, name_of)
                    ends, at = envelope.field(of), envelope.places_of(of)[end].tolist()
                    value, by = (ends.min, ends.min_by) if end else (ends.max, ends.max_by)
                    said, above = _said(results, estimates, f"{SIDES[end]}:{of}", SIDES[end], value, by)
                    shown = drawable(result.stress_nodes.spread(getattr(at_nodes[field], side)))
                    label = f"{side} {PICTURED[field].label(result.model.units)}"
                    most, singular = drawable(at_nodes[field].largest).max(), PICTURED[field].singular
                    limits = min(ends.min, most), min(ends.max, most)
                    hatched = discs(excluding(result, singular, cases) if field in PEAKING else ())
                    map_of = KINDS[PICTURED[field].kind].colours
                    panels.append(Panel(shown, limits, label, map_of, [(said, at)], above, hatched))
            yield Sheet([name], [Picture(panels, marks, words)], rows=2)


def _largest_pressure(results: Results, estimates: Estimates | None, envelope: Envelope) -> Panel:
    """Plan a panel with the largest contact pressure at every point, over the combinations of an envelope."""
    layout, model = envelope.layout, results.model
    layers, ends = [], []
    for index, area in layout.at_rest.items():
        rigid = not area.support.is_elastic
        where, of = envelope.pressures["rigid_contact_pressure" if rigid else "contact_pressure"]
        pressure = np.zeros(len(area.mesh.elements) if rigid else area.mesh.node_count)
        pressure[where] = of.largest
        layers.append(pressure_layer(area, pressure))
        along = envelope.along[index]
        most, _ = along.ends
        ends.append((float(along.largest[most]), int(along.largest_by[most]), index, area.pressure_places[most]))
    value, row, index, at = max(ends, key=lambda end: end[0])
    said, above = _said(results, estimates, f"max_pressure:{model.support[index].name}", "max", value, row)
    limits = min(0.0, *(float(layer.values.min()) for layer in layers)), value
    label = f"largest {PICTURED['pressure'].label(model.units)}"
    named = [(said, at.tolist())] if value > 0.0 else []
    return Panel(layers, limits, label, KINDS["pressure"].colours, named, above)


def _said(
    results: Results, estimates: Estimates | None, column: str, end: str, value: float, by: int
) -> tuple[str, str]:
    """Return the label and the title of an extreme, which is in ``column`` of the table at row ``by``."""
    told = estimates is not None and estimates.of_table is not None and bool(estimates.of_table.others)
    width = estimates.half_width(column, by) if told and estimates is not None else None
    name = results.key(by)
    cut = name if len(name) <= _LONGEST else f"{name[: _LONGEST - 1]}…"
    return extreme(end, value, told, width), f"{end}: {cut}"


_ACROSS = 3
"""Largest number of panels side by side in a picture."""
_PROFILED = ("deflection", *RESULTANTS, "pressure")


def profiles_csv(results: Results) -> str:
    """Return the profiles as comma-separated values: one row per combination, profile and station."""
    named = (
        ({"combination": name_cell(result.name), "profile": name_cell(one.name)}, one)
        for result in results.full.values()
        for one in result.profiles.values()
    )
    columns = ("combination", "profile", "distance", "x", "y", *PICTURED)
    return csv_text(columns, (names | row for names, one in named for row in one.rows()))


def draw_profiles(results: Results, directory: Path, pictures: Pictures = None) -> None:
    """Draw a picture of every profile, with a curve for each combination."""
    # matplotlib is imported only when a picture is drawn.
    from signorini.plot.curves import profile_picture
    from signorini.plot.files import save

    units, shown = results.model.units, profiled(results, pictures)
    for profile, file in zip(results.model.profile, profile_pictures(results.model), strict=True) if shown else ():
        curves = {one.name: one.profiles[profile.name] for one in shown if profile.name in one.profiles}
        panels = {
            PICTURED[name].label(units): {key: one.values[name] for key, one in curves.items()} for name in _PROFILED
        }
        distance = next(iter(curves.values())).distance
        along = f"{profile.name}{in_unit(units.length)}"
        upward = [PRESSURE.label(units)]
        figure = profile_picture(distance, panels, along, results.model.title, upward)
        save(figure, directory / file, results.model.provenance.metadata)
