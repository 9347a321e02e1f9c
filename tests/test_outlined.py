"""Plates whose outline and holes are given: their contours, meshes and edges, and refusals."""

import numpy as np
import pytest
from models import rectangular

from signorini import InputError, Model
from signorini.analysis.check import Quality, check
from signorini.mesh.meshers import outlined
from signorini.shapes import Polyline
from signorini.shapes.outlines import circle, straight

L = [[0, 0], [8, 0], [8, 4], [4, 4], [4, 8], [0, 8]]


def model(size=0.5, **given):
    plate = {"shape": "polygon", "points": L, "thickness": 0.2} | given.pop("plate", {})
    tables = {
        "material": {"E": 30e9, "nu": 0.2, "unit_weight": 25e3},
        "plate": plate,
        "mesh": {"size": size},
        "support": [{"edge": ["edge 1", "edge 6"], "fix": "simple"}],
        "load": [{"pressure": 2e3}],
    }
    return Model(**tables | given)


def meshed(found):
    return check(found).discretisation.mesh


def test_edges_run_from_corner_to_corner_and_holes_have_their_own():
    holes = [{"circle": {"center": [2, 2], "radius": 0.5}}, {"polygon": [[5, 1], [7, 1], [6, 3]]}]
    mesh = meshed(model(plate={"holes": holes}))
    assert list(mesh.edges) == [
        *(f"edge {i}" for i in range(1, 7)),
        *("hole 1", "hole 2", "hole 2 edge 1", "hole 2 edge 2", "hole 2 edge 3"),
    ]
    for number, (a, b) in enumerate(zip(L, L[1:] + L[:1], strict=True), 1):
        nodes = mesh.points[mesh.edges[f"edge {number}"]].reshape(-1, 2)
        assert (nodes.min(axis=0) == np.min([a, b], axis=0)).all()
        assert (nodes.max(axis=0) == np.max([a, b], axis=0)).all()
    assert np.abs(np.hypot(*(mesh.points[mesh.edges["hole 1"]] - 2.0).reshape(-1, 2).T) - 0.5).max() < 1e-14
    assert mesh.element_area.sum() == pytest.approx(48 - np.pi / 4 - 2, rel=1e-4)


@pytest.mark.parametrize(
    ("plate", "names", "area"),
    [
        ({"shape": "rectangle", "size": [4, 3]}, {"left", "right", "bottom", "top"}, 12),
        ({"shape": "disc", "radius": 2, "center": [2, 1]}, {"rim"}, 4 * np.pi),
        ({"shape": "disc", "radius": 4, "sector": 90}, {"rim", "start", "end"}, 4 * np.pi),
        ({"shape": "annulus", "inner": 0.5, "outer": 3}, {"inner", "outer"}, 8.75 * np.pi),
        (
            {"shape": "annulus", "inner": 0.5, "outer": 3, "sector": 200},
            {"inner", "outer", "start", "end"},
            8.75 * np.pi * 200 / 360,
        ),
    ],
)
def test_every_shape_may_have_holes(plate, names, area):
    hole = {"rectangle": [0.8, 0.9, 1.2, 1.4]}
    support = [{"edge": sorted(names), "fix": "simple"}]
    mesh = meshed(
        Model(
            material={"E": 30e9, "nu": 0.2},
            plate=plate | {"thickness": 0.2, "holes": [hole]},
            mesh={"size": 0.3},
            support=support,
            load=[{"pressure": 1.0}],
        )
    )
    assert set(mesh.edges) == names | {"hole 1", *(f"hole 1 {side}" for side in ("left", "right", "bottom", "top"))}
    assert mesh.element_area.sum() == pytest.approx(area - 0.2, rel=1e-4)


def test_sides_of_holes_are_those_of_the_hole():
    shaft = {"rectangle": [1, 1, 3, 2.5]}
    walls = [{"edge": ["edge 1", "edge 6"], "fix": "simple"}, {"edge": "hole 1 left", "resists": "down"}]
    arch = {"polygon": [[4.5, 1], [6.5, 1], {"through": [5.5, 2], "to": [4.5, 1]}]}
    found = check(model(plate={"holes": [shaft, arch]}, support=walls)).discretisation
    mesh = found.mesh
    left = mesh.points[mesh.edges["hole 1 left"]].reshape(-1, 2)
    assert (left.min(axis=0) == [1, 1]).all() and (left.max(axis=0) == [1, 2.5]).all()
    for hole, sides in (("hole 1", ["left", "right", "bottom", "top"]), ("hole 2", ["edge 1", "edge 2"])):
        parts = np.concatenate([mesh.edges[f"{hole} {side}"] for side in sides])
        assert sorted(parts.tolist()) == sorted(mesh.edges[hole].tolist())
    assert found.contacts.positions[:, 0] == pytest.approx(1)
    around = [*walls, {"edge": ["hole 2", "hole 2 edge 1"], "resists": "both"}]
    with pytest.raises(InputError, match=r'support\[3\].edge\[2\].*"hole 2 edge 1" is part of "hole 2"'):
        model(plate={"holes": [shaft, arch]}, support=around)


@pytest.mark.parametrize("off", [0, 5e-16, -1e-9])
def test_an_outline_may_close_by_an_arc(off):
    half = [[0, 0], [4, 0], {"through": [2, 2], "to": [off, 0]}]
    mesh = meshed(model(0.4, plate={"points": half}, support=[{"edge": "edge 2", "fix": "simple"}]))
    assert mesh.element_area.sum() == pytest.approx(2 * np.pi, rel=1e-4)
    assert sorted(mesh.edges) == ["edge 1", "edge 2"]


@pytest.mark.parametrize(
    ("plate", "says"),
    [
        ({"points": [[0, 0], [4, 4], [4, 0], [0, 4]]}, "plate.points[3]: edge 1 and edge 3 cross or touch at [2, 2]."),
        ({"holes": [{"rectangle": [7, 3, 9, 3.5]}]}, "plate.holes[1]: edge 2 and hole 1 cross or touch at [8, 3"),
        ({"holes": [{"circle": {"center": [6, 6], "radius": 1}}]}, "plate.holes[1]: hole 1 at [7, 6] is not inside"),
        (
            {"holes": [{"rectangle": [1, 1, 3, 3]}, {"circle": {"center": [2, 2], "radius": 0.5}}]},
            "plate.holes[2]: hole 2 at [2.5, 2] is inside hole 1. Leave the inner one out.",
        ),
    ],
)
def test_bad_outlines_are_told_with_their_place(plate, says):
    with pytest.raises(InputError) as error:
        meshed(model(plate=plate, support=[{"edge": "edge 1", "fix": "clamped"}]))
    assert says in str(error.value)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (
            {"plate": {"points": [[0, 0], [1, 1]]}},
            "plate.points: found [[0, 0], [1, 1]]; it must be a list of at least 3",
        ),
        ({"plate": {"points": [[0, 0], [1, 0], [1, 1], [0, 0]]}}, "the last corner equals the first"),
        ({"plate": {"points": [{"through": [1, 1], "to": [2, 0]}, [1, 0], [1, 1]]}}, "it begins with an arc"),
        ({"plate": {"points": [[0, 0], [1, 0], {"via": [1, 1], "to": [2, 0]}]}}, "plate.points[3].via: unknown key"),
        ({"plate": {"points": [[0, 0], [1, 0], 3]}}, "plate.points[3]: found 3; it must be a corner [x, y], or an arc"),
        ({"plate": {"holes": [{}]}}, "plate.holes[1]: found none; exactly one of rectangle, circle, polygon"),
        ({"mesh": {"divisions": [4, 4]}}, "mesh.divisions: divisions are for a regular mesh"),
        ({"mesh": {"refine": [{"edge": "left", "size": 1}]}}, "mesh.refine[1].edge"),
        ({"mesh": {"refine": [{"size": 1}]}}, "mesh.refine[1]: found none; exactly one of at, edge, line"),
        ({"support": [{"edge": "edge 7", "fix": "simple"}]}, "support[1].edge"),
    ],
)
def test_bad_tables_are_told_with_their_place(given, says):
    with pytest.raises(InputError) as error:
        model(**given)
    assert says in str(error.value)


def test_q8r_takes_quadrilaterals_alone():
    assert len(meshed(model(plate={"element": "q8r"})).elements) == 192
    with pytest.raises(InputError, match=r"plate.element: The mesh has \d+ triangles, and q8r has quadrilaterals only"):
        meshed(model(plate={"element": "q8r", "points": [[0, 0], [8, 0], [3, 7]]}, support=[{"edge": "edge 1"}]))
    disc = {"shape": "disc", "radius": 3, "thickness": 0.2, "element": "q8r"}
    support, load = [{"edge": "rim", "fix": "simple"}], [{"pressure": 1e3}]
    refine = [{"at": [2, 1], "size": 0.1}]
    assert not meshed(rectangular(plate=disc, mesh={}, support=support, load=load)).triangles.any()
    with pytest.raises(InputError, match=r"discs and annuli without holes and mesh\.refine, have no triangles\.$"):
        meshed(rectangular(plate=disc, mesh={"refine": refine}, support=support, load=load))


def test_areas_pass_over_holes_and_lines_do_not():
    holes = [{"circle": {"center": [2, 2], "radius": 0.5}}]
    load = [{"pressure": 3.0, "area": {"rectangle": [1, 1, 3, 3]}}]
    found = check(model(plate={"holes": holes}, load=load))
    assert found.resultants[0].force == pytest.approx(3 * (4 - np.pi / 4), rel=1e-4)
    with pytest.raises(InputError, match="The line has 50 % of its size off the plate"):
        check(model(plate={"holes": holes}, load=[{"line_load": 1.0, "line": [[1, 2], [3, 2]]}]))
    with pytest.raises(InputError, match=r"off the plate"):
        load = [{"pressure": 3.0, "area": {"rectangle": [1, 1, 3, 8.5]}}]
        check(model(plate={"holes": holes}, load=load))


def test_areas_may_reach_over_edges_by_the_last_digit_written():
    points = [[0.0, 0.0], [7.1, 3.3], [6.2, 6.7], [0.4, 5.5]]
    corners = [[round(x + 1e-6, 6), round(y - 1e-6, 6)] for x, y in points]
    support = [{"edge": "edge 1", "fix": "clamped"}]

    def loaded():
        check(model(plate={"points": points}, support=support, load=[{"pressure": 1.0, "area": {"polygon": corners}}]))

    loaded()
    corners[0][1] -= 1e-4
    with pytest.raises(InputError, match="off the plate"):
        loaded()


@pytest.mark.parametrize("stiffness", [{}, {"stiffness": 1e6}])
def test_what_is_in_a_hole_alone_is_not_on_the_plate(stiffness):
    # A small one is less than the loss of a coarse mesh at the round outline.
    for radius in (0.4, 0.02):
        area = {"circle": {"center": [2, 2], "radius": radius}}
        given = {"plate": {"holes": [{"circle": {"center": [2, 2], "radius": 0.5}}]}, "size": 1.5}
        with pytest.raises(InputError, match=r"support\[1\].area: The area is not on the plate"):
            check(model(**given, support=[{"area": area, "resists": "down", **stiffness}]))
        with pytest.raises(InputError, match=r"load\[1\].area: The area is not on the plate"):
            check(model(**given, load=[{"pressure": 2e3, "area": area}]))


def test_the_mesh_follows_lines_outlines_and_jumps():
    support = [{"line": [[1, 1], [3.2, 6.3]], "fix": "simple"}, {"edge": "edge 2", "fix": "simple"}]
    load = [{"pressure": 1.0, "area": {"rectangle": [4.6, 0.7, 7.3, 2.9]}}]
    mesh = meshed(model(plate={"thickness": "where(y < 3.6, 0.2, 0.3)"}, support=support, load=load))
    for line in ([[1, 1], [3.2, 6.3]], [[4.6, 0.7], [7.3, 0.7], [7.3, 2.9]], [[0, 3.6], [8, 3.6]]):
        assert mesh.edges_along(Polyline(tuple(map(tuple, line)))) is not None


def test_the_mesh_follows_walls_near_to_edges_and_to_each_other():
    def followed(*lines, size=0.5):
        mesh = meshed(model(size, support=[*({"line": line} for line in lines), {"edge": "edge 2"}]))
        return [mesh.edges_along(Polyline(tuple(map(tuple, line)))) is not None for line in lines], len(mesh.elements)

    alone = len(meshed(model()).elements)
    for off in (0.3, 0.2, 0.1, 0.07):
        assert followed([[0.5, off], [7, off]])[0] == [True]
        assert followed([[1, 2], [6, 2]], [[1.2, 2 + off], [6.3, 2 + off]], [[off, 2.5], [off, 7]])[0] == [True] * 3
    # Nearer ones are left out, without cost.
    assert followed([[0.5, 0.06], [7, 0.06]]) == ([False], alone)
    assert followed([[0.5, 0.1], [7, 0.1]])[1] < 3 * alone


def test_a_footprint_near_to_an_edge_is_followed():
    found = meshed(model(support=[{"at": [0.6, 0.55], "patch": [0.8, 0.8]}, {"edge": "edge 2", "fix": "simple"}]))
    sides = [[[0.2, 0.15], [1, 0.15]], [[0.2, 0.15], [0.2, 0.95]], [[0.2, 0.95], [1, 0.95]]]
    assert all(found.edges_along(Polyline(tuple(map(tuple, side)))) is not None for side in sides)


@pytest.mark.parametrize(
    "where",
    [
        {"at": [6, 2]},
        {"line": [[6, 2], [7, 3]]},
        {"edge": "edge 2"},
        {"circle": {"center": [6, 2], "radius": 1}},
        {"area": {"rectangle": [5, 1, 7, 3]}},
        {"area": {"circle": {"center": [6, 2], "radius": 1}}},
    ],
)
def test_elements_are_smaller_where_that_is_asked_for(where):
    mesh = meshed(model(mesh={"size": 0.8, "refine": [where | {"size": 0.2}]}))
    near = mesh.locate(
        np.array([[7.0, 2.0] if "circle" in where else [7.95, 2.1] if "edge" in where else [6.01, 2.01]])
    )
    assert mesh.element_area[near.elements[0]] < 2.5 * 0.2**2
    assert mesh.element_area.max() > 0.5 * 0.8**2
    assert Quality.of(mesh).angle > 30


@pytest.mark.parametrize(
    "plate", [{"shape": "disc", "radius": 2.0}, {"shape": "annulus", "inner": 0.5, "outer": 2.0, "sector": 90}]
)
def test_discs_and_annuli_may_be_refined(plate):
    refined = {"size": 0.5, "refine": [{"at": [1.2, 1.0], "size": 0.05}]}
    tables = {"material": {"E": 1.0, "nu": 0.0}, "mesh": refined, "load": [{"pressure": 1.0}]}
    support = [{"edge": "rim" if plate["shape"] == "disc" else "outer", "fix": "clamped"}]
    mesh = meshed(Model(plate=plate | {"thickness": 0.1}, support=support, **tables))
    assert mesh.element_area[mesh.locate(np.array([[1.21, 1.01]])).elements[0]] < 3 * 0.05**2
    assert mesh.element_area.max() > 0.1


def test_check_tells_how_well_elements_are_shaped():
    assert check(model()).quality == "smallest angle 90°, 100 % of the area in quadrilaterals"
    square = straight(((0, 0), (1, 0), (1, 1), (0, 1)), ("edge 1",) * 4)
    mixed = Quality.of(outlined([square, circle((0.4, 0.5), 0.2, "hole 1")], 0.2))
    assert 30 < mixed.angle < 60 and 0.8 < mixed.quadrilaterals <= 1


def test_supports_along_arcs_reach_as_far_as_the_arcs():
    """A force beside the chord between an arc's ends is balanced up to the arc, and beyond the ends it is not."""
    points = [[0, 0], [4, 0], [4, 2], {"through": [2, 3], "to": [0, 2]}]
    support = [{"edge": "edge 3", "resists": "down"}]
    for y, balanced in ((2.99, True), (2.01, True), (1.99, False)):
        load = [{"force": 1.0, "at": [2, y]}]
        assert check(model(0.5, plate={"points": points}, support=support, load=load)).balanced is balanced
