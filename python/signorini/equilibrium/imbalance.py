"""Whether reactions exist that balance a load, and the factor of a load case at which they no longer do.

The plate is a rigid body here, and no matrix is factored. Reactions of one-sided supports have a sign. By Farkas' lemma
they balance the load exactly if the load does no positive work in any rigid motion that all supports allow. A linear
program in at most three unknowns per plate finds the motion with the most work. Supports extend to their outlines,
independently of the mesh. A plate tips about the line of the allowed motion with the most work per rotation. This work
is the missing moment: by duality, the least couple with which reactions would balance the load.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from scipy.sparse import csr_array, hstack, vstack

from signorini.base.linear_program import minimise, minimise_with_prices
from signorini.discretise import Discretisation
from signorini.discretise.rows import RANK, Floats, Ints
from signorini.equilibrium.balance import Bearing, RigidFreedom, allowed_motions, load_size, work_of
from signorini.errors import InputError, length, point
from signorini.model import Combination

_UP_AND_DOWN = 1e-5
"""Weight of the deflection relative to rotations in the norm of motions. It is small, so that it only decides between
motions with equal rotations.
"""
_ROUNDING = 1e-9
"""Reactions and motions up to this value count as zero, relative to the largest reaction or motion."""
WORK = 1e-10
"""Largest work that counts as zero, relative to the size of the load times the largest component of the motion."""
_COARSE = 1e-5
"""Largest extra load, relative to the load, that is found by extreme rays: a linear program has the tolerance 1e-7."""
_CLOSED = 1e-7
"""Largest opening of a point that counts as closed while the plate tips, relative to the largest opening."""
_LIFTS = 1e-9
"""Largest lift of a node by a unit rotation that counts as zero, relative to the plate's size."""
_MOST_HINGES = 4
"""Largest number of hinges of one support that a message lists."""
_MOST = 1e6
"""Largest multiple of a load case's factor that counts as a limit of equilibrium. Above it a case has no limit."""
_ALIKE = 1e-9
"""Limits of equilibrium of two load cases count as equal up to this relative difference."""
_OVERLAP = 1e-7
"""Smallest overlap at which rigid supports count as contradictory, relative to the largest gap or settlement."""
_BRINK = 1e-9
"""Equilibrium is marginal if reactions that balance the load cannot all exceed this value, relative to the load."""
CONTRADICTION = (
    "The rigid supports contradict each other: no deflection of the plate agrees with all their gaps and settlements. "
    "Reactions that balance the load exist. Correct a gap or a settlement, or give a stiffness."
)
"""Message if `supports_contradict` is true."""


@dataclass(frozen=True, eq=False)
class Axis:
    """A line about which the plate tips: ``normal`` (2,) · x + ``offset`` = 0 with a unit normal."""

    normal: Floats
    offset: float

    def ends(self, middle: Floats, length: float) -> Floats:
        """End points (2, 2) of a segment of this axis of given length, centred at the point nearest to ``middle``."""
        foot = middle - (self.normal @ middle + self.offset) * self.normal
        along = np.array([-self.normal[1], self.normal[0]])
        return np.asarray(foot + np.outer([-0.5, 0.5], along) * length)


@dataclass(frozen=True, eq=False)
class Holding:
    """Least extra force that would just hold the plate, its direction, and the position (2,) of the loaded node."""

    force: float
    direction: Literal["up", "down"]
    node: Floats


@dataclass(frozen=True, eq=False)
class Imbalance:
    """The motion by which a load moves the plate off all its supports, or tips it about a line.

    ``resultant`` is the sum of the load's forces, positive down. The plate moves off its supports in ``direction``, or
    tips about ``axis``; ``moment`` is the missing moment about the axis. ``hinges`` (k, 2) are points of the supports'
    outlines on the axis, ``supports`` (k,) the numbers of their supports. ``holding`` is None if no force at one point
    holds the plate. ``limit`` is a load case and the multiple of its factor at which the plate would just stand.

    If ``supports`` yield at their limits, ``carried`` is the factor of the load that can be balanced, ``most`` the
    largest force, or moment about the axis, of the supports, and ``moment`` the missing force or moment. For several
    plates ``motions`` (p, 3), w and slopes about the middle, replace direction and axis.
    """

    resultant: float
    direction: Literal["up", "down"] | None
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
    """Find the motion because of which no reactions balance a nodal load (3n,); None if reactions exist.

    Raise `InputError` if reactions exist on the supports' outlines, but not at the contact points of the mesh.
    """
    if freedom.outline.limited:
        return _beyond_limits(discretisation, freedom, nodal)
    if not discretisation.plates and (direction := _lifting(discretisation, freedom, nodal)):
        down, mx, my = (float(part) for part in discretisation.rigid_motions.T @ nodal)
        acting = discretisation.middle + np.array([mx, my]) / down
        holding = _holding(discretisation, freedom, nodal, acting, "down" if direction == "up" else "up")
        return Imbalance(down, direction, None, 0.0, np.zeros((0, 2)), np.zeros(0, np.int64), holding)
    best = _unresisted(discretisation, freedom, freedom.outline, nodal)
    if best is None:
        _require_reach(discretisation, freedom, nodal)
        return None
    # The plate tips by the motion with the most work per rotation.
    work = work_of(discretisation, freedom, nodal) / load_size(discretisation, nodal)
    most = steepest(freedom.motions, freedom.outline.moves, work)
    if discretisation.plates:
        return _of_plates(discretisation, freedom, nodal, best if most is None else most)
    return _tipping(discretisation, freedom, nodal, best if most is None else most)


def _beyond_limits(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats) -> Imbalance | None:
    """Collapse mechanism in which supports with limits lift off or yield; None if they can balance the whole load.

    A linear program over the reactions finds the largest factor of the load that can be balanced. Its multipliers are
    the mechanism (static and kinematic theorems, Drucker, Prager & Greenberg 1952). In this motion the load does more
    work than the supports dissipate.
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
        yields = np.where(bearing.moves @ motion > 0.0, bearing.most, bearing.least)
        yields = np.isfinite(yields) & (yields != 0.0) & (np.abs(bearing.moves @ motion) > _CLOSED)
        yielding = np.unique(bearing.support[yields])
        return replace(
            _of_plates(discretisation, freedom, nodal, motion), supports=yielding, carried=max(0.0, float(best[0][0]))
        )
    w, *slopes = (freedom.motions @ motion) / np.array([1.0, discretisation.mesh.size, discretisation.mesh.size])
    turning, pressed = float(np.hypot(*slopes)), bearing.moves @ motion
    tips = turning * discretisation.mesh.size > _ROUNDING * abs(w)
    strength = np.where(pressed > 0.0, bearing.most, bearing.least)
    yields = np.isfinite(strength) & (strength != 0.0) & (np.abs(pressed) > _CLOSED * np.abs(pressed).max())
    unit = turning if tips else abs(float(w))
    most = float(strength[yields] @ pressed[yields]) / unit
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
        np.unique(bearing.support[yields]),
        None,
        carried=max(0.0, float(best[0][0])),
        most=most,
    )


def _of_plates(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats, motion: Floats) -> Imbalance:
    """Imbalance of several plates that move by ``motion`` (d,), which every support allows."""
    motions = (freedom.motions @ motion).reshape(-1, 3) / [1.0, discretisation.mesh.size, discretisation.mesh.size]
    down, none = float((discretisation.rigid_motions.T @ nodal)[::3].sum()), np.zeros(0, np.int64)
    return Imbalance(down, None, None, 0.0, np.zeros((0, 2)), none, None, motions=motions)


def _tipping(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats, motion: Floats) -> Imbalance:
    """Imbalance of a plate that tips by ``motion`` (d,), which every support allows."""
    opening = np.abs(freedom.outline.moves @ motion)
    w, *slopes = (freedom.motions @ motion) / np.array([1.0, discretisation.mesh.size, discretisation.mesh.size])
    turning = float(np.hypot(*slopes))
    normal = np.array(slopes) / turning
    axis = Axis(normal, float(w / turning - normal @ discretisation.middle))
    work = discretisation.rigid_motions.T @ nodal
    closed = opening <= _CLOSED * opening.max(initial=0.0)
    # An added weight has the largest effect at the node that the motion lifts most.
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
    """The motion (d,) with |motion| ≤ 1 in which the load does most work, and that no one-sided point resists.

    ``bearing`` has the positions of the one-sided points. None if the load does no work in any such motion.
    """
    total = load_size(discretisation, nodal)
    if not freedom.count or total == 0:
        return None
    work, one_sided = work_of(discretisation, freedom, nodal), bearing.moves
    # The default tolerance of a linear program, 1e-7 of the load, is larger than the tolerance of the certificate.
    best = minimise(-work / total, one_sided, (-np.inf, 0.0), (-1.0, 1.0), tolerance=WORK)
    return None if best is None or work @ best <= WORK * total else best


def _require_reach(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats) -> None:
    """Refuse a load that reactions on the supports' outlines can balance, but reactions at contact points cannot."""
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
    """Direction in which the plate moves off all supports without rotation; None if no such motion does work."""
    one_sided, least = freedom.outline.moves, WORK * load_size(discretisation, nodal)
    work = work_of(discretisation, freedom, nodal)
    directions: tuple[tuple[Literal["up", "down"], float], ...] = (("up", -1.0), ("down", 1.0))
    for direction, w in directions:
        motion = np.array([w, 0.0, 0.0])
        part = motion @ freedom.motions
        free = np.abs(freedom.motions @ part - motion).max() <= RANK
        if free and (one_sided @ part).max(initial=0.0) <= RANK and work @ part > least:
            return direction
    return None


def _holding(
    discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats, best: Floats, direction: Literal["up", "down"]
) -> Holding | None:
    """Least extra load that would hold the plate, at the node nearest to ``best`` or to the middle of the supports."""
    for position in (best, freedom.outline.positions.mean(axis=0)):
        node = discretisation.mesh.points[((discretisation.mesh.points - position) ** 2).sum(axis=1).argmin()]
        least = _least_holding(discretisation, freedom, nodal, node, direction)
        if least is not None:
            return Holding(least, direction, node)
    return None


def _least_holding(
    discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats, position: Floats, direction: str
) -> float | None:
    """Least extra load at a point with which reactions balance the load; found by a linear program over reactions."""
    size = discretisation.mesh.size
    # Equations of equilibrium in the free motions, with forces relative to the load and lengths to the plate's size.
    scale = np.array([1.0, size, size])
    resultant = work_of(discretisation, freedom, nodal)
    total = float(np.abs(resultant).max())
    sign = 1.0 if direction == "down" else -1.0
    extra = sign * (np.array([1.0, *(position - discretisation.middle)]) / scale) @ freedom.motions
    one_sided = freedom.outline.moves
    cost = np.zeros(1 + len(one_sided))
    cost[0] = 1.0
    balance = np.column_stack([-extra, one_sided.T])
    least = minimise(cost, balance, (resultant / total, resultant / total), (0.0, np.inf))
    if least is None or least[0] > _COARSE:
        return None if least is None else total * float(least[0])
    # An extra load this small is lost in the linear program's tolerance: compute it from extreme rigid motions.
    rays = allowed_motions(freedom.outline)
    if rays is None:
        return None
    needed, helped = rays @ resultant / total, -(rays @ extra)
    helping = (helped > RANK) & (needed > 0.0)
    return total * float((needed[helping] / helped[helping]).max()) if helping.any() else None


def explain(discretisation: Discretisation, why: Imbalance | None) -> str:
    """Text on the missing force or moment, the motion, and loads that would restore equilibrium; "" if why is None."""
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
        resultant = f"{abs(why.resultant):.6g}{unit} {why.direction}"
        text += f": the load's resultant is {resultant}, and no support resists that way."
    if why.holding is not None:
        position = point(why.holding.node, discretisation.mesh.size)
        text += f" An extra {why.holding.force:.6g}{unit} {why.holding.direction} at {position} would just hold it."
    if why.limit is not None:
        case, factor = why.limit
        text += f' With the case "{case}" at {factor:.4g} times its factor it would just stand.'
    return text


def _at_limits(discretisation: Discretisation, why: Imbalance) -> str:
    """Text for the supports that yield, such as " at the limits of soil and anchors"; empty if no support yields."""
    names = [discretisation.model.support[index].name for index in why.supports.tolist()]
    return f" at the limit{'s' * (len(names) > 1)} of {' and '.join(names)}" if names else ""


def mechanism(discretisation: Discretisation, why: Imbalance) -> str:
    """Text for the motion of the plate, such as "tips about the line x = 2"."""
    if why.motions is not None:
        each = _motions(discretisation, why.motions)
        return f"{' and '.join(each)}{_at_limits(discretisation, why)}"
    if why.carried is not None and len(why.supports):
        return f"{_about(discretisation, why.axis) or f'moves {why.direction}'}{_at_limits(discretisation, why)}"
    if why.axis is None:
        return f"{'lifts off' if why.direction == 'up' else 'drops away from'} its supports"
    size, owners = discretisation.mesh.size, dict[str, dict[str, None]]()
    for hinge, support in zip(why.hinges, why.supports, strict=True):
        owners.setdefault(point(hinge, size), {})[discretisation.model.support[support].name] = None
    spots_by_names: dict[str, list[str]] = {}
    for spot, whose in owners.items():
        spots_by_names.setdefault(" and ".join(whose), []).append(spot)
    through = ", ".join(
        f"{', '.join(spots[:_MOST_HINGES])}{', ...' if len(spots) > _MOST_HINGES else ''} of {names}"
        for names, spots in spots_by_names.items()
    )
    return _about(discretisation, why.axis) + (f" through {through}" if through else "")


def _motions(discretisation: Discretisation, motions: Floats) -> list[str]:
    """Text for the motion of each plate, without plates that do not move."""
    size, result = discretisation.mesh.size, []
    for plate, (w, *slopes) in zip(discretisation.plates, motions.tolist(), strict=True):
        turning, most = float(np.hypot(*slopes)), float(np.abs(motions * [1.0, size, size]).max())
        if turning * size > _ROUNDING * most:
            normal = np.array(slopes) / turning
            offset = w / turning - float(normal @ discretisation.middle)
            result.append(f'"{plate.name}" {_about(discretisation, Axis(normal, offset))}')
        elif abs(w) > _ROUNDING * most:
            result.append(f'"{plate.name}" {"goes down" if w > 0 else "lifts off"}')
    return result


def _about(discretisation: Discretisation, axis: Axis | None) -> str:
    if axis is None:
        return ""
    return f"tips about the line {line_in_words(axis.normal, axis.offset, discretisation.mesh.size)}"


def line_in_words(normal: Floats, offset: float, size: float) -> str:
    """Text of the line's equation normal · x + offset = 0, with 1 as largest coefficient; ``size`` is the plate's size.

    Examples
    --------
    >>> import numpy as np
    >>> line_in_words(np.array([-0.6, -0.8]), 1.6, 4.0)
    '0.75 x + y = 2'
    >>> line_in_words(np.array([1.0, 1e-17]), 1e-16, 4.0)
    'x = 0'
    >>> line_in_words(np.array([0.70710677, 0.70710679]), -7 * 2**0.5, 7.0)
    'x + y = 14'
    """
    leading = int(abs(normal[1]) > abs(normal[0]) * (1 + 1e-9))
    a, b = (round(float(part / normal[leading]), 6) for part in normal)
    equals = length(-offset / normal[leading], size)
    if a == 0.0 or b == 0.0:
        return f"{'xy'[leading]} = {equals}"
    first = "x" if a == 1.0 else f"{a:g} x"
    second = "y" if abs(b) == 1.0 else f"{abs(b):g} y"
    return f"{first} {'+' if b > 0 else '-'} {second} = {equals}"


def steepest(motions: Floats, moves: Floats, work: Floats) -> Floats | None:
    """Find the allowed motion (d,), of unit maximum norm, with the most work per rotation.

    The motion minimises ½ rotation² − work·motion subject to moves·motion ≤ 0. The dual problem is a nonnegative
    least-squares problem in the reactions. Supports with a positive reaction remain closed, which determines the
    motion. ``motions`` (3p, d) and ``moves`` (k, d) are those of `RigidFreedom`, ``work`` (d,) is the work of the load.
    None if the motion found is not allowed or does no work, because of rounding.
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
    closed = moves[reactions > _ROUNDING * reactions.max(initial=0.0)]
    free = null_space(closed, rcond=_ROUNDING) if len(closed) else np.eye(len(work))
    motion = free @ np.linalg.solve(free.T @ metric @ free, free.T @ work)
    motion = motion / max(np.abs(motion).max(initial=0.0), np.finfo(float).tiny)
    return motion if (moves @ motion).max(initial=0.0) <= _ROUNDING and work @ motion > 0 else None


def imbalance_of(discretisation: Discretisation, freedom: RigidFreedom, combination: Combination) -> Imbalance | None:
    """`Imbalance` of a combination, including its ``limit``; None if reactions balance the load."""
    why = imbalance(discretisation, freedom, discretisation.load(combination).weighing)
    return None if why is None else replace(why, limit=nearest_limit(discretisation, freedom, combination))


def nearest_limit(
    discretisation: Discretisation, freedom: RigidFreedom, combination: Combination
) -> tuple[str, float] | None:
    """Find the case, and the multiple of its factor, at which the combination reaches the limit of equilibrium.

    All other cases are unchanged. The multiple nearest to 1 in ratio is taken; in a tie, that of the last case of the
    combination. Reactions without limits form a cone: if a single load can be balanced, so can any multiple of it. None
    if no case alone has a limit, or if none restores the equilibrium of an unbalanced combination.
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
    # Rounding must not choose between cases with reciprocal limits, which are equally near to 1.
    return min(reversed(limits), key=lambda pair: round(abs(np.log(pair[1])) / _ALIKE), default=None)


def on_the_brink(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats) -> bool:
    """Whether equilibrium is marginal: reactions balance the load, but not after an arbitrarily small shift of it."""
    total = load_size(discretisation, nodal)
    if not freedom.count or total == 0:
        return False
    if freedom.outline.limited:
        return largest_factor(discretisation, freedom, freedom.outline, 0.0 * nodal, nodal) <= 1.0 + _BRINK
    one_sided = freedom.outline.moves
    # The first unknown is the least reaction r of all points; the other unknowns are the reactions minus r.
    balance = np.column_stack([one_sided.sum(axis=0), one_sided.T])
    work = work_of(discretisation, freedom, nodal) / total
    cost = np.append(-1.0, np.zeros(len(one_sided)))
    most = minimise(cost, balance, (work, work), (0.0, np.append(1.0, np.full(len(one_sided), np.inf))))
    return most is not None and bool(most[0] <= _BRINK)


def floats(discretisation: Discretisation, freedom: RigidFreedom, *loads: Floats) -> bool:
    """Whether some rigid motions are held by one-sided supports alone, and no load (3n,) does work in these motions."""
    sizes = [
        (np.abs(work_of(discretisation, freedom, nodal)).max(initial=0.0), load_size(discretisation, nodal))
        for nodal in loads
    ]
    return freedom.count > 0 and all(work <= _BRINK * size for work, size in sizes)


def supports_contradict(discretisation: Discretisation) -> bool:
    """Whether no deflection agrees with all rigid supports. A linear program finds the least overlap of supports."""
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
    """Find the largest t such that one-sided supports can balance ``rest`` + t ``case``, nodal loads (3n,).

    The positions of the supports are in ``bearing``. The value is infinite if there is no largest t, and NaN if no t ≥
    0 can be balanced.
    """
    size = load_size(discretisation, case)
    if not freedom.count or size == 0:
        return np.inf
    strengths = np.abs(np.append(bearing.least, bearing.most))
    strengths = strengths[np.isfinite(strengths) & (strengths > 0.0)]
    # The linear program has the unknown t/unit and finds limits up to `_MOST` units.
    # The first unit makes the loads ``rest`` and unit·``case`` equal in size.
    # Without ``rest``, the first unit makes unit·``case`` equal in size to the least force limit of a support position.
    # The unit grows while t exceeds `_MOST` units, until unit·``case`` reaches the sum of all force limits.
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
    """Least and largest t ≥ 0 such that reactions balance ``rest`` + t ``case``; an empty list without such a t."""
    total = load_size(discretisation, rest) + load_size(discretisation, case)
    one_sided = bearing.moves
    balance = np.column_stack([-work_of(discretisation, freedom, case) / total, one_sided.T])
    work = work_of(discretisation, freedom, rest) / total
    bounds = np.append(0.0, bearing.least / total), np.append(_MOST, bearing.most / total)
    limits = []
    for sign in (1.0, -1.0):
        cost = np.append(sign, np.zeros(len(one_sided)))
        end = minimise(cost, balance, (work, work), bounds)
        limits += [] if end is None else [float(end[0])]
    return limits
