"""The report by axe-core in headless Chromium: no serious or critical finding, in both languages and on a phone."""

from typing import Any

import pytest
from models import rectangular

import signorini
from signorini.reports import page


def report(language: str) -> str:
    """Page of a slab with checks, a punched column, cuts and a load path."""
    model = rectangular(
        units={"length": "m", "force": "kN"},
        material={"E": 30e6, "nu": 0.2, "unit_weight": 25},
        support=[
            {"name": "feet", "at": [[1, 1], [3, 1], [1, 3]], "resists": "down"},
            {"name": "column", "at": [2.5, 2.5], "resists": "down", "patch": [0.3, 0.3]},
            {"name": "wall", "edge": "left", "resists": "down"},
        ],
        load=[{"case": "G", "self_weight": True}, {"case": "Q", "pressure": 5}],
        combination=[
            {"name": "ULS", "group": "ULS", "factors": {"G": 1.35, "Q": 1.5}},
            {"name": "up", "group": "ULS", "factors": {"G": 1.0, "Q": -0.2}},
            {"name": "SLS", "group": "SLS", "factors": {"G": 1.0, "Q": 1.0}},
        ],
        reinforcement={
            "code": "EN 1992-1-1:2004",
            "fck": 30e3,
            "fyk": 500e3,
            "cover": {"top": 0.03, "bottom": 0.03},
            "bar": 0.012,
        },
        punching=[
            {
                "support": "column",
                "column": [0.3, 0.3],
                "code": "EN 1992-1-1:2004",
                "d": [0.165, 0.155],
                "rho": [0.005, 0.005],
                "fck": 30e3,
                "fyk": 500e3,
            }
        ],
        check=[{"name": "sag", "of": "deflection", "limit": 0.01}, {"name": "press", "of": "von_mises", "limit": 10.0}],
        probe=[{"at": [[2, 2], [3, 3]]}],
        section=[{"name": "cut", "line": [[0, 2], [4, 2]]}],
        strip=[{"name": "middle", "line": [[0, 2], [4, 2]], "width": 1}],
        report={"language": language, "project": "4711", "author": "A", "date": "2026-11-28"},
    )
    return page.page(signorini.solve(model), None, model.to_toml(), signorini.path(model, "G", "Q", 2.0, steps=4))


@pytest.mark.parametrize(("language", "width"), [("en", 1400), ("de", 1400), ("en", 390)])
def test_axe_finds_nothing_serious(browser: Any, language: str, width: int) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe-playwright-python is not installed")
    shown = browser.new_page(viewport={"width": width, "height": 900})
    shown.set_content(report(language))
    shown.evaluate("Promise.all([...document.querySelectorAll('.signorini-map')].map((map) => map.signoriniMap.ready))")
    shown.evaluate("for (const one of document.querySelectorAll('details')) one.open = true")
    found = axe.Axe().run(shown).response["violations"]
    serious = {
        one["id"]: [node["html"] for node in one["nodes"]] for one in found if one["impact"] in ("serious", "critical")
    }
    shown.close()
    assert serious == {}
