"""Units of length and force."""

METRES = {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048, "yd": 0.9144}
"""Metres per unit, by the label of the unit of length."""
NEWTONS = {"N": 1.0, "kN": 1e3, "MN": 1e6, "kip": 4448.2216152605, "lbf": 4.4482216152605}
"""Newtons per unit, by the label of the unit of force."""


def steel_unit(length: str) -> tuple[float, str]:
    """Factor and unit in which reports write areas of bars per length: mm²/m for known units of length.

    Examples
    --------
    >>> steel_unit("m"), steel_unit("mm"), steel_unit("")
    ((1000000.0, 'mm²/m'), (1000.0, 'mm²/m'), (1.0, ''))
    """
    if length in METRES:
        return METRES[length] * 1e6, "mm²/m"
    return 1.0, f"{length}²/{length}" if length else ""
