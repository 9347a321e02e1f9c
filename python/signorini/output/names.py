"""Names of result files, and cells of CSV tables."""

from __future__ import annotations

import csv
import io
import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any, Literal

from signorini.analysis.results import Results
from signorini.model import Model
from signorini.results.quantities import REINFORCEMENT
from signorini.results.result import Result
from signorini.results.support_result import areas_below, lines_below

JSON, CSV, TABLE, XLSX = "results.json", "reactions.csv", "combinations.parquet", "results.xlsx"
GOVERNING, CHECKS = "governing.csv", "checks.csv"
PATH_JSON, PATH_CSV, PATH_PICTURE = "path.json", "path.csv", "path.png"
INDEX, COVERAGE = "index.md", "coverage.md"
STUDY = "study.json"
REFINEMENT = "refinement.png"
PROFILES_CSV = "profiles.csv"
OF_ALL = frozenset((JSON, CSV, TABLE, XLSX, GOVERNING, CHECKS, PROFILES_CSV, REFINEMENT))
"""Names of the files of all combinations; files of one combination are pictures and .vtu files."""
DEFORMED, PRESSURE, MOMENTS, SHEARS, REACTIONS = "-deformed", "-pressure", "-moments", "-shears", "-reactions"
BARS = "-reinforcement"
"""Suffixes that a picture's file name has after the combination's name; a picture of deflections has none."""
PICTURES = {
    "": ("deflection",),
    DEFORMED: ("deflection",),
    MOMENTS: ("mx", "my", "mxy"),
    SHEARS: ("qx", "qy"),
    BARS: tuple(REINFORCEMENT),
    PRESSURE: ("pressure",),
    REACTIONS: (),
}
"""Fields that a picture shows, by the suffix of its name; pictures of reactions show diagrams along lines."""
_KINDS = {"": "picture", DEFORMED: "deformed", MOMENTS: "moments", SHEARS: "shears", PRESSURE: "pressure"}
_KINDS |= {REACTIONS: "line reactions", BARS: "reinforcement"}
Chosen = Literal["all", "governing", "none"]
Pictures = Chosen | None
"""Names of the combinations that have pictures. None: all combinations if there are at most `_FEW`, else the governing
ones.
"""
_FEW = 4
_CURVES = 10
"""Largest number of combinations that have a curve in a picture of a profile; with more, colours would repeat."""
_LONGEST_NAME = 80
_MINUS = re.compile(r"(?<![a-z0-9_.)\]-])-(?!-)|(?<!-)-(?![a-z0-9_.(\[-])")
"""Pattern of a dash that is a minus sign. A dash between words or numbers is a hyphen and does not match."""
_RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?")


def files(
    results: Results, pictures: Pictures = None, xlsx: bool = False, ranks: int = 0
) -> list[dict[str, str | None]]:
    """List the files of the results: combination (None for files of all combinations), kind and file name.

    Fields computed by several ``ranks`` have a file for each rank.
    """
    together = {"results": JSON, "reactions": CSV}
    together |= {"governing": GOVERNING} if len(results) > 1 else {}
    together |= {"spreadsheet": XLSX} if xlsx else {}
    together |= {"checks": CHECKS} if results.model.check else {}
    if results.model.profile:
        together["profile table"] = PROFILES_CSV
    together |= {"table": TABLE} if results.model.tabulated else {}
    together |= {"refinement": REFINEMENT} if results.refinement else {}
    named: list[tuple[str | None, str, str]] = [(None, kind, name) for kind, name in together.items()]
    if profiled(results, pictures):
        named += [(None, "profiles", name) for name in profile_pictures(results.model)]
    for (_, plate), name in envelope_files(results).items():
        named.append((None, "envelope", name))
        shown = envelope_pictures(results, name, plate) if pictures != "none" else {}
        named += [(None, _KINDS[ending], file) for ending, file in shown.items()]
    drawn = {one.name for one, _ in pictured(results, pictures)}
    for one, slug in slugs(results):
        named.append((one.name, *(("pvtu", f"{slug}.pvtu") if ranks else ("vtu", f"{slug}.vtu"))))
        named += [(one.name, "vtu", name) for name in pieces(slug, ranks)]
        endings = pictures_of(one) if one.name in drawn else {}
        named += [(one.name, _KINDS[ending], f"{slug}{ending}.png") for ending in endings]
    return [{"combination": name, "kind": kind, "file": file} for name, kind, file in named]


def pieces(slug: str, ranks: int) -> list[str]:
    """Names of the .vtu files of the ranks that a .pvtu file lists."""
    return [f"{slug}.{rank}.vtu" for rank in range(ranks)]


def expected_names(model: Model) -> Iterator[str]:
    """Yield the names of result files that are known before solving; governing combinations are known only after."""
    yield from (JSON, CSV)
    if len(model.effective_combinations) > 1:
        yield GOVERNING
    if model.check:
        yield CHECKS
    if model.profile:
        yield PROFILES_CSV
        yield from profile_pictures(model)
    taken = _taken(model)
    if model.mesh.accuracy is not None:
        yield REFINEMENT
    names: Iterable[str] = (combination.name for combination in model.effective_combinations)
    if model.tabulated:
        yield TABLE
        fields = model.output.fields
        names = names if fields == "all" else () if isinstance(fields, str) else fields
    for slug in unique_slugs([*taken, *_by_plate(model, names)]):
        yield from (f"{slug}{ending}" for ending in (".vtu", *(f"{ending}.png" for ending in PICTURES)))


def envelope_files(results: Results) -> dict[tuple[str, str], str]:
    """Names of the envelope files by (group, plate); group ``""`` is all combinations, plate ``""`` the only plate.

    A group that contains all combinations has no file of its own.
    """
    if not (results.model.tabulated and results.envelope.fields):
        return {}
    named = zip(_enveloped(results.model), unique_slugs(_envelopes(results.model)), strict=True)
    return {(group, plate): f"{slug}.vtu" for (group, plate), slug in named if results.combined.any_solved(group)}


def envelope_file(results: Results, group: str, plate: str = "") -> str | None:
    """Name of the envelope file of a group and plate; None if the group has no envelope."""
    return envelope_files(results).get((group if group in _parts(results.model) else "", plate))


def envelope_pictures(results: Results, file: str, plate: str) -> dict[str, str]:
    """Names of the pictures of one plate's envelope file, by their suffixes."""
    lines = bool(lines_on(results, plate))
    endings = [ending for ending in PICTURES if enveloped(results, ending) or (ending == REACTIONS and lines)]
    return {ending: f"{Path(file).stem}{ending}.png" for ending in endings}


def lines_on(results: Results, plate: str) -> list[int]:
    """Indices, in the model's list of supports, of the line supports of one plate.

    A line support between two plates is listed for the first of them.
    """
    owned = {one.name: one.numbers["support"] for one in results.discretisation.members}[plate]
    between = [support.between for support in results.model.support]
    lines = results.combined.layout.lines
    return [index for index in lines if index in owned and (between[index] or (plate,))[0] == plate]


def enveloped(results: Results, ending: str) -> tuple[str, ...]:
    """Fields that a picture of an envelope shows; none for a deformed view, since extremes are not one deformation."""
    if ending == PRESSURE:
        return PICTURES[PRESSURE] if results.combined.layout.at_rest else ()
    fields = () if ending == DEFORMED else PICTURES[ending]
    return tuple(field for field in fields if field in results.combined.layout.fields)


def profile_pictures(model: Model) -> list[str]:
    """File names of the pictures of profiles, in the order of the profiles."""
    return [f"{slug}.png" for slug in unique_slugs(f"profile {profile.name}" for profile in model.profile)]


def profiled(results: Results, pictures: Pictures) -> list[Result]:
    """Results that have a curve in pictures of profiles."""
    named = list(slugs(results))
    if pictures is None and len(named) <= _CURVES:
        pictures = "all"
    return [one for one, _ in pictured(results, pictures)]


def pictures_of(result: Result) -> dict[str, tuple[str, ...]]:
    """Fields of every picture of a combination, by the picture's suffix; pressures only if an area support exists."""
    without = set() if areas_below(result.supports) else {PRESSURE}
    without |= set() if lines_below(result.supports) else {REACTIONS}
    without |= set() if result.model.bars else {BARS}
    return {ending: fields for ending, fields in PICTURES.items() if ending not in without}


def _taken(model: Model) -> list[str]:
    """Names, without suffix, of pictures of all combinations; files of single combinations must have other names."""
    taken = _envelopes(model) if model.tabulated else []
    taken += [Path(name).stem for name in profile_pictures(model)]
    return taken + [Path(REFINEMENT).stem] * (model.mesh.accuracy is not None)


def _envelopes(model: Model) -> list[str]:
    return [" ".join(filter(None, ("envelope", *of))) for of in _enveloped(model)]


def _enveloped(model: Model) -> list[tuple[str, str]]:
    """Pairs (group, plate) that have an envelope."""
    return list(product(("", *_parts(model)), model.plates or ("",)))


def _parts(model: Model) -> list[str]:
    """Groups that contain some of the combinations, but not all."""
    combinations = model.effective_combinations
    return [group for group, count in combinations.groups.items() if count < len(combinations)]


def slugs(results: Results) -> Iterator[tuple[Result, str]]:
    """Pairs of a result and its file name: one for each solved combination or, with several plates, each of its plates.

    The names are distinct and valid on every file system.
    """
    solved = [result for result in results.full.values() if result.status == "solved"]
    plates = [plate for result in solved for plate in result.members.values()]
    taken = _taken(results.model)
    values = unique_slugs([*taken, *_by_plate(results.model, [result.name for result in solved])])
    return zip(plates, values[len(taken) :], strict=True)


def _by_plate(model: Model, names: Iterable[str]) -> Iterator[str]:
    """Yield the name of each combination or, with several plates, a name for each plate of each combination."""
    for name in names:
        yield from (f"{name} {plate}" for plate in model.plates) if model.plates else (name,)


def pictured(results: Results, pictures: Pictures) -> Iterator[tuple[Result, str]]:
    """Yield the results that have pictures, with their file names."""
    named = list(slugs(results))
    govern = pictures == "governing" or (pictures is None and len(named) > _FEW)
    wanted = set(results.governing) if govern else set(results) if pictures != "none" else set()
    return ((one, slug) for one, slug in named if one.name in wanted)


def unique_slugs(names: Iterable[str]) -> list[str]:
    """Convert names to distinct file names without suffix, of lower-case letters, digits, dots, dashes and plus signs.

    A dash that does not join two words or numbers becomes "minus". No returned name equals another returned name
    followed by a suffix of pictures.

    Examples
    --------
    >>> unique_slugs(["ULS 1.35G + 1.5Q", "uls 1.35G+1.5Q", "../été", "荷重", "con"])
    ['uls-1.35g+1.5q', 'uls-1.35g+1.5q-2', 'ete', 'combination', 'con-2']
    >>> unique_slugs(["W+ lead", "W- lead", "G - 1.5 W", "x-y"])
    ['w+lead', 'w-minus-lead', 'g-minus-1.5-w', 'x-y']
    >>> unique_slugs(["wind", "wind pressure", "snow pressure", "snow"])
    ['wind', 'wind-pressure-2', 'snow-pressure', 'snow-2']
    """
    taken: set[str] = set()
    result = []
    for name in names:
        plain = unicodedata.normalize("NFKD", name.replace("−", "-")).encode("ascii", "ignore").decode().lower()
        signed = _MINUS.sub(" minus ", plain)
        short = re.sub(r"-*\+-*", "+", re.sub(r"[^a-z0-9_.+]+", "-", signed))[:_LONGEST_NAME]
        base = short.strip("-.") or "combination"
        slug, count = base, 1
        while {slug + ending for ending in PICTURES} & taken or _RESERVED.fullmatch(slug):
            count += 1
            slug = f"{base}-{count}"
        taken |= {slug + ending for ending in PICTURES}
        result.append(slug)
    return result


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[Any] | Mapping[str, Any]]) -> str:
    """Write comma-separated values; each row is a sequence in column order, or a mapping by column name."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(columns)
    table.writerows([row.get(of) for of in columns] if isinstance(row, Mapping) else row for row in rows)
    return text.getvalue()


_FORMULA = ("=", "+", "-", "@", "\t", "\r", "＝", "＋", "－", "＠", "'")
"""First characters of cells that a spreadsheet computes (OWASP, *CSV Injection*), and the apostrophe before text."""


def name_cell(name: str) -> str:
    """Put an apostrophe before a name that a spreadsheet would compute, so that it is read as text.

    A name that begins with an apostrophe gets a second one, so that a program that reads the file removes one
    apostrophe from every such name. Numbers are not changed.

    Examples
    --------
    >>> [name_cell(name) for name in ("G + Q", "-W", "=1+1", "'t Huis", "")]
    ['G + Q', "'-W", "'=1+1", "''t Huis", '']
    """
    return f"'{name}" if name.startswith(_FORMULA) else name
