"""Diagrams of a report as SVG: sections, strips, profiles and walls, with the values shown at the pointer."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from signorini.base.numbers import ROUNDING, in_unit, number, size_of
from signorini.discretise.rows import Floats
from signorini.reports.blocks import Drawing, Label, Writer, found, solved, svg_path
from signorini.reports.sections import Contents
from signorini.results.quantities import BY_LIST, MEANS, PICTURED, PRESSURE, RESULTANTS, THROUGH, Quantity

_WIDE, _HIGH, _LEFT, _TOP, _FOOT = 720.0, 150.0, 82.0, 24.0, 30.0
"""Width of a diagram, height of a panel, and margins at the left, above and below, in CSS pixels."""
_MOST = 8
"""Largest number of combinations with a curve each; for more, a panel has curves of the largest and smallest values."""
_DIGITS, _TICKS, _APART = 4, 8, 13.0
"""Number of digits at axes, largest number of intervals between ticks, least distance of labels [pixels]."""
_PROFILED = ("deflection", *RESULTANTS, PRESSURE.name)
_Curve = tuple[str, Sequence[float | None], Sequence[Any], Sequence[str]]
"""Curve over k places: name, values (k,), half-widths (k,) of the mesh error, governing combinations (k,).

Without an estimate each half-width is ``...``. The curve of a single combination has no governing combinations.
"""


@dataclass(frozen=True)
class _Panel:
    quantity: Quantity
    curves: Sequence[_Curve]
    upward: bool = False


def diagrams(of: Contents) -> Iterator[Drawing]:
    """Yield the diagrams of sections, strips, profiles and walls, for the combinations whose results are complete."""
    every, write = list(solved(of.values)), of.write
    along = [one for one in MEANS if len(one.path) == 1]  # longer paths: bars and design moments of one face
    for index, cut in enumerate(every[0]["sections"] if len(every) > 1 else ()):
        values = [one["sections"][index] for one in every]
        told = [found(one["plus_minus"], "sections", index) for one in every]
        panels = [_Panel(each, [_curve("", values, told, each)]) for each in THROUGH]
        codes = [of.short(one["name"]) for one in every]
        yield _diagram(
            f"{write('section')} {cut['name']}", np.arange(len(every), dtype=np.float64), codes, panels, write
        )
    for key, quantities in (("strip", along), ("profile", [PICTURED[name] for name in _PROFILED])):
        for index, first in enumerate(every[0][f"{key}s"] if every else ()):
            places = np.array([[one["x"], one["y"]] if key == "profile" else one["at"] for one in first["stations"]])
            distance = np.concatenate([[0.0], np.hypot(*np.diff(places, axis=0).T).cumsum()])
            panels = [_panel(of, each, (f"{key}s", index, "stations")) for each in quantities]
            yield _diagram(f"{write(key)} {first['name']}", distance, (), panels, write)
    per_length = BY_LIST["line"][0]
    for place, support in ((of.place_of(index), one) for index, one in enumerate(of.results.model.support)):
        line = found(every[0] if every else None, *place, "line")
        if line and all("reaction" in station for station in line):
            distance = np.array([station["s"] for station in line])
            yield _diagram(
                f"{write('support')} {support.name}",
                distance,
                (),
                [_panel(of, per_length, (*place, "line"), True)],
                write,
            )


def _panel(of: Contents, quantity: Quantity, path: tuple[str | int, ...], upward: bool = False) -> _Panel:
    """Panel of a quantity with a curve for each combination; ``path`` leads to the stations in results.json."""
    curves = []
    for one in solved(of.values):
        told = None if "line" in path or "profiles" in path else found(one["plus_minus"], *path)
        curves.append(_curve(of.code(one["name"]), found(one, *path), told, quantity))
    if len(curves) > _MOST:
        curves = [_ends(of.write(side), curves, pick) for side, pick in (("max", np.nanargmax), ("min", np.nanargmin))]
    return _Panel(quantity, curves, upward or quantity.kind == PRESSURE.kind)


def _curve(name: str, stations: Sequence[Any], told: Sequence[Any] | None, quantity: Quantity) -> _Curve:
    values = [one.get(quantity.name, found(one, *quantity.path)) for one in stations]
    widths = [...] * len(values) if told is None else [found(one, *quantity.path) for one in told]
    return name, values, widths, ()


def _ends(side: str, curves: Sequence[_Curve], pick: Any) -> _Curve:
    """Curve of the largest or the smallest values over the combinations ``curves``."""
    every = np.array([values for _, values, *_ in curves], np.float64)
    by = [0 if np.isnan(column).all() else int(pick(column)) for column in every.T]
    values = [curves[row][1][at] for at, row in enumerate(by)]
    widths = [curves[row][2][at] for at, row in enumerate(by)]
    return side, values, widths, [f" ({curves[row][0].partition(':')[0]})" for row in by]


def _diagram(words: str, distance: Floats, names: Sequence[str], panels: Sequence[_Panel], write: Writer) -> Drawing:
    """Diagram of panels, one below another, over a common distance, or over ``names`` at equal distances."""
    span = float(np.ptp(distance)) or 1.0
    x = _LEFT + (distance - distance.min()) / span * (_WIDE - _LEFT - 12.0)
    sizes: dict[str, float] = {}
    for panel in panels:
        every = [value for _, own, *_ in panel.curves for value in own if value is not None]
        sizes[panel.quantity.kind] = max(sizes.get(panel.quantity.kind, 0.0), size_of(every))
    paths, labels, shown = list[tuple[str, str]](), list[Label](), list[Any]()
    for row, panel in enumerate(panels):
        largest = sizes[panel.quantity.kind]
        values = [np.array(own, np.float64) for _, own, *_ in panel.curves]
        values = [np.where(np.abs(own) <= ROUNDING * largest, 0.0, own) for own in values]
        low, high = (float(pick(np.append(np.concatenate(values), 0.0))) for pick in (np.nanmin, np.nanmax))
        top, size = row * _HIGH + _TOP, _HIGH - _TOP - 12.0
        sign, end = (-1.0, high) if panel.upward else (1.0, low)
        scale = size / (high - low or 1.0)

        def level(value: Any, top: float = top, sign: float = sign, end: float = end, scale: float = scale) -> Any:
            return top + sign * (value - end) * scale

        paths.append(("axis", svg_path(np.array([[_LEFT, level(0.0)], [_WIDE - 12.0, level(0.0)]]))))
        title = write.label(panel.quantity)
        labels.append(Label(_LEFT, top - 9.0, title, "title"))
        for value in (0.0, *(end for end in (low, high) if abs(level(end) - level(0.0)) > _APART)):
            labels.append(Label(_LEFT - 6.0, level(value) + 4.0, number(value, digits=_DIGITS), "tick"))
        own = []
        for at, ((name, _, widths, by), of) in enumerate(zip(panel.curves, values, strict=True)):
            pixels = np.column_stack([x, level(of)])
            gaps = np.flatnonzero(np.isnan(of))
            if names:
                pieces = [np.array([[px, level(0.0)], [px, py]]) for px, py in pixels.tolist()]
            else:
                pieces = [piece[~np.isnan(piece[:, 1])] for piece in np.split(pixels, gaps)]
            if line := "".join(svg_path(piece) for piece in pieces if len(piece)):
                paths.append((f"{'bars' if names else 'curve'} c{at}", line))
            triples = zip(of.tolist(), widths, by or [""] * len(of), strict=True)
            texts = [
                "" if np.isnan(value) else write.number(value, width, largest).text + who
                for value, width, who in triples
            ]
            own.append([name, texts, [None if y != y else round(y) for y in pixels[:, 1].tolist()]])
        shown.append([title, row * _HIGH, own])
    bottom = len(panels) * _HIGH
    ticks = names or [number(one, digits=_DIGITS) for one in distance]
    last = len(x) - 1
    for at in range(
        0, len(x), next((step for step in range(1, last) if last % step == 0 and last <= _TICKS * step), last) or 1
    ):
        labels.append(Label(float(x[at]), bottom + 8.0, ticks[at], "below"))
    unit = "" if names else write.units.length
    data = {"x": [round(one) for one in x.tolist()], "at": list(ticks), "unit": f" {unit}".rstrip(), "panels": shown}
    legend = [(f"c{at}", name) for at, (name, *_) in enumerate(panels[0].curves) if name]
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    return Drawing(words + in_unit(unit), (_WIDE, bottom + _FOOT - 12.0), paths, labels, text, legend)
