"""Boundary layer of thin plates, which meshes coarser than the thickness cannot resolve.

Along edges that leave the slope free, the moment mnn and the twist mnt are zero, at free edges also the shear qn. In a
layer of width δ = √(T/S), with T the twisting and S the shear rigidity along the edge, h/√(12κ) for a solid plate,
twist and shear approach the values of Kirchhoff's plate as 1 − exp(−d/δ). The shear along the edge is larger by mnt/δ
there, bending moments by up to 2δ |qn| (D. N. Arnold, R. S. Falk, *Asymptotic analysis of the boundary layer for the
Reissner-Mindlin plate model*, SIAM J. Math. Anal. 27, 1996).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from signorini.accuracy.half_width import sections_at
from signorini.discretise.held import sides_that_hold_turns
from signorini.discretise.rows import Floats, Ints
from signorini.mesh import Mesh
from signorini.model import Model
from signorini.model.whole import supports_and_loads
from signorini.results.quantities import DESIGN_MOMENTS, REINFORCEMENT, RESULTANTS, Key
from signorini.shapes.distances import distances
from signorini.singularities.boundary import middles

KINDS = frozenset(("deflection", "rotation", "moment", "stress", "reaction", "pressure", "per_length", "corner"))
_SOFTER = 1.3
"""Relative increase of deflections by the boundary layer, divided by h/L; thickness h, L = 4·area/perimeter. Measured:
0.86 for a simply supported square, 1.26 for a free strip in torsion (0.63 h over its width)."""
_SEEN = 2.65
"""Factor in x = 2.65 h/s with thickness h and element size s; elements resolve the part x tanh(1/x) of the layer. On
simply supported squares of side 100 h and 1000 h this part is right to 0.03 for s = 0.6 h to 100 h."""
_TWIST_SEEN = 30.0
"""Factor in 1 / (1 + 30 (δ/s)²), the part of the twist at edges that elements of size s do not resolve. On squares with
two free edges this part is right to 0.06 for s = 0.7 h to 50 h."""
_FADED = 12.0
"""Largest distance from an edge, in δ, at which the layer counts: there the layer's fields are e⁻¹² of those at the
edge.
"""
_PER_WIDTH = math.sqrt(10.0)
"""Ratio h/δ of thickness to layer width in solid plates with κ = 5/6, for which the constants above were measured."""
_CHORDS = np.linspace(-1.0, 1.0, 9)
"""Parameters -1 to 1 along a curved element side of the points that divide it into eight straight parts."""
_ON_EDGE = 1e-6
"""Largest distance from an edge, relative to the plate's size, of a point on it; also the largest |nx ny| of the normal
n of edges parallel to the axes.
"""


def unseen_layer(model: Model, mesh: Mesh, sizes: Sequence[float]) -> float:
    """Relative error of fields because elements do not resolve the layer along edges with free twist.

    ``sizes`` are the sides of elements on the two finest meshes. If errors are proportional to the
    element size, the change between these meshes shows a part of this error. The comparison of meshes covers this part,
    which is subtracted.
    """
    ends = mesh.points[_sides(model, mesh)[:, [0, 2]]]
    free = float(np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum())
    solid, rigidities, which = sections_at(model, mesh.points)
    widths = np.array([math.sqrt(one.in_twist / one.in_shear) for one in rigidities])
    thickness = _PER_WIDTH * float((solid * widths[which]).mean())
    left, before = (_left(thickness, size) for size in sizes[:2])
    shown = (before - left) / (sizes[1] / sizes[0] - 1.0)
    return float(_SOFTER * thickness * free / (4.0 * mesh.element_area.sum()) * max(0.0, left - shown))


def unseen_at_edges(
    numbers: Mapping[Key, Floats],
    most: Floats,
    probes: Floats,
    model: Model,
    mesh: Mesh,
    finer: float,
) -> dict[Key, Floats]:
    """Errors (k,) of moments and shears in k results, caused by the unresolved part of the layer along edges.

    Errors at probes follow from the twist and shear at the probes. The error of the largest shear follows from the
    largest mxy if the edges are parallel to the axes, otherwise from the largest moment. ``numbers`` (k,) are those on
    the finest mesh, ``most`` (k,) the largest moments. ``finer`` is the ratio of the finest mesh's element size to that
    of ``mesh``.
    """
    result, sides = dict[Key, Floats](), _sides(model, mesh)
    if not len(sides):
        return result
    begin, end = _chords(mesh, sides)
    way = end - begin
    length = np.hypot(*way.T)
    nx, ny = way[:, 1] / length, -way[:, 0] / length
    thickness, rigidities, which = sections_at(model, 0.5 * (begin + end))
    twist = np.stack([-nx * ny, nx * ny, nx**2 - ny**2])
    turned = np.einsum("ik,kij,jk->k", twist, np.stack([one.bending for one in rigidities])[which], twist)
    shear = np.einsum("ik,kij,jk->k", (-ny, nx), np.stack([one.shear for one in rigidities])[which], (-ny, nx))
    width = thickness * np.sqrt(turned / shear)
    parts = len(_CHORDS) - 1
    size = finer * np.repeat(mesh.element_area[mesh.find_sides(sides)[0]], parts) / (parts * length)
    unseen = 1.0 / (1.0 + _TWIST_SEEN * (width / size) ** 2)
    lines = [middles(mesh, item.where) for item in supports_and_loads(model)]
    free = np.repeat(~np.isin(sides[:, 1], np.concatenate(lines)), parts)

    peaks = [np.abs(numbers[key]) for key in _ends("mxy") if key in numbers]
    if peaks and np.abs(nx * ny).max() < _ON_EDGE:  # every edge is parallel to x or y
        most = np.maximum(*peaks)
    for name, along in (("qx", ny), ("qy", nx)):
        part = float((np.abs(along) * unseen / width).max())
        thinnest = float(thickness.min())
        result |= {key: part * most for key in _ends(name) if key in numbers}
        result |= {key: 1.5 / thinnest * part * most for key in _ends(f"t{name[1]}z") if key in numbers}

    for number, at_probe in enumerate(probes):
        away = distances(at_probe[None], begin, end)[0]
        near = away < _FADED * width
        if not near.any() or ("probe", number, "mx") not in numbers:
            continue
        mx, my, mxy, qx, qy = (numbers["probe", number, name] for name in RESULTANTS)
        x, y, delta, left = np.stack([nx, ny, width, unseen * np.exp(-away / width)])[:, near, None]
        # At the edge the exact twist is zero, so the error is the whole twist.
        on = away[near, None] <= _ON_EDGE * mesh.size
        twist = np.where(on, 1.0, left) * np.abs(x * y * (my - mx) + (x**2 - y**2) * mxy)
        across = np.where(on & free[near, None], 1.0, left) * np.abs(x * qx + y * qy)
        bent = np.maximum(2.0 * delta * across, on * np.abs(x**2 * mx + y**2 * my + 2.0 * x * y * mxy))
        turned, straight = np.abs(2.0 * x * y), np.abs(x**2 - y**2)
        direct, twisting = (turned * twist + bent).max(axis=0), (straight * twist + turned * bent).max(axis=0)
        either = (twist + bent).max(axis=0)
        solid = float(sections_at(model, at_probe[None])[0][0])
        bending, shearing = 6.0 / solid**2, 1.5 / solid
        von_mises = 2.0 * direct + math.sqrt(3.0) * twisting
        missed = {
            **dict(zip(RESULTANTS[:3], (direct, direct, twisting), strict=True)),
            "qx": (np.abs(x) * across + np.abs(y) * twist / delta).max(axis=0),
            "qy": (np.abs(y) * across + np.abs(x) * twist / delta).max(axis=0),
            **dict.fromkeys(("m1", "m2"), either),
            **dict.fromkeys(DESIGN_MOMENTS, direct + twisting),
            **dict.fromkeys(("von_mises", "von_mises_bottom"), bending * von_mises),
        }
        for face in ("top", "bottom"):
            missed |= {f"{name}_{face}": bending * direct for name in ("sx", "sy")}
            missed[f"txy_{face}"] = bending * twisting
        for number, name in enumerate(REINFORCEMENT if model.bars else ()):
            assert model.bars is not None
            depth = solid - model.bars[number]
            # The lever arm of the bars is at least 0.8 of their depth.
            missed[name] = (direct + twisting) / (0.8 * model.bars.yield_stress * depth)
        missed |= {"txz": shearing * missed["qx"], "tyz": shearing * missed["qy"]}
        result |= {("probe", number, name): part for name, part in missed.items()}
    return result


def _ends(field: str) -> tuple[Key, Key]:
    return ("field", "max", field), ("field", "min", field)


def _sides(model: Model, mesh: Mesh) -> Ints:
    """Boundary sides (k, 3), as nodes, along which no support holds a slope or a twist."""
    return np.asarray(mesh.boundary[~np.isin(mesh.boundary[:, 1], sides_that_hold_turns(model, mesh)[:, 1])])


def _chords(mesh: Mesh, sides: Ints) -> tuple[Floats, Floats]:
    """Start and end points (p, 2) of the straight parts of sides (k, 3), in the order of the sides."""
    a, middle, b = (mesh.points[sides[:, at], None] for at in range(3))
    t = _CHORDS[:, None]
    places = middle + t * (0.5 * (b - a) + t * (0.5 * (a + b) - middle))
    return places[:, :-1].reshape(-1, 2), places[:, 1:].reshape(-1, 2)


def _left(thickness: float, size: float) -> float:
    """Part of the layer, 0 to 1, that elements with sides of length ``size`` do not resolve; formula at `_SEEN`."""
    seen = _SEEN * thickness / size
    return 1.0 - seen * math.tanh(1.0 / seen)
