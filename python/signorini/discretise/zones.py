"""Section of the plate at each place: its own thickness and stiffness, or those of zones."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple, Self

import numpy as np

from signorini.discretise.places import in_area
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
"""Largest distance of a border from the sides that follow it, relative to the element or to a smaller zone: the error
of a parabola over 45° of a circle."""
_ROUNDING = 1e-6
"""The same of elements with a narrow strip between zones, which is more than a border that is a little off."""
_NARROW = 0.05
"""Width of a strip, over the side of an element, that may be less than a sliver of it; of a flat element too."""
_BESIDE = 1e-6
"""Distance from a border, relative to the plate's size, at which the section beside it is read."""


@dataclass(frozen=True, eq=False)
class Rigidity:
    """Rigidities of a plate of thickness 1.

    ``bending`` (3, 3) makes [mxx, myy, mxy] of [κxx, κyy, 2κxy] and goes with the thickness cubed; ``shear`` (2, 2)
    makes [qx, qy] of [γx, γy] and goes with the thickness.
    """

    bending: Floats
    shear: Floats

    @classmethod
    def isotropic(cls, E: float, nu: float, factor: float) -> Self:
        """Take Young's modulus, Poisson's ratio and the shear correction factor."""
        d = E / (12 * (1 - nu**2))
        bending = d * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, 0.5 * (1 - nu)]])
        return cls(bending, factor * E / (2 * (1 + nu)) * np.eye(2))

    @classmethod
    def made_of(cls, material: Material, factor: float, modifiers: Modifiers) -> Self:
        """Take a material's, those of an orthotropic one turned from its axes to x and y."""
        if material.E is not None and material.nu is not None:
            return cls.isotropic(material.E, material.nu, factor).modified(modifiers)
        axes = material.axes
        stiffer = axes.Ey / axes.Ex
        d = axes.Ex / (12 * (1 - axes.nu_xy**2 * stiffer))
        coupled, twist = d * axes.nu_xy * stiffer, axes.Gxy / 12
        bending = np.array([[d, coupled, 0], [coupled, d * stiffer, 0], [0, 0, twist]])
        return cls(bending, factor * np.diag([axes.Gxz, axes.Gyz])).modified(modifiers).turned(axes.angle)

    @classmethod
    def given(cls, by: Stiffness, thickness: float, modifiers: Modifiers) -> Self:
        """Take those of a section that has a thickness, turned from its axes to x and y.

        Examples
        --------
        >>> from signorini.model.material import Modifiers, Stiffness
        >>> ribbed = Stiffness(Dx=8.0, Dy=1.6, D1=0.8, Dxy=0.4, Sx=6.0, Sy=2.0, angle=90)
        >>> Rigidity.given(ribbed, 2.0, Modifiers()).for_core.round(12).tolist()
        [0.2, 0.1, 0.0, 1.0, 0.0, 0.05, 1.0, 0.0, 3.0]
        """
        bending = np.array([[by.Dx, by.D1, 0], [by.D1, by.Dy, 0], [0, 0, by.Dxy]]) / thickness**3
        return cls(bending, np.diag([by.Sx, by.Sy]) / thickness).modified(modifiers).turned(by.angle)

    def turned(self, degrees: float) -> Self:
        """Transform from local axes, the first at so many degrees from x, to x and y."""
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        turn = np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]])
        ahead = np.array([[c, s], [-s, c]])
        return type(self)(turn.T @ self.bending @ turn, ahead.T @ self.shear @ ahead)

    def modified(self, by: Modifiers) -> Self:
        """Multiply by the plate's factors of bending, twist and shear."""
        bending = by.bending * self.bending
        bending[2, 2] = by.twist * self.bending[2, 2]
        return type(self)(bending, by.shear * self.shear)

    @property
    def for_core(self) -> Floats:
        """The rigidities (9,) as `_core.Plate` takes them."""
        return np.concatenate([self.bending[np.triu_indices(3)], self.shear[np.triu_indices(2)]])

    @property
    def in_waves(self) -> float:
        """Rigidity in bending against waves sin(x) sin(y); D of an isotropic plate."""
        b = self.bending
        return float((b[0, 0] + 2 * (b[0, 1] + 2 * b[2, 2]) + b[1, 1]) / 4)

    @property
    def in_twist(self) -> float:
        """Mean rigidity in twist of all directions."""
        b = self.bending
        return float((b[0, 0] + b[1, 1] - 2 * b[0, 1] + 4 * b[2, 2]) / 8)

    @property
    def in_shear(self) -> float:
        """Mean rigidity in shear of all directions."""
        return float(self.shear.trace() / 2)


class Made(NamedTuple):
    """Whose thickness and material a place has, 0 the plate's and i that of zone i, and which of the rigidities.

    ``section`` is the material, or beyond all materials i the stiffness that zone i, or the plate, gives.
    """

    thickness: Ints
    material: Ints
    section: Ints
    rigidity: Ints


@dataclass(frozen=True, eq=False)
class Zones:
    """The zones of a model on a mesh.

    ``inside`` and ``parted`` (z, ne) are elements in each zone, those that its border parts by their middles, and those
    that it parts. ``rigidities`` are the plate's, and what others there may be; ``young`` (r,) their largest Young's
    moduli, ``equivalent`` (r,) the thickness of a solid plate that is as stiff as a section given by its stiffness, NaN
    of solid ones. ``number`` (2z + 2, z + 1) says which of them a section, see `Made`, has with the modifiers of a zone
    or the plate.
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
        """Take zones on no mesh, for `made_at`."""
        nowhere = np.zeros((len(model.zone), 0), np.bool_)
        return cls(model, nowhere, nowhere, *_rigidities(model))

    @classmethod
    def of(cls, model: Model, mesh: Mesh, problems: Problems) -> Self:
        """Find the elements of every zone; zones beyond the plate are reported as problems."""
        count, area = len(mesh.elements), mesh.element_area
        inside, parted = np.zeros((2, len(model.zone), count), np.bool_)
        middles = mesh.map(np.arange(count), mesh.triangles[:, None] * CENTROID)
        result = cls(model, inside, parted, *_rigidities(model))
        points = []
        for index, zone in enumerate(model.zone):
            with problems.collected():
                points.append(in_area(mesh, model.plate, zone.region, ("zone", index), 3))
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
        """The finite element of the plate."""
        return self.model.plate.element

    @property
    def formulas(self) -> tuple[Expression, ...]:
        """Thickness of the plate, and of every zone, that of the plate where it has none."""
        plate = self.model.plate.thickness
        return (plate, *(plate if zone.thickness is None else zone.thickness for zone in self.model.zone))

    @property
    def places(self) -> tuple[Place, ...]:
        """Where the formulas stand in the input."""
        return (("plate", "thickness"), *(("zone", index, "thickness") for index in range(len(self.model.zone))))

    @property
    def borders(self) -> list[Callable[[Floats], Floats]]:
        """Levels (`signorini.discretise.quadrature.stepped`) along the borders of zones that part elements."""
        zones = zip(self.model.zone, self.parted, strict=True)
        return [side for zone, parted in zones if parted.any() for side in sides_of(zone.region)]

    @property
    def unit_weights(self) -> Floats:
        """Weight per volume of the materials of plate and zones; NaN for materials without it."""
        materials = [self.model.material, *(zone.material or self.model.material for zone in self.model.zone)]
        return np.array([np.nan if one.unit_weight is None else one.unit_weight for one in materials])

    def poisson_of(self, elements: Ints) -> Floats:
        """Poisson's ratios (q,) of elements (q,)."""
        result = np.full(len(self.number), np.nan)
        for section, own in _sections(self.model).items():
            result[section] = own.poisson
        return result[self.of_elements.section[elements]]

    @property
    def without_extremes(self) -> Bools:
        """Elements (ne,) of zones that are left out of extremes."""
        return np.asarray(self.inside[[not zone.extremes for zone in self.model.zone]].any(axis=0))

    @property
    def of_elements(self) -> Made:
        """Section of each element (ne,); an element cut by a border has that of its middle."""
        return self._made(self.inside)

    def at(self, elements: Ints, points: Floats) -> Made:
        """Section of points (q, 2) in elements (q,)."""
        inside = self.inside[:, elements]
        for index, zone in enumerate(self.model.zone):
            beside = self.parted[index, elements]
            inside[index, beside] = zone.region.contains(points[beside])
        return self._made(inside)

    def made_at(self, points: Floats) -> Made:
        """Section of points (q, 2), independent of the mesh."""
        inside = [zone.region.contains(points) for zone in self.model.zone]
        return self._made(np.array(inside, np.bool_).reshape(-1, len(points)))

    def thickness(self, made: Made, points: Floats) -> Floats:
        """Evaluate the thickness (q,) by which the plate is stiff at points (q, 2)."""
        return self.acting(made.rigidity, self.nominal(made.thickness, points))

    def solid(self, elements: Ints, points: Floats) -> Floats:
        """Thickness (q,) at points (q, 2) in elements (q,), NaN where a section is given by its stiffness."""
        made = self.at(elements, points)
        given = np.isnan(self.equivalent[made.rigidity])
        return np.where(given, self.nominal(made.thickness, points), np.nan)

    def acting(self, rigidity: Ints, nominal: Floats) -> Floats:
        """Thickness (q,) by which the plate is stiff, where it has a nominal one and rigidities with numbers (q,)."""
        equivalent = self.equivalent[rigidity]
        return np.where(np.isnan(equivalent), nominal, equivalent)

    def nominal(self, who: Ints, points: Floats) -> Floats:
        """Evaluate the thickness (q,) that is given at points (q, 2), by the formulas with numbers (q,)."""
        result = np.empty(len(points))
        for number in np.unique(who):
            mine = who == number
            result[mine] = self.formulas[number](*points[mine].T, above=0.0, place=self.places[number])
        return result

    def _in_strips(self, mesh: Mesh) -> Bools:
        """Elements (ne,) in which beside a border there is a narrow strip that is made as neither side of it is."""
        result = np.zeros(len(mesh.elements), np.bool_)
        size = float(np.sqrt(mesh.element_area.max(initial=0.0)))
        near, far = _BESIDE * mesh.size, _NARROW * size
        boxes = np.array([zone.region.bounds for zone in self.model.zone]).reshape(-1, 4)
        for index, zone in enumerate(self.model.zone):
            between = np.maximum(boxes[:, :2] - boxes[index, 2:], boxes[index, :2] - boxes[:, 2:])
            reached = (between <= 2.0 * far).all(axis=1)
            points, normals = _along(zone.region.outline, 0.5 * float(np.sqrt(mesh.element_area.min(initial=size**2))))
            ways = np.array([near, -near, far, -far])[:, None, None] * normals
            places = (points + ways).reshape(-1, 2)
            where = np.zeros((len(boxes), len(places)), np.bool_)
            for other in np.flatnonzero(reached):
                where[other] = self.model.zone[other].region.contains(places)
            rigid = where[[zone.rigid for zone in self.model.zone]].any(axis=0)
            made = np.array([*self._made(where), rigid]).reshape(5, 4, -1)
            for side in (0, 1):
                strip = (made[:, side] != made[:, 2]).any(axis=0) & (made[:, side] != made[:, 3]).any(axis=0)
                elements = mesh.locate(points[strip] + ways[side, strip]).elements
                result[elements[elements >= 0]] = True
        return result

    def _made(self, inside: Bools) -> Made:
        material, stiffness = self._last("material", inside), self._last("stiffness", inside)
        count = len(self.model.zone) + 1
        own = np.array([part.stiffness is not None for part in (self.model.plate, *self.model.zone)])
        section = np.where(own[stiffness] & (stiffness >= self._last("is_solid", inside)), count + stiffness, material)
        number = self.number[section, self._last("modifiers", inside)]
        return Made(self._last("thickness", inside), material, section, number)

    def _last(self, key: str, inside: Bools) -> Ints:
        """The last zone that has a key, of places inside (z, q) of zones; 0 the plate."""
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
        """Put them behind one another."""
        nowhere = np.zeros((0, 0), np.bool_)
        young, equivalent = (np.concatenate([getattr(one, name) for one in plates]) for name in ("young", "equivalent"))
        rigidities = tuple(rigidity for one in plates for rigidity in one.rigidities)
        return cls(model, nowhere, nowhere, rigidities, young, equivalent, np.zeros((0, 0), np.int64), tuple(plates))

    @property
    def element(self) -> str:
        """The finite element of all plates."""
        return self.plates[0].element

    @property
    def of_elements(self) -> Made:
        """Sections of the elements: section numbers are per plate, numbers of rigidities are global."""
        first = np.cumsum([0, *(len(one.rigidities) for one in self.plates)])
        each = [one.of_elements for one in self.plates]
        each = [one._replace(rigidity=one.rigidity + start) for one, start in zip(each, first, strict=False)]
        return Made(*map(np.concatenate, zip(*each, strict=True)))


def _along(outline: Outline, step: float) -> tuple[Floats, Floats]:
    """Points (q, 2) along an outline, not farther apart than a step, and normals (q, 2)."""
    points, tangents = [np.zeros((0, 2))], [np.zeros((0, 2))]
    for arc in arcs_of(outline):
        count = math.ceil(arc.length / step) + (0 if isinstance(arc, Segment) else 8)
        for values, found in zip(
            (points, tangents), arc.at(arc.length * (np.arange(count) + 0.5) / count), strict=True
        ):
            values.append(found)
    along = np.concatenate(tangents)
    return np.concatenate(points), np.column_stack([along[:, 1], -along[:, 0]])


def _sections(model: Model) -> dict[int, Material | Stiffness]:
    """Properties of sections by number (`Made`); materials without moduli have no section."""
    parts = list(enumerate((model.plate, *model.zone)))
    materials = ((0, model.material), *((i, zone.material) for i, zone in enumerate(model.zone, 1)))
    result: dict[int, Material | Stiffness] = {}
    result |= {i: material for i, material in materials if material is not None and material.is_elastic}
    result |= {len(parts) + i: part.stiffness for i, part in parts if part.stiffness is not None}
    return result


def _rigidities(model: Model) -> tuple[tuple[Rigidity, ...], Floats, Floats, Ints]:
    """Rigidities with Young's moduli and equivalent thicknesses, and which a section has with modifiers."""
    parts = (model.plate, *model.zone)
    modifiers = {i: part.modifiers for i, part in enumerate(parts) if part.modifiers is not None}
    known: dict[bytes, int] = {}
    made: list[tuple[Rigidity, float, float]] = []
    number = np.zeros((2 * len(parts), len(parts)), np.int64)
    for (i, own), (j, factors) in product(_sections(model).items(), modifiers.items()):
        if isinstance(own, Material):
            rigidity, young = Rigidity.made_of(own, model.plate.shear_factor, factors), own.young
            thickness = np.nan
        else:
            thickness, young = own.equivalent
            rigidity = Rigidity.given(own, thickness, factors)
        key = np.append(rigidity.for_core, (young, thickness)).tobytes()
        if key not in known:
            known[key] = len(made)
            made.append((rigidity, young, thickness))
        number[i, j] = known[key]
    rigidities, youngs, equivalent = zip(*made, strict=True)
    return rigidities, np.array(youngs), np.array(equivalent), number
