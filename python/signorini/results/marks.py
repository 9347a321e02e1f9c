"""Content of pictures: marks of supports, loads, zones, edges and singularities of a model; panels of fields."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from signorini.base.numbers import estimated, in_unit, plain
from signorini.discretise import Discretisation
from signorini.discretise.laws import known_values, on_soil, written_at
from signorini.discretise.quadrature import area_quadrature
from signorini.discretise.rows import Bools, Floats
from signorini.equilibrium.balance import NO_FORCE
from signorini.mesh import Mesh
from signorini.model import Load, Model, Support
from signorini.model.where import Where
from signorini.model.whole import Units
from signorini.plot.picture import (
    CutMark,
    EdgeMark,
    LineDiagram,
    LoadMark,
    Panel,
    Picture,
    PressureLayer,
    SingularMark,
    SupportMark,
    ZoneMark,
)
from signorini.plot.view import seen
from signorini.results.checks import quantity_of
from signorini.results.contact_field.area_contact import AreaContact
from signorini.results.contact_field.lines import Segments, chained
from signorini.results.extremes import FieldExtremes, peak
from signorini.results.line_reactions import Line, LineReactions
from signorini.results.quantities import KINDS, PEAKING, PRESSURE
from signorini.results.state import ResultState
from signorini.results.support_points import SupportPoints
from signorini.results.support_result import SupportResult, areas_below, describe
from signorini.shapes import Polyline, Region, Ring
from signorini.shapes.tessellation import tessellate
from signorini.singularities.singularity import Singularity, away_from

_AROUND = 180
_MOST_EDGES = 40
"""Largest number of edges whose names are drawn; outlines made of chords have hundreds of edges."""
_MOST_NUMBERS = 100
"""Largest number of points of supports that are numbered in a picture."""
_SAME = 1e-9
"""Difference in x at which the two possible positions of an edge's name count as equal, relative to plate size."""
_ALONG = 200
"""Number of parts into which a drawn line is divided; each part is drawn open or closed like the nearest contact point.
"""
_SOIL = "BrBG_r"
"""Colour map for the stiffness of elastic areas."""
_BREAK = np.full((1, 2), np.nan)
_Style = Literal["points", "line", "area"]
_STYLES: dict[str, _Style] = {"at": "points", "area": "area"}


def support_mark(
    mesh: Mesh,
    support: Support,
    positions: Floats,
    closed: Bools | None = None,
    boundary: Sequence[Floats] = (),
    numbers: Sequence[str] = (),
    words: str = "",
) -> SupportMark:
    """Mark of a support with points at positions (k, 2); ``closed`` (k,) marks closed points, None before the solution.

    ``numbers`` are drawn beside the positions, ``words`` follow the support's kind in the legend.
    """
    style = _STYLES.get(support.place, "line")
    if support.fixed:
        closed = None  # a fixed support never opens, so its points have no states to draw
    counts = None if closed is None else (int(closed.sum()), int((~closed).sum()))
    places, states = positions, closed
    if support.place != "at":
        places, states = _divided(drawn(mesh, support.where)), None
        acting = ~np.isnan(places[:, 0])
        acting[acting] = on_soil(support, places[acting])
        places = np.where(acting[:, None], places, np.nan)
        if closed is not None and len(positions):
            from scipy.spatial import cKDTree

            states = closed[cKDTree(positions).query(np.nan_to_num(places))[1]]
    return SupportMark(
        support.name,
        _kind(support),
        places,
        states,
        style,
        boundary,
        support.is_compliant,
        support.has_gap,
        describe(support) + words,
        counts,
        _prints(support),
        numbers,
    )


def _numbers(supports: Sequence[Support], counts: Sequence[int]) -> list[list[str]]:
    """Names of the points of supports at points, as in tables: only the number from 1 if just one support has points.

    If there are more than a hundred points, the names are empty.
    """
    pointed = [count if one.place == "at" else 0 for one, count in zip(supports, counts, strict=True)]
    alone = sum(count > 0 for count in pointed) == 1
    names = []
    for one, count in zip(supports, pointed, strict=True):
        every = [str(n + 1) if alone else f"{one.name}[{n + 1}]" if count > 1 else one.name for n in range(count)]
        names.append(every if sum(pointed) <= _MOST_NUMBERS else [])
    return names


def _given(support: Support, positions: Floats, units: Units) -> tuple[str, list[str]]:
    """Gap, preload and tightening order of a support as text: a common text, and a text for each point."""
    same, each = "", [""] * len(positions)
    for key, kind, values in written_at(support, positions):
        unit = getattr(units, kind, "")
        words = [f", {key} {plain(float(one), 4)} {unit}".rstrip() for one in values] if np.any(values) else []
        if len(set(words)) == 1:
            same += words[0]
        elif words:
            each = [before + now for before, now in zip(each, words, strict=True)]
    return same, each


def _kind(support: Support) -> Literal["down", "up", "both", "clamped", "hinged", "symmetry"]:
    if not support.fixed:
        return support.direction
    if "w" not in support.fixed:
        return "symmetry"
    return "clamped" if "slope" in support.fixed else "hinged"


def pressure_layer(area: AreaContact, pressure: Floats | None = None) -> PressureLayer:
    """Layer of an area support's pressure, or of ``pressure``: (n,) at nodes, or (ne,) in elements if it is rigid."""
    on = area.covered > 0
    cut = tessellate(area.mesh.elements[on])
    covered = area.support.where.region
    outline = None if covered is None else _loops(covered)
    if pressure is not None:
        values = cut.interpolate(pressure) if area.support.is_elastic else pressure[on]
    else:
        values = area.element_pressure[on] if area.stiff[on].all() else area.pressing(cut)
    return PressureLayer(cut, values, area.bounds, outline)


def unsolved_marks(discretisation: Discretisation) -> list[SupportMark]:
    """Marks of the supports of a model before its solution; points are labelled with gap, preload, tightening order."""
    marks, model = [], discretisation.model
    places = [SupportPoints.of(discretisation, index).positions for index in range(len(model.support))]
    numbers = _numbers(model.support, [len(one) for one in places])
    for index, support in enumerate(model.support):
        held = (discretisation.held.support.reshape(-1, 3) == index).any(axis=1)
        springs, contacts = discretisation.springs, discretisation.contacts
        positions = [discretisation.mesh.points[held], springs.positions[springs.support == index]]
        positions.append(contacts.positions[contacts.support == index])
        every = places[index] if support.place == "at" else np.unique(np.concatenate(positions), axis=0)
        words, each = _given(support, places[index], model.units) if support.place == "at" else ("", [])
        named = [name + of for name, of in zip(numbers[index], each, strict=False)]
        marks.append(support_mark(discretisation.mesh, support, every, numbers=named, words=words))
    columns = discretisation.columns.columns
    return marks + perimeter_marks([line for one in columns for line in one.drawn(one.check.basic.pieces)])


def bedding_panel(discretisation: Discretisation) -> Panel | None:
    """Panel of the stiffness of areas whose stiffness varies in x and y; None without such areas."""
    mesh, model = discretisation.mesh, discretisation.model
    layers, known = [], []
    for support in model.support:
        if support.place != "area" or support.modulus is None or support.modulus.is_constant:
            continue
        region = support.where.region
        cut = tessellate(mesh.elements[np.unique(area_quadrature(mesh, region, order=1).elements)])
        values = np.nan_to_num(known_values(support.modulus, cut.interpolate(mesh.points)))
        soil = (values[cut.triangles] > 0.0).all(axis=1)
        cut = replace(cut, triangles=cut.triangles[soil], parents=cut.parents[soil])
        layers.append(PressureLayer(cut, values, (0.0, np.inf), None if region is None else _loops(region)))
        known.append(values[values > 0.0])
    if not layers:
        return None
    unit = model.units.force_by_length(-3)
    limits = float(min(map(np.min, known))), float(max(map(np.max, known)))
    return Panel(layers, limits, "stiffness of the bedding" + (f" [{unit}]" if unit else ""), _SOIL)


def zone_marks(discretisation: Discretisation) -> list[ZoneMark]:
    """Marks of the zones of a model; their properties are in the legend."""
    marks = []
    for zone in discretisation.model.zone:
        parts = ["rigid"] if zone.rigid else [] if zone.thickness is None else [f"thickness {zone.thickness.source}"]
        if (own := zone.material) is not None and own.is_elastic:
            parts.append(f"E = {own.E:.4g}" if own.E is not None else f"Ex = {own.Ex:.4g}, Ey = {own.Ey:.4g}")
        if zone.stiffness is not None:
            parts.append(f"Dx = {zone.stiffness.Dx:.4g}, Dy = {zone.stiffness.Dy:.4g}")
        if zone.modifiers is not None:
            parts += [f"{key} × {value:.4g}" for key, value in zone.modifiers if value != 1.0]
        marks.append(ZoneMark(", ".join(parts) or "as the plate", _loops(zone.region)))
    return marks


def cut_marks(model: Model) -> list[CutMark]:
    """Marks of the sections and strips of a model, as lines in the picture."""
    marks = [CutMark(section.name, np.array(section.line)) for section in model.section]
    for strip in model.strip:
        # Lines across a strip run from the strip's right to its left.
        borders = np.array(strip.across).transpose(1, 0, 2)[::-1]
        marks.append(CutMark(strip.name, np.array(strip.line), borders))
    return marks


def load_marks(discretisation: Discretisation) -> list[LoadMark]:
    """Marks of the loads of a model; name of the load case and kind of load are in the legend."""
    marks = []
    for load in discretisation.model.load:
        value = next((given for given in (load.pressure, load.force, load.line_load) if given is not None), 0.0)
        varies = not isinstance(value, float) and not value.is_constant
        sizes = np.asarray(value if isinstance(value, float) else value(*_under(discretisation.mesh, load).T))
        upward = bool(sizes.max() <= 0.0 and sizes.min() < 0.0)
        kind = "couple" if load.couple_about is not None else load.kind.replace("_", " ")
        name = kind + (" by its formula" if varies else "") + (", upward" if upward else "")
        everywhere = load.place == "area" and load.where.region is None
        style = _STYLES.get(load.place, "line")
        places = np.zeros((0, 2)) if everywhere else drawn(discretisation.mesh, load.where)
        name += " everywhere" if everywhere and not varies else ""
        words = _value(load, sizes, discretisation.model.units)
        marks.append(LoadMark(load.case, name, places, style, upward, load.couple, words, _prints(load)))
    for moving in discretisation.model.moving:
        marks.append(LoadMark(moving.case, "the way it moves", np.array(moving.line), "line"))
        wheels = moving.wheels(0.5 * moving.length)
        if moving.patch is None:
            marks.append(LoadMark(moving.case, "its wheels halfway", np.array([at for at, _, _ in wheels])))
        else:
            prints = [part for at, along, _ in wheels for part in (_BREAK, _print(at, along, moving.patch))]
            marks.append(LoadMark(moving.case, "its wheels' prints halfway", np.concatenate(prints), "area"))
    return marks


def _under(mesh: Mesh, load: Load) -> Floats:
    """Positions (k, 2) on the plate at which a load is evaluated to find its smallest and largest value."""
    if load.at is not None:
        return np.array(load.at)
    if load.place == "area" and load.where.region is None:
        return mesh.points
    places = _divided(drawn(mesh, load.where))
    if load.place == "area":
        places = np.concatenate([mesh.points[load.where.covers(mesh.points)], places])
    places = places[np.isfinite(places[:, 0])]
    return places[mesh.locate(places).inside]


def _value(load: Load, sizes: Floats, units: Units) -> str:
    """Text for the magnitude of a load with its unit; the arrow or mark of the load shows the direction."""
    unit = units.force_by_length({"pressure": -2, "line_load": -1, "force": 0}.get(load.kind, 1))
    if load.couple_about is not None:
        axes = ((axis, getattr(load.couple_about, axis)) for axis in ("x", "y"))
        text = "about " + ", ".join(f"{axis} {plain(size, 4)}" for axis, size in axes if size is not None)
    elif load.couple is not None:
        text = f"[{', '.join(plain(part, 4) for part in load.couple)}]"
    elif load.curvature is not None:
        text, unit = f"[{', '.join(plain(part, 4) for part in load.curvature)}]", units.length and f"1/{units.length}"
    elif load.self_weight:
        return ""
    else:
        ends = sizes if sizes.min() < 0.0 < sizes.max() else np.abs(sizes)
        text = " to ".join(dict.fromkeys(plain(float(end), 4) for end in (ends.min(), ends.max())))
    return f"{text} {unit}".rstrip()


def resultant_of(discretisation: Discretisation, case: str) -> tuple[float, float, float]:
    """Resultant of a load case: force, positive down, and couples (mx, my) about the plate's middle.

    A sum that is only rounding is set to 0.
    """
    weighing, motions = discretisation.cases[case].weighing, discretisation.rigid_motions
    total, most = (each.reshape(-1, 3).sum(axis=0) for each in (weighing @ motions, np.abs(weighing) @ np.abs(motions)))
    force, mx, my = np.where(np.abs(total) > NO_FORCE * most, total, 0.0).tolist()
    return force, mx, my


def case_totals(discretisation: Discretisation) -> dict[str, str]:
    """Text for the resultant of each load case without moving loads: the force or, if it is 0, the couples."""
    units, sums = discretisation.model.units, {}
    for case in dict.fromkeys(load.case for load in discretisation.model.load):
        force, *couple = resultant_of(discretisation, case)
        if force:
            sums[case] = f"{plain(abs(force), 4)} {units.force}".rstrip() + (" up" if force < 0 else " down")
        elif any(couple):
            sums[case] = f"moment [{', '.join(plain(one, 4) for one in couple)}] {units.force_by_length(1)}".rstrip()
    return sums


def edge_marks(mesh: Mesh) -> list[EdgeMark]:
    """Marks with the names of edges. A name is placed beside its edge's middle, since a load's value may be there.

    If there are too many names, the sides of holes are not named; if there are still too many, no edge is named.
    """
    wholes = {name.rpartition(" edge ")[0] or name.rpartition(" ")[0] for name in mesh.edges} & set(mesh.edges)
    names = [name for name in mesh.edges if name not in wholes]
    if len(names) > _MOST_EDGES:
        names = [name for name in mesh.edges if not any(name.startswith(f"{whole} ") for whole in wholes)]
    marks = []
    for name in names if len(names) <= _MOST_EDGES else ():
        triples = mesh.edges[name]
        before, after = (mesh.points[triples[part * len(triples) // 5]] for part in (2, 3))
        begin, half, end = (after if after[1, 0] < before[1, 0] - _SAME * mesh.size else before).tolist()
        marks.append(EdgeMark(name, (half[0], half[1]), (end[0] - begin[0], end[1] - begin[1])))
    return marks


def singular_marks(named: Sequence[Singularity]) -> list[SingularMark]:
    """Marks of singularities: their points and lines."""
    return [SingularMark(one.what, np.array(one.where), one.line, one.limited) for one in named if one.where]


def _prints(item: Support | Load) -> Floats:
    """Outlines (k, 2) of the footprints of a support's or load's points; a row of NaN is before each outline."""
    outlines = [part for shape in item.where.footprints for part in (_BREAK, _loops(shape))]
    return np.concatenate(outlines or [np.zeros((0, 2))])


def _print(at: tuple[float, float], along: tuple[float, float], patch: tuple[float, float]) -> Floats:
    """Outline (5, 2) of a rectangle with sides ``patch`` around a point; the first side has the direction ``along``."""
    corners = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * patch
    (tx, ty) = along
    return np.asarray(at + corners @ np.array([[tx, ty], [-ty, tx]]))


def drawn(mesh: Mesh, where: Where) -> Floats:
    """Vertices (k, 2) that draw ``where``: points, edges, a line, a circle or an outline; NaN rows between parts."""
    if where.points:
        return np.array(where.points)
    if where.edges:
        return np.concatenate([_chained(mesh, name) for name in where.edges])
    match where.curve:
        case Polyline(points):
            return np.array(points)
        case Ring(center, radius):
            angle = np.linspace(0.0, 2.0 * np.pi, _AROUND + 1)
            around = center + radius * np.column_stack([np.cos(angle), np.sin(angle)])
            return np.where(mesh.locate(around).inside[:, None], around, np.nan)
    return _around(mesh) if where.region is None else _loops(where.region)


def _divided(line: Floats) -> Floats:
    """Insert vertices into a polyline (k, 2), so that about `_ALONG` parts of equal length result."""
    steps = np.hypot(*np.diff(line, axis=0).T)
    longest = float(np.nansum(steps)) / _ALONG
    if not longest > 0:
        return line
    parts = [line[:1]]
    for a, b, step in zip(line[:-1], line[1:], steps, strict=True):
        count = 1 if np.isnan(step) else max(1, round(step / longest))
        parts.append(b[None] if count == 1 else a + np.arange(1, count + 1)[:, None] / count * (b - a))
    return np.concatenate(parts)


def _around(mesh: Mesh) -> Floats:
    """Outline (k, 2) of the plate and its holes; a row of NaN is before each closed curve."""
    sides = mesh.sides.reshape(-1, 3)
    _, first, uses = np.unique(sides[:, 1], return_index=True, return_counts=True)
    outer = sides[first[uses == 1]]
    pairs = np.concatenate([outer[:, :2], outer[:, 1:]])
    return np.concatenate([part for line in chained(Segments(mesh.points, pairs)) for part in (_BREAK, line)])


def _chained(mesh: Mesh, name: str) -> Floats:
    """Vertices (k, 2) of an edge of the mesh along its element sides; a row of NaN before each connected part."""
    pieces: list[Floats] = []
    last = -1
    for nodes in mesh.edges[name].tolist():
        pieces += [mesh.points[nodes[1:]]] if nodes[0] == last else [_BREAK, mesh.points[nodes]]
        last = nodes[2]
    return np.concatenate(pieces)


def _loops(shape: Region) -> Floats:
    """Closed outlines (k, 2) of a region: each ends with its first point; rows of NaN are between outlines."""
    first, *others = (np.concatenate([loop, loop[:1]]) for loop in shape.loops)
    return np.concatenate([first, *(part for loop in others for part in (_BREAK, loop))])


def support_marks(result: ResultState) -> list[SupportMark]:
    """Marks of the supports, open or closed, and of the control perimeters of columns."""
    asked, supports = result.model.support, result.supports
    numbers = _numbers(asked, [len(one.positions) for one in supports])
    marks = [
        support_mark(result.mesh, one, of_support.positions, of_support.closed, of_support.contact_boundary, own)
        for one, of_support, own in zip(asked, supports, numbers, strict=True)
    ]
    lines = [line for column in result.punching for line in column.perimeter]
    return marks + perimeter_marks(lines)


def perimeter_marks(lines: Sequence[Floats]) -> list[SupportMark]:
    """Mark of the control perimeters of columns, given as polylines (k, 2); empty without polylines."""
    places = np.concatenate([_BREAK, *(part for line in lines for part in (line, _BREAK))])
    mark = SupportMark("punching", "perimeter", places, style="line", words="control perimeters")
    return [mark] if lines else []


def view_of(picture: Picture, mesh: Mesh, deflection: Floats, factor: float) -> Picture:
    """Convert a picture of a deflection from plan to oblique view: marks and extremes move onto the deflected plate."""

    def on(places: Floats) -> Floats:
        where = mesh.locate(np.nan_to_num(places, nan=np.inf))
        here, known = np.full(len(places), np.nan), where.inside
        shapes = mesh.shape_functions(where.elements[known], where.xi[known])
        here[known] = (shapes * deflection[mesh.elements[where.elements[known]]]).sum(axis=1)
        return seen(places, here, factor)

    marks = []
    for mark in picture.marks:
        lines = [line[np.isfinite(line[:, 0])] for line in map(on, mark.boundary)]
        marks.append(replace(mark, positions=on(mark.positions), boundary=lines, footprints=on(mark.footprints)))
    panels = [
        replace(one, extremes=[(words, on(np.array([at]))[0].tolist()) for words, at in one.extremes])
        for one in picture.panels
    ]
    return Picture(panels, marks, f"{picture.title}, deflections × {plain(factor, 2)}")


def field_range(field: str, result: ResultState) -> tuple[float, float]:
    """Smallest and largest value of a field outside singular places; the range of pressures includes 0."""
    if field != PRESSURE.name:
        ends, most = _ends(field, result), drawable(result.fields[field]).max()
        return min(ends.min, most), min(ends.max, most)
    ranges = [area.range for area in areas_below(result.supports)]
    return min(low for low, _ in ranges), max(high for _, high in ranges)


def panel(
    field: str,
    result: ResultState,
    widths: Mapping[str, Any] | None = None,
    limits: tuple[float, float] | None = None,
    scale: float = 1.0,
) -> Panel:
    """Panel of a field, or of the pressure, with its extremes and, if known, their half-widths.

    Labels of the extremes have the numbers times ``scale``.
    """
    of, measured = quantity_of(result.model, field)
    label, map_of = of.label(result.model.units), KINDS[of.kind].colours
    limits = limits or field_range(field, result)
    if field == PRESSURE.name:
        areas = areas_below(result.supports)
        most = max(areas, key=lambda area: area.largest[0])
        index = next(index for index, one in enumerate(result.supports) if one.area is most)
        value, at = most.largest
        width = None if widths is None else widths["supports"][index]["max_pressure"]
        words = extreme("max", value, widths is not None, width)
        layers = [pressure_layer(area) for area in areas]
        return Panel(layers, limits, label, map_of, [(words, at.tolist())] if value > 0 else [])
    ends, values = _ends(field, result), None
    if widths is not None and field in result.extremes:
        values = widths["deflection"] if field == "deflection" else widths["fields"][field]
    largest = scale * max(abs(ends.max), abs(ends.min))
    half = {name: values and values[name] and scale * values[name] for name in ("max", "min")}
    named = [
        (extreme(name, scale * value, values is not None, half[name], largest), at)
        for name, value, at in (("max", ends.max, ends.max_at), ("min", ends.min, ends.min_at))
    ]
    hatched = discs(result.excluding(measured.singular) if measured.name in PEAKING else ())
    shown = drawable(result.stress_nodes.spread(result.fields[field]))
    return Panel(shown, limits, label, map_of, named, hatched=hatched)


def drawable(values: Floats) -> Floats:
    """Replace infinite ones of values (n,), which contours cannot show, by the largest finite value."""
    return np.where(np.isinf(values), values[np.isfinite(values)].max(initial=0.0), values)


def discs(excluded: Iterable[Singularity]) -> Floats:
    """Discs (c, 3) around singularities in which values are excluded: x, y and radius."""
    places = [(*at, one.within) for one in excluded if one.within for at in one.where]
    return np.array(places, np.float64).reshape(-1, 3)


_NONE = 1e-9
"""Smallest concentrated force that is labelled, relative to the sum of the magnitudes of the line's reactions."""


def line_diagram(
    support: SupportResult, line: LineReactions, units: Units, widths: Mapping[str, Any] | None = None
) -> LineDiagram:
    """Diagram of a support's reactions per length; the largest value of each run is labelled.

    The label has the half-width if it is known.
    """
    told, ends = widths is not None, dict[int, float | None]()
    for side, sign in (("max", 1.0), ("min", -1.0)):
        ends[peak(sign * line.reactions, line.positions)] = None if widths is None else widths[f"{side}_per_length"]
    words = []
    for station in _written_at(line.reactions, line.begins, ends):
        value = float(line.reactions[station])
        known = station in ends and told
        words.append((_written(value, known, ends.get(station)), station, value))
    of_corners = [None] * len(line.corners) if widths is None else [one["reaction"] for one in widths["corners"]]
    corners = [
        _written(force, told, width) if abs(force) > _NONE * float(np.abs(support.reactions).sum()) else ""
        for force, width in zip(line.corner_reactions.tolist(), of_corners, strict=True)
    ]
    return LineDiagram(
        *(line.positions, line.normals, line.begins, line.reactions[None], words, line.corners, corners),
        (in_unit(units.force_by_length(-1)), in_unit(units.force)),
    )


def enveloped_diagram(line: Line, ends: Floats, units: Units) -> LineDiagram:
    """Diagram of the envelope of a line; ``ends`` (2, k + c) are maxima and minima at k stations and c corners."""
    per_length, corners = ends[:, : len(line.s)], ends[:, len(line.s) :]
    begins = np.append(True, line.pieces[:-1] < 0)
    words = []
    for values, sign in zip(per_length, (1.0, -1.0), strict=True):
        most = peak(sign * values, line.positions)
        for station in _written_at(sign * values, begins, [most]):
            value = float(values[station])
            words += [(_written(value, False, None), station, value)] * (sign * value > 0.0)
    said = [" to ".join(_written(force, False, None) for force in pair) for pair in corners[::-1].T.tolist()]
    return LineDiagram(
        *(line.positions, line.normals, begins, per_length, words, line.corners, said),
        (in_unit(units.force_by_length(-1)), in_unit(units.force)),
    )


def _written_at(values: Floats, begins: Bools, ends: Iterable[int]) -> list[int]:
    """Stations at which a line's diagram is labelled: the largest magnitude of each run, and extremes ``ends`` below 0.

    A smallest value that is positive has no label, since it does not govern a design.
    """
    firsts = [*np.flatnonzero(begins).tolist(), len(values)]
    result = [a + int(np.abs(values[a:b]).argmax()) for a, b in pairwise(firsts)]
    return list(dict.fromkeys([*result, *(end for end in ends if values[end] < 0.0)]))


def extreme(name: str, value: float, told: bool, width: float | None, largest: float = 0.0) -> str:
    """Label of an extreme: its value and, if ``told``, its half-width ``width``; "± ?" if the half-width is None.

    A value that is only a rounding error of ``largest`` is written as 0.

    Examples
    --------
    >>> extreme("min", -21.3412, True, 0.25), extreme("max", 21.3412, False, None), extreme("max", 21.3412, True, None)
    ('min −21.34 ± 0.25', 'max 21.34', 'max 21.34 ± ?')
    """
    return f"{name} {_written(value, told, width, largest)}"


def _written(value: float, told: bool, width: float | None, largest: float = 0.0) -> str:
    return estimated(value, width, largest).replace("-", "−") if told else plain(value, 4)


def _ends(field: str, result: ResultState) -> FieldExtremes:
    if field in result.extremes:
        return result.extremes[field]
    nodes, measured = result.stress_nodes, quantity_of(result.model, field)[1]
    singular = result.singular if measured.name in PEAKING else ()
    away = away_from(nodes.mesh, singular, measured.singular)
    return FieldExtremes.of(result.fields[field], nodes, away, singular, measured.singular)
