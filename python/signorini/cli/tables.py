"""Print results, or the answer of `signorini check`: tables of each combination, or a summary of many combinations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from rich.console import Console
from rich.text import Text

from signorini.accuracy.comparison import Estimate
from signorini.accuracy.half_width import largest_of
from signorini.analysis.check import ASKED, Check
from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.base.numbers import in_unit, number, size_of
from signorini.cli.checks import print_checks
from signorini.cli.governing import MeanRow, print_bearings, print_combined, print_governing, print_means
from signorini.cli.grid import UNSETTLED, Column, Grid, cell, in_title, numbers, say, say_checked, unit_of
from signorini.cli.sensitivities import print_sensitivities
from signorini.cli.sentences import MAX_KINDS, SEVERAL, Labels, kind_of, lifted, of_bolts, resting
from signorini.contact.certificate import FIGURES
from signorini.discretise import Discretisation
from signorini.errors import length, point
from signorini.model import Model, Support
from signorini.output.names import JSON
from signorini.output.warnings import warnings_of
from signorini.results.marks import case_totals
from signorini.results.quantities import (
    AT_BOLTS,
    AT_PROBES,
    FIELDS,
    LINEAR,
    MEAN_SIDES,
    MEANS,
    OF_SHEAR,
    REINFORCEMENT,
    RESULTANTS,
    THROUGH,
    place_of,
)
from signorini.results.result import Result
from signorini.results.support_result import MEANINGS, SYMBOLS, describe, kinds
from signorini.singularities.beside import PEAKS
from signorini.singularities.named import singularities
from signorini.singularities.singularity import Singularity

Widths = Mapping[str, Any] | None
"""Half-widths (±) in the structure of results.json; None if mesh errors are not estimated."""
_PLAIN = {"down": "^", "up": "v", "both": "<>", "fixed": "=", "elastic": "~"}
_MAX_POINTS = 20
"""Largest number of support points for which all reactions are printed; of more points, only the largest reactions."""
_MAX_OPEN = 8
"""Largest number of open support points that are named; of more open points, only their number is printed."""
_MAX_WARNINGS = 20
"""Largest number of warnings, and of shapes moved by snapping, that are printed."""


def print_results(console: Console, results: Results, estimates: Estimates | None) -> None:
    """Print tables of each combination or, from three combinations on, a summary; then warnings and singularities."""
    discretisation, labels = results.discretisation, Labels(results)
    _print_model(console, discretisation)
    if results.model.tabulated:
        console.print()
        print_combined(console, results, estimates, labels)
    elif len(results) >= SEVERAL:
        console.print()
        _print_summary(console, results, estimates, labels)
        _print_largest(console, results, estimates, labels)
        print_bearings(console, results, estimates, labels)
        for group in (*results.model.effective_combinations.groups,) or ("",):
            print_governing(console, results, estimates, labels, group)
        say(console, f"{JSON} has all results of every combination.")
    for result in results.full.values() if not results.model.tabulated and len(results) < SEVERAL else ():
        console.print()
        if result.status == "solved":
            _print_result(console, result, _estimate(estimates, result), results.limits[result.name])
        else:
            say(console, f"{result.name}: no equilibrium", style="bold red")
    console.print()
    print_verdicts(console, results, estimates, labels)
    _print_legend(console, discretisation.model.support)


def print_verdicts(
    console: Console, results: Results, estimates: Estimates | None, labels: Labels | None = None
) -> None:
    """Print checks, sensitivities, warnings, singularities, and the names of combinations printed as C1, C2, ..."""
    labels = labels or Labels(results)
    print_checks(console, results, estimates, labels)
    print_sensitivities(console, results.sensitivities, labels)
    _print_refinement(console, results)
    told = warnings_of(results, estimates)
    _print_warnings(console, {sentence: [labels.code(name) for name in names] for sentence, names in told.items()})
    singular = [singularity for result in results.full.values() for singularity in result.singular]
    if results.model.tabulated:
        singular = [*singularities(results.discretisation, results.model.effective_combinations.cases)]
    _print_singular(console, singular, results.model, f" All in {JSON}.")
    for line in labels.listed():
        say(console, line)
    if labels.named:
        console.print()


def _print_refinement(console: Console, results: Results) -> None:
    """Print elements, dofs and largest half-width of each mesh solved for ``mesh.accuracy``."""
    if not results.refinement:
        return
    shown = Grid([*numbers("elements", "dofs", "largest ±"), Column("of")])
    for step in results.refinement:
        shown.add(str(step.elements), str(step.dofs), f"{step.worst:.2g}", step.what)
    say(console, f"refined to ± {results.model.mesh.accuracy:g} of the largest value of each field")
    shown.show(console, apart=True)


def print_check(console: Console, check: Check) -> None:
    """Print the size of a model, its supports, and the load resultants of its combinations."""
    discretisation = check.discretisation
    model, units = discretisation.model, discretisation.model.units
    _print_model(console, discretisation)
    say(console, check.quality)
    console.print()
    columns = [Column(""), Column("support"), Column("kind", spare=True)]
    supports = Grid([*columns, *numbers("nodes held", "springs", "contact points")], heads=2)
    for index, support in enumerate(model.support):
        held = discretisation.held.support.reshape(-1, 3)[discretisation.held.dofs.reshape(-1, 3).any(axis=1)]
        counts = (
            int((held == index).any(axis=1).sum()),
            int((discretisation.springs.support == index).sum()),
            int((discretisation.contacts.support == index).sum()),
        )
        supports.add(_symbol(support, console), support.name, describe(support), *map(str, counts))
    supports.show(console, apart=True)
    if totals := case_totals(discretisation):
        say(console, f"total of each load case: {', '.join(f'{case} {total}' for case, total in totals.items())}")
        console.print()
    titles = (f"load{in_unit(units.force)}", f"acts at{in_unit(units.length)}", "balanced", "limit")
    loads = Grid([Column("combination"), *numbers(*titles)])
    largest = size_of([resultant.force for resultant in check.resultants])
    listed = [resultant for number, resultant in enumerate(check.resultants) if number < ASKED or resultant.message]
    for resultant in listed[: 2 * ASKED]:
        place = point(resultant.at, discretisation.mesh.size) if resultant.at else f"moment {point(resultant.couple)}"
        verdict = Text("no", style="bold red") if resultant.message else Text("just" if resultant.brink else "yes")
        limit = f"{resultant.limit[1]:.4g} × factored {resultant.limit[0]}" if resultant.limit else "none"
        loads.add(resultant.name, number(resultant.force, largest), place, verdict, limit)
    loads.show(console)
    if more := len(check.resultants) - len(listed[: 2 * ASKED]):
        unbalanced = sum(bool(resultant.message) for resultant in check.resultants)
        say(console, f"and {more} more; {unbalanced} of all {len(check.resultants)} combinations cannot be balanced")
    console.print()
    _print_warnings(console, dict.fromkeys(check.warnings, ()))
    _print_singular(console, check.singular, model)
    _print_legend(console, model.support)


def _print_model(console: Console, discretisation: Discretisation) -> None:
    model = discretisation.model
    if model.title:
        say(console, model.title, style="bold")
    one_sided = int((~discretisation.points.two_sided).sum())
    say(
        console,
        f"{_shapes(model)}, {_elements(discretisation)}, "
        f"{discretisation.mesh.node_count} nodes, {discretisation.dof_count} dofs, "
        f"{one_sided} one-sided contact points",
    )
    for move in discretisation.snapped[:_MAX_WARNINGS]:
        begin, end = (", ".join(length(x, discretisation.mesh.size) for x in xs) for xs in (move.begin, move.end))
        say(console, f"snapped: {move.what} from [{begin}] to [{end}], onto {move.onto}")
    if (more := len(discretisation.snapped) - _MAX_WARNINGS) > 0:
        say(console, f"snapped: {more} more, in results.json")


def _shapes(model: Model) -> str:
    return ", ".join(f"{name}: {plate.shape}" for name, plate in model.plates.items()) or model.plate.shape


def _elements(discretisation: Discretisation) -> str:
    triangles, count = int(discretisation.mesh.triangles.sum()), len(discretisation.mesh.elements)
    kinds = {discretisation.zones.element: count - triangles, "mitc7": triangles}
    return " and ".join(f"{many} elements {kind}" for kind, many in kinds.items() if many)


def _estimate(estimates: Estimates | None, result: Result) -> Estimate | None:
    return None if estimates is None else estimates[result.name]


def _widths(estimates: Estimates | None, result: Result) -> Widths:
    return None if estimates is None else estimates[result.name].plus_minus


def _print_summary(console: Console, results: Results, estimates: Estimates | None, labels: Labels) -> None:
    model = results.discretisation.model
    names = [f"{support.name}{in_unit(model.units.force)}" for support in model.support]
    unit = in_unit(model.units.length)
    columns = [*numbers(f"largest deflection{unit}", f"smallest{unit}", "open points")]
    shown = Grid([Column("combination", coded=labels.numbered), *columns, *numbers(*names)])
    size = max((size_of(result.deflection) for result in results.full.values() if result.supports), default=0.0)
    for result in results.full.values():
        if result.status != "solved":
            shown.add(Text(labels.cell(result.name), style="bold red"), "", "", "", *[""] * len(names))
            continue
        widths, load = _widths(estimates, result), largest_of(result)["reaction"]
        pairs = (("max", result.deflection.max()), ("min", result.deflection.min()))
        ends = (cell(float(end), widths, ("deflection", name), size) for name, end in pairs)
        reactions = (
            cell(support.reaction, widths, (*place_of(model, index), "reaction"), load)
            for index, support in enumerate(result.supports)
        )
        opened = sum(support.open_count for support in result.supports)
        shown.add(labels.cell(result.name), *ends, str(opened), *reactions)
    shown.show(console)
    if results.unbalanced:
        say(console, f"without equilibrium: {', '.join(results.unbalanced)}", style="bold red")
    solved = [result for result in results.full.values() if result.status == "solved"]
    for name, sentence in ((result.name, lifted(result)) for result in solved):
        if sentence:
            say(console, f"{labels.in_sentence(name)}: {sentence}")
    console.print()


def _print_largest(console: Console, results: Results, estimates: Estimates | None, labels: Labels) -> None:
    """Print extreme moments and shears of all combinations, largest certificate errors, and the meshes behind ±."""
    solved = [result for result in results.full.values() if result.status == "solved"]
    if not solved:
        return
    model, size = results.model, results.discretisation.mesh.size
    where = f"at{in_unit(model.units.length)}"
    by = Column("of", coded=labels.numbered)
    columns = [*numbers("largest", where), by, *numbers("smallest", where), by]
    shown, means = Grid([Column("moments and shears"), *columns], unknown=UNSETTLED), list[MeanRow]()
    for name in RESULTANTS:
        scale, cells = max(largest_of(result)[FIELDS[name].kind] for result in solved), []
        most = max(solved, key=lambda result: result.extremes[name].max)
        least = min(solved, key=lambda result: result.extremes[name].min)
        for side, result in (("max", most), ("min", least)):
            value, place = getattr(result.extremes[name], side), getattr(result.extremes[name], f"{side}_at")
            cells += [cell(value, _widths(estimates, result), ("fields", name, side), scale, 5)]
            cells += [point(place, size), labels.cell(result.name)]
        shown.add(FIELDS[name].label(model.units), *cells)
        means.append(_means(solved, name, scale, lambda result: _widths(estimates, result), labels))
    shown.show(console)
    singular = {number: [each for result in solved for each in result.excluding(number)] for number in PEAKS}
    print_means(console, singular, means, model.units, labels)
    console.print()
    worst = ", ".join(f"{name} {max(getattr(result.certificate, name) for result in solved):.1e}" for name in FIGURES)
    say(console, f"worst certificate passed: {worst}")
    estimate = _estimate(estimates, solved[0])
    say_checked(console, () if estimate is None else estimate.elements, model.estimated)
    console.print()


def _means(
    results: Sequence[Result], name: str, size: float, widths: Callable[[Result], Widths], labels: Labels | None = None
) -> MeanRow:
    """Table cells of the largest and smallest mean of the field ``name`` at singular places; empty without means."""
    cells: list[list[str]] = []
    for side, sign in zip(MEAN_SIDES, (1.0, -1.0), strict=True):
        with_mean = [result for result in results if not np.isnan(getattr(result.extremes[name], side))]
        most = max(with_mean, key=lambda result: sign * getattr(result.extremes[name], side), default=None)
        cells.append([])
        if most is not None:
            value, place, width = (getattr(most.extremes[name], f"{side}{part}") for part in ("", "_at", "_width"))
            mean = cell(value, widths(most), ("fields", name, side), size, 5)
            by = [labels.cell(most.name)] if labels else []
            cells[-1] = [mean, point(place, most.mesh.size), length(width), *by]
    return FIELDS[name].label(results[0].model.units), cells


def _print_result(console: Console, result: Result, estimate: Estimate | None, limit: tuple[str, float] | None) -> None:
    units, largest = result.model.units, largest_of(result)
    widths, load = None if estimate is None else estimate.plus_minus, largest["reaction"]
    failed = f" after {' and '.join(result.unsettled)} did not converge" if result.unsettled else ""
    method = f": solved by {result.method}{failed}, {result.iterations} {result.counted}"
    say(console, Text(result.name, style="bold") + Text(method))
    columns = [Column(""), Column("support"), Column("kind", spare=True)]
    rows = Grid([*columns, *numbers(f"reaction{in_unit(units.force)}", "closed", "open")], heads=2)
    for index, (support, values) in enumerate(zip(result.model.support, result.supports, strict=True)):
        counts = (str(values.closed_count), str(values.open_count))
        reaction = cell(values.reaction, widths, (*place_of(result.model, index), "reaction"), load)
        rows.add(_symbol(support, console), values.name, values.kind, reaction, *counts)
    if len(result.supports) > 1:
        rows.last_apart = True
        grounded = zip(result.model.support, result.supports, strict=True)
        total = sum(values.reaction for support, values in grounded if support.between is None)
        closed = sum(values.closed_count for values in result.supports)
        opened = sum(values.open_count for values in result.supports)
        rows.add("", "all", "", number(total, load), str(closed), str(opened))
    rows.show(console)
    _print_lines(console, result, widths, largest)
    _print_points(console, result, widths, largest)
    for sentence in (*resting(result, widths, largest["pressure"]), *of_bolts(result, widths), lifted(result)):
        if sentence:
            say(console, sentence)
    for name, plate in result.members.items():
        plate_widths = widths if not name or widths is None else widths["plates"][name]
        _print_deflection(console, plate, plate_widths, f"{name}: " if name else "")
        _print_extremes(console, plate, plate_widths, largest_of(plate))
    if limit is not None:
        say(console, f"Equilibrium ends at {limit[1]:.4g} × the factored case {limit[0]}, other cases unchanged")
    say(console, f"certificate {result.certificate}", style="" if result.certificate.passed else "bold red")
    say_checked(console, () if estimate is None else estimate.elements, result.model.estimated)
    if result.probes:
        console.print()
        _print_probes(console, result, widths, largest)
    _print_through(console, result, widths, largest)


def _print_lines(console: Console, result: Result, widths: Widths, largest: Mapping[str, float]) -> None:
    """Print the extremes of the reaction per length of each line support, and its largest concentrated force."""
    units, size, where = result.model.units, result.mesh.size, f"at{in_unit(result.model.units.length)}"
    titles = f"largest{in_unit(units.force_by_length(-1))}", where, "smallest", where
    shown = Grid([Column("reaction per length"), *numbers(*titles, f"corner{in_unit(units.force)}", where)])
    lines = [(index, support.line) for index, support in enumerate(result.supports) if support.line is not None]
    for index, line in lines:
        of_support, cells = place_of(result.model, index), list[str]()
        for name in ("max_per_length", "min_per_length"):
            value, place = getattr(line, name), getattr(line, f"{name}_at")
            cells += [cell(value, widths, (*of_support, name), largest["per_length"]), point(place, size)]
        if len(line.corners):
            most = int(np.abs(line.corner_reactions).argmax())
            path = (*of_support, "corners", most, "reaction")
            force = cell(float(line.corner_reactions[most]), widths, path, largest["reaction"])
            cells += [force, point(line.corners[most].tolist(), size)]
        shown.add(result.supports[index].name, *cells, *[""] * (6 - len(cells)))
    if lines:
        console.print()
        shown.show(console, apart=True)


def _print_points(console: Console, result: Result, widths: Widths, largest: Mapping[str, float]) -> None:
    """Print the reactions of supports at points; of more than 20 points, only the largest reactions."""
    supports, units, size = result.supports, result.model.units, result.mesh.size
    every = [(i, k) for i, values in enumerate(supports) if values.place == "at" for k in range(len(values.reactions))]
    if not every:
        return
    listed = sorted(every, key=lambda pair: -abs(supports[pair[0]].reactions[pair[1]]))[:_MAX_POINTS]
    titles = [f"at{in_unit(units.length)}", f"reaction{in_unit(units.force)}"]
    tightened = any(supports[index].preloads is not None for index, _ in listed)
    titles += [f"{quantity.name.replace('_', ' ')}{in_unit(units.force)}" for quantity in AT_BOLTS if tightened]
    titles.append(f"gap{in_unit(units.length)}")
    shown = Grid([Column("point"), *numbers(*titles), Column("state")])
    for index, k in sorted(listed):
        values, path = supports[index], (*place_of(result.model, index), "points", k)
        name = f"{values.name}[{k + 1}]" if len(values.reactions) > 1 else values.name
        gap = cell(float(values.gaps[k]), widths, (*path, "gap"), largest["deflection"])
        reaction = cell(float(values.reactions[k]), widths, (*path, "reaction"), largest["reaction"])
        place = point(values.positions[k].tolist(), size)
        bolts = [""] * len(AT_BOLTS) * tightened
        if values.bolt_forces:
            columns = ((quantity.name, float(values.bolt_forces[quantity.name][k])) for quantity in AT_BOLTS)
            bolts = [cell(value, widths, (*path, name), largest["reaction"]) for name, value in columns]
        shown.add(name, place, reaction, *bolts, gap, values.states[k])
    console.print()
    shown.show(console)
    if more := len(every) - len(listed):
        say(console, f"and {more} more points with smaller reactions, all in reactions.csv")
        for values in result.supports:
            if values.place == "at" and 0 < values.open_count <= _MAX_OPEN:
                places = (point(at, size) for at in values.positions[~values.closed].tolist())
                say(console, f"{values.name}, open: {', '.join(places)}")
    console.print()


def _print_deflection(console: Console, result: Result, widths: Widths, prefix: str) -> None:
    unit, largest = unit_of(result.model.units.length), size_of(result.deflection)
    values = result.extremes["deflection"]
    parts = (
        f"{name} {cell(value, widths, ('deflection', name), largest)}{unit} at {point(at, result.mesh.size)}"
        for name, value, at in (("max", values.max, values.max_at), ("min", values.min, values.min_at))
    )
    say(console, f"{prefix}deflection, positive down: {', '.join(parts)}")


def _print_extremes(console: Console, result: Result, widths: Widths, largest: Mapping[str, float]) -> None:
    """Print extremes of moments and shears, the places excluded from them, and mean values at these places."""
    units, size = result.model.units, result.mesh.size
    where = f"at{in_unit(units.length)}"
    shown = Grid([Column("moments and shears"), *numbers("largest", where, "smallest", where)], unknown=UNSETTLED)
    means = list[MeanRow]()
    for name in (*RESULTANTS, *(name for name in REINFORCEMENT if name in result.extremes)):
        values, cells, kind = result.extremes[name], [], FIELDS[name].kind
        for side, value, at in (("max", values.max, values.max_at), ("min", values.min, values.min_at)):
            cells += [cell(value, widths, ("fields", name, side), largest[kind], 5), point(at, size)]
        shown.add(FIELDS[name].label(units), *cells)
        means.append(_means([result], name, largest[kind], lambda _: widths))
    console.print()
    shown.show(console)
    print_means(console, {number: result.excluding(number) for number in PEAKS}, means, units)


def _print_probes(console: Console, result: Result, widths: Widths, largest: Mapping[str, float]) -> None:
    """Print a table of the fields at probes, with a row per field and a column per probe."""
    units = result.model.units
    touching = any(probe.pressure is not None for probe in result.probes)
    quantities = [each for each in AT_PROBES if each.name in LINEAR or (each.name == "pressure" and touching)]
    shown = Grid([Column(f"at{in_unit(units.length)}"), *numbers(*(each.label(units) for each in quantities))])
    plates = [f"{probe.plate} " if probe.plate else "" for probe in result.model.probe for _ in probe.at]
    for index, probe in enumerate(result.probes):
        cells = []
        for quantity in quantities:
            path = ("probes", index, *quantity.path)
            value = float(result.numbers[result.catalogue.by_path[path]])
            cells.append("" if np.isnan(value) else cell(value, widths, path, largest[quantity.kind], 5))
        shown.add(f"{plates[index]}{point(probe.at, result.mesh.size)}", *cells)
    shown.show_turned(console)


def _print_through(console: Console, result: Result, widths: Widths, largest: Mapping[str, float]) -> None:
    """Print a row for each section with its section forces, and for each strip with the extremes of its mean moment."""
    units, size = result.model.units, result.mesh.size
    if result.sections:
        console.print()
        shown = Grid([Column("section"), *numbers(*(in_title(quantity, units) for quantity in THROUGH))])
        for index, section in enumerate(result.sections):
            values = ((each, getattr(section, each.name), ("sections", index, each.name)) for each in THROUGH)
            shown.add(section.name, *(cell(value, widths, path, largest[each.kind]) for each, value, path in values))
        shown.show(console)
    if result.strips:
        console.print()
        where = f"at{in_unit(units.length)}"
        shown = Grid([Column("strip"), *numbers(f"largest mean {in_title(MEANS[0], units)}", where, "smallest", where)])
        for index, strip in enumerate(result.strips):
            cells = []
            for key, station in (("max_moment", strip.sagging), ("min_moment", strip.hogging)):
                cells.append(cell(station.moment, widths, ("strips", index, key), largest["moment"], 5))
                cells.append(point(station.at, size))
            shown.add(strip.name, *cells)
        shown.show(console)
    if result.punching:
        console.print()
        shown = Grid([Column("column"), *numbers(*(in_title(quantity, units) for quantity in OF_SHEAR))])
        for index, column in enumerate(result.punching):
            values = ((each, column.numbers[each.name], ("punching", index, each.name)) for each in OF_SHEAR)
            shown.add(column.name, *(cell(value, widths, path, largest[each.kind]) for each, value, path in values))
        shown.show(console)


def _print_warnings(console: Console, warnings: Mapping[str, Sequence[str]]) -> None:
    """Print each warning with the names of the combinations that it concerns, if it does not concern all."""
    for sentence, names in list(warnings.items())[:_MAX_WARNINGS]:
        where = f" ({', '.join(names)})" if names else ""
        say(console, f"Warning{where}: {sentence}", style="yellow")
    if (more := len(warnings) - _MAX_WARNINGS) > 0:
        say(console, f"And {more} more warnings, all in results.json.", style="yellow")
    if warnings:
        console.print()


def _print_singular(console: Console, named: Iterable[Singularity], model: Model, rest: str = "") -> None:
    """Print a line about singular results and a line about results for which this mesh is too coarse.

    For each kind of singularity the first position and the number of further positions are printed; a load is named by
    its load case.
    ``rest`` is appended to each line.
    """
    cases, every = {load.case for load in model.load}, list(dict.fromkeys(named))
    for word, limited in (("Singular", False), ("Unresolved", True)):
        selected = [singularity for singularity in every if singularity.limited == limited]
        kinds: dict[str, list[Singularity]] = {}
        for each in selected:
            case = f' (case "{each.source}")' if each.source in cases else ""
            plate = f"{each.plate}: " if each.plate else ""
            kinds.setdefault(plate + kind_of(each) + case, []).append(each)
        if not kinds:
            continue
        listed = []
        for kind, same_kind in list(kinds.items())[:MAX_KINDS]:
            count = sum(1 if each.line else len(each.where) for each in same_kind)
            where = f" at {point(same_kind[0].where[0])}" if same_kind[0].where else ""
            listed.append(f"{kind}{where}{f' and {count - 1} more' if count > 1 else ''}")
        listed += [f"{len(kinds) - MAX_KINDS} more kinds"] * (len(kinds) > MAX_KINDS)
        *first, last = dict.fromkeys(number for each in selected for number in each.numbers)
        quantities = " and ".join(filter(None, (", ".join(first), last)))
        is_or_are, has = ("are", "have") if first else ("is", "has")
        means = f"{is_or_are} too small on this mesh" if limited else f"{has} no limit as the mesh is refined"
        advice = " ".join(dict.fromkeys(each.advice for each in selected))
        say(console, f"{word}, {quantities} {means}: {'; '.join(listed)}. {advice}{rest}", style="yellow")
    if every:
        console.print()


def _print_legend(console: Console, supports: Sequence[Support]) -> None:
    marks = _marks(console)
    used = {kind for support in supports for kind in kinds(support)}
    entries = [f"{marks[kind]} {meaning}" for kind, meaning in MEANINGS.items() if kind in used]
    entries += [f"without {marks['elastic']}: rigid"] * any(not support.is_compliant for support in supports)
    say(console, "  ".join(entries))


def _symbol(support: Support, console: Console) -> str:
    return "".join(_marks(console)[kind] for kind in kinds(support))


def _marks(console: Console) -> dict[str, str]:
    return SYMBOLS if console.encoding.lower().startswith("utf") else _PLAIN
