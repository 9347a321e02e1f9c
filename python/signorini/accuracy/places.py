"""Half-widths of places: of edges of contact, and of where fields are largest and smallest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from signorini.accuracy.half_width import rounded
from signorini.accuracy.meshes import side
from signorini.discretise.rows import Floats
from signorini.results.quantities import Path
from signorini.results.result import Result


def boundary_widths(result: Result, other: Result) -> dict[Path, float | None]:
    """Half-widths of every coordinate of edges of contact: the way to the edge on the other mesh, along each axis."""
    values: dict[Path, float | None] = {}
    for index, (mine, others) in enumerate(zip(result.supports, other.supports, strict=True)):
        segments = [np.stack([line[:-1], line[1:]], axis=1) for line in others.contact_boundary if len(line) > 1]
        for line, vertices in enumerate(mine.contact_boundary if segments else ()):
            for vertex, way in enumerate(rounded(np.abs(_ways(vertices, segments))).tolist()):
                for axis in (0, 1):
                    values[("supports", index, "contact_boundary", line, vertex, axis)] = way[axis]
    return values


def places_of_extremes(result: Result, numbers: Mapping[Path, float | None]) -> dict[Path, float | None]:
    """Half-widths of the places of extremes: how far nodes reach that may hold the extreme, within its half-width."""
    values: dict[Path, float | None] = {}
    spacing, points = 0.5 * side(result.mesh), result.stress_nodes.points
    for field, ends in result.extremes.items():
        path: Path = (field,) if field == "deflection" else ("fields", field)
        for name, value, at in (("max", ends.max, ends.max_at), ("min", ends.min, ends.min_at)):
            width = numbers[(*path, name)]
            near = points[np.flatnonzero(np.abs(result.fields[field] - value) <= 2.0 * (width or 0.0))]
            far = rounded(np.abs(near - at).max(axis=0, initial=0.0) + spacing).tolist()
            for axis in (0, 1):
                values[(*path, f"{name}_at", axis)] = None if width is None else far[axis]
    return values


def _ways(points: Floats, lines: Sequence[Floats]) -> Floats:
    """Vectors (q, 2) from points to the nearest place of lines of segments (k, 2, 2)."""
    a, b = np.concatenate(lines).transpose(1, 0, 2)
    along = b - a
    squared = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    result = np.empty_like(points)
    for number, at in enumerate(points):
        share = np.clip(((at - a) * along).sum(axis=1) / squared, 0.0, 1.0)
        ways = a + share[:, None] * along - at
        result[number] = ways[np.argmin((ways**2).sum(axis=1))]
    return result
