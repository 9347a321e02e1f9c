"""An interrupted run leaves either the results of the run before or those of this one, complete."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

import signorini
import signorini_command
from signorini.cli import app

pytestmark = pytest.mark.skipif(os.name == "nt", reason="signals and limits of POSIX")

SLAB = """
title = "{title}"
material = {{ E = 30e6, nu = 0.2 }}
plate = {{ shape = "rectangle", size = [4, 4], thickness = 0.2 }}
mesh = {{ divisions = [{along}, {along}] }}
support = [{{ at = [[1, 1], [3, 1], [3, 3], [1, 3]], resists = "down" }}]
load = [{{ pressure = 5 }}]
"""


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A slab and its results."""
    path = tmp_path_factory.mktemp("first") / "slab.toml"
    path.write_text(SLAB.format(title="first", along=4))
    assert CliRunner().invoke(app, ["solve", str(path)]).exit_code == 0
    return path


@pytest.fixture
def slab(first: Path, tmp_path: Path) -> Path:
    shutil.copytree(first.parent, tmp_path, dirs_exist_ok=True)
    return tmp_path / first.name


def started(path: Path, before: str = "") -> subprocess.Popen[str]:
    """Run the command line in a process of its own, after some Python."""
    lines = ["import sys", f"sys.argv = ['signorini', 'solve', {str(path)!r}]", before]
    code = "\n".join([*lines, "import signorini_command", "signorini_command.main()"])
    handled = lambda: signal.signal(signal.SIGINT, signal.default_int_handler)  # noqa: E731
    pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    as_users_have_it = {name: value for name, value in os.environ.items() if name not in signorini_command.POOLS}
    command = [sys.executable, "-c", code]
    return subprocess.Popen(command, text=True, preexec_fn=handled, env=as_users_have_it, **pipes)


def whole(directory: Path) -> str:
    """Title of the results in a directory, every file of which is there and of that run."""
    found = json.loads((directory / "results.json").read_text("utf-8"))
    names = [entry["file"] for entry in found["files"]]
    assert sorted(names) == sorted(path.name for path in directory.iterdir())
    assert all((directory / name).stat().st_size > 0 for name in names)
    return str(found["title"])


@pytest.mark.parametrize("limit", [1_000, 30_000])
def test_a_full_disk_leaves_the_old_results(slab: Path, limit: int) -> None:
    slab.write_text(SLAB.format(title="second", along=8))
    bounded = "import resource, signal\nsignal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
    running = started(slab, f"{bounded}resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))")
    _, errors = running.communicate(timeout=60)
    results = slab.with_name("slab-results")
    assert running.returncode == 2
    assert errors.splitlines() == [
        f"No files are written; {results} has the results of an earlier run.",
        f"Error: {results}: the results cannot be written there: File too large. Name another directory.",
    ]
    assert whole(results) == "first"
    assert sorted(path.name for path in slab.parent.iterdir()) == ["slab-results", "slab.toml"]


PAUSED = """
import signorini.{module} as module, sys, time
module = sys.modules["signorini.{module}"]
real = module.{name}
def paused(*given, **more):
    print("here", flush=True)
    for _ in range({seconds} * 20):
        time.sleep(0.05)
    return real(*given, **more)
module.{name} = paused
"""
"""Many short sleeps: a signal between Python's last look and the system's sleep waits until the sleep ends."""


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize(
    ("module", "name"),
    [("contact.strategy", "certified"), ("output.writing", "reactions_csv"), ("base.files", "_move")],
)
def test_a_signal_leaves_the_old_results(slab: Path, number: int, code: int, module: str, name: str) -> None:
    slab.write_text(SLAB.format(title="second", along=4))
    running = started(slab, PAUSED.format(module=module, name=name, seconds=30))
    assert running.stdout is not None and running.stdout.readline() == "here\n"
    running.send_signal(number)
    _, errors = running.communicate(timeout=20)
    assert running.returncode == code
    assert errors == "Interrupted; no files are written.\n"
    assert whole(slab.with_name("slab-results")) == "first"
    assert sorted(path.name for path in slab.parent.iterdir()) == ["slab-results", "slab.toml"]


def test_a_second_signal_during_imports_repeats_no_message() -> None:
    """timeout(1) sends its signal to the process and to its group."""
    again = "real(words); os.kill(os.getpid(), signal.SIGINT)"
    lines = ["import os, signal, sys, signorini_command", "real = sys.stderr.write", f"def write(words): {again}"]
    lines += ["sys.stderr.write = write", "signal.signal(signal.SIGINT, signorini_command._interrupted)"]
    lines += ["os.kill(os.getpid(), signal.SIGINT)"]
    ended = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stderr) == (130, "Interrupted; no files are written.\n")


STEPPING = """
import pathlib
real, count = pathlib.Path.rename, 0
def rename(self, target):
    global count
    count += 1
    print(count, flush=True)
    sys.stdin.readline()
    return real(self, target)
pathlib.Path.rename = rename
"""


@pytest.mark.parametrize("kill_at", [1, 8])
def test_a_kill_amid_the_exchange_leaves_no_mixture(slab: Path, kill_at: int) -> None:
    """results.json is the first of eight files removed and the last moved: files without it are no results."""
    slab.write_text(SLAB.format(title="second", along=4))
    running = started(slab, STEPPING)
    assert running.stdout is not None and running.stdin is not None
    for step in range(1, kill_at + 1):
        assert running.stdout.readline() == f"{step}\n"
        if step < kill_at:
            running.stdin.write("go\n")
            running.stdin.flush()
    running.kill()
    running.communicate()
    results = slab.with_name("slab-results") / "results.json"
    assert results.exists() == (kill_at == 1)
    if kill_at == 1:
        assert json.loads(results.read_text("utf-8"))["title"] == "first"


def test_two_runs_at_once_leave_the_results_of_one(slab: Path) -> None:
    shutil.rmtree(slab.with_name("slab-results"))
    running = []
    for name in ("one", "two"):
        path = slab.with_name(f"{name}.toml")
        path.write_text(SLAB.format(title=name, along=4) + f'combination = [{{ name = "{name}", factors.load = 1 }}]')
        running.append(started(path, f"sys.argv += ['-o', {str(slab.with_name('slab-results'))!r}]"))
    assert [process.communicate(timeout=60)[1] for process in running] == ["", ""]
    assert whole(slab.with_name("slab-results")) in ("one", "two")
    assert hidden(slab) == []


def hidden(slab: Path) -> list[Path]:
    return [path for path in (*slab.parent.iterdir(), *slab.with_name("slab-results").iterdir()) if path.name[0] == "."]


NATIVE = """
import ctypes, signorini.analysis.solve
def solve_all(model, progress, table):
    print("here", flush=True)
    ctypes.CDLL(None).usleep(30_000_000)
signorini.analysis.solve.solve_all = solve_all
"""


def test_ctrl_c_ends_native_code_too(slab: Path) -> None:
    running = started(slab, NATIVE)
    assert running.stdout is not None and running.stdout.readline() == "here\n"
    begun = time.monotonic()
    # usleep returns early on a signal to its own thread; libc's other threads keep sleeping as a factorization would.
    running.send_signal(signal.SIGINT)
    _, errors = running.communicate(timeout=20)
    assert (running.returncode, errors) == (130, "Interrupted; no files are written.\n")
    assert time.monotonic() - begun < 10
    assert hidden(slab) == [] and whole(slab.with_name("slab-results")) == "first"


@pytest.mark.parametrize("module", ["numpy", "scipy", "typer"])
def test_ctrl_c_while_modules_are_read_is_a_word(module: str) -> None:
    running = started(Path("slab.toml"), IMPORTING.format(module=module))
    assert running.stdout is not None and running.stdout.readline() == "here\n"
    running.send_signal(signal.SIGINT)
    _, errors = running.communicate(timeout=20)
    assert (running.returncode, errors) == (130, "Interrupted; no files are written.\n")


IMPORTING = """
import builtins, time
real = builtins.__import__
def slow(name, *given):
    if name.partition(".")[0] == "{module}":
        print("here", flush=True)
        try:
            for _ in range(600):
                time.sleep(0.05)
        except BaseException:
            raise ImportError(name)  # as an extension module that is interrupted may
    return real(name, *given)
builtins.__import__ = slow
"""


def test_a_mesh_that_cannot_fit_is_refused_before_it_is_made(slab: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("signorini.base.memory.available", lambda: 2e9)
    slab.write_text(SLAB.format(title="large", along=1000))
    begun = time.monotonic()
    done = CliRunner().invoke(app, ["solve", str(slab)])
    assert done.exit_code == 2 and time.monotonic() - begun < 2
    assert "slab.toml:5: mesh: A mesh of 1,000,000 elements takes about 35." in done.stderr
    assert "2.0 GB are free, enough for about 63,000. Use larger elements." in done.stderr


def test_a_limit_on_the_address_space_is_a_message(slab: Path) -> None:
    limit = "import resource\nresource.setrlimit(resource.RLIMIT_AS, (10**9, 10**9))"
    slab.write_text(SLAB.format(title="small", along=4))
    running = started(slab, limit)
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 2
    said = "mesh: A mesh of 16 elements takes about 0.1 GB of memory; 0.0 GB are free, too little for any number."
    assert errors.splitlines()[-1] == f"Error: slab.toml:5: {said}"


def test_contact_points_that_cannot_fit_are_refused(slab: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rigid = SLAB.format(title="rigid", along=40).replace("at = [[1, 1], [3, 1], [3, 3], [1, 3]]", 'area = "all"')
    slab.write_text(f'solver.method = "lemke"\n{rigid}')
    monkeypatch.setattr("signorini.base.memory.available", lambda: 2e8)
    done = CliRunner().invoke(app, ["solve", str(slab)])
    assert done.exit_code == 2
    assert "slab.toml:7: support: The problem of 1,760 contact points that need condensing takes about 0.6 GB" in (
        done.stderr
    )
    assert 'enough for about 1,000. Leave solver.method at "auto", which condenses fewer points.' in done.stderr


def test_threads_are_bounded_those_of_numpy_too(slab: Path) -> None:
    probe = "import atexit, os\natexit.register(lambda: print('threads', len(os.listdir('/proc/self/task'))))"
    counts = {}
    for bound in ("1", "3"):
        asked = f"sys.argv += ['--threads', '{bound}']"
        out, _ = started(slab, f"{probe}\n{asked}").communicate(timeout=60)
        counts[bound] = int(out.splitlines()[-1].split()[1])
    # The one that waits, and those that work; of three one more may wait for pictures.
    assert counts["1"] == 1 + 1 and counts["3"] in (1 + 3, 1 + 3 + 1)
    assert CliRunner().invoke(app, ["solve", str(slab), "--threads", "0"]).exit_code == 2
    assert signorini.solve(signorini.load(slab))["all"].certificate.passed
