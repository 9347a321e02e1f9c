"""Tables, numbers, points and units the way the terminal shows them."""

from __future__ import annotations

from collections.abc import Sequence

from rich import box
from rich.table import Table

from signorini.model import Units


def table(*left: str, right: Sequence[str]) -> Table:
    """Make an empty table: titles of columns of words, and of columns of numbers."""
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, header_style="bold")
    for title in left:
        table.add_column(title, overflow="fold")
    for title in right:
        table.add_column(title, justify="right", overflow="fold")
    return table


def visible(text: object) -> str:
    r"""Write what would command a terminal, such as an escape in the name of a file, so that it is read instead.

    Examples
    --------
    >>> visible("slab\x1b[31m.toml: no such file.") == r"slab\x1b[31m.toml: no such file."
    True
    """
    return "".join(sign if sign.isprintable() or sign == "\n" else repr(sign)[1:-1] for sign in str(text))


def number(value: float, digits: int = 6) -> str:
    """Write a number short enough to be read."""
    # Forces in newtons pass six digits soon; an exponent would be harder to read than some more of them.
    return f"{value:.0f}" if 1e5 <= abs(value) < 1e10 else f"{value:.{digits}g}"


def point(at: Sequence[float]) -> str:
    """Write a point."""
    return f"[{', '.join(f'{value:.6g}' for value in at)}]"


def per_area(units: Units) -> str:
    """The unit of a pressure."""
    return f"{units.force}/{units.length}²" if units.force and units.length else ""


def in_unit(unit: str) -> str:
    """Write a unit behind a title."""
    return f" [{unit}]" if unit else ""


def unit_of(length: str, power: int = 1) -> str:
    """Write a unit behind a number."""
    return f" {length}{'²' if power == 2 else ''}" if length else ""
