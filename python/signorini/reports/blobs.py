"""Arrays of interactive maps as deflated bytes: node values as 16-bit integers on a decimal grid, and indices."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from signorini.base.numbers import ROUNDING
from signorini.discretise.rows import Floats, Ints
from signorini.discretise.stressnodes import StressNodes

_MOST = 65_000
"""Largest 16-bit code of a finite value; the margin below `_MISSING` covers rounding."""
_MISSING = 65_535
"""16-bit code of a missing value (NaN)."""
_LEVEL = 6
"""Compression level of zlib: level 9 takes seven times as long and saves only 1 % of the bytes."""
_SIDES = ((0, 1), (1, 2), (2, 3), (3, 0))
"""Corners of an element at the ends of each side, in the order of its midside nodes."""


@dataclass
class Blobs:
    """Deflated arrays up to ``room`` bytes of base64; ``places`` are their offsets and lengths in ``content``.

    Each array begins at a multiple of three bytes, so that base64 can be sliced. Integers are stored as zigzag
    codes, low bytes before high bytes, which halves the size of the deflated array. Equal arrays are stored once.
    """

    room: int
    content: bytearray = field(default_factory=bytearray)
    places: list[tuple[int, int]] = field(default_factory=list)
    _known: dict[bytes, int] = field(default_factory=dict)

    def add(self, differences: Ints, wide: bool = False) -> int | None:
        """Store an array of differences with 16 or 32 bits each; return its number, None without room for it."""
        bits, whole = (32, "<i4") if wide else (16, "<i2")
        signed = ((differences + (1 << bits - 1)) & ((1 << bits) - 1)) - (1 << bits - 1)
        codes = ((signed << 1) ^ (signed >> bits - 1)).astype(whole)
        planes = codes.view(np.uint8).reshape(-1, codes.itemsize).T
        deflated = zlib.compress(np.ascontiguousarray(planes).tobytes(), _LEVEL)
        if deflated not in self._known:
            if (len(self.content) + len(deflated)) * 4 > 3 * self.room:
                return None
            self._known[deflated] = len(self.places)
            self.places.append((len(self.content), len(deflated)))
            self.content += deflated + bytes(-len(deflated) % 3)
        return self._known[deflated]


@dataclass(frozen=True, eq=False)
class Grid:
    """Numbering of the stress nodes (s,) of a plate in a page: along a Z-order curve, corners before midside nodes.

    A midside value is stored as its difference from the mean of its side's ends, a corner value as the difference from
    the corner before. Elements follow the same curve.
    """

    nodes: StressNodes

    @cached_property
    def ends(self) -> Ints:
        """Ends (s, 2) of the side of each midside node; −1 at corners."""
        elements = self.nodes.elements
        ends = np.full((self.nodes.count, 2), -1)
        for side, pair in enumerate(_SIDES):
            ends[elements[:, 4 + side]] = elements[:, pair]
        ends[elements[:, :4]] = -1
        return ends

    @cached_property
    def order(self) -> Ints:
        """Indices of the stress nodes (s,) in the order in which the page stores them."""
        return np.lexsort((self._curve(self.nodes.points), self.ends[:, 0] >= 0))

    @cached_property
    def element_order(self) -> Ints:
        """Indices of the elements (e,) in the order in which the page stores them."""
        return np.argsort(self._curve(self.nodes.points[self.nodes.elements[:, :4]].mean(axis=1)), kind="stable")

    @cached_property
    def corners(self) -> int:
        """Number of corner nodes."""
        return int((self.ends[:, 0] < 0).sum())

    def _curve(self, places: Floats) -> Ints:
        """Position (k,) of places (k, 2) on a Z-order curve of 2¹⁶ × 2¹⁶ cells."""
        points = self.nodes.points
        cells = np.rint((places - points.min(axis=0)) / np.ptp(points, axis=0).max() * 65_535).astype(np.int64)
        result = np.zeros(len(places), np.int64)
        for bit in range(16):
            result += ((cells >> bit & 1) << (2 * bit + np.arange(2))).sum(axis=1)
        return result

    def elements(self) -> Ints:
        """Differences (8e,) of node numbers: between first nodes of successive elements, then second nodes, etc."""
        number = np.empty(self.nodes.count, np.int64)
        number[self.order] = np.arange(self.nodes.count)
        return np.diff(number[self.nodes.elements[self.element_order]].T.ravel(), prepend=0)

    def at_nodes(self, codes: Ints) -> Ints:
        """Stored differences (s,) of codes (s,) at stress nodes, in the order of the page; see `Grid`."""
        first, second = codes[self.ends].T
        result = np.where(self.ends[:, 0] < 0, codes, codes - (first + second >> 1))[self.order]
        result[: self.corners] = np.diff(result[: self.corners], prepend=0)
        return result

    def on_elements(self, codes: Ints) -> Ints:
        """Differences (e,) between the codes (e,) of successive elements, in the order of the page."""
        return np.diff(codes[self.element_order], prepend=0)


def decimal_codes(values: Floats, largest: float) -> tuple[Ints, int, int]:
    """Codes (k,), first integer i₀ and power p with values ≈ (i₀ + code) · 10ᵖ, each correctly rounded.

    Values within rounding of zero, relative to ``largest``, the largest magnitude of their kind, are 0.

    Examples
    --------
    >>> codes, first, power = decimal_codes(np.array([-1.23456, 0.5, np.nan, 1e-17]), 1.0)
    >>> codes.tolist(), first, power
    ([0, 17346, 65535, 12346], -12346, -4)
    """
    known = np.isfinite(values)
    values = np.where(np.abs(values) <= ROUNDING * largest, 0.0, values)
    low, high = float(values[known].min(initial=np.inf)), float(values[known].max(initial=-np.inf))
    spread = max(high - low, 1e-4 * max(abs(high), abs(low))) if known.any() else 0.0
    power = int(np.ceil(np.log10(spread / _MOST))) if spread > 0.0 else 0
    scaled = np.where(known, values, 0.0)
    integers = np.rint(scaled * 10.0**-power if power < 0 else scaled / 10.0**power).astype(np.int64)
    first = int(integers[known].min()) if known.any() else 0
    return np.where(known, integers - first, _MISSING), first, power


def rounded(values: Any, digits: int = 6) -> list[Any]:
    """Round an array to significant digits of its largest magnitude, as lists for JSON; NaN becomes None."""
    array = np.asarray(values, dtype=np.float64)
    largest = float(np.abs(array[np.isfinite(array)]).max(initial=0.0))
    places = digits - 1 - int(np.floor(np.log10(largest))) if largest else 0

    def listed(one: Any) -> Any:
        if isinstance(one, list):
            return [listed(part) for part in one]
        return None if one != one else one

    return listed(np.round(array, places).tolist())  # type: ignore[no-any-return]
