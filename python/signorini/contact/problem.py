"""The contact problem of a model as plain arrays: K, G, gaps, the paper's P and s, and the LCP in any of its forms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias

import numpy as np

from signorini import _core
from signorini.base.arguments import known, made_by, number, vector
from signorini.base.memory import require_memory_for_interior_point, require_memory_for_proximal_steps
from signorini.base.remade import Remade
from signorini.contact.answer import Answer
from signorini.contact.dependence import repeats_itself
from signorini.contact.factoring import Method, base_of, core_problem, factored, method_of, regularization
from signorini.contact.selection import chosen
from signorini.discretise import CaseLoad, Discretisation, discretise
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.equilibrium.balance import RigidFreedom, rigid_freedom
from signorini.errors import InputError, SignoriniError
from signorini.model import Model

if TYPE_CHECKING:
    from scipy.sparse import csc_array, csr_array

Form = Literal["auto", "dual", "stiffness"]

Steps: TypeAlias = Callable[[int, int, float], object]
"""Called with a step's number, the contact points it changed and its relative imbalance; what it raises ends it."""

_FORMS: tuple[Form, ...] = ("auto", "stiffness", "dual")
_METHODS: tuple[Method, ...] = ("lemke", "active_set", "interior_point")
_LOAD = "Take discretisation.load(combination) or one of discretisation.cases."
"""How to come by a load with its nodal forces and curvatures."""


class Lcp(NamedTuple):
    """w = Mz + q with w, z ≥ 0 and zᵀw = 0, over one-sided contact points.

    Two-sided points, whose reaction may have either sign, are eliminated.

    Parameters
    ----------
    M : (k, k) array
    q : (k,) array
    points : (k,) array
        Contact point of each row, a row of the problem's G.
    gap_is_z : (k,) array
        Rows that are exchanged: there z is the gap and w the reaction; elsewhere z is the reaction and w the gap.
    """

    M: Floats
    q: Floats
    points: Ints
    gap_is_z: Bools

    def contact(self, z: Floats) -> tuple[Floats, Floats]:
        """Reactions (k,) and gaps (k,) of ``points``, given z (k,); z need not solve the problem.

        `ContactProblem.recover` gives those of two-sided points too, and the displacements.
        """
        w = self.M @ z + self.q
        return np.where(self.gap_is_z, w, z), np.where(self.gap_is_z, z, w)


@dataclass(frozen=True, eq=False, repr=False)
class ContactProblem(Remade):
    """A discretised model on its supports, factored once and condensed onto its contact points.

    Examples
    --------
    >>> from signorini import Model, lemke
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     mesh={"divisions": [4, 4]},
    ...     support=[{"edge": ["left"], "fix": "clamped"}, {"at": [[4, 0], [4, 4]], "resists": "down"}],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> problem = contact_problem(model)
    >>> P, s = problem.dual(problem.load("all"))
    >>> answer = lemke(P, -s)
    >>> answer.status, problem.G.shape, bool(np.isclose(*answer.z))
    ('solved', (2, 195), True)
    """

    discretisation: Discretisation
    freedom: RigidFreedom
    method: Method
    reference: _core.Reference | None = None
    """A solved load that others begin with; see `near`."""
    _cores: dict[Method, _core.ContactProblem] = field(default_factory=dict, repr=False)
    """Those of all methods that have been asked for, by what they are factored for; see `by`."""

    _made = MappingProxyType(
        {
            # It saves an active set some steps and changes no answer.
            "reference": lambda problem: None,
            "_cores": lambda problem: {},
        }
    )

    @property
    def core(self) -> _core.ContactProblem:
        """The plate factored for the method, and its contact points."""
        base = base_of(self.discretisation, self.method)
        if base not in self._cores:
            self._cores[base] = factored(self.discretisation, self.freedom, base)
        return self._cores[base]

    @property
    def is_factored(self) -> bool:
        """Whether there is a core already."""
        return base_of(self.discretisation, self.method) in self._cores

    @cached_property
    def K(self) -> csc_array:
        """Stiffness (3n, 3n) of plate and springs over every dof, held ones included."""
        from scipy.sparse import csc_array

        start, row, value = self.discretisation.plate.stiffness_matrix(self.discretisation.springs.arrays)
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

        "stiffness" has the gaps for unknowns. "dual" has the reactions, but gaps at points whose stiffness the factor
        carries: elastic ones softer than the plate in shear and, where one-sided supports alone hold the plate, as many
        as it has rigid motions. ``gap_is_z`` marks them. "auto" takes the better conditioned one, `better_form`.

        Raises
        ------
        InputError
            If the load is not 3n finite numbers, or there is no such form.
        SignoriniError
            If there is no "stiffness" form: rigid points repeat each other, and no reactions belong to some gaps.

        Examples
        --------
        A beam of plate on a soft spring that only pushes; the factor carries it, so that its gap is the unknown.

        >>> from signorini import Model, lemke
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 1], "thickness": 0.2},
        ...     mesh={"divisions": [4, 1]},
        ...     support=[{"edge": "left", "fix": "clamped"}, {"at": [4, 0.5], "resists": "down", "stiffness": 1e6}],
        ...     load=[{"pressure": 5e3}],
        ... )
        >>> problem = contact_problem(model)
        >>> load = problem.load("all")
        >>> posed = problem.lcp(load, "dual")
        >>> answer = lemke(posed.M, posed.q)
        >>> reaction, gap = posed.contact(answer.z)
        >>> refined = problem.recover(load, posed, answer.z)
        >>> posed.gap_is_z.tolist(), gap.tolist(), bool(np.isclose(reaction, refined.reaction).all())
        ([True], [0.0], True)
        """
        load = vector(load, self.discretisation.dof_count, "load")
        known(form, _FORMS, "form", "form", "The LCP")
        held = self.discretisation.held.values
        posed = Lcp(*self.condensed.core.lcp(load, held, self.better_form if form == "auto" else form))
        if not np.isfinite(posed.M).all() or (form == "stiffness" and repeats_itself(self.discretisation)):
            raise SignoriniError(
                "This problem has no such form: rigid points repeat each other, so that their gaps cannot be chosen "
                'freely. Take form "dual", whose unknowns are reactions.'
            )
        return posed

    @cached_property
    def better_form(self) -> Literal["dual", "stiffness"]:
        """The better conditioned form of the LCP: "stiffness" where every contact point is at a node of its own."""
        rows = self.G[:, ~self.discretisation.held.dofs]
        rows.eliminate_zeros()
        alone = (np.diff(rows.indptr) == 1).all() and len(np.unique(rows.indices)) == rows.nnz
        return "stiffness" if alone else "dual"

    def recover(self, load: Floats, posed: Lcp, z: Floats) -> _core.ContactSolution:
        """Displacements (3n,), and reactions and gaps (m,) of every contact point, from a solution z (k,) of the LCP.

        They are solved for on the contact set that z stands for, and refined; `_core.ContactSolution.status` is
        "unsolved" where that set does not hold the plate, or not in one way.
        """
        reaction, gap = posed.contact(z)
        closed = self.discretisation.contacts.two_sided.copy()
        largest = [np.abs(values).max(initial=0.0) or 1.0 for values in (reaction, gap)]
        closed[posed.points] = reaction / largest[0] > gap / largest[1]
        return self.condensed.core.solve_on(load, self.discretisation.held.values, closed)

    def dual(self, load: Floats) -> tuple[Floats, Floats]:
        """P (m, m) and s (m,) of the paper's (26) and (27), over every row of ``G``: gap = P·reaction − s.

        P = G K⁻¹ Gᵀ + C and s = G K⁻¹ f − g with K of the plate, held dofs and springs, but of no contact point,
        whatever stiffness that has; C is `compliance` on the diagonal. Where held dofs have values, K⁻¹ f is the
        displacement under the load with these values. Two-sided points are among the rows: their gap is 0 and their
        reaction has either sign, so where there are any, P and −s are not yet an LCP. That of `lcp` has eliminated
        them.

        Raises
        ------
        InputError
            If the load is not 3n finite numbers.
        SignoriniError
            If K has no inverse: one-sided supports, or two-sided points between nodes, alone hold the plate.
        """
        if not self.freedom.regular:
            raise SignoriniError(
                "The paper's P and s need K to be regular, but one-sided supports, or points between nodes, alone hold "
                'this plate. Take lcp(load, "stiffness") or lcp(load, "dual"), which takes a few gaps among its '
                "unknowns."
            )
        load = vector(load, self.discretisation.dof_count, "load")
        held = self.discretisation.held.values
        matrix, q, _, _ = self._bare.lcp(load, held, "dual")
        return matrix, -q

    @cached_property
    def _bare(self) -> _core.ContactProblem:
        """All points condensed as one-sided ones onto a factor that carries none of them."""
        found = self.discretisation
        points = found.contacts
        if points.two_sided.any() or regularization(found, self.freedom).any():
            one_sided = replace(points, two_sided=np.zeros(len(points), np.bool_))
            return core_problem(found, one_sided, np.zeros(len(points)), self.freedom.motions[:, :0], False)
        return self.condensed.core

    @property
    def condensed(self) -> ContactProblem:
        """The same problem with every point condensed, for the LCP."""
        return self.by("lemke")

    def by(self, method: Method) -> ContactProblem:
        """Pose the same problem for another method; it is factored when that is first needed, and once for all."""
        known(method, _METHODS, "method", "method", "A contact problem")
        return self if method == self.method else replace(self, method=method, reference=None)

    def near(self, load: Floats) -> ContactProblem:
        """Pose the same problem for loads not unlike a nodal one (3n,), with whose contact set an active set begins.

        Its solution is found here. Any load has the same answer, sooner or later; without an active set, or a solution,
        and beside points that hold both ways, nothing changes.
        """
        load = vector(load, self.discretisation.dof_count, "load")
        if self.method != "active_set" or self.discretisation.contacts.two_sided.any():
            return self
        return replace(self, reference=self.core.reference(load, self.discretisation.held.values))

    def solve(self, load: CaseLoad, form: Form = "auto", progress: Steps | None = None) -> Answer:
        """Displacements, reactions and gaps of one load; of answers that are equally right the least.

        ``form`` is that of the LCP where there is one; ``progress`` is called after every step of an active set, and
        now and then by other methods.
        """
        made_by(load, CaseLoad, _LOAD, "load")
        known(form, _FORMS, "form", "form", "The LCP")
        held = self.discretisation.held.values
        if self.method == "interior_point":
            require_memory_for_interior_point(len(load.nodal), len(self.gaps))
            solution = self.core.solve_by_interior_point(load.nodal, held, progress=progress)
        elif self.reference is not None:
            solution = self.core.solve_near(self.reference, load.nodal, held, progress=progress)
        else:
            form = self.better_form if form == "auto" else form
            solution = self.core.solve(load.nodal, held, form, progress=progress)
        return self._chosen(load, solution)

    def solve_by_proximal_steps(
        self, load: CaseLoad, part: float, closed: Bools | None = None, progress: Steps | None = None
    ) -> Answer:
        """Displacements, reactions and gaps of one load where rounding decides (docs/theory.md, section 6).

        By proximal steps, in which every increment of reaction yields by a part of the plate's own compliance: points
        that nearly repeat each other then share what rounding would decide, and a plate on the brink stays where it is.
        ``closed`` (m,) is a contact set to begin with; ``progress`` is called after every step.
        """
        made_by(load, CaseLoad, _LOAD, "load")
        if not 0.0 < number(part, "part") < np.inf:
            raise InputError(f"found {part:g}; it must be a finite number greater than 0.", place="part")
        require_memory_for_proximal_steps(len(load.nodal), len(self.gaps))
        held = self.discretisation.held.values
        return self._chosen(load, self.condensed.core.solve_by_proximal_steps(load.nodal, held, part, closed, progress))

    def _chosen(self, load: CaseLoad, solution: _core.ContactSolution) -> Answer:
        return chosen(self.discretisation, self.freedom, load.nodal, Answer.of(self.discretisation, solution))

    @property
    def seconds(self) -> Mapping[str, float]:
        """Seconds spent to assemble, order, factor and condense."""
        order, assemble, factor, condense = self.core.seconds
        return {"order": order, "assemble": assemble, "factor": factor, "condense": condense}


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
    method = method_of(found)
    base = base_of(found, method)
    return ContactProblem(found, freedom, method, _cores={base: factored(found, freedom, base)})
