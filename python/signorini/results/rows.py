"""Results of many combinations as rows of a table, computed in blocks of consecutive rows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from signorini.base.on_demand import Named
from signorini.contact.certificate import FIGURES
from signorini.discretise import Discretisation
from signorini.discretise.discretisation import OfWhole
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.model import Model
from signorini.results.catalogue import catalogue_of
from signorini.results.checks import checked_fields
from signorini.results.contact_field.area_contact import AreaContact, Pressures
from signorini.results.contact_field.areas import area_at_rest
from signorini.results.line_reactions import Line, lines_of
from signorini.results.quantities import (
    DESIGN_MOMENTS,
    ENDS,
    FIELDS,
    OF_AREAS,
    OF_LINES,
    PEAKING,
    REINFORCEMENT,
    SIDES,
    Catalogue,
    Home,
)
from signorini.results.readings import Readings, nodes_around
from signorini.results.state import ResultState
from signorini.results.support_points import SupportPoints
from signorini.singularities.beside import Beside, beside_of
from signorini.singularities.named import singularities_of
from signorini.singularities.singularity import at_peaks

_MOVED = 1.0 + 1e-9
"""Smallest ratio of a point's free travel to that at w = 0 at which it counts as lifted off; less is rounding."""
_MOST_BEARINGS = 100
"""Largest number of points of a support whose reactions are listed point by point; of more points, only their sum."""

Column = Sequence[str] | Floats | Ints
NamedColumns = Iterable[tuple[str, Column]]


@dataclass(frozen=True)
class Bearing:
    """A point of a support, by its number ``point`` from 1, or a whole support (None), whose reaction is listed."""

    support: int
    point: int | None
    at: tuple[float, float] | None

    def column(self, model: Model, what: str = "reaction") -> str:
        """Name of the table's column with one of the bearing's quantities, by default its reaction."""
        name = model.support[self.support].name
        return f"{what}:{name}" if self.point is None else f"{what}_at:{name}[{self.point}]"


@dataclass(frozen=True, eq=False)
class Hidden:
    """Nodes, of n, that are excluded from the extremes of a field, depending on the acting load cases.

    A node is excluded if the field is singular there under an acting load case, or if the node never counts
    (`StressNodes.counting`). Nodes that the same load cases exclude form a class.
    """

    classes: Ints  # (n,): number of the class of each node; class 0 is never excluded
    always: Bools  # (c,): whether each class is excluded under all loads
    by_case: Mapping[
        str, Bools
    ]  # for each load case: mask (c,) of the classes of nodes at which fields are singular under it

    @classmethod
    def nothing(cls, count: int) -> Hidden:
        """`Hidden` in which none of ``count`` nodes is excluded."""
        return cls(np.zeros(count, np.int64), np.zeros(1, np.bool_), {})

    @classmethod
    def of(cls, discretisation: Discretisation, number: str) -> Hidden:
        """Find the nodes at which "moment" or another ``number`` of `Singularity.numbers` is singular.

        If ``number`` is empty, only nodes that never count are excluded.
        """
        places: dict[str | None, Ints] = {}
        for case in (None, *discretisation.cases) if number else ():
            at = np.flatnonzero(at_peaks(discretisation.mesh, singularities_of(discretisation, case), number))
            places |= {case: at} if len(at) else {}
        of_mesh = discretisation.stress_nodes.nodes if number else np.arange(discretisation.mesh.node_count)
        left_out = ~discretisation.stress_nodes.counting(len(of_mesh))
        if not places:
            return cls(left_out.astype(np.int64), np.array([False, True]), {})
        nodes = np.unique(np.concatenate(list(places.values())))
        by = np.array([np.isin(nodes, at) for at in places.values()], np.bool_)
        alike, which = np.unique(by, axis=1, return_inverse=True)
        classes = np.zeros(discretisation.mesh.node_count, np.int64)
        classes[nodes] = 1 + which.ravel()
        hides = {case: np.concatenate([[False], row, [False]]) for case, row in zip(places, alike, strict=True)}
        always = hides.pop(None, np.zeros(2 + alike.shape[1], np.bool_))
        always[-1] = True
        by_case = {case: row for case, row in hides.items() if case is not None}
        return cls(np.where(left_out, len(always) - 1, classes[of_mesh]), always, by_case)

    def under(self, acting: Bools, cases: Sequence[str]) -> Bools:
        """Mask (k, c) of the classes that are excluded in k rows, given the mask (k, a) of load cases that act.

        No class is excluded in a row that would exclude all nodes.
        """
        result = np.tile(self.always, (len(acting), 1))
        for column, case in enumerate(cases):
            if case in self.by_case:
                result |= acting[:, column, None] & self.by_case[case]
        present = np.bincount(self.classes, minlength=result.shape[1]) > 0
        return np.asarray(result & (~result & present).any(axis=1, keepdims=True))


@dataclass(frozen=True, eq=False)
class PlateLayout:
    """The numbers of one plate in a table's rows, and the nodes excluded from its extremes."""

    plate: OfWhole
    catalogue: Catalogue  # names and units of this plate's numbers
    hidden: Mapping[str, Hidden]  # for each field, the nodes that are excluded from its extremes

    @classmethod
    def of(cls, plate: OfWhole, fields: tuple[str, ...]) -> PlateLayout:
        """Layout of one plate; ``fields`` are the fields whose extremes are in the rows."""
        number_of = {name: FIELDS[name].singular if name in PEAKING else "" for name in fields}
        by_number = {number: Hidden.of(plate.own, number) for number in set(number_of.values())}
        hidden = {name: by_number[number] for name, number in number_of.items()}
        return cls(plate, catalogue_of(plate.own, fields, "tables"), hidden)

    @property
    def beside(self) -> Beside:
        """Points of this plate at which moments or shears are singular."""
        return beside_of(self.plate.own)

    def nodes_of(self, field: str) -> slice | Ints:
        """Slice or indices of the plate's nodes (or stress nodes) of a field, among those of all plates."""
        return self.plate.stress_nodes if field in PEAKING else self.plate.nodes


@dataclass(frozen=True, eq=False, kw_only=True)
class Layout:
    """The columns of a model's table, and the data that do not change from row to row."""

    model: Model
    catalogue: Catalogue  # names and units of the numbers of a row
    supports: tuple[SupportPoints, ...]
    at_rest: Mapping[int, AreaContact]  # contact of areas without load, by index of the support in the model
    lines: Mapping[int, Line]  # lines of supports, by index of the support in the model
    fields: tuple[str, ...]  # names of the fields with envelopes
    probes: Floats  # (q, 2): positions of probes
    nodes: Floats  # (s, 2): positions of stress nodes; the mesh's nodes are the first
    members: tuple[PlateLayout, ...]
    # (p,): travel of every point of every support at w = 0; infinite if the point does not touch the plate
    rest: Floats

    @classmethod
    def of(cls, discretisation: Discretisation) -> Layout:
        """Lay out the rows of a model: which numbers they have.

        Rows have extremes of checked fields and of the fields in ``output.envelope``; if this key is not given, also of
        design moments and required areas.
        """
        model, output = discretisation.model, discretisation.model.output
        designed = model.bars and "envelope" not in output.model_fields_set
        by_default = (*DESIGN_MOMENTS, *REINFORCEMENT) if designed else ()
        fields = tuple(name for name in FIELDS if name in (*output.envelope, *by_default, *checked_fields(model)))
        points = tuple(SupportPoints.of(discretisation, index) for index in range(len(discretisation.model.support)))
        areas = [index for index, support in enumerate(discretisation.model.support) if support.area is not None]
        # With several plates, contact areas are computed from the results of each plate.
        areas = [] if discretisation.plates else areas
        at_rest = {index: area_at_rest(discretisation, index) for index in areas}
        members = tuple(PlateLayout.of(plate, fields) for plate in discretisation.members)
        catalogue, nodes = catalogue_of(discretisation, fields, "tables"), discretisation.stress_nodes.points
        probes = np.array([at for probe in discretisation.model.probe for at in probe.at]).reshape(-1, 2)
        rest_of_all = np.concatenate([np.zeros(0), *(one.rest(discretisation) for one in points)])
        return cls(
            model=discretisation.model,
            catalogue=catalogue,
            supports=points,
            at_rest=at_rest,
            lines=lines_of(discretisation),
            fields=fields,
            probes=probes,
            nodes=nodes,
            members=members,
            rest=rest_of_all,
        )

    @cached_property
    def on_lines(self) -> Mapping[int, slice]:
        """For each line, the slice of its reactions per length and concentrated forces in `Block.on_lines`."""
        ends = np.cumsum([0, *(len(line.s) + len(line.corners) for line in self.lines.values())]).tolist()
        return {index: slice(a, b) for index, (a, b) in zip(self.lines, pairwise(ends), strict=True)}

    @property
    def point_count(self) -> int:
        """Number of points of all supports."""
        return sum(len(points.positions) for points in self.supports)

    @cached_property
    def pressures(self) -> Pressures:
        """Pressures of all area supports of the model."""
        return Pressures(list(self.at_rest.values()))

    @cached_property
    def around_areas(self) -> Ints:
        """Nodes (k,) of the elements on elastic areas; their deflections determine pressures and contact areas."""
        return nodes_around(self.at_rest.values())

    @cached_property
    def bearings(self) -> tuple[Bearing, ...]:
        """Owners of listed reactions: each point of supports at points with few points; other supports as a whole."""
        result = []
        for index, (support, points) in enumerate(zip(self.model.support, self.supports, strict=True)):
            if support.place == "at" and 0 < len(points.positions) <= _MOST_BEARINGS:
                places = points.positions.tolist()
                result += [Bearing(index, number, (x, y)) for number, (x, y) in enumerate(places, start=1)]
            else:
                result.append(Bearing(index, None, None))
        return tuple(result)

    @cached_property
    def governed(self) -> tuple[tuple[str, Bearing], ...]:
        """Pairs (quantity, bearing) whose extremes are listed with the simultaneous reactions of all bearings."""
        result = [("reaction", bearing) for bearing in self.bearings]
        opening = [one for one in self.bearings if one.point is not None and self.supports[one.support].rows.size]
        areas = [one for one in self.bearings if self.model.support[one.support].area is not None]
        result += [
            (one.name, bearing) for bearing in self.bearings if bearing.support in self.lines for one in OF_LINES
        ]
        result += [("gap", bearing) for bearing in opening]
        tabled = [one.name for one in OF_AREAS if one.tabled]
        return (*result, *((what, bearing) for bearing in areas for what in tabled))

    @cached_property
    def governed_places(self) -> Ints:
        """Indices (e,) in the catalogue of the numbers ``governed``; reactions of the bearings are first."""
        places = [self.catalogue.by_column[bearing.column(self.model, what)] for what, bearing in self.governed]
        return np.array(places, np.int64)

    @property
    def slices(self) -> list[slice]:
        """For each support, the slice of its points among the points of all supports."""
        ends = np.cumsum([0, *(len(points.positions) for points in self.supports)]).tolist()
        return [slice(a, b) for a, b in pairwise(ends)]


@dataclass(frozen=True, eq=False, kw_only=True)
class Block:
    """A block of k consecutive rows of a table; numbers are NaN, and counts 0, in rows without equilibrium."""

    first: int  # number of the block's first row in the table, from 0
    solved: Bools  # (k,): whether there is an equilibrium
    method: list[str]
    not_unique: list[str]
    iterations: Ints  # (k,): Lemke pivots or Newton steps
    certificate: Floats  # (k, 5): errors of the certificate in the order of `FIGURES`
    values: Floats  # (k, n): numbers of each row in the order of the layout's catalogue
    reaction: Floats  # (k, p): reactions of every point of every support
    closed: Bools  # (k, p): whether each point is closed
    # (k, p): whether the plate has lifted off each point, which is without gap at w = 0 but open in this row
    lifted: Bools
    on_lines: Floats  # (k, l): reactions per length and concentrated forces of all lines
    on_areas: Floats  # (k, a): deflections of the nodes around elastic areas
    # (k, f, 4, 2): positions of max, min, max_mean and min_mean of each field; with several plates also by plate
    places: Floats

    @classmethod
    def empty(cls, layout: Layout, first: int, count: int) -> Block:
        """Block of ``count`` rows without numbers; its first row has the number ``first``."""

        def nan(*shape: int) -> Floats:
            return np.full((count, *shape), np.nan)

        values = nan(len(layout.catalogue))
        values[:, layout.catalogue.at("support", "closed", "open")] = 0.0
        return cls(
            first=first,
            solved=np.zeros(count, np.bool_),
            method=["equilibrium check"] * count,
            not_unique=[""] * count,
            iterations=np.zeros(count, np.int64),
            certificate=nan(len(FIGURES)),
            values=values,
            reaction=nan(layout.point_count),
            closed=np.zeros((count, layout.point_count), np.bool_),
            lifted=np.zeros((count, layout.point_count), np.bool_),
            on_lines=nan(max((where.stop for where in layout.on_lines.values()), default=0)),
            on_areas=nan(len(layout.around_areas)),
            places=nan(len(layout.catalogue.at("field", "max")), len(ENDS), 2),
        )

    @property
    def numbers(self) -> Ints:
        """Numbers (k,) of the block's rows among all rows."""
        return self.first + np.arange(len(self.solved))

    def put(self, row: int, layout: Layout, result: ResultState) -> None:
        """Fill a row of the block from the complete result of a combination."""
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
            self.closed[row, where] = support.closed
            self.lifted[row, where] = ~support.closed & (support.gaps > _MOVED * layout.rest[where])
        for index, where in layout.on_lines.items():
            if (line := result.supports[index].line) is not None:
                self.on_lines[row, where] = np.concatenate([line.reactions, line.corner_reactions])
        self.on_areas[row] = result.deflection[layout.around_areas]
        by_path = result.catalogue.by_path
        self.values[row] = result.numbers[[by_path[one.path] for one in layout.catalogue]]
        every: list[ResultState] = [result, *result.plates.values()]
        each = [one.extremes[name] for one in every for name in layout.fields]
        for at, ends in enumerate(each):
            self.places[row, at] = [getattr(ends, f"{end}_at") for end in ENDS]

    def put_supports(self, rows: Ints, layout: Layout, member: PlateLayout, readings: Readings) -> None:
        """Fill the support columns of rows (r,) for one plate.

        ``readings`` are those of the r combinations, superposed from load cases and contact points.
        """
        if layout.at_rest:
            self.on_areas[rows] = readings.linear.on_areas
        for index, of in zip(member.plate.numbers["support"], readings.supports, strict=True):
            if of.index in member.plate.upon:
                continue
            where = layout.slices[index]
            self.reaction[rows, where], self.closed[rows, where] = of.reactions, of.closed
            self.lifted[rows, where] = ~of.closed & (of.gaps > _MOVED * layout.rest[where])
            if index in layout.on_lines:
                self.on_lines[rows, layout.on_lines[index]] = np.concatenate(of.per_length, axis=1)

    def put_numbers(self, rows: Ints, layout: Layout, each: Sequence[Floats], places: Sequence[Floats]) -> None:
        """Fill rows (r,) with the numbers (r, n) of every plate and positions (r, f, 4, 2) of the fields' extremes."""
        self.values[rows] = layout.catalogue.of_members(each)
        count = len(layout.fields)
        if len(each) == 1:
            self.places[rows] = places[0]
            return
        for plate, of_plate in enumerate(places, start=1):
            self.places[rows, plate * count : (plate + 1) * count] = of_plate
        first, every = layout.members[0].catalogue, np.stack(places)
        for end, name in enumerate(ENDS):
            home: Home = "field" if name in SIDES else "mean"
            fields = [first.numbers[place].owner for place in first.at(home, name)]
            sign = 1.0 if name.startswith("max") else -1.0
            signed = [
                sign * own[:, one.catalogue.at(home, name)] for own, one in zip(each, layout.members, strict=True)
            ]
            which = np.nan_to_num(np.stack(signed), nan=-np.inf).argmax(axis=0)
            chosen = np.take_along_axis(every[:, :, fields, end], which[None, ..., None], axis=0)[0]
            self.places[rows[:, None], fields, end] = chosen

    def around(self, area: AreaContact, layout: Layout, rows: Ints) -> Floats:
        """Deflections (r, k) in rows (r,) of the nodes on an area; k = 0 for a rigid area."""
        if not area.support.is_elastic:
            return np.zeros((len(rows), 0))
        own = np.searchsorted(layout.around_areas, np.flatnonzero(area.on_nodes))
        return self.on_areas[np.ix_(rows, own)]

    def columns(self, layout: Layout, keys: NamedColumns, loads: NamedColumns = ()) -> Iterator[tuple[str, Column]]:
        """Yield the name and the values (k,) of every column of the table.

        ``keys`` are the first columns, which identify the rows; ``loads`` are the columns that describe their loads.
        """
        yield from keys
        yield "status", ["solved" if solved else "no_equilibrium" for solved in self.solved]
        yield "method", self.method
        yield "iterations", self.iterations
        yield "not_unique", self.not_unique
        yield from loads
        for one, values in zip(layout.catalogue, self.values.T, strict=True):
            yield one.column, values.astype(np.int64) if one.quantity.kind == "count" else values
            if one.home in ("field", "mean"):
                for axis, letter in enumerate("xy"):
                    yield f"{one.what}_{letter}:{one.subject}", self.places[:, one.owner, ENDS.index(one.what), axis]
        for index, name in enumerate(FIGURES):
            yield f"certificate:{name}", self.certificate[:, index]


def together(blocks: Iterable[NamedColumns]) -> Mapping[str, Column]:
    """Join the columns of consecutive blocks; columns of texts become tuples, those of numbers read-only arrays."""
    result: dict[str, list[Column]] = {}
    for block in blocks:
        for name, values in block:
            result.setdefault(name, []).append(values)
    return Named({name: _joined(parts) for name, parts in result.items()}, "column", "This table")


def _joined(parts: Sequence[Column]) -> Column:
    if not isinstance(parts[0], np.ndarray):
        return tuple(text for part in parts for text in part)
    whole = np.concatenate(parts)
    whole.flags.writeable = False
    return whole
