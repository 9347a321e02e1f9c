"""Rounds of bolt tightening: the force of each bolt of a support, and the order in which bolts are tightened."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import Field

from signorini.expression import PointValues
from signorini.model import base
from signorini.model.field import PositivePointScalar
from signorini.model.support import Support


class Tightening(base.Table):
    """One round of tightening: all or some bolts of a support are tightened to a force, each at most once."""

    support: base.Text = Field(description="Name of the support whose points are the tightened bolts.")
    force: PositivePointScalar = Field(
        description="Force to which each bolt is tightened: a number, an expression, or a list with one value per "
        "point."
    )
    sequence: tuple[base.Counts, ...] | None = Field(
        default=None,
        min_length=1,
        description="Groups of points that are tightened together, in order, such as [[1, 7], [4, 10]]; "
        "points are numbered from 1; default: all points together.",
    )
    case: base.Text | None = Field(
        default=None,
        description="Load case whose factor in a combination multiplies the force; in a combination without this case "
        "the round is left out; default: factor 1 in all combinations.",
    )

    def complaints_of(self, support: Support) -> Iterator[base.Complaint]:
        """Yield the problems of this round for the bolts of ``support``; their paths are within this table."""
        if support.preload is not None:
            yield (
                ("support",),
                f'"{support.name}" has a preload. Remove its preload and order: the key force replaces both.',
            )
        yield from ((("support",), message) for _, message in support.bolt_complaints())
        count, seen = support.point_count, set[int]()
        if isinstance(self.force, PointValues) and len(self.force.values) != count:
            yield ("force",), base.wrong_length(len(self.force.values), count)
        for position, group in enumerate(self.sequence or ()):
            for number in group:
                if number > count:
                    yield ("sequence", position), f'found point {number}; "{support.name}" has the points 1 to {count}.'
                elif number in seen:
                    why = f"found point {number} twice in one round."
                    yield ("sequence", position), f"{why} Tighten it the second time in another [[tightening]]."
                seen.add(number)
