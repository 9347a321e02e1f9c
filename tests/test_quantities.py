"""Numbers of results under all their names, and fields that follow from moments and shears."""

import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import meshio
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from models import rectangular

from signorini import Model, Result, Results, SignoriniError, estimate, path, solve, validate
from signorini.output import results_json
from signorini.results.quantities import derived, with_extremes

sys.path.insert(0, str(Path(__file__).parent / "fuzz"))
import random_models

THICKNESS = 0.2
BEARINGS = {"name": "bearings", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}
SOIL = {"name": "soil", "area": {"rectangle": [0, 0, 2, 2]}, "resists": "down", "stiffness": 1e7}
PLACES = {"at", "length", "width", "nodes", "contact_boundary", "max_pressure_at", "max_beside", "min_beside"}
PLACES |= {"max_at", "min_at", "line", "max_per_length_at", "min_per_length_at"}
PLACES |= {f"{side}_mean_{what}" for side in ("max", "min") for what in ("at", "width")}
"""Entries of results.json that are places, or whose length depends on the mesh."""


def model(*, soil: bool = True, **others: Any) -> Model:
    given: dict[str, Any] = {
        "thickness": THICKNESS,
        "support": [BEARINGS, {"name": "wall", "edge": "right", "fix": "simple"}, *([SOIL] if soil else [])],
        "load": [{"case": "G", "pressure": 5e3}, {"case": "Q", "force": 2e4, "at": [0.4, 3.7], "patch": [0.4, 0.4]}],
        "combination": [{"name": f"c{i}", "factors": {"G": 1, "Q": i / 2}} for i in range(4)],
        "probe": [{"at": [[2.1, 2.2], [0.4, 3.4]]}],
        "section": [{"name": "A", "line": [[1.5, 0], [1.5, 4]]}],
        "strip": [{"name": "s", "line": [[0, 1.7], [4, 1.7]], "width": 1.0, "stations": 3}],
    }
    return rectangular(**given | others)


@pytest.fixture(scope="module")
def results() -> Results:
    return solve(model())


@pytest.fixture(scope="module")
def one(results: Results) -> Result:
    return results["c2"]


def leaves(tree: Any, at: tuple[str | int, ...] = ()) -> Iterator[tuple[tuple[str | int, ...], float]]:
    """Yield the numbers of a tree with their keys and indices."""
    if isinstance(tree, dict | list):
        for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
            if key not in PLACES:
                yield from leaves(value, (*at, key))
    elif isinstance(tree, int | float):
        yield at, tree


def test_every_number_of_results_json_is_in_the_catalogue_and_back(results: Results, one: Result) -> None:
    written = results_json(results)["combinations"][2]
    told = {key: written[key] for key in ("deflection", "fields", "supports", "probes", "sections", "strips")}
    numbers = {number.path: value for number, value in zip(one.catalogue, one.numbers.tolist(), strict=True)}
    assert dict(leaves(told)) == {at: value for at, value in numbers.items() if not np.isnan(value)}
    for names in (one.catalogue.by_path, one.catalogue.by_name):
        assert len(names) == len(one.catalogue)
    assert len(one.catalogue.by_column) == len(one.catalogue.in_tables)


def test_a_number_has_one_value_by_its_keys_its_column_and_its_name(results: Results, one: Result) -> None:
    tabled = solve(model(output={"combinations": "table", "envelope": list(with_extremes(model()))})).table
    for number, value in zip(one.catalogue, one.numbers.tolist(), strict=True):
        if number.tabled and number.column in results.table:
            assert results.table[number.column][2] == pytest.approx(value, nan_ok=True), number.column
            assert tabled[number.column][2] == pytest.approx(value, rel=1e-8, abs=1e-9, nan_ok=True), number.column
    followed = path(model(), "G", "Q", at=[1.0, 2.0])
    stop = next(stop for stop in followed.stops if stop.t == 1.0)
    told = {number.name: value for number, value in zip(one.catalogue, one.numbers.tolist(), strict=True)}
    for name in stop.catalogue.by_name:
        assert stop.number(name) == pytest.approx(told[name], rel=1e-7, abs=1e-9, nan_ok=True), name


DESIGN = "mx_bottom", "my_bottom", "mx_top", "my_top"
FACES = tuple(f"{name}_{face}" for face in ("top", "bottom") for name in ("sx", "sy", "txy"))
STRESSES = *FACES, "von_mises", "von_mises_bottom"


def of_moments(moment: Any, *names: str) -> Any:
    """Return fields (..., f) of a plate of the thickness `THICKNESS` with moments (..., 3)."""
    return derived(names, moment, np.zeros((*moment.shape[:-1], 2)), np.array(THICKNESS))


moments = st.tuples(*[st.floats(-100, 100).map(lambda m: round(m, 3))] * 3).map(np.array)


@given(moments)
def test_bars_along_x_and_y_resist_the_moment_in_every_direction_and_no_less_would(moment: Any) -> None:
    """Wood (1968), Armer (1968): the least sum of both, at the bottom and, of the moments' opposites, at the top."""
    tensor, size = np.array([[moment[0], moment[2]], [moment[2], moment[1]]]), 1e-9 * (1 + np.abs(moment).max())
    x, y, *top = of_moments(moment, *DESIGN)
    assert np.negative(top) == pytest.approx(of_moments(moment * [-1, -1, 1], *DESIGN)[:2])
    spare = np.diag([x, y]) - tensor
    assert min(x, y) >= 0 and np.linalg.eigvalsh(spare).min() >= -size
    assert x == y == 0 or np.linalg.eigvalsh(spare).min() <= size
    if x > 0 and y > 0:
        assert x + y == pytest.approx(moment[0] + moment[1] + 2 * abs(moment[2]))


@given(moments)
def test_principal_moments_and_von_mises_are_those_of_the_tensor(moment: Any) -> None:
    tensor, size = np.array([[moment[0], moment[2]], [moment[2], moment[1]]]), 1e-9 * (1 + np.abs(moment).max())
    m1, m2, angle = of_moments(moment, "m1", "m2", "m_angle")
    axis = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    assert m1 >= m2 and tensor @ axis == pytest.approx(m1 * axis, abs=size)
    assert m1 + m2 == pytest.approx(moment[0] + moment[1], abs=size)
    *top, at_top, at_bottom = np.split(of_moments(moment, *STRESSES), [3, 6, 7])
    assert np.negative(top[0]) == pytest.approx(top[1]) and top[1] == pytest.approx(6 * moment / THICKNESS**2)
    mises = 6 / THICKNESS**2 * np.sqrt(m1**2 - m1 * m2 + m2**2)
    assert at_top == at_bottom == pytest.approx(mises, abs=1e3 * size)


def test_probes_and_fields_have_the_stresses_of_their_moments(one: Result) -> None:
    widths: Any = estimate(one).plus_minus
    by = 6 / THICKNESS**2
    for probe, width in zip(one.probes, widths["probes"], strict=True):
        moment, shear, stress = np.array(probe.moment), np.array(probe.shear), probe.stress
        assert stress["bottom"] == pytest.approx(by * moment)
        assert stress["top"] == pytest.approx(-by * moment)
        assert stress["shear"] == pytest.approx(1.5 / THICKNESS * shear)
        for face in ("bottom", "top"):
            of_moment = pytest.approx(by * np.array(width["moment"], float), rel=0.5, nan_ok=True)
            assert np.array(width["stress"][face], float) == of_moment
        wanted = 1.5 / THICKNESS * np.array(width["shear"], float)
        assert np.array(width["stress"]["shear"], float) == pytest.approx(wanted, rel=0.01, nan_ok=True)
    fields = one.fields
    assert np.allclose(fields["sx_top"], -by * one.moment[:, 0])
    assert np.allclose(fields["m1"], of_moments(one.moment, "m1")[:, 0])
    assert np.allclose(fields["my_top"], of_moments(one.moment, "my_top")[:, 0])
    assert np.allclose(fields["tyz"], 1.5 / THICKNESS * one.shear[:, 1])


def test_where_a_stiffness_stands_for_a_section_there_are_no_stresses() -> None:
    stiffness = {"Dx": 2e7, "Dy": 1e7, "D1": 2e6, "Dxy": 6e6, "Sx": 1e9, "Sy": 1e9}
    plate = {"shape": "rectangle", "size": [4, 4], "thickness": 0.2, "stiffness": stiffness}
    (found,) = results_json(
        solve(rectangular(plate=plate, support=[BEARINGS], load=[{"pressure": 1e3}], probe=[{"at": [2, 2]}]))
    )["combinations"]
    assert found["probes"][0]["stress"]["top"] == [None] * 3 and None not in found["probes"][0]["moment"]


@pytest.mark.parametrize("soil", [False, True])
def test_envelopes_of_fields_that_follow_are_the_largest_over_the_combinations(tmp_path: Path, soil: bool) -> None:
    asked = ["von_mises", "m1", "mx_bottom", "txz"]
    each, table = (
        solve(model(soil=soil, output=output))
        for output in ({"combinations": "each"}, {"combinations": "table", "envelope": asked})
    )
    for name in asked:
        every = np.array([result.fields[name] for result in each.values()])
        of, size = table.envelope.fields[name], 1e-8 * np.abs(every).max()
        assert of.largest == pytest.approx(every.max(axis=0), abs=size)
        assert of.smallest == pytest.approx(every.min(axis=0), abs=size)
        ends = [result.extremes[name] for result in each.values()]
        assert table.envelope.field(name).max == pytest.approx(max(one.max for one in ends), abs=size)
        assert table.key(table.envelope.field(name).max_by) == f"c{np.argmax([one.max for one in ends])}"


def test_a_vtu_file_has_every_field(one: Result, tmp_path: Path) -> None:
    one.to_vtk(tmp_path / "one.vtu")
    found = meshio.read(tmp_path / "one.vtu").point_data
    assert np.array_equal(found["von_mises"], one.stress_nodes.spread(one.fields["von_mises"]))
    for name, parts in (("stress_top", ("sx_top", "sy_top", "txy_top")), ("principal_moment", ("m1", "m2"))):
        for axis, part in enumerate(parts):
            assert np.array_equal(found[name][:, axis], one.stress_nodes.spread(one.fields[part]))


@pytest.mark.parametrize("seed", [8, 17, 27])
def test_results_are_the_same_in_whatever_order_they_are_read(seed: int) -> None:
    given = validate(random_models.model(Random(seed)))
    try:
        first, second = solve(given), solve(given)
    except SignoriniError as error:
        pytest.skip(str(error))

    def told(found: Results, widths: Any) -> str:
        written = results_json(found, widths)
        del written["seconds"]
        return json.dumps(written)

    widths, plain = estimate(first), told(second, None)
    result = next(iter(second.values()))
    before = result.warnings, result._repr_html_()
    _ = second.envelope, dict(second.table), result.fields["von_mises"], second.limits
    others = estimate(second)
    assert told(first, widths) == told(second, others) == told(second, estimate(second))
    assert told(first, None) == plain == told(second, None)
    assert (result.warnings, result._repr_html_()) == before


def test_a_probe_where_the_thickness_jumps_has_no_stress() -> None:
    """The moment of one side over the thickness of the other would be no stress of the plate."""
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [8, 6], "thickness": 0.2},
        mesh={"size": 0.5},
        zone=[{"area": {"rectangle": [3, 2, 5, 4]}, "thickness": 0.5}],
        support=[{"edge": ["left", "right", "bottom", "top"], "fix": "simple"}],
        load=[{"pressure": 1e4}],
    )
    on, beside = solve(model)["all"].probe([(4, 2), (4, 1.999)])
    assert np.isnan(on.stress["bottom"]).all() and np.isfinite(beside.stress["bottom"]).all()


def test_a_probe_on_a_wall_under_a_taper_has_stresses() -> None:
    """Moments jump there, the thickness does not."""
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [8, 6], "thickness": "0.2 + 0.1*y"},
        mesh={"divisions": [16, 12]},
        support=[{"edge": ["left", "right"], "fix": "simple"}, {"line": [[2, 3], [6, 3]]}],
        load=[{"pressure": 1e4}],
    )
    (probe,) = solve(model)["all"].probe([(3.7, 3)])
    # Solid plate: 6 m / h².
    assert probe.stress["bottom"][1] == pytest.approx(6 * probe.moment[1] / 0.5**2)


_CRACK_WIDTH = """DERIVED = (
    Derived(
        lambda moment, shear, thickness: np.abs(moment[..., :1]) / (3e9 * thickness[..., None]),
        (Quantity("crack_width", "deflection", "crack width", enveloped=False),),
    ),
"""
_SOLVED = """
import sys; sys.path.insert(0, sys.argv[1])
import json, signorini
from signorini.output import results_json
model = signorini.Model(
    material={"E": 30e9, "nu": 0.2}, plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    support=[{"edge": ["left", "right"], "fix": "simple"}], load=[{"pressure": 5e3}], probe=[{"at": [1, 2]}],
)
results = signorini.solve(model)
(one,) = results_json(results, signorini.estimate(results))["combinations"]
at = [of["probes"][0] for of in (one, one["plus_minus"])]
column = results.table["probe[1]:crack_width"].tolist()
print(json.dumps([*(of["crack_width"] for of in at), column, at[0]["moment"][0]]))
"""


def test_a_quantity_is_one_entry_with_one_formula(tmp_path: Path) -> None:
    """CONTRIBUTING.md, "Add a quantity": one product file changes, and results, half-widths and tables have it."""
    package = Path(sys.modules["signorini"].__path__[0])
    shutil.copytree(package, copy := tmp_path / "signorini", ignore=shutil.ignore_patterns("__pycache__"))
    registry = copy / "results" / "quantities.py"
    text = registry.read_text("utf-8")
    assert text.count("DERIVED = (\n") == 1
    registry.write_text(text.replace("DERIVED = (\n", _CRACK_WIDTH), "utf-8")
    command = [sys.executable, "-c", _SOLVED, str(tmp_path)]
    value, plus_minus, in_table, moment = json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)
    assert value == pytest.approx(moment / (3e9 * 0.2)) and in_table == [value]
    assert 0 < plus_minus < value
