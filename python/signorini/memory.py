"""Memory: what a mesh will take, known before it is made, and what there is."""

from __future__ import annotations

import math
from pathlib import Path

from signorini.errors import InputError

_PER_DOF = 1050.0
"""Bytes of element matrices, assembled matrix and fields for a dof, measured on 15 to 520 thousand dofs."""

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
    return min(found)


def require_memory(elements: int, place: str) -> None:
    """Refuse a mesh that cannot fit, before the system ends the process for trying.

    Raises
    ------
    InputError
        If the plate would take more memory than there is; the message says how many elements fit.
    """
    most = available()
    if needed(elements) <= most:
        return
    fitting = elements
    while fitting > 1 and needed(fitting) > most:
        fitting = int(0.95 * fitting)
    raise InputError(
        f"A mesh of {elements:,} elements takes about {needed(elements) / 1e9:.1f} GB of memory; {most / 1e9:.1f} GB "
        f"are free, enough for about {float(f'{fitting:.2g}'):,.0f}. Take larger elements.",
        place=place,
    )


def _lines(path: str) -> list[str]:
    try:
        return Path(path).read_text("ascii").splitlines()
    except (OSError, ValueError):
        return []
