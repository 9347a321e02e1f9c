"""Convert the fields of a result to the fields of a .vtu file."""

from __future__ import annotations

import numpy as np

from signorini.discretise.rows import Floats
from signorini.formats.vtk import displacement_vector
from signorini.results.checks import utilisations
from signorini.results.contact_field.area_contact import Pressures
from signorini.results.state import ResultState
from signorini.results.support_result import areas_below

_VECTORS = {
    "principal_moment": ("m1", "m2"),
    "design_moment_bottom": ("mx_bottom", "my_bottom"),
    "design_moment_top": ("mx_top", "my_top"),
    "stress_top": ("sx_top", "sy_top", "txy_top"),
    "stress_bottom": ("sx_bottom", "sy_bottom", "txy_bottom"),
    "shear_stress": ("txz", "tyz"),
    "reinforcement_bottom": ("as_x_bottom", "as_y_bottom"),
    "reinforcement_top": ("as_x_top", "as_y_top"),
}
"""Vectors in a .vtu file: names of the fields that are their components, by name of the vector."""


def vtk_fields(result: ResultState) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Fields of a .vtu file by name: first those at stress nodes, then those of elements."""
    data = {
        "deflection": result.deflection,
        "displacement": displacement_vector(result.deflection),
        "rotation": np.column_stack([result.rotation, np.zeros(len(result.rotation))]),
        "moment": result.moment,
        "shear": np.column_stack([result.shear, np.zeros(len(result.shear))]),
    }
    for name, parts in _VECTORS.items():
        if parts[0] not in result.fields:
            continue
        values = np.zeros((result.stress_nodes.count, 3))
        for axis, part in enumerate(parts):
            values[:, axis] = result.fields[part]
        data[name] = values
    data["von_mises"] = result.fields["von_mises"]
    data |= {name: result.fields[name] for name in utilisations(result.model)}
    of_elements = {}
    if any(support.on_nodes for support in result.model.support):
        data["reaction"] = result.nodal_reaction
    if areas := areas_below(result.supports):
        pressures, forces = Pressures(areas), [area.reactions for area in areas]
        if any(area.support.is_elastic for area in areas):
            on = pressures.nodes
            data["contact_pressure"] = np.zeros(result.mesh.node_count)
            data["contact_pressure"][on] = pressures.at_nodes([area.deflection[on] for area in areas], forces)
        if any(not area.support.is_elastic for area in areas):
            of_elements["rigid_contact_pressure"] = np.zeros(len(result.mesh.elements))
            of_elements["rigid_contact_pressure"][pressures.elements] = pressures.on_elements(forces)
    return {name: result.stress_nodes.spread(values) for name, values in data.items()}, of_elements
