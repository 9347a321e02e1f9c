"""Writes docs/keys.md, the tables of all keys of the input file, from the schema: `python docs/keys.py`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import signorini

PAGE = Path(__file__).with_name("keys.md")
_HEAD = """# Keys of the input file

Generated from the schema by `python docs/keys.py`. [input.md](input.md) explains the keys in context."""


def _resolved(node: dict[str, Any], definitions: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Tables (name, definition) that a value may be."""
    if "$ref" in node:
        name = node["$ref"].rpartition("/")[2]
        return [(name, definitions[name])]
    inner = [*node.get("anyOf", ()), *node.get("oneOf", ()), *node.get("allOf", ())]
    inner += [node[key] for key in ("items", "additionalProperties") if isinstance(node.get(key), dict)]
    return [found for one in inner for found in _resolved(one, definitions)]


def _table(definition: dict[str, Any]) -> list[str]:
    """Rows of a table of keys."""
    required = set(definition.get("required", ()))
    rows = ["| key | value | default |", "|---|---|---|"]
    for key, node in definition["properties"].items():
        default = node.get("default", "required" if key in required else "")
        plain = default in ("", "required", None, []) or isinstance(default, dict)
        shown = "required" if default == "required" else "" if plain else f"`{json.dumps(default)}`"
        text = node.get("description", "").rstrip(".").replace("|", "\\|")
        rows.append(f"| `{key}` | {text} | {shown} |")
    return rows


def page() -> str:
    """Return docs/keys.md: a section a table of the input file, each followed by the tables that are its values."""
    schema = signorini.schema()
    definitions, lines, done = schema["$defs"], [_HEAD], set[str]()
    top = {key: node for key, node in schema["properties"].items() if key != "plates"}
    waiting = [
        (f"`[[{key}]]`" if node.get("type") == "array" else f"`[{key}]`", name)
        for key, node in top.items()
        for name, _ in _resolved(node, definitions)
    ]
    while waiting:
        title, name = waiting.pop(0)
        definition = definitions[name]
        if name in done or "properties" not in definition:
            continue
        done.add(name)
        lines += ["", f"## {title}: {name}", "", definition.get("description", ""), "", *_table(definition)]
        inner = [
            (f"`{key}` of {name}", other)
            for key, node in definition["properties"].items()
            for other, _ in _resolved(node, definitions)
        ]
        waiting = [*(one for one in inner if one[1] not in done), *waiting]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
