"""What a mesh follows: arcs of borders and circles, and sizes of elements that leave room for borders and lines."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeAlias

import numpy as np

from signorini.discretise.rows import Bools, Floats
from signorini.shapes import Curve, Region
from signorini.shapes.extent import diameter
from signorini.shapes.outlines import Contour, Point, along_side, circle

Line: TypeAlias = Region | Curve

_AROUND = 12
"""Elements around a circle at least."""
_LEAST = 0.125
"""Part of the element size below which room is not made: so near things are seldom meant to be apart."""
_LEAST_BESIDE_LINES = 0.25
"""The same of lines: many small elements along them would cost more than following them brings."""
_FOLLOWED = 0.55 * _LEAST_BESIDE_LINES
"""Distance over the element size below which elements of the least size do not follow a line."""
_EVERY = 5
"""Degrees of the chords that arcs are drawn by here."""
_TOUCHING = 5e-4
"""Part of the plate's diameter by which things meet: such chords are up to so far off an arc."""


def arcs_of(border: Line) -> Iterator[tuple[float, ...]]:
    """Yield arcs, of circles their quarters, each by three points.

    Examples
    --------
    >>> from signorini.shapes import Circle
    >>> [round(x, 3) for x in next(arcs_of(Circle((0.0, 0.0), 1.0)))]
    [1.0, 0.0, 0.707, 0.707, 0.0, 1.0]
    """
    for x, y, radius in border.outline.circles.tolist():
        for begin, through, end in circle((x, y), radius, "").sides:
            assert through is not None  # a circle is of arcs
            yield (*begin, *through, *end)
    yield from (tuple(arc) for arc in border.outline.arcs.reshape(-1, 6).tolist())


def room(borders: Sequence[Line], contours: Sequence[Contour], size: float, lines: Sequence[Line] = ()) -> Floats:
    """Give straight pieces with sizes (k, 5) that let a mesh of elements of a size follow borders and lines.

    They are short sides and small circles of borders, and where a side, or a straight part of a line, is near to
    another one, or to one of the plate's contours, that it does not meet. Parts of one line are not asked for each
    other's sake, nor those that are nearer to something else than can be followed.

    Examples
    --------
    >>> from signorini.shapes import Polyline, Rectangle
    >>> from signorini.shapes.outlines import straight
    >>> plate = straight(((0, 0), (8, 0), (8, 6), (0, 6)), "abcd")
    >>> result = room([Rectangle(0.2, 2.0, 3.0, 4.0)], [plate], 0.5)
    >>> len(result), float(result[:, 4].min().round(3))
    (10, 0.2)
    >>> room([], [plate], 0.5, [Polyline(((4.0, 5.8), (4.4, 5.8)))]).round(3).tolist()
    [[4.0, 5.8, 4.2, 5.8, 0.2], [4.2, 5.8, 4.4, 5.8, 0.2]]
    """
    sides: list[tuple[Floats, int | None]] = [(side, None) for border in borders for side in _sides_of(border)]
    sides += [(side, number) for number, line in enumerate(lines) for side in line.outline.segments[:, None]]
    every = [*sides, *((side, -1) for contour in contours for side in _sides_around(contour))]
    boxes = np.array([[*side.min(axis=(0, 1)), *side.max(axis=(0, 1))] for side, _ in every]).reshape(-1, 4)
    touching = _TOUCHING * max(diameter(contour.points()) for contour in contours)
    outline = np.vstack([contour.points() for contour in contours])
    bounds = outline.min(axis=0) - size, outline.max(axis=0) + size
    result = [np.zeros((0, 5))]
    for (side, number), box in zip(sides, boxes, strict=False):
        length = float(np.hypot(*(side[:, 1] - side[:, 0]).T).sum())
        closed = bool((side[0, 0] == side[-1, 1]).all())
        own = np.inf if number is not None else length / _AROUND if closed else length
        pieces = _divided(_clipped(side, *bounds), 0.5 * size)
        apart = np.full(len(pieces), min(own, size))
        close = ((boxes[:, :2] <= box[2:] + size) & (boxes[:, 2:] >= box[:2] - size)).all(axis=1)
        for other, of in (every[at] for at in np.flatnonzero(close)):
            alike = other is side or (number is not None and of == number)
            if not alike and not _meet(side, other, touching):
                apart = np.minimum(apart, _distance(pieces.mean(axis=1), other))
        near = (apart < size) & ((number is None) | (apart > _FOLLOWED * size))
        sizes = np.maximum(apart[near], min((_LEAST if number is None else _LEAST_BESIDE_LINES) * size, own))
        result.append(np.column_stack([pieces[near].reshape(-1, 4), sizes]))
    return np.concatenate(result)


def _sides_of(border: Line) -> Iterator[Floats]:
    """Yield straight sides, and circles and arcs by their chords, (k, 2, 2)."""
    yield from border.outline.segments[:, None]
    for arc in border.outline.arcs.tolist():
        yield _chords(*arc)
    for x, y, radius in border.outline.circles.tolist():
        yield _joined(circle((x, y), radius, "").points()[::_EVERY])


def _sides_around(contour: Contour) -> Iterator[Floats]:
    """Yield the sides of a contour, arcs by their chords, (k, 2, 2)."""
    for side in contour.sides:
        yield _chords(*side)


def _chords(a: Point, through: Point | None, b: Point) -> Floats:
    along = np.vstack([along_side(a, through, b)[::_EVERY], b])
    return np.stack([along[:-1], along[1:]], axis=1)


def _joined(points: Floats) -> Floats:
    return np.stack([points, np.roll(points, -1, axis=0)], axis=1)


def _clipped(chords: Floats, low: Floats, high: Floats) -> Floats:
    """What of chords (k, 2, 2) is in a box (Liang and Barsky 1984): circles in another unit are kilometres long."""
    begin, along = chords[:, 0], chords[:, 1] - chords[:, 0]
    still = along == 0.0
    beside = (still & ((begin < low) | (begin > high))).any(axis=1)
    at = (np.stack([low, high])[:, None] - begin) / np.where(still, 1.0, along)
    enters = np.where(still, 0.0, at.min(axis=0)).max(axis=1).clip(0.0)
    leaves = np.where(still, 1.0, at.max(axis=0)).min(axis=1).clip(None, 1.0)
    ends = begin[:, None] + np.stack([enters, leaves], axis=1)[..., None] * along[:, None]
    # Those that are wholly in it stay as they are.
    ends = np.where(((enters == 0.0) & (leaves == 1.0))[:, None, None], chords, ends)
    return np.asarray(ends[~beside & (enters < leaves)])


def _divided(side: Floats, longest: float) -> Floats:
    """Pieces (q, 2, 2) of chords that are no longer."""
    parts = [np.zeros((0, 2, 2))]
    for a, b in side:
        # Rounding makes no further piece.
        count = max(1, int(np.ceil(np.hypot(*(b - a)) / longest - 1e-6)))
        stations = a + np.linspace(0.0, 1.0, count + 1)[:, None] * (b - a)
        parts.append(np.stack([stations[:-1], stations[1:]], axis=1))
    return np.concatenate(parts)


def _distance(points: Floats, chords: Floats) -> Floats:
    """Distance (q,) of points from the nearest chord (k, 2, 2)."""
    begin, along = chords[:, 0], chords[:, 1] - chords[:, 0]
    offset = points[:, None] - begin
    # A chord without length is its begin.
    square = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    share = np.clip((offset * along).sum(axis=2) / square, 0.0, 1.0)
    return np.asarray(np.hypot(*np.moveaxis(offset - share[..., None] * along, -1, 0)).min(axis=1))


def _meet(one: Floats, other: Floats, touching: float) -> bool:
    """Whether chords cross or touch others."""
    near = min(_distance(one.reshape(-1, 2), other).min(), _distance(other.reshape(-1, 2), one).min())
    return bool(near <= touching or _crossed(one, other).any())


def _crossed(one: Floats, other: Floats) -> Bools:
    (a, b), (c, d) = ((part[..., 0, :], part[..., 1, :]) for part in (one[:, None], other[None]))

    def turn(p: Floats, q: Floats, r: Floats) -> Floats:
        u, v = q - p, r - p
        return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

    return np.asarray((turn(a, b, c) * turn(a, b, d) < 0.0) & (turn(c, d, a) * turn(c, d, b) < 0.0))
