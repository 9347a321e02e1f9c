"""The model as a whole: what the engineer said, checked against itself; no arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
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
from signorini.errors import InputError, Place, unknown
from signorini.expression import Expression
from signorini.model.base import Complaint, Named, Table, Text
from signorini.model.combination import Choice, Combination, Combinations, FrozenMapping, Positions, Product, products
from signorini.model.load import Load, Moving, Probe
from signorini.model.material import Material, Zone, constant_thickness
from signorini.model.output import FEW, Output, Profile, Section, Strip
from signorini.model.parts import Part, parts_of, plate_complaints
from signorini.model.plate import AnyPlate, MeshOptions, MeshPlate
from signorini.model.problems import TOP, as_list, explained, tables_of
from signorini.model.support import Contact, Support
from signorini.model.tightening import Tightening
from signorini.model.where import Acting, Located, one_of, worth_following

_MOST_ELEMENTS = 10_000_000
_MOST_COMBINATIONS = 1_000_000
_MOST_POSITIONS = 2000

_LISTED = ("support", "contact", "load", "combination", "zone")
"""Tables that a model's short form counts."""

_HasName = TypeVar("_HasName", bound=Named)


class Units(Table):
    """Labels of the consistent units used; they appear in the output and change no number."""

    length: Text = Field(default="", description='Label of the unit of length, such as "m".')
    force: Text = Field(default="", description='Label of the unit of force, such as "N".')

    def force_by_length(self, power: int) -> str:
        """Unit of a force times a power of a length, from -3 to 1; empty where a label is missing."""
        if not self.force or (power and not self.length):
            return ""
        length = self.length
        return self.force + {-3: f"/{length}³", -2: f"/{length}²", -1: f"/{length}", 0: "", 1: f" {length}"}[power]


class Solver(Table):
    """Choice of the method that solves the contact problem."""

    method: Literal["auto", "lemke", "active_set"] = Field(
        default="auto", description="auto picks the method, and falls back without asking."
    )


def _named(tables: tuple[_HasName, ...]) -> tuple[_HasName, ...]:
    """Give every table that has no name its default one."""
    return tuple(
        table if table.name else table.model_copy(update={"name": f"{type(table).__name__.lower()} {position}"})
        for position, table in enumerate(tables, start=1)
    )


def _there(plate: object, info: ValidationInfo) -> object:
    """Miss a plate where there are no several; of those that are wrong it is not known."""
    if plate is None and not info.data.get("plates", True):
        raise PydanticCustomError("missing", "missing")
    return plate


def _for_toml(value: Any, place: str) -> Any:
    """Convert paths to text and omit None, which TOML does not have."""
    match value:
        case Mapping():
            items = ((key, one, f"{place}.{key}" if place else key) for key, one in value.items() if one is not None)
            return {key: _for_toml(one, where) for key, one, where in items}
        case list() | tuple():
            return [_for_toml(one, f"{place}[{number}]") for number, one in enumerate(value, 1)]
        case str() | int() | float():
            return value
        case PurePath():
            return str(value)
    name = getattr(value, "__qualname__", type(value).__name__)
    raise InputError(f"found {name}, which TOML does not have. Give numbers, an expression or a table.", place=place)


def acts(tables: Mapping[str, Any]) -> bool:
    """Whether tables of a model have an action beside loads: a moving load, a preload, a settlement, a rotation."""
    supports = tables.get("support")
    given = (
        as_list((one if isinstance(one, Mapping) else vars(one)).get(key))
        for one in (supports if isinstance(supports, list | tuple) else ())
        for key in ("preload", "settlement", "rotation")
        if isinstance(one, Mapping | Support)
    )
    return bool(tables.get("moving") or tables.get("tightening")) or any(
        value not in (None, 0, Expression(0.0)) for value in given
    )


def _without_required_load(schema: dict[str, Any]) -> None:
    """Let the schema have one of plate and plates, and no load where there are other actions."""
    del schema["required"]
    schema["oneOf"] = one_of(("plate", "plates"))
    schema["anyOf"] = one_of(("load", "moving", "support", "tightening"))


class Model(Table):
    """A plate, its supports and its loads: what the input file says, under the same names.

    Examples
    --------
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
    ...     support=[{"at": [[1, 1], [9, 1], [5, 9]], "resists": "down"}],
    ...     load=[{"pressure": 2e3}],
    ... )
    >>> model.support[0].name, model.cases
    ('support 1', ('load',))
    """

    model_config = ConfigDict(json_schema_extra=_without_required_load)

    title: Text = Field(default="", description="Title of the calculation.")
    units: Units = Field(default=Units(), description="Labels of the units, for the output.")
    material: Material = Field(
        default=Material(), description="The plate's material; needed unless stiffness says what the plate is."
    )
    plates: Annotated[Mapping[Text, AnyPlate], AfterValidator(FrozenMapping), PlainSerializer(dict)] = Field(
        default_factory=lambda: FrozenMapping({}),
        description="Several plates by name, in place of plate; what is on one of them says plate = its name.",
    )
    if TYPE_CHECKING:
        plate: AnyPlate
    else:  # Of several plates each has a model with a plate, see `parts`, and the whole has none.
        plate: Annotated[AnyPlate | None, BeforeValidator(_there)] = Field(
            default=None, validate_default=True, description="The plate's outline, thickness and element."
        )
    zone: tuple[Zone, ...] = Field(default=(), description="Parts of the plate that are made otherwise.")
    mesh: MeshOptions = Field(default=MeshOptions(), description="How finely the plate is meshed.")
    support: Annotated[tuple[Support, ...], AfterValidator(_named)] = Field(default=(), description="The supports.")
    contact: Annotated[tuple[Contact, ...], AfterValidator(_named)] = Field(
        default=(), description="Plates on one another."
    )
    load: tuple[Load, ...] = Field(description="The loads, at least one.")
    combination: Annotated[tuple[Combination, ...], AfterValidator(_named)] = Field(
        default=(), description='Combinations of load cases; none given: one named "all", every case at factor 1.'
    )
    tightening: tuple[Tightening, ...] = Field(
        default=(), description="Rounds in which bolts are tightened, from the first table to the last one."
    )
    moving: tuple[Moving, ...] = Field(default=(), description="Loads that move along a line.")
    probe: tuple[Probe, ...] = Field(default=(), description="Points where results are written out.")
    section: Annotated[tuple[Section, ...], AfterValidator(_named)] = Field(
        default=(), description="Lines along which the forces through the plate are written out."
    )
    strip: Annotated[tuple[Strip, ...], AfterValidator(_named)] = Field(
        default=(), description="Strips of which mean moments over their width are written out."
    )
    profile: Annotated[tuple[Profile, ...], AfterValidator(_named)] = Field(
        default=(), description="Lines and circles along which fields and the pressure are written out."
    )
    output: Output = Field(default=Output(), description="What is written of each combination.")
    solver: Solver = Field(default=Solver(), description="How the contact problem is solved.")

    @model_validator(mode="before")
    @classmethod
    def _without_loads(cls, data: Any) -> Any:
        """Let a model have no load where something else acts."""
        if not isinstance(data, Mapping) or as_list(data.get("load")) not in (None, [], ()):
            return data
        rest = {key: value for key, value in data.items() if key != "load"}
        return rest | {"load": ()} if acts(data) else rest

    def model_post_init(self, context: Any) -> None:
        """Put contacts among the supports, which they are, of two plates; a dump tells them apart again."""
        bolts = {bolt_round.support for bolt_round in self.tightening}
        alone = (support.as_bolt() if support.name in bolts else support for support in self._alone(self.support))
        self.__dict__["support"] = (*alone, *self.contact)

    def __repr__(self) -> str:
        """Count the tables."""
        tables = {key: getattr(self, key) for key in _LISTED}
        counts = [f"{len(of)} {key}" for key, of in tables.items() if of]
        return f"Model({', '.join([repr(self.title)] * bool(self.title) + counts)})"

    def to_toml(self) -> str:
        """Write the input as TOML text; `signorini.loads` reads it as an equal model. Paths of files are unchanged.

        Raises
        ------
        InputError
            If a stiffness is a function, which TOML does not have.

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
        return tomli_w.dumps(_for_toml(self.model_dump(exclude_unset=True), ""))

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy the model; with other tables it has neither the file nor the combinations of this one."""
        copy = super().model_copy(update=update, deep=deep)
        for key in self._beside_fields() if update else ():
            del copy.__dict__[key]
        return copy

    def varied(self, **tables: object) -> Self:
        """Copy the model with other tables for the program's own use: input file and combinations stay the same."""
        copy = self.model_copy(update=tables)
        copy.__dict__.update({"_asked": self} | self._beside_fields())
        if "combination" in tables:
            copy.__dict__.pop("effective_combinations", None)
        return copy

    @property
    def asked(self) -> Model:
        """The input, of which the program may have made this model."""
        asked: Model = self.__dict__.get("_asked", self)
        return asked

    def _beside_fields(self) -> dict[str, Any]:
        """What is computed of the fields, the input file (``_file``), and the model before the program changed it."""
        return {key: value for key, value in self.__dict__.items() if key not in type(self).model_fields}

    def read_from(self, file: str, sha256: str) -> Self:
        """Copy the model with the name and the SHA-256 of its input file."""
        copy = self.model_copy()
        copy.__dict__["_file"] = (file, sha256)
        return copy

    @cached_property
    def provenance(self) -> Provenance:
        """The input file with its SHA-256, and the whole input as JSON, of what was asked."""
        asked = self.asked
        return Provenance.of(asked.model_dump(exclude_unset=True), asked.__dict__.get("_file"))

    @field_serializer("support")
    def _alone(self, supports: tuple[Support, ...]) -> tuple[Support, ...]:
        return tuple(one for one in supports if not isinstance(one, Contact))

    @property
    def parts(self) -> tuple[Part[Model], ...]:
        """Several plates, each by itself; of one plate none."""
        return parts_of(self)

    @property
    def cases(self) -> tuple[str, ...]:
        """Names of the load cases that stay where they are, in the order of the input, and behind them of preloads."""
        return tuple(dict.fromkeys([*(load.case for load in self.load), *self.preload_cases]))

    @property
    def preload_cases(self) -> tuple[str, ...]:
        """Names of the cases that preloads are, in the order in which they first appear."""
        return tuple(dict.fromkeys(each.case for each in self.rounds if each.case is not None))

    @property
    def rounds(self) -> tuple[Tightening, ...]:
        """Rounds of tightening: a round for every support with a preload, and behind them those of [[tightening]]."""
        preloaded = (
            Tightening.model_construct(support=support.name, force=support.preload, case=support.preload_case)
            for support in self.support
            if support.preload is not None
        )
        return (*preloaded, *self.tightening)

    def round_factors(self, factors: Mapping[str, float]) -> tuple[float, ...]:
        """Factors (t,) of the forces of all `rounds` beside cases with these factors; empty where all are 0."""
        result = tuple(1.0 if each.case is None else factors.get(each.case, 0.0) for each in self.rounds)
        return result if any(result) else ()

    @property
    def materials(self) -> tuple[Material, ...]:
        """The plates' materials, and those that zones have."""
        plates = tuple(plate.material or self.material for plate in self.plates.values()) or (self.material,)
        return (*plates, *(zone.material for zone in self.zone if zone.material is not None))

    @property
    def divisions(self) -> tuple[int, int] | None:
        """Numbers of elements in rows; None where they fill the outline as they fit.

        They do so where rows cannot follow the border of a zone or the line of a support or load, at which moments or
        shears jump, unless they are counted or of an element that has no triangles.
        """
        rows = self.mesh.divisions is not None or follows_in_rows(self)
        return self.plate.divisions(self.mesh) if rows and not isinstance(self.plate, MeshPlate) else None

    @property
    def young(self) -> float:
        """Young's modulus, the largest there is; of sections whose stiffness is given that of solid ones as stiff."""
        result = [material.young for material in self.materials if material.is_elastic]
        for part in (*(self.plates.values() or (self.plate,)), *self.zone):
            if part.stiffness is not None:
                result.append(part.stiffness.equivalent[1])
        return max(result)

    @property
    def positions(self) -> Positions:
        """Names of the load cases that the positions of each moving load are, by the moving load's case."""
        return {moving.case: tuple(moving.positions) for moving in self.moving}

    @cached_property
    def effective_combinations(self) -> Combinations:
        """Every combination, those generated made when they are asked for.

        Where none is given there is one named "all", every case at factor 1; with moving loads one for each of their
        positions. What has no case, such as a settlement, acts in all.
        """
        positions = self.positions
        if self.combination:
            return Combinations(tuple(p for combination in self.combination for p in products(combination, positions)))
        choices = tuple(tuple(Choice(at, at, 1.0) for at in places) for places in positions.values())
        return Combinations((Product("all", tuple((case, 1.0) for case in self.cases), choices),))

    @property
    def tabulated(self) -> bool:
        """Whether combinations are rows of a table, and only some have all results."""
        asked = self.output.combinations
        return asked == "table" or (asked == "auto" and len(self.effective_combinations) > FEW)

    @property
    def estimated(self) -> bool:
        """Whether the command says of every number how far the mesh is from the plate."""
        plates = self.plates.values() or (self.plate,)
        return not any(isinstance(one, MeshPlate) for one in plates) if self.mesh.error is None else self.mesh.error

    def _complaints(self) -> Iterator[Complaint]:
        for key in ("support", "combination", "section", "strip", "profile"):
            yield from _repeated(key, [table.name for table in getattr(self, key)])
        yield from plate_complaints(self)
        if self.plate is not None:
            yield from self.complaints_of_plate()
        yield from self._moving_complaints()
        yield from self._combination_complaints()
        yield from self._preload_complaints()

    def complaints_of_plate(self) -> Iterator[Complaint]:
        """What is wrong with a plate and what is on it."""
        yield from self._mesh_complaints()
        yield from self._edge_complaints()
        yield from self._node_complaints()
        yield from self._section_complaints()
        for index, load in enumerate(self.load):
            if load.self_weight and self.material.unit_weight is None:
                why = "self_weight needs the material's unit_weight, which is not given."
                yield ("load", index, "self_weight"), why
        for index, zone in enumerate(self.zone if any(load.self_weight for load in self.load) else ()):
            if zone.material is not None and zone.material.unit_weight is None:
                why = "there is a load of self_weight, which needs this material's unit_weight."
                yield ("zone", index, "material"), why

    def _section_complaints(self) -> Iterator[Complaint]:
        """Sections that are made of a material without moduli."""
        if self.plate.stiffness is not None:
            yield from ((("plate", *path), message) for path, message in constant_thickness(self.plate.thickness))
        parts = (
            (("material",), self.plate, self.material),
            *((("zone", i, "material"), z, z.material) for i, z in enumerate(self.zone)),
        )
        for number, (place, part, material) in enumerate(parts):
            if material is None or material.is_elastic:
                continue
            later = any(zone.is_solid and zone.material is None for zone in self.zone[number:])
            if part.stiffness is None or later:
                yield from (((*place, *path), message) for path, message in material.missing())

    def _mesh_complaints(self) -> Iterator[Complaint]:
        if isinstance(self.plate, MeshPlate):
            for key in [*self.mesh.given(("divisions", "size", "accuracy")), *(["refine"] if self.mesh.refine else [])]:
                yield ("mesh", key), f"{key} does not go with a plate read from a mesh file, which is meshed already."
            return
        divisions = self.divisions
        if divisions is None:
            if self.mesh.divisions is not None:
                shape = self.plate.shape
                why = "a polygon" if shape == "polygon" else "holes" if self.plate.holes else "refine"
                yield ("mesh", "divisions"), f"divisions count the elements of a regular mesh; with {why} give size."
            return
        (first, second), fewest = divisions, self.plate.fewest[1]
        if second < fewest:
            yield ("mesh", "divisions"), f"found {second} elements around; this plate needs at least {fewest}."
        if first * second > _MOST_ELEMENTS:
            key = "size" if self.mesh.size is not None else "divisions"
            yield (
                ("mesh", key),
                f"found {first:.3g} by {second:.3g} elements; at most {_MOST_ELEMENTS:.0e} are allowed.",
            )

    def _moving_complaints(self) -> Iterator[Complaint]:
        yield from _repeated("moving", [moving.case for moving in self.moving], key="case")
        for index, moving in enumerate(self.moving):
            if moving.case in self.cases:
                where = "a preload" if moving.case in self.preload_cases else "[[load]]"
                why = f'"{moving.case}" is a case of {where} too; give the moving load a case of its own.'
                yield ("moving", index, "case"), why
        total = sum(moving.count for moving in self.moving)
        if total > _MOST_POSITIONS:
            longest = max(range(len(self.moving)), key=lambda index: self.moving[index].count)
            yield (
                ("moving", longest, "step"),
                f"the moving loads have {total} positions; at most {_MOST_POSITIONS} are allowed. Take a larger step.",
            )

    def _combination_complaints(self) -> Iterator[Complaint]:
        if sum(moving.count for moving in self.moving) > _MOST_POSITIONS:
            return
        positions = self.positions
        still = (*self.cases, *(at for places in positions.values() for at in places))
        total = 0
        for index, combination in enumerate(self.combination):
            known = True
            for case, place in combination.cases.items():
                if case in positions and combination.generate is None:
                    known = False
                    yield (
                        ("combination", index, *place),
                        f'"{case}" moves. Write generate = "positions" for a combination of each of its positions, or '
                        f'name one of them, from "{positions[case][0]}" to "{positions[case][-1]}".',
                    )
                elif case not in still and case not in positions:
                    known = False
                    yield ("combination", index, *place), unknown("case", case, (*self.cases, *positions))
            if combination.generate == "positions" and not positions.keys() & combination.cases.keys():
                yield ("combination", index, "factors"), 'generate = "positions" needs a case of [[moving]] among them.'
            if known:
                total += sum(len(product) for product in products(combination, positions))
            if total > _MOST_COMBINATIONS:
                yield (
                    ("combination", index),
                    f"there are {total:.3g} combinations up to here; at most {_MOST_COMBINATIONS} are allowed. Name "
                    "fewer cases or factors, or list under 'exclusive' the cases that do not act together.",
                )
                return
        yield from self._name_complaints()

    def _preload_complaints(self) -> Iterator[Complaint]:
        of_loads = {load.case for load in self.load}
        named = {case for combination in self.combination for case in combination.cases}
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
                yield place, f'"{case}" is a case of [[load]] too; give the preload a case of its own.'
            elif case is not None and self.combination and case not in named:
                why = f'no combination names the case "{case}", so that the bolts would not be tightened in any.'
                yield place, f"{why} Name it in one, or leave {place[-1]} out for a factor of 1 in all."
        for index, combination in enumerate(self.combination):
            for case in self.preload_cases:
                if (least := min(combination.factors_of(case), default=0.0)) < 0.0:
                    why = f'found the factor {least:g} of the preload "{case}"; it must not be negative.'
                    yield ("combination", index, *combination.cases[case]), why

    def _name_complaints(self) -> Iterator[Complaint]:
        """Names that are there twice once the tables are written out."""
        if any(combination.generate for combination in self.combination):
            positions = self.positions
            taken: dict[str, int] = {}
            for index, combination in enumerate(self.combination):
                for name in Combinations(tuple(products(combination, positions))).names():
                    if name in taken:
                        other = f"combination[{taken[name] + 1}]"
                        yield (
                            ("combination", index),
                            f'it makes "{name}", a name that {other} makes; each may stand once.',
                        )
                        return
                    taken[name] = index
        if isinstance(self.output.fields, tuple) and self.output.fields:
            names = set(self.effective_combinations.names())
            for position, name in enumerate(self.output.fields):
                if name not in names:
                    some = sorted(names)[:20]
                    yield ("output", "fields", position), unknown("combination", name, some, "Among others this model")

    def _edge_complaints(self) -> Iterator[Complaint]:
        names = self.plate.edge_names
        if names is None:
            return
        for place, item in self._located():
            for position, edge in enumerate(item.edge or ()):
                if edge not in names:
                    yield (*place, "edge", position), unknown("edge", edge, names, f"This {self.plate.shape}")
                elif whole := next((other for other in item.edge or () if edge.startswith(f"{other} ")), None):
                    why = f'"{edge}" is part of "{whole}", which is listed too. Leave it out.'
                    yield (*place, "edge", position), why

    def _node_complaints(self) -> Iterator[Complaint]:
        for place, item in () if isinstance(self.plate, MeshPlate) else self._located():
            if isinstance(item, Acting) and item.nodes is not None:
                why = f"nodes are those of a mesh file, and this {self.plate.shape} has none. Give points with at."
                yield (*place, "nodes"), why

    def _located(self) -> Iterator[tuple[Place, Located]]:
        """Yield what says where it is, with its place in the input."""
        yield from ((("support", index), one) for index, one in enumerate(self.support))
        yield from ((("load", index), one) for index, one in enumerate(self.load))
        yield from ((("mesh", "refine", index), one) for index, one in enumerate(self.mesh.refine))


def follows_in_rows(model: Model) -> bool:
    """Whether rows of elements can follow all borders of zones and all lines; `q8r` has rows only."""
    plate = model.plate
    if isinstance(plate, MeshPlate):
        return False
    size = plate.element_size(model.mesh)
    lines = (
        along for item in acting_on(model) if (along := item.where.curve) is not None and worth_following(along, size)
    )
    followed = *(zone.region for zone in model.zone), *lines
    return plate.element == "q8r" or all(map(plate.follows, followed))


def acting_on(model: Model) -> tuple[Acting, ...]:
    """Supports and loads."""
    return (*model.support, *model.load)


def _repeated(table: str, names: list[str], key: str = "name") -> Iterator[Complaint]:
    first: dict[str, int] = {}
    for index, name in enumerate(names):
        if first.setdefault(name, index) != index:
            why = f'the name "{name}" is taken by {table}[{first[name] + 1}]; each name may stand once.'
            yield (table, index, key), why


TOP.update(tables_of(Model))


@checked
def validate(data: Mapping[str, Any], *, source: str = "", line_of: Callable[[Place], int] | None = None) -> Model:
    """Make a model of nested mappings and lists, as read from an input file.

    Parameters
    ----------
    data : mapping
        The tables, under the keys of the input file.
    source : str
        Name of the file they come from, for messages.
    line_of : callable, optional
        Line in that file of a path of keys and positions (these count from 0).

    Returns
    -------
    Model

    Raises
    ------
    InputError
        Naming everything that is wrong, each with its place.

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
