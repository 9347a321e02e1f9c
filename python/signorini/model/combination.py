"""Combinations of load cases: written out one by one, or generated from a table, from patterns, from positions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Generic, Literal, TypeVar

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, PlainSerializer, WithJsonSchema

from signorini.model.base import Complaint, Number, Table, Text
from signorini.model.factortable import FactorTable, read_factor_table
from signorini.model.words import as_list, describe

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


class Combination(Table):
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
        FactorTable | None,
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
        written = self.given(("columns", "rows"))
        if (self.file is not None) == bool(written):
            yield (), 'generate = "table" needs either file, or columns and rows.'
        elif len(written) == 1:
            other = "rows" if written == ["columns"] else "columns"
            yield (other,), f"'{other}' is missing; it goes with {written[0]}."
        if self.columns is None or self.rows is None:
            return
        repeated = next((case for i, case in enumerate(self.columns) if case in self.columns[:i]), None)
        if repeated is not None:
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
