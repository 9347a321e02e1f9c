"""Refusals name the cause."""

from models import rectangular

from signorini import Model
from signorini.contact.certificate import Certificate
from signorini.contact.problem import contact_problem
from signorini.contact.strategy import refusal


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
    assert "stress-free curvature" in said_of(lost, 1e-5)
    assert "stress-free curvature" not in said_of(failed, 1e-5)
