"""Load paths of random small plates: each is followed to its end, and is what direct solutions say at other points.

The models are those of tests/fuzz/random_models.py, with loads of two cases. Of each path it is asked:

- that it is not given up, and its start not refused, unless no reactions balance that (a linear program of its own);
- that it ends where reactions cease to balance the load, or goes on for ever as the direct solution says far out;
- that inside of every segment the direct solution, by Lemke's algorithm or the active set in turn, is certified and has
  the same deflections, where these are unique;
- that at every event some point that opens or closes pressed before or presses after, or is apart.

    python benchmarks/random_paths.py [--count 10000] [--first 0] [--processes 2]
    python benchmarks/random_paths.py --show SEED
    python benchmarks/random_paths.py --check        a few, to see that the script works
"""

from __future__ import annotations

import argparse
import itertools
import json
import multiprocessing
import os
import sys
import time
from collections import Counter
from pathlib import Path
from random import Random

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fuzz"))
sys.path.insert(0, str(Path(__file__).parent))
import random_models
from random_plates import reactions_exist

from signorini import InputError, NoEquilibriumError, NotCertifiedError, path, solve, validate
from signorini.certificate import certify
from signorini.discretise import discretise

_FAR = 1e-4
"""Of the limit, how far from it equilibrium must exist, or not."""
_SAME = 1e-7
"""Largest difference of deflections, over the largest."""
_MOST_FAULTS = 3
_MOST_SEGMENTS = 12
"""Segments of a path that are compared with direct solutions."""


def drawn(seed):
    """A model with a case that is there and one that grows, and how far."""
    rng = Random(seed)
    tables = random_models.model(rng)
    loads = tables["load"]
    if len(loads) == 1:
        loads.append(dict(loads[0]))
    for i, load in enumerate(loads):
        load["case"] = "Q" if i == len(loads) - 1 else "G"
    if unlike(loads[-1]) == unlike(loads[0]) or rng.random() < 0.4:
        shift(rng, tables)
    tables["combination"] = [
        {"name": "less", "factors": {"Q": -1.0}},
        {"name": "both", "factors": {"G": 1.0, "Q": 1.0}},
    ]
    tables["solver"] = {"method": rng.choice(["auto", "auto", "lemke", "active_set"])}
    start = rng.choice(["G", "G", "G", None, "both"])
    return tables, start, rng.choice(["Q", "Q", "less", "both"]), rng.choice([None, None, 3.0])


def unlike(load):
    return {key: value for key, value in load.items() if key != "case"}


def shift(rng, tables):
    """Makes the load that grows a force or couple at one point."""
    last = tables["load"][-1]
    size = random_models._extent(tables["plate"])
    at = random_models.point(rng, tables["plate"])
    young, thickness = tables["material"]["E"], float(str(tables["plate"]["thickness"]).partition("*")[0])
    force = 1e-4 * young * thickness**3 / size
    last.clear()
    last |= {"case": "Q", "at": at} | ({"force": force} if rng.random() < 0.7 else {"moment": [force * size, 0.0]})


def balanced(found, load):
    return reactions_exist(found, load.nodal)


def judged(seed):
    """What has become of one path, and what is wrong with it."""
    tables, start, add, until = drawn(seed)
    try:
        model = validate(tables)
        plate = discretise(model)
    except InputError:
        return Counter({"refused input": 1}), []
    try:
        found = path(model, start, add, until)
    except InputError as error:
        floats, moves = "rest anywhere" in str(error), "motion" in str(error)
        kind = "floats" if floats else "mechanism" if moves else "refused path"
        return Counter({kind: 1}), [] if floats or moves else [str(error)]
    except NotCertifiedError as error:
        return Counter({"not certified": 1}), [f"not certified: {error}"] if alone(model, start) else []
    except NoEquilibriumError as error:
        load = 0.0 * plate.cases["G"] if start is None else plate.cases["G"] + (start == "both") * plate.cases["Q"]
        wrong = balanced(plate, load) is True and "contradict" not in str(error)
        return Counter({"no start": 1}), [f"start refused: {error}"] if wrong else []
    outcomes = Counter({found.ending: 1, "events": len(found.events), "segments": len(found.segments)})
    return outcomes, list(itertools.islice(faults(found, until), _MOST_FAULTS))


def alone(model, start):
    """Whether the load at the beginning has a certified solution by itself."""
    factors = {"G": float(start is not None), "Q": float(start == "both")}
    tables = model.model_dump(exclude_unset=True) | {"combination": [{"name": "start", "factors": factors}]}
    try:
        return bool(solve(validate(tables)))
    except (NotCertifiedError, NoEquilibriumError):
        return False


def faults(found, until):
    start, add = found._loads
    plate = found.problem.discretisation
    times = [stop.t for stop in found.stops]
    if found.ending == "stopped":
        yield f"stopped at {found.end:.9g}, limit {found.limit:.9g}"
    if not found.certificate.passed:
        yield f"certificate {found.certificate}"
    if any(a > b for a, b in itertools.pairwise(times)) or any(
        a == c for a, c in zip(times[:-2], times[2:], strict=True)
    ):
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
        yield "goes on, but nothing balances a large t"
    segments = found.segments
    picked = segments[:: max(1, len(segments) // _MOST_SEGMENTS)]
    for segment in (segment for segment in picked if not segment.jumps):
        a, b = segment.begin.t, segment.end.t
        yield from differences(found, a + 0.37 * (b - a))
    if found.ending == "no_more_events":
        yield from differences(found, 7.0 * found.end)
    yield from idle(found)


def differences(found, t):
    """What the path shows at one t against the direct solution by another method."""
    plate, (start, add) = found.problem.discretisation, found._loads
    load = start + t * add
    try:
        at = found.at(t)
    except NotCertifiedError as error:
        yield f"at t = {t:.9g}: {error}"
        return
    other = found.problem.by("active_set" if found.problem.method == "lemke" and len(found.problem.gaps) else "lemke")
    answer = other.solve(load)
    judged = certify(plate, load, answer.hi, answer.lo, answer.reaction)
    if not judged.passed:
        answer = found.problem.solve(load)
        judged = certify(plate, load, answer.hi, answer.lo, answer.reaction)
    if not judged.passed:
        yield f"direct solution at t = {t:.9g}: {judged}"
        return
    w, direct = at.deflection, (answer.hi + answer.lo)[::3]
    forces, *couples = np.abs(load.nodal.reshape(-1, 3)).sum(axis=0)
    E, h, size = plate.model.material.E, plate.thickness.min(), plate.mesh.size
    least = 1e-6 * (forces + sum(couples) / size) * size**2 / (E * h**3 / 12)
    scale = max(np.abs(w).max(), np.abs(direct).max(), least)
    if scale and np.abs(w - direct).max() > _SAME * scale and pinned(found, answer):
        yield f"t = {t:.9g}: deflections differ by {np.abs(w - direct).max() / scale:.1e}"


def pinned(found, answer):
    """Whether pressed points and stiffness leave no rigid motion, so that deflections are unique."""
    freedom, contacts = found.problem.freedom, found.problem.discretisation.contacts
    pressed = contacts.two_sided | (answer.reaction > 1e-6 * np.abs(answer.reaction).max(initial=0.0))
    moves = freedom.moves[pressed & ~contacts.two_sided]
    return freedom.count == 0 or (len(moves) >= freedom.count and np.linalg.svd(moves)[1][-1] > 1e-6)


def idle(found):
    """Events at which nothing happens: all points that switch neither press nor part before or after."""
    pairs = list(itertools.pairwise(found.segments))
    for before, after in pairs[:: max(1, len(pairs) // _MOST_SEGMENTS)]:
        if before.jumps or after.jumps:
            continue
        seen = 0.0
        for segment in (before, after):
            a, b = segment.begin.t, segment.end.t
            on = solved_on(found, 0.5 * (a + b), segment.closed)
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


def solved_on(found, t, closed):
    load = found._loads[0] + t * found._loads[1]
    answer = found.problem.core.solve_on(load.nodal, found.problem.discretisation.held.values, closed)
    return answer if answer.status == "solved" else None


def _one(seed):
    try:
        outcomes, wrong = judged(seed)
        return seed, outcomes, [f"{drawn(seed)[0]['solver']['method']}: {message}" for message in wrong]
    except Exception as error:  # What a random path raises is what is looked for.
        return seed, Counter({"fault": 1}), [f"{type(error).__name__}: {error}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    parser.add_argument("--show", type=int)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    if given.show is not None:
        tables, *question = drawn(given.show)
        print(json.dumps(tables, indent=1), *question)
        print(*judged(given.show), sep="\n")
        return
    seeds = range(given.first, given.first + (60 if given.check else given.count))
    begun, outcomes, failures = time.perf_counter(), Counter(), 0
    with multiprocessing.Pool(given.processes) as pool:
        for seed, found, wrong in pool.imap_unordered(_one, seeds, chunksize=10):
            outcomes += found
            failures += bool(wrong)
            for message in wrong:
                print(f"seed {seed}: {message}", flush=True)
    spent = time.perf_counter() - begun
    print(f"{len(seeds)} paths in {spent:.0f} s: {dict(outcomes)}, {failures} with failures")
    sys.exit(0 if failures == 0 else 1)


if __name__ == "__main__":
    main()
