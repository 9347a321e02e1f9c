"""What runs within elements: borders and jumps, and lines along which slopes are held. Moments there are of no side."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from signorini.discretise import Discretisation
from signorini.discretise.meshing import to_follow
from signorini.discretise.quadrature import curve_quadrature
from signorini.discretise.rows import Ints
from signorini.model.places import curve
from signorini.shapes import Curve, Ring
from signorini.singularities.singularity import Singularity, as_places

_BESIDE = "take values from beside these elements."
_AS_ZONE = "Or say it with a zone, whose border the mesh follows."
_ON_SIDE = 1e-6
"""Part of an element within which a line is on its side."""


def of_cut_elements(discretisation: Discretisation) -> Iterator[Singularity]:
    """Nodes of elements inside which thickness or stiffness jump: their moments are of neither side."""
    zones = discretisation.zones
    cut = discretisation.thickness.layered[0] if discretisation.thickness.layered is not None else np.zeros(0, np.int64)
    parted = zones.parted[:, cut]
    borders = {f"Border of zone {number}": mine for number, mine in enumerate(parted, 1)}
    for what, mine in (borders | {"Jump of the thickness": ~parted.any(axis=0)}).items():
        advice = f"They are those of a laminate of both sides there; {_BESIDE} "
        advice += to_follow(discretisation.model) if what in borders else _AS_ZONE
        yield from _within(discretisation, cut[mine], what, advice, "plate")


def of_held_slopes(discretisation: Discretisation) -> Iterator[Singularity]:
    """Nodes of elements through which a line runs that holds slopes: moments jump there."""
    for support in discretisation.model.support:
        along = curve(support)
        if along is None or not {"slope", "twist"} & set(support.fixed):
            continue
        what = f"The {'circle' if isinstance(along, Ring) else 'line'} of {support.name}"
        advice = f"They are means of both sides there; {_BESIDE} {to_follow(discretisation.model)}"
        yield from _within(discretisation, _crossed(discretisation, along), what, advice, support.name)


def _within(
    discretisation: Discretisation, elements: Ints, what: str, advice: str, source: str
) -> Iterator[Singularity]:
    if len(elements):
        count = f"{len(elements)} element{'s' if len(elements) > 1 else ''}"
        where = as_places(discretisation.mesh.points[np.unique(discretisation.mesh.elements[elements])])
        yield Singularity(where, f"{what} within {count}", ("moment", "shear"), advice, source)


def _crossed(discretisation: Discretisation, along: Curve) -> Ints:
    """Elements (k,) through which a line runs, not along their sides."""
    mesh = discretisation.mesh
    if mesh.edges_along(along) is not None:
        return np.zeros(0, np.int64)
    pieces = curve_quadrature(mesh, along, order=1)
    off = np.abs(mesh.past(pieces.elements, pieces.xi))
    return np.unique(pieces.elements[off.min(axis=1) > _ON_SIDE])
