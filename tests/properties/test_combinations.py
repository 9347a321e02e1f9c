"""Random plates: combinations solved together equal single solves, equilibrium verdicts included."""

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from signorini import InputError, Model, NotCertifiedError
from signorini.analysis.combinations import Ways, combine
from signorini.analysis.single import solve_one
from signorini.contact.problem import contact_problem


@st.composite
def combined_models(draw, drawing):
    """A random plate whose loads are cases of their own, with some rows of factors."""
    tables = draw(drawing.models())
    loads = [{**load, "case": f"c{i}"} for i, load in enumerate(tables["load"])]
    factor = st.sampled_from([-1.5, -1.0, 0.0, 0.5, 1.0, 1.35])
    rows = draw(st.lists(st.lists(factor, min_size=len(loads), max_size=len(loads)), min_size=3, max_size=6))
    table = {
        "generate": "table",
        "columns": [load["case"] for load in loads],
        "rows": {f"r{i}": row for i, row in enumerate(rows)},
    }
    plate = tables["plate"]
    return tables | {
        "load": loads,
        "combination": [table],
        "probe": [{"at": draw(drawing.points(plate))}],
        "output": {"combinations": "table"},
        "solver": {"method": "lemke"},
    }


@settings(max_examples=50)
@given(data=st.data())
def test_a_batch_is_its_combinations_one_by_one(data, drawing, dense):
    tables = data.draw(combined_models(drawing))
    try:
        problem = contact_problem(Model(**tables))
    except InputError:
        return
    found = problem.discretisation
    twin = dense.of(problem, np.zeros(found.dof_count))
    assume(not twin.redundant)
    rows = {}

    def single(combination):
        return solve_one(problem, combination)

    def several(combinations, alone):
        raise AssertionError("Lemke's algorithm takes them as sums")

    def sink(columns):
        for name, values in columns:
            rows[name] = list(values)

    try:
        ways = Ways(problem, single, several)
        combined = combine(found, lambda first: ways, lambda _: None, sink)
        singles = [single(combination) for combination in combined.combinations]
    except (InputError, NotCertifiedError):  # A load may be so near an outline that only a finer mesh holds it.
        assume(False)
    assert [s == "solved" for s in rows["status"]] == [r.status == "solved" for r in singles]
    for row, result in enumerate(singles):
        if result.status != "solved" or not twin.pins(_all_reactions(problem, result, combined.combinations[row])):
            continue
        size = max((np.abs(support.reactions).max(initial=0) for support in result.supports), default=0.0)
        # Reactions of supports that carry almost no load are rounding of the load.
        load = np.abs(found.load(combined.combinations[row]).nodal).max()
        for support in result.supports:
            # Reactions of supports that nearly repeat each other are determined only as far as these differ.
            exact = 1e-9 * max(1.0, 1e-2 / _difference(twin))
            assert abs(rows[f"reaction:{support.name}"][row] - support.reaction) <= exact * max(size, load)
        length = twin.length(result.deflection)
        (probe,) = result.probes
        assert abs(rows["probe[1]:deflection"][row] - probe.deflection) <= 1e-9 * length
        field, largest = result.fields["mx"], result.extremes["mx"].max
        assert abs(rows["max:mx"][row] - largest) <= 1e-8 * max(np.abs(field).max(), load)


def _difference(twin):
    """Smallest singular value of the rigid points' rows, each of unit size: 0 where they repeat each other."""
    rigid = twin.G[twin.compliance == 0] / np.sqrt(np.diag(twin.K).clip(1e-12))
    if not len(rigid):
        return 1.0
    return np.linalg.svd(rigid / np.linalg.norm(rigid, axis=1)[:, None], compute_uv=False)[-1]


def _all_reactions(problem, result, combination):
    """Reactions of every contact point."""
    answer = problem.solve(problem.discretisation.load(combination))
    return answer.reaction
