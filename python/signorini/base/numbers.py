"""Write numbers as text for terminals and pictures: rounded, with their half-widths (±)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

ROUNDING = 1e-10
"""Numbers below this fraction of the largest number of their kind are written as 0, since they are rounding errors.

The tolerance of certificates is a hundred times as large.
"""


_KNOWN = 12
"""Numbers are first rounded to this many significant digits, so that rounding errors do not change their text."""
_LEAST = 4
"""Smallest number of significant digits with which a number is shown beside its half-width."""
_LONG = 9
"""A half-width that needs at least this number of decimals is written with an exponent."""


def size_of(values: ArrayLike) -> float:
    """Largest magnitude of values, the reference for numbers that are written as 0; 0 for an empty array."""
    return float(np.abs(np.asarray(values, dtype=np.float64)).max(initial=0.0))


def number(value: float, largest: float = 0.0, digits: int = 6) -> str:
    """Write a number with ``digits`` significant digits.

    Numbers within rounding of zero, relative to the ``largest`` number of the same kind, are written as 0.

    Examples
    --------
    >>> number(-1.7e-10, largest=8109.0), number(8109.0), number(1234567.8)
    ('0', '8109', '1234568')
    >>> number(2243.2499999999995, digits=5), number(2243.2500000000005, digits=5)
    ('2243.2', '2243.2')
    """
    if abs(value) <= ROUNDING * largest:
        return "0"
    value = float(f"{value:.{_KNOWN}g}")
    # Forces in newtons often have more than six digits; all digits are easier to read than an exponent.
    return f"{value:.0f}" if 1e5 <= abs(value) < 1e10 else f"{value:.{digits}g}"


def estimated(value: float, width: float | None, largest: float = 0.0, digits: int = 6) -> str:
    """Write a number with its half-width, rounded up to one or two digits; a half-width of None is written as "± ?".

    The number is rounded to the last digit of the half-width, but has at least four digits.

    Examples
    --------
    >>> estimated(714.8123, 0.37), estimated(0.00422472, 4.71e-6), estimated(200000.0, 1e-8, largest=2e5)
    ('714.8 ± 0.4', '0.004225 ± 0.000005', '200000 ± 0')
    >>> estimated(41281.0, 2.5e6), estimated(-29873.0, 8e3), estimated(0.3, 120.0), estimated(5.0, 21.3)
    ('41280 ± 2500000', '-29870 ± 8000', '0.3000 ± 120', '5.000 ± 22')
    >>> estimated(1e-23, 2e-23, largest=5.0), estimated(0.0, 0.0), estimated(0.0, 8.1e4)
    ('0', '0', '0 ± 90000')
    >>> estimated(-1.93456e-7, 3.1e-9), estimated(12.3, None), estimated(298107624.0, None)
    ('-1.935e-07 ± 4e-09', '12.3 ± ?', '298100000 ± ?')
    """
    if width is None:
        return f"{number(float(f'{value:.{_LEAST}g}'), largest, digits)} ± ?"
    shown = number(value, largest, digits)
    if width <= 10 * ROUNDING * largest:
        return shown if shown == "0" else f"{shown} ± 0"
    size = math.floor(math.log10(width))
    size -= width < 3 * 10**size * (1 - 1e-9)
    power = math.floor(math.log10(abs(value))) if shown != "0" else size
    place = max(size, power - digits + 1) if shown != "0" else size
    up = math.ceil(width / 10.0**place - 1e-9) * 10.0**place
    short = f"{up:.0f}" if 100 <= up < 1e7 else f"{up:.2g}"
    if shown == "0":
        return f"0 ± {short}"
    finest = min(place, power - _LEAST + 1)
    if "e" in shown:
        return f"{value:.{power - finest}e} ± {short}"
    if up < 100:
        short = f"{up:.{max(0, -place)}f}" if place > -_LONG else short
    return f"{round(value, -finest) + 0.0:.{max(0, -finest)}f} ± {short}"


def in_unit(unit: str) -> str:
    """Label of a unit in brackets, to append to a title; empty if the unit has no label."""
    return f" [{unit}]" if unit else ""


def compared(elements: Sequence[int], asked: bool) -> str:
    """Write a sentence with the numbers of elements of the meshes compared for ±, or with the reason why ± is missing.

    Examples
    --------
    >>> compared([64, 16, 4], asked=True), compared([], asked=True)
    ('± estimates the mesh error (meshes of 64, 16 and 4 elements).', 'The mesh error is not known: no ±.')
    """
    if not elements:
        return "The mesh error is not known: no ±." if asked else "The mesh error is not estimated: no ± (mesh.error)."
    sizes = f"{', '.join(map(str, elements[:-1]))} and {elements[-1]}"
    return f"± estimates the mesh error (meshes of {sizes} elements)."


POWERS = -4, 5
"""Exponents a, b: numbers from 10ᵃ to 10ᵇ are written without exponent, since five digits fit next to a colour bar."""


def plain(value: float, digits: int) -> str:
    """Write a number with ``digits`` significant digits for a picture; numbers outside `POWERS` have an exponent.

    Examples
    --------
    >>> plain(-17524.0, 4), plain(0.00015, 4), plain(2.5e6, 2), plain(1.2345e-7, 3)
    ('−17520', '0.00015', '2.5e6', '1.23e−7')
    """
    rounded = f"{value:.{digits}g}"
    if 10.0 ** POWERS[0] <= abs(value) < 10.0 ** POWERS[1]:
        text = np.format_float_positional(float(rounded), trim="-")
    else:
        text = rounded.replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")
    return text.replace("-", "−")
