"""What other meshes say of a result: half-widths of its numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from signorini.base.brief import Brief
from signorini.base.numbers import compared
from signorini.discretise.rows import Floats
from signorini.results.load_path import LoadPath
from signorini.results.result import Result, in_notebook


@dataclass(frozen=True, eq=False, repr=False)
class Estimate(Brief):
    """Half-widths within which refining the mesh is expected to move the numbers of a result.

    They are of the mesh, not of the equations.

    Parameters
    ----------
    result : Result
    widths : (n,) array
        Of the numbers of ``result.catalogue``; NaN where there is none.
    plus_minus : mapping or None
        The same by the keys deflection, fields, supports, probes, sections and strips of results.json, None in place
        of a number that has none; None where no other mesh was solved.
    elements : tuple of int
        Sizes of the meshes that were compared, the finest first, its own among them.
    warnings : tuple of str
        Why half-widths are missing or wide, in sentences.
    """

    result: Result
    widths: Floats
    plus_minus: Mapping[str, Any] | None
    elements: tuple[int, ...]
    warnings: tuple[str, ...]

    def _repr_html_(self) -> str:
        """Show the supports with half-widths in a notebook."""
        return in_notebook(self.result, self.plus_minus, compared(self.elements, True))


@dataclass(frozen=True)
class PathEstimate:
    """What coarser meshes say of a load path.

    Parameters
    ----------
    end : float or None
        Half-width of the t at which it ends.
    events : tuple of float or None
        Half-widths of the t of every named event.
    thresholds : tuple of float or None
        Those of the t of every threshold.
    elements, warnings
        As those of an `Estimate`.
    """

    end: float | None
    events: tuple[float | None, ...]
    thresholds: tuple[float | None, ...]
    elements: tuple[int, ...]
    warnings: tuple[str, ...]

    @classmethod
    def nothing(cls, events: int, thresholds: int, warnings: tuple[str, ...] = ()) -> PathEstimate:
        """No half-widths of so many events and thresholds."""
        return cls(None, (None,) * events, (None,) * thresholds, (), warnings)

    def half_width(self, path: LoadPath, index: int) -> float | None:
        """The widest half-width of the t of a stop that its events show, or of the end; None where one has none."""
        ends = {len(path.stops) - 1: self.end, 0: 0.0}
        widths = [self.events[number] for number in path.events_at.get(index, ())]
        widths += [self.thresholds[number] for number in path.reached_at.get(index, ())]
        widths = widths or [ends.get(index)]
        known = [width for width in widths if width is not None]
        return max(known) if known and len(known) == len(widths) else None

    def words(self, path: LoadPath, index: int) -> str:
        """Write the t of a stop, to digits that keep the order, with its half-width."""
        t = f"{path.stops[index].t:.6g}"
        if not self.elements:
            return t
        width = 0.0 if path.words(index) == "end" and path.ending == "no_more_events" else self.half_width(path, index)
        return f"{t} ± {'?' if width is None else f'{width:.2g}'}" if width != 0 else t
