"""The answer to a contact problem and, among several solutions, the one of least norm.

The solutions of a contact problem are a convex set: any displacement of one solution and the reactions of another make
a solution. So displacements and reactions are chosen independently, by rules without any order of supports, points or
pivots: reactions by their least weighted sum of squares and, if the plate can move between its supports, the deflection
by its least ∫ w². docs/theory.md, section 5, has the weights.

Each choice is a small least-squares problem with inequalities, solved as a least-distance problem (Lawson and Hanson
1974, *Solving Least Squares Problems*, chapter 23).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal, Self, TypeAlias

import numpy as np

from signorini import _core
from signorini.base.linear_program import minimise
from signorini.base.remade import Remade
from signorini.discretise import ContactPoints, Discretisation
from signorini.discretise.discretisation import OfWhole
from signorini.discretise.quadrature import area_quadrature
from signorini.discretise.repeated import SAME
from signorini.discretise.rows import Bools, Floats, Pieces, null_space
from signorini.equilibrium.balance import RigidFreedom, describe_motion

_AGAINST_EACH_OTHER = 1e6
"""The solver's answer is no fallback if its largest reaction exceeds that of the least-norm answer by this factor.

Ten of sixteen digits remain in the sum of such reactions.
"""
_ACTIVE = 1e-10
"""Zero tolerance for multipliers of inequalities in the least-norm problems, relative to the largest multiplier."""
_OF_SUMS = 64 * float(np.finfo(float).eps)
"""Rounding of C_i·y, of a constraint C_i·y ≤ r_i at the unconstrained minimum y, relative to Σ_j |C_ij y_j|."""
_NIL = 1e-11
"""Zero tolerance for forces and deflections, relative to the largest force or deflection."""
_HARDLY = 1e-6
"""Lower bound of the reference deflection for the test whether gaps are zero, relative to Σ|λ| a²/D."""
_STILL = 1e-12
"""Rank tolerance for displacements of pushing points in rigid motions, relative to the largest singular value or 1.

If all these points are on one line, the rank must show that the plate can turn about this line.
"""
_MOVED = 1e-9
"""Smallest magnitude at which a component of a unit vector counts as nonzero."""
_DOUBTFUL = 1e-9
"""Zero tolerance for gaps and reactions, wider than `_NIL`, to mark combinations that may have several solutions.

A combination that is marked without need is solved separately, which takes longer but changes no result.
"""
Elsewhere: TypeAlias = Callable[[], Iterable[Floats]]


@dataclass(frozen=True)
class NotUnique:
    """Reactions or deflections that load and supports do not determine; those of least norm are shown.

    Parameters
    ----------
    what : str
        "reactions": rigid supports with linearly dependent rows can share their forces in several ways. "deflection":
        the plate may move as a rigid body between its supports.
    supports : tuple of str
        Names of the supports that share the forces; empty for "deflection".
    motion : str
        How the plate may move, in words; empty for "reactions".
    """

    what: Literal["reactions", "deflection"]
    supports: tuple[str, ...] = ()
    motion: str = ""

    @property
    def otherwise(self) -> str:
        """Text on the other solutions, for messages."""
        if self.what == "reactions":
            return f"reactions of {', '.join(self.supports)} could be shared otherwise"
        return f"the plate could rest elsewhere, {self.motion}"

    def __str__(self) -> str:
        """Describe in one line which reactions or deflections are not unique."""
        shown = "the least are shown" if self.what == "reactions" else "the least deflection is shown"
        return f"{self.otherwise}; {shown}"


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Answer(Remade):
    """Solution for one load: displacements, reactions, gaps and contact states; numbers are NaN unless solved.

    Displacements are ``hi + lo`` (3n,), the sum of two doubles. ``reaction``, ``gap``, ``closed`` and ``piece`` (m,)
    belong to the contact points; ``piece`` is the number of the piece of the point's law. The gap of a yielding point
    is minus its yield travel. The reaction of a two-sided point includes the reactions of redundant points whose rows
    depend on it. ``shared`` (m + r,) are the separate reactions of m contact points and r redundant points.
    ``not_unique`` is empty if the answer is unique. ``somehow`` is the solver's answer if another one was chosen.
    ``solution`` is the core's solution, a start for other loads of the same problem; it is not pickled.
    """

    status: Literal["solved", "no_equilibrium", "unsolved"]
    hi: Floats
    lo: Floats
    reaction: Floats
    gap: Floats
    closed: Bools
    piece: Pieces
    shared: Floats
    pivots: int
    iterations: int
    gradients: int
    factorizations: int
    corrections: int
    not_unique: tuple[NotUnique, ...] = ()
    somehow: Self | None = None
    solution: _core.ContactSolution | None = None

    _made = MappingProxyType({"solution": lambda answer: None})

    def on(self, plate: OfWhole) -> Self:
        """The part of the answer that belongs to one of several plates."""
        mine, points = plate.points[: len(plate.own.contacts)], plate.points
        own = {key: getattr(self, key)[mine] for key in ("reaction", "gap", "closed", "piece")}
        own |= {"hi": self.hi[plate.dofs], "lo": self.lo[plate.dofs], "shared": self.shared[points]}
        return replace(self, **own, not_unique=(), somehow=None, solution=None)

    @property
    def in_turn(self) -> tuple[Self, ...]:
        """The answer itself, followed by the solver's answer `somehow` as a fallback.

        There is no fallback if supports push against each other so strongly in the solver's answer that the sum of
        reactions has lost the digits of the load.
        """
        if self.somehow is None:
            return (self,)
        most = [float(np.abs(one.reaction).max(initial=0.0)) for one in (self, self.somehow)]
        if most[1] > _AGAINST_EACH_OTHER * most[0]:
            return (self,)
        return (self, replace(self.somehow, not_unique=self.not_unique))

    @classmethod
    def of(cls, discretisation: Discretisation, solution: _core.ContactSolution) -> Self:
        """Convert a solution of the core to an answer, without a choice among several solutions."""
        reaction, yields = solution.reaction, discretisation.contacts.yield_on(solution.piece)
        return cls(
            status=solution.status,
            hi=solution.hi,
            lo=solution.lo,
            reaction=reaction,
            gap=np.where(yields, -np.abs(solution.gap), np.where(solution.closed, 0.0, solution.gap)),
            closed=solution.closed,
            piece=solution.piece,
            shared=np.concatenate([reaction, np.zeros(len(discretisation.repeated))]),
            pivots=solution.pivots,
            iterations=solution.iterations,
            gradients=solution.gradients,
            factorizations=solution.factorizations,
            corrections=solution.corrections,
            solution=solution,
        )


def chosen(
    discretisation: Discretisation,
    freedom: RigidFreedom,
    nodal: Floats,
    answer: Answer,
    elsewhere: Elsewhere | None = None,
) -> Answer:
    """Return the least-norm answer to a nodal load (3n,) among all solutions, with a `NotUnique` for each choice.

    ``elsewhere`` is called if the plate can move. On a load path it returns the reactions (m,) just before and just
    after this load: points that push at either of these hold the plate under this load too, so that the deflection does
    not jump along the path.
    """
    if answer.status != "solved":
        return answer
    least = _with_least_reactions(discretisation, nodal, answer)
    if freedom.count:
        least = _with_least_deflection(discretisation, freedom, nodal, least, elsewhere)
    return least if least is answer else replace(least, somehow=answer)


def doubtful(discretisation: Discretisation, freedom: RigidFreedom, reaction: Floats, gap: Floats) -> Bools:
    """Mask (k,) of the combinations that may have several solutions; reactions and gaps are (k, m)."""
    if len(discretisation.repeated):
        return np.ones(len(reaction), np.bool_)
    several = np.zeros(len(reaction), np.bool_)
    if discretisation.shared:
        # If every point is closed, gaps are rounding errors, and the reference is the deflection that reactions cause.
        travel = np.abs(gap).max(axis=1, initial=0.0) + np.abs(discretisation.contacts.distance).max()
        touching = np.abs(gap) <= _DOUBTFUL * (travel + _bending(discretisation, reaction))[:, None]
        several |= np.any([touching[:, one.points].sum(axis=1) > 1 for one in discretisation.shared], axis=0)
    if freedom.count:
        nothing = _DOUBTFUL * np.abs(reaction).max(axis=1, initial=0.0)[:, None]
        pushing = _holding(discretisation.contacts, reaction, nothing)
        squares = np.einsum("mi,mj->mij", freedom.moves, freedom.moves).reshape(len(freedom.moves), -1)
        held = (pushing.astype(np.float64) @ squares).reshape(-1, freedom.count, freedom.count)
        values = np.linalg.eigvalsh(held)
        # Eigenvalues are sums of squared displacements; they need a higher power of the tolerance than displacements.
        several |= values[:, 0] <= _DOUBTFUL**1.5 * values[:, -1]
    return several


def _with_least_reactions(discretisation: Discretisation, nodal: Floats, answer: Answer) -> Answer:
    """Replace reactions of points with linearly dependent rows by those with the least weighted sum of squares."""
    points, count = discretisation.points, len(answer.reaction)
    together: list[Iterable[int]] = list(discretisation.held_together)
    reaction, closed, piece = answer.shared.copy(), answer.closed.copy(), answer.piece.copy()
    gap = np.append(answer.gap, np.zeros(len(discretisation.repeated)))
    largest = max(float(np.abs(answer.hi[::3]).max()), _HARDLY * float(_bending(discretisation, answer.reaction)))
    nothing = _NIL * _force(discretisation, nodal, answer)
    low, high = points.limits_at_rest
    touching = (np.abs(gap) <= _NIL * np.maximum(largest, np.abs(points.distance))) & (low - nothing <= reaction)
    touching = points.two_sided | (touching & (reaction <= high + nothing))
    nodes, holders = np.unique(discretisation.held.nodes, return_counts=True)
    for shared in discretisation.shared:
        meet = touching[shared.points]
        mine = shared.points[meet]
        ways = shared.ways @ null_space(shared.ways[~meet], SAME) if not meet.all() else shared.ways
        ways = ways[meet]
        if not ways.shape[1]:
            continue
        ways, _ = np.linalg.qr(ways)
        root = np.sqrt(discretisation.share_weights[mine])
        size = max(float(np.abs(reaction[mine]).max()), nothing) or 1.0
        rows, offset = [ways / root[:, None]], [reaction[mine] / root / size]
        if (at_holds := discretisation.point_rows[mine][:, 3 * nodes]).nnz:
            imbalance = discretisation.plate.residual(discretisation.springs.arrays, nodal, answer.hi, answer.lo)
            rows.append(-(at_holds.T @ ways) / np.sqrt(holders)[:, None])
            offset.append((imbalance - discretisation.point_rows.T @ reaction)[3 * nodes] / np.sqrt(holders) / size)
        sides, ends = np.concatenate([-ways, ways]), np.concatenate([-low[mine], high[mine]])
        at_ends = np.isfinite(ends)
        room = np.maximum(ends - np.concatenate([-reaction[mine], reaction[mine]]), 0.0)[at_ends] / size
        change = ways @ least(np.vstack(rows), np.concatenate(offset), sides[at_ends], room)
        shares = reaction[mine] + size * change
        shares = np.where(shares <= low[mine] + nothing, low[mine], shares)
        shares = np.where(shares >= high[mine] - nothing, high[mine], shares)
        others = ways @ span_of_cone(sides[np.concatenate([shares == low[mine], shares == high[mine]])])
        which = mine[(np.abs(others) > _MOVED).any(axis=1)]
        reaction[mine] = shares
        own = mine[mine < count]
        closed[own] = True
        piece[own] = discretisation.contacts.pieces_at(reaction[:count], nothing, flat=False)[own]
        if len(which):
            together.append(set(points.support[which].tolist()))
    folded = reaction[:count] + discretisation.repeated.follows.T @ reaction[count:]
    names = [support.name for support in discretisation.model.support]
    several = tuple(NotUnique("reactions", tuple(names[i] for i in sorted(who))) for who in _merged(together))
    if not several:
        return answer
    gap = np.where(closed, 0.0, answer.gap)
    several = (*answer.not_unique, *several)
    return replace(answer, reaction=folded, shared=reaction, closed=closed, piece=piece, gap=gap, not_unique=several)


def _holding(contacts: ContactPoints, reaction: Floats, nothing: Floats | float) -> Bools:
    """Mask (..., m) of one-sided points that neither open nor yield, so that rigid motions change their forces."""
    return np.asarray(~contacts.two_sided & ~contacts.flat_on(contacts.pieces_at(reaction, nothing)))


def _bending(discretisation: Discretisation, reaction: Floats) -> Floats:
    """Order of magnitude Σ|λ| a²/D (...,) of the deflections that reactions λ (..., m) cause."""
    rigidity = discretisation.model.young * discretisation.thickness.max() ** 3 / 12 / discretisation.mesh.size**2
    return np.asarray(np.abs(reaction).sum(axis=-1) / rigidity)


def _merged(sets: Sequence[Iterable[int]]) -> list[set[int]]:
    """Unite sets with common elements; return the unions, sorted by their least element."""
    out: list[set[int]] = []
    for one in map(set, sets):
        common = [other for other in out if other & one]
        out = [other for other in out if not other & one] + [one.union(*common)]
    return sorted(out, key=min)


def _force(discretisation: Discretisation, nodal: Floats, answer: Answer) -> float:
    """Reference force: the largest nodal load or reaction; couples are divided by the plate's size.

    Without load it is also at least the force that would bend the plate by its largest deflection.
    """
    size = discretisation.mesh.size
    forces = np.abs(nodal.reshape(-1, 3)).max(axis=0) / [1.0, size, size]
    bending = 0.0
    if not nodal.any():
        rigidity = discretisation.model.young * discretisation.thickness.max() ** 3 / 12
        bending = rigidity * float(np.abs(answer.hi[::3]).max()) / size**2
    return max(float(forces.max()), bending, float(np.abs(answer.reaction).max(initial=0.0))) or 1.0


def _with_least_deflection(
    discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats, answer: Answer, elsewhere: Elsewhere | None
) -> Answer:
    contacts, nothing = discretisation.contacts, _NIL * _force(discretisation, nodal, answer)
    pushing = _holding(contacts, answer.reaction, nothing)
    # If the load has no resultant, reactions are rounding of internal forces, and this rounding is the tolerance.
    rounding = np.finfo(float).eps * discretisation.plate.internal_magnitude(
        discretisation.held.dofs, answer.hi, answer.lo
    )
    if (np.abs(answer.reaction[pushing]) <= rounding).all():
        nothing = max(nothing, rounding)
        pushing = _holding(contacts, answer.reaction, nothing)
    free = null_space(freedom.moves[pushing], _STILL)
    if free.shape[1] and elsewhere is not None:
        for reaction in elsewhere():
            # Where a load path starts at zero load, all reactions are rounding errors, so that no point pushes.
            pushing |= _holding(contacts, reaction, max(_NIL * float(np.abs(reaction).max()), rounding))
        free = null_space(freedom.moves[pushing], _STILL)
    if not free.shape[1]:
        return answer
    idle = ~contacts.two_sided & ~pushing
    # A reaction within rounding of 0 is set to 0; a reaction within rounding of its limit is set to the limit.
    flat = contacts.forces_on(contacts.pieces_at(answer.reaction, nothing))
    settled = np.where(idle, flat, answer.reaction)
    over = area_quadrature(discretisation.mesh)
    values = discretisation.mesh.shape_functions(over.elements, over.xi)
    root = np.sqrt(over.weights)
    motions = freedom.motions @ free
    moves = root[:, None] * (discretisation.in_motions(over.positions, over.elements) @ motions)
    both_ways = np.concatenate([-freedom.moves[idle], freedom.moves[idle]]) @ free

    def bounds(hi: Floats, lo: Floats) -> tuple[Floats, Floats, Floats]:
        """Travels (m,) of all points; C and r: in rigid motions y with C y ≤ r reactions of ``idle`` points stay."""
        travel = -discretisation.plate.openings(*contacts.rows.arrays, contacts.distance, hi, lo)
        length = np.maximum(float(np.abs(hi[::3]).max()), np.abs(contacts.distance))
        rooms = [np.where(np.abs(one) > _NIL * length, one, 0.0)[idle] for one in contacts.room(travel, settled)]
        room = np.concatenate(rooms)
        return travel, both_ways[np.isfinite(room)], room[np.isfinite(room)]

    hi, lo = answer.hi, answer.lo
    travel, sides, room = bounds(hi, lo)
    ways = free @ span_of_cone(sides[room <= 0.0])
    if not ways.shape[1]:
        return answer
    # The second pass corrects rounding: the deflections before the first pass may be far larger than after it.
    for _ in range(2):
        deflection = (values * (hi + lo)[::3][discretisation.mesh.elements[over.elements]]).sum(axis=1)
        unit = float(np.abs(deflection).max()) or 1.0
        part = least(moves, root * deflection / unit, sides, room / unit)
        hi, lo = discretisation.moved(hi, lo, unit * (motions @ part) / discretisation.sizes)
        # After a large motion of a free plate, rounding has also moved the points that push; they are moved back.
        travel -= -discretisation.plate.openings(*contacts.rows.arrays, contacts.distance, hi, lo)
        back = freedom.motions @ np.linalg.lstsq(freedom.moves[pushing], travel[pushing], rcond=None)[0]
        hi, lo = discretisation.moved(hi, lo, back / discretisation.sizes)
        travel, sides, room = bounds(hi, lo)
    back, on = contacts.room(travel, settled)
    length = np.maximum(float(np.abs(hi[::3]).max()), np.abs(contacts.distance))
    nil = _NIL * length
    touching = ~idle | (np.minimum(back, on) <= nil)
    closed = touching | (settled != 0.0)
    piece = np.where(touching, contacts.pieces_at(settled, 0.0, flat=False), contacts.pieces_at(settled, 0.0))
    shared = answer.shared.copy()
    shared[: len(settled)][idle] = settled[idle]
    several = NotUnique("deflection", motion=_in_words(freedom.motions @ ways, discretisation))
    return replace(
        answer,
        hi=hi,
        lo=lo,
        reaction=settled,
        shared=shared,
        gap=np.where(touching, 0.0, np.where(settled == 0.0, on, -np.minimum(back, on))),
        closed=closed,
        piece=piece,
        not_unique=(*answer.not_unique, several),
    )


def _in_words(ways: Floats, discretisation: Discretisation) -> str:
    match ways.shape[1]:
        case 1:
            return describe_motion(ways[:, 0] / np.abs(ways[:, 0]).max(), discretisation)
        case 2:
            return "by any combination of two rigid motions"
        case _:
            return "by any small rigid motion"


def span_of_cone(sides: Floats) -> Floats:
    """Basis (d, e) of the span of the cone C y ≤ 0, where the rows of C (c, d) have similar lengths.

    Each step finds a direction in the cone with C_i y < 0 for some rows i, and drops these rows. The direction vanishes
    on the remaining rows, so that the next direction is independent of it. There are at most d steps.
    """
    stay = sides
    while len(stay):
        leaves = stay @ _steepest_in_cone(sides, stay.sum(axis=0)) < -_MOVED
        if not leaves.any():
            break
        stay = stay[~leaves]
    return null_space(stay, _ACTIVE)


def _steepest_in_cone(sides: Floats, cost: Floats) -> Floats:
    """The y (d,) with C y ≤ 0 and |y_i| ≤ 1 that minimises c·y, by cutting planes (Kelley 1960).

    About d rows of C are active. The most violated row is added to the rows in use until no row is violated.
    """
    kept: list[int] = []
    while True:
        y = minimise(cost, sides[kept], (-np.inf, 0.0), (-1.0, 1.0), tolerance=_ACTIVE)
        assert y is not None, "y = 0 is in the cone"
        beyond = sides @ y
        worst = int(beyond.argmax())
        if beyond[worst] <= _STILL or worst in kept:
            return y
        kept.append(worst)


def least(matrix: Floats, offset: Floats, sides: Floats, room: Floats) -> Floats:
    """For arguments A, b, C, r ≥ 0: the y with C y ≤ r that minimises ‖A y + b‖; 0 if the solver fails."""
    from scipy.optimize import nnls

    q, r = np.linalg.qr(matrix)
    free = -np.linalg.solve(r, q.T @ offset)
    if ((sides @ free) <= room).all():
        return np.asarray(free)
    # With A = QR, y₀ = −R⁻¹Qᵀb and x = R (y − y₀) the problem is: minimise ‖x‖ subject to C R⁻¹ x ≤ r − C y₀.
    rows = np.linalg.solve(r.T, sides.T).T  # C R⁻¹
    size = np.linalg.norm(rows, axis=1)
    kept = np.flatnonzero(size > 0)
    beyond = (sides @ free - room)[kept] / size[kept]
    # Divide by the largest violation: divided by the slack of a far constraint, violations could look like 0.
    unit = float(beyond.max())
    facing = np.vstack([-(rows[kept] / size[kept, None]).T, beyond / unit])
    try:
        multipliers, _ = nnls(facing, np.append(np.zeros(len(r)), 1.0))
    except RuntimeError:
        return np.zeros(len(r))
    # Active constraints are solved again as equations, to full accuracy.
    # The multiplier of an active constraint may be rounded to 0; such a constraint is added when it is violated.
    on = multipliers[: len(kept)] > _ACTIVE * multipliers.max(initial=0.0)
    for _ in kept:
        rests = kept[on]
        y = free - np.linalg.solve(r, np.linalg.pinv(rows[rests]) @ (sides[rests] @ free - room[rests]))
        # y is computed from the unconstrained minimum, so it has at least the rounding error of this minimum.
        rounding = _ACTIVE * (np.abs(sides) @ np.abs(y) + np.abs(room)) + _OF_SUMS * (np.abs(sides) @ np.abs(free))
        over = (sides @ y - room - rounding)[kept]
        if not (over > 0.0).any():
            return np.asarray(y)
        on[int(over.argmax())] = True
    return np.zeros(len(r))
