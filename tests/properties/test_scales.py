"""Scales far apart in one model: thickness over span, stiffness over stiffness; and the numbering, which has none."""

import meshio
import numpy as np
import pytest
from models import rectangular

from signorini import Model, solve
from signorini.mesh.meshers import annulus

BEARINGS = [[0.7, 0.6], [3.4, 0.5], [3.3, 3.2], [0.5, 3.5]]
CORNER = [0.1, 0.1]


def plate(thickness, supports, loads, young=1000.0, method="auto"):
    model = rectangular(
        material={"E": young, "nu": 0.3},
        thickness=thickness,
        divisions=[8, 8],
        support=supports,
        load=loads,
        solver={"method": method},
    )
    result = solve(model)["all"]
    assert result.certificate.passed
    return result


SUPPORTS = {
    "bearings": [{"at": [*BEARINGS, [2.0, 2.1]], "resists": "down"}],
    "wall and prop": [{"edge": "left", "fix": "clamped"}, {"at": [3.5, 2.2], "resists": "down"}],
    "walls that let go": [{"edge": ["left", "right", "bottom", "top"], "resists": "down"}],
}


@pytest.mark.parametrize("supports", SUPPORTS.values(), ids=SUPPORTS)
def test_thickness_over_span_from_a_hundred_thousandth_to_one(supports) -> None:
    """Under loads that grow with D, thin plates deflect alike and thick ones more, by shear; forces are the same."""
    ratios = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0]
    results = []
    for ratio in ratios:
        rigidity = (4 * ratio) ** 3
        loads = [
            {"pressure": 1e-3 * rigidity},
            {"force": 2e-3 * rigidity, "at": CORNER if len(supports) == 1 else [3, 3]},
        ]
        results.append(plate(4 * ratio, supports, loads))
    deflection = np.array([np.ptp(result.deflection) for result in results])
    assert np.abs(deflection[:3] / deflection[0] - 1).max() < 1e-3
    assert (np.diff(deflection[2:]) > 0).all() and deflection[-1] > 2 * deflection[0]
    total = np.array([sum(r.reactions.values()) / (4 * ratio) ** 3 for r, ratio in zip(results, ratios, strict=True)])
    assert total == pytest.approx(np.full(len(ratios), 0.018), rel=1e-6)


@pytest.mark.parametrize("ratio", [1e-12, 1e12])
def test_stiffnesses_that_differ_by_a_million_million(ratio) -> None:
    """A much stiffer support than the others is rigid, a much softer one has no effect."""
    loads = [{"pressure": 1.0}, {"force": 3.0, "at": CORNER}]
    bed = {"area": "all", "resists": "down", "stiffness": 20.0}
    far = {"at": [2.0, 2.1], "resists": "down"}
    both = plate(0.3, [bed, {**far, "stiffness": 20.0 * ratio}], loads)
    alone = plate(0.3, [bed, far] if ratio > 1 else [bed], loads)
    assert np.abs(both.deflection - alone.deflection).max() <= 1e-8 * np.abs(alone.deflection).max()
    assert both.supports[0].reaction == pytest.approx(alone.supports[0].reaction, rel=1e-8)


@pytest.mark.parametrize(
    ("method", "gap"),
    [("lemke", 1e3), ("lemke", 1e9), ("active_set", 1e3), ("active_set", 1e9)],
)
@pytest.mark.parametrize("supports", SUPPORTS.values(), ids=SUPPORTS)
def test_a_stop_out_of_reach_changes_nothing(supports, gap, method) -> None:
    """Its travel is 1e9 and 1e15 times the deflection: none of the tolerances may be relative to it."""
    loads = [{"pressure": 1e-6}, {"force": 2e-6, "at": [3, 3]}]
    stops = [{"at": [1.0, 1.2], "resists": way, "gap": gap} for way in ("down", "up")]
    alone = plate(0.3, supports, loads, method=method)
    beside = plate(0.3, [*supports, *stops], loads, method=method)
    assert np.abs(beside.deflection - alone.deflection).max() <= 1e-9 * np.abs(alone.deflection).max()
    assert (beside.method, beside.unsettled) == (method, ())


@pytest.mark.parametrize("seed", [1, 2])
def test_numbering_does_not_matter(tmp_path, seed) -> None:
    mesh = annulus((0.0, 0.0), 1.0, 3.0, (3, 8), 180)
    random = np.random.default_rng(seed)
    order = random.permutation(mesh.node_count)
    number = np.argsort(order)
    turned = np.array(
        [
            np.concatenate([np.roll(e[:4], k), np.roll(e[4:], k)])
            for e, k in zip(mesh.elements, random.integers(0, 4, len(mesh.elements)), strict=True)
        ]
    )
    elements = number[turned][random.permutation(len(turned))]
    results = []
    for name, points, cells in (("plain", mesh.points, mesh.elements), ("mixed", mesh.points[order], elements)):
        file = tmp_path / f"{name}.vtk"
        meshio.Mesh(np.column_stack([points, np.zeros(len(points))]), [("quad8", cells)]).write(file, binary=False)
        model = Model(
            material={"E": 1000.0, "nu": 0.3},
            plate={"shape": "mesh", "file": file, "thickness": 0.2},
            support=[
                {"at": [[1.5, 0.4], [-1.9, 0.7], [0.3, 2.4]], "resists": "down"},
                {"line": [[-2.5, 0.3], [-1.4, 0.9]], "resists": "down", "stiffness": 50.0},
                {"at": [2.5, 0.5], "resists": "up", "gap": 0.01},
            ],
            load=[{"pressure": 0.2}, {"force": 1.0, "at": [-1.2, 1.6]}],
        )
        results.append(solve(model)["all"])
    plain, mixed = results
    assert plain.certificate.passed and mixed.certificate.passed
    assert np.abs(mixed.deflection[number] - plain.deflection).max() <= 1e-9 * np.abs(plain.deflection).max()
    for a, b in zip(plain.supports, mixed.supports, strict=True):
        assert b.reactions.sum() == pytest.approx(a.reactions.sum(), rel=1e-9, abs=1e-9)
