"""Files are read to their end, so they must have one."""

import os
import re
from pathlib import Path

import pytest

import signorini
from signorini.errors import InputError
from signorini.mesh.meshfile import read as read_mesh

pytestmark = pytest.mark.skipif(os.name == "nt", reason="pipes and devices of POSIX")

SLAB = """
material = { E = 30e6, nu = 0.2 }
plate = { shape = "rectangle", size = [4, 4], thickness = 0.2 }
support = [{ at = [[1, 1], [3, 1], [3, 3], [1, 3]], resists = "down" }]
load = [{ case = "G", pressure = 5 }]
"""


@pytest.mark.parametrize(
    ("what", "says"),
    [
        ("pipe", "it is a pipe (FIFO); only regular files are read"),
        ("/dev/zero", "it is a device; only regular files are read"),
        ("link/zero", "it is a device; only regular files are read"),
        ("sparse", "the file is larger than"),
    ],
)
def test_what_has_no_end_is_not_read(tmp_path: Path, what: str, says: str) -> None:
    """As the input, as a table of factors and as a mesh; it neither waits nor fills the memory."""
    (tmp_path / "link").symlink_to("/dev")
    os.mkfifo(tmp_path / "pipe")
    with open(tmp_path / "sparse", "wb") as sparse:
        sparse.truncate(10**13)
    name = str(tmp_path / what)
    with pytest.raises(InputError, match=re.escape(f"{name}: the file cannot be read: {says}")):
        signorini.load(name)
    with pytest.raises(InputError, match=re.escape(f"{name}: The mesh file cannot be read: {says}")):
        read_mesh(name)
    (tmp_path / "slab.toml").write_text(SLAB + f'combination = [{{ generate = "table", file = "{what}" }}]')
    with pytest.raises(InputError, match=re.escape(f"combination[1].file: {name} cannot be read: {says}")):
        signorini.load(tmp_path / "slab.toml")


def test_a_link_to_a_file_is_read(tmp_path: Path) -> None:
    (tmp_path / "slab.toml").write_text("\ufeff" + SLAB, "utf-8")
    (tmp_path / "link.toml").symlink_to("slab.toml")
    assert signorini.load(tmp_path / "link.toml") == signorini.load(tmp_path / "slab.toml")
