"""The command line: solve, check, path, schema."""

from signorini.cli.commands import app, main

__all__ = ["app", "main"]
