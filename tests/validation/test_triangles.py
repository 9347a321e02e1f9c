"""Plates of triangles, alone and beside quadrilaterals, against the references that quadrilaterals are held to."""

from pathlib import Path

import numpy as np
import pytest
from halving import halved
from tensionless import quarter_square

import signorini
from signorini import Model, contact_problem
from signorini.analysis.single import solve_one
from signorini.discretise import discretise
from signorini.validation import cases
from signorini.validation.runner import model_of, values_of

PARTS = pytest.mark.parametrize("part", [0.5, 1.0], ids=["mixed", "triangles"])


def solved(model, part):
    """The only combination of a model on its mesh with a part of the elements halved."""
    mesh = halved(discretise(model).mesh, part)
    (combination,) = model.effective_combinations
    result = solve_one(contact_problem(discretise(model, mesh)), combination)
    assert result.certificate.passed
    return result


@PARTS
@pytest.mark.parametrize(
    ("name", "n"),
    [
        ("strip-tensionless", 80),
        ("disc-tensionless-3", 16),
        ("ssnl130-bed-1", 8),
        ("footing-quarter", 8),
        ("base-plate", 24),
        ("slab-a", 20),
        ("square-one-sided-10", 20),
    ],
)
def test_a_validation_case_holds_with_triangles(name, n, part):
    """Within twice the tolerance, because the mesh is half as fine."""
    case = cases()[name]
    values = values_of(case, solved(model_of(case, n), part))
    errors = [number.error(value) for number, value in zip(case.numbers, values, strict=True)]
    assert all(error < 2 * number.tolerance for number, error in zip(case.numbers, errors, strict=True)), errors


@PARTS
@pytest.mark.parametrize(("thickness", "exact"), [(0.1, 0.00150463), (1e-4, 0.00126532)])
def test_the_clamped_square_does_not_lock(part, thickness, exact):
    def ratio(n):
        result = solved(quarter_square({"fix": "clamped"}, thickness, n), part)
        return result.deflection.max() * thickness**3 / 12 / (1 - 0.3**2) / exact

    assert [ratio(n) for n in (4, 8)] == pytest.approx([1.0, 1.0], abs=7e-3)
    assert ratio(8) == pytest.approx(1.0, abs=4e-4)


def test_the_equilateral_triangle_of_the_examples(tmp_path, monkeypatch):
    """Timoshenko and Woinowsky-Krieger 1959: hard edges, height a; at the centroid qa⁴/972D and (1 + ν)qa²/54."""
    monkeypatch.chdir(tmp_path)
    recipe = Path(__file__).parents[2].joinpath("examples/triangle_mesh.py").read_text("utf-8")
    errors = []
    for n in (8, 16):
        exec(recipe.replace("n, side = 8", f"n, side = {n}"), {})
        a, thickness = 3 * np.sqrt(3), 0.002
        model = Model(
            material={"E": 12 * 0.96 / thickness**3, "nu": 0.2},
            plate={"shape": "mesh", "file": "triangle.inp", "thickness": thickness},
            support=[{"name": "base", "edge": "base", "fix": "hard"}, {"edge": "boundary", "fix": "hard"}],
            load=[{"pressure": 1.0}],
        )
        result = signorini.solve(model)["all"]
        assert result.certificate.passed
        (probe,) = result.probe([[3.0, a / 3]])
        errors.append([probe.deflection * 972 / a**4 - 1, *(np.array(probe.moment[:2]) * 54 / 1.2 / a**2 - 1)])
    assert (np.abs(errors[1]) < [5e-4, 5e-3, 5e-3]).all()
    assert (np.abs(errors[0]) > 3 * np.abs(errors[1])).all()


@PARTS
def test_a_free_plate_takes_its_stress_free_curvature(part):
    k = (1e-3, 2e-3, 5e-4)
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [6, 4], "thickness": 0.3},
        mesh={"divisions": [6, 4]},
        support=[{"at": [[0, 0], [6, 0], [0, 4]], "fix": "simple"}],
        load=[{"curvature": list(k)}],
    )
    result = solved(model, part)
    x, y = result.mesh.points.T
    bent = 0.5 * k[0] * x**2 + 0.5 * k[1] * y**2 + k[2] * x * y
    plane = np.column_stack([np.ones(3), [0, 6, 0], [0, 0, 4]])
    at = np.array([0.0, 18 * k[0], 8 * k[1]])
    expected = bent - np.column_stack([np.ones_like(x), x, y]) @ np.linalg.solve(plane, at)
    assert result.deflection == pytest.approx(expected, abs=1e-12 * np.abs(bent).max())
    assert np.abs(result.moment).max() < 1e-7 * 30e9 * 0.3**3 / 12 * max(k)


@PARTS
@pytest.mark.parametrize("thickness", ["where(x + 0.4*y < 3.4, 0.3, 0.6)", "0.2 + 0.05*x"], ids=["askew step", "taper"])
def test_thickness_that_varies_in_triangles_is_as_in_quadrilaterals(part, thickness):
    model = Model(
        material={"E": 30e9, "nu": 0.2, "unit_weight": 25e3},
        plate={"shape": "rectangle", "size": [6, 4], "thickness": thickness},
        mesh={"divisions": [12, 8]},
        support=[{"name": "wall", "edge": ["left"], "fix": "clamped"}],
        load=[{"self_weight": True}],
    )
    whole, cut = solved(model, 0.0), solved(model, part)
    assert cut.deflection.max() == pytest.approx(whole.deflection.max(), rel=2e-3)
    assert cut.reactions["wall"] == pytest.approx(whole.reactions["wall"], rel=1e-9)
    middle = cut.probe([[1.1, 1.9]])[0].moment
    assert middle == pytest.approx(whole.probe([[1.1, 1.9]])[0].moment, abs=0.03 * max(map(abs, middle)))
