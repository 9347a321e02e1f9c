"""A process beside the command draws its pictures, and ends with it."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="the system lists no processes")

SECONDS = 60
SLAB = """
title = "荷重"
material = { E = 30e6, nu = 0.2 }
plate = { shape = "rectangle", size = [4, 4], thickness = 0.2 }
mesh = { divisions = [4, 4] }
support = [{ area = "all", resists = "down", stiffness = 1e4 }]
load = [{ case = "G", pressure = 5 }, { case = "Q", force = 20, at = [1, 1] }]
combination = [{ name = "G", factors = { G = 1 } }, { name = "G + Q", factors = { G = 1, Q = 1 } }]
"""


def solved(directory: Path, before: str = "", *more: str) -> subprocess.Popen[str]:
    """Solve a slab by the command line after some Python, as where there are two cores."""
    directory.mkdir()
    (directory / "slab.toml").write_text(SLAB, "utf-8")
    arguments = ["signorini", "solve", str(directory / "slab.toml"), *more]
    # A shell's jobs in the background ignore Ctrl-C.
    code = f"""
import os, signal, sys, time
os.sched_getaffinity = lambda process: {{0, 1}}
signal.signal(signal.SIGINT, signal.default_int_handler)
import signorini.plot.artist as artist
{before}
sys.argv = {arguments!r}
import atexit, signorini_command
atexit.register(lambda: print("matplotlib" in sys.modules))
signorini_command.main()
"""
    return subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def files(directory: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (directory / "slab-results").iterdir() if path.suffix != ".json"}


def test_pictures_are_the_same_whoever_draws_them(tmp_path: Path) -> None:
    runs = {
        "drawn": solved(tmp_path / "drawn"),
        "by several": solved(tmp_path / "by several", "artist._ENOUGH = 2"),
        "alone": solved(tmp_path / "alone", "", "--threads", "1"),
    }
    for name, run in runs.items():
        output, errors = run.communicate(timeout=SECONDS)
        assert run.returncode == 0 and "Traceback" not in errors
        # A missing letter of the font is reported; if another process draws, this one does not import matplotlib.
        assert "Glyph 33655" in errors
        assert output.endswith("\nTrue\n" if name == "alone" else "\nFalse\n")
    drawn = files(tmp_path / "drawn")
    assert len(drawn) == 14 and all(content for content in drawn.values())
    assert files(tmp_path / "by several") == files(tmp_path / "alone") == drawn


def test_without_pictures_no_process_is_started(tmp_path: Path) -> None:
    run = solved(tmp_path / "none", "artist._started = None", "--pictures", "none")
    output, errors = run.communicate(timeout=SECONDS)
    assert (run.returncode, errors) == (0, "") and output.endswith("\nFalse\n")
    assert not [name for name in files(tmp_path / "none") if name.endswith(".png")]


def test_if_the_process_that_draws_is_ended_nothing_is_written(tmp_path: Path) -> None:
    killed = """
real = artist._started
def ended():
    process = real()
    process.kill()
    return process
artist._started = ended
"""
    run = solved(tmp_path / "killed", killed)
    _, errors = run.communicate(timeout=SECONDS)
    assert run.returncode == 2 and "the process that draws the pictures ended" in errors
    assert [path.name for path in (tmp_path / "killed").iterdir()] == ["slab.toml"]


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGKILL, -9)])
def test_whoever_draws_ends_with_the_command(tmp_path: Path, number: int, code: int) -> None:
    told = f"""
real = artist._started
def slow():
    process = real()
    open({str(tmp_path)!r} + f"/{{process.pid}}", "w")
    return process
artist._started = slow
import signorini.output.writing as writing
writing.results_json = lambda *given: time.sleep(60)
"""
    running = solved(tmp_path / "slab", told)
    end = time.monotonic() + SECONDS
    while not (others := [int(path.name) for path in tmp_path.iterdir() if path.name.isdigit()]):
        assert time.monotonic() < end
        time.sleep(0.05)
    time.sleep(1.0)
    running.send_signal(number)
    running.communicate(timeout=SECONDS)
    assert running.returncode == code
    end = time.monotonic() + 20
    while any(map(alive, others)):
        assert time.monotonic() < end
        time.sleep(0.05)
    if number != signal.SIGKILL:
        assert [path.name for path in (tmp_path / "slab").iterdir()] == ["slab.toml"]


def alive(process: int) -> bool:
    """Whether a process runs; one whose end nobody has asked for does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False
