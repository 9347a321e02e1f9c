"""The largest and the smallest of many results, and which of them they come from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from signorini import _core
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.results.columns import Block, Layout
from signorini.results.extremes import NUMBERS
from signorini.results.result import FIELDS, Result
from signorini.results.section_result import COMPONENTS

NONE = -1
"""Number of no result."""
_GOVERNING = 12
"""Results at most that count as governing."""
_EQUAL = 1e-9
"""Part of the largest of their kind within which numbers differ by rounding: they are as large."""
_KINDS = {name: NUMBERS.get(name, "rotation" if "rotation" in name else name) for name in FIELDS}
"""What numbers of a field are compared with."""


@dataclass(frozen=True, eq=False)
class Extremes:
    """Largest and smallest values (n,) met so far, with the numbers of the results, of equals the first.

    Values are equal within a billionth of the ``size`` (n,) of the largest of their kind; where that is 0, to the bit.
    """

    largest: Floats
    largest_by: Ints
    smallest: Floats
    smallest_by: Ints
    size: Floats

    @classmethod
    def none(cls, size: int) -> Extremes:
        """Nothing met yet."""
        who = np.full(size, NONE, dtype=np.int64)
        return cls(np.full(size, -np.inf), who, np.full(size, np.inf), who.copy(), np.zeros(size))

    def take(self, values: Floats, who: Ints, size: float | Floats = 0.0) -> None:
        """Meet values (k, n) of results (k,), in rising order, the largest of whose kind is of ``size``.

        Examples
        --------
        >>> extremes = Extremes.none(1)
        >>> extremes.take(np.array([[5.0], [5.0 + 1e-12], [-5.0 + 1e-12], [-5.0]]), np.arange(4), size=5.0)
        >>> extremes.largest_by, extremes.smallest_by
        (array([0]), array([2]))
        """
        if not values.size:
            return
        np.maximum(self.size, size, out=self.size)
        columns, within = np.arange(values.shape[1]), _EQUAL * self.size
        for bound, by, sign in ((self.largest, self.largest_by, 1.0), (self.smallest, self.smallest_by, -1.0)):
            signed = sign * values
            most = signed.max(axis=0)
            at = (signed >= most - within).argmax(axis=0)
            better = most > sign * bound + within
            bound[better], by[better] = values[at, columns][better], who[at[better]]

    def meet(self, other: Extremes) -> tuple[Bools, Bools]:
        """Meet what others have met; return which of the largest and smallest (n,) are theirs."""
        found = []
        np.maximum(self.size, other.size, out=self.size)
        within = _EQUAL * self.size
        for mine, by, theirs, who, sign in (
            (self.largest, self.largest_by, other.largest, other.largest_by, 1.0),
            (self.smallest, self.smallest_by, other.smallest, other.smallest_by, -1.0),
        ):
            earlier = (who < by) & (who != NONE)
            better = sign * theirs > sign * mine + np.where(earlier, -within, within)
            better |= earlier & (theirs == mine)
            mine[better], by[better] = theirs[better], who[better]
            found.append(better)
        return found[0], found[1]

    @property
    def ends(self) -> tuple[int, int]:
        """Which of these numbers is the largest of all, and which the smallest; of equals that of the first result."""
        high, low = (
            np.where(signed >= signed.max() - _EQUAL * self.size.max(), by, np.iinfo(np.int64).max).argmin()
            for signed, by in ((self.largest, self.largest_by), (-self.smallest, self.smallest_by))
        )
        return int(high), int(low)

    def take_sums(
        self, coefficients: Floats, vectors: Floats, who: Ints, classes: Ints, left_out: Bools
    ) -> tuple[Floats, Ints]:
        """Meet sums of vectors (b, n) with coefficients (k, b); return each one's extremes and their places (k, 2).

        Those extremes leave out what is in some of the classes (n,), by ``left_out`` (k, c).
        """
        extremes = (self.largest, self.largest_by, self.smallest, self.smallest_by)
        return _core.envelop(coefficients, vectors, who, *extremes, classes, left_out)


@dataclass(frozen=True, eq=False)
class Concurrent:
    """Extremes of numbers (e,), and of each the reactions of all bearings in that result (e, b).

    The first numbers are these reactions.
    """

    extremes: Extremes
    with_largest: Floats
    with_smallest: Floats

    @classmethod
    def none(cls, size: int, bearings: int) -> Concurrent:
        """Nothing met yet."""
        return cls(Extremes.none(size), np.full((size, bearings), np.nan), np.full((size, bearings), np.nan))

    def take(self, values: Floats, who: Ints, size: Floats) -> None:
        """Meet numbers (k, e) of results (k,), in rising order, the largest of whose kinds are of a size (e,)."""
        largest_by, smallest_by = self.extremes.largest_by.copy(), self.extremes.smallest_by.copy()
        self.extremes.take(values, who, size)
        for now, before, beside in (
            (self.extremes.largest_by, largest_by, self.with_largest),
            (self.extremes.smallest_by, smallest_by, self.with_smallest),
        ):
            changed = np.flatnonzero(now != before)
            beside[changed] = values[np.searchsorted(who, now[changed]), : beside.shape[1]]

    def meet(self, other: Concurrent) -> None:
        """Meet what others have met."""
        larger, smaller = self.extremes.meet(other.extremes)
        self.with_largest[larger] = other.with_largest[larger]
        self.with_smallest[smaller] = other.with_smallest[smaller]


@dataclass(frozen=True, eq=False)
class Peaks:
    """The largest and the smallest of the results' own extremes of fields (f,), and where (f, 2) these are."""

    extremes: Extremes
    largest_at: Floats
    smallest_at: Floats

    @classmethod
    def none(cls, fields: int) -> Peaks:
        """Nothing met yet."""
        return cls(Extremes.none(fields), np.full((fields, 2), np.nan), np.full((fields, 2), np.nan))

    def take(self, peaks: Floats, places: Floats, who: Ints, size: Floats) -> None:
        """Meet extremes (k, f, 2) of results (k,), in rising order, and their places (k, f, 2, 2).

        The largest of the fields' kinds are of a ``size`` (f,).
        """
        if not len(who):
            return
        highest, lowest = Extremes.none(peaks.shape[1]), Extremes.none(peaks.shape[1])
        highest.take(peaks[..., 0], who, size)
        lowest.take(peaks[..., 1], who, size)
        one = Extremes(highest.largest, highest.largest_by, lowest.smallest, lowest.smallest_by, highest.size)
        fields, high, low = np.arange(peaks.shape[1]), *np.searchsorted(who, [one.largest_by, one.smallest_by])
        self.meet(Peaks(one, places[high, fields, 0], places[low, fields, 1]))

    def meet(self, other: Peaks) -> None:
        """Meet what others have met."""
        larger, smaller = self.extremes.meet(other.extremes)
        self.largest_at[larger] = other.largest_at[larger]
        self.smallest_at[smaller] = other.smallest_at[smaller]


@dataclass(frozen=True, eq=False)
class SupportEnvelope:
    """Extremes of one support.

    Parameters
    ----------
    reaction : Extremes
        Of its total (1,).
    points : Extremes
        Of the reaction of every point (p,).
    gap : Extremes
        Of what is left of the travel of every point (p,); the largest is by the result that lifts it most.
    lifted : (p,) array
        In how many results the point is open.
    pressure : Extremes
        Of an area, the pressures at its points and, if it is elastic, its nodes behind them; else none.
    places : (q, 2) array
        Where these are.
    pressed : Extremes or None
        Of an area, of its largest pressure and of the part of it in contact (2,).
    """

    reaction: Extremes
    points: Extremes
    gap: Extremes
    lifted: Ints
    pressure: Extremes
    places: Floats
    pressed: Extremes | None


@dataclass(frozen=True, eq=False)
class Envelope:
    """Extremes over all results with an equilibrium.

    Parameters
    ----------
    fields : dict of Extremes
        At every node of a field, by its name.
    pressures : dict
        "contact_pressure" at the nodes of elastic areas, "rigid_contact_pressure" on the elements of rigid ones: which
        nodes or elements (k,), and the extremes there.
    supports : tuple of SupportEnvelope
        In the order of the model.
    probes : Extremes
        Of every field at every probe, (8q,).
    through : Extremes
        Of moment, twist and shear of every section, and of their means at every station of a strip (3s,).
    sections : sequence of str
        Columns of the first of these, which are of sections.
    bearings : Concurrent
        Of what the layout calls governed, in its order.
    names : tuple of str
        Fields whose extremes over nodes each result has, away from where these have no limit: those of ``peaks``.
    peaks : Peaks
    """

    fields: dict[str, Extremes]
    pressures: dict[str, tuple[Ints, Extremes]]
    supports: tuple[SupportEnvelope, ...]
    probes: Extremes
    through: Extremes
    sections: Sequence[str]
    bearings: Concurrent
    names: tuple[str, ...]
    peaks: Peaks

    @classmethod
    def none(cls, layout: Layout, mesh: Mesh) -> Envelope:
        """Nothing met yet."""
        names = list(layout.fields)
        if names and any(support.on_nodes for support in layout.model.support):
            names.append("reaction")
        on = {"contact_pressure": layout.pressures.nodes, "rigid_contact_pressure": layout.pressures.elements}
        return cls(
            {name: Extremes.none(len(layout.nodes if name in NUMBERS else mesh.points)) for name in names},
            {name: (places, Extremes.none(len(places))) for name, places in on.items() if len(places) and names},
            tuple(_nothing_of(layout, index) for index in range(len(layout.supports))),
            Extremes.none(len(FIELDS) * len(layout.probes)),
            Extremes.none(len(layout.through)),
            layout.through[: len(COMPONENTS) * len(layout.model.section)],
            Concurrent.none(len(layout.governed), len(layout.bearings)),
            layout.fields,
            Peaks.none(len(layout.fields)),
        )

    def take_fields(self, result: Result, who: Ints) -> None:
        """Meet the fields of one result (1,)."""
        for name, extremes in self.fields.items():
            extremes.take((result.nodal_reaction if name == "reaction" else result.fields[name])[None], who)

    def meet(self, other: Envelope) -> None:
        """Meet what others have met."""
        pairs = [(self.probes, other.probes), (self.through, other.through)]
        pairs += [(mine, other.fields[name]) for name, mine in self.fields.items()]
        pairs += [(mine, other.pressures[name][1]) for name, (_, mine) in self.pressures.items()]
        for here, there in zip(self.supports, other.supports, strict=True):
            pairs += [(here.reaction, there.reaction), (here.points, there.points), (here.gap, there.gap)]
            pairs += [(here.pressure, there.pressure)]
            pairs += [(here.pressed, there.pressed)] if here.pressed is not None and there.pressed is not None else []
            here.lifted[:] += there.lifted
        for mine, theirs in pairs:
            mine.meet(theirs)
        self.bearings.meet(other.bearings)
        self.peaks.meet(other.peaks)

    def take(self, block: Block, layout: Layout, rows: Ints) -> None:
        """Meet supports, probes, sections and strips of rows (k,) of a block that were solved."""
        who, probes, through = block.numbers[rows], block.probes[rows], block.through[rows]
        self.probes.take(probes, who, _sizes(probes, [_KINDS[name] for name in FIELDS] * len(layout.probes)))
        self.through.take(through, who, _sizes(through, layout.through_kinds))
        governed = layout.of_governed(block.reaction[rows], block.gap[rows], block.areas[rows])
        self.bearings.take(governed, who, _sizes(governed, [what for what, _ in layout.governed]))
        peaks = block.peaks[rows]
        fields = np.fmax.reduce(np.abs(peaks), axis=2, initial=0.0)
        self.peaks.take(peaks, block.places[rows], who, _sizes(fields, [_KINDS[name] for name in layout.fields]))
        totals = [block.reaction[rows, where].sum(axis=1) for where in layout.slices]
        load, force, travel = (_size(part) for part in (totals, block.reaction[rows], block.gap[rows]))
        for where, total, support in zip(layout.slices, totals, self.supports, strict=True):
            support.reaction.take(total[:, None], who, load)
            support.points.take(block.reaction[rows, where], who, force)
            support.gap.take(block.gap[rows, where], who, travel)
            support.lifted[:] += (~block.closed[rows, where]).sum(axis=0)
        if layout.at_rest and len(who):
            self._take_areas(block, layout, rows)

    def _take_areas(self, block: Block, layout: Layout, rows: Ints) -> None:
        """Meet the pressures of areas."""
        who, slices = block.numbers[rows], layout.slices
        forces = [block.reaction[rows, slices[index]] for index in layout.at_rest]
        for at, ((index, area), force) in enumerate(zip(layout.at_rest.items(), forces, strict=True)):
            support = self.supports[index]
            pressure = area.measured(block.around(area, layout, rows), force)[0]
            support.pressure.take(pressure, who, _size(pressure))
            if support.pressed is not None:
                pressed = block.areas[rows, at]
                support.pressed.take(pressed, who, np.abs(pressed).max(axis=0))
        pressures = layout.pressures
        for name, (nodes, extremes) in self.pressures.items():
            if name == "rigid_contact_pressure":
                pressure = pressures.on_elements(forces)
            else:
                deflection = block.on_areas[np.ix_(rows, np.searchsorted(layout.around_areas, nodes))]
                pressure = pressures.at_nodes(deflection, forces)
            extremes.take(pressure, who, _size(pressure))

    def governing(self) -> dict[str, tuple[float, int, float, int]]:
        """Largest value, by which result, smallest value, and by which; of fields, supports' reactions and sections.

        Keys are names of fields, "reaction:" with a support's place in the model, and columns of sections.
        """
        ends = {name: (self.peaks.extremes, at, at) for at, name in enumerate(self.names)}
        if "reaction" in self.fields:
            ends["reaction"] = self.fields["reaction"], *self.fields["reaction"].ends
        ends |= {f"reaction:{index}": (support.reaction, 0, 0) for index, support in enumerate(self.supports)}
        ends |= {name: (self.through, at, at) for at, name in enumerate(self.sections)}
        return {
            name: (float(of.largest[high]), int(of.largest_by[high]), float(of.smallest[low]), int(of.smallest_by[low]))
            for name, (of, high, low) in ends.items()
        }

    @property
    def rows(self) -> list[int]:
        """Numbers of the results with an extreme of some field, reaction or section, in that order, some at most."""
        found = self.governing().values()
        return [*dict.fromkeys(by for _, high, _, low in found for by in (high, low) if by != NONE)][:_GOVERNING]


def _sizes(values: Floats, kinds: Sequence[str]) -> Floats:
    """Sizes (n,) of the largest of values (k, n) of each one's kind."""
    names, which = np.unique(np.array(kinds, dtype=np.str_), return_inverse=True)
    largest = np.zeros(len(names))
    np.fmax.at(largest, which, np.fmax.reduce(np.abs(values), axis=0, initial=0.0))
    return largest[which]


def _size(values: ArrayLike) -> float:
    """The size of the largest of values, but for those that are none."""
    return float(np.fmax.reduce(np.abs(np.asarray(values, dtype=np.float64)), axis=None, initial=0.0))


def _nothing_of(layout: Layout, index: int) -> SupportEnvelope:
    """Nothing met yet by a support."""
    count, area, places = len(layout.supports[index].positions), layout.at_rest.get(index), np.zeros((0, 2))
    if area is not None:
        places = area.measured(area.deflection[area.on_nodes], area.reactions)[1]
    return SupportEnvelope(
        Extremes.none(1),
        Extremes.none(count),
        Extremes.none(count),
        np.zeros(count, dtype=np.int64),
        Extremes.none(len(places)),
        places,
        None if area is None else Extremes.none(2),
    )
