"""Preloads that bolts cannot be given."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from signorini.discretise.points import ContactPoints
from signorini.discretise.repeated import Repeated
from signorini.errors import InputError, Place, Problems, point
from signorini.mesh import Mesh
from signorini.model import Model, Support


def require_preloads(
    model: Model, mesh: Mesh, contacts: ContactPoints, repeated: Repeated, problems: Problems, between: bool = False
) -> None:
    """Refuse preloads beyond what bolts can give, and those of bolts where rigid supports hold the plate.

    Of bolts of one plate, or those between two.
    """
    followed = np.zeros(len(contacts), np.bool_)
    followed[repeated.follows.indices] = True
    for index, support in enumerate(model.support):
        if support.preload is None or (support.between is not None) != between:
            continue
        own = contacts.pick(np.flatnonzero((contacts.support == index) & ~followed))
        with problems.collected():
            _require_free(support, own, ("support", index))
            force = support.preload(*own.positions.T, above=0.0, place=("support", index, "preload"))
            least, most = own.limits
            strength = np.where(own.direction < 0.0, most, -least)
            for factor, place in _factors(model, index):
                if (beyond := factor * force > strength).any():
                    at = int(np.argmax(beyond))
                    times = "" if factor == 1.0 else f", {factor:g} times the preload of {support.name}"
                    raise InputError(
                        f"found {factor * force[at]:g}{times}; at {point(own.positions[at], mesh.size)} the bolt gives "
                        f"{strength[at]:g} at most. Tighten it less, or raise its limit or law.",
                        place=place,
                    )


def _require_free(support: Support, own: ContactPoints, place: Place) -> None:
    """Refuse bolts of which some have no contact point of their own."""
    key = "at" if support.nodes is None else "nodes"
    for number in range(len(getattr(support, key))):
        if number not in own.numbers:
            raise InputError(
                "rigid supports hold the plate both ways there, so that the bolt would carry its preload whatever "
                "acts. Leave out its preload, or give those supports a stiffness.",
                place=(*place, key, number),
            )


def _factors(model: Model, index: int) -> Iterator[tuple[float, Place]]:
    """Factors of a support's preload, with the places where they stand."""
    case = model.support[index].preload_case
    yield 1.0, ("support", index, "preload")
    if case is not None:
        for number, combination in enumerate(model.combination):
            for factor in sorted(combination.factors_of(case)):
                yield factor, ("combination", number, *combination.cases[case])
