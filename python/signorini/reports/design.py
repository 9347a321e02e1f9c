"""Sections of a report by design codes: strengths, factors of combinations, required reinforcement, checks not made."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from signorini.base.numbers import number
from signorini.base.units import METRES, NEWTONS, steel_unit
from signorini.design import aci318, asce7, en1990
from signorini.design import en1992_bending as en1992
from signorini.discretise.punching import Check
from signorini.model import Case, Combination
from signorini.model.punching import ACI_318, EN_1992
from signorini.reports.blocks import Block, Cell, Table, Text, solved
from signorini.reports.numbers import extremes
from signorini.reports.sections import Contents, codes_of
from signorini.results.envelope import NONE
from signorini.results.quantities import DESIGN_MOMENTS, REINFORCEMENT, on_plate
from signorini.results.result import Result
from signorini.singularities.singularity import away_from

_EQUAL = 1e-9
"""Relative tolerance for equal areas of reinforcement."""
_GAMMAS = {"permanent": "γG", "variable": "γQ", "preload": "γP", "accidental": "γA", "seismic": "γAE"}
_EVER_PRESENT = ("D", "Ev", "P")
"""Symbols of ASCE 7 for loads that act in every combination; loads with other symbols are variable."""


def strengths(of: Contents) -> Iterator[Block]:
    """Yield the strengths and partial factors of concrete and steel, each with its clause."""
    write, rows = of.write, list[Sequence[Cell]]()

    def say(part: str, symbol: str, value: float, unit: str, clause: str, source: str) -> None:
        cells = Cell(number(value, digits=4), value), Cell(unit), Cell(clause), Cell(write(source))
        rows.append([Cell(part), Cell(symbol), *cells])

    own, model = of.results.model.reinforcement, of.results.model
    if own is not None:
        part, stress = write("reinforcement"), _megapascals(of)
        fck, fyk, given = own.fck * stress, own.fyk * stress, own.model_fields_set
        sources = {key: "given" if key in given else "recommended" for key in ("gamma_c", "gamma_s", "alpha_cc")}
        depth, strength = en1992.stress_block(fck)
        say(part, "fck", fck, "MPa", "3.1.2, Table 3.1", "given")
        say(part, "fctm", en1992.tensile_strength(fck), "MPa", "3.1.2, Table 3.1", "computed")
        say(part, "γC", own.gamma_c, "", "2.4.2.4 (1), Table 2.1N", sources["gamma_c"])
        say(part, "αcc", own.alpha_cc, "", "3.1.6 (1)", sources["alpha_cc"])
        fcd = en1992.compressive_strength(fck, own.gamma_c, own.alpha_cc)
        say(part, "fcd = αcc fck / γC", fcd, "MPa", "3.1.6 (1), Eq. (3.15)", "computed")
        say(part, "λ", depth, "", "3.1.7 (3), Eq. (3.19), (3.20)", "computed")
        say(part, "η", strength, "", "3.1.7 (3), Eq. (3.21), (3.22)", "computed")
        say(part, "fyk", fyk, "MPa", "3.2.2 (3)", "given")
        say(part, "γS", own.gamma_s, "", "2.4.2.4 (1), Table 2.1N", sources["gamma_s"])
        say(part, "fyd = fyk / γS", en1992.yield_strength(fyk, own.gamma_s), "MPa", "3.2.7 (2)", "computed")
    for index, check in _punched(of).items():
        table = model.punching[index]
        part = f"{write('punching')} {table.support or table.load}"
        if table.code == EN_1992:
            say(part, "fck", check.fck, "MPa", "3.1.2, Table 3.1", "given")
            say(part, "γC", en1992.GAMMA_C, "", "2.4.2.4 (1), Table 2.1N", "recommended")
            fcd = en1992.compressive_strength(check.fck, en1992.GAMMA_C, en1992.ALPHA_CC)
            say(part, "fcd = fck / γC", fcd, "MPa", "3.1.6 (1), αcc = 1", "computed")
            say(part, "CRd,c = 0.18/γC", 0.18 / en1992.GAMMA_C, "", "6.4.4 (1)", "recommended")
            say(part, "fyk", check.fyk, "MPa", "3.2.2 (3)", "given")
            say(part, "γS", en1992.GAMMA_S, "", "2.4.2.4 (1), Table 2.1N", "recommended")
        else:
            say(part, "f'c", check.fck, "MPa", "ACI 318-19, 19.2.1", "given")
            say(part, "fyt", check.fyk, "MPa", "ACI 318-19, 20.2.2.4", "given")
            say(part, "φ", aci318.PHI, "", "ACI 318-19, 21.2.1", "code")
    head = [write(key) for key in ("part", "symbol", "value", "unit", "only_clause", "source")]
    yield Table(write("strengths"), head, rows)


def _punched(of: Contents) -> dict[int, Check]:
    """Check of one column of each input table [[punching]], by the table's index; it has the strengths in MPa."""
    return {one.column.table: one.check for one in of.results.discretisation.columns.columns}


def _megapascals(of: Contents) -> float:
    """Factor from the model's unit of stress to MPa."""
    units = of.results.model.units
    return NEWTONS[units.force] / METRES[units.length] ** 2 * 1e-6


def factors(of: Contents) -> Iterator[Block]:
    """Yield tables of the rules that generate combinations and of load cases as actions; texts on load patterns."""
    write, model = of.write, of.results.model.original
    rules, symbols = list[Sequence[Cell]](), list[Sequence[Cell]]()
    tables = [one for one in model.combination if one.generate in ("en1990", "asce7")]
    for one in tables:
        for rule in one.rule or ():
            if one.generate == "en1990":
                rules.append([Cell(one.name or rule), Cell(rule), *_en1990(of, one, rule)])
                continue
            for label, _, text in asce7.RULES[rule]:
                cells = Cell(one.name or rule), Cell(f"{rule} {label}"), Cell(text), Cell(asce7.section(rule, text))
                symbols.append(cells)
    head = [write(key) for key in ("part", "rule", "sum_of_actions")]
    yield Table(write("rules"), [*head, write("factors"), write("only_clause"), write("source")], rules)
    yield Table(write("rules_asce"), [*head, write("only_clause")], symbols)
    if tables:
        yield from _actions(of, model.cases, {str(one.generate) for one in tables})
        yield from _patterns(of, model.cases, {str(one.generate) for one in tables})
    for one in model.combination:
        if one.generate == "patterns":
            yield Text(write("pattern_table", name=one.name, cases=", ".join(one.variable or ())))


def _en1990(of: Contents, table: Combination, rule: str) -> Iterator[Cell]:
    """Cells of a rule of EN 1990: expression, factors, clause, and which factors the user gave."""
    expression, clause = en1990.CLAUSES[rule]
    given = table.gamma.values if table.gamma is not None else {}
    gamma = {**en1990.GAMMA[rule], **given}
    yield Cell(expression)
    used = {symbol: gamma[kind] for kind, symbol in _GAMMAS.items() if kind in gamma}
    used |= {"ξ": (table.xi or en1990.XI,)} if rule == "6.10ab" else {}
    yield Cell("; ".join(f"{key} = {' / '.join(f'{value:g}' for value in values)}" for key, values in used.items()))
    yield Cell(clause)
    keys = [f"gamma.{kind}" for kind in given] + [key for key in ("xi", "accidental_leading") if getattr(table, key)]
    yield Cell(f"{of.write('given')}: {', '.join(keys)}" if keys else of.write("recommended"))


def _actions(of: Contents, cases: Mapping[str, Case], codes: set[str]) -> Iterator[Block]:
    """Yield the table of load cases: kind, category, ψ0, ψ1, ψ2, group, and clause."""
    write, rows = of.write, list[Sequence[Cell]]()
    for name, case in cases.items():
        own = cases.get(case.follows or "", case)
        psi = own.representative[1:] if own.kind == "variable" else ()
        shown = [Cell(f"{value:g}", value) for value in psi] or [Cell("–")] * 3
        clause = "" if not psi else f"{write('given')}: psi" if own.psi else "EN 1990, Table A1.1"
        kind = write(own.kind) if own.kind and "en1990" in codes else ""
        symbol = f"{own.asce}: {write(f'asce_{own.asce}')}" if own.asce and "asce7" in codes else ""
        kind = "; ".join(filter(None, (kind, symbol)))
        clause = "; ".join(filter(None, (clause, symbol and "ASCE 7-22, 2.2")))
        parts = (("with", case.follows), ("group", own.group), ("action", own.action))
        together = "; ".join(f"{key} {value}" for key, value in parts if value)
        rows.append([Cell(name), Cell(kind), Cell(own.category or ""), *shown, Cell(together), Cell(clause)])
    head = [write("case"), write("kind"), write("category"), "ψ0", "ψ1", "ψ2", write("together"), write("only_clause")]
    yield Table(write("actions"), head, rows)


def _patterns(of: Contents, cases: Mapping[str, Case], codes: set[str]) -> Iterator[Block]:
    """Yield sentences: which load cases are parts of one action, exclude each other, or act in full or not at all."""
    write = of.write
    kinds = {name: case.kind if "en1990" in codes else case.asce for name, case in cases.items()}
    variable = [name for name, kind in kinds.items() if kind not in (None, "permanent", "preload", *_EVER_PRESENT)]
    for key, words in (("action", "pattern_parts"), ("group", "pattern_group")):
        named = [getattr(cases[name], key) for name in variable]
        for one in dict.fromkeys(filter(None, named)):
            own = ", ".join(name for name, other in zip(variable, named, strict=True) if other == one)
            yield Text(write(words, name=one, cases=own))
    alone = [name for name in variable if not cases[name].action]
    if alone:
        yield Text(write("pattern_none", cases=", ".join(alone)))


class Layer(NamedTuple):
    """The largest required area of one layer of bars, and the moments at the place of this area."""

    area: float
    moments: tuple[float, float, float]
    design: float
    depth: float
    at: tuple[float, float]


def _largest(result: Result, name: str) -> Layer | None:
    """Largest required area in one combination outside singular places; of equal areas, that at the largest moment."""
    layers = list[Layer]()
    for member in result.members.values():
        nodes, bars = member.stress_nodes, member.model.bars
        assert bars is not None  # callers require [reinforcement] in the input
        area, design = member.fields[name], np.abs(member.fields[REINFORCEMENT[name]])
        known = away_from(nodes.mesh, member.singular, "moment")[nodes.nodes] & ~np.isnan(area)
        if not known.any():
            continue
        most = area[known].max()
        alike = known & (np.isinf(area) if np.isinf(most) else area >= most * (1.0 - _EQUAL))
        node = int(np.where(alike, design, -1.0).argmax())
        axis, face = name.split("_")[1:]
        depth = member.thickness[node] - getattr(bars, f"{face}_{axis}")
        x, y = nodes.points[node].tolist()
        moments = member.moment if member.moment_of_bars is None else member.moment_of_bars
        mx, my, mxy = moments[node].tolist()
        layers.append(Layer(float(area[node]), (mx, my, mxy), float(design[node]), float(depth), (x, y)))
    return max(layers, key=lambda layer: layer.area, default=None)


def reinforcement(of: Contents) -> Iterator[Block]:
    """Yield the method, tables of limits and effective depths, and the largest required area of each layer of bars."""
    model, write = of.results.model, of.write
    own, bars = model.reinforcement, model.bars
    if own is None or bars is None or not any(True for _ in solved(of.values)):
        return
    stress = _megapascals(of)
    fck, fyk = own.fck * stress, own.fyk * stress
    lam, eta = en1992.stress_block(fck)
    yield Text(write("design_moments"))
    yield Text(write("steel_formula"))
    if own.face:
        yield Text(write("face_words"))
    (area, unit), length = steel_unit(model.units.length), model.units.length
    ratio = en1992.least_ratio(fck, fyk)
    fctm = en1992.tensile_strength(fck)
    facts = {
        write("deepest"): f"{en1992.largest_depth(fck):.3f} (5.5 (4), δ = 1)",
        "η fcd": f"{bars.block * stress:.4g} MPa (3.1.7 (3), η = {eta:g}, λ = {lam:g})",
        "As,min / d": f"max(0.26 · {fctm:.3g}/{fyk:g}, 0.0013) = {ratio:.5f} (9.2.1.1 (1), 9.3.1.1 (1))",
        "As,max / h": f"{bars.most:g} (9.2.1.1 (3))",
    }
    yield write.facts(write("limits"), facts.items())
    thickness = np.concatenate([one.thickness[np.isfinite(one.thickness)] for one in _any(of).members.values()])
    rows = list[Sequence[Cell]]()
    ends = sorted({float(thickness.min()), float(thickness.max())}) if len(thickness) else []
    for name in REINFORCEMENT:
        axis, face = name.split("_")[1:]
        distance = getattr(bars, f"{face}_{axis}")
        outer = distance <= min(getattr(bars, f"{face}_{other}") for other in "xy")
        for h in ends:
            d = h - distance
            cells = [Cell(write("outer" if outer else "inner")), *(write.number(value) for value in (distance, h, d))]
            rows.append([Cell(_layer(of, name)), *cells, write.number(ratio * d, scale=area)])
    head = [write("layer"), write("position"), f"{write('axis_distance')} [{length}]", f"h [{length}]", f"d [{length}]"]
    yield Table(write("depths"), [*head, f"As,min [{unit}]"], rows)
    yield Text(write("steel_unit", unit=unit))
    yield from _largest_table(of, bars, lam)


def _any(of: Contents) -> Result:
    """Result of the first combination with an equilibrium, for data that all combinations share."""
    return of.results[next(solved(of.values))["name"]]


def _governing(of: Contents, name: str) -> str | None:
    """Combination with the largest bar area or design moment ``name``; top design moments: with the smallest value."""
    ends = [of.results.envelope.field(on_plate(name, plate.name)) for plate in of.results.discretisation.members]
    sign = DESIGN_MOMENTS.get(name, 1.0)
    value, row = max((sign * one.max, one.max_by) if sign > 0.0 else (-one.min, one.min_by) for one in ends)
    return None if row == NONE or math.isnan(value) else of.results.key(row)


def _layer(of: Contents, name: str) -> str:
    axis, face = name.split("_")[1:]
    return f"{of.write(face)} {axis} ({name})"


def _largest_table(of: Contents, bars: en1992.Bars, lam: float) -> Iterator[Block]:
    """Yield the table of the largest required area of each layer of bars over all combinations."""
    write, units, rows = of.write, of.results.model.units, list[Sequence[Cell]]()
    (area, unit), moment = steel_unit(units.length), f" [{units.force} {units.length}/{units.length}]"
    if not {*REINFORCEMENT} <= {*of.results.envelope.layout.fields}:
        yield Text(write("not_enveloped"))
        return
    for name in REINFORCEMENT:
        by = _governing(of, name)
        layer = None if by is None else _largest(of.results[by], name)
        if layer is None or by is None:
            continue
        width = next((one[2] for one in extremes(of, name) if one[0] == "max" and one[3] == by), ...)
        # If the minimum governs, many combinations have equal areas; the table shows the one with the largest moment.
        most = _governing(of, REINFORCEMENT[name]) or by
        other = _largest(of.results[most], name)
        if other is not None and other.area >= layer.area * (1.0 - _EQUAL):
            layer, by = other, most
        rest = 1.0 - 2.0 * layer.design / (bars.block * layer.depth**2)
        s = 1.0 - math.sqrt(max(rest, 0.0))
        needed = bars.block * layer.depth * s / bars.yield_stress
        why = "none_needed" if not layer.area else "minimum" if needed < layer.area * (1.0 - _EQUAL) else "bending"
        if math.isinf(layer.area):
            value, why = Cell("∞"), "beyond"
        else:
            value = write.number(layer.area, width, scale=area)
        size = max(map(abs, layer.moments))
        numbers = [write.number(one, size=size) for one in (*layer.moments, layer.design)]
        numbers.append(write.number(layer.depth))
        depths = [Cell(f"{s / lam:.4f}", s / lam), write.number(layer.depth * (1.0 - 0.5 * s))]
        cells = [value, Cell(of.code(by)), write.place(layer.at), *numbers, *depths]
        rows.append([Cell(_layer(of, name)), *cells, Cell(write(why))])
    head = [write("layer"), f"As [{unit}]", write("governing"), write("place"), f"mx{moment}", f"my{moment}"]
    head += [f"mxy{moment}", f"|m|{moment}", f"d [{units.length}]", "x/d", f"z [{units.length}]", write("decides")]
    yield Table(write("largest_areas"), head, rows)


_NOT_CHECKED: Mapping[str, Mapping[str, str]] = {
    EN_1992: {
        "one_way_shear": "EN 1992-1-1, 6.2",
        "crack_width": "EN 1992-1-1, 7.3",
        "cracked_deflection": "EN 1992-1-1, 7.4.3",
        "detailing": "EN 1992-1-1, 8, 9",
        "fire": "EN 1992-1-2",
        "wall_ends": "EN 1992-1-1, 6.4.2 (6)",
    },
    ACI_318: {
        "one_way_shear": "ACI 318-19, 22.5",
        "crack_width": "ACI 318-19, 24.3",
        "cracked_deflection": "ACI 318-19, 24.2",
        "detailing": "ACI 318-19, 8.7, 25",
        "fire": "ACI 318-19, 4.11",
        "wall_ends": "ACI 318-19, 22.6.4",
    },
}
"""Checks that the program does not make, with their clauses, by design code."""


def not_checked(of: Contents) -> Iterator[Block]:
    """Yield the table of checks that the program does not make, if a design code is used."""
    write, codes = of.write, codes_of(of.input)
    if not codes:
        return
    concrete = [code for code in _NOT_CHECKED if code in codes] or [EN_1992]
    clauses = {key: "; ".join(_NOT_CHECKED[code][key] for code in concrete) for key in _NOT_CHECKED[EN_1992]}
    rows = [[Cell(write(key)), Cell(clause)] for key, clause in clauses.items()]
    if of.results.model.reinforcement is None:
        rows.insert(0, [Cell(write("no_bending")), Cell("[reinforcement]")])
    if not of.results.model.punching:
        rows.append([Cell(write("no_punching")), Cell("[[punching]]")])
    yield Table(write("not_checked"), [write("check"), write("only_clause")], rows)


def uncracked(of: Contents) -> Iterator[Block]:
    """Yield the warning that checked deflections are of the uncracked plate, and places where tension exceeds fctm."""
    model, write = of.results.model, of.write
    checks = [one for one in of.values.get("checks") or () if "deflection" in one["of"].rpartition(".")[2]]
    if not checks or not codes_of(of.input):
        return
    yield Text(write("uncracked"), "warning")
    punched = [one.fck for one in _punched(of).values()]
    own = model.reinforcement
    if own is None and not punched:
        return
    stress = _megapascals(of)
    fctm = en1992.tensile_strength(punched[0] if own is None else own.fck * stress)
    for name in dict.fromkeys(one["governing"] for one in checks if one["governing"]):
        if of.results[name].status != "solved":
            continue
        most, at = max(map(_tension, of.results[name].members.values()))
        if most * stress > fctm:
            place = write.place(at).text
            words = write("cracks", name=of.code(name), value=f"{most * stress:.3g}", place=place, fctm=f"{fctm:.3g}")
            yield Text(words, "warning")


def _tension(member: Result) -> tuple[float, list[float]]:
    """Largest principal tensile stress of the faces outside singular places, and its place."""
    nodes = member.stress_nodes
    stress = 6.0 * np.maximum(member.fields["m1"], -member.fields["m2"]) / member.thickness**2
    known = away_from(nodes.mesh, member.singular, "moment")[nodes.nodes]
    node = int(np.where(known & np.isfinite(stress), stress, -np.inf).argmax())
    return float(stress[node]), nodes.points[node].tolist()
