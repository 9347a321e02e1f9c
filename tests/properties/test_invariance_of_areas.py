"""Invariance of answers on one-sided areas under units, load factor, orientation and a common gap."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from signorini import Model, solve

GRID = [(x, y) for x in (0.0, 1.3, 2.9, 4.0) for y in (0.0, 0.9, 2.2, 4.0)]
PAD, PATCH = [[0.2, 0.3], [3.6, 0.5], [3.1, 3.7], [0.4, 2.9]], [[1, 1], [2.5, 1], [2, 2.4]]
# Whole elements: elements that an outline cuts are cut again in an order that depends on the axes.
WHOLE_PAD = [[0.8, 0.0], [4.0, 0.0], [4.0, 3.2], [0.8, 3.2]]
WHOLE_PATCH = [[0.8, 0.8], [2.4, 0.8], [2.4, 2.4], [0.8, 2.4]]
TURNS = {
    "mirrored": (lambda x, y: (4.0 - x, y), (0.0, 0.0)),
    "transposed": (lambda x, y: (y, x), (0.0, 0.0)),
    "turned": (lambda x, y: (-y, x), (-4.0, 0.0)),
    "moved": (lambda x, y: (x + 30.0, y - 50.0), (30.0, -50.0)),
}
# Within the pad's kern and outside of it, so that it lifts off in part.
places = st.tuples(st.integers(10, 28), st.integers(10, 26)).map(lambda at: (at[0] / 10, at[1] / 10))
beds = st.sampled_from([300.0, 3.0, None])


def raft(bed, at, turn=lambda x, y: (x, y), origin=(0.0, 0.0), length=1.0, force=1.0, gap=0.0, load=1.0, whole=False):
    outline = [[length * c for c in turn(*corner)] for corner in (WHOLE_PAD if whole else PAD)]
    soil = {"name": "soil", "area": {"polygon": outline}, "resists": "down", "gap": gap}
    if bed is not None:
        soil["stiffness"] = bed * force / length**3
    anchor = {"at": [length * c for c in turn(3.9, 3.8)], "resists": "up", "stiffness": 2.0 * force / length}
    patch = [[length * c for c in turn(*corner)] for corner in (WHOLE_PATCH if whole else PATCH)]
    model = Model(
        material={"E": 1000.0 * force / length**2, "nu": 0.3},
        plate={
            "shape": "rectangle",
            "size": [4.0 * length, 4.0 * length],
            "origin": [length * c for c in origin],
            "thickness": 0.3 * length,
        },
        mesh={"divisions": [5, 5]},
        support=[soil, {**anchor, "gap": gap}] if gap == 0 else [soil],
        load=[
            {"pressure": 0.3 * force / length**2 * load, "area": {"polygon": patch}},
            {"force": 2.0 * force * load, "at": [length * c for c in turn(*at)]},
        ],
    )
    result = solve(model)["all"]
    assert result.certificate.passed
    return result


def at_points(result, points):
    return np.array([probe.deflection for probe in result.probe(points)])


def assert_alike(first, second, points, length=1.0, force=1.0, accuracy=1e-8, extent=1e-5):
    """Deflections at points, reactions, contact area and largest pressure of two results, in each other's units."""
    u, v = at_points(first, GRID), at_points(second, points) / length
    assert np.abs(u - v).max() <= accuracy * np.abs(u).max()
    a, b = first.supports[0], second.supports[0]
    assert b.reaction / force == pytest.approx(a.reaction, rel=accuracy)
    assert b.contact_area / length**2 == pytest.approx(a.contact_area, rel=extent)
    assert b.max_pressure / force * length**2 == pytest.approx(a.max_pressure, rel=1e2 * accuracy)


@pytest.mark.parametrize("way", TURNS)
@settings(max_examples=6)
@given(bed=beds, at=places)
def test_orientation_and_place_do_not_matter(way, bed, at):
    turn, origin = TURNS[way]
    first, second = raft(bed, at, whole=True), raft(bed, at, turn, origin, whole=True)
    # The fine cells in which the edge of contact is drawn are halved one way, which its length shows.
    points, accuracy = [turn(*point) for point in GRID], 1e-7 if way == "moved" else 1e-8
    assert_alike(first, second, points, accuracy=accuracy, extent=3e-3)


@settings(max_examples=12)
@given(bed=beds, at=places, length=st.sampled_from([1e-3, 1e3, 0.3048]), force=st.sampled_from([1e-6, 1e3, 1e9]))
def test_units_do_not_matter(bed, at, length, force):
    scaled = raft(bed, at, length=length, force=force)
    assert_alike(raft(bed, at), scaled, length * np.array(GRID), length, force)


@settings(max_examples=12)
@given(bed=beds, at=places, load=st.sampled_from([1e-6, 0.5, 3.0, 1e5]))
def test_the_extent_of_contact_does_not_depend_on_the_size_of_the_load(bed, at, load):
    first, second = raft(bed, at), raft(bed, at, load=load)
    assert np.abs(second.deflection / load - first.deflection).max() <= 1e-8 * np.abs(first.deflection).max()
    a, b = first.supports[0], second.supports[0]
    assert b.contact_area == pytest.approx(a.contact_area, rel=1e-5)
    assert (b.closed == a.closed).all() and b.reaction / load == pytest.approx(a.reaction, rel=1e-8)


@settings(max_examples=12)
@given(bed=beds, at=places, gap=st.sampled_from([1e-3, 0.02, 1.0]))
def test_a_gap_everywhere_lowers_the_plate_by_it(bed, at, gap):
    first, second = raft(bed, at, gap=1e-9), raft(bed, at, gap=gap)
    lowered = second.deflection - first.deflection
    assert np.abs(lowered - (gap - 1e-9)).max() <= 1e-8 * max(np.abs(first.deflection).max(), gap)
    assert second.supports[0].contact_area == pytest.approx(first.supports[0].contact_area, rel=1e-4)


@pytest.mark.parametrize("radius", [0.05, 0.15, 0.3])
@pytest.mark.parametrize("way", [{"resists": "both"}, {"resists": "down"}, {"resists": "down", "stiffness": 1e13}])
def test_rigid_pads_within_an_element_hold_both_slopes_alike(radius: float, way: dict[str, object]) -> None:
    places = [[x, y] for x in (1.5, 8.5) for y in (1.5, 8.5)]
    tables = {
        "material": {"E": 3e10, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [10, 10], "thickness": 0.2},
        "mesh": {"divisions": [10, 10]},
        "support": [{"area": {"circle": {"center": place, "radius": radius}}, **way} for place in places],
        "load": [{"pressure": 1e4}],
        "probe": [{"at": at} for at in ([0, 5], [10, 5], [5, 0], [5, 10])],
    }
    deflection = [probe.deflection for probe in solve(Model.model_validate(tables))["all"].probes]
    assert deflection == pytest.approx([deflection[0]] * 4, rel=1e-9)
