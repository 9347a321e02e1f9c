"""Interactive maps of fields: the data of results for one HTML file, and the markup of a viewer.

A page has `assets_html` once and `map_html` for each viewer; it makes no request.
"""

from __future__ import annotations

import base64
import html
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any, NamedTuple, Self

import numpy as np

from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.discretise.discretisation import OfWhole
from signorini.discretise.laws import constant_limit
from signorini.discretise.rows import Floats, Ints
from signorini.errors import InputError
from signorini.model import Model
from signorini.reports.blobs import Blobs, Grid, decimal_codes, rounded
from signorini.reports.blocks import for_script, shown_in
from signorini.reports.map_marks import EXACT, lines_of, plate_marks, support_states
from signorini.reports.names import numbered, short
from signorini.reports.punching import Punched
from signorini.results.checks import quantity_of, utilisations
from signorini.results.contact_field.area_contact import AreaContact
from signorini.results.envelope import NONE, Envelope
from signorini.results.load_path import LoadPath, typical_t
from signorini.results.marks import drawn, extreme, panel
from signorini.results.quantities import DESIGN_MOMENTS, FIELDS, PICTURED, PRESSURE, REINFORCEMENT, SIDES, on_plate
from signorini.results.result import Result
from signorini.results.support_result import areas_below

BUDGET = 1_500_000
"""Largest size of a viewer's arrays in the page [bytes]."""
MAIN = ("deflection", PRESSURE.name)
"""Fields that are stored before all others; the others are stored as long as the size budget lasts."""
_MOST_STOPS = 24
"""Largest number of stops (load factors with results) of a load path in a viewer."""
_MOST_NAMES = 500
"""Largest number of governing combinations of a field whose names a viewer stores, to show them at the pointer."""
_ENDS = ("largest", "smallest")
ASSETS = ("maps.css", "maps.vert", "maps.frag", "maps.js")


@dataclass(frozen=True, eq=False)
class MapData:
    """Data of a viewer: a header for JSON, and deflated arrays to which it refers by number."""

    header: dict[str, Any]
    content: bytes


class _Layer(NamedTuple):
    """Values of a field, (s,) at stress nodes or (e,) on elements: of the whole plate, or of one area support."""

    values: Floats
    at_nodes: bool = True
    bounds: tuple[float, float] | None = None  # pressures outside these bounds are drawn as a gap
    number: int = -1
    area: AreaContact | None = None
    by: Ints | None = None  # (s,): in an envelope, the combination (row) that gives each value
    key: Callable[[int], str] = str  # name of the combination in a row

    @property
    def limit(self) -> float | None:
        """Pressure at which the area support yields, if it is constant over the area; else None."""
        return None if self.area is None else constant_limit(self.area.support)


@dataclass(frozen=True, eq=False)
class _OfResult:
    """A state of a map that shows one result: a combination, or a stop of a load path."""

    about: dict[str, Any]
    rank: int  # fields of states with a lower rank are stored first
    result: Result
    estimates: Estimates | None = None

    def supports(self, plate: OfWhole) -> list[dict[str, Any]]:
        return support_states(self._on(plate), self._plus_minus(plate))

    def contact(self, plate: OfWhole) -> list[Floats]:
        return [line for one in self._on(plate).supports if not one.upon for line in one.contact_boundary]

    def has(self, plate: OfWhole, name: str) -> bool:
        result = self._on(plate)
        return bool(areas_below(result.supports)) if name == PRESSURE.name else name in result.fields

    def describe(self, plate: OfWhole, name: str) -> dict[str, Any]:
        told = self._plus_minus(plate)
        scale, _ = _shown_in(self.result.model, name)
        shown = panel(name, self._on(plate), told, scale=scale)
        of = {} if told is None else told["deflection"] if name == "deflection" else told["fields"].get(name, {})
        width = max((of[side] for side in SIDES if of.get(side) is not None), default=None)
        ends = [[words, *rounded(at)] for words, at in shown.extremes]
        limits, width = [scale * end for end in shown.limits], None if width is None else scale * width
        return {"range": rounded(limits), "ends": ends, "discs": rounded(shown.hatched), "width": width}

    def layers(self, plate: OfWhole, name: str) -> Iterator[_Layer]:
        result, nodes = self._on(plate), plate.own.stress_nodes
        if name != PRESSURE.name:
            yield _Layer(_shown_in(result.model, name)[0] * nodes.spread(result.fields[name]))
            return
        for number, support in enumerate(result.supports):
            if (area := support.area) is not None and not support.upon:
                rigid = bool(area.stiff[area.covered > 0].all())
                values = area.element_pressure if rigid else nodes.spread(area.nodal_pressing)
                yield _Layer(values, not rigid, area.bounds, number, area)

    def _on(self, plate: OfWhole) -> Result:
        return self.result.members[plate.name]

    def _plus_minus(self, plate: OfWhole) -> Mapping[str, Any] | None:
        known = self.estimates is not None and self.result.name in self.estimates
        return self.estimates[self.result.name].of(self._on(plate)).plus_minus if self.estimates and known else None


@dataclass(frozen=True, eq=False)
class _OfEnvelope:
    """A state of a map that shows one end of an envelope: ``end`` 0 has the largest values, 1 the smallest."""

    about: dict[str, Any]
    envelope: Envelope
    end: int
    key: Callable[[int], str]  # long name of the combination in a row, for the pointer
    label: Callable[[int], str]  # short name of the combination in a row, on the map
    estimates: Estimates | None = None
    rank: int = 0

    def supports(self, plate: OfWhole) -> None:
        return None

    def contact(self, plate: OfWhole) -> list[Floats]:
        return []

    def has(self, plate: OfWhole, name: str) -> bool:
        if name in (checked := utilisations(plate.own.model)):
            field, check = checked[name]
            return self.end == 0 and not check.combinations and field in self.envelope.layout.fields
        return bool(self.envelope.pressures) if name == PRESSURE.name else name in self.envelope.layout.fields

    def describe(self, plate: OfWhole, name: str) -> dict[str, Any]:
        if name == PRESSURE.name:
            values = [side for _, one in self.envelope.pressures.values() for side in (one.largest, one.smallest)]
            low, high = min(float(of.min()) for of in values), max(float(of.max()) for of in values)
            return {"range": rounded([min(low, 0.0), max(high, 0.0)]), "ends": [], "discs": [], "width": None}
        if name in utilisations(plate.own.model):
            field, check = utilisations(plate.own.model)[name]
            ends = self.envelope.field(on_plate(field, plate.name))
            used = check.used(np.array([ends.max, ends.min]))
            side = int(used.argmax())
            words = f"{extreme('max', used[side], False, None)}, {self.label((ends.max_by, ends.min_by)[side])}"
            place = rounded(self.envelope.places_of(on_plate(field, plate.name))[side])
            return {"range": rounded([0.0, used[side]]), "ends": [[words, *place]], "discs": [], "width": None}
        column, width = on_plate(name, plate.name), None
        ends = self.envelope.field(column)
        value, row = (ends.min, ends.min_by) if self.end else (ends.max, ends.max_by)
        told = self.estimates is not None and bool(self.estimates.table)
        if self.estimates is not None and told:
            width = self.estimates.half_width(f"{SIDES[self.end]}:{column}", row)
        scale, _ = _shown_in(self.envelope.layout.model, name)
        width = None if width is None else scale * width
        limits = [scale * ends.min, scale * ends.max]
        words = f"{extreme(SIDES[self.end], scale * value, told, width, max(map(abs, limits)))}, {self.label(row)}"
        at = rounded(self.envelope.places_of(column)[self.end])
        return {"range": rounded(limits), "ends": [[words, *at]], "discs": [], "width": width}

    def layers(self, plate: OfWhole, name: str) -> Iterator[_Layer]:
        nodes = plate.own.stress_nodes
        if name in utilisations(plate.own.model):
            values, by = self._utilisation(plate, name)
            yield _Layer(nodes.spread(values), by=by, key=self.key)
            return
        if name != PRESSURE.name:
            values, by = self.envelope.on(plate).fields[name].sides[self.end]
            values = _shown_in(self.envelope.layout.model, name)[0] * values
            yield _Layer(nodes.spread(values), by=by[nodes.nodes] if len(by) < nodes.count else by, key=self.key)
            return
        for kind, (where, extremes) in self.envelope.pressures.items():
            at_nodes = kind == "contact_pressure"
            values = np.zeros(nodes.mesh.node_count if at_nodes else len(nodes.elements))
            values[where] = getattr(extremes, _ENDS[self.end])
            yield _Layer(nodes.spread(values) if at_nodes else values, at_nodes, (0.0, np.inf))

    def _utilisation(self, plate: OfWhole, name: str) -> tuple[Floats, Ints]:
        """Largest utilisation (s,) at the stress nodes of a plate, and the combination (row, (s,)) of each."""
        field, check = utilisations(plate.own.model)[name]
        values, by = self.envelope.on(plate).utilisation(field, check)
        of_nodes = plate.own.stress_nodes.nodes
        return (values[of_nodes], by[of_nodes]) if len(by) < len(of_nodes) else (values, by)


def _shown_in(model: Model, name: str) -> tuple[float, str]:
    """Factor and unit in which a report writes a field."""
    return shown_in(quantity_of(model, name)[0], model.units)


def fields_of(model: Model) -> tuple[str, ...]:
    """Fields of a viewer, most important first: areas of bars, design moments, deflection, pressure, utilisations.

    With reinforcement, von Mises' stress comes last, since it does not apply to concrete.
    """
    checked = tuple(utilisations(model))
    if model.bars is None:
        return (*MAIN, *checked, *(name for name in PICTURED if name not in MAIN))
    first = (*REINFORCEMENT, *DESIGN_MOMENTS, *MAIN, *checked)
    last = ("rotation_x", "rotation_y", "von_mises")
    return (*first, *(name for name in PICTURED if name not in first + last), *last)


_State = _OfResult | _OfEnvelope


def map_data(
    results: Results | Result | LoadPath,
    estimates: Estimates | None = None,
    *,
    fields: Sequence[str] = (),
    budget: int = BUDGET,
    columns: Sequence[Punched] = (),
) -> MapData:
    """Collect the data of a viewer: geometry, marks, and fields of combinations and envelopes or of a path's stops.

    Arrays are stored until ``budget`` is used: deflection and pressure of envelopes and of governing combinations, then
    further ``fields`` of these in the order given, then other combinations of ``results.full`` in the same way.

    Parameters
    ----------
    results : Results, Result or LoadPath
    estimates : Estimates, optional
        Half-widths: ``signorini.estimate(results)``.
    fields : sequence of str
        Names in `PICTURED`, most important first; by default `fields_of`.
    budget : int
        Largest size of the arrays in the page [bytes].
    columns : sequence of Punched
        Punched columns whose perimeters are drawn.

    Raises
    ------
    InputError
        If no combination has an equilibrium.
    """
    whole = Results.alone(results) if isinstance(results, Result) else results
    states, blobs = list(_states(results, estimates)), Blobs(budget)
    if not states:
        raise InputError("found no combination with an equilibrium; a map needs a result.", place="results")
    units, fields = whole.model.units, fields or fields_of(whole.model)
    main = {*MAIN, *utilisations(whole.model), *((*REINFORCEMENT, *DESIGN_MOMENTS) if whole.model.bars else ())}
    plates = [_Plate.of(plate, blobs, columns) for plate in whole.discretisation.members]
    asked = sorted(
        (4 * (state.rank > 1) + 2 * (name not in main) + state.rank % 2, order, row, plate)
        for row, state in enumerate(states)
        for order, name in enumerate(fields)
        for plate, of in enumerate(plates)
        if state.has(of.plate, name)
    )
    stored: list[list[dict[str, Any]]] = [[{} for _ in plates] for _ in states]
    left_out = len(asked)
    for _, order, row, plate in asked:
        name, state, of = fields[order], states[row], plates[plate]
        values = list(state.layers(of.plate, name))
        known = any(np.isfinite(one.values).any() for one in values)  # a plate given by its stiffness has no stresses
        layers = of.store(values, _largest(state, of.plate, name)) if known else []
        if layers is None:
            break
        left_out -= 1
        if not layers:
            continue
        about = state.describe(of.plate, name)
        stored[row][plate][name] = about | {"layers": layers, "discs": of.disc_number(about["discs"])}
    kept = [name for name in fields if any(name in of for row in stored for of in row)]
    header = {
        "title": whole.model.title,
        "path": whole.name if isinstance(whole, LoadPath) else "",
        "length": units.length,
        "plates": [one.header for one in plates],
        "fields": [
            {"name": of, "words": quantity_of(whole.model, of)[0].words, "unit": _shown_in(whole.model, of)[1]}
            for of in kept
        ],
        "states": [
            state.about
            | {
                "plates": [
                    {
                        "fields": of,
                        "supports": state.supports(one.plate),
                        "contact": lines_of(*state.contact(one.plate)),
                    }
                    for of, one in zip(row, plates, strict=True)
                ]
            }
            for state, row in zip(states, stored, strict=True)
            if any(row)
        ],
        "left_out": left_out,
        "blobs": blobs.places,
    }
    return MapData(header, bytes(blobs.content))


def _largest(state: _State, plate: OfWhole, name: str) -> float:
    """Largest magnitude of all fields of the same kind in one state; values within its rounding are stored as zero."""
    kind = quantity_of(plate.own.model, name)[0].kind
    alike = (one for one in FIELDS if PICTURED[one].kind == kind and state.has(plate, one))
    values = (layer.values for one in {*alike, name} for layer in state.layers(plate, one))
    return max(float(np.abs(of[np.isfinite(of)]).max(initial=0.0)) for of in values)


def _states(results: Results | Result | LoadPath, estimates: Estimates | None) -> Iterator[_State]:
    """Yield the states of a viewer: envelopes, then governing and other combinations, or stops of a path.

    A path has no envelope: at the end of equilibrium its deflections and pressures grow without limit.
    """
    if isinstance(results, Result):
        if results.status == "solved":
            yield _OfResult({"kind": "combination", "name": results.name, "words": results.name}, 1, results)
        return
    if isinstance(results, LoadPath):
        typical = typical_t(results)
        words = {typical: ""} | {results.key(row): results.words(row) for row in _stops(results)}
        for t in sorted(words):
            about = {"kind": "stop", "name": f"t = {t:.6g}", "t": t, "words": words[t], "printed": t == typical}
            yield _OfResult(about, 1, results.at(t))
        return
    key, label = (lambda row: numbered(results, results.key(row))), (lambda row: short(results, results.key(row)))
    combinations = results.model.effective_combinations
    several = len(results.groups) > 1
    envelopes = {"": results.envelope} | (dict(results.groups) if several else {})
    for group, envelope in envelopes.items() if results.combined.solved > 1 else ():
        mixed = several and not group and sum(combinations.groups.values()) == len(combinations)
        for end, side in enumerate(_ENDS):
            yield _OfEnvelope({"kind": side, "name": group, "mixed": mixed}, envelope, end, key, label, estimates)
    governing = results.governing
    for name in [*governing, *(name for name in results.full if name not in governing)]:
        if (result := results[name]).status == "solved":
            group = combinations[results.number_of(name)].group
            about = {"kind": "combination", "name": name, "words": numbered(results, name), "group": group}
            yield _OfResult(about, 1 + (name not in governing), result, estimates)


def _stops(path: LoadPath) -> list[int]:
    """Indices of the stops of a load path in a viewer: events, thresholds, both ends, and some equally spaced stops."""
    told = [row for row in range(len(path.stops)) if path.words(row)]
    others = [row for row in range(len(path.stops)) if not path.words(row)]
    places = np.unique(np.linspace(0, max(len(others) - 1, 0), max(_MOST_STOPS - len(told), 0)).astype(np.int64))
    return sorted([*told, *(others[at] for at in places.tolist() if others)])


@dataclass(frozen=True, eq=False)
class _Plate:
    """One plate of a viewer: its header, and its arrays in ``blobs``."""

    plate: OfWhole
    blobs: Blobs
    grid: Grid
    header: dict[str, Any]

    @classmethod
    def of(cls, plate: OfWhole, blobs: Blobs, columns: Sequence[Punched]) -> Self:
        """Store the geometry of a plate in ``blobs``, and return the plate with its header."""
        nodes = plate.own.stress_nodes
        grid, low, size = Grid(nodes), nodes.points.min(axis=0), float(np.ptp(nodes.points, axis=0).max())
        codes = np.rint((nodes.points - low) / size * 65_535).astype(np.int64)
        header = {
            "name": plate.name,
            "low": low.tolist(),
            "size": size,
            "nodes": nodes.count,
            "corners": grid.corners,
            "elements": len(nodes.elements),
            "wide": nodes.count > 65_535,
            "index": blobs.add(grid.elements(), nodes.count > 65_535),
            "xy": [blobs.add(grid.at_nodes(codes[:, axis])) for axis in range(2)],
            "marks": plate_marks(plate.own, columns),
            "areas": {},
            "discs": [],
        }
        if None in (header["index"], *header["xy"]):
            raise InputError(f"found {blobs.room}; the mesh alone needs more bytes than this.", place="budget")
        return cls(plate, blobs, grid, header)

    def store(self, layers: Sequence[_Layer], largest: float) -> list[dict[str, Any]] | None:
        """Store the layers of a field and return their descriptions; None if there is no room in ``blobs``."""
        result = []
        for layer in layers:
            codes, first, power = decimal_codes(layer.values, largest)
            blob = self.blobs.add(self.grid.at_nodes(codes) if layer.at_nodes else self.grid.on_elements(codes))
            about: dict[str, Any] = {"blob": blob, "first": first, "power": power, "nodes": layer.at_nodes}
            if layer.bounds is not None:
                about["bounds"] = [end if np.isfinite(end) else None for end in layer.bounds]
            if layer.area is not None:
                about |= {"area": layer.number, "limit": layer.limit}
                self._keep_area(layer.number, layer.area)
            if layer.by is not None:
                rows, numbers = np.unique(layer.by, return_inverse=True)
                by = self.blobs.add(self.grid.at_nodes(numbers)) if len(rows) <= _MOST_NAMES else None
                about |= (
                    {}
                    if by is None
                    else {"by": by, "names": ["" if row == NONE else layer.key(row) for row in rows.tolist()]}
                )
            if blob is None or any(area["on"] is None for area in self.header["areas"].values()):
                return None
            result.append(about)
        return result

    def disc_number(self, discs: list[Any]) -> int:
        """Index in the header of a list of discs around singular places; equal lists are stored once."""
        if discs not in self.header["discs"]:
            self.header["discs"].append(discs)
        return int(self.header["discs"].index(discs))

    def _keep_area(self, number: int, area: AreaContact) -> None:
        """Store, once for each area support, its elements and the outline that clips them."""
        if number not in self.header["areas"]:
            on = (area.covered > 0).astype(np.int64)
            where, exact = area.support.where, EXACT * area.mesh.size
            outline = [] if where.region is None else lines_of(drawn(area.mesh, where), exact=exact)
            self.header["areas"][number] = {"on": self.blobs.add(self.grid.on_elements(on)), "outline": outline}


def map_html(data: MapData, element_id: str, language: str = "en", texts: Mapping[str, str] | None = None) -> str:
    """Markup of a viewer with its data; "<" is escaped, so that names are text.

    ``texts`` replaces texts of the ``language`` in ``assets/maps.json``, and words of fields by their names.
    """
    known = json.loads(_asset("maps.json"))[language] | dict(texts or {})
    header = for_script(json.dumps(data.header | {"texts": known}, allow_nan=False, separators=(",", ":")))
    return (
        f'<div class="signorini-map" id="{html.escape(element_id)}">'
        f'<script type="application/json">{header}</script>'
        f'<script type="application/octet-stream">{base64.b64encode(data.content).decode()}</script></div>'
    )


def _asset(name: str) -> str:
    return (resources.files("signorini.reports") / "assets" / name).read_text(encoding="utf-8")


def assets() -> dict[str, str]:
    """Style, shaders and script of the viewers by file name; a page embeds each once."""
    return {name: _asset(name) for name in ASSETS}


def assets_html() -> str:
    """Markup of `assets`: a page has it once, before its viewers are mounted."""
    of = assets()
    shaders = (f'<script type="x-shader" id="{name}">{of[name]}</script>' for name in ("maps.vert", "maps.frag"))
    return f"<style>{of['maps.css']}</style>{''.join(shaders)}<script>{of['maps.js']}</script>"
