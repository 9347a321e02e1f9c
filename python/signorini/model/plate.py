"""Tables [plate] and [mesh] of the input: outline, thickness and finite element of a plate, and mesh options."""

from __future__ import annotations

import math
import os
from abc import abstractmethod
from collections.abc import Iterable, Iterator
from pathlib import Path as FilePath
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, StrictBool, WithJsonSchema

from signorini.model import base
from signorini.model.material import Material, Modifiers, Stiffness
from signorini.model.places import Box, Corners, Holes, contour
from signorini.model.problems import BRANCHES, describe
from signorini.model.where import Located, one_of
from signorini.shapes import Curve, Region, Ring
from signorini.shapes.outlines import Contour, circle, sector, straight

Divisions = Annotated[
    tuple[base.Count, base.Count],
    BeforeValidator(base.listed(2, "two whole numbers, such as [20, 20]")),
    WithJsonSchema({"type": "array", "items": {"type": "integer", "minimum": 1}, "minItems": 2, "maxItems": 2}),
]


class Refinement(Located):
    """A place with smaller elements; the element size increases gradually with the distance from the place."""

    model_config = ConfigDict(json_schema_extra={"oneOf": one_of(Located.places)})

    size: base.Positive = Field(description="Element size at the place: length of the longest side of an element.")

    def _complaints(self) -> Iterator[base.Complaint]:
        yield from self._place_complaints("the place of the smaller elements")
        if self.area == "all":
            yield ("area",), 'found "all"; give size in [mesh] for the whole plate.'

    def boxes(self, plate: Box) -> list[Box]:
        """Bounding boxes [x0, y0, x1, y1] of the refined places on the rectangular plate [x0, y0, x1, y1]."""
        x0, y0, x1, y1 = plate
        sides = {"left": (x0, y0, x0, y1), "right": (x1, y0, x1, y1), "bottom": (x0, y0, x1, y0)}
        sides["top"] = (x0, y1, x1, y1)
        where = self.where
        boxes = [*(sides[name] for name in where.edges), *((x, y, x, y) for x, y in where.points)]
        return [*boxes, *(shape.bounds for shape in where.shapes)]


class MeshOptions(base.Table):
    """Mesh options: numbers of elements or an element size; default 20 elements along the longer side."""

    model_config = ConfigDict(json_schema_extra={"not": {"required": ["divisions", "size"]}})

    divisions: Divisions | None = Field(
        default=None,
        description="Numbers of elements: [along x, along y] of a rectangle, [radial, around] of a disc or annulus.",
    )
    size: base.Positive | None = Field(default=None, description="Element size: length of its longest side.")
    refine: tuple[Refinement, ...] = Field(default=(), description="Places with smaller elements, each with a size.")
    snap: base.NonNegative = Field(
        default=0.0,
        description="Snapping distance: supports, zones and loads that are closer than this to an edge, or to another "
        "of them, are moved onto it; default 0: none is moved.",
    )
    accuracy: Annotated[float, Field(gt=0, lt=1), BeforeValidator(base.number)] | None = Field(
        default=None,
        description="Largest allowed mesh error (half-width ±) of any number, relative to the largest value of its "
        "field, such as mx; the mesh is refined until all numbers meet this bound.",
    )
    error: StrictBool | None = Field(
        default=None,
        description="Whether to estimate the mesh error (±) of every number from solutions on other meshes; default "
        "true, for a mesh file false.",
    )

    def _complaints(self) -> Iterator[base.Complaint]:
        if self.divisions is not None and self.size is not None:
            yield ("size",), "found both divisions and size; give one of them."
        if self.accuracy is not None and self.error is False:
            yield ("error",), "found false; accuracy needs the half-widths ±. Remove error = false."


_DEFAULT_DIVISIONS = 20
"""Number of elements along the longer side of a plate whose mesh options give no size."""
_SHAPES = "Shape of the plate: one of rectangle, disc, annulus, polygon, mesh."
MAX_ASPECT_RATIO = 1000.0
"""Largest ratio of length to width of a plate.

The bending flexibilities of the two directions differ by its fourth power, 1e12; doubles have 16 digits.
"""
_MAX_OFFSET = 1e6
"""Largest distance of a plate from the origin, relative to its size, so that coordinates keep ten of 16 digits."""


def _require_shape(schema: dict[str, Any]) -> None:
    schema["required"] = ["shape", *schema.get("required", [])]


class _Plate(base.Table):
    model_config = ConfigDict(json_schema_extra=_require_shape)

    thickness: base.PositiveScalar = Field(description="Thickness: a number, or an expression in x and y.")
    element: Literal["mitc9", "q8r"] = Field(
        default="mitc9",
        description="Finite element: mitc9 (free of locking) or q8r (Hinton-Owen, reduced integration).",
    )
    shear_factor: base.Positive = Field(default=5 / 6, description="Shear correction factor; default 5/6.")
    modifiers: Modifiers = Field(default=Modifiers(), description="Factors on stiffness in bending, twist and shear.")
    stiffness: Stiffness | None = Field(
        default=None, description="Stiffness of the cross section; by default it follows from material and thickness."
    )
    mesh: MeshOptions | None = Field(
        default=None, description="For one of several plates: mesh options of this plate, in place of [mesh]."
    )
    material: Material | None = Field(
        default=None, description="For one of several plates: material of this plate, in place of [material]."
    )

    def model_post_init(self, context: Any) -> None:
        """Mark ``shape`` as set, so that `model_dump(exclude_unset=True)` keeps this key, which selects the class."""
        self.__pydantic_fields_set__.add("shape")


class OutlinedPlate(_Plate):
    """A plate given by its outline, for which a mesh is generated."""

    holes: Holes = Field(
        default=(), description="Holes of the plate, each a table with one of rectangle, circle, polygon."
    )

    @property
    @abstractmethod
    def outline(self) -> Contour:
        """The outer boundary of the plate."""

    @property
    def hole_contours(self) -> tuple[Contour, ...]:
        """The boundaries of the plate's holes."""
        return tuple(hole.contour(f"hole {number}") for number, hole in enumerate(self.holes, 1))

    @property
    def contours(self) -> tuple[Contour, ...]:
        """The outer boundary and the boundaries of the holes."""
        return (self.outline, *self.hole_contours)

    @property
    def edge_names(self) -> tuple[str, ...]:
        """Names of the edges, which supports and loads can use: outer edges, then those of the holes."""
        return tuple(dict.fromkeys(name for contour in self.contours for name in contour.edges))

    def element_size(self, mesh: MeshOptions) -> float:
        """Element size that the mesh options prescribe; by default the longer side of the plate divided by 20."""
        return mesh.size if mesh.size is not None else self._longer_side() / _DEFAULT_DIVISIONS

    def divisions(self, mesh: MeshOptions) -> tuple[int, int] | None:
        """Numbers of elements of a regular mesh (see `MeshOptions.divisions`); None for an unstructured mesh."""
        return None

    @property
    def min_divisions(self) -> tuple[int, int]:
        """Smallest allowed numbers of elements of a regular mesh, in the order of `MeshOptions.divisions`."""
        return 1, 1

    def follows(self, border: Region | Curve) -> bool:
        """Whether element sides of a regular mesh can follow the border of a zone, or a support or load on a curve."""
        return True

    def scaled(self, mesh: MeshOptions, factor: float, divisions: tuple[int, int] | None) -> MeshOptions:
        """Mesh options with element sizes multiplied by ``factor``; ``divisions`` are those of the unscaled mesh."""
        refine = tuple(place.model_copy(update={"size": place.size * factor}) for place in mesh.refine)
        return MeshOptions(size=self.element_size(mesh) * factor, refine=refine)

    def _longer_side(self) -> float:
        x0, y0, x1, y1 = self.outline.bounds
        return max(x1 - x0, y1 - y0)


class _PatternedPlate(OutlinedPlate):
    """A plate that has a regular mesh if it has no holes: a rectangle, disc or annulus."""

    refines_regularly: ClassVar[bool] = False
    """Whether a regular mesh of this class can have smaller elements at the places of `MeshOptions.refine`."""

    def divisions(self, mesh: MeshOptions) -> tuple[int, int] | None:
        """Numbers of elements of a regular mesh (see `MeshOptions.divisions`); None for an unstructured mesh."""
        if self.holes or (mesh.refine and not self.refines_regularly):
            return None
        if mesh.divisions is not None:
            return mesh.divisions
        size = self.element_size(mesh)
        return self._at_least_minimum(min(length / size, 1e9) - 1e-9 for length in self._lengths())

    def scaled(self, mesh: MeshOptions, factor: float, divisions: tuple[int, int] | None) -> MeshOptions:
        """Mesh options with element sizes multiplied by ``factor``; ``divisions`` are those of the unscaled mesh."""
        scaled = super().scaled(mesh, factor, divisions)
        if divisions is None:
            return scaled
        counts = self._at_least_minimum(count / factor for count in divisions)
        return scaled.model_copy(update={"divisions": counts, "size": None})

    def _at_least_minimum(self, counts: Iterable[float]) -> tuple[int, int]:
        first, second = (max(math.ceil(count), least) for count, least in zip(counts, self.min_divisions, strict=True))
        return first, second

    @abstractmethod
    def _lengths(self) -> tuple[float, float]:
        """Lengths of the plate along the two directions of ``MeshOptions.divisions``."""


class RectanglePlate(_PatternedPlate):
    """A rectangular plate with sides parallel to the axes."""

    refines_regularly: ClassVar[bool] = True

    shape: Literal["rectangle"] = Field(default="rectangle", description=_SHAPES)
    size: Annotated[tuple[base.Positive, base.Positive], *base.vector(2, "two lengths [a, b], along x and y")] = Field(
        description="Side lengths of the rectangle, [along x, along y]."
    )
    origin: base.Point = Field(
        default=(0.0, 0.0), description="Lower left corner [x, y] of the rectangle; default [0, 0]."
    )

    @property
    def outline(self) -> Contour:
        """The four sides of the rectangle."""
        (x, y), (a, b) = self.origin, self.size
        corners = ((x, y), (x + a, y), (x + a, y + b), (x, y + b))
        return straight(corners, ("bottom", "right", "top", "left"))

    def follows(self, border: Region | Curve) -> bool:
        """Whether ``border`` consists of segments parallel to the axes, which a regular mesh can follow."""
        ends = border.outline.segments
        return not len(border.outline.whole_circles) and bool((ends[:, 0] == ends[:, 1]).any(axis=1).all())

    def _lengths(self) -> tuple[float, float]:
        return self.size

    def _complaints(self) -> Iterator[base.Complaint]:
        if max(self.size) > MAX_ASPECT_RATIO * min(self.size):
            why = f"found {list(self.size)}: the ratio of its sides is over {MAX_ASPECT_RATIO:g}. Use a beam model."
            yield ("size",), why
        yield from _too_far("origin", self.origin, max(self.size))


class _RoundPlate(_PatternedPlate):
    """A disc or annulus, full or a sector of it; its regular mesh has radial and circumferential lines."""

    center: base.Point = Field(default=(0.0, 0.0), description="Center [x, y] of the plate; default [0, 0].")

    def follows(self, border: Region | Curve) -> bool:
        """Whether a regular mesh can follow ``border``: true only for a circular curve around the plate's center."""
        return isinstance(border, Ring) and bool(border.radii(self.center))


def _quarters(sector: float) -> float:
    if sector not in (90, 180, 360):
        raise ValueError(f"found {describe(sector)}; a disc can be 90, 180 or 360 degrees.")
    return sector


class DiscPlate(_RoundPlate):
    """A full, half or quarter disc; a half or quarter begins at the x axis and extends towards y."""

    shape: Literal["disc"] = Field(default="disc", description=_SHAPES)
    radius: base.Positive = Field(description="Radius of the disc.")
    sector: Annotated[float, AfterValidator(_quarters), BeforeValidator(base.number)] = Field(
        default=360.0,
        description="Angle of the sector from the x axis, in degrees: 90, 180 or 360.",
        json_schema_extra={"enum": [90, 180, 360]},
    )

    @property
    def outline(self) -> Contour:
        """The circle of a full disc; for a sector, its arc and its straight sides."""
        if self.sector == 360:
            return circle(self.center, self.radius, "rim")
        return sector(self.center, 0.0, self.radius, self.sector, ("start", "rim", "end", ""))

    def _lengths(self) -> tuple[float, float]:
        return self.radius, math.radians(self.sector) * self.radius

    def _complaints(self) -> Iterator[base.Complaint]:
        yield from _too_far("center", self.center, self.radius)


class AnnulusPlate(_RoundPlate):
    """A full ring, or a sector of a ring, which begins at the x axis and extends towards y."""

    shape: Literal["annulus"] = Field(default="annulus", description=_SHAPES)
    inner: base.Positive = Field(description="Inner radius of the ring.")
    outer: base.Positive = Field(description="Outer radius of the ring.")
    sector: Annotated[float, Field(gt=0, le=360), BeforeValidator(base.number)] = Field(
        default=360.0, description="Angle of the sector from the x axis, in degrees; default 360."
    )

    @property
    def outline(self) -> Contour:
        """The outer circle; for a sector, all sides of the sector."""
        if self.sector == 360:
            return circle(self.center, self.outer, "outer")
        return sector(self.center, self.inner, self.outer, self.sector, ("start", "outer", "end", "inner"))

    @property
    def contours(self) -> tuple[Contour, ...]:
        """The outer boundary, the inner circle of a full ring, and the boundaries of the holes."""
        inner = (circle(self.center, self.inner, "inner"),) if self.sector == 360 else ()
        return (self.outline, *inner, *self.hole_contours)

    @property
    def min_divisions(self) -> tuple[int, int]:
        """Smallest numbers of elements, [radial, around]: 1 along a radius; around, 1 for each quarter of a circle."""
        return 1, math.ceil(self.sector / 90)

    def _lengths(self) -> tuple[float, float]:
        return self.outer - self.inner, math.radians(self.sector) * self.outer

    def _longer_side(self) -> float:
        chord = 2 * self.outer * math.sin(math.radians(min(self.sector, 180)) / 2)
        return max(chord, self.outer - self.inner)

    def _complaints(self) -> Iterator[base.Complaint]:
        least, opening = self.outer / _MAX_OFFSET, 360 - self.sector
        if not self.outer - self.inner > least:
            yield ("outer",), f"found {describe(self.outer)}; it must exceed inner, which is {describe(self.inner)}."
        elif self.outer > _MAX_OFFSET * self.inner:
            yield ("inner",), f"found {self.inner:g}; it must be at least {1 / _MAX_OFFSET:g} times outer. Use a disc."
        elif math.radians(self.sector) * self.inner < least:
            why = f"the inner side would be shorter than {1 / _MAX_OFFSET:g} times outer."
            yield ("sector",), f"found {describe(self.sector)}; {why}"
        elif opening and math.radians(opening) * self.inner < least:
            yield (
                ("sector",),
                f"found {describe(self.sector)}; its straight sides almost meet. Use 360 for a full ring.",
            )
        yield from _too_far("center", self.center, self.outer)


class PolygonPlate(OutlinedPlate):
    """A plate whose outline has straight sides and arcs."""

    shape: Literal["polygon"] = Field(default="polygon", description=_SHAPES)
    points: Corners = Field(
        description="Corners [x, y] of the outline in order; an arc to a corner is { through = [x, y], to = [x, y] }."
    )

    @property
    def outline(self) -> Contour:
        """The sides of the polygon; edge i runs from corner i to the next corner."""
        return contour(self.points, "edge", numbered=True)

    def _complaints(self) -> Iterator[base.Complaint]:
        x0, y0, x1, y1 = self.outline.bounds
        yield from _too_far("points", (max(abs(x0), abs(x1)), max(abs(y0), abs(y1))), max(x1 - x0, y1 - y0))


def _too_far(key: str, point: tuple[float, float], size: float) -> Iterator[base.Complaint]:
    if max(map(abs, point)) > _MAX_OFFSET * size:
        why = f"farther away than {_MAX_OFFSET:g} times the plate's size. Move the plate to the origin."
        yield (key,), f"found {list(point)}: {why}"


def _file(value: object) -> FilePath:
    if not isinstance(value, str | os.PathLike):
        raise ValueError(f"found {describe(value)}; it must be the path of a mesh file, in quotes.")
    if not str(value).strip() or "\0" in str(value):
        raise ValueError(f"found {describe(str(value))}; it must be the path of a mesh file.")
    return FilePath(value)


class MeshPlate(_Plate):
    """A plate whose mesh is read from a file, with 8- or 9-node quadrilaterals and 6-node triangles."""

    shape: Literal["mesh"] = Field(default="mesh", description=_SHAPES)
    file: Annotated[FilePath, BeforeValidator(_file), WithJsonSchema({"type": "string"})] = Field(
        description="Mesh file, relative to the input file."
    )

    @property
    def edge_names(self) -> None:
        """None, as the names of the edges are in the mesh file, which is not read yet."""
        return None


Plate = RectanglePlate | DiscPlate | AnnulusPlate | PolygonPlate | MeshPlate
AnyPlate = Annotated[Plate, Field(discriminator="shape")]
BRANCHES["plate"] = {
    "rectangle": RectanglePlate,
    "disc": DiscPlate,
    "annulus": AnnulusPlate,
    "polygon": PolygonPlate,
    "mesh": MeshPlate,
}
