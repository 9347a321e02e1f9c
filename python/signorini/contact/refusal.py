"""Why an answer is refused: the figure that fails, what arithmetic has to do with it, and what would help."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from signorini.contact.answer import Answer
from signorini.contact.certificate import CERTIFIABLE, Certificate
from signorini.contact.magnitudes import forces_at_nodes
from signorini.discretise import CaseLoad, Discretisation
from signorini.errors import point

_PUSHING = 100.0
"""Sum of reactions, over that of the loads, from which supports push against each other more than they carry."""
_MARGINAL = (
    "Rounding decides which supports are in contact. Take a finer mesh or fewer supports that nearly repeat each "
    "other, or give the rigid ones a stiffness."
)


def refusal(name: str, discretisation: Discretisation, load: CaseLoad, answer: Answer, certificate: Certificate) -> str:
    """Say why the answer to a load of that name is refused, and what to do.

    Examples
    --------
    >>> from signorini import Model
    >>> from signorini.contact.certificate import certify
    >>> from signorini.contact.problem import contact_problem
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 1], "thickness": 0.2},
    ...     mesh={"divisions": [4, 1]},
    ...     support=[{"edge": ["left"], "fix": "clamped"}],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> problem = contact_problem(model)
    >>> result, load = problem.discretisation, problem.discretisation.cases["load"]
    >>> answer = problem.solve(load)
    >>> wrong = certify(result, load, 2 * answer.hi, answer.lo, answer.reaction)
    >>> print(refusal("all", result, load, answer, wrong).partition("Rounding ")[2])
    decides which supports are in contact. Take a finer mesh or fewer supports that nearly repeat each other, or give \
the rigid ones a stiffness.
    """
    vain = ""
    why = [_of_supports(discretisation, load, answer)]
    if certificate.rounding > CERTIFIABLE:
        vain = (
            f" Rounding may be {certificate.rounding:.0e} of the forces that act; over {CERTIFIABLE:g} of them it "
            "certifies nothing."
        )
        why.append(_of_element(discretisation))
    elif not any(why):
        why.append(_MARGINAL)
    # Where more than that failed, it is what the others say.
    if certificate.lost > CERTIFIABLE and replace(certificate, lost=0.0).passed:
        why = [
            f"Over {CERTIFIABLE:g} that proves nothing: a stress-free curvature, or a load that balances itself, is so "
            "much larger than the others that these are lost in its rounding. Correct it, or give it a combination of "
            "its own."
        ]
    return (
        f'"{name}" is refused, its certificate {certificate}.{vain}{"".join(f" {reason}" for reason in why if reason)}'
    )


def uncertain(discretisation: Discretisation) -> str:
    """Say why there is no answer to refuse, and what to do."""
    return f"{_MARGINAL} {_of_element(discretisation)}".rstrip()


def _of_element(discretisation: Discretisation) -> str:
    if discretisation.model.plate.element != "q8r":
        return ""
    return 'Elements of q8r bend in some shapes with hardly any resistance: "mitc9" may do better.'


def _of_supports(discretisation: Discretisation, load: CaseLoad, answer: Answer) -> str:
    """Say that supports push against each other, where that takes much more than the loads."""
    internal, pushes = forces_at_nodes(discretisation, answer.hi, answer.lo, answer.reaction)
    pressed = np.abs(answer.reaction).sum()
    if not (pushes > internal or pressed > _PUSHING * np.abs(load.nodal[::3]).sum() > 0.0):
        return ""
    where = discretisation.mesh.points[
        int(np.abs(discretisation.contact_rows.T @ np.abs(answer.reaction)).argmax()) // 3
    ]
    return (
        f"Supports near {point(where)} push against each other with forces that outweigh all others, "
        "and so does their rounding. Leave out those that nearly repeat each other, give the rigid ones a stiffness, "
        "or correct a settlement."
    )
