"""Wrong arguments in Python are refused in words, as wrong input is; none ends in a traceback of another kind."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from models import rectangular

import signorini
from signorini import InputError, Model, contact_problem, path, solve

NAN = float("nan")
POINTS = "it must be a point [x, y] or a sequence of points"
MODEL = "it must be a Model. Make one with signorini.Model(...) or signorini.load(file)."


@pytest.fixture(scope="module")
def slab() -> SimpleNamespace:
    model = rectangular(
        divisions=[2, 2],
        support=[
            {"name": "soil", "area": "all", "resists": "down", "stiffness": 1e7},
            {"at": [1, 1], "resists": "down"},
        ],
        load=[{"case": "G", "pressure": 5e3}, {"case": "Q", "force": 1e3, "at": [1, 1]}],
    )
    problem = contact_problem(model)
    return SimpleNamespace(
        model=model,
        results=(results := solve(model)),
        result=results["all"],
        widths=signorini.estimate(results),
        path=path(model, "G", "Q", until=2),
        problem=problem,
        load=problem.load("all"),
    )


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s: s.result.probe([(1, 2, 3)]), f"points: found [(1, 2, 3)]; {POINTS}"),
        (lambda s: s.result.probe([(1, 2), (1,)]), f"points: found [(1, 2), (1,)]; {POINTS}"),
        (lambda s: s.result.probe([NAN, 1]), "The point [nan, 1] is not on the plate"),
        (lambda s: s.result.pressure([1j, 1]), f"points: found [1j, 1]; {POINTS}"),
        (lambda s: s.result.plot("zz"), "field: Unknown field 'zz'. This result has: deflection, m1"),
        (lambda s: s.result.plot(3), "field: found 3; it must be the name of a field"),
        (lambda s: s.result.plot(ax=3), "ax: found 3; it must be axes of matplotlib"),
        (lambda s: s.result.plot(limits=5), "limits: found 5; it must be two finite numbers, the lower one first"),
        (lambda s: s.result.plot(limits=(2, NAN)), "limits: found (2, nan); it must be two finite numbers"),
        (lambda s: s.result.to_vtk(None), "path: found None; it must be the path of a file"),
        (lambda s: signorini.write(s.results, None), "directory: found None; it must be the path of a directory"),
        (lambda s: signorini.write(s.path, 3), "directory: found 3; it must be the path of a directory"),
        (lambda s: path(3, "G", "Q"), f"model: found 3; {MODEL}"),
        (lambda s: path(s.model, 3, "Q"), "start: found 3; it must be the name of a load case or combination"),
        (lambda s: path(s.model, "G", None), "add: found None; it must be the name of the load that grows"),
        (lambda s: path(s.model, "G", "Q", until="3"), "until: found '3'; it must be a number"),
        (lambda s: path(s.model, "G", "Q", until=True), "until: found True; it must be a number"),
        (
            lambda s: signorini.lemke([[1.0]], np.array([-1j])),
            "q: found array([-0.-1.j]); it must be an array of numbers",
        ),
        (lambda s: path(s.model, "G", "Q", until=10**400), "until: found inf; it must be a finite number"),
        (lambda s: s.path.at("x"), "t: found 'x'; it must be a number"),
        (lambda s: s.path.at(NAN), "t is nan; the path goes from 0 to 2"),
        (lambda s: s.problem.load("zz"), "combination: Unknown combination 'zz'. This model has: all."),
        (lambda s: s.problem.lcp(s.load * NAN), "load: found nan at index 0; all numbers must be finite"),
        (lambda s: s.problem.lcp(s.load[:3]), "load: found an array of shape (3,); it must be 63 numbers, one per dof"),
        (lambda s: s.problem.lcp(s.load, "zz"), "form: Unknown form 'zz'. The LCP has: auto, dual, stiffness."),
        (lambda s: s.problem.by("zz"), "method: Unknown method 'zz'."),
        (lambda s: s.problem.solve(s.load), "it must be a CaseLoad. Take discretisation.load(combination)"),
        (
            lambda s: s.problem.solve(s.problem.discretisation.cases["G"], start=3),
            "start: found 3; it must be a Answer.",
        ),
        (
            lambda s: s.problem.by("active_set").solve(
                s.problem.discretisation.cases["G"], start=s.problem.solve(s.problem.discretisation.cases["G"])
            ),
            "start: The solution to begin with is of another problem.",
        ),
        (lambda s: solve(3), f"model: found 3; {MODEL}"),
        (
            lambda s: contact_problem({}),
            "model: found {}; it must be a Model. Make a Model from the mapping first: signorini.validate(mapping).",
        ),
        (lambda s: signorini.load(3), "path: found 3; it must be the path of an input file"),
        (lambda s: signorini.validate(None), "found no value; it must be a table"),
        (lambda s: Model(foo=3), "plate: 'plate' is missing"),
        (lambda s: Model({}), "Model: found {}; a table takes its keys by name, as in Model(key=value, ...)"),
        (lambda s: solve(s.model, progress=3), "progress: found 3; it must be a function that takes a Progress"),
        (lambda s: s.results["zz"], "combination: Unknown combination 'zz'. This mapping of results has: all."),
        (lambda s: s.results["all"].reactions["soill"], "support: Unknown support 'soill'. This result has: soil,"),
        (lambda s: s.results["all"].fields["mxx"], "field: Unknown field 'mxx'. This result has: "),
        (lambda s: s.results["all"].extremes[0], "field: found 0; it must be the name of a field"),
        (lambda s: s.results.limits["zz"], "combination: Unknown combination 'zz'. This mapping of limits has: all."),
        (lambda s: s.results.table["reaction:soill"], "column: Unknown column 'reaction:soill'. This table has"),
        (lambda s: s.widths.half_width("reaction:soill", 0), "column: Unknown column 'reaction:soill'. This table of"),
        (lambda s: s.widths.half_width("reaction:soil", "zz"), "combination: Unknown combination 'zz'."),
        (lambda s: s.widths.half_width("reaction:soil", 1), "row: found 1; it must be the number of a combination, 0"),
        (lambda s: s.results[3], "combination: found 3; it must be the name of a combination"),
        (lambda s: s.path.words(99), "index: found 99; it must be the number of a stop, 0 to"),
    ],
)
def test_wrong_arguments_are_refused_in_words(slab: SimpleNamespace, call, message: str) -> None:
    with np.errstate(invalid="ignore"), pytest.raises(InputError, match=re.escape(message)):
        call(slab)


def test_results_are_a_mapping_all_the_same(slab: SimpleNamespace) -> None:
    assert "zz" not in slab.results and slab.results.get("zz") is None and "all" in slab.results
    with pytest.raises(KeyError):
        slab.results["zz"]


def test_no_points_have_no_results(slab: SimpleNamespace) -> None:
    assert slab.result.probe([]) == [] and slab.result.probe(np.zeros((0, 2))) == []
    assert slab.result.pressure([]).shape == (0,)


def test_a_load_may_be_any_sequence_of_numbers(slab: SimpleNamespace) -> None:
    wanted = slab.problem.lcp(slab.load)
    for load in (slab.load.tolist(), np.repeat(slab.load, 2)[::2]):
        assert np.array_equal(slab.problem.lcp(load).q, wanted.q)
    assert slab.problem.lcp(np.zeros(63, int)).q.shape == wanted.q.shape
    assert slab.path.at(np.array(1)).name == slab.path.at(1.0).name
