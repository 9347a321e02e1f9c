"""Groups of bolts that are tightened together, their forces, and checks of these forces."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from signorini.discretise.laws import orders_at
from signorini.discretise.points import ContactPoints
from signorini.discretise.repeated import Repeated
from signorini.discretise.rows import Floats, Ints
from signorini.errors import InputError, Place, Problems, point
from signorini.mesh import Mesh
from signorini.model import Model, Tightening


def bolt_groups(
    model: Model, contacts: ContactPoints, bolt_round: Tightening, place: Place = ()
) -> list[tuple[int, Ints, Floats]]:
    """Return the groups of bolts of a round of tightening as (order, points (k,), forces (k,)); forces are positive.

    A support with a preload has a group for each value of ``order``; a [[tightening]], for each entry of ``sequence``.
    """
    (index,) = (number for number, support in enumerate(model.support) if support.name == bolt_round.support)
    support = model.support[index]
    (bolts,) = np.nonzero(contacts.support == index)
    numbers = contacts.numbers[bolts]
    force = support.on_points(bolt_round.force)(*contacts.positions[bolts].T, above=0.0, place=place)
    if (order := orders_at(support, numbers)) is not None:
        return [(turn, bolts[order == turn], force[order == turn]) for turn in np.unique(order).tolist()]
    groups = [np.isin(numbers + 1, group) for group in bolt_round.sequence or (numbers + 1,)]
    return [(turn, bolts[group], force[group]) for turn, group in enumerate(groups)]


def require_preloads(
    model: Model, mesh: Mesh, contacts: ContactPoints, repeated: Repeated, problems: Problems, between: bool = False
) -> None:
    """Refuse forces above the strength of the bolts, and bolts where rigid supports hold the plate.

    With ``between``, bolts between two plates are checked, otherwise bolts of one plate.
    """
    followed = np.zeros(len(contacts), np.bool_)
    followed[repeated.follows.indices] = True
    least, most = contacts.limits
    strength = np.where(contacts.direction < 0.0, most, -least)
    names = [support.name for support in model.support if (support.between is not None) == between]
    tables = len(model.rounds) - len(model.tightening)
    for number, bolt_round in enumerate(model.rounds):
        if bolt_round.support not in names:
            continue
        index = [support.name for support in model.support].index(bolt_round.support)
        place = ("support", index, "preload") if number < tables else ("tightening", number - tables, "force")
        with problems.collected():
            _require_free(model, index, contacts.numbers[(contacts.support == index) & ~followed])
            groups = bolt_groups(model, contacts, bolt_round, place)
            for factor, where in _factors(model, bolt_round, place):
                for _, bolts, force in groups:
                    if (beyond := factor * force > strength[bolts]).any():
                        worst = int(np.argmax(beyond))
                        times = "" if factor == 1.0 else f", {factor:g} times the preload of {bolt_round.support}"
                        raise InputError(
                            f"found {factor * force[worst]:g}{times}; at "
                            f"{point(contacts.positions[bolts][worst], mesh.size)} the bolt gives "
                            f"{strength[bolts][worst]:g} at most. Tighten the bolt less, or raise its limit or law.",
                            place=where,
                        )


def _require_free(model: Model, index: int, numbers: Ints) -> None:
    """Refuse a support with a bolt that has no contact point; ``numbers`` are the bolts that have one."""
    support = model.support[index]
    key = "at" if support.nodes is None else "nodes"
    for number in range(support.point_count):
        if number not in numbers:
            raise InputError(
                "rigid supports hold the plate both ways there, so that the force of the bolt would not depend on the "
                "load. Leave out the preload, or give these supports a stiffness.",
                place=("support", index, key, number),
            )


def _factors(model: Model, bolt_round: Tightening, place: Place) -> Iterator[tuple[float, Place]]:
    """Yield each factor by which combinations multiply the forces of a round, with its place in the input."""
    yield 1.0, place
    if bolt_round.case is not None:
        yield from model.factors_of(bolt_round.case)
