"""Write docs/keys.md from the schema of the input file and docs/quantities.md from the registry of quantities."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import signorini
from signorini.output.explain import allowed, inner
from signorini.results.quantities import Number

Node = dict[str, Any]
_KEYS = """# Keys of the input file

`python docs/tables.py` generates this page from the schema of the input file. [input.md](input.md) explains the keys.

Bounds in the column "allowed" hold for every number of a list and for every value of an expression."""
_QUANTITIES = """# Numbers of results

`python docs/tables.py` generates this page from the registry of quantities. [results.md](results.md) explains them.

Units are F (force) and L (length). Names are those of `Result.to_dataframe()` and of [thresholds](paths.md#thresholds).
The examples have an area support `AREA`, an edge `LINE`, point supports `POINTS`, a section `CUT` and a strip `STRIP`.
They also have punched columns `COLUMNS`. Contacts between plates have the numbers of supports.
Paths begin in `combinations[]` of `results.json`; columns are those of `combinations.parquet`.
The key `output.envelope` of the input selects the fields that have columns `max:…` and `min:…`."""
_MODEL = """
units = { length = "m", force = "kN" }
material = { E = 1e7, nu = 0.2 }
plate = { shape = "rectangle", size = [4, 4], thickness = 0.2 }
mesh = { divisions = [2, 2] }
load = [{ pressure = 2 }]
probe = [{ at = [2, 2] }]
reinforcement = { code = "EN 1992-1-1:2004", fck = 30e3, fyk = 500e3, d_top = [0.03, 0.04], d_bottom = [0.03, 0.04] }
section = [{ name = "CUT", line = [[2, 0], [2, 4]] }]
strip = [{ name = "STRIP", line = [[0, 2], [4, 2]], width = 1 }]
support = [
  { name = "AREA", area = "all", resists = "down", stiffness = 1e4, limit = 500 },
  { name = "LINE", edge = "left", fix = "simple" },
  { name = "POINTS", at = [3, 2], resists = "up", limit = 50, preload = 5, rotational_stiffness = 100 },
]
"""

_COLUMNS = """
units = { length = "m", force = "kN" }
material = { E = 3e7, nu = 0.2 }
plate = { shape = "rectangle", size = [4, 4], thickness = 0.2 }
load = [{ pressure = 2 }]
support = [{ name = "COLUMNS", at = [[1, 1], [3, 1], [2, 3]], radius = 0.2 }]
punching = [{ support = "COLUMNS", code = "ACI 318-19", d = [0.15, 0.15], fck = 3e4, fyk = 4e5 }]
"""


def _tables(node: Node, definitions: dict[str, Node]) -> list[tuple[str, Node]]:
    """Name and schema of each table that is allowed as the value of a key."""
    if "$ref" in node:
        return [(name := node["$ref"].rpartition("/")[2], definitions[name])]
    if "properties" in node:
        return [("FieldTable", node)]
    return [found for one in inner(node) for found in _tables(one, definitions)]


def _section(title: str, *columns: str) -> str:
    """Section heading, followed by the head of a table with the given columns."""
    return f"\n## {title}\n\n| {' | '.join(columns)} |\n|{'---|' * len(columns)}"


def _row(key: str, node: Node, required: bool) -> str:
    """Table row that describes a key."""
    default, text = node.get("default"), node["description"].rstrip(".").replace("|", "\\|")
    shown = "" if default in (None, []) or isinstance(default, dict) else f"`{json.dumps(default)}`"
    return f"| `{key}` | {text} | {allowed(node, '`{}`')} | {'required' if required else shown} |"


def keys() -> str:
    """Return docs/keys.md: a section for each table of the input file, then for each table in its values."""
    schema, lines, done = signorini.schema(), [_KEYS], set[str]()
    definitions, waiting = schema["$defs"], list[tuple[str, str, Node]]()
    for key, node in schema["properties"].items():
        title = f"`[[{key}]]`" if node.get("type") == "array" else f"`[{key}]`"
        waiting += [(title, *found) for found in _tables(node, definitions) if key != "plates"]
    while waiting:
        title, name, table = waiting.pop(0)
        if name not in done:
            done.add(name)
            own, required = table["properties"].items(), table.get("required", ())
            lines += [_section(f"{title}: {name}\n\n{table['description']}", "key", "value", "allowed", "default")]
            lines += [_row(key, node, key in required) for key, node in own]
            waiting[:0] = [(f"`{key}` of {name}", *found) for key, node in own for found in _tables(node, definitions)]
    return "\n".join(lines) + "\n"


def _path(number: Number) -> str:
    """JSON path of a number in results.json, without the indices of supports, points and so on."""
    own = len(number.path) - len(number.quantity.path)
    keys = (key if isinstance(key, str) else f"[{key if n >= own else ''}]" for n, key in enumerate(number.path))
    return ".".join(keys).replace(".[", "[")


def quantities() -> str:
    """Return docs/quantities.md, from a model with supports, sections and so on of all kinds."""
    model, lines, units = signorini.loads(_MODEL), [_QUANTITIES], signorini.Units(length="L", force="F")
    every = [signorini.solve(one)["all"].catalogue for one in (model, signorini.loads(_COLUMNS))]
    numbers = [*every[0], *every[1].only(lambda one: one.home == "punching")]
    for home in dict.fromkeys(one.home for one in numbers):
        lines.append(_section(home.capitalize(), "name", "number", "unit", "path", "column"))
        first = {(one.owner, _path(one)): one for one in reversed(numbers) if one.home == home}
        for (_, path), one in reversed(first.items()):
            cells = f"`{one.name}` | {one.quantity.words} | {one.quantity.unit(units)} | `{path}`"
            lines.append(f"| {cells} | {f'`{one.column}`' if one.tabled else ''} |")
    return "\n".join(lines) + "\n"


PAGES = {"keys.md": keys, "quantities.md": quantities}

if __name__ == "__main__":
    for name, page in PAGES.items():
        Path(__file__).with_name(name).write_text(page(), encoding="utf-8")
