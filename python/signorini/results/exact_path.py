"""A load path with every event of every contact point: segments, jumps, and ranges of t with several right answers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from signorini.base.arguments import checked
from signorini.base.remade import Brief
from signorini.contact.certificate import certified
from signorini.contact.factoring import Method
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import Answer, NotUnique, chosen
from signorini.contact.strategy import answered, refusal
from signorini.discretise import CaseLoad
from signorini.discretise.rows import Floats, Pieces
from signorini.errors import NotCertifiedError
from signorini.results.load_path import LoadPath, beside
from signorini.results.path_stop import PathStop
from signorini.results.recovery import recovered
from signorini.results.result import Result


@dataclass(frozen=True, eq=False, repr=False)
class Segment(Brief):
    """Segment of the path between two stops. No contact point changes its piece in it, so the answer is linear in t."""

    begin: PathStop  # stops at the first and the last t of the segment
    end: PathStop
    pieces: Pieces  # (m,): piece of its law on which each contact point is in the segment

    @property
    def jumps(self) -> bool:
        """Whether the segment is a jump at one t: the plate is not held, and moves until other points hold it."""
        return self.begin.t == self.end.t


@checked
@dataclass(frozen=True, eq=False, repr=False)
class ExactPath(LoadPath):
    """A load path with a stop at every event of every contact point; between two stops everything is linear in t.

    The path also stops where redundant supports begin to distribute a reaction differently among themselves.
    """

    _first: Pieces | None = None
    _doubtful: tuple[int, ...] = ()
    """Indices of the segments on which several answers may be right."""

    @cached_property
    def segments(self) -> tuple[Segment, ...]:
        """Segments between successive stops."""
        assert self._first is not None
        pieces, result = self._first, []
        for begin, end in zip(self.stops[:-1], self.stops[1:], strict=True):
            pieces = pieces.copy()
            pieces[begin.points] = begin.pieces
            result.append(Segment(begin, end, pieces))
        return tuple(result)

    @cached_property
    def not_unique(self) -> tuple[tuple[float, float, NotUnique], ...]:
        """Ranges of t in which several answers are right, and how these answers differ.

        At its stops the path has the answer that continues the path; `at` returns the least-norm answer.
        """
        result, stretches = self.problem.discretisation, list[tuple[float, float, NotUnique]]()
        for segment in (self.segments[index] for index in self._doubtful):
            load = self._loads[0] + 0.5 * (segment.begin.t + segment.end.t) * self._loads[1]
            solution = self.problem.core.solve_on(load.nodal, result.held.values, segment.pieces)
            answer = chosen(result, self.problem.freedom, load.nodal, Answer.of(result, solution))
            for one in answer.not_unique:
                before = [stretch for stretch in stretches if stretch[1:] == (segment.begin.t, one)]
                begin = before[0][0] if before else segment.begin.t
                stretches = [stretch for stretch in stretches if stretch not in before]
                stretches.append((begin, segment.end.t, one))
        return tuple(stretches)

    def words(self, index: int) -> str:
        """Describe how supports change at a stop, and whether the plate jumps."""
        jumps = index < len(self.segments) and self.segments[index].jumps
        moves = "the plate moves on its own until another support holds it"
        return "; ".join(part for part in (super().words(index), moves * jumps) if part)

    def _beside(self, t: float) -> Iterator[Floats]:
        """Yield contact reactions (m,) at the middle of each segment, except jumps, that contains t or ends at t."""
        held = self.problem.discretisation.held.values
        for segment in self.segments:
            if segment.begin.t <= t <= segment.end.t and not segment.jumps:
                load = self._loads[0] + 0.5 * (segment.begin.t + segment.end.t) * self._loads[1]
                solution = self.problem.core.solve_on(load.nodal, held, segment.pieces)
                if solution.status == "solved":
                    yield solution.reaction

    def _result(self, t: float) -> Result:
        jumps = any(segment.jumps and segment.begin.t == t for segment in self.segments)
        return self._on(t, int(np.searchsorted([stop.t for stop in self.stops[1:-1]], t, side="left")), leading=jumps)

    def _of_stops(self) -> Iterator[Result]:
        count = len(self.stops)
        for row, stop in enumerate(self.stops):
            # The first of the two stops of a jump has the state before the jump, the second stop the state after it.
            after = 0 < row < count - 1 and self.segments[row - 1].jumps
            yield self._on(stop.t, row if after else max(row - 1, 0), leading=True)

    def _on(self, t: float, segment: int, leading: bool) -> Result:
        """Result at t on the contact state of a segment.

        If several answers are right, the result has the least-norm answer or, if ``leading``, an answer that continues
        the path.
        """
        load = self._loads[0] + t * self._loads[1]
        discretisation = self.problem.discretisation
        assert self._first is not None
        pieces = self.segments[segment].pieces if self.segments else self._first
        answer = Answer.of(discretisation, self.problem.core.solve_on(load.nodal, discretisation.held.values, pieces))
        made_of = beside(self._loads, t)
        methods: Sequence[Method] = (self.problem.method,)
        answer, certificate = certified(discretisation, load, answer, made_of)
        if not certificate.passed:
            # On this contact state redundant supports may share a reaction wrongly; solve for the load at t instead.
            tried = answered(self.problem, load, beside=made_of)
            answer, certificate = certified(discretisation, load, tried.answer.somehow or tried.answer, made_of)
            methods = tried.methods
        if not certificate.passed:
            raise NotCertifiedError(refusal(self.load_at(t).name, discretisation, load, answer, certificate))
        elsewhere = partial(self._beside, t) if leading else None
        least = chosen(discretisation, self.problem.freedom, load.nodal, answer, elsewhere)
        if least is not answer:
            answer, certificate = certified(discretisation, load, least, made_of)
        return recovered(discretisation, self.load_at(t), methods, load, answer, certificate)


def ahead(problem: ContactProblem, loads: tuple[CaseLoad, CaseLoad], t: float, pieces: Pieces) -> Iterator[Floats]:
    """Yield the contact reactions (m,), of either sign, at a much larger t if all points stay on their ``pieces``.

    Nothing is yielded if these pieces do not hold the plate.
    """
    start, add = (np.abs(load.nodal).max() for load in loads)
    far = t + max(t, start / add if start else 1.0)
    held = problem.discretisation.held.values
    solution = problem.core.solve_on((loads[0] + far * loads[1]).nodal, held, pieces)
    if solution.status == "solved":
        yield solution.reaction
