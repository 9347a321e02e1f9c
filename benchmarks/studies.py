"""A study of rafts with random soil, load and thickness: workers, kills, and the price of separate solves.

Every run is a process of its own, `signorini study` or `signorini solve`. Separate solves are measured on some variants
and scaled to all. While the last study runs, random workers are killed, and its table must be equal to the bit.

    python benchmarks/studies.py [--variants 1000] [--separate 20] [--kills 10]
    python benchmarks/studies.py --check      40 variants, correctness only
"""

import argparse
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import pyarrow.parquet as pq

from signorini.studies.studyfile import load_study

COMMAND = [sys.executable, "-c", "from signorini_command import main; main()"]
ONE_THREAD = os.environ | {"RAYON_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}

RAFT = """
units = { length = "m", force = "kN" }
material = { E = 30e6, nu = 0.2, unit_weight = 25 }
plate = { shape = "rectangle", size = [12, 8], thickness = 0.6 }
mesh = { size = 0.5 }
support = [{ name = "soil", area = "all", resists = "down", stiffness = 20e3 }]
load = [{ self_weight = true }, { force = 1200, at = [1.5, 1.5] }, { force = 1500, at = [10.5, 6.5] }]
check = [{ name = "bearing", of = "soil.max_pressure", limit = 200 }]
"""
STUDY = """
template = "raft.toml"
results = ["soil.max_pressure", "deflection.max", "check:bearing.utilisation"]
samples = {variants}
[parameters]
"support.soil.stiffness" = {{ lognormal = [20e3, 5e3] }}
"load[2].force" = {{ gumbel = [1200, 150] }}
"plate.thickness" = {{ uniform = [0.5, 0.7] }}
"""


def timed(directory, *arguments, kills=0):
    """Run the command; return its duration and the processor time, in seconds."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    process = subprocess.Popen([*COMMAND, *arguments], cwd=directory, env=ONE_THREAD, stdout=subprocess.DEVNULL)
    killed = kill(process, kills) if kills else None
    if process.wait():
        sys.exit(f"{' '.join(arguments)} failed")
    if killed is not None:
        killed.join()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.perf_counter() - begun, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def kill(process, kills):
    """Kill random workers of a running study, one a second."""

    def run():
        choose, left = random.Random(1), kills
        while left and process.poll() is None:
            time.sleep(1.0)
            tasks = Path(f"/proc/{process.pid}/task").iterdir()
            workers = [int(child) for task in tasks for child in read(task / "children")]
            if workers:
                os.kill(choose.choice(workers), signal.SIGKILL)
                left -= 1
        if left:
            sys.exit(f"The study ended before {left} of {kills} kills; take more variants.")

    thread = threading.Thread(target=run)
    thread.start()
    return thread


def read(file):
    """Words of a file; none if its process has ended."""
    try:
        return file.read_text().split()
    except OSError:
        return []


def main():
    """Print a line for each run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--variants", type=int, default=1000)
    parser.add_argument("--separate", type=int, default=20)
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--check", action="store_true")
    asked = parser.parse_args()
    if asked.check:
        asked.variants, asked.separate, asked.kills = 40, 1, 2
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        (directory / "raft.toml").write_text(RAFT)
        (directory / "study.toml").write_text(STUDY.format(variants=asked.variants))
        plan = load_study(directory / "study.toml")
        chosen = range(0, asked.variants, asked.variants // asked.separate)
        separate = []
        for number in chosen:
            (directory / "one.toml").write_text(plan.variant(number).model.to_toml())
            separate.append(timed(directory, "solve", "one.toml", "--pictures", "none"))
        alone, processor = (sum(times) / len(separate) * asked.variants for times in zip(*separate, strict=True))
        print(f"separate solves          {alone:8.1f} s {processor:8.1f} s of processor time, from {len(separate)}")
        tables = {}
        for words, workers, kills in (("one worker", 1, 0), ("two workers", 2, 0), ("two, killed", 2, asked.kills)):
            output = words.replace(", ", "-").replace(" ", "-")
            spent, used = timed(directory, "study", "study.toml", "--workers", str(workers), "-o", output, kills=kills)
            tables[words] = pq.read_table(directory / output / "study.parquet")
            ratio = f"{used / processor:.2f} of separate solves in processor time, {spent / alone:.2f} elapsed"
            print(f"{words:24} {spent:8.1f} s {used:8.1f} s of processor time; {ratio}", flush=True)
        first = tables["one worker"]
        assert first.num_rows == asked.variants and set(first["status"].to_pylist()) == {"solved"}
        for words, table in tables.items():
            assert table.equals(first), words
    print("The tables are equal to the bit.")


if __name__ == "__main__":
    main()
