"""Zones: parts of the plate with a thickness, material or modifiers of their own."""

import pickle

import meshio
import numpy as np
import pytest
from pytest import approx

from signorini import InputError, Model, estimate, path, solve
from signorini.analysis.check import check
from signorini.discretise import discretise
from signorini.formats.vtk import as_meshio, write_vtu
from signorini.output import write

CONCRETE = {"E": 30e9, "nu": 0.2, "unit_weight": 25e3}
MIDDLE = {"rectangle": [3, 2, 5, 4]}
STIFF = {"Dx": 8e6, "Dy": 6e6, "D1": 1e6, "Dxy": 2e6, "Sx": 1e8, "Sy": 1e8}
THICK = {"area": MIDDLE, "thickness": 0.4}


def slab(*zones, plate=None, **given):
    tables = {
        "material": CONCRETE,
        "plate": {"shape": "rectangle", "size": [8, 6], "thickness": 0.2} | (plate or {}),
        "mesh": {"divisions": [16, 12]},
        "zone": zones,
        "support": [{"edge": ["left", "right"], "fix": "simple"}],
        "load": [{"pressure": 5e3}],
    }
    return Model(**tables | given)


def solved(*zones, **given):
    return solve(slab(*zones, **given))["all"]


@pytest.mark.parametrize(
    ("own", "plate", "material"),
    [
        (
            {"modifiers": {"bending": 0.5, "twist": 0.1, "shear": 0.7}},
            {"modifiers": {"bending": 0.5, "twist": 0.1, "shear": 0.7}},
            CONCRETE,
        ),
        (
            {"material": {"Ex": 30e9, "Ey": 10e9, "nu_xy": 0.2, "Gxy": 5e9, "angle": 30}},
            {},
            {"Ex": 30e9, "Ey": 10e9, "nu_xy": 0.2, "Gxy": 5e9, "angle": 30},
        ),
        ({"thickness": "0.2 + 0.01*x"}, {"thickness": "0.2 + 0.01*x"}, CONCRETE),
    ],
)
def test_a_zone_over_the_whole_plate_is_the_plate(own, plate, material):
    zoned = solved({"area": {"rectangle": [0, 0, 8, 6]}, **own})
    whole = solved(plate=plate, material=material)
    assert zoned.deflection == approx(whole.deflection, rel=1e-12)
    assert zoned.moment == approx(whole.moment, rel=1e-9, abs=1e-9 * np.abs(whole.moment).max())


def test_a_zone_of_thickness_is_a_step_of_the_formula():
    formula = "where((x > 3) and (x < 5) and (y > 2) and (y < 4), 0.4, 0.2)"
    zoned, stepped = solved(THICK), solved(plate={"thickness": formula})
    assert zoned.deflection == approx(stepped.deflection, rel=1e-12)
    assert zoned.moment == approx(stepped.moment, abs=1e-10 * np.abs(stepped.moment).max())


def test_borders_are_lines_of_the_mesh():
    zone = {"area": {"rectangle": [3.1, 1.7, 5.3, 4.2]}, "thickness": 0.4}
    freely = {"plate": {"holes": [{"rectangle": [0.4, 0.6, 1.2, 1.4]}]}, "mesh": {"size": 0.5}}
    for given in ({}, freely):
        found = discretise(slab(zone, **given))
        assert not found.zones.parted.any()
        inside = found.zones.inside[0]
        assert found.mesh.element_area[inside].sum() == approx(2.2 * 2.5, rel=1e-12)


def test_zones_have_their_weight_cut_elements_too():
    heavy = CONCRETE | {"unit_weight": 60e3}
    for area, size in (({"circle": {"center": [4, 3], "radius": 1.3}}, np.pi * 1.69), (MIDDLE, 4.0)):
        result = solved({"area": area, "thickness": 0.3, "material": heavy}, load=[{"self_weight": True}])
        total = 48 * 0.2 * 25e3 + size * (0.3 * 60e3 - 0.2 * 25e3)
        assert sum(result.reactions.values()) == approx(total, rel=1e-5)


@pytest.mark.parametrize("width", [1e-3, 1e-4])
def test_a_slot_between_two_zones_is_found_as_a_thin_zone_is(width):
    left, slot, right = (
        {"rectangle": [x0, 0, x1, 6]} for x0, x1 in ((0, 3.23), (3.23, 3.23 + width), (3.23 + width, 8))
    )
    between = solved({"area": left, "thickness": 0.2}, {"area": right, "thickness": 0.2}, plate={"thickness": 0.01})
    thin, whole = solved({"area": slot, "thickness": 0.01}), solved()
    assert between.deflection == approx(thin.deflection, rel=1e-9, abs=1e-12)
    assert between.deflection.max() > (1 + 100 * width) * whole.deflection.max()
    assert any(one.what.startswith("Border of zone 2 within") for one in between.singular)


def test_where_zones_overlap_later_ones_win_key_by_key():
    wide, narrow = {"rectangle": [2, 1, 6, 5]}, MIDDLE
    zones = [
        {"area": wide, "thickness": 0.3},
        {"area": narrow, "modifiers": {"bending": 0.5}},
        {"area": narrow, "thickness": 0.4},
    ]
    found = discretise(slab(*zones))
    element = found.mesh.locate(np.array([[4.1, 3.1], [2.1, 1.1], [0.1, 0.1]])).elements
    made = found.zones.of_elements
    assert made.thickness[element].tolist() == [3, 1, 0]
    assert made.rigidity[element].tolist() == [1, 0, 0]


def test_a_later_zone_of_thickness_or_material_is_solid_again():
    wide, narrow = {"rectangle": [2, 1, 6, 5]}, MIDDLE
    zones = [
        {"area": wide, "thickness": 0.3, "stiffness": STIFF},
        {"area": narrow, "modifiers": {"bending": 0.5}},
        {"area": {"rectangle": [3, 2, 4, 4]}, "thickness": 0.3},
        {"area": {"rectangle": [3, 2, 4, 3]}, "material": CONCRETE},
    ]
    found = discretise(slab(*zones))
    places = [[4.6, 3.6], [2.1, 1.1], [0.1, 0.1], [3.6, 3.6], [3.6, 2.6]]
    made = found.zones.of_elements
    element = found.mesh.locate(np.array(places)).elements
    # Materials have the numbers 0 to 4, the plate's and zones' stiffnesses those from 5 on.
    assert made.section[element].tolist() == [6, 6, 0, 0, 4]
    assert made.thickness[element].tolist() == [1, 1, 0, 3, 3]
    thickness = found.zones.equivalent[made.rigidity[element[:2]]]
    assert thickness == approx([np.sqrt(10 * 2.5e6 / 1e8)] * 2, rel=1e-14)
    first = found.zones.rigidities[made.rigidity[element[1]]].bending * thickness[1] ** 3
    assert first == approx(np.array([[8e6, 1e6, 0], [1e6, 6e6, 0], [0, 0, 2e6]]), rel=1e-14)
    halved = found.zones.rigidities[made.rigidity[element[0]]].bending * thickness[0] ** 3
    assert halved[0] == approx(0.5 * first[0], rel=1e-14)


D_SHAPED = [[3, 2], [4.5, 2], {"through": [5.5, 3], "to": [4.5, 4]}, [3, 4]]


@pytest.mark.parametrize("plate", [{}, {"holes": [{"rectangle": [0.4, 0.6, 1.2, 1.4]}]}])
def test_areas_may_have_arcs(plate):
    """Followed by the mesh of a polygon, and cutting the elements of rows."""
    mesh = {"size": 0.5} if plate else {"divisions": [16, 12]}
    area = {"polygon": D_SHAPED}
    size = 3 + np.pi / 2
    heavy = {"area": area, "thickness": 0.2, "material": CONCRETE | {"unit_weight": 60e3}}
    support = [
        {"edge": ["left", "right"], "fix": "simple"},
        {"name": "bed", "area": area, "resists": "down", "stiffness": 1e6},
    ]
    loads = [{"self_weight": True}, {"pressure": 5e3, "area": area}]
    model = slab(heavy, plate=plate, mesh=mesh, support=support, load=loads)
    found = discretise(model)
    assert found.zones.parted.any() == (not plate)
    result = solve(model)["all"]
    own = 0.2 * 25e3 * (48 - (0.64 if plate else 0)) + size * (0.2 * 35e3 + 5e3)
    assert sum(result.reactions.values()) == approx(own, rel=1e-4 if plate else 1e-5)
    assert result.certificate.passed


def test_sections_cut_areas_with_arcs():
    line = [[4.7, 0], [4.7, 6]]
    load = [{"pressure": 5e3, "area": {"polygon": D_SHAPED}}]
    result = solved(
        load=load,
        section=[{"name": "cut", "line": line}],
        support=[{"name": side, "edge": [side]} for side in ("left", "right")],
    )
    (section,) = result.sections
    # The part of the half disc about [4.5, 3] to the right of the line.
    segment = np.arccos(0.2) - 0.2 * np.sqrt(1 - 0.04)
    right = result.reactions["right"] - 5e3 * segment
    assert abs(section.shear) == approx(abs(right), rel=1e-9)


def test_arcs_that_cross_a_side_are_refused():
    crossing = [[0, 0], [4, 0], [4, 1], {"through": [2, -1], "to": [0, 1]}]
    with pytest.raises(
        InputError, match=r"zone\[1\].area.polygon: The polygon crosses or touches itself. List corners"
    ):
        slab({"area": {"polygon": crossing}, "thickness": 0.3})


def test_overlaps_that_are_seldom_meant_are_told():
    other = {"area": {"rectangle": [4, 3, 6, 5]}, "thickness": 0.3}
    (partly,) = check(slab(THICK, other)).warnings
    assert partly.startswith("Zones 1 and 2 overlap, such as at [4.25, 3.25]: there the thickness of zone 2 counts")
    (hidden,) = check(slab(THICK, {"area": {"rectangle": [2, 1, 6, 5]}, "thickness": 0.3})).warnings
    assert "zone 1 counts nowhere: zone 2, which comes later, covers it" in hidden
    assert not check(slab({"area": {"rectangle": [2, 1, 6, 5]}, "thickness": 0.3}, THICK)).warnings


@pytest.mark.parametrize(
    ("zone", "message"),
    [
        (
            {"area": MIDDLE},
            r"zone\[1\]: the zone has no effect; give thickness, material, modifiers, stiffness or rigid",
        ),
        (
            {"area": MIDDLE, "stiffness": STIFF},
            r"zone\[1\].thickness: 'thickness' is missing; it is required with stiffness",
        ),
        ({"area": MIDDLE, "stiffness": STIFF, "thickness": "x"}, r"zone\[1\].thickness: found \"x\"; beside stiffness"),
        ({"area": MIDDLE, "stiffness": STIFF | {"D1": 8e6}}, r"stiffness.D1: found 8e\+06; .D1. must be less than"),
        ({"area": MIDDLE, "thickness": 0.3, "material": {}}, r"zone\[1\].material.E: 'E' is missing. Young's modulus"),
        ({"area": "all", "thickness": 0.3}, r'zone\[1\].area: found "all"'),
        ({"area": {"rectangle": [7, 2, 9, 4]}, "thickness": 0.3}, r"zone\[1\].area: The area has 50 % of its size off"),
        ({"area": {"rectangle": [9, 2, 10, 4]}, "thickness": 0.3}, r"zone\[1\].area: The area is not on the plate"),
        ({"area": MIDDLE, "thickness": "x - 4"}, r"zone\[1\].thickness: .* must be greater than 0"),
        ({"area": MIDDLE, "thickness": 1e-9}, r"zone\[1\].thickness: Found the thickness 1e-09"),
        ({"area": MIDDLE, "material": {"E": 1e9, "nu": 0.2}}, r"zone\[1\].material: a self_weight load"),
    ],
)
def test_what_is_wrong_with_a_zone_is_told_with_its_place(zone, message):
    with pytest.raises(InputError, match=message):
        discretise(slab(zone, load=[{"self_weight": True}]))


def test_a_zone_may_lie_over_a_hole():
    polygon = {"shape": "rectangle", "size": [8, 6], "holes": [{"rectangle": [4, 3, 6, 5]}]}
    result = solved(THICK, plate=polygon, mesh={"size": 0.5}, load=[{"self_weight": True}])
    total = (48 - 4) * 0.2 * 25e3 + (4 - 1) * 0.2 * 25e3
    assert sum(result.reactions.values()) == approx(total, rel=1e-9)
    assert result.certificate.passed


@pytest.mark.parametrize("sector", [360, 90])
@pytest.mark.parametrize("size", [0.2, 0.8])
def test_areas_may_lie_over_the_inside_of_an_annulus(size, sector):
    ring = {"shape": "annulus", "inner": 0.5, "outer": 3, "thickness": 0.2, "sector": sector}
    areas = [{"circle": {"radius": 1.3}}]
    if sector == 360:
        areas += [{"rectangle": [-0.4, -0.7, 1, 1]}, {"circle": {"center": [0.1, 0], "radius": 1}}]
    for area in areas:
        tables = {
            "material": CONCRETE,
            "plate": ring,
            "mesh": {"size": size},
            "zone": [{"area": area, "thickness": 0.4}],
            "support": [{"edge": "outer", "fix": "simple"}],
            "load": [{"pressure": 5e3, "area": area}],
        }
        total = discretise(Model(**tables)).cases["load"].nodal[::3].sum()
        if area == areas[0]:
            assert total == approx(5e3 * np.radians(sector) * (1.3**2 - 0.25) / 2, rel=1e-3)
    for radius in (0.4, 3.2):
        off = tables | {"zone": [{"area": {"circle": {"radius": radius}}, "thickness": 0.4}]}
        with pytest.raises(InputError, match=r"(off|not on) the plate"):
            discretise(Model(**off))


def test_moments_keep_their_sides_of_a_jump():
    held = [{"edge": ["bottom", "top"], "fix": "symmetry"}, {"edge": ["left"], "fix": "clamped"}]
    model = slab(
        {"area": {"rectangle": [5, 0, 10, 1]}, "thickness": 0.4},
        plate={"size": [10, 1]},
        mesh={"divisions": [10, 2]},
        support=held,
        load=[{"moment": [0, 0], "at": [1, 0.5]}, {"line_load": 1e3, "edge": ["right"]}],
        probe=[{"at": [[5, 0.5], [4.999999, 0.5], [5.000001, 0.5]]}],
    )
    result = solve(model)["all"]
    nodes = result.stress_nodes
    assert len(result.moment) == len(result.shear) == nodes.count == result.mesh.node_count + 5
    on_jump = np.flatnonzero(result.mesh.points[nodes.nodes][:, 0] == 5)
    assert len(on_jump) == 10
    assert result.moment[on_jump, 0] == approx(-5e3, rel=1e-6)
    both, before, behind = result.probes
    for number in range(3):
        pair = before.moment[number], behind.moment[number]
        assert both.moment[number] == approx(max(pair, key=abs), rel=1e-4, abs=1e-3)
    assert both.deflection == approx(before.deflection, rel=1e-5)


def test_combinations_paths_and_paths_know_the_sides():
    parted = [{"pressure": 5e3, "case": "G"}, {"force": 20e3, "at": [2.2, 1.3], "case": "Q"}]
    points = [{"at": [[1, 1], [7, 1], [1, 5], [7, 5]], "resists": "down"}]
    rows = {"columns": ["G", "Q"], "rows": {"one": [1.0, 0.0], "two": [1.35, 1.5]}}
    probes = [{"at": [[3, 3], [3, 4], [1.1, 1.2]]}]
    given = {"load": parted, "support": points, "probe": probes}
    table = solve(slab(THICK, combination=[{"generate": "table", **rows}], output={"combinations": "table"}, **given))
    each = solve(slab(THICK, combination=[{"name": "two", "factors": {"G": 1.35, "Q": 1.5}}], **given))["two"]
    row = {name: values[1] for name, values in table.table.items()}
    for number, probe in enumerate(each.probes, 1):
        names = [f"probe[{number}]:{name}" for name in ("mx", "my", "mxy", "qx", "qy")]
        assert [row[name] for name in names] == approx([*probe.moment, *probe.shear], rel=1e-8, abs=1e-6)
    assert row["max:mx"] == approx(each.extremes["mx"].max, rel=1e-9)
    assert len(table.envelope.fields["mx"].largest) == each.stress_nodes.count > each.mesh.node_count
    again = pickle.loads(pickle.dumps(each))
    assert (again.moment == each.moment).all()


def test_corners_of_borders_inside_the_plate_are_named_with_what_grows_there():
    named = {one.what: one for one in check(slab(THICK)).singular}
    (corners,) = (one for what, one in named.items() if "zone 1" in what)
    assert sorted(corners.where) == [(3, 2), (3, 4), (5, 2), (5, 4)] and corners.numbers == ("moment", "shear")
    at_edge = {"area": {"rectangle": [0, 0, 8, 3]}, "thickness": 0.3}
    like = {"area": MIDDLE, "material": CONCRETE, "thickness": 0.2}
    round_ = {"area": {"circle": {"center": [4, 3], "radius": 1}}, "thickness": 0.3}
    for zone in (at_edge, like, round_):
        assert not [one for one in check(slab(zone)).singular if "Corner of the border" in one.what]


def test_moments_inside_elements_that_a_border_cuts_are_left_out_by_name():
    disc = {"area": {"circle": {"center": [4, 3], "radius": 1.1}}, "thickness": 0.4}
    outline = {"shape": "polygon", "points": [[0, 0], [8, 0], [8, 6], [0, 6]], "thickness": 0.2}
    sides = [{"edge": ["edge 2", "edge 4"], "fix": "simple"}]
    followed = solve(
        Model(**slab(disc).model_dump(exclude_unset=True) | {"plate": outline, "mesh": {"size": 0.3}, "support": sides})
    )["all"]
    assert not [one for one in followed.singular if "within" in one.what]
    result = solved(disc, mesh={"divisions": [32, 24]})
    (named,) = (one for one in result.singular if one.what.startswith("Border of zone 1 within"))
    assert (named.numbers, named.within) == (("moment", "shear"), 0.0)
    assert np.abs(np.hypot(*(np.array(named.where) - (4, 3)).T) - 1.1).max() < 0.36
    for field in ("mx", "my"):
        most = result.extremes[field]
        assert most.max == approx(followed.extremes[field].max, rel=0.05) and most.max_at not in named.where
    assert result.extremes["mx"].max_beside == named.what
    assert result.fields["mx"].max() > 1.08 * followed.extremes["mx"].max
    stepped = slab(plate={"thickness": "where(hypot(x - 4, y - 3) < 1.1, 0.4, 0.2)"}, mesh={"divisions": [32, 24]})
    (alike,) = (one for one in check(stepped).singular if "within" in one.what)
    assert alike.what.startswith("Jump of the thickness within") and set(named.where) <= set(alike.where)


def test_every_element_and_a_mesh_from_a_file_take_zones(tmp_path):
    reference = solved(THICK).deflection.max()
    assert solved(THICK, plate={"element": "q8r"}).deflection.max() == approx(reference, rel=5e-3)
    mesh = discretise(slab()).mesh
    file = tmp_path / "slab.vtu"
    write_vtu(file, as_meshio(mesh.points, mesh.elements, {}))
    free = Model(
        material=CONCRETE,
        plate={"shape": "mesh", "file": file, "thickness": 0.2},
        zone=[THICK],
        support=[{"line": [[0, 0], [0, 6]], "fix": "simple"}, {"line": [[8, 0], [8, 6]], "fix": "simple"}],
        load=[{"pressure": 5e3}],
    )
    assert solve(free)["all"].deflection.max() == approx(reference, rel=1e-6)


def test_files_hold_both_sides_of_jumps(tmp_path):
    result = solved(THICK)
    result.to_vtk(tmp_path / "slab.vtu")
    read = meshio.read(tmp_path / "slab.vtu")
    nodes = result.stress_nodes
    assert len(read.points) == nodes.count > result.mesh.node_count
    assert (read.point_data["moment"] == result.moment).all()
    assert (read.point_data["deflection"] == result.deflection[nodes.nodes]).all()
    assert (read.cells_dict["quad8"] == nodes.elements).all()
    assert result.extremes["my"].min == result.moment[:, 1].min()
    rows = {"columns": ["load"], "rows": {"one": [1.0], "two": [2.0]}}
    model = slab(THICK, combination=[{"generate": "table", **rows}], output={"combinations": "table"})
    write(solve(model), tmp_path / "out")
    envelope = meshio.read(tmp_path / "out" / "envelope.vtu")
    assert (envelope.point_data["my_max"] == 2 * result.moment[:, 1])[result.moment[:, 1] > 0].all()


def test_a_load_path_and_its_states_know_zones():
    points = [{"name": "points", "at": [[1, 1], [7, 1], [1, 5], [7, 5]], "resists": "down"}]
    loads = [{"pressure": 5e3, "case": "G"}, {"force": 900e3, "at": [7.5, 5.5], "patch": [0.4, 0.4], "case": "Q"}]
    model = slab(THICK, support=points, load=loads, probe=[{"at": [[3, 3]]}])
    found = path(model, start="G", add="Q")
    assert found.support_events
    again = solve(slab(THICK, support=points, load=loads, combination=[{"factors": {"G": 1, "Q": 0.02}}]))
    assert found.at(0.02).deflection == approx(again["combination 1"].deflection, rel=1e-8, abs=1e-12)


@pytest.mark.parametrize(
    "area",
    [
        {"circle": {"center": [1.23, 1.3], "radius": 1e-3}},
        {"rectangle": [1.23, 0, 1.23 + 1e-8, 4]},
    ],
)
def test_a_zone_too_small_to_be_seen_changes_nothing(area):
    plate = {"shape": "rectangle", "size": [6, 4], "thickness": 0.2}
    rest = {"mesh": {"divisions": [12, 8], "error": False}, "support": [{"edge": ["left", "right"], "fix": "simple"}]}
    rest |= {"material": {"E": 30e9, "nu": 0.2}, "plate": plate, "load": [{"pressure": 5e3}]}
    (bare,) = solve(Model(**rest)).values()
    (found,) = solve(Model(**rest, zone=[{"area": area, "thickness": 0.1}])).values()
    # The mesh follows the strip.
    assert found.deflection.max() == approx(bare.deflection.max(), rel=2e-3)


def test_rows_that_cannot_follow_a_border_give_way_to_elements_that_do():
    circle = {"area": {"circle": {"center": [4, 3], "radius": 1.3}}, "thickness": 0.4}
    skew = {"area": {"polygon": [[3, 2], [5, 2.3], [4.5, 4.2]]}, "thickness": 0.4}
    for zone in (circle, skew):
        model = slab(zone, mesh={"size": 0.5})
        assert model.divisions is None and not discretise(model).zones.parted.any()
        counted, quadratic = slab(zone), slab(zone, mesh={"size": 0.5}, plate={"element": "q8r"})
        assert counted.divisions == quadratic.divisions == (16, 12) and discretise(counted).zones.parted.any()
        followed, cut = (solve(one)["all"].deflection.max() for one in (model, counted))
        assert followed == approx(cut, rel=0.02)
    disc = {"shape": "disc", "radius": 3, "thickness": 0.2}
    rim = {"plate": disc, "support": [{"edge": "rim"}], "load": [{"pressure": 1e3}]}
    zone = {"area": {"circle": {"radius": 2}}, "thickness": 0.4}
    model = Model(material=CONCRETE, zone=[zone], **rim)
    assert model.divisions is None and not discretise(model).zones.parted.any()
    result = solved(circle, mesh={"size": 0.5})
    width = estimate(result).plus_minus["deflection"]["max"]
    assert result.certificate.passed and width < 0.02 * result.deflection.max()
