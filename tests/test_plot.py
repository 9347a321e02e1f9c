import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from signorini.errors import InputError
from signorini.plot import (
    BalanceMark,
    LoadMark,
    PressureLayer,
    SupportMark,
    check_picture,
    contour,
    deflection_picture,
    line,
    pressure,
    pressure_picture,
    save,
    supports,
)
from signorini.shapes.tessellation import tessellate

# A square whose right edge bulges, and its neighbour on the left.
POINTS = np.array(
    [
        [0, 0],
        [1, 0],
        [1, 1],
        [0, 1],
        [-1, 0],
        [-1, 1],
        [0.5, 0],
        [1.2, 0.5],
        [0.5, 1],
        [0, 0.5],
        [-0.5, 0],
        [-1, 0.5],
        [-0.5, 1],
    ]
)
ELEMENTS = np.array([[0, 1, 2, 3, 6, 7, 8, 9], [3, 5, 4, 0, 12, 11, 10, 9]])
PADS = SupportMark("pads", "down", np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), np.array([True, False, True]))


def colour_limits(values: np.ndarray) -> tuple[str, float, float]:
    bands = contour(POINTS, ELEMENTS, values).collections[0]
    return bands.cmap.name, round(bands.norm.vmin, 12), round(bands.norm.vmax, 12)


def area(vertices: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    return float(np.sum(ux * vy - uy * vx) / 2)


def test_triangles_meet_on_shared_edges_and_follow_curved_ones() -> None:
    cut = tessellate(ELEMENTS, divisions=4)
    vertices = cut.interpolate(POINTS)
    assert len(vertices) == 2 * 5 * 5 - 5
    assert len(np.unique(vertices.round(12), axis=0)) == len(vertices)
    assert int(cut.outer.sum()) == 6
    assert vertices[:, 0].max() == 1.2


def test_finer_triangles_fill_the_curved_outline_with_second_order() -> None:
    exact = 2 + 2 / 3 * 0.2  # the bulge is a parabola of height 0.2 on a chord of 1
    errors = []
    for divisions in (4, 8):
        cut = tessellate(ELEMENTS, divisions)
        errors.append(exact - area(cut.interpolate(POINTS), cut.triangles))
    assert errors[0] / errors[1] == pytest.approx(4, rel=1e-6)


def test_all_eight_nodes_are_vertices_of_even_the_coarsest_triangles() -> None:
    vertices = tessellate(ELEMENTS, divisions=2).interpolate(POINTS)
    for node in POINTS:
        assert np.abs(vertices - node).sum(axis=1).min() < 1e-14


def test_a_large_mesh_is_cut_least() -> None:
    many = np.arange(20_000)[:, None] * 8 + np.arange(8)
    assert len(tessellate(many).triangles) == 8 * len(many)


def test_colours_diverge_about_zero_only_where_both_signs_occur() -> None:
    rising = POINTS[:, 0] + 1
    assert colour_limits(rising - 1) == ("RdBu", -1.2, 1.2)
    assert colour_limits(rising)[:2] == ("YlGnBu", 0)
    assert colour_limits(-rising)[::2] == ("YlOrRd_r", 0)


def test_rounding_below_zero_is_not_uplift() -> None:
    assert colour_limits(POINTS[:, 0] + 1 - 1e-15)[:2] == ("YlGnBu", 0)


@pytest.mark.parametrize("constant", [0.0, 5.0, -1e-9])
def test_a_constant_field_can_be_drawn(constant: float) -> None:
    axes = contour(POINTS, ELEMENTS, np.full(13, constant))
    axes.figure.draw_without_rendering()


def test_contours_go_to_given_axes_with_equal_scales() -> None:
    mine = Figure().add_subplot()
    axes = contour(POINTS, ELEMENTS, POINTS[:, 0], ax=mine, label="deflection [mm]", title="ULS", levels=[-1, 0, 1.2])
    assert axes is mine
    assert axes.get_aspect() == 1
    assert axes.get_title() == "ULS"
    assert mine.figure.axes[1].get_ylabel() == "deflection [mm]"


@pytest.mark.parametrize(
    ("values", "words"), [(np.zeros(4), r"shape \(4,\)"), (np.full(13, np.nan), "13 of 13 values .* not finite")]
)
def test_a_field_that_cannot_be_drawn_is_refused(values: np.ndarray, words: str) -> None:
    with pytest.raises(InputError, match=words):
        contour(POINTS, ELEMENTS, values)


def test_a_mesh_of_other_elements_is_refused() -> None:
    with pytest.raises(InputError, match=r"\(2, 4\)"):
        contour(POINTS, ELEMENTS[:, :4], np.zeros(13))


def test_closed_points_are_filled_and_open_ones_hollow() -> None:
    axes = supports([PADS], Figure().add_subplot())
    closed, opened = axes.lines
    np.testing.assert_array_equal(closed.get_xydata(), PADS.positions[[0, 2]])
    np.testing.assert_array_equal(opened.get_xydata(), PADS.positions[[1]])
    assert closed.get_markerfacecolor() != "white"
    assert opened.get_markerfacecolor() == "white"


@pytest.mark.parametrize(("kind", "marker"), [("down", "^"), ("up", "v"), ("both", "s")])
def test_the_mark_shows_which_way_a_support_acts(kind: str, marker: str) -> None:
    axes = supports([SupportMark("s", kind, PADS.positions)], Figure().add_subplot())
    assert axes.lines[0].get_marker() == marker


def test_a_support_that_acts_nowhere_stands_in_the_legend() -> None:
    idle = SupportMark("idle", "down", np.zeros((0, 2)), np.zeros(0, dtype=bool))
    axes = supports([idle], Figure().add_subplot())
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["idle: pushes up only, 0 closed, 0 open"]


def test_the_legend_counts_closed_and_open_below_the_axes() -> None:
    wall = SupportMark("wall", "fixed", np.array([[0, 0], [0, 1.0]]), style="line")
    figure = deflection_picture(POINTS, ELEMENTS, POINTS[:, 0], [PADS, wall], title="ULS", length="m")
    axes = figure.axes[0]
    figure.draw_without_rendering()
    legend = axes.get_legend()
    words = [entry.get_text() for entry in legend.get_texts()]
    assert words == ["pads: pushes up only, 2 closed, 1 open", "wall: fixed"]
    assert legend.get_window_extent().y1 < axes.xaxis.label.get_window_extent().y0
    assert axes.get_xlabel() == "x [m]"


def test_a_support_that_acts_nowhere_is_in_the_legend() -> None:
    idle = SupportMark("idle", "down", np.zeros((0, 2)), np.zeros(0, bool), "area")
    axes = supports([idle], Figure().add_subplot())
    assert [entry.get_text() for entry in axes.get_legend().get_texts()] == ["idle: pushes up only, 0 closed, 0 open"]


@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)])
def test_the_hatch_of_a_fixed_edge_lies_outside(order: slice) -> None:
    axes = contour(POINTS, ELEMENTS, POINTS[:, 0])
    bottom = np.array([[-1, 0], [1, 0.0]])[order]
    supports([SupportMark("wall", "fixed", bottom, style="line")], axes)
    np.testing.assert_array_equal(axes.lines[-1].get_xdata(), [-1, 1])


def test_a_fixed_line_breaks_at_rows_of_nan() -> None:
    pieces = np.array([[0, 0], [0, 1], [np.nan, np.nan], [1, 0], [1, 1]])
    axes = supports([SupportMark("walls", "fixed", pieces, style="line")], Figure().add_subplot())
    assert [len(piece.get_xdata()) for piece in axes.lines] == [2, 2]


def test_the_extremes_of_the_deflection_are_named() -> None:
    figure = deflection_picture(POINTS, ELEMENTS, POINTS[:, 0] * 1e-3)
    assert {text.get_text() for text in figure.axes[0].texts} == {"max 0.0012", "min −0.001"}


def test_the_check_picture_shows_mesh_supports_and_loads() -> None:
    loads = [
        LoadMark("Q", np.array([[0.5, 0.5]])),
        LoadMark("wind", np.array([[0.2, 0.5]]), upward=True),
        LoadMark("wall", np.array([[0, 0], [0, 1.0]]), "line"),
        LoadMark("patch", np.array([[0, 0], [0.5, 0], [0.5, 0.5]]), "area"),
        LoadMark("everywhere", np.empty((0, 2)), "area"),
    ]
    figure = check_picture(POINTS, ELEMENTS, supports=[PADS], loads=loads)
    axes = figure.axes[0]
    names = [entry.get_text() for entry in axes.get_legend().get_texts()]
    assert names == [PADS.label, "Q", "wind", "wall", "patch", "everywhere"]
    edges = [entry for entry in axes.collections if isinstance(entry, LineCollection)]
    assert sum(len(entry.get_segments()) for entry in edges) == 7
    assert len(axes.patches) == 1


def test_the_check_picture_shows_resultants_and_the_lines_the_plate_tips_about() -> None:
    marks = [
        BalanceMark("calm", (0.5, 0.5)),
        BalanceMark("wind", (1.8, 0.5), unbalanced=True, axis=((0.75, 0.0), (0.75, 1.0))),
        BalanceMark("storm", (1e6, 0.0), upward=True, unbalanced=True),
        BalanceMark("couple", None),
    ]
    axes = check_picture(POINTS, ELEMENTS, balance=marks).axes[0]
    assert [entry.get_text() for entry in axes.get_legend().get_texts()] == [
        "calm: resultant",
        "wind: resultant, not balanced",
        "wind: tips about this line",
        "storm: upward resultant, not balanced, far off the plate",
    ]
    calm, wind, axis = axes.lines
    assert [*calm.get_xydata()[0], *wind.get_xydata()[0]] == [0.5, 0.5, 1.8, 0.5]
    assert (axis.get_xdata() == 0.75).all() and np.ptp(axis.get_ydata()) > 1.0
    assert axes.get_xlim()[1] > 1.8
    assert [(name.get_text(), name.xy) for name in axes.texts] == [("calm", (0.5, 0.5)), ("wind", (1.8, 0.5))]


def test_of_many_resultants_only_some_that_are_not_balanced_have_names() -> None:
    marks = [BalanceMark(f"c{i}", (0.01 * i, 0.5), unbalanced=i % 10 == 0) for i in range(200)]
    axes = check_picture(POINTS, ELEMENTS, balance=marks).axes[0]
    assert [name.get_text() for name in axes.texts] == [f"c{10 * i}" for i in range(8)]
    assert [entry.get_text() for entry in axes.get_legend().get_texts()][8:] == [
        "resultants of 180 more combinations",
        "resultants of 12 more combinations, not balanced",
    ]


def test_sections_are_drawn_with_deflection_down_and_share_axes() -> None:
    axes = line([0, 1], [0, 2], label="60", ylabel="deflection [mm]")
    line([0, 1], [0, 3], ax=axes, label="90")
    assert axes.yaxis_inverted()
    assert axes.get_ylabel() == "deflection [mm]"
    assert [entry.get_text() for entry in axes.get_legend().get_texts()] == ["60", "90"]
    assert not line([0, 1], [0, 2], down=False).yaxis_inverted()


def reach(axes: Axes, which: int) -> tuple[float, float]:
    """From where to where in x the filled contours or triangles go; the first are the pale plate."""
    paths = [path for path in axes.collections[which].get_paths() if len(path.vertices)]
    x = np.concatenate([path.vertices[:, 0] for path in paths])
    return round(float(x.min()), 12), round(float(x.max()), 12)


CUT = tessellate(ELEMENTS)
ACROSS = CUT.interpolate(POINTS)[:, 0]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("bounds", "reached"), [((0, np.inf), (0.25, 1.2)), ((-np.inf, 0), (-1, 0.25)), ((-np.inf, np.inf), (-1, 1.2))]
)
def test_pressure_is_drawn_as_far_as_the_support_exerts_it(bounds: tuple[float, float], reached: object) -> None:
    axes = pressure(POINTS, ELEMENTS, [PressureLayer(CUT, ACROSS - 0.25, bounds)])
    assert reach(axes, 1) == reached


@pytest.mark.filterwarnings("error")
def test_pressures_of_elements_are_drawn_one_an_element_and_nothing_where_they_are_zero() -> None:
    axes = pressure(POINTS, ELEMENTS, [PressureLayer(CUT, np.array([3.0, 0.0]), (0, np.inf))])
    assert reach(axes, 1) == (0, 1.2)
    assert axes.collections[1].get_clim() == (0, 3)


@pytest.mark.filterwarnings("error")
def test_pressure_ends_at_the_outline_of_the_area() -> None:
    outline = np.array([[0, 0.2], [0.5, 0.2], [0.5, 0.8], [0, 0.2]])
    axes = pressure(POINTS, ELEMENTS, [PressureLayer(CUT, ACROSS + 2, (0, np.inf), outline)])
    for part in axes.collections[1:3]:
        clip, _ = part.get_transformed_clip_path_and_affine()
        np.testing.assert_array_equal(clip.vertices, outline)


@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)])
@pytest.mark.parametrize(("end", "within"), [(0.55, ACROSS[ACROSS < 0.55].max()), (0.0, 0.0)])
def test_colours_and_the_largest_pressure_are_of_what_is_within_the_outline(
    order: slice, end: float, within: float
) -> None:
    outline = np.array([[-1, 0], [end, 0], [end, 1], [-1, 1], [-1, 0]])[order]
    axes = pressure_picture(POINTS, ELEMENTS, [PressureLayer(CUT, ACROSS + 1, (0, np.inf), outline)]).axes[0]
    within += 1
    assert axes.collections[1].get_clim() == (0, within)
    assert [text.get_text() for text in axes.texts] == [f"max {within:.4g}"]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("values", [-np.ones_like(ACROSS), np.full_like(ACROSS, 2.0)])
def test_pressure_that_is_nowhere_or_everywhere_the_same_can_be_drawn(values: np.ndarray) -> None:
    down = PressureLayer(CUT, values, (0, np.inf))
    up = PressureLayer(CUT, -ACROSS, (-np.inf, 0))
    for layers in ([], [down], [down, up]):
        pressure_picture(POINTS, ELEMENTS, layers).draw_without_rendering()


def test_the_pressure_picture_has_the_edge_of_contact_instead_of_an_area_s_points() -> None:
    edge = np.array([[0.25, 0], [0.25, 1.0]])
    soil = SupportMark("soil", "down", POINTS, np.ones(len(POINTS), bool), "area", [edge])
    layers = [PressureLayer(CUT, ACROSS - 0.25, (0, np.inf))]
    axes = pressure_picture(POINTS, ELEMENTS, layers, [soil, PADS], length="m").axes[0]
    assert [entry.get_text() for entry in axes.get_legend().get_texts()] == [PADS.label, "edge of contact"]
    np.testing.assert_array_equal(axes.lines[-1].get_xydata(), edge)
    assert [text.get_text() for text in axes.texts] == ["max 0.95"]
    axes = deflection_picture(POINTS, ELEMENTS, POINTS[:, 0], [soil]).axes[0]
    assert [entry.get_text() for entry in axes.get_legend().get_texts()] == [soil.label, "edge of contact"]
    np.testing.assert_array_equal(axes.lines[-1].get_xydata(), edge)


def test_a_picture_is_saved_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    figure = deflection_picture(POINTS, ELEMENTS, POINTS[:, 0], [PADS])
    target = tmp_path / "slab.png"
    save(figure, target)
    written = target.read_bytes()
    assert written.startswith(b"\x89PNG")

    def fail(path: Path, **options: object) -> None:
        path.write_text("half")
        raise OSError("disk full")

    monkeypatch.setattr(figure, "savefig", fail)
    with pytest.raises(OSError, match="disk full"):
        save(figure, target)
    assert [entry.name for entry in tmp_path.iterdir()] == ["slab.png"]
    assert target.read_bytes() == written


def test_drawing_leaves_matplotlib_s_global_state_alone() -> None:
    program = "import sys, signorini.plot; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
