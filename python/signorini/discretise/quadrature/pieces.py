"""Element sides and outlines as curves y(x): the sides of the strips that cut elements are integrated over."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]

_STRAIGHT = 1e-14


@dataclass(frozen=True, eq=False)
class Pieces:
    """Curves y(x).

    Parameters
    ----------
    owner : (p,) int array
        Number of the cut element each belongs to.
    is_side : (p,) bool array
        Whether it is a side of the element; else it is of the outline.
    quadratic : (p, 2, 3) float array
        Coefficients of x and y as polynomials in t, of a stretch on which x is monotone. NaN for a circle.
    circle : (p, 3) float array
        Centre and radius of a half circle. NaN for a quadratic.
    sign : (p,) float array
        Of a quadratic, whether x grows (1) or falls (−1) with t; of a circle, whether this is the half of greater (1)
        or smaller (−1) y.
    ends : (p, 2) float array
        Lower and upper bound in x.
    turns : (p, 2) bool array
        Whether the tangent is vertical at either end.
    """

    owner: Ints
    is_side: Bools
    quadratic: Floats
    circle: Floats
    sign: Floats
    ends: Floats
    turns: Bools

    def take(self, index: Ints | Bools) -> Pieces:
        """Select some pieces."""
        return Pieces(*(getattr(self, item.name)[index] for item in fields(self)))

    @staticmethod
    def join(parts: Sequence[Pieces]) -> Pieces:
        """Collect pieces, sorted by owner."""
        all_ = Pieces(*(np.concatenate([getattr(part, item.name) for part in parts]) for item in fields(Pieces)))
        return all_.take(np.argsort(all_.owner, kind="stable"))

    @classmethod
    def of_quadratics(cls, owner: Ints, curves: Floats, is_side: bool) -> Pieces:
        """Split quadratics (k, 2, 3) on −1 ≤ t ≤ 1 where x turns back."""
        x0, x1, x2 = curves[:, 0].T
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = np.clip(np.nan_to_num(-x1 / (2.0 * x2), nan=1.0), -1.0, 1.0)
        t = np.stack([np.column_stack([-np.ones_like(turn), turn]), np.column_stack([turn, np.ones_like(turn)])])
        x = x0[:, None] + t * (x1[:, None] + t * x2[:, None])
        x = x.reshape(-1, 2)
        at_turn = (np.abs(x1[:, None] + 2.0 * x2[:, None] * t) <= 1e-12 * np.abs(x2)[:, None]).reshape(-1, 2)
        at_turn &= np.tile(x2 != 0.0, 2)[:, None]
        falls = x[:, 1] < x[:, 0]
        order = np.where(falls[:, None], [1, 0], [0, 1])
        return cls(
            owner=np.tile(owner, 2),
            is_side=np.full(len(x), is_side),
            quadratic=np.tile(curves, (2, 1, 1)),
            circle=np.full((len(x), 3), np.nan),
            sign=np.where(falls, -1.0, 1.0),
            ends=np.take_along_axis(x, order, axis=1),
            turns=np.take_along_axis(at_turn, order, axis=1),
        )

    @classmethod
    def of_circles(cls, owner: Ints, circles: Floats) -> Pieces:
        """Split circles (k, 3) into their lower and upper halves."""
        both = np.tile(circles, (2, 1))
        return cls(
            owner=np.tile(owner, 2),
            is_side=np.zeros(len(both), dtype=bool),
            quadratic=np.full((len(both), 2, 3), np.nan),
            circle=both,
            sign=np.repeat([-1.0, 1.0], len(circles)),
            ends=both[:, :1] + both[:, 2:] * np.array([-1.0, 1.0]),
            turns=np.ones((len(both), 2), dtype=bool),
        )

    @property
    def straight(self) -> Bools:
        """Which pieces (p,) are straight."""
        return np.asarray((self.quadratic[..., 2] == 0.0).all(axis=1))

    def height(self, index: Ints, x: Floats) -> Floats:
        """Compute y (k,) on the pieces numbered (k,) at x (k,)."""
        y = np.empty(len(x))
        round_ = np.isnan(self.quadratic[index, 0, 0])
        y[round_] = self._on_circle(index[round_], x[round_])
        y[~round_] = self._on_quadratic(index[~round_], x[~round_])
        return y

    def _on_circle(self, index: Ints, x: Floats) -> Floats:
        cx, cy, r = self.circle[index].T
        return np.asarray(cy + self.sign[index] * np.sqrt(np.maximum((r - (x - cx)) * (r + (x - cx)), 0.0)))

    def _on_quadratic(self, index: Ints, x: Floats) -> Floats:
        (x0, x1, x2), (y0, y1, y2) = self.quadratic[index].transpose(1, 2, 0)
        sign = self.sign[index]
        # dx/dt is this root; of the two forms of t the one that does not cancel.
        root = sign * np.sqrt(np.maximum(x1 * x1 + 4.0 * x2 * (x - x0), 0.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.where(x1 * sign > 0.0, 2.0 * (x - x0) / (x1 + root), (root - x1) / (2.0 * x2))
        t = np.clip(np.nan_to_num(t), -1.0, 1.0)
        return np.asarray(y0 + t * (y1 + t * y2))


def straightened(curves: Floats) -> Floats:
    """Leave out of quadratics (k, 2, 3) a bend that is only rounding."""
    bend = np.abs(curves[..., 2]).max(axis=1)
    size = np.abs(curves[..., 1]).max(axis=1) + np.abs(curves[..., 0]).max(axis=1)
    result = curves.copy()
    result[bend <= _STRAIGHT * size, :, 2] = 0.0
    return result
