"""Drawings of a report as pixels: model, load cases, fields, reactions along walls, profiles, strips, load path."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from signorini.analysis.check import Quality
from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.base.numbers import in_unit
from signorini.discretise import Discretisation
from signorini.output.pictures import jobs_of
from signorini.plot.curves import profile_picture
from signorini.plot.files import png_of, with_palette
from signorini.plot.picture import LoadMark
from signorini.plot.pictures import Figure, check_picture, drawn
from signorini.plot.plan import Plan
from signorini.reports.blocks import Picture, Writer
from signorini.reports.names import short
from signorini.results import marks
from signorini.results.load_path import LoadPath
from signorini.results.quantities import MEANS, PICTURED, PRESSURE, RESULTANTS
from signorini.singularities.named import singularities

_MOST_CASES = 12
"""Largest number of load cases that are drawn."""
_PROFILED = ("deflection", *RESULTANTS, PRESSURE.name)


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


def of_reactions(results: Results, estimates: Estimates | None) -> Iterator[Picture]:
    """Draw reactions per length along walls."""
    walls = any(one.along_line for one in results.model.support)
    for job in jobs_of(results, estimates, "governing" if len(results) > 1 else None) if walls else ():
        sheets = [sheet for sheet in job.sheets if any(picture.diagrams for picture in sheet.pictures)]
        titles = [picture.title for sheet in sheets for picture in sheet.pictures]
        for title, (_, content) in zip(titles, drawn(replace(job, sheets=sheets, metadata={})), strict=True):
            yield Picture(with_palette(content), title)


def of_profiles(results: Results, write: Writer) -> Iterator[Picture]:
    """Draw the fields along each profile, and moment, twist and shear along each strip: a curve for a combination."""
    model, solved = results.model, [one for one in results.full.values() if one.status == "solved"]
    along_unit = in_unit(model.units.length)
    for profile in model.profile if solved else ():
        own = {short(results, one.name): one.profiles[profile.name] for one in solved if profile.name in one.profiles}
        panels = {
            write.label(PICTURED[name]): {key: one.values[name] for key, one in own.items()} for name in _PROFILED
        }
        distance = next(iter(own.values())).distance
        upward = [write.label(PRESSURE)]
        yield Picture(_png(profile_picture(distance, panels, profile.name + along_unit, "", upward)), profile.name)
    for strip in model.strip if solved else ():
        stations = {short(results, one.name): one.strips[strip.name].stations for one in solved}
        places = np.array([one.at for one in next(iter(stations.values()))])
        distance = np.concatenate([[0.0], np.hypot(*np.diff(places, axis=0).T).cumsum()])
        panels = {
            write.label(each): {
                key: np.array([getattr(one, each.name) for one in own]) for key, own in stations.items()
            }
            for each in MEANS
            if len(each.path) == 1  # the others have a value for each face
        }
        yield Picture(_png(profile_picture(distance, panels, strip.name + along_unit, "", [])), strip.name)


def of_path(path: LoadPath, write: Writer) -> Picture:
    """Draw reactions and deflections over the load factor."""
    return Picture(_png(path.plot()), write("drawn_path"))
