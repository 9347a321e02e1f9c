"""What a notebook shows of supports."""

from __future__ import annotations

import html
from collections.abc import Sequence

from signorini.kinds import symbol
from signorini.model import Support
from signorini.support_result import SupportResult

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
