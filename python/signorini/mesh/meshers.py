"""Meshes of rectangles, discs, annuli and their sectors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from signorini.base.memory import require_memory
from signorini.errors import InputError
from signorini.mesh import Mesh
from signorini.mesh.axes import ALONG_X, Axes
from signorini.mesh.grading import graded
from signorini.mesh.subdivision import subdivide
from signorini.shapes.contours import directions
from signorini.shapes.outlines import Box, Point

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

Refined = tuple[Box, float]

_SAME = 1e-9
SECTORS = (90, 180, 360)
_ROUNDNESS = 0.3


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
    """Mesh a rectangle along the axes.

    Parameters
    ----------
    origin : (x, y)
        Lower left corner.
    size : (width, height)
        Lengths of the sides.
    divisions : (int, int)
        Elements along x and along y; the numbers are kept.
    x_lines, y_lines : sequence of float
        Coordinates that grid lines should have; see `signorini.mesh.subdivision.subdivide` for which are followed.
    refined : sequence of (box, size)
        Boxes (x0, y0, x1, y1) in which elements are smaller, and how small; one that reaches from side to side asks
        for it across alone. Then there are more elements than the divisions say (`signorini.mesh.grading.graded`).
    x_lesser, y_lesser : sequence of float
        Coordinates that give way to `x_lines` and `y_lines`.
    axes : Axes
        From where they begin, pieces between lines that are alike get their elements (`signorini.mesh.axes.axes_of`).

    Returns
    -------
    Mesh
        With edges left, right, bottom and top.

    Raises
    ------
    InputError
        If a length or a number of divisions is not positive.

    Examples
    --------
    >>> mesh = rectangle((0.0, 0.0), (4.0, 2.0), (4, 2), x_lines=[1.2])
    >>> mesh.node_count, len(mesh.elements), sorted(mesh.edges)
    (37, 8, ['bottom', 'left', 'right', 'top'])
    """
    _require_positive("The rectangle's size", size)
    _require_divisions(divisions, ("x", "y"))
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
    """Joints of a rectangle's elements along an axis."""
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

    # Which end it begins from matters for pieces that are alike alone; else coordinates keep their digits.
    forward = along(1.0)
    if axes[0][axis] + axes[1][axis] > 0:
        return forward
    backward = along(-1.0)
    alike = len(forward) == len(backward) and np.abs(forward - backward).max() <= _SAME * length
    return forward if alike else backward


def annulus(
    center: Point,
    inner: float,
    outer: float,
    divisions: tuple[int, int],
    sector: float = 360,
    radii: Sequence[float] = (),
) -> Mesh:
    """Mesh the space between two circles, or a sector of it counted from the x axis.

    Parameters
    ----------
    center : (x, y)
        Centre of both circles.
    inner, outer : float
        Their radii.
    divisions : (int, int)
        Elements along a radius and along the circumference; the numbers are kept.
    sector : float
        Degrees, up to 360.
    radii : sequence of float
        Radii of circles that the mesh should have; see `signorini.mesh.subdivision.subdivide` for which are followed.

    Returns
    -------
    Mesh
        With edges inner and outer, and of a sector start (at angle 0) and end. Nodes on circles are on them exactly.

    Raises
    ------
    InputError
        If the radii do not bound a ring, or there is less than one element to a quarter of the circumference.

    Examples
    --------
    >>> mesh = annulus((0.0, 0.0), 1.0, 2.0, (2, 12))
    >>> len(mesh.elements), sorted(mesh.edges)
    (24, ['inner', 'outer'])
    """
    _require_positive("The annulus's radii", (inner, outer))
    if not inner < outer:
        raise InputError(f"An annulus's inner radius must be less than the outer one; found {inner:g} and {outer:g}.")
    _require_divisions(divisions, ("the radius", "the circumference"))
    if not 0.0 < sector <= 360.0:
        raise InputError(f"A sector has up to 360 degrees; found {sector:g}.")
    radial, around = divisions
    if around < sector / 90.0:
        raise InputError(
            f"Along the circumference there must be at least {math.ceil(sector / 90.0)} elements; found {around}."
        )
    closed = sector == 360.0
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


def disc(
    center: Point,
    radius: float,
    divisions: tuple[int, int],
    sector: float = 360,
    radii: Sequence[float] = (),
) -> Mesh:
    """Mesh a disc, or a sector of it counted from the x axis, with a square core inside rings.

    Parameters
    ----------
    center : (x, y)
        Centre.
    radius : float
        Radius of the rim.
    divisions : (int, int)
        Elements along a radius, those of the core included, and along the circumference. The circumference takes the
        next multiple of 4 (of 2 for a quarter). The core of a disc with 4m elements around has m × m of them; of a half
        disc with 4m, 2m × m; of a quarter with 2m, m × m. A radius takes at least those of the core and a quarter as
        many again, over which the core's outline turns into a circle, and one for each of `radii`.
    sector : 360, 180 or 90
        Degrees.
    radii : sequence of float
        Radii of circles that the mesh should have; see `signorini.mesh.subdivision.subdivide` for which are followed.

    Returns
    -------
    Mesh
        With the edge rim, and of a sector start (at angle 0) and end. Nodes on circles are on them exactly.

    Raises
    ------
    InputError
        If the radius or a number of divisions is not positive.

    Examples
    --------
    >>> mesh = disc((0.0, 0.0), 1.0, (4, 16))
    >>> len(mesh.elements), sorted(mesh.edges)
    (48, ['rim'])
    """
    _require_positive("The disc's radius", (radius,))
    _require_divisions(divisions, ("the radius", "the circumference"))
    quarters = _quarters(sector)
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
    """Joints along a radius, as many as asked for, or else up to twice as many, so that most of the radii are joints.

    A circle that the core fills has small elements, and beside it must not be much larger ones.
    """
    wanted = [one for one in radii if one < radius * (1.0 - _SAME)]
    result, most = np.zeros(0), -1
    for count in range(radial, 2 * radial + 1):
        knots = subdivide(0.0, radius, count, wanted, first=first)
        followed = sum(bool(np.abs(knots[first:] - one).min() <= _SAME * radius) for one in wanted)
        if followed > most:
            result, most = knots, followed
        if followed == len(wanted):
            break
    return result


def _half_width() -> float:
    """Distance from the centre to the middle of a side of a core whose corners are at distance 1."""
    return (1.0 - _ROUNDNESS) * math.sqrt(0.5) + _ROUNDNESS


def _core(quarters: int, cells: int) -> tuple[Floats, Ints]:
    """Place the core's nodes, corners at distance 1, between a square and a disc; sides of elements are straight."""
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
    """Walk the core's outline counter-clockwise: all of it from its lower right corner, or from start to end."""
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
    """Form the elements of a lattice of nodes (2a+1, 2b+1) whose rows advance to the left of its columns."""
    a, b, c = slice(0, -2, 2), slice(1, -1, 2), slice(2, None, 2)
    around = ((a, a), (a, c), (c, c), (c, a), (a, b), (b, c), (c, b), (b, a))
    return np.stack([index[place] for place in around], axis=-1).reshape(-1, 8)


def _triples(line: Ints) -> Ints:
    """List corner, midside, corner of each side along a line of nodes."""
    return np.column_stack([line[:-2:2], line[1::2], line[2::2]])


def _mesh(points: Floats, elements: Ints, edges: Mapping[str, Ints]) -> Mesh:
    """Leave out the centres of the lattices' cells, which 8-node elements do not have."""
    used = np.zeros(len(points), dtype=bool)
    used[elements] = True
    number = np.cumsum(used) - 1
    return Mesh(points[used], number[elements], {name: number[triples] for name, triples in edges.items()})


def _require_positive(what: str, numbers: Sequence[float]) -> None:
    if not all(math.isfinite(number) and number > 0.0 for number in numbers):
        raise InputError(f"{what} must be positive; found {', '.join(f'{number:g}' for number in numbers)}.")


def _require_divisions(divisions: Sequence[int], along: tuple[str, str]) -> None:
    if len(divisions) != 2 or min(divisions) < 1:
        raise InputError(
            f"Divisions are two positive numbers of elements, along {along[0]} and along {along[1]}; "
            f"found {list(divisions)}."
        )


def _quarters(sector: float) -> int:
    if sector not in SECTORS:
        raise InputError(f"A sector has 90, 180 or 360 degrees; found {sector:g}.")
    return int(sector) // 90
