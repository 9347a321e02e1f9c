"""Results: fields at nodes, reactions, contact state and certificate of one combination."""

from __future__ import annotations

import html
import os
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal, Self, TypeAlias

import numpy as np

from signorini.base import arguments
from signorini.base.arguments import checked, known
from signorini.base.numbers import estimated, number, size_of
from signorini.base.on_demand import Listed, Named, OnDemand
from signorini.base.packages import package
from signorini.base.remade import Remade
from signorini.contact.certificate import Certificate
from signorini.contact.selection import Answer, NotUnique
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.equilibrium.balance import NO_FORCE
from signorini.errors import InputError, point
from signorini.formats.vtk import as_meshio, displacement_vector, write_vtu
from signorini.mesh import Location, Mesh
from signorini.model import Combination, Model
from signorini.results.catalogue import catalogue_of
from signorini.results.contact_field.area_contact import Pressures
from signorini.results.extremes import FieldExtremes, Means, extremes, of_plates
from signorini.results.local_results import (
    ProbeResult,
    ProfileResult,
    SectionResult,
    StripResult,
    probe_results,
    profile_results,
    section_results,
    total_pressure,
)
from signorini.results.marks import panel, support_marks
from signorini.results.notebook import supports_table
from signorini.results.of_plates import said_of
from signorini.results.quantities import (
    AT_BOLTS,
    AT_CORNERS,
    FIELDS,
    LINEAR,
    MEAN_SIDES,
    OF_AREAS,
    OF_BOLTS,
    OF_LIMITED_AREAS,
    OF_LINES,
    PEAKING,
    SIDES,
    TOLD,
    TURNING,
    Catalogue,
    Home,
    Number,
    derived,
)
from signorini.results.support_result import SupportResult, areas_below, support_result
from signorini.results.warnings import model_warnings, result_warnings, sentences
from signorini.singularities.named import singularities
from signorini.singularities.singularity import Singularity, at_peaks

if TYPE_CHECKING:
    from signorini.plot.pictures import Axes

Points: TypeAlias = Floats | Sequence[tuple[float, float]] | tuple[float, float]
Status = Literal["solved", "no_equilibrium"]


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Result(Remade):
    """One combination. Numbers are NaN where there is no equilibrium.

    Parameters
    ----------
    deflection : (n,) array
        Positive down.
    rotation : (n, 2) array
        Slopes θx, θy.
    stress_nodes : StressNodes
        Nodes (s,) of moments and shears: the mesh's, and behind them, for those on a jump of what the plate is made
        of, one for each further side; and the elements (ne, 8) by them.
    moment : (s, 3) array
        mx, my, mxy, positive when they sag; averaged at nodes from the superconvergent points, but across no jump.
    shear : (s, 2) array
        qx, qy.
    nodal_reaction : (n,) array
        Upward force of the supports at points, along lines and edges on every node that they act on. Areas have
        pressures instead, and footprints spread their reactions.
    supports, sections, strips : tuple of SupportResult, SectionResult, StripResult
        What supports do, forces through sections, mean moments of strips: each by its number from 0 or by its name, as
        ``supports["columns"]``.
    method : str
        "lemke", "active_set" or "saddle"; "given" where `signorini.recover` was given the reactions.
    unsettled : tuple of str
        Methods that were tried before and did not settle; almost always none.
    iterations : int
        Pivots of Lemke's algorithm, or Newton steps of the active set.
    not_unique : tuple of NotUnique
        What else would be as right, where supports repeat each other or the plate may rest elsewhere: of all these the
        least reactions, and then the least deflection, are given. Empty where this is the only answer.
    warnings : tuple of str
        What of the model and of this answer is seldom meant, in sentences.
    singular : tuple of Singularity
        Where numbers have no limit as the mesh is refined, and which.
    thickness : (s,) array
        At the nodes of stresses, NaN where a stiffness is given in place of a solid section.
    catalogue : Catalogue
        What ``numbers`` are.
    combination : Combination or None
        The load, by factors of the model's cases; None where it is none of these.
    means : Means or None
        Means of moments and shears at the places where these have no limit. None where there is no equilibrium.
    plates : mapping of Result
        Of several plates each by name, with what is between it and others among its supports. The fields of all are
        behind one another in those of the whole.
    """

    name: str
    status: Status
    message: str
    method: str
    unsettled: tuple[str, ...]
    iterations: int
    not_unique: tuple[NotUnique, ...]
    mesh: Mesh
    model: Model
    certificate: Certificate
    deflection: Floats
    rotation: Floats
    stress_nodes: StressNodes
    moment: Floats
    shear: Floats
    nodal_reaction: Floats
    supports: Listed[SupportResult]
    probes: tuple[ProbeResult, ...]
    sections: Listed[SectionResult]
    strips: Listed[StripResult]
    seconds: float
    warnings: tuple[str, ...]
    singular: tuple[Singularity, ...]
    thickness: Floats
    catalogue: Catalogue
    combination: Combination | None
    means: Means | None = None
    plates: Mapping[str, Result] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        discretisation: Discretisation,
        load_of: Combination | str,
        methods: Sequence[str],
        load: CaseLoad,
        answer: Answer,
        certificate: Certificate,
        stress: Floats | None = None,
        beneath: Mapping[int, Floats] | None = None,
        upon: Collection[int] = (),
    ) -> Self:
        """Recover every field from a contact solution; the last of ``methods`` found it.

        ``load_of`` is the combination, or the name of another load. ``stress`` (s, 5) are the moments and shears at the
        nodes, if already known. ``beneath`` are the deflections (n,) of other plates by the number of the support
        between; ``upon`` are the supports by which another plate lies on this one.
        """
        if discretisation.plates:
            return cls._of_plates(discretisation, load_of, methods, load, answer, certificate)
        *unsettled, method = methods
        begun = time.perf_counter()
        hi, lo = answer.hi, answer.lo
        nodal = (hi + lo).reshape(-1, 3)
        rotation = discretisation.held.to_global(nodal[:, 1:])
        if stress is None:
            stress, _ = discretisation.plate.stresses(hi, lo, tuple(load.curvature), load.couples)
        spread = discretisation.point_rows.T @ answer.shared
        held_force = np.zeros(discretisation.dof_count)
        if discretisation.held.dofs.any():
            imbalance = discretisation.plate.residual(discretisation.springs.arrays, load.nodal, hi, lo)
            held_force = np.where(discretisation.held.dofs, imbalance - spread, 0.0)
        held_couple = discretisation.held.to_global(held_force.reshape(-1, 3)[:, 1:])
        pull = discretisation.spring_forces(hi, lo)
        points, springs = discretisation.off_areas
        nodal_reaction = held_force + discretisation.point_rows.T @ (points * answer.shared)
        nodal_reaction += discretisation.spring_rows.T @ (springs * pull)
        forces = load.weighing[::3]
        lift = -float(forces.sum())
        lift = lift if lift > NO_FORCE * np.abs(forces).sum() else np.nan
        every = (
            support_result(
                *(discretisation, index, held_force[::3], held_couple, pull, answer, lift),
                *((beneath or {}).get(index, 0.0), index in upon),
            )
            for index in range(len(discretisation.model.support))
        )
        supports = Listed(every, "support")
        nodes, thickness = discretisation.stress_nodes, discretisation.node_thickness
        fields = np.column_stack([nodes.spread(nodal[:, 0]), nodes.spread(rotation), stress])
        through = discretisation.through(load, hi, lo, answer.shared, pull)
        return cls(
            load_of if isinstance(load_of, str) else load_of.name,
            "solved",
            "",
            method,
            tuple(unsettled),
            answer.pivots if method == "lemke" else answer.iterations,
            answer.not_unique,
            discretisation.mesh,
            discretisation.model,
            certificate,
            nodal[:, 0],
            rotation,
            nodes,
            stress[:, :3],
            stress[:, 3:],
            nodal_reaction[::3],
            supports,
            tuple(
                probe_results(fields, nodes, thickness, supports, discretisation.probes, discretisation.probe_positions)
            ),
            *section_results(discretisation, through),
            time.perf_counter() - begun,
            result_warnings(discretisation, load, nodal[:, 0], supports, answer.not_unique),
            singularities(discretisation, load.acting),
            thickness,
            catalogue_of(discretisation, TOLD),
            None if isinstance(load_of, str) else load_of,
            Means.of(discretisation, stress[:, :3], stress[:, 3:], load.acting),
        )

    @classmethod
    def _of_plates(
        cls,
        discretisation: Discretisation,
        load_of: Combination | str,
        methods: Sequence[str],
        load: CaseLoad,
        answer: Answer,
        certificate: Certificate,
    ) -> Self:
        """Recover several plates, each by itself, and put them together."""
        begun, each = time.perf_counter(), discretisation.plates
        deflections = [(answer.hi + answer.lo)[one.dofs][::3] for one in each]
        plates: dict[str, Self] = {}
        for one, own in zip(each, load.plates, strict=True):
            beneath = {number: matrix @ deflections[other] for number, (other, matrix) in one.beneath.items()}
            part = answer.on(one), certificate, None
            plates[one.name] = cls.of(one.own, load_of, methods, own, *part, beneath, one.upon)

        def in_order(key: str, of: Callable[[Self], Sequence[Any]]) -> Listed[Any]:
            """Entries of the plates for each table of the model, in its order; between plates the upper one's."""
            result: dict[int, Any] = {}
            for one in each:
                for which, value in zip(one.numbers[key], of(plates[one.name]), strict=True):
                    between = key == "support" and discretisation.model.support[which].between
                    if not between or between[0] == one.name:
                        result[which] = value
            return Listed((result[which] for which in sorted(result)), key)

        nodes = discretisation.stress_nodes
        stress = np.empty((nodes.count, 5))
        for one in each:
            of = plates[one.name]
            stress[one.stress_nodes] = np.column_stack([of.moment, of.shear])
        first, alike = plates[each[0].name], list(plates.values())
        return replace(
            first,
            not_unique=answer.not_unique,
            mesh=discretisation.mesh,
            model=discretisation.model,
            deflection=np.concatenate(deflections),
            rotation=np.concatenate([of.rotation for of in alike]),
            stress_nodes=nodes,
            moment=stress[:, :3],
            shear=stress[:, 3:],
            nodal_reaction=np.concatenate([of.nodal_reaction for of in alike]),
            supports=in_order("support", lambda of: of.supports),
            probes=tuple(one for of in in_order("probe", _by_table) for one in of),
            sections=in_order("section", lambda of: of.sections),
            strips=in_order("strip", lambda of: of.strips),
            seconds=time.perf_counter() - begun,
            warnings=said_of({name: of.warnings for name, of in plates.items()}) + sentences(answer.not_unique),
            singular=singularities(discretisation, load.acting),
            thickness=discretisation.node_thickness,
            catalogue=catalogue_of(discretisation, TOLD),
            plates=plates,
        )

    @property
    def counted(self) -> str:
        """Unit that ``iterations`` counts."""
        return "pivots" if self.method == "lemke" else "Newton steps"

    @property
    def heading(self) -> str:
        """Title of its pictures: the model's, and the name."""
        return ", ".join(part for part in (self.model.title, self.name) if part)

    @property
    def reactions(self) -> Mapping[str, float]:
        """Total reaction of every support by name, positive when it pushes the plate up."""
        return Named({support.name: support.reaction for support in self.supports}, "support", "This result")

    @cached_property
    def fields(self) -> Mapping[str, Floats]:
        """Every field by name, see `signorini.results.quantities.FIELDS`.

        deflection, rotation_x and rotation_y are at the nodes of the mesh (n,), all others at those of stresses (s,):
        mx, my, mxy, qx, qy; principal moments m1, m2; design moments such as mx_bottom; stresses such as sx_top,
        von_mises and txz.
        """
        return OnDemand(FIELDS, self._field, None, "field", "This result")

    def _field(self, name: str) -> Floats:
        field: Floats
        if name in LINEAR:
            values = dict(zip(LINEAR, (self.deflection, *self.rotation.T, *self.moment.T, *self.shear.T), strict=True))
            field = values[name]
        else:
            field = derived([name], self.moment, self.shear, self.thickness)[:, 0]
        field.flags.writeable = False
        return field

    @cached_property
    def profiles(self) -> Mapping[str, ProfileResult]:
        """Deflection, moments, shears and pressure along the model's profiles, by name.

        Examples
        --------
        >>> from signorini import Model, solve
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        ...     support=[{"edge": ["left", "right"], "fix": "simple"}],
        ...     load=[{"pressure": 5e3}],
        ...     profile=[{"name": "middle", "line": [[0, 2], [4, 2]], "stations": 5}],
        ... )
        >>> solve(model)["all"].profiles["middle"].values["mx"].round().tolist()
        [7.0, 7386.0, 9852.0, 7386.0, 7.0]
        """
        if self.plates:
            every = {name: own for one in self.plates.values() for name, own in one.profiles.items()}
            return Named({one.name: every[one.name] for one in self.model.profile}, "profile", "This result")
        profiles = self.model.profile if self.status == "solved" else ()
        result = profile_results(profiles, self.fields, self.stress_nodes, self.supports) if profiles else ()
        return Named({one.name: one for one in result}, "profile", "This result")

    @cached_property
    def extremes(self) -> Mapping[str, FieldExtremes]:
        """Largest and smallest deflection, mx, my, mxy, qx and qy over the nodes.

        Those of moments and shears are away from where these have no limit.

        Examples
        --------
        >>> from signorini import Model, solve
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        ...     support=[{"edge": ["left", "right"], "fix": "simple"}],
        ...     load=[{"pressure": 5e3}],
        ... )
        >>> mx = solve(model)["all"].extremes["mx"]
        >>> round(mx.max), mx.max_at[0], mx.max_beside
        (10336, 2.0, '')
        """
        if self.plates:
            return Named(of_plates([one.extremes for one in self.plates.values()]), "field", "This mapping of extremes")
        found = extremes(self.fields, self.stress_nodes, self.singular, self.means)
        return Named(found, "field", "This mapping of extremes")

    def excluding(self, number: str) -> list[Singularity]:
        """The singularities around which extremes of "moment" or "shear" leave out nodes; none where all would be."""
        if self.plates:
            return [replace(one, plate=name) for name, of in self.plates.items() for one in of.excluding(number)]
        those = [one for one in self.singular if one.excludes(number)]
        return [] if at_peaks(self.mesh, those, number).all() else those

    @cached_property
    def numbers(self) -> Floats:
        """Every number (k,) of its ``catalogue``; NaN if missing."""
        result, at = np.full(len(self.catalogue), np.nan), self.catalogue.at
        if self.status != "solved":
            return result
        if self.plates:
            each = list(self.plates.values())
            for place, numbers in enumerate(self.catalogue.in_plates):
                values = [each[plate].numbers[number] for plate, number in numbers]
                smallest = self.catalogue.numbers[place].what.startswith("min")
                result[place] = (np.fmin if smallest else np.fmax).reduce(values)
            return result

        def put(home: Home, owners: Sequence[object], *names: str) -> None:
            for name in names if owners else ():
                result[at(home, name)] = [getattr(one, name) for one in owners]

        areas = [one for one in self.supports if one.area is not None]
        put("support", self.supports, "reaction", "closed_part")
        put("support", areas, *(one.name for one in OF_AREAS))
        lines = [one.line for one in self.supports if one.line is not None]
        put("support", lines, *(one.name for one in OF_LINES))
        corners = [line.corner_reactions for line in lines]
        result[at("corner", AT_CORNERS.name)] = np.concatenate([np.zeros(0), *corners])
        limited = [one for one in areas if one.yielded_area is not None]
        put("support", limited, *(one.name for one in OF_LIMITED_AREAS))
        bolts = [one for one in self.supports if one.preloads is not None]
        put("support", bolts, *(one.name for one in OF_BOLTS))
        for quantity in AT_BOLTS if bolts else ():
            result[at("point", quantity.name)] = np.concatenate([bolt.bolt_forces[quantity.name] for bolt in bolts])
        put("section", self.sections, "moment", "twist", "shear")
        put("station", [station for strip in self.strips for station in strip.stations], "moment", "twist", "shear")
        result[at("support", "closed", "open")] = [(one.closed_count, one.open_count) for one in self.supports]
        points = [one for one in self.supports if one.place == "at"]
        if len(at("point", "reaction")):
            result[at("point", "reaction")] = np.concatenate([one.reactions for one in points])
            result[at("point", "gap")] = np.concatenate([one.gaps for one in points])
        if lawful := [one.pieces for one in points if one.pieces is not None]:
            result[at("point", "piece")] = np.concatenate(lawful)
        if turning := [one.moments for one in points if one.moments is not None]:
            result[at("point", *TURNING)] = np.concatenate(turning)
        if self.probes:
            linear = [(one.deflection, *one.rotation, *one.moment, *one.shear) for one in self.probes]
            result[at("probe", *LINEAR)] = linear
            if areas:
                result[at("probe", "pressure")] = [np.nan if p.pressure is None else p.pressure for p in self.probes]
            self.catalogue.derive(result, np.array([one.thickness for one in self.probes]))
        if self.strips:
            result[at("strip", "max_moment")] = [one.sagging.moment for one in self.strips]
            result[at("strip", "min_moment")] = [one.hogging.moment for one in self.strips]
        for side in SIDES:
            result[at("field", side)] = [getattr(ends, side) for ends in self.extremes.values()]
        for side in MEAN_SIDES:
            result[at("mean", side)] = [getattr(self.extremes[name], side) for name in PEAKING]
        return result

    def probe(self, points: Points) -> list[ProbeResult]:
        """Results at points (q, 2) of the plate.

        Raises
        ------
        InputError
            If a point is not on the plate, or none at all.
        """
        positions, where = self._located(points)
        fields = np.column_stack([self.stress_nodes.spread(self.fields[name]) for name in LINEAR])
        return probe_results(fields, self.stress_nodes, self.thickness, self.supports, where, positions)

    def pressure(self, points: Points) -> Floats:
        """Contact pressure (q,) of the area supports at points (q, 2) of the plate, positive where they push it up.

        It is 0 at a gap, and NaN without area support. An elastic area has k ⟨w − settlement − gap⟩, a rigid one its
        reaction over the area, element by element.

        Raises
        ------
        InputError
            If a point is not on the plate.

        Examples
        --------
        >>> from signorini import Model, solve
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.5},
        ...     support=[{"area": "all", "resists": "down", "stiffness": 20e6}],
        ...     load=[{"pressure": 2e3}],
        ... )
        >>> solve(model)["all"].pressure([(2, 2), (0, 0)]).round(6)
        array([2000., 2000.])
        """
        return total_pressure(self.supports, self._located(points)[0])

    def _located(self, points: Points) -> tuple[Floats, Location]:
        self._require_fields()
        positions = arguments.points(points)
        where = self.mesh.locate(positions)
        if not where.inside.all():
            at = point(positions[np.argmin(where.inside)])
            raise InputError(f"The point {at} is not on the plate. Move it onto the plate.")
        return positions, where

    def plot(
        self,
        field: str = "deflection",
        ax: Axes | None = None,
        limits: tuple[float, float] | None = None,
        plus_minus: Mapping[str, Any] | None = None,
    ) -> Axes:
        """Draw a field as contours with the supports, open or closed, as the pictures of the command show it.

        Parameters
        ----------
        field : str
            One of `fields`, or "pressure": the contact pressure of area supports.
        ax : Axes, optional
            Of matplotlib; by default those of a new figure.
        limits : (low, high), optional
            Range of the colours, of results that are to be compared; by default that of the field.
        plus_minus : mapping, optional
            Half-widths to name with the extremes: ``signorini.estimate(result).plus_minus``.

        Raises
        ------
        InputError
            If there is no field of that name, no area whose pressure could be drawn, or no interval in the limits.
        """
        from signorini.plot.marks import draw_legend
        from signorini.plot.pictures import draw_panel, field_picture
        from signorini.plot.plan import Plan

        known(field, [*self.fields, "pressure"], "field", "field", "This result")
        if ax is not None and not hasattr(ax, "tricontourf"):
            raise InputError(f"found {ax!r}; it must be axes of matplotlib, or None for new ones.", place="ax")
        if plus_minus is not None:
            arguments.made_by(plus_minus, Mapping, "Take estimate(result).plus_minus.", "plus_minus")
        self._require_fields()
        if field == "pressure" and not areas_below(self.supports):
            raise InputError('There is no "pressure": the plate rests on no area.', place="field")
        nodes, units = self.stress_nodes, self.model.units
        plan = Plan(nodes.points, nodes.elements, nodes.left_out)
        marks = support_marks(self.mesh, self.model.support, self.supports)
        drawn = panel(field, self, plus_minus, None if limits is None else arguments.interval(limits, "limits"))
        if ax is None:
            return field_picture(plan, [drawn], marks, title=self.heading, length=units.length).axes[0]
        draw_legend(ax, draw_panel(ax, plan, drawn, marks))
        ax.set_title(self.heading, parse_math=False, wrap=True)
        return ax

    def _require_fields(self) -> None:
        if self.plates:
            names = ", ".join(f'plates["{name}"]' for name in self.plates)
            raise InputError(f"There are several plates. Take one of them: {names}.", place="plates")
        if self.status != "solved":
            raise InputError(f"There are no fields: {self.message}", place="field")

    def to_vtk(self, path: str | os.PathLike[str]) -> None:
        """Write a .vtu file with every field; the displacement vector points down where the plate goes down.

        Raises
        ------
        InputError
            If there is no equilibrium, and so no field.
        OSError
            If the file cannot be written.
        """
        self._require_fields()
        mesh = as_meshio(self.stress_nodes.points, self.stress_nodes.elements, *vtk_fields(self))
        write_vtu(path, mesh, self.model.provenance.metadata)

    def to_pyvista(self) -> Any:
        """Give the plate with every field as a `pyvista.UnstructuredGrid`; PyVista must be installed.

        Several plates are a `pyvista.MultiBlock` by name.

        Raises
        ------
        InputError
            If there is no equilibrium, and so no field.
        SignoriniError
            If PyVista is not installed.
        """
        if self.plates:
            return package("pyvista").MultiBlock({name: one.to_pyvista() for name, one in self.plates.items()})
        self._require_fields()
        mesh = as_meshio(self.stress_nodes.points, self.stress_nodes.elements, *vtk_fields(self))
        return package("pyvista").from_meshio(mesh)

    def to_dataframe(self) -> Any:
        """Give the ``numbers`` as a `pandas.DataFrame`, a row a number: value, unit, place. It needs pandas.

        Rows have the names of thresholds, such as "bolts[1].reaction". A place (x, y) is that of a point, a probe, a
        station or an extreme, else NaN.

        Examples
        --------
        >>> from signorini import Model, solve
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        ...     units={"length": "m", "force": "N"},
        ...     support=[{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}],
        ...     load=[{"pressure": 1e3}],
        ... )
        >>> table = solve(model)["all"].to_dataframe()
        >>> table.loc["feet[3].reaction"].map(str).tolist()[1:], round(table.loc["feet[3].reaction", "value"])
        (['N', '2.0', '3.0'], 8000)
        """
        units, places = self.model.units, [_place(self, one) for one in self.catalogue]
        columns = {
            "value": self.numbers,
            "unit": [one.quantity.unit(units) for one in self.catalogue],
            **dict(zip("xy", np.array(places).reshape(-1, 2).T, strict=True)),
        }
        names = package("pandas").Index([one.name for one in self.catalogue], name="name")
        return package("pandas").DataFrame(columns, names)

    def _repr_html_(self) -> str:
        """Show the supports in a notebook."""
        return in_notebook(self, None, "")


def _place(result: Result, one: Number) -> tuple[float, float]:
    """Where a number of a result is; NaN where it has no place."""
    own = result.plates[str(one.path[1])] if one.path[0] == "plates" else result
    places: Mapping[str, Callable[[], tuple[float, float] | None]] = {
        "point": lambda: tuple(own.supports[one.owner].positions[one.part].tolist()),
        "probe": lambda: own.probes[one.owner].at,
        "station": lambda: own.strips[one.owner].stations[one.part].at,
        "strip": lambda: getattr(own.strips[one.owner], "sagging" if one.what == "max_moment" else "hogging").at,
        "field": lambda: getattr(own.extremes[one.quantity.name], f"{one.what}_at"),
        "support": lambda: own.supports[one.owner].max_pressure_at if one.what == "max_pressure" else None,
    }
    found = places[one.home]() if result.status == "solved" and one.home in places else None
    return (np.nan, np.nan) if found is None else found


def _by_table(result: Result) -> list[tuple[ProbeResult, ...]]:
    """Probes of each table of them."""
    ends = np.cumsum([0, *(len(probe.at) for probe in result.model.probe)]).tolist()
    return [result.probes[a:b] for a, b in pairwise(ends)]


def in_notebook(result: Result, plus_minus: Mapping[str, Any] | None, of_mesh: str) -> str:
    """Write a result as HTML, with half-widths and their meshes if there are any."""
    title = f"<p><b>{html.escape(result.name)}</b>: {result.status.replace('_', ' ')}</p>"
    if result.status != "solved":
        return f"{title}<p>{html.escape(result.message)}</p>"
    units, ends = result.model.units, result.extremes["deflection"]
    most = size_of([ends.min, ends.max])
    low, high = (
        number(value, most) if plus_minus is None else estimated(value, plus_minus["deflection"][side], most)
        for side, value in (("min", ends.min), ("max", ends.max))
    )
    said = [
        f"deflection {low} to {high} {units.length}".rstrip() + ", positive down",
        f"{result.method}, {result.iterations} {result.counted}; certificate {result.certificate}",
        *([of_mesh] if of_mesh else []),
        *result.warnings,
    ]
    widths = None if plus_minus is None else plus_minus["supports"]
    table = supports_table(result.model.support, result.supports, units, widths)
    return f"{title}{table}<p>{'<br>'.join(map(html.escape, said))}</p>"


_VECTORS = {
    "principal_moment": ("m1", "m2"),
    "design_moment_bottom": ("mx_bottom", "my_bottom"),
    "design_moment_top": ("mx_top", "my_top"),
    "stress_top": ("sx_top", "sy_top", "txy_top"),
    "stress_bottom": ("sx_bottom", "sy_bottom", "txy_bottom"),
    "shear_stress": ("txz", "tyz"),
}
"""Fields that a .vtu file has together."""


def vtk_fields(result: Result) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Fields of a .vtu file by name: at the nodes of stresses, and of the elements."""
    data = {
        "deflection": result.deflection,
        "displacement": displacement_vector(result.deflection),
        "rotation": np.column_stack([result.rotation, np.zeros(len(result.rotation))]),
        "moment": result.moment,
        "shear": np.column_stack([result.shear, np.zeros(len(result.shear))]),
    }
    for name, parts in _VECTORS.items():
        values = np.zeros((result.stress_nodes.count, 3))
        for axis, part in enumerate(parts):
            values[:, axis] = result.fields[part]
        data[name] = values
    data["von_mises"] = result.fields["von_mises"]
    of_elements = {}
    if any(support.on_nodes for support in result.model.support):
        data["reaction"] = result.nodal_reaction
    if areas := areas_below(result.supports):
        pressures, forces = Pressures(areas), [area.reactions for area in areas]
        if any(area.support.modulus is not None for area in areas):
            on = pressures.nodes
            data["contact_pressure"] = np.zeros(result.mesh.node_count)
            data["contact_pressure"][on] = pressures.at_nodes([area.deflection[on] for area in areas], forces)
        if any(area.support.modulus is None for area in areas):
            of_elements["rigid_contact_pressure"] = np.zeros(len(result.mesh.elements))
            of_elements["rigid_contact_pressure"][pressures.elements] = pressures.on_elements(forces)
    return {name: result.stress_nodes.spread(values) for name, values in data.items()}, of_elements


def unsolved_result(discretisation: Discretisation, combination: Combination, message: str) -> Result:
    """Build the result of a combination without equilibrium: NaN for every number, and the reason."""
    nan = float("nan")
    count, of_stress = discretisation.mesh.node_count, discretisation.stress_nodes.count
    nothing = np.full(count, nan)
    return Result(
        combination.name,
        "no_equilibrium",
        message,
        "equilibrium check",
        (),
        0,
        (),
        discretisation.mesh,
        discretisation.model,
        Certificate(nan, nan, nan, nan, nan),
        nothing,
        np.full((count, 2), nan),
        discretisation.stress_nodes,
        np.full((of_stress, 3), nan),
        np.full((of_stress, 2), nan),
        nothing,
        Listed((), "support"),
        (),
        Listed((), "section"),
        Listed((), "strip"),
        0.0,
        model_warnings(discretisation, combination.acting),
        (),
        discretisation.node_thickness,
        catalogue_of(discretisation, TOLD),
        combination,
    )
