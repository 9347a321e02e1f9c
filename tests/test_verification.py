"""`signorini verify`: a changed value is found by its path; files of every kind of model are solved again."""

import base64
import copy
import hashlib
import json
import math
import random
import shutil
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from models import tables
from typer.testing import CliRunner

import signorini
from signorini import InputError, Model, solve, verify, write
from signorini.cli.commands import app

ROOT = Path(__file__).parents[1]
SUPPORTS = [
    {"name": "feet", "at": [[1, 1], [3, 1]], "resists": "down", "gap": 1e-5},
    {"name": "soil", "area": {"rectangle": [0, 2, 4, 4]}, "resists": "down", "stiffness": 1e7},
    {"name": "wall", "edge": "left", "fix": "simple"},
]
LOADS = [{"case": "G", "pressure": 5e3}, {"case": "Q", "force": 4e4, "at": [4, 0]}]
COMBINED = [{"name": f"c{n}", "group": f"g{n % 2}", "factors": {"G": 1, "Q": 0.3 * n}} for n in range(3)]
ASKED = {
    "probe": [{"at": [2, 2]}],
    "section": [{"name": "cut", "line": [[2, 0], [2, 4]]}],
    "strip": [{"name": "strip", "line": [[0, 2], [4, 2]], "width": 1, "stations": 3}],
    "profile": [{"name": "line", "line": [[0, 2], [4, 2]], "stations": 3}],
}
Key = tuple[str | int, ...]


def everything(**others: Any) -> Model:
    return Model(**tables(support=SUPPORTS, load=LOADS, combination=COMBINED) | ASKED | others)


def run(*arguments: str | Path) -> Any:
    return CliRunner().invoke(app, [str(one) for one in arguments])


def numbers(node: Any, path: Key = ()) -> Iterator[tuple[Key, float]]:
    if isinstance(node, dict | list):
        for key, value in node.items() if isinstance(node, dict) else enumerate(node):
            yield from numbers(value, (*path, key))
    elif isinstance(node, int | float) and not isinstance(node, bool):
        yield path, node


def changed(tree: Any, path: Key, value: object) -> None:
    for key in path[:-1]:
        tree = tree[key]
    tree[path[-1]] = value


@pytest.fixture(scope="module", params=["each", "table"])
def stored(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    place = tmp_path_factory.mktemp("written")
    write(solve(everything(output={"combinations": request.param})), place, pictures="none")
    return json.loads((place / "results.json").read_text("utf-8"))


def verified(stored: dict[str, Any], place: Path) -> signorini.Verification:
    (place / "results.json").write_text(json.dumps(stored), "utf-8")
    return verify(place / "results.json")


def test_what_was_written_is_computed_again_to_the_last_bit(stored: dict[str, Any], tmp_path: Path) -> None:
    found = verified(stored, tmp_path)
    assert found.equal and found.differences == found.rounding == ()
    assert found.compared > len([path for path, _ in numbers(stored) if path[0] not in ("seconds", "input")])
    assert {"seconds", "program", "input.sha256"} <= set(found.not_compared)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("by", [lambda value: 1.5 * value + 1, lambda value: math.nextafter(value, math.inf)])
def test_every_changed_number_is_found_by_its_path(
    stored: dict[str, Any], tmp_path: Path, seed: int, by: Callable[[float], float]
) -> None:
    """Changes beyond the tolerance are differences; changes of the last bit are named as rounding."""
    places = [(path, value) for path, value in numbers(stored) if path[0] not in ("seconds", "input", "options")]
    assert {"plus_minus", "certificate", "reaction", "max_with"} <= {key for path, _ in places for key in path}
    picked = random.Random(seed).sample(places, 40)
    tampered = copy.deepcopy(stored)
    for path, value in picked:
        changed(tampered, path, by(value))
    found = verified(tampered, tmp_path)
    large = by(1.0) > 2
    assert {one.path for one in (found.differences if large else (*found.rounding, *found.differences))} == {
        path for path, _ in picked
    }
    # A number that is 0 or a count has no rounding.
    exact = {path for path, value in picked if value == 0}
    assert large or {one.path for one in found.differences} <= exact
    assert found.equal == (not found.differences)
    for one in found.differences if large else ():
        assert one.stored == by(one.computed) and one.difference == pytest.approx(one.stored - one.computed)


CHECKED = {
    "units": {"length": "m", "force": "N"},
    "punching": [
        {
            "support": "feet",
            "column": [0.3, 0.3],
            "code": "EN 1992-1-1:2004",
            **{"d": [0.15, 0.15], "rho": [0.005, 0.005], "fck": 30e6, "fyk": 500e6},
        }
    ],
    "check": [
        {"name": "stress", "of": "von_mises", "limit": 20e6},
        {"name": "=soil", "of": "soil.max_pressure", "limit": 2e5},
    ],
}


def test_checks_and_punching_are_compared(tmp_path: Path) -> None:
    write(solve(everything(**CHECKED)), tmp_path, pictures="none")
    stored = json.loads((tmp_path / "results.json").read_text("utf-8"))
    assert verified(stored, tmp_path).equal
    places = [(path, value) for path, value in numbers(stored) if {"checks", "punching"} & set(path)]
    picked = random.Random(1).sample([(path, value) for path, value in places if path[0] != "input"], 30)
    for path, value in picked:
        changed(stored, path, 1.5 * value + 1)
    assert {one.path for one in verified(stored, tmp_path).differences} == {path for path, _ in picked}


def test_missing_and_additional_keys_texts_and_states_are_found(stored: dict[str, Any], tmp_path: Path) -> None:
    tampered = copy.deepcopy(stored)
    del tampered["governing_reactions"][0]["max"]
    tampered["combinations"].pop()
    tampered["extra"] = {"a": 1}
    tampered["combinations"][0]["supports"][0]["points"][0]["state"] = "yields"
    tampered["units"]["force"] = "kN"
    found = {one.place: one for one in verified(tampered, tmp_path).differences}
    last = len(stored["combinations"]) - 1
    assert {place: one.what for place, one in found.items()} == {
        "governing_reactions[0].max": "missing",
        f"combinations[{last}]": "missing",
        "extra": "additional",
        "combinations[0].supports[0].points[0].state": "value",
        "units.force": "value",
    }
    assert found["units.force"].difference is None and found["units.force"].computed == ""


def test_a_changed_model_differs_by_its_hash_and_by_its_results(stored: dict[str, Any], tmp_path: Path) -> None:
    tampered = copy.deepcopy(stored)
    tampered["input"]["model"]["plate"]["thickness"] = 0.25
    found = verified(tampered, tmp_path).differences
    assert found[0].place == "input.model_sha256" and len(found) > 50


def test_the_command_lists_the_differences_and_ends_with_its_exit_code(stored: dict[str, Any], tmp_path: Path) -> None:
    file = tmp_path / "results.json"
    file.write_text(json.dumps(stored), "utf-8")
    equal = run("verify", file)
    assert equal.exit_code == 0 and "0 different" in equal.output
    tampered = copy.deepcopy(stored)
    tampered["combinations"][0]["supports"][0]["reaction"] = 12345.5
    tampered["program"]["version"] = "0.0.1"
    file.write_text(json.dumps(tampered), "utf-8")
    differs = run("verify", file, "--threads", "1")
    assert differs.exit_code == 1 and "0.0.1" in differs.output
    assert "combinations[0].supports[0].reaction" in differs.output and "12345.5" in differs.output


@pytest.mark.parametrize(
    "content",
    [
        "",
        "{",
        "[1]",
        "{}",
        '{"input": {}}',
        '{"input": {"model": {"plate": 1}}}',
        "<html></html>",
        "[" * 100_000,
        "\xff",
    ],
)
def test_other_files_are_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "file").write_bytes(content.encode("latin-1"))
    for file in (tmp_path / "file", tmp_path / "none.json", tmp_path):
        assert run("verify", file).exit_code == 2
        with pytest.raises(InputError, match=str(tmp_path)):
            verify(file)


def test_a_report_is_verified_by_the_json_that_it_embeds(stored: dict[str, Any], tmp_path: Path) -> None:
    """The content of comments and of other scripts is not taken for it."""
    stored = copy.deepcopy(stored)
    stored["combinations"][0]["deflection"]["max"] += 1.0
    text = base64.b64encode(zlib.compress(json.dumps(stored).encode())).decode()
    script = '<script type="application/octet-stream" id="signorini-results">'
    page = f"<!doctype html><!-- {script}{{}}</script> --><title>&lt;script&gt;</title>{script}\n{text}\n</script>"
    (tmp_path / "slab.html").write_text(page, "utf-8")
    assert [one.place for one in verify(tmp_path / "slab.html").differences] == ["combinations[0].deflection.max"]
    (tmp_path / "slab.html").write_text(page + f"{script}{{}}</script>", "utf-8")
    with pytest.raises(InputError):
        verify(tmp_path / "slab.html")


@pytest.mark.parametrize("error", [[], ["--no-error"]])
def test_files_of_the_command_are_verified_after_their_inputs_are_gone(tmp_path: Path, error: list[str]) -> None:
    """Mesh files and CSV files are embedded."""
    inputs = tmp_path / "inputs"
    inputs.mkdir()
    shutil.copy(ROOT / "examples" / "circular_cover_21.msh", inputs)
    text = (ROOT / "examples" / "circular_cover_21.toml").read_text("utf-8")
    (inputs / "mesh.toml").write_text(text, "utf-8")
    (inputs / "k.csv").write_text("x,y,value\n0,0,1e7\n4,0,2e7\n0,4,1e7\n4,4,3e7\n", "utf-8")
    (inputs / "c.csv").write_text("name,G\n=1+1,1\n-2,2\n", "utf-8")
    (inputs / "csv.toml").write_text(
        """
material = { E = 30e9, nu = 0.2 }
plate = { shape = "rectangle", size = [4, 4], thickness = 0.2 }
mesh = { divisions = [4, 4] }
support = [{ name = "soil", area = "all", resists = "down", stiffness = { file = "k.csv" } }]
load = [{ case = "G", pressure = 5e3 }]
combination = [{ generate = "table", file = "c.csv" }]
""",
        "utf-8",
    )
    for name in ("mesh", "csv"):
        done = run("solve", inputs / f"{name}.toml", "-o", tmp_path / name, "--pictures", "none", *error)
        assert done.exit_code == 0, done.output
    stored = json.loads((tmp_path / "csv" / "results.json").read_text("utf-8"))
    for one in stored["input"]["files"]:
        assert one["sha256"] == hashlib.sha256(Path(one["file"]).read_bytes()).hexdigest()
    shutil.rmtree(inputs)
    for name in ("mesh", "csv"):
        assert verify(tmp_path / name / "results.json").rounding == ()
        assert verify(tmp_path / name / "results.json").equal
    stored["input"]["files"][0]["gzip"] = stored["input"]["files"][1]["gzip"]
    with pytest.raises(InputError, match="SHA-256"):
        verified(stored, tmp_path)
    stored["input"]["files"][0]["gzip"] = None
    with pytest.raises(InputError, match=r"is not embedded"):
        verified(stored, tmp_path)


def test_a_file_that_is_not_embedded_is_found_beside_the_results(tmp_path: Path) -> None:
    mesh = shutil.copy(ROOT / "examples" / "circular_cover_21.msh", tmp_path / "plate.msh")
    model = signorini.load(ROOT / "examples" / "circular_cover_21.toml")
    plate = model.plate.model_copy(update={"file": Path(mesh)})
    write(solve(model.model_copy(update={"plate": plate})), tmp_path / "results", pictures="none")
    stored = json.loads((tmp_path / "results" / "results.json").read_text("utf-8"))
    stored["input"]["files"][0]["gzip"] = None
    stored["input"]["model"]["plate"]["file"] = stored["input"]["files"][0]["file"] = "elsewhere/plate.msh"
    found = verified(stored, tmp_path / "results")
    assert [one.place for one in found.differences] == ["input.model_sha256"]
    (tmp_path / "plate.msh").write_text("another mesh", "utf-8")
    with pytest.raises(InputError, match=r"Put plate.msh with the SHA-256"):
        verified(stored, tmp_path / "results")


def test_a_python_function_is_refused(tmp_path: Path) -> None:
    def bedding(x: Any, y: Any) -> Any:
        return 1e7 + 0 * x

    soil = [{"name": "soil", "area": "all", "resists": "down", "stiffness": bedding}]
    write(solve(Model(**tables(support=soil, load=LOADS))), tmp_path, pictures="none")
    with pytest.raises(InputError, match=r"function .*bedding"):
        verify(tmp_path / "results.json")


def test_results_that_python_writes_singly_are_verified(tmp_path: Path) -> None:
    """A result of one combination, one at some t of a path, and one with half-widths that were asked for."""
    model = everything(mesh={"divisions": [4, 4], "error": False})
    result, path = solve(model)["c2"], signorini.path(model, "G", "Q", until=1.0, steps=4)
    for name, of, estimate in (
        ("one", result, None),
        ("at", path.at(0.5), None),
        ("estimated", result, signorini.estimate(result)),
        ("path", path, None),
        ("estimated path", path, signorini.estimate(path)),
    ):
        file = write(of, tmp_path / name, estimate, pictures="none")[0]
        found = verify(file)
        assert found.equal, (name, found.differences[:5])


@pytest.mark.parametrize("arguments", [["--steps", "5"], ["--at", "0.5,1"], ["--events", "all"]])
def test_a_path_is_verified_with_its_options(tmp_path: Path, arguments: list[str]) -> None:
    (tmp_path / "slab.toml").write_text(everything().to_toml(), "utf-8")
    asked = ["--from", "G", "--add", "Q", "--until", "1", "--when", "soil.reaction = 2e4", *arguments]
    done = run("path", tmp_path / "slab.toml", "-o", tmp_path / "path", *asked)
    assert done.exit_code == 0, done.output
    file = tmp_path / "path" / "path.json"
    assert run("verify", file).exit_code == 0
    stored = json.loads(file.read_text("utf-8"))
    stored["stops"][1]["supports"][0]["reaction"] += 10.0
    file.write_text(json.dumps(stored), "utf-8")
    assert [one.place for one in verify(file).differences] == ["stops[1].supports[0].reaction"]
    stored["interrupted"] = True
    file.write_text(json.dumps(stored), "utf-8")
    with pytest.raises(InputError, match="interrupted"):
        verify(file)
