"""Results: fields at nodes, reactions, contact state and certificate of one combination."""

from __future__ import annotations

import html
import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, Self, TypeAlias

import numpy as np

from signorini.base import arguments
from signorini.base.arguments import known
from signorini.base.named import Named
from signorini.base.numbers import compared, estimated, number, size_of
from signorini.base.remade import Remade
from signorini.contact.answer import Answer, NotUnique
from signorini.contact.certificate import Certificate
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.errors import InputError, point
from signorini.formats.vtk import displacement_vector, write_vtu
from signorini.mesh import Location, Mesh
from signorini.model import Model
from signorini.results.contact_field import Pressures
from signorini.results.estimate import NONE, Estimate, Estimator
from signorini.results.extremes import FieldExtremes, extremes
from signorini.results.notebook import supports_table
from signorini.results.panels import panel, support_marks
from signorini.results.probe_result import ProbeResult, probe_results, total_pressure
from signorini.results.profile_result import ProfileResult, profile_results
from signorini.results.section_result import SectionResult, StripResult, section_results
from signorini.results.support_result import SupportResult, support_result
from signorini.results.warnings import model_warnings, result_warnings
from signorini.singularities.named import singularities
from signorini.singularities.singularity import Singularity

if TYPE_CHECKING:
    from signorini.plot import Axes

Points: TypeAlias = Floats | Sequence[tuple[float, float]] | tuple[float, float]
Status = Literal["solved", "no_equilibrium"]


FIELDS = ("deflection", "rotation_x", "rotation_y", "mx", "my", "mxy", "qx", "qy")


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
    sections : tuple of SectionResult
        Forces through the model's sections.
    strips : tuple of StripResult
        Mean moments of the model's strips.
    method : str
        "lemke", "active_set" or "interior_point"; "given" where `signorini.recover` was given the reactions.
    unsettled : tuple of str
        Methods that were tried before and did not settle; almost always none.
    iterations : int
        Lemke's pivots, the active set's Newton steps, or the steps of the interior point method.
    not_unique : tuple of NotUnique
        What else would be as right, where supports repeat each other or the plate may rest elsewhere: of all these the
        least reactions, and then the least deflection, are given. Empty where this is the only answer.
    noticed : tuple of str
        What of the model and of this answer is seldom meant, in sentences; ``warnings`` has them too.
    singular : tuple of Singularity
        Where numbers have no limit as the mesh is refined, and which.
    estimator : Estimator or None
        Who says how far its mesh is from the plate.
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
    supports: tuple[SupportResult, ...]
    probes: tuple[ProbeResult, ...]
    sections: tuple[SectionResult, ...]
    strips: tuple[StripResult, ...]
    seconds: float
    noticed: tuple[str, ...]
    singular: tuple[Singularity, ...]
    estimator: Estimator | None = field(default=None, repr=False)

    @classmethod
    def of(
        cls,
        found: Discretisation,
        name: str,
        methods: Sequence[str],
        load: CaseLoad,
        answer: Answer,
        certificate: Certificate,
        stress: Floats | None = None,
    ) -> Self:
        """Recover every field from a contact solution; the last of ``methods`` found it.

        ``stress`` (s, 5) are the moments and shears at the nodes, where they are known already.
        """
        *unsettled, method = methods
        begun = time.perf_counter()
        hi, lo = answer.hi, answer.lo
        nodal = (hi + lo).reshape(-1, 3)
        rotation = found.held.to_global(nodal[:, 1:])
        if stress is None:
            stress, _ = found.plate.stresses(hi, lo, tuple(load.curvature), load.couples)
        spread = found.point_rows.T @ answer.shared
        held_force = np.zeros(found.dof_count)
        if found.held.dofs.any():
            imbalance = found.plate.residual(found.springs.arrays, load.nodal, hi, lo)
            held_force = np.where(found.held.dofs, imbalance - spread, 0.0)
        pull = found.spring_forces(hi, lo)
        points, springs = found.off_areas
        nodal_reaction = held_force + found.point_rows.T @ (points * answer.shared)
        nodal_reaction += found.spring_rows.T @ (springs * pull)
        supports = tuple(
            support_result(found, index, held_force[::3], pull, answer) for index in range(len(found.model.support))
        )
        nodes = found.stress_nodes
        fields = np.column_stack([nodes.spread(nodal[:, 0]), nodes.spread(rotation), stress])
        through = found.through(load, hi, lo, answer.shared, pull)
        return cls(
            name,
            "solved",
            "",
            method,
            tuple(unsettled),
            answer.pivots if method == "lemke" else answer.iterations,
            answer.not_unique,
            found.mesh,
            found.model,
            certificate,
            nodal[:, 0],
            rotation,
            nodes,
            stress[:, :3],
            stress[:, 3:],
            nodal_reaction[::3],
            supports,
            tuple(probe_results(fields, nodes, supports, found.probes, found.probe_positions)),
            *section_results(found, through),
            time.perf_counter() - begun,
            result_warnings(found, load, nodal[:, 0], supports, answer.not_unique),
            singularities(found, load.acting),
        )

    @property
    def counted(self) -> str:
        """What ``iterations`` counts."""
        return {"lemke": "pivots", "active_set": "Newton steps"}.get(self.method, "interior point steps")

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
        """Every field by name: deflection, rotation_x, rotation_y (n,), mx, my, mxy, qx, qy (s,)."""
        values = [self.deflection, *self.rotation.T, *self.moment.T, *self.shear.T]
        for one in values:
            one.flags.writeable = False
        return Named(dict(zip(FIELDS, values, strict=True)), "field", "This result")

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
        profiles = self.model.profile if self.status == "solved" else ()
        found = profile_results(profiles, self.fields, self.stress_nodes, self.supports) if profiles else ()
        return Named({one.name: one for one in found}, "profile", "This result")

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
        return Named(extremes(self.fields, self.stress_nodes, self.singular), "field", "This mapping of extremes")

    @cached_property
    def estimate(self) -> Estimate:
        """What other meshes say of these numbers; the plate is solved on them when this is first asked for.

        What stands in the way, such as memory, is said in its ``warnings``, and then in those of the result.
        """
        return NONE if self.estimator is None else self.estimator(self)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is seldom meant, in sentences, and once half-widths were asked for why they are missing."""
        return self.noticed + (self.estimate.warnings if "estimate" in self.__dict__ else ())

    @property
    def asked_estimate(self) -> Estimate:
        """The estimate where the model asks for one (``mesh.error``); else nothing is solved."""
        return self.estimate if self.model.estimated else NONE

    @property
    def plus_minus(self) -> Mapping[str, Any] | None:
        """Half-widths within which refining the mesh is expected to move every number: of the mesh, not the equations.

        The same structure as the keys deflection, fields, supports, probes, sections and strips of results.json
        (docs/results.md). None in place of a number that has none, and where nothing is known: without equilibrium, of
        reactions that were given, or where no other mesh could be solved, as ``warnings`` then says.

        Examples
        --------
        >>> from signorini import Model, solve
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        ...     support=[{"name": "walls", "edge": ["left", "right"], "resists": "down"}],
        ...     load=[{"pressure": 5e3, "area": {"rectangle": [0, 0, 1, 1]}}],
        ... )
        >>> result = solve(model)["all"]
        >>> print(f"{1e6 * result.deflection.max():.1f} ± {1e6 * result.plus_minus['deflection']['max']:.1f}")
        61.9 ± 0.3
        """
        return self.estimate.plus_minus

    def probe(self, points: Points) -> list[ProbeResult]:
        """Results at points (q, 2) of the plate.

        Raises
        ------
        InputError
            If a point is not on the plate, or none at all.
        """
        positions, where = self._located(points)
        fields = np.column_stack([self.stress_nodes.spread(field) for field in self.fields.values()])
        return probe_results(fields, self.stress_nodes, self.supports, where, positions)

    def pressure(self, points: Points) -> Floats:
        """Contact pressure (q,) of the area supports at points (q, 2) of the plate, positive where they push it up.

        0 where there is a gap, NaN where there is no area support. Of an elastic area k ⟨w − settlement − gap⟩, of a
        rigid one its reaction over the area, an element at a time.

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
        return total_pressure(self.supports, self._located(points)[1])

    def _located(self, points: Points) -> tuple[Floats, Location]:
        positions = arguments.points(points)
        where = self.mesh.locate(positions)
        if not where.inside.all():
            at = point(positions[np.argmin(where.inside)])
            raise InputError(f"The point {at} is not on the plate. Move it onto the plate.")
        return positions, where

    def plot(
        self, field: str = "deflection", ax: Axes | None = None, limits: tuple[float, float] | None = None
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

        Raises
        ------
        InputError
            If there is no field of that name, no area whose pressure could be drawn, or no interval in the limits.
        """
        from signorini.plot import Plan, draw_legend, draw_panel, field_picture

        known(field, [*self.fields, "pressure"], "field", "field", "This result")
        if ax is not None and not hasattr(ax, "tricontourf"):
            raise InputError(f"found {ax!r}; it must be axes of matplotlib, or None for new ones.", place="ax")
        self._require_fields()
        if field == "pressure" and not any(support.area is not None for support in self.model.support):
            raise InputError('There is no "pressure": no support of this model is an area.', place="field")
        nodes, units = self.stress_nodes, self.model.units
        plan = Plan.of(nodes.points, nodes.elements)
        marks = support_marks(self.mesh, self.model.support, self.supports)
        widths = self.estimate.plus_minus if "estimate" in self.__dict__ else None
        drawn = panel(field, self, widths, None if limits is None else arguments.interval(limits, "limits"))
        if ax is None:
            return field_picture(plan, [drawn], marks, title=self.heading, length=units.length).axes[0]
        draw_legend(ax, draw_panel(ax, plan, drawn, marks))
        ax.set_title(self.heading, parse_math=False, wrap=True)
        return ax

    def _require_fields(self) -> None:
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
        write_vtu(path, self.stress_nodes.points, self.stress_nodes.elements, *vtk_fields(self))

    def _repr_html_(self) -> str:
        """Show the supports in a notebook, with half-widths once `plus_minus` was asked for: nothing is solved here."""
        title = f"<p><b>{html.escape(self.name)}</b>: {self.status.replace('_', ' ')}</p>"
        if self.status != "solved":
            return f"{title}<p>{html.escape(self.message)}</p>"
        estimate = self.estimate if "estimate" in self.__dict__ else None
        units, widths = self.model.units, None if estimate is None else estimate.plus_minus
        ends = [float(self.deflection.min()), float(self.deflection.max())]
        if widths is not None:
            most = size_of(ends)
            low, high = (
                estimated(end, widths["deflection"][side], most) for end, side in zip(ends, ("min", "max"), strict=True)
            )
        else:
            low, high = map(number, ends)
        said = [
            f"deflection {low} to {high} {units.length}".rstrip() + ", positive down",
            f"{self.method}, {self.iterations} {self.counted}; certificate {self.certificate}, of the equations",
            f"of the mesh: {compared(estimate.elements, True) if estimate else '± once plus_minus is asked for'}",
            *self.warnings,
        ]
        table = supports_table(self.model.support, self.supports, units, None if widths is None else widths["supports"])
        return f"{title}{table}<p>{'<br>'.join(map(html.escape, said))}</p>"


def vtk_fields(result: Result) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Fields of a .vtu file by name: at the nodes of stresses, and of the elements."""
    data = {
        "deflection": result.deflection,
        "displacement": displacement_vector(result.deflection),
        "rotation": np.column_stack([result.rotation, np.zeros(len(result.rotation))]),
        "moment": result.moment,
        "shear": np.column_stack([result.shear, np.zeros(len(result.shear))]),
    }
    of_elements = {}
    if any(support.on_nodes for support in result.model.support):
        data["reaction"] = result.nodal_reaction
    if areas := [support.area for support in result.supports if support.area is not None]:
        pressures, forces = Pressures(areas), [area.reactions for area in areas]
        if any(area.support.stiffness is not None for area in areas):
            on = pressures.nodes
            data["contact_pressure"] = np.zeros(result.mesh.node_count)
            data["contact_pressure"][on] = pressures.at_nodes(result.deflection[on], forces)
        if any(area.support.stiffness is None for area in areas):
            of_elements["rigid_contact_pressure"] = np.zeros(len(result.mesh.elements))
            of_elements["rigid_contact_pressure"][pressures.elements] = pressures.on_elements(forces)
    return {name: result.stress_nodes.spread(values) for name, values in data.items()}, of_elements


def unsolved_result(found: Discretisation, name: str, message: str) -> Result:
    """Build the result of a combination without equilibrium: NaN for every number, and the reason."""
    nan = float("nan")
    count, of_stress = found.mesh.node_count, found.stress_nodes.count
    nothing = np.full(count, nan)
    return Result(
        name,
        "no_equilibrium",
        message,
        "equilibrium check",
        (),
        0,
        (),
        found.mesh,
        found.model,
        Certificate(nan, nan, nan, nan, nan),
        nothing,
        np.full((count, 2), nan),
        found.stress_nodes,
        np.full((of_stress, 3), nan),
        np.full((of_stress, 2), nan),
        nothing,
        (),
        (),
        (),
        (),
        0.0,
        model_warnings(found),
        (),
    )
