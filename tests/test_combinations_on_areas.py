"""Combinations of plates on areas: their active sets side by side, held to what each gives when solved by itself."""

import os
import subprocess
import sys

import models
import numpy as np
import pyarrow.parquet as pq
import pytest

import signorini
from signorini import Model, contact_problem
from signorini.analysis.single import solve_one

SUPPORTS = {
    "soil": [{"name": "soil", "area": "all", "resists": "down", "stiffness": 2e3}],
    "soil and rigid points": [
        {"name": "soil", "area": {"rectangle": [0, 0, 4, 2]}, "resists": "down", "stiffness": 2e3},
        {"name": "bearings", "at": [[0.7, 3.6], [3.3, 3.6]], "resists": "down", "gap": 1e-4},
        {"name": "anchor", "at": [2, 0.3], "resists": "up", "stiffness": 1e4, "gap": 1e-3},
    ],
    "soil and a point that holds both ways": [
        {"name": "soil", "area": "all", "resists": "down", "stiffness": 2e3, "settlement": "1e-3*x"},
        {"name": "pin", "at": [1.3, 2.2]},
    ],
    "a wall and a rigid bed": [
        {"name": "wall", "edge": "left", "fix": "simple"},
        {"name": "bed", "area": {"rectangle": [2, 0, 4, 4]}, "resists": "down"},
        {"name": "line", "line": [[1, 0.5], [1, 3.5]], "resists": "down", "gap": 2e-4},
    ],
}


def tables(support, rows, **changes):
    given = {
        "material": {"E": 30e6, "nu": 0.2},
        "divisions": [6, 6],
        "support": SUPPORTS[support],
        "load": [
            {"case": "G", "pressure": 5},
            {"case": "Q", "force": 60, "at": [0.5, 0.5]},
            {"case": "P", "force": 40, "at": [3.4, 2.5]},
            {"case": "W", "pressure": -4, "area": {"rectangle": [0, 0, 4, 2]}},
        ],
        "combination": [{"generate": "table", "columns": ["G", "Q", "P", "W"], "rows": rows}],
        "probe": [{"at": [[1, 1], [3.3, 2.2]]}],
        "solver": {"method": "active_set"},
        "output": {"combinations": "table", "fields": "none"},
    }
    return models.tables(**given | changes)


def random_rows(count):
    random = np.random.default_rng(3)
    factors = np.column_stack([random.choice([1.0, 1.35], count), random.uniform(0, 1.5, (count, 3))])
    return {f"c{i}": row for i, row in enumerate(factors.tolist())}


@pytest.mark.parametrize("support", SUPPORTS)
def test_each_row_is_its_combination_solved_by_itself(tmp_path, support):
    model = Model(**tables(support, random_rows(30)))
    results = signorini.solve(model, table=tmp_path / "t.parquet")
    rows = pq.read_table(tmp_path / "t.parquet").to_pylist()
    problem = contact_problem(model)
    states = set()
    for row, combination in zip(rows, model.effective_combinations, strict=True):
        single = solve_one(problem, combination)
        assert (row["combination"], row["status"]) == (single.name, "solved")
        most = max(np.abs(s.reactions).max() for s in single.supports)
        for s in single.supports:
            assert row[f"reaction:{s.name}"] == pytest.approx(s.reaction, abs=1e-9 * most)
            assert row[f"closed:{s.name}"] == s.closed_count
        assert row["max:mx"] == pytest.approx(single.extremes["mx"].max, abs=1e-9 * np.abs(single.moment).max())
        deflection = np.abs(single.deflection).max()
        assert row["probe[2]:deflection"] == pytest.approx(single.probes[1].deflection, abs=1e-9 * deflection)
        states.add(tuple(s.closed.tobytes() for s in single.supports))
    # Beside points that hold both ways an active set now and then leaves a combination to Lemke's algorithm.
    assert len(states) > 2 and results.combined.alone <= (10 if "both" in support else 0)
    assert max(results.combined.certificate.values()) < 1e-10


def test_one_without_equilibrium_and_one_that_nearly_tips_stand_among_others(tmp_path):
    rows = random_rows(20) | {"flies": [1, 0, 0, 20], "tips": [1, 30, 0, 3.5], "stands": [1, 30, 0, 0]}
    model = Model(**tables("soil", rows))
    results = signorini.solve(model, table=tmp_path / "t.parquet")
    table = {row["combination"]: row for row in pq.read_table(tmp_path / "t.parquet").to_pylist()}
    assert set(results.unbalanced) == {name for name, row in table.items() if row["status"] != "solved"}
    assert "lifts off" in results.unbalanced["flies"] and "flies" in results.unbalanced
    stands = {c.name: c for c in model.effective_combinations}["stands"]
    single = solve_one(contact_problem(model), stands)
    assert table["stands"]["reaction:soil"] == pytest.approx(single.reactions["soil"], rel=1e-9)
    assert table["stands"]["open:soil"] == single.supports[0].open_count > 0


def test_a_batch_of_which_none_has_equilibrium_stands_before_one_that_has() -> None:
    """More than are in memory at once tip, so that none of them is left to be solved together."""
    rows = {f"c{i}": [0.0, 0.0, 0.0, 1.0 + i] for i in range(70)} | {"rests": [1.0, 0.0, 0.0, 0.0]}
    combined = signorini.solve(Model(**tables("soil", rows))).combined
    assert combined is not None and (combined.solved, len(combined.combinations)) == (1, 71)


def in_order(forward):
    rows = random_rows(40)
    return tables("soil and rigid points", {name: rows[name] for name in (rows if forward else reversed(rows))})


BITS = """
import hashlib, signorini
model = signorini.Model(
    material={"E": 30e9, "nu": 0.2},
    plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
    mesh={"divisions": [48, 48]},
    support=[{"area": "all", "resists": "down", "stiffness": 1e7}],
    load=[{"pressure": 1e3}, {"at": [9, 8.5], "force": -2e5}, {"at": [2, 3], "force": 2e6}],
)
print(hashlib.sha256(signorini.solve(model)["all"].deflection.tobytes()).hexdigest())
"""


def test_a_slab_on_soil_has_the_same_bits_on_any_number_of_threads():
    found = [
        subprocess.run(
            [sys.executable, "-c", BITS],
            check=True,
            capture_output=True,
            env={**os.environ, "RAYON_NUM_THREADS": threads},
        ).stdout
        for threads in "123"
    ]
    assert found[0] and found[0] == found[1] == found[2]


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_pressure_and_contact_area_are_columns_and_have_envelopes(method, tmp_path):
    support = "soil and rigid points" if method == "lemke" else "a wall and a rigid bed"
    rows = random_rows(100 if method == "lemke" else 14)
    model = Model(**tables(support, rows, solver={"method": method}, mesh={"divisions": [4, 4]}))
    combined = signorini.solve(model, table=tmp_path / "rows.parquet").combined
    assert combined.alone == 0
    rows = pq.read_table(tmp_path / "rows.parquet").to_pydict()
    problem = contact_problem(model)
    alone = [solve_one(problem, combination) for combination in model.effective_combinations]
    (index,) = (i for i, one in enumerate(model.support) if one.area is not None)
    name = model.support[index].name
    found = np.array([[one.supports[index].max_pressure, one.supports[index].contact_area] for one in alone])
    assert np.allclose(rows[f"max_pressure:{name}"], found[:, 0], rtol=1e-7)
    assert np.allclose(rows[f"contact_area:{name}"], found[:, 1], rtol=1e-7)
    assert np.ptp(found[:, 0]) > 0
    ends = [combined.envelope[f"{what}:{name}"] for what in ("max_pressure", "contact_area")]
    assert np.allclose([one.max for one in ends], found.max(axis=0), rtol=1e-7)
    assert np.allclose([one.min for one in ends], found.min(axis=0), rtol=1e-7)
