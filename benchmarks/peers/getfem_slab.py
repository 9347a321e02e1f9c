"""Slabs A and B by GetFEM: a MITC4 plate.

The soil of slab A is a nonlinear term, solved by Newton's method. The points of slab B are springs of an explicit
matrix. Springs that pull are removed and the plate is solved again, until none pulls and no removed spring would push.
Runs under the Python of Debian's python3-getfem:

    /usr/bin/python3 benchmarks/peers/getfem_slab.py A 160
"""

from __future__ import annotations

from typing import Any

from absent import missing

try:
    import getfem as gf
    import numpy as np
    from getfem_plate import plate
    from slab import BEARINGS, PATCH, POISSON, RIGID, SIDE, SOIL, THICKNESS, UNIFORM, YOUNG, Grid, main
except ImportError:
    missing("GetFEM (Debian: python3-getfem)")
MOST_SOLUTIONS = 20
"""Largest number of solutions of slab B."""


def loaded(n: int) -> tuple[Any, Any, Any]:
    """Return the plate under its load: the model, the space of its deflection, and the quadrature."""
    grid, stations = Grid(n), np.linspace(0.0, SIDE, n + 1)
    mesh = gf.Mesh("cartesian", stations, stations)
    model, plane, rule = plate(mesh, YOUNG, POISSON, THICKNESS)
    for name, value in (("soil", SOIL), ("uniform", UNIFORM), ("patch", PATCH)):
        model.add_initialized_data(name, [value])
    model.add_linear_term(rule, "-uniform * Test_w")
    under = mesh.cvid()[grid.loaded]
    mesh.set_region(1, np.vstack([under, np.full_like(under, -1)]))
    model.add_linear_term(rule, "-patch * Test_w", 1)
    return model, plane, rule


def on_soil(n: int) -> dict[str, Any]:
    """Solve slab A."""
    model, plane, rule = loaded(n)
    model.add_nonlinear_term(rule, "soil * pos_part(w) * Test_w")
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


def on_points(n: int) -> dict[str, Any]:
    """Solve slab B."""
    places, closed = None, np.ones(len(BEARINGS), bool)
    for _ in range(MOST_SOLUTIONS):
        model, plane, _ = loaded(n)
        nodes = plane.basic_dof_nodes()
        places = np.array([np.argmin(np.hypot(*(nodes.T - at).T)) for at in BEARINGS])
        springs = gf.Spmat("empty", plane.nbdof(), plane.nbdof())
        for place in places[closed].tolist():
            springs.add(place, place, RIGID)
        model.add_explicit_matrix("w", "w", springs)
        model.solve()
        w = model.variable("w")
        if ((pushed := w[places] > 0) == closed).all():
            reactions = RIGID * np.maximum(w[places], 0.0)
            return {"settlement": float(w.max()), "uplift": float(-w.min()), "reactions": reactions.tolist()}
        closed = pushed
    raise RuntimeError("the contact state repeats")


def solve(case: str, n: int) -> dict[str, Any]:
    """Solve a case with n × n elements."""
    return on_soil(n) if case == "A" else on_points(n)


if __name__ == "__main__":
    main(solve)
