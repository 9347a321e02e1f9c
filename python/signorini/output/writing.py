"""Write results as files: results.json, reactions.csv, a .vtu file and pictures of each combination, a table of all."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Sequence
from itertools import chain
from pathlib import Path
from typing import Literal, Protocol, get_args

from signorini.accuracy.comparison import Estimate, PathEstimate
from signorini.analysis.estimate import Estimates, estimate_asked, estimates_of
from signorini.analysis.results import Results
from signorini.base import arguments
from signorini.base.arguments import checked, watching
from signorini.base.files import replacing_together
from signorini.errors import InputError
from signorini.formats.xlsx import write_xlsx
from signorini.output.checks import write_checks
from signorini.output.directory import cannot_write, former_results
from signorini.output.envelope_json import write_envelope
from signorini.output.governing import governing_csv
from signorini.output.load_path import write_path
from signorini.output.names import (
    CSV,
    GOVERNING,
    JSON,
    PROFILES_CSV,
    TABLE,
    XLSX,
    Chosen,
    Pictures,
    envelope_files,
    pieces,
    slugs,
)
from signorini.output.pictures import draw_profiles, jobs_of, profiles_csv, write_refinement
from signorini.output.spreadsheet import sheets_of
from signorini.output.tables import reactions_csv, results_json
from signorini.plot.picture import Job
from signorini.results.load_path import LoadPath
from signorini.results.result import Result


class Fields(Protocol):
    """Writes the fields of a result that several processes computed: a .vtu file for each process."""

    @property
    def count(self) -> int:
        """Number of processes."""

    def write(self, result: Result, path: Path, pieces: Sequence[Path]) -> None:
        """Write the .pvtu file ``path`` and the .vtu files ``pieces``, which it lists."""


_NOT_ITS = "it must be the return value of signorini.estimate(results)."


@checked
def write(
    results: Results | Result | LoadPath,
    directory: str | os.PathLike[str],
    estimate: Estimates | Estimate | PathEstimate | None = None,
    pictures: Literal["all", "governing", "none"] | None = None,
    xlsx: bool = False,
) -> list[Path]:
    """Write the files of `signorini solve` or `signorini path` into a directory.

    All files are written, or none; docs/results.md describes them. Files of an earlier run there are replaced as a set,
    and other files stay. With ``mesh.error``, the default, half-widths are computed by solving on other meshes, unless
    ``estimate`` is given. Rows of a table are solved again if they were too many to be stored.

    Parameters
    ----------
    results : Results, Result or LoadPath
        Return value of `signorini.solve`, `signorini.path` or `signorini.recover`, or the result of one combination.
    directory : path-like
        Directory to write to; made if it does not exist.
    estimate : Estimates, Estimate or PathEstimate, optional
        Half-widths from `signorini.estimate`.
    pictures : {"all", "governing", "none"}, optional
        Combinations of `Results` with pictures: by default all if there are up to four, else the governing ones.
    xlsx : bool
        Whether `Results` are also written as a spreadsheet, results.xlsx; XlsxWriter must be installed.

    Returns
    -------
    list of Path
        The written files.

    Raises
    ------
    InputError
        If the path is not a directory, cannot be made or written to, or has another program's file with the name of a
        file to be written.

    Examples
    --------
    >>> import tempfile
    >>> from signorini import Model, path, solve, write
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     mesh={"divisions": [4, 4]},
    ...     support=[{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}],
    ...     load=[{"case": "G", "pressure": 1e3}],
    ... )
    >>> with tempfile.TemporaryDirectory() as place:
    ...     files = [*write(solve(model), place), *write(path(model, None, "G"), place)]
    >>> [file.name for file in files if file.suffix in (".json", ".csv")]
    ['results.json', 'reactions.csv', 'path.json', 'path.csv']
    """
    arguments.path(directory, "a directory", "directory")
    if pictures is not None:
        arguments.known(pictures, get_args(Chosen), "choice", "pictures", "This function")
    if isinstance(results, LoadPath):
        of_path = estimate_asked(results) if estimate is None else estimate
        if not isinstance(of_path, PathEstimate | None):
            raise InputError(_NOT_ITS, place="estimate")
        return write_path(results, directory, of_path)
    if isinstance(results, Result):
        results = Results.alone(results)
    arguments.made_by(
        results, Results, "signorini.solve(model) returns Results, signorini.path(model, ...) a LoadPath.", "results"
    )
    if isinstance(estimate, Estimate):
        estimate = Estimates(results, {estimate.result.name: estimate}, None)
    if estimate is None and results.model.estimated:
        estimate = estimates_of(results, watching(None, ""))
    if not isinstance(estimate, Estimates | None):
        raise InputError(_NOT_ITS, place="estimate")
    return write_results(results, directory, estimate, pictures=pictures, xlsx=xlsx)


def write_results(
    results: Results,
    directory: str | os.PathLike[str],
    estimates: Estimates | None,
    table: str | os.PathLike[str] | None = None,
    pictures: Pictures = None,
    xlsx: bool = False,
    draw: Callable[[Sequence[Job]], Iterable[tuple[str, bytes]]] | None = None,
    fields: Fields | None = None,
) -> list[Path]:
    """Write ``results.json``, ``reactions.csv`` and, for each solved combination, a ``.vtu`` file and pictures.

    Several combinations also have ``governing.csv``. If combinations are rows of a table, the table is written too, and
    only combinations in ``results.full`` have files of their own. If fields are enveloped, ``envelope.vtu`` and its
    pictures are written. A ``table`` that `signorini.solve` wrote on the same file system is moved to the directory.

    All files are written, or none: they are written in a temporary directory and moved when all are complete. The files
    of an earlier run are replaced together. Other files are kept; a file of another program with the name of a file to
    be written raises `InputError`. If several runs write at once, the files are those of the last run. ``draw`` draws
    the pictures; if it is None, this process draws them. ``fields`` writes the fields; if it is None, this process
    writes one .vtu file of each result.
    """
    target = Path(directory)
    named = list(slugs(results))
    jobs = jobs_of(results, estimates, pictures)
    drawn = (draw or _drawn)(jobs) if jobs else ()
    values = results_json(results, estimates, pictures, xlsx, 0 if fields is None else fields.count)
    names = [JSON, CSV]
    try:
        with replacing_together(target, former_results, JSON, results.model.provenance.read) as beside:
            for result, slug in named:
                if fields is None:
                    result.to_vtk(beside / f"{slug}.vtu")
                else:
                    fields.write(
                        result, beside / f"{slug}.pvtu", [beside / name for name in pieces(slug, fields.count)]
                    )
            write_refinement(results, beside)
            if results.model.profile:
                (beside / PROFILES_CSV).write_text(profiles_csv(results), encoding="utf-8")
                draw_profiles(results, beside, pictures)
            plates = {one.name: one for one in results.discretisation.members}
            for (group, plate), name in envelope_files(results).items():
                metadata = results.model.provenance.metadata
                write_envelope(plates[plate], results.combined.over(group), group, beside / name, metadata)
            if table is not None:
                Path(table).rename(beside / TABLE)
            elif results.model.tabulated:
                _write_table(results, estimates, beside / TABLE)
            (beside / CSV).write_text(reactions_csv(results, estimates), encoding="utf-8")
            if len(results) > 1:
                (beside / GOVERNING).write_text(governing_csv(results, estimates), encoding="utf-8")
            write_checks(results, estimates, beside)
            (beside / JSON).write_text(
                json.dumps(values, indent=1, ensure_ascii=False, allow_nan=False) + "\n", "utf-8"
            )
            if xlsx:
                write_xlsx(beside / XLSX, sheets_of(values, results), results.model.provenance.metadata)
            for name, content in drawn:
                (beside / name).write_bytes(content)
            names = [entry["file"] for entry in values["files"]]
    except OSError as error:
        raise cannot_write(target, error) from None
    return [target / name for name in names]


def _drawn(jobs: Sequence[Job]) -> Iterable[tuple[str, bytes]]:
    # matplotlib is imported only for pictures.
    from signorini.plot.pictures import drawn

    return chain.from_iterable(map(drawn, jobs))


def _write_table(results: Results, estimates: Estimates | None, path: Path) -> None:
    # pyarrow is imported only for tables.
    from signorini.formats.parquet import writing

    widths = {} if estimates is None else estimates.table
    with writing(path, results.model.provenance.metadata) as sink:
        sink((*results.table.items(), *widths.items()))
