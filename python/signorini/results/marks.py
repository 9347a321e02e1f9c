"""Supports and loads as marks for pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats
from signorini.mesh import Mesh
from signorini.model import Area, Circle, Load, Support
from signorini.results.contact_field import AreaContact
from signorini.shapes.tessellation import tessellate

if TYPE_CHECKING:
    from signorini.plot import LoadMark, PressureLayer, SupportMark

Style = Literal["points", "line", "area"]

_AROUND = 180
_BREAK = np.full((1, 2), np.nan)


def support_mark(
    mesh: Mesh,
    support: Support,
    positions: Floats,
    closed: Bools | None = None,
    boundary: Sequence[Floats] = (),
) -> SupportMark:
    """Draw a support that acts at positions (k, 2), of which some are closed; None: not known yet."""
    from signorini.plot import SupportMark

    style: Style = "points" if support.place == "at" else "area" if support.place == "area" else "line"
    if support.fix is None:
        return SupportMark(support.name, support.resists or "both", positions, closed, style, boundary)
    return SupportMark(support.name, "fixed", positions if style == "points" else path(mesh, support), None, style)


def pressure_layer(area: AreaContact) -> PressureLayer:
    """Draw the pressure of an area support."""
    from signorini.plot import PressureLayer

    on = area.covered > 0
    cut = tessellate(area.mesh.elements[on])
    outline = _outline(area.support.area) if isinstance(area.support.area, Area) else None
    values = area.element_pressure[on] if area.stiff[on].all() else area.pressing(cut)
    return PressureLayer(cut, values, area.bounds, outline)


def support_marks(found: Discretisation) -> list[SupportMark]:
    """Draw the supports of a model that is not solved."""
    marks = []
    for index, support in enumerate(found.model.support):
        held = (found.held.support.reshape(-1, 3) == index).any(axis=1)
        springs, contacts = found.springs, found.contacts
        positions = [found.mesh.points[held], springs.positions[springs.support == index]]
        positions.append(contacts.positions[contacts.support == index])
        marks.append(support_mark(found.mesh, support, np.unique(np.concatenate(positions), axis=0)))
    return marks


def load_marks(found: Discretisation) -> list[LoadMark]:
    """Draw the loads of a model, the case's name and the kind in the legend."""
    from signorini.plot import LoadMark

    marks = []
    for load in found.model.load:
        name = f"{load.case}: {load.kind.replace('_', ' ')}"
        if load.at is not None:
            upward = load.force is not None and load.force < 0
            marks.append(LoadMark(name, np.array(load.at), "points", upward))
        elif load.kind == "line_load":
            marks.append(LoadMark(name, path(found.mesh, load), "line"))
        elif isinstance(load.area, Area):
            marks.append(LoadMark(name, _outline(load.area), "area"))
        else:
            marks.append(LoadMark(f"{name} everywhere", np.zeros((0, 2)), "area"))
    for moving in found.model.moving:
        marks.append(LoadMark(f"{moving.case}: the way it moves", np.array(moving.line), "line"))
        halfway = [at for at, _, _ in moving.wheels(0.5 * moving.length)]
        marks.append(LoadMark(f"{moving.case}: its wheels halfway", np.array(halfway), "points"))
    return marks


def path(mesh: Mesh, item: Support | Load) -> Floats:
    """Vertices (k, 2) of the item's edge, line or circle; a row of NaN between pieces."""
    if item.line is not None:
        return np.array(item.line, dtype=np.float64)
    if item.circle is not None:
        points = _round(item.circle)
        return np.where(mesh.locate(points).inside[:, None], points, np.nan)
    return np.concatenate([_chained(mesh, name) for name in item.edge or ()])


def _chained(mesh: Mesh, name: str) -> Floats:
    """Vertices of an edge of the mesh, side after side."""
    pieces: list[Floats] = []
    last = -1
    for nodes in mesh.edges[name].tolist():
        pieces += [mesh.points[nodes[1:]]] if nodes[0] == last else [_BREAK, mesh.points[nodes]]
        last = nodes[2]
    return np.concatenate(pieces)


def _outline(area: Area) -> Floats:
    if area.rectangle is not None:
        x0, y0, x1, y1 = area.rectangle
        return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]])
    if area.circle is not None:
        return _round(area.circle)
    corners: Sequence[tuple[float, float]] = area.polygon or ()
    return np.array([*corners, corners[0]], dtype=np.float64)


def _round(circle: Circle) -> Floats:
    angle = np.linspace(0.0, 2.0 * np.pi, _AROUND + 1)
    return np.array(circle.center) + circle.radius * np.column_stack([np.cos(angle), np.sin(angle)])
