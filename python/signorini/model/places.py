"""Tables of the input that describe shapes: outlines, circles, areas, and holes of plates."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import BeforeValidator, ConfigDict, Discriminator, Field, Tag

from signorini import shapes
from signorini.errors import InputError
from signorini.model import base
from signorini.model.problems import BRANCHES, as_list, describe
from signorini.shapes import Region, Whole
from signorini.shapes.outlines import Contour, circle, straight

MAX_CORNERS = 2000
"""Largest number of corners of an outline, and of holes of a plate.

The time for finding crossing sides grows with the square of this number.
"""
_SAME_POINT = 1e-9
"""Largest distance, relative to the outline's size, up to which the last arc ends at the first corner."""


class Arc(base.Table):
    """An arc of an outline, from the previous corner through the point ``through`` to the corner ``to``."""

    through: base.Point = Field(description="A point [x, y] of the arc, near the middle of the arc.")
    to: base.Point = Field(description="The corner [x, y] where the arc ends.")


def _form(value: object) -> str | None:
    if isinstance(value, dict | Arc):
        return "arc"
    return "point" if isinstance(as_list(value), list | tuple) else None


Corner: TypeAlias = Annotated[
    Annotated[base.Point, Tag("point")] | Annotated[Arc, Tag("arc")],
    Discriminator(
        _form,
        custom_error_type="area",
        custom_error_message="it must be a corner [x, y], or an arc to a corner { through = [x, y], to = [x, y] }.",
    ),
]


def _corners(value: Any) -> object:
    value = as_list(value)
    least = 2 if isinstance(value, list | tuple) and any(isinstance(corner, dict | Arc) for corner in value) else 3
    if not isinstance(value, list | tuple) or len(value) < least:
        raise ValueError(f"found {describe(value)}; it must be a list of at least 3 corners [x, y], or 2 with an arc.")
    if len(value) > MAX_CORNERS:
        raise ValueError(f"found {len(value)} corners; at most {MAX_CORNERS} are allowed.")
    if isinstance(value[0], dict | Arc):
        raise ValueError("it begins with an arc, which needs a corner before it. Begin with a corner [x, y].")
    if as_list(value[0]) == as_list(value[-1]):
        raise ValueError("the last corner equals the first. Remove it: the outline is closed automatically.")
    end = value[-1].get("to") if isinstance(value[-1], dict) else getattr(value[-1], "to", None)
    if len(value) == 2 and as_list(end) == as_list(value[0]):
        raise ValueError("the arc ends where it begins. Give the arc another end, or use circle.")
    return value


Corners: TypeAlias = Annotated[tuple[Corner, ...], BeforeValidator(_corners), Field(json_schema_extra={"minItems": 2})]


def contour(corners: tuple[tuple[float, float] | Arc, ...], name: str, numbered: bool) -> Contour:
    """Return the closed outline with the corners and arcs ``corners``.

    If the last element is an arc that ends at the first corner (tolerance ``_SAME_POINT``), it closes the outline;
    otherwise a straight side does.
    """
    points = [corner.to if isinstance(corner, Arc) else corner for corner in corners]
    through = [corner.through if isinstance(corner, Arc) else None for corner in corners]
    size = max(max(axis) - min(axis) for axis in zip(*points, strict=True))
    if through[-1] is not None and math.dist(points[-1], points[0]) <= _SAME_POINT * size:
        points.pop()
    else:
        through.append(None)
    names = tuple(f"{name} {i}" if numbered else name for i in range(1, len(points) + 1))
    return Contour(tuple(points), tuple(through[1:]), names)


BRANCHES["points"] = BRANCHES["polygon"] = {"point": Arc, "arc": Arc}


_FORMS = ("rectangle", "circle", "polygon")


class Circle(base.Table):
    """A circle; supports and line loads act along it, and where an area is required it is a disc."""

    center: base.Point = Field(default=(0.0, 0.0), description="Center [x, y] of the circle; default [0, 0].")
    radius: base.Positive = Field(description="Radius of the circle.")


Box = Annotated[tuple[base.Number, base.Number, base.Number, base.Number], *base.vector(4, "[x0, y0, x1, y1]")]


def _build_errors(key: str, build: Callable[[], Region]) -> Iterator[base.Complaint]:
    """Call ``build``, which makes a region; if it raises an InputError, yield (key,) and the error's message."""
    try:
        build()
    except InputError as error:
        yield (key,), error.message


class Outline(base.Table):
    """A closed curve, given by exactly one of the keys rectangle, circle, polygon."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [form]} for form in _FORMS]})
    forms: ClassVar[tuple[str, ...]] = _FORMS

    rectangle: Box | None = Field(
        default=None, description="Rectangle with sides parallel to the axes: [x0, y0, x1, y1]."
    )
    circle: Circle | None = Field(default=None, description="Disc: { center = [x, y], radius = r }.")
    polygon: Corners | None = Field(
        default=None,
        description="Polygon: corners [x, y] in order; an arc to a corner is { through = [x, y], to = [x, y] }.",
    )

    def _complaints(self) -> Iterator[base.Complaint]:
        forms = self.present(self.forms)
        if len(forms) != 1:
            yield (), f"found {' and '.join(forms) or 'none'}; exactly one of {', '.join(self.forms)} is needed."
        box = self.rectangle
        if box is not None and not (box[0] < box[2] and box[1] < box[3]):
            yield ("rectangle",), f"found {list(box)}; [x0, y0, x1, y1] needs x0 < x1 and y0 < y1."


class Form(Outline):
    """A region of the plane without holes, given by exactly one of rectangle, circle, polygon."""

    def _complaints(self) -> Iterator[base.Complaint]:
        yield from super()._complaints()
        if self.polygon is not None:
            yield from _build_errors("polygon", lambda: self.whole)

    @cached_property
    def whole(self) -> Whole:
        """The region inside the rectangle, circle or polygon of this table."""
        if self.rectangle is not None:
            return shapes.Rectangle(*self.rectangle)
        if self.circle is not None:
            return shapes.Circle(self.circle.center, self.circle.radius)
        assert self.polygon is not None  # Validation requires rectangle, circle or polygon.
        drawn = contour(self.polygon, "", numbered=False)
        if not any(drawn.through):
            return shapes.Polygon(drawn.corners)
        try:
            shapes.Polygon(tuple((x, y) for x, y in drawn.points().tolist()))
        except InputError:
            raise InputError(
                "The polygon crosses or touches itself. List corners and arcs in order around the outline, or split it "
                "into several polygons."
            ) from None
        return shapes.Rounded(drawn)


class Annulus(base.Table):
    """The area between two concentric circles."""

    center: base.Point = Field(default=(0.0, 0.0), description="Center [x, y] of both circles; default [0, 0].")
    inner: base.Positive = Field(description="Radius of the inner circle.")
    outer: base.Positive = Field(description="Radius of the outer circle.")

    def _complaints(self) -> Iterator[base.Complaint]:
        if not self.inner < self.outer:
            yield ("inner",), f"found {self.inner:g}; it must be less than outer, {self.outer:g}."


class Area(Form):
    """An area of the plate, given by exactly one of rectangle, circle, polygon, annulus, with optional holes."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [form]} for form in (*_FORMS, "annulus")]})
    forms: ClassVar[tuple[str, ...]] = (*_FORMS, "annulus")

    annulus: Annulus | None = Field(
        default=None, description="Ring between two circles: { center = [x, y], inner = r, outer = R }."
    )
    holes: tuple[Form, ...] = Field(
        default=(), description="Holes of the area, each a table with one of rectangle, circle, polygon."
    )

    def _complaints(self) -> Iterator[base.Complaint]:
        wrong = list(super()._complaints())
        yield from wrong
        if self.holes and not wrong:
            yield from _build_errors("holes", lambda: self.region)

    @cached_property
    def region(self) -> Region:
        """The area as a region, with its holes."""
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


class Hole(Outline):
    """A hole of the plate, given by exactly one of rectangle, circle, polygon."""

    def contour(self, name: str) -> Contour:
        """Return the outline of the hole; its sides are named as the plate's sides ("hole 1 left", "hole 1 edge 2")."""
        if self.rectangle is not None:
            x0, y0, x1, y1 = self.rectangle
            sides = [f"{name} {side}" for side in ("bottom", "right", "top", "left")]
            return replace(straight(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), sides), whole=name)
        if self.circle is not None:
            return circle(self.circle.center, self.circle.radius, name)
        assert self.polygon is not None  # Validation requires rectangle, circle or polygon.
        return replace(contour(self.polygon, f"{name} edge", numbered=True), whole=name)


Holes: TypeAlias = Annotated[tuple[Hole, ...], Field(max_length=MAX_CORNERS)]
