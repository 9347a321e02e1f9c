"""Load cases by name, those of moving loads' positions made when they are asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from signorini.discretise.loads import CaseLoad, push
from signorini.discretise.quadrature import area_quadrature
from signorini.mesh import Mesh
from signorini.model import Moving
from signorini.model.moving import Wheel
from signorini.shapes import Polygon

_GAUSS = 3


class Cases(Mapping[str, CaseLoad]):
    """Load cases by name.

    Parameters
    ----------
    still : mapping
        Cases that stay where they are.
    moving : tuple of Moving
        Every position of theirs is a case. Wheels, or parts of their prints, that are not on the plate do not act.
    mesh : Mesh
    """

    def __init__(self, still: Mapping[str, CaseLoad], moving: tuple[Moving, ...], mesh: Mesh) -> None:
        self._still = still
        self._places = {at: (load, s) for load in moving for at, s in load.positions.items()}
        self._mesh = mesh

    def __getitem__(self, case: str) -> CaseLoad:
        """Return a case."""
        if case in self._still:
            return self._still[case]
        load, travelled = self._places[case]
        return replace(_position(self._mesh, load.wheels(travelled), load.patch), acting=frozenset([case]))

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        yield from self._still
        yield from self._places

    def __len__(self) -> int:
        """Count the cases."""
        return len(self._still) + len(self._places)


def _position(mesh: Mesh, wheels: list[Wheel], patch: tuple[float, float] | None) -> CaseLoad:
    nodal = np.zeros(3 * mesh.node_count)
    if patch is None:
        where = mesh.locate(np.array([at for at, _, _ in wheels]))
        forces = np.array([force for _, _, force in wheels])
        push(mesh, nodal, where.elements[where.inside], where.xi[where.inside], forces[where.inside])
    else:
        for at, direction, force in wheels:
            points = area_quadrature(mesh, Polygon(_print(at, direction, patch)), _GAUSS)
            push(mesh, nodal, points.elements, points.xi, force / (patch[0] * patch[1]) * points.weights)
    return CaseLoad(nodal, np.zeros(3), np.zeros(2 * len(mesh.elements)), nodal)


def _print(
    at: tuple[float, float], direction: tuple[float, float], patch: tuple[float, float]
) -> tuple[tuple[float, float], ...]:
    """Corners of a wheel's print."""
    (x, y), (tx, ty), (length, width) = at, direction, patch
    corners = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
    return tuple((x + a * length * tx - b * width * ty, y + a * length * ty + b * width * tx) for a, b in corners)
