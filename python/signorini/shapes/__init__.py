"""Regions and curves of the plane on which loads and supports act."""

from signorini.shapes.hollow import Hollow, Region
from signorini.shapes.regions import Circle, Curve, Floats, Polygon, Polyline, Rectangle, Ring, Whole
from signorini.shapes.rounded import Rounded

__all__ = [
    "Circle",
    "Curve",
    "Floats",
    "Hollow",
    "Polygon",
    "Polyline",
    "Rectangle",
    "Region",
    "Ring",
    "Rounded",
    "Whole",
]
