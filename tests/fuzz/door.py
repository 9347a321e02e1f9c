"""Check refusals of models outside the domain: whether rigid supports are where the message says."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from signorini import InputError, Model
from signorini.model import MeshPlate, Support
from signorini.shapes.outlines import along_arc

Floats = npt.NDArray[np.float64]

_NEAR = re.compile(
    r"holds the plate rigidly at \[(\S+), (\S+)\], (\S+) from .*at least a tenth of the thickness apart, here (\S+)\. "
)
_SOFT = re.compile(r"alone holds the plate.* with kL⁴/D = (\S+); it must be (\S+) or more")
_MOVED = 3e-4
"""Tolerance for positions, relative to the plate's size: supports may be snapped, and messages round."""
_SAMPLES = 4000
"""Number of sample points along each side of a curve."""


def words_of_the_door(error: InputError) -> bool:
    """Whether every problem of a refusal is that the model is outside the domain."""
    return all(_NEAR.search(part.message) or _SOFT.search(part.message) for part in error.parts)


def wrongly_refused(model: Model, error: InputError) -> list[str]:
    """Errors in a refusal of a model outside the domain."""
    wrong = []
    for part in error.parts:
        if (near := _NEAR.search(part.message)) is not None:
            x, y, distance, least = (float(number) for number in near.groups())
            if not distance <= least * (1 + 1e-2) or not _are_near(model, part.path, np.array([x, y]), distance):
                wrong.append(f"refused inside the domain: {part}")
        elif (soft := _SOFT.search(part.message)) is not None:
            found, least = (float(number) for number in soft.groups())
            if found > least:
                wrong.append(f"refused inside the domain: {part}")
    return wrong


def _are_near(model: Model, path: tuple[str | int, ...], at: Floats, distance: float) -> bool:
    """Whether the named support is at a position, and another point or support within a distance of it."""
    drawn = [
        (index, samples)
        for index, support in enumerate(model.support)
        if support.holds_w
        for samples in _samples(model, support)
    ]
    extent = np.ptp(np.concatenate([samples for _, samples in drawn]), axis=0).max()
    slack = _MOVED * _extent(model, extent) + extent / _SAMPLES
    mine = [samples for index, samples in drawn if index == path[1]]
    others = [samples for samples in (those for _, those in drawn)]
    on = min(cKDTree(samples).query(at)[0] for samples in mine) <= slack
    reached = sum(len(cKDTree(samples).query_ball_point(at, 1.01 * distance + slack)) > 0 for samples in others)
    return bool(on and reached > 1)


def _extent(model: Model, least: float) -> float:
    if isinstance(model.plate, MeshPlate):
        return least
    return float(np.ptp(model.plate.outline.points(), axis=0).max())


def _samples(model: Model, support: Support) -> Iterator[Floats]:
    """Sample points of a support, one array for each point and each line."""
    t = np.linspace(0.0, 1.0, _SAMPLES)[:, None]
    if support.at is not None:
        yield from (np.array([at]) for at in support.at)
    elif support.edge is not None and not isinstance(model.plate, MeshPlate):
        for contour in model.plate.contours:
            for name in set(support.edge) & contour.edges.keys():
                points = contour.points(name)
                yield np.concatenate([a + t * (b - a) for a, b in pairwise(points)])
                if len(contour.edges[name]) == len(contour.sides):
                    yield points[-1] + t * (points[0] - points[-1])
    elif (shape := support.where.shape) is not None:
        drawn = shape.outline
        sides = [a + t * (b - a) for a, b in drawn.segments]
        sides += [np.concatenate([a + t[::40] * (b - a) for a, b in pairwise(along_arc(*arc))]) for arc in drawn.arcs]
        turn = 2.0 * np.pi * t
        sides += [
            np.array([x, y]) + r * np.column_stack([np.cos(turn), np.sin(turn)]) for x, y, r in drawn.circles.tolist()
        ]
        yield np.concatenate(sides)
