"""Moment, twist and shear through one line, as sums over the elements that the line meets.

For the part of the plate on the left of the line, the principle of virtual work gives, for any displacement v,

    ∫ t·v along the line  =  ∫ σ : ε(v) over the part  −  work of loads and reactions on the part,

with t the traction from the right. v is w = 1, or a rotation about the line, at the nodes of elements that the line
meets, and 0 at all others. Inner nodes are in equilibrium, so that only elements that the line meets contribute. Where
v is a rigid motion in an element, its stresses do no work and the sum is exact, whatever the quadrature. At an end of
the line inside the plate v is not rigid: there the missing part of v on the line times the element's moments and shears
is added.

A line that ends on an edge is continued in a direction that leads out of the plate. Its straight continuation could
meet the plate again beyond a re-entrant corner, or beyond a round hole that the line touches.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from signorini import _core
from signorini.discretise.held import Held
from signorini.discretise.quadrature import Quadrature, area_quadrature
from signorini.discretise.quadrature.crossings import touched
from signorini.discretise.quadrature.lines import Segment
from signorini.discretise.quadrature.rules import gauss
from signorini.discretise.quadrature.stepped import Levels
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.errors import InputError, point
from signorini.mesh import Mesh
from signorini.mesh.sides import onto
from signorini.shapes.cuts import LEFT, RIGHT, CutLine, LeftOf, Near, Part
from signorini.shapes.outlines import Point, arc_through

BESIDE = 1e-6
"""Tolerance for an end of a line that lies on an edge, or at a node of an edge, relative to the plate's size."""
_BEYOND = 2.0
"""Length by which a line is continued beyond an end inside the plate, relative to an element's largest diagonal.

The virtual displacement v becomes 0 within one diagonal beyond the end."""
_ORDER = 5
"""Number of Gauss points in each direction on parts of divided elements."""
_ON_SIDE = 1e-9
"""Largest distance past an element's side, in reference coordinates, that counts as rounding."""
_AROUND = [0, 4, 1, 5, 2, 6, 3, 7]
"""Indices of an element's nodes in order along its boundary."""
_POINTS = {"mitc9": 9, "q8r": 4}
"""Number of Gauss points of an element's stiffness matrix, by kind of element."""
_WORK = np.array([-1.0, -1.0, -1.0, 1.0, 1.0])
"""Signs of the terms of σ : ε = −mx κx − my κy − mxy 2κxy + qx γx + qy γy."""
_TRIANGULAR = np.array([(i, j) for i in range(3) for j in range(3 - i)])
"""Exponents (i, j) of the monomials ξⁱ ηʲ up to degree 2."""


def followed(mesh: Mesh, points: Sequence[Point]) -> tuple[CutLine, tuple[bool, bool]]:
    """Return a line through ``points``, continued out of the plate at ends on an edge; and which ends are inside."""
    corners, touching = np.array(points, dtype=np.float64), mesh.near.place
    if len(points) > 2 and points[0] == points[-1]:
        return CutLine(corners, touching), (False, False)
    edges = [_edge(mesh, corners[end]) for end in (0, -1)]
    for end, (position, _) in zip((0, -1), edges, strict=True):
        corners[end] = position
    directions = [
        None if beside is None else _out(beside - position, position - corners[inner], touching)
        for inner, (position, beside) in zip((1, -2), edges, strict=True)
    ]
    return CutLine(corners, touching, directions), (directions[0] is None, directions[1] is None)


def _edge(mesh: Mesh, end: Floats) -> tuple[Floats, Floats | None]:
    """Position of an end of a line, moved to a node of an edge within tolerance, and its neighbours along the edge.

    The neighbours (2, 2) are nodes before and after the end; None if the end is not on an edge.
    """
    chords = np.concatenate([mesh.boundary[:, :2], mesh.boundary[:, 1:]])
    near, ends = BESIDE * mesh.size, mesh.points[chords]
    apart = np.hypot(*np.moveaxis(ends[:, 0] - end, 1, 0))
    if apart.min() <= near:
        node = chords[apart.argmin(), 0]
        end = mesh.points[node]
        before, after = ends[chords[:, 1] == node, 0], ends[chords[:, 0] == node, 1]
        # If several parts of the plate meet only in this node, take the two neighbours with no plate between them.
        pairs = [
            np.stack([neighbour_before, neighbour_after]) for neighbour_before in before for neighbour_after in after
        ]
        return end, min(pairs, key=lambda pair: _turn(pair - end))
    sides = mesh.points[mesh.boundary]
    apart = np.hypot(*(onto(sides, end) - end).T)
    side = sides[apart.argmin()]
    if apart.min() > near and not _on_arc(side, end, near):
        return end, None
    chord = side[:2] if (end - side[1]) @ (side[2] - side[0]) < 0.0 else side[1:]
    return end, chord


def _on_arc(side: Floats, position: Floats, near: float) -> bool:
    """Whether a position is on the arc that a side of an element approximates by a parabola."""
    a, middle, b = (tuple(node) for node in side.tolist())
    arc = arc_through(a, middle, b)
    between = 0.0 < (position - side[0]) @ (side[2] - side[0]) < math.dist(a, b) ** 2
    return arc is not None and bool(between) and abs(math.dist(position, arc[0]) - arc[1]) <= near


def _turn(beside: Floats) -> float:
    """Counter-clockwise angle between two directions (2, 2) along an edge, with the plate on the left."""
    (x, y), (u, v) = beside.tolist()
    return math.atan2(x * v - y * u, x * u + y * v) % math.tau


def _out(beside: Floats, outward: Floats, touching: float) -> Floats | None:
    """Direction out of the plate that bisects two directions (2, 2) along the edge.

    ``outward`` is the direction of the line at its end. None if the line runs along the edge and the edge continues
    straight: then the line counts as just inside.
    """
    outward = outward / np.hypot(*outward)
    off, forward = beside @ [outward[1], -outward[0]], beside @ outward
    if (np.abs(off) <= touching).all() and forward[0] * forward[1] < 0.0:
        return None
    half = 0.5 * _turn(beside)
    c, s = math.cos(half), math.sin(half)
    return np.asarray(np.array([[c, -s], [s, c]]) @ beside[0] / np.hypot(*beside[0]))


@dataclass(frozen=True, eq=False)
class Cut:
    """A line, its length on the plate, and the elements (k,) that the line meets, ascending.

    Moment, twist and shear are the sum of ``of_forces`` (k, 3, 24) times nodal forces of the elements, in nodal axes,
    and ``of_stress`` (k, p, 5, 3) times moments and shears of the elements at Gauss points. ``motion`` (k, 3, 24) is v
    in elements that the line divides, else 0. ``left`` is the quadrature of the parts of divided elements on the left;
    element indices in it count among the k elements.
    """

    line: CutLine
    length: float
    elements: Ints
    of_forces: Floats
    of_stress: Floats
    motion: Floats
    left: Quadrature

    def divided(self) -> Bools:
        """Mask (k,) of the elements that the line divides."""
        return np.asarray(self.motion.any(axis=(1, 2)))

    def on_left(self, mesh: Mesh, region: Part | None, order: int, levels: Levels) -> Quadrature:
        """Quadrature of a region's part on the left in divided elements; element indices count among the k elements."""
        if region is None and not levels:
            return self.left
        return _on_left(mesh.part(self.elements), self.line, self.divided(), region, order, levels)

    def work(self, elements: Ints, rows: Floats, left: Floats) -> Floats:
        """Contribution (q, 3) to moment, twist and shear of downward forces with rows (q, 24) over elements (q,).

        Element indices count among the k elements. ``left`` (q,) is the fraction of each force that acts on the left: a
        half for a force on the line.
        """
        on_whole = (left == 0.5) & ~self.divided()[elements]
        weights = self.of_forces[elements] + left[:, None, None] * self.motion[elements]
        return np.where(on_whole[:, None], 0.0, -np.einsum("qcd,qd->qc", weights, rows))

    def lefts(self, positions: Floats) -> Floats:
        """Fraction (q,) of forces at positions (q, 2) that acts on the left: 1 or 0, a half on the line."""
        return np.asarray(0.5 - 0.5 * self.line.near(positions).side)

    def level(self, positions: Floats) -> Floats:
        """Level function (q,) at positions (q, 2) that is zero on the line."""
        near = self.line.near(positions)
        return np.where(near.side == 0, near.off[np.arange(len(positions)), near.piece], near.side)


def cut(mesh: Mesh, plate: _core.Plate, kind: str, held: Held, points: Sequence[Point]) -> Cut:
    """Cut a plate along a line through points; ``kind`` is the name of the plate's finite element."""
    line = _Followed(mesh, points)
    met, divided, pieces = _met(mesh, line)
    length = _length(line.line, pieces)
    if not length > 0.0:
        raise InputError("The line is not on the plate. Move it onto the plate.")
    near = line.line.near(mesh.points[mesh.elements[met]].reshape(-1, 2))
    taken = line.taken(near).reshape(-1, 8)
    taken[_of_bodies_at_ends(mesh.elements[met], held, near.side.reshape(-1, 8), taken)] = 0.0
    # Elements that contain a piece of the line are kept even if v = 0 at their nodes: `_rest` adds their traction.
    of_line = (pieces.begin >= 0.0) & (pieces.end <= line.line.lengths[pieces.piece])
    kept = taken.any(axis=1) | np.isin(met, pieces.elements[of_line])
    elements, divided, taken = met[kept], divided[kept], taken[kept]
    shares, off = (values.reshape(len(met), 8, -1)[kept] for values in (near.shares, near.off))
    v = np.zeros((len(elements), 3, 8, 3))
    v[:, 0, :, 0], v[:, 0, :, 1:] = -(shares * off).sum(axis=2), -shares @ line.line.normals
    v[:, 1, :, 1:] = -shares @ line.line.along
    v[:, 2, :, 0] = 1.0
    v *= taken[:, None, :, None]
    if held.frames is not None:
        c, s = np.moveaxis(held.frames[mesh.elements[elements]], -1, 0)[:, :, None]
        x, y = v[..., 1].copy(), v[..., 2].copy()
        v[..., 1], v[..., 2] = c * x + s * y, c * y - s * x
    rigid = held.bodies.rigid[elements]
    parts = _parts_of_forces(mesh, line.line, elements, divided, near.side.reshape(-1, 8)[kept], rigid)
    of_forces = (v * parts[:, None, :, None]).reshape(-1, 3, 24)
    whole = v.reshape(-1, 3, 24)
    motion = np.where(divided[:, None, None], whole, 0.0)
    stress = _rest(mesh, plate, kind, line, elements, whole, pieces)
    left = _on_left(mesh.part(elements), line.line, divided, None, _ORDER, ())
    if divided.any():
        strains = plate.strain_rows(elements)
        strains = strains.reshape(*strains.shape[:2], 5, 24)
        shapes = _between(mesh, kind, elements[left.elements], left.xi)
        shared = np.zeros((len(elements), shapes.shape[1], shapes.shape[1]))
        np.add.at(shared, left.elements, left.weights[:, None, None] * shapes[:, :, None] * shapes[:, None, :])
        work = np.einsum("kcd,kpsd->kpsc", motion, strains) * _WORK[:, None]
        stress += np.einsum("kap,kpsc->kasc", shared, work)
    return Cut(line.line, length, elements, of_forces, stress, motion, left)


class _Followed:
    """A line on a plate, with the ends that lie inside the plate, and the length of its continuation at these ends."""

    def __init__(self, mesh: Mesh, points: Sequence[Point]) -> None:
        self.line, self.inside = followed(mesh, points)
        self.reach = _BEYOND * float(np.hypot(*(mesh.boxes[:, 2:] - mesh.boxes[:, :2]).T).max())
        self.beyond = np.where(self.inside, self.reach, 0.0)

    def taken(self, near: Near) -> Floats:
        """Factor of the virtual displacement v at points: 0 beyond an end inside the plate, ½ at the end, else 1."""
        taken, lengths = np.ones(len(near.piece)), self.line.lengths
        for end, (piece, past) in enumerate(((0, -near.station), (len(lengths) - 1, near.station - lengths[-1]))):
            if self.inside[end]:
                factor = np.where(np.abs(past) <= self.line.touching, 0.5, past < 0.0)
                taken = np.where(near.piece == piece, np.minimum(taken, factor), taken)
        return taken


def _met(mesh: Mesh, followed: _Followed) -> tuple[Ints, Bools, _Pieces]:
    """Elements (k,) that the continued line meets, at least in a node; mask of divided elements; pieces of the line.

    An element is divided if it has nodes on both sides of the line, or if the line crosses a bulge of a curved side.
    """
    line, beyond = followed.line, followed.beyond
    near = np.unique(touched(mesh.boxes, line.extended(followed.reach).outline, line.touching)[0])
    met, divided = np.zeros(len(near), np.bool_), np.zeros(len(near), np.bool_)
    nodes, sides = mesh.points[mesh.elements[near][:, _AROUND]], mesh.points[mesh.sides[near].reshape(-1, 3)]
    pieces = []
    for piece, (begin, along, normal) in enumerate(zip(line.begin, line.along, line.normals, strict=True)):
        station, off = ((nodes - begin) @ axis for axis in (along, normal))
        low = -beyond[0] * (piece == 0)
        high = line.lengths[piece] + beyond[1] * (piece == len(line.lengths) - 1)
        off = np.where(np.abs(off) <= line.touching, 0.0, off)
        next_station, next_off = np.roll(station, -1, axis=1), np.roll(off, -1, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = station + (next_station - station) * off / (off - next_off)
        stations = np.hstack([crossing, station])
        crossed = np.hstack([off * next_off < 0.0, off == 0.0])
        first = np.maximum(np.where(crossed, stations, np.inf).min(axis=1), low)
        final = np.minimum(np.where(crossed, stations, -np.inf).max(axis=1), high)
        longer = final > first + line.touching
        crossings = low + Segment(begin + low * along, begin + high * along).crossings(sides)
        stops = np.unique(np.clip(np.concatenate([[low, 0.0, line.lengths[piece], high], crossings]), low, high))
        (long,) = np.nonzero(np.diff(stops) > line.touching)
        middle = begin + 0.5 * (stops[long] + stops[long + 1])[:, None] * along
        beside = np.concatenate([middle + side * line.touching * normal for side in (LEFT, RIGHT)])
        left, right = _within(mesh, beside).reshape(2, -1)
        of_pieces = np.concatenate([left, right[right != left]])
        at = np.concatenate([long, long[right != left]])[of_pieces >= 0]
        of_pieces = of_pieces[of_pieces >= 0]
        share = 1.0 / np.bincount(at, minlength=len(stops))[at]
        pieces.append(_Pieces(of_pieces, np.full(len(at), piece), stops[at], stops[at + 1], share))
        met |= (final >= first - line.touching) | np.isin(near, of_pieces)
        divided |= longer & (off > 0.0).any(axis=1) & (off < 0.0).any(axis=1) | np.isin(near, left[left == right])
    return near[met], divided[met], _Pieces(*(np.concatenate(part) for part in zip(*pieces, strict=True)))


def _within(mesh: Mesh, positions: Floats) -> Ints:
    """Elements (q,) that contain positions (q, 2), −1 off the plate and between a curved edge and its circle."""
    where = mesh.locate(positions)
    inside = where.inside
    inside[inside] = (mesh.past(where.elements[inside], where.xi[inside]) <= _ON_SIDE).all(axis=1)
    return np.where(inside, where.elements, -1)


class _Pieces(NamedTuple):
    """Parts of a line, each in or along an element (q,): piece of the line (q,), first and last station (q,).

    ``share`` (q,) is the weight of each part: 1, or ½ if it runs between two elements and is listed for both.
    """

    elements: Ints
    piece: Ints
    begin: Floats
    end: Floats
    share: Floats


def _of_bodies_at_ends(nodes: Ints, held: Held, side: Ints, taken: Floats) -> Bools:
    """Mask of nodes (k, 8) of rigid bodies in which the line ends, without running along the body: there v = 0.

    A body is in equilibrium only as a whole, so that v must be a single rigid motion on the body.
    """
    inside, leader = held.bodies.inside[nodes], held.bodies.leaders[nodes]
    along = leader[inside & (side == 0) & (taken == 1.0)]
    return np.asarray(inside & np.isin(leader, np.setdiff1d(leader[inside & (taken < 1.0)], along)))


def _parts_of_forces(mesh: Mesh, line: CutLine, elements: Ints, divided: Bools, side: Ints, rigid: Bools) -> Floats:
    """Factors (k, 8) of v for the nodal forces of the elements; ``side`` (k, 8) is the side of each node.

    In divided elements the factor is −1 at nodes on the left. In other elements it is 0 except at nodes on the line: ½
    for elements on the left, −½ on the right. Along an edge of the plate, with elements on one side only, it is ±1.
    Nodes of a rigid body count as on the body's side, since a body is in equilibrium only as a whole.
    """
    nodes = mesh.elements[elements]
    centres = mesh.map(elements, mesh.inward(elements, np.zeros((len(elements), 2)), 0.0))
    side_of_centre = line.near(centres).side
    beside = [np.isin(nodes, nodes[divided | (side_of_centre == sign)]) for sign in (LEFT, RIGHT)]
    of_bodies = [np.isin(nodes, nodes[rigid & (side_of_centre == sign)]) for sign in (LEFT, RIGHT)]
    alone = [
        np.isin(nodes, nodes[~rigid & (divided | (side_of_centre == sign))], invert=True) for sign in (LEFT, RIGHT)
    ]
    within = (side == 0) & ((of_bodies[0] & alone[1]) | (of_bodies[1] & alone[0]))
    if (crossed := (rigid & divided) | within.any(axis=1)).any():
        crossing_at = point(centres[np.argmax(crossed)], mesh.size)
        raise InputError(
            f"The line crosses a rigid zone at {crossing_at}, where there are no moments and shears. Let the line run "
            "along the zone's outline or beside it, or end at the outline."
        )
    part = np.select(of_bodies, [0.5 + 0.5 * side_of_centre[:, None], 0.5 - 0.5 * side_of_centre[:, None]], 0.5)
    of_whole = -side_of_centre[:, None] * np.where(beside[0] & beside[1], part, 1.0) * (side == 0)
    of_divided = np.select(of_bodies, [1.0, 0.0], 0.5) * (side == 0) + (side == LEFT)
    return np.asarray(np.where(divided[:, None], -of_divided, of_whole))


def _on_left(part: Mesh, line: CutLine, divided: Bools, region: Part | None, order: int, levels: Levels) -> Quadrature:
    """Quadrature of a region's part on the left of the line in the divided elements (k,) of the mesh ``part``."""
    (which,) = np.nonzero(divided)
    if not len(which):
        return Quadrature(which, np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2)))
    divided_mesh = part.part(which)
    (x0, y0), (x1, y1) = divided_mesh.boxes[:, :2].min(axis=0).tolist(), divided_mesh.boxes[:, 2:].max(axis=0).tolist()
    result = area_quadrature(divided_mesh, LeftOf(line, (x0, y0, x1, y1), region), order, levels=levels)
    return Quadrature(which[result.elements], result.xi, result.weights, result.positions)


def _between(mesh: Mesh, kind: str, elements: Ints, xi: Floats) -> Floats:
    """Values (q, p) of the functions that interpolate between the Gauss points of an element's stiffness matrix.

    For triangles, with seven points, the functions are a least-squares fit by quadratics; the last two columns are 0.
    """
    count = _POINTS[kind]
    result = np.zeros((len(xi), count))
    triangles = mesh.triangles[elements]
    for mask, degrees, points in (
        (~triangles, _square(round(np.sqrt(count))), _core.section_points(kind)[:count]),
        (triangles, _TRIANGULAR, _core.section_points("mitc9", True)[:7]),
    ):
        if not mask.any():
            continue
        result[mask, : len(points)] = _monomials(xi[mask], degrees) @ np.linalg.pinv(_monomials(points, degrees))
    return result


def _square(count: int) -> Ints:
    return np.array([(i, j) for i in range(count) for j in range(count)])


def _monomials(xi: Floats, degrees: Ints) -> Floats:
    return np.asarray((xi[:, None, :] ** degrees).prod(axis=2))


def _rest(
    mesh: Mesh, plate: _core.Plate, kind: str, line: _Followed, elements: Ints, v: Floats, pieces: _Pieces
) -> Floats:
    """Work (k, p, 5, 3) of unit stresses in the part of v that is missing on the line.

    On the line, v should be a rigid motion up to the ends; interpolation from the nodes gives only a part of it.
    """
    place, met = placed(elements, pieces.elements)
    node, weight = gauss(_ORDER)
    half = 0.5 * (pieces.end - pieces.begin)[met, None]
    station = (0.5 * (pieces.begin + pieces.end)[met, None] + half * node).ravel()
    weights = (half * weight * pieces.share[met, None]).ravel()
    place, piece = (np.repeat(values, _ORDER) for values in (place, pieces.piece[met]))
    along, normal, element = line.line.along[piece], line.line.normals[piece], elements[place]
    positions = line.line.begin[piece] + station[:, None] * along
    xi = mesh.invert(element, positions)
    missing = np.zeros((len(element), 3, 3))
    missing[:, 0, 1:], missing[:, 1, 1:], missing[:, 2, 0] = -normal, -along, 1.0
    missing *= line.taken(line.line.near(positions))[:, None, None]
    rows = np.stack([plate.interpolation_rows(element, xi, field)[0] for field in range(3)], axis=1)
    w, x, y = np.moveaxis(missing - np.einsum("qcd,qfd->qcf", v[place], rows), -1, 0)
    nx, ny = (part[:, None] for part in normal.T)
    # The traction from the right side acts as Q·n on w, and as −Mn on the slopes.
    work = weights[:, None, None] * np.stack([-nx * x, -ny * y, -nx * y - ny * x, nx * w, ny * w], axis=1)
    stress = np.zeros((len(elements), _POINTS[kind], 5, 3))
    np.add.at(stress, place, _between(mesh, kind, element, xi)[:, :, None, None] * work[:, None])
    return stress


def _length(line: CutLine, pieces: _Pieces) -> float:
    """Length of the line on the plate, without its continuations."""
    inside = np.minimum(pieces.end, line.lengths[pieces.piece]) - np.maximum(pieces.begin, 0.0)
    return float(np.maximum(inside, 0.0) @ pieces.share)


def placed(elements: Ints, wanted: Ints) -> tuple[Ints, Ints]:
    """Positions in sorted ``elements`` (k,), and indices in ``wanted`` (q,), of entries that occur in both arrays."""
    place = np.minimum(np.searchsorted(elements, wanted), len(elements) - 1)
    found = np.flatnonzero(elements[place] == wanted) if len(elements) else np.zeros(0, np.int64)
    return place[found], found
