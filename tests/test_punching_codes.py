"""Punching by codes: closed forms of perimeters, published examples, and invariance."""

import numpy as np
import pytest
import shapely
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from structuralcodes.codes.ec2_2004 import shear

from signorini.design import aci318, en1992_punching
from signorini.design.perimeters import Column, Plan
from signorini.errors import InputError

D, C1, C2 = 250.0, 300.0, 500.0
WIDE = shapely.box(-10e3, -10e3, 10e3, 10e3)


def rectangle(centre: complex, sides: tuple[float, float], angle: float = 0.0) -> Column:
    turn, (b, h) = np.exp(1j * np.radians(angle)), sides
    corners = [centre + 0.5 * turn * (u * b + 1j * v * h) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return Column(tuple(map(complex, corners)))


def rings(slab: shapely.Polygon) -> list[np.ndarray]:
    return [shapely.get_coordinates(ring)[:-1] for ring in (slab.exterior, *slab.interiors)]


def eurocode(column: Column, slab: shapely.Polygon = WIDE, d: float = D, **keys: object) -> en1992_punching.Punching:
    plan = Plan.of(column, rings(slab), 6.0 * d, widened=True)
    return en1992_punching.Punching(plan, (d, d), (0.005, 0.005), 30.0, 500.0, **keys)


def numbers(one, force: float, moment: complex = 0.0, inside: float = 0.0) -> dict[str, float]:
    taken = np.full((1, len(one.perimeters)), inside)
    found = one.numbers(np.array([force]), np.array([moment], np.complex128), taken)
    return {name: float(value[0]) for name, value in found.items()}


def test_flat_slab_of_the_concrete_centre() -> None:
    """How to design concrete structures using Eurocode 2: flat slabs; column 400 mm, d 260 mm, 1204.8 kN, β 1.15."""
    found = numbers(eurocode(rectangle(0.0, (400.0, 400.0)), d=260.0, given=1.15), 1204.8e3)
    assert found["u1"] == pytest.approx(4867.0, abs=0.5)
    assert found["v_ed"] == pytest.approx(1.09, abs=0.005)
    assert found["v_ed_face"] == pytest.approx(3.33, abs=0.005)


def test_c30_with_d_of_345_mm() -> None:
    """C30, d 0.35 and 0.34 m, 7.54 cm²/m both ways."""
    rho = np.sqrt(754 / 350e3 * 754 / 340e3)
    assert en1992_punching.concrete_resistance(30.0, 345.0, rho) == pytest.approx(0.44814, abs=5e-6)
    assert en1992_punching.largest_resistance(30.0) == pytest.approx(4.224, rel=1e-12)


def test_resistance_agrees_with_structuralcodes() -> None:
    """6.2.2(1) has the resistance of 6.4.4(1): k, ρl, CRd,c and vmin."""
    draw = np.random.default_rng(1)
    for fck, d, rho in zip(
        draw.uniform(20, 50, 50), draw.uniform(120, 900, 50), draw.uniform(0.001, 0.03, 50), strict=True
    ):
        theirs = shear.VRdc(fck, d, rho * 1000.0 * d, 1000.0, 0.0, 1e6, fck / 1.5) / (1000.0 * d)
        assert en1992_punching.concrete_resistance(fck, d, rho) == pytest.approx(theirs, rel=1e-12)


def test_interior_column_has_the_modulus_of_equation_6_41() -> None:
    one = eurocode(rectangle(0.0, (C1, C2)))
    expected = C1**2 / 2 + C1 * C2 + 4 * C2 * D + 16 * D**2 + 2 * np.pi * D * C1
    assert one.basic.pieces.modulus(1.0) == pytest.approx(expected, rel=1e-12)
    beta = numbers(one, 800e3, 60e6)["beta"]
    k = en1992_punching.moment_part(C1 / C2)
    assert beta == pytest.approx(1 + k * 60e6 / 800e3 * one.basic.pieces.length / expected, rel=1e-12)


@settings(deadline=None)
@given(st.floats(0.0, 2 * np.pi))
def test_circular_column_has_beta_of_equation_6_42_about_any_axis(angle: float) -> None:
    diameter, e = 400.0, 90.0
    beta = numbers(eurocode(Column((0j,), diameter / 2)), 500e3, 500e3 * e * np.exp(1j * angle))["beta"]
    assert beta == pytest.approx(1 + 0.6 * np.pi * e / (diameter + 4 * D), rel=1e-12)


def test_edge_column() -> None:
    """Figures 6.15 and 6.20(a), Equations (6.44) and (6.45), 6.4.5(3)."""
    one = eurocode(rectangle(C1 / 2, (C1, C2)), shapely.box(0, -10e3, 20e3, 10e3))
    u1 = 2 * C1 + C2 + 2 * np.pi * D
    assert one.basic.pieces.length == pytest.approx(u1, rel=1e-12)
    assert one.face_length == pytest.approx(min(C2 + 3 * D, C2 + 2 * C1), rel=1e-12)
    reduced = C2 + 2 * min(1.5 * D, 0.5 * C1) + 2 * np.pi * D
    modulus = C2**2 / 4 + C1 * C2 + 4 * C1 * D + 8 * D**2 + np.pi * D * C2
    k = en1992_punching.moment_part(C1 / (2 * C2))
    inward_and_along = numbers(one, 400e3, 30e6 + 20e6j)["beta"]
    assert inward_and_along == pytest.approx(u1 / reduced + k * 20e6 / 400e3 * u1 / modulus, rel=1e-12)
    assert numbers(one, 400e3, -1e6)["beta"] == pytest.approx(u1 / reduced, rel=1e-12)
    across = one.basic.pieces.modulus(1.0)
    part = en1992_punching.moment_part(C1 / C2) * 300e6 / 400e3 * u1 / across
    assert numbers(one, 400e3, -300e6)["beta"] == pytest.approx(1 + part, rel=1e-12)


def test_column_away_from_the_edge_has_no_reduced_perimeter() -> None:
    """6.4.2(5): beyond d from the edge, β without a moment is 1, though the perimeter still ends at the edge."""
    one = eurocode(rectangle(C1 / 2 + 1.2 * D, (C1, C2)), shapely.box(0, -10e3, 20e3, 10e3))
    assert len(one.basic.normals) == 1
    assert numbers(one, 400e3)["beta"] == 1.0
    assert one.face_length == pytest.approx(2 * (C1 + C2))


def test_corner_column() -> None:
    """Figures 6.15 and 6.20(b), Equation (6.46)."""
    one = eurocode(rectangle(C1 / 2 + 0.5j * C2, (C1, C2)), shapely.box(0, 0, 20e3, 20e3))
    u1 = C1 + C2 + np.pi * D
    assert one.basic.pieces.length == pytest.approx(u1, rel=1e-12)
    assert one.face_length == pytest.approx(min(3 * D, C1 + C2), rel=1e-12)
    reduced = min(1.5 * D, 0.5 * C1) + min(1.5 * D, 0.5 * C2) + np.pi * D
    assert numbers(one, 300e3, 10e6 + 5e6j)["beta"] == pytest.approx(u1 / reduced, rel=1e-12)


def test_perimeter_ends_at_an_edge_only_where_that_is_shorter() -> None:
    full = 2 * (C1 + C2) + 4 * np.pi * D
    for apart in (200.0, 600.0, 900.0, 1500.0):
        one = eurocode(rectangle(apart + C1 / 2, (C1, C2)), shapely.box(0, -10e3, 20e3, 10e3))
        to_edge = 2 * (apart + C1) + C2 + 2 * np.pi * D
        assert one.basic.pieces.length == pytest.approx(min(full, to_edge), rel=1e-12)
        assert len(one.basic.normals) == (to_edge < full)


def test_opening_takes_the_sector_between_its_tangents() -> None:
    """6.4.2(3): the sector cuts the straight side of the perimeter; beyond 6d the opening has no effect."""
    b = 400.0
    for gap, near in ((900.0, True), (1600.0, False)):
        hole = shapely.box(b / 2 + gap, -100.0, b / 2 + gap + 200.0, 100.0)
        one = eurocode(rectangle(0.0, (b, b)), WIDE.difference(hole))
        lost = 2 * (b / 2 + 2 * D) * 100.0 / (b / 2 + gap) if near else 0.0
        assert one.basic.pieces.length == pytest.approx(4 * b + 4 * np.pi * D - lost, rel=1e-9)


def test_long_opening_counts_with_the_width_of_figure_6_14() -> None:
    b, far, wide, long = 400.0, 1000.0, 100.0, 400.0
    hole = shapely.box(far - long / 2, -wide / 2, far + long / 2, wide / 2)
    one = eurocode(rectangle(0.0, (b, b)), WIDE.difference(hole))
    half = 0.5 * np.sqrt(wide * long) / (far - long / 2)
    assert one.basic.pieces.length == pytest.approx(4 * b + 4 * np.pi * D - 2 * half * (b / 2 + 2 * D), rel=1e-9)


def test_opening_around_the_column_is_refused() -> None:
    ring = shapely.box(-900, -900, 900, 900).difference(shapely.box(-300, -901, 300, 600))
    with pytest.raises(InputError, match="straight"):
        _ = eurocode(rectangle(0.0, (400.0, 400.0)), WIDE.difference(ring)).basic


def test_links_and_outer_perimeter() -> None:
    """Equations (6.52) and (6.54) by hand."""
    one = eurocode(rectangle(0.0, (400.0, 400.0)), given=1.15)
    found = numbers(one, 900e3)
    v_rd_c = en1992_punching.concrete_resistance(30.0, D, 0.005)
    v_ed, effective = 1.15 * 900e3 / (found["u1"] * D), min(250 + 0.25 * D, 500 / 1.15)
    assert found["asw"] == pytest.approx((v_ed - 0.75 * v_rd_c) * found["u1"] / (1.5 * effective), rel=1e-12)
    assert found["uout"] == pytest.approx(1.15 * 900e3 / (v_rd_c * D), rel=1e-12)
    assert numbers(one, 300e3)["asw"] == 0.0


def test_footing_is_governed_by_the_worst_perimeter() -> None:
    """6.4.4(2) with uniform pressure: the governing distance lies between the face and 2d."""
    column, pressure = rectangle(0.0, (400.0, 400.0)), 0.3
    one = eurocode(column, on_foundation=True, given=1.0)
    resistance = en1992_punching.concrete_resistance(30.0, D, 0.005)
    force, distances = pressure * 2000.0**2, [perimeter.distance for perimeter in one.perimeters]
    inside = pressure * np.array([400.0**2 + 1600.0 * a + np.pi * a**2 for a in distances])
    found = one.numbers(np.array([force]), np.zeros(1, np.complex128), inside[None])
    by_hand = [
        (force - taken) / ((1600.0 + 2 * np.pi * a) * D) / (resistance * 2 * D / a)
        for a, taken in zip(distances, inside, strict=True)
    ]
    assert found["v_ed"][0] / found["v_rd_c"][0] == pytest.approx(max(by_hand), rel=1e-12)
    assert 0 < int(np.argmax(by_hand)) < len(by_hand) - 1


def test_footing_is_checked_with_and_without_its_edges() -> None:
    one = eurocode(rectangle(0.0, (400.0, 400.0)), shapely.box(-1e3, -1e3, 1e3, 1e3), on_foundation=True)
    at_2d = [perimeter for perimeter in one.perimeters if perimeter.distance == 2 * D]
    assert {len(perimeter.normals) for perimeter in at_2d} == {0, 1, 2}


def critical(column: Column, slab: shapely.Polygon = WIDE) -> aci318.Punching:
    return aci318.Punching(Plan.of(column, rings(slab), 4.0 * 300.0), (D, D), 30.0, 420.0)


def test_interior_column_of_aci_318() -> None:
    """R8.4.4.2.3: Jc of an interior column in closed form, both axes."""
    one, b1, b2 = critical(rectangle(0.0, (C1, C2))), C1 + D, C2 + D
    bo = 2 * (b1 + b2)
    about_y = D * b1**3 / 6 + b1 * D**3 / 6 + D * b2 * b1**2 / 2
    about_x = D * b2**3 / 6 + b2 * D**3 / 6 + D * b1 * b2**2 / 2
    assert one.basic.pieces.inertia(1.0, D) == pytest.approx(about_y, rel=1e-12)
    part, other = aci318.shear_part(b1, b2), aci318.shear_part(b2, b1)
    expected = 800e3 / (bo * D) + part * 50e6 * b1 / 2 / about_y + other * 20e6 * b2 / 2 / about_x
    assert numbers(one, 800e3, 50e6 + 20e6j)["v_ed"] == pytest.approx(expected, rel=1e-12)


def test_edge_column_of_aci_318() -> None:
    """The moment acts about the centroid of the critical section; Jc of ACI 421.1R plus the faces' own inertia."""
    one = critical(rectangle(C1 / 2, (C1, C2)), shapely.box(0, -10e3, 20e3, 10e3))
    b1, b2 = C1 + D / 2, C2 + D
    bo, away = 2 * b1 + b2, b1**2 / (2 * b1 + b2)  # centroid from the inner face
    inertia = D * (2 * (b1**3 / 12 + b1 * (b1 / 2 - away) ** 2) + b2 * away**2) + 2 * b1 * D**3 / 12
    assert one.basic.pieces.length == pytest.approx(bo, rel=1e-12)
    moment = 60e6 - 300e3 * (b1 - away - C1 / 2)
    shear = aci318.shear_part(b1, b2) * moment / inertia
    expected = 300e3 / (bo * D) + max(shear * away, -shear * (b1 - away))
    assert numbers(one, 300e3, 60e6)["v_ed"] == pytest.approx(expected, rel=1e-12)


def test_table_22_6_5_2() -> None:
    """Each of the three formulas governs in turn; λs below 1 for d above 250 mm."""
    assert aci318.concrete_resistance(25.0, 200.0, 2400.0, 1.0, 40.0) == pytest.approx(0.33 * 5)
    assert aci318.concrete_resistance(25.0, 200.0, 2400.0, 4.0, 40.0) == pytest.approx(0.17 * 1.5 * 5)
    assert aci318.concrete_resistance(25.0, 200.0, 8000.0, 1.0, 20.0) == pytest.approx(0.083 * 2.5 * 5)
    assert aci318.concrete_resistance(25.0, 750.0, 9000.0, 1.0, 40.0) == pytest.approx(0.33 * 5 * np.sqrt(0.5))


def test_the_worse_of_two_perimeters_governs_beside_an_edge() -> None:
    """A perimeter to an edge 3 d away is shorter but takes off more load than the perimeter around the column."""
    slab = shapely.box(-C1 / 2 - 3 * D, -10e3, 10e3, 10e3)
    one = eurocode(rectangle(0.0, (C1, C2)), slab)
    around, to_edge = one.perimeters
    found = one.numbers(np.array([500e3]), np.array([0j]), np.array([[20e3, 150e3]]))
    assert to_edge.pieces.length < around.pieces.length
    assert found["v_ed"][0] == pytest.approx(480e3 / (around.pieces.length * D), rel=1e-12)


def test_links_beyond_a_raft_perimeter_need_the_resistance_without_enhancement() -> None:
    """uout = β V / (vRd,c d) with vRd,c of Eq. (6.47) and V without the pressure inside; absent without links."""
    one = eurocode(rectangle(0.0, (C1, C2)), given=1.0, on_foundation=True)
    found = numbers(one, 3000e3)
    own = en1992_punching.concrete_resistance(30.0, D, 0.005)
    assert found["uout"] == pytest.approx(3000e3 / (own * D), rel=1e-12)
    assert np.isnan(numbers(one, 100e3)["uout"])


@settings(deadline=None)
@given(
    st.floats(0.0, 360.0),
    st.complex_numbers(max_magnitude=1e5, allow_nan=False),
    st.sampled_from([0.0, 150.0, 700.0]),
    st.sampled_from([0.0, 600.0, 5e3]),
    st.booleans(),
)
def test_no_number_depends_on_position_and_rotation(
    angle: float, shift: complex, left: float, below: float, american: bool
) -> None:
    """Column near an edge or a corner, with an opening."""
    slab = shapely.box(-C1 / 2 - left, -C2 / 2 - below, 10e3, 10e3).difference(shapely.box(900, 100, 1300, 500))
    turn = np.exp(1j * np.radians(angle))
    moved = shapely.transform(slab, lambda xy: np.column_stack(_parts(shift + turn * (xy @ [1, 1j]))))
    make = critical if american else eurocode
    here = make(rectangle(0.0, (C1, C2)), slab)
    there = make(rectangle(shift, (C1, C2), angle), moved)
    moment = 30e6 + 12e6j
    first, second = numbers(here, 500e3, moment), numbers(there, 500e3, moment * turn)
    assert second == pytest.approx(first, rel=1e-6, nan_ok=True)


@st.composite
def plans(draw: st.DrawFn) -> tuple[Column, shapely.Polygon]:
    """A column with one to four near edges and an opening or notch of any place, or without."""
    sides = draw(st.tuples(*[st.sampled_from([200.0, 300.0, 400.0, 900.0])] * 2))
    column = rectangle(0.0, sides) if draw(st.booleans()) else Column((0j,), sides[0] / 2)
    gaps = draw(st.tuples(*[st.sampled_from([0.0, 50.0, 150.0, 249.0, 251.0, 400.0, 700.0, 1500.0, 9e3])] * 4))
    x0, y0, x1, y1 = (gap - column.extent(way)[0] for gap, way in zip(gaps, (1, 1j, -1, -1j), strict=True))
    slab = shapely.box(-x0, -y0, x1, y1)
    x, y, b, h = draw(st.tuples(*[st.integers(-1500, 1500)] * 2, *[st.integers(50, 900)] * 2))
    void = shapely.box(x, y, x + b, y + h)
    if draw(st.booleans()):
        void = void.difference(shapely.box(x + b / 2, y + h / 2, x + b, y + h))
    around = shapely.MultiPoint(shapely.points(np.column_stack(_parts(np.array(column.corners))))).convex_hull
    if shapely.distance(void, around) > column.radius + 5.0 and (left := slab.difference(void)).geom_type == "Polygon":
        slab = left
    return column, slab


@settings(deadline=None, max_examples=25, phases=[Phase.generate])
@given(
    plans(),
    st.tuples(st.integers(-90, 90), st.integers(-90, 90), st.sampled_from([500e3, -500e3, 1.0, 0.0])),
    st.sampled_from(["floor", "raft", "ACI"]),
    st.floats(0.0, 360.0),
)
def test_mirrored_and_turned_plans_have_the_same_numbers(plan, loads, kind: str, angle: float) -> None:
    (column, slab), (mx, my, force) = plan, loads
    turn = np.exp(1j * np.radians(angle))

    def found(mirrored: bool) -> dict[str, float] | str:
        def moved(z: np.ndarray) -> np.ndarray:
            return turn * np.conj(z) + 3e3 + 2e3j if mirrored else z

        corners = moved(np.array(column.corners))[:: -1 if mirrored else 1]
        own = Column(tuple(map(complex, corners)), column.radius)
        around = shapely.transform(slab, lambda xy: np.column_stack(_parts(moved(xy @ [1, 1j]))))
        moment = 1e6 * (turn * complex(mx, -my) if mirrored else complex(mx, my))
        try:
            one = critical(own, around) if kind == "ACI" else eurocode(own, around, on_foundation=kind == "raft")
            return numbers(one, force, moment)
        except InputError as error:
            return error.message

    first, second = found(False), found(True)
    assert second == (first if isinstance(first, str) else pytest.approx(first, rel=1e-6, nan_ok=True))


@settings(deadline=None, max_examples=25, phases=[Phase.generate])
@given(plans())
def test_lengths_agree_with_samples_of_each_perimeter(plan) -> None:
    """Every millimetre of the closed line is in the slab, seen from the column, and in no sector of an opening."""
    column, slab = plan
    try:
        every = eurocode(column, slab).perimeters
    except InputError:
        return
    sides = [shapely.LineString(pair) for ring in rings(slab) for pair in zip(ring, np.roll(ring, -1, 0), strict=True)]
    for one in every:
        lengths = np.array(one.whole.lengths)
        counts = np.maximum(np.round(lengths), 4).astype(int)
        points = [one.whole.pick(np.array([i])).at((np.arange(n) + 0.5) / n)[0] for i, n in enumerate(counts)]
        weights, z = np.concatenate([[b / n] * n for b, n in zip(lengths, counts, strict=True)]), np.concatenate(points)
        near = np.abs(z) < 8e3
        z, weights = z[near], weights[near]
        start, stop = 1e-6 * z, (1 + 1e-6) * z
        sights = shapely.linestrings(
            np.stack([[start.real, stop.real], [start.imag, stop.imag]], axis=-1).swapaxes(0, 1)
        )
        seen = ~np.any([shapely.intersects(sights, side) for side in sides], axis=0)
        for hole in slab.interiors:
            if shapely.distance(hole, shapely.MultiPoint(column_points(column)).convex_hull) <= 6 * D + column.radius:
                first, last = Plan.of(column, rings(slab), 6 * D, widened=True).sector(shapely.Polygon(hole))
                seen &= np.angle(z / first) % (2 * np.pi) >= np.angle(last / first) % (2 * np.pi)
        seen &= shapely.contains_xy(slab, stop.real, stop.imag)
        assert one.pieces.length == pytest.approx(weights[seen].sum(), abs=20.0)


def column_points(column: Column) -> list[tuple[float, float]]:
    return [(z.real, z.imag) for z in column.corners]


@pytest.mark.parametrize("make", [eurocode, critical])
def test_stress_is_continuous_where_the_force_vanishes(make) -> None:
    for column in (rectangle(0.0, (400.0, 400.0)), Column((0j,), 200.0)):
        none, little = (numbers(make(column), force, 100e6) for force in (0.0, 1e-3))
        assert np.isnan(none["beta"])
        assert none["v_ed"] == pytest.approx(little["v_ed"], rel=1e-6) and none["utilisation"] > 0.1


def test_column_in_a_strip_has_perimeters_across_it() -> None:
    for width, u1 in ((600.0, 1200.0), (1200.0, 2400.0)):
        one = eurocode(rectangle(0.0, (300.0, 300.0)), shapely.box(-10e3, -width / 2, 10e3, width / 2))
        assert one.basic.pieces.length == pytest.approx(u1, rel=1e-9)


def test_end_of_a_strip_is_refused() -> None:
    with pytest.raises(InputError, match="one-way shear"):
        _ = eurocode(rectangle(0.0, (300.0, 300.0)), shapely.box(-200, -300, 10e3, 300)).perimeters


def test_largest_stress_of_aci_318_is_of_either_sign() -> None:
    """Edge column, 30 kN and 80 kNm inward: the stress at the free edge is negative and larger."""
    one = critical(rectangle(0.0, (400.0, 400.0)), shapely.box(-200, -10e3, 10e3, 10e3))
    assert numbers(one, 30e3, 80e6)["v_ed"] == pytest.approx(0.64292, rel=1e-4)


def _parts(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return z.real, z.imag
