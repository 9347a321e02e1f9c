import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import jsonschema
import pytest
from command import run

import signorini
from signorini.contact.certificate import Certificate

SLAB = """
title = "Slab [bold]on[/bold] pads"
units = { length = "m", force = "kN" }
material = { E = 30e6, nu = 0.2 }
plate = { shape = "rectangle", size = [4, 4], thickness = 0.2 }
mesh = { divisions = [4, 4] }

[[support]]
name = "pads"
at = [[1, 1], [3, 1], [3, 3], [1, 3]]
resists = "down"

[[load]]
case = "G"
pressure = 5

[[load]]
case = "Q"
force = 80
at = [0.2, 1.0]

[[load]]
case = "W"
pressure = -8

[[combination]]
name = "calm"
factors = { G = 1, Q = 1 }
"""
STORM = """
[[combination]]
name = "storm"
factors = { G = 1, W = 1 }
"""
KINDS = """
[[support]]
name = "anchor"
at = [3.5, 3.5]
resists = "up"

[[support]]
name = "prop"
at = [2, 2]
stiffness = 100

[[support]]
name = "wall"
edge = "left"
fix = "simple"
"""


@pytest.fixture
def slab(tmp_path: Path) -> Path:
    path = tmp_path / "slab.toml"
    path.write_text(SLAB)
    return path


def test_names_with_dollars_are_drawn_as_they_are(slab: Path) -> None:
    named = slab.read_text().replace("Slab", "$x_{$").replace('"pads"', '"$p_{$"').replace('"m"', '"$m_{$"')
    slab.write_text(named.replace('"calm"', '"$c_{$"'))
    for command in (["solve"], ["check"], ["path", "--add", "G"]):
        assert run(command[0], slab, *command[1:]).exit_code == 0, command


OF_CALM = ("calm-deformed.png", "calm-moments.png", "calm-shears.png", "calm.png", "calm.vtu")


def test_solve_writes_beside_the_input_and_prints_a_table(slab: Path) -> None:
    done = run("solve", slab)
    assert (done.exit_code, done.stderr) == (0, "")
    names = [*OF_CALM, "reactions.csv", "results.json"]
    assert sorted(path.name for path in slab.with_name("slab-results").iterdir()) == names
    lines = done.stdout.splitlines()
    assert lines[0] == "Slab [bold]on[/bold] pads"
    (row,) = (line.split() for line in lines if line.startswith("▲  "))
    assert row == ["▲", "pads", "points,", "pushes", "up", "only,", "rigid", "160", "±", "0", "3", "1"]
    assert "reaction [kN]" in done.stdout
    points = [line.split() for line in lines if line.startswith("pads[")]
    assert [(row[0], row[1] + row[2], row[-1]) for row in points] == [
        *(("pads[1]", "[1,1]", "closed"), ("pads[2]", "[3,1]", "open")),
        *(("pads[3]", "[3,3]", "closed"), ("pads[4]", "[1,3]", "closed")),
    ]
    assert sum(float(row[3]) for row in points) == pytest.approx(160, rel=1e-2)
    assert any(line.startswith("certificate passed: penetration") for line in lines)
    assert any(line.startswith("deflection, positive down: max ") for line in lines)
    assert f"Written to {slab.with_name('slab-results')}/" in lines


def test_the_table_shows_what_kind_each_support_is(slab: Path) -> None:
    slab.write_text(SLAB + KINDS)
    for command in ("solve", "check"):
        lines = run(command, slab).stdout.splitlines()
        symbols = {line.split()[1]: line.split()[0] for line in lines if line.startswith(("▲  ", "▼  ", "◆", "▬"))}
        assert symbols == {"pads": "▲", "anchor": "▼", "prop": "◆~", "wall": "▬"}
        assert "▲ pushes up only  ▼ holds down only  ◆ holds both ways  ▬ fixed  ~ elastic  without ~: rigid" in lines


def test_one_combination_without_equilibrium_is_named_and_the_others_are_written_where_told(slab: Path) -> None:
    slab.write_text(SLAB + STORM)
    out = slab.parent / "a" / "b"
    done = run("solve", slab, "-o", out)
    assert done.exit_code == 3
    assert "storm: no equilibrium" in done.stdout
    assert done.stderr.startswith(
        "No equilibrium.\nstorm: The plate lifts off its supports: the load's resultant is 48 kN"
    )
    assert sorted(path.name for path in out.iterdir()) == [
        *OF_CALM,
        *("governing.csv", "reactions.csv", "results.json"),
    ]
    assert json.loads((out / "results.json").read_text())["combinations"][0]["status"] == "solved"
    assert not slab.with_name("slab-results").exists()


def test_results_name_the_reason_where_no_combination_has_equilibrium(slab: Path) -> None:
    slab.write_text(SLAB.replace('"calm"\nfactors = { G = 1, Q = 1 }', '"storm"\nfactors = { W = 1 }'))
    done = run("solve", slab)
    assert done.exit_code == 3 and done.stderr.startswith("No equilibrium.\nstorm: ")
    (storm,) = json.loads((slab.with_name("slab-results") / "results.json").read_text("utf-8"))["combinations"]
    assert storm["status"] == "no_equilibrium" and storm["message"] in done.stderr


def test_what_is_not_certified_is_refused_and_not_written(slab: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    refused = Certificate(penetration=1e-3, tension=0.0, complementarity=0.0, equilibrium=0.0, balance=0.0)
    monkeypatch.setattr("signorini.contact.strategy.certified", lambda found, load, answer, beside: (answer, refused))
    done = run("solve", slab)
    assert (done.exit_code, done.stdout) == (4, "")
    assert 'Combination "calm" is refused' in done.stderr
    assert [path.name for path in slab.parent.iterdir()] == ["slab.toml"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("thickness", "thicknes", "plate.thicknes: unknown key 'thicknes'. Did you mean 'thickness'?"),
        ("at = [0.2, 1.0]", "at = [5, 0]", "slab.toml:20: load[2].at: The point [5, 0] is not on the plate"),
        ("Q = 1", "R = 1", "Unknown case 'R'. This model has: G, Q, W."),
        ("units = {", "units = {{", "slab.toml:3: invalid TOML"),
    ],
)
def test_bad_input_is_said_in_place(slab: Path, old: str, new: str, message: str) -> None:
    slab.write_text(SLAB.replace(old, new))
    for command in ("solve", "check"):
        done = run(command, slab)
        assert (done.exit_code, done.stdout) == (2, "")
        assert done.stderr.startswith("Error: ") and message in done.stderr
        assert [path.name for path in slab.parent.iterdir()] == ["slab.toml"]


@pytest.mark.parametrize(
    "arguments", [[], ["solve"], ["sovle", "x"], ["solve", "--fast", "x"], ["solve", "no.toml"], ["solve", "."]]
)
def test_wrong_usage_ends_with_2_and_a_message(arguments: list[str]) -> None:
    done = run(*arguments)
    assert (done.exit_code, done.stdout) == (2, "")
    assert "Traceback" not in done.stderr and len(done.stderr) > 20


def test_a_directory_that_cannot_be_is_refused_before_solving(slab: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("signorini.analysis.solve.solve_all", None)
    done = run("solve", slab, "-o", slab)
    assert done.exit_code == 2
    assert (
        done.stderr == f"Error: {slab}: the results cannot be written there: Not a directory. Name another directory.\n"
    )


def test_check_draws_and_says_where_the_load_acts(slab: Path) -> None:
    done = run("check", slab)
    assert (done.exit_code, done.stderr) == (0, "")
    assert slab.with_name("slab-check.png").read_bytes().startswith(b"\x89PNG")
    # 80 kN at (2, 2) and 80 kN at (0.2, 1)
    (row,) = (line for line in done.stdout.splitlines() if line.startswith("calm"))
    assert row.split() == ["calm", "160", "[1.1,", "1.5]", "yes", "1.25", "×", "factored", "Q"]
    assert not slab.with_name("slab-results").exists()
    assert run("check", slab, "-o", slab.with_name("plan.pdf")).exit_code == 0
    assert slab.with_name("plan.pdf").read_bytes().startswith(b"%PDF")


def test_check_replaces_its_own_picture_and_no_file_of_others(slab: Path) -> None:
    picture = slab.with_name("slab-check.png")
    assert [run("check", slab).exit_code for _ in range(2)] == [0, 0]
    picture.write_bytes(b"\x89PNG a photograph")
    done = run("check", slab)
    assert done.exit_code == 2
    assert done.stderr == (
        f"Error: {picture}: this file exists, and signorini did not draw it. Move it, or name another file with -o.\n"
    )
    assert picture.read_bytes() == b"\x89PNG a photograph"
    assert run("check", slab, "-o", picture).exit_code == 0
    assert picture.stat().st_size > 1000


@pytest.fixture
def reading(tmp_path: Path) -> Path:
    """A directory of input files that read a table, a mesh from earlier results, and a picture, each from a file."""
    (tmp_path / "bed.csv").write_text("x,y,value\n0,0,1e7\n4,0,1e7\n4,3,1e7\n0,3,1e7\n")
    (tmp_path / "logo.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'/>")
    plate = 'shape = "rectangle", size = [4, 3]'
    text = """\
        report = {{ logo = "logo.svg" }}
        material = {{ E = 30e9, nu = 0.2 }}
        plate = {{ {plate}, thickness = 0.2 }}
        mesh = {{ {mesh}error = false }}
        support = [{{ name = "bed", area = "all", resists = "down", stiffness = {{ file = "bed.csv" }} }}]
        load = [{{ pressure = 5e3 }}]
    """
    (tmp_path / "bed.toml").write_text(text.format(plate=plate, mesh="divisions = [4, 3], "))
    assert run("solve", tmp_path / "bed.toml", "-o", tmp_path / "out", "--pictures", "none").exit_code == 0
    (tmp_path / "again.toml").write_text(text.format(plate='shape = "mesh", file = "out/all.vtu"', mesh=""))
    (tmp_path / "alias.toml").symlink_to(tmp_path / "bed.toml")
    (tmp_path / "bed.html").symlink_to(tmp_path / "bed.csv")
    (tmp_path / "bed.xlsx").hardlink_to(tmp_path / "bed.toml")
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        (["report", "bed.toml", "-o", "bed.toml"], "bed.toml"),
        (["report", "bed.toml", "-o", "out/../bed.toml", "--no-error"], "bed.toml"),
        (["report", "bed.toml", "-o", "alias.toml"], "alias.toml"),
        (["report", "bed.toml", "-o", "bed.csv"], "bed.csv"),
        (["report", "bed.toml", "-o", "logo.svg"], "logo.svg"),
        (["report", "bed.toml"], "bed.html"),
        (["report", "bed.toml", "-o", "bed.htm", "--xlsx"], "bed.xlsx"),
        (["check", "bed.toml", "-o", "logo.svg"], "logo.svg"),
        (["solve", "again.toml", "-o", "out"], "all.vtu"),
    ],
)
def test_no_command_replaces_a_file_that_it_reads(
    reading: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], found: str
) -> None:
    monkeypatch.chdir(reading)
    monkeypatch.setattr("signorini.analysis.solve.solve_all", None)
    monkeypatch.setattr("signorini.analysis.check.check", None)
    before = {file: file.read_bytes() for file in reading.rglob("*") if file.is_file()}
    done = run(*arguments)
    assert done.exit_code == 2, done.output
    assert f"this run reads {found}. Name another " in done.stderr
    assert {file: file.read_bytes() for file in reading.rglob("*") if file.is_file()} == before


def test_no_function_replaces_a_file_that_its_model_was_read_from(reading: Path) -> None:
    before = {file: file.read_bytes() for file in reading.rglob("*") if file.is_file()}
    results = signorini.solve(signorini.load(reading / "again.toml"))
    for write in (
        lambda: signorini.report(results, reading / "again.toml"),
        lambda: signorini.write(results, reading / "out"),
        lambda: results["all"].to_vtk(reading / "out" / "all.vtu"),
    ):
        with pytest.raises((signorini.InputError, OSError), match="this run reads"):
            write()
    assert {file: file.read_bytes() for file in reading.rglob("*") if file.is_file()} == before


def test_a_path_shows_where_the_plate_lifts_more_than_it_sinks(slab: Path) -> None:
    slab.write_text(SLAB + '[[load]]\ncase = "pull"\nforce = -12\nat = [0.1, 0.1]\n')
    done = run("path", slab, "--add", "pull", "--from", "G", "--until", "1")
    found = json.loads((slab.with_name("slab-path") / "path.json").read_text())
    last = found["stops"][-1]["deflection"]
    assert done.exit_code == 0 and -last["min"] > last["max"] > 0
    assert f"{last['min']:.6g}" in done.stdout


def test_check_finds_the_combination_without_equilibrium(slab: Path) -> None:
    slab.write_text(SLAB + STORM)
    picture = slab.with_name("plan.svg")
    done = run("check", slab, "-o", picture)
    assert done.exit_code == 3
    assert done.stderr.startswith("No equilibrium.\nstorm: The plate lifts off")
    assert picture.read_text().startswith("<?xml")


def test_check_refuses_a_picture_of_no_known_format(slab: Path) -> None:
    done = run("check", slab, "-o", "plan.foo")
    assert done.exit_code == 2
    assert 'found the suffix ".foo"; a picture ends in .png, .svg, .pdf.' in done.stderr


def test_schema_accepts_the_examples() -> None:
    done = run("schema")
    assert done.exit_code == 0
    schema = json.loads(done.stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    assert schema == signorini.schema()
    for path in (Path(__file__).parents[1] / "examples").glob("*.toml"):
        jsonschema.validate(tomllib.loads(path.read_text("utf-8")), schema)


def test_closed_streams_change_no_exit_code_of_solve_and_make_schema_end_with_1(slab: Path) -> None:
    command = f"exec {sys.executable} -m signorini"
    solved = subprocess.run(["sh", "-c", f"{command} solve {slab} --pictures none >&- 2>&-"])
    assert solved.returncode == 0
    assert (slab.with_name(f"{slab.stem}-results") / "results.json").exists()
    schema = subprocess.run(["sh", "-c", f"{command} schema >&-"], stderr=subprocess.PIPE, text=True)
    assert schema.returncode == 1 and schema.stderr.startswith("Error: ") and "Traceback" not in schema.stderr


def test_version() -> None:
    done = run("--version")
    assert (done.exit_code, done.stdout) == (0, f"signorini {signorini.__version__}\n")


class PanicException(BaseException):
    """As pyo3 raises it."""


@pytest.mark.parametrize("kind", [ZeroDivisionError, PanicException])
def test_a_fault_of_the_program_is_one_line(
    slab: Path, monkeypatch: pytest.MonkeyPatch, kind: type[BaseException]
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise kind("by\nzero")

    monkeypatch.setattr("signorini.analysis.solve.solve_all", fail)
    done = run("solve", slab)
    assert done.exit_code == 1
    assert done.stderr.startswith(f"Internal error ({kind.__name__}: by zero).")
    assert done.stderr.count("\n") == 1 and "please report" in done.stderr


def process(*arguments: str | Path, **options: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "signorini", *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)  # type: ignore[call-overload,no-any-return]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.parametrize(("combination", "code"), [("", 0), (STORM, 3)])
def test_what_nobody_reads_changes_no_exit_code(slab: Path, combination: str, code: int) -> None:
    """Neither does a full disk that standard output or standard error is sent to: results are in files."""
    slab.write_text(SLAB + combination)
    command = [sys.executable, "-m", "signorini", "solve", str(slab), "--pictures", "none"]
    for shown, said in (("/dev/full", "/dev/null"), ("/dev/null", "/dev/full")):
        with open(shown, "w") as stdout, open(said, "w") as stderr:
            assert subprocess.run(command, stdout=stdout, stderr=stderr).returncode == code
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "w") as nobody:
        done = subprocess.run(command, stdout=nobody, stderr=subprocess.PIPE, text=True)
    assert done.returncode == code and "Errno" not in done.stderr and "Traceback" not in done.stderr


ANSWERS = [
    ["--version"],
    ["--help"],
    ["solve", "--help"],
    ["schema"],
    ["explain", "support.gap"],
    ["explain", "gap", "--json"],
]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.parametrize("arguments", ANSWERS, ids=" ".join)
def test_an_answer_that_is_in_no_file_and_goes_nowhere_is_an_error(arguments: list[str]) -> None:
    command = [sys.executable, "-m", "signorini", *arguments]
    with open("/dev/full", "w") as full:
        lost = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
    closed = subprocess.run(["sh", "-c", '"$@" >&-', "sh", *command], stderr=subprocess.PIPE, text=True)
    for done, why in ((lost, "No space left on device"), (closed, "Bad file descriptor")):
        assert done.returncode == 1
        assert done.stderr == f"Error: the text cannot be written to standard output: {why}.\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.parametrize("arguments", [[], ["nonsense"], ["solve"], ["explain", "nonsense"]], ids=" ".join)
def test_the_exit_code_tells_an_error_whose_message_is_lost(arguments: list[str]) -> None:
    with open("/dev/full", "w") as full:
        assert subprocess.run([sys.executable, "-m", "signorini", *arguments], stderr=full).returncode == 2


def test_a_terminal_without_the_symbols_gets_plain_ones(slab: Path) -> None:
    running = process("solve", slab, env={**os.environ, "PYTHONIOENCODING": "ascii"})
    out, errors = running.communicate(timeout=60)
    assert (running.returncode, errors) == (0, "")
    assert any(line.startswith("^ ") and "pads" in line for line in out.splitlines())


def test_a_row_stays_on_one_line_when_the_output_is_a_file(slab: Path) -> None:
    slab.write_text(SLAB.replace('"pads"', f'"{"long " * 12}name"'))
    running = process("solve", slab, env={**os.environ, "COLUMNS": "40"})
    out, _ = running.communicate(timeout=60)
    assert any("long name" in line and "160" in line for line in out.splitlines())


def test_supports_that_contradict_each_other_are_told_from_a_load_they_cannot_hold(slab: Path) -> None:
    # On a side of an element the deflection is a parabola, which cannot zigzag through four points.
    floor = '[[support]]\nat = [[2, 2], [2.6666666666666667, 2]]\nresists = "down"\n'
    ceiling = '[[support]]\nat = [[2.3333333333333333, 2], [3, 2]]\nresists = "up"\nsettlement = 0.01\n'
    slab.write_text(SLAB + floor + ceiling)
    done = run("solve", slab)
    assert done.exit_code == 3
    assert "calm: The rigid supports contradict each other" in done.stderr


ESCAPE = "\x1b[31m\x07\x9b2J\u202e"


@pytest.mark.parametrize(
    "text",
    [
        f'title = "{ESCAPE}"',
        f"title = {ESCAPE}",
        'title = "a\\u001b[31mb"\n' + SLAB.partition("\n")[2].partition("\n")[2],
        SLAB.replace("thickness = 0.2", 'thickness = "1\\u001b"'),
        SLAB.replace("pressure = 5", 'pressure = "\\u001b\\u202e"'),
        SLAB.replace("{ G = 1, Q = 1 }", '{ "\\u001bG" = 1 }'),
        SLAB + '["\\u001bG"]\n',
        SLAB,
    ],
)
def test_neither_an_input_nor_its_name_commands_the_terminal(tmp_path: Path, text: str) -> None:
    path = tmp_path / f"slab{ESCAPE}.toml"
    path.write_text(text, "utf-8")
    for command in ("solve", "check"):
        for file in (path, tmp_path / f"none{ESCAPE}.toml"):
            done = run(command, file)
            assert done.exit_code == (0 if (text, file) == (SLAB, path) else 2)
            assert all(sign.isprintable() or sign == "\n" for sign in done.output), repr(done.output)
