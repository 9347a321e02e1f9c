"""Compute a certified result from reactions that the caller gives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from signorini.analysis.tightening import tightened
from signorini.base.arguments import array, checked, known, made_by, vector
from signorini.contact.certificate import TOLERANCE, certified
from signorini.contact.own_rows import RowProblem
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import Answer, chosen
from signorini.contact.strategy import refusal
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Bools, Floats, Pieces
from signorini.errors import InputError, NotCertifiedError, point
from signorini.results.recovery import recovered
from signorini.results.result import Result

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

_S = TypeVar("_S", Bools, Pieces)
_T = TypeVar("_T")
_ACCURATE = 1e-6
"""Largest error of given reactions that is accepted, relative to the largest reaction or load. An iterative solver has
such errors."""
_NONE = (1e-13, TOLERANCE)
"""Largest reactions that count as zero, relative to the largest reaction or load. The first value allows for rounding.
The second, the certificate's tolerance, is tried if no answer with the first is certified.
"""
_NOT = "These reactions are not the answer: "
_OWN = "own load"
"""Name of a load that the caller gives as an array."""


@checked
def recover(problem: ContactProblem | RowProblem, load: str | ArrayLike, reactions: ArrayLike) -> Result:
    """Certify given reactions, and compute the plate's displacements and results.

    Only the contact state is taken from the reactions: the plate is solved on it, refined and certified. So given
    reactions may be wrong by 10⁻⁶ of the largest reaction or nodal load; those of the result are exact to rounding.

    Parameters
    ----------
    problem : ContactProblem or RowProblem
    load : str or (3n,) array_like
        Name of a combination, or nodal forces and couples.
    reactions : (m,) or (m + r,) array_like
        λ of the paper's (27), for each row of ``problem.G``; positive in the direction that the support resists.
        Two-sided rows that an LCP has eliminated may have NaN.

    Returns
    -------
    Result
        Result with ``method`` "given". Reactions of rows added by the caller count as its loads.

    Raises
    ------
    InputError
        If shapes or numbers are wrong, or there is no combination of that name.
    NotCertifiedError
        If these reactions are not the answer; the message gives the difference.

    Examples
    --------
    >>> from signorini import Model, contact_problem, lemke
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     mesh={"divisions": [4, 4]},
    ...     support=[{"edge": "left", "fix": "clamped"}, {"name": "props", "at": [[4, 0], [4, 4]], "resists": "down"}],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> problem = contact_problem(model)
    >>> P, s = problem.dual(problem.load("all"))
    >>> reactions = lemke(P, -s).z
    >>> result = recover(problem, "all", reactions)
    >>> bool(np.isclose(result.reactions["props"], reactions.sum())), result.certificate.passed
    (True, True)
    >>> recover(problem, "all", [reactions[0], 0.0])
    Traceback (most recent call last):
    signorini.errors.NotCertifiedError: These reactions are not the answer: row 0 at [4, 0] has the reaction 14286.2, \
but the solution in which the same rows push has 21130.1.
    """
    if not isinstance(problem, RowProblem):
        made_by(problem, ContactProblem, "Make one with signorini.contact_problem(model).", "problem")
    own = problem.problem if isinstance(problem, RowProblem) else problem
    name, case = _load(own.discretisation, load)
    if isinstance(load, str):
        own = tightened(own, load)
    given = _reactions(problem, reactions)
    if isinstance(problem, RowProblem):
        return _of_rows(replace(problem, problem=own), name, case, given)
    return _recover(own, name, case, given)


def _load(discretisation: Discretisation, load: str | ArrayLike) -> tuple[str, CaseLoad]:
    if isinstance(load, str):
        combinations = {one.name: one for one in discretisation.model.effective_combinations}
        return load, discretisation.load(combinations[known(load, combinations, "combination", "load")])
    nodal = vector(load, discretisation.dof_count, "load")
    nothing = CaseLoad.none(discretisation.mesh.node_count, len(discretisation.mesh.elements))
    return _OWN, replace(nothing, nodal=nodal, weighing=nodal)


def _beside(load: CaseLoad, pushed: Floats) -> CaseLoad:
    """Subtract from a load the nodal forces ``pushed`` (3n,) of the reactions at the caller's rows."""
    nodal = load.nodal - pushed
    return replace(load, nodal=nodal, weighing=nodal if load.all_weighs else load.weighing - pushed)


def _reactions(problem: ContactProblem | RowProblem, reactions: ArrayLike) -> Floats:
    given, both = array(reactions, "reactions", 1), problem.two_sided
    if len(given) != len(both):
        raise InputError(f"found {len(given)} numbers; give {len(both)}, one for each row of G.", place="reactions")
    wrong = np.where(both, np.isinf(given), ~np.isfinite(given))
    if wrong.any():
        at = int(np.argmax(wrong))
        raise InputError(f"found {given[at]} at index {at}; all numbers must be finite.", place="reactions")
    return given


def _recover(problem: ContactProblem, name: str, load: CaseLoad, given: Floats) -> Result:
    discretisation = problem.discretisation
    unit = np.where(discretisation.contacts.slope, discretisation.mesh.size, 1.0)
    size = float(max(np.nanmax(np.abs(given) / unit, initial=0.0), np.abs(load.nodal[::3]).max()))

    def on(pieces: Pieces) -> Result:
        solution = problem.core.solve_on(load.nodal, problem.held_values, pieces)
        if solution.status != "solved":
            raise NotCertifiedError(f"{_NOT}the rows that push do not hold the plate, or their forces are not unique.")
        _require_same(problem, given, solution.reaction, unit, size)
        answer = chosen(discretisation, problem.freedom, load.nodal, Answer.of(discretisation, solution))
        answer, certificate = certified(discretisation, load, answer)
        if not certificate.passed:
            gap = np.where(problem.two_sided, 0.0, answer.gap)
            if certificate.penetration > TOLERANCE and gap.min(initial=0.0) < 0.0:
                at = int(np.argmin(gap))
                raise NotCertifiedError(f"{_NOT}{_row(problem, at)} would be passed by {-gap[at]:g}.")
            raise NotCertifiedError(f"{_NOT}{refusal(name, discretisation, load, answer, certificate)}")
        return recovered(discretisation, name, ("given",), load, answer, certificate)

    return _first(on, [discretisation.contacts.pieces_at(given, part * size) for part in _NONE])


def _first(on: Callable[[_S], _T], sets: Sequence[_S]) -> _T:
    """Return the result of the first contact state in ``sets`` that is certified."""
    try:
        return on(sets[0])
    except NotCertifiedError:
        if np.array_equal(sets[0], sets[1]):
            raise
        return on(sets[1])


def _row(problem: ContactProblem | RowProblem, row: int) -> str:
    points = problem.problem.positions if isinstance(problem, RowProblem) else problem.positions
    return f"row {row} at {point(points[row])}" if row < len(points) else f"row {row}"


def _require_same(
    problem: ContactProblem | RowProblem, given: Floats, result: Floats, unit: Floats, size: float
) -> None:
    """Refuse given reactions that differ from the computed ones by more than `_ACCURATE` × ``size``.

    The reactions computed on the same contact state are ``result``. Both are divided by ``unit`` before the comparison.
    """
    missed = np.nan_to_num(np.abs(given - result)) / unit
    if missed.max(initial=0.0) > _ACCURATE * size:
        at = int(np.argmax(missed))
        raise NotCertifiedError(
            f"{_NOT}{_row(problem, at)} has the reaction {given[at]:g}, but the solution in which the same rows push "
            f"has {result[at]:g}."
        )


def _of_rows(problem: RowProblem, name: str, load: CaseLoad, given: Floats) -> Result:
    matrix, s = problem.dual(load.nodal)
    count = len(problem.problem.gaps)
    # The caller's rows have arbitrary units. Therefore reactions are multiplied by √diag(P) before they are compared.
    unit = 1.0 / np.sqrt(np.diag(matrix))
    size = float(max(np.nanmax(np.abs(given) / unit, initial=0.0), np.abs(s * unit).max(initial=0.0)))

    def on(pushing: Bools) -> Result:
        exact = np.zeros(len(s))
        exact[pushing] = np.linalg.lstsq(matrix[np.ix_(pushing, pushing)], s[pushing], rcond=None)[0]
        _require_same(problem, given, exact, unit, size)
        own = exact[count:]
        result = _recover(problem.problem, name, _beside(load, problem.rows.T @ own), exact[:count])
        _require_open(problem, result, own)
        return result

    return _first(on, [problem.two_sided | (given / unit > part * size) for part in _NONE])


def _require_open(problem: RowProblem, result: Result, own: Floats) -> None:
    """Refuse displacements that violate a constraint of the caller's rows, or leave a gap at a row with a reaction."""
    count, values = len(problem.problem.gaps), problem.problem.discretisation
    slopes = values.held.from_global(result.rotation)
    moved = np.column_stack([result.deflection, slopes]).ravel()
    gap = problem.row_gaps - problem.rows @ moved + problem.row_compliance * own
    size = abs(problem.rows) @ np.abs(moved) + np.abs(problem.row_gaps) + problem.row_compliance * np.abs(own)
    missed = np.where(problem.row_two_sided | (own != 0.0), np.abs(gap), np.maximum(-gap, 0.0))
    if (missed > TOLERANCE * size).any():
        at = int(np.argmax(missed - TOLERANCE * size))
        raise NotCertifiedError(f"{_NOT}{_row(problem, count + at)} would be passed by {-gap[at]:g}.")
