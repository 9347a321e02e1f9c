"""Results of each support: kind in words, reactions, gaps, states, and contact of areas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Self

import numpy as np

from signorini.base.remade import Remade
from signorini.discretise.held import sides_that_hold_turns
from signorini.discretise.places import quadratic_tangents, side_lengths
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.model import Support
from signorini.results.contact_field.area_contact import AreaContact
from signorini.results.line_reactions import LineReactions, of_the_line_alone, per_length_of_sides
from signorini.results.quantities import of_support
from signorini.results.readings import Readings, SupportForces


@dataclass(frozen=True, eq=False)
class EdgeCouples:
    """Mean couple per length (k,) that a support exerts on element sides (k, 2, 2) along edges of the plate.

    A side is given by its two ends and has the plate on its left. Sides within a rigid zone or inside the plate are
    left out. The couple holds the slope across the edge and is positive where the plate sags.
    """

    sides: Floats
    couples: Floats

    @classmethod
    def of_springs(cls, mesh: Mesh, edges: Sequence[str], positions: Floats, couples: Floats) -> Self:
        """Couples per length from couples (s,) of rotational springs at positions (s, 2), summed over each side."""
        sides = _sides(mesh, edges, np.zeros(mesh.node_count, np.bool_))
        begin, end = mesh.points[sides[:, 0]], mesh.points[sides[:, 2]]
        along = end - begin
        part = np.einsum("skd,kd->sk", positions[:, None] - begin, along) / (along**2).sum(axis=1)
        nearest = begin + np.clip(part, 0.0, 1.0)[..., None] * along
        own = ((positions[:, None] - nearest) ** 2).sum(axis=2).argmin(axis=1)
        length = side_lengths(mesh, sides).sum(axis=1)
        return cls(np.stack([begin, end], axis=1), np.bincount(own, couples, len(sides)) / length)

    @classmethod
    def of(cls, mesh: Mesh, edges: Sequence[str], nodal: Floats, held: Ints, rigid: Bools) -> Self:
        """Couples per length from couples (n, 2) of held nodes, each divided by the length that its node represents.

        The couple of a node belongs to several sides if ``held`` sides (h, 3) meet at a corner there, or if the node is
        in a rigid zone, ``rigid`` (n,). For such a node the mean of the side's other nodes is used.

        Examples
        --------
        >>> from signorini.mesh.meshers import rectangle
        >>> mesh = rectangle((0.0, 0.0), (4.0, 2.0), (1, 2))
        >>> nodal, none = np.zeros((mesh.node_count, 2)), np.zeros(mesh.node_count, np.bool_)
        >>> nodal[mesh.edges["right"].ravel(), 0] = [1 / 6, 4 / 6, 1 / 6, 1 / 6, 4 / 6, 1 / 6]
        >>> nodal[mesh.edges["right"][0, 2], 0] *= 2
        >>> EdgeCouples.of(mesh, ["right"], nodal, mesh.edges["right"], none).couples.round(12).tolist()
        [1.0, 1.0]
        """
        sides = _sides(mesh, edges, rigid)
        tangents = quadratic_tangents(mesh, sides)
        across = np.stack([tangents[..., 1], -tangents[..., 0]], axis=-1)
        alone = of_the_line_alone(mesh, sides, held, rigid)
        couples = per_length_of_sides(mesh, sides, across, alone) @ nodal.ravel()
        return cls(mesh.points[sides[:, [0, 2]]], couples)


def _sides(mesh: Mesh, edges: Sequence[str], rigid: Bools) -> Ints:
    """Sides (k, 3) of elements along edges, each once, without sides in a rigid zone (n,) or inside the plate."""
    sides = np.concatenate([mesh.edges[name] for name in edges])
    sides = sides[np.sort(np.unique(sides[:, 1], return_index=True)[1])]
    outer = mesh.sides[mesh.on_boundary][:, 1]
    return np.asarray(sides[np.isin(sides[:, 1], outer) & ~rigid[sides].all(axis=1)])


MEANINGS = {
    "down": "pushes up only",
    "up": "holds down only",
    "both": "holds both ways",
    "fixed": "fixed",
    "elastic": "elastic",
}
SYMBOLS = {"down": "▲", "up": "▼", "both": "◆", "fixed": "▬", "elastic": "~"}


def kinds(support: Support) -> list[str]:
    """Keys of `MEANINGS` and `SYMBOLS` for a support: "fixed" or its direction; also "elastic" if it is elastic."""
    how = "fixed" if support.fixed else support.direction
    return [how, "elastic"] if support.is_compliant else [how]


def symbol(support: Support) -> str:
    """Symbol of a support's kind in tables."""
    return "".join(SYMBOLS[kind] for kind in kinds(support))


def describe(support: Support) -> str:
    """Describe where a support is and in which direction it holds.

    Examples
    --------
    >>> describe(Support(at=[1, 1], resists="down", gap=0.001))
    'points, pushes up only, rigid, with gap'
    >>> describe(Support(edge="left", fix="clamped"))
    'edge, clamped'
    >>> describe(Support(at=[1, 1], resists="up", law=[[0, 0], [0, 90e3], [0.01, 120e3]]))
    'points, holds down only, rigid at first, then elastic'
    """
    where = {"at": "points"}.get(support.place, support.place)
    if support.fixed:
        return f"{where}, {support.fixing}" + ", elastic" * support.is_elastic
    how = MEANINGS[support.direction] if support.between is None else f"between {' and '.join(support.between)}"
    rigid = "rigid at first, then elastic" if support.is_compliant else "rigid"
    parts = [where, how, "elastic" if support.is_elastic else rigid]
    parts += ["with gap"] * support.has_gap + ["with limit"] * support.can_yield + ["preloaded"] * support.is_bolt
    return ", ".join(parts)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class SupportResult(Remade):
    """Results of one support.

    Parameters
    ----------
    name, kind : str
        Name of the support; text that says where the support is and in which direction it acts.
    place : str
        Key of the support's place: "at", "edge", "line", "circle" or "area".
    numbers : mapping of float
        Quantities of the support by their names in results.json: reaction, closed, contact_area and so on.
    positions : (k, 2) array
        Positions of the support's k points. ``reactions`` (k,) are the points' upward forces, ``gaps`` (k,) their
        remaining free travels, and ``closed`` (k,) marks closed points. Springs and held nodes are always closed. A
        point of a rigid or practically rigid area is an element; its position is the centroid of the forces in the
        element.
    weights : (k,) array
        Length or area that each point represents; 1 for a support at points.
    area : AreaContact or None
        Contact of an area support: pressure, contact area, edge of contact.
    edge : EdgeCouples or None
        Couples per length, if the support is along edges and holds the slope.
    line : LineReactions or None
        Reactions per length, if the support is along edges, a line or a circle and acts on the deflection.
    yielded : (k,) array
        Mask of the points whose reaction reaches the limit.
    pieces : (k,) array or None
        Piece of its law on which each point is, from 0 in the order of travel; None without a law or a limit, and for
        supports along lines and on areas.
    moments : (k, 2) array or None
        Couples on θx and θy that points with a rotational stiffness exert on the plate; None without such a stiffness.
    tightened_to : (k,) array or None
        Reactions (negative) to which bolts were last tightened; 0 for a bolt that was not tightened.
    preloads : (k,) array or None
        Reactions of bolts when all bolts are tightened and before other loads act.
    upon : bool
        Whether another plate rests on this plate through the support.
    """

    name: str
    kind: str
    place: Literal["at", "edge", "line", "circle", "area"]
    numbers: Mapping[str, float]
    positions: Floats
    reactions: Floats
    gaps: Floats
    closed: Bools
    weights: Floats
    area: AreaContact | None
    edge: EdgeCouples | None
    line: LineReactions | None
    yielded: Bools
    pieces: Ints | None
    moments: Floats | None
    tightened_to: Floats | None
    preloads: Floats | None
    upon: bool

    @property
    def changes(self) -> Floats | None:
        """Change (k,) of the reactions at points with a preload, caused by the loads after tightening."""
        return None if self.preloads is None else self.reactions - self.preloads

    @property
    def bolt_forces(self) -> Mapping[str, Floats]:
        """Forces (k,) of bolts by their names in results.json; empty for supports without bolts."""
        columns = {"tightened_to": self.tightened_to, "preload": self.preloads, "change": self.changes}
        return {name: values for name, values in columns.items() if values is not None}

    @property
    def reaction(self) -> float:
        """Total force, positive when the support pushes the plate up."""
        return self.numbers["reaction"]

    @property
    def closed_part(self) -> float:
        """Closed part of the support, 0 to 1: of points by number, of lines by length, of areas by contact area."""
        return self.numbers["closed_part"]

    @property
    def preload(self) -> float:
        """Sum of the preloads of the support's points; NaN without a preload."""
        return self.numbers.get("preload", np.nan)

    @property
    def prying(self) -> float:
        """Prying: tension of bolts divided by the upward resultant of the loads; NaN without bolts or upward load."""
        return self.numbers.get("prying", np.nan)

    @property
    def states(self) -> list[str]:
        """State of every point: "open", "closed" or "yields"."""
        columns = zip(self.closed.tolist(), self.yielded.tolist(), strict=True)
        return ["yields" if yields else "closed" if closed else "open" for closed, yields in columns]

    @property
    def closed_count(self) -> int:
        """Number of the support's closed points."""
        return int(self.closed.sum())

    @property
    def open_count(self) -> int:
        """Number of the support's open points."""
        return len(self.closed) - self.closed_count

    @property
    def contact_area(self) -> float | None:
        """Contact area, from the deflection field if the support is elastic; None if the support is not an area."""
        return self.numbers.get("contact_area")

    @property
    def yielded_area(self) -> float | None:
        """Area in which the limit is reached, from the deflection field if elastic; None if there is no limit."""
        return self.numbers.get("yielded_area")

    @property
    def contact_boundary(self) -> tuple[Floats, ...]:
        """Edge of an area's contact: polylines (k, 2) with the contact on their left.

        The last point of a closed polyline is its first point; other polylines end at the border of the plate or the
        support. On an elastic area polylines follow the deflection field, on a rigid area element sides.
        """
        return () if self.area is None else self.area.contact_boundary

    @property
    def max_pressure(self) -> float | None:
        """Largest pressure of an area, from the deflection field if elastic; None if the support is not an area."""
        return self.numbers.get("max_pressure")

    @property
    def max_pressure_at(self) -> tuple[float, float] | None:
        """Position (x, y) of `max_pressure`; None if the support is not an area."""
        if self.area is None:
            return None
        x, y = self.area.largest[1].tolist()
        return x, y

    @property
    def max_tension(self) -> float | None:
        """Largest pressure with which an area pulls the plate down, as a positive number; None if it is not an area."""
        return self.numbers.get("max_tension")


def support_result(readings: Readings, index: int, forces: SupportForces) -> SupportResult:
    """Result of support number ``index``, from the readings of one solution and the nodal forces of all supports."""
    reading = readings.supports[index]
    discretisation, support, points = readings.discretisation, reading.support, reading.points
    (answer,), area = readings.answers, None
    positions, closed, reactions = (
        points.centres(discretisation, answer.shared),
        reading.closed[0],
        reading.reactions[0],
    )
    if support.area is not None:
        # The support's result and its area share the same arrays, so that a pickle contains each array once.
        (area,) = reading.areas()
        positions, closed, reactions = area.positions, area.closed, area.reactions
    edge, springs = None, discretisation.springs
    (turning,) = np.nonzero(springs.slope & (springs.support == index))
    if support.edge is not None and len(turning):
        couples = forces.springs[turning]
        edge = EdgeCouples.of_springs(discretisation.mesh, support.edge, springs.positions[turning], couples)
    if support.edge is not None and "slope" in support.fixed:
        held = sides_that_hold_turns(discretisation.model, discretisation.mesh)
        couples = discretisation.held.to_global(forces.held.reshape(-1, 3)[:, 1:])
        edge = EdgeCouples.of(discretisation.mesh, support.edge, couples, held, discretisation.held.bodies.inside)
    line = None
    if support.along_line:
        per_length, corners = reading.per_length
        line = LineReactions.of(readings.reader.lines[index], per_length[0], corners[0])
    names = [one.name for one in of_support(support)]
    return SupportResult(
        name=support.name,
        kind=describe(support),
        place=support.place,
        numbers={name: float(readings.read("support", index, name)[0, 0]) for name in names},
        positions=positions,
        reactions=reactions,
        gaps=reading.gaps[0],
        closed=closed,
        weights=points.weights,
        area=area,
        edge=edge,
        line=line,
        yielded=reading.yielded[0],
        pieces=reading.pieces[0] if support.place == "at" and support.has_pieces else None,
        moments=reading.couples[0] if len(points.turning) else None,
        tightened_to=reading.tightened_to if support.is_bolt else None,
        preloads=reading.preloads if support.is_bolt else None,
        upon=index in readings.upon,
    )


def areas_below(supports: Sequence[SupportResult]) -> list[AreaContact]:
    """Contact of the areas that support this plate, without areas through which another plate rests on this plate."""
    return [one.area for one in supports if one.area is not None and not one.upon]


def lines_below(supports: Sequence[SupportResult]) -> list[tuple[SupportResult, LineReactions]]:
    """Lines that support this plate, each with its support, without lines through which another plate rests on it."""
    return [(one, one.line) for one in supports if one.line is not None and not one.upon]
