"""One thread for NumPy's products, as on the command line: workers side by side would wait for each other's cores.

The fixtures that several files share.
"""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from slab_on_pads import SLAB

from signorini_command import POOLS

for pool in POOLS:
    os.environ.setdefault(pool, "1")


@pytest.fixture
def slab(tmp_path: Path) -> Path:
    """The input file of the slab on pads."""
    file = tmp_path / "slab.toml"
    file.write_text(SLAB)
    return file


@pytest.fixture(scope="module")
def chromium() -> str:
    """The path of a browser; without one the test is skipped."""
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    return found or pytest.skip("no Chromium is installed")


@pytest.fixture(scope="module")
def browser(chromium: str) -> Iterator[Any]:
    """A headless browser of playwright, with WebGL by software."""
    driver = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    arguments = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with driver.sync_playwright() as run:
        one = run.chromium.launch(executable_path=chromium, args=arguments)
        yield one
        one.close()
