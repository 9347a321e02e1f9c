"""Parameters of a study: their places in a model, their values or distributions, and the design of the variants."""

from __future__ import annotations

import csv
import itertools
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from signorini.base.regular import read_regular
from signorini.discretise.rows import Floats
from signorini.errors import InputError, Place, unknown
from signorini.model import Model
from signorini.model.base import Table, number
from signorini.model.problems import describe
from signorini.model.study import Design

Value = Any
"""Value of a parameter, as a key of the input may have it: a number, a text, a list."""

MOST_ROWS = 1_000_000
"""Largest number of variants in one study; the table of so large a study takes about 1 GB."""
_LARGEST_FILE = 400_000_000
"""Largest allowed size in bytes of a CSV file with values of a parameter."""
_PART = re.compile(r'(?:"([^"]+)"|([^."\[\]]+))((?:\[\d+\])*)(?:\.(?=.)|$)')
"""Pattern of one part of a parameter's path: key or name (in quotes if it contains a dot), then positions from 1."""


def _gumbel(mean: float, deviation: float) -> Any:
    from scipy import stats

    scale = deviation * math.sqrt(6.0) / math.pi
    return stats.gumbel_r(mean - np.euler_gamma * scale, scale)


def _lognormal(mean: float, deviation: float) -> Any:
    from scipy import stats

    spread = math.log1p((deviation / mean) ** 2)
    return stats.lognorm(math.sqrt(spread), scale=mean * math.exp(-0.5 * spread))


def _normal(mean: float, deviation: float) -> Any:
    from scipy import stats

    return stats.norm(mean, deviation)


def _uniform(least: float, most: float) -> Any:
    from scipy import stats

    return stats.uniform(least, most - least)


FAMILIES: Mapping[str, tuple[Callable[[float, float], Any], Callable[[float, float], bool], str]] = {
    "normal": (_normal, lambda mean, deviation: deviation > 0, "[mean, standard deviation > 0]"),
    "lognormal": (_lognormal, lambda mean, deviation: mean > 0 < deviation, "[mean > 0, standard deviation > 0]"),
    "gumbel": (_gumbel, lambda mean, deviation: deviation > 0, "[mean, standard deviation > 0] of maxima"),
    "uniform": (_uniform, lambda least, most: least < most, "[least, largest]"),
}
"""For each distribution: function that makes it from two numbers, test of the numbers, their meaning in words."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of a study: its path in the input, and a list of values or, if random, its quantile function."""

    path: str
    values: tuple[Value, ...] = ()
    quantile: Callable[[Floats], Floats] | None = None

    @classmethod
    def of(cls, path: str, given: object, directory: Path) -> Parameter:
        """Read a parameter from its values in the study file; names of CSV files are relative to ``directory``."""
        place = ("parameters", path)
        if isinstance(given, list | tuple | np.ndarray):
            if not len(given):
                raise InputError("the list is empty. Give at least one value.", place)
            return cls(path, tuple(given.tolist() if isinstance(given, np.ndarray) else given))
        match given:
            case {"file": str(file), **others} if not others:
                return cls(path, _column(directory / file, path, place))
            case {"from": low, "to": high, **others} if set(others) <= {"steps"}:
                least, most, steps = _number(low, place), _number(high, place), others.get("steps")
                if steps is None:
                    return cls(path, quantile=_law("uniform", least, most, place))
                if not isinstance(steps, int) or isinstance(steps, bool) or not 2 <= steps <= MOST_ROWS:
                    raise InputError(f"found steps = {describe(steps)}; it must be a whole number from 2 on.", place)
                return cls(path, tuple(np.linspace(least, most, steps).tolist()))
            case dict() if len(given) == 1 and next(iter(given)) in FAMILIES:
                ((family, numbers),) = given.items()
                if not isinstance(numbers, list | tuple) or len(numbers) != 2:
                    raise InputError(f"{family} takes two numbers, {FAMILIES[family][2]}.", place)
                first, second = (_number(each, place) for each in numbers)
                return cls(path, quantile=_law(family, first, second, place))
        laws = ", ".join(f"{{ {family} = {meaning} }}" for family, (_, _, meaning) in FAMILIES.items())
        forms = f'a list of values, {{ from, to, steps }}, {{ file = "table.csv" }}, {laws}'
        raise InputError(f"found {describe(given)}; it must be one of: {forms}.", place)

    @property
    def is_random(self) -> bool:
        """Whether the parameter has a distribution instead of a list of values."""
        return self.quantile is not None

    def at(self, probabilities: Floats) -> tuple[Value, ...]:
        """Values (n,) of the parameter at probabilities (n,); values of a list are equally probable."""
        if self.quantile is not None:
            return tuple(self.quantile(probabilities).tolist())
        return tuple(self.values[int(u * len(self.values))] for u in probabilities)


def _law(family: str, first: float, second: float, place: Place) -> Callable[[Floats], Floats]:
    make, allowed, meaning = FAMILIES[family]
    if not allowed(first, second):
        raise InputError(f"found [{first:g}, {second:g}]; {family} takes {meaning}.", place)
    quantile: Callable[[Floats], Floats] = make(first, second).ppf
    return quantile


def _number(value: object, place: Place) -> float:
    try:
        return number(value)
    except ValueError as error:
        raise InputError(str(error), place) from None


def _column(file: Path, name: str, place: Place) -> tuple[Value, ...]:
    """Values of the column ``name`` of a CSV file; a cell that is not a number gives a text."""
    try:
        lines = read_regular(file, _LARGEST_FILE).decode("utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise InputError(f"{file} cannot be read: {why}.", place) from None
    rows = list(csv.reader(lines))
    header = [cell.strip() for cell in rows[0]] if rows else []
    if name not in header or len(rows) < 2:
        raise InputError(f"{file} needs the column {name} and at least one row; found {', '.join(header)}.", place)
    column = header.index(name)
    short = next((line for line, row in enumerate(rows[1:], 2) if row and len(row) <= column), None)
    if short is not None:
        raise InputError(f"{file}:{short} has no cell in the column {name}.", place)
    return tuple(_cell(row[column]) for row in rows[1:] if row)


def _cell(text: str) -> Value:
    try:
        return float(text)
    except ValueError:
        return text.strip()


def variants(
    parameters: Sequence[Parameter], design: Design, samples: int | None, seed: int
) -> list[tuple[Value, ...]]:
    """Return for each variant the values of all parameters.

    "grid" combines every value of each parameter with every value of the other parameters. "list" gives variant i the
    i-th value of every parameter. "latin" is a Latin hypercube (McKay, Beckman, Conover 1979): for each parameter,
    each of n ranges of probability 1/n contains the value of exactly one of the n variants.

    Examples
    --------
    >>> two = [Parameter("a", (1, 2)), Parameter("b", (3, 4))]
    >>> variants(two, "grid", None, 0), variants(two, "list", None, 0)
    ([(1, 3), (1, 4), (2, 3), (2, 4)], [(1, 3), (2, 4)])
    """
    if design == "latin":
        if samples is None:
            raise InputError('design = "latin" needs the number of variants, such as samples = 1000.', ("samples",))
        from scipy.stats import qmc

        probabilities = qmc.LatinHypercube(len(parameters), seed=np.random.default_rng(seed)).random(samples)
        return list(
            zip(*(one.at(column) for one, column in zip(parameters, probabilities.T, strict=True)), strict=True)
        )
    if samples is not None:
        raise InputError(f'found samples with design = "{design}"; only "latin" has samples.', ("samples",))
    for one in parameters:
        if one.is_random:
            why = f'it is random, but design = "{design}" needs listed values. Use "latin", or {{ from, to, steps }}.'
            raise InputError(why, ("parameters", one.path))
    counts = [len(one.values) for one in parameters]
    if design == "grid":
        if math.prod(counts) > MOST_ROWS:
            why = f"found {math.prod(counts):.3g} variants; at most {MOST_ROWS} are allowed."
            raise InputError(f'{why} Take design = "latin".', ("parameters",))
        return list(itertools.product(*(one.values for one in parameters)))
    if len(set(counts)) > 1:
        each = ", ".join(f"{one.path} has {count}" for one, count in zip(parameters, counts, strict=True))
        raise InputError(
            f'design = "list" needs the same number of values for all parameters; {each}.', ("parameters",)
        )
    return list(zip(*(one.values for one in parameters), strict=True))


def place_of(path: str, model: Model, tables: Mapping[str, Any]) -> Place:
    """Return the place of a parameter in the ``tables`` of a model's input: keys, and positions in lists from 0.

    Raises
    ------
    InputError
        If the model has no such table, entry or key.

    Examples
    --------
    >>> from signorini import Model
    >>> tables = dict(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [10, 8], "thickness": 0.3},
    ...     support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7}],
    ...     load=[{"pressure": 1e3}],
    ... )
    >>> [place_of(path, Model(**tables), tables) for path in ("support.soil.gap", "plate.size[2]")]
    [('support', 0, 'gap'), ('plate', 'size', 1)]
    """
    where = ("parameters", path)
    keys, at = list[str | int](), 0
    while at < len(path):
        part = _PART.match(path, at)
        if part is None:
            raise InputError(
                'a path consists of keys and names, separated by dots, such as "support.soil.stiffness".', where
            )
        keys += [part[1] or part[2].strip(), *(int(position) for position in re.findall(r"\d+", part[3]))]
        at = part.end()
    place, node, raw = list[str | int](), model, tables
    for key in keys:
        found: str | int
        if isinstance(node, Table):
            known = type(node).model_fields
            if key not in known:
                raise InputError(unknown("key", str(key), list(known), type(node).__name__), where)
            found, node = key, getattr(node, str(key))
        elif isinstance(node, Mapping):
            if key not in node:
                raise InputError(unknown("name", str(key), list(node), ".".join(map(str, place))), where)
            found, node = key, node[key]
        elif isinstance(raw, list | tuple):
            if place[-1] == "at" and len(raw) == 1:  # The coordinates of a single point are named at[1] and at[2].
                place, raw, node = [*place, 0], raw[0], raw[0]
            entries = node if isinstance(node, tuple) and node and isinstance(node[0], Table) else raw
            names = [getattr(entry, "name", "") or "" for entry in entries][: len(raw)]
            if isinstance(key, str) and key not in names:
                raise InputError(unknown("name", key, list(filter(None, names)), ".".join(map(str, place))), where)
            found = names.index(key) if isinstance(key, str) else key - 1
            if not 0 <= found < len(raw):
                raise InputError(f"found [{key}]; there are {len(raw)}.", where)
            node = entries[found]
        else:
            raise InputError(f'"{".".join(map(str, place))}" has no part "{key}".', where)
        place.append(found)
        empty: list[Any] = []
        raw = raw.get(found, empty) if isinstance(raw, Mapping) else raw[found] if isinstance(found, int) else empty
    if isinstance(node, Table) or (isinstance(node, tuple) and node and isinstance(node[0], Table)):
        raise InputError(f'"{path}" is a whole table. Name a key of this table.', where)
    return tuple(place)


def changed(tables: Any, place: Place, value: Value) -> Any:
    """Return a copy of nested tables with another value at a place; unchanged tables are shared with the original.

    Examples
    --------
    >>> changed({"load": [{"pressure": 1.0}]}, ("load", 0, "pressure"), 2.0)
    {'load': [{'pressure': 2.0}]}
    """
    if not place:
        return value
    key, rest = place[0], place[1:]
    if isinstance(key, int):
        return [changed(each, rest, value) if index == key else each for index, each in enumerate(tables)]
    return {**tables, key: changed(tables.get(key, {}), rest, value)}
