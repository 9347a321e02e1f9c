"""Known units of length and force, and the unit of reinforcement areas in reports."""

METRES = {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048, "yd": 0.9144}
"""Length of each known unit of length in metres, by the unit's label."""
NEWTONS = {"N": 1.0, "kN": 1e3, "MN": 1e6, "kip": 4448.2216152605, "lbf": 4.4482216152605}
"""Force of each known unit of force in newtons, by the unit's label."""


def steel_unit(length: str) -> tuple[float, str]:
    """Return factor and unit with which reports write bar areas per length: mm²/m for known units of length.

    Examples
    --------
    >>> steel_unit("m"), steel_unit("mm"), steel_unit("")
    ((1000000.0, 'mm²/m'), (1000.0, 'mm²/m'), (1.0, ''))
    """
    if length in METRES:
        return METRES[length] * 1e6, "mm²/m"
    return 1.0, f"{length}²/{length}" if length else ""
