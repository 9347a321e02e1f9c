"""Mesh files: content read from each format, and refusals."""

import json

import meshio
import numpy as np
import pytest
from halving import halved
from typer.testing import CliRunner

from signorini import Model, load, solve
from signorini.cli import app
from signorini.discretise import discretise
from signorini.errors import InputError
from signorini.mesh import Mesh
from signorini.mesh.cells import node_numbers
from signorini.mesh.meshers import annulus, rectangle
from signorini.mesh.meshfile import read

PLATE = rectangle((0.0, 0.0), (4.0, 2.0), (4, 2))


def in_space(points):
    return np.column_stack([points, np.zeros(len(points))])


def lines(triples):
    return triples[:, [0, 2, 1]]


def tagged(mesh=PLATE, names=("left", "right", "bottom", "top")):
    """A mesh with physical groups, as Gmsh writes it."""
    tags = {name: i + 1 for i, name in enumerate(names)}
    tags["plate"] = len(names) + 1
    cells = [("line3", lines(mesh.edges[name])) for name in names] + [("quad8", mesh.elements)]
    values = [np.full(len(block), tag) for (_, block), tag in zip(cells, tags.values(), strict=True)]
    return meshio.Mesh(
        in_space(mesh.points),
        cells,
        cell_data={"gmsh:physical": values, "gmsh:geometrical": values},
        field_data={name: np.array([tag, 2 if name == "plate" else 1]) for name, tag in tags.items()},
    )


def mixed(part, clockwise=False):
    """A mesh with triangles, and as meshio has it."""
    mesh = halved(PLATE, part)
    triangles = mesh.elements[mesh.triangles][:, [0, 1, 2, 4, 5, 7]]
    if clockwise:
        triangles = triangles[:, [0, 2, 1, 5, 4, 3]]
    cells = [("quad8", mesh.elements[~mesh.triangles]), ("triangle6", triangles)]
    return mesh, meshio.Mesh(in_space(mesh.points), [cell for cell in cells if len(cell[1])])


def same_edge(found, wanted):
    return sorted(map(tuple, found.tolist())) == sorted(map(tuple, wanted.tolist()))


def write(path, data, **options):
    data.write(path, **options)
    return path


@pytest.mark.parametrize("part", [0.5, 1.0])
@pytest.mark.parametrize("clockwise", [False, True])
def test_triangles_are_read_beside_quadrilaterals(tmp_path, part, clockwise):
    wanted, data = mixed(part, clockwise)
    mesh = read(write(tmp_path / "plate.vtu", data))
    assert (len(mesh.elements), mesh.triangles.sum()) == (len(wanted.elements), wanted.triangles.sum())
    assert mesh.element_area.sum() == pytest.approx(8.0, rel=1e-14)
    assert same_edge(np.sort(mesh.edges["boundary"]), np.sort(wanted.boundary))


def test_a_plate_of_triangles_is_solved_by_the_command(tmp_path):
    mesh, data = mixed(0.5)
    write(tmp_path / "plate.vtu", data)
    (tmp_path / "slab.toml").write_text(
        """
        material = { E = 30e9, nu = 0.2 }
        plate = { shape = "mesh", file = "plate.vtu", thickness = 0.2 }
        support = [{ name = "soil", area = "all", resists = "down", stiffness = 30e6 }]
        load = [{ case = "G", pressure = 2e3 }, { case = "Q", force = 50e3, at = [0.5, 0.4] }]
        combination = [{ name = "G", factors = { G = 1 } }, { name = "both", factors = { G = 1.35, Q = 1.5 } }]
        output = { combinations = "table", fields = "all" }
        """
    )
    ran = CliRunner().invoke(app, ["solve", str(tmp_path / "slab.toml")])
    assert ran.exit_code == 0
    assert f"{(~mesh.triangles).sum()} elements mitc9 and {mesh.triangles.sum()} elements mitc7" in ran.output
    results = json.loads((tmp_path / "slab-results" / "results.json").read_text())
    both = results["combinations"][1]
    assert both["certificate"]["passed"]
    assert both["supports"][0]["reaction"] == pytest.approx(1.35 * 16e3 + 75e3)
    back = meshio.read(tmp_path / "slab-results" / "both.vtu")
    assert sum(len(block.data) for block in back.cells if block.type == "triangle6") == mesh.triangles.sum()
    alone = solve(load(tmp_path / "slab.toml"))["both"]
    assert back.point_data["deflection"] == pytest.approx(alone.deflection, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "file_format"),
    [("plate.vtu", "vtu"), ("plate.vtk", "vtk"), ("plate.inp", "abaqus"), ("a.msh", "gmsh"), ("b.msh", "gmsh22")],
)
def test_a_plate_is_the_same_in_every_format(tmp_path, capsys, name, file_format):
    plain = meshio.Mesh(in_space(PLATE.points), [("quad8", PLATE.elements)])
    path = write(tmp_path / name, plain, file_format=file_format)
    capsys.readouterr()
    mesh = read(path)
    assert mesh.points == pytest.approx(PLATE.points, abs=1e-15)
    assert np.array_equal(mesh.elements, PLATE.elements)
    assert same_edge(mesh.edges["boundary"], PLATE.boundary)
    assert capsys.readouterr() == ("", "")


def gmsh(**sections):
    """Text of a file of Gmsh."""
    return "".join(f"${name}\n" + "\n".join(map(str, body)) + f"\n$End{name}\n" for name, body in sections.items())


def test_an_edge_and_one_that_contains_it_are_refused_together(tmp_path):
    """Its sides would be loaded twice."""
    path = tmp_path / "plate.msh"
    tagged().write(path, file_format="gmsh22")
    model = Model(
        material={"E": 1e9, "nu": 0.2},
        plate={"shape": "mesh", "file": str(path), "thickness": 0.1},
        support=[{"edge": "left", "fix": "clamped"}],
        load=[{"line_load": 1.0, "edge": ["right", "boundary"]}],
    )
    with pytest.raises(InputError, match='"right", "boundary" have sides in common') as raised:
        discretise(model)
    assert raised.value.place == "load[1].edge"


def msh41(mesh, edges):
    """Text of a file of Gmsh's format 4.1, each edge a physical curve with two in the group "sides" as well."""
    groups = [f'1 {i} "{name}"' for i, name in enumerate(edges, 1)] + ['1 9 "sides"', '2 10 "plate"']
    box = "0 0 0 4 2 0"
    curves = [f"{i} {box} {'2 9' if i < 3 else '1'} {i} 0" for i in range(1, len(edges) + 1)]
    count = mesh.node_count
    nodes = [*range(1, count + 1)], [f"{x!r} {y!r} 0" for x, y in mesh.points.tolist()]
    blocks, tag = [], 0
    for i, (cells, kind) in enumerate([*((lines(edge), 8) for edge in edges.values()), (mesh.elements, 16)], 1):
        dimension, entity = (2, 1) if kind == 16 else (1, i)
        blocks.append(f"{dimension} {entity} {kind} {len(cells)}")
        for cell in (cells + 1).tolist():
            tag += 1
            blocks.append(" ".join(map(str, [tag, *cell])))
    return gmsh(
        MeshFormat=["4.1 0 8"],
        PhysicalNames=[len(groups), *groups],
        Entities=[f"0 {len(edges)} 1 0", *curves, f"1 {box} 1 10 0"],
        Nodes=[f"1 {count} 1 {count}", f"2 1 0 {count}", *nodes[0], *nodes[1]],
        Elements=[f"{len(edges) + 1} {tag} 1 {tag}", *blocks],
    )


def test_physical_groups_of_gmsh_2_are_edges(tmp_path):
    mesh = read(write(tmp_path / "plate.msh", tagged(), file_format="gmsh22"))
    assert sorted(mesh.edges) == ["bottom", "boundary", "left", "right", "top"]
    for name, edge in PLATE.edges.items():
        assert same_edge(mesh.edges[name], edge)


def test_physical_groups_of_gmsh_4_are_edges_and_a_line_may_be_in_two(tmp_path):
    path = tmp_path / "plate.msh"
    path.write_text(msh41(PLATE, PLATE.edges))
    mesh = read(path)
    assert sorted(mesh.edges) == ["bottom", "boundary", "left", "right", "sides", "top"]
    for name, edge in PLATE.edges.items():
        assert same_edge(mesh.edges[name], edge)
    assert same_edge(mesh.edges["sides"], np.vstack([PLATE.edges["left"], PLATE.edges["right"]]))


def test_node_and_line_sets_of_abaqus_are_edges(tmp_path):
    left, top = PLATE.edges["left"], PLATE.edges["top"]
    data = meshio.Mesh(
        in_space(PLATE.points),
        [("line3", lines(top)), ("quad8", PLATE.elements)],
        point_sets={"wall": np.unique(left), "corner": np.array([0])},
        cell_sets={"roof": [np.arange(len(top)), np.array([], int)]},
    )
    mesh = read(write(tmp_path / "plate.inp", data))
    assert sorted(mesh.edges) == ["boundary", "roof", "wall"]
    assert same_edge(mesh.edges["wall"], left) and same_edge(mesh.edges["roof"], top)


def test_nine_node_quadrilaterals_lose_their_centres(tmp_path):
    centres = PLATE.points[PLATE.elements[:, :4]].mean(axis=1)
    points = np.vstack([PLATE.points, centres])
    elements = np.column_stack([PLATE.elements, PLATE.node_count + np.arange(len(centres))])
    mesh = read(write(tmp_path / "plate.vtu", meshio.Mesh(in_space(points), [("quad9", elements)])))
    assert np.array_equal(mesh.points, PLATE.points) and np.array_equal(mesh.elements, PLATE.elements)


def test_clockwise_elements_are_turned(tmp_path):
    elements = PLATE.elements.copy()
    elements[3] = elements[3, [0, 3, 2, 1, 7, 6, 5, 4]]
    mesh = read(write(tmp_path / "plate.vtu", meshio.Mesh(in_space(PLATE.points), [("quad8", elements)])))
    assert np.array_equal(mesh.elements, PLATE.elements)


def test_coincident_nodes_are_merged_and_unused_ones_dropped(tmp_path):
    each_its_own = PLATE.points[PLATE.elements].reshape(-1, 2)
    each_its_own += 1e-10 * np.random.default_rng(0).uniform(-1, 1, each_its_own.shape)
    points = in_space(np.vstack([[[-5.0, -5.0]], each_its_own]))
    data = meshio.Mesh(points, [("quad8", 1 + np.arange(64).reshape(8, 8))])
    mesh = read(write(tmp_path / "plate.vtu", data))
    assert mesh.node_count == PLATE.node_count
    assert mesh.element_area == pytest.approx(PLATE.element_area)


def test_a_plate_at_another_level_is_read(tmp_path):
    """And one whose level is written in seven digits."""
    points = in_space(PLATE.points) + np.array([0.0, 0.0, 3.5])
    points[::2, 2] += 2e-7
    assert read(write(tmp_path / "plate.vtu", meshio.Mesh(points, [("quad8", PLATE.elements)]))).size == 4.0


CORNERS = PLATE.elements[:, :4]
TILTED = in_space(PLATE.points) + np.outer(PLATE.points[:, 0], [0.0, 0.0, 0.1])
APART = in_space(PLATE.points[PLATE.elements].reshape(-1, 2) * 1.0)
APART[8:] += 10.0 * np.array([1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("points", "cells", "message"),
    [
        (
            PLATE.points,
            [("triangle", CORNERS[:, :3])],
            "not 8- or 9-node quadrilaterals or 6-node triangles: 8 triangle. Use only second-order elements",
        ),
        (PLATE.points, [("quad", CORNERS)], "8 quad. .*ElementOrder = 2"),
        (PLATE.points, [("quad8", PLATE.elements), ("triangle", CORNERS[:2, :3])], "6-node triangles: 2 triangle"),
        (PLATE.points, [("line3", lines(PLATE.boundary))], "has no elements"),
        (TILTED, [("quad8", PLATE.elements)], "not plane: z varies by 0.4"),
        (APART[:, :2], [("quad8", np.arange(64).reshape(8, 8))], "in 2 pieces that share no side"),
        (
            PLATE.points[:-1],
            [("quad8", PLATE.elements)],
            "An element of the mesh refers to node index 36 .*has 36 nodes",
        ),
        (1e100 * PLATE.points, [("quad8", PLATE.elements)], r"lie within 4e\+100, .* at most 1e\+60"),
        (1e-61 * PLATE.points, [("quad8", PLATE.elements)], "must be at least 1e-60"),
        (1e8 + PLATE.points, [("quad8", PLATE.elements)], "lies 1e.08 from the origin, .* Move it to the origin"),
    ],
)
def test_a_file_that_is_no_plate_is_refused_with_its_name(tmp_path, points, cells, message):
    points = in_space(points) if points.shape[1] == 2 else points
    path = write(tmp_path / "wrong.vtu", meshio.Mesh(points, cells))
    with pytest.raises(InputError, match=message) as caught:
        read(path)
    assert caught.value.place == str(path)


def test_a_group_of_lines_that_is_no_side_is_refused(tmp_path):
    data = tagged()
    data.cells[0].data[0] = [0, 5, 7]
    with pytest.raises(InputError, match=r"Group 'left' of the mesh has a line at .* not a side of an element"):
        read(write(tmp_path / "plate.msh", data, file_format="gmsh22"))


def test_a_group_that_takes_the_name_of_the_outline_is_refused(tmp_path):
    data = tagged()
    data.field_data["boundary"] = data.field_data.pop("left")
    with pytest.raises(InputError, match=r"group 'boundary' that is not the whole outline.*Rename the group"):
        read(write(tmp_path / "plate.msh", data, file_format="gmsh22"))


def test_a_group_of_two_node_lines_is_refused(tmp_path):
    data = meshio.Mesh(
        in_space(PLATE.points),
        [("line", PLATE.edges["left"][:, [0, 2]]), ("quad8", PLATE.elements)],
        cell_data={"gmsh:physical": [np.ones(2, int), np.full(8, 2)]},
        field_data={"left": np.array([1, 1])},
    )
    with pytest.raises(InputError, match="Group 'left' of the mesh consists of 2-node lines"):
        read(write(tmp_path / "plate.msh", data, file_format="gmsh22"))


FAN = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2.4, 1], [1, 1], [1, 2.4], [0, 1]], float)
"""Two elements, a side of each collapsed to the first node."""
COLLAPSED = np.array([[0, 0, 1, 2, 0, 4, 5, 6], [0, 0, 2, 3, 0, 6, 7, 8]])


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize("apart", [False, True])
def test_a_quadrilateral_with_a_collapsed_side_begins_with_it(tmp_path, turn, clockwise, apart):
    around = (np.arange(4) + turn) % 4
    points, cells = FAN, COLLAPSED[:, [*around, *(4 + around)]]
    if clockwise:
        cells = cells[:, [0, 3, 2, 1, 7, 6, 5, 4]]
    if apart:
        # Every place of a side has a node of its own, at the same point.
        points, cells = FAN[cells.ravel()], np.arange(16).reshape(2, 8)
    found = read(write(tmp_path / "fan.vtu", meshio.Mesh(in_space(points), [("quad8", cells)])))
    assert (found.points[found.elements] == FAN[COLLAPSED]).all() and found.node_count == 9
    assert not found.triangles.any() and len(found.edges["boundary"]) == 4
    triangles = found.with_triangles()
    assert triangles.triangles.all() and triangles.element_area == pytest.approx(found.element_area)


def test_a_point_at_a_collapsed_side_is_its_node(tmp_path):
    mesh = read(write(tmp_path / "fan.vtu", meshio.Mesh(in_space(FAN), [("quad8", COLLAPSED)])))
    random = np.random.default_rng(3)
    for size in (1.0, 1e-3, 1e-8, 1e-13, 0.0):
        points = size * random.uniform(0, 1.9, (100, 2))
        where = mesh.locate(points)
        assert where.inside.all()
        assert mesh.map(where.elements, where.xi) == pytest.approx(points, abs=1e-11)
    assert mesh.shape_functions(where.elements, where.xi).tolist() == [[1.0, 0, 0, 0, 0, 0, 0, 0]] * 100


def test_an_element_whose_corners_are_one_node_is_refused(tmp_path):
    cells = [("quad8", np.array([[4, 4, 4, 4, 0, 1, 2, 3]])), ("line3", lines(PLATE.edges["left"]))]
    sets = {"left": [np.zeros(0, int), np.arange(len(PLATE.edges["left"]))]}
    with pytest.raises(InputError, match="not a side of an element"):
        read(write(tmp_path / "plate.inp", meshio.Mesh(in_space(PLATE.points), cells, cell_sets=sets)))


def test_an_element_that_repeats_a_node_elsewhere_is_refused():
    wrong = COLLAPSED.copy()
    wrong[0, 4] = 8
    with pytest.raises(InputError, match=r"uses a node twice; .* collapsed to the node c also six, as"):
        Mesh(FAN, wrong, {})


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("plate.msh", b""),
        ("plate.msh", b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 2"),
        ("plate.vtu", b"<VTKFile"),
        ("plate.inp", bytes(range(256))),
        ("plate.txt", b"nothing"),
        ("plate", b""),
    ],
)
def test_a_file_that_cannot_be_read_is_refused_quietly(tmp_path, capsys, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read(path)
    assert caught.value.place == str(path)
    assert capsys.readouterr() == ("", "")


def test_a_missing_file_and_a_directory_are_refused(tmp_path):
    for path in (tmp_path / "no.msh", tmp_path):
        with pytest.raises(InputError, match=r"does not exist|is a directory"):
            read(path)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_a_node_without_a_finite_place_is_named(tmp_path, axis, wrong):
    points = in_space(PLATE.points)
    points[5, axis] = wrong
    path = write(tmp_path / "plate.vtu", meshio.Mesh(points, [("quad8", PLATE.elements)]))
    with pytest.raises(InputError, match=r"Node 5 \(the first has index 0\) of the mesh is at \(.*finite number"):
        read(path)


def test_nodes_of_abaqus_in_several_blocks_are_refused_by_that_name(tmp_path):
    path = tmp_path / "plate.inp"
    path.write_text(NUMBERED[".inp"].replace("11, 0.5, 0\n", "*NODE\n11, 0.5, 0\n"))
    with pytest.raises(InputError, match=r"Its nodes are in 2 blocks \*NODE, of which meshio reads only the last"):
        read(path)


# Two elements, their nodes numbered as no position in the file would number them.
CORNERS_AT = ["10 0 0", "20 1 0", "30 2 0", "40 0 1", "50 1 1", "60 2 1"]
MIDDLES_AT = ["11 0.5 0", "21 1.5 0", "31 0 0.5", "41 1 0.5", "51 2 0.5", "61 0.5 1", "71 1.5 1"]
CELLS = ["1 {}10 20 50 40 11 41 61 31", "2 {}20 30 60 50 21 51 71 41"]


def numbered_block(entity, nodes):
    """Nodes as Gmsh's format 4.1 has those of an entity: their numbers, then their places."""
    split = [node.split(" ", 1) for node in nodes]
    return [f"2 {entity} 0 {len(nodes)}", *(number for number, _ in split), *(f"{at} 0" for _, at in split)]


NUMBERED = {
    ".inp": "\n".join(
        [
            *("*HEADING", "two plates", "*NODE", *(node.replace(" ", ", ") for node in CORNERS_AT + MIDDLES_AT)),
            *("*ELEMENT, TYPE=S8R", *(cell.format("").replace(" ", ", ") for cell in CELLS), ""),
        ]
    ),
    ".msh": gmsh(
        MeshFormat=["2.2 0 8"],
        Nodes=[13, *(f"{node} 0" for node in CORNERS_AT + MIDDLES_AT)],
        Elements=[2, *(cell.format("16 2 0 1 ") for cell in CELLS)],
    ),
    "4.msh": gmsh(
        MeshFormat=["4.1 0 8"],
        Nodes=["2 13 10 71", *numbered_block(1, CORNERS_AT), *numbered_block(2, MIDDLES_AT)],
        Elements=["1 2 1 2", "2 1 16 2", *(cell.format("") for cell in CELLS)],
    ),
}


def on_nodes(file, support, load):
    return {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "mesh", "file": str(file), "thickness": 0.1},
        "support": [{"resists": "down", **support}],
        "load": [load],
    }


@pytest.mark.parametrize("ending", NUMBERED)
def test_supports_and_loads_name_nodes_by_their_numbers(tmp_path, ending):
    file = tmp_path / f"plate{ending}"
    file.write_text(NUMBERED[ending])
    by_number = on_nodes(file, {"nodes": [60, 10, 30, 40]}, {"force": 1e3, "nodes": 41})
    by_point = on_nodes(file, {"at": [[2, 1], [0, 0], [2, 0], [0, 1]]}, {"force": 1e3, "at": [1, 0.5]})
    one, other = (solve(Model(**model))["all"] for model in (by_number, by_point))
    assert one.supports[0].positions.tolist() == by_point["support"][0]["at"]
    np.testing.assert_array_equal(one.deflection, other.deflection)


def test_nodes_of_a_vtu_count_from_0(tmp_path):
    meshio.Mesh(
        np.array([[0, 0], [4, 0], [4, 2], [0, 2], [2, 0], [4, 1], [2, 2], [0, 1]], float), [("quad8", [range(8)])]
    ).write(tmp_path / "plate.vtu")
    model = on_nodes(tmp_path / "plate.vtu", {"nodes": [0, 1, 2, 3]}, {"moment": [1e3, 0], "nodes": [7]})
    found = discretise(Model(**model))
    assert found.model.load[0].at == ((0.0, 1.0),) and found.contacts.positions.tolist()[2] == [4.0, 2.0]


def test_a_number_that_no_node_has_is_told_its_place(tmp_path):
    file = tmp_path / "plate.inp"
    file.write_text(NUMBERED[".inp"])
    with pytest.raises(InputError) as caught:
        discretise(Model(**on_nodes(file, {"nodes": [10, 12, 40]}, {"force": 1, "nodes": [1]})))
    says = "The mesh file has no node {}; its 13 nodes have numbers from 10 to 71."
    assert [(part.place, part.message) for part in caught.value.parts] == [
        ("support[1].nodes[2]", says.format(12)),
        ("load[1].nodes[1]", says.format(1)),
    ]


def test_nodes_of_files_without_numbers_are_refused(tmp_path):
    file = tmp_path / "plate.msh"
    file.write_text(NUMBERED[".msh"])
    binary = tmp_path / "binary.msh"
    meshio.write(binary, meshio.read(file), file_format="gmsh22", binary=True)
    with pytest.raises(InputError, match=r"^plate.file: .*binary.msh: .* Mesh.Binary = 0, or give points with at"):
        discretise(Model(**on_nodes(binary, {"nodes": [1, 2, 3]}, {"force": 1, "at": [1, 0.5]})))
    with pytest.raises(InputError, match=r"not \.med\. Give points with at, or write the mesh in one of these formats"):
        node_numbers(tmp_path / "plate.med", 13)


@pytest.mark.parametrize(
    ("support", "load", "says"),
    [
        (
            {"nodes": [1, 2]},
            {"force": 1, "at": [1, 1]},
            r"^support\[1\].nodes: nodes belong to a mesh file",
        ),
        ({"at": [1, 1]}, {"force": 1, "nodes": 3}, r"^load\[1\].nodes: nodes belong to a mesh file"),
        ({"at": [1, 1], "nodes": 3}, {"pressure": 1}, "found at and nodes; exactly one of at, nodes, edge"),
        (
            {"at": [1, 1]},
            {"force": 1, "at": [1, 1], "nodes": 3},
            "found at and nodes; force needs exactly one of at, nodes",
        ),
        ({"at": [1, 1]}, {"pressure": 1, "nodes": 3}, "nodes is not allowed with pressure"),
        ({"nodes": [3, 3]}, {"pressure": 1}, "3 is listed twice"),
        ({"nodes": [1.5]}, {"pressure": 1}, r"found 1.5; it must be a whole number"),
        ({"nodes": []}, {"pressure": 1}, "it must be the number of a node or a list of numbers"),
        ({"nodes": -1}, {"pressure": 1}, "must not be less than 0"),
    ],
)
def test_nodes_are_refused_where_they_do_not_fit(support, load, says):
    plate = {"shape": "rectangle", "size": [2, 2], "thickness": 0.1}
    with pytest.raises(InputError, match=says):
        Model(**on_nodes("", support, load) | {"plate": plate})


def test_areas_pass_over_the_holes_of_a_mesh_and_not_beyond_its_outline(tmp_path):
    mesh = annulus((3.0, 2.0), 0.5, 2.0, (3, 12))
    file = write(tmp_path / "ring.vtu", meshio.Mesh(in_space(mesh.points), [("quad8", mesh.elements)]))
    edge, disc = {"edge": "boundary", "resists": "both"}, {"circle": {"center": [3, 2], "radius": 1.2}}
    for area in (
        disc,
        {"polygon": [[2, 1], [4, 1], [3.5, 3], [2, 3]]},
        {**disc, "holes": [{"rectangle": [2.6, 2, 3, 2.2]}]},
    ):
        model = Model(**on_nodes(file, edge, {"pressure": 4.0, "area": area}))
        whole = model.load[0].area.region.area
        # In the last one the hole in the area covers most of that in the mesh.
        over = np.pi * 0.25 if "holes" not in area else np.pi * 0.25 - 0.08
        assert discretise(model).cases["load"].nodal[::3].sum() == pytest.approx(4 * (whole - over), rel=2e-3)
    beyond = {"circle": {"center": [3, 2], "radius": 2.1}}
    with pytest.raises(InputError, match=r"load\[1\]\.area: The area has 9\.\d+ % of its size off the plate"):
        discretise(Model(**on_nodes(file, edge, {"pressure": 4.0, "area": beyond})))
    inside = {"rectangle": [2.8, 1.8, 3.2, 2.2]}
    with pytest.raises(InputError, match="The area is not on the plate"):
        discretise(Model(**on_nodes(file, edge, {"pressure": 4.0, "area": inside})))
