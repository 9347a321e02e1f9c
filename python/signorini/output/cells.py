"""Names as cells of tables that spreadsheets read."""

from __future__ import annotations

_FORMULA = ("=", "+", "-", "@", "\t", "\r", "＝", "＋", "－", "＠", "'")
"""What a cell begins with that a spreadsheet computes (OWASP, *CSV Injection*); and our own mark."""


def name_cell(name: str) -> str:
    """Mark a name that a spreadsheet would take for a formula as text, by an apostrophe before it.

    A name that begins with an apostrophe gets one too, so that whoever reads names takes one away where there is one.
    Numbers are no names: -1 stays -1.

    Examples
    --------
    >>> [name_cell(name) for name in ("G + Q", "-W", "=1+1", "'t Huis", "")]
    ['G + Q', "'-W", "'=1+1", "''t Huis", '']
    """
    return f"'{name}" if name.startswith(_FORMULA) else name
