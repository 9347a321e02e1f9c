"""Half-widths of a table's columns, row by row."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from signorini.analysis.twins.compared import Meshes
from signorini.analysis.twins.half_width import FASTEST, FASTEST_OF_POINTS, half_widths
from signorini.analysis.twins.leaves import acts_at_points
from signorini.discretise.rows import Floats
from signorini.model import Model
from signorini.results.columns import Column

ENDING = ":plus_minus"
_ESTIMATED = re.compile(
    r"(reaction|max_pressure|contact_area|reaction_at|gap_at|probe\[\d+\]|section\[.*\]|strip\[.*\]|max|min):.*"
)


def column_widths(tables: Sequence[Mapping[str, Column]], meshes: Meshes, model: Model) -> Iterator[tuple[str, Floats]]:
    """Yield the half-widths (k,) of every column that has any; ``tables`` of the same rows are as the meshes are.

    NaN where a mesh has no equilibrium. What grows for ever at a point is left to the results of single combinations:
    here its half-width is as wide as the slowest convergence makes it.
    """
    fastest = FASTEST_OF_POINTS if acts_at_points(model) else FASTEST
    for name, own in tables[meshes.own].items():
        if not _ESTIMATED.fullmatch(name) or not all(name in table for table in tables):
            continue
        values = np.array([np.asarray(table[name], dtype=np.float64) for table in tables])
        size, none = np.abs(np.asarray(own, dtype=np.float64)), np.zeros(len(own))
        yield name + ENDING, half_widths(values, meshes.sizes, meshes.own, fastest, none, size, none == 0)[0]
