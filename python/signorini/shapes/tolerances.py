"""How near is the same, on a plate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Tolerances:
    """Lengths that tell places of a plate from each other.

    Parameters
    ----------
    extent : float
        The plate's diameter.
    thickness : float or array
        Its thickness, at one place or some; 0 where no support is judged by it.

    Examples
    --------
    >>> near = Tolerances(4.0, 0.3)
    >>> near.place, near.written, near.apart
    (4e-08, 4e-06, 0.03)
    """

    extent: float
    thickness: float | Floats = 0.0

    @property
    def place(self) -> float:
        """Two places nearer than this are one.

        Rows of nearer ones differ by less than their rounding: at 1e-9 two rigid points with a spring beside them
        changed deflections by 3 %.
        """
        return 1e-8 * self.extent

    @property
    def written(self) -> float:
        """What is nearer than this to an edge or a circle is on it: coordinates are written with six digits."""
        return 1e-6 * self.extent

    @property
    def apart(self) -> float | Floats:
        """Rigid supports that are not at one place are at least so far from each other.

        What a plate does between two grows with the inverse of the square.
        """
        return self.thickness / 10.0
