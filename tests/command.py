"""The command line, run within the tests."""

from pathlib import Path

from typer.testing import CliRunner, Result

from signorini.cli import app


def run(*arguments: str | float | Path) -> Result:
    """Run it."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])
