from pathlib import Path

import meshio
import numpy as np
import pytest
from halving import halved

from signorini.errors import InputError
from signorini.formats.vtk import Vtu, displacement_vector, write_vtu
from signorini.mesh.meshers import rectangle

# Two elements side by side, the right one with a curved edge.
POINTS = np.array(
    [
        [0, 0],
        [1, 0],
        [2, 0],
        [0, 1],
        [1, 1],
        [2, 1],
        [0.5, 0],
        [1, 0.5],
        [0.5, 1],
        [0, 0.5],
        [1.5, 0],
        [2.2, 0.5],
        [1.5, 1],
    ]
)
ELEMENTS = np.array([[0, 1, 4, 3, 6, 7, 8, 9], [1, 2, 5, 4, 10, 11, 12, 7]])


def write(path: Path, **fields: object) -> meshio.Mesh:
    write_vtu(path, POINTS, ELEMENTS, fields)
    return meshio.read(path)


def test_mesh_and_fields_come_back_to_the_last_bit(tmp_path: Path) -> None:
    deflection = np.sin(np.arange(13.0))
    closed = np.array([True, False])
    write_vtu(tmp_path / "a.vtu", POINTS, ELEMENTS, {"deflection": deflection}, {"closed": closed})
    back = meshio.read(tmp_path / "a.vtu")
    np.testing.assert_array_equal(back.points[:, :2], POINTS)
    assert not back.points[:, 2].any()
    assert [block.type for block in back.cells] == ["quad8"]
    np.testing.assert_array_equal(back.cells[0].data, ELEMENTS)
    np.testing.assert_array_equal(back.point_data["deflection"], deflection)
    np.testing.assert_array_equal(back.cell_data["closed"][0], [1, 0])


def test_triangles_are_vtks_quadratic_ones(tmp_path: Path) -> None:
    mesh = halved(rectangle((0.0, 0.0), (2.0, 1.0), (3, 2)), 0.5)
    write_vtu(tmp_path / "a.vtu", mesh.points, mesh.elements, {"x": mesh.points[:, 0]}, {"area": mesh.element_area})
    back = meshio.read(tmp_path / "a.vtu")
    own = {"quad8": range(8), "triangle6": [0, 1, 2, 4, 5, 7]}
    found = [(block.type, tuple(nodes)) for block in back.cells for nodes in block.data.tolist()]
    kinds = np.where(mesh.triangles, "triangle6", "quad8")
    assert found == [(kind, tuple(row[own[kind]].tolist())) for kind, row in zip(kinds, mesh.elements, strict=True)]
    np.testing.assert_array_equal(np.concatenate(back.cell_data["area"]), mesh.element_area)


def test_positive_deflection_warps_downwards(tmp_path: Path) -> None:
    back = write(tmp_path / "a.vtu", displacement=displacement_vector(np.full(13, 2.0)))
    np.testing.assert_array_equal(back.point_data["displacement"], np.tile([0.0, 0.0, -2.0], (13, 1)))


def test_vectors_of_the_plane_get_a_zero_third_component(tmp_path: Path) -> None:
    back = write(tmp_path / "a.vtu", shear=POINTS)
    np.testing.assert_array_equal(back.point_data["shear"], np.column_stack([POINTS, np.zeros(13)]))


def test_a_file_is_much_smaller_than_its_text(tmp_path: Path) -> None:
    write_vtu(tmp_path / "a.vtu", np.tile(POINTS, (200, 1)), ELEMENTS, {"w": np.zeros(2600)})
    assert (tmp_path / "a.vtu").stat().st_size < 10_000


def test_a_field_of_another_length_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^moment: The field has the shape \(4,\); for 13 nodes"):
        write(tmp_path / "a.vtu", moment=np.zeros(4))


@pytest.mark.parametrize(("points", "elements"), [(np.zeros((13, 3)), ELEMENTS), (POINTS, ELEMENTS[:, :4])])
def test_another_shape_of_mesh_is_refused(tmp_path: Path, points: np.ndarray, elements: np.ndarray) -> None:
    with pytest.raises(InputError, match="it must be"):
        write_vtu(tmp_path / "a.vtu", points, elements, {})


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "a.vtu"
    target.write_text("old")

    def fail(self: Vtu, path: Path, *fields: object) -> None:
        path.write_text("half")
        raise OSError("disk full")

    monkeypatch.setattr(Vtu, "write", fail)
    with pytest.raises(OSError, match="disk full"):
        write_vtu(target, POINTS, ELEMENTS, {})
    assert [(entry.name, entry.read_text()) for entry in tmp_path.iterdir()] == [("a.vtu", "old")]
