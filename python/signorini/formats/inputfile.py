"""Read a model from a TOML file; make the JSON Schema of such files."""

from __future__ import annotations

import functools
import hashlib
import os
import re
import reprlib
import tomllib
from pathlib import Path
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from signorini.base import arguments
from signorini.base.arguments import checked
from signorini.base.provenance import tables_with
from signorini.base.regular import read_regular
from signorini.errors import InputError
from signorini.expression import Expression
from signorini.formats.toml import Lines, hint, without_strings
from signorini.model import Model, validate
from signorini.model.problems import LISTS

_LARGEST_FILE = 4_000_000
"""Largest allowed size of an input file in bytes; large tables of data belong in CSV files."""
_MAX_KEY_PARTS = 16
"""Largest allowed number of parts of a dotted key (memory of tomllib grows with its square); the model needs 4."""


@checked
def load(path: str | os.PathLike[str]) -> Model:
    """Read an input file.

    Parameters
    ----------
    path : str or path-like
        A TOML file. File names in it are relative to its directory.

    Returns
    -------
    Model

    Raises
    ------
    InputError
        If the file cannot be read or is not a valid model; lists every problem with its place and line.
    """
    arguments.path(path, "an input file", "path")
    content = _content(path)
    text, source = _decoded(content, path), os.path.basename(path)
    return _model(text, source, Path(path).parent).read_from(os.fspath(path), hashlib.sha256(content).hexdigest())


@checked
def loads(text: str) -> Model:
    """Read the text of an input file; file names in it are relative to the working directory.

    Raises
    ------
    InputError
        If the text is not a valid model; lists every problem with its place and line.

    Examples
    --------
    >>> text = '''
    ... material = { E = 30e9, nu = 0.2 }
    ... plate = { shape = "rectangle", size = [4, 4], thickness = 0.2 }
    ... support = [{ edge = "left", fix = "clamped" }]
    ... load = [{ pressure = 5e3 }]
    ... '''
    >>> loads(text) == loads(loads(text).to_toml())
    True
    """
    if not isinstance(text, str):
        raise InputError(f"found {reprlib.repr(text)}; it must be the text of an input file.", place="text")
    return _model(text, "text", Path())


def _model(text: str, source: str, directory: Path) -> Model:
    """Parse and validate a text; file names in it are relative to ``directory``."""
    lines = functools.cache(lambda: Lines(text))
    data = _parse(text, source)
    for key in ("file", "logo"):
        for table in tables_with(key, data):
            table[key] = str(directory / table[key])
    return validate(data, source=source, line_of=lambda path: lines().of(path))


def parsed(path: str | os.PathLike[str]) -> tuple[dict[str, Any], str]:
    """Parse a TOML file; return its tables and its text.

    Raises
    ------
    InputError
        If the file cannot be read or is no valid TOML.
    """
    text = _decoded(_content(path), path)
    return _parse(text, os.path.basename(path)), text


def with_line(error: InputError, path: str | os.PathLike[str]) -> InputError:
    """Return an error in which the places of problems have the input file's name and line number.

    The error was raised after the input file was read. Problems whose place is not in the model remain unchanged.
    """
    if not any(part.path for part in error.parts):
        return error
    lines, source = Lines(_decoded(_content(path), path)), os.path.basename(path)
    placed = sorted(((lines.of(part.path) if part.path else 0, part) for part in error.parts), key=lambda pair: pair[0])
    return InputError.combined(
        [InputError(part.message, place=f"{source}:{line}: {part.place}") if line else part for line, part in placed],
        source,
    )


def _content(path: str | os.PathLike[str]) -> bytes:
    place = str(path)
    try:
        return read_regular(path, _LARGEST_FILE)
    except (OSError, ValueError) as error:
        match error:
            case FileNotFoundError():
                why = "the file does not exist."
            case IsADirectoryError():
                why = "this is a directory; give the path of an input file."
            case PermissionError():
                why = "permission to read the file is denied."
            case _:
                why = f"the file cannot be read: {getattr(error, 'strerror', None) or error}."
        raise InputError(why, place=place if place.isprintable() else repr(place)) from None


def _decoded(content: bytes, path: str | os.PathLike[str]) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"byte {content[error.start]:#04x} is not UTF-8 text. Save the file in the encoding UTF-8.",
            place=f"{os.path.basename(path)}:{line}",
        ) from None


def _parse(text: str, source: str) -> dict[str, Any]:
    # Refuse long dotted keys: the memory of tomllib grows with the square of the number of parts of a key.
    keys = without_strings(text)
    for segment in re.split(r"[=,\[\]{}\n]", keys):
        if segment.count(".") >= _MAX_KEY_PARTS and sum(map(bool, segment.split("."))) > _MAX_KEY_PARTS:
            line = keys.count("\n", 0, keys.index(segment)) + 1
            raise InputError(f"a dotted key has more than {_MAX_KEY_PARTS} parts.", place=f"{source}:{line}")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        problem, line, column = _syntax(str(error), text)
        content = text.replace("\r\n", "\n").split("\n")[line - 1].strip()
        shown = f"{content[:77]}..." if len(content) > 80 else content
        if advice := hint(problem, content, LISTS):
            message = f"invalid TOML. {advice} Found{column}: {shown}"
        else:
            message = f"invalid TOML: {problem}{column}" + (f" in: {shown}" if shown else "")
        raise InputError(message, place=f"{source}:{line}") from None
    except RecursionError:
        raise InputError("lists or tables are nested too deeply.", place=source) from None
    except ValueError:
        raise InputError("a number has too many digits.", place=source) from None


def _syntax(message: str, text: str) -> tuple[str, int, str]:
    """Split an error message of tomllib into the problem, the line number, and a text with the column."""
    match = re.fullmatch(r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)", message, re.DOTALL)
    if match is None:
        return message, 1, ""
    problem = match.group(1)[:1].lower() + match.group(1)[1:]
    last = text.rstrip().count("\n") + 1 if match.group(2) is None else int(match.group(2))
    if problem == "unclosed array":
        # tomllib reports a line after the list; report the last line with an open bracket, where the list begins.
        opened = [i for i, line in enumerate(text.split("\n")[:last], start=1) if re.search(r"=\s*\[[^\]]*$", line)]
        return "this list has no closing ]", opened[-1] if opened else last, ""
    if match.group(2) is None:
        return f"{problem} at the end of the file", last, ""
    return problem, last, f" (column {match.group(3)})"


@checked
def schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of the input file, for completion and checks in editors.

    Returns
    -------
    dict

    Examples
    --------
    >>> schema()["oneOf"]
    [{'required': ['plate']}, {'required': ['plates']}]
    """
    body: dict[str, Any] = _for_toml(Model.model_json_schema(schema_generator=_SchemaGenerator))
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **body,
        "title": "Input file of signorini",
    }


class _SchemaGenerator(GenerateJsonSchema):
    def encode_default(self, dft: Any) -> Any:
        """Convert an `Expression` that is a default value to its number or text, for JSON."""
        return dft.source if isinstance(dft, Expression) else super().encode_default(dft)


def _for_toml(node: Any, *, is_name_table: bool = False) -> Any:
    """Adapt a JSON Schema to TOML: remove null, which TOML lacks, and titles.

    Descriptions are shortened to their first paragraph.
    """
    if isinstance(node, list):
        return [_for_toml(item) for item in node]
    if not isinstance(node, dict):
        return node
    if is_name_table:
        return {name: _for_toml(part) for name, part in node.items()}
    kept = {
        key: _for_toml(part, is_name_table=key in ("properties", "$defs"))
        for key, part in node.items()
        if key not in ("title", "discriminator") and not (key == "default" and part in (None, ""))
    }
    if "description" in kept:
        kept["description"] = " ".join(kept["description"].split("\n\n")[0].split())
    branches = [branch for branch in kept.get("anyOf", []) if branch != {"type": "null"}]
    if len(branches) == 1 and isinstance(branches[0], dict):
        del kept["anyOf"]
        return {**branches[0], **kept}
    return {**kept, "anyOf": branches} if branches else kept
