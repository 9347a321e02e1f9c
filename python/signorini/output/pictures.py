"""Pictures of combinations: deflection, contact pressure, moments and shears."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from signorini.accuracy.refinement import ORDER
from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.base.forked import Forked, forked
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
from signorini.results.envelope import Ends, Envelope
from signorini.results.marks import support_marks as support_marks_of
from signorini.results.panels import colours, extreme, field_range, panel, quantity, support_marks
from signorini.results.result import Result

if TYPE_CHECKING:
    from signorini.plot import Panel, Plan

_ARTISTS = 2
"""Processes that draw: moments take as long as all else."""
_LONGEST = 44
"""Letters of a combination's name that have room above a panel."""
_MOST_ELEMENTS = 100_000
"""Elements beyond which memory is not for several processes that draw them at once."""


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
    named : tuple of (str, Result, mapping or None)
        The picture's file, what it shows, and half-widths, where they are asked for.
    """

    fields: tuple[str, ...]
    named: tuple[tuple[str, Result, Mapping[str, Any] | None], ...]

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
            ranges = [field_range(field, result) for _, result, _ in self.named]
            limits[field] = min(low for low, _ in ranges), max(high for _, high in ranges)

        def panels(result: Result, widths: Mapping[str, Any] | None) -> list[Panel]:
            return [panel(field, result, widths, limit) for field, limit in limits.items()]

        model = self.named[0][1].model
        pictures = [
            Picture(partial(panels, one, widths), support_marks(one.mesh, model.support, one.supports), one.heading)
            for _, one, widths in self.named
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
    ends : tuple of ((str, str), (str, str))
        Of each field the combinations with the largest and the smallest value, and these in words.
    envelope : Envelope
    discretisation : Discretisation
    """

    fields: tuple[str, ...]
    file: str
    title: str
    ends: tuple[tuple[tuple[str, str], tuple[str, str]], ...]
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

        units, panels = self.discretisation.model.units, list[Panel]()
        for end, side in enumerate(("largest", "smallest")):
            for field, ends in zip(self.fields, self.ends, strict=True):
                extremes, of_all = self.envelope.fields[field], self.envelope.field(field)
                limits = of_all.min, of_all.max
                at = self.envelope.places[self.envelope.layout.fields.index(field), end].tolist()
                shown = self.nodes.spread(getattr(extremes, side))
                label, (name, words) = f"{side} {quantity(field, units)}", ends[end]
                panels.append(Panel(shown, label, colours(field), limits, [(words, at)], name))
        picture = Picture(lambda: panels, support_marks_of(self.discretisation), self.title)
        for content in drawn_as_png(plan, [picture], units.length, rows=2):
            yield self.file, content


def envelope_sheets(results: Results, estimates: Estimates | None) -> list[EnvelopeSheet]:
    """Plan the pictures of envelopes: of all combinations, and of each group."""
    sheets, title = list[EnvelopeSheet](), results.model.title
    for group, file in envelope_files(results).items():
        what = f"envelope of {group}" if group else f"envelope of {results.combined.solved} combinations"
        words = ", ".join(part for part in (title, what) if part)
        for ending, name in envelope_pictures(results, file).items():
            fields, envelope = enveloped(results, ending), results.combined.over(group)
            ends = tuple(_ends(results, estimates, field, envelope.field(field)) for field in fields)
            sheets.append(EnvelopeSheet(fields, name, words, ends, envelope, results.discretisation))
    return sheets


def _ends(
    results: Results, estimates: Estimates | None, field: str, ends: Ends
) -> tuple[tuple[str, str], tuple[str, str]]:
    """Of a field's largest and smallest value the combination, and the value in words."""
    told = estimates is not None and estimates.of_table is not None and bool(estimates.of_table.others)
    found = list[tuple[str, str]]()
    for end, value, by in (("max", ends.max, ends.max_by), ("min", ends.min, ends.min_by)):
        width = estimates.half_width(f"{end}:{field}", by) if told and estimates is not None else None
        name = results.key(by)
        cut = name if len(name) <= _LONGEST else f"{name[: _LONGEST - 1]}…"
        found.append((f"{end}: {cut}", extreme(end, value, told, width)))
    return found[0], found[1]


def sheets_of(results: Results, named: Sequence[tuple[Result, str]], estimates: Estimates | None) -> list[Sheet]:
    """Plan the pictures of combinations, each field in one scale over all of a group, or over all that are in none."""
    combinations = results.model.effective_combinations
    widths = {result.name: None if estimates is None else estimates[result.name].plus_minus for result, _ in named}
    groups = {one.name: one.group for one in combinations} if combinations.groups else {}
    grouped = dict[str, list[tuple[Result, str]]]()
    for result, slug in named:
        grouped.setdefault(groups.get(result.name, ""), []).append((result, slug))
    return [
        Sheet(fields, tuple((f"{slug}{ending}.png", result, widths[result.name]) for result, slug in those))
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
