"""CONTRIBUTING.md: its recipes, files and names are those of the repository."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
JUSTFILE = (ROOT / "justfile").read_text("utf-8")
FOLDERS = "", "python/signorini", "tests", "tests/validation", "core/src/element"
SUFFIXES = r"\.(?:py|rs|md|toml|txt)"


def test_every_recipe_is_described_and_every_described_recipe_exists() -> None:
    recipes = set(re.findall(r"^([a-z]+)(?: \*files)?:$", JUSTFILE, re.MULTILINE)) - {"default"}
    assert set(re.findall(r"`just (\w+)", PAGE)) == recipes


@pytest.mark.skipif(shutil.which("just") is None, reason="needs just")
def test_the_recipes_are_read_by_just() -> None:
    listed = subprocess.run(["just", "--summary"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert {"build", "test", "lint", "docs", "bench", "wheel"} <= set(listed.split())


def test_every_file_that_is_named_exists() -> None:
    named = set(re.findall(rf"`([\w./]+/[\w.]+{SUFFIXES}|[\w]+{SUFFIXES})`", PAGE))
    here = {name for name in named if any((ROOT / folder / name).exists() for folder in FOLDERS)}
    assert {name for name in named - here if not [*ROOT.glob(f"*/**/{name}")]} == set()


def test_the_benchmarks_that_are_checked_exist() -> None:
    checked = re.findall(r'^    "([\w.]+)', (ROOT / ".ci" / "bench").read_text("utf-8"), re.MULTILINE)
    assert checked and all((ROOT / "benchmarks" / name).exists() for name in checked)
