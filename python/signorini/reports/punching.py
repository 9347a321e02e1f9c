"""Punching in a report: columns in their governing combinations, sheets of numbers, figures of perimeters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.design import aci318, en1992_punching
from signorini.discretise.rows import Floats
from signorini.errors import InputError
from signorini.model.punching import Punching
from signorini.reports.blocks import Cell, Drawing, Writer, svg_path
from signorini.results.envelope import NONE
from signorini.results.punching import ColumnResult
from signorini.results.quantities import OF_COLUMNS

_FORMULAS = {
    "EN 1992-1-1:2004": {
        "beta": "1 + Σ k u1/W1 · e, e = M/|V − ΔV|; at edges u1/u1* + k* u1/W1,2 · e2",
        "v_ed": "β · |V − ΔV| / (u1 · d)",
        "v_ed_face": "(V + Σ k u1/W1 · M) / (u0 · d)",
        "v_rd_c": "max(0.12 · k · (100 ρ fck)^⅓, vmin) · 2d/a, in MPa; ρ = √(ρx ρy) ≤ 0.02",
        "v_rd_max": "0.4 · ν · fck/γc; γc = 1.5",
        "asw": "(vEd − 0.75 vRd,c) · u1 / (1.5 fywd,ef) ≥ 0 if vEd > vRd,c",
        "uout": "β · |V − ΔV| / (vRd,c · d) if vEd > vRd,c, with a = 2d; β · V / (vRd,c · d) on foundations",
        "with_links": "max(vEd / (1.5 vRd,c), vEd,0 / vRd,max)",
        "utilisation": "max(vEd / vRd,c, vEd,0 / vRd,max); 6.4.3(2)",
    },
    "ACI 318-19": {
        "beta": "vu / (|V − ΔV| / (bo d))",
        "v_ed": "|V − ΔV| / (bo d) + Σ γv M c / Jc",
        "v_ed_face": "V / (u0 · d)",
        "v_rd_c": "φ · min(0.33, 0.17 (1 + 2/βc), 0.083 (2 + αs d/bo)) · λs √f'c in MPa",
        "v_rd_max": "φ 0.5 √f'c",
        "asw": "(vu − φ 0.17 λs √f'c) · bo / (φ fyt) ≥ 0 if vu > φ vc; fyt ≤ 420 MPa",
        "uout": "vu · bo / (φ 0.17 λs √f'c)",
        "utilisation": "vu / (φ vc)",
        "with_links": "vu / vu,max",
    },
}
"""Formulas of the numbers of a punching check, by design code."""
KINDS_OF_LINES = ("u0", "dead", "u1", "uout")
"""Kinds of lines drawn for a column: outline, bounds of sectors behind openings, control and outer perimeter."""
_SYMBOLS = {
    **{"force": "V", "inside": "ΔV", "moment_x": "Mx", "moment_y": "My", "beta": "β", "v_ed": "vEd"},
    **{"v_ed_face": "vEd,0", "v_rd_c": "vRd,c", "v_rd_max": "vRd,max", "asw": "Asw/s"},
}
_SYMBOLS_ACI = {"u1": "bo", "v_ed": "vu", "v_ed_face": "vu,0", "v_rd_c": "φ vc", "v_rd_max": "vu,max"}
"""Symbols of numbers in formulas, by the numbers' names; for ACI 318 `_SYMBOLS_ACI` replaces some of `_SYMBOLS`."""
_POWERS = {1: "", 2: "²", 4: "⁴"}
_DIVISIONS = 20
_STEP = 1.2
"""Number of bisections for the distance of the outer perimeter, and ratio of successive distances tried before them."""
_SIZE, _MARGIN = 430.0, 1.12
"""Width and height of a figure in CSS pixels, and their ratio to the extent of the lines in the figure."""


@dataclass(frozen=True, eq=False)
class Punched:
    """A punched column in the combination with its largest utilisation; ``widths`` are half-widths by name, or None."""

    of: ColumnResult
    combination: str
    widths: Mapping[str, float | None] | None

    @property
    def utilisation(self) -> tuple[float, Any]:
        """Utilisation with its half-width: None if unknown, ``...`` without half-widths."""
        return self.of.numbers["utilisation"], ... if self.widths is None else self.widths["utilisation"]

    @property
    def at(self) -> int:
        """Index of the control perimeter that governs."""
        own = np.array([found.pieces.length for found in self.of.column.check.perimeters])
        return int(np.abs(own - self.of.numbers["u1"] * self.of.column.length).argmin())

    @cached_property
    def outer(self) -> list[Floats]:
        """Points (k, 2) along the parts of the outer perimeter; none unless shear reinforcement is required."""
        check, wanted = self.of.column.check, self.of.numbers["uout"] * self.of.column.length
        plan, low, edges = check.plan, check.basic.distance, check.perimeters[self.at].edges
        high = low
        if not self.of.numbers["asw"] > 0.0:
            return []
        try:
            while plan.perimeter(high, edges).pieces.length < wanted:
                low, high = high, _STEP * high
            for _ in range(_DIVISIONS):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if plan.perimeter(middle, edges).pieces.length < wanted else (low, middle)
        except InputError:  # the outer perimeter lies beyond the slab
            return []
        return self.of.column.drawn(plan.perimeter(high, edges).pieces)

    @cached_property
    def lines(self) -> Mapping[str, list[Floats]]:
        """Points (k, 2) along lines of each kind in `KINDS_OF_LINES`."""
        face = self.of.column.drawn(self.of.column.check.plan.column.offset(0.0))
        return dict(zip(KINDS_OF_LINES, (face, self._sectors, self.of.perimeter, self.outer), strict=True))

    @property
    def _sectors(self) -> list[Floats]:
        """Lines (2, 2) from the column's centre that bound the sectors behind openings."""
        plan, length = self.of.column.check.plan, self.of.column.length
        points = np.concatenate([*self.of.perimeter, *self.outer]) @ [1.0, 1j] * length
        reach, centre = float(np.abs(points - plan.column.centre).max()), plan.column.centre
        rays = [ray for opening in plan.openings for ray in plan.sector(opening)]
        ends = np.array([[centre, centre + reach * ray] for ray in rays]).reshape(-1, 2) / length
        return [np.column_stack([line.real, line.imag]) for line in ends]


def punched(results: Results, estimates: Estimates | None) -> list[Punched]:
    """Punched columns in their governing combinations, which are solved now if only their rows of the table exist."""
    layout, every = results.combined.layout, list[Punched]()
    columns = [
        [one for one in layout.catalogue if one.home == "punching" and one.owner == index]
        for index in range(len(layout.model.columns))
    ]
    for index, numbers in enumerate(columns):
        used = next(one for one in numbers if one.what == "utilisation")
        if (row := results.envelope[used.column].max_by) == NONE:
            continue
        widths = None
        if estimates is not None:
            widths = {one.what: estimates.half_width(one.column, row) for one in numbers if one.tabled}
        every.append(Punched(results[results.key(row)].punching[index], results.key(row), widths))
    return every


def sheet(one: Punched, table: Punching, write: Writer) -> Iterator[Sequence[Cell]]:
    """Yield the rows of a sheet: symbol, meaning, value with ±, unit, formula and clause of each number.

    ``table`` is the [[punching]] of the column; [reinforcement] gives the depths, ratios and strengths that it lacks.
    """
    column, check, units = one.of.column, one.of.column.check, write.units

    def row(symbol: str, words: str, value: float, force: int, length: int, why: str) -> Sequence[Cell]:
        unit = units.force_by_length(length) if force else units.length + _POWERS[length] if length else ""
        own = write.number(value / (column.force**force * column.length**length))
        return [Cell(symbol), Cell(write(words)), own, Cell(unit), Cell(why)]

    eurocode = isinstance(check, en1992_punching.Punching)

    def source(key: str, default: str) -> str:
        return write("input") if getattr(table, key) is not None else default

    for symbol, axis in (("c1", check.plan.column.axis), ("c2", 1j * check.plan.column.axis)):
        yield row(symbol, "column_side", check.plan.column.size(axis), 0, 1, _along(axis))
    for symbol, d in zip(("dx", "dy"), check.d, strict=True):
        yield row(symbol, "depth", d, 0, 1, source("d", write("depth_of_bars")))
    yield row("d", "mean_d", check.depth, 0, 1, "= (dx + dy)/2")
    for symbol, rho in zip(("ρx", "ρy"), getattr(check, "rho", ()), strict=False):
        yield row(symbol, "ratio", rho, 0, 0, source("rho", "= As,min/(b d); EN 1992-1-1, 9.2.1.1(1), Eq. (9.1N)"))
    for key, symbol in zip(("fck", "fyk"), ("fck", "fyk") if eurocode else ("f'c", "fyt"), strict=True):
        yield row(symbol, "strength", getattr(check, key), 1, -2, source(key, "[reinforcement]"))
    helpers = _eurocode(one, check) if isinstance(check, en1992_punching.Punching) else _aci(one, check)
    helping = [row(*each) for each in helpers]
    for quantity in OF_COLUMNS:
        if quantity.name == "beta":
            yield from helping
        width = ... if one.widths is None else one.widths.get(quantity.name, ...)
        formula, clause = _FORMULAS[column.code].get(quantity.name), check.clauses.get(quantity.name)
        if quantity.name == "inside":
            formula = write("inside_raft" if column.column.support is None else "inside_slab")
        why = "; ".join(filter(None, (formula and f"= {formula}", clause)))
        own = one.of.numbers[quantity.name]
        value = write.number(None if np.isnan(own) else own, width)
        symbols = _SYMBOLS if eurocode else _SYMBOLS | _SYMBOLS_ACI
        yield [
            Cell(symbols.get(quantity.name, quantity.name)),
            Cell(write.translated(quantity.words)),
            value,
            Cell(quantity.unit(units)),
            Cell(why),
        ]


def _along(direction: complex) -> str:
    return f"[{direction.real:.4g}, {direction.imag:.4g}]"


_Help = Iterator[tuple[str, str, float, int, int, str]]
"""Numbers that formulas use: symbol, key of the meaning, value in N and mm, exponents of force and length, clause."""


def _eurocode(one: Punched, check: en1992_punching.Punching) -> _Help:
    perimeter, of, column, depth = check.perimeters[one.at], check.shapes, check.plan.column, check.depth
    net = abs(one.of.numbers["force"] - one.of.numbers["inside"]) or np.inf
    moment = complex(*(one.of.numbers[f"moment_{axis}"] for axis in "xy")) * one.of.column.length / net
    yield "a", "distance", perimeter.distance, 0, 1, "6.4.2(1); 6.4.4(2)"
    if check.given is not None:
        yield "β", "factor", check.given, 0, 0, "6.4.3(6)"
    axis, uniform, beside = complex(of.axis[one.at]), float(of.uniform[one.at]), float(of.beside[one.at])
    for number, direction in ((1, axis), (2, 1j * axis)) if check.given is None else ():
        ratio, modulus = column.size(direction) / column.size(1j * direction), perimeter.pieces.modulus(direction)
        yield f"e{number}", "eccentricity", abs((moment * direction.conjugate()).real), 0, 1, _along(direction)
        yield f"k{number}", "moment_part", en1992_punching.moment_part(ratio), 0, 0, f"Table 6.1, c1/c2 = {ratio:.4g}"
        yield f"W1,{number}", "modulus", modulus, 0, 2, "= ∫ |e| dl; Eq. (6.40)"
        if of.normals[one.at].any() and number == 2:
            yield "u1*", "reduced", perimeter.pieces.length / uniform, 0, 1, "Figure 6.20"
        if beside and number == 2:
            yield "k*", "moment_part", beside * modulus / perimeter.pieces.length, 0, 0, "Eq. (6.44), c1/(2 c2)"
    k = min(1.0 + np.sqrt(200.0 / depth), 2.0)
    yield "k", "size_factor", k, 0, 0, "= 1 + √(200 mm/d) ≤ 2; 6.4.4(1)"
    yield "vmin", "least", 0.035 * k**1.5 * np.sqrt(check.fck), 1, -2, "= 0.035 k^1.5 √fck in MPa; Eq. (6.3N)"
    yield "ν", "cracked", 0.6 * (1.0 - check.fck / 250.0), 0, 0, "= 0.6 (1 − fck/250 MPa); Eq. (6.6N)"
    effective = min(250.0 + 0.25 * depth, check.fyk / en1992_punching.GAMMA_S)
    yield "fywd,ef", "effective", effective, 1, -2, "= 250 + 0.25 d ≤ fyk/1.15 in MPa and mm; 6.4.5(1)"


def _aci(one: Punched, check: aci318.Punching) -> _Help:
    section, column = check.perimeters[one.at], check.plan.column
    pieces, normals = section.pieces, section.normals
    axis = check.axis(section)
    numbers, force, length = one.of.numbers, one.of.column.force, one.of.column.length
    net = force * (numbers["force"] - numbers["inside"])
    moment = force * length * complex(numbers["moment_x"], numbers["moment_y"]) * np.sign(net)
    moment -= abs(net) * (pieces.centroid - column.centre)
    for number, direction in ((1, axis), (2, 1j * axis)) if check.given is None else ():
        about = (moment * np.conj(direction)).real
        sides = [np.array([side, -side]) for side in (direction, 1j * direction)]
        b1, b2 = (float(pieces.highest(side).sum()) for side in sides)
        middle = (pieces.centroid * np.conj(direction)).real
        outermost = float(
            pieces.highest(np.array([direction * np.sign(about or 1.0)]))[0] - middle * np.sign(about or 1.0)
        )
        yield f"M,{number}", "about_centroid", abs(about), 1, 1, "R8.4.4.2.3"
        yield f"γv,{number}", "shear_part", aci318.shear_part(b1, b2), 0, 0, f"8.4.4.2.2, {_along(direction)}"
        yield f"c,{number}", "outermost", outermost, 0, 1, "R8.4.4.2.3"
        yield f"Jc,{number}", "inertia", pieces.inertia(direction, check.depth), 0, 4, "R8.4.4.2.3"
    if check.given is not None:
        yield "β", "factor", check.given, 0, 0, ""
    short, long = sorted(column.size(side) for side in (column.axis, 1j * column.axis))
    yield "βc", "side_ratio", long / short, 0, 0, "22.6.5.2"
    yield "αs", "place_factor", aci318.ALPHA_S[len(normals)], 0, 0, "22.6.5.3"
    yield "λs", "size_factor", aci318.size_factor(check.depth), 0, 0, "= √(2/(1 + 0.004 d)) ≤ 1, d in mm; 22.5.5.1.3"
    yield "φ", "safety", aci318.PHI, 0, 0, "Table 21.2.1"
    yield "√f'c", "root", aci318.root_of(check.fck), 1, -2, "in MPa; 22.6.3.1"


def figure(one: Punched, write: Writer) -> Drawing:
    """Plan of a column: slab and openings, outline, control perimeter, outer perimeter, sectors behind openings."""
    column = one.of.column
    points = np.concatenate([line for lines in one.lines.values() for line in lines])
    middle, size = 0.5 * (points.min(axis=0) + points.max(axis=0)), _MARGIN * float(np.ptp(points, axis=0).max())

    def on(line: Floats) -> Floats:
        return np.asarray((line - middle) * [1.0, -1.0] * (_SIZE / size) + 0.5 * _SIZE)

    slab = column.check.plan.slab
    rings = [np.asarray(ring.coords) / column.length for ring in (slab.exterior, *slab.interiors)]
    paths = [("slab", "".join(svg_path(on(ring)) + "Z" for ring in rings))]
    paths += [(kind, "".join(svg_path(on(line)) for line in lines)) for kind, lines in one.lines.items() if lines]
    keys = ["u0", "u1", *(["uout"] if one.outer else [])]
    lengths = [f"{key} = {write.number(one.of.numbers[key]).text} {write.units.length}" for key in keys]
    legend = list(zip(keys, lengths, strict=True))
    return Drawing(write("perimeters", name=one.of.name), (_SIZE, _SIZE), paths, legend=legend)
