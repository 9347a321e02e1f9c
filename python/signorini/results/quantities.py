"""Registry of quantities: name, symbol, unit, JSON key, kind, and the files in which each quantity appears.

JSON, tables, envelopes, half-widths, thresholds, pictures and the terminal take names and paths from this registry. The
"home" of a number is the kind of its owner: a field, a support, a probe and so on.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import Literal, NamedTuple

import numpy as np

from signorini import _core
from signorini.base.remade import short
from signorini.design.en1992_bending import Bars
from signorini.discretise.rows import Floats, Ints
from signorini.errors import InputError, unknown
from signorini.model import Check, Model, Support
from signorini.model.check import OVERTURNING
from signorini.model.whole import Units

Path = tuple[str | int, ...]
"""Path of a number in results.json: keys and indices from the root of a combination."""
Home = Literal[
    "field", "mean", "support", "point", "corner", "probe", "section", "strip", "station", "punching", "check"
]
Key = tuple[Home, int | str, str]


@dataclass(frozen=True)
class Kind:
    """A kind of numbers that are compared with each other: they have the same unit and similar magnitude."""

    force: int = 0  # exponents of force and of length in the unit
    length: int = 0
    singular: str = ""  # name in `Singularity.numbers`; empty for kinds that are never singular
    colours: str = "RdBu"  # name of the colour map in pictures; its middle colour means zero

    def unit(self, units: Units) -> str:
        """Unit of numbers of this kind in a model's units; empty if the model does not name its units."""
        if self.force:
            return units.force_by_length(self.length)
        return f"{units.length}{'²' if self.length == 2 else ''}" if units.length and self.length else ""


KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "deflection": Kind(0, 1, "deflection", "RdBu"),
        "rotation": Kind(0, 0, "rotation", "PiYG"),
        "moment": Kind(1, 0, "moment", "BrBG"),
        "shear": Kind(1, -1, "shear", "PRGn"),
        "stress": Kind(1, -2, "moment", "RdYlBu"),
        "shear_stress": Kind(1, -2, "shear", "PRGn"),
        "reinforcement": Kind(0, 1, "moment", "RdGy"),
        "couple": Kind(1, 1),
        "force": Kind(1, 0),
        "reaction": Kind(1, 0, "reaction"),
        "pressure": Kind(1, -2, "pressure", "PuOr"),
        "per_length": Kind(1, -1, "pressure"),
        "corner": Kind(1, 0, "reaction"),
        "area": Kind(0, 2),
        "length": Kind(0, 1),
        "part": Kind(),
        "count": Kind(),
        "angle": Kind(),
    }
)


@dataclass(frozen=True)
class Quantity:
    """One quantity, such as mx or a reaction: name, kind, key, and the files in which its numbers appear."""

    name: str  # name in tables and thresholds, such as "mx"
    kind: str  # name of the kind in `KINDS`
    words: str = ""  # name in words with the symbol; a description may follow after a comma
    key: Path = ()  # keys and indices in results.json below the owner; if empty, ``name`` is the key
    # name of the vector of which the quantity is a component; the ± of one component considers those of all components
    vector: str = ""
    tabled: bool = True  # whether tables have a column for the quantity
    enveloped: bool = True  # whether envelopes contain extremes of the quantity
    along_paths: bool = True  # whether load paths list the quantity at every stop
    parents: tuple[str, ...] = ()  # names of the fields that the quantity's formula uses

    @property
    def path(self) -> Path:
        """Keys and indices in results.json below the owner: ``key`` or, if this is empty, the name."""
        return self.key or (self.name,)

    @property
    def singular(self) -> str:
        """Name of the quantity in `Singularity.numbers`; empty if the quantity is never singular."""
        return KINDS[self.kind].singular

    def unit(self, units: Units) -> str:
        """Unit of the quantity in a model's units; empty if the model does not name units."""
        if self.kind == "moment" and units.length and units.force:
            # Moments have the unit force × length per length of the section.
            return f"{units.force} {units.length}/{units.length}"
        if self.kind == "reinforcement" and units.length:
            return f"{units.length}²/{units.length}"
        return KINDS[self.kind].unit(units)

    def label(self, units: Units) -> str:
        """Description of the quantity with its unit.

        Examples
        --------
        >>> FIELDS["mx"].label(Units(length="m", force="kN")), FIELDS["qx"].label(Units(length="m", force="kN"))
        ('moment mx [kN m/m]', 'shear qx [kN/m]')
        """
        unit = self.unit(units)
        what, comma, more = self.words.partition(", ")
        return f"{what} [{unit}]{comma}{more}" if unit else self.words


def _by_name(quantities: Sequence[Quantity]) -> Mapping[str, Quantity]:
    return MappingProxyType({one.name: one for one in quantities})


LINEAR = _by_name(
    [
        Quantity("deflection", "deflection", "deflection, positive down"),
        Quantity("rotation_x", "rotation", "rotation θx", ("rotation", 0), "rotation"),
        Quantity("rotation_y", "rotation", "rotation θy", ("rotation", 1), "rotation"),
        Quantity("mx", "moment", "moment mx", ("moment", 0), "moment"),
        Quantity("my", "moment", "moment my", ("moment", 1), "moment"),
        Quantity("mxy", "moment", "moment mxy", ("moment", 2), "moment"),
        Quantity("qx", "shear", "shear qx", ("shear", 0), "shear"),
        Quantity("qy", "shear", "shear qy", ("shear", 1), "shear"),
    ]
)
"""Fields that are linear in the solution, in the order in which arrays (..., 8) have them along the last axis."""


@dataclass(frozen=True)
class Derived:
    """The c fields that one formula computes from moments (..., 3), shears (..., 2) and thickness (...).

    ``formula`` is the name of a formula of the core, see `core/src/fields.rs`, or a function. Only fields whose formula
    is in the core have envelopes.
    """

    formula: str | Callable[[Floats, Floats, Floats], Floats]
    quantities: tuple[Quantity, ...]
    inputs: tuple[str, ...] = ("mx", "my", "mxy")  # names of the fields that a formula of the core reads
    of_bars: bool = False  # whether `Reinforcement.face` replaces moments at columns by means

    def values(self, moment: Floats, shear: Floats, thickness: Floats, bars: Bars | None) -> Floats:
        """Values (..., c) of the fields; ``bars`` are `Model.bars`."""
        if not isinstance(self.formula, str):
            return self.formula(moment, shear, thickness)
        inputs = np.ascontiguousarray(shear if self.inputs == ("qx", "qy") else moment, np.float64)
        shape, of = inputs.shape[:-1], inputs.reshape(-1, inputs.shape[-1])
        depth = np.array(np.broadcast_to(thickness, shape), np.float64).ravel()
        return _core.evaluate(self.formula, of, depth, bars or ()).reshape(*shape, len(self.quantities))


def _of_face(face: str) -> Iterator[Quantity]:
    for place, (name, symbol) in enumerate((("sx", "σx"), ("sy", "σy"), ("txy", "τxy"))):
        yield Quantity(f"{name}_{face}", "stress", f"stress {symbol} at the {face}", ("stress", face, place), "stress")


DERIVED = (
    Derived(
        "principal",
        tuple(
            Quantity(
                *(name, "moment", f"principal moment {name}", ("principal_moment", place), "principal_moment"),
                parents=("mx", "my", "mxy"),
            )
            for place, name in enumerate(("m1", "m2"))
        ),
    ),
    Derived(
        "angle",
        (Quantity("m_angle", "angle", "angle of m1", ("principal_moment", 2), tabled=False, enveloped=False),),
    ),
    Derived(
        "design",
        tuple(
            Quantity(
                f"m{axis}_{face}",
                "moment",
                f"design moment along {axis} at the {face}",
                ("design_moment", face, place),
                f"design_moment {face}",
                parents=(f"m{axis}", "mxy"),
            )
            for face in ("bottom", "top")
            for place, axis in enumerate("xy")
        ),
        of_bars=True,
    ),
    Derived(
        "face",
        (
            *_of_face("top"),
            *_of_face("bottom"),
            Quantity("von_mises", "stress", "von Mises stress", ("stress", "von_mises", 0), "stress"),
            Quantity(
                "von_mises_bottom",
                "stress",
                "von Mises stress at the bottom",
                ("stress", "von_mises", 1),
                "stress",
                False,
                False,
            ),
        ),
    ),
    Derived(
        "shear",
        (
            Quantity("txz", "shear_stress", "shear stress τxz", ("stress", "shear", 0), "shear stress"),
            Quantity("tyz", "shear_stress", "shear stress τyz", ("stress", "shear", 1), "shear stress"),
        ),
        ("qx", "qy"),
    ),
    Derived(
        "steel",
        tuple(
            Quantity(
                f"as_{axis}_{face}",
                "reinforcement",
                f"required As along {axis} at the {face}",
                ("as", face, place),
                f"as {face}",
                parents=(f"m{axis}", "mxy"),
            )
            for face in ("bottom", "top")
            for place, axis in enumerate("xy")
        ),
        of_bars=True,
    ),
)
"""Fields that are computed from moments, shears and thickness."""

DESIGN_MOMENTS: Mapping[str, float] = MappingProxyType(
    {f"m{axis}_{face}": sign for face, sign in (("bottom", 1.0), ("top", -1.0)) for axis in "xy"}
)
"""Sign of each design moment: +1 for reinforcement at the bottom, −1 at the top."""
REINFORCEMENT: Mapping[str, str] = MappingProxyType({f"as_{name[1:]}": name for name in DESIGN_MOMENTS})
"""Name of the design moment that determines each field of required reinforcement."""
FIELDS: Mapping[str, Quantity] = _by_name(
    [*LINEAR.values(), *(one for of in DERIVED for one in of.quantities if one.enveloped)]
)
"""Every field at the nodes, by name."""
OF_BARS = frozenset(one.name for of in DERIVED if of.of_bars for one in of.quantities)
"""Names of the fields for the design of bars: design moments and required reinforcement."""
PEAKING: Mapping[str, Quantity] = _by_name([one for one in FIELDS.values() if one.singular in ("moment", "shear")])
"""Fields whose extremes exclude singular places, by name. Singular deflections grow too slowly to be excluded."""
RESULTANTS = tuple(name for name in LINEAR if name in PEAKING)
"""Names of moments and shears: mx, my, mxy, qx, qy."""
PRESSURE = Quantity("pressure", "pressure", "contact pressure, positive up", tabled=False, enveloped=False)
PICTURED = {**FIELDS, PRESSURE.name: PRESSURE}
"""Quantities that pictures and profiles can show, by name."""
AT_PROBES: tuple[Quantity, ...] = tuple(
    one if one.name == "deflection" else replace(one, along_paths=False)
    for one in (*LINEAR.values(), PRESSURE, *(one for of in DERIVED for one in of.quantities))
)


def in_model(model: Model, quantities: Iterable[Quantity]) -> tuple[Quantity, ...]:
    """The ``quantities`` that a model has: all, but required reinforcement only with [reinforcement]."""
    return tuple(one for one in quantities if one.kind != "reinforcement" or model.bars)


def with_extremes(model: Model) -> tuple[str, ...]:
    """Names of the fields whose extremes a result has: the deflection, moments, shears and fields derived from them."""
    return ("deflection", *(one.name for one in in_model(model, PEAKING.values())))


OF_SUPPORTS = (
    Quantity("reaction", "reaction", "reaction, total, positive up"),
    Quantity("closed", "count", "closed, number of closed points", enveloped=False),
    Quantity("open", "count", "open, number of open points", enveloped=False),
    Quantity("closed_part", "part", "closed part, 0 to 1", tabled=False),
    Quantity("lifted_part", "part", "lifted part, 1 − closed part", tabled=False),
)
OF_AREAS = (
    Quantity("max_pressure", "pressure", "max pressure, positive up"),
    Quantity("contact_area", "area", "contact area"),
    Quantity("max_tension", "pressure", "max tension, pulling the plate down", tabled=False, along_paths=False),
)
OF_RESULTANTS = (
    *(
        Quantity(
            *(
                f"eccentricity_{axis}",
                "length",
                f"eccentricity e{axis} of the reaction, from the area's centroid",
                ("eccentricity", at),
            ),
            *("eccentricity", True, False, False),
        )
        for at, axis in enumerate("xy")
    ),
    Quantity("kern", "part", "kern, eccentricity relative to the edge of the kern in the same direction"),
)
"""Quantities of the resultant reaction of an area support."""
OF_LINES = tuple(
    Quantity(f"{side}_per_length", "per_length", f"{side} per length, of the reaction, positive up", along_paths=False)
    for side in ("max", "min")
)
"""Quantities of supports along edges, lines and circles."""
AT_CORNERS = Quantity("reaction", "corner", "concentrated force", (), "", False, False, False)
"""Concentrated force at a corner or end of a support's line."""
OF_LIMITED_AREAS = (
    Quantity("yielded_area", "area", "yielded area, pressure at its limit", tabled=False, along_paths=False),
)
OF_POINTS = (
    Quantity("reaction", "reaction", "reaction, positive up"),
    Quantity("gap", "deflection", "gap, remaining free travel"),
)
OF_TURNING_POINTS = tuple(
    Quantity(
        f"moment_{axis}",
        "couple",
        f"moment {axis}, couple on θ{axis} of the plate",
        ("moment", at),
        "moment",
    )
    for at, axis in enumerate("xy")
)
OF_POINTS_WITH_LAWS = (
    Quantity("piece", "count", "piece of the law, counted from 0 at the least travel", (), "", False, False, False),
)
OF_BOLTS = (
    Quantity("preload", "reaction", "preload, sum over the bolts", enveloped=False, along_paths=False),
    Quantity("prying", "part", "prying, −Σ reaction of the bolts / upward load", tabled=False, along_paths=False),
)
"""Quantities of supports with bolts."""
AT_BOLTS = (
    Quantity("tightened_to", "reaction", "tightened to, last tightening force", enveloped=False, along_paths=False),
    Quantity(
        "preload", "reaction", "preload, force of the bolt before other loads", enveloped=False, along_paths=False
    ),
    Quantity("change", "reaction", "change, reaction − preload", enveloped=False, along_paths=False),
)
"""Quantities of each bolt."""
THROUGH = (
    Quantity("moment", "couple", "moment, ∫ mₙₙ ds"),
    Quantity("twist", "couple", "twist, ∫ mₙₛ ds"),
    Quantity("shear", "force", "shear, ∫ qₙ ds"),
)
"""Integrals of moment, twist and shear along sections."""
MEANS = (
    Quantity("moment", "moment", "moment, mean of mₙₙ"),
    Quantity("twist", "moment", "twist, mean of mₙₛ"),
    Quantity("shear", "shear", "shear, mean of qₙ"),
    *(
        Quantity(f"{name}_{face}", kind, f"{words} along the strip at the {face}", (key, face))
        for name, kind, words, key in (
            ("moment", "moment", "design moment", "design_moment"),
            ("as", "reinforcement", "required As", "as"),
        )
        for face in ("bottom", "top")
    ),
)
"""Means of moment, twist and shear across a strip at its stations; design moments and areas of bars along it."""
OF_STRIPS = tuple(
    Quantity(f"{side}_moment", "moment", f"{side} moment, of the means at the strip's stations", tabled=False)
    for side in ("max", "min")
)
OF_COLUMNS = (
    Quantity("u0", "length", "u0, length of the column's face", tabled=False, along_paths=False),
    Quantity("u1", "length", "u1, length of the control perimeter (ACI: bo)", enveloped=False, along_paths=False),
    Quantity("force", "force", "force of the column, positive towards the plate", along_paths=False),
    Quantity("inside", "force", "inside, force within u1, subtracted from the column's force", along_paths=False),
    *(
        Quantity(
            f"moment_{axis}",
            "couple",
            f"moment, force × its distance from the column's centre along {axis}",
            ("moment", at),
            "moment",
        )
        for at, axis in enumerate("xy")
    ),
    Quantity("beta", "part", "β, largest shear stress / mean shear stress", enveloped=False, along_paths=False),
    Quantity("v_ed", "stress", "vEd, shear stress at u1"),
    Quantity("v_ed_face", "stress", "vEd at u0, shear stress at the column's face", along_paths=False),
    Quantity("v_rd_c", "stress", "vRd,c, resistance without shear reinforcement", enveloped=False, along_paths=False),
    Quantity("v_rd_max", "stress", "vRd,max, largest resistance", tabled=False, along_paths=False),
    Quantity("utilisation", "part", "utilisation, without shear reinforcement"),
    Quantity("with_links", "part", "utilisation, with the most shear links allowed", along_paths=False),
    Quantity("asw", "length", "asw, required area of links per radial length", along_paths=False),
    Quantity("uout", "length", "uout, length of the perimeter outside of which no links are needed", along_paths=False),
)
"""Quantities of punched columns."""
OF_SHEAR = tuple(one for one in OF_COLUMNS if one.name in ("force", "inside", "beta", "v_ed", "v_rd_c", "utilisation"))
"""Quantities of punched columns that the terminal prints."""
_SUPPORTS = (*OF_SUPPORTS, *OF_AREAS, *OF_LINES, *OF_LIMITED_AREAS, *OF_BOLTS)
_POINTS = (*OF_POINTS, *OF_TURNING_POINTS, *AT_BOLTS)
BY_LIST: Mapping[str, tuple[Quantity, ...]] = MappingProxyType(
    {
        **dict.fromkeys(("supports", "contacts"), _SUPPORTS),
        **dict.fromkeys(("points", "nodes", "corners", "joints"), _POINTS),
        "line": (
            Quantity("reaction", "per_length", "reaction per length, positive up"),
            Quantity("couple", "moment", "couple per length, positive where the plate sags"),
        ),
        "governing_reactions": tuple(Quantity(key, "reaction") for key in ("max", "min", "max_with", "min_with")),
        "probes": AT_PROBES,
        "sections": THROUGH,
        "strips": OF_STRIPS,
        "punching": OF_COLUMNS,
        "stations": (*MEANS, *PICTURED.values()),
        "": tuple(PICTURED.values()),
    }
)
"""Quantities of the entries of each list in results.json, by the list's key; those of fields have the key ""."""
OF_CHECKS = (
    Quantity("value", "part", "value that governs a check", enveloped=False, along_paths=False),
    Quantity("utilisation", "part", "utilisation, value / limit", enveloped=False),
)
SIDES = ("max", "min")
MEAN_SIDES = ("max_mean", "min_mean")
"""Names of the largest and the smallest of a field's means, over the points at which the field is singular."""
ENDS = (*SIDES, *MEAN_SIDES)
EXTREMES: tuple[Home, ...] = ("field", "mean")
"""Homes (kinds of owner) of two kinds of extremes: of fields, and of their means at singular places."""
_OF_ONE: tuple[Home, ...] = ("support", "point", "corner", "strip")
"""Homes (kinds of owner) whose numbers are computed separately for each owner, such as each support."""
_OF_ANSWERS = ("prying", "piece")
"""Names of quantities that are computed from a complete answer and do not follow from superposed readings."""
SMOOTH = frozenset(
    (
        *("contact_area", "max_pressure", "closed_part", "lifted_part", "max_moment", "min_moment"),
        *("max_per_length", "min_per_length", "v_ed", "kern", "utilisation"),
    )
)
"""Names of quantities that are not linear in the load, even while the contact state does not change."""


def derived(
    quantities: Sequence[str], moment: Floats, shear: Floats, thickness: Floats, bars: Bars | None = None
) -> Floats:
    """Values (..., f) of f derived fields, from moments (..., 3), shears (..., 2) and thickness (...).

    Required reinforcement also needs ``bars``, `Model.bars`.

    Examples
    --------
    >>> derived(["m1", "m2", "m_angle"], np.array([3.0, 3.0, 1.0]), np.zeros(2), np.array(1.0)).tolist()
    [4.0, 2.0, 45.0]
    """
    result = np.empty((*moment.shape[:-1], len(quantities)))
    for of in DERIVED:
        names = [one.name for one in of.quantities]
        if wanted := [place for place, name in enumerate(quantities) if name in names]:
            values = of.values(moment, shear, thickness, bars)
            result[..., wanted] = values[..., [names.index(quantities[place]) for place in wanted]]
    return result


def quantity_at(keys: Sequence[str]) -> Quantity | None:
    """Quantity of a number in results.json, given the keys of its path without indices; None if it has no quantity."""
    owner = next((key for key in reversed(keys) if key in BY_LIST), "")
    named = {key: one for one in BY_LIST[owner] for key in (one.path[0], one.name)}
    return next((named[key] for key in reversed(keys) if key in named), None)


def along_strips(what: str, through: Floats, thickness: Floats, axis: Ints, bars: Bars | None) -> Floats:
    """Design moments or required reinforcement (..., c) of bars along strips at c stations.

    ``through`` (..., c, 3) are means of moment, twist and shear; the design moments are moment ± |twist|. ``axis`` (c,)
    is 0 for strips along x, 1 along y; the reinforcement of other strips is NaN.
    """
    moment, twist, shear = through[..., 0], through[..., 1], np.zeros((*through.shape[:-1], 2))
    quantity, face = what.split("_")
    # With the moment |twist| across the strip, the design moments along it are moment ± |twist| at both faces.
    along_x, along_y = (
        np.stack([*pair, twist], axis=-1) for pair in ((moment, np.abs(twist)), (np.abs(twist), moment))
    )
    if quantity == "moment":
        return derived([f"mx_{face}"], along_x, shear, thickness)[..., 0]
    x, y = (
        derived([f"as_{name}_{face}"], of, shear, thickness, bars)[..., 0]
        for name, of in (("x", along_x), ("y", along_y))
    )
    return np.where(axis == 0, x, np.where(axis == 1, y, np.nan))


class FieldGroup(NamedTuple):
    """Fields ``names`` whose envelopes are computed together; ``wanted`` are their indices in the formulas' results."""

    names: tuple[str, ...]
    inputs: tuple[str, ...]
    formulas: tuple[str, ...]
    wanted: tuple[int, ...]
    of_bars: bool = False


def field_groups(fields: Iterable[str]) -> Iterator[FieldGroup]:
    """Group fields by the inputs of their formulas; each field that is linear in the solution is a group by itself."""
    names = list(fields)
    own = {one.name for of in DERIVED for one in of.quantities}
    yield from (FieldGroup((name,), (name,), ("sum",), (0,)) for name in names if name not in own)
    for inputs, of_bars in dict.fromkeys((of.inputs, of.of_bars) for of in DERIVED):
        alike = [of for of in DERIVED if (of.inputs, of.of_bars) == (inputs, of_bars)]
        those = [of for of in alike if any(one.name in names for one in of.quantities)]
        values = [one.name for of in those for one in of.quantities]
        wanted = [place for place, name in enumerate(values) if name in names]
        if wanted:
            formulas = tuple(of.formula for of in those if isinstance(of.formula, str))
            yield FieldGroup(tuple(values[place] for place in wanted), inputs, formulas, tuple(wanted), of_bars)


@dataclass(frozen=True)
class Number:
    """A number of a result, without its value: quantity, owner, and its names in files."""

    quantity: Quantity
    home: Home  # kind of the owner, such as "support"
    owner: int  # index of the owner in the model's table; for extremes, number of the field and plate
    path: Path  # keys and indices that lead to the number in results.json
    subject: str  # name of the owner in columns and thresholds
    part: int = 0  # index, from 0, of the support's point or the strip's station that has the number
    tabled: bool = True  # whether tables have a column for the number
    estimated: bool = True  # whether it has a half-width, from comparison with other meshes
    check: Check | None = None  # the check, if the owner is a check

    @property
    def column(self) -> str:
        """Name of the number's column in tables."""
        what = self.what
        if self.home in ("support", "punching", "check", *EXTREMES):
            return f"{what}:{self.subject}"
        return f"{what}_at:{self.subject}" if self.home == "point" else f"{self.subject}:{what}"

    @property
    def name(self) -> str:
        """Name of the number in thresholds, such as "bolts[1].reaction"."""
        return f"{'check:' * (self.home == 'check')}{self.subject}.{self.what}"

    @property
    def what(self) -> str:
        """Name of the quantity; for an extreme of a field the name of the extreme, such as "max"."""
        return str(self.path[-1]) if self.home in EXTREMES else self.quantity.name

    @property
    def group(self) -> tuple[Home, int, str]:
        """Key of the numbers that are computed together: home, owner (0 for all owners of the home), and name."""
        return self.home, self.owner if self.home in _OF_ONE else 0, self.what

    @property
    def key(self) -> Key:
        """Home, owner (for extremes the name of the extreme), and name of the quantity."""
        return self.home, self.what if self.home in EXTREMES else self.owner, self.quantity.name

    @property
    def over_plates(self) -> bool:
        """Whether the number is an extreme over all plates, not an extreme of one of several plates."""
        return self.home in EXTREMES and self.path[0] != "plates"

    @property
    def envelope_path(self) -> Path:
        """Path of the number's extremes in an envelope's JSON; for probes and points it ends in the quantity's name."""
        if self.home in EXTREMES:
            plate = self.path[:2] if self.path[0] == "plates" else ()
            return (*plate, "fields", self.quantity.name)
        own = len(self.path) - len(self.quantity.path)
        return (*self.path[:own], self.quantity.name) if self.home in ("probe", "point", "punching") else self.path

    @property
    def ties(self) -> tuple[str, str, int]:
        """Key of the numbers that are compared with each other: same home and kind; pressures and areas by support."""
        kind = self.quantity.kind
        return self.home, kind, self.owner if kind in ("pressure", "area", "per_length") else -1


def on_plate(field: str, plate: str) -> str:
    """Name of a field in columns of tables: "plate.field" for one of several plates, else the field's name."""
    return f"{plate}.{field}" if plate else field


def place_of(model: Model, index: int) -> Path:
    """Path of support number ``index`` in results.json; contacts, which have the last indices, have their own list."""
    first = len(model.support) - len(model.contact)
    return ("supports", index) if index < first else ("contacts", index - first)


def of_support(support: Support) -> tuple[Quantity, ...]:
    """Quantities of a support as a whole, which depend on its kind."""
    area, bolt = support.area is not None, support.is_bolt
    limited = OF_LIMITED_AREAS * (area and support.can_yield)
    return OF_SUPPORTS + (OF_AREAS + OF_RESULTANTS) * area + OF_LINES * support.along_line + limited + OF_BOLTS * bolt


def measures(check: Check, number: Number) -> bool:
    """Whether a check measures a number: `Check.of` is its name, with ``[*]`` for any index, or its field."""
    if number.home in EXTREMES and number.subject == check.of:
        return True
    pattern = re.escape(check.of).replace(r"\[\*\]", r"\[[^\]]+\]")
    return number.home != "check" and re.fullmatch(pattern, number.name) is not None


def _of_check(quantity: Quantity, check: Check, index: int, numbers: Sequence[Number]) -> Number:
    """The value or utilisation of a check as a number; raise `InputError` if the check measures no number."""
    kinds = [one.quantity.kind for one in numbers if measures(check, one)]
    if not kinds and check.of != OVERTURNING:
        others = (one for one in numbers if one.home != "check")
        known = dict.fromkeys(one.subject if one.home in EXTREMES else one.name for one in others)
        raise InputError(unknown("field or number", check.of, [*known, OVERTURNING]), place=("check", index, "of"))
    if quantity.name == "value" and kinds:
        quantity = replace(quantity, kind=kinds[0])
    elif not kinds:
        quantity = replace(quantity, along_paths=False)
    path = ("checks", index, quantity.name)
    return Number(quantity, "check", index, path, check.name, 0, True, not kinds and quantity.name == "value", check)


def _is_tabled(model: Model, number: Number) -> bool:
    """Whether a number has a column only because a check measures it; numbers that cannot be superposed have none."""
    line = number.what in ("closed_part", "lifted_part") and model.support[number.owner].along_line
    missing = bool(model.plates) or line or number.what in _OF_ANSWERS
    return not (missing or number.tabled) and any(measures(check, number) for check in model.check)


def _require_unique(numbers: Sequence[Number], model: Model) -> None:
    """Raise `InputError` if two numbers have one name, such as those of a support "a[1]" and of point 1 of "a"."""
    first: dict[str, Number] = {}
    for one in numbers:
        if (other := first.setdefault(one.name, one)) is not one:
            table = {"point": "support", "corner": "support", "station": "strip"}.get(one.home, one.home)
            index = model.columns[one.owner].table if one.home == "punching" else one.owner
            why = (
                f'"{one.name}" is a number of a {other.home} and of another {one.home}. Give one of them another name.'
            )
            raise InputError(why, (table, index, "name"))


def of_points(support: Support) -> tuple[Quantity, ...]:
    """Quantities of each point of a support at points."""
    turning = OF_TURNING_POINTS * (bool(support.rotational))
    return OF_POINTS + AT_BOLTS * support.is_bolt + turning + OF_POINTS_WITH_LAWS * support.has_pieces


@dataclass(frozen=True, eq=False)
class Catalogue:
    """Ordered list of the numbers of a model's results, without lists whose length depends on the mesh."""

    numbers: tuple[Number, ...]
    in_plates: tuple[tuple[tuple[int, int], ...], ...] = ()
    """With several plates, pairs of a plate and the index in its catalogue, for each number; see `of_plates`."""

    @classmethod
    def of(
        cls,
        model: Model,
        points: Sequence[int],
        gaps: Sequence[bool],
        corners: Mapping[int, int],
        fields: Sequence[str],
    ) -> Catalogue:
        """List a model's numbers; ``fields`` are the fields whose extremes are listed.

        For each support, ``points`` is the number of its points, and ``gaps`` whether they can open. ``corners`` is the
        number of corners of a line, by index of the support.
        """
        result: list[Number] = []
        for index, (support, count, opens) in enumerate(zip(model.support, points, gaps, strict=True)):
            for one in of_support(support):
                # On lines and areas counts of closed points have no half-width (±): they grow as the mesh is refined.
                told = one.kind != "count" or support.place == "at"
                path: Path = (*place_of(model, index), *one.path)
                result.append(Number(one, "support", index, path, support.name, 0, one.tabled, told))
            for point in range(count if support.place == "at" else 0):
                for one in of_points(support):
                    path = (*place_of(model, index), "points", point, *one.path)
                    tabled, told = one.tabled and (opens or one.name != "gap"), one.kind != "count"
                    subject = f"{support.name}[{point + 1}]"
                    result.append(Number(one, "point", index, path, subject, point, tabled, told))
            for corner in range(corners.get(index, 0)):
                path = (*place_of(model, index), "corners", corner, *AT_CORNERS.path)
                subject = f"{support.name} corner[{corner + 1}]"
                result.append(Number(AT_CORNERS, "corner", index, path, subject, corner, AT_CORNERS.tabled))
        on_areas = {of for one in model.support if one.area is not None for of in one.between or (one.plate,)}
        for index, plate in enumerate(probe.plate for probe in model.probe for _ in probe.at):
            for one in in_model(model, AT_PROBES):
                if one.name != PRESSURE.name or plate in on_areas:
                    # The angle has no half-width, since it is undefined where both principal moments are equal.
                    path, told = ("probes", index, *one.path), one.kind != "angle"
                    result.append(Number(one, "probe", index, path, f"probe[{index + 1}]", 0, one.tabled, told))
        for index, section in enumerate(model.section):
            for one in THROUGH:
                result.append(Number(one, "section", index, ("sections", index, *one.path), f"section[{section.name}]"))
        for index, strip in enumerate(model.strip):
            subject = f"strip[{strip.name}]"
            for one in OF_STRIPS:
                result.append(Number(one, "strip", index, ("strips", index, *one.path), subject, 0, False))
            for station in range(strip.stations):
                for one in in_model(model, MEANS):
                    path = ("strips", index, "stations", station, *one.path)
                    result.append(Number(one, "station", index, path, f"{subject}[{station + 1}]", station))
        for index, column in enumerate(model.columns):
            for one in OF_COLUMNS:
                path = ("punching", index, *one.path)
                result.append(Number(one, "punching", index, path, column.subject, 0, one.tabled))
        measured = {one.group for one in result if _is_tabled(model, one)}
        result = [replace(one, tabled=one.tabled or one.group in measured) for one in result]
        enveloped = [(plate, name) for plate in ("", *model.plates) for name in fields]
        for index, (plate, name) in enumerate(enveloped):
            on, of = ("plates", plate) if plate else (), (name,) if name == "deflection" else ("fields", name)
            path, subject = (*on, *of), on_plate(name, plate)
            result += [Number(FIELDS[name], "field", index, (*path, side), subject) for side in SIDES]
            if name in PEAKING:
                result += [Number(FIELDS[name], "mean", index, (*path, side), subject) for side in MEAN_SIDES]
        for index, check in enumerate(model.check):
            result += [_of_check(one, check, index, result) for one in OF_CHECKS]
        _require_unique(result, model)
        return cls(tuple(result))

    def __len__(self) -> int:
        """Number of entries of the catalogue."""
        return len(self.numbers)

    def __repr__(self) -> str:
        """List the names of the first numbers."""
        return f"Catalogue({short(self.by_name)})"

    def __iter__(self) -> Iterator[Number]:
        """Iterate over the numbers."""
        return iter(self.numbers)

    def only(self, wanted: Callable[[Number], bool]) -> Catalogue:
        """Catalogue of only the numbers for which ``wanted`` is true, with their pairs ``in_plates``."""
        kept = [place for place, one in enumerate(self.numbers) if wanted(one)]
        in_plates = tuple(self.in_plates[place] for place in kept) if self.in_plates else ()
        return Catalogue(tuple(self.numbers[place] for place in kept), in_plates)

    @cached_property
    def in_tables(self) -> Catalogue:
        """Catalogue of the numbers that have a column in tables."""
        return self.only(lambda one: one.tabled)

    def at(self, home: Home, *names: str) -> Ints:
        """Indices of the numbers with a home and a name, one for each of q owners: (q,), or (q, k) for k names."""
        result = [self._places.get((home, name), np.zeros(0, np.int64)) for name in names]
        return result[0] if len(names) == 1 else np.stack(result, axis=-1)

    @cached_property
    def _places(self) -> Mapping[tuple[str, str], Ints]:
        places: dict[tuple[str, str], list[int]] = {}
        for place, one in enumerate(self.numbers):
            places.setdefault((one.home, one.what), []).append(place)
        return {key: np.array(of, np.int64) for key, of in places.items()}

    @cached_property
    def by_column(self) -> Mapping[str, int]:
        """Index of each number that has a column in tables, by name of the column."""
        return {one.column: place for place, one in enumerate(self.numbers) if one.tabled}

    @cached_property
    def by_name(self) -> Mapping[str, int]:
        """Index of each number, by its name in thresholds."""
        return {one.name: place for place, one in enumerate(self.numbers)}

    @cached_property
    def by_path(self) -> Mapping[Path, int]:
        """Index of each number, by its path in results.json."""
        return {one.path: place for place, one in enumerate(self.numbers)}

    @cached_property
    def groups(self) -> Mapping[tuple[Home, int, str], Ints]:
        """Indices of the numbers that are computed together, by `Number.group`."""
        groups: dict[tuple[Home, int, str], list[int]] = {}
        for place, one in enumerate(self.numbers):
            groups.setdefault(one.group, []).append(place)
        return {key: np.array(of, np.int64) for key, of in groups.items()}

    def of_members(self, each: Sequence[Floats]) -> Floats:
        """Values (..., n) of all plates' numbers, from the values of each plate; extremes are taken over the plates."""
        if not self.in_plates:
            return each[0]
        result = np.empty((*each[0].shape[:-1], len(self)))
        result[..., [place for place, of in enumerate(self.in_plates) if not of]] = np.nan
        for place, of in ((place, of) for place, of in enumerate(self.in_plates) if of):
            values = [each[plate][..., number] for plate, number in of]
            smallest = self.numbers[place].what.startswith("min")
            result[..., place] = (np.fmin if smallest else np.fmax).reduce(values)
        return result

    @cached_property
    def along_paths(self) -> Catalogue:
        """Catalogue of the numbers that load paths list at every stop, and of those that checks need."""
        checks = [one.check for one in self.numbers if one.check is not None]
        return self.only(lambda one: one.quantity.along_paths or any(measures(check, one) for check in checks))
