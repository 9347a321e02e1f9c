"""Checks of results against limits: the tables [[check]] of the input."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
from pydantic import BeforeValidator, Field, WithJsonSchema

from signorini.errors import unknown
from signorini.expression import LEAST
from signorini.model import base
from signorini.model.cases import Cases, growing_in
from signorini.model.combination import Combination, Combinations
from signorini.model.problems import as_list

OVERTURNING = "overturning"
"""Value of the key ``of`` that checks the equilibrium of the plate as a rigid body, instead of a result."""


def _bounds(value: object) -> object:
    value = as_list(value)
    return value if isinstance(value, list | tuple) else (-base.number(value), base.number(value))


Bounds = Annotated[
    tuple[base.Number, base.Number],
    BeforeValidator(base.listed(2, "one number, or two: [lower, upper]")),
    BeforeValidator(_bounds),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}, "minItems": 2}]}),
]


class Check(base.Named):
    """A check of a result against a limit: utilisation = value / limit in every combination."""

    of: base.Text = Field(
        description='Checked result: a field such as "von_mises", a number such as "soil.max_pressure", a number at '
        'all points of a support, as in "anchors[*].reaction", or "overturning".'
    )
    limit: Bounds | None = Field(
        default=None,
        description="Limit of the result's magnitude, or [lower, upper] with lower < 0 < upper; required, but for "
        "overturning the default is 1.",
    )
    combinations: tuple[base.Text, ...] = Field(default=(), description="Names of checked combinations; default all.")
    group: base.Text = Field(default="", description="Group of combinations that is checked; default all combinations.")
    grows: tuple[base.Text, ...] = Field(
        default=(),
        description="For overturning: load cases that are multiplied by λ; the checked value is 1/λ for the λ at which "
        "equilibrium ends; other load cases stay constant; default with [cases]: all except permanent and preload.",
    )

    def _complaints(self) -> Iterator[base.Complaint]:
        if self.of != OVERTURNING and self.grows:
            yield ("grows",), f'grows is only for a check of "{OVERTURNING}". Remove grows.'
        if self.of != OVERTURNING and self.limit is None:
            yield ("limit",), "'limit' is missing. Give the largest allowed value."
        if self.limit is not None and not self.limit[0] < 0.0 < self.limit[1]:
            yield ("limit",), "limit must be a number greater than 0, or [lower, upper] with lower < 0 < upper."
        if self.limit is not None and min(map(abs, self.limit)) < LEAST:
            yield ("limit",), f"found {min(self.limit, key=abs):g}; it must be at least {LEAST:g} in size."
        if self.combinations and self.group:
            yield ("group",), "found the keys combinations and group; give one of them."

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest allowed value of the checked quantity; (-1, 1) if the input gives no limit."""
        return self.limit or (-1.0, 1.0)

    def limit_of(self, values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Limit of each value (same shape): the lower limit if the value is negative, else the upper limit."""
        return np.where(values < 0.0, *self.bounds)

    def used(self, values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Utilisation value / limit of each checked value (same shape)."""
        return np.asarray(values / self.limit_of(values))

    def includes(self, group: str, combinations: Combinations) -> bool:
        """Whether this check applies to every combination of ``group``; ``group=""`` means all combinations."""
        whole = combinations.groups.get(self.group, 0) == len(combinations)
        return not self.combinations and (whole or self.group in ("", group))

    def applies_to(self, combination: Combination) -> bool:
        """Whether this check applies to the combination."""
        return self.group in ("", combination.group) and combination.name in (self.combinations or (combination.name,))

    def growing(self, described: Cases) -> tuple[str, ...]:
        """Load cases whose factors a check of overturning increases: ``grows``, or by default `growing_in`."""
        return self.grows or growing_in(described)

    def complaints_of(
        self, cases: Sequence[str], combinations: Combinations, described: Cases
    ) -> Iterator[base.Complaint]:
        """Yield a problem for each unknown load case, combination or group; paths are within this table."""
        if self.of == OVERTURNING and not self.growing(described):
            yield ("grows",), "'grows' is missing. Name the load cases that overturn the plate, such as [\"W\"]."
        for position, case in enumerate(self.grows):
            if case not in cases:
                yield ("grows", position), unknown("load case", case, cases)
        if self.group and self.group not in combinations.groups:
            yield ("group",), unknown("group", self.group, tuple(combinations.groups))
        missing: dict[Any, int] = {name: position for position, name in enumerate(self.combinations)}
        for name in combinations.names() if missing else ():
            missing.pop(name, None)
        for name, position in missing.items():
            yield ("combinations", position), f'there is no combination "{name}". Give the name of a combination.'
