"""Draw the plates of a case: model with supports and loads, and pressure or deflection on the finest mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from signorini.analysis.results import Results
from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats
from signorini.plot.curves import line
from signorini.plot.files import png_of, with_palette
from signorini.plot.pictures import Figure, check_picture, field_picture
from signorini.plot.plan import Plan
from signorini.results import marks
from signorini.results.result import Result
from signorini.results.support_result import areas_below

_WIDTH = 3.0
"""Largest width of a plan [inches]: the picture's text is readable on a page 500 pixels wide."""
_LONG = 4.0
"""Smallest ratio of length to width of a plate that is drawn as a strip: by a curve of the deflection along x."""
_ALONG = 201
"""Number of points of a curve along a strip."""


@dataclass(frozen=True)
class Drawing:
    """A picture of a plate: suffix of its file name, caption, and content of the .png file."""

    ending: str
    words: str
    png: bytes


def drawings(results: Results) -> Iterator[tuple[Drawing, Drawing]]:
    """Draw each plate of the combination "all": the model, then the pressure of elastic soil, or the deflection."""
    members, each = results["all"].members, results.discretisation.each
    for (plate, result), discretisation in zip(members.items(), each, strict=True):
        ending, of = (f"-{plate}", f", plate {plate}") if plate else ("", "")
        soil = areas_below(result.supports)
        # Pressures of rigid area supports, which act on each element's mean deflection, oscillate and are not drawn.
        field = "pressure" if soil and not any(area.on_means for area in soil) else "deflection"
        low, high = result.mesh.points.min(axis=0), result.mesh.points.max(axis=0)
        if high[0] - low[0] > _LONG * (high[1] - low[1]):
            name, words, figure = "profile", "deflection along the long edges", _profile(result, low, high)
        else:
            name, words, figure = field, field, _field(result, field)
        yield (
            Drawing(f"-model{ending}", f"supports and loads{of}", _png(_model(discretisation))),
            Drawing(f"-{name}{ending}", f"{words}{of}", _png(figure)),
        )


def _png(figure: Figure) -> bytes:
    return with_palette(png_of(figure))


def _profile(result: Result, low: Floats, high: Floats) -> Figure:
    """Draw the deflection along the two long edges of a strip along x; the second curve is dashed."""
    x = np.linspace(low[0], high[0], _ALONG)
    figure = Figure(figsize=(1.4 * _WIDTH, 0.8 * _WIDTH), layout="constrained")
    axes = figure.add_subplot()
    for y in (low[1], high[1]):
        values = [probe.deflection for probe in result.probe(np.column_stack([x, np.full(_ALONG, y)]))]
        line(x, values, ax=axes, label=f"y = {y:g}", xlabel="x", ylabel="deflection")
    axes.lines[-1].set_linestyle("dashed")
    axes.legend(frameon=False)
    return figure


def _model(discretisation: Discretisation) -> Figure:
    mesh = discretisation.mesh
    return check_picture(
        Plan(mesh.points, mesh.elements),
        bedding=marks.bedding_panel(discretisation),
        zones=marks.zone_marks(discretisation),
        supports=marks.unsolved_marks(discretisation),
        loads=marks.load_marks(discretisation),
        mesh=False,
        widest=_WIDTH,
    )


def _field(result: Result, field: str) -> Figure:
    nodes = result.stress_nodes
    plan = Plan(nodes.points, nodes.elements, nodes.left_out)
    return field_picture(plan, [marks.panel(field, result)], marks.support_marks(result), widest=_WIDTH)
