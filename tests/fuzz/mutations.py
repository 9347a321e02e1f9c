"""Text of an input file with errors, made from a model's tables."""

from __future__ import annotations

import copy
import datetime
import json
from random import Random
from typing import Any

from random_models import Tables, model

Spot = tuple[Any, Any]
"""A table or list, and a key or position in it."""

_NUMBERS = [0, -1, 1, 0.5, -0.0, float("nan"), float("inf"), -float("inf"), 1e300, 1e-300, 1e61, 1e-61, 1e60, 1e-60]
_NUMBERS += [10**30, -(2**63), 2**64, 1e-12, 1e-9, 1e-7, 1e9, 3, 89.9, 720]
_TEXTS = ["", "x", "1/x", "1/(x-x)", "sqrt(-1)", "__import__('os')", "open('/etc/passwd')", "x.y", "lambda: 0", "x^2"]
_TEXTS += ["30e9", "nan", "inf", "1e999", "(" * 90 + "x" + ")" * 90, "9**9**9**9", "-" * 300 + "1", "where(x>0,1,1/0)"]
_TEXTS += ["all", "left", "downn", "rectangle", "mesh", "clamped", "\x00", "line\nbreak", "Ω" * 50, "x" * 3000, "../x"]
_TEXTS += ["1 if x else 2", "x if", "[x]", "x,y", "0.1*x", "-x", "log(x)", "exp(1000*x)", "atan2(y, x)"]
_TEXTS += ["0x10", "1_000"]
_OTHERS: list[Any] = [True, False, [], {}, [[]], [{}], [0], [0, 0], [1, 2, 3], [[0, 0]], [[0, 0], [0, 0]], [["a", "b"]]]
_OTHERS += [datetime.date(2020, 1, 1), datetime.datetime(2020, 1, 1, 1), datetime.time(1)]
_OTHERS += [[None], {"a": 1}, [[1, 2, 3]]]
_OTHERS += [[0.0, float("nan")], {"circle": {"radius": 1}}, {"rectangle": [0, 0, 1, 1], "polygon": [[0, 0]]}]
_KEYS = ["thicknes", "E", "at", "edge", "fix", "resists", "gap", "stiffness", "name", "case", "", "a b"]
_KEYS += ["größe", "file"]
_LARGEST_DIVISION = 8
_ASKED = 0.03
"""Fraction of the inputs with mesh.accuracy, whose meshes are refined."""


def text(rng: Random) -> bytes:
    """Draw an input file: a model with up to four errors in its tables, and sometimes errors in its text."""
    tables = model(rng)
    if rng.random() < _ASKED:
        tables["mesh"] = {key: value for key, value in tables["mesh"].items() if key != "error"} | {"accuracy": 0.5}
    for _ in range(rng.choice([0, 0, 1, 1, 1, 2, 4])):
        rng.choice([_replace, _replace, _replace, _drop, _rename, _double, _scale, _swap])(rng, tables)
    _keep_small(tables)
    written = toml(tables).encode("utf-8", "surrogatepass")
    for _ in range(rng.choice([0] * 8 + [1, 3])):
        written = rng.choice([_cut, _flip, _repeat_line, _insert])(rng, written)
    return written


def _spots(node: Any) -> list[Spot]:
    pairs = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    return [spot for key, value in pairs for spot in [(node, key), *_spots(value)]]


def _spot(rng: Random, tables: Tables) -> Spot:
    return rng.choice(_spots(tables) or [(tables, "plate")])


def _replace(rng: Random, tables: Tables) -> None:
    node, key = _spot(rng, tables)
    node[key] = copy.deepcopy(rng.choice(rng.choice([_NUMBERS, _NUMBERS, _TEXTS, _OTHERS])))


def _drop(rng: Random, tables: Tables) -> None:
    node, key = _spot(rng, tables)
    del node[key]


def _rename(rng: Random, tables: Tables) -> None:
    node, key = _spot(rng, tables)
    if isinstance(node, dict):
        node[rng.choice([*_KEYS, str(key)[:-1], f"{key}s", str(key).upper()])] = node.pop(key)


def _double(rng: Random, tables: Tables) -> None:
    node, key = _spot(rng, tables)
    if isinstance(node, list):
        node.extend([node[key]] * rng.choice([1, 1, 30]))


def _scale(rng: Random, tables: Tables) -> None:
    node, key = _spot(rng, tables)
    if isinstance(node[key], int | float) and not isinstance(node[key], bool):
        node[key] *= rng.choice([-1, 0, 2, 1e3, 1e-3, 1e12, 1e-12, 1e40, 1 + 1e-12, 1 - 1e-9])


def _swap(rng: Random, tables: Tables) -> None:
    (a, i), (b, j) = _spot(rng, tables), _spot(rng, tables)
    held = json.loads(json.dumps([a[i], b[j]], default=str))
    b[j] = held[0]
    if i in a if isinstance(a, dict) else i < len(a):
        a[i] = held[1]


def _keep_small(tables: Tables) -> None:
    """Avoid meshes that would take long: larger numbers of elements are made far too large, and so refused."""
    mesh = tables.get("mesh")
    mesh = mesh if isinstance(mesh, dict) else {}
    divisions = mesh.get("divisions")
    for i, count in enumerate(divisions if isinstance(divisions, list) else ()):
        if isinstance(count, int) and count > _LARGEST_DIVISION:
            divisions[i] = max(count, 10**8)
    if isinstance(tables.get("plate"), dict):
        plate = tables["plate"]
        sizes = [s for s in (plate.get("size"), [plate.get("radius")], [plate.get("outer")]) if isinstance(s, list)]
        longest = max([abs(s) for pair in sizes for s in pair if isinstance(s, int | float)], default=0.0)
        refine = mesh.get("refine")
        of_places = [one for one in refine if isinstance(one, dict)] if isinstance(refine, list) else []
        for asked, parts in ((mesh, 12), *((one, 50) for one in of_places)):
            if isinstance(asked.get("size"), int | float) and not 0 < longest / parts < asked["size"]:
                asked["size"] = min(asked["size"], longest * 1e-9)
    if "refine" in mesh or tables.get("zone"):
        # Half-widths would need much finer meshes.
        mesh["error"] = False


def _cut(rng: Random, content: bytes) -> bytes:
    start = rng.randrange(len(content) + 1)
    return content[:start] + content[start + rng.choice([1, 2, 10, 10**6]) :]


def _flip(rng: Random, content: bytes) -> bytes:
    if not content:
        return content
    at = rng.randrange(len(content))
    return content[:at] + bytes([rng.randrange(256)]) + content[at + 1 :]


def _repeat_line(rng: Random, content: bytes) -> bytes:
    lines = content.split(b"\n")
    at = rng.randrange(len(lines))
    return b"\n".join(lines[:at] + [lines[at]] * rng.choice([2, 50]) + lines[at:])


def _insert(rng: Random, content: bytes) -> bytes:
    at = rng.randrange(len(content) + 1)
    piece = rng.choice(
        [b"[", b"]", b'"', b"=", b"\xff", b"\x00", b"[[load]]\n", b"\r", b"'''", b"{", b"#", b"\xef\xbb\xbf"]
    )
    return content[:at] + piece + content[at:]


def toml(tables: Tables) -> str:
    """Write tables as TOML; lists of tables get double brackets."""
    plain = {key: value for key, value in tables.items() if not _is_tables(value) and not isinstance(value, dict)}
    lines = [f"{_key(key)} = {_value(value)}" for key, value in plain.items()]
    for key, value in tables.items():
        if key not in plain:
            for table in value if isinstance(value, list) else [value]:
                lines.append(f"[{_key(key)}]" if isinstance(value, dict) else f"[[{_key(key)}]]")
                lines += [f"{_key(inner)} = {_value(item)}" for inner, item in table.items()]
    return "\n".join(lines) + "\n"


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def _key(key: Any) -> str:
    return json.dumps(str(key), ensure_ascii=False)


def _value(value: Any) -> str:
    match value:
        case None:
            return '"none"'
        case bool():
            return str(value).lower()
        case str():
            return json.dumps(value, ensure_ascii=False)
        case dict():
            return "{ " + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + " }"
        case list():
            return "[" + ", ".join(map(_value, value)) + "]"
        case datetime.date() | datetime.time():
            return value.isoformat()
        case _:
            return repr(value)
