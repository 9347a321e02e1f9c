"""Plates on soil and grout that only push: closed forms, and the active set against Lemke's algorithm."""

import numpy as np
import pytest

import signorini
from signorini import Model

SOIL = {"name": "soil", "area": "all", "resists": "down"}


def solved(method: str = "auto", **keys: object) -> signorini.Result:
    result = signorini.solve(Model.model_validate({"solver": {"method": method}, **keys}))["all"]
    assert result.certificate.passed
    return result


def strip(divisions: int) -> tuple[float, float, float]:
    """EI = k = 1, so ℓ = 1; thin, ν = 0, central line load of 1."""
    thickness, width = 0.02, 0.5
    result = solved(
        material={"E": 12 / thickness**3, "nu": 0},
        plate={"shape": "rectangle", "size": [12, width], "origin": [-6, 0], "thickness": thickness},
        mesh={"divisions": [divisions, 2]},
        support=[{**SOIL, "stiffness": 1}],
        load=[{"line_load": 1, "line": [[0, 0], [0, width]]}],
        probe=[{"at": [0, width / 2]}],
    )
    area = result.supports[0].contact_area
    assert area is not None
    return area / width / 2, result.probes[0].deflection, result.probes[0].moment[0]


def test_long_strip_under_a_line_load() -> None:
    """Closed form (Hetényi's beam cut where its deflection vanishes): half-length, deflection and moment."""
    lam = 1 / np.sqrt(2)
    exact = np.array([2.221441, 1.090331 * lam / 2, 1.090331 / (4 * lam)])
    errors = [np.abs(np.array(strip(n)) / exact - 1) for n in (40, 80)]
    assert errors[1].max() < 0.005
    assert errors[1][2] < 0.3 * errors[0][2]
    assert errors[0][0] < 1e-3 and errors[1][0] < 1e-3


@pytest.mark.parametrize(
    ("radius", "contact", "centre", "rim"),
    [(3, 2.672175, 0.136545, -0.013917), (5, 2.773571, 0.133210, -0.066287)],
)
def test_free_disc_under_a_central_load(radius: float, contact: float, centre: float, rim: float) -> None:
    """Kelvin functions inside the contact circle, a free plate outside (thin, D = k = 1)."""
    result = solved(
        material={"E": 12 * (1 - 0.09) / 0.01**3, "nu": 0.3},
        plate={"shape": "disc", "radius": radius, "thickness": 0.01},
        mesh={"divisions": [16, 64]},
        support=[{**SOIL, "stiffness": 1}],
        load=[{"force": 1, "at": [0, 0]}],
        probe=[{"at": [[0, 0], [radius, 0]]}],
    )
    area = result.supports[0].contact_area
    assert area is not None
    assert np.sqrt(area / np.pi) == pytest.approx(contact, rel=0.002)
    assert result.probes[0].deflection == pytest.approx(centre, rel=0.002)
    assert result.probes[1].deflection == pytest.approx(rim, rel=0.01)


def test_code_aster_ssnl130_on_a_continuous_bed() -> None:
    """Code_Aster V6.02.130: w(0) = 4/1125 m, w(2) = −4/3375 m, contact over 1.5 m."""
    result = solved(
        material={"E": 2e11, "nu": 0},
        plate={"shape": "rectangle", "size": [1, 2], "thickness": 0.3},
        mesh={"divisions": [4, 8]},
        support=[{**SOIL, "stiffness": 5e3}],
        load=[{"pressure": "5*(y-2)**2"}],
        probe=[{"at": [[0.5, 0], [0.5, 2]]}],
    )
    assert result.probes[0].deflection == pytest.approx(4 / 1125, rel=1e-6)
    assert result.probes[1].deflection == pytest.approx(-4 / 3375, rel=1e-6)
    assert result.supports[0].contact_area == pytest.approx(1.5, rel=1e-6)


def test_rigid_footing_with_an_eccentricity_of_a_quarter() -> None:
    """Triangular pressure: contact over 0.75 B, greatest pressure 8/3 of the mean."""
    result = solved(
        material={"E": 1e12, "nu": 0.2},
        plate={"shape": "rectangle", "size": [2, 2], "thickness": 1},
        mesh={"divisions": [8, 8]},
        support=[{**SOIL, "stiffness": 1e6}],
        load=[{"force": 1e3, "at": [1.5, 1]}],
    )
    assert result.supports[0].contact_area == pytest.approx(3.0, rel=1e-5)
    assert result.supports[0].max_pressure == pytest.approx(8 / 3 * 1e3 / 4, rel=1e-5)


def test_rigid_base_plate_on_grout_with_anchors() -> None:
    """Equilibrium of the linear stress block with two bolts: length 0.362679 m, bolts 199.126 kN, 9.638 MPa."""
    result = solved(
        material={"E": 2e16, "nu": 0.3},
        plate={"shape": "rectangle", "size": [0.6, 0.4], "origin": [-0.3, -0.2], "thickness": 0.1},
        mesh={"divisions": [24, 16]},
        support=[
            {**SOIL, "stiffness": 1e10},
            {"name": "bolts", "at": [[-0.25, -0.1], [-0.25, 0.1]], "resists": "up", "stiffness": 2e8},
        ],
        load=[{"force": 500e3, "at": [0.3, 0]}, {"moment": [500e3 * 0.05, 0], "at": [0, 0]}],
    )
    grout = result.supports[0]
    assert grout.contact_area is not None
    assert grout.contact_area / 0.4 == pytest.approx(0.362679, rel=1e-3)
    assert -result.reactions["bolts"] == pytest.approx(199.126e3, rel=1e-3)
    assert grout.max_pressure == pytest.approx(9.638e6, rel=1e-3)


def slab_a(divisions: int, method: str = "auto") -> signorini.Result:
    return solved(
        method,
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        mesh={"divisions": [divisions, divisions]},
        support=[{**SOIL, "stiffness": 30e6}],
        load=[{"pressure": 2e3}, {"pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}}],
    )


def test_slab_a_settles_and_lifts_as_converged() -> None:
    """4.229 mm, contact over 0.915 to 0.917 of the area, 126.86 kPa; GetFEM, CalculiX and OpenSees agree."""
    result = slab_a(40)
    area = result.supports[0].contact_area
    assert area is not None
    assert result.deflection.max() == pytest.approx(4.229e-3, rel=5e-4)
    assert area / 100 == pytest.approx(0.916, abs=2e-3)
    assert result.supports[0].max_pressure == pytest.approx(126.86e3, rel=1e-3)
    assert -1.5e-5 < result.deflection.min() < -1.4e-5


def test_active_set_and_lemke_give_the_same_slab() -> None:
    by_lemke, by_active_set = slab_a(8, "lemke"), slab_a(8, "active_set")
    assert (by_lemke.method, by_active_set.method) == ("lemke", "active_set")
    assert np.abs(by_lemke.deflection - by_active_set.deflection).max() < 1e-10 * np.abs(by_lemke.deflection).max()
    assert (by_lemke.supports[0].closed == by_active_set.supports[0].closed).all()


def test_a_plate_that_touches_nothing_at_the_start_falls_onto_the_soil() -> None:
    """The gap is a hundred settlements deep; the answer is that without a gap, lower by it."""
    on, above = (
        solved(
            "active_set",
            material={"E": 30e9, "nu": 0.2},
            plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
            mesh={"divisions": [8, 8]},
            support=[{**SOIL, "stiffness": 30e6, "gap": gap}],
            load=[{"pressure": 2e3}, {"force": 5e5, "at": [1, 1]}],
        )
        for gap in (0.0, 0.5)
    )
    assert np.abs(above.deflection - 0.5 - on.deflection).max() < 1e-9 * np.abs(on.deflection).max()


def test_soil_with_bearings_anchors_and_a_wall_is_what_lemke_finds() -> None:
    """Soft and hard points together, some of each open."""
    by_lemke, result = (
        solved(
            method,
            material={"E": 30e9, "nu": 0.2},
            plate={"shape": "rectangle", "size": [10, 6], "thickness": 0.25},
            mesh={"divisions": [10, 6]},
            support=[
                {**SOIL, "stiffness": 2e6, "gap": "1e-4 * x"},
                {"name": "pads", "at": [[2, 2], [8, 2], [5.13, 4.77]], "resists": "down", "gap": 5e-4},
                {"name": "anchors", "at": [[0.5, 5.5], [9.5, 5.5]], "resists": "up"},
                {"name": "wall", "edge": "bottom", "resists": "down", "gap": 2e-4},
            ],
            load=[{"pressure": 3e3}, {"force": 4e5, "at": [8.2, 1.1]}],
        )
        for method in ("lemke", "active_set")
    )
    assert (by_lemke.method, result.method) == ("lemke", "active_set")
    assert sum(result.reactions.values()) == pytest.approx(3e3 * 60 + 4e5, rel=1e-9)
    assert np.abs(by_lemke.deflection - result.deflection).max() < 1e-9 * np.abs(result.deflection).max()
    for ours, theirs in zip(result.supports, by_lemke.supports, strict=True):
        assert (ours.closed == theirs.closed).all()
    hard = np.concatenate([support.closed for support in result.supports[1:]])
    assert 0 < hard.sum() < len(hard) and result.reactions["soil"] > 0


def test_few_points_of_very_stiff_soil_under_a_thin_plate() -> None:
    """A thin plate on very stiff soil that few points touch, on a wall that may let go."""
    tables = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [4.7, 3.5], "thickness": 0.0267},
        "mesh": {"divisions": [5, 4]},
        "support": [
            {**SOIL, "stiffness": 4.15e8, "gap": "1e-3*abs(x-1)"},
            {"name": "wall", "edge": "left", "resists": "down"},
        ],
        "load": [
            {"pressure": 361.0},
            {"force": -16.7e3, "at": [2.4, 2.18]},
            {"force": 3.8e3, "at": [3.79, 0.77]},
            {"force": 79.4e3, "at": [1.13, 2.67]},
        ],
    }
    by_lemke, result = solved("lemke", **tables), solved("active_set", **tables)
    assert result.method == "active_set"
    assert np.abs(by_lemke.deflection - result.deflection).max() < 1e-8 * np.abs(result.deflection).max()


@pytest.mark.parametrize(("thickness", "stiffness"), [(0.3, None), (0.03, None), (0.3, 1e10), (0.3, 1e3)])
def test_a_bed_from_soft_to_rigid_under_a_curled_slab(thickness: float, stiffness: float | None) -> None:
    """The gap is a bowl that opens towards the corners; points of the bed are elements where it is rigid."""
    bed = {"name": "bed", "area": "all", "resists": "down", "gap": "4e-5*((x-5)**2 + (y-5)**2)"}
    by_lemke, result = (
        solved(
            method,
            material={"E": 30e9, "nu": 0.2},
            plate={"shape": "rectangle", "size": [10, 10], "thickness": thickness},
            mesh={"divisions": [9, 9]},
            support=[bed if stiffness is None else {**bed, "stiffness": stiffness}],
            load=[{"pressure": 2e3}, {"force": 1e5, "at": [3, 4]}],
        )
        for method in ("lemke", "active_set")
    )
    assert (by_lemke.method, result.method) == ("lemke", "active_set")
    assert np.abs(by_lemke.deflection - result.deflection).max() < 1e-9 * np.abs(result.deflection).max()
    ours, theirs = result.supports[0], by_lemke.supports[0]
    assert 0 < ours.closed.sum() and (ours.closed.sum() < len(ours.closed) or stiffness == 1e3)
    assert np.abs(ours.reactions - theirs.reactions).max() < 1e-8 * np.abs(theirs.reactions).max()


def test_the_lcp_of_a_bedded_plate_has_every_point_whatever_solves_it() -> None:
    tables = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        "mesh": {"divisions": [6, 6]},
        "support": [{**SOIL, "stiffness": 30e6}],
        "load": [{"pressure": 2e3}, {"force": 5e5, "at": [1, 1]}],
    }
    problem = signorini.contact_problem(Model.model_validate(tables))
    assert problem.method == "active_set"
    posed = problem.lcp(problem.load("all"))
    assert sorted(posed.points) == list(range(len(problem.gaps)))
    answer = signorini._core.lemke(posed.M, posed.q)
    direct = problem.solve(problem.discretisation.cases["load"])
    gap = np.where(posed.gap_is_z, answer.z, answer.w)
    assert np.abs(gap - direct.gap[posed.points]).max() < 1e-9 * np.abs(direct.hi[::3]).max()
