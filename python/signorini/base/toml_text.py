"""Nested mappings and lists as TOML text."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import PurePath
from typing import Any

from signorini.errors import InputError

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def toml_text(tables: Mapping[str, Any]) -> str:
    """Write tables under headers, lists of tables under double brackets, and what is deeper inline; None is left out.

    Raises
    ------
    InputError
        If a value is one that TOML does not have, such as a function.

    Examples
    --------
    >>> print(toml_text({"title": "Slab", "mesh": {"size": 0.5}, "load": [{"at": ((1.0, 2.0),), "force": 1e5}]}))
    title = "Slab"
    <BLANKLINE>
    [mesh]
    size = 0.5
    <BLANKLINE>
    [[load]]
    at = [[1.0, 2.0]]
    force = 100000.0
    <BLANKLINE>
    """
    return "\n\n".join(_blocks(tables)) + "\n"


def _blocks(tables: Mapping[str, Any]) -> Iterator[str]:
    plain = {key: value for key, value in tables.items() if not (_is_table(value) or _is_list_of_tables(value))}
    if any(value is not None for value in plain.values()):
        yield _lines(plain, "")
    for key, value in tables.items():
        if _is_list_of_tables(value):
            yield from (f"[[{_key(key)}]]\n{_lines(one, f'{key}[{number}]')}" for number, one in enumerate(value, 1))
        elif _is_table(value) and value and all(map(_is_table, value.values())):
            yield from (f"[{_key(key)}.{_key(name)}]\n{_lines(one, f'{key}.{name}')}" for name, one in value.items())
        elif _is_table(value):
            yield f"[{_key(key)}]\n{_lines(value, key)}"


def _is_table(value: object) -> bool:
    return isinstance(value, Mapping)


def _is_list_of_tables(value: object) -> bool:
    return isinstance(value, list | tuple) and bool(value) and all(map(_is_table, value))


def _lines(table: Mapping[str, Any], place: str) -> str:
    return "\n".join(_pairs(table, place))


def _pairs(table: Mapping[str, Any], place: str) -> Iterator[str]:
    for key, value in table.items():
        if value is not None:
            yield f"{_key(key)} = {_value(value, f'{place}.{key}' if place else key)}"


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else _string(key)


def _string(text: str) -> str:
    # JSON escapes every control character but DEL.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: object, place: str) -> str:
    match value:
        case bool():
            return str(value).lower()
        case int() | float():
            return repr(value)
        case str() | PurePath():
            return _string(str(value))
        case list() | tuple():
            return f"[{', '.join(_value(one, place) for one in value)}]"
        case Mapping():
            return f"{{ {', '.join(_pairs(value, place))} }}" if value else "{}"
    name = getattr(value, "__qualname__", type(value).__name__)
    raise InputError(f"found {name}, which TOML does not have. Give numbers, an expression or a table.", place=place)
