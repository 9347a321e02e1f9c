"""The whole input: class `Model`, checks that involve several of its tables, and `validate`."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from itertools import chain
from pathlib import PurePath
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeVar

import tomli_w
from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    ValidationError,
    ValidationInfo,
    field_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError

from signorini.base.arguments import checked
from signorini.base.provenance import Provenance
from signorini.design.combining import count
from signorini.design.en1992_bending import Bars
from signorini.errors import InputError, Place, unknown
from signorini.expression import Expression
from signorini.model.base import Complaint, Named, Table, Text
from signorini.model.cases import MOST_GENERATED, Case, Positions, actions_of, complaints_of, missing_in
from signorini.model.check import Check
from signorini.model.combination import Choice, Combination, Combinations, Expanded, FrozenMapping, Product, products
from signorini.model.load import Load, Moving, Probe
from signorini.model.material import Material, Zone, constant_thickness
from signorini.model.output import MAX_FULL_RESULTS, Output, Profile, Section, Strip
from signorini.model.parts import Part, parts_of, plate_complaints
from signorini.model.plate import AnyPlate, MeshOptions, MeshPlate
from signorini.model.problems import TOP, as_list, explained, tables_of
from signorini.model.punching import ColumnAt, Punching, columns_of
from signorini.model.reinforcement import Reinforcement
from signorini.model.report import Report
from signorini.model.support import Contact, Support
from signorini.model.tightening import Tightening
from signorini.model.where import Acting, Located, mesh_follows, one_of
from signorini.shapes import Region

_MAX_ELEMENTS = 10_000_000
"""Largest number of elements of a regular mesh; a larger number is assumed to be a typing error."""
_MAX_COMBINATIONS = 1_000_000
"""Largest number of combinations of a model; more are refused."""
_MAX_POSITIONS = 2000
"""Largest total number of positions of all moving loads; each position is a load case."""

_COUNTED = ("support", "contact", "load", "combination", "zone")
"""Keys of the lists of tables whose lengths ``repr(model)`` shows."""

_HasName = TypeVar("_HasName", bound=Named)


class Units(Table):
    """Labels of the input's consistent units, which the output shows; no values are converted."""

    length: Text = Field(default="", description='Label of the unit of length, such as "m".')
    force: Text = Field(default="", description='Label of the unit of force, such as "N".')

    def force_by_length(self, power: int) -> str:
        """Label of the unit force × length^``power``, -3 ≤ ``power`` ≤ 1; empty if a label is missing."""
        if not self.force or (power and not self.length):
            return ""
        length = self.length
        return self.force + {-3: f"/{length}³", -2: f"/{length}²", -1: f"/{length}", 0: "", 1: f" {length}"}[power]


class Solver(Table):
    """Options of the solver of the contact problem."""

    method: Literal["auto", "lemke", "active_set"] = Field(
        default="auto",
        description="Method that is tried first, before others; auto chooses by the number and kind of contact points.",
    )


def _named(tables: tuple[_HasName, ...]) -> tuple[_HasName, ...]:
    """Give tables without a name the default name: type and number, such as "support 1"."""
    return tuple(
        table if table.name else table.model_copy(update={"name": f"{type(table).__name__.lower()} {position}"})
        for position, table in enumerate(tables, start=1)
    )


def _require_plate(plate: object, info: ValidationInfo) -> object:
    """Refuse a model without [plate] and [plates]; if [plates] is invalid, only its own error is reported."""
    if plate is None and not info.data.get("plates", True):
        raise PydanticCustomError("missing", "missing")
    return plate


def _for_toml(value: Any, place: str) -> Any:
    """Convert file paths to text and omit keys with the value None: TOML can represent neither."""
    match value:
        case Mapping():
            items = ((key, item) for key, item in value.items() if item is not None)
            return {key: _for_toml(item, f"{place}.{key}" if place else key) for key, item in items}
        case list() | tuple():
            return [_for_toml(item, f"{place}[{number}]") for number, item in enumerate(value, 1)]
        case str() | int() | float():
            return value
        case PurePath():
            return str(value)
    name = getattr(value, "__qualname__", type(value).__name__)
    raise InputError(f"found {name}; TOML has no functions. Give numbers, an expression or a table.", place=place)


def acts(tables: Mapping[str, Any]) -> bool:
    """Whether the plate has an action other than [[load]]: a moving load, preload, settlement or rotation."""
    supports = tables.get("support")
    values = (
        as_list((support if isinstance(support, Mapping) else vars(support)).get(key))
        for support in (supports if isinstance(supports, list | tuple) else ())
        for key in ("preload", "settlement", "rotation")
        if isinstance(support, Mapping | Support)
    )
    return bool(tables.get("moving") or tables.get("tightening")) or any(
        value not in (None, 0, Expression(0.0)) for value in values
    )


def _without_required_load(schema: dict[str, Any]) -> None:
    """In the JSON Schema, require exactly one of plate and plates, and at least one load or other action."""
    del schema["required"]
    schema["oneOf"] = one_of(("plate", "plates"))
    schema["anyOf"] = one_of(("load", "moving", "support", "tightening"))


class Model(Table):
    """A plate, its supports and its loads, with the tables and keys of the input file.

    Examples
    --------
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
    ...     support=[{"at": [[1, 1], [9, 1], [5, 9]], "resists": "down"}],
    ...     load=[{"pressure": 2e3}],
    ... )
    >>> model.support[0].name, model.load_cases
    ('support 1', ('load',))
    """

    model_config = ConfigDict(json_schema_extra=_without_required_load)

    title: Text = Field(default="", description="Title of the calculation.")
    units: Units = Field(default=Units(), description="Labels of the units, for the output.")
    material: Material = Field(
        default=Material(), description="The plate's material; required unless stiffness is given for all sections."
    )
    plates: Annotated[Mapping[Text, AnyPlate], AfterValidator(FrozenMapping), PlainSerializer(dict)] = Field(
        default_factory=lambda: FrozenMapping({}),
        description="Several plates by name, in place of plate; in other tables the key plate names the plate.",
    )
    if TYPE_CHECKING:
        plate: AnyPlate
    else:  # In a model of several plates ``plate`` is None; the model of each entry of ``parts`` has a plate.
        plate: Annotated[AnyPlate | None, BeforeValidator(_require_plate)] = Field(
            default=None, validate_default=True, description="The plate's outline, thickness and finite element."
        )
    zone: tuple[Zone, ...] = Field(
        default=(), description="Parts of the plate with another thickness, material or stiffness."
    )
    mesh: MeshOptions = Field(default=MeshOptions(), description="Mesh options.")
    support: Annotated[tuple[Support, ...], AfterValidator(_named)] = Field(default=(), description="The supports.")
    contact: Annotated[tuple[Contact, ...], AfterValidator(_named)] = Field(
        default=(), description="Contacts between a plate and a plate below it."
    )
    load: tuple[Load, ...] = Field(description="The loads, at least one.")
    cases: Annotated[Mapping[Text, Case], AfterValidator(FrozenMapping), PlainSerializer(dict)] = Field(
        default_factory=lambda: FrozenMapping({}),
        description="Load cases as actions, by name; needed for combinations by a design code.",
    )
    combination: Annotated[tuple[Combination, ...], AfterValidator(_named)] = Field(
        default=(), description='Combinations of load cases; default: one named "all", with factor 1 for every case.'
    )
    tightening: tuple[Tightening, ...] = Field(default=(), description="Rounds of bolt tightening, in this order.")
    moving: tuple[Moving, ...] = Field(default=(), description="Loads that move along a line.")
    probe: tuple[Probe, ...] = Field(default=(), description="Points at which results are reported.")
    section: Annotated[tuple[Section, ...], AfterValidator(_named)] = Field(
        default=(), description="Cuts through the plate, whose section forces are reported."
    )
    strip: Annotated[tuple[Strip, ...], AfterValidator(_named)] = Field(
        default=(), description="Strips, whose moments averaged over the width are reported."
    )
    profile: Annotated[tuple[Profile, ...], AfterValidator(_named)] = Field(
        default=(), description="Lines and circles along which fields and the pressure are reported."
    )
    punching: tuple[Punching, ...] = Field(default=(), description="Columns that are checked for punching.")
    check: Annotated[tuple[Check, ...], AfterValidator(_named)] = Field(
        default=(), description="Checks of fields and numbers against limits."
    )
    reinforcement: Reinforcement | None = Field(
        default=None, description="Code, strengths and positions of bars, for the required reinforcement."
    )
    output: Output = Field(default=Output(), description="Results to compute and write for each combination.")
    solver: Solver = Field(default=Solver(), description="Options of the contact solver.")
    report: Report = Field(default=Report(), description="Title block and language of the report.")

    @model_validator(mode="before")
    @classmethod
    def _without_loads(cls, data: Any) -> Any:
        """Allow a model without [[load]] if it has another action, see `acts`."""
        if not isinstance(data, Mapping) or as_list(data.get("load")) not in (None, [], ()):
            return data
        rest = {key: value for key, value in data.items() if key != "load"}
        return rest | {"load": ()} if acts(data) else rest

    def model_post_init(self, context: Any) -> None:
        """Append the contacts to the supports, and mark supports that [[tightening]] names as bolts."""
        bolts = {bolt_round.support for bolt_round in self.tightening}
        supports = self._without_contacts(self.support)
        marked = (support.as_bolt() if support.name in bolts else support for support in supports)
        self.__dict__["support"] = (*marked, *self.contact)

    def __repr__(self) -> str:
        """Show the title and the number of tables of each kind."""
        counts = [f"{count} {key}" for key in _COUNTED if (count := len(getattr(self, key)))]
        return f"Model({', '.join([repr(self.title)] * bool(self.title) + counts)})"

    def to_toml(self) -> str:
        """Write the model as TOML text, which `signorini.loads` reads as an equal model; file paths are unchanged.

        Raises
        ------
        InputError
            If a stiffness is a Python function.

        Examples
        --------
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "disc", "radius": 2, "thickness": "0.2 + 0.01*x"},
        ...     support=[{"edge": "rim", "fix": "simple"}],
        ...     load=[{"pressure": 2e3}],
        ... )
        >>> model.to_toml().splitlines()[8:12]
        ['[plate]', 'thickness = "0.2 + 0.01*x"', 'shape = "disc"', 'radius = 2.0']
        """
        text = tomli_w.dumps(_for_toml(self.model_dump(exclude_unset=True), ""))
        # Each array without tables is joined to one line; this cannot change strings, as they have no line breaks.
        text = re.sub(r"(?<!}),\n *\]", "]", text)
        return re.sub(r"(\[|, ?)\n +(?=[^ {])", lambda match: match[1].rstrip() + " " * (match[1] != "["), text)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy the model; with ``update``, the copy is not its input file and recomputes the combinations."""
        copy = super().model_copy(update=update, deep=deep)
        for key in self._cached().keys() - {"_path"} if update else ():
            del copy.__dict__[key]
        return copy

    def varied(self, **tables: object) -> Self:
        """Copy the model with other tables as a variant of its input; the variant keeps input file and combinations."""
        copy = self.model_copy(update=tables)
        copy.__dict__.update({"_original": self} | self._cached())
        if "combination" in tables:
            for key in ("effective_combinations", "expanded"):
                copy.__dict__.pop(key, None)
        return copy

    @property
    def original(self) -> Model:
        """The model as read from the input, if this model is a variant of it (see `varied`); else this model."""
        original: Model = self.__dict__.get("_original", self)
        return original

    @property
    def part(self) -> str:
        """Name of the plate, if this is the model of one of several plates; else empty."""
        name: str = self.__dict__.get("_part", "")
        return name

    def _cached(self) -> dict[str, Any]:
        """Entries of ``__dict__`` that are not keys of the input: cached properties, input file, original model."""
        return {key: value for key, value in self.__dict__.items() if key not in type(self).model_fields}

    def read_from(self, file: str, sha256: str) -> Self:
        """Copy the model; the copy knows the path ``file`` and the SHA-256 of its input file."""
        copy = self.model_copy()
        copy.__dict__.update({"_file": (os.path.basename(file), sha256), "_path": file})
        return copy

    @cached_property
    def provenance(self) -> Provenance:
        """Name and SHA-256 of the input file, and the input as JSON; for a variant, those of its original model."""
        original = self.original
        file, path = (original.__dict__.get(key) for key in ("_file", "_path"))
        return Provenance.of(original.model_dump(exclude_unset=True), file, path)

    @field_serializer("support")
    def _without_contacts(self, supports: tuple[Support, ...]) -> tuple[Support, ...]:
        return tuple(support for support in supports if not isinstance(support, Contact))

    @property
    def parts(self) -> tuple[Part[Model], ...]:
        """Each plate of a model of several plates as a `Part`; empty for a model of one plate."""
        return parts_of(self)

    @property
    def load_cases(self) -> tuple[str, ...]:
        """Names of the load cases of [[load]] in the order of the input, followed by the load cases of preloads."""
        return tuple(dict.fromkeys([*(load.case for load in self.load), *self.preload_cases]))

    @property
    def preload_cases(self) -> tuple[str, ...]:
        """Names of the load cases that multiply bolt forces, each once, in the order of the `rounds`."""
        return tuple(dict.fromkeys(each.case for each in self.rounds if each.case is not None))

    @property
    def rounds(self) -> tuple[Tightening, ...]:
        """Rounds of tightening: one for each support with a preload, followed by the rounds of [[tightening]]."""
        preloaded = (
            Tightening.model_construct(support=support.name, force=support.preload, case=support.preload_case)
            for support in self.support
            if support.preload is not None
        )
        return (*preloaded, *self.tightening)

    def round_factors(self, factors: Mapping[str, float]) -> tuple[float, ...]:
        """Factors (t,) of the bolt forces in the t rounds of `rounds`; empty if all are 0.

        ``factors`` are the factors of load cases in a combination.
        """
        of_rounds = tuple(1.0 if each.case is None else factors.get(each.case, 0.0) for each in self.rounds)
        return of_rounds if any(of_rounds) else ()

    @property
    def materials(self) -> tuple[Material, ...]:
        """The materials of all plates and zones."""
        plates = tuple(plate.material or self.material for plate in self.plates.values()) or (self.material,)
        return (*plates, *(zone.material for zone in self.zone if zone.material is not None))

    @property
    def divisions(self) -> tuple[int, int] | None:
        """Numbers of elements of a regular mesh; None for an unstructured mesh.

        A mesh is regular if `mesh.divisions` is given, or if sides of a regular mesh can follow all borders of zones
        and lines of supports and loads, at which moments or shears jump.
        """
        regular = self.mesh.divisions is not None or follows_in_rows(self)
        return self.plate.divisions(self.mesh) if regular and not isinstance(self.plate, MeshPlate) else None

    @property
    def young(self) -> float:
        """Largest Young's modulus of all materials and, for sections given by stiffness, of equivalent solid plates."""
        moduli = [material.young for material in self.materials if material.is_elastic]
        for part in (*(self.plates.values() or (self.plate,)), *self.zone):
            if part.stiffness is not None:
                moduli.append(part.stiffness.equivalent[1])
        return max(moduli)

    @property
    def positions(self) -> Positions:
        """Map from each moving load's case to the load cases of its positions."""
        return {moving.case: tuple(moving.positions) for moving in self.moving}

    @property
    def columns(self) -> tuple[ColumnAt, ...]:
        """The columns that [[punching]] checks."""
        return columns_of(self.punching, self.support, self.load)

    @cached_property
    def refused(self) -> tuple[Complaint, ...]:
        """Problems of [cases] and of combinations by a design code; empty in a valid model."""
        return tuple(self._case_complaints())

    @cached_property
    def expanded(self) -> tuple[tuple[Expanded, ...], ...]:
        """Combinations of each table [[combination]]; see `products`."""
        if self.refused or sum(moving.count for moving in self.moving) > _MAX_POSITIONS:
            return ((),) * len(self.combination)
        shared = Counter((table.generate, rule) for table in self.combination for rule in table.rule or ())
        named = [any(shared[table.generate, rule] > 1 for rule in table.rule or ()) for table in self.combination]
        tables, positions = zip(self.combination, named, strict=True), self.positions
        return tuple(tuple(products(table, positions, self.cases, prefixed)) for table, prefixed in tables)

    def factors_of(self, case: str) -> Iterator[tuple[float, Place]]:
        """Yield the factors of a load case in the tables [[combination]], each with its path in the input."""
        for index, (table, every) in enumerate(zip(self.combination, self.expanded, strict=True)):
            generated = {(one.factors or {}).get(case, 0.0) for one in Combinations(every if table.rule else ())}
            for factor in sorted(table.factors_of(case) | generated):
                yield factor, ("combination", index, *table.cases.get(case, ()))

    @cached_property
    def effective_combinations(self) -> Combinations:
        """All combinations; those of the key ``generate`` are made when accessed.

        Without [[combination]] the only combination is "all", with factor 1 for every case; with moving loads there is
        one for each position. Actions without a case, such as settlements, act in every combination.
        """
        if self.combination:
            return Combinations(tuple(chain.from_iterable(self.expanded)))
        slots = tuple(tuple(Choice(name, name, 1.0) for name in names) for names in self.positions.values())
        return Combinations((Product("all", tuple((case, 1.0) for case in self.load_cases), slots),))

    @cached_property
    def bars(self) -> Bars | None:
        """Design data of the reinforced section, see `Reinforcement.section`; None without [reinforcement]."""
        units, own = self.units, self.reinforcement
        return None if own is None else own.section(units.length, units.force)

    @property
    def footprints(self) -> tuple[tuple[tuple[float, float], Region], ...]:
        """Pairs of a point and its footprint, for all supports at points with footprints."""
        places = (support.where for support in self.support if support.at)
        return tuple(pair for where in places for pair in zip(where.points, where.footprints, strict=False))

    @property
    def at_faces(self) -> bool:
        """Whether bars in columns are designed for the moments at the column faces; see `Reinforcement.face`."""
        return self.reinforcement is not None and self.reinforcement.face

    @property
    def tabulated(self) -> bool:
        """Whether combinations are rows of one table, and only some have full results; see `Output.combinations`."""
        option = self.output.combinations
        return option == "table" or (option == "auto" and len(self.effective_combinations) > MAX_FULL_RESULTS)

    @property
    def has_limits(self) -> bool:
        """Whether the reaction of a support is bounded, by a limit or by a law with a horizontal end."""
        return any(support.can_yield for support in self.support)

    @property
    def estimated(self) -> bool:
        """Whether the command line estimates mesh errors (±); by default it does, unless a mesh is from a file."""
        plates = self.plates.values() or (self.plate,)
        return not any(isinstance(plate, MeshPlate) for plate in plates) if self.mesh.error is None else self.mesh.error

    def _complaints(self) -> Iterator[Complaint]:
        for key in ("support", "combination", "section", "strip", "profile", "check"):
            yield from _repeated(key, [table.name for table in getattr(self, key)])
        yield from plate_complaints(self)
        if self.plate is not None:
            yield from self.complaints_of_plate()
        yield from self._moving_complaints()
        yield from self.refused
        yield from self._combination_complaints()
        yield from self._preload_complaints()
        for index, punching in enumerate(self.punching):
            complaints = punching.complaints_of(self.support, self.load, self.units, self.reinforcement is not None)
            yield from ((("punching", index, *path), message) for path, message in complaints)
        cases = tuple(dict.fromkeys([*(load.case for load in self.load), *self.positions]))
        for index, check in enumerate(self.check):
            complaints = check.complaints_of(cases, self.effective_combinations, self.cases)
            yield from ((("check", index, *path), message) for path, message in complaints)
        yield from self._reinforcement_complaints()

    def _reinforcement_complaints(self) -> Iterator[Complaint]:
        if self.reinforcement is not None:
            found = self.reinforcement.complaints_in(self.units.length, self.units.force)
            yield from ((("reinforcement", *place), message) for place, message in found)
            return
        for position, name in enumerate(self.output.envelope):
            if name.startswith("as_"):
                yield ("output", "envelope", position), f'"{name}" needs [reinforcement].'

    def complaints_of_plate(self) -> Iterator[Complaint]:
        """Yield the problems of a plate and of its tables."""
        yield from self._mesh_complaints()
        yield from self._edge_complaints()
        yield from self._node_complaints()
        yield from self._section_complaints()
        for index, load in enumerate(self.load):
            if load.self_weight and self.material.unit_weight is None:
                why = "self_weight needs unit_weight in [material]."
                yield ("load", index, "self_weight"), why
        for index, zone in enumerate(self.zone if any(load.self_weight for load in self.load) else ()):
            if zone.material is not None and zone.material.unit_weight is None:
                why = "a self_weight load needs the unit_weight of this material."
                yield ("zone", index, "material"), why

    def _section_complaints(self) -> Iterator[Complaint]:
        """Yield a problem for each material without moduli that a solid section of the plate or a zone has."""
        if self.plate.stiffness is not None:
            yield from ((("plate", *path), message) for path, message in constant_thickness(self.plate.thickness))
        parts = (
            (("material",), self.plate, self.material),
            *((("zone", i, "material"), z, z.material) for i, z in enumerate(self.zone)),
        )
        for number, (place, part, material) in enumerate(parts):
            if material is None or material.is_elastic:
                continue
            used_later = any(zone.is_solid and zone.material is None for zone in self.zone[number:])
            if part.stiffness is None or used_later:
                yield from (((*place, *path), message) for path, message in material.missing())

    def _mesh_complaints(self) -> Iterator[Complaint]:
        if isinstance(self.plate, MeshPlate):
            refine = ["refine"] if self.mesh.refine else []
            for key in [*self.mesh.present(("divisions", "size", "accuracy")), *refine]:
                yield ("mesh", key), f"{key} is not allowed with a mesh file, which contains the elements."
            return
        divisions = self.divisions
        if divisions is None:
            if self.mesh.divisions is not None:
                shape = self.plate.shape
                why = "a polygon" if shape == "polygon" else "holes" if self.plate.holes else "refine"
                yield ("mesh", "divisions"), f"divisions are for a regular mesh; with {why} give size."
            return
        (first, second), min_divisions = divisions, self.plate.min_divisions[1]
        if second < min_divisions:
            yield ("mesh", "divisions"), f"found {second} elements around; this plate needs at least {min_divisions}."
        if first * second > _MAX_ELEMENTS:
            key = "size" if self.mesh.size is not None else "divisions"
            yield (
                ("mesh", key),
                f"found {first:.3g} by {second:.3g} elements; at most {_MAX_ELEMENTS:.0e} are allowed.",
            )

    def _moving_complaints(self) -> Iterator[Complaint]:
        yield from _repeated("moving", [moving.case for moving in self.moving], key="case")
        for index, moving in enumerate(self.moving):
            if moving.case in self.load_cases:
                where = "a preload" if moving.case in self.preload_cases else "[[load]]"
                why = f'"{moving.case}" is also a case of {where}; give the moving load another case.'
                yield ("moving", index, "case"), why
        total = sum(moving.count for moving in self.moving)
        if total > _MAX_POSITIONS:
            longest = max(range(len(self.moving)), key=lambda index: self.moving[index].count)
            yield (
                ("moving", longest, "step"),
                f"the moving loads have {total} positions; at most {_MAX_POSITIONS} are allowed. Use a larger step.",
            )

    def _case_complaints(self) -> Iterator[Complaint]:
        if sum(moving.count for moving in self.moving) > _MAX_POSITIONS:
            return
        positions = self.positions
        known = (*self.load_cases, *positions)
        if wrong := [*complaints_of(self.cases, known, positions)]:
            yield from wrong
            return
        for index, combination in enumerate(self.combination):
            code = combination.generate
            if code != "en1990" and code != "asce7":
                continue
            if missing := missing_in(self.cases, known, code):
                yield ("combination", index, "generate"), missing
                continue
            actions = actions_of(self.cases, positions, code)
            counts = {name: count(rules, actions) for name, rules in combination.rules.items()}
            for name in (name for name, number in counts.items() if not number):
                yield ("combination", index, "rule"), f'"{name}" gives no combination of the load cases in [cases].'
            if (total := sum(counts.values())) > MOST_GENERATED:
                yield (
                    ("combination", index),
                    f"found {total} combinations; at most {MOST_GENERATED} are allowed. Put cases that do not act "
                    "together into one group, or give cases from one source the key with.",
                )

    def _combination_complaints(self) -> Iterator[Complaint]:
        if sum(moving.count for moving in self.moving) > _MAX_POSITIONS:
            return
        positions = self.positions
        fixed = (*self.load_cases, *(name for names in positions.values() for name in names))
        total = 0
        for index, combination in enumerate(self.combination):
            valid = True
            for case, place in combination.cases.items():
                if case in positions and combination.generate is None:
                    valid = False
                    yield (
                        ("combination", index, *place),
                        f'"{case}" is a moving load. Write generate = "positions" for a combination of each '
                        f'position, or name one position, from "{positions[case][0]}" to "{positions[case][-1]}".',
                    )
                elif case not in fixed and case not in positions:
                    valid = False
                    yield ("combination", index, *place), unknown("case", case, (*self.load_cases, *positions))
            if combination.generate == "positions" and not positions.keys() & combination.cases.keys():
                yield ("combination", index, "factors"), 'generate = "positions" needs a case of [[moving]] in factors.'
            if valid:
                total += sum(map(len, self.expanded[index]))
            if total > _MAX_COMBINATIONS:
                yield (
                    ("combination", index),
                    f"found {total:.3g} combinations up to this table; at most {_MAX_COMBINATIONS} are allowed. Use "
                    "fewer cases or factors, or list cases that do not act together in 'exclusive'.",
                )
                return
        yield from self._name_complaints()

    def _preload_complaints(self) -> Iterator[Complaint]:
        of_loads = {load.case for load in self.load}
        by_name = {support.name: support for support in self.support}
        for index, bolt_round in enumerate(self.tightening):
            if bolt_round.support not in by_name:
                yield ("tightening", index, "support"), unknown("support", bolt_round.support, tuple(by_name))
                continue
            for place, message in bolt_round.complaints_of(by_name[bolt_round.support]):
                yield ("tightening", index, *place), message
        cases: list[tuple[Place, str | None]] = []
        cases += [(("support", index, "preload_case"), bolt.preload_case) for index, bolt in enumerate(self.support)]
        cases += [(("tightening", index, "case"), bolt_round.case) for index, bolt_round in enumerate(self.tightening)]
        for place, case in cases:
            if case in of_loads:
                yield place, f'"{case}" is also a case of [[load]]; give the preload another case.'
            elif case is not None and self.combination and next(self.factors_of(case), None) is None:
                why = f'no combination has the case "{case}", so the bolts would never be tightened.'
                yield place, f"{why} Add the case to a combination, or remove {place[-1]} for factor 1."
        for case in self.preload_cases:
            for factor, place in self.factors_of(case):
                if factor < 0.0:
                    yield place, f'found the factor {factor:g} of the preload "{case}"; it must not be negative.'

    def _name_complaints(self) -> Iterator[Complaint]:
        """Yield a problem for combination names that are generated twice, or unknown in ``output.fields``."""
        if any(combination.generate for combination in self.combination):
            taken: dict[str, int] = {}
            for index, expanded in enumerate(self.expanded):
                for name in Combinations(expanded).names():
                    if name in taken:
                        other = f"combination[{taken[name] + 1}]"
                        yield (
                            ("combination", index),
                            f'it generates the name "{name}", as does {other}; names must be unique.',
                        )
                        return
                    taken[name] = index
        if isinstance(self.output.fields, tuple) and self.output.fields:
            names = set(self.effective_combinations.names())
            for position, name in enumerate(self.output.fields):
                if name not in names:
                    examples = sorted(names)[:20]
                    yield (
                        ("output", "fields", position),
                        unknown("combination", name, examples, "This model, among others,"),
                    )

    def _edge_complaints(self) -> Iterator[Complaint]:
        names = self.plate.edge_names
        if names is None:
            return
        for place, item in self._located():
            for position, edge in enumerate(item.edge or ()):
                if edge not in names:
                    yield (*place, "edge", position), unknown("edge", edge, names, f"This {self.plate.shape}")
                elif whole := next((other for other in item.edge or () if edge.startswith(f"{other} ")), None):
                    why = f'"{edge}" is part of "{whole}", which is also listed. Remove one of them.'
                    yield (*place, "edge", position), why

    def _node_complaints(self) -> Iterator[Complaint]:
        for place, item in () if isinstance(self.plate, MeshPlate) else self._located():
            if isinstance(item, Acting) and item.nodes is not None:
                why = f"nodes belong to a mesh file, but the plate is a {self.plate.shape}. Give points with at."
                yield (*place, "nodes"), why

    def _located(self) -> Iterator[tuple[Place, Located]]:
        """Yield (path in the input, table) for each support, load and table of ``mesh.refine``."""
        yield from ((("support", index), support) for index, support in enumerate(self.support))
        yield from ((("load", index), load) for index, load in enumerate(self.load))
        yield from ((("mesh", "refine", index), refinement) for index, refinement in enumerate(self.mesh.refine))


def follows_in_rows(model: Model) -> bool:
    """Whether a regular mesh can follow all zones and lines; always true for `q8r`, which has no other meshes."""
    plate = model.plate
    if isinstance(plate, MeshPlate):
        return False
    size = plate.element_size(model.mesh)
    curves = (item.where.curve for item in supports_and_loads(model))
    lines = (curve for curve in curves if curve is not None and mesh_follows(curve, size))
    followed = *(zone.region for zone in model.zone), *lines
    return plate.element == "q8r" or all(map(plate.follows, followed))


def supports_and_loads(model: Model) -> tuple[Acting, ...]:
    """Return the supports, followed by the loads."""
    return (*model.support, *model.load)


def _repeated(table: str, names: list[str], key: str = "name") -> Iterator[Complaint]:
    first: dict[str, int] = {}
    for index, name in enumerate(names):
        if first.setdefault(name, index) != index:
            why = f'the name "{name}" is taken by {table}[{first[name] + 1}]; names must be unique.'
            yield (table, index, key), why


TOP.update(tables_of(Model))


@checked
def validate(data: Mapping[str, Any], *, source: str = "", line_of: Callable[[Place], int] | None = None) -> Model:
    """Validate nested mappings and lists, as parsed from an input file, and return the model.

    Parameters
    ----------
    data : mapping
        The tables, with the keys of the input file.
    source : str
        Name of the input file, for messages.
    line_of : callable, optional
        Returns the line of the file for a path of keys and positions, counted from 0.

    Returns
    -------
    Model

    Raises
    ------
    InputError
        Lists every problem with its place.

    Examples
    --------
    >>> validate({"material": {"E": 30e9, "nu": 0.5}, "plate": {"shape": "disc", "radius": 1, "thickness": 0.1},
    ...           "load": [{"pressure": 1}]})
    Traceback (most recent call last):
        ...
    signorini.errors.InputError: material.nu: found 0.5; it must be less than 0.5.
    """
    try:
        return Model.model_validate(data)
    except ValidationError as error:
        raise explained(error, Model, data, source, line_of) from None
