"""Sections of a report on the input: scope, materials, geometry, loads, combinations, glossary."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from signorini.accuracy.comparison import PathEstimate
from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.base.numbers import in_unit, number
from signorini.model.key_units import unit_of
from signorini.reports import pictures
from signorini.reports.blocks import Block, Cell, Section, Table, Text, Writer, solved
from signorini.reports.names import numbered, short
from signorini.reports.punching import Punched, punched
from signorini.results.load_path import LoadPath
from signorini.results.marks import resultant_of
from signorini.results.quantities import PICTURED, Quantity, in_model

_MOST_ROWS = 500
"""Largest number of combinations that are listed."""
_PLACES = ("at", "edge", "line", "circle", "area", "nodes", "shape")


@dataclass(frozen=True)
class Contents:
    """Data of all sections of a report: results, ``values`` (content of results.json), writer, source of the input."""

    results: Results
    estimates: Estimates | None
    values: Mapping[str, Any]
    write: Writer
    source: str
    along: LoadPath | None = None
    along_estimate: PathEstimate | None = None

    @property
    def input(self) -> Mapping[str, Any]:
        """Tables of the input file, from results.json."""
        tables: Mapping[str, Any] = self.values["input"]["model"]
        return tables

    @cached_property
    def quantities(self) -> Mapping[tuple[str, str], Quantity]:
        """Quantities of the results, by the kind of their owner (such as "support") and their name."""
        every = (number for one in self.results.full.values() for number in one.catalogue.numbers)
        return {(number.home, number.what): number.quantity for number in every}

    @cached_property
    def punched(self) -> Sequence[Punched]:
        """Punched columns in their governing combinations."""
        return punched(self.results, self.estimates)

    @property
    def groups(self) -> Sequence[str]:
        """Groups of combinations with extremes; first "" for all combinations, unless every combination has a group."""
        every = self.results.model.effective_combinations
        return (*(() if sum(every.groups.values()) == len(every) else ("",)), *every.groups)

    def over(self, group: str) -> Mapping[str, Any]:
        """Part of results.json about a group of combinations; about all combinations if ``group`` is empty."""
        return next(one for one in self.values["groups"] if one["name"] == group) if group else self.values

    def solved(self, group: str = "") -> Iterator[Mapping[str, Any]]:
        """Yield the combinations of results.json with an equilibrium, of a group or, if it is empty, all."""
        combinations = self.results.model.effective_combinations
        for one in solved(self.values):
            if group in ("", combinations[self.results.number_of(one["name"])].group):
                yield one

    def captioned(self, key: str, group: str) -> str:
        """Text of the catalogue texts.toml, followed by the name of a group of combinations, if any."""
        return self.write(key) + (f": {group}" if group else "")

    def place_of(self, index: int) -> tuple[str, int]:
        """Path of support number ``index`` in results.json; contacts between plates are numbered after the supports."""
        count = len(self.results.model.support) - len(self.results.model.contact)
        return ("supports", index) if index < count else ("contacts", index - count)

    def checked(self, checked: str) -> Quantity | None:
        """Quantity of the number or field that a check names, such as "soil.max_pressure"."""
        name = checked.rpartition(".")[2]
        found = (
            [PICTURED[name]]
            if name in PICTURED
            else [one for (_, what), one in self.quantities.items() if what == name]
        )
        return found[0] if found else None

    def code(self, name: str) -> str:
        """Number of a combination with its name: "C17: ULS"; the name alone if there are fewer than three."""
        return numbered(self.results, name)

    def short(self, name: str) -> str:
        """Number of a combination: "C17"; its name if there are fewer than three."""
        return short(self.results, name)


def codes_of(tables: Mapping[str, Any]) -> list[str]:
    """Names of the design codes that the input uses."""
    rules = {"en1990": "EN 1990", "asce7": "ASCE 7"}
    found = [rules.get(str(one.get("generate")), "") for one in tables.get("combination", ())]
    found += [str(one.get("code", "")) for one in (tables.get("reinforcement") or {}, *tables.get("punching", ()))]
    return [code for code in dict.fromkeys(found) if code]


def scope(of: Contents) -> Iterator[Block]:
    """Yield the texts on the method, the design codes and the domain of validity."""
    write, program = of.write, of.values["program"]
    yield Text(write("method"))
    codes = ", ".join(codes_of(of.input))
    yield Text(write("codes", codes=codes) if codes else write("no_codes"))
    yield Text(write("domain"))
    units = ", ".join(filter(None, (of.write.units.length, of.write.units.force)))
    commit = program["commit"] or ""
    facts = {
        write("program"): f"{program['name']} {program['version']}" + (f" ({commit[:12]})" if commit else ""),
        write("input_file"): of.values["input"]["file"] or "",
        "SHA-256": of.values["input"]["sha256"],
        write("units"): units or write("no_units"),
        write("signs_title"): write("signs"),
        write("error_title"): write("error" if of.estimates is not None else "no_error"),
    }
    yield write.facts(write("basis"), facts.items())


def materials(of: Contents) -> Iterator[Block]:
    """Yield materials, thicknesses, zones and reinforcement as the input has them."""
    write, rows = of.write, list[Sequence[Cell]]()
    parts = [(write("plate"), of.input.get("material")), (write("plate"), of.input.get("plate"))]
    parts += [(name, plate) for name, plate in (of.input.get("plates") or {}).items()]
    parts += [(f"{write('zone')} {index}", zone) for index, zone in enumerate(of.input.get("zone", ()), 1)]
    parts += [(write("reinforcement"), of.input.get("reinforcement"))]
    for owner, table in parts:
        for key, value in _flat(table or {}, ("mesh", "points", "holes", "area", "shape", "origin", "size", "element")):
            rows.append([Cell(owner), Cell(key), value_of(of, key.rpartition(".")[2], value)])
    yield Table(write("materials"), [write("part"), write("property"), write("value")], rows)


def _flat(table: Mapping[str, Any], without: Sequence[str], before: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the values of a table and of tables in it, each with its path of keys joined by dots."""
    for key, value in table.items():
        if isinstance(value, Mapping) and key not in without:
            yield from _flat(value, (), f"{before}{key}.")
        elif key not in without:
            yield before + key, value


def value_of(of: Contents, key: str, value: Any, table: Mapping[str, Any] | None = None) -> Cell:
    """Cell of a value of the input with its unit, if known, which may depend on the place (line, area) in ``table``."""
    unit = "°" if key == "angle" else unit_of(key, of.write.units, table)
    return Cell(f"{_words(of, value)} {unit}".rstrip())


def _words(of: Contents, value: Any) -> str:
    """Text of a value of the input: numbers, names, points [x, y], lists and tables of these."""
    if isinstance(value, bool):
        return of.write("yes" if value else "no")
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_words(of, one)}" for key, one in value.items())
    if not isinstance(value, list | tuple):
        return number(value) if isinstance(value, float) else str(value)
    words = [_words(of, one) for one in value]
    numeric = len(value) > 1 and all(isinstance(one, int | float) for one in value)
    return f"[{', '.join(words)}]" if numeric else ", ".join(words)


def _place(of: Contents, table: Mapping[str, Any], default: str = "") -> str:
    """Text of the place of a support or load."""
    return next((f"{key} {_words(of, table[key])}" for key in _PLACES if key in table), default)


def geometry(of: Contents) -> Iterator[Block]:
    """Yield the numbers of the mesh, the drawing of plate, mesh and supports, and the table of supports."""
    write, model = of.write, of.values["model"]
    facts = {write(key): str(model[key]) for key in ("nodes", "elements", "dofs", "contact_points")}
    facts |= {write("quality"): "; ".join(pictures.qualities(of.results))}
    yield write.facts(write("mesh"), facts.items())
    yield from pictures.of_model(of.results, write)
    rows = []
    for kind in ("support", "contact"):
        for index, table in enumerate(of.input.get(kind, ()), 1):
            place = _place(of, table)
            rest = (f"{key} = {value_of(of, key, value, table).text}" for key, value in table.items())
            shown = [text for key, text in zip(table, rest, strict=True) if key not in ("name", *_PLACES)]
            rows.append([Cell(str(table.get("name", f"{kind} {index}"))), Cell(place), Cell("; ".join(shown))])
    yield Table(write("supports"), [write("support"), write.titled("place", "deflection"), write("properties")], rows)
    if moved := of.values["snapped"]:
        rows = [[Cell(one["what"]), write.place(one["from"]), write.place(one["to"])] for one in moved]
        yield Table(write("snapped"), [write("what"), write("from"), write("to")], rows)


def loads(of: Contents) -> Iterator[Block]:
    """Yield the loads and the sum of each load case, and a drawing of each case."""
    write, discretisation = of.write, of.results.discretisation
    rows = []
    for table in of.input.get("load", ()):
        place = _place(of, table, write("everywhere"))
        shown = (
            f"{key} = {value_of(of, key, value).text}" for key, value in table.items() if key not in ("case", *_PLACES)
        )
        rows.append([Cell(str(table.get("case", "load"))), Cell("; ".join(shown)), Cell(place)])
    yield Table(write("loads"), [write("case"), write("load"), write.titled("place", "deflection")], rows)
    rows, units = [], of.write.units
    for case in discretisation.cases:
        force, *couple = resultant_of(discretisation, case)
        at: object = None
        if force:
            at = (discretisation.middle + np.array(couple) / force).tolist()
        elif any(couple):
            at = f"{write('couple')} [{', '.join(f'{one:.5g}' for one in couple)}] {units.force_by_length(1)}"
        rows.append([Cell(case), write.number(force), write.place(at)])
    yield Table(
        write("sums"), [write("case"), write("sum") + in_unit(units.force), write("resultant")], rows[:_MOST_ROWS]
    )
    yield from pictures.of_cases(of.results, write)


def combinations(of: Contents) -> Iterator[Block]:
    """Yield the combinations with their factors, a table for each group."""
    write, every = of.write, of.results.model.effective_combinations
    listed = [every[row] for row in range(min(len(every), _MOST_ROWS))]
    if len(every) > _MOST_ROWS:
        yield Text(write("more_combinations", count=len(every), shown=_MOST_ROWS))
    for group in dict.fromkeys(one.group for one in listed):
        own = [one for one in listed if one.group == group]
        cases = list(dict.fromkeys(case for one in own for case, factor in (one.factors or {}).items() if factor))
        rows = [
            [Cell(of.code(one.name)), *(write.number((one.factors or {}).get(case, 0.0) or None) for case in cases)]
            for one in own
        ]
        yield Table(of.captioned("combinations", group), [write("combination"), *cases], rows)


def glossary(of: Contents) -> Iterator[Block]:
    """Yield the quantities of the registry that the results have, with their units."""
    write, rows = of.write, dict[str, Sequence[Cell]]()
    for one in (*in_model(of.results.model, PICTURED.values()), *of.quantities.values()):
        words = write.translated(one.words or one.name.replace("_", " "))
        rows.setdefault(words, [Cell(one.name), Cell(words), Cell(write.unit_of(one) or "–")])
    yield Table(write("glossary"), [write("symbol"), write("meaning"), write("unit")], list(rows.values()))


def section(key: str, blocks: Iterator[Block]) -> Section | None:
    """Section of a report made of blocks, without empty tables; None if no block remains."""
    own = [one for one in blocks if not isinstance(one, Table) or one.rows]
    return Section(key, own) if own else None
