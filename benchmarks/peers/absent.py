"""End a script whose program is not installed. This module imports no package, so that every Python can run it."""

import sys

MISSING = 3
"""Exit code of a script whose program is not installed."""


def missing(package: str) -> None:
    """End with the exit code `MISSING` and a message."""
    print(f"{package} is not installed.", file=sys.stderr)
    sys.exit(MISSING)
