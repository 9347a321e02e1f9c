"""Draw whole figures: fields of results, and models before they are solved."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes as Axes
from matplotlib.collections import PatchCollection, PathCollection
from matplotlib.figure import Figure as Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch
from matplotlib.patheffects import withStroke

from signorini.errors import InputError
from signorini.plot.field import Scale, add_colour_bar, draw_field, draw_pressure
from signorini.plot.files import DOTS, as_png, png_of, with_texts
from signorini.plot.line_diagrams import line_diagrams
from signorini.plot.marks import LARGEST, Entry, draw_numbers, draw_supports, draw_zones, legend_words
from signorini.plot.model_marks import draw_balances, draw_cuts, draw_edges, draw_loads, draw_singular
from signorini.plot.page import WIDEST, Page
from signorini.plot.picture import (
    BalanceMark,
    CutMark,
    EdgeMark,
    Job,
    LoadMark,
    Panel,
    Picture,
    SingularMark,
    SupportMark,
    ZoneMark,
)
from signorini.plot.plan import (
    HATCHED,
    INK,
    Labels,
    Plan,
    draw_mesh,
    draw_outlines,
    draw_sheet,
    inches_per_unit,
    literal,
    set_window,
)
from signorini.plot.view import AXES, seen

EXCLUDED = "excluded from extremes (singular)"
_ABOVE = 18.0
"""Distance from a plan to the title above [points]; the label of an extreme at the upper edge fits in between."""
_SMALLEST_NUMBER = 2.5
"""Smallest font size of the number of a node [points]."""
_LEVEL = "#9aa6b0"
_ARROW = 0.07
"""Length of the arrows along x and y in an oblique view, relative to the width of the view."""
_MOST_NUMBERS = 5000
"""Largest number of nodes for which node numbers are drawn."""


def draw_panel(axes: Axes, plan: Plan, panel: Panel, marks: Sequence[SupportMark]) -> list[Entry]:
    """Draw a field with its colour bar, its extremes and the supports; return the legend entries."""
    set_window(axes, plan)
    return _draw_on(axes, plan, panel, _frame(axes, panel), marks)


def _frame(axes: Axes, panel: Panel, bar: Axes | None = None) -> Scale:
    """Draw the title of a panel and its colour bar; return the colour scale.

    The colour bar is drawn on the axes ``bar``; if None, on new axes beside ``axes``.
    """
    scale = Scale.of(panel)
    add_colour_bar(axes, scale, panel.label, bar)
    if panel.title:
        axes.set_title(literal(panel.title), fontsize=8.5, color=INK, pad=_ABOVE)
    return scale


def _draw_on(axes: Axes, plan: Plan, panel: Panel, scale: Scale, marks: Sequence[SupportMark]) -> list[Entry]:
    """Draw the field and extremes of a panel, and the supports; return the legend entries."""
    labels = Labels(axes)
    for mark in marks:
        if mark.style == "points" and len(mark.positions):
            labels.keep_free(mark.positions, LARGEST)
        for line in mark.boundary:
            labels.keep_free(line, 4.0)
    if panel.extremes:
        places = np.array([at for _, at in panel.extremes], dtype=float)
        labels.keep_free(places, LARGEST)
        for colour, width in (("white", 3.5), (INK, 1.2)):
            axes.plot(*places.T, "+", color=colour, markersize=6.8 + width, markeredgewidth=width, zorder=6)
        for place, (words, _) in enumerate(panel.extremes):
            labels.beside(words, places[place], 8.5, others=np.delete(places, place, axis=0))
    draw_numbers(marks, labels)
    if isinstance(panel.values, np.ndarray):
        draw_field(axes, plan, panel.values, scale, labels)
    else:
        draw_pressure(axes, plan, panel.values, scale, labels)
    excluded = _draw_excluded(axes, panel)
    return [*draw_supports(marks, axes), *_remarks(plan, hatched=isinstance(panel.values, np.ndarray)), *excluded]


def _draw_excluded(axes: Axes, panel: Panel) -> list[Entry]:
    """Hatch the discs around singular points that a panel's extremes exclude; return the legend entry, if any."""
    look: dict[str, Any] = HATCHED | {"facecolor": "none", "edgecolor": INK, "alpha": 0.6}
    discs = [Circle((x, y), radius) for x, y, radius in panel.hatched.tolist()]
    axes.add_collection(PatchCollection(discs, zorder=2.1, **look), autolim=False)
    return [(EXCLUDED, (Patch(**look),))] * bool(discs)


def _remarks(plan: Plan, hatched: bool = True) -> list[Entry]:
    """Legend entries of dashed lines, where moments and shears jump, and of hatched elements, if there are any."""
    dashed = Line2D([], [], color=INK, linewidth=0.7, linestyle="dashed")
    result: list[Entry] = [("moments and shears jump", (dashed,))] * bool(np.size(plan.edges[2].vertices))
    if hatched and plan.left_out is not None and plan.left_out.any():
        result.append(("left out of the extremes", (Patch(**HATCHED),)))
    return result


def field_picture(
    plan: Plan,
    panels: Sequence[Panel],
    marks: Sequence[SupportMark] = (),
    *,
    title: str = "",
    length: str = "",
    widest: float = WIDEST,
) -> Figure:
    """Draw fields side by side, each with the supports; the first axes of the returned figure are the plans.

    ``widest`` is the largest width of a single plan in inches.
    """
    page, scales = _page(plan, panels, length, widest=widest)
    page.finish(title, _draw_fields(page, plan, panels, scales, marks))
    return page.figure


def _page(
    plan: Plan, panels: Sequence[Panel], length: str, rows: int = 1, widest: float = WIDEST
) -> tuple[Page, list[Scale]]:
    """Make a page with the colour bars and titles of panels; return the page and the colour scale of each panel."""
    titles = any(panel.title for panel in panels)
    page = Page(plan, len(panels), length, bars=True, rows=rows, titles=titles, widest=widest)
    for label in {panel.label for panel in panels}:
        page.make_room_for_label(label)
    return page, [_frame(axes, panel, bar) for axes, panel, bar in zip(page.plans, panels, page.bars, strict=True)]


def _draw_fields(
    page: Page, plan: Plan, panels: Sequence[Panel], scales: Sequence[Scale], marks: Sequence[SupportMark]
) -> list[Entry]:
    """Draw the field of each panel with the supports; return the legend entries, which are equal for all panels."""
    entries = [_draw_on(*each, marks) for each in zip(page.plans, [plan] * len(panels), panels, scales, strict=True)]
    return entries[-1]


def drawn_as_png(plan: Plan, pictures: Sequence[Picture], length: str = "", rows: int = 1) -> Iterator[bytes]:
    """Draw pictures of several results (see `field_picture`); yield the content of a .png file for each.

    The panels of all pictures have equal labels, limits and titles: axes and colour bars are drawn once.
    """
    if not pictures:
        return
    page, scales = _page(plan, pictures[0].panels, length, rows)
    for picture in pictures:
        excluded = [EXCLUDED] * any(len(panel.hatched) for panel in picture.panels)
        remarks = [*(words for words, _ in _remarks(plan)), *excluded]
        page.make_room(picture.title, [*legend_words(picture.marks), *remarks])
    page.figure.set_dpi(DOTS)
    canvas: Any = page.canvas  # matplotlib has no type hints for the methods of a canvas
    canvas.draw()
    shared = canvas.copy_from_bbox(page.figure.bbox)
    before = set(map(id, page.artists()))
    for picture in pictures:
        canvas.restore_region(shared)
        page.finish(picture.title, _draw_fields(page, plan, picture.panels, scales, picture.marks))
        drawn = [artist for artist in page.artists() if id(artist) not in before]
        for artist in sorted(drawn, key=lambda artist: artist.get_zorder()):
            artist.draw(canvas.get_renderer())
        yield as_png(canvas)
        for artist in drawn:
            artist.remove()


def view_picture(view: Plan, level: Plan, picture: Picture) -> Figure:
    """Draw an oblique view of a deflected plate with mesh and supports, over its undeflected outline ``level``."""
    page, (scale,) = _page(view, picture.panels, "")
    (axes,) = page.plans
    axes.set_axis_off()
    look: dict[str, Any] = {"color": _LEVEL, "linewidth": 1.0}
    axes.add_collection(PathCollection(level.edges[1:2], facecolors="none", edgecolors=_LEVEL, zorder=0.5))
    draw_mesh(axes, view)
    entries = _draw_fields(page, view, picture.panels, [scale], picture.marks)
    (low, high), corner = axes.get_xlim(), view.window[0]
    for name, along in zip("xy", _ARROW * (high - low) * AXES, strict=True):
        begin = corner - [min(0.0, _ARROW * (high - low) * AXES[1, 0]), 0.0]
        axes.annotate(
            name,
            tuple(begin),
            tuple(begin + along),
            ha="center",
            va="center",
            fontsize=9,
            color=INK,
            arrowprops={"arrowstyle": "<-", "color": INK, "linewidth": 0.8, "shrinkA": 5, "shrinkB": 0},
        )
    page.finish(picture.title, [*entries, ("without deflection", (Line2D([], [], **look),))])
    return page.figure


def drawn(job: Job) -> Iterator[tuple[str, bytes]]:
    """Draw the pictures of a job; yield the name and the content of each file."""
    return ((name, with_texts(png, job.metadata)) for name, png in _drawn(job))


def _drawn(job: Job) -> Iterator[tuple[str, bytes]]:
    plan = Plan(job.points, job.elements, job.left_out)
    level = Plan(seen(job.points), job.elements)
    for sheet in job.sheets:
        if any(picture.diagrams for picture in sheet.pictures):
            for file, picture in zip(sheet.files, sheet.pictures, strict=True):
                yield file, png_of(line_diagrams(plan, picture, sheet.largest, job.length))
        elif sheet.seen:
            for file, picture, nodes in zip(sheet.files, sheet.pictures, sheet.seen, strict=True):
                yield file, png_of(view_picture(Plan(nodes, job.elements, job.left_out, level.nodes), level, picture))
        else:
            yield from zip(sheet.files, drawn_as_png(plan, sheet.pictures, job.length, sheet.rows), strict=True)


def check_picture(
    plan: Plan,
    *,
    bedding: Panel | None = None,
    zones: Iterable[ZoneMark] = (),
    supports: Sequence[SupportMark] = (),
    loads: Sequence[LoadMark] = (),
    cuts: Iterable[CutMark] = (),
    totals: Mapping[str, str] | None = None,
    edges: Iterable[EdgeMark] = (),
    singular: Sequence[SingularMark] = (),
    balance: Sequence[BalanceMark] = (),
    poorest: tuple[tuple[float, float], str] | None = None,
    title: str = "",
    length: str = "",
    mesh: bool = True,
    numbers: bool = False,
    widest: float = WIDEST,
) -> Figure:
    """Draw a model before it is solved: mesh, supports, loads with their totals, sections and strips.

    The pressure layers of ``bedding`` have the stiffness of area supports as values. ``totals`` are texts with the
    totals of load cases. ``poorest`` is the most distorted corner of an element with its text. ``numbers`` adds the
    node numbers, from 1. ``widest`` is the largest width of the plan in inches.
    """
    if numbers and len(plan.nodes) > _MOST_NUMBERS:
        raise InputError(
            f"the numbers of {len(plan.nodes)} nodes are unreadable in a picture; at most {_MOST_NUMBERS} are drawn. "
            "Remove --nodes, or use a coarser mesh."
        )
    page = Page(plan, 1, length, bars=bedding is not None, widest=widest)
    (axes,) = page.plans
    sheet = draw_sheet(axes, plan)
    if mesh:
        draw_mesh(axes, plan)
    labels = Labels(axes)
    if bedding is None:
        draw_outlines(axes, plan)
    elif not isinstance(bedding.values, np.ndarray):
        draw_pressure(axes, plan, bedding.values, _frame(axes, bedding, page.bars[0]), labels)
    for positions in [mark.positions for marks in (supports, loads) for mark in marks if mark.style == "points"]:
        labels.keep_free(positions, LARGEST)
    entries = draw_zones(zones, axes, sheet, labels) + draw_supports(supports, axes)
    draw_numbers(supports, labels)
    balances = draw_balances(balance, axes, labels)
    entries += draw_loads(loads, axes, totals or {}, sheet, labels) + draw_singular(singular, axes)
    if numbers:
        _number_nodes(axes, plan)
    entries += draw_cuts(cuts, axes, labels) + balances
    draw_edges(edges, labels)
    if poorest is not None:
        at, words = poorest
        (ring,) = axes.plot(*at, "o", markerfacecolor="none", markeredgecolor="#7a4fb5", markersize=9, zorder=6)
        entries.append((words, (ring,)))
    page.finish(title, entries)
    return page.figure


def _number_nodes(axes: Axes, plan: Plan) -> None:
    """Write the number of each node, as large as the element size allows."""
    side = float(np.hypot(*(plan.nodes[plan.cells[:, 4]] - plan.nodes[plan.cells[:, 0]]).T).min())
    size = float(np.clip(0.35 * side * inches_per_unit(axes) * 72, _SMALLEST_NUMBER, 8.0))
    halo = [withStroke(linewidth=0.3 * size, foreground="white")]
    for node in np.unique(plan.cells).tolist():
        words = axes.annotate(str(node + 1), plan.nodes[node], (0.25 * size, 0.25 * size), textcoords="offset points")
        words.set(fontsize=size, color="#0b5d8f", path_effects=halo, zorder=6.5)
