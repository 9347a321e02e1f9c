"""Promises of the documents for `rigid = true` and `extremes = false`."""

from __future__ import annotations

import numpy as np
import pytest
from models import rectangular

from signorini import InputError, Model, estimate, path, solve
from signorini.discretise import discretise

MATERIAL = {"E": 30e9, "nu": 0.2, "unit_weight": 25e3}
COLUMN = {"area": {"rectangle": [1, 1, 2, 2]}, "rigid": True}


def slab(**changes):
    parts = {
        "material": MATERIAL,
        "plate": {"shape": "rectangle", "size": [4, 3], "thickness": 0.2},
        "mesh": {"divisions": [8, 6]},
        "zone": [COLUMN],
        "support": [
            {"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7},
            {"name": "anchors", "at": [[0.5, 0.5], [0.5, 2.5]], "resists": "up", "stiffness": 1e7},
        ],
        "load": [
            {"case": "G", "self_weight": True},
            {"case": "N", "force": 2e5, "at": [1.5, 1.5]},
            {"case": "M", "moment": [2e5, -1e5], "at": [1.5, 1.5]},
        ],
        "combination": [{"name": "all", "factors": {"G": 1, "N": 1, "M": 1}}],
    }
    return Model(**{**parts, **changes})


def is_one_body(result, inside):
    points = result.mesh.points[inside]
    plane = np.column_stack([np.ones(len(points)), points])
    return np.abs(plane @ np.linalg.lstsq(plane, result.deflection[inside])[0] - result.deflection[inside]).max()


def test_a_rigid_zone_stays_plane_and_has_no_moments_or_shears():
    model = slab()
    result = solve(model)["all"]
    x, y = result.mesh.points.T
    inside = (x >= 1) & (x <= 2) & (y >= 1) & (y <= 2)
    assert is_one_body(result, inside) < 1e-14 * np.ptp(result.deflection)
    nodes = result.stress_nodes
    within = np.unique(nodes.elements[nodes.left_out])
    assert len(within) == inside.sum()
    assert not any(result.fields[name][within].any() for name in ("mx", "my", "mxy", "qx", "qy"))
    at = np.array([result.extremes[name].max_at for name in result.extremes])
    assert ((at <= 1) | (at >= 2)).any(axis=1).all()
    assert sum(result.reactions.values()) == pytest.approx(25e3 * 0.2 * 12 + 2e5, rel=1e-10)


def test_a_force_anywhere_on_a_rigid_zone_is_its_resultant():
    at_middle = slab(
        load=[
            {"case": "G", "force": 1e5, "at": [1.5, 1.5]},
            {"case": "N", "moment": [2e4, 0], "at": [1.5, 1.5]},
            {"case": "M", "pressure": 0},
        ]
    )
    beside = slab(
        load=[{"case": "G", "force": 1e5, "at": [1.7, 1.5]}, {"case": "N", "pressure": 0}, {"case": "M", "pressure": 0}]
    )
    one, other = (solve(model)["all"].deflection for model in (at_middle, beside))
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-9 * np.abs(one).max())


def test_rigid_zones_that_touch_are_one_body():
    touching = slab(zone=[{**COLUMN, "area": {"rectangle": box}} for box in ([1, 1, 1.5, 2], [1.5, 1, 2, 2])])
    one, other = (solve(model)["all"].deflection for model in (slab(), touching))
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(one).max())
    corners = discretise(slab(zone=[COLUMN, {**COLUMN, "area": {"rectangle": [2, 2, 3, 3]}}]))
    bodies = corners.held.bodies
    assert len(set(bodies.leaders[bodies.inside].tolist())) == 1


def test_a_quarter_with_edges_of_symmetry_through_a_rigid_zone_is_the_whole():
    def plate(size, divisions, column, edges, force):
        return Model(
            material=MATERIAL,
            plate={"shape": "rectangle", "size": [size, size], "thickness": 0.2},
            mesh={"divisions": [divisions, divisions]},
            zone=[{"area": {"rectangle": column}, "rigid": True}],
            support=edges,
            load=[{"force": force, "at": [2, 2]}],
        )

    around = ["left", "right", "bottom", "top"]
    whole = solve(plate(4, 8, [1, 1, 3, 3], [{"edge": around, "fix": "simple"}], 4e5))["all"]
    fixed = [{"name": "wall", "edge": around[::2], "fix": "simple"}, {"edge": around[1::2], "fix": "symmetry"}]
    quarter = solve(plate(2, 4, [1, 1, 2, 2], fixed, 1e5))["all"]
    assert quarter.deflection.max() == pytest.approx(whole.deflection.max(), rel=1e-9)
    assert quarter.reactions["wall"] == pytest.approx(1e5, rel=1e-10)


@pytest.mark.parametrize("fix", ["simple", "hard", "clamped"])
def test_a_held_edge_runs_through_a_rigid_zone(fix):
    edges = {"name": "walls", "edge": ["left", "right"], "fix": fix}
    model = slab(support=[edges], zone=[{**COLUMN, "area": {"rectangle": [0, 1, 1, 2]}}])
    result = solve(model)["all"]
    assert result.reactions["walls"] == pytest.approx(25e3 * 0.2 * 12 + 2e5, rel=1e-10)
    assert np.abs(result.deflection[result.mesh.points[:, 0] == 0]).max() < 1e-15
    assert result.certificate.passed


def test_combinations_paths_and_half_widths_take_rigid_zones():
    many = slab(
        combination=[
            {"generate": "patterns", "permanent": {"G": [1, 1.35]}, "variable": {"N": [1, 1.5], "M": [-1, 1]}}
        ],
        output={"combinations": "table"},
    )
    names = [one.name for one in many.effective_combinations]
    alone = solve(slab(combination=[{"name": "one", "factors": many.effective_combinations[-1].factors}]))["one"]
    together = solve(many)[names[-1]]
    np.testing.assert_allclose(
        together.deflection, alone.deflection, rtol=0, atol=1e-9 * np.abs(alone.deflection).max()
    )
    assert estimate(alone).plus_minus["deflection"]["max"] is not None
    found = path(slab(), start="G", add="M", steps=5, until=1)
    assert [found.at(t).certificate.passed for t in (0, 1)] == [True, True]


def test_what_is_left_out_of_extremes_is_left_out_of_envelopes():
    soft = {"area": {"rectangle": [3, 2, 4, 3]}, "thickness": 0.15, "extremes": False}
    pressed = {"case": "N", "force": 2e5, "at": [3.5, 2.5], "patch": [0.5, 0.5]}
    weight, turned = {"case": "G", "self_weight": True}, {"case": "M", "pressure": 1}
    found = [
        solve(slab(zone=[{**soft, "extremes": counts}], load=[weight, pressed, turned]))["all"]
        for counts in (True, False)
    ]
    np.testing.assert_array_equal(*(one.fields["mx"] for one in found))
    for name in ("mx", "deflection"):
        assert found[0].extremes[name].max_at > (3, 2)
        assert found[1].extremes[name].max < found[0].extremes[name].max


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"zone": [{**COLUMN, "thickness": 0.4}]}, r"zone\[1\]\.thickness: found thickness .* rigid"),
        (
            {"zone": [{"area": {"circle": {"center": [1.5, 1.5], "radius": 0.4}}, "rigid": True}]},
            r"zone\[1\]\.area: The outline of this rigid zone cuts the element at .* Give mesh\.size, not divisions",
        ),
        ({"section": [{"line": [[0, 1.5], [4, 1.5]]}]}, r"section\[1\]\.line: The line crosses a rigid zone at"),
    ],
)
def test_what_is_wrong_with_a_rigid_zone_is_told_with_its_place(changes, message):
    with pytest.raises(InputError, match=message):
        solve(slab(**changes))


def test_a_round_rigid_zone_in_a_rectangle_is_followed():
    model = slab(mesh={"size": 0.5}, zone=[{"area": {"circle": {"center": [1.5, 1.5], "radius": 0.4}}, "rigid": True}])
    result = solve(model)["all"]
    inside = np.hypot(*(result.mesh.points - [1.5, 1.5]).T) < 0.401
    assert inside.sum() > 8 and is_one_body(result, inside) < 1e-14 * np.ptp(result.deflection)


@pytest.mark.parametrize(
    "line",
    [
        [[1, 0], [1, 3]],
        [[2, 3], [2, 0]],
        [[0.9, 0.9], [2.1, 0.9], [2.1, 2.1], [0.9, 2.1], [0.9, 0.9]],
        [[2.2, 0], [2.2, 3]],
    ],
)
def test_shears_through_sections_beside_a_rigid_zone_balance_what_acts(line):
    edges = {"name": "wall", "edge": "left", "fix": "clamped"}
    model = slab(support=[edges], section=[{"line": line}], combination=[{"name": "all", "factors": {"N": 1}}])
    section = solve(model)["all"].sections[0]
    crossed = 2e5 if len(line) > 2 or line[0][0] == 1 else 0.0
    assert abs(section.shear) == pytest.approx(crossed, rel=1e-9, abs=1e-4)


def test_corners_of_a_rigid_zone_have_no_limit():
    singular = solve(slab())["all"].singular
    assert any(
        set(one.where) == {(1, 1), (2, 1), (1, 2), (2, 2)} and one.numbers == ("moment", "shear") for one in singular
    )


def test_a_rigid_plate_on_soil_sinks_as_by_hand():
    model = slab(
        zone=[{"area": {"rectangle": [0, 0, 4, 3]}, "rigid": True}],
        support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7}],
        combination=[{"name": "all", "factors": {"N": 1}}],
    )
    result = solve(model)["all"]
    sunk, turned = 2e5 / (2e7 * 12), -0.5 * 2e5 / (2e7 * 3 * 4**3 / 12)
    x = result.mesh.points[:, 0]
    np.testing.assert_allclose(result.deflection, sunk + turned * (x - 2), rtol=1e-9)


def test_strips_and_sections_may_end_at_the_outline_of_a_rigid_zone():
    """Their numbers go on smoothly from those of lines that end beside it."""
    model = Model(
        material={"E": 33e6, "nu": 0.2, "unit_weight": 25},
        plate={"shape": "rectangle", "size": [14, 10], "thickness": 0.6},
        mesh={"size": 0.5, "error": False},
        zone=[{"area": {"rectangle": [5.5, 4.85, 8.5, 5.15]}, "rigid": True}],
        support=[{"area": "all", "resists": "down", "stiffness": 30e3}],
        load=[{"force": 900, "at": [7, 5], "patch": [3, 0.3]}, {"self_weight": True}],
        strip=[
            {"line": [[9.5, 0], [9.5, 10]], "width": 2},
            {"line": [[9.5, 0], [9.5, 10]], "width": 1.98},
            {"line": [[4.5, 10], [4.5, 0]], "width": 2},
        ],
        section=[{"line": [[x, y], [14, y]]} for y in (4.85, 5, 5.15) for x in (8.5, 8.51)],
    )
    result = solve(model)["all"]
    at_zone, beside, mirrored = (strip.sagging.moment for strip in result.strips)
    assert at_zone == pytest.approx(beside, rel=0.01)
    assert mirrored == pytest.approx(at_zone, rel=1e-6)
    for at_zone, beside in zip(result.sections[::2], result.sections[1::2], strict=True):
        assert at_zone.moment == pytest.approx(beside.moment, rel=0.02)
        assert at_zone.shear == pytest.approx(beside.shear, rel=0.05, abs=1)


@pytest.mark.parametrize("mesh", [{"size": 0.5}, {"divisions": [8, 8]}])
@pytest.mark.parametrize(
    "area",
    [
        {"rectangle": [1, 1, 3, 1.02]},
        {"rectangle": [0.1, 0.1, 0.2, 0.2]},
        {"polygon": [[1, 1], [2, 1.3], [1.7, 2.2], [0.8, 1.9]]},
    ],
)
def test_the_remedy_for_a_rigid_zone_that_is_not_followed_works(mesh, area):
    def solved(**options):
        zone = [{"area": area, "rigid": True}]
        edges = {"edge": ["left", "right"], "fix": "simple"}
        options = {"error": False, **options}
        return solve(rectangular(mesh=options, zone=zone, support=[edges], load=[{"pressure": 1e3}]))["all"]

    try:
        solved(**mesh)
    except InputError as error:
        said = str(error)
        if "Give mesh.size, not divisions" in said:
            assert "divisions" in mesh
            solved(size=0.5)
        else:
            size = float(said.split("elements of ")[1].split(" or less")[0])
            solved(size=0.5, refine=[{"area": area, "size": size}])
