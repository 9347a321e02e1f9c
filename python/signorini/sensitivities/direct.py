"""Direct differentiation of a contact solution on the pieces of the laws (Haftka and Gürdal 1992, section 7.2).

On fixed pieces the state equations r(u, p) = f − K u − Gᵀλ = 0 are linear in u. A parameter p moves their solution by
du/dp, which solves the same equations with the right-hand side ∂r/∂p: one solve with the factor of the problem. A
number y(u, λ; p) of the result then has the derivative of y along this direction. The range in which all points stay on
their pieces needs du/dp for each parameter too, so that an adjoint solution for each number would save no solve.

∂r/∂p and the derivative of y are differences over small steps of the parameter, with pieces fixed, and with u, λ fixed
or moved along the direction. They have no error from a change of the contact state.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from signorini.analysis.tightening import tightened_by
from signorini.base.arguments import known
from signorini.base.on_demand import kept
from signorini.base.reuse import Reuse
from signorini.contact.problem import ContactProblem, unfactored
from signorini.contact.selection import Answer
from signorini.contact.strategy import answered
from signorini.discretise import CaseLoad, Discretisation, discretise
from signorini.discretise.points import ContactPoints
from signorini.discretise.rows import Bools, Floats, Pieces
from signorini.errors import InputError, SignoriniError
from signorini.model import Combination
from signorini.results.quantities import Number
from signorini.results.recovery import recovered
from signorini.results.result import Result
from signorini.results.sensitivity import Derivative, Sensitivity
from signorini.sensitivities.parameters import Input, Parameter


@dataclass(frozen=True)
class _Stencil:
    """Finite-difference stencil: ``step`` relative to a parameter's reference size, ``weights`` by offset in steps."""

    step: float
    weights: Mapping[int, float]

    def rate(self, values: Mapping[int, Floats]) -> Floats:
        """Derivative (k,), per reference size of the parameter, of k values that are given at each offset."""
        return np.asarray(sum(weight * values[offset] for offset, weight in self.weights.items()) / self.step)


_CENTRAL, _FORWARD = {-1: -0.5, 1: 0.5}, {0: -1.5, 1: 2.0, 2: -0.5}
_BACKWARD = {-offset: -weight for offset, weight in _FORWARD.items()}
_FOURTH_ORDER = {-2: 1 / 12, -1: -2 / 3, 1: 2 / 3, 2: -1 / 12}
_LINEAR = tuple(_Stencil(1e-5, weights) for weights in (_CENTRAL, _FORWARD, _BACKWARD))
"""Stencils for parameters on which the state depends linearly: loads, gaps, settlements, preloads.

One-sided stencils are for parameters at the end of their allowed range, such as a gap of 0.
"""
_STIFF = (_Stencil(2e-4, _FOURTH_ORDER), *(_Stencil(1e-5, weights) for weights in (_FORWARD, _BACKWARD)))
"""Stencils for stiffness parameters; the larger step of the central one reduces rounding from element matrices."""
_KINK, _LEAST_KINK = 0.02, 0.01
"""Smallest second difference of a number, over the stencil's values of the parameter, that is a kink: relative to the
first differences, and relative to the step times the largest number of the same kind, such as all moments."""
_AT_END = 1e-12
"""Distance of a point from the end of its law's piece that counts as 0, relative to its reference force or travel."""
_REACHED = 1e-7
"""Least |derivative| with respect to the parameter, of a point's distance from the end of its law's piece, at which a
point at this end leaves the piece; relative to the point's reference force or travel."""
_STILL = 1e-8
"""Largest |derivative| with respect to the parameter, of a point's distance from the end of its law's piece, that
counts as rounding; relative to the point's reference force or travel."""


class _State(NamedTuple):
    """Contact points on given pieces of their laws, at displacements u; each array is (m,), ``margins`` (2, m).

    ``slope`` is the stiffness of the piece, infinite where it is rigid. ``line`` is the force at fixed u of points on
    pieces of finite slope, 0 on rigid pieces. ``offset`` is the deflection Gu of points on rigid pieces, else 0.
    ``margins`` are the distances to both ends of the piece: in travel where the slope is 0, else in force.
    """

    slope: Floats
    line: Floats
    offset: Floats
    reaction: Floats
    gap: Floats
    margins: Floats


def _state(found: Discretisation, pieces: Pieces, hi: Floats, lo: Floats, rigid: Floats) -> _State:
    """State at the displacements u = hi + lo (3n,), a sum of two doubles.

    ``rigid`` (m,) are the reactions of those of the m contact points whose piece of the law has an infinite slope.
    """
    points = found.contacts
    anchor, force, slope, begin, end = np.zeros((5, len(points)))
    for law, own in points.by_law:
        piece = pieces[own]
        travels = [vertex[0] for vertex in law.vertices] if not law.straight else []
        (anchor[own], force[own]), slope[own] = law.anchors[piece].T, law.slopes[piece]
        begin[own], end[own] = np.array([-np.inf, *travels])[piece], np.array([*travels, np.inf])[piece]
    is_rigid, is_flat = np.isinf(slope), slope == 0.0
    travel = -found.plate.openings(*points.rows.arrays, points.distance, hi, lo)
    line = points.scale * (force + np.where(is_rigid, 0.0, slope) * (travel / points.unit - anchor))
    reaction = np.where(is_rigid, rigid, line)
    least, most = points.range_on(pieces)
    low = np.where(is_flat, travel - points.unit * begin, reaction - least)
    high = np.where(is_flat, points.unit * end - travel, most - reaction)
    beyond = points.unit * anchor - travel
    gap = np.where(points.yield_on(pieces), -np.abs(beyond), np.where(is_flat, beyond, 0.0))
    offset = np.where(is_rigid, points.distance + points.unit * anchor, 0.0)
    spring = points.scale * slope / points.unit
    return _State(spring, np.where(is_rigid, 0.0, line), offset, reaction, gap, np.array([low, high]))


@dataclass(frozen=True, eq=False)
class _Variant:
    """The discretisation at one value of a parameter, with the combination and its load."""

    found: Discretisation
    combination: Combination
    load: CaseLoad


class _Rates(NamedTuple):
    """Derivatives of k numbers by one parameter, per its reference size; ``kinks`` (k,) marks numbers with a kink.

    ``valid`` is the parameter's range in which points keep their pieces; ``leaves``: a point leaves its piece at once.
    """

    size: float
    numbers: Floats
    kinks: Bools
    valid: tuple[float, float]
    leaves: bool


class Direct:
    """Derivatives of all numbers of one combination, with points on the pieces of laws as in its answer."""

    def __init__(self, problem: ContactProblem, combination: Combination) -> None:
        # Each variant tightens the bolts again, and therefore starts from the gaps before tightening.
        self._loose = (problem.unmoved or problem).discretisation
        problem = tightened_by(problem, combination.factors or {}, lambda now: None)
        load = problem.discretisation.load(combination)
        tried = answered(problem, load)
        if not tried.passed or tried.certificate is None:
            raise SignoriniError(f'Combination "{combination.name}" has no certified answer.')
        if tried.answer.not_unique or len(problem.discretisation.repeated):
            why = "; ".join(map(str, tried.answer.not_unique)) or "rigid supports repeat each other"
            raise InputError(f"the answer is not unique, and so has no derivative: {why}.", combination.name)
        self.methods, self.answer, self.certificate = tried.methods, tried.answer, tried.certificate
        self.problem, self.base = problem.by(tried.methods[-1]), _Variant(problem.discretisation, combination, load)
        self.input = Input(problem.discretisation.model)
        self._found = dict[Parameter, _Rates]()
        self._reuse = Reuse()

    @cached_property
    def result(self) -> Result:
        """Result of the combination."""
        return self._result(self.base, self.answer)

    @cached_property
    def _sizes(self) -> tuple[float, float]:
        """Reference force: largest nodal load or reaction. Reference travel: largest deflection plus largest gap."""
        moved = np.abs((self.answer.hi + self.answer.lo)[::3]).max()
        force = max(np.abs(self.answer.reaction).max(initial=0.0), np.abs(self.base.load.nodal[::3]).max())
        return float(force), float(moved + np.abs(self.base.found.contacts.distance).max(initial=0.0))

    def sensitivity(self, number: Number) -> Sensitivity:
        """Derivatives of one number of the catalogue with respect to parameters of the input."""
        result = self.result
        index, unit = result.catalogue.by_name[number.name], number.quantity.unit(result.model.units)
        value, combination = float(result.numbers[index]), self.base.combination

        def compute(path: str) -> Derivative:
            one = Parameter.of(path, self.input.model, self.input.tables, combination)
            rates = self.rates(one)
            slope, why = float(rates.numbers[index]) / rates.size, ""
            if rates.leaves:
                why = "a contact point just opens, closes or reaches a limit; derivatives above and below differ."
            elif rates.kinks[index]:
                why = f"{number.name} has a kink at this value: two places or two terms of its formula are equal."
            if why or not math.isfinite(slope):
                slope, why = math.nan, why or f"{number.name} has no value."
            elasticity = one.value / value * slope if value else math.nan
            of = f"{unit} per {one.unit}".strip() if one.unit else unit
            return Derivative(path, one.value, one.unit, slope, of, elasticity, rates.valid, why)

        return Sensitivity(number.name, value, unit, combination.name, lambda: self.input.paths(combination), compute)

    def rates(self, one: Parameter) -> _Rates:
        """Derivatives of all numbers by one parameter, computed once."""
        if one not in self._found:
            self._found[one] = self._rates(one)
        return self._found[one]

    def _rates(self, one: Parameter) -> _Rates:
        size, answer, base = self._size(one), self.answer, self.base.found
        stencil, variants = self._variants(one, size)

        def posed(variant: _Variant) -> tuple[Floats, Floats, Floats]:
            """Residual (3n,) of a variant at the answer's u, offsets (m,) of rigid points, held values (3n,)."""
            found, state = variant.found, _state(variant.found, answer.piece, answer.hi, answer.lo, answer.reaction)
            left = found.plate.residual(found.springs.arrays, variant.load.nodal, answer.hi, answer.lo)
            left = np.where(base.held.dofs, 0.0, left - found.contact_rows.T @ state.line)
            return left, state.offset, found.held.values

        each = {offset: posed(variant) for offset, variant in variants.items()}
        force, shift, held = (stencil.rate({offset: parts[i] for offset, parts in each.items()}) for i in range(3))
        try:
            moved = self.problem.core.with_distance(base.contacts.distance + shift).solve_on(
                self.base.load.nodal + force, base.held.values + held, answer.piece
            )
        except RuntimeError:
            raise InputError("the plate can move on its contact state: no derivative.", one.path) from None
        du, reaction = (moved.hi - answer.hi) + (moved.lo - answer.lo), moved.reaction - answer.reaction
        numbers, margins = {0: self.result.numbers}, dict[int, Floats]()
        for offset, variant in variants.items():
            part = offset * stencil.step
            hi = answer.hi + part * du
            lo = answer.lo + ((answer.hi - hi) + part * du)
            state = _state(variant.found, answer.piece, hi, lo, answer.reaction + part * reaction)
            moving = replace(answer, hi=hi, lo=lo, reaction=state.reaction, shared=state.reaction, gap=state.gap)
            if offset:
                numbers[offset] = self._result(variant, replace(moving, solution=None)).numbers
            margins[offset] = state.margins
        valid, leaves = self._valid(one, size, stencil, margins)
        return _Rates(size, stencil.rate(numbers), self._kinks(stencil, numbers), valid, leaves)

    def _kinks(self, stencil: _Stencil, numbers: Mapping[int, Floats]) -> Bools:
        """Mask (k,) of numbers with a kink: slopes before and after the middle of three parameter values differ."""
        middle = min(max(0, min(numbers) + 1), max(numbers) - 1)
        low, here, high = (numbers[middle + offset] for offset in (-1, 0, 1))
        second, first = np.abs(low - 2.0 * here + high), np.abs(here - low) + np.abs(high - here)
        kinds = np.array([number.quantity.kind for number in self.result.catalogue.numbers])
        size = np.abs(np.nan_to_num(numbers[0]))
        largest = {kind: size[kinds == kind].max() for kind in np.unique(kinds).tolist()}
        least = np.array([largest[kind] for kind in kinds.tolist()])
        return np.asarray((second > _KINK * first) & (second > _LEAST_KINK * stencil.step * least))

    def _size(self, one: Parameter) -> float:
        """Reference size of a parameter: its value or, where it may be 0, at least the size of similar quantities."""
        force, travel = self._sizes
        if one.is_positive:
            return abs(one.value)
        if one.travels:
            return max(abs(one.value), travel) or 1.0
        exponents, length = one.dimension, self.base.found.mesh.size
        size = force ** exponents[0] * length ** exponents[1] if any(exponents) else 0.1
        return max(abs(one.value), size) or 1.0

    def _variants(self, one: Parameter, size: float) -> tuple[_Stencil, dict[int, _Variant]]:
        """Stencil, and the variants at its offsets; a one-sided stencil if the input refuses values on one side."""
        refused: InputError | None = None
        for stencil in _LINEAR if one.is_linear else _STIFF:
            try:
                values = {offset: one.value + offset * stencil.step * size for offset in stencil.weights}
                return stencil, {at: self._variant(one, value) if at else self.base for at, value in values.items()}
            except InputError as error:
                refused = refused or error
        assert refused is not None
        raise refused

    def _variant(self, one: Parameter, value: float) -> _Variant:
        base = self.base.found
        model, combination = one.varied(base.model, self.input.tables, self.base.combination, value)
        with self._reuse:
            found = (
                self._loose if model is base.model else discretise(model, [plate.own.mesh for plate in base.members])
            )
        _require_alike(one, base, found)
        factors = combination.factors or {}
        if found.model.round_factors(factors):
            found = tightened_by(unfactored(found), factors, lambda now: None).discretisation
        return _Variant(found, combination, found.load(combination))

    def _result(self, variant: _Variant, answer: Answer) -> Result:
        given = variant.found, variant.combination, self.methods, variant.load, answer, self.certificate
        return recovered(*given)

    @cached_property
    def _margins(self) -> tuple[Floats, Floats]:
        """Distances (2, m) of the points from the ends of their pieces, 0 within rounding; reference size (m,) of each.

        The size is the largest travel on flat pieces. On sloped pieces it is the force at the largest travel, at most
        the largest force.
        """
        answer, (force, travel) = self.answer, self._sizes
        state = _state(self.base.found, answer.piece, answer.hi, answer.lo, answer.reaction)
        sizes = np.where(state.slope == 0.0, travel, np.minimum(force, state.slope * travel))
        return np.where(state.margins <= _AT_END * sizes, 0.0, state.margins), sizes

    def _valid(
        self, one: Parameter, size: float, stencil: _Stencil, margins: Mapping[int, Floats]
    ) -> tuple[tuple[float, float], bool]:
        """Parameter range in which every margin is positive to first order; whether a point leaves its piece at once.

        ``margins`` are the distances (2, m) of points from the ends of their pieces, at each offset of the stencil.
        """
        own, sizes = self._margins
        finite = np.isfinite(own)
        slope = stencil.rate({offset: np.where(finite, each, 0.0) for offset, each in margins.items()})
        at_end = finite & (own == 0.0)
        leaves = bool((at_end & (np.abs(slope) > _REACHED * sizes)).any())
        moving = finite & ~at_end & (np.abs(slope) > _STILL * sizes)
        steps = -own[moving] / slope[moving]
        low, high = steps[steps < 0.0].max(initial=-np.inf), steps[steps > 0.0].min(initial=np.inf)
        first = one.value + size * low
        if one.is_positive or (one.value >= 0.0 and "gap" in one.place):
            first = max(first, 0.0)
        return (float(first), float(one.value + size * high)), leaves


def _require_alike(one: Parameter, base: Discretisation, other: Discretisation) -> None:
    """Refuse a parameter that moves the mesh, or changes the kind of a support or the rows of its points."""

    def alike(points: ContactPoints, others: ContactPoints) -> bool:
        pairs = zip(points.rows.arrays, others.rows.arrays, strict=True)
        return (
            len(points) == len(others)
            and np.array_equal(points.law, others.law)
            and all(map(np.array_equal, *zip(*pairs, strict=True)))
            and [len(law.slopes) for law in points.laws] == [len(law.slopes) for law in others.laws]
        )

    same = np.array_equal(base.mesh.points, other.mesh.points) and np.array_equal(base.held.dofs, other.held.dofs)
    if not (same and alike(base.contacts, other.contacts) and alike(base.springs, other.springs)):
        why = "another value moves the mesh or changes the kind of a support."
        raise InputError(why, one.path)


@kept
def _direct(problem: ContactProblem, combination: str) -> Direct:
    combinations = problem.discretisation.model.effective_combinations
    return Direct(problem, next(one for one in combinations if one.name == combination))


@kept
def _problem(result: Result) -> ContactProblem:
    """The contact problem of a result, on its mesh."""
    return unfactored(discretise(result.model, [one.mesh for one in result.members.values()]))


def sensitivity(problem: ContactProblem, combination: str, name: str) -> Sensitivity:
    """Derivatives of the number ``name`` in a combination of the problem's model.

    Raises
    ------
    InputError
        If there is no such number, it is a count, or the answer is not unique.
    """
    direct = _direct(problem, combination)
    catalogue = direct.result.catalogue
    number = catalogue.numbers[catalogue.by_name[known(name, catalogue.by_name, "number", "sensitivity")]]
    if number.quantity.kind == "count":
        raise InputError(f"{name} is a count, and so has no derivative.", "sensitivity")
    return direct.sensitivity(number)


def of_result(result: Result, name: str) -> Sensitivity:
    """Derivatives of the number ``name`` of a result; see `Result.sensitivity`."""
    if result.combination is None or result.status != "solved":
        found = "no equilibrium" if result.status != "solved" else "a load of its own"
        raise InputError(f"found {found}; only a solved combination of the model has derivatives.", "sensitivity")
    if any(one.between for one in result.model.support) and not result.plates:
        raise InputError("found the result of one of several plates; take the result of all plates.", "sensitivity")
    return sensitivity(_problem(result), result.combination.name, name)
