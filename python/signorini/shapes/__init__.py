"""Regions and curves of the plane on which loads and supports act."""

from signorini.shapes.regions import (
    Circle,
    Curve,
    Hollow,
    Polygon,
    Polyline,
    Rectangle,
    Region,
    Ring,
    Rounded,
    Whole,
)

__all__ = [
    "Circle",
    "Curve",
    "Hollow",
    "Polygon",
    "Polyline",
    "Rectangle",
    "Region",
    "Ring",
    "Rounded",
    "Whole",
]
