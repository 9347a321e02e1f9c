"""Directory of results: names of the files of earlier runs, and a check that the directory can be written to."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from signorini.base.files import locked, require_free, temporary_directory
from signorini.base.regular import read_regular
from signorini.errors import InputError
from signorini.model import Model
from signorini.output.names import (
    CSV,
    INDEX,
    JSON,
    OF_ALL,
    PATH_CSV,
    PATH_JSON,
    PATH_PICTURE,
    STUDY,
    expected_names,
    unique_slugs,
)

_OF_ONE = re.compile(r"[\w.+-]+\.(vtu|pvtu|png)")
"""Names of the files of one combination, and of pictures of envelopes and profiles."""
_KEYS_OF_RESULTS = {"schema", "title", "units", "model", "combinations", "seconds", "files"}
_KEYS_OF_STUDY = {"program", "input", "study_sha256", "results"}
_KEYS_OF_PATH = {"schema", "title", "units", "from", "add", "method", "ending", "stops"}
_INDEX_SAYS = "`signorini validate` writes these pages"
"""Text in every index that `signorini validate` writes; it tells this index from files of other programs."""
_LINK = re.compile(r"\]\(([\w.+-]+\.(?:md|toml|png))\)")
"""Pattern of a link to a file in the same directory."""
_LARGEST_ACCOUNT = 1_000_000_000
"""Largest size in bytes of a file, such as results.json, that is read to list the files of an earlier run."""


def former_results(directory: Path) -> list[str]:
    """Names of the result files that ``results.json`` in a directory lists; empty if another program wrote it."""
    try:
        entries = _account(directory / JSON, _KEYS_OF_RESULTS)["files"]
        # In schema 1 of results.json, the entries of ``files`` are file names; now they are tables.
        named = (entry["file"] if isinstance(entry, dict) else entry for entry in entries)
        names = [name for name in named if name in OF_ALL or _OF_ONE.fullmatch(name)]
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return []
    return names if {JSON, CSV} <= set(names) else []


def former_path(directory: Path) -> list[str]:
    """Names of the load path's files in a directory; empty if another program wrote the ``path.json`` there."""
    try:
        _account(directory / PATH_JSON, _KEYS_OF_PATH)
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return []
    return [PATH_JSON, PATH_CSV, PATH_PICTURE]


def former_study(directory: Path) -> list[str]:
    """Names of the summary and the pictures of a study in a directory; empty if another program wrote the summary."""
    try:
        results = _account(directory / STUDY, _KEYS_OF_STUDY)["results"]
        slugs = unique_slugs([result["name"] for result in results])
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return []
    return [STUDY, *(f"{slug}.png" for slug in slugs)]


def former_pages(directory: Path) -> list[str]:
    """Names of the pages of validation that the index in a directory links, and of the files that these pages link."""
    try:
        index = _text(directory / INDEX)
    except (OSError, ValueError):
        return []
    if _INDEX_SAYS not in index:
        return []
    pages = _LINK.findall(index)
    linked = (link for page in pages for link in _links(directory / page))
    return list(dict.fromkeys([INDEX, *pages, *linked]))


def _links(page: Path) -> list[str]:
    try:
        return _LINK.findall(_text(page))
    except (OSError, ValueError):
        return []


def _text(file: Path) -> str:
    return read_regular(file, _LARGEST_ACCOUNT).decode("utf-8")


def _account(file: Path, keys: set[str]) -> dict[str, Any]:
    result: dict[str, Any] = json.loads(read_regular(file, _LARGEST_ACCOUNT))
    if not keys <= result.keys():
        raise KeyError
    return result


@contextmanager
def room_for(directory: str | os.PathLike[str], model: Model) -> Iterator[Path]:
    """Context that yields a hidden directory on the file system to which results will be written.

    Two cases are refused before the results are computed: a directory that cannot be made or written to, and one in
    which files of another program, or files that the model is read from, have the names of the results.
    """
    with _room(Path(directory), former_results, expected_names(model), model.provenance.read) as room:
        yield room


@contextmanager
def room_for_path(directory: str | os.PathLike[str], model: Model) -> Iterator[Path]:
    """Context like `room_for`, for the files of a load path."""
    with _room(Path(directory), former_path, (PATH_JSON, PATH_CSV, PATH_PICTURE), model.provenance.read) as room:
        yield room


@contextmanager
def room_for_study(directory: str | os.PathLike[str], results: Sequence[str], template: Model) -> Iterator[Path]:
    """Context like `room_for`, for the summary and the pictures of a study of the given results."""
    names = (STUDY, *(f"{slug}.png" for slug in unique_slugs(results)))
    with _room(Path(directory), former_study, names, template.provenance.read) as room:
        yield room


@contextmanager
def room_for_pages(directory: str | os.PathLike[str], names: Iterable[str]) -> Iterator[Path]:
    """Context like `room_for`, for the files ``names`` of a validation."""
    with _room(Path(directory), former_pages, names) as room:
        yield room


@contextmanager
def _room(
    directory: Path, former: Callable[[Path], list[str]], names: Iterable[str], read: Collection[str] = ()
) -> Iterator[Path]:
    target = directory.absolute()
    with ExitStack() as context:
        try:
            nearest = next(place for place in (target, *target.parents) if place.exists())
            room = context.enter_context(temporary_directory(nearest, target.name))
            if nearest == target:
                with locked(target):
                    require_free(target, names, former, read)
        except OSError as error:
            raise cannot_write(directory, error) from None
        yield room


def cannot_write(target: Path, error: OSError) -> InputError:
    """Return the error for results that cannot be written to a directory, with the reason."""
    why = error.strerror or str(error)
    return InputError(f"the results cannot be written there: {why}. Name another directory.", str(target))
