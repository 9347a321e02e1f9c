"""What a contact problem states, as plain arrays: K, G, gaps, loads."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from signorini.base.arguments import known
from signorini.base.arguments import points as points_of_plate
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats, Rows
from signorini.errors import InputError
from signorini.mesh import Mesh

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from scipy.sparse import csc_array, csr_array

_PARTS = ("w", "θx", "θy")
_NO_PART = 1e-14
"""Coefficient of a row below which it is rounding of the place in its element."""


class Statement:
    """The arrays of a discretised model, before anything is factored."""

    discretisation: Discretisation

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
        """Bounds g (m,) of Gu: the free travel of every contact point, and the settlement of its base."""
        return self.discretisation.contacts.distance

    @property
    def settlements(self) -> Floats:
        """What of `gaps` (m,) is the settlement of the base in the row's direction; the rest is free travel, ≥ 0."""
        return self.discretisation.contacts.settlement

    @property
    def two_sided(self) -> Bools:
        """Contact points (m,) that hold both ways, without travel: equations Gu = gaps, whose reaction has any sign."""
        return self.discretisation.contacts.two_sided

    @property
    def compliance(self) -> Floats:
        """Inverse stiffness (m,) of every contact point's support; 0 where it is rigid."""
        return self.discretisation.contacts.compliance

    @property
    def positions(self) -> Floats:
        """Where every contact point is (m, 2)."""
        return self.discretisation.contacts.positions

    @property
    def mesh(self) -> Mesh:
        """Nodes, ``mesh.points`` (n, 2), and elements, ``mesh.elements`` (ne, 8); see `signorini.mesh.Mesh`."""
        return self.discretisation.mesh

    @property
    def held(self) -> Bools:
        """Dofs (3n,) that supports hold at `held_values`."""
        return self.discretisation.held.dofs

    @property
    def held_values(self) -> Floats:
        """Prescribed values (3n,) of held dofs, the paper's u₀: settlements and rotations; 0 elsewhere."""
        return self.discretisation.held.values

    @property
    def frames(self) -> Floats:
        """Unit vectors (n, 2) along which the first slope of every node is; the second is a quarter turn from it.

        [1, 0], so that they are θx and θy, but at nodes of edges askew to x and y.
        """
        frames = self.discretisation.held.frames
        return np.broadcast_to([1.0, 0.0], (self.mesh.node_count, 2)) if frames is None else frames

    def rows_at(self, points: ArrayLike, of: Literal["w", "θx", "θy"] = "w") -> csr_array:
        """Rows (q, 3n) that take the displacements to the deflection, or a slope, at points (q, 2) of the plate.

        Of `mitc9` between nodes a slope has a part in its elements' own middle, without their loads.

        Raises
        ------
        InputError
            If a point is not on the plate, or there is no such part.

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
            If there is none of that name.
        """
        result = {c.name: c for c in self.discretisation.model.effective_combinations}
        return self.discretisation.load(result[known(combination, result, "combination", "combination")]).nodal
