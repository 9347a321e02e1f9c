"""Validation of meshes; every error message names an element or a node."""

from __future__ import annotations

import numpy as np

from signorini.base.components import components
from signorini.errors import InputError, point
from signorini.mesh import isoparametric as maps
from signorini.mesh.sides import onto
from signorini.shapes.arrays import Bools, Floats, Ints
from signorini.shapes.boxes import BoxTree

_ROOT = np.sqrt(0.6)
_GAUSS = np.array([[x, y] for x in (-_ROOT, 0.0, _ROOT) for y in (-_ROOT, 0.0, _ROOT)])
_STATIONS = np.vstack([maps.CORNERS, _GAUSS])
_TRIANGLE_STATIONS = np.vstack([maps.TRIANGLE_CORNERS, maps.folded(_GAUSS)])
_DEGENERATE_STATIONS = np.vstack([maps.CORNERS[2:], [[-1.0, 0.0], [1.0, 0.0]], _GAUSS])
"""Reference points for the check of det J > 0 in degenerate quadrilaterals, off the collapsed side, where det J = 0."""
_COINCIDENT = 1e-9
"""Largest distance from a side at which a node counts as on the side, relative to the mesh's size."""
_STRAIGHT = 1e-9
"""Largest ratio of rise to chord of an element side that counts as straight."""
_CHORDS = 32
"""Number of chords that approximate a curved side; they deviate from the side by a thousandth of its rise."""
_TOGETHER = 1 << 18
"""Number of pairs of chords that are compared at once: their arrays fit in the cache."""


def name_element(points: Floats, elements: Ints, index: int) -> str:
    """Text with an element's number and position, for messages."""
    return f"Element {index} (the first has index 0) near {point(points[elements[index]].mean(axis=0))}"


def _name_node(points: Floats, index: int) -> str:
    return f"node {index} (the first has index 0) at {point(points[index])}"


def check_numbers(points: Floats, elements: Ints) -> None:
    """Check array shapes, finite coordinates and node numbers of a mesh.

    The numbers must be in range and different within an element, and every node must be used.
    """
    if points.ndim != 2 or points.shape[1] != 2:
        raise InputError(f"A mesh's points must have shape (n, 2); found {points.shape}.")
    if elements.ndim != 2 or elements.shape[1] != 8 or not len(elements):
        raise InputError(f"A mesh's elements must have shape (ne, 8) with ne ≥ 1; found {elements.shape}.")
    finite = np.isfinite(points).all(axis=1)
    if not finite.all():
        raise InputError(f"The mesh has a coordinate that is not finite: {_name_node(points, int(np.argmin(finite)))}.")
    if elements.min() < 0 or elements.max() >= len(points):
        raise InputError(f"The mesh's elements must use nodes 0 to {len(points) - 1}; found "
                         f"{elements.min()} to {elements.max()}.")  # fmt: skip
    ordered = np.sort(elements, axis=1)
    repeats = (ordered[:, 1:] == ordered[:, :-1]).sum(axis=1)
    triangles = maps.are_triangles(elements) & (elements[:, 2] == elements[:, 6])
    degenerate = maps.are_degenerate(elements) & (elements[:, 0] == elements[:, 4])
    repeated = repeats != np.where(triangles | degenerate, 2, 0)
    if repeated.any():
        raise InputError(
            f"{name_element(points, elements, int(np.argmax(repeated)))} uses a node twice; "
            "a quadrilateral needs eight different nodes, a triangle six, as [a, b, c, c, ab, bc, c, ca], and a "
            "quadrilateral with a side collapsed to the node c also six, as [c, c, a, b, c, ca, ab, bc]."
        )
    unused = np.bincount(elements.ravel(), minlength=len(points)) == 0
    if unused.any():
        raise InputError(
            f"The mesh has nodes that no element uses, such as {_name_node(points, int(np.argmax(unused)))}."
        )


def check_jacobians(points: Floats, elements: Ints) -> None:
    """Check that det J > 0 in every element, that is, nodes are counter-clockwise and no element is too distorted."""
    nodes, triangles, degenerate = points[elements], maps.are_triangles(elements), maps.are_degenerate(elements)
    det = np.empty((len(elements), len(_STATIONS)))
    for mask, stations in (
        (~(triangles | degenerate), _STATIONS),
        (triangles, _TRIANGLE_STATIONS),
        (degenerate & ~triangles, _DEGENERATE_STATIONS),
    ):
        det[mask] = maps.determinants(nodes[mask], stations, stations is _TRIANGLE_STATIONS)
    lower, upper = maps.bounds(np.moveaxis(nodes, 1, 0))
    extent = upper - lower
    bad = ~(det > 1e-10 * (extent[:, 0] * extent[:, 1])[:, None])
    if bad.any():
        index = int(np.argmax(bad.any(axis=1)))
        name = name_element(points, elements, index)
        if bad[index].all():
            raise InputError(f"{name} is clockwise or flat; its corners must run counter-clockwise.")
        raise InputError(
            f"{name} folds over itself (its Jacobian is not positive everywhere): a corner of 180° or more, or a "
            "midside node too near a corner. Improve its shape."
        )


def check_sides(points: Floats, elements: Ints) -> None:
    """Check that neighbouring elements share whole sides."""
    corner = np.zeros(len(points), dtype=bool)
    corner[elements[:, :4]] = True
    real = maps.real_sides(elements)
    at_corner = corner[elements[:, 4:]] & real
    hanging = at_corner.any(axis=1)
    if hanging.any():
        index = int(np.argmax(hanging))
        node = int(elements[index, 4:][at_corner[index]][0])
        raise InputError(
            f"{name_element(points, elements, index)} has a hanging node: its midside {_name_node(points, node)} is a "
            "corner of another element. Elements must meet along whole sides."
        )
    sides = elements[:, np.array(maps.SIDES)][real]
    sides = sides[np.argsort(sides[:, 1], kind="stable")]
    same = sides[1:, 1] == sides[:-1, 1]
    thrice = np.append(False, same[1:] & same[:-1])
    mismatched = same & ((sides[1:, 0] != sides[:-1, 2]) | (sides[1:, 2] != sides[:-1, 0]))
    pairs = np.sort(sides[:, [0, 2]], axis=1)
    by_pair = np.lexsort((sides[:, 1], pairs[:, 1], pairs[:, 0]))
    split = (pairs[by_pair][1:] == pairs[by_pair][:-1]).all(axis=1) & (np.diff(sides[by_pair, 1]) != 0)
    for wrong, midside in ((thrice | mismatched, sides[1:, 1]), (split, sides[by_pair[1:], 1])):
        if wrong.any():
            raise InputError(
                "Elements that share a side must have the same corners and the same midside node there, and at most "
                f"two may share it; this fails at midside {_name_node(points, int(midside[np.argmax(wrong)]))}."
            )


def check_boundary_nodes(points: Floats, boundary: Ints) -> None:
    """Check that no boundary node lies on another boundary side: elements would not be connected there."""
    sides = points[boundary]
    tolerance = _COINCIDENT * float(np.ptp(points, axis=0).max())
    boxes = maps.side_boxes(sides) + tolerance * np.array([-1.0, -1.0, 1.0, 1.0])
    nodes = np.unique(boundary)
    node, side = BoxTree(boxes).pairs(points[nodes])
    node = nodes[node]
    other = (boundary[side] != node[:, None]).all(axis=1)
    node, side = node[other], side[other]
    miss = points[node] - onto(sides[side], points[node])
    on = np.hypot(*miss.T) <= tolerance
    if on.any():
        first = int(np.argmax(on))
        raise InputError(
            f"The mesh has a hanging or duplicate node: {_name_node(points, int(node[first]))} lies on the side "
            f"with nodes {', '.join(map(str, boundary[side[first]]))} without belonging to it. Merge coincident nodes; "
            "elements must meet along whole sides."
        )


def check_overlap(points: Floats, boundary: Ints) -> None:
    """Check that the boundary of a connected mesh does not cross itself; elements overlap if and only if it does.

    Elements of equal orientation that meet along whole sides cover each point as often as the boundary winds around it.
    The boundary of a connected mesh that does not cross itself winds around each point at most once.
    """
    sides = points[boundary]
    i, j = BoxTree(maps.side_boxes(sides)).overlaps()
    disjoint = (boundary[i][:, :, None] != boundary[j][:, None, :]).all(axis=(1, 2))
    i, j = i[disjoint], j[disjoint]
    a, middle, b = np.moveaxis(sides, 1, 0)
    curved = np.hypot(*(0.5 * (a + b) - middle).T) > _STRAIGHT * np.hypot(*(b - a).T)
    either = curved[i] | curved[j]
    for pairs, count in ((np.flatnonzero(~either), 1), (np.flatnonzero(either), _CHORDS)):
        t = np.linspace(-1.0, 1.0, count + 1)[:, None, None]
        chains = 0.5 * t * (t - 1.0) * a + (1.0 - t * t) * middle + 0.5 * t * (t + 1.0) * b
        for start in range(0, len(pairs), _TOGETHER // count**2):
            block = pairs[start : start + _TOGETHER // count**2]
            first, second = chains[:, None, i[block]], chains[None, :, j[block]]
            begin, end = first[:-1], first[1:]
            part = _crossing(begin, end, second[:, :-1], second[:, 1:])
            if not np.isnan(part).all():
                chord, other_chord, pair = np.unravel_index(np.nanargmin(part), part.shape)
                place = begin[chord, 0, pair] + part[chord, other_chord, pair] * (end - begin)[chord, 0, pair]
                nodes = [", ".join(map(str, boundary[side[block[pair]]])) for side in (i, j)]
                raise InputError(
                    f"Elements of the mesh overlap: its boundary crosses itself at {point(place)}, where the side with "
                    f"nodes {nodes[0]} meets the side with nodes {nodes[1]}."
                )


def _crossing(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """Parameter in (0, 1) at which each segment a–b crosses the segment c–d, points (…, 2); NaN if it does not."""

    def turn(p: Floats, q: Floats, r: Floats) -> Floats:
        u, v = q - p, r - p
        return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

    begin, end = turn(c, d, a), turn(c, d, b)
    crossed = (turn(a, b, c) * turn(a, b, d) < 0.0) & (begin * end < 0.0)
    return np.asarray(np.where(crossed, begin / np.where(crossed, begin - end, 1.0), np.nan))


def check_one_piece(points: Floats, elements: Ints) -> None:
    """Check that all elements are connected through common sides."""
    element, side = np.nonzero(maps.real_sides(elements))
    midsides = elements[element, 4 + side]
    order = np.argsort(midsides, kind="stable")
    shared = np.flatnonzero(np.diff(midsides[order]) == 0)
    piece = components(len(elements), element[order[shared]], element[order[shared + 1]])
    if (count := int(piece.max()) + 1) > 1:
        names = [name_element(points, elements, int(np.argmax(piece == i))) for i in range(min(count, 3))]
        raise InputError(
            f"The mesh is in {count} pieces that share no side: {'; '.join(names)}{'; …' if count > 3 else ''}. "
            "Join the pieces, or make a model of each piece."
        )


def check_edge(name: str, triples: Ints, sides: Ints) -> None:
    """Check that the triples (k, 3) of a named edge are element sides with the plate on their left."""
    if triples.ndim != 2 or triples.shape[1] != 3 or not len(triples):
        raise InputError(f"Edge {name!r} must be node triples of shape (k, 3) with k ≥ 1; found {triples.shape}.")
    order = np.argsort(sides[:, 1], kind="stable")
    first = np.searchsorted(sides[:, 1], triples[:, 1], sorter=order)
    last = np.searchsorted(sides[:, 1], triples[:, 1], side="right", sorter=order) - 1
    matches = [(sides[order[np.clip(at, 0, len(order) - 1)]] == triples).all(axis=1) for at in (first, last)]
    wrong = ~(matches[0] | matches[1])
    if wrong.any():
        raise InputError(
            f"Edge {name!r} has nodes {', '.join(map(str, triples[np.argmax(wrong)]))}, which are not corner, "
            "midside and corner of an element's side with the plate on its left."
        )


def on_boundary(elements: Ints) -> Bools:
    """Mask (ne, 4) of the sides of elements (ne, 8) that belong to one element only."""
    midsides, real = elements[:, 4:], maps.real_sides(elements)
    return np.asarray((np.bincount(midsides[real], minlength=int(elements.max()) + 1)[midsides] == 1) & real)


def loops(sides: Ints) -> Ints:
    """Order boundary sides (k, 3) so that each loop is contiguous and starts at its lowest corner number."""
    outgoing: dict[int, list[int]] = {}
    for index in np.lexsort((sides[:, 2], sides[:, 0]))[::-1].tolist():
        outgoing.setdefault(int(sides[index, 0]), []).append(index)
    order: list[int] = []
    for start in sorted(outgoing):
        corner = start
        while outgoing.get(corner):
            index = outgoing[corner].pop()
            order.append(index)
            corner = int(sides[index, 2])
    return np.asarray(sides[order])
