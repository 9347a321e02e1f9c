"""The catalogue of a model: the list of the numbers that its results have."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.results.line_reactions import lines_of
from signorini.results.of_plates import places_in_plates
from signorini.results.quantities import Catalogue
from signorini.results.support_points import SupportPoints


@kept
def catalogue_of(
    discretisation: Discretisation, fields: tuple[str, ...], part: Literal["all", "tables", "paths"] = "all"
) -> Catalogue:
    """List the numbers of a model's results, computed once; ``fields`` are the fields whose extremes are listed."""
    points = [SupportPoints.of(discretisation, index) for index in range(len(discretisation.model.support))]
    counts, opens = [len(of.positions) for of in points], [of.rows.size > 0 for of in points]
    corners = {index: len(line.corners) for index, line in lines_of(discretisation).items()}
    result = Catalogue.of(discretisation.model, counts, opens, corners, fields)
    result = {"all": result, "tables": result.in_tables, "paths": result.along_paths}[part]
    own = [catalogue_of(plate.own, fields, part) for plate in discretisation.plates]
    return replace(result, in_plates=places_in_plates(discretisation.model, result.numbers, own)) if own else result
