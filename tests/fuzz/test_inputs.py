"""A sample of fuzzed input files, and every input that once found a fault."""

import subprocess
import sys
import tempfile
from pathlib import Path

import inputs
import meshes
import pytest

CORPUS = Path(__file__).parent / "corpus"


def test_fuzzed_inputs_end_with_an_exit_code_and_one_message() -> None:
    faults, codes = {}, set()
    for seed in range(150):
        outcomes, wrong = inputs.one(seed)
        codes.update(outcomes)
        if wrong:
            faults[seed] = wrong
    assert faults == {}
    assert codes >= {"exit 0", "exit 2", "exit 3"}


def test_fuzzed_mesh_files_do_too() -> None:
    faults = {seed: found for seed in range(60) if (found := meshes.one(seed)[1])}
    assert faults == {}


@pytest.mark.parametrize("command", ["solve", "check"])
@pytest.mark.parametrize("path", sorted(CORPUS.iterdir()), ids=lambda path: path.stem)
def test_an_input_that_once_found_a_fault(path: Path, command: str) -> None:
    """Inputs that one form of the problem once refused are solved by another."""
    with tempfile.TemporaryDirectory() as directory:
        drawn = command == "check"
        code, errors, wrong = inputs.ended(path.read_bytes(), command, Path(directory), pictures=drawn)
    assert wrong == []
    assert not path.stem.startswith("refused_") or code in (0, 3), errors


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("x\n" * 10**6, "slab.toml:1: invalid TOML"),
        ("asdf qwer\n" * 10**6, "larger than 4 MB"),
        ("a = " + "[" * 10**6, "nested too deeply"),
        ("\n".join(f"k{i} = {i}" for i in range(10**5)), "100002 problems:"),
        (bytes(range(256)) * 10**4, "is not UTF-8 text"),
    ],
    ids=["short lines", "long", "brackets", "keys", "bytes"],
)
def test_a_million_lines_of_garbage_are_refused_in_seconds(content: str | bytes, says: str, tmp_path: Path) -> None:
    content = content.encode() if isinstance(content, str) else content
    code, errors, wrong = inputs.ended(content, "solve", tmp_path, pictures=False)
    assert (code, wrong) == (2, []) and says in errors


def test_the_script_counts_what_it_ran() -> None:
    script = [sys.executable, str(CORPUS.parent / "inputs.py"), "--count", "20", "--processes", "2"]
    done = subprocess.run(script, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and done.stdout.startswith("20 seeds from 0: {'exit ")
