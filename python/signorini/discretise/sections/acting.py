"""What loads and supports do in the elements that a section divides, on the left of its line."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from signorini.discretise.quadrature import Quadrature, area_quadrature
from signorini.discretise.quadrature.stepped import Levels
from signorini.discretise.rows import Bools, Floats, Ints, Rows
from signorini.discretise.sections.cut import Cut, placed
from signorini.mesh import Mesh
from signorini.model import Area, Support
from signorini.model.places import footprints
from signorini.shapes.cuts import Part

_ORDER = 3
_FLAT = 1e-9
"""Part of the largest below which what an area has of an element is too narrow to tell the slope of a pressure."""
_AT_SIDE = 1e-6
"""How near a side, in reference coordinates, a point is on it."""


@dataclass(frozen=True, eq=False)
class Spread:
    """A pressure over a region, or over the plate, at points (q, 2) of elements (q,); it may jump where levels do."""

    region: Part | None
    order: int
    levels: Levels
    pressure: Callable[[Ints, Floats], Floats]

    @classmethod
    def even(cls, shape: Part, pressure: float) -> Spread:
        """One pressure over a footprint."""
        return cls(shape, _ORDER, (), lambda _, at: np.full(len(at), pressure))


class Push(NamedTuple):
    """Forces (q,), down, at reference points (q, 2) of elements (q,), their positions (q, 2)."""

    elements: Ints
    xi: Floats
    positions: Floats
    force: Floats


@dataclass(frozen=True, eq=False)
class Acting:
    """What supports act through: rows (m,), positions, directions, whose and which of its points they are.

    ``averaged`` are those of areas that act on means of elements, and at points on their outline.
    """

    rows: Rows
    positions: Floats
    direction: Floats
    support: Ints
    numbers: Ints
    averaged: Bools


def of_points(cut: Cut, mesh: Mesh, elements: Ints, xi: Floats, positions: Floats, force: Floats) -> Floats:
    """What forces (q,) at points (q, 2) of elements (q,) add to moment, twist and shear (3,)."""
    place, some = placed(cut.elements, elements)
    rows = _deflections(mesh, elements[some], xi[some], force[some])
    return np.asarray(cut.work(place, rows, cut.lefts(positions[some])).sum(axis=0))


def of_line(cut: Cut, mesh: Mesh, whole: Push, divided: Push) -> Floats:
    """What forces along a line add (3,), and those of the same line divided where it crosses the cut's."""
    place, some = placed(cut.elements, whole.elements)
    if not len(place):
        return np.zeros(3)
    nodal = _deflections(mesh, whole.elements[some], whole.xi[some], whole.force[some])
    left = np.where(cut.divided()[place], 0.0, cut.lefts(whole.positions[some]))
    result = cut.work(place, nodal, left).sum(axis=0)
    place, some = placed(cut.elements, divided.elements)
    force = cut.lefts(divided.positions[some]) * divided.force[some]
    rows = _deflections(mesh, divided.elements[some], divided.xi[some], force)
    return np.asarray(result - np.einsum("qcd,qd->c", cut.motion[place], rows))


def of_couples(cut: Cut, elements: Ints, positions: Floats, rows: Floats) -> Floats:
    """What couples with rows (q, 24) at points (q, 2) of elements (q,) add (3,)."""
    place, some = placed(cut.elements, elements)
    return np.asarray(cut.work(place, rows[some], cut.lefts(positions[some])).sum(axis=0))


def of_spread(cut: Cut, mesh: Mesh, elements: Ints, xi: Floats, force: Floats, spread: Spread) -> Floats:
    """What a pressure, of which nodal forces are those of forces (q,) at points of elements (q,), adds (3,)."""
    place, some = placed(cut.elements, elements)
    if not len(place):
        return np.zeros(3)
    nodal = _deflections(mesh, elements[some], xi[some], force[some])
    left = cut.on_left(mesh, spread.region, spread.order, spread.levels)
    on = cut.elements[left.elements]
    share = _deflections(mesh, on, left.xi, left.weights * spread.pressure(on, left.positions))
    on_left = np.einsum("qcd,qd->c", cut.motion[left.elements], share)
    return np.asarray(cut.work(place, nodal, np.zeros(len(place))).sum(axis=0) - on_left)


def footprints_of(mesh: Mesh, supports: Sequence[Support], acting: Acting) -> dict[int, tuple[Part, Quadrature]]:
    """Footprints of the rows that have one, and points all over them."""
    result = {}
    for index, support in enumerate(supports):
        shapes = footprints(support)
        for row in np.flatnonzero(acting.support == index).tolist() if shapes else ():
            shape = shapes[acting.numbers[row]]
            result[row] = shape, area_quadrature(mesh, shape, _ORDER)
    return result


def of_supports(
    cut: Cut,
    mesh: Mesh,
    supports: Sequence[Support],
    acting: Acting,
    prints: Mapping[int, tuple[Part, Quadrature]],
) -> Floats:
    """What a reaction of 1 along each row (m,), up, adds to moment, twist and shear (m, 3)."""
    result = np.zeros((len(acting.rows), 3))
    place, rows = placed(cut.elements, acting.rows.elements)
    areas = [index for index, support in enumerate(supports) if support.area is not None]
    spread = np.isin(acting.support[rows], areas) & ~_on_outline(mesh, acting, rows)
    left = np.where(spread, 0.0, cut.lefts(acting.positions[rows]))
    result[rows] = -cut.work(place, acting.rows.coefficients[rows], left)
    for row, (shape, over) in prints.items():
        pressure = -acting.direction[row] / over.total
        even = Spread.even(shape, pressure)
        result[row] = of_spread(cut, mesh, over.elements, over.xi, pressure * over.weights, even)
    rows = rows[spread]
    for index in np.unique(acting.support[rows]).tolist() if cut.divided().any() else ():
        for own, shares in _shares(cut, mesh, supports[index], acting, rows[acting.support[rows] == index]):
            result[own] += shares
    return result


def _on_outline(mesh: Mesh, acting: Acting, rows: Ints) -> Bools:
    """Which of some rows (q,) stand for points on the outline of an area that acts on means of elements."""
    # Others, footprints among them, need not be in their first element.
    result = acting.averaged[rows]
    rows = rows[result]
    elements = acting.rows.elements[rows]
    x, y = mesh.invert(elements, acting.positions[rows]).T
    in_triangles = np.minimum(np.minimum(x, y), 1.0 - x - y)
    inside = np.where(mesh.triangles[elements], in_triangles, 1.0 - np.maximum(np.abs(x), np.abs(y)))
    result[result] = inside < _AT_SIDE
    return result


def _shares(cut: Cut, mesh: Mesh, support: Support, acting: Acting, own: Ints) -> Iterator[tuple[Ints, Floats]]:
    """Yield the work that reactions of an area's rows, spread over their elements, do on the left (k, 3)."""
    region = support.area.region if isinstance(support.area, Area) else None
    left = cut.on_left(mesh, region, _ORDER, ())
    over = area_quadrature(mesh.part(cut.elements), region, _ORDER)
    rows = _deflections(mesh, cut.elements[left.elements], left.xi, left.weights)
    work = np.einsum("qcd,qd->qc", cut.motion[left.elements], rows)
    for at in np.unique(left.elements).tolist():
        here, all_over = left.elements == at, over.elements == at
        mine = own[acting.rows.elements[own] == cut.elements[at]]
        middle, size = over.positions[all_over].mean(axis=0), np.sqrt(over.weights[all_over].sum())
        # The pressure that is linear over what the area has of the element, with the resultants of its points.
        linear, every, points = (
            np.column_stack([np.ones(len(p)), (p - middle) / size])
            for p in (left.positions[here], over.positions[all_over], acting.positions[mine])
        )
        inverse = np.linalg.pinv(every.T @ (over.weights[all_over, None] * every), rcond=_FLAT, hermitian=True)
        yield mine, acting.direction[mine, None] * (points @ inverse @ (linear.T @ work[here]))


def _deflections(mesh: Mesh, elements: Ints, xi: Floats, force: Floats) -> Floats:
    """Rows (q, 24) of the deflection at points of elements, times forces (q,)."""
    rows = np.zeros((len(elements), 24))
    rows[:, ::3] = force[:, None] * mesh.shape_functions(elements, xi)
    return rows
