"""Summary of the checks of a model: the governing combination, value, utilisation and place of each."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.discretise import Discretisation
from signorini.equilibrium.stability import load_factors
from signorini.model.check import OVERTURNING
from signorini.results.catalogue import catalogue_of
from signorini.results.checks import checks_in, require_measured
from signorini.results.envelope import NONE
from signorini.results.frames import place_of_number
from signorini.results.quantities import EXTREMES, Number, with_extremes
from signorini.results.result import Result


@dataclass(frozen=True)
class CheckResult:
    """Result of one check in its governing combination; None where no checked combination has a number."""

    name: str
    of: str  # the field or number that the check measures
    value: float | None  # measured value; for overturning 1/λ, λ the load factor at the limit; None if infinite
    limit: float | None  # limit for values with the sign of this value
    utilisation: float | None  # ratio of value to limit
    plus_minus: float | None  # half-width of the utilisation
    governing: str | None  # name of the combination with the largest utilisation
    # position of the extreme of a field, a pressure or a strip; else the name of the object, such as "probe[1]"
    place: tuple[float, float] | str | None
    without_equilibrium: int  # number of checked combinations that have no equilibrium, and so no numbers
    # True if utilisation + ± ≤ 1 in all combinations and all have equilibrium; False if utilisation − ± > 1 in any
    passed: bool | None
    verdict: str  # ``passed`` in words; if it is None, the reason


def require_checks(discretisation: Discretisation) -> None:
    """Refuse checks of unknown numbers and, in a table of combinations, of numbers that tables do not have."""
    model = discretisation.model
    if model.check and (catalogue := catalogue_of(discretisation, with_extremes(model))) and model.tabulated:
        advice = 'This check needs all results of each combination: give output.combinations = "each".'
        require_measured(discretisation, catalogue.in_tables, "a table of combinations", *model.check, advice=advice)


def check_results(results: Results, estimates: Estimates | None = None) -> tuple[CheckResult, ...]:
    """Results of all checks of a model, in their order.

    Examples
    --------
    >>> from signorini import Model, solve
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7}],
    ...     load=[{"pressure": 5e3}],
    ...     check=[{"name": "bearing", "of": "soil.max_pressure", "limit": 10e3}],
    ... )
    >>> (bearing,) = check_results(solve(model))
    >>> round(bearing.utilisation, 6), bearing.governing, bearing.place, bearing.verdict
    (0.5, 'all', (0.0, 0.0), 'passed')
    """
    catalogue = results.combined.layout.catalogue
    places = {one.owner: place for place, one in enumerate(catalogue) if one.home == "check" and one.what == "value"}
    return tuple(_result(results, estimates, index, places[index]) for index in range(len(results.model.check)))


def _result(results: Results, estimates: Estimates | None, index: int, place: int) -> CheckResult:
    check, combinations = results.model.check[index], results.model.effective_combinations
    missing = [row for row in results.combined.unsolved if check.applies_to(combinations[row])]
    ends = results.envelope.values.sides
    known = [(float(values[place]), int(by[place])) for values, by in ends if by[place] != NONE]
    if check.of == OVERTURNING and missing:
        # The utilisation of overturning exceeds 1 in combinations without equilibrium.
        growing = check.growing(results.model.cases)
        factors = load_factors(results.discretisation, [combinations[row] for row in missing], growing)
        with np.errstate(divide="ignore"):
            known += zip((1.0 / factors).tolist(), missing, strict=True)
    used = [float(check.used(np.array(value))) for value, _ in known]
    if not used:
        verdict = "no equilibrium" if missing else "no value"
        return CheckResult(check.name, check.of, None, None, None, None, None, None, len(missing), None, verdict)
    value, row = known[int(np.argmax(used))]
    limit, utilisation, name = float(check.limit_of(np.array(value))), max(used), results.key(row)
    width = None if estimates is None else estimates.half_width(f"utilisation:{check.name}", row)
    if estimates is not None and row in missing and not results.model.has_limits:
        width = 0.0
    reach = (-math.inf, -math.inf) if estimates is None else estimates.reach(check)
    passed, verdict = judged(utilisation, width, estimates is not None, len(missing), reach)
    where = None if check.of == OVERTURNING else _place(results[name], index)
    own, part, half = (value, utilisation, width) if math.isfinite(utilisation) else (None, None, None)
    return CheckResult(check.name, check.of, own, limit, part, half, name, where, len(missing), passed, verdict)


def judged(
    utilisation: float,
    width: float | None,
    estimated: bool,
    missing: int,
    reach: tuple[float, float] = (-math.inf, -math.inf),
) -> tuple[bool | None, str]:
    """Whether a check passes, and the verdict in words.

    ``width`` is the half-width of the largest utilisation, None if unknown; ``missing`` combinations have no
    equilibrium. ``reach`` is the largest utilisation − ± and utilisation + ± over all combinations with half-widths.

    Examples
    --------
    >>> judged(0.9, 0.2, estimated=True, missing=0)
    (None, 'undecided: 1 is within ±')
    >>> judged(0.9, 0.05, estimated=True, missing=0, reach=(0.85, 1.1))
    (None, 'undecided: 1 is within ±')
    """
    low, high = max(utilisation - (width or 0.0), reach[0]), max(utilisation + (width or 0.0), reach[1])
    if low > 1.0:
        return False, "failed"
    if missing:
        return None, "no equilibrium"
    if estimated and width is None:
        return None, "± unknown"
    if high > 1.0:
        return None, "undecided: 1 is within ±"
    return True, "passed"


def _place(result: Result, index: int) -> tuple[float, float] | str:
    """Position of the number that governs a check in one combination, or the name of its support, section or probe."""
    numbers: tuple[Number, ...] = result.catalogue.numbers
    own = next(one for one in checks_in(result.catalogue) if numbers[one.utilisation].owner == index)
    one: Number = numbers[own.measured[own.governing(result.numbers[None])[0][0]]]
    # A probe, or another object at one point, needs no position beside its name.
    at = place_of_number(result, one) if one.home in (*EXTREMES, "support", "strip") else None
    return one.subject if at is None else (float(at[0]), float(at[1]))
