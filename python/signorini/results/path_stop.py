"""What a load path shows at its beginning, at an event and at its end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from signorini.base.brief import Brief
from signorini.contact.answer import Answer, NotUnique
from signorini.contact.certificate import imbalances
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.results.closed_part import closed_part
from signorini.results.columns import Bearing
from signorini.results.peak import peak
from signorini.results.support_points import SupportPoints
from signorini.results.support_result import area_at_rest

_MOST_POINTS = 100
"""Points of supports at points up to which stops list the reaction of each."""


@dataclass(frozen=True)
class Switch:
    """A contact point that opens or closes.

    Parameters
    ----------
    support : str
    at : (x, y)
    closes : bool
    """

    support: str
    at: tuple[float, float]
    closes: bool

    @property
    def change(self) -> Literal["opens", "closes"]:
        """What it does."""
        return "closes" if self.closes else "opens"


@dataclass(frozen=True, eq=False, repr=False)
class PathStop(Brief):
    """The path at one t. Between two stops all is linear in t, but for the extremes and the work.

    Parameters
    ----------
    t : float
    switched : tuple of Switch
        Contact points that open or close here.
    points : (k,) array
        Which contact points these are.
    reactions : (s,) array
        Total of every support, positive when it pushes the plate up.
    at_points, gaps : (b,) arrays
        Reactions of the `listed_points`, and what is left of their travel.
    closed, counts : (s,) arrays
        Closed points of every support from here on, and how many points it has.
    parts : (s,) array
        The part of every support that is closed here: of points as many, of lines by length, of areas by contact area.
    contact_areas, max_pressures : (s,) arrays
        Of areas; else NaN.
    deflections : (q,) array
        At the model's probes.
    through : (3s,) array
        Moment, twist and shear of the model's sections, and their means at the stations of its strips.
    largest, smallest : float
        Extremes of the deflection over the nodes.
    largest_at, smallest_at : (x, y)
    work, work_size : float
        Sum of nodal loads times displacements, which is the same for all solutions of one load, and of the magnitudes.
    not_unique : tuple of NotUnique
        What of the answer is a choice among equal ones.
    """

    t: float
    switched: tuple[Switch, ...]
    points: Ints
    reactions: Floats
    at_points: Floats
    gaps: Floats
    closed: Ints
    counts: Ints
    parts: Floats
    contact_areas: Floats
    max_pressures: Floats
    deflections: Floats
    through: Floats
    largest: float
    smallest: float
    largest_at: tuple[float, float]
    smallest_at: tuple[float, float]
    work: float
    work_size: float
    not_unique: tuple[NotUnique, ...] = ()

    @property
    def utmost(self) -> float:
        """The extreme of the deflection that is larger in size, negative where the plate lifts most."""
        return self.smallest if -self.smallest > self.largest else self.largest


def switches(found: Discretisation, points: Ints, answer: Answer) -> tuple[Switch, ...]:
    """Say which contact points open or close, and where."""
    contacts, closed = found.contacts, answer.closed
    return tuple(
        Switch(
            found.model.support[contacts.support[i]].name,
            (float(contacts.positions[i, 0]), float(contacts.positions[i, 1])),
            bool(closed[i]),
        )
        for i in points
    )


def listed_points(found: Discretisation) -> list[Bearing]:
    """Points of supports at points, whose reactions every stop lists; none where they are many."""
    listed = [
        Bearing(index, number, (x, y))
        for index, support in enumerate(found.model.support)
        if support.place == "at"
        for number, (x, y) in enumerate(SupportPoints.of(found, index).positions.tolist(), start=1)
    ]
    return listed if len(listed) <= _MOST_POINTS else []


def path_stops(
    found: Discretisation,
    at: Sequence[float],
    loads: Sequence[CaseLoad],
    points: Sequence[Ints],
    switched: Sequence[Ints],
    answers: Sequence[Answer],
    imbalance: Floats | None = None,
) -> list[PathStop]:
    """Reduce answers (k,) to what the path keeps of them; ``switched`` are the points that are said to open or close.

    ``imbalance`` (k, 3n) are their residuals, of plate and springs alone, where they are known.
    """
    hi, lo = np.array([answer.hi for answer in answers]), np.array([answer.lo for answer in answers])
    shared, closed = np.array([answer.shared for answer in answers]), np.array([answer.closed for answer in answers])
    imbalance = imbalances(found, loads, hi, lo) if imbalance is None else imbalance
    deflection = (hi + lo)[:, ::3]
    works = np.array([load.nodal for load in loads]) * (hi + lo)
    held_force = np.where(found.held.dofs, imbalance - (found.point_rows.T @ shared.T).T, 0.0)[:, ::3]
    pull = found.spring_forces(hi, lo)
    listed = {one.support for one in listed_points(found)}
    supports = [
        _support_at_stops(found, index, index in listed, held_force, pull, deflection, closed, shared, answers)
        for index in range(len(found.model.support))
    ]
    of_points, of_gaps, *of_supports = zip(*supports, strict=True)
    at_points, gaps = np.concatenate(of_points, axis=1), np.concatenate(of_gaps, axis=1)
    totals, closed_counts, counts, parts, areas, pressures = (np.array(numbers).T for numbers in of_supports)
    values = found.mesh.shape_functions(found.probes.elements, found.probes.xi)
    at_probes = np.einsum("qi,kqi->kq", values, deflection[:, found.mesh.elements[found.probes.elements]])
    stops = []
    for row, (t, load, answer) in enumerate(zip(at, loads, answers, strict=True)):
        extremes = [peak(sign * deflection[row], found.mesh.points) for sign in (1.0, -1.0)]
        most, least = [(float(x), float(y)) for x, y in found.mesh.points[extremes]]
        stops.append(
            PathStop(
                t,
                switches(found, switched[row], answer),
                points[row],
                totals[row],
                at_points[row],
                gaps[row],
                closed_counts[row],
                counts[row],
                parts[row],
                areas[row],
                pressures[row],
                at_probes[row],
                found.through(load, answer.hi, answer.lo, answer.shared, pull[row]),
                float(deflection[row].max()),
                float(deflection[row].min()),
                most,
                least,
                float(works[row].sum()),
                float(np.abs(works[row]).sum()),
                answer.not_unique,
            )
        )
    return stops


def _support_at_stops(
    found: Discretisation,
    index: int,
    listed: bool,
    held_force: Floats,
    pull: Floats,
    deflection: Floats,
    closed: Bools,
    shared: Floats,
    answers: Sequence[Answer],
) -> tuple[Floats, Floats, Floats, Ints, Ints, Floats, Floats, Floats]:
    """What a support does: reactions and gaps (k, p) of its points, if they are listed, and numbers (k,).

    These are its total, closed points, all points, the part that is closed, contact area and largest pressure.
    """
    support, points = found.model.support[index], SupportPoints.of(found, index)
    fixed = np.concatenate([held_force[:, points.nodes], pull[:, points.springs]], axis=1)
    reactions, closed = points.forces(fixed, shared), points.closed(closed)
    areas = pressures = np.full(len(closed), np.nan)
    if support.area is not None:
        at_rest = area_at_rest(found, index)
        areas = at_rest.contact_areas(deflection, closed)
        known, _ = at_rest.measured(deflection[:, at_rest.on_nodes], reactions)
        pressures = np.fmax.reduce(known, axis=1, initial=0.0)
    parts = [closed_part(found, index, answer, area) for answer, area in zip(answers, areas.tolist(), strict=True)]
    return (
        reactions if listed else reactions[:, :0],
        points.gaps(np.array([answer.gap for answer in answers])) if listed else reactions[:, :0],
        reactions.sum(axis=1),
        closed.sum(axis=1),
        np.full(len(closed), closed.shape[1]),
        np.array(parts),
        areas,
        pressures,
    )
