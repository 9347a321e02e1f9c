"""What a notebook shows of supports, and of a load path."""

from __future__ import annotations

import html
from collections.abc import Sequence

from signorini.model import Support, Units
from signorini.results.support_result import SupportResult
from signorini.results.support_words import symbol

_NUMBER = 'style="text-align: right"'
_WORDS = 'style="text-align: left"'


def supports_table(supports: Sequence[Support], found: Sequence[SupportResult], force: str) -> str:
    """Write a table in HTML: what kind each support is, its reaction in the unit ``force``, its points.

    Examples
    --------
    >>> supports_table([], [], "kN").count("reaction [kN]")
    1
    """
    unit = f" [{html.escape(force)}]" if force else ""
    head = (
        f"<tr><th></th><th {_WORDS}>support</th><th {_WORDS}>kind</th>"
        f"<th {_NUMBER}>reaction{unit}</th><th {_NUMBER}>closed</th><th {_NUMBER}>open</th></tr>"
    )
    rows = "".join(
        f"<tr><td {_WORDS}>{symbol(support)}</td><td {_WORDS}>{html.escape(s.name)}</td>"
        f"<td {_WORDS}>{html.escape(s.kind)}</td><td {_NUMBER}>{s.reaction:.6g}</td>"
        f"<td {_NUMBER}>{s.closed_count}</td><td {_NUMBER}>{s.open_count}</td></tr>"
        for support, s in zip(supports, found, strict=True)
    )
    return f"<table>{head}{rows}</table>"


def path_table(supports: Sequence[str], stops: Sequence[tuple[float, str, float, list[float]]], units: Units) -> str:
    """Write the stops of a load path in HTML: t, what happens, the deflection largest in size, the supports' reactions.

    Examples
    --------
    >>> from signorini.model import Units
    >>> closes = 0.5, "prop closes at [2, 2]", 0.001, [0.0]
    >>> path_table(["prop"], [closes], Units(length="m", force="kN")).count("<tr>")
    2
    """
    length, force = (f" [{html.escape(unit)}]" if unit else "" for unit in (units.length, units.force))
    titles = [f"largest deflection{length}", *(f"{html.escape(name)}{force}" for name in supports)]
    head = f"<tr><th {_NUMBER}>t</th><th {_WORDS}>event</th>"
    head += "".join(f"<th {_NUMBER}>{title}</th>" for title in titles) + "</tr>"
    rows = "".join(
        f"<tr><td {_NUMBER}>{t:.6g}</td><td {_WORDS}>{html.escape(event)}</td>"
        + "".join(f"<td {_NUMBER}>{value:.6g}</td>" for value in (largest, *reactions))
        + "</tr>"
        for t, event, largest, reactions in stops
    )
    return f"<table>{head}{rows}</table>"
