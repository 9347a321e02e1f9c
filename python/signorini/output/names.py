"""Names of the files of results."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator
from pathlib import Path

from signorini.analysis.solve import Results
from signorini.model import Model
from signorini.output.envelope_json import ENVELOPE, TABLE
from signorini.results.result import Result

JSON, CSV = "results.json", "reactions.csv"
PATH_JSON, PATH_CSV, PATH_PICTURE = "path.json", "path.csv", "path.png"
PRESSURE, MOMENTS, SHEARS = "-pressure", "-moments", "-shears"
"""End the names of pictures other than that of the deflection."""
_ENDINGS = ("", MOMENTS, SHEARS, PRESSURE)
_LONGEST_NAME = 80
_RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?")


def file_names(results: Results) -> list[str]:
    """Name every file of the results."""
    pictures = [ending for ending in _ENDINGS if ending != PRESSURE or has_areas(results)]
    endings = [".vtu", *(f"{ending}.png" for ending in pictures)]
    combined = results.combined
    together = [] if combined is None else [TABLE, *([ENVELOPE] if combined.envelope.fields else [])]
    return [JSON, CSV, *together, *(f"{slug}{ending}" for _, slug in slugs(results) for ending in endings)]


def expected_names(model: Model) -> Iterator[str]:
    """Name files that the results of a model will have as far as it tells: not those of what governs in a table."""
    yield from (JSON, CSV)
    taken: list[str] = []
    names: Iterable[str] = (combination.name for combination in model.effective_combinations)
    if model.tabulated:
        yield TABLE
        taken = [Path(ENVELOPE).stem] if model.output.envelope else []
        fields = model.output.fields
        names = names if fields == "all" else () if isinstance(fields, str) else fields
    for slug in unique_slugs([*taken, *names]):
        yield from (f"{slug}{ending}" for ending in (".vtu", *(f"{ending}.png" for ending in _ENDINGS)))


def has_areas(results: Results) -> bool:
    """Whether the plate rests on an area."""
    return any(support.area is not None for support in results.discretisation.model.support)


def slugs(results: Results) -> Iterator[tuple[Result, str]]:
    """Solved combinations with file names of their own, on every file system."""
    solved = [result for result in results.values() if result.status == "solved"]
    taken = [] if results.combined is None else [Path(ENVELOPE).stem]
    found = unique_slugs([*taken, *(result.name for result in solved)])
    return zip(solved, found[len(taken) :], strict=True)


def unique_slugs(names: Iterable[str]) -> list[str]:
    """Turn names into file names without suffix: short, of small letters, digits, dots, dashes, each once.

    None is another one with the ending of a picture.

    Examples
    --------
    >>> unique_slugs(["ULS 1.35G + 1.5Q", "uls 1.35G / 1.5Q", "../été", "荷重", "con"])
    ['uls-1.35g-1.5q', 'uls-1.35g-1.5q-2', 'ete', 'combination', 'con-2']
    >>> unique_slugs(["wind", "wind pressure", "snow pressure", "snow"])
    ['wind', 'wind-pressure-2', 'snow-pressure', 'snow-2']
    """
    taken: set[str] = set()
    found = []
    for name in names:
        plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode().lower()
        base = re.sub(r"[^a-z0-9_.]+", "-", plain)[:_LONGEST_NAME].strip("-.") or "combination"
        slug, count = base, 1
        while {slug + ending for ending in _ENDINGS} & taken or _RESERVED.fullmatch(slug):
            count += 1
            slug = f"{base}-{count}"
        taken |= {slug + ending for ending in _ENDINGS}
        found.append(slug)
    return found
