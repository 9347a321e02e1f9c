"""Parameters with respect to which numbers are differentiated: their paths, values, units and variants."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from signorini.errors import InputError, Place
from signorini.expression import Expression
from signorini.model import Combination, Model, validate
from signorini.model.key_units import dimension, unit_of
from signorini.studies.parameters import changed, place_of

_TABLES = ("material", "plate", "plates", "zone", "support", "contact", "load", "tightening")
"""Tables of the input whose numbers are listed as parameters."""
_POSITIVE = frozenset(
    (
        *("E", "Ex", "Ey", "Gxy", "Gxz", "Gyz", "unit_weight", "thickness", "shear_factor", "bending", "twist"),
        *("shear", "Dx", "Dy", "Dxy", "Sx", "Sy", "stiffness", "limit", "rotational_stiffness", "preload"),
    )
)
"""Keys whose values must be positive; such a parameter is changed by steps relative to its own value."""
_SIGNED = frozenset(
    (
        *("nu", "nu_xy", "D1", "gap", "settlement", "rotation", "pressure", "force", "line_load", "moment"),
        *("couple_about", "curvature", "factors"),
    )
)
"""Keys whose values may be 0 or change sign."""
_LINEAR = _SIGNED - {"nu", "nu_xy", "D1"} | {"preload", "unit_weight", "limit"}
"""Keys of loads, gaps, preloads and limits; u and λ depend linearly on them for a fixed contact state."""
_CASE = re.compile(r'case\.(?:"([^"]+)"|(.+))\.factor')


@dataclass(frozen=True)
class Parameter:
    """A number of the input of a model, or the factor of a load case in a combination if ``place`` is empty.

    ``dimension`` are the exponents of force and length in its unit.
    """

    path: str
    place: Place
    value: float
    dimension: tuple[int, int]
    unit: str
    case: str = ""

    @classmethod
    def of(cls, path: str, model: Model, tables: Mapping[str, Any], combination: Combination) -> Parameter:
        """Parameter at a key path such as ``support.soil.stiffness``, which studies use too.

        ``case.NAME.factor`` is the factor of the load case NAME in the combination.

        Raises
        ------
        InputError
            If there is no number at the path, or the number moves the mesh.
        """
        if found := _CASE.fullmatch(path):
            case, factors = found[1] or found[2], combination.factors or {}
            if case not in model.load_cases and case not in factors:
                raise InputError(f'there is no load case "{case}"; there are {", ".join(model.load_cases)}.', path)
            return cls(path, (), float(factors.get(case, 0.0)), (0, 0), "", case)
        place = place_of(path, model, tables)
        keys = [key for key in place if isinstance(key, str)]
        key = next((one for one in reversed(keys) if one in _POSITIVE | _SIGNED), "")
        if why := _stays_zero(place, model):
            raise InputError(why, path)
        if not key or place[0] not in (*_TABLES, "combination"):
            listed = ", ".join(sorted(_POSITIVE | _SIGNED))
            why = "only numbers that do not move the mesh have derivatives"
            raise InputError(f"{why}: {listed}, and case.NAME.factor.", path)
        table = _at(tables, place[: place.index(key)])
        own = table if isinstance(table, Mapping) else None
        unit, value = unit_of(key, model.units, own), _number(path, place, model, tables)
        return cls(path, place, value, dimension(key, own), unit)

    @property
    def is_positive(self) -> bool:
        """Whether the value must stay positive."""
        return any(key in _POSITIVE for key in self.place)

    @property
    def is_linear(self) -> bool:
        """Whether displacements and reactions depend linearly on the parameter, for a fixed contact state."""
        return not self.place or any(key in _LINEAR for key in self.place)

    @property
    def travels(self) -> bool:
        """Whether the parameter is a gap or a settlement of supports."""
        return any(key in ("gap", "settlement") for key in self.place)

    def varied(
        self, model: Model, tables: Mapping[str, Any], combination: Combination, value: float
    ) -> tuple[Model, Combination]:
        """The model and the combination with another value of the parameter; the combination keeps its name."""
        if not self.place:
            factors = {**(combination.factors or {}), self.case: value}
            return model, combination.model_copy(update={"factors": factors})
        other = validate(changed(tables, self.place, value))
        if self.place[0] != "combination":
            return other, combination
        return other, next(one for one in other.effective_combinations if one.name == combination.name)


def _stays_zero(place: Place, model: Model) -> str:
    """Reason why the number at a key path ``place``, a gap or settlement of 0, has no other value; empty if it has."""
    if place[0] not in ("support", "contact"):
        return ""
    support = getattr(model, place[0])[place[1]]
    if place[2] == "gap" and not support.has_gap and (support.direction == "both" or support.is_bolt):
        return (
            'the gap must stay 0: with fix or preload a gap is not allowed, and with resists = "both" it makes another '
            'kind of support. With resists = "both", give a small gap above 0 for derivatives there.'
        )
    if place[2] == "settlement" and (support.between is not None or not support.holds_w):
        return "the settlement must stay 0: the support acts between plates, or does not hold the deflection."
    return ""


def _at(tables: Any, place: Place) -> Any:
    """The value or table at a key path ``place`` in nested tables; None if the path does not exist."""
    for key in place:
        try:
            tables = tables[key]
        except (KeyError, IndexError, TypeError):
            return None
    return tables


def _number(path: str, place: Place, model: Model, tables: Mapping[str, Any]) -> float:
    """The number at a key path ``place`` of the input or, if the input does not give it, the model's default."""
    value: Any = _at(tables, place)
    if value is None:
        value = model
        for key in place:
            value = getattr(value, key, None) if isinstance(key, str) else value[key]
    if isinstance(value, Expression) and value.is_constant:
        value = value.value
    if isinstance(value, bool) or not isinstance(value, int | float):
        found = "nothing" if value is None else f'"{value}"' if isinstance(value, str) else "no number"
        raise InputError(f"found {found}; the input must give a number at this path.", path)
    return float(value)


@dataclass(frozen=True, eq=False)
class Input:
    """The input of a model as tables, and the paths of its parameters."""

    model: Model

    @cached_property
    def tables(self) -> Mapping[str, Any]:
        """Tables of the input file; for a variant of a model, the tables of the original model."""
        tables: Mapping[str, Any] = json.loads(self.model.provenance.text)
        return tables

    def paths(self, combination: Combination) -> list[str]:
        """Paths of all parameters that act in a combination, in the order of the input."""
        acting = {case for case, factor in (combination.factors or {}).items() if factor}
        listed = list[str]()
        for key in _TABLES:
            entries = self.tables.get(key)
            listed += _leaves(key, entries if entries is not None else {}, acting)
        varied = [path for path in listed if not _stays_zero(place_of(path, self.model, self.tables), self.model)]
        return varied + [f"case.{_quoted(case)}.factor" for case in sorted(acting)]


def _leaves(path: str, node: Any, acting: set[str]) -> Iterator[str]:
    """Yield the path of every number below ``node`` that may be a parameter."""
    if isinstance(node, Mapping):
        if path.startswith("load") and node.get("case", "load") not in acting:
            return
        for key, value in node.items():
            known = key in _POSITIVE | _SIGNED
            if isinstance(value, int | float) and not isinstance(value, bool) and known:
                yield f"{path}.{_quoted(key)}"
            elif known and isinstance(value, Sequence) and not isinstance(value, str):
                numbers = enumerate(value, 1)
                yield from (f"{path}.{key}[{at}]" for at, one in numbers if isinstance(one, int | float))
            elif isinstance(value, Mapping):
                yield from _leaves(f"{path}.{_quoted(key)}", value, acting)
    elif isinstance(node, Sequence) and not isinstance(node, str):
        names = [str(entry.get("name", "")) for entry in node]
        for at, (name, entry) in enumerate(zip(names, node, strict=True), 1):
            yield from _leaves(f"{path}.{_quoted(name)}" if name else f"{path}[{at}]", entry, acting)


def _quoted(name: str) -> str:
    return f'"{name}"' if re.search(r"[.\[\]]", name) else name
