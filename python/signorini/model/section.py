"""Sections through the plate, and strips of it, whose forces and mean moments are written out."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field

from signorini.errors import point
from signorini.model.base import Complaint, Point, Polyline, Positive, Stations, Table, Text
from signorini.shapes import Floats
from signorini.shapes.regions import meeting

_STATIONS = 21
"""Twenty steps meet supports, middles and quarters of one to five equal spans."""
_CLOSED = 1e-5
"""Part of a line's extent within which its ends are one: coordinates are written with so many digits or more."""


def _closing(line: tuple[Point, ...]) -> tuple[Point, ...]:
    """Let a line that ends in its first point but for rounding end there."""
    extent = float(np.ptp(np.array(line), axis=0).max())
    near = len(line) > 2 and math.dist(line[0], line[-1]) <= _CLOSED * extent
    return (*line[:-1], line[0]) if near else line


def _pieces(line: tuple[Point, ...]) -> Floats:
    return np.array(list(pairwise(line)))


class Section(Table):
    """A line through the plate: the force and the moments that one part of the plate gives the other along it."""

    name: Text = Field(default="", description='Name, each once; default "section 1", "section 2", ...')
    line: Annotated[Polyline, AfterValidator(_closing)] = Field(
        description="The line [[x, y], [x, y], ...]; it begins and ends on the plate."
    )

    def _complaints(self) -> Iterator[Complaint]:
        met = meeting(_pieces(self.line), self.line[0] == self.line[-1])
        if met is not None:
            one, other = (f"from {point(self.line[at])} to {point(self.line[at + 1])}" for at in met)
            yield (
                ("line",),
                f"the line goes back, or crosses or touches itself: its pieces {one} and {other} meet. A section has "
                "one part of the plate on its left and one on its right; split it into several sections.",
            )


class Strip(Table):
    """A strip of the plate, such as a column strip: mean moments over its width at stations along its middle line."""

    name: Text = Field(default="", description='Name, each once; default "strip 1", "strip 2", ...')
    line: Polyline = Field(description="Its middle line [[x, y], [x, y], ...].")
    width: Positive = Field(description="Its width, half on either side of the line.")
    stations: Stations = Field(
        default=_STATIONS, description="How many stations, evenly from one end of the line to the other; default 21."
    )

    def _complaints(self) -> Iterator[Complaint]:
        for a, b, c in zip(self.line, self.line[1:], self.line[2:], strict=False):
            met = meeting(_pieces((a, b, c)), False)
            if met is not None:
                yield ("line",), f"the line goes back on itself at {point(b)}. Split it into two strips."

    @property
    def places(self) -> tuple[Floats, Floats]:
        """Where the stations are (n, 2), and the unit direction of the line there (n, 2), at a corner the mean.

        Examples
        --------
        >>> at, along = Strip(line=[[0, 2], [8, 2]], width=2, stations=3).places
        >>> at.tolist(), along[0].tolist()
        ([[0.0, 2.0], [4.0, 2.0], [8.0, 2.0]], [1.0, 0.0])
        """
        points = np.array(self.line)
        pieces = np.diff(points, axis=0)
        ends = np.cumsum([0.0, *(math.dist(a, b) for a, b in pairwise(self.line))])
        travelled = np.linspace(0.0, ends[-1], self.stations)
        at = np.column_stack([np.interp(travelled, ends, part) for part in points.T])
        tiny = 1e-9 * ends[-1]
        before, after = (
            np.clip(np.searchsorted(ends, travelled + sign * tiny) - 1, 0, len(pieces) - 1) for sign in (-1.0, 1.0)
        )
        unit = pieces / np.hypot(*pieces.T)[:, None]
        along = unit[before] + unit[after]
        return at, np.asarray(along / np.hypot(*along.T)[:, None])

    @property
    def across(self) -> list[tuple[tuple[float, float], tuple[float, float]]]:
        """The line across it at each station, so that the strip's own line crosses it from its left to its right."""
        at, along = self.places
        half = 0.5 * self.width * np.column_stack([along[:, 1], -along[:, 0]])
        return [(tuple(a), tuple(b)) for a, b in zip((at + half).tolist(), (at - half).tolist(), strict=True)]
