"""Write the checks of results: as the key "checks" of results.json, and as the file checks.csv."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from signorini.analysis.checks import check_results
from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.output.names import CHECKS, csv_text, name_cell

_COLUMNS = (
    *("name", "of", "value", "limit", "utilisation", "plus_minus", "governing", "place", "x", "y"),
    *("without_equilibrium", "verdict"),
)


def checks_json(results: Results, estimates: Estimates | None) -> list[dict[str, Any]]:
    """Return the value of the key "checks" of results.json."""
    each = (asdict(one) for one in check_results(results, estimates))
    return [one | {"place": list(one["place"]) if isinstance(one["place"], tuple) else one["place"]} for one in each]


def write_checks(results: Results, estimates: Estimates | None, directory: Path) -> None:
    """Write checks.csv if there are checks: a row each, with the position x, y of the extreme of a field."""
    rows = []
    for one in check_results(results, estimates):
        x, y = one.place if isinstance(one.place, tuple) else (None, None)
        texts = {key: name_cell(text) for key, text in asdict(one).items() if isinstance(text, str)}
        rows.append(asdict(one) | {"place": None, "x": x, "y": y} | texts)
    if rows:
        (directory / CHECKS).write_text(csv_text(_COLUMNS, rows), encoding="utf-8")
