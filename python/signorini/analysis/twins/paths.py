"""Load paths on other meshes: half-widths of the t of every event, and of results at any t."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from signorini.analysis.twins.compared import Meshes, rounded
from signorini.analysis.twins.half_width import FASTEST, FASTEST_OF_POINTS, half_widths
from signorini.analysis.twins.leaves import acts_at_points
from signorini.analysis.twins.twins import Twins, compare
from signorini.base.progress import Watcher
from signorini.base.remade import Remade
from signorini.contact.problem import ContactProblem
from signorini.errors import SignoriniError
from signorini.results.estimate import Estimate, PathEstimate
from signorini.results.load_path import LoadPath
from signorini.results.path_stop import Switch
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
        """Compare the events of a path: by support, what opens or closes, place, and how often before."""
        others, warning = self.paths
        if not others:
            return PathEstimate(None, ((),) * len(path.stops), (), (warning,))
        meshes = Meshes.of(path.mesh, [other.mesh for other in others])
        every = [next(one for one in (path, *others) if one.mesh is mesh) for mesh in meshes.every]
        switched = [list(_occurrences(one)) for one in every]
        own = switched[meshes.own]
        t = [[_matching(one, found, meshes.reach) for one in own] for found in switched]
        values = np.array(
            [[*row, path_.end if path_.ending == path.ending else np.nan] for row, path_ in zip(t, every, strict=True)]
        )
        none = np.zeros(values.shape[1])
        fastest = FASTEST_OF_POINTS if acts_at_points(path.model) else FASTEST
        size = np.abs(values[meshes.own])
        widths = half_widths(values, meshes.sizes, meshes.own, fastest, none, size, none == 0)[0]
        *of_events, end = (rounded(width) for width in widths.tolist())
        left = iter(of_events)
        stops = tuple(tuple(next(left) for _ in stop.switched) for stop in path.stops)
        # Where equilibrium ends the outlines of the supports say, and where the user asked to.
        exact = path.ending in ("no_equilibrium", "until")
        return PathEstimate(0.0 if exact else end, stops, meshes.elements, ())

    def estimate_at(self, t: float, result: Result) -> Estimate:
        """Compare a result at some t."""
        others, warning = self.paths
        found: list[Result] = []
        for other in others:
            try:
                found.append(other.at(t))
            except SignoriniError as error:
                warning = f"No half-width (±) says how far the mesh is from the plate; on another mesh: {error}"
                break
        return compare(result, found) if found else Estimate(None, (), (warning,))


def _occurrences(path: LoadPath) -> Iterator[tuple[Switch, int, float]]:
    """Every point that opens or closes, how often it has done so before, and its t."""
    before: dict[Switch, int] = {}
    for stop in path.stops:
        for switch in stop.switched:
            yield switch, before.get(switch, 0), stop.t
            before[switch] = before.get(switch, 0) + 1


def _matching(one: tuple[Switch, int, float], found: list[tuple[Switch, int, float]], reach: float) -> float:
    """The t at which the same happens on another mesh, at the nearest point; NaN where nothing like it does."""
    switch, count, _ = one
    alike = [
        (math.dist(switch.at, other.at), abs(times - count), t)
        for other, times, t in found
        if (other.support, other.closes) == (switch.support, switch.closes)
    ]
    distance, times, t = min(alike, default=(math.inf, 0, math.nan))
    return t if distance <= reach and times == 0 else math.nan
