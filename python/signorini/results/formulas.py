"""What moments and shears amount to: principal moments, moments for reinforcement, stresses."""

from __future__ import annotations

import numpy as np

from signorini.discretise.rows import Floats


def principal_moments(moment: Floats) -> Floats:
    """Principal moments m1 ≥ m2, and the angle from x to the direction of m1 in degrees towards y.

    Parameters
    ----------
    moment : (..., 3) array
        mx, my, mxy.

    Returns
    -------
    (..., 3) array

    Examples
    --------
    >>> principal_moments(np.array([3.0, 3.0, 1.0]))
    array([ 4.,  2., 45.])
    """
    mx, my, mxy = np.moveaxis(moment, -1, 0)
    middle, radius = 0.5 * (mx + my), np.hypot(0.5 * (mx - my), mxy)
    return np.stack([middle + radius, middle - radius, np.degrees(0.5 * np.arctan2(2 * mxy, mx - my))], axis=-1)


def design_moments(moment: Floats) -> Floats:
    """Moments along x and y for which reinforcement along them is designed: at the bottom ≥ 0, at the top ≤ 0.

    R. H. Wood, *The reinforcement of slabs in accordance with a pre-determined field of moments*, Concrete 2 (1968);
    G. S. T. Armer, discussion of it.

    Parameters
    ----------
    moment : (..., 3) array
        mx, my, mxy.

    Returns
    -------
    (..., 4) array
        Bottom x and y, top x and y.

    Examples
    --------
    >>> design_moments(np.array([[3.0, 2.0, 1.0], [4.0, -5.0, 2.0]]))
    array([[ 4. ,  3. ,  0. ,  0. ],
           [ 4.8,  0. ,  0. , -6. ]])
    """
    mx, my, mxy = np.moveaxis(moment, -1, 0)
    return np.stack([*_sagging(mx, my, mxy), *(0.0 - one for one in _sagging(-mx, -my, mxy))], axis=-1)


def _sagging(mx: Floats, my: Floats, mxy: Floats) -> tuple[Floats, Floats]:
    """Moments that bars at the bottom are designed for: with one bar at most where one moment alone needs none."""
    x, y, twist = mx + np.abs(mxy), my + np.abs(mxy), mxy**2
    with np.errstate(divide="ignore", invalid="ignore"):
        alone_x, alone_y = mx + twist / np.abs(my), my + twist / np.abs(mx)
    of_x = np.where(x < 0, 0.0, np.where(y < 0, np.maximum(alone_x, 0.0), x))
    of_y = np.where(y < 0, 0.0, np.where(x < 0, np.maximum(alone_y, 0.0), y))
    return of_x, of_y


def face_stresses(moment: Floats, thickness: Floats) -> Floats:
    """Stresses at the faces of a solid plate, tension positive: ∓6 m/h² at the top and the bottom.

    Parameters
    ----------
    moment : (..., 3) array
        mx, my, mxy, positive where they sag.
    thickness : (...) array

    Returns
    -------
    (..., 8) array
        σx, σy and τxy at the top, these at the bottom, von Mises' stress at the top and at the bottom.

    Examples
    --------
    >>> face_stresses(np.array([3.0, 0.0, 0.0]), np.array(2.0))
    array([-4.5, -0. , -0. ,  4.5,  0. ,  0. ,  4.5,  4.5])
    """
    bottom = 6.0 * moment / (thickness**2)[..., None]
    x, y, xy = np.moveaxis(bottom, -1, 0)
    mises = np.sqrt(np.maximum(x * x - x * y + y * y + 3.0 * xy * xy, 0.0))[..., None]
    return np.concatenate([-bottom, bottom, mises, mises], axis=-1)


def shear_stresses(shear: Floats, thickness: Floats) -> Floats:
    """Transverse shear stresses τxz, τyz (..., 2) at mid-depth of a solid plate, 3/2 q/h, from qx, qy (..., 2)."""
    return np.asarray(1.5 * shear / thickness[..., None])
