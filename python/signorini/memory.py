"""Memory: what a mesh will take, known before it is made, and what there is."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable
from pathlib import Path

from signorini.errors import InputError

_PER_DOF = 1050.0
"""Bytes of element matrices, assembled matrix and fields for a dof, measured on 15 to 520 thousand dofs."""

_PER_PAIR = 200.0
"""Bytes of condensed matrices and of Lemke's tableau for a pair of contact points, measured on 1600 and 3025 points."""

_PER_THREAD = 1.0e9
"""Address space that matrix products reserve for a thread, of which they use little."""

_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
_USES = ("/sys/fs/cgroup/memory.current", "/sys/fs/cgroup/memory/memory.usage_in_bytes")


def needed(elements: int) -> float:
    """Estimate the bytes that a plate of so many elements takes to be factored, within about a fifth.

    The factor's entries a dof grow with the logarithm of the number of dofs, as by nested dissection they must.

    Examples
    --------
    >>> round(needed(57_600) / 1e9, 1)
    1.4
    """
    dofs = 9.0 * elements
    entries = max(16.6 * math.log2(dofs) - 101.0, 50.0)
    return dofs * (8.0 * entries + _PER_DOF)


def needed_by_points(points: int) -> float:
    """Estimate the bytes that so many condensed contact points take, their complementarity problem with them.

    Examples
    --------
    >>> round(needed_by_points(6000) / 1e9, 1)
    7.2
    """
    return _PER_PAIR * points**2


def available() -> float:
    """Bytes that this process may still take; infinite where the system does not tell."""
    found = [math.inf]
    for line in _lines("/proc/meminfo"):
        if line.startswith("MemAvailable:"):
            found.append(1024.0 * float(line.split()[1]))
    for limit, use in zip(_LIMITS, _USES, strict=True):
        most, taken = _lines(limit), _lines(use)
        if most and taken and most[0].isdigit() and taken[0].isdigit():
            found.append(float(most[0]) - float(taken[0]))
    found.append(_address_space())
    return max(0.0, min(found))


def _address_space() -> float:
    """Bytes that ``ulimit -v`` leaves to this process."""
    if sys.platform != "linux":
        return math.inf
    import resource

    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return math.inf
    taken = sum(1024.0 * float(line.split()[1]) for line in _lines("/proc/self/status") if line.startswith("VmSize:"))
    threads = int(os.environ.get("RAYON_NUM_THREADS", 0)) or os.cpu_count() or 1
    return limit - taken - (threads + 1) * _PER_THREAD


def require_memory(elements: int, place: str) -> None:
    """Refuse a mesh that cannot fit, before the system ends the process for trying.

    Raises
    ------
    InputError
        If the plate would take more memory than there is; the message says how many elements fit.
    """
    _require(needed, elements, f"A mesh of {elements:,} elements", "Take larger elements.", place)


def require_memory_for_points(points: int, advice: str, place: str) -> None:
    """Refuse contact points whose condensed problem cannot fit, with advice.

    Raises
    ------
    InputError
        If it would take more memory than there is; the message says how many points fit.
    """
    _require(needed_by_points, points, f"The problem of {points:,} contact points that need condensing", advice, place)


def _require(taking: Callable[[int], float], count: int, what: str, advice: str, place: str) -> None:
    most, takes = available(), taking(count)
    if takes <= most:
        return
    fitting = count
    while fitting and taking(fitting) > most:
        fitting = int(0.95 * fitting)
    enough = f"enough for about {float(f'{fitting:.2g}'):,.0f}. {advice}" if fitting else "not enough for the least."
    raise InputError(
        f"{what} takes about {max(0.1, takes / 1e9):.1f} GB of memory; {most / 1e9:.1f} GB are free, {enough}",
        place=place,
    )


def _lines(path: str) -> list[str]:
    try:
        return Path(path).read_text("ascii").splitlines()
    except (OSError, ValueError):
        return []
