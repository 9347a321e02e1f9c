"""Quadrature over the intersection of each element with a region.

An element is cut into strips along y at every corner, turning point and crossing of its sides and the region's outline.
Within a strip these curves neither begin, end nor cross. So each cell between two of them has one smooth curve below
and one above, and Gauss rules apply. A square-root end (a vertical tangent) is removed by substitution, as in the
height-function quadrature of Saye (2015). Cells are bisected until area and first moments have converged.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from signorini.discretise.quadrature.crossings import (
    between_circles,
    quadratics,
    together,
    touched,
    with_circles,
    with_segments,
)
from signorini.discretise.quadrature.rules import Rule, gauss
from signorini.discretise.rows import Bools, Floats, Ints, Table
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import real_sides
from signorini.shapes.cuts import Part

_STRAIGHT = 1e-14
"""Largest quadratic term of a side that counts as straight, relative to its coordinates."""
_THIN = 1e-13
"""Strips, covered areas and weights of points up to this part of the element or cell are left out as rounding."""
_ROUNDED = 8.0 * np.finfo(float).eps
"""Least width of a strip, relative to the element's coordinates: ends of neighbouring sides differ by rounding."""
_SLIVER = 1e-12
"""Largest uncovered area of an element that counts as whole, relative to the element's area."""
_ALONG = 1e-9
"""Largest distance of nodes from a circle that the mesh follows, relative to the mesh's size."""
_CONVERGED = 1e-13
"""Convergence tolerance for moments of bisected cells, relative to the area of the element's box or region."""
_CURVED_POINTS = 8
"""Number of Gauss points along x in a cell bounded by curves."""
_BISECTIONS = 40
"""Largest number of bisections of a cell."""


@dataclass(frozen=True, eq=False)
class Pieces(Table):
    """Curves y(x) between ``ends`` (p, 2) in x: sides of cut elements ``owner`` (p,), or parts of the outline in them.

    ``quadratic`` (p, 2, 3) has the coefficients of x(t) and y(t), with x monotone in t; NaN for half circles.
    ``circle`` (p, 3) has centre and radius of half circles; NaN for quadratics. ``sign`` (p,) is the sign of dx/dt; for
    half circles +1 is the upper half, −1 the lower one. ``turns`` (p, 2) marks vertical tangents at the ends.
    """

    owner: Ints
    is_side: Bools
    quadratic: Floats
    circle: Floats
    sign: Floats
    ends: Floats
    turns: Bools

    @classmethod
    def of_quadratics(cls, owner: Ints, curves: Floats, is_side: bool) -> Pieces:
        """Split quadratic curves (k, 2, 3) on −1 ≤ t ≤ 1 at the extremum of x, so that x is monotone."""
        x0, x1, x2 = curves[:, 0].T
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = np.clip(np.nan_to_num(-x1 / (2.0 * x2), nan=1.0), -1.0, 1.0)
        t = np.stack([np.column_stack([-np.ones_like(turn), turn]), np.column_stack([turn, np.ones_like(turn)])])
        x = x0[:, None] + t * (x1[:, None] + t * x2[:, None])
        x = x.reshape(-1, 2)
        at_turn = (np.abs(x1[:, None] + 2.0 * x2[:, None] * t) <= 1e-12 * np.abs(x2)[:, None]).reshape(-1, 2)
        at_turn &= np.tile(x2 != 0.0, 2)[:, None]
        falls = x[:, 1] < x[:, 0]
        order = np.where(falls[:, None], [1, 0], [0, 1])
        return cls(
            owner=np.tile(owner, 2),
            is_side=np.full(len(x), is_side),
            quadratic=np.tile(curves, (2, 1, 1)),
            circle=np.full((len(x), 3), np.nan),
            sign=np.where(falls, -1.0, 1.0),
            ends=np.take_along_axis(x, order, axis=1),
            turns=np.take_along_axis(at_turn, order, axis=1),
        )

    @classmethod
    def of_circles(cls, owner: Ints, circles: Floats) -> Pieces:
        """Split circles (k, 3) into their lower and upper halves."""
        halves = np.tile(circles, (2, 1))
        return cls(
            owner=np.tile(owner, 2),
            is_side=np.zeros(len(halves), dtype=bool),
            quadratic=np.full((len(halves), 2, 3), np.nan),
            circle=halves,
            sign=np.repeat([-1.0, 1.0], len(circles)),
            ends=halves[:, :1] + halves[:, 2:] * np.array([-1.0, 1.0]),
            turns=np.ones((len(halves), 2), dtype=bool),
        )

    @property
    def straight(self) -> Bools:
        """Mask (p,) of straight pieces."""
        return np.asarray((self.quadratic[..., 2] == 0.0).all(axis=1))

    def height(self, index: Ints, x: Floats) -> Floats:
        """Height y (k,) at x (k,) on the pieces with indices (k,)."""
        y = np.empty(len(x))
        round_ = np.isnan(self.quadratic[index, 0, 0])
        y[round_] = self._on_circle(index[round_], x[round_])
        y[~round_] = self._on_quadratic(index[~round_], x[~round_])
        return y

    def _on_circle(self, index: Ints, x: Floats) -> Floats:
        cx, cy, r = self.circle[index].T
        return np.asarray(cy + self.sign[index] * np.sqrt(np.maximum((r - (x - cx)) * (r + (x - cx)), 0.0)))

    def _on_quadratic(self, index: Ints, x: Floats) -> Floats:
        (x0, x1, x2), (y0, y1, y2) = self.quadratic[index].transpose(1, 2, 0)
        sign = self.sign[index]
        # ``root`` is dx/dt. Of the two formulas for t, the formula without cancellation is taken at each x.
        root = sign * np.sqrt(np.maximum(x1 * x1 + 4.0 * x2 * (x - x0), 0.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.where(x1 * sign > 0.0, 2.0 * (x - x0) / (x1 + root), (root - x1) / (2.0 * x2))
        t = np.clip(np.nan_to_num(t), -1.0, 1.0)
        return np.asarray(y0 + t * (y1 + t * y2))


@dataclass(frozen=True, eq=False)
class Parts:
    """Parts of a mesh in a region: ``whole`` elements (k,), and points (q, 2) with weights (q,) in cut elements (q,).

    ``factors`` (k,) are areas of whole elements bounded by true arcs, relative to areas bounded by parabolas.
    """

    whole: Ints
    factors: Floats
    elements: Ints
    positions: Floats
    weights: Floats


@dataclass(frozen=True, eq=False)
class _Cells(Table):
    """Cells of cut elements ``owner`` (c,): range in x (c, 2), lower and upper curve (c, 2), vertical end tangents."""

    owner: Ints
    x: Floats
    between: Ints
    singular: Bools

    def halves(self) -> _Cells:
        left, right, middle = self.x.copy(), self.x.copy(), self.x.mean(axis=1)
        left[:, 1] = right[:, 0] = middle
        first, second = self.singular & [True, False], self.singular & [False, True]
        return _Cells.join([replace(self, x=left, singular=first), replace(self, x=right, singular=second)])


def cut(mesh: Mesh, region: Part, order: int, rule: Rule = gauss, follow: bool = False) -> Parts:
    """Intersect a mesh with a region, whose outline may cut elements anywhere, or leave the mesh.

    ``rule`` is Gauss's, or Lobatto's with points on the outline; it has ``order`` points across a strip. With
    ``follow``, element sides replace the arcs of the outline that they approximate: slivers between side and arc have
    no points.
    """
    x0, y0, x1, y1 = region.bounds
    boxes = mesh.boxes
    near = (boxes[:, 0] <= x1) & (boxes[:, 2] >= x0) & (boxes[:, 1] <= y1) & (boxes[:, 3] >= y0)
    candidates = np.flatnonzero(near)
    by_segment, segment, by_circle, circle = touched(boxes[candidates], region.outline, _THIN * mesh.size)
    factors = np.ones(len(mesh.elements))
    if follow:
        along, gained = _along_circles(mesh, candidates[by_circle], region.outline.whole_circles[circle])
        np.add.at(factors, candidates[by_circle[along]], gained / mesh.element_area[candidates[by_circle[along]]])
        by_circle, circle = by_circle[~along], circle[~along]
    cut_ = np.union1d(by_segment, by_circle)
    clear = np.delete(candidates, cut_)
    centres = mesh.map(clear, mesh.inward(clear, np.zeros((len(clear), 2)), 0.0))
    whole, cut_elements = clear[region.contains(centres)], candidates[cut_]
    owners = (np.searchsorted(cut_, by_segment), np.searchsorted(cut_, by_circle))
    # Coordinates are relative to the region's middle, so that rounding does not decide the order of touching curves.
    origin = np.array([0.5 * (x0 + x1), 0.5 * (y0 + y1)])
    sides = mesh.points[mesh.sides[cut_elements]] - origin
    segments, circles = region.outline.segments[segment] - origin, region.outline.whole_circles[circle]
    pieces, breaks = _pieces(sides, owners, segments, circles - np.append(origin, 0.0))
    local, rounding = boxes[cut_elements] - np.tile(origin, 2), _ROUNDED * np.abs(boxes[cut_elements]).max(axis=1)
    cells = _cells(pieces, _strips(*breaks, local, rounding), region, origin)
    owner, positions, weights = _integrate(pieces, cells, local, region.area, order, rule)
    positions += origin
    area, covered = mesh.element_area[cut_elements], np.bincount(owner, weights, len(cut_elements))
    full = covered >= (1.0 - _SLIVER) * area
    longest = np.minimum((local[:, 2:] - local[:, :2]).max(axis=1), max(x1 - x0, y1 - y0))
    least = np.maximum(_THIN * np.minimum(area, region.area), rounding * longest)
    keep = (~full & (covered > least))[owner]
    whole = np.sort(np.concatenate([whole, cut_elements[full]]))
    return Parts(whole, factors[whole], cut_elements[owner[keep]], positions[keep], weights[keep])


def _along_circles(mesh: Mesh, elements: Ints, circles: Floats) -> tuple[Bools, Floats]:
    """Mask (k,) of elements with a side on their circle (k, 3), and areas between these sides and the circle's arcs.

    Only elements that are entirely inside or outside the circle are marked. Each marked element has one area, the sum
    over its sides, positive within the circle.
    """
    off = np.hypot(*np.moveaxis(mesh.nodes[elements] - circles[:, None, :2], -1, 0)) - circles[:, 2:]
    on_circle, slack = np.abs(off) <= _ALONG * mesh.size, _ALONG * mesh.size
    sides = mesh.sides[elements]
    local = (mesh.elements[elements][:, None, None] == sides[..., None]).argmax(axis=-1)
    arcs = np.take_along_axis(np.repeat(on_circle[:, None], 4, axis=1), local, axis=2).all(axis=2)
    arcs &= real_sides(mesh.elements[elements])
    within, beyond = (off <= slack).all(axis=1), (off >= -slack).all(axis=1)
    along = arcs.any(axis=1) & (within | beyond)
    a, middle, b = np.moveaxis(mesh.points[sides], 2, 0)
    chord, radius = np.hypot(*np.moveaxis(b - a, -1, 0)), circles[:, 2:]
    rise = np.hypot(*np.moveaxis(middle - 0.5 * (a + b), -1, 0))
    angle = 2.0 * np.arcsin(np.minimum(0.5 * chord / radius, 1.0))
    between = 0.5 * radius**2 * (angle - np.sin(angle)) - 2.0 / 3.0 * chord * rise
    gained = np.where(arcs, between, 0.0).sum(axis=1) * np.where(within, 1.0, -1.0)
    return along, gained[along]


def _pieces(
    sides: Floats, owners: tuple[Ints, Ints], segments: Floats, circles: Floats
) -> tuple[Pieces, tuple[Ints, Floats]]:
    """Curves of every cut element with sides (c, 4, 3, 2), and the element and x of each end of a strip."""
    by_segment, by_circle = owners
    curves = quadratics(sides.reshape(-1, 3, 2))
    # A side whose bend is within rounding counts as straight.
    size = np.abs(curves[..., 1]).max(axis=1) + np.abs(curves[..., 0]).max(axis=1)
    curves[np.abs(curves[..., 2]).max(axis=1) <= _STRAIGHT * size, :, 2] = 0.0
    sides = curves.reshape(-1, 4, 2, 3)
    middles = 0.5 * (segments[:, :1] + segments[:, 1:])
    lines = quadratics(np.concatenate([segments[:, :1], middles, segments[:, 1:]], axis=1))
    lines[..., 2] = 0.0
    pieces = Pieces.join(
        [
            Pieces.of_quadratics(np.repeat(np.arange(len(sides)), 4), sides.reshape(-1, 2, 3), is_side=True),
            Pieces.of_quadratics(by_segment, lines, is_side=False),
            Pieces.of_circles(by_circle, circles),
        ]
    )
    pieces = pieces.pick(np.argsort(pieces.owner, kind="stable"))
    with_line, line_points = with_segments(sides[by_segment].reshape(-1, 2, 3), np.repeat(segments, 4, axis=0))
    with_arc, arc_points = with_circles(sides[by_circle].reshape(-1, 2, 3), np.repeat(circles, 4, axis=0))
    arc, line = together(by_circle, by_segment)
    on_line, corners = with_circles(lines[line], circles[arc])
    first_circle, second_circle = together(by_circle, by_circle)
    on_circle, tips = between_circles(circles[first_circle], circles[second_circle])
    owners_of_x = np.repeat(pieces.owner, 2), by_segment[with_line // 4], by_circle[with_arc // 4]
    owner = np.concatenate([*owners_of_x, by_circle[arc[on_line]], by_circle[first_circle[on_circle]]])
    x = np.concatenate(
        [pieces.ends.ravel(), *(positions[:, 0] for positions in (line_points, arc_points, corners, tips))]
    )
    return pieces, (owner, x)


def _strips(owner: Ints, x: Floats, boxes: Floats, rounding: Floats) -> tuple[Ints, Floats]:
    """Strips between neighbouring breaks ``x`` in each element's box: elements (s,) and ranges (s, 2) in x.

    Breaks nearer to each other than the rounding (c,) of the element's coordinates are merged.
    """
    x = np.clip(x, boxes[owner, 0], boxes[owner, 2])
    order = np.lexsort((x, owner))
    owner, x = owner[order], x[order]
    low, high = boxes[owner[:-1]][:, [0, 2]].T
    least = np.maximum(_THIN * (high - low), rounding[owner[:-1]])
    wide = (owner[1:] == owner[:-1]) & (np.diff(x) > least)
    return owner[:-1][wide], np.column_stack([x[:-1], x[1:]])[wide]


def _cells(pieces: Pieces, strips: tuple[Ints, Floats], region: Part, origin: Floats) -> _Cells:
    """Sort the curves through each strip; return the cells between them that lie in both the element and the region."""
    owner, x = strips
    starts = np.searchsorted(pieces.owner, [owner, owner + 1])
    counts = starts[1] - starts[0]
    strip = np.repeat(np.arange(len(owner)), counts)
    piece = np.arange(len(strip)) - np.repeat(np.cumsum(counts) - counts, counts) + starts[0][strip]
    middle = x.mean(axis=1)[strip]
    spans = (pieces.ends[piece, 0] < middle) & (middle < pieces.ends[piece, 1])
    strip, piece, middle = strip[spans], piece[spans], middle[spans]
    y = pieces.height(piece, middle)
    order = np.lexsort((y, strip))
    strip, piece, middle, y = strip[order], piece[order], middle[order], y[order]
    crossed = np.cumsum(pieces.is_side[piece])
    first = np.searchsorted(strip, strip)
    within = (crossed - crossed[first] + pieces.is_side[piece[first]]) % 2 == 1
    inside = (strip[1:] == strip[:-1]) & within[:-1] & (y[1:] > y[:-1])
    lower = np.flatnonzero(inside)
    lower = lower[region.contains(np.column_stack([middle[lower], 0.5 * (y[lower] + y[lower + 1])]) + origin)]
    between = np.column_stack([piece[lower], piece[lower + 1]])
    ranges = x[strip[lower]]
    reaches = np.abs(pieces.ends[between] - ranges[:, None]) <= 1e-12 * np.abs(np.diff(pieces.ends[between]))
    return _Cells(owner[strip[lower]], ranges, between, (pieces.turns[between] & reaches).any(axis=1))


def _integrate(
    pieces: Pieces, cells: _Cells, boxes: Floats, area: float, order: int, rule: Rule
) -> tuple[Ints, Floats, Floats]:
    """Elements, positions and weights of the quadrature points in the cells.

    Cells with curved bounds are bisected in x until their moments have converged.
    """
    straight = np.asarray(pieces.straight[cells.between].all(axis=1))
    done = [_points(pieces, cells.pick(straight), order + 1, order, rule)]
    cells = cells.pick(~straight)
    extent = boxes[:, 2:] - boxes[:, :2]
    tolerance = (_CONVERGED * np.minimum(extent.prod(axis=1), area))[:, None]
    noise = 4.0 * np.finfo(float).eps * np.nanmax(np.abs(pieces.circle), initial=np.abs(boxes).max(initial=0.0))
    for _ in range(_BISECTIONS):
        if not len(cells.owner):
            break
        coarse, halves = _moments(pieces, cells, boxes), cells.halves()
        fine = _moments(pieces, halves, boxes).reshape(2, -1, 3).sum(axis=0)
        rounding = noise * np.diff(cells.x)
        converged = (np.abs(fine - coarse) <= tolerance[cells.owner] + rounding).all(axis=1)
        done.append(_points(pieces, cells.pick(converged), _CURVED_POINTS, order, rule))
        cells = halves.pick(np.tile(~converged, 2))
    done.append(_points(pieces, cells, _CURVED_POINTS, order, rule))
    owner, positions, weights = (np.concatenate(parts) for parts in zip(*done, strict=True))
    by_owner = np.argsort(owner, kind="stable")
    return owner[by_owner], positions[by_owner], weights[by_owner]


def _stations(pieces: Pieces, cells: _Cells, rule: tuple[Floats, Floats]) -> tuple[Floats, Floats, Floats, Floats]:
    """Stations x of a rule in each cell, their weights, and lower and upper y at these stations, all (c, count)."""
    node, weight = rule
    t, w = 0.5 + 0.5 * node, 0.5 * weight
    maps = np.stack([t, t**2, 1.0 - (1.0 - t) ** 2, t**2 * (3.0 - 2.0 * t)])
    slopes = np.stack([np.ones_like(t), 2.0 * t, 2.0 - 2.0 * t, 6.0 * t * (1.0 - t)])
    kind = cells.singular @ np.array([1, 2])
    width = np.diff(cells.x)
    x = cells.x[:, :1] + width * maps[kind]
    low, high = (
        pieces.height(np.repeat(cells.between[:, side], len(node)), x.ravel()).reshape(x.shape) for side in range(2)
    )
    return x, width * slopes[kind] * w, low, np.maximum(high, low)


def _moments(pieces: Pieces, cells: _Cells, boxes: Floats) -> Floats:
    """Area and first moments (c, 3) of cells about the middle of the element's box, relative to the box's size."""
    x, weight, low, high = _stations(pieces, cells, gauss(_CURVED_POINTS))
    lower, upper = boxes[cells.owner, :2, None], boxes[cells.owner, 2:, None]
    (middle_x, middle_y), (extent_x, extent_y) = (np.moveaxis(f, 1, 0) for f in (0.5 * (lower + upper), upper - lower))
    height = weight * (high - low)
    moments = (height, height * (x - middle_x) / extent_x, height * (0.5 * (low + high) - middle_y) / extent_y)
    return np.stack([moment.sum(axis=1) for moment in moments], axis=1)


def _points(pieces: Pieces, cells: _Cells, count: int, order: int, rule: Rule) -> tuple[Ints, Floats, Floats]:
    """Elements (q,), positions (q, 2) and weights (q,) of the quadrature points in the cells."""
    x, weight, low, high = _stations(pieces, cells, rule(count))
    node, across = rule(order)
    y = 0.5 * (low + high)[..., None] + 0.5 * (high - low)[..., None] * node
    weights = weight[..., None] * 0.5 * (high - low)[..., None] * across
    positions = np.stack([np.broadcast_to(x[..., None], y.shape), y], axis=-1)
    owner = np.broadcast_to(cells.owner[:, None, None], y.shape)
    # Points at the tip of a cell have the weight 0 and are left out.
    positive = weights > _THIN * weights.sum(axis=(1, 2), keepdims=True)
    return owner[positive], positions[positive], weights[positive]
