"""Maps of the report in headless Chromium: controls, values under the pointer, colours, print; and their data."""

import base64
import io
import json
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from models import rectangular

import signorini
from signorini import InputError, Model, Results
from signorini.formats.inputfile import load
from signorini.reports.blobs import Grid
from signorini.reports.maps import MapData, assets, assets_html, map_data, map_html
from signorini.results.quantities import FIELDS, PICTURED, in_model

EXAMPLES = Path(__file__).parents[1] / "examples"
WHOLE = "const v = document.querySelector('.signorini-map').signoriniMap;"


def page_of(data: MapData) -> str:
    mount = "signorini.maps.mount(document.querySelector('.signorini-map'))"
    body = f"{assets_html()}{map_html(data, 'map')}<script>{mount}</script>"
    return f"<!doctype html><html lang='en'><meta charset='utf-8'><title>t</title><body>{body}</body></html>"


def decimals(about: dict[str, Any]) -> int:
    return max(0, -max(layer["power"] for layer in about["layers"]))


def said(value: float, about: dict[str, Any]) -> str:
    return f"{round(value, decimals(about)) + 0.0:.{decimals(about)}f}".replace("-", "−")


def plain(text: str) -> str:
    return text.replace("\u00a0", " ")


class Shown:
    """A page with one map in a browser, and everything that went wrong on it."""

    def __init__(self, page: Any, path: Path, data: MapData) -> None:
        self.page, self.data, self.errors, self.requests = page, data, list[str](), list[str]()
        page.on("console", lambda message: self.errors.append(message.text))
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))
        path.write_text(page_of(data), encoding="utf-8")
        page.goto(path.as_uri())
        self.js("await v.ready")
        self.url = path.as_uri()

    def js(self, script: str, argument: Any = None) -> Any:
        result = self.page.evaluate(f"async (a) => {{ {WHOLE} {script} }}", argument)
        return result

    def show(self, **wanted: Any) -> None:
        self.js("await v.show(a); v.paint()", wanted)

    def about(self, field: str, state: int, plate: int = 0) -> dict[str, Any]:
        return self.data.header["states"][state]["plates"][plate]["fields"][field]  # type: ignore[no-any-return]

    def state(self, name: str) -> int:
        return [one["name"] for one in self.data.header["states"]].index(name)

    def hover(self, x: float, y: float) -> str:
        at = self.js(
            "const b = v.canvas.getBoundingClientRect(), p = v.project(...a); return [b.left + p[0], b.top + p[1]]",
            [x, y],
        )
        self.page.mouse.move(*at)
        return plain(self.page.inner_text(".tip b"))

    def pixels(self) -> Any:
        """Colours (h, w, 4) of the map."""
        coded = self.js("return v.canvas.toDataURL()").partition(",")[2]
        return np.rint(255 * imread(io.BytesIO(base64.b64decode(coded))))


Opened = Callable[..., Shown]


@pytest.fixture
def opened(browser: Any, tmp_path: Path) -> Iterator[Opened]:
    pages: list[Shown] = []

    def open_page(data: MapData, width: int = 1400, height: int = 1000, **options: Any) -> Shown:
        page = browser.new_page(viewport={"width": width, "height": height}, **options)
        pages.append(Shown(page, tmp_path / f"{len(pages)}.html", data))
        return pages[-1]

    yield open_page
    for shown in pages:
        assert shown.errors == [], "the console has errors"
        assert shown.requests == [shown.url], "the page makes requests"
        shown.page.close()


@pytest.fixture(scope="module")
def slab() -> Results:
    return signorini.solve(load(EXAMPLES / "flat_slab.toml"))


@pytest.fixture(scope="module")
def footing() -> Results:
    return signorini.solve(load(EXAMPLES / "yielding_footing.toml"))


def test_every_field_of_the_registry_has_a_map(slab: Results, footing: Results) -> None:
    every = {one["name"] for one in map_data(footing).header["fields"]}
    assert every == {one.name for one in in_model(footing.model, PICTURED.values())}
    header = map_data(slab).header
    assert {one["name"] for one in header["fields"]} == {one.name for one in in_model(slab.model, FIELDS.values())}
    kinds = [(one["kind"], one["name"]) for one in header["states"]]
    assert kinds == [("largest", ""), ("smallest", ""), ("combination", "ULS"), ("combination", "SLS")]


def test_the_value_under_the_pointer_is_that_of_the_result(opened: Opened, slab: Results) -> None:
    shown, result = opened(map_data(slab)), slab["ULS"]
    state, nodes = shown.state("ULS"), result.stress_nodes
    alone = np.flatnonzero(~np.isin(np.arange(nodes.mesh.node_count), nodes.further))
    some = np.random.default_rng(1).choice(alone, 12, replace=False)
    for field in ("deflection", "mx", "mx_top", "von_mises"):
        shown.show(state=state, field=field)
        about, unit = shown.about(field, state), PICTURED[field].unit(result.model.units)
        for node in some.tolist():
            x, y = nodes.mesh.points[node].tolist()
            assert shown.hover(x, y) == f"{said(float(result.fields[field][node]), about)} {unit}"
    shown.show(field="deflection")
    most = result.extremes["deflection"]
    assert shown.hover(*most.max_at).startswith(said(most.max, shown.about("deflection", state)))
    ((x, y),) = result.model.probe[0].at
    inner = np.array([x + 0.07, y + 0.11])
    shown.show(field="mxy")
    value = float(shown.js("return v.value(...a).value", inner.tolist()))
    exact = result.probe(inner[None])[0]
    assert value == pytest.approx(exact.moment[2], abs=10.0 ** -decimals(shown.about("mxy", state)) * 3)
    assert shown.js("return v.value(8, 8)") is None  # in the opening


def test_every_node_value_is_correctly_rounded(opened: Opened, slab: Results) -> None:
    shown, result = opened(map_data(slab)), slab["SLS"]
    for field in ("deflection", "my", "txz"):
        shown.show(state=shown.state("SLS"), field=field)
        places, values = shown.js("const n = [...v.layers[0].nodal]; return [n.map((_, i) => v.plate.place(i)), n]")
        order = Grid(result.stress_nodes).order
        exact = result.stress_nodes.spread(result.fields[field])[order]
        half = 0.5 * 10.0 ** -decimals(shown.about(field, shown.state("SLS")))
        assert np.abs(np.array(values) - exact).max() <= half * (1 + 1e-6)
        assert np.abs(np.array(places) - result.stress_nodes.points[order]).max() < 16 / 65535


def test_contact_pressure_has_gap_limit_and_edge(opened: Opened, footing: Results) -> None:
    shown, result = opened(map_data(footing)), footing["G + 1.3 W"]
    shown.show(field="pressure")
    places = np.array([[0.5, 1.5], [2.0, 1.0], [2.5, 0.75], [3.99, 1.5]])
    for place, exact in zip(places.tolist(), result.pressure(places).tolist(), strict=True):
        found = shown.js("return v.value(...a)", place)
        assert found["gap"] == (exact == 0.0)
        assert found["value"] == pytest.approx(exact, abs=0.3)
    assert shown.hover(0.5, 1.5) == "no contact"
    assert "edge of contact" in shown.page.inner_text(".key")
    assert "limit reached" in shown.page.inner_text(".key")
    assert shown.js("return v.own.contact.length") == 1


def test_reactions_and_states_are_those_of_the_result(opened: Opened, slab: Results) -> None:
    shown, result = opened(map_data(slab)), slab["ULS"]
    shown.show(state=shown.state("ULS"))
    states = shown.js("return v.own.supports")
    columns = result.supports["columns"]
    assert [float(one) for one in states[1]["each"]] == pytest.approx(columns.reactions.tolist(), rel=1e-5)
    wall = states[0]["is"]
    assert 0 < wall.count("o") < len(wall)
    assert f"{result.supports['wall'].reaction:.6g} kN" in shown.page.inner_text(".key")


def test_controls(opened: Opened, slab: Results) -> None:
    shown = opened(map_data(slab))
    page = shown.page
    page.get_by_label("Combination").select_option("ULS")
    page.get_by_label("Field").select_option("moment mx")
    page.wait_for_function(f"() => {{ {WHOLE} return v.at.field === 'mx' && v.at.state === 2 }}")
    assert plain(page.inner_text(".legend .title b")) == "moment mx [kN m/m]"
    shared = shown.js("return v.range()")
    page.get_by_label("Combination").select_option("SLS")
    page.wait_for_function(f"() => {{ {WHOLE} return v.at.state === 3 }}")
    assert shown.js("return v.range()") == shared
    page.get_by_label("own scale").check()
    own = shown.js("return v.range()")
    assert own == pytest.approx(shown.about("mx", 3)["range"]) and own[0] > shared[0]
    for box in ("supports", "sections", "loads", "mesh"):
        before = shown.js("v.paint(); return v.canvas.toDataURL()")
        page.get_by_label(box, exact=True).click()
        assert shown.js("v.paint(); return v.canvas.toDataURL()") != before
    whole = shown.js("return v.view.scale")
    page.get_by_label("zoom in").click()
    assert shown.js("return v.view.scale") > whole
    page.get_by_label("zoom out").click()
    assert shown.js("return v.view.scale") == pytest.approx(whole)
    box = page.locator("canvas").first.bounding_box()
    page.mouse.move(box["x"] + 300, box["y"] + 200)
    page.mouse.wheel(0, -200)
    page.wait_for_function(f"() => {{ {WHOLE} return v.view.scale > {whole} * 1.2 }}")
    at = shown.js("return v.view.middle")
    page.mouse.down()
    page.mouse.move(box["x"] + 340, box["y"] + 200)
    page.mouse.up()
    assert shown.js("return v.view.middle")[0] < at[0]
    page.get_by_label("whole plate", exact=True).click()
    assert shown.js("return v.view.scale") == pytest.approx(whole)


@pytest.mark.parametrize("width", [1400, 390])
@pytest.mark.parametrize("name", ["flange_pair", "slab_by_en1990", "yielding_footing"])
def test_every_option_shows_what_it_says(opened: Opened, name: str, width: int) -> None:
    model = load(EXAMPLES / f"{name}.toml")
    grows = name == "yielding_footing"
    shown = opened(map_data(signorini.path(model, start="G", add="W") if grows else signorini.solve(model)), width)
    page = shown.page
    state, field = page.get_by_label("Combination"), page.get_by_label("Field")
    for row in [*range(0, state.locator("option").count(), 6)]:
        state.select_option(str(row))
        page.wait_for_function(f"() => {{ {WHOLE} return v.at.state === {row} }}")
        for option in field.locator("option:enabled").all()[:: 1 if row == 0 else 9]:
            field.select_option(option.get_attribute("value"))
            page.wait_for_function(
                f"(field) => {{ {WHOLE} return v.at.field === field }}", arg=option.get_attribute("value")
            )
            legend = page.inner_text(".legend .title")
            assert option.inner_text() in legend and state.locator("option").nth(row).inner_text() in legend
            inside = (
                "const box = v.legend.getBoundingClientRect(), ticks = [...v.legend.querySelectorAll('.ticks span')];"
            )
            inside += "return ticks.map((one) => one.getBoundingClientRect()).every((one) => !one.width "
            assert shown.js(f"{inside} || (one.left > box.left - 1 && one.right < box.right + 1))")
            assert page.evaluate("document.documentElement.scrollWidth") <= width
    if grows:
        slider, text = page.get_by_label("Load factor"), page.locator(".slider output").first
        box, beside = slider.bounding_box(), text.bounding_box()
        assert box["width"] > 100 and (beside["x"] >= box["x"] + box["width"] or beside["y"] >= box["y"] + 10)
        for key, value in (("Home", "0"), ("End", f"{float(signorini.path(model, start='G', add='W').end):.6g}")):
            slider.press(key)
            page.wait_for_function(f"() => {{ {WHOLE} return v.nameOf(v.state).startsWith('t = {value}') }}")
            assert text.inner_text().startswith(f"t = {value}")


def test_keyboard(opened: Opened, slab: Results) -> None:
    shown = opened(map_data(slab))
    page = shown.page
    page.locator(".signorini-map canvas").first.focus()
    before = shown.js("return [v.view.scale, ...v.view.middle]")
    page.keyboard.press("+")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowUp")
    scale, x, y = shown.js("return [v.view.scale, ...v.view.middle]")
    assert scale > before[0] and x > before[1] and y > before[2]
    assert page.inner_text(".tip b").endswith(" m")
    page.keyboard.press("-")
    page.keyboard.press("0")
    assert shown.js("return [v.view.scale, ...v.view.middle]") == pytest.approx(before)
    named = "(e) => e.closest('.key') || e.labels?.length || e.ariaLabel"
    assert shown.js(f"return [...v.root.querySelectorAll('select, input, button, canvas')].every({named})")


def test_the_deformed_view_turns(opened: Opened, slab: Results) -> None:
    shown = opened(map_data(slab))
    page = shown.page
    assert page.get_by_label("deformed view").is_disabled()  # no plate has the deflections of an envelope
    shown.show(state=shown.state("ULS"))
    page.get_by_label("deformed view").check()
    flat = shown.js("return v.project(5, 8, 0)")
    assert shown.js("return v.project(5, 8, 0.01)")[1] > flat[1]  # down
    times = shown.js("return v.times")
    page.get_by_label("deflection ×").fill("80")
    assert shown.js("return v.times") == pytest.approx(2 * times)
    angles = shown.js("return v.angles")
    box = page.locator("canvas").first.bounding_box()
    page.mouse.move(box["x"] + 600, box["y"] + 300)
    page.mouse.down()
    page.mouse.move(box["x"] + 660, box["y"] + 320)
    page.mouse.up()
    turned = shown.js("return v.angles")
    assert turned["around"] != angles["around"] and turned["up"] != angles["up"]
    assert shown.js("return v.fine([5, 5, 11, 5]).length") > 20  # a line follows the deformed plate
    x, y = shown.js(
        "const w = v.plate.at(v.plate.locate(5, 8), v.deflection); return v.unproject(...v.project(5, 8, w))"
    )
    assert (x, y) == pytest.approx((5, 8), abs=1e-3)


@pytest.mark.parametrize("turned", [False, True])
def test_the_canvas_has_the_colours_of_webgl(opened: Opened, footing: Results, slab: Results, turned: bool) -> None:
    for results, field in ((footing, "pressure"), (slab, "mx")):
        shown = opened(map_data(results), 700, 600)
        last = len(shown.data.header["states"]) - 1
        shown.show(state=last, field=field)
        shown.js("v.with.supports = false; v.toggleDepth(a); signorini.maps.useCanvas(false); v.paint()", turned)
        glass = shown.pixels()
        shown.js("signorini.maps.useCanvas(true); v.paint()")
        canvas = shown.pixels()
        apart = np.abs(glass - canvas).max(axis=-1)
        assert len(np.unique(glass.reshape(-1, 4), axis=0)) > 100
        assert (apart > 12).mean() < 0.01


def test_without_webgl_the_canvas_is_used(browser: Any, tmp_path: Path, footing: Results) -> None:
    context = browser.new_context()
    context.add_init_script(
        "const get = HTMLCanvasElement.prototype.getContext;"
        "HTMLCanvasElement.prototype.getContext = function (kind, ...more) "
        "{ return kind === 'webgl2' ? null : get.call(this, kind, ...more) }"
    )
    shown = Shown(context.new_page(), tmp_path / "page.html", map_data(footing))
    shown.js("v.paint()")
    assert len(np.unique(shown.pixels().reshape(-1, 4), axis=0)) > 100
    assert shown.errors == []
    context.close()


def test_a_printed_map_has_its_proportions(opened: Opened, slab: Results) -> None:
    shown = opened(map_data(slab))
    shown.page.emulate_media(media="print")
    shown.page.set_viewport_size({"width": 700, "height": 1000})
    assert not shown.page.locator(".controls").is_visible()
    shape = "return [v.canvas.clientHeight / v.canvas.clientWidth, v.canvas.height / v.canvas.width]"
    shown_shape, own_shape = shown.js(shape)
    assert shown_shape == pytest.approx(own_shape, rel=0.01)
    assert len(shown.page.pdf()) > 20_000


def test_several_plates(opened: Opened) -> None:
    results = signorini.solve(load(EXAMPLES / "crane_mats.toml"))
    shown = opened(map_data(results))
    shown.page.get_by_label("Plate", exact=True).select_option("middle")
    shown.page.wait_for_function(f"() => {{ {WHOLE} return v.at.plate === 2 }}")
    plate = next(iter(results.values())).plates["middle"]
    shown.show(field="pressure")
    place = [1.5, 2.5]
    assert shown.js("return v.value(...a).value", place) == pytest.approx(float(plate.pressure([place])[0]), rel=1e-3)


def test_a_load_path_has_a_slider(opened: Opened) -> None:
    path = signorini.path(load(EXAMPLES / "yielding_footing.toml"), start="G", add="W")
    shown = opened(map_data(path))
    slider = shown.page.get_by_label("Load factor")
    slider.fill("0")
    slider.press("ArrowRight")
    stops = [one for one in shown.data.header["states"] if one["kind"] == "stop"]
    shown.page.wait_for_function(f"(t) => {{ {WHOLE} return v.state.t === t }}", arg=stops[1]["t"])
    shown.show(field="deflection")
    result = path.at(stops[1]["t"])
    most = result.extremes["deflection"]
    about = shown.about("deflection", shown.data.header["states"].index(stops[1]))
    assert shown.hover(*most.max_at).split()[0] == said(most.max, about)


def test_two_choices_in_quick_succession_both_count(opened: Opened, slab: Results) -> None:
    shown = opened(map_data(slab))
    state = shown.state("SLS")
    shown.js("v.show({ field: 'mx' }); await v.show({ state: a })", state)
    assert shown.js("return [v.at.field, v.at.state]") == ["mx", state]


def test_a_phone_shows_the_whole_map(opened: Opened, slab: Results) -> None:
    shown = opened(map_data(slab), 390, 844, device_scale_factor=2, has_touch=True)
    assert shown.page.evaluate("document.documentElement.scrollWidth") <= 390
    box = shown.page.locator(".stage").bounding_box()
    assert box["width"] > 330 and box["height"] < 844


def test_an_envelope_names_the_governing_combination(opened: Opened, slab: Results) -> None:
    shown, envelope = opened(map_data(slab)), slab.envelope
    shown.show(state=0, field="mx")
    nodes = slab["ULS"].stress_nodes
    alone = np.flatnonzero(~np.isin(np.arange(nodes.mesh.node_count), nodes.further))[::400]
    for node in alone.tolist():
        name = slab.key(int(envelope.fields["mx"].largest_by[node]))
        assert shown.js("return v.value(...a).by", nodes.points[node].tolist()) == name


def test_half_widths_stand_beside_values(opened: Opened, footing: Results) -> None:
    estimates = signorini.estimate(footing)
    shown = opened(map_data(footing, estimates))
    most = footing["G + 1.3 W"].extremes["deflection"]
    text = shown.hover(*most.max_at)
    assert "±" in text
    digits = text.split(" ± ")[0]
    assert float(digits) == pytest.approx(most.max, abs=0.51 * 10.0 ** -len(digits.partition(".")[2]))


def test_names_are_text(opened: Opened) -> None:
    evil = "</script><script>window.evil = 1</script><img src=x onerror='window.evil = 2'>"
    model = rectangular(
        title=evil,
        support=[{"name": evil, "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}],
        load=[{"case": evil, "pressure": 1e3}],
        section=[{"name": evil, "line": [[0, 2], [4, 2]]}],
    )
    shown = opened(map_data(signorini.solve(model)))
    shown.show(field="mx")
    assert shown.page.evaluate("window.evil") is None
    assert evil[:20] in shown.page.inner_text(".key")


def with_combinations(count: int, **others: Any) -> Model:
    combinations = [{"name": f"c{i}", "factors": {"G": 1.0, "W": 0.01 * i}} for i in range(1, count + 1)]
    return rectangular(
        support=[{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}],
        load=[{"case": "G", "pressure": 1e3}, {"case": "W", "force": 500, "at": [2.5, 2]}],
        combination=combinations,
        **others,
    )


def test_many_combinations_stay_within_the_budget() -> None:
    results = signorini.solve(with_combinations(100, output={"envelope": ["deflection", "mx", "my"]}))
    whole = map_data(results)
    names = [one["name"] for one in whole.header["states"] if one["kind"] == "combination"]
    assert set(results.governing) <= set(names)
    few = map_data(results, budget=5_000)
    assert len(few.content) * 4 / 3 <= 5_000 and few.header["left_out"] > 0
    first = few.header["states"][0]
    assert first["kind"] == "largest" and "deflection" in first["plates"][0]["fields"]


def test_twenty_fields_on_twenty_thousand_nodes_fit_a_page() -> None:
    results = signorini.solve(with_combinations(3, divisions=(81, 81)))
    assert results.discretisation.mesh.node_count > 19_000
    data = map_data(results)
    assert {one["name"] for one in data.header["fields"]} >= {
        one.name for one in in_model(results.model, FIELDS.values())
    }
    assert len(page_of(data)) < 2_000_000


def test_a_model_without_equilibrium_has_no_map() -> None:
    feet = {"at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}
    loads = [{"case": "G", "pressure": 1e3}, {"case": "W", "force": 1e6, "at": [0, 0]}]
    combinations = [{"name": "G", "factors": {"G": 1}}, {"name": "G + W", "factors": {"G": 1, "W": 1}}]
    results = signorini.solve(rectangular(support=[feet], load=loads, combination=combinations))
    assert [one["name"] for one in map_data(results).header["states"]] == ["G"]
    with pytest.raises(InputError, match="equilibrium"):
        map_data(results["G + W"])


def test_equal_arrays_are_stored_once_and_keep_their_values(opened: Opened) -> None:
    feet = {"at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}
    combinations = [{"name": f"{factor}", "factors": {"G": factor}} for factor in (1, 10)]
    model = rectangular(support=[feet], load=[{"case": "G", "pressure": 1e3}], combination=combinations)
    shown = opened(map_data(signorini.solve(model)))
    blobs, values = [], []
    for name in ("1", "10"):
        shown.show(state=shown.state(name), field="deflection")
        blobs.append([layer["blob"] for layer in shown.about("deflection", shown.state(name))["layers"]])
        values.append(shown.js("return v.value(2, 1.5).value"))
    assert blobs[0] == blobs[1] and values[1] == pytest.approx(10 * values[0])


def test_header_is_json(slab: Results) -> None:
    assert json.loads(json.dumps(map_data(slab).header, allow_nan=False))["title"] == slab.model.title


def test_the_script_parses(tmp_path: Path) -> None:
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    (tmp_path / "maps.js").write_text(assets()["maps.js"], encoding="utf-8")
    subprocess.run([node, "--check", tmp_path / "maps.js"], check=True)


def test_a_given_stiffness_has_no_stresses() -> None:
    given = dict.fromkeys(("Dx", "Dy"), 20e6) | {"D1": 4e6, "Dxy": 8e6, "Sx": 2e9, "Sy": 2e9}
    model = Model(
        plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2, "stiffness": given},
        support=[{"edge": ["left", "right"], "fix": "simple"}],
        load=[{"pressure": 1e3}],
    )
    header = map_data(signorini.solve(model)).header
    names = {one["name"] for one in header["fields"]}
    assert "mx" in names and "von_mises" not in names and header["left_out"] == 0


def test_the_budget_holds_the_mesh(slab: Results) -> None:
    with pytest.raises(InputError, match="budget"):
        map_data(slab, budget=1000)


def test_utilisations_of_checked_fields_have_maps() -> None:
    check = {"name": "stress", "of": "von_mises", "limit": 1e6}
    results = signorini.solve(with_combinations(3, check=[check]))
    states = map_data(results).header["states"]
    assert [one["kind"] for one in states if "utilisation:stress" in one["plates"][0]["fields"]].count("largest") == 1
    about = states[0]["plates"][0]["fields"]["utilisation:stress"]
    assert about["range"][1] == pytest.approx(results.envelope.field("von_mises").max / 1e6, rel=1e-5)
