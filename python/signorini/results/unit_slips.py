"""Numbers of a model that look as if they were in another unit, in sentences."""

from __future__ import annotations

from collections.abc import Iterator

from signorini.base.plain import plain
from signorini.base.units import METRES
from signorini.discretise import Discretisation

_NEWTONS = {"N": 1.0, "daN": 10.0, "kN": 1e3, "MN": 1e6, "kgf": 9.80665, "lbf": 4.4482216, "lb": 4.4482216}
_NEWTONS |= {"tf": 9806.65, "kip": 4448.2216, "kips": 4448.2216}
_SOFTEST, _STIFFEST = 1e8, 1e12
"""Pascals between which Young's moduli of plates are: rubber is softer, and hardly anything stiffer than diamond."""
_LIGHTEST, _HEAVIEST = 100.0, 3e5
"""Newtons per cubic metre between which their weights are: foam is lighter, and nothing heavier than osmium."""
_RIGID, _NONE = 1e3, 1e-4
"""Stiffness of a support, over D/h⁴ of a bed, D/h³ of a line, D/h² of a point, from which the plate does not feel that
it is elastic; and over the same with the plate's size, below which the plate moves as if it were free. Concrete on
soil has 0.001 of the one and 100 of the other, a base plate on grout 1 of the first."""
_POWERS = {"area": 4, "edge": 3, "line": 3, "circle": 3, "at": 2}


def unit_slips(found: Discretisation) -> Iterator[str]:
    """Ask of Young's modulus, the weight and stiffnesses whether another unit was meant."""
    yield from _of_material(found)
    yield from _of_supports(found)


def _of_material(found: Discretisation) -> Iterator[str]:
    model = found.model
    length, force = model.units.length, model.units.force
    if force not in _NEWTONS or length not in METRES:
        return
    modulus = max((one.young for one in model.materials if one.is_elastic), default=None)
    pascals = (modulus or 0.0) * _NEWTONS[force] / METRES[length] ** 2
    if modulus is not None and not _SOFTEST <= pascals <= _STIFFEST:
        yield (
            f"E = {modulus:.4g} {force}/{length}² is {pascals:.4g} Pa, and what plates are made of has "
            f"{_SOFTEST:.0e} to {_STIFFEST:.0e}: was another unit meant?"
        )
    for weight in dict.fromkeys(one.unit_weight for one in model.materials) if _weighs(found) else ():
        newtons = (weight or _LIGHTEST) * _NEWTONS[force] / METRES[length] ** 3
        if weight and not _LIGHTEST <= newtons <= _HEAVIEST:
            yield (
                f"unit_weight = {weight:.4g} {force}/{length}³ is {newtons:.4g} N/m³, and what plates are made of has "
                f"{_LIGHTEST:.0f} to {_HEAVIEST:.0f}: was another unit meant, or a mass?"
            )


def _weighs(found: Discretisation) -> bool:
    return any(load.self_weight for load in found.model.load)


def _of_supports(found: Discretisation) -> Iterator[str]:
    model, thickness = found.model, float(found.thickness.at_points.mean())
    rigidity = model.young * thickness**3 / 12
    for support in model.support:
        if support.stiffness is None or not support.stiffness.is_constant:
            continue
        stiffness, power = support.stiffness.value, _POWERS.get(support.place, 2)
        within, over = stiffness * thickness**power / rigidity, stiffness * found.mesh.size**power / rigidity
        words = f"The stiffness of {support.name}, {stiffness:.4g}, is "
        if within > _RIGID:
            yield (
                f"{words}{plain(within, 2)} times that of the plate within its thickness: as good as rigid. Is it in "
                "the units of E and of lengths? A support without stiffness is rigid."
            )
        elif over < _NONE:
            yield (
                f"{words}{plain(over, 2)} of that of the whole plate: as good as none. Is it in the units of E and of "
                "lengths?"
            )
