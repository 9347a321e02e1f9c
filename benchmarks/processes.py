"""Run each benchmark in its own process, so that runs share no caches or memory peaks."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from typing import Any


def peak_mb() -> float:
    """Largest memory of this process up to now [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def run(script: str, *arguments: object, python: str = sys.executable) -> dict[str, Any]:
    """Run a script and return the JSON of its last line of output."""
    done = subprocess.run([python, script, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{script} {' '.join(map(str, arguments))} failed:\n{done.stderr}")
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found
