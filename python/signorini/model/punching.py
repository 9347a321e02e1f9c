"""Tables [[punching]] of the input: columns to be checked for punching, design code, depth and reinforcement."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field

from signorini.base.units import METRES, NEWTONS
from signorini.errors import unknown
from signorini.model import base
from signorini.model.load import Load
from signorini.model.support import Support
from signorini.model.where import Acting
from signorini.shapes import Hollow, Whole

EN_1992, ACI_318 = "EN 1992-1-1:2004", "ACI 318-19"
_RANGES = {"fck": (5.0, 120.0), "fyk": (200.0, 1000.0)}
"""Smallest and largest accepted strength in MPa; other values are probably in a wrong unit."""
_MOST_STEEL = 0.1
"""Largest accepted ratio of reinforcement As / (b d); a larger value is probably in per cent."""


Pair = Annotated[tuple[base.Positive, base.Positive], *base.vector(2, "two numbers, along x and along y")]


class ColumnAt(NamedTuple):
    """A column: name such as "punching:columns[3]", indices of its [[punching]], point and support, center, outline."""

    subject: str
    table: int
    point: int
    support: int | None  # None for a column that stands on the plate, as a load
    at: tuple[float, float]
    outline: Whole


class Punching(base.OnPlate, base.Named):
    """A check of the plate for punching: by columns below (a support), or by columns on it (forces of a load case)."""

    name: base.Text = Field(
        default="", description="Name of the columns; default the name of the support or load case."
    )
    support: base.Text | None = Field(
        default=None,
        description="Name of the support that represents the columns: each of its points, or its area, is a column.",
    )
    load: base.Text | None = Field(
        default=None,
        description="In place of support: a load case with the forces of columns that stand on the plate.",
    )
    number: base.Counts | None = Field(
        default=None, description="Numbers of the columns that are checked, counted from 1; default all columns."
    )
    code: Literal["EN 1992-1-1:2004", "ACI 318-19"] = Field(description="Design code.")
    column: Pair | None = Field(
        default=None, description="Sides [b, h] of rectangular columns; default the footprint of the support or load."
    )
    diameter: base.Positive | None = Field(default=None, description="Diameter of circular columns.")
    angle: base.Number = Field(
        default=0.0, description="Angle in degrees from the x axis to the first side of the rectangle `column`."
    )
    d: Pair | None = Field(
        default=None,
        description="Effective depths [dx, dy] of the bars in tension; default: least thickness within the control "
        "perimeter less distance of these bars in [reinforcement]: top bars over a support, bottom bars of a raft.",
    )
    rho: Pair | None = Field(
        default=None,
        description="Ratios [ρx, ρy] of the bars in tension, for EN 1992; default with [reinforcement]: minimum ratio.",
    )
    fck: base.Positive | None = Field(
        default=None, description="Strength of concrete, fck or f'c, as force per area; default fck of [reinforcement]."
    )
    fyk: base.Positive | None = Field(
        default=None,
        description="Strength of shear reinforcement, fyk or fyt, as force per area; default fyk of [reinforcement].",
    )
    beta: Literal["computed"] | base.Positive = Field(
        default="computed",
        description='Factor β ≥ 1 by which unbalanced moments increase the shear stress: "computed", or a number.',
    )

    def _complaints(self) -> Iterator[base.Complaint]:
        for keys, needed in ((("support", "load"), 1), (("column", "diameter"), 0)):
            if not needed <= len(found := self.present(keys)) <= 1:
                yield (), f"found {' and '.join(found) or 'none'} of {' and '.join(keys)}; give one."

    @property
    def columns_name(self) -> str:
        """Common part of the columns' names: ``name``, by default the name of the support or load case."""
        return self.name or self.support or self.load or ""

    def columns(self, supports: Sequence[Support], loads: Sequence[Load], table: int = 0) -> Iterator[ColumnAt | None]:
        """Yield the column at each point, or None if it has no outline; ``table`` is the index of this [[punching]]."""
        places: list[tuple[Acting, tuple[float, float], int | None]] = []
        for load in loads:
            if load.case == self.load and load.plate == self.plate and load.force is not None:
                known = [at for _, at, _ in places]
                places += [(load, at, None) for at in load.at or () if at not in known]
        for index, support in enumerate(supports):
            if support.name == self.support and (region := support.where.region) is not None:
                x0, y0, x1, y1 = region.bounds
                places.append((support, (0.5 * (x0 + x1), 0.5 * (y0 + y1)), index))
            elif support.name == self.support:
                places += [(support, at, index) for at in support.at or ()]
        for point, (acting, at, support_index) in enumerate(places):
            outline, subject = self._outline(acting, at), f"punching:{self.columns_name}[{point + 1}]"
            yield None if outline is None else ColumnAt(subject, table, point, support_index, at, outline)

    def _outline(self, acting: Acting, at: tuple[float, float]) -> Whole | None:
        if self.column is not None or self.diameter is not None:
            radius = None if self.diameter is None else 0.5 * self.diameter
            acting = Acting.model_construct(at=(at,), patch=self.column, radius=radius, angle=self.angle)
        where = acting.where
        region = where.footprints[where.points.index(at)] if where.footprints else where.region
        return region.around if isinstance(region, Hollow) else region

    def complaints_of(
        self, supports: Sequence[Support], loads: Sequence[Load], units: Any, reinforced: bool
    ) -> Iterator[base.Complaint]:
        """Yield the contradictions with other tables of the model, each with its path within this table, and a message.

        ``reinforced`` says whether the model has [reinforcement].
        """
        needed = ("d", "rho", "fck", "fyk") if self.code == EN_1992 else ("d", "fck", "fyk")
        for key in (key for key in needed if not reinforced and getattr(self, key) is None):
            yield (key,), f"'{key}' is missing. Give it, or a table [reinforcement], from which it is taken."
        names, columns = [support.name for support in supports], list(self.columns(supports, loads))
        if self.support is not None and self.support not in names:
            yield ("support",), unknown("support", self.support, names)
        elif not columns:
            key, what = ("support", "no points") if self.load is None else ("load", "no force at points")
            yield (key,), f"found {what}; columns are the points of at, or one area as rectangle, circle or polygon."
        elif None in columns:
            yield ("column",), "the outline of the columns is missing. Give column = [b, h] or diameter."
        for number in self.number or ():
            if number > len(columns):
                yield ("number",), f"found column {number}; there are the columns 1 to {len(columns)}."
        for key, unit, known in (("length", units.length, METRES), ("force", units.force, NEWTONS)):
            if unit not in known:
                yield (), f"{self.code} needs a known unit of {key} in units; found {unit!r} of {', '.join(known)}."
                return
        unit, pascals = f"{units.force}/{units.length}²", NEWTONS[units.force] / METRES[units.length] ** 2
        for key, (least, most) in _RANGES.items():
            value = getattr(self, key)
            if value is not None and not least <= (strength := value * pascals * 1e-6) <= most:
                why = f"found {value:g} {unit}, which is {strength:.3g} MPa; give {least:g} to {most:g} MPa in {unit}."
                yield (key,), why
        if self.rho is not None and max(self.rho) > _MOST_STEEL:
            yield ("rho",), f"found {max(self.rho):g}; a ratio is at most {_MOST_STEEL:g}, 0.6 % is 0.006."
        if isinstance(self.beta, float) and self.beta < 1.0:
            yield ("beta",), f"found {self.beta:g}; β, the largest over the mean shear stress, is at least 1."


def columns_of(tables: Sequence[Punching], supports: Sequence[Support], loads: Sequence[Load]) -> tuple[ColumnAt, ...]:
    """Return the columns that the tables [[punching]] check, in the order of these tables."""
    every = ((own, table) for index, table in enumerate(tables) for own in table.columns(supports, loads, index))
    chosen = ((column, table.number) for column, table in every if column is not None)
    return tuple(column for column, numbers in chosen if numbers is None or column.point + 1 in numbers)
