"""Results as rows of a table: what is written of each, whoever solved it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from signorini.base.named import Named
from signorini.contact.certificate import FIGURES
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.model import Model
from signorini.results.contact_field import AreaContact, Pressures
from signorini.results.extremes import NUMBERS
from signorini.results.result import FIELDS, Result
from signorini.results.section_result import COMPONENTS, columns_of, numbers_of
from signorini.results.support_points import SupportPoints
from signorini.results.support_result import area_at_rest
from signorini.singularities.named import singularities_of
from signorini.singularities.singularity import at_peaks

_MOST_BEARINGS = 100
"""Points of one support beyond which its reaction is looked at as a whole."""
_OF_AREAS = ("max_pressure", "contact_area")

Column = Sequence[str] | Floats | Ints
NamedColumns = Iterable[tuple[str, Column]]


@dataclass(frozen=True)
class Bearing:
    """What one reaction is of: point ``point`` (from 1) of a support at points, or a support as a whole."""

    support: int
    point: int | None
    at: tuple[float, float] | None

    def column(self, model: Model, what: str = "reaction") -> str:
        """The table's column of its reaction, or of something else that it has."""
        name = model.support[self.support].name
        return f"{what}:{name}" if self.point is None else f"{what}_at:{name}[{self.point}]"


@dataclass(frozen=True, eq=False)
class Hidden:
    """Nodes (n,) of a field that count in no extreme, by class: alike are those that the same load cases hide.

    A field has no limit there, or they are left out whatever acts.

    Parameters
    ----------
    classes : (n,) array
        0 of those that nothing hides.
    always : (c,) array
        Which classes are hidden whatever acts.
    by_case : dict of (c,) arrays
        Which classes a load case hides, if any.
    """

    classes: Ints
    always: Bools
    by_case: Mapping[str, Bools]

    @classmethod
    def nothing(cls, count: int) -> Hidden:
        """No node of so many."""
        return cls(np.zeros(count, np.int64), np.zeros(1, np.bool_), {})

    @classmethod
    def of(cls, found: Discretisation, number: str) -> Hidden:
        """Look for the nodes of the fields that singularities call so; none if it is empty."""
        places: dict[str | None, Ints] = {}
        for case in (None, *found.cases) if number else ():
            at = np.flatnonzero(at_peaks(found.mesh, singularities_of(found, case), number))
            places |= {case: at} if len(at) else {}
        of_mesh = found.stress_nodes.nodes if number else np.arange(found.mesh.node_count)
        left_out = ~found.stress_nodes.counting(len(of_mesh))
        if not places:
            return cls(left_out.astype(np.int64), np.array([False, True]), {})
        nodes = np.unique(np.concatenate(list(places.values())))
        by = np.array([np.isin(nodes, at) for at in places.values()], np.bool_)
        alike, which = np.unique(by, axis=1, return_inverse=True)
        classes = np.zeros(found.mesh.node_count, np.int64)
        classes[nodes] = 1 + which.ravel()
        hides = {case: np.concatenate([[False], row, [False]]) for case, row in zip(places, alike, strict=True)}
        always = hides.pop(None, np.zeros(2 + alike.shape[1], np.bool_))
        always[-1] = True
        by_case = {case: row for case, row in hides.items() if case is not None}
        return cls(np.where(left_out, len(always) - 1, classes[of_mesh]), always, by_case)

    def under(self, acting: Bools, cases: Sequence[str]) -> Bools:
        """Which classes (k, c) are hidden where load cases act (k, a); where no node would be left, none."""
        found = np.tile(self.always, (len(acting), 1))
        for column, case in enumerate(cases):
            if case in self.by_case:
                found |= acting[:, column, None] & self.by_case[case]
        present = np.bincount(self.classes, minlength=found.shape[1]) > 0
        return np.asarray(found & (~found & present).any(axis=1, keepdims=True))


@dataclass(frozen=True, eq=False)
class Layout:
    """Which columns a model's results have."""

    model: Model
    supports: tuple[SupportPoints, ...]
    at_rest: Mapping[int, AreaContact]
    fields: tuple[str, ...]
    probes: Floats
    nodes: Floats
    """Positions (s, 2) of the nodes of stresses; the first are those of the mesh."""
    hidden: Mapping[str, Hidden]
    """Of every field its nodes at which it has no limit."""

    @classmethod
    def of(cls, found: Discretisation, fields: Sequence[str]) -> Layout:
        """Lay out the columns of a model; ``fields`` are those that envelopes are sought of."""
        points = tuple(SupportPoints.of(found, index) for index in range(len(found.model.support)))
        areas = [index for index, support in enumerate(found.model.support) if support.area is not None]
        at_rest = {index: area_at_rest(found, index) for index in areas}
        by_number = {number: Hidden.of(found, number) for number in {NUMBERS.get(name, "") for name in fields}}
        hidden = {name: by_number[NUMBERS.get(name, "")] for name in fields}
        nodes = found.stress_nodes.points
        return cls(found.model, points, at_rest, tuple(fields), found.probe_positions, nodes, hidden)

    @cached_property
    def through(self) -> list[str]:
        """Columns (3s,) of sections and strips."""
        return columns_of(self.model)

    @property
    def through_kinds(self) -> list[str]:
        """What these columns (3s,) are compared with: moments, twisting or not, or shears, of sections or of strips."""
        of_line = ["moment" if what == "twist" else what for what in COMPONENTS]
        of_strips = [f"{what} of strips" for what in of_line]
        return of_line * len(self.model.section) + of_strips * (
            len(self.through) // len(of_line) - len(self.model.section)
        )

    @property
    def point_count(self) -> int:
        """Number of points of all supports."""
        return sum(len(points.positions) for points in self.supports)

    @cached_property
    def pressures(self) -> Pressures:
        """Pressures of all areas together."""
        return Pressures(list(self.at_rest.values()))

    @cached_property
    def around_areas(self) -> Ints:
        """Nodes (k,) of the elements that elastic areas are in; what these do follows from the deflections there."""
        elastic = [area for area in self.at_rest.values() if area.support.stiffness is not None]
        nodes = [area.mesh.elements[area.covered > 0].ravel() for area in elastic]
        return np.unique(np.concatenate([np.zeros(0, np.int64), *nodes]))

    @cached_property
    def bearings(self) -> tuple[Bearing, ...]:
        """Points of supports at points, of which there are not too many, and all other supports."""
        found = []
        for index, (support, points) in enumerate(zip(self.model.support, self.supports, strict=True)):
            if support.place == "at" and 0 < len(points.positions) <= _MOST_BEARINGS:
                places = points.positions.tolist()
                found += [Bearing(index, number, (x, y)) for number, (x, y) in enumerate(places, start=1)]
            else:
                found.append(Bearing(index, None, None))
        return tuple(found)

    @cached_property
    def governed(self) -> tuple[tuple[str, Bearing], ...]:
        """Of which numbers extremes are sought with what all bearings do then: first their reactions.

        Then gaps of points that may open and, of areas, the largest pressure and how much is in contact.
        """
        found = [("reaction", bearing) for bearing in self.bearings]
        opening = [one for one in self.bearings if one.point is not None and self.supports[one.support].rows.size]
        areas = [one for one in self.bearings if one.support in self.at_rest]
        found += [("gap", bearing) for bearing in opening]
        return (*found, *((what, bearing) for bearing in areas for what in _OF_AREAS))

    def of_governed(self, reaction: Floats, gap: Floats, areas: Floats) -> Floats:
        """Numbers (k, e) of ``governed``, from reactions and gaps of all points (k, p) and of areas (k, a, 2)."""
        found, slices = np.empty((len(reaction), len(self.governed))), self.slices
        for column, (what, bearing) in enumerate(self.governed):
            where = slices[bearing.support]
            if what in _OF_AREAS:
                found[:, column] = areas[:, list(self.at_rest).index(bearing.support), _OF_AREAS.index(what)]
            elif bearing.point is None:
                found[:, column] = reaction[:, where].sum(axis=1)
            else:
                found[:, column] = (gap if what == "gap" else reaction)[:, where][:, bearing.point - 1]
        return found

    @property
    def slices(self) -> list[slice]:
        """Which of all supports' points are each support's."""
        ends = np.cumsum([0, *(len(points.positions) for points in self.supports)]).tolist()
        return [slice(a, b) for a, b in pairwise(ends)]


@dataclass(frozen=True, eq=False)
class Block:
    """Consecutive results (k,); NaN and 0 where there is no equilibrium.

    Parameters
    ----------
    first : int
        Number of the first of them.
    solved : (k,) array
    method, not_unique : lists of str
    iterations : (k,) array
    certificate : (k, 5) array
        In the order of the certificate's figures.
    reaction, gap, closed : (k, p) arrays
        Of every point of every support.
    probes : (k, 8q) array
        Every field at every probe.
    through : (k, 3s) array
        Moment, twist and shear of every section, and their means at every station of a strip.
    on_areas : (k, n) array
        Deflections of the nodes around elastic areas.
    areas : (k, a, 2) array
        Of every area its largest pressure, and how much of it is in contact.
    peaks : (k, f, 2) array
        Largest and smallest value of each enveloped field, away from where it has no limit.
    places : (k, f, 2, 2) array
        Where these are.
    """

    first: int
    solved: Bools
    method: list[str]
    not_unique: list[str]
    iterations: Ints
    certificate: Floats
    reaction: Floats
    gap: Floats
    closed: Bools
    probes: Floats
    through: Floats
    on_areas: Floats
    areas: Floats
    peaks: Floats
    places: Floats

    @classmethod
    def empty(cls, layout: Layout, first: int, count: int) -> Block:
        """Make room for results that are still to come."""
        points, fields = layout.point_count, len(layout.fields)

        def nan(*shape: int) -> Floats:
            return np.full((count, *shape), np.nan)

        return cls(
            first,
            np.zeros(count, np.bool_),
            ["equilibrium check"] * count,
            [""] * count,
            np.zeros(count, np.int64),
            nan(len(FIGURES)),
            nan(points),
            nan(points),
            np.zeros((count, points), np.bool_),
            nan(len(FIELDS) * len(layout.probes)),
            nan(len(layout.through)),
            nan(len(layout.around_areas)),
            nan(len(layout.at_rest), 2),
            nan(fields, 2),
            nan(fields, 2, 2),
        )

    @property
    def numbers(self) -> Ints:
        """Numbers (k,) of these among all."""
        return self.first + np.arange(len(self.solved))

    def put(self, row: int, layout: Layout, result: Result) -> None:
        """Fill a row with a result that has every field."""
        self.solved[row] = result.status == "solved"
        self.method[row] = result.method
        self.iterations[row] = result.iterations
        self.not_unique[row] = ", ".join(dict.fromkeys(one.what for one in result.not_unique))
        if not self.solved[row]:
            return
        figures = asdict(result.certificate)
        self.certificate[row] = [figures[name] for name in FIGURES]
        for where, support in zip(layout.slices, result.supports, strict=True):
            self.reaction[row, where] = support.reactions
            self.gap[row, where] = support.gaps
            self.closed[row, where] = support.closed
        self.on_areas[row] = result.deflection[layout.around_areas]
        for at, index in enumerate(layout.at_rest):
            area = result.supports[index].area
            assert area is not None  # the support is one
            self.areas[row, at] = area.max_pressure, area.contact_area
        values = [(p.deflection, *p.rotation, *p.moment, *p.shear) for p in result.probes]
        self.probes[row] = np.array(values).ravel()
        self.through[row] = numbers_of(result.sections, result.strips)
        for at, name in enumerate(layout.fields):
            ends = result.extremes[name]
            self.peaks[row, at], self.places[row, at] = (ends.max, ends.min), (ends.max_at, ends.min_at)

    def around(self, area: AreaContact, layout: Layout, rows: Ints) -> Floats:
        """Deflections (r, k) of the nodes on an area, in some rows; none of a rigid one."""
        if area.support.stiffness is None:
            return np.zeros((len(rows), 0))
        own = np.searchsorted(layout.around_areas, np.flatnonzero(area.on_nodes))
        return self.on_areas[np.ix_(rows, own)]

    def columns(self, layout: Layout, keys: NamedColumns, loads: NamedColumns = ()) -> Iterator[tuple[str, Column]]:
        """Yield every column (k,) with its name.

        ``keys`` are the columns that tell the rows apart, ``loads`` those that say what is on the plate.
        """
        yield from keys
        yield "status", ["solved" if solved else "no_equilibrium" for solved in self.solved]
        yield "method", self.method
        yield "iterations", self.iterations
        yield "not_unique", self.not_unique
        yield from loads
        area = 0
        for where, support, points in zip(layout.slices, layout.model.support, layout.supports, strict=True):
            reaction, closed = self.reaction[:, where], self.closed[:, where]
            yield f"reaction:{support.name}", reaction.sum(axis=1)
            yield f"closed:{support.name}", np.where(self.solved, closed.sum(axis=1), 0)
            yield f"open:{support.name}", np.where(self.solved, (~closed).sum(axis=1), 0)
            if support.area is not None:
                yield f"max_pressure:{support.name}", self.areas[:, area, 0]
                yield f"contact_area:{support.name}", self.areas[:, area, 1]
                area += 1
            if support.place == "at":
                for number in range(len(points.positions)):
                    yield f"reaction_at:{support.name}[{number + 1}]", reaction[:, number]
                for number in range(len(points.positions) if points.rows.size else 0):
                    yield f"gap_at:{support.name}[{number + 1}]", self.gap[:, where][:, number]
        for index in range(self.probes.shape[1]):
            probe, field = divmod(index, len(FIELDS))
            yield f"probe[{probe + 1}]:{FIELDS[field]}", self.probes[:, index]
        yield from zip(layout.through, self.through.T, strict=True)
        for at, name in enumerate(layout.fields):
            for side, what in enumerate(("max", "min")):
                yield f"{what}:{name}", self.peaks[:, at, side]
                yield f"{what}_x:{name}", self.places[:, at, side, 0]
                yield f"{what}_y:{name}", self.places[:, at, side, 1]
        for index, name in enumerate(FIGURES):
            yield f"certificate:{name}", self.certificate[:, index]


def together(blocks: Iterable[NamedColumns]) -> Mapping[str, Column]:
    """Join the columns of consecutive blocks, texts as lists, numbers as arrays nobody writes into."""
    found: dict[str, list[Column]] = {}
    for block in blocks:
        for name, values in block:
            found.setdefault(name, []).append(values)
    return Named({name: _joined(parts) for name, parts in found.items()}, "column", "This table")


def _joined(parts: Sequence[Column]) -> Column:
    if not isinstance(parts[0], np.ndarray):
        return tuple(text for part in parts for text in part)
    whole = np.concatenate(parts)
    whole.flags.writeable = False
    return whole
