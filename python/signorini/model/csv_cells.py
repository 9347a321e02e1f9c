"""Read CSV files as text cells, and numbers from these cells; invalid files raise ValueError."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from signorini.base.regular import read_regular


def read_cells(path: Path, largest: int) -> list[list[str]]:
    """Read a CSV file of at most ``largest`` bytes; return the text cells of each line."""
    try:
        text = read_regular(path, largest).decode("utf-8-sig")
        lines = list(csv.reader(io.StringIO(text, newline=""), skipinitialspace=True))
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror or error}.") from None
    except UnicodeDecodeError:
        raise ValueError(f"{path} is not UTF-8 text. Save it in the encoding UTF-8.") from None
    except csv.Error as error:
        raise ValueError(f"{path} is not a CSV file: {error}.") from None
    if lines and len(lines[0]) == 1 and lines[0][0].count(";") > 0:
        raise ValueError(f"{path} has semicolons between its columns. Save it with commas, and with decimal points.")
    return lines


def number_in(cell: str) -> float:
    """Read the number in a cell; NaN if the cell has no number."""
    # Without this test float() would also accept 1_000 and digits that are not ASCII.
    try:
        return float(cell) if cell.isascii() and "_" not in cell else float("nan")
    except ValueError:
        return float("nan")
