"""How far supports reach: the outlines of areas, lines and edges as the input has them, not as a mesh does."""

from __future__ import annotations

import numpy as np

from signorini.discretise.places import region
from signorini.discretise.rows import Floats
from signorini.mesh import Mesh
from signorini.model import AnnulusPlate, DiscPlate, MeshPlate, Plate, Support
from signorini.model.places import curve
from signorini.shapes import Curve, Region
from signorini.shapes.extent import hull
from signorini.shapes.outlines import Point, along_arc

_TURN = 360
"""Points of a full circle: the arcs between them rise by 4e-5 of the radius over their chords."""


def outline(mesh: Mesh, plate: Plate, support: Support) -> Floats:
    """Points (k, 2) whose hull is that of the support: its corners in order or ends, and points of circles.

    They are those of the input, whatever the mesh; only of a plate that is a mesh they are the mesh's.

    Examples
    --------
    >>> from signorini.mesh.meshers import rectangle
    >>> from signorini.model import RectanglePlate
    >>> plate, mesh = RectanglePlate(size=(4, 2), thickness=0.1), rectangle((0.0, 0.0), (4.0, 2.0), (3, 3))
    >>> soil = Support(area="all", resists="down", stiffness=1e6)
    >>> sorted(outline(mesh, plate, soil).tolist())
    [[0.0, 0.0], [0.0, 2.0], [4.0, 0.0], [4.0, 2.0]]
    """
    if support.at is not None:
        return np.array(support.at, dtype=np.float64)
    shape = curve(support) or region(support.area)
    if shape is not None:
        points = _of_shape(plate, shape)
    else:
        names = support.edge if support.edge is not None else (None,)
        points = np.concatenate([_edge(mesh, plate, name) for name in names])
    return np.asarray(points[hull(points)])


def _of_shape(plate: Plate, shape: Region | Curve) -> Floats:
    """A region or curve, of which only circles about the center of a sector may leave the plate."""
    drawn = shape.outline
    points = [drawn.segments.reshape(-1, 2)]
    points += [along_arc(*arc) for arc in drawn.arcs.tolist()]
    for x, y, radius in drawn.circles:
        if isinstance(plate, DiscPlate | AnnulusPlate) and (x, y) == tuple(plate.center):
            points.append(_arc(plate.center, radius, plate.sector))
            if plate.sector < 360:
                inner = plate.inner if isinstance(plate, AnnulusPlate) else 0.0
                points.append(_arc(plate.center, min(inner, radius), plate.sector))
        else:
            points.append(_arc((x, y), radius, 360.0))
    return np.concatenate(points)


def _edge(mesh: Mesh, plate: Plate, name: str | None) -> Floats:
    """Points of an edge of the plate, of all where there is no name."""
    if isinstance(plate, MeshPlate):
        return mesh.points[np.unique(mesh.boundary if name is None else mesh.edges[name])]
    if name is None:
        return plate.outline.points()
    return np.concatenate([contour.points(name) for contour in plate.contours if name in contour.edges])


def _arc(center: Point, radius: float, sector: float) -> Floats:
    """An arc from the x axis on, both its ends included."""
    turn = np.radians(np.linspace(0.0, sector, 1 + int(np.ceil(_TURN * sector / 360.0))))
    return np.asarray(center + radius * np.column_stack([np.cos(turn), np.sin(turn)]))
