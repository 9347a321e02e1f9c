"""Pressure, extent and edge of contact of areas, from the field: against closed forms and against the reactions."""

import numpy as np
import pytest

import signorini
from signorini import Model
from signorini.results.contact_field.lines import thinned


def solved(**keys: object) -> signorini.Result:
    tables = {"material": {"E": 30e9, "nu": 0.2}, "load": [{"pressure": 2e3}]}
    result = signorini.solve(Model.model_validate(tables | keys))["all"]
    assert result.certificate.passed
    return result


def square(size: float, thickness: float = 0.3) -> dict[str, object]:
    return {"shape": "rectangle", "size": [size, size], "thickness": thickness}


@pytest.mark.parametrize(("radius", "contact"), [(3, 2.672175), (5, 2.773571)])
def test_the_edge_of_contact_of_a_free_disc_is_the_exact_circle(radius: float, contact: float) -> None:
    """Kelvin functions inside the contact circle, a free plate outside (thin, D = k = 1); elements are curved."""
    result = solved(
        material={"E": 12 * (1 - 0.09) / 0.01**3, "nu": 0.3},
        plate={"shape": "disc", "radius": radius, "thickness": 0.01},
        mesh={"divisions": [16, 64]},
        support=[{"area": "all", "resists": "down", "stiffness": 1}],
        load=[{"force": 1, "at": [0, 0]}],
    )
    (edge,) = result.supports[0].contact_boundary
    element = np.sqrt(result.mesh.element_area.mean())
    assert (edge[0] == edge[-1]).all() and len(edge) > 64
    assert np.abs(np.hypot(*edge.T) - contact).max() < 0.005 * element
    turning = np.diff(np.unwrap(np.arctan2(edge[:, 1], edge[:, 0])))
    assert turning.sum() == pytest.approx(2 * np.pi) and (turning > 0).all()
    assert np.abs(result.pressure(edge)).max() < 1e-5 * result.supports[0].max_pressure


def test_an_endless_plate_keeps_its_contact_radius_and_deflection_under_a_force() -> None:
    """Weitsman (1970): radius 2.848918 ℓ, w0 = 0.1311657 P/(kℓ²); a disc of 24 ℓ is within 3e-3 of it."""
    result = solved(
        material={"E": 12 * (1 - 0.09) / 0.01**3, "nu": 0.3},
        plate={"shape": "disc", "radius": 24, "thickness": 0.01},
        mesh={"divisions": [48, 48]},
        support=[{"area": "all", "resists": "down", "stiffness": 1}],
        load=[{"force": 1, "at": [0, 0]}],
    )
    (edge,) = result.supports[0].contact_boundary
    assert np.hypot(*edge.T) == pytest.approx(2.848918, rel=3e-3)
    assert result.probe([(0, 0)])[0].deflection == pytest.approx(0.1311657, rel=3e-3)


def test_the_edge_of_contact_ends_at_the_edges_of_the_plate() -> None:
    """Code_Aster SSNL130 on a continuous bed: contact over 1.5 m, which is a line of the mesh."""
    result = solved(
        material={"E": 2e11, "nu": 0},
        plate={"shape": "rectangle", "size": [1, 2], "thickness": 0.3},
        mesh={"divisions": [4, 8]},
        support=[{"area": "all", "resists": "down", "stiffness": 5e3}],
        load=[{"pressure": "5*(y-2)**2"}],
    )
    (edge,) = result.supports[0].contact_boundary
    assert edge[:, 1] == pytest.approx(1.5, abs=1e-6)
    assert edge[[0, -1], 0].tolist() == [1, 0]


def half_of_polygon(corners: np.ndarray, point: np.ndarray, along: np.ndarray) -> float:
    """Area of a convex polygon to the left of a line."""
    side = along[0] * (corners - point)[:, 1] - along[1] * (corners - point)[:, 0]
    kept = []
    for i in range(len(corners)):
        j = (i + 1) % len(corners)
        if side[i] >= 0:
            kept.append(corners[i])
        if side[i] * side[j] < 0:
            kept.append(corners[i] + (corners[j] - corners[i]) * side[i] / (side[i] - side[j]))
    x, y = np.array(kept).T
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))


TURNS = np.linspace(0, 2 * np.pi, 4001)[:-1]
AREAS = {
    "rectangle": ([0.13, 0.21, 1.83, 1.9], [[0.13, 0.21], [1.83, 0.21], [1.83, 1.9], [0.13, 1.9]]),
    "polygon": ([[0.2, 0.3], [1.9, 0.1], [1.7, 1.8], [0.4, 1.9]], [[0.2, 0.3], [1.9, 0.1], [1.7, 1.8], [0.4, 1.9]]),
    "circle": (
        {"center": [1, 1], "radius": 0.8},
        [[1 + 0.8 * np.cos(turn), 1 + 0.8 * np.sin(turn)] for turn in TURNS],
    ),
}


@pytest.mark.parametrize("shape", AREAS)
def test_under_a_rigid_footing_contact_is_a_half_of_the_support_although_its_outline_cuts_elements(shape: str) -> None:
    given, outline = AREAS[shape]
    result = solved(
        material={"E": 1e13, "nu": 0.2},
        plate=square(2, thickness=1),
        mesh={"divisions": [8, 8]},
        support=[{"area": {shape: given}, "resists": "down", "stiffness": 1e6}],
        load=[{"force": 1e3, "at": [1.4, 1.13]}],
    )
    soil = result.supports[0]
    (edge,) = soil.contact_boundary
    along = (edge[-1] - edge[0]) / np.hypot(*(edge[-1] - edge[0]))
    off = along[0] * (edge - edge[0])[:, 1] - along[1] * (edge - edge[0])[:, 0]
    assert np.abs(off).max() < 1e-3 * 0.25
    assert soil.contact_area == pytest.approx(half_of_polygon(np.array(outline), edge[0], along), rel=2e-6)
    ends = edge[[0, -1], None]
    sides = np.stack([outline, np.roll(outline, -1, axis=0)], axis=1)
    step = sides[:, 1] - sides[:, 0]
    part = np.clip(((ends - sides[:, 0]) * step).sum(axis=2) / (step**2).sum(axis=1), 0, 1)
    off = np.hypot(*np.moveaxis(ends - sides[:, 0] - part[..., None] * step, -1, 0)).min(axis=1)
    assert off.max() < 1e-3 * 0.25


def test_the_edge_of_contact_on_a_rigid_area_runs_between_closed_and_open_elements() -> None:
    result = solved(
        plate=square(10),
        mesh={"divisions": [12, 12]},
        support=[{"area": {"circle": {"center": [5, 5], "radius": 4.2}}, "resists": "down"}],
        load=[{"pressure": 2e3}, {"force": 2e5, "at": [4, 3]}],
    )
    bed = result.supports[0]
    assert bed.closed_count * bed.open_count > 0
    side = 10 / 12
    for edge in bed.contact_boundary:
        assert np.hypot(*(edge - 5).T).max() < 4.2 * (1 + 1e-3)
        middle, step = 0.5 * (edge[1:] + edge[:-1]), np.diff(edge, axis=0)
        inward = 0.1 * side * np.column_stack([-step[:, 1], step[:, 0]]) / np.hypot(*step.T)[:, None]
        assert np.abs(middle / side - np.round(middle / side)).min(axis=1).max() < 1e-9
        within, beyond = result.pressure(middle + inward), result.pressure(middle - inward)
        assert (np.isnan(within) | (within > 0)).all() and (np.isnan(beyond) | (beyond == 0)).all()
    assert any((edge[0] == edge[-1]).all() for edge in bed.contact_boundary)
    mean = result.pressure(bed.positions)
    assert np.abs(mean * bed.weights - bed.reactions).max() < 1e-12 * bed.reactions.max()
    assert bed.max_pressure == pytest.approx(mean.max(), rel=1e-12)


def test_pressure_is_the_soil_law_and_soil_that_holds_both_ways_pulls() -> None:
    patch = {"rectangle": [0, 0, 6, 10]}
    keys = {"plate": square(10), "mesh": {"divisions": [10, 10]}, "load": [{"force": 4e5, "at": [1, 1]}]}
    down, both, up = (
        solved(
            **keys,
            support=[
                {"name": "soil", "area": patch, "resists": resists, "stiffness": "2e6*(1+x)", "settlement": 1e-3},
                {"at": [[0.5, 0.5], [9, 9], [0.5, 9], [9, 0.5]], "resists": "both", "stiffness": 3e6},
            ],
        )
        for resists in ("down", "both", "up")
    )
    places = np.array([[0.3, 0.2], [3.3, 4.1], [5.9, 9.8], [6.1, 5]])
    for result, low, high in ((down, 0, np.inf), (both, -np.inf, np.inf), (up, -np.inf, 0)):
        deflection = np.array([probe.deflection for probe in result.probe(places.tolist())])
        law = np.clip(2e6 * (1 + places[:, 0]) * (deflection - 1e-3), low, high)
        found = result.pressure(places)
        assert found[:3] == pytest.approx(law[:3], rel=1e-9)
        assert np.isnan(found[3])
        assert [probe.pressure for probe in result.probe(places.tolist())] == [*found[:3].tolist(), None]
    assert both.pressure(places)[:3].min() < 0 < both.pressure(places)[:3].max()
    assert down.supports[0].max_pressure > 0 == up.supports[0].max_pressure
    assert both.supports[0].contact_boundary == ()
    assert both.supports[0].contact_area == pytest.approx(60, rel=1e-12)


def test_pressures_of_areas_one_over_the_other_add_up() -> None:
    half = {"rectangle": [0, 0, 5, 10]}
    soils = [{"area": "all", "resists": "down", "stiffness": 1e6}, {"area": half, "resists": "both", "stiffness": 1e6}]
    result = solved(plate=square(10), mesh={"divisions": [4, 4]}, support=soils)
    left, right = (probe.deflection for probe in result.probe([(2, 5), (8, 5)]))
    assert result.pressure([(2, 5), (8, 5)]) == pytest.approx([2e6 * left, 1e6 * right], rel=1e-9)


def test_numbers_of_an_area_need_have_values_only_on_it() -> None:
    result = solved(
        plate=square(10),
        mesh={"divisions": [7, 5]},
        support=[
            {
                "area": {"rectangle": [2.1, 0, 10, 10]},
                "resists": "down",
                "stiffness": "1e6*sqrt(x-2.1)+1e5",
                "gap": "1e-4*sqrt(x-2.1)",
            },
            {"edge": "left", "fix": "simple"},
        ],
        load=[{"pressure": 1e3}, {"force": -3e4, "at": [9, 3]}],
    )
    soil = result.supports[0]
    assert soil.contact_area is not None and 0.2 * 79 < soil.contact_area < 79
    edges = soil.contact_boundary
    assert len(edges) and all(edge[:, 0].min() >= 2.1 - 1e-6 for edge in edges)
    gap = 1e-4 * np.sqrt(edges[0][:, 0] - 2.1)
    deflection = [probe.deflection for probe in result.probe(edges[0].tolist())]
    assert np.abs(deflection - gap).max() < 1e-3 * np.abs(result.deflection).max()


def test_where_the_plate_is_held_on_soil_it_touches_without_an_edge_of_contact() -> None:
    result = solved(
        plate=square(10, thickness=0.05),
        support=[
            {"edge": ["left", "right", "top"], "fix": "clamped"},
            {"area": "all", "resists": "down", "stiffness": 3e7},
        ],
    )
    assert result.supports[1].contact_boundary == ()
    assert result.supports[1].contact_area == pytest.approx(100, rel=1e-9)


def test_where_the_plate_only_touches_there_is_no_contact() -> None:
    """Pressed down and held at its edges: a support that only holds down touches it there."""
    edges = {"edge": ["left", "right", "top", "bottom"], "fix": "clamped"}
    anchors = {"area": "all", "resists": "up", "stiffness": 1e6}
    result = solved(plate=square(4), mesh={"divisions": [4, 4]}, support=[edges, anchors])
    assert (result.supports[1].contact_area, result.supports[1].contact_boundary) == (0.0, ())


def test_a_thinned_line_keeps_its_corners_and_stays_within_its_tolerance() -> None:
    turn = np.linspace(0, np.pi / 2, 200)
    line = np.vstack(
        [np.column_stack([np.cos(turn), np.sin(turn)]), np.column_stack([np.zeros(50), np.linspace(1, 0)])]
    )
    thin = thinned(line, 1e-3)
    assert len(thin) < 40
    assert (thin[[0, -1]] == line[[0, -1]]).all() and (np.abs(thin - [0, 1]).sum(axis=1) < 1e-6).any()
    middle = 0.5 * (thin[1:] + thin[:-1])
    curved = middle[:, 0] > 1e-3
    assert np.abs(np.hypot(*middle[curved].T) - 1).max() < 3e-3
