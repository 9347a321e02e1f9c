"""Solve one model over the ranks of MPI: ``signorini solve --engine petsc``.

Rank 0 meshes the plate and divides the arrays. Every rank assembles its part of K with the core's elements; PETSc and
MUMPS factor it. Rank 0 then has u and λ, and computes the numbers and files with the code of the embedded engine.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from signorini.analysis.checks import require_checks
from signorini.analysis.results import Results
from signorini.base.memory import over_machines
from signorini.base.progress import Progress
from signorini.contact.certificate import Certificate, certified
from signorini.contact.problem import Steps, unfactored
from signorini.contact.selection import Answer, chosen
from signorini.contact.strategy import refusal
from signorini.discretise import Discretisation, discretise
from signorini.discretise.rows import Floats, Ints
from signorini.equilibrium.balance import rigid_freedom
from signorini.equilibrium.imbalance import explain, imbalance_of
from signorini.errors import InputError, NotCertifiedError, Place
from signorini.formats.vtk import as_meshio, write_pvtu, write_vtu
from signorini.model import Combination, Model
from signorini.mpi.certificate import errors
from signorini.mpi.newton import Problem, solved
from signorini.mpi.parts import Division, Part, bisected, parts_of
from signorini.mpi.ranks import Ranks
from signorini.results.recovery import recovered, unsolved_result
from signorini.results.result import Result
from signorini.results.vtk import vtk_fields

Show = Callable[[Progress], object]


def _solve(communicator: Any, argument: tuple[Part, Steps | None]) -> dict[str, Any]:
    """Solve one rank's part; return the values at the rank's nodes and points, and the errors of the certificate."""
    part, steps = argument
    problem = Problem(part, communicator)
    solution = solved(problem, steps or _silent)
    mine, owned = problem.mine, problem.owned
    return {
        "hi": solution.hi[owned],
        "lo": solution.lo[owned],
        "points": part.points[mine],
        **{name: getattr(solution, name)[mine] for name in ("reaction", "gap", "closed")},
        "errors": errors(problem, solution),
        "steps": solution.steps,
        "factorizations": solution.factorizations,
    }


def _silent(step: int, changing: int, residual: float) -> None: ...


def _write(communicator: Any, argument: tuple[Path, dict[str, str], Any]) -> None:
    """Write one rank's elements of a .vtu file."""
    path, metadata, mesh = argument
    write_vtu(path, as_meshio(*mesh), metadata)


class Engine:
    """PETSc over the processes of ``mpiexec``. Only rank 0 calls `solve` and `write`."""

    def __init__(self) -> None:
        self.ranks = Ranks({"solve": _solve, "write": _write})

    @property
    def count(self) -> int:
        """Number of processes."""
        return self.ranks.count

    def solve(self, model: Model, show: Show) -> Results:
        """Solve every combination of a model; only rank 0 calls it.

        Raises
        ------
        InputError
            If the model has a part that this engine does not solve.
        NotCertifiedError
            If an answer fails its certificate.
        """
        _require_plain(model)
        begun, seconds = time.perf_counter(), dict.fromkeys(("mesh", "assemble", "order", "factor", "contact"), 0.0)
        results: dict[str, Result] = {}
        discretisation: Discretisation | None = None
        for combination in model.effective_combinations:
            # The discretisation of the previous combination is released, so that only one is in memory.
            discretisation = None
            results[combination.name], discretisation = _result(self.ranks, model, combination, show, seconds)
        seconds["recover"] = sum(result.seconds for result in results.values())
        seconds["total"] = time.perf_counter() - begun
        assert discretisation is not None, "a model has a combination"
        return Results(unfactored(discretisation), results, seconds)

    def write(self, result: Result, path: Path, pieces: Sequence[Path]) -> None:
        """Write the .pvtu file ``path``, and on each rank the .vtu file of its elements, which is one of ``pieces``."""
        nodes, metadata = result.stress_nodes, result.model.provenance.metadata
        owner = bisected(result.mesh.points[result.mesh.elements[:, :4]].mean(axis=1), self.count)
        of_nodes, of_elements = vtk_fields(result)

        def piece(rank: int) -> tuple[Any, ...]:
            chosen = owner == rank
            used, elements = np.unique(nodes.elements[chosen], return_inverse=True)
            at_nodes, at_elements = (
                {name: values[which] for name, values in fields.items()}
                for fields, which in ((of_nodes, used), (of_elements, chosen))
            )
            return nodes.points[used], elements.reshape(-1, 8), at_nodes, at_elements

        self.ranks.run("write", ((one, metadata, piece(rank)) for rank, one in enumerate(pieces)))
        write_pvtu(path, [one.name for one in pieces], of_nodes, of_elements)


def _result(
    ranks: Ranks, model: Model, combination: Combination, show: Show, seconds: dict[str, float]
) -> tuple[Result, Discretisation]:
    """Result of one combination, and the discretisation on which it was computed."""
    arguments, order, unbalanced = _posed(ranks, model, combination, show, seconds)
    if unbalanced:
        discretisation = _discretised(ranks, model, show, seconds)
        return unsolved_result(discretisation, combination, unbalanced), discretisation
    begun = time.perf_counter()
    found = ranks.run("solve", arguments)
    seconds["contact"] += time.perf_counter() - begun
    discretisation = _discretised(ranks, model, show, seconds)
    load, freedom = discretisation.load(combination), rigid_freedom(discretisation)
    answer = _answer(discretisation, order, found)
    least = chosen(discretisation, freedom, load.nodal, answer)
    certificate = Certificate(**found[0]["errors"])
    if least is not answer or not certificate.passed or not (load.all_weighs or not load.weighing.any()):
        # `certified` certifies the other answer that `chosen` took, or adds rounding limits and `lost` to the errors.
        least, certificate = certified(discretisation, load, least)
    if not certificate.passed:
        why = refusal(combination.name, discretisation, load, least, certificate)
        raise NotCertifiedError(f"Combination {why}")
    return recovered(discretisation, combination, ("active_set",), load, least, certificate), discretisation


def _posed(
    ranks: Ranks, model: Model, combination: Combination, show: Show, seconds: dict[str, float]
) -> tuple[Iterator[tuple[Part, Steps | None]], Ints, str]:
    """Arguments of the ranks' jobs, the order of nodes, and the reason why no reactions balance the load, or "".

    The discretisation is released when the arguments are sent, so that rank 0 has its memory for the factor.
    """
    discretisation = _discretised(ranks, model, show, seconds)
    require_checks(discretisation)
    _require_handled(discretisation)
    message = explain(discretisation, imbalance_of(discretisation, rigid_freedom(discretisation), combination))
    division = Division.of(discretisation, ranks.count)
    parts = parts_of(discretisation, division, discretisation.load(combination))

    def steps(step: int, changing: int, residual: float) -> None:
        show(Progress(combination.name, step, changing, residual, method="the active set over the ranks"))

    return ((part, None if rank else steps) for rank, part in enumerate(parts)), division.order, message


def _discretised(ranks: Ranks, model: Model, show: Show, seconds: dict[str, float]) -> Discretisation:
    show(Progress(stage="mesh"))
    with over_machines(ranks.machines):
        discretisation = discretise(model)
    for name in ("mesh", "assemble"):
        seconds[name] += discretisation.seconds[name]
    return discretisation


def _answer(discretisation: Discretisation, order: Ints, found: list[dict[str, Any]]) -> Answer:
    """Join the parts of the solution that the ranks have found into one `Answer` on the whole mesh."""
    points = np.concatenate([one["points"] for one in found])

    def at_nodes(name: str) -> Floats:
        values = np.empty((len(order), 3))
        values[order] = np.concatenate([one[name] for one in found]).reshape(-1, 3)
        return values.ravel()

    def at_points(name: str) -> Any:
        values = np.concatenate([one[name] for one in found])
        result = np.empty_like(values)
        result[points] = values
        return result

    reaction, closed = at_points("reaction"), at_points("closed")
    return Answer(
        status="solved",
        hi=at_nodes("hi"),
        lo=at_nodes("lo"),
        reaction=reaction,
        gap=at_points("gap"),
        closed=closed,
        piece=np.where(discretisation.contacts.two_sided, 0, closed).astype(np.uint8),
        shared=np.concatenate([reaction, np.zeros(len(discretisation.repeated))]),
        pivots=0,
        iterations=found[0]["steps"],
        gradients=0,
        factorizations=found[0]["factorizations"],
        corrections=0,
    )


def _require_plain(model: Model) -> None:
    """Refuse input that this engine does not solve, before the plate is meshed."""
    combinations = (
        ("combination",) if model.combination else ("moving",) if model.moving else ("output", "combinations")
    )
    found: list[tuple[Place, object, str]] = [
        (("plates",), model.plates, "several plates"),
        (combinations, model.tabulated, "combinations as rows of a table"),
        (("mesh", "accuracy"), model.mesh.accuracy, "refinement to an accuracy"),
        (("solver", "method"), model.solver.method not in ("auto", "active_set"), "Lemke's algorithm"),
        (("tightening",) if model.tightening else ("support",), model.rounds, "bolts that are tightened"),
        (("punching",), model.punching, "punching"),
    ]
    found += [(("zone", index, "rigid"), zone.rigid, "rigid zones") for index, zone in enumerate(model.zone)]
    for index, support in enumerate(model.support):
        found.append((("support", index), support.has_footprint, "supports with a footprint"))
    for where, given, what in found:
        if given:
            raise InputError(
                f"The engine petsc does not solve models with {what}. Leave this out, or take --engine embedded.",
                where,
            )


def _require_handled(discretisation: Discretisation) -> None:
    """Refuse supports whose law, which depends on several keys, is neither λ = k max(τ, 0) nor a straight line."""
    contacts = discretisation.contacts
    handled = np.array([law.only_pushes or law.straight for law in contacts.laws], np.bool_)[contacts.law]
    if not handled.all():
        index = int(contacts.support[~handled][0])
        raise InputError(
            "The engine petsc solves supports that push in one direction or hold in both, with a constant stiffness or "
            "none, and no limit. Change this support, or take --engine embedded.",
            ("support", index),
        )
