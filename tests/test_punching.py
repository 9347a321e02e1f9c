"""Punching of a model's columns: what acts inside perimeters, moments, tables, half-widths, paths and messages."""

import json

import numpy as np
import pytest

import signorini
from signorini import Model
from signorini.design.en1992_punching import concrete_resistance
from signorini.errors import InputError
from signorini.output.envelope_json import envelope_json
from signorini.results.figures import figures

EN = {"code": "EN 1992-1-1:2004", "d": [0.25, 0.25], "rho": [0.005, 0.005], "fck": 30e3, "fyk": 500e3}
ACI = {"code": "ACI 318-19", "d": [0.25, 0.25], "fck": 30e3, "fyk": 420e3}
SLAB = {
    "units": {"length": "m", "force": "kN"},
    "material": {"E": 30e6, "nu": 0.2},
    "plate": {"shape": "rectangle", "size": [12, 12], "thickness": 0.3},
    "mesh": {"size": 0.8},
    "support": [{"name": "columns", "at": [[2, 2], [10, 2], [2, 10], [10, 10], [6, 6]], "resists": "both"}],
    "load": [{"case": "G", "pressure": 10}],
    "punching": [{"support": "columns", "column": [0.4, 0.4], **EN}],
}
U1 = 1.6 + np.pi
INSIDE = 0.16 + 0.8 + 0.25 * np.pi
"""Length of the perimeter at 2d and the area inside it."""


def solved(**tables):
    return next(iter(signorini.solve(Model(**(SLAB | tables))).values()))


def column(result, name="columns[5]"):
    return result.punching[name].numbers


def test_load_inside_the_perimeter_is_taken_off():
    result = solved()
    found, reaction = column(result), result.supports["columns"].reactions[4]
    assert found["u1"] == pytest.approx(U1, rel=1e-12)
    assert found["force"] == pytest.approx(reaction, rel=1e-12)
    assert found["inside"] == pytest.approx(10 * INSIDE, rel=1e-9)
    assert found["v_ed"] == pytest.approx((reaction - 10 * INSIDE) / (U1 * 0.25), rel=1e-9)
    assert found["beta"] == 1.0


@pytest.mark.parametrize(
    ("load", "inside"),
    [
        ({"pressure": "x"}, 6 * INSIDE),
        ({"pressure": 3, "area": {"rectangle": [6, 0, 12, 12]}}, 1.5 * INSIDE),
        ({"pressure": 3, "area": {"rectangle": [6.1, 6.1, 6.3, 6.5]}}, 3 * 0.08),
        ({"pressure": 3, "area": {"rectangle": [6, 6, 12, 12]}}, 0.75 * INSIDE),
        ({"pressure": "where(x > 6, 4, 0)"}, 2 * INSIDE),
        ({"line_load": 7, "line": [[0, 6], [12, 6]]}, 7 * 1.4),
        ({"line_load": 7, "line": [[0, 0], [12, 12]]}, 7 * 2 * (np.hypot(0.2, 0.2) + 0.5)),
        ({"force": 50, "at": [[6.3, 6.3], [6.6, 6.6]]}, 50),
        ({"force": 50, "at": [6.7, 6], "patch": [0.4, 0.4]}, 25),
        ({"moment": [50, 20], "at": [6.3, 6.3]}, 0),
    ],
)
def test_part_of_a_load_inside_the_perimeter(load, inside):
    model = Model(**SLAB | {"load": [load, {"case": "load", "pressure": 0.0}]})
    assert column(signorini.solve(model)["all"])["inside"] == pytest.approx(inside, rel=1e-9, abs=1e-9)


def test_self_weight_and_moving_loads_inside_the_perimeter():
    tables = {"material": {"E": 30e6, "nu": 0.2, "unit_weight": 25}, "load": [{"case": "G", "self_weight": True}]}
    moving = [{"case": "T", "line": [[2, 6], [10, 6]], "step": 4, "axles": [[0, 60], [1.2, 60]]}]
    factors = {"name": "U", "factors": {"G": 1, "T@4": 1}}
    result = solved(**tables, moving=moving, combination=[factors])
    assert column(result)["inside"] == pytest.approx(25 * 0.3 * INSIDE + 60, rel=1e-9)


@pytest.mark.parametrize(
    "support",
    [
        {"at": [6, 6], "fix": "clamped"},
        {"at": [6, 6], "resists": "both", "rotational_stiffness": 1e5},
        {"at": [6, 6], "patch": [0.4, 0.4], "resists": "both", "rotational_stiffness": 1e5},
        {"area": {"rectangle": [5.8, 5.8, 6.2, 6.2]}, "resists": "both", "stiffness": 1e7},
        {"area": {"rectangle": [5.8, 5.8, 6.2, 6.2]}, "resists": "both"},
    ],
)
def test_moment_of_a_single_column_is_that_of_the_load(support):
    load = [{"force": 100, "at": [9, 7]}, {"pressure": 1}, {"case": "load", "moment": [30, 10], "at": [4, 4]}]
    result = solved(support=[{"name": "columns", **support}], load=load)
    found = column(result, "columns[1]")
    assert found["force"] == pytest.approx(244, rel=1e-6)
    assert found["moment_x"] == pytest.approx(100 * 3 + 30, rel=1e-5)
    assert found["moment_y"] == pytest.approx(100 * 1 + 10, rel=1e-5)


def test_raft_with_true_soil_pressure():
    """A rigid raft under an eccentric column: the pressure is linear, and known in closed form."""
    force, at = 2000.0, (3.6, 2.6)
    model = Model(
        units=SLAB["units"],
        material={"E": 1e16, "nu": 0.2},
        plate={"shape": "rectangle", "size": [8, 6], "thickness": 0.5},
        support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 2e4}],
        load=[
            {"case": "G", "force": force, "at": list(at), "patch": [0.4, 0.3]},
            {"case": "G", "pressure": 12},
            {"case": "W", "moment": [90, -40], "at": list(at)},
        ],
        combination=[{"name": "U", "factors": {"G": 1.35, "W": 1.5}}, {"name": "P", "factors": {"G": 1.0}}],
        punching=[{"load": "G", **EN, "d": [0.4, 0.4]}],
    )
    for name, g, w in (("U", 1.35, 1.5), ("P", 1.0, 0.0)):
        found = column(signorini.solve(model)[name], "G[1]")
        mx, my = g * force * (at[0] - 4) + 90 * w, g * force * (at[1] - 3) - 40 * w
        pressure = g * force / 48 + mx * (at[0] - 4) / (6 * 8**3 / 12) + my * (at[1] - 3) / (8 * 6**3 / 12)
        a = (found["u1"] - 1.4) / (2 * np.pi)
        assert found["v_rd_c"] * a == pytest.approx(2 * 0.4 * concrete_resistance(30, 400, 0.005) * 1e3)
        assert found["inside"] == pytest.approx(pressure * (0.12 + 1.4 * a + np.pi * a**2), rel=1e-8)
        assert found["force"] == pytest.approx(g * force)
        assert (found["moment_x"], found["moment_y"]) == pytest.approx((90 * w, -40 * w))


def test_reactions_of_other_supports_inside_the_perimeter():
    """A patch of soil and a pile beside the column carry what is missing in the perimeter."""
    others = [
        {"name": "soil", "area": {"rectangle": [6.3, 5.9, 6.5, 6.2]}, "resists": "down", "stiffness": 2e4},
        {"name": "pad", "area": {"rectangle": [5.5, 5.9, 5.7, 6.2]}, "resists": "both"},
        {"name": "pile", "at": [[6, 6.6], [3, 3]], "resists": "down", "stiffness": 1e4},
    ]
    result = solved(support=[*SLAB["support"], *others])
    pile = result.supports["pile"].reactions[0]
    pushing = result.reactions["soil"] + result.reactions["pad"] + pile
    assert column(result)["inside"] == pytest.approx(10 * INSIDE - pushing, rel=1e-9)


@pytest.mark.parametrize("x", [6, 5.5])
def test_column_whose_perimeter_meets_an_edge_of_symmetry_is_refused(x):
    plate, edge = {"shape": "rectangle", "size": [6, 12], "thickness": 0.3}, {"edge": "right", "fix": "symmetry"}
    support = [{"name": "columns", "at": [[2, 2], [2, 10], [x, 6]], "resists": "both"}, edge]
    with pytest.raises(InputError, match=r"punching\[1\].*symmetry"):
        solved(plate=plate, support=support)


def test_pictures_show_perimeters():
    result = solved()
    axes = result.plot()
    assert any("control perimeters" in text.get_text() for text in axes.get_legend().get_texts())
    line = next(line for line in axes.lines if line.get_linestyle() == "--").get_xydata()
    length = np.nansum(np.hypot(*np.diff(line, axis=0).T))
    assert length == pytest.approx(5 * U1, rel=1e-3)


def test_rows_of_tables_envelopes_and_half_widths():
    combinations = [{"name": f"c{i}", "factors": {"G": 1 + i / 10, "Q": i % 3}} for i in range(6)]
    load = [{"case": "G", "pressure": 10}, {"case": "Q", "force": 200, "at": [7, 6]}]
    each = signorini.solve(Model(**SLAB | {"load": load, "combination": combinations}))
    table = signorini.solve(
        Model(**SLAB | {"load": load, "combination": combinations, "output": {"combinations": "table"}})
    )
    singles = [column(result)["utilisation"] for result in each.values()]
    assert table.combined.rows["utilisation:punching:columns[5]"] == pytest.approx(singles, rel=1e-9)
    extreme = envelope_json(table)["punching"][4]["utilisation"]
    assert (extreme["max"], extreme["max_by"]) == (pytest.approx(max(singles)), f"c{np.argmax(singles)}")
    estimate = signorini.estimate(each["c5"]).plus_minus["punching"][4]
    assert 0.0 < estimate["utilisation"] < 0.1 * singles[5]


def test_json_has_every_number_and_clause():
    found = json.loads(json.dumps(figures(solved())))["punching"][4]
    keys = "u0 u1 force inside moment beta v_ed v_rd_c v_rd_max utilisation asw uout openings clauses"
    assert set(keys.split()) <= found.keys()
    assert found["name"] == "columns[5]" and "6.47" in found["clauses"]["v_rd_c"]


def test_path_to_a_utilisation():
    path = signorini.path(Model(**SLAB), None, "G", when=["punching:columns[5] = 1"], until=50)
    t = path.thresholds[0].t
    assert column(path.at(t))["utilisation"] == pytest.approx(1.0, rel=1e-5)


@pytest.mark.parametrize("code", [EN, ACI])
def test_no_utilisation_depends_on_units(code):
    found = []
    for length, metre, force, kilonewton in (
        ("m", 1.0, "kN", 1.0),
        ("mm", 1e3, "N", 1e3),
        ("ft", 1 / 0.3048, "kip", 1 / 4.4482216152605),
    ):
        stress = kilonewton / metre**2
        at = [[x * metre, y * metre] for x, y in SLAB["support"][0]["at"]]
        tables = {
            "units": {"length": length, "force": force},
            "material": {"E": 30e6 * stress, "nu": 0.2},
            "plate": {"shape": "rectangle", "size": [12 * metre, 12 * metre], "thickness": 0.3 * metre},
            "mesh": {"size": 0.8 * metre},
            "support": [{"name": "columns", "at": at}],
            "load": [{"pressure": 10 * stress}],
            "punching": [
                {
                    "support": "columns",
                    "diameter": 0.4 * metre,
                    **code,
                    "d": [0.26 * metre, 0.24 * metre],
                    "fck": 30e3 * stress,
                    "fyk": 500e3 * stress,
                }
            ],
        }
        found.append([result.numbers["utilisation"] for result in solved(**tables).punching])
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    assert found[2] == pytest.approx(found[0], rel=1e-9)


def test_columns_of_several_plates():
    plate = {"shape": "rectangle", "size": [12, 12], "thickness": 0.3}
    tables = {key: SLAB[key] for key in ("units", "material")}
    supports = [{**SLAB["support"][0], "name": name, "plate": name} for name in ("roof", "floor")]
    model = Model(
        **tables,
        plates={"roof": plate, "floor": plate},
        support=supports,
        load=[{"plate": "roof", "pressure": 5}, {"plate": "floor", "pressure": 10}],
        punching=[{"support": name, "plate": name, "column": [0.4, 0.4], **EN} for name in ("floor", "roof")],
    )
    result = signorini.solve(model)["all"]
    assert [one.name for one in result.punching] == [f"{p}[{i}]" for p in ("floor", "roof") for i in range(1, 6)]
    assert column(result, "floor[5]")["force"] == pytest.approx(2 * column(result, "roof[5]")["force"])
    assert figures(result)["punching"][0]["force"] == pytest.approx(column(result, "floor[1]")["force"])


@pytest.mark.parametrize(
    ("tables", "says"),
    [
        ({"punching": [{"support": "pillars", **EN}]}, "punching[1].support"),
        ({"punching": [{"support": "columns", **EN}]}, "punching[1].column"),
        ({"punching": [{"support": "columns", "number": 6, "diameter": 1, **EN}]}, "columns 1 to 5"),
        ({"punching": [{"load": "Q", "diameter": 1, **EN}]}, "punching[1].load"),
        ({"punching": [{"diameter": 1, **EN}]}, "support and load"),
        ({"punching": [{"support": "columns", "diameter": 1, **EN, "rho": None}]}, "punching[1].rho"),
        ({"punching": [{"support": "columns", "diameter": 1, **EN, "fck": 30}]}, "0.03 MPa"),
        ({"units": {"length": "m"}}, "force"),
        ({"units": {"length": "cubit", "force": "kN"}}, "length"),
    ],
)
def test_wrong_tables_are_refused_with_the_key(tables, says):
    with pytest.raises(InputError) as error:
        Model(**SLAB | tables)
    assert says in str(error.value)


def test_column_off_the_plate_is_refused():
    with pytest.raises(InputError, match=r"punching\[1\]"):
        solved(
            plate={
                "shape": "rectangle",
                "size": [12, 12],
                "thickness": 0.3,
                "holes": [{"circle": {"center": [6, 6], "radius": 1}}],
            },
            support=[{"name": "columns", "at": [6, 6], "radius": 1.2}, {"edge": "left", "fix": "clamped"}],
        )


def test_missing_keys_are_those_of_reinforcement():
    """The example of the input file: strengths of [reinforcement], then also its depths and least ratio."""
    bars = {"code": EN["code"], "fck": 30e3, "fyk": 500e3, "cover": {"top": 0.03, "bottom": 0.05}, "bar": 0.01}
    drop = [{"area": {"rectangle": [5, 5, 7, 7]}, "thickness": 0.4}]
    table = {"support": "columns", "column": [0.4, 0.4], "code": EN["code"]}
    given = solved(punching=[{**table, "d": EN["d"], "rho": EN["rho"]}], reinforcement=bars)
    assert column(given) == pytest.approx(column(solved()), rel=1e-12, nan_ok=True)
    result = solved(punching=[table], reinforcement=bars, zone=drop)
    told = figures(result)["punching"]
    assert [told[index]["d"] for index in (0, 4)] == [pytest.approx([d - 0.035, d - 0.045]) for d in (0.3, 0.4)]
    assert told[0]["rho"] == pytest.approx([0.26 * 0.3 * 30 ** (2 / 3) / 500] * 2)
    load, soil = [{"case": "G", "force": 900, "at": [6, 6]}], [{"area": "all", "resists": "down", "stiffness": 2e4}]
    raft = solved(punching=[{**table, "support": None, "load": "G"}], reinforcement=bars, load=load, support=soil)
    assert figures(raft)["punching"][0]["d"] == pytest.approx([0.3 - 0.055, 0.3 - 0.065])


@pytest.mark.parametrize("code", [EN["code"], "ACI 318-19"])
def test_the_depth_is_that_of_the_thinnest_plate_within_the_perimeter(code):
    """A thickened strip that is narrower than the control perimeter does not count."""
    bars = {"code": EN["code"], "fck": 30e3, "fyk": 500e3, "cover": {"top": 0.03, "bottom": 0.05}, "bar": 0.01}
    table = {"support": "columns", "column": [0.4, 0.4], "code": code, "number": [5]}
    columns = [
        figures(solved(punching=[table], reinforcement=bars, zone=zone))["punching"][0]
        for half in (None, 0.25, 2.0)
        for zone in [[{"area": {"rectangle": [0, 6 - half, 12, 6 + half]}, "thickness": 0.4}] if half else []]
    ]
    assert [one["d"] for one in columns] == [pytest.approx([d - 0.035, d - 0.045]) for d in (0.3, 0.3, 0.4)]


def test_columns_of_two_codes_have_different_names():
    """Numbers with one name are refused, whatever their owners; [[punching]] has a name of its own."""
    table, american = {"support": "columns", "column": [0.4, 0.4]}, {"code": "ACI 318-19", "d": EN["d"], "fck": 30e3}
    two = [{**EN, **table}, {**table, **american, "fyk": 500e3}]
    with pytest.raises(InputError, match=r"punching\[2\].name"):
        solved(punching=two)
    result = solved(punching=[two[0], {**two[1], "name": "american"}])
    assert len({one.name for one in result.punching}) == 2 * len({one.at for one in result.punching})


def test_a_slab_with_every_table_of_design(tmp_path):
    """Cases, reinforcement, punching and checks together: keys of results.json, and thresholds of a path."""
    cases = {"G": {"kind": "permanent"}, "Q": {"kind": "variable", "category": "B", "group": "live"}}
    model = Model(
        **SLAB
        | {
            "support": [SLAB["support"][0] | {"rotational_stiffness": 1e5}],
            "load": [{"case": "G", "pressure": 6}, {"case": "G2", "pressure": 1}, {"case": "Q", "pressure": 3}],
            "cases": cases | {"G2": {"kind": "permanent", "with": "G"}},
            "combination": [{"name": "ULS", "generate": "en1990", "rule": "6.10"}],
            "reinforcement": {
                **{"code": EN["code"], "fck": 30e3, "fyk": 500e3, "bar": 0.012},
                "cover": {"top": 0.035, "bottom": 0.035},
            },
            "punching": [{**EN, "fck": None, "fyk": None, "support": "columns", "column": [0.4, 0.4]}],
            "check": [{"name": "plate stress", "of": "von_mises", "limit": 213e3}],
            "probe": [{"at": [4, 4]}],
        }
    )
    results = signorini.solve(model)
    signorini.write(results, tmp_path, pictures="none")
    found = json.loads((tmp_path / "results.json").read_text())
    own = found["combinations"][0]
    assert {
        *("u0", "u1", "force", "inside", "moment", "beta", "v_ed", "v_rd_c", "v_rd_max", "utilisation", "asw"),
        *("uout", "openings", "clauses"),
    } <= own["punching"][4].keys()
    assert {"value", "limit", "utilisation", "plus_minus", "governing"} <= found["checks"][0].keys()
    assert [len(own["probes"][0]["as"][face]) for face in ("bottom", "top")] == [2, 2]
    when = ["check:plate stress = 1", "punching:columns[3] = 1"]
    found = signorini.path(model, "G", "Q", until=1e3, when=when)
    assert all(one.t is not None for one in found.thresholds)


def test_small_footings_are_checked_next_to_the_column():
    """On a pad little wider than its column, the governing perimeter is nearer than d/2: V (1 − A(a)/A) a/u(a)."""
    d, side = 0.5, 0.7
    load = [{"case": "G", "force": 3000, "at": [0.35, 0.35]}]
    soil = [{"area": "all", "resists": "down", "stiffness": 1e5}]
    plate, punching = {"shape": "rectangle", "size": [side, side], "thickness": 0.6}, {"load": "G", **EN, "d": [d, d]}
    tables = {"plate": plate, "mesh": {"size": 0.1}, "material": {"E": 1e13, "nu": 0.2}}
    result = solved(**tables, load=load, support=soil, punching=[{**punching, "column": [0.4, 0.4]}])
    a = d / 8 * np.arange(1, 3)  # beyond 0.15 m perimeters are cut by the edges
    u, area = 1.6 + 2 * np.pi * a, 0.16 + 1.6 * a + np.pi * a**2
    v_rd = concrete_resistance(30, 500, 0.005) * 1e3 * 2 * d / a
    ratio = 3000 * (1 - area / side**2) / (u * d) / v_rd
    found = column(result, "G[1]")
    assert found["v_ed"] / found["v_rd_c"] == pytest.approx(ratio.max(), rel=1e-6)
