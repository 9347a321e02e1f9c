"""Loads as work-equivalent nodal forces."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from signorini import _core
from signorini.discretise.footprints import Footprints
from signorini.discretise.frames import Held
from signorini.discretise.places import Sampled, along_curve, in_area, located, mesh_edges, region
from signorini.discretise.quadrature import Quadrature, area_quadrature
from signorini.discretise.quadrature.stepped import Levels, crossed, cut_by
from signorini.discretise.rows import Floats, Ints
from signorini.discretise.sections import Sections
from signorini.discretise.sections.acting import Push, Spread
from signorini.discretise.zones import Zones
from signorini.errors import Place, Problems
from signorini.mesh import Mesh
from signorini.model import Load, Model
from signorini.model.places import footprints as shapes_of

_GAUSS = 3
_GAUSS_VARYING = 5
"""Gauss points a direction where the load varies, and on thirds of a circle: of what turns three times around it three
points miss 2 %, and of a circle inside one element the deflection 2e-5."""
CANCELLED = 16 * float(np.finfo(float).eps)
"""Part of two loads below which their sum is rounding: a plate held up by its buoyancy must not drift away on it."""
_BALANCED = 1e-12
"""Part of the magnitudes that a resultant is made of below which it is their rounding."""


@dataclass(frozen=True, eq=False)
class CaseLoad:
    """One load case, or a combination of them.

    Parameters
    ----------
    nodal : (3n,) array
        Forces and couples in the nodes' frames.
    curvature : (3,) array
        Stress-free curvatures kx, ky, kxy.
    couples : (2e,) array
        Couples on the centre rotations of the elements.
    weighing: (3n,) array
        Of ``nodal`` what has a resultant: without stress-free curvatures, and without loads that balance themselves.
    through : (3s,) array
        Of the moment, twist and shear of each section what the load itself does where its line is; of nodal forces
        nothing.
    acting : frozenset of str
        The load cases that it is made of.
    """

    nodal: Floats
    curvature: Floats
    couples: Floats
    weighing: Floats
    through: Floats = field(default_factory=lambda: np.zeros(()))
    acting: frozenset[str] = frozenset()

    @classmethod
    def none(cls, nodes: int, elements: int) -> CaseLoad:
        """No load on a mesh of so many nodes and elements."""
        nodal = np.zeros(3 * nodes)
        return cls(nodal, np.zeros(3), np.zeros(2 * elements), nodal)

    @property
    def all_weighs(self) -> bool:
        """Whether there is nothing else than what has a resultant."""
        return self.weighing is self.nodal

    def __add__(self, other: CaseLoad) -> CaseLoad:
        """Let both act; where they cancel but for rounding, nothing does."""
        nodal = _sum(self.nodal, other.nodal)
        return CaseLoad(
            nodal,
            _sum(self.curvature, other.curvature),
            _sum(self.couples, other.couples),
            nodal if self.all_weighs and other.all_weighs else _sum(self.weighing, other.weighing),
            self.through + other.through,
            self.acting | other.acting,
        )

    def __rmul__(self, factor: float) -> CaseLoad:
        """Multiply by a factor."""
        nodal = factor * self.nodal
        weighing = nodal if self.all_weighs else factor * self.weighing
        acting = self.acting if factor else frozenset()
        through = factor * self.through
        return CaseLoad(nodal, factor * self.curvature, factor * self.couples, weighing, through, acting)


def _sum(a: Floats, b: Floats) -> Floats:
    total = a + b
    return np.where(np.abs(total) <= CANCELLED * (np.abs(a) + np.abs(b)), 0.0, total)


def loaded_sides(model: Model, mesh: Mesh, problems: Problems) -> dict[int, Ints | None]:
    """Of every load by its number the sides (k, 3) along which it acts; None where the mesh follows no line of it."""
    result = {}
    for index, load in enumerate(model.load):
        with problems.collected():
            result[index] = mesh_edges(mesh, model.plate, load, ("load", index)) if load.kind == "line_load" else None
    return result


def case_loads(
    zones: Zones,
    mesh: Mesh,
    plate: _core.Plate,
    held: Held,
    sections: Sections,
    sides: Mapping[int, Ints | None],
    problems: Problems,
) -> dict[str, CaseLoad]:
    """Every load case of the model, by name, of loads whose sides are known."""
    model = zones.model
    cases: dict[str, CaseLoad] = {}
    motions = held.rigid_motions(mesh.points, mesh.middle) / [1.0, mesh.size, mesh.size]
    footprints = Footprints(mesh, model.support)
    for index, along in sides.items():
        load = model.load[index]
        with problems.collected():
            onto = Onto(mesh, sections)
            result = _weighed(motions, _load(zones, onto, plate, footprints, load, along, ("load", index)))
            cases[load.case] = cases[load.case] + result if load.case in cases else result
    return {case: replace(_weighed(motions, load), acting=frozenset([case])) for case, load in cases.items()}


def _weighed(motions: Floats, load: CaseLoad) -> CaseLoad:
    """A load of which nothing weighs if it balances itself."""
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
    model, mesh = zones.model, onto.mesh
    match load.kind:
        case "pressure":
            assert load.pressure is not None
            order = _GAUSS if load.pressure.is_constant else _GAUSS_VARYING
            over = in_area(mesh, model.plate, load.area, place, order, levels=load.pressure.levels)
            formula, key = load.pressure, (*place, "pressure")
            onto.spread(over, Spread(region(load.area), order, formula.levels, lambda _, at: formula(*at.T, place=key)))
        case "self_weight":
            _weigh(zones, onto)
        case "line_load":
            assert load.line_load is not None
            order = _GAUSS if load.line_load.is_constant and load.circle is None else _GAUSS_VARYING
            formula = load.line_load

            def along(levels: Levels) -> Push:
                levels = (*formula.levels, *levels)
                points = along_curve(mesh, model.plate, load, place, sides, order, levels=levels)
                force = points.weights * formula(*points.positions.T, place=(*place, "line_load"))
                return Push(points.elements, points.xi, points.positions, force)

            onto.draw(along)
        case "force":
            assert load.force is not None and load.at is not None
            spread = footprints.of(load, place)
            for over, shape in zip(spread, shapes_of(load) if spread else (), strict=True):
                onto.spread(over, Spread.even(shape, load.force / over.total))
            if not spread:
                points = located(mesh, load.at, (*place, "at"))
                onto.push(points, load.force * points.weights)
        case "moment" | "couple_about":
            assert load.couple is not None and load.at is not None
            spread = footprints.of(load, place)
            for over, shape in zip(spread, shapes_of(load) if spread else (), strict=True):
                onto.spread(over, Spread(shape, _GAUSS, (), _turning(over, load.couple)))
            if not spread:
                onto.twist(plate, located(mesh, load.at, (*place, "at")), load.couple)
        case "curvature":
            assert load.curvature is not None
            nodal, couples = plate.curvature_load(load.curvature)
            return CaseLoad(nodal, np.array(load.curvature), couples, np.zeros_like(nodal), onto.through)
    return onto.load


class Onto:
    """Nodal forces of what acts on a mesh, and what it does at sections, as they are summed."""

    def __init__(self, mesh: Mesh, sections: Sections) -> None:
        self.mesh, self._sections = mesh, sections
        self._nodal = np.zeros(3 * mesh.node_count)
        self._couples = np.zeros(2 * len(mesh.elements))
        self.through = np.zeros(3 * len(sections))

    @property
    def load(self) -> CaseLoad:
        """All of it."""
        return CaseLoad(self._nodal, np.zeros(3), self._couples, self._nodal, self.through)

    def push(self, points: Sampled | Quadrature, force: Floats) -> None:
        """Add forces (q,) at points."""
        self._add(points.elements, points.xi, force)
        self.through += self._sections.of_points(points.elements, points.xi, points.positions, force)

    def draw(self, along: Callable[[Levels], Push]) -> None:
        """Add forces along a line, whose points are divided where levels change sign."""
        whole = along(())
        self._add(whole.elements, whole.xi, whole.force)
        self.through += self._sections.of_line(whole, along)

    def spread(self, over: Quadrature, spread: Spread) -> None:
        """Add a pressure, integrated at points."""
        force = over.weights * spread.pressure(over.elements, over.positions)
        self._add(over.elements, over.xi, force)
        self.through += self._sections.of_spread(over.elements, over.xi, force, spread)

    def twist(self, plate: _core.Plate, points: Sampled, moment: tuple[float, float]) -> None:
        """Add a couple at each of some points."""
        dofs = (3 * self.mesh.elements[points.elements][:, :, None] + np.arange(3)).reshape(-1, 24)
        for field_, couple in enumerate(moment, start=1):
            rows, centre = plate.interpolation_rows(points.elements, points.xi, field_)
            np.add.at(self._nodal, dofs, couple * rows)
            np.add.at(self._couples, 2 * points.elements[:, None] + np.arange(2), couple * centre)
            self.through += self._sections.of_couples(points.elements, points.positions, couple * rows)

    def _add(self, elements: Ints, xi: Floats, force: Floats) -> None:
        self._nodal[::3] += self.mesh.nodal_forces(elements, xi, force)


def _weigh(zones: Zones, onto: Onto) -> None:
    """Add the plate's weight."""
    formulas = dict.fromkeys(zones.formulas)
    order = _GAUSS if all(formula.is_constant for formula in formulas) else _GAUSS_VARYING
    levels: Levels = [level for formula in formulas for level in formula.levels]
    parted = [*levels, *zones.borders] if zones.parted.any() else levels

    def weight(elements: Ints, positions: Floats) -> Floats:
        made = zones.at(elements, positions)
        return np.asarray(zones.unit_weights[made.material] * zones.nominal(made.thickness, positions))

    onto.spread(_over_plate(zones, onto.mesh, order, levels), Spread(None, order, parted, weight))


def _over_plate(zones: Zones, mesh: Mesh, order: int, levels: Levels) -> Quadrature:
    """Points all over the plate to integrate its thickness by."""
    over = area_quadrature(mesh, None, order, levels=levels)
    parted = np.flatnonzero(zones.parted.any(axis=0))
    if not len(parted):
        return over
    levels = [*levels, *zones.borders]
    across = crossed(mesh, parted, levels)
    cut = cut_by(mesh, parted, [level for level, some in zip(levels, across, strict=True) if some.any()], order)
    rest = ~np.isin(over.elements, parted)
    return Quadrature(
        np.concatenate([over.elements[rest], cut.elements]),
        np.concatenate([over.xi[rest], cut.xi]),
        np.concatenate([over.weights[rest], cut.weights]),
        np.concatenate([over.positions[rest], cut.positions]),
    )


def _turning(over: Quadrature, couple: tuple[float, float]) -> Callable[[Ints, Floats], Floats]:
    """The pressure that varies linearly over a footprint and whose resultant is a couple."""
    # From the middle, and by the footprint's own size: the three products are then of one size.
    middle = over.weights @ over.positions / over.total
    size = np.sqrt(over.total)

    def linear(positions: Floats) -> Floats:
        return np.column_stack([np.ones(len(positions)), (positions - middle) / size])

    at = linear(over.positions)
    resultant = np.array([0.0, *couple]) / [1.0, size, size]
    pressure = np.linalg.solve(at.T @ (over.weights[:, None] * at), resultant)
    return lambda _, positions: np.asarray(linear(positions) @ pressure)
