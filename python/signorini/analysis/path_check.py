"""What a load path is held to beside its certificate: direct solutions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from signorini.base.progress import Progress, Watcher
from signorini.contact.certificate import least_deflection
from signorini.contact.problem import ContactProblem
from signorini.contact.strategy import answered
from signorini.discretise import CaseLoad
from signorini.results.load_path import beside
from signorini.results.path_stop import PathStop, path_stops

_SAME = 1e-6
"""Difference of deflections, over the largest, and of works, over the work, that is none."""
_MOVED = 1e-9
"""Part of the magnitudes that a work is made of which the rounding of t brings where a plate moves on its own."""
_AT = 1e-12
"""Rounding of the t of an event, over t: as much of the loads that are added is there where their sum vanishes."""
_SAMPLES = 11
"""Parts of a path at whose ends it is compared with direct solutions."""


def confirmed(
    problem: ContactProblem, loads: tuple[CaseLoad, CaseLoad], stops: Sequence[PathStop], watcher: Watcher
) -> int:
    """How many stops, from the first, direct solutions confirm: at the first, the last and some between.

    Where one says otherwise the first that does so is searched for by halving.
    """
    last, agreed = len(stops) - 1, -1
    for k in sorted({round(i * last / _SAMPLES) for i in range(_SAMPLES + 1)} if stops else ()):
        if agrees(problem, loads, stops[k], watcher):
            agreed = k
            continue
        wrong = k
        while wrong - agreed > 1:
            middle = (agreed + wrong) // 2
            if agrees(problem, loads, stops[middle], watcher):
                agreed = middle
            else:
                wrong = middle
        return wrong
    return len(stops)


def agrees(problem: ContactProblem, loads: tuple[CaseLoad, CaseLoad], stop: PathStop, watcher: Watcher) -> bool:
    """Whether a direct solution has the deflections of a stop or, where several solve it, the work.

    Where no direct solution is certified it says nothing against the stop, which is.
    """
    result, load = problem.discretisation, loads[0] + stop.t * loads[1]

    def steps(method: str, step: int, changing: int, residual: float) -> None:
        watcher(Progress(f"t = {stop.t:.6g}, solved anew", step, changing, residual, method=method))

    tried = answered(problem, load, steps)
    if not tried.passed:
        return True
    none = [stop.points[:0]]
    (direct,) = path_stops(result, [stop.t], [load], none, none, [tried.answer])
    shown, wanted = (np.array([s.largest, s.smallest, *s.deflections]) for s in (stop, direct))
    apart = np.abs(shown - wanted).max() > _SAME * max(np.abs(wanted).max(), least_deflection(result, load))
    parts = sum(float(np.abs(part.nodal).max()) for part in beside(loads, stop.t))
    size = float(np.abs(load.nodal).max())
    rounding = max(_MOVED * size, _AT * parts) * max(direct.work_size, stop.work_size)
    return not apart or size * abs(direct.work - stop.work) <= max(size * _SAME * abs(direct.work), rounding)
