"""The file of a study: a template, parameters, and the numbers that are wanted."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal

from pydantic import Field, ValidationError

from signorini.errors import Place
from signorini.model.base import Count, Table, Text
from signorini.model.problems import explained

Design = Literal["grid", "list", "latin"]


class StudyFile(Table):
    """The keys of a study's file."""

    template: Text = Field(description="The input file of the model, relative to the study's file.")
    parameters: dict[str, Any] = Field(description="Values by path in the template.")
    results: tuple[Text, ...] = Field(description="Names of numbers, as for thresholds of a path.")
    design: Design | None = Field(default=None, description='"grid", "list" or "latin".')
    samples: Count | None = Field(default=None, description="Number of variants of a Latin hypercube.")
    seed: int = Field(default=0, ge=0, strict=True, description="Seed of the random numbers.")


def validate_study(data: Mapping[str, Any], source: str, line_of: Callable[[Place], int]) -> StudyFile:
    """Validate the tables of a study's file; `validate` describes ``source`` and ``line_of``.

    Raises
    ------
    InputError
        Lists every problem with its place.
    """
    try:
        return StudyFile.model_validate(data)
    except ValidationError as error:
        raise explained(error, StudyFile, data, source, line_of) from None
