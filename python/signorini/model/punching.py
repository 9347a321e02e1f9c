"""Columns that are checked for punching: places, outlines, code, depth and reinforcement."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal, NamedTuple, Protocol

from pydantic import BeforeValidator, Field, WithJsonSchema

from signorini.base.units import METRES, NEWTONS
from signorini.errors import unknown
from signorini.model import base
from signorini.model.load import Load
from signorini.model.problems import as_list
from signorini.model.support import Support
from signorini.model.where import Acting, Located
from signorini.shapes import Hollow
from signorini.shapes import Whole as Region

EN_1992, ACI_318 = "EN 1992-1-1:2004", "ACI 318-19"
_STRENGTHS = (5.0, 120.0)
"""Smallest and largest fck in MPa; another one is in the wrong unit."""


def _twice(value: object) -> object:
    value = as_list(value)
    return value if isinstance(value, list | tuple) else [value, value]


Pair = Annotated[
    tuple[base.Positive, base.Positive],
    BeforeValidator(base.listed(2, "one number, or two for x and y")),
    BeforeValidator(_twice),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}, "minItems": 2}]}),
]


class Labels(Protocol):
    """Labels of the units of a model."""

    @property
    def length(self) -> str:
        """Unit of length."""

    @property
    def force(self) -> str:
        """Unit of force."""


class Whole(Protocol):
    """The members of `Model` that this module uses."""

    @property
    def units(self) -> Labels:
        """Units."""

    @property
    def support(self) -> tuple[Support, ...]:
        """Supports, followed by contacts."""

    @property
    def load(self) -> tuple[Load, ...]:
        """Loads."""

    @property
    def punching(self) -> tuple[Punching, ...]:
        """Tables of columns."""


class ColumnAt(NamedTuple):
    """A column of a model: index of its table, number of its point from 1, place, outline, index of its support."""

    table: int
    number: int
    at: tuple[float, float]
    outline: Region
    support: int | None

    def subject(self, model: Whole) -> str:
        """Name of the column, such as "punching:columns[3]"."""
        table = model.punching[self.table]
        return f"punching:{table.support or table.load}[{self.number}]"


class Punching(base.OnPlate):
    """A check of columns for punching: of a slab on a support, or of a raft under the forces of a load case."""

    support: base.Text | None = Field(
        default=None, description="Name of the support whose points are the columns: at points, or one area."
    )
    load: base.Text | None = Field(
        default=None,
        description="In place of support: a load case; its force loads stand where columns stand on the plate.",
    )
    number: base.Counts | None = Field(
        default=None, description="Numbers of the points that are checked, from 1, in the order of at; default all."
    )
    code: Literal["EN 1992-1-1:2004", "ACI 318-19"] = Field(description="Design code.")
    column: Annotated[tuple[base.Positive, base.Positive], *base.vector(2, "two sides [b, h]")] | None = Field(
        default=None, description="Sides [b, h] of rectangular columns; default the footprint of the support or load."
    )
    diameter: base.Positive | None = Field(default=None, description="Diameter of circular columns.")
    angle: base.Number = Field(default=0.0, description="Rotation of column: degrees from x to its first side.")
    d: Pair = Field(description="Effective depths [dx, dy] of the reinforcement, or one for both.")
    rho: Pair | None = Field(
        default=None, description="Ratios [ρx, ρy] of the tension reinforcement, or one for both; required by EN 1992."
    )
    fck: base.Positive = Field(description="Strength of the concrete, fck or f'c, as force per area.")
    fyk: base.Positive = Field(description="Strength of the shear reinforcement, fyk or fyt, as force per area.")
    beta: Literal["computed"] | base.Positive = Field(
        default="computed", description="Factor β of the unbalanced moment: computed, or a number."
    )

    def _complaints(self) -> Iterator[base.Complaint]:
        for keys, needed in ((("support", "load"), 1), (("column", "diameter"), 0)):
            if not needed <= len(found := self.present(keys)) <= 1:
                yield (), f"found {' and '.join(found) or 'none'} of {' and '.join(keys)}; give one."
        if self.code == EN_1992 and self.rho is None:
            yield ("rho",), f"'rho' is missing; {EN_1992} needs the ratios of reinforcement [ρx, ρy]."

    def places(self, model: Whole) -> list[tuple[Located, tuple[float, float], int | None]]:
        """Tables and points (p,) that columns may stand at, and the index of the support."""
        if self.load is not None:
            own = (load for load in model.load if load.case == self.load and load.plate == self.plate)
            points = {point: load for load in own if load.force is not None for point in load.at or ()}
            return [(load, point, None) for point, load in points.items()]
        index = next(index for index, support in enumerate(model.support) if support.name == self.support)
        support = model.support[index]
        if (region := support.where.region) is not None:
            x0, y0, x1, y1 = region.bounds
            return [(support, (0.5 * (x0 + x1), 0.5 * (y0 + y1)), index)]
        return [(support, point, index) for point in support.at or ()]

    def columns(self, model: Whole, table: int) -> Iterator[ColumnAt]:
        """Yield the columns."""
        for number, (located, at, support) in enumerate(self.places(model), start=1):
            outline = self._outline(located, at, number)
            if outline is not None and (self.number is None or number in self.number):
                yield ColumnAt(table, number, at, outline, support)

    def _outline(self, located: Located, at: tuple[float, float], number: int) -> Region | None:
        if self.column is not None or self.diameter is not None:
            radius = None if self.diameter is None else 0.5 * self.diameter
            located = Acting.model_construct(at=(at,), patch=self.column, radius=radius, angle=self.angle)
            return located.where.footprints[0]
        where = located.where
        region = where.footprints[where.points.index(at)] if where.footprints else where.region
        return region.around if isinstance(region, Hollow) else region

    def complaints_of(self, model: Whole) -> Iterator[base.Complaint]:
        """Yield the problems of the table with the rest of the model; places are relative to this table."""
        names = [support.name for support in model.support]
        if self.support is not None and self.support not in names:
            yield ("support",), unknown("support", self.support, names)
            return
        places = self.places(model)
        if not places:
            key, what = ("support", "no points") if self.load is None else ("load", "no force at points")
            yield (key,), f"found {what}; columns are points of at, or one area with a rectangle, circle or polygon."
        for number in self.number or ():
            if number > len(places):
                yield ("number",), f"found column {number}; there are the columns 1 to {len(places)}."
        if any(self._outline(*place[:2], 1) is None for place in places):
            yield ("column",), "the outline of the columns is missing. Give column = [b, h] or diameter."
        units = model.units
        for key, unit, known in (("length", units.length, METRES), ("force", units.force, NEWTONS)):
            if unit not in known:
                yield (), f"{self.code} needs a known unit of {key} in units; found {unit!r} of {', '.join(known)}."
                return
        strength = self.fck * NEWTONS[units.force] / (1e3 * METRES[units.length]) ** 2
        if not _STRENGTHS[0] <= strength <= _STRENGTHS[1]:
            unit = f"{units.force}/{units.length}²"
            yield ("fck",), f"found {self.fck:g} {unit}, which is {strength:.3g} MPa; give 5 to 120 MPa in {unit}."


def columns_of(model: Whole) -> tuple[ColumnAt, ...]:
    """The columns of all tables, in their order."""
    return tuple(column for table, punching in enumerate(model.punching) for column in punching.columns(model, table))
