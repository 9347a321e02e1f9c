"""A contact problem with additional rows of G: linear bounds on displacements that are no supports of the model."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array, issparse, sparray, vstack

from signorini.base.arguments import array, checked, made_by
from signorini.base.remade import Brief
from signorini.contact.lcp import lemke
from signorini.contact.problem import ContactProblem
from signorini.discretise.rows import Bools, Floats
from signorini.errors import InputError

_REPEATED = 1e-10
"""Largest eigenvalue of P over two-sided rows, scaled to a diagonal of 1, at which these rows count as dependent."""


@checked
@dataclass(frozen=True, eq=False, repr=False)
class RowProblem(Brief):
    """The contact problem of a model with additional rows of G after those of its contact points; see `with_rows`.

    Parameters
    ----------
    problem : ContactProblem
    rows : (r, 3n) sparse array
    row_gaps, row_compliance : (r,) arrays
    row_two_sided : (r,) array of bool
    """

    problem: ContactProblem
    rows: csr_array
    row_gaps: Floats
    row_compliance: Floats
    row_two_sided: Bools

    @cached_property
    def G(self) -> csr_array:
        """Rows G (m + r, 3n) of the model's contact points, followed by the additional rows, with Gu ≤ gaps."""
        return csr_array(vstack([self.problem.G, self.rows]))

    @property
    def gaps(self) -> Floats:
        """Upper bounds (m + r,) of Gu, contact points first."""
        return np.concatenate([self.problem.gaps, self.row_gaps])

    @property
    def compliance(self) -> Floats:
        """Diagonal (m + r,) of C, the inverse stiffness of every row; 0 for a rigid row."""
        return np.concatenate([self.problem.compliance, self.row_compliance])

    @property
    def two_sided(self) -> Bools:
        """Whether each row (m + r,) is an equation, with a reaction of either sign."""
        return np.concatenate([self.problem.two_sided, self.row_two_sided])

    def dual(self, load: Floats) -> tuple[Floats, Floats]:
        """P (m + r, m + r) and s (m + r,) of one nodal load (3n,): gap = P·reaction − s, as `ContactProblem.dual`.

        Raises
        ------
        InputError
            If the load is not 3n finite numbers.
        """
        matrix, s = self.problem.dual(load)
        coupling = self.problem.G @ self._moved
        block = self.rows @ self._moved
        whole = np.block([[matrix, coupling], [coupling.T, 0.5 * (block + block.T) + np.diag(self.row_compliance)]])
        return whole, np.concatenate([s, self.rows @ self.problem.free(load) - self.row_gaps])

    @cached_property
    def _moved(self) -> Floats:
        """Displacements K⁻¹ Gᵀ (3n, r) per unit reaction of the additional rows."""
        columns = [self.problem.free(self.rows[[i]].toarray()[0], held=False) for i in range(self.rows.shape[0])]
        return np.column_stack(columns) if columns else np.zeros((self.rows.shape[1], 0))

    def solve(self, load: Floats) -> Floats:
        """Reactions (m + r,) under one nodal load (3n,), by Lemke's algorithm after two-sided rows are eliminated.

        `signorini.recover` computes a certified result from the reactions.

        Raises
        ------
        InputError
            If no displacements satisfy all rows, or two-sided rows are linearly dependent.
        """
        matrix, s = self.dual(load)
        two_sided, one_sided = self.two_sided, ~self.two_sided
        matrix_two_sided = matrix[np.ix_(two_sided, two_sided)]
        unit = 1.0 / np.sqrt(np.diag(matrix_two_sided))
        least_eigenvalue = np.linalg.eigvalsh(matrix_two_sided * unit * unit[:, None])[:1]
        if not (least_eigenvalue > _REPEATED).all():
            raise InputError("two-sided rows repeat each other. Leave out rows that are combinations of others.", "G")
        eliminated = np.linalg.solve(
            matrix_two_sided, np.column_stack([matrix[np.ix_(two_sided, one_sided)], s[two_sided]])
        )
        coupled = matrix[np.ix_(one_sided, two_sided)]
        answer = lemke(
            matrix[np.ix_(one_sided, one_sided)] - coupled @ eliminated[:, :-1],
            coupled @ eliminated[:, -1] - s[one_sided],
            max_pivots=None,
        )
        if answer.status != "solved":
            raise InputError(
                "rows contradict each other: no displacements satisfy all of them. Correct a gap, or give a "
                "flexibility.",
                place="G",
            )
        reactions = np.zeros(len(s))
        reactions[one_sided] = answer.z
        reactions[two_sided] = eliminated[:, -1] - eliminated[:, :-1] @ answer.z
        return reactions


@checked
def with_rows(
    problem: ContactProblem,
    G: ArrayLike | sparray,
    gaps: ArrayLike,
    two_sided: ArrayLike | None = None,
    flexibility: ArrayLike | None = None,
) -> RowProblem:
    """Add rows to those of a model's contact points: G u − C λ ≤ g, with reactions λ ≥ 0 that act as −Gᵀλ.

    A row may couple any dofs: the difference of two deflections, a mean, a slope. `ContactProblem.rows_at` returns rows
    of the deflection or a slope at points. In results the reactions of additional rows count as loads.

    Parameters
    ----------
    problem : ContactProblem
        The problem's K must be regular: held dofs, springs and two-sided points at nodes hold the plate without the
        added rows.
    G : (r, 3n) array_like or sparse array
        Columns are dofs, in the order and the nodal axes that `ContactProblem` documents.
    gaps : (r,) array_like
        g, in the units of G u: lengths if G has deflections with coefficients of 1.
    two_sided : (r,) array_like of bool, optional
        Rows that are equations, G u − C λ = g, with λ of either sign; all False by default.
    flexibility : (r,) array_like, optional
        Diagonal of C ≥ 0, in the units of g over those of λ; 0 (rigid) by default.

    Raises
    ------
    InputError
        If the shapes do not match, or a rigid row acts on held dofs only.
    SignoriniError
        If K is not regular.

    Examples
    --------
    The free corner of a plate may sink by at most 1 mm more than the middle of its edge.

    >>> from signorini import Model, contact_problem, recover
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.1},
    ...     mesh={"divisions": [4, 4]},
    ...     support=[{"edge": "left", "fix": "clamped"}],
    ...     load=[{"force": 10e3, "at": [4, 0]}],
    ... )
    >>> problem = contact_problem(model)
    >>> corner, middle = problem.rows_at([4, 0]), problem.rows_at([4, 2])
    >>> stopped = with_rows(problem, corner - middle, [1e-3])
    >>> reactions = stopped.solve(problem.load("all"))
    >>> result = recover(stopped, "all", reactions)
    >>> at_corner, at_middle = result.probe([(4, 0), (4, 2)])
    >>> bool(reactions[0] > 0), round(at_corner.deflection - at_middle.deflection, 12), result.certificate.passed
    (True, 0.001, True)
    """
    made_by(problem, ContactProblem, "Make one with signorini.contact_problem(model).", "problem")
    result = csr_array(G) if issparse(G) else csr_array(array(G, "G", 2))
    count, size = result.shape[0], problem.discretisation.dof_count
    if not all(law.only_pushes or law.straight for law, _ in problem.discretisation.contacts.by_law):
        raise InputError(
            "found supports with a limit or a law; additional rows need a model without such supports.",
            place="problem",
        )
    if result.shape[1] != size:
        raise InputError(
            f"found an array of shape {result.shape}; it must have {size} columns, one for each dof.", place="G"
        )
    bounds = _per_row(gaps, count, "gaps")
    compliance = np.zeros(count) if flexibility is None else _per_row(flexibility, count, "flexibility")
    equations = np.zeros(count, np.bool_) if two_sided is None else np.asarray(two_sided)
    if equations.shape != (count,) or equations.dtype != np.bool_:
        raise InputError(
            f"found an array of {equations.dtype}, shape {equations.shape}; it must have {count} bools, one for a row.",
            "two_sided",
        )
    if not np.isfinite(result.data).all():
        raise InputError("found numbers that are not finite; all numbers must be finite.", place="G")
    if (compliance < 0).any():
        raise InputError(f"found {compliance.min():g}; all numbers must be 0 or more.", place="flexibility")
    without_effect = (abs(result[:, ~problem.held]).sum(axis=1) == 0) & (compliance == 0)
    if without_effect.any():
        raise InputError(
            f"row {int(np.argmax(without_effect))} acts on held dofs alone, which cannot move. Leave this row out.",
            place="G",
        )
    rows = RowProblem(problem, result, bounds, compliance, equations)
    problem.free(np.zeros(size))
    return rows


def _per_row(value: ArrayLike, count: int, place: str) -> Floats:
    result = array(value, place, 1)
    if len(result) != count or not np.isfinite(result).all():
        raise InputError(f"found {len(result)} numbers; they must be {count} finite numbers.", place=place)
    return result
