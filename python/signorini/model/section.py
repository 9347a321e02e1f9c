"""Sections through the plate, and strips of it, whose forces and mean moments are written out."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from pydantic import Field

from signorini.model.base import Polyline, Positive, Stations, Table, Text
from signorini.shapes import Floats

_STATIONS = 21
"""Twenty steps meet supports, middles and quarters of one to five equal spans."""


class Section(Table):
    """A line through the plate: the force and the moments that one part of the plate gives the other along it."""

    name: Text = Field(default="", description='Name, each once; default "section 1", "section 2", ...')
    line: Polyline = Field(description="The line [[x, y], [x, y], ...]; it begins and ends on the plate.")


class Strip(Table):
    """A strip of the plate, such as a column strip: mean moments over its width at stations along its middle line."""

    name: Text = Field(default="", description='Name, each once; default "strip 1", "strip 2", ...')
    line: Polyline = Field(description="Its middle line [[x, y], [x, y], ...].")
    width: Positive = Field(description="Its width, half on either side of the line.")
    stations: Stations = Field(
        default=_STATIONS, description="How many stations, evenly from one end of the line to the other; default 21."
    )

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
