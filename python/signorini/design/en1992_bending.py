"""Bending of slabs by EN 1992-1-1:2004, with its recommended values; strengths are in MPa.

The core computes the reinforcement from these numbers, `core/src/fields.rs`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from signorini.shapes.arrays import Bools, Floats

STRENGTHS = (12.0, 90.0)
"""Range of the concrete strength fck, table 3.1."""
YIELD_STRENGTHS = (400.0, 600.0)
"""Range of the yield strength fyk of bars, 3.2.2 (3)."""
GAMMA_C, GAMMA_S, ALPHA_CC = 1.5, 1.15, 1.0
"""Partial factors of concrete and steel, table 2.1N, and coefficient αcc, 3.1.6 (1)."""
_SAME = 1e-9
"""Relative tolerance within which an area of reinforcement counts as equal to the minimum reinforcement."""
MOST = 0.04
"""Largest area of bars relative to the concrete section, As / Ac, 9.2.1.1 (3)."""


class Bars(NamedTuple):
    """Reinforced concrete section in the units of the model, as the Rust core reads it."""

    bottom_x: float
    bottom_y: float
    top_x: float
    top_y: float
    """Distances of the axes of bottom and top bars, along x and along y, from the slab's face on their side."""
    block: float
    """Stress η fcd of the rectangular stress block."""
    yield_stress: float
    """Design strength fyd of the bars."""
    deepest: float
    """Largest relative depth λ x/d of the rectangular stress block."""
    least: float
    """Smallest As/d."""
    most: float
    """Largest As/h."""
    plain: float
    """Largest m/h² (moment per width m, thickness h) that needs no bars: such moments are rounding errors."""

    def are_least(self, field: str, areas: float | Floats, thickness: float | Floats) -> Bools:
        """Whether areas of a ``field``, such as "as_x_bottom", are the minimum reinforcement for a thickness."""
        _, axis, face = field.split("_")
        least = self.least * (thickness - getattr(self, f"{face}_{axis}"))
        return np.asarray(np.isclose(areas, least, rtol=_SAME, atol=0.0))


def compressive_strength(fck: float, gamma_c: float, alpha_cc: float) -> float:
    """Design strength fcd = αcc fck / γC; 3.1.6 (1)."""
    return alpha_cc * fck / gamma_c


def yield_strength(fyk: float, gamma_s: float) -> float:
    """Design strength fyd = fyk / γS, with a horizontal branch; 3.2.7 (2)."""
    return fyk / gamma_s


def tensile_strength(fck: float) -> float:
    """Mean tensile strength fctm; table 3.1.

    Examples
    --------
    >>> round(tensile_strength(30.0), 1), round(tensile_strength(60.0), 1)
    (2.9, 4.4)
    """
    return 0.3 * fck ** (2 / 3) if fck <= 50.0 else 2.12 * math.log(1.0 + (fck + 8.0) / 10.0)


def ultimate_strain(fck: float) -> float:
    """Ultimate strain εcu2 = εcu3 of concrete; table 3.1.

    Examples
    --------
    >>> round(ultimate_strain(50.0), 4), round(ultimate_strain(70.0), 4)
    (0.0035, 0.0027)
    """
    return 0.0035 if fck <= 50.0 else 0.0026 + 0.035 * ((90.0 - fck) / 100.0) ** 4


def stress_block(fck: float) -> tuple[float, float]:
    """Factors λ of the depth and η of the strength of the rectangular stress block; 3.1.7 (3)."""
    beyond = max(fck - 50.0, 0.0)
    return 0.8 - beyond / 400.0, 1.0 - beyond / 200.0


def largest_depth(fck: float) -> float:
    """Largest x/d without redistribution of moments, δ = 1 in 5.5 (4): (1 − k1)/k2 or, above C50, (1 − k3)/k4.

    Examples
    --------
    >>> round(largest_depth(30.0), 3), round(largest_depth(70.0), 3)
    (0.448, 0.326)
    """
    k1 = 0.44 if fck <= 50.0 else 0.54
    return (1.0 - k1) / (1.25 * (0.6 + 0.0014 / ultimate_strain(fck)))


def least_ratio(fck: float, fyk: float) -> float:
    """Smallest As / (bt d) = max(0.26 fctm/fyk, 0.0013); 9.2.1.1 (1), for slabs 9.3.1.1 (1)."""
    return max(0.26 * tensile_strength(fck) / fyk, 0.0013)
