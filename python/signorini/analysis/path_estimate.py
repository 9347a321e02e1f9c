"""Load paths on coarser meshes: half-widths of the t of named events and thresholds."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from signorini.accuracy.comparison import Meshes, known
from signorini.accuracy.estimate import PathEstimate
from signorini.accuracy.half_width import FASTEST_OF_POINTS, half_widths, rounded
from signorini.accuracy.sizes import acts_at_points
from signorini.analysis.other_meshes import OtherMeshes
from signorini.analysis.path_loads import PathLoads
from signorini.analysis.path_root import LINEAR, SMOOTH, root
from signorini.analysis.sampler import Sampler, State, Watch
from signorini.base.progress import Watcher
from signorini.contact.problem import ContactProblem
from signorini.errors import SignoriniError
from signorini.mesh import Mesh
from signorini.results.exact_path import ExactPath
from signorini.results.load_path import AT_LIMIT, LoadPath
from signorini.results.path_events import Threshold

_NEAR = 0.02
"""Part of the path's length about an event within which a coarser mesh is first searched for it."""
_FARTHER = 4.0
"""Ratio of such distances."""


def estimate_asked(path: LoadPath, watcher: Watcher = lambda now: None) -> PathEstimate | None:
    """Estimate a path if its model asks for it and it can be."""
    return estimate_path(path, watcher) if path.model.estimated and _has_estimate(path) else None


def _has_estimate(path: LoadPath) -> bool:
    """Not one that follows every contact point, nor one that was cut short."""
    return not (isinstance(path, ExactPath) or path.interrupted)


def estimate_path(path: LoadPath, watcher: Watcher) -> PathEstimate:
    """Find the events of a path on coarser meshes; what one of them does not do near them has no half-width."""
    asked = [(Watch(None, number), one.t, _falls(path, one)) for number, one in enumerate(path.thresholds) if one.t]
    names = [support.name for support in path.model.support]
    watches = [
        (Watch(names.index(event.support), event.number), event.t, event.opening) for event in path.support_events
    ]
    count, wanted = len(watches), len(path.thresholds)
    if not _has_estimate(path):
        return PathEstimate.nothing(count, wanted)

    def found(problem: ContactProblem, watch: Watcher) -> tuple[Mesh, list[float]]:
        sampler = Sampler(problem, PathLoads.of(problem, path.start, path.add), path.thresholds, watch)
        return problem.mesh, _same_events(sampler, [*watches, *asked], path.stops[-1].t)

    others, warning = OtherMeshes(path.model, path.mesh, watcher).solved_on_coarser(found)
    if not others:
        return PathEstimate.nothing(count, wanted, (warning,))
    meshes = Meshes.of(path.mesh, [mesh for mesh, _ in others], bool(warning))
    own = [t for _, t, _ in [*watches, *asked]]
    of = [(path.mesh, own), *others]
    values = np.array([next(t for mesh, t in of if mesh is one) for one in meshes.every]).reshape(len(of), -1)
    none = np.full(values.shape[1], np.nan)
    # Two meshes that do the same while a third does not show no order.
    alike = meshes.fastest(acts_at_points(path.model))
    fastest = np.where(np.isnan(values).any(axis=0), np.minimum(alike, FASTEST_OF_POINTS), alike)
    size = np.abs(values[meshes.own])
    widths = half_widths(values, meshes.sizes, meshes.own, fastest, none, size, np.isnan(none))[0]
    sampler = Sampler(path.problem, PathLoads((path.start, path.add), path._loads, (0, 0)), path.thresholds, _quiet)
    known_to = [LINEAR if sampler.exact(watch) else SMOOTH for watch, _, _ in [*watches, *asked]]
    widths = np.fmax(widths, np.where(np.isnan(widths), np.nan, np.array(known_to) * path.stops[-1].t))
    widths[widths > size] = np.nan
    found_widths = [known(width) for width in rounded(widths).tolist()]
    of_asked = iter(found_widths[count:])
    of_thresholds = tuple(next(of_asked) if one.t else None for one in path.thresholds)
    # Where equilibrium ends the outlines of the supports say, and where the user asked to.
    end = 0.0 if path.ending in ("no_equilibrium", "until") else None
    warnings = (warning,) if warning else ()
    return PathEstimate(end, tuple(found_widths[:count]), of_thresholds, meshes.elements, warnings)


def _quiet(now: object) -> None:
    """Watch nothing."""


def _falls(path: LoadPath, one: Threshold) -> bool:
    """Whether a quantity comes down to the value of a threshold."""
    row = next(row for row, stop in enumerate(path.stops) if stop.t == one.t)
    return path.stops[row - 1].number(one.quantity) >= one.value


def _same_events(sampler: Sampler, wanted: Sequence[tuple[Watch, float, bool]], span: float) -> list[float]:
    """The t near those given at which functions change their signs likewise; NaN where they do not.

    A function falls below zero, as where something opens, or comes up to it.
    """
    state = sampler.state(0.0)
    result = [math.nan] * len(wanted)
    for number in sorted(range(len(wanted)), key=lambda number: wanted[number][1]):
        watch, t, falls = wanted[number]
        try:
            state = _same_event(sampler, state, watch, t, falls, span)
        except SignoriniError:
            continue
        result[number] = state.t
    return result


def _same_event(sampler: Sampler, near: State, watch: Watch, t: float, falls: bool, span: float) -> State:
    """Search on the side of t where it must be, farther and farther off."""
    end = sampler.path.end * (1 - AT_LIMIT)
    state = sampler.state(min(t, end), near)
    beyond = (sampler.value(state, watch) >= 0) != falls
    distance, known = min(_NEAR * span, t / _FARTHER), [state]
    while distance <= t:
        last = known[0].t <= 0 if beyond else known[-1].t >= end
        if last:
            break
        next_t = max(t - distance, 0.0) if beyond else min(t + distance, end)
        other = sampler.state(next_t, known[0 if beyond else -1])
        known.insert(0 if beyond else len(known), other)
        if ((sampler.value(other, watch) >= 0) == falls) == beyond:
            return root(sampler, watch, known, known[0].t, span)
        distance *= _FARTHER
    raise SignoriniError("it does not happen on this mesh.")
