"""results.json of random models with every kind of result has the keys of its schema and no others."""

import tempfile
from pathlib import Path
from random import Random

import inputs
import mutations
import result_models


def test_results_of_random_models_are_valid_by_their_schema() -> None:
    faults, codes = {}, set()
    for seed in range(300, 340):
        content = mutations.toml(result_models.model(Random(seed))).encode()
        with tempfile.TemporaryDirectory() as directory:
            code, errors, wrong = inputs.ended(content, "solve", Path(directory), pictures=False)
        codes.add(code)
        if wrong:
            faults[seed] = wrong, errors
    assert faults == {}
    assert codes >= {0, 3}
