"""Outlines of plates with arcs, and holes."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, TypeAlias

from pydantic import Field

from signorini.model.area import Outline
from signorini.model.corners import MOST_CORNERS, contour
from signorini.shapes.contours import Contour, circle, straight


class Hole(Outline):
    """A hole: exactly one of rectangle, circle, polygon."""

    def contour(self, name: str) -> Contour:
        """Draw its outline, of that name, its sides as they are called where they are the plate's."""
        if self.rectangle is not None:
            x0, y0, x1, y1 = self.rectangle
            sides = [f"{name} {side}" for side in ("bottom", "right", "top", "left")]
            return replace(straight(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), sides), whole=name)
        if self.circle is not None:
            return circle(self.circle.center, self.circle.radius, name)
        assert self.polygon is not None  # it has exactly one of the three
        return replace(contour(self.polygon, f"{name} edge", numbered=True), whole=name)


Holes: TypeAlias = Annotated[tuple[Hole, ...], Field(max_length=MOST_CORNERS)]
