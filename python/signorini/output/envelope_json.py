"""JSON of a table of combinations: its summary and its envelopes."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from signorini.accuracy.comparison import Meshes, compared, known
from signorini.analysis.combinations import Combined
from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.discretisation import OfWhole
from signorini.discretise.rows import Floats
from signorini.formats.vtk import as_meshio, write_vtu
from signorini.mesh import Mesh
from signorini.output.names import TABLE, envelope_file
from signorini.results.checks import utilisations
from signorini.results.envelope import NONE, Envelope
from signorini.results.extremes import least_at
from signorini.results.figures import columns_named, with_widths
from signorini.results.local_results import least_along
from signorini.results.quantities import ENDS, SIDES, Number, Path, Quantity, place_of
from signorini.results.warnings import idle_cases, model_warnings, rows_too_thin, too_far
from signorini.singularities.beside import beside_of
from signorini.singularities.named import excluding, singularities

_ESTIMATED = ("fields", "supports", "contacts", "probes", "sections", "strips", "punching", "plates")


def table_json(results: Results, estimates: Estimates | None) -> dict[str, Any]:
    """Return the value of the key "table" of results.json."""
    combined = results.combined
    return {
        "file": TABLE,
        "combinations": len(combined.combinations),
        "solved": combined.solved,
        "no_equilibrium": len(combined.combinations) - combined.solved,
        "solved_alone": combined.alone,
        "not_unique": combined.not_unique,
        "governing": list(results.governing),
        "certificate": {**combined.certificate, "passed": True} if combined.solved else None,
        "warnings": list(table_warnings(results, estimates)),
        "unbalanced": [{"name": name, "message": message} for name, message in combined.unbalanced.items()],
    }


def table_warnings(results: Results, estimates: Estimates | None) -> Iterator[str]:
    """Yield warnings about the model and, if these have envelopes, about deflections and required reinforcement."""
    yield from model_warnings(results.discretisation, results.model.effective_combinations.cases)
    yield from idle_cases(results.model)
    extremes = results.envelope.fields.get("deflection")
    if extremes is not None:
        down = extremes.largest >= -extremes.smallest
        yield from too_far(results.discretisation, np.where(down, extremes.largest, extremes.smallest))
    yield from rows_too_thin(results.envelope, results.key)
    if estimates is not None and estimates.no_others:
        yield estimates.no_others


def envelope_json(results: Results, estimates: Estimates | None = None, group: str = "") -> dict[str, Any] | None:
    """Value of "envelope" in results.json for a group (``""``: all combinations); None if none was solved."""
    own = _Shown.of(results.combined, results.discretisation.mesh, group)
    if own is None:
        return None
    plus_minus, tree = None, own.tree(results, group)
    others = () if estimates is None or estimates.of_table is None else estimates.of_table.others
    told = [one for combined, mesh in others if (one := _Shown.of(combined, mesh, group)) is not None]
    if told and estimates is not None:
        # Extremes over the nodes of several plates together have no half-widths.
        widths = {} if results.model.plates else _widths_of_wholes(results, own, told)
        for number, path, side, row in own.ends():
            known_row = number.estimated and row != NONE
            widths[*path, side] = estimates.half_width(number.column, row) if known_row else None
        plus_minus = with_widths({key: tree[key] for key in _ESTIMATED if key in tree}, widths)
    for plate in results.model.plates:
        tree["plates"][plate]["file"] = envelope_file(results, group, plate)
    return {"file": envelope_file(results, group), **tree, "plus_minus": plus_minus}


def _widths_of_wholes(results: Results, own: _Shown, others: Sequence[_Shown]) -> dict[Path, float | None]:
    """Half-widths, by JSON path, of extremes over nodes or points; such extremes have no column in the table."""
    meshes = Meshes.of(own.mesh, [one.mesh for one in others])
    every = [next(one for one in (own, *others) if one.mesh is mesh) for mesh in meshes.every]
    numbers = [number for number, *_ in own.wholes()]
    # On a mesh with nodes along a line support, its largest force per length is not among these numbers: NaN.
    found = [{number.path: value for number, value, *_ in one.wholes()} for one in every]
    values = np.array([[of.get(number.path, np.nan) for number in numbers] for of in found])[:, :, None]
    named = [(singularities(results.discretisation), np.ones(1, np.bool_))]
    result, _ = compared(values, numbers, meshes, results.model, results.combined.layout.probes, named)
    return {one.path: known(width) for one, (width,) in zip(numbers, result.tolist(), strict=True)}


@dataclass(frozen=True, eq=False)
class _Shown:
    """The envelope of the combinations of a group, and the mesh on which they were solved."""

    envelope: Envelope
    mesh: Mesh

    @classmethod
    def of(cls, combined: Combined, mesh: Mesh, group: str) -> _Shown | None:
        return cls(combined.over(group), mesh) if combined.any_solved(group) else None

    def ends(self) -> Iterator[tuple[Number, Path, str, int]]:
        """Yield the extremes of table columns: number, its path of keys, key of the extreme, and row of the table."""
        layout, of = self.envelope.layout, self.envelope.values
        for place, one in enumerate(layout.catalogue):
            if not one.quantity.enveloped:
                continue
            for side, (_, by) in zip(SIDES, of.sides, strict=True):
                if one.home not in ("field", "mean") or one.what.startswith(side):
                    key = one.what if one.home == "mean" else side
                    yield one, one.envelope_path, key, int(by[place])

    def wholes(self) -> Iterator[tuple[Number, float, int, list[float]]]:
        """Yield the extremes over nodes or points: number, value, row of the table, and position.

        These extremes have no column in the table.
        """
        envelope, mesh, layout = self.envelope, self.mesh, self.envelope.layout
        over = {"reaction": (mesh.points, envelope.fields["reaction"])} if "reaction" in envelope.fields else {}
        for name, (places, extremes) in envelope.pressures.items():
            elastic = name == "contact_pressure"
            over[name] = (mesh.points[places] if elastic else mesh.points[mesh.elements[places]].mean(axis=1)), extremes
        for name, (points, extremes) in over.items():
            quantity = Quantity(name, "reaction" if name == "reaction" else "pressure")
            for side, at, (values, by) in zip(SIDES, extremes.ends, extremes.sides, strict=True):
                number = Number(quantity, "field", 0, ("fields", name, side), name)
                yield number, float(values[at]), int(by[at]), points[at].tolist()
        for index, extremes in envelope.along.items():
            support, of_support = layout.model.support[index], layout.supports[index]
            area = layout.at_rest.get(index)
            if not len(extremes.largest) or (area is None and len(of_support.nodes)):
                continue
            per = extremes.largest if area is not None else extremes.largest / of_support.weights
            where = area.pressure_places if area is not None else of_support.positions
            at, quantity = int(per.argmax()), Quantity("largest", "pressure")
            number = Number(
                quantity, "support", index, (*place_of(layout.model, index), "largest", "max"), support.name
            )
            yield number, float(per[at]), int(extremes.largest_by[at]), where[at].tolist()

    def tree(self, results: Results, group: str) -> dict[str, Any]:
        """Return the extremes as nested dictionaries in the form of results.json."""
        envelope, layout = self.envelope, self.envelope.layout
        cases = frozenset(results.model.effective_combinations.cases_of(group))
        supports = [self._support(results, index) for index in range(len(layout.supports))]
        first_contact = len(supports) - len(layout.model.contact)
        result: dict[str, Any] = {
            "fields": {name: {} for name in layout.fields},
            **({"plates": {plate: {} for plate in layout.model.plates}} if layout.model.plates else {}),
            "supports": supports[:first_contact],
            **({"contacts": supports[first_contact:]} if layout.model.contact else {}),
            "probes": [{"at": at} for at in layout.probes.tolist()],
            "sections": [{"name": section.name} for section in layout.model.section],
            "strips": [
                {"name": strip.name, "stations": [{"at": at} for at in strip.places[0].tolist()]}
                for strip in layout.model.strip
            ],
            **({"punching": columns} if (columns := columns_named(layout.model)) else {}),
        }
        for one, path, side, row in self.ends():
            if one.what == "gap" and (side == "min" or not envelope.open_in[one.owner][one.part]):
                continue
            at, value = _at(result, path), getattr(envelope[one.column], side[:3])
            at |= (
                {side: None, f"{side}_by": None}
                if row == NONE
                else {side: None if np.isinf(value) else value, f"{side}_by": results.key(row)}
            )
            place = list[float]()
            if one.home in ("field", "mean"):
                place = envelope.places[one.owner, ENDS.index(side)].tolist()
                at[f"{side}_at"] = None if row == NONE else place
            if one.quantity.kind == "reinforcement" and one.home != "mean" and side == "max":
                at["minimum_governs"] = None if row == NONE else _is_least(results, one, value, place)
            if one.home == "mean":
                of = excluding(results.discretisation, one.quantity.singular, cases)
                named = [part for part in of if one.over_plates or part.plate == path[1]]
                at["excluded"] = [
                    {"what": part.what, "within": part.within, **({"plate": part.plate} if part.plate else {})}
                    for part in named
                ]
                at[f"{side}_width"] = None if row == NONE else _width_at(results, place)
        for number, value, row, place in self.wholes():
            at, side = _at(result, number.path[:-1]), str(number.path[-1])
            at |= {side: value, f"{side}_by": results.key(row), f"{side}_at": place}
            if number.home == "support":
                at["per"] = "area" if number.owner in layout.at_rest else "length"
        return result

    def _support(self, results: Results, index: int) -> dict[str, Any]:
        layout, lifted_in = self.envelope.layout, self.envelope.lifted_in[index]
        support, points = layout.model.support[index], layout.supports[index]
        result: dict[str, Any] = {"name": support.name, "lifted": int((lifted_in > 0).sum())}
        if support.place == "at":
            pairs = zip(points.positions.tolist(), lifted_in.tolist(), strict=True)
            result["points"] = [{"at": at, "gap": None, "lifted_in": count} for at, count in pairs]
        if (line := layout.lines.get(index)) is not None:
            where = layout.on_lines[index]
            ends = [self._ends(results, number) for number in range(where.start, where.stop)]
            places = zip(line.positions.tolist(), line.s.tolist(), ends, strict=False)
            result["line"] = [{"at": at, "s": s, **own} for at, s, own in places]
            corners = zip(line.corners.tolist(), ends[len(line.s) :], strict=True)
            result["corners"] = [{"at": at, **own} for at, own in corners]
        return result

    def _ends(self, results: Results, number: int) -> dict[str, Any]:
        """Return both extremes of a reaction per length or of a concentrated force, with their combinations."""
        extremes: dict[str, Any] = {}
        for side, (values, by) in zip(SIDES, self.envelope.on_lines.sides, strict=True):
            extremes |= {side: float(values[number]), f"{side}_by": results.key(int(by[number]))}
        return extremes


def _is_least(results: Results, one: Number, area: float, place: Sequence[float]) -> bool:
    """Whether an area of reinforcement, at a node, a probe or a station of a strip, is the minimum reinforcement."""
    found, name, bars = results.discretisation, one.quantity.name, results.model.bars
    assert bars is not None  # Areas of reinforcement exist only if the input has [reinforcement].
    if one.home == "field":
        return least_at(name, area, place, bars, found.stress_nodes, found.node_thickness)
    if one.home == "probe":
        return bool(bars.are_least(name, area, _at_probes(found)[one.owner]))
    member = next(plate for plate in found.members if one.owner in plate.numbers["strip"])
    own = member.numbers["strip"].index(one.owner)
    counts = [strip.stations for strip in member.own.model.strip]
    every = [area] * sum(counts)
    return bool(least_along(member.own, name.removeprefix("as_"), every)[sum(counts[:own]) + one.part])


@kept
def _at_probes(found: Discretisation) -> Floats:
    """Thickness (q,) at all probes of a model."""
    tables = dict[int, Floats]()
    for plate in found.members:
        ends = np.cumsum([len(probe.at) for probe in plate.own.model.probe])
        tables |= zip(plate.numbers["probe"], np.split(plate.own.probe_thickness, ends), strict=False)
    return np.concatenate([tables[index] for index in sorted(tables)])


def _width_at(results: Results, place: Sequence[float]) -> float:
    return max(beside_of(plate).width_at(place) for plate in results.discretisation.each)


def _at(tree: dict[str, Any], path: Path) -> dict[str, Any]:
    """Return the nested dictionary at a path of keys; missing dictionaries are added."""
    result: Any = tree
    for key in path:
        if isinstance(key, str) and result.get(key) is None:
            result[key] = {}
        result = result[key]
    table: dict[str, Any] = result
    return table


def write_envelope(
    plate: OfWhole, envelope: Envelope, group: str, path: str | os.PathLike[str], metadata: Mapping[str, str]
) -> None:
    """Write a .vtu file with the extremes of a group at the nodes of a plate, and the numbers of their rows.

    Extremes are those of every field, and the largest utilisation of each check that includes the group.
    """
    nodes, model = plate.own.stress_nodes, plate.own.model
    mesh, envelope = nodes.mesh, envelope.on(plate)
    at_nodes: dict[str, Floats] = {}
    of_elements: dict[str, Floats] = {}
    fields = {name: (np.arange(len(of.largest)), of) for name, of in envelope.fields.items()}
    for name, (places, extremes) in (fields | envelope.pressures).items():
        rigid = name == "rigid_contact_pressure"
        for side, (value, by) in zip(SIDES, extremes.sides, strict=True):
            for ending, values, elsewhere in (("", value, 0.0), ("_row", by, NONE)):
                count = len(mesh.elements) if rigid else max(mesh.node_count, len(values))
                data = np.full(count, float(elsewhere))
                data[places] = values
                (of_elements if rigid else at_nodes)[f"{name}_{side}{ending}"] = data
    for name, (field, check) in utilisations(model).items():
        if field in envelope.fields and check.includes(group, model.effective_combinations):
            values, rows = envelope.utilisation(field, check)
            at_nodes |= {f"{name}_max": values, f"{name}_max_row": rows.astype(np.float64)}
    at_nodes = {name: nodes.spread(data) for name, data in at_nodes.items()}
    write_vtu(path, as_meshio(nodes.points, nodes.elements, at_nodes, of_elements), metadata)
