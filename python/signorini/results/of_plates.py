"""Models with several plates: the plate of each number, and the number's index in this plate's catalogue."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from signorini.model import Model
from signorini.results.quantities import Catalogue, Number

Place = tuple[int, int]
"""Index of a plate, and index of a number in that plate's catalogue (or index of an object in that plate's model)."""


def places_in_plates(model: Model, whole: Sequence[Number], own: Sequence[Catalogue]) -> tuple[tuple[Place, ...], ...]:
    """For each number of a model with several plates, pairs of a plate and the index in this plate's catalogue.

    An extreme over all plates has one pair for each plate. Numbers of a support between two plates belong to the upper
    plate.
    """
    names, homes = list(model.plates), _homes(model)
    result: list[tuple[Place, ...]] = []
    for one in whole:
        path, key = one.path, str(one.path[0])
        if key == "plates":
            plates: Sequence[int] = [names.index(str(path[1]))]
            path = path[2:]
        elif one.home == "check":
            plates = ()
        elif one.over_plates:
            plates = range(len(names))
        else:
            table = "supports" if key == "contacts" else key
            plate, local = homes[table][one.owner]
            plates, path = [plate], (table, local, *path[2:])
        result.append(tuple((plate, own[plate].by_path[path]) for plate in plates))
    return tuple(result)


def said_of(each: Mapping[str, Sequence[str]]) -> tuple[str, ...]:
    """Prefix the sentences of each plate with its name; a sentence that all plates have gets no prefix."""
    plates: dict[str, list[str]] = {}
    for name, sentences in each.items():
        for sentence in dict.fromkeys(sentences):
            plates.setdefault(sentence, []).append(name)
    alike = len(each)
    return tuple(said if len(names) == alike else f"{' and '.join(names)}: {said}" for said, names in plates.items())


def _homes(model: Model) -> Mapping[str, Mapping[int, Place]]:
    """Plate and index in it of each support, probe, section, strip and column; each point of a [[probe]] is a probe."""
    result: dict[str, dict[int, Place]] = {"supports": {}, "probes": {}, "sections": {}, "strips": {}, "punching": {}}
    first = [0]
    for probe in model.probe:
        first.append(first[-1] + len(probe.at))
    for plate, part in enumerate(model.parts):
        for key in ("support", "section", "strip"):
            for local, number in enumerate(part.numbers[key]):
                between = key == "support" and model.support[number].between
                if not between or between[0] == part.name:
                    result[f"{key}s"][number] = plate, local
        columns = [at for at, column in enumerate(model.columns) if column.table in part.numbers["punching"]]
        result["punching"] |= {at: (plate, local) for local, at in enumerate(columns)}
        points = [at for number in part.numbers["probe"] for at in range(first[number], first[number + 1])]
        result["probes"] |= {at: (plate, local) for local, at in enumerate(points)}
    return result
