"""Write tables as the sheets of an .xlsx workbook; no cell is a formula or a link."""

from __future__ import annotations

import datetime
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from signorini.base.packages import package
from signorini.errors import InputError

Cell = str | float | None
_MOST_ROWS = 1_048_575
"""Largest number of rows of a sheet of an .xlsx file, without the header row."""
_WIDTHS = (8, 40)
"""Smallest and largest width of a column in characters."""
_MEASURED = 100
"""Number of first rows of a sheet whose texts determine the widths of its columns."""
_MADE = datetime.datetime(2000, 1, 1)
"""Creation date in the workbook's properties, constant so that identical results give identical files."""


@dataclass(frozen=True)
class Sheet:
    """A table for one sheet of a workbook: the titles of its columns, and its rows."""

    name: str
    columns: Sequence[str]
    rows: Iterable[Sequence[Cell]]


def write_xlsx(path: str | os.PathLike[str], sheets: Iterable[Sheet], metadata: Mapping[str, str]) -> None:
    """Write a workbook row by row; the header of every sheet stays visible and has a filter. It needs XlsxWriter."""
    with package("xlsxwriter").Workbook(os.fspath(path), {"constant_memory": True}) as book:
        said = "; ".join(f"{name}: {text}" for name, text in metadata.items())
        book.set_properties({"comments": said, "created": _MADE})
        bold = book.add_format({"bold": True, "text_wrap": True, "valign": "top"})
        for sheet in sheets:
            page, widths, last = book.add_worksheet(sheet.name), [len(title) / 2 for title in sheet.columns], 0
            for place, title in enumerate(sheet.columns):
                page.write_string(0, place, title, bold)
            for last, row in enumerate(sheet.rows, start=1):
                if last > _MOST_ROWS:
                    raise InputError(f"the sheet {sheet.name} has more than {_MOST_ROWS} rows.", place="xlsx")
                for place, value in enumerate(row):
                    if isinstance(value, str):
                        page.write_string(last, place, value)
                        widths[place] = max(widths[place], len(value) if last < _MEASURED else 0)
                    elif isinstance(value, bool):
                        page.write_boolean(last, place, value)
                    elif value is not None:
                        page.write_number(last, place, value)
            for place, width in enumerate(widths):
                page.set_column(place, place, min(max(width + 2, _WIDTHS[0]), _WIDTHS[1]))
            page.freeze_panes(1, 0)
            page.autofilter(0, 0, last, len(sheet.columns) - 1)
