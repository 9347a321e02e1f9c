"""Orthotropic plates against Navier's series with shear, and against isotropic ones."""

import numpy as np
import pytest
from halving import halved

import signorini
from signorini import Model, contact_problem
from signorini.analysis.single import solve_one
from signorini.discretise import discretise
from signorini.mesh import Mesh

A, B, PRESSURE = 4.0, 3.0, 1e3
TIMBER = {"Ex": 11e9, "Ey": 1.1e9, "nu_xy": 0.3, "Gxy": 0.69e9, "Gxz": 0.6e9, "Gyz": 0.069e9}


MODIFIERS = {"bending": 0.5, "twist": 0.1, "shear": 0.7}


def navier(thickness, x, y, modifiers, terms=60):
    """Deflection and [mx, my, mxy] of the hard simply supported rectangle whose sides are the material's axes."""
    E1, E2, nu, G, G1, G2 = (TIMBER[key] for key in ("Ex", "Ey", "nu_xy", "Gxy", "Gxz", "Gyz"))
    d = E1 * thickness**3 / 12 / (1 - nu**2 * E2 / E1)
    D11, D12, D22, D66 = d, d * nu * E2 / E1, d * E2 / E1, G * thickness**3 / 12
    S1, S2 = 5 / 6 * thickness * G1, 5 / 6 * thickness * G2
    bending, twist, shear = (modifiers.get(key, 1.0) for key in MODIFIERS)
    D11, D12, D22, D66, S1, S2 = bending * D11, bending * D12, bending * D22, twist * D66, shear * S1, shear * S2
    w, moment = 0.0, np.zeros(3)
    for m in range(1, terms, 2):
        for n in range(1, terms, 2):
            a, b = m * np.pi / A, n * np.pi / B
            K = np.array(
                [
                    [S1 * a**2 + S2 * b**2, -S1 * a, -S2 * b],
                    [-S1 * a, D11 * a**2 + D66 * b**2 + S1, (D12 + D66) * a * b],
                    [-S2 * b, (D12 + D66) * a * b, D22 * b**2 + D66 * a**2 + S2],
                ]
            )
            W, X, Y = np.linalg.solve(K, [16 * PRESSURE / np.pi**2 / m / n, 0, 0])
            ss, cc = np.sin(a * x) * np.sin(b * y), np.cos(a * x) * np.cos(b * y)
            w += W * ss
            twist = D66 * (b * X + a * Y) * cc
            moment += [(D11 * a * X + D12 * b * Y) * ss, (D12 * a * X + D22 * b * Y) * ss, -twist]
    return w, moment


def turned(model, angle, part=0.0):
    """The model's rectangle, its material with it, turned about the origin; some of its elements halved."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    mesh = discretise(model).mesh
    mesh = halved(mesh, part) if part else mesh
    mesh = Mesh(mesh.points @ np.array([[c, s], [-s, c]]), mesh.elements, mesh.edges)
    model = Model.model_validate(model.model_copy(update={"probe": ()}))
    (combination,) = model.effective_combinations
    result = solve_one(contact_problem(discretise(model, mesh)), combination)
    assert result.certificate.passed
    return result, np.array([[c, -s], [s, c]])


@pytest.mark.parametrize("part", [0.0, 1.0], ids=["quadrilaterals", "triangles"])
@pytest.mark.parametrize("angle", [0.0, 30.0])
@pytest.mark.parametrize(("thickness", "modifiers"), [(0.4, {}), (0.02, {}), (1e-4, {}), (0.2, MODIFIERS)])
def test_the_hard_rectangle_is_naviers_at_any_angle(thickness, modifiers, angle, part):
    model = Model(
        material=TIMBER | {"angle": angle},
        plate={"shape": "rectangle", "size": [A, B], "thickness": thickness, "modifiers": modifiers},
        mesh={"divisions": [16, 12]},
        support=[{"edge": ["left", "right", "bottom", "top"], "fix": "hard"}],
        load=[{"pressure": PRESSURE}],
    )
    result, turn = turned(model, angle, part)
    for x, y in ((A / 2, B / 2), (1.25, 0.75)):
        (probe,) = result.probe([turn @ [x, y]])
        deflection, (mx, my, mxy) = navier(thickness, x, y, modifiers)
        expected = turn @ np.array([[mx, mxy], [mxy, my]]) @ turn.T
        found = np.array([probe.moment[0], probe.moment[1], probe.moment[2]])
        assert probe.deflection == pytest.approx(deflection, rel=2e-3)
        size = np.abs(expected).max()
        assert found == pytest.approx([expected[0, 0], expected[1, 1], expected[0, 1]], abs=2e-2 * size)


def sections(thickness, modifiers=None):
    """The stiffness of a section of TIMBER, in N·m and N/m."""
    E1, E2, nu, G, G1, G2 = (TIMBER[key] for key in ("Ex", "Ey", "nu_xy", "Gxy", "Gxz", "Gyz"))
    d = E1 * thickness**3 / 12 / (1 - nu**2 * E2 / E1)
    bending = {"Dx": d, "Dy": d * E2 / E1, "D1": d * nu * E2 / E1, "Dxy": G * thickness**3 / 12}
    return bending | {"Sx": 5 / 6 * thickness * G1, "Sy": 5 / 6 * thickness * G2}


@pytest.mark.parametrize(("h", "modifiers", "angle"), [(0.4, {}, 0.0), (0.02, {}, 30.0), (0.2, MODIFIERS, -50.0)])
def test_a_section_given_by_its_stiffness_is_that_of_its_material(h, modifiers, angle):
    """Whatever thickness stands beside it; so too in a zone over the whole plate."""

    def deflection(material, thickness, zone=(), **given):
        plate = {"shape": "rectangle", "size": [A, B], "thickness": thickness, "modifiers": modifiers, **given}
        model = Model(
            material=material,
            plate=plate,
            zone=zone,
            mesh={"divisions": [16, 12], "error": False},
            support=[{"edge": ["left", "right", "bottom", "top"], "fix": "hard"}],
            load=[{"pressure": PRESSURE}],
            probe=[{"at": [[1.25, 0.75], [A / 2, B / 2]]}],
        )
        probes = signorini.solve(model)["all"].probes
        return np.array([[probe.deflection, *probe.moment, *probe.shear] for probe in probes])

    made, own = deflection(TIMBER | {"angle": angle}, h), sections(h) | {"angle": angle}
    whole = {"area": {"rectangle": [0, 0, A, B]}, "thickness": h, "stiffness": own}
    for other in (
        deflection({}, h, stiffness=own),
        deflection({}, 1.7 * h, stiffness=own),
        deflection({"E": 1e9, "nu": 0.1}, 2 * h, zone=[whole]),
    ):
        assert np.abs(other - made).max(axis=0) / np.abs(made).max(axis=0) == pytest.approx(0.0, abs=1e-12)
    if angle == 0.0:
        exact = navier(h, A / 2, B / 2, modifiers)[0]
        assert made[1, 0] == pytest.approx(exact, rel=2e-3)


def test_a_ribbed_slab_is_hubers():
    """Timoshenko and Woinowsky-Krieger 1959, chapter 11: D₁ = 0, and the series of a simply supported plate.

    Ribs 0.4 deep and t = 0.1 wide every a = 1 m under a slab h = 0.1: Dx = E I / a of a rib with its slab,
    Dy = E a h³/12 (a - t + α³ t), Dxy = G h³/12 + C / 2a with the torsional stiffness C of a rib.
    """
    E, nu, h, depth, width, pitch = 30e9, 0.0, 0.1, 0.4, 0.1, 1.0
    slab, rib = pitch * h, width * depth
    middle = (slab * h / 2 + rib * (h + depth / 2)) / (slab + rib)
    inertia = (
        pitch * h**3 / 12 + slab * (middle - h / 2) ** 2 + width * depth**3 / 12 + rib * (h + depth / 2 - middle) ** 2
    )
    G = E / 2 / (1 + nu)
    Dx, Dy = E * inertia / pitch, E * pitch * h**3 / 12 / (pitch - width + (h / (h + depth)) ** 3 * width)
    Dxy = G * h**3 / 12 + G * 0.281 * depth * width**3 / (2 * pitch)
    section = {"Dx": Dx, "Dy": Dy, "D1": 0.0, "Dxy": Dxy, "Sx": 1e4 * Dx, "Sy": 1e4 * Dx}
    model = Model(
        material={"unit_weight": 25e3},
        plate={"shape": "rectangle", "size": [A, B], "thickness": 0.14, "stiffness": section},
        mesh={"divisions": [24, 24]},
        support=[{"edge": ["left", "right", "bottom", "top"], "fix": "hard"}],
        load=[{"self_weight": True}],
    )
    m, n = (np.arange(1, 100, 2)[axis] for axis in (np.s_[:, None], np.s_[None]))
    rigid = Dx * (m / A) ** 4 + 4 * Dxy * (m * n / A / B) ** 2 + Dy * (n / B) ** 4
    sines = np.sin(m * np.pi / 2) * np.sin(n * np.pi / 2)
    exact = 16 * 25e3 * 0.14 / np.pi**6 * (sines / (m * n * rigid)).sum()
    result = signorini.solve(model)["all"]
    assert result.probe([[A / 2, B / 2]])[0].deflection == pytest.approx(exact, rel=1e-3)
    assert sum(result.reactions.values()) == pytest.approx(25e3 * 0.14 * A * B, rel=1e-9)


@pytest.mark.parametrize("element", ["mitc9", "q8r"])
@pytest.mark.parametrize("angle", [0.0, 37.0])
def test_equal_moduli_are_isotropic_at_any_angle_across_steps_too(angle, element):
    def deflection(material):
        model = Model(
            material=material,
            plate={
                "shape": "rectangle",
                "size": [4, 3],
                "thickness": "where(x + 0.4*y < 2.3, 0.2, 0.3)",
                "element": element,
            },
            mesh={"divisions": [8, 6]},
            support=[{"edge": ["left"], "fix": "clamped"}, {"at": [[3.5, 2.5]], "resists": "down"}],
            load=[{"pressure": 1e3}, {"curvature": [1e-4, 2e-4, 3e-4]}],
        )
        return signorini.solve(model)["all"].deflection

    G = 30e9 / 2 / 1.2
    alike = deflection({"Ex": 30e9, "Ey": 30e9, "nu_xy": 0.2, "Gxy": G, "angle": angle})
    isotropic = deflection({"E": 30e9, "nu": 0.2})
    assert alike == pytest.approx(isotropic, abs=1e-10 * np.abs(isotropic).max())
