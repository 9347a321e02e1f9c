"""Several plates: each by itself first, then all in one table of nodes and elements, and what is between them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TypeVar

import numpy as np
from scipy.sparse import block_diag, csr_array, hstack

from signorini import _core
from signorini.base.arguments import made_by
from signorini.discretise.discretisation import Discretisation, OfWhole, discretise_plate, plate_of
from signorini.discretise.domain import require_domain
from signorini.discretise.held import Bodies, Held
from signorini.discretise.loads import CaseLoad, Cases
from signorini.discretise.placed import placed
from signorini.discretise.points import ContactPoints, Springs
from signorini.discretise.preloads import require_preloads
from signorini.discretise.repeated import Repeated, not_held
from signorini.discretise.rows import Further, Ints, Rows
from signorini.discretise.sections import Sections
from signorini.discretise.stressnodes import StressNodes
from signorini.discretise.supports import Ground, points_of
from signorini.discretise.thickness import PlateStiffness, Thickness
from signorini.discretise.zones import ZonesOfPlates
from signorini.errors import Problems, placing
from signorini.mesh import Location, Mesh
from signorini.model import Model
from signorini.model.parts import Part


def discretise(model: Model, mesh: Mesh | None = None) -> Discretisation:
    """Mesh the plate, unless a mesh of it is given, or all plates, and turn supports and loads into arrays."""
    made_by(model, Model, _advice(model), "model")
    if not model.plates:
        return discretise_plate(model, mesh)
    parts, problems = model.parts, Problems()
    each: list[Discretisation] = []
    for part in parts:
        with placing(part.place), problems.collected():
            each.append(discretise_plate(part.model))
    problems.raise_collected()
    joints = _between(model, parts, each, problems)
    problems.raise_collected()
    return _joined(model, parts, each, joints, problems)


def _advice(given: object) -> str:
    """How to come from what was given to a model."""
    match given:
        case str() | os.PathLike():
            return "Load the file first: signorini.load(file)."
        case Mapping():
            return "Make one of the mapping first: signorini.validate(mapping)."
        case _:
            return "Make one with signorini.Model(...) or signorini.load(file)."


@dataclass(frozen=True, eq=False)
class _Joint:
    """What is between two plates, by number, as points of the whole: rows over both, the first's elements first."""

    support: int
    upper: int
    lower: int
    points: ContactPoints

    def rows(self, first: Ints) -> tuple[Rows, Rows]:
        """Rows over the upper plate and over the lower one, given where each plate's elements begin among all."""
        return self.points.rows.parted(int(first[self.upper + 1] - first[self.upper]))


def _between(
    model: Model, parts: Sequence[Part[Model]], each: Sequence[Discretisation], problems: Problems
) -> list[_Joint]:
    grounds = [Ground(one.model.plate, one.mesh, one.plate, one.held, one.plate_stiffness) for one in each]
    names = [part.name for part in parts]
    at = []
    for part, one in zip(parts, each, strict=True):
        with placing(part.place):
            at.append(placed(one.model, one.mesh, problems))
    problems.raise_collected()
    result = []
    for index, support in enumerate(model.support):
        if support.between is None:
            continue
        upper, lower = map(names.index, support.between)
        own = parts[upper].numbers["support"].index(index)
        mine = [one for one in at[upper] if one.index == own]
        with placing(parts[upper].place):
            points = points_of(replace(grounds[upper], beneath=grounds[lower]), mine, problems)
        result.append(_Joint(index, upper, lower, replace(points, support=np.full(len(points), index))))
    return result


def _joined(
    model: Model,
    parts: Sequence[Part[Model]],
    each: Sequence[Discretisation],
    joints: Sequence[_Joint],
    problems: Problems,
) -> Discretisation:
    mesh = Mesh.layered([one.mesh for one in each])
    nodes, elements = (
        np.cumsum([0, *counts])
        for counts in ([one.mesh.node_count for one in each], [len(one.mesh.elements) for one in each])
    )
    supports = [np.array(part.numbers["support"], np.int64) for part in parts]
    springs = [
        _moved(one.springs, first, of) for one, first, of in zip(each, elements.tolist(), supports, strict=False)
    ]
    at = list(zip(each, elements.tolist(), supports, strict=False))
    own = [_shared(_moved(one.contacts, first, of), first) for one, first, of in at]
    repeated = [_shared(_moved(one.repeated.points, first, of), first) for one, first, of in at]
    held = _held([one.held for one in each], nodes, supports, mesh)
    between = [_over_both(one, elements) for one in joints]
    acting = [not_held(mesh, held, one) for one in between]
    between = [one.pick(those) for one, those in zip(between, acting, strict=True)]
    joints = [replace(one, points=one.points.pick(those)) for one, those in zip(joints, acting, strict=True)]
    contacts = ContactPoints.join([*own, *between]) if joints else ContactPoints.join(own)
    again = ContactPoints.join(repeated)
    follows = csr_array(block_diag([one.repeated.follows for one in each], "csr"))
    follows = csr_array(hstack([follows, csr_array((len(again), len(contacts) - follows.shape[1]))], "csr"))
    stress_nodes = _stress_nodes(mesh, [one.stress_nodes for one in each], nodes, elements)
    zones, thickness = ZonesOfPlates.join(model, [one.zones for one in each]), _thickness(each, elements)
    whole = Discretisation(
        model,
        tuple(one for plate in each for one in plate.snapped),
        mesh,
        plate_of(mesh, zones, thickness, stress_nodes, held),
        zones,
        thickness,
        stress_nodes,
        _plate_stiffness([one.plate_stiffness for one in each]),
        held,
        Springs.join(springs),
        contacts,
        Repeated(again, follows),
        Sections(mesh, (), np.zeros(0)),
        CasesOfPlates(each),
        Location(np.zeros(0, np.int64), np.zeros((0, 2))),
        np.zeros((0, 2)),
        {name: sum(one.seconds[name] for one in each) for name in each[0].seconds},
    )
    require_preloads(model, mesh, contacts, whole.repeated, problems, between=True)
    problems.raise_collected()
    plates = tuple(_of_whole(parts, each, joints, at, whole) for at in range(len(parts)))
    for part, plate in zip(parts, plates, strict=True):
        with placing(part.place):
            one = plate.own
            of = one.zones, one.thickness, one.held, one.springs, one.contacts
            require_domain(one.model, one.mesh, *of, problems)
    problems.raise_collected()
    return replace(whole, plates=plates)


_Table = TypeVar("_Table", Springs, ContactPoints)


def _moved(table: _Table, first: int, supports: Ints) -> _Table:
    """A plate's springs or points among those of all, whose elements begin with the first one."""
    rows, further = table.rows, table.rows.further
    beyond = Further(further.owners, further.elements + first, further.coefficients)
    moved = Rows(rows.elements + first, rows.coefficients, beyond)
    return replace(table, rows=moved, support=supports[table.support])


def _shared(points: ContactPoints, first: int) -> ContactPoints:
    """The same of points that stand for parts of elements."""
    return replace(points, shared=np.where(points.shared >= 0, points.shared + first, -1))


def _over_both(joint: _Joint, first: Ints) -> ContactPoints:
    """Points between two plates among those of all."""
    points, (upper, lower) = joint.points, joint.rows(first)
    moved = Further(upper.further.owners, upper.further.elements + first[joint.upper], upper.further.coefficients)
    rows = Rows(upper.elements + first[joint.upper], upper.coefficients, moved)
    return _shared(replace(points, rows=rows.beside(lower, int(first[joint.lower]))), int(first[joint.upper]))


def _held(each: Sequence[Held], nodes: Ints, supports: Sequence[Ints], mesh: Mesh) -> Held:
    frames = None
    if any(one.frames is not None for one in each):
        frames = np.concatenate(
            [np.tile([1.0, 0.0], (len(one.bodies.points), 1)) if one.frames is None else one.frames for one in each]
        )
    holders = [
        np.column_stack([one.holders[:, 0] + first, own[one.holders[:, 1]]])
        for one, first, own in zip(each, nodes, supports, strict=False)
    ]
    by = [np.append(own, -1)[one.support] for one, own in zip(each, supports, strict=True)]
    leaders = [one.bodies.leaders + first for one, first in zip(each, nodes, strict=False)]
    bodies = Bodies(
        mesh.points,
        np.concatenate(leaders),
        np.concatenate([one.bodies.inside for one in each]),
        np.concatenate([one.bodies.rigid for one in each]),
    )
    dofs, values, numbers = (
        np.concatenate([getattr(one, key) for one in each]) for key in ("dofs", "values", "numbers")
    )
    return Held(dofs, values, np.concatenate(by), np.concatenate(holders), numbers, frames, bodies)


def _stress_nodes(mesh: Mesh, each: Sequence[StressNodes], nodes: Ints, elements: Ints) -> StressNodes:
    """Those of all plates: the nodes of all meshes, and behind them further ones of all."""
    places = _of_stress(each, nodes)
    return StressNodes(
        mesh,
        np.concatenate([one.further + first for one, first in zip(each, nodes, strict=False)]),
        np.concatenate([one.around + first for one, first in zip(each, elements, strict=False)]),
        np.concatenate([own[one.rows] for one, own in zip(each, places, strict=True)]),
        np.concatenate([one.left_out for one in each]),
    )


def _of_stress(each: Sequence[StressNodes], nodes: Ints) -> list[Ints]:
    """Where the nodes of stresses of every plate are among those of all."""
    further = nodes[-1] + np.cumsum([0, *(len(one.further) for one in each)])
    return [
        np.concatenate([np.arange(a, b), np.arange(c, d)])
        for (a, b), (c, d) in zip(pairwise(nodes), pairwise(further), strict=True)
    ]


def _thickness(each: Sequence[Discretisation], elements: Ints) -> Thickness:
    kind, of = each[0].zones.element, [one.thickness for one in each]
    points = len(_core.section_points(kind)) if len({float(one.at_points[0, 0]) for one in of}) > 1 else 1
    points = max(points, *(one.at_points.shape[1] for one in of))
    count = [len(one.mesh.elements) for one in each]
    at_points, nominal = (
        np.concatenate(
            [np.broadcast_to(getattr(one, key), (many, points)) for one, many in zip(of, count, strict=True)]
        )
        for key in ("at_points", "nominal")
    )
    if points == 1:
        return Thickness(at_points[:1], nominal)
    layered = [
        (one.layered[0] + first, one.layered[1])
        for one, first in zip(of, elements, strict=False)
        if one.layered is not None
    ]
    if not layered:
        return Thickness(at_points, nominal)
    jumping, sections = map(np.concatenate, zip(*layered, strict=True))
    return Thickness(at_points, nominal, (jumping, sections))


def _plate_stiffness(each: Sequence[PlateStiffness]) -> PlateStiffness:
    return PlateStiffness(*(np.concatenate([getattr(one, key) for one in each]) for key in ("in_waves", "in_shear")))


class CasesOfPlates(Cases):
    """Load cases by name, on all plates."""

    def __init__(self, each: Sequence[Discretisation]) -> None:
        self._each = each
        self._names = tuple(dict.fromkeys(case for one in each for case in one.cases))

    def __getitem__(self, case: str) -> CaseLoad:
        """Return a case."""
        if case not in self._names:
            raise KeyError(case)
        return CaseLoad.join([one.load_of(case) for one in self._each])

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(self._names)

    def __len__(self) -> int:
        """Count the cases."""
        return len(self._names)

    def partly_off(self) -> Iterator[tuple[str, str, int, float]]:
        """Where wheels' prints are partly off a plate."""
        for one in self._each:
            yield from one.cases.partly_off()


def _of_whole(
    parts: Sequence[Part[Model]],
    each: Sequence[Discretisation],
    joints: Sequence[_Joint],
    at: int,
    whole: Discretisation,
) -> OfWhole:
    """A plate with what acts between it and others, as its own support, among the arrays of all."""
    one, numbers = each[at], parts[at].numbers["support"]
    starts = np.cumsum([0, *(len(plate.mesh.elements) for plate in each)])
    counts = {key: np.cumsum([0, *(len(getattr(plate, key)) for plate in each)]) for key in ("springs", "contacts")}
    own = np.arange(*counts["contacts"][at : at + 2])
    first, tables, places = int(counts["contacts"][-1]), [one.contacts], [own]
    beneath: dict[int, tuple[int, csr_array]] = {}
    upon = set()
    for joint in joints:
        sides = [joint.upper, joint.lower]
        behind = np.arange(first, first := first + len(joint.points))
        if at not in sides:
            continue
        side, other = sides.index(at), sides[1 - sides.index(at)]
        table = replace(joint.points, rows=joint.rows(starts)[side])
        if side:
            table = replace(table, direction=-table.direction, shared=np.full_like(table.shared, -1))
        number = numbers.index(joint.support)
        if side:
            upon.add(number)
        tables.append(replace(table, support=np.full(len(table), number)))
        places.append(behind)
        if one.model.support[number].area is not None:
            beneath[number] = other, _deflection_at(one.mesh, each[other].mesh)
    contacts = ContactPoints.join(tables)
    follows = csr_array(one.repeated.follows)
    more = csr_array((len(one.repeated), len(contacts) - follows.shape[1]))
    repeated = Repeated(one.repeated.points, csr_array(hstack([follows, more], "csr")))
    again = len(whole.contacts) + np.cumsum([0, *(len(plate.repeated) for plate in each)])
    nodes, elements, springs = (
        slice(*map(int, np.cumsum([0, *counted])[at : at + 2]))
        for counted in (
            [plate.mesh.node_count for plate in each],
            [len(plate.mesh.elements) for plate in each],
            [len(plate.springs) for plate in each],
        )
    )
    ends = np.cumsum([0, *(plate.mesh.node_count for plate in each)])
    return OfWhole(
        parts[at].name,
        replace(one, contacts=contacts, repeated=repeated),
        nodes,
        elements,
        _of_stress([plate.stress_nodes for plate in each], ends)[at],
        springs,
        np.concatenate([*places, np.arange(again[at], again[at + 1])]),
        parts[at].numbers,
        beneath,
        frozenset(upon),
    )


def _deflection_at(mesh: Mesh, other: Mesh) -> csr_array:
    """What takes the deflections (n',) of another plate to those at a plate's nodes (n,), 0 off the other plate."""
    at = other.locate(mesh.points)
    (on,) = np.nonzero(at.inside)
    values = other.shape_functions(at.elements[on], at.xi[on])
    columns = other.elements[at.elements[on]]
    rows = np.repeat(on, 8)
    return csr_array((values.ravel(), (rows, columns.ravel())), shape=(mesh.node_count, other.node_count))
