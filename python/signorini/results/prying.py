"""Rigid supports that all but touch, and pry the plate apart between them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

import numpy as np

from signorini.discretise import Discretisation
from signorini.discretise.placed import SAME_PLACE
from signorini.discretise.quadrature.arcs import arc_of
from signorini.discretise.rows import Bools, Floats
from signorini.discretise.touching import TOUCHING
from signorini.errors import point
from signorini.mesh.boxtree import BoxTree
from signorini.mesh.sides import Sides
from signorini.model import OutlinedPlate, Support
from signorini.model.curve import curve
from signorini.model.footprint import KEYS as FOOTPRINT
from signorini.shapes import Curve, Ring
from signorini.shapes.nearest import Targets, edges_of
from signorini.shapes.outlines import bounds_of

_ALONG = 0.2
"""Slope of the distance between two lines up to which one runs along the other: an angle of twelve degrees."""
_NEIGHBOURS = 0.1
"""Part of the thickness within which two points pry. What a plate does between them falls with the square of it."""
_OF_SIDE, _OF_CIRCLE, _MOST = 4, 64, 1000
"""Pieces of a side of a line and of a circle that are looked at, at least, and of either, about at most."""

_Holding: TypeAlias = tuple[str, Support, Targets | Sides]


def prying(found: Discretisation) -> Iterator[str]:
    """Rigid points, and rigid lines and circles, less than the thickness from an edge or line that is held rigidly."""
    model, mesh, thickness = found.model, found.mesh, float(found.thickness.max())
    rigid = [one for one in model.support if one.is_rigid and not one.given(FOOTPRINT)]
    if all(one.place in ("edge", "area") for one in rigid):
        return
    of_edges = _edges(found, {name for one in rigid for name in one.edge or ()}, thickness)
    holding: list[_Holding] = [(f"the edge {name}", one, of_edges[name]) for one in rigid for name in one.edge or ()]
    holding += [(f"the {one.place}", one, Targets.along([line])) for one in rigid if (line := curve(one)) is not None]
    boxes = np.array([those.bounds for *_, those in holding]).reshape(-1, 4)
    told = set[tuple[int, int]]()
    for support in (one for one in rigid if one.place not in ("edge", "area")):
        reached = (holding[at] for at in _reached(support, boxes, thickness))
        beside = [(what, other, those) for what, other, those in reached if other is not support]
        looked_at = _looked_at(support, [those for *_, those in beside], mesh.diameter, thickness)
        for what, other, those in beside:
            pair = min(id(support), id(other)), max(id(support), id(other))
            if pair in told or _let_go(support, other):
                continue
            if (at := _nearest(looked_at, those, thickness)) is not None:
                told.add(pair)
                yield _words(support, at[0], at[1], f"{what} that {other.name} holds, less than the thickness")
    points = [one for one in rigid if one.at is not None]
    yield from _pairs(points, SAME_PLACE * mesh.diameter, _NEIGHBOURS * thickness)


def _pairs(rigid: list[Support], least: float, most: float) -> Iterator[str]:
    """Points near another one, the first of each two supports."""
    points = np.array([at for one in rigid for at in one.at or ()]).reshape(-1, 2)
    if not len(points):
        return
    of = np.repeat(np.arange(len(rigid)), [len(one.at or ()) for one in rigid])
    one_of, others = BoxTree.build(np.tile(points, 2) + most * np.array([-1.0, -1.0, 1.0, 1.0])).pairs(points)
    apart = np.hypot(*(points[one_of] - points[others]).T)
    told = set[tuple[int, int]]()
    for one, other, far in zip(one_of.tolist(), others.tolist(), apart.tolist(), strict=True):
        first, second = int(of[one]), int(of[other])
        if one < other and least < far < most and (first, second) not in told:
            told.add((first, second))
            if not _let_go(rigid[first], rigid[second]):
                near = f"the point {point(points[other].tolist())} of {rigid[second].name}"
                what = f"{near}, less than a tenth of the thickness"
                yield _words(rigid[first], points[one], far, what)


def _words(support: Support, at: Floats, apart: float, what: str) -> str:
    return (
        f"{support.name} holds the plate rigidly at {point(at.tolist())}, {apart:.3g} from {what}: they pry "
        "against each other, and their reactions are not those of a plate. Leave it out, or give it a stiffness."
    )


def _let_go(one: Support, other: Support) -> bool:
    """Whether both hold one way, and the same: one of them then lets go."""
    return one.fix is None and other.fix is None and one.resists == other.resists in ("down", "up")


def _reached(support: Support, boxes: Floats, within: float) -> list[int]:
    """Which of some boxes (k, 4) the one around a support comes so near to."""
    along = curve(support)
    x0, y0, x1, y1 = bounds_of(support.at or ()) if along is None else along.bounds
    low, high = boxes[:, :2] - within, boxes[:, 2:] + within
    return np.flatnonzero(((low <= [x1, y1]) & (high >= [x0, y0])).all(axis=1)).tolist()


def _looked_at(
    support: Support, beside: Sequence[Targets | Sides], diameter: float, most: float
) -> list[tuple[Floats, Bools, bool]]:
    """Points and ends of a support, then points along its line; whether they are free, and whether along a line.

    What is on something else that holds the plate is part of that.
    """
    if not beside:
        return []
    along, drawn = curve(support), Targets.join([those for those in beside if isinstance(those, Targets)])
    places = [] if isinstance(along, Ring) else [np.array(support.at if along is None else along.points)]
    ends = len(places)
    places += [] if along is None else list(_pieces(along, most))
    found = []
    for number, at in enumerate(places):
        free = drawn.nearest(at)[1] > SAME_PLACE * diameter
        for those in (those for those in beside if isinstance(those, Sides)):
            # Sides of a mesh are parabolas where what runs along them is an arc.
            free &= those.nearest(at)[1] > TOUCHING * diameter
        if free.any():
            found.append((at, free, number >= ends))
    return found


def _nearest(
    looked_at: Sequence[tuple[Floats, Bools, bool]], those: Targets | Sides, most: float
) -> tuple[Floats, float] | None:
    """A point of a support that is near, and how far: at a point or an end, else where it runs along them."""
    for places, free, runs in looked_at:
        apart = those.nearest(places)[1]
        near = free & (apart < most)
        if runs:
            near &= _runs_along(places, np.minimum(apart, 2.0 * most))
        if near.any():
            chosen = int(np.where(near, apart, np.inf).argmin() if runs else near.argmax())
            return places[chosen], float(apart[chosen])
    return None


def _runs_along(places: Floats, apart: Floats) -> Bools:
    """Where a distance hardly changes from one place to the next, on both sides."""
    flat = np.abs(np.diff(apart)) <= _ALONG * np.hypot(*np.diff(places, axis=0).T)
    return np.asarray(np.append(flat, True) & np.insert(flat, 0, True))


def _pieces(line: Curve, step: float) -> Iterator[Floats]:
    """Points along each side of a line, or around a circle, about half a step apart."""
    step = max(0.5 * step, line.length / _MOST)
    if isinstance(line, Ring):
        count = max(_OF_CIRCLE, math.ceil(line.length / step))
        angle = np.linspace(0.0, math.tau, count + 1)
        yield line.center + line.radius * np.column_stack([np.cos(angle), np.sin(angle)])
        return
    for side in map(arc_of, line.sides):
        count = max(_OF_SIDE, math.ceil(side.length / step))
        yield side.at(np.linspace(0.0, side.length, count + 1))[0]


def _edges(found: Discretisation, names: set[str], within: float) -> Mapping[str, Targets | Sides]:
    """Edges as they are drawn; of a mesh from a file its sides, and how far from them it is looked."""
    if isinstance(found.model.plate, OutlinedPlate):
        return edges_of(found.model.plate.contours, names)
    mesh = found.mesh
    return {name: Sides(mesh.points[mesh.edges[name]], within) for name in names}
