"""Supports are found on the mesh once, and everything lists their points as the input does."""

import math

import numpy as np
import pytest
from models import rectangular
from tensionless import slab_a

from signorini import Model, estimate, solve
from signorini.discretise import discretise
from signorini.errors import InputError
from signorini.formats.vtk import as_meshio, write_vtu
from signorini.mesh import Mesh, meshers
from signorini.shapes import Polyline, Ring

PLATE = {
    "load": [{"pressure": 5e3}],
}


@pytest.mark.parametrize("how", [{"fix": "simple"}, {"stiffness": 1e8}, {"resists": "down"}, {"gap": 1e-4}])
def test_points_keep_the_order_of_the_input(how):
    # Nodes and points between them, two of them as near to each other as supports may be.
    at = [[3.3, 3.1], [1, 1], [0.4, 3.3], [3, 1], [0.42, 3.3]]
    other = {"at": [2.1, 2.2], "stiffness": 1e6}
    (result,) = solve(rectangular(**PLATE, support=[other, {"at": at, **how}])).values()
    np.testing.assert_allclose(result.supports[1].positions, at, rtol=0, atol=1e-12)


@pytest.mark.parametrize("apart", [0.0, 1e-11, 1e-10, 1e-9, 5e-9, 2e-8])
def test_points_all_but_at_one_place_are_at_one_place(apart):
    """A spring at a closed rigid bearing carries no load, and once separated them at some of these distances."""
    bearings = {"name": "a", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}
    beside = {"name": "c", "at": [1 + apart, 1], "resists": "both"}
    spring = {"name": "d", "at": [3, 1], "resists": "both", "stiffness": 1e12}
    for more in ([], [spring]):
        support = [bearings, beside, *more]
        model = rectangular(mesh={"divisions": [6, 6]}, support=support, load=[{"pressure": 1e4}])
        result = solve(model)["all"]
        assert list(result.reactions.values())[:2] == pytest.approx([140000, 20000], rel=1e-9)
        assert result.supports[1].positions[0, 0] == 1 + apart and result.not_unique


def test_an_area_off_a_round_edge_is_told_how_far() -> None:
    corners = [[0, 0], [4.5, 0], [0, 4]]
    load = [{"pressure": 1e3, "area": {"polygon": corners}}]
    plate = {"shape": "disc", "radius": 4, "thickness": 0.2}
    model = Model(material={"E": 30e9, "nu": 0.2}, plate=plate, support=[{"edge": "rim", "fix": "simple"}], load=load)
    with pytest.raises(InputError, match=r"% of its size off the plate, up to 0\.5 beyond it at \[4\.5, 0\]"):
        discretise(model)


@pytest.mark.parametrize("what", [{"resists": "both"}, {"resists": "down", "stiffness": 1e6}])
@pytest.mark.parametrize("mesh", [{"size": 0.4}, {"divisions": [10, 10]}])
def test_a_circle_that_leaves_the_plate_is_refused_whether_the_mesh_follows_it_or_not(what, mesh) -> None:
    circle = {"center": [0, 0], "radius": 1.5}
    model = rectangular(mesh=mesh, support=[{"circle": circle, **what}], load=[{"pressure": 1e3}])
    with pytest.raises(InputError, match=r"support\[1\]\.circle: The circle has 75 % of its size off the plate"):
        discretise(model)
    load = [{"line_load": 1e3, "circle": circle}]
    model = rectangular(mesh=mesh, support=[{"edge": "left", "fix": "clamped"}], load=load)
    with pytest.raises(InputError, match=r"load\[1\]\.circle: The circle has 75 % of its size off the plate"):
        discretise(model)


def test_lines_and_circles_of_supports_and_loads_are_followed_where_the_elements_are_not_counted() -> None:
    oblique, ring = Polyline(((0.5, 0.5), (3.0, 2.2))), Ring((2.2, 2.1), 0.9)
    support = {"line": [[0.5, 0.5], [3.0, 2.2]], "resists": "both"}
    load = {"line_load": 1e3, "circle": {"center": [2.2, 2.1], "radius": 0.9}}
    for items, followed in ((([support], [{"pressure": 1e3}]), oblique), (([BESIDE], [load]), ring)):
        model = rectangular(mesh={"size": 0.4}, support=items[0], load=items[1])
        assert model.divisions is None and discretise(model).mesh.edges_along(followed) is not None
        counted = rectangular(mesh={"divisions": [10, 10]}, support=items[0], load=items[1])
        assert counted.divisions == (10, 10) and discretise(counted).mesh.edges_along(followed) is None
    disc = {"shape": "disc", "radius": 3, "thickness": 0.2}
    for at, rows in (([0, 0], True), ([0.5, 0], False)):
        held = [{"circle": {"center": at, "radius": 2}, "resists": "both"}]
        model = rectangular(plate=disc, mesh={"size": 0.4}, support=held, load=[{"pressure": 1e3}])
        assert (model.divisions is not None) == rows
        assert discretise(model).mesh.edges_along(Ring((at[0], at[1]), 2.0)) is not None


BESIDE = {"edge": "left", "fix": "clamped"}


SNAP = 2e-3
EDGES = {"name": "edges", "edge": ["left", "right", "bottom", "top"], "fix": "simple"}
TURNED = 2 * np.pi * (np.arange(8) + 0.3) / 8
ON_RING = np.column_stack([5 + 3 * np.cos(TURNED), 4 + 3 * np.sin(TURNED)]).tolist()


ALL_BUT_TOUCHING = pytest.mark.parametrize(
    ("exact", "rounded"),
    [
        ([{"line": [[2, 0], [7, 6]], "resists": "down"}], [{"line": [[2, 1e-3], [7, 6]], "resists": "down"}]),
        ([{"line": [[2, 0], [7, 6]], "resists": "down"}], [{"line": [[2, -1e-7], [7, 6]], "resists": "down"}]),
        ([{"line": [[2, 0], [2, 8]], "fix": "simple"}], [{"line": [[2, 1e-6], [2, 8.0004]], "fix": "simple"}]),
        *(
            (
                [{"line": [[0, 2], [10, 5]], "fix": "simple"}, {"line": [[5, 3.5], [6, 8]], "fix": "simple"}],
                [{"line": [[0, 2], [10, 5]], "fix": "simple"}, {"line": [[5, y], [6, 8]], "fix": "simple"}],
            )
            for y in (3.4999, 3.5003)
        ),
        ([], [{"at": [[3, 1e-9], [0.0004, 2], [10, 3]], "resists": "both"}]),
        ([], [{"line": [[1e-6, 0], [0, 8]], "resists": "down"}]),
    ],
)


@ALL_BUT_TOUCHING
def test_what_all_but_touches_an_edge_or_a_wall_is_snapped_onto_it(exact, rounded) -> None:
    plate = {"shape": "rectangle", "size": [10, 8], "thickness": 0.3}

    def solved(support):
        mesh = {"size": 0.7, "snap": SNAP}
        return solve(rectangular(plate=plate, mesh=mesh, support=[EDGES, *support], load=[{"pressure": 1e4}]))["all"]

    assert_alike(solved(rounded), solved(exact), exact)


def assert_alike(found, wanted, exact) -> None:
    assert found.deflection.max() == pytest.approx(wanted.deflection.max(), rel=2e-3)
    others = [list(one.reactions.values())[1:] for one in (found, wanted)]
    assert others[0] == pytest.approx(others[1], rel=5e-3) if exact else max(map(abs, others[0])) < 5e4


@ALL_BUT_TOUCHING
def test_what_all_but_touches_an_edge_of_a_mesh_from_a_file_is_snapped_onto_it(tmp_path, exact, rounded) -> None:
    found, wanted = (solve(on_a_file(tmp_path, [], support))["all"] for support in (rounded, exact))
    assert_alike(found, wanted, exact)


def on_a_file(tmp_path, followed, support) -> Model:
    """The same plate read from a file, whose mesh follows some supports."""
    drawn, load = {"shape": "rectangle", "size": [10, 8], "thickness": 0.3}, [{"pressure": 1e4}]
    mesh = discretise(rectangular(plate=drawn, mesh={"size": 0.7}, support=[EDGES, *followed], load=load)).mesh
    plate = {"shape": "mesh", "file": written(tmp_path / "plate.vtu", mesh), "thickness": 0.3}
    held = [{"name": "edges", "edge": "boundary", "fix": "simple"}, *support]
    return rectangular(plate=plate, mesh={"snap": SNAP}, support=held, load=load)


def test_a_wall_that_all_but_ends_at_a_node_of_a_mesh_from_a_file_is_snapped_onto_it(tmp_path) -> None:
    """It goes askew across the edge: its nearest place there would be off the sides that follow it."""
    exact = {"line": [[2, 0], [7, 6]], "resists": "down"}
    found = discretise(on_a_file(tmp_path, [exact], [exact | {"line": [[2, 1e-3], [7, 6]]}]))
    assert found.model.support[1].line == ((2.0, 0.0), (7.0, 6.0))
    assert found.mesh.edges_along(Polyline(((2.0, 0.0), (7.0, 6.0)))) is not None


def written(file, mesh):
    write_vtu(file, as_meshio(mesh.points, mesh.elements, {}))
    return str(file)


@pytest.mark.parametrize("held", [{"fix": "simple"}, {"resists": "both"}])
@pytest.mark.parametrize(
    "plate",
    [
        {"shape": "rectangle", "size": [10, 8], "thickness": 0.3},
        {"shape": "disc", "radius": 4, "center": [5, 4], "thickness": 0.3},
    ],
)
def test_rigid_points_on_a_rigid_circle_do_nothing(plate, held) -> None:
    """They are up to 1e-5 off the curved sides that stand for it, and would clamp the plate there."""
    ring = {"circle": {"center": [5, 4], "radius": 3}, **held}

    def solved(*more):
        model = rectangular(plate=plate, mesh={"size": 0.8333}, support=[ring, *more], load=[{"pressure": 1e4}])
        return solve(model)["all"].probe([[5, 4]])[0]

    wanted, found = solved(), solved({"at": ON_RING, "resists": "both"})
    assert found.deflection == pytest.approx(wanted.deflection, rel=1e-6)
    assert found.moment == pytest.approx(wanted.moment, rel=1e-6, abs=1e-3)


@pytest.mark.parametrize("off", [3e-4, 3e-3, -3e-3])
def test_points_beside_arcs_of_the_mesh_stay_where_they_are(off) -> None:
    """Without a held circle, places are not moved onto the mesh's circles: a plane stays a plane."""
    plane = np.array([0.01, -0.01, 0.005])
    at = (7 / 3 + off) * np.array([np.cos(0.07), np.sin(0.07)])
    settlement = float(plane @ [1.0, *at])
    held = {"at": at.tolist(), "fix": "clamped", "settlement": settlement, "rotation": plane[1:].tolist()}
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "annulus", "inner": 1.0, "outer": 3.0, "thickness": 0.05},
        mesh={"size": 0.7, "error": False},
        support=[held],
        load=[{"pressure": 0.0}],
    )
    mesh = discretise(model).mesh
    assert np.abs(np.hypot(*mesh.points.T) - 7 / 3).min() < 1e-9
    found = solve(model)["all"].deflection
    assert found == pytest.approx(plane[0] + mesh.points @ plane[1:], abs=1e-12)


def test_a_circle_that_all_but_is_the_rim_is_snapped_onto_it() -> None:
    disc = {"shape": "disc", "radius": 5, "thickness": 0.3}
    rim = {"edge": "rim", "fix": "simple"}
    ring = {"circle": {"center": [0, 0], "radius": 4.9999999}, "resists": "down"}
    material = {"E": 30e9, "nu": 0.2}
    load = [{"pressure": 1e4}]
    mesh = {"size": 0.8, "snap": SNAP}
    model = rectangular(material=material, plate=disc, mesh=mesh, support=[rim, ring], load=load)
    # Timoshenko & Woinowsky-Krieger (1959), eq. 68, and the shear's share.
    stiff = 30e9 * 0.3**3 / 12 / (1 - 0.2**2)
    bent = 1e4 * 5**4 * 5.2 / (64 * 1.2 * stiff) + 1e4 * 5**2 / (4 * 5 / 6 * 30e9 / 2.4 * 0.3)
    assert solve(model)["all"].deflection.max() == pytest.approx(bent, rel=1e-3)


def rounded_disc(digits):
    """A disc of radius 5 whose coordinates have a number of digits."""
    mesh = meshers.disc((0.0, 0.0), 5.0, (4, 24))
    points = np.array([[float(f"{x:.{digits}g}") for x in point] for point in mesh.points])
    return Mesh(points, mesh.elements, {})


@pytest.mark.parametrize("radius", [4.9999999, 5.0000001, 5.0001, 5.003])
@pytest.mark.parametrize("digits", [8, 17])
def test_a_ring_that_all_but_is_a_round_edge_is_divided_as_its_sides_are(tmp_path, radius, digits) -> None:
    """No side of an element crosses a ring just outside the nodes, whose pieces once spanned several elements."""
    file = written(tmp_path / "disc.vtu", rounded_disc(digits))
    read = {"shape": "mesh", "file": file, "thickness": 0.3}
    ring = {"circle": {"center": [0, 0], "radius": radius}, "stiffness": 1e8}
    drawn = {"shape": "disc", "radius": 5, "thickness": 0.3}
    for plate, options in ((read, {}), (drawn, {"size": 1.0})):
        made = [
            rectangular(plate=plate, mesh=options, support=[held], load=[{"pressure": 1e4}])
            for held in (ring, {"edge": "boundary" if plate is read else "rim", "stiffness": 1e8})
        ]
        found, wanted = (solve(model)["all"] for model in made)
        assert found.deflection.max() == pytest.approx(wanted.deflection.max(), rel=5e-3)
        assert len(discretise(made[0]).springs) == len(discretise(made[1]).springs)


@pytest.mark.parametrize("radius", [5, 4.9999999])
@pytest.mark.parametrize("digits", [8, 17])
def test_what_all_but_is_on_a_round_edge_of_a_mesh_from_a_file_is_there(tmp_path, radius, digits) -> None:
    """A ring wall that all but is the rim, a wall that ends beside it, and points on it, between nodes."""
    file = written(tmp_path / "disc.vtu", rounded_disc(digits))
    plate = {"shape": "mesh", "file": file, "thickness": 0.3}
    rim = {"name": "rim", "edge": "boundary", "fix": "simple"}
    ring = {"circle": {"center": [0, 0], "radius": radius}, "resists": "down"}
    wall = {"line": [[0, 0], [radius * np.cos(0.2), radius * np.sin(0.2)]], "fix": "simple"}
    on = {"at": (radius * np.column_stack([np.cos(TURNED), np.sin(TURNED)])).tolist(), "resists": "both"}

    def solved(*support):
        return solve(rectangular(plate=plate, mesh={}, support=support, load=[{"pressure": 1e4}]))["all"]

    alone, with_wall = solved(rim), solved(rim, wall | {"line": [[0, 0], [5 * np.cos(0.2), 5 * np.sin(0.2)]]})
    for support, wanted in (((rim, ring), alone), ((rim, on), alone), ((rim, wall), with_wall)):
        found = solved(*support)
        assert found.deflection.max() == pytest.approx(wanted.deflection.max(), rel=1e-3)


def test_small_circles_are_not_followed_with_many_small_elements() -> None:
    columns = [{"circle": {"center": [x, y], "radius": 0.02}, "resists": "down"} for x in (2, 5, 8) for y in (2, 6)]
    plate = {"shape": "rectangle", "size": [10, 8], "thickness": 0.3}
    model = rectangular(plate=plate, mesh={"size": 0.8333}, support=columns, load=[{"pressure": 1e4}])
    assert model.divisions is not None
    assert estimate(solve(model)["all"]).plus_minus is not None


@pytest.mark.parametrize("size", [5e-8, 1e-12])
@pytest.mark.parametrize("place", [{"line": [[1, 1], [3, 2]]}, {"circle": {"center": [2, 1.5], "radius": 1}}])
@pytest.mark.parametrize("shape", ["rectangle", "disc"])
def test_far_too_small_elements_beside_lines_are_refused_before_they_take_memory(shape, place, size) -> None:
    """In pieces of their size the line, or the rim, alone would not fit into memory; one took more than a minute."""
    hole = {"circle": {"center": [2, 2.2], "radius": 0.3}}
    plate = {"size": [4, 3]} if shape == "rectangle" else {"center": [2, 1.5], "radius": 2, "holes": [hole]}
    clamped = {"edge": "left" if shape == "rectangle" else "rim", "fix": "clamped"}
    model = rectangular(
        plate={"shape": shape, "thickness": 0.2, **plate},
        mesh={"size": size},
        support=[clamped, place],
        load=[{"pressure": 1}],
    )
    words = r"Elements of size 5e-8, .* would be more than the \d+ that there is room for. Give larger sizes\.$"
    with pytest.raises(InputError, match=words if size > 1e-8 else "1e-12; it must be at least 4e-08"):
        discretise(model)


def _refined_at_a_point(shape, away, size):
    outline = (
        {"origin": [away, away], "size": [4, 3]} if shape == "rectangle" else {"center": [away, away], "radius": 4}
    )
    return rectangular(
        plate={"shape": shape, "thickness": 0.2, **outline},
        mesh={"size": 1.0, "refine": [{"at": [away + 1, away + 2], "size": size}]},
        support=[{"area": "all", "resists": "down", "stiffness": 1e7}],
        load=[{"pressure": 1e3}],
    )


@pytest.mark.parametrize(("shape", "area"), [("rectangle", 12.0), ("disc", 16.0 * math.pi)])
@pytest.mark.parametrize("away", [0.0, 1e6])
def test_elements_may_be_as_small_as_rounding_of_coordinates_allows(shape, area, away) -> None:
    result = solve(_refined_at_a_point(shape, away, 1.01e-8 * (away + 4.0)))["all"]
    assert sum(result.reactions.values()) == pytest.approx(1e3 * area, rel=1e-5)


@pytest.mark.parametrize("shape", ["rectangle", "disc"])
@pytest.mark.parametrize(("away", "size"), [(0.0, 1e-9), (0.0, 1e-14), (1e6, 1e-3), (1e6, 1e-9), (1e6, 1e-11)])
def test_elements_that_rounding_would_shape_are_refused(shape, away, size) -> None:
    """They folded, or missed each other's nodes; sizes of 1e-11 beside coordinates of 1e6 took all memory."""
    with pytest.raises(InputError, match=rf"size: found {size:g}; it must be at least .* put the origin nearer"):
        discretise(_refined_at_a_point(shape, away, size))


def test_far_too_small_elements_in_an_area_are_refused_before_they_take_memory() -> None:
    disc = {"shape": "disc", "radius": 3, "thickness": 0.2}
    refine = [{"area": {"rectangle": [0, 0, 1, 1]}, "size": 1e-7}]
    model = rectangular(plate=disc, mesh={"refine": refine}, support=[{"edge": "rim"}], load=[{"pressure": 1e3}])
    with pytest.raises(InputError, match=r"size: found 1e-07, with more than 1e\+07 elements"):
        discretise(model)


@pytest.mark.parametrize("place", [{"circle": {"center": [3, 0], "radius": 1e60}}, {"line": [[1, 1], [1e60, 1]]}])
def test_what_is_drawn_far_beyond_the_plate_is_refused_before_it_is_divided(place) -> None:
    disc = {"shape": "disc", "radius": 3, "thickness": 0.2}
    load = [{"line_load": 1.0, **place}]
    model = rectangular(plate=disc, mesh={"size": 1.0}, support=[{"edge": "rim", "fix": "simple"}], load=load)
    with pytest.raises(InputError, match="is not on the plate"):
        discretise(model)


def test_a_small_circle_in_a_large_element_holds_the_plate() -> None:
    for ways in ({"resists": "both"}, {"resists": "down"}, {"fix": "simple"}):
        support = {"circle": {"center": [2.3, 1.7], "radius": 0.1}, **ways}
        model = rectangular(divisions=[1, 1], support=[support], load=[{"force": 1e3, "at": [2.32, 1.7]}])
        (held,) = solve(model)["all"].supports
        assert held.reaction == pytest.approx(1e3)


def test_where_nothing_is_held_every_contact_point_stays() -> None:
    tables = slab_a(4).model_dump(exclude_unset=True)
    wall = {"name": "wall", "edge": "left", "fix": "clamped"}
    free, held = (
        discretise(Model.model_validate({**tables, "support": support}))
        for support in (tables["support"], [*tables["support"], wall])
    )
    # Four points across a side on the outline, three at other sides and beside held nodes.
    assert len(free.contacts) == 4 * 9 + 8 * 12 + 4 * 16
    assert len(held.contacts) < len(free.contacts)
