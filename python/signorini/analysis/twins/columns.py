"""Half-widths of a table's columns, row by row: those of the same numbers of a combination by itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from signorini.analysis.twins.compared import Meshes, compared
from signorini.analysis.twins.leaves import Path
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats
from signorini.model import Combination
from signorini.results.columns import Column, Layout
from signorini.results.result import FIELDS
from signorini.results.section_result import paths_of
from signorini.singularities.named import singularities_of
from signorini.singularities.singularity import Singularity

ENDING = ":plus_minus"
_TOGETHER = 4096
"""Rows that are compared at once."""
_OF_PROBE: dict[str, Path] = {"deflection": ("deflection",)}
_OF_PROBE |= {name: ("rotation", at) for at, name in enumerate(("rotation_x", "rotation_y"))}
_OF_PROBE |= {name: ("moment", at) for at, name in enumerate(("mx", "my", "mxy"))}
_OF_PROBE |= {name: ("shear", at) for at, name in enumerate(("qx", "qy"))}


@dataclass(frozen=True, eq=False)
class Rows:
    """The columns of a table that have half-widths, and under which loads their rows are."""

    found: Discretisation
    layout: Layout

    @cached_property
    def columns(self) -> Mapping[str, Path]:
        """The path of the same number of a result by itself, by the column's name."""
        paths: dict[str, Path] = {}
        for index, (support, points) in enumerate(zip(self.layout.model.support, self.layout.supports, strict=True)):
            name, of = support.name, ("supports", index)
            paths[f"reaction:{name}"] = (*of, "reaction")
            if support.area is not None:
                paths |= {f"{key}:{name}": (*of, key) for key in ("max_pressure", "contact_area")}
            for number in range(len(points.positions) if support.place == "at" else 0):
                at = (*of, "points", number)
                paths |= {f"{key}_at:{name}[{number + 1}]": (*at, key) for key in ("reaction", "gap")}
        for probe in range(len(self.layout.probes)):
            paths |= {f"probe[{probe + 1}]:{name}": ("probes", probe, *_OF_PROBE[name]) for name in FIELDS}
        paths |= zip(self.layout.through, paths_of(self.layout.model), strict=True)
        for name in self.layout.fields:
            field = ("deflection",) if name == "deflection" else ("fields", name)
            paths |= {f"{side}:{name}": (*field, side) for side in ("max", "min")}
        return paths

    def widths(
        self, tables: Sequence[Mapping[str, Column]], meshes: Meshes, combinations: Sequence[Combination]
    ) -> Mapping[str, Floats]:
        """Half-widths (k,) of the columns, by their names with an ending; ``tables`` are in the order of the meshes.

        NaN where a number has none, or a mesh no equilibrium.
        """
        columns = {name: path for name, path in self.columns.items() if all(name in table for table in tables)}
        out = {name: np.empty(len(combinations)) for name in columns}
        for first in range(0, len(combinations), _TOGETHER):
            rows = slice(first, first + _TOGETHER)
            found = [{path: np.asarray(of[name])[rows] for name, path in columns.items()} for of in tables]
            named = self._named(combinations[rows])
            widths, _ = compared(found, meshes, self.layout.model, self._figures, named)
            for name, width in zip(columns, widths, strict=True):
                out[name][rows] = width
        return {name + ENDING: width for name, width in out.items()}

    @cached_property
    def _figures(self) -> Mapping[str, object]:
        supports = [{"name": support.name} for support in self.layout.model.support]
        return {"supports": supports, "probes": [{"at": at} for at in self.layout.probes.tolist()]}

    def _named(self, combinations: Sequence[Combination]) -> list[tuple[Sequence[Singularity], Bools]]:
        """Singularities of the supports, and of every load case with the rows in which it acts."""
        acting = [{case for case, factor in (one.factors or {}).items() if factor} for one in combinations]
        found: list[tuple[Sequence[Singularity], Bools]] = [
            (singularities_of(self.found), np.ones(len(acting), np.bool_))
        ]
        for case in sorted(set().union(*acting)):
            where = np.array([case in cases for cases in acting], np.bool_)
            found.append((singularities_of(self.found, case), where))
        return found
