"""Regions with holes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from signorini.errors import InputError
from signorini.shapes.outlines import Box, Outline, Point
from signorini.shapes.overlap import overlap
from signorini.shapes.regions import Whole

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

_SAME = 1e-6
"""Part of a hole's area that is rounding, where it touches what is beside it."""


@dataclass(frozen=True)
class Hollow:
    """A region without its holes.

    Raises
    ------
    InputError
        If a hole is not within the region, or overlaps another one.

    Examples
    --------
    >>> from signorini.shapes import Circle
    >>> ring = Hollow(Circle((0.0, 0.0), 2.0), (Circle((0.0, 0.0), 1.0),))
    >>> round(ring.area / np.pi, 12), ring.contains(np.array([[1.5, 0.0], [0.5, 0.0], [0.0, 2.5]])).tolist()
    (3.0, [True, False, False])
    """

    around: Whole
    holes: tuple[Whole, ...]

    def __post_init__(self) -> None:
        """Refuse holes that are not apart, or not within."""
        (around,) = self.around.loops
        for number, hole in enumerate(self.holes):
            (own,) = hole.loops
            size = overlap(own, own)
            if overlap(own, around) < (1.0 - _SAME) * size:
                raise InputError(f"Hole {number + 1} reaches out of the area. Cut it to the area.")
            for other, earlier in enumerate(self.holes[:number]):
                if overlap(own, earlier.loops[0]) > _SAME * size:
                    raise InputError(f"Holes {other + 1} and {number + 1} overlap. Draw them as one.")
        if not self.area > 0.0:
            raise InputError("The holes leave nothing of the area.")

    @cached_property
    def parts(self) -> tuple[Whole, ...]:
        """What is around, and the holes."""
        return (self.around, *self.holes)

    @cached_property
    def outline(self) -> Outline:
        """The outline around and those of the holes."""
        drawn = [part.outline for part in self.parts]
        return Outline(*(np.concatenate([getattr(one, of) for one in drawn]) for of in ("segments", "circles", "arcs")))

    @property
    def loops(self) -> tuple[Floats, ...]:
        """Points (k, 2) along every outline, that around first."""
        return tuple(loop for part in self.parts for loop in part.loops)

    @property
    def corners(self) -> Floats:
        """Corners (c, 2)."""
        return np.concatenate([part.corners for part in self.parts])

    @property
    def x_lines(self) -> tuple[float, ...]:
        """Abscissae a rectangular mesh should have grid lines at."""
        return tuple(sorted({line for part in self.parts for line in part.x_lines}))

    @property
    def y_lines(self) -> tuple[float, ...]:
        """Ordinates a rectangular mesh should have grid lines at."""
        return tuple(sorted({line for part in self.parts for line in part.y_lines}))

    def radii(self, center: Point) -> tuple[float, ...]:
        """Radii of circles around `center` that a round mesh should have."""
        return tuple(radius for part in self.parts for radius in part.radii(center))

    @cached_property
    def area(self) -> float:
        """Area."""
        return self.around.area - sum(hole.area for hole in self.holes)

    @property
    def bounds(self) -> Box:
        """Bounding box xmin, ymin, xmax, ymax."""
        return self.around.bounds

    def contains(self, points: Floats) -> Bools:
        """Whether each of the points (q, 2) is inside; on the outline of a hole either answer may come."""
        inside = self.around.contains(points)
        for hole in self.holes:
            inside &= ~hole.contains(points)
        return inside


Region: TypeAlias = Whole | Hollow
