from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.image import imread
from matplotlib.patches import PathPatch
from matplotlib.text import Text
from matplotlib.tri._tricontour import TriContourSet
from models import rectangular

import signorini
from signorini import Model, solve, write
from signorini.analysis.check import check
from signorini.base.numbers import plain
from signorini.discretise import discretise
from signorini.errors import InputError
from signorini.mesh.meshers import rectangle
from signorini.output.pictures import jobs_of
from signorini.plot.curves import load_path_picture, profile_picture
from signorini.plot.files import save
from signorini.plot.marks import draw_support, legend_words
from signorini.plot.picture import BalanceMark, EdgeMark, LoadMark, Panel, Picture, PressureLayer, SupportMark, ZoneMark
from signorini.plot.pictures import check_picture, drawn_as_png, field_picture, view_picture
from signorini.plot.plan import Plan
from signorini.plot.view import exaggeration, seen
from signorini.results.marks import (
    bedding_panel,
    case_totals,
    edge_marks,
    load_marks,
    singular_marks,
    support_marks,
    unsolved_marks,
)
from signorini.shapes.tessellation import tessellate
from signorini.singularities.named import singularities

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
PLAN = Plan(POINTS, ELEMENTS)
PADS = SupportMark("pads", "down", np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), np.array([True, False, True]))


ACROSS_PLATE = Panel(POINTS[:, 0], (-1.0, 1.2))


def contour(values: np.ndarray) -> Axes:
    return field_picture(PLAN, [Panel(values, (values.min(), values.max()))]).axes[0]


def pressure(layer: PressureLayer, limits: tuple[float, float]) -> Axes:
    return field_picture(PLAN, [Panel([layer], limits)]).axes[0]


def colour_limits(values: np.ndarray) -> tuple[str, float, float]:
    bands = next(part for part in contour(values).collections if isinstance(part, TriContourSet))
    return bands.cmap.name, round(bands.norm.vmin, 12), round(bands.norm.vmax, 12)


def test_zero_is_the_middle_of_the_colours_of_both_signs_and_a_field_of_one_sign_has_its_half() -> None:
    rising = POINTS[:, 0] + 1
    assert colour_limits(rising - 1) == ("RdBu", -1.2, 1.2)
    assert colour_limits(rising) == ("RdBu", -2.2, 2.2)
    assert colour_limits(-rising) == ("RdBu", -2.2, 2.2)
    assert colour_limits(rising + 5) == ("RdBu", 2.8, 7.2)


def test_rounding_below_zero_is_not_uplift() -> None:
    assert colour_limits(POINTS[:, 0] + 1 - 1e-15) == ("RdBu", -2.2, 2.2)


def areas_in_view(points: np.ndarray, elements: np.ndarray, deflection: np.ndarray, factor: float) -> np.ndarray:
    cut = tessellate(elements)
    a, b, c = np.moveaxis(cut.interpolate(seen(points, deflection, factor))[cut.triangles], 1, 0)
    (x, y), (u, v) = (b - a).T, (c - a).T
    return np.asarray(x * v - y * u)


@pytest.mark.parametrize("seed", range(5))
def test_no_part_of_a_deflected_plate_hides_another(seed: int) -> None:
    mesh = rectangle((0.0, 0.0), (4.0, 2.0), (8, 4))
    random = np.random.default_rng(seed)
    smooth, rough = (random.uniform(-1, 1, 2) @ mesh.points.T, random.uniform(-1, 1, mesh.node_count))
    tilted, folded = (exaggeration(mesh.points, mesh.elements, [one]) for one in (smooth, rough))
    # A plate that is only tilted has a largest deflection of 15 % of its size, to two digits.
    assert tilted * np.abs(smooth).max() == pytest.approx(0.15 * 4, rel=0.05)
    assert folded * np.abs(rough).max() < 0.3 * 0.15 * 4
    for deflection, factor in ((smooth, tilted), (rough, folded)):
        assert (areas_in_view(mesh.points, mesh.elements, deflection, factor) > 0).all()
    assert exaggeration(mesh.points, mesh.elements, [smooth, rough]) == min(tilted, folded)
    assert exaggeration(mesh.points, mesh.elements, [0.0 * smooth]) == 1.0


def test_views_of_the_first_example_of_the_paper_show_where_its_prop_holds() -> None:
    """The deflected mesh, alike exaggerated in both steps, with every support on it: held is filled, open hollow."""
    results = solve(signorini.load(Path(__file__).parents[1] / "examples" / "clamped_quarter.toml"))
    (job,) = jobs_of(results, None)
    (sheet,) = (one for one in job.sheets if len(one.seen))
    assert sheet.files == ["first-step-deformed.png", "unilateral-deformed.png"]
    first, whole = results.values()
    factor = exaggeration(first.mesh.points, first.mesh.elements, [first.deflection, whole.deflection])
    for picture, places, result in zip(sheet.pictures, sheet.seen, (first, whole), strict=True):
        assert picture.title.endswith(f"{result.name}, deflections × {plain(factor, 2)}")
        assert np.array_equal(places, seen(job.points, result.stress_nodes.spread(result.deflection), factor))
        clamped, _, prop = picture.marks
        assert prop.positions == pytest.approx(places[(job.points == 100).all(axis=1)])
        assert clamped.positions[np.isfinite(clamped.positions[:, 0])].min(axis=0) == pytest.approx([-50.0, 0.0])
        assert prop.closed.tolist() == result.supports[2].closed.tolist()
    drawn_in = view_picture(Plan(sheet.seen[1], job.elements), Plan(seen(job.points), job.elements), sheet.pictures[1])
    words = [text.get_text() for text in drawn_in.axes[0].get_legend().get_texts()]
    assert words[2:] == ["centre: points, pushes up only, rigid, with gap, 1 closed, 0 open", "without deflection"]
    assert {"x", "y"} <= {text.get_text() for text in drawn_in.axes[0].texts}


def test_contours_have_their_values_written_on_them() -> None:
    written = {text.get_text() for text in contour(POINTS[:, 0]).texts}
    assert "0" in written and len(written) > 2
    assert all(-1 <= float(text.replace("−", "-")) <= 1.2 for text in written)


@pytest.mark.parametrize("constant", [0.0, 5.0, -1e-9])
def test_a_constant_field_can_be_drawn(constant: float) -> None:
    axes = contour(np.full(13, constant))
    axes.figure.draw_without_rendering()


def test_closed_points_are_filled_and_open_ones_hollow() -> None:
    axes = field_picture(PLAN, [ACROSS_PLATE], [PADS]).axes[0]
    closed, opened = axes.lines
    np.testing.assert_array_equal(closed.get_xydata(), PADS.positions[[0, 2]])
    np.testing.assert_array_equal(opened.get_xydata(), PADS.positions[[1]])
    assert closed.get_markerfacecolor() != "white"
    assert opened.get_markerfacecolor() == "white"


def shape(axes: Axes, line: int = 0) -> list:
    return axes.lines[line].get_marker().vertices.round(6).tolist()


def drawn(*kinds: str, style: str = "points", **keys: object) -> list[Axes]:
    marks = [SupportMark("s", kind, PADS.positions, style=style, **keys) for kind in kinds]
    return [field_picture(PLAN, [ACROSS_PLATE], [mark]).axes[0] for mark in marks]


def test_every_kind_of_support_at_points_has_a_mark_of_its_own() -> None:
    kinds = ("down", "up", "both", "clamped", "hinged", "symmetry")
    marks = [shape(axes) for axes in drawn(*kinds)]
    marks += [shape(*drawn("down", elastic=True)), shape(*drawn("down", gap=True))]
    assert all(a != b for i, a in enumerate(marks) for b in marks[:i])


def test_lines_tell_clamped_from_hinged_from_symmetry_and_elastic_from_rigid() -> None:
    clamped, hinged, symmetry, rigid = drawn("clamped", "hinged", "symmetry", "down", style="line")
    (elastic,) = drawn("down", style="line", elastic=True)
    assert len(clamped.lines[0].get_path_effects()) == 2  # the hatch
    assert symmetry.lines[1].get_linestyle() == "--" and hinged.lines[0].get_linestyle() == "-"
    assert not isinstance(hinged.lines[1].get_marker(), str)
    assert len(rigid.lines[0].get_xydata()) == 3 < 20 < len(elastic.lines[0].get_xydata())
    off = elastic.lines[0].get_xydata()[:5, 1]
    assert (np.sign(off[1:4]) == [-1, 1, -1]).all() or (np.sign(off[1:4]) == [1, -1, 1]).all()


def test_the_legend_tells_areas_from_lines_and_elastic_from_rigid_lines() -> None:
    def sample(style, elastic):
        axes = contour(POINTS[:, 0])
        first = draw_support(SupportMark("s", "down", PADS.positions, style=style, elastic=elastic), axes)[1][0]
        marker = first.get_marker()
        return marker if isinstance(marker, str) else marker.vertices.tolist()

    samples = [sample("line", False), sample("line", True), sample("area", True)]
    assert all(a != b for i, a in enumerate(samples) for b in samples[:i])


def test_of_a_line_that_lets_go_the_open_part_is_hollow() -> None:
    edge = np.column_stack([np.linspace(-1, 1, 81), np.zeros(81)])
    mark = SupportMark("wall", "down", edge, edge[:, 0] < 0.5, "line", counts=(30, 10))
    axes = field_picture(PLAN, [ACROSS_PLATE], [mark]).axes[0]
    hollow = [part for part in axes.lines if part.get_color() == "white"]
    assert [part.get_xdata()[[0, -1]].round(6).tolist() for part in hollow] == [[0.5, 1.0]]
    assert mark.label == "wall: pushes up only, 30 closed, 10 open"


def test_the_legend_counts_closed_and_open_below_the_axes() -> None:
    wall = SupportMark("wall", "clamped", np.array([[0, 0], [0, 1.0]]), style="line")
    figure = field_picture(PLAN, [ACROSS_PLATE], [PADS, wall], title="ULS", length="m")
    axes = figure.axes[0]
    figure.draw_without_rendering()
    legend = axes.get_legend()
    words = [entry.get_text() for entry in legend.get_texts()]
    assert words == ["pads: pushes up only, 2 closed, 1 open", "wall: clamped"]
    assert words == legend_words([PADS, wall])
    assert legend.get_window_extent().y1 < axes.xaxis.label.get_window_extent().y0
    assert axes.get_xlabel() == "x [m]"


def test_names_of_extremes_beside_each_other_stand_at_their_own() -> None:
    places = {"max 119000 ± 12000": (0.1, 0.0), "min −112000 ± 15000": (-0.1, 0.0)}
    figure = field_picture(PLAN, [replace(ACROSS_PLATE, extremes=list(places.items()))])
    figure.draw_without_rendering()
    axes = figure.axes[0]
    across = {name: axes.transData.transform(at)[0] for name, at in places.items()}
    for text in (text for text in axes.texts if text.get_text() in places):
        extent = text.get_window_extent()
        middle = 0.5 * (extent.x0 + extent.x1)
        assert min(across, key=lambda name: abs(across[name] - middle)) == text.get_text()


def test_what_is_beyond_a_scale_has_its_last_colour() -> None:
    """As beside a corner without a limit, which the extremes leave out."""
    values = np.where(POINTS[:, 0] > 0.5, 59e3, np.where(POINTS[:, 0] < 0.0, -1000.0, 70.0))
    for limits, colour in (((-1000.0, 70.0), None), ((-1000.0, -100.0), "pale")):
        figure = field_picture(PLAN, [Panel(values, limits)])
        (bands,) = [one for one in figure.axes[0].collections if isinstance(one, TriContourSet) and one.filled]
        last = bands.get_facecolor()[-1]
        assert any(len(path.vertices) for path in bands.get_paths()[-1:])
        # A scale of one sign has no colour of the other sign.
        assert (last[:3] > 0.8).all() if colour else last[2] > last[0]


def test_elements_that_are_left_out_are_hatched_and_named_in_the_legend() -> None:
    plan = Plan(POINTS, ELEMENTS, np.array([True, False]))
    axes = field_picture(plan, [ACROSS_PLATE]).axes[0]
    (hatched,) = [one for one in axes.patches if one.get_hatch()]
    x = hatched.get_path().vertices[:, 0]
    assert (x.min(), x.max()) == (0.0, 1.2) and to_hex(hatched.get_facecolor()) == "#eef2f5"
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["left out of the extremes"]


def test_a_footprint_is_drawn_as_large_as_it_is_and_its_mark_leaves_most_of_it_free() -> None:
    corners = 0.5 + 0.1 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    prints = np.concatenate([np.full((1, 2), np.nan), corners] * 2)
    mark = SupportMark("c", "down", np.array([[0.5, 0.5]] * 2), np.array([True, False]), footprints=prints)
    axes = field_picture(PLAN, [ACROSS_PLATE], [mark]).axes[0]
    shut, opened = axes.patches
    np.testing.assert_allclose(shut.get_path().vertices[:5], corners)
    assert shut.get_facecolor()[3] > 0 == opened.get_facecolor()[3] and opened.get_linestyle() == "dashed"
    wide = 72 * 0.2 * (axes.get_position().width * axes.figure.get_figwidth()) / np.ptp(axes.get_xlim())
    marks = [line for line in axes.lines if not isinstance(line.get_marker(), str)]
    assert marks and all(line.get_markersize() < 0.5 * wide for line in marks)


def test_every_curve_of_a_load_path_looks_different_and_none_is_left_out_in_silence() -> None:
    from signorini.plot.curves import load_path_picture

    probes = {f"probe {i}": [0, i, 2 * i] for i in range(21)}
    figure = load_path_picture([0, 1, 2], probes, {"a": [0, 1, 2], "b": [0, 1, 2]}, {"prop": [0, 1, 1]}, {"a = 1": 1.0})
    deflections = figure.axes[2]
    looks = [(line.get_color(), line.get_linestyle()) for line in deflections.get_lines() if len(line.get_xdata()) == 3]
    assert len(set(looks)) == len(looks) == 18
    assert deflections.get_legend().get_texts()[-1].get_text() == "3 more are not drawn"
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ["a, b"]
    assert [text.get_text() for text in figure.axes[0].texts] == ["a = 1"]


def test_saved_together_pictures_are_those_drawn_alone_and_what_they_share_stays(tmp_path: Path) -> None:
    values = [POINTS[:, 0], 0.5 * POINTS[:, 1]]
    opened = SupportMark("pads", "down", PADS.positions, np.array([False, False, True]))
    pictures = [
        Picture([Panel(v, (-1.0, 1.2), "w [m]")], marks, f"case {i}")
        for i, (v, marks) in enumerate(zip(values, ([PADS], [opened]), strict=True))
    ]
    together = list(drawn_as_png(PLAN, [*pictures, pictures[0], pictures[1]], "m"))
    for picture, first, again in zip(pictures, together[:2], together[2:], strict=True):
        assert first == again
        alone = field_picture(PLAN, picture.panels, picture.marks, title=picture.title, length="m")
        save(alone, tmp_path / "alone.png")
        one, other = (imread(file)[..., :3] for file in (BytesIO(first), tmp_path / "alone.png"))
        assert one.shape == other.shape
        # Lines that are drawn in another order differ by a shade.
        assert (np.abs(one - other).max(axis=2) > 0.3).mean() < 1e-3


def test_the_check_picture_shows_mesh_supports_and_loads() -> None:
    loads = [
        LoadMark("Q", "force", np.array([[0.5, 0.5]])),
        LoadMark("Q", "force, upward", np.array([[0.2, 0.5]]), upward=True),
        LoadMark("wall", "line load", np.array([[0, 0], [0, 1.0]]), "line"),
        LoadMark("G", "pressure", np.array([[0, 0], [0.5, 0], [0.5, 0.5]]), "area"),
        LoadMark("G", "pressure everywhere", np.empty((0, 2)), "area"),
        LoadMark("T", "moment", np.array([[0.0, 0.5]]), couple=(3.0, 0.0)),
    ]
    axes = check_picture(PLAN, supports=[PADS], loads=loads).axes[0]
    names = [entry.get_text() for entry in axes.get_legend().get_texts()]
    assert names[:3] == [PADS.label, "Q: force", "Q: force, upward"] and names[-1] == "T: moment"
    assert {part.get_label() for part in axes.collections} >= {"_elements", "_outline"}
    assert len(axes.patches) == 1
    colours = [handle.get_color() for handle in (axes.lines[-6], axes.lines[-5], axes.lines[-4])]
    assert colours[0] == colours[1] != colours[2]
    # A couple that turns the plate ahead of it along x down: the force down is there.
    up, down = axes.lines[-1], axes.lines[-2]
    assert "otimes" in down.get_marker() and "odot" in up.get_marker()
    assert up.get_xdata()[0] < 0 < down.get_xdata()[0] and down.get_ydata()[0] == 0.5


def test_the_check_picture_has_a_map_of_bedding_that_is_not_constant(tmp_path) -> None:
    def drawn(stiffness: object) -> Panel | None:
        bed = {"name": "soil", "area": "all", "resists": "down", "stiffness": stiffness}
        model = Model(
            units={"length": "m", "force": "kN"},
            material={"E": 33e6, "nu": 0.2},
            plate={"shape": "rectangle", "size": [8, 6], "thickness": 0.25},
            mesh={"size": 1.0, "error": False},
            support=[bed],
            load=[{"pressure": 3}],
        )
        found = check(model)
        assert found.save_picture(tmp_path / "check.png")[0].stat().st_size > 1000
        return bedding_panel(found.discretisation)

    boreholes = [(1, 1, 20e3), (7, 1, 20e3), (7, 5, 30e3), (1, 5, 30e3)]
    assert drawn(20e3) is None
    for stiffness in ({"points": boreholes, "outside": "nearest"}, "20e3 + 2.5e3*min(max(y - 1, 0), 4)"):
        panel = drawn(stiffness)
        assert panel is not None
        assert panel.limits == pytest.approx((20e3, 30e3))
        assert panel.label.endswith("[kN/m³]")


def test_node_numbers_are_drawn_on_request() -> None:
    assert not check_picture(PLAN).axes[0].texts
    texts = check_picture(PLAN, numbers=True).axes[0].texts
    wanted = [(str(i), tuple(at)) for i, at in enumerate(POINTS, start=1)]
    assert [(text.get_text(), text.xy) for text in texts] == wanted
    many = Plan(np.zeros((6000, 2)), ELEMENTS)
    with pytest.raises(InputError, match="6000 nodes"):
        check_picture(many, numbers=True)


def test_the_check_picture_shows_zones_on_the_plate_alone_with_their_numbers() -> None:
    outline = np.array([[0.2, 0.2], [3.0, 0.2], [3.0, 0.8], [0.2, 0.8], [0.2, 0.2]])
    axes = check_picture(PLAN, zones=[ZoneMark("thickness 0.4", outline)]).axes[0]
    (drawn,) = (part for part in axes.patches if part.get_clip_path() is not None and isinstance(part, PathPatch))
    assert drawn.get_clip_path() is not axes.patch
    assert [text.get_text() for text in axes.texts] == ["1"]
    legend = axes.get_figure().legends or [axes.get_legend()]
    assert "zone 1: thickness 0.4" in [text.get_text() for text in legend[0].get_texts()]


def test_the_check_picture_shows_resultants_and_the_lines_the_plate_tips_about() -> None:
    marks = [
        BalanceMark("calm", (0.5, 0.5)),
        BalanceMark("wind", (1.8, 0.5), unbalanced=True, axis=((0.75, 0.0), (0.75, 1.0))),
        BalanceMark("storm", (1e6, 0.0), upward=True, unbalanced=True),
        BalanceMark("couple", None),
    ]
    axes = check_picture(PLAN, balance=marks).axes[0]
    assert [entry.get_text() for entry in axes.get_legend().get_texts()] == [
        "calm: resultant",
        "wind: resultant at [1.8, 0.5], off the picture, not balanced",
        "wind: tips about this line",
        "storm: upward resultant at [1000000, 0], off the picture, not balanced",
    ]
    calm, axis = axes.lines
    assert calm.get_xydata()[0].tolist() == [0.5, 0.5]
    assert (axis.get_xdata() == 0.75).all() and np.ptp(axis.get_ydata()) > 1.0
    # The plate is as large as without them: arrows at the border point there.
    assert axes.get_xlim() == check_picture(PLAN).axes[0].get_xlim()
    arrows = [text for text in axes.texts if text.arrow_patch is not None and not text.get_text()]
    assert [round(arrow.xy[0], 6) for arrow in arrows] == [round(axes.get_xlim()[1], 6)] * 2
    names = {"calm", "wind: at [1.8, 0.5]", "storm: at [1000000, 0]"}
    assert {text.get_text() for text in axes.texts} == names | {""}


def test_resultants_at_one_place_have_one_name() -> None:
    marks = [BalanceMark(f"c{i}", (0.5, 0.5 + 1e-4 * i)) for i in range(5)] + [
        BalanceMark("up", (0.5, 0.5), upward=True)
    ]
    axes = check_picture(PLAN, balance=marks).axes[0]
    assert [name.get_text() for name in axes.texts] == ["c0 and 4 more", "up"]
    assert [entry.get_text() for entry in axes.get_legend().get_texts()] == [
        "c0 and 4 more: resultant",
        "up: upward resultant",
    ]


def reach(axes: Axes, which: int) -> tuple[float, float]:
    """From where to where in x they go."""
    paths = [path for path in pressures(axes)[which].get_paths() if len(path.vertices)]
    x = np.concatenate([path.vertices[:, 0] for path in paths])
    return round(float(x.min()), 12), round(float(x.max()), 12)


def pressures(axes: Axes) -> list:
    return [part for part in axes.collections if part.get_label() not in ("_elements", "_outline")]


CUT = tessellate(ELEMENTS)
ACROSS = CUT.interpolate(POINTS)[:, 0]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("bounds", "reached"), [((0, np.inf), (0.25, 1.2)), ((-np.inf, 0), (-1, 0.25)), ((-np.inf, np.inf), (-1, 1.2))]
)
def test_pressure_is_drawn_as_far_as_the_support_exerts_it(bounds: tuple[float, float], reached: object) -> None:
    axes = pressure(PressureLayer(CUT, ACROSS - 0.25, bounds), np.clip([-1.25, 0.95], *bounds))
    assert reach(axes, 1) == reached


@pytest.mark.filterwarnings("error")
def test_pressure_ends_at_the_outline_of_the_area() -> None:
    outline = np.array([[0, 0.2], [0.5, 0.2], [0.5, 0.8], [0, 0.2]])
    axes = pressure(PressureLayer(CUT, ACROSS + 2, (0, np.inf), outline), (0.0, 3.0))
    for part in pressures(axes)[1:3]:
        clip, _ = part.get_transformed_clip_path_and_affine()
        np.testing.assert_array_equal(clip.vertices, outline)


def test_an_area_is_its_outline_and_the_edge_of_contact() -> None:
    edge, outline = np.array([[0.25, 0], [0.25, 1.0]]), np.array([[-1, 0], [1, 0], [1, 1], [-1, 1], [-1, 0.0]])
    soil = SupportMark("soil", "down", outline, None, "area", [edge], counts=(80, 20))
    layers = [PressureLayer(CUT, ACROSS - 0.25, (0, np.inf))]
    panel = Panel(layers, (0.0, 0.95), extremes=[("max 0.95", (1.2, 0.5))])
    axes = field_picture(PLAN, [panel], [soil, PADS], length="m").axes[0]
    words = [entry.get_text() for entry in axes.get_legend().get_texts()]
    assert words == ["soil: pushes up only, 80 closed, 20 open", PADS.label, "edge of contact"]
    np.testing.assert_array_equal(axes.lines[-1].get_xydata()[1:], edge)
    assert any(np.array_equal(part.get_xydata(), outline) for part in axes.lines)
    assert "max 0.95" in {text.get_text() for text in axes.texts}


def test_the_outline_of_an_area_is_closed_where_its_points_are() -> None:
    soil = {"name": "soil", "area": "all", "resists": "down", "stiffness": 1e5}
    load = [{"pressure": 1e3}, {"force": 3e5, "at": [3.5, 3.5], "patch": [0.5, 0.5]}]
    result = solve(rectangular(divisions=[8, 8], support=[soil], load=load))["all"]
    (mark,) = support_marks(result)
    pressed = result.pressure(np.clip(mark.positions[1:], 0, 4)) > 0
    assert mark.closed is not None
    assert 0.2 < pressed.mean() < 0.8
    assert (mark.closed[1:] == pressed).mean() > 0.9


def test_a_load_by_a_formula_is_drawn_as_one_and_the_way_it_acts() -> None:
    model = rectangular(load=[{"case": "W", "pressure": "-1.5*(x<2)"}, {"case": "Q", "pressure": "2*(x<2)"}])
    wind, live = load_marks(discretise(model))
    assert (wind.name, wind.value, wind.upward) == ("pressure by its formula, upward", "0 to 1.5", True)
    assert (live.name, live.value, live.upward) == ("pressure by its formula", "0 to 2", False)


def test_the_check_picture_names_edges_values_of_loads_their_sums_and_places_without_a_limit(tmp_path: Path) -> None:
    loads = [
        {"case": "G", "pressure": 5, "area": {"rectangle": [0, 0, 2, 4]}},
        {"case": "G", "force": -60, "at": [[3, 2], [3, 3]]},
        {"case": "T", "moment": [0, 4.5], "at": [2, 2]},
    ]
    model = rectangular(units={"length": "m", "force": "kN"}, load=loads)
    found = discretise(model)
    figure = check_picture(
        Plan(found.mesh.points, found.mesh.elements),
        loads=load_marks(found),
        totals=case_totals(found),
        edges=edge_marks(found.mesh),
        singular=singular_marks(singularities(found)),
    )
    axes = figure.axes[0]
    written = [text.get_text() for text in axes.texts]
    assert {"left", "right", "bottom", "top"} < set(written)
    assert written.count("60 kN up") == 2 and {"5 kN/m²", "[0, 4.5] kN m"} < set(written)
    legend = [entry.get_text().replace("\n", " ") for entry in axes.get_legend().get_texts()]
    assert {"G: pressure, 5 kN/m²", "G: force, upward, 60 kN", "G: 80 kN up in total"} < set(legend)
    assert "T: moment [0, 4.5] kN m in total" in legend
    (named,) = (words for words in legend if words.startswith("no limit"))
    assert "Force at a point of load[2]" in named and "Couple at a point of load[3]" in named
    rings = [line for line in axes.lines if line.get_markersize() == 13.0]
    assert sum(len(line.get_xdata()) for line in rings) >= 3


def test_values_of_loads_are_those_where_they_act() -> None:
    model = rectangular(
        load=[
            {"case": "A", "line_load": "10 * x", "line": [[1, 1], [3, 1]]},
            {"case": "B", "line_load": "10 * x", "edge": "bottom"},
            {"case": "C", "pressure": "10 * x", "area": {"rectangle": [1, 1, 2, 2]}},
            {"case": "D", "pressure": "x + 2"},
        ]
    )
    assert [mark.value for mark in load_marks(discretise(model))] == ["10 to 30", "0 to 40", "10 to 20", "2 to 6"]


def test_couples_read_as_they_are_written_and_their_sum_as_a_moment() -> None:
    written = [
        ({"moment": [2, 3]}, "A: moment, [2, 3] kN m", "moment [2, 3] kN m"),
        ({"couple_about": {"x": 3, "y": -2}}, "A: couple, about x 3, y −2 kN m", "moment [2, 3] kN m"),
        ({"couple_about": {"y": -4}}, "A: couple, about y −4 kN m", "moment [4, 0] kN m"),
    ]
    for load, label, total in written:
        held = [{"edge": "left", "fix": "clamped"}]
        units, at = {"length": "m", "force": "kN"}, [3, 3]
        found = discretise(rectangular(units=units, support=held, load=[{"case": "A", "at": at, **load}]))
        (mark,) = load_marks(found)
        assert (mark.label, case_totals(found)) == (label, {"A": total})


@pytest.mark.parametrize("radius", [3.0, 5.0, 5.8])
def test_forces_along_a_circle_that_cancel_are_a_couple(radius: float) -> None:
    """Though parabolas stand for its arcs."""
    tank = {"shape": "disc", "radius": 6, "thickness": 0.3, "holes": [{"circle": {"center": [2, 1], "radius": 0.5}}]}
    wind = {"line_load": f"1000*x/(pi*{radius}**3)", "circle": {"radius": radius}}
    model = rectangular(
        units={"length": "m", "force": "kN"}, plate=tank, mesh={"size": 0.4}, load=[{"case": "W", **wind}]
    )
    assert case_totals(discretise(model)) == {"W": "moment [1000, 0] kN m"}


@pytest.mark.parametrize(("thickness", "said"), [(0.4, True), (0.2, False)])
def test_lines_across_which_moments_jump_are_in_the_legend(thickness: float, said: bool, tmp_path: Path) -> None:
    zone = {"area": {"rectangle": [1, 1, 3, 3]}, "thickness": thickness}
    held = [{"edge": ["left", "right"], "fix": "simple"}]
    results = solve(rectangular(zone=[zone], support=held, load=[{"pressure": 5}], mesh={"error": False}))
    figure = results["all"].plot("mx").figure
    legends = [axes.get_legend() for axes in figure.axes if axes.get_legend() is not None]
    words = [entry.get_text() for legend in legends for entry in legend.get_texts()]
    assert ("moments and shears jump" in words) is said
    assert write(results, tmp_path)


def test_no_words_of_a_check_picture_lie_on_others() -> None:
    top = np.array([[0.0, 1.0], [1.0, 1.0]])
    loads = [LoadMark(case, "line load", top, "line", value=f"{case} kN/m") for case in "123"]
    loads += [LoadMark("4", "force", np.array([[0.5, 0.9]]), value="4 kN")]
    edges = [EdgeMark("top", (0.5, 1.0), (-0.4, 0.0)), EdgeMark("hole 1 top", (0.5, 0.96), (-0.4, 0.0))]
    balance = [BalanceMark("ULS", (0.5, 0.9)), BalanceMark("SLS", (0.56, 0.9))]
    zones = [ZoneMark("thicker", np.array([[0.4, 0.8], [0.6, 0.8], [0.6, 1.0], [0.4, 1.0], [0.4, 0.8]]))]
    figure = check_picture(PLAN, loads=loads, edges=edges, balance=balance, zones=zones)
    figure.canvas.draw()
    texts = [text for text in figure.axes[0].texts if text.get_text()]
    assert len(texts) == 9
    boxes = [Text.get_window_extent(text) for text in texts]
    assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])
    plate = {"support": [{"edge": "left", "fix": "clamped"}], "load": [{"pressure": 1}]}
    marks = {mark.name: mark for mark in edge_marks(discretise(rectangular(divisions=[10, 10], **plate)).mesh)}
    assert all(marks[name].at[0] < 2.0 for name in ("top", "bottom"))


def test_points_carry_the_numbers_of_the_tables_and_check_says_gaps_preloads_and_orders() -> None:
    bolts = {"name": "bolts", "at": [[3, 1], [1, 1]], "resists": "up", "stiffness": 1e7, "preload": 5e4, "order": 2}
    feet = {"name": "feet", "at": [[3, 3], [1, 3]], "resists": "down", "gap": "0.001*x"}
    soil = {"area": "all", "resists": "down", "stiffness": 1e7}
    model = rectangular(support=[bolts, feet, soil], load=[{"pressure": 1e3}])
    bolted, footed, _ = unsolved_marks(discretise(model))
    assert [*bolted.numbers] == ["bolts[1]", "bolts[2]"] and bolted.positions.tolist() == [[3, 1], [1, 1]]
    assert "preload" in bolted.label and "order 2" in bolted.label
    assert [text.partition(",")[0] for text in footed.numbers] == ["feet[1]", "feet[2]"]
    assert "0.003" in footed.numbers[0] and "0.001" in footed.numbers[1]
    texts = {text.get_text() for text in signorini.solve(model)["all"].plot("mx").texts}
    assert texts >= {"bolts[1]", "bolts[2]", "feet[1]", "feet[2]"}


def test_the_lifted_part_of_a_pressure_picture_is_blank() -> None:
    load = [{"pressure": 1e3}, {"force": 3e4, "at": [3.5, 2]}]
    model = rectangular(thickness=0.5, support=[{"area": "all", "resists": "down", "stiffness": 2e6}], load=load)
    figure = signorini.solve(model)["all"].plot("pressure").figure
    figure.canvas.draw()
    dots = np.asarray(figure.canvas.buffer_rgba())
    axes = figure.axes[0]

    def colour(x: float, y: float) -> list[int]:
        column, row = axes.transData.transform((x, y))
        return dots[len(dots) - int(row), int(column), :3].tolist()

    assert colour(0.3, 1.7) == [255, 255, 255] and min(colour(3.0, 1.7)) < 250


def test_pressure_goes_up_in_a_profile_and_all_else_down() -> None:
    curves = {"G": np.array([0.0, 1.0, 2.0])}
    figure = profile_picture([0, 1, 2], {"deflection": curves, "pressure": curves}, upward=["pressure"])
    assert [axes.yaxis.get_inverted() for axes in figure.axes] == [True, False]


def test_words_at_an_extreme_are_nearest_to_its_own_cross() -> None:
    for apart in (0.05, 0.1, 0.2, 0.3):
        places = {"max 1.234 ± 0.567": (0.5, 0.5), "min −1.234 ± 0.567": (0.5 + apart, 0.5)}
        panel = Panel(POINTS[:, 0].copy(), (-1.0, 1.0), extremes=list(places.items()))
        axes = field_picture(PLAN, [panel]).axes[0]
        for text in axes.texts:
            if (words := text.get_text()) in places:
                box = text.get_window_extent(axes.figure.canvas.get_renderer())
                away = {
                    name: float(np.hypot(*(np.clip(at, box.min, box.max) - at)))
                    for name, at in ((name, axes.transData.transform(at)) for name, at in places.items())
                }
                assert away[words] == min(away.values())


@pytest.mark.parametrize("name", ["W" * 60, "a name with some words in it that goes on and on " * 3])
def test_the_legend_of_a_narrow_plate_is_within_the_page(name: str) -> None:
    plan = Plan(POINTS * [0.1, 4.0], ELEMENTS)
    panel = Panel(POINTS[:, 0].copy(), (0.0, 1.0))
    figure = field_picture(plan, [panel], [SupportMark(name, "down", np.array([[0.01, 1.0]]))], title=name)
    figure.canvas.draw()
    box = figure.axes[0].get_legend().get_window_extent()
    assert box.x0 >= 0 and box.x1 <= figure.bbox.x1 and box.y0 >= 0


def test_the_design_range_of_a_path_is_not_flattened_by_its_end() -> None:
    t, values = np.linspace(0, 1, 101), np.linspace(0, 1, 101)
    values[-1] = 1e3
    figure = load_path_picture(t, {"largest": values}, {"soil": values}, {"soil": np.ones(101)})
    low, high = sorted(figure.axes[0].get_ylim())
    assert low <= 0 and 0.97 <= high < 2
