"""The domain of validity: models just inside each limit are certified, those just outside are refused."""

from pathlib import Path

import pytest
from models import rectangular
from typer.testing import CliRunner

from signorini import InputError, Model, path, solve
from signorini.analysis.check import check
from signorini.cli import app
from signorini.discretise import discretise

SIZE, THICKNESS = 10.0, 0.4
LEAST = 0.1 * THICKNESS
INSIDE, OUTSIDE = 1.01 * LEAST, 0.99 * LEAST
CORNERS = {"name": "corners", "at": [[1, 1], [9, 1], [9, 9], [1, 9]], "resists": "down"}
WALL = {"name": "walls", "edge": ["left", "right"], "fix": "simple"}
HINGE = {"name": "hinge", "edge": "left", "fix": "simple"}
BEAM = {"name": "beam", "line": [[2, 3], [8, 3]], "fix": "simple"}
RING = {"name": "ring", "circle": {"center": [5, 6], "radius": 1.5}, "fix": "simple"}
PAD = {"name": "pad", "area": {"rectangle": [4, 5, 6, 7]}, "resists": "down"}


def model(*support: dict, **others: object) -> Model:
    given = {
        "size": [SIZE, SIZE],
        "thickness": THICKNESS,
        "mesh": {"divisions": [6, 6], "error": False},
        "load": [{"pressure": 1e3}],
    }
    return rectangular(**given | others, support=list(support))


def is_certified(asked: Model) -> bool:
    return all(result.certificate.passed for result in solve(asked).values())


def said(asked: Model) -> str:
    """The common message of solve, check and path."""
    words = set()
    for ask in (solve, check, lambda of: path(of, None, "load")):
        with pytest.raises(InputError) as refused:
            ask(asked)
        words.add(str(refused.value))
    (one,) = words
    return one


NEAR = {
    "two points of one support": lambda d: [{"name": "near", "at": [[5, 5], [5 + d, 5], [2, 2]], "resists": "down"}],
    "footprints": lambda d: [CORNERS, {"name": "near", "at": [[5, 5], [5 + d, 5]], "radius": 0.3, "fix": "simple"}],
    "a point and an edge": lambda d: [WALL, {"name": "near", "at": [d, 4.3], "resists": "down"}],
    "the end of a line": lambda d: [WALL, BEAM, {"name": "near", "line": [[5, 3 + d], [5, 8]], "fix": "simple"}],
    "a line and an edge": lambda d: [WALL, {"name": "near", "line": [[d, 2], [d, 6]], "resists": "down"}],
    "circles": lambda d: [RING, {"name": "near", "circle": {"center": [5, 6], "radius": 1.5 + d}, "resists": "down"}],
    "areas": lambda d: [WALL, PAD, {"name": "near", "area": {"rectangle": [6 + d, 5, 8, 7]}, "resists": "down"}],
}


@pytest.mark.parametrize("supports", NEAR.values(), ids=NEAR)
def test_rigid_supports_a_tenth_of_the_thickness_apart_are_certified_and_nearer_ones_refused(supports) -> None:
    assert is_certified(model(*supports(INSIDE)))
    words = said(model(*supports(OUTSIDE)))
    assert "holds the plate rigidly at [" in words and "0.0396 from the " in words
    assert "at least a tenth of the thickness apart, here 0.04." in words and "give one a stiffness" in words
    assert words.startswith("support[") and "near" in words


@pytest.mark.parametrize("supports", NEAR.values(), ids=NEAR)
@pytest.mark.parametrize("stiffness", [1e3, 1e9])
def test_elastic_ones_may_be_at_any_distance(supports, stiffness) -> None:
    *others, near = supports(OUTSIDE)
    elastic = near | {"stiffness": stiffness}
    assert is_certified(model(*others, elastic) if others else model(elastic))


def test_one_so_stiff_that_it_is_as_good_as_rigid_counts_as_rigid() -> None:
    """From 10¹² of D/L² on, which is 2.6e16 here."""
    near = {"name": "near", "at": [0.0099, 4.3], "resists": "down"}
    below, above = (near | {"stiffness": part * 2.6041667e16} for part in (0.99, 1.01))
    assert is_certified(model(WALL, below, thickness=0.1))
    assert "0.0099 from the edge left of walls" in said(model(WALL, above, thickness=0.1))


ONE_PLACE = {
    "points": [CORNERS, {"at": [[1, 1], [9, 9]], "resists": "up"}, {"at": [1, 1], "resists": "down"}],
    "a point on an edge and on a line": [WALL, BEAM, {"at": [[0, 4.3], [4.1, 3]], "resists": "down"}],
    "lines that cross and meet": [WALL, BEAM, {"line": [[0, 2], [4, 3], [7, 6]], "resists": "down"}],
    "lines that cross at a small angle": [WALL, BEAM, {"line": [[2, 2.9], [8, 3.1]], "resists": "down"}],
    "areas side by side and a line within": [
        WALL,
        PAD,
        {"area": {"rectangle": [6, 5, 8, 7]}, "resists": "down"},
        {"line": [[4.01, 5.01], [4.01, 6.99]], "resists": "down"},
    ],
    "a point in an area": [WALL, PAD, {"at": [5.99, 6], "resists": "down"}],
}


@pytest.mark.parametrize("supports", ONE_PLACE.values(), ids=ONE_PLACE)
def test_rigid_supports_at_one_place_are_certified(supports) -> None:
    assert is_certified(model(*supports))


FLOOR = {"name": "floor", "area": "all", "resists": "down"}
ANCHORS = {"name": "anchors", "resists": "up"}
BOLTED = [[2, 2], [8, 2], [8, 8], [2, 8]]
OPPOSED: dict[str, list[dict]] = {
    "points": [FLOOR, ANCHORS | {"at": BOLTED}],
    "points that hold both ways": [FLOOR, ANCHORS | {"at": BOLTED, "resists": "both"}],
    "points that hold all": [FLOOR, ANCHORS | {"at": BOLTED, "resists": None, "fix": "clamped"}],
    "points between nodes": [FLOOR, ANCHORS | {"at": [[2.3, 2.1], [7.2, 6.7]]}],
    "a vertical law": [FLOOR, ANCHORS | {"at": BOLTED, "law": [[0, 0], [0, 5e3]]}],
    "preloaded bolts": [FLOOR, ANCHORS | {"at": BOLTED, "preload": 5e3}],
    "washers": [FLOOR, ANCHORS | {"at": BOLTED, "radius": 0.3}],
    "square washers": [FLOOR, ANCHORS | {"at": BOLTED, "patch": [0.5, 0.3], "fix": "simple", "resists": None}],
    "points at an edge": [FLOOR, ANCHORS | {"at": [[0, 3], [0, 7]]}],
    "a line": [FLOOR, ANCHORS | {"line": [[2, 2], [2, 8]]}],
    "a circle": [FLOOR, ANCHORS | {"circle": {"center": [5, 5], "radius": 3}, "fix": "simple", "resists": None}],
    "an area": [FLOOR, ANCHORS | {"area": {"rectangle": [2, 2, 4, 8]}}],
    "a point within one area": [WALL, PAD, ANCHORS | {"at": [5, 6]}],
    "a line on the outline of an area": [WALL, PAD, ANCHORS | {"line": [[4, 4], [4, 8]]}],
    "an area that holds both ways": [FLOOR, ANCHORS | {"area": {"rectangle": [2, 2, 4, 8]}, "resists": "both"}],
    "an area that holds down": [WALL, FLOOR | {"resists": "up"}, ANCHORS | {"at": BOLTED, "resists": "down"}],
    "settled alike": [FLOOR | {"settlement": 0.01}, ANCHORS | {"at": BOLTED, "settlement": 0.01}],
    "gaps alike": [WALL, FLOOR | {"gap": 0.01}, ANCHORS | {"at": BOLTED, "settlement": 0.01}],
}


@pytest.mark.parametrize("supports", OPPOSED.values(), ids=OPPOSED)
def test_rigid_supports_that_oppose_each_other_are_refused(supports) -> None:
    given = [{key: value for key, value in one.items() if value is not None} for one in supports]
    words = said(model(*given))
    assert "floor" in words or "pad" in words
    assert "anchors" in words and "both are rigid" in words and "Give one of the two a stiffness" in words
    *others, anchors = given
    if "law" not in anchors and anchors.get("fix") != "clamped":
        discretise(model(*others, anchors | {"stiffness": 1e7}))


BODY = {"rigid": True, "area": {"rectangle": [0, 0, 5, 5]}}
NOT_OPPOSED: dict[str, list[dict]] = {
    "the edge of the plate": [FLOOR, {"edge": "left", "resists": "both"}],
    "a line along the edge of the plate": [FLOOR, {"line": [[0, 0], [0, 10]], "resists": "up"}],
    "corners of the plate": [FLOOR, {"at": [[0, 0], [0, 10], [10, 0], [10, 10]], "resists": "up"}],
    "a line that holds its slope": [FLOOR, {"line": [[2, 2], [2, 8]], "fix": "clamped"}],
    "points within a rigid zone": [FLOOR, {"at": [[1.5, 1.5], [2.5, 3]], "resists": "up"}],
    "washers within a rigid zone": [FLOOR, {"at": [[1.5, 1.5], [2.5, 3]], "radius": 0.2, "resists": "up"}],
    "points that push as the area does": [FLOOR, {"at": BOLTED, "resists": "down"}],
    "an area that holds both ways": [FLOOR | {"resists": "both"}, {"at": BOLTED, "resists": "up"}],
    "areas that hold both ways together": [FLOOR, FLOOR | {"name": "lid", "resists": "up"}, {"at": BOLTED}],
    "an area within one that holds both ways": [WALL, PAD, FLOOR | {"resists": "both"}],
    "clearance": [FLOOR | {"gap": 0.001}, {"at": BOLTED, "resists": "up"}],
    "anchors that yield": [FLOOR, {"at": BOLTED, "resists": "up", "limit": 1e4}],
    "beside the area": [WALL, PAD, {"at": [3.5, 6], "resists": "up"}],
    "areas that touch": [WALL, PAD, {"area": {"rectangle": [6, 5, 8, 7]}, "resists": "up"}],
}


@pytest.mark.parametrize("supports", NOT_OPPOSED.values(), ids=NOT_OPPOSED)
def test_others_do_not_oppose_each_other(supports) -> None:
    zone = [BODY] if supports[-1].get("at") in ([[1.5, 1.5], [2.5, 3]],) else []
    assert is_certified(model(*supports, zone=zone))


def test_opposed_supports_between_plates_are_refused() -> None:
    plate = {"shape": "rectangle", "size": [4, 4], "thickness": 0.2}
    given = {
        "material": {"E": 30e9, "nu": 0.2},
        "plates": {"upper": plate, "lower": plate},
        "mesh": {"divisions": [4, 4], "error": False},
        "contact": [{"name": "bearing", "between": ["upper", "lower"], "area": "all"}],
        "load": [{"plate": "upper", "pressure": 1e3}],
    }
    bolts = {"name": "bolts", "between": ["upper", "lower"], "at": [[1, 1], [3, 3]], "resists": "up"}
    base = {"plate": "lower", "edge": ["left", "right"], "fix": "simple"}
    words = said(Model(**given, support=[base, bolts | {"radius": 0.1}]))
    assert "bolts" in words and "bearing" in words and "both are rigid" in words
    assert is_certified(Model(**given, support=[base, bolts | {"stiffness": 1e8}]))


@pytest.mark.parametrize("washers", [{}, {"radius": 20}])
def test_reactions_of_elastic_anchors_on_a_rigid_floor_have_a_limit(washers) -> None:
    def base_plate(size: int) -> Model:
        couple = {"couple_about": {"y": -30e6}, "at": [200, 150], "patch": [120, 120]}
        return Model(
            material={"E": 210e3, "nu": 0.3},
            plate={"shape": "rectangle", "size": [400, 300], "thickness": 20},
            mesh={"size": size, "error": False},
            support=[
                FLOOR,
                ANCHORS | washers | {"at": [[50, 50], [350, 50], [350, 250], [50, 250]], "stiffness": 3e5},
            ],
            load=[{"force": 50e3, "at": [200, 150], "patch": [120, 120]}, couple],
        )

    pulls = [solve(base_plate(size))["all"].supports[1].reactions.min() for size in (40, 20)]
    assert pulls[0] == pytest.approx(pulls[1], rel=0.02)
    assert pulls[1] == pytest.approx(-73e3, rel=0.03)


def test_the_thickness_is_that_where_supports_are() -> None:
    near = {"name": "near", "at": [[2, 5], [2.015, 5], [8, 5], [5, 2]], "resists": "down"}
    zone = [{"area": {"rectangle": [5, 0, 10, 10]}, "thickness": 1.0}]
    assert is_certified(model(near, thickness=0.1, zone=zone))
    there = near | {"at": [[8, 5], [8.015, 5], [2, 5], [5, 2]]}
    assert "here 0.1." in said(model(there, thickness=0.1, zone=zone))


def stiffness(part: float, nu: float = 0.2) -> float:
    """Modulus of a bed with that kL⁴/D."""
    return part * 30e9 * THICKNESS**3 / 12 / (1 - nu**2) / SIZE**4


BEDS = {
    "a bed": lambda k: {"area": "all", "resists": "down", "stiffness": k},
    "edges": lambda k: {"edge": ["left", "right"], "stiffness": k * SIZE / 2},
    "points": lambda k: {"at": [[x, y] for x in (0, 10) for y in (0, 10)], "stiffness": k * SIZE**2 / 4},
}


@pytest.mark.parametrize("bed", BEDS.values(), ids=BEDS)
@pytest.mark.parametrize(
    ("held", "limit", "words"),
    [([], 1e-10, "alone holds the plate, as"), ([HINGE], 1e-6, "against a motion that rigid supports leave free, as")],
)
def test_elastic_supports_alone_are_as_stiff_as_a_bed_of_the_plates_size(bed, held, limit, words) -> None:
    """About a hinge springs at the other edge have 1.5 times the λ of a bed as stiff in all; else w has the least."""
    load = [{"pressure": 1e-3}, {"force": 1e-2, "at": [4.3, 5.6]}]
    assert is_certified(model(*held, bed(stiffness(1.01 * limit)), load=load))
    least = 1.5 if held and "area" not in bed(1.0) else 1
    refused = said(model(*held, {"name": "soft", **bed(stiffness(0.99 * limit / least))}, load=load))
    place = f"support[{len(held) + 1}].stiffness"
    assert refused.startswith(f"{place}: The stiffness of soft alone holds") and words in refused
    assert f"it must be {limit:g} or more" in refused and "or hold the plate rigidly" in refused


@pytest.mark.parametrize("part", [1.01e-14, 1e-6, 1e12, 1e20])
def test_beside_rigid_supports_that_hold_the_plate_a_bed_may_be_soft_and_as_stiff_as_it_likes(part) -> None:
    bed = {"name": "soft", "area": "all", "resists": "down"}
    assert is_certified(model(CORNERS, bed | {"stiffness": stiffness(part)}))
    refused = said(model(WALL, bed | {"stiffness": stiffness(0.99e-14)}))
    assert "soft is as soft as a bed under the whole plate with kL⁴/D = 9.9e-15; it must be 1e-14 or more" in refused


def test_a_soft_bed_carries_what_its_stiffness_says() -> None:
    """With rigid supports the deflection does not depend on it: reaction over stiffness is constant."""
    load = [{"force": 1.0, "at": [5.5, 5.0]}]
    supports = [
        {"name": "pins", "at": [[2, 2], [8, 2]], "resists": "both"},
        {"name": "bearing", "at": [5, 8], "resists": "down"},
    ]

    def compliance(part: float) -> float:
        k = stiffness(part)
        soft = {"name": "soft", "area": "all", "resists": "down", "stiffness": k}
        return solve(model(*supports, soft, load=load))["all"].reactions["soft"] / k

    assert [compliance(part) for part in (1e-14, 1e-12, 1e-10)] == pytest.approx([compliance(1e-8)] * 3, rel=1e-6)


def test_a_spring_beside_one_sided_supports_that_hold_the_plate_may_be_soft() -> None:
    """It used to be all that kept the matrix regular."""
    others = [HINGE, {"name": "bearing", "at": [8, 3], "resists": "down"}]
    spring = {"name": "spring", "at": [7, 7], "stiffness": 1e-12 * 30e9 * THICKNESS**3 / 12 / SIZE**2}
    assert is_certified(model(*others, spring))


def test_supports_are_measured_together() -> None:
    halves = [
        {"area": {"rectangle": [x, 0, x + 5, 10]}, "resists": "down", "stiffness": stiffness(1.01e-10)} for x in (0, 5)
    ]
    assert is_certified(model(*halves))
    assert "support 1 and support 2 alone" in said(model(*(one | {"stiffness": stiffness(9.9e-11)} for one in halves)))


@pytest.mark.parametrize("ratio", [1.01e-6, 1e-5, 0.5, 0.999])
def test_thickness_over_size_inside(ratio) -> None:
    thickness = ratio * SIZE
    assert is_certified(model(WALL, CORNERS, thickness=thickness, load=[{"pressure": 1e3 * thickness**3}]))


@pytest.mark.parametrize(("ratio", "found"), [(0.99e-6, "9.9e-06"), (1.01, "10.1")])
def test_thickness_over_size_outside(ratio, found) -> None:
    words = said(model(CORNERS, thickness=ratio * SIZE))
    assert words.startswith(f"plate.thickness: Found the thickness {found} at ") and "from 1e-05 to 10." in words


@pytest.mark.parametrize("step", [10, 100])
def test_steps_of_thickness(step) -> None:
    zone = [{"area": {"circle": {"center": [5, 5], "radius": 2}}, "thickness": 0.01 * step}]
    assert is_certified(model(WALL, CORNERS, thickness=0.01, zone=zone))


@pytest.mark.parametrize("thickness", [1e-3, 1.0])
def test_ribbons_and_their_elements(thickness) -> None:
    """An element 1000 times as long as it is wide, or as the plate is thick."""
    ends = {"edge": ["left", "right"], "fix": "simple"}

    def ribbon(width: float, across: int = 1) -> Model:
        load = [{"pressure": 1e-3 * thickness**3}]
        return model(ends, size=[1000, width], thickness=thickness, mesh={"divisions": [1, across]}, load=load)

    assert is_certified(ribbon(1.0))
    if thickness < 1.0:
        with pytest.raises(InputError, match=r"plate.size: found .*: the ratio of its sides is over 1000"):
            ribbon(0.5)
        words = said(ribbon(1.0, across=2))
        assert words == (
            "mesh: The element at [500, 0.25] is 1000 long and 0.5 wide or thick, 2000 to 1; at most 1000 to 1 is in "
            "the domain. Take 2 times as many elements along their longer sides, or fewer across; or calculate a beam."
        )


@pytest.mark.parametrize("divisions", [[1, 1], [1000, 1]])
def test_from_one_to_a_thousand_elements_along_a_side(divisions) -> None:
    assert is_certified(model(WALL, CORNERS, mesh={"divisions": divisions, "error": False}))


def test_a_million_sizes_from_the_origin() -> None:
    def away(by: float) -> Model:
        at = [[by + x, y] for x in (1, 9) for y in (1, 9)]
        plate = {"shape": "rectangle", "size": [SIZE, SIZE], "origin": [by, 0], "thickness": THICKNESS}
        return rectangular(
            plate=plate, mesh={"divisions": [4, 4], "error": False}, support=[{"at": at}], load=[{"pressure": 1e3}]
        )

    assert is_certified(away(1e7))
    with pytest.raises(
        InputError, match=r"origin: found .* farther away than 1e\+06 times the plate's size. Move the plate"
    ):
        away(1.01e7)


@pytest.mark.parametrize("unit", [1e-9, 1e9])
def test_in_any_units(unit) -> None:
    """Lengths and moduli, of which the door's products would leave all numbers if they were formed at once."""

    def scaled(soft: float) -> Model:
        plate = {"shape": "rectangle", "size": [SIZE * unit, SIZE * unit], "thickness": THICKNESS * unit}
        bed = {"area": "all", "resists": "down", "stiffness": stiffness(soft) / unit * unit**5}
        return rectangular(
            material={"E": 30e9 * unit**5, "nu": 0.2},
            plate=plate,
            mesh={"divisions": [4, 4], "error": False},
            support=[bed],
            load=[{"pressure": unit**5}],
        )

    assert is_certified(scaled(1.01e-10))
    assert "kL⁴/D = 9.9e-11" in said(scaled(0.99e-10))


@pytest.mark.parametrize("gap", [0.0, 1e-12, 1.0, 1e30])
def test_any_gap(gap) -> None:
    assert is_certified(model(CORNERS, {"at": [5, 5], "resists": "down", "gap": gap}))


def test_all_that_is_outside_is_told_at_once_with_its_line_and_nothing_is_written(tmp_path: Path) -> None:
    file = tmp_path / "slab.toml"
    file.write_text(
        """
material = { E = 30e9, nu = 0.2 }
plate = { shape = "rectangle", size = [10, 10], thickness = 0.4 }
mesh = { divisions = [4, 4] }
load = [{ pressure = 1e3 }]
support = [
  { name = "wall", edge = "left", fix = "simple" },
  { name = "posts", at = [[5, 5], [5.01, 5], [0.01, 3]], resists = "down" },
]
"""
    )
    done = CliRunner().invoke(app, ["solve", str(file)])
    assert done.exit_code == 2 and [one.name for one in tmp_path.iterdir()] == ["slab.toml"]
    words = " ".join(done.output.split())
    assert (
        "2 problems:" in words
        and "slab.toml:8: support[2].at[1]" in words
        and words.count("posts holds the plate rigidly") == 2
    )
    assert "0.01 from the point [5.01, 5] of posts" in words and "0.01 from the edge left of wall" in words
