"""Corners of outlines, and arcs to them."""

from __future__ import annotations

import math
from typing import Annotated, Any, TypeAlias

from pydantic import BeforeValidator, Discriminator, Field, Tag

from signorini.model.base import Point, Table
from signorini.model.problems import BRANCHES
from signorini.model.words import as_list, describe
from signorini.shapes.contours import Contour

MOST_CORNERS = 2000
_SAME = 1e-9
"""Part of an outline's size within which its last arc ends at its first corner."""


class Arc(Table):
    """An arc from the corner before it through a point to a corner."""

    through: Point = Field(description="A point of the arc [x, y], near its middle.")
    to: Point = Field(description="The corner [x, y] where it ends.")


def _form(value: object) -> str | None:
    if isinstance(value, dict | Arc):
        return "arc"
    return "point" if isinstance(as_list(value), list | tuple) else None


Corner: TypeAlias = Annotated[
    Annotated[Point, Tag("point")] | Annotated[Arc, Tag("arc")],
    Discriminator(
        _form,
        custom_error_type="area",
        custom_error_message="it must be a corner [x, y], or an arc to one, { through = [x, y], to = [x, y] }.",
    ),
]


def _corners(value: Any) -> object:
    value = as_list(value)
    if not isinstance(value, list | tuple) or len(value) < 3:
        raise ValueError(f"found {describe(value)}; it must be a list of at least 3 corners [x, y].")
    if len(value) > MOST_CORNERS:
        raise ValueError(f"found {len(value)} corners; at most {MOST_CORNERS} are allowed.")
    if isinstance(value[0], dict | Arc):
        raise ValueError("it begins with an arc, which has no corner to start from. Begin with a corner [x, y].")
    if as_list(value[0]) == as_list(value[-1]):
        raise ValueError("the last corner is the first one again; leave it out, the outline closes by itself.")
    return value


Corners: TypeAlias = Annotated[tuple[Corner, ...], BeforeValidator(_corners), Field(json_schema_extra={"minItems": 3})]


def contour(corners: tuple[tuple[float, float] | Arc, ...], name: str, numbered: bool) -> Contour:
    """Draw the outline with such corners; of a last arc that ends at the first corner the corner counts once.

    It ends there if it is nearer to it than a billionth of the outline's size: coordinates of arcs are rounded.

    Examples
    --------
    >>> half = contour(((0, 0), (2, 0), Arc(through=(1, 1), to=(0, 0))), "edge", numbered=True)
    >>> half.corners, half.through, half.names
    (((0, 0), (2, 0)), (None, (1.0, 1.0)), ('edge 1', 'edge 2'))
    """
    points = [corner.to if isinstance(corner, Arc) else corner for corner in corners]
    through = [corner.through if isinstance(corner, Arc) else None for corner in corners]
    size = max(max(axis) - min(axis) for axis in zip(*points, strict=True))
    if through[-1] is not None and math.dist(points[-1], points[0]) <= _SAME * size:
        points.pop()
    else:
        through.append(None)
    names = tuple(f"{name} {i}" if numbered else name for i in range(1, len(points) + 1))
    return Contour(tuple(points), tuple(through[1:]), names)


BRANCHES["points"] = BRANCHES["polygon"] = {"point": Arc, "arc": Arc}
