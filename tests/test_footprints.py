"""Forces, couples and supports at points that are spread over footprints."""

import numpy as np
import pytest
from models import rectangular
from scipy.sparse import block_array
from scipy.sparse.linalg import spsolve

from signorini import InputError, Model, path, solve
from signorini.contact.problem import contact_problem
from signorini.discretise import discretise
from signorini.equilibrium.balance import rigid_freedom
from signorini.equilibrium.imbalance import nearest_limit
from signorini.model.output import Output
from signorini.results.vtk import vtk_fields

HARD = {"edge": ["left", "right", "bottom", "top"], "fix": "hard"}
FOOTPRINTS = [{"patch": [0.7, 0.5]}, {"radius": 0.33}, {"patch": [0.02, 0.05]}, {"patch": [2.2, 3.1]}, {}]
WAYS = [
    {"fix": "simple"},
    {"stiffness": 1e8},
    {"resists": "down"},
    {"resists": "down", "stiffness": 1e8},
    {"resists": "down", "gap": 1e-4},
    {"gap": 1e-4, "stiffness": 1e9},
]
AT = [[1, 1], [3, 1], [1, 3], [3, 3]]


def resultant(model: Model) -> np.ndarray:
    """Force, and couples about the origin that work on the slopes in x and y."""
    found = discretise(model)
    force, mx, my = found.rigid_motions.T @ found.cases["load"].nodal
    return np.array([force, *(np.array([mx, my]) + force * found.middle)])


@pytest.mark.parametrize("footprint", FOOTPRINTS)
@pytest.mark.parametrize("thickness", [0.2, "where(x > 1.3, 0.4, 0.2)"])
def test_resultants_are_those_of_points(footprint, thickness):
    def of(**load):
        return resultant(
            rectangular(divisions=[5, 7], thickness=thickness, support=[HARD], load=[load | {"at": [1.37, 2.2]}])
        )

    size = 100e3 * np.array([1, 4, 4])
    np.testing.assert_allclose(of(force=100e3, **footprint) / size, [1, 1.37 / 4, 2.2 / 4], rtol=0, atol=1e-13)
    np.testing.assert_allclose(of(moment=[3, 5], **footprint), [0, 3, 5], rtol=0, atol=1e-11)
    np.testing.assert_allclose(of(couple_about={"x": 3, "y": 5}, **footprint), [0, -5, 3], rtol=0, atol=1e-11)


def test_a_couple_about_an_axis_turns_as_the_right_hand_does_with_z_down():
    # About x it takes y to z: the side of greater y goes down. About y it takes z to x: the side of greater x goes up.
    for about, down, up in (("x", [2, 2.6], [2, 1.4]), ("y", [1.4, 2], [2.6, 2])):
        load = {"couple_about": {about: 10e3}, "at": [2, 2], "patch": [0.5, 0.5]}
        found = solve(rectangular(divisions=[8, 8], support=[HARD], load=[load]))["all"].probe([down, up])
        assert found[0].deflection > 0 > found[1].deflection


@pytest.mark.parametrize("how", WAYS)
@pytest.mark.parametrize("footprint", FOOTPRINTS[:2])
def test_a_support_takes_the_mean_of_the_deflection_by_any_method(how, footprint):
    load = [{"pressure": 5e3}, {"force": 20e3, "at": [2.2, 1.7], "radius": 0.2}]
    reactions = []
    for method in ("lemke", "active_set"):
        model = rectangular(
            divisions=[5, 7], support=[{"at": AT, **how, **footprint}], load=load, solver={"method": method}
        )
        result = solve(model)["all"]
        mean = discretise(
            rectangular(divisions=[5, 7], support=[{"at": AT, "resists": "down", **footprint}], load=load)
        ).contact_rows @ np.concatenate([np.c_[result.deflection, result.rotation].ravel()])
        forces = result.supports[0].reactions
        reactions.append(forces)
        stretch = forces / how.get("stiffness", np.inf) + how.get("gap", 0.0)
        np.testing.assert_allclose(mean, stretch, rtol=0, atol=1e-11)
        np.testing.assert_allclose(result.supports[0].positions, AT, rtol=0, atol=0)
        assert forces.sum() == pytest.approx(100e3, rel=1e-9)
    np.testing.assert_allclose(reactions[1:], reactions[:1], rtol=1e-7)


@pytest.mark.parametrize("others", [[], [{"edge": "left", "fix": "clamped"}]], ids=["alone", "beside an edge"])
@pytest.mark.parametrize("stiffness", [1e6, 1e9, 1e12, None])
def test_wide_footprints_that_hold_both_ways_solve_the_equations_of_their_rows(stiffness, others):
    """[K Gᵀ; G 0] without condensation; K has the rows of elastic ones. Each footprint meets 25 elements."""
    support = {"at": AT, "patch": [0.9, 0.9], **({"fix": "simple"} if stiffness is None else {"stiffness": stiffness})}
    load = [{"force": 20e3, "at": [2.2, 1.7], "patch": [0.3, 0.2]}]
    problem = contact_problem(rectangular(divisions=[24, 24], support=[support, *others], load=load))
    free = ~problem.held
    both = problem.G[problem.two_sided][:, free]
    found = spsolve(
        block_array([[problem.K[free][:, free], both.T], [both, None]], format="csc"),
        np.concatenate([problem.load("all")[free], np.zeros(both.shape[0])]),
    )
    expected = np.zeros(len(free))
    expected[free] = found[: free.sum()]
    result = solve(problem.discretisation.model)["all"]
    np.testing.assert_allclose(result.deflection, expected[::3], rtol=0, atol=1e-7 * abs(expected[::3]).max())


def test_tables_and_paths_have_the_reactions_of_single_solves():
    supports = [
        {"at": AT, "resists": "down", "patch": [0.7, 0.5], "stiffness": 1e8},
        {"at": [2, 2], "resists": "up", "radius": 0.4, "gap": 1e-4},
    ]
    load = [{"case": "G", "pressure": 2e3}, {"case": "Q", "force": 30e3, "at": [3.4, 2], "patch": [0.3, 0.3]}]
    factors = [{"G": g, "Q": q} for g in (1, 1.35) for q in (0, 0.5, 1.0)]
    single = rectangular(support=supports, load=load, combination=[{"factors": one} for one in factors])
    table = Model(**(single.model_dump(exclude_unset=True) | {"output": {"combinations": "table"}}))
    in_table = solve(table).table
    for row, result in enumerate(solve(single).values()):
        for support in result.supports:
            for number, force in enumerate(support.reactions, start=1):
                name = f"reaction_at:{support.name}[{number}]"
                assert in_table[name][row] == pytest.approx(force, rel=1e-8, abs=1e-4)
    found = path(single, start="G", add="Q", until=1.0)
    np.testing.assert_allclose(
        found.at(1.0).supports[0].reactions, solve(single)["combination 3"].supports[0].reactions, rtol=1e-8
    )


def navier(sides, thickness, patch, at, force, modulus, poisson, terms=399):
    """Deflection of a simply supported Reissner-Mindlin plate in the middle of a patch load, edges without twist."""
    (a, b), (u, v), (x, y) = sides, patch, at
    rigidity = modulus * thickness**3 / 12 / (1 - poisson**2)
    shear = 5 / 6 * modulus / 2 / (1 + poisson) * thickness
    p, q = (np.pi * np.arange(1, terms + 1) / side for side in (a, b))
    of_load = np.outer(np.sin(p * x) * np.sinc(p * u / 2 / np.pi), np.sin(q * y) * np.sinc(q * v / 2 / np.pi))
    waves = p[:, None] ** 2 + q**2
    amplitude = 4 * force / (a * b) * of_load * (1 / (rigidity * waves**2) + 1 / (shear * waves))
    return (amplitude * np.outer(np.sin(p * x), np.sin(q * y))).sum()


@pytest.mark.parametrize("patch", [[0.8, 0.6], [0.3, 0.3]])
def test_a_patch_load_deflects_a_simply_supported_plate_by_naviers_series(patch):
    load = {"force": 50e3, "at": [1.6, 2.3], "patch": patch}
    model = rectangular(size=(4, 5), divisions=[32, 40], support=[HARD], load=[load], probe=[{"at": [1.6, 2.3]}])
    exact = navier((4, 5), 0.2, patch, (1.6, 2.3), 50e3, 30e9, 0.2)
    assert solve(model)["all"].probes[0].deflection == pytest.approx(exact, rel=2e-4)


def test_moments_converge_under_a_couple_on_a_footprint_and_grow_for_ever_under_that_of_a_point():
    def largest(**footprint):
        load = {"moment": [10e3, 0], "at": [2.1, 1.9], **footprint}
        models = (rectangular(divisions=[n, n], support=[HARD], load=[load]) for n in (8, 16, 32))
        return np.array([np.abs(solve(model)["all"].moment).max() for model in models])

    spread, single = largest(patch=[0.6, 0.6]), largest()
    assert np.ptp(spread[1:]) < 1e-3 * spread[1] < abs(spread[0] - spread[1]) < 0.2 * spread[1]
    assert (single[1:] > 1.9 * single[:-1]).all()


@pytest.mark.parametrize("footprint", [{"patch": [1.0, 2.0]}, {"radius": 0.35}])
def test_edges_of_symmetry_cut_footprints_through_their_middle(footprint):
    bearings = {"resists": "down", "stiffness": 1e8, **footprint}
    whole = rectangular(
        size=(8, 8),
        divisions=[16, 16],
        support=[{"at": [[4, 4], [4, 1], [4, 7], [1, 4], [7, 4]], **bearings}],
        load=[{"pressure": 5e3}, {"force": 40e3, "at": [4, 4], "patch": [1, 1]}],
    )
    quarter = rectangular(
        plate={"shape": "rectangle", "size": [4, 4], "origin": [4, 4], "thickness": 0.2},
        divisions=[8, 8],
        support=[
            {"edge": ["left", "bottom"], "fix": "symmetry"},
            {"at": [4, 4], **bearings, "stiffness": 0.25e8},
            {"at": [[4, 7], [7, 4]], **bearings, "stiffness": 0.5e8},
        ],
        load=[{"pressure": 5e3}, {"force": 10e3, "at": [4, 4], "patch": [1, 1]}],
    )
    all_of_it, part = solve(whole)["all"], solve(quarter)["all"]
    forces = all_of_it.supports[0].reactions
    assert part.supports[1].reaction == pytest.approx(forces[0] / 4, rel=1e-9)
    np.testing.assert_allclose(part.supports[2].reactions, forces[[2, 4]] / 2, rtol=1e-9)
    points = [[4.3, 4.1], [6, 7.5]]
    np.testing.assert_allclose(
        [one.deflection for one in part.probe(points)], [one.deflection for one in all_of_it.probe(points)], rtol=1e-8
    )


def test_a_sector_has_its_part_of_a_disc_about_its_middle():
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "disc", "radius": 2, "sector": 90, "thickness": 0.2},
        support=[{"edge": ["start", "end"], "fix": "symmetry"}, {"edge": "rim", "fix": "simple"}],
        load=[{"force": 25e3, "at": [0, 0], "radius": 0.4}],
    )
    assert resultant(model)[0] == pytest.approx(25e3, rel=1e-12)


@pytest.mark.parametrize("item", ["support", "load"])
@pytest.mark.parametrize(("at", "mirror"), [([0.2, 2], False), ([0, 2], False), ([0.2, 2], True), ([0, 4], True)])
def test_a_footprint_beyond_the_plate_is_refused_with_its_place(item, at, mirror):
    others = [{"edge": "left", "fix": "symmetry"}] if mirror else []
    spread = {"at": [[2, 2], at], "patch": [0.5, 0.5]}
    support = [*others, spread] if item == "support" else [HARD, *others]
    load = [{"force": 1e3, **spread}] if item == "load" else [{"pressure": 1e3}]
    place = rf"{item}\[{len(others) + 1 if item == 'support' else 1}\]\.at\[2\]"
    with pytest.raises(InputError, match=place):
        discretise(rectangular(support=support, load=load))


@pytest.mark.parametrize("given", [{"radius": 1e-13}, {"patch": [0.5, 1e-13]}])
def test_footprints_too_small_to_be_told_from_points_are_refused(given):
    for table in ({"load": [{"force": 1, "at": [2.1, 2], **given}]}, {"support": [HARD, {"at": [2.1, 2], **given}]}):
        with pytest.raises(
            InputError, match=r"less than a billionth of the plate's size.* Give a larger footprint, or a point without"
        ):
            discretise(rectangular(**{"support": [HARD], "load": [{"pressure": 1}]} | table))


BOTH = [
    ({"patch": [0, 1]}, "greater than 0"),
    ({"patch": 1}, "length along x"),
    ({"radius": -1}, "greater than 0"),
    ({"radius": 1, "patch": [1, 1]}, "found both patch and radius"),
    ({"angle": 30}, "angle rotates a patch, but patch is missing"),
]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        *(({"load": [{"force": 1, "at": [2, 2], **given}]}, message) for given, message in BOTH),
        *(({"support": [HARD, {"at": [2, 2], **given}]}, message) for given, message in BOTH),
        ({"load": [{"pressure": 1, "patch": [1, 1]}]}, "patch is the footprint of points; pressure has none"),
        (
            {"load": [{"line_load": 1, "edge": "left", "radius": 1}]},
            "radius is the footprint of points; line_load has none",
        ),
        ({"support": [{"edge": "left", "fix": "simple", "radius": 1}]}, "use it with at or nodes"),
        ({"support": [{"at": [2, 2], "fix": "clamped", "radius": 1}]}, "holds slopes"),
        ({"load": [{"couple_about": {}, "at": [1, 1]}]}, "found neither x nor y"),
    ],
)
def test_footprints_have_a_size_and_are_those_of_points(wrong, message):
    with pytest.raises(InputError, match=message):
        rectangular(**{"support": [HARD], "load": [{"pressure": 1}]} | wrong)


def test_a_footprint_bears_at_its_middle():
    """Its pressure is even, so that it holds no moment: the limit of equilibrium is that of points."""

    def limit(**footprint):
        found = discretise(
            rectangular(
                support=[{"at": AT, "resists": "down", **footprint}],
                load=[
                    {"case": "G", "pressure": 5e3},
                    {"case": "Q", "force": 20e3, "at": [3.7, 2], "radius": 0.2},
                    {"case": "W", "force": 5e3, "at": [2, 0.5]},
                ],
            )
        )
        return nearest_limit(found, rigid_freedom(found), found.model.effective_combinations[0])

    (case, spread), (same, single) = limit(patch=[0.8, 0.8]), limit()
    assert case == same
    assert spread == pytest.approx(single, rel=1e-12)


def test_mean_deflections_over_one_place_may_differ_from_the_points():
    # A footprint's mean does not fix its middle: no contradiction, and a plate that bends between them.
    support = [{"edge": "left", "fix": "clamped"}, {"at": [2, 2], "radius": 0.5}, {"at": [2, 2], "settlement": 1e-4}]
    result = solve(rectangular(divisions=[8, 8], support=support, load=[{"pressure": 1e3}]))["all"]
    assert result.certificate.passed
    assert result.supports[1].reaction > 0 > result.supports[2].reaction


def test_supports_on_the_same_footprint_share_or_contradict():
    here = {"at": [3, 2], "radius": 0.5}
    left = {"edge": "left", "fix": "clamped"}
    shared = solve(rectangular(support=[left, here, here], load=[{"pressure": 1e3}]))["all"]
    assert shared.supports[1].reaction == pytest.approx(shared.supports[2].reaction, rel=1e-9)
    with pytest.raises(InputError, match="contradict each other"):
        solve(rectangular(support=[left, here, here | {"settlement": 1e-3}], load=[{"pressure": 1e3}]))


@pytest.mark.parametrize("how", [{"fix": "simple"}, {"resists": "down"}, {"stiffness": 1e8}])
def test_reactions_of_footprints_are_no_forces_on_nodes(how, tmp_path):
    """Spread over the mesh by its shape functions they would pull at some nodes."""
    model = rectangular(support=[{"name": "pads", "at": AT, "patch": [0.7, 0.5]} | how], load=[{"pressure": 1e3}])
    result = solve(model)["all"]
    assert result.reactions["pads"] == pytest.approx(16e3)
    assert not result.nodal_reaction.any()
    table = solve(model.model_copy(update={"output": Output(combinations="table")}))
    assert "reaction" not in table.envelope.fields
    assert "reaction" not in vtk_fields(result)[0]


def test_the_mesh_follows_patches():
    found = discretise(
        rectangular(divisions=[8, 8], support=[HARD], load=[{"force": 1, "at": [2.03, 2], "patch": [1, 1]}])
    )
    assert {1.53, 2.53} <= set(found.mesh.points[:, 0].round(12))


def test_a_patch_turned_with_the_plate_is_the_patch():
    points, c, s = [[0, 0], [6, 0], [6, 4], [0, 4]], np.cos(np.radians(35)), np.sin(np.radians(35))

    def turned(x, y):
        return [c * x - s * y, s * x + c * y]

    def found(turn, **angle):
        model = Model(
            material={"E": 30e9, "nu": 0.2},
            plate={"shape": "polygon", "points": [turn(*at) for at in points], "thickness": 0.2},
            mesh={"size": 0.5, "error": False},
            support=[
                {"edge": "edge 4", "fix": "symmetry"},
                {"edge": "edge 2", "fix": "simple"},
                {"at": turn(1.5, 2.5), "patch": [0.6, 0.4], "resists": "down", **angle},
            ],
            load=[
                {"force": 1e5, "at": turn(3.1, 1.2), "patch": [0.9, 0.5], **angle},
                {"force": 1e4, "at": turn(0, 1), "patch": [0.9, 0.5], **angle},
            ],
            probe=[{"at": turn(3, 1)}],
        )
        return solve(model)["all"]

    straight, askew = found(lambda x, y: [x, y]), found(turned, angle=35)
    assert askew.probes[0].deflection == pytest.approx(straight.probes[0].deflection, rel=1e-7)
    assert askew.reactions["support 3"] == pytest.approx(straight.reactions["support 3"], rel=1e-7)
    with pytest.raises(InputError, match="off the plate"):
        found(turned, angle=20)


@pytest.mark.parametrize("stiffness", [1e5, 4e6, 1e8])
def test_a_footprint_that_turns_takes_the_couple_of_beam_theory(stiffness):
    """A beam under an end couple M₀ on a footprint of length a at its middle, which turns by the mean of θ over it.

    By the principle of virtual work, with m̄ = 1/a over the footprint and M̄, V̄ of it: φ = ∫ M̄ M/EI + V̄ V/κGA dx.
    """
    young, h, span, a, width, end = 30e9, 0.4, 4.0, 0.5, 0.5, 1e4
    bending, shear = young * h**3 / 12 * width, 5 / 6 * young / 2 * h * width
    model = Model(
        material={"E": young, "nu": 0.0},
        plate={"shape": "rectangle", "size": [span, width], "thickness": h},
        mesh={"divisions": [128, 1], "error": False},
        support=[
            {"edge": ["left", "right"], "fix": "simple"},
            {
                "name": "column",
                "at": [2, 0.25],
                "patch": [a, width],
                "stiffness": 1.0,
                "rotational_stiffness": [1.0, stiffness],
            },
        ],
        load=[{"moment": [end, 0], "at": [a / 2, width / 2], "patch": [a, width]}],
    )
    x = np.linspace(0, span, 80001)
    mean = np.clip((x - (span - a) / 2) / a, 0, 1)
    unit = mean - x / span
    # The load's pressure c x on its footprint has the couple end.
    s = np.clip(x / a, 0, 1)
    force = 6 * end / a * (s**2 - s)
    given = end * (3 * s**2 - 2 * s**3) - end * x / span
    bend = np.trapezoid(unit * given, x) / bending
    slide = np.trapezoid((force + end / span) * -1 / span, x) * -1 / shear
    flexibility = np.trapezoid(unit**2, x) / bending + 1 / span / shear
    turned = (bend + slide) / (1 + stiffness * flexibility)
    result = solve(model)["all"]
    assert result.supports[1].moments[0, 0] == pytest.approx(-stiffness * turned, rel=2e-3)


@pytest.mark.parametrize("mesh", [{"size": 0.5}, {"divisions": [11, 7]}])
def test_footprints_that_turn_balance_the_load_and_sections_that_cross_them(mesh):
    columns = {"at": [[0.5, 0.5], [5.5, 0.5], [5.5, 3.5], [0.5, 3.5], [2.3, 2]], "resists": "down", "stiffness": 1e8}
    model = rectangular(
        size=(6, 4),
        mesh={**mesh, "error": False},
        support=[{**columns, "patch": [0.6, 0.4], "rotational_stiffness": [2e7, "3e7 + 1e6*x"]}],
        load=[{"pressure": 1e4}, {"force": 5e4, "at": [4.2, 1.3]}],
        section=[{"name": "cut", "line": [[2.2, 0], [2.2, 4]]}],
    )
    result = solve(model)["all"]
    of = result.supports[0]
    assert (np.abs(of.moments) > 10).all()
    assert of.reaction == pytest.approx(1e4 * 24 + 5e4, rel=1e-12)
    for axis, moment in enumerate((1e4 * 24 * 3 + 5e4 * 4.2, 1e4 * 24 * 2 + 5e4 * 1.3)):
        assert of.reactions @ of.positions[:, axis] - of.moments[:, axis].sum() == pytest.approx(moment, rel=1e-10)
    # A third of the last column, about x = 2.1, is on the left.
    forces, couples = of.reactions[[0, 3, 4]] * [1, 1, 1 / 3], of.moments[[0, 3, 4], 0] * [1, 1, 1 / 3]
    levers = 2.2 - np.array([0.5, 0.5, 2.1])
    (cut,) = result.sections
    assert abs(cut.shear) == pytest.approx(abs(1e4 * 2.2 * 4 - forces.sum()), rel=1e-9)
    assert cut.moment == pytest.approx(forces @ levers + couples.sum() - 1e4 * 4 * 2.2**2 / 2, rel=1e-9)


def test_the_couple_of_a_footprint_is_its_stiffness_times_its_mean_rotation():
    at, radius = [[1.37, 2.2], [2.5, 1.3]], 0.3
    model = rectangular(
        mesh={"size": 0.4, "error": False},
        support=[
            {"edge": "left", "fix": "simple"},
            {"edge": "right", "resists": "down"},
            {"at": at, "radius": radius, "rotational_stiffness": [2e6, 5e6]},
        ],
        load=[{"pressure": 1e4}, {"force": 1e4, "at": [3, 3]}],
    )
    result = solve(model)["all"]
    r, turn = np.meshgrid(radius * np.sqrt((np.arange(40) + 0.5) / 40), 2 * np.pi * (np.arange(40) + 0.5) / 40)
    around = np.column_stack([(r * np.cos(turn)).ravel(), (r * np.sin(turn)).ravel()])
    for middle, couples in zip(at, result.supports[2].moments, strict=True):
        rotation = np.mean([probe.rotation for probe in result.probe(middle + around)], axis=0)
        assert couples == pytest.approx(-rotation * [5e6, 2e6], rel=2e-3, abs=1)


HOLE = {"circle": {"center": [1, 1], "radius": 0.1}}
PLATE = {"shape": "rectangle", "size": [2, 2], "thickness": 0.04, "holes": [HOLE]}
STEEL = {"E": 210e9, "nu": 0.3}
SIDES = {"edge": ["left", "right"], "fix": "simple"}


def test_a_washer_over_a_hole_spreads_its_force_over_the_annulus_on_the_plate():
    at, rim = {"at": [1, 1], "radius": 0.2}, {"annulus": {"center": [1, 1], "inner": 0.1, "outer": 0.2}}
    results = [
        solve(
            Model(
                material=STEEL,
                plate=PLATE,
                mesh={"size": 0.2, "error": False},
                support=[SIDES],
                load=[load],
                section=[{"line": [[0.95, 0], [0.95, 2]]}],
            )
        )["all"]
        for load in ({"force": 1e4, **at}, {"pressure": 1e4 / (np.pi * (0.2**2 - 0.1**2)), "area": rim})
    ]
    deflections = [result.deflection for result in results]
    np.testing.assert_allclose(*deflections, rtol=0, atol=2e-3 * deflections[1].max())
    assert results[0].sections[0].moment == pytest.approx(results[1].sections[0].moment, rel=1e-2)
    for result in results:
        assert result.supports[0].reaction == pytest.approx(1e4, rel=2e-3)


@pytest.mark.parametrize("footprint", [{"radius": 0.2}, {"patch": [0.4, 0.3]}])
def test_a_bolt_in_a_hole_holds_the_mean_deflection_under_its_washer(footprint):
    bolt = {"name": "bolt", "at": [[1, 1], [0.5, 1.6]], **footprint, "stiffness": 1e7}
    upper = Model(
        material=STEEL,
        plate=PLATE,
        mesh={"size": 0.2, "error": False},
        support=[SIDES, {**bolt, "resists": "down"}],
        load=[{"pressure": 1e4}],
    )
    plates = {name: {**PLATE, "mesh": {"size": 0.2}} for name in ("upper", "lower")}
    between = Model(
        material=STEEL,
        plates=plates,
        mesh={"error": False},
        zone=[{"plate": "lower", "area": {"rectangle": [0, 0, 2, 2]}, "rigid": True}],
        contact=[{**bolt, "between": ["upper", "lower"]}],
        support=[{"plate": "upper", **SIDES}, {"plate": "lower", "edge": ["left", "right"], "fix": "clamped"}],
        load=[{"plate": "upper", "pressure": 1e4}],
    )
    alone = solve(upper)["all"]
    assert alone.certificate.passed
    assert alone.reactions["support 1"] + alone.reactions["bolt"] == pytest.approx(1e4 * (4 - np.pi * 0.01), rel=1e-3)
    both = solve(between)["all"]
    assert both.certificate.passed
    np.testing.assert_allclose(both.supports[-1].reactions, alone.supports[-1].reactions, rtol=1e-9)


@pytest.mark.parametrize("footprint", [{}, {"radius": 0.08}])
def test_a_bolt_in_a_hole_without_a_washer_is_refused(footprint):
    bolt = {"at": [1, 1], "resists": "up", **footprint}
    model = Model(material=STEEL, plate=PLATE, mesh={"size": 0.2}, support=[SIDES, bolt], load=[{"pressure": 1e4}])
    with pytest.raises(InputError, match=r"support\[2\]\.at: .*arger than the hole"):
        solve(model)
