"""Tables [[support]] and [[contact]] of the input: place, direction, gap, stiffness, limit or law, preload."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
    PrivateAttr,
    WithJsonSchema,
    field_serializer,
    model_validator,
)

from signorini.expression import LARGEST, Expression, PointValues
from signorini.model import base
from signorini.model.field import NonNegativePointScalar, PointFieldScalar, PointScalar, PositivePointScalar
from signorini.model.problems import as_list, describe
from signorini.model.where import Acting, one_of

Component = Literal["w", "slope", "twist"]

_COMPONENTS: tuple[Component, ...] = ("w", "slope", "twist")
_KINDS: dict[str, tuple[Component, ...]] = {
    "clamped": ("w", "slope", "twist"),
    "hard": ("w", "twist"),
    "simple": ("w",),
    "symmetry": ("slope",),
}


def _fix(value: object) -> object:
    value = as_list(value)
    allowed = f"it must be one of {', '.join(_KINDS)}, or a list of {', '.join(_COMPONENTS)}."
    if isinstance(value, str) and value in _KINDS:
        return value
    if not isinstance(value, list | tuple) or not value or any(part not in _COMPONENTS for part in value):
        raise ValueError(f"found {describe(value)}; {allowed}")
    if len(set(value)) < len(value):
        raise ValueError(f"found {describe(list(value))}; list each of w, slope, twist once at most.")
    return tuple(value)


Fix = Annotated[
    Literal["clamped", "hard", "simple", "symmetry"] | tuple[Component, ...],
    PlainValidator(_fix),
    PlainSerializer(lambda fix: fix),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "string", "enum": list(_KINDS)},
                {
                    "type": "array",
                    "items": {"type": "string", "enum": list(_COMPONENTS)},
                    "minItems": 1,
                    "uniqueItems": True,
                },
            ]
        }
    ),
]


_MAX_LAW_POINTS = 100
"""Largest number of points of a law, so that one byte can number the pieces of an antisymmetric law."""


def _law(value: object) -> object:
    value = as_list(value)
    if not isinstance(value, list | tuple) or not 2 <= len(value) <= _MAX_LAW_POINTS:
        found = f"{len(value)} point{'s' * (len(value) != 1)}" if isinstance(value, list | tuple) else describe(value)
        raise ValueError(f"found {found}; it must be a list of 2 to {_MAX_LAW_POINTS} points [travel, force].")
    return value


Law = Annotated[
    tuple[base.Point, ...],
    BeforeValidator(_law),
    Field(json_schema_extra={"minItems": 2, "maxItems": _MAX_LAW_POINTS}),
]


def _rotational(value: object) -> object:
    value = as_list(value)
    if not isinstance(value, list | tuple):
        return [value]
    if len(value) not in (1, 2):
        raise ValueError(f"found {describe(value)}; it must be one stiffness, or [about x, about y] at points.")
    return value


Between = Annotated[
    tuple[base.Text, base.Text],
    BeforeValidator(base.listed(2, 'the names of two plates, ["upper", "lower"], the upper one first')),
    WithJsonSchema({"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}),
]


Rotational = Annotated[
    tuple[base.PositiveScalar, ...],
    BeforeValidator(_rotational),
    WithJsonSchema({"anyOf": [{"type": ["number", "string"]}, {"type": "array", "minItems": 1, "maxItems": 2}]}),
]


_PER_POINT = ("gap", "settlement", "stiffness", "limit", "preload")
"""Keys whose value can be a list with one number per point of the support, beside the key ``order``."""


def _direction(value: object) -> object:
    """Refuse ``resists = "tension"``, "compression" and similar words; the message gives the allowed value."""
    text = value.lower() if isinstance(value, str) else ""
    for direction, acts, stems in (("up", "holds the plate down", "tens pull"), ("down", "pushes it up", "compr push")):
        if any(stem in text for stem in stems.split()):
            found = f"found {describe(value)}; it must be down, up or both."
            raise ValueError(f'{found} A support that only {acts} has resists = "{direction}".')
    return value


_NOT_BETWEEN = ("plate", "fix", "nodes", "edge", "rotational_stiffness", "rotation")
"""Keys that are not allowed with ``between``, in a support between two plates."""


class Support(Acting, base.Named):
    """A support: its place (exactly one of at, nodes, edge, line, circle, area), and fix or resists."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": one_of(Acting.places),
            "not": {"anyOf": [{"required": ["fix", "resists"]}, {"required": ["patch", "radius"]}]},
        }
    )

    fix: Fix | None = Field(
        default=None,
        description="Displacements held in both directions: clamped (w, slope, twist), hard (w, twist), simple (w), "
        "symmetry (slope), or a list of w, slope, twist.",
    )
    resists: Annotated[Literal["down", "up", "both"] | None, BeforeValidator(_direction)] = Field(
        default=None,
        description="Deflection that the support resists: down (the support only pushes up), up (it only holds down), "
        "both; default both.",
        json_schema_extra={"default": "both"},
    )
    gap: NonNegativePointScalar = Field(
        default=Expression(0.0),
        description="Free travel before the support acts, in each direction that it resists: a number, an expression, "
        "or a list with one value per point; default 0.",
    )
    stiffness: PointFieldScalar | None = Field(
        default=None,
        description="Stiffness (force per travel) per point, length or area, default rigid: a number, an expression, a "
        "list with one value per point, or a table { file = … } of values at points.",
    )
    limit: PositivePointScalar | None = Field(
        default=None,
        description="Largest reaction, at which the support yields, per point, per length (edge, line, circle) or per "
        "area: a number, an expression, or a list with one value per point.",
    )
    law: Law | None = Field(
        default=None,
        description="Force-travel law in place of stiffness and limit: [[travel, force], …], nondecreasing, from "
        "[0, 0]; its last slope continues; with resists = both antisymmetric, unless it begins at a negative travel.",
    )
    rotational_stiffness: Rotational | None = Field(
        default=None,
        description="Rotational stiffness (moment per rotation) of the support: along an edge, a line or a circle per "
        "length, for the slope across it; at a point or footprint for both axes, or [about x, about y].",
    )
    settlement: PointScalar = Field(
        default=Expression(0.0),
        description="Downward displacement of the support's base: a number, an expression, or a list with one value "
        "per point; default 0.",
    )
    between: Between | None = Field(
        default=None,
        description='["upper", "lower"]: names of the two plates that the support connects; the key resists is for '
        "the upper plate.",
    )
    preload: PositivePointScalar | None = Field(
        default=None,
        description="Force to which the bolt at each point is tightened before other loads act: a number, an "
        "expression, or a list with one value per point; resists must be up or both.",
    )
    preload_case: base.Text | None = Field(
        default=None,
        description="Load case whose factor in a combination multiplies the preload; in a combination without this "
        "case the preload is 0; default: factor 1 in all combinations.",
    )
    order: base.Counts | None = Field(
        default=None,
        description="Order of tightening, a number or a list with one number per point; bolts of equal order are "
        "tightened together, lower orders first.",
        json_schema_extra={"default": 1},
    )
    rotation: base.Rotation | None = Field(
        default=None,
        description="Prescribed slopes [θx, θy] where slope or twist is held: numbers or expressions; default [0, 0].",
    )

    default_resists: ClassVar[Literal["down", "both"]] = "both"
    """Value of the key ``resists`` in a table without the keys ``fix`` and ``resists``."""
    _tightened: bool = PrivateAttr(default=False)

    def model_post_init(self, context: Any) -> None:
        """Store the points of ``at`` in each list with one value per point, so that it can be evaluated at a point."""
        for key in _PER_POINT if self.at is not None else ():
            self.__dict__[key] = self.on_points(getattr(self, key))

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy the support with other keys; lists with one value per point then belong to the points of the copy."""
        copy = super().model_copy(update=update, deep=deep)
        copy.model_post_init(None)
        return copy

    def on_points(self, value: Any) -> Any:
        """Return a list with one value per point together with this support's points; other values unchanged."""
        return PointValues(value.values, self.at or ()) if isinstance(value, PointValues) else value

    def as_bolt(self) -> Self:
        """Copy the support; the points of the copy are marked as bolts that a table [[tightening]] tightens."""
        copy = self.model_copy()
        copy._tightened = True
        return copy

    @property
    def is_bolt(self) -> bool:
        """Whether the points of the support are bolts, tightened before other loads act."""
        return self.preload is not None or self._tightened

    @property
    def point_count(self) -> int:
        """Number of points of ``at`` or ``nodes``; 0 for other places."""
        return len(self.at or self.nodes or ())

    @model_validator(mode="after")
    def _apply_default_resists(self) -> Self:
        if self.fix is None and self.resists is None:
            # `resists` is not marked as set, so that `model_dump(exclude_unset=True)` has only keys of the input.
            self.__dict__["resists"] = self.default_resists
            self.model_fields_set.discard("resists")
        return self

    @field_serializer("resists")
    def _resists_if_set(self, resists: str | None) -> str | None:
        return resists if "resists" in self.model_fields_set else None

    @property
    def fixed(self) -> tuple[Component, ...]:
        """The displacements that ``fix`` holds, in the order w, slope, twist; empty without ``fix``."""
        if self.fix is None:
            return ()
        held = _KINDS[self.fix] if isinstance(self.fix, str) else self.fix
        return tuple(part for part in _COMPONENTS if part in held)

    @property
    def fixing(self) -> str:
        """The displacements that ``fix`` holds, as text for messages: a name such as "hard", or "w slope held"."""
        return self.fix if isinstance(self.fix, str) else f"{' '.join(self.fix or ())} held"

    @property
    def rotational(self) -> Rotational:
        """Rotational stiffness: one expression, or two (about x and y) at points; empty if the support has none."""
        return self.rotational_stiffness or ()

    @property
    def prescribes_slopes(self) -> bool:
        """Whether the key ``rotation`` prescribes the values of held slopes."""
        return self.rotation is not None

    @property
    def holds_rotation(self) -> bool:
        """Whether ``fix`` holds the slope or the twist."""
        return bool({"slope", "twist"} & set(self.fixed))

    @property
    def on_nodes(self) -> bool:
        """Whether reactions act at points or on lines; false if they are distributed over an area or a footprint."""
        return self.area is None and not self.has_footprint

    @property
    def holds_w(self) -> bool:
        """Whether the support acts on the deflection w in at least one direction, by ``resists`` or ``fix``."""
        return self.resists is not None or "w" in self.fixed

    @property
    def along_line(self) -> bool:
        """Whether the support acts on the deflection w along an edge, a line or a circle."""
        return self.holds_w and self.place in ("edge", "line", "circle")

    @property
    def direction(self) -> Literal["down", "up", "both"]:
        """Deflections that the support resists: "down", "up" or "both"; with ``fix`` always "both"."""
        return self.resists or "both"

    @property
    def has_gap(self) -> bool:
        """Whether the gap can be other than 0: one of its values is nonzero, or it is an expression in x and y."""
        return not _is_zero(self.gap)

    @property
    def resists_by_default(self) -> bool:
        """Whether the support resists both directions because neither ``fix`` nor ``resists`` is given."""
        return self.resists == "both" and "resists" not in self.model_fields_set

    @property
    def is_elastic(self) -> bool:
        """Whether the support has a finite stiffness; false for a law with a vertical piece, of infinite slope."""
        return self.modulus is not None

    @property
    def is_rigid(self) -> bool:
        """Whether the support holds w without a finite stiffness: it is rigid, or its law has a vertical piece."""
        return self.holds_w and not self.is_elastic

    @property
    def modulus(self) -> PointFieldScalar | None:
        """Stiffness, or the largest slope of a law; None for a rigid support, or a law with a vertical piece."""
        if self.law is None:
            return self.stiffness
        steps = [(t - s, f - g) for (s, g), (t, f) in pairwise(self.law)]
        return Expression(max(rise / run for run, rise in steps)) if all(run for run, _ in steps) else None

    @property
    def is_compliant(self) -> bool:
        """Whether the travel increases with the force: the support has a stiffness, or a law with an inclined piece."""
        return self.modulus is not None or any(s < t and f < g for (s, f), (t, g) in pairwise(self.law or ()))

    @property
    def has_pieces(self) -> bool:
        """Whether the support has a law or a limit; results then give the piece of the law on which each point is."""
        return self.law is not None or self.limit is not None

    @property
    def can_yield(self) -> bool:
        """Whether the reaction of the support is bounded: the support has a limit, or a law with a horizontal end."""
        if self.law is None:
            return self.limit is not None
        return self.law[-1][1] == self.law[-2][1] or (self.law[0][0] < 0.0 and self.law[0][1] == self.law[1][1])

    def _complaints(self) -> Iterator[base.Complaint]:
        yield from self._place_complaints("the place of a support")
        if self.at is not None:
            seen: dict[tuple[float, float], int] = {}
            for index, point in enumerate(self.at):
                if seen.setdefault(point, index) != index:
                    yield ("at", index), f"point {index + 1} equals point {seen[point] + 1}."
        yield from self._footprint_complaints()
        if self.between is not None:
            yield from self._between_complaints(self.between)
        if self.fix is not None:
            yield from self._fix_complaints()
        if self.law is not None:
            yield from self._law_complaints(self.law)
        if self.rotational_stiffness is not None:
            yield from self._rotational_complaints(self.rotational_stiffness)
        yield from self._list_complaints()
        yield from self._preload_complaints()
        if self.rotation is not None and not self.holds_rotation and self.rotational_stiffness is None:
            yield (
                ("rotation",),
                f"{describe(self.fix or self.resists)} does not hold a slope; a rotation needs rotational_stiffness, "
                "or fix = clamped, hard, symmetry, or a list with slope or twist.",
            )

    def _between_complaints(self, between: Between) -> Iterator[base.Complaint]:
        if between[0] == between[1]:
            yield ("between",), f"found {describe(between[0])} twice; name two plates, the upper one first."
        for key in self.present(_NOT_BETWEEN):
            yield (key,), f"{key} is not allowed with between; use at, line, circle or area, and resists."
        if not _is_zero(self.settlement):
            yield ("settlement",), "settlement is not allowed with between; use gap."

    def _rotational_complaints(self, stiffness: Rotational) -> Iterator[base.Complaint]:
        place = ("rotational_stiffness",)
        if "slope" in self.fixed:
            yield place, f"{describe(self.fix)} holds the slope already; use hard or simple, or remove this key."
        if self.area is not None:
            yield place, "rotational_stiffness is not allowed with area; use at, nodes, edge, line or circle."
        elif self.place != "at" and len(stiffness) == 2:
            yield place, "found two values; along an edge, a line or a circle give one value, for the slope across it."

    def _list_complaints(self) -> Iterator[base.Complaint]:
        lists = {key: list(value.values) for key in _PER_POINT if isinstance(value := getattr(self, key), PointValues)}
        if len(self.order or ()) > 1:
            lists["order"] = list(self.order or ())
        for key, values in lists.items():
            if self.place != "at":
                yield (
                    (key,),
                    f"found {describe(values)}; a list with one value per point is for at or nodes, not for "
                    f"{self.place}. Give one value.",
                )
            elif len(values) != self.point_count:
                yield (key,), base.wrong_length(len(values), self.point_count)

    def _preload_complaints(self) -> Iterator[base.Complaint]:
        if self.preload is not None:
            yield from self.bolt_complaints()
            return
        for key in self.present(("preload_case", "order")):
            yield (key,), f"{key} needs a preload; give a preload, or remove {key}."

    def bolt_complaints(self) -> Iterator[base.Complaint]:
        """Yield the problems that prevent the support's points from being bolts that are tightened."""
        place = ("preload",)
        if self.fix is not None:
            yield place, "a preload is not allowed with fix; use resists = up or both."
        elif self.resists == "down":
            yield place, "a support with resists = down cannot pull the plate down; use up or both."
        if self.place != "at":
            yield place, f"a preload belongs to bolts at points; use at or nodes, not {self.place}."
        if not _is_zero(self.gap):
            yield ("gap",), "a gap is not allowed with a preload: tightening closes it. Remove the gap."

    def _law_complaints(self, law: Law) -> Iterator[base.Complaint]:
        for key in self.present(("fix", "stiffness", "limit")):
            yield (key,), f"found both law and {key}; a law replaces {key}."
        for position, (start, end) in enumerate(pairwise(law), start=1):
            (s, f), (t, g) = start, end
            found = f"found {list(end)} after {list(start)}"
            if start == end or s > t or f > g:
                problem = "the point repeats" if start == end else f"the {'travel' if s > t else 'force'} decreases"
                yield ("law", position), f"{found}: {problem}. Travel and force must not decrease."
            elif s < t and g - f > LARGEST * (t - s):
                yield ("law", position), f"{found}: the slope is over {LARGEST:g}."
            elif s == t != 0.0:
                yield ("law", position), f"{found}: a vertical piece is allowed at travel 0 only. Reduce the slope."
        forces_at_zero = [force for travel, force in law if travel == 0.0]
        if (self.resists or self.default_resists) != "both" or law[0][0] >= 0.0:
            if law[0] != (0.0, 0.0) or law[1][1] <= 0.0:
                yield (
                    ("law",),
                    f"found a law from {list(law[0])} to {list(law[1])}; it must begin at [0, 0] and rise. Give a free "
                    "travel as gap.",
                )
        elif not (min(forces_at_zero, default=1.0) <= 0.0 <= max(forces_at_zero, default=-1.0)):
            yield (
                ("law",),
                "found a law without the point [0, 0]; a law that begins at a negative travel must contain it.",
            )
        elif not _is_zero(self.gap):
            yield ("gap",), "a gap is not allowed with a law that begins at a negative travel; shift the law instead."

    def _fix_complaints(self) -> Iterator[base.Complaint]:
        fixed = self.fixed
        if self.resists is not None:
            yield ("resists",), "found both fix and resists; give one. fix holds in both directions."
        if self.area is not None:
            yield ("fix",), "fix is not allowed with area; use resists."
        if self.place == "at" and ("slope" in fixed) != ("twist" in fixed):
            yield (
                ("fix",),
                f"found {describe(self.fix)}; at a point, which has no direction, fix holds both slope and twist or "
                "neither: use simple or clamped.",
            )
        if self.has_footprint and fixed != ("w",):
            yield (
                ("fix",),
                f"{describe(self.fix)} holds slopes, but a footprint holds only the mean deflection; use simple.",
            )
        if not _is_zero(self.gap):
            yield ("gap",), "a gap is not allowed with fix; use resists."
        if self.limit is not None:
            yield ("limit",), "a limit is not allowed with fix; use resists."
        if self.stiffness is not None and fixed != ("w",):
            yield ("stiffness",), f"a stiffness needs fix = simple or resists, not {describe(self.fix)}."
        if not _is_zero(self.settlement) and "w" not in fixed:
            yield ("settlement",), f"{describe(self.fix)} does not hold the deflection; a settlement has no effect."


def _is_zero(value: PointScalar) -> bool:
    return value.is_constant and value.value == 0.0


_CONTACT_KEYS = (
    *("name", "between", "at", "line", "circle", "area", "patch", "angle", "radius"),
    *("gap", "stiffness", "limit", "law"),
)


def _only_contact_keys(schema: dict[str, Any]) -> None:
    """Remove keys of supports that a contact cannot have from the JSON Schema of a contact; require ``between``."""
    schema["properties"] = {key: value for key, value in schema["properties"].items() if key in _CONTACT_KEYS}
    schema["required"] = ["between"]


class Contact(Support):
    """Contact between an upper and a lower plate: a support between the two plates that can only push them apart.

    A contact takes a place (one of at, line, circle, area), gap, stiffness, limit or law.
    """

    model_config = ConfigDict(json_schema_extra=_only_contact_keys)
    default_resists: ClassVar[Literal["down", "both"]] = "down"

    def _complaints(self) -> Iterator[base.Complaint]:
        yield from super()._complaints()
        if self.between is None:
            yield ("between",), "'between' is missing. Name two plates, the upper one first."
        others = sorted(self.model_fields_set.difference(_CONTACT_KEYS, _NOT_BETWEEN, ("between", "settlement")))
        for key in others if self.between is not None else ():
            if getattr(self, key) == type(self).model_fields[key].default:
                continue
            yield (key,), f"found {key}; a contact, which only pushes, takes {', '.join(_CONTACT_KEYS)}."
