"""Drawings: shapes read from DXF, shapes left out, and the input files made of them."""

import math
import tomllib
from collections.abc import Sequence
from pathlib import Path
from random import Random
from typing import Any

import ezdxf
import pytest
from command import run

import signorini
from signorini.analysis.check import check
from signorini.errors import InputError
from signorini.importers.drawing import Drawing
from signorini.importers.drawing_toml import drawing_as_toml
from signorini.importers.dxf import read_dxf

Corners = Sequence[tuple[float, ...]]
RECTANGLE = [(0, 0), (12, 0), (12, 7), (0, 7)]


class Sheet:
    """A drawing, in metres by default."""

    def __init__(self, directory: Path, unit: int = 6) -> None:
        self.made, self.path = ezdxf.new(), directory / "floor.dxf"
        self.made.header["$INSUNITS"] = unit
        self.space = self.made.modelspace()

    def closed(self, corners: Corners, layer: str = "0") -> None:
        self.space.add_lwpolyline(corners, "xyb"[: len(corners[0])], close=True, dxfattribs={"layer": layer})

    def open(self, layer: str, *corners: tuple[float, ...]) -> None:
        self.space.add_lwpolyline(corners, dxfattribs={"layer": layer})

    def lines(self, layer: str, *ends: tuple[tuple[float, float], tuple[float, float]]) -> None:
        for a, b in ends:
            self.space.add_line(a, b, {"layer": layer})

    def circles(self, layer: str, *those: tuple[float, float, float]) -> None:
        for x, y, radius in those:
            self.space.add_circle((x, y), radius, {"layer": layer})

    def points(self, layer: str, *those: tuple[float, float]) -> None:
        for at in those:
            self.space.add_point(at, dxfattribs={"layer": layer})

    def arcs(self, layer: str, *those: tuple[float, float, float, float, float]) -> None:
        for x, y, radius, begin, end in those:
            self.space.add_arc((x, y), radius, begin, end, dxfattribs={"layer": layer})

    def read(self, unit: str | None = None, **layers: list[str]) -> Drawing:
        self.made.saveas(self.path)
        return read_dxf(self.path, layers, unit)


@pytest.fixture
def sheet(tmp_path: Path) -> Sheet:
    return Sheet(tmp_path)


@pytest.fixture
def plate(sheet: Sheet) -> Sheet:
    """A sheet with the outline of a plate on it."""
    sheet.closed(RECTANGLE)
    return sheet


def written(drawing: Drawing) -> dict[str, Any]:
    return tomllib.loads(drawing_as_toml(drawing, "floor"))


def accepted(drawing: Drawing, directory: Path) -> bool:
    """Check the model of a drawing, on soil so that it is held; return whether a corner of it is singular."""
    target = directory / "floor.toml"
    target.write_text(drawing_as_toml(drawing, "floor") + "\n[[support]]\narea = 'all'\nstiffness = 1e7\n", "utf-8")
    return bool(check(signorini.load(target)).singular)


def found(drawing: Drawing) -> dict[tuple[float, ...], list[tuple[float, float]]]:
    """Points by their footprints, rounded."""
    return {size: sorted((round(x, 6), round(y, 6)) for x, y in places) for size, places in drawing.points.items()}


def middles(drawing: Drawing) -> list[list[tuple[float, float]]]:
    return [[(round(x, 6), round(y, 6)) for x, y, *_ in line] for line in drawing.lines]


def box(x: float, y: float, a: float, b: float) -> Corners:
    """Corners of a rectangle about a point."""
    return [(x - a / 2, y - b / 2), (x + a / 2, y - b / 2), (x + a / 2, y + b / 2), (x - a / 2, y + b / 2)]


def sides(corners: Corners) -> list[Any]:
    return list(zip(corners, [*corners[1:], corners[0]], strict=True))


# The outline


def test_sides_drawn_apart_are_joined_in_any_order_and_sense_with_their_arcs(sheet: Sheet) -> None:
    sheet.lines("SLAB", ((10, 7), (0, 7)), ((12, 0), (12, 5)), ((12, 0), (0, 0)), ((0, 7.0004), (0, 0)))
    sheet.arcs("SLAB", (10, 5, 2, 0, 90))
    sheet.lines("SLAB", ((0, 0), (12, 0)))
    drawing = sheet.read(outline=["slab"])
    assert drawing.outline.area == pytest.approx(12 * 7 - (4 - math.pi), rel=1e-4)
    points = written(drawing)["plate"]["points"]
    (arc,) = (point for point in points if isinstance(point, dict))
    assert len(points) == 5
    assert arc["through"] == pytest.approx([10 + 2 * math.sqrt(0.5), 5 + 2 * math.sqrt(0.5)], abs=1e-6)


@pytest.mark.parametrize(("unit", "size"), [(1, 0.0254), (4, 1e-3), (6, 1.0), (2, 0.3048)])
def test_lengths_are_metres_whatever_the_drawing_has(unit: int, size: float, tmp_path: Path) -> None:
    sheet = Sheet(tmp_path, unit)
    sheet.closed([(0, 0), (1000, 0), (1000, 500)])
    assert sheet.read().outline.area == pytest.approx(size**2 * 250e3)


def test_a_drawing_without_a_unit_asks_for_one(tmp_path: Path) -> None:
    sheet = Sheet(tmp_path, 0)
    sheet.closed([(1000 * x, 1000 * y) for x, y in RECTANGLE])
    with pytest.raises(InputError, match=r"the drawing has no unit of length."):
        sheet.read()
    assert sheet.read("mm").outline.area == pytest.approx(84)


def drawn_twice(sheet: Sheet) -> None:
    sheet.arcs("0", (0, 0, 5, 0, 180))
    sheet.space.add_lwpolyline([(-5, 0, -1), (5, 0)], "xyb")
    sheet.lines("0", ((-5, 0), (5, 0)), ((5, 0), (-5, 1e-7)))


def notched(sheet: Sheet) -> None:
    for corners in (box(4, 3, 8, 6), box(3, 0.5, 2, 1)):
        sheet.lines("0", *sides(corners))


def overlapping(sheet: Sheet) -> None:
    sheet.lines("0", ((0, 0), (5, 0)), ((4, 0), (7, 0)), ((8, 0), (6, 0)), ((8, 0), (8, 6)), ((8, 6), (0, 6)))
    sheet.lines("0", ((0, 6), (0, 0)), ((2, 6), (3, 6)))


def mirrored(sheet: Sheet) -> None:
    given = {"extrusion": (0, 0, -1)}
    sheet.space.add_lwpolyline([(0, 0), (-4, 0), (-4, 3), (0, 3)], close=True, dxfattribs=given)


OUTLINES = {
    "a whole turn drawn as an arc": (lambda sheet: sheet.arcs("0", (1, 2, 5, 0, 360)), 25 * math.pi),
    "what is drawn twice, in any sense": (drawn_twice, 12.5 * math.pi),
    "a notch that shares a part of the outline": (notched, 48),
    "lines that overlap along one line": (overlapping, 48),
    "what is mirrored": (mirrored, 12),
}


@pytest.mark.parametrize(("draw", "area"), OUTLINES.values(), ids=OUTLINES)
def test_an_outline_is_where_it_is_drawn_and_counts_once(draw: Any, area: float, sheet: Sheet) -> None:
    draw(sheet)
    drawing = sheet.read()
    assert drawing.outline.area == pytest.approx(area, rel=1e-12) and (draw is notched or not drawing.left)
    assert draw is not mirrored or drawing.outline.box == pytest.approx((0, 0, 4, 3))


def test_ellipses_and_splines_become_few_arcs_close_to_them_without_corners(tmp_path: Path) -> None:
    sheet = Sheet(tmp_path)
    sheet.space.add_ellipse((0, 0), (8, 0), 0.5)
    drawing = sheet.read()
    outline = drawing.outline
    assert outline.area == pytest.approx(math.pi * 8 * 4, rel=1e-4) and len(outline.corners) <= 40
    assert all(corner.bulge > 0 for corner in outline.corners) and not accepted(drawing, tmp_path)
    sheet = Sheet(tmp_path)
    sheet.space.add_open_spline([(0, 0), (2, 3), (6, 3), (8, 0)])
    sheet.lines("0", ((8, 0), (0, 0)))
    outline = sheet.read().outline
    # Bézier's cubic: ∫ y dx with y = 9t(1 − t) and dx = (6 + 12t(1 − t)) dt.
    assert outline.area == pytest.approx(9 + 108 / 30, rel=1e-4)
    assert 4 < len(outline.corners) < 20


@pytest.mark.parametrize("end", [180, 30, 10])
@pytest.mark.parametrize("begin", [0, 180])
def test_an_arc_and_its_chord_are_read_back(begin: int, end: int, sheet: Sheet, tmp_path: Path) -> None:
    for layer, (x, radius) in {"outline": (0, 50), "zones": (20, 9), "holes": (-20, 9)}.items():
        y = 0 if layer == "outline" else 15 * math.cos(math.radians(begin))
        arc = sheet.space.add_arc((x, y), radius, begin, begin + end, dxfattribs={"layer": layer})
        sheet.space.add_line(arc.start_point, arc.end_point, {"layer": layer})
    drawing = sheet.read()
    turn = math.radians(end)
    assert drawing.outline.area == pytest.approx(50**2 * (turn - math.sin(turn)) / 2)
    assert end < 180 or (len(drawing.holes), len(drawing.zones), drawing.left) == (1, 1, ())
    accepted(drawing, tmp_path)


@pytest.mark.parametrize("right", [4, 5])
def test_an_outline_that_crosses_itself_is_refused_with_the_place(right: float, sheet: Sheet) -> None:
    sheet.closed([(0, 0), (4, 4), (right, 0), (0, 4)], "outline")
    sheet.circles("outline", (1, 2, 0.1))
    with pytest.raises(InputError, match=r"outline: .*edge 1 and edge 3 cross or touch at \["):
        sheet.read()


@pytest.mark.parametrize(
    ("end", "told"), [((0, 5), r"they end, at \[0, 5\], \[0, 6\]"), ((8, 3), r"they end, at \[0, 6\], \[8, 3\]")]
)
@pytest.mark.parametrize("layers", [{}, {"outline": ["SLAB"]}])
def test_an_outline_that_does_not_close_is_no_hole(end: Any, told: str, layers: Any, sheet: Sheet) -> None:
    sheet.open("SLAB", (0, 6), (8, 6), (8, 0), (0, 0), end)
    sheet.circles("SLAB", (4, 3, 0.5))
    with pytest.raises(InputError, match=rf"0.785398 m², but open lines of layer SLAB .*{told}") as refused:
        sheet.read(**layers)
    assert refused.value.place == "outline"


def test_lines_of_the_outline_that_branch_are_refused_where_they_do(sheet: Sheet) -> None:
    sheet.lines("0", *sides(box(4, 3, 8, 6)))
    sheet.arcs("0", (4, 6, 4, 0, 180))
    sheet.circles("0", (4, 3, 0.5))
    with pytest.raises(InputError, match=r"more than two meet, at \[0, 6\], \[8, 6\]"):
        sheet.read()


@pytest.mark.parametrize(
    ("layer", "message"),
    [
        ("walls", r"no line of layer walls is closed. The longest has 2 sides and ends at \[0, 0\] and"),
        ("none", "layer 'none' .* Its layers are: axes, slab, walls"),
        ("axes", "layer axes has no closed line for the outline"),
    ],
)
def test_layers_without_an_outline_say_what_is_there(layer: str, message: str, sheet: Sheet) -> None:
    sheet.closed(RECTANGLE, "slab")
    sheet.open("walls", (0, 0), (5, 0), (5, 4))
    sheet.space.add_text("A", dxfattribs={"layer": "axes"})
    with pytest.raises(InputError, match=message):
        sheet.read(outline=[layer])


def test_a_frame_that_is_taken_is_told_with_the_slab_s_layer(sheet: Sheet) -> None:
    sheet.closed(RECTANGLE, "SLAB")
    sheet.closed([(-9, -9), (20, -9), (20, 16), (-9, 16)])
    assert "name the slab's layer with --outline: layer SLAB has one of 84 m²" in sheet.read().took[0]
    assert sheet.read(outline=["SLAB"]).took[0].endswith("84 m², layer SLAB")


def test_a_file_that_is_no_drawing_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "notes.dxf"
    path.write_text("thickness 250\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"notes.dxf is not a DXF drawing"):
        read_dxf(path, {})


# Holes and zones


def test_closed_lines_within_the_outline_on_its_layer_are_holes(sheet: Sheet) -> None:
    sheet.closed(RECTANGLE, "A")
    sheet.closed([(2, 2, -1), (3, 2, -1)], "A")
    sheet.circles("A", (6, 3, 0.4), (60, 3, 0.4))
    drawing = sheet.read()
    assert [hole.area for hole in drawing.holes] == pytest.approx([math.pi * 0.5**2, math.pi * 0.4**2])
    assert drawing.left == ("layer A: 1 closed line, at [60, 3]",)


def test_arcs_and_splines_that_mirror_each_other_are_two(sheet: Sheet) -> None:
    for layer, x, radius in (("outline", 0, 5), ("holes", 2, 1)):
        sheet.arcs(layer, *((x, 0, radius, start, start + 180) for start in (0, 180)))
    sheet.arcs("holes", (-2, 0, 2, 60, 120), (-2, 2 * math.sqrt(3), 2, 240, 300))
    for y in (1, -1):
        spline = [(-1, 0), (-0.5, 0.5 * y), (0.5, -0.5 * y), (1, 0)]
        sheet.space.add_open_spline(spline, dxfattribs={"layer": "lines"})
    drawing = sheet.read()
    assert drawing.outline.area == pytest.approx(25 * math.pi)
    assert [hole.area for hole in drawing.holes] == pytest.approx([math.pi, 8 * (math.pi / 6 - math.sqrt(3) / 4)])
    assert not drawing.lines and "lines: 1 closed" in drawing.left[-1]


def test_zones_are_read_and_those_beyond_the_outline_are_told(plate: Sheet) -> None:
    plate.closed(box(2, 1.75, 2, 1.5), "ZONES")
    plate.circles("ZONES", (6, 3, 1.2))
    plate.space.add_lwpolyline([(8, 1), (9, 1, 1), (9, 2)], "xyb", close=True, dxfattribs={"layer": "ZONES"})
    plate.closed(box(12, 1.5, 2, 1), "ZONES")
    drawing = plate.read()
    assert drawing.left == ("zones: 1, at [12, 1.5]: not within the outline",)
    by_form = {next(iter(zone["area"])): zone for zone in written(drawing)["zone"]}
    assert by_form.pop("rectangle") == {"area": {"rectangle": [1, 1, 3, 2.5]}, "thickness": 0.4}
    assert by_form.pop("circle")["area"] == {"circle": {"center": [6, 3], "radius": 1.2}}
    (polygon,) = by_form.values()
    assert polygon["area"]["polygon"] == [[8, 1], [9, 1], {"through": [9.5, 1.5], "to": [9, 2]}]


def test_holes_in_holes_and_holes_that_touch_are_left_and_told(plate: Sheet, tmp_path: Path) -> None:
    plate.circles("holes", (3, 3, 1), (3, 3, 0.5), (7, 3, 1), (9, 3, 1))
    plate.closed([(10, 5), (11, 6), (11, 5), (10, 6)], "zones")
    drawing = plate.read()
    assert [hole.middle for hole in drawing.holes] == [(3, 3), (7, 3)] and not drawing.zones
    assert sorted(left.partition(". ")[0] for left in drawing.left) == [
        "holes: at [3, 3]: hole 2 at [3.5, 3] is inside hole 1",
        "holes: at [9, 3]: hole 3 and hole 4 cross or touch at [8, 3]",
        "zones: at [10.5, 5.5]: The polygon crosses or touches itself: the sides from corners 1 and 3 meet",
    ]
    accepted(drawing, tmp_path)


# Points and lines


def test_footprints_of_points_are_read_from_blocks_turned_scaled_and_repeated(plate: Sheet) -> None:
    column = plate.made.blocks.new("column")
    column.add_lwpolyline(box(0, 0, 2, 4), close=True)
    scaled = {"xscale": 0.1, "yscale": 0.1, "layer": "columns"}
    for x, degrees in ((2, 30), (5, 120), (8, -60), (10, 90)):
        plate.space.add_blockref("column", (x, 3), scaled | {"rotation": degrees})
    plate.space.add_blockref("column", (4, 1), scaled | {"column_count": 2, "column_spacing": 4})
    plate.circles("columns", (1, 1, 0.25))
    plate.points("columns", (5, 5))
    drawing = plate.read(points=["columns"])
    assert found(drawing) == {
        (): [(5, 5)],
        (0.25,): [(1, 1)],
        (0.2, 0.4, 30.0): [(2, 3)],
        (0.4, 0.2, 30.0): [(5, 3), (8, 3)],
        (0.4, 0.2): [(10, 3)],
        (0.2, 0.4): [(4, 1), (8, 1)],
    }
    assert not drawing.left
    turned = {(*one.get("patch", ()), one.get("angle")) for one in written(drawing)["support"]}
    assert turned == {(None,), (0.2, 0.4, 30), (0.4, 0.2, 30), (0.4, 0.2, None), (0.2, 0.4, None)}


def test_filled_columns_have_footprints_and_what_has_none_is_told(plate: Sheet) -> None:
    a, b, c, d = box(1, 1, 0.4, 0.4)
    plate.space.add_solid([a, b, d, c], {"layer": "POINTS"})
    for at in ((3, 1), (5, 1)):
        hatch = plate.space.add_hatch(dxfattribs={"layer": "POINTS"})
        hatch.paths.add_polyline_path(box(*at, 0.4, 0.4), is_closed=True)
    plate.closed(box(5, 1, 0.4, 0.4), "POINTS")
    plate.space.add_hatch(dxfattribs={"layer": "POINTS"}).paths.add_edge_path().add_arc((7, 1), 0.3, 0, 360)
    plate.closed([(8.8, 1), (9, 0.8), (9.2, 1), (9, 1.2)], "POINTS")
    plate.closed([(2.8, 5), (3.2, 5), (3, 5.3)], "POINTS")
    plate.circles("POINTS", (12, 3, 0.2))
    drawing = plate.read()
    points = found(drawing)
    assert points.pop((0.283, 0.283, 45.0), None) or points.pop((0.283, 0.283, -45.0)) == [(9, 1)]
    assert points == {(0.4, 0.4): [(1, 1), (3, 1), (5, 1)], (0.3,): [(7, 1)], (): [(3, 5.15), (12, 3)]}
    assert drawing.left == (
        "points: 1, at [12, 3]: their shape reaches beyond the plate; imported as points without footprint",
        "points: 1, at [3, 5.15]: neither circles nor rectangles; imported as points without footprint",
    )


def test_circles_of_arcs_are_circles(plate: Sheet) -> None:
    plate.closed([(6, 4, 1), (6.4, 4, 1)], "POINTS")
    plate.closed([(2, 2, -1), (2.4, 2, -1)], "POINTS")
    plate.arcs("POINTS", (5, 5, 0.2, 30, 180), (5, 5, 0.2, 180, 30))
    assert found(plate.read()) == {(0.2,): [(2.2, 2), (5, 5), (6.2, 4)]}


def test_a_point_drawn_twice_is_taken_once(plate: Sheet, tmp_path: Path) -> None:
    plate.points("points", (1, 1), (5, 1), (1, 1), (5, 3))
    plate.circles("points", (5, 3, 0.2))
    drawing = plate.read()
    assert drawing.points == {(): [(1, 1), (5, 1)], (0.2,): [(5, 3)]}
    assert drawing.left == ("points: 2, at [1, 1], [5, 3]: drawn twice; taken once",)
    accepted(drawing, tmp_path)


def test_columns_over_the_edge_are_moved_flush_with_it(sheet: Sheet) -> None:
    # An edge that is not quite straight up, and columns that reach over it by 0.07, 0.5 and 3 mm.
    sheet.closed([(0, 0), (10.001, 0), (10, 6.002), (0, 6)], "OUTLINE")
    corners = [(0, 0), (9.601, 0), (9.601, 2.8), (9.603, 5.6), (0, 5.6)]
    for x, y in corners:
        sheet.closed(box(x + 0.2, y + 0.2, 0.4, 0.4), "POINTS")
    sheet.read()
    done = run("import-dxf", sheet.path)
    assert done.exit_code == 0 and "Used: points: 5 of 5" in done.output and "Left out" not in done.output
    assert "points: 3, at [9.801, 0.2], [9.801, 3], [9.803, 5.8]: moved flush with the edge" in done.output
    (support,) = tomllib.loads(sheet.path.with_suffix(".toml").read_text(encoding="utf-8"))["support"]
    assert support["patch"] == [0.4, 0.4]
    for (x, y), at in zip(corners, support["at"], strict=True):
        assert at == pytest.approx([x + 0.2, y + 0.2], abs=0.004)
    check(signorini.load(sheet.path.with_suffix(".toml")))


L_SHAPE = [(0, 0), (12, 0), (12, 4), (6, 4), (6, 7), (0, 7)]
OVER = {
    "a circle": (lambda s: s.circles("POINTS", (11.803, 2, 0.2)), {(0.2,): [(11.8, 2)]}),
    "in a corner": (lambda s: s.closed(box(11.802, 0.196, 0.4, 0.4), "POINTS"), {(0.4, 0.4): [(11.8, 0.2)]}),
    "into a hole": (lambda s: s.closed(box(2.803, 2, 0.4, 0.4), "POINTS"), {(0.4, 0.4): [(2.8, 2)]}),
    "askew": (lambda s: s.closed([(11.703, 2), (11.853, 1.85), (12.003, 2), (11.853, 2.15)], "POINTS"), None),
    "farther": (lambda s: s.closed(box(11.9, 2, 0.4, 0.4), "POINTS"), {(0.3, 0.4): [(11.85, 2)]}),
    "its middle too": (lambda s: s.closed(box(12.1, 2, 0.4, 0.4), "POINTS"), {(0.1, 0.4): [(11.95, 2)]}),
    "over a corner": (lambda s: s.closed(box(11.9, 0.1, 0.4, 0.6), "POINTS"), {(0.3, 0.4): [(11.85, 0.2)]}),
    "far into a hole": (lambda s: s.closed(box(2.9, 2, 0.4, 0.4), "POINTS"), {(0.3, 0.4): [(2.85, 2)]}),
    "a point beside the edge": (lambda s: s.points("POINTS", (12.003, 2)), {(): [(12.003, 2)]}),
}


@pytest.mark.parametrize(("draw", "points"), OVER.values(), ids=OVER)
def test_footprints_over_an_edge_are_moved_or_cut_by_it(draw: Any, points: Any, sheet: Sheet, tmp_path: Path) -> None:
    sheet.closed(L_SHAPE, "OUTLINE")
    sheet.closed(box(4, 2, 2, 2), "HOLES")
    draw(sheet)
    drawing = sheet.read()
    assert not drawing.left and not drawing.lost and drawing.counts == ["holes: 1 of 1", "points: 1 of 1"]
    assert points is None or found(drawing) == points
    accepted(drawing, tmp_path)


def test_a_column_at_a_round_edge_is_moved_flush_with_the_arc(sheet: Sheet, tmp_path: Path) -> None:
    sheet.circles("OUTLINE", (0, 0, 10))
    sheet.circles("POINTS", (9.803 * math.cos(0.4), 9.803 * math.sin(0.4), 0.2))
    drawing = sheet.read()
    (((x, y),),) = drawing.points.values()
    assert math.hypot(x, y) == pytest.approx(9.8, abs=2e-5) and not drawing.left
    accepted(drawing, tmp_path)


LOST = {
    "a circle on the edge": (lambda s: s.circles("POINTS", (12, 2, 0.2)), "points: 1, at [12, 2]: their shape reaches"),
    "at a re-entrant corner": (lambda s: s.closed(box(6, 4, 1, 1), "POINTS"), "points: 1, at [6, 4]: their shape"),
    "a triangle": (lambda s: s.closed([(2, 1), (3, 1), (2.5, 2)], "POINTS"), "points: 1, at [2.5, 1.5]: neither"),
    "off the plate": (lambda s: s.closed(box(14, 2, 1, 1), "POINTS"), "points: 1, at [14, 2]: not on the plate"),
    "open": (lambda s: s.open("POINTS", (1, 1), (2, 1), (2, 2), (1, 2)), "layer POINTS: 1 open line, at [1, 1]"),
    "crossing": (
        lambda s: [s.closed(box(2, 2, *size), "POINTS") for size in ((0.3, 0.6), (0.6, 0.3))],
        "points: 2, at [2, 2], [2, 2]: shapes that cross at one place; none is imported",
    ),
    "a hole at the edge": (lambda s: s.closed(box(12, 2, 1, 1), "HOLES"), "holes: 1, at [12, 2]: not inside"),
    "an opening on the outline's layer": (lambda s: s.circles("OUTLINE", (12, 2, 1)), "holes: 1, at [12, 2]: not in"),
    "holes that touch": (lambda s: s.circles("HOLES", (2, 2, 1), (4, 2, 1)), "holes: at [4, 2]: hole 1 and hole 2"),
    "a zone": (lambda s: s.closed(box(12, 2, 1, 1), "ZONES"), "zones: 1, at [12, 2]: not within the outline"),
    "a wall": (lambda s: s.open("LINES", (2, 2), (13, 2)), "lines: 1, at [2, 2]: not on the plate"),
}


@pytest.mark.parametrize(("draw", "said"), LOST.values(), ids=LOST)
def test_shapes_that_do_not_arrive_are_errors(draw: Any, said: str, sheet: Sheet) -> None:
    sheet.closed(L_SHAPE, "OUTLINE")
    draw(sheet)
    sheet.read()
    done = run("import-dxf", sheet.path)
    assert done.exit_code == 2
    assert f"Error: not used as drawn: {said}" in " ".join(done.output.split())
    assert "points: 1 of 1" in done.output or " 0 of " in done.output or "1 of 2" in done.output
    assert sheet.path.with_suffix(".toml").exists()


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("inner", [box(2, 2, 0.3, 0.3), [(1.8, 2, 1), (2.2, 2, 1)]])
def test_two_shapes_at_one_place_are_a_tube_in_any_order(order: int, inner: Corners, plate: Sheet) -> None:
    for corners in (box(2, 2, 0.5, 0.6), inner)[::order]:
        plate.closed(corners, "POINTS")
    drawing = plate.read()
    assert found(drawing) == {(0.5, 0.6): [(2, 2)]} and not drawing.left
    assert "points: 1, at [2, 2]: tubes, their outer shapes" in drawing.took


def test_zones_and_lines_beside_an_edge_are_taken(plate: Sheet, tmp_path: Path) -> None:
    plate.circles("ZONES", (11.003, 2, 1))
    plate.closed(box(1.997, 2, 4, 1), "ZONES")
    plate.closed([(5, -0.002), (6, -0.002), (5.5, 1)], "ZONES")
    plate.open("LINES", (12.003, 3.5), (12.003, 6.9))
    drawing = plate.read()
    assert not drawing.left and drawing.counts == ["zones: 3 of 3", "lines: 1 of 1"]
    accepted(drawing, tmp_path)


def test_what_is_drawn_inside_a_shape_is_its_symbol(plate: Sheet) -> None:
    plate.closed(box(3, 3, 2, 2), "HOLES")
    plate.lines("HOLES", ((2, 2), (4, 4)), ((2, 4), (4, 2)))
    plate.closed(box(7, 3, 0.4, 0.4), "POINTS")
    plate.lines("POINTS", ((6.8, 2.8), (7.2, 3.2)))
    drawing = plate.read()
    assert not drawing.lost and [line.partition(":")[0] for line in drawing.left] == ["layer HOLES", "layer POINTS"]


U_SHAPE = [(2, 1), (2, 4), (6, 4), (6, 1)]
WALLS = {
    "a long rectangle": ([(box(3, 1.1, 4, 0.2), True)], [(1, 1.1), (5, 1.1)]),
    "askew": ([([(6, 1), (9, 4), (8.9, 4.1), (5.9, 1.1)], True)], [(5.95, 1.05), (8.95, 4.05)]),
    "drawn all around": (
        [([*U_SHAPE[:3], (6, 2), (5.8, 2), (5.8, 3.8), (2.2, 3.8), (2.2, 1)], True)],
        [(2.1, 1), (2.1, 3.9), (5.9, 3.9), (5.9, 2)],
    ),
    "open faces with corners": (
        [(U_SHAPE, False), ([(5.8, 1), (5.8, 3.8), (2.2, 3.8), (2.2, 1)], False)],
        [(2.1, 1), (2.1, 3.9), (5.9, 3.9), (5.9, 1)],
    ),
    "the faces of a shaft": (
        [(box(3.5, 2.5, 3, 3), True), ([(4.8, 3.8), (4.8, 1.2), (2.2, 1.2), (2.2, 3.8)], True)],
        [(2.1, 1.1), (4.9, 1.1), (4.9, 3.9), (2.1, 3.9), (2.1, 1.1)],
    ),
}


@pytest.mark.parametrize(("faces", "middle"), WALLS.values(), ids=WALLS)
def test_a_wall_drawn_with_its_faces_is_the_line_along_its_middle(faces: Any, middle: Corners, plate: Sheet) -> None:
    for corners, closed in faces:
        plate.closed(corners, "LINES") if closed else plate.open("LINES", *corners)
    drawing = plate.read()
    assert middles(drawing) in ([middle], [middle[::-1]]) and not drawing.left


def test_two_lines_as_far_apart_as_the_faces_of_a_wall_are_one(plate: Sheet) -> None:
    plate.lines("LINES", ((1, 1), (6, 1)), ((5.8, 1.2), (1.2, 1.2)), ((8, 1), (8, 5)))
    plate.open("LINES", (1, 4), (4, 4), (4, 6))
    plate.open("LINES", (1, 4.24), (3.76, 4.24), (3.76, 6), (3.7, 6.1))
    drawing = plate.read()
    ends = middles(drawing)
    assert sorted(ends[0]) == [(1.1, 1.1), (5.9, 1.1)] and len(ends) == 4
    faces, beside = drawing.took[-2:]
    assert faces.startswith("lines: 1 pair side by side, 0.2 m apart, at [")
    assert faces.endswith("]: faces of walls, imported as the center lines")
    assert beside == (
        "lines: 1, at [1, 4.24]: beside another, less than 0.6 m apart; both are supports. If they are the faces of "
        "one wall, keep only one"
    )


# Shapes left out


TEE = [(1, 3), (5, 3), (5, 3.2), (3.1, 3.2), (3.1, 5), (2.9, 5), (2.9, 3.2), (1, 3.2)]
LEFT = {
    "slivers": (lambda plate: plate.closed([(1, 1), (3, 1), (3, 1.0002), (1, 1.0002)]), "layer 0: 1 sliver, at [2, 1]"),
    "open lines": (
        lambda plate: plate.lines("0", ((4, -1), (4, 8))),
        "outline: 1 open line of layer 0, at [4, -1]: beyond it.",
    ),
    "no wall": (
        lambda plate: plate.closed(TEE, "LINES"),
        "lines: 1 closed, at [3, 4]: not a wall of constant thickness. Draw its center line, or a",
    ),
}


@pytest.mark.parametrize(("draw", "told"), LEFT.values(), ids=LEFT)
def test_what_cannot_be_taken_is_told_with_its_place(draw: Any, told: str, plate: Sheet) -> None:
    draw(plate)
    assert plate.read().left[0].startswith(told)


def test_what_is_left_is_listed_by_layer_and_kind(sheet: Sheet) -> None:
    sheet.made.layers.add("old").off()
    sheet.closed(RECTANGLE, "slab")
    sheet.space.add_text("C30/37", dxfattribs={"layer": "notes"})
    for layer in ("notes", "old"):
        sheet.lines(layer, ((0, 0), (1, 1)))
    left = sheet.read(outline=["slab"]).left
    assert left == ("layer notes: 1 open line, at [0, 0]; 1 TEXT", "layer old: 1 hidden LINE")


def test_holes_points_and_lines_off_the_plate_are_left_and_told(plate: Sheet) -> None:
    for x in (5.25, 12.05, 20.25):
        plate.closed(box(x, 3.25, 0.5, 0.5), "HOLES")
    plate.points("POINTS", (1, 1), (0, 2), (5.25, 3.25), (13, 0))
    plate.lines("LINES", ((1, 1), (1, 4)), ((5, 1), (5.25, 6)))
    drawing = plate.read()
    assert [hole.middle for hole in drawing.holes] == [(5.25, 3.25)]
    assert drawing.points == {(): [(1, 1), (0, 2)]} and len(drawing.lines) == 1
    assert drawing.left == (
        "holes: 2, at [12.05, 3.25], [20.25, 3.25]: not inside the outline; an opening at an edge must be part of the "
        "outline",
        "points: 2, at [5.25, 3.25], [13, 0]: not on the plate; left out",
        "lines: 1, at [5, 1]: not on the plate; left out",
    )


# The input file


def test_the_command_writes_a_file_once_and_says_what_it_took(plate: Sheet) -> None:
    plate.read()
    first = run("import-dxf", plate.path)
    assert first.exit_code == 0 and "Used: outline: 4 sides, 84 m², layer 0" in first.output
    text = plate.path.with_suffix(".toml").read_text(encoding="utf-8")
    assert tomllib.loads(text)["plate"]["points"] == [[0, 0], [12, 0], [12, 7], [0, 7]]
    again = run("import-dxf", plate.path)
    assert again.exit_code == 2 and "exists; give another name" in again.output


def test_roles_take_several_layers(sheet: Sheet) -> None:
    sheet.closed(box(4, 3, 8, 6), "SLAB")
    for x, layer in ((1, "A"), (5, "B")):
        sheet.closed(box(x + 0.5, 1.5, 1, 1), f"Z{layer}")
        sheet.circles(f"H{layer}", (x, 4, 0.3))
        sheet.points(f"P{layer}", (x, 0.5))
        sheet.lines(f"L{layer}", ((x, 5), (x + 1, 5)))
    sheet.read()
    names = {"zones": "Z", "holes": "H", "points": "P", "lines": "L"}
    roles = [part for role, letter in names.items() for layer in "Ab" for part in (f"--{role}", letter + layer)]
    done = run("import-dxf", sheet.path, "--outline", "SLAB", *roles)
    assert done.exit_code == 0, done.output
    made = tomllib.loads(sheet.path.with_suffix(".toml").read_text(encoding="utf-8"))
    assert len(made["zone"]) == len(made["plate"]["holes"]) == 2
    assert sorted(len(one.get("at", ["line"])) for one in made["support"]) == [1, 1, 2]
    assert "Left" not in done.output and "Add loads." in done.output


def test_a_floor_of_twenty_columns_two_shafts_and_a_drop_panel_goes_from_its_drawing_to_certified_results(
    sheet: Sheet,
) -> None:
    sheet.closed(box(15, 9, 30, 18), "SLAB")
    for x in (0.3, 7.5, 15, 22.5, 29.7):
        for y in (0.3, 6, 12, 17.7):
            hatch = sheet.space.add_hatch(dxfattribs={"layer": "COLUMNS"})
            hatch.paths.add_polyline_path(box(x, y, 0.4, 0.4), is_closed=True)
    for x in (11, 19):
        sheet.closed(box(x, 9, 2.4, 3), "SHAFTS")
    sheet.closed(box(15, 12, 2.6, 2.6), "PANELS")
    drawing = sheet.read(outline=["slab"], holes=["shafts"], zones=["panels"], points=["columns"])
    assert len(drawing.holes) == 2 and len(drawing.zones) == 1 and not drawing.left
    text = drawing_as_toml(drawing, "floor").replace("\npatch", '\nresists = "down"\npatch')
    live = '\n[[load]]\ncase = "live"\npressure = 3e3\n'
    both = '\n[[combination]]\nname = "ULS"\nfactors = { self-weight = 1.35, live = 1.5 }\n'
    target = sheet.path.with_suffix(".toml")
    target.write_text(text + live + both, encoding="utf-8")
    result = signorini.solve(signorini.load(target))["ULS"]
    area = 30 * 18 - 2 * 2.4 * 3
    total = 1.35 * 25e3 * (0.25 * area + 0.15 * 2.6**2) + 1.5 * 3e3 * area
    assert result.certificate.passed and len(result.supports[0].reactions) == 20
    assert sum(result.reactions.values()) == pytest.approx(total, rel=1e-9)
    # The drawing is its own image about the middle of its length, and so are the reactions.
    reactions = result.supports[0].reactions.reshape(5, 4)
    assert reactions[::-1] == pytest.approx(reactions, rel=1e-2)
    widths = signorini.estimate(result).plus_minus["supports"][0]["points"]
    assert all(0 < one["reaction"] < 0.01 * reactions.max() for one in widths)
    assert len(result.stress_nodes.further) >= 4


def ring(random: Random, sheet: Sheet, layer: str, x: float, y: float, radius: float) -> None:
    """A closed shape of lines, arcs and bulges, as one polyline or as many entities, at times one that crosses."""
    count = random.randint(2, 6)
    angles = [math.tau * (i + 0.8 * random.random()) / count for i in range(count)]
    if random.random() < 0.15:
        random.shuffle(angles)
    corners = []
    for angle in angles:
        far = radius * random.uniform(0.5, 1.0)
        corners.append((x + far * math.cos(angle), y + far * math.sin(angle)))
    bulges = [random.choice([0.0, 0.0, random.uniform(-0.6, 1.0)]) for _ in corners]
    bulges[0] = bulges[0] or float(count == 2)
    whole = random.random() < 0.5
    sides = [(*at, bulge) for at, bulge in zip(corners, bulges, strict=True)]
    polyline = sheet.space.add_lwpolyline(sides, "xyb", close=True, dxfattribs={"layer": layer})
    if not whole:
        polyline.explode()


@pytest.mark.parametrize("seed", range(12))
def test_what_is_written_of_random_drawings_is_accepted_or_told(seed: int, sheet: Sheet, tmp_path: Path) -> None:
    random = Random(seed)
    ring(random, sheet, "outline", 0, 0, 10)
    for layer in ("holes", "holes", "zones", "points"):
        ring(random, sheet, layer, random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(0.3, 3))
    sheet.points("points", *((random.randint(-4, 4), random.randint(-4, 4)) for _ in range(6)))
    try:
        drawing = sheet.read()
    except InputError as error:
        assert "cross or touch" in str(error) or "folds back" in str(error)
        return
    if not any(left.startswith("outline: ") for left in drawing.left):
        accepted(drawing, tmp_path)
