"""Circles, and the parts of the plate that supports and loads act on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Annotated, ClassVar, Literal

from pydantic import BeforeValidator, ConfigDict, Discriminator, Field, Tag, WithJsonSchema

from signorini import shapes
from signorini.errors import InputError
from signorini.model.base import (
    Complaint,
    Number,
    Point,
    Positive,
    Table,
    listed,
    numbers_schema,
)
from signorini.model.corners import Corners, contour
from signorini.model.problems import BRANCHES
from signorini.shapes import Region, Whole

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


def box_complaints(box: tuple[float, float, float, float] | None) -> Iterator[Complaint]:
    """Yield what is wrong with a rectangle, if there is one."""
    if box is not None and not (box[0] < box[2] and box[1] < box[3]):
        yield ("rectangle",), f"found {list(box)}; [x0, y0, x1, y1] needs x0 < x1 and y0 < y1."


def _refused(key: str, build: Callable[[], Region]) -> Iterator[Complaint]:
    """Yield why a region cannot be built, at the key that it is built from."""
    try:
        build()
    except InputError as error:
        yield (key,), error.message


class Outline(Table):
    """A closed line: exactly one of rectangle, circle, polygon."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [form]} for form in _FORMS]})
    forms: ClassVar[tuple[str, ...]] = _FORMS

    rectangle: Box | None = Field(default=None, description="Sides parallel to the axes: [x0, y0, x1, y1].")
    circle: Circle | None = Field(default=None, description="A disc: { center = [x, y], radius = r }.")
    polygon: Corners | None = Field(
        default=None, description="Corners [x, y] in order; an arc to a corner is { through = [x, y], to = [x, y] }."
    )

    def _complaints(self) -> Iterator[Complaint]:
        forms = self.given(self.forms)
        if len(forms) != 1:
            yield (), f"found {' and '.join(forms) or 'none'}; exactly one of {', '.join(self.forms)} is needed."
        yield from box_complaints(self.rectangle)


class Form(Outline):
    """A part of the plane without holes."""

    def _complaints(self) -> Iterator[Complaint]:
        yield from super()._complaints()
        if self.polygon is not None:
            yield from _refused("polygon", lambda: self.whole)

    @cached_property
    def whole(self) -> Whole:
        """The region of the plane, without holes."""
        if self.rectangle is not None:
            return shapes.Rectangle(*self.rectangle)
        if self.circle is not None:
            return shapes.Circle(self.circle.center, self.circle.radius)
        assert self.polygon is not None  # it has exactly one of the three
        drawn = contour(self.polygon, "", numbered=False)
        if not any(drawn.through):
            return shapes.Polygon(drawn.corners)
        try:
            shapes.Polygon(tuple((x, y) for x, y in drawn.points().tolist()))
        except InputError:
            raise InputError(
                "The polygon crosses or touches itself. Give corners and arcs in order around the outline, or split it "
                "into several polygons."
            ) from None
        return shapes.Rounded(drawn)


class Annulus(Table):
    """What is between two circles about one center."""

    center: Point = Field(default=(0.0, 0.0), description="Center [x, y]; default [0, 0].")
    inner: Positive = Field(description="Radius of the inner circle.")
    outer: Positive = Field(description="Radius of the outer circle.")

    def _complaints(self) -> Iterator[Complaint]:
        if not self.inner < self.outer:
            yield ("inner",), f"found {self.inner:g}; it must be less than outer, {self.outer:g}."


class Area(Form):
    """A part of the plate: exactly one of rectangle, circle, polygon, annulus, and the holes in it."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [form]} for form in (*_FORMS, "annulus")]})
    forms: ClassVar[tuple[str, ...]] = (*_FORMS, "annulus")

    annulus: Annulus | None = Field(
        default=None, description="{ center = [x, y], inner = r, outer = R }: what is between two circles."
    )
    holes: tuple[Form, ...] = Field(
        default=(), description="Holes in it, each a table with one of rectangle, circle, polygon."
    )

    def _complaints(self) -> Iterator[Complaint]:
        wrong = list(super()._complaints())
        yield from wrong
        if self.holes and not wrong:
            yield from _refused("holes", lambda: self.region)

    @cached_property
    def region(self) -> Region:
        """The region of the plane."""
        holes = tuple(hole.whole for hole in self.holes)
        if self.annulus is not None:
            center, inner, outer = self.annulus.center, self.annulus.inner, self.annulus.outer
            return shapes.Hollow(shapes.Circle(center, outer), (shapes.Circle(center, inner), *holes))
        return shapes.Hollow(self.whole, holes) if holes else self.whole


def _area_form(value: object) -> str | None:
    if isinstance(value, str) and value == "all":
        return "all"
    return "table" if isinstance(value, dict | Area) else None


AnyArea = Annotated[
    Annotated[Literal["all"], Tag("all")] | Annotated[Area, Tag("table")],
    Discriminator(
        _area_form,
        custom_error_type="area",
        custom_error_message='it must be "all" or a table with one of rectangle, circle, polygon, annulus.',
    ),
]
BRANCHES["area"] = {"all": Area, "table": Area}
