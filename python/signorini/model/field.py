"""Values of a key that vary over the plate: from a CSV file, a list of points, or a Python function."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import pydantic
from pydantic import PlainSerializer, PlainValidator, WithJsonSchema

from signorini.errors import InputError
from signorini.expression import LARGEST, Expression, Field, PointValues
from signorini.expression.field import Outside
from signorini.model import base
from signorini.model.csv_cells import number_in, read_cells
from signorini.model.problems import as_list, describe

_LARGEST_FILE = 20_000_000
"""Largest size in bytes of a CSV file of points; it suffices for about a million points."""


def _read_points(value: object) -> Field:
    """Read a CSV file with the columns x, y and value, with or without a header."""
    if not isinstance(value, str | Path) or not str(value):
        raise ValueError(f"found {describe(value)}; it must be the name of a CSV file, in quotes.")
    rows = []
    for number, cells in enumerate(read_cells(Path(value), _LARGEST_FILE), start=1):
        words = [cell.strip() for cell in cells]
        if not any(words) or (number == 1 and words[:2] == ["x", "y"]):
            continue
        if len(words) != 3:
            raise ValueError(f"line {number} of {value} has {len(words)} columns; it must have three: x, y, value.")
        row = [number_in(word) for word in words]
        for word, parsed in zip(words, row, strict=True):
            if not abs(parsed) <= LARGEST:
                raise ValueError(
                    f"line {number} of {value} has {describe(word)}; it must be a number. A first line that names the "
                    "columns is: x,y,value."
                )
        rows.append((row[0], row[1], row[2]))
    try:
        return Field(tuple(rows), str(value))
    except InputError as error:
        raise ValueError(f"{value}: {error.message}") from None


_Point = Annotated[tuple[base.Number, base.Number, base.Number], *base.vector(3, "a point [x, y, value]")]
_points = pydantic.TypeAdapter(tuple[_Point, ...])


def _read_listed(value: object) -> Field:
    """Read a list of points [x, y, value]."""
    try:
        return Field(_points.validate_python(as_list(value)))
    except InputError as error:
        raise ValueError(error.message) from None


def _outside(value: object) -> Any:
    if isinstance(value, bool) or value not in ("nearest", 0):
        raise ValueError(f'found {describe(value)}; it must be "nearest" or 0.')
    return "nearest" if value == "nearest" else 0


_POINTS: dict[str, Any] = {
    "type": "array",
    "items": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
    "minItems": 3,
}


class FieldTable(base.Table):
    """Values at points (x, y), in a file or in a list; between the points they are interpolated linearly."""

    file: Annotated[Field, PlainValidator(_read_points), WithJsonSchema({"type": "string"})] | None = pydantic.Field(
        default=None, description="A CSV file with the columns x, y and value; its path is relative to the input file."
    )
    points: Annotated[Field, PlainValidator(_read_listed), WithJsonSchema(_POINTS)] | None = pydantic.Field(
        default=None, description="In place of a file: a list of points with values, [[x, y, value], …]."
    )
    outside: Annotated[Outside, PlainValidator(_outside), WithJsonSchema({"enum": ["nearest", 0]})] | None = (
        pydantic.Field(
            default=None,
            description='Value outside the convex hull of the points: "nearest", the value at the nearest point of the '
            "hull, or 0; by default the hull must cover the support.",
        )
    )


def _read(value: object) -> Expression | Field:
    value = as_list(value)
    match value:
        case Field():
            return value
        case Mapping():
            if len(value.keys() & {"file", "points"}) != 1 or not value.keys() <= {"file", "points", "outside"}:
                found = ", ".join(map(str, value)) or "no keys"
                raise ValueError(
                    f'found a table of {found}; it must be {{ file = "…" }} or {{ points = [[x, y, value], …] }}, and '
                    'may have outside = "nearest" or outside = 0.'
                )
            table = FieldTable.model_validate(value)
            field = table.file or table.points
            assert field is not None  # Validation requires exactly one of file and points.
            return replace(field, outside=table.outside)
        case list() | tuple():
            return _read_listed(value)
    if callable(value) and not isinstance(value, Expression):
        return Field(value)
    return base.reader(above=0.0)(value)


_FIELD_SCHEMAS: list[dict[str, Any]] = [
    {"type": "number", "exclusiveMinimum": 0},
    {"type": "string"},
    FieldTable.model_json_schema(),
    _POINTS,
]
FieldScalar = Annotated[
    Expression | Field,
    PlainValidator(_read),
    PlainSerializer(lambda scalar: scalar.source),
    WithJsonSchema({"anyOf": _FIELD_SCHEMAS}),
]
"""A positive number, an expression, or a field: a table with a file or points, or a Python function."""


def _or_point_values(
    read: Callable[[object], Any], limits: dict[str, float], schemas: list[dict[str, Any]] | None = None
) -> tuple[PlainValidator, PlainSerializer, WithJsonSchema]:
    """Annotations of a key whose value is a list with one number per point, or any value that ``read`` validates."""

    def read_each(value: object) -> Any:
        value = as_list(value)
        if isinstance(value, PointValues):
            return value
        if not isinstance(value, list | tuple) or not value or isinstance(as_list(value[0]), list | tuple):
            return read(value)
        values = []
        for position, number in enumerate(value, start=1):
            try:
                values.append(float(read(base.number(number)).value))
            except ValueError as error:
                raise ValueError(f"value {position} of the list: {error}") from None
        return PointValues(tuple(values))

    number: dict[str, Any] = {"type": "number", **limits}
    every = [*(schemas or [number, {"type": "string"}]), {"type": "array", "items": number, "minItems": 1}]
    return PlainValidator(read_each), PlainSerializer(lambda value: value.source), WithJsonSchema({"anyOf": every})


_ABOVE = {"exclusiveMinimum": 0.0}
PointScalar = Annotated[Expression | PointValues, *_or_point_values(base.reader(), {})]
PositivePointScalar = Annotated[Expression | PointValues, *_or_point_values(base.reader(above=0.0), _ABOVE)]
NonNegativePointScalar = Annotated[
    Expression | PointValues, *_or_point_values(base.reader(at_least=0.0), {"minimum": 0.0})
]
PointFieldScalar = Annotated[Expression | Field | PointValues, *_or_point_values(_read, _ABOVE, _FIELD_SCHEMAS)]
"""A positive number, an expression or a field; or a list with one positive number per point."""
