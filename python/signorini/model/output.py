"""Output options: combinations, sections, strips and profiles."""

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
    twice,
)
from signorini.model.places import Circle
from signorini.model.problems import as_list, describe
from signorini.model.where import curve_of
from signorini.shapes import Ring
from signorini.shapes.arrays import Floats
from signorini.shapes.regions import meeting

FEW = 12
"""Largest number of combinations with a result of their own."""

_WORDS = ("governing", "all", "none")

_Forces = Literal["deflection", "mx", "my", "mxy", "qx", "qy", "m1", "m2"]
_Design = Literal["mx_bottom", "my_bottom", "mx_top", "my_top"]
_Stresses = Literal[
    "sx_top", "sy_top", "txy_top", "sx_bottom", "sy_bottom", "txy_bottom", "von_mises", "txz", "tyz"
]  # fmt: skip
EnvelopeField = Literal[_Forces, _Design, _Stresses]
ENVELOPED: tuple[EnvelopeField, ...] = ("deflection", "mx", "my", "mxy", "qx", "qy")


def _chosen(value: object) -> object:
    if isinstance(value, str):
        if value not in _WORDS:
            raise ValueError(
                f"found {describe(value)}; it must be {', '.join(_WORDS)}, or a list of names of combinations."
            )
        return value
    value = as_list(value)
    if not isinstance(value, list | tuple) or not all(isinstance(name, str) for name in value):
        raise ValueError(f"found {describe(value)}; it must be {', '.join(_WORDS)}, or a list of names in quotes.")
    return tuple(value)


class Output(Table):
    """How much is computed and written of each combination."""

    combinations: Literal["auto", "each", "table"] = Field(
        default="auto",
        description=f"each: all results of every combination; table: a row of combinations.parquet for each, an "
        f"envelope over all, and all results of those in fields; auto: each up to {FEW} combinations, then table.",
    )
    fields: Annotated[
        Literal["governing", "all", "none"] | tuple[Text, ...],
        BeforeValidator(_chosen),
        WithJsonSchema({"anyOf": [{"enum": list(_WORDS)}, {"type": "array", "items": {"type": "string"}}]}),
    ] = Field(
        default="governing",
        description="For table: combinations with all results, .vtu file and picture: governing, all, none, or names.",
    )
    envelope: tuple[EnvelopeField, ...] = Field(
        default=ENVELOPED,
        description="For table: fields whose largest and smallest values at every node are sought; [] for none.",
    )

    def _complaints(self) -> Iterator[Complaint]:
        if self.combinations == "each":
            for key in ("fields", "envelope"):
                if getattr(self, key) != type(self).model_fields[key].default:
                    yield (key,), f'{key} goes with combinations = "table"; with "each" every combination has all.'
        if (repeated := twice(self.envelope)) is not None:
            yield ("envelope",), f'"{repeated}" is listed twice.'


_OF_STRIP = 21
"""Twenty steps meet supports, middles and quarters of one to five equal spans."""
_CLOSED = 1e-5
"""Relative tolerance for coincident ends of a line, relative to its extent: coordinates have more digits."""


def _closing(line: tuple[Point, ...]) -> tuple[Point, ...]:
    """Close a line whose last point is its first up to rounding."""
    extent = float(np.ptp(np.array(line), axis=0).max())
    near = len(line) > 2 and math.dist(line[0], line[-1]) <= _CLOSED * extent
    return (*line[:-1], line[0]) if near else line


def _spaced(line: tuple[Point, ...], stations: int) -> tuple[Floats, Floats, Floats]:
    """How far along a line its corners are, how far evenly spaced stations, and where these are (k, 2)."""
    ends = np.cumsum([0.0, *(math.dist(a, b) for a, b in pairwise(line))])
    travelled = np.linspace(0.0, ends[-1], stations)
    return ends, travelled, np.column_stack([np.interp(travelled, ends, part) for part in np.array(line).T])


def _pieces(line: tuple[Point, ...]) -> Floats:
    return np.array(list(pairwise(line)))


class Section(OnPlate, Named):
    """A line through the plate: the force and the moments that one part of the plate gives the other along it."""

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


class Strip(OnPlate, Named):
    """A strip of the plate, such as a column strip: mean moments over its width at stations along its middle line."""

    line: Polyline = Field(description="Its middle line [[x, y], [x, y], ...].")
    width: Positive = Field(description="Its width, half on either side of the line.")
    stations: Stations = Field(
        default=_OF_STRIP, description="How many stations, evenly from one end of the line to the other; default 21."
    )

    def _complaints(self) -> Iterator[Complaint]:
        for a, b, c in zip(self.line, self.line[1:], self.line[2:], strict=False):
            met = meeting(_pieces((a, b, c)), False)
            if met is not None:
                yield ("line",), f"the line goes back on itself at {point(b)}. Split it into two strips."

    @property
    def places(self) -> tuple[Floats, Floats]:
        """Where the stations are (n, 2), and the unit direction of the line there (n, 2), at a corner the mean."""
        pieces = np.diff(np.array(self.line), axis=0)
        ends, travelled, at = _spaced(self.line, self.stations)
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


_OF_PROFILE = 101
"""A hundred steps meet halves, quarters, fifths and tenths of a line, and draw its curves smoothly."""


class Profile(OnPlate, Named):
    """A line or a circle with stations, evenly from its beginning to its end."""

    line: Polyline | None = Field(default=None, description="The line [[x, y], [x, y], ...].")
    circle: Circle | None = Field(default=None, description="{ center = [x, y], radius = r }, from x towards y.")
    stations: Stations = Field(
        default=_OF_PROFILE, description="How many stations, evenly from one end to the other; default 101."
    )

    def _complaints(self) -> Iterator[Complaint]:
        if len(self.present(("line", "circle"))) != 1:
            yield (), "it must have a line or a circle, one of them."

    @property
    def places(self) -> tuple[Floats, Floats]:
        """How far along (k,) the stations are, and where (k, 2)."""
        result = curve_of(self.line, self.circle)
        assert result is not None  # it has a line or a circle
        if isinstance(result, Ring):
            along = np.linspace(0.0, result.length, self.stations)
            turned = along / result.radius
            return along, np.array(result.center) + result.radius * np.column_stack([np.cos(turned), np.sin(turned)])
        return _spaced(result.points, self.stations)[1:]
