"""Numbers as pictures and their captions show them."""

from __future__ import annotations

import numpy as np

POWERS = -4, 5
"""Numbers between these powers of ten are written without one: those of five digits still fit beside the colours."""


def plain(value: float, digits: int) -> str:
    """Write a number of so many digits as short as it can be read, with a power of ten only where it is far from one.

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
