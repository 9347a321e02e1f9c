"""Profiles: the promises of the documents."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest

from signorini import InputError, Model, solve, write


def plate(**changes):
    parts = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [4, 3], "thickness": 0.2},
        "mesh": {"divisions": [8, 6]},
        "support": [
            {"area": {"rectangle": [0, 0, 2, 3]}, "resists": "down", "stiffness": 1e7},
            {"edge": "right", "fix": "simple"},
        ],
        "load": [{"pressure": 5e3}],
        "profile": [
            {"name": "along", "line": [[0, 1], [4, 1]], "stations": 9},
            {"circle": {"center": [2, 1.5], "radius": 1}},
        ],
    }
    return Model(**{**parts, **changes})


def test_a_profile_is_probes_at_its_stations():
    at = [[float(x), 1.0] for x in np.linspace(0, 4, 9)]
    result = solve(plate(probe=[{"at": at}]))["all"]
    along = result.profiles["along"]
    np.testing.assert_allclose(along.at, at)
    np.testing.assert_allclose(along.distance, np.linspace(0, 4, 9))
    for name, values in {
        "deflection": [probe.deflection for probe in result.probes],
        "my": [probe.moment[1] for probe in result.probes],
        "qx": [probe.shear[0] for probe in result.probes],
        "pressure": [np.nan if probe.pressure is None else probe.pressure for probe in result.probes],
    }.items():
        np.testing.assert_array_equal(along.values[name], values)


def test_a_circle_begins_on_the_x_axis_and_ends_where_it_began():
    ring = solve(plate())["all"].profiles["profile 2"]
    np.testing.assert_allclose(ring.at[[0, 25, -1]], [[3, 1.5], [2, 2.5], [3, 1.5]], atol=1e-12)
    assert ring.distance[-1] == pytest.approx(2 * np.pi)


def test_stations_off_the_plate_have_no_values(tmp_path):
    model = plate(
        mesh={"size": 0.5},
        plate={
            "shape": "rectangle",
            "size": [4, 3],
            "thickness": 0.2,
            "holes": [{"rectangle": [2.25, 0.5, 2.75, 1.5]}],
        },
    )
    results = solve(model)
    mx = results["all"].profiles["along"].values["mx"]
    assert np.flatnonzero(np.isnan(mx)).tolist() == [5]
    assert "profile-along.png" in [file.name for file in write(results, tmp_path)]
    told = json.loads((tmp_path / "results.json").read_text())
    assert told["combinations"][0]["profiles"][0]["stations"][5]["mx"] is None
    assert {"profiles", "profile table"} <= {entry["kind"] for entry in told["files"]}
    rows = list(csv.DictReader((tmp_path / "profiles.csv").read_text().splitlines()))
    assert len(rows) == 9 + 101 and rows[5]["mx"] == "" and float(rows[4]["mx"]) == mx[4]
    write(solve(plate(profile=[])), tmp_path)
    assert not [file for file in tmp_path.iterdir() if "profile" in file.name]


@pytest.mark.parametrize(
    ("profile", "message"),
    [
        ({}, r"profile\[1\]: give exactly one of line and circle"),
        ({"line": [[0, 0], [1, 1]], "circle": {"radius": 1}}, r"profile\[1\]: give exactly one of line and circle"),
        ({"line": [[0, 5], [4, 5]]}, r"profile\[1\]: No station of the profile is on the plate"),
    ],
)
def test_what_is_wrong_with_a_profile_is_told_with_its_place(profile, message):
    with pytest.raises(InputError, match=message):
        solve(plate(profile=[profile]))
