"""Where a line ends: inside the plate, or on an edge, through which it leaves the plate.

What the line divides the plate into is a matter of the plate alone: beyond a re-entrant corner, or where it touches a
round hole, the plate is on the straight continuation of a line that has already ended. So of an end on an edge what is
left and right is told by a continuation that leads out of the plate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from signorini.discretise.rows import Floats
from signorini.mesh import Mesh
from signorini.mesh.sides import onto
from signorini.shapes.cuts import CutLine
from signorini.shapes.outlines import Point, arc_through

BESIDE = 1e-6
"""How far from an edge, of the plate's size, an end is on it, and from a node of an edge in it: more than rounding."""


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
