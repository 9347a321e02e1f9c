"""What each support does in a solution: reactions, gaps, states, and the contact of areas."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from signorini import _core
from signorini.contact_field import AreaContact
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.kinds import describe
from signorini.model import Support


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
    area : AreaContact or None
        Of an area, its contact as a field.
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
    area: AreaContact | None

    @property
    def closed_count(self) -> int:
        """Number of closed points."""
        return int(self.closed.sum())

    @property
    def open_count(self) -> int:
        """Number of open points."""
        return len(self.closed) - self.closed_count

    @property
    def contact_area(self) -> float | None:
        """Area in contact, from the deflection field where it is elastic; None if the support is not an area."""
        return None if self.area is None else self.area.contact_area

    @property
    def contact_boundary(self) -> tuple[Floats, ...]:
        """Edge of an area's contact: polylines (k, 2) with the contact on their left.

        The last point of a closed one is its first; the others end where the plate or the support does. Of an elastic
        area they follow the deflection field, of a rigid one the sides of elements.
        """
        return () if self.area is None else self.area.contact_boundary

    @property
    def max_pressure(self) -> float | None:
        """Largest pressure of an area, from the deflection field where it is elastic; None if it is not an area."""
        return None if self.area is None else self.area.max_pressure


def support_result(
    found: Discretisation,
    index: int,
    held_force: Floats,
    pull: Floats,
    answer: _core.ContactSolution,
) -> SupportResult:
    """Say what a support does.

    Parameters
    ----------
    found : Discretisation
    index : int
        Which support of the model.
    held_force : (n,) array
        Upward force on every node that is held.
    pull : (s,) array
        Upward force of every spring.
    answer : ContactSolution
    """
    support = found.model.support[index]
    held = (found.held.support.reshape(-1, 3)[:, 0] == index) & found.held.dofs[::3]
    springs = found.springs.support == index
    contacts = (found.contacts.support == index) & ~found.contacts.slope
    points = found.contacts.pick(contacts)
    # A point with travel both ways has two rows, first all those that push up, then all that hold down.
    ways = 2 if len(points) and np.ptp(points.direction) > 0 else 1
    forces = (points.direction * answer.reaction[contacts]).reshape(ways, -1).sum(axis=0)
    travel = answer.gap[contacts].reshape(ways, -1).min(axis=0)
    touching = answer.closed[contacts].reshape(ways, -1).any(axis=0)
    points = points.pick(np.arange(len(points)) < len(forces))
    nodes = int(held.sum())
    fixed = nodes + int(springs.sum())
    positions = np.concatenate([found.mesh.points[held], found.springs.positions[springs], points.positions])
    reactions = np.concatenate([held_force[held], pull[springs], forces])
    gaps = np.concatenate([np.zeros(fixed), travel])
    closed = np.concatenate([np.ones(fixed, np.bool_), touching])
    weights = np.concatenate([np.ones(nodes), found.springs.weights[springs], points.weights])
    order = _as_written(support, positions)
    area = None
    if support.area is not None:
        elements = np.concatenate([found.springs.rows.elements[springs], points.rows.elements])
        area = AreaContact(found.mesh, support, (answer.hi + answer.lo)[::3], elements, weights, closed, reactions)
    return SupportResult(
        support.name,
        describe(support),
        float(reactions.sum()),
        positions[order],
        reactions[order],
        gaps[order],
        closed[order],
        weights[order],
        support.place,
        area,
    )


def _as_written(support: Support, positions: Floats) -> Ints:
    """Order of point supports as the model lists them."""
    if support.at is None or not len(positions):
        return np.arange(len(positions))
    given = np.array(support.at)
    nearest = ((positions[:, None] - given) ** 2).sum(axis=2).argmin(axis=1)
    return np.argsort(nearest, kind="stable")
