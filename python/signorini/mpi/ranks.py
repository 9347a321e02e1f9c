"""The ranks: rank 0 sends every rank its part of a job, all work on it together, and rank 0 gets the results."""

from __future__ import annotations

import os
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from signorini.errors import SignoriniError

_WAIT = 0.005
"""Seconds between two checks for the next job. MPI itself waits at full load, which would slow rank 0 down."""
Job = Callable[[Any, Any], Any]
"""Function of communicator and argument, called on every rank with the rank's argument."""


class Ranks:
    """The processes of ``mpiexec``; without it, one process.

    Raises
    ------
    SignoriniError
        If petsc4py or mpi4py is not installed.
    """

    def __init__(self, jobs: Mapping[str, Job]) -> None:
        try:
            import petsc4py

            # PETSc must not replace the signal handlers of the command.
            petsc4py.init(["-no_signal_handler"])
            from mpi4py import MPI
            from mpi4py.util import pkl5
        except ImportError as error:
            raise SignoriniError(
                f"The engine petsc needs petsc4py and mpi4py: {error}. Make an environment with .ci/petsc, see "
                "docs/scaling.md, or take --engine embedded."
            ) from None
        self._jobs = jobs
        self._communicator: Any = MPI.COMM_WORLD
        # This communicator sends arrays without a copy, also those of more than 2 GB.
        self._sending: Any = pkl5.Intracomm(MPI.COMM_WORLD)
        beside = MPI.COMM_WORLD.Split_type(MPI.COMM_TYPE_SHARED)
        self.machines = int(MPI.COMM_WORLD.allreduce(int(beside.rank == 0)))
        """Number of machines on which the processes run."""
        os.environ.setdefault("RAYON_NUM_THREADS", str(max(1, (os.cpu_count() or 1) // beside.size)))

    @property
    def rank(self) -> int:
        """Number of this process, from 0."""
        return int(self._communicator.rank)

    @property
    def count(self) -> int:
        """Number of processes."""
        return int(self._communicator.size)

    def run(self, name: str, arguments: Iterable[Any]) -> list[Any]:
        """Run a job on every rank, with one argument each; return the results of all ranks. Only rank 0 calls it."""
        every = iter(arguments)
        own = next(every)
        for rank in range(1, self.count):
            self._sending.send((name, next(every)), rank)
        # Run the generator of arguments to its end, so that it releases its large arrays.
        next(every, None)
        return self._gathered(name, own)

    def serve(self) -> None:
        """Take part in the jobs of rank 0 until it ends. Only the other ranks call it."""
        while (job := self._next()) is not None:
            self._gathered(*job)

    def end(self) -> None:
        """End `serve` on the other ranks."""
        for rank in range(1, self.count):
            self._sending.send(None, rank)

    def _next(self) -> Any:
        while not self._sending.iprobe(0):
            time.sleep(_WAIT)
        return self._sending.recv(None, 0)

    def _gathered(self, name: str, argument: Any) -> list[Any]:
        try:
            result = self._jobs[name](self._communicator, argument)
        except SignoriniError as error:
            # Every rank raises this error, so that all ranks reach the gather below.
            result = error
        except (KeyboardInterrupt, SystemExit):
            raise
        except BaseException as error:
            if self.count == 1:
                raise
            # The other ranks would wait for this rank for ever, so all ranks are aborted.
            traceback.print_exc()
            kind = "not enough memory" if isinstance(error, MemoryError) else f"{type(error).__name__}: {error}"
            sys.stderr.write(f"Error on rank {self.rank}: {kind}. All ranks end; no files are written.\n")
            sys.stderr.flush()
            self._communicator.Abort(1)
        results = self._sending.gather(result, 0) or []
        for failed in results:
            if isinstance(failed, SignoriniError):
                raise failed
        return results
