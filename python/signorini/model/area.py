"""Circles, and the parts of the plate that supports and loads act on."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, ConfigDict, Discriminator, Field, Tag, WithJsonSchema

from signorini.model.base import (
    Complaint,
    Number,
    Point,
    Polygon,
    Positive,
    Table,
    listed,
    numbers_schema,
)
from signorini.model.problems import BRANCHES

_MOST_CORNERS = 2000
_FORMS = ("rectangle", "circle", "polygon")


class Circle(Table):
    """A circle: its line for a support or line load, its disc for an area."""

    center: Point = Field(default=(0.0, 0.0), description="Center [x, y]; default [0, 0].")
    radius: Positive = Field(description="Radius.")


Box = Annotated[
    tuple[Number, Number, Number, Number],
    BeforeValidator(listed(4, "[x0, y0, x1, y1]")),
    WithJsonSchema(numbers_schema(4)),
]


class Area(Table):
    """A part of the plate: exactly one of rectangle, circle, polygon."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [form]} for form in _FORMS]})

    rectangle: Box | None = Field(default=None, description="Sides parallel to the axes: [x0, y0, x1, y1].")
    circle: Circle | None = Field(default=None, description="A disc: { center = [x, y], radius = r }.")
    polygon: Polygon | None = Field(default=None, description="Corners [[x, y], ...] in order, either way round.")

    def _complaints(self) -> Iterator[Complaint]:
        forms = self.given(_FORMS)
        if len(forms) != 1:
            yield (), f"found {' and '.join(forms) or 'none'}; exactly one of {', '.join(_FORMS)} is needed."
        if self.rectangle is not None:
            x0, y0, x1, y1 = self.rectangle
            if not (x0 < x1 and y0 < y1):
                yield ("rectangle",), f"found {list(self.rectangle)}; [x0, y0, x1, y1] needs x0 < x1 and y0 < y1."
        if self.polygon is not None:
            why = _polygon_fault(np.array(self.polygon))
            if why:
                yield ("polygon",), why


def _polygon_fault(corners: np.ndarray[Any, np.dtype[np.float64]]) -> str:
    """Say why the outline encloses no area of its own, or nothing."""
    count = len(corners)
    if count > _MOST_CORNERS:
        return f"found {count} corners; at most {_MOST_CORNERS} are allowed."
    start, end = corners, np.roll(corners, -1, axis=0)
    for index in range(count - 1):
        first, last = index + 2, count - (index == 0)
        a, b, c, d = start[index], end[index], start[first:last], end[first:last]
        apart = (_cross(b - a, c - a) * _cross(b - a, d - a) < 0) & (_cross(d - c, a - c) * _cross(d - c, b - c) < 0)
        if apart.any():
            other = first + int(np.argmax(apart))
            return f"its outline crosses itself: the side after corner {index + 1} cuts that after corner {other + 1}."
    local = start - start[0]
    if abs(_cross(local, np.roll(local, -1, axis=0)).sum()) <= 1e-12 * (np.ptp(corners, axis=0) ** 2).sum():
        return "it encloses nothing."
    return ""


def _cross(u: Any, v: Any) -> Any:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]


def _area_form(value: object) -> str | None:
    if isinstance(value, str) and value == "all":
        return "all"
    return "table" if isinstance(value, dict | Area) else None


AnyArea = Annotated[
    Annotated[Literal["all"], Tag("all")] | Annotated[Area, Tag("table")],
    Discriminator(
        _area_form,
        custom_error_type="area",
        custom_error_message='it must be "all" or a table with one of rectangle, circle, polygon.',
    ),
]
BRANCHES["area"] = {"all": Area, "table": Area}
