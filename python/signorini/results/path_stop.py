"""What a load path shows at its beginning, at an event and at its end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from signorini.base.brief import Brief
from signorini.contact.answer import Answer
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats, Ints
from signorini.results.peak import peak
from signorini.results.support_result import SupportResult, support_result


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
    closed, counts : (s,) arrays
        Closed points of every support from here on, and how many points it has.
    parts : (s,) array
        The part of every support that is closed from here on, by points, length or area.
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
    """

    t: float
    switched: tuple[Switch, ...]
    points: Ints
    reactions: Floats
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


def path_stop(
    found: Discretisation, t: float, load: CaseLoad, points: Ints, switched: Ints, answer: Answer
) -> PathStop:
    """Reduce an answer to what the path keeps of it; ``switched`` are the points that are said to open or close."""
    displacement = answer.hi + answer.lo
    deflection, works = displacement[::3], load.nodal * displacement
    imbalance = found.plate.residual(found.springs.arrays, load.nodal, answer.hi, answer.lo)
    held_force = np.where(found.held.dofs, imbalance - found.point_rows.T @ answer.shared, 0.0)
    pull = found.spring_forces(answer.hi, answer.lo)
    supports = [
        support_result(found, index, held_force[::3], pull, answer) for index in range(len(found.model.support))
    ]
    most, least = peak(deflection, found.mesh.points), peak(-deflection, found.mesh.points)
    at = [(float(x), float(y)) for x, y in found.mesh.points[[most, least]]]
    values = found.mesh.shape_functions(found.probes.elements, found.probes.xi)
    elements = found.mesh.elements[found.probes.elements]
    return PathStop(
        t,
        switches(found, switched, answer),
        points,
        np.array([support.reaction for support in supports]),
        np.array([support.closed_count for support in supports]),
        np.array([len(support.closed) for support in supports]),
        np.array([_part(support) for support in supports]),
        np.array([support.contact_area for support in supports], dtype=np.float64),
        np.array([support.max_pressure for support in supports], dtype=np.float64),
        np.einsum("qi,qi->q", values, deflection[elements]),
        found.through(load, answer.hi, answer.lo, answer.shared, pull),
        float(deflection[most]),
        float(deflection[least]),
        at[0],
        at[1],
        float(works.sum()),
        float(np.abs(works).sum()),
    )


def _part(support: SupportResult) -> float:
    """The part of a support that is closed; 1 of what acts nowhere."""
    whole = float(support.weights.sum())
    return 1.0 if support.closed.all() else float(support.weights[support.closed].sum()) / whole
