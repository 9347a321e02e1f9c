"""Invariance under scale, units, place and orientation; and the theorems of linear elasticity."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from signorini import Model, NoEquilibriumError, solve
from signorini.contact.problem import contact_problem

BEARINGS = [[0.7, 0.6], [3.4, 0.5], [3.3, 3.2], [0.5, 3.5], [2.0, 1.9]]


def tables(supports, loads, divisions=(3, 3), size=(4.0, 4.0), origin=(0.0, 0.0), thickness=0.3, **more):
    return {
        "material": {"E": 1000.0, "nu": 0.3},
        "plate": {"shape": "rectangle", "size": list(size), "origin": list(origin), "thickness": thickness, **more},
        "mesh": {"divisions": list(divisions)},
        "support": supports,
        "load": loads,
    }


def run(model):
    return solve(Model(**model))["all"]


def at_points(result, points):
    return np.array([probe.deflection for probe in result.probe(points)])


coordinate = st.integers(0, 40).map(lambda i: i / 10)
spots = st.tuples(coordinate, coordinate)
forces = st.lists(st.tuples(spots, st.integers(-3, 9).filter(bool)), min_size=1, max_size=3, unique_by=lambda f: f[0])
kinds = st.lists(
    st.tuples(st.sampled_from(["down", "down", "both", "up"]), st.sampled_from([0.0, 0.0, 0.004]), st.booleans()),
    min_size=5,
    max_size=5,
)


def supports_of(kinds, turn=lambda x, y: (x, y), length=1.0, force=1.0, settlement=0.0):
    out = []
    for (x, y), (resists, gap, soft) in zip(BEARINGS, kinds, strict=True):
        a, b = turn(x, y)
        out.append({"at": [length * a, length * b], "resists": resists, "gap": length * gap, "settlement": settlement})
        if soft:
            out[-1]["stiffness"] = 500.0 * force / length
    return out


def loads_of(forces, turn=lambda x, y: (x, y), length=1.0, force=1.0):
    pushes = [{"force": float(p) * force, "at": [length * c for c in turn(*at)]} for at, p in forces]
    return [{"pressure": 2.0 * force / length**2}, *pushes]


def solved(model):
    try:
        return run(model)
    except NoEquilibriumError:
        return None


GRID = [(x, y) for x in (0.0, 1.3, 2.9, 4.0) for y in (0.0, 0.9, 2.2, 4.0)]
TURNS = {
    "mirrored": (lambda x, y: (4.0 - x, y), (0.0, 0.0)),
    "transposed": (lambda x, y: (y, x), (0.0, 0.0)),
    "turned": (lambda x, y: (-y, x), (-4.0, 0.0)),
    "moved": (lambda x, y: (x + 700.0, y - 300.0), (700.0, -300.0)),
}


@pytest.mark.parametrize("way", TURNS)
@settings(max_examples=12)
@given(kinds=kinds, forces=forces)
def test_orientation_and_place_do_not_matter(way, kinds, forces):
    turn, origin = TURNS[way]
    first = solved(tables(supports_of(kinds), loads_of(forces)))
    second = solved(tables(supports_of(kinds, turn), loads_of(forces, turn), origin=origin))
    assert (first is None) == (second is None)
    assume(first is not None)
    u, v = at_points(first, GRID), at_points(second, [turn(*at) for at in GRID])
    # Coordinates far away carry fewer digits.
    accuracy = 1e-8 if way != "moved" else 1e-6
    assert np.abs(u - v).max() <= accuracy * max(np.abs(u).max(), 1e-6)


@settings(max_examples=15)
@given(kinds=kinds, forces=forces, length=st.sampled_from([1e-3, 1e3, 0.3048]), force=st.sampled_from([1e-6, 1e3, 1e9]))
def test_units_do_not_matter(kinds, forces, length, force):
    first = solved(tables(supports_of(kinds), loads_of(forces)))
    scaled = tables(
        supports_of(kinds, length=length, force=force),
        loads_of(forces, length=length, force=force),
        size=(4.0 * length, 4.0 * length),
        thickness=0.3 * length,
    )
    scaled["material"]["E"] = 1000.0 * force / length**2
    second = solved(scaled)
    assert (first is None) == (second is None)
    assume(first is not None)
    u, v = first.deflection, second.deflection / length
    assert np.abs(u - v).max() <= 1e-8 * max(np.abs(u).max(), 1e-6)
    for name, reaction in first.reactions.items():
        assert second.reactions[name] / force == pytest.approx(reaction, rel=1e-7, abs=1e-7)


@settings(max_examples=15)
@given(kinds=kinds, forces=forces, factor=st.sampled_from([1e-6, 0.5, 3.0, 1e5]))
def test_without_gaps_the_answer_scales_with_the_load(kinds, forces, factor):
    kinds = [(resists, 0.0, soft) for resists, _, soft in kinds]
    first = solved(tables(supports_of(kinds), loads_of(forces)))
    second = solved(tables(supports_of(kinds), loads_of(forces, force=factor)))
    assert (first is None) == (second is None)
    assume(first is not None)
    u = first.deflection
    assert np.abs(second.deflection / factor - u).max() <= 1e-8 * max(np.abs(u).max(), 1e-6)


@settings(max_examples=15)
@given(kinds=kinds, forces=forces, shift=st.sampled_from([0.01, -0.3, 5.0]))
def test_a_settlement_of_everything_moves_the_plate_by_it(kinds, forces, shift):
    first = solved(tables(supports_of(kinds), loads_of(forces)))
    second = solved(tables(supports_of(kinds, settlement=shift), loads_of(forces)))
    assert (first is None) == (second is None)
    assume(first is not None)
    accuracy = 1e-8 * max(np.abs(first.deflection).max(), abs(shift))
    assert np.abs(second.deflection - first.deflection - shift).max() <= accuracy


@given(first=spots, second=spots, edge=st.sampled_from(["clamped", "simple"]))
@settings(max_examples=15)
def test_deflections_are_reciprocal(first, second, edge):
    assume(first != second)
    supports = [{"edge": "left", "fix": "clamped"}, {"edge": "top", "fix": edge}, {"at": [3.1, 0.7], "stiffness": 40.0}]
    there = run(tables(supports, [{"force": 1.0, "at": list(first)}])).probe(second)[0].deflection
    back = run(tables(supports, [{"force": 1.0, "at": list(second)}])).probe(first)[0].deflection
    assert there == pytest.approx(back, rel=1e-10, abs=1e-12)


@settings(max_examples=10)
@given(forces=forces)
def test_loads_superpose_on_bilateral_supports(forces):
    model = tables([{"edge": ["left", "top"], "fix": "hard"}, {"at": [3.1, 0.7], "fix": "simple"}], loads_of(forces))
    model["load"] = [{**load, "case": f"c{i}"} for i, load in enumerate(model["load"])]
    cases = [load["case"] for load in model["load"]]
    model["combination"] = [
        {"name": "all", "factors": dict.fromkeys(cases, 1.5)},
        *({"name": case, "factors": {case: 1.5}} for case in cases),
    ]
    results = solve(Model(**model))
    parts = sum(results[case].deflection for case in cases)
    assert np.abs(results["all"].deflection - parts).max() <= 1e-9 * np.abs(parts).max()


@settings(max_examples=15)
@given(kinds=kinds, gap=st.sampled_from([1e-4, 1e-2]), forces=forces)
def test_wider_gaps_lower_the_least_energy(kinds, gap, forces):
    narrow = [(resists, g, False) for resists, g, _ in kinds]
    wide = [(resists, g + gap, False) for resists, g, _ in kinds]
    models = [Model(**tables(supports_of(k), loads_of(forces))) for k in (narrow, wide)]
    energies = []
    for model in models:
        problem = contact_problem(model)
        load = problem.discretisation.cases["load"]
        answer = problem.solve(load)
        assume(answer.status == "solved")
        u = answer.hi + answer.lo
        energies.append(0.5 * u @ (problem.K @ u) - load.nodal @ u)
    assert energies[1] <= energies[0] + 1e-9 * max(map(abs, energies))
