"""Run the code on pages of the documentation; ``docs/made/PAGE`` is the working directory of a page.

A page links the files of ``examples/`` that it needs. Its blocks of code run in order:

- ``toml`` that begins with ``# NAME.toml`` is written to that file. Other ``toml`` is a passage of a file of the page.
- ``sh`` and ``python`` run, and may not fail.
- A block without language shows lines of their output, in order; ``…`` stands for left-out lines.
- Links to ``made/`` are files that the code has written.
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
"""Pages whose code writes files that the page shows; `index.md` has none."""
_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"\]\(((?:\.\./)*(examples|made)/[^)\s]+)\)")


class PageError(Exception):
    """Failure of the code of a page, or a line or file on the page that the code does not give."""


def directory(page: Path) -> Path:
    """Return the working directory of a page."""
    return MADE / page.relative_to(DOCS).with_suffix("")


def cover(page: Path) -> tuple[str, str, str]:
    """Return the title of a page, and the text and address of its first picture."""
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
    """Return a digest of the page, of its inputs and of the times at which the program's files changed."""
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
                raise PageError(f"{page.name}: not a passage of a file of the page:\n{body}")
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
                    raise PageError(f"{page.name}: the output has no such line, or another order: {shown}\n{output}")
