"""Plates on supports that hold one way only, against closed forms and independent programs."""

import numpy as np
import pytest
from models import rectangular
from tensionless import quarter_square

import signorini


@pytest.mark.parametrize(("thickness", "contact"), [(0.1, (0.303, 0.308)), (0.01, (0.2475, 0.2525))])
def test_contact_of_a_square_on_rigid_one_sided_edges_ends_within_an_element(thickness, contact):
    """Quarter of a plate under uniform load; a high-order spectral Mindlin solver."""
    for n in (10, 20, 40):
        result = signorini.solve(quarter_square({"resists": "down"}, thickness, n))["all"]
        edges = result.supports[0]
        for along, across in ((0, 1), (1, 0)):
            side = np.abs(edges.positions[:, across] - 0.5) < 1e-12
            closed = np.sort(edges.positions[side & edges.closed, along])
            opened = np.sort(edges.positions[side & ~edges.closed, along])
            assert closed[-1] < opened[0]
            assert contact[0] - 0.5 / n <= closed[-1] <= contact[1] + 0.5 / n
        assert (edges.reactions >= 0).all()


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
    return {n: slab_b(n) for n in (20, 40)}


class TestSlabB:
    """10 m slab on 16 rigid points that only push.

    Rigid points indent a Mindlin plate by ln(1/element size), so reactions drift slowly with the mesh: by up to 0.15 kN
    from 40 to 80 and on to 120 elements a side; MITC4 on 160 × 160 is where mitc9 is on 80 × 80.
    """

    @pytest.mark.parametrize("n", [20, 40])
    def test_exactly_two_lift(self, slabs, n):
        points = slabs[n].supports[0]
        assert points.positions[~points.closed].tolist() == [[6.5, 0.5], [0.5, 6.5]]
        assert points.reaction == pytest.approx(700e3, rel=1e-11)

    @pytest.mark.parametrize("n", [20, 40])
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
