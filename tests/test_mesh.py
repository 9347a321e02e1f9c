"""Meshes: output of the meshers, refusals, and location of points."""

import math
import re
from itertools import pairwise

import numpy as np
import pytest
from halving import halved
from hypothesis import given, settings
from hypothesis import strategies as st

from signorini._core import serendipity
from signorini.discretise.quadrature import area_quadrature
from signorini.errors import InputError
from signorini.mesh import Mesh
from signorini.mesh.divisions import graded, subdivide
from signorini.mesh.isoparametric import folded
from signorini.mesh.meshers import annulus, disc, rectangle
from signorini.shapes import Polyline, Ring

SQUARE = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1]], float)
ELEMENT = np.arange(8)[None]


def distorted(mesh, amount=0.2, seed=1, curved=True):
    """Move inner nodes by `amount` of the smallest element."""
    random = np.random.default_rng(seed)
    points, step = mesh.points.copy(), amount * math.sqrt(mesh.element_area.min())
    fixed = np.zeros(len(points), dtype=bool)
    fixed[mesh.boundary] = True
    midside = np.zeros(len(points), dtype=bool)
    midside[mesh.elements[:, 4:]] = True
    points[~fixed & ~midside] += random.uniform(-step, step, (np.sum(~fixed & ~midside), 2))
    inner = mesh.unique_sides[~fixed[mesh.unique_sides[:, 1]]]
    bend = random.uniform(-0.3 * step, 0.3 * step, (len(inner), 2)) if curved else 0.0
    points[inner[:, 1]] = 0.5 * (points[inner[:, 0]] + points[inner[:, 2]]) + bend
    return Mesh(points, mesh.elements, mesh.edges)


def scaled_jacobian(mesh):
    """Least sine of the angle between the coordinate lines."""
    station = np.stack(np.meshgrid(*2 * [np.linspace(-1, 1, 5)]), axis=-1).reshape(-1, 2)
    j = np.einsum("end,rna->erda", mesh.nodes, serendipity(station)[1])
    lengths = np.hypot(j[..., 0, :], j[..., 1, :]).prod(axis=-1)
    return float((np.linalg.det(j) / lengths).min())


MESHES = {
    "rectangle": rectangle((1.0, -2.0), (4.0, 3.0), (5, 4)),
    "disc": disc((1.0, 2.0), 2.0, (5, 16)),
    "quarter annulus": annulus((0.0, 0.0), 1.0, 2.0, (3, 5), sector=90),
    "distorted rectangle": distorted(rectangle((0.0, 0.0), (4.0, 3.0), (5, 4))),
    "distorted disc": distorted(disc((0.0, 0.0), 2.0, (5, 16)), 0.15),
    "triangles": halved(rectangle((0.0, 0.0), (4.0, 3.0), (5, 4))),
    "mixed disc": halved(disc((0.0, 0.0), 2.0, (5, 16)), 0.5),
}


# Output of the meshers


def test_a_rectangle_has_the_divisions_asked_for_and_its_own_area_and_moments_of_inertia():
    mesh = rectangle((1.0, 2.0), (4.0, 3.0), (5, 7), x_lines=[2.3, 4.0], y_lines=[2.5])
    assert len(mesh.elements) == 35
    q = area_quadrature(mesh)
    x, y = (q.positions - (3.0, 3.5)).T
    assert q.weights @ np.array([x**2, y**2, x * y]).T == pytest.approx([3 * 4**3 / 12, 4 * 3**3 / 12, 0], abs=1e-12)
    assert mesh.size == 4.0 and q.total == pytest.approx(12.0, rel=1e-14)


@pytest.mark.parametrize("sector", [1.0, 60.0, 135.5, 359.0])
def test_an_annulus_may_be_any_sector(sector):
    n = 4 * math.ceil(sector / 90)
    mesh = annulus((1.0, -1.0), 1.0, 2.0, (2, n), sector)
    assert len(mesh.elements) == 2 * n
    assert area_quadrature(mesh, order=4).total == pytest.approx(math.radians(sector) * 1.5, rel=1e-4)
    end = mesh.points[mesh.edges["end"]] - (1.0, -1.0)
    angle = np.degrees(np.arctan2(end[..., 1], end[..., 0])) % 360
    assert angle == pytest.approx(np.full(angle.shape, sector), abs=1e-9)
    assert (mesh.points[mesh.edges["start"]][..., 1] == -1.0).all()


@pytest.mark.parametrize("sector", [90, 180, 360])
@pytest.mark.parametrize("mesher", [disc, lambda c, r, n, s: annulus(c, 0.4 * r, r, n, s)], ids=["disc", "annulus"])
def test_area_and_moment_of_inertia_of_round_meshes_converge_with_the_fourth_power(mesher, sector):
    inner = 0.0 if mesher is disc else 0.8
    exact = np.array([(2.0**2 - inner**2) / 2, (2.0**4 - inner**4) / 4]) * math.radians(sector)
    errors = []
    for n in (4, 8):
        q = area_quadrature(mesher((1.0, -1.0), 2.0, (n, n * sector // 90), sector), order=4)
        polar = ((q.positions - (1.0, -1.0)) ** 2).sum(axis=1)
        errors.append(np.abs([q.total - exact[0], q.weights @ polar - exact[1]]) / exact)
    assert (np.array(errors[0]) < 1e-4).all()
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.2)


@pytest.mark.parametrize(
    ("sector", "around", "core"), [(360, 16, (4, 4)), (360, 13, (4, 4)), (180, 7, (4, 2)), (90, 7, (4, 4))]
)
def test_the_circumference_of_a_disc_is_rounded_up_to_fit_its_core(sector, around, core):
    mesh = disc((0.0, 0.0), 1.0, (9, around), sector)
    rim = len(mesh.edges["rim"])
    assert rim == {360: 16, 180: 8, 90: 8}[sector]
    assert (len(mesh.elements) - core[0] * core[1]) % rim == 0


@pytest.mark.parametrize("sector", [90, 180, 360])
@pytest.mark.parametrize("divisions", [(10, 63), (12, 48), (19, 118)])
@pytest.mark.parametrize("radius", [0.8, 1.3, 2.1])
def test_the_core_of_a_disc_ends_within_a_circle_that_the_mesh_should_have(radius, divisions, sector):
    divisions = divisions[0], divisions[1] * sector // 360
    plain, mesh = disc((1.0, 2.0), 3.0, divisions, sector), disc((1.0, 2.0), 3.0, divisions, sector, [radius])
    ring = mesh.edges_along(Ring((1.0, 2.0), radius))
    assert ring is not None and len(ring) == len(mesh.edges["rim"]) == len(plain.edges["rim"])
    assert len(mesh.elements) <= 2.7 * len(plain.elements) and scaled_jacobian(mesh) > 0.55


def test_a_circle_much_smaller_than_the_core_of_a_disc_changes_no_element():
    plain, mesh = disc((0.0, 0.0), 3.0, (19, 118)), disc((0.0, 0.0), 3.0, (19, 118), 360, [0.2])
    assert len(mesh.elements) - len(plain.elements) == len(mesh.edges["rim"])


@pytest.mark.parametrize(("asked", "around"), [(12, 12), (9, 12)])
def test_an_annulus_has_the_divisions_asked_for_rounded_up_to_a_multiple_of_four(asked, around):
    mesh = annulus((0.0, 0.0), 1.0, 2.0, (3, asked), radii=[1.3])
    assert len(mesh.elements) == 3 * around
    assert len(mesh.edges_along(Ring((0.0, 0.0), 1.3))) == around
    for mirrored in (mesh.points * [-1, 1], mesh.points * [1, -1]):
        assert np.abs(mirrored[:, None] - mesh.points).max(axis=2).min(axis=1).max() < 1e-12


def area_to_the_left(mesh, edge):
    """Area between an edge and the mean of the nodes, positive if that is on its left."""
    points = mesh.points[edge] - mesh.points.mean(axis=0)
    a, m, b = np.moveaxis(points, 1, 0)
    return 0.5 * sum((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum() for p, q in ((a, m), (m, b)))


@pytest.mark.parametrize("name", MESHES)
def test_named_edges_make_up_the_outline_with_the_plate_on_the_left(name):
    mesh = MESHES[name]
    named = np.vstack(list(mesh.edges.values()))
    assert sorted(map(tuple, named)) == sorted(map(tuple, mesh.boundary))
    assert all((a[2] == b[0]) for edge in mesh.edges.values() for a, b in pairwise(edge))
    signs = {key: area_to_the_left(mesh, edge) > 0 for key, edge in mesh.edges.items()}
    assert all(positive for key, positive in signs.items() if key != "inner")


# Following lines


@given(st.integers(1, 30), st.lists(st.floats(-0.5, 1.5), max_size=6), st.floats(-10.0, 10.0), st.integers(1, 3))
def test_a_subdivision_keeps_its_count_and_its_neighbours_are_alike(count, lines, start, first):
    count += first
    knots = subdivide(start, start + 1.0, count, [start + line for line in lines], first=first)
    sizes = np.diff(knots)
    assert len(sizes) == count and knots[0] == start and knots[-1] == start + 1.0
    assert (sizes > 0).all()
    assert (np.maximum(sizes[1:] / sizes[:-1], sizes[:-1] / sizes[1:]) < 3.001).all()


_PLACES = st.lists(st.floats(-0.5, 1.5), max_size=6)


@given(st.integers(2, 30), _PLACES, _PLACES, st.booleans())
def test_lesser_lines_keep_no_other_from_being_followed(count, lines, lesser, is_graded):
    """A section 5 mm beside a column's face took the grid away from it, and the face ran inside elements."""

    def joints(*groups):
        if is_graded:
            return graded(0.0, 1.0, 1.0 / count, [(0.4, 0.5, 0.5 / count)], *groups)
        return subdivide(0.0, 1.0, count, *groups)

    alone, both = joints(lines), joints(lines, lesser)
    followed = [line for line in lines if np.abs(alone - line).min() <= 1e-9]
    assert all(np.abs(both - line).min() <= 2e-9 for line in followed)


@given(st.floats(0.26, 0.74))
def test_a_single_line_well_inside_is_followed_exactly(line):
    mesh = rectangle((0.0, 0.0), (1.0, 1.0), (6, 2), x_lines=[line])
    assert np.abs(mesh.points[:, 0] - line).min() < 1e-9
    assert mesh.edges_along(Polyline(((line, 0.0), (line, 1.0)))) is not None


@given(st.integers(2, 20), st.lists(st.integers(1, 89), max_size=8, unique=True), st.floats(1e-3, 1e3))
def test_a_subdivision_is_the_same_in_other_units_for_lines_on_a_grid(count, lines, unit):
    here = subdivide(0.0, 9.0, count, [0.1 * line for line in lines])
    there = subdivide(0.0, unit * 9.0, count, [unit * 0.1 * line for line in lines])
    assert np.abs(there / unit - here).max() < 1e-12 * 9.0


# Refusals


def moved(node, to):
    points = SQUARE.copy()
    points[node] = to
    return points


TWO = np.vstack([SQUARE, SQUARE + np.array([2.0, 0.0])])
APART = np.vstack([SQUARE, SQUARE + np.array([5.0, 0.0])])
BOTH = np.arange(16).reshape(2, 8)
SMALL = np.vstack([SQUARE, 0.5 * SQUARE + (2.0, 0.0)])


@pytest.mark.parametrize(
    ("points", "elements", "message"),
    [
        (moved(2, (0.4, 0.4)), ELEMENT, r"Element 0 .* folds over itself"),
        (moved(4, (0.2, 0.0)), ELEMENT, r"Element 0 .* folds over itself"),
        (SQUARE, ELEMENT[:, [0, 3, 2, 1, 7, 6, 5, 4]], "Element 0 .* is clockwise"),
        (moved(1, (np.nan, 0.0)), ELEMENT, "not finite: node 1"),
        (np.vstack([SQUARE, [[9.0, 9.0]]]), ELEMENT, r"no element uses, such as node 8 .* at \[9, 9\]"),
        (SQUARE, ELEMENT + 1, "must use nodes 0 to 7; found 1 to 8"),
        (SQUARE, np.array([[0, 1, 2, 3, 4, 5, 6, 6]]), "Element 0 .* uses a node twice"),
        (SQUARE, np.empty((0, 8)), "ne ≥ 1"),
        (np.zeros((8, 3)), ELEMENT, r"shape \(n, 2\); found \(8, 3\)"),
        (TWO, BOTH, "hanging or duplicate node: node .* lies on the side"),
        (SMALL, BOTH, "hanging or duplicate node: node .* lies on the side"),
        (APART, BOTH, "in 2 pieces that share no side: Element 0 .*; Element 1"),
    ],
)
def test_a_mesh_names_what_is_wrong_with_it(points, elements, message):
    with pytest.raises(InputError, match=message):
        Mesh(points, elements, {})


def around(mesh, degrees, inward=0.0):
    """Bend a square of side 1 around a circle, its lower side outside; inward as it goes."""
    angle, radius = np.radians(degrees) * mesh.points[:, 0], 3.0 - mesh.points[:, 1] - inward * mesh.points[:, 0]
    return Mesh(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), mesh.elements, {})


def eight(mesh, wide=0.02):
    """Bend it along a figure eight that crosses itself between nodes."""
    t, beside = 4.5 * mesh.points[:, 0] - 0.5, wide * (mesh.points[:, 1] - 0.5)
    ahead = np.column_stack([np.cos(t), np.cos(2 * t)])
    ahead /= np.hypot(*ahead.T)[:, None]
    line = np.column_stack([np.sin(t), 0.5 * np.sin(2 * t)])
    return Mesh(line + beside[:, None] * np.column_stack([-ahead[:, 1], ahead[:, 0]]), mesh.elements, {})


def test_elements_that_overlap_are_refused_with_the_place():
    strip = rectangle((0.0, 0.0), (1.0, 1.0), (30, 4))
    assert around(strip, 359.9).element_area.sum() == pytest.approx(np.radians(359.9) * 2.5, rel=1e-4)
    with pytest.raises(InputError, match=r"overlap: its boundary crosses itself at \[2\.9501\d, 0\]"):
        around(strip, 361, inward=0.05)
    with pytest.raises(InputError, match=r"overlap: its boundary crosses itself at"):
        around(strip, 500, inward=0.7)
    assert around(strip, 500, inward=1.5).size > 4  # a spiral
    with pytest.raises(InputError, match="overlap: its boundary crosses itself at") as refused:
        eight(rectangle((0.0, 0.0), (1.0, 1.0), (30, 1)))
    # The bands of the eight, 0.02 wide, cross in a square about the origin.
    place = re.findall(r"\[(\S+), (\S+)\]", str(refused.value))[0]
    assert np.hypot(*map(float, place)) == pytest.approx(0.02 / np.sqrt(2), rel=0.01)


def test_a_midside_that_is_a_neighbours_corner_hangs():
    points = np.vstack([SQUARE, [[3, 1], [3, 2], [2.5, 1], [3, 1.5], [2.5, 2], [2, 1.5]]])
    neighbour = [5, 8, 9, 2, 10, 11, 12, 13]
    with pytest.raises(InputError, match=r"hanging node: its midside node 5 .* at \[2, 1\]"):
        Mesh(points, np.array([ELEMENT[0], neighbour]), {})


def test_a_side_shared_with_different_midsides_is_refused():
    points = np.vstack([SQUARE, [[4, 0], [4, 2], [3, 0], [4, 1], [3, 2], [2, 1]]])
    with pytest.raises(InputError, match="same midside node"):
        Mesh(points, np.array([ELEMENT[0], [1, 8, 9, 2, 10, 11, 12, 13]]), {})


# Where points are


@pytest.mark.parametrize("name", MESHES)
@given(data=st.data())
@settings(max_examples=30, deadline=None)
def test_locating_a_mapped_point_gives_it_back(name, data):
    mesh = MESHES[name]
    coordinate = st.floats(-1.0, 1.0)
    drawn = data.draw(
        st.lists(st.tuples(st.integers(0, len(mesh.elements) - 1), coordinate, coordinate), min_size=1, max_size=8)
    )
    elements = np.array([item[0] for item in drawn])
    xi = np.array([item[1:] for item in drawn])
    within = np.abs(xi).max(axis=1) < 1.0 - 1e-8
    within &= ~mesh.triangles[elements] | (np.abs(xi.sum(axis=1)) > 1e-8)
    xi = np.where(mesh.triangles[elements, None], folded(xi), xi)
    points = mesh.map(elements, xi)
    found = mesh.locate(points)
    assert found.inside.all()
    assert mesh.map(found.elements, found.xi) == pytest.approx(points, abs=1e-9)
    assert np.array_equal(found.elements[within], elements[within])
    assert found.xi[within] == pytest.approx(xi[within], abs=1e-9)


@given(angle=st.floats(1.0, 90.0), width=st.floats(1e-3, 0.999), seed=st.integers(0, 1000))
@settings(max_examples=50, deadline=None)
def test_positions_in_a_long_curved_element_have_their_reference_points(angle, width, seed):
    """In a ring's sector of up to 90°, up to a thousand times as long as wide."""
    mesh = annulus((0.3, -0.2), 1.0 - width, 1.0, (1, 1), sector=angle)
    xi = np.random.default_rng(seed).uniform(-1.0, 1.0, (40, 2))
    elements = np.zeros(40, np.int64)
    assert mesh.invert(elements, mesh.map(elements, xi)) == pytest.approx(xi, abs=1e-9)


def test_a_point_is_outside_past_a_straight_edge_but_inside_on_the_true_circle():
    square = MESHES["rectangle"]
    assert square.locate(np.array([[1.0 - 1e-12, -1.0], [1.0 - 1e-6, -1.0]])).inside.tolist() == [True, False]
    coarse = disc((0.0, 0.0), 1.0, (2, 8))
    angle = np.linspace(0.0, 2.0 * np.pi, 101)
    rim = np.column_stack([np.cos(angle), np.sin(angle)])
    found = coarse.locate(rim)
    assert found.inside.all()
    assert coarse.map(found.elements, found.xi) == pytest.approx(rim, abs=1e-10)
    assert not coarse.locate(1.05 * rim).inside.any()


# Sides along curves
