"""Choice of the meshes with which a result is compared, and of the next mesh in refinement to a requested accuracy."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from signorini.accuracy.comparison import Estimate
from signorini.accuracy.half_width import largest_of, named
from signorini.base.memory import fits, needed
from signorini.discretise.rows import Bools, Floats
from signorini.mesh import Mesh
from signorini.mesh.meshers import divided
from signorini.model import Area, MeshOptions, MeshPlate, Model, RectanglePlate, Refinement
from signorini.model.whole import supports_and_loads
from signorini.results.quantities import Number
from signorini.results.result import Result
from signorini.shapes.distances import Targets, distances
from signorini.shapes.outlines import Point

_LEAST_ALONG, _LEAST = 16, 2500
"""Smallest numbers of elements, along a side and in total, of meshes that are compared with coarser ones. Half-widths
from 1000, 250 and 64 elements cover 94 to 96 % of true errors; half-widths from finer meshes cover 99 %."""

_STRAIGHT = 1e-9
"""Largest distance of a midside node from the middle of a straight side's ends, relative to the plate's size."""

_FEWEST_ALONG = 2
"""Smallest number of elements along the longer side of a mesh that can be coarsened."""

_CHEAP = 10_000
"""Largest number of elements of a finer mesh for comparison. Its solution takes a second or two."""


_WORK_EXPONENT = 1.3
"""Approximate exponent p of the solution time, which grows as (number of elements)^p."""


@dataclass(frozen=True)
class OtherMesh:
    """A model on another mesh, whose elements have ``factor`` times the side of the elements of its own mesh.

    If ``mesh`` is None, the mesh follows from the options of ``model``.
    """

    model: Model
    mesh: Mesh | None
    words: str
    factor: float

    @property
    def work(self) -> float:
        """Estimated solution time, relative to the time on the model's own mesh."""
        return math.pow(self.factor, -2.0 * _WORK_EXPONENT)


def meshes_beside(model: Model, mesh: Mesh) -> Iterator[tuple[OtherMesh, ...]]:
    """Yield tuples of meshes with which a mesh can be compared, the best tuple first.

    The first two meshes of a tuple are compared. A third mesh replaces a mesh that cannot be solved, or whose element
    size differs too little from the others.
    """
    given = _is_given(model)
    if model.plates and given:
        return
    count, along = len(mesh.elements), _along(model, len(mesh.elements))
    # Where the outline fixes the element size, other size options give the same mesh.
    outlined = not model.plates and model.divisions is None and mesh.spanning.any() and count <= _CHEAP
    fixed = given or outlined
    # A refined mesh is divided: size options do not scale the transition to its small elements, division does.
    finer = _divided if fixed or (not model.plates and _is_straight(mesh)) else _scaled
    coarser = [] if given or along == 1 else [_scaled(model, mesh, 2.0), _scaled(model, mesh, 4.0)]
    # In a refinement to an accuracy, all meshes are compared with finer meshes.
    # Half-widths would jump if some meshes were compared with finer meshes and others with coarser meshes.
    asked = model.mesh.accuracy is not None
    coarse = fixed or asked or along < _LEAST_ALONG or count < _LEAST
    if coarse and 16 * count <= _CHEAP:
        yield finer(model, mesh, 0.5), finer(model, mesh, 0.25)
    if fixed or asked or (coarse and 4 * count <= _CHEAP):
        yield finer(model, mesh, 0.5), *coarser[:1]
    if coarser:
        yield tuple(coarser)
    if not model.plates and 4 * count <= _CHEAP:
        yield (_divided(model, mesh, 0.5),)


def _is_given(model: Model) -> bool:
    """Whether the input gives the mesh of the plate, or of one of several plates."""
    return any(isinstance(plate, MeshPlate) for plate in (model.plate, *model.plates.values()))


def _is_straight(mesh: Mesh) -> bool:
    """Whether all sides of elements are straight, so that divided elements cover the same area."""
    corners = mesh.points[mesh.elements[:, :4]]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    return bool(np.abs(mesh.points[mesh.elements[:, 4:8]] - middles).max() <= _STRAIGHT * mesh.size)


def _along(model: Model, count: int) -> int:
    """Estimated number of elements along the shorter side of a plate; for several plates the smallest number."""
    parts = [part.model for part in model.parts] if model.plates else [model]
    # `divisions` omit elements of refined places, so √(number of elements) replaces them in refined meshes.
    each = [None if part.mesh.refine else part.divisions for part in parts]
    return min(math.isqrt(count // len(each)) if one is None else min(one) for one in each)


def meshes_beside_path(model: Model, mesh: Mesh) -> tuple[OtherMesh, ...]:
    """Return meshes of two and four times the element size or, if these are the same mesh, of a half and a quarter.

    The tuple is empty if the input gives the mesh, or if there is only one element along a side.
    """
    count, rows = len(mesh.elements), None if model.plates or model.mesh.refine else model.divisions
    along = _along(model, count) if model.plates else math.isqrt(count) if rows is None else max(rows)
    if _is_given(model) or along < _FEWEST_ALONG:
        return ()
    pair = _scaled(model, mesh, 2.0), _scaled(model, mesh, 4.0)
    if _rows(pair[0].model) == _rows(pair[1].model):
        pair = _scaled(model, mesh, 0.5), _scaled(model, mesh, 0.25)
    return pair


def _rows(model: Model) -> list[object]:
    """Divisions of every plate, or the mesh options of a plate without divisions."""
    each = [part.model for part in model.parts] if model.plates else [model]
    return [one.mesh if one.divisions is None or one.mesh.refine else one.divisions for one in each]


_WORDS = {0.25: "a quarter of its size", 0.5: "half its size", 2.0: "twice its size", 4.0: "four times its size"}


def _scaled(model: Model, mesh: Mesh, factor: float) -> OtherMesh:
    if model.plates:
        plates = {part.name: _scaled(part.model, mesh, factor).model for part in model.parts}
        own = {name: one.plate.model_copy(update={"mesh": one.mesh}) for name, one in plates.items()}
        return OtherMesh(model.varied(plates=own), None, _WORDS[factor], factor)
    assert not isinstance(model.plate, MeshPlate)
    scaled = model.plate.scaled(model.mesh, factor, model.divisions)
    return OtherMesh(model.varied(mesh=scaled), None, _WORDS[factor], factor)


def _divided(model: Model, mesh: Mesh, factor: float) -> OtherMesh:
    """Return a mesh with every element divided once into four (``factor`` 0.5) or twice (0.25)."""
    return OtherMesh(model, divided(mesh, round(math.log2(1 / factor))), f"{_WORDS[factor]}, divided", factor)


_MOST_STEPS = 12
_TRIED, _GAINED, _TWICE = 3, 0.8, 2
"""Refinement ends if the last three meshes double the number of elements, but the smallest half-width of these meshes
is above 0.8 times that of all earlier meshes."""
ORDER = 1.5
"""Expected order of convergence p of half-widths: they decrease as (element size)^p."""
_LEAST_STEP, _MOST, _MOST_AT_PLACES = 1.4, 2.5, 4.0
"""Smallest and largest factor by which elements shrink from one mesh to the next over the whole plate, and largest
factor at single places.
"""
_GROWTH = 0.25
"""Increase of the element size per unit of distance from places with small elements."""
_PARTS = 3.0
"""Length, in mean element sizes, of the parts of a line with inaccurate numbers. Each part has its own refinement."""
_AIM = 0.5
"""Accuracy that refinement at single places aims at, relative to the requested accuracy. This leaves a margin, since a
new mesh within an outline also changes numbers at places where it is not finer."""
_TWINS = 1.25
"""Memory for a mesh and one of half its element size together, relative to the memory for the finer mesh."""
_SAME_SIZE, _AS_ALL = 0.8, 0.95
"""Refined bands of a rectangle: smallest ratio of the element sizes of neighbours that are joined to one band, and
smallest ratio of element sizes, inside to outside, at which a band is not refined.
"""


@dataclass(frozen=True)
class Refined:
    """One mesh of a refinement to a requested accuracy."""

    elements: int
    dofs: int
    worst: float
    """Largest half-width among the numbers, relative to the largest value of the number's field."""
    what: str
    """Name of the number that has this largest half-width."""
    expected: int
    """Estimated number of elements with which the requested accuracy is reached."""

    def said(self, asked: float) -> str:
        """State the accuracy reached, and the elements and memory that the requested accuracy ``asked`` would need."""
        result = (
            f"with {self.elements:,} elements ± of {self.what} is {self.worst:.2g} of the largest value of its field"
        )
        return result if self.worst <= asked else f"{result}. ± of {asked:g} would take {_cost(self.expected)}"


@dataclass(frozen=True)
class _Wide:
    """A number, its result, and its half-width ``part`` relative to the largest value of its kind."""

    part: float
    result: Result
    number: Number

    @property
    def what(self) -> str:
        probes = np.array([probe.at for probe in self.result.probes]).reshape(-1, 2)
        return f"{named([self.number], self.result.model, probes)} in {self.result.name}"

    @property
    def place(self) -> tuple[Point, ...]:
        """Point or line to which the number belongs; empty for numbers of the whole plate."""
        model, one = self.result.model, self.number
        match one.home:
            case "probe" if one.quantity.kind not in ("deflection", "rotation"):
                return (self.result.probes[one.owner].at,)
            case "section":
                return tuple(model.section[one.owner].line)
            case "station":
                return model.strip[one.owner].across[one.part]
            case "strip":
                moments = [station.moment for station in self.result.strips[one.owner].stations]
                at = int(np.argmax(moments) if one.what == "max_moment" else np.argmin(moments))
                return model.strip[one.owner].across[at]
        return ()


@dataclass(frozen=True)
class _Piece:
    """A point or a straight part of a line at which half-widths exceed the requested accuracy.

    ``size`` is the element size at this place. ``part`` is the largest half-width at this place, relative to the
    largest value of its field.
    """

    ends: tuple[Point, ...]
    size: float
    part: float

    def smaller(self, asked: float, most: float) -> float:
        """Element size that is expected to reach the accuracy ``asked``, but at least ``size / most``."""
        return self.size / float(np.clip((self.part / (_AIM * asked)) ** (1 / ORDER), 1.0, most))

    def refinement(self, size: float) -> Refinement:
        return Refinement(line=self.ends, size=size) if len(self.ends) > 1 else Refinement(at=self.ends, size=size)


def worst_of(estimates: Mapping[str, Estimate], before: Sequence[Refined] = ()) -> Refined | None:
    """Return the mesh of the estimates with its largest relative half-width; None if no number has a half-width.

    ``before`` are the previous meshes of the refinement.
    """
    worst = max(_numbers(estimates), key=lambda number: number.part, default=None)
    if worst is None:
        return None
    mesh, model = worst.result.mesh, worst.result.model
    count = len(mesh.elements)
    expected, asked = count, model.mesh.accuracy
    if asked is not None and worst.part > asked:
        if not isinstance(model.plate, RectanglePlate) or model.divisions is None:
            whole, pieces = _too_wide(estimates, asked)
            sizes = [piece.smaller(asked, math.inf) for piece in pieces]
            expected = _count(mesh, max(1.0, whole / asked) ** (1 / ORDER), pieces, sizes)
        else:
            expected = math.ceil(count * (worst.part / asked) ** (1 / _rate(before, count, worst.part)))
    return Refined(count, 3 * mesh.node_count, worst.part, worst.what, expected)


def _numbers(estimates: Mapping[str, Estimate]) -> Iterator[_Wide]:
    """Yield the numbers that must be accurate, with their half-widths.

    Extremes of fields, of reactions per length and of concentrated forces are excluded: probes say where a field must
    be accurate. Stresses are excluded, since they are as accurate as moments and shears.
    """
    for estimate in estimates.values():
        result, largest = estimate.result, largest_of(estimate.result)
        jumps = _on_lines(result.model, result.mesh, [probe.at for probe in result.probes])
        for number, width in zip(result.catalogue, estimate.widths.tolist(), strict=True):
            kind, at_probe = number.quantity.kind, number.home == "probe"
            skipped = at_probe and (kind in ("stress", "shear_stress") or (kind == "shear" and jumps[number.owner]))
            skipped |= kind in ("per_length", "corner")
            if (
                math.isnan(width)
                or skipped
                or (number.home in ("field", "mean") and number.quantity.name != "deflection")
            ):
                continue
            size = largest[number.quantity.kind]
            yield _Wide(width / size if size > 0 else 0.0, result, number)


def _on_lines(model: Model, mesh: Mesh, points: Sequence[Point]) -> Bools:
    """Mask of the points on a line that supports or loads the plate, since shears jump across such a line."""
    at, result = np.array(points).reshape(-1, 2), np.zeros(len(points), np.bool_)
    for item in supports_and_loads(model):
        if item.where.curve is not None:
            result |= Targets.along(item.where.outline).nearest(at)[1] <= mesh.near.written
    return result


def _rate(before: Sequence[Refined], count: int, worst: float) -> float:
    """Exponent r with half-width ∝ (number of elements)^−r, as observed; at least the expected exponent."""
    least = 0.5 * ORDER
    if not before or not count > before[0].elements:
        return least
    first = before[0]
    return max(least, math.log(first.worst / worst) / math.log(count / first.elements))


def unknown(asked: float) -> str:
    """Return the warning that the accuracy is unknown, since no other mesh could be solved."""
    return f"The accuracy of {asked:g} that was asked for is not known to be reached: no number has a half-width (±)."


def _cost(elements: int) -> str:
    memory = _TWINS * needed(4 * elements) / 1e9
    count = float(f"{elements:.2g}")
    return f"about {count:,.0f} elements and {memory:.1f} GB of memory, including a mesh of half the element size"


def refined(model: Model, estimates: Mapping[str, Estimate], steps: Sequence[Refined]) -> tuple[Model | None, str]:
    """Return the model with the next mesh, or None; and the reason if the accuracy is not reached, else ""."""
    asked, plate, reached = model.mesh.accuracy, model.plate, steps[-1]
    assert asked is not None and not isinstance(plate, MeshPlate)
    if reached.worst <= asked:
        return None, ""
    worst = [step.worst for step in steps]
    left = f"The accuracy of {asked:g} that was asked for is not reached: {reached.said(asked)}"
    if len(steps) == _MOST_STEPS:
        return None, f"{left}. This mesh is the last of {_MOST_STEPS} meshes; begin with smaller elements."
    tried = steps[-_TRIED - 1 :]
    if (
        len(steps) > _TRIED
        and reached.elements >= _TWICE * tried[0].elements
        and min(worst[-_TRIED:]) > _GAINED * min(worst[:-_TRIED])
    ):
        return None, (
            f"{left}, but finer meshes hardly improve it. Loads and supports at points, or on less than "
            "an element, need a footprint or mesh.refine; the shear jumps on a line that supports or loads the plate."
        )
    shrinking = float(np.clip((reached.worst / asked) ** (1 / ORDER), _LEAST_STEP, _MOST))
    count = math.ceil(reached.elements * shrinking**2)
    if not isinstance(plate, RectanglePlate) or model.divisions is None:
        (mesh, count) = _at_places(model, estimates, len(steps) > 1 and worst[-1] > _GAINED * worst[-2])
    else:
        mesh = _graded(plate, [one.result for one in estimates.values() if one.result.status == "solved"], shrinking)
    if not fits(_TWINS * needed(4 * count)):
        return None, f"{left}. The memory does not suffice for the next mesh, of {_cost(count)}."
    kept = {"accuracy": asked, "error": model.mesh.error}
    return model.varied(mesh=mesh.model_copy(update=kept)), ""


def _at_places(model: Model, estimates: Mapping[str, Estimate], everywhere: bool) -> tuple[MeshOptions, int]:
    """Mesh options with smaller elements at the places of inaccurate numbers, and the estimated number of elements.

    A number without a place refines the whole plate. The whole plate is also refined if ``everywhere``, since
    refinement at places did not help.
    """
    asked, plate = model.mesh.accuracy, model.plate
    assert asked is not None and not isinstance(plate, MeshPlate)
    whole, pieces = _too_wide(estimates, asked)
    shrinking = 1.0
    if everywhere or whole > asked:
        shrinking = float(np.clip((whole / asked) ** (1 / ORDER), _LEAST_STEP, _MOST))
    scaled = plate.scaled(model.mesh, 1 / shrinking, None)
    sizes = [piece.smaller(asked, _MOST_AT_PLACES) for piece in pieces]
    refine = [piece.refinement(size) for piece, size in zip(pieces, sizes, strict=True)]
    mesh = next(iter(estimates.values())).result.mesh
    return scaled.model_copy(update={"refine": (*scaled.refine, *refine)}), _count(mesh, shrinking, pieces, sizes)


def _too_wide(estimates: Mapping[str, Estimate], asked: float) -> tuple[float, list[_Piece]]:
    """Largest relative half-width of numbers without a place, and the points and parts of lines to refine."""
    whole, parts = 0.0, dict[tuple[Point, ...], float]()
    for number in _numbers(estimates):
        if number.part > _AIM * asked:
            place = number.place
            whole = max(whole, 0.0 if place else number.part)
            if place:
                parts[place] = max(parts.get(place, 0.0), number.part)
    mesh = next(iter(estimates.values())).result.mesh
    ends, part = list[tuple[Point, ...]](), list[float]()
    longest = _PARTS * float(np.sqrt(mesh.element_area.mean()))
    for place, most in parts.items():
        if len(place) == 1:
            ends.append(place)
            part.append(most)
        for begin, end in pairwise(place):
            stations = np.linspace(begin, end, math.ceil(math.dist(begin, end) / longest) + 1).tolist()
            result = [(tuple(one), tuple(other)) for one, other in pairwise(stations)]
            ends += result
            part += [most] * len(result)
    middles = np.array([np.mean(one, axis=0) for one in ends]).reshape(-1, 2)
    sizes = np.sqrt(mesh.element_area[mesh.locate(middles).elements]).tolist()
    return whole, [_Piece(*one) for one in zip(ends, sizes, part, strict=True)]


def _count(mesh: Mesh, shrinking: float, pieces: Sequence[_Piece], sizes: Sequence[float]) -> int:
    """Estimated number of elements if all shrink by the factor ``shrinking``, and those at ``pieces`` to ``sizes``."""
    side = np.sqrt(mesh.element_area) / shrinking
    middles = mesh.points[mesh.elements[:, :4]].mean(axis=1)
    for piece, size in zip(pieces, sizes, strict=True):
        ends = np.array([piece.ends[0], piece.ends[-1]])
        side = np.minimum(side, size + _GROWTH * distances(middles, ends[:1], ends[1:])[:, 0])
    return math.ceil(float((mesh.element_area / side**2).sum()))


def _graded(plate: RectanglePlate, solved: Sequence[Result], shrinking: float) -> MeshOptions:
    """Mesh options of a rectangle with smaller elements in columns and rows with large curvature of moments."""
    mesh = solved[0].mesh
    (x, y), (a, b) = plate.origin, plate.size
    bands: list[Refinement] = []
    counts = []
    for axis, length in ((0, a), (1, b)):
        joints, bending = _bending(mesh, solved, axis)
        sides = np.diff(joints)
        # The interpolation error h²m''/8 shall be equal in all elements, and smaller than now by ``shrinking``².
        target = bending.max() / shrinking**2
        wanted = sides * np.sqrt(np.clip(target / np.maximum(bending, 1e-3 * target), 1 / _MOST**2, 1.0))
        counts.append(max(1, math.ceil(length / wanted.max() - 1e-9)))
        for low, high, size in _bands(joints, wanted, length / counts[-1]):
            box = (low, y, high, y + b) if axis == 0 else (x, low, x + a, high)
            bands.append(Refinement(area=Area(rectangle=box), size=size))
    return MeshOptions(divisions=(counts[0], counts[1]), refine=tuple(bands))


def _bending(mesh: Mesh, solved: Sequence[Result], axis: int) -> tuple[Floats, Floats]:
    """Grid coordinates (k + 1,) of a rectangle along an axis, and the interpolation error of moments per column (k,).

    The error is h²|m''|/8, the deviation of a moment from linear within an element, as a root mean square over the
    column. It is the largest over several results, each relative to its largest moment.
    """
    corners = mesh.points[mesh.elements[:, :4]][..., axis]
    joints = np.unique(mesh.points[mesh.elements[:, :4].ravel(), axis])
    keep = np.append(True, np.diff(joints) > 1e-9 * mesh.size)
    joints = joints[keep]
    column = np.searchsorted(joints, corners.mean(axis=1)) - 1
    sides = ((0, 4, 1), (3, 6, 2)) if axis == 0 else ((0, 7, 3), (1, 5, 2))
    most = np.zeros(len(joints) - 1)
    for result in solved:
        moment = result.moment[result.stress_nodes.elements]
        size = np.abs(moment).max()
        if not size > 0:
            continue
        bent = sum(np.abs(moment[:, b] - 0.5 * (moment[:, a] + moment[:, c])).max(axis=1) for a, b, c in sides)
        square = np.bincount(column, mesh.element_area * (bent / size) ** 2, len(most))
        most = np.maximum(most, np.sqrt(square / np.bincount(column, mesh.element_area, len(most))))
    return joints, np.maximum(most, np.finfo(float).tiny)


def _bands(joints: Floats, wanted: Floats, size: float) -> list[tuple[float, float, float]]:
    """Bands (begin, end, element size) of neighbouring columns of similar size, except bands of about ``size``."""
    result: list[tuple[float, float, float]] = []
    for low, high, side in zip(joints[:-1].tolist(), joints[1:].tolist(), wanted.tolist(), strict=True):
        if result and result[-1][1] == low and _SAME_SIZE < side / result[-1][2] < 1 / _SAME_SIZE:
            result[-1] = result[-1][0], high, min(side, result[-1][2])
        elif side < _AS_ALL * size:
            result.append((low, high, side))
    return result
