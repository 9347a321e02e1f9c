"""Time of contact over that of a linear solve of the same mesh.

Four plates on one-sided supports, against the same supports two-sided, which is a linear problem:

- slab A on soil; two-sided springs are part of the matrix;
- the same slab on 100 rigid points; two-sided points are held dofs;
- on 36 rigid footprints of a tenth of its sides, against two-sided points in their middles, since two-sided footprints
  are contact rows too;
- on a second slab on the soil, with an elastic layer between them.

The runs alternate in one process; figures are medians, and ratios those of the medians.

"core" is from the discretised model to displacements and reactions: equilibrium check of the supports, ordering,
assembly, factorization, condensation, contact, refinement. "whole" is from the model to the certified result.

    python benchmarks/contact_price.py [--elements 160 400] [--repeat 5]
    python benchmarks/contact_price.py --check      answers only: both agree where all points stay closed
"""

import argparse
import statistics
import sys
import time
from collections.abc import Callable

import numpy as np
from tensionless import slab_a

from signorini import Model, solve
from signorini.contact.problem import contact_problem
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
"""Those that are one problem while every point stays closed."""

PLATES = ALIKE | {"36 footprints": on_footprints}


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
    # The last answer is that of the one-sided supports.
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


def check():
    """Compare under a uniform load, where all points stay closed and one-sided supports equal two-sided ones."""
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
    sys.exit(0 if passed else 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, nargs="+", default=[160, 400])
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    if given.check:
        check()
    for elements in given.elements:
        for name in PLATES:
            compare(name, elements, given.repeat)


if __name__ == "__main__":
    main()
