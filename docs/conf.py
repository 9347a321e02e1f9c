"""Configuration of the documentation site: ``sphinx-build -nW --keep-going docs docs/_build/html``.

Before Sphinx reads the pages, their code runs (pages.py), and ``docs/reference`` is written: the command line from
typer, the Python names from ``signorini.__all__``, the benchmarks from their docstrings.
"""

import ast
import inspect
import sys
from collections.abc import Iterator
from pathlib import Path
from textwrap import indent
from typing import Any

import typer.main
from docutils import nodes
from typer.cli import get_docs_for_click

import signorini
import signorini.cli
from signorini.model.base import Table

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS))
import pages  # noqa: E402

project = "signorini"
author = copyright = "The signorini authors"
release = signorini.__version__

extensions = ["myst_nb", "sphinx_design", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "sphinx.ext.napoleon"]
exclude_patterns = ["_build", "made"]
templates_path = ["_templates"]
default_role = "py:obj"
highlight_language = "text"
# Sphinx ignores references without a target: docstrings name types of other libraries and of private modules.
nitpick_ignore_regex = [("py:.*", ".*")]
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4
nb_execution_mode = "force"  # A cache of notebook outputs would keep the outputs of an older version of signorini.
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autosummary_generate = ["reference/names.md"]

html_theme = "pydata_sphinx_theme"
html_title = "signorini"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "navbar_align": "left",
    "header_links_before_dropdown": 6,
    "navigation_depth": 1,
    "secondary_sidebar_items": {"**": ["page-toc"], "quantities": []},
    "footer_start": ["copyright"],
    "footer_end": [],
}

_COMMAND = "# Command line\n\nThe output of `signorini COMMAND --help` for every command.\n\n"
_BENCHMARKS = """# Benchmarks

Each script of the folder `benchmarks` compares signorini with known answers, or measures ratios of times and errors.
The option `--check` of some scripts checks answers without timing; continuous integration uses this option.
[accuracy.md](../accuracy.md) and [validation.md](../validation.md) have the results.

| script | content |
|---|---|
"""


def _autosummary(title: str, names: list[str]) -> str:
    listed = indent("\n".join(names), "   ")
    directives = f".. currentmodule:: signorini\n.. autosummary::\n   :toctree: api\n   :nosignatures:\n\n{listed}"
    return f"## {title}\n\n```{{eval-rst}}\n{directives}\n```\n"


def _api() -> str:
    """Return the text of reference/names.md, the page of all public Python names."""
    things = {name: getattr(signorini, name) for name in signorini.__all__ if not name.startswith("__")}
    kinds = {name: thing for name, thing in things.items() if inspect.isclass(thing)}
    errors = [name for name, kind in kinds.items() if issubclass(kind, Exception)]
    tables = [name for name, kind in kinds.items() if issubclass(kind, Table) and name != "Model"]
    functions = [name for name, thing in things.items() if inspect.isfunction(thing)]
    classes = [name for name in kinds if name not in (*errors, *tables)]
    return "\n".join(
        [
            "# Python names",
            "",
            "[python.md](../python.md) lists the Python names by task, with the shapes of arrays.",
            "",
            _autosummary("Functions", functions),
            _autosummary("Classes", classes),
            _autosummary("Errors", errors),
            "## Tables of a model",
            "",
            "These classes have the keys of the tables of an [input file](../keys.md): "
            f"{', '.join(f'`{one}`' for one in tables)}.",
        ]
    )


def _benchmarks() -> Iterator[str]:
    folder = DOCS.parent / "benchmarks"
    for path in sorted(folder.rglob("*.py")):
        text = ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""
        yield f"| `{path.relative_to(folder)}` | {' '.join(text.split(chr(10) * 2)[0].split())} |\n"


def _grid(folder: str) -> str:
    """Return a grid of cards that link the pages of a folder; each card shows the first picture of its page."""
    cards = "".join(
        f":::{{grid-item-card}} {title}\n:link: {page.stem}\n:link-type: doc\n"
        f":img-top: {picture}\n:img-alt: {words}\n:::\n"
        for page in pages.RUN
        if page.parent.name == folder
        for title, words, picture in [pages.cover(page)]
    )
    return f"::::{{grid}} 1 2 3 3\n:gutter: 3\n\n{cards}::::\n"


def _write(app: Any) -> None:
    for page in pages.RUN:
        pages.run(page)
    command = typer.main.get_command(signorini.cli.app)
    shown = get_docs_for_click(obj=command, ctx=typer.Context(command), name="signorini")
    for name, text in {
        "reference/command.md": _COMMAND + shown.removeprefix("# `signorini`\n"),
        "reference/names.md": _api(),
        "reference/benchmarks.md": _BENCHMARKS + "".join(_benchmarks()),
        "made/howto.md": _grid("howto"),
        "made/gallery.md": _grid("gallery"),
    }.items():
        path = DOCS / name
        path.parent.mkdir(exist_ok=True)
        if not path.exists() or path.read_text("utf-8") != text:
            path.write_text(text, "utf-8")


def _signature(app: Any, what: str, name: str, *_: Any) -> tuple[str, None] | None:
    """Show no signature of a class on its page, since users construct few classes; ``Model`` has ``(**tables)``."""
    return ("(**tables)" if name == "signorini.Model" else "", None) if what == "class" else None


def _link(app: Any, tree: nodes.document, page: str) -> None:
    """Link each picture of a page to its file in full size, except pictures on cards, which are links already."""
    for image in list(tree.findall(nodes.image)):
        stored = app.env.images.get(image["uri"])
        if stored and "sd-card-img-top" not in image["classes"] and app.builder.format == "html":
            link = nodes.reference(refuri=f"{'../' * page.count('/')}_images/{stored[1]}", internal=True)
            image.replace_self(link)
            link.append(image)


def setup(app: Any) -> None:
    """Write the generated pages of the site; this must happen before autosummary looks for names in these pages."""
    app.connect("builder-inited", _write, priority=100)
    app.connect("doctree-resolved", _link)
    app.connect("autodoc-process-signature", _signature)
