"""Results of a study: its table, quantiles, first-order sensitivities, and probabilities that a check fails."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from signorini.base.arguments import checked, known
from signorini.base.packages import package
from signorini.discretise.rows import Bools, Floats
from signorini.studies.variant import Row

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
"""Probabilities of the quantiles in the summary of a study."""
_CONFIDENCE = 0.95
"""Confidence of the intervals given for probabilities of failure."""


@dataclass(frozen=True)
class FailureProbability:
    """Probability that a check fails, from the variants of a random study.

    The interval has 95 % confidence for n independent variants (Clopper, Pearson 1934); with a Latin hypercube the
    scatter is hardly larger (Owen 1997). ``certain`` counts variants that fail with utilisation − ±, ``possible`` those
    that fail with utilisation + ±.
    """

    failed: int
    count: int
    interval: tuple[float, float]
    certain: int
    possible: int

    @property
    def value(self) -> float:
        """Estimate of the probability of failure: the part of the counted variants that fail."""
        return self.failed / self.count


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Study:
    """Rows of a study in the order of the variants.

    Parameters
    ----------
    rows : tuple of dict
        Column values of each variant: "row", every parameter by its path, "status", "message", "model_sha256",
        "elements", "certificate" (largest error), and each result NAME with "plus_minus:NAME" and "combination:NAME".
    parameters, results : tuple of str
        Names of the parameters and of the results.
    count : int
        Number of variants of the study; more than the rows if other shards have the others.
    random : bool
        Whether all parameters are random.
    """

    rows: tuple[Row, ...]
    parameters: tuple[str, ...]
    results: tuple[str, ...]
    count: int
    random: bool

    def __repr__(self) -> str:
        """Show the number of variants and the names of parameters and results."""
        return f"Study({len(self.rows)} of {self.count} variants, {', '.join((*self.parameters, *self.results))})"

    def __getitem__(self, name: str) -> Floats:
        """Values (n,) of a numeric column of the study's table; NaN for variants without a value."""
        columns = self.rows[0] if self.rows else ()
        return np.array([row[known(name, columns, "column", "name", "This study")] for row in self.rows], np.float64)

    @cached_property
    def solved(self) -> Bools:
        """Mask (n,) of the variants with status "solved"."""
        return np.array([row["status"] == "solved" for row in self.rows], np.bool_)

    def to_dataframe(self) -> Any:
        """Return the rows as a `pandas.DataFrame`; pandas must be installed."""
        return package("pandas").DataFrame(list(self.rows)).set_index("row")

    def quantiles(self, result: str) -> Mapping[float, float]:
        """Return quantiles of a result over the solved variants, by probability."""
        values = self[result][self.solved]
        values = values[np.isfinite(values)]
        found = np.quantile(values, QUANTILES) if len(values) else np.full(len(QUANTILES), np.nan)
        return dict(zip(QUANTILES, found.tolist(), strict=True))

    def failure_probability(self, result: str) -> FailureProbability:
        """Estimate the probability that a utilisation exceeds 1; a variant without equilibrium counts as failed.

        Variants that are refused, failed to run or are not certified are not counted.
        """
        from scipy.stats import binomtest

        value, width = self[result], np.nan_to_num(self[f"plus_minus:{result}"])
        lost = np.array([row["status"] == "no_equilibrium" for row in self.rows], np.bool_)
        counted = (self.solved & ~np.isnan(value)) | lost
        failed, certain, possible = (
            int((counted & (lost | (of > 1.0))).sum()) for of in (value, value - width, value + width)
        )
        total = int(counted.sum())
        if not total:
            return FailureProbability(0, 0, (0.0, 1.0), 0, 0)
        low, high = binomtest(failed, total).proportion_ci(_CONFIDENCE, "exact")
        return FailureProbability(failed, total, (float(low), float(high)), certain, possible)

    def sensitivities(self, result: str) -> Mapping[str, float]:
        """Estimate the first-order sensitivity of a result y to each parameter x: Var(E[y | x]) / Var(y).

        The solved variants are grouped by equal values of x or, if there are many values, into groups of equal size.
        The estimate is ε² of the analysis of variance, which the number of groups does not bias (Kelley 1935; Plischke,
        Borgonovo, Smith 2013). It is NaN if y or x does not vary.
        """
        used = self.solved & np.isfinite(self[result])
        y = self[result][used]
        found = {}
        for name in self.parameters:
            given = [row[name] for row, use in zip(self.rows, used, strict=True) if use]
            found[name] = _first_order(_grouped(given), y)
        return found


def _grouped(values: list[Any]) -> np.ndarray[Any, np.dtype[np.int64]]:
    """Return the group number (n,) of each value: one group per value or, with many values, √n groups of equal size."""
    different = sorted(set(map(repr, values)))
    most = max(2, math.isqrt(len(values)))
    if len(different) <= most or not all(isinstance(value, int | float) for value in values):
        number = {value: index for index, value in enumerate(different)}
        return np.array([number[repr(value)] for value in values], np.int64)
    ranks = np.argsort(np.argsort(values, kind="stable"), kind="stable")
    return np.asarray(ranks * most // len(values), np.int64)


def _first_order(group: np.ndarray[Any, np.dtype[np.int64]], y: Floats) -> float:
    """Return ε², the first-order sensitivity, of results y (n,) whose group numbers are ``group`` (n,).

    Examples
    --------
    >>> x = np.repeat(np.arange(10.0), 50)
    >>> float(round(_first_order(x.astype(int), x), 9))
    1.0
    """
    count = int(group.max(initial=-1)) + 1
    if count < 2 or count >= len(y) or np.ptp(y) <= 1e-12 * np.abs(y).max():
        return float("nan")
    size = np.bincount(group)
    means = np.bincount(group, y) / size
    within, total = float(((y - means[group]) ** 2).sum()), float(((y - y.mean()) ** 2).sum())
    error = within / (len(y) - count)
    return float(max(0.0, (total - within - (count - 1) * error) / total))
