"""Supports so soft that double precision loses them beside the plate: which one, why, and what would help."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from signorini.discretise import Discretisation

_SOFTEST = 1e-6
"""Stiffness of a support in all, over Et³/12a², from which on it is found on meshes and plates of every kind tried."""


class Softest(NamedTuple):
    """The softest support: its place in the input, and why it is too soft."""

    place: str
    why: str


def softest(found: Discretisation) -> Softest | None:
    """Say which support is the softest, if it is soft enough to be lost."""
    springs, contacts = found.springs, found.contacts
    yielding = contacts.compliance > 0
    who = np.concatenate([springs.support, contacts.support[yielding]])
    stiffness = np.concatenate([springs.stiffness, 1.0 / contacts.compliance[yielding]])
    if not len(who):
        return None
    supports, which = np.unique(who, return_inverse=True)
    total = np.bincount(which, stiffness)
    index, least = int(supports[total.argmin()]), float(total.min())
    own = found.model.material.E * float(found.thickness.max()) ** 3 / 12 / found.mesh.size**2
    if least >= _SOFTEST * own:
        return None
    return Softest(
        f"support[{index + 1}].stiffness",
        f"The stiffness of {found.model.support[index].name}, {least:.3g} in all, is {least / own:.1g} of the plate's "
        "own, E t³/12 over its size squared, and double precision loses it beside what else holds the plate. Give it "
        f"at least {_SOFTEST * own:.3g} in all, or leave it out and hold the plate otherwise.",
    )
