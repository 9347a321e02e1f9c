"""The certificate: how far an answer is from a solution, computed by code that did not solve it.

It takes the displacements, reactions and the statement of the problem, and recomputes gaps, nodal forces and the
three global balances from them. It reads no factor, no condensed matrix, and no status.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from signorini.contact.selection import Answer
from signorini.discretise import CaseLoad, ContactPoints, Discretisation
from signorini.discretise.loads import CANCELLED
from signorini.discretise.rows import Bools, Floats, Ints

TOLERANCE = 1e-8
CERTIFIABLE = 1e-4
"""Part of the forces that act which arithmetic may leave unknown. What is out of balance all over a plate adds up as
in a random walk and loads add up plainly, so that an answer is wrong by hardly more; a larger part would excuse all."""
_ROUNDINGS = 4.0
"""Units of rounding, of the internal and contact forces that cancel at a node, below which no imbalance can be seen."""
_NO_LEVER = 1e-12
"""Part of what supports have in one resultant below which they have none in another: couples have no force but for the
rounding of their rows, some units of it times the shape functions' slopes."""
_NIL = 1e-6
"""Deflections below this part of F a²/D are rounding of the elimination."""
_UNSEEN = _ROUNDINGS * float(np.finfo(float).eps) / TOLERANCE
"""Part of a size which, as a scale, turns the tolerance into that size's rounding."""
_CANCELLED = CANCELLED / TOLERANCE
"""As `_UNSEEN`, of loads that are added: as much of them counts as nothing where they cancel."""
FIGURES = ("penetration", "tension", "complementarity", "equilibrium", "balance")
LIMITED = ("tension", "equilibrium", "balance")
"""Figures that the rounding of the plate's own forces may limit."""


@dataclass(frozen=True)
class Certificate:
    """Errors of an answer, each relative to a size stated here; ``passed`` means all are within tolerance.

    Parameters
    ----------
    penetration : float
        Deepest penetration, or largest violation of a held deflection, over the largest deflection, or, where supports
        leave none, a millionth of the deflection F a²/D by which the load F scales on a plate of size a, or 10⁻⁷ of the
        slopes that are given times a. Violations of held slopes count over the largest slope, or this deflection by a.
    tension : float
        Largest reaction of the wrong sign over the largest reaction or nodal load.
    complementarity : float
        Largest lesser one of a reaction and its gap, each over the size that it is judged by above.
    equilibrium : float
        Largest nodal force out of balance over the largest nodal load (couples over the element size).
    balance : float
        Largest of the three global resultants out of balance over the sum of the load's magnitudes.
    tension_limit, equilibrium_limit, balance_limit : float
        What double precision can show of the three for this plate: internal forces of thin plates, and forces by which
        supports push against each other, are so much larger than the loads that their rounding counts. A figure over
        the tolerance is judged by its limit; 0 where none is.
    rounding : float
        Where a figure is judged by its limit, what rounding may be of the forces that act: of loads, of reactions, and,
        where settlements move the plate, of what bends it. Over 1e-4 that certifies nothing. 0 where no figure is.
    lost : float
        Where curvatures or loads that balance themselves act beside others: largest of force and two moments by which
        reactions miss the resultant of those others, over the sum of their magnitudes or the largest total of a
        support, or, if more, the largest of the least forces of the acting supports that make it up, over the largest
        reaction. Over 1e-4 the others are lost in the rounding of what has no resultant. 0 where all has one, or
        nothing.
    """

    penetration: float
    tension: float
    complementarity: float
    equilibrium: float
    balance: float
    tension_limit: float = 0.0
    equilibrium_limit: float = 0.0
    balance_limit: float = 0.0
    rounding: float = 0.0
    lost: float = 0.0

    @property
    def limited(self) -> bool:
        """Whether arithmetic limits a figure that passed."""
        return self.passed and max(self.tension, self.equilibrium, self.balance) > TOLERANCE

    @classmethod
    def worst(cls, of: Sequence[Self]) -> Self:
        """Take the largest of every figure."""
        return cls(**{figure.name: max(getattr(one, figure.name) for one in of) for figure in fields(cls)})

    @property
    def passed(self) -> bool:
        """Whether every figure is within tolerance, or within a limit that still certifies."""
        within = (getattr(self, name) <= max(TOLERANCE, getattr(self, f"{name}_limit", 0.0)) for name in FIGURES)
        return all(within) and self.rounding <= CERTIFIABLE and self.lost <= CERTIFIABLE

    def __str__(self) -> str:
        """Say it in a line."""
        figures = ", ".join(f"{name} {getattr(self, name):.1e}" for name in FIGURES)
        limits = ", ".join(f"{name} to {getattr(self, f'{name}_limit'):.0e}" for name in LIMITED)
        note = f"; arithmetic limits {limits}" if self.limited or self.rounding > CERTIFIABLE else ""
        lost = f"; reactions miss the load by {self.lost:.0e} of it" if self.lost > CERTIFIABLE else ""
        return f"{'passed' if self.passed else 'failed'}: {figures}{note}{lost}"


def certify(
    discretisation: Discretisation,
    load: CaseLoad,
    hi: Floats,
    lo: Floats,
    reaction: Floats,
    pieces: Sequence[Ints] = (),
    beside: Sequence[CaseLoad] = (),
) -> Certificate:
    """Judge displacements ``hi + lo`` (3n,) and the contact points' reactions (m,) under a load.

    ``pieces`` (m,) are pieces of the laws on which they claim to be solutions: how far points are off such a piece
    counts as complementarity too. An answer at both ends of a stretch that stands on the same pieces proves all
    between them, which is linear. ``beside`` are the loads that this one is the sum of: their rounding, and
    that of the reactions to them, is none of the answer's fault where they cancel.
    """
    sets = [those[None] for those in pieces]
    return certify_each(discretisation, [load], hi[None], lo[None], reaction[None], sets, [beside])[0]


def certify_each(
    discretisation: Discretisation,
    loads: Sequence[CaseLoad],
    hi: Floats,
    lo: Floats,
    reaction: Floats,
    pieces: Sequence[Ints] = (),
    beside: Sequence[Sequence[CaseLoad]] = (),
    imbalance: Floats | None = None,
) -> list[Certificate]:
    """Judge answers (k,) to as many loads as `certify` does each, from arrays of one more dimension in front.

    ``imbalance`` (k, 3n) are the residuals of plate and springs alone, where they are known.
    """
    contacts, held, size = discretisation.contacts, discretisation.held, discretisation.mesh.size
    nodal = np.array([load.nodal for load in loads])
    beside = beside or [()] * len(loads)
    deflected, reached = (
        np.array([sum(float(of(discretisation, part.nodal)) for part in parts) for parts in beside])
        for of in (loaded_deflection, reaching)
    )
    imbalance = imbalances(discretisation, loads, hi, lo) if imbalance is None else imbalance
    with np.errstate(invalid="ignore"):
        pushes = (discretisation.contact_rows.T @ reaction.T).T
        at_holds = np.where(held.dofs, imbalance - pushes, 0.0)
        at_free = np.where(held.dofs, 0.0, imbalance - pushes)

        travels = _travels(discretisation, hi, lo)
        force = np.where(contacts.slope, reaction / size, reaction)
        slip = np.where(held.dofs, hi + lo - held.values, 0.0)
        springs = discretisation.springs
        # Travel counts by its rounding, and at its own point: a stop far away must not excuse what happens at others.
        lever = np.where(contacts.slope, size, 1.0)
        travel, idle = _UNSEEN * lever * np.abs(contacts.distance), ~nodal.any(axis=1)
        # Slopes that are given deflect the plate between nodes that are held.
        turned = max(
            float(np.abs(held.values.reshape(-1, 3)[:, 1:]).max(initial=0.0)),
            float(np.abs(contacts.distance[contacts.slope]).max(initial=0.0)),
        )
        deflection, slopes = hi[:, ::3], hi.reshape(len(hi), -1, 3)[:, :, 1:]
        length = maximum(
            largest_magnitudes(deflection),
            _NIL * loaded_deflection(discretisation, nodal),
            _UNSEEN * deflected,
            _UNSEEN * turned * size,
            idle * travel.max(initial=0.0),
            idle * _UNSEEN * (np.abs(springs.base) * np.where(springs.slope, size, 1.0)).max(initial=0.0),
        )
        slope = maximum(largest_magnitudes(slopes), length / size)
        lengths = np.where(contacts.slope, slope[:, None], np.maximum(travel, length[:, None]))
        lengths += length[:, None] == 0.0

        across = float(np.sqrt(discretisation.mesh.element_area.mean()))
        # Forces count from what bending to the deflection takes, less the rigid motion in it; under no load, from what
        # shearing to the travel does.
        part = np.minimum(np.abs(bending_part(discretisation, deflection)), length[:, None])
        bent = np.where(idle, length, largest_magnitudes(part))
        bending = rigidity(discretisation, discretisation.thickness.max()) * bent / size**2
        # What bolts are tightened to acts as loads do.
        rest = maximum(_UNSEEN * bending, _CANCELLED * reached, float(np.abs(contacts.preload).max(initial=0.0)))
        shear = discretisation.model.young * discretisation.thickness.max()
        rest = np.where(idle, maximum(rest, shear * maximum(_UNSEEN * length, travel.max(initial=0.0))), rest)
        by_load = by_force(nodal, across)
        by_supports = maximum(by_force(at_holds, across), largest_magnitudes(force))
        scale = maximum(np.where(by_load != 0.0, by_load, by_supports), rest)
        pressing = maximum(scale, largest_magnitudes(force))
        unit = np.where(contacts.slope, size, 1.0) * np.where(pressing != 0.0, pressing, 1.0)[:, None]
        too_far, too_near, beyond = off_laws(contacts, travels, reaction, lengths, unit)
        too_near = np.max(
            [too_near, *(_off_pieces(contacts, those, travels, reaction, lengths, unit) for those in pieces)], axis=0
        )
        pull = discretisation.spring_forces(hi, lo)
        against = at_holds + (discretisation.spring_rows.T @ pull.T).T + pushes
        out_of_balance, total = resultants_and_sizes(discretisation, nodal, against)
        by_name = {
            "penetration": maximum(
                largest_magnitudes(too_far),
                ratio(largest_magnitudes(slip[:, ::3]), length),
                ratio(largest_magnitudes(slip.reshape(slopes.shape[0], -1, 3)[:, :, 1:]), slope),
            ),
            "tension": largest_magnitudes(beyond),
            "complementarity": largest_magnitudes(too_near),
            "equilibrium": ratio(by_force(at_free, across), scale),
            "balance": ratio(out_of_balance, maximum(total, rest)),
        }
        of_each = zip(loads, beside, against, at_holds, pull, reaction, strict=True)
        lost = [_lost(discretisation, *one) for one in of_each]
    certificates = []
    for row, load_lost in enumerate(lost):
        figures = {name: float(values[row]) for name, values in by_name.items()}
        sizes = float(scale[row]), float(pressing[row]), float(maximum(total, rest)[row])
        certificates.append(_judged(discretisation, figures, load_lost, sizes, hi[row], lo[row], reaction[row]))
    return certificates


def imbalances(discretisation: Discretisation, loads: Sequence[CaseLoad], hi: Floats, lo: Floats) -> Floats:
    """F - Ku (k, 3n) of plate and springs, at displacements hi + lo (k, 3n)."""
    springs = discretisation.springs.arrays
    each = zip(loads, hi, lo, strict=True)
    return np.array([discretisation.plate.residual(springs, load.nodal, one, rest) for load, one, rest in each])


def _judged(
    discretisation: Discretisation,
    figures: dict[str, float],
    lost: float,
    sizes: tuple[float, float, float],
    hi: Floats,
    lo: Floats,
    reaction: Floats,
) -> Certificate:
    """Certify figures by sizes of imbalances, reactions and resultants, or by what double precision can show."""
    worst = max(figures[name] for name in LIMITED)
    if worst <= TOLERANCE or not np.isfinite(worst):
        return Certificate(**figures, lost=lost)
    held, (scale, pressing, size) = discretisation.held, sizes

    def left_by_rounding(at: Bools) -> float:
        return _ROUNDINGS * float(np.finfo(float).eps) * sum(forces_at_nodes(discretisation, hi, lo, reaction, at))

    at_nodes = left_by_rounding(~held.dofs)
    # Roundings of the dofs add up as in a random walk; those of the dofs held are in the resultants too.
    many = np.sqrt(discretisation.dof_count)
    resultant = many * left_by_rounding(np.ones_like(held.dofs))
    # Beside settlements a load may be nothing: what bends the plate, and what supports push with, count as well.
    bent = float(np.abs(bending_part(discretisation, hi[None, ::3])).max())
    bending = rigidity(discretisation, discretisation.thickness.min()) * bent / discretisation.mesh.size**4
    bending = max(scale, bending * float(discretisation.mesh.element_area.sum()))
    pushing = float(maximum(size, reaching(discretisation, push_magnitudes(discretisation, hi, lo, reaction))))
    # A reaction that balances nothing but rounding may have either sign.
    limits = {
        "tension": (many * at_nodes, pressing, pressing),
        "equilibrium": (at_nodes, scale, bending),
        "balance": (resultant, size, pushing),
    }
    judged = [limits[name] for name in LIMITED if figures[name] > TOLERANCE]
    return Certificate(
        **figures,
        **{f"{name}_limit": float(ratio(rounding, loads)) for name, (rounding, loads, _) in limits.items()},
        rounding=max(float(ratio(rounding, acting)) for rounding, _, acting in judged),
        lost=lost,
    )


def certified(
    discretisation: Discretisation, load: CaseLoad, answer: Answer, beside: Sequence[CaseLoad] = ()
) -> tuple[Answer, Certificate]:
    """Judge an answer, and where it fails what stands for it; that which passes, or else the last."""
    for turn in answer.in_turn:
        certificate = certify(discretisation, load, turn.hi, turn.lo, turn.reaction, beside=beside)
        if certificate.passed:
            break
    return turn, certificate


def least_deflection(discretisation: Discretisation, load: CaseLoad) -> float:
    """Deflection below which that of a load is rounding."""
    return _NIL * float(loaded_deflection(discretisation, load.nodal))


def _travels(discretisation: Discretisation, hi: Floats, lo: Floats) -> Floats:
    contacts = discretisation.contacts
    rows = contacts.rows.arrays
    return -np.array(
        [discretisation.plate.openings(*rows, contacts.distance, *one) for one in zip(hi, lo, strict=True)]
    )


def off_laws(
    contacts: ContactPoints, travels: Floats, reaction: Floats, lengths: Floats, sizes: Floats
) -> tuple[Floats, Floats, Floats]:
    """How far points (k, m) have gone beyond their laws, fall short of them, and are beyond what these can give.

    A point that reacts is off its law by a travel; on a flat piece by a force, if that is less.
    """
    result = np.zeros((3, *travels.shape))
    for law, at in contacts.by_law:
        travel, scale, unit = travels[:, at] / contacts.unit[at], contacts.scale[at], contacts.unit[at]
        force = reaction[:, at] / scale
        least, most = law.forces
        given = np.clip(force, least, most)
        low, high = law.travels(given)
        result[2][:, at] = scale * np.abs(force - given) / sizes[:, at]
        flat = scale * np.abs(given - law.flat_force(travel)) / sizes[:, at]
        for which, off in enumerate((travel - high, low - travel)):
            result[which][:, at] = np.minimum(np.maximum(off, 0.0) * unit / lengths[:, at], flat)
        if law.straight:
            result[0][:, at] = result[:2, :, at].max(axis=0)
            result[1][:, at] = 0.0
    return result[0], result[1], result[2]


def _off_pieces(
    contacts: ContactPoints, pieces: Ints, travels: Floats, reaction: Floats, lengths: Floats, sizes: Floats
) -> Floats:
    """How far points (k, m) are off the lines of pieces of their laws; straight laws have but one."""
    result = np.zeros(travels.shape)
    for number, law in enumerate(contacts.laws):
        if law.straight or not (mine := contacts.law == number).any():
            continue
        at = np.broadcast_to(mine, travels.shape).nonzero()
        piece = np.broadcast_to(pieces, travels.shape)[at]
        anchor, slope, scale = law.anchors[piece], law.slopes[piece], contacts.scale[at[1]]
        unit = contacts.unit[at[1]]
        force = reaction[at] / scale
        flat = scale * np.abs(force - anchor[:, 1]) / sizes[at]
        along = (force - anchor[:, 1]) / np.where(slope == 0.0, np.inf, slope)
        away = np.abs(travels[at] - unit * (anchor[:, 0] + along)) / lengths[at]
        result[at] = np.where(slope == 0.0, flat, away)
    return result


def _lost(
    discretisation: Discretisation,
    load: CaseLoad,
    beside: Sequence[CaseLoad],
    against: Floats,
    at_holds: Floats,
    pull: Floats,
    reaction: Floats,
) -> float:
    """What the forces of supports (3n,) leave of the loads that have a resultant, where there are others too.

    The resultant that is missed counts over these loads or the largest total of a support, and the least forces of
    acting supports that make it up over the largest that acts: supports near each other need more.
    """
    if load.all_weighs or not load.weighing.any():
        return 0.0
    (missing,), _ = resultants_and_sizes(discretisation, load.weighing[None], against[None])
    # Loads that cancel can miss the rounding of their parts.
    of_parts = sum(float(reaching(discretisation, part.weighing)) for part in beside)
    of_loads = max(float(reaching(discretisation, load.weighing)), _CANCELLED * of_parts)
    totals = np.abs(_totals(discretisation, at_holds, pull, reaction)).max()
    part = float(ratio(missing, maximum(of_loads, totals)))
    if not part > 0.0:
        return part
    motions, held = discretisation.scaled_motions, discretisation.held.dofs
    # A couple counts as a force at the plate's size.
    slope = np.concatenate([np.flatnonzero(held) % 3 > 0, discretisation.springs.slope, discretisation.contacts.slope])
    arm = np.where(slope, discretisation.mesh.size, 1.0)
    forces = np.concatenate([at_holds[held], pull, reaction]) / arm
    moved = [motions[held], discretisation.spring_rows @ motions, discretisation.contact_rows @ motions]
    rows = np.concatenate(moved) * arm[:, None]
    largest = np.abs(forces).max(initial=0.0)
    acting = np.abs(forces) > _UNSEEN * largest
    resultant = np.einsum("ij,i->j", motions, load.weighing - against)
    making = np.linalg.lstsq(rows[acting].T, resultant, rcond=_NO_LEVER)[0]
    # Of the loads at least half a mean share, since nodal forces of a pressure have both signs.
    most = np.abs(making).max(initial=0.0)
    return max(part, float(ratio(most, maximum(largest, 0.5 * of_loads / max(acting.sum(), 1)))))


def _totals(discretisation: Discretisation, at_holds: Floats, pull: Floats, reaction: Floats) -> Floats:
    """Upward force (s,) of every support; of those that hold a node together the first has it."""
    contacts, many = discretisation.contacts, len(discretisation.model.support)
    forces = np.where(contacts.slope, 0.0, contacts.direction * reaction)
    at_nodes = discretisation.held.dofs[::3]
    return np.asarray(
        np.bincount(discretisation.held.support[::3][at_nodes], at_holds[::3][at_nodes], many)
        + np.bincount(discretisation.springs.support, np.where(discretisation.springs.slope, 0.0, pull), many)
        + np.bincount(contacts.support, forces, many)
    )


def forces_at_nodes(
    discretisation: Discretisation, hi: Floats, lo: Floats, reaction: Floats, at: Bools | None = None
) -> tuple[float, float]:
    """Largest sum of what cancels at one of some dofs (3n,), or of the free ones: in the plate, and between supports.

    Their rounding is what arithmetic leaves out of balance.
    """
    at = ~discretisation.held.dofs if at is None else at
    across = float(np.sqrt(discretisation.mesh.element_area.mean()))
    internal = discretisation.plate.internal_magnitude(~at, hi, lo)
    pushes = np.where(at, push_magnitudes(discretisation, hi, lo, reaction), 0.0)
    return float(internal), float(by_force(pushes[None], across)[0])


def push_magnitudes(discretisation: Discretisation, hi: Floats, lo: Floats, reaction: Floats) -> Floats:
    """Sums (3n,) of the magnitudes that supports push with.

    Those that nearly repeat each other push against each other, and their forces are carried as doubles.
    """
    pull = np.abs(discretisation.spring_forces(hi, lo))
    return np.asarray(abs(discretisation.contact_rows).T @ np.abs(reaction) + abs(discretisation.spring_rows).T @ pull)


def resultants_and_sizes(discretisation: Discretisation, nodal: Floats, against: Floats) -> tuple[Floats, Floats]:
    """Largest resultants (k,) of loads (k, 3n) and of what supports set against them, and the whole sizes."""
    # Threads of a linear algebra library would cost more than these sums.
    resultant = np.einsum("ij,ki->kj", discretisation.scaled_motions, nodal - against)
    return largest_magnitudes(resultant), maximum(reaching(discretisation, nodal), reaching(discretisation, against))


def reaching(discretisation: Discretisation, nodal: Floats) -> Floats:
    """Sums (...,) of the magnitudes that nodal forces (..., 3n) have in a resultant."""
    return np.asarray((np.abs(nodal) * np.abs(discretisation.scaled_motions).max(axis=1)).sum(axis=-1))


def bending_part(discretisation: Discretisation, deflection: Floats) -> Floats:
    """Deflections (k, n) of the nodes without the rigid motions nearest to them."""
    motions = discretisation.rigid_motions[::3]
    return np.asarray(deflection - (motions @ np.linalg.lstsq(motions, deflection.T)[0]).T)


def loaded_deflection(discretisation: Discretisation, nodal: Floats) -> Floats:
    """Deflections (...,) by which loads (..., 3n) scale on the plate."""
    forces, *couples = np.moveaxis(np.abs(nodal.reshape(*nodal.shape[:-1], -1, 3)).sum(axis=-2), -1, 0)
    size = discretisation.mesh.size
    loads = (forces + sum(couples) / size) * size**2
    return np.asarray(loads / rigidity(discretisation, discretisation.thickness.min()))


def rigidity(discretisation: Discretisation, thickness: float) -> float:
    """Bending stiffness E t³/12 of a thickness, Poisson's ratio left out."""
    return discretisation.model.young * float(thickness) ** 3 / 12


def by_force(nodal: Floats, across: float) -> Floats:
    """Largest of nodal forces (k, 3n); couples count by the force they are at an element's size apart."""
    return largest_magnitudes(nodal.reshape(len(nodal), -1, 3) / [1.0, across, across])


def largest_magnitudes(values: Floats) -> Floats:
    """Largest magnitudes (k,) of values (k, ...); NaN where there is one."""
    return np.asarray(np.abs(values).reshape(len(values), -1).max(axis=1, initial=0.0))


def maximum(*sizes: Floats | float) -> Floats:
    """The largest of each; NaN where there is one."""
    return np.asarray(functools.reduce(np.maximum, sizes))


def ratio(error: Floats | float, size: Floats | float) -> Floats:
    """Errors over sizes: none of no error, infinite of no size."""
    error, size = np.asarray(error), np.asarray(size)
    part = np.where(size > 0.0, error / np.where(size > 0.0, size, 1.0), np.inf)
    return np.asarray(np.where(error == 0.0, 0.0, part))
