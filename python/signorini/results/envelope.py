"""Envelopes: largest and smallest values over many results, and the numbers of the results in which they occur."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from signorini import _core
from signorini.base.arguments import key_of
from signorini.base.remade import Brief, Remade
from signorini.contact.problem import ContactProblem
from signorini.design.en1992_bending import Bars
from signorini.discretise import Discretisation
from signorini.discretise.discretisation import OfWhole
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.model import Check, Model
from signorini.results.quantities import ENDS, PEAKING, SIDES, FieldGroup, Home
from signorini.results.rows import Block, Column, Layout
from signorini.results.state import ResultState

_SIGNS = (1.0, -1.0)
"""Signs by which values are multiplied so that the largest product is the maximum (+1) or the minimum (−1)."""
NONE = -1
"""Number of the governing result in an envelope that contains no result yet."""
_GOVERNING = 12
"""Largest number of governing results that `Envelope.rows` lists."""
_EQUAL = 1e-9
"""Relative tolerance for equal values: relative to the largest value of the same kind, such as all moments."""


@dataclass(frozen=True, eq=False)
class Extremes:
    """Largest and smallest value of each of n numbers over many results, and the results in which they occur.

    If values are equal, the first result governs. Values are equal if they differ by at most 10⁻⁹ ``size`` (n,), where
    ``size`` is the largest magnitude of the same kind of numbers. Where ``size`` is 0, only identical values are equal.
    """

    largest: Floats
    largest_by: Ints
    smallest: Floats
    smallest_by: Ints
    size: Floats

    @classmethod
    def none(cls, size: int) -> Extremes:
        """Extremes of ``size`` numbers before any result is taken: largest value −∞, smallest value ∞."""
        who = np.full(size, NONE, dtype=np.int64)
        return cls(np.full(size, -np.inf), who, np.full(size, np.inf), who.copy(), np.zeros(size))

    @property
    def sides(self) -> tuple[tuple[Floats, Ints], tuple[Floats, Ints]]:
        """The largest values with their result numbers, then the smallest values with their result numbers."""
        return (self.largest, self.largest_by), (self.smallest, self.smallest_by)

    def take(self, values: Floats, who: Ints, size: float | Floats = 0.0) -> list[Bools]:
        """Extend the extremes by the values (k, n) of k further results, numbered ``who`` (k,) in rising order.

        ``size`` is the largest magnitude of each number's kind. Returns a mask (n,) of the largest values that changed,
        and one of the smallest values that changed.

        Examples
        --------
        >>> extremes = Extremes.none(1)
        >>> _ = extremes.take(np.array([[5.0], [5.0 + 1e-12], [-5.0 + 1e-12], [-5.0]]), np.arange(4), size=5.0)
        >>> extremes.largest_by, extremes.smallest_by
        (array([0]), array([2]))
        """
        if not len(values):
            return [np.zeros(len(self.size), np.bool_)] * 2
        np.maximum(self.size, size, out=self.size)
        columns, within, new = np.arange(values.shape[1]), _EQUAL * self.size, []
        for (bound, by), sign in zip(self.sides, _SIGNS, strict=True):
            signed = sign * values
            most = np.fmax.reduce(signed, axis=0)
            at = (signed >= most - within).argmax(axis=0)
            better = most > sign * bound + within
            bound[better], by[better] = values[at, columns][better], who[at[better]]
            new.append(better)
        return new

    def meet(self, other: Extremes) -> list[Bools]:
        """Extend the extremes by the extremes of other results; return masks (n,) as `take` does."""
        result = []
        np.maximum(self.size, other.size, out=self.size)
        within = _EQUAL * self.size
        for (mine, by), (theirs, who), sign in zip(self.sides, other.sides, _SIGNS, strict=True):
            earlier = (who < by) & (who != NONE)
            better = sign * theirs > sign * mine + np.where(earlier, -within, within)
            better |= earlier & (theirs == mine)
            mine[better], by[better] = theirs[better], who[better]
            result.append(better)
        return result

    def pick(self, which: Ints | slice) -> Extremes:
        """Extremes of only those numbers that have the indices ``which``."""
        return Extremes(*(getattr(self, one.name)[which] for one in fields(self)))

    def put(self, which: Ints | slice, some: Extremes) -> None:
        """Replace the extremes of the numbers with indices ``which`` by the extremes ``some``."""
        for one in fields(self):
            getattr(self, one.name)[which] = getattr(some, one.name)

    @property
    def ends(self) -> tuple[int, int]:
        """Indices of the numbers with the largest and the smallest of all values; ties: that of the first result."""
        within = _EQUAL * self.size.max()
        high, low = (
            np.where(sign * of >= (sign * of).max() - within, by, np.iinfo(np.int64).max).argmin()
            for (of, by), sign in zip(self.sides, _SIGNS, strict=True)
        )
        return int(high), int(low)

    @staticmethod
    def take_sums(
        each: Sequence[Extremes],
        fields: FieldGroup,
        coefficients: Floats,
        inputs: Sequence[Floats],
        thickness: Floats,
        bars: Bars | None,
        who: Ints,
        classes: Ints,
        left_out: Bools,
    ) -> tuple[Floats, Ints]:
        """Extend the extremes ``each`` of several fields by k superposed results, numbered ``who`` (k,).

        The formulas of the fields take sums of ``inputs`` (b, n) with coefficients (k, b), the thickness (n,) and
        `Model.bars`. Returns the maximum and minimum over the nodes of each field in each sum (f, k, 2), and the nodes
        (f, k, 2) where they occur. ``classes`` (n,) is the class of each node; ``left_out`` (k, c) marks the classes
        that are excluded from the extremes of each sum.
        """
        bounds = [(*one.sides[0], *one.sides[1]) for one in each]
        of = coefficients, inputs, fields.formulas, fields.wanted, thickness, bars or ()
        peaks, places = _core.envelop(*of, who, bounds, classes, left_out)
        # The core returns minus infinity for a field whose values are all NaN.
        peaks[np.isneginf(peaks[..., 0])] = np.nan
        return peaks, places


@dataclass(frozen=True)
class Ends:
    """Largest and smallest value of a number over many results, and the numbers of the results in which they occur."""

    max: float
    max_by: int
    min: float
    min_by: int


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Envelope:
    """Extremes over all results with an equilibrium, and the numbers of the results in which they occur."""

    __repr__ = Brief.__repr__

    layout: Layout
    values: Extremes  # (n,): extremes of every number in the layout's catalogue
    # (f, 4, 2): positions of max, min, max_mean and min_mean of each field; with several plates also by plate
    places: Floats
    beside: Floats
    """(2, e, b): reactions of the b bearings in the results with the maximum and the minimum of each of e numbers.

    The numbers are those of ``layout.governed``.
    """
    # extremes of each field at every node, by name of the field; "reaction" is the nodal force of the supports
    fields: dict[str, Extremes]
    pressures: dict[str, tuple[Ints, Extremes]]
    """Indices (k,) of the nodes on elastic areas, and the extremes of "contact_pressure" at these nodes.

    Also, indices (k,) of the elements on rigid areas, and the extremes of "rigid_contact_pressure" in these elements.
    """
    along: dict[int, Extremes]
    """Extremes of an area's pressures at its `pressure_places`, or of the reactions of a line's points, by support."""
    on_lines: Extremes  # extremes of reactions per length and concentrated forces of all lines, see `Layout.on_lines`
    open_in: tuple[Ints, ...]  # for each support, counts (p,) of the results in which each point is open
    lifted_in: tuple[Ints, ...]  # for each support, counts (p,) of the results with lift-off at each point

    @classmethod
    def none(cls, layout: Layout, mesh: Mesh) -> Envelope:
        """Envelope that contains no result yet."""
        names = list(layout.fields)
        if names and any(support.on_nodes for support in layout.model.support):
            names.append("reaction")
        on = {"contact_pressure": layout.pressures.nodes, "rigid_contact_pressure": layout.pressures.elements}
        along = {}
        for index, (support, points) in enumerate(zip(layout.model.support, layout.supports, strict=True)):
            if index in layout.at_rest:
                along[index] = Extremes.none(len(layout.at_rest[index].pressure_places))
            elif support.place != "at" and support.area is None:
                along[index] = Extremes.none(len(points.positions))
        return cls(
            layout=layout,
            values=Extremes.none(len(layout.catalogue)),
            places=np.full((len(layout.catalogue.at("field", "max")), len(ENDS), 2), np.nan),
            beside=np.full((2, len(layout.governed), len(layout.bearings)), np.nan),
            fields={name: Extremes.none(len(layout.nodes if name in PEAKING else mesh.points)) for name in names},
            pressures={
                name: (places, Extremes.none(len(places))) for name, places in on.items() if len(places) and names
            },
            along=along,
            on_lines=Extremes.none(max((where.stop for where in layout.on_lines.values()), default=0)),
            open_in=tuple(np.zeros(len(points.positions), np.int64) for points in layout.supports),
            lifted_in=tuple(np.zeros(len(points.positions), np.int64) for points in layout.supports),
        )

    def __getitem__(self, column: str) -> Ends:
        """Extremes of the number that is in a column of the table."""
        by_column = self.layout.catalogue.by_column
        at, of = by_column[key_of(column, by_column, "column", "This envelope")], self.values
        largest, smallest = float(of.largest[at]), float(of.smallest[at])
        return Ends(largest, int(of.largest_by[at]), smallest, int(of.smallest_by[at]))

    def field(self, name: str, mean: str = "") -> Ends:
        """Extremes of a field over all results and all nodes outside singular places.

        If ``mean`` is "_mean", these are the extremes of the field's means at singular points. With several plates
        "plate.field" names the field of one plate.
        """
        high, low = self[f"max{mean}:{name}"], self[f"min{mean}:{name}"]
        return Ends(high.max, high.max_by, low.min, low.min_by)

    def utilisation(self, field: str, check: Check) -> tuple[Floats, Ints]:
        """Largest utilisation (n,) of a checked field at each node, and the row (n,) of the table with it; else NaN."""
        sides = self.fields[field].sides
        used = [np.where(by == NONE, -np.inf, check.used(values)) for values, by in sides]
        smallest = used[1] > used[0]
        values, rows = np.where(smallest, used[1], used[0]), np.where(smallest, sides[1][1], sides[0][1])
        return np.where(rows == NONE, np.nan, values), rows

    def places_of(self, name: str) -> Floats:
        """Positions (2, 2) of the largest and the smallest value of a field; ``name`` is as in `field`."""
        catalogue = self.layout.catalogue
        places: Floats = self.places[catalogue.numbers[catalogue.by_column[f"max:{name}"]].owner]
        return places

    def on(self, plate: OfWhole) -> Envelope:
        """Copy of the envelope in which `fields` has only the nodes of one of several plates."""
        nodes = np.arange(plate.nodes.start, plate.nodes.stop)
        at = {name: plate.stress_nodes if name in PEAKING else nodes for name in self.fields}
        return replace(self, fields={name: one.pick(at[name]) for name, one in self.fields.items()})

    def take_fields(self, result: ResultState, who: Ints) -> None:
        """Extend the nodal extremes `fields` by one complete result; ``who`` (1,) is its number."""
        for name, extremes in self.fields.items():
            extremes.take((result.nodal_reaction if name == "reaction" else result.fields[name])[None], who)

    def take(self, block: Block, rows: Ints) -> None:
        """Extend the envelope by those rows (k,) of a block whose results have an equilibrium."""
        if not len(rows):
            return
        layout, values, who = self.layout, block.values[rows], block.numbers[rows]
        before = [by.copy() for _, by in self.values.sides]
        self.values.take(values, who, _sizes(values, [one.ties for one in layout.catalogue]))
        governed, reactions = layout.governed_places, layout.governed_places[: len(layout.bearings)]
        for side, ((_, now), old) in enumerate(zip(self.values.sides, before, strict=True)):
            changed = np.flatnonzero(now[governed] != old[governed])
            self.beside[side, changed] = values[np.searchsorted(who, now[governed[changed]])][:, reactions]
            for at, owner, end in _ends(layout, side):
                some = np.flatnonzero(now[at] != old[at])
                mine = owner[some]
                self.places[mine, end] = block.places[rows[np.searchsorted(who, now[at[some]])], mine, end]
        for index, where in enumerate(layout.slices):
            self.open_in[index][:] += (~block.closed[rows, where]).sum(axis=0)
            self.lifted_in[index][:] += block.lifted[rows, where].sum(axis=0)
            if index in self.along and index not in layout.at_rest:
                own = block.reaction[rows, where]
                self.along[index].take(own, who, _size(own))
        self.on_lines.take(block.on_lines[rows], who, _size(block.on_lines[rows]))
        if layout.at_rest:
            self._take_areas(block, rows)

    def _take_areas(self, block: Block, rows: Ints) -> None:
        """Extend the envelope by the pressures of areas in the rows (k,) of a block."""
        layout, who = self.layout, block.numbers[rows]
        forces = [block.reaction[rows, layout.slices[index]] for index in layout.at_rest]
        for (index, area), force in zip(layout.at_rest.items(), forces, strict=True):
            pressure = area.measured(block.around(area, layout, rows), force)
            self.along[index].take(pressure, who, _size(pressure))
        for name, (nodes, extremes) in self.pressures.items():
            if name == "rigid_contact_pressure":
                pressure = layout.pressures.on_elements(forces)
            else:
                deflection = block.on_areas[np.ix_(rows, np.searchsorted(layout.around_areas, nodes))]
                pressure = layout.pressures.at_nodes([deflection] * len(forces), forces)
            extremes.take(pressure, who, _size(pressure))

    def meet(self, other: Envelope) -> None:
        """Extend this envelope by another envelope of other results."""
        new = self.values.meet(other.values)
        for side, better in enumerate(new):
            at = better[self.layout.governed_places]
            self.beside[side, at] = other.beside[side, at]
            for numbers, owner, end in _ends(self.layout, side):
                theirs = owner[better[numbers]]
                self.places[theirs, end] = other.places[theirs, end]
        pairs = [(mine, other.fields[name]) for name, mine in self.fields.items()]
        pairs += [(mine, other.pressures[name][1]) for name, (_, mine) in self.pressures.items()]
        pairs += [(mine, other.along[index]) for index, mine in self.along.items()]
        pairs.append((self.on_lines, other.on_lines))
        for extremes, others in pairs:
            extremes.meet(others)
        counts = (*self.open_in, *self.lifted_in), (*other.open_in, *other.lifted_in)
        for count, more in zip(*counts, strict=True):
            count[:] += more

    @property
    def rows(self) -> list[int]:
        """Numbers of at most `_GOVERNING` results with extremes: of fields, then of reactions, sections and means."""
        result = [self.field(name) for name in self.layout.fields]
        if "reaction" in self.fields:
            of = self.fields["reaction"]
            high, low = of.ends
            result.append(Ends(0.0, int(of.largest_by[high]), 0.0, int(of.smallest_by[low])))
        told = (one for one in self.layout.catalogue if one.home in ("support", "section"))
        result += [self[one.column] for one in told if one.home == "section" or one.what == "reaction"]
        for name in (name for name in self.layout.fields if name in PEAKING):
            field, mean = self.field(name), self.field(name, "_mean")
            rows = mean.max_by if mean.max > field.max else NONE, mean.min_by if mean.min < field.min else NONE
            result.append(Ends(mean.max, rows[0], mean.min, rows[1]))
        return [*dict.fromkeys(by for one in result for by in (one.max_by, one.min_by) if by != NONE)][:_GOVERNING]


def _ends(layout: Layout, side: int) -> Iterator[tuple[Ints, Ints, int]]:
    """Yield a tuple for the maxima (``side`` 0) or minima (1) of fields, then one for those of means at singularities.

    Each tuple has the indices (k,) in the catalogue, the indices (k,) of the fields, and the index in `ENDS`.
    """
    homes: tuple[Home, Home] = ("field", "mean")
    for home, end in zip(homes, (side, side + len(SIDES)), strict=True):
        at = layout.catalogue.at(home, ENDS[end])
        yield at, np.array([layout.catalogue.numbers[place].owner for place in at], np.int64), end


def _sizes(values: Floats, kinds: list[tuple[str, str, int]]) -> Floats:
    """For each of n numbers, the largest finite magnitude over k results among all numbers of the same kind."""
    values = np.where(np.isinf(values), 0.0, values)
    number_of = {kind: number for number, kind in enumerate(dict.fromkeys(kinds))}
    which = np.array([number_of[kind] for kind in kinds], np.int64)
    largest = np.zeros(len(number_of))
    np.fmax.at(largest, which, np.fmax.reduce(np.abs(values), axis=0, initial=0.0))
    return largest[which]


def _size(values: ArrayLike) -> float:
    """Largest magnitude of an array's values; NaN is ignored."""
    return float(np.fmax.reduce(np.abs(np.asarray(values, dtype=np.float64)), axis=None, initial=0.0))


Key = TypeVar("Key", str, float)


class States(Remade, Generic[Key]):
    """Results of one problem under several loads: table with a row for each load, envelope, and governing rows."""

    problem: ContactProblem

    @property
    def discretisation(self) -> Discretisation:
        """Mesh, supports and loads as arrays."""
        return self.problem.discretisation

    @property
    def model(self) -> Model:
        """The model that was solved."""
        return self.discretisation.model

    @abstractmethod
    def key(self, row: int) -> Key:
        """Key of a row of the table, given the row's number from 0: the combination's name, or t."""

    @property
    @abstractmethod
    def table(self) -> Mapping[str, Column]:
        """Columns of the table by name, each with a number or a text for every row; docs/results.md describes them.

        Missing numbers are NaN.
        """

    @property
    @abstractmethod
    def envelope(self) -> Envelope:
        """Extremes over all rows with an equilibrium, and the numbers (from 0) of the rows in which they occur."""

    @property
    def governing(self) -> tuple[Key, ...]:
        """Keys of the governing rows, those with an extreme of a field, reaction or section; at most `_GOVERNING`."""
        return tuple(map(self.key, self.envelope.rows))
