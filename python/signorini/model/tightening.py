"""Rounds of tightening: to which force the bolts of a support are tightened, and in which sequence."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import BeforeValidator, Field, WithJsonSchema

from signorini.expression import PointValues
from signorini.model import base
from signorini.model.field import PositivePointScalar
from signorini.model.problems import as_list, describe
from signorini.model.support import Support


def _groups(value: object) -> object:
    value = as_list(value)
    if not isinstance(value, list | tuple) or not value:
        raise ValueError(f"found {describe(value)}; it must be a list of groups of points, such as [[1, 7], [4, 10]].")
    groups = [as_list(one) for one in value]
    groups = [one if isinstance(one, list | tuple) else [one] for one in groups]
    if not all(groups):
        raise ValueError("found an empty group; each group must list at least one point.")
    return groups


Sequence = Annotated[
    tuple[tuple[base.Count, ...], ...],
    BeforeValidator(_groups),
    WithJsonSchema(
        {
            "type": "array",
            "minItems": 1,
            "items": {
                "anyOf": [
                    {"type": "integer", "minimum": 1},
                    {"type": "array", "items": {"type": "integer", "minimum": 1}, "minItems": 1},
                ]
            },
        }
    ),
]


class Tightening(base.Table):
    """One round of tightening of the bolts of a support."""

    support: base.Text = Field(description="Name of the support whose points are the bolts.")
    force: PositivePointScalar = Field(
        description="Force to which each bolt is tightened: a number, an expression, or a list with one value a point."
    )
    sequence: Sequence | None = Field(
        default=None,
        description="Groups of points that are tightened together, one group after the other: [[1, 7], [4, 10]]. "
        "Points count from 1. Default: all points together.",
    )
    case: base.Text | None = Field(
        default=None,
        description="The force is a case of this name: combinations give its factor, and without one this round is "
        "left out. Default: factor 1 in all.",
    )

    def turns(self, count: int) -> tuple[tuple[int, ...], ...]:
        """Groups of points, from 0, that are tightened together, of a support with so many points."""
        if self.sequence is None:
            return (tuple(range(count)),)
        return tuple(tuple(number - 1 for number in group) for group in self.sequence)

    def complaints_of(self, support: Support) -> Iterator[base.Complaint]:
        """Yield what is wrong with this round of a support, relative to this table."""
        if support.preload is not None:
            yield (
                ("support",),
                f'"{support.name}" has the key preload; its force and its order stand here. Leave preload out there.',
            )
        for _, message in support.bolt_complaints():
            yield ("support",), message
        count = support.point_count
        if isinstance(self.force, PointValues) and len(self.force.values) != count:
            yield ("force",), base.miscounted(len(self.force.values), count)
        seen = set[int]()
        for at, group in enumerate(self.sequence or ()):
            for number in group:
                if number > count:
                    yield ("sequence", at), f'found point {number}; "{support.name}" has the points 1 to {count}.'
                elif number in seen:
                    why = f"found point {number} twice; in one round a bolt is tightened once."
                    yield ("sequence", at), f"{why} Give a second [[tightening]] for the second time."
                seen.add(number)
