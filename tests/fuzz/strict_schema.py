"""Schemas of results.json and path.json that also refuse keys that they do not name, and descriptions they lack."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema

import signorini


def strict(node: Any) -> Any:
    """The schema, which then refuses keys that it does not name."""
    if isinstance(node, dict):
        closed = {"additionalProperties": False} if "type" in node and isinstance(node.get("properties"), dict) else {}
        return {key: strict(value) for key, value in node.items()} | closed
    return [strict(one) for one in node] if isinstance(node, list) else node


RESULTS, PATH = (
    jsonschema.Draft202012Validator(strict(signorini.results_schema(file))) for file in ("results.json", "path.json")
)


def faults(file: Path) -> list[str]:
    """Differences of a written results.json or path.json from the strict schema; NaN and Infinity are no JSON."""

    def refuse(name: str) -> float:
        raise ValueError(f"{name} is no JSON number")

    try:
        found = json.loads(file.read_text("utf-8"), parse_constant=refuse)
    except ValueError as error:
        return [f"{file.name}: {error}"]
    schema = PATH if "stops" in found else RESULTS
    return [f"{file.name}: {error.json_path}: {error.message[:200]}" for error in schema.iter_errors(found)][:5]
