"""What a plate of thickness 1 resists with: its rigidities in x and y."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from signorini.discretise.rows import Floats
from signorini.model import Material
from signorini.model.material import Modifiers, Stiffness


@dataclass(frozen=True, eq=False)
class Rigidity:
    """Rigidities of a plate of thickness 1.

    Parameters
    ----------
    bending : (3, 3) array
        [mxx, myy, mxy] from [κxx, κyy, 2κxy]; it goes with the thickness cubed.
    shear : (2, 2) array
        [qx, qy] from [γx, γy]; it goes with the thickness.
    """

    bending: Floats
    shear: Floats

    @classmethod
    def isotropic(cls, E: float, nu: float, factor: float) -> Self:
        """Take Young's modulus, Poisson's ratio and the shear correction factor.

        Examples
        --------
        >>> Rigidity.isotropic(12.0, 0.0, 0.5).for_core.tolist()
        [1.0, 0.0, 0.0, 1.0, 0.0, 0.5, 3.0, 0.0, 3.0]
        """
        d = E / (12 * (1 - nu**2))
        bending = d * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, 0.5 * (1 - nu)]])
        return cls(bending, factor * E / (2 * (1 + nu)) * np.eye(2))

    @classmethod
    def made_of(cls, material: Material, factor: float, modifiers: Modifiers) -> Self:
        """Take a material's, those of an orthotropic one turned from its axes to x and y."""
        if material.E is not None and material.nu is not None:
            return cls.isotropic(material.E, material.nu, factor).modified(modifiers)
        axes = material.axes
        stiffer = axes.Ey / axes.Ex
        d = axes.Ex / (12 * (1 - axes.nu_xy**2 * stiffer))
        coupled, twist = d * axes.nu_xy * stiffer, axes.Gxy / 12
        bending = np.array([[d, coupled, 0], [coupled, d * stiffer, 0], [0, 0, twist]])
        return cls(bending, factor * np.diag([axes.Gxz, axes.Gyz])).modified(modifiers).turned(axes.angle)

    @classmethod
    def given(cls, by: Stiffness, thickness: float, modifiers: Modifiers) -> Self:
        """Take those of a section that has a thickness, turned from its axes to x and y.

        Examples
        --------
        >>> from signorini.model.material import Modifiers, Stiffness
        >>> ribbed = Stiffness(Dx=8.0, Dy=1.6, D1=0.8, Dxy=0.4, Sx=6.0, Sy=2.0, angle=90)
        >>> Rigidity.given(ribbed, 2.0, Modifiers()).for_core.round(12).tolist()
        [0.2, 0.1, 0.0, 1.0, 0.0, 0.05, 1.0, 0.0, 3.0]
        """
        bending = np.array([[by.Dx, by.D1, 0], [by.D1, by.Dy, 0], [0, 0, by.Dxy]]) / thickness**3
        return cls(bending, np.diag([by.Sx, by.Sy]) / thickness).modified(modifiers).turned(by.angle)

    def turned(self, degrees: float) -> Self:
        """Turn from axes of their own, the first by so many degrees from x, to x and y."""
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        turn = np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]])
        ahead = np.array([[c, s], [-s, c]])
        return type(self)(turn.T @ self.bending @ turn, ahead.T @ self.shear @ ahead)

    def modified(self, by: Modifiers) -> Self:
        """Multiply by the plate's factors of bending, twist and shear.

        Examples
        --------
        >>> from signorini.model.material import Modifiers
        >>> Rigidity.isotropic(12.0, 0.0, 0.5).modified(Modifiers(twist=0.1)).for_core.tolist()
        [1.0, 0.0, 0.0, 1.0, 0.0, 0.05, 3.0, 0.0, 3.0]
        """
        bending = by.bending * self.bending
        bending[2, 2] = by.twist * self.bending[2, 2]
        return type(self)(bending, by.shear * self.shear)

    @property
    def for_core(self) -> Floats:
        """The rigidities (9,) as `_core.Plate` takes them."""
        return np.concatenate([self.bending[np.triu_indices(3)], self.shear[np.triu_indices(2)]])

    @property
    def in_waves(self) -> float:
        """Rigidity in bending against waves sin(x) sin(y); D of an isotropic plate."""
        b = self.bending
        return float((b[0, 0] + 2 * (b[0, 1] + 2 * b[2, 2]) + b[1, 1]) / 4)

    @property
    def in_twist(self) -> float:
        """Mean rigidity in twist of all directions."""
        b = self.bending
        return float((b[0, 0] + b[1, 1] - 2 * b[0, 1] + 4 * b[2, 2]) / 8)

    @property
    def in_shear(self) -> float:
        """Mean rigidity in shear of all directions."""
        return float(self.shear.trace() / 2)
