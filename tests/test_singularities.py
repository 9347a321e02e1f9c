"""Where numbers have no limit as the mesh is refined is said before anything is solved, and nowhere else."""

import json

import numpy as np
import pytest
from models import rectangular

from signorini import Model, solve
from signorini.analysis.check import check
from signorini.discretise import discretise
from signorini.formats.vtk import as_meshio, write_vtu
from signorini.mesh import meshers
from signorini.output.tables import results_json
from signorini.results.quantities import RESULTANTS
from signorini.singularities.boundary import exponents_below_one, moments_grow
from signorini.singularities.named import singularities
from signorini.singularities.singularity import away_from

HARD = {"edge": ["left", "right", "bottom", "top"], "fix": "hard"}
PRESSURE = {"pressure": 5e3}
THREE_HARD = {"edge": ["left", "bottom", "top"], "fix": "hard"}
BOX = {"rectangle": [1, 1, 3, 3]}
DISC = {"circle": {"center": [2, 2], "radius": 1}}

SIDES = {"edge": ["left", "right"], "fix": "hard"}
LEFT = {"edge": "left", "fix": "hard"}
FLOOR = {"area": "all", "resists": "down"}
SYMMETRY = {"edge": ["left", "bottom"], "fix": "symmetry"}
FEET = [[1, 1], [3, 1], [2, 3]]
CORNERS, MIDDLE, ENDS, ACROSS = [[0, 0], [4, 0], [4, 4], [0, 4]], [[2, 2]], [[1, 2], [3, 2]], [[2, 0], [2, 4]]


def held(*support, **load):
    """Tables of supports and, if given, of a load."""
    return {"support": list(support)} | ({"load": [load]} if load else {})


NOTHING = {
    "hard edges": held(HARD),
    "soft edges": held({**HARD, "fix": "simple"}),
    "clamped edges": held({**HARD, "fix": "clamped"}),
    "two hard edges": held(SIDES),
    "edges that let go": held({"edge": HARD["edge"], "resists": "down"}),
    "hard edges turned as they settle": held(SIDES | {"settlement": "1e-3*y**2", "rotation": ["1e-3*y", "2e-3*y"]}),
    "a quarter": held(SYMMETRY, {"edge": ["right", "top"], "fix": "hard"}),
    "a clamped quarter": held(SYMMETRY, {"edge": ["right", "top"], "fix": "clamped"}),
    "soil": held(FLOOR | {"stiffness": 1e7}),
    "soil within": held({"area": BOX, "resists": "down", "stiffness": 1e7}),
    "all on a floor": held(FLOOR),
    "footprints": {
        "support": [{"at": [[1, 1], [3, 1], [1, 3], [3, 3]], "resists": "down", "radius": 0.3}],
        "load": [{"force": 1e4, "at": [2, 2], "patch": [0.3, 0.4]}, {"moment": [1, 2], "at": [1, 2], "radius": 0.2}],
    },
    "a patch of pressure": held(HARD, pressure=1e4, area=DISC),
    "a line load to free edges": held(SIDES, line_load=1e4, line=ACROSS),
    "a line load that fades": held(THREE_HARD, line_load="x - 1", line=[[1, 2], [4, 2]]),
    "a round line load": held(HARD, line_load=1e4, **DISC),
    "a loaded free edge": held({"at": FEET, "resists": "down", "radius": 0.3}, line_load=1, edge="right"),
    "a load that is none": {"load": [{"force": 0, "at": [2, 2]}, PRESSURE]},
}
NAMED = {
    "a force": (held(HARD, force=1e4, at=[2, 2]), MIDDLE, "deflection moment shear"),
    "a couple": (held(HARD, moment=[1, 0], at=[2, 2]), MIDDLE, "deflection rotation moment shear"),
    "a couple about": (held(HARD, couple_about={"x": 1}, at=[2, 2]), MIDDLE, "deflection rotation moment shear"),
    "a rigid point": (held(HARD, {"at": [2, 2]}), MIDDLE, "deflection moment shear reaction"),
    "an elastic point": (held(HARD, {"at": [2, 2], "stiffness": 1e6}), MIDDLE, "deflection moment shear reaction"),
    "a clamped point": (held({"at": [2, 2], "fix": "clamped"}), MIDDLE, "deflection rotation moment shear reaction"),
    "a statically determinate plate": (held({"at": FEET, "resists": "down"}), FEET, "deflection moment shear"),
    "ends of a line load": (held(HARD, line_load=1, line=ENDS), ENDS, "shear"),
    "a bend of a line load": (
        held(THREE_HARD, line_load=1, line=[[4, 1], [2, 1], [2, 3], [4, 3]]),
        [[2, 1], [2, 3]],
        "shear",
    ),
    "a line load to a held edge": (held(HARD, line_load=1, line=[[2, 2], [4, 2]]), [[2, 2], [4, 2]], "shear"),
    "ends of a rigid line": (held(HARD, {"line": ENDS, "resists": "down"}), ENDS, "shear pressure"),
    "ends of an elastic line": (held(HARD, {"line": ENDS, "stiffness": 1e6}), ENDS, "shear"),
    "a clamped line": (held(HARD, {"line": ENDS, "fix": "clamped"}), ENDS, "moment shear pressure"),
    "a rigid disc": (held(HARD, {"area": DISC, "resists": "down"}), None, "pressure"),
    "edges on a floor": (held(FLOOR, force=1, at=[2, 2], patch=[1, 1]), None, "pressure"),
    "corners on a floor": (held(FLOOR, force=1, at=[2, 2], patch=[1, 1]), CORNERS, "shear"),
    "edges on a curved floor": (held(FLOOR | {"settlement": "1e-4*x**2"}), None, "pressure"),
    "corners of a rigid area": (
        held(HARD, {"area": BOX, "resists": "down"}),
        [[1, 1], [3, 1], [3, 3], [1, 3]],
        "shear",
    ),
    "corners between clamped and free": (held({"edge": "left", "fix": "clamped"}), [[0, 0], [0, 4]], "moment"),
    "corners between soft and free": (held(SIDES | {"fix": "simple"}), CORNERS, "shear"),
    "a corner of an edge that may let go and a soft one": (
        held({"edge": ["left", "right"], "resists": "down"}, {"edge": ["bottom", "top"], "fix": "simple"}),
        CORNERS,
        "shear",
    ),
    "a hard edge turned along itself, to free ones": (
        held(SIDES | {"rotation": [0, "1e-4*y"]}),
        [[0, 4], [4, 4]],
        "shear",
    ),
    "a hard line turned along itself, to free edges": (
        held(LEFT, {"line": ACROSS, "fix": "hard", "rotation": [0, 1e-4]}),
        ACROSS,
        "moment shear pressure",
    ),
    "where a wall ends at the edge": (
        held(LEFT, {"line": [[4, 0], [4, 2]], "fix": "simple"}),
        [[4, 0], [4, 2]],
        "shear",
    ),
    "a soft line to free edges": (held(SIDES, {"line": ACROSS, "fix": "simple"}), ACROSS, "shear pressure"),
    "a hard line to free edges": (held(SIDES, {"line": ACROSS, "fix": "hard"}), ACROSS, "moment"),
    "the end of a load on an edge": (held(LEFT, line_load=1, line=[[4, 0], [4, 2]]), [[4, 2]], "shear"),
}


def named(**tables):
    found = discretise(rectangular(**{"divisions": [8, 8], "support": [HARD], "load": [PRESSURE]} | tables))
    return found, singularities(found)


@pytest.mark.parametrize("plate", NOTHING)
def test_plates_without_singular_numbers_have_none_named(plate):
    _, found = named(**NOTHING[plate])
    assert found == ()


@pytest.mark.parametrize("plate", NAMED)
def test_singular_numbers_are_named_with_their_place(plate):
    tables, where, numbers = NAMED[plate]
    _, found = named(**tables)
    those = [one for one in found if one.numbers == tuple(numbers.split())]
    assert those
    assert all(one.advice and one.what and one.within == pytest.approx(0.2) for one in those)
    if where is not None:
        np.testing.assert_allclose(
            sorted(at for one in those for at in one.where), sorted(map(tuple, where)), atol=1e-9
        )


RING = {"circle": {"center": [1, 0], "radius": 2}}
STRAIGHT = {"edge": ["start", "end"], "fix": "hard"}
ON_HALF_DISCS = {
    "a soft ring": ({"support": [{**RING, "fix": "simple"}]}, "shear pressure"),
    "a ring that lets go": ({"support": [{**RING, "resists": "down"}]}, "shear pressure"),
    "a ring that holds the slope across": ({"support": [{**RING, "fix": ["w", "slope"]}]}, "moment shear pressure"),
    "a clamped ring": ({"support": [{**RING, "fix": "clamped"}]}, "moment"),
    "a round line load": ({"support": [STRAIGHT], "load": [{**RING, "line_load": 1}]}, "shear"),
}


@pytest.mark.parametrize("plate", ON_HALF_DISCS)
def test_rings_end_at_the_straight_sides_of_a_half_disc(plate):
    tables, numbers = ON_HALF_DISCS[plate]
    model = Model(
        material={"E": 30e9, "nu": 0.3},
        plate={"shape": "disc", "radius": 3, "center": [1, 0], "sector": 180, "thickness": 0.3},
        mesh={"divisions": [6, 6]},
        **{"load": [PRESSURE]} | tables,
    )
    (where,) = [one.where for one in singularities(discretise(model)) if one.numbers == tuple(numbers.split())]
    np.testing.assert_allclose(sorted(where), [[-1, 0], [3, 0]], atol=1e-9)


def test_corners_have_the_exponents_of_the_literature():
    # Free re-entrant corner 0.5445; clamped beside free in plane stress, ν = 0.3: 0.7583 (Williams 1952); critical
    # angles of Rössle & Sändig (2011): 61.7 degrees clamped beside free for ν = 0.29, 90 hard, 128.7 hard beside free.
    assert exponents_below_one(1.5 * np.pi, "free", "free", 0.3) == 2
    assert [moments_grow(np.radians(a), "clamped", "free", 0.3) for a in (60, 65)] == [False, True]
    assert [moments_grow(np.radians(a), "twist", "free", 0.3) for a in (128, 132)] == [False, True]
    assert [moments_grow(np.radians(a), "twist", "twist", 0.3) for a in (89.5, 92)] == [False, True]
    assert [moments_grow(np.radians(a), "slope", "twist", 0.3) for a in (44.5, 47, 90)] == [False, True, False]


def test_a_corner_inwards_of_a_mesh_file_is_named(tmp_path):
    # An L of three squares of two by two elements.
    square = meshers.rectangle((0.0, 0.0), (4.0, 4.0), (4, 4))
    mesh = square.part(np.flatnonzero((square.points[square.elements[:, :4]].mean(axis=1) < 2).any(axis=1)))
    write_vtu(tmp_path / "l.vtu", as_meshio(mesh.points, mesh.elements, {}))
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "mesh", "file": str(tmp_path / "l.vtu"), "thickness": 0.2},
        support=[{"area": "all", "stiffness": 1e7}],
        load=[PRESSURE],
    )
    (corner,) = singularities(discretise(model))
    assert corner.where == ((2.0, 2.0),)
    assert corner.numbers == ("moment", "shear")
    assert "270°" in str(corner)


@pytest.mark.parametrize("shape", [{"shape": "disc", "radius": 2}, {"shape": "annulus", "inner": 1, "outer": 2}])
def test_round_edges_have_no_corners(shape):
    rim = "rim" if shape["shape"] == "disc" else "outer"
    for divisions in ([3, 4], [4, 16]):
        model = Model(
            material={"E": 30e9, "nu": 0.2},
            plate={**shape, "thickness": 0.2},
            mesh={"divisions": [max(3, divisions[0]), max(8, divisions[1])]},
            support=[{"edge": rim, "fix": "hard"}],
            load=[PRESSURE],
        )
        assert singularities(discretise(model)) == ()


@pytest.mark.parametrize("area", ["all", BOX])
def test_what_acts_at_a_point_on_a_rigid_area_has_no_largest_pressure(area):
    floor = {"name": "floor", "area": area, "resists": "down"}
    _, found = named(support=[floor], load=[{"force": 1e4, "at": [[2, 2], [0.5, 0.5]]}])
    of_pressure = [one for one in found if one.numbers == ("pressure",) and not one.line]
    on = ((2, 2), (0.5, 0.5)) if area == "all" else ((2, 2),)
    assert [(one.where, one.source) for one in of_pressure] == [(on, "floor")]


def test_only_what_acts_is_named():
    load = [{"case": "G", "pressure": 1e3}, {"case": "Q", "force": 1e4, "at": [2, 2]}]
    combination = [{"factors": {"G": 1}}, {"factors": {"G": 1, "Q": 0}}, {"factors": {"G": 1, "Q": 1.5}}]
    results = solve(rectangular(support=[HARD], load=load, combination=combination))
    assert [[one.source for one in result.singular] for result in results.values()] == [[], [], ["Q"]]
    written = json.loads(json.dumps(results_json(results)))["combinations"][2]["singular"]
    (one,) = written
    assert (one["where"], one["numbers"], one["line"]) == ([[2.0, 2.0]], ["deflection", "moment", "shear"], False)
    assert (one["count"], one["box"]) == (1, [2.0, 2.0, 2.0, 2.0])
    assert one["what"] == "Force at a point of load[2]"
    assert "footprint" in one["advice"]
    assert len(check(results.model).singular) == 1


def test_of_many_places_some_are_listed_with_the_box_around_all():
    circle = {"area": {"circle": {"center": [2.1, 2.1], "radius": 1.03}}, "thickness": 0.3}
    model = rectangular(support=[HARD], load=[PRESSURE], zone=[circle], mesh={"divisions": [16, 16], "error": False})
    result = solve(model)["all"]
    (written,) = (one for one in results_json(solve(model))["combinations"][0]["singular"] if "within" in one["what"])
    every = max((one.where for one in result.singular), key=len)
    assert written["count"] == len(every) > 50
    assert written["where"] == [list(at) for at in every[:20]]
    assert written["box"] == [*np.min(every, axis=0), *np.max(every, axis=0)]


@pytest.mark.parametrize("footprint", [{"patch": [0.1, 0.02]}, {"radius": 0.05}])
def test_a_footprint_far_smaller_than_an_element_is_named_as_unresolved(footprint):
    small = {"support": [HARD, {"name": "foot", "at": [[1, 1], [3, 1]], **footprint}]}
    small["load"] = [{"force": 1e4, "at": [2.3, 2.2], **footprint}]
    found, (load, foot) = named(**small)
    assert str(load) == (
        "The footprint of load[1], 0.1 wide, acts as a point on this mesh: moment and shear at it are too small. "
        "Take elements of 0.05 there (mesh.refine)."
    )
    assert (load.where, foot.where, foot.source) == (((2.3, 2.2),), ((1, 1), (3, 1)), "foot")
    assert load.limited
    assert away_from(found.mesh, [load], "moment").all()
    places = [[2.3, 2.2], [1, 1], [3, 1]]
    assert named(**small, mesh={"refine": [{"at": places, "size": 0.05}]})[1] == ()


@pytest.mark.parametrize(
    "item",
    [
        {"support": [HARD, {"circle": {"center": [2, 2], "radius": 0.1}, "stiffness": 1e6}]},
        {"support": [HARD], "load": [{"line_load": 1, "circle": {"center": [2, 2], "radius": 0.1}}]},
        {"support": [HARD], "load": [{"line_load": 1, "line": [[1.9, 2], [2.1, 2]]}]},
        {"support": [HARD, {"area": {"rectangle": [1.9, 1.95, 2.1, 2.05]}, "resists": "down", "stiffness": 1e6}]},
        {"support": [HARD, {"area": {"rectangle": [1.9, 1.95, 2.1, 2.05]}, "resists": "down"}]},
    ],
)
def test_circles_lines_and_areas_far_smaller_than_an_element_are_named_as_unresolved(item):
    _, found = named(**item)
    (one,) = [one for one in found if one.limited]
    np.testing.assert_allclose(one.where, [(2.0, 2.0)])
    assert "0.2 wide, acts as a point on this mesh" in str(one)


@pytest.mark.parametrize("fix", ["symmetry", "hard", "clamped"])
@pytest.mark.parametrize(
    "place",
    [{"circle": {"center": [2, 2], "radius": 0.7}}, {"line": [[0.3, 0.3], [3.6, 3.1]]}],
    ids=["circle", "line"],
)
def test_lines_that_hold_slopes_within_elements_are_named_unless_the_mesh_follows_them(fix, place):
    held = {"name": "held", **place, "fix": fix}
    (kind,) = place
    pads = {"at": [[1, 1], [3, 1], [1, 3], [3, 3]], "resists": "both", "radius": 0.3}
    inside = {}
    for mesh in ({"divisions": [8, 8]}, {"size": 0.4}):
        found = discretise(rectangular(mesh=mesh, support=[pads, held], load=[PRESSURE]))
        inside["divisions" in mesh] = [one for one in singularities(found) if "within" in one.what]
    assert not inside[False]
    (one,) = inside[True]
    assert (one.numbers, one.source, one.within, one.limited) == (("moment", "shear"), "held", 0.0, False)
    assert one.what.startswith(f"The {kind} of held within ") and "Give mesh.size, not divisions." in one.advice
    x, y = np.array(one.where).T
    off_circle, off_line = np.hypot(x - 2, y - 2) - 0.7, (2.8 * (x - 0.3) - 3.3 * (y - 0.3)) / np.hypot(2.8, 3.3)
    away = np.abs(off_circle if kind == "circle" else off_line)
    assert away.max() <= np.hypot(0.5, 0.5)
    loose = rectangular(mesh={"divisions": [8, 8]}, support=[pads, {**place, "resists": "both"}], load=[PRESSURE])
    assert not [one for one in singularities(discretise(loose)) if "within" in one.what]


def test_wheels_with_small_prints_are_named_as_unresolved():
    truck = {"case": "truck", "line": [[0.5, 2], [3.5, 2]], "step": 1.0, "axles": [[0, 1e4]], "patch": [0.05, 0.1]}
    combination = [{"name": "traffic", "generate": "positions", "factors": {"truck": 1}}]
    _, found = named(moving=[truck], combination=combination)
    assert {one.what for one in found} == {"The footprint of wheels of truck, 0.1 wide,"}
    truck["patch"] = [0.3, 0.4]
    assert named(moving=[truck], combination=combination)[1] == ()


def test_wheels_are_named_where_they_stand():
    moving = {"case": "truck", "line": [[0, 2], [4, 2]], "step": 2, "axles": [0, 1e4]}
    model = rectangular(support=[HARD], load=[PRESSURE], moving=[moving])
    found = discretise(model)
    (one,) = singularities(found, {"truck@2"})
    assert one.where == ((2.0, 2.0),)
    patched = rectangular(support=[HARD], load=[PRESSURE], moving=[{**moving, "patch": [0.8, 0.8]}])
    assert singularities(discretise(patched)) == ()


def test_peaks_leave_singular_places_out():
    """The envelope's largest moment stays where it is under finer meshes; under the force it grows."""
    load = [{"case": "G", "pressure": 5e3}, {"case": "Q", "force": 1e4, "at": [1, 1]}]
    combination = [{"factors": {"G": 1, "Q": q}} for q in (0.5, 1)]
    tables = {"support": [HARD], "load": load, "combination": combination, "output": {"combinations": "table"}}
    largest = []
    for n in (8, 16, 32):
        results = solve(rectangular(divisions=[n, n], **tables))
        peak = results_json(results)["envelope"]["fields"]["mx"]
        largest.append(peak["max"])
        assert np.hypot(peak["max_at"][0] - 1, peak["max_at"][1] - 1) > 0.2
        assert peak["max"] < results.envelope.fields["mx"].largest.max()
        single = results[peak["max_by"]].extremes["mx"]
        assert (peak["max"], peak["max_at"]) == (pytest.approx(single.max, rel=1e-9), list(single.max_at))
    assert np.ptp(largest[1:]) < 0.05 * largest[-1]


@pytest.mark.parametrize("solver", ["lemke", "active_set"])
def test_peaks_of_rows_leave_out_what_acts_in_them_alone(solver):
    """Without the force its place is not excluded; with it the row equals the single result."""
    moving = {"case": "wheel", "line": [[1, 1.5], [3, 1.5]], "step": 1, "axles": [0, 2e3]}
    rows = {"without": [1.0, 0.0], "with": [1.0, 1.0], "less": [0.5, 0.2]}
    results = solve(
        rectangular(
            divisions=[12, 12],
            support=[HARD, {"at": [2, 2], "resists": "down"}],
            load=[{"case": "G", "pressure": 5e3}, {"case": "Q", "force": 1e3, "at": [2, 3]}],
            moving=[moving],
            combination=[
                {"name": "t", "generate": "table", "columns": ["G", "Q"], "rows": rows},
                {"name": "w", "generate": "positions", "factors": {"G": 1.0, "wheel": 1.0}},
            ],
            output={"combinations": "table"},
            solver={"method": solver},
        )
    )
    table = results.table
    for row, name in enumerate(results):
        for field in ("deflection", *RESULTANTS):
            ends = results[name].extremes[field]
            for side in ("max", "min"):
                value = table[f"{side}:{field}"][row]
                assert value == pytest.approx(getattr(ends, side), rel=1e-6, abs=1e-9 * abs(ends.max)), (name, field)
    rows_of_mx = table["max:mx"]
    assert results_json(results)["envelope"]["fields"]["mx"]["max"] == max(rows_of_mx)


def test_extremes_name_the_singular_place_that_they_leave_out():
    load = [{"pressure": 5e3}, {"force": 1e4, "at": [1, 1]}]
    result = solve(rectangular(divisions=[32, 32], support=[HARD], load=load))["all"]
    mx = result.extremes["mx"]
    assert mx.max_beside == "Force at a point of load[2]"
    assert mx.max < result.moment[:, 0].max()
    assert np.hypot(mx.max_at[0] - 1, mx.max_at[1] - 1) > 0.2
    assert mx.min_beside == ""
    assert mx.min == result.moment[:, 0].min()
    written = results_json(solve(rectangular(divisions=[32, 32], support=[HARD], load=load)))["combinations"][0]
    assert written["fields"]["mx"]["max"] == mx.max
    assert written["fields"]["mx"]["max_beside"] == mx.max_beside


@pytest.mark.parametrize(
    ("plate", "number"),
    [
        ("ends of a line load", "shear"),
        ("a force", "moment"),
        ("a hard line to free edges", "moment"),
        ("a hard edge turned along itself, to free ones", "shear"),
    ],
)
def test_what_is_named_grows_with_every_finer_mesh(plate, number):
    tables, where, _ = NAMED[plate]
    peaks = []
    for n in (8, 16, 32):
        result = solve(
            rectangular(**{"divisions": [n, n], "thickness": 0.5, "support": [HARD], "load": [PRESSURE]} | tables)
        )["all"]
        near = np.hypot(*(result.stress_nodes.points - where[0]).T) < 0.3
        peaks.append(np.abs(result.stress_nodes.spread(getattr(result, number))[near]).max())
    first, second = np.diff(peaks)
    assert second > 0.9 * first > 0


@pytest.mark.parametrize("times", [3, 5, 6])
def test_numbers_are_taken_for_a_peak_within_the_thickness_there_of_borders_the_thinner_side_s(times):
    """A column's zone on a base plate, however thick it is, leaves the plate beside it among the extremes."""
    column = {"area": {"rectangle": [-120, -120, 120, 120]}, "thickness": 40 * times}
    model = Model(
        material={"E": 210e3, "nu": 0.3},
        plate={"shape": "rectangle", "size": [600, 400], "origin": [-300, -200], "thickness": 40},
        mesh={"size": 20, "error": False},
        zone=[column],
        support=[{"name": "grout", "area": "all", "resists": "both", "stiffness": 800}],
        load=[{"couple_about": {"y": -80e6}, "at": [0, 0], "patch": [240, 240]}],
        section=[{"line": [[121, -200], [121, 200]]}],
    )
    found = discretise(model)
    assert {one.within for one in singularities(found)} == {40.0}
    (result,) = solve(model).values()
    assert abs(result.sections[0].moment) / 400 < max(result.extremes["mx"].max, -result.extremes["mx"].min)
    assert not result.warnings


def test_a_plate_that_lies_beside_places_without_a_limit_is_warned_of():
    pad = {"size": [1, 1], "thickness": 0.6, "shape": "rectangle"}
    feet = {"name": "feet", "at": [[0.1, 0.1], [0.9, 0.1], [0.5, 0.9]], "resists": "both"}
    heavy = {"at": [0.5, 0.5], "force": 1e3}
    model = rectangular(plate=pad, support=[feet], load=[heavy], mesh={"divisions": [4, 4], "error": False})
    (result,) = solve(model).values()
    assert any("All of the plate" in warning and "moments have no limit" in warning for warning in result.warnings)


WITHIN = [
    {"load": [{"force": 1e3, "at": [2, 2]}]},
    {"load": [{"couple_about": {"x": 1e3}, "at": [[2, 2], [1.5, 2], [2.3, 1.8]]}]},
    {"load": [{"force": 1e3, "at": [2.2, 2], "radius": 0.01}]},
    {"load": [{"line_load": 1e3, "line": [[1.8, 2], [2.2, 2]]}]},
    {"support": [{"at": [[2, 2], [2.5, 1.5]], "stiffness": 1e7, "rotational_stiffness": 1e6}]},
    {"support": [{"at": [[2, 2]], "fix": "simple"}]},
    {"support": [{"at": [[2, 2]], "radius": 0.01, "resists": "down"}]},
    {"support": [{"line": [[1.8, 2], [2.2, 2]], "resists": "down"}]},
    {"support": [{"area": {"rectangle": [1.8, 1.8, 2.2, 2.2]}, "resists": "down"}]},
    {"moving": [{"case": "lorry", "line": [[1.75, 2], [2.25, 2]], "step": 0.5, "axles": [[0, 1e3]]}]},
    {"zone": [{"area": {"rectangle": [1.75, 1.75, 2.25, 2.25]}, "thickness": 0.4}]},
]


@pytest.mark.parametrize("given", WITHIN)
def test_what_acts_on_a_rigid_zone_is_no_singularity(given):
    zone = {"area": {"rectangle": [1.5, 1.5, 2.5, 2.5]}, "rigid": True}
    edges = {"edge": ["left", "right", "top", "bottom"], "fix": "hard"}
    parts = {
        "support": [edges, *given.get("support", [])],
        "load": given.get("load", [{"pressure": 1e3}]),
        "zone": [zone, *given.get("zone", [])],
    }
    named = [
        singularities(discretise(rectangular(divisions=[8, 8], **{**given, **parts, "zone": zones})))
        for zones in (parts["zone"], given.get("zone", []))
    ]
    assert {one.what.split(" at ")[0] for one in named[0]} == {"Corner of a rigid zone"}
    # Without the rigid zone there is some.
    assert named[1]
