"""A table of factors from a CSV file: a row a combination, a column a load case."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path

from signorini.base.regular import read_regular
from signorini.expression import LARGEST
from signorini.model.words import describe

_LARGEST_FILE = 200_000_000


@dataclass(frozen=True)
class FactorTable:
    """Names (k,) of combinations, their cases, and a row of factors each."""

    source: str
    columns: tuple[str, ...]
    names: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]


def read_factor_table(value: object) -> FactorTable | None:
    """Read a CSV file whose first column holds names and whose header names the load cases of the others.

    An empty cell is the factor 0.

    Raises
    ------
    ValueError
        Saying what is wrong with the file, and in which line.
    """
    if value is None or isinstance(value, FactorTable):
        return value
    if not isinstance(value, str | Path):
        raise ValueError(f"found {describe(value)}; it must be the name of a CSV file, in quotes.")
    path = Path(value)
    try:
        text = read_regular(path, _LARGEST_FILE).decode("utf-8-sig")
        lines = list(csv.reader(io.StringIO(text, newline=""), skipinitialspace=True))
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror or error}.") from None
    except UnicodeDecodeError:
        raise ValueError(f"{path} is not UTF-8 text. Save it in the encoding UTF-8.") from None
    except csv.Error as error:
        raise ValueError(f"{path} is not a CSV file: {error}.") from None
    if lines and len(lines[0]) == 1 and lines[0][0].count(";") > 0:
        raise ValueError(f"{path} has semicolons between its columns. Save it with commas, and with decimal points.")
    if not lines or len(lines[0]) < 2:
        raise ValueError(f'{path} has no header; its first line must be "name" and the load cases, set off by commas.')
    first, *columns = (cell.strip() for cell in lines[0])
    if first != "name":
        raise ValueError(
            f'the header of {path} begins with {describe(first)}; it must begin with "name", the column of the '
            "combinations' names, before the load cases."
        )
    for index, case in enumerate(columns):
        if not case or case in columns[:index]:
            what = f'names the load case "{case}" twice' if case else "has a column without a load case"
            raise ValueError(f"the header of {path} {what}.")
    names, rows = [], []
    for number, line in enumerate(lines[1:], start=2):
        if not any(cell.strip() for cell in line):
            continue
        names.append(_name(line[0], path, number))
        rows.append(_row(line[1:], tuple(columns), path, number))
    if not rows:
        raise ValueError(f"{path} has a header but no rows.")
    return FactorTable(str(value), tuple(columns), tuple(names), tuple(rows))


def _name(text: str, path: Path, number: int) -> str:
    name = text.strip()
    if not name or not name.isprintable() or len(name) > 200:
        raise ValueError(f"line {number} of {path} begins with {describe(text)}; it must be the combination's name.")
    return name


def _row(cells: list[str], columns: tuple[str, ...], path: Path, number: int) -> tuple[float, ...]:
    if len(cells) != len(columns):
        raise ValueError(f"line {number} of {path} has {len(cells)} factors; the header names {len(columns)} cases.")
    factors = []
    for case, cell in zip(columns, cells, strict=True):
        try:
            # float() would take 1_000 and the digits of every script.
            plain = cell.isascii() and "_" not in cell
            factor = 0.0 if not cell.strip() else float(cell) if plain else float("nan")
        except ValueError:
            factor = float("nan")
        if not abs(factor) <= LARGEST:
            raise ValueError(f'line {number} of {path} has {describe(cell)} under "{case}"; it must be a number.')
        factors.append(factor)
    return tuple(factors)
