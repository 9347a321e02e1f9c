"""Quadrature over regions and along curves that the mesh does not follow, against closed forms."""

import math
from itertools import pairwise

import numpy as np
import pytest
from halving import halved
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from signorini.discretise.meshing import arcs_of
from signorini.discretise.quadrature import area_quadrature, curve_quadrature, off_plate
from signorini.mesh import Mesh
from signorini.mesh.meshers import disc, outlined, rectangle
from signorini.model.places import Area
from signorini.shapes import Circle, Hollow, Polygon, Polyline, Rectangle, Ring
from signorini.shapes.cuts import CutLine, LeftOf
from signorini.shapes.outlines import straight


def distorted(mesh, bend, seed=1):
    """Move inner corners by a fifth and bend inner sides by `bend` of the smallest element."""
    random = np.random.default_rng(seed)
    points, step = mesh.points.copy(), math.sqrt(mesh.element_area.min())
    fixed = np.zeros(len(points), dtype=bool)
    fixed[mesh.boundary] = True
    corner = np.zeros(len(points), dtype=bool)
    corner[mesh.elements[:, :4]] = True
    inner = corner & ~fixed
    points[inner] += step * random.uniform(-0.2, 0.2, (inner.sum(), 2))
    sides = mesh.unique_sides[~fixed[mesh.unique_sides[:, 1]]]
    middles = 0.5 * (points[sides[:, 0]] + points[sides[:, 2]])
    points[sides[:, 1]] = middles + bend * step * random.uniform(-1.0, 1.0, middles.shape)
    return Mesh(points, mesh.elements, mesh.edges)


SQUARE = rectangle((-2.0, -2.0), (4.0, 4.0), (5, 7))
ROUND = disc((0.0, 0.0), 2.0, (5, 16))
MESHES = {
    "rectangle": SQUARE,
    "disc": ROUND,
    "straight distorted rectangle": distorted(SQUARE, 0.0),
    "curved distorted rectangle": distorted(SQUARE, 0.05),
    "curved distorted disc": distorted(ROUND, 0.04),
    "one element": rectangle((-2.0, -2.0), (4.0, 4.0), (1, 1)),
    "triangles": halved(SQUARE),
    "mixed disc": halved(ROUND, 0.5),
    "curved distorted triangles": distorted(halved(SQUARE), 0.04),
}
any_mesh = st.sampled_from(sorted(MESHES))
coordinate = st.floats(-0.7, 0.7)


def moments(quadrature):
    return np.array([quadrature.total, *(quadrature.weights @ quadrature.positions)])


def polygon_moments(points):
    x, y = np.array(points).T
    x1, y1 = np.roll(x, -1), np.roll(y, -1)
    cross = x * y1 - x1 * y
    return np.array([cross.sum() / 2, ((x + x1) * cross).sum() / 6, ((y + y1) * cross).sum() / 6])


def check(name, region, exact):
    """Area and first moments to 1e-11 of the area; positive weights; reference points that belong to the positions."""
    mesh = MESHES[name]
    q = area_quadrature(mesh, region)
    assert moments(q) == pytest.approx(exact, abs=1e-11 * exact[0])
    assert (q.weights >= 0.0).all()
    assert mesh.map(q.elements, q.xi) == pytest.approx(q.positions, abs=1e-9)
    assert np.abs(q.xi).max() <= 1.0 + 1e-9
    assert off_plate(mesh, region, q) == 0.0


# Regions


@given(any_mesh, coordinate, coordinate, st.floats(0.001, 0.9))
@settings(max_examples=80, deadline=None)
def test_circles_anywhere_have_their_area_and_centroid(name, x, y, radius):
    check(name, Circle((x, y), radius), math.pi * radius**2 * np.array([1.0, x, y]))


@given(any_mesh, coordinate, coordinate, st.floats(0.001, 0.6), st.floats(0.001, 0.6))
@settings(max_examples=50, deadline=None)
def test_rectangles_anywhere_have_their_area_and_centroid(name, x, y, width, height):
    region = Rectangle(x, y, x + width, y + height)
    check(name, region, region.area * np.array([1.0, x + width / 2, y + height / 2]))


@given(any_mesh, coordinate, coordinate, st.lists(st.floats(0.1, 0.7), min_size=3, max_size=9), st.floats(0.0, 6.0))
@settings(max_examples=50, deadline=None)
def test_star_shaped_polygons_anywhere_have_their_area_and_centroid(name, x, y, radii, start):
    angles = start + np.linspace(0.0, 2.0 * np.pi, len(radii), endpoint=False)
    points = np.column_stack([x + radii * np.cos(angles), y + radii * np.sin(angles)])
    check(name, Polygon(tuple(map(tuple, points))), polygon_moments(points))
    check(name, Polygon(tuple(map(tuple, points[::-1]))), polygon_moments(points))


@pytest.mark.parametrize("shift", [0.0, 1e-15, -1e-15, 1e-12, 1e-7])
@pytest.mark.parametrize("name", ["rectangle", "one element", "disc"])
def test_outlines_on_grid_lines_and_through_nodes_are_exact(name, shift):
    points = [
        (-0.4 + shift, -2.0 / 7.0),
        (0.4, -2.0 / 7.0),
        (0.4, 2.0 / 7.0 + shift),
        (-0.4 + shift, 2.0 / 7.0 + shift),
    ]
    check(name, Polygon(tuple(points)), polygon_moments(points))
    check(name, Circle((shift, 0.0), 0.4), math.pi * 0.16 * np.array([1.0, shift, 0.0]))
    diagonal = [(-1.0, -1.0), (1.0, 1.0 + shift), (-1.0, 1.0)]
    check(name, Polygon(tuple(diagonal)), polygon_moments(diagonal))


@given(st.floats(-1.5, 1.5), st.floats(-1.0, 1.0), st.floats(0.0, 6.3))
@settings(max_examples=30, deadline=None)
def test_straight_steps_across_straight_triangles_are_exact(x, y, angle):
    mesh, (c, s) = MESHES["triangles"], (math.cos(angle), math.sin(angle))

    def level(points):
        return c * (points[:, 0] - x) + s * (points[:, 1] - y)

    q = area_quadrature(mesh, levels=[level])
    assert q.total == pytest.approx(16.0, rel=1e-13)
    above = level(q.positions) > 0.0
    corners = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]
    kept = []
    for p, r in zip(corners, corners[1:] + corners[:1], strict=True):
        a, b = level(np.array([p, r]))
        kept += [p] if a > 0 else []
        kept += [tuple(np.array(p) + a / (a - b) * (np.array(r) - np.array(p)))] if a * b < 0 else []
    expected = polygon_moments(kept) if len(kept) > 2 else np.zeros(3)
    found = np.array([q.weights[above].sum(), *(q.weights[above] @ q.positions[above])])
    assert found == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize("sector", [90, 180, 360])
def test_a_circle_along_a_ring_of_elements_is_exact_though_they_are_parabolas(sector):
    mesh = disc((0.0, 0.0), 2.0, (8, 24 * sector // 360), sector, radii=[1.5])
    assert mesh.edges_along(Ring((0.0, 0.0), 1.5)) is not None
    q = area_quadrature(mesh, Circle((0.0, 0.0), 1.5))
    assert q.total == pytest.approx(math.pi * 1.5**2 * sector / 360, rel=1e-12)
    ring = curve_quadrature(mesh, Ring((0.0, 0.0), 1.5))
    assert ring.total == pytest.approx(3.0 * math.pi * sector / 360, rel=1e-12)


@pytest.mark.parametrize("far", [0.0, 100.0, 1e4])
@pytest.mark.parametrize("radius", [0.3, 0.33, 0.37])
def test_a_circle_that_elements_follow_is_exact_far_from_the_origin(far, radius):
    """Ends of sides that meet differ by rounding there, and between them is no strip."""
    x = (far - 0.5, far + 0.5)
    square = straight(((x[0], -0.5), (x[1], -0.5), (x[1], 0.5), (x[0], 0.5)), "abcd")
    round_ = Circle((far, 0.0), radius)
    mesh = outlined([square], 0.2, lines=[(np.array(list(arcs_of(round_))), False)])
    found = area_quadrature(mesh, round_)
    assert found.total == pytest.approx(round_.area, rel=1e-12 + 1e-14 * far)


# Off the plate


@pytest.mark.parametrize("name", ["rectangle", "straight distorted rectangle", "curved distorted rectangle"])
def test_of_a_region_across_the_edge_the_part_on_the_plate_counts(name):
    mesh = MESHES[name]
    half = Circle((2.0, 0.1), 0.7)
    q = area_quadrature(mesh, half)
    assert moments(q)[:2] == pytest.approx([half.area / 2, half.area - 2 / 3 * 0.7**3], rel=1e-11)
    assert off_plate(mesh, half, q) == pytest.approx(half.area / 2, rel=1e-11)
    away = Rectangle(5.0, 5.0, 6.0, 7.0)
    q = area_quadrature(mesh, away)
    assert len(q.weights) == 0 and off_plate(mesh, away, q) == 2.0


def test_the_circle_that_an_elements_rim_stands_for_is_on_the_plate_but_no_larger_one():
    for n in (8, 16, 64):
        mesh = disc((0.0, 0.0), 1.0, (4, n))
        for radius, on in ((1.0, True), (1.02, False)):
            region = Circle((0.0, 0.0), radius)
            assert (off_plate(mesh, region, area_quadrature(mesh, region)) == 0.0) is on


# Curves


@given(any_mesh, st.lists(st.tuples(coordinate, coordinate), min_size=2, max_size=5))
@settings(max_examples=50, deadline=None)
def test_lines_anywhere_have_their_length_and_centroid(name, points):
    assume(all(math.dist(a, b) > 1e-3 for a, b in pairwise(points)))
    mesh, line = MESHES[name], Polyline(tuple(points))
    q = curve_quadrature(mesh, line)
    a, b = np.array(points[:-1]), np.array(points[1:])
    lengths = np.hypot(*(b - a).T)
    assert q.total == pytest.approx(line.length, rel=1e-12)
    assert q.weights @ q.positions == pytest.approx(lengths @ (0.5 * (a + b)), abs=1e-12)
    assert mesh.map(q.elements, q.xi) == pytest.approx(q.positions, abs=1e-9)
    assert q.weights @ q.tangents == pytest.approx(b[-1] - a[0], abs=1e-12)


@given(any_mesh, coordinate, coordinate, st.floats(0.01, 1.0))
@settings(max_examples=50, deadline=None)
def test_rings_anywhere_have_their_circumference_and_centre(name, x, y, radius):
    mesh, ring = MESHES[name], Ring((x, y), radius)
    q = curve_quadrature(mesh, ring, order=8)
    assert q.total == pytest.approx(ring.length, rel=1e-12)
    assert q.weights @ q.positions == pytest.approx(ring.length * np.array([x, y]), abs=1e-4)
    assert np.hypot(*(q.positions - (x, y)).T) == pytest.approx(radius, rel=1e-12)
    outward = (q.positions - (x, y)) / radius
    assert q.normals == pytest.approx(outward, abs=1e-10)


@pytest.mark.parametrize("away", [0.0, *(sign * 1.07 * 2.0**n for n in (6, 14, 22) for sign in (1, -1))])
@pytest.mark.parametrize("shape", ["circle", "ring", "square", "tilted"])
def test_what_touches_mesh_lines_far_from_the_origin_keeps_its_area(away, shape):
    """As at site coordinates: rounding must not tell a circle that touches a line from one that crosses it."""
    rng = np.random.default_rng(7)
    for _ in range(8):
        origin = away * rng.uniform(0.5, 1.0, 2)
        mesh, radius = rectangle(tuple(origin), (10.0, 6.0), (20, 12)), 0.5 * rng.integers(1, 4) - 0.3
        x, y = origin + 0.5 * rng.integers(3, 8, 2) + radius * rng.choice([-1.0, 0.0, 1.0], 2)
        corners = radius * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        if shape == "tilted":
            corners = radius * np.array([[-1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
        region = {
            "circle": Circle((x, y), radius),
            "ring": Hollow(Circle((x, y), radius), (Circle((x, y), 0.5 * radius),)),
        }.get(shape, Polygon(tuple(map(tuple, np.add(corners, [x, y])))))
        found = area_quadrature(mesh, region)
        rounding = 1e-12 + 100 * np.finfo(float).eps * np.abs(origin).max() / radius
        assert found.total == pytest.approx(region.area, rel=rounding)
        middle = found.weights @ (found.positions - [x, y]) / found.total
        assert np.abs(middle).max() <= rounding * radius + 10 * np.finfo(float).eps * np.abs(origin).max()


# Edges


# Regions and curves themselves, and roots


@given(
    any_mesh,
    st.tuples(*4 * [coordinate]),
    st.sampled_from([None, Circle((0.3, -0.2), 0.8), Rectangle(-1, -0.5, 0.9, 1)]),
)
@example("curved distorted disc", (0.0, 0.25, 2.6781309754448466e-10, 0.0), None)
@settings(max_examples=60, deadline=None)
def test_left_and_right_of_a_line_are_the_whole(name, ends, region):
    """Quadrature of the plate, and of a region whose outline the line crosses within elements."""
    mesh = MESHES[name]
    a, b = np.array(ends).reshape(2, 2)
    assume(math.dist(a, b) > 0.1)
    points = [tuple(p) for p in (2 * a - b, a, b, b + np.array([0.3, 1.2])[:: 1 if b[0] > a[0] else -1])]
    box = (-2.1, -2.1, 2.1, 2.1)
    whole = moments(area_quadrature(mesh, region))
    halves = [area_quadrature(mesh, LeftOf(CutLine(line, 1e-9), box, region), 4) for line in (points, points[::-1])]
    # A line that is nearly one of the mesh is taken for it, 1e-9 off over up to four lengths.
    assert sum(moments(half) for half in halves) == pytest.approx(whole, abs=1e-10 * whole[0] + 4e-9)
    for half, line in zip(halves, (points, points[::-1]), strict=True):
        assert (CutLine(line, 1e-9).near(half.positions).side <= 0).all()
        assert region is None or region.contains(half.positions).all()


@pytest.mark.parametrize(
    "polygon",
    [
        [[1.5, 1.134], {"through": [3, 2], "to": [1.5, 2.866]}, {"through": [2.2, 2], "to": [1.5, 1.134]}],
        [[1, 1], {"through": [2, 0.5], "to": [3, 1]}, {"through": [2, 0.6], "to": [1, 1]}],
        [[1, 1], {"through": [2, 1.6], "to": [3, 1]}, [3, 3], {"through": [2, 2.4], "to": [1, 3]}],
        [[1, 1], [3, 1], {"through": [1.585786437627, 1.585786437627], "to": [1, 3]}],
        [[1, 1], {"through": [2, 2], "to": [3, 1]}],
    ],
)
@pytest.mark.parametrize("count", [8, 21, 40])
def test_areas_between_arcs_have_their_area_and_first_moments(polygon, count):
    region = Area(polygon=polygon).region
    found = area_quadrature(rectangle((0.0, 0.0), (4.0, 4.0), (count, count)), region)
    assert found.total == pytest.approx(region.area, rel=1e-10)
    # The outline as a polygon of chords of one degree, whose area is less than 1e-4 off.
    x, y = region.loops[0].T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    for values, chord in ((found.positions[:, 0], x), (found.positions[:, 1], y)):
        moment = abs((cross * (chord + np.roll(chord, -1))).sum()) / 6
        assert found.weights @ values == pytest.approx(moment, rel=2e-3)
