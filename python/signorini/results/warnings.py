"""Warnings of a model or an answer: sentences on input that can be solved but is probably a mistake."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Collection, Iterator, Sequence
from itertools import combinations, product

import numpy as np

from signorini.base.numbers import plain
from signorini.base.on_demand import kept
from signorini.contact.selection import NotUnique
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.meshing import to_follow
from signorini.discretise.quadrature import area_quadrature, curve_quadrature
from signorini.discretise.rows import Floats
from signorini.equilibrium.balance import NO_FORCE
from signorini.errors import point
from signorini.model import Load, MeshPlate, Model, Support
from signorini.model.material import ZONE_KEYS
from signorini.model.punching import EN_1992
from signorini.model.where import Acting
from signorini.results.envelope import NONE, Envelope
from signorini.results.extremes import Means
from signorini.results.of_plates import said_of
from signorini.results.quantities import ENDS, REINFORCEMENT, derived, on_plate
from signorini.results.support_points import SupportPoints
from signorini.results.support_result import SupportResult
from signorini.results.unit_slips import unit_slips
from signorini.shapes import Region
from signorini.shapes.distances import depth, distances
from signorini.shapes.regions import overlap
from signorini.singularities.named import singularities
from signorini.singularities.singularity import at_peaks

_FOLLOWED = 0.5
"""Smallest part of a line's length on element sides with which the mesh counts as following the line."""
_SMALLER = 0.5
"""Element size that warnings suggest, relative to the size of elements that a line cuts or that form a strip."""
_STRIP = 4
"""Smallest number of elements with which an area that is one element wide counts as a strip, not as a pad."""
_INSIDE = 1e-6
"""Depth of a point of one area inside another above which the areas overlap, relative to the plate's size."""
_TOUCH = 1e-6
"""Largest common area of two regions that only touch, relative to the area of the smaller region."""
_NOTHING = 1e-9
"""Largest component of a couple across an edge that counts as zero, relative to the couple's magnitude."""
_HARDLY = 1e-6
"""Largest tension of an area that counts as zero, relative to the area's largest pressure."""
_OUTWEIGHS = 1e3
"""Ratio of a support's reactions to the loads that causes a warning; couples of loads are divided by the thickness. A
thin plate has such a ratio on supports that are a tenth of its thickness apart.
"""
_UNSAID = ', since resists is left out. Give resists = "down" if the plate can lift off it, else "both".'
_INFINITE = ": the required reinforcement is infinite there. Use a thicker plate or stronger concrete."
_LARGEST = ("", ENDS.index("max")), ("_mean", ENDS.index("max_mean"))
"""For the maximum and the largest mean: argument ``mean`` of `Envelope.field`, and row of `Envelope.places_of`."""
_MOST = 0.75
"""Largest part of the plate's area that extremes exclude near singularities without a warning. For thick covers of
flanges on many bolts this part is a half.
"""


def model_warnings(discretisation: Discretisation, acting: Collection[str] | None = None) -> tuple[str, ...]:
    """Warnings of a model, such as E in another unit, a mesh of one element, two supports at one place.

    ``acting`` are the load cases at whose positions of moving loads footprints are checked; None for all positions.
    """
    of_plates = {plate.name: plate.own for plate in discretisation.members}
    return said_of({name: (*_whatever_acts(own), *_wheels_off(own, acting)) for name, own in of_plates.items()})


@kept
def _whatever_acts(discretisation: Discretisation) -> tuple[str, ...]:
    of_plate = unit_slips, _one_element, _one_across, _unrefined, _unfollowed, _zones, _left_out
    of_supports = _one_place, _overlaps, _footprints, _loads_overlap, _never_act, _beds_both_ways, _couples, _no_moments
    return tuple(said for check in (*of_plate, *of_supports) for said in check(discretisation))


def result_warnings(
    discretisation: Discretisation,
    load: CaseLoad,
    deflection: Floats,
    supports: Sequence[SupportResult],
    not_unique: Sequence[NotUnique],
    of_bars: Floats,
    means: Means,
) -> tuple[str, ...]:
    """Warnings of the result of one combination: first those about the model, then those about the answer.

    ``of_bars`` (s, 3) are moments at stress nodes for the design of bars.
    """
    warned = [
        *model_warnings(discretisation, load.acting),
        *idle_cases(discretisation.model),
        *no_resultant(discretisation, load),
        *too_far(discretisation, deflection),
        *too_thin(discretisation, load, of_bars, means),
    ]
    warned += _beds_that_pull(discretisation.model, supports)
    warned += _outweighing(discretisation, load, supports)
    return (*warned, *sentences(not_unique))


def too_thin(discretisation: Discretisation, load: CaseLoad, of_bars: Floats, means: Means) -> Iterator[str]:
    """Warn if a section cannot resist its design moment, at nodes or as a mean at a singular point.

    ``of_bars`` (s, 3) are moments at stress nodes.
    """
    nodes, bars = discretisation.stress_nodes, discretisation.model.bars
    if bars is None:
        return
    shear = np.zeros((len(of_bars), 2))
    areas = derived(list(REINFORCEMENT), of_bars, shear, discretisation.node_thickness, bars)
    peaks = at_peaks(discretisation.mesh, singularities(discretisation, load.acting), "moment")
    beyond = np.flatnonzero(np.isinf(areas).any(axis=1) & ~peaks[nodes.nodes])
    if len(beyond):
        count, first = f"at {len(beyond)} of {nodes.count} nodes, such as ", nodes.points[beyond[0]]
        yield f"The section cannot resist the design moment {count}at {point(first)}{_INFINITE}"
    ends = {name: means.ends(name) for name in REINFORCEMENT}
    for name, of in ends.items():
        if math.isinf(of.get("max_mean", 0.0)):
            yield f"The section cannot resist the mean design moment at {point(of['max_mean_at'])}, {name}{_INFINITE}"


def rows_too_thin(envelope: Envelope, key: Callable[[int], str]) -> Iterator[str]:
    """Warn, for each field of required reinforcement, of a row in which a section cannot resist its design moment.

    ``key`` is the name of a row.
    """
    plates, fields = (
        envelope.layout.model.plates or ("",),
        [one for one in envelope.layout.fields if one in REINFORCEMENT],
    )
    for field, (mean, end) in product([on_plate(one, name) for name in plates for one in fields], _LARGEST):
        if math.isinf((found := envelope.field(field, mean)).max) and found.max_by != NONE:
            what, place = f"{'mean ' * bool(mean)}design moment", point(envelope.places_of(field)[end].tolist())
            yield f'The section cannot resist the {what} at {place}, {field}, in "{key(found.max_by)}"{_INFINITE}'


def sentences(not_unique: Sequence[NotUnique]) -> tuple[str, ...]:
    """Sentences that describe which parts of an answer are not unique."""
    return tuple(f"{str(one)[0].upper()}{str(one)[1:]}." for one in not_unique)


def idle_cases(model: Model) -> Iterator[str]:
    """Warn of load cases and moving loads that occur in no combination.

    Load paths have no such warning, since the caller names their loads.
    """
    taken = model.effective_combinations.cases
    for case in model.load_cases:
        if case not in taken:
            yield f'The load case "{case}" acts in no combination. Is its name spelled correctly?'
    for case, positions in model.positions.items():
        if taken.isdisjoint(positions):
            yield (
                f'The moving load "{case}" acts in no combination. Name it in a combination with generate = '
                '"positions", "table" or "patterns".'
            )


def no_resultant(discretisation: Discretisation, load: CaseLoad) -> Iterator[str]:
    """Warn if the forces of a load sum to zero, or if no load acts and no support settles or is tightened."""
    if load.curvature.any() or any(support.between for support in discretisation.model.support):
        # Forces between plates are not loads, so there is no warning for several plates.
        return
    forces = load.nodal[::3]
    total = float(np.abs(forces).sum())
    cancel = total and abs(forces.sum()) <= NO_FORCE * total
    if cancel and not any(one.couple is not None and one.has_footprint for one in discretisation.model.load):
        yield "The load's resultant is zero: its forces cancel each other. Do all forces have the right sign?"
    elif not load.nodal.any() and not _some_base_moves(discretisation, load):
        yield "No load acts."


def too_far(discretisation: Discretisation, deflection: Floats) -> Iterator[str]:
    """Warn if a deflection (n,) exceeds the thickness, since the theory is valid for small deflections only."""
    elements, thickness = discretisation.mesh.elements, bending_thickness(discretisation)
    at = int((np.abs(deflection[elements]).max(axis=1) / thickness).argmax())
    node = elements[at, int(np.abs(deflection[elements[at]]).argmax())]
    if abs(deflection[node]) > thickness[at]:
        unit = discretisation.model.units.length and f" {discretisation.model.units.length}"
        where = point(discretisation.mesh.points[node], discretisation.mesh.size)
        yield (
            f"The deflection at {where}, {deflection[node]:.4g}{unit}, is beyond the thickness, "
            f"{thickness[at]:.4g}{unit}: the theory is valid for small deflections. Are E, thickness, "
            "loads and the stiffness of supports in the same units?"
        )


def _left_out(discretisation: Discretisation) -> Iterator[str]:
    """Warn if extremes of moments or shears exclude most of the plate, since most nodes are near singularities."""
    mesh, named = discretisation.mesh, singularities(discretisation)
    for number in ("moment", "shear"):
        peaks = at_peaks(mesh, named, number)
        part = float(mesh.element_area[peaks[mesh.elements].all(axis=1)].sum() / mesh.element_area.sum())
        where = f"is nearer than one thickness to places where {number}s have no limit"
        if peaks.all():
            yield f"All of the plate {where}: the largest {number}s occur there, and they grow as the mesh is refined."
        elif part > _MOST:
            yield f"{100 * part:.0f} % of the plate {where}. Extremes of {number}s exclude this part."


def bending_thickness(discretisation: Discretisation) -> Floats:
    """Thickness (ne,) of elements with which deflections are compared, at most the largest thickness outside zones.

    A thick zone moves with the plate around it, so that its own thickness is no measure of small deflections.
    """
    nominal = np.broadcast_to(discretisation.thickness.nominal.min(axis=1), len(discretisation.mesh.elements))
    own = nominal[discretisation.zones.of_elements.thickness == 0]
    return np.minimum(nominal, own.max()) if len(own) else nominal


def _zones(discretisation: Discretisation) -> Iterator[str]:
    """Warn of overlapping zones that give the same key, unless the later zone is inside the earlier, as is usual."""
    for (one, earlier), (other, later) in combinations(enumerate(discretisation.model.zone, 1), 2):
        first, second = discretisation.zones.inside[[one - 1, other - 1]]
        both = first & second
        keys = " and ".join(key for key in earlier.present(ZONE_KEYS) if key in later.present(ZONE_KEYS))
        if not keys or (both == second).all() or not both.any():
            continue
        if (both == first).all():
            yield (
                f"The {keys} of zone {one} counts nowhere: zone {other}, which comes later, covers it. "
                f"Put zone {one} after zone {other}."
            )
        else:
            at = point(discretisation.mesh.points[discretisation.mesh.elements[np.argmax(both), :4]].mean(axis=0))
            yield (
                f"Zones {one} and {other} overlap, such as at {at}: there the {keys} of zone {other} counts, since it "
                "is the later zone. Is that intended?"
            )


def _never_act(discretisation: Discretisation) -> Iterator[str]:
    """Warn of support points at which other supports hold every dof, so that these points can neither push nor open."""
    for index, support in enumerate(discretisation.model.support):
        count = len(support.where.points)
        listed = len(SupportPoints.of(discretisation, index).positions)
        if listed < count and support.holds_w:
            which = f"{count - listed} of its {count} points are" if count > 1 else "its point is"
            yield (
                f"{support.name}: {which} where other supports hold the plate, and have no reaction. "
                "Results number only the other points."
            )


def _beds_both_ways(discretisation: Discretisation) -> Iterator[str]:
    """Warn of beds that act in both directions by default beside one-sided supports: soil and grout hardly pull."""
    if _some_one_way(discretisation.model):
        yield from (f"{name} holds the plate down too{_UNSAID}" for name in _beds_unsaid(discretisation.model))


def _no_moments(discretisation: Discretisation) -> Iterator[str]:
    """Warn of punched columns with β to be computed from the moment at a support point that transfers no moment."""
    supports = {support.name: support for support in discretisation.model.support}
    for punching in discretisation.model.punching:
        support = supports.get(punching.support or "")
        if support is None or punching.beta != "computed" or support.area is not None:
            continue
        if not support.rotational and not support.holds_rotation:
            known = " or beta = 1.15 inside, 1.4 at edges, 1.5 at corners (EN 1992-1-1, 6.4.3 (6))"
            yield (
                f"Punching of {support.name}: supports without rotational stiffness transfer no moment, so β = 1. Give "
                f"rotational_stiffness{known if punching.code == EN_1992 else ' or beta'}."
            )


def _beds_that_pull(model: Model, supports: Sequence[SupportResult]) -> Iterator[str]:
    """Warn of beds that pull in this result though the input has no ``resists`` for them.

    If a support is one-sided, `_beds_both_ways` has warned already.
    """
    if _some_one_way(model):
        return
    unsaid = set(_beds_unsaid(model))
    for support in supports:
        if support.name in unsaid and (pull := support.max_tension or 0.0) > _HARDLY * (support.max_pressure or 0.0):
            yield f"{support.name} pulls the plate down, with up to {_with_unit(model, pull, -2)}{_UNSAID}"


def _outweighing(discretisation: Discretisation, load: CaseLoad, supports: Sequence[SupportResult]) -> Iterator[str]:
    """Warn of reactions much larger than the loads, such as of rigid supports that pry a thin plate apart."""
    if load.curvature.any() or _some_base_moves(discretisation, load) or discretisation.points.distance.any():
        return
    forces, *couples = np.abs(load.nodal.reshape(-1, 3)).sum(axis=0).tolist()
    acting = forces + sum(couples) / float(discretisation.thickness.min())
    sums = {support.name: float(np.abs(support.reactions).sum()) for support in supports}
    if acting and (most := max(sums.values(), default=0.0)) > _OUTWEIGHS * acting:
        names = " and ".join(name for name, value in sums.items() if value > 0.1 * most)
        yield (
            f"Reactions of {names} add up to {_with_unit(discretisation.model, most, 0)}, {most / acting:.1g} times "
            "the loads: rigid supports near each other pry the plate apart. Make these supports coincide, move them "
            "apart, or give them a stiffness."
        )


def _some_base_moves(discretisation: Discretisation, load: CaseLoad) -> bool:
    """Whether supports move the plate in addition to a load, because they settle or bolts are tightened."""
    settles = discretisation.held.values, discretisation.springs.distance, discretisation.points.settlement
    tightened = (one.case in (None, *load.acting) for one in discretisation.model.rounds)
    return any(values.any() for values in settles) or any(tightened)


def _with_unit(model: Model, value: float, power: int) -> str:
    """Text for a value with the unit force × length^power."""
    return f"{value:.4g} {model.units.force_by_length(power)}".rstrip()


def _some_one_way(model: Model) -> bool:
    return any(support.direction != "both" for support in model.support)


def _beds_unsaid(model: Model) -> Iterator[str]:
    for support in model.support:
        if support.area is not None and support.resists_by_default:
            yield support.name


def _unrefined(discretisation: Discretisation) -> Iterator[str]:
    """Warn of mesh refinements (``mesh.refine``) at places outside the plate."""
    mesh = discretisation.mesh
    for index, part in enumerate(discretisation.model.mesh.refine, 1):
        off = [f"point {point(at)}" for at in part.where.points if not mesh.locate(np.array([at])).inside.all()]
        along, area = part.where.curve, part.where.region
        if (along is not None and not curve_quadrature(mesh, along, order=1).total) or (
            area is not None and not area_quadrature(mesh, area, order=1).total
        ):
            off.append(part.place)
        for what in off:
            yield f"The {what} of refinement {index} is not on the plate, so it refines no elements."


def _unfollowed(discretisation: Discretisation) -> Iterator[str]:
    """Warn of supports and loads along lines and circles that cut elements, since the mesh does not follow them."""
    model, mesh = discretisation.model, discretisation.mesh
    named: list[tuple[str, Acting]] = [(support.name, support) for support in model.support]
    named += [(_name(index, load), load) for index, load in enumerate(model.load) if load.line_load is not None]
    for name, item in named:
        if (along := item.where.curve) is None:
            continue
        begin, _, end = mesh.points[mesh.sides_on(along)].transpose(1, 0, 2)
        points = curve_quadrature(mesh, along, order=1)
        if np.hypot(*(end - begin).T).sum() < _FOLLOWED * points.total:
            beside = distances(points.positions, begin, end).min(axis=1, initial=np.inf) > mesh.near.place
            first = int(np.argmax(beside))
            size = _SMALLER * math.sqrt(mesh.element_area[points.elements[first]])
            where = f"along it, such as at {point(points.positions[first], mesh.size)}"
            shared = isinstance(item, Support) and item.is_rigid
            near = ", and near other supports the error of its reaction may exceed its ±" if shared else ""
            yield (
                f"The mesh does not follow the {item.place} of {name}: in the elements that the line cuts, moments "
                f"and shears are means of both sides{near}. {to_follow(model, where, size)}"
            )


@kept
def _off_plate(discretisation: Discretisation) -> list[tuple[str, str, int, float]]:
    """Wheels' footprints that are partly off the plate, listed as by `Cases.partly_off`; computed once."""
    return list(discretisation.cases.partly_off())


def _wheels_off(discretisation: Discretisation, acting: Collection[str] | None) -> Iterator[str]:
    """Warn of moving loads with a wheel's footprint partly off the plate.

    The warning names the position where the wheel loses most of its force.
    """
    off = [one for one in _off_plate(discretisation) if acting is None or one[1] in acting]
    for case in dict.fromkeys(case for case, *_ in off):
        those = [(lost, at, axle) for one, at, axle, lost in off if one == case]
        lost, at, axle = max(those)
        more = len({at for _, at, _ in those}) - 1
        also = f"; so do wheels at {more} more position{'s' * (more > 1)}" if more else ""
        yield (
            f'A wheel of the moving load "{case}" is partly off the plate: at {at}, axle {axle}, '
            f"{plain(100 * lost, 3)} % of its force does not act{also}. Move the line inwards, or end it earlier."
        )


def _name(index: int, load: Load) -> str:
    return f'load[{index + 1}] (case "{load.case}")'


def _one_element(discretisation: Discretisation) -> Iterator[str]:
    mesh = discretisation.mesh
    if len(mesh.elements) == 1:
        yield "The mesh is a single element, too coarse for the bending of the plate. Use more elements."
    elif np.isin(mesh.elements[:, :4], mesh.sides[mesh.on_boundary]).all():
        yield "The mesh is one element wide, too coarse for bending across the plate. Use more elements."
    elif mesh.spanning.any():
        first = mesh.points[mesh.elements[np.argmax(mesh.spanning), :4]].mean(axis=0)
        yield (
            f"{int(mesh.spanning.sum())} elements reach from edge to edge, such as at {point(first)}: too coarse for "
            "the bending of the plate there. Use smaller elements: mesh.size or mesh.refine."
        )


def _one_across(discretisation: Discretisation) -> Iterator[str]:
    """Warn of elastic strips and rings, such as gaskets, that are one element wide: all corner nodes are on the rim."""
    mesh = discretisation.mesh
    for index, support in enumerate(discretisation.model.support):
        if support.area is None or not support.is_elastic:
            continue
        mine = np.isin(np.arange(len(mesh.elements)), SupportPoints.of(discretisation, index).elements)
        rim = np.isin(
            np.arange(len(mesh.points)), np.r_[mesh.elements[~mine].ravel(), mesh.sides[mesh.on_boundary].ravel()]
        )
        if mine.sum() >= _STRIP and rim[mesh.elements[mine, :4]].all():
            size = _SMALLER * math.sqrt(mesh.element_area[mine].min())
            own = isinstance(discretisation.model.plate, MeshPlate)
            helps = "Make the mesh finer there." if own else f"Take elements of {size:.2g} or less there (mesh.refine)."
            yield f"{support.name} is one element wide, too coarse for its pressure across the width. {helps}"


def _one_place(discretisation: Discretisation) -> Iterator[str]:
    model = discretisation.model
    rigid = [i for i, s in enumerate(model.support) if s.place == "at" and not s.is_elastic]
    places = [SupportPoints.of(discretisation, index).positions for index in rigid]
    within = discretisation.mesh.near.place
    for (one, here), (other, there) in combinations(zip(rigid, places, strict=True), 2):
        near = (np.abs(here[:, None] - there) <= within).all(axis=-1).any(axis=-1)
        first, second = model.support[one], model.support[other]
        as_large = (first.patch, first.angle, first.radius) == (second.patch, second.angle, second.radius)
        if near.any() and _alike(first, second) and as_large:
            yield (
                f"{first.name} and {second.name} both hold the plate rigidly at "
                f"{point(here[near][0], discretisation.mesh.size)}: how they share the reaction is a convention."
            )


def _couples(discretisation: Discretisation) -> Iterator[str]:
    """Warn of couples on an edge that holds the slope: their component across the edge loads only the support."""
    model, mesh = discretisation.model, discretisation.mesh
    for holding in model.support:
        for name in holding.where.edges:
            begin, end = mesh.points[mesh.edges[name][:, [0, 2]]].transpose(1, 0, 2)
            for index, load in enumerate(model.load) if "slope" in holding.fixed else ():
                if load.couple is None or load.at is None or load.has_footprint:
                    continue
                apart = distances(np.array(load.at), begin, end)
                side = apart.argmin(axis=1)
                across = (end - begin)[side][:, ::-1] * [1.0, -1.0]
                part = np.abs(across @ load.couple) / (np.hypot(*across.T) * math.hypot(*load.couple) + 1e-300)
                if len(lost := np.flatnonzero((apart.min(axis=1) <= mesh.near.place) & (part > _NOTHING))):
                    yield (
                        f"The couple of {_name(index, load)} at {point(load.at[lost[0]])} turns the plate across the "
                        f"edge {name}, where {holding.name} holds the slope: this component loads the support only."
                    )


def _overlaps(discretisation: Discretisation) -> Iterator[str]:
    model = discretisation.model
    elastic = [i for i, s in enumerate(model.support) if s.area is not None and s.is_elastic]
    for one, other in combinations(elastic, 2):
        first, second = model.support[one], model.support[other]
        if first.between != second.between or not _alike(first, second):
            continue
        if _reaches(discretisation, one, other) or _reaches(discretisation, other, one):
            yield f"The areas of {first.name} and {second.name} overlap: in the overlap their stiffnesses add."


def _footprints(discretisation: Discretisation) -> Iterator[str]:
    """Warn of overlapping footprints of supports that act in the same direction."""
    supports, mesh = discretisation.model.support, discretisation.mesh
    held = [(i, shape) for i, support in enumerate(supports) for shape in support.where.footprints]
    for one, other, at in _overlapping(held):
        first, second = supports[one], supports[other]
        if _alike(first, second) and first.between == second.between:
            what = f"of {first.name}" if one == other else f"of {first.name} and {second.name}"
            yield f"Footprints {what} overlap, such as at {point(at, mesh.size)}: both act in the overlap."


def _loads_overlap(discretisation: Discretisation) -> Iterator[str]:
    """Warn of overlapping areas or footprints of two loads of the same kind in the same load case."""
    mesh, alike = discretisation.mesh, dict[tuple[str, str], list[tuple[int, Region]]]()
    for index, load in enumerate(discretisation.model.load):
        shapes = load.where.footprints if load.where.region is None else (load.where.region,)
        alike.setdefault((load.case, load.kind), []).extend((index, shape) for shape in shapes)
    for (case, _), acting in alike.items():
        for one, other, at in _overlapping(acting):
            which = f"load[{one + 1}]" if one == other else f"load[{one + 1}] and load[{other + 1}]"
            where = f'of {which} (case "{case}") overlap, such as at {point(at, mesh.size)}'
            yield f"Areas {where}: in the overlap their pressures add. Is that intended?"


def _overlapping(shapes: Sequence[tuple[int, Region]]) -> Iterator[tuple[int, int, Floats]]:
    """Yield each pair of supports or loads with overlapping regions, and a point in the bounding boxes of both."""
    told = set[tuple[int, int]]()
    shapes = sorted(shapes, key=lambda one: one[1].bounds[0])
    begin = [shape.bounds[0] for _, shape in shapes]
    beside = ((i, j) for i, (_, shape) in enumerate(shapes) for j in range(i + 1, bisect_left(begin, shape.bounds[2])))
    for (one, first), (other, second) in ((shapes[i], shapes[j]) for i, j in beside):
        pair = min(one, other), max(one, other)
        common = first.bounds, second.bounds
        low, high = np.max(common, axis=0)[:2], np.min(common, axis=0)[2:]
        if pair in told or (high <= low).any():
            continue
        parts = [(overlap(a, b), i, j) for i, a in enumerate(first.loops) for j, b in enumerate(second.loops)]
        if sum(part if (i > 0) == (j > 0) else -part for part, i, j in parts) > _TOUCH * min(first.area, second.area):
            told.add(pair)
            yield *pair, 0.5 * (low + high)


def _alike(one: Support, other: Support) -> bool:
    """Whether two supports can both push, or both pull, at the same time."""
    return {one.direction, other.direction} != {"down", "up"}


def _reaches(discretisation: Discretisation, one: int, other: int) -> bool:
    """Whether area support number ``one`` has points inside area support number ``other``."""
    points, others = SupportPoints.of(discretisation, one), SupportPoints.of(discretisation, other)
    positions = points.positions[np.isin(points.elements, others.elements)]
    of_other = discretisation.model.support[other].where.region
    if of_other is None or not len(positions):
        return len(positions) > 0
    return bool((depth(of_other, positions) > _INSIDE * discretisation.mesh.size).any())
