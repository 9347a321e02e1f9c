"""Discretisation of a model: mesh, stiffness of the plate, prescribed dofs, springs, contact points and loads."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array

from signorini import _core
from signorini.base.arguments import known, made_by
from signorini.base.remade import Remade
from signorini.base.reuse import shared
from signorini.discretise.domain import require_domain
from signorini.discretise.held import Bodies, Held, hold
from signorini.discretise.laws import is_unyielding
from signorini.discretise.loads import CaseLoad, Cases, case_loads, loaded_sides
from signorini.discretise.meshing import mesh_of
from signorini.discretise.placed import placed
from signorini.discretise.places import located, sides_beside
from signorini.discretise.points import ContactPoints, Parts, parts_of
from signorini.discretise.preloads import require_preloads
from signorini.discretise.punching import Columns
from signorini.discretise.repeated import (
    Repeated,
    Shared,
    followers,
    lengths,
    parallel,
    shared_by,
    that_can_act,
    times,
    within,
)
from signorini.discretise.rows import Bools, Floats, Ints, Rows
from signorini.discretise.sections import Sections
from signorini.discretise.snapping import Snapped
from signorini.discretise.stressnodes import Sides, StressNodes, solid_thickness, stress_nodes_of
from signorini.discretise.supports import SupportedPlate, springs_and_contacts
from signorini.discretise.thickness import PlateStiffness, Thickness, thickness_of
from signorini.discretise.zones import Zones
from signorini.errors import InputError, Problems
from signorini.mesh import Location, Mesh
from signorini.model import Combination, Model
from signorini.model.parts import ON_PLATES

__all__ = ["CaseLoad", "ContactPoints", "Discretisation", "Held", "Repeated", "Rows"]

_plate = shared(_core.Plate)


@dataclass(frozen=True, eq=False, repr=False)
class Discretisation(Remade):
    """A model as arrays: n nodes with three dofs (w, θ1, θ2) each, ordered by node.

    θ1, θ2 are θx, θy, except at nodes with axes of their own (``held.frames``). Nodes of a rigid body (``held.bodies``)
    are slaves of one leader node: displacements are expanded to the slaves, rows and loads act on the leader.
    """

    model: Model
    snapped: tuple[Snapped, ...]
    mesh: Mesh
    plate: _core.Plate
    zones: Zones
    thickness: Thickness
    stress_nodes: StressNodes
    plate_stiffness: PlateStiffness
    held: Held
    springs: ContactPoints
    contacts: ContactPoints
    repeated: Repeated
    sections: Sections
    columns: Columns
    cases: Cases
    probes: Location
    probe_positions: Floats
    seconds: Mapping[str, float]
    plates: tuple[OfWhole, ...] = ()
    """Plates whose arrays are joined in this discretisation; empty for a model of one plate."""
    tightening: tuple[float, ...] = ()
    """Factors (t,) of the bolt forces in the t rounds of tightening, as `Model.round_factors` gives them."""

    _made = MappingProxyType({"plate": lambda result: result.made()})

    @property
    def members(self) -> tuple[OfWhole, ...]:
        """The plates with their indices into the joined arrays; for a model of one plate, this plate alone."""
        return self.plates or (OfWhole.alone(self),)

    @property
    def each(self) -> tuple[Discretisation, ...]:
        """Discretisations of the plates; for a model of one plate, this discretisation alone."""
        return tuple(plate.own for plate in self.members)

    @property
    def dof_count(self) -> int:
        """Number of dofs 3n, including held dofs."""
        return 3 * self.mesh.node_count

    @cached_property
    def points(self) -> ContactPoints:
        """The m contact points, followed by the r redundant points of ``repeated``."""
        return ContactPoints.join([self.contacts, self.repeated.points])

    @cached_property
    def parts(self) -> tuple[Parts, ...]:
        """For each support, the indices of its held nodes, springs and ``points``."""
        return parts_of(len(self.model.support), self.held.nodes, self.held.points, self.springs, self.points)

    def made(self) -> _core.Plate:
        """Make the core's element data of the plate, or of all plates joined."""
        return plate_of(self.mesh, self.zones, self.thickness, self.stress_nodes, self.held)

    def over_dofs(self, rows: Rows) -> csr_array:
        """G B (m, 3n): rows as a sparse matrix, with dofs of slave nodes replaced by those of their leaders."""
        return self.held.bodies.onto_leaders(rows.matrix(self.mesh.elements, self.dof_count))

    @cached_property
    def shared(self) -> list[Shared]:
        """Groups of ``points`` whose reactions are not unique, because their rows are linearly dependent."""
        return shared_by(self.model, self.mesh, self.held, self.points)

    def by_sign(self, reaction: Floats) -> Floats:
        """Unique part of the reactions in groups of `shared` in which some points push up and others down.

        ``reaction`` (m + r,) belongs to ``points``; the result has one entry for each point of such a group. The result
        is orthogonal to every redistribution of reactions within the group. Its sign decides which points of the group
        carry the reaction.
        """
        parts = [np.zeros(0)]
        for group in self.shared:
            direction = np.where(self.points.two_sided, 0.0, self.points.direction)[group.points]
            if np.ptp(direction):
                of_group = reaction[group.points]
                parts.append(of_group - group.ways @ (group.ways.T @ of_group))
        return np.concatenate(parts)

    @property
    def repeats_itself(self) -> bool:
        """Whether rows of rigid contact points are linearly dependent, so that their gaps can contradict each other."""
        rigid = np.flatnonzero((self.contacts.compliance == 0) & ~self.contacts.slope)
        free = within(self.contact_rows[rigid], ~self.held.dofs)
        group, _ = parallel(free)
        return len(np.unique(group)) < len(group) or bool(len(followers(times(free, 1.0 / lengths(free))).rows))

    @cached_property
    def share_weights(self) -> Floats:
        """Weights (m + r,) of ``points`` in the least norm of reactions; A is the area of the plate.

        The weight is 1 for a listed point, length/√A on a line, area/A on an area.
        """
        dimension = np.array([{"at": 0, "area": 2}.get(support.place, 1) for support in self.model.support])
        size = np.sqrt(self.mesh.element_area.sum())
        return np.asarray(self.points.weights / size ** dimension[self.points.support])

    @cached_property
    def held_together(self) -> tuple[frozenset[int], ...]:
        """Sets of supports that hold the deflection of the same nodes.

        Two lines that share only a corner node make no set: each line carries half of the corner's reaction.
        """
        nodes, holders = self.held.nodes, self.held.points.support
        _, first, count = np.unique(nodes, return_index=True, return_counts=True)
        middles = np.zeros(self.mesh.node_count, np.bool_)
        middles[self.mesh.unique_sides[:, 1]] = True
        sets = (
            frozenset(holders[begin : begin + many].tolist())
            for begin, many in zip(first, count, strict=True)
            if many > 1
            and (
                middles[nodes[begin]]
                or any(self.model.support[index].at is not None for index in holders[begin : begin + many].tolist())
            )
        )
        return tuple(dict.fromkeys(sets))

    @cached_property
    def contact_rows(self) -> csr_array:
        """Rows G (m, 3n) of the m contact points."""
        return self.over_dofs(self.contacts.rows)

    @cached_property
    def point_rows(self) -> csr_array:
        """Rows (m + r, 3n) of the contact points, followed by rows of the redundant points.

        Over the free dofs, a redundant row is a linear combination of rows of contact points; over held dofs, it need
        not be.
        """
        if not len(self.repeated.points):
            return self.contact_rows
        return self.over_dofs(self.points.rows)

    @cached_property
    def off_areas(self) -> tuple[Bools, Bools]:
        """Masks of ``points`` (m + r,) and springs (s,) that act at points or on lines, not on areas or footprints."""
        off = np.array([support.on_nodes for support in self.model.support], np.bool_)
        return off[self.points.support], off[self.springs.support]

    @cached_property
    def spring_rows(self) -> csr_array:
        """Rows (s, 3n) of the springs."""
        return self.over_dofs(self.springs.rows)

    def spring_forces(self, hi: Floats, lo: Floats, base: Floats | None = None) -> Floats:
        """Upward forces −k (row·u − base) (..., s) of springs at displacements u = hi + lo (..., 3n).

        ``base`` (s,), if not None, replaces ``springs.distance``. Products are summed in extended precision: travels of
        stiff springs are as small as the rounding of u.
        """
        springs = self.springs
        if hi.ndim > 1:
            return np.array([self.spring_forces(*displacement, base) for displacement in zip(hi, lo, strict=True)])
        at_rest = springs.distance if base is None else base
        return -springs.stiffness * self.plate.openings(*springs.rows.arrays, at_rest, hi, lo)

    def through(self, load: CaseLoad, hi: Floats, lo: Floats, reaction: Floats, pull: Floats) -> Floats:
        """Moment, twist and shear (3s,) of each section, then their means over the width at each station of a strip.

        The plate is in equilibrium under ``load`` with displacements u = hi + lo (3n,), reactions (m + r,) of
        ``points`` and upward forces ``pull`` (k,) of springs.
        """
        if not len(self.sections.per):
            return np.zeros(0)
        of_points, of_springs = self._reactions_through
        within = self.sections.within(self.plate, hi, lo, load.curvature, load.couples)
        forces = within + load.through + of_points[:, : len(reaction)] @ reaction + of_springs @ pull
        return np.asarray(forces / np.repeat(self.sections.per, 3))

    @cached_property
    def cut_lengths(self) -> Floats:
        """Lengths (s,) on the plate of all sections, then of the cross lines at all stations of strips."""
        result: dict[tuple[str, int], Floats] = {}
        for plate in self.members:
            first = len(plate.own.model.section)
            cut = plate.own.sections.lengths
            ends = first + np.cumsum([0, *(strip.stations for strip in plate.own.model.strip)])
            result |= {("section", number): cut[i : i + 1] for i, number in enumerate(plate.numbers["section"])}
            result |= {("strip", number): cut[ends[i] : ends[i + 1]] for i, number in enumerate(plate.numbers["strip"])}
        return np.concatenate([np.zeros(0), *(result[key] for key in sorted(result))])

    @cached_property
    def _reactions_through(self) -> tuple[csr_array, csr_array]:
        """Moment, twist and shear of sections per unit reaction of ``points`` (3s, m + r), and of springs (3s, k)."""
        at_sections = self.sections.of_supports
        return at_sections(self.model.support, self.points), at_sections(self.model.support, self.springs)

    @cached_property
    def rigid_motions(self) -> Floats:
        """Rigid-body modes R (3n, 3p) of p plates: w = 1, w = x − x0, w = y − y0 on each, with (x0, y0) = `middle`."""
        motions, members = self.held.rigid_motions(self.mesh.points, self.middle), self.members
        result = np.zeros((len(motions), 3 * len(members)))
        for number, plate in enumerate(members):
            result[plate.dofs, 3 * number : 3 * number + 3] = motions[plate.dofs]
        return result

    @cached_property
    def scaled_motions(self) -> Floats:
        """Rigid-body modes (3n, 3p) with rotations divided by the mesh size L: all deflections are of order one."""
        return np.asarray(self.rigid_motions / self.sizes)

    @property
    def sizes(self) -> Floats:
        """Divisor (3p,) of each mode in `scaled_motions`: 1 for the deflection, the mesh size L for rotations."""
        return np.tile([1.0, self.mesh.size, self.mesh.size], len(self.members))

    def in_motions(self, positions: Floats, elements: Ints) -> Floats:
        """Deflections (q, 3p) of the rigid-body modes `scaled_motions` at positions (q, 2) in elements (q,)."""
        linear = np.column_stack([np.ones(len(positions)), (positions - self.middle) / self.mesh.size])
        firsts = [plate.elements.start for plate in self.members]
        result = np.zeros((len(linear), len(firsts), 3))
        result[np.arange(len(linear)), np.searchsorted(firsts, elements, side="right") - 1] = linear
        return result.reshape(len(linear), 3 * len(firsts))

    def moved(self, hi: Floats, lo: Floats, motions: Floats) -> tuple[Floats, Floats]:
        """Displacements u = hi + lo (3n,) plus rigid motions (3p,): for each plate w and two slopes about `middle`."""
        x, y = self.middle.tolist()
        moved = [
            part.own.plate.moved(hi[part.dofs], lo[part.dofs], (x, y), (w, tx, ty))
            for part, (w, tx, ty) in zip(self.members, motions.reshape(-1, 3).tolist(), strict=True)
        ]
        return np.concatenate([high for high, _ in moved]), np.concatenate([low for _, low in moved])

    @cached_property
    def probe_sides(self) -> Sides:
        """Location of every probe in each element that contains the probe, since values may jump between elements."""
        return self.stress_nodes.sides(self.probe_positions, self.probes)

    @cached_property
    def node_thickness(self) -> Floats:
        """Thickness (s,) at the stress nodes; NaN where the section is given by its stiffness."""
        result = np.empty(self.stress_nodes.count)
        for plate in self.members:
            result[plate.stress_nodes] = solid_thickness(plate.own.stress_nodes, plate.own.zones)
        return result

    @cached_property
    def probe_thickness(self) -> Floats:
        """Thickness (q,) at probes; NaN where the section is given by its stiffness, and where the thickness jumps."""
        return self.probe_sides.alike(self.stress_nodes.at(self.probe_sides, self.node_thickness))

    @property
    def middle(self) -> Floats:
        """Middle (2,) of the bounding box of the mesh."""
        return self.mesh.middle

    @cached_property
    def no_load(self) -> CaseLoad:
        """The load that is zero everywhere."""
        if self.plates:
            return CaseLoad.join([plate.own.no_load for plate in self.plates])
        return CaseLoad.none(self.mesh.node_count, len(self.mesh.elements))

    def load_of(self, case: str) -> CaseLoad:
        """Load of the load case ``case``; zero if the case acts only on other plates."""
        return self.cases[case] if case in self.cases else replace(self.no_load, acting=frozenset([case]))

    def tightened(self, contacts: ContactPoints, tightening: tuple[float, ...]) -> Discretisation:
        """Copy with the contact points ``contacts``, whose bolts are tightened with the factors ``tightening`` (t,)."""
        plates = []
        for plate in self.plates:
            contacts_of_plate, changed = plate.own.contacts, contacts.pick(plate.points[: len(plate.own.contacts)])
            moved = replace(
                contacts_of_plate,
                distance=changed.distance,
                settlement=changed.settlement,
                tightened_to=changed.tightened_to,
                preload=changed.preload,
            )
            plates.append(replace(plate, own=plate.own.tightened(moved, tightening)))
        return replace(self, contacts=contacts, tightening=tightening, plates=tuple(plates))

    def load(self, combination: Combination) -> CaseLoad:
        """Load of a combination: sum of its load cases times their factors."""
        made_by(combination, Combination, "Take one of model.effective_combinations.", "combination")
        total = self.no_load
        for case, factor in (combination.factors or {}).items():
            total = total + factor * self.cases[known(case, self.cases, "load case", "factors")]
        return total


def discretise_plate(model: Model, mesh: Mesh | None = None) -> Discretisation:
    """Discretise one plate: mesh it, unless ``mesh`` is given, and convert its supports and loads to arrays."""
    begun = time.perf_counter()
    mesh, model, moved = mesh_of(model, mesh)
    meshed = time.perf_counter()
    problems = Problems()
    placements = placed(model, mesh, problems)
    supports = [each for each in placements if each.support.between is None]
    loaded = loaded_sides(model, mesh, problems)
    # If the input's thickness is wrong, this placeholder is used instead, to find all other errors in the input.
    thickness, zones = Thickness(*np.full((2, 1, 1), mesh.size)), Zones.of(model, mesh, problems)
    bodies = Bodies.of(mesh, zones, problems)
    held = hold(mesh, supports, bodies, problems)
    stress_nodes = StressNodes.of_mesh(mesh)
    with problems.collected():
        along = [sides_beside(mesh, each.support.where, each.sides) for each in placements]
        along += [sides_beside(mesh, model.load[index].where, sides) for index, sides in loaded.items()]
        rigid = [each.support for each in placements if is_unyielding(each.support)]
        areas = [support.where.region for support in rigid if support.where.region is not None]
        thickness, stress_nodes = thickness_of(mesh, zones), stress_nodes_of(mesh, zones, along, areas, bodies.rigid)
    plate = plate_of(mesh, zones, thickness, stress_nodes, held)
    stiffness = PlateStiffness.of(mesh, zones, thickness.at_points)
    supported = SupportedPlate(model.plate, mesh, plate, held, stiffness)
    springs, contacts = springs_and_contacts(supported, supports, problems)
    sections = Sections.of(model, mesh, plate, held, problems)
    columns = Columns.of(zones, mesh, problems)
    static = case_loads(zones, mesh, plate, held, sections, columns, loaded, problems)
    probes = [Location(np.zeros(0, np.int64), np.zeros((0, 2)))]
    for index, probe in enumerate(model.probe):
        with problems.collected():
            points = located(mesh, probe.at, ("probe", index, "at"))
            probes.append(Location(points.elements, points.xi))
    for index, profile in enumerate(model.profile):
        if not mesh.locate(profile.places[1]).inside.any():
            with problems.collected():
                raise InputError("No station of the profile is on the plate. Move its line.", ("profile", index))
    problems.raise_collected()
    # If this plate has supports to other plates, module `plates` checks the domain of all plates with these supports.
    if not any(support.between for support in model.support):
        require_domain(model, mesh, zones, thickness, held, springs, contacts, problems)
    problems.raise_collected()
    contacts, repeated = that_can_act(model, mesh, held, contacts)
    require_preloads(model, mesh, contacts, repeated, problems)
    problems.raise_collected()
    assembled = time.perf_counter()
    seconds = {"mesh": meshed - begun, "assemble": assembled - meshed}
    return Discretisation(
        model,
        moved,
        mesh,
        plate,
        zones,
        thickness,
        stress_nodes,
        stiffness,
        held,
        springs,
        contacts,
        repeated,
        sections,
        columns,
        Cases(static, model.moving, mesh, sections, columns),
        Location(np.concatenate([where.elements for where in probes]), np.concatenate([where.xi for where in probes])),
        np.array([position for probe in model.probe for position in probe.at]).reshape(-1, 2),
        seconds,
    )


def plate_of(mesh: Mesh, zones: Zones, thickness: Thickness, stress_nodes: StressNodes, held: Held) -> _core.Plate:
    """Make the core's element data, for one plate or for several plates joined."""
    try:
        return _plate(
            *elements_for_core(mesh, zones, thickness, held),
            stress_nodes.elements if len(stress_nodes.further) else None,
            held.bodies.leaders if held.bodies.inside.any() else None,
        )
    except ValueError as error:
        raise InputError(f"{error}. Change the mesh or the thickness.", place=("plate",)) from None


class ElementsForCore(NamedTuple):
    """Leading arguments of the constructor `_core.Plate`: nodes (n, 2), elements (ne, 8) and their sections."""

    points: Floats
    elements: Ints
    thickness: float | Floats
    young: float
    rigidities: Floats
    kind: str
    frames: Floats | None
    layered: tuple[Ints, Floats] | None
    others: tuple[Ints, Floats, Floats] | None


def elements_for_core(mesh: Mesh, zones: Zones, thickness: Thickness, held: Held) -> ElementsForCore:
    """Convert nodes, elements and sections of a plate to the arguments of `_core.Plate`."""
    others = None
    if len(zones.rigidities) > 1:
        units = np.array([rigidity.for_core for rigidity in zones.rigidities[1:]])
        others = zones.of_elements.rigidity, zones.young[1:], units
    return ElementsForCore(
        mesh.points,
        mesh.elements,
        thickness.for_core,
        float(zones.young[0]),
        zones.rigidities[0].for_core,
        zones.element,
        held.frames,
        thickness.layered,
        others,
    )


@dataclass(frozen=True, eq=False, repr=False)
class OfWhole(Remade):
    """One plate of a model with several: its discretisation ``own``, and indices into the joined arrays of all plates.

    These indices are ``nodes``, ``elements``, ``stress_nodes`` (s,), ``springs`` and ``points`` (m + r,). ``numbers``
    maps each key, such as "load", to the indices of the plate's loads in the whole model.

    ``beneath`` has an entry for each area support of this plate against another plate: the first node of the other
    plate, and the matrix (n, n') that interpolates the other plate's deflections at this plate's nodes. ``upon`` are
    indices of the supports through which other plates rest on this plate.
    """

    name: str
    own: Discretisation
    nodes: slice
    elements: slice
    stress_nodes: Ints
    springs: slice
    points: Ints
    numbers: Mapping[str, tuple[int, ...]]
    beneath: Mapping[int, tuple[int, csr_array]]
    upon: frozenset[int]

    @classmethod
    def alone(cls, plate: Discretisation) -> OfWhole:
        """Make the only member of `Discretisation.members` of a model of one plate."""
        model = plate.model
        return cls(
            "",
            plate,
            slice(0, plate.mesh.node_count),
            slice(0, len(plate.mesh.elements)),
            np.arange(plate.stress_nodes.count),
            slice(0, len(plate.springs)),
            np.arange(len(plate.points)),
            {key: tuple(range(len(getattr(model, key)))) for key in ON_PLATES},
            {},
            frozenset(),
        )

    def deflections_beneath(self, deflection: Floats) -> dict[int, Floats]:
        """For each support in ``beneath``, the deflections (n,) of the other plate at this plate's nodes.

        ``deflection`` (N,) are the deflections of all plates.
        """
        return {
            number: matrix @ deflection[first : first + matrix.shape[1]]
            for number, (first, matrix) in self.beneath.items()
        }

    @property
    def dofs(self) -> slice:
        """Indices of this plate's dofs among the dofs of all plates."""
        return slice(3 * self.nodes.start, 3 * self.nodes.stop)
