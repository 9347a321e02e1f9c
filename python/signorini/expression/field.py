"""Varying input values: values at points, interpolated linearly; a Python function; values per support point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini.errors import InputError, Place, point
from signorini.expression.expression import LARGEST
from signorini.expression.levels import Level
from signorini.expression.tree import first_point

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull, Delaunay

_ON_OUTLINE = 1e-9
"""Largest distance outside the convex hull of the points, relative to their extent, that counts as on the hull.

Also the largest ratio of width to length of points that count as collinear.
"""

_Array = NDArray[np.float64]
Outside = Literal["nearest", 0]
"""Value outside the convex hull of the points: "nearest", the value at the nearest point of the hull, or zero."""


@dataclass(frozen=True)
class Field:
    """A nonnegative value, such as a stiffness, that varies over the plate; 0 means no support.

    Parameters
    ----------
    given : tuple of (x, y, value), or callable
        Values at points, linear on the Delaunay triangles of the points; or a function of x (q,) and y (q,) that
        returns values (q,).
    file : str
        The CSV file of the points, if any.
    outside : "nearest" or 0, optional
        Value outside the convex hull of the points: that at the nearest point of the hull, or 0. By default it is 0,
        and a support that extends outside the hull is refused.

    Raises
    ------
    InputError
        With fewer than three points, collinear points, different values at one point, or a negative value.

    Examples
    --------
    >>> field = Field(((0.0, 0.0, 1.0), (2.0, 0.0, 3.0), (0.0, 2.0, 1.0)))
    >>> field([1.0, 0.5, 2.0], [0.0, 0.5, 2.0])
    array([2. , 1.5, 0. ])
    >>> Field(field.given, outside="nearest")([3.0, 2.0, -1.0], [0.0, 2.0, 1.0])
    array([3., 2., 1.])
    """

    given: tuple[tuple[float, float, float], ...] | Callable[[_Array, _Array], ArrayLike]
    file: str = ""
    outside: Outside | None = None
    is_constant: ClassVar[bool] = False
    levels: ClassVar[tuple[Level, ...]] = ()

    def __post_init__(self) -> None:
        """Check the points (x, y, value) of the field, if it is given by points."""
        if callable(self.given):
            return
        points, values = self._table[:, :2], self._table[:, 2]
        if len(points) < 3:
            raise InputError(f"found {len(points)} point{'s' * (len(points) != 1)}; at least three are needed.")
        if (values < 0.0).any():
            least = int(values.argmin())
            raise InputError(f"found {values[least]:g} at {point(points[least])}; it must not be negative.")
        order = np.lexsort((points[:, 1], points[:, 0]))
        repeated = (points[order[1:]] == points[order[:-1]]).all(axis=1)
        same = np.flatnonzero(repeated & (values[order[1:]] != values[order[:-1]]))
        if len(same):
            first, second = values[order[same[0] : same[0] + 2]]
            raise InputError(f"found {first:g} and {second:g} at {point(points[order[same[0]]])}; give one value.")
        _, spread, _ = np.linalg.svd(self._scaled(points), full_matrices=False)
        if spread[1] <= _ON_OUTLINE * spread[0]:
            raise InputError("all points are collinear; they must span an area.")

    @property
    def source(self) -> Any:
        """The field as in the input: a table with the file or the points, the list of points, or the function."""
        outside = {} if self.outside is None else {"outside": self.outside}
        if not self.file and not outside:
            return self.given
        return ({"file": self.file} if self.file else {"points": self.given}) | outside

    @property
    def box(self) -> tuple[_Array, _Array]:
        """Lower left and upper right corner (2,) of the bounding box of the points."""
        return self._table[:, :2].min(axis=0), self._table[:, :2].max(axis=0)

    def depth(self, positions: _Array) -> _Array:
        """Signed distance (q,) of positions (q, 2) from the convex hull, relative to the extent of the points.

        It is positive inside the hull and within rounding of its outline. If a function gives the field, it is ∞.
        """
        if callable(self.given):
            return np.full(len(positions), np.inf)
        normals, offsets = self._hull.equations[:, :2], self._hull.equations[:, 2]
        return np.asarray(_ON_OUTLINE - (self._scaled(positions) @ normals.T + offsets).max(axis=1))

    def __call__(
        self,
        x: ArrayLike,
        y: ArrayLike,
        *,
        above: float | None = None,
        place: str | Place = "",
    ) -> _Array:
        """Evaluate the field at points x and y; arguments and errors are those of `Expression.__call__`."""
        px, py = np.broadcast_arrays(np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64))
        values = self._values(np.column_stack([px.ravel(), py.ravel()]), place).reshape(px.shape)
        wrong = ~(np.abs(values) <= LARGEST) | (values < 0.0) | (values <= (-np.inf if above is None else above))
        if wrong.any():
            why = "must be finite and not negative" if above is None else f"must be greater than {above:g}"
            found = f"{self} is {values[wrong].flat[0]:g} at {first_point(wrong, px, py)}"
            raise InputError(f"{found}; it {why}.", place=place)
        return values

    def __str__(self) -> str:
        """Return the name of the CSV file or of the function that gives the field, for messages."""
        return self.file or getattr(self.given, "__name__", "The table")

    def _values(self, positions: _Array, place: str | Place) -> _Array:
        """Values (q,) of the field at positions (q, 2)."""
        if callable(self.given):
            values = np.asarray(self.given(*positions.T))
            if values.shape != (len(positions),) or values.dtype.kind not in "iuf":
                raise InputError(
                    f"{self} returns an array {values.shape} of {values.dtype} for x and y ({len(positions)},); it "
                    "must return one real number per point.",
                    place=place,
                )
            return values.astype(np.float64)
        mesh, at = self._triangles, self._scaled(positions)
        triangle = mesh.find_simplex(at, tol=_ON_OUTLINE)
        part = np.einsum("qij,qj->qi", mesh.transform[triangle, :2], at - mesh.transform[triangle, 2])
        weights = np.column_stack([part, 1.0 - part.sum(axis=1)])
        corners = self._table[:, 2][mesh.simplices[triangle]]
        values = np.where(triangle >= 0, np.maximum((weights * corners).sum(axis=1), 0.0), 0.0)
        if self.outside == "nearest":
            values[triangle < 0] = self._nearest(at[triangle < 0])
        return values

    def _nearest(self, scaled: _Array) -> _Array:
        """Values (q,) at the nearest points of the convex hull for positions (q, 2) in scaled coordinates."""
        corners = self._hull.vertices
        places, heights = self._scaled(self._table[corners, :2]), self._table[corners, 2]
        best, values = np.full(len(scaled), np.inf), np.zeros(len(scaled))
        for a, b, first, last in zip(places, np.roll(places, -1, 0), heights, np.roll(heights, -1), strict=True):
            part = np.clip((scaled - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
            distance = np.hypot(*(scaled - a - part[:, None] * (b - a)).T)
            values = np.where(distance < best, first + part * (last - first), values)
            best = np.minimum(best, distance)
        return values

    @cached_property
    def _table(self) -> _Array:
        return np.reshape(np.array(self.given, dtype=np.float64), (-1, 3))

    @cached_property
    def _triangles(self) -> Delaunay:
        from scipy.spatial import Delaunay

        return Delaunay(self._scaled(self._table[:, :2]))

    @cached_property
    def _hull(self) -> ConvexHull:
        from scipy.spatial import ConvexHull

        return ConvexHull(self._scaled(self._table[:, :2]))

    def _scaled(self, positions: _Array) -> _Array:
        """Convert positions (q, 2) to coordinates relative to the points' center, divided by the points' extent."""
        low, high = self.box
        return np.asarray((positions - 0.5 * (low + high)) / ((high - low).max() or 1.0))


@dataclass(frozen=True)
class PointValues:
    """A list with one value for each point of a support.

    Parameters
    ----------
    values : (k,) tuple of float
        The values, in the order of the points.
    points : (k, 2) tuple
        Coordinates of the points of the support.

    Examples
    --------
    >>> gap = PointValues((0.0, 0.3), ((1.0, 1.0), (4.0, 1.0)))
    >>> gap([4.0, 1.0], [1.0, 1.0])
    array([0.3, 0. ])
    """

    values: tuple[float, ...]
    points: tuple[tuple[float, float], ...] = field(default=(), compare=False, repr=False)
    levels: ClassVar[tuple[Level, ...]] = ()

    @property
    def is_constant(self) -> bool:
        """Whether all values of the list are equal."""
        return len(set(self.values)) == 1

    @property
    def value(self) -> float:
        """The first value of the list, which is the value at all points if the list is constant."""
        return self.values[0]

    @property
    def source(self) -> list[float]:
        """The list of values as in the input."""
        return list(self.values)

    def __call__(
        self,
        x: ArrayLike,
        y: ArrayLike,
        *,
        above: float | None = None,
        at_least: float | None = None,
        place: str | Place = "",
    ) -> _Array:
        """Return at each position x, y the value of the nearest support point, without a check of bounds."""
        from scipy.spatial import cKDTree

        at = np.stack(np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64)), axis=-1)
        return np.array(self.values)[cKDTree(self.points).query(at)[1]]
