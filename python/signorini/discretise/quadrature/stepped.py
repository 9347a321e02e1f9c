"""Quadrature of functions that jump along curves which the mesh does not follow.

The curves are the zeros of level functions. An element that a curve crosses is quartered until, in every part, each
level that changes sign is linear up to a tolerance. The part is then cut into triangles along the zero of the linear
function. Straight steps in elements with straight parallel sides are integrated exactly without quartering. Cuts along
other curves deviate by at most `OFF` element sides.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from signorini.discretise.quadrature.rules import Quadrature, collapsed, gauss
from signorini.discretise.rows import Bools, Floats, Ints, Table
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import TRIANGLE_CORNERS
from signorini.shapes.cuts import Part

_EMPTY = 1e-14
"""Smallest area of a triangle that is kept, relative to the area of its box."""


Levels = Sequence[Callable[[Floats], Floats]]
"""Level functions of positions (q, 2): each function changes sign at a step of the integrand. NaN counts as negative.
"""
OFF = 1e-4
"""Largest deviation of a cut from a curved step, relative to the side of the element."""
_DEEPEST = 7
"""Largest number of times that an element is subdivided."""
INSIDE = 1.0 - 1e-6
"""Distance of the outermost sample points from an element's middle, relative to that of the sides."""
_PARTED = 0.4863
"""Position at which the side of a box is divided, relative to its length.

Jumps often run along the middle, which is therefore avoided.
"""
_SEEN = 9
"""Number of sample points of an element in each direction; features below an eighth of the element may be missed."""
_CHUNK = 200_000
"""Largest number of sample points that are evaluated at once, to limit memory."""
_HYPOTENUSE = np.array([1.0, -1.0, -1.0])
"""Coefficients of the plane 1 − ξ − η, positive inside the reference triangle."""


@dataclass(frozen=True, eq=False)
class Triangles(Table):
    """Triangles in boxes, which are parts of elements in ξ and η.

    ``box`` (t,) is the index of each triangle's box, ``corners`` are (t, 3, 2).
    """

    box: Ints
    corners: Floats
    box_area: Floats

    @classmethod
    def of_boxes(cls, which: Ints, boxes: Floats) -> Triangles:
        """Divide boxes (k, 4) along a diagonal into two triangles each; ``which`` (k,) are the indices of the boxes.

        A box is given by its lower and upper corner.
        """
        x0, y0, x1, y1 = boxes.T
        a, b, c, d = (np.column_stack(corner) for corner in ((x0, y0), (x1, y0), (x1, y1), (x0, y1)))
        corners = np.stack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)], axis=1)
        return cls(np.repeat(which, 2), corners.reshape(-1, 3, 2), np.repeat((x1 - x0) * (y1 - y0), 2))

    @property
    def area(self) -> Floats:
        """Areas (t,) of the triangles."""
        (ax, ay), (bx, by) = ((self.corners[:, i] - self.corners[:, 0]).T for i in (1, 2))
        return np.asarray(0.5 * np.abs(ax * by - ay * bx))


def split(triangles: Triangles, planes: Floats, changes: Bools) -> tuple[Triangles, Ints, Floats]:
    """Cut triangles in boxes marked in ``changes`` (c,) along p₀ + p₁ξ + p₂η = 0; p is the box's row of ``planes``.

    Return the uncut triangles and the parts of the others, then the box (f,) and the ends (f, 2, 2) of each cut.
    """
    boxes = triangles.box
    value = planes[boxes, :1] + np.einsum("tij,tj->ti", triangles.corners, planes[boxes, 1:])
    above = value > 0.0
    count = above.sum(axis=1)
    cut = changes[boxes] & (count > 0) & (count < 3)
    if not cut.any():
        return triangles, np.zeros(0, dtype=np.int64), np.zeros((0, 2, 2))
    alone = (above[cut] == (count[cut] == 1)[:, None]).argmax(axis=1)
    turn = (alone[:, None] + np.arange(3)) % 3
    rows = np.arange(len(turn))[:, None]
    corners, heights = triangles.corners[cut][rows, turn], value[cut][rows, turn]
    share = (heights[:, :1] / (heights[:, :1] - heights[:, 1:]))[..., None]
    ends = corners[:, :1] + share * (corners[:, 1:] - corners[:, :1])
    p, q, r, a, b = corners[:, 0], corners[:, 1], corners[:, 2], ends[:, 0], ends[:, 1]
    parts = np.concatenate([np.stack(part, axis=1) for part in ((p, a, b), (a, q, r), (a, r, b))])
    triangles_made = Triangles(
        np.concatenate([boxes[~cut], np.tile(boxes[cut], 3)]),
        np.concatenate([triangles.corners[~cut], parts]),
        np.concatenate([triangles.box_area[~cut], np.tile(triangles.box_area[cut], 3)]),
    )
    return triangles_made.pick(triangles_made.area > _EMPTY * triangles_made.box_area), boxes[cut], ends


def gauss_on_triangles(triangles: Triangles, order: int) -> tuple[Ints, Floats, Floats]:
    """Box (q,), point (q, 2) and weight (q,) of Gauss rules that are collapsed to the triangles."""
    unit, weights = collapsed(TRIANGLE_CORNERS[:3], gauss(order), gauss(order))
    shape, weights = np.column_stack([1.0 - unit.sum(axis=1), unit]), 2.0 * weights
    points = np.einsum("sk,tkd->tsd", shape, triangles.corners).reshape(-1, 2)
    return np.repeat(triangles.box, order**2), points, (triangles.area[:, None] * weights).ravel()


def gauss_on_boxes(boxes: Floats, order: int) -> tuple[Ints, Floats, Floats]:
    """Box (q,), point (q, 2) and weight (q,) of Gauss rules on boxes (k, 4)."""
    node, weight = gauss(order)
    station = np.stack(np.meshgrid(node, node, indexing="ij"), axis=-1).reshape(-1, 2)
    middle, half = 0.5 * (boxes[:, :2] + boxes[:, 2:]), 0.5 * (boxes[:, 2:] - boxes[:, :2])
    points = middle[:, None] + half[:, None] * station
    weights = half.prod(axis=1)[:, None] * np.outer(weight, weight).ravel()
    return np.repeat(np.arange(len(boxes)), order**2), points.reshape(-1, 2), weights.ravel()


class Cut(NamedTuple):
    """Quadrature of elements that are cut by steps, and the segments of the steps in these elements.

    Segments have the elements ``front_elements`` (f,) and the ends ``fronts`` (f, 2, 2) in reference coordinates.
    """

    points: Quadrature
    front_elements: Ints
    fronts: Floats


def sides_of(region: Part) -> list[Callable[[Floats], Floats]]:
    """Level functions of a region's outline, which are zero on its extended sides and full circles."""
    outline = region.outline
    return [
        *(partial(_across, side) for side in outline.segments),
        *(partial(_beyond, c) for c in outline.whole_circles),
    ]


def _across(side: Floats, points: Floats) -> Floats:
    (ax, ay), (bx, by) = side
    return np.asarray((bx - ax) * (points[:, 1] - ay) - (by - ay) * (points[:, 0] - ax))


def _beyond(circle: Floats, points: Floats) -> Floats:
    x, y, radius = circle
    return np.asarray(np.hypot(points[:, 0] - x, points[:, 1] - y) - radius)


def crossed(mesh: Mesh, elements: Ints, levels: Levels) -> Bools:
    """Mask (levels, k) of the elements (k,) in which each level changes sign."""
    result = np.zeros((len(levels), len(elements)), dtype=bool)
    stations = _square(_SEEN)
    step = _CHUNK // len(stations)
    for start in range(0, len(elements) if len(levels) else 0, step):
        part = elements[start : start + step]
        points = mesh.spread(part, stations, INSIDE).reshape(-1, 2)
        for i, level in enumerate(levels):
            above = (level(points) > 0.0).reshape(len(part), -1)
            result[i, start : start + step] = above.any(axis=1) & ~above.all(axis=1)
    return result


def among(levels: Levels, across: Bools) -> list[Callable[[Floats], Floats]]:
    """Select the level functions that change sign in at least one element, by their mask ``across`` (levels, k)."""
    return [level for level, crossed_elements in zip(levels, across, strict=True) if crossed_elements.any()]


def cut_by(
    mesh: Mesh,
    elements: Ints,
    levels: Levels,
    order: int,
    off: float = OFF,
    quarter: bool = False,
) -> Cut:
    """Quadrature over elements (k,) of a function that is smooth except where a level changes sign.

    Parts have up to ``order`` Gauss points in each direction. A cut deviates from its step by at most ``off``, relative
    to the element's side; after seven subdivisions the cut is accepted with a larger deviation. With ``quarter`` no
    part extends over the middle lines of a quadrilateral.
    """
    # A triangle fills only half of its box; the other half is cut off.
    owner, boxes = elements, np.where(mesh.triangles[elements, None], [0.0, 0, 1, 1], [-1.0, -1, 1, 1])
    crossing = np.ones((len(owner), len(levels)), dtype=bool)
    points: list[tuple[Ints, Floats, Floats]] = []
    # The list of step pieces begins with an empty array, since the samples may detect no step.
    fronts = [(np.zeros(0, np.int64), np.zeros((0, 2, 2)))]
    for depth in range(_DEEPEST + 1):
        if not len(owner):
            break
        changes, planes, bent = _planes(mesh, owner, boxes, levels, crossing, _SEEN if depth == 0 else 5)
        # A part of an element can only be crossed by levels that cross the element.
        crossing = changes if depth == 0 else crossing
        ready = np.logical_or((bent <= 2.0 * off).all(axis=1), depth == _DEEPEST)
        if quarter:
            # Boxes are also divided at the elements' middle lines ξ = 0 and η = 0.
            axes = np.broadcast_to([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], (len(boxes), 2, 3))
            changes = np.hstack([changes, (boxes[:, :2] < 0.0) & (boxes[:, 2:] > 0.0)])
            planes = np.concatenate([planes, axes], axis=1)
        over_hypotenuse = mesh.triangles[owner] & (boxes[:, 2:].sum(axis=1) > 1.0)
        clear = ready & ~changes.any(axis=1) & ~over_hypotenuse
        fewer = max(2, order - depth)
        square, xi, weights = gauss_on_boxes(boxes[clear], fewer)
        points.append((owner[clear][square], xi, weights))
        triangles = Triangles.of_boxes(np.flatnonzero(ready & ~clear), boxes[ready & ~clear])
        if over_hypotenuse.any():
            triangles, _, _ = split(triangles, np.tile(_HYPOTENUSE, (len(owner), 1)), over_hypotenuse)
            triangles = triangles.pick(
                ~over_hypotenuse[triangles.box] | (triangles.corners.mean(axis=1).sum(axis=1) < 1.0)
            )
        for i in np.flatnonzero(changes.any(axis=0)):
            triangles, square, ends = split(triangles, planes[:, i], changes[:, i])
            if i < len(levels):
                fronts.append((owner[square], ends))
        square, xi, weights = gauss_on_triangles(triangles, fewer)
        points.append((owner[square], xi, weights))
        owner, boxes, crossing = owner[~ready].repeat(4), _quartered(boxes[~ready]), crossing[~ready].repeat(4, axis=0)
        inside = ~mesh.triangles[owner] | (boxes[:, :2].sum(axis=1) < 1.0)
        owner, boxes, crossing = owner[inside], boxes[inside], crossing[inside]
    element, xi, weights = (np.concatenate(part) for part in zip(*points, strict=True))
    by_element = np.argsort(element, kind="stable")
    element, xi, weights = element[by_element], xi[by_element], weights[by_element]
    front_elements, ends = (np.concatenate(part) for part in zip(*fronts, strict=True))
    weights = weights * np.linalg.det(mesh.jacobian(element, xi))
    return Cut(Quadrature(element, xi, weights, mesh.map(element, xi)), front_elements, ends)


def _planes(
    mesh: Mesh, owner: Ints, boxes: Floats, levels: Levels, crossing: Bools, count: int
) -> tuple[Bools, Floats, Floats]:
    """Fit planes c₀ + c₁ξ + c₂η to levels in boxes.

    Return whether each level changes sign in each box (c, l), the planes (c, l, 3), and their largest errors (c, l) as
    distances in reference coordinates. Only levels in the mask ``crossing`` (c, l) are evaluated.
    """
    stations, shape = INSIDE * _square(count), (len(owner), len(levels))
    changes, planes, bent = np.zeros(shape, dtype=bool), np.zeros((*shape, 3)), np.zeros(shape)
    terms = np.column_stack([np.ones(len(stations)), stations])
    fit = np.linalg.pinv(terms)
    middle, half = 0.5 * (boxes[:, :2] + boxes[:, 2:]), 0.5 * (boxes[:, 2:] - boxes[:, :2])
    xi = (middle[:, None] + half[:, None] * stations).reshape(-1, 2)
    points = mesh.map(np.repeat(owner, len(stations)), xi).reshape(len(owner), -1, 2)
    for i, level in enumerate(levels):
        rows = np.flatnonzero(crossing[:, i])
        values = level(points[rows].reshape(-1, 2)).reshape(len(rows), len(stations))
        above = values > 0.0
        changing = above.any(axis=1) & ~above.all(axis=1)
        changes[rows, i] = changing
        values = np.where(np.isfinite(values), values, -1.0)
        local = values @ fit.T
        worst = np.abs(values - local @ terms.T).max(axis=1)
        slopes = local[:, 1:] / half[rows]
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = np.nan_to_num(worst / np.hypot(*slopes.T), nan=np.inf)
        bent[rows, i] = np.where(changing, distance, 0.0)
        planes[rows, i] = np.column_stack([local[:, 0] - (slopes * middle[rows]).sum(axis=1), slopes])
    return changes, planes, bent


def _quartered(boxes: Floats) -> Floats:
    low, high = boxes[:, :2], boxes[:, 2:]
    ends = np.stack([low, low + _PARTED * (high - low), high], axis=1)
    i, j = np.divmod(np.arange(4), 2)
    parts = [ends[:, i, 0], ends[:, j, 1], ends[:, i + 1, 0], ends[:, j + 1, 1]]
    return np.stack(parts, axis=2).reshape(-1, 4)


def _square(count: int) -> Floats:
    """Evenly spaced points (count², 2) of the reference square, including points on its sides."""
    along = np.linspace(-1.0, 1.0, count)
    return np.stack(np.meshgrid(along, along, indexing="ij"), axis=-1).reshape(-1, 2)
