"""Release: one version and date in all files, licences of all crates, and dependencies of the recipe."""

import json
import re
import runpy
import shutil
import subprocess
import tomllib
import zipfile
from pathlib import Path

import pytest

import signorini

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
CITATION, RECIPE, LICENCES, CHANGES = (
    (ROOT / name).read_text("utf-8")
    for name in ("CITATION.cff", "recipe/recipe.yaml", "THIRDPARTY.yml", "CHANGELOG.md")
)
CODEMETA = json.loads((ROOT / "codemeta.json").read_text("utf-8"))
CONDA = {"matplotlib": "matplotlib-base"}
"""Packages with another name on conda-forge."""


def given(pattern: str, text: str) -> str:
    found = re.search(pattern, text, re.MULTILINE)
    assert found is not None, pattern
    return found[1]


def test_every_file_has_the_version_of_the_program_and_the_date_of_the_changelog() -> None:
    version = signorini.__version__
    assert tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]["package"]["version"] == version
    assert (
        given(r"^version: (.*)$", CITATION) == CODEMETA["version"] == given(r'^  version: "(.*)"$', RECIPE) == version
    )
    date = given(rf"^## \[{re.escape(version)}\] - (\d{{4}}-\d{{2}}-\d{{2}})$", CHANGES)
    assert given(r"^date-released: (.*)$", CITATION) == CODEMETA["datePublished"] == date


def test_the_recipe_has_the_dependencies_of_the_package() -> None:
    listed = re.findall(r"^    - (\S+) >=(\S+)$", RECIPE.partition("  run:")[2], re.MULTILINE)
    wanted = [re.fullmatch(r"([\w-]+)>=([\d.]+)", one) for one in PROJECT["dependencies"]]
    assert listed == [(CONDA.get(one[1], one[1]), one[2]) for one in wanted if one]
    assert None not in wanted


@pytest.mark.skipif(shutil.which("cargo") is None, reason="needs cargo")
def test_the_licences_are_those_of_every_crate_in_a_wheel() -> None:
    tree = [
        "cargo",
        "tree",
        "--package",
        "signorini-python",
        "--edges",
        "normal",
        "--target",
        "all",
        "--prefix",
        "none",
    ]
    listed = subprocess.run([*tree, "--locked"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    crates = {(name, version) for name, version in re.findall(r"^(\S+) v(\S+)", listed, re.MULTILINE)}
    names = re.findall(r"^- package_name: (.*)\n  package_version: (.*)$", LICENCES, re.MULTILINE)
    assert {crate for crate in crates if not crate[0].startswith("signorini")} <= set(names)
    assert "NOT FOUND" not in LICENCES


def test_the_package_carries_the_licences() -> None:
    assert PROJECT["license-files"] == ["LICENSE-MIT", "LICENSE-APACHE", "THIRDPARTY.yml"]
    assert all((ROOT / name).exists() for name in PROJECT["license-files"])


FILES = {
    "signorini/_core.abi3.so": b"needs GLIBC_2.17",
    **dict.fromkeys(("signorini/py.typed", "signorini/output/schema.toml"), b""),
    **dict.fromkeys((f"signorini-0.1.0.dist-info/{name}" for name in PROJECT["license-files"]), b""),
}
TAG = "cp311-abi3-musllinux_1_2_x86_64"


@pytest.mark.parametrize(
    ("tag", "change", "found"),
    [
        (TAG, {}, ""),
        ("cp311-cp311-musllinux_1_2_x86_64", {}, "stable ABI"),
        (TAG, {"signorini/second.so": b""}, "one library"),
        (TAG, {"signorini-0.1.0.dist-info/THIRDPARTY.yml": None}, "contains THIRDPARTY.yml"),
        (TAG, {"signorini/large": bytes(7_000_000)}, "size 7.0 MB"),
        ("cp311-abi3-manylinux_2_17_x86_64", {"signorini/_core.abi3.so": b"GLIBC_2.35"}, "needs glibc 2.35"),
    ],
)
def test_a_wheel_that_is_not_as_it_must_be_is_refused(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tag: str,
    change: dict[str, bytes | None],
    found: str,
) -> None:
    wheel = tmp_path / f"signorini-0.1.0-{tag}.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for name, content in (FILES | change).items():
            if content is not None:
                archive.writestr(name, content)
    module = runpy.run_path(str(ROOT / ".ci" / "wheel.py"))
    monkeypatch.setitem(module["check_content"].__globals__, "check_linked", lambda library: None)
    if found:
        with pytest.raises(SystemExit):
            module["check_content"](wheel, None)
        last = capsys.readouterr().out.splitlines()[-1]
        assert last.startswith("ERROR") and found in last
    else:
        module["check_content"](wheel, None)
        assert "ERROR" not in capsys.readouterr().out
