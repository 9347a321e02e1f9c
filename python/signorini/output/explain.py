"""Explain keys of the input file, keys and numbers of results.json, and errors, by their schemas and classes."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from signorini.base.arguments import checked
from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError, SignoriniError, unknown
from signorini.formats.inputfile import schema
from signorini.output.schema import Node, results_schema

_BOUNDS = {"exclusiveMinimum": "> {:g}", "minimum": "≥ {:g}", "exclusiveMaximum": "< {:g}", "maximum": "≤ {:g}"}
_TYPES = {
    **{"number": "number", "integer": "integer", "string": "text", "boolean": "true or false", "null": "null"},
    **{"object": "table", "array": "list"},
}
_ERRORS = (InputError, NoEquilibriumError, NotCertifiedError, SignoriniError)


@dataclass(frozen=True)
class Explanation:
    """Meaning of a key of the input file, a key or number of results.json, or an error.

    Parameters
    ----------
    keys : tuple of str
        Paths of the key, such as ``"support.gap"``; in results.json with [] for lists and NAME for names.
    source : str
        "input file", "results.json", "path.json" or "error".
    meaning : str
        Description.
    type : str
        Types of the value, such as "number, text".
    unit : str
        Unit of a number of results, with L for length and F for force.
    allowed, default : str
        Allowed words or bounds; default value, or "required".
    documented : str
        Page of the documentation.
    """

    keys: tuple[str, ...]
    source: str
    meaning: str
    type: str = ""
    unit: str = ""
    allowed: str = ""
    default: str = ""
    documented: str = ""


@checked
def explain(key: str) -> tuple[Explanation, ...]:
    """Explain a key of the input file, a key, number or column of results, or an error.

    Parameters
    ----------
    key : str
        A path or its end, such as ``"support.gap"`` or ``"gap"``; the name of a number, such as ``"soil.max_pressure"``
        or ``"probe[1].mx"``; a column, such as ``"reaction:soil"``; or the name of an error.

    Returns
    -------
    tuple of Explanation
        All meanings: those of the input file first.

    Raises
    ------
    InputError
        If no key has this name.

    Examples
    --------
    >>> one, *others = explain("support.settlement")
    >>> one.source, one.default, len(others)
    ('input file', '0.0', 0)
    >>> explain("soil.max_pressure")[0].unit
    'F/L²'
    """
    entries = [*_entries()]
    parts = tuple(re.split(r"[.:]", re.sub(r"\[[^\[\]]*\]", "", key.strip("[] "))))
    # Full paths of the input file are tried first: "support" must not match the end of governing_reactions[].support.
    found = [one for one in entries if _same(parts, one.parts) and one.explanation.source == "input file"]
    if not found and all(parts):
        found = [one for one in entries if _same(parts, one.parts[-len(parts) :]) or parts == (one.name,)]
    found = found or _owned(parts[0], parts[-1], entries) or _owned(parts[-1], parts[0], entries)
    if not found:
        names = {name for one in entries for name in (".".join(one.parts), one.parts[-1], one.name) if name}
        raise InputError(unknown("key", key, names, "This program"), place="key")
    paths: dict[Explanation, dict[str, None]] = {}
    for one in found:
        paths.setdefault(one.explanation, {})[one.path] = None
    return tuple(replace(one, keys=tuple(keys)) for one, keys in paths.items())


def _same(parts: tuple[str, ...], path: tuple[str, ...]) -> bool:
    """Whether the parts of a key match the parts of a path, in which NAME stands for any name."""
    return len(parts) == len(path) and all(known in (part, "NAME") for part, known in zip(parts, path, strict=True))


def _owned(owner: str, number: str, entries: Sequence[_Entry]) -> list[_Entry]:
    """Entries named ``number`` in lists of the kind ``owner``, such as "probe", or else of supports and contacts."""
    found = [one for one in entries if one.name == number != ""]
    for of in ({owner, f"{owner}s"}, {"supports", "contacts"}):
        if those := [one for one in found if of & {*one.parts}]:
            return those
    return found


@dataclass(frozen=True)
class _Entry:
    """A key with its explanation; ``name`` is the name of a number in tables and thresholds."""

    path: str
    explanation: Explanation
    name: str = ""

    @property
    def parts(self) -> tuple[str, ...]:
        return tuple(re.sub(r"\[\d*\]", "", self.path).split("."))


def _entries() -> Iterator[_Entry]:
    """Yield all keys: those of the input file, of results.json and of path.json, and the errors."""
    for path, node, required in _walk(body := schema(), "", body["$defs"], frozenset()):
        shown = node.get("default")
        default = (
            "required" if required else "" if shown in (None, []) or isinstance(shown, dict) else json.dumps(shown)
        )
        yield _Entry(
            path.replace("[]", ""),
            Explanation((), "input file", node["description"], types(node), "", allowed(node), default, "docs/keys.md"),
        )
    files: tuple[Literal["results.json", "path.json"], ...] = ("results.json", "path.json")
    for file in files:
        for path, node, _ in _walk(body := results_schema(file), "", body["$defs"], frozenset()):
            name = node.get("name", "")
            page = "docs/quantities.md" if name else "docs/results.md"
            said, unit = node.get("description", ""), node.get("unit", "")
            yield _Entry(path, Explanation((), file, said, types(node), unit, "", "", page), name)
    for kind in _ERRORS:
        meaning = (kind.__doc__ or "").split("\n")[0].replace("`", "")
        exits = f"exit code {kind.exit_code}"
        yield _Entry(kind.__name__, Explanation((), "error", meaning, exits, documented="docs/programs.md"))


def inner(node: Node) -> list[Node]:
    """Schemas one level below a schema: its alternatives, list items and mapping values."""
    found = [*node.get("anyOf", ()), *node.get("oneOf", ()), node.get("items"), node.get("additionalProperties")]
    return [one for one in found if isinstance(one, dict)]


def allowed(node: Node, form: str = "{}") -> str:
    """Allowed words of a value, each in ``form``, or bounds of its numbers, as text."""
    own = ", ".join(form.format(json.dumps(word)) for word in node.get("enum", ()))
    own = own or " and ".join(text.format(node[key]) for key, text in _BOUNDS.items() if key in node)
    return own or next((found for one in inner(node) if (found := allowed(one, form))), "")


def types(node: Node) -> str:
    """Types of a value as text, such as "number, text, list of numbers"."""
    if "$ref" in node:
        return _TYPES["object"]
    if branches := [*node.get("anyOf", ()), *node.get("oneOf", ())]:
        every = ", ".join(filter(None, map(types, branches)))
        return ", ".join(dict.fromkeys(every.split(", ")))
    kinds = node.get("type", ())
    items = types(node["items"]).removesuffix(", null") if isinstance(node.get("items"), dict) else ""
    of = re.sub(r"^\w+", r"\g<0>s", items)
    names = [_TYPES[kind] for kind in ([kinds] if isinstance(kinds, str) else kinds)]
    return ", ".join(f"list of {of}" if of and name == "list" else name for name in names)


def _walk(
    node: Node, path: str, definitions: Mapping[str, Node], within: frozenset[str]
) -> Iterator[tuple[str, Node, bool]]:
    """Yield path, schema and whether it is required, for each key of a schema, except keys below ``plus_minus``."""
    if "$ref" in node:
        name = node["$ref"].rpartition("/")[2]
        if name not in within:
            yield from _walk(definitions[name], path, definitions, within | {name})
    for key, child in node.get("properties", {}).items():
        below = f"{path}.{key}" if path else key
        if "description" in child:
            yield below, child, key in node.get("required", ())
        if key != "plus_minus":
            yield from _walk(child, below, definitions, within)
    for index, child in enumerate(node.get("prefixItems", ())):
        yield f"{path}[{index}]", child, True
    for child in inner(node):
        ending = "[]" if child is node.get("items") else ".NAME" if child is node.get("additionalProperties") else ""
        yield from _walk(child, path + ending, definitions, within)
