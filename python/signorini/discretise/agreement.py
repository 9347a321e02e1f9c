"""Rigid supports that ask for different deflections where they meet, as the input has them and not as a mesh does."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from signorini.discretise.places import curve, region
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.supports import ContactPoints
from signorini.errors import InputError
from signorini.mesh import Mesh
from signorini.mesh.boxtree import BoxTree
from signorini.model import AnnulusPlate, DiscPlate, Model, Plate, Support
from signorini.quadrature.crossings import evaluate, quadratics, with_circles, with_segments
from signorini.regions import Region

_SAME_PLACE = 1e-9
"""Part of the plate's size within which points are one."""
_NEAR = 1e-4
"""Part of an element's side within which a mesh cannot tell places apart; deflections there are those of one place, but
for what the plate may turn."""
_STEEP = 0.1
"""Slope from which on deflections are no longer small."""
_CONSISTENT = 1e-9
"""Part of the gaps and settlements by which bounds may cross."""
_SPACING = 0.25
"""Distance, over an element's side, of the points of a curve that are compared with what it lies on."""
_MOST = 10_000
"""Points of one curve, or pairs of sides and segments, that are looked at together."""
_CHORDS = 64
"""Straight pieces of a curved side: they leave it by less than 1e-3 of its rise."""
_STRAIGHT = 1e-9


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
    drawn: dict[int, _Drawn] = {}
    for place, first in enumerate(rigid[:-1]):
        apart = (least[place] > most[place + 1 :]) | (least[place + 1 :] > most[place])
        for second in (rigid[place + 1 + i] for i in np.flatnonzero(apart)):
            if _asks_the_same(model.support[first], model.support[second]):
                continue
            for i in (first, second):
                if i not in drawn:
                    drawn[i] = _draw(mesh, model.plate, model.support[i])
            _require_agreement_of(model, mesh, (first, second), (drawn[first], drawn[second]))


def _is_rigid(support: Support, compliance: Floats) -> bool:
    """Whether a support bounds the deflection, without stiffness or with one as good as none."""
    if support.resists is None and "w" not in support.fixed:
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


@dataclass(frozen=True, eq=False)
class _Drawn:
    """Where a support is: points (q, 2) of it, straight or curved sides (k, 3, 2), circles (m, 3), and a region."""

    points: Floats
    sides: Floats = field(default_factory=lambda: np.zeros((0, 3, 2)))
    circles: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    inside: Region | None = None
    everywhere: bool = False
    only_points: bool = False

    def nearest(self, points: Floats, near: float) -> tuple[Ints, Floats]:
        """Which of some points are within ``near`` of this support, by number, and what of it is nearest to each."""
        every = np.arange(len(points))
        if self.everywhere:
            return every, points
        found = [(every[:0], points[:0])]
        if self.inside is not None:
            within = self.inside.contains(points)
            found.append((every[within], points[within]))
        chords = np.repeat(self.points[:, None], 2, axis=1) if self.only_points else _chords(self.sides)
        if len(chords):
            boxes = np.hstack([chords.min(axis=1) - near, chords.max(axis=1) + near])
            point, chord = BoxTree.build(boxes).pairs(points)
            a, along = chords[chord, 0], chords[chord, 1] - chords[chord, 0]
            length = (along**2).sum(axis=1)
            part = ((points[point] - a) * along).sum(axis=1) / np.where(length > 0, length, 1.0)
            found.append((point, a + np.clip(part, 0.0, 1.0)[:, None] * along))
        for x, y, radius in self.circles:
            out = points - (x, y)
            distance = np.hypot(*out.T)
            off = distance > 0.5 * radius
            found.append((every[off], (x, y) + out[off] * (radius / distance[off])[:, None]))
        which, at = (np.concatenate(parts) for parts in zip(*found, strict=True))
        close = np.hypot(*(points[which] - at).T) <= near
        return which[close], at[close]


def _draw(mesh: Mesh, plate: Plate, support: Support) -> _Drawn:
    if support.at is not None:
        return _Drawn(np.array(support.at, dtype=np.float64), only_points=True)
    if support.area == "all":
        return _Drawn(mesh.points, everywhere=True)
    step = _SPACING * float(np.sqrt(mesh.element_area.mean()))
    shape = curve(support) or region(support.area)
    if shape is None:
        return _draw_edges(mesh, plate, support.edge or (), step)
    outline, inside = shape.outline, region(support.area)
    sides = np.stack([outline.segments[:, 0], outline.segments.mean(axis=1), outline.segments[:, 1]], axis=1)
    points = [_spread(sides, outline.circles, step)]
    if inside is not None:
        points.append(mesh.points[inside.contains(mesh.points)])
    return _Drawn(np.concatenate(points), sides, outline.circles, inside)


def _draw_edges(mesh: Mesh, plate: Plate, names: tuple[str, ...], step: float) -> _Drawn:
    """Edges of the plate: true circles of discs and annuli, and sides of elements."""
    radii: dict[str, float] = {}
    center = (0.0, 0.0)
    match plate:
        case DiscPlate():
            radii, center = {"rim": plate.radius}, plate.center
        case AnnulusPlate():
            radii, center = {"inner": plate.inner, "outer": plate.outer}, plate.center
    others = [mesh.points[mesh.edges[name]] for name in names if name not in radii]
    sides = np.concatenate([np.zeros((0, 3, 2)), *others])
    circles = np.array([[*center, radii[name]] for name in names if name in radii]).reshape(-1, 3)
    return _Drawn(_spread(sides, circles, step), sides, circles)


def _spread(sides: Floats, circles: Floats, step: float) -> Floats:
    """Points all along sides and circles, ends of sides among them."""
    found = [sides[:, [0, 2]].reshape(-1, 2)]
    along = quadratics(sides)
    length = np.hypot(*(sides[:, 2] - sides[:, 0]).T)
    count = np.minimum(np.ceil(length / step), _MOST // max(1, len(sides)) + 1).astype(np.int64)
    which = np.repeat(np.arange(len(sides)), count)
    number = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    found.append(evaluate(along[which], 2.0 * (number + 0.5) / count[which] - 1.0))
    for x, y, radius in circles:
        angle = np.linspace(0.0, 2 * np.pi, min(_MOST, math.ceil(2 * np.pi * radius / step) + 4), endpoint=False)
        found.append((x, y) + radius * np.column_stack([np.cos(angle), np.sin(angle)]))
    return np.concatenate(found)


def _is_straight(sides: Floats) -> Bools:
    bend = np.abs(sides[:, 1] - 0.5 * (sides[:, 0] + sides[:, 2])).max(axis=1, initial=0.0)
    return np.asarray(bend <= _STRAIGHT * np.abs(sides[:, 2] - sides[:, 0]).max(axis=1, initial=0.0))


def _chords(sides: Floats) -> Floats:
    """Straight segments (r, 2, 2) along sides."""
    straight = _is_straight(sides)
    bent = quadratics(sides[~straight])
    ends = [evaluate(bent, np.full(len(bent), t)) for t in np.linspace(-1.0, 1.0, _CHORDS + 1)]
    pieces = [np.stack([a, b], axis=1) for a, b in pairwise(ends)]
    return np.concatenate([sides[straight][:, [0, 2]], *pieces])


def _crossings(one: _Drawn, other: _Drawn) -> Floats:
    """Points (r, 2) at which outlines cross; two curved sides, being a mesh's, meet at nodes only."""
    mine, others = _is_straight(one.sides), _is_straight(other.sides)
    found = [
        *_pairwise(one.sides, other.sides[others][:, [0, 2]], with_segments),
        *_pairwise(other.sides[~others], one.sides[mine][:, [0, 2]], with_segments),
        *_pairwise(one.sides, other.circles, with_circles),
        *_pairwise(other.sides, one.circles, with_circles),
        *(_of_circles(a, b) for a in one.circles for b in other.circles),
    ]
    return np.concatenate([np.zeros((0, 2)), *found])


def _pairwise(
    sides: Floats, others: Floats, crossed: Callable[[Floats, Floats], tuple[Ints, Floats]]
) -> Iterator[Floats]:
    """Cross every side with every segment or circle, some at a time."""
    if not len(sides):
        return
    curves, some = quadratics(sides), max(1, _MOST // len(sides))
    for first in range(0, len(others), some):
        part = others[first : first + some]
        pairs = np.repeat(curves, len(part), axis=0), np.concatenate([part] * len(curves))
        yield crossed(*pairs)[1]


def _of_circles(one: Floats, other: Floats) -> Floats:
    """Points (2, 2) at which two circles cross, or one of the first on the line through their centres."""
    between = other[:2] - one[:2]
    distance = float(np.hypot(*between))
    if distance == 0.0:
        return np.zeros((0, 2))
    along = between / distance
    part = 0.5 * (distance + (one[2] - other[2]) * (one[2] + other[2]) / distance)
    part = float(np.clip(part, -one[2], one[2]))
    up = math.sqrt((one[2] - part) * (one[2] + part)) * np.array([-along[1], along[0]])
    return np.asarray(one[:2] + part * along + np.array([up, -up]))


def _feet(sides: Floats, circles: Floats) -> Floats:
    """The points (r, 2) of straight sides that are nearest to the centres of circles."""
    a, along = sides[:, None, 0], (sides[:, 2] - sides[:, 0])[:, None]
    part = ((circles[None, :, :2] - a) * along).sum(axis=2) / (along**2).sum(axis=2)
    return np.asarray((a + np.clip(part, 0.0, 1.0)[..., None] * along).reshape(-1, 2))


def _require_agreement_of(model: Model, mesh: Mesh, supports: tuple[int, int], drawn: tuple[_Drawn, _Drawn]) -> None:
    one, other = drawn
    near = _NEAR * float(np.sqrt(mesh.element_area.mean()))
    points = [one.points, other.points, _crossings(one, other)]
    points += [_feet(a.sides[_is_straight(a.sides)], b.circles) for a, b in (drawn, drawn[::-1])]
    asked = np.concatenate(points)
    of_one, at_one = one.nearest(asked, near)
    asked = asked[of_one]
    of_other, at_other = other.nearest(asked, near)
    asked, at_one = asked[of_other], at_one[of_other]
    apart = np.maximum(np.hypot(*(at_one - asked).T), np.hypot(*(at_other - asked).T))
    together = (apart <= _SAME_PLACE * mesh.size)[:, None]
    at = [np.where(together, asked, place) for place in (at_one, at_other)]
    on_plate = mesh.locate(at[0]).inside & mesh.locate(at[1]).inside
    at = [places[on_plate] for places in at]
    if not len(at[0]):
        return
    bounds = [_bounds(model.support[i], i, places) for i, places in zip(supports, at, strict=True)]
    (least, most, size), (other_least, other_most, other_size) = bounds
    over = np.maximum(least - other_most, other_least - most)
    distance = np.hypot(*(at[0] - at[1]).T)
    allowed = _CONSISTENT * np.maximum(size, other_size) + _STEEP * distance
    if not (over > allowed).any():
        return
    worst = int(np.argmax(over - allowed))
    upper = 0 if other_least[worst] - most[worst] >= least[worst] - other_most[worst] else 1
    order = (0, 1) if all(b[0][worst] == b[1][worst] for b in bounds) else (upper, 1 - upper)
    raise _contradiction(
        mesh, at[order[0]][worst], float(distance[worst]), [(supports[i], *bounds[i][:2]) for i in order], worst
    )


def _bounds(support: Support, index: int, at: Floats) -> tuple[Floats, Floats, Floats]:
    """The least and the most deflection that a support allows at points (q, 2), and the size of what they are from."""
    settlement = support.settlement(*at.T, place=f"support[{index + 1}].settlement")
    gap = support.gap(*at.T, at_least=0.0, place=f"support[{index + 1}].gap")
    least = np.full(len(at), -np.inf) if support.resists == "down" else settlement - gap
    most = np.full(len(at), np.inf) if support.resists == "up" else settlement + gap
    return least, most, np.abs(settlement) + gap


def _contradiction(
    mesh: Mesh, at: Floats, distance: float, bounds: Sequence[tuple[int, Floats, Floats]], which: int
) -> InputError:
    (first, *mine), (second, *theirs) = ((index, least[which], most[which]) for index, least, most in bounds)
    x, y = np.round(at / mesh.size, 12) * mesh.size + 0.0
    names = f"support[{first + 1}]", f"support[{second + 1}]"
    away, why = "", ""
    if distance > _SAME_PLACE * mesh.size:
        away, why = f", {distance:.3g} away,", "Mesh elements are too large to tell these places apart. "
    if mine[0] == mine[1] and theirs[0] == theirs[1]:
        said = f"{names[0]} holds the plate at {mine[0] + 0.0:g} there and {names[1]}{away} at {theirs[0] + 0.0:g}"
    else:
        said = (
            f"{names[0]} lets the deflection be at most {mine[1] + 0.0:g} there and {names[1]}{away} at least "
            f"{theirs[0] + 0.0:g}"
        )
    return InputError(
        f"Supports contradict each other at [{x:g}, {y:g}]: {said}. {why}Correct a gap or a settlement, or "
        "give a stiffness.",
        place=names[1],
    )
