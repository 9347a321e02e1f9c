"""Plates on supports that hold one way only, against closed forms and independent programs."""

from fractions import Fraction

import numpy as np
import pytest
from models import rectangular
from tensionless import THICK_SQUARE, THIN_SQUARE

import signorini

# MITC4, 160 × 160, another program; kN, rows from y = 0.5.
SLAB_B = np.array(
    [[333.96, 93.67, 0, 5.85], [93.67, 71.92, 7.92, 14.01], [0, 7.92, 21.46, 11.79], [5.85, 14.01, 11.79, 6.17]]
)
# Ours on 80 × 80.
SLAB_B_MITC9 = np.array(
    [
        [333.965, 93.663, 0, 5.852],
        [93.663, 71.945, 7.907, 14.016],
        [0, 7.907, 21.476, 11.786],
        [5.852, 14.016, 11.786, 6.169],
    ]
)


def rigid_on_springs(stiffness, positions, force, moment):
    """Deflections at y = 0 and y = 2 of a rigid beam on one-sided springs, and which of them touch; exact."""
    closed = set(range(len(positions)))
    while True:
        k0 = sum(stiffness[i] for i in closed)
        k1 = sum(stiffness[i] * positions[i] for i in closed)
        k2 = sum(stiffness[i] * positions[i] ** 2 for i in closed)
        a = (force * k2 - moment * k1) / (k0 * k2 - k1 * k1)
        b = (moment * k0 - force * k1) / (k0 * k2 - k1 * k1)
        now = {i for i, y in enumerate(positions) if a + b * y > 0}
        if now == closed:
            return a, a + 2 * b, closed
        closed = now


def near_rigid(support, young, divisions):
    model = rectangular(
        material={"E": young, "nu": 0.3},
        size=[1, 2],
        thickness=0.3,
        divisions=divisions,
        support=support,
        load=[{"pressure": "5*(y-2)**2"}],
        probe=[{"at": [[0.5, 0], [0.5, 2]]}],
    )
    return signorini.solve(model)["all"]


class TestSSNL130:
    """Code_Aster SSNL130 (V6.02.130): near-rigid plate 1 m × 2 m × 0.30 m on unilateral springs, p = 5(y − 2)²."""

    LINES = tuple(Fraction(i, 8) for i in range(17))
    STIFFNESS = tuple(Fraction(10**4, 16) / (2 if i in (0, 16) else 1) for i in range(17))

    def lines(self):
        return [
            {"line": [[0, float(y)], [1, float(y)]], "resists": "down", "stiffness": float(k)}
            for y, k in zip(self.LINES, self.STIFFNESS, strict=True)
        ]

    def test_the_rigid_plate_on_17_lines(self):
        near, far, closed = rigid_on_springs(self.STIFFNESS, self.LINES, Fraction(40, 3), Fraction(20, 3))
        assert (near, far, closed) == (Fraction(208, 58875), Fraction(-176, 153075), set(range(13)))

    @pytest.mark.parametrize("divisions", [[1, 16], [2, 32]])
    def test_discrete(self, divisions):
        """Lines of springs y = i/8. The plate's bending is 1.3e-7 of it with the source's E, proportional to 1/E."""
        exact = np.array([208 / 58875, -176 / 153075])
        for young, bound in ((2e11, 1.5e-7), (2e13, 1.5e-9)):
            result = near_rigid(self.lines(), young, divisions)
            assert [probe.deflection for probe in result.probes] == pytest.approx(exact, rel=bound)
            states = [(support.closed.all(), support.closed.any()) for support in result.supports]
            assert states == [(True, True)] * 13 + [(False, False)] * 4
            assert sum(result.reactions.values()) == pytest.approx(40 / 3, rel=1e-12)

    def test_continuous(self):
        soil = [{"area": "all", "resists": "down", "stiffness": 5e3}]
        result = near_rigid(soil, 2e11, [1, 16])
        assert [probe.deflection for probe in result.probes] == pytest.approx([4 / 1125, -4 / 3375], rel=1e-6)
        # The plate bends a little: the edge of contact moves by less than its deflection, 1e-7, does.
        assert result.supports[0].contact_area == pytest.approx(1.5, rel=1e-7)


@pytest.mark.parametrize(
    ("case", "contact"), [(THICK_SQUARE, (0.303, 0.308)), (THIN_SQUARE, (0.2475, 0.2525))], ids=["thick", "thin"]
)
def test_square_on_rigid_one_sided_edges(case, contact):
    """Uniform load, edges that only push up; a high-order spectral Mindlin solver. Quarter plate."""
    errors = []
    for n in (10, 20, 40):
        result = signorini.solve(case.model(n))["all"]
        errors.append(list(case.errors(result).values()))
        edges = result.supports[0]
        for along, across in ((0, 1), (1, 0)):
            side = np.abs(edges.positions[:, across] - 0.5) < 1e-12
            closed = np.sort(edges.positions[side & edges.closed, along])
            opened = np.sort(edges.positions[side & ~edges.closed, along])
            assert closed[-1] < opened[0]
            assert contact[0] - 0.5 / n <= closed[-1] <= contact[1] + 0.5 / n
        assert edges.reaction == pytest.approx(0.25, rel=1e-9)
        assert (edges.reactions >= 0).all()
    errors = np.array(errors)
    assert (errors[-1] < [5e-4, 5e-4, 1e-3]).all()
    assert (errors[-1] < np.maximum(0.5 * errors[0], 1e-4)).all()


def slab_b(n, gap=0.0):
    at = [[x, y] for y in (0.5, 3.5, 6.5, 9.5) for x in (0.5, 3.5, 6.5, 9.5)]
    model = rectangular(
        size=[10, 10],
        thickness=0.3,
        divisions=[n, n],
        support=[{"name": "points", "at": at, "resists": "down", "gap": gap}],
        load=[{"pressure": 2e3}, {"pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}}],
    )
    return signorini.solve(model)["all"]


@pytest.fixture(scope="module")
def slabs():
    return {n: slab_b(n) for n in (40, 80)}


class TestSlabB:
    """10 m slab on 16 rigid points that only push.

    Rigid points indent a Mindlin plate by ln(1/element size), so reactions drift slowly with the mesh: by up to 0.15 kN
    from 40 to 80 and on to 120 elements a side; MITC4 on 160 × 160 is where mitc9 is on 80 × 80.
    """

    @pytest.mark.parametrize("n", [40, 80])
    def test_exactly_two_lift(self, slabs, n):
        points = slabs[n].supports[0]
        assert points.positions[~points.closed].tolist() == [[6.5, 0.5], [0.5, 6.5]]
        assert points.reaction == pytest.approx(700e3, rel=1e-11)

    def test_reactions(self, slabs):
        coarse, fine = (slabs[n].supports[0].reactions.reshape(4, 4) / 1e3 for n in (40, 80))
        assert fine == pytest.approx(SLAB_B, rel=1e-2)
        assert fine == pytest.approx(SLAB_B_MITC9, abs=1e-3)
        assert coarse == pytest.approx(SLAB_B, abs=1e-3 * SLAB_B.max())
        assert np.abs(fine - SLAB_B).max() < 0.1 * np.abs(coarse - SLAB_B).max()

    @pytest.mark.parametrize("n", [40, 80])
    def test_a_gap_everywhere_lowers_it_and_changes_nothing_else(self, slabs, n):
        lowered = slab_b(n, gap=1e-3)
        assert lowered.supports[0].reactions == pytest.approx(slabs[n].supports[0].reactions, abs=1e-6)
        assert lowered.deflection - 1e-3 == pytest.approx(slabs[n].deflection, abs=1e-15)
        assert (lowered.supports[0].closed == slabs[n].supports[0].closed).all()


def thin(support, thickness, n):
    """The whole unit square on n × n elements: centre deflection times D, its result."""
    model = rectangular(
        material={"E": 1.0, "nu": 0.3},
        size=[1, 1],
        thickness=thickness,
        divisions=[n, n],
        support=[{"name": "edges", "edge": ["left", "right", "bottom", "top"], **support}],
        load=[{"pressure": 1.0}],
        probe=[{"at": [0.5, 0.5]}],
    )
    result = signorini.solve(model)["all"]
    return result.probes[0].deflection * thickness**3 / 12 / (1 - 0.3**2), result


class TestThinPlates:
    """Up to 231,363 dofs, h/a from 1e-3 to 1e-5: the refined residual recovers digits that double precision loses."""

    def check(self, result, thickness):
        assert result.reactions["edges"] == pytest.approx(1.0, abs=1e-10)
        certificate = result.certificate
        assert certificate.passed and not certificate.limited
        # At h/a = 1e-5 it is rounding that decides about a few points at the edge of contact.
        signs = 1e-12 if thickness > 1e-5 else 1e-9
        assert max(certificate.penetration, certificate.tension, certificate.complementarity) < signs

    def test_clamped(self):
        for thickness, n in ((1e-3, 80), (1e-5, 160)):
            deflection, result = thin({"fix": "clamped"}, thickness, n)
            assert deflection == pytest.approx(0.00126532, rel=1e-4)
            self.check(result, thickness)

    def test_one_sided(self, square):
        """Edges that only push up leave a boundary layer, h wide, whose softness is proportional to h/a.

        From h/a = 0.01 (0.004402, see above) to 0 it is 0.45 %, so 0.045 % of physics are left at h/a = 1e-3, of which
        160 × 160 elements see a third. The thin limit itself has converged on 80 × 80.
        """
        found = {}
        for thickness, n in ((1e-3, 160), (2e-4, 80), (1e-4, 80), (1e-5, 160)):
            found[thickness], result = thin({"resists": "down"}, thickness, n)
            self.check(result, thickness)
        limit = found[1e-5]
        coarse, d = square({"resists": "down"}, 1e-5, 40)
        assert limit == pytest.approx(coarse.deflection.max() * d, rel=1e-4)
        assert [found[1e-4], found[2e-4]] == pytest.approx([limit, limit], rel=1e-4)
        assert 1e-4 < found[1e-3] / limit - 1 < 4.5e-4


def over_obstacle(divisions: int) -> signorini.Result:
    model = signorini.Model(
        material={"E": 1.0, "nu": 0.3},
        plate={"shape": "disc", "radius": 2, "thickness": 0.01},
        mesh={"divisions": [divisions, divisions]},
        support=[
            {"edge": ["rim"], "fix": "clamped"},
            {"area": "all", "resists": "down", "settlement": "x**2 + y**2 - 1"},
        ],
        load=[{"pressure": 0.0}],
    )
    result = signorini.solve(model)["all"]
    assert result.certificate.passed
    return result


def test_a_clamped_disc_over_a_curved_obstacle_takes_its_closed_form_with_the_square_of_the_mesh() -> None:
    """Brenner, Sung, Zhang (2012), thin: on 1 − r² up to r₀, free beyond; no load but the obstacle."""
    r = np.linspace(0, 2, 21)
    outer = r > 0.18134453
    exact = 1 - r**2
    far = r[outer]
    exact[outer] = 0.5250406303 * far**2 * np.log(far) - 0.6286090479 * far**2
    exact[outer] += 0.01726640079 * np.log(far) + 1.046746304
    coarse, fine = (
        np.abs([-at.deflection for at in over_obstacle(n).probe(np.column_stack([r, 0 * r]))] - exact).max()
        for n in (16, 32)
    )
    assert fine < 1e-3 and fine < 0.35 * coarse
