"""Verify results.json, path.json or a report: solve the embedded model again and compare every value."""

from __future__ import annotations

import base64
import binascii
import copy
import hashlib
import json
import math
import os
import re
import zlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from html.parser import HTMLParser
from itertools import zip_longest
from pathlib import Path as FilePath
from tempfile import TemporaryDirectory
from typing import Any, Literal

from signorini.analysis.estimate import estimate_asked, estimate_path, estimates_of
from signorini.analysis.path import path as load_path
from signorini.analysis.results import alone
from signorini.analysis.solve import solve
from signorini.base import arguments
from signorini.base.arguments import checked, watching
from signorini.base.progress import Watcher
from signorini.base.provenance import FUNCTION, LARGEST_EMBEDDED, sha256_of, tables_with_files
from signorini.base.regular import read_regular
from signorini.errors import InputError, SignoriniError
from signorini.model import Combination, Model, validate
from signorini.output.load_path import path_json
from signorini.output.tables import results_json
from signorini.results.quantities import (
    AT_BOLTS,
    AT_CORNERS,
    AT_PROBES,
    MEANS,
    OF_AREAS,
    OF_BOLTS,
    OF_LIMITED_AREAS,
    OF_LINES,
    OF_POINTS,
    OF_STRIPS,
    OF_SUPPORTS,
    OF_TURNING_POINTS,
    PICTURED,
    THROUGH,
    Path,
)

EMBEDDED = "signorini-results"
"""``id`` of the element of a report that contains results.json."""
TOLERANCE = 1e-7
"""Tolerance relative to the largest number of the same kind; certificates allow errors of 1e-8."""
_OF_WIDTHS = 0.0101
"""Relative tolerance for half-widths: one unit in the last of their three digits."""
_OF_SENTENCES = 1e-3
"""Relative tolerance for numbers within sentences, which have four to six digits."""
_LARGEST_FILE = 1_000_000_000
"""Largest size in bytes of a file that is verified."""
_NOT_RESULTS = ("program", "input", "options", "seconds")
_OF_PATHS = ("add", "until", "steps", "at", "when", "events")
"""Options of a path."""
_SENTENCES = {"message", "warnings", "advice", "what", "kind", "mechanism"}
_PLACES = {"at", "where", "box", "from", "to", "x", "y", "contact_boundary"}
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_ABSENT = object()

_SUPPORTS = (*OF_SUPPORTS, *OF_AREAS, *OF_LINES, *OF_LIMITED_AREAS, *OF_BOLTS)
_POINTS = (*OF_POINTS, *OF_TURNING_POINTS, *AT_BOLTS, AT_CORNERS)
_QUANTITIES = {
    "supports": _SUPPORTS,
    "contacts": _SUPPORTS,
    "points": _POINTS,
    "nodes": _POINTS,
    "corners": _POINTS,
    "probes": AT_PROBES,
    "sections": THROUGH,
    "strips": OF_STRIPS,
    "stations": (*MEANS, *PICTURED.values()),
    "": tuple(PICTURED.values()),
}
"""Quantities by the list that contains them."""
_KINDS = {
    owner: {key: quantity.kind for quantity in of for key in (quantity.path[0], quantity.name)}
    for owner, of in _QUANTITIES.items()
} | {
    "line": {"reaction": "per_length", "couple": "moment"},
    "joints": {"reaction": "reaction", "preload": "reaction"},
    "governing_reactions": dict.fromkeys(("max", "min", "max_with", "min_with"), "reaction"),
}
_SAME = {"force": "reaction", "corner": "reaction", "shear_stress": "stress"}
"""Kinds that are compared with numbers of another kind of the same unit."""


@dataclass(frozen=True)
class Difference:
    """One value of a file that differs from the computed one.

    Parameters
    ----------
    path : tuple of str and int
        Keys and indices (from 0) in the file.
    stored, computed : number, str, bool, list, dict or None
        Value in the file and value computed again; None for an absent value.
    what : {"value", "missing", "additional"}
        "missing": the file lacks the key; "additional": the key is only in the file.
    """

    path: Path
    stored: Any
    computed: Any
    what: Literal["value", "missing", "additional"] = "value"

    @property
    def place(self) -> str:
        """The path as text, such as ``combinations[0].supports[1].reaction``."""
        return "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in self.path).removeprefix(".")

    @property
    def difference(self) -> float | None:
        """Stored minus computed value; None if one of them is no number."""
        return _real(self.stored) - _real(self.computed) if _numbers(self.stored, self.computed) else None


@dataclass(frozen=True)
class Verification:
    """Comparison of the values in a file with those computed again from its model.

    Parameters
    ----------
    differences : tuple of Difference
        Values that differ by more than the tolerance, and keys that only one side has.
    rounding : tuple of Difference
        Values that differ within the tolerance. On the same processor with the same version there are none.
    compared : int
        Number of compared values.
    not_compared : tuple of str
        Keys of the file that are no results.
    version : str
        Version of the program that wrote the file.
    """

    differences: tuple[Difference, ...]
    rounding: tuple[Difference, ...]
    compared: int
    not_compared: tuple[str, ...]
    version: str

    @property
    def equal(self) -> bool:
        """Whether no value differs by more than the tolerance."""
        return not self.differences


@checked
def verify(path: str | os.PathLike[str], progress: Watcher | None = None) -> Verification:
    """Solve the model embedded in a file again, with the same options, and compare every value.

    Numbers are equal if they differ by at most 1e-7 of the largest number of their kind. Half-widths may differ by one
    unit in their third digit. Certificate errors are compared with 1.

    Parameters
    ----------
    path : path-like
        A results.json, a path.json, or a report in HTML with an embedded results.json.
    progress : callable, optional
        Called with a `Progress`, as in `signorini.solve`.

    Returns
    -------
    Verification

    Raises
    ------
    InputError
        If the file cannot be read, has no model that can be solved again, or names a file that is neither embedded nor
        found.

    Examples
    --------
    >>> import tempfile
    >>> from signorini import Model, solve, verify, write
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     mesh={"divisions": [4, 4], "error": False},
    ...     support=[{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}],
    ...     load=[{"pressure": 1e3}],
    ... )
    >>> with tempfile.TemporaryDirectory() as place:
    ...     file = write(solve(model), place, pictures="none")[0]
    ...     changed = file.with_name("changed.json")
    ...     _ = changed.write_text(file.read_text("utf-8").replace('"elements": 16', '"elements": 17'), "utf-8")
    ...     verify(file).equal, [(one.place, one.difference) for one in verify(changed).differences]
    (True, [('model.elements', 1.0)])
    """
    file = FilePath(arguments.path(path, "a file of results", "path"))
    with TemporaryDirectory() as room:
        return verified(file, watching(progress, "progress"), FilePath(room))


def verified(file: FilePath, watcher: Watcher, room: FilePath) -> Verification:
    """Verify a file as `verify` does; embedded files are unpacked into the directory ``room``."""
    stored = _read(file)
    given: Mapping[str, Any] = stored["input"]
    differences = list(_hashes(given))
    try:
        computed = _solved_again(stored, _model(given, file, room), watcher)
    except SignoriniError as error:
        raise InputError(f"its model cannot be solved again: {error}", place=str(file)) from None
    other = {key: value for key, value in stored.items() if key not in _NOT_RESULTS}
    again = {key: value for key, value in json.loads(json.dumps(computed)).items() if key not in _NOT_RESULTS}
    pairs = list(_pairs(other, again))
    rounding = list[Difference]()
    for difference, small in _compared(pairs):
        (rounding if small else differences).append(difference)
    skipped = ("program", "input.file", "input.sha256", "options", "seconds")
    present = tuple(key for key in skipped if key.removeprefix("input.") in (given if "." in key else stored))
    version = str(_table(stored.get("program")).get("version", ""))
    return Verification(tuple(differences), tuple(rounding), len(pairs) + 1, present, version)


def _read(file: FilePath) -> dict[str, Any]:
    """Read a results.json or path.json, or the results.json of a report."""
    try:
        text = read_regular(file, _LARGEST_FILE).decode("utf-8-sig")
        stored = json.loads(text if text.lstrip().startswith("{") else _of_report(text))
    except OSError as error:
        raise InputError(f"the file cannot be read: {error.strerror or error}.", place=str(file)) from None
    except (ValueError, RecursionError):
        stored = None
    if not isinstance(stored, dict) or not _table(_table(stored.get("input")).get("model")):
        why = "it has no results of signorini with their model. Give a results.json, a path.json or a report (.html)."
        raise InputError(why, place=str(file))
    return stored


def _of_report(text: str) -> str:
    """Return the JSON that a report embeds; an error if it has none or several."""
    parser = _Script()
    parser.feed(text)
    (found,) = parser.found
    return found


class _Script(HTMLParser):
    """Collects the content of the script elements with the ``id`` of the results."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self._inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = tag == "script" and ("id", EMBEDDED) in attrs
        if self._inside:
            self.found.append("")

    def handle_endtag(self, tag: str) -> None:
        self._inside = False

    def handle_data(self, data: str) -> None:
        if self._inside:
            self.found[-1] += data


def _table(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, dict) else {}


def _hashes(given: Mapping[str, Any]) -> Iterator[Difference]:
    """Compare the SHA-256 of the embedded model."""
    key, computed = "model_sha256", sha256_of(given["model"])
    if given.get(key) != computed:
        yield Difference(("input", key), given.get(key), computed, "value" if key in given else "missing")


def _model(given: Mapping[str, Any], file: FilePath, room: FilePath) -> Model:
    """Validate the embedded model; embedded files are unpacked into the directory ``room``."""
    tables = copy.deepcopy(given["model"])
    if name := next(_functions(tables), None):
        raise InputError(f"the stiffness of a support is the Python function {name}, which the file does not contain.")
    listed = given.get("files")
    files = {one.get("file"): one for one in map(_table, listed if isinstance(listed, list) else [])}
    for number, table in enumerate(tables_with_files(tables)):
        name = table["file"]
        table["file"] = str(_unpacked(name, _table(files.get(name)), file, room / str(number)))
    return validate(tables, source=file.name)


def _functions(node: Any) -> Iterator[str]:
    """Yield the names of Python functions in an input."""
    if isinstance(node, dict) and node.keys() == {FUNCTION} and isinstance(node[FUNCTION], str):
        yield node[FUNCTION]
    for value in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
        yield from _functions(value)


def _unpacked(name: str, embedded: Mapping[str, Any], file: FilePath, room: FilePath) -> FilePath:
    """Return a copy of an embedded file, or a file of that name and SHA-256 beside the results or their directory."""
    sha256, beside = embedded.get("sha256"), FilePath(name).name
    if isinstance(packed := embedded.get("gzip"), str):
        try:
            content = zlib.decompressobj(31).decompress(base64.b64decode(packed), LARGEST_EMBEDDED)
        except (binascii.Error, zlib.error, ValueError):
            raise InputError(f"the embedded file {name} is damaged.") from None
        if hashlib.sha256(content).hexdigest() != sha256:
            raise InputError(f"the embedded file {name} does not have its SHA-256, {sha256}.")
        room.mkdir()
        (room / beside).write_bytes(content)
        return room / beside
    for place in (FilePath(name), file.parent / beside, file.absolute().parent.parent / beside):
        if place.is_file():
            with place.open("rb") as opened:
                if sha256 in (None, hashlib.file_digest(opened, "sha256").hexdigest()):
                    return place
    needed = f" with the SHA-256 {sha256}" if sha256 else ""
    raise InputError(f"the file {name} is not embedded. Put {beside}{needed} beside {file.name}.")


def _solved_again(stored: Mapping[str, Any], model: Model, watcher: Watcher) -> dict[str, Any]:
    """Solve a model with the options of a file, and return the JSON of the results."""
    options = _table(stored.get("options"))
    if "stops" in stored:
        if stored.get("interrupted"):
            raise InputError("the path was interrupted, so it cannot be followed again.")
        given = {key: options[key] for key in _OF_PATHS if key in options}
        found = load_path(model, options.get("from"), progress=watcher, **given)
        estimate = estimate_asked(found, watcher)
        if estimate is None and stored.get("plus_minus") is not None:
            estimate = estimate_path(found, watcher)
        return path_json(found, estimate)
    if (own := options.get("combination")) is not None:
        model = alone(model, Combination(**_table(own)))
    results = solve(model, watcher)
    told = [stored.get("envelope"), *(of if isinstance(of := stored.get("combinations"), list) else [])]
    estimated = model.estimated or any(_table(one).get("plus_minus") is not None for one in told)
    return results_json(results, estimates_of(results, watcher) if estimated else None, options.get("pictures"))


def _pairs(stored: Any, computed: Any, path: Path = ()) -> Iterator[tuple[Path, Any, Any]]:
    """Yield the path, the stored and the computed value of every leaf of two trees."""
    if isinstance(stored, dict) and isinstance(computed, dict):
        for key in {**computed, **stored}:
            yield from _pairs(stored.get(key, _ABSENT), computed.get(key, _ABSENT), (*path, key))
    elif isinstance(stored, list) and isinstance(computed, list):
        for index, (one, two) in enumerate(zip_longest(stored, computed, fillvalue=_ABSENT)):
            yield from _pairs(one, two, (*path, index))
    else:
        yield path, stored, computed


def _compared(pairs: list[tuple[Path, Any, Any]]) -> Iterator[tuple[Difference, bool]]:
    """Yield the differences, and for each whether it is within the tolerance."""
    scales = _scales((_kind(_keys(path)), two) for path, one, two in pairs if _numbers(one, two))
    for place, (path, one, two) in enumerate(pairs):
        if _ABSENT in (one, two):
            yield (
                Difference(path, None, two, "missing") if one is _ABSENT else Difference(path, one, None, "additional"),
                False,
            )
        elif _numbers(one, two):
            if one != two:
                tolerance = TOLERANCE * scales[_kind(_keys(path))]
                if path[-2:] == ("principal_moment", 2):
                    # The direction turns by the error of the moments over their difference.
                    apart = pairs[place - 2][2] - pairs[place - 1][2]
                    tolerance = math.degrees(TOLERANCE * scales["moment"] / apart) if apart else 180.0
                if "plus_minus" in path:
                    tolerance = max(tolerance, _OF_WIDTHS * abs(two))
                yield Difference(path, one, two), abs(_real(one) - two) <= tolerance
        elif type(one) is not type(two) or one != two:
            yield Difference(path, one, two), bool(_SENTENCES & set(path)) and _same_words(one, two)


def _scales(numbers: Iterable[tuple[str, float]]) -> dict[str, float]:
    """Largest magnitude of each kind; lower bounds for kinds that may vanish up to rounding."""
    scales = {"certificate": 1.0}
    for kind, value in numbers:
        scales[kind] = max(scales.get(kind, 0.0), abs(value))
    size = scales.get("place", 0.0)
    if size:
        scales["rotation"] = max(scales.get("rotation", 0.0), scales.get("deflection", 0.0) / size)
        scales["couple"] = max(scales.get("couple", 0.0), scales.get("reaction", 0.0) * size)
    return scales


def _keys(path: Path) -> tuple[str, ...]:
    return tuple(key for key in path if isinstance(key, str))


@cache
def _kind(keys: tuple[str, ...]) -> str:
    """Kind of numbers that are compared: "place", "certificate", a kind of quantity, else the keys themselves."""
    if keys[-1] in _PLACES or keys[-1].endswith("_at"):
        return "place"
    if "certificate" in keys:
        return "certificate"
    owner = next((key for key in reversed(keys) if key in _KINDS), "")
    for key in reversed(keys):
        if kind := _KINDS[owner].get(key) or (_KINDS[""].get(key) if not owner else None):
            return _SAME.get(kind, kind)
    return ".".join(key for key in keys if key != "plus_minus")


def _numbers(*values: object) -> bool:
    return all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)


def _real(value: float) -> float:
    """Convert a number to float; an integer beyond its range becomes ∞."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _same_words(one: object, two: object) -> bool:
    """Whether two sentences have the same words, and numbers that agree to their digits."""
    if not (isinstance(one, str) and isinstance(two, str)) or _NUMBER.split(one) != _NUMBER.split(two):
        return False
    numbers = zip(_NUMBER.findall(one), _NUMBER.findall(two), strict=True)
    return all(math.isclose(float(a), float(b), rel_tol=_OF_SENTENCES) for a, b in numbers)
