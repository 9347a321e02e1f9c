"""Study files: an input file as template, the keys to vary, and the names of the resulting numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal

from pydantic import Field, ValidationError

from signorini.errors import Place
from signorini.model.base import Count, Table, Text
from signorini.model.problems import explained

Design = Literal["grid", "list", "latin"]


class StudyFile(Table):
    """Keys of a study file, which describes variants of one input file."""

    template: Text = Field(description="Input file whose keys are varied; relative to the study file.")
    parameters: dict[str, Any] = Field(
        description="List of values, or a distribution, for the path of each varied key in the template."
    )
    results: tuple[Text, ...] = Field(
        description="Names of the numbers to compute, written as in thresholds of a load path."
    )
    design: Design | None = Field(
        default=None, description='Design of the variants: "grid", "list" or "latin" (Latin hypercube).'
    )
    samples: Count | None = Field(default=None, description="Number of variants of a Latin hypercube.")
    seed: int = Field(default=0, ge=0, strict=True, description="Seed of the random numbers.")


def validate_study(data: Mapping[str, Any], source: str, line_of: Callable[[Place], int]) -> StudyFile:
    """Validate the contents of a study file; see `signorini.model.validate` for ``source`` and ``line_of``.

    Raises
    ------
    InputError
        Lists every problem with its place.
    """
    try:
        return StudyFile.model_validate(data)
    except ValidationError as error:
        raise explained(error, StudyFile, data, source, line_of) from None
