"""Which method a load is solved by: each once, in turn, until an answer is certified."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple, TypeAlias

from signorini.base.memory import fits, needed_by_interior_point
from signorini.contact.answer import Answer
from signorini.contact.budget import Budget, BudgetSpent
from signorini.contact.certificate import Certificate, certified
from signorini.contact.factoring import Method, base_of, can_be_factored
from signorini.contact.problem import ContactProblem, Form, Steps
from signorini.discretise import CaseLoad
from signorini.equilibrium.limits import supports_contradict

_FALLBACKS: tuple[Method, ...] = ("active_set", "lemke", "saddle", "interior_point")
"""Methods that take over, in turn, where one does not settle; a prescribed one is only the first."""

WORDS: dict[Method, str] = {
    "lemke": "Lemke's algorithm",
    "active_set": "the active set",
    "saddle": "the saddle-point system",
    "interior_point": "the interior point method",
}
"""What methods are called where they tell how far they are."""

Told: TypeAlias = Callable[[str, int, int, float], object]
"""Called with what is at work, in words, and what `Steps` are called with; what it raises ends it."""


class Attempt(NamedTuple):
    """A method, and the form of its LCP."""

    problem: ContactProblem
    form: Form = "auto"

    def solve(self, load: CaseLoad, progress: Steps | None = None, start: Answer | None = None) -> Answer:
        """Solve a load, from an answer of the same problem to another one if there is one."""
        return self.problem.solve(load, self.form, progress, start)


@dataclass(frozen=True, eq=False)
class Tried:
    """An answer, the methods that were tried for it, and what it is worth; the first one where none is certified."""

    methods: tuple[Method, ...]
    answer: Answer
    certificate: Certificate | None
    contradiction: bool = False

    @property
    def passed(self) -> bool:
        """Whether the answer is certified."""
        return self.certificate is not None and self.certificate.passed


def attempts(problem: ContactProblem) -> Iterator[Attempt]:
    """Every method, in the order in which they are tried until an answer is certified.

    What memory is not left for is not tried, but for the method of the problem itself.
    """
    if problem.reference is not None:
        yield Attempt(problem)
    for other in _methods(replace(problem, reference=None)):
        forms = _forms(other) if other.method == "lemke" else ("auto",)
        yield from (Attempt(other, form) for form in forms)


def methods_along(problem: ContactProblem) -> Iterator[ContactProblem]:
    """Problems that can follow a load path, in turn."""
    base = base_of(problem.discretisation, problem.method)
    for other in _methods(problem):
        if other is problem or other.method not in ("interior_point", base):
            yield other


def _methods(problem: ContactProblem) -> Iterator[ContactProblem]:
    """The problem, and posed for the methods that take over."""
    yield problem
    for other in map(problem.by, _FALLBACKS):
        if other is not problem and _fits(other):
            yield other


def _fits(problem: ContactProblem) -> bool:
    """Whether memory is left for a method, and its points can be condensed."""
    discretisation = problem.discretisation
    if not (problem.is_factored or can_be_factored(discretisation, base_of(discretisation, problem.method))):
        return False
    if problem.method != "interior_point":
        return True
    return fits(needed_by_interior_point(discretisation.dof_count, len(discretisation.contacts)))


def _forms(problem: ContactProblem) -> tuple[Form, ...]:
    """The better form of the LCP, then the other one, which is the same where the LCP has no rows."""
    if problem.discretisation.contacts.two_sided.all():
        return (problem.better_form,)
    return ("stiffness", "dual") if problem.better_form == "stiffness" else ("dual", "stiffness")


def answered(
    problem: ContactProblem,
    load: CaseLoad,
    progress: Told | None = None,
    beside: Sequence[CaseLoad] = (),
    start: Answer | None = None,
) -> Tried:
    """Solve one load and certify the answer; where that fails, ask in the other form and by every other method.

    What takes over from the problem's own method has a `Budget`. ``progress`` watches all that is tried, and what it
    raises ends it. ``beside`` is that of `certify`; ``start`` is an answer of the same problem to another load, which
    the problem's own method begins with.
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
