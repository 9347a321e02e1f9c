"""The report as one HTML file that loads nothing from the network, and as PDF printed by an installed Chromium."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
import tempfile
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import datetime
from importlib import resources
from itertools import chain
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from signorini.accuracy.comparison import PathEstimate
from signorini.analysis.estimate import Estimates, estimate_asked, estimates_of
from signorini.analysis.results import Results
from signorini.base import arguments
from signorini.base.arguments import checked, watching
from signorini.base.files import replacing, require_replaceable, require_unread
from signorini.base.packages import package
from signorini.base.regular import read_regular
from signorini.errors import InputError, SignoriniError
from signorini.formats.xlsx import write_xlsx
from signorini.model import Model
from signorini.output.spreadsheet import sheets_of
from signorini.output.tables import results_json
from signorini.reports import design, numbers, sections
from signorini.reports.blocks import Block, Map, Section, Text, Writer, data_uri
from signorini.reports.maps import assets_html
from signorini.reports.sections import Contents
from signorini.results.load_path import LoadPath
from signorini.results.result import Result

_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge")
_LOGOS = {".png": "image/png", ".svg": "image/svg+xml"}
_LARGEST_LOGO = 500_000
"""Largest size of a logo [bytes]."""
_LARGEST_PAGE = 1_900_000
"""Largest size of a page with the arrays of its maps [bytes]; the texts of the maps are not counted."""
_LEAST_MAP = 600_000
"""Least room for the arrays of one map [bytes], even if the page then exceeds its largest size."""
_SECONDS = 180
"""Longest time that a browser may take to print [seconds]."""

_SECTIONS: Mapping[str, Callable[[Contents], Iterator[Block]]] = {
    "scope": lambda of: chain(sections.scope(of), design.not_checked(of)),
    "summary": lambda of: chain(numbers.summary(of), design.uncracked(of), numbers.extreme_results(of)),
    "materials": lambda of: chain(sections.materials(of), design.strengths(of), design.factors(of)),
    "geometry": sections.geometry,
    "loads": sections.loads,
    "combinations": sections.combinations,
    "equilibrium": numbers.equilibrium,
    "reactions": numbers.reactions,
    "fields": numbers.fields,
    "cuts": numbers.cuts,
    "load_path": numbers.load_path,
    "reinforcement": design.reinforcement,
    "punching": numbers.punching,
    "sensitivities": numbers.sensitivities,
    "warnings": numbers.warnings,
    "input": lambda of: iter([Text(of.source, "verbatim")]),
    "glossary": sections.glossary,
    "verify": lambda of: iter([Text(of.write("verify_words")), Text("signorini verify FILE.html", "verbatim")]),
}
"""Sections of a report in their order, by key of the catalogue of texts."""


@checked
def report(
    results: Results | Result,
    path: str | os.PathLike[str],
    estimate: Estimates | None = None,
    *,
    load_path: LoadPath | None = None,
    pdf: bool = False,
    xlsx: bool = False,
) -> list[Path]:
    """Write a report: one HTML file with checks, results, maps, and the input.

    Title block and language are those of ``[report]`` of the model. With ``mesh.error``, the default, half-widths are
    computed by solving on other meshes, unless ``estimate`` is given.

    Parameters
    ----------
    results : Results or Result
        Return value of `signorini.solve`, or the result of one combination.
    path : path-like
        The HTML file; a file there is replaced, unless the model is read from it.
    estimate : Estimates, optional
        Half-widths from `signorini.estimate`.
    load_path : LoadPath, optional
        A load path of the same model, which the report also shows, with half-widths if ``mesh.error`` is true.
    pdf : bool
        Whether an installed Chromium or Chrome also prints the report to a PDF file beside it.
    xlsx : bool
        Whether a spreadsheet beside it has the results, too; XlsxWriter must be installed.

    Returns
    -------
    list of Path
        The written files.

    Examples
    --------
    >>> import tempfile
    >>> from signorini import Model, report, solve
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     mesh={"divisions": [4, 4]},
    ...     support=[{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}],
    ...     load=[{"pressure": 1e3}],
    ... )
    >>> with tempfile.TemporaryDirectory() as place:
    ...     files = report(solve(model), f"{place}/slab.html")
    >>> [file.name for file in files]
    ['slab.html']
    """
    arguments.path(path, "an HTML file", "path")
    if isinstance(results, Result):
        results = Results.alone(results)
    arguments.made_by(results, Results, "signorini.solve(model) returns Results.", "results")
    if estimate is None and results.model.estimated:
        estimate = estimates_of(results, watching(None, ""))
    original = results.model.original
    try:
        source = original.to_toml()
    except InputError:  # TOML cannot contain a stiffness that is a Python function
        source = json.dumps(json.loads(original.provenance.text), indent=1, ensure_ascii=False)
    along_estimate = None if load_path is None else estimate_asked(load_path)
    return write_report(results, path, estimate, source, load_path, along_estimate, pdf, xlsx)


def write_report(
    results: Results,
    path: str | os.PathLike[str],
    estimates: Estimates | None,
    source: str,
    load_path: LoadPath | None = None,
    along_estimate: PathEstimate | None = None,
    pdf: bool = False,
    xlsx: bool = False,
) -> list[Path]:
    """Write a report as `report` does; ``source`` is the text of the input file."""
    written = require_report(path, results.model, pdf, xlsx)
    target, *_ = written
    text = page(results, estimates, source, load_path, along_estimate)
    with _writing(target), replacing(target) as temporary:
        temporary.write_text(text, encoding="utf-8")
    if pdf:
        _print(target, target.with_suffix(".pdf"))
    if xlsx:
        values = results_json(results, estimates)
        with _writing(file := target.with_suffix(".xlsx")), replacing(file) as temporary:
            write_xlsx(temporary, sheets_of(values, results), results.model.provenance.metadata)
    return written


def require_report(path: str | os.PathLike[str], model: Model, pdf: bool = False, xlsx: bool = False) -> list[Path]:
    """Return the files of a report; refuse files that cannot be written, and a PDF or spreadsheet without its program.

    A file that the model is read from is refused, too. Called before the results are computed, it refuses early a
    report that could not be written.
    """
    target = Path(path)
    if pdf:
        _browser()
    if xlsx:
        package("xlsxwriter")
    files = [target, *(target.with_suffix(suffix) for suffix, asked in ((".pdf", pdf), (".xlsx", xlsx)) if asked)]
    for file in files:
        with _writing(file):
            require_unread(file, model.provenance.read)
            require_replaceable(file)
    return files


@contextmanager
def _writing(file: Path) -> Iterator[None]:
    """Context in which an error of writing a file is raised as `InputError`."""
    try:
        yield
    except OSError as error:
        raise InputError(f"{file} cannot be written: {error.strerror or error}. Name another file.", "output") from None


def page(
    results: Results,
    estimates: Estimates | None,
    source: str,
    load_path: LoadPath | None = None,
    along_estimate: PathEstimate | None = None,
) -> str:
    """Return the HTML of a report."""
    model, values = results.model, results_json(results, estimates)
    write = Writer(model.report.language, model.units)
    contents = Contents(results, estimates, values, write, source, load_path, along_estimate)
    made = (sections.section(key, blocks(contents)) for key, blocks in _SECTIONS.items())
    own: Sequence[Section] = [one for one in made if one is not None]
    keys = ("project", "number", "client", "author", "checker", "approver", "date", "revision")
    block = {write(key): text for key in keys if (text := getattr(model.report, key))}
    block[write("run")] = datetime.now().astimezone().strftime("%Y-%m-%d %H:%M")
    program = f"{values['program']['name']} {values['program']['version']}"
    title = model.title or values["input"]["file"] or write("report")
    environment = Environment(
        loader=PackageLoader("signorini.reports"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    text = environment.get_template("page.html").render(
        write=write,
        title=title,
        block=block,
        logo=_logo(model.report.logo),
        sections=own,
        program=program,
        margins=Markup(_margins(title, block, program, values["input"]["sha256"])),
        style=Markup(_asset("page.css")),
        script=Markup(_asset("page.js")),
        maps=Markup(assets_html()),
        results=Markup(_embedded(values)),
    )
    maps = [one for each in own for one in each.blocks if isinstance(one, Map)]
    for index, one in enumerate(maps):
        room = (_LARGEST_PAGE - len(text.encode())) // (len(maps) - index)
        text = text.replace(one.place, one.markup(max(room, _LEAST_MAP)), 1)
    return text


def _asset(name: str) -> str:
    return (resources.files("signorini.reports") / "assets" / name).read_text("utf-8")


def _embedded(values: Mapping[str, Any]) -> str:
    """results.json for a script element of the report, deflated and in base64."""
    text = json.dumps(values, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return base64.b64encode(zlib.compress(text.encode(), 6)).decode()


def _margins(title: str, block: Mapping[str, str], program: str, sha256: str) -> str:
    """CSS of the margins of printed pages, which repeat the title block."""
    above = " · ".join([title, *block.values()])
    below = f"{program} · SHA-256 {sha256[:16]}"
    return f"@page {{ @top-left {{ content: {_quoted(above)} }} @bottom-left {{ content: {_quoted(below)} }} }}"


def _quoted(text: str) -> str:
    """Text as a string of CSS; every character except letters and digits is escaped."""
    return '"' + "".join(one if one.isalnum() and one.isascii() else f"\\{ord(one):x} " for one in text) + '"'


def _logo(logo: str) -> str:
    """Logo of the title block as a data URI; empty without logo."""
    if not logo:
        return ""
    kind = _LOGOS.get(Path(logo).suffix.lower())
    if kind is None:
        raise InputError(f'found "{logo}"; a logo is a file .png or .svg.', place=("report", "logo"))
    try:
        return data_uri(read_regular(logo, _LARGEST_LOGO), kind)
    except OSError as error:
        raise InputError(f"{logo} cannot be read: {error.strerror}.", place=("report", "logo")) from None


def _browser() -> str:
    """Path of an installed Chromium or Chrome."""
    found = next((path for name in _BROWSERS if (path := shutil.which(name))), None)
    if found is None:
        raise InputError(
            f"found no browser for the PDF. Install Chromium or Chrome ({', '.join(_BROWSERS)}), or print the HTML "
            "file from any browser.",
            place="pdf",
        )
    return found


def _print(page: Path, target: Path) -> None:
    """Print a page to a PDF file."""
    browser = _browser()
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "report.pdf"
        options = ["--headless", "--disable-gpu", "--no-pdf-header-footer", f"--user-data-dir={folder}/profile"]
        # The PDF is untagged: tags of every table cell would be a third of it, and the HTML page serves screen readers.
        options += ["--disable-pdf-tagging", "--virtual-time-budget=20000", f"--print-to-pdf={made}"]
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            options.append("--no-sandbox")  # Chromium does not start as root with its sandbox
        try:
            ended = subprocess.run(
                [browser, *options, page.resolve().as_uri() + "#print"], capture_output=True, timeout=_SECONDS
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            raise SignoriniError(f"{browser} did not print {page}: {error}.") from None
        if not made.exists():
            said = ended.stderr.decode(errors="replace").strip().splitlines()
            raise SignoriniError(f"{browser} did not print {page}: {said[-1] if said else 'no message'}.")
        with _writing(target), replacing(target) as temporary:
            shutil.copyfile(made, temporary)
