"""Additions to `tomllib`: line numbers of keys, and hints on how to correct invalid TOML."""

from __future__ import annotations

import bisect
import contextlib
import re
import tomllib
from collections.abc import Collection

Path = tuple[str | int, ...]

_BLANK = re.compile(r"(?:[ \t\n]|#[^\n]*)*")
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_STRING = re.compile(
    r'"""(?:[^"\\]|\\.|"{1,2}(?!"))*"{3,5}|' r"'''(?:[^']|'{1,2}(?!'))*'{3,5}|" r'"(?:[^"\\\n]|\\.)*"|' r"'[^'\n]*'",
    re.DOTALL,
)
_TOKENS = re.compile(rf"(?P<comment>#[^\n]*)|{_STRING.pattern}|[\"'].*", re.DOTALL)
_SCALAR = re.compile(r"[^,\]}\n#]*")


def without_strings(text: str) -> str:
    """Replace strings in a TOML text by "" and remove comments, but keep line breaks, so that line numbers remain."""
    return _TOKENS.sub(lambda token: "" if token["comment"] else '""' + "\n" * token.group().count("\n"), text)


class Lines:
    """Line numbers, from 1, of the tables, keys and list items of a valid TOML text.

    A path that is not in the text gets the line of the innermost table in the text that contains the path.
    """

    def __init__(self, text: str) -> None:
        self._text = text.replace("\r\n", "\n")
        self._breaks = [match.start() for match in re.finditer("\n", self._text)]
        self._position = 0
        self._lines: dict[Path, int] = {(): 1}
        self._counts: dict[Path, int] = {}
        with contextlib.suppress(RecursionError):  # Keys that are nested too deeply get the line of their table.
            self._read_document()

    def of(self, path: Path) -> int:
        """Line number of a path or, if the path is not in the text, of the longest leading part that is in the text."""
        while path not in self._lines:
            path = path[:-1]
        return self._lines[path]

    def _read_document(self) -> None:
        table: Path = ()
        while self._skip_blank() < len(self._text):
            line = self._line()
            if self._text.startswith("[", self._position):
                double = self._text.startswith("[[", self._position)
                self._position += 1 + double
                table = self._header(self._key(), double, line)
                self._position += 1 + double
            else:
                self._key_and_value(table)

    def _header(self, key: Path, double: bool, line: int) -> Path:
        """Return the path of the table below a header; a header in double brackets appends a table to a list."""
        path: Path = ()
        for index, part in enumerate(key):
            path = (*path, part)
            if double and index == len(key) - 1:
                self._lines.setdefault(path, line)
                self._counts[path] = self._counts.get(path, 0) + 1
            if path in self._counts:
                path = (*path, self._counts[path] - 1)
            self._lines.setdefault(path, line)
        self._lines[path] = line
        return path

    def _key_and_value(self, table: Path) -> None:
        line = self._line()
        path = table
        for part in self._key():
            path = (*path, part)
            self._lines.setdefault(path, line)
        self._position += 1
        self._value(path)

    def _key(self) -> Path:
        """Read a key and the blanks around it; return the parts of the key (several for a dotted key)."""
        parts: list[str | int] = []
        while True:
            self._skip_blank()
            quoted = _STRING.match(self._text, self._position)
            bare = _BARE_KEY.match(self._text, self._position)
            if quoted:
                parts.append(tomllib.loads(f"key = {quoted.group()}")["key"])
                self._position = quoted.end()
            elif bare:
                parts.append(bare.group())
                self._position = bare.end()
            self._skip_blank()
            if not self._text.startswith(".", self._position):
                return tuple(parts)
            self._position += 1

    def _value(self, path: Path) -> None:
        self._skip_blank()
        self._lines.setdefault(path, self._line())
        string = _STRING.match(self._text, self._position)
        if string:
            self._position = string.end()
        elif self._text.startswith("[", self._position):
            self._items(path, "]")
        elif self._text.startswith("{", self._position):
            self._items(path, "}")
        else:
            scalar = _SCALAR.match(self._text, self._position)
            self._position = scalar.end() if scalar else len(self._text)

    def _items(self, path: Path, close: str) -> None:
        """Read the items of a list, or the keys of an inline table, up to the closing bracket."""
        self._position += 1
        index = 0
        while not self._text.startswith(close, self._skip_blank()):
            if close == "]":
                self._value((*path, index))
            else:
                self._key_and_value(path)
            if self._text.startswith(",", self._skip_blank()):
                self._position += 1
            index += 1
        self._position += 1

    def _skip_blank(self) -> int:
        blank = _BLANK.match(self._text, self._position)
        self._position = blank.end() if blank else self._position
        return self._position

    def _line(self) -> int:
        return bisect.bisect_left(self._breaks, self._position) + 1


_NUMBER = r"(?>[+-]?\d[\d_]*(?:\.\d+)?(?:[eE][+-]?\d+)?)"
_ENDS = r"\s*(?:[,}\]#].*)?$"

# Frequent errors: a pattern of the line at which the parser stopped, and the hint of the first pattern that matches.
_SLIPS: tuple[tuple[str, str], ...] = (
    (r"^(?://|;|%|--)", "A comment begins with #."),
    (r"[“”„‘’«»]", "Quotes are straight: \" or '."),
    (r'=\s*"[^"]*\\', "Write a path with / in place of \\, or in single quotes."),
    (r"=\s*\(", "Write a list in square brackets: [1, 2]."),
    (rf"=\s*([+-]?\d{{1,3}}(?:,\d{{3}}){{2,}}){_ENDS}", "Write a number without commas: {joined}."),
    (
        rf"=\s*([+-]?\d+),(\d{{3}}){_ENDS}",
        "The decimal sign is a point: {1}.{2}. If {1},{2} is meant in thousands, write {1}{2}.",
    ),
    (rf"=\s*([+-]?\d+),(\d+(?:[eE][+-]?\d+)?){_ENDS}", "The decimal sign is a point: {1}.{2}."),
    (r",\s*\}", "Remove the comma before the closing brace."),
    (
        r"\{[^}]*$",
        "Write a table in braces on one line, from {{ to }}, or write it under a header.",
    ),
    (r"[=,\[]\s*([+-]?)(\.\d+)", "Write a digit before the point: {1}0{2}."),
    (r"[=,\[]\s*([+-]?\d+)\.(?!\d)((?:[eE][+-]?\d+)?)", "Write a digit after the point: {1}.0{2}."),
    (r"=\s*[+-]?0+(\d[\d.]*)", "Remove the leading zeros: {1}."),
    (rf"=\s*({_NUMBER})\s*[*^/]", "Write a power of ten as 30e9, and a formula in quotes."),
    (r"=\s*(\d+(?: \d{3})+)\b", "Write a number without spaces: {joined}."),
    (rf"=\s*({_NUMBER})\s*[^\W\d_]", "Write a number without a unit: {1}. Label the units in [units]."),
    (rf"=\s*{_NUMBER}\s*;", "Remove the semicolon."),
    (r"=\s*(True|False|TRUE|FALSE)\b", "Write {small} in small letters."),
    (r"=\s*([^\W\d]\w*)", 'Write text in quotes: "{1}".'),
    (r"=\s*(?:#.*)?$", "The value after = is missing."),
    (r"^[\w.\- ]+:", "Write = between a key and its value."),
    (r"[{,]\s*\w+\s*:", "Write = between a key and its value."),
    (r"^\[\[[^\]]*\](?!\])", "Close a header in double brackets with ]]."),
    (r"^\[[^\]]*$", "Close a header in brackets with ]."),
    (r"""=\s*(["'])(?:(?!\1).)*$""", "The closing quote {1} is missing."),
    (r"^\{", "This looks like JSON; the input must be TOML, see docs/input.md."),
    (r"^[^=\[]+$", "A line must be [a header], key = value, or # a comment."),
    (r"^[^\x00-\x7f]", "Write keys in letters a to z, such as nu."),
)


def hint(problem: str, line: str, lists: Collection[str]) -> str:
    """Hint on how to correct a line of invalid TOML; empty if no pattern matches.

    ``problem`` is the parser's message for ``line``; ``lists`` are the tables that need double brackets.

    Examples
    --------
    >>> hint("Expected newline or end of document after a statement", "nu = 0,3", ["support"])
    'The decimal sign is a point: 0.3.'
    >>> hint("Cannot declare ('support',) twice", "[support]", ["support"])
    'Write this table in double brackets, once for each: [[support]].'
    """
    line = line.strip()
    header = re.match(r"\[\[?\s*(\w+)\s*\]", line)
    if header and ("twice" in problem or "overwrite" in problem or "mutate" in problem):
        if header[1] in lists:
            return f"Write this table in double brackets, once for each: [[{header[1]}]]."
        return "This table occurs twice; put all its keys under one header."
    if "overwrite" in problem:
        return "This key occurs twice in its table; remove one of the two lines."
    for pattern, advice in _SLIPS:
        if match := re.search(pattern, line):
            first = match.group(1) if match.re.groups else ""
            joined, small = re.sub("[, ]", "", first), first.lower()
            return advice.format(match.group(), *match.groups(), joined=joined, small=small)
    return ""
