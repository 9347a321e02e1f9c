"""Random load paths that once took thousands of steps."""

import path_models

from signorini import validate
from signorini.contact.problem import contact_problem
from signorini.contact.strategy import answered
from signorini.discretise import discretise


def test_a_start_far_from_the_solution_is_left_once() -> None:
    """The Newton iteration once restarted with the first penalty again and again, until its step limit."""
    tables, *_ = path_models.drawn(7700243)
    plate = discretise(validate(tables))
    problem = contact_problem(plate)
    steps: list[object] = []
    near, far = (plate.cases["G"] + t * plate.cases["Q"] for t in (8.0, 16.0))
    start = answered(problem, near).answer
    tried = answered(problem, far, lambda *step: steps.append(step), start=start)
    assert tried.passed and tried.methods == ("active_set",) and len(steps) < 200
