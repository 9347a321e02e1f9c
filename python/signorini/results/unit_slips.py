"""Warnings about numbers of the input that are probably in another unit than the model's units."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping

import numpy as np

from signorini.base.numbers import plain
from signorini.base.units import METRES, NEWTONS
from signorini.discretise import Discretisation
from signorini.discretise.laws import constant_stiffness
from signorini.model.problems import describe

_NEWTONS = {"N": 1.0, "daN": 10.0} | NEWTONS | {"kgf": 9.80665, "kp": 9.80665, "tf": 9806.65, "t": 9806.65}
_NEWTONS |= {"lb": NEWTONS["lbf"], "kips": NEWTONS["kip"]}
_LENGTHS = {"metre": "m", "millimetre": "mm", "centimetre": "cm", "decimetre": "dm", "kilometre": "km"}
_LENGTHS |= {"inch": "in", "foot": "ft", "feet": "ft", "yard": "yd"}
_FORCES = {"newton": "N", "decanewton": "daN", "kilonewton": "kN", "meganewton": "MN", "pound": "lbf", "tonne": "tf"}
_ALIKE = 0.7
"""Smallest similarity (`difflib`) of an unknown unit to a known unit at which the known unit is suggested."""
_THICKEST = 0.5
"""Largest ratio of thickness to the plate's smaller extent without a warning. EN 1992-1-1, 5.3.1, allows a fifth for
slabs.
"""
_SOFTEST, _STIFFEST = 1e8, 1e12
"""Young's moduli of plates in Pa that cause no warning. Rubber is softer; diamond has about the largest modulus."""
_LIGHTEST, _HEAVIEST = 100.0, 3e5
"""Unit weights in N/m³ that cause no warning: from foam to osmium."""
_RIGID, _NONE = 1e3, 1e-4
"""Bounds of a support's stiffness, relative to D/h⁴ for a bed, D/h³ for a line, D/h² for a point. Above the first bound
the support is practically rigid. Below the second bound, with the plate's size in place of h, it has practically no
effect. Concrete on soil has 0.001 times the first bound and 100 times the second; a base plate on grout is at the first
bound.
"""
_POWERS = {"area": 4, "edge": 3, "line": 3, "circle": 3, "at": 2}


def unit_slips(discretisation: Discretisation) -> Iterator[str]:
    """Yield warnings about lengths, Young's modulus, unit weight and stiffnesses that seem to be in another unit."""
    yield from _unknown("length", discretisation.model.units.length, METRES, _LENGTHS)
    yield from _unknown("force", discretisation.model.units.force, _NEWTONS, _FORCES)
    yield from _of_lengths(discretisation)
    yield from _of_material(discretisation)
    yield from _of_supports(discretisation)


def _unknown(kind: str, given: str, known: Mapping[str, float], words: Mapping[str, str]) -> Iterator[str]:
    if given and given not in known:
        spelt = {unit.casefold(): unit for unit in known} | dict(words)
        near = difflib.get_close_matches(given.casefold(), spelt, n=1, cutoff=_ALIKE)
        meant = f' Did you mean "{spelt[near[0]]}"?' if near else ""
        yield (
            f"units.{kind} = {describe(given)} is an unknown unit. Known units are {', '.join(known)}; "
            f"the size of numbers is checked only with a known unit.{meant}"
        )


def _of_lengths(discretisation: Discretisation) -> Iterator[str]:
    model, thickness = discretisation.model, float(discretisation.thickness.nominal.max())
    # The smallest thickness is compared, since some models represent a stiff part by a very thick zone.
    thinnest = float(discretisation.thickness.nominal.min())
    smaller, larger = np.sort(np.ptp(discretisation.mesh.points, axis=0)).tolist()
    if thinnest > _THICKEST * smaller:
        yield (
            f"The thickness, {_length(discretisation, thinnest)}, is {plain(thinnest / smaller, 2)} times the plate's "
            f"smaller extent, {_length(discretisation, smaller)}; the thickness of a plate is at most "
            "a fifth of its extent: was another unit meant?"
        )
    if (size := model.mesh.size) is not None and size > larger:
        yield (
            f"The size of elements, {_length(discretisation, size)}, is {plain(size / larger, 2)} times the plate's "
            f"larger extent, {_length(discretisation, larger)}: was another unit meant?"
        )
    points = discretisation.points
    for support, parts in zip(model.support, discretisation.parts, strict=True):
        rows = parts.rows.ravel()
        settled = points.settlement[rows]
        moved = discretisation.held.values[3 * parts.nodes], discretisation.springs.distance[parts.springs], settled
        base = "stretch by the preload" if support.is_bolt else "settlement"
        travels = {"gap": points.distance[rows] - settled, base: np.abs(np.concatenate(moved))}
        for what, values in travels.items():
            most = float(values.max(initial=0.0))
            if most > thickness:
                yield (
                    f"The {what} of {support.name}, {_length(discretisation, most)}, is {plain(most / thickness, 2)} "
                    "times the plate's thickness: was another unit meant?"
                )


def _length(discretisation: Discretisation, value: float) -> str:
    return f"{value:.4g} {discretisation.model.units.length}".rstrip()


def _of_material(discretisation: Discretisation) -> Iterator[str]:
    model = discretisation.model
    length, force = model.units.length, model.units.force
    if force not in _NEWTONS or length not in METRES:
        return
    modulus = max((one.young for one in model.materials if one.is_elastic), default=None)
    pascals = (modulus or 0.0) * _NEWTONS[force] / METRES[length] ** 2
    if modulus is not None and not _SOFTEST <= pascals <= _STIFFEST:
        yield (
            f"E = {modulus:.4g} {force}/{length}² is {pascals:.4g} Pa; materials of plates have "
            f"{_SOFTEST:.0e} to {_STIFFEST:.0e}: was another unit meant?"
        )
    for weight in (
        dict.fromkeys(one.unit_weight for one in model.materials)
        if any(load.self_weight for load in model.load)
        else ()
    ):
        newtons = (weight or _LIGHTEST) * _NEWTONS[force] / METRES[length] ** 3
        if weight and not _LIGHTEST <= newtons <= _HEAVIEST:
            yield (
                f"unit_weight = {weight:.4g} {force}/{length}³ is {newtons:.4g} N/m³; materials of plates have "
                f"{_LIGHTEST:.0f} to {_HEAVIEST:.0f}: was another unit meant, or a mass?"
            )


def _of_supports(discretisation: Discretisation) -> Iterator[str]:
    model, thickness = discretisation.model, float(discretisation.thickness.at_points.mean())
    rigidity = model.young * thickness**3 / 12
    for support in model.support:
        if (stiffness := constant_stiffness(support)) is None:
            continue
        power = _POWERS.get(support.place, 2)
        within, over = stiffness * thickness**power / rigidity, stiffness * discretisation.mesh.size**power / rigidity
        words = f"The stiffness of {support.name}, {stiffness:.4g}, is "
        if within > _RIGID:
            yield (
                f"{words}{plain(within, 2)} times D/h^{power} of the plate with thickness h: as good as rigid. Is it "
                "in the units of E and of lengths? For a rigid support leave out its stiffness."
            )
        elif over < _NONE:
            yield (
                f"{words}{plain(over, 2)} times D/L^{power} of the plate with size L: as good as none. Is it in the "
                "units of E and of lengths?"
            )
