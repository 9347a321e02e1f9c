"""Every file says which program, which version and which input it comes from; identical runs give identical files."""

import hashlib
import json
import re
from pathlib import Path

import pyarrow.parquet
import pytest
from models import tables
from PIL import Image
from typer.testing import CliRunner

import signorini
from signorini.cli.commands import app
from signorini.model import validate

LOADS = [{"case": "G", "pressure": 1e3}, {"case": "Q", "force": 1e4, "at": [2, 2]}]
FEET = [{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}]
PROFILE = [{"name": "middle", "line": [[0, 2], [4, 2]], "stations": 3}]


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place, mesh = tmp_path_factory.mktemp("input"), {"divisions": [2, 2], "error": False}
    asked = {"profile": PROFILE, "output": {"combinations": "table"}}
    model = signorini.Model(**tables(support=FEET, load=LOADS) | asked | {"mesh": mesh})
    (place / "Größe.toml").write_text("# a comment\n" + model.to_toml(), "utf-8")
    return place / "Größe.toml"


def _run(*arguments: str | Path) -> None:
    done = CliRunner().invoke(app, [str(one) for one in arguments])
    assert done.exit_code == 0, done.output


@pytest.fixture(scope="module")
def runs(file: Path) -> tuple[Path, Path]:
    places = file.with_name("one"), file.with_name("two")
    for place in places:
        _run("solve", file, "-o", place, "--pictures", "governing", "--threads", "1")
    return places


def test_every_file_of_a_solve_carries_program_version_and_input(file: Path, runs: tuple[Path, Path]) -> None:
    sha256 = hashlib.sha256(file.read_bytes()).hexdigest()
    told = json.loads((runs[0] / "results.json").read_text("utf-8"))
    assert told["program"]["name"] == "signorini" and told["program"]["version"] == signorini.__version__
    assert (told["input"]["file"], told["input"]["sha256"]) == (file.name, sha256)
    assert validate(told["input"]["model"]) == signorini.load(file)
    assert told["options"] == {"pictures": "governing", "xlsx": False}
    software, seen = f"signorini {signorini.__version__}", set()
    for one in runs[0].iterdir():
        seen.add(one.suffix)
        if one.suffix == ".png":
            text = Image.open(one).text
            assert (text["Software"], text["Input"], text["Input-SHA256"]) == (software, file.name, sha256)
        elif one.suffix == ".vtu":
            comment = re.search(r"<!-- (.*?) -->", one.read_text("latin-1")).group(1)
            assert software in comment and sha256 in comment
        elif one.suffix == ".parquet":
            metadata = pyarrow.parquet.read_schema(one).metadata
            assert (metadata[b"Software"].decode(), metadata[b"Input-SHA256"].decode()) == (software, sha256)
    assert {".png", ".vtu", ".parquet"} <= seen


def test_a_path_and_a_check_carry_them_too(file: Path, tmp_path: Path) -> None:
    _run("path", file, "--add", "Q", "--until", "2", "--steps", "2", "-o", tmp_path / "path")
    told = json.loads((tmp_path / "path" / "path.json").read_text("utf-8"))
    assert told["input"]["sha256"] == hashlib.sha256(file.read_bytes()).hexdigest()
    assert told["options"]["until"] == 2 and told["options"]["steps"] == 2
    for name in ("check.svg", "check.pdf", "check.png"):
        _run("check", file, "-o", tmp_path / name)
        assert b"signorini" in (tmp_path / name).read_bytes()
    for picture in (tmp_path / "path" / "path.png", tmp_path / "check.png"):
        assert Image.open(picture).text["Input-SHA256"] == told["input"]["sha256"]


def test_identical_runs_give_identical_files_but_for_times(runs: tuple[Path, Path]) -> None:
    names = sorted(one.name for one in runs[0].iterdir())
    assert names == sorted(one.name for one in runs[1].iterdir())
    for name in names:
        one, two = ((run / name).read_bytes() for run in runs)
        if name == "results.json":
            one, two = (json.dumps(json.loads(text) | {"seconds": {}}).encode() for text in (one, two))
        assert one == two, name


def test_a_changed_model_is_not_taken_for_its_file(file: Path) -> None:
    model = signorini.load(file)
    changed = model.model_copy(update={"load": model.load[:1]})
    assert (model.provenance.file, changed.provenance.file) == (file.name, None)
    assert changed.provenance.sha256 not in (
        model.provenance.sha256,
        signorini.Model(**tables(support=FEET, load=LOADS)).provenance.sha256,
    )


def test_what_the_program_changes_leaves_the_input_as_it_was() -> None:
    given = tables(support=FEET, load=LOADS) | {"mesh": {"divisions": [4, 4], "snap": 0.01, "error": False}}
    model = signorini.Model(**given)
    assert signorini.solve(model).model.provenance == model.provenance
