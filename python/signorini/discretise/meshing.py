"""The mesh that a model asks for; it follows the outlines and lines of loads and supports where it can."""

from __future__ import annotations

import math
from collections.abc import Iterator

from signorini.discretise.places import curve, region
from signorini.memory import require_memory
from signorini.mesh import Mesh
from signorini.mesh.meshers import annulus, disc, rectangle
from signorini.model import AnnulusPlate, DiscPlate, Load, MeshPlate, Model, RectanglePlate, Support
from signorini.regions import Curve, Region


def mesh_of(model: Model) -> Mesh:
    """Mesh the model's plate, or read its mesh."""
    plate = model.plate
    if isinstance(plate, MeshPlate):
        from signorini.mesh.meshfile import read

        mesh = read(plate.file)
        require_memory(len(mesh.elements), "plate.file")
        return mesh
    require_memory(math.prod(plate.divisions(model.mesh)), "mesh")
    match plate:
        case RectanglePlate():
            x_lines = [x for shape in _shapes(model) for x in shape.x_lines]
            y_lines = [y for shape in _shapes(model) for y in shape.y_lines]
            return rectangle(plate.origin, plate.size, plate.divisions(model.mesh), x_lines, y_lines)
        case DiscPlate():
            radii = [r for shape in _shapes(model) for r in shape.radii(plate.center)]
            return disc(plate.center, plate.radius, plate.divisions(model.mesh), plate.sector, radii)
        case AnnulusPlate():
            radii = [r for shape in _shapes(model) for r in shape.radii(plate.center)]
            divisions = plate.divisions(model.mesh)
            return annulus(plate.center, plate.inner, plate.outer, divisions, plate.sector, radii)


def _shapes(model: Model) -> Iterator[Region | Curve]:
    items: list[Support | Load] = [*model.support, *model.load]
    for item in items:
        for shape in (region(item.area), curve(item)):
            if shape is not None:
                yield shape
