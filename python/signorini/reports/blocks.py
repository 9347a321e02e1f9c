"""Blocks of a report's sections, without markup: texts, tables, pictures. Templates write them as HTML."""

from __future__ import annotations

import base64
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any, ClassVar, Literal

from markupsafe import Markup

from signorini.base.numbers import estimated, in_unit, number
from signorini.base.units import steel_unit
from signorini.discretise.rows import Floats
from signorini.model import Units
from signorini.results.quantities import KINDS, Quantity

_DIGITS = 5
"""Number of significant digits of numbers without half-width."""
_FOLDED = 25
"""Largest number of rows of a table that is shown unfolded."""
_ABSENT = "–"


@dataclass(frozen=True)
class Cell:
    """A cell of a table: its text, and for numbers the value, by which the table is sorted."""

    text: str
    value: float | None = None


@dataclass(frozen=True)
class Table:
    """A table with a caption, titles of columns, and rows of cells; the first column names the row.

    If ``english``, the rows are messages of the program, which are in English in reports of every language.
    """

    block: ClassVar[str] = "table"
    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    open: bool = False
    english: bool = False

    @property
    def folded(self) -> bool:
        """Whether the table is folded: it has more than `_FOLDED` rows and is not ``open``."""
        return len(self.rows) > _FOLDED and not self.open

    @property
    def numbers(self) -> Sequence[bool]:
        """For each column, whether it has numbers, which are aligned at the right."""
        return [any(row[at].value is not None for row in self.rows) for at in range(len(self.head))]


@dataclass(frozen=True)
class Text:
    """A paragraph, a heading within a section, a message, or a text with its line breaks."""

    block: ClassVar[str] = "text"
    words: str
    kind: Literal["plain", "heading", "good", "bad", "warning", "verbatim"] = "plain"
    english: bool = False


@dataclass(frozen=True)
class Picture:
    """A picture with a caption, which is also its alternative text."""

    block: ClassVar[str] = "picture"
    content: bytes
    words: str

    @property
    def uri(self) -> str:
        """The picture as a data URI."""
        return data_uri(self.content, "image/png")


@dataclass(frozen=True)
class Label:
    """A text at the position x, y of a drawing; ``kind`` is its class in the style sheet."""

    x: float
    y: float
    words: str
    kind: str = ""


@dataclass(frozen=True)
class Drawing:
    """An SVG drawing with a caption: size, paths with their CSS classes, labels; ``legend``: CSS classes and texts.

    A diagram has ``data``: the values that are shown at the pointer.
    """

    block: ClassVar[str] = "drawing"
    words: str
    size: tuple[float, float]
    paths: Sequence[tuple[str, str]]
    labels: Sequence[Label] = ()
    data: str = ""
    legend: Sequence[tuple[str, str]] = ()

    @property
    def script(self) -> Markup:
        """Content of the HTML script element with the drawing's data."""
        return Markup(for_script(self.data))

    @property
    def kind(self) -> str:
        """CSS class of the drawing's HTML element."""
        return "diagram" if self.data else "perimeters"


@dataclass(frozen=True)
class Map:
    """An interactive map: its name, and a function that returns its markup for a largest size [bytes] of its arrays."""

    block: ClassVar[str] = "map"
    name: str
    markup: Callable[[int], str]

    @property
    def place(self) -> str:
        """HTML comment that marks the place of the map in a page; texts in a page are escaped and cannot contain it."""
        return f"<!-- {self.name} -->"


Block = Table | Text | Picture | Drawing | Map


@dataclass(frozen=True)
class Section:
    """A section of a report: key in the catalogue of texts, which is its anchor too, and its blocks."""

    key: str
    blocks: Sequence[Block]


def for_script(data: str) -> str:
    """JSON for a script element, with letters escaped so that no text can end the element."""
    for letter in "<>&\u2028\u2029":
        data = data.replace(letter, f"\\u{ord(letter):04x}")
    return data


def svg_path(points: Floats) -> str:
    """Path data of a line through points (k, 2) in CSS pixels."""
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points.tolist())


def data_uri(content: bytes, kind: str) -> str:
    """Content of a file as a data URI."""
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


def shown_in(quantity: Quantity, units: Units) -> tuple[float, str]:
    """Factor and unit in which a report writes a quantity: the model's unit, or `steel_unit` for areas of bars."""
    return steel_unit(units.length) if quantity.kind == "reinforcement" else (1.0, quantity.unit(units))


@cache
def _catalogue() -> Mapping[str, Mapping[str, Any]]:
    text = (resources.files("signorini.reports") / "texts.toml").read_text("utf-8")
    return tomllib.loads(text)


@dataclass(frozen=True)
class Writer:
    """Writes texts in one language, and numbers with units and half-widths."""

    language: str
    units: Units

    def __call__(self, key: str, **values: object) -> str:
        """Text of the catalogue texts.toml in the report's language, with values filled in."""
        return str(_catalogue()["texts"][key][self.language]).format(**values)

    def translated(self, words: str) -> str:
        """Translate the description of a quantity; words that are not in the catalogue texts.toml stay English."""
        return words if self.language == "en" else str(_catalogue()[self.language].get(words, words))

    def label(self, quantity: Quantity) -> str:
        """Description of a quantity with its unit, for the title of a column."""
        words = self.translated(quantity.words or quantity.name.replace("_", " ")).partition(", ")[0]
        return words[:1].upper() + words[1:] + in_unit(self.unit_of(quantity))

    def unit_of(self, quantity: Quantity) -> str:
        """Unit in which the report writes a quantity."""
        return shown_in(quantity, self.units)[1]

    def value(self, quantity: Quantity, value: object, width: object = ..., size: float = 0.0) -> Cell:
        """Cell with the value of a quantity, in the unit of `unit_of`."""
        return self.number(value, width, size, shown_in(quantity, self.units)[0])

    def titled(self, key: str, kind: str) -> str:
        """Text of the catalogue texts.toml, followed by the unit of a kind of quantities."""
        return self(key) + in_unit(Quantity("", kind).unit(self.units))

    def number(self, value: object, width: object = ..., size: float = 0.0, scale: float = 1.0) -> Cell:
        """Cell of a number; ``width`` is its half-width, None if unknown, ``...`` if no half-width was computed.

        The text has the number times ``scale``, the value of the cell is the number itself.
        """
        if isinstance(value, bool) or not isinstance(value, int | float):
            return Cell(_ABSENT if value is None else str(value))
        if isinstance(value, int) or not isinstance(width, int | float | None):
            text = str(value) if isinstance(value, int) else number(scale * value, scale * size, _DIGITS)
            return Cell(text, float(value))
        return Cell(estimated(scale * value, None if width is None else scale * width, scale * size), value)

    def place(self, at: object) -> Cell:
        """Cell with the coordinates [x, y] of a place."""
        if not isinstance(at, list | tuple):
            return Cell("" if at is None else str(at))
        return Cell(f"[{', '.join(f'{value:.5g}' for value in at)}]")

    def facts(self, caption: str, facts: Iterable[tuple[str, str]]) -> Table:
        """Table of two columns, names and values; names without value are left out."""
        rows = [(Cell(name), Cell(value)) for name, value in facts if value]
        return Table(caption, [self("what"), self("value")], rows)

    def unit(self, kind: str) -> str:
        """Unit of a kind of quantities, in brackets."""
        return in_unit(KINDS[kind].unit(self.units))


def found(tree: Any, *keys: str | int) -> Any:
    """Value at a path of keys and indices in ``tree``, a part of results.json; None if the path is missing."""
    for key in keys:
        if isinstance(tree, Mapping):
            tree = tree.get(key)
        elif isinstance(tree, list) and isinstance(key, int) and key < len(tree):
            tree = tree[key]
        else:
            return None
    return tree


def solved(values: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """Yield the combinations of results.json with an equilibrium."""
    return (one for one in values["combinations"] if one["status"] == "solved")
