"""Calls of Rust functions with invalid arguments: lengths, NaN, indices, strides, one array twice, others' objects.

    python tests/fuzz/border.py [--count 100000] [--first 0] [--seconds 600] [--processes 2]

A call must return or raise an ordinary exception; a panic is a failure.
"""

from __future__ import annotations

import functools
import sys
import warnings
from collections import Counter
from collections.abc import Callable
from random import Random
from typing import Any

import campaign
import numpy as np

from signorini import Model, _core
from signorini.contact.problem import ContactProblem, contact_problem
from signorini.discretise import Discretisation

ORDINARY = (ValueError, TypeError, RuntimeError, MemoryError, OverflowError)

_REALS = [np.nan, np.inf, -np.inf, 0.0, -0.0, -1.0, 1e300, -1e300, 1e-300, 5e-324]
_WHOLES = [-1, -(2**63), 2**63 - 1, 10**9, 0, 7, 8, 20, 21]


def example(points: int = 2) -> tuple[ContactProblem, Discretisation]:
    """A small problem whose arrays are of every kind: held slopes in frames, springs, one- and two-sided points."""
    problem = contact_problem(
        Model(
            material={"E": 1000.0, "nu": 0.3},
            plate={"shape": "disc", "radius": 2.0, "sector": 90, "thickness": 0.3},
            mesh={"divisions": [2, 4]},
            support=[
                {"edge": "rim", "fix": "hard"},
                {"at": [[0.7, 0.6]], "stiffness": 5.0},
                {"at": [[0.4, 0.9]], "fix": "simple"},
                {"at": [[0.9, 0.3], [0.3, 0.2], [0.2, 0.5]][:points], "resists": "down", "gap": 0.01},
                {"area": {"rectangle": [0.1, 0.1, 0.4, 0.4]}, "resists": "down", "stiffness": 9.0},
            ],
            load=[{"pressure": 1.0}],
        )
    )
    return problem, problem.discretisation


def made(problem: ContactProblem, found: Discretisation) -> list[Any]:
    """Objects of a problem: core, plate, responses and lists of responses, shared data of cases, solutions."""
    core, load, held = problem.core, found.cases["load"].nodal, found.held.values
    rest, points = _core.rest_response(core, held), _core.point_responses(core, 0, len(problem.gaps))
    cases = _core.load_responses(core, load[None])
    shared = _core.combined_cases(core, rest, cases, points)
    active = problem.by("active_set").core
    return [
        core,
        found.plate,
        rest,
        cases,
        points,
        shared,
        active.solve_and_factor(load, held),
        [core.solve(load, held)],
    ]


def strangers() -> list[Any]:
    """Objects of other problems of equal, larger and smaller size, and responses without displacements."""
    found = [thing for points in (2, 3, 1) for thing in made(*example(points))]
    return [*found, *([thing.at_points()] for thing in found if isinstance(thing, _core.Response))]


def calls(problem: ContactProblem, found: Discretisation) -> list[tuple[Callable[..., Any], list[Any]]]:
    """Every function of the core with valid arguments."""
    mesh, material, contacts, held = found.mesh, found.model.material, found.contacts, found.held
    u, load = np.linspace(0.0, 1.0, found.dof_count), found.cases["load"].nodal
    rows = contacts.rows
    constraints = [
        *(*rows.arrays, contacts.distance, contacts.law, contacts.scale, contacts.unit),
        np.zeros(len(rows)),
    ]

    laws = [(law.vertices, law.ends) for law in contacts.laws]

    def contact(
        elements, coefficients, further, distance, law, scale, unit, regularization, dofs, motions, method, *spring
    ):
        points = {
            "elements": elements,
            "rows": coefficients,
            "further": further,
            "distance": distance,
            "law": law,
            "scale": scale,
            "unit": unit,
            "regularization": regularization,
        }
        _core.ContactProblem(found.plate, dofs, spring, points, laws, motions, method).solve(load, held.values)

    def residual(load, hi, lo, *spring):
        found.plate.residual(spring, load, hi, lo)

    thickness = np.full((len(mesh.elements), len(_core.section_points("mitc9"))), 0.3)
    rigidities = np.tile([2.0, 0.6, 0.0, 2.0, 0.0, 0.7, 80.0, 0.0, 80.0], (1, thickness.shape[1], 1))
    plate = [
        mesh.points,
        mesh.elements,
        thickness,
        material.E,
        found.zones.rigidities[0].for_core,
        "mitc9",
        held.frames,
    ]

    def layered(*arguments):
        *most, elements, rigidities = arguments
        _core.Plate(*most, None, (elements, rigidities))

    def zoned(*arguments):
        *most, number, young, units, nodes = arguments
        _core.Plate(*most, None, None, (number, young, units), nodes)

    spring = list(found.springs.arrays)
    centre = np.zeros(2 * len(mesh.elements))
    lcp = problem.lcp(load)
    core, _, rest, cases, points, shared, reference, solved = made(problem, found)
    active = problem.by("active_set").core
    one, count = np.ones((1, 1)), len(rows)
    return [
        (_core.combined_cases, [core, rest, cases, points]),
        (_core.combine, [core, shared, one]),
        (_core.solution_stresses, [found.plate, solved, np.zeros((1, 3)), centre[None]]),
        (active.solve, [load, held.values, None, reference]),
        (_core.solve_together, [active, reference, load[None], held.values]),
        (_core.rest_response, [core, held.values]),
        (_core.load_responses, [core, load[None]]),
        (_core.point_responses, [core, 0, count]),
        (core.solve_on, [load, held.values, np.zeros(count, np.uint8)]),
        (core.path, [0 * load, load, held.values, 2.0, lambda *stop: None]),
        (found.plate.openings, [*rows.arrays, contacts.distance, u, u]),
        (_core.superpose, [one, u[None]]),
        (_core.Plate, plate),
        (layered, [*plate[:6], np.array([2]), rigidities]),
        (zoned, [*plate[:6], np.arange(len(mesh.elements)) % 2, np.array([1e9]), plate[4][None], mesh.elements]),
        (found.plate.interpolation_rows, [rows.elements, np.zeros((len(rows), 2)), 0]),
        (found.plate.curvature_load, [np.array([0.1, 0.0, 0.2])]),
        (residual, [load, u, 1e-17 * u, *spring]),
        (found.plate.internal_magnitude, [held.dofs, u, u]),
        (found.plate.stresses, [u, u, np.array([0.1, 0.0, 0.2]), centre]),
        (contact, [*constraints, held.dofs, np.zeros((0, found.dof_count)), "saddle", *spring]),
        (problem.core.solve, [load, held.values, None, solved[0]]),
        (problem.core.lcp, [load, held.values, "dual"]),
        (problem.core.apply_inverse, [load]),
        (_core.lemke, [lcp.M, lcp.q, np.ones(len(lcp.q)), 1000, np.zeros(len(lcp.q), np.bool_)]),
        (_core.serendipity, [np.zeros((3, 2))]),
    ]


def spoilt(rng: Random, arguments: list[Any], others: list[Any]) -> list[Any]:
    """Copy the arguments and make one to three of them wrong; some are taken from ``others``."""
    arguments = [argument.copy() if isinstance(argument, np.ndarray) else argument for argument in arguments]
    for _ in range(rng.choice([1, 1, 2, 3])):
        at = rng.randrange(len(arguments))
        if isinstance(arguments[at], np.ndarray):
            arguments[at] = rng.choice([_value, _value, _value, _length, _strides, _kind])(rng, arguments[at])
        elif (like := [other for other in others if type(other) is type(arguments[at])]) and rng.random() < 0.8:
            arguments[at] = rng.choice(like)
        else:
            arguments[at] = rng.choice([None, -1, 0, 2**62, 3, "stiffness", "", "ö", np.nan, 1e308, [], arguments[0]])
        if rng.random() < 0.1:
            arguments[rng.randrange(len(arguments))] = arguments[at]
    return arguments


def _value(rng: Random, array: np.ndarray) -> np.ndarray:
    if array.size:
        at = rng.randrange(array.size)
        if array.dtype == np.bool_:
            array.flat[at] ^= True
        else:
            with np.errstate(over="ignore"):
                array.flat[at] = rng.choice(_WHOLES if array.dtype.kind == "i" else _REALS)
    return array


def _length(rng: Random, array: np.ndarray) -> np.ndarray:
    way = rng.randrange(4)
    if way == 0:
        return array[: rng.randrange(len(array) + 1)]
    if way == 1:
        return np.concatenate([array, array[:1]])
    if way == 2 and array.ndim == 2:
        return array[:, : rng.randrange(array.shape[1] + 1)]
    return array.reshape(rng.choice([(-1,), (1, -1), (-1, 1), (*array.shape, 1)]))


def _strides(rng: Random, array: np.ndarray) -> np.ndarray:
    array = rng.choice([np.asfortranarray, lambda a: a[::-1], lambda a: np.repeat(a, 2, axis=0)[::2]])(array)
    array.flags.writeable = rng.random() < 0.5
    return array


def _kind(rng: Random, array: np.ndarray) -> np.ndarray:
    kind = rng.choice([np.float32, np.int32, np.float64, np.int64, np.bool_, np.complex128, object])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return array.astype(kind)


def fault(seed: int, entries: list[tuple[Callable[..., Any], list[Any]]], others: list[Any]) -> str:
    """Message if the call of a seed panics; empty if it does not."""
    rng = Random(seed)
    call, arguments = rng.choice(entries)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            call(*spoilt(rng, arguments, others))
    except ORDINARY:
        pass
    except BaseException as error:  # pyo3's PanicException does not derive from Exception.
        return f"{getattr(call, '__name__', call)}: {type(error).__name__}: {error}"
    return ""


_entries = functools.cache(lambda: (calls(*example()), strangers()))


def one(seed: int) -> tuple[Counter[str], list[str]]:
    """Make the call of a seed; return the outcome and its faults."""
    found = fault(seed, *_entries())
    return Counter({"calls": 1}), [found] if found else []


if __name__ == "__main__":
    sys.exit(campaign.main(__doc__, one, lambda seed: None))
