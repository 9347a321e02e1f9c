"""The forces through sections, and mean moments over strips."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats
from signorini.model import Model

COMPONENTS = ("moment", "twist", "shear")


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
    """Mean moments, twists and shears of a strip at its stations."""

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
    found: Discretisation, through: Floats
) -> tuple[tuple[SectionResult, ...], tuple[StripResult, ...]]:
    """Give sections and strips what `Discretisation.through` says (3s,)."""
    model, values = found.model, zip(found.sections.lengths.tolist(), through.reshape(-1, 3).tolist(), strict=True)
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


def numbers_of(sections: Sequence[SectionResult], strips: Sequence[StripResult]) -> list[float]:
    """Give their moments, twists and shears as they stand in a row of a table (3s,)."""
    stations = [station for strip in strips for station in strip.stations]
    every: list[SectionResult | StationResult] = [*sections, *stations]
    return [number for one in every for number in (one.moment, one.twist, one.shear)]


def columns_of(model: Model) -> list[str]:
    """Name the columns of these numbers (3s,).

    Examples
    --------
    >>> from signorini import Model
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     load=[{"pressure": 5e3}],
    ...     section=[{"name": "A", "line": [[2, 0], [2, 4]]}],
    ...     strip=[{"name": "B", "line": [[0, 2], [4, 2]], "width": 2, "stations": 2}],
    ... )
    >>> columns_of(model)[2:4], columns_of(model)[-1]
    (['section[A]:shear', 'strip[B][1]:moment'], 'strip[B][2]:shear')
    """
    lines = [f"section[{section.name}]" for section in model.section]
    lines += [f"strip[{strip.name}][{station}]" for strip in model.strip for station in range(1, strip.stations + 1)]
    return [f"{line}:{component}" for line in lines for component in COMPONENTS]


def paths_of(model: Model) -> list[tuple[str | int, ...]]:
    """Give the keys and indices that lead to these numbers in results.json (3s,)."""
    lines: list[tuple[str | int, ...]] = [("sections", index) for index in range(len(model.section))]
    for index, strip in enumerate(model.strip):
        lines += [("strips", index, "stations", station) for station in range(strip.stations)]
    return [(*line, component) for line in lines for component in COMPONENTS]
