"""The built documentation site in headless Chromium: widths, requests, search, accessibility.

``sphinx-build -nW docs docs/_build/html`` builds the site, and reports links and pictures that lead nowhere. Without a
built site or a browser these tests are skipped.
"""

import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

SITE = Path(__file__).parents[1] / "docs" / "_build" / "html"
ALL = sorted(
    path.relative_to(SITE).as_posix()
    for path in SITE.rglob("*.html")
    if not path.relative_to(SITE).parts[0].startswith("_")
)
KINDS = [
    "index.html",
    "first_raft.html",
    "tutorial.html",
    "howto/index.html",
    "howto/raft.html",
    "gallery/index.html",
    "theory.html",
    "keys.html",
    "results.html",
    "validation.html",
    "reference/command.html",
    "reference/names.html",
    "reference/api/signorini.solve.html",
    "reference/api/signorini.Result.html",
    "search.html",
]
WIDE = """[document.documentElement, ...document.querySelectorAll("h1, h2, h3, p, li, .prev-next-area a")]
    .filter((one) => one.clientWidth && one.scrollWidth > one.clientWidth + 1).map((one) => one.textContent)"""
"""Texts that extend beyond their block. Code and tables scroll."""
pytestmark = pytest.mark.skipif(not ALL, reason="the site is not built")


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Print nothing."""


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(SITE))) as server:
        server.handle_error = lambda *_: None  # the browser closes connections when it leaves a page
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def test_every_page_fits_a_phone_and_a_desk_and_asks_no_other_host(browser: Any, address: str) -> None:
    page, requests, wrong = browser.new_page(), list[str](), dict[str, Any]()
    page.on("request", lambda request: requests.append(request.url))
    page.on("response", lambda answer: wrong.update({answer.url: answer.status} if answer.status >= 400 else {}))
    page.on("pageerror", lambda error: wrong.update({page.url: str(error)}))
    for name in ALL:
        page.goto(address + name)
        for width in (1280, 390):
            page.set_viewport_size({"width": width, "height": 900})
            if wide := page.evaluate(WIDE):
                wrong[f"{name} at {width}"] = wide
    page.close()
    assert wrong == {}
    assert [url for url in requests if not url.startswith((address, "data:"))] == []


@pytest.mark.parametrize(
    ("word", "found"), [("uplift", "howto/raft.html"), ("tightening", "input.html"), ("lemke", "api")]
)
def test_search_finds_the_page_of_a_word(browser: Any, address: str, word: str, found: str) -> None:
    page = browser.new_page()
    page.goto(address)
    page.keyboard.press("Control+k")
    page.keyboard.type(word)
    page.keyboard.press("Enter")
    page.wait_for_selector(f"#search-results li a[href*='{found}']")
    page.close()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing_serious_on_any_kind_of_page(browser: Any, address: str, theme: str) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe-playwright-python is not installed")
    page, serious = browser.new_page(viewport={"width": 1280, "height": 900}, color_scheme=theme), dict[str, Any]()
    for name in KINDS:
        page.goto(address + name)
        for one in axe.Axe().run(page).response["violations"]:
            if one["impact"] in ("serious", "critical"):
                serious[f"{name}: {one['id']}"] = [node["html"] for node in one["nodes"]]
    page.close()
    assert serious == {}
