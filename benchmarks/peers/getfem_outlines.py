"""Plates of `outlines.py` that have no closed form, by GetFEM: MITC4 on squares, deflections at nodes.

Runs under the Python of Debian's python3-getfem, and prints a line of JSON: the deflections with a given number of
elements along a side of length 2, and their limit, extrapolated from a quarter, half and all of the elements.

    /usr/bin/python3 benchmarks/peers/getfem_outlines.py L 256
    /usr/bin/python3 benchmarks/peers/getfem_outlines.py hole 256
"""

import json
import sys

import getfem as gf
import numpy as np
from getfem_plate import plate

SIDE, THICKNESS, YOUNG, POISSON = 2.0, 0.1, 1e7, 0.3
CUT = {"L": (1.0, 1.0, 2.0, 2.0), "hole": (0.75, 0.75, 1.25, 1.25)}
PLACES = {"L": [(0.5, 0.5), (1.5, 0.5)], "hole": [(0.5, 0.5), (0.75, 1.0)]}


def inside(points, box):
    """Mask of the points (2, q) in a box."""
    x, y = points
    return (x >= box[0]) & (x <= box[2]) & (y >= box[1]) & (y <= box[3])


def solve(case, elements):
    stations = np.linspace(0.0, SIDE, elements + 1)
    mesh = gf.Mesh("cartesian", stations, stations)
    centre = np.array([mesh.pts_from_cvid(c)[0].mean(axis=1) for c in mesh.cvid()])
    mesh.del_convex(mesh.cvid()[inside(centre.T, CUT[case])])
    faces = mesh.outer_faces()
    # Edges of the hole are free; all points of the elements beside these edges are in the inner box.
    free = [case == "hole" and inside(mesh.pts_from_cvid(c)[0], (0.5, 0.5, 1.5, 1.5)).all() for c in faces[0]]
    mesh.set_region(1, faces[:, ~np.array(free)])

    model, plane, rule = plate(mesh, YOUNG, POISSON, THICKNESS)
    model.add_linear_term(rule, "-Test_w")
    model.add_Dirichlet_condition_with_simplification("w", 1)
    if case == "hole":
        model.add_Dirichlet_condition_with_simplification("theta", 1)
    model.solve()
    w, nodes = model.variable("w"), plane.basic_dof_nodes()
    return np.array([w[np.argmin(np.hypot(*(nodes.T - at).T))] for at in PLACES[case]])


def main():
    case, elements = sys.argv[1], int(sys.argv[2])
    coarse, middle, fine = (solve(case, elements // part) for part in (4, 2, 1))
    ratio = (fine - middle) / (middle - coarse)
    limits = fine + (fine - middle) * ratio / (1.0 - ratio)
    print(json.dumps({"deflections": fine.tolist(), "limits": limits.tolist()}))


if __name__ == "__main__":
    main()
