"""Sections of the plate and of its zones: materials, modifiers, and stiffnesses."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any, NamedTuple

from pydantic import BeforeValidator, ConfigDict, Field

from signorini.expression import Expression
from signorini.model.base import (
    Complaint,
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
_NEEDED = ("Ex", "Ey", "nu_xy", "Gxy")


class Axes(NamedTuple):
    """Moduli of an orthotropic material along its own axes, the first turned by an angle from x, in degrees."""

    Ex: float
    Ey: float
    nu_xy: float
    Gxy: float
    Gxz: float
    Gyz: float
    angle: float


def _either(schema: dict[str, Any]) -> None:
    def without(*keys: str) -> dict[str, Any]:
        return {"not": {"anyOf": [{"required": [key]} for key in keys]}}

    schema["oneOf"] = [
        {"required": list(_ISOTROPIC), **without(*_ORTHOTROPIC)},
        {"required": list(_NEEDED), **without(*_ISOTROPIC)},
        without(*_ISOTROPIC, *_ORTHOTROPIC),
    ]


class Material(Table):
    """A linear elastic material: isotropic by E and nu, or orthotropic by Ex, Ey, nu_xy and Gxy.

    Without any of them it is one of sections whose stiffness is given.
    """

    model_config = ConfigDict(json_schema_extra=_either)

    E: Positive | None = Field(default=None, description="Young's modulus, force per area.")
    nu: Annotated[float, Field(gt=-1, lt=0.5), BeforeValidator(number)] | None = Field(
        default=None, description="Poisson's ratio, between -1 and 0.5."
    )
    Ex: Positive | None = Field(default=None, description="Young's modulus along the first axis.")
    Ey: Positive | None = Field(default=None, description="Young's modulus along the second axis.")
    nu_xy: Annotated[float, BeforeValidator(number)] | None = Field(
        default=None, description="Poisson's ratio: how far it shrinks along the second axis, pulled along the first."
    )
    Gxy: Positive | None = Field(default=None, description="Shear modulus in the plane of the plate.")
    Gxz: Positive | None = Field(default=None, description="Shear modulus across the plate, first axis; default Gxy.")
    Gyz: Positive | None = Field(default=None, description="Shear modulus across the plate, second axis; default Gxy.")
    angle: Annotated[float, BeforeValidator(number)] | None = Field(
        default=None, description="Angle from x to the first axis, in degrees; default 0."
    )
    unit_weight: NonNegative | None = Field(
        default=None, description="Weight per volume; needed by a load of self_weight."
    )

    @property
    def is_elastic(self) -> bool:
        """Whether it has moduli."""
        return bool(self.present((*_ISOTROPIC, *_ORTHOTROPIC)))

    @property
    def young(self) -> float:
        """Young's modulus, of an orthotropic material the larger one."""
        return self.E if self.E is not None else max(self.axes.Ex, self.axes.Ey)

    @property
    def poisson(self) -> float:
        """Poisson's ratio, of an orthotropic material the geometric mean of its two."""
        return self.nu if self.nu is not None else self.axes.nu_xy * math.sqrt(self.axes.Ey / self.axes.Ex)

    @property
    def axes(self) -> Axes:
        """The moduli of an orthotropic material."""
        Ex, Ey, nu_xy, Gxy = (getattr(self, key) for key in _NEEDED)
        return Axes(Ex, Ey, nu_xy, Gxy, self.Gxz or Gxy, self.Gyz or Gxy, self.angle or 0.0)

    def missing(self) -> Iterator[Complaint]:
        """Say which moduli an isotropic material lacks."""
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
                f"({', '.join(_NEEDED)}).",
            )
            return
        for key in _NEEDED:
            if getattr(self, key) is None:
                yield (key,), f"'{key}' is missing; it goes with {orthotropic[0]}."
        if not set(_NEEDED) - set(orthotropic) and self.axes.nu_xy**2 * self.axes.Ey >= self.axes.Ex:
            most = math.sqrt(self.axes.Ex / self.axes.Ey)
            yield (
                ("nu_xy",),
                f"found {self.nu_xy:g}; its size must be less than the root of Ex/Ey, {most:.6g}. Is it the ratio of "
                "the other axis, nu_yx = nu_xy Ey/Ex?",
            )


class Modifiers(Table):
    """Factors of the plate's stiffness along the material's axes, or x and y: cracked, ribbed or hollow sections."""

    bending: Positive = Field(default=1.0, description="Factor of the rigidities in bending.")
    twist: Positive = Field(default=1.0, description="Factor of the rigidity in twist.")
    shear: Positive = Field(default=1.0, description="Factor of the rigidities in shear.")


class Stiffness(Table):
    """Stiffness of a section along its own axes, such as a ribbed or hollow one."""

    Dx: Positive = Field(description="Bending moment per curvature along the first axis, force times length.")
    Dy: Positive = Field(description="Bending moment per curvature along the second axis.")
    D1: Number = Field(description="Bending moment along either axis per curvature along the other one.")
    Dxy: Positive = Field(description="Twisting moment per twice the twist; (1 - nu) D / 2 of a solid plate.")
    Sx: Positive = Field(description="Shear force per shear strain along the first axis, force per length.")
    Sy: Positive = Field(description="Shear force per shear strain along the second axis.")
    angle: Number = Field(default=0.0, description="Angle from x to the first axis, in degrees; default 0.")

    @property
    def poisson(self) -> float:
        """Poisson's ratio, the geometric mean of those of both axes."""
        return self.D1 / math.sqrt(self.Dx * self.Dy)

    @property
    def equivalent(self) -> tuple[float, float]:
        """Thickness and Young's modulus of a solid plate that is about as stiff.

        Twist and shear, means of all directions, tell the thickness: those of a solid plate are G h³/12 and 5/6 G h.

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
            yield ("D1",), f"found {self.D1:g}; its size must be less than the root of Dx Dy, {most:.6g}."


def constant_thickness(thickness: Expression) -> Iterator[Complaint]:
    """Refuse an expression beside a stiffness, which stands for one section."""
    if not thickness.is_constant:
        yield (
            ("thickness",),
            f'found "{thickness.source}"; beside stiffness, which is that of one section, it must be a number.',
        )


ZONE_KEYS = ("thickness", "material", "modifiers", "stiffness")


class Zone(OnPlate):
    """A part of the plate with a thickness, material or modifiers of its own; where zones overlap, later ones win.

    A rigid one moves as one body, whatever other zones are there.
    """

    model_config = ConfigDict(
        json_schema_extra={"anyOf": [{"required": [key]} for key in (*ZONE_KEYS, "rigid", "extremes")]}
    )

    area: AnyArea = Field(description="A table with one of rectangle, circle, polygon.")
    thickness: PositiveScalar | None = Field(
        default=None, description="Thickness there: a number, or an expression in x and y; default that of the plate."
    )
    material: Material | None = Field(default=None, description="The material there; default that of the plate.")
    modifiers: Modifiers | None = Field(
        default=None, description="Factors of the stiffness there, in place of those of the plate."
    )
    stiffness: Stiffness | None = Field(
        default=None, description="Stiffness of the section there; beside it a thickness, for the weight."
    )
    rigid: bool = Field(default=False, description="Whether it moves as one body, in place of a thickness.")
    extremes: bool = Field(
        default=True, description="Whether it counts in extremes of fields and colour scales; rigid ones never do."
    )

    @property
    def region(self) -> Region:
        """The region of the plane."""
        assert isinstance(self.area, Area)  # "all" is refused
        return self.area.region

    @property
    def where(self) -> Where:
        """Where it is."""
        return Where("area", region=self.region)

    def _complaints(self) -> Iterator[Complaint]:
        if self.area == "all":
            yield ("area",), 'found "all"; what the whole plate is made of stands in [plate] and [material].'
        if self.rigid and (given := self.present(ZONE_KEYS)):
            yield (given[0],), f"found {given[0]} beside rigid; a rigid zone has none. Leave one of them out."
        if not self.present(ZONE_KEYS) and not self.rigid and self.extremes:
            yield (), f"it changes nothing; give {', '.join(ZONE_KEYS)} or rigid."
        if self.stiffness is not None:
            if self.thickness is None:
                yield ("thickness",), "'thickness' is missing; it goes with stiffness, for the weight."
            else:
                yield from constant_thickness(self.thickness)

    @property
    def is_solid(self) -> bool:
        """Whether the section follows from material and thickness."""
        return self.stiffness is None and bool(self.present(("thickness", "material")))
