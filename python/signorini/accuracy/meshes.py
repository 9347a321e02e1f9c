"""Which meshes a mesh is compared with: of twice and four times its size or, if it is coarse, half and a quarter."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from signorini.mesh import Mesh
from signorini.mesh.refined import refined
from signorini.model import MeshPlate, Model

_LEAST_ALONG, _LEAST = 16, 2500
"""Elements along a side, and in all, from which on meshes of twice and four times the size show the plate: those of
1000 elements, compared with 250 and 64, cover what refining does in 94 to 96 % of numbers, with finer ones in 99 %."""

_FEWEST_ALONG = 2
"""Elements along the longer side that can be made larger."""

_CHEAP, _CHEAP_QUARTER = 10_000, 5_000
"""Elements of meshes of half and of a quarter of the size that are affordable: both take a second or two."""


@dataclass(frozen=True)
class OtherMesh:
    """The same plate on another mesh.

    Parameters
    ----------
    model : Model
    mesh : Mesh or None
        None where the model says all.
    words : str
    """

    model: Model
    mesh: Mesh | None
    words: str


def meshes_beside(model: Model, mesh: Mesh) -> Iterator[tuple[OtherMesh, ...]]:
    """Yield pairs of meshes to compare with, the nearest one first in each; the best pair first.

    A third one takes the place of a second one that cannot be solved, or is no other mesh.
    """
    count, plate = len(mesh.elements), model.plate
    divisions = model.divisions
    if isinstance(plate, MeshPlate) or (divisions is None and mesh.spanning.any() and count <= _CHEAP):
        # Where the outline alone says how large elements are, meshes of other sizes have the same ones.
        quarter = [_divided(model, mesh, 0.25)] if 16 * count <= _CHEAP else []
        larger = [] if isinstance(plate, MeshPlate) else [_scaled(model, mesh, 2.0)]
        cheap = 16 * count <= _CHEAP_QUARTER
        yield (_divided(model, mesh, 0.5), *(quarter + larger if cheap else larger + quarter))
    if isinstance(plate, MeshPlate):
        return
    # Divisions do not tell of refined places.
    along = math.isqrt(count) if divisions is None or model.mesh.refine else min(divisions)
    # Meshes on the way to an accuracy are judged alike, by finer ones, or half-widths would grow where that ends.
    asked = model.mesh.accuracy is not None
    coarse = along < _LEAST_ALONG or count < _LEAST or asked
    if coarse and 16 * count <= _CHEAP_QUARTER:
        yield _scaled(model, mesh, 0.5), _scaled(model, mesh, 0.25)
    if coarse and (asked or 4 * count <= _CHEAP):
        # Lines that the mesh follows may leave no larger elements.
        instead = [0.25] if 16 * count <= _CHEAP else []
        yield tuple(_scaled(model, mesh, factor) for factor in (0.5, *([2.0] if along > 1 else []), *instead))
    if along > 1:
        yield _scaled(model, mesh, 2.0), _scaled(model, mesh, 4.0)
    if not coarse and 4 * count <= _CHEAP:
        yield (_scaled(model, mesh, 0.5),)
    if 4 * count <= _CHEAP and (divisions is None or model.mesh.refine):
        # Where refined places and small outlines say how large most elements are.
        yield (_divided(model, mesh, 0.5),)


def coarser_of(model: Model, mesh: Mesh) -> tuple[OtherMesh, ...]:
    """Meshes of twice and four times the size; none of a mesh that is given, or of one element along a side."""
    divisions = model.divisions
    along = math.isqrt(len(mesh.elements)) if divisions is None or model.mesh.refine else max(divisions)
    if isinstance(model.plate, MeshPlate) or along < _FEWEST_ALONG:
        return ()
    return _scaled(model, mesh, 2.0), _scaled(model, mesh, 4.0)


_WORDS = {0.25: "a quarter of its size", 0.5: "half its size", 2.0: "twice its size", 4.0: "four times its size"}


def _scaled(model: Model, mesh: Mesh, factor: float) -> OtherMesh:
    assert not isinstance(model.plate, MeshPlate)
    scaled = model.plate.scaled(model.mesh, factor, model.divisions)
    return OtherMesh(model.model_copy(update={"mesh": scaled}), None, _WORDS[factor])


def _divided(model: Model, mesh: Mesh, factor: float) -> OtherMesh:
    """Every element in four, once or twice."""
    return OtherMesh(model, refined(mesh, round(math.log2(1 / factor))), f"{_WORDS[factor]}, divided")


def side(mesh: Mesh) -> float:
    """Mean side of a mesh's elements."""
    return float(np.sqrt(mesh.element_area.mean()))
