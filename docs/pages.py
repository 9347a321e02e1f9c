"""Run the code on pages of the documentation and compare its output with the page.

The working directory of a page is ``docs/made/PAGE``. Linked files of ``examples/`` are copied there.
The code blocks of a page are handled in order:

- ``toml`` that begins with ``# NAME.toml`` is written to that file. Other ``toml`` must be part of a file there.
- ``sh`` and ``python`` run, and may not fail.
- A block without language shows lines that the last command printed, in order; ``…`` stands for left-out lines.

Every linked file in ``made/`` must have been written by the code of the page.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import signorini

DOCS = Path(__file__).parent
MADE = DOCS / "made"
RUN = [
    DOCS / "first_raft.md",
    *(page for folder in ("howto", "gallery") for page in sorted((DOCS / folder).glob("*.md")) if page.stem != "index"),
]
"""Pages whose code is run before the site is built: the first tutorial, how-to pages and gallery."""
_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"\]\(((?:\.\./)*(examples|made)/[^)\s]+)\)")


class PageError(Exception):
    """The code of a page fails, or does not print a line or write a file that the page shows."""


def directory(page: Path) -> Path:
    """Return the working directory of a page."""
    return MADE / page.relative_to(DOCS).with_suffix("")


def cover(page: Path) -> tuple[str, str, str]:
    """Return the title of a page, and the alternative text and link target of the page's first picture."""
    text = page.read_text("utf-8")
    return re.findall(r"^# (.*)$", text, re.MULTILINE)[0], *re.findall(r"!\[(.*?)\]\((.*?)\)", text)[0]


def run(page: Path) -> Path:
    """Run the code of a page, unless it has run with the same page, examples and program; return its directory."""
    text, here = page.read_text("utf-8"), directory(page)
    links = {(kind, (page.parent / target).resolve()) for target, kind in _LINK.findall(text)}
    inputs = [path for kind, path in sorted(links) if kind == "examples"]
    state, stamp = _state(text, inputs), here / ".state"
    if not stamp.exists() or stamp.read_text("utf-8") != state:
        shutil.rmtree(here, ignore_errors=True)
        here.mkdir(parents=True)
        for path in inputs:
            shutil.copy(path, here)
        _run(page, _BLOCK.findall(text), here)
        if missing := [str(path) for kind, path in links if not path.exists()]:
            raise PageError(f"{page.name}: no such files: {', '.join(missing)}")
        stamp.write_text(state, "utf-8")
    return here


def _state(text: str, inputs: list[Path]) -> str:
    """Return a hash of the page, of its input files and of the modification times of the program's files."""
    program = Path(signorini.__file__).parent
    times = sorted(path.stat().st_mtime_ns for path in program.rglob("*") if path.suffix in (".py", ".so"))
    return hashlib.sha256(repr((text, [path.read_bytes() for path in inputs], times)).encode()).hexdigest()


def _run(page: Path, blocks: list[tuple[str, str]], here: Path) -> None:
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    package = os.pathsep.join([str(Path(signorini.__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PATH": path, "PYTHONPATH": package, "COLUMNS": "100"}
    output: list[str] = []
    for language, body in blocks:
        if language == "toml":
            named = re.match(r"# (\S+\.toml)\n", body)
            if named:
                (here / named[1]).write_text(body, "utf-8")
            elif not any(body in file.read_text("utf-8") for file in here.glob("*.toml")):
                raise PageError(f"{page.name}: no input file of this page contains this block of the page:\n{body}")
        elif language in ("sh", "python"):
            command = ["bash", "-euc", body] if language == "sh" else [sys.executable, "-c", body]
            done = subprocess.run(command, cwd=here, env=environment, capture_output=True, text=True, check=False)
            if done.returncode:
                raise PageError(f"{page.name}: {body}{done.stdout}{done.stderr}")
            output = done.stdout.splitlines()
        elif not language:
            lines = iter(line.rstrip() for line in output)
            for shown in body.splitlines():
                if shown.strip() != "…" and shown.rstrip() not in lines:
                    raise PageError(
                        f"{page.name}: the output lacks this line, or has it in another order: {shown}\n{output}"
                    )
