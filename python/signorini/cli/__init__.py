"""The command line: solve, check, path, report, verify, study, validate, import-dxf, schema, explain."""

from signorini.cli.commands import app, main

__all__ = ["app", "main"]
