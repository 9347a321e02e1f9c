"""Processes beside this one do a part of the work, or nothing; what they leave undone is done without them."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(not hasattr(os, "fork") or sys.platform == "darwin", reason="there is no fork")

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


def alone(code: str, **options: object) -> subprocess.CompletedProcess[str]:
    """Run code in a process that has no threads."""
    command = [sys.executable, "-c", "import os, signal, sys, time\nfrom signorini.base.forked import forked\n" + code]
    return subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, **options)  # type: ignore[call-overload,no-any-return]


def test_what_is_prepared_once_serves_every_process() -> None:
    done = alone("""
at = []
def prepare():
    at.append(os.getpid())
def work(job):
    for number in job:
        yield number, at, os.getpid() == at[0]
with forked(3, prepare, work) as processes:
    for start, process in enumerate(processes):
        process.begin(range(start, start + 2))
    found = [list(process.results()) for process in processes]
print([[number for number, *_ in each] for each in found], [own for ((_, _, own), _) in found])
print(len({at[0] for each in found for _, at, _ in each}), at, os.listdir("/proc/self/task") == [str(os.getpid())])
try:
    os.waitpid(-1, os.WNOHANG)
except ChildProcessError:
    print("none is left")
print(len(os.listdir("/proc/self/fd")))
""")
    assert done.stderr == ""
    values, prepared, left, files = done.stdout.splitlines()
    assert values == "[[0, 1], [1, 2], [2, 3]] [True, False, False]"
    assert prepared == "1 [] True" and left == "none is left" and int(files) <= 4


@pytest.mark.parametrize(
    "end",
    [
        "os._exit(1)",
        "os.kill(os.getpid(), signal.SIGKILL)",
        "raise MemoryError",
        "raise KeyboardInterrupt",
        "sys.exit(2)",
    ],
)
@pytest.mark.parametrize("when", ["prepare", "work"])
def test_one_that_ends_before_its_time_gives_what_it_had_done_and_says_nothing(end: str, when: str) -> None:
    done = alone(f"""
def end():
    {end}
def work(job):
    yield job
    if job == {when!r}:
        end()
    yield job
with forked(2, end if {when!r} == "prepare" else int, work) as processes:
    for job, process in zip(["work", "other"], processes):
        process.begin(job)
    print([list(process.results()) for process in processes])
""")
    assert done.stderr == ""
    assert done.stdout == ("[[], []]\n" if when == "prepare" else "[['work'], ['other', 'other']]\n")


def test_one_that_is_gone_takes_no_job_however_large() -> None:
    done = alone("""
with forked(2, lambda: os._exit(0), iter) as processes:
    time.sleep(0.2)
    for process in processes:
        process.begin(bytes(10_000_000))
    print([list(process.results()) for process in processes])
""")
    assert (done.stdout, done.stderr) == ("[[], []]\n", "")


def test_results_do_not_wait_for_whoever_takes_them() -> None:
    done = alone("""
def work(job):
    yield bytes(300_000)
    with open(job, "w") as file:
        file.write("went on")
with forked(1, int, work) as (process,):
    read, write = os.pipe()
    process.begin(f"/proc/{os.getpid()}/fd/{write}")
    print(os.read(read, 20).decode())
    print([len(one) for one in process.results()])
""")
    assert (done.stdout, done.stderr) == ("went on\n[300000]\n", "")


def test_none_outlives_the_work_of_this_one() -> None:
    begun = time.monotonic()
    done = alone("""
try:
    with forked(2, lambda: time.sleep(600), iter):
        raise ValueError("over")
except ValueError as error:
    print(error)
with forked(2, int, lambda job: time.sleep(600) or []) as processes:
    for process in processes:
        process.begin(0)
    time.sleep(0.3)
""")
    assert (done.stdout, done.stderr) == ("over\n", "")
    assert time.monotonic() - begun < SECONDS / 2


def test_none_is_forked_beside_threads_or_where_the_system_has_no_more() -> None:
    done = alone("""
import resource, threading
over = threading.Event()
thread = threading.Thread(target=over.wait)
thread.start()
with forked(2, int, iter) as processes:
    print(processes)
over.set()
thread.join()
while len(os.listdir("/proc/self/task")) > 1:
    time.sleep(0.001)  # the system lists it a little longer
def refused():
    raise BlockingIOError
real, os.fork = os.fork, refused
with forked(2, int, iter) as processes:
    print(processes)
os.fork = real
parent = os.getpid()
os.fork = lambda: real() if os.getpid() == parent else refused()
with forked(2, int, iter) as processes:
    for process in processes:
        process.begin("ab")
    print([list(process.results()) for process in processes])
""")
    assert (done.stdout, done.stderr) == ("[]\n[]\n[['a', 'b'], []]\n", "")


def solved(directory: Path, before: str = "", *more: str) -> subprocess.Popen[str]:
    """Solve a slab by the command line after some Python."""
    directory.mkdir()
    (directory / "slab.toml").write_text(SLAB, "utf-8")
    arguments = ["signorini", "solve", str(directory / "slab.toml"), *more]
    # On one core there would be nobody who draws; a shell's jobs in the background ignore Ctrl-C.
    two = "import os, signal, sys, time\nos.sched_getaffinity = lambda process: {0, 1}\n"
    two += "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    code = f"{two}sys.argv = {arguments!r}\n{before}\nimport signorini_command\nsigno" + "rini_command.main()"
    return subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def files(directory: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (directory / "slab-results").iterdir() if path.suffix != ".json"}


FORKS = """
import atexit
import signorini.output.pictures as pictures
real = pictures.forked
def told(count, prepare, work):
    print("asked for", count, flush=True)
    atexit.register(lambda: print("matplotlib" in sys.modules))
    return real(count, prepare, {work})
pictures.forked = told
"""


def test_pictures_are_the_same_whoever_draws_them(tmp_path: Path) -> None:
    killed = "lambda job: (time.sleep(0 * os.kill(os.getpid(), signal.SIGKILL)) for _ in job)"
    half = "lambda job: (one for number, one in zip(range(1), work(job)))"
    runs = {
        "drawn": solved(tmp_path / "drawn", FORKS.format(work="work")),
        "killed": solved(tmp_path / "killed", FORKS.format(work=killed)),
        "half": solved(tmp_path / "half", FORKS.format(work=half)),
        "alone": solved(tmp_path / "alone", FORKS.format(work="work"), "--threads", "1"),
    }
    said = {}
    for name, run in runs.items():
        output, errors = run.communicate(timeout=SECONDS)
        assert run.returncode == 0
        # A letter that the font lacks is told once, whoever meets it; or where others began, by them and by this one.
        assert 1 <= errors.count("Glyph 33655") <= 1 + (name == "half") and "Traceback" not in errors
        said[name] = output.startswith("asked for 2"), output.endswith("\nFalse\n")
    # Where others draw, this process reads no matplotlib.
    assert said == {"drawn": (True, True), "killed": (True, False), "half": (True, False), "alone": (False, False)}
    drawn = files(tmp_path / "drawn")
    assert len(drawn) == 12 and all(content for content in drawn.values())
    for name in runs:
        assert files(tmp_path / name) == drawn


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGKILL, -9)])
def test_whoever_draws_ends_with_the_command(tmp_path: Path, number: int, code: int) -> None:
    here = f"open({str(tmp_path)!r} + f'/{{os.getpid()}}', 'w')"
    slow = f"lambda job: (time.sleep(0.2) or ('slow', b'') for _ in [{here}] * 1000)"
    running = solved(tmp_path / "slab", FORKS.format(work=slow))
    end = time.monotonic() + SECONDS
    while len(others := [int(path.name) for path in tmp_path.iterdir() if path.name.isdigit()]) < 2:
        assert time.monotonic() < end
        time.sleep(0.05)
    running.send_signal(number)
    running.communicate(timeout=SECONDS)
    assert running.returncode == code
    end = time.monotonic() + 10
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
