"""Models and results are pickled from one process to another, equal to the last bit."""

import copy
import dataclasses
import multiprocessing
import pickle
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest
from models import rectangular

import signorini
from signorini import _core
from signorini.discretise import discretise

SECONDS = 120


def model(**changes: object) -> signorini.Model:
    data = {
        "title": "Slab",
        "material": {"E": 30e6, "nu": 0.2, "unit_weight": 25},
        "thickness": "0.2 + 0.01*x",
        "divisions": [6, 6],
        "support": [
            {"name": "feet", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"},
            {"name": "soil", "area": {"circle": {"center": [2, 2], "radius": 1}}, "resists": "down", "stiffness": 1e4},
        ],
        "load": [{"case": "G", "self_weight": True}, {"case": "Q", "force": 20, "at": [4, 2]}],
        "probe": [{"at": [2.2, 2.1]}],
    }
    return rectangular(**data | changes)


TABLE = model(
    combination=[
        {"generate": "patterns", "permanent": {"G": [1, 1.35]}, "variable": {"Q": [0.1 * i for i in range(1, 9)]}}
    ]
)
COPIES: dict[str, Callable[[object], object]] = {
    "pickle 4": lambda thing: pickle.loads(pickle.dumps(thing, 4)),
    "pickle 5": lambda thing: pickle.loads(pickle.dumps(thing, 5)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}


def numbers(thing: object, place: str = "") -> Iterator[tuple[str, object]]:
    """Every number and word that a result is made of, floats as bytes."""
    if isinstance(thing, np.ndarray):
        yield place, (thing.dtype, thing.shape, thing.tobytes())
    elif isinstance(thing, signorini.Model | str | int | None):
        yield place, thing
    elif isinstance(thing, float):
        yield place, np.float64(thing).tobytes()
    elif dataclasses.is_dataclass(thing):
        for field in dataclasses.fields(thing):
            yield from numbers(getattr(thing, field.name), f"{place}.{field.name}")
    elif isinstance(thing, Mapping):
        for name, part in thing.items():
            yield from numbers(part, f"{place}[{name}]")
    elif isinstance(thing, tuple | list):
        for index, part in enumerate(thing):
            yield from numbers(part, f"{place}[{index}]")


@pytest.fixture(scope="module")
def things() -> dict[str, object]:
    results = signorini.solve(model())
    path = signorini.path(model(), start="G", add="Q", until=3.0, events="all")
    return {
        "model": model(),
        "table of combinations": TABLE,
        "results": results,
        "result": results["all"],
        "without equilibrium": signorini.solve(
            model(
                support=[model().support[0]], combination=[{"name": "up", "factors": {"G": -1}}, {"factors": {"G": 1}}]
            )
        )["up"],
        "support": results["all"].supports[1],
        "envelopes": signorini.solve(TABLE),
        "path": path,
        "segment": path.segments[0],
        "stop": path.stops[-1],
        "discretisation": discretise(model()),
        "problem": signorini.contact_problem(model()),
        "mesh": results["all"].mesh,
        "progress": signorini.Progress(),
    }


@pytest.mark.parametrize("how", COPIES)
def test_copies_say_the_same_to_the_last_bit(things: dict[str, object], how: str) -> None:
    for name, thing in things.items():
        again = COPIES[how](thing)
        assert type(again) is type(thing)
        assert list(numbers(again)) == list(numbers(thing)), name


@pytest.mark.parametrize("how", COPIES)
def test_what_is_asked_of_copies_is_answered_alike(things: dict[str, object], how: str, tmp_path: Path) -> None:
    result, path, problem = (things[name] for name in ("result", "path", "problem"))
    again = [COPIES[how](thing) for thing in (result, path, problem)]
    points = [(2.3, 1.9), (0.5, 3.5)]
    for one, other in zip(result.probe(points), again[0].probe(points), strict=True):
        assert list(numbers(one)) == list(numbers(other))
    assert result.pressure(points).tobytes() == again[0].pressure(points).tobytes()
    for field in ("mx", "pressure"):
        again[0].plot(field)
    for name, thing in (("one.vtu", result), ("other.vtu", again[0])):
        thing.to_vtk(tmp_path / name)
    assert (tmp_path / "one.vtu").read_bytes() == (tmp_path / "other.vtu").read_bytes()
    assert signorini.estimate(again[0]).plus_minus == signorini.estimate(result).plus_minus
    assert again[0]._repr_html_() == result._repr_html_()
    skipped = {".seconds"}
    at = [dict(numbers(thing.at(0.7))) for thing in (path, again[1])]
    assert {k: v for k, v in at[0].items() if k not in skipped} == {k: v for k, v in at[1].items() if k not in skipped}
    again[1].plot()
    load = problem.load("all")
    for one, other in zip(problem.lcp(load, "stiffness"), again[2].lcp(load, "stiffness"), strict=True):
        assert one.tobytes() == other.tobytes()
    for one in (result, again[0], path.at(0.7)):
        for array in (one.mesh.points, one.deflection, one.moment, one.fields["mx"], one.supports[0].reactions):
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 0.0


def test_a_pickled_result_holds_its_fields_and_no_factor() -> None:
    result = signorini.solve(model(mesh={"divisions": [40, 40]}))["all"]
    problem = signorini.contact_problem(model(mesh={"divisions": [40, 40]}))
    # 9 fields, the thickness, 2 coordinates a node; 8 nodes an element; the area's deflection, and its points.
    expected = 8 * (13 * result.mesh.node_count + 8 * len(result.mesh.elements))
    before = len(pickle.dumps(result))
    result.plot("pressure")
    assert expected < before == len(pickle.dumps(result)) < 1.6 * expected < 8 * problem.core.factor_entries


@pytest.mark.parametrize("start", ["spawn", "fork"])
@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
def test_models_are_solved_in_other_processes(start: str) -> None:
    if start not in multiprocessing.get_all_start_methods():
        pytest.skip(f"there is no {start} here")
    models = [model(load=[{"pressure": load}]) for load in (3.0, 5.0, 7.0)]
    with multiprocessing.get_context(start).Pool(2) as pool:
        there = pool.map_async(signorini.solve, models).get(timeout=SECONDS)
        problems = pool.map_async(signorini.contact_problem, models[:1]).get(timeout=SECONDS)
        failed = pool.apply_async(signorini.solve, [model(support=[{"at": [1, 1], "resists": "down"}])])
        with pytest.raises(signorini.InputError, match="Nothing holds the plate") as caught:
            failed.get(timeout=SECONDS)
    assert caught.value.place == "support"
    for here, results in zip(map(signorini.solve, models), there, strict=True):
        of = [{k: v for k, v in numbers(found["all"]) if k != ".seconds"} for found in (here, results)]
        assert of[0] == of[1]
    P, s = problems[0].lcp(problems[0].load("all"))[:2]
    assert np.isfinite(_core.lemke(P, s).z).all()
