"""Write the pictures and the summary of a study beside its table."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from signorini.base.files import replacing_together
from signorini.output.directory import former_study
from signorini.output.names import STUDY, unique_slugs
from signorini.studies.store import TABLE
from signorini.studies.study import Plan
from signorini.studies.summary import Study


def write_study(study: Study, directory: Path, plan: Plan) -> list[Path]:
    """Write study.json and a picture of each result; return the paths of all files of the study.

    These files replace the files of an earlier study in the directory; files of other programs stay.
    """
    from signorini.plot.files import save
    from signorini.plot.studies import study_picture

    written = [directory / TABLE] if len(study.rows) == study.count else []
    metadata, units = plan.template.provenance.metadata, plan.units
    summary = {**plan.template.provenance.json({}), "study_sha256": plan.sha256, "results": _summary(study)}
    with replacing_together(directory, former_study, STUDY, plan.template.provenance.read) as beside:
        (beside / STUDY).write_text(json.dumps(summary, indent=1, ensure_ascii=False), "utf-8")
        written.append(directory / STUDY)
        for name, slug in zip(study.results, unique_slugs(study.results), strict=True):
            used = study.solved & np.isfinite(study[name])
            if used.any():
                rows = [row for row, use in zip(study.rows, used, strict=True) if use]
                columns = {each: [row[each] for row in rows] for each in study.parameters}
                figure = study_picture(
                    name,
                    study[name][used],
                    {each: _positions(values) for each, values in columns.items()},
                    study.quantiles(name),
                    study.sensitivities(name),
                    units,
                    1.0 if name.endswith(".utilisation") else None,
                )
                save(figure, beside / f"{slug}.png", metadata)
                written.append(directory / f"{slug}.png")
    return written


def _positions(values: list[Any]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return the values of a parameter as numbers (n,); distinct texts and lists are numbered as they first occur."""
    if all(isinstance(value, int | float) for value in values):
        return np.array(values, np.float64)
    order = {text: float(index) for index, text in enumerate(dict.fromkeys(map(repr, values)))}
    return np.array([order[repr(value)] for value in values])


def _summary(study: Study) -> list[dict[str, Any]]:
    result = []
    for name in study.results:
        own: dict[str, Any] = {
            "name": name,
            "quantiles": study.quantiles(name),
            "sensitivities": study.sensitivities(name),
        }
        own = {key: _known(value) if isinstance(value, dict) else value for key, value in own.items()}
        if study.random and name.endswith(".utilisation"):
            found = study.failure_probability(name)
            own["failure"] = {
                "failed": found.failed,
                "variants": found.count,
                "interval_95": list(found.interval),
                "failed_with_plus_minus": [found.certain, found.possible],
            }
        result.append(own)
    return result


def _known(values: dict[Any, float]) -> dict[str, float | None]:
    return {str(key): value if math.isfinite(value) else None for key, value in values.items()}
