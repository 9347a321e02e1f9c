"""Results: fields at nodes, reactions, contact state and certificate of one combination."""

from __future__ import annotations

import html
import os
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal, Self

import numpy as np

from signorini import _core
from signorini.certificate import Certificate
from signorini.contact_field import contact_area, largest_pressure
from signorini.discretise import CaseLoad, ContactPoints, Discretisation
from signorini.discretise.rows import Bools, Floats
from signorini.errors import InputError, unknown
from signorini.kinds import describe, symbol
from signorini.mesh import Mesh
from signorini.model import Model, Support
from signorini.problem import spring_arrays
from signorini.sketch import support_mark
from signorini.supportpoints import SupportPoints
from signorini.vtk import displacement_vector, write_vtu

if TYPE_CHECKING:
    from signorini.plot import Axes, SupportMark

Status = Literal["solved", "no_equilibrium"]

FIELDS = ("deflection", "rotation_x", "rotation_y", "mx", "my", "mxy", "qx", "qy")


@dataclass(frozen=True, eq=False)
class SupportResult:
    """What one support does.

    Parameters
    ----------
    name, kind : str
        Its name, and in words where it is and which way it holds.
    reaction : float
        Total force, positive when it pushes the plate up.
    positions : (k, 2) array
        Where it acts; reactions (k,), remaining gaps (k,) and states (k,) of these points follow. Springs and held
        nodes are always closed.
    weights : (k,) array
        Length or area that each point stands for; 1 at a point.
    contact_area, max_pressure : float or None
        Area in contact and largest pressure of an area, from the deflection field where it is elastic; None elsewhere.
    """

    name: str
    kind: str
    reaction: float
    positions: Floats
    reactions: Floats
    gaps: Floats
    closed: Bools
    weights: Floats
    place: Literal["at", "edge", "line", "circle", "area"]
    contact_area: float | None
    max_pressure: float | None

    @property
    def closed_count(self) -> int:
        """Number of closed points."""
        return int(self.closed.sum())

    @property
    def open_count(self) -> int:
        """Number of open points."""
        return len(self.closed) - self.closed_count


@dataclass(frozen=True)
class ProbeResult:
    """Deflection, rotations (θx, θy), moments (mx, my, mxy) and shears (qx, qy) at a point."""

    at: tuple[float, float]
    deflection: float
    rotation: tuple[float, float]
    moment: tuple[float, float, float]
    shear: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Result:
    """One combination. Numbers are NaN where there is no equilibrium.

    Parameters
    ----------
    deflection : (n,) array
        Positive down.
    rotation : (n, 2) array
        Slopes θx, θy.
    moment : (n, 3) array
        mx, my, mxy, positive when they sag; averaged at nodes from the superconvergent points.
    shear : (n, 2) array
        qx, qy.
    nodal_reaction : (n,) array
        Upward force of every support on every node that it acts on.
    method : str
        "lemke", "active_set" or "interior_point".
    iterations : int
        Lemke's pivots, the active set's Newton steps, or the steps of the interior point method.
    """

    name: str
    status: Status
    message: str
    method: str
    iterations: int
    mesh: Mesh
    model: Model
    certificate: Certificate
    deflection: Floats
    rotation: Floats
    moment: Floats
    shear: Floats
    nodal_reaction: Floats
    supports: tuple[SupportResult, ...]
    probes: tuple[ProbeResult, ...]
    seconds: float

    @classmethod
    def of(
        cls,
        found: Discretisation,
        name: str,
        method: str,
        load: CaseLoad,
        answer: _core.ContactSolution,
        certificate: Certificate,
    ) -> Self:
        """Recover every field from a contact solution."""
        begun = time.perf_counter()
        hi, lo, reaction = answer.hi, answer.lo, answer.reaction
        nodal = (hi + lo).reshape(-1, 3)
        rotation = found.held.to_global(nodal[:, 1:])
        stress, _ = found.plate.stresses(hi, lo, tuple(load.curvature), load.couples)
        imbalance = found.plate.residual(spring_arrays(found), load.nodal, hi, lo)
        spread = found.contact_rows.T @ reaction
        held_force = np.where(found.held.dofs, imbalance - spread, 0.0)
        springs = found.springs
        pull = springs.stiffness * (found.spring_rows @ (hi + lo) - springs.base)
        nodal_reaction = held_force + spread + found.spring_rows.T @ pull
        supports = tuple(
            _support_result(found, index, support, held_force[::3], pull, answer)
            for index, support in enumerate(found.model.support)
        )
        fields = np.column_stack([nodal[:, 0], rotation, stress])
        return cls(
            name,
            "solved",
            "",
            method,
            answer.pivots if method == "lemke" else answer.iterations,
            found.mesh,
            found.model,
            certificate,
            nodal[:, 0],
            rotation,
            stress[:, :3],
            stress[:, 3:],
            nodal_reaction[::3],
            supports,
            tuple(_probes(fields, found.mesh, found.probes.elements, found.probes.xi, found.probe_positions)),
            time.perf_counter() - begun,
        )

    @property
    def counted(self) -> str:
        """What ``iterations`` counts."""
        return {"lemke": "pivots", "active_set": "Newton steps"}.get(self.method, "interior point steps")

    @property
    def reactions(self) -> Mapping[str, float]:
        """Total reaction of every support by name, positive when it pushes the plate up."""
        return {support.name: support.reaction for support in self.supports}

    @cached_property
    def fields(self) -> Mapping[str, Floats]:
        """Every field (n,) by name: deflection, rotation_x, rotation_y, mx, my, mxy, qx, qy."""
        values = np.column_stack([self.deflection, self.rotation, self.moment, self.shear])
        return dict(zip(FIELDS, values.T, strict=True))

    def probe(self, points: Floats | list[tuple[float, float]] | tuple[float, float]) -> list[ProbeResult]:
        """Results at points (q, 2) of the plate.

        Raises
        ------
        InputError
            If a point is not on the plate.
        """
        positions = np.atleast_2d(np.asarray(points, dtype=np.float64))
        where = self.mesh.locate(positions)
        if not where.inside.all():
            x, y = positions[np.argmin(where.inside)]
            raise InputError(f"The point [{x:g}, {y:g}] is not on the plate. Move it onto the plate.")
        fields = np.column_stack(list(self.fields.values()))
        return _probes(fields, self.mesh, where.elements, where.xi, positions)

    def plot(self, field: str = "deflection", ax: Axes | None = None) -> Axes:
        """Draw a field as contours with the supports, open or closed, on matplotlib axes.

        Raises
        ------
        InputError
            If there is no field of that name.
        """
        from signorini.plot import contour, supports

        if field not in self.fields:
            raise InputError(unknown("field", field, self.fields, "This result"))
        values = self.fields[field]
        title = ", ".join(part for part in (self.model.title, self.name) if part)
        ax = contour(self.mesh.points, self.mesh.elements, values, ax=ax, label=field, title=title)
        return supports(support_marks(self), ax)

    def to_vtk(self, path: str | os.PathLike[str]) -> None:
        """Write a .vtu file with every field; the displacement vector points down where the plate goes down."""
        data = {
            "deflection": self.deflection,
            "displacement": displacement_vector(self.deflection),
            "rotation": np.column_stack([self.rotation, np.zeros(len(self.rotation))]),
            "moment": self.moment,
            "shear": np.column_stack([self.shear, np.zeros(len(self.shear))]),
            "reaction": self.nodal_reaction,
        }
        write_vtu(path, self.mesh.points, self.mesh.elements, data)

    def _repr_html_(self) -> str:
        """Show the supports' table in a notebook."""
        units = self.model.units
        unit = f" [{html.escape(units.force)}]" if units.force else ""
        number = 'style="text-align: right"'
        words = 'style="text-align: left"'
        head = (
            f"<tr><th></th><th {words}>support</th><th {words}>kind</th>"
            f"<th {number}>reaction{unit}</th><th {number}>closed</th><th {number}>open</th></tr>"
        )
        rows = "".join(
            f"<tr><td {words}>{symbol(support)}</td><td {words}>{html.escape(s.name)}</td>"
            f"<td {words}>{html.escape(s.kind)}</td><td {number}>{s.reaction:.6g}</td>"
            f"<td {number}>{s.closed_count}</td><td {number}>{s.open_count}</td></tr>"
            for support, s in zip(self.model.support, self.supports, strict=False)
        )
        title = f"<p><b>{html.escape(self.name)}</b>: {self.status.replace('_', ' ')}</p>"
        if self.status != "solved":
            return f"{title}<p>{html.escape(self.message)}</p>"
        length = f" {units.length}" if units.length else ""
        ends = f"deflection {self.deflection.min():.6g} to {self.deflection.max():.6g}{length}, positive down"
        verdict = (
            f"{html.escape(ends)}<br>{self.method}, {self.iterations} {self.counted}; certificate {self.certificate}"
        )
        return f"{title}<table>{head}{rows}</table><p>{verdict}</p>"


def unsolved_result(found: Discretisation, name: str, message: str) -> Result:
    """Build the result of a combination without equilibrium: NaN for every number, and the reason."""
    nan = float("nan")
    count = found.mesh.node_count
    nothing = np.full(count, nan)
    return Result(
        name,
        "no_equilibrium",
        message,
        "equilibrium check",
        0,
        found.mesh,
        found.model,
        Certificate(nan, nan, nan, nan, nan),
        nothing,
        np.full((count, 2), nan),
        np.full((count, 3), nan),
        np.full((count, 2), nan),
        nothing,
        (),
        (),
        0.0,
    )


def _support_result(
    found: Discretisation,
    index: int,
    support: Support,
    held_force: Floats,
    pull: Floats,
    answer: _core.ContactSolution,
) -> SupportResult:
    points = SupportPoints.of(found, index)
    reactions = points.forces(np.concatenate([held_force[points.nodes], pull[points.springs]]), answer.reaction)
    closed = points.closed(answer.closed)
    contacts = found.contacts.pick(points.rows[0])
    area = _contact_field(
        found.mesh, support, contacts, closed, points.weights, reactions, (answer.hi + answer.lo)[::3]
    )
    return SupportResult(
        support.name,
        describe(support),
        float(reactions.sum()),
        points.positions,
        reactions,
        points.gaps(answer.gap),
        closed,
        points.weights,
        support.place,
        *area,
    )


def _contact_field(
    mesh: Mesh,
    support: Support,
    points: ContactPoints,
    closed: Bools,
    weights: Floats,
    reactions: Floats,
    deflection: Floats,
) -> tuple[float | None, float | None]:
    """Area in contact and largest pressure of an area."""
    if support.area is None:
        return None, None
    largest = float((reactions / weights).max(initial=0.0))
    if support.stiffness is None:
        return float(weights[closed].sum()), largest
    largest = max(largest, largest_pressure(mesh, support, deflection))
    if support.resists == "both":
        return float(weights[closed].sum()), largest
    return contact_area(mesh, support, deflection, points.rows.elements, weights, closed), largest


def support_marks(result: Result) -> list[SupportMark]:
    """Marks of the supports for pictures."""
    pairs = zip(result.model.support, result.supports, strict=True)
    return [support_mark(result.mesh, support, found.positions, found.closed) for support, found in pairs]


def _probes(
    fields: Floats, mesh: Mesh, elements: np.ndarray[tuple[int], np.dtype[np.int64]], xi: Floats, positions: Floats
) -> list[ProbeResult]:
    values, _ = _core.serendipity(xi) if len(xi) else (np.zeros((0, 8)), None)
    at_points = np.einsum("qi,qif->qf", values, fields[mesh.elements[elements]])
    return [
        ProbeResult((x, y), v[0], (v[1], v[2]), (v[3], v[4], v[5]), (v[6], v[7]))
        for (x, y), v in zip(positions.tolist(), at_points.tolist(), strict=True)
    ]
