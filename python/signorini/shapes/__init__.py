"""Regions and curves of the plane on which loads and supports act."""

from signorini.shapes.regions import Circle, Curve, Floats, Polygon, Polyline, Rectangle, Region, Ring

__all__ = ["Circle", "Curve", "Floats", "Polygon", "Polyline", "Rectangle", "Region", "Ring"]
