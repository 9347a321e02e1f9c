"""Numbers, lines and tables on the terminal: broken between words, never in a number, a point or before a unit."""

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
"""Signs of a word from which on it may be broken."""
_GLUE = "\ue000"
"""Stands, while lines are broken, for a space at which none may be."""
_TOGETHER = re.compile(r"(?<=\d) (?=[^\s\d])|(?<=[±+−-]) (?=[\d?])|\[[^\[\]]{1,40}\]")
"""The space between a number and its unit, or its sign; a point, or a unit behind a title."""
_JOINT = re.compile(r"[^+:;,/_|]*[+:;,/_|]|[^+:;,/_|]+")
"""A part of a word, with the sign behind it that joins it to the next."""
_PAGE = 120
"""Signs within which rows stand side by side, also where there is no end to a line, as in a file."""
_LEAST, _SPARE = 16, 24
"""Widths that a column of words keeps where it has them, or the table is turned; and a spare one, or it is dropped."""


def say(console: Console, text: Cell, style: str = "") -> None:
    """Print a text, its lines broken between words where the console ends."""
    for line in str(text).split("\n") if isinstance(text, str) else [text]:
        for part in _broken(console, _glued(line), console.width):
            console.print(part, style=style)


def say_checked(console: Console, elements: Sequence[int], asked: bool) -> None:
    """Say what the certificate checks and what ± estimates; ``elements`` are the sizes of the meshes compared."""
    say(console, f"The certificate checks the solution of this mesh. {compared(elements, asked)}")


@dataclass(frozen=True)
class Column:
    """A column of a table."""

    title: str
    number: bool = False  # whether its cells are at the right, and never broken
    spare: bool = False  # whether it goes first where there is no room
    coded: bool = False  # whether the code before a colon stands for the cell where there is no room


def numbers(*titles: str) -> list[Column]:
    """Make columns of numbers."""
    return [Column(title, number=True) for title in titles]


@dataclass
class Grid:
    """A table of which the first ``heads`` columns say what a row is.

    Where the console is too narrow, titles and words are broken between words, then spare columns are dropped, and then
    the table is turned: its rows stand side by side, as many as there is room for.
    """

    columns: Sequence[Column]
    heads: int = 1
    rows: list[list[Text]] = field(default_factory=list)
    last_apart: bool = False
    unknown: str = ""  # what to say below where a half-width is not known

    def add(self, *cells: Cell) -> None:
        """Add a row, below all others."""
        self.rows.append([_glued(cell) for cell in cells])

    def show(self, console: Console, apart: bool = False) -> None:
        """Print a table that has rows, and below it the meaning of "± ?"; ``apart`` adds an empty line."""
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

    def _widths(self, kept: Sequence[int], room: int) -> list[int] | None:
        """Widths of columns in so much room, the widest of them narrowed first; None where it is too little."""
        titles = [_glued(self.columns[index].title) for index in kept]
        widths, least = [], []
        for title, index in zip(titles, kept, strict=True):
            whole = [row[index] for row in self.rows]
            widths.append(max(cell.cell_len for cell in (title, *whole)))
            column = self.columns[index]
            needed = (cell.cell_len if column.number else _longest_word(cell) for cell in whole)
            wanted = 0 if column.number else min(widths[-1], _SPARE if column.spare else _LEAST)
            least.append(max([wanted, _longest_word(title), *needed]))
        excess = sum(widths) + len(_GAP) * (len(kept) - 1) - room
        if sum(least) + len(_GAP) * (len(kept) - 1) > room:
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
            cells = [_broken(console, cell, width) for cell, width in zip(row, widths, strict=True)]
            for level in range(max(map(len, cells))):
                console.print(_line(columns, widths, [cell[level] if level < len(cell) else Text() for cell in cells]))

    def show_turned(self, console: Console) -> None:
        """Print it with its rows side by side, as many as there is room for."""
        room = min(console.width, _PAGE)
        first = Text(" ").join(_glued(column.title) for column in self.columns[: self.heads] if column.title)
        heads = [Text(" ").join(cell for cell in row[: self.heads] if cell) for row in self.rows]
        names = [column.title for column in self.columns[self.heads :]]
        begin = 0
        while begin < len(self.rows):
            count = len(self.rows) - begin
            while True:
                mine = self.rows[begin : begin + count]
                columns = [Column(head.plain) for head in heads[begin : begin + count]]
                part = Grid([Column(first.plain), *columns])
                for index, name in enumerate(names, start=self.heads):
                    part.add(name, *(row[index] for row in mine))
                kept = list(range(count + 1))
                widths = part._widths(kept, room)
                if widths is not None or count == 1:
                    break
                count -= 1
            if begin:
                console.print()
            part._print(console, kept, widths or [room // 2 - len(_GAP)] * 2)
            begin += count


def _glued(cell: Cell) -> Text:
    """Put glue where no line may be broken."""
    text = Text(cell) if isinstance(cell, str) else cell.copy()
    text.plain = _TOGETHER.sub(lambda result: result[0].replace(" ", _GLUE), text.plain)
    return text


def _longest_word(text: Text) -> int:
    return min(max(map(cell_len, text.plain.split(" ")), default=0), _LONGEST_WORD)


def _filled(word: str, width: int) -> str:
    """Divide a word into parts that fit a line, each as long as it may be.

    Examples
    --------
    >>> _filled("ULS:1.35G1+1.35G2+1.5Q", 12)
    'ULS:1.35G1+ 1.35G2+1.5Q'
    """
    parts = [""]
    for piece in _JOINT.findall(word):
        if parts[-1] and len(parts[-1]) + len(piece) > width:
            parts.append("")
        parts[-1] += piece
    return " ".join(parts)


def _broken(console: Console, text: Text, width: int) -> list[Text]:
    """Break a glued text into lines, words that are longer than a line behind signs that join their parts."""
    if max(map(cell_len, text.plain.split(" "))) > width:
        text = text.copy()
        text.plain = " ".join(_filled(word, width) for word in text.plain.split(" "))
    lines = list(text.wrap(console, width))
    for line in lines:
        line.plain = line.plain.replace(_GLUE, " ")
        line.rstrip()
    return lines or [Text()]


def _line(columns: Iterable[Column], widths: Iterable[int], cells: Iterable[Text]) -> Text:
    """Put cells beside each other."""
    result = []
    for column, width, cell in zip(columns, widths, cells, strict=True):
        space = " " * (width - cell.cell_len)
        result.append(Text.assemble(space, cell) if column.number else Text.assemble(cell, space))
    line = Text(_GAP).join(result)
    line.rstrip()
    return line


UNKNOWN = "± ?"
UNSETTLED = f"{UNKNOWN}: does not settle from mesh to mesh, near what is named below as singular or unresolved"


def cell(
    value: float, widths: Mapping[str, Any] | None, path: Sequence[str | int], largest: float = 0.0, digits: int = 6
) -> str:
    """Write a number, with its half-width where there are any."""
    if widths is None:
        return number(value, largest, digits)
    result: Any = widths
    for part in path:
        result = result[part]
    return estimated(value, result, largest, digits)


def in_contact(name: str, part: str, value: float, whole: float, what: str, unit: str) -> str:
    """Say on which part of its length or area a support holds."""
    if not whole:
        return f"{name}: others hold the plate all over it"
    return f"{name}: in contact on {min(100.0, 100.0 * value / whole):.3g} % of its {what}, {part} of {whole:.6g}{unit}"


def in_title(one: Quantity, units: Units) -> str:
    """Name a force through a section, with its unit."""
    return f"{one.name}{in_unit(one.unit(units))}"


def unit_of(length: str, power: int = 1) -> str:
    """Write a unit behind a number."""
    return f" {length}{'²' if power == 2 else ''}" if length else ""
