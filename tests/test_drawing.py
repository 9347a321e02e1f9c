"""Drawings: what is read from DXF, what is left, and the input files made of them."""

import math
import tomllib
from pathlib import Path
from random import Random
from typing import Any

import ezdxf
import pytest
from ezdxf.document import Drawing as Document
from ezdxf.layouts import Modelspace
from typer.testing import CliRunner

import signorini
from signorini.analysis.check import check
from signorini.cli.commands import app
from signorini.errors import InputError
from signorini.formats.drawing import Drawing
from signorini.formats.drawing_toml import drawing_as_toml
from signorini.formats.dxf import read_dxf

RECTANGLE = [(0, 0), (12000, 0), (12000, 7000), (0, 7000)]


def document(unit: int = 4) -> Document:
    made = ezdxf.new()
    made.header["$INSUNITS"] = unit
    return made


def on(layer: str) -> dict[str, str]:
    return {"layer": layer}


def saved(made: Document, directory: Path) -> Path:
    path = directory / "floor.dxf"
    made.saveas(path)
    return path


def plate(path: Path, **layers: str) -> dict[str, Any]:
    return tomllib.loads(drawing_as_toml(read_dxf(path, layers), "floor"))["plate"]


def test_sides_drawn_apart_are_joined_in_any_order_and_sense_with_their_arcs(tmp_path: Path) -> None:
    made = document()
    space = made.modelspace()
    space.add_line((10000, 7000), (0, 7000), on("SLAB"))
    space.add_line((12000, 0), (12000, 5000), on("SLAB"))
    space.add_line((12000, 0), (0, 0), on("SLAB"))
    space.add_arc((10000, 5000), 2000, 0, 90, dxfattribs=on("SLAB"))
    space.add_line((0, 7000.4), (0, 0), on("SLAB"))
    space.add_line((0, 0), (12000, 0), on("SLAB"))
    drawing = read_dxf(saved(made, tmp_path), {"outline": ["slab"]})
    assert drawing.outline.area == pytest.approx(12 * 7 - (4 - math.pi), rel=1e-4)
    points = plate(tmp_path / "floor.dxf")["points"]
    (arc,) = (point for point in points if isinstance(point, dict))
    assert len(points) == 5
    assert arc["through"] == pytest.approx([10 + 2 * math.sqrt(0.5), 5 + 2 * math.sqrt(0.5)], abs=1e-6)


@pytest.mark.parametrize(("unit", "size"), [(1, 0.0254), (4, 1e-3), (6, 1.0), (2, 0.3048)])
def test_lengths_are_metres_whatever_the_drawing_has(unit: int, size: float, tmp_path: Path) -> None:
    made = document(unit)
    made.modelspace().add_lwpolyline([(0, 0), (1000, 0), (1000, 500)], close=True)
    assert read_dxf(saved(made, tmp_path), {}).outline.area == pytest.approx(size**2 * 250e3)


def test_a_drawing_without_a_unit_asks_for_one(tmp_path: Path) -> None:
    made = document(0)
    made.modelspace().add_lwpolyline(RECTANGLE, close=True)
    path = saved(made, tmp_path)
    with pytest.raises(InputError, match=r"names no unit of length. Name one of mm, cm"):
        read_dxf(path, {})
    assert read_dxf(path, {}, "mm").outline.area == pytest.approx(84)


def test_closed_lines_within_the_outline_on_its_layer_are_holes(tmp_path: Path) -> None:
    made = document()
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True, dxfattribs=on("A"))
    space.add_lwpolyline([(2000, 2000, -1), (3000, 2000, -1)], format="xyb", close=True, dxfattribs=on("A"))
    space.add_circle((6000, 3000), 400, on("A"))
    space.add_circle((60000, 3000), 400, on("A"))
    drawing = read_dxf(saved(made, tmp_path), {})
    assert [round(hole.area, 6) for hole in drawing.holes] == [round(math.pi * 0.5**2, 6), round(math.pi * 0.4**2, 6)]
    assert drawing.left == ("layer A: 1 closed line, at [60, 3]",)


def arcs(space: Modelspace, layer: str, x: float, y: float, radius: float) -> None:
    for start in (0, 180):
        space.add_arc((x, y), radius, start, start + 180, dxfattribs=on(layer))


def test_arcs_and_splines_that_mirror_each_other_are_two(tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    arcs(space, "outline", 0, 0, 5)
    arcs(space, "holes", 2, 0, 1)
    space.add_arc((-2, 0), 2, 60, 120, dxfattribs=on("holes"))
    space.add_arc((-2, 2 * math.sqrt(3)), 2, 240, 300, dxfattribs=on("holes"))
    for y in (1, -1):
        space.add_open_spline([(-1, 0), (-0.5, 0.5 * y), (0.5, -0.5 * y), (1, 0)], dxfattribs=on("lines"))
    drawing = read_dxf(saved(made, tmp_path), {})
    assert drawing.outline.area == pytest.approx(25 * math.pi)
    assert [hole.area for hole in drawing.holes] == pytest.approx([math.pi, 8 * (math.pi / 6 - math.sqrt(3) / 4)])
    assert not drawing.lines and "lines: 1 closed" in drawing.left[-1]


def test_what_is_drawn_twice_counts_once_in_any_sense(tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    space.add_arc((0, 0), 5, 0, 180)
    space.add_lwpolyline([(-5, 0, -1), (5, 0)], "xyb")
    space.add_line((-5, 0), (5, 0))
    space.add_line((5, 0), (-5, 1e-7))
    drawing = read_dxf(saved(made, tmp_path), {})
    assert drawing.outline.area == pytest.approx(12.5 * math.pi) and not drawing.left


def test_a_whole_turn_drawn_as_an_arc_is_closed(tmp_path: Path) -> None:
    made = document(6)
    made.modelspace().add_arc((1, 2), 5, 0, 360)
    assert read_dxf(saved(made, tmp_path), {}).outline.area == pytest.approx(25 * math.pi)


def test_footprints_of_points_are_read_from_blocks_turned_scaled_and_repeated(tmp_path: Path) -> None:
    made = document()
    column = made.blocks.new("column")
    column.add_lwpolyline([(-1, -2), (1, -2), (1, 2), (-1, 2)], close=True)
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True)
    turned = {"rotation": 90, "xscale": 100, "yscale": 100, "layer": "columns"}
    space.add_blockref("column", (3000, 3000), turned)
    rows = {"xscale": 100, "yscale": 100, "layer": "columns", "column_count": 2, "column_spacing": 4000}
    space.add_blockref("column", (4000, 1000), rows)
    space.add_circle((1000, 1000), 250, on("columns"))
    space.add_point((5000, 5000), dxfattribs=on("columns"))
    points = read_dxf(saved(made, tmp_path), {"points": ["columns"]}).points
    assert {size: [tuple(round(x, 6) for x in at) for at in places] for size, places in points.items()} == {
        (): [(5, 5)],
        (0.25,): [(1, 1)],
        (0.4, 0.2): [(3, 3)],
        (0.2, 0.4): [(4, 1), (8, 1)],
    }


def test_blocks_within_themselves_end(tmp_path: Path) -> None:
    made = document()
    made.blocks.new("a").add_blockref("b", (0, 0))
    made.blocks.new("b").add_blockref("a", (1, 1))
    made.modelspace().add_blockref("a", (0, 0))
    made.modelspace().add_lwpolyline(RECTANGLE, close=True)
    assert read_dxf(saved(made, tmp_path), {}).outline.area == pytest.approx(84)


def test_ellipses_and_splines_become_few_arcs_close_to_them(tmp_path: Path) -> None:
    made = document(6)
    made.modelspace().add_ellipse((0, 0), (8, 0), 0.5)
    outline = read_dxf(saved(made, tmp_path), {}).outline
    assert outline.area == pytest.approx(math.pi * 8 * 4, rel=1e-4) and len(outline.corners) <= 40
    assert all(corner.bulge > 0 for corner in outline.corners)
    made = document(6)
    space = made.modelspace()
    space.add_open_spline([(0, 0), (2, 3), (6, 3), (8, 0)])
    space.add_line((8, 0), (0, 0))
    outline = read_dxf(saved(made, tmp_path), {}).outline
    # Of Bézier's cubic: ∫ y dx with y = 9t(1 − t) and dx = (6 + 12t(1 − t)) dt.
    assert outline.area == pytest.approx(9 + 108 / 30, rel=1e-4)
    assert 4 < len(outline.corners) < 20


def test_an_imported_ellipse_has_no_corners(tmp_path: Path) -> None:
    made = document(6)
    made.modelspace().add_ellipse((0, 0), (6, 0), 0.6)
    target = tmp_path / "ellipse.toml"
    text = drawing_as_toml(read_dxf(saved(made, tmp_path), {}), "ellipse")
    target.write_text(text + "[[support]]\narea = 'all'\nstiffness = 1e7\n", encoding="utf-8")
    assert not check(signorini.load(target)).singular


def test_zones_are_read_and_those_beyond_the_outline_are_told(tmp_path: Path) -> None:
    made = document()
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True)
    panel = [(1000, 1000), (3000, 1000), (3000, 2500), (1000, 2500)]
    beyond = [(11000, 1000), (13000, 1000), (13000, 2000), (11000, 2000)]
    space.add_lwpolyline(panel, close=True, dxfattribs=on("ZONES"))
    space.add_circle((6000, 3000), 1200, on("ZONES"))
    space.add_lwpolyline([(8000, 1000), (9000, 1000, 1), (9000, 2000)], "xyb", close=True, dxfattribs=on("ZONES"))
    space.add_lwpolyline(beyond, close=True, dxfattribs=on("ZONES"))
    drawing = read_dxf(saved(made, tmp_path), {})
    assert len(drawing.zones) == 3
    assert drawing.left == ("zones: 1, at [12, 1.5]: not within the outline",)
    zones = tomllib.loads(drawing_as_toml(drawing, "floor"))["zone"]
    by_form = {next(iter(zone["area"])): zone for zone in zones}
    assert by_form["rectangle"] == {"area": {"rectangle": [1, 1, 3, 2.5]}, "thickness": 0.4}
    assert by_form["circle"]["area"] == {"circle": {"center": [6, 3], "radius": 1.2}}
    assert by_form["polygon"]["area"]["polygon"] == [[8, 1], [9, 1], {"through": [9.5, 1.5], "to": [9, 2]}]


def test_holes_points_and_lines_off_the_plate_are_left_and_told(tmp_path: Path) -> None:
    made = document()
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True)
    for x, y in ((5000, 3000), (11800, 3000), (20000, 3000)):
        corners = [(x, y), (x + 500, y), (x + 500, y + 500), (x, y + 500)]
        space.add_lwpolyline(corners, close=True, dxfattribs=on("HOLES"))
    for at in ((1000, 1000), (0, 2000), (5250, 3250), (13000, 0)):
        space.add_point(at, dxfattribs=on("POINTS"))
    space.add_line((1000, 1000), (1000, 4000), on("LINES"))
    space.add_line((5000, 1000), (5250, 6000), on("LINES"))
    drawing = read_dxf(saved(made, tmp_path), {})
    assert [hole.middle for hole in drawing.holes] == [(5.25, 3.25)]
    assert drawing.points == {(): [(1, 1), (0, 2)]} and len(drawing.lines) == 1
    assert drawing.left == (
        "holes: 2, at [12.05, 3.25], [20.25, 3.25]: not inside the outline; an opening at an edge is part of it",
        "points: 2, at [5.25, 3.25], [13, 0]: not on the plate; left",
        "lines: 1, at [5, 1]: not on the plate; left",
    )


def test_filled_columns_have_footprints_and_what_has_none_is_told(tmp_path: Path) -> None:
    made = document()
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True)

    def square(x: float, y: float) -> list[tuple[float, float]]:
        return [(x - 200, y - 200), (x + 200, y - 200), (x + 200, y + 200), (x - 200, y + 200)]

    a, b, c, d = square(1000, 1000)
    space.add_solid([a, b, d, c], on("POINTS"))
    for at in ((3000, 1000), (5000, 1000)):
        hatch = space.add_hatch(dxfattribs=on("POINTS"))
        hatch.paths.add_polyline_path(square(*at), is_closed=True)
    space.add_lwpolyline(square(5000, 1000), close=True, dxfattribs=on("POINTS"))
    space.add_hatch(dxfattribs=on("POINTS")).paths.add_edge_path().add_arc((7000, 1000), 300, 0, 360)
    space.add_lwpolyline([(8800, 1000), (9000, 800), (9200, 1000), (9000, 1200)], close=True, dxfattribs=on("POINTS"))
    space.add_lwpolyline([(2800, 5000), (3200, 5000), (3000, 5300)], close=True, dxfattribs=on("POINTS"))
    space.add_circle((12000, 3000), 200, on("POINTS"))
    drawing = read_dxf(saved(made, tmp_path), {})
    found = {size: sorted((round(x, 6), round(y, 6)) for x, y in places) for size, places in drawing.points.items()}
    assert found.pop((0.283, 0.283, 45.0), None) or found.pop((0.283, 0.283, -45.0)) == [(9, 1)]
    assert found == {(0.4, 0.4): [(1, 1), (3, 1), (5, 1)], (0.3,): [(7, 1)], (): [(3, 5.15), (12, 3)]}
    assert drawing.left == (
        "points: 1, at [12, 3]: their shape reaches beyond the plate; points without footprint",
        "points: 1, at [3, 5.15]: neither circles nor rectangles; points without footprint",
    )


def test_a_long_rectangle_on_the_layer_of_lines_is_a_wall(tmp_path: Path) -> None:
    made = document()
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True)
    space.add_lwpolyline([(1000, 1000), (5000, 1000), (5000, 1200), (1000, 1200)], close=True, dxfattribs=on("LINES"))
    space.add_lwpolyline([(6000, 1000), (9000, 4000), (8900, 4100), (5900, 1100)], close=True, dxfattribs=on("LINES"))
    drawing = read_dxf(saved(made, tmp_path), {})
    assert [[tuple(round(x, 6) for x in end[:2]) for end in line] for line in drawing.lines] == [
        [(1, 1.1), (5, 1.1)],
        [(5.95, 1.05), (8.95, 4.05)],
    ]
    walls = "lines: walls drawn as closed lines, 2, at [1, 1.1], [5.95, 1.05]: the lines along their middles"
    assert (drawing.took[-1], drawing.left) == (walls, ())


def test_columns_turned_keep_their_footprint(tmp_path: Path) -> None:
    made = document()
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True)
    block = made.blocks.new("COLUMN")
    block.add_lwpolyline([(-300, -150), (300, -150), (300, 150), (-300, 150)], close=True)
    for x, degrees in ((2000, 30), (5000, 120), (8000, -60), (10000, 0)):
        space.add_blockref("COLUMN", (x, 3000), on("POINTS") | {"rotation": degrees})
    drawing = read_dxf(saved(made, tmp_path), {})
    found = {size: sorted((round(x, 6), round(y, 6)) for x, y in places) for size, places in drawing.points.items()}
    assert found == {(0.6, 0.3, 30.0): [(2, 3)], (0.3, 0.6, 30.0): [(5, 3), (8, 3)], (0.6, 0.3): [(10, 3)]}
    assert not drawing.left
    turned = tomllib.loads(drawing_as_toml(drawing, "floor"))["support"]
    assert [(one["patch"], one.get("angle")) for one in turned] == [
        ([0.6, 0.3], 30),
        ([0.3, 0.6], 30),
        ([0.6, 0.3], None),
    ]


def test_two_lines_as_far_apart_as_the_faces_of_a_wall_are_one(tmp_path: Path) -> None:
    made = document()
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True)
    for a, b in (((1000, 1000), (6000, 1000)), ((5800, 1200), (1200, 1200)), ((8000, 1000), (8000, 5000))):
        space.add_line(a, b, on("LINES"))
    space.add_lwpolyline([(1000, 4000), (4000, 4000), (4000, 6000)], dxfattribs=on("LINES"))
    space.add_lwpolyline([(1000, 4240), (3760, 4240), (3760, 6000), (3700, 6100)], dxfattribs=on("LINES"))
    drawing = read_dxf(saved(made, tmp_path), {})
    ends = [[tuple(round(x, 6) for x in end[:2]) for end in line] for line in drawing.lines]
    assert sorted(ends[0]) == [(1.1, 1.1), (5.9, 1.1)] and len(ends) == 4
    faces, beside = drawing.took[-2:]
    assert faces.startswith("lines: 1 pair side by side, 0.2 m apart, at [")
    assert faces.endswith("]: faces of walls, the lines along their middles")
    assert beside == (
        "lines: 1, at [1, 4.24]: beside another, less than 0.6 m apart; both are supports. Keep one where they are the "
        "faces of one wall"
    )


def test_what_is_mirrored_lies_where_it_is_drawn(tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    space.add_lwpolyline([(0, 0), (-4, 0), (-4, 3), (0, 3)], close=True, dxfattribs={"extrusion": (0, 0, -1)})
    assert read_dxf(saved(made, tmp_path), {}).outline.box == pytest.approx((0, 0, 4, 3))


def test_what_is_left_is_listed_by_layer_and_kind(tmp_path: Path) -> None:
    made = document()
    made.layers.add("old").off()
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True, dxfattribs=on("slab"))
    space.add_text("C30/37", dxfattribs=on("notes"))
    space.add_line((0, 0), (1, 1), on("notes"))
    space.add_line((0, 0), (1, 1), on("old"))
    left = read_dxf(saved(made, tmp_path), {"outline": ["slab"]}).left
    assert left == ("layer notes: 1 open line, at [0, 0]; 1 TEXT", "layer old: 1 hidden LINE")


@pytest.mark.parametrize(
    ("layers", "message"),
    [
        ({"outline": ["walls"]}, r"no line of layer walls is closed. The longest has 2 sides and ends at \[0, 0\] and"),
        ({"outline": ["none"]}, "nothing on a layer 'none'. Its layers are: axes, slab, walls"),
        ({"outline": ["axes"]}, "layer axes has no closed line for the outline"),
    ],
)
def test_layers_without_an_outline_say_what_is_there(
    layers: dict[str, list[str]], message: str, tmp_path: Path
) -> None:
    made = document()
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True, dxfattribs=on("slab"))
    space.add_lwpolyline([(0, 0), (5000, 0), (5000, 4000)], dxfattribs=on("walls"))
    space.add_text("A", dxfattribs=on("axes"))
    with pytest.raises(InputError, match=message):
        read_dxf(saved(made, tmp_path), layers)


def test_the_command_writes_a_file_once_and_says_what_it_took(tmp_path: Path) -> None:
    made = document()
    made.modelspace().add_lwpolyline(RECTANGLE, close=True)
    path = saved(made, tmp_path)
    run = CliRunner()
    first = run.invoke(app, ["import-dxf", str(path)])
    assert first.exit_code == 0 and "Taken: outline: 4 sides, 84 m², layer 0" in first.output
    written = path.with_suffix(".toml").read_text(encoding="utf-8")
    assert tomllib.loads(written)["plate"]["points"] == [[0, 0], [12, 0], [12, 7], [0, 7]]
    again = run.invoke(app, ["import-dxf", str(path)])
    assert again.exit_code == 2 and "exists already" in again.output


def test_a_file_that_is_no_drawing_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "notes.dxf"
    path.write_text("thickness 250\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"notes.dxf is no DXF drawing"):
        read_dxf(path, {})


def test_an_imported_floor_is_solved_once_it_has_its_loads(tmp_path: Path) -> None:
    made = document()
    space = made.modelspace()
    space.add_lwpolyline([(0, 0), (6000, 0), (6000, 2000, 0.3), (5000, 4000), (0, 4000)], "xyb", close=True)
    space.add_circle((3000, 2500), 300)
    for at in ((500, 500), (5500, 500), (5000, 3500), (500, 3500)):
        x, y = at
        corners = [(x - 200, y - 200), (x + 200, y - 200), (x + 200, y + 200), (x - 200, y + 200)]
        space.add_lwpolyline(corners, close=True, dxfattribs=on("points"))
    space.add_line((0, 1000), (0, 3000), on("lines"))
    path = saved(made, tmp_path)
    text = drawing_as_toml(read_dxf(path, {}), "floor")
    target = tmp_path / "floor.toml"
    target.write_text(text.replace("size = 0.2", "size = 0.5"), encoding="utf-8")
    result = signorini.solve(signorini.load(target))["all"]
    arc = math.hypot(1, 2) / 2 / math.sin(2 * math.atan(0.3))
    turn = 4 * math.atan(0.3)
    area = 24 - 1 + arc**2 * (turn - math.sin(turn)) / 2 - math.pi * 0.3**2
    assert result.certificate.passed
    assert sum(result.reactions.values()) == pytest.approx(25e3 * 0.25 * area, rel=1e-3)


def test_a_floor_of_twenty_columns_two_shafts_and_a_drop_panel_goes_from_its_drawing_to_certified_results(
    tmp_path: Path,
) -> None:
    made = document()
    space = made.modelspace()

    def box(x: float, y: float, a: float, b: float) -> list[tuple[float, float]]:
        return [(x - a / 2, y - b / 2), (x + a / 2, y - b / 2), (x + a / 2, y + b / 2), (x - a / 2, y + b / 2)]

    space.add_lwpolyline([(0, 0), (30000, 0), (30000, 18000), (0, 18000)], close=True, dxfattribs=on("SLAB"))
    for x in (300, 7500, 15000, 22500, 29700):
        for y in (300, 6000, 12000, 17700):
            space.add_hatch(dxfattribs=on("COLUMNS")).paths.add_polyline_path(box(x, y, 400, 400), is_closed=True)
    for x in (11000, 19000):
        space.add_lwpolyline(box(x, 9000, 2400, 3000), close=True, dxfattribs=on("SHAFTS"))
    space.add_lwpolyline(box(15000, 12000, 2600, 2600), close=True, dxfattribs=on("PANELS"))
    layers = {"outline": ["slab"], "holes": ["shafts"], "zones": ["panels"], "points": ["columns"]}
    drawing = read_dxf(saved(made, tmp_path), layers)
    assert len(drawing.holes) == 2 and len(drawing.zones) == 1 and not drawing.left
    text = drawing_as_toml(drawing, "floor").replace("\npatch", '\nresists = "down"\npatch')
    live = '\n[[load]]\ncase = "live"\npressure = 3e3\n'
    both = '\n[[combination]]\nname = "ULS"\nfactors = { self-weight = 1.35, live = 1.5 }\n'
    (tmp_path / "floor.toml").write_text(text + live + both, encoding="utf-8")
    results = signorini.solve(signorini.load(tmp_path / "floor.toml"))
    result = results["ULS"]
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


def accepted(drawing: Drawing, directory: Path) -> None:
    """Check what is written of a drawing, on soil so that it stands."""
    target = directory / "floor.toml"
    target.write_text(drawing_as_toml(drawing, "floor") + "\n[[support]]\narea = 'all'\nstiffness = 1e7\n", "utf-8")
    check(signorini.load(target))


@pytest.mark.parametrize("end", [180, 30, 10])
@pytest.mark.parametrize("begin", [0, 180])
def test_an_arc_and_its_chord_are_read_back(begin: int, end: int, tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    for layer, (x, radius) in {"outline": (0, 50), "zones": (20, 9), "holes": (-20, 9)}.items():
        y = 0 if layer == "outline" else 15 * math.cos(math.radians(begin))
        arc = space.add_arc((x, y), radius, begin, begin + end, dxfattribs=on(layer))
        space.add_line(arc.start_point, arc.end_point, on(layer))
    drawing = read_dxf(saved(made, tmp_path), {})
    turn = math.radians(end)
    assert drawing.outline.area == pytest.approx(50**2 * (turn - math.sin(turn)) / 2)
    assert end < 180 or (len(drawing.holes), len(drawing.zones), drawing.left) == (1, 1, ())
    accepted(drawing, tmp_path)


def test_a_point_drawn_twice_is_taken_once(tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    space.add_lwpolyline([(0, 0), (6, 0), (6, 4), (0, 4)], close=True)
    for at in ((1, 1), (5, 1), (1, 1), (5, 3)):
        space.add_point(at, dxfattribs=on("points"))
    space.add_circle((5, 3), 0.2, on("points"))
    drawing = read_dxf(saved(made, tmp_path), {})
    assert drawing.points == {(): [(1, 1), (5, 1)], (0.2,): [(5, 3)]}
    assert drawing.left == ("points: 2, at [1, 1], [5, 3]: drawn twice; taken once",)
    accepted(drawing, tmp_path)


def test_holes_in_holes_and_holes_that_touch_are_left_and_told(tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    space.add_lwpolyline([(0, 0), (12, 0), (12, 7), (0, 7)], close=True)
    for x, y, radius in ((3, 3, 1), (3, 3, 0.5), (7, 3, 1), (9, 3, 1)):
        space.add_circle((x, y), radius, on("holes"))
    space.add_lwpolyline([(10, 5), (11, 6), (11, 5), (10, 6)], close=True, dxfattribs=on("zones"))
    drawing = read_dxf(saved(made, tmp_path), {})
    assert [hole.middle for hole in drawing.holes] == [(3, 3), (7, 3)] and not drawing.zones
    assert sorted(left.partition(". ")[0] for left in drawing.left) == [
        "holes: at [3, 3]: hole 2 at [3.5, 3] is inside hole 1",
        "holes: at [9, 3]: hole 3 and hole 4 cross or touch at [8, 3]",
        "zones: at [10.5, 5.5]: The polygon crosses or touches itself: the sides from corners 1 and 3 meet",
    ]
    accepted(drawing, tmp_path)


@pytest.mark.parametrize("right", [4, 5])
def test_an_outline_that_crosses_itself_is_refused_with_the_place(right: float, tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    space.add_lwpolyline([(0, 0), (4, 4), (right, 0), (0, 4)], close=True, dxfattribs=on("outline"))
    space.add_circle((1, 2), 0.1, on("outline"))
    with pytest.raises(InputError, match=r"outline: .*edge 1 and edge 3 cross or touch at \["):
        read_dxf(saved(made, tmp_path), {})


def test_slivers_are_left_with_their_place(tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    space.add_lwpolyline([(0, 0), (6, 0), (6, 4), (0, 4)], close=True)
    space.add_lwpolyline([(1, 1), (3, 1), (3, 1.0002), (1, 1.0002)], close=True)
    assert read_dxf(saved(made, tmp_path), {}).left == ("layer 0: 1 sliver, at [2, 1]",)


def ring(random: Random, space: Modelspace, layer: str, x: float, y: float, radius: float) -> None:
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
    polyline = space.add_lwpolyline(sides, "xyb", close=True, dxfattribs=on(layer))
    if not whole:
        polyline.explode()


@pytest.mark.parametrize("seed", range(12))
def test_what_is_written_of_random_drawings_is_accepted_or_told(seed: int, tmp_path: Path) -> None:
    random = Random(seed)
    made = document(6)
    space = made.modelspace()
    ring(random, space, "outline", 0, 0, 10)
    for layer in ("holes", "holes", "zones", "points"):
        ring(random, space, layer, random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(0.3, 3))
    for _ in range(6):
        space.add_point((random.randint(-4, 4), random.randint(-4, 4)), dxfattribs=on("points"))
    try:
        drawing = read_dxf(saved(made, tmp_path), {})
    except InputError as error:
        assert "cross or touch" in str(error) or "folds back" in str(error)
        return
    if not any(left.startswith("outline: ") for left in drawing.left):
        accepted(drawing, tmp_path)


def walled(made: Document, *lines: tuple[list[tuple[float, float]], bool]) -> None:
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True)
    for corners, closed in lines:
        space.add_lwpolyline(corners, close=closed, dxfattribs=on("LINES"))


def middles(drawing: Drawing) -> list[list[tuple[float, float]]]:
    return [[(round(x, 6), round(y, 6)) for x, y, _ in line] for line in drawing.lines]


def test_collinear_lines_that_overlap_are_one(tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    for a, b in (((0, 0), (5, 0)), ((4, 0), (7, 0)), ((8, 0), (6, 0)), ((8, 0), (8, 6)), ((8, 6), (0, 6))):
        space.add_line(a, b, on("SLAB"))
    space.add_line((0, 6), (0, 0), on("SLAB"))
    space.add_line((2, 6), (3, 6), on("SLAB"))
    space.add_circle((4, 3), 0.5, on("SLAB"))
    drawing = read_dxf(saved(made, tmp_path), {"outline": ["SLAB"]})
    assert (drawing.outline.area, len(drawing.holes), drawing.left) == (48, 1, ())


def test_a_notch_that_shares_a_part_of_the_outline_keeps_it(tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    for corners in ([(0, 0), (8, 0), (8, 6), (0, 6)], [(2, 0), (4, 0), (4, 1), (2, 1)]):
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            space.add_line(a, b, on("SLAB"))
    assert read_dxf(saved(made, tmp_path), {}).outline.area == 48


@pytest.mark.parametrize(
    ("end", "told"), [((0, 5), r"they end, at \[0, 5\], \[0, 6\]"), ((8, 3), r"they end, at \[0, 6\], \[8, 3\]")]
)
@pytest.mark.parametrize("layers", [{}, {"outline": ["SLAB"]}])
def test_an_outline_that_does_not_close_is_no_hole(
    end: tuple[float, float], told: str, layers: dict[str, list[str]], tmp_path: Path
) -> None:
    made = document(6)
    made.modelspace().add_lwpolyline([(0, 6), (8, 6), (8, 0), (0, 0), end], dxfattribs=on("SLAB"))
    made.modelspace().add_circle((4, 3), 0.5, on("SLAB"))
    with pytest.raises(InputError, match=rf"0.785398 m², but open lines of layer SLAB .*{told}") as refused:
        read_dxf(saved(made, tmp_path), layers)
    assert refused.value.place == "outline"


def test_lines_of_the_outline_that_branch_are_refused_where_they_do(tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    for a, b in (((0, 0), (8, 0)), ((8, 0), (8, 6)), ((8, 6), (0, 6)), ((0, 6), (0, 0))):
        space.add_line(a, b)
    space.add_arc((4, 6), 4, 0, 180)
    space.add_circle((4, 3), 0.5)
    with pytest.raises(InputError, match=r"more than two meet, at \[0, 6\], \[8, 6\]"):
        read_dxf(saved(made, tmp_path), {})


def test_open_lines_beyond_the_outline_are_told(tmp_path: Path) -> None:
    made = document(6)
    made.modelspace().add_lwpolyline([(0, 0), (8, 0), (8, 6), (0, 6)], close=True)
    made.modelspace().add_line((4, -1), (4, 7))
    (told, _) = read_dxf(saved(made, tmp_path), {}).left
    assert told.startswith("outline: 1 open line of layer 0, at [4, -1]: beyond it.")


def test_a_frame_that_is_taken_is_told_with_the_slab_s_layer(tmp_path: Path) -> None:
    made = document()
    space = made.modelspace()
    space.add_lwpolyline(RECTANGLE, close=True, dxfattribs=on("SLAB"))
    space.add_lwpolyline([(-9000, -9000), (20000, -9000), (20000, 16000), (-9000, 16000)], close=True)
    path = saved(made, tmp_path)
    assert "name the slab's layer with --outline: layer SLAB has one of 84 m²" in read_dxf(path, {}).took[0]
    assert read_dxf(path, {"outline": ["SLAB"]}).took[0].endswith("84 m², layer SLAB")


def test_roles_take_several_layers(tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    space.add_lwpolyline([(0, 0), (8, 0), (8, 6), (0, 6)], close=True, dxfattribs=on("SLAB"))
    for i, layer in enumerate("AB"):
        x = 1 + 4 * i
        space.add_lwpolyline([(x, 1), (x + 1, 1), (x + 1, 2), (x, 2)], close=True, dxfattribs=on(f"Z{layer}"))
        space.add_circle((x, 4), 0.3, on(f"H{layer}"))
        space.add_point((x, 0.5), on(f"P{layer}"))
        space.add_line((x, 5), (x + 1, 5), on(f"L{layer}"))
    roles = [
        part
        for role in ("zones", "holes", "points", "lines")
        for part in (f"--{role}", f"{role[0].upper()}A", f"--{role}", f"{role[0]}b")
    ]
    run = CliRunner().invoke(app, ["import-dxf", str(saved(made, tmp_path)), "--outline", "SLAB", *roles])
    assert run.exit_code == 0, run.output
    written = tomllib.loads((tmp_path / "floor.toml").read_text(encoding="utf-8"))
    assert len(written["zone"]) == len(written["plate"]["holes"]) == 2
    assert sorted(len(one.get("at", ["line"])) for one in written["support"]) == [1, 1, 2]
    assert "Left" not in run.output and "Add loads." in run.output


def test_a_wall_drawn_all_around_is_the_line_along_its_middle(tmp_path: Path) -> None:
    made = document()
    outer, inner = [(2000, 1000), (2000, 4000), (6000, 4000), (6000, 2000)], [(2200, 1000), (2200, 3800)]
    walled(made, ([*outer, (5800, 2000), (5800, 3800), *reversed(inner)], True))
    drawing = read_dxf(saved(made, tmp_path), {})
    assert not drawing.left
    ((*found,),) = middles(drawing)
    assert found in ([(2.1, 1), (2.1, 3.9), (5.9, 3.9), (5.9, 2)], [(5.9, 2), (5.9, 3.9), (2.1, 3.9), (2.1, 1)])


def test_open_faces_with_corners_are_one_wall(tmp_path: Path) -> None:
    made = document()
    walled(
        made,
        ([(2000, 1000), (2000, 4000), (6000, 4000), (6000, 1000)], False),
        ([(5800, 1000), (5800, 3800), (2200, 3800), (2200, 1000)], False),
    )
    drawing = read_dxf(saved(made, tmp_path), {})
    assert not drawing.left
    assert middles(drawing) == [[(2.1, 1), (2.1, 3.9), (5.9, 3.9), (5.9, 1)]]


def test_the_faces_of_a_shaft_are_one_closed_wall(tmp_path: Path) -> None:
    made = document()
    walled(
        made,
        ([(2000, 1000), (5000, 1000), (5000, 4000), (2000, 4000)], True),
        ([(4800, 3800), (4800, 1200), (2200, 1200), (2200, 3800)], True),
    )
    drawing = read_dxf(saved(made, tmp_path), {})
    assert not drawing.left
    assert middles(drawing) == [[(2.1, 1.1), (4.9, 1.1), (4.9, 3.9), (2.1, 3.9), (2.1, 1.1)]]


def test_a_closed_line_that_is_no_wall_says_what_to_draw(tmp_path: Path) -> None:
    made = document()
    tee = [(1, 3), (5, 3), (5, 3.2), (3.1, 3.2), (3.1, 5), (2.9, 5), (2.9, 3.2), (1, 3.2)]
    walled(made, ([(1000 * x, 1000 * y) for x, y in tee], True))
    (told,) = read_dxf(saved(made, tmp_path), {}).left
    assert told.startswith("lines: 1 closed, at [3, 4]: no wall of one thickness. Draw its middle, or a rectangle")


def test_circles_of_arcs_are_circles(tmp_path: Path) -> None:
    made = document(6)
    space = made.modelspace()
    space.add_lwpolyline([(0, 0), (8, 0), (8, 6), (0, 6)], close=True)
    space.add_lwpolyline([(6, 4, 1), (6.4, 4, 1)], format="xyb", close=True, dxfattribs=on("POINTS"))
    space.add_lwpolyline([(2, 2, -1), (2.4, 2, -1)], format="xyb", close=True, dxfattribs=on("POINTS"))
    space.add_arc((5, 5), 0.2, 30, 180, dxfattribs=on("POINTS"))
    space.add_arc((5, 5), 0.2, 180, 30, dxfattribs=on("POINTS"))
    (places,) = [read_dxf(saved(made, tmp_path), {}).points[0.2,]]
    assert sorted((round(x, 6), round(y, 6)) for x, y in places) == [(2.2, 2), (5, 5), (6.2, 4)]
