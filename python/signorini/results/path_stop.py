"""The stops of a load path: its start, events, and its end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from signorini.base.on_demand import kept
from signorini.base.remade import Brief
from signorini.contact.certificate import imbalances
from signorini.contact.selection import Answer, NotUnique
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats, Ints, Pieces
from signorini.results.catalogue import catalogue_of
from signorini.results.extremes import peak
from signorini.results.of_plates import places_in_plates
from signorini.results.quantities import SIDES, TURNING, Catalogue, Home
from signorini.results.support_points import SupportPoints, closed_part
from signorini.results.support_result import area_at_rest

_MOST_POINTS = 100
"""Largest number of points whose reactions are listed at each stop."""


@dataclass(frozen=True)
class Switch:
    """A contact point that opens, closes, yields or stops to."""

    support: str
    at: tuple[float, float]
    change: Literal["opens", "closes", "yields", "stops yielding"]

    @property
    def closes(self) -> bool:
        """Whether it begins to bear."""
        return self.change == "closes"

    @property
    def opens(self) -> bool:
        """Whether it bears no more than before: it opens or yields."""
        return self.change in ("opens", "yields")


@dataclass(frozen=True, eq=False, repr=False)
class PathStop(Brief):
    """The path at one t. Between two stops all numbers are linear in t, except extremes and work."""

    t: float
    switched: tuple[Switch, ...]  # contact points that open or close here
    points: Ints  # (k,): which contact points these are
    pieces: Pieces  # (k,): pieces of their laws that they are on from here on
    catalogue: Catalogue  # catalogue of ``values``
    values: Floats  # (n,): points that are closed after the stop
    largest_at: tuple[float, float]  # where the extremes of the deflection are
    smallest_at: tuple[float, float]
    work: float  # sum of nodal loads times displacements: the same for all solutions of one load
    work_size: float  # sum of the magnitudes
    not_unique: tuple[NotUnique, ...] = ()  # freedoms of the answer among equally right ones

    @property
    def reactions(self) -> Floats:
        """Total (s,) of every support, positive when it pushes the plate up."""
        return self._of("support", "reaction")

    @property
    def parts(self) -> Floats:
        """The part (s,) of every support that is closed: of points as many, of lines by length, of areas by area."""
        return self._of("support", "closed_part")

    @property
    def deflections(self) -> Floats:
        """Deflections (q,) at the model's probes."""
        return self._of("probe", "deflection")

    @property
    def through(self) -> Floats:
        """Moment, twist and shear (3s,) of the model's sections, and their means at the stations of its strips."""
        at = self.catalogue.at
        homes: tuple[Home, ...] = ("section", "station")
        places = [at(home, "moment", "twist", "shear") for home in homes]
        return np.asarray(self.values[np.concatenate(places).ravel()])

    @property
    def largest(self) -> float:
        """Largest deflection at a node."""
        return self.number("deflection.max")

    @property
    def smallest(self) -> float:
        """Smallest deflection at a node."""
        return self.number("deflection.min")

    @property
    def utmost(self) -> float:
        """The extreme of the deflection that is larger in size, negative where the plate lifts most."""
        return self.smallest if -self.smallest > self.largest else self.largest

    def number(self, name: str) -> float:
        """A number by its name, such as "bolts[1].reaction"."""
        return float(self.values[self.catalogue.by_name[name]])

    def with_part(self, index: int, part: float, count: int) -> PathStop:
        """The closed part of a support, and the number of its closed points."""
        values, closed = self.values.copy(), round(part * count)
        values[self.catalogue.at("support", "closed_part", "closed", "open")[index]] = part, closed, count - closed
        return replace(self, values=values)

    def _of(self, home: Home, name: str) -> Floats:
        return np.asarray(self.values[self.catalogue.at(home, name)])


@dataclass(frozen=True, eq=False)
class Switched:
    """Contact points (k,) that come onto other pieces of their laws, and those that they come from."""

    points: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    before: Pieces = field(default_factory=lambda: np.zeros(0, np.uint8))

    def as_switches(self, discretisation: Discretisation, answer: Answer) -> tuple[Switch, ...]:
        """Describe the changes of points, with places; a change between pieces of a law without a name is skipped."""
        contacts, after = discretisation.contacts.pick(self.points), answer.piece[self.points]
        yielded, yields = contacts.yield_on(self.before), contacts.yield_on(after)
        opened, opens = contacts.open_on(self.before), contacts.open_on(after)
        changes = np.select([yields & ~yielded, yielded, opens], ["yields", "stops yielding", "opens"], "closes")
        (told,) = np.nonzero((yields != yielded) | (opens != opened))
        names = [discretisation.model.support[index].name for index in contacts.support[told].tolist()]
        places = [(x, y) for x, y in contacts.positions[told].tolist()]
        return tuple(map(Switch, names, places, changes[told].tolist()))


@kept
def numbers_at_stops(discretisation: Discretisation) -> Catalogue:
    """The numbers of stops; points of supports at points only if they are few."""
    whole = catalogue_of(discretisation, ("deflection",)).along_paths
    many = len(whole.at("point", "reaction")) > _MOST_POINTS
    told = tuple(one for one in whole if one.home != "point" or not many)
    own = [catalogue_of(plate.own, ("deflection",)).along_paths for plate in discretisation.plates]
    return Catalogue(told, places_in_plates(discretisation.model, told, own) if own else ())


def path_stops(
    discretisation: Discretisation,
    at: Sequence[float],
    loads: Sequence[CaseLoad],
    points: Sequence[Ints],
    switched: Sequence[Switched],
    answers: Sequence[Answer],
    imbalance: Floats | None = None,
) -> list[PathStop]:
    """Reduce answers (k,) to the numbers that a path keeps; ``switched`` are the points that open or close.

    ``imbalance`` (k, 3n) are their residuals, of plate and springs alone, if known.
    """
    catalogue = numbers_at_stops(discretisation)
    numbers = _numbers(discretisation, catalogue, loads, answers, imbalance, {})
    deflection = np.array([(answer.hi + answer.lo)[::3] for answer in answers])
    works = np.array([load.nodal * (answer.hi + answer.lo) for load, answer in zip(loads, answers, strict=True)])
    stops = []
    for row, (t, answer) in enumerate(zip(at, answers, strict=True)):
        extremes = [peak(sign * deflection[row], discretisation.mesh.points) for sign in (1.0, -1.0)]
        most, least = [(float(x), float(y)) for x, y in discretisation.mesh.points[extremes]]
        stops.append(
            PathStop(
                t,
                switched[row].as_switches(discretisation, answer),
                points[row],
                answer.piece[points[row]],
                catalogue,
                numbers[row],
                most,
                least,
                float(works[row].sum()),
                float(np.abs(works[row]).sum()),
                answer.not_unique,
            )
        )
    return stops


def _numbers(
    discretisation: Discretisation,
    catalogue: Catalogue,
    loads: Sequence[CaseLoad],
    answers: Sequence[Answer],
    imbalance: Floats | None,
    beneath: Mapping[int, Floats],
) -> Floats:
    """The numbers of the catalogue in every answer (k, n); ``beneath`` are other plates' deflections (k, n)."""
    if discretisation.plates:
        return _of_plates(discretisation, catalogue, loads, answers)
    hi, lo = np.array([answer.hi for answer in answers]), np.array([answer.lo for answer in answers])
    imbalance = imbalances(discretisation, loads, hi, lo) if imbalance is None else imbalance
    deflection, pull = (hi + lo)[:, ::3], discretisation.spring_forces(hi, lo)
    numbers = np.full((len(answers), len(catalogue)), np.nan)
    _put_supports(discretisation, catalogue, numbers, imbalance, pull, deflection, answers, beneath)
    values = discretisation.mesh.shape_functions(discretisation.probes.elements, discretisation.probes.xi)
    at_probes = np.einsum(
        "qi,kqi->kq", values, deflection[:, discretisation.mesh.elements[discretisation.probes.elements]]
    )
    numbers[:, catalogue.at("probe", "deflection")] = at_probes
    ends = np.stack([deflection.max(axis=1), deflection.min(axis=1)], axis=1)
    numbers[:, catalogue.at("field", *SIDES)] = ends[:, None]
    for row, (load, answer) in enumerate(zip(loads, answers, strict=True)):
        through = discretisation.through(load, answer.hi, answer.lo, answer.shared, pull[row])
        catalogue.put_through(numbers[row], through)
    return numbers


def _of_plates(
    discretisation: Discretisation, catalogue: Catalogue, loads: Sequence[CaseLoad], answers: Sequence[Answer]
) -> Floats:
    """Those of several plates, from each of them."""
    own, each = [catalogue_of(one, ("deflection",)).along_paths for one in discretisation.each], list[Floats]()
    deflections = [np.array([(one.hi + one.lo)[plate.dofs][::3] for one in answers]) for plate in discretisation.plates]
    for at, plate in enumerate(discretisation.plates):
        beneath = {which: (matrix @ deflections[other].T).T for which, (other, matrix) in plate.beneath.items()}
        on = [load.plates[at] for load in loads], [answer.on(plate) for answer in answers]
        each.append(_numbers(plate.own, own[at], *on, None, beneath))
    result = np.empty((len(answers), len(catalogue)))
    for place, of in enumerate(catalogue.in_plates):
        values = [each[plate][:, number] for plate, number in of]
        smallest = catalogue.numbers[place].what == "min"
        result[:, place] = np.min(values, axis=0) if smallest else np.max(values, axis=0)
    return result


def _put_supports(
    discretisation: Discretisation,
    catalogue: Catalogue,
    numbers: Floats,
    imbalance: Floats,
    pull: Floats,
    deflection: Floats,
    answers: Sequence[Answer],
    beneath: Mapping[int, Floats],
) -> None:
    """Fill in the numbers of supports and their points in each answer (k, n)."""
    shared, all_closed = np.array([one.shared for one in answers]), np.array([one.closed for one in answers])
    gaps = np.array([one.gap for one in answers])
    held_force = np.where(discretisation.held.dofs, imbalance - (discretisation.point_rows.T @ shared.T).T, 0.0)[:, ::3]
    of_points: list[tuple[Floats, Floats]] = []
    moments = [SupportPoints.of(discretisation, i).moments(pull) for i in range(len(discretisation.model.support))]
    areas = [index for index, support in enumerate(discretisation.model.support) if support.area is not None]
    for index, support in enumerate(discretisation.model.support):
        points = SupportPoints.of(discretisation, index)
        fixed = np.concatenate([held_force[:, points.nodes], pull[:, points.springs]], axis=1)
        reactions, closed = points.forces(fixed, shared), points.closed(all_closed)
        contact = np.full(len(answers), np.nan)
        if support.area is not None:
            at_rest, above = area_at_rest(discretisation, index), deflection - beneath.get(index, 0.0)
            contact = at_rest.contact_areas(above, closed)
            pressures = at_rest.measured(above[:, at_rest.on_nodes], reactions)
            most = np.fmax.reduce(pressures, axis=1, initial=0.0)
            at = catalogue.at("support", "contact_area", "max_pressure")[areas.index(index)]
            numbers[:, at] = np.stack([contact, most], axis=1)
        parts = [
            closed_part(discretisation, index, one, area) for one, area in zip(answers, contact.tolist(), strict=True)
        ]
        count = closed.sum(axis=1)
        at = catalogue.at("support", "reaction", "closed", "open", "closed_part")[index]
        numbers[:, at] = np.stack([reactions.sum(axis=1), count, closed.shape[1] - count, parts], axis=1)
        if support.place == "at":
            of_points.append((reactions, points.gaps(gaps)))
    if len(at := catalogue.at("point", "reaction", "gap")):
        numbers[:, at] = np.stack([np.concatenate(column, axis=1) for column in zip(*of_points, strict=True)], axis=-1)
        numbers[:, catalogue.at("point", *TURNING)] = np.concatenate(moments, axis=1)
