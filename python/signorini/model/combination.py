"""Combinations of load cases: written out one by one, or generated from a table, from patterns, from positions."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from pathlib import Path
from typing import Annotated, Any, Generic, Literal, TypeVar, overload

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, PlainSerializer, WithJsonSchema

from signorini.expression import LARGEST
from signorini.model.base import Complaint, Named, Number, Text, twice
from signorini.model.csv_cells import number_in, read_cells
from signorini.model.problems import as_list, describe

_LARGEST_FILE = 200_000_000


Value = TypeVar("Value")

Generate = Literal["table", "patterns", "positions"]

_KEYS: dict[Generate | None, tuple[str, ...]] = {
    None: ("factors",),
    "positions": ("factors",),
    "table": ("file", "columns", "rows"),
    "patterns": ("permanent", "variable", "exclusive"),
}


class FrozenMapping(Mapping[str, Value], Generic[Value]):
    """An immutable mapping from names, hashable where its values are."""

    __slots__ = ("_of",)

    def __init__(self, of: Mapping[str, Value]) -> None:
        self._of = dict(of)

    def __getitem__(self, name: str) -> Value:
        """Return what has that name."""
        return self._of[name]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(self._of)

    def __len__(self) -> int:
        """Count the names."""
        return len(self._of)

    def __hash__(self) -> int:
        """Hash the names and what has them."""
        return hash(frozenset(self._of.items()))

    def __repr__(self) -> str:
        """Show the names and what has them."""
        return f"{type(self).__name__}({self._of})"


class Factors(FrozenMapping[float]):
    """Factor of each load case: an immutable mapping."""


@dataclass(frozen=True)
class Listing:
    """Combinations written out in a table, one a row, its columns the load cases; and the file that it is read from."""

    columns: tuple[str, ...]
    names: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]
    source: str = ""
    group: str = ""

    def __len__(self) -> int:
        """Count the combinations."""
        return len(self.names)

    def __getitem__(self, index: int) -> tuple[str, Factors]:
        """Return the name and the factors of one combination."""
        row = zip(self.columns, self.rows[index], strict=True)
        return self.names[index], Factors({case: factor for case, factor in row if factor})

    @property
    def cases(self) -> set[str]:
        """Every case that occurs."""
        return set(self.columns)


def read_factor_table(value: object) -> Listing | None:
    """Read a CSV file whose first column holds names and whose header names the load cases of the others.

    An empty cell is the factor 0. What is wrong with the file is told in a ValueError, with its line.
    """
    if value is None or isinstance(value, Listing):
        return value
    if not isinstance(value, str | Path):
        raise ValueError(f"found {describe(value)}; it must be the name of a CSV file, in quotes.")
    path = Path(value)
    lines = read_cells(path, _LARGEST_FILE)
    if not lines or len(lines[0]) < 2:
        raise ValueError(f'{path} has no header; its first line must be "name" and the load cases, set off by commas.')
    first, *columns = (cell.strip() for cell in lines[0])
    if first != "name":
        raise ValueError(
            f'the header of {path} begins with {describe(first)}; it must begin with "name", the column of the '
            "combinations' names, before the load cases."
        )
    for index, case in enumerate(columns):
        if not case or case in columns[:index]:
            what = f'names the load case "{case}" twice' if case else "has a column without a load case"
            raise ValueError(f"the header of {path} {what}.")
    names, rows = [], []
    for number, line in enumerate(lines[1:], start=2):
        if not any(cell.strip() for cell in line):
            continue
        names.append(name := line[0].strip())
        if not name or not name.isprintable() or len(name) > 200:
            what = describe(line[0])
            raise ValueError(f"line {number} of {path} begins with {what}; it must be the combination's name.")
        rows.append(_factors_of(line[1:], tuple(columns), path, number))
    if not rows:
        raise ValueError(f"{path} has a header but no rows.")
    return Listing(tuple(columns), tuple(names), tuple(rows), str(value))


def _factors_of(cells: list[str], columns: tuple[str, ...], path: Path, number: int) -> tuple[float, ...]:
    if len(cells) != len(columns):
        raise ValueError(f"line {number} of {path} has {len(cells)} factors; the header names {len(columns)} cases.")
    factors = []
    for case, cell in zip(columns, cells, strict=True):
        factor = number_in(cell) if cell.strip() else 0.0
        if not abs(factor) <= LARGEST:
            raise ValueError(f'line {number} of {path} has {describe(cell)} under "{case}"; it must be a number.')
        factors.append(factor)
    return tuple(factors)


def _values(value: object) -> object:
    """Read one number as a list of one; refuse a value that says nothing or says it twice."""
    value = as_list(value)
    listed = value if isinstance(value, list | tuple) else [value]
    if not listed:
        raise ValueError("found an empty list; it must be a factor or a list of factors.")
    for index, factor in enumerate(listed):
        if factor == 0 and not isinstance(factor, bool):
            raise ValueError("found the factor 0; leave it out. A variable case is absent in some patterns anyway.")
        if factor in listed[:index]:
            raise ValueError(f"the factor {describe(factor)} is listed twice.")
    return listed


def _one(value: object) -> object:
    """Refuse a list where one factor belongs."""
    if isinstance(value, list | tuple):
        raise ValueError(
            f'found {describe(value)}; it must be a number. Lists of factors go with generate = "patterns", in '
            "permanent and variable."
        )
    return value


_Number = {"type": "number"}
Values = Annotated[
    tuple[Number, ...],
    BeforeValidator(_values),
    WithJsonSchema({"anyOf": [_Number, {"type": "array", "items": _Number, "minItems": 1}]}),
]
ByCase = Annotated[Mapping[Text, Values], Field(min_length=1), AfterValidator(FrozenMapping), PlainSerializer(dict)]


def _row(value: object) -> object:
    return tuple(as_list(value)) if isinstance(as_list(value), list) else value


Row = Annotated[tuple[Number, ...], BeforeValidator(_row)]
Rows = Annotated[Mapping[Text, Row], Field(min_length=1), AfterValidator(FrozenMapping), PlainSerializer(dict)]


class Combination(Named):
    """A combination of load cases, each with its factor; or, where ``generate`` says how, many combinations."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [
                {"required": ["factors"]},
                {"required": ["generate"], "properties": {"generate": {"enum": ["table", "patterns"]}}},
            ]
        }
    )

    name: Text = Field(
        default="",
        description='Name, each once; default "combination 1", "combination 2", ... Generated names begin with it.',
    )
    group: Text = Field(
        default="",
        description="Group whose envelope and governing combinations are told apart, such as ULS or SLS; left out: "
        "in none but the envelope of all.",
    )
    factors: (
        Annotated[
            Mapping[Text, Annotated[Number, BeforeValidator(_one)]], AfterValidator(Factors), PlainSerializer(dict)
        ]
        | None
    ) = Field(
        default=None,
        description="Factor of each load case, as in { G = 1.35, Q = 1.5 }; a case left out has none. Empty: no load.",
    )
    generate: Generate | None = Field(
        default=None,
        description="table: a row a combination; patterns: every pattern of variable cases, permanent ones always "
        "there; positions: one combination for each position of the moving cases in factors.",
    )
    file: Annotated[
        Listing | None,
        BeforeValidator(read_factor_table),
        PlainSerializer(lambda table: table.source if table else None),
        WithJsonSchema({"type": "string"}),
    ] = Field(
        default=None,
        description="For table: a CSV file, its header name and load cases, a row a combination; looked for beside "
        "the input file.",
    )
    columns: tuple[Text, ...] | None = Field(
        default=None, min_length=1, description="For table, with rows: the load cases of the columns."
    )
    rows: Rows | None = Field(
        default=None, description="For table, with columns: the factors of each combination by its name."
    )
    permanent: ByCase | None = Field(
        default=None, description="For patterns: factor, or list of factors, of cases that are always there."
    )
    variable: ByCase | None = Field(
        default=None, description="For patterns: factor, or list of factors, of cases that may be absent."
    )
    exclusive: tuple[Annotated[tuple[Text, ...], Field(min_length=2)], ...] = Field(
        default=(), description="For patterns: lists of variable cases of which at most one is there."
    )

    def _complaints(self) -> Iterator[Complaint]:
        if self.generate is None and self.factors is None:
            yield (
                ("factors",),
                "'factors' is missing. Factor of each load case, as in { G = 1.35, Q = 1.5 }; a case left out has "
                "none.",
            )
        goes = {key for keys in _KEYS.values() for key in keys}
        for key in sorted(goes - set(_KEYS[self.generate])):
            if getattr(self, key) not in (None, ()):
                with_it = [f'generate = "{way}"' for way, keys in _KEYS.items() if way and key in keys]
                here = f'generate = "{self.generate}"' if self.generate else "a combination without generate"
                yield (key,), f"{key} does not go with {here}; it goes with {' or '.join(with_it)}."
        match self.generate:
            case "positions" if self.factors is None:
                yield (
                    ("factors",),
                    "'factors' is missing. It names the moving cases, and the others that act with them.",
                )
            case "table":
                yield from self._table_complaints()
            case "patterns":
                yield from self._pattern_complaints()

    def _table_complaints(self) -> Iterator[Complaint]:
        written = self.present(("columns", "rows"))
        if (self.file is not None) == bool(written):
            yield (), 'generate = "table" needs either file, or columns and rows.'
        elif len(written) == 1:
            other = "rows" if written == ["columns"] else "columns"
            yield (other,), f"'{other}' is missing; it goes with {written[0]}."
        if self.columns is None or self.rows is None:
            return
        if (repeated := twice(self.columns)) is not None:
            yield ("columns",), f'"{repeated}" is listed twice.'
        for name, row in self.rows.items():
            if len(row) != len(self.columns):
                yield ("rows", name), f"found {len(row)} factors; columns lists {len(self.columns)} cases."

    def _pattern_complaints(self) -> Iterator[Complaint]:
        if self.variable is None:
            yield ("variable",), "'variable' is missing. It names the cases that may be absent, as in { Q = 1.5 }."
            return
        for case in sorted(self.variable.keys() & (self.permanent or {}).keys()):
            yield ("variable", case), f'"{case}" is among the permanent cases too; a case is one or the other.'
        seen: set[str] = set()
        for position, group in enumerate(self.exclusive):
            for case in group:
                if case not in self.variable:
                    yield ("exclusive", position), f'"{case}" is not among the variable cases.'
                elif case in seen:
                    yield ("exclusive", position), f'"{case}" is listed twice; a case stands in one list at most.'
                seen.add(case)

    @property
    def acting(self) -> frozenset[str]:
        """Names of the cases with a factor that is not zero."""
        return frozenset(case for case, factor in (self.factors or {}).items() if factor)

    @property
    def listing(self) -> Listing:
        """The rows of a table."""
        if self.file is not None:
            return self.file
        assert self.columns is not None and self.rows is not None  # one or the other is given
        return Listing(self.columns, tuple(self.rows), tuple(self.rows.values()))

    @property
    def cases(self) -> dict[str, tuple[str | int, ...]]:
        """The load cases that it names, and under which key each first stands."""
        places: dict[str, tuple[str | int, ...]] = {}
        tables: tuple[tuple[str, Any], ...] = (
            ("factors", self.factors),
            ("permanent", self.permanent),
            ("variable", self.variable),
        )
        for key, table in tables:
            for case in table or ():
                places.setdefault(case, (key, case))
        for position, case in enumerate(self.columns or ()):
            places.setdefault(case, ("columns", position))
        for case in self.file.columns if self.file is not None else ():
            places.setdefault(case, ("file",))
        return places

    def factors_of(self, case: str) -> set[float]:
        """Factors that it gives a case."""
        result = {self.factors[case]} if self.factors is not None and case in self.factors else set()
        result.update(*((table or {}).get(case, ()) for table in (self.permanent, self.variable)))
        if self.generate == "table" and case in (columns := self.listing.columns):
            result |= {row[columns.index(case)] for row in self.listing.rows}
        return result


Positions = Mapping[str, Sequence[str]]
"""The cases that a moving load becomes, by its own case."""


@dataclass(frozen=True)
class Choice:
    """One way to fill a place of a pattern: a term of the name, and the factor of one case; or nothing."""

    term: str = ""
    case: str = ""
    factor: float = 0.0


@dataclass(frozen=True)
class Product:
    """Every way to fill each place with one of its choices, the last place changing first."""

    name: str
    fixed: tuple[tuple[str, float], ...]
    places: tuple[tuple[Choice, ...], ...]
    group: str = ""

    def __len__(self) -> int:
        """Count the combinations."""
        return math.prod(len(choices) for choices in self.places)

    def __getitem__(self, index: int) -> tuple[str, Factors]:
        """Return the name and the factors of one combination."""
        chosen: list[Choice] = []
        for choices in reversed(self.places):
            index, which = divmod(index, len(choices))
            chosen.insert(0, choices[which])
        factors = dict(self.fixed) | {choice.case: choice.factor for choice in chosen if choice.case}
        terms = _sum([choice.term for choice in chosen if choice.term])
        return ": ".join(part for part in (self.name, terms) if part), Factors(factors)

    @property
    def cases(self) -> set[str]:
        """Every case that occurs."""
        return {case for case, _ in self.fixed} | {c.case for choices in self.places for c in choices if c.case}


@dataclass(frozen=True, eq=False)
class Combinations(Sequence[Combination]):
    """Combinations in the order of the input, generated ones where their table stands."""

    products: tuple[Product | Listing, ...]

    def __post_init__(self) -> None:
        """Find where each product begins."""
        object.__setattr__(self, "_ends", list(accumulate(len(product) for product in self.products)))

    def __len__(self) -> int:
        """Count the combinations."""
        return int(self._ends[-1]) if self.products else 0  # type: ignore[attr-defined]

    @property
    def cases(self) -> set[str]:
        """Every case that occurs in some combination."""
        return self.cases_of("")

    def cases_of(self, group: str) -> set[str]:
        """Every case that occurs in some combination of a group; with group "" in any combination."""
        return {case for product in self.products if group in ("", product.group) for case in product.cases}

    @overload
    def __getitem__(self, index: int) -> Combination: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Combination]: ...
    def __getitem__(self, index: int | slice) -> Combination | Sequence[Combination]:
        """Make one combination, or those of a slice."""
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"there are {len(self)} combinations; found {index}")
        index %= len(self)
        which = bisect_right(self._ends, index)  # type: ignore[attr-defined]
        name, factors = self.products[which][index - (self._ends[which - 1] if which else 0)]  # type: ignore[attr-defined]
        return Combination.model_construct(name=name, group=self.products[which].group, factors=factors)

    @property
    def groups(self) -> dict[str, int]:
        """How many combinations each group with a name has, in the order of the input."""
        counts: dict[str, int] = {}
        for product in self.products:
            if product.group:
                counts[product.group] = counts.get(product.group, 0) + len(product)
        return counts

    def names(self) -> Iterator[str]:
        """Yield every name."""
        for product in self.products:
            for index in range(len(product)):
                yield product[index][0]


def products(combination: Combination, positions: Positions) -> Iterator[Product | Listing]:
    """What a table of the input stands for."""
    group = combination.group
    match combination.generate:
        case None:
            yield Product(combination.name, tuple(_factors(combination).items()), (), group)
        case "positions":
            yield _of_factors(combination.name, _factors(combination), positions, group)
        case "table":
            listing = combination.listing
            if positions.keys() & listing.cases:
                yield from (_of_factors(*listing[index], positions, group) for index in range(len(listing)))
            else:
                yield replace(listing, group=group)
        case "patterns":
            yield Product(combination.name, (), tuple(_patterns(combination, positions)), group)


def _factors(combination: Combination) -> Mapping[str, float]:
    assert combination.factors is not None  # a combination without factors is refused
    return combination.factors


def _of_factors(name: str, factors: Mapping[str, float], positions: Positions, group: str) -> Product:
    fixed = tuple((case, factor) for case, factor in factors.items() if case not in positions)
    moving = ((case, factor) for case, factor in factors.items() if case in positions)
    places = tuple(tuple(Choice(at, at, factor) for at in positions[case]) for case, factor in moving)
    return Product(name, fixed, places, group)


def _patterns(combination: Combination, positions: Positions) -> Iterator[tuple[Choice, ...]]:
    def choices(case: str, values: Sequence[float]) -> tuple[Choice, ...]:
        places = positions.get(case, (case,))
        return tuple(Choice(_term(factor, at), at, factor) for factor in values for at in places)

    assert combination.variable is not None  # patterns without variable cases are refused
    for case, values in (combination.permanent or {}).items():
        yield choices(case, values)
    grouped = {case: group for group in combination.exclusive for case in group}
    for case in combination.variable:
        group = grouped.get(case, (case,))
        if case == group[0]:
            yield (Choice(), *(choice for name in group for choice in choices(name, combination.variable[name])))


def _term(factor: float, case: str) -> str:
    return case if factor == 1 else f"-{case}" if factor == -1 else f"{factor:.12g} {case}"


def _sum(terms: Sequence[str]) -> str:
    """Join terms the way a sum is written."""
    first, *others = terms or [""]
    return first + "".join(f" - {term[1:]}" if term.startswith("-") else f" + {term}" for term in others)
