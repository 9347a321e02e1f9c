"""Rates of convergence on smooth problems whose Mindlin solution is closed.

With any ψ, θ = ∇ψ and w = ψ − (D/S) Δψ solve the Mindlin plate under p = D Δ²ψ. ψ is a sum of plane waves here, so
that derivatives are exact. ``mitc9`` should lose one order of h from deflection to moments and none for thinness
(Bathe, Brezzi & Fortin 1989).
"""

import numpy as np
import pytest
from halving import halved

import signorini
from signorini import _core
from signorini.discretise.quadrature import area_quadrature
from signorini.discretise.zones import Rigidity
from signorini.mesh import Mesh
from signorini.mesh.meshers import rectangle

E, NU, KAPPA = 1.0, 0.3, 5 / 6
RIGIDITY = Rigidity.isotropic(E, NU, KAPPA).for_core
THICKNESSES = (0.1, 1e-2, 1e-3, 1e-4, 1e-5)
SKEW = np.array([[1.0, 0.5], [0.1, 0.8]])
MESHES = (8, 16, 32)
GAUSS = np.array([[s, t] for s in np.polynomial.legendre.leggauss(5)[0] for t in np.polynomial.legendre.leggauss(5)[0]])
GAUSS_WEIGHTS = np.outer(np.polynomial.legendre.leggauss(5)[1], np.polynomial.legendre.leggauss(5)[1]).ravel()
SAMPLES = np.array([[s, t] for t in (-1, 1) for s in (-1, 1)]) / np.sqrt(3)


class Waves:
    """ψ = Σ c cos(k·x + φ)."""

    def __init__(self, amplitudes, wave_vectors, phases):
        self.c, self.k, self.phase = np.array(amplitudes), np.array(wave_vectors), np.array(phases)

    @classmethod
    def product(cls, first, second):
        """(Σ aᵢ sin(kᵢ·x)) (Σ bⱼ sin(lⱼ·x)), each given as pairs of amplitude and wave vector."""
        pairs = [
            (0.5 * sign * a * b, np.subtract(k, sign * np.array(q)))
            for a, k in first
            for b, q in second
            for sign in (1, -1)
        ]
        return cls([c for c, _ in pairs], [k for _, k in pairs], np.zeros(len(pairs)))

    def laplacian(self):
        return Waves(-self.c * (self.k**2).sum(axis=1), self.k, self.phase)

    def __call__(self, points):
        return np.cos(points @ self.k.T + self.phase) @ self.c

    def gradient(self, points):
        return -np.sin(points @ self.k.T + self.phase) @ (self.c[:, None] * self.k)

    def hessian(self, points):
        xx, yy, xy = self.k[:, 0] ** 2, self.k[:, 1] ** 2, self.k[:, 0] * self.k[:, 1]
        return -np.cos(points @ self.k.T + self.phase) @ (self.c[:, None] * np.column_stack([xx, yy, xy]))


class Exact:
    def __init__(self, psi, thickness):
        self.psi, self.lap = psi, psi.laplacian()
        self.d = E * thickness**3 / 12 / (1 - NU**2)
        self.shear = KAPPA * E * thickness / 2 / (1 + NU)
        self.thickness = thickness

    def deflection(self, points):
        return self.psi(points) - self.d / self.shear * self.lap(points)

    def moment(self, points):
        xx, yy, xy = self.psi.hessian(points).T
        return -self.d * np.column_stack([xx + NU * yy, yy + NU * xx, (1 - NU) * xy])

    def pressure(self, points):
        return self.d * self.lap.laplacian()(points)


def at_reference_points(mesh, xi):
    """Shape functions, positions (e, g, 2) and determinants (e, g) of every element at the same reference points."""
    values, slopes = _core.serendipity(xi)
    nodes = mesh.nodes
    jacobian = np.einsum("gia,eib->egab", slopes, nodes)
    return values, np.einsum("gi,eib->egb", values, nodes), np.linalg.det(jacobian)


def errors(mesh, exact, nodal_w, sampled):
    """Relative L2 errors of the deflection, of the moments, and of the moments at the 2 × 2 points alone.

    Between these points the moments are bilinear in each element.
    """
    values, at, det = at_reference_points(mesh, GAUSS)
    weight = det * GAUSS_WEIGHTS
    w = exact.deflection(at.reshape(-1, 2)).reshape(det.shape)
    w_error = (weight * (nodal_w[mesh.elements] @ values.T - w) ** 2).sum() / (weight * w**2).sum()
    m = exact.moment(at.reshape(-1, 2)).reshape(*det.shape, 3)
    s, t = np.sqrt(3) * GAUSS.T
    bilinear = np.column_stack([(1 - s) * (1 - t), (1 + s) * (1 - t), (1 - s) * (1 + t), (1 + s) * (1 + t)]) / 4
    found = np.einsum("gp,epm->egm", bilinear, sampled[..., :3])
    m_error = (weight * ((found - m) ** 2).sum(axis=2)).sum() / (weight * (m**2).sum(axis=2)).sum()
    _, at, det = at_reference_points(mesh, SAMPLES)
    m = exact.moment(at.reshape(-1, 2)).reshape(*det.shape, 3)
    at_points = (det * ((sampled[..., :3] - m) ** 2).sum(axis=2)).sum() / (det * (m**2).sum(axis=2)).sum()
    return np.sqrt([w_error, m_error, at_points])


def rates(found):
    found = np.array(found)
    return np.log2(found[:-1] / found[1:])


def sin_cubed(k):
    return [(0.75, k), (-0.25, 3 * np.array(k))]


def rectangles(n):
    return rectangle((0.0, 0.0), (1.0, 1.0), (n, n))


def placed(mesh, points):
    return Mesh(points, mesh.elements, mesh.edges)


def parallelograms(n):
    mesh = rectangles(n)
    return placed(mesh, mesh.points @ SKEW.T)


def scattered(n, seed=1):
    """Inner corners moved at random by up to 20 % of the element size, each mesh anew; sides are straight."""
    mesh, random = rectangles(n), np.random.default_rng(seed)
    points = mesh.points.copy()
    corners = np.unique(mesh.elements[:, :4])
    inner = corners[((points[corners] > 1e-9) & (points[corners] < 1 - 1e-9)).all(axis=1)]
    points[inner] += random.uniform(-0.2, 0.2, (len(inner), 2)) / n
    for a, b, middle in mesh.sides[..., [0, 2, 1]].reshape(-1, 3):
        points[middle] = (points[a] + points[b]) / 2
    return placed(mesh, points)


def subdivided(n):
    """The scattered mesh of 4 × 4, each element split evenly: its parts tend to parallelograms."""
    mesh, coarse = rectangles(n), rectangles(4)
    where = coarse.locate(mesh.points)
    return placed(mesh, scattered(4).map(where.elements, where.xi))


def clamped_errors(prescribed, element, thickness, mesh, edges=None):
    """Errors with sin³(πs) sin³(πt) for ψ, so that w and θ vanish on the edges s, t = 0, 1 at every thickness."""
    s, t = np.pi * np.linalg.inv(np.eye(2) if edges is None else edges)
    exact = Exact(Waves.product(sin_cubed(s), sin_cubed(t)), thickness)
    plate = _core.Plate(mesh.points, mesh.elements, thickness, E, RIGIDITY, element)
    values, at, det = at_reference_points(mesh, GAUSS)
    force = det * GAUSS_WEIGHTS * exact.pressure(at.reshape(-1, 2)).reshape(det.shape)
    load = np.zeros((mesh.node_count, 3))
    np.add.at(load[:, 0], mesh.elements, force @ values)
    held = np.zeros((mesh.node_count, 3), np.bool_)
    held[np.unique(mesh.boundary)] = True
    hi, lo = prescribed(plate, held.ravel(), np.zeros(plate.dof_count), load.ravel())
    _, sampled = plate.stresses(hi, lo, (0, 0, 0), np.zeros(2 * len(mesh.elements)))
    return errors(mesh, exact, (hi + lo)[::3], sampled)


def hard_errors(element, thickness, n):
    exact = Exact(Waves.product([(1.0, (np.pi, 0.0))], [(1.0, (0.0, np.pi))]), thickness)
    factor = exact.d * 4 * np.pi**4
    model = signorini.Model(
        material={"E": E, "nu": NU},
        plate={"shape": "rectangle", "size": [1, 1], "thickness": thickness, "element": element},
        mesh={"divisions": [n, n]},
        support=[{"edge": ["left", "right", "bottom", "top"], "fix": "hard"}],
        load=[{"pressure": f"{factor!r}*sin(pi*x)*sin(pi*y)"}],
    )
    result = signorini.solve(model)["all"]
    values, _, _ = at_reference_points(result.mesh, SAMPLES)
    nodal = np.column_stack([result.moment, result.shear])
    sampled = np.einsum("gi,eif->egf", values, nodal[result.mesh.elements])
    return errors(result.mesh, exact, result.deflection, sampled)


@pytest.mark.parametrize("thickness", THICKNESSES)
def test_mitc9_on_the_hard_square_under_a_sine(thickness):
    """Navier's term with the shear deflection, from an input like a user's."""
    found = rates([hard_errors("mitc9", thickness, n) for n in MESHES])[-1]
    assert found[0] == pytest.approx(3.1, abs=0.1)
    assert found[1] == pytest.approx(2.0, abs=0.05)
    assert found[2] > 2.8


@pytest.mark.parametrize("thickness", THICKNESSES)
@pytest.mark.parametrize(
    ("mesher", "edges"),
    [(rectangles, None), (parallelograms, SKEW), (subdivided, None)],
    ids=lambda m: getattr(m, "__name__", ""),
)
def test_mitc9_clamped_on_affine_meshes(prescribed, mesher, edges, thickness):
    """Orders 3 and 2, and 3 for moments at the 2 × 2 points, at any h/a; so too where elements tend to affine."""
    found = rates([clamped_errors(prescribed, "mitc9", thickness, mesher(n), edges) for n in MESHES])[-1]
    assert found[0] == pytest.approx(3.07, abs=0.1)
    assert found[1] == pytest.approx(2.1, abs=0.12)
    assert found[2] > 2.75


@pytest.mark.parametrize("mesher", [rectangles, subdivided, scattered])
def test_thinness_costs_mitc9_nothing(prescribed, mesher):
    coarse = [clamped_errors(prescribed, "mitc9", thickness, mesher(16)) for thickness in THICKNESSES]
    assert coarse[2:] == pytest.approx(np.tile(coarse[-1], (3, 1)), rel=2e-3)
    assert (np.array(coarse) < 1.3 * np.array(coarse[0])).all()


@pytest.mark.parametrize("thickness", [0.1, 1e-3, 1e-5])
def test_mitc9_on_meshes_scattered_anew(prescribed, thickness):
    """Where quadrilaterals stay general: orders of 2.2 in deflection and 2 in moments, again for any h/a."""
    found = np.array([clamped_errors(prescribed, "mitc9", thickness, scattered(n)) for n in (16, 32, 64)])
    assert (rates(found)[-1] > [2.1, 1.9, 1.9]).all()
    assert (found[1, :2] < [1.5e-4, 4.1e-3]).all()


def clamped_errors_at_nodes(prescribed, thickness, mesh):
    """Relative L2 errors of the deflection, and of the moments carried to the nodes, at the points of a fine rule."""
    s, t = np.pi * np.eye(2)
    exact = Exact(Waves.product(sin_cubed(s), sin_cubed(t)), thickness)
    plate = _core.Plate(mesh.points, mesh.elements, thickness, E, RIGIDITY, "mitc9")
    over = area_quadrature(mesh, order=5)
    values, nodes = mesh.shape_functions(over.elements, over.xi), mesh.elements[over.elements]
    load = np.zeros((mesh.node_count, 3))
    np.add.at(load[:, 0], nodes, (over.weights * exact.pressure(over.positions))[:, None] * values)
    held = np.zeros((mesh.node_count, 3), np.bool_)
    held[np.unique(mesh.boundary)] = True
    hi, lo = prescribed(plate, held.ravel(), np.zeros(plate.dof_count), load.ravel())
    nodal, _ = plate.stresses(hi, lo, (0, 0, 0), np.zeros(2 * len(mesh.elements)))
    found = np.einsum("qi,qif->qf", values, np.column_stack([(hi + lo)[::3], nodal[:, :3]])[nodes])
    wanted = np.column_stack([exact.deflection(over.positions), exact.moment(over.positions)])
    miss, size = (over.weights @ square for square in ((found - wanted) ** 2, wanted**2))
    return np.sqrt([miss[0] / size[0], miss[1:].sum() / size[1:].sum()])


@pytest.mark.parametrize("part", [0.5, 1.0], ids=["mixed", "triangles"])
def test_triangles_converge_alike_at_any_thickness(prescribed, part):
    """Orders 3 of the deflection and 2 of the moments on triangles; beside scattered quadrilaterals as theirs."""
    found = {
        thickness: [clamped_errors_at_nodes(prescribed, thickness, halved(scattered(n), part)) for n in (8, 16, 32)]
        for thickness in (0.1, 1e-3, 1e-5)
    }
    assert np.array(found[1e-3]) == pytest.approx(np.array(found[1e-5]), rel=2e-2)
    for errors in found.values():
        assert (rates(errors)[-1] > [2.2, 1.7]).all()


@pytest.mark.parametrize("mesher", [rectangles, subdivided, scattered])
def test_q8r_of_a_thick_plate(prescribed, mesher):
    """The same orders without locking, at h/a = 0.2, scattered meshes included."""
    found = rates([clamped_errors(prescribed, "q8r", 0.2, mesher(n)) for n in MESHES])[-1]
    assert found[0] == pytest.approx(3.0, abs=0.05)
    assert found[1] == pytest.approx(2.0, abs=0.06)


def test_q8r_locks_in_thin_clamped_plates_and_mitc9_does_not(square):
    """Ratio to the exact centre deflection on 8 × 8 elements, a known limit of the paper's element."""
    exact = {0.1: 0.00150463, 0.01: 0.00126786, 0.001: 0.00126534, 0.0001: 0.00126532}

    def ratios(element):
        found = [(square({"fix": "clamped"}, h, 4, element), w) for h, w in exact.items()]
        return [result.deflection.max() * d / w for (result, d), w in found]

    assert ratios("q8r") == pytest.approx([1.000, 0.993, 0.66, 0.10], abs=5e-3)
    assert ratios("mitc9") == pytest.approx([1.0003, 1.0005, 1.0006, 1.0006], abs=6e-5)
