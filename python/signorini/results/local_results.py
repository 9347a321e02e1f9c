"""Results at places of the plate: probes, profiles along lines, sections and strips."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypedDict

import numpy as np

from signorini.base.on_demand import Listed, kept
from signorini.design.en1992_bending import Bars
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.stressnodes import Sides, StressNodes
from signorini.mesh import Location, Mesh
from signorini.model.output import Profile
from signorini.results.contact_field.area_contact import AreaContact, without_shared_borders
from signorini.results.quantities import PRESSURE, along_strips, derived

_FACES = ("top", "bottom")
_ALONG = 1e-6
"""Largest component of a strip's unit tangent across the x or y axis at which the strip counts as along this axis."""


@dataclass(frozen=True)
class ProbeResult:
    """Results at a point of the plate; where moments or shears jump, the values of larger magnitude are given.

    Parameters
    ----------
    at : (x, y)
    deflection : float
    rotation : (θx, θy)
    moment : (mx, my, mxy)
    shear : (qx, qy)
    pressure : float or None
        Contact pressure of area supports, positive up; None without an area support at the point.
    thickness : float
        Thickness of a solid plate; at a jump, of the thinner side. NaN if the input gives a stiffness in place of a
        solid section.
    bars : Bars or None
        Section of reinforced concrete; None without [reinforcement].
    of_bars : (mx, my, mxy) or None
        Moments for the design of bars, see `Reinforcement.face`; None if they are ``moment``.
    """

    at: tuple[float, float]
    deflection: float
    rotation: tuple[float, float]
    moment: tuple[float, float, float]
    shear: tuple[float, float]
    pressure: float | None

    thickness: float
    bars: Bars | None = None
    of_bars: tuple[float, float, float] | None = None

    @property
    def principal_moment(self) -> tuple[float, float, float]:
        """Principal moments m1 ≥ m2, and the angle from x to the direction of m1, in degrees towards y.

        Examples
        --------
        >>> ProbeResult((0, 0), 0, (0, 0), (3.0, 3.0, 1.0), (0, 0), None, 1.0).principal_moment
        (4.0, 2.0, 45.0)
        """
        m1, m2, angle = self._derived("m1", "m2", "m_angle")
        return m1, m2, angle

    @property
    def design_moment(self) -> dict[str, tuple[float, float]]:
        """Moments for which reinforcement along x and y is designed: "bottom" ≥ 0, "top" ≤ 0.

        They are those of R. H. Wood, *The reinforcement of slabs in accordance with a pre-determined field of moments*,
        Concrete 2 (1968), and G. S. T. Armer, discussion of this paper.
        """
        return self._at_faces("mx", "my")

    @property
    def reinforcement(self) -> dict[str, tuple[float, float]] | None:
        """Required reinforcement along x and y at "bottom" and "top", area per length; None without [reinforcement].

        The area is infinite where the section cannot resist the design moment.
        """
        return self._at_faces("as_x", "as_y") if self.bars else None

    @property
    def minimum_governs(self) -> dict[str, tuple[bool, bool]] | None:
        """Whether each area of `reinforcement` is the code's minimum reinforcement; None without [reinforcement]."""
        bars, areas = self.bars, self.reinforcement
        if bars is None or areas is None:
            return None
        x, y = (
            {face: bool(bars.are_least(f"as_{axis}_{face}", areas[face][at], self.thickness)) for face in areas}
            for at, axis in enumerate("xy")
        )
        return {face: (x[face], y[face]) for face in areas}

    def _at_faces(self, x: str, y: str) -> dict[str, tuple[float, float]]:
        names = [f"{name}_{face}" for face in ("bottom", "top") for name in (x, y)]
        a, b, c, d = self._derived(*names, moment=self.of_bars or self.moment)
        return {"bottom": (a, b), "top": (c, d)}

    def _derived(self, *names: str, moment: tuple[float, float, float] | None = None) -> list[float]:
        given, shear, thickness = np.array(moment or self.moment), np.array(self.shear), np.array(self.thickness)
        values: list[float] = derived(names, given, shear, thickness, self.bars).tolist()
        return values

    @property
    def stress(self) -> dict[str, tuple[float, ...]]:
        """Stresses of a solid plate: σx, σy, τxy at "top" and "bottom", tension positive; "von_mises"; "shear".

        The two von Mises stresses are those at the top and the bottom. Shear stresses are τxz, τyz at mid-depth. All
        are NaN where a stiffness is given instead of a solid section.

        Examples
        --------
        >>> ProbeResult((0, 0), 0, (0, 0), (3.0, 0.0, 0.0), (0, 4.0), None, 2.0).stress["bottom"]
        (4.5, 0.0, 0.0)
        """
        at = {face: tuple(self._derived(*(f"{name}_{face}" for name in ("sx", "sy", "txy")))) for face in _FACES}
        mises, shear = self._derived("von_mises", "von_mises_bottom"), self._derived("txz", "tyz")
        return at | {"von_mises": tuple(mises), "shear": tuple(shear)}


def probe_results(
    positions: Floats, fields: Floats, pressures: Floats, thickness: Floats, bars: Bars | None, of_bars: Floats
) -> tuple[ProbeResult, ...]:
    """Results of probes at positions (q, 2), from fields (q, 8), pressures (q,) and thickness (q,) there.

    Pressures are NaN off area supports. ``of_bars`` (q, 3) are the moments for the design of ``bars``, `Model.bars`.
    """
    columns = positions.tolist(), fields.tolist(), pressures.tolist(), thickness.tolist(), of_bars.tolist()
    return tuple(
        ProbeResult(
            *((x, y), v[0], (v[1], v[2]), (v[3], v[4], v[5]), (v[6], v[7])),
            *(None if np.isnan(p) else p, h, bars, (m[0], m[1], m[2])),
        )
        for (x, y), v, p, h, m in zip(*columns, strict=True)
    )


def fields_at(fields: Floats, nodes: StressNodes, where: Location, positions: Floats) -> Floats:
    """Interpolate fields (s, f) to positions (q, 2); where a field jumps, take the value of larger magnitude."""
    sides = nodes.sides(positions, where)
    return sides.larger(nodes.at(sides, fields))


def total_pressure(areas: Sequence[AreaContact], positions: Floats) -> Floats:
    """Sum (q,) of the pressures of areas at positions (q, 2) on the plate; NaN where there is no area.

    On the common border of areas that only touch, the value is the pressure of one of these areas.
    """
    if not areas or not len(positions):
        return np.full(len(positions), np.nan)
    result = np.array([area.pressure(positions) for area in areas])
    on = without_shared_borders(areas, positions, ~np.isnan(result))
    return np.where(on.any(axis=0), np.where(on, result, 0.0).sum(axis=0), np.nan)


@dataclass(frozen=True, eq=False)
class ProfileResult:
    """Fields at the stations (k,) of a line; where a field jumps, the value of larger magnitude.

    Parameters
    ----------
    name : str
    distance : (k,) array
        Distance of each station from the beginning of the line.
    at : (k, 2) array
    values : dict of (k,) arrays
        Every field by name, and the pressure of area supports, positive up. Fields are NaN off the plate, the pressure
        also off the areas.
    """

    name: str
    distance: Floats
    at: Floats
    values: Mapping[str, Floats]

    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield a row for each station, with values by name of the column; None where a value is missing."""
        columns = {"distance": self.distance, "x": self.at[:, 0], "y": self.at[:, 1], **self.values}
        for row in zip(*(column.tolist() for column in columns.values()), strict=True):
            yield {name: None if np.isnan(value) else value for name, value in zip(columns, row, strict=True)}


def profile_results(
    profiles: Sequence[Profile],
    fields: Mapping[str, Floats],
    nodes: StressNodes,
    areas: Sequence[AreaContact],
) -> tuple[ProfileResult, ...]:
    """Interpolate fields, (n,) at nodes or (s,) at stress nodes, to the stations of profiles."""
    table = np.column_stack([nodes.spread(values) for values in fields.values()])
    result = []
    for profile in profiles:
        distance, at = profile.places
        where, on = stations(nodes.mesh, at)
        values = np.full((len(at), len(fields) + 1), np.nan)
        values[on, :-1] = fields_at(table, nodes, where, at[on])
        values[on, -1] = total_pressure(areas, at[on])
        result.append(
            ProfileResult(profile.name, distance, at, dict(zip((*fields, PRESSURE.name), values.T, strict=True)))
        )
    return tuple(result)


def stations(mesh: Mesh, at: Floats) -> tuple[Location, Bools]:
    """Locate those of the points (k, 2) that are on the plate; also return their mask (k,)."""
    where = mesh.locate(at)
    return Location(where.elements[where.inside], where.xi[where.inside]), where.inside


@dataclass(frozen=True)
class SectionResult:
    """Force and moments, integrated along a line, that the plate on its right exerts on the plate on its left.

    Parameters
    ----------
    name : str
    length : float
        Length of the part of the line that is on the plate.
    moment : float
        ∫ mnn ds of the moment that bends fibres across the line, positive where the plate sags.
    twist : float
        ∫ mns ds of the twisting moment; n points to the right of the line, s along the line.
    shear : float
        ∫ qn ds: force on the left part, positive down. It equals the reactions minus the loads on this part.
        Loads and reactions on the line itself count half on either side.

    Examples
    --------
    >>> from signorini import Model, solve
    >>> cantilever = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 2], "thickness": 0.2},
    ...     support=[{"edge": ["left"], "fix": "clamped"}],
    ...     load=[{"line_load": 5e3, "edge": ["right"]}],
    ...     section=[{"line": [[1, 0], [1, 2]]}],
    ... )
    >>> (section,) = solve(cantilever)["all"].sections
    >>> round(section.moment, 3), round(section.shear, 3)
    (-30000.0, 10000.0)
    """

    name: str
    length: float
    moment: float
    twist: float
    shear: float


@dataclass(frozen=True)
class StationResult:
    """Mean moment, twist and shear across a strip at a station, over the width of the strip that is on the plate.

    Parameters
    ----------
    at : (x, y)
        Position of the station on the strip's line.
    width : float
        Width of the strip on the plate at the station; holes are subtracted.
    moment, twist, shear : float
        Means per length of mnn, mns and qn; n is along the strip, s to its left.
    design_moment : dict
        Moments for which reinforcement along the strip is designed: "bottom" ≥ 0, "top" ≤ 0.
    reinforcement : dict or None
        Required reinforcement along the strip at "bottom" and "top", area per length, NaN for strips that are not along
        x or y; None without [reinforcement].
    minimum_governs : dict or None
        Whether each ``reinforcement`` is the minimum; None without [reinforcement].
    """

    at: tuple[float, float]
    width: float
    moment: float
    twist: float
    shear: float
    design_moment: dict[str, float]
    reinforcement: dict[str, float] | None
    minimum_governs: dict[str, bool] | None


@dataclass(frozen=True)
class StripResult:
    """Mean moments, twists and shears across a strip at its stations.

    Examples
    --------
    >>> from signorini import Model, solve
    >>> slab = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [6, 4], "thickness": 0.2},
    ...     support=[{"edge": ["left", "right"], "fix": "simple"}],
    ...     load=[{"pressure": 5e3}],
    ...     strip=[{"line": [[0, 2], [6, 2]], "width": 4}],
    ... )
    >>> (strip,) = solve(slab)["all"].strips
    >>> strip.sagging.at, round(strip.sagging.moment, 3)
    ((3.0, 2.0), 22500.0)
    """

    name: str
    stations: tuple[StationResult, ...]

    @property
    def sagging(self) -> StationResult:
        """The station with the largest mean moment."""
        return max(self.stations, key=lambda station: station.moment)

    @property
    def hogging(self) -> StationResult:
        """The station with the smallest mean moment."""
        return min(self.stations, key=lambda station: station.moment)


class SectionsAndStrips(TypedDict):
    """Results of all sections and strips of a model, by name of the keyword arguments of `ResultState`."""

    sections: Listed[SectionResult]
    strips: Listed[StripResult]


_ACROSS = 9
"""Number of points across a strip at which the thickness is evaluated to find the least thickness."""


@kept
def strip_sections(discretisation: Discretisation) -> tuple[Floats, Ints]:
    """Least thickness (c,) of one plate along each cross line of its strips, and the direction (c,) of the strip there.

    Cross lines are those at stations, then those at faces of columns. The direction is 0 for x, 1 for y, −1 for others.
    The thickness is NaN where the section is given by its stiffness.
    """
    nodes, strips, faces = discretisation.stress_nodes, discretisation.model.strip, discretisation.sections.faces
    across = [ends for strip in strips for ends in strip.across]
    ends = np.array([*across, *(ends for _, ends in faces)]).reshape(-1, 2, 2)
    part = np.linspace(0.01, 0.99, _ACROSS)[:, None]
    points = (ends[:, :1] + part * (ends[:, 1:] - ends[:, :1])).reshape(-1, 2)
    point, where = nodes.mesh.holding(points)
    thickness, known = np.full(len(ends), np.inf), nodes.at(Sides(point, where), discretisation.node_thickness)
    # A thickness is NaN where the section is given by its stiffness; np.minimum keeps NaN, with a warning.
    with np.errstate(invalid="ignore"):
        np.minimum.at(thickness, point // _ACROSS, known)
    tangent = np.abs(np.concatenate([np.zeros((0, 2)), *(strip.places[1] for strip in strips)]))
    axis = np.where(tangent[:, 1] < _ALONG, 0, np.where(tangent[:, 0] < _ALONG, 1, -1))
    return thickness, np.concatenate([axis, axis[np.array([station for station, _ in faces], np.int64)]])


def designed(discretisation: Discretisation, what: str, through: Floats) -> Floats:
    """Design moments or required reinforcement (..., c) at c stations of strips, from means (..., c + f, 3).

    The last f means are at faces of columns. A station inside a column has the value of larger magnitude of those at
    the column's faces.
    """
    values = along_strips(what, through, *strip_sections(discretisation), discretisation.model.bars)
    faces = np.array([station for station, _ in discretisation.sections.faces], np.int64)
    count = values.shape[-1] - len(faces)
    result = values[..., :count].copy()
    for station in np.unique(faces):
        own = values[..., count + np.flatnonzero(faces == station)]
        result[..., station] = np.take_along_axis(own, np.abs(own).argmax(axis=-1)[..., None], axis=-1)[..., 0]
    return result


def least_along(discretisation: Discretisation, face: str, areas: Sequence[float]) -> Bools:
    """Mask (c,) of the stations of strips at which the required area is the minimum reinforcement for the thickness."""
    bars, count, (thickness, axis) = discretisation.model.bars, len(areas), strip_sections(discretisation)
    assert bars is not None  # A model without [reinforcement] has no areas of bars.
    x, y = (bars.are_least(f"as_{name}_{face}", np.array(areas), thickness[:count]) for name in "xy")
    return np.where(axis[:count] == 0, x, y)


def section_results(discretisation: Discretisation, through: Floats) -> SectionsAndStrips:
    """Results of sections and strips from ``through`` (3s,): moment, twist and shear of s sections and stations."""
    lengths = discretisation.cut_lengths.tolist()
    values = ((length, *row) for length, row in zip(lengths, through.reshape(-1, 3).tolist(), strict=False))
    sections = [SectionResult(section.name, *next(values)) for section in discretisation.model.section]
    strips = []
    means, bars = through.reshape(-1, 3)[len(sections) :], discretisation.model.bars
    faces = {
        what: designed(discretisation, what, means).tolist()
        for what in (f"{name}_{face}" for name in (("moment", "as") if bars else ("moment",)) for face in _FACES)
    }
    least = {f: least_along(discretisation, f, faces[f"as_{f}"]).tolist() for f in _FACES} if bars else {}
    number = iter(range(len(means)))
    for strip in discretisation.model.strip:
        stations = []
        for (x, y), station in zip(strip.places[0].tolist(), number, strict=False):
            length, moment, twist, shear = next(values)
            design = {face: faces[f"moment_{face}"][station] for face in _FACES}
            required = {face: faces[f"as_{face}"][station] for face in _FACES} if bars else None
            governs = {face: least[face][station] for face in _FACES} if bars else None
            stations.append(StationResult((x, y), length, moment, twist, shear, design, required, governs))
        strips.append(StripResult(strip.name, tuple(stations)))
    return SectionsAndStrips(sections=Listed(sections, "section"), strips=Listed(strips, "strip"))
