"""The command line: solve, check, path, report, verify, study, validate, import-dxf, schema, explain."""

from __future__ import annotations

import json
import math
import os
import signal
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import asdict, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType
from typing import TYPE_CHECKING, Annotated, Literal

import typer

import signorini
from signorini.base.packages import package
from signorini.base.units import METRES
from signorini.cli import interrupts, streams
from signorini.cli.grid import say
from signorini.cli.streams import progress_line, visible
from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError, SignoriniError
from signorini_command import ASKED

if TYPE_CHECKING:
    from signorini.analysis.estimate import Estimates
    from signorini.mpi.engine import Engine

_MAX_REASONS = 20
"""Largest number of combinations without equilibrium for which a message gives the reasons."""
_BEFORE_LIMIT = 0.999
"""Value for --until that a message suggests, as a fraction of the t at which equilibrium of the load path ends."""
_OPTIONS = {
    "start": "--from",
    "add": "--add",
    "until": "--until",
    "steps": "--steps",
    "at": "--at",
    "when": "--when",
    "events": "--events",
    "unit": "--unit",
    "output": "--output",
    "no_error": "--no-error",
    "pdf": "--pdf",
    "shard": "--shard",
    "scheduler": "--scheduler",
    "case": "--case",
    "sensitivity": "--sensitivity",
}
_OPTIONS |= {role: f"--{role}" for role in ("outline", "holes", "zones", "points", "lines")}
"""Command-line option for each Python argument that an error message may name."""

app = typer.Typer(
    name="signorini",
    help="Finite elements for Reissner-Mindlin plates on one-sided supports: contact is solved exactly, and every "
    "result has a certificate.",
    epilog="Example: signorini solve slab.toml writes slab-results/ and prints the reactions. Exit codes: 0 solved, "
    "2 bad input, 3 no equilibrium in some combination, 4 not certified.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

NoError = Annotated[
    bool, typer.Option("--no-error", help="Do not estimate mesh errors (±), as with mesh.error = false.")
]
Threads = Annotated[
    int | None, typer.Option(min=1, max=4096, metavar="N", help="Use at most N threads. [default: one per core]")
]
Start = Annotated[
    str | None,
    typer.Option("--from", metavar="CASE", help="The load at t = 0: a load case or combination. [default: no load]"),
]
Until = Annotated[
    float | None,
    typer.Option(metavar="T", help="The largest t. [default: the t at which equilibrium or the events end]"),
]
SensitivityOf = Annotated[
    list[str] | None,
    typer.Option(
        "--sensitivity",
        metavar="NAME",
        help='Differentiate a number, such as "soil.max_pressure", with respect to all parameters; repeatable.',
    ),
]
InputFile = Annotated[Path, typer.Argument(metavar="FILE", help="The input file, TOML.", show_default=False)]


def main() -> None:
    """Run the command line and end the process with its exit code."""
    signal.signal(signal.SIGTERM, _terminate)
    streams.open_closed()
    for stream in (sys.stdout, sys.stderr):
        # Replace characters that the terminal's encoding lacks; by default such characters would raise an error.
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")
    # If an error message cannot be written, the exit code still reports the error.
    sys.stderr = streams.tolerant(sys.stderr)
    try:
        app()
    except OSError as error:
        # Output of --help, --version, schema and explain is in no file, so that its loss is an error.
        streams.discard(sys.stdout)
        say(streams.stderr(), f"Error: the text cannot be written to standard output: {error.strerror}.")
        sys.exit(SignoriniError.exit_code)
    finally:
        streams.flush()


def _terminate(number: int, frame: FrameType | None) -> None:
    """Raise SystemExit at SIGTERM, so that open contexts remove incomplete files."""
    sys.exit(interrupts.TERMINATED)


def _version(requested: bool) -> None:
    if requested:
        streams.answer().print(f"signorini {signorini.__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None: ...


@app.command(
    short_help="Solve every load combination, write the results.",
    epilog="Example: signorini solve slab.toml -o results",
)
def solve(
    file: InputFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Directory of the results. [default: FILE-results]"),
    ] = None,
    threads: Threads = None,
    pictures: Annotated[
        Literal["all", "governing", "none"] | None,
        typer.Option(
            help="Combinations with pictures. [default: all, or only the governing ones if there are more than four]",
            show_default=False,
        ),
    ] = None,
    xlsx: Annotated[bool, typer.Option("--xlsx", help="Also write results.xlsx, a spreadsheet.")] = False,
    no_error: NoError = False,
    sensitivity: SensitivityOf = None,
    engine: Annotated[
        Literal["embedded", "petsc"],
        typer.Option(help="petsc: solve with PETSc and MUMPS, over all processes of mpiexec."),
    ] = "embedded",
) -> None:
    """Solve every combination; write results.json, reactions.csv, .vtu files and pictures; print a table.

    For many combinations write combinations.parquet and envelopes, and all files for the governing combinations.
    """
    from signorini.plot.artist import Artist, cores

    without_artist = pictures == "none" or threads == 1 or cores() == 1
    with _messages(file), _ranks(engine) as ranks, nullcontext() if without_artist else Artist() as artist:
        from signorini.cli.tables import print_results
        from signorini.output.directory import former_results, room_for
        from signorini.output.names import TABLE
        from signorini.output.writing import write_results

        if xlsx:
            package("xlsxwriter")
        if ranks and sensitivity:
            raise InputError("the engine petsc computes no sensitivities. Use --engine embedded.", "--sensitivity")
        _limit(threads)
        model = _loaded(file, no_error)
        directory = output if output is not None else file.with_name(f"{file.stem}-results")
        with (
            _left(directory, former_results),
            _room(room_for(directory, model), ranks) as temporary,
            progress_line() as show,
        ):
            table = temporary / TABLE if temporary and model.tabulated else None
            with interrupts.exit_on_signal(temporary):
                results, estimates = _solved(model, show, table, sensitivity or (), ranks)
            show("writing the results")
            draw = artist.drawn if artist else None
            write_results(results, directory, estimates, table, pictures, xlsx, draw, ranks)
        print_results(streams.stdout(), results, estimates)
        streams.stdout().print(f"Written to {visible(directory)}{os.sep}")
        _refuse(results.unbalanced, results.unbalanced_count)


@app.command(
    short_help="Mesh and draw the model, check its equilibrium.",
    epilog="Example: signorini check slab.toml -o slab.svg",
)
def check(
    file: InputFile,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="PICTURE",
            help="File of the picture: .png, .svg or .pdf. [default: FILE-check.png]",
        ),
    ] = None,
    nodes: Annotated[bool, typer.Option("--nodes", help="Write node numbers, from 1, into the picture.")] = False,
) -> None:
    """Validate, mesh and draw the model, and check that the supports can balance every combination, without solving."""
    with _messages(file):
        from signorini.analysis.check import check as checked
        from signorini.analysis.check import pictures_of, require_free, require_picture
        from signorini.cli.tables import print_check

        model = signorini.load(file)
        picture = output if output is not None else file.with_name(f"{file.stem}-check.png")
        require_picture(picture, model)
        for planned in pictures_of(model, picture) if output is None else ():
            require_free(planned)
        result = checked(model)
        drawn = result.save_picture(picture, nodes)
        print_check(streams.stdout(), result)
        streams.stdout().print(f"Drawn in {', '.join(map(visible, drawn))}")
        unbalanced = {resultant.name: resultant.message for resultant in result.resultants if resultant.message}
        _refuse(unbalanced, len(unbalanced))


@app.command(
    short_help="Follow a plate under a growing load.",
    epilog="Example: signorini path slab.toml --from G --add Q --until 2",
)
def path(
    file: InputFile,
    add: Annotated[
        str,
        typer.Option(
            "--add", metavar="CASE", help="The load that grows: a load case or combination.", show_default=False
        ),
    ],
    start: Start = None,
    until: Until = None,
    steps: Annotated[
        int | None, typer.Option(metavar="N", help="Number of equally spaced load factors t to solve. [default: 50]")
    ] = None,
    at: Annotated[
        str | None, typer.Option(metavar="T,T", help="Load factors t to solve, such as 0.5,1,1.5, in place of --steps.")
    ] = None,
    when: Annotated[
        list[str] | None,
        typer.Option(
            metavar="EQUATION",
            help='Find the t at which a result has a value: "bolts[1].reaction = -203e3"; repeatable.',
        ),
    ] = None,
    events: Annotated[
        str,
        typer.Option(
            metavar="WHICH",
            help="Events to find: named (default), or all: of every contact point, without ±.",
            show_default=False,
        ),
    ] = "named",
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Directory of the files. [default: FILE-path]")
    ] = None,
    no_error: NoError = False,
) -> None:
    """Follow a plate under the load --from plus t times --add: find the t at which supports open or equilibrium ends.

    Write path.json, path.csv and path.png; print the events. Ctrl-C ends the path and writes its results until then.
    """
    with _messages(file):
        from signorini.analysis.estimate import estimate_asked
        from signorini.cli.events import print_path
        from signorini.output import write_path
        from signorini.output.directory import former_path, room_for_path

        model = _loaded(file, no_error)
        directory = output if output is not None else file.with_name(f"{file.stem}-path")
        with _left(directory, former_path):
            with (
                room_for_path(directory, model) as temporary,
                progress_line() as show,
                interrupts.exit_on_signal(temporary, interrupts.PATH_GRACE),
            ):
                chosen = None if at is None else _numbers(at)
                result = signorini.path(
                    model, start, add, until, show, steps=steps, at=chosen, when=when or (), events=_events(events)
                )
                try:
                    estimate = estimate_asked(result, show)
                except KeyboardInterrupt:
                    result, estimate = replace(result, interrupted=True), None
            write_path(result, directory, estimate)
        print_path(streams.stdout(), result, estimate)
        streams.stdout().print(f"Written to {visible(directory)}{os.sep}")
        if result.interrupted:
            raise typer.Exit(interrupts.INTERRUPTED)
        if result.ending == "stopped":
            why = "rounding decides which points are in contact. "
            before = _BEFORE_LIMIT * result.limit
            if result.end < before < (until or math.inf) and math.isfinite(before):
                why += f"Equilibrium ends at t = {result.limit:.6g}: stop before it with --until {before:.6g}. Or use"
            else:
                why += "Use"
            why += " another mesh size, smaller or larger, or give rigid supports a stiffness"
            if result.ends_with_the_mesh:
                why = (
                    f"up to t = {result.limit:.6g}, reactions on the outlines of the supports balance the load, but "
                    "reactions at the contact points of this mesh do not. Refine the mesh at the supports"
                )
            raise NotCertifiedError(f"the path was followed to t = {result.end:.6g} only: beyond this t {why}.")


@app.command(
    short_help="Solve the model of a results file again, compare all numbers.",
    epilog="Example: signorini verify slab-results/results.json. Exit codes: 0 equal, 1 not equal, 2 bad file.",
)
def verify(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help="The file of results: a results.json, a path.json or a report.", show_default=False
        ),
    ],
    threads: Threads = None,
) -> None:
    """Solve the model that is embedded in a file of results, with the same options; name every value that differs.

    Differences by rounding, up to 1e-7 of the largest number of the same kind, count as equal.
    """
    with _messages():
        from signorini.cli.verification import print_verification
        from signorini.output.verification import verified

        _limit(threads)
        with TemporaryDirectory() as room, progress_line() as show, interrupts.exit_on_signal(Path(room)):
            verification = verified(file, show, Path(room))
        print_verification(streams.stdout(), verification)
        if not verification.equal:
            raise typer.Exit(1)


@app.command(
    short_help="Solve published cases, compare with their references.",
    epilog="Example: signorini validate -o validation. Exit codes: 0 every verdict holds, 1 a verdict does not hold.",
)
def validate(
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            help="Directory for a page of each case, with pictures and input file. [default: none]",
        ),
    ] = None,
    names: Annotated[
        list[str] | None,
        typer.Option("--case", metavar="NAME", help="Solve only this case; repeatable. [default: all cases]"),
    ] = None,
) -> None:
    """Solve cases of known answer on several meshes; compare the errors of results with tolerances and with ±.

    Cases are solved in processes, one per core.
    """
    with _messages():
        from signorini.base.arguments import known
        from signorini.cli.validation import print_validation
        from signorini.output.directory import cannot_write, room_for_pages
        from signorini.validation import cases, names_of, outcomes, write_pages

        chosen = [known(name, cases(), "case", "case", "The validation") for name in names or cases()]
        files = names_of(cases()[name] for name in chosen)
        with progress_line() as show, nullcontext() if output is None else room_for_pages(output, files):
            found = {}
            for outcome in outcomes(chosen, drawn=output is not None):
                found[outcome.case.name] = outcome
                show(f"{len(found)} of {len(chosen)} cases")
        ordered = [found[name] for name in chosen]
        print_validation(streams.stdout(), ordered)
        if output is not None:
            try:
                write_pages(ordered, output)
            except OSError as error:
                raise cannot_write(output, error) from None
            streams.stdout().print(f"Written to {visible(output)}{os.sep}")
        if not all(outcome.holds for outcome in ordered):
            raise typer.Exit(1)


def _limit(threads: int | None) -> None:
    """Limit the number of threads of the Rust core; None sets no limit."""
    if threads is not None:
        # The Rust core reads this environment variable when it first starts its threads.
        os.environ["RAYON_NUM_THREADS"] = str(threads)


@app.command(
    short_help="Solve every combination, write a report to hand over.",
    epilog="Example: signorini report slab.toml -o slab.html --pdf",
)
def report(
    file: InputFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="PAGE", help="The report, HTML. [default: FILE.html]"),
    ] = None,
    pdf: Annotated[bool, typer.Option("--pdf", help="Print a PDF, too, through an installed Chromium.")] = False,
    xlsx: Annotated[bool, typer.Option("--xlsx", help="Also write a spreadsheet beside the report.")] = False,
    add: Annotated[
        str | None,
        typer.Option(
            "--add",
            metavar="CASE",
            help="Add a load path to the report, along which this load grows: a load case or combination.",
        ),
    ] = None,
    start: Start = None,
    until: Until = None,
    no_error: NoError = False,
    sensitivity: SensitivityOf = None,
) -> None:
    """Solve every combination and write one HTML file, usable offline, with checks, results, maps and the input.

    Print the checks and the warnings. The table [report] of the input gives the title block and the language.
    """
    with _messages(file):
        from signorini.analysis.estimate import estimate_asked
        from signorini.cli.tables import print_verdicts
        from signorini.reports.page import require_report, write_report

        target = output if output is not None else file.with_suffix(".html")
        if add is None and (start, until) != (None, None):
            raise InputError("a load path in the report needs --add, the load that grows.", place="add")
        model = _loaded(file, no_error)
        require_report(target, model, pdf, xlsx)
        with progress_line() as show:
            results, estimates = _solved(model, show, sensitivity=sensitivity or ())
            followed = None if add is None else signorini.path(model, start, add, until, show)
            widths = None if followed is None else estimate_asked(followed, show)
            show("writing the report")
            written = write_report(results, target, estimates, file.read_text("utf-8"), followed, widths, pdf, xlsx)
        print_verdicts(streams.stdout(), results, estimates)
        streams.stdout().print(f"Written to {', '.join(map(visible, written))}")
        _refuse(results.unbalanced, results.unbalanced_count)


@app.command(short_help="Solve many variants of a model.", epilog="Example: signorini study study.toml --workers 8")
def study(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The study, TOML.", show_default=False)],
    workers: Annotated[
        int | None,
        typer.Option(min=1, max=4096, metavar="N", help="Number of local processes. [default: one per core]"),
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Solve on the cluster of this Dask scheduler.")
    ] = None,
    shard: Annotated[
        str | None,
        typer.Option(
            metavar="I/N", help="Solve only every N-th variant from number I on, as one of N jobs that share the study."
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Directory of the table. [default: FILE-study]")
    ] = None,
) -> None:
    """Solve a model for many values of its parameters; write study.parquet and pictures; print quantiles.

    To continue an interrupted study, run the same command again: finished variants are not solved again.
    """
    directory = output if output is not None else file.with_name(f"{file.stem}-study")
    with _messages(
        file, f"Interrupted; finished variants are kept in {directory}. Run the same command again to continue."
    ):
        from signorini.cli.studies import live_table, print_study
        from signorini.output.directory import cannot_write, room_for_study
        from signorini.studies.cluster import solvers
        from signorini.studies.study import run
        from signorini.studies.studyfile import load_study
        from signorini.studies.writing import write_study

        plan, part = load_study(file), None if shard is None else _part(shard)
        with room_for_study(directory, plan.results, plan.template):
            pass
        try:
            with live_table(plan.results) as show, solvers(workers, scheduler) as solver:
                result = run(plan, solver, directory, part, show)
            written = write_study(result, directory, plan)
        except OSError as error:
            raise cannot_write(directory, error) from None
        print_study(streams.stdout(), result)
        streams.stdout().print(f"Written to {', '.join(map(visible, written))}")


def _part(text: str) -> tuple[int, int]:
    """Parse the value I/N of ``--shard``; return the numbers I and N."""
    try:
        number, count = (int(part) for part in text.split("/"))
    except ValueError:
        raise InputError(f"found {text!r}; it must be I/N, such as 1/8.", place="shard") from None
    return number, count


def _loaded(file: Path, no_error: bool) -> signorini.Model:
    """Load a model; if ``no_error`` is True, set mesh.error = false, so that no mesh error is estimated."""
    model = signorini.load(file)
    if not no_error:
        return model
    if model.mesh.accuracy is not None:
        raise InputError(
            "mesh.accuracy needs estimates of the mesh error (±). Remove --no-error or mesh.accuracy.", place="no_error"
        )
    return model.model_copy(update={"mesh": model.mesh.model_copy(update={"error": False})})


def _solved(
    model: signorini.Model,
    show: Callable[[object], None],
    table: Path | None = None,
    sensitivity: Sequence[str] = (),
    engine: Engine | None = None,
) -> tuple[signorini.Results, Estimates | None]:
    """Solve a model, differentiate numbers and, unless ``mesh.error`` is false, estimate mesh errors."""
    from signorini.analysis.estimate import estimates_of
    from signorini.analysis.results import with_sensitivities
    from signorini.analysis.solve import solve_all

    results = engine.solve(model, show) if engine else solve_all(model, show, table)
    results = with_sensitivities(results, sensitivity, show)
    return results, estimates_of(results, show, table) if model.estimated else None


@contextmanager
def _left(directory: Path, former: Callable[[Path], Sequence[str]]) -> Iterator[None]:
    """Context that, after an error, prints that files in ``directory``, if any, are from an earlier run."""
    try:
        yield
    except SignoriniError:
        if former(directory):
            streams.stderr().print(f"No files are written; {visible(directory)} has the results of an earlier run.")
        raise


@contextmanager
def _room(room: AbstractContextManager[Path], engine: Engine | None) -> Iterator[Path | None]:
    """Context with the temporary directory that ``room`` makes; None with petsc, after a test that it can be made.

    If an MPI rank dies, MPI kills the other ranks at once, so that no rank could remove a temporary directory.
    """
    with room as temporary:
        if engine is None:
            yield temporary
            return
    yield None


@contextmanager
def _ranks(engine: str) -> Iterator[Engine | None]:
    """Context with the engine petsc, or None for "embedded"; ranks other than 0 serve rank 0 and then exit."""
    if engine == "embedded":
        yield None
        return
    from signorini.mpi.engine import Engine

    started = Engine()
    if started.ranks.rank:
        started.ranks.serve()
        raise typer.Exit
    try:
        yield started
    finally:
        started.ranks.end()


def _numbers(text: str) -> list[float]:
    """Parse the numbers of ``--at``, separated by commas."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"found {text!r}; it must be numbers separated by commas: 0.5,1,1.5.", place="at") from None


def _events(events: str) -> Literal["named", "all"]:
    """Return the value of ``--events`` if it is "named" or "all"; refuse other values."""
    from signorini.base.arguments import known

    return "all" if known(events, ("named", "all"), "choice", "events", "It") == "all" else "named"


@app.command(
    "import-dxf",
    short_help="Make an input file from a drawing.",
    epilog="Example: signorini import-dxf floor.dxf --outline SLAB --holes OPENINGS --points COLUMNS -o slab.toml",
)
def import_dxf(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The drawing, DXF.", show_default=False)],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="The input file. [default: FILE.toml]")
    ] = None,
    outline: Annotated[
        list[str] | None,
        typer.Option(
            metavar="LAYER", help="Layer of the outline. [default: outline, or the layer of the largest closed line]"
        ),
    ] = None,
    holes: Annotated[
        list[str] | None,
        typer.Option(metavar="LAYER", help="Layer of holes. [default: holes, or the layer of the outline]"),
    ] = None,
    zones: Annotated[list[str] | None, typer.Option(metavar="LAYER", help="Layer of zones. [default: zones]")] = None,
    points: Annotated[
        list[str] | None,
        typer.Option(metavar="LAYER", help="Layer of supports at points, with their footprints. [default: points]"),
    ] = None,
    lines: Annotated[
        list[str] | None, typer.Option(metavar="LAYER", help="Layer of supports along lines. [default: lines]")
    ] = None,
    unit: Annotated[
        str | None,
        typer.Option(
            metavar="UNIT", help=f"Unit of the drawing: {', '.join(METRES)}. [default: unit in the drawing's header]"
        ),
    ] = None,
) -> None:
    """Make an input file from a drawing: outline, holes, zones, and supports at points and along lines.

    Print numbers of used shapes, and shapes that are not used. Layer options can be repeated: --zones A --zones B.
    """
    with _messages():
        from signorini.base.files import replacing
        from signorini.importers.drawing_toml import drawing_as_toml
        from signorini.importers.dxf import read_dxf

        target = output if output is not None else file.with_suffix(".toml")
        if target.exists():
            raise InputError(f"{target} exists; give another name with -o, or remove the file.", place="output")
        named = {"outline": outline, "holes": holes, "zones": zones, "points": points, "lines": lines}
        result = read_dxf(file, {role: layers for role, layers in named.items() if layers}, unit)
        try:
            with replacing(target) as temporary:
                temporary.write_text(drawing_as_toml(result, file.stem), encoding="utf-8")
        except OSError as error:
            raise InputError(f"{target} cannot be written: {error.strerror}.", place="output") from None
        out, errors = streams.stdout(), [lost.line for lost in result.lost]
        left_out = [line for line in result.left if line not in errors]
        for heading, lines_of in (("Used", result.took), ("Left out", left_out)):
            for line in lines_of:
                say(out, visible(f"{heading}: {line}"))
        for line in errors:
            say(streams.stderr(), visible(f"Error: not used as drawn: {line}"))
        supported = bool(result.points or result.lines)
        assumed, missing = (", supports that resist in both directions", "") if supported else ("", "supports and ")
        say(out, visible(f"Written to {target}. Assumed: material and thickness{assumed}. Add {missing}loads."))
        if errors:
            raise typer.Exit(InputError.exit_code)


@app.command(
    short_help="Print the JSON Schema of input or results files.",
    epilog="Example: signorini schema > signorini.schema.json",
)
def schema(
    results: Annotated[bool, typer.Option("--results", help="The schema of results.json.")] = False,
    along_path: Annotated[bool, typer.Option("--path", help="The schema of path.json.")] = False,
) -> None:
    """Print the JSON Schema of the input file, for completion and checks in editors, or of a results file."""
    with _messages():
        if along_path:
            found = signorini.results_schema("path.json")
        else:
            found = signorini.results_schema() if results else signorini.schema()
    _print_json(found)


@app.command(
    short_help="Explain a key of the input or of results.",
    epilog="Examples: signorini explain support.gap; signorini explain soil.max_pressure; signorini explain InputError",
)
def explain(
    key: Annotated[
        str,
        typer.Argument(
            metavar="KEY", help="A key, name of a number, column of a table, or error class.", show_default=False
        ),
    ],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Explain a key of the input file, a key, number or column of results, or an error: meaning, unit, allowed values.

    A key may be a path or its end, such as support.gap or gap.
    """
    with _messages():
        from signorini.cli.explanations import print_explanations

        found = signorini.explain(key)
    if as_json:
        _print_json([asdict(one) for one in found])
    else:
        print_explanations(streams.answer(), found)


def _print_json(value: object) -> None:
    sys.stdout.write(json.dumps(value, indent=2, ensure_ascii=False) + "\n")
    sys.stdout.flush()


def _refuse(unbalanced: Mapping[str, str], count: int) -> None:
    """Raise NoEquilibriumError if ``count`` > 0; the message has the reasons of the first 20 combinations."""
    if count:
        reasons = [f"{name}: {message}" for name, message in unbalanced.items()][:_MAX_REASONS]
        more = [f"And {count - len(reasons)} more."] if count > len(reasons) else []
        raise NoEquilibriumError("\n".join(reasons + more))


@contextmanager
def _messages(file: Path | None = None, interrupted: str = interrupts.MESSAGE) -> Iterator[None]:
    """Context that converts an exception to a message on standard error and an exit code.

    ``interrupted`` is the message after SIGINT or SIGTERM.
    """
    try:
        yield
    except InputError as error:
        from signorini.formats.inputfile import with_line

        place = _OPTIONS.get(error.place)
        text = f"{place}: {error.message}" if place else error if file is None else with_line(error, file)
        _end(f"Error: {text}", error.exit_code)
    except NoEquilibriumError as error:
        _end(f"No equilibrium.\n{error}", error.exit_code)
    except SignoriniError as error:
        _end(f"Error: {error}", error.exit_code)
    except KeyboardInterrupt:
        _end(interrupted, interrupts.INTERRUPTED)
    except SystemExit as ending:
        if ending.code == interrupts.TERMINATED:
            say(streams.stderr(), visible(interrupted))
        raise
    except MemoryError:
        _end("Error: not enough memory. Use a coarser mesh.", SignoriniError.exit_code)
    except typer.Exit:
        raise
    except BaseException as error:
        if ASKED:
            _end(interrupted, interrupts.INTERRUPTED)
        # PyO3 raises a Rust panic as a BaseException that is not an Exception.
        if not isinstance(error, Exception) and type(error).__name__ != "PanicException":
            raise
        _end(
            f"Internal error ({type(error).__name__}: {' '.join(str(error).split())}). This is a bug of signorini "
            f"{signorini.__version__}; please report it with the input file.",
            SignoriniError.exit_code,
        )


def _end(message: str, code: int) -> None:
    say(streams.stderr(), visible(message))
    raise typer.Exit(code)
