"""HTML of results and of load paths for notebooks: a picture, and tables of supports and other numbers."""

from __future__ import annotations

import base64
import html
import io
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from signorini.base.numbers import estimated, in_unit, number, size_of
from signorini.errors import point
from signorini.model import Support, Units
from signorini.results.drawing import draw_field
from signorini.results.state import ResultState
from signorini.results.support_result import SupportResult, symbol

_NUMBER = 'style="padding: 0 0.5em; text-align: right; white-space: nowrap"'
_WORDS = 'style="padding: 0 0.5em; text-align: left"'
_LISTED = ("sections", "strips", "checks", "punching")
"""Keys of results.json whose lists are shown as tables."""
_Row = tuple[Sequence[str], Sequence[str]]
"""Cells of one row of a table: first texts, then numbers."""
_MOST_POINTS = 20
"""Largest number of points of a support that a table lists, as in the tables that the command prints."""


def supports_table(
    supports: Sequence[Support],
    result: Sequence[SupportResult],
    units: Units,
    widths: Sequence[Mapping[str, Any]] | None = None,
) -> str:
    """Write a table of supports in HTML: kind, reaction, reactions of points, pressures of areas.

    Numbers have a ± if half-widths are known. If a support has many points, those with the largest reactions are
    listed.
    """
    areas = any(one.area is not None for one in result)
    gapped = any(support.place == "at" and not one.closed.all() for support, one in zip(supports, result, strict=True))
    titles = [f"reaction{in_unit(units.force)}", *[f"gap{in_unit(units.length)}"] * gapped, "closed", "open"]
    if areas:
        titles += [f"largest pressure{in_unit(units.force_by_length(-2))}"]
        titles += [f"in contact{in_unit(units.length and units.length + '²')}"]
    size = size_of([one.reaction for one in result] + [size_of(one.reactions) for one in result])
    rows: list[_Row] = []
    for index, (support, one) in enumerate(zip(supports, result, strict=True)):
        width = None if widths is None else widths[index]
        cells = [_written(one.reaction, width, "reaction", size), *[""] * gapped]
        cells += [str(one.closed_count), str(one.open_count)]
        if one.area is not None:
            cells += [_written(getattr(one, key), width, key) for key in ("max_pressure", "contact_area")]
        rows.append(([symbol(support), one.name, one.kind], cells))
        if support.place == "at" and len(one.reactions) > 1:
            rows += _points(one, width, size)
    return _table(["", "support", "kind"], titles, rows)


def _points(one: SupportResult, widths: Mapping[str, Any] | None, size: float) -> Iterator[_Row]:
    """Yield rows of the points of a support in their order; of many points only those with the largest reactions."""
    shown = np.sort(np.argsort(-np.abs(one.reactions), kind="stable")[:_MOST_POINTS]).tolist()
    for at in shown:
        width = None if widths is None else widths["points"][at]
        gap = "" if one.closed[at] else _written(float(one.gaps[at]), width, "gap")
        where = f"{at + 1} at {point(one.positions[at].tolist())}"
        reaction = _written(float(one.reactions[at]), width, "reaction", size)
        yield ["", where, one.states[at]], [reaction, gap]
    if left := len(one.reactions) - len(shown):
        yield ["", f"and {left} of smaller reactions", ""], []


def _table(heads: Sequence[str], titles: Sequence[str], rows: Iterable[_Row]) -> str:
    """Write a table in HTML: columns of texts with titles ``heads``, then columns of numbers with ``titles``."""

    def line(tag: str, words: Sequence[str], numbers: Sequence[str]) -> str:
        cells = [(_WORDS, text) for text in words] + [(_NUMBER, text) for text in numbers]
        cells += [(_NUMBER, "")] * (len(titles) - len(numbers))
        return f"<tr>{''.join(f'<{tag} {style}>{html.escape(text)}</{tag}>' for style, text in cells)}</tr>"

    return f"<table>{line('th', heads, titles)}{''.join(line('td', *row) for row in rows)}</table>"


def _written(value: float, widths: Mapping[str, Any] | None, key: str, size: float = 0.0) -> str:
    return number(value, size) if widths is None else estimated(value, widths[key], size)


def path_table(supports: Sequence[str], stops: Iterable[tuple[str, str, float, list[float]]], units: Units) -> str:
    """Write a table of a load path's stops in HTML: t, events, largest deflection, reactions of supports."""
    titles = [f"largest deflection{in_unit(units.length)}", *(f"{name}{in_unit(units.force)}" for name in supports)]
    rows = (([t, event], [f"{value:.6g}" for value in (most, *reactions)]) for t, event, most, reactions in stops)
    return _table(["t", "event"], titles, rows)


def picture_of(figure: Any) -> str:
    """Write a figure of matplotlib as an image in HTML."""
    file = io.BytesIO()
    figure.savefig(file, format="png")
    png = base64.b64encode(file.getvalue()).decode("ascii")
    return f'<p><img alt="picture" style="max-width: 60em; width: 100%" src="data:image/png;base64,{png}"></p>'


def _other_numbers(result: ResultState, plus_minus: Mapping[str, Any] | None) -> Iterator[str]:
    """Yield a table for each list of `_LISTED` in the result, with a row for each section, strip, check or column."""
    tables: dict[str, dict[str, dict[str, str]]] = {}
    pairs = zip(result.catalogue, result.numbers.tolist(), strict=True)
    listed = [(one, value) for one, value in pairs if one.path[0] in _LISTED and len(one.path) == 3]
    for one, value in listed:
        if not math.isnan(value):
            owner, index, key = one.path
            size = np.nanmax([abs(other) for of, other in listed if of.quantity.kind == one.quantity.kind])
            widths = None if plus_minus is None else plus_minus[str(owner)][index]
            row = tables.setdefault(str(owner), {}).setdefault(one.subject, {})
            row[one.quantity.label(result.model.units)] = _written(value, widths, str(key), float(size))
    for owner, rows in tables.items():
        titles = list(dict.fromkeys(title for row in rows.values() for title in row))
        yield _table(
            [owner], titles, (([name], [row.get(title, "") for title in titles]) for name, row in rows.items())
        )


def in_notebook(
    result: ResultState, plus_minus: Mapping[str, Any] | None, of_mesh: str, *, pictured: bool = True
) -> str:
    """Write a result as HTML, with half-widths and the text ``of_mesh`` about their meshes, if given.

    If ``pictured``, a picture of the deflection is included.
    """
    title = f"<p><b>{html.escape(result.name)}</b>: {result.status.replace('_', ' ')}</p>"
    if result.status != "solved":
        return f"{title}<p>{html.escape(result.message)}</p>"
    units, ends = result.model.units, result.extremes["deflection"]
    most = size_of([ends.min, ends.max])
    low, high = (
        number(value, most) if plus_minus is None else estimated(value, plus_minus["deflection"][side], most)
        for side, value in (("min", ends.min), ("max", ends.max))
    )
    said = [
        f"deflection {low} to {high} {units.length}".rstrip() + ", positive down",
        f"{result.method}, {result.iterations} {result.counted}; certificate {result.certificate}",
        *([of_mesh] if of_mesh else []),
        *result.warnings,
    ]
    widths = None if plus_minus is None else plus_minus["supports"]
    figures = (draw_field(one, "deflection", None, None, None).figure for one in result.members.values())
    pictures = map(picture_of, figures if pictured else ())
    tables = [supports_table(result.model.support, result.supports, units, widths), *_other_numbers(result, plus_minus)]
    return f"{title}{''.join((*pictures, *tables))}<p>{'<br>'.join(map(html.escape, said))}</p>"
