"""Outlines of plates with arcs, and holes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, TypeAlias

from pydantic import ConfigDict, Field

from signorini.model.area import Box, Circle, box_complaints
from signorini.model.base import Complaint, Table
from signorini.model.corners import MOST_CORNERS, Corners, contour
from signorini.shapes.contours import Contour, circle, straight

_FORMS = ("rectangle", "circle", "polygon")


class Hole(Table):
    """A hole: exactly one of rectangle, circle, polygon."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [form]} for form in _FORMS]})

    rectangle: Box | None = Field(default=None, description="Sides parallel to the axes: [x0, y0, x1, y1].")
    circle: Circle | None = Field(default=None, description="{ center = [x, y], radius = r }.")
    polygon: Corners | None = Field(default=None, description="Corners, and arcs to them, as the points of a polygon.")

    def _complaints(self) -> Iterator[Complaint]:
        forms = self.given(_FORMS)
        if len(forms) != 1:
            yield (), f"found {' and '.join(forms) or 'none'}; exactly one of {', '.join(_FORMS)} is needed."
        yield from box_complaints(self.rectangle)

    def contour(self, name: str) -> Contour:
        """Draw its outline, every side of one name."""
        if self.rectangle is not None:
            x0, y0, x1, y1 = self.rectangle
            return straight(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), (name,) * 4)
        if self.circle is not None:
            return circle(self.circle.center, self.circle.radius, name)
        assert self.polygon is not None  # it has exactly one of the three
        return contour(self.polygon, name, numbered=False)


Holes: TypeAlias = Annotated[tuple[Hole, ...], Field(max_length=MOST_CORNERS)]
