"""Why an answer is refused: the figure that fails, what arithmetic has to do with it, and what would help."""

from __future__ import annotations

import numpy as np

from signorini.answer import Answer
from signorini.certificate import CERTIFIABLE, Certificate, forces_at_nodes
from signorini.discretise import Discretisation
from signorini.slenderness import of_shape
from signorini.softness import softest


def refusal(name: str, found: Discretisation, answer: Answer, certificate: Certificate) -> str:
    """Say why the answer of a load of that name is refused, and what to do.

    Examples
    --------
    >>> from signorini import Model
    >>> from signorini.certificate import certify
    >>> from signorini.problem import contact_problem
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4000, 1], "thickness": 0.2},
    ...     mesh={"divisions": [1, 1]},
    ...     support=[{"edge": ["left"], "fix": "clamped"}],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> problem = contact_problem(model)
    >>> found, load = problem.discretisation, problem.discretisation.cases["load"]
    >>> answer = problem.solve(load)
    >>> wrong = certify(found, load, 2 * answer.hi, answer.lo, answer.reaction)
    >>> print(refusal("all", found, answer, wrong).partition("Double precision ")[2])
    cannot tell bending of the element at [2000, 0.5], whose sides are 4000 and 1 (4000 to 1) at a thickness of 0.2: \
bending across it is stiffer by the fourth power of that ratio. Take elements at most 1000 times as long as they are \
wide: 4 times as many along their longer sides, or fewer across; or calculate a beam.
    """
    soft = softest(found)
    why = of_shape(found) or (soft.why if soft else _of_supports(found, answer))
    vain = ""
    if certificate.rounding > CERTIFIABLE:
        vain = (
            f" Rounding may be {certificate.rounding:.0e} of the forces that act; over {CERTIFIABLE:g} of them it "
            "certifies nothing."
        )
    return f'"{name}" is refused, its certificate {certificate}.{vain}{" " if why else ""}{why}'


def _of_supports(found: Discretisation, answer: Answer) -> str:
    """Say that supports push against each other, where their forces outweigh those in the plate."""
    internal, pushes = forces_at_nodes(found, answer.hi, answer.lo, answer.reaction)
    if not pushes > internal:
        return ""
    where = found.mesh.points[int(np.abs(found.contact_rows.T @ np.abs(answer.reaction)).argmax()) // 3]
    return (
        f"Supports near [{where[0]:.6g}, {where[1]:.6g}] push against each other with forces that outweigh all others, "
        "and so does their rounding. Leave out those that nearly repeat each other, give the rigid ones a stiffness, "
        "or correct a settlement."
    )
