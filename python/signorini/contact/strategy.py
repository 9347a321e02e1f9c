"""Try the methods for a load in turn until an answer is certified; write the message if no answer is certified."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple, TypeAlias

import numpy as np

from signorini.contact.certificate import CERTIFIABLE, Certificate, certified, forces_at_nodes
from signorini.contact.factoring import Method, can_be_factored
from signorini.contact.problem import ContactProblem, Form, Steps
from signorini.contact.selection import Answer
from signorini.discretise import CaseLoad, Discretisation
from signorini.equilibrium.imbalance import supports_contradict
from signorini.errors import point

_MOST = 1e11
"""Largest total number of operations of the fallback methods for a load; they take one or two minutes.

The certified random plate that took longest, with 3285 points, used 5e10.
"""

_A_FACTOR, _FILL = 6000.0, 1.2
"""Coefficient and exponent in the number of operations 6000 n^1.2 of a factorization with n dofs.

A factorization takes 3.4 s for n = 58,563, and 0.5 s for n = 14,883.
"""
_A_SOLVE, _FACTORED = 1000.0, 0.125
"""Operations per dof of a Newton step, which reads the factor a few times; and the fraction of steps with a new factor.

Measured fractions: 6 of 69, 22 of 150, and 197 of 732 in the longest run.
"""
_PIVOTS = 64
"""Pivots of Lemke's algorithm between two calls of the callback; each pivot reads the tableau once."""


_FALLBACKS: tuple[Method, ...] = ("active_set", "lemke", "saddle")
"""Fallback methods in the order in which they are tried; a method prescribed by the input is tried before them."""
WORDS: dict[Method, str] = {
    "lemke": "Lemke's algorithm",
    "active_set": "the active set",
    "saddle": "the saddle-point system",
}
"""Names of the methods in progress reports."""
Told: TypeAlias = Callable[[str, int, int, float], object]
"""Function called with the name of the method, then the arguments of `Steps`; an exception in it ends the solve."""
_PUSHING = 100.0
"""Least Σ|reactions|/Σ|loads| at which a message gives supports that push against each other as the reason."""
_MARGINAL = (
    "Rounding decides which supports are in contact. Take a finer mesh or fewer supports that nearly repeat each "
    "other, or give rigid supports a stiffness."
)


class BudgetSpent(Exception):
    """Raised in the callback of a fallback method when the `Budget` is used up."""


class Budget:
    """Number of operations left to the fallback methods; ``dofs`` and ``points`` determine those of a step."""

    def __init__(self, dofs: int, points: int) -> None:
        self._left = _MOST
        self._dofs, self._points = float(dofs), float(points)

    def allows(self, method: Method) -> bool:
        """Whether the remaining operations suffice for the first step of a method."""
        return self._a_step(method) <= self._left

    def watching(self, method: Method, progress: Steps | None) -> Steps:
        """Return a callback that counts the operations of steps and calls ``progress``, or raises `BudgetSpent`."""
        a_step = self._a_step(method)

        def watch(step: int, changing: int, residual: float) -> None:
            self._left -= a_step
            if self._left < 0.0:
                raise BudgetSpent
            if progress is not None:
                progress(step, changing, residual)

        return watch

    def _a_step(self, method: Method) -> float:
        pivots = 2.0 * _PIVOTS * self._points**2
        factor = _A_FACTOR * math.pow(self._dofs, _FILL)
        newton = _A_SOLVE * self._dofs + _FACTORED * factor
        saddle = _A_FACTOR * math.pow(self._dofs + self._points, _FILL)
        return {"lemke": pivots, "active_set": newton, "saddle": saddle}[method]


class Attempt(NamedTuple):
    """A contact problem posed for one method, and the form of the LCP to solve."""

    problem: ContactProblem
    form: Form = "auto"

    def solve(self, load: CaseLoad, progress: Steps | None = None, start: Answer | None = None) -> Answer:
        """Solve a load; ``start`` is an answer to another load of the same problem."""
        return self.problem.solve(load, self.form, progress, start)


@dataclass(frozen=True, eq=False)
class Tried:
    """The certified answer, its certificate and the methods tried; the first answer if no answer is certified.

    ``contradiction`` is True if the rigid supports contradict each other.
    """

    methods: tuple[Method, ...]
    answer: Answer
    certificate: Certificate | None
    contradiction: bool = False

    @property
    def passed(self) -> bool:
        """Whether the answer is certified."""
        return self.certificate is not None and self.certificate.passed


def attempts(problem: ContactProblem) -> Iterator[Attempt]:
    """Yield the problem posed for every method, in the order in which they are tried until an answer is certified.

    Methods that exceed the free memory are skipped, except the method of the problem itself.
    """
    if problem.reference is not None:
        yield Attempt(problem)
    for other in posed_for_methods(replace(problem, reference=None)):
        if other.method != "lemke":
            yield Attempt(other)
            continue
        yield Attempt(other, other.better_form)
        # Without one-sided points the LCP has no rows, and both forms are the same.
        if not other.discretisation.contacts.two_sided.all():
            yield Attempt(other, "dual" if other.better_form == "stiffness" else "stiffness")


def posed_for_methods(problem: ContactProblem) -> Iterator[ContactProblem]:
    """Yield the problem itself, then the problem posed for each fallback method that fits into memory."""
    yield problem
    for other in map(problem.by, _FALLBACKS):
        if other is not problem and (other.is_factored or can_be_factored(other.discretisation, other.method)):
            yield other


def answered(
    problem: ContactProblem,
    load: CaseLoad,
    progress: Told | None = None,
    beside: Sequence[CaseLoad] = (),
    start: Answer | None = None,
) -> Tried:
    """Solve one load and certify the answer; after a failure try the other form of the LCP and every other method.

    Fallback methods have a `Budget`. ``progress`` is called in all methods, and an exception in it ends the solve.
    ``beside`` are the loads whose sum this load is, see `certify`. The problem's own method starts from ``start``, an
    answer of the same problem to another load.
    """
    discretisation = problem.discretisation
    budget = Budget(discretisation.dof_count, len(discretisation.contacts))
    first: Tried | None = None
    methods: tuple[Method, ...] = ()
    consistent = False
    for attempt in attempts(problem):
        method = attempt.problem.method
        watch: Steps | None = None if progress is None else partial(progress, WORDS[method])
        takes_over = method != problem.method
        if takes_over and not budget.allows(method):
            continue
        if first is not None and watch is not None:
            watch(0, 0, 1.0)
        if takes_over:
            watch = budget.watching(method, watch)
        methods += () if method in methods else (method,)
        try:
            answer = attempt.solve(load, watch, None if first or takes_over else start)
        except BudgetSpent:
            break
        certificate = None
        if answer.status == "solved":
            answer, certificate = certified(discretisation, load, answer, beside)
        elif answer.status == "no_equilibrium" and not consistent:
            if supports_contradict(discretisation):
                return Tried(methods, answer, None, contradiction=True)
            consistent = True
        tried = Tried(methods, answer, certificate)
        if tried.passed:
            return tried
        first = first if first and (first.certificate or not certificate) else tried
    assert first is not None, "there are attempts"
    contradiction = not consistent and supports_contradict(discretisation)
    return Tried(methods, first.answer, first.certificate, contradiction)


def refusal(name: str, discretisation: Discretisation, load: CaseLoad, answer: Answer, certificate: Certificate) -> str:
    """Message on the reason why the answer to the load ``name`` is refused, with the remedy."""
    vain = ""
    why = [_of_supports(discretisation, load, answer)]
    if certificate.rounding > CERTIFIABLE:
        vain = (
            f" Rounding errors may be {certificate.rounding:.0e} of the acting forces; an answer is certified if they "
            f"are at most {CERTIFIABLE:g}."
        )
        why.append(_of_element(discretisation))
    elif not any(why):
        why.append(_MARGINAL)
    # The lost load is given as the reason only if all other errors of the certificate pass.
    if certificate.lost > CERTIFIABLE and replace(certificate, lost=0.0).passed:
        why = [
            f"The limit is {CERTIFIABLE:g}: a stress-free curvature, or a load that balances itself, is so large that "
            "the other loads are lost in its rounding. Correct this load, or give it a combination of its own."
        ]
    return (
        f'"{name}" is refused, its certificate {certificate}.{vain}{"".join(f" {reason}" for reason in why if reason)}'
    )


def uncertain(discretisation: Discretisation) -> str:
    """Message for the case that every method fails, with the remedy."""
    return f"{_MARGINAL} {_of_element(discretisation)}".rstrip()


def _of_element(discretisation: Discretisation) -> str:
    if discretisation.zones.element != "q8r":
        return ""
    return 'Elements of q8r bend in some shapes with hardly any resistance. Try element = "mitc9".'


def _of_supports(discretisation: Discretisation, load: CaseLoad, answer: Answer) -> str:
    """Sentence on supports that push against each other with forces far above the loads; "" without such supports."""
    internal, pushes = forces_at_nodes(discretisation, answer.hi, answer.lo, answer.reaction)
    pressed = np.abs(answer.reaction).sum()
    if not (pushes > internal or pressed > _PUSHING * np.abs(load.nodal[::3]).sum() > 0.0):
        return ""
    where = discretisation.mesh.points[
        int(np.abs(discretisation.contact_rows.T @ np.abs(answer.reaction)).argmax()) // 3
    ]
    return (
        f"Supports near {point(where)} push against each other with forces that exceed all other forces, "
        "and so does their rounding. Leave out supports that nearly repeat others, give rigid supports a stiffness, "
        "or correct a settlement."
    )
