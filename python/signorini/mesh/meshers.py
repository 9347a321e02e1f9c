"""Meshes of rectangles, discs, annuli, sectors and outlines; uniform division of a mesh."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from signorini._core import mesh_outline
from signorini.base.memory import require_memory
from signorini.base.reuse import shared
from signorini.errors import InputError
from signorini.mesh import Mesh
from signorini.mesh.divisions import ALONG_X, Axes, graded, subdivide
from signorini.shapes.arrays import Floats, Ints
from signorini.shapes.outlines import Box, Contour, Point, directions

Refined = tuple[Box, float]

_SAME = 1e-9
_ROUNDNESS = 0.3


@shared
def rectangle(
    origin: Point,
    size: tuple[float, float],
    divisions: tuple[int, int],
    x_lines: Sequence[float] = (),
    y_lines: Sequence[float] = (),
    refined: Sequence[Refined] = (),
    x_lesser: Sequence[float] = (),
    y_lesser: Sequence[float] = (),
    axes: Axes = ALONG_X,
) -> Mesh:
    """Mesh a rectangle with sides along the axes.

    There are ``divisions`` elements along x and y. Grid lines follow `x_lines` and `y_lines`, then the lesser lines, as
    far as `subdivide` can. ``refined`` are boxes (xmin, ymin, xmax, ymax) with an element size; a box that spans the
    plate in one direction refines the other direction only. Refinement increases the number of elements (`graded`). If
    several divisions are equally good, ``axes`` (`axes_of`) decide.
    """
    x = _with_middles(_joints(0, origin, size, divisions, (x_lines, x_lesser), refined, axes))
    y = _with_middles(_joints(1, origin, size, divisions, (y_lines, y_lesser), refined, axes))
    require_memory(len(x) // 2 * (len(y) // 2), ("mesh",))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    index = np.arange(len(points)).reshape(len(y), len(x))
    edges = {
        "left": _triples(index[::-1, 0]),
        "right": _triples(index[:, -1]),
        "bottom": _triples(index[0]),
        "top": _triples(index[-1, ::-1]),
    }
    return _mesh(points, _quads(index), edges)


def _joints(
    axis: int,
    origin: Point,
    size: tuple[float, float],
    divisions: tuple[int, int],
    lines: tuple[Sequence[float], Sequence[float]],
    refined: Sequence[Refined],
    axes: Axes,
) -> Floats:
    """Coordinates of the grid lines of a rectangle along axis 0 (x) or 1 (y)."""
    start, length, across = origin[axis], size[axis], size[1 - axis]
    caps = []
    for box, most in refined:
        low, high, below, above = box[axis], box[2 + axis], box[1 - axis], box[3 - axis]
        spans = high - low >= length * (1 - _SAME)
        if not spans or above - below >= across * (1 - _SAME):
            caps.append((low, high, most))

    def along(sense: float) -> Floats:
        begin, end = sorted((sense * start, sense * (start + length)))
        wanted = [[sense * line for line in group] for group in lines]
        if not caps:
            return np.sort(sense * subdivide(begin, end, divisions[axis], *wanted))
        within = [(min(sense * low, sense * high), max(sense * low, sense * high), most) for low, high, most in caps]
        return np.sort(sense * graded(begin, end, length / divisions[axis], within, *wanted))

    # If several divisions are equally good, the axes decide whether the side is divided forward or backward.
    # If both divisions are equal up to rounding, the forward one is used.
    forward = along(1.0)
    if axes[0][axis] + axes[1][axis] > 0:
        return forward
    backward = along(-1.0)
    equal = len(forward) == len(backward) and np.abs(forward - backward).max() <= _SAME * length
    return forward if equal else backward


@shared
def annulus(
    center: Point,
    inner: float,
    outer: float,
    divisions: tuple[int, int],
    sector: float = 360,
    radii: Sequence[float] = (),
) -> Mesh:
    """Mesh an annulus, or a sector of ``sector`` degrees from the x axis.

    ``divisions`` are the numbers of elements along a radius and along the circumference. The latter is rounded up to a
    multiple of 4 in a full annulus, so that its mesh is symmetric to both axes. Circles of ``radii`` are followed as
    far as `subdivide` can. The edges are inner and outer; a sector also has start (at angle 0) and end.
    Nodes of circles are exactly on them.
    """
    radial, around = divisions
    closed = sector == 360.0
    around = -(-around // 4) * 4 if closed else around
    radius = _with_middles(subdivide(inner, outer, radial, radii))
    degrees = np.linspace(0.0, sector, 2 * around + 1)
    columns = slice(-1) if closed else slice(None)
    points = (directions(degrees[columns])[:, None] * radius[:, None]).reshape(-1, 2)
    index = np.arange(len(points)).reshape(-1, len(radius))
    if closed:
        index = np.vstack([index, index[:1]])
    edges = {"inner": _triples(index[::-1, 0]), "outer": _triples(index[:, -1])}
    if not closed:
        edges |= {"start": _triples(index[0]), "end": _triples(index[-1, ::-1])}
    return _mesh(center + points, _quads(index), edges)


@shared
def disc(
    center: Point,
    radius: float,
    divisions: tuple[int, int],
    sector: float = 360,
    radii: Sequence[float] = (),
) -> Mesh:
    """Mesh a disc, or a sector of 90° or 180° from the x axis, with a square core inside rings.

    ``divisions`` are the numbers of elements along a radius, core included, and along the circumference, which is
    rounded up to a multiple of 4 (quarter: 2). The core of a disc with 4m elements around has m × m elements; of a half
    disc with 4m, 2m × m; of a quarter with 2m, m × m. A radius has at least the elements of the core, a quarter as many
    for the transition to a circle, and one for each of `radii`. The edges are the rim; a sector also has start (at
    angle 0) and end. Nodes of circles are exactly on them.
    """
    quarters = int(sector) // 90
    cells = -(-divisions[1] // (2 if quarters == 1 else 4))
    depth = -(-cells // 2) if quarters == 4 else cells
    turning = -(-depth // 4)
    radial = max(divisions[0], depth + turning + len(radii))
    knots = _with_most_of(radius, radial, radii, depth + turning)
    core_radius = knots[depth] / (0.5 + 0.5 * _half_width())
    core, rows = _core(quarters, cells)
    outline = _core_outline(rows, quarters)
    core_points = core_radius * core.reshape(-1, 2)

    degrees = np.linspace(0.0, sector, len(outline)) - (45.0 if quarters == 4 else 0.0)
    rays = directions(degrees)
    base, circle = core_points[outline], knots[depth + turning] * rays
    circle[1::2] = 0.5 * (circle[:-1:2] + circle[2::2])
    share = np.linspace(0.0, 1.0, 2 * turning + 1)[1:-1, None, None]
    turned = base + share * (circle - base)
    rings = rays * _with_middles(knots[depth + turning :])[:, None, None]
    ring_points = np.concatenate([turned, rings]).transpose(1, 0, 2)
    if quarters == 4:
        ring_points = ring_points[:-1]
    ring = len(core_points) + np.arange(ring_points.shape[0] * ring_points.shape[1]).reshape(ring_points.shape[:2])
    if quarters == 4:
        ring = np.vstack([ring, ring[:1]])
    ring = np.hstack([outline[:, None], ring])

    edges = {"rim": _triples(ring[:, -1])}
    if quarters < 4:
        middle = rows[0, rows.shape[1] // 2 :] if quarters == 2 else rows[0]
        edges["start"] = _triples(np.append(middle, ring[0, 1:]))
        inward = rows[0, : rows.shape[1] // 2 + 1] if quarters == 2 else rows[::-1, 0]
        edges["end"] = _triples(np.append(ring[-1, :0:-1], inward))
    points = np.vstack([core_points, ring_points.reshape(-1, 2)])
    return _mesh(center + points, np.vstack([_quads(rows), _quads(ring)]), edges)


def _with_most_of(radius: float, radial: int, radii: Sequence[float], first: int) -> Floats:
    """Joints along a radius: ``radial`` parts, or up to twice as many if then more of ``radii`` are joints.

    More parts may be needed, because the elements of a small core are small, and neighbours must not be much larger.
    """
    wanted = [r for r in radii if r < radius * (1.0 - _SAME)]
    best, most = np.zeros(0), -1
    for count in range(radial, 2 * radial + 1):
        knots = subdivide(0.0, radius, count, wanted, first=first)
        followed = sum(bool(np.abs(knots[first:] - r).min() <= _SAME * radius) for r in wanted)
        if followed > most:
            best, most = knots, followed
        if followed == len(wanted):
            break
    return best


def _half_width() -> float:
    """Distance from the center to the middle of a core's side, if the core's corners are at distance 1."""
    return (1.0 - _ROUNDNESS) * math.sqrt(0.5) + _ROUNDNESS


def _core(quarters: int, cells: int) -> tuple[Floats, Ints]:
    """Nodes (b, a, 2) of the core of a disc, with its corners at distance 1 from the center; node numbers (b, a).

    The shape of the core is between a square and a disc; element sides are straight.
    """
    across = 2 * cells if quarters == 2 else cells
    u = np.linspace(0.0 if quarters == 1 else -1.0, 1.0, across + 1)
    v = np.linspace(-1.0 if quarters == 4 else 0.0, 1.0, cells + 1)
    uu, vv = np.meshgrid(u, v)
    square = np.stack([uu, vv], axis=-1) * math.sqrt(0.5)
    round_ = np.stack([uu * np.sqrt(1.0 - 0.5 * vv**2), vv * np.sqrt(1.0 - 0.5 * uu**2)], axis=-1)
    corners = (1.0 - _ROUNDNESS) * square + _ROUNDNESS * round_
    points = np.empty((2 * len(v) - 1, 2 * len(u) - 1, 2))
    points[::2, ::2] = corners
    points[::2, 1::2] = 0.5 * (corners[:, 1:] + corners[:, :-1])
    points[1::2] = 0.5 * (points[:-1:2] + points[2::2])
    return points, np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])


def _core_outline(rows: Ints, quarters: int) -> Ints:
    """Node numbers of the core's outline, counter-clockwise from the lower right corner; in a sector to its end."""
    walk = [rows[:, -1], rows[-1, -2::-1]]
    if quarters > 1:
        walk.append(rows[-2::-1, 0])
    if quarters == 4:
        walk.append(rows[0, 1:])
    return np.concatenate(walk)


def _with_middles(knots: Floats) -> Floats:
    filled = np.empty(2 * len(knots) - 1)
    filled[::2] = knots
    filled[1::2] = 0.5 * (knots[1:] + knots[:-1])
    return filled


def _quads(index: Ints) -> Ints:
    """Elements (ab, 8) of a grid of a × b cells with node numbers (2a+1, 2b+1)."""
    a, b, c = slice(0, -2, 2), slice(1, -1, 2), slice(2, None, 2)
    around = ((a, a), (a, c), (c, c), (c, a), (a, b), (b, c), (c, b), (b, a))
    return np.stack([index[place] for place in around], axis=-1).reshape(-1, 8)


def _triples(line: Ints) -> Ints:
    """Node triples corner, midside, corner of the element sides along a line of node numbers."""
    return np.column_stack([line[:-2:2], line[1::2], line[2::2]])


def _mesh(points: Floats, elements: Ints, edges: Mapping[str, Ints]) -> Mesh:
    """Make a mesh without unused nodes, such as the centers of grid cells: elements have 8 nodes."""
    used = np.zeros(len(points), dtype=bool)
    used[elements] = True
    number = np.cumsum(used) - 1
    return Mesh(points[used], number[elements], {name: number[triples] for name, triples in edges.items()})


MOST = 10_000_000
"""Largest number of elements of the mesh of an outline, even if more would fit into memory."""


class OutlineError(InputError):
    """An outline that cannot be meshed, with the index of the faulty ``contour`` and of its ``side``, or None."""

    def __init__(self, message: str, contour: int | None = None, side: int | None = None) -> None:
        super().__init__(message)
        self.contour, self.side = contour, side


@shared
def outlined(
    contours: Sequence[Contour],
    size: float,
    refinements: Floats | None = None,
    lines: Sequence[tuple[Floats, bool]] = (),
    points: Floats | None = None,
    most: int = MOST,
    axes: Axes = ALONG_X,
) -> Mesh:
    """Mesh the area inside the first contour and outside the others, which are holes.

    ``size`` is the largest element size, as the side of a square element. There are at most about ``most``
    elements. The edges of the mesh are those of the contours; nodes on arcs are exactly on them. With equal axes
    (`axes_of`) the mesh does not depend on units or position, nor on the order of corners, holes, and lines of a group.
    Contours that cross, touch or nearly touch are refused.

    ``refinements`` (r, 5) are segments, x, y to x, y, with the element size there; away from them the size grows by a
    quarter of the distance. ``lines`` are groups of lines that element sides follow, in order of priority: segments (l,
    4), or arcs (a, 6) from x, y through x, y to x, y. A line is skipped if a part of it is outside the plate, or closer
    to the outline or to earlier lines than about half an element. If the flag of the group is True, only such parts of
    its lines are skipped. ``points`` (p, 2) become nodes, unless they are too close to other nodes or lines.
    """
    none = np.nan, np.nan
    loops = [
        (
            np.array(contour.corners, dtype=np.float64),
            np.array([none if m is None else m for m in contour.through], dtype=np.float64),
            [contour.whole or name for name in contour.names],
        )
        for contour in contours
    ]
    follow = [np.zeros((0, 8))]
    for rank, (group, in_part) in enumerate(lines):
        through = group[:, 2:4] if group.shape[1] == 6 else np.full((len(group), 2), np.nan)
        options = np.broadcast_to([rank, in_part], (len(group), 2))
        follow.append(np.column_stack([group[:, :2], group[:, -2:], through, options]))
    finer, fixed = (np.zeros((0, k)) if array is None else array for array, k in ((refinements, 5), (points, 2)))
    directions_of = [list(axis) for axis in axes]
    try:
        nodes, elements, sides, origin = mesh_outline(
            loops, size, finer, np.concatenate(follow), fixed, most, directions_of
        )
    except ValueError as error:
        raise OutlineError(*error.args) from None
    edges = {
        name: sides[(origin[:, 0] == ring) & np.isin(origin[:, 1], numbers)]
        for ring, contour in enumerate(contours)
        for name, numbers in contour.edges.items()
    }
    return Mesh(nodes, elements, edges)


def divided(mesh: Mesh, times: int = 1) -> Mesh:
    """Divide every element into four, ``times`` times; curved sides and named edges are preserved."""
    return mesh if times == 0 else divided(_halved(mesh), times - 1)


def _halved(mesh: Mesh) -> Mesh:
    n = mesh.node_count
    # New nodes on the sides of elements are the quarter points of each side.
    # New nodes inside a quadrilateral are its center and four midsides, inside a triangle three midsides.
    sides = mesh.unique_sides
    number = np.full(n, -1)
    number[sides[:, 1]] = np.arange(len(sides))
    a, m, b = mesh.points[sides].transpose(1, 0, 2)
    quarters = np.stack([0.375 * a + 0.75 * m - 0.125 * b, -0.125 * a + 0.75 * m + 0.375 * b], axis=1)
    squares, triangles = np.flatnonzero(~mesh.triangles), np.flatnonzero(mesh.triangles)
    inside = np.array([[0.0, 0.0], [0.0, -0.5], [0.5, 0.0], [0.0, 0.5], [-0.5, 0.0]])
    across = np.array([[0.25, 0.25], [0.5, 0.25], [0.25, 0.5]])
    within = [
        mesh.map(np.repeat(elements, len(xi)), np.tile(xi, (len(elements), 1)))
        for elements, xi in ((squares, inside), (triangles, across))
    ]
    points = np.vstack([mesh.points, quarters.reshape(-1, 2), *within])
    centre = n + 2 * len(sides) + 5 * np.arange(len(squares))
    joint = n + 2 * len(sides) + 5 * len(squares) + 3 * np.arange(len(triangles))

    # Quarter points of the sides of each element, in counter-clockwise order around the element.
    first = n + 2 * number[mesh.sides[..., 1]]
    along = sides[number[mesh.sides[..., 1]], 0] == mesh.sides[..., 0]
    near, far = np.where(along, first, first + 1), np.where(along, first + 1, first)
    corner, middle = mesh.elements[:, :4], mesh.elements[:, 4:]
    parts = []
    for i in range(4):
        j = i - 1
        joints = centre + 1 + i, centre + 1 + j % 4
        corners = [corner[squares, i], middle[squares, i], centre, middle[squares, j]]
        parts.append(np.stack([*corners, near[squares, i], *joints, far[squares, j]], axis=1))
    around = [0, 1, 3]
    middles = [middle[triangles, side] for side in around]
    for i, side in enumerate(around):
        a, b, c = corner[triangles, i], middles[i], middles[i - 1]
        parts.append(np.stack([a, b, c, c, near[triangles, side], joint + i, c, far[triangles, around[i - 1]]], axis=1))
    a, b, c = middles
    parts.append(np.stack([a, b, c, c, joint + 1, joint + 2, c, joint], axis=1))
    edges = {}
    for name, triples in mesh.edges.items():
        start = n + 2 * number[triples[:, 1]]
        same = sides[number[triples[:, 1]], 0] == triples[:, 0]
        first_quarter, last_quarter = np.where(same, start, start + 1), np.where(same, start + 1, start)
        halves = np.stack(
            [triples[:, 0], first_quarter, triples[:, 1], triples[:, 1], last_quarter, triples[:, 2]], axis=1
        )
        edges[name] = halves.reshape(-1, 3)
    return Mesh(points, np.concatenate(parts), edges)
