"""The engine petsc and the embedded engine on slab A: time, Newton steps, memory of each rank, size of the factor.

Every run has processes of its own. Memory is the largest resident set of a process, including imports. The processor
time of a rank includes the time in which it waits for others, because MPI waits at full load. docs/scaling.md has the
results.

    .ci/petsc                                   makes the environment
    .venv-petsc/bin/python benchmarks/petsc.py [--elements 75 160 333] [--ranks 1 2 4]
    .venv-petsc/bin/python benchmarks/petsc.py --check          answers only, on a small mesh
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time

SETTLEMENT = 4.229e-3
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
"""Open MPI starts processes of root only with these; tests run as root in containers."""


def used() -> dict[str, float]:
    of = resource.getrusage(resource.RUSAGE_SELF)
    return {"memory_mb": of.ru_maxrss / 1024, "cpu": of.ru_utime + of.ru_stime}


def embedded(elements: int) -> dict[str, object]:
    from tensionless import slab_a

    from signorini import contact_problem, solve

    begun = time.perf_counter()
    results = solve(slab_a(elements))
    seconds, ranks = time.perf_counter() - begun, [used()]
    core = contact_problem(slab_a(elements)).core
    result = results["all"]
    return {
        "dofs": results.discretisation.dof_count,
        "seconds": seconds,
        "factor_seconds": results.seconds["factor"],
        "ranks": ranks,
        "entries": core.factor_entries,
        "flops": core.factor_flops,
        "steps": result.iterations,
        "settlement": float(result.deflection.max()),
        "uplift": -float(result.deflection.min()),
        "passed": result.certificate.passed,
    }


def over_ranks(elements: int) -> dict[str, object] | None:
    from tensionless import slab_a

    from signorini.mpi.engine import Engine
    from signorini.mpi.linear import Equations

    factors: list[dict[str, float]] = []
    factor = Equations.factor

    def watched(self: Equations) -> None:
        begun = time.perf_counter()
        factor(self)
        made = self._solver.getFactorMatrix()
        entries = made.getMumpsInfog(29)
        factors.append(
            {
                "seconds": time.perf_counter() - begun,
                # MUMPS gives large numbers in millions, with the opposite sign.
                "entries": float(entries) if entries >= 0 else -1e6 * entries,
                "flops": made.getMumpsRinfog(3),
            }
        )

    Equations.factor = watched  # type: ignore[method-assign]
    engine, begun = Engine(), time.perf_counter()
    results = None
    if engine.ranks.rank:
        engine.ranks.serve()
    else:
        results = engine.solve(slab_a(elements), lambda progress: None)
        engine.ranks.end()
    from mpi4py import MPI

    seconds = time.perf_counter() - begun
    ranks = MPI.COMM_WORLD.gather(used())
    if results is None:
        return None
    result = results["all"]
    return {
        "dofs": results.discretisation.dof_count,
        "seconds": seconds,
        "factor_seconds": factors[-1]["seconds"],
        "first_factor_seconds": factors[0]["seconds"],
        "factors": len(factors),
        "ranks": ranks,
        "entries": factors[0]["entries"],
        "flops": factors[0]["flops"],
        "steps": result.iterations,
        "settlement": float(result.deflection.max()),
        "uplift": -float(result.deflection.min()),
        "passed": result.certificate.passed,
    }


def run(elements: int, ranks: int) -> dict[str, object]:
    """Solve in processes of their own; 0 ranks is the embedded engine."""
    command = [sys.executable, __file__, "--run", str(elements)]
    if ranks:
        command = ["mpiexec", "--oversubscribe", "-n", str(ranks), *command, "--petsc"]
    threads = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"} if ranks else {}
    found = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **AS_ROOT, **threads})
    if found.returncode:
        sys.exit(found.stderr)
    result: dict[str, object] = json.loads(found.stdout.splitlines()[-1])
    return result


def measure(elements: list[int], ranks: list[int]) -> None:
    print("elements       dofs  engine     time  steps  factor: time  entries     flops   MB and CPU s of each rank")
    for n in elements:
        for count in ranks:
            of = run(n, count)
            each = "  ".join(f"{one['memory_mb']:.0f} {one['cpu']:.0f}" for one in of["ranks"])
            name = f"petsc {count}" if count else "embedded"
            print(
                f"{n:4} × {n:<4} {of['dofs']:8}  {name:8} {of['seconds']:6.1f} s  {of['steps']:5}  "
                f"{of['factor_seconds']:10.2f} s  {of['entries']:8.3g}  {of['flops']:8.3g}   {each}",
                flush=True,
            )


def check() -> None:
    rows = [run(40, count) for count in (0, 1, 2)]
    spread = max(abs(row[key] / rows[0][key] - 1) for row in rows for key in ("settlement", "uplift"))
    error = abs(rows[0]["settlement"] / SETTLEMENT - 1)
    print(f"settlement off by {error:.1e}; 1 and 2 ranks differ from the embedded engine by {spread:.1e}")
    sys.exit(0 if error < 5e-4 and spread < 1e-9 and all(row["passed"] for row in rows) else 1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, nargs="+", default=[75, 160, 333])
    parser.add_argument("--ranks", type=int, nargs="+", default=[0, 1, 2, 4], help="0 is the embedded engine")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--run", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--petsc", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.run:
        found = over_ranks(given.run) if given.petsc else embedded(given.run)
        if found is not None:
            print(json.dumps(found))
    elif given.check:
        check()
    else:
        measure(given.elements, given.ranks)


if __name__ == "__main__":
    main()
