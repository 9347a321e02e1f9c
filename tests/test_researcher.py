"""The contact problem as arrays, as a researcher takes it: stated, changed, solved by others and certified."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from models import rectangular

import signorini
from signorini import InputError, Model, NotCertifiedError, _core, contact_problem, lemke, recover, solve, with_rows

CLAMPED = {"edge": "left", "fix": "clamped"}
PROPS = {"name": "props", "at": [[4, 0], [3.7, 2.8], [2.1, 1.4]], "resists": "down", "gap": 1e-4, "settlement": 2e-4}
STRUT = {"at": [3.9, 0.3], "settlement": 1e-4}
ANCHOR = {"at": [[1.2, 0.4]], "resists": "up", "gap": 1e-5, "settlement": -3e-5, "stiffness": 1e7}
BED = {"area": "all", "resists": "down", "stiffness": 1e6}


def model(*support: dict, **changes: object) -> Model:
    data = {
        "size": [4, 3],
        "divisions": [8, 6],
        "support": support,
        "load": [{"pressure": 5e3}, {"force": 50e3, "at": [0.7, 0.9]}],
    }
    return rectangular(**data | changes)


@pytest.fixture
def factored(monkeypatch: pytest.MonkeyPatch) -> Callable[[], int]:
    """Count the factorizations since it was last asked."""
    real, made = _core.ContactProblem, []

    def factor(*arguments: object, **room: int | None) -> _core.ContactProblem:
        made.append(arguments)
        return real(*arguments, **room)

    monkeypatch.setattr(_core, "ContactProblem", factor)

    def since() -> int:
        count = len(made)
        made.clear()
        return count

    return since


@pytest.mark.parametrize(
    ("support", "method", "for_lcp", "for_dual"),
    [
        ([CLAMPED, PROPS], "auto", 0, 0),
        # The factor of the solve carries springs, or leaves two-sided points out of the LCP: K alone has its own.
        ([CLAMPED, PROPS, ANCHOR], "auto", 0, 1),
        ([CLAMPED, PROPS, STRUT], "auto", 0, 1),
        ([CLAMPED, BED], "active_set", 1, 1),
    ],
)
def test_nothing_is_factored_twice(
    support: list[dict], method: str, for_lcp: int, for_dual: int, factored: Callable[[], int]
) -> None:
    posed = model(*support, solver={"method": method})
    solve(posed)
    assert factored() == 1
    problem = contact_problem(posed)
    problem.solve(problem.discretisation.cases["load"])
    assert factored() == 1
    load = problem.load("all")
    problem.lcp(load)
    assert factored() == for_lcp
    problem.dual(load)
    assert factored() == for_dual
    for again in (problem, problem.near(load), problem.by("lemke"), problem.by(problem.method)):
        again.lcp(load)
        again.dual(2 * load)
        again.free(load)
        again.solve(problem.discretisation.cases["load"])
    assert factored() == 0


def test_travel_and_settlement_and_points_that_hold_both_ways_are_told_apart() -> None:
    problem = contact_problem(model(CLAMPED, PROPS, STRUT, ANCHOR))
    assert problem.two_sided.tolist() == [False, False, False, True, False]
    assert problem.settlements == pytest.approx([2e-4, 2e-4, 2e-4, 1e-4, 3e-5])
    assert problem.gaps - problem.settlements == pytest.approx([1e-4, 1e-4, 1e-4, 0, 1e-5])
    assert problem.compliance == pytest.approx([0, 0, 0, 0, 1e-7])
    assert problem.positions[3].tolist() == [3.9, 0.3]


def test_dofs_are_ordered_as_documented() -> None:
    problem = contact_problem(model({**CLAMPED, "settlement": 1e-3, "rotation": [2e-3, "3e-3*y"]}, PROPS))
    x, y = problem.mesh.points.T
    left = x == 0
    assert np.array_equal(problem.held.reshape(-1, 3), np.repeat(left[:, None], 3, axis=1))
    wanted = np.where(left, [np.full_like(x, 1e-3), np.full_like(x, 2e-3), 3e-3 * y], 0.0)
    assert pytest.approx(wanted, abs=1e-18) == problem.held_values.reshape(-1, 3).T
    assert (problem.frames == [1, 0]).all()
    plane = np.column_stack([1 + 2 * x - 3 * y, np.full_like(x, 2), np.full_like(x, -3)]).ravel()
    assert np.abs(problem.K @ plane).max() < 1e-9 * abs(problem.K).max()
    at = [[0.3, 1.1], [4, 3]]
    for of, values in (("w", [1 + 0.6 - 3.3, 0]), ("θx", [2, 2]), ("θy", [-3, -3])):
        assert problem.rows_at(at, of) @ plane == pytest.approx(values, abs=1e-12)


def test_frames_of_an_edge_askew_have_their_first_slope_across_it() -> None:
    sector = {"shape": "annulus", "inner": 1, "outer": 2, "sector": 60, "thickness": 0.2}
    supports = [{"edge": ["start", "end"], "fix": "symmetry"}, {"edge": "inner", "fix": "simple"}]
    problem = contact_problem(model(*supports, plate=sector, load=[{"pressure": 5e3}]))
    x, y = problem.mesh.points.T
    end = np.isclose(np.degrees(np.arctan2(y, x)), 60)
    assert end.sum() > 5
    across = problem.frames[end] @ [-np.sin(np.pi / 3), np.cos(np.pi / 3)]
    assert np.abs(across) == pytest.approx(1)
    assert problem.held.reshape(-1, 3)[end, 1].all() and not problem.held.reshape(-1, 3)[end, 2].any()
    result = solve(problem.discretisation.model)["all"]
    c, s = problem.frames.T
    slopes = np.column_stack([c * result.rotation[:, 0] + s * result.rotation[:, 1], c * result.rotation[:, 1]])
    assert np.abs(slopes[end, 0]).max() < 1e-12 * np.abs(result.rotation).max()


def test_a_sweep_keeps_the_mesh_and_is_the_same_as_each_of_its_models_alone() -> None:
    first = contact_problem(model(CLAMPED, PROPS))
    for changes in (
        {"support": [CLAMPED, {**PROPS, "gap": 3e-4, "stiffness": 1e8}]},
        {"load": [{"pressure": 1e4}]},
        {"material": {"E": 10e9, "nu": 0.3}, "plate": {"shape": "rectangle", "size": [4, 3], "thickness": 0.3}},
    ):
        posed = model(**{"support": [CLAMPED, PROPS], **changes})
        swept, alone = first.with_model(posed), contact_problem(posed)
        assert swept.mesh is first.mesh
        assert (swept.G != first.G).nnz == 0
        assert np.array_equal(swept.dual(swept.load("all"))[0], alone.dual(alone.load("all"))[0])
        assert np.array_equal(swept.dual(swept.load("all"))[1], alone.dual(alone.load("all"))[1])


def test_a_sweep_to_another_outline_is_refused() -> None:
    wider = model(CLAMPED, PROPS, plate={"shape": "rectangle", "size": [5, 3], "thickness": 0.2})
    with pytest.raises(InputError, match="plate: found another outline"):
        contact_problem(model(CLAMPED, PROPS)).with_model(wider)


def test_gaps_and_loads_of_a_sweep_change_s_as_documented() -> None:
    near, far = (contact_problem(model(CLAMPED, {**PROPS, "gap": gap})) for gap in (1e-4, 5e-4))
    P, s = near.dual(near.load("all"))
    other, t = far.dual(far.load("all"))
    assert np.array_equal(P, other)
    assert t == pytest.approx(s - (far.gaps - near.gaps), abs=1e-12 * np.abs(s).max())


# --- reactions of one's own ---


def answered(problem: signorini.ContactProblem) -> np.ndarray:
    return problem.solve(problem.discretisation.cases["load"]).reaction


def test_reactions_that_miss_by_little_are_refined() -> None:
    posed = model(CLAMPED, PROPS, STRUT, ANCHOR)
    problem, wanted = contact_problem(posed), solve(posed)["all"]
    exact = answered(problem)
    noise = 1e-8 * np.abs(exact).max() * np.array([1, -1, 0.3, 1, -0.2])
    found = recover(problem, "all", exact + np.where(exact > 0, noise, -np.abs(noise)))
    assert np.array_equal(found.deflection, wanted.deflection)
    assert found.reactions == pytest.approx(wanted.reactions, rel=1e-12)
    assert found.method == "given" and found.certificate.passed


def test_a_nodal_load_of_ones_own_is_as_good_as_a_combination() -> None:
    problem = contact_problem(model(CLAMPED, PROPS))
    by_name, by_array = (recover(problem, load, answered(problem)) for load in ("all", problem.load("all")))
    assert np.array_equal(by_name.deflection, by_array.deflection)


WRONG: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "a hundredth of one too much": lambda exact: np.where(np.arange(len(exact)) == exact.argmax(), 1.01, 1) * exact,
    "none": np.zeros_like,
    "one left out": lambda exact: np.where(np.arange(len(exact)) == exact.argmax(), 0, exact),
    "pulling": lambda exact: -exact,
    "one too many": lambda exact: np.where(exact == 0, 1e-3 * exact.max(), exact),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_reactions_that_are_not_the_answer_are_refused(wrong: str) -> None:
    problem = contact_problem(model(CLAMPED, PROPS, {"at": [4, 1.5], "resists": "up", "gap": 1e-3}))
    exact = answered(problem)
    assert (exact == 0).any() and (exact > 0).any()
    with pytest.raises(NotCertifiedError, match="These reactions are not the answer"):
        recover(problem, "all", WRONG[wrong](exact))


def test_a_contact_set_that_holds_nothing_is_refused() -> None:
    problem = contact_problem(model({"at": [[1, 1], [3, 1], [3, 2], [1, 2]], "resists": "down"}))
    with pytest.raises(NotCertifiedError, match="the rows that push do not hold the plate"):
        recover(problem, "all", [1e4, 0, 0, 0])


def test_points_that_would_be_passed_are_named() -> None:
    problem = contact_problem(model(CLAMPED, PROPS))
    with pytest.raises(NotCertifiedError, match=r"row \d at \[.*\] would be passed by [\d.e-]+\."):
        recover(problem, "all", np.zeros(3))


# --- rows of one's own ---


@pytest.fixture(scope="module")
def both() -> Iterator[tuple[signorini.ContactProblem, signorini.RowProblem]]:
    """The same question with supports of the model, and with their rows given by hand behind the first one's."""
    whole = contact_problem(model(CLAMPED, PROPS, STRUT, ANCHOR))
    part = contact_problem(model(CLAMPED, {**PROPS, "at": PROPS["at"][:1]}))
    rest = slice(1, None)
    yield (
        whole,
        with_rows(part, whole.G[rest], whole.gaps[rest], whole.two_sided[rest], whole.compliance[rest]),
    )


def test_rows_of_ones_own_state_the_problem_that_supports_do(both: tuple) -> None:
    whole, own = both
    load = whole.load("all")
    (P, s), (Q, t) = whole.dual(load), own.dual(load)
    assert pytest.approx(P, abs=1e-10 * P.max()) == Q
    assert t == pytest.approx(s, abs=1e-10 * np.abs(s).max())
    assert (own.G != whole.G).nnz == 0
    assert np.array_equal(own.gaps, whole.gaps) and np.array_equal(own.two_sided, whole.two_sided)


def test_rows_of_ones_own_have_the_answer_that_supports_have(both: tuple) -> None:
    whole, own = both
    reactions = own.solve(whole.load("all"))
    assert reactions == pytest.approx(answered(whole), abs=1e-9 * reactions.max())
    wanted = solve(whole.discretisation.model)["all"]
    found = recover(own, "all", reactions)
    assert found.deflection == pytest.approx(wanted.deflection, abs=1e-10 * wanted.deflection.max())
    assert found.moment == pytest.approx(wanted.moment, abs=1e-9 * np.abs(wanted.moment).max())
    assert found.certificate.passed


def test_a_row_may_couple_dofs_far_apart() -> None:
    """Two free corners that may not part by more than a gap, as a tie between them would have it; checked densely."""
    problem = contact_problem(model(CLAMPED, load=[{"force": 50e3, "at": [4, 0]}]))
    row = problem.rows_at([4, 0]) - problem.rows_at([4, 3])
    free = problem.rows_at([4, 0]) @ problem.free(problem.load("all"))
    tied = with_rows(problem, row, [0.2 * free[0]])
    reaction = tied.solve(problem.load("all"))
    g, open_dofs = row.toarray()[0], ~problem.held
    K, f = problem.K.toarray()[np.ix_(open_dofs, open_dofs)], problem.load("all")[open_dofs]
    system = np.block([[K, g[open_dofs, None]], [g[None, open_dofs], np.zeros((1, 1))]])
    wanted = np.linalg.solve(system, np.append(f, 0.2 * free[0]))
    assert reaction == pytest.approx(wanted[-1:], rel=1e-9)
    assert recover(tied, "all", reaction).deflection.max() == pytest.approx(wanted[:-1].max(), rel=1e-3)


def test_rows_by_lemke_of_the_stated_dual() -> None:
    problem = contact_problem(model(CLAMPED))
    tied = with_rows(problem, problem.rows_at([[4, 0], [4, 3]]), [1e-4, 1e-4])
    P, s = tied.dual(problem.load("all"))
    assert tied.solve(problem.load("all")) == pytest.approx(lemke(P, -s).z, rel=1e-12)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"G": np.ones((1, 4))}, r"G: found an array of shape \(1, 4\); it must have 519 columns"),
        ({"gaps": [1, 2]}, "gaps: found 2 numbers; they must be 1"),
        ({"gaps": [np.nan]}, "gaps: .* finite"),
        ({"flexibility": [-1]}, "flexibility: found -1"),
        ({"two_sided": [1]}, "two_sided: found an array of int64"),
        ({"G": np.zeros((1, 519))}, "G: row 0 acts on held dofs alone"),
    ],
)
def test_rows_that_make_no_sense_are_refused(keys: dict, message: str) -> None:
    problem = contact_problem(model(CLAMPED))
    assert problem.K.shape == (519, 519)
    with pytest.raises(InputError, match=message):
        with_rows(problem, **{"G": problem.rows_at([4, 0]), "gaps": [0.0], **keys})


def test_rows_that_contradict_or_repeat_each_other_are_refused() -> None:
    problem = contact_problem(model(CLAMPED))
    row, load = problem.rows_at([4, 0]).toarray(), problem.load("all")
    with pytest.raises(InputError, match="contradict each other"):
        with_rows(problem, np.vstack([row, -row]), [-1e-3, -1e-3]).solve(load)
    with pytest.raises(InputError, match="repeat each other"):
        with_rows(problem, np.vstack([row, row]), [0, 0], [True, True]).solve(load)


def test_rows_need_a_plate_that_is_held_without_them() -> None:
    problem = contact_problem(model({"at": [[1, 1], [3, 1], [3, 2], [1, 2]], "resists": "down"}))
    with pytest.raises(signorini.SignoriniError, match="need K to be regular"):
        with_rows(problem, problem.rows_at([2, 2]), [0.0])
