"""Parts of the plate that are made otherwise."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import ConfigDict, Field

from signorini.model.area import AnyArea, Area
from signorini.model.base import Complaint, PositiveScalar, Table
from signorini.model.material import Material, Modifiers, Stiffness, constant_thickness
from signorini.shapes import Region

KEYS = ("thickness", "material", "modifiers", "stiffness")


class Zone(Table):
    """A part of the plate with a thickness, material or modifiers of its own; where zones overlap, later ones win.

    A rigid one moves as one body, whatever other zones are there.
    """

    model_config = ConfigDict(
        json_schema_extra={"anyOf": [{"required": [key]} for key in (*KEYS, "rigid", "extremes")]}
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

    def _complaints(self) -> Iterator[Complaint]:
        if self.area == "all":
            yield ("area",), 'found "all"; what the whole plate is made of stands in [plate] and [material].'
        if self.rigid and (given := self.given(KEYS)):
            yield (given[0],), f"found {given[0]} beside rigid; a rigid zone has none. Leave one of them out."
        if not self.given(KEYS) and not self.rigid and self.extremes:
            yield (), f"it changes nothing; give {', '.join(KEYS)} or rigid."
        if self.stiffness is not None:
            if self.thickness is None:
                yield ("thickness",), "'thickness' is missing; it goes with stiffness, for the weight."
            else:
                yield from constant_thickness(self.thickness)

    @property
    def is_solid(self) -> bool:
        """Whether material and thickness make it, whatever makes what is below."""
        return self.stiffness is None and bool(self.given(("thickness", "material")))
