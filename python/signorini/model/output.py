"""Tables of the input that concern results: output options, sections, strips and profiles."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, WithJsonSchema

from signorini.errors import point
from signorini.model.base import (
    Complaint,
    Named,
    OnPlate,
    Point,
    Polyline,
    Positive,
    Stations,
    Table,
    Text,
    first_duplicate,
)
from signorini.model.places import Circle
from signorini.model.problems import as_list, describe
from signorini.model.where import curve_of
from signorini.shapes import Region, Ring
from signorini.shapes.arrays import Floats
from signorini.shapes.distances import depth
from signorini.shapes.regions import meeting

MAX_FULL_RESULTS = 12
"""Largest number of combinations for which ``combinations = "auto"`` means "each", with full results for all.

For more combinations "auto" means "table".
"""

_FIELDS_OPTIONS = ("governing", "all", "none")

_Forces = Literal["deflection", "mx", "my", "mxy", "qx", "qy", "m1", "m2"]
_Design = Literal["mx_bottom", "my_bottom", "mx_top", "my_top"]
_Bars = Literal["as_x_bottom", "as_y_bottom", "as_x_top", "as_y_top"]
_Stresses = Literal[
    "sx_top", "sy_top", "txy_top", "sx_bottom", "sy_bottom", "txy_bottom", "von_mises", "txz", "tyz"
]  # fmt: skip
EnvelopeField = Literal[_Forces, _Design, _Bars, _Stresses]
ENVELOPED: tuple[EnvelopeField, ...] = ("deflection", "mx", "my", "mxy", "qx", "qy")


def _fields(value: object) -> object:
    if isinstance(value, str):
        if value not in _FIELDS_OPTIONS:
            raise ValueError(
                f"found {describe(value)}; it must be {', '.join(_FIELDS_OPTIONS)}, or a list of names of combinations."
            )
        return value
    value = as_list(value)
    if not isinstance(value, list | tuple) or not all(isinstance(name, str) for name in value):
        raise ValueError(
            f"found {describe(value)}; it must be {', '.join(_FIELDS_OPTIONS)}, or a list of names of combinations."
        )
    return tuple(value)


class Output(Table):
    """Options of the output: results that are computed and written for each combination."""

    combinations: Literal["auto", "each", "table"] = Field(
        default="auto",
        description=f"each: all results of every combination; table: envelopes, a row of combinations.parquet for each "
        f"combination, and all results only of the combinations in the key fields; auto: each for up to "
        f"{MAX_FULL_RESULTS} combinations, otherwise table.",
    )
    fields: Annotated[
        Literal["governing", "all", "none"] | tuple[Text, ...],
        BeforeValidator(_fields),
        WithJsonSchema({"anyOf": [{"enum": list(_FIELDS_OPTIONS)}, {"type": "array", "items": {"type": "string"}}]}),
    ] = Field(
        default="governing",
        description='For combinations = "table": governing, all, none, or names of the combinations that have all '
        "results, a .vtu file and a picture.",
    )
    envelope: tuple[EnvelopeField, ...] = Field(
        default=ENVELOPED,
        description='For combinations = "table": fields whose largest and smallest values at each node are computed; '
        "[] for none; with [reinforcement] the default includes design moments and required areas.",
    )

    def _complaints(self) -> Iterator[Complaint]:
        if self.combinations == "each":
            for key in ("fields", "envelope"):
                if getattr(self, key) != type(self).model_fields[key].default:
                    yield (key,), f'{key} is for combinations = "table"; with "each" every combination has all results.'
        if (repeated := first_duplicate(self.envelope)) is not None:
            yield ("envelope",), f'"{repeated}" is listed twice.'


_IN_COLUMN = 1e-9
"""Rounding tolerance, relative to a column's size: stations nearer to its outline are not inside the column."""
_HALVINGS = 50
"""Number of bisections that locate the face of a column on the center line of a strip, up to rounding errors."""
_STRIP_STATIONS = 21
"""Default number of stations of a strip.

20 steps place stations at the quarter points of 1 or 5 equal spans, and at the middles of 2 equal spans.
"""
_SAME_END = 1e-5
"""Largest distance between the two ends of a closed section line, relative to the line's extent.

Coordinates in an input have more digits than this tolerance.
"""


def _closed(line: tuple[Point, ...]) -> tuple[Point, ...]:
    """Return the line with its last point set to the first point, if the two are equal within `_SAME_END`."""
    extent = float(np.ptp(np.array(line), axis=0).max())
    closes = len(line) > 2 and math.dist(line[0], line[-1]) <= _SAME_END * extent
    return (*line[:-1], line[0]) if closes else line


def _equal_steps(line: tuple[Point, ...], stations: int) -> tuple[Floats, Floats, Floats]:
    """Return arc lengths of the line's corners, and arc lengths (k,) and positions (k, 2) of k equidistant points."""
    corners = np.cumsum([0.0, *(math.dist(a, b) for a, b in pairwise(line))])
    s = np.linspace(0.0, corners[-1], stations)
    return corners, s, np.column_stack([np.interp(s, corners, axis) for axis in np.array(line).T])


def _segments(line: tuple[Point, ...]) -> Floats:
    return np.array(list(pairwise(line)))


class Section(OnPlate, Named):
    """A line that cuts the plate; its results are the force and the moments between the two parts of the plate."""

    line: Annotated[Polyline, AfterValidator(_closed)] = Field(
        description="The line of the section, [[x, y], [x, y], ...]; it begins and ends on the plate."
    )

    def _complaints(self) -> Iterator[Complaint]:
        met = meeting(_segments(self.line), self.line[0] == self.line[-1])
        if met is not None:
            first, second = (f"from {point(self.line[i])} to {point(self.line[i + 1])}" for i in met)
            yield (
                ("line",),
                f"the line turns back, or crosses or touches itself: see its segments {first} and {second}. A section "
                "must separate a left from a right part of the plate; split it into several sections.",
            )


class Strip(OnPlate, Named):
    """A strip of the plate, such as a column strip: moments averaged over its width, at stations of its center line."""

    line: Polyline = Field(description="The center line of the strip, [[x, y], [x, y], ...].")
    width: Positive = Field(description="Width of the strip, half on either side of its center line.")
    stations: Stations = Field(
        default=_STRIP_STATIONS,
        description="Number of equally spaced stations of the strip, ends included; default 21.",
    )

    def _complaints(self) -> Iterator[Complaint]:
        for a, b, c in zip(self.line, self.line[1:], self.line[2:], strict=False):
            if meeting(_segments((a, b, c)), False) is not None:
                yield ("line",), f"the line turns back at {point(b)}. Split the line into two strips."

    @property
    def places(self) -> tuple[Floats, Floats]:
        """Points (n, 2) of the stations and unit tangents (n, 2); at a corner the tangent bisects its two segments."""
        return self._at(_equal_steps(self.line, self.stations)[1])

    def _at(self, s: Floats) -> tuple[Floats, Floats]:
        """Points (n, 2) and unit tangents (n, 2) at arc lengths (n,) of the center line."""
        segments, (corners, *_) = np.diff(np.array(self.line), axis=0), _equal_steps(self.line, self.stations)
        points = np.column_stack([np.interp(s, corners, axis) for axis in np.array(self.line).T])
        rounding = 1e-9 * corners[-1]
        before, after = (
            np.clip(np.searchsorted(corners, s + sign * rounding) - 1, 0, len(segments) - 1) for sign in (-1.0, 1.0)
        )
        unit = segments / np.hypot(*segments.T)[:, None]
        tangents = unit[before] + unit[after]
        return points, np.asarray(tangents / np.hypot(*tangents.T)[:, None])

    @property
    def across(self) -> list[tuple[tuple[float, float], tuple[float, float]]]:
        """Ends of the cross line at each station; seen along it, the center line runs from left to right."""
        return self._across(*self.places)

    def faces(self, column: Region) -> Iterator[tuple[int, tuple[Point, Point]]]:
        """Yield the index of each station in a convex column, with the ends of a cross line at the column's outline.

        A station has two such cross lines: where the center line enters the column and where it leaves the column.
        Cross lines beyond the ends of the strip are left out.
        """
        s, size = _equal_steps(self.line, self.stations)[1], math.dist(*np.array(column.bounds).reshape(2, 2))
        for station in np.flatnonzero(depth(column, self.places[0]) > _IN_COLUMN * size).tolist():
            for sign in (-1.0, 1.0):
                inside, outside = s[station], s[station] + sign * size
                for _ in range(_HALVINGS):
                    middle = 0.5 * (inside + outside)
                    within = depth(column, self._at(np.array([middle]))[0])[0] > 0.0
                    inside, outside = (middle, outside) if within else (inside, middle)
                if 0.0 < outside < s[-1]:
                    yield station, self._across(*self._at(np.array([outside])))[0]

    def _across(self, points: Floats, tangents: Floats) -> list[tuple[Point, Point]]:
        half = 0.5 * self.width * np.column_stack([tangents[:, 1], -tangents[:, 0]])
        return [(tuple(a), tuple(b)) for a, b in zip((points + half).tolist(), (points - half).tolist(), strict=True)]


_PROFILE_STATIONS = 101
"""Default number of stations of a profile.

100 steps place stations at halves, quarters, fifths and tenths, and plot smoothly.
"""


class Profile(OnPlate, Named):
    """A line or a circle with equally spaced stations, at which fields are reported."""

    line: Polyline | None = Field(default=None, description="The line of the profile, [[x, y], [x, y], ...].")
    circle: Circle | None = Field(
        default=None,
        description="The circle of the profile, { center = [x, y], radius = r }; stations run from angle 0 towards y.",
    )
    stations: Stations = Field(
        default=_PROFILE_STATIONS,
        description="Number of equally spaced stations of the profile, ends included; default 101.",
    )

    def _complaints(self) -> Iterator[Complaint]:
        if len(self.present(("line", "circle"))) != 1:
            yield (), "give exactly one of line and circle."

    @property
    def places(self) -> tuple[Floats, Floats]:
        """Arc lengths s (k,) of the stations, and their positions (k, 2)."""
        curve = curve_of(self.line, self.circle)
        assert curve is not None  # Validation requires exactly one of line and circle.
        if isinstance(curve, Ring):
            s = np.linspace(0.0, curve.length, self.stations)
            angle = s / curve.radius
            return s, np.array(curve.center) + curve.radius * np.column_stack([np.cos(angle), np.sin(angle)])
        return _equal_steps(curve.points, self.stations)[1:]
