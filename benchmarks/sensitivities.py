"""Sensitivities of random small plates, against central differences of new solutions.

The plates are those of random_laws.py, with constant gaps, a probe and a section: limits, laws, springs, preloads,
several plates. For up to six parameters of each plate, all numbers of the result are compared. The judge solves the
contact problem anew at four values of the parameter (differences of fourth order), with a step at which the contact
state stays. Derivatives must agree to 1e-6 of the largest number or derivative of the same kind, both for a change of
the parameter by its reference size. A difference that changes by more than 1e-7 with half the step is counted,
and not compared.

The range in which no point changes its piece is compared with the contact states of new solutions 2 % inside and 2 %
outside of its nearer end. Ends farther than 0.001 of the reference size are compared for loads, gaps and settlements
alone, on which the state depends linearly.

    python benchmarks/sensitivities.py [--count 1000] [--first 0] [--seconds 600] [--processes 2]
    python benchmarks/sensitivities.py --show SEED
    python benchmarks/sensitivities.py --check        a few plates, to test the script
"""

from __future__ import annotations

import json
import sys
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fuzz"))
import campaign
import random_laws

from signorini import InputError, Model, NoEquilibriumError, SignoriniError
from signorini.contact.problem import unfactored
from signorini.contact.strategy import answered
from signorini.discretise import discretise
from signorini.sensitivities.direct import Direct
from signorini.sensitivities.parameters import Parameter

warnings.simplefilter("error", RuntimeWarning)
TOLERANCE = 1e-6
_STEADY = 1e-7
"""Largest change of a difference with half the step, relative to the same reference as the tolerance."""
_STEPS = (2e-3, 2e-4, 2e-5)
"""Steps of the differences, relative to the parameter's reference size; the first that keeps the contact state."""
_PARAMETERS = 6
_NEAR = 1e-3
"""Largest distance of compared ends from the parameter, relative to the reference size; first order is then accurate
to 2 %."""
_LINEAR = ("gap", "settlement", "pressure", "force", "moment")
Tables = dict[str, Any]


def tables(seed: int) -> Tables:
    """Draw the model of a seed; return the tables of an input file."""
    drawn, rng = random_laws.tables(seed), np.random.default_rng([44, seed])
    for support in drawn["support"]:
        if isinstance(support.get("gap"), str):
            support["gap"] = float(support["gap"].partition("*")[0])
    plate = drawn["plates"]["p0"] if "plates" in drawn else drawn["plate"]
    disc = plate["shape"] == "disc"
    size = np.array(2 * [2 * plate["radius"]] if disc else plate["size"])
    at = size * (rng.uniform(-0.2, 0.2, 2) + (0.0 if disc else 0.5))
    on = {"plate": "p0"} if "plates" in drawn else {}
    drawn["probe"] = [{**on, "at": at.tolist()}]
    ends = at - 0.1 * size, at + size * [0.1, 0.15]
    drawn["section"] = [{**on, "line": [end.tolist() for end in ends]}]
    return drawn


def _solved(direct: Direct, one: Parameter, value: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Pieces of the points, and all numbers of the result at another value; None if there is no unique answer."""
    try:
        variant = direct._variant(one, value)
    except SignoriniError:
        return None
    tried = answered(unfactored(variant.found), variant.load)
    if not tried.passed or tried.answer.not_unique:
        return None
    return tried.answer.piece, direct._result(variant, tried.answer).numbers


def _differences(direct: Direct, one: Parameter, size: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Derivatives of all numbers times the reference size, and their changes with half the step."""
    for step in _STEPS:
        found = {at: _solved(direct, one, one.value + at * step * size) for at in (-2, -1, -0.5, 0.5, 1, 2)}
        if all(each is not None and np.array_equal(each[0], direct.answer.piece) for each in found.values()):
            values = {at: each[1] for at, each in found.items() if each is not None}

            def difference(h: float, values: dict[float, np.ndarray] = values, step: float = step) -> np.ndarray:
                inner, outer = values[h] - values[-h], values[2 * h] - values[-2 * h]
                return (8.0 * inner - outer) / (12.0 * h * step)

            whole, half = difference(1), difference(0.5)
            return half, np.abs(whole - half)
    return None


def _compared(direct: Direct, one: Parameter) -> tuple[Counter[str], list[str]]:
    try:
        rates = direct.rates(one)
    except SignoriniError:
        return Counter({"refused parameter": 1}), []
    if rates.leaves:
        return Counter({"at the end of a piece": 1}), []
    outcome, wrong = _range(direct, one, rates.size, rates.valid)
    judged = _differences(direct, one, rates.size)
    if judged is None:
        return outcome + Counter({"state too near its end": 1}), wrong
    theirs, unsteady = judged
    numbers, values = direct.result.catalogue.numbers, direct.result.numbers
    kinds = [one.quantity.kind for one in numbers]
    reference = np.abs(np.nan_to_num([values, rates.numbers, theirs])).max(axis=0)
    sizes = {kind: reference[[other == kind for other in kinds]].max() for kind in set(kinds)}
    for number, mine, other, change, kind, kink in zip(
        numbers, rates.numbers, theirs, unsteady, kinds, rates.kinks, strict=True
    ):
        if kind == "count" or not np.isfinite(mine + other) or sizes[kind] == 0.0:
            continue
        if kink or change > _STEADY * sizes[kind]:
            outcome["kink" if kink else "beyond the judge"] += 1
            continue
        outcome["derivatives"] += 1
        if abs(mine - other) > TOLERANCE * sizes[kind]:
            wrong.append(f"{number.name} by {one.path}: {mine:.9g}, not {other:.9g}; size {sizes[kind]:.3g}")
    return outcome, wrong


def _range(direct: Direct, one: Parameter, size: float, valid: tuple[float, float]) -> tuple[Counter[str], list[str]]:
    """Compare the nearer end of the range with the contact states beside it."""
    end = min(valid, key=lambda end: abs(end - one.value))
    away = end - one.value
    linear = any(key in _LINEAR for key in one.place) or not one.place
    if not np.isfinite(end) or (end == 0.0 and one.is_positive) or not (linear or abs(away) <= _NEAR * size):
        return Counter(), []
    inside, outside = (_solved(direct, one, one.value + part * away) for part in (0.98, 1.02))
    if inside is None or outside is None:
        return Counter({"range without solution": 1}), []
    wrong = []
    if not np.array_equal(inside[0], direct.answer.piece):
        wrong.append(f"{one.path} within {valid}: a point changes its piece inside")
    if np.array_equal(outside[0], direct.answer.piece):
        wrong.append(f"{one.path} within {valid}: no point changes its piece outside")
    return Counter({"ranges": 1}), wrong


def draw(seed: int) -> tuple[Counter[str], list[str]]:
    """Compare the sensitivities of a seed's plate; return counts of outcomes, and errors."""
    try:
        model = Model(**tables(seed))
        problem = unfactored(discretise(model))
        direct = Direct(problem, model.effective_combinations[0])
    except NoEquilibriumError:
        return Counter({"no equilibrium": 1}), []
    except InputError as error:
        return Counter({"not unique" if "unique" in str(error) else "refused": 1}), []
    except SignoriniError:
        return Counter({"no answer": 1}), []
    outcome, wrong = Counter({"solved": 1}), list[str]()
    paths = direct.input.paths(direct.base.combination)
    chosen = np.random.default_rng([45, seed]).permutation(paths)[:_PARAMETERS]
    for path in chosen.tolist():
        one = Parameter.of(path, model, direct.input.tables, direct.base.combination)
        found, faults = _compared(direct, one)
        outcome, wrong = outcome + found, wrong + faults
    return outcome, wrong


def show(seed: int) -> None:
    """Print the input of a seed's model."""
    print(json.dumps(tables(seed), indent=1))


if __name__ == "__main__":
    sys.exit(campaign.main(__doc__, draw, show, count=1000, check=10))
