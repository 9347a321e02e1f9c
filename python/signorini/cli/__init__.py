"""The command line: solve, check, path, report, study, validate, import-dxf, schema."""

from signorini.cli.commands import app, main

__all__ = ["app", "main"]
