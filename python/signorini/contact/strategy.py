"""Which method, form and care a load is solved with: in what order, nothing twice, until an answer is certified."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple, TypeAlias

from signorini.base.memory import fits, needed_by_interior_point, needed_by_proximal_steps
from signorini.contact.answer import Answer
from signorini.contact.budget import Budget, BudgetSpent
from signorini.contact.certificate import Certificate, certified
from signorini.contact.factoring import Method, base_of, can_be_factored
from signorini.contact.problem import ContactProblem, Form, Steps
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Bools
from signorini.equilibrium.limits import supports_contradict

_FALLBACKS: tuple[Method, ...] = ("active_set", "lemke", "interior_point")
"""Methods that take over, in turn, where one does not settle; a prescribed one is only the first."""

_YIELDING = (1e-6, 1e-9, 1e-11, 1e-13, 1e-15)
"""Parts of the plate's own compliance that are tried, each from the contact set of the one before; see `Attempt`."""

WORDS: dict[Method, str] = {
    "lemke": "Lemke's algorithm",
    "active_set": "the active set",
    "interior_point": "the interior point method",
}
"""What methods are called where they tell how far they are."""

BY_PROXIMAL_STEPS = "proximal steps"

Told: TypeAlias = Callable[[str, int, int, float], object]
"""Called with what is at work, in words, and what `Steps` are called with; what it raises ends it."""

_MOST_DOFS = 200_000
"""Dofs up to which proximal steps are tried, on load paths too: one step took 14 s on 59,000 dofs."""


class Attempt(NamedTuple):
    """A way to an answer: a method, the form of its LCP, and where rounding decides, what increments yield by.

    ``near`` says that it begins with the contact set of the last answer, if there is one; ``only_near``, that it is
    left out if there is none.
    """

    problem: ContactProblem
    form: Form = "auto"
    part: float | None = None
    near: bool = False
    only_near: bool = False

    @property
    def words(self) -> str:
        """What is at work."""
        return WORDS[self.problem.method] if self.part is None else BY_PROXIMAL_STEPS

    def solve(self, load: CaseLoad, progress: Steps | None = None, closed: Bools | None = None) -> Answer:
        """Solve a load; where rounding decides, beginning with a contact set (m,) if there is one."""
        if self.part is None:
            return self.problem.solve(load, self.form, progress)
        return self.problem.solve_by_proximal_steps(load, self.part, closed, progress)


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


def attempts(problem: ContactProblem, proximal: bool = True) -> Iterator[Attempt]:
    """Every way to an answer, in the order in which they are tried until one is certified.

    Without ``proximal`` only those of pivots and of active sets. What memory is not left for is not tried, but for the
    method of the problem itself.
    """
    if problem.reference is not None:
        yield Attempt(problem)
    condensed: ContactProblem | None = None
    parts: Sequence[float] = _YIELDING
    for way in _methods(replace(problem, reference=None)):
        if way.method == "lemke":
            condensed = way
            yield from (Attempt(way, form) for form in _forms(way))
            if proximal and _may_take_steps(way.discretisation):
                # A set that is right but for rounding takes a step or two, and from rest each takes a factor.
                yield Attempt(way, part=_YIELDING[0], near=True, only_near=True)
        elif way.method == "active_set":
            yield Attempt(way)
        elif proximal:
            if condensed is not None:
                yield from _proximal(condensed, parts)
                # What is left imprecise by what comes next.
                parts = _YIELDING[1:]
            yield Attempt(way)
    if proximal and condensed is not None:
        yield from _proximal(condensed, parts)


def ways_along(problem: ContactProblem) -> Iterator[tuple[ContactProblem, bool]]:
    """Problems that can follow a load path, in turn, and whether by proximal steps."""
    found, condensed = problem.discretisation, None
    for way in _methods(problem):
        if way is problem or way.method not in ("interior_point", base_of(found, problem.method)):
            yield way, False
        if way.method == "lemke":
            condensed = way
    if condensed is not None and _may_take_steps(found):
        yield condensed, True


def _methods(problem: ContactProblem) -> Iterator[ContactProblem]:
    """The problem, and posed for the methods that take over."""
    yield problem
    if problem.discretisation.contacts.two_sided.all():
        return
    for other in map(problem.by, _FALLBACKS):
        if other is not problem and _fits(other):
            yield other


def _fits(problem: ContactProblem) -> bool:
    """Whether memory is left for a method, and its points can be condensed."""
    found = problem.discretisation
    if not (problem.is_factored or can_be_factored(found, base_of(found, problem.method))):
        return False
    if problem.method != "interior_point":
        return True
    return fits(needed_by_interior_point(found.dof_count, len(found.contacts)))


def _forms(problem: ContactProblem) -> tuple[Form, ...]:
    """The better form of the LCP, then the other one, which is the same where the LCP has no rows."""
    if problem.discretisation.contacts.two_sided.all():
        return (problem.better_form,)
    return ("stiffness", "dual") if problem.better_form == "stiffness" else ("dual", "stiffness")


def _proximal(problem: ContactProblem, parts: Sequence[float]) -> Iterator[Attempt]:
    # Asked each time, since memory may be less than it was.
    for part, near in itertools.product(parts, (True, False)):
        if _may_take_steps(problem.discretisation):
            yield Attempt(problem, part=part, near=near)


def _may_take_steps(found: Discretisation) -> bool:
    """Whether there is time and memory for proximal steps."""
    return found.dof_count <= _MOST_DOFS and fits(needed_by_proximal_steps(found.dof_count, len(found.contacts)))


def answered(
    problem: ContactProblem,
    load: CaseLoad,
    progress: Told | None = None,
    proximal: bool = True,
    beside: Sequence[CaseLoad] = (),
) -> Tried:
    """Solve one load and certify the answer; where that fails, ask in every other form and by every other method.

    A basis that rounding makes singular in one form is regular in another. What takes over from the problem's own
    method has a `Budget`. ``progress`` watches all that is tried, and what it raises ends it. ``proximal`` is that of
    `attempts`, ``beside`` that of `certify`.
    """
    found = problem.discretisation
    budget = Budget(found.dof_count, len(found.contacts))
    first: Tried | None = None
    near: Bools | None = None
    methods: tuple[Method, ...] = ()
    stepped = set[tuple[float, bytes | None]]()
    consistent = False
    for attempt in attempts(problem, proximal):
        if attempt.only_near and near is None:
            continue
        closed = near if attempt.near else None
        if attempt.part is not None:
            steps = attempt.part, None if closed is None else closed.tobytes()
            if steps in stepped:
                continue
            stepped.add(steps)
        watch: Steps | None = None if progress is None else partial(progress, attempt.words)
        way = attempt.problem.method, attempt.part is not None
        takes_over = way != (problem.method, False)
        if takes_over and not budget.allows(*way):
            continue
        if first is not None and watch is not None:
            watch(0, 0, 1.0)
        if takes_over:
            watch = budget.watching(*way, watch)
        methods += () if attempt.problem.method in methods else (attempt.problem.method,)
        try:
            answer = attempt.solve(load, watch, closed)
        except BudgetSpent:
            break
        certificate = None
        if answer.status == "solved":
            answer, certificate = certified(found, load, answer, beside)
        elif answer.status == "no_equilibrium" and not consistent:
            if supports_contradict(found):
                return Tried(methods, answer, None, contradiction=True)
            consistent = True
        tried = Tried(methods, answer, certificate)
        if tried.passed:
            return tried
        if certificate is not None:
            near = answer.closed
        first = first if first and (first.certificate or not certificate) else tried
    assert first is not None, "there are attempts"
    contradiction = not consistent and supports_contradict(found)
    return Tried(methods, first.answer, first.certificate, contradiction)
