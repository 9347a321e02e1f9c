"""Load cases by name, those of moving loads' positions made when they are asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from signorini.discretise.loads import CaseLoad, Onto
from signorini.discretise.quadrature import Quadrature, area_quadrature
from signorini.discretise.sections import Sections
from signorini.discretise.sections.acting import Spread
from signorini.mesh import Mesh
from signorini.model import Moving
from signorini.model.load import Wheel
from signorini.shapes import Polygon

_GAUSS = 3
_NOTHING = 1e-9
"""Part of a print that is rounding where it ends with the plate."""


class Cases(Mapping[str, CaseLoad]):
    """Load cases by name.

    Parameters
    ----------
    still : mapping
        Cases that stay where they are.
    moving : tuple of Moving
        Every position of theirs is a case. Wheels, or parts of their prints, that are not on the plate do not act.
    mesh : Mesh
    sections : Sections
    """

    def __init__(
        self, still: Mapping[str, CaseLoad], moving: tuple[Moving, ...], mesh: Mesh, sections: Sections
    ) -> None:
        self._still = still
        self._places = {at: (load, s) for load in moving for at, s in load.positions.items()}
        self._mesh, self._sections = mesh, sections

    def __getitem__(self, case: str) -> CaseLoad:
        """Return a case."""
        if case in self._still:
            return self._still[case]
        load, travelled = self._places[case]
        result = _position(Onto(self._mesh, self._sections), load.wheels(travelled), load.patch)
        return replace(result, acting=frozenset([case]))

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        yield from self._still
        yield from self._places

    def __len__(self) -> int:
        """Count the cases."""
        return len(self._still) + len(self._places)

    def partly_off(self) -> Iterator[tuple[str, str, int, float]]:
        """Where wheels' prints are partly off the plate: moving load, position, axle from 1, part of the force lost.

        Wheels wholly off it have not arrived yet, or are gone.
        """
        for name, (load, travelled) in self._places.items():
            if load.patch is None:
                continue
            wheels = load.wheels(travelled)
            prints = np.array([_print(at, direction, load.patch) for at, direction, _ in wheels])
            inside = self._mesh.locate(prints.reshape(-1, 2)).inside.reshape(-1, 4)
            for wheel in np.flatnonzero(inside.any(axis=1) & ~inside.all(axis=1)).tolist():
                shape = Polygon(tuple(map(tuple, prints[wheel].tolist())))
                on = float(area_quadrature(self._mesh, shape, _GAUSS).weights.sum())
                lost = 1.0 - on / (load.patch[0] * load.patch[1])
                if lost > _NOTHING:
                    yield load.case, name, wheel * len(load.axles) // len(wheels) + 1, lost


def _position(onto: Onto, wheels: list[Wheel], patch: tuple[float, float] | None) -> CaseLoad:
    mesh = onto.mesh
    if patch is None:
        positions = np.array([at for at, _, _ in wheels])
        where = mesh.locate(positions)
        forces = np.array([force for _, _, force in wheels])
        on, at = where.inside, positions[where.inside]
        onto.push(Quadrature(where.elements[on], where.xi[on], np.ones(len(at)), at), forces[on])
    else:
        for middle, direction, force in wheels:
            shape = Polygon(_print(middle, direction, patch))
            onto.spread(area_quadrature(mesh, shape, _GAUSS), Spread.even(shape, force / (patch[0] * patch[1])))
    return onto.load


def _print(
    at: tuple[float, float], direction: tuple[float, float], patch: tuple[float, float]
) -> tuple[tuple[float, float], ...]:
    """Corners of a wheel's print."""
    (x, y), (tx, ty), (length, width) = at, direction, patch
    corners = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
    return tuple((x + a * length * tx - b * width * ty, y + a * length * ty + b * width * tx) for a, b in corners)
