"""Refusals name what is to blame, and what they advise works."""

import re
from importlib import import_module

import pytest
from models import rectangular

import signorini
from signorini import Model
from signorini.contact.certificate import Certificate
from signorini.contact.problem import contact_problem
from signorini.contact.refusal import refusal
from signorini.errors import InputError, NotCertifiedError


def on_soft_edges(stiffness: float) -> Model:
    """A thin plate on two elastic edges, of that stiffness in all."""
    return rectangular(
        size=[10, 10],
        thickness=0.002,
        divisions=[5, 7],
        support=[
            {"name": "soft", "edge": ["left", "bottom"], "stiffness": stiffness / 20},
            {"edge": "right", "fix": "symmetry"},
        ],
        load=[{"pressure": 1e3}],
    )


@pytest.mark.parametrize("stiffness", [2e-8, 2e-7, 2.1e-7, 1e-6])
def test_the_stiffness_advised_for_a_support_that_is_too_soft_is_enough(stiffness: float) -> None:
    with pytest.raises((InputError, NotCertifiedError), match="The stiffness of soft") as refused:
        signorini.solve(on_soft_edges(stiffness))
    advised = re.search(r"at least (\S+) in all", str(refused.value))
    assert advised and float(advised[1]) >= 10 * stiffness
    assert signorini.solve(on_soft_edges(float(advised[1])))["all"].certificate.passed


def on_a_soft_bed(part: float) -> Model:
    """A plate held on its left and on a bed, of that part of the plate's stiffness in all; curvature and weight."""
    return rectangular(
        material={"E": 30e9, "nu": 0.2, "unit_weight": 25e3},
        size=[10, 10],
        thickness=0.3,
        divisions=[5, 5],
        support=[
            {"edge": "left", "fix": "simple"},
            {"name": "bed", "area": "all", "resists": "down", "stiffness": part * 30e9 * 0.3**3 / 12 / 10**4},
        ],
        load=[{"curvature": [1e-4, 0, 0]}, {"self_weight": True}],
    )


def said_of(certificate: Certificate, part: float) -> str:
    problem = contact_problem(on_a_soft_bed(part))
    load = problem.discretisation.cases["load"]
    return refusal("all", problem.discretisation, load, problem.solve(load), certificate)


def test_a_refusal_speaks_of_curvature_only_where_all_else_passed() -> None:
    lost = Certificate(0.0, 0.0, 0.0, 0.0, 0.0, lost=0.4)
    failed = Certificate(0.0, 0.0, 0.0, equilibrium=29.0, balance=0.4, lost=0.4)
    assert "stress-free curvature" in said_of(lost, 1e-5) and "of bed" not in said_of(lost, 1e-5)
    assert "stress-free curvature" not in said_of(failed, 1e-5) and "The stiffness of bed" in said_of(failed, 1e-5)


def test_a_path_without_an_answer_names_the_soft_support(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(import_module("signorini.analysis.exact_path"), "_trace", lambda *_: None)
    with pytest.raises(NotCertifiedError, match="The stiffness of bed"):
        signorini.path(on_a_soft_bed(1e-5), start=None, add="load", events="all")
