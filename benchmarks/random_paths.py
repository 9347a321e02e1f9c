"""Load paths of random small plates, followed to their ends and compared with direct solutions.

The models are those of tests/fuzz/path_models.py. Conditions on a path from event to event:

- it continues while reactions at the mesh's contact points balance the load, by an independent linear program, or
  until the load at t = 0 is smaller than the rounding of t times the growing load;
- it ends where reactions cease to balance the load, or continues without limit if a direct solution at large t exists;
- inside every segment the direct solution by the other method, Lemke's algorithm or the active set, is certified and
  has the same deflections where these are unique;
- at every event a point that opens or closes has a reaction before or after, or a gap;
- where the plate jumps at one t, deflections, or reactions of supports or points, change;
- between two stops the supports' reactions are linear, except for reactions of dependent supports;
- it takes at most a few hundred solver steps per stop;
- at stops the direct solution has the same extremes of deflection where these are unique, and the supports' reactions
  add up to the load.

Conditions on the sampled path of the same model:

- it continues as long and ends for the same reason as the exact path; if it continues without limit, it includes the
  last named event of the exact path. Deflections and fractions in contact at its stops are those of the exact path;
- its events of points are those of the exact path, except events undone between samples.

The path of an extreme model may stop early, but must not be wrong.

    python benchmarks/random_paths.py [--count 10000] [--first 0] [--seconds 600] [--processes 2]
    python benchmarks/random_paths.py --show SEED
    python benchmarks/random_paths.py --check        a few plates, to test the script
"""

from __future__ import annotations

import itertools
import json
import sys
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fuzz"))
sys.path.insert(0, str(Path(__file__).parent))
import campaign
import door
from path_models import drawn
from random_plates import MOVES, reactions_exist

from signorini import InputError, NoEquilibriumError, NotCertifiedError, path, solve, validate
from signorini.contact.strategy import answered
from signorini.discretise import discretise

_FAR = 1e-4
"""Relative distance from the limit of equilibrium at which equilibrium is checked on both sides."""
_FAR_OUT = 1e8
"""A path without further events is checked at this multiple of its last t."""
_SAME = 1e-7
"""Largest difference of equal deflections, relative to the largest deflection."""
_BALANCED = 1e-5
"""Largest imbalance at a stop, relative to the load or the largest reaction."""
_STAYS = 1e-9
"""Largest relative difference of a value before and after a jump that counts as unchanged."""
_SAMPLES = 12
_NEAR = 1e-8
"""Tolerance for the t of an event, relative to the path's length."""
_PART = 1e-6
"""Largest difference of equal fractions in contact."""
_MOST_FAULTS = 3
_MOST_STEPS = 500
"""Largest number of solver steps per stop."""
_MOST_SEGMENTS = 12
"""Largest number of segments of a path that are compared with direct solutions."""


def at_start(found, start):
    """Load at t = 0: none, case G, or cases G and Q."""
    return 0.0 * found.cases["G"] if start is None else found.cases["G"] + (start == "both") * found.cases["Q"]


def balanced(found, load):
    return reactions_exist(found, load.nodal)


def judged(seed):
    """Follow the path of a seed; return its outcome and its errors."""
    tables, start, add, until, wild = drawn(seed)
    try:
        model = validate(tables)
    except InputError:
        return Counter({"refused input": 1}), []
    try:
        plate = discretise(model)
    except InputError as error:
        if door.words_of_the_door(error):
            return Counter({"refused at the door": 1}), door.wrongly_refused(model, error)
        return Counter({"refused input": 1}), []
    steps = []
    try:
        found = path(model, start, add, until, progress=steps.append, events="all")
    except InputError as error:
        # The test includes points whose row is the mean over an element.
        floats = "rest anywhere" in str(error)
        moves = any(words in str(error) for words in MOVES)
        on_mesh = (
            "not at the contact points of this mesh" in str(error) and balanced(plate, at_start(plate, start)) is False
        )
        kind = "floats" if floats else "mechanism" if moves else "no start on the mesh" if on_mesh else "refused path"
        return Counter({kind: 1}), [] if floats or moves or on_mesh else [str(error)]
    except NotCertifiedError as error:
        wrong = not wild and alone(model, start)
        return Counter({"not certified": 1}), [f"not certified: {error}"] if wrong else []
    except NoEquilibriumError as error:
        wrong = balanced(plate, at_start(plate, start)) is True and "contradict" not in str(error)
        return Counter({"no start": 1}), [f"start refused: {error}"] if wrong else []
    outcomes = Counter({found.ending: 1, "events": len(found.events), "segments": len(found.segments)})
    many = len(steps) > _MOST_STEPS * (1 + len(found.stops))
    wrong = [f"{len(steps)} steps for {len(found.stops)} stops"] if many else []
    wrong += itertools.islice(faults(found, until, wild), _MOST_FAULTS)
    sampled = path(model, start, add, until, steps=_SAMPLES)
    outcomes += Counter({f"sampled {sampled.ending}": 1, "named events": len(sampled.support_events)})
    return outcomes, wrong + list(itertools.islice(faults_of_samples(sampled, found, wild), _MOST_FAULTS))


def alone(model, start):
    """Whether the load at t = 0 alone has a certified solution."""
    factors = {"G": float(start is not None), "Q": float(start == "both")}
    tables = model.model_dump(exclude_unset=True) | {"combination": [{"name": "start", "factors": factors}]}
    try:
        return bool(solve(validate(tables)))
    except (NotCertifiedError, NoEquilibriumError):
        return False


def faults(found, until, wild):
    start, add = found._loads
    plate = found.problem.discretisation
    times = [stop.t for stop in found.stops]
    if found.ending == "stopped" and not wild and not found.ends_with_the_mesh and not start_is_rounding(found):
        yield f"stopped at {found.end:.9g}, limit {found.limit:.9g}"
    if not found.certificate.passed:
        yield f"certificate {found.certificate}"
    # If a plate has moved by more than its size, rounding of its gaps may split one jump into two.
    fallen = wild and max(abs(w) for stop in found.stops for w in (stop.largest, stop.smallest)) > plate.mesh.size
    twice = any(a == c for a, c in zip(times[:-2], times[2:], strict=True))
    if any(a > b for a, b in itertools.pairwise(times)) or (twice and not fallen):
        yield f"t does not grow: {times}"
    if found.ending == "until" and found.end != until:
        yield f"ends at {found.end} instead of {until}"
    if until is not None and found.end > until:
        yield f"goes to {found.end}, beyond {until}"
    if found.ending == "no_equilibrium":
        if balanced(plate, start + found.end * (1 + _FAR) * add) is True and found.end > 0:
            yield f"ends at {found.end}, but reactions balance more"
    elif (
        until is None
        and found.ending == "no_more_events"
        and balanced(plate, start + 1e3 * (found.end or 1) * add) is False
    ):
        yield "goes on, but no reactions balance a large t"
    yield from wrong_stops(found)
    segments = found.segments
    picked = segments[:: max(1, len(segments) // _MOST_SEGMENTS)]
    for segment in (segment for segment in picked if not segment.jumps):
        a, b = segment.begin.t, segment.end.t
        yield from differences(found, a + 0.37 * (b - a), wild)
        yield from bent(found, segment, wild)
    if found.ending == "no_more_events":
        yield from differences(found, 7.0 * found.end, wild)
        if not wild:
            yield from differences(found, _FAR_OUT * found.end, wild, may_be_unsolved=True)
    yield from idle(found)
    yield from still(found)


def start_is_rounding(found):
    """Whether the load at t = 0 is below the rounding of the load at the end of a path."""
    start, add = found._loads
    return np.abs(start.nodal).max() <= np.finfo(float).eps * found.end * np.abs(add.nodal).max()


def faults_of_samples(sampled, found, wild):
    """Yield the differences of a sampled path from the exact path ``found``."""
    if sampled.ending != found.ending and not wild and "stopped" not in (found.ending, sampled.ending):
        yield f"sampled: ends with {sampled.ending} at {sampled.end:.9g}, not {found.ending} at {found.end:.9g}"
    if sampled.ending == "stopped" != found.ending and not wild and not sampled.ends_with_the_mesh:
        yield f"sampled: stopped at {sampled.end:.9g}, limit {sampled.limit:.9g}, not {found.ending}"
    if not sampled.certificate.passed:
        yield f"sampled: certificate {sampled.certificate}"
    if wild or "stopped" in (found.ending, sampled.ending):
        return
    yield from other_stops(sampled, found)
    yield from other_events(sampled, found)


def other_stops(sampled, found):
    """Yield the stops of a sampled path at which the exact path has other deflections or fractions in contact."""
    plate, (start, add) = found.problem.discretisation, found._loads
    stops = [stop for stop in sampled.stops if stop.t < found.limit * (1 - _FAR)]
    for stop in stops[:: max(1, len(stops) // _MOST_SEGMENTS)]:
        load = start + stop.t * add
        answer = direct_solution(found, load)
        if answer is None or not pinned(found, answer):
            continue
        at = found.at(stop.t)
        apart = max(abs(at.deflection.max() - stop.largest), abs(at.deflection.min() - stop.smallest))
        if apart > _SAME * scale_of(plate, load, at.deflection):
            yield f"sampled: at t = {stop.t:.9g} deflections differ by {apart / np.abs(at.deflection).max():.1e}"
        event = any(abs(one.t - stop.t) <= _NEAR * sampled.end for one in (*found.stops, *sampled.support_events))
        parts = [support.closed_part for support in at.supports]
        if not event and np.abs(parts - stop.parts).max() > _PART:
            yield f"sampled: at t = {stop.t:.9g} parts closed are {stop.parts}, not {np.array(parts)}"


def other_events(sampled, found):
    """Yield the events of point supports that only one of the two paths has."""
    names = [support.name for support in found.model.support if support.place == "at"]
    near = _NEAR * max(sampled.end, found.end if found.ending == "no_more_events" else 0.0)
    mine, others = (
        [one for one in path.support_events if one.support in names and near < one.t < found.limit * (1 - _FAR)]
        for path in (sampled, found)
    )
    for one in mine:
        if not any(same_event(one, other) and abs(one.t - other.t) <= near for other in others):
            yield f"sampled: {one.support} {one.change} at {one.at} at t = {one.t:.9g}, which does not happen"
    # After the end of the exact path, the sampled path has solved at powers of 2.
    times = np.append(np.linspace(0.0, sampled.end, _SAMPLES + 1), sampled.end * 2.0 ** np.arange(1, 200))
    for one in others:
        undone = any(
            other is not one
            and other.support == one.support
            and np.allclose(other.at, one.at)
            and np.searchsorted(times, other.t) == np.searchsorted(times, one.t)
            for other in found.support_events
            if other.support in names
        )
        if not undone and not any(same_event(one, other) and abs(one.t - other.t) <= near for other in mine):
            yield f"sampled: {one.support} {one.change} at {one.at} at t = {one.t:.9g}, which is not found"


def same_event(one, other):
    return (one.support, one.change) == (other.support, other.change) and np.allclose(one.at, other.at)


def differences(found, t, wild, may_be_unsolved=False):
    """Yield the differences of the path at t from the direct solution by another method."""
    plate, (start, add) = found.problem.discretisation, found._loads
    load = start + t * add
    try:
        at = found.at(t)
    except NotCertifiedError as error:
        if not wild and not may_be_unsolved:
            yield f"at t = {t:.9g}: {error}"
        return
    answer = direct_solution(found, load)
    if answer is None:
        if not may_be_unsolved:
            yield f"no direct solution at t = {t:.9g}"
        return
    w, direct = at.deflection, (answer.hi + answer.lo)[::3]
    scale = scale_of(plate, load, w, direct)
    if scale and np.abs(w - direct).max() > _SAME * scale and pinned(found, answer):
        yield f"t = {t:.9g}: deflections differ by {np.abs(w - direct).max() / scale:.1e}"


def bent(found, segment, wild):
    """Yield reactions that are not linear in t inside a segment."""
    if wild or found.problem.discretisation.shared:
        return
    t = segment.begin.t + 0.37 * (segment.end.t - segment.begin.t)
    try:
        shown = np.array(list(found.at(t).reactions.values()))
    except NotCertifiedError:
        return
    between = segment.begin.reactions + 0.37 * (segment.end.reactions - segment.begin.reactions)
    load = found._loads[0] + t * found._loads[1]
    forces = np.abs(load.nodal).reshape(-1, 3) / [1.0, found.mesh.size, found.mesh.size]
    size = max(forces.max(), *(np.abs(stop.reactions).max() for stop in (segment.begin, segment.end)))
    if np.abs(shown - between).max() > _BALANCED * size:
        yield f"t = {t:.9g}: reactions are {shown}, between those at the stops {between}"


def direct_solution(found, load):
    """Certified direct answer of a load, if possible by a method other than the path's; None if there is none."""
    problem = found.problem
    other = "active_set" if problem.method == "lemke" and len(problem.gaps) else "lemke"
    tried = answered(problem.by(other), load)
    return tried.answer if tried.passed else None


def scale_of(plate, load, *deflections):
    """Largest deflection, or 10⁻⁶ of F L²/(E h³/12) under the load F if that is larger."""
    forces, *couples = np.abs(load.nodal.reshape(-1, 3)).sum(axis=0)
    E, h, size = plate.model.young, plate.thickness.min(), plate.mesh.size
    least = 1e-6 * (forces + sum(couples) / size) * size**2 / (E * h**3 / 12)
    return max(least, *(np.abs(w).max() for w in deflections))


def wrong_stops(found):
    """Yield stops that differ from direct solutions, or at which reactions do not balance the load."""
    plate, (start, add) = found.problem.discretisation, found._loads
    motions = plate.rigid_motions / [1.0, plate.mesh.size, plate.mesh.size]
    resultants = [part.nodal @ motions for part in (start, add)]
    for resultant, part in zip(resultants, (start, add), strict=True):
        resultant[np.abs(resultant) <= 1e-12 * (np.abs(part.nodal) @ np.abs(motions)).max()] = 0.0
    jumps = {segment.begin.t for segment in found.segments if segment.jumps}
    stops = [stop for stop in found.stops if stop.t not in jumps]
    for stop in stops[:: -max(1, len(stops) // _MOST_SEGMENTS)]:
        wanted = resultants[0][0] + stop.t * resultants[1][0]
        size = np.abs(resultants[0]).max() + stop.t * np.abs(resultants[1]).max()
        if size and abs(stop.reactions.sum() - wanted) > _BALANCED * max(size, np.abs(stop.reactions).max()):
            yield f"at the stop t = {stop.t:.9g} supports bear {stop.reactions.sum():.6g} instead of {wanted:.6g}"
        load = start + stop.t * add
        if not load.nodal.any():
            continue
        answer = direct_solution(found, load)
        if answer is None:
            if stop.t < found.limit * (1 - _FAR):
                yield f"no direct solution at the stop t = {stop.t:.9g}"
            continue
        w = (answer.hi + answer.lo)[::3]
        apart = max(abs(w.max() - stop.largest), abs(w.min() - stop.smallest))
        if apart > _SAME * scale_of(plate, load, w) and pinned(found, answer):
            yield f"at the stop t = {stop.t:.9g} deflections differ by {apart / np.abs(w).max():.1e}"


def pinned(found, answer):
    """Whether pressed points and springs leave no rigid motion, so that deflections are unique."""
    freedom, contacts = found.problem.freedom, found.problem.discretisation.contacts
    pressed = contacts.two_sided | (answer.reaction > 1e-6 * np.abs(answer.reaction).max(initial=0.0))
    moves = freedom.moves[pressed & ~contacts.two_sided]
    return freedom.count == 0 or (len(moves) >= freedom.count and np.linalg.svd(moves)[1][-1] > 1e-6)


def idle(found):
    """Yield events without effect: the points that switch have neither a reaction before or after, nor a gap."""
    pairs = list(itertools.pairwise(found.segments))
    for before, after in pairs[:: max(1, len(pairs) // _MOST_SEGMENTS)]:
        if before.jumps or after.jumps or not len(after.begin.points):
            continue
        seen = 0.0
        for segment in (before, after):
            a, b = segment.begin.t, segment.end.t
            on = solved_on(found, 0.5 * (a + b), segment.pieces)
            if on is None:
                return
            points = after.begin.points
            force, length = np.abs(on.reaction).max(initial=0.0) or 1.0, np.abs(on.hi[::3]).max() or 1.0
            seen = max(
                seen,
                np.abs(on.reaction[points]).max(initial=0.0) / force,
                np.abs(on.gap[points]).max(initial=0.0) / length,
            )
        if seen < 1e-13:
            yield f"event at {after.begin.t:.9g} is none: {seen:.1e}"


def still(found):
    """Yield jumps at which neither a deflection nor the force of a point changes."""
    for k, (before, after) in enumerate(itertools.pairwise(found.stops)):
        if before.t != after.t:
            continue
        moved = [
            np.abs(new - old).max() > _STAYS * max(np.abs(new).max(), np.abs(old).max())
            for old, new in (
                (np.array([before.largest, before.smallest]), np.array([after.largest, after.smallest])),
                (before.reactions, after.reactions),
            )
        ]
        around = [found.segments[at].pieces for at in (k - 1, k + 1) if 0 <= at < len(found.segments)]
        at_points = [
            one.reaction for one in (solved_on(found, before.t, pieces) for pieces in around) if one is not None
        ]
        if len(at_points) == 2:
            old, new = at_points
            moved.append(np.abs(new - old).max() > _STAYS * max(np.abs(new).max(), np.abs(old).max()))
        if not any(moved):
            yield f"at t = {before.t:.9g} the plate is said to move, but stays"


def solved_on(found, t, pieces):
    load = found._loads[0] + t * found._loads[1]
    answer = found.problem.core.solve_on(load.nodal, found.problem.discretisation.held.values, pieces)
    return answer if answer.status == "solved" else None


def show(seed):
    tables, *question = drawn(seed)
    print(json.dumps(tables, indent=1), *question)


if __name__ == "__main__":
    sys.exit(campaign.main(__doc__, judged, show, count=10_000, check=60))
