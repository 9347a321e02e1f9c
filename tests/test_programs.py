"""A program's way in: schema of results.json, explanations of keys, exit codes, the example of docs/programs.md."""

import json
import re
import runpy
import subprocess
import sys
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import strict_schema
from command import run
from slab_on_pads import SLAB

import signorini
from signorini.cli import interrupts
from signorini.output import results_json
from signorini.output.load_path import path_json
from signorini.results.quantities import BY_LIST, FIELDS

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "programs.md").read_text("utf-8")
EXAMPLES = sorted((ROOT / "examples").glob("*.toml"))
STORM = SLAB.replace("combination = [", 'combination = [{ name = "storm", factors = { G = -1 } }, ')
"""The slab with a combination without equilibrium."""
SCHEMA = signorini.results_schema()
CHECKS = """
[[check]]
name = "w"
of = "deflection"
limit = 0.01
[[check]]
name = "m"
of = "mx"
limit = 100
[[check]]
name = "pad"
of = "pads[1].reaction"
limit = 50
[[section]]
name = "cut"
line = [[2, 0], [2, 4]]
[[strip]]
name = "strip"
line = [[0, 2], [4, 2]]
width = 1
"""
TWO = """
material = { E = 30e6, nu = 0.2 }
plates.upper = { shape = "rectangle", size = [2, 2], thickness = 0.2, mesh = { divisions = [4, 4] } }
plates.lower = { shape = "rectangle", size = [2, 2], thickness = 0.3, mesh = { divisions = [4, 4] } }
support = [{ name = "soil", plate = "lower", area = "all", resists = "down", stiffness = 1e4 }]
contact = [{ name = "joint", between = ["upper", "lower"], area = "all", stiffness = 1e6 }]
load = [{ case = "G", plate = "upper", pressure = 5 }, { case = "Q", plate = "upper", force = 10, at = [1.9, 1.9] }]
combination = [{ name = "service", factors = { G = 1, Q = 1 } }]
"""


@pytest.mark.parametrize(("option", "file"), [("--results", "results.json"), ("--path", "path.json")])
def test_the_schema_of_results_is_draft_2020_12_and_printed_by_the_command(option: str, file: Any) -> None:
    schema = signorini.results_schema(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    done = run("schema", option)
    assert done.exit_code == 0 and json.loads(done.stdout) == schema


@pytest.mark.parametrize("text", [SLAB, SLAB + CHECKS, TWO], ids=["slab", "checks", "two plates"])
@pytest.mark.parametrize("events", ["named", "all"])
def test_a_path_has_the_keys_of_the_schema_and_no_others(text: str, events: Any) -> None:
    steps: Any = {"steps": 3} if events == "named" else {}
    followed = signorini.path(signorini.loads(text), "G", "Q", until=3, events=events, **steps)
    strict_schema.PATH.validate(path_json(followed, signorini.estimate(followed) if events == "named" else None))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_results_of_an_example_have_the_keys_of_the_schema_and_no_others(path: Path) -> None:
    results = signorini.solve(signorini.load(path))
    strict_schema.RESULTS.validate(
        results_json(results, signorini.estimate(results) if results.model.estimated else None)
    )


def test_results_without_equilibrium_and_with_every_kind_of_line_have_the_keys_of_the_schema() -> None:
    pads = signorini.loads(STORM)
    for output in ({}, {"combinations": "table", "envelope": ["deflection", "mx", "m1"]}):
        model = signorini.validate(pads.model_dump(exclude_unset=True) | {"output": output})
        strict_schema.RESULTS.validate(results_json(solved := signorini.solve(model), signorini.estimate(solved)))
    pages = runpy.run_path(str(ROOT / "docs" / "tables.py"))
    for text in (pages["_MODEL"], pages["_COLUMNS"]):
        strict_schema.RESULTS.validate(
            results_json(solved := signorini.solve(signorini.loads(text)), signorini.estimate(solved))
        )


@pytest.mark.parametrize(
    "change",
    [
        lambda results: results["combinations"][0].pop("certificate"),
        lambda results: results["combinations"][0]["certificate"].update(passed="yes"),
        lambda results: results["combinations"][0]["supports"][0].update(reaction="700 kN"),
        lambda results: results.update(schema=1),
    ],
)
def test_the_schema_refuses_results_that_are_damaged(change: Any) -> None:
    results = results_json(signorini.solve(signorini.loads(SLAB)))
    jsonschema.validate(results, SCHEMA)
    change(results)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(results, SCHEMA)


def nodes(node: Any) -> Iterator[dict[str, Any]]:
    if isinstance(node, dict):
        yield node
    for value in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
        yield from nodes(value)


def test_every_key_of_results_has_a_description_and_every_quantity_is_among_them() -> None:
    described = [part for node in nodes(SCHEMA) for part in node.get("properties", {}).values()]
    of_vectors = {"design_moment", "stress", "as", "top", "bottom", "von_mises", "shear"}
    keys = {key for node in nodes(SCHEMA) for key, part in node.get("properties", {}).items() if not says(part)}
    assert described and keys <= of_vectors | {"rotation", "moment", "principal_moment", "eccentricity"}
    names = {node["name"] for node in nodes(SCHEMA) if isinstance(node.get("name"), str)}
    wanted = {one.name for of in BY_LIST.values() for one in of if one.kind != "reaction"} | {*FIELDS}
    assert wanted - names == set()


def says(node: Any) -> bool:
    return isinstance(node, dict) and bool(node.get("description"))


def test_every_key_of_results_is_documented() -> None:
    text = "".join((ROOT / "docs" / name).read_text("utf-8") for name in ("results.md", "quantities.md"))
    schemas = SCHEMA, signorini.results_schema("path.json")
    every = {key for schema in schemas for node in nodes(schema) for key in node.get("properties", {})}
    words = set(re.findall(r"\w+", text))
    assert {key for key in every if key not in words and not re.match("max_|min_|.*_limit$", key)} == set()


@pytest.mark.parametrize(
    ("key", "source", "unit", "said"),
    [
        ("support.gap", "input file", "", "Free travel"),
        ("[[support]]", "input file", "", "supports"),
        ("plates.top.thickness", "input file", "", "Thickness"),
        ("certificate.passed", "results.json", "", "error"),
        ("soil.max_pressure", "results.json", "F/L²", "pressure"),
        ("probe[1].mx", "results.json", "F L/L", "moment mx"),
        ("max:mx", "results.json", "F L/L", "moment mx"),
        ("reaction:soil", "results.json", "F", "reaction"),
        ("section[cut].moment", "results.json", "F L", "moment"),
        ("NoEquilibriumError", "error", "", "supports cannot hold"),
    ],
)
def test_a_key_a_number_a_column_and_an_error_are_explained(key: str, source: str, unit: str, said: str) -> None:
    first = signorini.explain(key)[0]
    assert (first.source, first.unit) == (source, unit) and said in first.meaning
    done = run("explain", key)
    assert done.exit_code == 0 and first.meaning.split()[0] in done.stdout
    told = json.loads(run("explain", key, "--json").stdout)
    assert [one["meaning"] for one in told] == [one.meaning for one in signorini.explain(key)]
    assert all((ROOT / one["documented"]).exists() for one in told)


def test_explanations_are_those_of_the_schemas() -> None:
    (gap,) = signorini.explain("support.gap")
    node = signorini.schema()["$defs"]["Support"]["properties"]["gap"]
    assert (gap.meaning, gap.default, gap.allowed) == (node["description"], json.dumps(node["default"]), "≥ 0")
    (thickness,) = signorini.explain("plate.thickness")
    assert (thickness.default, thickness.allowed) == ("required", "> 0")
    assert {one.source for one in signorini.explain("gap")} == {"input file", "results.json", "path.json"}


@pytest.mark.parametrize("key", ["", ".", "foo.bar", "support.gpa"])
def test_an_unknown_key_is_bad_usage(key: str) -> None:
    done = run("explain", key)
    assert done.exit_code == 2 and repr(key) in done.stderr
    assert key != "support.gpa" or "support.gap" in done.stderr


def test_the_table_of_exit_codes_is_that_of_the_program(
    slab: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = re.findall(r"^\| (\d+) \|", PAGE, re.MULTILINE)
    errors = signorini.SignoriniError, signorini.InputError, signorini.NoEquilibriumError, signorini.NotCertifiedError
    known = [0, *(error.exit_code for error in errors), interrupts.INTERRUPTED, interrupts.TERMINATED]
    assert [int(code) for code in table] == known
    out = tmp_path / "out"
    solve = ("solve", slab, "-o", out, "--pictures", "none")
    assert run(*solve).exit_code == 0
    assert run("verify", out / "results.json").exit_code == 0
    changed = json.loads((out / "results.json").read_text("utf-8"))
    changed["combinations"][0]["supports"][0]["reaction"] *= 2
    (out / "results.json").write_text(json.dumps(changed), encoding="utf-8")
    assert run("verify", out / "results.json").exit_code == 1
    slab.write_text(STORM)
    assert run(*solve).exit_code == 3 and (out / "results.json").exists()
    assert run("check", slab).exit_code == 3
    slab.write_text(SLAB.replace("0.2 }\nplate", "2 }\nplate"))
    assert run(*solve[:3], tmp_path / "none").exit_code == 2 and not (tmp_path / "none").exists()
    slab.write_text(SLAB)

    def refuse(*_: object, **__: object) -> None:
        raise signorini.NotCertifiedError("refused")

    monkeypatch.setattr("signorini.analysis.solve.solve_all", refuse)
    assert run(*solve[:3], tmp_path / "none").exit_code == 4 and not (tmp_path / "none").exists()


@pytest.mark.parametrize("text", [SLAB + CHECKS, TWO], ids=["one plate", "two plates"])
@pytest.mark.parametrize("kind", ["each", "table"])
def test_files_with_exit_code_3_are_those_of_this_run_also_if_no_combination_has_an_equilibrium(
    slab: Path, tmp_path: Path, text: str, kind: str
) -> None:
    up = '[{ name = "up", group = "A", factors = { G = -1 } }, { name = "far up", group = "B", factors = { G = -2 } }]'
    slab.write_text(f'output.combinations = "{kind}"\n' + text)
    out = tmp_path / "out"
    assert run("solve", slab, "-o", out).exit_code == 0
    slab.write_text(re.sub(r"(?m)^combination = .*$", f"combination = {up}", slab.read_text()))
    done = run("solve", slab, "-o", out, "--xlsx")
    assert done.exit_code == 3 and "up: " in done.stderr and "far up: " in done.stderr
    assert strict_schema.faults(out / "results.json") == []
    found = json.loads((out / "results.json").read_text("utf-8"))
    assert found["input"]["sha256"] == sha256(slab.read_bytes()).hexdigest()
    assert {one["status"] for one in found["combinations"]} <= {"no_equilibrium"}
    assert sorted(path.name for path in out.iterdir()) == sorted(entry["file"] for entry in found["files"])
    assert run("verify", out / "results.json").exit_code == 0
    assert run("report", slab).exit_code == 3


@pytest.mark.parametrize("text", [SLAB, STORM], ids=["solved", "without equilibrium"])
def test_the_example_prints_reactions_with_half_widths(slab: Path, text: str) -> None:
    slab.write_text(text)
    (program,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    done = subprocess.run([sys.executable, "-c", program], cwd=slab.parent, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert re.search(r"^service pads [\d.]+ ± [\d.e-]+ kN$", done.stdout, re.MULTILINE)
    assert (text == STORM) == ("storm has no equilibrium" in done.stdout)
