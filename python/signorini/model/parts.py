"""Models of several plates: a model for each plate with its tables, and the areas shared by two plates."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, Literal, Protocol, Self, TypeVar

import shapely

from signorini.errors import InputError, Place, unknown
from signorini.model.base import Complaint, OnPlate
from signorini.model.material import Material
from signorini.model.places import Arc, Area, Form
from signorini.model.plate import MeshOptions, MeshPlate, Plate
from signorini.model.problems import describe
from signorini.model.support import Support
from signorini.shapes.outlines import Contour

ON_PLATES = ("zone", "support", "load", "moving", "probe", "section", "strip", "profile", "punching")
"""Keys of tables that belong to the plate in their key ``plate``, and supports to both plates in ``between``."""
_SAME_AREA = 1e-9
"""Tolerance for equal areas, relative to the area of the plate; it covers rounding errors of corners."""
_REVERSED: Mapping[str | None, Literal["down", "up"]] = {"down": "up", "up": "down"}


class Whole(Protocol):
    """The members of `Model` that this module uses; see `Model` for their meaning."""

    @property
    def title(self) -> str:
        """Title of the model."""

    @property
    def plate(self) -> Plate:
        """The plate of a model of one plate; None for several plates."""

    @property
    def plates(self) -> Mapping[str, Plate]:
        """The plates by name; empty for a model of one plate."""

    @property
    def mesh(self) -> MeshOptions:
        """Mesh options [mesh], for plates without a table ``mesh`` of their own."""

    @property
    def material(self) -> Material:
        """Material [material], for plates without a table ``material`` of their own."""

    @property
    def support(self) -> tuple[Support, ...]:
        """All supports; the contacts are last."""

    @property
    def contact(self) -> tuple[Support, ...]:
        """Contacts between plates."""

    @property
    def effective_combinations(self) -> object:
        """All combinations of the model."""

    def varied(self, **tables: object) -> Self:
        """Return a copy of the model in which ``tables`` replace those with the same key."""

    def complaints_of_plate(self) -> Iterator[Complaint]:
        """Yield the problems of a plate and of its tables."""


M = TypeVar("M", bound=Whole)


@dataclass(frozen=True)
class Part(Generic[M]):
    """One of several plates; ``model`` has this plate alone, with its supports and its contacts with other plates.

    ``numbers`` maps each key, such as "load", to the indices of the plate's tables in the whole model.
    """

    name: str
    whole: M
    numbers: Mapping[str, tuple[int, ...]]

    @cached_property
    def model(self) -> M:
        """Model of this plate alone, with its own tables."""
        whole, plate = self.whole, self.whole.plates[self.name]
        tables: dict[str, object] = {
            key: tuple(getattr(whole, key)[i] for i in numbers) for key, numbers in self.numbers.items()
        }
        tables["support"] = tuple(_on_plate(whole, whole.support[i], self.name) for i in self.numbers["support"])
        replaced = {key: getattr(plate, key) for key in self._replaced}
        title = ", ".join(part for part in (whole.title, self.name) if part)
        # This access computes the whole model's combinations, which `varied` then copies into the model of this plate.
        _ = whole.effective_combinations
        result = whole.varied(**tables, **replaced, plate=plate, plates={}, contact=(), check=(), title=title)
        result.__dict__["_part"] = self.name
        return result

    @property
    def _replaced(self) -> tuple[str, ...]:
        """Those of the keys "mesh" and "material" that [plates.NAME] gives, in place of the whole model's tables."""
        return tuple(key for key in ("mesh", "material") if getattr(self.whole.plates[self.name], key) is not None)

    def place(self, place: Place) -> Place:
        """Convert the path of a problem in this plate's model to the path in the whole model's input."""
        key, *rest = place or ("",)
        if key == "plate" or key in self._replaced:
            return ("plates", self.name, *(rest if key == "plate" else place))
        if key in self.numbers and rest and isinstance(rest[0], int):
            number, first = self.numbers[str(key)][rest[0]], len(self.whole.support) - len(self.whole.contact)
            return (*(_place_of(number, first) if key == "support" else (key, number)), *rest[1:])
        return place


def parts_of(model: M) -> tuple[Part[M], ...]:
    """Return each plate of a model of several plates as a `Part`; empty for a model of one plate."""
    plates = {key: [_plates_of(table) for table in getattr(model, key)] for key in ON_PLATES}
    return tuple(
        Part(name, model, {key: tuple(i for i, on in enumerate(of) if name in on) for key, of in plates.items()})
        for name in model.plates
    )


def _plates_of(table: OnPlate) -> tuple[str, ...]:
    """Names of the plates to which a table belongs; two for a support between plates."""
    if isinstance(table, Support) and table.between is not None:
        return table.between
    return () if table.plate is None else (table.plate,)


def _on_plate(model: Whole, support: Support, name: str) -> Support:
    """The support as it acts on plate ``name``; on the lower of two plates down and up of ``resists`` are exchanged."""
    if support.between is None:
        return support
    upper, lower = support.between
    area = None if support.area is None else _area_on_both(model, name, lower if name == upper else upper, support.area)
    resists = support.resists if name == upper else _REVERSED.get(support.resists, support.resists)
    return support.model_copy(update={"area": area, "resists": resists})


def _area_on_both(model: Whole, name: str, other: str, area: Area | Literal["all"]) -> Area | Literal["all"]:
    """The part of ``area`` on both plates; "all" if it is the whole plate ``name``.

    Holes of plate ``name`` itself are left to its mesh, and an area beyond the outline of a plate is refused there.
    """
    plate, other_plate = model.plates[name], model.plates[other]
    if area == "all":
        return _shared_area(name, plate, other, other_plate)
    if isinstance(other_plate, MeshPlate):
        return area
    outline, *inner = area.region.loops
    whole = shapely.Polygon(outline, inner)
    cut = [(hole, shapely.Polygon(hole.points())) for hole in other_plate.contours[1:]]
    cut = [(hole, shape) for hole, shape in cut if whole.intersection(shape).area > _SAME_AREA * whole.area]
    if not cut:
        return area
    if all(whole.contains_properly(shape) for _, shape in cut):
        (form,) = area.present(area.forms)
        holes = *area.holes, *(Form(polygon=_corners(hole)) for hole, _ in cut)
        return Area(**{form: getattr(area, form), "holes": holes})
    left = shapely.get_parts(whole.difference(shapely.union_all([shape for _, shape in cut])))
    parts = [part for part in left if part.area > _SAME_AREA * whole.area]
    if len(parts) != 1:
        raise InputError(
            f'the holes of "{other}" divide the area into {len(parts)} separate areas. Write one table for each area.'
            if parts
            else f'the area lies in a hole of "{other}". Move it onto both plates.'
        )
    return _drawn(parts[0])


def _shared_area(name: str, plate: Plate, other: str, other_plate: Plate) -> Area | Literal["all"]:
    """The area in which two plates overlap; "all" if it is the whole ``plate``."""
    if isinstance(plate, MeshPlate) or isinstance(other_plate, MeshPlate):
        raise InputError(
            f'found "all", but the outline of "{name}" or "{other}" is in a mesh file. Give the shared area as a '
            "rectangle, a circle or a polygon."
        )
    polygon, other_polygon = (
        shapely.Polygon(outline, holes)
        for outline, *holes in ([contour.points() for contour in each.contours] for each in (plate, other_plate))
    )
    tolerance = _SAME_AREA * polygon.area
    shared = shapely.get_parts(shapely.intersection(polygon, other_polygon))
    areas = [part for part in shared if shapely.area(part) > tolerance]
    if not areas:
        raise InputError(f'"{name}" and "{other}" do not overlap. Move one plate, or remove this table.')
    if len(areas) > 1:
        raise InputError(
            f'"{name}" and "{other}" overlap in {len(areas)} separate areas. Write one table for each area.'
        )
    if polygon.area - areas[0].area <= tolerance:
        return "all"
    if other_polygon.area - areas[0].area <= tolerance:
        outline, *holes = other_plate.contours
        return Area(polygon=_corners(outline), holes=tuple(Form(polygon=_corners(hole)) for hole in holes))
    return _drawn(areas[0])


def _drawn(polygon: shapely.Polygon) -> Area:
    """The polygon as an area of the input."""
    boundaries = (polygon.exterior, *polygon.interiors)
    rings = [[(x, y) for x, y in shapely.get_coordinates(ring)[:-1].tolist()] for ring in boundaries]
    return Area(polygon=rings[0], holes=tuple(Form(polygon=ring) for ring in rings[1:]))


def _corners(contour: Contour) -> tuple[tuple[float, float] | Arc, ...]:
    """The corners and arcs of an outline, in the form of the key ``polygon``."""
    ends = [after if through is None else Arc(through=through, to=after) for _, through, after in contour.sides]
    # In the key ``polygon`` a straight side from the last corner back to the first one is not listed.
    return (contour.corners[0], *(ends if isinstance(ends[-1], Arc) else ends[:-1]))


def plate_complaints(model: Whole) -> Iterator[Complaint]:
    """Yield the problems of [plates], of other tables' references to plates, and of each plate's tables."""
    several = bool(model.plates)
    if several and model.plate is not None:
        yield ("plates",), "found both [plate] and [plates]; give one."
        return
    if not several:
        for key in ("mesh", "material"):
            if getattr(model.plate, key) is not None:
                yield ("plate", key), f"for one plate, give it as the table [{key}]."
    for name in model.plates:
        if not re.fullmatch(r"[A-Za-z0-9_-]{1,40}", name):
            yield (
                ("plates", name),
                f"found the name {describe(name)}; it is part of file names: use up to 40 letters, digits, - or _.",
            )
    wrong_references = [*_reference_complaints(model), *_cycle_complaints(model)]
    yield from wrong_references
    if len({plate.element for plate in model.plates.values()}) > 1:
        yield ("plates",), "found plates with different elements; all must have the same element, mitc9 or q8r."
    if several and model.mesh.accuracy is not None:
        yield (
            ("mesh", "accuracy"),
            "accuracy is for one plate; refine the meshes of several plates by hand until ± is small enough.",
        )
    for name, plate in model.plates.items():
        for key in plate.mesh.present(("accuracy", "error")) if plate.mesh is not None else ():
            why = (
                "give error in [mesh]; it applies to all plates."
                if key == "error"
                else "refine by hand until ± is small."
            )
            yield ("plates", name, "mesh", key), f"{key} is not allowed in plates.NAME.mesh, for one plate; {why}"
    if wrong_references or not several:
        return
    first = len(model.support) - len(model.contact)
    for index, support in enumerate(model.support):
        if support.between is not None and support.area is not None:
            try:
                for name, other in (support.between, support.between[::-1]):
                    _area_on_both(model, name, other, support.area)
            except InputError as error:
                yield (*_place_of(index, first), "area"), error.message
                return
    for part in parts_of(model):
        yield from ((part.place(path), message) for path, message in part.model.complaints_of_plate())


def _reference_complaints(model: Whole) -> Iterator[Complaint]:
    """Yield a problem for each table whose key ``plate`` is missing, unknown or superfluous."""
    first = len(model.support) - len(model.contact)
    for key in ON_PLATES:
        for index, table in enumerate(getattr(model, key)):
            place = _place_of(index, first) if key == "support" else (key, index)
            names, where = _plates_of(table), "plate" if table.plate is not None else "between"
            if not model.plates and names:
                yield (*place, where), f"found {where}, but there is one plate only. Remove the key, or give [plates]."
            elif model.plates and not names:
                yield (*place, "plate"), f"'plate' is missing. Name one of the plates: {', '.join(model.plates)}."
            for name in names if model.plates else ():
                if name not in model.plates:
                    yield (*place, where), unknown("plate", name, model.plates, "This model")


def _cycle_complaints(model: Whole) -> Iterator[Complaint]:
    """Yield a problem if plates lie on each other in a cycle, such as A on B and B on A."""
    first, below = len(model.support) - len(model.contact), dict[str, set[str]]()
    for index, (upper, lower) in ((i, each.between) for i, each in enumerate(model.support) if each.between):
        if upper in below.get(lower, ()):
            yield (
                (*_place_of(index, first), "between"),
                f'found "{upper}" on "{lower}", but "{lower}" lies on "{upper}". Name the upper plate first, then the '
                "lower plate.",
            )
            return
        beneath = {lower} | below.get(lower, set())
        for name in [upper, *(name for name, lower_names in below.items() if upper in lower_names)]:
            below[name] = below.get(name, set()) | beneath


def _place_of(index: int, first: int) -> Place:
    """Path in the input of support ``index`` of `Model.support`; from ``first`` on, these are tables [[contact]]."""
    return ("support", index) if index < first else ("contact", index - first)
