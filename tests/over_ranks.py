"""Solve input files over the ranks of mpiexec: over_ranks.py DIRECTORY FILE …; writes DIRECTORY/<name>.json."""

import json
import sys
from pathlib import Path

from signorini import load
from signorini.mpi.engine import Engine
from signorini.output import results_json

directory, files = Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]]
engine = Engine()
if engine.ranks.rank:
    engine.ranks.serve()
else:
    try:
        for file in files:
            values = results_json(engine.solve(load(file), lambda progress: None))
            (directory / f"{file.stem}.json").write_text(json.dumps(values))
    finally:
        engine.ranks.end()
