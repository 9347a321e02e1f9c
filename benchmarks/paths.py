"""Time of load paths relative to single solves, in CPU seconds on one thread, and their number of solves.

- A strip of 400 x 1 elements on tensionless soil under its weight and a line load that grows to t = 60, relative to
  one solve of the same model, both with half-widths (target: at most 20). Likewise the base plate of examples/, whose
  anchors begin to pull, also on 96 x 64 elements.
- Slab A, 10 m x 10 m under 2 kPa on tensionless soil, 160 x 160 elements, without half-widths. Its path is relative
  to one linear solve: meshing, factoring and solving on two-sided soil (target: at most 60). A downward force of t ×
  500 kN near a corner never tips the slab, since soil is under the resultant. As an upward force it tips the slab
  about the far corner at t = 2/9. Both paths are followed.
- A raft on 2304 points that is overturned; the path follows every contact point: number of events per second.
- A cover bolted on a gasket one element wide: the pressure in bar at which half of the gasket is open, by contact area
  and by number of points, also on a mesh of half the element size.

    python benchmarks/paths.py [--divisions 160]
    python benchmarks/paths.py --check        small meshes; fails if a path is wrong, not if it is slow
"""

from __future__ import annotations

import argparse
import os
import sys
import time
import tomllib
from pathlib import Path

os.environ.setdefault("RAYON_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from signorini import Model, estimate, path, solve
from signorini.analysis.sampler import Sampler
from signorini.contact.problem import contact_problem

_SOIL = {"name": "soil", "area": "all", "stiffness": 30e6}
_CONCRETE = {"E": 30e9, "nu": 0.2}
_EXAMPLES = Path(__file__).parents[1] / "examples"
_PART = 1e-4
"""Tolerance for the fraction in contact at an event, which should be a multiple of a quarter."""


def strip(along, **more):
    """Model of a strip on soil that a growing line load lifts off."""
    return Model(
        material=_CONCRETE,
        plate={"shape": "rectangle", "size": [0.1 * along, 0.1], "thickness": 0.3},
        mesh={"divisions": [along, 1]},
        support=[{**_SOIL, "resists": "down"}],
        load=[
            {"case": "G", "pressure": 7.5e3},
            {"case": "Q", "line_load": 20e3, "line": [[0.05 * along, 0], [0.05 * along, 0.1]]},
        ],
        **more,
    )


def base_plate(divisions, factors):
    """Model of the base plate of the examples, with one combination."""
    tables = tomllib.loads((_EXAMPLES / "base_plate.toml").read_text("utf-8"))
    tables |= {"mesh": {"divisions": divisions}, "combination": [{"name": "one", "factors": factors}]}
    return Model(**tables)


def slab(support, divisions, pressure=500e3):
    """Model of slab A on the given support."""
    return Model(
        material=_CONCRETE,
        plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        mesh={"divisions": [divisions, divisions]},
        support=[support],
        load=[
            {"case": "G", "pressure": 2e3},
            {"case": "Q", "pressure": pressure, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}},
        ],
    )


def gasket(size):
    """Model of a quarter of the examples' cover on a flat gasket 30 mm wide, under 1 bar, with bolts at 180 Kgm."""
    tables = tomllib.loads((_EXAMPLES / "circular_cover.toml").read_text("utf-8"))
    symmetry, bolts = tables["support"][0], tables["load"][0]
    ring = {"annulus": {"inner": 310.0, "outer": 340.0}}
    tables |= {
        "mesh": {"size": size, "error": False},
        "support": [symmetry, {"name": "gasket", "area": ring, "resists": "down", "stiffness": 2e4 / 30}],
        "load": [
            bolts | {"force": 180 * bolts["force"]},
            {"case": "bar", "pressure": -0.1, "area": {"circle": {"radius": 340.0}}},
        ],
    }
    del tables["combination"]
    return Model(**tables)


def seconds_of(action):
    """Run an action; return its CPU seconds, its result and its number of solves."""
    count, plain = [0], Sampler.state

    def counted(self, *given, **more):
        count[0] += 1
        return plain(self, *given, **more)

    Sampler.state = counted
    begun = time.process_time()
    try:
        answer = action()
    finally:
        Sampler.state = plain
    return time.process_time() - begun, answer, count[0]


def faults(name, found, ending, limit=np.inf):
    """Yield the errors of a path: its end, the balance at its stops, the fractions in contact at its events."""
    if (found.ending, found.limit) != (ending, limit) and not np.isclose(found.limit, limit, rtol=1e-9):
        yield f"{name}: ends with {found.ending}, limit {found.limit}, not {ending}, limit {limit}"
    if not found.certificate.passed:
        yield f"{name}: {found.certificate}"
    start, add = (load.nodal[::3].sum() for load in found._loads)
    for stop in found.stops:
        wanted = start + stop.t * add
        if abs(stop.reactions.sum() - wanted) > 1e-8 * max(abs(wanted), abs(start)):
            yield f"{name}: at t = {stop.t:.6g} supports bear {stop.reactions.sum():.9g}, not {wanted:.9g}"
    names = [support.name for support in found.model.support]
    for event in found.support_events:
        part = found.stops[event.row].parts[names.index(event.support)]
        if event.change == "part closed" and abs(part - event.closed) > _PART:
            yield f"{name}: at t = {event.t:.6g} {part:.6g} of {event.support} are closed, not {event.closed}"


def told(name, found):
    return (
        f"{name}: {len(found.support_events)} named events, {len(found.stops)} stops to t = {found.end:.6g} "
        f"({found.ending})"
    )


def with_half_widths(name, model, single, *given):
    """Print the time of a path with half-widths, relative to one solve with half-widths; yield errors of the path."""
    alone, _, _ = seconds_of(lambda: estimate(solve(single)))
    spent, found, own = seconds_of(lambda: path(model, *given))
    more, compared, others = seconds_of(lambda: estimate(found))
    print(
        f"{told(name, found)}; {own} solves in {spent:.2f} s, {others} on meshes of {compared.elements[1:]} elements "
        f"for half-widths in {more:.2f} s; one solve with half-widths {alone:.2f} s; ratio {(spent + more) / alone:.1f}"
    )
    yield from faults(name, found, found.ending)


def slab_a(divisions, pressure, ending, limit):
    """Print the time of a path of slab A, relative to one linear solve."""

    def linear():
        problem = contact_problem(slab(_SOIL, divisions))
        return problem.solve(problem.discretisation.cases["G"])

    alone, _, _ = seconds_of(linear)
    model = slab({**_SOIL, "resists": "down"}, divisions, pressure)
    spent, found, own = seconds_of(lambda: path(model, "G", "Q"))
    name = f"slab A, {divisions} x {divisions}, {pressure / 1e3:g} kN"
    print(
        f"{told(name, found)}; {own} solves in {spent:.2f} s; a linear solve {alone:.2f} s; "
        f"ratio {spent / alone:.1f}, a solve {spent / own / alone:.2f}"
    )
    yield from faults(name, found, ending, limit)


def every_point(divisions):
    """Follow an overturned raft from event to event; print events per second."""
    model = slab({**_SOIL, "resists": "down"}, divisions, -500e3)
    spent, found, _ = seconds_of(lambda: path(model, "G", "Q", events="all"))
    points, name = len(found.problem.gaps), f"every point of a raft, {divisions} x {divisions}"
    print(
        f"{told(name, found)}; {points} points, {len(found.events)} events in {spent:.2f} s; "
        f"{len(found.events) / spent:.0f} events a second"
    )
    if found.ending != "no_equilibrium":
        yield f"{name}: ends with {found.ending} at {found.end}"


def fewer_closed(stop):
    return stop.number("gasket.closed") <= stop.number("gasket.open")


def half_open(sizes):
    """Print the pressure at which half of a gasket is open: half of the area, and half of the points."""
    for size in sizes:
        found = path(gasket(size), "bolts", "bar", when=["gasket.closed_part = 0.5"])
        (half,) = found.thresholds
        counted = next((stop.t for stop in found.stops if fewer_closed(stop)), np.nan)
        by_points = path(gasket(size), "bolts", "bar", at=np.linspace(0.0, 2 * counted, 401).tolist())
        counted = next(stop.t for stop in by_points.stops if fewer_closed(stop))
        name = f"gasket, elements of {size:g} mm"
        print(f"{told(name, found)}; half open at {half.t:.4g} bar, by its points at {counted:.4g} bar")
        yield from faults(name, found, "no_equilibrium", found.limit)
        area = found.at(half.t).supports[1].contact_area
        whole = np.pi / 4 * (340.0**2 - 310.0**2)
        if abs(area / whole - 0.5) > 10 * _PART:
            yield f"{name}: at {half.t} bar {area / whole} of it are closed"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--divisions", type=int, default=160)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    small = [24, 16]
    seconds_of(lambda: estimate(solve(base_plate(small, {"column": 1.0}))))  # a first run, which imports modules
    along, divisions = (40, 20) if given.check else (400, given.divisions)
    grown = strip(along, combination=[{"name": "one", "factors": {"G": 1.0, "Q": 60.0}}])
    wrong = [*with_half_widths(f"strip, {along} x 1", strip(along), grown, "G", "Q", 60.0)]
    for mesh in [small] if given.check else [small, [96, 64]]:
        wind, both = base_plate(mesh, {"wind": -1.0}), base_plate(mesh, {"column": 1.0, "wind": -1.0})
        wrong += with_half_widths(f"base plate, {mesh[0]} x {mesh[1]}", wind, both, "column", "one")
    wrong += slab_a(divisions, 500e3, "no_more_events", np.inf)
    wrong += slab_a(divisions, -500e3, "no_equilibrium", 2 / 9)
    wrong += every_point(8 if given.check else 16)
    wrong += half_open([30.0] if given.check else [30.0, 15.0, 7.5])
    print(*wrong, sep="\n")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
