"""Whole figures: fields of results, and models before they are solved."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from signorini.errors import InputError
from signorini.plot.balance import BalanceMark, draw_balances
from signorini.plot.cuts import CutMark, draw_cuts
from signorini.plot.field import Scale
from signorini.plot.files import DOTS, as_png
from signorini.plot.labels import Labels
from signorini.plot.loads import LoadMark, draw_loads
from signorini.plot.marks import LARGEST, Entry, ZoneMark, draw_supports, draw_zones, legend_words
from signorini.plot.page import Page
from signorini.plot.panel import draw_on, frame, remarks, scale_of
from signorini.plot.picture import Job, Panel, Picture, SupportMark
from signorini.plot.places import EdgeMark, SingularMark, draw_edges, draw_singular
from signorini.plot.plan import Plan, draw_mesh, draw_outlines, draw_sheet, inches_per_unit

_SMALLEST_NUMBER = 2.5
"""Points that a node's number is high at least."""
_MOST_NUMBERS = 5000
"""Nodes that have their numbers drawn."""


def field_picture(
    plan: Plan, panels: Sequence[Panel], marks: Sequence[SupportMark] = (), *, title: str = "", length: str = ""
) -> Figure:
    """Draw fields side by side, each with the supports, open or closed, as one figure.

    Parameters
    ----------
    plan : Plan
        The plate; one for all pictures of a run.
    panels : sequence of Panel
    marks : sequence of SupportMark
    title : str
        Wrapped to the figure's width.
    length : str
        The unit of length, for the axes.

    Returns
    -------
    Figure
        Its first axes are the plans of the panels, in their order.

    Examples
    --------
    >>> nodes = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [2, 0.5], [1, 1], [0, 0.5]]
    >>> from signorini.plot.picture import Panel
    >>> plan = Plan.of(nodes, [range(8)])
    >>> figure = field_picture(plan, [Panel(plan.nodes[:, 0], "mx [N]"), Panel(plan.nodes[:, 1], "my [N]")])
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['y', 'y', 'mx [N]', 'my [N]']
    """
    page = _page(plan, panels, length)
    scales = _frame(page, plan, panels)
    page.finish(title, _draw_fields(page, plan, panels, scales, marks))
    return page.figure


def _page(plan: Plan, panels: Sequence[Panel], length: str, rows: int = 1) -> Page:
    return Page(plan, len(panels), length, bars=True, rows=rows, titles=any(panel.title for panel in panels))


def _frame(page: Page, plan: Plan, panels: Sequence[Panel]) -> list[Scale]:
    """Draw colour bars and titles of panels, and return the scales."""
    scales = [scale_of(plan, panel) for panel in panels]
    for axes, bar, scale, panel in zip(page.plans, page.bars, scales, panels, strict=True):
        frame(axes, panel, scale, bar)
    return scales


def _draw_fields(
    page: Page, plan: Plan, panels: Sequence[Panel], scales: Sequence[Scale], marks: Sequence[SupportMark]
) -> list[Entry]:
    """Draw fields and supports, and return the entries of the legend."""
    entries: list[Entry] = []
    for axes, panel, scale in zip(page.plans, panels, scales, strict=True):
        entries = draw_on(axes, plan, panel, scale, marks)
    return entries


def drawn_as_png(plan: Plan, pictures: Sequence[Picture], length: str = "", rows: int = 1) -> Iterator[bytes]:
    """Draw pictures of one kind, of several results, as `field_picture` does, one after another.

    Their panels have the same labels, limits and titles, and are in so many rows. What they share, axes and colour
    bars, is drawn once.

    Yields
    ------
    bytes
        A .png file.
    """
    if not pictures:
        return
    page = _page(plan, first := pictures[0].panels, length, rows)
    scales = _frame(page, plan, first)
    for picture in pictures:
        page.make_room(picture.title, [*legend_words(picture.marks), *(words for words, _ in remarks(plan))])
    page.figure.set_dpi(DOTS)
    canvas: Any = page.canvas  # matplotlib leaves its methods without types
    canvas.draw()
    shared = canvas.copy_from_bbox(page.figure.bbox)
    before = set(map(id, page.artists()))
    for picture in pictures:
        canvas.restore_region(shared)
        page.finish(picture.title, _draw_fields(page, plan, picture.panels, scales, picture.marks))
        drawn = [artist for artist in page.artists() if id(artist) not in before]
        for artist in sorted(drawn, key=lambda artist: artist.get_zorder()):
            artist.draw(canvas.get_renderer())
        # Without the alpha channel, of which a page has no need, there is a fourth less to compress.
        yield as_png(np.asarray(canvas.buffer_rgba())[..., :3])
        for artist in drawn:
            artist.remove()


def drawn(job: Job) -> Iterator[tuple[str, bytes]]:
    """Draw pictures of one plate, one after another: name and content of a file."""
    plan = Plan.of(job.points, job.elements, job.left_out)
    for sheet in job.sheets:
        yield from zip(sheet.files, drawn_as_png(plan, sheet.pictures, job.length, sheet.rows), strict=True)


def check_picture(
    plan: Plan,
    *,
    zones: Iterable[ZoneMark] = (),
    supports: Iterable[SupportMark] = (),
    loads: Iterable[LoadMark] = (),
    cuts: Iterable[CutMark] = (),
    totals: Mapping[str, str] | None = None,
    edges: Iterable[EdgeMark] = (),
    singular: Sequence[SingularMark] = (),
    balance: Iterable[BalanceMark] = (),
    poorest: tuple[tuple[float, float], str] | None = None,
    title: str = "",
    length: str = "",
    numbers: bool = False,
) -> Figure:
    """Draw a model before it is solved: mesh, supports, loads and what they amount to, sections and strips.

    Parameters
    ----------
    plan : Plan
    zones : iterable of ZoneMark
    supports : iterable of SupportMark
    loads : iterable of LoadMark
    cuts : iterable of CutMark
    totals : mapping of str, optional
        The sums of load cases, in words.
    edges : iterable of EdgeMark
    singular : sequence of SingularMark
    balance : iterable of BalanceMark
    poorest : ((x, y), str), optional
        The corner of the worst element, and words about it.
    title : str
    length : str
        The unit of length, for the two axes.
    numbers : bool
        Whether to write the numbers of the nodes, from 0.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        There are too many nodes for their numbers.
    """
    if numbers and len(plan.nodes) > _MOST_NUMBERS:
        raise InputError(
            f"numbers of {len(plan.nodes)} nodes cannot be read in a picture; {_MOST_NUMBERS} is the most. Leave them "
            "out, or take a coarser mesh."
        )
    page = Page(plan, 1, length, bars=False)
    (axes,) = page.plans
    sheet = draw_sheet(axes, plan)
    draw_mesh(axes, plan)
    draw_outlines(axes, plan)
    labels, supports, loads = Labels(axes), list(supports), list(loads)
    for style, places in [(mark.style, mark.positions) for mark in supports] + [(m.style, m.positions) for m in loads]:
        if style == "points" and len(places):
            labels.keep_free(places, LARGEST)
    entries = draw_zones(zones, axes, sheet, labels) + draw_supports(supports, axes)
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
    """Write the number of every node beside it, as large as there is room."""
    side = float(np.hypot(*(plan.nodes[plan.cells[:, 4]] - plan.nodes[plan.cells[:, 0]]).T).min())
    size = float(np.clip(0.35 * side * inches_per_unit(axes) * 72, _SMALLEST_NUMBER, 8.0))
    halo = [withStroke(linewidth=0.3 * size, foreground="white")]
    for node in np.unique(plan.cells).tolist():
        words = axes.annotate(str(node), plan.nodes[node], (0.25 * size, 0.25 * size), textcoords="offset points")
        words.set(fontsize=size, color="#0b5d8f", path_effects=halo, zorder=6.5)
