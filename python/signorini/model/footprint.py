"""Footprints: the area over which a force, a couple or a support at a point is spread."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Annotated, Protocol

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema

from signorini import shapes
from signorini.model.base import Complaint, Positive, listed, number, numbers_schema
from signorini.shapes.contours import directions

KEYS = ("patch", "radius")

Patch = Annotated[
    Annotated[
        tuple[Positive, Positive],
        BeforeValidator(listed(2, "a patch [length along x, width along y]")),
        WithJsonSchema(numbers_schema(2)),
    ]
    | None,
    Field(description="Footprint of each point of at or nodes: a rectangle [length along x, width along y] about it."),
]
Angle = Annotated[
    Annotated[float, BeforeValidator(number)] | None,
    Field(description="Turns the patch: degrees from x to its first side, towards y; default 0."),
]
Radius = Annotated[Positive | None, Field(description="Footprint of each point of at or nodes: a disc about it.")]


class AtPoints(Protocol):
    """A support or load, as far as it may be at points."""

    @property
    def at(self) -> tuple[tuple[float, float], ...] | None:
        """The points."""

    @property
    def patch(self) -> tuple[float, float] | None:
        """The lengths of a rectangle about each."""

    @property
    def angle(self) -> float | None:
        """By how many degrees the rectangles are turned."""

    @property
    def radius(self) -> float | None:
        """The radius of a disc about each."""

    def given(self, keys: Iterable[str]) -> list[str]:
        """Those of the keys that have a value."""


def footprint_complaints(item: AtPoints) -> Iterator[Complaint]:
    """Yield what is wrong with the footprint of a support or load."""
    keys = item.given(KEYS)
    if len(keys) > 1:
        yield ("radius",), "found both patch and radius; give one."
    elif keys and not item.given(("at", "nodes")):
        yield (keys[0],), f"{keys[0]} is the footprint of points; it goes with at or nodes."
    if item.angle is not None and item.patch is None:
        yield ("angle",), "angle turns a patch, and there is none."


def footprints(item: AtPoints) -> tuple[shapes.Rectangle | shapes.Circle | shapes.Polygon, ...]:
    """The footprint of every point; none where points are points.

    Examples
    --------
    >>> from signorini.model import Load
    >>> footprints(Load(force=20e3, at=[[2, 3], [4, 3]], patch=[0.5, 1]))[0]
    Rectangle(x0=1.75, y0=2.5, x1=2.25, y1=3.5)
    """
    points = item.at or ()
    if item.radius is not None:
        return tuple(shapes.Circle(at, item.radius) for at in points)
    if item.patch is None:
        return ()
    a, b = item.patch
    if item.angle:
        ((c, s),) = directions(np.array([item.angle])).tolist()
        around = [(0.5 * u * a, 0.5 * v * b) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        return tuple(
            shapes.Polygon(tuple((x + c * u - s * v, y + s * u + c * v) for u, v in around)) for x, y in points
        )
    return tuple(shapes.Rectangle(x - 0.5 * a, y - 0.5 * b, x + 0.5 * a, y + 0.5 * b) for x, y in points)
