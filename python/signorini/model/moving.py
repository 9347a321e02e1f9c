"""Loads that move along a line: every position of theirs is a load case."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated

from pydantic import BeforeValidator, Field, WithJsonSchema

from signorini.model.base import Complaint, NonNegative, Number, Polyline, Positive, Table, Text, listed, numbers_schema
from signorini.model.words import as_list

_END = 1e-9
"""A last step shorter than this part of a step is none."""


def _axles(value: object) -> object:
    value = as_list(value)
    if isinstance(value, list | tuple) and value and not any(isinstance(as_list(item), list | tuple) for item in value):
        return [value]
    return value


Axle = Annotated[
    tuple[NonNegative, Number],
    BeforeValidator(listed(2, "an axle [distance behind the first, force]")),
    WithJsonSchema(numbers_schema(2)),
]
Patch = Annotated[
    tuple[Positive, Positive],
    BeforeValidator(listed(2, "a patch [length along the line, width across it]")),
    WithJsonSchema(numbers_schema(2)),
]
Wheel = tuple[tuple[float, float], tuple[float, float], float]
"""Where a wheel stands, the unit direction it rolls in, and its force."""


class Moving(Table):
    """A load that moves along a line: axles with one or two wheels, each a force at a point or on a patch."""

    case: Text = Field(min_length=1, description="Name of the load case that the positions belong to.")
    line: Polyline = Field(description="The line [[x, y], [x, y], ...] along which the first axle moves.")
    step: Positive = Field(description="Distance from one position to the next; the end of the line is the last one.")
    axles: Annotated[tuple[Axle, ...], Field(min_length=1), BeforeValidator(_axles)] = Field(
        description="[distance behind the first axle, force] of each axle, such as [[0, 60], [1.2, 60]]."
    )
    gauge: NonNegative = Field(
        default=0.0, description="Distance between the two wheels of an axle, half its force on each; 0: one wheel."
    )
    patch: Patch | None = Field(
        default=None, description="[length along the line, width across it] of each wheel's print; left out: a point."
    )

    def _complaints(self) -> Iterator[Complaint]:
        if self.patch is not None and 0 < self.gauge < self.patch[1]:
            yield (
                ("patch",),
                f"the prints of an axle's wheels overlap: they are {self.patch[1]:g} wide and {self.gauge:g} apart.",
            )

    @property
    def length(self) -> float:
        """Length of the line."""
        return sum(math.dist(a, b) for a, b in pairwise(self.line))

    @property
    def count(self) -> int:
        """Number of positions."""
        return math.ceil(self.length / self.step - _END) + 1

    @property
    def positions(self) -> dict[str, float]:
        """Distance of the first axle along the line, by the name of the load case.

        Examples
        --------
        >>> Moving(case="truck", line=[[0, 0], [1, 0]], step=0.4, axles=[[0, 1]]).positions
        {'truck@0': 0.0, 'truck@0.4': 0.4, 'truck@0.8': 0.8, 'truck@1': 1.0}
        """
        travelled = [min(i * self.step, self.length) for i in range(self.count)]
        return {f"{self.case}@{round(s, 12):.10g}": s for s in travelled}

    def wheels(self, travelled: float) -> list[Wheel]:
        """Every wheel, with the first axle so far along the line; the line goes on straight before its beginning."""
        wheels: list[Wheel] = []
        for behind, force in self.axles:
            (x, y), (tx, ty) = self._at(travelled - behind)
            sides = (-0.5, 0.5) if self.gauge else (0.0,)
            for side in sides:
                offset = side * self.gauge
                wheels.append(((x - offset * ty, y + offset * tx), (tx, ty), force / len(sides)))
        return wheels

    def _at(self, travelled: float) -> tuple[tuple[float, float], tuple[float, float]]:
        """Point of the line and its direction there."""
        left = travelled
        for a, b in pairwise(self.line):
            length = math.dist(a, b)
            if left <= length or b == self.line[-1]:
                break
            left -= length
        tx, ty = (b[0] - a[0]) / length, (b[1] - a[1]) / length
        return (a[0] + left * tx, a[1] + left * ty), (tx, ty)
