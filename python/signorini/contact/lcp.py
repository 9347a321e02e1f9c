"""The linear complementarity problem of one load."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from signorini.discretise.rows import Bools, Floats, Ints


class Lcp(NamedTuple):
    """w = Mz + q with w, z ≥ 0 and zᵀw = 0, over one-sided contact points.

    Two-sided points, whose reaction may have either sign, are eliminated.

    Parameters
    ----------
    M : (k, k) array
    q : (k,) array
    points : (k,) array
        Contact point of each row, a row of the problem's G.
    gap_is_z : (k,) array
        Rows that are exchanged: there z is the gap and w the reaction; elsewhere z is the reaction and w the gap.
    """

    M: Floats
    q: Floats
    points: Ints
    gap_is_z: Bools

    def contact(self, z: Floats) -> tuple[Floats, Floats]:
        """Reactions (k,) and gaps (k,) of ``points``, given z (k,); z need not solve the problem.

        `signorini.recover` makes of the reactions a certified result.
        """
        w = self.M @ z + self.q
        return np.where(self.gap_is_z, w, z), np.where(self.gap_is_z, z, w)
