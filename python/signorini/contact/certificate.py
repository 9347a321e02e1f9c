"""The certificate: errors of an answer, computed from the statement of the problem alone.

Penetrations Gu − Cλ − g, nodal forces F − Ku − Gᵀλ (F the nodal loads) and the global balance are recomputed from the
displacements u and reactions λ, without any factor, condensed matrix or status of a solver.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Self

import numpy as np

from signorini.contact.selection import Answer
from signorini.discretise import CaseLoad, ContactPoints, Discretisation
from signorini.discretise.loads import CANCELLED
from signorini.discretise.rows import Bools, Floats, Ints

TOLERANCE = 1e-8
"""Largest error of a certified answer; each error is relative to the reference size stated in `Certificate`."""
CERTIFIABLE = 1e-4
"""Largest relative rounding error of a certified answer, the limit of the fields ``rounding`` and ``lost``.

Rounding errors at the nodes add up as in a random walk, loads add up directly. So the relative error of the whole
answer is hardly larger than this limit.
"""
_ROUNDINGS = 4.0
"""Largest imbalance at a node that counts as rounding, in machine epsilons times the internal and contact forces there.
"""
_RANK = 1e-12
"""Rank tolerance in the least-norm problem for the support forces with a given resultant, see `_Answers.lost`."""
NIL = 1e-6
"""Largest deflection, relative to F a²/D, that may be rounding of the elimination; F is the load, a the plate's size.
"""
UNSEEN = _ROUNDINGS * float(np.finfo(float).eps) / TOLERANCE
"""Lower bound 4ε/`TOLERANCE` = 9e-8 of a reference size, relative to the rounded number, for example a gap.

The rounding of the number, 4ε times its size, is then at most `TOLERANCE` times the reference size, and passes.
"""
_CANCELLED = CANCELLED / TOLERANCE
"""Lower bound 4e-7 of the reference force, relative to the loads; their sum has a rounding error of `CANCELLED`."""
FIGURES = ("penetration", "tension", "complementarity", "equilibrium", "balance")
"""Names of the errors of a certificate, in the order in which they are shown."""
LIMITED = ("tension", "equilibrium", "balance")
"""Names of the errors that may exceed the tolerance, up to the rounding of internal forces and support forces."""


@dataclass(frozen=True)
class Certificate:
    """Errors of an answer, each relative to a size stated here; ``passed`` means that all are within tolerance.

    Parameters
    ----------
    penetration : float
        Largest penetration (Gu − Cλ − g)₊ or violation of a held deflection, relative to the reference deflection: the
        largest deflection, at least 10⁻⁶ F a²/D for a load F on a plate of size a, and at least 10⁻⁷ a times the
        prescribed slopes. Violations of held slopes are relative to the largest slope, at least the reference
        deflection over a.
    tension : float
        Largest reaction of the wrong sign, or beyond its limit, relative to the largest reaction or nodal load.
    complementarity : float
        Largest min(reaction, gap), with the reaction relative to the size of ``tension``, the gap to that of
        ``penetration``.
    equilibrium : float
        Largest nodal force F − Ku − Gᵀλ relative to the largest nodal load; couples are divided by the element size.
    balance : float
        Largest global resultant of loads and reactions (force, two moments over a) relative to the sum of magnitudes.
    tension_limit, equilibrium_limit, balance_limit : float
        Rounding of these errors in double precision. Internal forces of thin plates, and forces of supports that push
        against each other, are far larger than the loads, so that their rounding may exceed the tolerance. An error
        above the tolerance is compared with its limit. 0 if all three errors are within the tolerance.
    rounding : float
        Largest limit that was used, relative to the acting forces: loads, reactions, and with settlements the forces
        that bend the plate. Above 1e-4 the answer is not certified. 0 if no limit was used.
    lost : float
        0 unless stress-free curvatures or self-equilibrated loads act together with other loads. Then the resultant of
        these other loads and the reactions, relative to the sum of the magnitudes of these other loads, or to the
        largest total force of a support if larger. Or, if larger, the largest of the least-norm support forces with
        this resultant, relative to the largest reaction. Above 1e-4 the other loads are lost in rounding.
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
        """Whether the certificate passes only because an error above the tolerance is within its rounding limit."""
        return self.passed and max(self.tension, self.equilibrium, self.balance) > TOLERANCE

    @classmethod
    def worst(cls, certificates: Sequence[Self]) -> Self:
        """Certificate in which each field is the largest value of this field among ``certificates``."""
        return cls(
            **{
                figure.name: max(getattr(certificate, figure.name) for certificate in certificates)
                for figure in fields(cls)
            }
        )

    @property
    def passed(self) -> bool:
        """Whether errors are within the tolerance or their limits, ``rounding`` and ``lost`` within `CERTIFIABLE`."""
        within = (getattr(self, name) <= max(TOLERANCE, getattr(self, f"{name}_limit", 0.0)) for name in FIGURES)
        return all(within) and self.rounding <= CERTIFIABLE and self.lost <= CERTIFIABLE

    def __str__(self) -> str:
        """Describe the certificate in one line."""
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
    """Certify displacements u = ``hi + lo`` (3n,) and reactions λ (m,) of contact points under a load.

    ``pieces`` are contact states: each array (m,) has the piece of each point's law. The answer must lie on all of
    these states; the largest distance from a piece counts as complementarity error. If two answers are certified on the
    same state, all answers between them are certified. ``beside`` are the loads whose sum is ``load``: where they
    cancel, their rounding is tolerated.
    """
    sets = [set_of_pieces[None] for set_of_pieces in pieces]
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
    """Certify k answers to k loads; all arrays have an additional first dimension k, see `certify`.

    ``imbalance`` (k, 3n), the residual F − Ku of plate and springs, is computed if it is None.
    """
    imbalance = imbalances(discretisation, loads, hi, lo) if imbalance is None else imbalance
    answers = _Answers(discretisation, loads, hi, lo, reaction, pieces, beside or [()] * len(loads), imbalance)
    with np.errstate(invalid="ignore"):
        errors = {name: getattr(answers, name)() for name in FIGURES}
        lost = [answers.lost(row) for row in range(len(loads))]
    rows = ({name: float(values[row]) for name, values in errors.items()} for row in range(len(loads)))
    return [answers.certificate(row, figures, lost[row]) for row, figures in enumerate(rows)]


@dataclass(frozen=True, eq=False)
class _Answers:
    """k answers to k loads; the methods named in `FIGURES` return the errors (k,) of the answers.

    ``imbalance`` (k, 3n) is F − Ku of plate and springs; the other fields are the arguments of `certify_each`.
    """

    discretisation: Discretisation
    loads: Sequence[CaseLoad]
    hi: Floats
    lo: Floats
    reaction: Floats
    pieces: Sequence[Ints]
    beside: Sequence[Sequence[CaseLoad]]
    imbalance: Floats

    def penetration(self) -> Floats:
        """Largest (Gu − Cλ − g)₊ at contact points and |u − ū| at held dofs, relative to the reference for each."""
        held = self.discretisation.held
        slip = np.where(held.dofs, self.hi + self.lo - held.values, 0.0).reshape(len(self.hi), -1, 3)
        return maximum(
            largest_magnitudes(self._off_laws[0]),
            ratio(largest_magnitudes(slip[:, :, 0]), self.length),
            ratio(largest_magnitudes(slip[:, :, 1:]), self.slope),
        )

    def tension(self) -> Floats:
        """Largest distance of a reaction λ from the range of forces of its point's law, relative to `reaction_size`."""
        return largest_magnitudes(self._off_laws[2])

    def complementarity(self) -> Floats:
        """Largest min(reaction λ, gap g + Cλ − Gu), both relative; or the distance from given ``pieces``, if larger."""
        sizes = self._travels, self.reaction, self._lengths, self._units
        contacts = self.discretisation.contacts
        off = [self._off_laws[1], *(_off_pieces(contacts, pieces, *sizes) for pieces in self.pieces)]
        return largest_magnitudes(np.max(off, axis=0))

    def equilibrium(self) -> Floats:
        """Largest |F − Ku − Gᵀλ| at free dofs, relative to the reference nodal force `force_size`."""
        residual = np.where(self.discretisation.held.dofs, 0.0, self.imbalance - self.pushes)
        return ratio(by_force(residual, self.element_size), self.force_size)

    def balance(self) -> Floats:
        """Largest |Rᵀ(F − forces of supports)| over rigid motions R, relative to the reference resultant."""
        return ratio(self._resultants[0], self.resultant_size)

    def lost(self, row: int) -> float:
        """Field ``lost`` of answer ``row``: relative resultant of reactions and of loads that can have a resultant."""
        discretisation, load, supports = self.discretisation, self.loads[row], self.support_forces[row]
        if load.all_weighs or not load.weighing.any():
            return 0.0
        (missing,), _ = resultants_and_sizes(discretisation, load.weighing[None], supports[None])
        # If loads cancel in their sum, the sum has the rounding of the single loads.
        of_parts = sum(float(reaching(discretisation, part.weighing)) for part in self.beside[row])
        of_loads = max(float(reaching(discretisation, load.weighing)), _CANCELLED * of_parts)
        holding, pull, reaction = self.holding[row], self.pull[row], self.reaction[row]
        totals = np.abs(_totals(discretisation, holding, pull, reaction)).max()
        relative = float(ratio(missing, maximum(of_loads, totals)))
        if not relative > 0.0:
            return relative
        motions, held = discretisation.scaled_motions, discretisation.held.dofs
        # Couples are divided by the plate's size, to be compared with forces.
        slopes = np.flatnonzero(held) % 3 > 0, discretisation.springs.slope, discretisation.contacts.slope
        arm = np.where(np.concatenate(slopes), discretisation.mesh.size, 1.0)
        forces = np.concatenate([holding[held], pull, reaction]) / arm
        blocks = [motions[held], discretisation.spring_rows @ motions, discretisation.contact_rows @ motions]
        largest = np.abs(forces).max(initial=0.0)
        acting = np.abs(forces) > UNSEEN * largest
        resultant = np.einsum("ij,i->j", motions, load.weighing - supports)
        rows = (np.concatenate(blocks) * arm[:, None])[acting]
        least_norm = np.abs(np.linalg.lstsq(rows.T, resultant, rcond=_RANK)[0]).max(initial=0.0)
        # The reference is at least ½ Σ|loads| / number of support forces: nodal loads of a pressure have both signs.
        return max(relative, float(ratio(least_norm, maximum(largest, 0.5 * of_loads / max(acting.sum(), 1)))))

    def certificate(self, row: int, figures: dict[str, float], lost: float) -> Certificate:
        """Certificate of the answer with index ``row``; limits are computed if an error exceeds the tolerance."""
        worst = max(figures[name] for name in LIMITED)
        if worst <= TOLERANCE or not np.isfinite(worst):
            return Certificate(**figures, lost=lost)
        discretisation, held = self.discretisation, self.discretisation.held.dofs
        answer = discretisation, self.hi[row], self.lo[row], self.reaction[row]
        sizes = self.force_size[row], self.reaction_size[row], self.resultant_size[row]
        force, reaction, resultant = map(float, sizes)
        epsilon = _ROUNDINGS * float(np.finfo(float).eps)
        # Rounding errors of n dofs add up to √n times one of them, as in a random walk. Resultants include held dofs.
        random_walk = np.sqrt(discretisation.dof_count)
        at_nodes = epsilon * sum(forces_at_nodes(*answer, ~held))
        of_resultant = random_walk * (epsilon * sum(forces_at_nodes(*answer, np.ones_like(held))))
        # With settlements alone the loads are zero, so forces that bend the plate and support forces count as acting.
        deflection = float(np.abs(bending_part(discretisation, self.hi[row][None, ::3])).max())
        bending = rigidity(discretisation, discretisation.thickness.min()) * deflection / discretisation.mesh.size**4
        bending = max(force, bending * float(discretisation.mesh.element_area.sum()))
        pushing = float(maximum(resultant, reaching(discretisation, push_magnitudes(*answer))))
        # A reaction that is smaller than the rounding of nodal forces may have the wrong sign.
        limits = {
            "tension": (random_walk * at_nodes, reaction, reaction),
            "equilibrium": (at_nodes, force, bending),
            "balance": (of_resultant, resultant, pushing),
        }
        judged = [limits[name] for name in LIMITED if figures[name] > TOLERANCE]
        return Certificate(
            **figures,
            **{f"{name}_limit": float(ratio(rounding, size)) for name, (rounding, size, _) in limits.items()},
            rounding=max(float(ratio(rounding, acting)) for rounding, _, acting in judged),
            lost=lost,
        )

    @cached_property
    def nodal(self) -> Floats:
        """Nodal loads F (k, 3n) of the k answers."""
        return np.array([load.nodal for load in self.loads])

    @cached_property
    def pushes(self) -> Floats:
        """Nodal forces Gᵀλ (k, 3n) of the contact points' reactions."""
        return np.asarray((self.discretisation.contact_rows.T @ self.reaction.T).T)

    @cached_property
    def holding(self) -> Floats:
        """Forces F − Ku − Gᵀλ (k, 3n) of supports at held dofs; 0 at other dofs."""
        return np.where(self.discretisation.held.dofs, self.imbalance - self.pushes, 0.0)

    @cached_property
    def pull(self) -> Floats:
        """Upward forces (k, s) of the s springs."""
        return self.discretisation.spring_forces(self.hi, self.lo)

    @cached_property
    def support_forces(self) -> Floats:
        """Nodal forces (k, 3n) of all supports, positive if opposite to the loads."""
        return np.asarray(self.holding + (self.discretisation.spring_rows.T @ self.pull.T).T + self.pushes)

    @cached_property
    def unloaded(self) -> Bools:
        """Whether the nodal load (k,) of each answer is zero, so that only settlements and preloads act."""
        return np.asarray(~self.nodal.any(axis=1))

    @cached_property
    def travel(self) -> Floats:
        """Lower bound (m,) of the reference travel of each contact point, so that the rounding of its g is no error.

        Each point has its own bound: a large gap at one point must not allow larger errors at other points.
        """
        contacts = self.discretisation.contacts
        return UNSEEN * np.where(contacts.slope, self.discretisation.mesh.size, 1.0) * np.abs(contacts.distance)

    @cached_property
    def length(self) -> Floats:
        """Reference deflection (k,): the largest, at least the one that rounding of loads and settlements causes."""
        held, contacts, springs = self.discretisation.held, self.discretisation.contacts, self.discretisation.springs
        size = self.discretisation.mesh.size
        prescribed = max(
            float(np.abs(held.values.reshape(-1, 3)[:, 1:]).max(initial=0.0)),
            float(np.abs(contacts.distance[contacts.slope]).max(initial=0.0)),
        )
        return maximum(
            largest_magnitudes(self.hi[:, ::3]),
            NIL * loaded_deflection(self.discretisation, self.nodal),
            UNSEEN * self._of_parts(loaded_deflection),
            UNSEEN * prescribed * size,
            self.unloaded * self.travel.max(initial=0.0),
            self.unloaded * UNSEEN * (np.abs(springs.distance) * np.where(springs.slope, size, 1.0)).max(initial=0.0),
        )

    @cached_property
    def slope(self) -> Floats:
        """Reference slope (k,): the largest slope, or the reference deflection over the plate's size if larger."""
        slopes = self.hi.reshape(len(self.hi), -1, 3)[:, :, 1:]
        return maximum(largest_magnitudes(slopes), self.length / self.discretisation.mesh.size)

    @cached_property
    def element_size(self) -> float:
        """Square root of the mean element area."""
        return float(np.sqrt(self.discretisation.mesh.element_area.mean()))

    @cached_property
    def least_force(self) -> Floats:
        """Lower bound (k,) of the reference force, so that rounding does not count as an error.

        It is the largest of three forces: the largest preload; `UNSEEN` D w / a², the rounding of the force that bends
        the plate, with w the deflection without rigid motion and a the plate's size; `_CANCELLED` times the magnitude
        of the loads whose sum is this load. If the load is zero, w is `length`, and the bound is also at least E h
        times the rounding of `length`, and E h times the largest `travel`.
        """
        discretisation, size = self.discretisation, self.discretisation.mesh.size
        part = np.minimum(np.abs(bending_part(discretisation, self.hi[:, ::3])), self.length[:, None])
        bent = np.where(self.unloaded, self.length, largest_magnitudes(part))
        bending = rigidity(discretisation, discretisation.thickness.max()) * bent / size**2
        preload = float(np.abs(discretisation.contacts.preload).max(initial=0.0))
        least = maximum(UNSEEN * bending, _CANCELLED * self._of_parts(reaching), preload)
        shear = discretisation.model.young * discretisation.thickness.max()
        sheared = shear * maximum(UNSEEN * self.length, self.travel.max(initial=0.0))
        return np.where(self.unloaded, maximum(least, sheared), least)

    @cached_property
    def force_size(self) -> Floats:
        """Reference nodal force (k,): the largest nodal load, or without loads the largest force of a support."""
        by_load = by_force(self.nodal, self.element_size)
        by_supports = maximum(by_force(self.holding, self.element_size), self._largest_reaction)
        return maximum(np.where(by_load != 0.0, by_load, by_supports), self.least_force)

    @cached_property
    def reaction_size(self) -> Floats:
        """Reference reaction (k,): the largest reaction, or the reference nodal force if larger."""
        return maximum(self.force_size, self._largest_reaction)

    @cached_property
    def resultant_size(self) -> Floats:
        """Reference resultant (k,): Σ|loads| or Σ|forces of supports|, whichever is larger; at least `least_force`."""
        return maximum(self._resultants[1], self.least_force)

    def _of_parts(self, size: Callable[[Discretisation, Floats], Floats]) -> Floats:
        """Sum (k,) of ``size(discretisation, nodal)`` over the loads ``beside`` that add up to each load."""
        sizes = [sum(float(size(self.discretisation, part.nodal)) for part in parts) for parts in self.beside]
        return np.array(sizes)

    @cached_property
    def _largest_reaction(self) -> Floats:
        contacts, size = self.discretisation.contacts, self.discretisation.mesh.size
        return largest_magnitudes(np.where(contacts.slope, self.reaction / size, self.reaction))

    @cached_property
    def _resultants(self) -> tuple[Floats, Floats]:
        return resultants_and_sizes(self.discretisation, self.nodal, self.support_forces)

    @cached_property
    def _travels(self) -> Floats:
        """Travels Gu − g (k, m) of the contact points."""
        rows, distance = self.discretisation.contacts.rows.arrays, self.discretisation.contacts.distance
        answers = zip(self.hi, self.lo, strict=True)
        return -np.array([self.discretisation.plate.openings(*rows, distance, high, low) for high, low in answers])

    @cached_property
    def _lengths(self) -> Floats:
        """Reference travel (k, m) of each contact point: the reference deflection or slope; 1 without deflection."""
        at_points = np.maximum(self.travel, self.length[:, None])
        lengths = np.where(self.discretisation.contacts.slope, self.slope[:, None], at_points)
        return np.asarray(lengths + (self.length[:, None] == 0.0))

    @cached_property
    def _units(self) -> Floats:
        """Reference reaction (k, m) of each point: `reaction_size`, or 1 if this is 0; for couples times plate size."""
        size = self.reaction_size
        unit = np.where(self.discretisation.contacts.slope, self.discretisation.mesh.size, 1.0)
        return np.asarray(unit * np.where(size != 0.0, size, 1.0)[:, None])

    @cached_property
    def _off_laws(self) -> tuple[Floats, Floats, Floats]:
        sizes = self._lengths, self._units
        return off_laws(self.discretisation.contacts, self._travels, self.reaction, *sizes)


def imbalances(discretisation: Discretisation, loads: Sequence[CaseLoad], hi: Floats, lo: Floats) -> Floats:
    """Residual F − Ku (k, 3n) of plate and springs, without contact points, at displacements u = hi + lo (k, 3n)."""
    springs = discretisation.springs.arrays
    answers = zip(loads, hi, lo, strict=True)
    return np.array([discretisation.plate.residual(springs, load.nodal, high, low) for load, high, low in answers])


def certified(
    discretisation: Discretisation, load: CaseLoad, answer: Answer, beside: Sequence[CaseLoad] = ()
) -> tuple[Answer, Certificate]:
    """Certify an answer; if this fails, certify the fallback in `Answer.in_turn`.

    Return the answer that passes, else the last answer tried, with its certificate.
    """
    for candidate in answer.in_turn:
        certificate = certify(discretisation, load, candidate.hi, candidate.lo, candidate.reaction, beside=beside)
        if certificate.passed:
            break
    return candidate, certificate


def least_deflection(discretisation: Discretisation, load: CaseLoad) -> float:
    """Largest deflection that counts as rounding: 10⁻⁶ F a²/D for a load F on a plate of size a."""
    return NIL * float(loaded_deflection(discretisation, load.nodal))


def off_laws(
    contacts: ContactPoints, travels: Floats, reaction: Floats, lengths: Floats, sizes: Floats
) -> tuple[Floats, Floats, Floats]:
    """Distances (k, m) of points from their laws: penetration, gap, and force outside the law's range.

    Penetration and gap are travels relative to ``lengths`` (k, m). At travels on a piece of slope 0 they are the
    distance in force relative to ``sizes`` (k, m), if this is less. For a straight law the penetration is the larger of
    penetration and gap, and the gap is 0.
    """
    result = np.zeros((3, *travels.shape))
    for law, points in contacts.by_law:
        travel, scale, unit = travels[:, points] / contacts.unit[points], contacts.scale[points], contacts.unit[points]
        force = reaction[:, points] / scale
        least, most = law.forces
        force_in_range = np.clip(force, least, most)
        low, high = law.travels(force_in_range)
        result[2][:, points] = scale * np.abs(force - force_in_range) / sizes[:, points]
        flat = scale * np.abs(force_in_range - law.flat_force(travel)) / sizes[:, points]
        for row, distance in enumerate((travel - high, low - travel)):
            result[row][:, points] = np.minimum(np.maximum(distance, 0.0) * unit / lengths[:, points], flat)
        if law.straight:
            result[0][:, points] = result[:2, :, points].max(axis=0)
            result[1][:, points] = 0.0
    return result[0], result[1], result[2]


def _off_pieces(
    contacts: ContactPoints, pieces: Ints, travels: Floats, reaction: Floats, lengths: Floats, sizes: Floats
) -> Floats:
    """Relative distances (k, m) of points from the lines through ``pieces`` of their laws; 0 for straight laws."""
    result = np.zeros(travels.shape)
    for number, law in enumerate(contacts.laws):
        if law.straight or not (of_law := contacts.law == number).any():
            continue
        entries = np.broadcast_to(of_law, travels.shape).nonzero()
        piece = np.broadcast_to(pieces, travels.shape)[entries]
        anchor, slope, scale = law.anchors[piece], law.slopes[piece], contacts.scale[entries[1]]
        unit = contacts.unit[entries[1]]
        force = reaction[entries] / scale
        flat = scale * np.abs(force - anchor[:, 1]) / sizes[entries]
        along = (force - anchor[:, 1]) / np.where(slope == 0.0, np.inf, slope)
        distance = np.abs(travels[entries] - unit * (anchor[:, 0] + along)) / lengths[entries]
        result[entries] = np.where(slope == 0.0, flat, distance)
    return result


def _totals(discretisation: Discretisation, at_holds: Floats, pull: Floats, reaction: Floats) -> Floats:
    """Upward force (s,) of every support; a node held by several supports counts for the first of them."""
    contacts, count = discretisation.contacts, len(discretisation.model.support)
    forces = np.where(contacts.slope, 0.0, contacts.direction * reaction)
    at_nodes = discretisation.held.dofs[::3]
    return np.asarray(
        np.bincount(discretisation.held.support[::3][at_nodes], at_holds[::3][at_nodes], count)
        + np.bincount(discretisation.springs.support, np.where(discretisation.springs.slope, 0.0, pull), count)
        + np.bincount(contacts.support, forces, count)
    )


def forces_at_nodes(
    discretisation: Discretisation, hi: Floats, lo: Floats, reaction: Floats, dofs: Bools | None = None
) -> tuple[float, float]:
    """Largest sum over elements of |internal force| at a dof, and largest sum over supports of |support force|.

    Only ``dofs`` (3n,) count, by default the free dofs. A residual within the rounding of these sums is no error of the
    answer.
    """
    dofs = ~discretisation.held.dofs if dofs is None else dofs
    element_size = float(np.sqrt(discretisation.mesh.element_area.mean()))
    internal = discretisation.plate.internal_magnitude(~dofs, hi, lo)
    pushes = np.where(dofs, push_magnitudes(discretisation, hi, lo, reaction), 0.0)
    return float(internal), float(by_force(pushes[None], element_size)[0])


def push_magnitudes(discretisation: Discretisation, hi: Floats, lo: Floats, reaction: Floats) -> Floats:
    """Sum (3n,) at each dof of the magnitudes of the forces of springs and contact points.

    Nearly redundant supports push against each other with large forces, which are rounded to doubles.
    """
    pull = np.abs(discretisation.spring_forces(hi, lo))
    return np.asarray(abs(discretisation.contact_rows).T @ np.abs(reaction) + abs(discretisation.spring_rows).T @ pull)


def resultants_and_sizes(discretisation: Discretisation, nodal: Floats, against: Floats) -> tuple[Floats, Floats]:
    """Largest component (k,) of the resultants of ``nodal`` − ``against``, loads minus support forces (k, 3n).

    The second array (k,) is the sum of magnitudes of the loads, or of the support forces if larger.
    """
    # einsum uses no threads; starting threads would take longer than these sums.
    resultant = np.einsum("ij,ki->kj", discretisation.scaled_motions, nodal - against)
    return largest_magnitudes(resultant), maximum(reaching(discretisation, nodal), reaching(discretisation, against))


def reaching(discretisation: Discretisation, nodal: Floats) -> Floats:
    """Sums (...,) over dofs i of |F_i| maxⱼ |R_ij|, for nodal forces F (..., 3n) and rigid motions R."""
    return np.asarray((np.abs(nodal) * np.abs(discretisation.scaled_motions).max(axis=1)).sum(axis=-1))


def bending_part(discretisation: Discretisation, deflection: Floats) -> Floats:
    """Deflections (k, n) minus their rigid part, the rigid motion nearest in least squares."""
    motions = discretisation.rigid_motions[::3]
    return np.asarray(deflection - (motions @ np.linalg.lstsq(motions, deflection.T, rcond=None)[0]).T)


def loaded_deflection(discretisation: Discretisation, nodal: Floats) -> Floats:
    """Reference deflection F a²/D (...,) of loads (..., 3n): F the sum of their magnitudes, a the plate's size."""
    forces, *couples = np.moveaxis(np.abs(nodal.reshape(*nodal.shape[:-1], -1, 3)).sum(axis=-2), -1, 0)
    size = discretisation.mesh.size
    loads = (forces + sum(couples) / size) * size**2
    return np.asarray(loads / rigidity(discretisation, discretisation.thickness.min()))


def rigidity(discretisation: Discretisation, thickness: float) -> float:
    """Bending stiffness E h³/12 of a plate of thickness h, without the factor 1/(1 − ν²)."""
    return discretisation.model.young * float(thickness) ** 3 / 12


def by_force(nodal: Floats, element_size: float) -> Floats:
    """Largest magnitude (k,) of nodal forces and couples (k, 3n); couples are divided by the element size."""
    return largest_magnitudes(nodal.reshape(len(nodal), -1, 3) / [1.0, element_size, element_size])


def largest_magnitudes(values: Floats) -> Floats:
    """Largest magnitude (k,) in each row of values (k, ...); NaN if the row contains a NaN."""
    return np.asarray(np.abs(values).reshape(len(values), -1).max(axis=1, initial=0.0))


def maximum(*sizes: Floats | float) -> Floats:
    """Elementwise maximum of several arrays; NaN where an array is NaN."""
    return np.asarray(functools.reduce(np.maximum, sizes))


def ratio(error: Floats | float, size: Floats | float) -> Floats:
    """Elementwise quotient ``error``/``size``, with 0/0 = 0 and x/0 = ∞."""
    error, size = np.asarray(error), np.asarray(size)
    part = np.where(size > 0.0, error / np.where(size > 0.0, size, 1.0), np.inf)
    return np.asarray(np.where(error == 0.0, 0.0, part))
