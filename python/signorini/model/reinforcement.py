"""Table [reinforcement] of the input: design code, strengths, and distances of bars from the plate's faces."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field

from signorini.base.units import METRES, NEWTONS
from signorini.design import en1992_bending as en1992
from signorini.model.base import Complaint, Flag, NonNegative, Positive, Table, vector

_PLAIN = 1e-6
"""Tensile stress, relative to fctm, below which a face requires no bars: such a stress is a rounding error."""

Distances = Annotated[tuple[Positive, Positive], *vector(2, "two distances [dx, dy]")]


class Cover(Table):
    """Concrete cover of the outer bars, those along x, at both faces."""

    top: NonNegative = Field(description="Concrete cover at the top face.")
    bottom: NonNegative = Field(description="Concrete cover at the bottom face.")


class Reinforcement(Table):
    """Code and strengths for the required reinforcement; at both faces, bars along x are the outer layer."""

    code: Literal["EN 1992-1-1:2004"] = Field(description="Design code.")
    fck: Positive = Field(description="Characteristic strength of concrete, as force per area.")
    fyk: Positive = Field(description="Characteristic yield strength of the bars, as force per area.")
    cover: Cover | None = Field(
        default=None, description="Concrete cover of the outer bars (along x), { top = …, bottom = … }."
    )
    bar: Positive | None = Field(default=None, description="Diameter of the bars; required with cover.")
    d_top: Distances | None = Field(
        default=None,
        description="In place of cover and bar: distances [dx, dy] from the top face to the axes of the bars.",
    )
    d_bottom: Distances | None = Field(
        default=None, description="In place of cover and bar: distances [dx, dy] from bottom face to axes of the bars."
    )
    face: Flag = Field(
        default=False,
        description="Whether bars within a column (footprint of a point support) are designed for the moments at the "
        "column's faces; without a footprint, for means along diameters of a circle.",
    )
    gamma_c: Positive = Field(default=en1992.GAMMA_C, description="Partial factor γC of concrete.")
    gamma_s: Positive = Field(default=en1992.GAMMA_S, description="Partial factor γS of the bars.")
    alpha_cc: Positive = Field(
        default=en1992.ALPHA_CC, description="Coefficient αcc of long-term effects on the strength of concrete."
    )

    def _complaints(self) -> Iterator[Complaint]:
        given = self.present(("cover", "bar", "d_top", "d_bottom"))
        if given not in (["cover", "bar"], ["d_top", "d_bottom"]):
            yield (), f"found {' and '.join(given) or 'no distances'}; give cover and bar, or d_top and d_bottom."

    def complaints_in(self, length: str, force: str) -> Iterator[Complaint]:
        """Yield a problem if a strength is outside the range of the code, or if unknown units prevent this check."""
        for key, unit, known in (("length", length, METRES), ("force", force, NEWTONS)):
            if unit not in known:
                why = f"{self.code} needs a known unit: units.{key} must be one of {', '.join(known)}."
                yield (), f"found {unit!r} as unit of {key}; {why}" if unit else why
                return
        for key, (least, most) in (("fck", en1992.STRENGTHS), ("fyk", en1992.YIELD_STRENGTHS)):
            found = getattr(self, key) * _megapascals(length, force)
            if not least <= found <= most:
                why = f"{self.code} allows {least:g} to {most:g} MPa. Give {key} in {force}/{length}²."
                yield (key,), f"found {getattr(self, key):g} {force}/{length}², which is {found:.4g} MPa; {why}"

    @property
    def distances(self) -> tuple[float, float, float, float]:
        """Distances of bar axes from the nearer face: bottom bars along x, along y, top bars along x, along y."""
        if self.d_bottom is not None and self.d_top is not None:
            return (*self.d_bottom, *self.d_top)
        assert (
            self.cover is not None and self.bar is not None
        )  # Validation requires cover and bar if d_bottom and d_top are absent.
        bottom, top = self.cover.bottom + 0.5 * self.bar, self.cover.top + 0.5 * self.bar
        return bottom, bottom + self.bar, top, top + self.bar

    def section(self, length: str, force: str) -> en1992.Bars:
        """Design data of the reinforced section: bar distances, strengths, ratios; units are ``length``, ``force``."""
        unit = _megapascals(length, force)
        fck, fyk = self.fck * unit, self.fyk * unit
        depth, strength = en1992.stress_block(fck)
        return en1992.Bars(
            *self.distances,
            strength * en1992.compressive_strength(self.fck, self.gamma_c, self.alpha_cc),
            en1992.yield_strength(self.fyk, self.gamma_s),
            depth * en1992.largest_depth(fck),
            en1992.least_ratio(fck, fyk),
            en1992.MOST,
            _PLAIN * en1992.tensile_strength(fck) / unit / 6.0,
        )


def _megapascals(length: str, force: str) -> float:
    """Value in MPa of the stress unit ``force``/``length``²."""
    return NEWTONS[force] / METRES[length] ** 2 * 1e-6
