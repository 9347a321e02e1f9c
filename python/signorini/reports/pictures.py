"""Drawings of a report as pixels: model, load cases, load path."""

from __future__ import annotations

from collections.abc import Iterator

from signorini.analysis.check import Quality
from signorini.analysis.results import Results
from signorini.discretise import Discretisation
from signorini.plot.files import png_of, with_palette
from signorini.plot.picture import LoadMark
from signorini.plot.pictures import Figure, check_picture
from signorini.plot.plan import Plan
from signorini.reports.blocks import Picture, Writer
from signorini.results import marks
from signorini.results.load_path import LoadPath
from signorini.singularities.named import singularities

_MOST_CASES = 12
"""Largest number of load cases that are drawn."""


def _png(figure: Figure) -> bytes:
    return with_palette(png_of(figure))


def qualities(results: Results) -> list[str]:
    """Sentence on the quality of the mesh of each plate."""
    return [str(Quality.of(each.mesh)) for each in results.discretisation.each]


def of_model(results: Results, write: Writer) -> Iterator[Picture]:
    """Draw each plate with its mesh, zones, supports, sections and strips."""
    for name, each in _plates(results):
        figure = check_picture(
            Plan(each.mesh.points, each.mesh.elements),
            bedding=marks.bedding_panel(each),
            zones=marks.zone_marks(each),
            supports=marks.unsolved_marks(each),
            cuts=marks.cut_marks(each.model),
            edges=marks.edge_marks(each.mesh),
            singular=marks.singular_marks(singularities(each)),
            length=each.model.units.length,
        )
        yield Picture(_png(figure), write("drawn_model") + name)


def of_cases(results: Results, write: Writer) -> Iterator[Picture]:
    """Draw the loads of each load case on each plate that it acts on."""
    cases = [*results.discretisation.model.cases, *(moving.case for moving in results.discretisation.model.moving)]
    of_plates = [(name, each, marks.load_marks(each)) for name, each in _plates(results)]
    for case in [*dict.fromkeys(cases)][:_MOST_CASES]:
        for name, each, every in of_plates:
            if own := [mark for mark in every if mark.case == case]:
                yield Picture(_of_case(each, own), write("drawn_case", case=case) + name)


def _of_case(each: Discretisation, loads: list[LoadMark]) -> bytes:
    figure = check_picture(
        Plan(each.mesh.points, each.mesh.elements),
        supports=marks.unsolved_marks(each),
        loads=loads,
        totals=marks.case_totals(each),
        mesh=False,
        length=each.model.units.length,
    )
    return _png(figure)


def _plates(results: Results) -> Iterator[tuple[str, Discretisation]]:
    """Yield each plate after its name; the name of a single plate is empty."""
    plates = results.discretisation
    for name, each in zip(plates.model.plates or ("",), plates.each, strict=True):
        yield f", {name}" if name else "", each


def of_path(path: LoadPath, write: Writer) -> Picture:
    """Draw reactions and deflections over the load factor."""
    return Picture(_png(path.plot()), write("drawn_path"))
