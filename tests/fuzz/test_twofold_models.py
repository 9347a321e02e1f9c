"""Random plates said in two ways: a sample of benchmarks/random_plates.py."""

from collections import Counter
from random import Random

import extreme_models
import twofold_models

from signorini import InputError


def test_plates_said_in_two_ways_have_one_answer() -> None:
    wrong, judged = {}, Counter()
    for seed in range(700, 728):
        model = twofold_models.twofold(Random(seed))
        try:
            result = extreme_models.solved(model.tables)
        except InputError:
            continue
        judged[model.kind] += result is not None
        if found := model.judge(result):
            wrong[seed] = found
    assert wrong == {}
    assert all(judged[kind] >= 1 for kind in ("both sides", "hollow", "solid", "turned"))
