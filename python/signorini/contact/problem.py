"""The contact problem of a model: its arrays, its factor, the paper's P and s, its LCP in any form, its answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csc_array, csr_array

from signorini import _core
from signorini.base.arguments import checked, known, made_by, vector
from signorini.base.arguments import points as points_of_plate
from signorini.base.remade import Remade
from signorini.contact.factoring import Method, core_problem, factored, method_of, regularization
from signorini.contact.lcp import Lcp, lcp_of
from signorini.contact.selection import Answer, chosen
from signorini.discretise import CaseLoad, Discretisation, discretise
from signorini.discretise.rows import Bools, Floats, Rows
from signorini.equilibrium.balance import RigidFreedom, rigid_freedom
from signorini.errors import InputError, SignoriniError
from signorini.mesh import Mesh
from signorini.model import Model

_PARTS = ("w", "θx", "θy")
_NO_PART = 1e-14
"""Zero tolerance for interpolation coefficients, whose sum is 1; a location in an element is rounded by about this."""
Form = Literal["auto", "dual", "stiffness"]
Steps: TypeAlias = Callable[[int, int, float], object]
"""Function called with the number of a step, the number of points that changed in it, and the relative residual.

An exception in this function ends the solution.
"""
_FORMS: tuple[Form, ...] = ("auto", "stiffness", "dual")
_METHODS: tuple[Method, ...] = ("lemke", "active_set", "saddle")
_NOT_OUTLINE = {"thickness", "element", "shear_factor"}
"""Keys of ``plate`` that may differ between models on the same mesh."""
_LOAD = "Take discretisation.load(combination) or one of discretisation.cases."
"""Advice in messages on how to make a load that contains nodal forces and curvatures."""


class Statement:
    """The arrays of a discretised model, without any factor."""

    discretisation: Discretisation

    @cached_property
    def K(self) -> csc_array:
        """Stiffness (3n, 3n) of plate and springs over all dofs, including held dofs."""
        start, row, value = self.discretisation.plate.stiffness_matrix(self.discretisation.springs.arrays)
        size = self.discretisation.dof_count
        lower = csc_array((value, row, start), shape=(size, size))
        upper = lower.T.tocsc()
        return csc_array(lower + upper - csc_array((lower.diagonal(), (range(size), range(size))), shape=(size, size)))

    @property
    def G(self) -> csr_array:
        """Rows (m, 3n) of the contact points; Gu ≤ gaps."""
        return self.discretisation.contact_rows

    @property
    def gaps(self) -> Floats:
        """Bounds g (m,) of Gu: free travel of every contact point plus the settlement of its support's base."""
        return self.discretisation.contacts.distance

    @property
    def settlements(self) -> Floats:
        """Settlement (m,) of each point's base along its row of G; `gaps` − settlement is the free travel ≥ 0."""
        return self.discretisation.contacts.settlement

    @property
    def two_sided(self) -> Bools:
        """Whether each contact point (m,) has a straight law, Gu − Cλ = gaps, with a reaction of either sign."""
        return self.discretisation.contacts.two_sided

    @property
    def compliance(self) -> Floats:
        """Diagonal (m,) of C, the inverse stiffness of every contact point; 0 where the support is rigid."""
        return self.discretisation.contacts.compliance

    @property
    def limits(self) -> tuple[Floats, Floats]:
        """Least and largest reaction (m,) of every contact point; infinite where the reaction is unlimited."""
        return self.discretisation.contacts.limits

    @property
    def positions(self) -> Floats:
        """Position (m, 2) of every contact point."""
        return self.discretisation.contacts.positions

    @property
    def mesh(self) -> Mesh:
        """Nodes, ``mesh.points`` (n, 2), and elements, ``mesh.elements`` (ne, 8); see `signorini.mesh.Mesh`."""
        return self.discretisation.mesh

    @property
    def held(self) -> Bools:
        """Mask (3n,) of dofs that supports hold at `held_values`."""
        return self.discretisation.held.dofs

    @property
    def held_values(self) -> Floats:
        """Prescribed values (3n,) of held dofs, the paper's u₀: settlements and rotations; 0 at other dofs."""
        return self.discretisation.held.values

    @property
    def frames(self) -> Floats:
        """Unit vectors (n, 2) of each node's first slope; its second slope is a quarter turn from them.

        They are [1, 0], for the slopes θx and θy, except at nodes of oblique edges that hold one slope.
        """
        frames = self.discretisation.held.frames
        return np.broadcast_to([1.0, 0.0], (self.mesh.node_count, 2)) if frames is None else frames

    def rows_at(self, points: ArrayLike, of: Literal["w", "θx", "θy"] = "w") -> csr_array:
        """Rows (q, 3n) that map displacements to the deflection, or a slope, at points (q, 2) of the plate.

        Between nodes, rows of slopes of `mitc9` include the element's eliminated internal dofs, but not loads on these
        dofs.

        Raises
        ------
        InputError
            If a point is not on the plate, or ``of`` is not one of the three names.

        Examples
        --------
        >>> from signorini import Model, contact_problem
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        ...     mesh={"divisions": [2, 2]},
        ...     support=[{"edge": "left", "fix": "clamped"}],
        ...     load=[{"pressure": 5e3}],
        ... )
        >>> rows = contact_problem(model).rows_at([[4, 2], [1.3, 0.7]])
        >>> rows.shape, rows.sum(axis=1).round(12).tolist(), rows[[0]].nnz
        ((2, 63), [1.0, 1.0], 1)
        """
        known(of, _PARTS, "part", "of", "A displacement")
        _require_one_plate(self.discretisation, "rows_at")
        result, positions = self.discretisation, points_of_plate(points)
        where = result.mesh.locate(positions)
        if not where.inside.all():
            x, y = positions[np.argmin(where.inside)]
            raise InputError(f"the point [{x:g}, {y:g}] is not on the plate.", place="points")
        coefficients, _ = result.plate.interpolation_rows(where.elements, where.xi, _PARTS.index(of))
        coefficients[np.abs(coefficients) < _NO_PART] = 0.0
        return Rows(where.elements, coefficients).matrix(result.mesh.elements, result.dof_count)

    def load(self, combination: str) -> Floats:
        """Nodal load (3n,) of a combination.

        Raises
        ------
        InputError
            If there is no combination of this name.
        """
        result = {c.name: c for c in self.discretisation.model.effective_combinations}
        return self.discretisation.load(result[known(combination, result, "combination", "combination")]).nodal


@checked
@dataclass(frozen=True, eq=False, repr=False)
class ContactProblem(Statement, Remade):
    """A discretised model on its supports, factored once and condensed onto its contact points.

    Dof 3i is the deflection w of node i of `mesh`, positive down; 3i + 1 and 3i + 2 are its slopes θx ≈ ∂w/∂x and θy ≈
    ∂w/∂y, or, where an oblique edge holds one slope, the slopes along its `frames`. `K`, `G` and loads go over every
    dof in this order, which depends on the mesh alone; `held` marks dofs with prescribed values. Loads are
    work-conjugate: forces down on w, couples on slopes.

    Contact points are the rows of `G`, support by support in the order of the model: +w where the support pushes up, −w
    where it holds down; with travel in both directions the rows that push up are first. The unknowns of contact points
    are reactions λ and gaps ρ = `gaps` − Gu + `compliance`·λ. Without a limit, λ ≥ 0, ρ ≥ 0 and λρ = 0. With a limit, λ
    is also at most the upper one of `limits`; where it equals this limit, ρ ≤ 0 is minus the yield travel. Two-sided
    points, marked by `two_sided`, have ρ = 0 and λ of either sign.

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
    reference: _core.ContactSolution | None = None
    """Solution of another load; the active set starts from the contact set of this solution, see `near`."""
    unmoved: ContactProblem | None = None
    """The problem with other gaps g whose factor this problem uses; see `moved`."""
    _cores: dict[str, _core.ContactProblem] = field(default_factory=dict, repr=False)
    """The core's factored problems by method; each is made when it is first needed.

    The factor of "dual" includes no contact point, see `_bare`.
    """

    _made = MappingProxyType(
        {
            # ``reference`` is not pickled: it only saves the active set some steps and changes no answer.
            "reference": lambda problem: None,
            "_cores": lambda problem: {},
        }
    )

    @property
    def core(self) -> _core.ContactProblem:
        """The core's problem for the method, factored on first access."""
        method, result = self.method, self.discretisation
        if method not in self._cores:
            self._cores[method] = (
                factored(result, self.freedom, method)
                if self.unmoved is None
                else self.unmoved.by(method).core.with_distance(result.contacts.distance)
            )
        return self._cores[method]

    def without_factor(self) -> ContactProblem:
        """Copy of the problem without its factor, which is computed again on first access."""
        unmoved = None if self.unmoved is None else self.unmoved.without_factor()
        return replace(self, reference=None, unmoved=unmoved, _cores={})

    def moved(self, discretisation: Discretisation) -> ContactProblem:
        """Pose the problem of a discretisation that differs in g alone; it uses the factor of this problem."""
        return replace(self, discretisation=discretisation, reference=None, unmoved=self, _cores={})

    @property
    def is_factored(self) -> bool:
        """Whether the factor for this problem's method is already computed."""
        return self.method in self._cores or (self.unmoved is not None and self.unmoved.by(self.method).is_factored)

    def lcp(self, load: Floats, form: Form = "auto") -> Lcp:
        """Pose the LCP of one nodal load (3n,).

        "stiffness" has the gaps as unknowns z. "dual" has the reactions as z, except at points whose stiffness the
        factor includes: there z is the gap, and ``gap_is_z`` is True. The factor includes elastic points softer than
        the plate in shear, without footprint. If one-sided supports alone hold the plate, it also includes as many
        points as the plate has rigid motions. "auto" takes the better conditioned form, `better_form`.

        Raises
        ------
        InputError
            If the load is not 3n finite numbers, or there is no such form.
        SignoriniError
            If there is no "stiffness" form: rows of rigid points are linearly dependent, so that some gaps belong to no
            reactions.

        Examples
        --------
        A strip of plate on a soft spring that only pushes; the factor includes it, so that its gap is the unknown.

        >>> from signorini import Model, lemke, recover
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
        >>> reactions, gaps = posed.contact(answer.z)
        >>> result = recover(problem, "all", reactions)
        >>> posed.gap_is_z.tolist(), gaps.tolist(), bool(np.isclose(reactions[0], result.reactions["support 2"]))
        ([True], [0.0], True)
        """
        load = vector(load, self.discretisation.dof_count, "load")
        known(form, _FORMS, "form", "form", "The LCP")
        held = self.discretisation.held.values
        given = self.condensed.core.lcp(load, held, self.better_form if form == "auto" else form)
        posed = lcp_of(*given, self.discretisation.contacts)
        if not np.isfinite(posed.M).all() or (form == "stiffness" and self.discretisation.repeats_itself):
            raise SignoriniError(
                "This problem has no such form: rigid points repeat each other, so that their gaps cannot be chosen "
                'freely. Take form "dual", whose unknowns are reactions.'
            )
        return posed

    @cached_property
    def better_form(self) -> Literal["dual", "stiffness"]:
        """The better conditioned form of the LCP: "stiffness" if each contact point is at its own node, else "dual"."""
        rows = self.G
        free = ~self.discretisation.held.dofs[rows.indices] & (rows.data != 0.0)
        if np.count_nonzero(free) != len(self.gaps):
            return "dual"
        many = np.diff(np.concatenate([[0], np.cumsum(free)])[rows.indptr])
        alone = (many == 1).all() and len(np.unique(rows.indices[free])) == len(many)
        return "stiffness" if alone else "dual"

    def dual(self, load: Floats) -> tuple[Floats, Floats]:
        """P (m, m) and s (m,) of the paper's (26) and (27), over every row of ``G``: gap = P·reaction − s.

        P = G K⁻¹ Gᵀ + C and s = G K⁻¹ f − g, with K of the plate, held dofs and springs, without contact points; C is
        `compliance` on the diagonal. Where held dofs have prescribed values, K⁻¹ f is the displacement under the load
        with these values. Two-sided points are among the rows: their gap is 0 and their reaction has either sign. P and
        −s are therefore an LCP only without two-sided points; `lcp` eliminates them. P and s contain only the
        compliance C of a law. A point at its `limits` has a gap below 0, minus its yield travel, and the solution of
        ``lemke(P, -s)`` may exceed the limit. `lcp` has a row for each vertex of such a law.

        Raises
        ------
        InputError
            If the load is not 3n finite numbers.
        SignoriniError
            If K has no inverse: one-sided supports, or two-sided points between nodes, alone hold the plate.
        """
        self._require_regular()
        load = vector(load, self.discretisation.dof_count, "load")
        held = self.discretisation.held.values
        matrix, q, _, _ = self._bare.lcp(load, held, "dual")
        return matrix, -q

    def free(self, load: Floats, held: bool = True) -> Floats:
        """Displacements (3n,) under a nodal load (3n,) without contact points: K⁻¹ f, with held dofs at their values.

        Without ``held`` these values are 0.

        Raises
        ------
        InputError
            If the load is not 3n finite numbers.
        SignoriniError
            If K has no inverse, as for `dual`.
        """
        self._require_regular()
        load = vector(load, self.discretisation.dof_count, "load")
        values = self.held_values if held else np.zeros_like(load)
        solution = self._bare.solve_on(load, values, np.zeros(len(self.gaps), np.uint8))
        return solution.hi + solution.lo

    def _require_regular(self) -> None:
        if not self.freedom.regular:
            raise SignoriniError(
                "The paper's P and s need K to be regular, but one-sided supports, or points between nodes, alone hold "
                'this plate. Take lcp(load, "stiffness") or lcp(load, "dual"), which takes a few gaps among its '
                "unknowns."
            )

    @property
    def _bare(self) -> _core.ContactProblem:
        """The core's problem for `dual`: all points count as one-sided, and the factor includes no point's stiffness.

        Subtracting stiffnesses from the solver's factor would lose the digits by which they exceed the plate's
        stiffness.
        """
        result, points = self.discretisation, self.discretisation.contacts
        pushing = all(law.only_pushes for law, _ in points.by_law)
        if pushing and not regularization(result, self.freedom).any():
            return self.condensed.core
        if "dual" not in self._cores and self.unmoved is not None:
            self._cores["dual"] = self.unmoved._bare.with_distance(points.distance)
        if "dual" not in self._cores:
            one_sided = replace(points, laws=tuple(law.pushing for law in points.laws))
            motions = self.freedom.motions[:, :0]
            self._cores["dual"] = core_problem(result, one_sided, np.zeros(len(points)), motions, "lemke")
        return self._cores["dual"]

    @property
    def condensed(self) -> ContactProblem:
        """The same problem for Lemke's algorithm, with the plate condensed onto all contact points."""
        return self.by("lemke")

    def by(self, method: Method) -> ContactProblem:
        """Pose the same problem for another method; its factor is computed on first access and kept."""
        known(method, _METHODS, "method", "method", "A contact problem")
        return self if method == self.method else replace(self, method=method, reference=None)

    def with_model(self, model: Model) -> ContactProblem:
        """Pose another model on the same mesh, for a sweep over gaps, stiffnesses, supports, thickness or loads.

        Dofs and the order of all arrays stay, even if the other model alone would be meshed along other lines. The
        contact points stay if the supports stay in place. Loads, gaps and settlements of contact points do not change
        P. They change s, which decreases by the increase of `gaps`.

        Raises
        ------
        InputError
            If the other model's plate has another outline, or for the reasons given in `contact_problem`.

        Examples
        --------
        >>> from signorini import Model, lemke
        >>> def slab(stiffness):
        ...     return Model(
        ...         material={"E": 30e9, "nu": 0.2},
        ...         plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        ...         mesh={"divisions": [4, 4]},
        ...         support=[
        ...             {"edge": "left", "fix": "clamped"},
        ...             {"at": [4, 2], "resists": "down", "stiffness": stiffness},
        ...         ],
        ...         load=[{"pressure": 5e3}],
        ...     )
        >>> first = contact_problem(slab(1e5))
        >>> for stiffness in (1e5, 1e6, 1e7):
        ...     problem = first.with_model(slab(stiffness))
        ...     P, s = problem.dual(problem.load("all"))
        ...     print(problem.mesh is first.mesh, round(lemke(P, -s).z[0], -1))
        True 760.0
        True 6150.0
        True 21060.0
        """
        made_by(model, Model, "Make one with signorini.Model(...) or signorini.load(file).", "model")
        _require_one_plate(self.discretisation, "with_model")
        mine = self.discretisation.model.plate
        if model.plate.model_dump(exclude=_NOT_OUTLINE) != mine.model_dump(exclude=_NOT_OUTLINE):
            raise InputError(
                "found another outline than that of this problem's plate; only thickness, element and shear_factor may "
                "differ. Take contact_problem(model).",
                place="plate",
            )
        return contact_problem(discretise(model, self.mesh))

    def near(self, load: Floats, progress: Steps | None = None) -> ContactProblem:
        """Pose the same problem for loads similar to ``load`` (3n,), from whose contact set the active set starts.

        ``load`` is solved here. The start changes no answer. The start is ignored by other methods, if ``load`` has no
        solution, and if a support has ``resists = "both"``. ``progress`` is as for `solve`.
        """
        load = vector(load, self.discretisation.dof_count, "load")
        if self.method != "active_set" or self.discretisation.contacts.two_sided.any():
            return self
        return replace(self, reference=self.core.solve_and_factor(load, self.discretisation.held.values, progress))

    def solve(
        self, load: CaseLoad, form: Form = "auto", progress: Steps | None = None, start: Answer | None = None
    ) -> Answer:
        """Solve one load; among several answers that satisfy all conditions, return the one of least norm.

        ``form`` is the form of the LCP; methods without an LCP ignore it. ``progress`` is called after every step of an
        active set, and now and then by other methods. ``start`` is the answer to another load of this problem, from
        whose contact set the method begins.
        """
        made_by(load, CaseLoad, _LOAD, "load")
        known(form, _FORMS, "form", "form", "The LCP")
        if start is not None:
            made_by(start, Answer, "Take an answer that solve returned for another load.", "start")
        held = self.discretisation.held.values
        form = self.better_form if form == "auto" else form
        near = self.reference if start is None else start.solution
        try:
            solution = self.core.solve(load.nodal, held, form, near, progress)
        except ValueError as error:
            if near is None:
                raise
            raise InputError(f"{error}.", place="start") from None
        answer = Answer.of(self.discretisation, solution)
        return chosen(self.discretisation, self.freedom, load.nodal, answer)

    @property
    def seconds(self) -> Mapping[str, float]:
        """Seconds spent on ordering, factorization and condensation, by name."""
        order, factor, condense = self.core.seconds
        return {"order": order, "factor": factor, "condense": condense}


@checked
def contact_problem(model: Model | Discretisation) -> ContactProblem:
    """Assemble, factor and condense a model.

    Raises
    ------
    InputError
        If the plate is a mechanism, has more contact points than can be condensed, or cannot be factored.
    SignoriniError
        If the problem does not fit into memory.
    """
    problem = unfactored(model if isinstance(model, Discretisation) else discretise(model))
    return replace(problem, _cores={problem.method: factored(problem.discretisation, problem.freedom, problem.method)})


def unfactored(discretisation: Discretisation) -> ContactProblem:
    """Pose a problem whose factor is computed on first access."""
    return ContactProblem(discretisation, rigid_freedom(discretisation), method_of(discretisation), _cores={})


def _require_one_plate(discretisation: Discretisation, what: str) -> None:
    if discretisation.plates:
        raise InputError(f"{what} is for models of one plate; found several plates.", place="plates")
