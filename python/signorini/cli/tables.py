"""Tables on the terminal, whose first column shows what kind each support is."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from signorini.analysis.check import Check
from signorini.analysis.solve import Results
from signorini.cli.cells import in_unit, number, per_area, point, table, unit_of
from signorini.cli.governing import print_combined
from signorini.discretise import Discretisation
from signorini.model import Support, Units
from signorini.results.result import Result
from signorini.results.support_result import SupportResult
from signorini.results.support_words import MEANINGS, SYMBOLS, describe, kinds

_PLAIN = {"down": "^", "up": "v", "both": "<>", "fixed": "=", "elastic": "~"}
_MOST_OPEN = 8
"""Open points named below a table; where more are open their number says enough."""
_MOST_LISTED = 20
"""Combinations listed by `check`, and as many again of those that cannot be balanced."""
_ROUNDING = 1e-12
"""Part of the largest value of its kind below which a figure shows zero."""


def print_results(console: Console, results: Results) -> None:
    """Print every combination: supports, certificate, extremes, probes."""
    _print_model(console, results.discretisation)
    if results.model.tabulated:
        console.print()
        print_combined(console, results.combined, results.full)
    for result in results.full.values() if not results.model.tabulated else ():
        console.print()
        if result.status == "solved":
            _print_result(console, result)
        else:
            console.print(Text(f"{result.name}: no equilibrium", style="bold red"))
    console.print()
    _print_legend(console, results.discretisation.model.support)


def print_check(console: Console, check: Check) -> None:
    """Print a model's size, its supports and the resultants of its combinations."""
    found = check.discretisation
    model, units = found.model, found.model.units
    _print_model(console, found)
    console.print()
    supports = table("", "support", "kind", right=["nodes held", "springs", "contact points"])
    for index, support in enumerate(model.support):
        held = found.held.support.reshape(-1, 3)[found.held.dofs.reshape(-1, 3).any(axis=1)]
        counts = (
            int((held == index).any(axis=1).sum()),
            int((found.springs.support == index).sum()),
            int((found.contacts.support == index).sum()),
        )
        supports.add_row(_symbol(support, console), Text(support.name), describe(support), *map(str, counts))
    console.print(supports)
    console.print()
    right = [f"load{in_unit(units.force)}", f"acts at{in_unit(units.length)}", "balanced", "limit"]
    loads = table("combination", right=right)
    listed = [r for number, r in enumerate(check.resultants) if number < _MOST_LISTED or r.message]
    for resultant in listed[: 2 * _MOST_LISTED]:
        at = point(resultant.at) if resultant.at else f"couple {point(resultant.couple)}"
        verdict = Text("no", style="bold red") if resultant.message else Text("just" if resultant.brink else "yes")
        none = "not asked" if found.model.tabulated else "none"
        limit = f"{resultant.limit[0]} at {resultant.limit[1]:.4g}" if resultant.limit else none
        loads.add_row(Text(resultant.name), number(resultant.force), at, verdict, Text(limit))
    console.print(loads)
    if left := len(check.resultants) - len(listed[: 2 * _MOST_LISTED]):
        unbalanced = sum(bool(resultant.message) for resultant in check.resultants)
        console.print(f"and {left} more; of all {len(check.resultants)} combinations {unbalanced} cannot be balanced")
    console.print()
    _print_legend(console, model.support)


def _print_model(console: Console, found: Discretisation) -> None:
    model = found.model
    if model.title:
        console.print(Text(model.title, style="bold"))
    one_sided = int((~found.contacts.two_sided).sum())
    console.print(
        f"{model.plate.shape}, {len(found.mesh.elements)} elements {model.plate.element}, "
        f"{found.mesh.node_count} nodes, {found.dof_count} dofs, {one_sided} one-sided contact points"
    )


def _print_result(console: Console, result: Result) -> None:
    units = result.model.units
    before = f" after {' and '.join(result.unsettled)} did not settle" if result.unsettled else ""
    how = f": solved by {result.method}{before}, {result.iterations} {result.counted}"
    console.print(Text(result.name, style="bold") + Text(how))
    rows = table("", "support", "kind", right=[f"reaction{in_unit(units.force)}", "closed", "open"])
    least = _ROUNDING * float(abs(result.nodal_reaction).max())
    for support, found in zip(result.model.support, result.supports, strict=True):
        rows.add_row(
            _symbol(support, console),
            Text(found.name),
            found.kind,
            number(found.reaction if abs(found.reaction) > least else 0.0),
            str(found.closed_count),
            str(found.open_count),
        )
    if len(result.supports) > 1:
        rows.add_section()
        total = sum(found.reaction for found in result.supports)
        counts = [sum(getattr(found, count) for found in result.supports) for count in ("closed_count", "open_count")]
        rows.add_row("", "all", "", number(total), *map(str, counts))
    console.print(rows)
    for found in result.supports:
        _print_extent(console, found, units)
    _print_deflection(console, result)
    for one in result.not_unique:
        console.print(Text(f"not unique: {one}", style="yellow"))
    console.print(Text(f"certificate {result.certificate}", style="" if result.certificate.passed else "bold red"))
    if result.probes:
        console.print(_probes(result, units))


def _print_extent(console: Console, found: SupportResult, units: Units) -> None:
    """Which points are open, or how large the area in contact is."""
    if found.place == "at" and 0 < found.open_count <= _MOST_OPEN:
        console.print(f"{found.name}, open: {', '.join(map(point, found.positions[~found.closed].tolist()))}")
    if found.contact_area is not None and found.max_pressure is not None:
        area = f"{number(found.contact_area)}{unit_of(units.length, 2)}"
        pressure = f"{number(found.max_pressure)} {per_area(units)}".rstrip()
        console.print(f"{found.name}, in contact: {area}, largest pressure {pressure}")


def _print_deflection(console: Console, result: Result) -> None:
    unit = unit_of(result.model.units.length)
    ends = (("max", int(result.deflection.argmax())), ("min", int(result.deflection.argmin())))
    parts = (
        f"{name} {number(float(result.deflection[node]))}{unit} at {point(result.mesh.points[node].tolist())}"
        for name, node in ends
    )
    console.print(f"deflection, positive down: {', '.join(parts)}")


def _probes(result: Result, units: Units) -> Table:
    moment = f" [{units.force} {units.length}/{units.length}]" if units.force and units.length else ""
    shear = f" [{units.force}/{units.length}]" if units.force and units.length else ""
    titles = [f"deflection{in_unit(units.length)}", "θx", "θy", f"mx{moment}", "my", "mxy", f"qx{shear}", "qy"]
    pressed = any(probe.pressure is not None for probe in result.probes)
    rows = table(f"probe{in_unit(units.length)}", right=titles + pressed * [f"pressure{in_unit(per_area(units))}"])
    rounding = [_ROUNDING * float(abs(field).max()) for field in result.fields.values()]
    for probe in result.probes:
        values = (probe.deflection, *probe.rotation, *probe.moment, *probe.shear)
        shown = (value if abs(value) > least else 0.0 for value, least in zip(values, rounding, strict=True))
        pressure = pressed * ["" if probe.pressure is None else number(probe.pressure, 5)]
        rows.add_row(point(probe.at), *(number(value, 5) for value in shown), *pressure)
    return rows


def _print_legend(console: Console, supports: Sequence[Support]) -> None:
    marks = _marks(console)
    used = {kind for support in supports for kind in kinds(support)}
    console.print("  ".join(f"{marks[kind]} {meaning}" for kind, meaning in MEANINGS.items() if kind in used))


def _symbol(support: Support, console: Console) -> str:
    return "".join(_marks(console)[kind] for kind in kinds(support))


def _marks(console: Console) -> dict[str, str]:
    return SYMBOLS if console.encoding.lower().startswith("utf") else _PLAIN
