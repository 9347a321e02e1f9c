"""The forces through one line as sums over the elements that it meets.

Of the part of the plate on the line's left the principle of virtual work says, for any displacement v,

    ∫ t·v along the line  =  ∫ σ : ε(v) over the part  -  the work of what acts on it,

t what the other part gives it. v is 1, or turns about the line, at the nodes of elements that the line meets and 0 at
all others. Inner nodes are in equilibrium, so that of those on the left the elements on the right tell as much: only
elements that the line meets remain. Where v is a rigid motion in them nothing of the elements' own stress is left, and
the sum is what acts on either side, whatever the quadrature. Where it is not, at an end of the line inside the plate,
what v is too little on the line times the element's own moments and shears there is added.

Beyond a re-entrant corner, or where a line touches a round hole, the plate is on the straight continuation of a line
that has already ended. So a line that ends on an edge is continued by one that leads out of the plate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from signorini import _core
from signorini.discretise.held import Held
from signorini.discretise.quadrature import Quadrature, area_quadrature
from signorini.discretise.quadrature.rules import gauss
from signorini.discretise.quadrature.stepped import Levels
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.errors import InputError, point
from signorini.mesh import Mesh
from signorini.mesh.sides import onto
from signorini.shapes.cuts import LEFT, RIGHT, CutLine, LeftOf, Near, Part
from signorini.shapes.outlines import Point, arc_through

BESIDE = 1e-6
"""How far from an edge, of the plate's size, an end is on it, and from a node of an edge in it: more than rounding."""
_BEYOND = 2.0
"""Diagonals of the largest element by which a line is followed beyond an end inside the plate: v ends within one."""
_ORDER = 5
_AROUND = [0, 4, 1, 5, 2, 6, 3, 7]
_POINTS = {"mitc9": 9, "q8r": 4}
"""Points of an element's stiffness."""
_WORK = np.array([-1.0, -1.0, -1.0, 1.0, 1.0])
"""σ : ε is −mx κx − my κy − mxy 2κxy + qx γx + qy γy."""
_TRIANGULAR = np.array([(i, j) for i in range(3) for j in range(3 - i)])


def followed(mesh: Mesh, points: Sequence[Point]) -> tuple[CutLine, tuple[bool, bool]]:
    """Give a line through points that leaves the plate where it ends on an edge; and which ends are inside."""
    corners, touching = np.array(points, dtype=np.float64), mesh.near.place
    if len(points) > 2 and points[0] == points[-1]:
        return CutLine(corners, touching), (False, False)
    edges = [_edge(mesh, corners[end]) for end in (0, -1)]
    for end, (at, _) in zip((0, -1), edges, strict=True):
        corners[end] = at
    ways = [
        None if beside is None else _out(beside - at, at - corners[inner], touching)
        for inner, (at, beside) in zip((1, -2), edges, strict=True)
    ]
    return CutLine(corners, touching, ways), (ways[0] is None, ways[1] is None)


def _edge(mesh: Mesh, at: Floats) -> tuple[Floats, Floats | None]:
    """Where an end is, in a node if it is next to it; of one on an edge the node before and that behind it (2, 2)."""
    chords = np.concatenate([mesh.boundary[:, :2], mesh.boundary[:, 1:]])
    near, ends = BESIDE * mesh.size, mesh.points[chords]
    apart = np.hypot(*np.moveaxis(ends[:, 0] - at, 1, 0))
    if apart.min() <= near:
        node = chords[apart.argmin(), 0]
        at = mesh.points[node]
        before, behind = ends[chords[:, 1] == node, 0], ends[chords[:, 0] == node, 1]
        # Where parts of the plate meet in a node, those between which there is no plate.
        pairs = [np.stack([one, other]) for one in before for other in behind]
        return at, min(pairs, key=lambda pair: _turn(pair - at))
    sides = mesh.points[mesh.boundary]
    apart = np.hypot(*(onto(sides, at) - at).T)
    side = sides[apart.argmin()]
    if apart.min() > near and not _on_arc(side, at, near):
        return at, None
    chord = side[:2] if (at - side[1]) @ (side[2] - side[0]) < 0.0 else side[1:]
    return at, chord


def _on_arc(side: Floats, at: Floats, near: float) -> bool:
    """Whether a place is on the arc for which a side stands: so are ends on circles, the sides being parabolas."""
    a, middle, b = (tuple(node) for node in side.tolist())
    arc = arc_through(a, middle, b)
    between = 0.0 < (at - side[0]) @ (side[2] - side[0]) < math.dist(a, b) ** 2
    return arc is not None and bool(between) and abs(math.dist(at, arc[0]) - arc[1]) <= near


def _turn(beside: Floats) -> float:
    """Angle counter-clockwise from one direction to the other (2, 2), along an edge that has the plate on the left."""
    (x, y), (u, v) = beside.tolist()
    return math.atan2(x * v - y * u, x * u + y * v) % math.tau


def _out(beside: Floats, outward: Floats, touching: float) -> Floats | None:
    """Give the direction midway between those along the edge (2, 2), on the side where no plate is.

    None where the line runs along the edge, and the edge goes on straight ahead: the line is that just inside.
    """
    outward = outward / np.hypot(*outward)
    off, ahead = beside @ [outward[1], -outward[0]], beside @ outward
    if (np.abs(off) <= touching).all() and ahead[0] * ahead[1] < 0.0:
        return None
    half = 0.5 * _turn(beside)
    c, s = math.cos(half), math.sin(half)
    return np.asarray(np.array([[c, -s], [s, c]]) @ beside[0] / np.hypot(*beside[0]))


@dataclass(frozen=True, eq=False)
class Cut:
    """A line, its length on the plate, and the elements (k,) that it meets, in rising order.

    ``of_forces`` (k, 3, 24) is what nodal forces on the elements count for in moment, twist and shear, in the nodes'
    frames, ``of_stress`` (k, p, 5, 3) what their moments and shears do at the points of their stiffness. ``motion`` (k,
    3, 24) is v of the elements that the line divides, else 0, and ``left`` are points of these on the left; elements by
    their place among the k.
    """

    line: CutLine
    length: float
    elements: Ints
    of_forces: Floats
    of_stress: Floats
    motion: Floats
    left: Quadrature

    def divided(self) -> Bools:
        """Which elements (k,) the line divides."""
        return np.asarray(self.motion.any(axis=(1, 2)))

    def on_left(self, mesh: Mesh, region: Part | None, order: int, levels: Levels) -> Quadrature:
        """Points of a region on the left, in the elements that the line divides, by their place among the k."""
        if region is None and not levels:
            return self.left
        return _on_left(mesh.part(self.elements), self.line, self.divided(), region, order, levels)

    def work(self, elements: Ints, rows: Floats, left: Floats) -> Floats:
        """What forces count for (q, 3), down, with rows (q, 24) over elements (q,) by their place among the k.

        ``left`` (q,) is the part of each that acts on the left: half of what acts on the line.
        """
        on_whole = (left == 0.5) & ~self.divided()[elements]
        lever = self.of_forces[elements] + left[:, None, None] * self.motion[elements]
        return np.where(on_whole[:, None], 0.0, -np.einsum("qcd,qd->qc", lever, rows))

    def lefts(self, positions: Floats) -> Floats:
        """What part (q,) of something at positions (q, 2) acts on the left."""
        return np.asarray(0.5 - 0.5 * self.line.near(positions).side)

    def level(self, positions: Floats) -> Floats:
        """Give numbers (q,) for positions (q, 2) that change their sign where the line is, and nowhere near it."""
        near = self.line.near(positions)
        return np.where(near.side == 0, near.off[np.arange(len(positions)), near.piece], near.side)


def cut(mesh: Mesh, plate: _core.Plate, kind: str, held: Held, points: Sequence[Point]) -> Cut:
    """Cut a plate of a kind of elements along a line through points, some of which is on the plate."""
    line = _Followed(mesh, points)
    met, divided, pieces = _met(mesh, line)
    length = _length(line.line, pieces)
    if not length > 0.0:
        raise InputError("The line is not on the plate. Move it onto the plate.")
    near = line.line.near(mesh.points[mesh.elements[met]].reshape(-1, 2))
    taken = line.taken(near).reshape(-1, 8)
    taken[_of_bodies_at_ends(mesh.elements[met], held, near.side.reshape(-1, 8), taken)] = 0.0
    # Where no node is beside the line, v is 0 in an element that the line is in, and too little by all of it.
    of_line = (pieces.begin >= 0.0) & (pieces.end <= line.line.lengths[pieces.piece])
    some = taken.any(axis=1) | np.isin(met, pieces.elements[of_line])
    elements, divided, taken = met[some], divided[some], taken[some]
    shares, off = (values.reshape(len(met), 8, -1)[some] for values in (near.shares, near.off))
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
    parts = _parts_of_forces(mesh, line.line, elements, divided, near.side.reshape(-1, 8)[some], rigid)
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
    """A line on a plate: which of its ends lie inside, and how far it is followed beyond these."""

    def __init__(self, mesh: Mesh, points: Sequence[Point]) -> None:
        self.line, self.inside = followed(mesh, points)
        self.reach = _BEYOND * float(np.hypot(*(mesh.boxes[:, 2:] - mesh.boxes[:, :2]).T).max())
        self.beyond = np.where(self.inside, self.reach, 0.0)

    def taken(self, near: Near) -> Floats:
        """1 at points beside the line, 0 beyond an end inside the plate, a half beside the end itself."""
        taken, lengths = np.ones(len(near.piece)), self.line.lengths
        for end, (piece, past) in enumerate(((0, -near.station), (len(lengths) - 1, near.station - lengths[-1]))):
            if self.inside[end]:
                there = np.where(np.abs(past) <= self.line.touching, 0.5, past < 0.0)
                taken = np.where(near.piece == piece, np.minimum(taken, there), taken)
        return taken


def _met(mesh: Mesh, followed: _Followed) -> tuple[Ints, Bools, _Pieces]:
    """Elements (k,) that the line meets as far as it is followed, be it in a node, and which of them it divides.

    And what of it is in each; of elements with curved sides as if these were straight between nodes.
    """
    line, beyond = followed.line, followed.beyond
    x0, y0, x1, y1 = line.extended(followed.reach).bounds
    low, high = mesh.boxes[:, :2] - line.touching, mesh.boxes[:, 2:] + line.touching
    (near,) = np.nonzero((low <= [x1, y1]).all(axis=1) & (high >= [x0, y0]).all(axis=1))
    met, divided = np.zeros(len(near), np.bool_), np.zeros(len(near), np.bool_)
    nodes = mesh.points[mesh.elements[near][:, _AROUND]]
    pieces = []
    for piece, (begin, along, normal) in enumerate(zip(line.begin, line.along, line.normals, strict=True)):
        station, off = ((nodes - begin) @ way for way in (along, normal))
        low = -beyond[0] * (piece == 0)
        high = line.lengths[piece] + beyond[1] * (piece == len(line.lengths) - 1)
        off = np.where(np.abs(off) <= line.touching, 0.0, off)
        ahead, ahead_off = np.roll(station, -1, axis=1), np.roll(off, -1, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = station + (ahead - station) * off / (off - ahead_off)
        at = np.hstack([crossing, station])
        on = np.hstack([off * ahead_off < 0.0, off == 0.0])
        first = np.maximum(np.where(on, at, np.inf).min(axis=1), low)
        final = np.minimum(np.where(on, at, -np.inf).max(axis=1), high)
        met |= final >= first - line.touching
        longer = final > first + line.touching
        divided |= longer & (off > 0.0).any(axis=1) & (off < 0.0).any(axis=1)
        stops = np.unique([low, 0.0, line.lengths[piece], high])
        for begin_at, end_at in pairwise(stops):
            first_in, final_in = np.maximum(first, begin_at), np.minimum(final, end_at)
            (some,) = np.nonzero(final_in > first_in + line.touching)
            pieces.append(_Pieces(near[some], np.full(len(some), piece), first_in[some], final_in[some]))
    return near[met], divided[met], _Pieces(*(np.concatenate(part) for part in zip(*pieces, strict=True)))


class _Pieces(NamedTuple):
    """What of the line's pieces (q,) is in elements (q,), or along their sides: from one station to another."""

    elements: Ints
    piece: Ints
    begin: Floats
    end: Floats


def _of_bodies_at_ends(nodes: Ints, held: Held, side: Ints, taken: Floats) -> Bools:
    """Which nodes (k, 8) are of rigid bodies that the line ends at, and does not run along: v is 0 on these.

    A body is in equilibrium as a whole, so that v must be one rigid motion on it.
    """
    inside, leader = held.bodies.inside[nodes], held.bodies.leaders[nodes]
    along = leader[inside & (side == 0) & (taken == 1.0)]
    return np.asarray(inside & np.isin(leader, np.setdiff1d(leader[inside & (taken < 1.0)], along)))


def _parts_of_forces(mesh: Mesh, line: CutLine, elements: Ints, divided: Bools, side: Ints, rigid: Bools) -> Floats:
    """What part of v nodal forces of the elements (k, 8) count with, at nodes on a side (k, 8) of the line.

    Of elements that it divides, -v at nodes on the left. Of others v at nodes on the line: half of it on its left, half
    of -v on its right; along an edge of the plate, where elements are on one side alone, the whole. So too along a
    rigid body, whose nodes are in equilibrium all together, and not each: they count as on the body's side.
    """
    nodes = mesh.elements[elements]
    centres = mesh.map(elements, mesh.inward(elements, np.zeros((len(elements), 2)), 0.0))
    where = line.near(centres).side
    beside = [np.isin(nodes, nodes[divided | (where == way)]) for way in (LEFT, RIGHT)]
    of_bodies = [np.isin(nodes, nodes[rigid & (where == way)]) for way in (LEFT, RIGHT)]
    alone = [np.isin(nodes, nodes[~rigid & (divided | (where == way))], invert=True) for way in (LEFT, RIGHT)]
    within = (side == 0) & ((of_bodies[0] & alone[1]) | (of_bodies[1] & alone[0]))
    if (crossed := (rigid & divided) | within.any(axis=1)).any():
        at = point(centres[np.argmax(crossed)], mesh.size)
        raise InputError(
            f"The line crosses a rigid zone at {at}, where there are no moments and shears. Let it run along the "
            "zone's outline or beside it, or end at the outline."
        )
    part = np.select(of_bodies, [0.5 + 0.5 * where[:, None], 0.5 - 0.5 * where[:, None]], 0.5)
    of_whole = -where[:, None] * np.where(beside[0] & beside[1], part, 1.0) * (side == 0)
    of_divided = np.select(of_bodies, [1.0, 0.0], 0.5) * (side == 0) + (side == LEFT)
    return np.asarray(np.where(divided[:, None], -of_divided, of_whole))


def _on_left(part: Mesh, line: CutLine, divided: Bools, region: Part | None, order: int, levels: Levels) -> Quadrature:
    """Points of a region on the left in those elements (k,) of a part of the mesh that the line divides."""
    (which,) = np.nonzero(divided)
    if not len(which):
        return Quadrature(which, np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2)))
    some = part.part(which)
    (x0, y0), (x1, y1) = some.boxes[:, :2].min(axis=0).tolist(), some.boxes[:, 2:].max(axis=0).tolist()
    result = area_quadrature(some, LeftOf(line, (x0, y0, x1, y1), region), order, levels=levels)
    return Quadrature(which[result.elements], result.xi, result.weights, result.positions)


def _between(mesh: Mesh, kind: str, elements: Ints, xi: Floats) -> Floats:
    """Values (q, p) of the functions that are 1 at one of the points of an element's stiffness and 0 at the others.

    Of triangles, whose last two places are empty, least squares by quadratics through seven points.
    """
    count = _POINTS[kind]
    result = np.zeros((len(xi), count))
    triangles = mesh.triangles[elements]
    for some, degrees, points in (
        (~triangles, _square(round(np.sqrt(count))), _core.section_points(kind)[:count]),
        (triangles, _TRIANGULAR, _core.section_points("mitc9", True)[:7]),
    ):
        if not some.any():
            continue
        result[some, : len(points)] = _monomials(xi[some], degrees) @ np.linalg.pinv(_monomials(points, degrees))
    return result


def _square(count: int) -> Ints:
    return np.array([(i, j) for i in range(count) for j in range(count)])


def _monomials(xi: Floats, degrees: Ints) -> Floats:
    return np.asarray((xi[:, None, :] ** degrees).prod(axis=2))


def _rest(
    mesh: Mesh, plate: _core.Plate, kind: str, line: _Followed, elements: Ints, v: Floats, pieces: _Pieces
) -> Floats:
    """What stresses (k, p, 5, 3) do on what v is too little on the line, where it should be 1 to the line's ends."""
    place, some = placed(elements, pieces.elements)
    node, weight = gauss(_ORDER)
    half = 0.5 * (pieces.end - pieces.begin)[some, None]
    station = (0.5 * (pieces.begin + pieces.end)[some, None] + half * node).ravel()
    weights = (half * weight * _once(pieces)[some, None]).ravel()
    place, piece = (np.repeat(values, _ORDER) for values in (place, pieces.piece[some]))
    along, normal, at = line.line.along[piece], line.line.normals[piece], elements[place]
    positions = line.line.begin[piece] + station[:, None] * along
    xi = mesh.invert(at, positions)
    wanted = np.zeros((len(at), 3, 3))
    wanted[:, 0, 1:], wanted[:, 1, 1:], wanted[:, 2, 0] = -normal, -along, 1.0
    wanted *= line.taken(line.line.near(positions))[:, None, None]
    rows = np.stack([plate.interpolation_rows(at, xi, field)[0] for field in range(3)], axis=1)
    w, x, y = np.moveaxis(wanted - np.einsum("qcd,qfd->qcf", v[place], rows), -1, 0)
    nx, ny = (part[:, None] for part in normal.T)
    # What the right gives the left: Q·n on w, -Mn on the slopes.
    work = weights[:, None, None] * np.stack([-nx * x, -ny * y, -nx * y - ny * x, nx * w, ny * w], axis=1)
    stress = np.zeros((len(elements), _POINTS[kind], 5, 3))
    np.add.at(stress, place, _between(mesh, kind, at, xi)[:, :, None, None] * work[:, None])
    return stress


def _once(pieces: _Pieces) -> Floats:
    """1, or a half where the line runs between two elements, for each of them."""
    middle = 0.5 * (pieces.begin + pieces.end)
    order = np.lexsort((middle, pieces.piece))
    again = (np.diff(pieces.piece[order]) == 0) & (pieces.begin[order][1:] < middle[order][:-1])
    parts = np.ones(len(middle))
    for shared in (order[:-1][again], order[1:][again]):
        parts[shared] = 0.5
    return parts


def _length(line: CutLine, pieces: _Pieces) -> float:
    """Length of the line on the plate, without what it is followed beyond its ends."""
    inside = np.minimum(pieces.end, line.lengths[pieces.piece]) - np.maximum(pieces.begin, 0.0)
    return float(np.maximum(inside, 0.0) @ _once(pieces))


def placed(elements: Ints, of: Ints) -> tuple[Ints, Ints]:
    """Which of some elements (q,) are among elements (k,) in rising order: their place there, and which they are."""
    place = np.minimum(np.searchsorted(elements, of), len(elements) - 1)
    some = np.flatnonzero(elements[place] == of) if len(elements) else np.zeros(0, np.int64)
    return place[some], some
