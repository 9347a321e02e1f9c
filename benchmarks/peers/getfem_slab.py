"""Slab A by GetFEM: MITC4 plate on soil that only pushes, as a nonlinear term solved by Newton's method.

Runs under the Python of Debian's python3-getfem, and prints a line of JSON.

    /usr/bin/python3 benchmarks/peers/getfem_slab.py 160
"""

import json
import resource
import sys
import time

import getfem as gf
import numpy as np
from getfem_plate import plate

SIDE, THICKNESS, YOUNG, POISSON, SOIL = 10.0, 0.3, 30e9, 0.2, 30e6
UNIFORM, PATCH, PATCH_ENDS = 2e3, 500e3, (0.5, 1.5)


def peak_mb():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def solve(elements):
    stations = np.linspace(0.0, SIDE, elements + 1)
    mesh = gf.Mesh("cartesian", stations, stations)
    model, plane, rule = plate(mesh, YOUNG, POISSON, THICKNESS)
    for name, value in (("soil", SOIL), ("uniform", UNIFORM), ("patch", PATCH)):
        model.add_initialized_data(name, [value])
    model.add_nonlinear_term(rule, "soil * pos_part(w) * Test_w")
    model.add_linear_term(rule, "-uniform * Test_w")
    # The borders of the loaded patch are element edges.
    centre = np.array([mesh.pts_from_cvid(c)[0].mean(axis=1) for c in mesh.cvid()])
    under = mesh.cvid()[((centre > PATCH_ENDS[0]) & (centre < PATCH_ENDS[1])).all(axis=1)]
    mesh.set_region(1, np.vstack([under, np.full_like(under, -1)]))
    model.add_linear_term(rule, "-patch * Test_w", 1)

    # Newton's method starts from a plate that touches everywhere: without soil its matrix is singular.
    model.set_variable("w", np.full(plane.nbdof(), 1e-3))
    iterations, _ = model.solve("max_res", 1e-8, "max_iter", 50)[:2]
    w = model.variable("w")
    touching = gf.asm("generic", rule, 0, "Heaviside(w)", -1, model)
    return {
        "settlement": float(w.max()),
        "uplift": float(-w.min()),
        "pressure": float(SOIL * w.max()),
        "contact": float(touching) / SIDE**2,
        "dofs": int(model.nbdof()),
        "iterations": int(iterations),
    }


def main():
    idle = peak_mb()
    begun = time.perf_counter()
    found = solve(int(sys.argv[1]))
    print(json.dumps({**found, "seconds": time.perf_counter() - begun, "idle_mb": idle, "peak_mb": peak_mb()}))


if __name__ == "__main__":
    main()
