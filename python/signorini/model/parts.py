"""Models of several plates: each plate by itself, as a model of its own, and where two of them are on one another."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, Literal, Protocol, Self, TypeVar

from signorini.errors import InputError, Place, unknown
from signorini.model.base import Complaint, OnPlate
from signorini.model.material import Material
from signorini.model.places import Arc, Area, Form
from signorini.model.plate import MeshOptions, MeshPlate, OutlinedPlate, Plate
from signorini.model.problems import describe
from signorini.model.support import Support
from signorini.shapes.outlines import Contour

ON_PLATES = ("zone", "support", "load", "moving", "probe", "section", "strip", "profile")
"""Tables of what is on one plate."""
_ALIKE = 1e-9
"""Part of a plate's area by which what two plates share may miss it and be all of it: the rounding of their corners."""
_TURNED: Mapping[str | None, Literal["down", "up"]] = {"down": "up", "up": "down"}


class Whole(Protocol):
    """What a model of plates has."""

    @property
    def title(self) -> str:
        """Its title."""

    @property
    def plate(self) -> Plate:
        """Its plate, if it has one."""

    @property
    def plates(self) -> Mapping[str, Plate]:
        """Several plates by name."""

    @property
    def mesh(self) -> MeshOptions:
        """How finely plates are meshed that do not say it."""

    @property
    def material(self) -> Material:
        """What plates are of that do not say it."""

    @property
    def support(self) -> tuple[Support, ...]:
        """Supports, and behind them contacts."""

    @property
    def contact(self) -> tuple[Support, ...]:
        """Contacts between plates."""

    @property
    def effective_combinations(self) -> object:
        """Every combination."""

    def varied(self, **tables: object) -> Self:
        """A copy with other tables."""

    def complaints_of_plate(self) -> Iterator[Complaint]:
        """What is wrong with a plate and what is on it."""


M = TypeVar("M", bound=Whole)


@dataclass(frozen=True)
class Part(Generic[M]):
    """One of several plates: a model of its own, whose supports are those of the plate and those between it and others.

    ``numbers`` say which of the whole model's tables its own are, by key.
    """

    name: str
    whole: M
    numbers: Mapping[str, tuple[int, ...]]

    @cached_property
    def model(self) -> M:
        """The plate by itself."""
        whole, plate = self.whole, self.whole.plates[self.name]
        tables: dict[str, object] = {
            key: tuple(getattr(whole, key)[at] for at in own) for key, own in self.numbers.items()
        }
        tables["support"] = tuple(_seen_from(whole, whole.support[at], self.name) for at in self.numbers["support"])
        own = {key: getattr(plate, key) for key in self._own}
        title = ", ".join(part for part in (whole.title, self.name) if part)
        # Combinations name the cases of all plates; a copy keeps what is computed of them.
        _ = whole.effective_combinations
        return whole.varied(**tables, **own, plate=plate, plates={}, contact=(), title=title)

    @property
    def _own(self) -> tuple[str, ...]:
        """Tables that stand in the plate."""
        return tuple(key for key in ("mesh", "material") if getattr(self.whole.plates[self.name], key) is not None)

    def place(self, place: Place) -> Place:
        """Where in the whole model a place of this one is."""
        key, *rest = place or ("",)
        if key == "plate" or key in self._own:
            return ("plates", self.name, *(rest if key == "plate" else place))
        if key in self.numbers and rest and isinstance(rest[0], int):
            number, first = self.numbers[str(key)][rest[0]], len(self.whole.support) - len(self.whole.contact)
            return (*(_place_of(number, first) if key == "support" else (key, number)), *rest[1:])
        return place


def parts_of(model: M) -> tuple[Part[M], ...]:
    """The plates of a model, each by itself; none where there is one plate alone."""
    on = {key: [_plates_of(one) for one in getattr(model, key)] for key in ON_PLATES}
    return tuple(
        Part(name, model, {key: tuple(at for at, of in enumerate(each) if name in of) for key, each in on.items()})
        for name in model.plates
    )


def _plates_of(one: OnPlate) -> tuple[str, ...]:
    """The plates that a table is of."""
    if isinstance(one, Support) and one.between is not None:
        return one.between
    return () if one.plate is None else (one.plate,)


def _seen_from(model: Whole, support: Support, name: str) -> Support:
    """A support as one of its plates has it: one between two plates acts on the lower one the other way."""
    if support.between is None:
        return support
    upper, lower = support.between
    area = support.area if support.area != "all" else _shared(model, name, upper if name == lower else lower)
    resists = support.resists if name == upper else _TURNED.get(support.resists, support.resists)
    return support.model_copy(update={"area": area, "resists": resists})


def _shared(model: Whole, name: str, other: str) -> Area | Literal["all"]:
    """The area that a plate shares with another: "all" if that is all of it."""
    both = [model.plates[one] for one in (name, other)]
    if any(isinstance(one, MeshPlate) for one in both):
        raise InputError(
            f'found "all" between plates of which one is read from a file ("{name}" or "{other}"). Say where they are '
            "on one another, with a rectangle, a circle or a polygon."
        )
    # Only several plates need shapely.
    import shapely

    own, beside = both
    assert isinstance(own, OutlinedPlate) and isinstance(beside, OutlinedPlate)
    mine, theirs = (
        shapely.Polygon(outline, holes)
        for outline, *holes in ([contour.points() for contour in one.contours] for one in (own, beside))
    )
    shared = shapely.intersection(mine, theirs)
    slack = _ALIKE * mine.area
    pieces = [one for one in shapely.get_parts(shared) if shapely.area(one) > slack]
    if not pieces:
        raise InputError(f'"{name}" and "{other}" are nowhere on one another. Move one of them, or leave this out.')
    if len(pieces) > 1:
        raise InputError(
            f'"{name}" and "{other}" are on one another in {len(pieces)} places apart. Give each of them a table of '
            "its own, with its area."
        )
    if mine.area - pieces[0].area <= slack:
        return "all"
    if theirs.area - pieces[0].area <= slack:
        outline, holes = beside.contours[0], beside.contours[1:]
        return Area(polygon=_corners(outline), holes=tuple(Form(polygon=_corners(hole)) for hole in holes))
    drawn = (pieces[0].exterior, *pieces[0].interiors)
    rings = [[(x, y) for x, y in shapely.get_coordinates(ring)[:-1].tolist()] for ring in drawn]
    return Area(polygon=rings[0], holes=tuple(Form(polygon=ring) for ring in rings[1:]))


def _corners(contour: Contour) -> tuple[tuple[float, float] | Arc, ...]:
    """The corners of an outline as a polygon has them."""
    ends = [after if through is None else Arc(through=through, to=after) for _, through, after in contour.sides]
    # A straight last side leads back to the first corner of itself.
    return (contour.corners[0], *(ends if isinstance(ends[-1], Arc) else ends[:-1]))


def plate_complaints(model: Whole) -> Iterator[Complaint]:
    """What is wrong with where tables say they are, and with each plate by itself."""
    given = bool(model.plates)
    if given and model.plate is not None:
        yield ("plates",), "found both [plate] and [plates]; give one."
        return
    if not given:
        for key in ("mesh", "material"):
            if getattr(model.plate, key) is not None:
                yield ("plate", key), f"it is a table of its own: [{key}]."
    for name in model.plates:
        if not re.fullmatch(r"[A-Za-z0-9_-]{1,40}", name):
            yield (
                ("plates", name),
                f"found the name {describe(name)}; files have it: take up to 40 letters, digits, - or _.",
            )
    wrong = [*_of_tables(model), *_in_circles(model)]
    yield from wrong
    if len({plate.element for plate in model.plates.values()}) > 1:
        yield ("plates",), "found plates of different elements; all have one, mitc9 or q8r."
    if given and model.mesh.accuracy is not None:
        yield ("mesh", "accuracy"), "found accuracy beside several plates; refine their meshes by hand, as ± says."
    for name, plate in model.plates.items():
        for key in plate.mesh.present(("accuracy", "error")) if plate.mesh is not None else ():
            yield ("plates", name, "mesh", key), f"found {key} of one plate. [mesh] error is of all; refine by hand."
    if wrong or not given:
        return
    first = len(model.support) - len(model.contact)
    for index, support in enumerate(model.support):
        if support.between is not None and support.area == "all":
            try:
                _shared(model, *support.between)
            except InputError as error:
                yield (*_place_of(index, first), "area"), error.message
                return
    for part in parts_of(model):
        yield from ((part.place(path), message) for path, message in part.model.complaints_of_plate())


def _of_tables(model: Whole) -> Iterator[Complaint]:
    """Tables that name no plate where they have to, or one that is not there."""
    first = len(model.support) - len(model.contact)
    for key in ON_PLATES:
        for index, one in enumerate(getattr(model, key)):
            place = _place_of(index, first) if key == "support" else (key, index)
            of = _plates_of(one)
            if not model.plates and of:
                where = "plate" if one.plate is not None else "between"
                yield (*place, where), f"found {where}, and there is one plate. Leave it out, or give [plates]."
            elif model.plates and not of:
                yield (*place, "plate"), f"'plate' is missing. Name one of the plates: {', '.join(model.plates)}."
            for name in of if model.plates else ():
                if name not in model.plates:
                    where = "plate" if one.plate is not None else "between"
                    yield (*place, where), unknown("plate", name, model.plates, "This model")


def _in_circles(model: Whole) -> Iterator[Complaint]:
    """Plates that lie on each other."""
    first, below = len(model.support) - len(model.contact), dict[str, set[str]]()
    for index, (upper, lower) in ((at, one.between) for at, one in enumerate(model.support) if one.between):
        if upper in below.get(lower, ()):
            yield (
                (*_place_of(index, first), "between"),
                f'found "{upper}" on "{lower}", on which it lies itself. Name the upper plate first, then the lower.',
            )
            return
        beneath = {lower} | below.get(lower, set())
        for name in [upper, *(one for one, of in below.items() if upper in of)]:
            below[name] = below.get(name, set()) | beneath


def _place_of(index: int, first: int) -> Place:
    """Where a support stands, of which contacts are from the first on."""
    return ("support", index) if index < first else ("contact", index - first)
