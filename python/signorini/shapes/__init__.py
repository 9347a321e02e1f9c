"""Regions and curves of the plane on which loads and supports act."""

from signorini.shapes.regions import Circle, Curve, Floats, Polygon, Polyline, Rectangle, Region, Ring
from signorini.shapes.rounded import Rounded

__all__ = ["Circle", "Curve", "Floats", "Polygon", "Polyline", "Rectangle", "Region", "Ring", "Rounded"]
