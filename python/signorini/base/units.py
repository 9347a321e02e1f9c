"""Units of length and force."""

METRES = {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048, "yd": 0.9144}
"""Metres per unit, by the label of the unit of length."""
NEWTONS = {"N": 1.0, "kN": 1e3, "MN": 1e6, "kip": 4448.2216152605, "lbf": 4.4482216152605}
"""Newtons per unit, by the label of the unit of force."""
