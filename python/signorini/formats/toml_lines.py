"""Line numbers of the keys of a TOML text, which `tomllib` does not give."""

from __future__ import annotations

import bisect
import contextlib
import re
import tomllib

Path = tuple[str | int, ...]

_BLANK = re.compile(r"(?:[ \t\n]|#[^\n]*)*")
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_STRING = re.compile(
    r'"""(?:[^"\\]|\\.|"{1,2}(?!"))*"{3,5}|' r"'''(?:[^']|'{1,2}(?!'))*'{3,5}|" r'"(?:[^"\\\n]|\\.)*"|' r"'[^'\n]*'",
    re.DOTALL,
)
_SCALAR = re.compile(r"[^,\]}\n#]*")


class Lines:
    r"""Line numbers, from 1, of the tables, keys and list items of a valid TOML text.

    Parameters
    ----------
    text : str
        What `tomllib.loads` has already accepted.

    Examples
    --------
    >>> lines = Lines("[plate]\nsize = [1,\n  2]\n[[load]]\nforce = 3\n")
    >>> lines.of(("plate", "size", 1)), lines.of(("load", 0, "force"))
    (3, 5)

    A path that is not in the text gets the line of the table it would be in.

    >>> lines.of(("load", 0, "at"))
    4
    """

    def __init__(self, text: str) -> None:
        self._text = text.replace("\r\n", "\n")
        self._breaks = [match.start() for match in re.finditer("\n", self._text)]
        self._position = 0
        self._lines: dict[Path, int] = {(): 1}
        self._counts: dict[Path, int] = {}
        with contextlib.suppress(RecursionError):  # lines beyond nesting this deep fall back to the table's
            self._read_document()

    def of(self, path: Path) -> int:
        """Line of a path, or of the longest part of it that the text has."""
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
        """Enter a table; in a list of tables, its last one, or with double brackets a new one."""
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
        """Read a key, dotted or not, and the blanks around it."""
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
