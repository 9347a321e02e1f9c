"""The command line, on ranks of which one is killed in its second Newton step: dying_rank.py RANK ARGUMENT …."""

import os
import signal
import sys


def main(dead: int) -> None:
    from mpi4py import MPI

    from signorini.mpi.linear import Equations
    from signorini_command import main as command

    fill, calls = Equations.fill, []

    def dying(self: Equations, *arguments: object) -> None:
        calls.append(1)
        if MPI.COMM_WORLD.rank == dead and len(calls) == 2:
            os.kill(os.getpid(), signal.SIGKILL)
        fill(self, *arguments)

    Equations.fill = dying
    command()


if __name__ == "__main__":
    main(int(sys.argv.pop(1)))
