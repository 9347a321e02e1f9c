"""Results as files: results.json, reactions.csv, a .vtu and a picture of combinations, the table of all of them."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import tempfile
import unicodedata
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

from signorini.errors import InputError
from signorini.files import replacing_together
from signorini.result import ProbeResult, Result, SupportResult, support_marks
from signorini.solve import Results
from signorini.tabulated import ENVELOPE, TABLE, envelope_json, table_json, write_envelope

SCHEMA = 1
JSON, CSV = "results.json", "reactions.csv"
_LONGEST_NAME = 80
_RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?")
_OURS = re.compile(r"[\w.-]+\.(vtu|png)|reactions\.csv|results\.json|combinations\.parquet")
_COLUMNS = (
    *("combination", "support", "kind", "point", "x", "y", "reaction", "gap", "state"),
    *("closed", "open", "contact_area", "max_pressure"),
)


def results_json(results: Results) -> dict[str, Any]:
    """Give the results in the form of ``results.json``.

    Numbers of a combination without equilibrium are absent: its lists are empty, its tables None, and ``message``
    says why. No number is NaN or infinite.

    Parameters
    ----------
    results : Results

    Returns
    -------
    dict
        Of what JSON can hold; docs/results.md describes every key.

    Examples
    --------
    >>> import signorini
    >>> model = signorini.Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
    ...     support=[{"name": "bearings", "at": [[1, 1], [9, 1], [1, 9], [9, 9]], "resists": "down"}],
    ...     load=[{"pressure": 2e3}],
    ... )
    >>> found = results_json(signorini.solve(model))["combinations"][0]
    >>> found["name"], found["status"], [point["state"] for point in found["supports"][0]["points"]]
    ('all', 'solved', ['closed', 'closed', 'closed', 'closed'])
    """
    found, combined = results.discretisation, results.combined
    tabulated = {} if combined is None else {"table": table_json(combined), "envelope": envelope_json(combined, found)}
    return {
        "schema": SCHEMA,
        "title": found.model.title,
        "units": {"length": found.model.units.length, "force": found.model.units.force},
        "model": {
            "nodes": found.mesh.node_count,
            "elements": len(found.mesh.elements),
            "dofs": found.dof_count,
            "contact_points": int((~found.contacts.two_sided).sum()),
        },
        "combinations": [_combination(result) for result in results.values()],
        **tabulated,
        "seconds": {name: float(spent) for name, spent in results.seconds.items()},
        "files": _file_names(results),
    }


def reactions_csv(results: Results) -> str:
    """Give the reactions as a table of comma-separated values.

    A row a combination and support, its ``point`` "total"; and, for point supports, a row a point.

    Parameters
    ----------
    results : Results

    Returns
    -------
    str
    """
    text = io.StringIO()
    table = csv.DictWriter(text, _COLUMNS, lineterminator="\n")
    table.writeheader()
    for result in results.values():
        table.writerows(_rows(result))
    return text.getvalue()


def write(
    results: Results, directory: str | os.PathLike[str], table: str | os.PathLike[str] | None = None
) -> list[Path]:
    """Write ``results.json``, ``reactions.csv`` and, of each solved combination, a ``.vtu`` and a ``.png``.

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
    from signorini.plot import deflection_picture, save

    target = Path(directory)
    unit = results.discretisation.model.units.length
    found = results_json(results)
    names = [JSON, CSV]
    try:
        with replacing_together(target, _former(target), seal=JSON) as beside:
            for result, slug in _slugs(results):
                result.to_vtk(beside / f"{slug}.vtu")
                figure = deflection_picture(
                    result.mesh.points,
                    result.mesh.elements,
                    result.deflection,
                    support_marks(result),
                    title=", ".join(part for part in (result.model.title, result.name) if part),
                    label=f"deflection{f' [{unit}]' if unit else ''}, positive down",
                    length=unit,
                )
                save(figure, beside / f"{slug}.png")
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
    """Give a directory, for as long as the context lasts, on the file system where results will be written.

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
    nearest = next(place for place in (target, *target.parents) if place.exists())
    try:
        room = tempfile.TemporaryDirectory(prefix=".signorini-", dir=nearest)
    except OSError as error:
        raise _cannot_write(Path(directory), error) from None
    with room as place:
        yield Path(place)


def _cannot_write(target: Path, error: OSError) -> InputError:
    why = error.strerror or str(error)
    return InputError(f"the results cannot be written there: {why}. Name another directory.", str(target))


def _file_names(results: Results) -> list[str]:
    combined = results.combined
    together = [] if combined is None else [TABLE, *([ENVELOPE] if combined.envelope.fields else [])]
    return [JSON, CSV, *together, *(f"{slug}{suffix}" for _, slug in _slugs(results) for suffix in (".vtu", ".png"))]


def _former(target: Path) -> list[str]:
    """Files of an earlier run, by its own account; never a name that this program would not write."""
    try:
        named = json.loads((target / JSON).read_text("utf-8"))["files"]
        return [name for name in named if _OURS.fullmatch(name)]
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return []


def _slugs(results: Results) -> Iterator[tuple[Result, str]]:
    """Solved combinations with file names of their own, on every file system."""
    solved = [result for result in results.values() if result.status == "solved"]
    taken = [] if results.combined is None else [Path(ENVELOPE).stem]
    slugs = unique_slugs([*taken, *(result.name for result in solved)])
    return zip(solved, slugs[len(taken) :], strict=True)


def unique_slugs(names: Iterable[str]) -> list[str]:
    """Turn names into file names without suffix: short, of small letters, digits, dots, dashes, each once.

    Examples
    --------
    >>> unique_slugs(["ULS 1.35G + 1.5Q", "uls 1.35G / 1.5Q", "../été", "荷重", "con"])
    ['uls-1.35g-1.5q', 'uls-1.35g-1.5q-2', 'ete', 'combination', 'con-2']
    """
    taken: set[str] = set()
    slugs = []
    for name in names:
        plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode().lower()
        base = re.sub(r"[^a-z0-9_.]+", "-", plain)[:_LONGEST_NAME].strip("-.") or "combination"
        slug, count = base, 1
        while slug in taken or _RESERVED.fullmatch(slug):
            count += 1
            slug = f"{base}-{count}"
        taken.add(slug)
        slugs.append(slug)
    return slugs


def _combination(result: Result) -> dict[str, Any]:
    solved = result.status == "solved"
    return {
        "name": result.name,
        "status": result.status,
        "message": result.message,
        "method": result.method,
        "iterations": result.iterations,
        "certificate": _certificate(result) if solved else None,
        "deflection": _extremes(result) if solved else None,
        "supports": [_support(support) for support in result.supports],
        "probes": [_probe(probe) for probe in result.probes],
    }


def _certificate(result: Result) -> dict[str, Any]:
    return {**asdict(result.certificate), "passed": result.certificate.passed}


def _extremes(result: Result) -> dict[str, Any]:
    highest, lowest = int(result.deflection.argmax()), int(result.deflection.argmin())
    return {
        "max": float(result.deflection[highest]),
        "max_at": result.mesh.points[highest].tolist(),
        "min": float(result.deflection[lowest]),
        "min_at": result.mesh.points[lowest].tolist(),
    }


def _support(support: SupportResult) -> dict[str, Any]:
    found: dict[str, Any] = {
        "name": support.name,
        "kind": support.kind,
        "reaction": support.reaction,
        "closed": support.closed_count,
        "open": support.open_count,
        "contact_area": support.contact_area,
        "max_pressure": support.max_pressure,
    }
    if support.place == "at":
        found["points"] = [
            {"at": at, "reaction": reaction, "gap": gap, "state": "closed" if closed else "open"}
            for at, reaction, gap, closed in _points(support)
        ]
    return found


def _points(support: SupportResult) -> Iterator[tuple[list[float], float, float, bool]]:
    columns = (support.positions, support.reactions, support.gaps, support.closed)
    return zip(*(column.tolist() for column in columns), strict=True)


def _probe(probe: ProbeResult) -> dict[str, Any]:
    return {
        "at": list(probe.at),
        "deflection": probe.deflection,
        "rotation": list(probe.rotation),
        "moment": list(probe.moment),
        "shear": list(probe.shear),
    }


def _rows(result: Result) -> Iterator[dict[str, Any]]:
    if result.status != "solved":
        for asked in result.model.support:
            yield {"combination": result.name, "support": asked.name, "point": "total", "state": result.status}
    for support in result.supports:
        row = {"combination": result.name, "support": support.name, "kind": support.kind}
        yield row | {
            "point": "total",
            "reaction": support.reaction,
            "closed": support.closed_count,
            "open": support.open_count,
            "contact_area": support.contact_area,
            "max_pressure": support.max_pressure,
        }
        if support.place == "at":
            for number, ((x, y), reaction, gap, closed) in enumerate(_points(support), start=1):
                state = "closed" if closed else "open"
                yield row | {"point": number, "x": x, "y": y, "reaction": reaction, "gap": gap, "state": state}
