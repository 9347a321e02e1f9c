"""The plate's thickness where its elements ask for it, and their sections where it jumps inside them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from signorini import _core
from signorini.discretise.quadrature.stepped import Cut, crossed, cut_by
from signorini.discretise.rigidity import Rigidity
from signorini.discretise.rows import Floats, Ints
from signorini.errors import InputError, point
from signorini.mesh import Mesh
from signorini.model import Model

_RANGE = (1e-6, 10.0)
"""Thickness over the plate's size: beyond, double precision holds no plate, or the plate is a block."""

_ORDER = 4
"""Gauss points a direction of the parts of an element that a step cuts: h³ of a linear thickness is exact."""

_BESIDE = 2e-3
"""How far beside a step its two thicknesses are looked up, in reference coordinates: well off any curve's chord."""

_SHORT = 1e-3
"""Length of a piece of a step, over the element's size, below which it tells no direction."""

_SOFTEST = 1e-9
"""Least rigidity across a step over that along it: less would be lost in rounding where the step runs askew."""

_SAME = 1e-9
"""Part of the thickness below which it does not jump, as of a formula that is continuous where its branches meet."""


@dataclass(frozen=True, eq=False)
class Thickness:
    """Thickness (e, p) at every element's section points, or one number (1, 1) where it is constant.

    ``layered`` are the elements (k,) inside which it jumps, and their rigidities (k, p, 9) as `_core.Plate` takes them.
    """

    at_points: Floats
    layered: tuple[Ints, Floats] | None = None

    def max(self) -> float:
        """Return the largest."""
        return float(self.at_points.max())

    def min(self) -> float:
        """Return the least."""
        return float(self.at_points.min())

    @property
    def for_core(self) -> float | Floats:
        """The thickness as `_core.Plate` takes it."""
        return float(self.at_points[0, 0]) if self.at_points.size == 1 else self.at_points


def thickness_of(model: Model, mesh: Mesh, rigidity: Rigidity) -> Thickness:
    """Evaluate the thickness.

    Raises
    ------
    InputError
        If it is not that of a plate somewhere; the message names the place.
    """
    formula, kind = model.plate.thickness, model.plate.element
    if formula.is_constant:
        value = np.array([[formula.value]])
        _require_plate(mesh, value.ravel(), mesh.points[:1])
        return Thickness(value)
    xi = np.where(mesh.triangles[:, None, None], _core.section_points(kind, True), _core.section_points(kind))
    points = np.empty_like(xi)
    for shapes, some in ((_core.serendipity, ~mesh.triangles), (_core.triangular, mesh.triangles)):
        if some.any():
            points[some] = shapes(xi[some][0])[0] @ mesh.nodes[some]
    at_points = _evaluated(model, mesh, points.reshape(-1, 2)).reshape(points.shape[:2])
    levels = [level for level in formula.levels if level.jumps]
    across = crossed(mesh, np.arange(len(mesh.elements)), levels)
    elements = np.flatnonzero(across.any(axis=0))
    if not len(elements):
        return Thickness(at_points)
    levels = [level for level, by_element in zip(levels, across, strict=True) if by_element.any()]
    cut = cut_by(mesh, elements, levels, _ORDER, quarter=True)
    inside = _evaluated(model, mesh, cut.positions)
    fronts = _jumps(model, mesh, cut)
    jumping = np.unique(fronts.elements)
    return Thickness(at_points, (jumping, _sections(rigidity, mesh, xi[jumping], jumping, cut, inside, fronts)))


def _evaluated(model: Model, mesh: Mesh, points: Floats) -> Floats:
    thickness = model.plate.thickness(*points.T, above=0.0, place=("plate", "thickness"))
    _require_plate(mesh, thickness, points)
    return thickness


def _require_plate(mesh: Mesh, thickness: Floats, points: Floats) -> None:
    thinnest, thickest = _RANGE[0] * mesh.size, _RANGE[1] * mesh.size
    wrong = (thickness < thinnest) | (thickness > thickest)
    if wrong.any():
        at = point(points[np.argmax(wrong)], mesh.size)
        raise InputError(
            f"Found the thickness {thickness[np.argmax(wrong)]:g} at {at}; on a plate {mesh.size:g} long it "
            f"must be from {thinnest:g} to {thickest:g}. Are the units those of the plate's size?",
            place=("plate", "thickness"),
        )


@dataclass(frozen=True, eq=False)
class _Fronts:
    """Pieces (f,) of the steps at which the thickness jumps: normals (f, 2), and length times jump, for a weight."""

    elements: Ints
    normals: Floats
    weights: Floats


def _jumps(model: Model, mesh: Mesh, cut: Cut) -> _Fronts:
    size = np.sqrt(mesh.element_area[cut.front_elements])
    ends = mesh.map(np.repeat(cut.front_elements, 2), cut.fronts.reshape(-1, 2)).reshape(-1, 2, 2)
    along = ends[:, 1] - ends[:, 0]
    length = np.hypot(*along.T)
    long = length > _SHORT * size
    elements, fronts, along, length = (part[long] for part in (cut.front_elements, cut.fronts, along, length))
    normals = np.column_stack([along[:, 1], -along[:, 0]]) / length[:, None]
    ahead = fronts[:, 1] - fronts[:, 0]
    beside = _BESIDE * np.column_stack([ahead[:, 1], -ahead[:, 0]]) / np.hypot(*ahead.T)[:, None]
    one, other = (
        _evaluated(model, mesh, mesh.map(elements, np.clip(fronts.mean(axis=1) + side * beside, -1.0, 1.0)))
        for side in (-1.0, 1.0)
    )
    step = np.abs(one - other)
    real = step > _SAME * np.maximum(one, other)
    return _Fronts(elements[real], normals[real], (step * length)[real])


def _sections(
    rigidity: Rigidity, mesh: Mesh, xi: Floats, elements: Ints, cut: Cut, thickness: Floats, fronts: _Fronts
) -> Floats:
    """Rigidities (k, p, 9) of elements as laminates of strips along the step (docs/theory.md, section 4).

    Each point has the means over the quarters of the element that it lies in or between, of triangles over the whole.
    """
    n = fronts.normals
    bent = np.column_stack([n**2, 2.0 * n.prod(axis=1)])
    means = _quarter_means(mesh, xi, elements, cut, thickness)
    b = _laminate(means(3), means(-3), rigidity.bending, _mean_square(elements, fronts, rigidity.bending, bent))
    s = _laminate(means(1), means(-1), rigidity.shear, _mean_square(elements, fronts, rigidity.shear, n))
    (i, j), (k, m) = np.triu_indices(3), np.triu_indices(2)
    return np.concatenate([b[..., i, j], s[..., k, m]], axis=-1)


def _quarter_means(mesh: Mesh, xi: Floats, elements: Ints, cut: Cut, thickness: Floats) -> Callable[[int], Floats]:
    """Mean of a power of the thickness over the quarters around each point (k, p, 2) of the elements: (k, p)."""
    mine = np.isin(cut.elements, elements)
    quarter = (cut.xi[mine] > 0.0) @ np.array([1, 2])
    place = 4 * np.searchsorted(elements, cut.elements[mine]) + quarter
    weights, thickness = cut.weights[mine], thickness[mine]
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])
    around = (xi[:, :, None] * signs > -_SHORT).all(axis=3) | mesh.triangles[elements, None, None]

    def sums(power: int) -> Floats:
        by_quarter = np.bincount(place, weights * thickness**power, 4 * len(elements)).reshape(-1, 4)
        return np.asarray(np.einsum("kq,kpq->kp", by_quarter, around))

    area = sums(0)
    return lambda power: sums(power) / area


def _mean_square(elements: Ints, fronts: _Fronts, plate: Floats, strains: Floats) -> Floats:
    """Mean (k, d, d), over the fronts of each element, of what the plate (d, d) resists strains (f, d) across with."""
    forces = strains @ plate
    vectors = forces / np.sqrt((forces * strains).sum(axis=1))[:, None]
    place = np.searchsorted(elements, fronts.elements)
    total = np.zeros((len(elements), vectors.shape[1], vectors.shape[1]))
    np.add.at(total, place, np.einsum("f,fi,fj->fij", fronts.weights, vectors, vectors))
    return np.asarray(total / np.bincount(place, fronts.weights, len(elements))[:, None, None])


def _laminate(along: Floats, inverse: Floats, plate: Floats, across: Floats) -> Floats:
    """Rigidities (k, p, d, d): the mean along the step; across it, the inverse of the mean of inverses."""
    drop = along - np.maximum(1.0 / inverse, _SOFTEST * along)
    return np.asarray(along[..., None, None] * plate - drop[..., None, None] * across[:, None])
