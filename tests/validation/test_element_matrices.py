"""Element matrices against a second derivation, dense and slow, straight from the energy.

½∫κᵀ D_b κ + ½∫ S |∇w − θ|² on shape functions fitted to monomials; the tying conditions of MITC9 as Bathe, Brezzi &
Fortin (1989), Int. J. Num. Meth. Eng. 28, 1787–1801, write them, but with means over the quadrilateral, solved as
linear equations.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import block_diag
from scipy.sparse import csc_array

from signorini import _core
from signorini.discretise.zones import Rigidity
from signorini.mesh.isoparametric import determinants

E, NU, KAPPA = 3.0, 0.27, 5 / 6
RIGIDITY = Rigidity.isotropic(E, NU, KAPPA).for_core
NODES = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0], [0, 0]], float)
SERENDIPITY = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (2, 1), (1, 2)]
LAGRANGE = [(i, j) for i in range(3) for j in range(3)]
SHEAR = {0: [(0, 0), (1, 0), (0, 1), (1, 1), (0, 2)], 1: [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0)]}
ELEMENTS = ["mitc9", "q8r"]


def monomials(powers, at, derivative=None):
    values = []
    for power in powers:
        terms = [at[a] ** power[a] for a in (0, 1)]
        if derivative is not None:
            k = power[derivative]
            terms[derivative] = k * at[derivative] ** (k - 1) if k else 0.0
        values.append(terms[0] * terms[1])
    return np.array(values)


def shape(powers, at):
    """Values and reference gradients of the functions that are 1 at one node and 0 at the others."""
    fit = np.linalg.inv([monomials(powers, node) for node in NODES[: len(powers)]])
    return monomials(powers, at) @ fit, np.array([monomials(powers, at, a) @ fit for a in (0, 1)])


def points(order):
    x, weights = np.polynomial.legendre.leggauss(order)
    return [((a, b), u * v) for a, u in zip(x, weights, strict=True) for b, v in zip(x, weights, strict=True)]


def covariant(element, nodes, at):
    """∇w − θ along ξ and η: rows (2, 26)."""
    _, slope = shape(SERENDIPITY, at)
    tangents = slope @ nodes
    rotation = np.zeros(9)
    if element == "mitc9":
        rotation = shape(LAGRANGE, at)[0]
    else:
        rotation[:8] = shape(SERENDIPITY, at)[0]
    rows = np.zeros((2, 26))
    rows[:, 0:24:3] = slope
    for part in (0, 1):
        rows[:, [*range(1 + part, 24, 3), 24 + part]] = -tangents[:, part, None] * rotation
    return rows


def tied(nodes, at):
    """Covariant shear of MITC9 at a point, rows (2, 26).

    The polynomials with the eight tied values on the sides and the two means of the physical shear over the
    quadrilateral of the corners.
    """
    g = 1 / np.sqrt(3)
    none = np.zeros(5)
    conditions, values = [], []
    for a in (0, 1):
        for tie in [(s, t) if a == 0 else (t, s) for t in (-1, 1) for s in (-g, g)]:
            conditions.append(np.roll(np.append(monomials(SHEAR[a], tie), none), 5 * a))
            values.append(covariant("mitc9", nodes, tie)[a])
    means, physical = np.zeros((2, 10)), np.zeros((2, 26))
    for p, weight in points(3):
        jacobian = shape([(0, 0), (1, 0), (0, 1), (1, 1)], p)[1] @ nodes[:4]
        to_physical = weight * np.linalg.det(jacobian) * np.linalg.inv(jacobian)
        means += to_physical @ block_diag(monomials(SHEAR[0], p), monomials(SHEAR[1], p))
        physical += to_physical @ covariant("mitc9", nodes, p)
    coefficients = np.linalg.solve([*conditions, *means], [*values, *physical])
    return block_diag(monomials(SHEAR[0], at), monomials(SHEAR[1], at)) @ coefficients


def strains(element, nodes, at):
    """[κxx, κyy, 2κxy, γx, γy] over 24 nodal dofs and two centre rotations, and the Jacobian's determinant."""
    jacobian = shape(SERENDIPITY, at)[1] @ nodes
    powers = LAGRANGE if element == "mitc9" else SERENDIPITY
    gradient = np.zeros((2, 9))
    gradient[:, : len(powers)] = np.linalg.solve(jacobian, shape(powers, at)[1])
    rows = np.zeros((5, 26))
    first, second = [*range(1, 24, 3), 24], [*range(2, 24, 3), 25]
    rows[0, first], rows[1, second] = gradient
    rows[2, first], rows[2, second] = gradient[1], gradient[0]
    shear = tied(nodes, at) if element == "mitc9" else covariant(element, nodes, at)
    rows[3:] = np.linalg.solve(jacobian, shear)
    return rows, np.linalg.det(jacobian)


def full_matrix(element, nodes, thickness):
    matrix = np.zeros((26, 26))
    for at, weight in points(3 if element == "mitc9" else 2):
        h = shape(SERENDIPITY, at)[0] @ thickness
        bending = E * h**3 / 12 / (1 - NU**2) * np.array([[1, NU, 0], [NU, 1, 0], [0, 0, (1 - NU) / 2]])
        elasticity = np.zeros((5, 5))
        elasticity[:3, :3] = bending
        elasticity[3:, 3:] = KAPPA * E / 2 / (1 + NU) * h * np.eye(2)
        rows, determinant = strains(element, nodes, at)
        matrix += weight * determinant * rows.T @ elasticity @ rows
    return matrix


def condensed(element, nodes, thickness):
    full = full_matrix(element, nodes, thickness)
    if element == "q8r":
        return full[:24, :24]
    return full[:24, :24] - full[:24, 24:] @ np.linalg.solve(full[24:, 24:], full[24:, :24])


def core_plate(element, nodes, thickness):
    at_points = np.array([[shape(SERENDIPITY, at)[0] @ thickness for at in _core.section_points(element)]])
    return _core.Plate(nodes, np.arange(8)[None], at_points, E, RIGIDITY, element)


def core_matrix(element, nodes, thickness):
    matrix = np.zeros((24, 24))
    matrix[np.tril_indices(24)] = core_plate(element, nodes, thickness).element_stiffness()[0]
    return matrix + np.tril(matrix, -1).T


@st.composite
def shapes(draw):
    """Quadrilaterals with curved sides: the reference square, every node moved, turned, stretched and shifted."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    nodes = NODES[:8] + random.uniform(-0.18, 0.18, (8, 2))
    angle = random.uniform(0, 2 * np.pi)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return (nodes * [random.uniform(0.3, 1), 1]) @ turn.T + random.uniform(-3, 3, 2)


@pytest.mark.parametrize("element", ELEMENTS)
@settings(max_examples=25, deadline=None)
@given(nodes=shapes(), log_thickness=st.floats(-3, 0), taper=st.floats(0, 0.3))
def test_element_matrix_is_the_one_derived_from_the_energy(element, nodes, log_thickness, taper):
    thickness = 10**log_thickness * (1 + taper * NODES[:8, 0])
    expected = condensed(element, nodes, thickness)
    assert core_matrix(element, nodes, thickness) == pytest.approx(expected, rel=0, abs=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize(("element", "modes"), [("mitc9", 3), ("q8r", 4)])
@settings(max_examples=50, deadline=None)
@given(nodes=shapes(), log_thickness=st.floats(-1.5, 0))
def test_a_free_element_has_three_zero_energy_modes_and_q8r_one_more(element, modes, nodes, log_thickness):
    values = np.linalg.eigvalsh(core_matrix(element, nodes, np.full(8, 10**log_thickness)))
    assert (np.abs(values) < 1e-12 * values[-1]).sum() == modes
    assert values[modes] > 1e-8 * values[-1]


COLLAPSED = np.array([[0, 0, 1, 2, 0, 3, 4, 5]])


@st.composite
def collapsed_shapes(draw):
    """Quadrilaterals with curved sides, the first one collapsed: nodes (6, 2) in the order of `COLLAPSED`."""
    nodes = draw(shapes())
    return np.vstack([nodes[4], nodes[[2, 3]], 0.5 * (nodes[4] + nodes[2]), nodes[6], 0.5 * (nodes[4] + nodes[3])])


@settings(max_examples=25, deadline=None)
@given(nodes=collapsed_shapes(), log_thickness=st.floats(-1.5, 0))
def test_a_collapsed_quadrilateral_is_one_with_three_nodes_at_one_place(nodes, log_thickness):
    """Its matrix is that of the eight functions; K sums the entries of the three coincident nodes and has no mechanism.

    The hourglass mode of one quadrilateral alone separates its three nodes.
    """
    thickness = 10**log_thickness
    plate = _core.Plate(nodes, COLLAPSED, thickness, E, RIGIDITY, "q8r")
    expected = condensed("q8r", nodes[COLLAPSED[0]], np.full(8, thickness))
    lower = np.zeros((24, 24))
    lower[np.tril_indices(24)] = plate.element_stiffness()[0]
    assert lower + np.tril(lower, -1).T == pytest.approx(expected, rel=0, abs=1e-12 * np.abs(expected).max())
    onto = np.kron(np.eye(6)[COLLAPSED[0]], np.eye(3))
    none = (np.zeros(0, np.int64), np.zeros((0, 24)), np.zeros(0, np.int64), np.zeros(0), np.zeros(0))
    starts, rows, entries = plate.stiffness_matrix(none)
    summed = csc_array((entries, rows, starts), shape=(18, 18)).toarray()
    summed += np.tril(summed, -1).T
    assert summed == pytest.approx(onto.T @ expected @ onto, rel=0, abs=1e-12 * np.abs(expected).max())
    values = np.linalg.eigvalsh(summed)
    assert (np.abs(values) < 1e-12 * values[-1]).sum() == 3
    assert values[3] > 1e-8 * values[-1]


@settings(max_examples=25, deadline=None)
@given(nodes=collapsed_shapes(), state=st.tuples(*[st.floats(-1, 1)] * 5))
def test_a_collapsed_quadrilateral_has_any_constant_curvature_and_any_constant_shear(nodes, state):
    """Linear rotations and a linear deflection are reproduced at every Gauss point, whatever the shape."""
    xx, yy, xy, *slope = state
    plate = _core.Plate(nodes, COLLAPSED, 0.1, E, RIGIDITY, "q8r")
    bend = 0.1**3 / 12 * E / (1 - NU**2)
    moment = [-bend * (xx + NU * yy), -bend * (yy + NU * xx), -bend * (1 - NU) * xy]
    rotations = nodes @ np.array([[xx, xy], [xy, yy]])
    _, sampled = plate.stresses(np.column_stack([np.zeros(6), rotations]).ravel(), np.zeros(18), (0, 0, 0), np.zeros(2))
    assert sampled[0, :, :3] == pytest.approx(np.tile(moment, (4, 1)), abs=1e-12)
    nodal, sampled = plate.stresses(
        np.column_stack([nodes @ slope, np.zeros((6, 2))]).ravel(), np.zeros(18), (0, 0, 0), np.zeros(2)
    )
    shear = KAPPA * E / 2 / (1 + NU) * 0.1 * np.array(slope)
    assert sampled[0, :, 3:] == pytest.approx(np.tile(shear, (4, 1)), abs=1e-12)
    assert nodal[:, 3:] == pytest.approx(np.tile(shear, (6, 1)), abs=1e-12)


def free_triangle(nodes, thickness):
    """Matrix (18, 18) of a triangle of nodes (6, 2), corners and midsides."""
    plate = _core.Plate(nodes, np.array([[0, 1, 2, 2, 3, 4, 2, 5]]), thickness, E, RIGIDITY, "mitc9")
    matrix = np.zeros((24, 24))
    matrix[np.tril_indices(24)] = plate.element_stiffness()[0]
    own = np.delete(np.arange(24), [9, 10, 11, 18, 19, 20])
    assert not np.delete(matrix, own, axis=0).any()
    matrix = matrix[np.ix_(own, own)]
    return matrix + np.tril(matrix, -1).T


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_a_free_triangle_has_three_zero_energy_modes_and_the_next_does_not_know_its_thickness(seed):
    corners = np.array([[0, 0], [1, 0], [0.5, 0.9]])
    nodes = np.vstack([corners, 0.5 * (corners + np.roll(corners, -1, axis=0))])
    nodes += np.random.default_rng(seed).uniform(-0.08, 0.08, (6, 2))
    nodes /= np.ptp(nodes, axis=0).max()
    least = []
    for thickness in (0.1, 0.01, 0.001):
        values = np.linalg.eigvalsh(free_triangle(nodes, thickness))
        assert np.abs(values[:3]).max() < 1e-13 * values[-1]
        least.append(values[3] / thickness**3)
    assert least[0] > 0.004 * E and max(least) < 3 * min(least)


@pytest.mark.parametrize("element", ELEMENTS)
@settings(max_examples=25, deadline=None)
@given(nodes=shapes(), log_thickness=st.floats(-4, 0), motion=st.tuples(*[st.floats(-1, 1)] * 3))
def test_rigid_motions_leave_no_force(element, nodes, log_thickness, motion):
    plate = core_plate(element, nodes, np.full(8, 10**log_thickness))
    w, x, y = motion
    rigid = np.column_stack([w + nodes @ [x, y], np.full(8, x), np.full(8, y)]).ravel()
    nothing = (np.zeros(0, np.int64), np.zeros((0, 24)), np.zeros(0, np.int64), np.zeros(0), np.zeros(0))
    force = plate.residual(nothing, np.zeros(24), rigid, np.zeros(24))
    # The rest of a thin element's shear is in springs beside its matrix.
    largest = max(plate.element_stiffness().max(), E * 10**log_thickness)
    assert np.abs(force).max() <= 1e-14 * largest * max(np.abs(rigid).max(), 1e-300)


def edge_forces(nodes, traction):
    """∮ N q·n ds over the four parabolic sides, with N along a side the parabolas through its three nodes."""
    force = np.zeros(8)
    for a, b, middle in ((0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7)):
        side = [a, middle, b]
        for s, weight in zip(*np.polynomial.legendre.leggauss(3), strict=True):
            values = np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2])
            dx, dy = np.array([s - 0.5, -2 * s, s + 0.5]) @ nodes[side]
            force[side] += weight * values * (traction @ [dy, -dx])
    return force


@pytest.mark.parametrize("element", ELEMENTS)
@settings(max_examples=25, deadline=None)
@given(nodes=shapes(), slope=st.tuples(st.floats(-1, 1), st.floats(-1, 1)), rotation=st.tuples(*[st.floats(-1, 1)] * 2))
def test_constant_shear_between_held_rotations_is_exact_on_any_shape(element, nodes, slope, rotation):
    """The shear patch test of Bathe, Brezzi & Fortin: w linear, every rotation held at one value, the centre's too.

    Each element answers with the constant shear everywhere and with nodal forces that depend on its sides alone, so
    that in any patch those of neighbours cancel.
    """
    thickness = np.full(8, 0.1)
    shear = KAPPA * E / 2 / (1 + NU) * 0.1 * (np.array(slope) - rotation)
    nodal = np.column_stack([nodes @ slope, np.tile(rotation, (8, 1))]).ravel()
    couples = np.zeros(2)
    if element == "mitc9":
        couples = full_matrix(element, nodes, thickness)[24:] @ [*nodal, *rotation]
    plate = core_plate(element, nodes, thickness)
    _, sampled = plate.stresses(nodal, np.zeros(24), (0, 0, 0), couples)
    assert sampled[0, :, 3:] == pytest.approx(np.tile(shear, (4, 1)), abs=1e-12)
    assert sampled[0, :, :3] == pytest.approx(np.zeros((4, 3)), abs=1e-12)
    force = core_matrix(element, nodes, thickness) @ nodal
    for part in (0, 1):
        row, _ = plate.interpolation_rows(np.zeros(1, np.int64), np.zeros((1, 2)), 1 + part)
        force -= row[0] * couples[part]
    assert force[::3] == pytest.approx(edge_forces(nodes, shear), abs=1e-12)


@pytest.mark.parametrize("element", ["mitc9", "mitc7", "q8r"])
def test_stresses_and_strains_at_the_points_of_the_stiffness_are_the_nodal_forces(element):
    """∫ Bᵀσ = Ku − ∫ BᵀDκ⁰, with frames, for a thickness that varies."""
    random = np.random.default_rng(4)
    kind, triangle = "mitc9" if element == "mitc7" else element, element == "mitc7"
    at = np.array([[0, 0], [3, 0.2], [2.7, 2], [0.1, 1.6]], float)[: 3 if triangle else 4]
    points = np.vstack([at, 0.5 * (at + np.roll(at, -1, axis=0))])
    nodes = np.array([[0, 1, 2, 2, 3, 4, 2, 5]]) if triangle else np.arange(8)[None]
    stations = _core.section_points(kind, triangle)
    count = 4 if element == "q8r" else 9
    thickness = 0.2 + 0.1 * random.random((1, len(stations)))
    angles = random.uniform(0, 1, len(points))
    frames = np.column_stack([np.cos(angles), np.sin(angles)])
    plate = _core.Plate(points, nodes, thickness, E, RIGIDITY, kind, frames)
    u = random.normal(size=3 * len(points))
    forces, stress = plate.element_forces(np.array([0]), u, np.zeros_like(u), (0.1, -0.2, 0.3), np.zeros(2))
    rows = plate.strain_rows(np.array([0])).reshape(count, 5, 24)
    line = {3: [5 / 9, 8 / 9, 5 / 9], 2: [1.0, 1.0]}[round(count**0.5)]
    root = 15**0.5
    light, heavy = (155 - root) / 2400, (155 + root) / 2400
    weights = np.array([0.1125, *3 * [light], *3 * [heavy], 0, 0]) if triangle else np.outer(line, line).ravel()
    weights = weights * determinants(points[nodes], stations[:count], triangle)[0]
    work = np.einsum("p,ps,psd->d", weights, stress[0] * [-1, -1, -1, 1, 1], rows)
    dofs = (3 * nodes[0][:, None] + np.arange(3)).ravel()
    found = [np.bincount(dofs, values, len(u)) for values in (work, forces[0])]
    assert found[0] == pytest.approx(found[1], abs=1e-12 * np.abs(found[1]).max())
