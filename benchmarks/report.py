"""Report of slab B with reinforcement and 500 combinations: time and size of its page, and the page in a browser.

Solves and pages alternate; their times are medians. In headless Chromium: first paint, switches of the field, errors on
the console, requests, and values under the pointer against results.json. Without a graphics processor Chromium draws by
software; the bound of a switch is then not judged.

    python benchmarks/report.py [--elements 80] [--combinations 500] [--repeat 5]
    python benchmarks/report.py --check     no timing, on a small model
"""

import argparse
import base64
import json
import shutil
import statistics
import sys
import tempfile
import time
import zlib
from pathlib import Path

from combinations import tables
from design_envelopes import BARS

import signorini
from signorini.base.units import steel_unit
from signorini.reports.page import page

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
MOST_BYTES, MOST_PAINT, MOST_SWITCH = 2_000_000, 1.0, 0.1
VIEWER = "const v = document.querySelector('.signorini-map').signoriniMap;"
RENDERER = """() => {
  const gl = document.createElement("canvas").getContext("webgl2");
  return gl ? gl.getParameter(gl.getExtension("WEBGL_debug_renderer_info").UNMASKED_RENDERER_WEBGL) : "canvas";
}"""
SWITCHES = f"""async () => {{ {VIEWER}
  const spent = [], fields = Object.keys(v.own.fields);
  await v.ready;
  for (const field of [...fields, ...fields]) {{
    const begun = performance.now();
    await v.show({{ field }});
    v.paint();
    await createImageBitmap(v.canvas, 0, 0, 1, 1);
    spent.push((performance.now() - begun) / 1e3);
  }}
  return [spent.slice(1, fields.length), spent.slice(fields.length)];
}}"""


def model(elements, combinations):
    """Slab B with reinforcement and the default output."""
    data = tables(elements, combinations) | {"output": {}, "units": {"length": "m", "force": "N"}}
    data["mesh"] = {"divisions": [elements, elements], "error": False}
    return signorini.Model(**data, reinforcement={"code": "EN 1992-1-1:2004"} | BARS)


def ends(results, state, field):
    """Extremes of a field with their places in results.json: of the envelopes or of one combination."""
    if state["kind"] == "combination":
        owner = next(one for one in results["combinations"] if one["name"] == state["name"])
        found = owner["deflection"] if field == "deflection" else owner["fields"].get(field, {})
        return [(found[f"{side}_at"], found[side]) for side in ("max", "min") if f"{side}_at" in found]
    side = {"largest": "max", "smallest": "min"}[state["kind"]]
    found = results["envelope"]["fields"][field]
    return [(found[f"{side}_at"], found[side])]


def under_pointer(shown, results):
    """Largest difference of values under the pointer from results.json, relative to the stored digit; their number."""
    header = shown.evaluate(f"() => {{ {VIEWER} return v.data }}")
    last, worst, count = len(header["states"]) - 1, 0.0, 0
    shown.locator(".signorini-map canvas").first.scroll_into_view_if_needed()
    for number in (0, last):
        state = header["states"][number]
        for field, about in state["plates"][0]["fields"].items():
            digit = 10.0 ** max(layer["power"] for layer in about["layers"])
            shown.evaluate(
                f"async (a) => {{ {VIEWER} await v.show(a); v.paint() }}",
                {"state": number, "field": field},
            )
            for at, value in ends(results, state, field):
                place = shown.evaluate(
                    f"""(a) => {{ {VIEWER} const b = v.canvas.getBoundingClientRect(), p = v.project(...a);
                    return [b.left + p[0], b.top + p[1]] }}""",
                    at,
                )
                shown.mouse.move(*place)
                said = float(shown.inner_text(".tip b").replace("\u2212", "-").split()[0])
                shown_value = value * (steel_unit("m")[0] if field.startswith("as_") else 1.0)
                worst, count = max(worst, abs(said - shown_value) / digit), count + 1
    return worst, count


def in_browser(text, width=1400):
    """Open a page in headless Chromium and return what was measured; None without a browser."""
    if CHROMIUM is None:
        return None
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        return None
    errors, requests = [], []
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as run:
        file = Path(folder, "slab.html")
        file.write_text(text, "utf-8")
        browser = run.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        shown = browser.new_page(viewport={"width": width, "height": 900})
        shown.on("console", lambda one: None if "GL Driver" in one.text else errors.append(one.text))
        shown.on("pageerror", lambda one: errors.append(str(one)))
        shown.on("request", lambda one: requests.append(one.url))
        shown.goto(file.as_uri())
        shown.evaluate(f"async () => {{ {VIEWER} await v.ready }}")
        paint = shown.evaluate("performance.getEntriesByName('first-contentful-paint')[0].startTime") / 1e3
        coded = shown.locator("#signorini-results").text_content()
        results = json.loads(zlib.decompress(base64.b64decode(coded)))
        worst, count = under_pointer(shown, results)
        first, again = shown.evaluate(SWITCHES)
        renderer = shown.evaluate(RENDERER)
        browser.close()
    outside = [url for url in requests if not url.startswith(("file:", "data:", "blob:"))]
    return {
        "paint": paint,
        "first": statistics.median(first),
        "again": statistics.median(again),
        "renderer": renderer,
        "software": any(word in renderer for word in ("SwiftShader", "llvmpipe", "canvas")),
        "errors": errors,
        "requests": outside,
        "worst": worst,
        "count": count,
    }


def correct(found):
    """Print what was found in the browser besides times, and return whether it is as promised."""
    print(
        f"{found['count']} values under the pointer: at most {found['worst']:.3f} of the stored digit from results.json"
    )
    print(f"console errors: {len(found['errors'])}, requests: {len(found['requests'])}")
    print(*found["errors"], *found["requests"], sep="\n", end="")
    return found["worst"] <= 0.5 + 1e-6 and found["count"] > 10 and not found["errors"] and not found["requests"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, default=80)
    parser.add_argument("--combinations", type=int, default=500)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    if given.check:
        small = model(12, 20)
        found = in_browser(page(signorini.solve(small), None, small.to_toml()), width=500)
        if found is None:
            print("skipped: Chromium or playwright is not installed")
        sys.exit(0 if found is None or correct(found) else 1)

    of = model(given.elements, given.combinations)
    source, seconds = of.to_toml(), {"solve": [], "page": []}
    for _ in range(given.repeat):
        begun = time.perf_counter()
        results = signorini.solve(of)
        seconds["solve"].append(time.perf_counter() - begun)
        begun = time.perf_counter()
        text = page(results, None, source)
        seconds["page"].append(time.perf_counter() - begun)
    solve, written = map(statistics.median, seconds.values())
    size = len(text.encode())
    print(f"slab B, {results.discretisation.mesh.node_count} nodes, {len(results)} combinations, {given.repeat} turns")
    print(f"solve {solve:.2f} s, page {written:.2f} s: {written / solve:.2f} times; {size / 1e6:.2f} MB (most 2)")
    passed, found = written <= solve and size <= MOST_BYTES, in_browser(text)
    if found is None:
        sys.exit("Chromium or playwright is not installed: no browser was measured")
    drawn = f"by software ({found['renderer']}), not judged" if found["software"] else found["renderer"]
    print(f"first paint {found['paint']:.2f} s (most {MOST_PAINT:g}); drawn {drawn}")
    print(f"switch of the field {found['first']:.3f} s at first, {found['again']:.3f} s again (most {MOST_SWITCH:g})")
    passed &= found["paint"] <= MOST_PAINT and (found["software"] or found["first"] <= MOST_SWITCH)
    sys.exit(0 if correct(found) and passed else 1)


if __name__ == "__main__":
    main()
