"""Loads, moving loads, and probes."""

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
    """Couples about the axes x and y; at least one of the two is required."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1})

    x: Number | None = Field(default=None, description="Couple about x; positive: the side of greater y goes down.")
    y: Number | None = Field(default=None, description="Couple about y; positive: the side of greater x goes up.")

    def _complaints(self) -> Iterator[Complaint]:
        if not self.present(("x", "y")):
            yield (), "found neither x nor y; give at least one couple."


class Load(Acting):
    """A load that belongs to a load case.

    Exactly one key gives its kind: pressure, force, line_load, moment, couple_about, self_weight or curvature.
    """

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": _KINDS,
            "not": {"required": ["patch", "radius"]},
        }
    )

    case: Text = Field(default="load", min_length=1, description='Load case to which the load belongs; default "load".')
    pressure: Scalar | None = Field(
        default=None, description="Force per area, positive down, on area (default 'all'): a number or an expression."
    )
    force: Number | None = Field(default=None, description="Force at each point or node, positive down.")
    line_load: Scalar | None = Field(
        default=None,
        description="Force per length along edge, line or circle, positive down: a number or an expression.",
    )
    moment: Annotated[tuple[Number, Number], *vector(2, "[mx, my], couples about two axes")] | None = Field(
        default=None,
        description="Couples [mx, my] at each point or node; mx does work on the rotation θx = ∂w/∂x, my on θy.",
    )
    couple_about: Axes | None = Field(
        default=None,
        description="Couples { x = …, y = … } about the axes x and y at each point or node; right-handed, z down.",
    )
    self_weight: Annotated[Literal[True], BeforeValidator(_true)] | None = Field(
        default=None, description="true: load by the self-weight, unit_weight of the material times the thickness."
    )
    curvature: Annotated[tuple[Number, Number, Number], *vector(3, "three curvatures [kx, ky, kxy]")] | None = Field(
        default=None, description="Stress-free curvatures [kx, ky, kxy], such as those of a plate heated on one face."
    )

    @model_validator(mode="before")
    @classmethod
    def _pressure_everywhere(cls, data: Any) -> Any:
        if isinstance(data, dict) and data.get("pressure") is not None and data.get("area") is None:
            return {**data, "area": "all"}
        return data

    @property
    def kind(self) -> Kind:
        """The key that gives the kind of load, such as "pressure"."""
        return next(kind for kind in _PLACES if getattr(self, kind) is not None)

    @property
    def couple(self) -> tuple[float, float] | None:
        """Couples [mx, my] at each point, from the key ``moment`` or ``couple_about``; None for other loads."""
        if self.couple_about is None:
            return self.moment
        # Axes are right-handed with z down: a couple about x does work on ∂w/∂y, a couple about y on -∂w/∂x.
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
                takes = " or ".join(allowed) if allowed else "no place: it acts on the whole plate"
                yield (key,), f"{key} is not allowed with {self.kind}, which takes {takes}."
        here = [key for key in places if key in allowed]
        if allowed and len(here) != 1 and len(here) == len(places):
            needs = f"exactly one of {', '.join(allowed)}" if len(allowed) > 1 else allowed[0]
            yield (), f"found {' and '.join(here) or 'no place'}; {self.kind} needs {needs} as its place."
        if (footprint := self.present(FOOTPRINT)) and "at" not in allowed:
            yield (footprint[0],), f"{footprint[0]} is the footprint of points; {self.kind} has none."
        else:
            yield from self._footprint_complaints()


class Probe(OnPlate):
    """Points at which deflection, rotations, moments and shears are reported."""

    at: Points = Field(description="A point [x, y] or a list of points.")


_SHORTEST_STEP = 1e-9
"""Smallest distance between the last two positions of a moving load, relative to ``step``.

A smaller distance is a rounding error of the line's length; the position at the line's end is then left out.
"""


def _axles(value: object) -> object:
    value = as_list(value)
    if isinstance(value, list | tuple) and value and not any(isinstance(as_list(item), list | tuple) for item in value):
        return [value]
    return value


Axle = Annotated[tuple[NonNegative, Number], *vector(2, "an axle [distance behind the first, force]")]
WheelPatch = Annotated[tuple[Positive, Positive], *vector(2, "a patch [length along the line, width across it]")]
Wheel = tuple[tuple[float, float], tuple[float, float], float]
"""A wheel: contact point (x, y), unit direction of travel, and force."""


class Moving(OnPlate):
    """A load that moves along a line: axles with one or two wheels. A wheel is a force at a point or on a patch."""

    case: Text = Field(min_length=1, description="Name of the load in combinations; each position is a load case too.")
    line: Polyline = Field(description="The line [[x, y], [x, y], ...] along which the first axle moves.")
    step: Positive = Field(description="Distance between positions of the load; the last one is at the line's end.")
    axles: Annotated[tuple[Axle, ...], Field(min_length=1), BeforeValidator(_axles)] = Field(
        description="[distance behind the first axle, force] of each axle, such as [[0, 60], [1.2, 60]]."
    )
    gauge: NonNegative = Field(
        default=0.0,
        description="Distance between the two wheels of an axle, each with half its force; 0: axles have one wheel.",
    )
    patch: WheelPatch | None = Field(
        default=None, description="Footprint of each wheel, [length along the line, width across it]; default a point."
    )

    def _complaints(self) -> Iterator[Complaint]:
        if self.patch is not None and 0 < self.gauge < self.patch[1]:
            yield (
                ("patch",),
                f"the patches of an axle's wheels overlap: they are {self.patch[1]:g} wide and {self.gauge:g} apart.",
            )

    @property
    def length(self) -> float:
        """Length of the line along which the load moves."""
        return sum(math.dist(a, b) for a, b in pairwise(self.line))

    @property
    def count(self) -> int:
        """Number of positions of the load."""
        return math.ceil(self.length / self.step - _SHORTEST_STEP) + 1

    @property
    def positions(self) -> dict[str, float]:
        """Map from the load case of each position to the distance s of the first axle from the start of the line."""
        travelled = [min(i * self.step, self.length) for i in range(self.count)]
        return {f"{self.case}@{round(s, 12):.10g}": s for s in travelled}

    def wheels(self, travelled: float) -> list[Wheel]:
        """All wheels with the first axle at s = ``travelled``; the first segment extends beyond the line's start."""
        wheels: list[Wheel] = []
        for behind, force in self.axles:
            (x, y), (tx, ty) = self._point_at(travelled - behind)
            sides = (-0.5, 0.5) if self.gauge else (0.0,)
            for side in sides:
                offset = side * self.gauge
                wheels.append(((x - offset * ty, y + offset * tx), (tx, ty), force / len(sides)))
        return wheels

    def _point_at(self, travelled: float) -> tuple[tuple[float, float], tuple[float, float]]:
        """Point of the line at distance s = ``travelled`` from its start, and the unit tangent there."""
        left = travelled
        for a, b in pairwise(self.line):
            length = math.dist(a, b)
            if left <= length or b == self.line[-1]:
                break
            left -= length
        tx, ty = (b[0] - a[0]) / length, (b[1] - a[1]) / length
        return (a[0] + left * tx, a[1] + left * ty), (tx, ty)
