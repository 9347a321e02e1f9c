"""A Mindlin plate of square elements in GetFEM, for the other scripts in this directory."""

import getfem as gf


def plate(mesh, young, poisson, thickness):
    """Return a model of MITC4 elements without loads and supports, the space of its deflection, and the quadrature."""
    plane, slopes = gf.MeshFem(mesh, 1), gf.MeshFem(mesh, 2)
    for space in (plane, slopes):
        space.set_fem(gf.Fem("FEM_QK(2,1)"))
    rule = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(2,4)"))
    model = gf.Model("real")
    model.add_fem_variable("w", plane)
    model.add_fem_variable("theta", slopes)
    for name, value in (("E", young), ("nu", poisson), ("thickness", thickness), ("kappa", 5 / 6)):
        model.add_initialized_data(name, [value])
    # The last argument selects GetFEM's MITC4.
    model.add_Mindlin_Reissner_plate_brick(rule, rule, "w", "theta", "E", "nu", "thickness", "kappa", 2)
    return model, plane, rule
