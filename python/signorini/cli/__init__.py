"""The command line: solve, check, path, import-dxf, schema."""

from signorini.cli.commands import app, main

__all__ = ["app", "main"]
