"""Load paths on other meshes: half-widths of the t of every event, and of results at any t."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from signorini.analysis.twins.compared import Meshes, rounded
from signorini.analysis.twins.half_width import FASTEST_OF_POINTS, half_widths
from signorini.analysis.twins.leaves import acts_at_points
from signorini.analysis.twins.twins import Twins, compare, without
from signorini.base.progress import Watcher
from signorini.base.remade import Remade
from signorini.contact.problem import ContactProblem
from signorini.errors import SignoriniError
from signorini.results.estimate import Estimate, PathEstimate
from signorini.results.load_path import LoadPath
from signorini.results.path_events import PathEvent, crossings
from signorini.results.result import Result


@dataclass(frozen=True, eq=False, repr=False)
class PathTwins(Remade):
    """A load path on other meshes, followed when something is first asked of it.

    Parameters
    ----------
    twins : Twins
    follow : callable
        Follows the path of a problem.
    """

    twins: Twins
    follow: Callable[[ContactProblem, Watcher], LoadPath]

    @cached_property
    def paths(self) -> tuple[list[LoadPath], str]:
        """The paths, and why there is none."""
        return self.twins.others(self.follow, several=True)

    def estimate(self, path: LoadPath) -> PathEstimate:
        """Compare the events of a path: by support, what it does, of points where, and how often before.

        What another mesh has not, or moves by more than its t, has no half-width: a finer one need not have it.
        """
        others, warning = self.paths
        if not others:
            return PathEstimate(None, (None,) * len(path.support_events), (), (warning,))
        meshes = Meshes.of(path.mesh, [other.mesh for other in others], bool(warning))
        every = [next(one for one in (path, *others) if one.mesh is mesh) for mesh in meshes.every]
        own = list(_occurrences(path))
        t = [[_matching(event, count, path, one, meshes.reach) for event, count in own] for one in every]
        values = np.array(
            [[*row, path_.end if path_.ending == path.ending else np.nan] for row, path_ in zip(t, every, strict=True)]
        )
        none = np.full(values.shape[1], np.nan)
        # Two meshes that do the same while a third does not show no order.
        alike = meshes.fastest(acts_at_points(path.model))
        fastest = np.where(np.isnan(values).any(axis=0), np.minimum(alike, FASTEST_OF_POINTS), alike)
        size = np.abs(values[meshes.own])
        widths = half_widths(values, meshes.sizes, meshes.own, fastest, none, size, np.isnan(none))[0]
        widths[:-1] = np.maximum(widths[:-1], [_step(event, path) for event, _ in own])
        widths[:-1][widths[:-1] > size[:-1]] = np.nan
        *of_events, end = (rounded(width) for width in widths.tolist())
        # Where equilibrium ends the outlines of the supports say, and where the user asked to.
        # If nothing opens or closes any more it is any t beyond.
        ends = {"no_equilibrium": 0.0, "until": 0.0, "no_more_events": None}
        warnings = (warning,) if warning else ()
        return PathEstimate(ends.get(path.ending, end), tuple(of_events), meshes.elements, warnings)

    def estimate_at(self, t: float, result: Result) -> Estimate:
        """Compare a result at some t."""
        others, warning = self.paths
        found: list[Result] = []
        for other in others:
            try:
                found.append(other.at(t))
            except SignoriniError as error:
                warning = without(len(found), f"on another mesh: {error}")
                break
        return compare(result, found, warning) if found else Estimate(None, (), (warning,))


def _occurrences(path: LoadPath) -> Iterator[tuple[PathEvent, int]]:
    """Every event, and how often the same has happened before."""
    before: dict[tuple[object, ...], int] = {}
    for event in path.support_events:
        where = event.at if event.change in ("opens", "closes") else event.closed * (event.change == "part closed")
        same = event.support, event.change, event.opening, where
        yield event, before.get(same, 0)
        before[same] = before.get(same, 0) + 1


def _step(event: PathEvent, path: LoadPath) -> float:
    """How far from the t at which a quarter is passed the part of its support changes before and after, by a point."""
    if event.change != "part closed":
        return 0.0
    index = [support.name for support in path.model.support].index(event.support)
    parts = [stop.parts[index] for stop in path.stops]
    changes = [stop.t for stop, before, now in zip(path.stops[1:], parts[:-1], parts[1:], strict=True) if before != now]
    before = max((t for t in changes if t < event.t), default=0.0)
    after = min((t for t in changes if t > event.t), default=path.end)
    return max(event.t - before, after - event.t)


def _matching(event: PathEvent, count: int, own: LoadPath, path: LoadPath, reach: float) -> float:
    """The t at which the same happens on another mesh, of points at the nearest one; NaN where nothing like it does.

    Lines and areas must pass a part as often, and in the same directions, on both: to and fro tells of no one event.
    """
    if event.change not in ("opens", "closes"):
        index = [support.name for support in path.model.support].index(event.support)
        ours, theirs = (crossings(one.stops, index, event) for one in (own, path))
        if [opens for _, opens in ours] != [opens for _, opens in theirs]:
            return math.nan
        return theirs[ours.index((event.t, event.opening))][0]
    assert event.at is not None  # it is a point
    alike = [
        (math.dist(event.at, other.at), abs(times - count), other.t)
        for other, times in _occurrences(path)
        if other.at is not None and (other.support, other.change) == (event.support, event.change)
    ]
    distance, times, t = min(alike, default=(math.inf, 0, math.nan))
    return t if distance <= reach and times == 0 else math.nan
