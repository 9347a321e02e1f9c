"""The largest and the smallest of many results, and which of them they come from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

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


@dataclass(frozen=True, eq=False)
class Extremes:
    """Largest and smallest values (n,) met so far, with the numbers of the results, of equals the first."""

    largest: Floats
    largest_by: Ints
    smallest: Floats
    smallest_by: Ints

    @classmethod
    def none(cls, size: int) -> Extremes:
        """Nothing met yet."""
        who = np.full(size, NONE, dtype=np.int64)
        return cls(np.full(size, -np.inf), who, np.full(size, np.inf), who.copy())

    def take(self, values: Floats, who: Ints) -> None:
        """Meet values (k, n) of results (k,)."""
        if not values.size:
            return
        columns = np.arange(values.shape[1])
        for bound, by, at, sign in (
            (self.largest, self.largest_by, values.argmax(axis=0), 1.0),
            (self.smallest, self.smallest_by, values.argmin(axis=0), -1.0),
        ):
            found = values[at, columns]
            better = sign * found > sign * bound
            bound[better], by[better] = found[better], who[at[better]]

    def meet(self, other: Extremes) -> tuple[Bools, Bools]:
        """Meet what others have met; return which of the largest and smallest (n,) are theirs."""
        found = []
        for mine, by, theirs, who, sign in (
            (self.largest, self.largest_by, other.largest, other.largest_by, 1.0),
            (self.smallest, self.smallest_by, other.smallest, other.smallest_by, -1.0),
        ):
            better = (sign * theirs > sign * mine) | ((theirs == mine) & (who < by) & (who != NONE))
            mine[better], by[better] = theirs[better], who[better]
            found.append(better)
        return found[0], found[1]

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

    def take(self, values: Floats, who: Ints) -> None:
        """Meet numbers (k, e) of results (k,), in rising order."""
        largest_by, smallest_by = self.extremes.largest_by.copy(), self.extremes.smallest_by.copy()
        self.extremes.take(values, who)
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

    def take(self, peaks: Floats, places: Floats, who: Ints) -> None:
        """Meet extremes (k, f, 2) of results (k,), in rising order, and their places (k, f, 2, 2)."""
        if not len(who):
            return
        fields, high, low = np.arange(peaks.shape[1]), peaks[..., 0].argmax(axis=0), peaks[..., 1].argmin(axis=0)
        one = Extremes(peaks[high, fields, 0], who[high], peaks[low, fields, 1], who[low])
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
        who = block.numbers[rows]
        self.probes.take(block.probes[rows], who)
        self.through.take(block.through[rows], who)
        self.bearings.take(layout.of_governed(block.reaction[rows], block.gap[rows], block.areas[rows]), who)
        self.peaks.take(block.peaks[rows], block.places[rows], who)
        for where, support in zip(layout.slices, self.supports, strict=True):
            reaction = block.reaction[rows, where]
            support.reaction.take(reaction.sum(axis=1)[:, None], who)
            support.points.take(reaction, who)
            support.gap.take(block.gap[rows, where], who)
            support.lifted[:] += (~block.closed[rows, where]).sum(axis=0)
        if layout.at_rest and len(who):
            self._take_areas(block, layout, rows)

    def _take_areas(self, block: Block, layout: Layout, rows: Ints) -> None:
        """Meet the pressures of areas."""
        who, slices = block.numbers[rows], layout.slices
        forces = [block.reaction[rows, slices[index]] for index in layout.at_rest]
        for at, ((index, area), force) in enumerate(zip(layout.at_rest.items(), forces, strict=True)):
            support = self.supports[index]
            support.pressure.take(area.measured(block.around(area, layout, rows), force)[0], who)
            if support.pressed is not None:
                support.pressed.take(block.areas[rows, at], who)
        pressures = layout.pressures
        for name, (nodes, extremes) in self.pressures.items():
            if name == "rigid_contact_pressure":
                extremes.take(pressures.on_elements(forces), who)
                continue
            deflection = block.on_areas[np.ix_(rows, np.searchsorted(layout.around_areas, nodes))]
            extremes.take(pressures.at_nodes(deflection, forces), who)

    def governing(self) -> dict[str, tuple[float, int, float, int]]:
        """Largest value, by which result, smallest value, and by which; of fields, supports' reactions and sections.

        Keys are names of fields, "reaction:" with a support's place in the model, and columns of sections.
        """
        ends = {name: (self.peaks.extremes, at, at) for at, name in enumerate(self.names)}
        if "reaction" in self.fields:
            nodal = self.fields["reaction"]
            ends["reaction"] = nodal, int(nodal.largest.argmax()), int(nodal.smallest.argmin())
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
