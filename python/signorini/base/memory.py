"""Memory: estimates for a mesh before it is made, and the free memory."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable
from pathlib import Path

from signorini.errors import InputError, Place

_PER_DOF = 1800.0
"""Bytes per dof of mesh, element matrices, fields and update matrices. Slabs on tensionless soil took 1500 beside L on
230 thousand dofs and 1000 on 3.7 million with congruent elements; without congruent elements they take 300 more."""

_PER_PAIR = 200.0
"""Bytes of condensed matrices and of Lemke's tableau for a pair of contact points, measured on 1600 and 3025 points."""

_PER_FOOTPRINT = 300.0
"""Bytes of the row of a footprint after forward substitution, over the root of the number of dofs: it reaches a few
times that number of columns. 900 on 232 thousand dofs took 270."""

_PER_THREAD = 1.0e9
"""Address space that matrix products reserve for a thread, of which they use little."""

_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
_USES = ("/sys/fs/cgroup/memory.current", "/sys/fs/cgroup/memory/memory.usage_in_bytes")


def needed(elements: int) -> float:
    """Estimate the bytes that the solution of a plate of so many elements takes, up to a third too many.

    The entries of the factor per dof grow with the logarithm of the number of dofs, as for nested dissection.

    Examples
    --------
    >>> round(needed(57_600) / 1e9, 1)
    1.8
    """
    dofs = 9.0 * elements
    entries = max(15.7 * math.log2(dofs) - 100.0, 50.0)
    return dofs * (8.0 * entries + _PER_DOF)


def needed_by_points(points: int) -> float:
    """Estimate the bytes of so many condensed contact points, with their complementarity problem.

    Examples
    --------
    >>> round(needed_by_points(6000) / 1e9, 1)
    7.2
    """
    return _PER_PAIR * points**2


def fits(bytes_needed: float) -> bool:
    """Whether so much memory is free."""
    return bytes_needed <= available()


def available() -> float:
    """Bytes that this process may still take; infinite where the system does not tell."""
    result = [math.inf]
    for line in _lines("/proc/meminfo"):
        if line.startswith("MemAvailable:"):
            result.append(1024.0 * float(line.split()[1]))
    for limit, use in zip(_LIMITS, _USES, strict=True):
        most, taken = _lines(limit), _lines(use)
        if most and taken and most[0].isdigit() and taken[0].isdigit():
            result.append(float(most[0]) - float(taken[0]))
    result.append(_address_space())
    return max(0.0, min(result))


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


def elements_that_fit(most: int) -> int:
    """Estimate the largest number of elements, up to a given one, that fits into memory, to two digits."""
    return int(float(f"{_fitting(needed, most, available()):.2g}"))


def require_memory(elements: int, place: Place) -> None:
    """Refuse a mesh that cannot fit, before the system ends the process for trying."""
    _require(needed, elements, f"A mesh of {elements:,} elements", "Take larger elements.", place)


def require_memory_for_points(points: int, advice: str, place: Place) -> None:
    """Refuse contact points whose condensed problem cannot fit, with advice."""
    _require(needed_by_points, points, f"The problem of {points:,} contact points that need condensing", advice, place)


def needed_by_footprints(footprints: int, dofs: int) -> float:
    """Estimate the bytes of the rows of so many footprints beside the factor of so many dofs.

    Examples
    --------
    >>> round(needed_by_footprints(900, 232_000) / 1e6)
    130
    """
    return _PER_FOOTPRINT * footprints * math.sqrt(dofs)


def require_memory_for_footprints(footprints: int, dofs: int, place: Place) -> None:
    """Refuse footprints that cannot fit."""
    what = f"The problem of {footprints:,} supports with footprints"
    _require(lambda count: needed_by_footprints(count, dofs), footprints, what, "Take fewer of them.", place)


def _require(taking: Callable[[int], float], count: int, what: str, advice: str, place: Place) -> None:
    most, takes = available(), taking(count)
    if takes <= most:
        return
    fitting = _fitting(taking, count, most)
    enough = f"enough for about {float(f'{fitting:.2g}'):,.0f}. {advice}" if fitting else "not enough for the least."
    raise InputError(
        f"{what} takes about {max(0.1, takes / 1e9):.1f} GB of memory; {most / 1e9:.1f} GB are free, {enough}",
        place=place,
    )


def _fitting(taking: Callable[[int], float], count: int, memory: float) -> int:
    while count and taking(count) > memory:
        count = int(0.95 * count)
    return count


def _lines(path: str) -> list[str]:
    try:
        return Path(path).read_text("ascii").splitlines()
    except (OSError, ValueError):
        return []
