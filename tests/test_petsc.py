"""The engine petsc: equal to the embedded engine on any number of ranks; its files; a rank that dies; refused input.

Ranks run in the environment that .ci/petsc makes; without it their tests are skipped.
"""

import json
import os
import shutil
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from command import run

from signorini import Model, load, solve
from signorini.contact.certificate import FIGURES, certify
from signorini.contact.problem import contact_problem
from signorini.discretise import discretise
from signorini.mpi.certificate import errors
from signorini.mpi.newton import Problem, Solution
from signorini.mpi.parts import Division, parts_of
from signorini.output import results_json

ROOT = Path(__file__).parents[1]
PYTHON = Path(os.environ.get("SIGNORINI_PETSC", ROOT / ".venv-petsc")) / "bin" / "python"
on_ranks = pytest.mark.skipif(
    not (PYTHON.exists() and shutil.which("mpiexec")), reason="PETSc is not installed: run .ci/petsc"
)
SLAB = """
material = { E = 30e9, nu = 0.2 }
plate = { shape = "rectangle", size = [10, 10], thickness = 0.3 }
load = [{ pressure = 2e3 }, { at = [1, 1], patch = [1, 1], force = 500e3 }]
"""
ROWS = (0.5, 3.5, 6.5, 9.5)
PADS = f"support = [{{ name = 'pads', at = {[[x, y] for y in ROWS for x in ROWS]}, resists = 'down'"
SOIL = "support = [{ name = 'soil', area = 'all', stiffness = 30e6, resists = 'down' }]"
FLOOR = """
material = { E = 30e9, nu = 0.2 }
plate = { shape = "polygon", points = [[0, 0], [6, 0], [5, 4], [0, 4]], thickness = "0.2 + 0.01*x" }
mesh = { size = 0.4, error = false }
zone = [{ area = { rectangle = [1.1, 1.1, 2.3, 2.3] }, thickness = 0.4, material = { E = 20e9, nu = 0.1 } }]
support = [
  { name = "wall", edge = ["edge 4"], resists = "down" },
  { name = "oblique", edge = ["edge 2"], fix = "clamped", settlement = 2e-4 },
  { name = "beam", line = [[0, 2.1], [5.4, 2.1]], resists = "down", gap = 1e-4 },
  { name = "block", area = { rectangle = [3, 0.5, 3.6, 1.1] }, stiffness = 1e13, resists = "down" },
  { name = "spring", at = [1.3, 3.3], stiffness = 3e7 },
]
load = [
  { case = "G", pressure = 5e3 }, { case = "G", area = { circle = { center = [2, 3], radius = 0.5 } }, pressure = 1e4 },
  { case = "Q", force = -3e4, at = [4.1, 3.1] },
]
combination = [
  { name = "down", factors = { G = 1.35 } }, { name = "up", factors = { G = 0.9, Q = 2.5 } },
]
"""
COVER = """
material = { E = 30e9, nu = 0.2 }
plate = { shape = "disc", radius = 3, thickness = 0.1 }
mesh = { size = 0.4, error = false }
support = [
  { name = "rim", edge = "rim", fix = "clamped", settlement = 1e-3 },
  { name = "block", area = { rectangle = [-0.5, -0.4, 0.6, 0.5] }, resists = "down", gap = 2e-3 },
]
load = [{ pressure = 2e4 }, { force = 1e4, at = [1, 0.7] }]
"""
MODELS = {
    "soil": f"{SLAB}{SOIL}\nmesh = {{ divisions = [32, 32], error = false }}",
    "pads": f"{SLAB}{PADS} }}]\nmesh = {{ divisions = [20, 20], error = false }}",
    "gaps": f"{SLAB}{PADS}, gap = 1e-3 }}]\nmesh = {{ divisions = [20, 20], error = false }}",
    "thin": f"{SLAB}{SOIL}\nmesh = {{ divisions = [20, 20], error = false }}".replace("0.3", "0.01"),
    "floor": FLOOR,
    "cover": COVER,
}


def over(ranks: int, *arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run the environment's Python on a number of ranks."""
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS"), "1")
    as_root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    command = ["mpiexec", "--oversubscribe", "-n", str(ranks), str(PYTHON), *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, **threads, **as_root}, cwd=cwd, timeout=300
    )


def leaves(values: Any, path: tuple[object, ...] = ()) -> Iterator[tuple[tuple[object, ...], Any]]:
    """Yield every leaf of a tree with its path."""
    if isinstance(values, dict | list):
        for key, value in values.items() if isinstance(values, dict) else enumerate(values):
            yield from leaves(value, (*path, key))
    else:
        yield path, values


def assert_same(found: Any, expected: Any) -> None:
    """Compare results: the same keys and words, numbers to 1e-9 of the largest of their kind."""
    ours, theirs = dict(leaves(found["combinations"])), dict(leaves(expected["combinations"]))
    largest: dict[object, float] = defaultdict(float)

    def kind(path: tuple[object, ...]) -> tuple[object, ...]:
        return tuple(key for key in path if isinstance(key, str) and key not in ("min", "max"))

    for path, value in theirs.items():
        if isinstance(value, float):
            largest[kind(path)] = max(largest[kind(path)], abs(value))
    assert ours.keys() == theirs.keys()
    for path, value in theirs.items():
        if "certificate" in path or path[-1] in ("method", "iterations"):
            continue
        if isinstance(value, float):
            assert abs(ours[path] - value) <= 1e-9 * largest[kind(path)], (path, ours[path], value)
        else:
            assert ours[path] == value, path
    assert all(combination["certificate"]["passed"] for combination in found["combinations"])


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    directory = tmp_path_factory.mktemp("models")
    for name, text in MODELS.items():
        (directory / f"{name}.toml").write_text(text)
    return [directory / f"{name}.toml" for name in MODELS]


@pytest.fixture(scope="module")
def embedded(files: list[Path]) -> dict[str, Any]:
    """Results of the embedded engine by name of the model, as a JSON file has them."""
    return {file.stem: json.loads(json.dumps(results_json(solve(load(file))))) for file in files}


@on_ranks
@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_equals_embedded(ranks: int, files: list[Path], embedded: dict[str, Any], tmp_path: Path) -> None:
    done = over(ranks, ROOT / "tests" / "over_ranks.py", tmp_path, *files)
    assert done.returncode == 0, done.stderr
    for name, expected in embedded.items():
        assert_same(json.loads((tmp_path / f"{name}.json").read_text()), expected)
    soil, pads = (json.loads((tmp_path / f"{name}.json").read_text())["combinations"][0] for name in ("soil", "pads"))
    # The converged values that other programs agree on.
    assert soil["deflection"]["max"] == pytest.approx(4.229e-3, rel=5e-4)
    assert soil["deflection"]["min"] == pytest.approx(-14.75e-6, rel=0.03)
    assert soil["supports"][0]["max_pressure"] == pytest.approx(126.86e3, rel=5e-4)
    assert soil["supports"][0]["contact_area"] == pytest.approx(91.6, abs=0.2)
    reactions = [point["reaction"] for point in pads["supports"][0]["points"]]
    lifted = [number for number, reaction in enumerate(reactions) if reaction == 0.0]
    assert lifted == [2, 8]
    assert reactions[:2] == pytest.approx([333.96e3, 93.67e3], rel=0.01)


@on_ranks
def test_files(tmp_path: Path) -> None:
    """The command writes a piece of the fields for each rank, which together are those of the embedded engine."""
    file = tmp_path / "floor.toml"
    file.write_text(FLOOR.replace(", error = false", ""))
    done = over(3, "-m", "signorini", "solve", file, "--engine", "petsc", "--pictures", "none")
    assert done.returncode == 0, done.stderr
    assert run("solve", file, "--pictures", "none", "-o", tmp_path / "embedded").exit_code == 0
    directory = tmp_path / "floor-results"
    values = json.loads((directory / "results.json").read_text())
    assert_same(values, json.loads((tmp_path / "embedded" / "results.json").read_text()))
    assert sorted(entry["file"] for entry in values["files"]) == sorted(path.name for path in directory.iterdir())
    assert values["options"]["ranks"] == 3
    listed = (directory / "up.pvtu").read_text()
    whole = meshio.read(tmp_path / "embedded" / "up.vtu")
    pieces = [meshio.read(directory / f"up.{rank}.vtu") for rank in range(3)]
    assert sum(len(block.data) for piece in pieces for block in piece.cells) == sum(map(len, whole.cells))
    for rank, piece in enumerate(pieces):
        assert f'Source="up.{rank}.vtu"' in listed
        for name, data in whole.point_data.items():
            assert f'Name="{name}"' in listed
            # Nodes at a jump have several values at one place.
            for place, value in zip(piece.points, piece.point_data[name], strict=True):
                there = data[(whole.points == place).all(axis=1)]
                assert np.abs(there - value).reshape(len(there), -1).max(axis=1).min() <= 1e-9 * np.abs(data).max()
    assert run("verify", directory / "results.json").exit_code == 2


@on_ranks
@pytest.mark.parametrize("dead", [0, 1])
def test_rank_dies(dead: int, tmp_path: Path) -> None:
    (tmp_path / "slab.toml").write_text(MODELS["soil"])
    script = ROOT / "tests" / "dying_rank.py"
    done = over(2, script, dead, "solve", "slab.toml", "--engine", "petsc", cwd=tmp_path)
    assert done.returncode != 0
    assert f"rank {dead}" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["slab.toml"]


@on_ranks
def test_no_equilibrium(tmp_path: Path) -> None:
    for pressure in (-4e3, -10e3):
        (tmp_path / "slab.toml").write_text(MODELS["pads"].replace("pressure = 2e3", f"pressure = {pressure}"))
        done = over(2, "-m", "signorini", "solve", tmp_path / "slab.toml", "--engine", "petsc")
        assert done.returncode == 3
        assert "No equilibrium" in done.stderr


@on_ranks
@pytest.mark.parametrize(
    ("change", "key"),
    [
        (("mesh = { divisions = [20, 20], error = false", "mesh = { accuracy = 0.01"), "mesh.accuracy"),
        (("resists = 'down'", "resists = 'down', limit = 1e9"), "support[1]"),
        (("resists = 'down'", "resists = 'down', patch = [0.4, 0.4]"), "support[1]"),
        (("mesh =", "output = { combinations = 'table' }\nmesh ="), "output.combinations"),
        (("mesh =", "solver = { method = 'lemke' }\nmesh ="), "solver.method"),
    ],
)
def test_refused(change: tuple[str, str], key: str, tmp_path: Path) -> None:
    file = tmp_path / "slab.toml"
    file.write_text(MODELS["pads"].replace(*change, 1))
    done = subprocess.run(
        [PYTHON, "-m", "signorini", "solve", file, "--engine", "petsc"], capture_output=True, text=True, timeout=100
    )
    assert done.returncode == 2
    assert key in done.stderr and "--engine embedded" in done.stderr


def test_without_petsc(tmp_path: Path) -> None:
    """The message says how to get the engine; a plain solve does not import it."""
    file = tmp_path / "slab.toml"
    file.write_text(MODELS["pads"].replace("20, 20", "4, 4"))
    plain = (
        "import sys; from signorini.cli import app\n"
        f"try: app(['solve', {str(file)!r}, '--pictures', 'none'])\n"
        "finally: assert not {'signorini.mpi', 'petsc4py', 'mpi4py'} & set(sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", plain], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    blocked = (
        "import sys; sys.modules['petsc4py'] = None\n"
        f"from signorini.cli import app; app(['solve', {str(file)!r}, '--engine', 'petsc'])"
    )
    done = subprocess.run([sys.executable, "-c", blocked], capture_output=True, text=True)
    assert done.returncode == 1
    assert ".ci/petsc" in done.stderr


class OneRank:
    """A communicator of one rank."""

    def allgather(self, value: float) -> list[float]:
        return [value]

    def Allreduce(self, values: np.ndarray, result: np.ndarray) -> None:
        result[...] = values


@pytest.mark.parametrize("ranks", [1, 2, 5])
def test_parts_are_the_whole(ranks: int, tmp_path: Path) -> None:
    """Residuals, travels and forces of supports on the parts are those of the whole plate."""
    (tmp_path / "floor.toml").write_text(FLOOR)
    whole = discretise(load(tmp_path / "floor.toml"))
    case = whole.load(whole.model.effective_combinations[1])
    division, rng = Division.of(whole, ranks), np.random.default_rng(1)
    u, lo, reaction = rng.standard_normal(whole.dof_count), np.zeros(whole.dof_count), rng.random(len(whole.contacts))
    residual = whole.plate.residual(whole.springs.arrays, case.nodal, u, lo)
    pushes, travel = whole.contact_rows.T @ reaction, whole.contact_rows @ u - whole.contacts.distance
    nodes, points = [], []
    for part in parts_of(whole, division, case):
        problem = Problem(part, OneRank())
        dofs = (3 * division.order[part.places][:, None] + np.arange(3)).ravel()
        owned, mine = problem.owned, problem.mine
        scale = np.abs(residual).max()
        assert np.abs(problem.residual(u[dofs], lo[dofs]) - residual[dofs])[owned].max() <= 1e-13 * scale
        assert np.abs(problem.rows.T @ reaction[part.points] - pushes[dofs])[owned].max(initial=0.0) <= 1e-13
        assert np.abs(problem.travel(u[dofs], lo[dofs]) - travel[part.points]).max(initial=0.0) <= 1e-13
        nodes.append(dofs[owned])
        points.append(part.points[mine])
    assert sorted(np.concatenate(nodes)) == list(range(whole.dof_count))
    assert sorted(np.concatenate(points)) == list(range(len(whole.contacts)))


@pytest.mark.parametrize("name", ["soil", "floor", "cover"])
@pytest.mark.parametrize("wrong", [0.0, 1e-6])
def test_errors_are_those_of_certificate(name: str, wrong: float, tmp_path: Path) -> None:
    """The answer is right, or has an error of 1e-6 in displacements and reactions."""
    (tmp_path / "model.toml").write_text(MODELS[name])
    problem = contact_problem(load(tmp_path / "model.toml"))
    whole, rng = problem.discretisation, np.random.default_rng(2)
    case = whole.load(whole.model.effective_combinations[0])
    answer = problem.solve(case)
    hi = answer.hi + wrong * np.abs(answer.hi).max() * rng.standard_normal(len(answer.hi))
    reaction = answer.reaction + wrong * np.abs(answer.reaction).max() * rng.standard_normal(len(answer.reaction))
    expected = certify(whole, case, hi, answer.lo, reaction)
    (part,) = parts_of(whole, division := Division.of(whole, 1), case)
    dofs = (3 * division.order[part.places][:, None] + np.arange(3)).ravel()
    solution = Solution(hi[dofs], answer.lo[dofs], reaction, answer.gap, answer.closed, 1, 1)
    found = errors(Problem(part, OneRank()), solution)
    for figure in FIGURES:
        assert found[figure] == pytest.approx(getattr(expected, figure), rel=1e-9, abs=1e-13)


def test_model_without_file() -> None:
    """A division of more ranks than elements leaves some ranks without elements."""
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        mesh={"divisions": [1, 2]},
        support=[{"edge": "left", "fix": "clamped"}],
        load=[{"pressure": 1e3}],
    )
    whole = discretise(model)
    division = Division.of(whole, 3)
    assert np.bincount(division.owner, minlength=3).tolist() in ([0, 1, 1], [1, 0, 1], [1, 1, 0])
    assert division.firsts[-1] == whole.mesh.node_count
