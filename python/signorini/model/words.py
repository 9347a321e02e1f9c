"""Values and places of the input in words."""

from __future__ import annotations

import datetime
import reprlib
from typing import Any


def describe(value: object) -> str:
    """Show a value the way the input file writes it, cut short when long."""
    match value:
        case bool():
            return str(value).lower()
        case None:
            return "nothing"
        case str():
            shown = value if len(value) <= 60 else f"{value[:57]}..."
            return f'"{shown}"' if shown.isprintable() else f'"{repr(shown)[1:-1]}"'
        case dict():
            return "a table"
        case float():
            return repr(float(value)).removesuffix(".0")
        case int() if abs(value) > 10**20:
            return "an integer of more than 20 digits"
        case datetime.date() | datetime.time():
            return f"the date or time {value}"
        case list() | tuple() if value and all(isinstance(one, str) for one in value):
            return reprlib.repr(list(value)).replace("'", '"')
        case _:
            return reprlib.repr(value)


def as_list(value: Any) -> Any:
    """Turn a NumPy array into lists; leave anything else as it is."""
    return value.tolist() if hasattr(value, "tolist") else value
