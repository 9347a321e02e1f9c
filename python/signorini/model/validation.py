"""A model of nested mappings and lists, as an input file gives them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import ValidationError

from signorini.errors import Place
from signorini.model.problems import explained
from signorini.model.whole import Model


def validate(data: Mapping[str, Any], *, source: str = "", line_of: Callable[[Place], int] | None = None) -> Model:
    """Make a model of nested mappings and lists, as read from an input file.

    Parameters
    ----------
    data : mapping
        The tables, under the keys of the input file.
    source : str
        Name of the file they come from, for messages.
    line_of : callable, optional
        Line in that file of a path of keys and positions (these count from 0).

    Returns
    -------
    Model

    Raises
    ------
    InputError
        Naming everything that is wrong, each with its place.

    Examples
    --------
    >>> validate({"material": {"E": 30e9, "nu": 0.5}, "plate": {"shape": "disc", "radius": 1, "thickness": 0.1},
    ...           "load": [{"pressure": 1}]})
    Traceback (most recent call last):
        ...
    signorini.errors.InputError: material.nu: found 0.5; it must be less than 0.5.
    """
    try:
        return Model.model_validate(data)
    except ValidationError as error:
        raise explained(error, Model, data, source, line_of) from None
