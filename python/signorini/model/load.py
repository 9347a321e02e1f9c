"""Loads, those that move along a line, and the points where results are asked for."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Field, model_validator

from signorini.model.base import (
    Complaint,
    NonNegative,
    Number,
    OnPlate,
    Points,
    Polyline,
    Positive,
    Scalar,
    Table,
    Text,
    vector,
)
from signorini.model.problems import as_list, describe
from signorini.model.where import FOOTPRINT, Acting, one_of

Kind = Literal["pressure", "force", "line_load", "moment", "couple_about", "self_weight", "curvature"]

_PLACES: dict[Kind, tuple[str, ...]] = {
    "pressure": ("area",),
    "force": ("at", "nodes"),
    "line_load": ("edge", "line", "circle"),
    "moment": ("at", "nodes"),
    "couple_about": ("at", "nodes"),
    "self_weight": (),
    "curvature": (),
}


_KINDS: list[Any] = [
    {"required": [kind]} | ({"oneOf": one_of(places)} if len(places) > 1 else {}) for kind, places in _PLACES.items()
]


def _true(value: object) -> object:
    if value is not True:
        raise ValueError(f"found {describe(value)}; write true, or leave the key out.")
    return value


class Axes(Table):
    """A couple about each axis of the plane, at least one of them."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1})

    x: Number | None = Field(default=None, description="Couple about x: the side of greater y goes down.")
    y: Number | None = Field(default=None, description="Couple about y: the side of greater x goes up.")

    def _complaints(self) -> Iterator[Complaint]:
        if not self.present(("x", "y")):
            yield (), "found neither x nor y; give the couple about at least one of them."


class Load(Acting):
    """A load: exactly one of pressure, force, line_load, moment, couple_about, self_weight, curvature, in a case."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": _KINDS,
            "not": {"required": ["patch", "radius"]},
        }
    )

    case: Text = Field(default="load", min_length=1, description='The load case it belongs to; default "load".')
    pressure: Scalar | None = Field(
        default=None, description="Force per area, positive down, everywhere or on area: a number or an expression."
    )
    force: Number | None = Field(default=None, description="Force at each point of at or nodes, positive down.")
    line_load: Scalar | None = Field(
        default=None,
        description="Force per length along edge, line or circle, positive down: a number or an expression.",
    )
    moment: Annotated[tuple[Number, Number], *vector(2, "[mx, my], couples about two axes")] | None = Field(
        default=None,
        description="Couples [mx, my] at each point of at or nodes; mx works on the rotation θx = ∂w/∂x, my on θy.",
    )
    couple_about: Axes | None = Field(
        default=None,
        description="Couples { x = ..., y = ... } about the axes at each point of at or nodes; right-handed, z down.",
    )
    self_weight: Annotated[Literal[True], BeforeValidator(_true)] | None = Field(
        default=None, description="true: the plate's own weight, from material.unit_weight and the thickness."
    )
    curvature: Annotated[tuple[Number, Number, Number], *vector(3, "three curvatures [kx, ky, kxy]")] | None = Field(
        default=None, description="Stress-free curvatures [kx, ky, kxy], as by a temperature gradient."
    )

    @model_validator(mode="before")
    @classmethod
    def _pressure_everywhere(cls, data: Any) -> Any:
        if isinstance(data, dict) and data.get("pressure") is not None and data.get("area") is None:
            return {**data, "area": "all"}
        return data

    @property
    def kind(self) -> Kind:
        """The key of the kind of load."""
        return next(kind for kind in _PLACES if getattr(self, kind) is not None)

    @property
    def couple(self) -> tuple[float, float] | None:
        """Couples [mx, my] at each point, of ``moment`` or ``couple_about``; None of other loads."""
        if self.couple_about is None:
            return self.moment
        # z points down: a turn about x takes y to z, one about y takes z to x.
        return 0.0 - (self.couple_about.y or 0.0), self.couple_about.x or 0.0

    def _complaints(self) -> Iterator[Complaint]:
        kinds = self.present(_PLACES)
        if len(kinds) != 1:
            yield (), f"found {' and '.join(kinds) or 'none'}; a load is exactly one of {', '.join(_PLACES)}."
            return
        allowed = _PLACES[self.kind]
        places = self.present(sorted(self.places))
        for key in places:
            if key not in allowed:
                goes = f"with {' or '.join(allowed)}" if allowed else "alone"
                yield (key,), f"{key} does not go with {self.kind}, which goes {goes}."
        here = [key for key in places if key in allowed]
        if allowed and len(here) != 1 and len(here) == len(places):
            needs = f"exactly one of {', '.join(allowed)}" if len(allowed) > 1 else allowed[0]
            yield (), f"found {' and '.join(here) or 'no place'}; {self.kind} needs {needs} to say where it acts."
        if (footprint := self.present(FOOTPRINT)) and "at" not in allowed:
            yield (footprint[0],), f"{footprint[0]} does not go with {self.kind}; it is the footprint of points."
        else:
            yield from self._footprint_complaints()


class Probe(OnPlate):
    """Points where deflection, rotations, moments and shears are written out."""

    at: Points = Field(description="A point [x, y] or a list of points.")


_END = 1e-9
"""Smallest length of the last step, relative to a step."""


def _axles(value: object) -> object:
    value = as_list(value)
    if isinstance(value, list | tuple) and value and not any(isinstance(as_list(item), list | tuple) for item in value):
        return [value]
    return value


Axle = Annotated[tuple[NonNegative, Number], *vector(2, "an axle [distance behind the first, force]")]
Print = Annotated[tuple[Positive, Positive], *vector(2, "a patch [length along the line, width across it]")]
Wheel = tuple[tuple[float, float], tuple[float, float], float]
"""Where a wheel stands, the unit direction it rolls in, and its force."""


class Moving(OnPlate):
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
    patch: Print | None = Field(
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
        """Distance of the first axle along the line, by the name of the load case."""
        travelled = [min(i * self.step, self.length) for i in range(self.count)]
        return {f"{self.case}@{round(s, 12):.10g}": s for s in travelled}

    def wheels(self, travelled: float) -> list[Wheel]:
        """Every wheel, with the first axle at a distance along the line, which continues straight before its start."""
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
