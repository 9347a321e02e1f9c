"""Discretisation of a model: mesh, stiffness of the plate, prescribed dofs, springs, contact points and loads."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np
from scipy.sparse import csr_array

from signorini import _core
from signorini.base.arguments import known, made_by
from signorini.base.remade import Remade
from signorini.discretise.domain import require_domain
from signorini.discretise.held import Bodies, Held, hold
from signorini.discretise.loads import CaseLoad, Cases, case_loads, loaded_sides
from signorini.discretise.meshing import mesh_of
from signorini.discretise.placed import placed
from signorini.discretise.places import located, sides_beside
from signorini.discretise.points import ContactPoints, Parts, Springs, parts_of
from signorini.discretise.preloads import require_preloads
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
from signorini.discretise.supports import springs_and_contacts
from signorini.discretise.thickness import PlateStiffness, Thickness, thickness_of
from signorini.discretise.zones import Zones
from signorini.errors import InputError, Problems
from signorini.mesh import Location, Mesh
from signorini.model import Combination, Model

__all__ = ["CaseLoad", "ContactPoints", "Discretisation", "Held", "Repeated", "Rows", "Springs"]


@dataclass(frozen=True, eq=False, repr=False)
class Discretisation(Remade):
    """A model as arrays. Dofs are (w, θ1, θ2) node by node; θ1, θ2 are θx, θy unless ``held.frames`` says otherwise.

    Nodes of ``held.bodies`` follow others: displacements have their motion, rows and forces have nothing at them.
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
    springs: Springs
    contacts: ContactPoints
    repeated: Repeated
    sections: Sections
    cases: Cases
    probes: Location
    probe_positions: Floats
    seconds: Mapping[str, float]
    plates: tuple[OfWhole, ...] = ()
    """Of several plates each, of which the arrays here are put together."""
    tightening: tuple[float, ...] = ()
    """Factors (t,) of the rounds in which bolts are tightened, as `Model.round_factors` gives them."""

    _made = MappingProxyType({"plate": lambda result: result.made()})

    @property
    def each(self) -> tuple[Discretisation, ...]:
        """Every plate by itself."""
        return tuple(plate.own for plate in self.plates) or (self,)

    @property
    def dof_count(self) -> int:
        """Number of dofs, those held included."""
        return 3 * self.mesh.node_count

    @cached_property
    def points(self) -> ContactPoints:
        """Contact points and, behind them, those that repeat them (m + r,)."""
        return ContactPoints.join([self.contacts, self.repeated.points])

    @cached_property
    def parts(self) -> tuple[Parts, ...]:
        """What of held nodes, springs and ``points`` is each support's."""
        return parts_of(len(self.model.support), self.held, self.springs, self.points)

    def made(self) -> _core.Plate:
        """The plate, or all of them in one table of elements."""
        return plate_of(self.mesh, self.zones, self.thickness, self.stress_nodes, self.held)

    def over_dofs(self, rows: Rows) -> csr_array:
        """Rows as a sparse matrix (m, 3n), over the dofs of those nodes that lead others."""
        return self.held.bodies.onto_leaders(rows.matrix(self.mesh.elements, self.dof_count))

    @cached_property
    def shared(self) -> list[Shared]:
        """Which of ``points`` can share their reactions in more ways than one."""
        return shared_by(self.model, self.mesh, self.held, self.points)

    def by_sign(self, reaction: Floats) -> Floats:
        """What points that hold the plate from both sides share, whatever their shares of reactions (m + r,) are.

        Of its sign depends who carries it.
        """
        parts = [np.zeros(0)]
        for one in self.shared:
            ways = np.where(self.points.two_sided, 0.0, self.points.direction)[one.points]
            if np.ptp(ways):
                mine = reaction[one.points]
                parts.append(mine - one.ways @ (one.ways.T @ mine))
        return np.concatenate(parts)

    @property
    def repeats_itself(self) -> bool:
        """Whether rows of rigid contact points depend on each other, so that their gaps cannot be chosen freely."""
        rigid = np.flatnonzero((self.contacts.compliance == 0) & ~self.contacts.slope)
        free = within(self.contact_rows[rigid], ~self.held.dofs)
        group, _ = parallel(free)
        return len(np.unique(group)) < len(group) or bool(len(followers(times(free, 1.0 / lengths(free))).rows))

    @cached_property
    def share_weights(self) -> Floats:
        """What reactions of ``points`` (m + r,) count by: 1, a length over the plate's, or an area over the plate's."""
        power = np.array([{"at": 0, "area": 2}.get(one.place, 1) for one in self.model.support])[self.points.support]
        return np.asarray(self.points.weights / np.sqrt(self.mesh.element_area.sum()) ** power)

    @cached_property
    def held_together(self) -> tuple[frozenset[int], ...]:
        """Supports that hold the same nodes; not lines that only meet there, each of which has half of a corner."""
        nodes, holders = self.held.holders.T
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
        """Contact points' rows (m, 3n)."""
        return self.over_dofs(self.contacts.rows)

    @cached_property
    def point_rows(self) -> csr_array:
        """Rows (m + r, 3n) of contact points and, behind them, of those that repeat them.

        These follow from the others where no dof is held; at held dofs each has its own.
        """
        if not len(self.repeated.points):
            return self.contact_rows
        return self.over_dofs(self.points.rows)

    @cached_property
    def off_areas(self) -> tuple[Bools, Bools]:
        """Which contact points (m + r,), repeated ones behind, and which springs (s,), are of no area or footprint."""
        off = np.array([support.on_nodes for support in self.model.support], np.bool_)
        return off[self.points.support], off[self.springs.support]

    @cached_property
    def spring_rows(self) -> csr_array:
        """Springs' rows (m, 3n)."""
        return self.over_dofs(self.springs.rows)

    def spring_forces(self, hi: Floats, lo: Floats, base: Floats | None = None) -> Floats:
        """Upward forces (..., s) of springs at displacements (..., 3n), of the model's bases (s,) unless given.

        Stretches are summed in extended precision: a stiff spring between nodes moves by the rounding of theirs.
        """
        springs = self.springs
        if hi.ndim > 1:
            return np.array([self.spring_forces(*one, base) for one in zip(hi, lo, strict=True)])
        at_rest = springs.base if base is None else base
        return -springs.stiffness * self.plate.openings(*springs.rows.arrays, at_rest, hi, lo)

    def through(self, load: CaseLoad, hi: Floats, lo: Floats, reaction: Floats, pull: Floats) -> Floats:
        """Moment, twist and shear (3s,) of each section and, as means, of each station of a strip.

        Under a load, at displacements hi + lo (3n,); ``reaction`` (m + r,) are those of ``points``, ``pull`` (k,) the
        upward forces of springs.
        """
        if not len(self.sections.per):
            return np.zeros(0)
        of_points, of_springs = self._reactions_through
        within = self.sections.within(self.plate, hi, lo, load.curvature, load.couples)
        forces = within + load.through + of_points[:, : len(reaction)] @ reaction + of_springs @ pull
        return np.asarray(forces / np.repeat(self.sections.per, 3))

    @cached_property
    def cut_lengths(self) -> Floats:
        """Length (s,) on the plate of each section and, behind them, of each station of a strip."""
        if not self.plates:
            return self.sections.lengths
        result: dict[tuple[str, int], Floats] = {}
        for plate in self.plates:
            first = len(plate.own.model.section)
            cut = plate.own.sections.lengths
            ends = first + np.cumsum([0, *(strip.stations for strip in plate.own.model.strip)])
            result |= {("section", at): cut[i : i + 1] for i, at in enumerate(plate.numbers["section"])}
            result |= {("strip", at): cut[ends[i] : ends[i + 1]] for i, at in enumerate(plate.numbers["strip"])}
        return np.concatenate([np.zeros(0), *(result[key] for key in sorted(result))])

    @cached_property
    def _reactions_through(self) -> tuple[csr_array, csr_array]:
        """What reactions of ``points`` (3s, m + r) and of springs (3s, k) do at sections."""
        of = self.sections.of_supports
        return of(self.model.support, self.points), of(self.model.support, self.springs)

    @cached_property
    def rigid_motions(self) -> Floats:
        """Nodal vectors (3n, 3p) of the motions w = 1, w = x − x0, w = y − y0 about the middle, of each of p plates."""
        motions = self.held.rigid_motions(self.mesh.points, self.middle)
        if not self.plates:
            return motions
        result = np.zeros((len(motions), 3 * len(self.plates)))
        for number, plate in enumerate(self.plates):
            result[plate.dofs, 3 * number : 3 * number + 3] = motions[plate.dofs]
        return result

    @cached_property
    def scaled_motions(self) -> Floats:
        """The same, those that turn the plate over its size, so that all have deflections of about one."""
        return np.asarray(self.rigid_motions / self.sizes)

    @property
    def sizes(self) -> Floats:
        """Lengths (3p,) by which slopes of rigid motions are compared with deflections: 1, and the plates' size."""
        return np.tile([1.0, self.mesh.size, self.mesh.size], max(1, len(self.plates)))

    def in_motions(self, positions: Floats, elements: Ints) -> Floats:
        """Deflections (q, 3p) at positions (q, 2) in elements (q,) in the rigid motions that `scaled_motions` are."""
        at = np.column_stack([np.ones(len(positions)), (positions - self.middle) / self.mesh.size])
        if not self.plates:
            return at
        firsts = [plate.elements.start for plate in self.plates]
        result = np.zeros((len(at), len(firsts), 3))
        result[np.arange(len(at)), np.searchsorted(firsts, elements, side="right") - 1] = at
        return result.reshape(len(at), 3 * len(firsts))

    def moved(self, hi: Floats, lo: Floats, motions: Floats) -> tuple[Floats, Floats]:
        """Displacements (3n,) with rigid motions (3p,) of the plates beside them: w and the slopes about the middle."""
        x, y = self.middle.tolist()
        if not self.plates:
            w, tx, ty = motions.tolist()
            return self.plate.moved(hi, lo, (x, y), (w, tx, ty))
        each = [
            one.own.plate.moved(hi[one.dofs], lo[one.dofs], (x, y), (w, tx, ty))
            for one, (w, tx, ty) in zip(self.plates, motions.reshape(-1, 3).tolist(), strict=True)
        ]
        return np.concatenate([one for one, _ in each]), np.concatenate([one for _, one in each])

    @cached_property
    def probe_sides(self) -> Sides:
        """Where probes are, on every side of a jump."""
        return self.stress_nodes.sides(self.probe_positions, self.probes)

    @cached_property
    def node_thickness(self) -> Floats:
        """Thickness (s,) of a solid plate at the nodes of stresses; NaN where a stiffness is given in its place."""
        if not self.plates:
            return solid_thickness(self.stress_nodes, self.zones)
        result = np.empty(self.stress_nodes.count)
        for plate in self.plates:
            result[plate.stress_nodes] = plate.own.node_thickness
        return result

    @cached_property
    def probe_thickness(self) -> Floats:
        """The same at probes (q,); NaN also where it jumps."""
        return self.probe_sides.alike(self.stress_nodes.at(self.probe_sides, self.node_thickness))

    @property
    def middle(self) -> Floats:
        """Middle of the plate's bounding box."""
        return self.mesh.middle

    @cached_property
    def no_load(self) -> CaseLoad:
        """Nothing on any plate."""
        if self.plates:
            return CaseLoad.join([one.own.no_load for one in self.plates])
        return CaseLoad.none(self.mesh.node_count, len(self.mesh.elements))

    def load_of(self, case: str) -> CaseLoad:
        """A load case; of several plates one that does not act on this one too."""
        return self.cases[case] if case in self.cases else replace(self.no_load, acting=frozenset([case]))

    def tightened(self, contacts: ContactPoints, tightening: tuple[float, ...]) -> Discretisation:
        """The same with contact points at other distances, as bolts are tightened by these factors (t,) of rounds."""
        plates = []
        for one in self.plates:
            own, mine = one.own.contacts, contacts.pick(one.points[: len(one.own.contacts)])
            moved = replace(
                own,
                distance=mine.distance,
                settlement=mine.settlement,
                tightened_to=mine.tightened_to,
                preload=mine.preload,
            )
            plates.append(replace(one, own=one.own.tightened(moved, tightening)))
        return replace(self, contacts=contacts, tightening=tightening, plates=tuple(plates))

    def load(self, combination: Combination) -> CaseLoad:
        """Sum of the cases times their factors."""
        made_by(combination, Combination, "Take one of model.effective_combinations.", "combination")
        total = self.no_load
        for case, factor in (combination.factors or {}).items():
            total = total + factor * self.cases[known(case, self.cases, "load case", "factors")]
        return total


def discretise_plate(model: Model, mesh: Mesh | None = None) -> Discretisation:
    """Mesh a plate, unless a mesh of it is given, and turn its supports and loads into arrays."""
    begun = time.perf_counter()
    mesh, model, moved = mesh_of(model, mesh)
    meshed = time.perf_counter()
    problems = Problems()
    acting = placed(model, mesh, problems)
    supports = [one for one in acting if one.support.between is None]
    loaded = loaded_sides(model, mesh, problems)
    # A thickness that is wrong keeps no other problem from being found.
    thickness, zones = Thickness(*np.full((2, 1, 1), mesh.size)), Zones.of(model, mesh, problems)
    bodies = Bodies.of(mesh, zones, problems)
    held = hold(mesh, supports, bodies, problems)
    stress_nodes = StressNodes.of_mesh(mesh)
    with problems.collected():
        along = [sides_beside(mesh, one.support.where, one.sides) for one in acting]
        along += [sides_beside(mesh, model.load[index].where, sides) for index, sides in loaded.items()]
        stiff = [one.support for one in acting if one.support.is_rigid and not one.support.can_yield]
        areas = [one.where.region for one in stiff if one.where.region is not None]
        thickness, stress_nodes = thickness_of(mesh, zones), stress_nodes_of(mesh, zones, along, areas, bodies.rigid)
    plate = plate_of(mesh, zones, thickness, stress_nodes, held)
    stiffness = PlateStiffness.of(mesh, zones, thickness.at_points)
    springs, contacts = springs_and_contacts(model.plate, mesh, plate, held, stiffness, supports, problems)
    sections = Sections.of(model, mesh, plate, held, problems)
    still = case_loads(zones, mesh, plate, held, sections, loaded, problems)
    probes = [Location(np.zeros(0, np.int64), np.zeros((0, 2)))]
    for index, probe in enumerate(model.probe):
        with problems.collected():
            at = located(mesh, probe.at, ("probe", index, "at"))
            probes.append(Location(at.elements, at.xi))
    for index, profile in enumerate(model.profile):
        if not mesh.locate(profile.places[1]).inside.any():
            with problems.collected():
                raise InputError("None of its stations is on the plate. Move it onto the plate.", ("profile", index))
    problems.raise_collected()
    if not any(support.between for support in model.support):
        # What holds one of several plates is not all known yet.
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
        Cases(still, model.moving, mesh, sections),
        Location(np.concatenate([at.elements for at in probes]), np.concatenate([at.xi for at in probes])),
        np.array([at for probe in model.probe for at in probe.at]).reshape(-1, 2),
        seconds,
    )


def plate_of(mesh: Mesh, zones: Zones, thickness: Thickness, stress_nodes: StressNodes, held: Held) -> _core.Plate:
    """The plate, or all of several, for the core."""
    plates, others = zones.rigidities[0], None
    if len(zones.rigidities) > 1:
        units = np.array([rigidity.for_core for rigidity in zones.rigidities[1:]])
        others = zones.of_elements.rigidity, zones.young[1:], units
    try:
        return _core.Plate(
            mesh.points,
            mesh.elements,
            thickness.for_core,
            float(zones.young[0]),
            plates.for_core,
            zones.element,
            held.frames,
            thickness.layered,
            others,
            stress_nodes.elements if len(stress_nodes.further) else None,
            held.bodies.leaders if held.bodies.inside.any() else None,
        )
    except ValueError as error:
        raise InputError(f"{error}. Change the mesh or the thickness.", place=("plate",)) from None


@dataclass(frozen=True, eq=False, repr=False)
class OfWhole(Remade):
    """One of several plates: its own arrays, and where they are among those of all.

    ``nodes``, ``elements`` and ``stress_nodes`` (s,) say which these are, ``springs`` and ``points`` (m + r,) which of
    springs and of ``points``, ``numbers`` by key which of the model's tables. Of what acts between plates ``beneath``
    has, by the own number of the support, another plate's number and what takes its deflections to own nodes (n, n').
    ``upon`` are the own numbers of supports of other plates that lie on this one.
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

    @property
    def dofs(self) -> slice:
        """Which dofs these are."""
        return slice(3 * self.nodes.start, 3 * self.nodes.stop)
