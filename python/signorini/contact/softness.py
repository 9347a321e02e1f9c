"""Supports so soft that double precision loses them beside the plate: which one, why, and what would help."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from signorini.discretise import Discretisation
from signorini.errors import Place

_SOFTEST = 1e-6
"""Stiffness of a support in all, over Et³/12a², from which on it is found on meshes and plates of every kind tried."""
_SURE = 100.0
"""Times that stiffness which one that is surely found has, on the plates tried."""
_MORE = 10.0
"""Times the stiffness that it has by which a support that is lost all the same is to be stiffer."""
_DOUBTFUL = 1e3
"""Times that stiffness below which a support may be lost on some plates all the same."""


class Softest(NamedTuple):
    """The softest support: its place in the input, and why it is too soft."""

    place: Place
    why: str


def softest(found: Discretisation, doubtful: bool = False) -> Softest | None:
    """Say which support is the softest, if it is soft enough to be lost, or ``doubtful`` ones, perhaps to be lost.

    Examples
    --------
    >>> from signorini import Model
    >>> from signorini.discretise import discretise
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
    ...     support=[{"edge": "left", "fix": "simple"}, {"name": "bed", "area": "all", "stiffness": 0.1}],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> softest(discretise(model)), softest(discretise(model), doubtful=True).place
    (None, ('support', 1, 'stiffness'))
    """
    springs, contacts = found.springs, found.contacts
    yielding = contacts.compliance > 0
    who = np.concatenate([springs.support, contacts.support[yielding]])
    stiffness = np.concatenate([springs.stiffness, 1.0 / contacts.compliance[yielding]])
    if not len(who):
        return None
    supports, which = np.unique(who, return_inverse=True)
    total = np.bincount(which, stiffness)
    index, least = int(supports[total.argmin()]), float(total.min())
    own = found.model.young * float(found.thickness.max()) ** 3 / 12 / found.mesh.size**2
    if least >= _SOFTEST * own * (_DOUBTFUL if doubtful else 1.0):
        return None
    enough = max(_SURE * _SOFTEST * own, _MORE * least)
    loses = "loses" if least < _SOFTEST * own else "may lose"
    return Softest(
        ("support", index, "stiffness"),
        f"The stiffness of {found.model.support[index].name}, {least:.4g} in all, is {least / own:.2g} of the plate's "
        f"own, E t³/12 over its size squared, and double precision {loses} it beside what else holds the plate. Give "
        f"it at least {enough:.3g} in all, or leave it out and hold the plate otherwise.",
    )
