"""The stops of a load path: its start, its events, and its end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from signorini.base.on_demand import kept
from signorini.base.remade import Brief
from signorini.contact.selection import Answer, NotUnique
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats, Ints, Pieces
from signorini.model import Model
from signorini.results.catalogue import catalogue_of
from signorini.results.checks import checked_fields, checks_in, completed
from signorini.results.extremes import extremes_under, peak
from signorini.results.quantities import EXTREMES, FIELDS, Catalogue, Home
from signorini.results.readings import Readings, SupportForces
from signorini.singularities.beside import PEAKS

_MOST_POINTS = 100
"""Largest number of support points whose numbers a stop lists; if a model has more, stops list only supports."""


@dataclass(frozen=True)
class Switch:
    """A contact point that opens, closes, yields or stops yielding at a stop."""

    support: str
    at: tuple[float, float]
    change: Literal["opens", "closes", "yields", "stops yielding"]

    @property
    def closes(self) -> bool:
        """Whether the point closes, that is begins to push or pull."""
        return self.change == "closes"

    @property
    def opens(self) -> bool:
        """Whether the point opens or yields, so that it no longer adds stiffness."""
        return self.change in ("opens", "yields")


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class PathStop(Brief):
    """State of a load path at one t: the contact points that change, and the numbers that the path stores."""

    t: float
    switched: tuple[Switch, ...]  # contact points that open, close, yield or stop yielding
    points: Ints  # (k,): numbers of the contact points that change the piece of their law at the stop
    pieces: Pieces  # (k,): pieces of the laws that these points are on after the stop
    catalogue: Catalogue  # names of the numbers in ``values``
    values: Floats  # (n,): numbers of the stop, in the order of the catalogue
    largest_at: tuple[float, float]  # positions of the largest and the smallest deflection
    smallest_at: tuple[float, float]
    # Σ nodal load × displacement; the same for all solutions under one load
    work: float
    work_size: float  # Σ |nodal load × displacement|
    not_unique: tuple[NotUnique, ...] = ()  # if several answers are right, how they differ

    @property
    def reactions(self) -> Floats:
        """Total reaction (s,) of every support, positive when it pushes the plate up."""
        return self._of("support", "reaction")

    @property
    def parts(self) -> Floats:
        """Closed part (s,) of every support, 0 to 1: of points by number, of lines by length, of areas by area."""
        return self._of("support", "closed_part")

    @property
    def deflections(self) -> Floats:
        """Deflections (q,) at the model's probes."""
        return self._of("probe", "deflection")

    @property
    def through(self) -> Floats:
        """Moment, twist and shear of each section, then their means at each station of the strips: (3s,)."""
        at = self.catalogue.at
        homes: tuple[Home, ...] = ("section", "station")
        places = [at(home, "moment", "twist", "shear") for home in homes]
        return np.asarray(self.values[np.concatenate(places).ravel()])

    @property
    def largest(self) -> float:
        """Largest deflection over the nodes, positive down."""
        return self.number("deflection.max")

    @property
    def smallest(self) -> float:
        """Smallest deflection over the nodes; negative where the plate lifts."""
        return self.number("deflection.min")

    @property
    def utmost(self) -> float:
        """The extreme deflection that is larger in magnitude; negative where the plate lifts most."""
        return self.smallest if -self.smallest > self.largest else self.largest

    def number(self, name: str) -> float:
        """Value of a number at this stop, by the number's name, such as "bolts[1].reaction"."""
        return float(self.values[self.catalogue.by_name[name]])

    def with_part(self, index: int, part: float, count: int) -> PathStop:
        """Copy of the stop in which support number ``index`` has the closed part ``part``, 0 to 1.

        The support's lifted part, and how many of its ``count`` points are closed or open, are changed with it.
        """
        values, closed = self.values.copy(), round(part * count)
        places = self.catalogue.at("support", "closed_part", "lifted_part", "closed", "open")[index]
        values[places] = part, 1.0 - part, closed, count - closed
        return replace(self, values=values)

    def _of(self, home: Home, name: str) -> Floats:
        return np.asarray(self.values[self.catalogue.at(home, name)])


@dataclass(frozen=True, eq=False)
class Switched:
    """Indices (k,) of the contact points that change the piece of their law at a stop; pieces (k,) before and after."""

    points: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    before: Pieces = field(default_factory=lambda: np.zeros(0, np.uint8))
    after: Pieces = field(default_factory=lambda: np.zeros(0, np.uint8))

    def as_switches(self, discretisation: Discretisation) -> tuple[Switch, ...]:
        """Describe the points that open, close, yield or stop yielding, not those that change between other pieces."""
        contacts = discretisation.contacts.pick(self.points)
        yielded, yields = contacts.yield_on(self.before), contacts.yield_on(self.after)
        opened, opens = contacts.open_on(self.before), contacts.open_on(self.after)
        changes = np.select([yields & ~yielded, yielded, opens], ["yields", "stops yielding", "opens"], "closes")
        (told,) = np.nonzero((yields != yielded) | (opens != opened))
        names = [discretisation.model.support[index].name for index in contacts.support[told].tolist()]
        places = [(x, y) for x, y in contacts.positions[told].tolist()]
        return tuple(map(Switch, names, places, changes[told].tolist()))


@kept
def numbers_at_stops(discretisation: Discretisation) -> Catalogue:
    """Catalogue of the numbers that stops store; those of points only if there are at most `_MOST_POINTS` points."""
    whole = catalogue_of(discretisation, path_fields(discretisation.model), "paths")
    measured = {whole.numbers[place].home for check in checks_in(whole) for place in check.measured}
    many = len(whole.at("point", "reaction")) > _MOST_POINTS and "point" not in measured
    return whole.only(lambda one: one.home != "point" or not many)


def path_fields(model: Model) -> tuple[str, ...]:
    """Names of the fields whose extremes each stop stores: the deflection, and checked fields."""
    return tuple(name for name in FIELDS if name in ("deflection", *checked_fields(model)))


def path_stops(
    discretisation: Discretisation,
    at: Sequence[float],
    loads: Sequence[CaseLoad],
    points: Sequence[Ints],
    switched: Sequence[Switched],
    answers: Sequence[Answer],
    imbalance: Floats | None = None,
) -> list[PathStop]:
    """Compute a stop for each of k answers at the values ``at`` of t.

    ``points`` and ``switched`` are the contact points that change the piece of their law. ``imbalance`` (k, 3n) are the
    residuals F − Ku of plate and springs, without reactions, if known.
    """
    catalogue = numbers_at_stops(discretisation)
    numbers = _numbers(discretisation, catalogue, loads, answers, imbalance)
    deflection = np.array([(answer.hi + answer.lo)[::3] for answer in answers])
    works = np.array([load.nodal * (answer.hi + answer.lo) for load, answer in zip(loads, answers, strict=True)])
    stops = []
    for row, (t, answer) in enumerate(zip(at, answers, strict=True)):
        extremes = [peak(sign * deflection[row], discretisation.mesh.points) for sign in (1.0, -1.0)]
        most, least = [(float(x), float(y)) for x, y in discretisation.mesh.points[extremes]]
        stops.append(
            PathStop(
                t=t,
                switched=switched[row].as_switches(discretisation),
                points=points[row],
                pieces=answer.piece[points[row]],
                catalogue=catalogue,
                values=numbers[row],
                largest_at=most,
                smallest_at=least,
                work=float(works[row].sum()),
                work_size=float(np.abs(works[row]).sum()),
                not_unique=answer.not_unique,
            )
        )
    return stops


def _numbers(
    discretisation: Discretisation,
    catalogue: Catalogue,
    loads: Sequence[CaseLoad],
    answers: Sequence[Answer],
    imbalance: Floats | None,
) -> Floats:
    """Values (k, n) of the n numbers of a catalogue in k answers to k loads."""
    each, fields = [], path_fields(discretisation.model)
    stressed = any(one.home in ("probe", *EXTREMES) and one.quantity.singular in PEAKS for one in catalogue)
    for at, plate in enumerate(discretisation.members):
        own = plate.own
        own_loads, own_answers = [load.on(at) for load in loads], [answer.on(plate) for answer in answers]
        forces = [
            SupportForces.of(
                *(own, load.nodal, answer.hi, answer.lo, own.point_rows.T @ answer.shared),
                imbalance=None if imbalance is None else imbalance[row, plate.dofs],
            )
            for row, (load, answer) in enumerate(zip(own_loads, own_answers, strict=True))
        ]
        beneath = [plate.deflections_beneath((answer.hi + answer.lo)[::3]) for answer in answers]
        pairs = zip(own_loads, own_answers, strict=True)
        at_nodes = [_fields(own, *pair) if stressed else None for pair in pairs]
        readings = Readings.of(own, own_loads, own_answers, forces, at_nodes, beneath)
        told = catalogue_of(own, fields, "paths") if discretisation.plates else catalogue
        numbers, deflections = readings.numbers(told), readings.deflections(slice(None))
        for row, (load, values, deflection) in enumerate(zip(own_loads, at_nodes, deflections, strict=True)):
            ends = {"deflection": {"max": deflection.max(), "min": deflection.min()}}
            if values is not None:
                found = extremes_under(own, load.acting, values, fields[1:])
                ends |= {name: vars(one) for name, one in found.items()}
            for place, one in enumerate(told):
                if one.home in EXTREMES:
                    numbers[row, place] = ends[one.quantity.name][one.what]
        each.append(numbers)
    return completed(catalogue, catalogue.of_members(each))


def _fields(discretisation: Discretisation, load: CaseLoad, answer: Answer) -> Floats:
    """Fields (s, 8) of an answer at the stress nodes, in the order of `LINEAR`."""
    stress, _ = discretisation.plate.stresses(answer.hi, answer.lo, tuple(load.curvature), load.couples)
    nodal, spread = (answer.hi + answer.lo).reshape(-1, 3), discretisation.stress_nodes.spread
    return np.column_stack([spread(nodal[:, 0]), spread(discretisation.held.to_global(nodal[:, 1:])), stress])
