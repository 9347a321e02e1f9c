"""Rigid supports that ask for different deflections where they meet, as the input has them and not as a mesh does."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from signorini.discretise.drawn import Drawn, crossings, draw, feet
from signorini.discretise.placed import SAME_PLACE
from signorini.discretise.rows import Floats, Ints
from signorini.discretise.supports import ContactPoints
from signorini.errors import InputError, path_in_words, point
from signorini.mesh import Mesh
from signorini.model import Model, Support
from signorini.model.footprint import KEYS as FOOTPRINT

_NEAR = 1e-4
"""Part of an element's side within which a mesh cannot tell places apart; deflections there are those of one place, but
for what the plate may turn."""
_STEEP = 0.1
"""Slope from which on deflections are no longer small."""
_CONSISTENT = 1e-9
"""Part of the largest gap and settlement on two supports by which their bounds may cross: formulas are rounded."""
_ROUNDING = 1e-15
"""Part of the largest coordinate by which coordinates are rounded."""
_ROOT_OF_ROUNDING = 1e-7
"""Part of the largest gap and settlement by which a formula may change over the rounding of a coordinate: roots rise
steeply from zero, but what jumps is not rounded."""
_NO_NUMBERS = np.zeros(0, np.int64)
_SPACING = 0.25
"""Distance, over an element's side, of the points of a curve that are compared with what it lies on."""


def require_agreement(model: Model, mesh: Mesh, contacts: ContactPoints) -> None:
    """Refuse rigid supports of which one asks for more deflection than another allows, at a place that both hold.

    Places closer than a mesh can tell are one, unless a slope that is small leads from one to the other.

    Raises
    ------
    InputError
    """
    rigid = [
        i for i, support in enumerate(model.support) if _is_rigid(support, contacts.compliance[contacts.support == i])
    ]
    least, most = np.array([_constants(model.support[i]) for i in rigid]).reshape(-1, 2).T
    if not len(rigid) or least.max() <= most.min():
        return
    step = float(np.sqrt(mesh.element_area.mean()))
    drawn = [draw(mesh, model.plate, model.support[i], _SPACING * step) for i in rigid]
    values = [_Values(model.support[i], i, mesh, places) for i, places in zip(rigid, drawn, strict=True)]
    for first, second in _that_may_meet(drawn, least, most, _NEAR * step):
        if not _asks_the_same(model.support[rigid[first]], model.support[rigid[second]]):
            pair = (drawn[first], drawn[second]), (values[first], values[second])
            _require_agreement_of(mesh, _NEAR * step, *pair)


def _is_rigid(support: Support, compliance: Floats) -> bool:
    """Whether a support bounds the deflection, without stiffness or with one as good as none."""
    # A footprint's mean says nothing of any one place.
    if (support.resists is None and "w" not in support.fixed) or support.given(FOOTPRINT):
        return False
    return support.stiffness is None or (len(compliance) > 0 and not compliance.any())


def _constants(support: Support) -> tuple[float, float]:
    """The least and the most deflection that a support allows; where it varies, a most that is below any least."""
    ways = support.resists or "both"
    varies = not (support.settlement.is_constant and support.gap.is_constant)
    base, gap = (0.0, 0.0) if varies else (support.settlement.value, support.gap.value)
    least = -math.inf if ways == "down" else math.inf if varies else base - gap
    most = math.inf if ways == "up" else -math.inf if varies else base + gap
    return least, most


def _asks_the_same(one: Support, other: Support) -> bool:
    """Whether two supports follow the same formulas, so that they agree wherever they meet."""
    return one.settlement == other.settlement and one.gap == other.gap


def _that_may_meet(drawn: Sequence[Drawn], least: Floats, most: Floats, near: float) -> Iterator[tuple[int, int]]:
    """Pairs of supports, by number, that are near each other and may ask for different deflections."""
    boxes = np.array([one.box for one in drawn]) + near * np.array([-1.0, -1.0, 1.0, 1.0])
    only_points = np.array([one.only_points for one in drawn])
    points_near = _points_near(drawn, near)
    for first in range(len(drawn) - 1):
        later = slice(first + 1, None)
        meet = (boxes[first, :2] <= boxes[later, 2:]).all(axis=1) & (boxes[later, :2] <= boxes[first, 2:]).all(axis=1)
        if only_points[first]:
            meet &= ~only_points[later]
            meet[points_near.get(first, _NO_NUMBERS) - first - 1] = True
        meet &= (least[first] > most[later]) | (least[later] > most[first])
        yield from ((first, first + 1 + int(i)) for i in np.flatnonzero(meet))


def _points_near(drawn: Sequence[Drawn], near: float) -> dict[int, Ints]:
    """Later supports at points, by number, that have one near a point of each support at points."""
    from scipy.spatial import cKDTree

    which = [i for i, one in enumerate(drawn) if one.only_points]
    if len(which) < 2:
        return {}
    owner = np.repeat(which, [len(drawn[i].points) for i in which])
    tree = cKDTree(np.concatenate([drawn[i].points for i in which]))
    owners = np.sort(owner[tree.query_pairs(near, output_type="ndarray")], axis=1)
    pairs = np.unique(owners[owners[:, 0] < owners[:, 1]], axis=0)
    firsts, starts = np.unique(pairs[:, 0], return_index=True)
    return dict(zip(firsts.tolist(), np.split(pairs[:, 1], starts[1:]), strict=False))


def _require_agreement_of(mesh: Mesh, near: float, drawn: tuple[Drawn, Drawn], values: tuple[_Values, _Values]) -> None:
    one, other = drawn
    points = [one.points, other.points, crossings(one, other)]
    points += [feet(one, other), feet(other, one)]
    asked = np.concatenate(points)
    of_one, at_one = one.nearest(asked, near)
    asked = asked[of_one]
    of_other, at_other = other.nearest(asked, near)
    asked, at_one = asked[of_other], at_one[of_other]
    apart = np.maximum(np.hypot(*(at_one - asked).T), np.hypot(*(at_other - asked).T))
    together = (apart <= SAME_PLACE * mesh.diameter)[:, None]
    at = [np.where(together, asked, place) for place in (at_one, at_other)]
    on_plate = mesh.locate(at[0]).inside & mesh.locate(at[1]).inside
    at = [places[on_plate] for places in at]
    if not len(at[0]):
        return
    bounds = [of.bounds(places) for of, places in zip(values, at, strict=True)]
    (least, most), (other_least, other_most) = bounds
    distance = np.hypot(*(at[0] - at[1]).T)
    over = np.maximum(least - other_most, other_least - most) - _STEEP * distance
    if not (over > 0.0).any():
        return
    beyond = over - _CONSISTENT * max(of.largest for of in values)
    wrong = np.flatnonzero(beyond > 0.0)
    if not len(wrong):
        return
    rounding = sum(of.change_by_rounding(places[wrong]) for of, places in zip(values, at, strict=True))
    small = max(_ROOT_OF_ROUNDING * max(of.largest for of in values), _STEEP * _rounding_of_places(mesh))
    beyond[wrong] -= np.minimum(rounding, small)
    if not (beyond > 0.0).any():
        return
    worst = int(np.argmax(beyond))
    upper = 0 if other_least[worst] - most[worst] >= least[worst] - other_most[worst] else 1
    order = (0, 1) if all(b[0][worst] == b[1][worst] for b in bounds) else (upper, 1 - upper)
    said = [(values[i].index, *bounds[i]) for i in order]
    raise _contradiction(mesh, at[order[0]][worst], float(distance[worst]), said, worst)


def _rounding_of_places(mesh: Mesh) -> float:
    return _ROUNDING * float(np.abs(mesh.points).max())


@dataclass(frozen=True, eq=False)
class _Values:
    """What a support, by its number in the model, allows and where its formulas are asked."""

    support: Support
    index: int
    mesh: Mesh
    drawn: Drawn

    def _formulas(self, at: Floats) -> tuple[Floats, Floats]:
        """Settlement and gap at points (q, 2)."""
        own = ("support", self.index)
        settlement = self.support.settlement(*at.T, place=(*own, "settlement"))
        return settlement, self.support.gap(*at.T, at_least=0.0, place=(*own, "gap"))

    def bounds(self, at: Floats) -> tuple[Floats, Floats]:
        """The least and the most deflection that the support allows at points (q, 2)."""
        settlement, gap = self._formulas(at)
        least = np.full(len(at), -np.inf) if self.support.resists == "down" else settlement - gap
        most = np.full(len(at), np.inf) if self.support.resists == "up" else settlement + gap
        return least, most

    @cached_property
    def largest(self) -> float:
        """The largest settlement and gap anywhere on the support; what exceeds the plate's size is no deflection."""
        at = self.drawn.points
        settlement, gap = self._formulas(at[self.mesh.locate(at).inside])
        return min(float((np.abs(settlement) + gap).max(initial=0.0)), self.mesh.size)

    def change_by_rounding(self, at: Floats) -> Floats:
        """How much the formulas change over as much as the coordinates of points (q, 2) are rounded."""
        found = np.zeros(len(at))
        if self.support.settlement.is_constant and self.support.gap.is_constant:
            return found
        values = self._formulas(at)
        inward = np.where(at < self.mesh.middle, 1.0, -1.0) * _rounding_of_places(self.mesh)
        for there in (at + inward, at - inward):
            # A root or a quotient may not be defined on one side.
            with suppress(InputError):
                changed = self._formulas(there)
                found = np.maximum(found, sum(np.abs(a - b) for a, b in zip(changed, values, strict=True)))
        return found


def _contradiction(
    mesh: Mesh, at: Floats, distance: float, bounds: Sequence[tuple[int, Floats, Floats]], which: int
) -> InputError:
    (first, *mine), (second, *theirs) = ((index, least[which], most[which]) for index, least, most in bounds)
    names = [path_in_words(("support", index)) for index in (first, second)]
    away, why = "", ""
    if distance > SAME_PLACE * mesh.diameter:
        away, why = f", {distance:.3g} away,", "Mesh elements are too large to tell these places apart. "
    if mine[0] == mine[1] and theirs[0] == theirs[1]:
        said = f"{names[0]} holds the plate at {mine[0] + 0.0:g} there and {names[1]}{away} at {theirs[0] + 0.0:g}"
    else:
        said = (
            f"{names[0]} lets the deflection be at most {mine[1] + 0.0:g} there and {names[1]}{away} at least "
            f"{theirs[0] + 0.0:g}"
        )
    return InputError(
        f"Supports contradict each other at {point(at, mesh.size)}: {said}. {why}Correct a gap or a settlement, or "
        "give a stiffness.",
        place=("support", second),
    )
