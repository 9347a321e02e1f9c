"""JSON Schemas of results.json and path.json: keys from schema.toml, numbers from the registry of quantities."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal

from signorini.base import arguments
from signorini.base.arguments import checked
from signorini.model.whole import Units
from signorini.output.load_path import SCHEMA as PATH_SCHEMA
from signorini.output.names import JSON, PATH_JSON
from signorini.output.tables import SCHEMA
from signorini.results import quantities
from signorini.results.quantities import (
    BY_LIST,
    FIELDS,
    LINEAR,
    OF_POINTS,
    PEAKING,
    PICTURED,
    PRESSURE,
    SIDES,
    Quantity,
)

Node = dict[str, Any]
SYMBOLS = Units(length="L", force="F")
"""Symbols L and F that stand for the units of length and force in the schema."""
_TYPES: Mapping[str, Node] = {
    "text": {"type": "string"},
    "number": {"type": "number"},
    "count": {"type": "integer"},
    "flag": {"type": "boolean"},
    "point": {"type": "array", "items": {"type": ["number", "null"]}, "unit": "L"},
    "any": {},
}
_SUFFIXES = re.compile(r"\[\]|\{\}|\?|\(.*\)")
_ROOTS = {JSON: ("results", SCHEMA), PATH_JSON: ("path", PATH_SCHEMA)}
"""Table of schema.toml and version of the schema, for each file of results."""
_SIDES = {"max": "largest", "min": "smallest"}


def _groups() -> dict[str, Iterable[Quantity]]:
    """Lists of quantities in the registry (`results.quantities`), by the names that schema.toml uses."""
    return {
        **{name: of for name, of in vars(quantities).items() if isinstance(of, tuple)},
        "RESULTANTS": [LINEAR[name] for name in quantities.RESULTANTS],
        "AT_CORNERS": [quantities.AT_CORNERS],
        "OF_STATIONS_OF_LINES": BY_LIST["line"],
        "ALONG_PROFILES": PICTURED.values(),
    }


@checked
def results_schema(file: Literal["results.json", "path.json"] = "results.json") -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a file of results, for programs that read it.

    A number has the keywords ``name``, its name in tables and thresholds, and ``unit``, with L for length and F for
    force. Keys may be added in later versions, so that the schema allows other keys.

    Parameters
    ----------
    file : {"results.json", "path.json"}

    Returns
    -------
    dict

    Examples
    --------
    >>> results_schema()["$defs"]["support"]["properties"]["max_pressure"]
    {'type': ['number', 'null'], 'description': 'max pressure, positive up', 'unit': 'F/L²', 'name': 'max_pressure'}
    """
    arguments.known(file, tuple(_ROOTS), "file", "file", "This function")
    tables = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
    pressures = {f"{kind}contact_pressure": PRESSURE for kind in ("", "rigid_")}
    peaking = {name: FIELDS[name] for name in PEAKING}
    definitions = {
        **{name: _object(table, tables) for name, table in tables.items()},
        "fields": _fields("field", peaking),
        "stop_fields": _fields("stop_field", peaking),
        "envelope_fields": _fields("envelope_field", {**FIELDS, "reaction": OF_POINTS[0], **pressures}),
    }
    root, version = _ROOTS[file]
    body = definitions[root]
    body["properties"]["schema"]["const"] = version
    named = _used(body, definitions)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"{file} of signorini",
        **body,
        "$defs": {name: node for name, node in definitions.items() if name in named},
    }


def _used(node: Node, definitions: Mapping[str, Node]) -> set[str]:
    """Names of the definitions to which a schema refers, directly or through other definitions."""
    found, waiting = set[str](), [node]
    while waiting:
        new = set(re.findall(r"#/\$defs/(\w+)", json.dumps(waiting.pop()))) - found
        found |= new
        waiting += [definitions[name] for name in new]
    return found


def _fields(definition: str, of: Mapping[str, Quantity]) -> Node:
    ends = {name: _said({"$ref": f"#/$defs/{definition}"}, one) for name, one in of.items()}
    return {"type": "object", "description": "Extremes of fields, by name", "properties": ends}


def _said(node: Node, one: Quantity) -> Node:
    unit = one.unit(SYMBOLS)
    return {**node, "description": one.words, **({"unit": unit} if unit else {}), "name": one.name}


def _object(table: Mapping[str, Any], tables: Mapping[str, Mapping[str, Any]]) -> Node:
    """Schema of an object from its table in schema.toml."""
    pairs = list(_keys(table, tables))
    return {
        "type": "object",
        "description": table["about"],
        "properties": {key.removesuffix("?"): node for key, node in pairs},
        "required": [key for key, _ in pairs if not key.endswith("?")],
    }


def _keys(table: Mapping[str, Any], tables: Mapping[str, Mapping[str, Any]]) -> Iterator[tuple[str, Node]]:
    """Yield the keys of a table, with "?" if they are optional, and their schemas."""
    for key, value in table.items():
        if key == "include":
            yield from (pair for name in value for pair in _keys(tables[name], tables))
        elif isinstance(value, list):
            of = [one for name in value for one in _groups()[name]]
            mark = "" if key == "numbers" else "?"
            yield from ((f"{name}{mark}", node) for name, node in _numbers(of, key).items())
        elif "|" in key:
            yield from ((key.replace("|", side), _node(value.replace("|", _SIDES[side]))) for side in SIDES)
        elif key != "about":
            yield key, _node(value)


def _node(said: str) -> Node:
    """Schema of a value from its text "TYPE: description" in schema.toml."""
    kinds, _, description = said.partition(": ")
    nodes = []
    for kind in kinds.split("|"):
        name = re.match(r"\w+", kind)
        assert name is not None
        node = dict(_TYPES.get(name[0], {"$ref": f"#/$defs/{name[0]}"}))
        for suffix in _SUFFIXES.findall(kind):
            match suffix:
                case "[]":
                    node = {"type": "array", "items": node}
                case "{}":
                    node = {"type": "object", "additionalProperties": node}
                case "?":
                    node = _or_null(node)
                case unit:
                    node["unit"] = unit[1:-1]
        nodes.append(node)
    return {**(nodes[0] if len(nodes) == 1 else {"anyOf": nodes}), "description": description}


def _or_null(node: Node) -> Node:
    return {**node, "type": [node["type"], "null"]} if "type" in node else {"anyOf": [node, {"type": "null"}]}


def _numbers(of: Iterable[Quantity], form: str) -> dict[str, Node]:
    """Schemas, by key, of quantities or of their extremes; ``form`` is the key of schema.toml that lists them."""
    tree: dict[Any, Any] = {}
    extremes = form.endswith("extremes")
    for one in of:
        if extremes and not one.enveloped:
            continue
        at, path = tree, (one.name,) if form.startswith("named") else one.path
        for key in path[:-1]:
            at = at.setdefault(key, {})
        # A count is a "number" here, since its half-width in plus_minus may be a fraction.
        number = _or_null({"type": "number"})
        at[path[-1]] = [_said(_or_null({"$ref": "#/$defs/extreme"}) if extremes else number, one)]
    return {key: _assembled(node) for key, node in tree.items()}


def _assembled(tree: Any) -> Node:
    """Schema of nested dictionaries: an array if the keys are indices, else an object."""
    if isinstance(tree, list):
        leaf: Node = tree[0]
        return leaf
    inner = {key: _assembled(node) for key, node in tree.items()}
    if 0 in inner:
        return {"type": "array", "prefixItems": list(inner.values())}
    return {"type": "object", "properties": inner}
