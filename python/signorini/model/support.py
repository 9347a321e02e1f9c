"""Supports: where they are, which way they resist, and from which gap with which stiffness."""

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
        raise ValueError(f"found {describe(list(value))}; each of w, slope, twist may stand there once.")
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


_MOST_OF_LAW = 100
"""Points of a law: its pieces, both ways, are numbered by a byte."""


def _law(value: object) -> object:
    value = as_list(value)
    if not isinstance(value, list | tuple) or not 2 <= len(value) <= _MOST_OF_LAW:
        found = f"{len(value)} point{'s' * (len(value) != 1)}" if isinstance(value, list | tuple) else describe(value)
        raise ValueError(f"found {found}; it must be a list of 2 to {_MOST_OF_LAW} points [travel, force].")
    return value


Law = Annotated[
    tuple[base.Point, ...],
    BeforeValidator(_law),
    Field(json_schema_extra={"minItems": 2, "maxItems": _MOST_OF_LAW}),
]


def _turning(value: object) -> object:
    value = as_list(value)
    if not isinstance(value, list | tuple):
        return [value]
    if len(value) not in (1, 2):
        raise ValueError(f"found {describe(value)}; it must be one stiffness, or [about x, about y] of points.")
    return value


Between = Annotated[
    tuple[base.Text, base.Text],
    BeforeValidator(base.listed(2, 'the names of two plates, ["upper", "lower"], the upper one first')),
    WithJsonSchema({"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}),
]


Turning = Annotated[
    tuple[base.PositiveScalar, ...],
    BeforeValidator(_turning),
    WithJsonSchema({"anyOf": [{"type": ["number", "string"]}, {"type": "array", "minItems": 1, "maxItems": 2}]}),
]


_PER_POINT = ("gap", "settlement", "stiffness", "limit", "preload")
"""Keys that take a list with one value a point; so does order."""


def _way_of(value: object) -> object:
    """Refuse words for tension and compression, and say which way is meant."""
    word = value.lower() if isinstance(value, str) else ""
    for meant, acts, words in (("up", "holds the plate down", "tens pull"), ("down", "pushes it up", "compr push")):
        if any(one in word for one in words.split()):
            said = f"found {describe(value)}; it must be down, up or both. A support that {acts} only has"
            raise ValueError(f'{said} resists = "{meant}".')
    return value


_OF_ONE_PLATE = ("plate", "fix", "nodes", "edge", "rotational_stiffness", "rotation")
"""Keys of a support that has one plate."""


class Support(Acting, base.Named):
    """A support: where (exactly one of at, nodes, edge, line, circle, area) and how (fix, or resists)."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": one_of(Acting.places),
            "not": {"anyOf": [{"required": ["fix", "resists"]}, {"required": ["patch", "radius"]}]},
        }
    )

    fix: Fix | None = Field(
        default=None,
        description="Holds both ways: clamped (w, slope, twist), hard (w, twist), simple (w), symmetry (slope), "
        "or a list of w, slope, twist.",
    )
    resists: Annotated[Literal["down", "up", "both"] | None, BeforeValidator(_way_of)] = Field(
        default=None,
        description="Which way it resists: down (pushes up only), up (holds down only), both; default both.",
        json_schema_extra={"default": "both"},
    )
    gap: NonNegativePointScalar = Field(
        default=Expression(0.0),
        description="Free travel before it acts, either way it resists: a number, an expression, or a list with one "
        "value a point; default 0.",
    )
    stiffness: PointFieldScalar | None = Field(
        default=None,
        description="None: rigid. Per point, per length (edge, line, circle), per area: a number, an expression, or "
        "{ file = ... }, a table of x, y and value, linear between its points, which cover the support; or a list "
        "with one value a point.",
    )
    limit: PositivePointScalar | None = Field(
        default=None,
        description="Largest reaction; beyond it the support yields. Per point, per length (edge, line, circle), per "
        "area: a number, an expression, or a list with one value a point.",
    )
    law: Law | None = Field(
        default=None,
        description="In place of stiffness and limit: [[travel, force], ...], not falling, from [0, 0] on; the last "
        "slope goes on. Per point, per length (edge, line, circle), per area. With both it is alike both ways, or "
        "begins at a negative travel.",
    )
    rotational_stiffness: Turning | None = Field(
        default=None,
        description="Moment per slope, in place of holding the slope: per length (edge, line, circle) across it, per "
        "point or footprint about both axes, or [about x, about y]; numbers or expressions.",
    )
    settlement: PointScalar = Field(
        default=Expression(0.0),
        description="The base moves down by this: a number, an expression, or a list with one value a point; default "
        "0.",
    )
    between: Between | None = Field(
        default=None,
        description='["upper", "lower"]: it acts between these two plates; resists says how on the upper one.',
    )
    preload: PositivePointScalar | None = Field(
        default=None,
        description="Force to which each bolt, at a point, is tightened before other loads act; from there its graph "
        "goes on: a number, an expression, or a list with one value a point. With resists = up or both.",
    )
    preload_case: base.Text | None = Field(
        default=None,
        description="The preload is a case of this name: combinations give its factor, and where it has none the bolts "
        "are not tightened. Left out: factor 1 in all.",
    )
    order: base.Counts | None = Field(
        default=None,
        description="Bolts of one order are tightened together, after those of lower ones; one number, or a list with "
        "one a point.",
        json_schema_extra={"default": 1},
    )
    rotation: base.Rotation | None = Field(
        default=None,
        description="Slopes [θx, θy] at which slope and twist are held, numbers or expressions; default [0, 0].",
    )

    default_resists: ClassVar[Literal["down", "both"]] = "both"
    """How it resists where nothing is said of that."""
    _tightened: bool = PrivateAttr(default=False)

    def model_post_init(self, context: Any) -> None:
        """Put lists with one value a point onto the points."""
        for key in _PER_POINT if self.at is not None else ():
            self.__dict__[key] = self.on_points(getattr(self, key))

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy the support with other keys; lists with one value a point stay with their points."""
        result = super().model_copy(update=update, deep=deep)
        result.model_post_init(None)
        return result

    def on_points(self, value: Any) -> Any:
        """Return a list with one value a point on the points of this support, and any other value as it is."""
        return PointValues(value.values, self.at or ()) if isinstance(value, PointValues) else value

    def as_bolt(self) -> Self:
        """Return the same support with points that [[tightening]] tightens."""
        result = self.model_copy()
        result._tightened = True
        return result

    @property
    def is_bolt(self) -> bool:
        """Whether its points are tightened before other loads act."""
        return self.preload is not None or self._tightened

    @property
    def point_count(self) -> int:
        """Number of its points; 0 where it is at no points."""
        return len(self.at or self.nodes or ())

    @model_validator(mode="after")
    def _as_unsaid(self) -> Self:
        if self.fix is None and self.resists is None:
            # Not among what is set: a dump says no more than the input.
            self.__dict__["resists"] = self.default_resists
            self.model_fields_set.discard("resists")
        return self

    @field_serializer("resists")
    def _said(self, resists: str | None) -> str | None:
        return resists if "resists" in self.model_fields_set else None

    @property
    def fixed(self) -> tuple[Component, ...]:
        """What ``fix`` holds, in the order w, slope, twist; empty where ``resists`` says how."""
        if self.fix is None:
            return ()
        held = _KINDS[self.fix] if isinstance(self.fix, str) else self.fix
        return tuple(part for part in _COMPONENTS if part in held)

    @property
    def holds_rotation(self) -> bool:
        """Whether it holds a slope or a twist."""
        return bool({"slope", "twist"} & set(self.fixed))

    @property
    def on_nodes(self) -> bool:
        """Whether its reactions are forces on nodes: not spread over an area or a footprint."""
        return self.area is None and not self.has_footprint

    @property
    def holds_w(self) -> bool:
        """Whether it acts on the deflection, one way or both, not on slopes alone."""
        return self.resists is not None or "w" in self.fixed

    @property
    def along_line(self) -> bool:
        """Whether it acts on the deflection along an edge, a line or a circle."""
        return self.holds_w and self.place in ("edge", "line", "circle")

    @property
    def resists_by_default(self) -> bool:
        """Whether it holds both ways because nothing is said of how."""
        return self.resists == "both" and "resists" not in self.model_fields_set

    @property
    def is_rigid(self) -> bool:
        """Whether it holds the deflection without giving way, but for a limit."""
        return self.modulus is None and self.holds_w

    @property
    def modulus(self) -> PointFieldScalar | None:
        """Stiffness, of a law that of its steepest part; None where it is rigid, or a law rises without travel."""
        if self.law is None:
            return self.stiffness
        steps = [(t - s, f - g) for (s, g), (t, f) in pairwise(self.law)]
        return Expression(max(rise / run for run, rise in steps)) if all(run for run, _ in steps) else None

    @property
    def is_compliant(self) -> bool:
        """Whether more force makes it travel more: it is elastic, or, if a law rises without travel, later on."""
        return self.modulus is not None or any(s < t and f < g for (s, f), (t, g) in pairwise(self.law or ()))

    @property
    def has_pieces(self) -> bool:
        """Whether its force is told by the piece of a law, or of a line up to a limit."""
        return self.law is not None or self.limit is not None

    @property
    def can_yield(self) -> bool:
        """Whether there is an end to what it can give."""
        if self.law is None:
            return self.limit is not None
        return self.law[-1][1] == self.law[-2][1] or (self.law[0][0] < 0.0 and self.law[0][1] == self.law[1][1])

    def _complaints(self) -> Iterator[base.Complaint]:
        yield from self._place_complaints("where a support is")
        if self.at is not None:
            seen: dict[tuple[float, float], int] = {}
            for index, point in enumerate(self.at):
                if seen.setdefault(point, index) != index:
                    yield ("at", index), f"point {index + 1} repeats point {seen[point] + 1}."
        yield from self._footprint_complaints()
        if self.between is not None:
            yield from self._between_complaints(self.between)
        if self.fix is not None:
            yield from self._fix_complaints()
        if self.law is not None:
            yield from self._law_complaints(self.law)
        if self.rotational_stiffness is not None:
            yield from self._turning_complaints(self.rotational_stiffness)
        yield from self._list_complaints()
        yield from self._preload_complaints()
        if self.rotation is not None and not self.holds_rotation and self.rotational_stiffness is None:
            yield (
                ("rotation",),
                f"{describe(self.fix or self.resists)} does not hold a slope, so none is prescribed; use fix = "
                "clamped, hard or symmetry, or a list with slope or twist.",
            )

    def _between_complaints(self, between: Between) -> Iterator[base.Complaint]:
        if between[0] == between[1]:
            yield ("between",), f"found {describe(between[0])} twice; name two plates, the upper one first."
        for key in self.present(_OF_ONE_PLATE):
            yield (
                (key,),
                f"found {key} beside between; what acts between two plates is at points, lines or areas of both.",
            )
        if not _is_zero(self.settlement):
            yield ("settlement",), "found settlement beside between; between two plates there is a gap."

    def _turning_complaints(self, stiffness: Turning) -> Iterator[base.Complaint]:
        place = ("rotational_stiffness",)
        if "slope" in self.fixed:
            yield place, f"{describe(self.fix)} holds the slope already; use hard or simple, or leave it out."
        if self.area is not None:
            yield place, "it goes with at, nodes, edge, line or circle, not with areas."
        elif self.place != "at" and len(stiffness) == 2:
            yield place, "found two; along an edge, a line or a circle there is one, across it."

    def _list_complaints(self) -> Iterator[base.Complaint]:
        lists = {key: list(value.values) for key in _PER_POINT if isinstance(value := getattr(self, key), PointValues)}
        if len(self.order or ()) > 1:
            lists["order"] = list(self.order or ())
        for key, values in lists.items():
            if self.place != "at":
                yield (
                    (key,),
                    f"found {describe(values)}; a list with one value a point is for at or nodes, not for "
                    f"{self.place}. Give one value.",
                )
            elif len(values) != self.point_count:
                yield (key,), base.miscounted(len(values), self.point_count)

    def _preload_complaints(self) -> Iterator[base.Complaint]:
        if self.preload is not None:
            yield from self.bolt_complaints()
            return
        for key in self.present(("preload_case", "order")):
            yield (key,), f"{key} goes with a preload; give one, or leave it out."

    def bolt_complaints(self) -> Iterator[base.Complaint]:
        """Yield why its points cannot be tightened."""
        place = ("preload",)
        if self.fix is not None:
            yield place, "a preload does not go with fix; use resists = up or both."
        elif self.resists == "down":
            yield place, "found resists = down, which cannot pull the plate down; use up or both."
        if self.place != "at":
            yield place, f"a preload is that of a bolt at a point; use at or nodes, not {self.place}."
        if not _is_zero(self.gap):
            yield ("gap",), "a gap does not go with a preload: tightening takes up all travel. Leave it out."

    def _law_complaints(self, law: Law) -> Iterator[base.Complaint]:
        for key in self.present(("fix", "stiffness", "limit")):
            yield (key,), f"found both law and {key}; a law says all of how the force grows."
        for at, (one, other) in enumerate(pairwise(law), start=1):
            if one == other or one[0] > other[0] or one[1] > other[1]:
                said = "falls" if one[0] < other[0] else "does not go on" if one == other else "goes back"
                yield ("law", at), f"found {list(other)} after {list(one)}, where the law {said}; it must rise."
            elif one[0] < other[0] and other[1] - one[1] > LARGEST * (other[0] - one[0]):
                yield ("law", at), f"found {list(other)} after {list(one)}, which is steeper than {LARGEST:g}."
            elif one[0] == other[0] != 0.0:
                said = f"found {list(other)} after {list(one)}, where the law rises without travel"
                yield ("law", at), f"{said}; it may do so at travel 0 alone. Draw it less steep."
        at_rest = [force for travel, force in law if travel == 0.0]
        if (self.resists or self.default_resists) != "both" or law[0][0] >= 0.0:
            if law[0] != (0.0, 0.0) or law[1][1] <= 0.0:
                yield (
                    ("law",),
                    f"found a law from {list(law[0])} to {list(law[1])}; it must begin at [0, 0] and rise. Give free "
                    "travel as gap.",
                )
        elif not (min(at_rest, default=1.0) <= 0.0 <= max(at_rest, default=-1.0)):
            yield (
                ("law",),
                "found a law without [0, 0]; one that begins at a negative travel must have it among its points.",
            )
        elif not _is_zero(self.gap):
            yield ("gap",), "a gap does not go with a law that begins at a negative travel; draw it in the law."

    def _fix_complaints(self) -> Iterator[base.Complaint]:
        fixed = self.fixed
        if self.resists is not None:
            yield ("resists",), "found both fix and resists; give one. fix holds both ways."
        if self.area is not None:
            yield ("fix",), "fix does not go with area; use resists."
        if self.place == "at" and ("slope" in fixed) != ("twist" in fixed):
            yield (
                ("fix",),
                f"found {describe(self.fix)}; a point has no direction, so slope and twist go together there: "
                "simple holds the deflection, clamped all.",
            )
        if self.has_footprint and fixed != ("w",):
            yield ("fix",), f"{describe(self.fix)} holds slopes, and a footprint its mean deflection; use simple."
        if not _is_zero(self.gap):
            yield ("gap",), "a gap does not go with fix; use resists."
        if self.limit is not None:
            yield ("limit",), "a limit does not go with fix; use resists."
        if self.stiffness is not None and fixed != ("w",):
            yield ("stiffness",), f"a stiffness goes with fix = simple or with resists, not with {describe(self.fix)}."
        if not _is_zero(self.settlement) and "w" not in fixed:
            yield ("settlement",), f"{describe(self.fix)} does not hold the deflection, so nothing settles."


def _is_zero(value: PointScalar) -> bool:
    return value.is_constant and value.value == 0.0


_OF_CONTACTS = (
    *("name", "between", "at", "line", "circle", "area", "patch", "angle", "radius"),
    *("gap", "stiffness", "limit", "law"),
)


def _only_theirs(schema: dict[str, Any]) -> None:
    """Leave in the schema of a contact what a contact takes."""
    schema["properties"] = {key: of for key, of in schema["properties"].items() if key in _OF_CONTACTS}
    schema["required"] = ["between"]


class Contact(Support):
    """One plate on another: the upper one presses the lower one, and neither holds the other.

    A support between two plates that only pushes: where (one of at, line, circle, area), gap, stiffness, limit, law.
    """

    model_config = ConfigDict(json_schema_extra=_only_theirs)
    default_resists: ClassVar[Literal["down", "both"]] = "down"

    def _complaints(self) -> Iterator[base.Complaint]:
        yield from super()._complaints()
        if self.between is None:
            yield ("between",), "'between' is missing. Name two plates, the upper one first."
        others = sorted(self.model_fields_set.difference(_OF_CONTACTS, _OF_ONE_PLATE, ("between", "settlement")))
        for key in others if self.between is not None else ():
            if getattr(self, key) == type(self).model_fields[key].default:
                continue
            yield (key,), f"found {key}; a contact pushes only, and takes no more than {', '.join(_OF_CONTACTS)}."
