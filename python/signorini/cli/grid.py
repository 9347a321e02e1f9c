"""Text and tables on the terminal. Lines break between words, but not within a number, a point or a unit."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from rich.cells import cell_len
from rich.console import Console
from rich.text import Text

from signorini.base.numbers import compared, estimated, in_unit, number
from signorini.model import Units
from signorini.results.quantities import Quantity

Cell = str | Text
Line = Sequence[Text]

_GAP = "   "
_LONGEST_WORD = 32
"""Words with at most this number of characters are never divided at the end of a line."""
_GLUE = "\ue000"
"""Character that temporarily replaces a space at which a line must not break."""
_UNBREAKABLE = re.compile(r"(?<=\d) (?=[^\s\d])|(?<=[±+−-]) (?=[\d?])|\[[^\[\]]{1,40}\]")
"""Pattern of text in which lines do not break: a number with its unit or sign, a point [x, y], a unit in brackets."""
_WORD_PART = re.compile(r"[^+:;,/_|]*[+:;,/_|]|[^+:;,/_|]+")
"""Pattern of a part of a word, including the separator at its end; a long word is divided into such parts."""
_PAGE = 120
"""Largest width of a transposed table [characters]; a wider terminal is not filled."""
_MIN_TEXT, _MIN_OPTIONAL = 16, 24
"""Smallest width [characters] of a text column, and of an optional column.

If the columns of a table do not fit the console, optional columns are dropped first, then the table is transposed.
"""


def say(console: Console, text: Cell, style: str = "") -> None:
    """Print a text; lines end between words at the width of the console."""
    for line in str(text).split("\n") if isinstance(text, str) else [text]:
        for part in _wrapped(console, _glued(line), console.width):
            console.print(part, style=style)


def say_checked(console: Console, elements: Sequence[int], asked: bool) -> None:
    """Print that the certificate checks one mesh, and that ± compares meshes with these numbers of elements."""
    say(console, f"The certificate checks the solution of this mesh. {compared(elements, asked)}")


@dataclass(frozen=True)
class Column:
    """A column of a printed table: its title, and how its cells are printed."""

    title: str
    number: bool = False  # whether cells are numbers: right-aligned, never wrapped
    spare: bool = False  # whether the column may be dropped if the console is too narrow
    coded: bool = False  # whether "C7: name" is cut to "C7" if the console is too narrow


def numbers(*titles: str) -> list[Column]:
    """Return a column of numbers for each title."""
    return [Column(title, number=True) for title in titles]


@dataclass
class Grid:
    """A table whose first ``heads`` columns are row headings.

    On a narrow console text is wrapped; if the table is still too wide, optional columns are dropped; if it is still
    too wide, the table is transposed in blocks of rows.
    """

    columns: Sequence[Column]
    heads: int = 1
    rows: list[list[Text]] = field(default_factory=list)
    last_apart: bool = False  # whether a line is drawn above the last row
    unknown: str = ""  # text printed below a table in which a half-width is unknown

    def add(self, *cells: Cell) -> None:
        """Append a row that consists of these cells."""
        self.rows.append([_glued(cell) for cell in cells])

    def show(self, console: Console, apart: bool = False) -> None:
        """Print the table, unless empty; then a note if the table contains "± ?", and an empty line if ``apart``."""
        if not self.rows:
            return
        self._show(console)
        if self.unknown and any(_glued(UNKNOWN).plain in cell.plain for row in self.rows for cell in row):
            say(console, self.unknown)
        if apart:
            console.print()

    def _show(self, console: Console) -> None:
        kept = list(range(len(self.columns)))
        coded = [index for index in kept if self.columns[index].coded]
        widths = self._widths(kept, console.width)
        if any(widths is None or row[index].cell_len > widths[index] for row in self.rows for index in coded):
            for row in self.rows:
                for index in coded:
                    row[index] = row[index].split(":")[0]
        while (widths := self._widths(kept, console.width)) is None:
            spare = [index for index in kept if self.columns[index].spare]
            if not spare:
                self.show_turned(console)
                return
            kept.remove(spare[-1])
        self._print(console, kept, widths)

    def _widths(self, kept: Sequence[int], width: int) -> list[int] | None:
        """Widths of the columns ``kept`` with which the table fits ``width``; None if these columns cannot fit.

        The widest column is narrowed first.
        """
        titles = [_glued(self.columns[index].title) for index in kept]
        widths, least = [], []
        for title, index in zip(titles, kept, strict=True):
            cells = [row[index] for row in self.rows]
            widths.append(max(cell.cell_len for cell in (title, *cells)))
            column = self.columns[index]
            needed = (cell.cell_len if column.number else _longest_word(cell) for cell in cells)
            wanted = 0 if column.number else min(widths[-1], _MIN_OPTIONAL if column.spare else _MIN_TEXT)
            least.append(max([wanted, _longest_word(title), *needed]))
        excess = sum(widths) + len(_GAP) * (len(kept) - 1) - width
        if sum(least) + len(_GAP) * (len(kept) - 1) > width:
            return None
        for _ in range(excess):
            widest = max((i for i in range(len(kept)) if widths[i] > least[i]), key=lambda i: widths[i] - 1e-3 * i)
            widths[widest] -= 1
        return widths

    def _print(self, console: Console, kept: Sequence[int], widths: Sequence[int]) -> None:
        columns = [self.columns[index] for index in kept]
        rule = ("─" if console.encoding.lower().startswith("utf") else "-") * (
            sum(widths) + len(_GAP) * (len(kept) - 1)
        )
        head = [_glued(Text(column.title, style="bold")) for column in columns]
        for place, row in enumerate([head, *([row[index] for index in kept] for row in self.rows)]):
            if place == 1 or (place == len(self.rows) and self.last_apart):
                console.print(rule)
            cells = [_wrapped(console, cell, width) for cell, width in zip(row, widths, strict=True)]
            for level in range(max(map(len, cells))):
                console.print(_line(columns, widths, [cell[level] if level < len(cell) else Text() for cell in cells]))

    def show_turned(self, console: Console) -> None:
        """Print the transposed table in blocks; a block has as many rows of the original table as fit side by side."""
        width = min(console.width, _PAGE)
        first = Text(" ").join(_glued(column.title) for column in self.columns[: self.heads] if column.title)
        heads = [Text(" ").join(cell for cell in row[: self.heads] if cell) for row in self.rows]
        names = [column.title for column in self.columns[self.heads :]]
        begin = 0
        while begin < len(self.rows):
            count = len(self.rows) - begin
            while True:
                rows = self.rows[begin : begin + count]
                columns = [Column(head.plain) for head in heads[begin : begin + count]]
                block = Grid([Column(first.plain), *columns])
                for index, name in enumerate(names, start=self.heads):
                    block.add(name, *(row[index] for row in rows))
                kept = list(range(count + 1))
                widths = block._widths(kept, width)
                if widths is not None or count == 1:
                    break
                count -= 1
            if begin:
                console.print()
            block._print(console, kept, widths or [width // 2 - len(_GAP)] * 2)
            begin += count


def _glued(cell: Cell) -> Text:
    """Replace each space at which a line must not break by `_GLUE`."""
    text = Text(cell) if isinstance(cell, str) else cell.copy()
    text.plain = _UNBREAKABLE.sub(lambda match: match[0].replace(" ", _GLUE), text.plain)
    return text


def _longest_word(text: Text) -> int:
    return min(max(map(cell_len, text.plain.split(" ")), default=0), _LONGEST_WORD)


def _divided(word: str, width: int) -> str:
    """Insert spaces after separators of a word, so that its parts have at most ``width`` characters if possible.

    Examples
    --------
    >>> _divided("ULS:1.35G1+1.35G2+1.5Q", 12)
    'ULS:1.35G1+ 1.35G2+1.5Q'
    """
    parts = [""]
    for piece in _WORD_PART.findall(word):
        if parts[-1] and len(parts[-1]) + len(piece) > width:
            parts.append("")
        parts[-1] += piece
    return " ".join(parts)


def _wrapped(console: Console, text: Text, width: int) -> list[Text]:
    """Wrap a text of `_glued` to ``width``; words longer than a line are divided at separators."""
    if max(map(cell_len, text.plain.split(" "))) > width:
        text = text.copy()
        text.plain = " ".join(_divided(word, width) for word in text.plain.split(" "))
    lines = list(text.wrap(console, width))
    for line in lines:
        line.plain = line.plain.replace(_GLUE, " ")
        line.rstrip()
    return lines or [Text()]


def _line(columns: Iterable[Column], widths: Iterable[int], cells: Iterable[Text]) -> Text:
    """Join the cells of a row, each padded to the width of its column."""
    padded = []
    for column, width, cell in zip(columns, widths, cells, strict=True):
        space = " " * (width - cell.cell_len)
        padded.append(Text.assemble(space, cell) if column.number else Text.assemble(cell, space))
    line = Text(_GAP).join(padded)
    line.rstrip()
    return line


UNKNOWN = "± ?"
UNSETTLED = (
    f"{UNKNOWN}: the number does not converge with the mesh, near a place listed below as singular or unresolved"
)


def cell(
    value: float, widths: Mapping[str, Any] | None, path: Sequence[str | int], largest: float = 0.0, digits: int = 6
) -> str:
    """Write a number with its half-width (±), found at ``path`` in ``widths``; without half-width if that is None."""
    if widths is None:
        return number(value, largest, digits)
    width: Any = widths
    for key in path:
        width = width[key]
    return estimated(value, width, largest, digits)


def in_contact(name: str, shown: str, value: float, total: float, measure: str, unit: str) -> str:
    """Write a sentence on the part of a support in contact: ``value`` of its length or area ``total``.

    ``shown`` is ``value`` as text with its half-width.
    """
    if not total:
        return f"{name}: the plate is held by other supports everywhere on it"
    percent = min(100.0, 100.0 * value / total)
    return f"{name}: in contact on {percent:.3g} % of its {measure}, {shown} of {total:.6g}{unit}"


def in_title(quantity: Quantity, units: Units) -> str:
    """Title of a column: name of a quantity, with its unit."""
    return f"{quantity.name}{in_unit(quantity.unit(units))}"


def unit_of(length: str, power: int = 1) -> str:
    """Unit of length to the power 1 or 2, after a space; empty if the model has no label for the unit."""
    return f" {length}{'²' if power == 2 else ''}" if length else ""
