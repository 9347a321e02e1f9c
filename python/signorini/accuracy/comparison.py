"""Comparison of results on several meshes: half-widths of numbers and of positions."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import numpy as np

from signorini.accuracy.half_width import (
    ROUNDING,
    beside,
    half_widths,
    may_grow,
    rounded,
    side,
    sizes_of,
    unsettled,
    within_an_element,
)
from signorini.accuracy.half_width import named as named_numbers
from signorini.accuracy.layers import KINDS as TOUCHED
from signorini.accuracy.layers import unseen_at_edges, unseen_layer
from signorini.base import numbers as words
from signorini.base.remade import Brief
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.model import Model
from signorini.results.checks import widened
from signorini.results.figures import figures, with_widths
from signorini.results.load_path import LoadPath
from signorini.results.notebook import in_notebook
from signorini.results.of_plates import said_of
from signorini.results.quantities import DESIGN_MOMENTS, REINFORCEMENT, Number, Path, place_of
from signorini.results.result import Result
from signorini.shapes.distances import Targets
from signorini.singularities.singularity import Singularity


@dataclass(frozen=True, eq=False, repr=False)
class Estimate(Brief):
    """Half-widths (±): the expected changes of a result's numbers as the mesh is refined.

    Half-widths estimate the mesh error; the error of the solver is in the certificate.

    Parameters
    ----------
    result : Result
    widths : (n,) array
        Half-widths of the numbers of ``result.catalogue``; NaN where unknown.
    plus_minus : mapping or None
        Half-widths in the form of results.json, with its keys deflection, fields, supports, probes, sections and
        strips; None where a half-width is unknown. If no other mesh was solved, None in place of the mapping.
    elements : tuple of int
        Element counts of the compared meshes, finest first, including the mesh of ``result``.
    warnings : tuple of str
        Sentences that say why half-widths are missing or wide.
    plates : mapping of Estimate
        Estimate of each of several plates, by name.
    """

    result: Result
    widths: Floats
    plus_minus: Mapping[str, Any] | None
    elements: tuple[int, ...]
    warnings: tuple[str, ...]
    plates: Mapping[str, Estimate] = field(default_factory=dict)

    def of(self, result: Result) -> Estimate:
        """Return the estimate in ``plates`` of a single plate's result; for every other ``result`` this estimate."""
        return next((one for one in self.plates.values() if one.result is result), self)

    def to_dataframe(self) -> Any:
        """Return the table of `Result.to_dataframe` with the half-widths as column ``plus_minus``."""
        return self.result.to_dataframe().assign(plus_minus=self.widths)

    def _repr_html_(self) -> str:
        """Show the result with half-widths in a notebook."""
        return in_notebook(self.result, self.plus_minus, words.compared(self.elements, True))


@dataclass(frozen=True)
class PathEstimate:
    """Half-widths of the load factor t at events, thresholds and the end of a load path, from other meshes.

    Parameters
    ----------
    end : float or None
        Half-width of the t at which the path ends; None if unknown.
    events : tuple of float or None
        Half-width of the t of each named event; None where unknown.
    thresholds : tuple of float or None
        Half-width of the t of each threshold; None where unknown.
    elements, warnings
        As in `Estimate`.
    """

    end: float | None
    events: tuple[float | None, ...]
    thresholds: tuple[float | None, ...]
    elements: tuple[int, ...]
    warnings: tuple[str, ...]

    @classmethod
    def nothing(cls, events: int, thresholds: int, warnings: tuple[str, ...] = ()) -> PathEstimate:
        """Estimate without half-widths, for the given numbers of events and thresholds."""
        return cls(None, (None,) * events, (None,) * thresholds, (), warnings)

    def half_width(self, path: LoadPath, index: int) -> float | None:
        """Largest half-width of t over the events and thresholds at a stop, or half-width of the path's end.

        None if a half-width is unknown.
        """
        ends = {len(path.stops) - 1: self.end, 0: 0.0}
        widths = [self.events[number] for number in path.events_at.get(index, ())]
        widths += [self.thresholds[number] for number in path.reached_at.get(index, ())]
        widths = widths or [ends.get(index)]
        known = [width for width in widths if width is not None]
        return max(known) if known and len(known) == len(widths) else None

    def words(self, path: LoadPath, index: int) -> str:
        """Load factor t of a stop as text; ± its half-width, or ± ? if unknown, if meshes were compared."""
        t = f"{path.stops[index].t:.6g}"
        if not self.elements:
            return t
        width = 0.0 if path.words(index) == "end" and path.ending == "no_more_events" else self.half_width(path, index)
        return f"{t} ± {'?' if width is None else f'{width:.2g}'}" if width != 0 else t


def t_in_words(path: LoadPath, index: int, estimate: PathEstimate | None) -> str:
    """Load factor t of a stop as text, by `PathEstimate.words`; without half-width if ``estimate`` is None."""
    return f"{path.stops[index].t:.6g}" if estimate is None else estimate.words(path, index)


def boundary_widths(result: Result, other: Result) -> dict[Path, float | None]:
    """Half-widths of vertices of the contact boundary: distances along x and y to the boundary on another mesh."""
    values: dict[Path, float | None] = {}
    for index, (mine, others) in enumerate(zip(result.supports, other.supports, strict=True)):
        edges = Targets.of(
            sides=[side for line in others.contact_boundary for side in pairwise(line.tolist()) if side[0] != side[1]]
        )
        for number, line in enumerate(mine.contact_boundary if len(edges.sides) else ()):
            ways = np.concatenate([edges.nearest(vertex[None])[0] - vertex for vertex in line])
            for vertex, way in enumerate(rounded(np.abs(ways)).tolist()):
                for axis in (0, 1):
                    values[(*place_of(result.model, index), "contact_boundary", number, vertex, axis)] = way[axis]
    return values


def places_of_extremes(result: Result, numbers: Mapping[Path, float | None]) -> dict[Path, float | None]:
    """Half-widths of the positions of extremes: largest distances along x and y to nodes that may be the extreme."""
    values: dict[Path, float | None] = {}
    spacing, points = 0.5 * side(result.mesh), result.stress_nodes.points
    for name_of_field, ends in result.extremes.items():
        path: Path = (name_of_field,) if name_of_field == "deflection" else ("fields", name_of_field)
        for name, value, at in (("max", ends.max, ends.max_at), ("min", ends.min, ends.min_at)):
            width = numbers[(*path, name)]
            away = np.abs(np.nan_to_num(result.fields[name_of_field]) - np.nan_to_num(value))
            near = points[np.flatnonzero(away <= 2.0 * (width or 0.0))]
            far = rounded(np.abs(near - at).max(axis=0, initial=0.0) + spacing).tolist()
            for axis in (0, 1):
                values[(*path, f"{name}_at", axis)] = None if width is None else far[axis]
    return values


_MOVED = 1e-8
"""Smallest change of a number from mesh to mesh, relative to the largest number of its kind, that is not rounding.
Only the half-widths of numbers that change by more include the error of the unresolved boundary layer.
"""


@dataclass(frozen=True)
class Meshes:
    """Meshes of one plate, finest first; ``own`` is the index of the mesh whose results get half-widths."""

    every: tuple[Mesh, ...]
    own: int

    @classmethod
    def of(cls, own: Mesh, others: Sequence[Mesh]) -> Meshes:
        """Sort the own mesh and the other meshes by their numbers of elements, the largest number first."""
        every = sorted([own, *others], key=lambda mesh: -len(mesh.elements))
        return cls(tuple(every), every.index(own))

    def of_plate(self, plate: int) -> Meshes:
        """Return the meshes of one plate, by its index; for a single plate this object."""
        if not self.every[0].layers:
            return self
        return Meshes(tuple(mesh.layers[plate] for mesh in self.every), self.own)

    @property
    def sizes(self) -> list[float]:
        """Mean element size of each mesh."""
        return [side(mesh) for mesh in self.every]

    @property
    def elements(self) -> tuple[int, ...]:
        """Number of elements of each mesh."""
        return tuple(len(mesh.elements) for mesh in self.every)

    @property
    def reach(self) -> float:
        """Distance from a singularity up to which numbers may grow without limit: two elements of the coarsest mesh."""
        return 2.0 * self.sizes[-1]


def compared(
    values: Floats,
    numbers: Sequence[Number],
    meshes: Meshes,
    model: Model,
    probes: Floats,
    named: Sequence[tuple[Sequence[Singularity], Bools]],
) -> tuple[Floats, Bools]:
    """Return half-widths (n, k) of n numbers of k results, and a mask (n, k) of numbers without limit.

    A half-width is NaN where it is unknown. It does not depend on the other results, so that results, rows of tables
    and envelopes have the same half-widths. ``values`` (m, n, k) are in the order of the meshes, NaN where missing;
    ``probes`` (q, 2) are positions. ``named`` are the singularities of the supports and of each load case, with masks
    (k,) of the results in which they act. Only numbers near a singularity in ``named`` can be without limit.
    """
    values = np.where(np.isinf(values), np.nan, values)
    count, mesh = values.shape[2], meshes.every[meshes.own]
    sizes = sizes_of(values[meshes.own], numbers, model, mesh)
    values = _below_zero(values, numbers)
    own = values[meshes.own]
    largest = np.array([sizes[one.quantity.kind] for one in numbers]).reshape(-1, count)
    limited, unresolved = np.ones((len(numbers), count), np.bool_), np.zeros((len(numbers), count), np.bool_)
    for singular, where in named:
        unresolved |= within_an_element(numbers, singular, meshes.every[0])[:, None] & where
        limited &= ~(may_grow(numbers, model, probes, singular, meshes.reach)[:, None] & where)
    # A design moment that is zero does not grow without limit.
    signs = _signs(numbers)
    limited |= signs * own < 0.0
    changes = beside(numbers, np.abs(values[0] - values[1]))
    layer = unseen_layer(model, mesh, meshes.sizes)
    touched = np.array([one.quantity.kind in TOUCHED for one in numbers], np.bool_)[:, None]
    touched = touched & (changes > _MOVED * largest)
    widths, growing = half_widths(values, meshes.sizes, meshes.own, changes, largest, limited)
    # Peak pressures at the outline of a rigid area have no limit, but need not grow steadily on coarse meshes.
    rigid = {one.source for singular, _ in named for one in singular if one.line and "pressure" in one.numbers}
    peaks = [
        one.home == "support" and one.quantity.kind == "pressure" and model.support[one.owner].name in rigid
        for one in numbers
    ]
    growing |= np.array(peaks, np.bool_)[:, None] & unsettled(values, largest)
    widths = np.where(touched, np.maximum(widths, layer * largest), widths)
    places = {one.key: row for row, one in enumerate(numbers)}
    on_finest = {key: values[0, row] for key, row in places.items()}
    finer = meshes.sizes[0] / meshes.sizes[meshes.own]
    for key, width in unseen_at_edges(on_finest, sizes["moment"], probes, model, mesh, finer).items():
        if (row := places.get(key)) is not None:
            widths[row] = np.maximum(widths[row], np.abs(own[row] - values[0, row]) + width)
    _widen_absent(widths, numbers, own)
    # Where a design moment max(0, g) is zero, its half-width is only the part of g ± width above zero.
    widths = np.where(signs * own < 0.0, np.maximum(widths + signs * own, ROUNDING * largest), widths)
    return rounded(np.where(growing | unresolved, np.nan, widths)), growing


def compare(result: Result, others: Sequence[Result], warning: str = "") -> Estimate:
    """Compare a result with results on one or two other meshes; ``warning`` says why other meshes are missing."""
    if result.plates:
        return _compare_plates(result, others, warning)
    meshes = Meshes.of(result.mesh, [one.mesh for one in others])
    every = [next(one for one in (result, *others) if one.mesh is mesh) for mesh in meshes.every]
    catalogue, model = result.catalogue, result.model
    told = [place for place, one in enumerate(catalogue) if one.estimated]
    numbers = [catalogue.numbers[place] for place in told]
    values = np.array([[*one.numbers[told]] for one in every])[:, :, None]
    probes = np.array([probe.at for probe in result.probes]).reshape(-1, 2)
    output, grow = compared(values, numbers, meshes, model, probes, [(result.singular, np.ones(1, np.bool_))])
    widths = np.full(len(catalogue), np.nan)
    widths[told] = output[:, 0]
    widths = _with_checks(result, widths)
    by_path = {one.path: known(width) for one, width in zip(catalogue, widths.tolist(), strict=True)}
    by_path |= boundary_widths(result, every[1] if meshes.own == 0 else every[0])
    by_path |= places_of_extremes(result, by_path)
    warnings = [warning] if warning else []
    # A growing extreme of a field has no warning here, since the table of extremes names its singularity.
    growing = [one for one, grows in zip(numbers, grow[:, 0].tolist(), strict=True) if grows and one.home != "field"]
    # A contact between two plates is named in the warning of the upper plate only.
    upon = {index for index, support in enumerate(result.supports) if support.upon}
    growing = [one for one in growing if not (one.path[0] == "supports" and one.owner in upon)]
    if growing:
        warnings.append(
            f"As the mesh is refined these numbers grow and show no limit: {named_numbers(growing, model, probes)}. "
            "The named singularities give the reason and the remedy."
        )
    return Estimate(result, widths, with_widths(figures(result), by_path), meshes.elements, tuple(warnings))


def _compare_plates(result: Result, others: Sequence[Result], warning: str) -> Estimate:
    """Compare the result of each plate with those on other meshes, and combine the estimates of all plates."""
    each = {
        name: compare(own, [other.plates[name] for other in others], warning) for name, own in result.plates.items()
    }
    ends, names = list(each.values()), list(each)
    widths, plates = np.empty(len(result.catalogue)), dict[Path, str]()
    widths[:] = np.nan
    for row, (number, of) in enumerate(zip(result.catalogue, result.catalogue.in_plates, strict=True)):
        if not of:
            continue
        values = np.array([[ends[plate].result.numbers[place]] for plate, place in of])
        own = np.array([[ends[plate].widths[place]] for plate, place in of])
        (which,) = plates_of_extremes(result.numbers[row : row + 1], values, own).tolist()
        widths[row], plates[number.path] = own[which, 0], names[of[which][0]]
    widths = _with_checks(result, widths)
    by_path = {one.path: known(width) for one, width in zip(result.catalogue, widths.tolist(), strict=True)}
    by_path |= boundary_widths(result, others[0])
    for name, one in result.plates.items():
        of_plate = {path[2:]: width for path, width in by_path.items() if path[:2] == ("plates", name)}
        by_path |= {("plates", name, *path): width for path, width in places_of_extremes(one, of_plate).items()}
    for path in (one.path for one in result.catalogue if one.over_plates and one.home == "field"):
        at = [(*path[:-1], f"{path[-1]}_at", axis) for axis in (0, 1)]
        by_path |= {place: by_path["plates", plates[path], *place] for place in at}
    warnings = said_of({name: one.warnings for name, one in each.items()})
    elements = tuple(sum(counts) for counts in zip(*(one.elements for one in each.values()), strict=True))
    return Estimate(result, widths, with_widths(figures(result), by_path), elements, warnings, each)


def _with_checks(result: Result, widths: Floats) -> Floats:
    """Half-widths (n,) of a result's numbers; those of its checks are computed from the other half-widths."""
    return np.ravel(widened(result.catalogue, result.numbers[None], widths[None], result.model.has_limits))


def plates_of_extremes(values: Floats, own: Floats, widths: Floats) -> Ints:
    """Index (k,) of the plate at which each of k extremes ``values`` over all plates occurs.

    ``own`` and ``widths`` (p, k) are the extremes of each of p plates and their half-widths. If several plates have the
    same extreme, the plate with the largest half-width is returned.
    """
    away = np.nan_to_num(np.abs(own - values), nan=np.inf)
    ordered = np.where(away == away.min(axis=0), np.nan_to_num(widths, nan=np.inf), -1.0)
    return np.asarray(ordered.argmax(axis=0))


_AT_STATIONS: Mapping[str, float] = MappingProxyType({"moment_bottom": 1.0, "moment_top": -1.0})
"""Sign of each design moment at a station of a strip: at the bottom it is ≥ 0, at the top ≤ 0."""
_SIGNS = {"probe": DESIGN_MOMENTS, "station": _AT_STATIONS}
_AREAS = {"probe": REINFORCEMENT, "station": {name.replace("moment", "as"): name for name in _AT_STATIONS}}
"""`_SIGNS`: sign of each design moment at probes and stations. `_AREAS`: design moment of each bar area."""
_Place = tuple[str, int, int, str]


def _signs(numbers: Sequence[Number]) -> Floats:
    """Signs (n, 1) of design moments at probes and stations; 0 for other numbers."""
    return np.array([_SIGNS.get(one.home, {}).get(one.quantity.name, 0.0) for one in numbers]).reshape(-1, 1)


def _places(numbers: Sequence[Number]) -> dict[_Place, int]:
    """Indices of numbers at probes and at stations of strips, by ("probe" or "station", owner, station, quantity)."""
    local = ((row, one) for row, one in enumerate(numbers) if one.home in _SIGNS)
    return {(one.home, one.owner, one.part, one.quantity.name): row for row, one in local}


def _below_zero(values: Floats, numbers: Sequence[Number]) -> Floats:
    """Values (m, n, k) with g or −g, g ≤ 0, in place of each design moment that is zero at a probe or station.

    A design moment is max(0, g) at the bottom, with a continuous function g of the moments, or −max(0, g) at the top.
    With g, meshes on which the design moment is zero still show by how much it changes from mesh to mesh.
    """
    result, rows = values.copy(), _places(numbers)
    for (home, owner, part, name), row in rows.items():
        if (sign := _SIGNS[home].get(name)) is None:
            continue
        own, twisting = ("moment", "twist") if home == "station" else (name[:2], "mxy")
        along, across, twist = (
            rows.get((home, owner, part, of)) for of in (own, {"mx": "my", "my": "mx"}.get(own, own), twisting)
        )
        if along is None or across is None or twist is None:
            continue
        g = sign * values[:, along] + (size := np.abs(values[:, twist]))
        if across != along:  # Wood's rule if no bars across are needed: g = m + mxy² / |m across|
            other = np.abs(values[:, across])
            with np.errstate(divide="ignore", invalid="ignore"):
                alone = sign * values[:, along] + size**2 / other
            g = np.where(sign * values[:, across] + size < 0.0, alone, g)
        result[:, row] = np.where(values[:, row] == 0.0, sign * g, values[:, row])
    return result


def _widen_absent(widths: Floats, numbers: Sequence[Number], values: Floats) -> None:
    """Set the half-width of a bar area of zero to NaN if its design moment plus half-width exceeds zero.

    On a finer mesh at least the minimum reinforcement may be needed; its area is not estimated.
    """
    rows = _places(numbers)
    for (home, owner, part, name), row in rows.items():
        moment = rows.get((home, owner, part, _AREAS[home].get(name, "")))
        if moment is not None:
            sign = _SIGNS[home][numbers[moment].quantity.name]
            exceeds = widths[moment] + sign * values[moment] > 0.0
            widths[row] = np.where((values[row] == 0.0) & exceeds, np.nan, widths[row])


def known(width: float) -> float | None:
    """Return a half-width as a number; None if it is NaN."""
    return None if math.isnan(width) else float(width)
