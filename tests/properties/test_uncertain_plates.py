"""The message of a failure on several plates."""

import signorini
from signorini.contact.strategy import uncertain


def test_a_failure_on_two_plates_names_its_remedy() -> None:
    plate = {"shape": "rectangle", "size": [2.0, 2.0], "thickness": 0.2, "element": "q8r"}
    model = signorini.Model(
        material={"E": 30e9, "nu": 0.2},
        plates={"a": plate, "b": plate},
        mesh={"size": 1.0},
        support=[{"plate": "a", "area": "all", "stiffness": 1e7}, {"plate": "b", "area": "all", "stiffness": 1e7}],
        load=[{"plate": "a", "pressure": 1e3}],
    )
    assert "mitc9" in uncertain(signorini.contact_problem(model).discretisation)
