"""Studies: the same rows from any workers, killed or not; designs; sensitivities; probabilities by closed forms."""

import math
import os
import signal
import subprocess
import sys
import threading
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from scipy.stats import lognorm
from typer.testing import CliRunner

from signorini import Model, solve, study
from signorini.base.reuse import Reuse
from signorini.cli import app
from signorini.errors import InputError, SignoriniError
from signorini.model import validate
from signorini.studies import variant
from signorini.studies.parameters import Parameter, place_of, variants
from signorini.studies.store import TABLE
from signorini.studies.study import Plan
from signorini.studies.workers import WorkerDiedError, Workers

TEMPLATE = """
material = { E = 30e9, nu = 0.2 }
plate = { shape = "rectangle", size = [4, 3], thickness = 0.5 }
mesh = { divisions = [4, 4], error = false }
support = [{ name = "soil", area = "all", resists = "down", stiffness = 2e7 }]
load = [{ pressure = 5e3 }, { at = [3.5, 1.5], force = 60e3 }]
check = [{ name = "bearing", of = "soil.max_pressure", limit = 20e3 }]
"""
PADS = {"name": "pads", "at": [[0.5, 0.5], [3.5, 2.5]], "resists": "down", "stiffness": 2e8, "limit": 5e4}
STUDY = """
template = "raft.toml"
results = ["soil.max_pressure", "check:bearing.utilisation"]
samples = 40
[parameters]
"support.soil.stiffness" = { lognormal = [2e7, 4e6] }
"load[2].force" = { normal = [60e3, 15e3] }
"plate.thickness" = [0.4, 0.5]
"""


@pytest.fixture
def place(tmp_path: Path) -> Path:
    (tmp_path / "raft.toml").write_text(TEMPLATE)
    (tmp_path / "study.toml").write_text(STUDY)
    return tmp_path


def table(file: Path) -> list[dict[str, object]]:
    """Rows of a table; NaN as None, so that equal rows are equal."""
    rows = pq.read_table(file).to_pylist()
    return [{name: None if value != value else value for name, value in row.items()} for row in rows]


def command(place: Path, *options: str) -> list[str]:
    code = "from signorini_command import main; main()"
    return [sys.executable, "-c", code, "study", str(place / "study.toml"), *options]


def test_a_row_has_the_numbers_of_its_model_solved_alone(place: Path) -> None:
    forces = [20e3, 60e3, 250e3]
    found = study(place / "raft.toml", {"load[2].force": forces}, ["soil.max_pressure", "deflection.max"])
    for row, force in zip(found.rows, forces, strict=True):
        tables = Model.model_validate(variant.Variant(**_variant(place, force)).model.model_dump()).model_dump()
        result = solve(Model(**tables))["all"]
        assert row["soil.max_pressure"] == result.supports["soil"].max_pressure
        assert row["status"] == "solved" and row["certificate"] <= 1e-8


def _variant(place: Path, force: float) -> dict[str, object]:
    from signorini import load

    text = load(place / "raft.toml").provenance.text
    return {
        "number": 0,
        "program": variant.program(),
        "template": text,
        "places": (("load", 1, "force"),),
        "names": ("load[2].force",),
        "values": (force,),
        "results": (),
    }


def test_killed_workers_and_shards_change_no_bit_of_the_table(place: Path) -> None:
    assert subprocess.run(command(place, "-o", str(place / "one"), "--workers", "1")).returncode == 0
    expected = table(place / "one" / TABLE)
    assert [row["row"] for row in expected] == list(range(40))
    for number in (2, 1):
        subprocess.run(command(place, "-o", str(place / "parts"), "--shard", f"{number}/2"), check=True)
    assert table(place / "parts" / TABLE) == expected

    running = subprocess.Popen(command(place, "-o", str(place / "killed"), "--workers", "2"))
    random = np.random.default_rng(1)
    for _ in range(4):
        time.sleep(float(random.uniform(0.3, 1.0)))
        children = subprocess.run(["pgrep", "-P", str(running.pid)], capture_output=True, text=True).stdout.split()
        for child in children[:1]:
            os.kill(int(child), signal.SIGKILL)
    assert running.wait() == 0
    assert table(place / "killed" / TABLE) == expected


def test_a_killed_study_goes_on_and_keeps_its_rows(place: Path) -> None:
    first = subprocess.Popen(command(place, "-o", str(place / "out"), "--workers", "1"))
    parts = place / "out" / "study-rows"
    while first.poll() is None and not list(parts.glob("*.parquet")):
        time.sleep(0.05)
    first.kill()
    first.wait()
    kept = sum(len(table(file)) for file in parts.glob("*.parquet"))
    assert 0 < kept < 40
    done = []
    study(place / "raft.toml", *_asked(), samples=40, output=place / "out", progress=lambda now: done.append(now.done))
    assert done[0] == kept + 1 and done[-1] == 40
    again: list[object] = []
    study(place / "raft.toml", *_asked(), samples=40, output=place / "out", progress=again.append)
    assert not again
    with pytest.raises(InputError, match="another study"):
        study(place / "raft.toml", *_asked(), samples=41, output=place / "out")


def _asked() -> tuple[dict[str, object], list[str]]:
    parameters: dict[str, object] = {
        "support.soil.stiffness": {"lognormal": [2e7, 4e6]},
        "load[2].force": {"normal": [60e3, 15e3]},
        "plate.thickness": [0.4, 0.5],
    }
    return parameters, ["soil.max_pressure", "check:bearing.utilisation"]


@pytest.mark.parametrize(
    "parameters",
    [
        {"load[2].force": [60e3, 61e3, 62e3, 250e3]},
        {"support.soil.stiffness": [2e7, 3e7, 2e7, 4e7]},
        {"support.pads.stiffness": [2e8, 3e8, 2e8, 4e8], "support.pads.gap": [0.0, 1e-4, 2e-4, 0.0]},
        {"support.pads.limit": [1e4, 2e4, 3e4, 1e3]},
        {"support.soil.resists": ["down", "both", "down", "down"]},
        {"plate.thickness": [0.5, 0.6, 0.5, 0.5]},
        {"plate.size[1]": [4.0, 5.0, 4.0, 4.0]},
    ],
    ids=lambda parameters: next(iter(parameters)),
)
def test_rows_are_those_of_variants_solved_without_reuse(
    parameters: dict[str, list[object]], monkeypatch: pytest.MonkeyPatch
) -> None:
    tables = tomllib.loads(TEMPLATE)
    tables["support"].append(PADS)
    plan = Plan.of(
        validate(tables), parameters, ["soil.max_pressure", "pads.reaction", "deflection.max"], Path(), "list", None, 0
    )
    reused = [variant.solved(plan.variant(number)) for number in range(4)]
    for number, row in enumerate(reused):
        monkeypatch.setattr(variant, "_REUSE", Reuse())
        assert variant.solved(plan.variant(number)) == row and row["status"] == "solved"


def test_a_study_that_cannot_be_written_is_refused_before_its_variants_are_solved(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("signorini.studies.study.run", None)
    taken, other = place / "taken", place / "other"
    taken.touch()
    other.mkdir()
    (other / "study.json").write_text("{}")
    for directory, why in ((taken, "Not a directory"), (other, "study.json exists")):
        done = CliRunner().invoke(app, ["study", str(place / "study.toml"), "-o", str(directory)])
        assert done.exit_code == 2
        assert f"{directory}: the results cannot be written there: {why}" in done.stderr
    assert (other / "study.json").read_text() == "{}"


def test_a_variant_without_answer_is_a_row_with_its_reason(place: Path) -> None:
    found = study(
        place / "raft.toml", {"load[2].at": [[3.5, 1.5], [5.0, 1.5]], "plate.thickness": [0.4, -1]}, ["soil.reaction"]
    )
    assert [row["status"] for row in found.rows] == ["solved", "refused", "refused", "refused"]
    assert "thickness" in found.rows[1]["message"]
    lifted = study(place / "raft.toml", {"load[1].pressure": [5e3, -9e3]}, ["soil.reaction"])
    assert [row["status"] for row in lifted.rows] == ["solved", "no_equilibrium"]
    assert math.isnan(lifted["soil.reaction"][1])


def test_a_call_that_ends_every_process_is_an_error() -> None:
    with Workers(1) as workers, pytest.raises(WorkerDiedError):
        workers.submit(os._exit, 3).result()


def test_the_settlement_of_a_rigid_footing_on_random_soil(tmp_path: Path) -> None:
    """w = F/(k A) exceeds its limit where k < F/(A w): the lognormal distribution gives the probability."""
    tables = {
        "material": {"E": 30e12, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [2, 2], "thickness": 0.5},
        "mesh": {"divisions": [2, 2], "error": False},
        "support": [{"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7}],
        "load": [{"pressure": 200e3}],
        "check": [{"name": "settlement", "of": "deflection", "limit": 0.0125}],
    }
    found = study(
        Model(**tables),
        {"support.soil.stiffness": {"lognormal": [2e7, 5e6]}},
        ["check:settlement.utilisation"],
        samples=200,
    )
    spread = math.log1p(0.25**2)
    exact = lognorm(math.sqrt(spread), scale=2e7 * math.exp(-0.5 * spread)).cdf(200e3 / 0.0125)
    probability = found.failure_probability("check:settlement.utilisation")
    # In one dimension a Latin hypercube has one variant in each range of probability 1/n.
    assert abs(probability.value - exact) <= 1.0 / 200
    assert probability.interval[0] < exact < probability.interval[1]
    assert found.sensitivities("check:settlement.utilisation")["support.soil.stiffness"] > 0.9


def test_reliability_of_a_rigid_footing_with_eccentric_load_on_random_soil() -> None:
    """Largest settlement 2N/(3(B/2 − e) L k) beyond the kern, else N/(B L k) (1 + 6e/B), against 100,000 samples."""
    width, length, limit, samples = 3.0, 2.0, 0.0125, 400
    parameters: dict[str, object] = {
        "load[1].force": {"gumbel": [600e3, 90e3]},
        "load[1].at[1]": {"normal": [1.8, 0.25]},
        "support.soil.stiffness": {"lognormal": [2e7, 5e6]},
    }
    model = Model(
        material={"E": 30e12, "nu": 0.2},
        plate={"shape": "rectangle", "size": [width, length], "thickness": 0.5},
        mesh={"divisions": [12, 2], "error": False},
        support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7}],
        load=[{"at": [1.8, length / 2], "force": 600e3}],
        check=[{"name": "settlement", "of": "deflection", "limit": limit}],
    )
    found = study(model, parameters, ["check:settlement.utilisation"], samples=samples, seed=2)

    def utilisation(columns: list[np.ndarray]) -> np.ndarray:
        force, at, stiffness = columns
        pressure, e = force / (width * length), np.abs(at - width / 2)
        ratio = np.where(e <= width / 6, 1 + 6 * e / width, 4 * width / (3 * np.maximum(width - 2 * e, 1e-9)))
        return pressure * ratio / stiffness / limit

    solved = np.array([row["status"] == "solved" for row in found.rows])
    # Beyond e = B/3 the contact is narrower than half the footing, a few elements of this mesh.
    compared = solved & (np.abs(found["load[1].at[1]"] - width / 2) <= width / 3)
    assert solved.mean() > 0.99 and compared.mean() > 0.95
    chosen = utilisation([found[name] for name in parameters])
    assert found["check:settlement.utilisation"][compared] == pytest.approx(chosen[compared], rel=0.01)
    random = np.random.default_rng(1).random((3, 100_000))
    each = [Parameter.of(name, given, Path()) for name, given in parameters.items()]
    exact = np.mean(utilisation([np.array(one.at(row)) for one, row in zip(each, random, strict=True)]) > 1)
    low, high = found.failure_probability("check:settlement.utilisation").interval
    assert low < exact < high and 0.02 < exact < 0.98


def test_first_order_sensitivities_of_a_sum() -> None:
    """y = 3 a + b with independent a, b of equal variance: indices 0.9 and 0.1."""
    from signorini.studies.summary import Study

    values = variants([Parameter.of(name, {"normal": [0, 1]}, Path()) for name in "ab"], "latin", 2000, 3)
    rows = tuple({"a": a, "b": b, "y": 3 * a + b, "status": "solved"} for a, b in values)
    found = Study(rows, ("a", "b"), ("y",), 2000, True).sensitivities("y")
    assert found["a"] == pytest.approx(0.9, abs=0.03) and found["b"] == pytest.approx(0.1, abs=0.03)


@pytest.mark.parametrize("family", ["normal", "lognormal", "gumbel"])
def test_distributions_have_their_mean_and_deviation(family: str) -> None:
    one = Parameter.of("x", {family: [5.0, 1.0]}, Path())
    values = np.array(one.at((np.arange(100_000) + 0.5) / 100_000))
    assert values.mean() == pytest.approx(5.0, rel=1e-4) and values.std() == pytest.approx(1.0, rel=2e-3)


def test_values_from_a_table(place: Path) -> None:
    (place / "values.csv").write_text("load[2].force,plate.thickness\n1e4,0.4\n2e4,0.5\n")
    listed = {name: {"file": "values.csv"} for name in ("load[2].force", "plate.thickness")}
    found = study(place / "raft.toml", listed, ["soil.reaction"], design="list")
    assert found["soil.reaction"].tolist() == pytest.approx([70e3, 80e3])


@pytest.mark.parametrize(
    ("path", "named"),
    [
        ("support.soli.stiffness", "soli"),
        ("support.soil.stiffnes", "stiffnes"),
        ("load[3].force", "3"),
        ("plate", "whole table"),
        ("plate.thickness.x", "x"),
        ("..", "path"),
    ],
)
def test_a_wrong_path_is_refused_with_its_line(place: Path, path: str, named: str) -> None:
    text = STUDY.replace("plate.thickness", path)
    (place / "study.toml").write_text(text)
    done = CliRunner().invoke(app, ["study", str(place / "study.toml")])
    line = text[: text.index(f'"{path}" =')].count("\n") + 1
    assert done.exit_code == 2 and f"study.toml:{line}" in done.output and named in done.output
    assert not (place / "study-study").exists()


@pytest.mark.parametrize(
    "keys",
    [
        {"design": "grid"},
        {"samples": 0},
        {"results": ["soil.presure"]},
        {"parameters": {}},
        {"parameters": {"plate.thickness": {"normal": [1.0, -1.0]}}},
        {"parameters": {"plate.thickness": {"file": "missing.csv"}}},
        {"parameters": {"plate.thickness": [0.4]}, "samples": 5, "design": "list"},
    ],
)
def test_wrong_keys_are_refused(place: Path, keys: dict[str, object]) -> None:
    parameters, results = _asked()
    whole: dict[str, object] = {"parameters": parameters, "results": results, "samples": 40, **keys}
    with pytest.raises(InputError):
        study(place / "raft.toml", **whole)  # type: ignore[arg-type]


def test_names_with_dots_are_quoted() -> None:
    tables = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [4, 3], "thickness": 0.5},
        "support": [{"name": "a.b", "edge": "left", "fix": "clamped"}],
        "load": [{"pressure": 1e3}],
    }
    assert place_of('support."a.b".settlement', Model(**tables), tables) == ("support", 0, "settlement")


class OfAnotherVersion(ThreadPoolExecutor):
    """Its worker finds that the study is of another version."""

    def submit(self, function, one):  # type: ignore[override]
        return super().submit(function, replace(one, program="0.0.0"))


def test_a_worker_of_another_version_is_refused(place: Path) -> None:
    with OfAnotherVersion(1) as executor, pytest.raises(SignoriniError, match="version"):
        study(place / "raft.toml", {"plate.thickness": [0.4]}, ["soil.reaction"], executor)


class TestDask:
    """A scheduler and two workers in processes of their own, on this machine."""

    @pytest.fixture
    def cluster(self, tmp_path: Path):
        distributed = pytest.importorskip("distributed")
        running: dict[str, subprocess.Popen[bytes]] = {}
        environment = {**os.environ, "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "3s"}
        port = _free_port()

        def start(name: str, *options: str) -> None:
            kind = "scheduler" if name == "scheduler" else "worker"
            arguments = [sys.executable, "-m", "distributed.cli.dask_" + kind, *options, "--no-dashboard"]
            running[name] = subprocess.Popen(arguments, env=environment, cwd=tmp_path, stderr=subprocess.DEVNULL)

        address = f"tcp://127.0.0.1:{port}"

        def start_all() -> None:
            start("scheduler", "--host", "127.0.0.1", "--port", str(port))
            for name in ("first", "second"):
                start(name, address, "--nthreads", "1", "--no-nanny")

        start_all()
        client = distributed.Client(address, timeout=60, set_as_default=False)
        client.wait_for_workers(2, timeout=60)
        yield client, running, start_all
        client.close(timeout=1)
        for process in running.values():
            process.kill()
            process.wait()

    def test_a_worker_that_dies_changes_nothing(self, place: Path, cluster) -> None:
        client, running, _ = cluster
        expected = study(place / "raft.toml", *_asked(), samples=40)
        killed = threading.Event()

        def kill(now) -> None:
            if now.done >= 5 and not killed.is_set():
                running["first"].kill()
                killed.set()

        found = study(place / "raft.toml", *_asked(), client.get_executor(pure=False), samples=40, progress=kill)
        assert killed.is_set() and repr(found.rows) == repr(expected.rows)

    def test_a_scheduler_that_restarts_changes_nothing(self, place: Path, cluster) -> None:
        client, running, start_all = cluster
        expected = study(place / "raft.toml", *_asked(), samples=40)
        restarted = threading.Event()

        def restart(now) -> None:
            if now.done >= 5 and not restarted.is_set():
                for process in running.values():
                    process.kill()
                    process.wait()
                start_all()
                restarted.set()

        found = study(place / "raft.toml", *_asked(), client.get_executor(pure=False), samples=40, progress=restart)
        assert restarted.is_set() and repr(found.rows) == repr(expected.rows)


def _free_port() -> int:
    import socket

    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


@pytest.mark.parametrize(
    "paths",
    [("support.soil.stiffness", "support[1].stiffness"), ("load[2].at", "load[2].at[1]")],
    ids=lambda each: each[0],
)
def test_two_parameters_at_one_place_are_refused(place: Path, paths: tuple[str, str]) -> None:
    for first, second in (paths, paths[::-1]):
        with pytest.raises(InputError, match="sets"):
            study(place / "raft.toml", {first: [[3.0, 1.5]], second: [3.0]}, ["soil.reaction"])
