"""How far the numbers of a result are from the plate's: their half-widths, and who finds them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True)
class Estimate:
    """What other meshes say of a result.

    Parameters
    ----------
    plus_minus : mapping or None
        Deflection, fields, supports and probes as in results.json, a half-width in place of every number; None where
        there is no number, or no other mesh to compare with.
    elements : tuple of int
        Sizes of the meshes that were compared, the finest first, its own among them.
    warnings : tuple of str
        Why half-widths are missing, in sentences.
    """

    plus_minus: Mapping[str, Any] | None
    elements: tuple[int, ...]
    warnings: tuple[str, ...]


NONE = Estimate(None, (), ())


@dataclass(frozen=True)
class PathEstimate:
    """What other meshes say of a load path.

    Parameters
    ----------
    end : float or None
        Half-width of the t at which it ends.
    events : tuple of float or None
        Half-widths of the t of every named event.
    thresholds : tuple of float or None
        Those of the t of every threshold.
    elements, warnings
        As those of an `Estimate`.
    """

    end: float | None
    events: tuple[float | None, ...]
    thresholds: tuple[float | None, ...]
    elements: tuple[int, ...]
    warnings: tuple[str, ...]

    @classmethod
    def nothing(cls, events: int, thresholds: int, warnings: tuple[str, ...] = ()) -> PathEstimate:
        """No half-widths of so many events and thresholds."""
        return cls(None, (None,) * events, (None,) * thresholds, (), warnings)


class PathEstimator(Protocol):
    """Finds the events of a path on other meshes."""

    def estimate(self, path: Any) -> PathEstimate:
        """Compare a `LoadPath` with those of the other meshes."""
        ...

    def estimate_at(self, t: float, result: Any) -> Estimate:
        """Compare its `Result` at some t."""
        ...


class Estimator(Protocol):
    """Solves a combination on other meshes."""

    def __call__(self, result: Any) -> Estimate:
        """Compare a `Result` with those of the other meshes."""
        ...
