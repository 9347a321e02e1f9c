"""All validation cases, in the order of the index."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from signorini.validation import arrays, circles, design, others, rectangles, rigid, soil, squares, strips, torsion
from signorini.validation.case import Case

_FAMILIES = (squares, rectangles, circles, strips, torsion, soil, rigid, others, design, arrays)


@cache
def cases() -> Mapping[str, Case]:
    """Return every case by name."""
    every = [case for family in _FAMILIES for case in family.cases()]
    result = {case.name: case for case in every}
    assert len(result) == len(every), "two cases have the same name"
    return result
