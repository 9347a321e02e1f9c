"""Loads as work-equivalent nodal forces."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from signorini import _core
from signorini.discretise.footprints import Footprints
from signorini.discretise.frames import Held
from signorini.discretise.places import Sampled, along_curve, in_area, located, mesh_edges
from signorini.discretise.quadrature import Quadrature, area_quadrature
from signorini.discretise.quadrature.stepped import Levels, crossed, cut_by
from signorini.discretise.rows import Floats, Ints
from signorini.discretise.zones import Zones
from signorini.errors import Place, Problems
from signorini.mesh import Mesh
from signorini.model import Load

_GAUSS = 3
_GAUSS_VARYING = 5
"""Gauss points a direction where the load varies."""
_CANCELLED = 16 * float(np.finfo(float).eps)
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
    acting : frozenset of str
        The load cases that it is made of.
    """

    nodal: Floats
    curvature: Floats
    couples: Floats
    weighing: Floats
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
            self.acting | other.acting,
        )

    def __rmul__(self, factor: float) -> CaseLoad:
        """Multiply by a factor."""
        nodal = factor * self.nodal
        weighing = nodal if self.all_weighs else factor * self.weighing
        acting = self.acting if factor else frozenset()
        return CaseLoad(nodal, factor * self.curvature, factor * self.couples, weighing, acting)


def _sum(a: Floats, b: Floats) -> Floats:
    total = a + b
    return np.where(np.abs(total) <= _CANCELLED * (np.abs(a) + np.abs(b)), 0.0, total)


def case_loads(zones: Zones, mesh: Mesh, plate: _core.Plate, held: Held, problems: Problems) -> dict[str, CaseLoad]:
    """Every load case of the model, by name."""
    model = zones.model
    cases: dict[str, CaseLoad] = {}
    motions = held.rigid_motions(mesh.points, mesh.middle) / [1.0, mesh.size, mesh.size]
    footprints = Footprints(mesh, model.support)
    for index, load in enumerate(model.load):
        with problems.collected():
            found = _weighed(motions, _load(zones, mesh, plate, footprints, load, ("load", index)))
            cases[load.case] = cases[load.case] + found if load.case in cases else found
    return {case: replace(_weighed(motions, load), acting=frozenset([case])) for case, load in cases.items()}


def _weighed(motions: Floats, load: CaseLoad) -> CaseLoad:
    """A load of which nothing weighs if it balances itself."""
    resultant = np.abs(motions.T @ load.weighing)
    balanced = (resultant <= _BALANCED * (np.abs(motions).T @ np.abs(load.weighing))).all()
    return replace(load, weighing=np.zeros_like(load.nodal)) if balanced and load.nodal.any() else load


def _load(zones: Zones, mesh: Mesh, plate: _core.Plate, footprints: Footprints, load: Load, place: Place) -> CaseLoad:
    model = zones.model
    nodal = np.zeros(3 * mesh.node_count)
    curvature, couples = np.zeros(3), np.zeros(2 * len(mesh.elements))
    match load.kind:
        case "pressure":
            assert load.pressure is not None
            order = _GAUSS if load.pressure.is_constant else _GAUSS_VARYING
            over = in_area(mesh, model.plate, load.area, place, order, levels=load.pressure.levels)
            pressure = load.pressure(*over.positions.T, place=(*place, "pressure"))
            push(mesh, nodal, over.elements, over.xi, over.weights * pressure)
        case "self_weight":
            _weigh(zones, mesh, nodal)
        case "line_load":
            assert load.line_load is not None
            order = _GAUSS if load.line_load.is_constant else _GAUSS_VARYING
            sides = mesh_edges(mesh, load, place)
            points = along_curve(mesh, model.plate, load, place, sides, order, levels=load.line_load.levels)
            force = load.line_load(*points.positions.T, place=(*place, "line_load"))
            push(mesh, nodal, points.elements, points.xi, points.weights * force)
        case "force":
            assert load.force is not None and load.at is not None
            spread = footprints.of(load, place)
            for over in spread:
                push(mesh, nodal, over.elements, over.xi, load.force * over.weights / over.total)
            if not spread:
                points = located(mesh, load.at, (*place, "at"))
                push(mesh, nodal, points.elements, points.xi, load.force * points.weights)
        case "moment" | "couple_about":
            assert load.couple is not None and load.at is not None
            spread = footprints.of(load, place)
            for over in spread:
                push(mesh, nodal, over.elements, over.xi, _turning(over, load.couple))
            if not spread:
                _twist(mesh, plate, nodal, couples, located(mesh, load.at, (*place, "at")), load.couple)
        case "curvature":
            assert load.curvature is not None
            nodal, couples = plate.curvature_load(load.curvature)
            curvature = np.array(load.curvature)
    return CaseLoad(nodal, curvature, couples, np.zeros_like(nodal) if load.kind == "curvature" else nodal)


def _weigh(zones: Zones, mesh: Mesh, nodal: Floats) -> None:
    """Add the plate's weight to a nodal vector (3n,)."""
    over = _over_plate(zones, mesh)
    made = zones.at(over.elements, over.positions)
    weight = zones.unit_weights[made.material] * zones.thickness(made.thickness, over.positions)
    push(mesh, nodal, over.elements, over.xi, over.weights * weight)


def _over_plate(zones: Zones, mesh: Mesh) -> Quadrature:
    """Points all over the plate to integrate its thickness by."""
    order = _GAUSS if all(formula.is_constant for formula in zones.formulas) else _GAUSS_VARYING
    levels: Levels = [level for formula in dict.fromkeys(zones.formulas) for level in formula.levels]
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


def _turning(over: Quadrature, couple: tuple[float, float]) -> Floats:
    """Forces (q,) of the pressure that varies linearly over a footprint and whose resultant is a couple."""
    # From the middle, and by the footprint's own size: the three products are then of one size.
    middle = over.weights @ over.positions / over.total
    size = np.sqrt(over.total)
    linear = np.column_stack([np.ones(len(over.weights)), (over.positions - middle) / size])
    resultant = np.array([0.0, *couple]) / [1.0, size, size]
    pressure = np.linalg.solve(linear.T @ (over.weights[:, None] * linear), resultant)
    return np.asarray(over.weights * (linear @ pressure))


def push(mesh: Mesh, nodal: Floats, elements: Ints, xi: Floats, force: Floats) -> None:
    """Add forces (q,) at points of elements to a nodal vector (3n,)."""
    values = mesh.shape_functions(elements, xi)
    nodal[::3] += np.bincount(mesh.elements[elements].ravel(), (force[:, None] * values).ravel(), mesh.node_count)


def _twist(
    mesh: Mesh, plate: _core.Plate, nodal: Floats, couples: Floats, points: Sampled, moment: tuple[float, float]
) -> None:
    dofs = (3 * mesh.elements[points.elements][:, :, None] + np.arange(3)).reshape(-1, 24)
    for field, couple in enumerate(moment, start=1):
        rows, centre = plate.interpolation_rows(points.elements, points.xi, field)
        np.add.at(nodal, dofs, couple * rows)
        np.add.at(couples, 2 * points.elements[:, None] + np.arange(2), couple * centre)
