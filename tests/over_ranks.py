"""Solve input files over the ranks of mpiexec: over_ranks.py DIRECTORY FILE …; writes DIRECTORY/<name>.json."""

import json
import sys
from pathlib import Path

from signorini import load
from signorini.output import results_json


def main(directory: Path, files: list[Path]) -> None:
    from signorini.mpi.engine import Engine

    engine = Engine()
    if engine.ranks.rank:
        engine.ranks.serve()
        return
    try:
        for file in files:
            values = results_json(engine.solve(load(file), lambda progress: None))
            (directory / f"{file.stem}.json").write_text(json.dumps(values))
    finally:
        engine.ranks.end()


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
