"""Tables [cases.NAME] of the input, which describe load cases as actions of a design code; conversion to `Action`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, islice, product
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, PlainSerializer, WithJsonSchema, create_model

from signorini.design import asce7, en1990
from signorini.design.combining import Action
from signorini.errors import unknown
from signorini.model.base import Complaint, NonNegative, Table, Text, as_tuple, number, vector

MOST_GENERATED = 100_000
"""Largest number of combinations that one table [[combination]] may generate by the rules of a code."""

Code = Literal["en1990", "asce7"]
RuleName = Literal[
    "6.10", "6.10ab", "EQU", "accidental", "seismic", "characteristic", "frequent", "quasi-permanent", "LRFD", "ASD"
]
RULES: Mapping[str, tuple[str, ...]] = {"en1990": tuple(en1990.GAMMA), "asce7": tuple(asce7.RULES)}
"""Names of the combination rules of each design code, such as "6.10"."""
_KEY_OF: Mapping[Code, str] = {"en1990": "kind", "asce7": "asce"}
"""Key of [cases.NAME] that gives the kind of action (EN 1990) or the load symbol (ASCE/SEI 7) of the load case."""

_Psi = Annotated[float, Field(ge=0, le=1), BeforeValidator(number)]
_AT_LEAST_0 = {"type": "number", "minimum": 0}
Gammas = Annotated[
    tuple[NonNegative, ...],
    Field(min_length=1, max_length=2),
    BeforeValidator(as_tuple),
    PlainSerializer(lambda values: values[0] if len(values) == 1 else values),
    WithJsonSchema(_AT_LEAST_0 | {"type": ["number", "array"], "minItems": 1, "maxItems": 2, "items": _AT_LEAST_0}),
]


class Gamma(Table):
    """Partial factors γ of each kind of action: [unfavourable, favourable], or one value for both."""

    permanent: Gammas | None = Field(default=None, description="γG of permanent cases: [unfavourable, favourable].")
    variable: Gammas | None = Field(default=None, description="γQ of variable cases; at γQ = 0 the case is absent.")
    preload: Gammas | None = Field(default=None, description="γP of preloads.")
    accidental: Gammas | None = Field(default=None, description="γA of accidental cases.")
    seismic: Gammas | None = Field(default=None, description="Factor of the design value AEd of seismic cases.")

    @property
    def values(self) -> dict[str, tuple[float, ...]]:
        """Partial factors in the input: map from the kind of action, such as "permanent", to one or two factors."""
        return {key: getattr(self, key) for key in self.present(type(self).model_fields)}


_WITH = Field(default=None, description="Name of another load case, whose factor this case has in every combination.")
_FIELDS: dict[str, Any] = {"with": (Text | None, _WITH)}
# The key `with` is a keyword of Python, so that no class body can declare it.
_Following = create_model("_Following", __base__=Table, **_FIELDS)


class Case(_Following):
    """A load case as an action of a design code, for combinations with ``generate = "en1990"`` or ``"asce7"``."""

    kind: Literal["permanent", "variable", "accidental", "seismic", "preload"] | None = Field(
        default=None, description='Kind of action, for generate = "en1990".'
    )
    category: Literal["A", "B", "C", "D", "E", "F", "G", "H", "snow low", "snow high", "wind", "temperature"] | None = (
        Field(default=None, description="Category of a variable case, which gives ψ0, ψ1, ψ2 by EN 1990, Table A1.1.")
    )
    psi: Annotated[tuple[_Psi, _Psi, _Psi], *vector(3, "three numbers [ψ0, ψ1, ψ2]")] | None = Field(
        default=None, description="Factors [ψ0, ψ1, ψ2] of a variable case, in place of category."
    )
    asce: Literal["D", "L", "Lr", "S", "R", "W", "E", "Ev", "P"] | None = Field(
        default=None,
        description='Symbol of the load in ASCE/SEI 7, for generate = "asce7"; E is the horizontal and Ev the vertical '
        "seismic effect, P a preload with factor 1.",
    )
    group: Text | None = Field(
        default=None,
        description="Name of a group of actions that exclude each other, such as the directions of wind.",
    )
    action: Text | None = Field(
        default=None,
        description="Name of the action of which this case is a part, such as the live load on one span; its parts "
        "together are the leading action or an accompanying one, and each part may be absent.",
    )

    @property
    def follows(self) -> str | None:
        """Name of the load case whose factor this case has in every combination; None if it has a factor of its own."""
        name: str | None = getattr(self, "with")
        return name

    @property
    def representative(self) -> tuple[float, float, float, float]:
        """Representative values (1, ψ0, ψ1, ψ2) of the case, relative to its characteristic value."""
        return 1.0, *(self.psi or (en1990.PSI[self.category] if self.category else (1.0, 1.0, 1.0)))

    def _complaints(self) -> Iterator[Complaint]:
        own = self.present(("category", "psi"))
        if self.follows is not None:
            for key in (*own, *self.present(("group", "action"))):
                yield (key,), f'{key} is not allowed beside with = "{self.follows}"; give {key} to that case.'
        elif self.kind is None and self.asce is None:
            yield ("kind",), "'kind' is missing. It must be one of permanent, variable, accidental, seismic, preload."
        elif self.kind == "variable" and len(own) != 1:
            yield (), f"found {' and '.join(own) or 'neither category nor psi'}; a variable case needs category or psi."
        elif self.kind != "variable":
            for key in own:
                yield (key,), f"{key} is for variable cases; the kind of this case is {self.kind or 'not given'}."
        if self.action is not None and self.kind in ("permanent", "preload"):
            yield ("action",), f"action is for cases that may be absent; {self.kind} cases always act."


Cases = Mapping[str, Case]
Positions = Mapping[str, Sequence[str]]
"""Map from each moving load's case to the load cases of its positions."""


def complaints_of(cases: Cases, known: Sequence[str], positions: Positions) -> Iterator[Complaint]:
    """Yield the problems of [cases]: unknown load cases, ``with`` at a moving load, contradictions between cases."""
    first: dict[tuple[str, str], Case] = {}
    for name, case in cases.items():
        if name not in known:
            yield ("cases", name), unknown("case", name, known)
        if case.follows is not None:
            others = [other for other in cases if cases[other].follows is None]
            if case.follows not in others:
                yield ("cases", name, "with"), unknown("case", case.follows, others, "The [cases] without with")
            elif name in positions:
                yield ("cases", name, "with"), "with is not allowed for a moving load; give it to the other case."
            elif case.kind not in (None, cases[case.follows].kind):
                yield ("cases", name, "kind"), f'found {case.kind}; "{case.follows}" is {cases[case.follows].kind}.'
        for key in case.present(("group", "action")):
            other = first.setdefault((key, getattr(case, key)), case)
            same = ("kind", "asce") if key == "group" else ("kind", "asce", "group")
            for which in same:
                if getattr(other, which) != getattr(case, which):
                    found = f"found {getattr(case, which)} and {getattr(other, which)}"
                    yield ("cases", name, key), f"{found}; the cases of one {key} must have the same {which}."


def growing_in(cases: Cases) -> tuple[str, ...]:
    """Load cases of [cases] that are neither permanent nor preloads; checks of overturning increase their factors."""
    own = {name: cases.get(case.follows or name, case) for name, case in cases.items()}
    still = ("permanent", "preload", "D", "P")
    return tuple(name for name, case in own.items() if (case.kind or case.asce) not in still)


def missing_in(cases: Cases, known: Sequence[str], code: Code) -> str:
    """Error message that names the load cases without the key ``kind`` (EN 1990) or ``asce``; empty if all have it."""
    key = _KEY_OF[code]
    named = {name for name, case in cases.items() if case.follows is not None or getattr(case, key) is not None}
    missing = ", ".join(f"[cases.{case}]" for case in known if case not in named)
    return f'generate = "{code}" needs a role of each load case; give the key {key} in {missing}.' if missing else ""


def actions_of(cases: Cases, positions: Positions, code: Code) -> tuple[Action, ...]:
    """Return the load cases as actions of a design code; each position of a moving load is an alternative."""
    exclusive: dict[tuple[str, str], dict[tuple[str, str], list[str]]] = {}
    for name, case in cases.items():
        if case.follows is None:
            part = ("action", case.action) if case.action else ("case", name)
            together = ("group", case.group) if case.group else part
            if code == "en1990" and case.kind in ("accidental", "seismic"):
                together = ("kind", case.kind)  # Only one such action acts at a time (EN 1990, 6.11b and 6.12b).
            exclusive.setdefault(together, {}).setdefault(part, []).append(name)

    def alternatives(names: list[str]) -> Iterator[dict[str, tuple[float, ...]]]:
        """Yield the alternatives of an action: one or more of its parts, each moving load at one position."""
        choices: list[list[dict[str, tuple[float, ...]]]] = []
        for name in names:
            followers = [other for other in cases if cases[other].follows == name]
            own = positions.get(name, (name,))
            choices.append([dict.fromkeys((at, *followers), cases[name].representative) for at in own])
        for chosen in product(*([*of_part, {}] for of_part in choices)):
            if any(chosen):
                yield dict(chain.from_iterable(part.items() for part in chosen))

    result = []
    for parts in exclusive.values():
        role = getattr(cases[next(iter(parts.values()))[0]], _KEY_OF[code])
        every = chain.from_iterable(alternatives(names) for names in parts.values())
        result.append(Action(role, tuple(islice(every, MOST_GENERATED + 1))))
    return tuple(result)
