"""Outlines of plates with arcs, and holes."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from pydantic import Field

from signorini.model.area import Outline
from signorini.model.corners import MOST_CORNERS, contour
from signorini.shapes.contours import Contour, circle, straight


class Hole(Outline):
    """A hole: exactly one of rectangle, circle, polygon."""

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
