"""Thickness of the plate at the elements' section points, and rigidities of elements in which the thickness jumps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from signorini import _core
from signorini.discretise.quadrature import Quadrature
from signorini.discretise.quadrature.stepped import Cut, among, crossed, cut_by, sides_of
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.zones import Rigidity, Zones
from signorini.errors import InputError, point
from signorini.mesh import Mesh

_RANGE = (1e-6, 1.0)
"""Least and largest thickness relative to the plate's size (docs/domain.md)."""

_ORDER = 4
"""Number of Gauss points in each direction on parts of a cut element: h³ of a linear thickness is integrated
exactly."""

_BESIDE = 2e-3
"""Distance from a step of the thickness at which its two sides are evaluated, in reference coordinates."""

_SHORT = 1e-3
"""Least length of a piece of a thickness step, relative to the element; shorter pieces have no accurate direction."""

_SOFTEST = 1e-9
"""Least rigidity across a step of the thickness, relative to the rigidity along the step.

Smaller values are lost in rounding if the step is oblique.
"""

_SAME = 1e-9
"""Smallest jump of the thickness that counts as a step, relative to the thickness.

Branches of a formula may meet within rounding.
"""


@dataclass(frozen=True, eq=False)
class Thickness:
    """Thickness h (e, p) at the section points of every element, or (1, 1) where it is constant.

    ``at_points`` is the thickness of an equivalent solid plate where the section is given by its stiffness. ``nominal``
    (e, p) or (e, 1) is the thickness of the input. ``layered`` are the elements (k,) in which the thickness jumps, and
    their rigidities (k, p, 9) as `_core.Plate` takes them.
    """

    at_points: Floats
    nominal: Floats
    layered: tuple[Ints, Floats] | None = None

    def max(self) -> float:
        """Return the largest thickness on the plate."""
        return float(self.at_points.max())

    def min(self) -> float:
        """Return the least thickness on the plate."""
        return float(self.at_points.min())

    def least_at(self, mesh: Mesh, points: Floats) -> float:
        """Return the least thickness of all elements that contain points (q, 2)."""
        if self.at_points.size == 1 or not len(points):
            return self.min()
        _, where = mesh.holding(points)
        return float(self.at_points[where.elements].min(initial=self.max()))

    @property
    def for_core(self) -> float | Floats:
        """The thickness as `_core.Plate` takes it: a number if it is constant, else an array."""
        return float(self.at_points[0, 0]) if self.at_points.size == 1 else self.at_points


@dataclass(frozen=True, eq=False)
class PlateStiffness:
    """Stiffness of the plate in each element (ne,).

    ``in_waves`` is the ratio of pressure to deflection in a wave two elements long. ``in_shear`` is the shear rigidity,
    force per length.
    """

    in_waves: Floats
    in_shear: Floats

    @classmethod
    def of(cls, mesh: Mesh, zones: Zones, thickness: Floats) -> Self:
        """Compute the stiffness from the thickness (ne, p) at section points, or (1, 1) if it is constant."""
        h = np.broadcast_to(thickness.mean(axis=1), len(mesh.elements))
        number = zones.of_elements.rigidity
        unit = np.array([[rigidity.in_waves, rigidity.in_shear] for rigidity in zones.rigidities])[number]
        bending, shear = unit[:, 0] * h**3, unit[:, 1] * h
        # In the wave w = sin(πx/a) sin(πy/a), a² is the area of the element.
        wave = 2.0 * np.pi**2 / mesh.element_area
        return cls(1.0 / (1.0 / (bending * wave**2) + 1.0 / (shear * wave)), shear)


def thickness_of(mesh: Mesh, zones: Zones) -> Thickness:
    """Evaluate the thickness at all section points; refuse values outside the domain of validity."""
    formulas, kind = zones.formulas, zones.model.plate.element
    cut_by_zones = zones.parted.any(axis=0)
    if not cut_by_zones.any() and all(formula.is_constant for formula in formulas):
        by_formula = np.array([formula.value for formula in formulas])
        section = zones.of_elements
        nominal = by_formula[section.thickness]
        _require_plate(zones, mesh, nominal, section.thickness, mesh.points[mesh.elements[:, 0]])
        value = zones.acting(section.rigidity, nominal)
        if (value == value[0]).all():
            return Thickness(value[:1, None], nominal[:, None])
    xi = np.where(mesh.triangles[:, None, None], _core.section_points(kind, True), _core.section_points(kind))
    points = np.empty_like(xi)
    for shapes, mask in ((_core.serendipity, ~mesh.triangles), (_core.triangular, mesh.triangles)):
        if mask.any():
            points[mask] = shapes(xi[mask][0])[0] @ mesh.nodes[mask]
    all_elements = np.arange(len(mesh.elements))
    result = _evaluated(zones, mesh, np.repeat(all_elements, points.shape[1]), points.reshape(-1, 2))
    at_points, nominal = (values.reshape(points.shape[:2]) for values in result[::2])
    levels, across = _crossing(zones, mesh)
    elements = np.flatnonzero(across.any(axis=0) | cut_by_zones)
    if not len(elements):
        return Thickness(at_points, nominal)
    cut = cut_by(mesh, elements, among(levels, across), _ORDER, quarter=True)
    inside = _evaluated(zones, mesh, cut.points.elements, cut.points.positions)[:2]
    fronts = _jumps(zones, mesh, cut)
    jumping = np.unique(fronts.elements)
    sections = _sections(zones.rigidities, mesh, xi[jumping], jumping, cut, inside, fronts)
    return Thickness(at_points, nominal, (jumping, sections))


def _crossing(zones: Zones, mesh: Mesh) -> tuple[list[Callable[[Floats], Floats]], Bools]:
    """Level functions, zero where the thickness jumps or a zone ends; mask (levels, ne) of the elements they cross."""
    parted, of_elements = zones.parted.any(axis=0), zones.of_elements.thickness
    sought: list[tuple[Sequence[Callable[[Floats], Floats]], Bools]] = []
    for formula in dict.fromkeys(zones.formulas):
        with_formula = np.array([candidate is formula for candidate in zones.formulas])[of_elements] | parted
        sought.append(([level for level in formula.levels if level.jumps], with_formula))
    for zone, mask in zip(zones.model.zone, zones.parted, strict=True):
        sought.append((sides_of(zone.region), mask))
    across = []
    for curves, mask in sought:
        across.append(np.zeros((len(curves), len(mask)), np.bool_))
        across[-1][:, mask] = crossed(mesh, np.flatnonzero(mask), curves)
    return [level for curves, _ in sought for level in curves], np.concatenate(across)


def _evaluated(zones: Zones, mesh: Mesh, elements: Ints, points: Floats) -> tuple[Floats, Ints, Floats]:
    """Thickness (q,), index (q,) of the rigidity, and nominal thickness (q,) at points (q, 2) of elements (q,)."""
    section = zones.at(elements, points)
    nominal = zones.nominal(section.thickness, points)
    _require_plate(zones, mesh, nominal, section.thickness, points)
    return zones.acting(section.rigidity, nominal), section.rigidity, nominal


def _require_plate(zones: Zones, mesh: Mesh, thickness: Floats, formula_of: Ints, points: Floats) -> None:
    thinnest, thickest = _RANGE[0] * mesh.size, _RANGE[1] * mesh.size
    # The limits have a tolerance: far from the origin, the plate's size is rounded.
    wrong = (thickness < (1.0 - _SAME) * thinnest) | (thickness > (1.0 + _SAME) * thickest)
    if wrong.any():
        first = int(np.argmax(wrong))
        where = point(points[first], mesh.size)
        raise InputError(
            f"Found the thickness {thickness[first]:g} at {where}; on a plate {mesh.size:g} long it "
            f"must be from {thinnest:g} to {thickest:g}. Are the units those of the plate's size?",
            place=zones.places[formula_of[first]],
        )


@dataclass(frozen=True, eq=False)
class _Fronts:
    """Pieces (f,) of steps of the thickness: element, unit normal (f, 2), and weight.

    The weight is the length times the jump of the bending rigidity.
    """

    elements: Ints
    normals: Floats
    weights: Floats


def _jumps(zones: Zones, mesh: Mesh, cut: Cut) -> _Fronts:
    size = np.sqrt(mesh.element_area[cut.front_elements])
    ends = mesh.map(np.repeat(cut.front_elements, 2), cut.fronts.reshape(-1, 2)).reshape(-1, 2, 2)
    along = ends[:, 1] - ends[:, 0]
    length = np.hypot(*along.T)
    long = length > _SHORT * size
    elements, fronts, along, length = (part[long] for part in (cut.front_elements, cut.fronts, along, length))
    normals = np.column_stack([along[:, 1], -along[:, 0]]) / length[:, None]
    direction = fronts[:, 1] - fronts[:, 0]
    beside = _BESIDE * np.column_stack([direction[:, 1], -direction[:, 0]]) / np.hypot(*direction.T)[:, None]
    (thickness_before, rigidity_before), (thickness_after, rigidity_after) = (
        _evaluated(zones, mesh, elements, mesh.map(elements, np.clip(fronts.mean(axis=1) + side * beside, -1, 1)))[:2]
        for side in (-1.0, 1.0)
    )
    real = (np.abs(thickness_before - thickness_after) > _SAME * np.maximum(thickness_before, thickness_after)) | (
        rigidity_before != rigidity_after
    )
    bending = np.array([rigidity.in_waves for rigidity in zones.rigidities])
    sides = bending[rigidity_before] * thickness_before**3, bending[rigidity_after] * thickness_after**3
    # Weights must be positive even without a jump of the bending rigidity, since they are divided by their sum.
    step = np.maximum(np.abs(sides[0] - sides[1]), _SAME * np.maximum(*sides))
    return _Fronts(elements[real], normals[real], (step * length)[real])


def _sections(
    rigidities: Sequence[Rigidity],
    mesh: Mesh,
    xi: Floats,
    elements: Ints,
    cut: Cut,
    inside: tuple[Floats, Ints],
    fronts: _Fronts,
) -> Floats:
    """Rigidities (k, p, 9) of k elements as laminates of strips along the step (docs/theory.md, section 4).

    Each section point takes means over the quarters of the element that contain the point; in a triangle, over the
    element.
    """
    n = fronts.normals
    bent = np.column_stack([n**2, 2.0 * n.prod(axis=1)])
    place = np.searchsorted(elements, fronts.elements)
    weights = fronts.weights / np.bincount(place, fronts.weights, len(elements))[place]
    used, number = np.unique(inside[1], return_inverse=True)
    means = _quarter_means(mesh, xi, elements, cut.points, inside[0], number)
    materials = [rigidities[i] for i in used]
    b = _laminate(means, 3, np.array([rigidity.bending for rigidity in materials]), bent, place, weights)
    s = _laminate(means, 1, np.array([rigidity.shear for rigidity in materials]), n, place, weights)
    (i, j), (k, m) = np.triu_indices(3), np.triu_indices(2)
    return np.concatenate([b[..., i, j], s[..., k, m]], axis=-1)


def _quarter_means(
    mesh: Mesh, xi: Floats, elements: Ints, cut: Quadrature, thickness: Floats, number: Ints
) -> Callable[[int], Floats]:
    """Return the function that maps an exponent n to means of hⁿ at section points ``xi`` (k, p, 2) of elements (k,).

    Means are over the element's quarters around each point. The result has one part per material, (materials, k, p);
    the sum over materials is the mean.
    """
    in_elements = np.isin(cut.elements, elements)
    quarter = (cut.xi[in_elements] > 0.0) @ np.array([1, 2])
    count, kinds = 4 * len(elements), int(number.max()) + 1
    place = count * number[in_elements] + 4 * np.searchsorted(elements, cut.elements[in_elements]) + quarter
    weights, thickness = cut.weights[in_elements], thickness[in_elements]
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])
    around = (xi[:, :, None] * signs > -_SHORT).all(axis=3) | mesh.triangles[elements, None, None]

    def sums(power: int) -> Floats:
        by_quarter = np.bincount(place, weights * thickness**power, kinds * count).reshape(kinds, -1, 4)
        return np.asarray(np.einsum("mkq,kpq->mkp", by_quarter, around))

    area = sums(0).sum(axis=0)
    return lambda power: sums(power) / area


def _laminate(
    means: Callable[[int], Floats], power: int, plates: Floats, strains: Floats, place: Ints, weights: Floats
) -> Floats:
    """Rigidities (k, p, d, d) of a laminate: the mean along the step, the harmonic mean across it.

    ``means`` maps an exponent n to the means (m, k, p) of hⁿ by material. ``plates`` (m, d, d) are rigidities of the
    materials at h = 1, to be multiplied by h to ``power``. ``strains`` (f, d) are strains across each front, ``place``
    (f,) the index of its element. ``weights`` (f,) sum to 1 over the fronts of an element.
    """
    along, part, inverse = means(power), means(0), means(-power)
    mean = np.einsum("mkp,mij->kpij", along, plates)
    forces = np.einsum("fi,mij->mfj", strains, plates)
    across = np.einsum("mfj,fj->mf", forces, strains)
    vectors = forces / np.sqrt(across)[..., None]
    for number in range(mean.shape[1]):
        thick, share, thin = along[:, place, number], part[:, place, number], inverse[:, place, number]
        soft = np.maximum(1.0 / (thin / across).sum(axis=0), _SOFTEST * (thick * across).sum(axis=0))
        common = np.einsum("mf,mfi->fi", share / across, forces)
        drop = np.einsum("mf,mfi,mfj->fij", thick, vectors, vectors) - np.einsum("f,fi,fj->fij", soft, common, common)
        np.subtract.at(mean[:, number], place, weights[:, None, None] * drop)
    return np.asarray(mean)
