"""The nearest places of points, straight sides and arcs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from signorini.shapes.contours import Contour, arc_through
from signorini.shapes.outlines import Box, Outline, Point, Side, bounds_of

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Targets:
    """Points (c, 2), straight sides (k, 2, 2), and arcs (m, 5): x and y of the centre, radius, begin and turn.

    Examples
    --------
    >>> half = Targets.of(sides=[((-2.0, 0.0), (2.0, 0.0))], arcs=[(0.0, 0.0, 2.0, 0.0, math.pi)])
    >>> places, apart = half.nearest(np.array([[0.0, 1.5], [1.0, -1.0]]))
    >>> places.round(12).tolist(), apart.tolist()
    ([[0.0, 2.0], [1.0, 0.0]], [0.5, 1.0])
    """

    points: Floats
    sides: Floats
    arcs: Floats

    @classmethod
    def of(
        cls,
        points: Iterable[Point] = (),
        sides: Iterable[tuple[Point, Point]] = (),
        arcs: Iterable[Sequence[float]] = (),
    ) -> Targets:
        """Gather them."""
        shaped = ((points, (-1, 2)), (sides, (-1, 2, 2)), (arcs, (-1, 5)))
        return cls(*(np.array([*those], dtype=float).reshape(shape) for those, shape in shaped))

    @classmethod
    def along(cls, outline: Outline) -> Targets:
        """Gather what an outline is drawn with."""
        straight, arcs = [(a, b) for a, b in outline.segments.tolist()], list[tuple[float, ...]]()
        _sort(((a, m, b) for a, m, b in outline.arcs.tolist()), straight, arcs)
        return cls.of((), straight, arcs + [(*ring, 0.0, math.tau) for ring in outline.circles.tolist()])

    @classmethod
    def join(cls, several: Sequence[Targets]) -> Targets:
        """Take several as one."""
        none = cls.of()
        return cls(*(np.concatenate([getattr(one, key) for one in (none, *several)]) for key in vars(none)))

    @property
    def bounds(self) -> Box:
        """A box xmin, ymin, xmax, ymax around them, and around the whole circles of arcs."""
        x, y, radius, _, _ = self.arcs.T
        whole = np.concatenate([np.column_stack([x - radius, y - radius]), np.column_stack([x + radius, y + radius])])
        return bounds_of(np.concatenate([self.points, self.sides.reshape(-1, 2), whole]).tolist())

    def nearest(self, at: Floats) -> tuple[Floats, Floats]:
        """The nearest places (q, 2) of these to some (q, 2), and how far they are."""
        places = [np.broadcast_to(self.points, (len(at), *self.points.shape))]
        begin, along = self.sides[:, 0], self.sides[:, 1] - self.sides[:, 0]
        part = ((at[:, None] - begin) * along).sum(axis=2) / (along**2).sum(axis=1)
        places.append(begin + np.clip(part, 0.0, 1.0)[..., None] * along)
        x, y, radius, start, sweep = self.arcs.T
        angle = np.arctan2(at[:, 1, None] - y, at[:, 0, None] - x)
        turned = np.mod(np.sign(sweep) * (angle - start), math.tau)
        over = turned > np.abs(sweep)
        angle = np.where(over, np.where(turned - np.abs(sweep) < math.tau - turned, start + sweep, start), angle)
        places.append(np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=2))
        result = np.concatenate(places, axis=1)
        if not result.shape[1]:
            return at, np.full(len(at), np.inf)
        apart = np.hypot(*np.moveaxis(result - at[:, None], 2, 0))
        least = apart.argmin(axis=1)
        each = np.arange(len(at))
        return result[each, least], apart[each, least]


def sides_of(
    contours: Iterable[Contour], names: set[str] | None = None
) -> tuple[list[tuple[Point, Point]], list[tuple[float, ...]]]:
    """The straight sides and the arcs of contours, all or those of some edges, as `Targets.of` takes them."""
    straight, arcs = list[tuple[Point, Point]](), list[tuple[float, ...]]()
    for contour in contours:
        wanted = {side for name, sides in contour.edges.items() if names is None or name in names for side in sides}
        _sort((contour.sides[side] for side in sorted(wanted)), straight, arcs)
    return straight, arcs


def edges_of(contours: Iterable[Contour], names: set[str]) -> dict[str, Targets]:
    """Some edges of contours, each with its sides."""
    result = dict[str, tuple[list[tuple[Point, Point]], list[tuple[float, ...]]]]()
    for contour in contours:
        for name, sides in contour.edges.items():
            if name in names:
                _sort((contour.sides[side] for side in sides), *result.setdefault(name, ([], [])))
    return {name: Targets.of((), *sides) for name, sides in result.items()}


def _sort(sides: Iterable[Side], straight: list[tuple[Point, Point]], arcs: list[tuple[float, ...]]) -> None:
    """Add sides to those that are straight, or to the arcs."""
    for begin, through, end in sides:
        arc = None if through is None else arc_through(begin, through, end)
        if arc is None:
            straight.append((begin, end))
        else:
            arcs.append((*arc[0].tolist(), *arc[1:]))
