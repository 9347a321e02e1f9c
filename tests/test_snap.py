"""``[mesh] snap`` moves places onto others near them and reports it; without it no place moves."""

from __future__ import annotations

import math
from typing import Any

import pytest
from models import rectangular

import signorini
from signorini import InputError, Model
from signorini.discretise import discretise
from signorini.output import results_json

Tables = dict[str, Any]
LOAD = [{"pressure": 5e3}]
EDGES = {"name": "edges", "edge": ["left", "right", "bottom", "top"], "fix": "simple"}
HELD = {"fix": "simple"}


def plate(*support: Tables, snap: float = 0.005, load: list[Tables] = LOAD, **more: Any) -> Model:
    return rectangular(size=[6, 4], mesh={"snap": snap, "size": 0.5}, support=list(support), load=load, **more)


def moved(model: Model) -> dict[str, tuple[float, ...]]:
    return {one.what: one.end for one in discretise(model).snapped}


def test_nothing_moves_unless_it_is_asked_for() -> None:
    wall = {"line": [[2, 0.004], [3, 3]], "stiffness": 1e9}
    found = discretise(plate(EDGES, wall, snap=0.0))
    assert found.model.support[1].line == ((2.0, 0.004), (3.0, 3.0)) and found.snapped == ()


def test_a_wall_that_ends_beside_an_edge_is_refused_with_the_snap_that_joins_them() -> None:
    wall = {"name": "wall", "line": [[2, 0.004], [3, 3]], **HELD}
    words = (
        r"support\[2\].line: wall holds the plate rigidly at \[2, 0.004\], 0.004 from the edge bottom of edges, "
        r"support\[1\].edge\. .* Join them by mesh\.snap = 0\.008, move one support, or give one a stiffness\."
    )
    with pytest.raises(InputError, match=words):
        discretise(plate(EDGES, wall, snap=0.0))
    assert moved(plate(EDGES, wall, snap=0.008)) == {"support[2].line[1]": (2.0, 0.0)}


def test_points_ends_and_corners_move_onto_corners_first_then_onto_sides() -> None:
    supports = [
        {"line": [[1, 1], [1, 3]], **HELD},
        {"line": [[1.003, 3.001], [3, 3]], **HELD},
        {"at": [[1.002, 2], [5.996, 3.997], [2, 2]], "resists": "down"},
    ]
    load = [{"pressure": 1e3, "area": {"rectangle": [0.003, 0.004, 2.997, 2.998]}}]
    zone = [{"area": {"polygon": [[2.996, 3.001], [5, 2], [6.004, 4.003]]}, "thickness": 0.3}]
    assert moved(plate(*supports, load=load, zone=zone)) == {
        "support[2].line[1]": (1.0, 3.0),
        "support[3].at[1]": (1.0, 2.0),
        "support[3].at[2]": (6.0, 4.0),
        "zone[1].area.polygon[1]": (3.0, 3.0),
        "zone[1].area.polygon[3]": (6.0, 4.0),
        "load[1].area.rectangle": (0.0, 0.0, 3.0, 3.0),
    }


def test_an_end_moves_onto_a_line_that_comes_after_it_and_follows_it() -> None:
    first = {"line": [[3, 2.003], [3, 1]], **HELD}
    later = {"line": [[1, 2], [5, 2.0]], **HELD}
    assert moved(plate(first, later)) == {"support[1].line[1]": (3.0, 2.0)}
    follows = {"line": [[0.002, 2], [5, 2.0]], **HELD}
    assert moved(plate(first, follows))["support[1].line[1]"] == (3.0, 2.0)


def test_what_is_near_two_edges_is_near_their_corner_however_the_plate_is_mirrored() -> None:
    for x, y, corner in (
        (0.004, 0.004, (0, 0)),
        (5.996, 0.004, (6, 0)),
        (0.004, 3.996, (0, 4)),
        (5.996, 3.996, (6, 4)),
    ):
        model = plate({"at": [[x, y], [3, 2], [1, 2]], "resists": "down"})
        assert moved(model) == {"support[1].at[1]": corner}


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_units_do_not_tell_what_moves(unit: float) -> None:
    scaled = [[2 * unit, 0.004 * unit], [3 * unit, 3.0049 * unit]]
    across = {"line": [[1 * unit, 3 * unit], [5 * unit, 3 * unit]], **HELD}
    model = rectangular(
        plate={"shape": "rectangle", "size": [6 * unit, 4 * unit], "thickness": 0.2 * unit},
        mesh={"snap": 0.005 * unit},
        support=[across, {"line": scaled, **HELD}],
        load=LOAD,
    )
    ends = moved(model)
    assert ends["support[2].line[1]"] == pytest.approx((2 * unit, 0.0))
    assert ends["support[2].line[2]"] == pytest.approx((3 * unit, 3 * unit))


def test_a_circle_becomes_the_edge_or_the_circle_that_it_nearly_is() -> None:
    disc = {"shape": "disc", "radius": 4, "thickness": 0.2}
    rings = [{"circle": {"center": [0.001, 0], "radius": r}, "resists": "down"} for r in (3.998, 2.0, 2.002)]
    model = Model(
        material={"E": 30e9, "nu": 0.2}, plate=disc, mesh={"snap": 0.005}, support=[{"edge": "rim"}, *rings], load=LOAD
    )
    ends = moved(model)
    assert ends == {"support[2].circle": (0.0, 0.0, 4.0), "support[4].circle": (0.001, 0.0, 2.0)}


def test_a_line_as_short_as_that_is_refused() -> None:
    with pytest.raises(InputError, match=r"support\[2\]\.line: With mesh\.snap = 0\.01 this line or area degenerates"):
        discretise(plate({"at": [2, 2]}, {"line": [[2.001, 2], [2.004, 2]], **HELD}, snap=0.01))


def test_snapping_what_is_snapped_moves_nothing() -> None:
    wall, pads = {"line": [[2, 0.004], [3, 3.997]], **HELD}, {"at": [[2.3334, 1.3333], [5, 3.998]], "resists": "down"}
    found = discretise(plate(EDGES, wall, pads))
    assert found.snapped and discretise(found.model).snapped == ()


def test_results_say_what_was_moved() -> None:
    wall = {"line": [[2, 0.004], [3, 3]], "stiffness": 1e9}
    found = results_json(signorini.solve(plate(EDGES, wall)))["snapped"]
    assert found == [{"what": "support[2].line[1]", "from": [2.0, 0.004], "to": [2.0, 0.0], "onto": "bottom"}]


def test_reactions_are_those_of_what_is_drawn_exactly() -> None:
    turn = math.radians(23.0)
    along = [2 + 2 * math.cos(turn), 1 + 2 * math.sin(turn)]
    beside = [round(2 + math.cos(turn), 3), round(1 + math.sin(turn), 3)]
    wall = {"line": [[2, 1], along], **HELD}
    exact = [EDGES, wall, {"at": [2 + math.cos(turn), 1 + math.sin(turn)], "resists": "down"}]
    one = signorini.solve(plate(*exact))["all"]
    other = signorini.solve(plate(EDGES, wall, {"at": beside, "resists": "down"}))["all"]
    assert list(other.reactions.values()) == pytest.approx(list(one.reactions.values()), rel=1e-5, abs=1e-3)
