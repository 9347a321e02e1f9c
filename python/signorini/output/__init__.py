"""Results as files: results.json, reactions.csv, and a .vtu and a picture of every combination."""

from __future__ import annotations

import json
import os
import re
import tempfile
from pathlib import Path

from signorini.errors import InputError
from signorini.files import replacing_together
from signorini.output.names import CSV, JSON, PRESSURE, has_areas, slugs, unique_slugs
from signorini.output.tables import reactions_csv, results_json
from signorini.result import pressure_layers, support_marks
from signorini.solve import Results

__all__ = ["CSV", "JSON", "reactions_csv", "require_writable", "results_json", "unique_slugs", "write"]

_OURS = re.compile(r"[\w.-]+\.(vtu|png)|reactions\.csv|results\.json")


def write(results: Results, directory: str | os.PathLike[str]) -> list[Path]:
    """Write ``results.json``, ``reactions.csv`` and, of each solved combination, a ``.vtu`` and pictures.

    All of them, or none: they are written elsewhere and moved into place when complete. The files of an earlier run in
    the directory are replaced as a set; other files in it stay.

    Parameters
    ----------
    results : Results
    directory : path-like
        Made if need be.

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
            (beside / CSV).write_text(reactions_csv(results), encoding="utf-8")
            (beside / JSON).write_text(json.dumps(found, indent=1, ensure_ascii=False, allow_nan=False) + "\n", "utf-8")
            names = found["files"]
    except OSError as error:
        raise _cannot_write(target, error) from None
    return [target / name for name in names]


def require_writable(directory: str | os.PathLike[str]) -> None:
    """Refuse a directory that results could not be written to, before the time to compute them is spent.

    Raises
    ------
    InputError
        If the directory, or where it does not exist yet the nearest that does, cannot be written to.
    """
    target = Path(directory).absolute()
    nearest = next(place for place in (target, *target.parents) if place.exists())
    try:
        with tempfile.TemporaryDirectory(prefix=".signorini-", dir=nearest):
            pass
    except OSError as error:
        raise _cannot_write(Path(directory), error) from None


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
