"""Largest and smallest values of fields over the nodes, without nodes at singular places."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from signorini.design.en1992_bending import Bars
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.stressnodes import StressNodes
from signorini.results.quantities import FIELDS, LINEAR, MEAN_SIDES, OF_BARS, PEAKING, RESULTANTS, derived
from signorini.singularities.beside import PEAKS, Beside, Face, at_faces, beside_of, faces_of, means_of
from signorini.singularities.named import singularities
from signorini.singularities.singularity import Singularity, away_from

_ALIKE = 1e-9
"""Tolerance for equal numbers, relative to a field's size, and for equal coordinates, relative to the extent of the
positions.
"""


def peak(values: Floats, places: Floats) -> int:
    """Index of the largest of values (n,); if several are equal to rounding, that with the least x, then the least y.

    ``places`` (n, 2) are the positions of the values. Values of minus infinity do not count.

    Examples
    --------
    >>> peak(np.array([1.0, 3.0 - 1e-12, 3.0]), np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 1.0]]))
    1
    """
    size = float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
    near = np.flatnonzero(values >= values.max() - _ALIKE * size)
    if len(near) == 1:
        return int(near[0])
    alike = places[near] - places[near].min(axis=0)
    x, y = np.round(alike / (_ALIKE * max(float(alike.max()), 1e-300))).T
    return int(near[np.lexsort((y, x))[0]])


@dataclass(frozen=True)
class FieldExtremes:
    """Extremes of a field over the nodes, with positions; ties have the position with the least x, then the least y."""

    max: float
    max_at: tuple[float, float]
    # text for the singularity near which a larger value is excluded; empty if no larger value is excluded
    max_beside: str
    min: float
    min_at: tuple[float, float]
    min_beside: str
    # largest and smallest mean at singular points of this field, with position and width; NaN without singular points
    max_mean: float = math.nan
    max_mean_at: tuple[float, float] = (math.nan, math.nan)
    max_mean_width: float = math.nan
    min_mean: float = math.nan
    min_mean_at: tuple[float, float] = (math.nan, math.nan)
    min_mean_width: float = math.nan

    @classmethod
    def of(
        cls, values: Floats, nodes: StressNodes, away: Bools, singular: Sequence[Singularity] = (), number: str = ""
    ) -> FieldExtremes:
        """Find a field's extremes at the nodes ``away`` (n,) from singularities of ``number``, such as "moment"."""
        places, counting = nodes.points[: len(values)], nodes.counting(len(values)) & ~np.isnan(values)
        if not counting.any():
            nowhere = (math.nan, (math.nan, math.nan), "")
            return cls(*nowhere, *nowhere)
        away = away[nodes.nodes[: len(values)]] & counting
        away = away if away.any() else counting
        ends: list[tuple[float, tuple[float, float], str]] = []
        for signed in (values, -values):
            own, highest = np.where(away, signed, -np.inf), int(np.where(counting, signed, -np.inf).argmax())
            x, y = places[peak(own, places)].tolist()
            beside = "" if away[highest] else _nearest(places[highest], singular, number)
            ends.append((float(values[own.argmax()]), (x, y), beside))
        return cls(*ends[0], *ends[1])


def least_at(name: str, area: float, at: Sequence[float], bars: Bars, nodes: StressNodes, thickness: Floats) -> bool:
    """Whether the required area ``area`` of bars at a node's position ``at`` is the minimum reinforcement there."""
    apart = np.hypot(*(nodes.points - np.asarray(at)).T)
    return bool(bars.are_least(name, area, thickness[apart <= apart.min()]).any())


def of_plates(each: Sequence[Mapping[str, FieldExtremes]]) -> dict[str, FieldExtremes]:
    """Combine the extremes of each field of several plates into extremes over all of them."""
    result = {}
    for name in each[0]:
        most, least = (
            max((of[name] for of in each), key=lambda one: one.max),
            min((of[name] for of in each), key=lambda one: one.min),
        )
        result[name] = replace(most, min=least.min, min_at=least.min_at, min_beside=least.min_beside)
        for side, sign in (("max_mean", 1.0), ("min_mean", -1.0)):
            of = max((one[name] for one in each), key=lambda one: np.nan_to_num(sign * getattr(one, side), nan=-np.inf))
            result[name] = replace(result[name], **{key: getattr(of, key) for key in _keys(side)})
    return result


def _keys(side: str) -> tuple[str, str, str]:
    return side, f"{side}_at", f"{side}_width"


_LINES = {"mx": [0], "sx": [0], "my": [1], "sy": [1], "qx": [0, 1], "txz": [0, 1], "qy": [2, 3], "tyz": [2, 3]}
_LINES |= {"as_x": [0], "as_y": [1]}
"""For each field, the indices of the lines of `Beside` along which its means at singular points are taken.

Keys are names of fields without "_top" or "_bottom". All other fields of moments have means along lines 0 and 1.
"""


def mean_ends(name: str, means: Floats, beside: Beside, acting: Bools, bars: Bars | None) -> tuple[Floats, Ints]:
    """Return a field's largest and smallest mean (..., 2) at singular points, and the indices (..., 2) of these points.

    ``means`` (..., k, 10) are as in `means_of`; ``acting`` (..., k) is the mask of the points that are singular under
    the load. Derived fields are computed from the means, with `Model.bars`. Without a singular point the values are NaN
    and the indices 0.
    """
    peaks, lines = PEAKS.index(FIELDS[name].singular), _LINES.get(name.rsplit("_", 1)[0], [0, 1])
    moment, shear = means[..., :6].reshape(*means.shape[:-1], 2, 3), means[..., 6:, None]
    if peaks:
        shear = np.repeat(shear[..., lines, :], 2, axis=-1)
        moment, thickness = np.zeros((*shear.shape[:-1], 3)), beside.thickness[:, 2:][:, lines]
    else:
        moment = moment[..., lines, :]
        shear, thickness = np.zeros((*moment.shape[:-1], 2)), beside.thickness[:, lines]
    if name in LINEAR:
        values = np.concatenate([moment, shear], axis=-1)[..., RESULTANTS.index(name)]
    else:
        values = derived([name], moment, shear, thickness, bars)[..., 0]
    values = np.where((acting & beside.numbers[:, peaks])[..., None], values, np.nan).reshape(*means.shape[:-2], -1)
    if not len(beside):
        return np.full((*values.shape[:-1], 2), np.nan), np.zeros((*values.shape[:-1], 2), np.int64)
    signed = np.stack([values, -values], axis=-2)
    most = np.fmax.reduce(signed, axis=-1)
    size = np.fmax.reduce(np.where(np.isinf(signed), 0.0, np.abs(signed)), axis=-1)
    near = signed >= (most - _ALIKE * size)[..., None]
    return most * [1.0, -1.0], near.argmax(axis=-1) // len(lines)


def extremes(
    names: Sequence[str],
    fields: Mapping[str, Floats],
    nodes: StressNodes,
    singular: Sequence[Singularity],
    means: Means | None,
) -> dict[str, FieldExtremes]:
    """Find the extremes of the deflection, and of fields ``names`` of moments and shears outside singular places.

    ``means`` are the means at singular points, whose extremes are added.
    """
    numbers = {name: FIELDS[name].singular if name in PEAKING else "" for name in names}
    away = {number: away_from(nodes.mesh, singular, number) for number in dict.fromkeys(numbers.values())}
    result = {
        name: FieldExtremes.of(fields[name], nodes, away[number], singular, number) for name, number in numbers.items()
    }
    mean = {name: means.ends(name) for name in result if name in PEAKING} if means else {}
    return {name: replace(one, **mean.get(name, {})) for name, one in result.items()}


def extremes_under(
    discretisation: Discretisation, cases: Collection[str], values: Floats, names: Sequence[str]
) -> dict[str, FieldExtremes]:
    """Find the extremes of fields ``names`` of one plate under load cases, from its linear fields (s, 8)."""
    moment, shear, bars = values[:, 3:6], values[:, 6:], discretisation.model.bars
    fields, means = dict(zip(LINEAR, values.T, strict=True)), Means.of(discretisation, moment, shear, cases)
    of_bars = at_faces(means.faces, moment, moment, discretisation.stress_nodes.points)
    for name in (name for name in names if name not in LINEAR):
        own = of_bars if name in OF_BARS else moment
        fields[name] = derived([name], own, shear, discretisation.node_thickness, bars)[:, 0]
    singular = singularities(discretisation, cases)
    return extremes(names, fields, discretisation.stress_nodes, singular, means)


@dataclass(frozen=True, eq=False)
class Means:
    """Means (k, 10) of moments and shears of one result at the k singular points of `Beside`.

    ``acting`` (k,) is the mask of the points that are singular under the load. ``faces`` are the columns whose bars are
    designed for moments at the column's face.
    """

    beside: Beside
    values: Floats
    acting: Bools
    bars: Bars | None
    faces: tuple[Face, ...]

    @classmethod
    def of(cls, discretisation: Discretisation, moment: Floats, shear: Floats, cases: Collection[str]) -> Means:
        """Compute the means of one plate from moments (s, 3) and shears (s, 2) at the stress nodes."""
        beside, model = beside_of(discretisation), discretisation.model
        faces = faces_of(discretisation) if model.at_faces else ()
        return cls(beside, means_of(discretisation, moment, shear), beside.under(cases), model.bars, faces)

    def ends(self, name: str) -> dict[str, Any]:
        """Extremes of a field's means with positions and widths, as arguments of `FieldExtremes`."""
        result = dict[str, Any]()
        values, places = mean_ends(name, self.values, self.beside, self.acting, self.bars)
        for side, value, place in zip(MEAN_SIDES, values.tolist(), places.tolist(), strict=True):
            if not math.isnan(value):
                at = tuple(self.beside.places[place].tolist())
                told = value, at, 2.0 * float(self.beside.within[place])
                result |= dict(zip(_keys(side), told, strict=True))
        return result

    @cached_property
    def by_place(self) -> Mapping[tuple[float, float], dict[str, float]]:
        """Means of moments and shears by position of the singular point; of two lines, the mean of larger magnitude."""
        result: dict[tuple[float, float], dict[str, float]] = {}
        for (x, y), within, mean in zip(self.beside.places.tolist(), self.beside.within, self.values, strict=True):
            pairs = {"mx": mean[:1], "my": mean[4:5], "mxy": mean[[2, 5]], "qx": mean[6:8], "qy": mean[8:]}
            told = {name: of[~np.isnan(of)] for name, of in pairs.items()}
            larger = {name: float(of[np.abs(of).argmax()]) if len(of) else math.nan for name, of in told.items()}
            result[x, y] = {"width": 2.0 * float(within), **larger}
        return result


def _nearest(at: Floats, singular: Sequence[Singularity], number: str) -> str:
    """Text for the singularity nearest to a position, among those that exclude ``number``, such as "moment"."""
    those = [one for one in singular if one.excludes(number) and one.where]
    return min(those, key=lambda one: min(math.dist(at, place) for place in one.where)).what
