"""Pictures of the fields of one result."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from signorini.base import arguments
from signorini.base.arguments import known
from signorini.errors import InputError
from signorini.results.marks import panel, support_marks
from signorini.results.state import ResultState
from signorini.results.support_result import areas_below

if TYPE_CHECKING:
    from signorini.plot.pictures import Axes


def draw_field(
    result: ResultState,
    field: str,
    ax: Axes | None,
    limits: tuple[float, float] | None,
    plus_minus: Mapping[str, Any] | None,
) -> Axes:
    """Draw a field as contours, and the supports; `Result.plot` describes the arguments."""
    from signorini.plot.marks import draw_legend
    from signorini.plot.pictures import draw_panel, field_picture
    from signorini.plot.plan import Plan

    known(field, [*result.fields, "pressure"], "field", "field", "This result")
    if ax is not None and not hasattr(ax, "tricontourf"):
        raise InputError(f"found {ax!r}; it must be axes of matplotlib, or None for new ones.", place="ax")
    if plus_minus is not None:
        arguments.made_by(plus_minus, Mapping, "Take estimate(result).plus_minus.", "plus_minus")
    result.require_fields()
    if field == "pressure" and not areas_below(result.supports):
        raise InputError('There is no field "pressure": the plate rests on no area support.', place="field")
    nodes, units = result.stress_nodes, result.model.units
    plan = Plan(nodes.points, nodes.elements, nodes.left_out)
    marks = support_marks(result)
    drawn = panel(field, result, plus_minus, None if limits is None else arguments.interval(limits, "limits"))
    if ax is None:
        return field_picture(plan, [drawn], marks, title=result.heading, length=units.length).axes[0]
    draw_legend(ax, draw_panel(ax, plan, drawn, marks))
    ax.set_title(result.heading, parse_math=False, wrap=True)
    return ax
