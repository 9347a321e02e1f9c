"""Rigid supports that are near each other and not at one place: between them a plate's reactions have no bound."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from signorini.discretise.places import region
from signorini.discretise.quadrature.arcs import FullCircle, arcs_of_outline
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.errors import Place, path_in_words, point
from signorini.mesh import Mesh
from signorini.mesh.sides import Sides
from signorini.model import Model, OutlinedPlate, Support
from signorini.model.places import curve
from signorini.shapes import Region
from signorini.shapes.distances import Targets, edges_of
from signorini.shapes.outlines import Outline

_ALONG = 0.02
"""Slope of the distance between two lines up to which one runs along the other. Lines that meet or cross at more, which
is about a degree, are at one place there: they pry no more than parallel ones at the least distance."""
_OF_SIDE, _OF_CIRCLE, _MOST = 8, 64, 1000
"""Pieces of a side of a line and of a circle that are looked at, at least, and of either, about at most."""
_FEW = 300
"""Points up to which all pairs are looked at: a tree takes a while to be imported."""
_AT_ONE_PLACE = 8
"""Points that thinning may leave at one place: one in each cell around."""


class Near(NamedTuple):
    """A support near another one: where, how far, the least distance there, and what the other is, in words."""

    support: int
    place: Place
    at: Floats
    distance: float
    least: float
    other: str


@dataclass(frozen=True, eq=False)
class _Rigid:
    """What of a rigid support others may be near: its edges, its line, or the outline of what it covers."""

    index: int
    targets: Targets | Sides
    edges: Mapping[str, Targets | Sides]
    covers: Region | None = None

    def has(self, at: Floats) -> Bools:
        """Which places are within it."""
        return np.zeros(len(at), np.bool_) if self.covers is None else self.covers.contains(at)


_Places: TypeAlias = tuple[Floats, bool]


def too_near(model: Model, mesh: Mesh, rigid: Sequence[int], least: Floats) -> Iterator[Near]:
    """Pairs of rigid supports, by number, nearer than the least distance (ne,) of the element there, the first of each.

    Points are those of footprints too, by their middles, since these are what a plate turns about.
    """
    most = float(least.max())
    yield from _points(model, mesh, rigid, least)
    drawn = [_drawn(model, mesh, i, most) for i in rigid]
    lines = [one for one in drawn if one is not None]
    if not lines:
        return
    boxes = np.array([one.targets.bounds for one in lines]) + most * np.array([-1.0, -1.0, 1.0, 1.0])
    told = set[tuple[int, int]]()
    for index in rigid:
        support = model.support[index]
        for other in (lines[number] for number in _reached(support, boxes)):
            pair = min(index, other.index), max(index, other.index)
            if other.index == index or pair in told:
                continue
            for places, along in _looked_at(support, other.targets, most):
                if (near := _nearest(mesh, support, places, along, other, least)) is not None:
                    told.add(pair)
                    what = _name(model.support[other.index], other, near[0])
                    yield Near(index, ("support", index, support.place), *near, what)
                    break


def _points(model: Model, mesh: Mesh, rigid: Sequence[int], least: Floats) -> Iterator[Near]:
    """Points near other ones, the first of each two supports."""
    of = [(i, j) for i in rigid for j in range(len(model.support[i].at or ()))]
    if len(of) < 2:
        return
    at = np.array([place for i in rigid for place in model.support[i].at or ()])
    same = mesh.near.place
    # Any number of points may be at one place; of those one in each cell stands for all.
    _, first = np.unique(np.round((at - mesh.middle) / same), axis=0, return_index=True)
    first = np.sort(first)
    distance, neighbour = _neighbours(at[first], min(len(first), 2 + _AT_ONE_PLACE))
    limit = _limit(mesh, at[first], least)[:, None]
    one, rank = np.nonzero((distance > same) & (distance < limit))
    told = set[tuple[int, int]]()
    for number, column in zip(one.tolist(), rank.tolist(), strict=True):
        a, b = (int(first[k]) for k in (number, neighbour[number, column]))
        pair = min(of[a][0], of[b][0]), max(of[a][0], of[b][0])
        if pair not in told:
            told.add(pair)
            place, others = (("support", of[k][0], "at", of[k][1]) for k in (a, b))
            other = f"the point {point(at[b].tolist())} of {model.support[of[b][0]].name}, {path_in_words(others)}"
            yield Near(of[a][0], place, at[a], float(distance[number, column]), float(limit[number, 0]), other)


def _neighbours(at: Floats, count: int) -> tuple[Floats, Ints]:
    """Distances (n, count) to the nearest of points, themselves first, and their numbers."""
    if len(at) <= _FEW:
        apart = np.hypot(*np.moveaxis(at[:, None] - at, 2, 0))
        order = np.argsort(apart, axis=1)[:, :count]
        return np.take_along_axis(apart, order, axis=1), order
    from scipy.spatial import cKDTree

    distance, neighbour = cKDTree(at).query(at, k=count)
    return np.reshape(distance, (-1, count)), np.reshape(neighbour, (-1, count))


def _limit(mesh: Mesh, at: Floats, least: Floats) -> Floats:
    """The least distance (q,) at places (q, 2); off the plate there is none."""
    if (least == least[0]).all():
        return np.full(len(at), least[0])
    where = mesh.locate(at)
    return np.where(where.inside, least[where.elements], 0.0)


def _drawn(model: Model, mesh: Mesh, index: int, within: float) -> _Rigid | None:
    """The edges, line, circle or outline of an area that a support has."""
    support = model.support[index]
    if support.edge is not None:
        if isinstance(model.plate, OutlinedPlate):
            drawn = edges_of(model.plate.contours, set(support.edge))
            return _Rigid(index, Targets.join(list(drawn.values())), drawn)
        meshed = {name: Sides(mesh.points[mesh.edges[name]], within) for name in support.edge}
        return _Rigid(index, Sides(np.concatenate([one.nodes for one in meshed.values()]), within), meshed)
    outline = _outline(support)
    return None if outline is None else _Rigid(index, Targets.along(outline), {}, region(support.area))


def _name(support: Support, drawn: _Rigid, at: Floats) -> str:
    """What of a support is nearest to a place (2,)."""
    apart = {name: float(one.nearest(at[None])[1][0]) for name, one in drawn.edges.items()}
    what = f"{support.place} {min(apart, key=lambda name: apart[name], default='')}".rstrip()
    return f"the {what} of {support.name}, {path_in_words(('support', drawn.index, support.place))}"


def _reached(support: Support, boxes: Floats) -> list[int]:
    """Which of some boxes (k, 4) a support may reach; those on edges are looked at from the other side."""
    outline = _outline(support)
    if support.at is None and outline is None:
        return []
    x0, y0, x1, y1 = Targets.of(support.at or ()).bounds if outline is None else Targets.along(outline).bounds
    return np.flatnonzero(((boxes[:, :2] <= [x1, y1]) & (boxes[:, 2:] >= [x0, y0])).all(axis=1)).tolist()


def _outline(support: Support) -> Outline | None:
    """What the line or circle of a support is drawn with, or the outline of its area."""
    shape = curve(support) or region(support.area)
    return None if shape is None else shape.outline


def _looked_at(support: Support, beside: Targets | Sides, most: float) -> Iterator[_Places]:
    """Places of a support by themselves, such as points and ends; then those along its lines."""
    if support.at is not None:
        yield np.array(support.at), False
    if (outline := _outline(support)) is None:
        return
    yield np.concatenate([outline.segments.reshape(-1, 2), outline.arcs[:, ::2].reshape(-1, 2)]), False
    # A circle is nearest on the ray from its centre to the nearest place.
    to, far = beside.nearest(outline.circles[:, :2])
    some = (far > 0.0) & np.isfinite(far)
    x, y, radius = outline.circles[some].T
    centre = np.column_stack([x, y])
    yield centre + (to[some] - centre) * (radius / far[some])[:, None], False
    for arc in arcs_of_outline(outline):
        step = max(0.5 * most, arc.length / _MOST)
        count = max(_OF_CIRCLE if isinstance(arc, FullCircle) else _OF_SIDE, math.ceil(arc.length / step))
        yield arc.at(np.linspace(0.0, arc.length, count + 1))[0], True


def _nearest(
    mesh: Mesh, support: Support, at: Floats, along: bool, other: _Rigid, least: Floats
) -> tuple[Floats, float, float] | None:
    """The nearest of the places that are too near to another support and no part of it; how far, and the limit."""
    to, apart = other.targets.nearest(at)
    on = max(mesh.near.place, other.targets.off_arcs if isinstance(other.targets, Sides) else 0.0)
    near = (apart > on) & (apart < least.max())
    if along:
        near &= _runs_along(at, np.minimum(apart, 2.0 * float(least.max())))
    if not near.any():
        return None
    near &= apart < _limit(mesh, at, least)
    near &= ~other.has(at)
    covered = region(support.area)
    if covered is not None:
        near[near] &= ~covered.contains(to[near])
    if not near.any():
        return None
    chosen = int(np.where(near, apart, np.inf).argmin())
    return at[chosen], float(apart[chosen]), float(_limit(mesh, at[[chosen]], least)[0])


def _runs_along(places: Floats, apart: Floats) -> Bools:
    """Where a distance hardly changes from one place to the next, on both sides."""
    flat = np.abs(np.diff(apart)) <= _ALONG * np.hypot(*np.diff(places, axis=0).T)
    return np.asarray(np.append(flat, True) & np.insert(flat, 0, True))
