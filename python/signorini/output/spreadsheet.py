"""Sheets of results.xlsx, from the values of results.json and the labels of the registry."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from signorini.analysis.results import Results
from signorini.base.numbers import in_unit
from signorini.contact.certificate import FIGURES
from signorini.formats.xlsx import Cell, Sheet
from signorini.model import Units
from signorini.output.by_combination import by_combination
from signorini.results.quantities import BY_LIST, SIDES, Path, Quantity, quantity_at

_LISTS = {
    "Reactions": (("supports", "contacts"), ("points", "nodes")),
    "Supports": (("supports", "contacts"), ()),
    "Lines": (("supports", "contacts"), ("line",)),
    "Probes": (("probes",), ()),
    "Sections": (("sections",), ()),
    "Strips": (("strips",), ("stations",)),
    "Profiles": (("profiles",), ("stations",)),
    "Checks": (("checks",), ()),
    "Punching": (("punching",), ()),
}
"""Lists of results.json and of its combinations, and lists within their entries, that each sheet shows."""
_LENGTHS = ("s", "length", "width", "distance")
_WIDTH = "± "
"""Prefix of the titles of columns with half-widths."""


def sheets_of(values: Mapping[str, Any], results: Results) -> Iterator[Sheet]:
    """Yield the sheets that have rows; ``values`` are those of results.json."""
    units, first = Units(**values["units"]), next(iter(results.full.values()), None)
    exact = {} if first is None else {one.path: one.quantity for one in first.catalogue}
    yield Sheet("Summary", ("what", "value", "largest error of the certificate"), list(_summary(values)))
    yield _combinations(results, units)
    for name, (owners, parts) in _LISTS.items():
        rows = list(_rows(values, owners, parts, exact, units))
        if rows:
            yield _table(name, rows)
    for name, rows in (("Governing", list(_governing(values, units))), ("Envelope", list(_envelopes(values, units)))):
        if rows:
            yield _table(name, rows)


def _table(name: str, rows: Sequence[Mapping[str, Cell]]) -> Sheet:
    """Make a sheet from rows; the column of half-widths follows the column of their number."""
    found = dict.fromkeys(column for row in rows for column in row)
    numbers = [column for column in found if not column.startswith(_WIDTH)]
    columns = [title for column in numbers for title in (column, _WIDTH + column) if title in found]
    return Sheet(name, columns, ([row.get(column) for column in columns] for row in rows))


def _summary(values: Mapping[str, Any]) -> Iterator[Sequence[Cell]]:
    program, given, units = values["program"], values["input"], values["units"]
    yield from (("title", values["title"]), ("program", program["name"]), ("version", program["version"]))
    yield from (("commit", program["commit"]), ("input", given["file"]), ("SHA-256 of the input", given["sha256"]))
    yield ("SHA-256 of the model", given["model_sha256"])
    yield from (("unit of length", units["length"]), ("unit of force", units["force"]))
    yield from values["model"].items()
    for one in values["combinations"]:
        certificate = one["certificate"]
        largest = None if certificate is None else max(certificate[key] for key in FIGURES)
        said = one["message"] or ("certificate passed" if certificate and certificate["passed"] else one["status"])
        yield (one["name"], said, largest)
    yield from ((", ".join(("warning", *one["combinations"])), one["text"]) for one in values["warnings"])


def _combinations(results: Results, units: Units) -> Sheet:
    """Sheet of load-case factors by combination; with a stored table also numbers of supports, and utilisations."""
    combinations, numbers = results.model.effective_combinations, by_combination(results)
    acting = combinations.cases
    cases = [case for case in results.discretisation.cases if case in acting]
    columns = [values.tolist() for _, values in numbers]

    def rows() -> Iterator[Sequence[Cell]]:
        for row, one in enumerate(combinations):
            factors = one.factors or {}
            yield (one.name, one.group, *map(factors.get, cases), *(_finite(column[row]) for column in columns))

    titles = [f"{one.subject}: {one.quantity.label(units)}" for one, _ in numbers]
    return Sheet("Combinations", ["combination", "group", *(f"factor of {case}" for case in cases), *titles], rows())


def _finite(value: float) -> float | None:
    return value if value == value else None


def _rows(
    values: Mapping[str, Any], owners: Sequence[str], parts: Sequence[str], exact: Mapping[Path, Quantity], units: Units
) -> Iterator[dict[str, Cell]]:
    """Yield a row for each entry of the lists ``owners`` of results.json or, if given, of their lists ``parts``."""
    for combination in ({**values, "name": None, "plus_minus": None}, *values["combinations"]):
        head: dict[str, Cell] = {"combination": combination["name"]}
        for owner, index, entry in ((of, *pair) for of in owners for pair in enumerate(combination.get(of, ()))):
            of_all = (combination["plus_minus"] or {}).get(owner)
            widths = of_all[index] if of_all else {}
            if not parts:
                yield head | _cells(entry, widths, owner, (owner, index), exact, units)
            for part, number, each in ((of, *pair) for of in parts for pair in enumerate(entry.get(of, ()))):
                named, inner = {"name": entry["name"], "number": number + 1}, widths.get(part)
                path = (owner, index, part, number)
                yield head | named | _cells(each, inner and inner[number], part, path, exact, units)


def _cells(
    entry: Mapping[str, Any], widths: Any, owner: str, place: Path, exact: Mapping[Path, Quantity], units: Units
) -> dict[str, Cell]:
    """Cells of an entry by title: numbers with their half-widths, and texts; lists of tables are left out."""
    listed, cells = {one.path: one for one in BY_LIST.get(owner, ())}, dict[str, Cell]()
    for path, value, width in _leaves(entry, widths):
        keys = [str(key) for key in path]
        if (quantity := exact.get((*place, *path)) or listed.get(path)) is not None:
            cells[title := quantity.label(units)] = value
            if width is not None and quantity.kind != "count":
                cells[_WIDTH + title] = width
            continue
        if len(path) == 2 and (keys[0].endswith("at") or keys[0] in ("from", "to", "place")):
            keys = [*keys[0].replace("_at", "").removesuffix("at").split("_"), "xy"[int(keys[1])]]
        length = keys[-1] in ("x", "y", *_LENGTHS)
        cells[" ".join(filter(None, keys)).replace("_", " ") + in_unit(units.length) * length] = value
    return cells


def _leaves(node: Any, widths: Any, path: Path = ()) -> Iterator[tuple[Path, Cell, float | None]]:
    """Yield path, value and half-width of each number and text of an entry; lists of tables or lists are left out."""
    if isinstance(node, dict):
        for key, value in node.items():
            yield from _leaves(value, widths.get(key) if isinstance(widths, dict) else None, (*path, key))
    elif isinstance(node, list):
        for index, value in enumerate(node):
            if not isinstance(value, dict | list):
                yield from _leaves(value, widths[index] if isinstance(widths, list) else None, (*path, index))
    elif node is not None:
        yield path, node, widths if isinstance(widths, float) else None


def _governing(values: Mapping[str, Any], units: Units) -> Iterator[dict[str, Cell]]:
    """Yield the extremes of each bearing, over all combinations and over each group."""
    for group in (values, *values["groups"]):
        for one in group["governing_reactions"]:
            x, y = one["at"] or (None, None)
            row: dict[str, Cell] = {"group": group.get("name"), "support": one["support"], "point": one["point"]}
            row |= {f"x{in_unit(units.length)}": x, f"y{in_unit(units.length)}": y}
            yield row | _sides(one, one["plus_minus"], f"reaction{in_unit(units.force)}")


def _envelopes(values: Mapping[str, Any], units: Units) -> Iterator[dict[str, Cell]]:
    """Yield the extremes of each number over all combinations and over each group."""
    for group in (values, *values["groups"]):
        envelope = group.get("envelope") or {}
        for words, node, widths in _extremes(envelope, envelope.get("plus_minus"), ()):
            quantity = quantity_at([word for word in words if not word.isdigit()])
            row: dict[str, Cell] = {"group": group.get("name"), "quantity": ", ".join(words)}
            yield row | {"unit": quantity.unit(units) if quantity else None} | _sides(node, widths, "")


def _extremes(node: Any, widths: Any, words: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any, Any]]:
    """Yield the tables of an envelope that contain extremes: their keys and names, the table, and half-widths."""
    if isinstance(node, list):
        for index, entry in enumerate(node):
            if isinstance(entry, dict):
                name = entry.get("name", str(index + 1))
                yield from _extremes(entry, widths[index] if widths else None, (*words, name))
    elif isinstance(node, dict):
        if any(f"{side}_by" in node for side in SIDES):
            yield words, node, widths
        for key, value in node.items():
            yield from _extremes(value, (widths or {}).get(key), (*words, key)) if key != "plus_minus" else ()


def _sides(node: Mapping[str, Any], widths: Mapping[str, Any] | None, what: str) -> dict[str, Cell]:
    """Cells of the largest and the smallest value, their half-widths and combinations."""
    cells: dict[str, Cell] = {}
    for side in SIDES:
        title = f"{side} {what}".strip()
        cells |= {title: node.get(side), _WIDTH + title: (widths or {}).get(side), f"{side} by": node.get(f"{side}_by")}
    return cells
