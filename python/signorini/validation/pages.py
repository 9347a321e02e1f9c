"""Write the pages of validation: a page for each case, an index by feature, the comparison of ± with true errors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from statistics import median
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from signorini import _core
from signorini.base.files import replacing_together
from signorini.base.numbers import estimated, number
from signorini.output.directory import former_pages
from signorini.output.names import COVERAGE, INDEX
from signorini.validation.case import Case, Number
from signorini.validation.runner import EXACT, Comparison, Outcome, model_of


@dataclass(frozen=True)
class Row:
    """One number of a case on one mesh: its relative error, the estimated ±, and the error of the reference."""

    case: Case
    number: Number
    elements: int
    error: float
    width: float | None
    own: float
    covered: bool | None

    @property
    def verdict(self) -> str:
        """Whether ± covers the error of the number, by itself or only together with the reference's own error."""
        if self.covered is None or self.width is None:
            return "no limit"
        if self.error <= self.width + EXACT:
            return "yes"
        return "within the reference's own error" if self.covered else "**no**"


def rows_of(outcomes: Iterable[Outcome]) -> Iterator[Row]:
    """Yield every number on every mesh, without cases that have no mesh and printed values that are not reproduced."""
    for outcome in outcomes:
        for one in outcome.comparisons:
            if one.number.differs or outcome.case.direct:
                continue
            size = one.number.magnitude
            for mesh, error, width, covered in zip(outcome.meshes, one.errors, one.widths, one.covered, strict=True):
                relative = None if width is None else width / size
                own = one.number.uncertainty / size
                yield Row(outcome.case, one.number, mesh.elements, error, relative, own, covered)


def names_of(cases: Iterable[Case]) -> Iterator[str]:
    """Yield the names of the files that `write_pages` writes for cases, except pictures."""
    yield from (INDEX, COVERAGE)
    for case in cases:
        yield f"{case.name}.md"
        if not case.direct:
            yield f"{case.name}.toml"


def write_pages(outcomes: Sequence[Outcome], directory: Path) -> None:
    """Write an index, a comparison of ± with true errors, and page, input file and pictures of each case.

    All files are written, or none. They replace those of an earlier validation; files of other programs stay.
    """
    with replacing_together(directory, former_pages, seal=INDEX) as beside:
        _write_pages(outcomes, beside)


def _write_pages(outcomes: Sequence[Outcome], directory: Path) -> None:
    templates = _templates()
    for outcome in outcomes:
        case = outcome.case
        page = templates.get_template("case.md.jinja").render(
            case=case,
            outcome=outcome,
            conclusion=_conclusion(outcome),
            uncertain=[one for one in case.numbers if one.uncertainty],
            version=_core.__version__,
        )
        _write(directory / f"{case.name}.md", page)
        if not case.direct:
            _write(directory / f"{case.name}.toml", model_of(case, case.meshes[-1]).to_toml())
        for drawing in chain.from_iterable(outcome.drawings):
            (directory / f"{case.name}{drawing.ending}.png").write_bytes(drawing.png)
    features: dict[str, list[Case]] = {}
    for outcome in outcomes:
        for feature in outcome.case.features:
            features.setdefault(feature, []).append(outcome.case)
    kinds = [outcome.case.kind for outcome in outcomes]
    counts = {kind: kinds.count(kind) for kind in ("analytical", "numerical", "experimental")}
    counts |= {"holding": sum(outcome.holds for outcome in outcomes)}
    counts |= {"total": sum(len(outcome.comparisons) for outcome in outcomes)}
    index = {
        "outcomes": outcomes,
        "features": dict(sorted(features.items())),
        "counts": counts,
        "version": _core.__version__,
    }
    _write(directory / INDEX, templates.get_template("index.md.jinja").render(index))
    rows = list(rows_of(outcomes))
    coverage = templates.get_template("coverage.md.jinja").render(rows=rows, summary=summary(rows))
    _write(directory / COVERAGE, coverage)


def summary(rows: Sequence[Row]) -> dict[str, float]:
    """Count half-widths ± that cover the error, by themselves or with the reference's error; median of ± over error."""
    known = [row for row in rows if row.covered is not None and row.width is not None]
    ratios = [(row.width or 0.0) / row.error for row in known if row.error > max(row.own, EXACT)]
    return {
        "known": len(known),
        "covered": sum(bool(row.covered) for row in known),
        "alone": sum(row.verdict == "yes" for row in known),
        "unknown": len(rows) - len(known),
        "measured": len(ratios),
        "ratio": median(ratios) if ratios else math.nan,
    }


def _conclusion(outcome: Outcome) -> str:
    """Count the numbers that agree with the reference; list those that differ as stated, or miss their tolerance."""
    every = outcome.comparisons
    agreeing = [one for one in every if one.within and not one.number.differs]
    parts = [f"{len(agreeing)} of {len(every)} numbers agree with the reference within the tolerance."]
    for one in every:
        name = one.number.label
        if one.number.differs:
            stated = "as stated" if one.holds else "contrary to the case's statement that the values differ"
            parts.append(f"{name}: {one.errors[-1]:.2g} from the printed value, {stated}. {one.number.differs}")
        elif not one.within:
            parts.append(f"{name} misses its tolerance.")
    return " ".join(parts)


def _write(path: Path, text: str) -> None:
    path.write_text(text.rstrip("\n") + "\n", encoding="utf-8")


def _templates() -> Environment:
    result = Environment(
        loader=PackageLoader("signorini.validation"), undefined=StrictUndefined, trim_blocks=True, autoescape=False
    )
    result.filters |= {
        "shown": lambda value, size: number(value, size, 7),
        "with_width": _with_width,
        "error": lambda value: "" if value is None or math.isnan(value) else f"{value:.1e}",
        "rate": lambda value: "–" if value is None else f"{value:.1f}",
        "verdict": _verdict,
        "zip": lambda first, second: zip(first, second, strict=True),
        "largest": lambda outcome: max(
            (one.errors[-1] for one in outcome.comparisons if not one.number.differs), default=math.nan
        ),
    }
    return result


def _with_width(value: float, width: float | None, size: float) -> str:
    unmeshed: Any = width is not None and math.isnan(width)
    return number(value, size, 7) if unmeshed else estimated(value, width, size, 7)


def _verdict(one: Comparison) -> str:
    if one.holds:
        return "differs, as stated" if one.number.differs else "agrees"
    return "**agrees, against the statement**" if one.within else "**misses**"
