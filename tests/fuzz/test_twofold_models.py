"""Random plates with two descriptions: a sample of benchmarks/random_plates.py."""

from collections import Counter
from random import Random

import door
import extreme_models
import random_models
import twofold_models

from signorini import InputError, SignoriniError, estimate, solve, validate


def test_plates_said_in_two_ways_have_one_answer() -> None:
    wrong, judged = {}, Counter()
    for seed in range(700, 752):
        model = twofold_models.twofold(Random(seed))
        try:
            result = extreme_models.solved(model.tables)
        except InputError as error:
            if found := door.words_of_the_door(error) and door.wrongly_refused(validate(model.tables), error):
                wrong[seed] = found
            continue
        judged[model.kind] += result is not None
        if found := model.judge(result):
            wrong[seed] = found
    assert wrong == {}
    assert all(judged[kind] >= 1 for kind in ("both sides", "hollow", "solid", "turned", "rounded"))


def test_the_thickness_beside_a_stiffness_is_for_the_weight_alone() -> None:
    """If the stiffness is given, deflections, extremes and half-widths do not depend on the thickness."""
    compared = 0
    for seed in range(40):
        rng = Random(seed)
        tables = random_models.model(rng)
        loads = [load for load in tables["load"] if "self_weight" not in load]
        if "stiffness" not in tables["plate"] or "zone" in tables or not loads:
            continue
        tables = {key: value for key, value in tables.items() if key not in ("combination", "moving", "solver")}
        tables["load"] = [{key: value for key, value in load.items() if key != "case"} for load in loads]
        tables["output"] = {"combinations": "each"}
        told = []
        for factor in (1.0, 0.1):
            plate = tables["plate"] | {"thickness": factor * tables["plate"]["thickness"]}
            try:
                (result,) = solve(validate(tables | {"plate": plate})).values()
            except SignoriniError:
                continue
            if result.status == "solved":
                told.append((result.deflection.tolist(), result.extremes, estimate(result).plus_minus))
        assert told[1:] == told[:-1]
        compared += len(told) == 2
        if compared == 3:
            break
    assert compared == 3
