"""What a notebook shows of supports, and of a load path."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from signorini.base.numbers import estimated, number, size_of
from signorini.errors import point
from signorini.model import Support, Units
from signorini.results.support_result import SupportResult, symbol

_NUMBER = 'style="padding: 0 0.5em; text-align: right; white-space: nowrap"'
_WORDS = 'style="padding: 0 0.5em; text-align: left"'
_MOST_POINTS = 20
"""Points of a support that are listed, as on the terminal."""


def supports_table(
    supports: Sequence[Support],
    result: Sequence[SupportResult],
    units: Units,
    widths: Sequence[Mapping[str, Any]] | None = None,
) -> str:
    """Write a table in HTML: what kind each support is, its reaction and those of its points, the pressure of areas.

    ``widths`` are the half-widths of supports as in results.json; without them no ± is shown. Of supports with many
    points those with the largest reactions are listed.

    Examples
    --------
    >>> from signorini.model import Units
    >>> supports_table([], [], Units(force="kN")).count("reaction [kN]")
    1
    """
    areas = any(one.area is not None for one in result)
    gapped = any(support.place == "at" and not one.closed.all() for support, one in zip(supports, result, strict=True))
    columns = [f"reaction{_in(units.force)}", *[f"gap{_in(units.length)}"] * gapped, "closed", "open"]
    if areas:
        columns += [
            f"largest pressure{_in(units.force_by_length(-2))}",
            f"in contact{_in(units.length and units.length + '²')}",
        ]
    head = f"<tr><th></th><th {_WORDS}>support</th><th {_WORDS}>kind</th>"
    head += "".join(f"<th {_NUMBER}>{html.escape(title)}</th>" for title in columns) + "</tr>"
    size = size_of([one.reaction for one in result] + [size_of(one.reactions) for one in result])
    lines = []
    for index, (support, one) in enumerate(zip(supports, result, strict=True)):
        width = None if widths is None else widths[index]
        cells = [_written(one.reaction, width, "reaction", size), *[""] * gapped]
        cells += [str(one.closed_count), str(one.open_count)]
        if one.area is not None:
            cells += [_written(getattr(one, key), width, key) for key in ("max_pressure", "contact_area")]
        lines.append(_line(symbol(support), one.name, one.kind, cells, len(columns)))
        if support.place == "at" and len(one.reactions) > 1:
            lines += _points(one, width, size, len(columns))
    return f"<table>{head}{''.join(lines)}</table>"


def _points(one: SupportResult, widths: Mapping[str, Any] | None, size: float, columns: int) -> list[str]:
    """Rows of the points of a support, in their order; of many the largest reactions."""
    shown = np.sort(np.argsort(-np.abs(one.reactions), kind="stable")[:_MOST_POINTS]).tolist()
    lines = []
    for at in shown:
        width = None if widths is None else widths["points"][at]
        gap = "" if one.closed[at] else _written(float(one.gaps[at]), width, "gap")
        cells = [_written(float(one.reactions[at]), width, "reaction", size), gap]
        where = f"{at + 1} at {point(one.positions[at].tolist())}"
        lines.append(_line("", where, "closed" if one.closed[at] else "open", cells, columns))
    left = len(one.reactions) - len(shown)
    return lines + [_line("", f"and {left} of smaller reactions", "", [], columns)] * (left > 0)


def _line(mark: str, name: str, kind: str, cells: Sequence[str], columns: int) -> str:
    words = "".join(f"<td {_WORDS}>{html.escape(text)}</td>" for text in (mark, name, kind))
    empty = [""] * (columns - len(cells))
    return f"<tr>{words}" + "".join(f"<td {_NUMBER}>{html.escape(text)}</td>" for text in (*cells, *empty)) + "</tr>"


def _written(value: float, widths: Mapping[str, Any] | None, key: str, size: float = 0.0) -> str:
    return number(value, size) if widths is None else estimated(value, widths[key], size)


def _in(unit: str) -> str:
    return f" [{unit}]" if unit else ""


def path_table(supports: Sequence[str], stops: Sequence[tuple[str, str, float, list[float]]], units: Units) -> str:
    """Write the stops of a load path in HTML: t, what happens, the deflection largest in size, the supports' reactions.

    Examples
    --------
    >>> from signorini.model import Units
    >>> closes = "0.5 ± 0.01", "prop: closes at [2, 2]", 0.001, [0.0]
    >>> path_table(["prop"], [closes], Units(length="m", force="kN")).count("<tr>")
    2
    """
    length, force = (f" [{html.escape(unit)}]" if unit else "" for unit in (units.length, units.force))
    titles = [f"largest deflection{length}", *(f"{html.escape(name)}{force}" for name in supports)]
    head = f"<tr><th {_NUMBER}>t</th><th {_WORDS}>event</th>"
    head += "".join(f"<th {_NUMBER}>{title}</th>" for title in titles) + "</tr>"
    rows = "".join(
        f"<tr><td {_NUMBER}>{html.escape(t)}</td><td {_WORDS}>{html.escape(event)}</td>"
        + "".join(f"<td {_NUMBER}>{value:.6g}</td>" for value in (largest, *reactions))
        + "</tr>"
        for t, event, largest, reactions in stops
    )
    return f"<table>{head}{rows}</table>"
