"""Stiffness from tables, points and functions: statics of a rigid plate, formulas of the same field, and the door."""

import pickle

import meshio
import numpy as np
import pytest

import signorini
from signorini import Model
from signorini.analysis.check import check
from signorini.errors import InputError, NoEquilibriumError
from signorini.expression import Field
from signorini.results.marks import support_marks

SIDE = 4.0
CORNERS = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]
LOADS = [{"case": "G", "pressure": 10e3}, {"case": "Q", "force": 100e3, "at": [3.1, 1.2]}]


def plate(stiffness, divisions=(8, 8), load=LOADS, young=30e9, **more):
    support = {"name": "bed", "area": "all", "resists": "down", "stiffness": stiffness} | more.pop("bed", {})
    return Model(
        material={"E": young, "nu": 0.2},
        plate={"shape": "rectangle", "size": [SIDE, SIDE], "thickness": 0.25},
        mesh={"divisions": list(divisions), "error": False},
        support=[support],
        load=load,
        **more,
    )


def at_corners(formula):
    return [(x, y, formula(x, y)) for x, y in CORNERS]


def linear(x, y):
    return 1e7 + 4e6 * x


def test_a_rigid_plate_on_a_bed_that_varies_linearly_stands_as_statics_say():
    force, at = 100e3, 2.3
    result = signorini.solve(plate(at_corners(linear), load=[{"force": force, "at": [at, 2]}], young=3e16))["all"]
    # ∫ k (w + θx) dA = F and ∫ k (w + θx) x dA = F·at.
    moment = [SIDE * (1e7 * SIDE ** (n + 1) / (n + 1) + 4e6 * SIDE ** (n + 2) / (n + 2)) for n in range(3)]
    w, slope = np.linalg.solve([moment[:2], moment[1:]], [force, force * at])
    x = result.mesh.points[:, 0]
    assert result.deflection == pytest.approx(w + slope * x, rel=1e-6)
    assert result.pressure([(1, 1), (3, 2)]) == pytest.approx(
        [linear(x, 0) * (w + slope * x) for x in (1, 3)], rel=1e-6
    )


@pytest.mark.parametrize("given", [at_corners(linear), np.array(at_corners(linear)), linear])
def test_points_and_functions_are_the_formula_of_the_same_field(given):
    result, formula = (signorini.solve(plate(one))["all"] for one in (given, "1e7 + 4e6*x"))
    assert result.deflection == pytest.approx(formula.deflection, rel=1e-9)
    assert result.supports[0].reactions == pytest.approx(formula.supports[0].reactions, rel=1e-9)
    assert result.supports[0].contact_area == pytest.approx(formula.supports[0].contact_area, rel=1e-9)


STEP = 1e-6
HALVES = [(x, y, 2e7 if x < 2 else 5e6) for x in (0, 2 - STEP, 2 + STEP, SIDE) for y in (0, SIDE)]


def test_two_areas_and_a_table_of_two_halves_are_one_formula_that_jumps():
    beds = [
        {"name": name, "area": {"rectangle": [x, 0, x + 2, SIDE]}, "resists": "down", "stiffness": k}
        for name, x, k in (("left", 0, 2e7), ("right", 2, 5e6))
    ]
    formula = signorini.solve(plate("where(x < 2, 2e7, 5e6)"))["all"]
    table = plate(HALVES)
    for model in (table, Model(**table.model_dump() | {"support": beds})):
        assert signorini.solve(model)["all"].deflection == pytest.approx(formula.deflection, rel=1e-9)


def soil_under_half(x, y):
    return np.where(x <= 2.0, 1e7, 0.0)


HALF = {"points": [(x, y, 1e7) for x in (0, 2) for y in (0, SIDE)], "outside": 0}
CORNER = {"points": [(0, 0, 1e7), (0.5, 0, 1e7), (0, 4, 1e7)], "outside": 0}
LEFT = [{"pressure": 5e3}, {"force": 300e3, "at": [0.8, 2.2]}]


@pytest.mark.parametrize("given", [HALF, soil_under_half])
def test_without_stiffness_there_is_no_soil(given):
    ends, smaller = (
        signorini.solve(plate(stiffness, load=LEFT, bed=bed))["all"]
        for stiffness, bed in ((given, {}), (1e7, {"area": {"rectangle": [0, 0, 2, SIDE]}}))
    )
    assert ends.deflection == pytest.approx(smaller.deflection, rel=1e-9)
    of, other = ends.supports[0], smaller.supports[0]
    assert of.contact_area == pytest.approx(other.contact_area, rel=1e-9)
    assert of.closed_part == pytest.approx(1.0)
    assert of.max_pressure == pytest.approx(other.max_pressure, rel=1e-9)
    assert np.isnan(ends.pressure([(3, 1)])).all()
    (drawn,) = support_marks(ends)
    assert np.nanmax(drawn.positions[:, 0]) == pytest.approx(2.0)


def test_a_plate_tips_about_the_end_of_its_soil():
    with pytest.raises(NoEquilibriumError, match=r"tips about the line x = 1.9"):
        signorini.solve(plate(HALF, load=[{"pressure": 1e3}, {"force": 1e3, "at": [3, 2]}]))


INNER = [(x, y, linear(x, y)) for x in (1.0, 3.0) for y in (1.0, 3.0)]
WALL = {"name": "wall", "edge": ["left", "bottom"]}
BEDS = [
    ({"name": "bed"}, "covers 25 % of the area of bed; the table reaches from [1, 1] to [3, 3]."),
    ({"name": "strip", "area": {"rectangle": [2, 0, 4, 4]}}, "covers 25 % of the area of strip"),
    ({"name": "disc", "area": {"circle": {"center": [1, 2], "radius": 0.5}}}, "50 % of the area of disc"),
    (WALL | {"line": [[0.5, 2], [2.5, 2]], "edge": None}, "75 % of the length of wall"),
    (WALL, "covers 0 % of the length of wall"),
    ({"name": "piles", "at": [[1, 1], [2, 2], [3, 3], [3.5, 2]]}, "75 % of the points of piles; [3.5, 2] lies beyond"),
]


def bed_on_soil(bed, stiffness):
    soil = {"name": "soil", "area": "all", "resists": "down", "stiffness": 1e6}
    place = {"area": "all"} if not {"area", "at", "edge", "line"} & bed.keys() else {}
    support = [bed | place | {"resists": "down", "stiffness": stiffness}, soil]
    return Model(**plate(1e6).model_dump() | {"support": support})


@pytest.mark.parametrize(("bed", "said"), BEDS)
def test_a_table_that_does_not_cover_a_support_is_refused_with_the_covered_part(bed, said):
    with pytest.raises(InputError) as refused:
        check(bed_on_soil(bed, INNER))
    assert said in str(refused.value)
    assert "support[1].stiffness" in str(refused.value)
    assert 'outside = "nearest"' in str(refused.value)


@pytest.mark.parametrize(("bed", "said"), BEDS)
def test_beyond_a_table_holds_the_value_at_its_nearest_place(bed, said):
    clipped = "1e7 + 4e6*min(max(x, 1), 3)"
    results = [
        signorini.solve(bed_on_soil(bed, stiffness))["all"]
        for stiffness in ({"points": INNER, "outside": "nearest"}, clipped)
    ]
    assert results[0].supports[0].reactions == pytest.approx(results[1].supports[0].reactions, rel=1e-6)


def test_a_table_on_a_plate_of_several_must_cover_its_support():
    model = plate(1e7).model_dump()
    half = {key: value for key, value in model["plate"].items() if key != "holes"}
    plates = {"left": half, "right": half | {"origin": [10.0, 0.0]}}
    soil = {"name": "soil", "area": "all", "resists": "down"}
    support = [soil | {"plate": "left", "stiffness": 1e7}, soil | {"name": "fill", "plate": "right"}]
    for shift, refused in ((10.0, False), (0.0, True)):
        support[1]["stiffness"] = [(x + shift, y, k) for x, y, k in at_corners(linear)]
        whole = {key: value for key, value in model.items() if key != "plate"} | {"plates": plates, "support": support}
        whole["load"] = [{"plate": name, "pressure": 1e3} for name in plates]
        if not refused:
            assert check(Model(**whole)).balanced
            continue
        with pytest.raises(InputError, match=r"support\[2\].stiffness.*covers 0 % of the area of fill"):
            check(Model(**whole))


@pytest.mark.parametrize("where", [{"edge": ["left", "bottom"]}, {"line": [[0.5, 0.5], [3.5, 3]]}, {"at": CORNERS}])
@pytest.mark.parametrize("how", [{"resists": "down"}, {"fix": "simple"}])
def test_lines_edges_and_points_take_their_stiffness_from_a_table(where, how):
    bed = {"name": "wall", **where, **how}
    others = [{"name": "soil", "area": "all", "resists": "down", "stiffness": 1e6}]
    results = []
    for stiffness in (at_corners(linear), "1e7 + 4e6*x"):
        model = plate(1e6)
        support = [bed | {"stiffness": stiffness}, *others]
        results.append(signorini.solve(Model(**model.model_dump() | {"support": support}))["all"])
    assert results[0].supports[0].reactions == pytest.approx(results[1].supports[0].reactions, rel=1e-9)


def test_a_limit_goes_with_a_table():
    bed = {"limit": 30e3}
    table, formula = (signorini.solve(plate(one, bed=bed))["all"] for one in (at_corners(linear), "1e7 + 4e6*x"))
    assert table.supports[0].yielded_area == pytest.approx(formula.supports[0].yielded_area, rel=1e-9)
    assert formula.supports[0].yielded_area > 0.5


def test_combinations_paths_half_widths_and_files_are_those_of_the_formula(tmp_path):
    rows = {"generate": "table", "columns": ["G", "Q"], "rows": {f"row {n}": [1.0, 0.1 * n] for n in range(13)}}
    found = []
    for name, stiffness in (("table", at_corners(linear)), ("formula", "1e7 + 4e6*x")):
        many = signorini.solve(plate(stiffness, combination=[rows]))
        path = signorini.path(plate(stiffness), "G", "Q", until=2.0, steps=4)
        single = signorini.solve(plate(stiffness))
        signorini.write(single, tmp_path / name, estimate := signorini.estimate(single))
        assert (tmp_path / name / "all-pressure.png").exists()
        fields = meshio.read(tmp_path / name / "all.vtu").point_data
        found.append(
            [
                many.table["max_pressure:bed"],
                many.table["contact_area:bed"],
                [stop.t for stop in path.stops],
                path.table["max_pressure:bed"],
                estimate["all"].plus_minus["deflection"]["max"],
                fields["contact_pressure"],
            ]
        )
    for one, other in zip(*found, strict=True):
        assert np.asarray(one) == pytest.approx(np.asarray(other), rel=1e-6)


def test_a_model_with_a_field_is_dumped_copied_and_pickled(tmp_path):
    file = tmp_path / "bedding.csv"
    file.write_text("x, y, value\n" + "\n".join(f"{x}, {y}, {value}" for x, y, value in at_corners(linear)))
    for given in (at_corners(linear), linear, {"file": str(file)}):
        model = plate(given)
        _ = model.support[0].stiffness([1.0], [1.0])
        assert Model(**model.model_dump()) == model
        assert pickle.loads(pickle.dumps(model)) == model
        assert hash(model.support[0]) == hash(Model(**model.model_dump()).support[0])
    assert plate(linear).model_dump()["support"][0]["stiffness"] is linear
    for given in ({"file": str(file)}, {"file": str(file), "outside": "nearest"}, HALF):
        dumped = plate(given).model_dump()["support"][0]["stiffness"]
        assert Model(**plate(dumped).model_dump()) == plate(given)


def test_a_table_is_looked_for_beside_the_input(tmp_path, monkeypatch):
    (tmp_path / "bedding.csv").write_text("0,0,1e7\n4,0,2.6e7\n4,4,2.6e7\n0,4,1e7\n")
    text = """
[material]
E = 30e9
nu = 0.2
[plate]
shape = "rectangle"
size = [4, 4]
thickness = 0.25
[[support]]
area = "all"
resists = "down"
stiffness = { file = "bedding.csv" }
[[load]]
pressure = 1e3
"""
    (tmp_path / "slab.toml").write_text(text)
    stiffness = signorini.load(tmp_path / "slab.toml").support[0].stiffness
    assert stiffness([2.0], [3.0]) == pytest.approx([1.8e7])
    (tmp_path / "slab.toml").write_text(text.replace("bedding", "beding"))
    with pytest.raises(
        InputError, match=r"slab.toml:12: support\[1\].stiffness.file: .*beding.csv cannot be read: No such"
    ):
        signorini.load(tmp_path / "slab.toml")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "found 0 points; at least three are needed."),
        ("x,y,value\n0,0,1\n4,0,1\n", "found 2 points; at least three are needed."),
        ("0,0,1\n1,1,1\n3,3,1\n", "all points are collinear; they must span an area."),
        ("0,0,1\n4,0\n0,4,1\n", "line 2 of bedding.csv has 2 columns; it must have three: x, y, value."),
        ("0;0;1\n4;0;1\n0;4;1\n", "semicolons between its columns"),
        ("x,y,value\n0,0,soft\n4,0,1\n", 'line 2 of bedding.csv has "soft"; it must be a number.'),
        ("0,0,1\n4,0,-1\n0,4,1\n", "found -1 at [4, 0]; it must not be negative."),
        ("0,0,1\n4,0,1\n0,4,1\n4,0,2\n", "found 1 and 2 at [4, 0]; give one value."),
    ],
)
def test_a_file_that_is_no_table_of_points_is_refused(tmp_path, monkeypatch, content, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bedding.csv").write_text(content)
    with pytest.raises(InputError) as refused:
        plate({"file": "bedding.csv"})
    assert said in str(refused.value)
    assert str(refused.value).startswith('support[1].stiffness.file ("bed"): ')


@pytest.mark.parametrize(
    ("given", "more", "said"),
    [
        (CORNER, {}, "gives a stiffness to 0.06"),
        (CORNER, {"area": None, "edge": ["bottom", "right"]}, "to 0.062 of the"),
        (HALF, {"area": None, "at": [[1, 1], [1, 3], [3, 2]]}, "gives no stiffness at [3, 2]. Leave that point out"),
        (lambda x, y: x - 1.0, {}, "it must be finite and not negative"),
        (lambda x, y: 1e7, {}, "it must return one real number per point"),
        ({"fil": "bedding.csv"}, {}, 'found a table of fil; it must be { file = "…" }'),
        ([(0, 0), (1, 1), (0, 1)], {}, "found (0, 0); it must be a point [x, y, value]."),
    ],
)
def test_a_field_that_says_no_stiffness_is_refused(given, more, said):
    with pytest.raises(InputError) as refused:
        signorini.solve(plate(given, bed=more))
    assert said in str(refused.value)
    assert "support[1].stiffness" in str(refused.value)


def test_a_place_on_the_outline_of_a_table_has_its_value_wherever_the_origin_is():
    for shift in (0.0, 1e5):
        turn = np.array([[0.6, -0.8], [0.8, 0.6]])
        at = np.array(CORNERS) @ turn.T + shift
        field = Field(tuple((x, y, 3.0) for x, y in at.tolist()))
        middles = 0.5 * (at + np.roll(at, 1, axis=0))
        assert field(*middles.T) == pytest.approx([3.0] * 4)
        assert field(*(at + 0.01 * (at - at.mean(axis=0))).T) == pytest.approx([0.0] * 4)
