"""Verify results.json, path.json or a report: solve the embedded model again and compare every value."""

from __future__ import annotations

import base64
import copy
import hashlib
import json
import math
import os
import re
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import zip_longest
from pathlib import Path as FilePath
from tempfile import TemporaryDirectory
from typing import Any, Literal

from signorini.analysis.estimate import estimate_asked, estimate_path, estimates_of
from signorini.analysis.path import path as load_path
from signorini.analysis.results import alone, with_sensitivities
from signorini.analysis.solve import solve_all
from signorini.base import arguments
from signorini.base.arguments import checked, watching
from signorini.base.progress import Watcher
from signorini.base.provenance import FUNCTION, LARGEST_EMBEDDED, sha256_of, tables_with
from signorini.base.regular import read_regular
from signorini.errors import InputError, SignoriniError
from signorini.model import Combination, Model, validate
from signorini.output.load_path import path_json
from signorini.output.tables import results_json
from signorini.results.quantities import Path, quantity_at

TOLERANCE = 1e-7
"""Tolerance relative to the largest number of the same kind; certificates allow errors of 1e-8."""
_OF_WIDTHS = 0.0101
"""Relative tolerance for half-widths: they have three digits and may differ by one unit in the last."""
_LARGEST_FILE = 1_000_000_000
"""Largest size in bytes of a file that is verified."""
_NOT_RESULTS = ("program", "input", "options", "seconds")
_OF_PATHS = ("add", "until", "steps", "at", "when", "events")
"""Options of `signorini.path` that a path.json stores, besides the start of the path."""
_IN_REPORT = re.compile(r'<script\b[^>]*\bid="signorini-results"[^>]*>(.*?)</script>', re.DOTALL)
"""Element of a report that contains results.json, deflated and in base64."""
_ABSENT = object()

_PLACES = {"at", "where", "box", "from", "to", "x", "y", "contact_boundary"}
_SAME = {"force": "reaction", "shear_stress": "stress"}
"""Kinds of numbers compared relative to the largest number of another kind, the value here, of the same unit."""


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
        """Stored minus computed value; None if one of the two values is no number."""
        return self.stored - self.computed if _numbers(self.stored, self.computed) else None


@dataclass(frozen=True)
class Verification:
    """Comparison of the values in a file with the values computed again from its model.

    Parameters
    ----------
    differences : tuple of Difference
        Values that differ by more than the tolerance, and keys that only one side has.
    rounding : tuple of Difference
        Values that differ within the tolerance. On the same processor with the same version there are none.
    compared : int
        Number of compared values.
    version : str
        Version of the program that wrote the file.
    """

    differences: tuple[Difference, ...]
    rounding: tuple[Difference, ...]
    compared: int
    version: str

    not_compared = ("program", "input.file", "input.sha256", "options", "seconds")

    @property
    def equal(self) -> bool:
        """Whether no value differs by more than the tolerance."""
        return not self.differences


@checked
def verify(path: str | os.PathLike[str], progress: Watcher | None = None) -> Verification:
    """Solve the model embedded in a file again, with the same options, and compare every value.

    Parameters
    ----------
    path : path-like
        A results.json, a path.json, or a report in HTML with an embedded results.json.
    progress : callable, optional
        Called with a `Progress`, as in `signorini.solve`.

    Returns
    -------
    Verification
        Numbers are equal if they differ by at most 1e-7 of the largest number of their kind.

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
    (True, [('model.elements', 1)])
    """
    file = FilePath(arguments.path(path, "a file of results", "path"))
    with TemporaryDirectory() as room:
        return verified(file, watching(progress, "progress"), FilePath(room))


def verified(file: FilePath, watcher: Watcher, room: FilePath) -> Verification:
    """Verify a file as `verify` does; embedded files are unpacked into the directory ``room``."""
    stored = _read(file)
    given: Mapping[str, Any] = stored["input"]
    try:
        computed = json.loads(json.dumps(_solved_again(stored, _model(given, file, room), watcher)))
    except SignoriniError as error:
        raise InputError(f"its model cannot be solved again: {error}", place=str(file)) from None
    written, again = ({key: of[key] for key in of if key not in _NOT_RESULTS} for of in (stored, computed))
    hashes = (("input", "model_sha256"), given.get("model_sha256"), sha256_of(given["model"]))
    pairs = [hashes, *_pairs(written, again)]
    found = list(_compared(pairs))
    differences, rounding = (tuple(one for one, small in found if small == kind) for kind in (False, True))
    return Verification(differences, rounding, len(pairs), str(_table(stored.get("program")).get("version", "")))


def _read(file: FilePath) -> dict[str, Any]:
    """Read a results.json or path.json, or the results.json of a report."""
    try:
        text = read_regular(file, _LARGEST_FILE).decode("utf-8-sig")
        if not text.lstrip().startswith("{"):
            (coded,) = _IN_REPORT.findall(re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL))
            text = zlib.decompressobj().decompress(base64.b64decode(coded), _LARGEST_FILE).decode()
        # Integers of 300 or more digits are read as floats, since longer ones are beyond the range of a float.
        stored = json.loads(text, parse_int=lambda digits: int(digits) if len(digits) < 300 else float(digits))
    except OSError as error:
        raise InputError(f"the file cannot be read: {error.strerror or error}.", place=str(file)) from None
    except (ValueError, zlib.error, RecursionError):
        stored = None
    if not isinstance(stored, dict) or not _table(_table(stored.get("input")).get("model")):
        why = "it has no results with an embedded model. Give a results.json, a path.json or a report (.html)."
        raise InputError(why, place=str(file))
    return stored


def _table(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, dict) else {}


def _model(given: Mapping[str, Any], file: FilePath, room: FilePath) -> Model:
    """Validate the embedded model; embedded files are unpacked into the directory ``room``."""
    tables = copy.deepcopy(given["model"])
    for table in tables_with(FUNCTION, tables):
        raise InputError(f"a stiffness is the Python function {table[FUNCTION]}, which the file does not contain.")
    files = given.get("files")
    embedded = {one.get("file"): one for one in map(_table, files if isinstance(files, list) else [])}
    for number, table in enumerate(tables_with("file", tables)):
        of = _table(embedded.get(table["file"]))
        table["file"] = str(_unpacked(table["file"], of.get("sha256"), of.get("gzip"), file, room / str(number)))
    return validate(tables, source=file.name)


def _unpacked(name: str, sha256: str | None, packed: Any, file: FilePath, room: FilePath) -> FilePath:
    """Return a copy of an embedded file, or a file of that name and SHA-256 beside the results or their directory."""
    beside = FilePath(name).name
    places = [FilePath(name), file.parent / beside, file.absolute().parent.parent / beside]
    if isinstance(packed, str):
        try:
            content = zlib.decompressobj(31).decompress(base64.b64decode(packed), LARGEST_EMBEDDED)
        except (ValueError, zlib.error):
            content = b""
        room.mkdir()
        (room / beside).write_bytes(content)
        places = [room / beside]
    for place in filter(FilePath.is_file, places):
        with place.open("rb") as opened:
            if sha256 in (None, hashlib.file_digest(opened, "sha256").hexdigest()):
                return place
    of = f" with the SHA-256 {sha256}" if sha256 else ""
    if isinstance(packed, str):
        raise InputError(f"the embedded file {name} is damaged; it is not the one{of}.")
    raise InputError(f"the file {name} is not embedded. Put {beside}{of} beside {file.name}.")


def _solved_again(stored: Mapping[str, Any], model: Model, watcher: Watcher) -> dict[str, Any]:
    """Solve a model again with the options stored in a file, and return the JSON of the results."""
    options = _table(stored.get("options"))
    if "engine" in options:
        raise InputError(
            f"the results are of the engine {options['engine']}, but verify solves with the embedded engine. Solve the "
            "input again with the stored engine and compare."
        )
    if "stops" in stored:
        if stored.get("interrupted"):
            raise InputError("the load path was interrupted, so it cannot be computed again.")
        given = {key: options[key] for key in _OF_PATHS if key in options}
        found = load_path(model, options.get("from"), progress=watcher, **given)
        estimate = estimate_asked(found, watcher)
        if estimate is None and stored.get("plus_minus") is not None:
            estimate = estimate_path(found, watcher)
        return path_json(found, estimate)
    if own := _table(options.get("combination")):
        model = alone(model, Combination(**own))
    results = with_sensitivities(solve_all(model, watcher), options.get("sensitivity", ()), watcher)
    told = [stored.get("envelope"), *(of if isinstance(of := stored.get("combinations"), list) else [])]
    estimated = model.estimated or any(_table(one).get("plus_minus") is not None for one in told)
    return results_json(
        results,
        estimates_of(results, watcher) if estimated else None,
        options.get("pictures"),
        bool(options.get("xlsx")),
    )


def _pairs(stored: Any, computed: Any, path: Path = ()) -> Iterator[tuple[Path, Any, Any]]:
    """Yield the path, the stored value and the computed value of every leaf of the JSON trees of two results."""
    if isinstance(stored, dict) and isinstance(computed, dict):
        for key in {**computed, **stored}:
            yield from _pairs(stored.get(key, _ABSENT), computed.get(key, _ABSENT), (*path, key))
    elif isinstance(stored, list) and isinstance(computed, list):
        for index, (one, two) in enumerate(zip_longest(stored, computed, fillvalue=_ABSENT)):
            yield from _pairs(one, two, (*path, index))
    else:
        yield path, stored, computed


def _compared(pairs: list[tuple[Path, Any, Any]]) -> Iterator[tuple[Difference, bool]]:
    """Yield each difference of a stored and a computed value, and whether it is within the tolerance."""
    scales = _scales(pairs)
    for place, (path, one, two) in enumerate(pairs):
        if one is _ABSENT:
            yield Difference(path, None, two, "missing"), False
        elif two is _ABSENT:
            yield Difference(path, one, None, "additional"), False
        elif not _numbers(one, two):
            if type(one) is not type(two) or one != two:
                yield Difference(path, one, two), False
        elif one != two:
            tolerance = TOLERANCE * scales[_kind(path)]
            if path[-2:] == ("principal_moment", 2):
                # An error e of the principal moments m₁ and m₂ turns their direction by about e / (m₁ − m₂).
                apart = pairs[place - 2][2] - pairs[place - 1][2]
                tolerance = math.degrees(TOLERANCE * scales["moment"] / apart) if apart else 180.0
            if "plus_minus" in path:
                tolerance = max(tolerance, _OF_WIDTHS * abs(two))
            yield Difference(path, one, two), abs(one - two) <= tolerance


def _scales(pairs: list[tuple[Path, Any, Any]]) -> dict[str, float]:
    """Largest magnitude by kind of number; that of rotations and couples, which may be rounding, has a lower bound."""
    scales = dict.fromkeys(("place", "deflection", "reaction", "rotation", "couple"), 0.0) | {"certificate": 1.0}
    for path, one, two in pairs:
        if _numbers(one, two):
            kind = _kind(path)
            scales[kind] = max(scales.get(kind, 0.0), abs(two))
    size = scales["place"] or math.inf
    scales["rotation"] = max(scales["rotation"], scales["deflection"] / size)
    scales["couple"] = max(scales["couple"], scales["reaction"] * scales["place"])
    return scales


def _kind(path: Path) -> str:
    return _kind_of(tuple(key for key in path if isinstance(key, str) and key != "plus_minus"))


@cache
def _kind_of(keys: tuple[str, ...]) -> str:
    """Kind of number at a path of keys: "place", "certificate", a kind of quantity, else the keys themselves."""
    if keys[-1] in _PLACES or keys[-1].endswith("_at"):
        return "place"
    if "certificate" in keys:
        return "certificate"
    quantity = quantity_at(keys)
    return ".".join(keys) if quantity is None else _SAME.get(quantity.kind, quantity.kind)


def _numbers(*values: object) -> bool:
    return all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
