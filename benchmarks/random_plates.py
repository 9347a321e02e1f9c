"""Random small plates: each has a certified answer, or no equilibrium, as a separate linear program confirms.

Most models are those of tests/fuzz/random_models.py. The judge shares no code with the program's own check. It writes
the balance of every combination from the positions of supports, held nodes and springs, and the resultants of loads,
and finds reactions by scipy.optimize.linprog. A second linear program over the plate's deflections confirms verdicts
that supports contradict each other.

Every fourth model is from tests/fuzz/extreme_models.py, with its own judge: a closed form, statics, or a finer mesh.
Every eighth is from tests/fuzz/twofold_models.py, which describe one plate twice. The program may refuse these models,
but must not be wrong.

    python benchmarks/random_plates.py [--count 100000] [--first 0] [--seconds 600] [--processes 2]
    python benchmarks/random_plates.py --show SEED
    python benchmarks/random_plates.py --check        a few plates, to test the script
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from pathlib import Path
from random import Random

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import bmat

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fuzz"))
import campaign
import door
import extreme_models
import random_models
import twofold_models

from signorini import InputError, NoEquilibriumError, NotCertifiedError, solve, validate
from signorini.discretise import discretise

_NEAR = 1e-7
"""Largest imbalance, relative to the load, at which either verdict on equilibrium counts as right."""
_LOST = 1e-6
"""Largest imbalance of the reactions, relative to loads and reactions; a certificate allows 1e-4."""
_EXACT = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
"""Smallest tolerances that HiGHS allows; with its default it accepts an imbalance of 1e-7."""
MOVES = ("against this motion", "bends in some shapes without resistance")
"""Parts of messages about a plate that can move."""
_EXTREME = 4
"""Every 4th model is an extreme plate; every 8th is a plate that is described in two ways."""


def balance(found, nodal):
    """Return the resultants of unit reactions as columns, a mask of reactions of either sign, and the load's
    resultants.

    Resultants are the force, and moments about the middle divided by the plate's size. They are computed from positions
    alone. The reaction of a held slope is a couple.
    """
    points, contacts, springs, held = found.mesh.points, found.contacts, found.springs, found.held
    middle, size = 0.5 * (points.min(axis=0) + points.max(axis=0)), np.ptp(points, axis=0).max()

    def lever(at):
        return np.column_stack([np.ones(len(at)), (at - middle) / size])

    nodes = np.repeat(np.arange(len(points)), 3)
    frames = np.tile([1.0, 0.0], (len(points), 1)) if held.frames is None else held.frames
    unit = np.zeros((len(nodes), 3))
    unit[0::3] = lever(points)
    unit[1::3, 1:] = frames / size
    unit[2::3, 1:] = frames[:, ::-1] * [-1.0, 1.0] / size
    rows = contacts.rows
    of_slopes = rows.matrix(found.mesh.elements, len(unit)) @ unit
    at_contacts = np.where(contacts.slope[:, None], of_slopes, contacts.direction[:, None] * lever(contacts.positions))
    columns = np.vstack([unit[held.dofs], lever(springs.positions), at_contacts])
    both_ways = np.concatenate([np.ones(held.dofs.sum() + len(springs.positions), bool), contacts.two_sided])
    return columns.T, both_ways, unit.T @ nodal


def reactions_exist(found, nodal):
    """Whether reactions balance the load: True, False, or None if rounding decides.

    The load excludes curvatures: they have no resultant, but their couples would increase the reference size.
    """
    columns, both_ways, wanted = balance(found, nodal)
    total = np.abs(nodal[::3]).sum() + np.abs(nodal.reshape(-1, 3)[:, 1:]).sum() / found.mesh.size
    if total == 0.0:
        return True
    # Minimise the imbalance, relative to the load.
    slack = np.hstack([np.eye(3), -np.eye(3)])
    count = columns.shape[1]
    bounds = [(None if both else 0, None) for both in both_ways] + [(0, None)] * 6
    cost = np.append(np.zeros(count), np.ones(6))
    least = linprog(
        cost, A_eq=np.hstack([columns, slack]), b_eq=wanted / total, bounds=bounds, method="highs", options=_EXACT
    )
    if least.x is None:
        return None
    return True if least.fun < 1e-12 else None if least.fun < _NEAR else False


def deflection_exists(found):
    """Whether a deflection exists that satisfies every rigid support: True, False, or None if rounding decides."""
    contacts, held = found.contacts, found.held
    rigid = np.flatnonzero(contacts.compliance == 0)
    scale = max(np.abs(contacts.distance).max(initial=0.0), np.abs(held.values).max(initial=0.0))
    if scale == 0.0 or not len(rigid):
        return True
    rows = contacts.rows.matrix(found.mesh.elements, found.dof_count)[rigid]
    # Minimise the overlap in rows · u ≤ distance + overlap, which is common to all rows.
    upper = bmat([[rows, -np.ones((len(rigid), 1))]])
    two = contacts.two_sided[rigid]
    both = upper if not two.any() else bmat([[upper], [bmat([[-rows[two], -np.ones((two.sum(), 1))]])]])
    distance = contacts.distance[rigid] / scale
    limits = np.concatenate([distance, -distance[two]])
    bounds = [(v / scale, v / scale) if h else (None, None) for h, v in zip(held.dofs, held.values, strict=True)]
    cost = np.append(np.zeros(found.dof_count), 1.0)
    least = linprog(cost, A_ub=both, b_ub=limits, bounds=[*bounds, (0, None)], method="highs", options=_EXACT)
    if least.x is None:
        return None
    return True if least.fun < 1e-9 else None if least.fun < 1e-6 else False


def judged(seed):
    """Outcome and errors of the model of a seed."""
    model = with_judge(seed)
    return judged_ordinary(seed) if model is None else judged_by_its_own(model)


def with_judge(seed):
    """Model of a seed with its own judge; None for a model that a linear program judges."""
    if seed % _EXTREME == _EXTREME - 1:
        return extreme_models.extreme(Random(seed))
    return twofold_models.twofold(Random(seed)) if seed % (2 * _EXTREME) == 1 else None


def judged_by_its_own(model):
    """Outcome and errors of a model with its own judge."""
    try:
        result = extreme_models.solved(model.tables)
        wrong = model.judge(result)
    except (InputError, NotCertifiedError) as error:
        if isinstance(error, InputError) and door.words_of_the_door(error):
            wrong = door.wrongly_refused(validate(model.tables), error)
            return Counter({f"{model.kind} refused at the door": 1}), wrong
        return Counter({f"{model.kind} refused": 1}), [] if model.may_be_refused else [f"{model.kind}: {error}"]
    return Counter({f"{model.kind} {'certified' if result else 'without equilibrium'}": 1}), [
        f"{model.kind}: {line}" for line in wrong
    ]


def judged_ordinary(seed):
    """Outcome and errors of a model that a linear program judges."""
    tables = random_models.model(Random(seed))
    # Rows of a table do not store messages.
    tables["output"] = {"combinations": "each"}
    try:
        model = validate(tables)
    except InputError:
        return Counter({"refused input": 1}), []
    try:
        results = solve(model)
        found = results.problem.discretisation
        messages = {name: result.message for name, result in results.items()}
    except InputError as error:
        if door.words_of_the_door(error):
            return Counter({"refused at the door": 1}), door.wrongly_refused(model, error)
        moves = any(words in str(error) for words in MOVES)
        return Counter({"mechanism" if moves else "refused input": 1}), []
    except NotCertifiedError as error:
        if _certified_as_advised(tables, str(error)):
            return Counter({"refused, certified as advised": 1}), []
        return Counter({"not certified": 1}), [str(error)]
    except NoEquilibriumError as error:
        found = discretise(model)
        names = [combination.name for combination in model.effective_combinations]
        lines = str(error).splitlines()
        messages = {name: line.removeprefix(f"{name}: ") for name, line in zip(names, lines, strict=True)}
    straight = found
    if any("curvature" in load for load in tables["load"]):
        loads = [{**load, "curvature": [0.0, 0.0, 0.0]} if "curvature" in load else load for load in tables["load"]]
        straight = discretise(validate({**tables, "load": loads}))
    outcomes, wrong = Counter(), []
    for combination in model.effective_combinations:
        message = messages[combination.name]
        exists = reactions_exist(found, straight.load(combination).nodal)
        contradiction = "contradict" in message
        certified = "certified" if message or not results[combination.name].unsettled else "certified by a later method"
        outcomes["contradiction" if contradiction else "no equilibrium" if message else certified] += 1
        if exists is None:
            outcomes["of these marginal"] += 1
        elif exists == (bool(message) and not contradiction):
            wrong.append(f'"{combination.name}": the linear program says {exists}, the program "{message}"')
        elif not message and (missing := lost(found, combination, results[combination.name])):
            wrong.append(f'"{combination.name}": reported reactions miss the load by {missing:.1e} of it')
        elif contradiction and deflection_exists(found):
            wrong.append(f'"{combination.name}": a deflection agrees with all supports, yet: "{message}"')
    return outcomes, wrong


def lost(found, combination, result):
    """Imbalance of the reported reactions and the load, relative to loads and reactions; 0 if small."""
    reported = np.concatenate([support.reactions for support in result.supports])
    size = np.abs(reported).sum()
    for case in found.cases.values():
        force, *couples = np.abs(case.nodal.reshape(-1, 3)).sum(axis=0)
        size += force + sum(couples) / found.mesh.size
    missing = abs(found.load(combination).nodal[::3].sum() - sum(result.reactions.values()))
    return missing / size if missing > _LOST * size else 0.0


def _certified_as_advised(tables, refusal):
    """Whether the plate has an answer if changed as a refusal advises: another element, or no settlements."""
    if "Rounding may be" not in refusal:
        return False
    advice = []
    if "mitc9" in refusal:
        advice.append({"plate": {**tables["plate"], "element": "mitc9"}})
    if "correct a settlement" in refusal:
        without = [{key: value for key, value in item.items() if key != "settlement"} for item in tables["support"]]
        advice.append({"support": without})
    tries = [{**tables, **changes} for changes in advice]
    if len(advice) > 1:
        tries.append({**tables, **advice[0], **advice[1]})
    return any(_is_answered(validate(advised)) for advised in tries if advised != tables)


def _is_answered(model):
    try:
        solve(model)
    except NotCertifiedError:
        return False
    except NoEquilibriumError:
        pass
    return True


def model_of(seed):
    """Input tables of the model of a seed."""
    model = with_judge(seed)
    return random_models.model(Random(seed)) if model is None else model.tables


def show(seed):
    print(json.dumps(model_of(seed), indent=1))


if __name__ == "__main__":
    sys.exit(campaign.main(__doc__, judged, show))
