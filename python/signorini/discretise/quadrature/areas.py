"""Quadrature over regions of the plate; their outlines, and curves at which the integrand jumps, may cut elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from signorini._core import serendipity, triangular
from signorini.discretise.quadrature.cutcells import cut
from signorini.discretise.quadrature.rules import GAUSS, Quadrature, collapsed, gauss, lobatto, radon
from signorini.discretise.quadrature.stepped import OFF, Levels, among, crossed, cut_by, sides_of
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import TRIANGLE_CORNERS, determinants, real_sides
from signorini.mesh.sides import at_ends
from signorini.shapes import Curve, Polyline, Region, Ring
from signorini.shapes.cuts import Part

_ON_PLATE = 1e-9
"""Largest area or length off the plate, relative to the whole, that counts as rounding."""
_RADON = 3
"""Largest number of Gauss points per direction at which Radon's seven points on a triangle are as accurate."""
_LINES_FROM = {1: (2,), 2: (0,), 4: (1,), 3: (2, 0), 6: (0, 1), 5: (1, 2), 7: (0, 1, 2)}
"""For each set of a triangle's sides on the outline, their opposite corners, where lines of collapsed rules meet.

The key is the sum of 1, 2 and 4 for the first, second and third side in the set.
"""
_ROUNDINGS = 16.0
"""Largest rounding of an outline's position, in machine epsilons times the largest coordinate."""


def area_quadrature(
    mesh: Mesh,
    region: Part | None = None,
    order: int = GAUSS,
    to_outline: Bools | None = None,
    levels: Levels = (),
    off: float = OFF,
    follow: bool = False,
) -> Quadrature:
    """Quadrature over the intersection of a region, or of the whole plane, with the plate, sorted by element.

    Area and first moments are exact to about 1e-12. Whole elements have ``order`` Gauss points in each direction,
    elements that the outline cuts have more, see `cutcells`. Elements (ne,) in ``to_outline``, and cut elements, have
    Lobatto's rule of the same accuracy across their sides on the outline, so that points lie on it. The integrand jumps
    where ``levels`` change sign; a cut deviates from a curved jump by at most ``off``, relative to the element's side
    (`stepped`). With ``follow``, arcs of the outline are replaced by element sides that approximate them.
    """
    smooth = _smooth(mesh, region, order, to_outline, follow)
    if not levels:
        return smooth
    elements = np.unique(smooth.elements)
    across = crossed(mesh, elements, levels)
    if not across.any():
        return smooth
    elements, levels = elements[across.any(axis=0)], among(levels, across)
    if region is not None:
        outline = sides_of(region)
        levels += among(outline, crossed(mesh, elements, outline))
    result = cut_by(mesh, elements, levels, order, off).points
    inside = np.ones(len(result.weights), dtype=bool) if region is None else region.contains(result.positions)
    # Elements are cut along chords of curved outlines; weights are scaled to the exact area.
    count = len(mesh.elements)
    area = np.bincount(smooth.elements, smooth.weights, count)
    cut_area = np.bincount(result.elements[inside], result.weights[inside], count)
    done = np.isin(np.arange(count), elements) & (cut_area > 0.0)
    keep, inside = ~done[smooth.elements], inside & done[result.elements]
    weights = result.weights * (area / np.where(done, cut_area, 1.0))[result.elements]
    return _by_element([smooth.pick(keep), replace(result, weights=weights).pick(inside)])


def _smooth(mesh: Mesh, region: Part | None, order: int, to_outline: Bools | None, follow: bool) -> Quadrature:
    marked = np.zeros(len(mesh.elements), np.bool_) if to_outline is None else to_outline
    if region is None:
        return _by_element(_whole(mesh, np.arange(len(mesh.elements)), order, mesh.on_boundary & marked[:, None]))
    result = cut(mesh, region, order, lobatto if marked.any() else gauss, follow)
    xi = mesh.invert(result.elements, result.positions)
    covered = np.union1d(result.whole, result.elements)
    real = real_sides(mesh.elements)
    uses = np.bincount(mesh.elements[covered, 4:][real[covered]], minlength=mesh.node_count)
    outer = (uses[mesh.elements[result.whole, 4:]] == 1) & real[result.whole] & marked[result.whole, None]
    factors = np.ones(len(mesh.elements))
    factors[result.whole] = result.factors
    whole = [
        replace(points, weights=factors[points.elements] * points.weights)
        for points in _whole(mesh, result.whole, order, outer)
    ]
    return _by_element([*whole, Quadrature(result.elements, xi, result.weights, result.positions)])


def _by_element(parts: list[Quadrature]) -> Quadrature:
    joined = Quadrature.join(parts)
    return joined.pick(np.argsort(joined.elements, kind="stable"))


def _whole(mesh: Mesh, elements: Ints, order: int, outer: Bools) -> list[Quadrature]:
    """Quadrature over whole elements (k,): Lobatto's rule across sides marked in ``outer`` (k, 4), else Gauss's."""
    triangles = mesh.triangles[elements]
    across = np.column_stack([outer[:, 1] | outer[:, 3], outer[:, 0] | outer[:, 2]])
    rules = (gauss(order), lobatto(order))
    parts = []
    for x, y in ((0, 0), (0, 1), (1, 0), (1, 1)):
        group = elements[(across == (x, y)).all(axis=1) & ~triangles]
        station = np.stack(np.meshgrid(rules[x][0], rules[y][0], indexing="ij"), axis=-1).reshape(-1, 2)
        parts.append(_by_rule(mesh, group, station, np.outer(rules[x][1], rules[y][1]).ravel()))
    at_corner = np.zeros(outer.shape, np.bool_)
    at_corner[outer] = at_ends(mesh.points, mesh.sides[elements][outer])
    kinds = np.where(outer.any(axis=1) & at_corner.any(axis=1), 8, 0) + outer[:, [0, 1, 3]] @ [1, 2, 4]
    for kind in np.unique(kinds[triangles]):
        rule = _on_triangle(order, kind % 8, kind > 8)
        parts.append(_by_rule(mesh, elements[triangles & (kinds == kind)], *rule, triangles=True))
    return parts


def _by_rule(mesh: Mesh, elements: Ints, station: Floats, weight: Floats, triangles: bool = False) -> Quadrature:
    """Quadrature by one rule over whole elements, which are all triangles or all quadrilaterals."""
    nodes = mesh.nodes[elements]
    weights = determinants(nodes, station, triangles) * weight
    positions = ((triangular if triangles else serendipity)(station)[0] @ nodes).reshape(-1, 2)
    xi = np.tile(station, (len(elements), 1))
    return Quadrature(np.repeat(elements, len(station)), xi, weights.ravel(), positions)


def _on_triangle(order: int, sides: int, to_corners: bool) -> tuple[Floats, Floats]:
    """Points and weights on the reference triangle, exact at least to the degree 2·order − 2.

    ``sides`` is the sum of 1, 2 and 4 for each side on the outline. There are points on these sides; with
    ``to_corners``, also at the ends of the sides.
    """
    if sides == 0:
        return radon() if order <= _RADON else collapsed(TRIANGLE_CORNERS[:3], gauss(order), gauss(order))
    parts = []
    for corner in _LINES_FROM[sides]:
        across = lobatto(order) if to_corners else gauss(order)
        parts.append(collapsed(np.roll(TRIANGLE_CORNERS[:3], -corner, axis=0), lobatto(order), across))
    points, weights = (np.concatenate(part) for part in zip(*parts, strict=True))
    return points, weights / len(parts)


def off_plate(mesh: Mesh, where: Region | Curve, quadrature: Quadrature, part: float = 1.0) -> float:
    """Area of a region, or length of a curve, off the plate; ``part`` is the fraction that must be on the plate.

    The result is 0 within a tolerance: rounding, for a region also a strip of a millionth of the plate's size, and the
    area between the plate's round outline and the parabolas of its elements.
    """
    # Positions on an outline are uncertain by the rounding of coordinates.
    apart = _ROUNDINGS * float(np.finfo(float).eps) * float(np.abs(mesh.points).max())
    if isinstance(where, Ring | Polyline):
        measure, slack = where.length, apart
    else:
        x0, y0, x1, y1 = where.bounds
        apart = max(apart, mesh.near.written)
        measure, slack = where.area, mesh.round_outline_area(where.bounds) + apart * (x1 - x0 + y1 - y0)
    missing = part * measure - quadrature.total
    return missing if missing > _ON_PLATE * measure + slack else 0.0
