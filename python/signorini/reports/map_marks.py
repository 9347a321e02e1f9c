"""Marks of maps for JSON: supports with their states and reactions, loads, sections, strips, profiles, probes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from signorini.base.numbers import estimated, number, size_of
from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats
from signorini.plot.picture import LoadMark, SupportMark
from signorini.reports.blobs import rounded
from signorini.reports.punching import KINDS_OF_LINES, Punched
from signorini.results.contact_field.lines import thinned
from signorini.results.marks import cut_marks, load_marks, support_mark, support_marks, unsolved_marks, zone_marks
from signorini.results.result import Result

EXACT = 1e-4
"""Largest distance of a left-out vertex from the drawn line, relative to the plate's size: less than a pixel."""
_DIGITS = 5
"""Number of significant digits of the coordinates of lines."""


def plate_marks(plate: Discretisation, columns: Iterable[Punched]) -> dict[str, Any]:
    """Marks of one plate that are equal in all combinations, with perimeters of those ``columns`` that are on it."""
    model, cuts, exact = plate.model, cut_marks(plate.model), plate.mesh.size * EXACT
    supports, loads = [], []
    for asked, one in zip(model.support, unsolved_marks(plate), strict=False):
        # A line support has a contact state at each vertex, so that all of its vertices are kept.
        whole = one.style == "area" and asked.where.region is None
        lines = [] if whole else _drawn(one, exact if one.style == "area" else 0.0)
        look: dict[str, Any] = {"kind": one.kind, "style": one.style, "numbers": list(one.numbers), "lines": lines}
        supports.append({"name": one.name, "words": one.label, "prints": lines_of(one.footprints, exact=exact)} | look)
    for load in load_marks(plate):
        look = {"style": load.style, "upward": load.upward, "lines": _drawn(load, exact)}
        loads.append({"case": load.case, "words": load.label, "prints": lines_of(load.footprints, exact=exact)} | look)
    names = [one.column.subject for one in plate.columns.columns]
    own = [one for one in columns if one.of.column.column.subject in names]
    return {
        "supports": supports,
        "loads": loads,
        "zones": [{"line": lines_of(one.outline, exact=exact)} for one in zone_marks(plate)],
        "sections": [{"name": one.name, "line": lines_of(one.line)} for one in cuts if one.borders is None],
        "strips": [
            {"name": one.name, "line": lines_of(one.line), "borders": lines_of(*one.borders)}
            for one in cuts
            if one.borders is not None
        ],
        "profiles": [{"name": one.name, "line": lines_of(one.places[1], exact=exact)} for one in model.profile],
        "punching": {
            kind: lines_of(*(line for one in own for line in one.lines[kind]), exact=exact)
            for kind in (KINDS_OF_LINES if own else ())
        },
        "probes": rounded([list(at) for probe in model.probe for at in probe.at]),
    }


def _drawn(mark: SupportMark | LoadMark, exact: float) -> list[list[float]]:
    """Points or lines of a mark as flat lists of coordinates x, y, x, y."""
    if mark.style == "points":
        return lines_of(*mark.positions[:, None])
    return lines_of(mark.positions, exact=exact)


def support_states(result: Result, widths: Mapping[str, Any] | None) -> list[dict[str, Any]]:
    """States of the supports of one plate: a letter for each point, c closed, o open, y yielding, and reactions."""
    model = result.model
    size = size_of([one.reaction for one in result.supports] + [size_of(one.reactions) for one in result.supports])
    marks = support_marks(result)
    known = [None] * len(result.supports) if widths is None else [*widths["supports"], *widths.get("contacts", ())]
    states = []
    for asked, mark, one, width in zip(model.support, marks, result.supports, known, strict=False):
        yields = support_mark(result.mesh, asked, one.positions, one.yielded).closed
        letters = np.full(len(mark.positions), "c") if mark.closed is None else np.where(mark.closed, "c", "o")
        if yields is not None:
            letters[yields & (letters == "c")] = "y"
        each = []
        if mark.numbers:
            of_points = [None] * len(one.reactions) if width is None else [of["reaction"] for of in width["points"]]
            each = [
                _written(float(force), width is not None, of, size)
                for force, of in zip(one.reactions, of_points, strict=True)
            ]
        total = _written(one.reaction, width is not None, None if width is None else width["reaction"], size)
        letters = letters[np.isfinite(mark.positions[:, 0])]
        same = 1 if len(set(letters.tolist())) == 1 else None
        states.append({"is": "".join(letters[:same]), "each": each, "total": f"{total} {model.units.force}".rstrip()})
    return states


def _written(value: float, told: bool, width: float | None, size: float) -> str:
    return (estimated(value, width, size) if told else number(value, size)).replace("-", "−")


def lines_of(*lines: Floats, exact: float = 0.0) -> list[list[float]]:
    """Polylines (k, 2), divided at rows of NaN, as flat lists x, y, x, y, thinned to the accuracy ``exact``."""
    pieces = (piece for line in lines for piece in _pieces(line))
    return [rounded((thinned(one, exact) if exact and len(one) > 2 else one).ravel(), _DIGITS) for one in pieces]


def _pieces(line: Floats) -> Iterator[Floats]:
    breaks = np.flatnonzero(np.isnan(line[:, 0])).tolist() if len(line) else []
    for begin, end in zip([-1, *breaks], [*breaks, len(line)], strict=True):
        if end > begin + 1:
            yield line[begin + 1 : end]
