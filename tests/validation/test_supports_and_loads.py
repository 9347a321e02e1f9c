"""Every kind of support and load against statics, closed forms, or the same thing said otherwise."""

import numpy as np
import pytest

import signorini

THREE = [[0.13, 0.21], [3.71, 0.37], [1.87, 2.83]]
RECTANGLE = {"shape": "rectangle", "size": [4, 3], "thickness": 0.2}
CONCRETE = {"E": 30e9, "nu": 0.2}


def solve(support, load, plate=RECTANGLE, material=CONCRETE, divisions=(8, 6), **more):
    model = signorini.Model(
        material=material, plate=plate, mesh={"divisions": list(divisions)}, support=support, load=load, **more
    )
    return signorini.solve(model)["all"]


def statics(points, force, moment_x, moment_y):
    """Reactions of three points under the resultants Σ F, Σ F x, Σ F y."""
    return np.linalg.solve(np.vstack([np.ones(3), np.array(points).T]), [force, moment_x, moment_y])


# A strip with ν = 0 is Timoshenko's cantilever; its cubic deflection is in the elements' reach on rectangles.
STRIP = {"shape": "rectangle", "size": [2, 0.5], "thickness": 0.1}
STEEL = {"E": 200e9, "nu": 0.0}
CANTILEVER = {"name": "wall", "edge": "left", "fix": "clamped"}


def cantilever_flexibility():
    """Tip deflection under a unit force."""
    inertia, area = 0.5 * 0.1**3 / 12, 0.5 * 0.1
    return 2**3 / (3 * 200e9 * inertia) + 2 / (5 / 6 * 100e9 * area)


def cantilever(force, *supports):
    return solve(
        [CANTILEVER, *supports],
        [{"line_load": force / 0.5, "edge": "right"}],
        plate=STRIP,
        material=STEEL,
        divisions=(4, 2),
        probe=[{"at": [2, 0.25]}],
    )


def test_cantilever_under_a_line_load_on_its_edge():
    result = cantilever(1e3)
    assert result.probes[0].deflection == pytest.approx(1e3 * cantilever_flexibility(), rel=1e-10)
    assert result.reactions["wall"] == pytest.approx(1e3, rel=1e-12)
    at_wall = np.abs(result.mesh.points[:, 0]) < 1e-12
    assert result.moment[at_wall, 0] == pytest.approx(-1e3 * 2 / 0.5, rel=1e-9)


@pytest.mark.parametrize(
    ("resists", "force", "acts"),
    [("down", 1, True), ("up", -1, True), ("both", 1, True), ("both", -1, True), ("down", -1, False), ("up", 1, False)],
)
def test_prop_with_a_gap_acts_the_way_it_resists(resists, force, acts):
    """Force past the gap is shared with the prop: R = F − gap/flexibility."""
    force, gap = force * 1e3, 1e-4
    free = force * cantilever_flexibility()
    prop = {"name": "prop", "edge": "right", "resists": resists, "gap": gap}
    result = cantilever(force, prop)
    expected = force - np.sign(force) * gap / cantilever_flexibility() if acts else 0.0
    assert result.reactions["prop"] == pytest.approx(expected, rel=1e-9, abs=1e-9)
    tip = np.sign(force) * gap if acts else free
    assert result.probes[0].deflection == pytest.approx(tip, rel=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_gap_that_is_not_reached(sign):
    result = cantilever(sign * 1e3, {"name": "prop", "edge": "right", "gap": 1.001e3 * cantilever_flexibility()})
    assert result.reactions["prop"] == 0
    assert result.probes[0].deflection == pytest.approx(sign * 1e3 * cantilever_flexibility(), rel=1e-10)


@pytest.mark.parametrize("resists", ["both", "down"])
def test_elastic_line_under_the_tip(resists):
    """F − R bends the cantilever, and R = k w."""
    k, flexibility = 3e5, cantilever_flexibility()
    tip = 1e3 * flexibility / (1 + k * flexibility)
    line = {"name": "line", "line": [[2, 0], [2, 0.5]], "resists": resists, "stiffness": k / 0.5}
    result = cantilever(1e3, line)
    assert result.probes[0].deflection == pytest.approx(tip, rel=1e-9)
    assert result.reactions["line"] == pytest.approx(k * tip, rel=1e-9)


def test_settlement_of_the_prop():
    """A prop whose base goes down by s carries (w − s) over the sum of the flexibilities."""
    flexibility = cantilever_flexibility()
    free = 1e3 * flexibility
    for stiffness in (None, 3e5):
        more = {} if stiffness is None else {"stiffness": stiffness / 0.5}
        prop = {"name": "prop", "edge": "right", "resists": "down", "settlement": free / 3, **more}
        give = flexibility + (1 / stiffness if stiffness else 0.0)
        assert cantilever(1e3, prop).reactions["prop"] == pytest.approx((free - free / 3) / give, rel=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_spring_with_travel_both_ways_is_pressed_by_a_wall_that_settles(sign):
    wall = {**CANTILEVER, "settlement": sign * 0.01}
    spring = {"name": "spring", "at": [[0, 0.25], [2, 0.25]], "resists": "both", "stiffness": 5e5, "gap": 0.004}
    result = solve([wall, spring], [{"line_load": 0.0, "edge": "right"}], plate=STRIP, material=STEEL, divisions=(4, 2))
    at_wall, at_tip = result.supports[1].reactions
    assert at_wall == pytest.approx(sign * 5e5 * 0.006, rel=1e-12)
    # The tip bends a little across the strip too, under a force at its middle.
    assert at_tip == pytest.approx(sign * 0.006 / (1 / 5e5 + cantilever_flexibility()), rel=1e-3)
    assert result.reactions["wall"] == pytest.approx(-at_wall - at_tip, rel=1e-9)


@pytest.mark.parametrize("way", [{}, {"resists": "down"}, {"stiffness": 1e7}, {"resists": "down", "stiffness": 1e7}])
def test_three_points_between_nodes_carry_by_statics(way):
    result = solve([{"name": "points", "at": THREE, **way}], [{"force": 10e3, "at": [1.9, 1.1]}, {"pressure": 500}])
    expected = statics(THREE, 10e3 + 6e3, 19e3 + 12e3, 11e3 + 9e3)
    assert (expected > 0).all()
    assert result.supports[0].reactions == pytest.approx(expected, rel=1e-9)
    if "stiffness" in way:
        at_points = [probe.deflection for probe in result.probe(THREE)]
        assert at_points == pytest.approx(expected / 1e7, rel=1e-9)


def test_the_point_that_would_pull_lifts_off_and_an_anchor_would_hold_it():
    """Springs under a stiff plate: bilateral, the far corner would pull by about F/4."""
    corners = [[0.3, 0.3], [3.7, 0.3], [0.3, 2.7], [3.7, 2.7]]
    load, spring = [{"force": 10e3, "at": [0.5, 0.4]}], {"stiffness": 1e6}
    bilateral = solve([{"at": corners, **spring}], load).supports[0].reactions
    assert bilateral[3] == pytest.approx(-2e3, rel=0.2)

    points = solve([{"at": corners, "resists": "down", **spring}], load).supports[0]
    assert points.closed.tolist() == [True, True, True, False]
    assert points.reactions[:3] == pytest.approx(statics(corners[:3], 10e3, 5e3, 4e3), rel=1e-9)
    assert points.reactions[3] == 0
    assert points.gaps[3] > 0

    anchor = {"name": "anchor", "at": corners[3], "resists": "up", **spring}
    anchored = solve([{"at": corners[:3], "resists": "down", **spring}, anchor], load)
    assert anchored.reactions["anchor"] == pytest.approx(bilateral[3], rel=1e-9)
    assert anchored.supports[0].reactions == pytest.approx(bilateral[:3], rel=1e-9)


def test_uniform_pressure_on_a_uniform_bed_settles_evenly():
    for resists in ("both", "down"):
        bed = {"name": "bed", "area": "all", "resists": resists, "stiffness": 30e6}
        result = solve([bed], [{"pressure": 2e3}])
        assert result.deflection == pytest.approx(2e3 / 30e6, rel=1e-10)
        assert result.reactions["bed"] == pytest.approx(24e3, rel=1e-12)
        assert np.abs(result.moment).max() < 1e-6 * 2e3


@pytest.mark.parametrize("supports", [[{"edge": ["left", "top"]}], [{"at": THREE}]])
def test_plane_settlement_tilts_the_plate_and_strains_nothing(supports):
    plane = "0.001 + 0.002*x - 0.003*y"
    result = solve([{**supports[0], "settlement": plane}], [{"pressure": 0.0}])
    x, y = result.mesh.points.T
    assert result.deflection == pytest.approx(0.001 + 0.002 * x - 0.003 * y, rel=1e-9, abs=1e-13)
    assert result.rotation == pytest.approx(np.tile([0.002, -0.003], (len(x), 1)), rel=1e-9)


@pytest.mark.parametrize("at", [[2.0, 1.5], [2.25, 1.25], [1.83, 0.97]], ids=["node", "element centre", "anywhere"])
def test_couples_do_work_on_the_slopes(at):
    """Couples on ∂w/∂x and ∂w/∂y are in equilibrium like forces at an arm, at any place."""
    result = solve([{"name": "points", "at": THREE}], [{"moment": [3e3, -2e3], "at": at}])
    assert result.supports[0].reactions == pytest.approx(statics(THREE, 0, 3e3, -2e3), rel=1e-9)


def test_deflection_by_a_couple_and_slope_by_a_force_are_reciprocal():
    """Betti (1872), with the force between nodes."""
    wall, at, other = [{"edge": "left", "fix": "clamped"}], [3.0, 1.5], [2.21, 2.1]
    by_couple = solve(wall, [{"moment": [1e3, 0], "at": at}])
    by_force = solve(wall, [{"force": 1e3, "at": other}])
    assert by_couple.probe(other)[0].deflection == pytest.approx(by_force.probe(at)[0].rotation[0], rel=1e-9)


@pytest.mark.parametrize("element", ["mitc9", "q8r"])
def test_free_plate_curls_to_its_stress_free_curvature(element):
    """w = ½ kx x² + ½ ky y² + kxy x y less the plane through its three points, without moments or reactions."""
    kx, ky, kxy = 1e-3, -2e-3, 5e-4
    nodes = [[0, 0], [4, 0], [0, 3]]
    load = [{"curvature": [kx, ky, kxy]}]
    result = solve([{"name": "points", "at": nodes}], load, plate={**RECTANGLE, "element": element})

    def curl(x, y):
        return kx * x**2 / 2 + ky * y**2 / 2 + kxy * x * y

    x, y = result.mesh.points.T
    assert result.deflection == pytest.approx(curl(x, y) - curl(4, 0) * x / 4 - curl(0, 3) * y / 3, abs=1e-13)
    rigidity = 30e9 * 0.2**3 / 12 / (1 - 0.2**2)
    assert np.abs(result.moment).max() < 1e-9 * rigidity * 2e-3
    assert np.abs(result.supports[0].reactions).max() < 1e-9 * rigidity * 2e-3


@pytest.mark.parametrize("element", ["mitc9", "q8r"])
def test_clamped_plate_stays_flat_under_a_curvature_it_cannot_take(element):
    """M = −D(κ − κ⁰) with κ = 0: uniform D(1 + ν)k, positive, as a plate bent back flat sags."""
    result = solve(
        [{"edge": ["left", "right", "bottom", "top"], "fix": "clamped"}],
        [{"curvature": [1e-3, 1e-3, 0]}],
        plate={**RECTANGLE, "element": element},
    )
    rigidity = 30e9 * 0.2**3 / 12 / (1 - 0.2**2)
    assert np.abs(result.deflection).max() < 1e-15
    assert result.moment[:, :2] == pytest.approx(rigidity * 1.2 * 1e-3, rel=1e-10)
    assert np.abs(result.moment[:, 2]).max() < 1e-9 * rigidity * 1e-3


def power(a, b, n):
    """∫ tⁿ from a to b."""
    return (b ** (n + 1) - a ** (n + 1)) / (n + 1)


VARYING = [power(0.3, 1.3, i) * power(0.2, 2.2, j) for i, j in ((1, 2), (2, 2), (1, 3))]


@pytest.mark.parametrize(
    ("load", "resultants"),
    [
        ({"line_load": 700.0, "line": [[0.31, 0.27], [3.11, 2.37]]}, np.array([1, 1.71, 1.32]) * 700 * 3.5),
        ({"line_load": "100*x", "line": [[0, 1.1], [4, 1.1]]}, [800, 6400 / 3, 880]),
        ({"line_load": 50.0, "edge": "top"}, [200, 400, 600]),
        ({"line_load": 50.0, "circle": {"center": [2.1, 1.4], "radius": 0.9}}, np.array([1, 2.1, 1.4]) * 90 * np.pi),
        ({"pressure": "x*y**2", "area": {"rectangle": [0.3, 0.2, 1.3, 2.2]}}, VARYING),
        (
            {"pressure": 9.0, "area": {"circle": {"center": [2.1, 1.4], "radius": 0.9}}},
            np.array([1, 2.1, 1.4]) * 7.29 * np.pi,
        ),
    ],
    ids=["oblique line", "varying line", "edge", "circle", "varying pressure", "disc"],
)
def test_loads_across_elements_have_their_resultants(load, resultants):
    result = solve([{"at": THREE}], [load])
    assert result.supports[0].reactions == pytest.approx(statics(THREE, *resultants), rel=1e-8)


def test_self_weight_follows_the_thickness():
    result = solve(
        [{"at": THREE}],
        [{"self_weight": True}],
        plate={**RECTANGLE, "thickness": "0.2 + 0.05*x"},
        material={**CONCRETE, "unit_weight": 25e3},
    )
    weights = 25e3 * 3 * np.array([0.2 * 4 + 0.05 * 8, 0.2 * 8 + 0.05 * 64 / 3, 1.5 * (0.2 * 4 + 0.05 * 8)])
    assert result.supports[0].reactions == pytest.approx(statics(THREE, *weights), rel=1e-9)


def disc(sector, support, load):
    sides = [{"name": "sides", "edge": ["start", "end"], "fix": "symmetry"}] if sector < 360 else []
    plate = {"shape": "disc", "radius": 1.0, "thickness": 0.05, "sector": sector}
    return solve([*support, *sides], load, plate=plate, divisions=(8, 32 * sector // 360))


@pytest.mark.parametrize("sector", [90, 180])
@pytest.mark.parametrize(
    "support",
    [
        [{"name": "ring", "edge": "rim", "fix": "simple"}],
        [{"name": "ring", "edge": "rim", "fix": "clamped"}],
        [{"name": "ring", "circle": {"radius": 0.7}, "resists": "down", "stiffness": 1e9}],
        [{"name": "ring", "edge": "rim", "resists": "down"}, {"at": [0, 0], "resists": "down", "gap": 1e-6}],
    ],
    ids=["simple", "clamped", "elastic ring", "one-sided ring and a stop"],
)
def test_a_sector_with_symmetric_sides_is_the_whole_disc(support, sector):
    load = [{"pressure": 1e4, "area": {"circle": {"radius": 0.5}}}]
    whole, part = disc(360, support, load), disc(sector, support, load)
    x, y = part.mesh.points.T
    inside = np.hypot(x, y) < 0.999
    found = whole.probe(part.mesh.points[inside])
    deflection = np.array([probe.deflection for probe in found])
    # Where a ring ends, at a sector's sides, Lobatto's rule takes the place of Gauss's; on arcs they differ by this.
    assert part.deflection[inside] == pytest.approx(deflection, abs=1e-9 * np.abs(deflection).max())
    assert part.reactions["ring"] * 360 / sector == pytest.approx(whole.reactions["ring"], rel=1e-10)


def test_a_quarter_of_a_plate_on_one_sided_edges_is_the_whole_plate(square):
    quarter, _ = square({"resists": "down"}, 0.02, 12)
    whole = solve(
        [{"name": "edges", "edge": ["left", "right", "bottom", "top"], "resists": "down"}],
        [{"pressure": 1.0}],
        plate={"shape": "rectangle", "size": [1, 1], "origin": [-0.5, -0.5], "thickness": 0.02},
        material={"E": 1.0, "nu": 0.3},
        divisions=(24, 24),
    )
    found = whole.probe(quarter.mesh.points)
    deflection = np.array([probe.deflection for probe in found])
    assert quarter.deflection == pytest.approx(deflection, abs=1e-10 * deflection.max())
    assert quarter.reactions["edges"] * 4 == pytest.approx(whole.reactions["edges"], rel=1e-10)


def test_a_rigid_line_within_elements_shares_its_force_and_does_not_lock_the_plate():
    wall = {"name": "wall", "line": [[3, 2], [6.1, 5.3]]}
    edges = [f"edge {number}" for number in range(1, 5)]
    corners = [[0, 0], [10, 0], [10, 8], [0, 8]]
    found = {}
    for shape, names, size in [
        ({"shape": "rectangle", "size": [10, 8]}, ["left", "right", "bottom", "top"], 0.5),
        ({"shape": "polygon", "points": corners}, edges, 0.25),  # its mesh follows the wall
    ]:
        model = signorini.Model(
            material=CONCRETE,
            plate={**shape, "thickness": 0.26},
            mesh={"size": size, "error": False},
            support=[{"name": "edges", "edge": names, "fix": "simple"}, wall],
            load=[{"pressure": 15e3}],
        )
        (found[size],) = signorini.solve(model).values()
    forces = found[0.5].supports[1].reactions
    assert forces.sum() == pytest.approx(found[0.25].reactions["wall"], rel=0.01)
    # With two points in each element forces of 7 times the sum, and 10 % of the deflection missing.
    assert np.abs(forces).sum() < 3.0 * forces.sum()
    coarse, fine = (found[size].probe([7, 5])[0].deflection for size in (0.5, 0.25))
    assert coarse == pytest.approx(fine, rel=0.05)


@pytest.mark.parametrize("wall", [{"fix": "hard"}, {"fix": "simple"}, {"resists": "down"}])
def test_shears_jump_at_a_wall_between_two_spans(wall):
    # Timoshenko's beam, clamped at the wall by symmetry: R (L³/3D + L/S) = q (L⁴/8D + L²/2S) at its far end.
    span, load, thickness, young = 4.0, 1e3, 0.4, 30e9
    bending, shear = young * thickness**3 / 12, 5 / 6 * young / 2 * thickness
    far = load * (span**4 / (8 * bending) + span**2 / (2 * shear)) / (span**3 / (3 * bending) + span / shear)
    result = solve(
        [{"edge": ["left", "right"], "fix": "hard"}, {"line": [[span, 0], [span, 2]], **wall}],
        [{"pressure": load}],
        plate={"shape": "rectangle", "size": [2 * span, 2], "thickness": thickness},
        material={"E": young, "nu": 0},
        divisions=(16, 4),
        probe=[{"at": [[span, 1]]}],
    )
    assert result.extremes["qx"].max == pytest.approx(load * span - far, rel=1e-4)
    assert result.extremes["qx"].min == pytest.approx(far - load * span, rel=1e-4)
    assert abs(result.probes[0].shear[0]) == pytest.approx(load * span - far, rel=1e-4)
    assert signorini.estimate(result).plus_minus["fields"]["qx"]["max"] < 1e-3 * load * span


def test_shears_jump_along_a_line_load():
    result = solve(
        [{"edge": ["left", "right"], "fix": "hard"}],
        [{"line_load": 1e3, "line": [[2, 0], [2, 2]]}],
        plate={"shape": "rectangle", "size": [8, 2], "thickness": 0.2},
        material={"E": 30e9, "nu": 0},
        divisions=(16, 4),
    )
    assert (result.extremes["qx"].max, result.extremes["qx"].min) == pytest.approx((750, -250), rel=1e-9)


@pytest.mark.parametrize("begin", [0.0, 1e-6, 1e-4, 0.02])
@pytest.mark.parametrize("shape", ["rectangle", "polygon"])
def test_a_wall_parts_moments_and_shears_also_where_it_ends_beside_a_node(begin, shape):
    # A beam clamped at the wall and propped at 6 m: pL²/8 and 5pL/8 at the wall, and zero on its other side.
    outline = {"size": [10, 4]} if shape == "rectangle" else {"points": [[0, 0], [10, 0], [10, 4], [0, 4]]}
    edges = ["left", "right"] if shape == "rectangle" else ["edge 4", "edge 2"]
    model = signorini.Model(
        material={"E": 30e9, "nu": 0.0},
        plate={"shape": shape, "thickness": 0.2, **outline},
        mesh={"size": 0.5, "error": False},
        support=[{"edge": edges, "fix": "simple"}, {"line": [[4, begin], [4, 4]], "fix": "clamped"}],
        load=[{"pressure": 1e4, "area": {"rectangle": [4, 0, 10, 4]}}],
    )
    (at,) = signorini.solve(model)["all"].probe([[4, 2]])
    assert at.moment[0] == pytest.approx(-45e3, rel=0.01)
    assert at.shear[0] == pytest.approx(37.5e3, rel=0.01)


def test_a_line_load_parts_shears_also_where_it_ends_beside_a_node():
    model = signorini.Model(
        material={"E": 30e9, "nu": 0.0},
        plate={"shape": "rectangle", "size": [10, 4], "thickness": 0.2},
        mesh={"size": 0.5, "error": False},
        support=[{"edge": ["left", "right"], "fix": "simple"}],
        load=[{"line_load": 1e4, "line": [[4, 1e-4], [4, 4]]}],
    )
    (at,) = signorini.solve(model)["all"].probe([[4, 2]])
    assert at.shear[0] == pytest.approx(6e3, rel=1e-3)


@pytest.mark.parametrize(
    ("support", "at"),
    [
        ({"line": [[1, 0.5], [5, 3.2]], "resists": "both"}, [3.0, 1.85]),
        ({"line": [[1, 0.5], [5, 3.2]], "resists": "both", "stiffness": 5e7}, [3.0, 1.85]),
        ({"circle": {"center": [3, 2], "radius": 1.2}, "resists": "both"}, [4.2, 2.0]),
    ],
)
def test_walls_oblique_to_a_rectangle_part_moments_where_the_elements_are_not_counted(support, at):
    plate = {"shape": "rectangle", "size": [6, 4], "thickness": 0.2}

    def along_it(mesh):
        held = [{"edge": ["left", "right"], "fix": "hard"}, support]
        probe = [{"at": [at]}]
        material = {"E": 30e9, "nu": 0.2}
        load = [{"pressure": 5e3}]
        model = signorini.Model(material=material, plate=plate, support=held, load=load, probe=probe, mesh=mesh)
        result = signorini.solve(model)["all"]
        return np.array(result.probes[0].moment), result

    exact, _ = along_it({"size": 0.05})
    found, result = along_it({"size": 0.4})
    within = np.array(signorini.estimate(result).plus_minus["probes"][0]["moment"], float)
    assert not result.warnings
    assert np.abs(found - exact).max() < 0.06 * np.abs(exact).max()
    assert (np.abs(found - exact) <= within).all() and within.max() < 0.13 * np.abs(exact).max()
    cut, result = along_it({"divisions": [15, 10]})
    assert np.abs(cut - exact).max() > 3.0 * np.abs(found - exact).max()
    assert "The mesh does not follow the" in result.warnings[0]


@pytest.mark.parametrize(
    ("supports", "couples"),
    [
        ([{"edge": ["left", "right"], "fix": "clamped"}], [-4 / 3]),
        ([{"edge": "left", "fix": "clamped"}], [-8.0]),
        ([{"edge": "left", "fix": "clamped"}, {"edge": "right", "fix": "symmetry"}], [-16 / 3, 8 / 3]),
    ],
    ids=["clamped", "cantilever", "half of a clamped strip"],
)
def test_edges_of_a_strip_carry_the_couples_of_a_beam(supports, couples):
    """Bending moments qL²/12, qL²/2, and of the span 2L: q(2L)²/12 and q(2L)²/24; with ν = 0 all along the edge."""
    plate = {"shape": "rectangle", "size": [4, 1], "thickness": 0.1}
    result = solve(supports, [{"pressure": 1.0}], plate=plate, material=STEEL)
    for support, couple in zip(result.supports, couples, strict=True):
        assert support.edge.couples == pytest.approx(couple)


def test_the_rim_of_a_clamped_disc_carries_an_eighth_of_pr2():
    """Timoshenko and Woinowsky-Krieger (1959), equation 63: m_r = -q a²/8 at the edge."""
    plate = {"shape": "disc", "radius": 2, "thickness": 0.02}
    model = signorini.Model(
        material=STEEL | {"nu": 0.3},
        plate=plate,
        mesh={"size": 0.25},
        support=[{"name": "rim", "edge": "rim", "fix": "clamped"}],
        load=[{"pressure": 6.0}],
    )
    assert signorini.solve(model)["all"].supports[0].edge.couples == pytest.approx(-3.0, rel=2e-3)


@pytest.mark.parametrize("sides", [4, 6])
@pytest.mark.parametrize("apart", [False, True])
def test_couples_do_not_depend_on_corners_nor_on_how_edges_are_listed(sides, apart):
    """A stress-free curvature κ that clamped edges prevent is the moment D (1 + ν) κ everywhere."""
    turn = 2 * np.pi * np.arange(sides) / sides
    edges = [f"edge {i + 1}" for i in range(sides)]
    model = signorini.Model(
        material={"E": 12.0, "nu": 0.2},
        plate={"shape": "polygon", "points": np.column_stack([np.cos(turn), np.sin(turn)]).tolist(), "thickness": 1.0},
        mesh={"size": 0.3},
        support=[{"edge": edge, "fix": "clamped"} for edge in (edges if apart else [edges])],
        load=[{"curvature": [1e-3, 1e-3, 0]}],
    )
    result = signorini.solve(model)["all"]
    moment = 1e-3 / (1 - 0.2)
    for support in result.supports:
        assert np.abs(support.edge.couples) == pytest.approx(moment)


def test_where_a_clamped_edge_holds_a_rigid_zone_couples_are_those_beside_it():
    """The couple on the zone itself is not one per length."""
    supports = [{"edge": "left", "fix": "clamped"}]
    plate = {"shape": "rectangle", "size": [4, 3], "thickness": 0.2}
    whole = [{"area": {"rectangle": [0, 0, 0.5, 3]}, "rigid": True}]
    (left,) = solve(supports, [{"pressure": 1e4}], plate=plate, zone=whole).supports
    assert not len(left.edge.couples)
    part = [{"area": {"rectangle": [0, 1, 0.5, 2]}, "rigid": True}]
    (left,) = solve(supports, [{"pressure": 1e4}], plate=plate, zone=part, divisions=(32, 24)).supports
    ends = left.edge.sides[..., 1]
    assert (((ends <= 1) | (ends >= 2)).all(axis=1) & (left.edge.couples < 0)).all()


def test_four_bearings_of_a_rigid_zone_share_its_load_by_the_least_squares():
    """Under a force at (x, y) from the middle each carries F/4 + F x xᵢ/Σx² + F y yᵢ/Σy², whatever their order."""
    corners = [[1, 1], [2, 1], [2, 2], [1, 2]]
    for order in ([0, 1, 2, 3], [2, 0, 3, 1]):
        result = solve(
            [{"at": [corners[i] for i in order], "resists": "down"}],
            [{"force": 1e5, "at": [1.3, 1.4]}],
            zone=[{"area": {"rectangle": [1, 1, 2, 2]}, "rigid": True}],
        )
        expected = np.array([40e3, 20e3, 10e3, 30e3])
        assert result.supports[0].reactions == pytest.approx(expected[order])
        assert result.not_unique
