"""Results as files: results.json, reactions.csv, a .vtu and pictures of combinations, the table of all of them."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from signorini.analysis.solve import Results
from signorini.base.files import replacing_together
from signorini.base.forked import Forked
from signorini.formats.vtk import Vtu
from signorini.output.directory import cannot_write, former_results
from signorini.output.envelope_json import write_envelope
from signorini.output.governing import governing_csv
from signorini.output.names import CSV, GOVERNING, JSON, TABLE, envelope_files, slugs
from signorini.output.pictures import Drawing, envelope_sheets, sheets_of, write_refinement
from signorini.output.tables import reactions_csv, results_json
from signorini.results.result import vtk_fields


def write(
    results: Results,
    directory: str | os.PathLike[str],
    table: str | os.PathLike[str] | None = None,
    artists: Sequence[Forked] = (),
) -> list[Path]:
    """Write ``results.json``, ``reactions.csv`` and, of each solved combination, a ``.vtu`` and pictures.

    Of several combinations ``governing.csv`` comes with them. Where combinations are rows of a table, these are of the
    combinations in ``results``; the table and, unless no field is enveloped, ``envelope.vtu`` and its pictures come
    with them.

    All of them, or none: they are written elsewhere and moved into place when complete. The files of an earlier run in
    the directory are replaced as a set; other files in it stay, and one that has a name of ours is refused. Of several
    runs at once the last one leaves its files, whole, and none of the others'.

    Parameters
    ----------
    results : Results
    directory : path-like
        Made if need be.
    table : path-like, optional
        The table that `signorini.solve` has written, on the same file system; it is moved. Needed where combinations
        are rows of a table.
    artists : sequence of Forked
        Processes to draw the pictures (`signorini.output.pictures.artists`); without any, this one does.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    InputError
        If the directory cannot be made or written to, or has a file of somebody else's with the name of one of ours.
    """
    target = Path(directory)
    named = list(slugs(results))
    drawing = Drawing([*sheets_of(results, named), *envelope_sheets(results)], artists)
    found = results_json(results)
    names = [JSON, CSV]
    try:
        with replacing_together(target, partial(former_results, target), seal=JSON) as beside:
            solved = results.discretisation
            if named:
                vtu = Vtu(solved.stress_nodes.points, solved.stress_nodes.elements)
                for result, slug in named:
                    vtu.write(beside / f"{slug}.vtu", *vtk_fields(result))
            write_refinement(results, beside)
            for group, name in envelope_files(results).items():
                write_envelope(results.discretisation.stress_nodes, results.combined.over(group), beside / name)
            if table is not None:
                Path(table).rename(beside / TABLE)
            (beside / CSV).write_text(reactions_csv(results), encoding="utf-8")
            if len(results) > 1:
                (beside / GOVERNING).write_text(governing_csv(results), encoding="utf-8")
            (beside / JSON).write_text(json.dumps(found, indent=1, ensure_ascii=False, allow_nan=False) + "\n", "utf-8")
            for name, content in drawing.pictures():
                (beside / name).write_bytes(content)
            names = [entry["file"] for entry in found["files"]]
    except OSError as error:
        raise cannot_write(target, error) from None
    return [target / name for name in names]
