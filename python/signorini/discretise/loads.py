"""Loads as work-equivalent nodal forces; loads at positions of moving loads are computed on access."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from signorini import _core
from signorini.discretise.held import Held
from signorini.discretise.placed import Footprints
from signorini.discretise.places import along_curve, in_area, located, mesh_edges
from signorini.discretise.punching import Columns
from signorini.discretise.quadrature import GAUSS, LineQuadrature, Quadrature, area_quadrature
from signorini.discretise.quadrature.stepped import Levels, among, crossed, cut_by
from signorini.discretise.rows import Floats, Ints
from signorini.discretise.sections import Sections
from signorini.discretise.sections.sections import Spread
from signorini.discretise.zones import Zones
from signorini.errors import Place, Problems
from signorini.mesh import Mesh
from signorini.model import Load, Model, Moving
from signorini.model.load import Wheel
from signorini.shapes import Polygon

_GAUSS_VARYING = 5
"""Number of Gauss points in each direction for a load that varies, and on thirds of a circle.

Three points integrate cos 3φ around a circle with an error of 2 %."""
CANCELLED = 16 * float(np.finfo(float).eps)
"""Relative tolerance for a zero sum of two loads.

A floating plate must not drift under the rounding of the sum.
"""
_BALANCED = 1e-12
"""Largest resultant of a self-equilibrated load, relative to the sum of magnitudes of its forces."""
_NOTHING = 1e-9
"""Largest fraction of a wheel's footprint off the plate that is attributed to rounding."""


@dataclass(frozen=True, eq=False)
class CaseLoad:
    """Load vector f of a load case, or of a combination of the load cases ``acting``.

    ``nodal`` (3n,) are forces and couples in nodal axes, ``curvature`` (3,) the stress-free kx, ky, kxy, ``couples``
    (2e,) couples on the centre rotations of elements. ``weighing`` (3n,) is the part of ``nodal`` that can have a
    resultant: it excludes stress-free curvatures and self-equilibrated loads. ``through`` (3s,) is the direct
    contribution of the load to moment, twist and shear of each section, in addition to that of nodal forces.
    ``on_columns`` (r + 3c,) are forces and couples at columns, see `Columns`.
    ``plates`` are the loads on each of several plates; curvatures and sections are stored there only.
    """

    nodal: Floats
    curvature: Floats
    couples: Floats
    weighing: Floats
    through: Floats = field(default_factory=lambda: np.zeros(()))
    acting: frozenset[str] = frozenset()
    plates: tuple[CaseLoad, ...] = ()
    on_columns: Floats = field(default_factory=lambda: np.zeros(()))

    @classmethod
    def none(cls, nodes: int, elements: int) -> CaseLoad:
        """The zero load on a mesh of ``nodes`` nodes and ``elements`` elements."""
        nodal = np.zeros(3 * nodes)
        return cls(nodal, np.zeros(3), np.zeros(2 * elements), nodal)

    @classmethod
    def join(cls, plates: Sequence[CaseLoad]) -> CaseLoad:
        """Join the loads on several plates."""
        nodal, couples, weighing = (
            np.concatenate([getattr(load, key) for load in plates]) for key in ("nodal", "couples", "weighing")
        )
        acting = frozenset().union(*(load.acting for load in plates))
        return cls(nodal, np.zeros(3), couples, weighing, np.zeros(()), acting, tuple(plates))

    def on(self, plate: int) -> CaseLoad:
        """Load on the plate with a given index; for a model of one plate, this load."""
        return self.plates[plate] if self.plates else self

    @property
    def all_weighs(self) -> bool:
        """Whether ``weighing`` equals ``nodal``."""
        return self.weighing is self.nodal

    def __add__(self, other: CaseLoad) -> CaseLoad:
        """Sum of two loads; entries that cancel up to rounding are set to 0."""
        nodal = _sum(self.nodal, other.nodal)
        return CaseLoad(
            nodal,
            _sum(self.curvature, other.curvature),
            _sum(self.couples, other.couples),
            nodal if self.all_weighs and other.all_weighs else _sum(self.weighing, other.weighing),
            self.through + other.through,
            self.acting | other.acting,
            tuple(load + added for load, added in zip(self.plates, other.plates, strict=True)),
            self.on_columns + other.on_columns,
        )

    def __rmul__(self, factor: float) -> CaseLoad:
        """Multiply the load by a factor."""
        nodal = factor * self.nodal
        weighing = nodal if self.all_weighs else factor * self.weighing
        acting = self.acting if factor else frozenset()
        through = factor * self.through
        plates = tuple(factor * load for load in self.plates)
        rest = through, acting, plates, factor * self.on_columns
        return CaseLoad(nodal, factor * self.curvature, factor * self.couples, weighing, *rest)


def _sum(a: Floats, b: Floats) -> Floats:
    total = a + b
    return np.where(np.abs(total) <= CANCELLED * (np.abs(a) + np.abs(b)), 0.0, total)


def loaded_sides(model: Model, mesh: Mesh, problems: Problems) -> dict[int, Ints | None]:
    """Map from each load's index to the element sides (k, 3) along which it acts.

    The value is None for a load that does not act along a line, or whose line the mesh does not follow.
    """
    result = {}
    for index, load in enumerate(model.load):
        with problems.collected():
            result[index] = (
                mesh_edges(mesh, model.plate, load.where, ("load", index)) if load.kind == "line_load" else None
            )
    return result


def case_loads(
    zones: Zones,
    mesh: Mesh,
    plate: _core.Plate,
    held: Held,
    sections: Sections,
    columns: Columns,
    sides: Mapping[int, Ints | None],
    problems: Problems,
) -> dict[str, CaseLoad]:
    """Loads by load case; ``sides`` is the result of `loaded_sides`; loads without an entry in it are left out."""
    model = zones.model
    cases: dict[str, CaseLoad] = {}
    motions = held.rigid_motions(mesh.points, mesh.middle) / [1.0, mesh.size, mesh.size]
    footprints = Footprints(mesh, model.support)
    for index, sides_of_load in sides.items():
        load = model.load[index]
        with problems.collected():
            onto = Onto(mesh, sections, columns)
            result = _weighed(motions, _load(zones, onto, plate, footprints, load, sides_of_load, ("load", index)))
            cases[load.case] = cases[load.case] + result if load.case in cases else result
    # A case that only multiplies a preload has the load zero; `analysis.tightening` applies the preload.
    cases |= {case: CaseLoad.none(mesh.node_count, len(mesh.elements)) for case in model.preload_cases}
    return {
        case: replace(
            _weighed(motions, load),
            acting=frozenset([case]),
            on_columns=load.on_columns + columns.of_case(model, case),
        )
        for case, load in cases.items()
    }


def _weighed(motions: Floats, load: CaseLoad) -> CaseLoad:
    """Return the load with ``weighing`` set to 0 if the load is self-equilibrated."""
    resultant = np.abs(motions.T @ load.weighing)
    balanced = (resultant <= _BALANCED * (np.abs(motions).T @ np.abs(load.weighing))).all()
    return replace(load, weighing=np.zeros_like(load.nodal)) if balanced and load.nodal.any() else load


def _load(
    zones: Zones,
    onto: Onto,
    plate: _core.Plate,
    footprints: Footprints,
    load: Load,
    sides: Ints | None,
    place: Place,
) -> CaseLoad:
    model, mesh, where = zones.model, onto.mesh, load.where
    match load.kind:
        case "pressure":
            assert load.pressure is not None
            order = GAUSS if load.pressure.is_constant else _GAUSS_VARYING
            formula, key = load.pressure, (*place, "pressure")
            quadrature = in_area(mesh, model.plate, where.region, place, order, levels=formula.levels)
            onto.spread(
                quadrature,
                Spread(where.region, order, formula.levels, lambda _, positions: formula(*positions.T, place=key)),
            )
        case "self_weight":
            _weigh(zones, onto)
        case "line_load":
            assert load.line_load is not None
            order = GAUSS if load.line_load.is_constant and where.key != "circle" else _GAUSS_VARYING
            formula = load.line_load

            def along(levels: Levels) -> Quadrature:
                levels = (*formula.levels, *levels)
                points = along_curve(mesh, model.plate, where, place, sides, order, levels=levels)
                return points.times(formula(*points.positions.T, place=(*place, "line_load")))

            onto.draw(along)
        case "force":
            assert load.force is not None
            spread = footprints.of(load, place)
            for quadrature, shape in zip(spread, where.footprints, strict=True):
                onto.spread(quadrature, Spread.even(shape, load.force / quadrature.total))
            if not spread:
                onto.push(located(mesh, where.points, (*place, "at")).times(load.force))
        case "moment" | "couple_about":
            assert load.couple is not None
            spread = footprints.of(load, place)
            for quadrature, shape in zip(spread, where.footprints, strict=True):
                onto.spread(quadrature, Spread(shape, GAUSS, (), _turning(quadrature, load.couple)))
            if not spread:
                onto.twist(plate, located(mesh, where.points, (*place, "at")), load.couple)
        case "curvature":
            assert load.curvature is not None
            nodal, couples = plate.curvature_load(load.curvature)
            return CaseLoad(nodal, np.array(load.curvature), couples, np.zeros_like(nodal), onto.through)
    return onto.load


class Onto:
    """Sums the nodal forces of loads on a mesh and their direct contributions to sections and columns."""

    def __init__(self, mesh: Mesh, sections: Sections, columns: Columns) -> None:
        self.mesh, self._sections, self._columns = mesh, sections, columns
        self._nodal = np.zeros(3 * mesh.node_count)
        self._couples = np.zeros(2 * len(mesh.elements))
        self.through = np.zeros(3 * len(sections))
        self._on_columns = np.zeros(columns.count)

    @property
    def load(self) -> CaseLoad:
        """Sum of the loads that were added to this object."""
        result = CaseLoad(self._nodal, np.zeros(3), self._couples, self._nodal, self.through)
        return replace(result, on_columns=self._on_columns)

    def push(self, forces: Quadrature) -> None:
        """Add point forces, which are the weights of ``forces``."""
        self._add(forces)
        self.through += self._sections.of_points(forces)
        self._on_columns += self._columns.of_points(forces)

    def draw(self, along: Callable[[Levels], Quadrature]) -> None:
        """Add forces along a line.

        ``along`` is a function of level functions: it returns the line's quadrature, divided where these change sign.
        """
        whole = along(())
        self._add(whole)
        self.through += self._sections.of_line(whole, along)
        self._on_columns += self._columns.of_line(along)

    def spread(self, quadrature: Quadrature, spread: Spread) -> None:
        """Add the pressure ``spread``; ``quadrature`` has the points and weights over the pressure's region."""
        forces = quadrature.times(spread.pressure(quadrature.elements, quadrature.positions))
        self._add(forces)
        self.through += self._sections.of_spread(forces, spread)
        self._on_columns += self._columns.of_spread(forces, spread)

    def twist(self, plate: _core.Plate, points: LineQuadrature, moment: tuple[float, float]) -> None:
        """Add a couple (mx, my) at each point."""
        dofs = (3 * self.mesh.elements[points.elements][:, :, None] + np.arange(3)).reshape(-1, 24)
        for field_, couple in enumerate(moment, start=1):
            rows, centre = plate.interpolation_rows(points.elements, points.xi, field_)
            np.add.at(self._nodal, dofs, couple * rows)
            np.add.at(self._couples, 2 * points.elements[:, None] + np.arange(2), couple * centre)
            self.through += self._sections.of_rows(points.elements, points.positions, couple * rows)

    def _add(self, forces: Quadrature) -> None:
        self._nodal[::3] += self.mesh.nodal_forces(forces.elements, forces.xi, forces.weights)


def _weigh(zones: Zones, onto: Onto) -> None:
    """Add the self-weight of the plate."""
    formulas = dict.fromkeys(zones.formulas)
    order = GAUSS if all(formula.is_constant for formula in formulas) else _GAUSS_VARYING
    levels: Levels = [level for formula in formulas for level in formula.levels]
    parted = [*levels, *zones.borders] if zones.parted.any() else levels

    def weight(elements: Ints, positions: Floats) -> Floats:
        section = zones.at(elements, positions)
        return np.asarray(zones.unit_weights[section.material] * zones.nominal(section.thickness, positions))

    onto.spread(_over_plate(zones, onto.mesh, order, levels), Spread(None, order, parted, weight))


def _over_plate(zones: Zones, mesh: Mesh, order: int, levels: Levels) -> Quadrature:
    """Quadrature over the plate; elements that borders of zones cut are divided at the borders."""
    quadrature = area_quadrature(mesh, None, order, levels=levels)
    parted = np.flatnonzero(zones.parted.any(axis=0))
    if not len(parted):
        return quadrature
    levels = [*levels, *zones.borders]
    cut = cut_by(mesh, parted, among(levels, crossed(mesh, parted, levels)), order)
    return Quadrature.join([quadrature.pick(~np.isin(quadrature.elements, parted)), cut.points])


def _turning(quadrature: Quadrature, couple: tuple[float, float]) -> Callable[[Ints, Floats], Floats]:
    """Return a pressure as function of elements and positions, linear over a footprint, with a couple as resultant."""
    # Coordinates relative to the footprint's middle and size give three well-scaled equations for the pressure.
    middle = quadrature.centroid
    size = np.sqrt(quadrature.total)

    def linear(positions: Floats) -> Floats:
        return np.column_stack([np.ones(len(positions)), (positions - middle) / size])

    basis = linear(quadrature.positions)
    resultant = np.array([0.0, *couple]) / [1.0, size, size]
    pressure = np.linalg.solve(basis.T @ (quadrature.weights[:, None] * basis), resultant)
    return lambda _, positions: np.asarray(linear(positions) @ pressure)


class Cases(Mapping[str, CaseLoad]):
    """Load cases by name: those of static loads, and those of every position of moving loads.

    Wheels off the plate, and parts of wheels' footprints off the plate, do not act.
    """

    def __init__(
        self,
        static: Mapping[str, CaseLoad],
        moving: tuple[Moving, ...],
        mesh: Mesh,
        sections: Sections,
        columns: Columns,
    ) -> None:
        self._still = static
        self._places = {case: (load, s) for load in moving for case, s in load.positions.items()}
        self._mesh, self._sections, self._columns = mesh, sections, columns

    def __getitem__(self, case: str) -> CaseLoad:
        """Return the load of a case."""
        if case in self._still:
            return self._still[case]
        load, travelled = self._places[case]
        result = _position(Onto(self._mesh, self._sections, self._columns), load.wheels(travelled), load.patch)
        return replace(result, acting=frozenset([case]))

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the load cases."""
        yield from self._still
        yield from self._places

    def __len__(self) -> int:
        """Return the number of load cases."""
        return len(self._still) + len(self._places)

    def partly_off(self) -> Iterator[tuple[str, str, int, float]]:
        """Yield each wheel whose footprint is partly off the plate.

        The tuple has the moving load, the position, the number of the axle from 1, and the part of the force that is
        lost. Wheels entirely off the plate are ignored.
        """
        for name, (load, travelled) in self._places.items():
            if load.patch is None:
                continue
            wheels = load.wheels(travelled)
            prints = np.array([_print(position, direction, load.patch) for position, direction, _ in wheels])
            inside = self._mesh.locate(prints.reshape(-1, 2)).inside.reshape(-1, 4)
            for wheel in np.flatnonzero(inside.any(axis=1) & ~inside.all(axis=1)).tolist():
                shape = Polygon(tuple(map(tuple, prints[wheel].tolist())))
                covered = float(area_quadrature(self._mesh, shape, GAUSS).weights.sum())
                lost = 1.0 - covered / (load.patch[0] * load.patch[1])
                if lost > _NOTHING:
                    yield load.case, name, wheel * len(load.axles) // len(wheels) + 1, lost


def _position(onto: Onto, wheels: list[Wheel], patch: tuple[float, float] | None) -> CaseLoad:
    mesh = onto.mesh
    if patch is None:
        positions = np.array([positions_on_plate for positions_on_plate, _, _ in wheels])
        where = mesh.locate(positions)
        forces = np.array([force for _, _, force in wheels])
        on_plate, positions_on_plate = where.inside, positions[where.inside]
        onto.push(Quadrature(where.elements[on_plate], where.xi[on_plate], forces[on_plate], positions_on_plate))
    else:
        for middle, direction, force in wheels:
            shape = Polygon(_print(middle, direction, patch))
            onto.spread(area_quadrature(mesh, shape, GAUSS), Spread.even(shape, force / (patch[0] * patch[1])))
    return onto.load


def _print(
    centre: tuple[float, float], direction: tuple[float, float], patch: tuple[float, float]
) -> tuple[tuple[float, float], ...]:
    """Corners (4, 2) of a wheel's footprint ``patch`` = (length, width), with the length along ``direction``."""
    (x, y), (tx, ty), (length, width) = centre, direction, patch
    corners = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
    return tuple((x + a * length * tx - b * width * ty, y + a * length * ty + b * width * tx) for a, b in corners)
