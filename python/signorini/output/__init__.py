"""Results as files: results.json, reactions.csv, a .vtu and pictures of combinations, the table of all of them."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from signorini.errors import InputError
from signorini.files import replacing_together, room_beside
from signorini.output.loadpath import PATH_JSON, PATH_PICTURE, path_json, write_path
from signorini.output.names import CSV, JSON, PRESSURE, has_areas, slugs, unique_slugs
from signorini.output.tables import reactions_csv, results_json
from signorini.result import pressure_layers, support_marks
from signorini.solve import Results
from signorini.tabulated import ENVELOPE, TABLE, write_envelope

__all__ = [
    "CSV",
    "JSON",
    "PATH_JSON",
    "PATH_PICTURE",
    "path_json",
    "reactions_csv",
    "results_json",
    "room_for",
    "unique_slugs",
    "write",
    "write_path",
]

_OURS = re.compile(r"[\w.-]+\.(vtu|png)|reactions\.csv|results\.json|combinations\.parquet")


def write(
    results: Results, directory: str | os.PathLike[str], table: str | os.PathLike[str] | None = None
) -> list[Path]:
    """Write ``results.json``, ``reactions.csv`` and, of each solved combination, a ``.vtu`` and pictures.

    Where combinations are rows of a table, these are of the combinations in ``results``; the table and, unless no field
    is enveloped, ``envelope.vtu`` come with them.

    All of them, or none: they are written elsewhere and moved into place when complete. The files of an earlier run in
    the directory are replaced as a set; other files in it stay.

    Parameters
    ----------
    results : Results
    directory : path-like
        Made if need be.
    table : path-like, optional
        The table that `signorini.solve` has written, on the same file system; it is moved. Needed where combinations
        are rows of a table.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    InputError
        If the directory cannot be made or written to.
    """
    # Only this function needs matplotlib.
    from signorini.plot import deflection_picture, pressure_picture, save

    target = Path(directory)
    units = results.discretisation.model.units
    of_length = f" [{units.length}]" if units.length else ""
    of_pressure = f" [{units.force}/{units.length}²]" if units.force and units.length else ""
    found = results_json(results)
    names = [JSON, CSV]
    try:
        with replacing_together(target, _former(target), seal=JSON) as beside:
            for result, slug in slugs(results):
                result.to_vtk(beside / f"{slug}.vtu")
                plate = (result.mesh.points, result.mesh.elements)
                marks = support_marks(result)
                title = ", ".join(part for part in (result.model.title, result.name) if part)
                label = f"deflection{of_length}, positive down"
                figure = deflection_picture(
                    *plate, result.deflection, marks, title=title, label=label, length=units.length
                )
                save(figure, beside / f"{slug}.png")
                if has_areas(results):
                    layers, label = pressure_layers(result), f"contact pressure{of_pressure}, positive up"
                    figure = pressure_picture(*plate, layers, marks, title=title, label=label, length=units.length)
                    save(figure, beside / f"{slug}{PRESSURE}.png")
            if results.combined is not None and results.combined.envelope.fields:
                write_envelope(results.combined, results.discretisation, beside / ENVELOPE)
            if table is not None:
                Path(table).rename(beside / TABLE)
            (beside / CSV).write_text(reactions_csv(results), encoding="utf-8")
            (beside / JSON).write_text(json.dumps(found, indent=1, ensure_ascii=False, allow_nan=False) + "\n", "utf-8")
            names = found["files"]
    except OSError as error:
        raise _cannot_write(target, error) from None
    return [target / name for name in names]


@contextmanager
def room_for(directory: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a hidden directory, for as long as the context lasts, on the file system where results will be written.

    It is refused before the time to compute them is spent.

    Yields
    ------
    Path

    Raises
    ------
    InputError
        If the directory, or where it does not exist yet the nearest that does, cannot be written to.
    """
    target = Path(directory).absolute()
    with ExitStack() as context:
        try:
            nearest = next(place for place in (target, *target.parents) if place.exists())
            room = context.enter_context(room_beside(nearest, target.name))
        except OSError as error:
            raise _cannot_write(Path(directory), error) from None
        yield room


def _cannot_write(target: Path, error: OSError) -> InputError:
    why = error.strerror or str(error)
    return InputError(f"the results cannot be written there: {why}. Name another directory.", str(target))


def _former(target: Path) -> list[str]:
    """Files of an earlier run, by its own account; never a name that this program would not write."""
    try:
        named = json.loads((target / JSON).read_text("utf-8"))["files"]
        return [name for name in named if _OURS.fullmatch(name)]
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return []
