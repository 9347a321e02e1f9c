"""What a load path is held to beside its certificate: reactions that are told from rounding, and direct solutions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from signorini.certificate import certify, least_deflection
from signorini.discretise import CaseLoad, Discretisation
from signorini.path_stop import PathStop, path_stop, resultants
from signorini.problem import ContactProblem

_TOLD = 1e-6
"""Part of the largest resultant or reaction by which the reactions at a stop may miss the load's resultant."""
_SAME = 1e-6
"""Difference of deflections, over the largest, and of works, over the work, that is none."""
_ROUNDED = 1e-12
"""Part of the magnitudes that a sum is made of below which it is their rounding."""
_MOVED = 1e-9
"""Part of the magnitudes that a work is made of which the rounding of t brings where a plate moves on its own."""
_SAMPLES = 11
"""Parts of a path at whose ends it is compared with direct solutions."""


def told(found: Discretisation, loads: tuple[CaseLoad, CaseLoad], stop: PathStop) -> bool:
    """Whether the reactions at a stop balance the force and the moments of the load as such.

    A certificate measures balance by all that the load is made of. Of a load without a resultant, as a curvature, that
    may be so much more than what presses the plate on its supports that the reactions are nothing but its rounding.
    """
    parts = [resultants(found, load.nodal) for load in loads]
    for part, load in zip(parts, loads, strict=True):
        forces, *couples = np.abs(load.nodal.reshape(-1, 3)).sum(axis=0)
        part[np.abs(part) <= _ROUNDED * (forces + sum(couples) / found.mesh.size)] = 0.0
    wanted, size = parts[0] + stop.t * parts[1], np.abs(parts[0]).max() + stop.t * np.abs(parts[1]).max()
    if size == 0.0:
        return True
    missing = np.abs(stop.resultants - wanted).max()
    return bool(missing <= _TOLD * max(size, np.abs(stop.reactions).max(initial=0.0)))


def confirmed(problem: ContactProblem, loads: tuple[CaseLoad, CaseLoad], stops: Sequence[PathStop]) -> int:
    """How many stops, from the first, direct solutions confirm: at the first, the last and some between.

    Where one says otherwise the first that does so is searched for by halving.
    """
    last, agreed = len(stops) - 1, -1
    for k in sorted({round(i * last / _SAMPLES) for i in range(_SAMPLES + 1)} if stops else ()):
        if agrees(problem, loads, stops[k]):
            agreed = k
            continue
        wrong = k
        while wrong - agreed > 1:
            middle = (agreed + wrong) // 2
            if agrees(problem, loads, stops[middle]):
                agreed = middle
            else:
                wrong = middle
        return wrong
    return len(stops)


def agrees(problem: ContactProblem, loads: tuple[CaseLoad, CaseLoad], stop: PathStop) -> bool:
    """Whether a direct solution has the deflections of a stop or, where several solve it, the work.

    Where no direct solution is certified it says nothing against the stop, which is.
    """
    found, load = problem.discretisation, loads[0] + stop.t * loads[1]
    for attempt in problem.attempts():
        if attempt.part is not None or attempt.problem.method == "interior_point":
            continue
        answer = attempt.solve(load, lambda *now: None, None)
        if answer.status != "solved":
            continue
        if not certify(found, load, answer.hi, answer.lo, answer.reaction).passed:
            continue
        direct = path_stop(found, stop.t, load, stop.points[:0], stop.points[:0], answer)
        shown, wanted = (np.array([s.largest, s.smallest, *s.deflections]) for s in (stop, direct))
        apart = np.abs(shown - wanted).max() > _SAME * max(np.abs(wanted).max(), least_deflection(found, load))
        rounding = _MOVED * max(direct.work_size, stop.work_size)
        return not apart or abs(direct.work - stop.work) <= max(_SAME * abs(direct.work), rounding)
    return True
