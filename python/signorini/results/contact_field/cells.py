"""Elements of an elastic area that the edge of contact may cross, divided into cells and triangles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np

from signorini.discretise.laws import SupportLaw
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import are_triangles, real_sides
from signorini.results.contact_field.lines import Segments, zero_line
from signorini.shapes.tessellation import grid_shapes, tessellate


def positive_part(values: Floats) -> Floats:
    """Part of a triangle's area in which the linear function with corner values (..., 3) is positive.

    Examples
    --------
    >>> positive_part(np.array([[1.0, -1.0, -1.0], [1.0, 2.0, 3.0]]))
    array([0.25, 1.  ])
    """
    low, middle, high = np.moveaxis(np.sort(values, axis=-1), -1, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        one_above = high**2 / ((high - low) * (high - middle))
        two_above = 1.0 - low**2 / ((high - low) * (middle - low))
    part = np.where(middle > 0, two_above, one_above)
    return np.asarray(np.where(low >= 0, 1.0, np.where(high <= 0, 0.0, part)))


def both_positive_part(first: Floats, second: Floats) -> Floats:
    """Part of a triangle's area in which two linear functions with corner values (t, 3) are both positive.

    The triangle is cut into three where the first function is zero; the second function is linear on each part.

    Examples
    --------
    >>> x, y = np.array([[0.0, 1.0, 0.0]]), np.array([[0.0, 0.0, 1.0]])
    >>> both_positive_part(x - 0.5, y - 0.25), both_positive_part(0.5 - x, 0.5 - y)
    (array([0.0625]), array([0.5]))
    """
    above = (first > 0).sum(axis=1)
    result = np.where(above == 3, positive_part(second), 0.0)
    cut = (above == 1) | (above == 2)
    f, g, alone = first[cut], second[cut], above[cut] == 1
    odd = np.where(alone, f.argmax(axis=1), f.argmin(axis=1))
    turned = (odd[:, None] + np.arange(3)) % 3
    fa, fb, fc = np.take_along_axis(f, turned, axis=1).T
    ga, gb, gc = np.take_along_axis(g, turned, axis=1).T
    s, t = fa / (fa - fb), fa / (fa - fc)
    gs, gt = ga + s * (gb - ga), ga + t * (gc - ga)
    tip = s * t * positive_part(np.stack([ga, gs, gt], axis=1))
    rest = (1 - s) * positive_part(np.stack([gs, gb, gc], axis=1))
    rest += s * (1 - t) * positive_part(np.stack([gs, gc, gt], axis=1))
    result[cut] = np.where(alone, tip, rest)
    return result


_Values = TypeVar("_Values", Floats, Bools)

_FINEST = 12
_MOST_CELLS = 1_000_000
_AT_ONCE = 100_000
"""Largest number of vertices of cells whose values are computed at once, so that these values fit into the cache."""


def divisions(count: int) -> int:
    """Number d of cells along each side of an element, given how many elements are to be divided into d² cells."""
    return int(np.clip(2 * round(np.sqrt(_MOST_CELLS / max(count, 1)) / 2), 2, _FINEST))


class _Grid(NamedTuple):
    """Elements (e,) divided into d × d cells of two triangles each; ``triangles`` (e,) marks triangular elements."""

    shapes: Floats
    triangles: Bools
    depth: Floats
    """(e, d + 1, d + 1): depth of the vertices inside the support."""
    travel: tuple[Floats, Floats]
    """Settlement and gap of the support at the vertices, each (e, d + 1, d + 1)."""
    areas: Floats
    """(e, d, d, 2): areas of the two triangles of each cell."""
    whole: Bools
    """(e, d, d): mask of the cells that are wholly within the support."""
    outside: Bools
    inside: Floats
    """(e,): area of the part of each element that is within the support."""


@dataclass(frozen=True, eq=False)
class Cells:
    """Computes which part of each element on an elastic area is in contact, by dividing elements into cells."""

    mesh: Mesh
    law: SupportLaw
    covered: Bools  # (ne,): whether a part of each element is on the support
    depth: Callable[[Floats], Floats]  # maps positions (q, 2) to their depths (q,) inside the support

    def parts(self, deflection: Floats, crossed: Bools, touching: Floats) -> tuple[Ints, Ints, Floats]:
        """Compute the part in contact of each element that the edge of contact crosses, in k solutions.

        Returns three arrays (p,) for p pairs: number of the solution, number of the element, and part in contact, from
        0 to 1, of the element's area on the support. The part is NaN if no area of the element is on the support.
        Arguments are deflections (k, n), the mask (k, ne) of elements that the edge may cross, and zero tolerances (k,)
        of the overlap. Neighbours into which the edge continues are added. Overlap and depth are linear on each
        triangle.
        """
        crossed, known = crossed.copy(), []
        cuts = np.array([divisions(int(count)) for count in crossed.sum(axis=1)])
        own, elements = np.nonzero(crossed)
        across = self._across if len(own) else np.zeros((0, 4), np.int64)
        while True:
            parts, leaves = np.zeros(len(own)), np.zeros((len(own), 4), np.bool_)
            for cut in np.unique(cuts[own]).tolist():
                those = np.flatnonzero(cuts[own] == cut)
                different, place = np.unique(elements[those], return_inverse=True)
                grid, step = self._grid(different, cut), max(1, _AT_ONCE // (cut + 1) ** 2)
                for start in range(0, len(those), step):
                    some = those[start : start + step]
                    nodal = deflection[own[some, None], self.mesh.elements[elements[some]]]
                    at = place[start : start + step]
                    parts[some], leaves[some] = self._pressed(grid, at, nodal, touching[own[some]])
            known.append((own, elements, parts))
            more = np.zeros_like(crossed)
            pair, side = np.nonzero(leaves & (across[elements] >= 0))
            more[own[pair], across[elements[pair], side]] = True
            more &= self.covered & ~crossed
            if not more.any():
                whole = [np.concatenate(part) for part in zip(*known, strict=True)]
                return whole[0], whole[1], whole[2]
            crossed |= more
            own, elements = np.nonzero(more)

    def _pressed(self, grid: _Grid, place: Ints, nodal: Floats, touching: Floats) -> tuple[Floats, Bools]:
        """Parts (p,) in contact of elements ``place`` of a grid; mask (p, 4) of sides that the edge of contact cuts."""
        values = nodal @ grid.shapes[0].T
        if grid.triangles.any():
            of_triangle = grid.triangles[place]
            values[of_triangle] = nodal[of_triangle] @ grid.shapes[1].T
        values = values.reshape(-1, *grid.depth.shape[1:])
        settlement, gap = grid.travel
        values = self.law.overlap(values, (settlement[place], gap[place]))
        values[np.abs(values) <= touching[:, None, None]] = 0.0
        corners = _corners(values)
        low, high = np.minimum.reduce(corners), np.maximum.reduce(corners)
        whole = (low >= 0) & (high > 0) & grid.whole[place]
        pressed = np.einsum("pijt,pij->p", grid.areas[place], whole)
        # Cells whose overlap is unknown (NaN) are included; their area in contact becomes 0 below.
        at, i, j = np.nonzero(~(whole | (high < 0) | grid.outside[place]))
        which = place[at], i, j
        over = _of_triangles([corner[at, i, j] for corner in corners])
        deep = _of_triangles([corner[which] for corner in _corners(grid.depth)])
        area = np.where(np.isnan(over).any(axis=-1), 0.0, grid.areas[which])
        # A triangle with zero overlap at all corners is in contact if an adjacent triangle has a positive overlap.
        touches = (over == 0.0).all(axis=-1)
        if touches.any():
            cells = np.flatnonzero(touches.any(axis=1))
            beside = _beside(values[at[cells]] > 0)
            near = _of_triangles([corner[np.arange(len(cells)), i[cells], j[cells]] for corner in _corners(beside)])
            area[cells] *= ~touches[cells] | near.any(axis=-1)
        part = both_positive_part(deep.reshape(-1, 3), np.nan_to_num(over).reshape(-1, 3)).reshape(-1, 2)
        pressed += np.bincount(at, (area * part).sum(axis=1), len(place))
        inside = grid.inside[place]
        sides = (values[:, 0], values[:, :, -1], values[:, -1], values[:, :, 0])
        leaves = np.stack([(side > 0).any(axis=1) & (side < 0).any(axis=1) for side in sides], axis=1)
        return np.where(inside > 0, pressed / np.where(inside > 0, inside, 1.0), np.nan), leaves

    def _grid(self, elements: Ints, cut: int) -> _Grid:
        shapes, nodes = grid_shapes(cut), self.mesh.elements[elements]
        triangles, square = are_triangles(nodes), (len(elements), cut + 1, cut + 1)
        at = np.einsum("eva,eac->evc", shapes[triangles.astype(np.int64)], self.mesh.points[nodes])
        flat = at.reshape(-1, 2)
        depth = self.depth(flat).reshape(square)
        settlement, gap = (values.reshape(square) for values in self.law.travel(flat))
        x, y = (_of_triangles(_corners(part.reshape(square))) for part in np.moveaxis(at, -1, 0))
        areas = 0.5 * (
            (x[..., 1] - x[..., 0]) * (y[..., 2] - y[..., 0]) - (y[..., 1] - y[..., 0]) * (x[..., 2] - x[..., 0])
        )
        corners = _corners(depth)
        low, high = np.minimum.reduce(corners), np.maximum.reduce(corners)
        part = np.repeat((low > 0)[..., None], 2, axis=-1).astype(np.float64)
        cut_through = (low <= 0) & (high > 0)
        deep = _of_triangles([corner[cut_through] for corner in corners]).reshape(-1, 3)
        part[cut_through] = both_positive_part(deep, np.ones_like(deep)).reshape(-1, 2)
        known = ~np.isnan(_of_triangles(_corners(settlement + gap))).any(axis=-1)
        inside = np.where(known, areas * part, 0.0).sum(axis=(1, 2, 3))
        return _Grid(shapes, triangles, depth, (settlement, gap), areas, low > 0, high <= 0, inside)

    @property
    def _across(self) -> Ints:
        """Neighbour (ne, 4) of each element at each of its sides; −1 on the boundary."""
        elements = self.mesh.elements
        real, middles = real_sides(elements), elements[:, 4:]
        owner = np.arange(len(elements))[:, None] + 1
        both = np.bincount(middles[real], np.broadcast_to(owner, real.shape)[real], self.mesh.node_count)
        return np.where(real, both[middles].astype(np.int64) - owner - 1, -1)


def _corners(values: _Values) -> list[_Values]:
    """Values (e, d, d) at each of the four corners of all cells, counter-clockwise.

    ``values`` (e, d + 1, d + 1) are the values at the vertices of the grid.
    """
    return [values[:, :-1, :-1], values[:, :-1, 1:], values[:, 1:, 1:], values[:, 1:, :-1]]


def _of_triangles(corners: list[_Values]) -> _Values:
    """Values (..., 2, 3) at the corners of a cell's two triangles, from values (...) at the cell's four corners."""
    a, b, c, d = corners
    return np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=-2)


def _beside(pressed: Bools) -> Bools:
    """Mask (e, d + 1, d + 1) of all vertices of the triangles that have at least one vertex in the mask ``pressed``."""
    beside = np.zeros_like(pressed)
    a, b, c, d = _corners(pressed)
    first, second = a | b | c, a | c | d
    for corner, of in zip(_corners(beside), (first | second, first, first | second, second), strict=True):
        corner |= of
    return beside


def edge_of_contact(mesh: Mesh, law: SupportLaw, elements: Ints, deflection: Floats, touching: float) -> Segments:
    """Find the edge of contact of an elastic area within elements; overlaps of at most ``touching`` count as zero."""
    cut = tessellate(mesh.elements[elements], divisions(len(elements)))
    positions = cut.interpolate(mesh.points)
    values = law.overlap(cut.interpolate(deflection), law.travel(positions))
    values[np.abs(values) <= touching] = 0.0
    pressed = values > 0
    # A triangle with zero overlap at all corners is in contact if an adjacent triangle has a positive overlap.
    beside = np.zeros_like(pressed)
    beside[cut.triangles[pressed[cut.triangles].any(axis=1)]] = True
    known = cut.triangles[~np.isnan(values[cut.triangles]).any(axis=1)]
    return zero_line(positions, known, values, pressed | (beside & (values == 0)))
