"""Refine a mesh until every half-width is small enough: uniformly or, of rectangles, where moments bend."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from signorini.analysis.twins.leaves import kind_of, largest_of, leaves, named
from signorini.base.memory import fits, needed
from signorini.discretise.rows import Floats
from signorini.mesh import Mesh
from signorini.model import Area, MeshOptions, MeshPlate, Model, RectanglePlate, Refinement
from signorini.results.figures import figures
from signorini.results.result import Result

_MOST_STEPS = 12
_TRIED, _GAINED = 3, 0.8
"""Meshes in a row that must gain something, and to what part half-widths must fall for that."""
ORDER = 1.5
"""Order in the size of elements by which half-widths are expected to fall."""
_LEAST, _MOST = 1.4, 2.5
"""By how much sides of elements shrink from one mesh to the next."""
_SAME_SIZE, _AS_ALL = 0.8, 0.95
"""Size over that of its neighbour, and of all others, from which on a band is one with it, and needs none."""


@dataclass(frozen=True)
class Refined:
    """A mesh on the way to an accuracy that was asked for.

    Parameters
    ----------
    elements, dofs : int
    worst : float
        The largest half-width over the largest value of its field.
    what : str
        Whose it is.
    """

    elements: int
    dofs: int
    worst: float
    what: str


def worst_of(results: Mapping[str, Result]) -> Refined | None:
    """The number that is farthest from the plate, over the largest of its field; None where there is no half-width."""
    found: Refined | None = None
    for result in results.values():
        if result.plus_minus is None:
            continue
        largest, count = largest_of(result), len(result.mesh.elements)
        # Extremes of moments and shears are wherever they happen to be: a probe says where one is to be as near.
        asked = {key: of for key, of in result.plus_minus.items() if key != "fields"}
        for path, width in leaves(asked).items():
            size = largest[kind_of(path)]
            part = width / size if size > 0 else 0.0
            if found is None or part > found.worst:
                what = f"{result.name}: {named([path], figures(result)).removeprefix('of ')}"
                found = Refined(count, 3 * result.mesh.node_count, part, what)
    return found


def refined(model: Model, results: Mapping[str, Result], steps: Sequence[Refined]) -> tuple[Model | None, str]:
    """Model with the next mesh; None where there is none, and why if the accuracy is not reached."""
    asked, plate, reached = model.mesh.accuracy, model.plate, steps[-1]
    assert asked is not None and not isinstance(plate, MeshPlate)
    if reached.worst <= asked:
        return None, ""
    worst = [step.worst for step in steps]
    left = (
        f"The accuracy of {asked:g} that was asked for is not reached: ± {reached.worst:.2g} of its field is left of "
        f"{reached.what}, on {reached.elements} elements."
    )
    if len(steps) == _MOST_STEPS or (len(steps) > _TRIED and min(worst[-_TRIED:]) > _GAINED * min(worst[:-_TRIED])):
        return None, (
            f"{left} Finer meshes do not bring it much nearer. What acts at a point, or on less than an element, needs "
            "a footprint or mesh.refine."
        )
    shrinking = float(np.clip((reached.worst / asked) ** (1 / ORDER), _LEAST, _MOST))
    mesh = plate.scaled(model.mesh, 1 / shrinking)
    if isinstance(plate, RectanglePlate) and plate.divisions(model.mesh) is not None:
        solved = [result for result in results.values() if result.status == "solved"]
        mesh = _graded(plate, solved, shrinking)
    count = math.ceil(reached.elements * shrinking**2)
    if not fits(1.4 * needed(count)):
        last = math.ceil(reached.elements * (reached.worst / asked) ** (2 / ORDER))
        return None, (
            f"{left} It would take about {float(f'{last:.2g}'):,.0f} elements and {needed(last) / 1e9:.1f} GB of "
            "memory."
        )
    kept = {"accuracy": asked, "error": model.mesh.error}
    return model.model_copy(update={"mesh": mesh.model_copy(update=kept)}), ""


def _graded(plate: RectanglePlate, solved: Sequence[Result], shrinking: float) -> MeshOptions:
    """Mesh options of a rectangle with smaller elements in the columns and rows where moments bend most."""
    mesh = solved[0].mesh
    (x, y), (a, b) = plate.origin, plate.size
    bands: list[Refinement] = []
    counts = []
    for axis, length in ((0, a), (1, b)):
        joints, bending = _bending(mesh, solved, axis)
        sides = np.diff(joints)
        # What bends h²m''/8 within an element is to bend as little in all of them, and less by what is to be gained.
        target = bending.max() / shrinking**2
        wanted = sides * np.sqrt(np.clip(target / np.maximum(bending, 1e-3 * target), 1 / _MOST**2, 1.0))
        counts.append(max(1, math.ceil(length / wanted.max() - 1e-9)))
        for low, high, size in _bands(joints, wanted, length / counts[-1]):
            box = (low, y, high, y + b) if axis == 0 else (x, low, x + a, high)
            bands.append(Refinement(area=Area(rectangle=box), size=size))
    return MeshOptions(divisions=(counts[0], counts[1]), refine=tuple(bands))


def _bending(mesh: Mesh, solved: Sequence[Result], axis: int) -> tuple[Floats, Floats]:
    """Joints (k + 1,) of a rectangle's mesh along an axis, and how much moments bend within each column (k,) or row.

    Of several results the one that bends most, each over its own largest moment.
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
    """Join neighbouring columns of nearly one size; those as wide as all others need no band."""
    found: list[tuple[float, float, float]] = []
    for low, high, side in zip(joints[:-1].tolist(), joints[1:].tolist(), wanted.tolist(), strict=True):
        if found and found[-1][1] == low and _SAME_SIZE < side / found[-1][2] < 1 / _SAME_SIZE:
            found[-1] = found[-1][0], high, min(side, found[-1][2])
        elif side < _AS_ALL * size:
            found.append((low, high, side))
    return found
