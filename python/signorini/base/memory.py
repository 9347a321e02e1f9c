"""Estimate the memory for solving a plate before its mesh is made, and compare it with the free memory."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from signorini.errors import InputError, Place

_PER_DOF = 1800.0
"""Bytes per dof of all data except the factor L of K: mesh, element matrices, fields, update matrices.

Slabs on tensionless soil took 1500 with 230 thousand dofs and 1000 with 3.7 million dofs. These slabs have congruent
elements; slabs without congruent elements take 300 more.
"""

_DISCRETISED = 1200.0
"""Bytes per dof on MPI rank 0 for mesh and arrays before K is factored; a slab of one million dofs took 1100."""

_MACHINES: ContextVar[int] = ContextVar("machines", default=1)

_PER_PAIR = 200.0
"""Bytes of condensed matrices and Lemke's tableau per pair of contact points, measured with 1600 and 3025 points."""

_PER_FOOTPRINT = 300.0
"""Memory of the rows of G of supports with footprints after forward substitution: bytes / (footprints · √dofs).

After forward substitution with the factor such a row has a few times √dofs nonzero columns. A plate of 900 footprints
and 232 thousand dofs needed 270 bytes / (footprints · √dofs).
"""

_PER_THREAD = 1.0e9
"""Bytes of address space that matrix products reserve per thread; they use only a small part of it."""

_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
_USES = ("/sys/fs/cgroup/memory.current", "/sys/fs/cgroup/memory/memory.usage_in_bytes")


@contextmanager
def over_machines(count: int) -> Iterator[None]:
    """Context in which ``count`` machines share the factor; `needed` then estimates the bytes on the first machine."""
    token = _MACHINES.set(count)
    try:
        yield
    finally:
        _MACHINES.reset(token)


def needed(elements: int) -> float:
    """Estimate the bytes of memory for solving a plate of ``elements`` elements; up to a third too large.

    The number of factor entries per dof grows with the logarithm of the number of dofs, as for nested dissection.

    Examples
    --------
    >>> round(needed(57_600) / 1e9, 1)
    1.8
    """
    dofs = 9.0 * elements
    entries = max(15.7 * math.log2(dofs) - 100.0, 50.0)
    return dofs * max((8.0 * entries + _PER_DOF) / _MACHINES.get(), _DISCRETISED)


def needed_by_points(points: int) -> float:
    """Estimate the bytes for condensing the plate onto ``points`` contact points and solving the LCP.

    Examples
    --------
    >>> round(needed_by_points(6000) / 1e9, 1)
    7.2
    """
    return _PER_PAIR * points**2


def fits(bytes_needed: float) -> bool:
    """Whether this process can still allocate ``bytes_needed`` bytes of memory."""
    return bytes_needed <= available()


def available() -> float:
    """Bytes that this process can still allocate; infinite if the system does not report them."""
    limits = [math.inf]
    for line in _lines("/proc/meminfo"):
        if line.startswith("MemAvailable:"):
            limits.append(1024.0 * float(line.split()[1]))
    for limit, use in zip(_LIMITS, _USES, strict=True):
        most, used = _lines(limit), _lines(use)
        if most and used and most[0].isdigit() and used[0].isdigit():
            limits.append(float(most[0]) - float(used[0]))
    limits.append(_address_space())
    return max(0.0, min(limits))


def _address_space() -> float:
    """Bytes of address space that this process may still reserve under ``ulimit -v``."""
    if sys.platform != "linux":
        return math.inf
    import resource

    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return math.inf
    used = sum(1024.0 * float(line.split()[1]) for line in _lines("/proc/self/status") if line.startswith("VmSize:"))
    threads = int(os.environ.get("RAYON_NUM_THREADS", 0)) or os.cpu_count() or 1
    return limit - used - (threads + 1) * _PER_THREAD


def elements_that_fit(most: int) -> int:
    """Estimate the largest number of elements, at most ``most``, that fits into memory; rounded to two digits."""
    return int(float(f"{_fitting(needed, most, available()):.2g}"))


def require_memory(elements: int, place: Place) -> None:
    """Raise an InputError if the solution of a mesh does not fit into memory, before the system kills the process."""
    _require(needed, elements, f"A mesh of {elements:,} elements", "Use larger elements.", place)


def require_memory_for_points(points: int, advice: str, place: Place) -> None:
    """Raise an InputError if the problem condensed onto ``points`` contact points does not fit into memory."""
    _require(needed_by_points, points, f"The problem of {points:,} contact points that need condensing", advice, place)


def needed_by_footprints(footprints: int, dofs: int) -> float:
    """Estimate the bytes of the rows of ``footprints`` footprints, forward-substituted in a factor of ``dofs`` dofs.

    Examples
    --------
    >>> round(needed_by_footprints(900, 232_000) / 1e6)
    130
    """
    return _PER_FOOTPRINT * footprints * math.sqrt(dofs)


def require_memory_for_footprints(footprints: int, dofs: int, place: Place) -> None:
    """Raise an InputError if the rows of supports with footprints do not fit into memory."""
    subject = f"The problem of {footprints:,} supports with footprints"
    _require(lambda count: needed_by_footprints(count, dofs), footprints, subject, "Use fewer footprints.", place)


def _require(estimate: Callable[[int], float], count: int, subject: str, advice: str, place: Place) -> None:
    free, required = available(), estimate(count)
    if required <= free:
        return
    fitting = _fitting(estimate, count, free)
    enough = f"enough for about {float(f'{fitting:.2g}'):,.0f}. {advice}" if fitting else "too little for any number."
    raise InputError(
        f"{subject} takes about {max(0.1, required / 1e9):.1f} GB of memory; {free / 1e9:.1f} GB are free, {enough}",
        place=place,
    )


def _fitting(estimate: Callable[[int], float], count: int, memory: float) -> int:
    while count and estimate(count) > memory:
        count = int(0.95 * count)
    return count


def _lines(path: str) -> list[str]:
    try:
        return Path(path).read_text("ascii").splitlines()
    except (OSError, ValueError):
        return []
