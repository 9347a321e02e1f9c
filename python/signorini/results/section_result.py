"""The forces through sections, and mean moments over strips."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats


@dataclass(frozen=True)
class SectionResult:
    """What the part of the plate on the right of a line gives the part on its left, summed along the line.

    Parameters
    ----------
    name : str
    length : float
        Of the line on the plate.
    moment : float
        Integral of the moment that bends fibres across the line, mnn, positive when it sags.
    twist : float
        Integral of the twisting moment mns, n to the right of the line and s along it.
    shear : float
        Integral of qn: the force on the left part, positive down, which is the reactions there less the loads. What
        acts on the line itself counts half on either side.

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
    """Means across a strip at one of its stations, over its width on the plate.

    Parameters
    ----------
    at : (x, y)
        On the strip's line.
    width : float
        Of the strip there, without holes.
    moment, twist, shear : float
        Per length: mnn, mns and qn, n along the strip and s to its left.
    """

    at: tuple[float, float]
    width: float
    moment: float
    twist: float
    shear: float


@dataclass(frozen=True)
class StripResult:
    """Mean moments, twists and shears of a strip at its stations.

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


def section_results(
    discretisation: Discretisation, through: Floats
) -> tuple[tuple[SectionResult, ...], tuple[StripResult, ...]]:
    """Give sections and strips what `Discretisation.through` says (3s,)."""
    model, values = (
        discretisation.model,
        zip(discretisation.sections.lengths.tolist(), through.reshape(-1, 3).tolist(), strict=True),
    )
    sections = tuple(SectionResult(section.name, *_next(values)) for section in model.section)
    return sections, tuple(
        StripResult(
            strip.name,
            tuple(StationResult((x, y), *_next(values)) for x, y in strip.places[0].tolist()),
        )
        for strip in model.strip
    )


def _next(values: Iterator[tuple[float, list[float]]]) -> tuple[float, float, float, float]:
    length, (moment, twist, shear) = next(values)
    return length, moment, twist, shear
