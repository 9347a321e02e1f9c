"""Fields of plates for other programs."""

from pathlib import Path

import meshio
import numpy as np
from halving import halved
from models import rectangular

from signorini import solve
from signorini.formats.vtk import as_meshio, write_vtu
from signorini.mesh.meshers import rectangle


def test_quadrilaterals_and_triangles_come_back_from_a_file_to_the_last_bit(tmp_path: Path) -> None:
    mesh = halved(rectangle((0.0, 0.0), (2.0, 1.0), (3, 2)), 0.5)
    fields = {"w": np.sin(mesh.points[:, 0]), "moment": np.cos(mesh.points[:, [0, 1, 0]])}
    write_vtu(tmp_path / "a.vtu", as_meshio(mesh.points, mesh.elements, fields, {"area": mesh.element_area}))
    back = meshio.read(tmp_path / "a.vtu")
    np.testing.assert_array_equal(back.points, np.column_stack([mesh.points, np.zeros(mesh.node_count)]))
    order = np.argsort(mesh.triangles, kind="stable")
    np.testing.assert_array_equal(np.concatenate(back.cell_data["area"]), mesh.element_area[order])
    quads, triangles = back.cells
    np.testing.assert_array_equal(quads.data, mesh.elements[~mesh.triangles])
    np.testing.assert_array_equal(triangles.data, mesh.elements[mesh.triangles][:, [0, 1, 2, 4, 5, 7]])
    for name, values in fields.items():
        np.testing.assert_array_equal(back.point_data[name], values)


def test_results_are_tables_datasets_and_grids_of_other_packages() -> None:
    support = [{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}]
    results = solve(rectangular(support=support, load=[{"case": "G", "pressure": 1e3}]))
    result = results["all"]
    assert results.to_dataframe().loc["all", "reaction:feet"] == result.reactions["feet"]
    fields = results.to_xarray()
    assert fields["mx"].sel(combination="all").values.tolist() == result.fields["mx"].tolist()
    assert fields["reaction"].sel(support="feet").item() == result.reactions["feet"]
    (grid,) = results.to_pyvista()
    assert grid.n_cells == len(result.mesh.elements)
    assert grid["displacement"][:, 2].tolist() == (-result.deflection).tolist()
    assert grid.bounds[3] == result.mesh.points[:, 1].max()
