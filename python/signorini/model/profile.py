"""Lines along which deflection, moments, shears and pressure are written out."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from pydantic import Field

from signorini.model.area import Circle
from signorini.model.base import Complaint, Polyline, Stations, Table, Text
from signorini.model.curve import curve
from signorini.shapes import Floats, Ring

_STATIONS = 101
"""A hundred steps meet halves, quarters, fifths and tenths of a line, and draw its curves smoothly."""


class Profile(Table):
    """A line or a circle with stations, evenly from its beginning to its end."""

    name: Text = Field(default="", description='Name, each once; default "profile 1", "profile 2", ...')
    line: Polyline | None = Field(default=None, description="The line [[x, y], [x, y], ...].")
    circle: Circle | None = Field(default=None, description="{ center = [x, y], radius = r }, from x towards y.")
    stations: Stations = Field(
        default=_STATIONS, description="How many stations, evenly from one end to the other; default 101."
    )

    def _complaints(self) -> Iterator[Complaint]:
        if len(self.given(("line", "circle"))) != 1:
            yield (), "it must have a line or a circle, one of them."

    @property
    def places(self) -> tuple[Floats, Floats]:
        """How far along (k,) the stations are, and where (k, 2).

        Examples
        --------
        >>> along, at = Profile(line=[[0, 0], [3, 4]], stations=3).places
        >>> along.tolist(), at.tolist()
        ([0.0, 2.5, 5.0], [[0.0, 0.0], [1.5, 2.0], [3.0, 4.0]])
        """
        result = curve(self)
        assert result is not None  # it has a line or a circle
        along = np.linspace(0.0, result.length, self.stations)
        if isinstance(result, Ring):
            turned = along / result.radius
            return along, np.array(result.center) + result.radius * np.column_stack([np.cos(turned), np.sin(turned)])
        points = np.array(result.points)
        ends = np.append(0.0, np.hypot(*np.diff(points, axis=0).T).cumsum())
        return along, np.column_stack([np.interp(along, ends, part) for part in points.T])
