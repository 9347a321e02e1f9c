"""How finely a plate is meshed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import BeforeValidator, ConfigDict, Field, StrictBool, WithJsonSchema

from signorini.model.area import AnyArea, Area, Box, Circle
from signorini.model.base import Complaint, Count, Edges, NonNegative, Points, Polyline, Positive, Table, listed, number
from signorini.shapes.outlines import bounds_of

_PLACES = ("at", "edge", "line", "circle", "area")

Divisions = Annotated[
    tuple[Count, Count],
    BeforeValidator(listed(2, "two whole numbers, such as [20, 20]")),
    WithJsonSchema({"type": "array", "items": {"type": "integer", "minimum": 1}, "minItems": 2, "maxItems": 2}),
]


class Refinement(Table):
    """Smaller elements at a place, and around it in so far as sizes grow from there."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [place]} for place in _PLACES]})

    at: Points | None = Field(default=None, description="A point [x, y] or a list of points.")
    edge: Edges | None = Field(default=None, description="An edge of the plate by name, or a list of names.")
    line: Polyline | None = Field(default=None, description="A line through points [[x, y], [x, y], ...].")
    circle: Circle | None = Field(default=None, description="The line of a circle: { center = [x, y], radius = r }.")
    area: AnyArea | None = Field(default=None, description="A table with one of rectangle, circle, polygon.")
    size: Positive = Field(description="Largest side of an element there.")

    def _complaints(self) -> Iterator[Complaint]:
        places = self.given(_PLACES)
        if len(places) != 1:
            result = " and ".join(places) or "none"
            yield (), f"found {result}; exactly one of {', '.join(_PLACES)} says where elements are smaller."
        if self.area == "all":
            yield ("area",), 'found "all"; that is what the size of [mesh] is for.'

    def boxes(self, plate: Box) -> list[Box]:
        """Boxes [x0, y0, x1, y1] around the places, of a rectangle with that box."""
        x0, y0, x1, y1 = plate
        sides = {"left": (x0, y0, x0, y1), "right": (x1, y0, x1, y1), "bottom": (x0, y0, x1, y0)}
        sides["top"] = (x0, y1, x1, y1)
        result = [sides[name] for name in self.edge or ()] + [(x, y, x, y) for x, y in self.at or ()]
        if self.line is not None:
            result.append(bounds_of(self.line))
        if self.circle is not None:
            (x, y), radius = self.circle.center, self.circle.radius
            result.append((x - radius, y - radius, x + radius, y + radius))
        if isinstance(self.area, Area):
            result.append(self.area.region.bounds)
        return result


class MeshOptions(Table):
    """How finely the plate is meshed: by counts or by element size; by default 20 elements along the longer side."""

    model_config = ConfigDict(json_schema_extra={"not": {"required": ["divisions", "size"]}})

    divisions: Divisions | None = Field(
        default=None,
        description="Numbers of elements: [along x, along y] of a rectangle, [radial, around] of a disc or annulus.",
    )
    size: Positive | None = Field(default=None, description="Largest side of an element.")
    refine: tuple[Refinement, ...] = Field(default=(), description="Places with smaller elements.")
    snap: NonNegative = Field(
        default=0.0,
        description="A length; supports, zones and loads nearer than this to an edge or to each other are moved onto "
        "it. Default 0: nothing moves.",
    )
    accuracy: Annotated[float, Field(gt=0, lt=1), BeforeValidator(number)] | None = Field(
        default=None,
        description="Refine until every half-width is at most this part of the largest value of its field.",
    )
    error: StrictBool | None = Field(
        default=None,
        description="Say of every number how far the mesh is from the plate, by the plate's answers on other meshes; "
        "by default where the mesh is not read from a file.",
    )

    def _complaints(self) -> Iterator[Complaint]:
        if self.divisions is not None and self.size is not None:
            yield ("size",), "found both divisions and size; give one of them."
        if self.accuracy is not None and self.error is False:
            yield ("error",), "found false; an accuracy that is asked for needs half-widths. Leave it out."
