"""Closed forms and series that several families of cases use."""

from __future__ import annotations

import numpy as np

KAPPA = 5 / 6
"""Shear correction factor κ."""


def rigidity(young: float, thickness: float, nu: float) -> float:
    """Bending stiffness D = E h³/12(1 − ν²) of a plate."""
    return young * thickness**3 / 12 / (1 - nu**2)


def navier(a: float, b: float, x: float, y: float, h: float, nu: float, load: str = "1") -> tuple[float, float, float]:
    """Navier's series of the hard simply supported Mindlin plate a × b: w D/q, mx/q and my/q at (x, y).

    ``load`` is "1", uniform pressure q, or "x", hydrostatic pressure q x/a. The shear strain adds ΔΔw h²/6κ(1 − ν)
    (Mindlin 1951); h = 0 gives the thin plate of Timoshenko and Woinowsky-Krieger (1959), art. 30 and 33.
    """
    m, n = np.arange(1, 600)[:, None], np.arange(1, 600, 2)[None, :]
    along = np.where(m % 2, 2.0, 0.0) if load == "1" else np.where(m % 2, 1.0, -1.0)
    pressure = 8 / np.pi**2 * along / (m * n)
    alpha, beta = m * np.pi / a, n * np.pi / b
    square = alpha**2 + beta**2
    bending = pressure / square**2 * np.sin(alpha * x) * np.sin(beta * y)
    shear = h**2 / (6 * (1 - nu) * KAPPA)
    return (
        float((bending * (1 + shear * square)).sum()),
        float((bending * (alpha**2 + nu * beta**2)).sum()),
        float((bending * (beta**2 + nu * alpha**2)).sum()),
    )
