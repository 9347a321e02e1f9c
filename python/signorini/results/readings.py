"""Readings of solutions, and the numbers of results that are computed from readings.

A reading is a quantity that is linear in the solution in one contact state. A result is computed from the readings of
its answer, a load path from the readings of several answers. The readings of a row of a table are superposed from those
of load cases and contact points.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple, Self

import numpy as np

from signorini import _core
from signorini.base.on_demand import kept
from signorini.contact.selection import Answer
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.discretisation import OfWhole
from signorini.discretise.laws import SupportLaw
from signorini.discretise.punching import PunchedColumn
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.equilibrium.balance import NO_FORCE
from signorini.model import Support
from signorini.results.contact_field.area_contact import AreaContact
from signorini.results.contact_field.areas import area_at_rest, area_contact
from signorini.results.contact_field.kern import kern_of
from signorini.results.line_reactions import Line, lines_of
from signorini.results.local_results import designed, total_pressure
from signorini.results.punching import in_units, points_inside
from signorini.results.quantities import EXTREMES, LINEAR, OF_BARS, OF_COLUMNS, Catalogue, Home, derived
from signorini.results.support_points import SupportPoints, closed_part
from signorini.singularities.beside import at_faces, faces_of

_TOGETHER = 500_000
"""Largest number of nodal deflections in memory at once (4 MB) while contact areas are computed."""


class SupportForces(NamedTuple):
    """Forces in one solution: residual F − Ku (3n,), forces of held dofs (3n,), upward forces of springs (s,).

    F are the loads and the reactions of contact points.
    """

    imbalance: Floats
    held: Floats
    springs: Floats

    @classmethod
    def of(
        cls,
        discretisation: Discretisation,
        nodal: Floats,
        hi: Floats,
        lo: Floats,
        spread: Floats,
        springs: tuple[Ints, Floats, Ints, Floats, Floats] | None = None,
        imbalance: Floats | None = None,
    ) -> Self:
        """Compute the forces at u = hi + lo (3n,) under nodal loads (3n,) and reactions on nodes ``spread`` (3n,).

        ``springs``, unless None, replace the model's springs. ``imbalance`` is the residual without ``spread``, if
        known.
        """
        arrays = discretisation.springs.arrays if springs is None else springs
        residual = discretisation.plate.residual(arrays, nodal, hi, lo) if imbalance is None else imbalance
        residual = residual - spread
        held = np.where(discretisation.held.dofs, residual, 0.0)
        return cls(residual, held, discretisation.spring_forces(hi, lo, arrays[4]))

    def on(self, plate: OfWhole) -> SupportForces:
        """Forces on the nodes and springs of ``plate``, one of several plates."""
        return SupportForces(self.imbalance[plate.dofs], self.held[plate.dofs], self.springs[plate.springs])


class Linear(NamedTuple):
    """Readings of k solutions; the first axis of each array numbers the solutions."""

    probes: Floats
    """(k, q', 8): fields at probes, once for each side of a jump at a probe; last axis in the order of `LINEAR`."""
    of_bars: Floats
    """(k, q', 3): moments for the design of bars at probes; q' = 0 if no `Reinforcement.face` changes them."""
    through: Floats
    """(k, 3c): moment, twist and shear of every section, then their means at every station of the strips."""
    forces: Floats
    """(k, h + s): upward forces of held nodes and springs; all entries of a support are consecutive."""
    couples: Floats
    """(k, 2t): couples on θx and θy of points with a rotational stiffness, support by support."""
    on_lines: Floats
    """(k, v): forces at the vertices of lines that represent the twisting couples of edges, line by line."""
    on_areas: Floats
    """(k, a): deflections of the nodes that belong to elements on elastic areas."""
    beneath: Floats
    """(k, b, a): deflections of the plate below at the same a nodes, for each of b supports between two plates."""
    on_columns: Floats
    """(k, r + 3c): load in each of r regions within control perimeters; force and two couples of each of c columns."""

    @classmethod
    def stacked(cls, each: Iterable[Linear]) -> Linear:
        """Stack the readings of single solutions along a new first axis."""
        return cls(*map(np.array, zip(*each, strict=True)))

    def sums(self, coefficients: Floats) -> Linear:
        """Readings (k, ...) of k linear combinations of the b solutions, with coefficients (k, b)."""
        return Linear(
            *(
                _core.superpose(coefficients, one.reshape(len(one), -1)).reshape(len(coefficients), *one.shape[1:])
                for one in self
            )
        )


@dataclass(frozen=True, eq=False)
class Reader:
    """Computes the readings of solutions of one plate."""

    discretisation: Discretisation
    points: tuple[SupportPoints, ...]
    lines: Mapping[int, Line]
    around_areas: Ints  # (a,): nodes that belong to elements on elastic areas

    @staticmethod
    @kept
    def of(discretisation: Discretisation) -> Reader:
        """The `Reader` of a plate, built once."""
        supports = discretisation.model.support
        points = tuple(SupportPoints.of(discretisation, index) for index in range(len(supports)))
        areas = [area_at_rest(discretisation, index) for index, one in enumerate(supports) if one.area is not None]
        return Reader(discretisation, points, lines_of(discretisation), nodes_around(areas))

    @cached_property
    def forces_of(self) -> list[slice]:
        """For each support, the slice of the forces of its held nodes and springs in `Linear.forces`."""
        return _slices(points.fixed for points in self.points)

    @cached_property
    def couples_of(self) -> list[slice]:
        """For each support, the slice of its couples in `Linear.couples`."""
        return _slices(points.turning.size for points in self.points)

    @cached_property
    def vertices_of(self) -> Mapping[int, slice]:
        """For each line that holds the twist, the slice of the line's vertices in `Linear.on_lines`."""
        lines = {index: line.couples for index, line in self.lines.items() if line.couples is not None}
        return dict(zip(lines, _slices(couples.shape[0] for couples in lines.values()), strict=True))

    def read(
        self,
        load: CaseLoad,
        hi: Floats,
        lo: Floats,
        reaction: Floats,
        forces: SupportForces,
        fields: Floats | None,
        beneath: Mapping[int, Floats],
    ) -> Linear:
        """Take readings of a solution: u = hi + lo (3n,), reactions of contact points, support forces, fields (s, 8).

        ``beneath`` are deflections (n,) of other plates at this plate's nodes, by index of the support between the
        plates.

        If ``fields`` is None, only deflections are read at probes; the other fields are NaN there.
        """
        found, sides = self.discretisation, self.discretisation.probe_sides
        deflection = (hi + lo)[::3]
        if fields is None:
            fields = np.full((found.stress_nodes.count, len(LINEAR)) if len(sides.point) else (0, 0), np.nan)
            fields[:, :1] = found.stress_nodes.spread(deflection)[: len(fields), None]
        at_probes = found.stress_nodes.at(sides, fields) if len(sides.point) else np.zeros((0, len(LINEAR)))
        held, nothing = forces.held[::3], list[Floats]([np.zeros(0)])
        of_supports = [np.concatenate([held[one.nodes], forces.springs[one.springs]]) for one in self.points]
        couples = [one.moments(forces.springs).ravel() for one in self.points]
        on_lines, turned = nothing, np.zeros((0, 2))
        if self.vertices_of or found.columns.columns:
            turned = found.held.to_global(forces.held.reshape(-1, 3)[:, 1:])
            of_lines = [line.couples @ turned.ravel() for line in self.lines.values() if line.couples is not None]
            on_lines = nothing + of_lines
        faces, positions = faces_of(found) if found.model.at_faces else (), found.probe_positions[sides.point]
        return Linear(
            at_probes,
            at_faces(faces, fields[:, 3:6], at_probes[:, 3:6], positions) if faces else np.zeros((0, 3)),
            found.through(load, hi, lo, reaction, forces.springs),
            np.concatenate(nothing + of_supports),
            np.concatenate(nothing + couples),
            np.concatenate(on_lines),
            deflection[self.around_areas],
            np.array([other[self.around_areas] for other in beneath.values()]).reshape(
                len(beneath), len(self.around_areas)
            ),
            self._on_columns(load, reaction, turned),
        )

    def _on_columns(self, load: CaseLoad, reaction: Floats, turned: Floats) -> Floats:
        """Readings (r + 3c,) of `Linear.on_columns`, from a load, reactions, and couples (n, 2) of held nodes."""
        found = self.discretisation
        result, first, points = (
            load.on_columns + np.zeros(found.columns.count),
            len(found.columns.regions),
            found.points,
        )
        for own, column in zip(result[first:].reshape(-1, 3), found.columns.columns, strict=True):
            if (support := column.column.support) is not None and found.model.support[support].holds_rotation:
                held = found.held.points
                of_nodes = (held.support == support) & (held.numbers == column.column.point)
                of_rows = (points.support == support) & (points.numbers == column.column.point) & points.slope
                own[1:] -= turned[found.held.nodes[of_nodes]].sum(axis=0)
                own[1:] -= reaction[np.flatnonzero(of_rows)].reshape(-1, 2).sum(axis=0)
        return result


def nodes_around(areas: Iterable[AreaContact]) -> Ints:
    """Nodes (a,) of the elements on elastic areas; their deflections determine pressures and contact areas."""
    nodes = [area.mesh.elements[area.covered > 0].ravel() for area in areas if area.support.is_elastic]
    return np.unique(np.concatenate([np.zeros(0, np.int64), *nodes]))


def _slices(counts: Iterable[int]) -> list[slice]:
    ends = np.cumsum([0, *counts]).tolist()
    return [slice(begin, end) for begin, end in pairwise(ends)]


@dataclass(frozen=True, eq=False)
class Readings:
    """Readings of k solutions of one plate, and the numbers computed from them.

    ``shared`` (k, m + r) are reactions of all contact and repeated points. ``gap`` (k, m) and ``closed`` (k, m) are the
    states of contact points. Readings that are superposed have no ``answers`` and ``loads``, and only the deflections
    around areas.
    """

    reader: Reader
    linear: Linear
    shared: Floats
    gap: Floats
    closed: Bools
    answers: Sequence[Answer] = ()
    loads: Sequence[CaseLoad] = ()
    between: Sequence[int] = ()
    """Indices of the supports through which this plate rests on other plates, whose deflections are read."""
    upon: Collection[int] = ()
    """Indices of the supports through which another plate rests on this one."""

    @classmethod
    def of(
        cls,
        discretisation: Discretisation,
        loads: Sequence[CaseLoad],
        answers: Sequence[Answer],
        forces: Sequence[SupportForces],
        fields: Sequence[Floats | None],
        beneath: Sequence[Mapping[int, Floats]],
        upon: Collection[int] = (),
    ) -> Self:
        """Take the readings of k answers to k loads; `Reader.read` describes the arguments for each answer."""
        reader = Reader.of(discretisation)
        linear = Linear.stacked(
            reader.read(load, answer.hi, answer.lo, answer.shared, of, own, below)
            for load, answer, of, own, below in zip(loads, answers, forces, fields, beneath, strict=True)
        )
        shared, gap, closed = (np.array([getattr(one, key) for one in answers]) for key in ("shared", "gap", "closed"))
        return cls(reader, linear, shared, gap, closed, answers, loads, tuple(beneath[0]), upon)

    def numbers(self, catalogue: Catalogue) -> Floats:
        """Values (k, n) of the numbers of a catalogue; extremes of fields and checks are NaN, and computed later."""
        result = np.full((len(self.shared), len(catalogue)), np.nan)
        for (home, owner, what), places in catalogue.groups.items():
            if home not in EXTREMES and home != "check":
                result[:, places] = self.read(home, owner, what)
        return result

    def read(self, home: Home, owner: int, what: str) -> Floats:
        """Values (k, q) of the quantity ``what`` for q points, probes or stations; q is 1 for a support or strip."""
        match home:
            case "probe":
                return self._at_probes(what)
            case "section":
                return _THROUGH[what](self._through[:, : self._sections])
            case "station":
                return self._at_stations(what, self._through[:, self._sections :])
            case "punching":
                return self.punching[what]
            case "strip":
                return _OF_STRIPS[what](self._through[:, self._sections :][:, self._stations[owner]])[:, None]
            case "support":
                return _OF_SUPPORTS[what](self.supports[owner])[:, None]
            case _:
                return _OF_POINTS[home, what](self.supports[owner])

    @cached_property
    def supports(self) -> tuple[SupportReading, ...]:
        """Readings of each support, in the order of the model."""
        return tuple(SupportReading(self, index) for index in range(len(self.reader.points)))

    @property
    def discretisation(self) -> Discretisation:
        """Mesh, supports and loads of the plate."""
        return self.reader.discretisation

    @cached_property
    def punching(self) -> Mapping[str, Floats]:
        """Numbers (k, c) of the punching checks of c columns, by name of the quantity."""
        columns = self.discretisation.columns
        pairs = zip(columns.columns, columns.slices, strict=True)
        each = [self._punching(index, *pair) for index, pair in enumerate(pairs)]
        shape = len(each), len(self.shared)
        return {one.name: np.array([values[one.name] for values in each]).reshape(shape).T for one in OF_COLUMNS}

    def _punching(self, index: int, column: PunchedColumn, regions: slice) -> Mapping[str, Floats]:
        """Punching numbers (k,) of a column, from its force and moment and the forces inside its control perimeters."""
        first, own = len(self.discretisation.columns.regions), column.column
        load = self.linear.on_columns[:, regions]
        force, x, y = self.linear.on_columns[:, first + 3 * index :][:, :3].T
        moment, pushing = x + 1j * y, np.zeros_like(load)
        for state in self.supports:
            forces, places = (
                state.applied if state.support.area is not None else (state.reactions, state.points.positions)
            )
            mine = np.full(len(places), state.index == own.support)
            if state.support.area is None:
                mine &= np.arange(len(places)) == own.point
                within = [region.contains(places) & ~mine for region in column.regions]
                pushing += forces @ np.array(within, np.float64).T
            elif state.index != own.support:
                pushing += state.pressing(index)
            if mine.any():
                force, couples = forces[:, mine].sum(axis=1), state.couples[:, mine[: state.points.turning.shape[0]]]
                moment = (
                    forces[:, mine] @ (places[mine] - own.at) @ [1.0, 1j] - couples.sum(axis=1) @ [1.0, 1j] - moment
                )
        inside = pushing - load + force[:, None] if own.support is None else load - pushing
        return in_units(column, force, moment, inside)

    @cached_property
    def probes(self) -> Floats:
        """Fields (k, q, 8) at probes; where a field jumps, the value of larger magnitude."""
        return self.discretisation.probe_sides.larger(self.linear.probes)

    @cached_property
    def of_bars(self) -> Floats:
        """Moments (k, q, 3) for the design of bars at probes."""
        values = self.linear.of_bars
        return self.discretisation.probe_sides.larger(values) if values.shape[1] else self.probes[..., 3:6]

    @cached_property
    def pressures(self) -> Floats:
        """Contact pressures (k, q) at probes; NaN where there is no area support."""
        found = self.discretisation
        areas = [one for one in self.supports if one.support.area is not None and one.index not in self.upon]
        result, step = list[Floats](), max(1, _TOGETHER // found.mesh.node_count)
        for some in (slice(first, first + step) for first in range(0, len(self.shared), step)):
            of_each = zip(*(one.areas(some) for one in areas), strict=True) if areas else [()] * len(self.shared[some])
            result += [total_pressure(of_one, found.probe_positions) for of_one in of_each]
        return np.array(result).reshape(len(self.shared), len(found.probe_positions))

    def deflections(self, some: slice) -> Floats:
        """Deflections (k', n) of a slice of solutions; if superposed, they are known around elastic areas, else 0."""
        if self.answers:
            return np.array([(answer.hi + answer.lo)[::3] for answer in self.answers[some]])
        around = self.linear.on_areas[some]
        result = np.zeros((len(around), self.discretisation.mesh.node_count))
        result[:, self.reader.around_areas] = around
        return result

    def _at_probes(self, what: str) -> Floats:
        if what == "pressure":
            return self.pressures
        if what in LINEAR:
            return self.probes[..., list(LINEAR).index(what)]
        moment, shear, found = self.probes[..., 3:6], self.probes[..., 6:], self.discretisation
        moment = self.of_bars if what in OF_BARS else moment
        return derived([what], moment, shear, found.probe_thickness, found.model.bars)[..., 0]

    def _at_stations(self, what: str, through: Floats) -> Floats:
        if what in _THROUGH:
            return _THROUGH[what](through)[:, : through.shape[1] - len(self.discretisation.sections.faces)]
        return designed(self.discretisation, what, through)

    @property
    def _through(self) -> Floats:
        return self.linear.through.reshape(len(self.shared), self.linear.through.shape[1] // 3, 3)

    @property
    def _sections(self) -> int:
        return len(self.discretisation.model.section)

    @cached_property
    def _stations(self) -> list[slice]:
        return _slices(strip.stations for strip in self.discretisation.model.strip)


@dataclass(frozen=True, eq=False)
class SupportReading:
    """Readings of one support with p points in k solutions, and formulas for the quantities of the registry."""

    of: Readings
    index: int

    @property
    def support(self) -> Support:
        """The support in the model."""
        return self.of.discretisation.model.support[self.index]

    @property
    def points(self) -> SupportPoints:
        """Points of the support."""
        return self.of.reader.points[self.index]

    @cached_property
    def reactions(self) -> Floats:
        """Upward forces (k, p) that the points exert on the plate."""
        return self.points.forces(self.of.linear.forces[:, self.of.reader.forces_of[self.index]], self.of.shared)

    @cached_property
    def gaps(self) -> Floats:
        """Remaining free travels (k, p) of the points."""
        return self.points.gaps(self.of.gap)

    @cached_property
    def closed(self) -> Bools:
        """Mask (k, p): whether points are closed."""
        return self.points.closed(self.of.closed)

    @cached_property
    def yielded(self) -> Bools:
        """Mask (k, p): whether the reactions of points reach their limits."""
        return np.array([self.points.yielded(self.of.discretisation, one) for one in self.of.shared])

    @property
    def couples(self) -> Floats:
        """Couples (k, p, 2) on θx and θy that the points exert on the plate."""
        own = self.of.linear.couples[:, self.of.reader.couples_of[self.index]]
        return own.reshape(len(own), *self.points.turning.shape)

    @property
    def pieces(self) -> Ints:
        """Index (k, p) of the piece of its law on which each point is."""
        return np.array([self.points.pieces(self.of.discretisation, one.piece) for one in self.of.answers])

    @property
    def tightened_to(self) -> Floats:
        """Upward forces (p,) to which each bolt was last tightened."""
        return self.points.tightened_to(self.of.discretisation)

    @property
    def preloads(self) -> Floats:
        """Upward forces (p,) of the bolts when all bolts are tightened, before other loads act."""
        return self.points.preloads(self.of.discretisation)

    @property
    def lift(self) -> Floats:
        """Upward resultant (k,) of the loads on the plate; NaN where the resultant is zero or points down."""
        forces = np.array([load.weighing[::3] for load in self.of.loads])
        lift = -forces.sum(axis=1)
        return np.where(lift > NO_FORCE * np.abs(forces).sum(axis=1), lift, np.nan)

    @property
    def closed_part(self) -> Floats:
        """Closed part (k,) of the support, 0 to 1: of points by number, of lines by length, of areas by area.

        The closed part of a line can only be computed from complete answers.
        """
        weights = self.points.weights
        if not weights.sum() > 0.0:
            return np.ones(len(self.closed))
        if self.support.along_line:
            return np.array([closed_part(self.of.discretisation, self.points, one) for one in self.of.answers])
        touching = self.contact_area if self.support.area is not None else self.closed @ weights
        return np.asarray(np.clip(touching / weights.sum(), 0.0, 1.0))

    @cached_property
    def at_rest(self) -> AreaContact:
        """Contact of the area support without load."""
        return area_at_rest(self.of.discretisation, self.index)

    def above(self, some: slice) -> Floats:
        """Deflections (k', n) of the plate; around areas they are relative to the plate on which it rests, if any."""
        deflection = self.of.deflections(some)
        if (beneath := self.beneath) is not None:
            deflection[:, self.of.reader.around_areas] -= beneath[some]
        return deflection

    @property
    def beneath(self) -> Floats | None:
        """Deflections (k, a), at `Reader.around_areas`, of the plate on which this plate rests; None without one."""
        return self.of.linear.beneath[:, self.of.between.index(self.index)] if self.index in self.of.between else None

    def areas(self, some: slice = slice(None)) -> tuple[AreaContact, ...]:
        """Contact of the area support in each solution of a slice."""
        columns = zip(self.above(some), self.of.shared[some], self.closed[some], self.reactions[some], strict=True)
        return tuple(
            area_contact(
                *(self.of.discretisation, self.index, above),
                *(self.points.centres(self.of.discretisation, shared), closed, reactions),
            )
            for above, shared, closed, reactions in columns
        )

    @property
    def applied(self) -> tuple[Floats, Floats]:
        """Upward forces (k, q) of held nodes, springs and contact points, and their positions (q, 2)."""
        points, found = self.points, self.of.discretisation
        places = [found.mesh.points[points.nodes], found.springs.positions[points.springs]]
        positions = np.concatenate([*places, found.points.positions[points.rows[0]]])
        each = replace(points, shares=None, order=np.arange(len(positions)))
        return each.forces(self.of.linear.forces[:, self.of.reader.forces_of[self.index]], self.of.shared), positions

    def pressing(self, column: int) -> Floats:
        """Upward forces (k, r) of the area inside the control perimeters of a column."""
        points, rows, sums, means, stiff = points_inside(self.of.discretisation, column, self.index)
        result = [np.zeros((0, sums.shape[0]))]
        for first in range(0, len(self.reactions), step := max(1, _TOGETHER // max(rows.shape))):
            some = slice(first, first + step)
            pressure = np.asarray((means @ self.reactions[some].T).T)
            if not stiff.all():
                exerted = SupportLaw(self.support).pressure((rows @ self.above(some).T).T, points.positions)
                pressure = np.where(stiff, pressure, np.nan_to_num(np.clip(exerted, *self.at_rest.bounds)))
            result.append((sums @ pressure.T).T)
        return np.concatenate(result)

    @cached_property
    def eccentricity(self) -> Floats:
        """Eccentricity (k, 2) of the resultant about the centroid of the area; NaN without an upward resultant."""
        forces, positions = self.applied
        total, centroid = forces.sum(axis=1), kern_of(self.of.discretisation, self.index).centroid
        total = np.where(total > NO_FORCE * np.abs(forces).sum(axis=1), total, np.nan)
        return np.asarray(forces @ (positions - centroid) / total[:, None])

    @property
    def kern(self) -> Floats:
        """Eccentricity (k,) relative to the edge of the kern; above 1 a linear pressure would have tension."""
        return np.asarray((self.eccentricity @ kern_of(self.of.discretisation, self.index).corners.T).max(axis=1))

    @cached_property
    def pressures(self) -> Floats:
        """Pressures (k, q) of the area support at `AreaContact.pressure_places`."""
        if not self.support.is_elastic:
            return self.at_rest.measured(np.zeros((len(self.reactions), 0)), self.reactions)
        on = np.flatnonzero(self.at_rest.on_nodes)
        around = self.of.linear.on_areas if (beneath := self.beneath) is None else self.of.linear.on_areas - beneath
        deflection = around[:, np.searchsorted(self.of.reader.around_areas, on)]
        return self.at_rest.measured(deflection, self.reactions)

    @cached_property
    def contact_area(self) -> Floats:
        """Areas (k,) of the support that are in contact."""
        step, result = max(1, _TOGETHER // self.of.discretisation.mesh.node_count), [np.zeros(0)]
        for first in range(0, len(self.closed), step):
            some = slice(first, first + step)
            result.append(self.at_rest.contact_areas(self.above(some), self.closed[some]))
        return np.concatenate(result)

    @property
    def yielded_area(self) -> Floats:
        """Area (k,) of the support in which the limit of the pressure is reached."""
        return np.array([area.yielding(own) for area, own in zip(self.areas(), self.yielded, strict=True)], np.float64)

    @cached_property
    def per_length(self) -> tuple[Floats, Floats]:
        """Reactions per length (k, s) at the stations of the line, and concentrated forces (k, c)."""
        line, where = self.of.reader.lines[self.index], self.of.reader.vertices_of.get(self.index)
        return line.read(self.reactions, None if where is None else self.of.linear.on_lines[:, where])


_OF_SUPPORTS: Mapping[str, Callable[[SupportReading], Floats]] = {
    "reaction": lambda of: of.reactions.sum(axis=1),
    "closed": lambda of: of.closed.sum(axis=1),
    "open": lambda of: (~of.closed).sum(axis=1),
    "closed_part": lambda of: of.closed_part,
    "lifted_part": lambda of: 1.0 - of.closed_part,
    "max_pressure": lambda of: np.fmax.reduce(of.pressures, axis=1, initial=0.0),
    "max_tension": lambda of: np.fmax.reduce(-of.pressures, axis=1, initial=0.0),
    "contact_area": lambda of: of.contact_area,
    "eccentricity_x": lambda of: of.eccentricity[:, 0],
    "eccentricity_y": lambda of: of.eccentricity[:, 1],
    "kern": lambda of: of.kern,
    "yielded_area": lambda of: of.yielded_area,
    "max_per_length": lambda of: of.per_length[0].max(axis=1),
    "min_per_length": lambda of: of.per_length[0].min(axis=1),
    "preload": lambda of: np.full(len(of.reactions), of.preloads.sum()),
    "prying": lambda of: -of.reactions.sum(axis=1) / of.lift,
}
"""Formula for the values (k,) of each quantity of supports, by name of the quantity."""
_OF_POINTS: Mapping[tuple[Home, str], Callable[[SupportReading], Floats]] = {
    ("point", "reaction"): lambda of: of.reactions,
    ("point", "gap"): lambda of: of.gaps,
    ("point", "moment_x"): lambda of: of.couples[..., 0],
    ("point", "moment_y"): lambda of: of.couples[..., 1],
    ("point", "piece"): lambda of: of.pieces.astype(np.float64),
    ("point", "tightened_to"): lambda of: of.tightened_to,
    ("point", "preload"): lambda of: of.preloads,
    ("point", "change"): lambda of: of.reactions - of.preloads,
    ("corner", "reaction"): lambda of: of.per_length[1],
}
"""Formula for the values (k, p) or (p,) of each quantity of supports' points and corners, by home and name."""
_THROUGH: Mapping[str, Callable[[Floats], Floats]] = {
    "moment": lambda through: through[..., 0],
    "twist": lambda through: through[..., 1],
    "shear": lambda through: through[..., 2],
}
"""Formula for the values (k, c) of each quantity of sections and stations, from readings (k, c, 3)."""
_OF_STRIPS: Mapping[str, Callable[[Floats], Floats]] = {
    "max_moment": lambda through: through[..., 0].max(axis=1),
    "min_moment": lambda through: through[..., 0].min(axis=1),
}
"""Formula for the values (k,) of each quantity of a strip, from readings (k, c, 3) at its stations."""
