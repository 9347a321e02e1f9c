"""Time of contact relative to a linear solve on the same mesh.

Four plates on one-sided supports are compared with the same plates on two-sided supports, a linear problem:

- slab A on soil; in the linear problem the springs are part of the matrix;
- the same slab on 100 rigid points, which are held dofs in the linear problem;
- the same slab on 36 rigid footprints with a tenth of the slab's sides. The linear problem has two-sided points in the
  centers of the footprints, since two-sided footprints are contact rows too;
- the same slab on a second slab on soil, with an elastic layer between the slabs.

The runs alternate in one process. Times are medians, and ratios are ratios of medians.

Then six plates on rigid areas are compared with plates on soil in the same areas. The target is three times the time
on soil, or the time of three factorizations if that is more.

"core" is from the discretised model to displacements and reactions: equilibrium check of the supports, ordering,
assembly, factorization, condensation, contact, refinement. "whole" is from the model to the certified result.

    python benchmarks/contact_price.py [--elements 160 400] [--repeat 5]
    python benchmarks/contact_price.py --check      answers only: both agree where all points stay closed, and
                                                    the active set and Lemke's algorithm agree on rigid areas
"""

import argparse
import statistics
import sys
import time
from collections.abc import Callable

import numpy as np
from tensionless import slab_a

from signorini import Model, solve
from signorini.contact.problem import contact_problem, unfactored
from signorini.discretise import discretise

LINEAR, CONTACT = "both", "down"
TARGETS = {"soil": 1.5, "100 points": 1.2, "36 footprints": 1.5, "two slabs": 1.5}


def on_soil(elements: int, resists: str) -> Model:
    return slab_a(elements, resists=resists)


def on_points(elements: int, resists: str, count: int = 10, **footprint: object) -> Model:
    stations = (np.arange(count) + 0.5) * 10 / count
    support = {"at": [(float(x), float(y)) for y in stations for x in stations], "resists": resists, **footprint}
    return Model.model_validate({**slab_a(elements).model_dump(exclude_unset=True), "support": [support]})


def on_footprints(elements: int, resists: str) -> Model:
    return on_points(elements, resists, 6, **({"patch": [1.0, 1.0]} if resists == CONTACT else {}))


def on_a_slab(elements: int, resists: str) -> Model:
    given = slab_a(elements, resists=resists).model_dump(exclude_unset=True)
    plate, (soil,) = given.pop("plate"), given.pop("support")
    layer = {"between": ["upper", "lower"], "area": "all", "stiffness": 1e9, "resists": resists}
    tables = {"plates": {"upper": plate, "lower": plate}, "support": [{"plate": "lower", **soil}, layer]}
    return Model.model_validate({**given, **tables, "load": [{"plate": "upper", **load} for load in given["load"]]})


ALIKE: dict[str, Callable[[int, str], Model]] = {"soil": on_soil, "100 points": on_points, "two slabs": on_a_slab}
"""Models for which the solutions on one-sided and on two-sided supports are equal if every point stays closed."""

PLATES = ALIKE | {"36 footprints": on_footprints}


SIZE, SOIL = [10, 10], 3e8
"""Sides of the plates [m]; stiffness [Pa/m] of the soil that replaces rigid areas."""
RIGID_TARGET, FACTORIZATIONS = 3.0, 3.0
CORNER, HALF = {"rectangle": [0.5, 0.5, 1.5, 1.5]}, {"rectangle": [6, 0, 10, 10]}
CURLED = {"curvature": [-3e-4, -3e-4, 0]}
Tables = dict[str, object]


def one_plate(elements: int, beds: list[Tables], loads: list[Tables], shape: str = "rectangle") -> Tables:
    plate = {"shape": "disc", "radius": 5} if shape == "disc" else {"shape": shape, "size": SIZE}
    divisions = [elements // 4, 2 * elements] if shape == "disc" else [elements, elements]
    supports = [{"name": f"bed {i}", "resists": "down"} | bed for i, bed in enumerate(beds)]
    tables = {"plate": plate | {"thickness": 0.3}, "support": supports, "load": loads, "mesh": {"divisions": divisions}}
    return {"material": {"E": 30e9, "nu": 0.2}} | tables


def two_plates(elements: int, bed: Tables) -> Tables:
    plates = {name: {"shape": "rectangle", "size": SIZE, "thickness": h} for name, h in (("top", 0.3), ("base", 0.4))}
    loads = [{"pressure": 5e3}, {"pressure": 300e3, "area": CORNER}, {"pressure": -6e3, "area": HALF}]
    return {
        "material": {"E": 30e9, "nu": 0.2},
        "plates": plates,
        "contact": [{"between": ["top", "base"], **bed}],
        "support": [{"plate": "base", "area": "all", "resists": "down", "stiffness": 30e6}],
        "load": [{"plate": "top"} | load for load in loads],
        "mesh": {"divisions": [elements, elements]},
    }


def rigid_example(name: str, elements: int, stiffness: float | None) -> Model:
    """Make a plate on rigid areas; with a ``stiffness`` [Pa/m], on soil in the same areas."""
    elastic = {} if stiffness is None else {"stiffness": stiffness}
    bed: Tables = {"area": "all"} | elastic
    spot = [{"pressure": 2e3}, {"pressure": 500e3, "area": CORNER}]
    match name:
        case "slab":
            tables = one_plate(elements, [bed], spot)
        case "disc":
            circles = [(500e3, [2, 1], 0.7), (-40e3, [-2.5, -2.5], 1.0)]
            loads = [{"pressure": p, "area": {"circle": {"center": at, "radius": r}}} for p, at, r in circles]
            tables = one_plate(elements, [bed], [{"pressure": 2e3}, *loads], "disc")
        case "curled plate":
            tables = one_plate(elements, [bed], [{"pressure": 7.5e3}, CURLED])
        case "two pads":
            pads = [{"area": {"rectangle": [x, 0, x + 3, 10]}} | elastic for x in (0, 7)]
            tables = one_plate(elements, pads, [{"pressure": 10e3}])
        case "half lifted":
            tables = one_plate(elements, [bed], [{"pressure": 7.5e3}, {"pressure": -11e3, "area": HALF}])
        case _:
            tables = two_plates(elements, bed)
    return Model.model_validate(tables)


RIGID = ("slab", "disc", "curled plate", "two pads", "half lifted", "two plates")


def core_solve(plate):
    begun = time.perf_counter()
    answer = contact_problem(plate).solve(plate.cases["load"])
    assert answer.status == "solved"
    return time.perf_counter() - begun, answer


def whole_solve(model):
    begun = time.perf_counter()
    result = solve(model)["all"]
    assert result.certificate.passed
    return time.perf_counter() - begun, result


def compare(name, elements, repeat):
    models = {way: PLATES[name](elements, way) for way in (LINEAR, CONTACT)}
    plates = {way: discretise(model) for way, model in models.items()}
    core = {way: [] for way in models}
    whole = {way: [] for way in models}
    for _ in range(repeat):
        for way in models:
            spent, answer = core_solve(plates[way])
            core[way].append(spent)
            whole[way].append(whole_solve(models[way])[0])
    # `answer` is that of the last run, which is on one-sided supports.
    points, opened = len(answer.closed), int((~answer.closed).sum())
    steps = f"{answer.iterations} Newton steps, {answer.pivots} pivots"
    print(f"{name}, {elements} × {elements}, {plates[CONTACT].dof_count} dofs, {points} points, {opened} open, {steps}")
    for part, seconds in (("core", core), ("whole", whole)):
        linear, contact = (statistics.median(seconds[way]) for way in (LINEAR, CONTACT))
        print(
            f"  {part:5}  linear {linear:.3f} s, contact {contact:.3f} s: price {contact / linear:.2f} "
            f"(target {TARGETS[name]})",
            flush=True,
        )


def compare_rigid(name, elements, repeat):
    """Print the time of a plate on rigid areas, relative to soil and to one factorization."""
    plates = [discretise(rigid_example(name, elements, stiffness)) for stiffness in (None, SOIL)]
    rigid, soil = (statistics.median(core_solve(plate)[0] for _ in range(repeat)) for plate in plates)
    problem = contact_problem(plates[0])
    factorization, answer = problem.seconds["factor"], problem.solve(plates[0].cases["load"])
    steps = f"{answer.iterations} Newton steps, {answer.factorizations} factorizations, {answer.gradients} solves"
    print(
        f"rigid {name}, {elements} × {elements}, {len(answer.closed)} points, {steps}\n"
        f"  core   soil {soil:.3f} s, rigid {rigid:.3f} s: price {rigid / soil:.2f} (target {RIGID_TARGET}), "
        f"{rigid / factorization:.1f} factorizations (or {FACTORIZATIONS})",
        flush=True,
    )


def check_rigid(elements=12):
    """Compare the reactions that the active set and Lemke's algorithm give on rigid areas."""
    passed = True
    for name in RIGID:
        plate = discretise(rigid_example(name, elements, None))
        active_set, lemke = (unfactored(plate).by(method) for method in ("active_set", "lemke"))
        one, other = (problem.solve(plate.cases["load"]).reaction for problem in (active_set, lemke))
        error = np.abs(one - other).max() / np.abs(other).max()
        print(f"rigid {name}: largest difference of reactions by two methods, relative: {error:.1e}")
        passed &= error < 1e-9
    return passed


def check():
    """Compare one-sided with two-sided supports under a uniform load, where all points stay closed."""
    passed = True
    for name, plate in ALIKE.items():
        found = []
        for way in (LINEAR, CONTACT):
            tables = plate(20, way).model_dump(exclude_unset=True)
            tables["load"] = [{"pressure": 2e3} | ({"plate": "upper"} if "plates" in tables else {})]
            found.append(whole_solve(Model.model_validate(tables))[1])
        linear, contact = found
        closed = contact.supports[0].open_count == 0
        error = np.abs(linear.deflection - contact.deflection).max() / np.abs(linear.deflection).max()
        print(f"{name}: all closed: {closed}, largest difference, relative: {error:.1e}")
        passed &= closed and error < 1e-9
    return passed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, nargs="+", default=[160, 400])
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    if given.check:
        sys.exit(0 if check() & check_rigid() else 1)
    for elements in given.elements:
        for name in PLATES:
            compare(name, elements, given.repeat)
        for name in RIGID:
            compare_rigid(name, elements, given.repeat)


if __name__ == "__main__":
    main()
