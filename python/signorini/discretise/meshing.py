"""Meshes along the plate's outline and, where possible, along outlines and lines of zones, supports and loads."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

import numpy as np

from signorini.base.memory import elements_that_fit, require_memory
from signorini.discretise.laws import formulas_of
from signorini.discretise.rows import Floats
from signorini.discretise.snapping import Snapped, snapped
from signorini.errors import InputError, Place, Problems
from signorini.expression.levels import Drawing
from signorini.mesh import Mesh
from signorini.mesh.divisions import Axes, axes_of
from signorini.mesh.meshers import MOST, OutlineError, annulus, disc, outlined, rectangle
from signorini.model import (
    AnnulusPlate,
    DiscPlate,
    Load,
    MeshPlate,
    Model,
    Moving,
    OutlinedPlate,
    PolygonPlate,
    RectanglePlate,
    Refinement,
    Section,
    Strip,
    Support,
    Zone,
)
from signorini.model.field import PointFieldScalar
from signorini.model.where import Acting, Located, Where, mesh_follows
from signorini.model.whole import follows_in_rows, supports_and_loads
from signorini.shapes import Curve, Polyline, Region, Ring
from signorini.shapes.distances import distances
from signorini.shapes.extent import diameter
from signorini.shapes.outlines import Box, Contour, Point, along_arc, along_side, circle
from signorini.shapes.regions import meet

Line: TypeAlias = Region | Curve

_AROUND = 12
"""Least number of element sides around a circular border, which sets the element size at small circles."""
_LEAST = 0.125
"""Least element size of local refinement at borders of regions, relative to the element size of the mesh options."""
_LEAST_BESIDE_LINES = 0.25
"""Least element size of local refinement at lines, relative to the element size of the mesh options.

Smaller elements would be too many.
"""
_FOLLOWED = 0.55 * _LEAST_BESIDE_LINES
"""Least distance from other geometry at which the mesh can follow a line, relative to the element size."""
_SHARP = 0.42
"""Smallest angle in radians (24°) between two lines that the mesher can follow."""
_EVERY = 5
"""Angle in degrees of the chords by which this module approximates arcs."""
_TOUCHING = 5e-4
"""Largest distance of lines that count as touching, relative to the plate's diameter: the error of chords of 5°."""
_FINEST = 1e-8
"""Least element size relative to the largest coordinate; at 1e-9 rounding separates nodes that should coincide."""


def mesh_of(model: Model, mesh: Mesh | None = None) -> tuple[Mesh, Model, tuple[Snapped, ...]]:
    """Mesh the model's plate, read its mesh file, or take ``mesh`` if it is given.

    In the returned model, supports and loads at node numbers are at points, and ``mesh.snap`` is applied. The third
    value lists the items that were moved.
    """
    plate = model.plate
    if isinstance(plate, MeshPlate):
        mesh, model = _read(model, plate, mesh)
        return mesh, *snapped(model, mesh)
    model, moved = snapped(model)
    return (_made(model, plate) if mesh is None else mesh), model, moved


def _made(model: Model, plate: OutlinedPlate) -> Mesh:
    divisions = model.divisions
    _require_sizes(model, plate)
    if divisions is None:
        mesh = _outlined(model, plate)
        require_memory(len(mesh.elements), ("mesh",))
        _require_element(plate, mesh)
        return mesh
    require_memory(math.prod(divisions), ("mesh",))
    try:
        return _patterned(model, plate, divisions)
    except InputError as error:
        raise InputError(error.message, place=("plate",)) from None


def _require_sizes(model: Model, plate: OutlinedPlate) -> None:
    least = _FINEST * float(np.abs(plate.outline.bounds).max())
    sizes: list[tuple[float | None, Place]] = [(model.mesh.size, ("mesh", "size"))]
    sizes += [(part.size, ("mesh", "refine", number, "size")) for number, part in enumerate(model.mesh.refine)]
    for size, place in sizes:
        if size is not None and size < least:
            raise InputError(
                f"found {size:g}; it must be at least {least:.2g}, {_FINEST:g} of the largest coordinate: rounding "
                "would shape smaller elements. Take larger ones, or put the origin nearer to the plate.",
                place=place,
            )


def to_follow(model: Model, where: str = "there", size: float | None = None) -> str:
    """Advice for messages on how to make the mesh follow a line: for instance elements of ``size`` at ``where``."""
    if isinstance(model.plate, MeshPlate):
        return "Make a mesh whose element sides run along it."
    if model.plate.element == "q8r" and model.divisions is not None:
        return 'Leave out element = "q8r", whose meshes have only rows of elements.'
    if model.mesh.divisions is not None and not follows_in_rows(model):
        return "Give mesh.size, not divisions."
    elements = "smaller elements" if size is None else f"elements of {size:.2g} or less"
    return f"Take {elements} {where}{'' if size is None else ' (mesh.refine)'}."


def sharp_corner(region: Region) -> Floats | None:
    """Position (2,) of the sharpest corner of a region if its angle is too small for the mesher, else None."""
    least, result = _SHARP, None
    for loop in region.loops:
        back, onward = np.roll(loop, 1, axis=0) - loop, np.roll(loop, -1, axis=0) - loop
        cross, dot = back[:, 0] * onward[:, 1] - back[:, 1] * onward[:, 0], (back * onward).sum(axis=1)
        angles = np.abs(np.arctan2(cross, dot))
        if angles.min() < least:
            least, result = float(angles.min()), np.asarray(loop[angles.argmin()])
    return result


def room_beside(model: Model, region: Region) -> float | None:
    """Least distance of a region's sides from other lines that rows of elements follow; None without rows."""
    if not isinstance(model.plate, RectanglePlate) or model.divisions is None:
        return None
    (x, y), (a, b) = model.plate.origin, model.plate.size
    shapes = [*(zone.region for zone in model.zone), *_acted_on(model)]
    gaps = [np.inf]
    for low, high, key in ((x, x + a, "x_lines"), (y, y + b, "y_lines")):
        lines = np.unique([low, high, *(line for shape in shapes for line in getattr(shape, key))])
        apart = np.abs(lines - np.array(getattr(region, key))[:, None])
        gaps += apart[apart > _FINEST * (high - low)].tolist()
    return min(gaps)


def _read(model: Model, plate: MeshPlate, mesh: Mesh | None) -> tuple[Mesh, Model]:
    from signorini.mesh.meshfile import read, read_numbered

    place = ("plate", "file")
    points: Mapping[int, Point] = {}
    try:
        if any(item.nodes is not None for item in supports_and_loads(model)):
            in_file, points = read_numbered(plate.file)
            mesh = in_file if mesh is None else mesh
        elif mesh is None:
            mesh = read(plate.file)
    except InputError as error:
        raise InputError(str(error), place) from None
    require_memory(len(mesh.elements), place)
    _require_element(plate, mesh)
    # mitc9 treats a quadrilateral with a collapsed side as a triangle.
    return mesh if plate.element == "q8r" else mesh.with_triangles(), _at_nodes(model, points)


def _require_element(plate: MeshPlate | OutlinedPlate, mesh: Mesh) -> None:
    count = int(mesh.triangles.sum())
    if plate.element == "q8r" and count:
        without = (
            "Or mesh the plate with quadrilaterals only."
            if isinstance(plate, MeshPlate)
            else "Rectangles without holes, and discs and annuli without holes and mesh.refine, have no triangles."
        )
        raise InputError(
            f"The mesh has {count} triangle{'s' if count > 1 else ''}, and q8r has quadrilaterals only. Leave element "
            f'out: the default "mitc9" has triangles and quadrilaterals. {without}',
            place=("plate", "element"),
        )


def _at_nodes(model: Model, points: Mapping[int, Point]) -> Model:
    """Replace node numbers of supports and loads by points."""
    problems, update = Problems(), dict[str, object]()
    for key in ("support", "load"):
        items: list[Support | Load] = list(getattr(model, key))
        for i, item in enumerate(items):
            for position, number in enumerate(item.nodes or ()):
                if number not in points:
                    with problems.collected():
                        raise InputError(
                            f"The mesh file has no node {number}; its {len(points)} nodes have numbers from "
                            f"{min(points)} to {max(points)}.",
                            place=(key, i, "nodes", position),
                        )
            if item.nodes is not None:
                points_of_nodes = tuple(points[number] for number in item.nodes if number in points)
                items[i] = item.model_copy(update={"at": points_of_nodes, "nodes": None})
        update[key] = tuple(items)
    problems.raise_collected()
    return model.varied(**update)


def _patterned(model: Model, plate: OutlinedPlate, divisions: tuple[int, int]) -> Mesh:
    match plate:
        case RectanglePlate():
            (x, y), (a, b) = plate.origin, plate.size
            steps = (drawing for drawing, _ in _steps(model, (x, y, x + a, y + b)))
            shapes = [*(zone.region for zone in model.zone), *_acted_on(model), *steps]
            x_lines = [line for shape in shapes for line in shape.x_lines]
            y_lines = [line for shape in shapes for line in shape.y_lines]
            refined = [
                (box, refinement.size)
                for refinement in model.mesh.refine
                for box in refinement.boxes((x, y, x + a, y + b))
            ]
            x_lesser = [line for section in _sections(model) for line in section.x_lines]
            y_lesser = [line for section in _sections(model) for line in section.y_lines]
            lines = x_lines, y_lines, refined, x_lesser, y_lesser
            return rectangle(plate.origin, plate.size, divisions, *lines, _axes(model, plate))
        case DiscPlate():
            radii = _radii(model, plate.center, plate.radius)
            return disc(plate.center, plate.radius, divisions, plate.sector, radii)
        case _:
            assert isinstance(plate, AnnulusPlate)  # A polygon has no divisions, and is meshed along its outline.
            radii = _radii(model, plate.center, plate.outer)
            return annulus(plate.center, plate.inner, plate.outer, divisions, plate.sector, radii)


def _outlined(model: Model, plate: OutlinedPlate) -> Mesh:
    """Mesh along the outline, holes, borders of zones, circles, and straight lines of supports, loads and jumps."""
    size = plate.element_size(model.mesh)
    borders = [*(zone.region for zone in model.zone), *_rings(model, size)]
    walls = [along for item in supports_and_loads(model) if isinstance(along := item.where.curve, Polyline)]
    lines = [(np.array(list(arcs_of(border))).reshape(-1, 6), False) for border in borders]
    lines += [(_straight(wall), True) for wall in walls]
    lines += [(_straight(border), False) for border in borders]
    for drawing, (x0, y0, x1, y1) in _steps(model, plate.outline.bounds):
        jumps = [[x, y0, x, y1] for x in drawing.x_lines] + [[x0, y, x1, y] for y in drawing.y_lines]
        lines.append((np.array(jumps).reshape(-1, 4), False))
    lines += [(_straight(shape), False) for shape in [*_acted_on(model), *_sections(model)] if shape not in walls]
    refined = [rows for number, part in enumerate(model.mesh.refine) for rows in _refined(plate, part, number)]
    if _area(plate) <= MOST * size**2:
        refined += [room(borders, plate.contours, size, _refined_beside(model))]
    points = [position for part in model.mesh.refine for position in part.where.points]
    try:
        return outlined(
            plate.contours,
            size,
            np.concatenate([np.zeros((0, 5)), *refined]),
            lines,
            np.array(points).reshape(-1, 2),
            elements_that_fit(MOST),
            _axes(model, plate),
        )
    except OutlineError as error:
        raise InputError(error.message, place=_place_of(plate, error)) from None


def _straight(shape: Region | Curve) -> Floats:
    return shape.outline.segments.reshape(-1, 4)


def _axes(model: Model, plate: OutlinedPlate) -> Axes:
    """Axes in which the mesher works; they do not depend on the axes in which the plate is given.

    The outline determines the axes. If it leaves a choice, zones, refinements, supports, loads, sections, strips,
    moving loads and probes decide, in this order.
    """
    around = [contour.points() for contour in plate.contours]
    sides = [0.5 * (points + np.roll(points, 1, axis=0)) for points in around]
    zones = [_marks(zone.region) for zone in model.zone]
    placed: list[Located] = [*model.mesh.refine, *supports_and_loads(model)]
    items = [_marks_of(item.where, plate) for item in placed]
    drawn: list[Section | Strip | Moving] = [*model.section, *model.strip, *model.moving]
    lines = [np.array(item.line) for item in drawn]
    probes = [np.array(probe.at) for probe in model.probe]
    return axes_of([np.concatenate([*around, *sides]), *zones, *items, *lines, *probes])


def _marks_of(where: Where, plate: OutlinedPlate) -> Floats:
    points = np.array(where.points).reshape(-1, 2)
    return np.concatenate([points, *map(_marks, where.shapes), *_edges(where, plate)])


def _edges(where: Where, plate: OutlinedPlate) -> list[Floats]:
    return [contour.points(name) for name in where.edges for contour in plate.contours if name in contour.edges]


def _marks(shape: Region | Curve) -> Floats:
    """Points (k, 2) of a shape that distinguish the shape from its mirror images."""
    segments, circles, arcs = shape.outline.segments, shape.outline.circles, shape.outline.arcs
    across = circles[:, None, :2] + circles[:, 2:, None] * np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
    return np.concatenate([segments.mean(axis=1), *(part.reshape(-1, 2) for part in (segments, across, arcs))])


def _area(plate: OutlinedPlate) -> float:
    around, *holes = (contour.points().T for contour in plate.contours)
    return _enclosed(around) - sum(_enclosed(hole) for hole in holes)


def _enclosed(points: Floats) -> float:
    x, y = points - points[:, :1]
    return 0.5 * abs(float(x @ np.roll(y, 1) - y @ np.roll(x, 1)))


def _place_of(plate: OutlinedPlate, error: OutlineError) -> Place:
    if error.contour is None:
        return ("mesh",)
    hole = error.contour - (len(plate.contours) - len(plate.holes))
    if hole >= 0:
        return ("plate", "holes", hole)
    return ("plate", "points", error.side) if isinstance(plate, PolygonPlate) and error.side is not None else ("plate",)


def _refined(plate: OutlinedPlate, part: Refinement, number: int) -> Iterator[Floats]:
    """Yield arrays (k, 5) of straight pieces (x0, y0, x1, y1, size) at which a refinement requires the element size."""
    where = part.where
    chains = (
        [np.array([position, position]) for position in where.points]
        + _edges(where, plate)
        + list(where.outline.segments)
    )
    for x, y, radius in where.outline.circles.tolist():
        ring = circle((x, y), radius, "").points()
        chains.append(np.vstack([ring, ring[:1]]))
    chains += [along_arc(*arc) for arc in where.outline.arcs.tolist()]
    for chain in chains:
        yield np.column_stack([chain[:-1], chain[1:], np.full(len(chain) - 1, part.size)])
    if (inside := where.region) is not None:
        x0, y0, x1, y1 = inside.bounds
        if inside.area > MOST * part.size**2:
            message = f"found {part.size:g}, with more than {MOST:g} elements in this area. Take larger elements."
            raise InputError(message, place=("mesh", "refine", number, "size"))
        # The size is required at points two element sizes apart; between these points, sizes grow by at most a third.
        x, y = (_spread(low, high, 2.0 * part.size) for low, high in ((x0, x1), (y0, y1)))
        grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        held = grid[inside.contains(grid)]
        yield np.column_stack([held, held, np.full(len(held), part.size)])


def _spread(low: float, high: float, step: float) -> Floats:
    """Middles of the equal parts of an interval, divided into as few parts as possible no longer than ``step``."""
    count = math.ceil((high - low) / step - 1e-6)
    return np.asarray(low + (high - low) / count * (np.arange(count) + 0.5))


def _rings(model: Model, size: float) -> tuple[Ring, ...]:
    """Circles along which supports and loads act, each once; circles smaller than elements are left out."""
    rings = [item.where.curve for item in supports_and_loads(model)]
    return tuple(dict.fromkeys(ring for ring in rings if isinstance(ring, Ring) and mesh_follows(ring, size)))


def _sections(model: Model) -> list[Polyline]:
    return [Polyline(section.line) for section in model.section]


def _acted_on(model: Model) -> list[Region | Curve]:
    """Outlines and lines on which supports and loads act."""
    return [shape for item in supports_and_loads(model) for shape in item.where.shapes]


def _refined_beside(model: Model) -> list[Region | Curve]:
    """Geometry at which elements are refined: lines of supports and loads, areas and footprints of supports."""
    lines = [load.where.curve for load in model.load]
    of_supports = [shape for support in model.support for shape in support.where.shapes]
    return [*of_supports, *(line for line in lines if line is not None)]


def _radii(model: Model, center: Point, outer: float) -> list[float]:
    (x, y), r = center, outer
    steps = (drawing for drawing, _ in _steps(model, (x - r, y - r, x + r, y + r)))
    shapes = [*(zone.region for zone in model.zone), *_acted_on(model), *_sections(model), *steps]
    return [radius for shape in shapes for radius in shape.radii(center)]


def _steps(model: Model, box: Box) -> Iterator[tuple[Drawing, Box]]:
    """Yield the curves along which expressions jump, for the mesh to follow, each with the box in which it is drawn."""
    items: list[tuple[Acting | Zone | None, PointFieldScalar | None]] = [(None, model.plate.thickness)]
    items += [(zone, zone.thickness) for zone in model.zone]
    for support in model.support:
        if support.area is None and (not support.is_elastic or support.at is not None):
            continue  # Supports at points and rigid lines evaluate formulas only at their points.
        items += [(support, formula) for formula in formulas_of(support)]
    for load in model.load:
        items += [(load, value) for value in (load.pressure, load.line_load)]
    for item, formula in items:
        for level in formula.levels if formula is not None else ():
            within = _within(item, box)
            yield level.drawing(within), within


def _within(item: Acting | Zone | None, box: Box) -> Box:
    shape = None if item is None else item.where.shape
    if shape is None:
        return box
    return tuple(f(a, b) for f, a, b in zip((max, max, min, min), box, shape.bounds, strict=True))  # type: ignore[return-value]


def arcs_of(border: Line) -> Iterator[tuple[float, ...]]:
    """Yield three points of each arc and of each quarter of a circle of a border."""
    for x, y, radius in border.outline.circles.tolist():
        for begin, through, end in circle((x, y), radius, "").sides:
            assert through is not None  # A circle consists of arcs, each with a third point.
            yield (*begin, *through, *end)
    yield from (tuple(arc) for arc in border.outline.arcs.reshape(-1, 6).tolist())


def room(borders: Sequence[Line], contours: Sequence[Contour], size: float, lines: Sequence[Line] = ()) -> Floats:
    """Straight pieces (k, 5) at which elements must be smaller than ``size``: x0, y0, x1, y1, element size there.

    The pieces are short sides and small circles of borders, and parts of sides and lines near to other geometry that
    they do not touch. Sides of one line do not count as near to each other. Parts of ``lines`` are left out if they are
    too near to other geometry for the mesh to follow them.
    """
    sides: list[tuple[Floats, int | None]] = [(side, None) for border in borders for side in _sides_of(border)]
    sides += [(side, number) for number, line in enumerate(lines) for side in line.outline.segments[:, None]]
    obstacles = [*sides, *((_chords(*side), -1) for contour in contours for side in contour.sides)]
    boxes = np.array([[*side.min(axis=(0, 1)), *side.max(axis=(0, 1))] for side, _ in obstacles]).reshape(-1, 4)
    touching = _TOUCHING * max(diameter(contour.points()) for contour in contours)
    outline = np.vstack([contour.points() for contour in contours])
    bounds = outline.min(axis=0) - size, outline.max(axis=0) + size
    result = [np.zeros((0, 5))]
    for (side, number), box in zip(sides, boxes, strict=False):
        length = float(np.hypot(*(side[:, 1] - side[:, 0]).T).sum())
        closed = bool((side[0, 0] == side[-1, 1]).all())
        own_size = np.inf if number is not None else length / _AROUND if closed else length
        pieces = _divided(_clipped(side, *bounds), 0.5 * size)
        apart = np.full(len(pieces), min(own_size, size))
        close = ((boxes[:, :2] <= box[2:] + size) & (boxes[:, 2:] >= box[:2] - size)).all(axis=1)
        for other, line in (obstacles[index] for index in np.flatnonzero(close)):
            same_line = other is side or (number is not None and line == number)
            if not same_line and not meet(side, other, touching):
                apart = np.minimum(apart, _distance(pieces.mean(axis=1), other))
        near = (apart < size) & ((number is None) | (apart > _FOLLOWED * size))
        sizes = np.maximum(apart[near], min((_LEAST if number is None else _LEAST_BESIDE_LINES) * size, own_size))
        result.append(np.column_stack([pieces[near].reshape(-1, 4), sizes]))
    return np.concatenate(result)


def _sides_of(border: Line) -> Iterator[Floats]:
    """Yield the chords (k, 2, 2) of each side, arc and circle of a border."""
    yield from border.outline.segments[:, None]
    for arc in border.outline.arcs.tolist():
        yield _chords(*arc)
    for x, y, radius in border.outline.circles.tolist():
        points = circle((x, y), radius, "").points()[::_EVERY]
        yield np.stack([points, np.roll(points, -1, axis=0)], axis=1)


def _chords(a: Point, through: Point | None, b: Point) -> Floats:
    along = np.vstack([along_side(a, through, b)[::_EVERY], b])
    return np.stack([along[:-1], along[1:]], axis=1)


def _clipped(chords: Floats, low: Floats, high: Floats) -> Floats:
    """Parts of chords (k, 2, 2) inside a box (Liang & Barsky 1984), since circles may be far larger than the plate."""
    begin, along = chords[:, 0], chords[:, 1] - chords[:, 0]
    still = along == 0.0
    beside = (still & ((begin < low) | (begin > high))).any(axis=1)
    parameters = (np.stack([low, high])[:, None] - begin) / np.where(still, 1.0, along)
    enters = np.where(still, 0.0, parameters.min(axis=0)).max(axis=1).clip(0.0)
    leaves = np.where(still, 1.0, parameters.max(axis=0)).min(axis=1).clip(None, 1.0)
    ends = begin[:, None] + np.stack([enters, leaves], axis=1)[..., None] * along[:, None]
    # Chords entirely inside the box are kept unchanged, without rounding of their ends.
    ends = np.where(((enters == 0.0) & (leaves == 1.0))[:, None, None], chords, ends)
    return np.asarray(ends[~beside & (enters < leaves)])


def _divided(side: Floats, longest: float) -> Floats:
    """Divide chords (k, 2, 2) into pieces (q, 2, 2) no longer than ``longest``; pieces of a chord are equal."""
    parts = [np.zeros((0, 2, 2))]
    for a, b in side:
        # The tolerance avoids an additional piece caused by rounding.
        count = max(1, int(np.ceil(np.hypot(*(b - a)) / longest - 1e-6)))
        stations = a + np.linspace(0.0, 1.0, count + 1)[:, None] * (b - a)
        parts.append(np.stack([stations[:-1], stations[1:]], axis=1))
    return np.concatenate(parts)


def _distance(points: Floats, chords: Floats) -> Floats:
    """Distance (q,) of each point from the nearest of the chords (k, 2, 2)."""
    return np.asarray(distances(points, chords[:, 0], chords[:, 1]).min(axis=1))
