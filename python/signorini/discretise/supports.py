"""Supports as springs and contact points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from signorini import _core
from signorini.discretise.holds import holds_deflection, nodes_at
from signorini.discretise.places import Sampled, along_curve, edge_nodes, in_area, located, mesh_edges
from signorini.discretise.rows import Bools, Floats, Ints, Rows
from signorini.expression.levels import Level
from signorini.mesh import Mesh
from signorini.model import Model, Plate, Support

_GAUSS = 3
_GAUSS_RIGID = 2
"""Points on each piece of a rigid line that the mesh does not follow: no more than the dofs that can answer."""

_OFF = 0.02
"""How far a cut may lie from a curved step of a support, over an element's side: finer cuts are many contact points."""


@dataclass(frozen=True, eq=False)
class _Table:
    """Arrays of equal length, one entry a row."""

    rows: Rows

    def __len__(self) -> int:
        """Count the rows."""
        return len(self.rows)

    @classmethod
    def join(cls, parts: Sequence[Self]) -> Self:
        """Put tables behind one another; of one that is not empty no copy is made."""
        filled = [part for part in parts if len(part)]
        if len(filled) == 1:
            return filled[0]
        names = [field.name for field in fields(cls)][1:]
        columns = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
        return cls(Rows.join([part.rows for part in parts]), **columns)

    def pick(self, which: Bools | Ints) -> Self:
        """Keep the rows marked; where that is every one, no copy is made."""
        if which.dtype == np.bool_ and which.all():
            return self
        names = [field.name for field in fields(self)]
        return type(self)(**{name: getattr(self, name)[which] for name in names})


@dataclass(frozen=True, eq=False)
class Springs(_Table):
    """Linear springs: stiffness and base (m,); position (m, 2), weight and support of each."""

    stiffness: Floats
    base: Floats
    positions: Floats
    weights: Floats
    support: Ints


@dataclass(frozen=True, eq=False)
class ContactPoints(_Table):
    """Contact points: row·u + gap − compliance·reaction = distance.

    ``direction`` is +1 where the support pushes the plate up and −1 where it holds it down (its row is turned round);
    ``slope`` marks two-sided points that hold a slope instead of the deflection.
    """

    distance: Floats
    compliance: Floats
    two_sided: Bools
    direction: Floats
    slope: Bools
    positions: Floats
    weights: Floats
    support: Ints


@dataclass(frozen=True, eq=False)
class _Acting:
    """Points of one support with the rows that they act through."""

    rows: Rows
    positions: Floats
    weights: Floats
    slope: bool


def springs_and_contacts(model: Model, mesh: Mesh, plate: _core.Plate) -> tuple[Springs, ContactPoints]:
    """What the supports do beyond the dofs they hold at nodes."""
    none = np.zeros(0)
    flags, who, place = np.zeros(0, np.bool_), np.zeros(0, np.int64), np.zeros((0, 2))
    springs = [Springs(Rows.join([]), none, none, place, none, who)]
    contacts = [ContactPoints(Rows.join([]), none, none, flags, none, flags, place, none, who)]
    for index, support in enumerate(model.support):
        for acting in _acting(mesh, model.plate, plate, index, support):
            found = _springs_or_contacts(index, support, acting)
            if isinstance(found, Springs):
                springs.append(found)
            else:
                contacts += found
    joined = ContactPoints.join(contacts)
    return Springs.join(springs), joined


def _acting(mesh: Mesh, shape: Plate, plate: _core.Plate, index: int, support: Support) -> list[_Acting]:
    """Points and rows of one support, for what no node holds."""
    place = f"support[{index + 1}]"
    deflection = "w" in support.fixed or support.resists is not None
    if support.area is not None:
        points = in_area(mesh, shape, support.area, place, _GAUSS, _steps(support), _OFF)
        sampled = Sampled(points.elements, points.xi, points.weights, points.positions, np.zeros_like(points.positions))
        through = _Acting(_rows(plate, sampled, 0), sampled.positions, sampled.weights, False)
        return [through if support.stiffness is not None else _means(through)]
    if support.at is not None:
        sampled = located(mesh, support.at, place)
        between_nodes = nodes_at(mesh, sampled) < 0
        if holds_deflection(support) or not deflection:
            sampled = _pick(sampled, between_nodes)
        found = [_Acting(_rows(plate, sampled, 0), sampled.positions, sampled.weights, False)] if deflection else []
        if "slope" in support.fixed:
            found += [_Acting(_rows(plate, sampled, part), sampled.positions, sampled.weights, True) for part in (1, 2)]
        return found
    triples = mesh_edges(mesh, support, place)
    if support.stiffness is not None:
        sampled = along_curve(mesh, shape, support, place, _GAUSS, _steps(support))
    elif triples is None:
        sampled = along_curve(mesh, shape, support, place, _GAUSS_RIGID)
    elif support.fixed or holds_deflection(support):
        return []
    else:
        on = edge_nodes(mesh, triples)
        where = mesh.locate(mesh.points[on.nodes])
        sampled = Sampled(where.elements, where.xi, on.weights, mesh.points[on.nodes], np.zeros((len(on.nodes), 2)))
    found = [_Acting(_rows(plate, sampled, 0), sampled.positions, sampled.weights, False)] if deflection else []
    tx, ty = sampled.tangents.T
    for component, directions in (("slope", (ty, -tx)), ("twist", (tx, ty))):
        if component in support.fixed:
            rows = _along(plate, sampled, *directions)
            found.append(_Acting(rows, sampled.positions, sampled.weights, True))
    return found


def _steps(support: Support) -> list[Level]:
    """Where an elastic support's stiffness, gap or settlement jumps; the points of a rigid one are what they are."""
    formulas = (support.stiffness, support.gap, support.settlement) if support.stiffness is not None else ()
    return [level for formula in formulas if formula is not None for level in formula.levels if level.jumps]


def _springs_or_contacts(index: int, support: Support, acting: _Acting) -> Springs | list[ContactPoints]:
    place = f"support[{index + 1}]"
    positions, weights, count = acting.positions, acting.weights, len(acting.rows)
    settlement = np.zeros(count) if acting.slope else support.settlement(*positions.T, place=f"{place}.settlement")
    gap = support.gap(*positions.T, at_least=0.0, place=f"{place}.gap")
    who = np.full(count, index, dtype=np.int64)
    compliance = np.zeros(count)
    two_way = support.fix is not None or support.resists == "both"
    if support.stiffness is not None:
        stiffness = weights * support.stiffness(*positions.T, above=0.0, place=f"{place}.stiffness")
        if two_way and not gap.any():
            return Springs(acting.rows, stiffness, settlement, positions, weights, who)
        compliance = 1.0 / stiffness
    pushes_up = (1.0, gap + settlement)
    holds_down = (-1.0, gap - settlement)
    equation = two_way and not gap.any()
    sides = {"down": [pushes_up], "up": [holds_down]}.get(
        support.resists or "both", [pushes_up] if equation else [pushes_up, holds_down]
    )
    return [
        ContactPoints(
            acting.rows if sign > 0 else -acting.rows,
            distance,
            compliance,
            np.full(count, equation),
            np.full(count, sign),
            np.full(count, acting.slope),
            positions,
            weights,
            who,
        )
        for sign, distance in sides
    ]


def _rows(plate: _core.Plate, sampled: Sampled, field: int) -> Rows:
    coefficients, _ = plate.interpolation_rows(sampled.elements, sampled.xi, field)
    return Rows(sampled.elements, coefficients)


def _along(plate: _core.Plate, sampled: Sampled, dx: Floats, dy: Floats) -> Rows:
    """Rows of the slope along directions (dx, dy)."""
    x, y = _rows(plate, sampled, 1), _rows(plate, sampled, 2)
    return Rows(x.elements, dx[:, None] * x.coefficients + dy[:, None] * y.coefficients)


def _means(acting: _Acting) -> _Acting:
    """One mean an element: with more, a rigid bed's pressures would outnumber the deflections that answer them."""
    elements, inverse = np.unique(acting.rows.elements, return_inverse=True)
    area = np.bincount(inverse, acting.weights).astype(np.float64)

    def mean(values: Floats) -> Floats:
        return np.stack([np.bincount(inverse, acting.weights * column) / area for column in values.T], axis=1)

    return _Acting(Rows(elements, mean(acting.rows.coefficients)), mean(acting.positions), area, acting.slope)


def _pick(sampled: Sampled, which: Bools) -> Sampled:
    return Sampled(*(getattr(sampled, field.name)[which] for field in fields(sampled)))
