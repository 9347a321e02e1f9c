"""One thread for NumPy's products, as on the command line: workers side by side would wait for each other's cores.

The fixtures that several files share.
"""

import os
from pathlib import Path

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
