"""Reactions per length along edges, lines and circles, with concentrated forces at their ends and corners.

The line is divided into pieces with linear functions φⱼ of their ends j. Forces fᵢ of a support at coordinates tᵢ
become forces Fⱼ = Σᵢ φⱼ(tᵢ) fᵢ at the ends (docs/theory.md, section 5). Quadratic elements divide a smooth reaction
between corners and midsides as 1 : 4, thin elements irregularly. The forces Fⱼ do not alternate in this way.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Self

import numpy as np
from scipy.sparse import csr_array, eye_array

from signorini.base.components import components
from signorini.base.on_demand import kept
from signorini.base.remade import Remade
from signorini.discretise import Discretisation
from signorini.discretise.held import Bodies, sides_that_hold_turns
from signorini.discretise.laws import can_let_go
from signorini.discretise.places import mesh_edges, quadratic_tangents, side_lengths
from signorini.discretise.quadrature.lines import curve_pieces
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.model import Support
from signorini.results.extremes import peak
from signorini.results.support_points import SupportPoints
from signorini.shapes import Ring
from signorini.shapes.boxes import BoxTree

CORNER = np.cos(np.radians(15.0))
"""Cosine of the smallest turn of a line that counts as a corner. Between two quadratic sides along a circle the tangent
turns by less than 1°.
"""
_APART = 2.0
"""Distance of stations along a line that cuts elements, relative to the element size. Such a line holds the mean
deflection of each element, and the forces of neighbouring elements alternate; a longer distance averages them.
"""
_PARALLEL = 1e-9
"""Zero tolerance for eigenvalues of the second moments of a line's vertices, relative to the largest eigenvalue. One
eigenvalue is zero if the vertices within a rigid zone, to which a linear reaction is fitted, are on a straight line.
"""
_LAYER, _MOST_OF_RUN = 3.0, 0.25
"""Length of the zone at the end of a line in which the reaction per length is extrapolated: 3 times the plate's
thickness h, at most a quarter of a smooth run. A Mindlin plate spreads the concentrated force at the end over a
boundary layer of width δ = 0.32 h.
"""
_WIDTH, _SEEN = 10.0**-0.5, 2.65
"""Width δ of the boundary layer relative to the thickness h. On a mesh of elements of size s the layer has the width
x tanh(1/x) δ, with x = 2.65 h/s.
"""
_NEIGHBOURS = 3
"""Number of stations beyond the end zone through whose means the extrapolated parabola passes."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces of a support's line: end points (k, 2, 2), unit tangents there (k, 2, 2) and lengths (k,).

    ``sides`` (k, 3) are the element sides that form the pieces; None where the line cuts elements.
    """

    ends: Floats
    tangents: Floats
    lengths: Floats
    sides: Ints | None

    @classmethod
    def of(cls, discretisation: Discretisation, index: int) -> Self:
        """Divide the line of a support into pieces: element sides, or else parts of about two element sizes."""
        mesh, where = discretisation.mesh, discretisation.model.support[index].where
        sides = mesh_edges(mesh, discretisation.model.plate, where, ("support", index))
        if sides is not None:
            tangents = quadratic_tangents(mesh, sides)[:, [0, 2]]
            return cls(mesh.points[sides[:, [0, 2]]], tangents, side_lengths(mesh, sides).sum(axis=1), sides)
        assert where.curve is not None  # A line support that is not on edges has a curve.
        parts = []
        for arc, stops, elements in curve_pieces(mesh, where.curve):
            size = _APART * np.sqrt(mesh.element_area[elements[elements >= 0]].mean())
            for on in _runs_of(elements >= 0):
                own = stops[on[0] : on[-1] + 2]
                # A piece is at most a third of a circle; the two ends of a whole circle would be one point.
                turns = 3.0 * (own[-1] - own[0]) / (stops[-1] - stops[0]) if isinstance(where.curve, Ring) else 1.0
                count = max(1, round(turns), int((own[-1] - own[0]) / size))
                wanted = np.linspace(own[0], own[-1], count + 1)
                own = own[np.unique(np.abs(own[:, None] - wanted).argmin(axis=0))]
                at, along = arc.at(own)
                parts.append((*(np.stack([one[:-1], one[1:]], axis=1) for one in (at, along)), np.diff(own)))
        ends, tangents, lengths = (np.concatenate(column) for column in zip(*parts, strict=True))
        return cls(ends, tangents, lengths, None)

    def in_runs(self, near: float) -> tuple[Self, Ints, Bools]:
        """Order the pieces so that they form smooth runs; all pieces of a run point in the same direction along it.

        Returns the pieces, the vertices (k, 2) at the ends of each piece, and a mask (v,) of the vertices at which the
        line is smooth. Ends nearer than ``near`` are one vertex.
        """
        places = self.ends.reshape(-1, 2)
        pairs = BoxTree(np.hstack([places - near, places + near])).pairs(places)
        ends = components(len(places), *pairs)
        leaving = (self.tangents * np.array([[1.0], [-1.0]])).reshape(-1, 2)
        turned = np.column_stack([np.bincount(ends, part) for part in leaving.T])
        smooth = (np.bincount(ends) == 2) & ((turned**2).sum(axis=1) < 2.0 - 2.0 * CORNER)
        by_vertex = np.bincount(ends, np.arange(len(ends))).astype(np.int64)
        other = np.where(smooth[ends], by_vertex[ends] - np.arange(len(ends)), -1).tolist()
        order, seen = list[int](), np.zeros(len(self.ends), np.bool_)
        for first in range(0, len(ends), 2):
            if seen[first // 2]:
                continue
            entered = first
            while other[entered] >= 0 and (before := other[entered] ^ 1) != first:
                entered = before
            entered = first if other[entered] >= 0 else entered
            while entered >= 0 and not seen[entered // 2]:
                seen[entered // 2] = True
                order.append(entered)
                entered = other[entered ^ 1]
        piece, turn = np.array(order) // 2, np.array(order) % 2 == 1
        vertices = ends.reshape(-1, 2)[piece]
        result = type(self)(
            np.where(turn[:, None, None], self.ends[piece][:, ::-1], self.ends[piece]),
            np.where(turn[:, None, None], -self.tangents[piece][:, ::-1], self.tangents[piece]),
            self.lengths[piece],
            None if self.sides is None else np.where(turn[:, None], self.sides[piece][:, ::-1], self.sides[piece]),
        )
        return result, np.where(turn[:, None], vertices[:, ::-1], vertices), smooth

    def locate(self, points: Floats) -> tuple[Ints, Floats]:
        """Find the piece (q,) nearest to each point (q, 2), and the point's coordinate (q,) along it, from 0 to 1."""
        begin, along = self.ends[:, 0], self.ends[:, 1] - self.ends[:, 0]
        reach = self.lengths.max()
        boxes = np.hstack([self.ends.min(axis=1) - reach, self.ends.max(axis=1) + reach])
        point, piece = BoxTree(boxes).pairs(points)
        offset = points[point] - begin[piece]
        t = np.clip((offset * along[piece]).sum(axis=1) / (along[piece] ** 2).sum(axis=1), 0.0, 1.0)
        far = np.hypot(*(offset - t[:, None] * along[piece]).T)
        order = np.lexsort((piece, far, point))
        _, first = np.unique(point[order], return_index=True)
        return piece[order[first]], t[order[first]]


@dataclass(frozen=True, eq=False, kw_only=True)
class Line:
    """Stations (k,) along the line of a support, and matrices that map the support's forces to reactions per length.

    ``vertex`` (k,) is the vertex of each station, from 0 to v − 1; at a corner of the line, one vertex has two
    stations. ``lengths`` (k,) are the parts of the line that stations represent, ``normals`` (k, 2) point to the right
    of the line. ``pieces`` (k,) are the numbers of the pieces that begin at the stations, −1 at the end of a run.
    """

    positions: Floats
    normals: Floats
    s: Floats
    lengths: Floats
    vertex: Ints
    pieces: Ints
    sides: Ints | None
    forces: csr_array  # (v, p): maps the forces of the support's points to forces at the vertices
    # (v, 2n): maps couples on θx and θy of nodes to forces at the vertices; None unless the support holds the twist
    couples: csr_array | None
    # (k, k): maps mean reactions per length at stations to reactions per length, extrapolated at ends of the line
    extrapolated: csr_array
    # (k,): station whose mean, with a station's own, bounds its reaction: beyond the end zone, elsewhere the station
    beside: Ints
    zones: csr_array  # (c, v): 1 at the vertices in the end zone of each concentrated force
    corners: Floats  # (c, 2): positions of the corners and ends that have a concentrated force
    one_sided: bool
    points_s: Floats  # (p,): length along the line from its beginning to each point of the support

    @staticmethod
    @kept
    def of(discretisation: Discretisation, index: int) -> Line:
        """Stations and matrices of the line of support number ``index``, computed once."""
        support, mesh = discretisation.model.support[index], discretisation.mesh
        pieces, vertices, smooth = Pieces.of(discretisation, index).in_runs(mesh.near.place)
        goes_on = (vertices[:-1, 1] == vertices[1:, 0]) & smooth[vertices[:-1, 1]]
        firsts = np.flatnonzero(np.append(True, ~goes_on)).tolist()
        runs = [np.arange(a, b) for a, b in pairwise([*firsts, len(vertices)])]
        begin = np.concatenate([np.append(run, -1) for run in runs])
        after = np.concatenate([np.append(-1, run) for run in runs])
        half = 0.5 * pieces.lengths
        lengths = np.where(begin >= 0, half[begin], 0.0) + np.where(after >= 0, half[after], 0.0)
        piece, end = np.where(begin >= 0, begin, after), np.where(begin >= 0, 0, 1)
        vertex = vertices[piece, end]
        tangents = pieces.tangents[piece, end]
        s = np.append(0.0, np.cumsum(pieces.lengths))[piece + end]
        on, t = pieces.locate(SupportPoints.of(discretisation, index).positions)
        layer = np.full(len(vertex), float(discretisation.thickness.at_points.mean()))
        if "twist" in support.fixed:
            # There is no boundary layer at a node where two edges that hold the twist meet.
            held = sides_that_hold_turns(discretisation.model, mesh)[:, [0, 2]]
            meeting = np.append(np.bincount(held.ravel(), minlength=mesh.node_count), 0)
            layer[meeting[mesh.nodes_at(pieces.ends[piece, end])] > 1] = 0.0
        if not _concentrates(support):
            smooth = np.ones(len(smooth), np.bool_)
        extrapolated, toward, beside = _extrapolation(runs, pieces.lengths, smooth[vertex], layer)
        ends, corner = np.unique(vertex[toward[toward >= 0]], return_inverse=True)
        zones = np.unique(np.column_stack([corner.ravel(), vertex[toward >= 0]]), axis=0).T
        return Line(
            positions=pieces.ends[piece, end],
            normals=np.column_stack([tangents[:, 1], -tangents[:, 0]]),
            s=s,
            lengths=lengths,
            vertex=vertex,
            pieces=begin,
            sides=pieces.sides,
            forces=_at_vertices(discretisation, index, pieces, vertices, len(smooth)),
            couples=_force_pairs(discretisation, index, pieces, vertices, len(smooth))
            if "twist" in support.fixed
            else None,
            extrapolated=extrapolated,
            beside=beside,
            zones=csr_array((np.ones(zones.shape[1]), zones), shape=(len(ends), len(smooth))),
            corners=np.stack([np.bincount(vertices.ravel(), x) for x in pieces.ends.reshape(-1, 2).T], axis=1)[ends]
            / np.bincount(vertices.ravel())[ends, None],
            one_sided=can_let_go(support),
            points_s=np.append(0.0, np.cumsum(pieces.lengths))[on] + t * pieces.lengths[on],
        )

    def read(self, forces: Floats, couples: Floats | None = None) -> tuple[Floats, Floats]:
        """Reactions per length (..., k) at stations, and concentrated forces (..., c) at corners and ends.

        ``forces`` (..., p) are the forces of the support's points. ``couples`` (..., v) are forces at vertices that are
        equivalent to the twisting couples of the edge.
        """
        at_vertices = (self.forces @ forces.T).T + (0.0 if couples is None else couples)
        whole = np.bincount(self.vertex, self.lengths)
        mean = (at_vertices / whole)[..., self.vertex]
        per_length = (self.extrapolated @ mean.T).T
        next_to = mean[..., self.beside]
        per_length = np.clip(per_length, np.minimum(mean, next_to), np.maximum(mean, next_to))
        if self.one_sided:
            # On a one-sided line, reactions per length and concentrated forces have the sign of the mean reaction.
            per_length = np.clip(per_length, np.minimum(mean, 0.0), np.maximum(mean, 0.0))
        spread = np.zeros(at_vertices.shape)
        np.add.at(spread.T, self.vertex, (per_length * self.lengths).T)
        return np.asarray(per_length), np.asarray((self.zones @ (at_vertices - spread).T).T)


def lines_of(discretisation: Discretisation) -> dict[int, Line]:
    """Lines of supports by index of the support in the model; a line between two plates is read on the upper plate."""
    result = {}
    for plate in discretisation.members:
        for index, support in enumerate(plate.own.model.support):
            if support.along_line and index not in plate.upon:
                result[plate.numbers["support"][index]] = Line.of(plate.own, index)
    return dict(sorted(result.items()))


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LineReactions(Remade):
    """Reactions per length of a support along edges, a line or a circle, positive where they push the plate up.

    Between stations of one run the reaction per length is linear, so that its integral is
    Σ ``reactions`` × ``lengths``. The integral plus the sum of ``corner_reactions`` is the support's total reaction.

    Parameters
    ----------
    positions : (k, 2) array
        Stations, in the order of the line; two at a corner, and one at each end of a gap in the line.
    normals : (k, 2) array
        Unit normals of the line, to its right; outward on edges.
    s : (k,) array
        Length along the line from its beginning to each station.
    lengths : (k,) array
        Length of the line that each station represents.
    reactions : (k,) array
        Reaction per length at each station.
    begins : (k,) bool array
        Mask of the stations at which a run begins. A run is a smooth part of the line; its last station is the one
        before the next begin.
    corners : (c, 2) array
        Corners and ends of the line, at which a rigid support without limit has a concentrated force.
    corner_reactions : (c,) array
        Concentrated forces at ``corners``.
    points_s : (p,) array
        Length along the line from its beginning to each point of the support.

    Examples
    --------
    >>> from signorini import Model, solve
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     support=[{"edge": ["left", "right"], "fix": "clamped"}],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> line = solve(model)["all"].supports[0].line
    >>> total = line.reactions @ line.lengths + line.corner_reactions.sum()
    >>> round(float(total), 3), line.s[[0, -1]].round(9).tolist()
    (80000.0, [0.0, 8.0])
    """

    positions: Floats
    normals: Floats
    s: Floats
    lengths: Floats
    reactions: Floats
    begins: Bools
    corners: Floats
    corner_reactions: Floats
    points_s: Floats

    @classmethod
    def of(cls, line: Line, reactions: Floats, corner_reactions: Floats) -> Self:
        """Combine the stations of a line with reactions per length (k,) and concentrated forces (c,)."""
        begins = np.append(True, line.pieces[:-1] < 0)
        return cls(
            positions=line.positions,
            normals=line.normals,
            s=line.s,
            lengths=line.lengths,
            reactions=reactions,
            begins=begins,
            corners=line.corners,
            corner_reactions=corner_reactions,
            points_s=line.points_s,
        )

    @property
    def max_per_length(self) -> float:
        """Largest reaction per length."""
        return float(self.reactions.max())

    @property
    def min_per_length(self) -> float:
        """Smallest reaction per length."""
        return float(self.reactions.min())

    @property
    def max_per_length_at(self) -> tuple[float, float]:
        """Position (x, y) of the largest reaction per length; of equal values (to 1e-9) the least x, then y."""
        x, y = self.positions[peak(self.reactions, self.positions)].tolist()
        return x, y

    @property
    def min_per_length_at(self) -> tuple[float, float]:
        """Position (x, y) of the smallest reaction per length; of equal values (to 1e-9) the least x, then y."""
        x, y = self.positions[peak(-self.reactions, self.positions)].tolist()
        return x, y


def _at_vertices(discretisation: Discretisation, index: int, pieces: Pieces, vertices: Ints, count: int) -> csr_array:
    """Matrix (v, p) that maps forces of a support's p points to forces at v vertices, with φⱼ linear along each piece.

    In a rigid zone only the resultant and the moments of the reactions are determinate: there the reaction per length
    is assumed to be linear. Supports that can open have no such assumption.
    """
    points, bodies, mesh = SupportPoints.of(discretisation, index), discretisation.held.bodies, discretisation.mesh
    on, t = pieces.locate(points.positions)
    rows, columns = vertices[on].ravel(), np.repeat(np.arange(len(on)), 2)
    shares = np.column_stack([1.0 - t, t]).ravel()
    linear = csr_array((shares, (rows, columns)), shape=(count, len(on)))
    if not bodies.inside.any() or can_let_go(discretisation.model.support[index]):
        return linear
    result: Any = linear.tolil()
    nodes = mesh.nodes_at(points.positions)
    of_points = np.where(nodes >= 0, _body(bodies, nodes), _body(bodies, mesh.elements[points.elements, 0]))
    of_points[(nodes < 0) & ~bodies.rigid[points.elements]] = -1
    if pieces.sides is not None:
        of_pieces = np.where(bodies.inside[pieces.sides].all(axis=1), _body(bodies, pieces.sides[:, 1]), -1)
    else:
        elements = mesh.locate(pieces.ends.mean(axis=1)).elements
        of_pieces = np.where(bodies.rigid[elements], _body(bodies, mesh.elements[elements, 0]), -1)
    for body in np.intersect1d(of_points, of_pieces[of_pieces >= 0]).tolist():
        (own,), mine = np.nonzero(of_points == body), of_pieces == body
        some, first, which = np.unique(vertices[mine], return_index=True, return_inverse=True)
        length = np.bincount(which.ravel(), np.repeat(0.5 * pieces.lengths[mine], 2))
        at = pieces.ends[mine].reshape(-1, 2)[first]
        there, here = (
            np.column_stack([np.ones(len(one)), (one - at[0]) / mesh.size]) for one in (points.positions[own], at)
        )
        weighed = length[:, None] * here
        result[:, own] = 0.0
        result[np.ix_(some, own)] = weighed @ np.linalg.pinv(here.T @ weighed, _PARALLEL, hermitian=True) @ there.T
    return csr_array(result)


def _body(bodies: Bodies, nodes: Ints) -> Ints:
    """For each of nodes (q,), the leader node of the rigid zone that contains it; −1 outside rigid zones."""
    return np.where(bodies.inside[nodes], bodies.leaders[nodes], -1)


def _runs_of(which: Bools) -> list[Ints]:
    """Runs of consecutive indices at which a mask (k,) is True, as one array for each run."""
    (numbers,) = np.nonzero(which)
    return np.split(numbers, np.flatnonzero(np.diff(numbers) > 1) + 1) if len(numbers) else []


def _concentrates(support: Support) -> bool:
    """Whether a support can have a concentrated force: it is rigid and has no limit."""
    return not support.is_elastic and not support.has_pieces


def _extrapolation(runs: list[Ints], lengths: Floats, smooth: Bools, layer: Floats) -> tuple[csr_array, Ints, Ints]:
    """Matrix (k, k) that maps mean reactions at stations to reactions per length, extrapolated by `_at_end` at ends.

    An end is the first or last station of a run, unless it is in ``smooth`` (k,).

    ``layer`` (k,) is the thickness that causes a boundary layer at a station, 0 without a layer. The second returned
    array (k,) has for a station in an end zone the station of this end, −1 for other stations. The third array (k,) has
    for each station a station whose mean, with its own, bounds the reaction per length.
    """
    count = sum(len(run) + 1 for run in runs)
    result, toward, beside = eye_array(count, format="lil"), np.where(smooth, -1, np.arange(count)), np.arange(count)
    first = 0
    for run in runs:
        stations = first + np.arange(len(run) + 1)
        for order, along in ((stations, lengths[run]), (stations[::-1], lengths[run][::-1])):
            if not smooth[order[0]]:
                columns, weights = _at_end(along, float(layer[order[0]]))
                for station, row in zip(order, weights, strict=False):
                    result[station, station] = 0.0
                    result[station, order[columns]] = row
                    toward[station], beside[station] = order[0], order[columns[1:3][-1]]
        first += len(stations)
    return csr_array(result), toward, beside


def _at_end(lengths: Floats, thickness: float) -> tuple[Ints, Floats]:
    """Weights (z, m) of the means at stations ``columns`` (m,) in the reactions per length at the first z stations.

    ``lengths`` are the lengths of the pieces. If the end zone contains more than the first station, the parabola
    through stations beyond the zone is extrapolated. If it contains only the first station, the concentrated force Q
    has its centroid at the distance e h₀ from the end, with e = δ/h₀ and the length h₀ of the first piece. So eQ is
    part of the force at the second station.
    """
    s = np.append(0.0, np.cumsum(lengths))
    reach = min(_LAYER * thickness, _MOST_OF_RUN * float(s[-1]))
    count = max(1, int((s < reach).sum()))
    inner = s[count:-1]
    if not len(inner):
        return np.zeros(0, np.int64), np.zeros((0, 0))
    wanted = inner[0] + np.arange(_NEIGHBOURS) * max(reach, float(lengths[0]))
    columns = np.append(0, count + np.unique(np.abs(inner[:, None] - wanted).argmin(axis=0)))
    weights = np.array([[0.0, *_weights(lengths, station, columns[1:].tolist())] for station in range(count)])
    if count > 1 or not thickness:
        return columns, weights
    seen = _SEEN * thickness / lengths[0]
    e = seen * np.tanh(1.0 / seen) * _WIDTH * thickness / lengths[0]
    spread = 2.0 * e / (lengths[0] + lengths[1])
    first = np.eye(len(columns))[0]
    force = (first - weights[0]) * 0.5 * lengths[0] / (1.0 - e - 0.5 * lengths[0] * weights[0, 1] * spread)
    return columns, np.stack([weights[0] - weights[0, 1] * spread * force, np.eye(len(columns))[1] - spread * force])


def _weights(lengths: Floats, station: int, near: list[int]) -> list[float]:
    """Weights (n,) of the means at n stations ``near`` in that at ``station``, exact for polynomials of degree < n."""
    every = [station, *near]
    before, after = np.append(0.0, lengths)[every], np.append(lengths, 0.0)[every]
    s, size = np.append(0.0, np.cumsum(lengths))[every], lengths.sum()
    x = (s - s[0]) / size
    first = (after - before) / (3.0 * size)
    second = (after**3 + before**3) / (6.0 * (after + before) * size**2)
    moments = np.stack([np.ones(len(every)), x + first, x * x + 2.0 * x * first + second])[: len(near)]
    return [*np.linalg.solve(moments[:, 1:], moments[:, 0])]


def _force_pairs(
    discretisation: Discretisation, index: int, pieces: Pieces, vertices: Ints, count: int
) -> csr_array | None:
    """Matrix (v, 2n) that maps nodal couples to forces ±C/h at the ends of sides of length h with twisting couple C."""
    if (sides := pieces.sides) is None:
        return None
    mesh, held = discretisation.mesh, discretisation.held.bodies.inside
    tangents = quadratic_tangents(mesh, sides)
    alone = of_the_line_alone(mesh, sides, sides_that_hold_turns(discretisation.model, mesh), held)
    per_length = per_length_of_sides(mesh, sides, tangents, alone)
    rows, side = np.concatenate([vertices[:, 1], vertices[:, 0]]), np.tile(np.arange(len(sides)), 2)
    signs = np.repeat([1.0, -1.0], len(sides))
    return csr_array(csr_array((signs, (rows, side)), shape=(count, len(sides))) @ per_length)


def per_length_of_sides(mesh: Mesh, sides: Ints, directions: Floats, alone: Bools) -> csr_array:
    """Matrix (k, 2n) that maps couples of n nodes to mean couples per length of sides (k, 3).

    Only the component along ``directions`` (k, 3, 2) counts. A nodal couple is spread over the length that its node
    represents. Only nodes in the mask ``alone`` (k, 3) contribute.
    """
    length = side_lengths(mesh, sides)
    whole = np.bincount(sides.ravel(), length.ravel(), mesh.node_count)
    own = np.where(alone, length, 0.0)
    total = own.sum(axis=1, keepdims=True)
    shares = own / np.where(total > 0.0, total, 1.0) / whole[sides]
    rows = np.repeat(np.arange(len(sides)), 6)
    columns = (2 * sides[..., None] + np.arange(2)).ravel()
    return csr_array(
        ((shares[..., None] * directions).ravel(), (rows, columns)), shape=(len(sides), 2 * mesh.node_count)
    )


def of_the_line_alone(mesh: Mesh, sides: Ints, held: Ints, rigid: Bools) -> Bools:
    """Mask (k, 3) of the sides' nodes, not ``rigid``, at which no other ``held`` side ends or one goes straight on."""
    tangents = quadratic_tangents(mesh, sides)
    _, once = np.unique(held[:, 1], return_index=True)
    meeting = np.bincount(held[once][:, [0, 2]].ravel(), minlength=len(rigid))
    begin, end = (np.zeros((len(rigid), 2)) for _ in range(2))
    begin[sides[:, 0]], end[sides[:, 2]] = tangents[:, 0], tangents[:, 2]
    goes_on = (begin * end).sum(axis=1) > CORNER
    result = ((meeting < 2) | ((meeting == 2) & goes_on)) & ~rigid
    result[sides[:, 1]] = ~rigid[sides[:, 1]]
    return np.asarray(result[sides])
