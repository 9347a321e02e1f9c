"""Executors that solve the variants of a study: local processes, or the workers of a Dask scheduler."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from signorini.base.packages import package
from signorini.errors import InputError
from signorini.plot.artist import cores
from signorini.studies.workers import Workers

_SECONDS = 30
"""Seconds within which a Dask scheduler must answer."""


@contextmanager
def solvers(workers: int | None = None, scheduler: str | None = None) -> Iterator[Executor]:
    """Context with an executor: ``workers`` local processes, or all workers of the Dask scheduler at an address.

    Raises
    ------
    InputError
        If both are given, or no scheduler answers at the address.
    SignoriniError
        If ``distributed`` is not installed.
    """
    if scheduler is None:
        with Workers(workers or cores()) as local:
            yield local
        return
    if workers is not None:
        raise InputError(
            "give either --workers or --scheduler; a scheduler has its own workers.",
            "scheduler",
        )
    try:
        client = package("distributed").Client(scheduler, timeout=_SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(f"no Dask scheduler answers at {scheduler}: {error}.", "scheduler") from None
    with client:
        yield client.get_executor(pure=False)
