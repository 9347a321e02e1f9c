"""Base classes of the tables of the input, and types of the values of their keys: numbers, points, text, lists."""

from __future__ import annotations

import re
import reprlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from numbers import Integral, Real
from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
    ValidationError,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import InitErrorDetails, PydanticCustomError

from signorini.errors import InputError, Place
from signorini.expression import LARGEST, LEAST, Expression
from signorini.model.problems import as_list, describe, explained

Complaint = tuple[Place, str]


class Table(BaseModel):
    """Base class of a table of the input: immutable; unknown keys are refused.

    Invalid values raise `InputError`, which lists every problem with its place in the input.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    if not TYPE_CHECKING:  # Type checkers derive the constructor's parameters from the fields if `__init__` is hidden.

        def __init__(self, /, *args: object, **keys: object) -> None:
            """Make a table from its keys; invalid values raise the same `InputError` as in an input file."""
            name = type(self).__name__
            if args:
                raise InputError(
                    f"found {reprlib.repr(args[0])}; a table takes its keys by name, as in {name}(key=value, ...) or "
                    f"{name}(**mapping).",
                    place=name,
                )
            try:
                super().__init__(**keys)
            except ValidationError as error:
                raise explained(error, type(self), keys) from None

        # This flag makes pydantic validate nested tables without `__init__`, so that one error lists all problems.
        __init__.__pydantic_base_init__ = True

    def __setattr__(self, name: str, value: object) -> None:
        """Raise an AttributeError if a value is assigned to a key: tables are immutable."""
        if name in type(self).model_fields:
            kind = type(self).__name__
            raise AttributeError(f"{kind} is immutable; make a new {kind} with another {name}.", name=name, obj=self)
        super().__setattr__(name, value)

    def _complaints(self) -> Iterator[Complaint]:
        """Yield (path within this table, message) for each contradiction between keys."""
        yield from ()

    @model_validator(mode="after")
    def _refuse_complaints(self) -> Self:
        complaints = list(self._complaints())
        if complaints:
            raise ValidationError.from_exception_data(
                type(self).__name__,
                [
                    InitErrorDetails(
                        type=PydanticCustomError("complaint", "{message}", {"message": message}), loc=path, input=None
                    )
                    for path, message in complaints
                ],
            )
        return self

    def present(self, keys: Iterable[str]) -> list[str]:
        """Return those of the given keys of this table whose value is not None."""
        return [key for key in keys if getattr(self, key) is not None]


def wrong_length(length: int, points: int) -> str:
    """Error message for a list of ``length`` values that is given for a number ``points`` of points."""
    return f"found a list of {length} for {points} point{'s' * (points != 1)}; give one value per point, or one value."


def number(value: object) -> float:
    """Validate a finite int or float of Python or NumPy; a bool or text is refused."""
    if isinstance(value, bool) or not isinstance(value, Real):
        hint = _number_hint(value) if isinstance(value, str) else ""
        raise ValueError(f"found {describe(value)}; it must be a number.{hint}")
    try:
        result = float(value)
    except OverflowError:
        result = float("inf")
    if not abs(result) <= LARGEST:
        raise ValueError(f"found {describe(value)}; it must be finite and at most {LARGEST:g} in size.")
    return result


def _number_hint(text: str) -> str:
    """Hint for an error message: how to write a number that was given as text."""
    try:
        float(text)
    except ValueError:
        pointed = re.fullmatch(r"\s*([+-]?\d+),(\d+)\s*", text)
        if pointed:
            return f" The decimal sign is a point, and there are no quotes: {pointed[1]}.{pointed[2]}."
        return " Write digits without quotes, such as 30e9."
    return " Write it without quotes."


def _whole(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, Integral):
        raise ValueError(f"found {describe(value)}; it must be a whole number.")
    return int(value)


def _not_tiny(value: float) -> float:
    if value < LEAST:
        raise ValueError(f"found {value:g}; it must be at least {LEAST:g}. Choose other units.")
    return value


def _printable(text: str) -> str:
    if not text.isprintable():
        raise ValueError(f"found {text!r:.60}; line breaks and control characters are not allowed.")
    return text


def reader(above: float | None = None, at_least: float | None = None) -> Callable[[object], Expression]:
    """Return a validator of a number or an expression; a number must be > ``above`` or ≥ ``at_least``, if given."""

    def read(value: object) -> Expression:
        if isinstance(value, Expression):
            expression = value
        else:
            try:
                expression = Expression(value if isinstance(value, str) else number(value))
            except InputError as error:
                raise ValueError(error.message) from None
            except ValueError as error:
                raise ValueError(str(error).replace("a number.", "a number or an expression in x and y.")) from None
        if expression.is_constant:
            if above is not None and not expression.value > above:
                raise ValueError(f"found {expression.value:g}; it must be greater than {above:g}.")
            if at_least is not None and not expression.value >= at_least:
                raise ValueError(f"found {expression.value:g}; it must not be less than {at_least:g}.")
        return expression

    return read


def _scalar(
    above: float | None = None, at_least: float | None = None
) -> tuple[PlainValidator, PlainSerializer, WithJsonSchema]:
    """Annotations (validator, serializer, JSON Schema) of a key whose value is a number or an expression."""
    limits = {"exclusiveMinimum": above} if above is not None else {"minimum": at_least} if at_least is not None else {}
    schema = {"anyOf": [{"type": "number", **limits}, {"type": "string"}]}
    return (
        PlainValidator(reader(above, at_least)),
        PlainSerializer(lambda expression: expression.source),
        WithJsonSchema(schema),
    )


def listed(length: int, form: str) -> Callable[[object], object]:
    """Return a validator of a list of ``length`` values; ``form`` describes the list in error messages."""

    def check(value: object) -> object:
        value = as_list(value)
        if not isinstance(value, list | tuple) or len(value) != length:
            # In a TOML list a number with a decimal comma, such as 1,5, is read as two integers.
            commas = isinstance(value, list) and len(value) == 2 * length and all(type(part) is int for part in value)
            hint = " The decimal sign is a point." if commas else ""
            raise ValueError(f"found {describe(value)}; it must be {form}.{hint}")
        return value

    return check


def _numbers_schema(length: int) -> dict[str, Any]:
    """JSON Schema of a list of ``length`` numbers."""
    return {"type": "array", "items": {"type": "number"}, "minItems": length, "maxItems": length}


def _points(value: object) -> object:
    """Return a list of points unchanged, and a single point [x, y] as a list of one point."""
    value = as_list(value)
    if isinstance(value, list | tuple):
        if any(isinstance(as_list(item), list | tuple) for item in value):
            return value
        if len(value) == 2:
            return [value]
    raise ValueError(f"found {describe(value)}; it must be a point [x, y] or a list of points.")


def _polyline(points: Any) -> object:
    points = as_list(points)
    if not isinstance(points, list | tuple) or len(points) < 2:
        raise ValueError(f"found {describe(points)}; it must be a list of at least 2 points [x, y].")
    for index, (point, after) in enumerate(pairwise(points), start=1):
        if as_list(point) == as_list(after):
            raise ValueError(f"points {index} and {index + 1} are the same.")
    return points


def first_duplicate(values: Sequence[object]) -> object | None:
    """Return the first value of a list that equals an earlier value; None if there are no duplicates."""
    return next((value for index, value in enumerate(values) if value in values[:index]), None)


def unique_list(kind: type, form: str) -> BeforeValidator:
    """Return a validator of a list without duplicates; a single value of type ``kind`` becomes a list of one value."""

    def read(value: object) -> object:
        value = as_list(value)
        if isinstance(value, kind):
            return [value]
        if not isinstance(value, list | tuple) or not value:
            raise ValueError(f"found {describe(value)}; it must be {form}.")
        if (repeated := first_duplicate(value)) is not None:
            raise ValueError(f"{describe(repeated)} is listed twice.")
        return value

    return BeforeValidator(read)


def as_tuple(value: object) -> object:
    """Return a list unchanged, and a single value as a list of one value."""
    value = as_list(value)
    return value if isinstance(value, list | tuple) else [value]


def vector(length: int, form: str) -> tuple[BeforeValidator, WithJsonSchema]:
    """Annotations of a key that takes a list of ``length`` numbers; ``form`` describes the list in error messages."""
    return BeforeValidator(listed(length, form)), WithJsonSchema(_numbers_schema(length))


Flag = Annotated[bool, Field(strict=True)]
Number = Annotated[float, BeforeValidator(number)]
Positive = Annotated[float, Field(gt=0), AfterValidator(_not_tiny), BeforeValidator(number)]
NonNegative = Annotated[float, Field(ge=0), BeforeValidator(number)]
Count = Annotated[int, Field(ge=1, le=100_000), BeforeValidator(_whole)]
Counts = Annotated[
    tuple[Count, ...],
    Field(min_length=1),
    BeforeValidator(as_tuple),
    PlainSerializer(lambda counts: counts[0] if len(counts) == 1 else counts),
    WithJsonSchema(
        {"type": ["integer", "array"], "minimum": 1, "minItems": 1, "items": {"type": "integer", "minimum": 1}}
    ),
]
"""One positive integer or a list of positive integers."""
Stations = Annotated[int, Field(ge=2, le=1000), BeforeValidator(_whole)]
Text = Annotated[str, Field(strict=True, max_length=200), AfterValidator(_printable)]

Scalar = Annotated[Expression, *_scalar()]
PositiveScalar = Annotated[Expression, *_scalar(above=0.0)]
NonNegativeScalar = Annotated[Expression, *_scalar(at_least=0.0)]

Rotation = Annotated[
    tuple[Scalar, Scalar],
    BeforeValidator(listed(2, "two slopes [θx, θy], numbers or expressions in x and y")),
    WithJsonSchema(
        {"type": "array", "items": {"anyOf": [{"type": "number"}, {"type": "string"}]}, "minItems": 2, "maxItems": 2}
    ),
]
Point = Annotated[tuple[Number, Number], *vector(2, "a point [x, y]")]
Points = Annotated[
    tuple[Point, ...],
    BeforeValidator(_points),
    WithJsonSchema({"anyOf": [_numbers_schema(2), {"type": "array", "items": _numbers_schema(2), "minItems": 1}]}),
]
Polyline = Annotated[tuple[Point, ...], BeforeValidator(_polyline), Field(json_schema_extra={"minItems": 2})]
NodeNumber = Annotated[int, Field(ge=0), BeforeValidator(_whole)]
Nodes = Annotated[
    tuple[NodeNumber, ...],
    unique_list(Integral, "the number of a node or a list of numbers"),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "integer", "minimum": 0},
                {"type": "array", "items": {"type": "integer", "minimum": 0}, "minItems": 1, "uniqueItems": True},
            ]
        }
    ),
]
Edges = Annotated[
    tuple[Text, ...],
    unique_list(str, "the name of an edge or a list of names"),
    WithJsonSchema(
        {
            "anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}],
            "examples": ["left", "right", "bottom", "top", "rim", "inner", "outer", "start", "end", "edge 1", "hole 1"],
        }
    ),
]


class OnPlate(Table):
    """Base class of tables that belong to one plate, named by the key ``plate``."""

    plate: Text | None = Field(
        default=None, description="With several plates: name of the plate in [plates] to which this table belongs."
    )


class Named(Table):
    """Base class of tables with the key ``name``."""

    name: Text = Field(default="", description='Unique name; default: type and number of the table, as in "support 1".')
