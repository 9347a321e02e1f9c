"""From pydantic's errors to plain words: what was found, what is allowed, and where."""

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
    """Show a value the way the input file writes it, cut short when long."""
    match value:
        case bool():
            return str(value).lower()
        case None:
            return "nothing"
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
        case list() | tuple() if value and all(isinstance(one, str) for one in value):
            return reprlib.repr(list(value)).replace("'", '"')
        case _:
            return reprlib.repr(value)


def as_list(value: Any) -> Any:
    """Turn a NumPy array into lists; leave anything else as it is."""
    return value.tolist() if hasattr(value, "tolist") else value


_MOST_READ = 1000

LISTS = ("zone", "support", "contact", "load", "tightening", "combination", "moving", "probe", "section", "strip")
"""Tables that stand in double brackets."""

BRANCHES: dict[str, Mapping[str, type[BaseModel]]] = {}
"""Of keys that take one of several tables, these by what pydantic puts into its path for them, which is no key of the
input. The modules of the tables enter them, which stand above this one."""
TOP: dict[str, tuple[type[BaseModel], ...]] = {}
"""Keys of the whole model with the tables below each, so that a key in the wrong one is told its place."""


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
    """Put pydantic's error with data for a table in words; the other parameters are those of `validate`."""
    errors = error.errors(include_url=False)
    placed = []
    for path, message in _problems(errors[:_MOST_READ], data, root):
        line, result, label = line_of(path) if line_of is not None else 0, InputError(message, path), _label(path, data)
        result.place += f' ("{label}")' if label else ""
        placed.append((line, InputError(message, place=f"{source}:{line}: {result.place}") if line else result))
    placed.sort(key=lambda pair: pair[0])
    return InputError.combined([problem for _, problem in placed], source, omitted=len(errors[_MOST_READ:]))


def _problems(errors: list[ErrorDetails], data: Any, root: type[BaseModel]) -> list[tuple[Place, str]]:
    """Put every error in words, with its path, but for those that only echo another one."""
    resolved = [(details, *_resolve(details["loc"], data, root)) for details in errors]
    misspelt = {
        (*path[:-1], _nearest(str(path[-1]), table.model_fields))
        for details, path, table, _ in resolved
        if details["type"] == "extra_forbidden"
    }
    result = []
    for details, path, table, field in resolved:
        kind = details["type"]
        echo = (kind == "missing" and path in misspelt) or (kind == "too_short" and as_list(details["input"]))
        if kind in ("union_tag_invalid", "union_tag_not_found"):
            path = (*path, "shape")
            field = next(iter(BRANCHES["plate"].values())).model_fields["shape"]
        if not echo:
            result.append((path, _message(details, path, table, field)))
    return list(dict.fromkeys(result))


def _resolve(loc: Place, data: Any, root: type[BaseModel]) -> tuple[Place, type[BaseModel], FieldInfo | None]:
    """Walk pydantic's path; return it as the user wrote it, with the table and field that its last key belongs to."""
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
            # one point or one edge may stand without its list, and then has no position of its own
            lists = [isinstance(as_list(one), list | tuple) for one in value] if isinstance(value, list | tuple) else []
            if isinstance(value, list | tuple) and (any(lists) or not nested):
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
    """Collect the keys of a table with the tables below each."""
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
    """Name of the support or combination, or case of the load, that the path leads into."""
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
    result = f"found {describe(as_list(details['input']))}"
    about = (field.description or "") if field is not None else ""
    match details["type"]:
        case "complaint":
            return str(context["message"])
        case "area":
            return f"{result}; {details['msg']}"
        case "value_error":
            return str(context["error"])
        case "extra_forbidden":
            return _unknown_key(path, table)
        case "missing" | "union_tag_not_found":
            return f"'{key}' is missing. {about}{_written_as(path)}"
        case "union_tag_invalid":
            return _unknown_shape(details["input"])
        case "literal_error":
            allowed = re.findall(r"'([^']*)'", str(context["expected"]))
            return f"{result}; it must be one of {', '.join(allowed)}.{_suggest(details['input'], allowed)}"
        case kind if kind in _LIMITS:
            words, limit = _LIMITS[kind]
            return f"{result}; it must {words} {context[limit]:g}."
        case "string_type":
            return f"{result}; it must be text in quotes."
        case "string_too_long":
            return f"found text of {len(details['input'])} characters; at most {context['max_length']} are allowed."
        case "too_short" | "string_too_short":
            return f"it is empty. {about}"
        case "tuple_type" if isinstance(details["input"], Mapping):
            return f"found one table; this is a list of tables, each under [[{key}]] in double brackets."
        case "model_type" | "model_attributes_type" | "dict_type" | "mapping_type" | "tuple_type":
            kind = "a list" if details["type"] == "tuple_type" else "a table"
            return f"{result}; it must be {kind}. {about}"
        case _:
            return f"{result}; it does not fit here. {about}"


def _written_as(path: Place) -> str:
    """How a table that is missing is written."""
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
        hint = f" It is a table of its own: {headers[key]}, or above the first header {key} = {{ ... }}."
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
            hint = f" It goes with shape = {' or '.join(map(describe, shapes))}."
        elif inner:
            hint = f" It goes within {' or '.join(inner)}: {inner[0]} = {{ {key} = ... }}."
        elif key in TOP:
            hint = " It belongs above the first table."
        elif owners:
            hint = f" It belongs in {' or '.join(owners)}."
    return f"unknown key '{key}'.{hint} Allowed here: {', '.join(table.model_fields)}."


def _has(tables: Iterable[type[BaseModel]], key: str) -> bool:
    return any(key in table.model_fields for table in tables)


def _unknown_shape(plate: object) -> str:
    shape = plate.get("shape") if isinstance(plate, Mapping) else getattr(plate, "shape", None)
    shapes = list(BRANCHES["plate"])
    return (
        f"found {describe(shape)}; this version has {', '.join(shapes)}.{_suggest(shape, shapes)} "
        "Any other outline is a polygon of straight sides and arcs, or a mesh file."
    )


def _nearest(result: object, allowed: Iterable[str]) -> str:
    """Find the allowed word nearest to what was found; nothing if none is near."""
    words = {word.casefold(): word for word in allowed}
    near = difflib.get_close_matches(result[:60].casefold(), words, n=1) if isinstance(result, str) else []
    return words[near[0]] if near else ""


def _suggest(result: object, allowed: Iterable[str]) -> str:
    near = _nearest(result, allowed)
    return f" Did you mean '{near}'?" if near else ""
