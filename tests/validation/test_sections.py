"""Forces through sections and mean moments of strips, against closed forms."""

import math

import numpy as np
import pytest

from signorini import Model, solve

CONCRETE = {"E": 30e9, "nu": 0.2}


def solved(supports, loads, plate=None, mesh=None, **asked):
    model = Model(
        material=CONCRETE,
        plate={"shape": "rectangle", "size": [8, 6], "thickness": 0.2} | (plate or {}),
        mesh=mesh or {"divisions": [10, 8]},
        support=supports,
        load=loads,
        **asked,
    )
    return solve(model)["all"]


def across(*abscissae, top=6.0):
    return [{"line": [[x, 0], [x, top]]} for x in abscissae]


WALLS = [{"edge": ["left", "right"], "fix": "simple"}]


@pytest.mark.parametrize(("element", "thickness"), [("mitc9", 0.5), ("mitc9", 2e-4), ("q8r", 0.5), ("q8r", 0.02)])
def test_a_cantilever_has_p_times_l_however_thin(element, thickness):
    """At the clamped edge, along mesh lines, and across elements; the free edge has none."""
    lines = [*across(0.0, 4.0, 8.0), {"line": [[3.3, 0], [3.3, 3], [3.3, 6]]}]
    plate = {"thickness": thickness, "element": element}
    sections = solved([{"edge": "left", "fix": "clamped"}], [{"line_load": 1e3, "edge": "right"}], plate, section=lines)
    moments, shears = ([getattr(one, key) for one in sections.sections] for key in ("moment", "shear"))
    assert moments == pytest.approx([-48e3, -24e3, 0.0, -28.2e3], abs=48e3 * 1e-9)
    assert shears == pytest.approx([6e3] * 4, rel=1e-9)


def test_one_way_span_has_an_eighth_of_q_l_squared():
    sections = solved(WALLS, [{"pressure": 2e3}], section=across(4.0, 2.1)).sections
    assert [one.moment for one in sections] == pytest.approx([2e3 * 8**2 / 8 * 6, 6 * (8e3 * 2.1 - 1e3 * 2.1**2)])
    assert [one.shear for one in sections] == pytest.approx([0.0, 2e3 * 6 * 1.9], abs=1e-6)


@pytest.mark.parametrize(("divisions", "error"), [((8, 8), 1.2e-3), ((16, 16), 1.6e-4)])
def test_a_square_on_hard_edges_has_naviers_moments_along_its_middle(divisions, error):
    """∫ mx dy at x = a/2 of w = Σ 16q/π⁶D sin(mπx/a) sin(nπy/a)/mn(m² + n²)²/a⁴ (Timoshenko 1959, article 30)."""
    a, q, nu = 6.0, 1e4, 0.2
    m, n = np.meshgrid(*2 * [np.arange(1, 400, 2)], indexing="ij")
    terms = (m**2 + nu * n**2) / (m * n * (m**2 + n**2) ** 2) * np.sin(m * np.pi / 2)
    half = (1 - np.cos(n * np.pi / 2)) * a / (n * np.pi)
    plate = {"size": [a, a], "thickness": 0.02}
    lines = [*across(a / 2), {"line": [[a / 2, 0], [a / 2, a / 2]]}, {"line": [[a / 2, a / 2], [a / 2, a]]}]
    supports = [{"edge": ["left", "right", "bottom", "top"], "fix": "hard"}]
    whole, *halves = solved(supports, [{"pressure": q}], plate, {"divisions": divisions}, section=lines).sections
    exact = 16 * q * a**2 / np.pi**4 * (terms * 2 * half).sum()
    assert whole.moment == pytest.approx(exact, rel=error)
    assert [one.moment for one in halves] == pytest.approx([exact / 2] * 2, rel=error)
    assert sum(one.moment for one in halves) == pytest.approx(whole.moment, rel=1e-12)


def test_a_disc_has_its_closed_form_across_a_diameter():
    """mφ = q/16 ((3 + ν)a² − (1 + 3ν)r²) on a simply supported rim (Timoshenko, Woinowsky-Krieger 1959, article 16)."""
    plate = {"shape": "disc", "radius": 3, "thickness": 0.1}
    model = Model(
        material=CONCRETE,
        plate=plate,
        mesh={"divisions": [8, 32]},
        support=[{"edge": "rim", "fix": "simple"}],
        load=[{"pressure": 10.0}],
        section=[{"line": [[-3, 0], [3, 0]]}, {"line": [[0, -2], [0, 2]]}],
    )
    whole, part = solve(model)["all"].sections
    by_hand = [2 * 10 / 16 * ((3 + 0.2) * 9 * r - (1 + 0.6) * r**3 / 3) for r in (3, 2)]
    assert [whole.moment, part.moment] == pytest.approx(by_hand, rel=5e-4)
    assert [whole.length, part.length] == pytest.approx([6.0, 4.0])
    assert [whole.shear, part.shear] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_soil_that_balances_the_load_point_by_point_bends_nothing():
    soil = [{"area": "all", "resists": "down", "stiffness": 2e7}]
    lines = [{"line": [[0, 1], [8, 4.3]]}, *across(3.3), {"line": [[1, 1], [5.5, 4.3]]}]
    for one in solved(soil, [{"pressure": 2e3}], section=lines, mesh={"size": 0.7}).sections:
        assert [one.moment, one.twist, one.shear] == pytest.approx([0.0, 0.0, 0.0], abs=1e-7)


@pytest.mark.parametrize("zoned", [False, True])
def test_along_the_border_of_a_zone_the_moment_is_one(zoned):
    """The section runs where the thickness jumps to two and a half times as much, the others beside it."""
    zones = [{"area": {"rectangle": [4, 0, 8, 6]}, "thickness": 0.5}] if zoned else []
    sections = solved(WALLS, [{"pressure": 2e3}], section=across(3.999, 4.0, 4.001), zone=zones).sections
    moments = [one.moment for one in sections]
    assert moments[1] == pytest.approx(2e3 * 8**2 / 8 * 6, rel=1e-12)
    assert moments == pytest.approx([moments[1]] * 3, rel=1e-6)


def test_what_acts_on_the_line_counts_half_on_either_side():
    """A wall of bearings under the section, a force on it, and a line load along it."""
    supports = [*WALLS, {"name": "columns", "at": [[4, 1], [4, 3], [4, 5]]}]
    loads = [
        {"pressure": 2e3},
        {"force": 5e3, "at": [4, 2]},
        {"pressure": 3e3, "area": {"rectangle": [0, 0, 3, 6]}},
        {"line_load": 700.0, "line": [[4, 0], [4, 6]]},
    ]
    result = solved(supports, loads, section=across(3.9, 4.0, 4.1))
    before, on, after = (one.shear for one in result.sections)
    carried = result.reactions["columns"] - 5e3 - 700 * 6
    assert after - before == pytest.approx(carried - 2e3 * 6 * 0.2)
    assert on == pytest.approx(0.5 * (before + after), abs=1e-9 * abs(carried))


def test_a_ring_of_lines_around_a_column_carries_what_is_not_on_it():
    corners = [[2.5, 2.6], [3.7, 2.6], [3.7, 3.9], [2.5, 3.9], [2.5, 2.6]]
    supports = [*WALLS, {"name": "column", "at": [3.1, 3.2], "patch": [0.3, 0.3]}]
    lines = [{"line": corners}, {"line": corners[::-1]}]
    result = solved(supports, [{"pressure": 1e4}], section=lines)
    carried = result.reactions["column"] - 1e4 * 1.2 * 1.3
    assert [one.shear for one in result.sections] == pytest.approx([carried, -carried], rel=1e-12)
    assert result.sections[0].moment == pytest.approx(result.sections[1].moment)


def test_a_section_through_an_opening_has_what_is_left_of_the_plate():
    plate = {"holes": [{"rectangle": [3, 2, 5, 4]}, {"circle": {"center": [1.5, 3], "radius": 0.5}}]}
    result = solved(WALLS, [{"line_load": 1e3, "line": [[6, 0], [6, 6]]}], plate, {"size": 0.6}, section=across(1.5, 4))
    assert [one.length for one in result.sections] == pytest.approx([5.0, 4.0], rel=1e-3)
    assert [one.shear for one in result.sections] == pytest.approx([1e3 * 6 * 2 / 8] * 2, rel=1e-9)
    assert [one.moment for one in result.sections] == pytest.approx([1500 * 1.5, 1500 * 4], rel=1e-9)


def test_strips_of_a_flat_slab_have_the_total_static_moment():
    """An inner panel has M₀ = q l₂ l₁²/8 between the middles of supports at points (Nichols, Trans. ASCE 77, 1914)."""
    q, spans = 10e3, (6.0, 5.0)
    supports = [
        {"at": [[0, 0], [6, 0], [0, 5], [6, 5]]},
        {"edge": ["left", "right", "bottom", "top"], "fix": "symmetry"},
    ]
    strips = [
        {"name": "column, below", "line": [[0, 0.625], [6, 0.625]], "width": 1.25},
        {"name": "middle", "line": [[0, 2.5], [6, 2.5]], "width": 2.5},
        {"name": "column, above", "line": [[0, 4.375], [6, 4.375]], "width": 1.25},
    ]
    result = solved(supports, [{"pressure": q}], {"size": spans}, {"divisions": [12, 10]}, strip=strips)

    def total(station):
        return sum(strip.stations[station].moment * strip.stations[station].width for strip in result.strips)

    static = q * spans[1] * spans[0] ** 2 / 8
    assert total(10) - 0.5 * (total(0) + total(-1)) == pytest.approx(static, rel=1e-9)
    below = result.strips[0]
    # The column strip has about three quarters of the hogging and three fifths of the sagging (EN 1992-1-1, annex I).
    assert 0.6 < 2 * 1.25 * below.stations[0].moment / total(0) < 0.8
    assert 0.5 < 2 * 1.25 * below.sagging.moment / total(10) < 0.7
    assert below.sagging.at == pytest.approx((3.0, 0.625))
    assert below.hogging.at[0] in (0.0, 6.0)


def test_the_mean_over_a_strip_settles_where_the_moment_over_a_column_does_not():
    """Over a support at a point the moment grows as log h, its mean over two metres has a limit."""
    means, peaks = [], []
    for divisions in (8, 16, 32):
        supports = [*WALLS, {"at": [4, 3]}]
        strip = [{"line": [[2, 3], [6, 3]], "width": 2.0, "stations": 3}]
        mesh = {"divisions": [divisions, divisions]}
        result = solved(supports, [{"pressure": 1e4}], {"size": [8, 6]}, mesh, strip=strip, probe=[{"at": [4, 3]}])
        means.append(result.strips[0].hogging.moment)
        peaks.append(result.probes[0].moment[0])
    assert abs(means[2] - means[1]) < 0.003 * abs(means[2])
    assert abs(means[2] - means[0]) < 0.003 * abs(means[2])
    assert abs(peaks[2] - peaks[1]) > 0.1 * abs(peaks[1])


@pytest.mark.parametrize("angle", [0.0, 20.0, 67.0])
def test_parts_of_a_line_converge_to_what_is_there_and_add_up(angle):
    """Ends inside the plate, wherever they are in an element, beside a mesh four times as fine."""
    along = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    a, m, b = (np.array([4.05, 2.9]) + s * along for s in (-1.7, -0.3, 1.9))
    lines = [{"line": [p.tolist(), q.tolist()]} for p, q in ((a, m), (m, b), (a, b))]
    clamped = [{"edge": ["left", "right", "bottom", "top"], "fix": "clamped"}]
    load = [{"pressure": 1e4}, {"pressure": 2e4, "area": {"rectangle": [1, 1, 4, 3]}}]
    found = [solved(clamped, load, mesh={"divisions": [8 * n, 6 * n]}, section=lines).sections for n in (1, 2, 8)]
    for number, error in (("moment", 0.01), ("twist", 0.02), ("shear", 0.02)):
        coarse, fine, best = (np.array([getattr(one, number) for one in sections]) for sections in found)
        size = max(abs(getattr(one, key)) for one in found[2] for key in (number, "moment"))
        assert np.abs(fine - best).max() < error * size
        assert np.abs(fine - best).max() < max(0.75 * np.abs(coarse - best).max(), 1e-3 * size)
        assert fine[0] + fine[1] == pytest.approx(fine[2], abs=1e-9 * size)


@pytest.mark.parametrize("length", [0.03, 0.2, 0.45, 1.3])
def test_a_line_shorter_than_an_element_has_what_is_there(length):
    """To a hundredth of an element's value, for any begin and end in elements 0.8 × 0.75 large."""
    begin = np.linspace(1.0, 2.0, 9)
    model = Model(
        material={"E": 30e9, "nu": 0.0},
        plate={"shape": "rectangle", "size": [8, 6], "thickness": 0.2},
        mesh={"divisions": [10, 8]},
        support=WALLS,
        load=[{"pressure": 2e3}],
        strip=[{"line": [[2.1, y + length / 2], [3.3, y + length / 2]], "width": length, "stations": 2} for y in begin],
    )
    for strip in solve(model)["all"].strips:
        for station in strip.stations:
            x, part = station.at[0], max(0.75, length) / length
            assert station.moment == pytest.approx(8e3 * x - 1e3 * x**2, rel=8e-3 * part)
            assert station.shear == pytest.approx(2e3 * (4 - x), rel=8e-3 * part)
