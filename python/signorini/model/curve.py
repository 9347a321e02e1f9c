"""Lines and circles on which supports, loads and smaller elements are."""

from __future__ import annotations

from typing import Protocol

from signorini.model.area import Circle
from signorini.shapes import Curve, Polyline, Ring

_LEAST_RADIUS = 0.5
"""Part of the element size from which on a circle is worth following: twelve elements around it are half as large."""


class Along(Protocol):
    """A support, load or refinement, as far as it may be on a line."""

    @property
    def line(self) -> tuple[tuple[float, float], ...] | None:
        """Points of a line."""

    @property
    def circle(self) -> Circle | None:
        """A circle whose line it is."""


def curve(item: Along) -> Curve | None:
    """The curve that a line or circle names, or None for other places.

    Examples
    --------
    >>> from signorini.model import Support
    >>> curve(Support(line=[[0, 0], [3, 4]])).length
    5.0
    """
    if item.line is not None:
        return Polyline(item.line)
    if item.circle is not None:
        return Ring(item.circle.center, item.circle.radius)
    return None


def worth_following(along: Curve, size: float) -> bool:
    """Whether elements of some size are to follow a curve: around a small circle they would be too many.

    Examples
    --------
    >>> worth_following(Ring((0.0, 0.0), 0.2), 0.5), worth_following(Ring((0.0, 0.0), 0.3), 0.5)
    (False, True)
    """
    return not isinstance(along, Ring) or along.radius >= _LEAST_RADIUS * size
