"""Values and utilisations of checks, from the other numbers of a catalogue."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats, Ints
from signorini.equilibrium.stability import load_factors
from signorini.errors import InputError
from signorini.model import Check, Combination, Model
from signorini.model.check import OVERTURNING
from signorini.results.quantities import ENDS, FIELDS, PICTURED, Catalogue, Quantity, measures, on_plate, with_extremes


@dataclass(frozen=True, eq=False)
class CheckedNumbers:
    """Indices in a catalogue of the numbers of one check: the measured numbers (m,), its value, its utilisation.

    An overturning check measures its own value, 1/λ with the load factor λ of overturning.
    """

    check: Check
    measured: Ints
    value: int | None
    utilisation: int

    def governing(self, values: Floats) -> tuple[Ints, Floats]:
        """Index (k,) in ``measured`` of the most utilised number in each of k results, and its utilisation (k,)."""
        used = self.check.used(values[:, self.measured])
        which = np.where(np.isnan(used), -np.inf, used).argmax(axis=1)
        return which, np.take_along_axis(used, which[:, None], axis=1)[:, 0]


@kept
def checks_in(catalogue: Catalogue) -> tuple[CheckedNumbers, ...]:
    """Checks for which a catalogue has both the check's utilisation and at least one number that the check measures."""
    places: dict[int, dict[str, int]] = {}
    for place, one in enumerate(catalogue):
        if one.check is not None:
            places.setdefault(one.owner, {})[one.what] = place
    result = []
    for own in places.values():
        check, value = catalogue.numbers[own["utilisation"]].check, own.get("value")
        assert check is not None
        measured = [place for place, one in enumerate(catalogue) if measures(check, one)]
        if check.of == OVERTURNING:
            measured = [] if value is None else [value]
        if measured:
            result.append(CheckedNumbers(check, np.array(measured, np.int64), value, own["utilisation"]))
    return tuple(result)


def checked_fields(model: Model) -> tuple[str, ...]:
    """Names of the fields whose extremes are measured by a check of the model."""
    subjects = {on_plate(name, plate): name for name in with_extremes(model) for plate in ("", *model.plates)}
    wanted = {f"{subject}{end}": name for subject, name in subjects.items() for end in ("", *(f".{x}" for x in ENDS))}
    return tuple(name for name in FIELDS if name in {wanted.get(check.of) for check in model.check})


def utilisations(model: Model) -> dict[str, tuple[str, Check]]:
    """For each utilisation field "utilisation:<check>" of a model: name of the measured field, and the check."""
    fields = {name: field for field in with_extremes(model) for name in (field, on_plate(field, model.part))}
    checks = (check for check in model.original.check if check.of in fields)
    return {f"utilisation:{check.name}": (fields[check.of], check) for check in checks}


def quantity_of(model: Model, field: str) -> tuple[Quantity, Quantity]:
    """Quantity of a field, and the one that it is computed from: itself or, for a utilisation, the checked field."""
    if field in PICTURED:
        return PICTURED[field], PICTURED[field]
    measured, check = utilisations(model)[field]
    return Quantity(field, "part", f"utilisation, {check.name}"), PICTURED[measured]


def completed(catalogue: Catalogue, values: Floats, combinations: Sequence[Combination] | None = None) -> Floats:
    """Fill in the checks' values and utilisations among the numbers (k, n); NaN in combinations without the check."""
    result = values.copy()
    for one in checks_in(catalogue):
        which, utilisation = one.governing(values)
        result[:, one.utilisation] = utilisation
        if one.value is not None:
            result[:, one.value] = np.take_along_axis(values[:, one.measured], which[:, None], axis=1)[:, 0]
        if combinations is not None:
            others = [row for row, combination in enumerate(combinations) if not one.check.applies_to(combination)]
            result[np.ix_(others, [one.utilisation, one.utilisation if one.value is None else one.value])] = np.nan
    return result


def overturned(
    discretisation: Discretisation, catalogue: Catalogue, values: Floats, loads: Sequence[Combination | str]
) -> Floats:
    """Fill in the values 1/λ of overturning checks among the numbers (k, n) if the load is a combination."""
    result, rows = values.copy(), [row for row, load in enumerate(loads) if not isinstance(load, str)]
    combinations = [load for load in loads if not isinstance(load, str)]
    for one in checks_in(catalogue):
        if one.check.of == OVERTURNING:
            growing = one.check.growing(discretisation.model.cases)
            result[rows, one.value] = 1.0 / load_factors(discretisation, combinations, growing)
    return result


def widened(catalogue: Catalogue, values: Floats, widths: Floats, limited: bool) -> Floats:
    """Fill in the half-widths of checks in the half-widths (k, n) of all numbers.

    A check's value has the half-width of the governing number; its utilisation has this half-width divided by the
    limit. The load factor of overturning is exact, with half-width 0, unless supports have force limits (``limited``):
    its half-width then comes from other meshes, as for other numbers.
    """
    result = widths.copy()
    for one in checks_in(catalogue):
        which = one.governing(values)[0][:, None]
        value, width = (np.take_along_axis(of[:, one.measured], which, axis=1)[:, 0] for of in (values, widths))
        if one.check.of == OVERTURNING and not limited:
            width = np.zeros(len(value))
        result[:, one.utilisation] = width / np.abs(one.check.limit_of(value))
        if one.value is not None:
            result[:, one.value] = width
    return result


def require_measured(
    discretisation: Discretisation, catalogue: Catalogue, what: str, *checks: Check, advice: str = "Remove the check."
) -> None:
    """Raise `InputError` if a check measures a number that a catalogue lacks; ``what`` begins the message."""
    known = [one.check for one in checks_in(catalogue)]
    for check in checks:
        if check not in known:
            index = discretisation.model.check.index(check)
            raise InputError(f'{what} has no "{check.of}". {advice}', place=("check", index, "of"))
