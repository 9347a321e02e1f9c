"""Tables for cross sections of the plate and its zones: material, stiffness factors, stiffness of the section."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any, NamedTuple

from pydantic import BeforeValidator, ConfigDict, Field

from signorini.expression import Expression
from signorini.model.base import (
    Complaint,
    Flag,
    NonNegative,
    Number,
    OnPlate,
    Positive,
    PositiveScalar,
    Table,
    number,
)
from signorini.model.places import AnyArea, Area
from signorini.model.where import Where
from signorini.shapes import Region

_ISOTROPIC = ("E", "nu")
_ORTHOTROPIC = ("Ex", "Ey", "nu_xy", "Gxy", "Gxz", "Gyz", "angle")
_REQUIRED = ("Ex", "Ey", "nu_xy", "Gxy")
"""Keys that an orthotropic material must have; Gxz, Gyz and angle have defaults."""


class Axes(NamedTuple):
    """Moduli of an orthotropic material along its axes 1 and 2; ``angle`` is the angle from x to axis 1 in degrees."""

    Ex: float
    Ey: float
    nu_xy: float
    Gxy: float
    Gxz: float
    Gyz: float
    angle: float


def _isotropic_or_orthotropic(schema: dict[str, Any]) -> None:
    def without(*keys: str) -> dict[str, Any]:
        return {"not": {"anyOf": [{"required": [key]} for key in keys]}}

    schema["oneOf"] = [
        {"required": list(_ISOTROPIC), **without(*_ORTHOTROPIC)},
        {"required": list(_REQUIRED), **without(*_ISOTROPIC)},
        without(*_ISOTROPIC, *_ORTHOTROPIC),
    ]


class Material(Table):
    """A linear elastic material: isotropic by E and nu, or orthotropic by Ex, Ey, nu_xy and Gxy.

    A material without moduli gives only a weight; its sections must have the key ``stiffness``.
    """

    model_config = ConfigDict(json_schema_extra=_isotropic_or_orthotropic)

    E: Positive | None = Field(default=None, description="Young's modulus, force per area.")
    nu: Annotated[float, Field(gt=-1, lt=0.5), BeforeValidator(number)] | None = Field(
        default=None, description="Poisson's ratio, between -1 and 0.5."
    )
    Ex: Positive | None = Field(default=None, description="Orthotropic: Young's modulus along the first axis.")
    Ey: Positive | None = Field(default=None, description="Orthotropic: Young's modulus along the second axis.")
    nu_xy: Annotated[float, BeforeValidator(number)] | None = Field(
        default=None, description="Orthotropic: Poisson's ratio -ε₂/ε₁ under tension along the first axis."
    )
    Gxy: Positive | None = Field(default=None, description="Orthotropic: shear modulus in the plane of the plate.")
    Gxz: Positive | None = Field(default=None, description="Transverse shear modulus, first axis and z; default Gxy.")
    Gyz: Positive | None = Field(default=None, description="Transverse shear modulus, second axis and z; default Gxy.")
    angle: Annotated[float, BeforeValidator(number)] | None = Field(
        default=None, description="Angle in degrees from x to the first axis of the material; default 0."
    )
    unit_weight: NonNegative | None = Field(
        default=None, description="Weight per volume; required for a self_weight load."
    )

    @property
    def is_elastic(self) -> bool:
        """Whether the material has elastic moduli."""
        return bool(self.present((*_ISOTROPIC, *_ORTHOTROPIC)))

    @property
    def young(self) -> float:
        """Young's modulus E of the material; for an orthotropic material max(Ex, Ey)."""
        return self.E if self.E is not None else max(self.axes.Ex, self.axes.Ey)

    @property
    def poisson(self) -> float:
        """Poisson's ratio ν; for an orthotropic material the geometric mean √(ν_xy ν_yx)."""
        return self.nu if self.nu is not None else self.axes.nu_xy * math.sqrt(self.axes.Ey / self.axes.Ex)

    @property
    def axes(self) -> Axes:
        """Moduli of an orthotropic material, with Gxz and Gyz equal to Gxy by default, and the angle of its axes."""
        Ex, Ey, nu_xy, Gxy = (getattr(self, key) for key in _REQUIRED)
        return Axes(Ex, Ey, nu_xy, Gxy, self.Gxz or Gxy, self.Gyz or Gxy, self.angle or 0.0)

    def missing(self) -> Iterator[Complaint]:
        """Yield a problem for each of E and nu that the material lacks."""
        for key in _ISOTROPIC:
            if getattr(self, key) is None:
                yield (key,), f"'{key}' is missing. {type(self).model_fields[key].description}"

    def _complaints(self) -> Iterator[Complaint]:
        isotropic, orthotropic = self.present(_ISOTROPIC), self.present(_ORTHOTROPIC)
        if isotropic and not orthotropic:
            yield from self.missing()
        if not orthotropic:
            return
        if isotropic:
            yield (
                (isotropic[0],),
                f"found {isotropic[0]} beside {orthotropic[0]}; a material is isotropic (E, nu) or orthotropic "
                f"({', '.join(_REQUIRED)}).",
            )
            return
        for key in _REQUIRED:
            if getattr(self, key) is None:
                yield (key,), f"'{key}' is missing; it is required with {orthotropic[0]}."
        if not set(_REQUIRED) - set(orthotropic) and self.axes.nu_xy**2 * self.axes.Ey >= self.axes.Ex:
            most = math.sqrt(self.axes.Ex / self.axes.Ey)
            yield (
                ("nu_xy",),
                f"found {self.nu_xy:g}; |nu_xy| must be less than √(Ex/Ey) = {most:.6g}. Is this value the ratio under "
                "tension along the second axis, nu_yx = nu_xy Ey/Ex?",
            )


class Modifiers(Table):
    """Factors that multiply stiffnesses of cracked, ribbed or hollow sections; axes: the section's, or else x and y."""

    bending: Positive = Field(default=1.0, description="Factor that multiplies the bending stiffness.")
    twist: Positive = Field(default=1.0, description="Factor that multiplies the twisting stiffness.")
    shear: Positive = Field(default=1.0, description="Factor that multiplies the transverse shear stiffness.")


class Stiffness(Table):
    """Stiffness of a cross section along its axes 1 and 2; for sections that are not solid, such as ribbed slabs."""

    Dx: Positive = Field(description="Bending stiffness along the first axis, force times length.")
    Dy: Positive = Field(description="Bending stiffness along the second axis, force times length.")
    D1: Number = Field(description="Bending moment along one axis per curvature along the other; solid plate: nu D.")
    Dxy: Positive = Field(description="Twisting moment per twist 2 ∂²w/∂x∂y; solid plate: (1 - nu) D / 2.")
    Sx: Positive = Field(description="Shear stiffness along the first axis, force per length.")
    Sy: Positive = Field(description="Shear stiffness along the second axis, force per length.")
    angle: Number = Field(default=0.0, description="Angle in degrees from x to the first axis; default 0.")

    @property
    def poisson(self) -> float:
        """Poisson's ratio D1/√(Dx Dy), the geometric mean of the ratios D1/Dx and D1/Dy."""
        return self.D1 / math.sqrt(self.Dx * self.Dy)

    @property
    def equivalent(self) -> tuple[float, float]:
        """Thickness h and Young's modulus E of a solid isotropic plate with about this stiffness.

        h follows from the means over all directions of the twisting stiffness G h³/12 and the shear stiffness 5/6 G h.

        Examples
        --------
        >>> solid = Stiffness(Dx=32.0, Dy=32.0, D1=0.0, Dxy=16.0, Sx=40.0, Sy=40.0)  # E = 48, nu = 0, h = 2
        >>> solid.equivalent
        (2.0, 48.0)
        """
        twist, shear = (self.Dx + self.Dy - 2.0 * self.D1 + 4.0 * self.Dxy) / 8.0, (self.Sx + self.Sy) / 2.0
        thickness = math.sqrt(10.0 * twist / shear)
        return thickness, 12.0 * max(self.Dx, self.Dy) / thickness**3

    def _complaints(self) -> Iterator[Complaint]:
        most = math.sqrt(self.Dx * self.Dy)
        if abs(self.D1) >= most:
            yield ("D1",), f"found {self.D1:g}; |D1| must be less than √(Dx Dy) = {most:.6g}."


def constant_thickness(thickness: Expression) -> Iterator[Complaint]:
    """Yield a problem if the thickness is an expression; beside the key ``stiffness`` it must be a number."""
    if not thickness.is_constant:
        yield (
            ("thickness",),
            f'found "{thickness.source}"; beside stiffness, which describes one section, thickness must be a number.',
        )


ZONE_KEYS = ("thickness", "material", "modifiers", "stiffness")


class Zone(OnPlate):
    """A part of the plate with other properties; where zones overlap, each key is that of the last zone that gives it.

    A rigid zone moves as one body, also where other zones overlap it.
    """

    model_config = ConfigDict(
        json_schema_extra={"anyOf": [{"required": [key]} for key in (*ZONE_KEYS, "rigid", "extremes")]}
    )

    area: AnyArea = Field(description="Area of the zone: a table with one of rectangle, circle, polygon, annulus.")
    thickness: PositiveScalar | None = Field(
        default=None, description="Thickness of the zone: a number or an expression in x and y; default: the plate's."
    )
    material: Material | None = Field(default=None, description="Material of the zone; default: the plate's.")
    modifiers: Modifiers | None = Field(
        default=None, description="Stiffness factors of the zone, in place of those of the plate."
    )
    stiffness: Stiffness | None = Field(
        default=None, description="Stiffness of the zone's section; thickness is required as well, for its weight."
    )
    rigid: Flag = Field(
        default=False,
        description="Whether the zone moves as one rigid body; thickness, material and stiffness are then not allowed.",
    )
    extremes: Flag = Field(
        default=True,
        description="Whether extremes and colour scales include results in the zone; a rigid zone is always excluded.",
    )

    @property
    def region(self) -> Region:
        """The zone's area as a region of the plane."""
        assert isinstance(self.area, Area)  # Validation refuses a zone with area = "all".
        return self.area.region

    @property
    def where(self) -> Where:
        """The zone's area as an object `Where`, like the places of supports and loads."""
        return Where("area", region=self.region)

    def _complaints(self) -> Iterator[Complaint]:
        if self.area == "all":
            yield ("area",), 'found "all"; give properties of the whole plate in [plate] and [material].'
        if self.rigid and (keys := self.present(ZONE_KEYS)):
            yield (keys[0],), f"found {keys[0]} together with rigid; remove one of them."
        if not self.present(ZONE_KEYS) and not self.rigid and self.extremes:
            yield (), f"the zone has no effect; give {', '.join(ZONE_KEYS)} or rigid."
        if self.stiffness is not None:
            if self.thickness is None:
                yield ("thickness",), "'thickness' is missing; it is required with stiffness, for the weight."
            else:
                yield from constant_thickness(self.thickness)

    @property
    def is_solid(self) -> bool:
        """Whether the zone has a solid section: it has the key ``thickness`` or ``material``, but not ``stiffness``."""
        return self.stiffness is None and bool(self.present(("thickness", "material")))
