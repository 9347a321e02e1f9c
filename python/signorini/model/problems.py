"""Convert pydantic's errors to messages with the value found, the values allowed, and the place."""

from __future__ import annotations

import datetime
import difflib
import re
import reprlib
from collections.abc import Callable, Iterable, Mapping
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from signorini.errors import InputError, Place


def describe(value: object) -> str:
    """Return a value as text for messages, written as in an input file; long values are shortened."""
    match value:
        case bool():
            return str(value).lower()
        case None:
            return "no value"
        case str():
            shown = value if len(value) <= 60 else f"{value[:57]}..."
            return f'"{shown}"' if shown.isprintable() else f'"{repr(shown)[1:-1]}"'
        case dict():
            return "a table"
        case float():
            return repr(float(value)).removesuffix(".0")
        case int() if abs(value) > 10**20:
            return "an integer of more than 20 digits"
        case datetime.date() | datetime.time():
            return f"the date or time {value}"
        case list() | tuple() if value and all(isinstance(item, str) for item in value):
            return reprlib.repr(list(value)).replace("'", '"')
        case _:
            return reprlib.repr(value)


def as_list(value: Any) -> Any:
    """Convert a NumPy array to lists; other values are returned unchanged."""
    return value.tolist() if hasattr(value, "tolist") else value


_MAX_EXPLAINED = 1000
"""Largest number of pydantic's errors listed in a message; the message gives only the number of further errors."""

LISTS = (
    *("zone", "support", "contact", "load", "tightening", "combination", "moving", "probe", "section", "strip"),
    *("punching", "check"),
)

BRANCHES: dict[str, Mapping[str, type[BaseModel]]] = {}
"""Map from each key whose value is a tagged union to the classes of the union, by their tags in pydantic's paths.

The modules that define the unions, such as ``plate``, add their entries.
"""
TOP: dict[str, tuple[type[BaseModel], ...]] = {}
"""Keys of `Model`, each with the classes of its table; needed for messages that name the table of a misplaced key."""


_LIMITS = {
    "greater_than": ("be greater than", "gt"),
    "greater_than_equal": ("not be less than", "ge"),
    "less_than": ("be less than", "lt"),
    "less_than_equal": ("not be greater than", "le"),
}


def explained(
    error: ValidationError,
    root: type[BaseModel],
    data: Any,
    source: str = "",
    line_of: Callable[[Place], int] | None = None,
) -> InputError:
    """Convert pydantic's error about ``data``, the input of the table ``root``, to an `InputError`.

    `validate` describes ``source`` and ``line_of``.
    """
    errors = error.errors(include_url=False)
    placed = []
    for path, message in _problems(errors[:_MAX_EXPLAINED], data, root):
        line, problem, label = (
            line_of(path) if line_of is not None else 0,
            InputError(message, path),
            _label(path, data),
        )
        problem.place += f' ("{label}")' if label else ""
        placed.append((line, InputError(message, place=f"{source}:{line}: {problem.place}") if line else problem))
    placed.sort(key=lambda pair: pair[0])
    return InputError.combined([problem for _, problem in placed], source, omitted=len(errors[_MAX_EXPLAINED:]))


def _problems(errors: list[ErrorDetails], data: Any, root: type[BaseModel]) -> list[tuple[Place, str]]:
    """Convert errors to pairs (path, message), but none that follows from another, such as a misspelt key."""
    resolved = [(details, *_resolve(details["loc"], data, root)) for details in errors]
    misspelt = {
        (*path[:-1], _nearest(str(path[-1]), table.model_fields))
        for details, path, table, _ in resolved
        if details["type"] == "extra_forbidden"
    }
    problems = []
    for details, path, table, field in resolved:
        kind = details["type"]
        consequence = (kind == "missing" and path in misspelt) or (kind == "too_short" and as_list(details["input"]))
        if kind in ("union_tag_invalid", "union_tag_not_found"):
            path = (*path, "shape")
            field = next(iter(BRANCHES["plate"].values())).model_fields["shape"]
        if not consequence:
            problems.append((path, _message(details, path, table, field)))
    return list(dict.fromkeys(problems))


def _resolve(loc: Place, data: Any, root: type[BaseModel]) -> tuple[Place, type[BaseModel], FieldInfo | None]:
    """Convert a path of pydantic to a path in the input; return also the class and the field of its last key."""
    path: list[str | int] = []
    owner: type[BaseModel] = root
    inner: type[BaseModel] | None = root
    field: FieldInfo | None = None
    branches: Mapping[str, type[BaseModel]] = {}
    value = data
    for position, key in enumerate(loc):
        value = as_list(value)
        if isinstance(key, int):
            nested = isinstance(loc[position + 1], int) if position + 1 < len(loc) else False
            # A single point or edge may be given without a list; its path in the input then has no list index.
            is_list = isinstance(value, list | tuple)
            if is_list and (not nested or any(isinstance(as_list(item), list | tuple) for item in value)):
                path.append(key)
                value = value[key] if key < len(value) else None
        elif key in branches:
            inner, branches = branches[key], {}
        elif path == ["plates"] and key != "[key]":
            path.append(key)
            value = value.get(key) if isinstance(value, Mapping) else None
            branches = BRANCHES["plate"]
        elif key != "[key]":
            if inner is not None:
                owner, field = inner, inner.model_fields.get(key)
                inner = _table_in(field.annotation) if field is not None else None
            branches = BRANCHES.get(key, {})
            path.append(key)
            value = value.get(key) if isinstance(value, Mapping) else None
    return tuple(path), owner, field


def tables_of(root: type[BaseModel]) -> dict[str, tuple[type[BaseModel], ...]]:
    """Return the keys of the table ``root``, each with the classes of tables that are allowed as its value."""
    below = {name: _table_in(field.annotation) for name, field in root.model_fields.items()}
    return {
        name: tuple(BRANCHES[name].values()) if name in BRANCHES else (table,) if table is not None else ()
        for name, table in below.items()
    }


def _table_in(annotation: object) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((table for part in get_args(annotation) if (table := _table_in(part))), None)


def _label(path: Place, data: Any) -> str:
    """Name of the support or combination, or case of the load, to which ``path`` leads; empty for other tables."""
    match path:
        case ("support" | "load" | "moving" | "combination" as key, int(position), *_) if isinstance(data, Mapping):
            tables = data.get(key)
            table = tables[position] if isinstance(tables, list | tuple) and position < len(tables) else None
            label = table.get("case" if key in ("load", "moving") else "name") if isinstance(table, Mapping) else None
            return label if isinstance(label, str) and label.isprintable() and len(label) <= 60 else ""
    return ""


def _message(details: ErrorDetails, path: Place, table: type[BaseModel], field: FieldInfo | None) -> str:
    key = next((str(part) for part in reversed(path) if isinstance(part, str)), "")
    context = details.get("ctx", {})
    found = f"found {describe(as_list(details['input']))}"
    about = (field.description or "") if field is not None else ""
    match details["type"]:
        case "complaint":
            return str(context["message"])
        case "area":
            return f"{found}; {details['msg']}"
        case "value_error":
            return str(context["error"])
        case "extra_forbidden":
            return _unknown_key(path, table)
        case "missing" | "union_tag_not_found":
            return f"'{key}' is missing. {about}{_header_hint(path)}"
        case "union_tag_invalid":
            return _unknown_shape(details["input"])
        case "literal_error":
            allowed = re.findall(r"'([^']*)'", str(context["expected"]))
            return f"{found}; it must be one of {', '.join(allowed)}.{_suggest(details['input'], allowed)}"
        case kind if kind in _LIMITS:
            relation, limit = _LIMITS[kind]
            return f"{found}; it must {relation} {context[limit]:g}."
        case "string_type":
            return f"{found}; it must be text in quotes."
        case "string_too_long":
            return f"found text of {len(details['input'])} characters; at most {context['max_length']} are allowed."
        case "too_short" | "string_too_short":
            return f"found an empty value. {about}"
        case "tuple_type" if isinstance(details["input"], Mapping):
            return f"found a single table; it must be a list of tables, each under [[{key}]] in double brackets."
        case "model_type" | "model_attributes_type" | "dict_type" | "mapping_type" | "tuple_type":
            kind = "a list" if details["type"] == "tuple_type" else "a table"
            return f"{found}; it must be {kind}. {about}"
        case _:
            return f"{found}; it is invalid here. {about}"


def _header_hint(path: Place) -> str:
    """Return a hint that names the header of a missing table, such as [plate]."""
    name = str(path[-1])
    return "" if len(path) > 1 or not TOP.get(name) else f" Write it under {_header(name)}."


def _header(name: str) -> str:
    return f"[[{name}]]" if name in LISTS else f"[{name}]"


def _unknown_key(path: Place, table: type[BaseModel]) -> str:
    key = str(path[-1])
    headers = {name: _header(name) for name, tables in TOP.items() if tables}
    near = _nearest(key, table.model_fields)
    inner = [name for name, below in tables_of(table).items() if _has(below, key)] if len(path) > 1 else []
    if len(path) > 1 and key in headers:
        hint = f" It is a top-level table: write {headers[key]}, or {key} = {{ ... }} above the first header."
    elif len(path) == 1 and near in headers:
        hint = f" Did you mean {headers[near]}?"
    else:
        hint = "" if inner else _suggest(key, table.model_fields)
    if not hint:
        shapes = [shape for shape, plate in BRANCHES["plate"].items() if key in plate.model_fields]
        owners = [
            headers[name] for name, tables in TOP.items() if _has(tables, key) and name not in (path[0], "plates")
        ]
        if path[0] in ("plate", "plates") and shapes:
            hint = f" It needs shape = {' or '.join(map(describe, shapes))}."
        elif inner:
            hint = f" It belongs into {' or '.join(inner)}: {inner[0]} = {{ {key} = ... }}."
        elif key in TOP:
            hint = " It belongs above the first header of a table."
        elif owners:
            hint = f" It belongs in {' or '.join(owners)}."
    return f"unknown key '{key}'.{hint} Allowed here: {', '.join(table.model_fields)}."


def _has(tables: Iterable[type[BaseModel]], key: str) -> bool:
    return any(key in table.model_fields for table in tables)


def _unknown_shape(plate: object) -> str:
    shape = plate.get("shape") if isinstance(plate, Mapping) else getattr(plate, "shape", None)
    shapes = list(BRANCHES["plate"])
    return (
        f"found {describe(shape)}; it must be one of {', '.join(shapes)}.{_suggest(shape, shapes)} "
        "Describe any other outline as a polygon of straight sides and arcs, or by a mesh file."
    )


def _nearest(text: object, allowed: Iterable[str]) -> str:
    """Return the allowed word most similar to ``text``; empty if no word is similar."""
    words = {word.casefold(): word for word in allowed}
    near = difflib.get_close_matches(text[:60].casefold(), words, n=1) if isinstance(text, str) else []
    return words[near[0]] if near else ""


def _suggest(text: object, allowed: Iterable[str]) -> str:
    near = _nearest(text, allowed)
    return f" Did you mean '{near}'?" if near else ""
