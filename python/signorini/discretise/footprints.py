"""The footprints of points, on which forces are spread evenly and couples linearly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np

from signorini.discretise.places import edge_sides, located
from signorini.discretise.quadrature import Quadrature, area_quadrature, off_plate
from signorini.discretise.rows import Floats, Further, Rows
from signorini.errors import InputError, Place, point
from signorini.mesh import Mesh
from signorini.model import Load, Support
from signorini.model.places import footprints
from signorini.shapes import Circle, Polygon, Rectangle

_GAUSS = 3
_LEAST = 1e-9
"""Size of a footprint, over the plate's, below which its coordinates have not the digits to tell it from a point."""
_PARALLEL = 1e-9
"""Sine of the angle up to which directions are one."""


class Footprints:
    """Footprints on a mesh.

    One that an edge of symmetry cuts through its middle counts as far as it is on the plate: there the plate stands for
    two or four of them.

    Parameters
    ----------
    mesh : Mesh
    supports : sequence of Support
        All of the model's, for the edges of symmetry.
    """

    def __init__(self, mesh: Mesh, supports: Sequence[Support]) -> None:
        self._mesh = mesh
        self._supports = supports

    def of(self, item: Support | Load, place: Place) -> list[Quadrature]:
        """Quadrature over the footprint of every point; none where points are points.

        Raises
        ------
        InputError
            If a point, or part of a footprint, is not on the plate, or there is next to nothing of it.
        """
        shapes = footprints(item)
        if not shapes or item.at is None:
            return []
        across = 2.0 * item.radius if item.radius is not None else min(item.patch or ())
        if across < _LEAST * self._mesh.size:
            key = "patch" if item.radius is None else "radius"
            raise InputError(
                f"The footprint is {across:g} across, less than a billionth of the plate's size. Leave {key} out for a "
                "point, or give a larger one.",
                place=(*place, key),
            )
        result: list[Quadrature] = []
        problems: list[InputError] = []
        try:
            located(self._mesh, item.at, (*place, "at"))
        except InputError as error:
            problems.append(error)
        inside = self._mesh.locate(np.array(item.at)).inside
        for index, (at, shape) in enumerate(zip(item.at, shapes, strict=True)):
            if not inside[index]:
                continue
            points = area_quadrature(self._mesh, shape, _GAUSS)
            whole = self._on_plate(at, shape)
            missing = off_plate(self._mesh, shape, points, whole)
            if missing > 0:
                problems.append(
                    InputError(
                        f"The footprint of the point {point(at, self._mesh.size)} has "
                        f"{100 * missing / shape.area:.3g} % of its area off the plate. Move the point or make the "
                        "footprint smaller; only an edge of symmetry may cut it, through its middle.",
                        place=(*place, "at", index) if len(item.at) > 1 else (*place, "at"),
                    )
                )
            result.append(points)
        if problems:
            raise InputError.of(problems)
        return result

    def _on_plate(self, at: tuple[float, float], shape: Rectangle | Circle | Polygon) -> float:
        """Part of a footprint that has to be on the plate: all, unless edges of symmetry cut it through its middle."""
        near = self._axes[0], self._axes[1] - self._axes[0]
        length = np.hypot(*near[1].T)
        normals = np.column_stack([-near[1][:, 1], near[1][:, 0]]) / length[:, None]
        off, along = np.abs(((at - near[0]) * normals).sum(axis=1)), ((at - near[0]) * near[1]).sum(axis=1) / length
        slack = self._mesh.near.place
        through = np.unique(normals[(off <= slack) & (along >= -slack) & (along <= length + slack)].round(9), axis=0)
        if not isinstance(shape, Circle):
            side = shape.corners[1] - shape.corners[0]
            sines = np.stack([through @ side, through @ [-side[1], side[0]]]) / np.hypot(*side)
            if (np.abs(sines) > _PARALLEL).all(axis=0).any():
                return 1.0
        if len(through) == 2:
            return math.acos(float(np.clip(-through[0] @ through[1], -1.0, 1.0))) / (2 * math.pi)
        return 0.5 if len(through) == 1 else 1.0

    @cached_property
    def _axes(self) -> tuple[Floats, Floats]:
        """Ends (k, 2) of the sides of elements along edges of symmetry, the plate on their left."""
        triples = [np.zeros((0, 3), np.int64)]
        for index, support in enumerate(self._supports):
            if support.edge is not None and "slope" in support.fixed and "w" not in support.fixed:
                triples.append(edge_sides(self._mesh, support.edge, ("support", index)))
        ends = self._mesh.points[np.concatenate(triples)[:, [0, 2]]]
        return ends[:, 0], ends[:, 1]


def mean_deflections(mesh: Mesh, footprints: Sequence[Quadrature]) -> Rows:
    """Rows of the mean deflection over each footprint, which spread a force evenly over it."""
    elements, values, owners = [], [], []
    for number, over in enumerate(footprints):
        own, inverse = np.unique(over.elements, return_inverse=True)
        shape = np.zeros((len(own), 8))
        np.add.at(shape, inverse, (over.weights / over.total)[:, None] * mesh.shape_functions(over.elements, over.xi))
        # A node of several elements has all of it in the first one, so that no dof stands twice.
        _, first, node = np.unique(mesh.elements[own], return_index=True, return_inverse=True)
        gathered = np.zeros(shape.size)
        gathered[first] = np.bincount(node.ravel(), shape.ravel())
        elements.append(own)
        values.append(gathered.reshape(shape.shape))
        owners.append(np.full(len(own), number))
    element, value, owner = (np.concatenate(parts) for parts in (elements, values, owners))
    coefficients = np.zeros((len(element), 24))
    coefficients[:, ::3] = value
    leads = np.diff(owner, prepend=-1) > 0
    further = Further(owner[~leads], element[~leads], coefficients[~leads])
    return Rows(element[leads], coefficients[leads], further)
