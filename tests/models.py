"""The plate of most tests; a test gives its differences."""

from collections.abc import Sequence
from typing import Any

from signorini import Model


def tables(
    size: Sequence[float] = (4, 4), thickness: float | str = 0.2, divisions: Sequence[int] = (4, 4), **others: Any
) -> dict[str, Any]:
    """Tables of an input file: a rectangle of concrete in N and m, and others, which replace these."""
    return {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": list(size), "thickness": thickness},
        "mesh": {"divisions": list(divisions)},
    } | others


def rectangular(**given: Any) -> Model:
    """Make the model of such tables."""
    return Model(**tables(**given))
