"""What loads and supports do in the elements that a section divides, on the left of its line."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from signorini.discretise.quadrature import Quadrature, area_quadrature
from signorini.discretise.quadrature.stepped import Levels
from signorini.discretise.rows import Floats, Ints, Rows
from signorini.discretise.sections.cut import Cut, placed
from signorini.mesh import Mesh
from signorini.model import Area, Support
from signorini.model.footprint import footprints
from signorini.shapes.cuts import Part

_ORDER = 3
_FLAT = 1e-9
"""Part of the largest below which an element's points tell no slope of the pressure: they are on a line, or one."""


@dataclass(frozen=True, eq=False)
class Spread:
    """A pressure over a region, or over the plate, at points (q, 2) of elements (q,); it may jump where levels do."""

    region: Part | None
    order: int
    levels: Levels
    pressure: Callable[[Ints, Floats], Floats]


@dataclass(frozen=True, eq=False)
class Acting:
    """What supports act through: rows (m,), positions, weights, directions, whose and which of its points they are."""

    rows: Rows
    positions: Floats
    weights: Floats
    direction: Floats
    support: Ints
    numbers: Ints


def of_points(cut: Cut, mesh: Mesh, elements: Ints, xi: Floats, positions: Floats, force: Floats) -> Floats:
    """What forces (q,) at points (q, 2) of elements (q,) add to moment, twist and shear (3,)."""
    place, some = placed(cut.elements, elements)
    rows = _deflections(mesh, elements[some], xi[some], force[some])
    return np.asarray(cut.work(place, rows, cut.lefts(positions[some])).sum(axis=0))


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
    found = {}
    for index, support in enumerate(supports):
        shapes = footprints(support)
        for row in np.flatnonzero(acting.support == index).tolist() if shapes else ():
            shape = shapes[acting.numbers[row]]
            found[row] = shape, area_quadrature(mesh, shape, _ORDER)
    return found


def of_supports(
    cut: Cut,
    mesh: Mesh,
    supports: Sequence[Support],
    acting: Acting,
    prints: Mapping[int, tuple[Part, Quadrature]],
) -> Floats:
    """What a reaction of 1 along each row (m,), up, adds to moment, twist and shear (m, 3)."""
    found = np.zeros((len(acting.rows), 3))
    place, rows = placed(cut.elements, acting.rows.elements)
    in_areas = np.isin(acting.support, [i for i, support in enumerate(supports) if support.area is not None])
    left = np.where(in_areas[rows], 0.0, cut.lefts(acting.positions[rows]))
    found[rows] = -cut.work(place, acting.rows.coefficients[rows], left)
    for row, (shape, over) in prints.items():
        pressure = -acting.direction[row] / over.total
        even = Spread(shape, _ORDER, (), lambda _, at, of=pressure: np.full(len(at), of))  # type: ignore[misc]
        found[row] = of_spread(cut, mesh, over.elements, over.xi, pressure * over.weights, even)
    for index in np.unique(acting.support[rows[in_areas[rows]]]).tolist() if cut.divided().any() else ():
        for own, shares in _shares(cut, mesh, supports[index], acting, rows[acting.support[rows] == index]):
            found[own] += shares
    return found


def _shares(cut: Cut, mesh: Mesh, support: Support, acting: Acting, own: Ints) -> Iterator[tuple[Ints, Floats]]:
    """Yield the work that reactions of an area's rows, spread over their elements, do on the left (k, 3)."""
    region = support.area.region if isinstance(support.area, Area) else None
    left = cut.on_left(mesh, region, _ORDER, ())
    rows = _deflections(mesh, cut.elements[left.elements], left.xi, left.weights)
    work = np.einsum("qcd,qd->qc", cut.motion[left.elements], rows)
    for at in np.unique(left.elements).tolist():
        here = left.elements == at
        middle, size = left.positions[here].mean(axis=0), np.sqrt(mesh.element_area[cut.elements[at]])
        for way in (1.0, -1.0):
            mine = own[(acting.rows.elements[own] == cut.elements[at]) & (acting.direction[own] == way)]
            if not len(mine):
                continue
            # The pressure that is linear in the element and has the resultants of its points.
            linear, known = (
                np.column_stack([np.ones(len(p)), (p - middle) / size])
                for p in (left.positions[here], acting.positions[mine])
            )
            inverse = np.linalg.pinv(known.T @ (acting.weights[mine, None] * known), rcond=_FLAT, hermitian=True)
            yield mine, way * known @ inverse @ (linear.T @ work[here])


def _deflections(mesh: Mesh, elements: Ints, xi: Floats, force: Floats) -> Floats:
    """Rows (q, 24) of the deflection at points of elements, times forces (q,)."""
    rows = np.zeros((len(elements), 24))
    rows[:, ::3] = force[:, None] * mesh.shape_functions(elements, xi)
    return rows
