"""Pictures of combinations: deflection, contact pressure, moments and shears."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from signorini.analysis.accuracy import ORDER
from signorini.analysis.solve import Results
from signorini.base.forked import Forked, forked
from signorini.base.plain import plain
from signorini.discretise import Discretisation
from signorini.discretise.stressnodes import StressNodes
from signorini.output.names import (
    PICTURES,
    PRESSURE,
    REFINEMENT,
    envelope_files,
    envelope_pictures,
    enveloped,
    has_areas,
)
from signorini.results.envelope import Envelope
from signorini.results.marks import support_marks as support_marks_of
from signorini.results.panels import colours, field_range, panel, quantity, support_marks, unit_of
from signorini.results.result import Result

if TYPE_CHECKING:
    from signorini.plot import Panel, Plan

_ARTISTS = 2
"""Processes that draw: moments take as long as all else."""
_LONGEST = 44
"""Letters of a combination's name that have room above a panel."""
_MOST_ELEMENTS = 100_000
"""Elements beyond which memory is not for several processes that draw them at once."""


def caption(result: Result, ending: str) -> str:
    """Title of a picture: its heading and, where they are asked for, the half-widths of the extremes that it shows."""
    widths, said = result.asked_estimate.plus_minus, list[str]()
    if widths is None:
        return result.heading
    for field in PICTURES[ending]:
        if field == "pressure":
            every = zip(widths["supports"], result.supports, strict=True)
            told = [width["max_pressure"] for width, one in every if one.area]
        else:
            ends = widths["deflection"] if field == "deflection" else widths["fields"][field]
            told = [ends["max"], ends["min"]]
        known = [width for width in told if width is not None]
        half_width = f"± {plain(max(known), 2)} {unit_of(field, result.model.units)}".rstrip() if known else "± ?"
        said.append(half_width if len(PICTURES[ending]) == 1 else f"{field} {half_width}")
    return f"{result.heading}, extremes {', '.join(said)}"


def write_refinement(results: Results, directory: Path) -> None:
    """Draw the meshes on the way to the accuracy that was asked for."""
    steps, asked = results.refinement, results.model.mesh.accuracy
    if steps and asked is not None:
        # Only this function needs matplotlib.
        from signorini.plot import refinement_picture, save

        dofs, worst = [step.dofs for step in steps], [step.worst for step in steps]
        save(refinement_picture(dofs, worst, asked, ORDER, results.model.title), directory / REFINEMENT)


@dataclass(frozen=True, eq=False)
class Sheet:
    """Pictures of one kind in one scale.

    Parameters
    ----------
    fields : tuple of str
        Of each picture.
    named : tuple of (str, Result, str)
        The picture's file, what it shows, and its title.
    """

    fields: tuple[str, ...]
    named: tuple[tuple[str, Result, str], ...]

    @property
    def files(self) -> set[str]:
        """Names of their files."""
        return {file for file, *_ in self.named}

    @property
    def panels(self) -> int:
        """How many fields are to be drawn in all."""
        return len(self.fields) * len(self.named)

    @property
    def nodes(self) -> StressNodes:
        """Nodes of the fields."""
        return self.named[0][1].stress_nodes

    def drawn(self, plan: Plan) -> Iterator[tuple[str, bytes]]:
        """Draw them, one after another: name and content of a file."""
        # Only this function needs matplotlib.
        from signorini.plot import Picture, drawn_as_png

        limits = {}
        for field in self.fields:
            ranges = [field_range(field, result.fields, result.supports) for _, result, _ in self.named]
            limits[field] = min(low for low, _ in ranges), max(high for _, high in ranges)

        def panels(result: Result) -> list[Panel]:
            parts = (result.stress_nodes, result.fields, result.supports, result.model.units)
            return [panel(field, *parts, limit, result.extremes) for field, limit in limits.items()]

        model = self.named[0][1].model
        pictures = [
            Picture(partial(panels, one), support_marks(one.mesh, model.support, one.supports), title)
            for _, one, title in self.named
        ]
        files = (file for file, *_ in self.named)
        yield from zip(files, drawn_as_png(plan, pictures, model.units.length), strict=True)


@dataclass(frozen=True, eq=False)
class EnvelopeSheet:
    """The picture of fields' largest and, in the same scales, smallest values over combinations.

    Parameters
    ----------
    fields : tuple of str
    file, title : str
    of : tuple of (str, str)
        Combinations with the largest and the smallest value of each field.
    envelope : Envelope
    discretisation : Discretisation
    """

    fields: tuple[str, ...]
    file: str
    title: str
    of: tuple[tuple[str, str], ...]
    envelope: Envelope
    discretisation: Discretisation

    @property
    def files(self) -> set[str]:
        """Name of its file."""
        return {self.file}

    @property
    def panels(self) -> int:
        """How many fields are to be drawn in all."""
        return 2 * len(self.fields)

    @property
    def nodes(self) -> StressNodes:
        """Nodes of the fields."""
        return self.discretisation.stress_nodes

    def drawn(self, plan: Plan) -> Iterator[tuple[str, bytes]]:
        """Draw it: name and content of a file."""
        # Only this function needs matplotlib.
        from signorini.plot import Panel, Picture, drawn_as_png

        units, peaks, panels = self.discretisation.model.units, self.envelope.peaks, list[Panel]()
        for end, (side, short) in enumerate((("largest", "max"), ("smallest", "min"))):
            for field, of in zip(self.fields, self.of, strict=True):
                extremes, number = self.envelope.fields[field], self.envelope.names.index(field)
                limits = float(extremes.smallest.min()), float(extremes.largest.max())
                value = float(getattr(peaks.extremes, side)[number])
                at = getattr(peaks, f"{side}_at")[number].tolist()
                shown = self.nodes.spread(getattr(extremes, side))
                label = f"{side} {quantity(field, units)}"
                by = f"{short}: {_cut(of[end])}"
                panels.append(Panel(shown, label, colours(field), limits, [(short, value, at)], by))
        picture = Picture(lambda: panels, support_marks_of(self.discretisation), self.title)
        for content in drawn_as_png(plan, [picture], units.length, rows=2):
            yield self.file, content


def envelope_sheets(results: Results) -> list[EnvelopeSheet]:
    """Plan the pictures of envelopes: of all combinations, and of each group."""
    sheets, title = list[EnvelopeSheet](), results.model.title
    for group, file in envelope_files(results).items():
        what = f"envelope of {group}" if group else f"envelope of {results.combined.solved} combinations"
        words = ", ".join(part for part in (title, what) if part)
        for ending, name in envelope_pictures(results, file).items():
            fields, envelope = enveloped(results, ending), results.combined.over(group)
            governing = envelope.governing()
            of = tuple((results.key(governing[field][1]), results.key(governing[field][3])) for field in fields)
            sheets.append(EnvelopeSheet(fields, name, words, of, envelope, results.discretisation))
    return sheets


def _cut(name: str) -> str:
    return name if len(name) <= _LONGEST else f"{name[: _LONGEST - 1]}…"


def sheets_of(results: Results, named: Iterable[tuple[Result, str]]) -> list[Sheet]:
    """Plan the pictures of combinations, each field in one scale over all of a group, or over all that are in none."""
    combinations = results.model.effective_combinations
    groups = {one.name: one.group for one in combinations} if combinations.groups else {}
    grouped = dict[str, list[tuple[Result, str]]]()
    for result, slug in named:
        grouped.setdefault(groups.get(result.name, ""), []).append((result, slug))
    return [
        Sheet(fields, tuple((f"{slug}{ending}.png", result, caption(result, ending)) for result, slug in those))
        for ending, fields in PICTURES.items()
        if ending != PRESSURE or has_areas(results)
        for those in grouped.values()
    ]


def drawn(sheets: Sequence[Sheet | EnvelopeSheet]) -> Iterator[tuple[str, bytes]]:
    """Draw pictures of one plate, one after another: name and content of a file."""
    if sheets:
        # Only this function needs matplotlib.
        from signorini.plot import Plan

        nodes = sheets[0].nodes
        plan = Plan.of(nodes.points, nodes.elements)
        for sheet in sheets:
            yield from sheet.drawn(plan)


class Drawing:
    """Pictures of results, drawn by other processes, if there are any, while this one goes on."""

    def __init__(self, sheets: Sequence[Sheet | EnvelopeSheet], artists: Sequence[Forked] = ()) -> None:
        """Hand out the work."""
        if sheets and len(sheets[0].nodes.elements) > _MOST_ELEMENTS:
            artists = ()
        self._shares: list[list[Sheet | EnvelopeSheet]] = [[] for _ in artists]
        self._artists, self._own = artists, [] if artists else list(sheets)
        if artists:
            load = [0] * len(artists)
            # The largest first, each to whom has least to do.
            for sheet in sorted(sheets, key=lambda sheet: -sheet.panels):
                idle = load.index(min(load))
                load[idle] += sheet.panels
                self._shares[idle].append(sheet)
        for artist, share in zip(artists, self._shares, strict=True):
            artist.begin(share)

    def pictures(self) -> Iterator[tuple[str, bytes]]:
        """Give every picture, name and content of a file; what the others have not drawn is drawn here."""
        left = self._own
        for artist, share in zip(self._artists, self._shares, strict=True):
            there = set()
            for name, content in artist.results():
                there.add(name)
                yield name, content
            left += [sheet for sheet in share if not sheet.files <= there]
        yield from drawn(left)


@contextmanager
def artists() -> Iterator[list[Forked]]:
    """Give processes that read matplotlib while this one solves, and then draw for it; none where there is one core."""
    with forked(_ARTISTS if _cores() > 1 else 0, _ready, drawn) as found:
        yield found


def _ready() -> None:
    import signorini.plot  # noqa: F401


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
