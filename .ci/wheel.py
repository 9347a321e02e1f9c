"""Check a wheel and use it as somebody without Rust does: python .ci/wheel.py WHEEL [--floor 2.17] [--unused].

Checks are: the stable ABI, size, content, linked libraries, and on Linux the glibc version that the library needs. Then
an environment with the wheel alone runs the first example of README.md, and its program in Python, with an empty PATH.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
LARGEST = 6_000_000
"""Largest size of a wheel in bytes."""
NAME = re.compile(r"signorini-([\d.]+)-cp311-abi3-(\w+\.)*\w+\.whl")
SYSTEM = re.compile(r"linux-vdso|ld-linux|ld-musl|lib(c|m|dl|rt|pthread|gcc_s)\.(so|musl)")
"""Libraries of Linux that the extension module may need."""
LIBRARIES = ("signorini/_core.abi3.so", "signorini/_core.pyd")


def check(condition: object, found: str) -> None:
    """Print a finding, and end with exit code 1 if it is not as it must be."""
    print(f"{'ok   ' if condition else 'ERROR'} {found}")
    if not condition:
        sys.exit(1)


def check_content(wheel: Path, floor: str | None) -> None:
    """Check name, size and files of a wheel, and the libraries that its extension module needs."""
    check(NAME.fullmatch(wheel.name), f"name {wheel.name}: stable ABI of Python 3.11")
    size = wheel.stat().st_size
    check(size <= LARGEST, f"size {size / 1e6:.1f} MB, at most {LARGEST / 1e6:.0f} MB")
    with zipfile.ZipFile(wheel) as files:
        names = files.namelist()
        found = [name for name in names if name.endswith((".so", ".pyd", ".dll", ".dylib"))]
        check(len(found) == 1 and found[0] in LIBRARIES, f"one library: {', '.join(found)}")
        for part in ("py.typed", "LICENSE-MIT", "LICENSE-APACHE", "THIRDPARTY.yml", "output/schema.toml"):
            check(any(name.endswith(part) for name in names), f"contains {part}")
        binary = files.read(found[0])
        if platform.system() == "Linux" and "manylinux" in wheel.name:
            with tempfile.TemporaryDirectory() as place:
                check_linked(Path(files.extract(found[0], place)))
    tag = re.search(r"manylinux_(\d+)_(\d+)", wheel.name)
    if allowed := floor or (tag and f"{tag[1]}.{tag[2]}"):
        needed = max([(0, 0), *((int(a), int(b)) for a, b in re.findall(rb"GLIBC_(\d+)\.(\d+)", binary))])
        bound = tuple(int(part) for part in allowed.split("."))
        check(needed <= bound, f"needs glibc {needed[0]}.{needed[1]}, at most {allowed}")


def check_linked(library: Path) -> None:
    """Check that a library needs libraries of the system only."""
    listed = subprocess.run(["ldd", str(library)], capture_output=True, text=True, check=True).stdout
    needed = [line.split()[0] for line in listed.splitlines()]
    check(all(SYSTEM.search(name) for name in needed), f"linked with {', '.join(map(os.path.basename, needed))}")


def use(wheel: Path) -> None:
    """Install a wheel in an environment of its own, and run the examples of README.md without any other program."""
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        venv.create(place / "environment", with_pip=True)
        programs = place / "environment" / ("Scripts" if os.name == "nt" else "bin")
        python = programs / "python"
        subprocess.run([python, "-m", "pip", "install", "--quiet", str(wheel.resolve())], check=True)
        alone = {key: value for key, value in os.environ.items() if key.upper() not in ("PATH", "PYTHONPATH")}
        alone |= {"PATH": str(programs), "MPLBACKEND": "agg"}
        check(shutil.which("cargo", path=alone["PATH"]) is None, "no Rust on PATH")
        shutil.copy(ROOT / "examples" / "slab_on_points.toml", place)
        command = [programs / "signorini", "solve", "slab_on_points.toml"]
        solved = subprocess.run(command, cwd=place, env=alone, capture_output=True, text=True, encoding="utf-8")
        check(solved.returncode == 0 and "700000" in solved.stdout, f"signorini solve: {solved.stderr or 'solved'}")
        check((place / "slab_on_points-results" / "results.json").exists(), "results.json is written")
        (program,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text("utf-8"), re.DOTALL)
        ran = subprocess.run([python, "-c", program], cwd=place, env=alone, capture_output=True, text=True)
        check(ran.returncode == 0 and (place / "slab.png").exists(), f"program of README.md: {ran.stderr or 'ran'}")


def main() -> None:
    """Check the wheel that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path)
    parser.add_argument("--floor", help="largest glibc version that may be needed; by default that of the wheel's name")
    parser.add_argument("--unused", action="store_true", help="do not install the wheel, which is for another platform")
    given = parser.parse_args()
    check_content(given.wheel, given.floor)
    if not given.unused:
        use(given.wheel)


if __name__ == "__main__":
    main()
