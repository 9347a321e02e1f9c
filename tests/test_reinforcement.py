"""Required reinforcement by EN 1992-1-1:2004, from the design moments of Wood and Armer."""

import json
import math
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from models import tables

from signorini import InputError, Model, Output, estimate, solve, write
from signorini.design import en1992_bending as en1992
from signorini.output import results_json
from signorini.results.quantities import DESIGN_MOMENTS, FIELDS, REINFORCEMENT, derived

UNITS = {"length": "m", "force": "kN"}
BARS = {
    "code": "EN 1992-1-1:2004", "fck": 30e3, "fyk": 500e3, "cover": {"top": 0.03, "bottom": 0.03}, "bar": 0.012
}  # fmt: skip
DEPTH = 0.2 - 0.036, 0.2 - 0.048
FCD, FYD, FCTM = 20e3, 500e3 / 1.15, 0.3 * 30 ** (2 / 3) * 1e3


def slab(**changes: Any) -> Model:
    data: dict[str, Any] = {
        "units": UNITS,
        "material": {"E": 30e6, "nu": 0.2},
        "reinforcement": BARS,
        "support": [{"name": "walls", "edge": ["left", "right"], "fix": "simple"}],
        "load": [{"pressure": 12}],
        "probe": [{"at": [2, 2]}],
    }
    return Model(**tables(**data | changes))


def areas(moment: Any, model: Model, thickness: float = 0.2) -> Any:
    of = np.atleast_2d(np.array(moment, float))
    return derived(list(REINFORCEMENT), of, np.zeros((len(of), 2)), np.array(thickness), model.bars)


def closed_form(m: float, d: float, h: float = 0.2) -> float:
    """Required area of a rectangular section: μ = m/(d² fcd), As = (1 − √(1 − 2μ)) d fcd / fyd, at least 9.2.1.1."""
    if m <= 0:
        return 0.0
    mu, least = m / (d * d * FCD), max(0.26 * FCTM / 500e3, 0.0013) * d
    if mu > 0.5 or (1 - math.sqrt(1 - 2 * mu)) / 0.8 > 0.448:
        return math.inf
    area = max((1 - math.sqrt(1 - 2 * mu)) * d * FCD / FYD, least)
    return area if area <= 0.04 * h else math.inf


def least_design_moments(moment: Any) -> tuple[float, float]:
    """Bars at the bottom with the least sum that resist m(θ) in 721 directions of cracks, by brute force."""
    angle = np.linspace(0.0, np.pi, 721)
    c, s = np.cos(angle) ** 2, np.sin(angle) ** 2
    mx, my, mxy = moment
    along = mx * c + my * s + 2 * mxy * np.sin(angle) * np.cos(angle)
    # m_x c + m_y s ≥ m(θ): for each m_x the least m_y, and of these pairs the one with the least sum.
    size = np.abs(moment).sum()
    tried = np.linspace(0.0, size, 801)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        other = np.where(s > 1e-12, (along - tried * c) / s, np.where(along > tried * c + 1e-9 * size, np.inf, -np.inf))
    other = np.maximum(other.max(axis=1), 0.0)
    best = (tried[:, 0] + other).argmin()
    return float(tried[best, 0]), float(other[best])


def test_5000_random_moments_are_resisted_in_every_direction_of_a_crack_and_no_less_would() -> None:
    moment = np.random.default_rng(43).uniform(-100, 100, (5000, 3))
    found = derived(list(DESIGN_MOMENTS), moment, np.zeros((5000, 2)), np.array(0.2))
    angle = np.linspace(0.0, np.pi, 721)
    c, s, both = np.cos(angle) ** 2, np.sin(angle) ** 2, 2 * np.sin(angle) * np.cos(angle)
    along = moment[:, :1] * c + moment[:, 1:2] * s + moment[:, 2:] * both
    size = np.abs(moment).sum(axis=1)
    for sign, (x, y) in ((1.0, found[:, :2].T), (-1.0, -found[:, 2:].T)):
        spare = x[:, None] * c + y[:, None] * s - sign * along
        assert (spare.min(axis=1) >= -1e-9 * size).all() and min(x.min(), y.min()) >= 0.0
        # A crack somewhere has no spare moment, unless no bars are required.
        assert (spare.min(axis=1)[(x > 0) | (y > 0)] <= 1e-4 * size[(x > 0) | (y > 0)]).all()
    for one, (x, y) in zip(moment[:300], found[:300, :2], strict=True):
        tried, other = least_design_moments(one)
        assert x + y == pytest.approx(tried + other, abs=5e-3 * np.abs(one).sum())


@pytest.mark.parametrize(
    ("moment", "wanted"),
    [
        ((60, 40, 0), (60, 40, 0, 0)),  # sagging both ways
        ((60, 40, 20), (80, 60, 0, 0)),  # twist added to both
        ((60, -10, 20), (80, 10, 0, -10 - 400 / 60)),  # at the top bars along y alone
        ((60, -40, 20), (60 + 400 / 40, 0, 0, -40 - 400 / 60)),  # bars along x at the bottom, along y at the top
        ((-40, 60, 20), (0, 60 + 400 / 40, -40 - 400 / 60, 0)),
        ((-10, -90, 20), (0, 0, -30, -110)),  # no bars at the bottom
        ((-60, -40, 20), (0, 0, -80, -60)),  # hogging both ways
        ((0, 0, 30), (30, 30, -30, -30)),  # pure twist
    ],
)
def test_each_branch_of_the_design_moments(moment: Any, wanted: Any) -> None:
    found = derived(list(DESIGN_MOMENTS), np.array(moment, float), np.zeros(2), np.array(0.2))
    assert found == pytest.approx(wanted)


def test_areas_are_those_of_the_closed_form() -> None:
    model = slab()
    for m in np.linspace(1, 200, 200):
        found = areas([m, 0.8 * m, 0], model)[0]
        assert found[:2] == pytest.approx([closed_form(m, DEPTH[0]), closed_form(0.8 * m, DEPTH[1])], rel=1e-12)
        assert found[2:].tolist() == [0, 0]
        assert areas([-m, -0.8 * m, 0], model)[0, 2:] == pytest.approx(found[:2])
    # m = 40 kN m/m, d = 164 mm: μ = 0.0744, ω = 0.0774, As = 5.83 cm²/m.
    assert areas([40, 0, 0], model)[0, 0] == pytest.approx(5.83e-4, rel=2e-3)


def test_the_limits_of_a_section() -> None:
    model, ratio = slab(), en1992.least_ratio(30.0, 500.0)
    assert ratio == pytest.approx(0.26 * 2.8965 / 500, rel=1e-4)
    assert areas([1, 0, 0], model)[0, 0] == pytest.approx(ratio * DEPTH[0])  # the minimum governs
    assert areas([0, 0, 0], model).tolist() == [[0, 0, 0, 0]]
    s = 0.8 * en1992.largest_depth(30.0)
    largest = FCD * DEPTH[0] ** 2 * s * (1 - s / 2)
    assert np.isfinite(areas([largest * 0.999, 0, 0], model)[0, 0])
    assert np.isinf(areas([largest * 1.001, 0, 0], model)[0, 0])
    assert np.isinf(areas([1, 0, 0], model, thickness=0.03)[0, 0])  # thinner than its cover
    strong = slab(reinforcement=BARS | {"fck": 90e3, "gamma_c": 0.5})
    assert np.isinf(areas([900, 0, 0], strong)[0, 0])  # more than 0.04 Ac
    assert np.isnan(areas([1, 0, 0], model, thickness=math.nan)).all()


@pytest.mark.parametrize("length", ["mm", "cm", "in", "ft"])
@pytest.mark.parametrize("force", ["N", "MN", "kip", "lbf"])
def test_areas_do_not_depend_on_the_units(length: str, force: str) -> None:
    metres = {"mm": 1e-3, "cm": 1e-2, "in": 0.0254, "ft": 0.3048}[length]
    newtons = {"N": 1.0, "MN": 1e6, "kip": 4448.2216152605, "lbf": 4.4482216152605}[force]
    stress = 1e3 / newtons * metres**2
    bars = BARS | {"fck": 30e3 * stress, "fyk": 500e3 * stress, "bar": 0.012 / metres}
    bars |= {"cover": {"top": 0.03 / metres, "bottom": 0.03 / metres}}
    model = slab(units={"length": length, "force": force}, reinforcement=bars)
    moment = np.random.default_rng(1).uniform(-120, 120, (200, 3))
    found = areas(moment * 1e3 / newtons, model, 0.2 / metres) * metres
    assert found == pytest.approx(areas(moment, slab()), rel=1e-9)


def test_fields_extremes_probes_and_files_have_the_reinforcement(tmp_path: Path) -> None:
    results = solve(slab())
    one = results["all"]
    wanted = areas(one.moment, one.model)
    for place, name in enumerate(REINFORCEMENT):
        assert one.fields[name] == pytest.approx(wanted[:, place])
    probe = one.probes[0]
    assert probe.reinforcement is not None
    assert probe.reinforcement["bottom"] == pytest.approx(areas(probe.moment, one.model)[0, :2])
    write(results, tmp_path, pictures="all", estimate=estimate(results))
    (found,) = json.loads((tmp_path / "results.json").read_text("utf-8"))["combinations"]
    assert found["probes"][0]["as"] == {face: list(probe.reinforcement[face]) for face in ("bottom", "top")}
    assert found["fields"]["as_x_bottom"]["max"] == one.extremes["as_x_bottom"].max > 0
    assert found["plus_minus"]["fields"]["as_x_bottom"]["max"] > 0
    assert "as_x_bottom" not in solve(slab(reinforcement=None))["all"].fields
    file = next(tmp_path.glob("all.vtu"))
    assert meshio.read(file).point_data["reinforcement_bottom"][:, 0].max() == pytest.approx(wanted[:, 0].max())
    assert (tmp_path / "all-reinforcement.png").stat().st_size > 10_000


def test_a_table_says_in_which_combination_and_where_a_section_cannot_resist() -> None:
    """The required areas are enveloped by default; at a column without footprint the mean moment counts."""
    factors = [{"name": name, "factors": {"load": factor}} for name, factor in (("light", 1.0), ("heavy", 14.0))]
    changes: Any = {"combination": factors, "mesh": {"divisions": [8, 8]}}
    columns = {"name": "columns", "at": [[1, 1], [3, 1], [1, 3], [3, 3]], "resists": "both"}
    for supports in ({}, {"support": [columns]}):
        model = slab(**changes, **supports, output={"combinations": "table"})
        said = [one for one in results_json(solve(model))["table"]["warnings"] if "infinite" in one]
        assert said and all('"heavy"' in one and "[" in one for one in said)
        assert any("mean" in one for one in said) == bool(supports)
        own = [one for one in solve(slab(**changes, **supports))["heavy"].warnings if "infinite" in one]
        assert own and not any("infinite" in one for one in solve(slab(**changes, **supports))["light"].warnings)


@pytest.mark.parametrize("several", [False, True])
def test_where_the_minimum_governs_is_flagged_at_probes_and_extremes(several: bool) -> None:
    """Bars along x need more than the minimum under 12 kN/m², and the minimum under 1 kN/m²."""
    factors = [{"name": name, "factors": {"load": factor}} for name, factor in (("light", 1 / 12), ("heavy", 1.0))]
    changes: Any = {
        "combination": factors,
        "output": {"combinations": "table", "fields": "all", "envelope": ["as_x_bottom"]},
    }
    strip = [{"line": [[0, 2], [4, 2]], "width": 1, "stations": 3}]
    model = slab(**changes, probe=[{"at": [[2, 2], [0.2, 2]]}], strip=strip)
    if several:
        tables = model.model_dump(exclude_unset=True) | {"plates": {"slab": model.plate.model_dump(exclude_unset=True)}}
        named = {key: [{**tables[key][0], "plate": "slab"}] for key in ("support", "load", "probe", "strip")}
        model = Model(**{key: of for key, of in tables.items() if key != "plate"} | named)
    found = results_json(solve(model))
    light, heavy = found["combinations"]
    assert light["probes"][0]["minimum_governs"] == {"bottom": [True, True], "top": [False, False]}
    assert heavy["probes"][0]["minimum_governs"]["bottom"][0] is False
    assert [one["fields"]["as_x_bottom"]["minimum_governs"] for one in (light, heavy)] == [True, False]
    assert light["strips"][0]["stations"][1]["minimum_governs"] == {"bottom": True, "top": False}
    assert heavy["strips"][0]["stations"][1]["minimum_governs"] == {"bottom": False, "top": False}
    envelope = found["envelope"]
    assert envelope["strips"][0]["stations"][1]["as"]["bottom"]["minimum_governs"] is False
    assert [one["as_x_bottom"]["minimum_governs"] for one in envelope["probes"]] == [False, True]
    assert envelope["fields"]["as_x_bottom"]["minimum_governs"] is False


def test_where_the_section_is_too_thin_areas_are_infinite_and_a_warning_says_so(tmp_path: Path) -> None:
    results = solve(slab(load=[{"pressure": 120}]))
    one = results["all"]
    assert np.isinf(one.extremes["as_x_bottom"].max) and any("infinite" in said for said in one.warnings)
    write(results, tmp_path, pictures="all", estimate=estimate(results))
    (found,) = json.loads((tmp_path / "results.json").read_text("utf-8"))["combinations"]
    assert found["fields"]["as_x_bottom"]["max"] is None and found["probes"][0]["as"]["bottom"][0] is None


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"units": {}}, ["reinforcement", "units.length", "mm"]),
        ({"units": {"length": "m", "force": "t"}}, ["units.force", "'t'", "kN"]),
        ({"reinforcement": BARS | {"fck": 30}}, ["reinforcement.fck", "0.03 MPa", "kN/m²"]),
        ({"reinforcement": BARS | {"fyk": 900e3}}, ["reinforcement.fyk", "900 MPa", "600"]),
        ({"reinforcement": BARS | {"d_top": [0.04, 0.05]}}, ["reinforcement", "d_top", "cover"]),
        ({"reinforcement": None, "output": {"combinations": "table", "envelope": ["as_x_top"]}}, ["as_x_top"]),
    ],
)
def test_what_is_refused(changes: Any, says: list[str]) -> None:
    with pytest.raises(InputError) as error:
        slab(**changes)
    assert all(word in str(error.value) for word in says), str(error.value)


@pytest.mark.parametrize("soil", [False, True])
def test_envelopes_of_every_field_are_the_largest_over_the_combinations(soil: bool) -> None:
    support = {"area": "all", "resists": "down", "stiffness": 2e3} if soil else {"at": [[0, 0], [4, 0], [2, 4]]}
    changes: Any = {
        "support": [{"name": "below", "resists": "down"} | support, {"name": "held", "at": [2, 2]}],
        "load": [{"case": "G", "pressure": 8}, {"case": "Q", "force": 90, "at": [1, 3]}],
        "combination": [
            {"name": f"C{number}", "factors": {"G": 1.0 + 0.1 * number, "Q": 1.5 - 0.4 * number}} for number in range(6)
        ],
    }
    asked = [name for name in FIELDS if not name.startswith("rotation")]
    each = solve(slab(**changes, output={"combinations": "each"}))
    table = solve(slab(**changes, output={"combinations": "table", "envelope": asked}))
    for name in asked:
        every = np.array([result.fields[name] for result in each.values()])
        of, size = table.envelope.fields[name], 1e-7 * np.abs(every[np.isfinite(every)]).max(initial=1e-12)
        assert of.largest == pytest.approx(every.max(axis=0), abs=size), name
        assert of.smallest == pytest.approx(every.min(axis=0), abs=size), name
        nodes = np.arange(every.shape[1])
        known = of.largest_by >= 0
        assert every[of.largest_by[known], nodes[known]] == pytest.approx(of.largest[known], abs=size), name
        ends = [result.extremes[name] for result in each.values()]
        assert table.envelope.field(name).max == pytest.approx(max(end.max for end in ends), abs=size), name
        assert table.envelope.field(name).min == pytest.approx(min(end.min for end in ends), abs=size), name
    found = results_json(table)["envelope"]["fields"]
    assert set(found) >= set(asked)


def test_strips_have_the_design_moments_and_areas_of_their_means() -> None:
    strips = [
        {"name": "x", "line": [[0, 1.3], [4, 1.3]], "width": 1, "stations": 3},
        {"name": "y", "line": [[1.3, 0], [1.3, 4]], "width": 1, "stations": 3},
        {"name": "skew", "line": [[1, 1], [3, 3]], "width": 1, "stations": 3},
    ]
    load = [{"case": "G", "pressure": 8}, {"case": "Q", "force": 40, "at": [1, 3]}]
    factors = [{"name": "a", "factors": {"G": 1}}, {"name": "b", "factors": {"G": 1.35, "Q": -1.5}}]
    changes: Any = {"strip": strips, "load": load, "combination": factors}
    results = solve(slab(**changes))
    table = solve(slab(**changes, output={"combinations": "table"}))
    for one in results.values():
        for strip, depth in zip(one.strips, (*DEPTH, math.nan), strict=True):
            for number, at in enumerate(strip.stations, 1):
                bottom, top = max(at.moment + abs(at.twist), 0.0), min(at.moment - abs(at.twist), 0.0)
                assert at.design_moment == pytest.approx({"bottom": bottom, "top": top}, abs=1e-9)
                assert at.reinforcement is not None
                if strip.name == "skew":
                    assert np.isnan(list(at.reinforcement.values())).all()
                    continue
                wanted = {"bottom": closed_form(bottom, depth), "top": closed_form(-top, depth)}
                noise = {face: 0.0 if abs(m) < 1e-6 else wanted[face] for face, m in (("bottom", bottom), ("top", top))}
                assert at.reinforcement == pytest.approx(noise)
                row = list(results).index(one.name)
                for face in ("bottom", "top"):
                    column = f"strip[{strip.name}][{number}]:as_{face}"
                    assert table.table[column][row] == pytest.approx(at.reinforcement[face], rel=1e-8, abs=1e-12)
    found = results_json(table)["envelope"]["strips"][0]["stations"][1]["as"]["bottom"]
    assert found["max"] == max(one.strips[0].stations[1].reinforcement["bottom"] for one in results.values())


def test_bars_within_a_column_are_those_at_its_faces() -> None:
    """A slab on a wall pier across it: fields, probes and strips, with several plates, in results and tables."""
    wall = {"name": "wall", "at": [2, 0.5], "patch": [0.4, 1.0], "resists": "both"}
    plates = {
        "own": {"shape": "rectangle", "size": [4, 1], "thickness": 0.2},
        "other": {"shape": "rectangle", "size": [1, 1], "origin": [9, 0], "thickness": 0.3},
    }
    ends = [{"name": "ends", "plate": "own", "edge": ["left", "right"], "fix": "clamped"}]
    model = Model(
        units=UNITS,
        material={"E": 30e6, "nu": 0.0},
        reinforcement=BARS | {"face": True},
        plates=plates,
        mesh={"size": 0.1},
        support=[wall | {"plate": "own"}, *ends, {"plate": "other", "edge": "left", "fix": "clamped"}],
        load=[{"plate": name, "case": "G", "pressure": 30} for name in plates],
        combination=[{"name": "C", "factors": {"G": 1.0}}, {"name": "D", "factors": {"G": 0.5}}],
        probe=[{"plate": "own", "at": [[2, 0.5], [1.9, 0.3], [1.5, 0.5]]}],
        strip=[{"name": "s", "plate": "own", "line": [[0, 0.5], [4, 0.5]], "width": 0.8, "stations": 41}],
        output={"combinations": "each"},
    )
    results = solve(model)
    result, table = results["C"], solve(model.model_copy(update={"output": Output(combinations="table")}))
    centre, inside, beyond = result.probes
    station = {round(one.at[0], 6): one for one in result.strips[0].stations}
    left, right = station[1.8].moment, station[2.2].moment
    face = 0.5 * (left + right)
    assert centre.moment[0] < 1.05 * face < 0  # hogging is larger at the middle than at the face
    for probe in (centre, inside):
        assert probe.design_moment["top"][0] == pytest.approx(face, rel=0.01)
    assert beyond.design_moment["top"][0] == pytest.approx(min(beyond.moment[0] - abs(beyond.moment[2]), 0), rel=1e-9)
    assert station[2.0].design_moment["top"] == pytest.approx(min(left, right), rel=1e-6)
    assert station[2.0].moment < 1.05 * min(left, right)
    own = result.plates["own"]
    near = np.abs(own.stress_nodes.points[:, 0] - 2.0) <= 0.2
    assert own.fields["mx_top"][near] == pytest.approx(face, rel=0.01)
    whole = result.fields["mx_top"]
    assert np.sort(whole) == pytest.approx(np.sort([v for of in result.plates.values() for v in of.fields["mx_top"]]))
    assert own.probe((2, 0.5))[0].reinforcement == centre.reinforcement
    for column in ("probe[1]:as_x_top", "strip[s][21]:as_top"):
        assert table.table[column] == pytest.approx(results.table[column], rel=1e-8)


def test_bars_at_columns_are_designed_for_the_means_there() -> None:
    columns = {"name": "columns", "at": [[1, 1], [3, 1], [1, 3], [3, 3]], "resists": "down"}
    load = [{"case": "G", "pressure": 20}, {"case": "Q", "force": 30, "at": [2, 2]}]
    factors = [{"name": f"C{n}", "factors": {"G": 1 + n, "Q": 1.5 - n}} for n in range(3)]
    changes: Any = {"support": [columns], "load": load, "combination": factors, "mesh": {"divisions": [16, 16]}}
    face = slab(**changes, reinforcement=BARS | {"face": True})
    with_face, without = solve(face), solve(slab(**changes))
    one, other = with_face["C0"], without["C0"]
    at = np.hypot(*(one.stress_nodes.points - [1, 1]).T) < 0.1
    (mean,) = [place for place in one.means.by_place if place == (1.0, 1.0)]
    means = one.means.by_place[mean]
    assert one.fields["mx"] == pytest.approx(other.fields["mx"], rel=1e-12, abs=1e-9)
    assert one.fields["mx_top"][at] == pytest.approx(means["mx"], rel=0.05)  # a small twist is added
    assert one.fields["mx_top"][at].min() > other.fields["mx_top"][at].min()
    far = np.abs(one.stress_nodes.points - 2).max(axis=1) < 0.6
    assert one.fields["mx_top"][far].tolist() == other.fields["mx_top"][far].tolist()
    asked = [*DESIGN_MOMENTS, *REINFORCEMENT]
    table = solve(face.model_copy(update={"output": Output(combinations="table", envelope=asked)}))
    for name in asked:
        every = np.array([result.fields[name] for result in with_face.values()])
        size = 1e-7 * np.abs(every).max()
        assert table.envelope.fields[name].largest == pytest.approx(every.max(axis=0), abs=size)
        assert table.envelope.fields[name].smallest == pytest.approx(every.min(axis=0), abs=size)
