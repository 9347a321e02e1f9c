"""What results.json says of one combination in numbers: deflection, fields, supports, probes, sections, strips."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from signorini.results.probe_result import ProbeResult
from signorini.results.result import Result
from signorini.results.section_result import SectionResult, StripResult
from signorini.results.support_result import SupportResult


def figures(result: Result) -> dict[str, Any]:
    """Give the keys of a combination that are numbers of the plate; docs/results.md describes them."""
    ends = {name: _listed(asdict(of)) for name, of in result.extremes.items()} if result.status == "solved" else {}
    deflection = ends.pop("deflection", None)
    return {
        "deflection": deflection and {key: deflection[key] for key in ("max", "max_at", "min", "min_at")},
        "fields": ends,
        "supports": [_support(support) for support in result.supports],
        "probes": [_probe(probe) for probe in result.probes],
        **through_json(result.sections, result.strips),
        "profiles": [{"name": one.name, "stations": list(one.rows())} for one in result.profiles.values()],
    }


def through_json(sections: Sequence[SectionResult], strips: Sequence[StripResult]) -> dict[str, Any]:
    """Give the keys sections and strips."""
    return {"sections": [asdict(section) for section in sections], "strips": [_strip(strip) for strip in strips]}


def _support(support: SupportResult) -> dict[str, Any]:
    found = {"name": support.name, "kind": support.kind, **total(support)}
    found["closed_part"] = support.closed_part
    found["max_pressure_at"] = support.max_pressure_at and list(support.max_pressure_at)
    found["contact_boundary"] = [line.tolist() for line in support.contact_boundary]
    if support.area is not None:
        return found
    return found | {"points" if support.place == "at" else "nodes": list(point_figures(support))}


def total(support: SupportResult) -> dict[str, Any]:
    """Say what a support does as a whole."""
    return {
        "reaction": support.reaction,
        "closed": support.closed_count,
        "open": support.open_count,
        "contact_area": support.contact_area,
        "max_pressure": support.max_pressure,
        "max_tension": support.max_tension,
    }


def point_figures(support: SupportResult) -> Iterator[dict[str, Any]]:
    """Say what a support does at each of its points; of a held edge the consistent nodal forces."""
    columns = (support.positions, support.reactions, support.gaps, support.closed)
    for at, reaction, gap, closed in zip(*(column.tolist() for column in columns), strict=True):
        yield {"at": at, "reaction": reaction, "gap": gap, "state": "closed" if closed else "open"}


def _probe(probe: ProbeResult) -> dict[str, Any]:
    designed = _listed(probe.design_moment)
    return _listed(asdict(probe)) | {"principal_moment": list(probe.principal_moment), "design_moment": designed}


def _strip(strip: StripResult) -> dict[str, Any]:
    most, least = strip.sagging, strip.hogging
    ends = {"max_moment": most.moment, "max_at": list(most.at), "min_moment": least.moment, "min_at": list(least.at)}
    return {"name": strip.name, **ends, "stations": [_listed(asdict(station)) for station in strip.stations]}


def _listed(parts: Mapping[str, Any]) -> dict[str, Any]:
    return {name: list(value) if isinstance(value, tuple) else value for name, value in parts.items()}
