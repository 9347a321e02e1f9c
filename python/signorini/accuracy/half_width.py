"""Half-widths of numbers from several meshes; reference values of numbers: the largest number of each kind."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.zones import Rigidity, Zones
from signorini.errors import point
from signorini.mesh import Mesh
from signorini.model import Model
from signorini.results.quantities import KINDS, LINEAR, Number
from signorini.results.result import Result
from signorini.shapes.distances import distances
from signorini.singularities.singularity import Singularity

_SAFETY, _OF_BEFORE = 3.5, 0.3
"""Safety factor F in `half_widths`, and lower bound of a number's last change |d₁|, relative to the change |d₂| before.
For halved element sizes h, F assumes errors that fall as h^0.36, as slowly as a deflection under a point force. The
order that the changes show is not used: it jumps between combinations if a change is small by chance.
"""

_GROWS = 0.85
"""Smallest ratio |d₁|/|d₂| of a number's last two changes, as element sizes are halved, at which it counts as growing
without limit. The ratio is at least 0.9 at point supports and corners, and at most 0.7 for numbers that converge."""

_COUNTS = 0.02
"""Smallest change between the finest meshes, relative to the field's largest value, of a number without limit."""

ROUNDING = 1e-10
"""Smallest half-width of a number, its rounding error, relative to the largest number of its kind."""


def half_widths(
    values: Floats, sizes: Sequence[float], own: int, beside: Floats, largest: Floats, limited: Bools
) -> tuple[Floats, Bools]:
    """Estimate how far refinement will move numbers, and which numbers have no limit.

    Three meshes of sizes h₀ < h₁ < h₂ have the changes d₁ = v₀ − v₁ and d₂ = v₁ − v₂. A half-width is the distance
    from the finest mesh plus the remaining error of that mesh, |v − v₀| + F max(|d₁|, 0.3 |d₂|) / (r − 1), r = h₁/h₀.
    The second term is the grid convergence index with order 1 (P. J. Roache, *J. Fluids Eng.* 116, 1994, equation 8);
    Roache has F = 3 where the order is not known. A number that grows on every finer mesh by as much as before has no
    limit.

    Values (m, n) are those of two or three meshes, the finest first, NaN where missing; half-widths are for mesh
    ``own``. The last change counts as at least ``beside``, the change of related numbers, since one change may vanish
    by chance. ``largest`` are the largest values of each number's field. ``limited`` numbers have a limit.

    Examples
    --------
    >>> import numpy as np
    >>> values = np.array([[1.01, 3.0], [1.04, 2.0], [1.16, 1.0]])
    >>> nothing, largest, limited = np.zeros(2), np.full(2, 3.0), np.zeros(2, bool)
    >>> widths, growing = half_widths(values, [1.0, 2.0, 4.0], 0, nothing, largest, limited)
    >>> widths.round(3), growing
    (array([0.126,   nan]), array([False,  True]))
    """
    change = np.abs(values[0] - values[1])
    last = np.where((values == 0).all(axis=0), 0.0, np.fmax(change, beside))
    growing = np.zeros(change.shape, np.bool_)
    if len(values) > 2:
        before, size = np.abs(values[1] - values[2]), np.abs(values)
        last = np.fmax(last, _OF_BEFORE * before)
        growing = (
            (size[0] > size[1]) & (size[1] > size[2]) & (change >= before * _GROWS ** math.log2(sizes[2] / sizes[1]))
        )
        growing &= ~limited & (change > _COUNTS * largest) & (values[0] * values[2] > 0)
    widths = np.abs(values[own] - values[0]) + _SAFETY * last / (sizes[1] / sizes[0] - 1.0)
    widths = np.fmax(widths, np.where(np.isnan(widths), np.nan, ROUNDING * largest))
    return np.where(growing, np.nan, widths), growing


def unsettled(values: Floats, largest: Floats) -> Bools:
    """Mask (...) of numbers (2 or 3 meshes, ...) whose last change is above `_COUNTS` and half the change before it."""
    change = np.abs(values[0] - values[1])
    settles = change < 0.5 * np.abs(values[1] - values[2]) if len(values) > 2 else np.zeros(change.shape, np.bool_)
    return np.asarray(~settles & (change > _COUNTS * largest))


def rounded(widths: Floats) -> Floats:
    """Round half-widths to three significant digits."""
    known = widths > 0
    power = np.floor(np.log10(widths, where=known, out=np.zeros_like(widths))) - 2
    # Powers of ten up to 10²² are exact in double precision, so that the quotient is written with three digits.
    up, down = 10.0 ** np.maximum(power, 0), 10.0 ** np.maximum(-power, 0)
    return np.where(known, np.rint(widths * down / up) / down * up, widths)


_OF_VECTOR, _OF_POINTS = 0.5, 0.2
"""Lower bounds of a number's change from mesh to mesh, which may vanish by chance: relative to the largest change among
the components of its vector, and among the reactions of the points of its support.
"""
_BENT = 0.01
"""Lower bound of each kind's reference value, relative to the value of this kind in a plate that bends as a whole with
the largest deflection or moment.
"""


def beside(numbers: Sequence[Number], changes: Floats) -> Floats:
    """Lower bounds (n, k) of the changes of numbers from mesh to mesh: parts of the largest change of related numbers.

    Components of one vector are related, and so are the reactions of the points of one support.
    """
    groups: dict[tuple[object, ...], list[int]] = {}
    keys = [_group(one) for one in numbers]
    for place, key in enumerate(keys):
        groups.setdefault(key, []).append(place)
    result, known = np.empty_like(changes), np.nan_to_num(changes)
    for key, members in groups.items():
        quantity = numbers[members[0]].quantity
        # Principal and design moments are also related to all components of the moment, from which they follow.
        vectors = {LINEAR[name].vector for name in quantity.parents if LINEAR[name].kind == quantity.kind}
        related = [place for vector in vectors for place in groups.get((*key[:2], vector), [])]
        result[members] = known[[*members, *related]].max(axis=0)
    parts = [_OF_VECTOR if one.quantity.vector else _OF_POINTS for one in numbers]
    return np.asarray(result * np.array(parts).reshape(-1, 1))


def _group(one: Number) -> tuple[object, ...]:
    if one.quantity.vector:
        return one.home, 0 if one.home in ("field", "mean") else one.owner, one.quantity.vector
    if one.home == "point":
        return one.home, one.owner, ("points", one.what)
    return one.home, one.owner, one.path


def may_grow(
    numbers: Sequence[Number], model: Model, probes: Floats, singular: Sequence[Singularity], reach: float
) -> Bools:
    """Mask (n,) of numbers that may grow without limit, since a singularity is within the distance ``reach``.

    Numbers of a support are affected by its own singularities, extremes of fields by any singularity. Deflections grow
    everywhere if a support has a logarithmic singularity of the deflection. ``probes`` (q, 2) are the positions of
    probes.
    """
    supports = [support.name for support in model.support]
    result = np.zeros(len(numbers), np.bool_)
    for one in singular:
        near = (away(probes, one) <= max(reach, one.within)).tolist()
        whole = "deflection" in one.numbers and one.source in supports
        for place, number in enumerate(numbers):
            if number.home in ("section", "strip", "station", "mean"):
                result[place] |= "reaction" in one.numbers
            elif whole and number.quantity.kind in ("deflection", "rotation"):
                result[place] = True
            elif number.quantity.singular in one.numbers:
                own = number.home in ("support", "point") and one.source == supports[number.owner]
                result[place] |= number.home == "field" or own or (number.home == "probe" and near[number.owner])
    return result


def within_an_element(numbers: Sequence[Number], singular: Sequence[Singularity], finest: Mesh) -> Bools:
    """Mask (n,) of the means beside singularities whose width is less than one element of the finest mesh.

    Such a mean comes from the field within one element on every mesh, so that other meshes do not show its error.
    """
    result = np.zeros(len(numbers), np.bool_)
    for one in singular:
        elements = finest.locate(np.array(one.where).reshape(-1, 2)).elements
        if one.within > 0 and (2.0 * one.within < np.sqrt(finest.element_area[elements])).any():
            result |= [number.home == "mean" and one.excludes(number.quantity.singular) for number in numbers]
    return result


def away(points: Floats, singularity: Singularity) -> Floats:
    """Distances (q,) of points (q, 2) from the nearest point of a singularity."""
    where = np.array(singularity.where).reshape(-1, 2)
    begin, end = (where[:-1], where[1:]) if singularity.line else (where, where)
    return np.asarray(distances(points, begin, end).min(axis=1, initial=math.inf))


def largest_of(result: Result) -> Mapping[str, float]:
    """Reference value of every kind of number in a result: largest nodal value, sum of reactions, largest pressure."""
    each = [_largest_of_plate(plate) for plate in result.members.values()]
    return {kind: max(of[kind] for of in each) for kind in each[0]}


def _largest_of_plate(result: Result) -> Mapping[str, float]:
    def size(values: Floats) -> float:
        return float(np.abs(values).max(initial=0.0))

    areas = [np.array([s.max_pressure, s.max_tension]) for s in result.supports if s.area is not None]
    own = {name: size(getattr(result, name)) for name in ("deflection", "rotation", "moment", "shear")}
    own["reaction"] = float(sum(np.abs(support.reactions).sum() for support in result.supports))
    bent = _bent(result.model, result.mesh, np.array(own["deflection"]), np.array(own["moment"]))
    own["corner"] = own["reaction"]
    bent["corner"] = bent["reaction"]
    output = {name: max(value, bent[name].item()) for name, value in own.items()}
    scale = result.mesh.size
    stresses = {name: of.item() for name, of in _stresses(result.model, result.mesh, output).items()}
    return {
        **output,
        **stresses,
        "couple": output["moment"] * scale,
        "force": output["shear"] * scale,
        "pressure": max(map(size, areas), default=0.0),
        "per_length": max((size(s.line.reactions) for s in result.supports if s.line is not None), default=0.0),
        "area": float(result.mesh.element_area.sum()),
        "length": scale,
        "part": 1.0,
        "count": 0.0,
        "angle": 0.0,
    }


def sizes_of(values: Floats, numbers: Sequence[Number], model: Model, mesh: Mesh) -> dict[str, Floats]:
    """Reference value (k,) of every kind of number in k results: the largest of their numbers (n, k) of this kind.

    Only numbers that are both in results and in rows of tables are used. Each returned value is at least a hundredth of
    the value in a plate that bends as a whole with the given deflection or moment, since all numbers of a kind may be
    rounding errors: moments in a rigid motion, or shears in uniform bending. A hundredth of the largest gap counts as a
    deflection.
    """
    points = {one.owner for one in numbers if one.home == "point"}
    none = np.zeros(values.shape[1])
    result = dict.fromkeys(KINDS, none)
    for one, value in zip(numbers, np.nan_to_num(np.abs(values)), strict=True):
        kind = one.quantity.kind
        if kind == "reaction":
            if one.home != "support" or one.owner not in points:
                result[kind] = result[kind] + value
        elif one.home != "mean" and (
            one.home not in ("probe", "field")
            or one.quantity.name in LINEAR
            or (one.home == "field" and kind == "pressure")
        ):
            result[kind] = np.maximum(result[kind], (_BENT if one.what == "gap" else 1.0) * value)
    for kind, least in _bent(model, mesh, result["deflection"], result["moment"]).items():
        result[kind] = np.maximum(result[kind], least)
    return (
        result
        | _stresses(model, mesh, result)
        | {"area": none + mesh.element_area.sum(), "length": none + mesh.size, "part": none + 1.0, "count": none}
    )


def _bent(model: Model, mesh: Mesh, deflection: Floats, moment: Floats) -> dict[str, Floats]:
    """Lower bounds of the reference values of deflections, moments, shears and reactions, by kind of number.

    They are a hundredth of the values in a plate that bends as a whole with the given largest deflection or moment.
    They are needed since the sum of the reactions may be zero, and a plate may be bent without shears.
    """
    span, (thickness, *_) = mesh.size, sections_at(model, mesh.points)
    rigidity = model.young * float(thickness.max()) ** 3 / 12
    bent = _BENT * np.maximum(deflection, moment * span**2 / rigidity)
    of_bending = {
        "deflection": 1.0,
        "rotation": 1 / span,
        "moment": rigidity / span**2,
        "couple": rigidity / span,
        "shear": rigidity / span**3,
        "force": rigidity / span**2,
        "per_length": rigidity / span**3,
        "reaction": rigidity / span**2,
    }
    return {kind: part * bent for kind, part in of_bending.items()}


def _stresses(model: Model, mesh: Mesh, sizes: Mapping[str, Floats | float]) -> dict[str, Floats]:
    """Reference values of stresses and reinforcement: those of the largest moment and shear at the least thickness."""
    thickness = float(sections_at(model, mesh.points)[0].min())
    stress, shear = 6.0 * np.asarray(sizes["moment"]) / thickness**2, 1.5 * np.asarray(sizes["shear"]) / thickness
    bars = 0.0 * stress if model.bars is None else stress * thickness / (6.0 * model.bars.yield_stress)
    return {"stress": stress, "shear_stress": shear, "reinforcement": bars}


def sections_at(model: Model, points: Floats) -> tuple[Floats, Sequence[Rigidity], Ints]:
    """Thickness (n,) at points (n, 2), the plate's distinct rigidities, and the index (n,) of each point's rigidity.

    Where a rigidity is given in place of a thickness, the thickness is that of the equivalent solid plate.
    """
    zones, nominal = Zones.anywhere(model), np.empty(len(points))
    made = zones.made_at(points)
    for number in np.unique(made.thickness):
        mine = made.thickness == number
        nominal[mine] = np.abs(zones.formulas[number](*points[mine].T))
    return zones.acting(made.rigidity, nominal), zones.rigidities, made.rigidity


def named(numbers: Sequence[Number], model: Model, probes: Floats) -> str:
    """Text that names numbers and their owners, for warnings."""
    said: dict[str, list[str]] = {}
    for one in numbers:
        what = (one.quantity.words or one.quantity.name).partition(",")[0].replace("_", " ")
        match one.home:
            case "probe":
                whose = f"the probe at {point(probes[one.owner])}"
            case "section":
                whose = f"section {model.section[one.owner].name}"
            case "strip":
                whose = f"strip {model.strip[one.owner].name}"
            case "station":
                strip = model.strip[one.owner]
                whose = f"strip {strip.name} at {point(strip.places[0][one.part])}"
            case "punching":
                whose = model.columns[one.owner].subject
            case "support":
                whose = model.support[one.owner].name
            case "corner":
                whose, what = model.support[one.owner].name, f"{what} at corner {one.part + 1}"
            case "point":
                whose, what = model.support[one.owner].name, f"{what} of point {one.part + 1}"
            case _:
                whose, what = "the plate", f"{one.what} {what}"
        said.setdefault(whose, []).append(what)
    return "; ".join(f"{', '.join(what)} of {whose}" for whose, what in said.items())


def side(mesh: Mesh) -> float:
    """Side of the square that has the mean area of a mesh's elements."""
    return float(np.sqrt(mesh.element_area.mean()))
