"""Places of supports, loads and mesh refinements: keys of the input, and the class `Where` that they give."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, JsonValue

from signorini import shapes
from signorini.model import base
from signorini.model.places import AnyArea, Area, Circle
from signorini.shapes import Curve, Polyline, Region, Ring, Whole
from signorini.shapes.arrays import Bools, Floats
from signorini.shapes.outlines import Outline, Point, directions

PlaceKey = Literal["at", "edge", "line", "circle", "area"]

FOOTPRINT = ("patch", "radius")
_MIN_RADIUS = 0.5
"""Smallest radius of a circle along which the mesh has element sides, relative to the element size.

The 12 elements around the smallest circle have sides of about a quarter of the element size.
"""


@dataclass(frozen=True)
class Where:
    """A place on the plate: points, edges, a curve, or an area (a region, or the whole plate).

    ``key`` is the key that gives the place in the input, with "at" also for nodes. ``footprints`` has one region for
    each of the points, or is empty.
    """

    key: PlaceKey
    points: tuple[Point, ...] = ()
    edges: tuple[str, ...] = ()
    curve: Curve | None = None
    region: Region | None = None
    footprints: tuple[Whole, ...] = ()

    @property
    def shape(self) -> Curve | Region | None:
        """The curve or the region of the place; None for points, edges and the whole plate."""
        return self.curve if self.curve is not None else self.region

    @property
    def shapes(self) -> tuple[Curve | Region, ...]:
        """The curve or the region of the place, followed by the footprints of its points."""
        return (*(() if self.shape is None else (self.shape,)), *self.footprints)

    @property
    def outline(self) -> Outline:
        """Segments, circles and arcs of the curve or of the region's boundary; empty for other places."""
        return Outline() if self.shape is None else self.shape.outline

    def covers(self, points: Floats) -> Bools:
        """Mask (q,) of the points (q, 2) in the region; all points if the place has no region."""
        return np.ones(len(points), np.bool_) if self.region is None else self.region.contains(points)


def curve_of(line: tuple[Point, ...] | None, circle: Circle | None) -> Curve | None:
    """The curve of a line or a circle of the input; None if both are None."""
    if line is not None:
        return Polyline(line)
    return None if circle is None else Ring(circle.center, circle.radius)


def mesh_follows(curve: Curve, size: float) -> bool:
    """Whether element sides follow a curve in a mesh of element size ``size``: all curves but too small circles."""
    return not isinstance(curve, Ring) or curve.radius >= _MIN_RADIUS * size


def one_of(keys: tuple[str, ...]) -> list[JsonValue]:
    """Value of ``oneOf`` in a JSON Schema that requires exactly one of ``keys``."""
    return [{"required": [key]} for key in keys]


class Located(base.Table):
    """Base class of tables with a place on the plate, which exactly one of the keys ``places`` gives."""

    places: ClassVar[tuple[str, ...]] = ("at", "edge", "line", "circle", "area")

    at: base.Points | None = Field(
        default=None, description="A point [x, y] or a list of points, anywhere on the plate."
    )
    edge: base.Edges | None = Field(default=None, description="An edge of the plate by name, or a list of names.")
    line: base.Polyline | None = Field(default=None, description="A line through points [[x, y], [x, y], ...].")
    circle: Circle | None = Field(default=None, description="A circle, not a disc: { center = [x, y], radius = r }.")
    area: AnyArea | None = Field(
        default=None, description='"all" (the whole plate), or a table with one of rectangle, circle, polygon, annulus.'
    )

    @property
    def place(self) -> PlaceKey:
        """The key that gives the place; "area" for a table without a place, which acts on the whole plate."""
        keys: tuple[PlaceKey, ...] = ("at", "edge", "line", "circle")
        return next((key for key in keys if getattr(self, key) is not None), "area")

    @property
    def where(self) -> Where:
        """The place that the keys of the table give."""
        region = self.area.region if isinstance(self.area, Area) else None
        return Where(
            self.place, self.at or (), self.edge or (), curve_of(self.line, self.circle), region, self._footprints()
        )

    def _footprints(self) -> tuple[Whole, ...]:
        return ()

    def _place_complaints(self, meaning: str) -> Iterator[base.Complaint]:
        """Yield a problem unless exactly one place is given.

        ``meaning`` completes the message "exactly one of at, edge, ... gives".
        """
        keys = self.present(self.places)
        if len(keys) != 1:
            found = " and ".join(keys) or "none"
            yield (), f"found {found}; exactly one of {', '.join(self.places)} gives {meaning}."


class Acting(Located, base.OnPlate):
    """Base class of supports and loads; their points may have footprints."""

    places: ClassVar[tuple[str, ...]] = ("at", "nodes", "edge", "line", "circle", "area")

    nodes: base.Nodes | None = Field(
        default=None, description="A node of the mesh file by its number, or a list of numbers."
    )
    patch: (
        Annotated[tuple[base.Positive, base.Positive], *base.vector(2, "a patch [length along x, width along y]")]
        | None
    ) = Field(
        default=None,
        description="Footprint of each point or node: a rectangle [length along x, width along y] around it.",
    )
    angle: Annotated[float, BeforeValidator(base.number)] | None = Field(
        default=None, description="Angle of the rectangle patch: degrees from x to its length, towards y; default 0."
    )
    radius: base.Positive | None = Field(
        default=None, description="Footprint of each point or node: radius of a disc around it."
    )

    @property
    def place(self) -> PlaceKey:
        """The key that gives the place; "at" for the key ``nodes``, since nodes are points."""
        return "at" if self.nodes is not None else super().place

    @property
    def has_footprint(self) -> bool:
        """Whether the points have footprints: ``patch`` or ``radius`` is given."""
        return bool(self.present(FOOTPRINT))

    @property
    def width(self) -> tuple[float, float]:
        """Shorter and longer side of the footprint: (diameter, diameter) of a disc, (0, 0) without a footprint."""
        a, b = self.patch or (2.0 * (self.radius or 0.0),) * 2
        return min(a, b), max(a, b)

    def _footprints(self) -> tuple[Whole, ...]:
        points = self.at or ()
        if self.radius is not None:
            return tuple(shapes.Circle(point, self.radius) for point in points)
        if self.patch is None:
            return ()
        a, b = self.patch
        if self.angle:
            ((c, s),) = directions(np.array([self.angle])).tolist()
            corners = [(0.5 * u * a, 0.5 * v * b) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            return tuple(
                shapes.Polygon(tuple((x + c * u - s * v, y + s * u + c * v) for u, v in corners)) for x, y in points
            )
        return tuple(shapes.Rectangle(x - 0.5 * a, y - 0.5 * b, x + 0.5 * a, y + 0.5 * b) for x, y in points)

    def _footprint_complaints(self) -> Iterator[base.Complaint]:
        keys = self.present(FOOTPRINT)
        if len(keys) > 1:
            yield ("radius",), "found both patch and radius; give one."
        elif keys and not self.present(("at", "nodes")):
            yield (keys[0],), f"{keys[0]} is the footprint of points; use it with at or nodes."
        if self.angle is not None and self.patch is None:
            yield ("angle",), "angle rotates a patch, but patch is missing."
