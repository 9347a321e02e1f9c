"""Pressures where areas meet, and values of areas at nodes."""

from __future__ import annotations

import json
from pathlib import Path

import meshio
import numpy as np
import pytest
from matplotlib.image import imread

import signorini
from signorini.errors import InputError
from signorini.output import write
from signorini.output.envelope_json import envelope_json
from signorini.plot.files import save


def plate(divisions: int, support: list[dict], **keys: object) -> signorini.Model:
    return signorini.Model(
        **{
            "material": {"E": 30e6, "nu": 0.2},
            "plate": {"shape": "rectangle", "size": [4, 4], "thickness": 0.3},
            "mesh": {"divisions": [divisions, divisions]},
            "support": support,
            "load": [{"pressure": 100.0}],
        }
        | keys
    )


LEFT, RIGHT = {"rectangle": [0, 0, 2, 4]}, {"rectangle": [2, 0, 4, 4]}
MIDDLE = np.array([[2.0, 0.5], [2.0, 2.0], [2.0, 4.0], [1.0, 2.0], [4.0, 0.0]])


@pytest.mark.parametrize("divisions", [4, 5])
@pytest.mark.parametrize("law", [{"stiffness": 1e4}, {}])
def test_areas_that_touch_press_once_on_their_border(divisions: int, law: dict, tmp_path: Path) -> None:
    soils = [{"area": area, "resists": "down", **law} for area in (LEFT, RIGHT)]
    result = signorini.solve(plate(divisions, soils))["all"]
    assert result.pressure(MIDDLE) == pytest.approx(100, rel=1e-6)
    assert [probe.pressure for probe in result.probe(MIDDLE)] == pytest.approx([100] * 5, rel=1e-6)
    result.to_vtk(tmp_path / "a.vtu")
    found = meshio.read(tmp_path / "a.vtu")
    pressure = found.point_data["contact_pressure"] if law else found.cell_data["rigid_contact_pressure"][0]
    assert pressure == pytest.approx(np.full(len(pressure), 100), rel=1e-6)


def test_areas_that_overlap_add_on_their_border_too(tmp_path: Path) -> None:
    soils = [{"area": "all", "resists": "down", "stiffness": 1e4}, *({"area": RIGHT, "stiffness": 1e4},) * 2]
    result = signorini.solve(plate(5, soils))["all"]
    result.to_vtk(tmp_path / "a.vtu")
    pressure, x = meshio.read(tmp_path / "a.vtu").point_data["contact_pressure"], result.mesh.points[:, 0]
    assert (np.abs(x - 2) < 1e-9).any()
    times = np.where(x > 2 - 1e-9, 3, 1)
    assert pressure == pytest.approx(1e4 * times * result.deflection, rel=1e-9)


def test_nodal_reactions_are_of_points_lines_and_edges_only(tmp_path: Path) -> None:
    soil = {"area": "all", "resists": "down", "stiffness": 1e4}
    wall = {"name": "wall", "edge": "left", "resists": "both"}
    alone, both = (signorini.solve(plate(4, support))["all"] for support in ([soil], [soil, wall]))
    assert not alone.nodal_reaction.any()
    assert both.nodal_reaction.sum() == pytest.approx(both.reactions["wall"], rel=1e-9)
    alone.to_vtk(tmp_path / "a.vtu")
    both.to_vtk(tmp_path / "b.vtu")
    assert ["reaction" in meshio.read(tmp_path / name).point_data for name in ("a.vtu", "b.vtu")] == [False, True]


@pytest.mark.parametrize(
    ("divisions", "law"), [(12, {"stiffness": "2e3*(1+x)"}), (2, {}), (12, {}), (2, {"stiffness": 1e9})]
)
def test_pressures_of_a_table_are_those_of_its_combinations(divisions: int, law: dict, tmp_path: Path) -> None:
    loads = [{"case": "g", "pressure": 10.0}, {"case": "q", "force": 300, "at": [1, 1]}]
    factors = [(1, 0), (1, 1), (1, -0.1), (0.5, 3)]
    model = plate(
        divisions,
        [{"area": {"rectangle": [0, 0, 3.3, 4]}, "resists": "down", **law}, {"at": [[4, 0], [4, 4]]}],
        load=loads,
        mesh={"divisions": [divisions, divisions], "error": False},
        combination=[{"name": f"c{i}", "factors": {"g": g, "q": q}} for i, (g, q) in enumerate(factors)],
        output={"combinations": "table", "fields": "all"},
    )
    results = signorini.solve(model)
    (largest,) = [one["largest"] for one in envelope_json(results)["supports"] if "largest" in one]
    every = {name: result.supports[0].max_pressure for name, result in results.items()}
    assert largest["max"] == pytest.approx(max(every.values()), rel=1e-9)
    assert every[largest["max_by"]] == pytest.approx(largest["max"], rel=1e-9)
    written = write(results, tmp_path / "out", pictures="none")
    assert len(written) and json.loads((tmp_path / "out" / "results.json").read_text())["envelope"]["fields"]
    envelope = meshio.read(tmp_path / "out" / "envelope.vtu")
    singles = [meshio.read(tmp_path / "out" / f"c{i}.vtu") for i in range(len(factors))]
    name = "contact_pressure" if law else "rigid_contact_pressure"
    of = (lambda mesh, key: mesh.point_data[key]) if law else (lambda mesh, key: mesh.cell_data[key][0])
    values = np.array([of(mesh, name) for mesh in singles])
    scale = values.max()
    assert of(envelope, f"{name}_max") == pytest.approx(values.max(axis=0), abs=1e-9 * scale)
    assert of(envelope, f"{name}_min") == pytest.approx(values.min(axis=0), abs=1e-9 * scale)
    assert "reaction_max" in envelope.point_data
    assert envelope.point_data["reaction_max"].max() > 0


def test_a_run_s_pictures_have_one_scale_and_python_draws_the_same(tmp_path: Path) -> None:
    soil = {"area": "all", "resists": "down", "stiffness": 1e4}
    states = [{"name": name, "factors": {"load": factor}} for name, factor in (("whole", 1.0), ("half", 0.5))]
    model = plate(4, [soil], load=[{"pressure": "10*x"}], combination=states)
    # The command's titles have half-widths, which Python's plot does not wait for.
    results = signorini.solve(model.model_copy(update={"mesh": model.mesh.model_copy(update={"error": False})}))
    write(results, tmp_path)
    limits = (results["half"].deflection.min(), results["whole"].deflection.max())
    axes = results["half"].plot(limits=limits)
    save(axes.figure, tmp_path / "mine.png")
    theirs, mine = (imread(tmp_path / name)[..., :3] for name in ("half.png", "mine.png"))
    assert theirs.shape == mine.shape and (np.abs(theirs - mine).max(axis=2) > 0.3).mean() < 1e-3


def test_there_is_no_pressure_to_draw_without_an_area() -> None:
    result = signorini.solve(plate(2, [{"edge": "left", "fix": "clamped"}]))["all"]
    with pytest.raises(InputError, match="the plate rests on no area"):
        result.plot("pressure")
