"""Combinations of load cases: listed, or generated from a table, load patterns, moving loads or a design code."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, chain
from pathlib import Path
from typing import Annotated, Any, Generic, Literal, TypeVar, get_args, overload

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, PlainSerializer, WithJsonSchema

from signorini.design import asce7, en1990
from signorini.design.combining import Rule, Terms, combine, summed, term
from signorini.expression import LARGEST
from signorini.model.base import Complaint, Named, Number, Positive, Text, first_duplicate, unique_list
from signorini.model.cases import RULES, Cases, Gamma, Positions, RuleName, actions_of
from signorini.model.csv_cells import number_in, read_cells
from signorini.model.problems import as_list, describe

_LARGEST_FILE = 200_000_000
"""Largest size in bytes of a CSV file of factors; it suffices for a million combinations of 40 cases."""

Value = TypeVar("Value")

Generate = Literal["table", "patterns", "positions", "en1990", "asce7"]

_KEYS_OF: dict[Generate | None, tuple[str, ...]] = {
    None: ("factors",),
    "positions": ("factors",),
    "table": ("file", "columns", "rows"),
    "patterns": ("permanent", "variable", "exclusive"),
    "en1990": ("rule", "gamma", "xi", "accidental_leading"),
    "asce7": ("rule",),
}


class FrozenMapping(Mapping[str, Value], Generic[Value]):
    """An immutable mapping from names to values; hashable if its values are hashable."""

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[str, Value]) -> None:
        self._items = dict(items)

    def __getitem__(self, name: str) -> Value:
        """Return the value of ``name``."""
        return self._items[name]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names in the mapping."""
        return iter(self._items)

    def __len__(self) -> int:
        """Return the number of names in the mapping."""
        return len(self._items)

    def __hash__(self) -> int:
        """Hash the set of pairs (name, value)."""
        return hash(frozenset(self._items.items()))

    def __repr__(self) -> str:
        """Show the name of the class, and each name with its value."""
        return f"{type(self).__name__}({self._items})"


class Factors(FrozenMapping[float]):
    """Immutable mapping from load cases to their factors in one combination."""


@dataclass(frozen=True)
class Listing:
    """A table of combinations: a row per combination, a column per load case.

    ``source`` is the CSV file of the table, or empty.
    """

    columns: tuple[str, ...]
    names: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]
    source: str = ""
    group: str = ""

    def __len__(self) -> int:
        """Return the number of combinations."""
        return len(self.names)

    def __getitem__(self, index: int) -> tuple[str, Factors]:
        """Return the name and the nonzero factors of the combination in row ``index``."""
        row = zip(self.columns, self.rows[index], strict=True)
        return self.names[index], Factors({case: factor for case, factor in row if factor})

    @property
    def cases(self) -> set[str]:
        """Names of the load cases in the columns."""
        return set(self.columns)


@dataclass(frozen=True)
class Generated:
    """Combinations by the rules of a design code; ``rows`` are pairs of a name, and load cases with their factors."""

    rows: tuple[tuple[str, Terms], ...]
    group: str = ""

    def __len__(self) -> int:
        """Return the number of combinations."""
        return len(self.rows)

    def __getitem__(self, index: int) -> tuple[str, Factors]:
        """Return the name and the factors of combination number ``index``, counted from 0."""
        name, terms = self.rows[index]
        return name, Factors(dict(terms))

    @property
    def cases(self) -> set[str]:
        """Names of the load cases that occur in at least one combination."""
        return {case for _, terms in self.rows for case, _ in terms}


def read_factor_table(value: object) -> Listing | None:
    """Read a CSV file of combinations.

    The header is "name" and the load cases; each row has the name and the factors of a combination. An empty cell is
    the factor 0. An invalid file raises a ValueError with the line number.
    """
    if value is None or isinstance(value, Listing):
        return value
    if not isinstance(value, str | Path):
        raise ValueError(f"found {describe(value)}; it must be the name of a CSV file, in quotes.")
    path = Path(value)
    lines = read_cells(path, _LARGEST_FILE)
    if not lines or len(lines[0]) < 2:
        raise ValueError(
            f'{path} has no header; its first line must be "name" and the load cases, with commas between.'
        )
    first, *columns = (cell.strip() for cell in lines[0])
    if first != "name":
        raise ValueError(
            f'the header of {path} begins with {describe(first)}; its first column must be "name", the names of the '
            "combinations."
        )
    for index, case in enumerate(columns):
        if not case or case in columns[:index]:
            problem = f'has the load case "{case}" twice' if case else "has a column without a load case"
            raise ValueError(f"the header of {path} {problem}.")
    names, rows = [], []
    for number, line in enumerate(lines[1:], start=2):
        if not any(cell.strip() for cell in line):
            continue
        names.append(name := line[0].strip())
        if not name or not name.isprintable() or len(name) > 200:
            found = describe(line[0])
            raise ValueError(f"line {number} of {path} begins with {found}; it must begin with the combination's name.")
        rows.append(_row_factors(line[1:], tuple(columns), path, number))
    if not rows:
        raise ValueError(f"{path} has a header but no rows.")
    return Listing(tuple(columns), tuple(names), tuple(rows), str(value))


def _row_factors(cells: list[str], columns: tuple[str, ...], path: Path, number: int) -> tuple[float, ...]:
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
    """Convert a factor or a list of factors of a load case to a list; refuse empty lists, zeros and duplicates."""
    value = as_list(value)
    listed = value if isinstance(value, list | tuple) else [value]
    if not listed:
        raise ValueError("found an empty list; it must be a factor or a list of factors.")
    for index, factor in enumerate(listed):
        if factor == 0 and not isinstance(factor, bool):
            raise ValueError("found the factor 0; remove it. Patterns already include the absence of a variable case.")
        if factor in listed[:index]:
            raise ValueError(f"the factor {describe(factor)} is listed twice.")
    return listed


def _single_factor(value: object) -> object:
    """Refuse a list of factors where a single factor is required."""
    if isinstance(value, list | tuple):
        raise ValueError(
            f"found {describe(value)}; it must be a number. Only the keys permanent and variable of "
            'generate = "patterns" take lists of factors.'
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


_RULE = {"enum": list(get_args(RuleName))}
_RULE_SCHEMA = WithJsonSchema({"anyOf": [_RULE, {"type": "array", "items": _RULE, "minItems": 1}]})
Row = Annotated[tuple[Number, ...], BeforeValidator(_row)]
Rows = Annotated[Mapping[Text, Row], Field(min_length=1), AfterValidator(FrozenMapping), PlainSerializer(dict)]


class Combination(Named):
    """A combination of load cases with factors; with the key ``generate``, a description of many combinations."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [
                {"required": ["factors"]},
                {"required": ["generate"], "properties": {"generate": {"enum": ["table", "patterns", *RULES]}}},
            ]
        }
    )

    name: Text = Field(
        default="",
        description='Unique name, default "combination 1", "combination 2" and so on; names of patterns and '
        "positions begin with it, and names by a design code only if two tables have the same rule.",
    )
    group: Text = Field(
        default="",
        description="Group of the combination, such as ULS or SLS; each group has its own envelope and governing "
        "combinations, beside those of all combinations; default: no group.",
    )
    factors: (
        Annotated[
            Mapping[Text, Annotated[Number, BeforeValidator(_single_factor)]],
            AfterValidator(Factors),
            PlainSerializer(dict),
        ]
        | None
    ) = Field(
        default=None,
        description="Factor of each load case, as in { G = 1.35, Q = 1.5 }; other load cases do not act.",
    )
    generate: Generate | None = Field(
        default=None,
        description="Source of many combinations: rows of a table; all patterns of variable cases with all permanent "
        "cases; all positions of the moving loads in factors; or the rules of EN 1990 or ASCE/SEI 7.",
    )
    file: Annotated[
        Listing | None,
        BeforeValidator(read_factor_table),
        PlainSerializer(lambda table: table.source if table else None),
        WithJsonSchema({"type": "string"}),
    ] = Field(
        default=None,
        description='For generate = "table": a CSV file, relative to the input file; the header is name and the load '
        "cases, each further row is a combination.",
    )
    columns: tuple[Text, ...] | None = Field(
        default=None,
        min_length=1,
        description='For generate = "table" without file: load cases, in the order of the factors in rows.',
    )
    rows: Rows | None = Field(
        default=None,
        description='For generate = "table" without file: factors of each combination, in the order of columns.',
    )
    permanent: ByCase | None = Field(
        default=None,
        description='For generate = "patterns": factor, or list of factors, of each load case that always acts.',
    )
    variable: ByCase | None = Field(
        default=None,
        description='For generate = "patterns": factor, or list of factors, of each load case that may be absent.',
    )
    exclusive: tuple[Annotated[tuple[Text, ...], Field(min_length=2)], ...] = Field(
        default=(),
        description='For generate = "patterns": lists of variable cases; at most one case of each list acts at a time.',
    )
    rule: Annotated[tuple[RuleName, ...], unique_list(str, "a rule or a list of rules"), _RULE_SCHEMA] | None = Field(
        default=None, description='For generate = "en1990" or "asce7": a rule of the code, or a list of rules.'
    )
    gamma: Gamma | None = Field(
        default=None, description='For generate = "en1990": partial factors in place of the recommended factors.'
    )
    xi: Annotated[Positive, Field(le=1)] | None = Field(
        default=None, description="For the rule 6.10ab: factor ξ of unfavourable permanent cases; default 0.85."
    )
    accidental_leading: Literal["psi1", "psi2"] | None = Field(
        default=None, description="For the rule accidental: factor ψ1 or ψ2 of the leading action; default psi1."
    )

    def _complaints(self) -> Iterator[Complaint]:
        if self.generate is None and self.factors is None:
            yield (
                ("factors",),
                "'factors' is missing. Give the factor of each load case, as in { G = 1.35, Q = 1.5 }.",
            )
        all_keys = {key for keys in _KEYS_OF.values() for key in keys}
        for key in sorted(all_keys - set(_KEYS_OF[self.generate])):
            if getattr(self, key) not in (None, ()):
                allowed = [
                    f'generate = "{generate}"' for generate, keys in _KEYS_OF.items() if generate and key in keys
                ]
                here = f'generate = "{self.generate}"' if self.generate else "a combination without generate"
                yield (key,), f"{key} is not allowed with {here}; it is for {' or '.join(allowed)}."
        match self.generate:
            case "positions" if self.factors is None:
                yield (
                    ("factors",),
                    "'factors' is missing. Give the factors of cases of [[moving]], and of cases that act with them.",
                )
            case "table":
                yield from self._table_complaints()
            case "patterns":
                yield from self._pattern_complaints()
            case "en1990" | "asce7":
                yield from self._rule_complaints()

    def _rule_complaints(self) -> Iterator[Complaint]:
        own = RULES[self.generate or ""]
        allowed = ", ".join(own)
        if not self.rule:
            yield ("rule",), f"'rule' is missing. It must be one or more of {allowed}."
        elif others := [rule for rule in self.rule if rule not in own]:
            yield ("rule",), f'"{others[0]}" is no rule of {self.generate}; its rules are {allowed}.'
        elif self.generate == "en1990":
            recommended = en1990.GAMMA[self.rule[0]]
            if self.gamma is not None and any(en1990.GAMMA[rule] != recommended for rule in self.rule):
                yield ("gamma",), "the rules have different recommended factors; give each rule a table of its own."
            for kind in (self.gamma.values.keys() if self.gamma else set()) - recommended.keys():
                yield ("gamma", kind), f'the rule "{self.rule[0]}" has no factor of {kind} cases.'
            for key, rule in (("xi", "6.10ab"), ("accidental_leading", "accidental")):
                if getattr(self, key) is not None and rule not in self.rule:
                    yield (key,), f'{key} is for the rule "{rule}".'

    @property
    def rules(self) -> dict[str, list[Rule]]:
        """Combination rules of the design code, for each name in the key ``rule``."""
        if self.generate == "asce7":
            return {name: list(asce7.rules(name)) for name in self.rule or ()}
        gamma = self.gamma.values if self.gamma is not None else {}
        leading = en1990.PSI2 if self.accidental_leading == "psi2" else en1990.PSI1
        return {name: list(en1990.rules(name, gamma, self.xi or en1990.XI, leading)) for name in self.rule or ()}

    def _table_complaints(self) -> Iterator[Complaint]:
        keys = self.present(("columns", "rows"))
        if (self.file is not None) == bool(keys):
            yield (), 'generate = "table" needs either file, or columns and rows.'
        elif len(keys) == 1:
            missing = "rows" if keys == ["columns"] else "columns"
            yield (missing,), f"'{missing}' is missing; it is required with {keys[0]}."
        if self.columns is None or self.rows is None:
            return
        if (repeated := first_duplicate(self.columns)) is not None:
            yield ("columns",), f'"{repeated}" is listed twice.'
        for name, row in self.rows.items():
            if len(row) != len(self.columns):
                yield ("rows", name), f"found {len(row)} factors; columns lists {len(self.columns)} cases."

    def _pattern_complaints(self) -> Iterator[Complaint]:
        if self.variable is None:
            yield ("variable",), "'variable' is missing. Give the cases that may be absent, as in { Q = 1.5 }."
            return
        for case in sorted(self.variable.keys() & (self.permanent or {}).keys()):
            yield ("variable", case), f'"{case}" is both permanent and variable; remove it from one of the two keys.'
        seen: set[str] = set()
        for position, group in enumerate(self.exclusive):
            for case in group:
                if case not in self.variable:
                    yield ("exclusive", position), f'"{case}" is not a variable case.'
                elif case in seen:
                    yield ("exclusive", position), f'"{case}" is listed twice; a case may be in one list only.'
                seen.add(case)

    @property
    def acting(self) -> frozenset[str]:
        """Names of the load cases with a nonzero factor."""
        return frozenset(case for case, factor in (self.factors or {}).items() if factor)

    @property
    def listing(self) -> Listing:
        """Table of factors for ``generate = "table"``, from the key ``file`` or from ``columns`` and ``rows``."""
        if self.file is not None:
            return self.file
        assert self.columns is not None and self.rows is not None  # Validation requires both keys without a file.
        return Listing(self.columns, tuple(self.rows), tuple(self.rows.values()))

    @property
    def cases(self) -> dict[str, tuple[str | int, ...]]:
        """Map from each load case that this table names to its path in this table, where it occurs first."""
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
        """All factors that this table lists for a load case; factors by a design code are not included."""
        factors = {self.factors[case]} if self.factors is not None and case in self.factors else set()
        factors.update(*((table or {}).get(case, ()) for table in (self.permanent, self.variable)))
        if self.generate == "table" and case in (columns := self.listing.columns):
            factors |= {row[columns.index(case)] for row in self.listing.rows}
        return factors


@dataclass(frozen=True)
class Choice:
    """One choice of a slot of the Cartesian product `Product`: a load case, its factor, and its term in the name.

    ``case`` is empty for the choice that no load case of the slot acts.
    """

    term: str = ""
    case: str = ""
    factor: float = 0.0


@dataclass(frozen=True)
class Product:
    """Combinations as the Cartesian product of slots: each combination takes one choice from each slot.

    The choice of the last slot varies fastest. ``fixed`` are load cases and factors of every combination.
    """

    name: str
    fixed: tuple[tuple[str, float], ...]
    slots: tuple[tuple[Choice, ...], ...]
    group: str = ""

    def __len__(self) -> int:
        """Return the number of combinations."""
        return math.prod(len(choices) for choices in self.slots)

    def __getitem__(self, index: int) -> tuple[str, Factors]:
        """Return the name and the factors of combination number ``index``, counted from 0."""
        chosen: list[Choice] = []
        for choices in reversed(self.slots):
            index, number = divmod(index, len(choices))
            chosen.insert(0, choices[number])
        factors = dict(self.fixed) | {choice.case: choice.factor for choice in chosen if choice.case}
        terms = summed([choice.term for choice in chosen if choice.term])
        return ": ".join(part for part in (self.name, terms) if part), Factors(factors)

    @property
    def cases(self) -> set[str]:
        """Names of the load cases that occur in at least one combination."""
        return {case for case, _ in self.fixed} | {c.case for choices in self.slots for c in choices if c.case}


Expanded = Product | Listing | Generated
"""Combinations of one table [[combination]]; a table of factors with moving loads gives one `Product` per row."""


@dataclass(frozen=True, eq=False)
class Combinations(Sequence[Combination]):
    """All combinations of a model, in the order of the tables [[combination]] that list or generate them."""

    products: tuple[Expanded, ...]

    def __post_init__(self) -> None:
        """Compute, for each entry of ``products``, the index that follows its last combination."""
        object.__setattr__(self, "_ends", list(accumulate(len(product) for product in self.products)))

    def __len__(self) -> int:
        """Return the number of combinations."""
        return int(self._ends[-1]) if self.products else 0  # type: ignore[attr-defined]

    @property
    def cases(self) -> set[str]:
        """Names of the load cases that occur in at least one combination."""
        return self.cases_of("")

    def cases_of(self, group: str) -> set[str]:
        """Load cases that occur in at least one combination of ``group``; ``group=""`` means all combinations."""
        return {case for product in self.products if group in ("", product.group) for case in product.cases}

    @overload
    def __getitem__(self, index: int) -> Combination: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Combination]: ...
    def __getitem__(self, index: int | slice) -> Combination | Sequence[Combination]:
        """Return one combination, or a list of the combinations in a slice."""
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"there are {len(self)} combinations; found {index}")
        index %= len(self)
        number = bisect_right(self._ends, index)  # type: ignore[attr-defined]
        first = self._ends[number - 1] if number else 0  # type: ignore[attr-defined]
        name, factors = self.products[number][index - first]
        return Combination.model_construct(name=name, group=self.products[number].group, factors=factors)

    @property
    def groups(self) -> dict[str, int]:
        """Number of combinations of each named group, with the groups in the order of the input."""
        counts: dict[str, int] = {}
        for product in self.products:
            if product.group:
                counts[product.group] = counts.get(product.group, 0) + len(product)
        return counts

    def names(self) -> Iterator[str]:
        """Yield the name of every combination."""
        for product in self.products:
            for index in range(len(product)):
                yield product[index][0]


def products(combination: Combination, positions: Positions, cases: Cases, named: bool = False) -> Iterator[Expanded]:
    """Yield the combinations of one [[combination]] table of the input.

    With ``named``, names of combinations by a code begin with the name of the table.
    """
    group = combination.group
    match combination.generate:
        case None:
            yield Product(combination.name, tuple(_factors(combination).items()), (), group)
        case "positions":
            yield _over_positions(combination.name, _factors(combination), positions, group)
        case "table":
            listing = combination.listing
            if positions.keys() & listing.cases:
                yield from (_over_positions(*listing[index], positions, group) for index in range(len(listing)))
            else:
                yield replace(listing, group=group)
        case "patterns":
            yield Product(combination.name, (), tuple(_patterns(combination, positions)), group)
        case "en1990" | "asce7" as code:
            prefix = f"{combination.name} " if named else ""
            rules, actions = chain.from_iterable(combination.rules.values()), actions_of(cases, positions, code)
            yield Generated(tuple((prefix + name, terms) for name, terms in combine([*rules], actions)), group)


def _factors(combination: Combination) -> Mapping[str, float]:
    assert combination.factors is not None  # Validation refuses a combination without factors.
    return combination.factors


def _over_positions(name: str, factors: Mapping[str, float], positions: Positions, group: str) -> Product:
    """Return a combination for each position of the moving loads in ``factors``, with the other load cases."""
    fixed = tuple((case, factor) for case, factor in factors.items() if case not in positions)
    moving = ((case, factor) for case, factor in factors.items() if case in positions)
    slots = tuple(tuple(Choice(position, position, factor) for position in positions[case]) for case, factor in moving)
    return Product(name, fixed, slots, group)


def _patterns(combination: Combination, positions: Positions) -> Iterator[tuple[Choice, ...]]:
    """Yield the slots of `Product`: one per permanent case, then one per variable case or list of exclusive cases."""

    def choices(case: str, values: Sequence[float]) -> tuple[Choice, ...]:
        names = positions.get(case, (case,))
        return tuple(Choice(term(factor, name), name, factor) for factor in values for name in names)

    assert combination.variable is not None  # Validation refuses patterns without variable cases.
    for case, values in (combination.permanent or {}).items():
        yield choices(case, values)
    grouped = {case: group for group in combination.exclusive for case in group}
    for case in combination.variable:
        group = grouped.get(case, (case,))
        if case == group[0]:
            yield (Choice(), *(choice for name in group for choice in choices(name, combination.variable[name])))
