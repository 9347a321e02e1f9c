"""Numbers short enough to be read, with their half-widths."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

ROUNDING = 1e-10
"""Part of the largest of its kind below which a figure is shown as zero; certificates allow a hundredfold."""


def size_of(values: ArrayLike) -> float:
    """Give the largest size of values, with which those of their kind are compared; 0 of none."""
    return float(np.abs(np.asarray(values, dtype=np.float64)).max(initial=0.0))


def number(value: float, largest: float = 0.0, digits: int = 6) -> str:
    """Write a number short enough to be read; what beside the ``largest`` of its kind is rounding is zero.

    Examples
    --------
    >>> number(-1.7e-10, largest=8109.0), number(8109.0), number(1234567.8)
    ('0', '8109', '1234568')
    """
    if abs(value) <= ROUNDING * largest:
        return "0"
    # Forces in newtons pass six digits soon; an exponent would be harder to read than some more of them.
    return f"{value:.0f}" if 1e5 <= abs(value) < 1e10 else f"{value:.{digits}g}"


def estimated(value: float, width: float | None, largest: float = 0.0, digits: int = 6) -> str:
    """Write a number with its half-width, to the digits that this leaves; None: it has no limit, and three of them.

    Examples
    --------
    >>> estimated(714.8123, 0.37), estimated(0.00422472, 4.71e-6), estimated(200000.0, 1e-8, largest=2e5)
    ('714.8 ± 0.4', '0.004225 ± 0.000005', '200000 ± 0')
    >>> estimated(1e-23, 2e-23, largest=5.0), estimated(0.0, 0.0)
    ('0', '0')
    >>> estimated(-1.93456e-7, 3.1e-9), estimated(12.3, None), estimated(5.0, 21.3), estimated(1e-9, 3e-8)
    ('-1.93e-07 ± 4e-09', '12.3 ± ?', '5 ± 22', '0 ± 3e-08')
    >>> estimated(-101.397, None), estimated(298107624.0, None)
    ('-101 ± ?', '298000000 ± ?')
    >>> estimated(0.3, 120.0), estimated(0.0, 8.1e4), estimated(0.0, 3.2e5), estimated(1e-5, 120.0)
    ('0 ± 120', '0 ± 90000', '0 ± 4e+05', '0 ± 120')
    """
    if width is None:
        return f"{number(float(f'{value:.3g}'), largest, digits)} ± ?"
    shown = number(value, largest, digits)
    if width <= 10 * ROUNDING * largest:
        return shown if shown == "0" else f"{shown} ± 0"
    size = math.floor(math.log10(width))
    size -= width < 3 * 10**size * (1 - 1e-9)
    finest = math.floor(math.log10(abs(value))) - digits + 1 if shown != "0" else size
    place = max(size, finest)
    up = math.ceil(width / 10.0**place - 1e-9) * 10.0**place
    # An exponent is shorter from 1e5 on, and 'g' has one from 100 on.
    short = f"{up:.0f}" if 100 <= up < 1e5 else f"{up:.2g}"
    rounded = round(value, -place) if shown != "0" else 0.0
    if rounded == 0:
        return f"0 ± {short}"
    if "e" in shown:
        power = math.floor(math.log10(abs(value)))
        return f"{value:.{max(0, power - place)}e} ± {short}"
    return f"{rounded + 0.0:.{max(0, -place)}f} ± {up:.{max(0, -place)}f}"


def compared(elements: Sequence[int], asked: bool) -> str:
    """Where half-widths come from, or why there are none.

    Examples
    --------
    >>> compared([64, 16, 4], asked=True), compared([], asked=True)
    ('± by 64, 16 and 4 elements', 'not known, no ±')
    """
    if not elements:
        return "not known, no ±" if asked else "not asked, no ± (mesh.error)"
    return f"± by {', '.join(map(str, elements[:-1]))} and {elements[-1]} elements"
