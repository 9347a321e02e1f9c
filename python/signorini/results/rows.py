"""Results as rows of a table, also for pandas and xarray."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from signorini.base.on_demand import Named
from signorini.base.packages import package
from signorini.contact.certificate import FIGURES
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.model import Model
from signorini.results.catalogue import catalogue_of
from signorini.results.contact_field.area_contact import AreaContact, Pressures
from signorini.results.line_reactions import Line, lines_of
from signorini.results.quantities import ENDS, FIELDS, OF_AREAS, OF_LINES, PEAKING, Catalogue
from signorini.results.result import Result
from signorini.results.support_points import SupportPoints
from signorini.results.support_result import area_at_rest
from signorini.singularities.beside import Beside, beside_of
from signorini.singularities.named import singularities_of
from signorini.singularities.singularity import at_peaks

_MOVED = 1.0 + 1e-9
"""Smallest ratio of a travel to the travel at rest of a lifted point: more than rounding."""
_MOST_BEARINGS = 100
"""Largest number of points of a support that are bearings of their own; with more points the support is one bearing."""

Column = Sequence[str] | Floats | Ints
NamedColumns = Iterable[tuple[str, Column]]


@dataclass(frozen=True)
class Bearing:
    """Where a reaction acts: point ``point`` (from 1) of a support at points, or a support as a whole."""

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
    """

    classes: Ints  # (n,): class of each node; class 0 is never hidden
    always: Bools  # (c,): which classes are hidden whatever acts
    by_case: Mapping[str, Bools]  # which classes a load case hides, if any

    @classmethod
    def nothing(cls, count: int) -> Hidden:
        """Hide none of a number of nodes."""
        return cls(np.zeros(count, np.int64), np.zeros(1, np.bool_), {})

    @classmethod
    def of(cls, discretisation: Discretisation, number: str) -> Hidden:
        """Look for the nodes of the fields that singularities call so; none if it is empty."""
        if discretisation.plates:
            return cls.of_plates(discretisation, number)
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

    @classmethod
    def of_plates(cls, discretisation: Discretisation, number: str) -> Hidden:
        """The same of several plates, each with classes of its own."""
        each, plates = [cls.of(plate.own, number) for plate in discretisation.plates], discretisation.plates
        firsts = np.cumsum([0, *(len(one.always) for one in each)])
        count = discretisation.stress_nodes.count if number else discretisation.mesh.node_count
        classes = np.zeros(count, np.int64)
        for plate, one, first in zip(plates, each, firsts, strict=False):
            classes[plate.stress_nodes if number else plate.nodes] = first + one.classes
        by_case = {
            case: np.concatenate([one.by_case.get(case, np.zeros(len(one.always), np.bool_)) for one in each])
            for case in dict.fromkeys(case for one in each for case in one.by_case)
        }
        return cls(classes, np.concatenate([one.always for one in each]), by_case)

    def under(self, acting: Bools, cases: Sequence[str]) -> Bools:
        """Which classes (k, c) are hidden where load cases act (k, a); where no node would be left, none."""
        result = np.tile(self.always, (len(acting), 1))
        for column, case in enumerate(cases):
            if case in self.by_case:
                result |= acting[:, column, None] & self.by_case[case]
        present = np.bincount(self.classes, minlength=result.shape[1]) > 0
        return np.asarray(result & (~result & present).any(axis=1, keepdims=True))


@dataclass(frozen=True, eq=False)
class Layout:
    """Which numbers a model's rows have."""

    model: Model
    catalogue: Catalogue  # the numbers of every row
    supports: tuple[SupportPoints, ...]
    at_rest: Mapping[int, AreaContact]  # by the place of their support in the model
    lines: Mapping[int, Line]  # likewise
    fields: tuple[str, ...]  # those that envelopes are sought of
    probes: Floats  # (q, 2)
    probe_thickness: Floats  # (q,)
    nodes: Floats  # (s, 2): positions of the nodes of stresses; the first are those of the mesh
    hidden: Mapping[str, Hidden]  # of every field its nodes at which it has no limit
    beside: Beside  # the places at which moments or shears have none
    rest: Floats  # (p,): of every point of every support its travel in a plate at rest, infinite where it is apart

    @classmethod
    def of(cls, discretisation: Discretisation) -> Layout:
        """Lay out the rows of a model, with extremes of the fields that it asks for (``output.envelope``)."""
        asked: Sequence[str] = discretisation.model.output.envelope
        fields = tuple(name for name in FIELDS if name in asked)
        points = tuple(SupportPoints.of(discretisation, index) for index in range(len(discretisation.model.support)))
        areas = [index for index, support in enumerate(discretisation.model.support) if support.area is not None]
        # Areas of several plates are in the results of each plate.
        areas = [] if discretisation.plates else areas
        at_rest = {index: area_at_rest(discretisation, index) for index in areas}
        number_of = {name: FIELDS[name].singular if name in PEAKING else "" for name in fields}
        by_number = {number: Hidden.of(discretisation, number) for number in set(number_of.values())}
        hidden = {name: by_number[number] for name, number in number_of.items()}
        catalogue, nodes = catalogue_of(discretisation, fields).in_tables, discretisation.stress_nodes.points
        at = [at for probe in discretisation.model.probe for at in probe.at]
        probes = np.array(at).reshape(-1, 2), discretisation.probe_thickness
        lines, beside = lines_of(discretisation), beside_of(discretisation)
        rest_of_all = np.concatenate([np.zeros(0), *(one.rest(discretisation) for one in points)])
        return cls(
            *(discretisation.model, catalogue, points, at_rest, lines, fields),
            *(*probes, nodes, hidden, beside, rest_of_all),
        )

    @cached_property
    def on_lines(self) -> Mapping[int, slice]:
        """Which of all reactions per length, each line's concentrated forces behind them, are each line's."""
        ends = np.cumsum([0, *(len(line.s) + len(line.corners) for line in self.lines.values())]).tolist()
        return {index: slice(a, b) for index, (a, b) in zip(self.lines, pairwise(ends), strict=True)}

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
        """Nodes (k,) of the elements of elastic areas, whose deflections give pressures and contact areas."""
        elastic = [area for area in self.at_rest.values() if area.support.modulus is not None]
        nodes = [area.mesh.elements[area.covered > 0].ravel() for area in elastic]
        return np.unique(np.concatenate([np.zeros(0, np.int64), *nodes]))

    @cached_property
    def bearings(self) -> tuple[Bearing, ...]:
        """Points of supports at points, of which there are not too many, and all other supports."""
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
        """Numbers whose extremes are listed with all reactions: reactions, gaps, pressures and areas."""
        result = [("reaction", bearing) for bearing in self.bearings]
        opening = [one for one in self.bearings if one.point is not None and self.supports[one.support].rows.size]
        areas = [one for one in self.bearings if one.support in self.at_rest]
        result += [
            (one.name, bearing) for bearing in self.bearings if bearing.support in self.lines for one in OF_LINES
        ]
        result += [("gap", bearing) for bearing in opening]
        tabled = [one.name for one in OF_AREAS if one.tabled]
        return (*result, *((what, bearing) for bearing in areas for what in tabled))

    @cached_property
    def governed_places(self) -> Ints:
        """Which numbers of the catalogue these are (e,); the first are the bearings' reactions."""
        places = [self.catalogue.by_column[bearing.column(self.model, what)] for what, bearing in self.governed]
        return np.array(places, np.int64)

    @property
    def slices(self) -> list[slice]:
        """Which of all supports' points are each support's."""
        ends = np.cumsum([0, *(len(points.positions) for points in self.supports)]).tolist()
        return [slice(a, b) for a, b in pairwise(ends)]


@dataclass(frozen=True, eq=False)
class Block:
    """Consecutive results (k,); NaN and 0 where there is no equilibrium."""

    first: int  # number of the first of them
    solved: Bools  # (k,)
    method: list[str]
    not_unique: list[str]
    iterations: Ints  # (k,)
    certificate: Floats  # (k, 5): in the order of the certificate's figures
    values: Floats  # (k, n): in the order of the layout's catalogue
    reaction: Floats  # (k, p): of every point of every support
    closed: Bools  # (k, p)
    lifted: Bools  # (k, p): open where the plate touches at rest, and has moved away
    on_lines: Floats  # (k, l): reactions per length and concentrated forces of all lines
    on_areas: Floats  # (k, a): deflections of the nodes around elastic areas
    # (k, f, 4, 2): where the extremes of each enveloped field and of its means are, behind them those of each plate
    places: Floats

    @classmethod
    def empty(cls, layout: Layout, first: int, count: int) -> Block:
        """Make room for results that are still to come."""

        def nan(*shape: int) -> Floats:
            return np.full((count, *shape), np.nan)

        values = nan(len(layout.catalogue))
        values[:, layout.catalogue.at("support", "closed", "open")] = 0.0
        return cls(
            first,
            np.zeros(count, np.bool_),
            ["equilibrium check"] * count,
            [""] * count,
            np.zeros(count, np.int64),
            nan(len(FIGURES)),
            values,
            nan(layout.point_count),
            np.zeros((count, layout.point_count), np.bool_),
            np.zeros((count, layout.point_count), np.bool_),
            nan(max((where.stop for where in layout.on_lines.values()), default=0)),
            nan(len(layout.around_areas)),
            nan(len(layout.catalogue.at("field", "max")), len(ENDS), 2),
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
            self.closed[row, where] = support.closed
            self.lifted[row, where] = ~support.closed & (support.gaps > _MOVED * layout.rest[where])
        for index, where in layout.on_lines.items():
            if (line := result.supports[index].line) is not None:
                self.on_lines[row, where] = np.concatenate([line.reactions, line.corner_reactions])
        self.on_areas[row] = result.deflection[layout.around_areas]
        by_path = result.catalogue.by_path
        self.values[row] = result.numbers[[by_path[one.path] for one in layout.catalogue]]
        each = [one.extremes[name] for one in (result, *result.plates.values()) for name in layout.fields]
        for at, ends in enumerate(each):
            self.places[row, at] = [getattr(ends, f"{end}_at") for end in ENDS]

    def put_supports(
        self, rows: Ints, layout: Layout, reaction: Floats, gap: Floats, closed: Bools, bolts: Mapping[str, Floats]
    ) -> None:
        """Fill rows (r,) with values at all points (r, p); ``bolts`` are ``tightened_to`` and ``preload`` (p,)."""
        self.reaction[rows], self.closed[rows] = reaction, closed
        self.lifted[rows] = ~closed & (gap > _MOVED * layout.rest)
        at, values = layout.catalogue.at, self.values
        for column, where in zip(at("support", "reaction", "closed", "open"), layout.slices, strict=True):
            closed_count = closed[:, where].sum(axis=1)
            totals = (reaction[:, where].sum(axis=1), closed_count, closed[:, where].shape[1] - closed_count)
            values[np.ix_(rows, column)] = np.stack(totals, axis=1)
        for column in at("support", "preload"):
            values[rows, column] = bolts["preload"][layout.slices[layout.catalogue.numbers[column].owner]].sum()
        told = {name: np.broadcast_to(force, reaction.shape) for name, force in bolts.items()}
        told |= {"reaction": reaction, "gap": gap, "change": reaction - bolts["preload"]}
        for what, of_points in told.items():
            numbers = [layout.catalogue.numbers[place] for place in at("point", what)]
            every = [layout.slices[one.owner].start + one.part for one in numbers]
            values[np.ix_(rows, at("point", what))] = of_points[:, every]

    def put_lines(self, rows: Ints, layout: Layout, couples: Floats) -> None:
        """Fill rows (r,) with the reactions per length, given contributions of couples (r, v) at vertices of lines."""
        first = 0
        at = dict(zip(layout.lines, layout.catalogue.at("support", *(one.name for one in OF_LINES)), strict=True))
        for index, line in layout.lines.items():
            own = None if line.couples is None else couples[:, first : (first := first + line.couples.shape[0])]
            per_length, corners = line.read(self.reaction[rows, layout.slices[index]], own)
            self.on_lines[rows, layout.on_lines[index]] = np.concatenate([per_length, corners], axis=1)
            ends = per_length.max(axis=1), per_length.min(axis=1)
            self.values[np.ix_(rows, at[index])] = np.stack(ends, axis=1)

    def around(self, area: AreaContact, layout: Layout, rows: Ints) -> Floats:
        """Deflections (r, k) of the nodes on an area, in some rows; none of a rigid one."""
        if area.support.modulus is None:
            return np.zeros((len(rows), 0))
        own = np.searchsorted(layout.around_areas, np.flatnonzero(area.on_nodes))
        return self.on_areas[np.ix_(rows, own)]

    def columns(self, layout: Layout, keys: NamedColumns, loads: NamedColumns = ()) -> Iterator[tuple[str, Column]]:
        """Yield every column (k,) with its name.

        ``keys`` are the columns that identify the rows, ``loads`` those of the load.
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
    """Join the columns of consecutive blocks, texts as lists, numbers as arrays nobody writes into."""
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


def dataframe(table: Mapping[str, Column], key: str) -> Any:
    """Give a table as a `pandas.DataFrame`, its rows by one of its columns."""
    return package("pandas").DataFrame({name: np.asarray(values) for name, values in table.items()}).set_index(key)


def dataset(results: Mapping[str, Result]) -> Any:
    """Return fields and reactions of results on one mesh as an `xarray.Dataset`.

    Fields are by combination and stress node, with coordinates x and y; reactions by combination and support. Every
    variable has its description (``long_name``) and unit (``units``).
    """
    first = next(iter(results.values()))
    units, nodes = first.model.units, first.stress_nodes
    variables: dict[str, Any] = {}
    for name, quantity in FIELDS.items():
        values = np.stack([nodes.spread(one.fields[name]) for one in results.values()])
        variables[name] = (
            ("combination", "node"),
            values,
            {"long_name": quantity.words, "units": quantity.unit(units)},
        )
    places = {axis: ("node", at, {"units": units.length}) for axis, at in zip("xy", nodes.points.T, strict=True)}
    names = [support.name for support in first.model.support]
    nothing = [np.nan] * len(names)
    reactions = [[support.reaction for support in one.supports] or nothing for one in results.values()]
    what = {"long_name": "reaction, positive up", "units": units.force}
    variables["reaction"] = (("combination", "support"), np.array(reactions).reshape(len(results), -1), what)
    coordinates = {"combination": list(results), "support": names, **places}
    return package("xarray").Dataset(variables, coordinates, {"title": first.model.title})
