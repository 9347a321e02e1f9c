"""Plates at rest, small loads and forces that only round: the answer is zero, or as exact as for other loads."""

import io
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from models import rectangular
from rich.console import Console

import signorini
from signorini import Model
from signorini.cli.tables import print_results
from signorini.contact.selection import span_of_cone
from signorini.discretise.laws import Law

CONCRETE = {"E": 30e9, "nu": 0.2}
FEET = [[1, 1], [5, 1], [1, 3], [5, 3]]
LAW = [[0, 0], [6.02e-05, 12670.0], [1.023e-4, 15200.0]]
PLACES = {
    "points": {"at": FEET},
    "edges": {"edge": ["left", "right"]},
    "area": {"area": "all"},
    "circle": {"circle": {"center": [3, 2], "radius": 1.5}},
    "footprints": {"at": FEET, "radius": 0.3},
}


def slab(support, load, divisions=(6, 4), **more) -> Model:
    """A plate of 6 by 4 m, 0.3 m thick."""
    mesh = {"divisions": list(divisions), "error": False}
    plate = {"shape": "rectangle", "size": [6, 4], "thickness": 0.3}
    return Model(material=CONCRETE, plate=plate, mesh=mesh, support=[support], load=load, **more)


def on_soil(divisions: int) -> Model:
    """A plate that rests on soil, loaded near a corner."""
    return Model(
        material=CONCRETE,
        plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        mesh={"divisions": [divisions, divisions], "error": False},
        support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 30e6}],
        load=[{"case": "p", "pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}}],
    )


def test_a_path_from_rest_on_soil_takes_no_memory_that_grows_with_the_square_of_contact_points() -> None:
    model = on_soil(67)
    points = len(signorini.contact_problem(model).gaps)
    tracemalloc.start()
    try:
        found = signorini.path(model, None, "p", until=1.0, at=[1.0])
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert points >= 40_000 and found.end == 1.0
    assert found.stops[-1].reactions[0] == pytest.approx(500e3, rel=1e-9)
    # A matrix of the points squared has 8 bytes times 40,000 times 40,000, or an eighth of that as truth values.
    assert peak < 0.5 * points**2


def test_a_path_takes_no_more_solves_on_a_fine_mesh_than_on_a_coarse_one() -> None:
    for divisions in (4, 12):
        seen: set[str] = set()
        signorini.path(on_soil(divisions), None, "p", progress=lambda now, seen=seen: seen.add(now.combination))
        assert 50 < len(seen) <= 60


@pytest.mark.parametrize("seed", range(8))
def test_the_span_of_a_cone_holds_its_directions_and_no_others(seed: int) -> None:
    rng = np.random.default_rng(seed)
    inner, none = rng.normal(size=(2, 5)), rng.normal(size=(1, 5))
    # Rows that a direction leaves, and an equation as two rows.
    sides = rng.normal(size=(40, 5))
    sides *= -np.sign(sides @ inner[0])[:, None]
    across = none - (none @ np.linalg.pinv(inner)) @ inner
    basis = span_of_cone(np.vstack([sides, across, -across]))
    assert np.abs(inner @ (np.eye(5) - basis @ basis.T)).max() < 1e-9 or basis.shape[1] == 4
    assert basis.shape[1] == 4 and np.abs(across @ basis).max() < 1e-9


@pytest.mark.parametrize("resists", ["down", "both"])
@pytest.mark.parametrize("place", PLACES)
def test_a_combination_without_load_gives_zeros_on_a_law(place: str, resists: str) -> None:
    given = {**PLACES[place], "resists": resists, "law": LAW}
    combinations = [{"name": "Q", "factors": {"Q": 1}}, {"name": "nothing", "factors": {}}]
    results = signorini.solve(slab(given, [{"case": "Q", "pressure": 1e3}], combination=combinations))
    nothing = results["nothing"]
    assert results["Q"].deflection.max() > 1e-6
    assert not nothing.deflection.any() and not nothing.moment.any() and not nothing.supports[0].reactions.any()


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("factor", [1e-12, 1.0])
def test_a_limit_that_is_never_reached_changes_nothing(place: str, factor: float) -> None:
    given = {**PLACES[place], "resists": "both", "stiffness": 1e8}
    load = [{"pressure": 1e4 * factor}]
    free = signorini.solve(slab(given, load))["all"]
    for limit in (1e13, 1e15, 1e20):
        limited = signorini.solve(slab({**given, "limit": limit}, load))["all"]
        np.testing.assert_allclose(limited.deflection, free.deflection, rtol=1e-9)
        assert limited.supports[0].reaction == pytest.approx(free.supports[0].reaction, rel=1e-8)


def test_travels_and_forces_near_zero_keep_their_digits_beside_distant_vertices() -> None:
    law = Law(((-1e7, -1e15), (1e7, 1e15)), (0.0, 0.0))
    force = np.array([-3e-9, 0.0, 7e-9])
    for travel in law.travels(force):
        np.testing.assert_allclose(travel, force / 1e8, rtol=1e-15)
        np.testing.assert_allclose(law.force_at(travel), force, rtol=1e-15)


@pytest.mark.parametrize("events", ["named", "all"])
@pytest.mark.parametrize("pressure", [1e-3, 1.0, 1e9])
def test_a_path_from_nothing_follows_to_the_limit_load_in_any_unit_of_the_load(pressure: float, events) -> None:
    edges = {"edge": ["left", "right", "top", "bottom"], "resists": "both", "stiffness": 1e8, "limit": 1e5}
    model = slab(edges, [{"case": "Q", "pressure": pressure}], divisions=[7, 5])
    found = signorini.path(model, None, "Q", events=events, **({"steps": 2} if events == "named" else {}))
    assert found.ending == "no_equilibrium" and found.limit == pytest.approx(1e5 * 20 / 24 / pressure, rel=1e-9)


@pytest.mark.parametrize(
    ("formula", "at", "integral"),
    [
        ("1 + abs(x - 3)", (3.0, 2.0), 60.0),
        ("max(1, y - 1)", (3.0, 22 / 9), 36.0),
        ("max(0.2, min(1, hypot(x - 3, y - 2)))", (3.0, 2.0), 24.0 - np.pi * (1 - 0.2**3) / 3),
        ("where(x < 1.3, 2, 1 + abs(x - 3))", (2.9, 2.0), None),
    ],
)
def test_the_limit_load_of_a_bed_is_the_integral_of_its_limit(formula, at, integral) -> None:
    bed = {"area": "all", "resists": "down", "stiffness": 1e8, "limit": f"1e5 * ({formula})"}
    if integral is None:
        parts = [(2 * 1.3, 0.65), (1.7 * 1.85, 1.3 + 1.7 * (2.7 + 2) / (3 * 3.7)), (7.5, 3 + 3 * (1 + 8) / (3 * 5))]
        force = sum(part for part, _ in parts)
        at, integral = (sum(part * arm for part, arm in parts) / force, 2.0), 4 * force
    load = [{"case": "Q", "force": 1.0, "at": list(at), "patch": [0.5, 0.5]}]
    found = signorini.path(slab(bed, load, divisions=[7, 5]), None, "Q", until=1.0, steps=1)
    assert found.limit == pytest.approx(1e5 * integral, rel=1e-5)


def test_where_limits_are_of_the_points_of_a_mesh_the_end_of_a_path_has_a_half_width() -> None:
    bed = {"area": "all", "resists": "down", "stiffness": 1e8, "limit": 1e5}

    def followed(divisions):
        load = [{"case": "Q", "force": 1.0, "at": [3.7, 2.0], "patch": [0.5, 0.5]}]
        model = slab(bed, load, divisions=divisions)
        return signorini.path(model, None, "Q", steps=2)

    found = followed([10, 6])
    # The reactions have their resultant under the load: a strip of 2 (6 - 3.7) m carries it.
    exact, width = 1e5 * 4 * 2 * (6 - 3.7), signorini.estimate(found).end
    assert found.ending == "no_equilibrium" and 0 < abs(found.limit - exact) <= width < 0.1 * exact


def test_a_row_without_equilibrium_is_a_load_of_a_path(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text("name,G,Q\nalone,1,0\nlift,0,1\n")
    (tmp_path / "slab.toml").write_text(
        """
        material = { E = 30e9, nu = 0.2 }
        plate = { shape = "rectangle", size = [6, 4], thickness = 0.3 }
        mesh = { divisions = [6, 4], error = false }
        support = [{ name = "feet", at = [[1, 1], [5, 1], [1, 3], [5, 3]], resists = "down" }]
        load = [{ case = "G", pressure = 1e4 }, { case = "Q", force = -1e4, at = [3, 2] }]
        combination = [{ name = "rows", generate = "table", file = "rows.csv" }]
        """
    )
    found = signorini.path(signorini.load(tmp_path / "slab.toml"), "alone", "lift", steps=2)
    assert found.limit == pytest.approx(24.0) and found.ending == "no_equilibrium"


@pytest.mark.parametrize("count", [1, 13])
def test_numbers_that_are_rounding_are_not_said_to_be_wide(count: int) -> None:
    model = rectangular(
        size=(6, 4),
        divisions=[4, 3],
        support=[{"area": "all", "resists": "down", "stiffness": 2e7}],
        load=[{"case": "G", "pressure": 1e4}],
        combination=[{"name": f"c{i}", "factors": {"G": 1 + i}} for i in range(count)],
    )
    results, out = signorini.solve(model), io.StringIO()
    print_results(Console(file=out, width=200), results, signorini.estimate(results))
    assert "±" in out.getvalue() and "more than half" not in out.getvalue()


@pytest.mark.parametrize(("divisions", "elements"), [((2, 2), (64, 16, 4)), ((1, 2), (32, 8, 2))])
def test_a_path_on_few_elements_is_compared_with_two_other_meshes(divisions, elements) -> None:
    clamped = signorini.load(Path(__file__).parents[1] / "examples" / "clamped_quarter.toml")
    model = clamped.model_copy(update={"mesh": clamped.mesh.model_copy(update={"divisions": divisions})})
    compared = signorini.estimate(signorini.path(model, None, "load", until=1.0, steps=2))
    assert compared.elements == elements
    if divisions == (2, 2):
        # On 16 by 16 elements the gap closes at t = 0.49884.
        assert 0.5 - 0.49884 <= compared.events[0] <= 0.005


@pytest.mark.parametrize("count", [1, 13])
def test_an_extreme_over_plates_has_the_half_width_of_its_plate(count: int) -> None:
    steel = {"material": {"E": 210e6, "nu": 0.3}, "shape": "rectangle", "size": [1.2, 1.2], "origin": [0.9, 0.15]}
    mat = {"material": {"E": 10e6, "nu": 0.2}, "shape": "rectangle", "size": [3, 1.5], "thickness": 0.2}
    mesh = {"steel": {"mesh": {"size": 0.2}}, "mat": {"mesh": {"size": 0.3}}}
    model = Model(
        plates={"steel": {**steel, "thickness": 0.04, **mesh["steel"]}, "mat": {**mat, **mesh["mat"]}},
        contact=[{"name": "between", "between": ["steel", "mat"], "area": "all", "stiffness": 2e6}],
        support=[{"name": "soil", "plate": "mat", "area": "all", "resists": "down", "stiffness": 20e3}],
        load=[{"case": "Q", "plate": "steel", "force": 400, "at": [1.8, 0.9], "patch": [0.5, 0.5]}],
        combination=[{"name": f"c{i}", "factors": {"Q": 1 + 0.1 * i}} for i in range(count)],
    )
    results = signorini.solve(model)
    estimates = signorini.estimate(results)
    told = 0
    for field in ("deflection", "mx", "my", "qx", "qy"):
        for side in ("max", "min"):
            values = {plate: results.table[f"{side}:{plate}.{field}"][0] for plate in ("steel", "mat")}
            owner = min(values, key=lambda plate: abs(values[plate] - results.table[f"{side}:{field}"][0]))
            widths = [estimates.half_width(f"{side}:{name}", 0) for name in (field, f"{owner}.{field}")]
            assert widths[0] == widths[1]
            told += owner == "mat"
    assert 0 < told < 10
