"""Read a study from a TOML file."""

from __future__ import annotations

import functools
import os
from pathlib import Path

from signorini.errors import InputError
from signorini.formats.inputfile import load, parsed, with_line
from signorini.formats.toml import Lines
from signorini.model.study import validate_study
from signorini.studies.study import Plan


def load_study(path: str | os.PathLike[str]) -> Plan:
    """Read a study file and its template; return the plan of the study.

    Raises
    ------
    InputError
        If a file cannot be read or is invalid; the message has the line.
    """
    data, text = parsed(path)
    lines = functools.cache(lambda: Lines(text))
    own = validate_study(data, os.path.basename(path), lambda place: lines().of(place))
    directory = Path(path).parent
    template = load(directory / own.template)
    try:
        return Plan.of(template, own.parameters, own.results, directory, own.design, own.samples, own.seed)
    except InputError as error:
        raise with_line(error, path) from None
