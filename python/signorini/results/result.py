"""The class `Result`: results of one combination, with methods for pictures, files and tables."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from signorini.base import arguments
from signorini.base.arguments import checked
from signorini.base.files import require_unread
from signorini.base.packages import package
from signorini.discretise.rows import Floats
from signorini.errors import InputError, point
from signorini.formats.vtk import as_meshio, write_vtu
from signorini.mesh import Location
from signorini.results.drawing import draw_field
from signorini.results.frames import numbers_frame
from signorini.results.local_results import ProbeResult, probe_results, total_pressure
from signorini.results.notebook import in_notebook
from signorini.results.quantities import LINEAR
from signorini.results.sensitivity import Sensitivity
from signorini.results.state import ResultState
from signorini.results.support_result import areas_below
from signorini.results.vtk import vtk_fields
from signorini.singularities.beside import at_faces

if TYPE_CHECKING:
    from signorini.plot.pictures import Axes

Points: TypeAlias = Floats | Sequence[tuple[float, float]] | tuple[float, float]


@checked
@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Result(ResultState):
    """Results of one combination, with methods for pictures and files; docs/python.md lists its arrays and numbers."""

    def probe(self, points: Points) -> list[ProbeResult]:
        """Results at points (q, 2) of the plate, one `ProbeResult` for each.

        Raises
        ------
        InputError
            If a point is not on the plate, or the plate has no equilibrium.
        """
        positions, where = self._located(points)
        nodes = self.stress_nodes
        sides = nodes.sides(positions, where)
        fields = np.column_stack([nodes.spread(self.fields[name]) for name in LINEAR])
        thickness = sides.alike(nodes.at(sides, self.thickness))
        pressures, values = total_pressure(areas_below(self.supports), positions), nodes.at(sides, fields)
        faces = () if self.means is None else self.means.faces
        of_bars = sides.larger(at_faces(faces, self.moment, values[:, 3:6], positions[sides.point]))
        return [*probe_results(positions, sides.larger(values), pressures, thickness, self.model.bars, of_bars)]

    def pressure(self, points: Points) -> Floats:
        """Contact pressure (q,) of area supports at points (q, 2) of the plate, positive where they push the plate up.

        It is 0 where the support is open, and NaN without area support. On an elastic area the pressure is k ⟨w −
        settlement − gap⟩, on a rigid area the reaction of each element over the element's area.

        Raises
        ------
        InputError
            If a point is not on the plate.

        Examples
        --------
        >>> from signorini import Model, solve
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.5},
        ...     support=[{"area": "all", "resists": "down", "stiffness": 20e6}],
        ...     load=[{"pressure": 2e3}],
        ... )
        >>> solve(model)["all"].pressure([(2, 2), (0, 0)]).round(6)
        array([2000., 2000.])
        """
        return total_pressure(areas_below(self.supports), self._located(points)[0])

    def _located(self, points: Points) -> tuple[Floats, Location]:
        self.require_fields()
        positions = arguments.points(points)
        where = self.mesh.locate(positions)
        if not where.inside.all():
            at = point(positions[np.argmin(where.inside)])
            raise InputError(f"The point {at} is not on the plate. Move it onto the plate.")
        return positions, where

    def plot(
        self,
        field: str = "deflection",
        ax: Axes | None = None,
        limits: tuple[float, float] | None = None,
        plus_minus: Mapping[str, Any] | None = None,
    ) -> Axes:
        """Draw a field as contours, with open and closed supports, as in the pictures that the command writes.

        Parameters
        ----------
        field : str
            One of `fields`, or "pressure": the contact pressure of area supports.
        ax : Axes, optional
            Axes of matplotlib; by default those of a new figure.
        limits : (low, high), optional
            Range of the colours, for comparing results; by default the range of the field.
        plus_minus : mapping, optional
            Half-widths to name with the extremes: ``signorini.estimate(result).plus_minus``.

        Raises
        ------
        InputError
            If no field has that name, no area support has a pressure, or the limits are not an interval.
        """
        return draw_field(self, field, ax, limits, plus_minus)

    def sensitivity(self, name: str) -> Sensitivity:
        """Derivatives of a number with respect to gaps, stiffnesses, limits, preloads, thickness, moduli and loads.

        Derivatives hold for a fixed contact state: each contact point stays on its piece of its law (direct
        differentiation: Haftka and Gürdal 1992, section 7.2). Each parameter takes one solve with a factor that all
        parameters share.

        Parameters
        ----------
        name : str
            Name of a number as in thresholds: "soil.max_pressure", "probe[1].deflection", "check:NAME.utilisation".

        Returns
        -------
        Sensitivity
            A mapping from paths as in a study, such as "support.soil.stiffness", to derivatives in the units of the
            input. ``valid[path]`` is the range of the parameter in which no point changes its piece, to first order.

        Raises
        ------
        InputError
            If there is no such number, it is a count, there is no equilibrium, or the answer is not unique.

        Examples
        --------
        A rigid block on soil: the pressure is the force over the area.

        >>> from signorini import Model, solve
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [2, 2], "thickness": 1.0},
        ...     mesh={"divisions": [2, 2]},
        ...     support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 1e4}],
        ...     load=[{"force": 8e3, "at": [1, 1]}],
        ... )
        >>> found = solve(model)["all"].sensitivity("soil.reaction")
        >>> round(found["load[1].force"], 6), [round(end) for end in found.valid["load[1].force"][:1]]
        (1.0, [0])
        """
        # The module of sensitivities is imported only when it is needed.
        found: Sensitivity = import_module("signorini.sensitivities.direct").of_result(self, name)
        return found

    def to_vtk(self, path: str | os.PathLike[str]) -> None:
        """Write a .vtu file with every field; the displacement vector points down (−z) where the plate moves down.

        Raises
        ------
        InputError
            If there is no equilibrium, and so no field.
        OSError
            If the file cannot be written, or the model is read from it.
        """
        self.require_fields()
        mesh = as_meshio(self.stress_nodes.points, self.stress_nodes.elements, *vtk_fields(self))
        require_unread(path, self.model.provenance.read)
        write_vtu(path, mesh, self.model.provenance.metadata)

    def to_pyvista(self) -> Any:
        """Convert the plate with every field to a `pyvista.UnstructuredGrid`; PyVista must be installed.

        Several plates become a `pyvista.MultiBlock` of grids by name of the plate.

        Raises
        ------
        InputError
            If there is no equilibrium, and so no field.
        SignoriniError
            If PyVista is not installed.
        """
        if self.plates:
            return package("pyvista").MultiBlock({name: one.to_pyvista() for name, one in self.plates.items()})
        self.require_fields()
        mesh = as_meshio(self.stress_nodes.points, self.stress_nodes.elements, *vtk_fields(self))
        return package("pyvista").from_meshio(mesh)

    def to_dataframe(self) -> Any:
        """Convert the ``numbers`` to a `pandas.DataFrame` with a row for each number: value, unit, x, y.

        pandas must be installed. Rows have the names of thresholds, such as "bolts[1].reaction". x and y are the
        position of a point, a probe, a station or an extreme; NaN for other numbers.

        Examples
        --------
        >>> from signorini import Model, solve
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        ...     units={"length": "m", "force": "N"},
        ...     support=[{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}],
        ...     load=[{"pressure": 1e3}],
        ... )
        >>> table = solve(model)["all"].to_dataframe()
        >>> table.loc["feet[3].reaction"].map(str).tolist()[1:], round(table.loc["feet[3].reaction", "value"])
        (['N', '2.0', '3.0'], 8000)
        """
        return numbers_frame(self)

    def _repr_html_(self) -> str:
        """Show the deflection, the supports and other numbers in a notebook."""
        return in_notebook(self, None, "")
