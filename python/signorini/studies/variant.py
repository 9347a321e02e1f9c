"""Solve one variant of a study and return it as one row of the study's table."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any

from signorini._core import __version__
from signorini.analysis.estimate import Estimates, estimates_of
from signorini.analysis.results import Results
from signorini.analysis.solve import solve
from signorini.base.provenance import commit
from signorini.base.reuse import Reuse
from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError, Place, SignoriniError
from signorini.model import Model, validate
from signorini.studies.parameters import Value, changed

_REUSE = Reuse()
"""Meshes, element matrices, orderings and factors of earlier variants, stored for reuse in this process."""

Row = dict[str, Any]
"""One row of a study's table, for one variant: values by the names of columns."""


def program() -> str:
    """Return version and commit of signorini, which must be the same for all rows of a study."""
    return f"{__version__} {commit() or ''}".strip()


@dataclass(frozen=True)
class Variant:
    """A variant: the template's tables as JSON, and for each parameter its place in the tables and its value."""

    number: int
    program: str
    template: str
    places: tuple[Place, ...]
    names: tuple[str, ...]
    values: tuple[Value, ...]
    results: tuple[str, ...]

    @property
    def model(self) -> Model:
        """The validated model of the variant: the template with the values of the parameters."""
        tables = json.loads(self.template)
        for place, value in zip(self.places, self.values, strict=True):
            tables = changed(tables, place, value)
        return validate(tables)

    @property
    def unsolved(self) -> Row:
        """The row of the variant before it is solved: parameters, and empty results."""
        row: Row = {"row": self.number, **dict(zip(self.names, self.values, strict=True))}
        row |= {"status": "solved", "message": "", "model_sha256": "", "elements": 0, "certificate": math.nan}
        for name in self.results:
            row |= {name: math.nan, f"plus_minus:{name}": math.nan, f"combination:{name}": ""}
        return row

    def failed(self, why: str) -> Row:
        """Return the row of the variant with status "failed" and the reason ``why``."""
        return self.unsolved | {"status": "failed", "message": why}


class OtherProgramError(SignoriniError):
    """Raised if a worker runs another version of signorini than the process that started the study."""


def solved(variant: Variant) -> Row:
    """Solve a variant; return its row.

    ``status`` is "solved", "no_equilibrium" if a combination has no equilibrium, "not_certified", "refused" if the
    model is invalid, or "failed"; ``message`` is the reason. The row has the value of each result in the governing
    combination: the largest value for maxima and utilisations, the smallest for minima, and the value with the largest
    magnitude for other numbers.

    Raises
    ------
    OtherProgramError
        If this process runs another version of signorini than the process that started the study.
    """
    if variant.program != program():
        raise OtherProgramError(
            f"A worker runs signorini {program()}, the study {variant.program}. "
            "Install the same version on all workers."
        )
    row = variant.unsolved
    try:
        model = variant.model
        row["model_sha256"] = model.provenance.sha256
        with _REUSE:
            results = solve(model)
            estimates = estimates_of(results, lambda progress: None) if model.estimated else None
    except NoEquilibriumError as error:
        return row | {"status": "no_equilibrium", "message": str(error)}
    except NotCertifiedError as error:
        return row | {"status": "not_certified", "message": str(error)}
    except InputError as error:
        return row | {"status": "refused", "message": str(error)}
    except (SignoriniError, MemoryError) as error:
        return variant.failed(str(error) or "the memory is exhausted")
    if results.unbalanced_count:
        name, why = next(iter(results.unbalanced.items()))
        row |= {"status": "no_equilibrium", "message": f"{name}: {why}"}
    row |= {
        "elements": len(results.discretisation.mesh.elements),
        "certificate": max(results.combined.certificate.values()),
    }
    for name in variant.results:
        row |= _numbers(results, estimates, name)
    return row


def _numbers(results: Results, estimates: Estimates | None, name: str) -> Row:
    """Return columns of one result: value, half-width, governing combination; empty if no combination has it."""
    governing = results.governing_value(name)
    if governing is None:
        return {}
    value, row = governing
    catalogue = results.combined.layout.catalogue
    one = catalogue.numbers[catalogue.by_name[name]]
    width = None if estimates is None else estimates.half_width(one.column, row)
    return {
        name: value,
        f"plus_minus:{name}": math.nan if width is None else width,
        f"combination:{name}": results.key(row),
    }
