"""Rounds of tightening: to which force the bolts of a support are tightened, and in which sequence."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import Field

from signorini.expression import PointValues
from signorini.model import base
from signorini.model.field import PositivePointScalar
from signorini.model.support import Support


class Tightening(base.Table):
    """One round of tightening of the bolts of a support."""

    support: base.Text = Field(description="Name of the support whose points are the bolts.")
    force: PositivePointScalar = Field(
        description="Force to which each bolt is tightened: a number, an expression, or a list with one value a point."
    )
    sequence: tuple[base.Counts, ...] | None = Field(
        default=None,
        min_length=1,
        description="Groups of points that are tightened together, one group after the other: [[1, 7], [4, 10]]. "
        "Points count from 1. Default: all points together.",
    )
    case: base.Text | None = Field(
        default=None,
        description="The force is a case of this name: combinations give its factor, and without a factor the round "
        "is left out. Default: factor 1 in all.",
    )

    def complaints_of(self, support: Support) -> Iterator[base.Complaint]:
        """Yield the faults of this round of a support, with places relative to this table."""
        if support.preload is not None:
            yield ("support",), f'"{support.name}" has a preload. Leave preload and order out there: force stands here.'
        yield from ((("support",), message) for _, message in support.bolt_complaints())
        count, seen = support.point_count, set[int]()
        if isinstance(self.force, PointValues) and len(self.force.values) != count:
            yield ("force",), base.miscounted(len(self.force.values), count)
        for place, group in enumerate(self.sequence or ()):
            for number in group:
                if number > count:
                    yield ("sequence", place), f'found point {number}; "{support.name}" has the points 1 to {count}.'
                elif number in seen:
                    why = f"found point {number} twice in one round."
                    yield ("sequence", place), f"{why} Give another [[tightening]] for the second time."
                seen.add(number)
