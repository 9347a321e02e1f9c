"""Methods take over from one another where one does not settle, and the result says so."""

import numpy as np
import pytest
from models import rectangular

import signorini
from signorini import Model, NotCertifiedError
from signorini.contact.problem import ContactProblem


def slab(method: str = "auto", divisions: int = 8) -> Model:
    return rectangular(
        size=[10, 6],
        thickness=0.25,
        divisions=[divisions, 5],
        support=[
            {"name": "soil", "area": "all", "resists": "down", "stiffness": 2e6, "gap": "1e-4 * x"},
            {"name": "pads", "at": [[2, 2], [8, 2], [5.13, 4.77]], "resists": "down", "gap": 5e-4},
            {"name": "anchors", "at": [[0.5, 5.5], [9.5, 5.5]], "resists": "up"},
        ],
        load=[{"pressure": 3e3}, {"force": 4e5, "at": [8.2, 1.1]}],
        solver={"method": method},
    )


@pytest.fixture
def unsettled(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Methods put in here find something that fails its certificate."""
    names: set[str] = set()

    solve = ContactProblem.solve

    def spoiled(self: ContactProblem, load, *others):
        wrong = 1.01 * load
        return solve(self, wrong if self.method in names else load, *others)

    monkeypatch.setattr(ContactProblem, "solve", spoiled)
    return names


@pytest.mark.parametrize(
    ("failing", "tried"),
    [
        ((), ("active_set",)),
        (("active_set",), ("active_set", "lemke")),
        (("active_set", "lemke"), ("active_set", "lemke", "saddle")),
    ],
)
def test_soil_is_solved_by_the_next_method(
    unsettled: set[str], failing: tuple[str, ...], tried: tuple[str, ...]
) -> None:
    by_lemke = signorini.solve(slab("lemke"))["all"]
    unsettled.update(failing)
    result = signorini.solve(slab())["all"]
    assert (*result.unsettled, result.method) == tried and result.certificate.passed
    assert np.abs(result.deflection - by_lemke.deflection).max() < 1e-9 * np.abs(by_lemke.deflection).max()


@pytest.mark.parametrize(("method", "next_one"), [("lemke", "active_set"), ("active_set", "lemke")])
def test_a_method_asked_for_by_name_is_the_first_and_the_result_says_if_another_took_over(
    unsettled: set[str], method: str, next_one: str
) -> None:
    model = slab(method, divisions=4)
    assert (signorini.solve(model)["all"].unsettled, signorini.solve(model)["all"].method) == ((), method)
    unsettled.add(method)
    result = signorini.solve(model)["all"]
    assert (result.unsettled, result.method) == ((method,), next_one)


def test_what_no_method_settles_is_refused(unsettled: set[str]) -> None:
    unsettled |= {"lemke", "active_set", "saddle"}
    with pytest.raises(NotCertifiedError, match='"all" is refused'):
        signorini.solve(slab(divisions=4))
