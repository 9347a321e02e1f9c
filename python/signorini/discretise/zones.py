"""Section (thickness and stiffness) at each position, as the plate or one of its zones prescribes it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple, Self

import numpy as np

from signorini.discretise.places import in_area
from signorini.discretise.quadrature import GAUSS
from signorini.discretise.quadrature.lines import Segment, arcs_of
from signorini.discretise.quadrature.stepped import sides_of
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.errors import Place, Problems
from signorini.expression import Expression
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import CENTROID
from signorini.model import Material, Model
from signorini.model.material import Modifiers, Stiffness
from signorini.shapes.outlines import Outline

_SLIVER = 0.01
"""Largest area between a zone's border and element sides that approximate it; with a larger area, elements are cut.

It is relative to the smaller of the areas of element and zone. A parabola over 45° of a circle has this error.
"""
_ROUNDING = 1e-6
"""Value in place of `_SLIVER` in elements with a narrow strip between zones, since the strip's area is no error."""
_NARROW = 0.05
"""Largest width of a strip between zones that counts as narrow, relative to the side of an element."""
_BESIDE = 1e-6
"""Distance from a border, relative to the plate's size, at which the section beside the border is evaluated."""


@dataclass(frozen=True, eq=False)
class Rigidity:
    """Rigidities of a plate of thickness h = 1.

    [mxx, myy, mxy] = h³ ``bending`` [κxx, κyy, 2κxy] with ``bending`` (3, 3), and [qx, qy] = h ``shear`` [γx, γy] with
    ``shear`` (2, 2).
    """

    bending: Floats
    shear: Floats

    @classmethod
    def isotropic(cls, E: float, nu: float, factor: float) -> Self:
        """Rigidity of an isotropic plate with Young's modulus E, Poisson's ratio nu and a shear correction factor."""
        d = E / (12 * (1 - nu**2))
        bending = d * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, 0.5 * (1 - nu)]])
        return cls(bending, factor * E / (2 * (1 + nu)) * np.eye(2))

    @classmethod
    def of_material(cls, material: Material, factor: float, modifiers: Modifiers) -> Self:
        """Rigidity of a material, with an orthotropic material's axes transformed to x and y."""
        if material.E is not None and material.nu is not None:
            return cls.isotropic(material.E, material.nu, factor).modified(modifiers)
        axes = material.axes
        stiffer = axes.Ey / axes.Ex
        d = axes.Ex / (12 * (1 - axes.nu_xy**2 * stiffer))
        coupled, twist = d * axes.nu_xy * stiffer, axes.Gxy / 12
        bending = np.array([[d, coupled, 0], [coupled, d * stiffer, 0], [0, 0, twist]])
        return cls(bending, factor * np.diag([axes.Gxz, axes.Gyz])).modified(modifiers).turned(axes.angle)

    @classmethod
    def of_section(cls, section: Stiffness, thickness: float, modifiers: Modifiers) -> Self:
        """Rigidity of a section given by its stiffness, divided by powers of the thickness and transformed to x and y.

        Examples
        --------
        >>> from signorini.model.material import Modifiers, Stiffness
        >>> ribbed = Stiffness(Dx=8.0, Dy=1.6, D1=0.8, Dxy=0.4, Sx=6.0, Sy=2.0, angle=90)
        >>> Rigidity.of_section(ribbed, 2.0, Modifiers()).for_core.round(12).tolist()
        [0.2, 0.1, 0.0, 1.0, 0.0, 0.05, 1.0, 0.0, 3.0]
        """
        bending = (
            np.array([[section.Dx, section.D1, 0], [section.D1, section.Dy, 0], [0, 0, section.Dxy]]) / thickness**3
        )
        return cls(bending, np.diag([section.Sx, section.Sy]) / thickness).modified(modifiers).turned(section.angle)

    def turned(self, degrees: float) -> Self:
        """Transform the rigidity to x and y from axes whose first is at an angle in ``degrees`` from x."""
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        turn = np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]])
        rotation = np.array([[c, s], [-s, c]])
        return type(self)(turn.T @ self.bending @ turn, rotation.T @ self.shear @ rotation)

    def modified(self, modifiers: Modifiers) -> Self:
        """Multiply the rigidity by the factors for bending, twist and shear."""
        bending = modifiers.bending * self.bending
        bending[2, 2] = modifiers.twist * self.bending[2, 2]
        return type(self)(bending, modifiers.shear * self.shear)

    @property
    def for_core(self) -> Floats:
        """The nine entries (9,) of the rigidity, as `_core.Plate` takes them."""
        return np.concatenate([self.bending[np.triu_indices(3)], self.shear[np.triu_indices(2)]])

    @property
    def in_waves(self) -> float:
        """Bending rigidity in waves sin(x) sin(y); equals D for an isotropic plate."""
        b = self.bending
        return float((b[0, 0] + 2 * (b[0, 1] + 2 * b[2, 2]) + b[1, 1]) / 4)

    @property
    def in_twist(self) -> float:
        """Rigidity in twist, averaged over all directions."""
        b = self.bending
        return float((b[0, 0] + b[1, 1] - 2 * b[0, 1] + 4 * b[2, 2]) / 8)

    @property
    def in_shear(self) -> float:
        """Rigidity in shear, averaged over all directions."""
        return float(self.shear.trace() / 2)


class SectionIndex(NamedTuple):
    """Which of plate (0) and zones (1, 2, ...) determines the section at each point (q,).

    ``thickness`` and ``material`` are the parts that give thickness and material; ``rigidity`` is an index into
    ``Zones.rigidities``. ``section`` equals ``material``, or 1 + number of zones + i where the stiffness of part i
    applies.
    """

    thickness: Ints
    material: Ints
    section: Ints
    rigidity: Ints


@dataclass(frozen=True, eq=False)
class Zones:
    """The zones of a model on a mesh.

    ``inside`` (z, ne) marks the elements of each zone; an element that the border cuts counts by its middle. ``parted``
    (z, ne) marks elements that the border cuts. ``rigidities`` (r,) are the distinct rigidities, that of the plate
    first; ``young`` (r,) is the largest Young's modulus of each. ``equivalent`` (r,) is the thickness of a solid plate
    of equal stiffness where a section is given by its stiffness, else NaN. ``number`` (2z + 2, z + 1) is the index of
    the rigidity, by section (see `SectionIndex`) and by the part that gives the modifiers.
    """

    model: Model
    inside: Bools
    parted: Bools
    rigidities: tuple[Rigidity, ...]
    young: Floats
    equivalent: Floats
    number: Ints

    @classmethod
    def anywhere(cls, model: Model) -> Self:
        """Zones of a model without a mesh; only `made_at` can be called."""
        nowhere = np.zeros((len(model.zone), 0), np.bool_)
        return cls(model, nowhere, nowhere, *_rigidities(model))

    @classmethod
    def of(cls, model: Model, mesh: Mesh, problems: Problems) -> Self:
        """Find the elements of every zone; zones off the plate are reported as problems."""
        count, area = len(mesh.elements), mesh.element_area
        inside, parted = np.zeros((2, len(model.zone), count), np.bool_)
        middles = mesh.map(np.arange(count), mesh.triangles[:, None] * CENTROID)
        result = cls(model, inside, parted, *_rigidities(model))
        points = []
        for index, zone in enumerate(model.zone):
            with problems.collected():
                points.append(in_area(mesh, model.plate, zone.region, ("zone", index), GAUSS))
        if len(points) < len(model.zone):
            return result
        sliver = np.where(result._in_strips(mesh), _ROUNDING, _SLIVER)
        for index, (zone, quadrature) in enumerate(zip(model.zone, points, strict=True)):
            part = np.bincount(quadrature.elements, quadrature.weights, count)
            least = sliver * np.minimum(area, zone.region.area)
            parted[index] = (part > least) & (part < area - least)
            inside[index] = np.where(parted[index], zone.region.contains(middles), part > least)
        return result

    @property
    def element(self) -> str:
        """Name of the plate's finite element."""
        return self.model.plate.element

    @property
    def formulas(self) -> tuple[Expression, ...]:
        """Thickness of the plate and of every zone; a zone without a thickness has that of the plate."""
        plate = self.model.plate.thickness
        return (plate, *(plate if zone.thickness is None else zone.thickness for zone in self.model.zone))

    @property
    def places(self) -> tuple[Place, ...]:
        """Paths of ``formulas`` in the input, in the same order."""
        return (("plate", "thickness"), *(("zone", index, "thickness") for index in range(len(self.model.zone))))

    @property
    def borders(self) -> list[Callable[[Floats], Floats]]:
        """Level functions (`signorini.discretise.quadrature.stepped`), zero on borders of zones that cut elements."""
        zones = zip(self.model.zone, self.parted, strict=True)
        return [side for zone, parted in zones if parted.any() for side in sides_of(zone.region)]

    @property
    def unit_weights(self) -> Floats:
        """Unit weight of the material of the plate and of each zone; NaN for materials without unit weight."""
        materials = [self.model.material, *(zone.material or self.model.material for zone in self.model.zone)]
        return np.array([np.nan if material.unit_weight is None else material.unit_weight for material in materials])

    def poisson_of(self, elements: Ints) -> Floats:
        """Poisson's ratio (q,) of each of the elements ``elements`` (q,)."""
        result = np.full(len(self.number), np.nan)
        for section, properties in _sections(self.model).items():
            result[section] = properties.poisson
        return result[self.of_elements.section[elements]]

    @property
    def without_extremes(self) -> Bools:
        """Mask (ne,) of elements in zones with ``extremes = false``."""
        return np.asarray(self.inside[[not zone.extremes for zone in self.model.zone]].any(axis=0))

    @property
    def of_elements(self) -> SectionIndex:
        """Section at the middle of each element (ne,)."""
        return self._made(self.inside)

    def at(self, elements: Ints, points: Floats) -> SectionIndex:
        """Section at points (q, 2), each in one of the elements (q,)."""
        inside = self.inside[:, elements]
        for index, zone in enumerate(self.model.zone):
            beside = self.parted[index, elements]
            inside[index, beside] = zone.region.contains(points[beside])
        return self._made(inside)

    def made_at(self, points: Floats) -> SectionIndex:
        """Section at points (q, 2), from the borders of zones, independent of the mesh."""
        inside = [zone.region.contains(points) for zone in self.model.zone]
        return self._made(np.array(inside, np.bool_).reshape(-1, len(points)))

    def thickness(self, section: SectionIndex, points: Floats) -> Floats:
        """Thickness (q,) at points (q, 2), to which the rigidities of ``section`` refer."""
        return self.acting(section.rigidity, self.nominal(section.thickness, points))

    def solid(self, elements: Ints, points: Floats) -> Floats:
        """Thickness (q,) at points (q, 2) in elements (q,); NaN where a section is given by its stiffness."""
        section = self.at(elements, points)
        is_solid = np.isnan(self.equivalent[section.rigidity])
        return np.where(is_solid, self.nominal(section.thickness, points), np.nan)

    def acting(self, rigidity: Ints, nominal: Floats) -> Floats:
        """Thickness (q,) to which rigidities refer: that of the equivalent solid plate, or else ``nominal``."""
        equivalent = self.equivalent[rigidity]
        return np.where(np.isnan(equivalent), nominal, equivalent)

    def nominal(self, formula_of: Ints, points: Floats) -> Floats:
        """Thickness (q,) of the input at points (q, 2); ``formula_of`` (q,) is the index of each point's formula."""
        result = np.empty(len(points))
        for number in np.unique(formula_of):
            with_formula = formula_of == number
            result[with_formula] = self.formulas[number](*points[with_formula].T, above=0.0, place=self.places[number])
        return result

    def _in_strips(self, mesh: Mesh) -> Bools:
        """Mask (ne,) of elements with a narrow strip along a border, in which the section differs from both sides."""
        result = np.zeros(len(mesh.elements), np.bool_)
        size = float(np.sqrt(mesh.element_area.max(initial=0.0)))
        near, wide = _BESIDE * mesh.size, _NARROW * size
        boxes = np.array([zone.region.bounds for zone in self.model.zone]).reshape(-1, 4)
        for index, zone in enumerate(self.model.zone):
            between = np.maximum(boxes[:, :2] - boxes[index, 2:], boxes[index, :2] - boxes[:, 2:])
            reached = (between <= 2.0 * wide).all(axis=1)
            points, normals = _along(zone.region.outline, 0.5 * float(np.sqrt(mesh.element_area.min(initial=size**2))))
            offsets = np.array([near, -near, wide, -wide])[:, None, None] * normals
            places = (points + offsets).reshape(-1, 2)
            where = np.zeros((len(boxes), len(places)), np.bool_)
            for other in np.flatnonzero(reached):
                where[other] = self.model.zone[other].region.contains(places)
            rigid = where[[zone.rigid for zone in self.model.zone]].any(axis=0)
            sections = np.array([*self._made(where), rigid]).reshape(5, 4, -1)
            for side in (0, 1):
                strip = (sections[:, side] != sections[:, 2]).any(axis=0) & (sections[:, side] != sections[:, 3]).any(
                    axis=0
                )
                elements = mesh.locate(points[strip] + offsets[side, strip]).elements
                result[elements[elements >= 0]] = True
        return result

    def _made(self, inside: Bools) -> SectionIndex:
        material, stiffness = self._last("material", inside), self._last("stiffness", inside)
        count = len(self.model.zone) + 1
        has_stiffness = np.array([part.stiffness is not None for part in (self.model.plate, *self.model.zone)])
        section = np.where(
            has_stiffness[stiffness] & (stiffness >= self._last("is_solid", inside)), count + stiffness, material
        )
        number = self.number[section, self._last("modifiers", inside)]
        return SectionIndex(self._last("thickness", inside), material, section, number)

    def _last(self, key: str, inside: Bools) -> Ints:
        """For each point (q,), the number of the last zone that contains the point and sets ``key``.

        Zones are numbered from 1; 0 is the plate.
        """
        result = np.zeros(inside.shape[1], np.int64)
        for index, zone in enumerate(self.model.zone):
            if getattr(zone, key) not in (None, False):
                result[inside[index]] = index + 1
        return result


@dataclass(frozen=True, eq=False)
class ZonesOfPlates(Zones):
    """Sections of the elements of several plates, plate by plate."""

    plates: tuple[Zones, ...] = ()

    @classmethod
    def join(cls, model: Model, plates: Sequence[Zones]) -> Self:
        """Join the zones of several plates, with their rigidities one after another."""
        nowhere = np.zeros((0, 0), np.bool_)
        young, equivalent = (
            np.concatenate([getattr(zones, name) for zones in plates]) for name in ("young", "equivalent")
        )
        rigidities = tuple(rigidity for zones in plates for rigidity in zones.rigidities)
        return cls(model, nowhere, nowhere, rigidities, young, equivalent, np.zeros((0, 0), np.int64), tuple(plates))

    @property
    def element(self) -> str:
        """Name of the finite element of all plates."""
        return self.plates[0].element

    @property
    def of_elements(self) -> SectionIndex:
        """Sections of the elements of all plates.

        Numbers of sections start anew in each plate, numbers of rigidities run through all plates.
        """
        first = np.cumsum([0, *(len(sections.rigidities) for sections in self.plates)])
        each = [sections.of_elements for sections in self.plates]
        each = [
            sections._replace(rigidity=sections.rigidity + start) for sections, start in zip(each, first, strict=False)
        ]
        return SectionIndex(*map(np.concatenate, zip(*each, strict=True)))


def _along(outline: Outline, step: float) -> tuple[Floats, Floats]:
    """Points (q, 2) along an outline, at most ``step`` apart, and unit normals (q, 2) of the outline there."""
    points, tangents = [np.zeros((0, 2))], [np.zeros((0, 2))]
    for arc in arcs_of(outline):
        count = math.ceil(arc.length / step) + (0 if isinstance(arc, Segment) else 8)
        for values, computed in zip(
            (points, tangents), arc.at(arc.length * (np.arange(count) + 0.5) / count), strict=True
        ):
            values.append(computed)
    along = np.concatenate(tangents)
    return np.concatenate(points), np.column_stack([along[:, 1], -along[:, 0]])


def _sections(model: Model) -> dict[int, Material | Stiffness]:
    """Material or stiffness of each section by number (`SectionIndex`); materials without moduli have no section."""
    parts = list(enumerate((model.plate, *model.zone)))
    materials = ((0, model.material), *((i, zone.material) for i, zone in enumerate(model.zone, 1)))
    result: dict[int, Material | Stiffness] = {}
    result |= {i: material for i, material in materials if material is not None and material.is_elastic}
    result |= {len(parts) + i: part.stiffness for i, part in parts if part.stiffness is not None}
    return result


def _rigidities(model: Model) -> tuple[tuple[Rigidity, ...], Floats, Floats, Ints]:
    """Return ``rigidities``, ``young``, ``equivalent`` and ``number`` of `Zones`."""
    parts = (model.plate, *model.zone)
    modifiers = {i: part.modifiers for i, part in enumerate(parts) if part.modifiers is not None}
    indices: dict[bytes, int] = {}
    rows: list[tuple[Rigidity, float, float]] = []
    number = np.zeros((2 * len(parts), len(parts)), np.int64)
    for (i, properties), (j, factors) in product(_sections(model).items(), modifiers.items()):
        if isinstance(properties, Material):
            rigidity, young = Rigidity.of_material(properties, model.plate.shear_factor, factors), properties.young
            thickness = np.nan
        else:
            thickness, young = properties.equivalent
            rigidity = Rigidity.of_section(properties, thickness, factors)
        key = np.append(rigidity.for_core, (young, thickness)).tobytes()
        if key not in indices:
            indices[key] = len(rows)
            rows.append((rigidity, young, thickness))
        number[i, j] = indices[key]
    rigidities, youngs, equivalent = zip(*rows, strict=True)
    return rigidities, np.array(youngs), np.array(equivalent), number
