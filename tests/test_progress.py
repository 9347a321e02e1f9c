"""Progress of a solve, in Python and on a terminal."""

import os
import pty
import re
import subprocess
import sys
from contextlib import suppress
from itertools import groupby
from pathlib import Path
from threading import Thread
from types import SimpleNamespace

import pytest
from models import rectangular

import signorini
from signorini import Progress
from signorini.cli import streams

SLAB = """
material = { E = 30e9, nu = 0.2 }
plate = { shape = "rectangle", size = [10, 10], thickness = 0.3 }
mesh = { divisions = [10, 10] }
support = [{ name = "soil", area = "all", resists = "down", stiffness = 30e6 }]
load = [
    { case = "G", pressure = 2e3 },
    { case = "Q", force = 5e5, at = [1, 1] },
]
combination = [
    { name = "dead", factors = { G = 1 } },
    { name = "everything [bold]at once[/bold] with a long name", factors = { G = 1, Q = 1 } },
]
"""


@pytest.fixture
def slab(tmp_path: Path) -> Path:
    path = tmp_path / "slab.toml"
    path.write_text(SLAB)
    return path


def test_every_stage_and_every_step_of_the_active_set_is_told(slab: Path) -> None:
    told: list[Progress] = []
    results = signorini.solve(signorini.load(slab), progress=told.append)
    assert [now.stage for now in told[:2]] == ["mesh", "factor"]
    parts = {name: list(part) for name, part in groupby(told[2:], lambda now: now.combination)}
    assert list(parts) == list(results)
    for name, part in parts.items():
        assert {now.stage for now in part} == {"contact"}
        assert [now.step for now in part] == list(range(len(part)))
        assert len(part) - 1 == results[name].iterations
        assert part[-1].residual < 1e-9
        assert {now.method for now in part[1:]} == {"the active set"}
    assert max(now.changing for now in parts["everything [bold]at once[/bold] with a long name"]) > 0


class Enough(Exception):
    """Raised by who has seen enough."""


@pytest.mark.parametrize("last", [0, 1, 2, 3, 5])
def test_what_the_watcher_raises_ends_the_solve(slab: Path, last: int) -> None:
    told: list[Progress] = []

    def watch(now: Progress) -> None:
        told.append(now)
        if len(told) > last:
            raise Enough

    with pytest.raises(Enough):
        signorini.solve(signorini.load(slab), progress=watch)
    assert len(told) == last + 1


def on_a_terminal(command: list[str]) -> tuple[str, str]:
    """Run with a terminal for standard error; return standard output and the terminal's text."""
    ours, theirs = pty.openpty()
    environment = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "FORCE_COLOR")}
    shown = bytearray()

    def read() -> None:
        # The end of the other side is an error on Linux, an empty read on other systems.
        with suppress(OSError):
            while part := os.read(ours, 65536):
                shown.extend(part)

    reader = Thread(target=read)
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=theirs, env=environment | {"TERM": "xterm", "COLUMNS": "40"}
    ) as process:
        os.close(theirs)
        reader.start()
        printed, _ = process.communicate()
    reader.join()
    os.close(ours)
    assert process.returncode == 0
    return printed.decode(), shown.decode()


def test_pivots_are_reported_and_can_be_stopped() -> None:
    # Half of 365 rigid points open, a pivot each.
    line = [{"line": [[0.5, y], [9.5, y]], "resists": "down"} for y in (1.0, 3.0, 5.0, 7.0, 9.0)]
    model = rectangular(
        size=[10, 10],
        thickness=0.1,
        divisions=[40, 10],
        support=line,
        load=[{"pressure": "1e4*sin(3*x)*cos(y) + 2e3"}],
        solver={"method": "lemke"},
    )
    told: list[signorini.Progress] = []
    assert signorini.solve(model, told.append)["all"].certificate.passed
    assert max(now.step for now in told) >= 64

    def enough(now: signorini.Progress) -> None:
        if now.step:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        signorini.solve(model, enough)


def test_a_terminal_shows_a_line_that_is_gone_at_the_end(slab: Path) -> None:
    printed, shown = on_a_terminal([sys.executable, "-m", "signorini", "solve", str(slab)])
    assert "\x1b" not in printed and "dead: solved by active_set" in printed
    assert "writing the results" in shown
    assert shown.rstrip().endswith("\x1b[2K") and "\x1b[?25h" in shown
    visible = [re.sub(r"\x1b\[[\d?]*[a-zA-Z]", "", line) for line in re.split(r"[\r\n]+", shown)]
    assert max(map(len, visible)) < 40


def test_on_a_terminal_it_stays_how_far_every_mesh_came(slab: Path) -> None:
    slab.write_text(SLAB.replace("divisions = [10, 10]", "divisions = [4, 4], accuracy = 0.1"))
    _, shown = on_a_terminal([sys.executable, "-m", "signorini", "solve", str(slab)])
    visible = re.sub(r"\s+", " ", re.sub(r"\x1b\[[\d?]*[a-zA-Z]", "", shown))
    assert re.search(
        r"mesh 1: with 16 elements ± of .* is [\d.]+ of the largest value of its field\. ± of 0\.1 would take about",
        visible,
    )


@pytest.mark.parametrize("environment", [{}, {"FORCE_COLOR": "1"}])
def test_what_is_no_terminal_shows_nothing(slab: Path, environment: dict[str, str]) -> None:
    command = [sys.executable, "-m", "signorini", "solve", str(slab)]
    done = subprocess.run(command, capture_output=True, env=os.environ | environment, check=True)
    assert done.stderr == b""


def props(method: str) -> signorini.Model:
    """A plate on many props, which close and open one by one as the load grows."""
    return rectangular(
        size=[8, 8],
        divisions=[16, 16],
        support=[{"line": [[0.5, y], [7.5, y]], "resists": "down"} for y in (1.0, 4.0, 7.0)],
        load=[{"case": "G", "pressure": 2e3}, {"case": "Q", "force": 1e5, "at": [1.3, 1.2]}],
        solver={"method": method},
    )


@pytest.mark.parametrize("events", ["named", "all"])
@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_a_watcher_sees_the_solves_of_a_path_and_ends_them(method: str, events: str) -> None:
    told: list[Progress] = []
    begins = "after t" if events == "all" else "t = 0.06"

    def watch(now: Progress) -> None:
        told.append(now)
        if now.combination.startswith(begins):
            raise Enough

    with pytest.raises(Enough):
        signorini.path(props(method), "G", "Q", 3.0, progress=watch, events=events)
    assert sum(now.combination.startswith(begins) for now in told) == 1
    assert any(now.combination == "t = 0" for now in told)


def test_a_log_gets_a_plain_line_now_and_then(monkeypatch, capsys) -> None:
    clock = iter([0.0, 1.0, 59.0, 61.0, 62.0, 120.0, 125.0])
    monkeypatch.setattr(streams, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    with streams.progress_line() as show:
        for step in range(6):
            show(Progress("a\x1b[31m", step, 1, 0.5))
    assert capsys.readouterr().err.splitlines() == [
        f"after {after} s: a\\x1b[31m: step {step}, 1 contact point changing, imbalance 5.0e-01"
        for after, step in ((61, 2), (125, 5))
    ]
