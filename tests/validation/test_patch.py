"""Patch tests (Irons; MacNeal & Harder 1985, Finite Elements in Analysis and Design 1, 3–20).

The boundary's dofs are prescribed and the inner ones have to find the state. Signs: κ = sym ∇θ, moments sag positive.
"""

import numpy as np
import pytest

from signorini import _core
from signorini.discretise.zones import Rigidity

E, NU, KAPPA = 1e6, 0.25, 5 / 6
RIGIDITY = Rigidity.isotropic(E, NU, KAPPA).for_core
FIVE = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)]
OUTER = [(0.0, 0.0), (0.24, 0.0), (0.24, 0.12), (0.0, 0.12)]
INNER = [(0.04, 0.02), (0.18, 0.03), (0.16, 0.08), (0.08, 0.08)]


class Patch:
    """Corners and cells of four or three of them, with midsides; inner sides bulge by a fraction of their length."""

    def __init__(self, corners, cells, bulge=0.0):
        points, middles, elements, owners = [np.array(c, float) for c in corners], {}, [], {}
        sides = [[frozenset((a, b)) for a, b in zip(cell, (*cell[1:], cell[0]), strict=True)] for cell in cells]
        for side in (side for of_cell in sides for side in of_cell):
            owners[side] = owners.get(side, 0) + 1
        for cell, of_cell in zip(cells, sides, strict=True):
            for side in of_cell:
                if side not in middles:
                    middles[side] = len(points)
                    p, q = points[min(side)], points[max(side)]
                    out = np.array([p[1] - q[1], q[0] - p[0]]) * (bulge if owners[side] == 2 else 0.0)
                    points.append((p + q) / 2 + out)
            middle = [middles[side] for side in of_cell]
            elements.append([*cell, *middle] if len(cell) == 4 else [*cell, cell[2], *middle[:2], cell[2], middle[2]])
        self.points, self.elements = np.array(points), np.array(elements)
        outer = [side for side, count in owners.items() if count == 1]
        self.boundary = sorted({*(node for side in outer for node in side), *(middles[side] for side in outer)})

    def plate(self, element, thickness):
        return _core.Plate(self.points, self.elements, thickness, E, RIGIDITY, element)

    def split(self):
        """Four elements for one, with sides that stay straight."""
        corners, cells = list(self.points), []
        for element in self.elements:
            centre = len(corners)
            corners.append(self.points[element[:4]].mean(axis=0))
            a, b, c, d, ab, bc, cd, da = element
            cells += [(a, ab, centre, da), (ab, b, bc, centre), (centre, bc, c, cd), (da, centre, cd, d)]
        return Patch(corners, cells)


DISTORTED = Patch(OUTER + INNER, FIVE)
CURVED = Patch(OUTER + INNER, FIVE, 0.05)
PARALLELOGRAMS = Patch(
    [(x + 0.6 * y, y + 0.2 * x) for y in (0, 0.05, 0.12) for x in (0, 0.09, 0.15, 0.24)],
    [(4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4) for j in (0, 1) for i in (0, 1, 2)],
)


def scattered(n, part, seed=1, triangles=0.0):
    """n × n cells whose inner corners are moved at random by up to a part of their size; some halved to triangles."""
    random, step = np.random.default_rng(seed), np.array([0.24, 0.12]) / n
    corners = [
        step * (np.array([i, j]) + random.uniform(-part, part, 2) * (0 < i < n and 0 < j < n))
        for j in range(n + 1)
        for i in range(n + 1)
    ]
    first = [j * (n + 1) + i for j in range(n) for i in range(n)]
    cells = []
    for k in first:
        turn = random.integers(4)
        a, b, c, d = np.roll([k, k + 1, k + n + 2, k + n + 1], turn).tolist()
        cells += [(a, b, c), (c, d, a)] if random.random() < triangles else [(a, b, c, d)]
    return Patch(corners, cells)


SCATTERED = scattered(4, 0.2)


def rigidities(thickness):
    return E * thickness**3 / 12 / (1 - NU**2), KAPPA * E * thickness / 2 / (1 + NU)


def curved_by(kx, ky, kxy):
    """Constant curvature without shear: w quadratic, θ = ∇w."""

    def state(points, thickness):
        x, y = points.T
        d, _ = rigidities(thickness)
        dofs = np.column_stack([kx * x * x / 2 + ky * y * y / 2 + kxy * x * y, kx * x + kxy * y, kxy * x + ky * y])
        moment = -d * np.array([kx + NU * ky, ky + NU * kx, (1 - NU) * kxy])
        return dofs, np.broadcast_to([*moment, 0.0, 0.0], (len(points), 5))

    return state


def sheared_along(angle):
    """Constant shear Q in equilibrium with moments that grow linearly: w cubic, θ quadratic along one direction."""

    def state(points, thickness):
        d, s = rigidities(thickness)
        n = np.array([np.cos(angle), np.sin(angle)])
        t, q = points @ n, 1.0
        dofs = np.column_stack([q / s * t - q / d * t**3 / 6, *(-q / d * t**2 / 2 * n[:, None])])
        (c, sn), m = n, q * t
        moments = [m * (c * c + NU * sn * sn), m * (sn * sn + NU * c * c), m * (1 - NU) * c * sn]
        return dofs, np.column_stack([*moments, np.full((len(points), 2), q * n)])

    return state


STATES = {
    "moment x": curved_by(1, 0, 0),
    "moment y": curved_by(0, 1, 0),
    "moment all round": curved_by(1, 1, 0),
    "twist": curved_by(0, 0, 1),
}
SHEARS = {"shear x": sheared_along(0.0), "shear askew": sheared_along(0.7)}


def solve(prescribed, patch, element, thickness, state):
    """Largest errors of deflection, rotation, moment and shear, each over its largest value, Q over M per length."""
    plate = patch.plate(element, thickness)
    wanted, _ = state(patch.points, thickness)
    held = np.zeros(wanted.shape, np.bool_)
    held[patch.boundary] = True
    assert not held.all()
    hi, lo = prescribed(plate, held.ravel(), np.where(held, wanted, 0.0).ravel())
    nodal, stress = plate.stresses(hi, lo, (0, 0, 0), np.zeros(2 * len(patch.elements)))
    quadrilateral, _ = _core.serendipity(_core.section_points(element)[-4:])
    triangle, _ = _core.triangular(_core.section_points("mitc9", True)[-4:])
    values = np.where((patch.elements[:, 2] == patch.elements[:, 3])[:, None, None], triangle, quadrilateral)
    at = np.einsum("egi,eij->egj", values, patch.points[patch.elements]).reshape(-1, 2)
    wanted_stress = state(at, thickness)[1].reshape(stress.shape)
    error, size = np.abs((hi + lo).reshape(-1, 3) - wanted).max(axis=0), np.abs(wanted).max(axis=0)
    nodal_error = np.abs(nodal - state(patch.points, thickness)[1]).max(axis=0)
    moment = np.abs(wanted_stress[..., :3]).max()
    stress_error = np.maximum(np.abs(stress - wanted_stress).max(axis=(0, 1)), nodal_error)
    across = np.ptp(patch.points[:, 0])
    return np.array(
        [
            error[0] / size[0],
            error[1:].max() / size[1:].max(),
            stress_error[:3].max() / moment,
            stress_error[3:].max() * across / moment,
        ]
    )


def after_splits(prescribed, element, thickness, state, splits):
    """Errors on the distorted patch and on its subdivisions."""
    patches = [DISTORTED]
    for _ in range(splits):
        patches.append(patches[-1].split())
    return np.array([solve(prescribed, patch, element, thickness, state) for patch in patches])


@pytest.mark.parametrize("state", STATES | SHEARS)
@pytest.mark.parametrize("thickness", [0.03, 0.01])
@pytest.mark.parametrize("patch", [DISTORTED, SCATTERED], ids=["five", "scattered"])
def test_mitc9_holds_moment_and_shear_on_distorted_patches(prescribed, patch, state, thickness):
    assert solve(prescribed, patch, "mitc9", thickness, (STATES | SHEARS)[state]).max() < 1e-10


@pytest.mark.parametrize("state", STATES | SHEARS)
@pytest.mark.parametrize("thickness", [0.03, 0.01])
@pytest.mark.parametrize("part", [0.2, 0.3])
@pytest.mark.parametrize("triangles", [1.0, 0.5], ids=["triangles", "mixed"])
def test_mitc7_holds_moment_and_shear_alone_and_beside_mitc9(prescribed, triangles, part, thickness, state):
    patch = scattered(4, part, triangles=triangles)
    assert solve(prescribed, patch, "mitc9", thickness, (STATES | SHEARS)[state]).max() < 1e-10


@pytest.mark.parametrize("state", STATES | SHEARS)
@pytest.mark.parametrize("triangles", [1.0, 0.5], ids=["triangles", "mixed"])
def test_thin_triangles_hold_moment(prescribed, triangles, state):
    # As below, at a/h = 2400.
    patch = scattered(4, 0.2, triangles=triangles)
    assert solve(prescribed, patch, "mitc9", 1e-4, (STATES | SHEARS)[state])[:3].max() < 1e-10


@pytest.mark.parametrize("state", STATES | SHEARS)
def test_mitc9_holds_moment_at_the_thickness_of_macneal_and_harder(prescribed, state):
    # The shear is left out: at a/h = 240 the rounding of the prescribed dofs is itself one of 1e-10.
    assert solve(prescribed, DISTORTED, "mitc9", 0.001, (STATES | SHEARS)[state])[:3].max() < 1e-10


@pytest.mark.parametrize("state", STATES | SHEARS)
@pytest.mark.parametrize("thickness", [0.03, 0.01])
@pytest.mark.parametrize("element", ["mitc9", "q8r"])
def test_both_elements_hold_moment_and_shear_on_parallelograms(prescribed, element, thickness, state):
    assert solve(prescribed, PARALLELOGRAMS, element, thickness, (STATES | SHEARS)[state]).max() < 1e-10


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("thickness", [0.03, 0.001])
def test_curved_sides_cost_mitc9_an_error_of_second_order_in_the_bulge(prescribed, state, thickness):
    """On a parabolic side a quadratic w is quartic in the side's parameter, and the ties are exact up to cubics."""
    patches = [Patch(OUTER + INNER, FIVE, bulge) for bulge in (0.05, 0.025, 0.0125)]
    errors = np.array([solve(prescribed, patch, "mitc9", thickness, STATES[state]) for patch in patches])
    assert (errors[0, :3] < [1e-3, 2e-3, 5e-3]).all()
    assert (errors[:-1, :3] / errors[1:, :3] > 3.4).all()


@pytest.mark.parametrize("state", STATES | SHEARS)
def test_q8r_passes_on_general_quadrilaterals_only_in_the_limit(prescribed, state):
    """The weak patch test: serendipity functions lack the complete quadratic unless the element is a parallelogram.

    Its constant moment is then off by up to 23 % in the thick five-element patch; splitting the elements, which makes
    parallelograms of them, mends it.
    """
    errors = after_splits(prescribed, "q8r", 0.03, (STATES | SHEARS)[state], splits=4)
    assert errors[0, 2] > 0.05
    assert (errors[-1, :3] < [2e-6, 1e-6, 4e-5]).all()
    assert (errors[-2, :3] / errors[-1, :3] > [12, 15, 10]).all()
