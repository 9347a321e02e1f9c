"""The contact problem of a model as plain arrays: K, G, gaps, the paper's P and s, and the LCP in any of its forms."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias

import numpy as np

from signorini import _core
from signorini.arguments import known, made_by, number, vector
from signorini.discretise import CaseLoad, Discretisation, discretise
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.equilibrium import RigidFreedom, restraining_points, rigid_freedom
from signorini.errors import InputError, SignoriniError
from signorini.memory import require_memory_for_points
from signorini.model import Model

if TYPE_CHECKING:
    from scipy.sparse import csc_array, csr_array

Form = Literal["auto", "dual", "stiffness"]
Method = Literal["lemke", "active_set", "interior_point"]

Steps: TypeAlias = Callable[[int, int, float], object]
"""Called with a step's number, the contact points it changed and its relative imbalance; what it raises ends it."""

_FORMS: tuple[Form, ...] = ("auto", "stiffness", "dual")
_METHODS: tuple[Method, ...] = ("lemke", "active_set", "interior_point")
_LOAD = "Take discretisation.load(combination) or one of discretisation.cases."
"""How to come by a load with its nodal forces and curvatures."""

_YIELDING = (1e-6, 1e-9, 1e-11, 1e-13, 1e-15)
"""Parts of the plate's own compliance that are tried, each from the contact set of the one before; see `Attempt`."""

MOST_POINTS = 6000
"""Lemke works on dense matrices; with more contact points they would no longer fit in memory beside the factor."""

_FEW = 300
"""Elastic points up to which Lemke's algorithm is the quicker one."""

_FEW_IN_AREAS = 500
"""Points of areas up to which it is, rigid ones included."""

_FEW_RIGID = 3000
"""Rigid points, along lines for the most part, up to which it is."""

_CARRIED = 100.0
"""Stiffness that the factor carries at restraining points, over D/a²: about a plate's own under a point load."""


class Lcp(NamedTuple):
    """w = Mz + q with w, z ≥ 0 and zᵀw = 0, over one-sided contact points.

    z is the reaction of ``points`` and w its gap, or the other way round where ``gap_is_z``.
    """

    M: Floats
    q: Floats
    points: Ints
    gap_is_z: Bools


class Attempt(NamedTuple):
    """A way to an answer: a method, the form of its LCP, and where rounding decides, what increments yield by."""

    problem: ContactProblem
    form: Form = "auto"
    part: float | None = None

    def solve(self, load: CaseLoad, progress: Steps, closed: Bools | None) -> _core.ContactSolution:
        """Solve a load; where rounding decides, beginning with a contact set (m,) if there is one."""
        if self.part is None:
            return self.problem.solve(load, self.form, progress)
        return self.problem.solve_carefully(load, self.part, closed, progress)


@dataclass(frozen=True, eq=False)
class ContactProblem:
    """A discretised model on its supports, factored once and condensed onto its contact points.

    Examples
    --------
    >>> from signorini import Model
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     mesh={"divisions": [4, 4]},
    ...     support=[{"edge": ["left"], "fix": "clamped"}, {"at": [[4, 0], [4, 4]], "resists": "down"}],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> problem = contact_problem(model)
    >>> P, s = problem.dual(problem.load("all"))
    >>> answer = _core.lemke(P, -s)
    >>> answer.status, problem.G.shape, bool(np.isclose(*answer.z))
    ('solved', (2, 195), True)
    """

    discretisation: Discretisation
    freedom: RigidFreedom
    core: _core.ContactProblem
    method: Method
    reference: _core.Reference | None = None
    """A solved load that others begin with; see `near`."""
    _others: dict[Method, ContactProblem] = field(default_factory=dict, repr=False)

    @cached_property
    def K(self) -> csc_array:
        """Stiffness (3n, 3n) of plate and springs over every dof, held ones included."""
        from scipy.sparse import csc_array

        start, row, value = self.discretisation.plate.stiffness_matrix(spring_arrays(self.discretisation))
        size = self.discretisation.dof_count
        lower = csc_array((value, row, start), shape=(size, size))
        upper = lower.T.tocsc()
        return csc_array(lower + upper - csc_array((lower.diagonal(), (range(size), range(size))), shape=(size, size)))

    @property
    def G(self) -> csr_array:
        """Contact points' rows (m, 3n); Gu ≤ gaps."""
        return self.discretisation.contact_rows

    @property
    def gaps(self) -> Floats:
        """Free travel (m,) of every contact point, settlement included."""
        return self.discretisation.contacts.distance

    @property
    def compliance(self) -> Floats:
        """Inverse stiffness (m,) of every contact point's support; 0 where it is rigid."""
        return self.discretisation.contacts.compliance

    def load(self, combination: str) -> Floats:
        """Nodal load (3n,) of a combination.

        Raises
        ------
        InputError
            If there is none of that name.
        """
        found = {c.name: c for c in self.discretisation.model.effective_combinations}
        return self.discretisation.load(found[known(combination, found, "combination", "combination")]).nodal

    def lcp(self, load: Floats, form: Form = "auto") -> Lcp:
        """Pose the LCP of one nodal load (3n,).

        "stiffness" has the gaps for unknowns. "dual" has the reactions, but as many gaps as the plate has rigid motions
        that only one-sided supports hold. "auto" takes the better conditioned one: the stiffness form where every
        contact point is at a node of its own, else the dual.

        Raises
        ------
        InputError
            If the load is not 3n finite numbers, or there is no such form.
        """
        load = vector(load, self.discretisation.dof_count, "load")
        known(form, _FORMS, "form", "form", "The LCP")
        core = self.condensed.core
        return Lcp(*core.lcp(load, self.discretisation.held.values, None if form == "auto" else form))

    def dual(self, load: Floats) -> tuple[Floats, Floats]:
        """P (m, m) and s (m,) of the paper's (26) and (27): gap = P·reaction − s.

        Raises
        ------
        SignoriniError
            If one-sided supports alone hold the plate: its K has no inverse.
        """
        if not self.freedom.regular:
            raise SignoriniError(
                "The paper's P and s need K to be regular, but one-sided supports alone hold this plate. "
                'Take lcp(load, "stiffness") or lcp(load, "dual"), which takes a few gaps among its unknowns.'
            )
        posed = self.lcp(load, "dual")
        return posed.M, -posed.q

    @property
    def condensed(self) -> ContactProblem:
        """The same problem with every point condensed, for the LCP."""
        return self.by("lemke")

    def by(self, method: Method) -> ContactProblem:
        """Pose the same problem for another method; it is factored when it is first asked for."""
        known(method, _METHODS, "method", "method", "A contact problem")
        if method not in self._others:
            self._others[method] = _factored(self.discretisation, self.freedom, method)
        return self._others[method]

    def near(self, load: Floats) -> ContactProblem:
        """Pose the same problem for loads not unlike a nodal one (3n,), with whose contact set an active set begins.

        Its solution is found here. Any load has the same answer, sooner or later; without an active set, or a solution,
        and beside points that hold both ways, nothing changes.
        """
        load = vector(load, self.discretisation.dof_count, "load")
        if self.method != "active_set" or self.discretisation.contacts.two_sided.any():
            return self
        return replace(self, reference=self.core.reference(load, self.discretisation.held.values))

    @property
    def fallbacks(self) -> tuple[Method, ...]:
        """Methods that take over, in turn, where this one does not settle; a prescribed one is only the first."""
        if self.discretisation.contacts.two_sided.all():
            return ()
        others: tuple[Method, ...] = ("active_set", "lemke", "interior_point")
        can_be_condensed = len(self.gaps) <= MOST_POINTS
        return tuple(other for other in others if other != self.method and (other != "lemke" or can_be_condensed))

    def attempts(self) -> Iterator[Attempt]:
        """Every way to an answer, in the order in which they are tried until one is certified."""
        start = self
        if self.reference is not None:
            yield Attempt(self)
            start = replace(self, reference=None)
        for method in (self.method, *self.fallbacks):
            problem = start if method == self.method else start.by(method)
            if method != "lemke":
                yield Attempt(problem)
                continue
            yield from (Attempt(problem, form) for form in _FORMS)
            yield from (Attempt(problem, part=part) for part in _YIELDING)
        if "lemke" in self.fallbacks or (self.method == "lemke" and self.fallbacks):
            # What another method has left imprecise.
            yield from (Attempt(start.condensed, part=part) for part in _YIELDING[1:])

    def solve(self, load: CaseLoad, form: Form = "auto", progress: Steps | None = None) -> _core.ContactSolution:
        """Displacements, reactions and gaps of one load.

        ``form`` is that of the LCP where there is one; ``progress`` is called after every step of an active set.
        """
        made_by(load, CaseLoad, _LOAD, "load")
        known(form, _FORMS, "form", "form", "The LCP")
        held = self.discretisation.held.values
        if self.method == "interior_point":
            return self.core.solve_by_interior_point(load.nodal, held, progress=progress)
        if self.reference is not None:
            return self.core.solve_near(self.reference, load.nodal, held, progress=progress)
        return self.core.solve(load.nodal, held, None if form == "auto" else form, progress=progress)

    def solve_carefully(
        self, load: CaseLoad, part: float, closed: Bools | None = None, progress: Steps | None = None
    ) -> _core.ContactSolution:
        """Displacements, reactions and gaps of one load where rounding decides (docs/theory.md, section 6).

        By proximal steps, in which every increment of reaction yields by a part of the plate's own compliance: points
        that nearly repeat each other then share what rounding would decide, and a plate on the brink stays where it is.
        ``closed`` (m,) is a contact set to begin with; ``progress`` is called after every step.
        """
        made_by(load, CaseLoad, _LOAD, "load")
        if not 0.0 < number(part, "part") < np.inf:
            raise InputError(f"found {part:g}; it must be a finite number greater than 0.", place="part")
        held = self.discretisation.held.values
        return self.condensed.core.solve_carefully(load.nodal, held, part, closed, progress)

    @property
    def seconds(self) -> Mapping[str, float]:
        """Seconds spent to assemble, order, factor and condense."""
        order, assemble, factor, condense = self.core.seconds
        return {"order": order, "assemble": assemble, "factor": factor, "condense": condense}


def spring_arrays(found: Discretisation) -> tuple[Ints, Floats, Floats, Floats]:
    """Springs the way the core takes them."""
    springs = found.springs
    return springs.rows.elements, springs.rows.coefficients, springs.stiffness, springs.base


def contact_problem(model: Model | Discretisation) -> ContactProblem:
    """Assemble, factor and condense a model.

    Raises
    ------
    InputError
        If the plate is a mechanism, has more contact points than can be condensed, or cannot be factored.
    SignoriniError
        If it does not fit into memory.
    """
    found = model if isinstance(model, Discretisation) else discretise(model)
    freedom = rigid_freedom(found)
    return _factored(found, freedom, _method(found))


def _require_condensable(points: int, of_all: bool, asked: str) -> None:
    advice = "Take a coarser mesh, or give long lines and areas a stiffness."
    if of_all and asked == "lemke":
        advice = 'Leave solver.method at "auto", which condenses fewer.'
    if points > MOST_POINTS:
        raise InputError(
            f"Found {points} contact points that need condensing; at most {MOST_POINTS} can be. {advice}",
            place="support",
        )
    require_memory_for_points(points, advice, "support")


def _factored(found: Discretisation, freedom: RigidFreedom, method: Method) -> ContactProblem:
    contacts = found.contacts
    # What the interior point method finds is made exact by one of the others.
    many = len(contacts) > MOST_POINTS
    by_active_set = method == "active_set" or (method == "interior_point" and many)
    condensed = int((contacts.two_sided | (not by_active_set)).sum())
    _require_condensable(condensed, not by_active_set, found.model.solver.method)
    # The points of the active set are springs to the condensed ones, and hold what they hold.
    motions = freedom.motions[:, :0] if by_active_set else freedom.motions
    free_motions = motions.T @ (found.rigid_motions / np.array([1.0, found.mesh.size, found.mesh.size])).T
    rows = contacts.rows
    try:
        core = _core.ContactProblem(
            found.plate,
            found.held.dofs,
            spring_arrays(found),
            (
                rows.elements,
                rows.coefficients,
                contacts.distance,
                contacts.compliance,
                contacts.two_sided,
                _regularization(found, freedom),
            ),
            free_motions,
            by_active_set,
        )
    except RuntimeError as error:
        if found.model.plate.element == "q8r":
            raise InputError(
                "q8r bends in some shapes without resistance, and on this mesh the supports do not hold them all. "
                'Take element = "mitc9" or a finer mesh.',
                place="plate.element",
            ) from None
        raise InputError(
            f"The stiffness matrix cannot be factored: {error}. The plate's parts are too unlike for double precision: "
            "see that the thickness, the elements' sides and the stiffnesses of the supports do not differ wildly.",
            place="plate",
        ) from None
    except MemoryError:
        raise SignoriniError("The factor does not fit into memory. Take a coarser mesh.") from None
    return ContactProblem(found, freedom, core, method)


def _regularization(found: Discretisation, freedom: RigidFreedom) -> Floats:
    """Stiffness (m,) that the factor carries at contact points.

    Compliant ones are there with their own, unless they are stiffer than the plate in shear; where one-sided supports
    alone hold the plate, some rigid ones are there too, about as stiff as a plate under a point load.
    """
    contacts, material = found.contacts, found.model.material
    thickness = float(found.thickness.max())
    shear = found.model.plate.shear_factor * material.E * thickness / (2 * (1 + material.nu))
    with np.errstate(divide="ignore"):
        stiffness = np.where(contacts.compliance > 0, 1.0 / contacts.compliance, np.inf)
    carried = np.where(stiffness <= shear, stiffness, 0.0)
    if not freedom.regular:
        rigidity = _CARRIED * material.E * thickness**3 / 12
        needed = np.zeros(len(contacts))
        needed[contacts.two_sided] = rigidity
        needed[restraining_points(freedom, np.minimum(stiffness, rigidity / found.mesh.size**2))] = rigidity
        needed[~contacts.slope] /= found.mesh.size**2
        carried = np.maximum(carried, np.minimum(needed, stiffness))
    return np.asarray(carried)


def _method(found: Discretisation) -> Method:
    """The method asked for, or else the better one; without one-sided points all come to Lemke's without a pivot."""
    asked, contacts = found.model.solver.method, found.contacts
    one_sided = ~contacts.two_sided
    if not one_sided.any():
        return "lemke"
    if asked != "auto":
        return asked
    in_areas = np.array([support.area is not None for support in found.model.support])[contacts.support]
    elastic, areal = contacts.compliance[one_sided] > 0, in_areas[one_sided]
    many = elastic.sum() > _FEW or areal.sum() > _FEW_IN_AREAS or len(areal) > _FEW_RIGID
    return "active_set" if many else "lemke"
