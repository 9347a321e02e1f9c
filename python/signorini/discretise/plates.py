"""Several plates: each plate is discretised, then all plates and their contacts are joined in one discretisation."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.sparse import block_diag, csr_array, hstack

from signorini import _core
from signorini.base.arguments import made_by
from signorini.discretise.discretisation import Discretisation, OfWhole, discretise_plate, plate_of
from signorini.discretise.domain import require_domain
from signorini.discretise.held import Bodies, Held
from signorini.discretise.loads import CaseLoad, Cases
from signorini.discretise.placed import placed
from signorini.discretise.points import ContactPoints
from signorini.discretise.preloads import require_preloads
from signorini.discretise.punching import Columns
from signorini.discretise.repeated import Repeated, not_held
from signorini.discretise.rows import Further, Ints, Rows
from signorini.discretise.sections import Sections
from signorini.discretise.stressnodes import StressNodes
from signorini.discretise.supports import SupportedPlate, points_of, require_on_plate
from signorini.discretise.thickness import PlateStiffness, Thickness
from signorini.discretise.zones import ZonesOfPlates
from signorini.errors import Problems, placing
from signorini.mesh import Location, Mesh
from signorini.model import Model
from signorini.model.parts import Part


def discretise(model: Model, mesh: Mesh | Sequence[Mesh] | None = None) -> Discretisation:
    """Discretise a model: mesh its plates, unless ``mesh`` is given, and convert supports and loads to arrays.

    ``mesh`` is the mesh of a single plate, or a list with the mesh of each plate.
    """
    made_by(model, Model, _advice(model), "model")
    meshes: list[Mesh | None] = [mesh] if isinstance(mesh, Mesh) else list(mesh or ())
    if not model.plates:
        return discretise_plate(model, *meshes)
    parts, problems = model.parts, Problems()
    each: list[Discretisation] = []
    for part, own in zip(parts, meshes or [None] * len(parts), strict=True):
        with placing(part.place), problems.collected():
            each.append(discretise_plate(part.model, own))
    problems.raise_collected()
    joints = _between(model, parts, each, problems)
    problems.raise_collected()
    return _joined(model, parts, each, joints, problems)


def _advice(argument: object) -> str:
    """Advice for messages: how to make a model from the argument that was passed in place of a model."""
    match argument:
        case str() | os.PathLike():
            return "Load the file first: signorini.load(file)."
        case Mapping():
            return "Make a Model from the mapping first: signorini.validate(mapping)."
        case _:
            return "Make one with signorini.Model(...) or signorini.load(file)."


@dataclass(frozen=True, eq=False)
class _Joint:
    """Contact points of a support between two plates.

    Their rows are over the dofs of both plates, with elements of the upper plate first. ``support``, ``upper`` and
    ``lower`` are indices in the whole model.
    """

    support: int
    upper: int
    lower: int
    points: ContactPoints

    def rows(self, first: Ints) -> tuple[Rows, Rows]:
        """Rows over the upper and rows over the lower plate; ``first`` is the index of each plate's first element."""
        return self.points.rows.split(int(first[self.upper + 1] - first[self.upper]))


def _between(
    model: Model, parts: Sequence[Part[Model]], each: Sequence[Discretisation], problems: Problems
) -> list[_Joint]:
    grounds = [
        SupportedPlate(plate.model.plate, plate.mesh, plate.plate, plate.held, plate.plate_stiffness) for plate in each
    ]
    names = [part.name for part in parts]
    placements = []
    for part, plate in zip(parts, each, strict=True):
        with placing(part.place):
            placements.append(placed(plate.model, plate.mesh, problems))
    problems.raise_collected()
    result = []
    for index, support in enumerate(model.support):
        if support.between is None:
            continue
        upper, lower = map(names.index, support.between)
        on_upper, on_lower = (
            [each for each in placements[plate] if each.index == parts[plate].numbers["support"].index(index)]
            for plate in (upper, lower)
        )
        with placing(parts[lower].place), problems.collected():
            for one in on_lower:
                require_on_plate(grounds[lower], one)
        problems.raise_collected()
        with placing(parts[upper].place):
            points = points_of(replace(grounds[upper], beneath=grounds[lower]), on_upper, problems)
        result.append(_Joint(index, upper, lower, replace(points, support=np.full(len(points), index))))
    return result


def _joined(
    model: Model,
    parts: Sequence[Part[Model]],
    each: Sequence[Discretisation],
    joints: Sequence[_Joint],
    problems: Problems,
) -> Discretisation:
    mesh = Mesh.layered([plate.mesh for plate in each])
    nodes, elements = (np.cumsum([0, *map(count, each)]) for count in _COUNTS[:2])
    supports = [np.array(part.numbers["support"], np.int64) for part in parts]
    offsets = list(zip(each, elements.tolist(), supports, strict=False))
    springs = [_offset(plate.springs, first, indices) for plate, first, indices in offsets]
    contacts_of_plates = [_offset(plate.contacts, first, indices) for plate, first, indices in offsets]
    repeated = [_offset(plate.repeated.points, first, indices) for plate, first, indices in offsets]
    held = _held([plate.held for plate in each], nodes, elements, supports, mesh)
    between = [_over_both(joint, elements) for joint in joints]
    free = [not_held(mesh, held, points) for points in between]
    between = [points.pick(kept) for points, kept in zip(between, free, strict=True)]
    joints = [replace(joint, points=joint.points.pick(kept)) for joint, kept in zip(joints, free, strict=True)]
    contacts = ContactPoints.join([*contacts_of_plates, *between])
    redundant = ContactPoints.join(repeated)
    follows = csr_array(block_diag([plate.repeated.follows for plate in each], "csr"))
    follows = csr_array(hstack([follows, csr_array((len(redundant), len(contacts) - follows.shape[1]))], "csr"))
    stress_nodes = _stress_nodes(mesh, [plate.stress_nodes for plate in each], nodes, elements)
    zones, thickness = ZonesOfPlates.join(model, [plate.zones for plate in each]), _thickness(each, elements)
    whole = Discretisation(
        model,
        tuple(snapped for plate in each for snapped in plate.snapped),
        mesh,
        plate_of(mesh, zones, thickness, stress_nodes, held),
        zones,
        thickness,
        stress_nodes,
        _plate_stiffness([plate.plate_stiffness for plate in each]),
        held,
        ContactPoints.join(springs),
        contacts,
        Repeated(redundant, follows),
        Sections(mesh, (), np.zeros(0)),
        Columns(mesh, ()),
        CasesOfPlates(each),
        Location(np.zeros(0, np.int64), np.zeros((0, 2))),
        np.zeros((0, 2)),
        {name: sum(plate.seconds[name] for plate in each) for name in each[0].seconds},
    )
    require_preloads(model, mesh, contacts, whole.repeated, problems, between=True)
    problems.raise_collected()
    plates = tuple(_of_whole(parts, each, joints, index, whole) for index in range(len(parts)))
    for part, plate in zip(parts, plates, strict=True):
        with placing(part.place):
            plate_alone = plate.own
            arrays = (
                plate_alone.zones,
                plate_alone.thickness,
                plate_alone.held,
                plate_alone.springs,
                plate_alone.contacts,
            )
            require_domain(plate_alone.model, plate_alone.mesh, *arrays, problems)
    problems.raise_collected()
    return replace(whole, plates=plates)


_COUNTS: tuple[Callable[[Discretisation], int], ...] = (
    lambda plate: plate.mesh.node_count,
    lambda plate: len(plate.mesh.elements),
    lambda plate: len(plate.springs),
    lambda plate: len(plate.contacts),
    lambda plate: len(plate.repeated),
)
"""Functions that count the nodes, elements, springs, contact points and redundant points of a plate."""


def _offset(points: ContactPoints, first: int, supports: Ints) -> ContactPoints:
    """Points of one plate with indices into the joined arrays, in which the plate's elements begin at ``first``.

    ``supports`` are the indices of the plate's supports in the whole model.
    """
    rows, further = points.rows, points.rows.further
    beyond = Further(further.owners, further.elements + first, further.coefficients)
    moved = Rows(rows.elements + first, rows.coefficients, beyond)
    return _offset_shared(replace(points, rows=moved, support=supports[points.support]), first)


def _offset_shared(points: ContactPoints, first: int) -> ContactPoints:
    return replace(points, shared=np.where(points.shared >= 0, points.shared + first, -1))


def _over_both(joint: _Joint, first: Ints) -> ContactPoints:
    """Contact points between two plates, with element indices of the joined arrays."""
    points, (upper, lower) = joint.points, joint.rows(first)
    moved = Further(upper.further.owners, upper.further.elements + first[joint.upper], upper.further.coefficients)
    rows = Rows(upper.elements + first[joint.upper], upper.coefficients, moved)
    return _offset_shared(replace(points, rows=rows.extended(lower, int(first[joint.lower]))), int(first[joint.upper]))


def _held(each: Sequence[Held], nodes: Ints, elements: Ints, supports: Sequence[Ints], mesh: Mesh) -> Held:
    frames = None
    if any(held.frames is not None for held in each):
        frames = np.concatenate(
            [np.tile([1.0, 0.0], (len(held.bodies.points), 1)) if held.frames is None else held.frames for held in each]
        )
    of_nodes = [
        _offset(held.points, first, indices) for held, first, indices in zip(each, elements, supports, strict=False)
    ]
    support = [np.append(indices, -1)[held.support] for held, indices in zip(each, supports, strict=True)]
    leaders = [held.bodies.leaders + first for held, first in zip(each, nodes, strict=False)]
    bodies = Bodies(
        mesh.points,
        np.concatenate(leaders),
        np.concatenate([held.bodies.inside for held in each]),
        np.concatenate([held.bodies.rigid for held in each]),
    )
    dofs, values = (np.concatenate([getattr(held, key) for held in each]) for key in ("dofs", "values"))
    at = np.concatenate([held.nodes + first for held, first in zip(each, nodes, strict=False)])
    return Held(dofs, values, np.concatenate(support), at, ContactPoints.join(of_nodes), frames, bodies)


def _stress_nodes(mesh: Mesh, each: Sequence[StressNodes], nodes: Ints, elements: Ints) -> StressNodes:
    """Stress nodes of all plates joined: all mesh nodes, followed by the further nodes of each plate."""
    places = _of_stress(each, nodes)
    return StressNodes(
        mesh,
        np.concatenate([stress_nodes.further + first for stress_nodes, first in zip(each, nodes, strict=False)]),
        np.concatenate([stress_nodes.around + first for stress_nodes, first in zip(each, elements, strict=False)]),
        np.concatenate([indices[stress_nodes.rows] for stress_nodes, indices in zip(each, places, strict=True)]),
        np.concatenate([stress_nodes.left_out for stress_nodes in each]),
    )


def _of_stress(each: Sequence[StressNodes], nodes: Ints) -> list[Ints]:
    """For each plate, the indices of its stress nodes in the joined stress nodes."""
    further = nodes[-1] + np.cumsum([0, *(len(stress_nodes.further) for stress_nodes in each)])
    return [
        np.concatenate([np.arange(a, b), np.arange(c, d)])
        for (a, b), (c, d) in zip(pairwise(nodes), pairwise(further), strict=True)
    ]


def _thickness(each: Sequence[Discretisation], elements: Ints) -> Thickness:
    kind, thicknesses = each[0].zones.element, [thickness.thickness for thickness in each]
    points = (
        len(_core.section_points(kind))
        if len({float(thickness.at_points[0, 0]) for thickness in thicknesses}) > 1
        else 1
    )
    points = max(points, *(thickness.at_points.shape[1] for thickness in thicknesses))
    count = [len(thickness.mesh.elements) for thickness in each]
    at_points, nominal = (
        np.concatenate(
            [
                np.broadcast_to(getattr(thickness, key), (many, points))
                for thickness, many in zip(thicknesses, count, strict=True)
            ]
        )
        for key in ("at_points", "nominal")
    )
    if points == 1:
        return Thickness(at_points[:1], nominal)
    layered = [
        (thickness.layered[0] + first, thickness.layered[1])
        for thickness, first in zip(thicknesses, elements, strict=False)
        if thickness.layered is not None
    ]
    if not layered:
        return Thickness(at_points, nominal)
    jumping, sections = map(np.concatenate, zip(*layered, strict=True))
    return Thickness(at_points, nominal, (jumping, sections))


def _plate_stiffness(each: Sequence[PlateStiffness]) -> PlateStiffness:
    return PlateStiffness(
        *(np.concatenate([getattr(stiffness, key) for stiffness in each]) for key in ("in_waves", "in_shear"))
    )


class CasesOfPlates(Cases):
    """Load cases of several plates by name."""

    def __init__(self, each: Sequence[Discretisation]) -> None:
        self._each = each
        self._names = tuple(dict.fromkeys(case for plate in each for case in plate.cases))

    def __getitem__(self, case: str) -> CaseLoad:
        """Return the load of a case on all plates."""
        if case not in self._names:
            raise KeyError(case)
        return CaseLoad.join([plate.load_of(case) for plate in self._each])

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the load cases."""
        return iter(self._names)

    def __len__(self) -> int:
        """Return the number of load cases."""
        return len(self._names)

    def partly_off(self) -> Iterator[tuple[str, str, int, float]]:
        """Yield wheels whose footprints are partly off a plate, in the form of `Cases.partly_off`."""
        for plate in self._each:
            yield from plate.cases.partly_off()


def _of_whole(
    parts: Sequence[Part[Model]],
    each: Sequence[Discretisation],
    joints: Sequence[_Joint],
    index: int,
    whole: Discretisation,
) -> OfWhole:
    """Plate with index ``index`` as `OfWhole`; contacts with other plates are among its contact points."""
    plate, numbers = each[index], parts[index].numbers["support"]
    nodes, elements, springs, contacts, redundant = (np.cumsum([0, *map(count, each)]) for count in _COUNTS)
    tables, places = [plate.contacts], [np.arange(contacts[index], contacts[index + 1])]
    first = int(contacts[-1])
    beneath: dict[int, tuple[int, csr_array]] = {}
    upon = set()
    for joint in joints:
        sides = [joint.upper, joint.lower]
        indices = np.arange(first, first := first + len(joint.points))
        if index not in sides:
            continue
        side, other = sides.index(index), sides[1 - sides.index(index)]
        table = replace(joint.points, rows=joint.rows(elements)[side])
        number = numbers.index(joint.support)
        if side:
            table = replace(table, direction=-table.direction, shared=np.full_like(table.shared, -1))
            upon.add(number)
        tables.append(replace(table, support=np.full(len(table), number)))
        places.append(indices)
        if plate.model.support[number].area is not None:
            beneath[number] = int(nodes[other]), _deflection_at(plate.mesh, each[other].mesh)
    joined = ContactPoints.join(tables)
    follows = csr_array(plate.repeated.follows)
    empty = csr_array((len(plate.repeated), len(joined) - follows.shape[1]))
    repeated = Repeated(plate.repeated.points, csr_array(hstack([follows, empty], "csr")))
    own_redundant = len(whole.contacts) + np.arange(redundant[index], redundant[index + 1])
    node_slice, element_slice, spring_slice = (
        slice(*map(int, starts[index : index + 2])) for starts in (nodes, elements, springs)
    )
    return OfWhole(
        parts[index].name,
        replace(plate, contacts=joined, repeated=repeated),
        node_slice,
        element_slice,
        _of_stress([each_plate.stress_nodes for each_plate in each], nodes)[index],
        spring_slice,
        np.concatenate([*places, own_redundant]),
        parts[index].numbers,
        beneath,
        frozenset(upon),
    )


def _deflection_at(mesh: Mesh, other: Mesh) -> csr_array:
    """Matrix (n, n') that interpolates deflections (n',) of ``other`` at nodes (n,) of ``mesh``; 0 off ``other``."""
    where = other.locate(mesh.points)
    (inside,) = np.nonzero(where.inside)
    values = other.shape_functions(where.elements[inside], where.xi[inside])
    columns = other.elements[where.elements[inside]]
    rows = np.repeat(inside, 8)
    return csr_array((values.ravel(), (rows, columns.ravel())), shape=(mesh.node_count, other.node_count))
