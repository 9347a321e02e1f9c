"""Whether reactions exist that balance a load, and how near a load is to the end of its equilibrium.

It is decided on the plate as a rigid body, before anything is factorized. Reactions of one-sided supports have a sign,
so by Farkas' lemma they balance the load exactly if no rigid motion that every support allows lets the load do work.
The motion with the most work is found by a linear program in at most three unknowns. Supports reach as far as their
outlines, whatever the mesh. A plate tips about the line of the allowed motion with the most work for its turning: that
work is the moment that is short, by duality the least couple with which reactions would balance the load.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from scipy.sparse import csr_array, hstack, vstack

from signorini.base.linear_program import minimise, minimise_with_prices
from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats, Ints
from signorini.equilibrium.balance import RANK, Bearing, RigidFreedom, allowed_motions, load_size, work_of
from signorini.errors import InputError, length, point
from signorini.model import Combination

_UP_AND_DOWN = 1e-5
"""What moving up and down counts for beside turning by as much: little, so that of equal turns the nearest is found."""
_HOLDS = 1e-9
"""Part of the largest reaction, and of the motion, that is rounding."""
WORK = 1e-10
"""Work below this part of the load times the motion is rounding."""
_COARSE = 1e-5
"""Part of the load below which the tolerances of a linear program, 1e-7, count in an extra load."""
_CLOSED = 1e-7
"""Part of the largest opening below which a point stays closed as the plate tips."""
_LIFTS = 1e-9
"""Part of the plate's size below which a motion of unit turning lifts the plate nowhere."""
_MOST_HINGES = 4
"""Points of a support that a plate tips about."""
_MOST = 1e6
"""Times a case's factor beyond which it counts as without limit."""
_ALIKE = 1e-9
"""Ratio of limits, less one, that is rounding."""
_OVERLAP = 1e-7
"""Part of the largest travel by which rigid supports must overlap to contradict each other."""
_BRINK = 1e-9
"""Part of the load that must be to spare at every support for the plate not to be on the brink."""
CONTRADICTION = (
    "The rigid supports contradict each other: no deflection of the plate agrees with all their gaps and settlements. "
    "Reactions that balance the load exist. Correct a gap or a settlement, or give a stiffness."
)
"""What there is to say where `supports_contradict`."""


@dataclass(frozen=True, eq=False)
class Axis:
    """A line about which the plate tips: ``normal`` (2,) · x + ``offset`` = 0, the normal of length one."""

    normal: Floats
    offset: float

    def ends(self, middle: Floats, length: float) -> Floats:
        """Two points (2, 2) of the line so far apart, about its point nearest to the middle."""
        foot = middle - (self.normal @ middle + self.offset) * self.normal
        along = np.array([-self.normal[1], self.normal[0]])
        return np.asarray(foot + np.outer([-0.5, 0.5], along) * length)


@dataclass(frozen=True, eq=False)
class Holding:
    """The least extra force that would just hold the plate, which way it acts, and at which node (2,)."""

    force: float
    way: Literal["up", "down"]
    at: Floats


@dataclass(frozen=True, eq=False)
class Imbalance:
    """Why no reactions balance a load: it moves the plate off all its supports, or tips it about a line.

    ``resultant`` is the sum of the load's forces, positive down; ``way`` the way in which the plate moves off its
    supports, or ``axis`` the line about which it tips, ``moment`` what is short about it. ``hinges`` (k, 2) are points
    of the supports' outlines on the line, ``supports`` (k,) whose they are. ``holding`` is None if no force at one
    point holds the plate; ``limit`` is a case of a combination and the factor on top of its own at which it would
    just stand. Where ``supports`` come to their limits, ``carried`` is the part of the load that can be carried,
    ``most`` the force, or the moment about the line, that they can give, and ``moment`` what is short of either. Of
    several plates ``motions`` (p, 3) are theirs, as w and the slopes about the middle, in place of one way or line.
    """

    resultant: float
    way: Literal["up", "down"] | None
    axis: Axis | None
    moment: float
    hinges: Floats
    supports: Ints
    holding: Holding | None
    limit: tuple[str, float] | None = None
    carried: float | None = None
    most: float = np.inf
    motions: Floats | None = None


def imbalance(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats) -> Imbalance | None:
    """Find out why no reactions balance a nodal load (3n,); None where they exist.

    Where they exist, but the contact points of the mesh do not reach as far as they act, the load is refused.
    """
    if freedom.outline.limited:
        return _beyond_limits(discretisation, freedom, nodal)
    if not discretisation.plates and (way := _lifting(discretisation, freedom, nodal)):
        down, mx, my = (float(part) for part in discretisation.rigid_motions.T @ nodal)
        acting = discretisation.middle + np.array([mx, my]) / down
        holding = _holding(discretisation, freedom, nodal, acting, "down" if way == "up" else "up")
        return Imbalance(down, way, None, 0.0, np.zeros((0, 2)), np.zeros(0, np.int64), holding)
    best = _unresisted(discretisation, freedom, freedom.outline, nodal)
    if best is None:
        _require_reach(discretisation, freedom, nodal)
        return None
    # Of all such motions the one with most work for its turning.
    work = work_of(discretisation, freedom, nodal) / load_size(discretisation, nodal)
    most = steepest(freedom.motions, freedom.outline.moves, work)
    if discretisation.plates:
        return _of_plates(discretisation, freedom, nodal, best if most is None else most)
    return _tipping(discretisation, freedom, nodal, best if most is None else most)


def _beyond_limits(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats) -> Imbalance | None:
    """Why supports with limits cannot balance a load: the mechanism by which they open and yield; None where they can.

    The part of the load that they carry is a linear program over their reactions, whose multipliers are the mechanism
    (static and kinematic theorem, Drucker, Prager and Greenberg 1952): on it the load does more work than they can.
    """
    bearing, total = freedom.outline, load_size(discretisation, nodal)
    if not freedom.count or total == 0.0:
        return None
    work = work_of(discretisation, freedom, nodal)
    cost = np.append(-1.0, np.zeros(len(bearing.moves)))
    bounds = np.append(0.0, bearing.least / total), np.append(1.0, bearing.most / total)
    best = minimise_with_prices(cost, np.column_stack([-work / total, bearing.moves.T]), (0.0, 0.0), bounds, WORK)
    if best is None or best[0][0] >= 1.0 - WORK:
        return None
    motion = -best[1]
    motion *= np.sign(work @ motion) / np.abs(motion).max()
    if discretisation.plates:
        gives = np.where(bearing.moves @ motion > 0.0, bearing.most, bearing.least)
        gives = np.isfinite(gives) & (gives != 0.0) & (np.abs(bearing.moves @ motion) > _CLOSED)
        some = np.unique(bearing.support[gives])
        return replace(
            _of_plates(discretisation, freedom, nodal, motion), supports=some, carried=max(0.0, float(best[0][0]))
        )
    w, *slopes = (freedom.motions @ motion) / np.array([1.0, discretisation.mesh.size, discretisation.mesh.size])
    turning, pressed = float(np.hypot(*slopes)), bearing.moves @ motion
    tips = turning * discretisation.mesh.size > _HOLDS * abs(w)
    strength = np.where(pressed > 0.0, bearing.most, bearing.least)
    gives = np.isfinite(strength) & (strength != 0.0) & (np.abs(pressed) > _CLOSED * np.abs(pressed).max())
    unit = turning if tips else abs(float(w))
    most = float(strength[gives] @ pressed[gives]) / unit
    axis = None
    if tips:
        normal = np.array(slopes) / turning
        axis = Axis(normal, float(w / turning - normal @ discretisation.middle))
    return Imbalance(
        float((discretisation.rigid_motions.T @ nodal)[0]),
        None if tips else "down" if w > 0 else "up",
        axis,
        float(work @ motion) / unit - most,
        np.zeros((0, 2)),
        np.unique(bearing.support[gives]),
        None,
        carried=max(0.0, float(best[0][0])),
        most=most,
    )


def _of_plates(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats, motion: Floats) -> Imbalance:
    """How a load moves several plates by a motion (d,) that every support allows."""
    motions = (freedom.motions @ motion).reshape(-1, 3) / [1.0, discretisation.mesh.size, discretisation.mesh.size]
    down, none = float((discretisation.rigid_motions.T @ nodal)[::3].sum()), np.zeros(0, np.int64)
    return Imbalance(down, None, None, 0.0, np.zeros((0, 2)), none, None, motions=motions)


def _tipping(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats, motion: Floats) -> Imbalance:
    """How a load tips the plate by a motion (d,) that every support allows."""
    opening = np.abs(freedom.outline.moves @ motion)
    w, *slopes = (freedom.motions @ motion) / np.array([1.0, discretisation.mesh.size, discretisation.mesh.size])
    turning = float(np.hypot(*slopes))
    normal = np.array(slopes) / turning
    axis = Axis(normal, float(w / turning - normal @ discretisation.middle))
    work = discretisation.rigid_motions.T @ nodal
    closed = opening <= _CLOSED * opening.max(initial=0.0)
    # Weight holds it best where the motion lifts the plate most.
    lift = -(discretisation.mesh.points @ normal + axis.offset)
    farthest = int(lift.argmax())
    holding = None
    if lift[farthest] > _LIFTS * discretisation.mesh.size:
        holding = _holding(discretisation, freedom, nodal, discretisation.mesh.points[farthest], "down")
    return Imbalance(
        float(work[0]),
        None,
        axis,
        float(work @ np.array([w, *slopes])) / turning,
        freedom.outline.positions[closed],
        freedom.outline.support[closed],
        holding,
    )


def _unresisted(
    discretisation: Discretisation, freedom: RigidFreedom, bearing: Bearing, nodal: Floats
) -> Floats | None:
    """The motion (d,) of at most unit size that a bearing allows on which the load does most work, if there is one."""
    total = load_size(discretisation, nodal)
    if not freedom.count or total == 0:
        return None
    work, one_sided = work_of(discretisation, freedom, nodal), bearing.moves
    # By default 1e-7 of the load may be overlooked, which a certificate sees.
    best = minimise(-work / total, one_sided, (-np.inf, 0.0), (-1.0, 1.0), tolerance=WORK)
    return None if best is None or work @ best <= WORK * total else best


def _require_reach(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats) -> None:
    """Refuse a load that the supports can balance on their outlines, but not at the contact points of the mesh."""
    if _unresisted(discretisation, freedom, freedom.on_mesh, nodal) is None:
        return
    down, mx, my = (discretisation.rigid_motions.T @ nodal).reshape(-1, 3).sum(axis=0)
    where = ""
    if abs(down) > WORK * load_size(discretisation, nodal):
        where = f" near {point(discretisation.middle + np.array([mx, my]) / down, discretisation.mesh.size)}"
    raise InputError(
        f"The load acts{where} so near the outline of the supports that they can balance it, but not at the contact "
        "points of this mesh, which lie within that outline. Take a finer mesh there.",
        place=("mesh",),
    )


def _lifting(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats) -> Literal["up", "down"] | None:
    """Which way the plate moves off all its supports without turning, if it does."""
    one_sided, least = freedom.outline.moves, WORK * load_size(discretisation, nodal)
    work = work_of(discretisation, freedom, nodal)
    ways: tuple[tuple[Literal["up", "down"], float], ...] = (("up", -1.0), ("down", 1.0))
    for way, w in ways:
        motion = np.array([w, 0.0, 0.0])
        part = motion @ freedom.motions
        free = np.abs(freedom.motions @ part - motion).max() <= RANK
        if free and (one_sided @ part).max(initial=0.0) <= RANK and work @ part > least:
            return way
    return None


def _holding(
    discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats, best: Floats, way: Literal["up", "down"]
) -> Holding | None:
    """What least extra load would hold the plate, at the best point or, if none does there, amid the supports."""
    for at in (best, freedom.outline.positions.mean(axis=0)):
        node = discretisation.mesh.points[((discretisation.mesh.points - at) ** 2).sum(axis=1).argmin()]
        least = _least_holding(discretisation, freedom, nodal, node, way)
        if least is not None:
            return Holding(least, way, node)
    return None


def _least_holding(
    discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats, at: Floats, way: str
) -> float | None:
    """Least extra load at a point with which reactions balance the load, by a linear program in them."""
    size = discretisation.mesh.size
    # The conditions of equilibrium over the free motions, forces in units of the load and lengths of the plate.
    scale = np.array([1.0, size, size])
    resultant = work_of(discretisation, freedom, nodal)
    total = float(np.abs(resultant).max())
    sign = 1.0 if way == "down" else -1.0
    extra = sign * (np.array([1.0, *(at - discretisation.middle)]) / scale) @ freedom.motions
    one_sided = freedom.outline.moves
    cost = np.zeros(1 + len(one_sided))
    cost[0] = 1.0
    balance = np.column_stack([-extra, one_sided.T])
    least = minimise(cost, balance, (resultant / total, resultant / total), (0.0, np.inf))
    if least is None or least[0] > _COARSE:
        return None if least is None else total * float(least[0])
    # So little is within what the program lets pass: it is told by the motions that the load would win.
    rays = allowed_motions(freedom.outline)
    if rays is None:
        return None
    needed, helped = rays @ resultant / total, -(rays @ extra)
    helping = (helped > RANK) & (needed > 0.0)
    return total * float((needed[helping] / helped[helping]).max()) if helping.any() else None


def explain(discretisation: Discretisation, why: Imbalance | None) -> str:
    """Say why no reactions balance a load, what would, or nothing where they exist."""
    if why is None:
        return ""
    force, arm = discretisation.model.units.force, discretisation.model.units.length if why.axis else ""
    unit = f" {force}" if force else ""
    of_moment = f"{unit} {arm}".rstrip() if unit else ""
    text = f"The plate {mechanism(discretisation, why)}"
    if why.motions is not None:
        carried = "" if why.carried is None else f" {why.carried:.4g} times the load can be carried."
        text = f"{mechanism(discretisation, why)}, and nothing resists that.{carried}"
    elif why.carried is not None and len(why.supports):
        most = f"{'a moment of ' if why.axis else ''}{why.most:.6g}{of_moment}"
        text += (
            f". That is {most} at most, short by {why.moment:.6g}{of_moment}; {why.carried:.4g} times the load can be "
        )
        text += "carried."
    elif why.axis:
        text += f", short by a moment of {why.moment:.6g}{of_moment}."
    else:
        text += f": the load's resultant is {abs(why.resultant):.6g}{unit} {why.way}, and no support resists that way."
    if why.holding is not None:
        at = point(why.holding.at, discretisation.mesh.size)
        text += f" An extra {why.holding.force:.6g}{unit} {why.holding.way} at {at} would just hold it."
    if why.limit is not None:
        case, factor = why.limit
        text += f' With the case "{case}" at {factor:.4g} times its factor it would just stand.'
    return text


def mechanism(discretisation: Discretisation, why: Imbalance) -> str:
    """Say how the plate moves as no reactions balance its load, as "tips about the line x = 2"."""
    if why.motions is not None:
        each = _motions(discretisation, why.motions)
        names = " and ".join(discretisation.model.support[index].name for index in why.supports.tolist())
        gives = "give their limits" if len(why.supports) > 1 else "gives its limit"
        return f"{' and '.join(each)}{f' as {names} {gives}' if names else ''}"
    if why.carried is not None and len(why.supports):
        names = " and ".join(discretisation.model.support[index].name for index in why.supports.tolist())
        limits = f"{names} {'give their limits' if len(why.supports) > 1 else 'gives its limit'}"
        return f"{_about(discretisation, why.axis) or f'moves {why.way}'} as {limits}"
    if why.axis is None:
        return f"{'lifts off' if why.way == 'up' else 'drops away from'} its supports"
    size, owners = discretisation.mesh.size, dict[str, dict[str, None]]()
    for at, support in zip(why.hinges, why.supports, strict=True):
        owners.setdefault(point(at, size), {})[discretisation.model.support[support].name] = None
    alike: dict[str, list[str]] = {}
    for spot, whose in owners.items():
        alike.setdefault(" and ".join(whose), []).append(spot)
    through = ", ".join(
        f"{', '.join(spots[:_MOST_HINGES])}{', ...' if len(spots) > _MOST_HINGES else ''} of {names}"
        for names, spots in alike.items()
    )
    return _about(discretisation, why.axis) + (f" through {through}" if through else "")


def _motions(discretisation: Discretisation, motions: Floats) -> list[str]:
    """Say how each of several plates that moves does it."""
    size, result = discretisation.mesh.size, []
    for plate, (w, *slopes) in zip(discretisation.plates, motions.tolist(), strict=True):
        turning, most = float(np.hypot(*slopes)), float(np.abs(motions * [1.0, size, size]).max())
        if turning * size > _HOLDS * most:
            normal = np.array(slopes) / turning
            offset = w / turning - float(normal @ discretisation.middle)
            result.append(f'"{plate.name}" {_about(discretisation, Axis(normal, offset))}')
        elif abs(w) > _HOLDS * most:
            result.append(f'"{plate.name}" {"goes down" if w > 0 else "lifts off"}')
    return result


def _about(discretisation: Discretisation, axis: Axis | None) -> str:
    if axis is None:
        return ""
    return f"tips about the line {line_in_words(axis.normal, axis.offset, discretisation.mesh.size)}"


def line_in_words(normal: Floats, offset: float, size: float) -> str:
    """Equation of the line normal · x + offset = 0 on a plate of some size, the larger of its coefficients one.

    Examples
    --------
    >>> import numpy as np
    >>> line_in_words(np.array([-0.6, -0.8]), 1.6, 4.0)
    '0.75 x + y = 2'
    >>> line_in_words(np.array([1.0, 1e-17]), 1e-16, 4.0)
    'x = 0'
    """
    leading = int(abs(normal[1]) > abs(normal[0]) * (1 + 1e-9))
    a, b = (round(float(part / normal[leading]), 9) for part in normal)
    equals = length(-offset / normal[leading], size)
    if a == 0.0 or b == 0.0:
        return f"{'xy'[leading]} = {equals}"
    first = "x" if a == 1.0 else f"{a:.6g} x"
    second = "y" if abs(b) == 1.0 else f"{abs(b):.6g} y"
    return f"{first} {'+' if b > 0 else '-'} {second} = {equals}"


def steepest(motions: Floats, moves: Floats, work: Floats) -> Floats | None:
    """Find the allowed motion (d,), of largest entry one, whose work (d,) is largest for its turning.

    It minimises ½ turning² - work under moves ≤ 0, whose dual is a nonnegative least-squares problem in the reactions;
    those that act there name the supports it turns about, and these the motion. ``motions`` (3, d) and ``moves`` (k, d)
    are those of `RigidFreedom`. None where arithmetic does not tell one.
    """
    from scipy.linalg import null_space
    from scipy.optimize import nnls

    weighed = np.tile([_UP_AND_DOWN, 1.0, 1.0], len(motions) // 3)[:, None] * motions
    metric = weighed.T @ weighed
    half = np.linalg.inv(np.linalg.cholesky(metric))
    try:
        reactions, _ = nnls(half @ moves.T, half @ work)
    except RuntimeError:
        return None
    closed = moves[reactions > _HOLDS * reactions.max(initial=0.0)]
    free = null_space(closed, rcond=_HOLDS) if len(closed) else np.eye(len(work))
    motion = free @ np.linalg.solve(free.T @ metric @ free, free.T @ work)
    motion = motion / max(np.abs(motion).max(initial=0.0), np.finfo(float).tiny)
    return motion if (moves @ motion).max(initial=0.0) <= _HOLDS and work @ motion > 0 else None


def imbalance_of(discretisation: Discretisation, freedom: RigidFreedom, combination: Combination) -> Imbalance | None:
    """Find out why no reactions balance a combination, with the case that would let it stand; None where they do."""
    why = imbalance(discretisation, freedom, discretisation.load(combination).weighing)
    return None if why is None else replace(why, limit=nearest_limit(discretisation, freedom, combination))


def nearest_limit(
    discretisation: Discretisation, freedom: RigidFreedom, combination: Combination
) -> tuple[str, float] | None:
    """Find the case, and the factor on top of its own, by which the combination comes to the limit of equilibrium.

    All other cases stay as they are. Of several the nearest to 1 in ratio, of equally near ones the case that the
    combination names last. Without limits reactions of one-sided supports make a cone, so that a load alone has no end:
    where it can be balanced, any multiple of it can. None where no case on its own has an end, or where the combination
    is out of balance and none brings it back.
    """
    preloads = discretisation.model.preload_cases
    acting = {case: factor for case, factor in (combination.factors or {}).items() if factor and case not in preloads}
    nodal = {case: factor * discretisation.cases[case].weighing for case, factor in acting.items()}
    whole = discretisation.load(combination).weighing
    if (len(acting) < 2 and not freedom.outline.limited) or not freedom.count or not whole.any():
        return None
    limits = [
        (case, limit)
        for case in acting
        for limit in _limits(discretisation, freedom, freedom.outline, whole - nodal[case], nodal[case])
        if 1 / _MOST < limit < _MOST
    ]
    # Two cases have each other's limit upside down, and rounding must not choose between them.
    return min(reversed(limits), key=lambda pair: round(abs(np.log(pair[1])) / _ALIKE), default=None)


def on_the_brink(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats) -> bool:
    """Whether a load that can be balanced no longer could be if it moved, however little, some way."""
    total = load_size(discretisation, nodal)
    if not freedom.count or total == 0:
        return False
    if freedom.outline.limited:
        return largest_factor(discretisation, freedom, freedom.outline, 0.0 * nodal, nodal) <= 1.0 + _BRINK
    one_sided = freedom.outline.moves
    # The first unknown is a reaction that every point has; the others come on top of it.
    balance = np.column_stack([one_sided.sum(axis=0), one_sided.T])
    wanted = work_of(discretisation, freedom, nodal) / total
    cost = np.append(-1.0, np.zeros(len(one_sided)))
    most = minimise(cost, balance, (wanted, wanted), (0.0, np.append(1.0, np.full(len(one_sided), np.inf))))
    return most is not None and bool(most[0] <= _BRINK)


def floats(discretisation: Discretisation, freedom: RigidFreedom, *loads: Floats) -> bool:
    """Whether no nodal load (3n,) of these, be it none, does work in a motion that one-sided supports alone hold."""
    sizes = [
        (np.abs(work_of(discretisation, freedom, nodal)).max(initial=0.0), load_size(discretisation, nodal))
        for nodal in loads
    ]
    return freedom.count > 0 and all(work <= _BRINK * size for work, size in sizes)


def supports_contradict(discretisation: Discretisation) -> bool:
    """Whether no deflection of the plate agrees with all rigid supports: a linear program for the least overlap."""
    contacts, held = discretisation.contacts, discretisation.held
    rigid = contacts.unyielding
    rows = csr_array(discretisation.contact_rows[np.flatnonzero(rigid)])
    distance = contacts.distance[rigid] - rows @ held.values
    size = float(np.abs(distance).max(initial=0.0))
    if size == 0.0:
        return False
    moving = np.unique(rows.indices)
    rows = rows[:, moving[~held.dofs[moving]]]
    rows = vstack([rows, -rows[np.flatnonzero(contacts.two_sided[rigid])]])
    distance = np.append(distance, -distance[contacts.two_sided[rigid]])
    overlap = csr_array(-np.ones((len(distance), 1)))
    cost = np.append(np.zeros(rows.shape[1]), 1.0)
    lower = np.append(np.full(rows.shape[1], -np.inf), 0.0)
    facing: Any = hstack([rows, overlap])
    least = minimise(cost, facing, (-np.inf, distance / size), (lower, np.inf))
    return least is not None and bool(least[-1] > _OVERLAP)


def largest_factor(
    discretisation: Discretisation, freedom: RigidFreedom, bearing: Bearing, rest: Floats, case: Floats
) -> float:
    """Find the largest factor of a nodal load (3n,) with which a bearing's reactions balance it beside the rest.

    Infinite if there is none; NaN if no factor from 0 on has such reactions.
    """
    size = load_size(discretisation, case)
    if not freedom.count or size == 0:
        return np.inf
    strengths = np.abs(np.append(bearing.least, bearing.most))
    strengths = strengths[np.isfinite(strengths) & (strengths > 0.0)]
    # The factor is found in units of the rest or the weakest point, or in larger ones up to the sum of all limits.
    unit = (load_size(discretisation, rest) or float(strengths.min(initial=size))) / size
    while limits := _limits(discretisation, freedom, bearing, rest, unit * case):
        most = limits[-1]
        if most < _MOST or unit * size >= strengths.sum():
            break
        unit *= _MOST
    if not limits:
        return np.nan
    return np.inf if most >= _MOST else 0.0 if most <= _BRINK else unit * most


def _limits(
    discretisation: Discretisation, freedom: RigidFreedom, bearing: Bearing, rest: Floats, case: Floats
) -> list[float]:
    """Least and largest factor of a case beside the rest of the load for which reactions balance both."""
    total = load_size(discretisation, rest) + load_size(discretisation, case)
    one_sided = bearing.moves
    balance = np.column_stack([-work_of(discretisation, freedom, case) / total, one_sided.T])
    wanted = work_of(discretisation, freedom, rest) / total
    bounds = np.append(0.0, bearing.least / total), np.append(_MOST, bearing.most / total)
    found_limits = []
    for sign in (1.0, -1.0):
        cost = np.append(sign, np.zeros(len(one_sided)))
        end = minimise(cost, balance, (wanted, wanted), bounds)
        found_limits += [] if end is None else [float(end[0])]
    return found_limits
