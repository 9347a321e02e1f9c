"""Fuzz the command line with input files: a run ends with an exit code and one message, and writes all or no files.

    python tests/fuzz/inputs.py [--count 100000] [--first 0] [--seconds 600] [--processes 2]
    python tests/fuzz/inputs.py --show SEED     the input file of a seed, and its outcome

Outcomes and failures are printed with their seeds; the exit code is 0 if there is no failure.
"""

from __future__ import annotations

import io
import json
import re
import sys
import tempfile
import warnings
from collections import Counter
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from random import Random

import campaign
import mutations
import strict_schema
import typer.main

import signorini
import signorini.plot.curves
import signorini.plot.files
import signorini.plot.pictures
from signorini.cli import app

COMMANDS = typer.main.get_command(app)
NAME = "slab.toml"
_SELDOM = 50
"""One of 50 inputs draws its pictures, which take most of the time and do not affect the outcome."""

_PICTURES = (
    (signorini.plot.pictures, "check_picture"),
    (signorini.plot.curves, "load_path_picture"),
    (signorini.plot.files, "save"),
)
_NO_PICTURES = {"solve": ("--pictures", "none")}
_LEAVES = {"solve": ("slab-results", (0, 3)), "check": ("slab-check.png", (0, 3)), "path": ("slab-path", (0, 4))}
"""Files that each command may write beside the input, and the exit codes with which it does; `solve` always does."""
_CASES = ["load", "G", "Q", "all", "C0"]
"""Names of load cases and combinations of the drawn models, for load paths."""

_PLACE = re.compile(rf"Error: (\S*{re.escape(NAME)}(:\d+)?: |--\w+: |({'|'.join(signorini.Model.model_fields)})\b)")

_IN_MESH = re.compile(r"Error: \S*plate\.(msh|inp|vtu|vtk|ply): ")


def ended(
    content: bytes, command: str, directory: Path, pictures: bool, more: tuple[str, ...] = ()
) -> tuple[int, str, list[str]]:
    """Run a command on an input file; return its exit code, standard error, and a list of faults."""
    file, before = directory / NAME, {path.name for path in directory.iterdir()}
    file.write_bytes(content)
    drawn = {(home, name): getattr(home, name) for home, name in _PICTURES}
    if not pictures:
        more = (*more, *_NO_PICTURES.get(command, ()))
        for home, name in _PICTURES:
            setattr(home, name, lambda *given, **more: None)
        signorini.plot.files.save = lambda figure, path, metadata=None: Path(path).write_bytes(b"")
    try:
        code, errors, exception = _run([command, str(file), *more])
    finally:
        for (home, name), function in drawn.items():
            setattr(home, name, function)
    wrong = list(_faults(code, errors, exception))
    left = {path.name for path in directory.iterdir()} - before - {NAME}
    leaves, codes = _LEAVES[command]
    if code in codes and leaves in left:
        wrong += _faults_of_results(directory / leaves, code) if command == "solve" else []
        left -= {leaves}
    elif code == 0 or (code == 3 and command == "solve"):
        wrong.append("nothing is written")
    if left:
        wrong.append(f"left behind: {sorted(left)}")
    return code, errors, wrong


def _run(arguments: list[str]) -> tuple[int, str, BaseException | None]:
    """Call the command line in this process; return its exit code, standard error and exception."""
    out, errors = (io.TextIOWrapper(io.BytesIO(), "utf-8") for _ in range(2))
    code, exception = 0, None
    with warnings.catch_warnings(), redirect_stdout(out), redirect_stderr(errors):
        warnings.simplefilter("always")
        try:
            COMMANDS.main(arguments, prog_name="signorini")
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else int(end.code is not None)
        except campaign.Hang:
            raise
        except BaseException as error:  # Any exception that reaches the user is a fault.
            exception = error
    errors.seek(0)
    return code, errors.read(), exception


def _faults(code: int, errors: str, exception: BaseException | None):
    if exception is not None:
        yield f"{type(exception).__name__}: {exception}"
        return
    if code not in (0, 2, 3, 4):
        yield f"exit code {code}: {errors.strip()}"
    elif code == 0 and errors:
        yield f"says with success: {errors.strip()}"
    elif code == 2 and not _PLACE.match(errors) and not _IN_MESH.match(errors):
        yield f"no place in: {errors.strip()}"
    elif code == 3 and not errors.startswith("No equilibrium.\n"):
        yield f"does not say that there is no equilibrium: {errors.strip()}"
    if "Traceback" in errors or "Warning:" in errors:
        yield f"not for users: {errors.strip()}"
    # Combinations listed one by one have a line each.
    if len(errors) > 20_000 or errors.count("\n") > 60:
        yield f"a message of {len(errors)} characters"


def _faults_of_results(directory: Path, code: int) -> list[str]:
    try:
        found = json.loads((directory / "results.json").read_text("utf-8"), parse_constant=float.fromhex)
    except (OSError, ValueError) as error:
        return [f"results.json: {error}"]
    wrong = strict_schema.faults(directory / "results.json")
    if sorted(entry["file"] for entry in found["files"]) != sorted(path.name for path in directory.iterdir()):
        wrong.append("other files than results.json says")
    states = [combination["status"] for combination in found["combinations"]]
    unbalanced = found["table"]["no_equilibrium"] if "table" in found else states.count("no_equilibrium")
    if set(states) - {"solved", "no_equilibrium"} or (code == 0) != (unbalanced == 0):
        wrong.append(f"exit code {code} with {unbalanced} without equilibrium of {states}")
    if not all(c["certificate"]["passed"] for c in found["combinations"] if c["status"] == "solved"):
        wrong.append("not certified")
    return wrong


def one(seed: int) -> tuple[Counter[str], list[str]]:
    """Draw and run one input: its outcome and its faults."""
    rng = Random(seed)
    content = mutations.text(rng)
    command = rng.choice(["solve", "solve", "solve", "solve", "check", "path"])
    if command == "path" and b'"divisions"' not in content:
        command = "solve"  # On the default mesh a path over soil has thousands of events.
    more = ("--add", rng.choice(_CASES), *rng.choice([(), ("--from", rng.choice(_CASES)), ("--until", "2")]))
    with tempfile.TemporaryDirectory() as directory:
        drawn = rng.randrange(_SELDOM) == 0
        code, _, wrong = ended(content, command, Path(directory), drawn, more if command == "path" else ())
    return Counter({f"exit {code}": 1}), wrong


def show(seed: int) -> None:
    """Print the input file of a seed."""
    sys.stdout.buffer.write(mutations.text(Random(seed)))
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(campaign.main(__doc__, one, show))
