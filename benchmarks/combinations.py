"""Time of ten thousand load combinations of slab B, relative to the first: 12 load cases, reactions and 20 probes.

Times are those of whole processes, from the interpreter's start to results on disk. Runs of all combinations and of the
first alternate. Then some random combinations are solved by themselves and compared with their rows.

    python benchmarks/combinations.py [--elements 80] [--combinations 10000] [--side 4] [--repeat 3] [--pick 200]
    python benchmarks/combinations.py --pynite     ten combinations at 20×20 against PyNite (pip install PyNiteFEA)
    python benchmarks/combinations.py --soil       200 combinations of slab A, on soil, against as many separate solves
    python benchmarks/combinations.py --check      correctness only, on coarse meshes
"""

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

SIDE = 4
"""Number of support points along a side of slab B."""

CASES = 12
SPRING = 1e11
"""Stiffness of the springs that replace rigid points in PyNite."""


def points(side):
    """Positions of side × side support points, which are nodes of a mesh of 80×80 elements."""
    stations = (np.linspace(0.5, 9.5, side) * 8).round() / 8
    return [[float(x), float(y)] for y in stations for x in stations]


def tables(elements, combinations, side=SIDE):
    """Input tables of slab B with its weight, ten forces and wind uplift, in combinations with random factors."""
    random = np.random.default_rng(5)
    at = random.uniform(0.25, 9.75, (CASES - 2, 2)).round(2).tolist()
    forces = [{"case": f"Q{i}", "force": 100e3, "at": point} for i, point in enumerate(at)]
    loads = [{"case": "G", "pressure": 2e3}, *forces, {"case": "W", "pressure": -1e3}]
    factors = random.choice([0.0, 0.7, 1.0, 1.5], (combinations, CASES))
    factors[:, 0] = random.choice([1.0, 1.35], combinations)
    factors[:, -1] = random.uniform(-1.5, 1.5, combinations)
    rows = {f"c{i}": row for i, row in enumerate(factors.tolist())}
    return {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        "mesh": {"divisions": [elements, elements]},
        "support": [{"name": "points", "at": points(side), "resists": "down"}],
        "load": loads,
        "combination": [{"generate": "table", "columns": [load["case"] for load in loads], "rows": rows}],
        "probe": [{"at": random.uniform(0, 10, (20, 2)).tolist()}],
        "output": {"combinations": "table", "fields": "none", "envelope": []},
    }


def on_soil(elements, combinations):
    """Input tables of slab A with its weight, ten loaded patches, one of them at the corner, and wind uplift."""
    data = tables(elements, combinations)
    at = [[1.0, 1.0], *(np.clip(load["at"], 0.5, 9.5).tolist() for load in data["load"][2:-1])]
    patches = [{"area": {"rectangle": [x - 0.5, y - 0.5, x + 0.5, y + 0.5]}} for x, y in at]
    for load, patch in zip(data["load"][1:-1], patches, strict=True):
        del load["force"], load["at"]
        load |= patch | {"pressure": 200e3}
    data["load"][1]["pressure"] = 500e3
    data["support"] = [{"name": "soil", "area": "all", "resists": "down", "stiffness": 30e6}]
    return data


def separately(data, name):
    """Model whose only combination is the row of this name in the table."""
    (table,) = data["combination"]
    factors = dict(zip(table["columns"], table["rows"][name], strict=True))
    return data | {"combination": [{"name": name, "factors": factors}], "output": {}}


def soil(elements, combinations, pick):
    """Compare one solve of all combinations with separate solves of ``pick`` combinations: times and results.

    All solves are in one process, after a first solve, so that the start of the interpreter is not measured.
    """
    import pyarrow.parquet as pq

    from signorini import Model, solve

    data = on_soil(elements, combinations)
    names = list(data["combination"][0]["rows"])
    clocks = (time.perf_counter, time.process_time)
    spent = {"together": [], "separately": []}
    with tempfile.TemporaryDirectory() as place:
        path = Path(place, "combinations.parquet")
        picked = np.random.default_rng(7).choice(combinations, pick, replace=False).tolist()
        begun = [clock() for clock in clocks]
        solve(Model(**separately(data, names[0])))
        first = clocks[0]() - begun[0]
        begun = [clock() for clock in clocks]
        results = solve(Model(**data), table=path)
        spent["together"] = [clock() - start for clock, start in zip(clocks, begun, strict=True)]
        begun = [clock() for clock in clocks]
        singles = {number: solve(Model(**separately(data, names[number])))[names[number]] for number in picked}
        spent["separately"] = [
            (clock() - start) * combinations / pick for clock, start in zip(clocks, begun, strict=True)
        ]
        rows = pq.read_table(path).to_pylist()
    worst = max(difference_on_soil(rows[number], single) for number, single in singles.items())
    states = len({single.supports[0].closed.tobytes() for single in singles.values()})
    combined = results.combined
    wall, cpu = (a / b for a, b in zip(spent["together"], spent["separately"], strict=True))
    print(
        f"slab A on soil, {elements}x{elements}, {combinations} combinations of {CASES} load cases; first {first:.2f} s"
    )
    print(f"together {spent['together'][0]:.2f} s, separately {spent['separately'][0]:.2f} s: a part of {wall:.3f}")
    print(f"of processor time {spent['together'][1]:.2f} s, {spent['separately'][1]:.2f} s: a part of {cpu:.3f}")
    print(f"solved by themselves: {combined.alone}; worst certificate {max(combined.certificate.values()):.1e}")
    print(f"{pick} solved separately too, {states} contact sets: largest relative difference {worst:.1e}")
    return worst, states


def difference_on_soil(row, single):
    """Largest difference of a row of the table from a separate solve, relative to the largest value of its kind."""
    from signorini.results.quantities import LINEAR

    (support,) = single.supports
    assert row["combination"] == single.name and row["status"] == single.status == "solved"
    assert row["closed:soil"] == support.closed_count
    worst = abs(row["reaction:soil"] - support.reaction) / support.reaction
    for index, probe in enumerate(single.probes, start=1):
        values = (probe.deflection, *probe.rotation, *probe.moment, *probe.shear)
        for name, value in zip(LINEAR, values, strict=True):
            worst = max(worst, abs(row[f"probe[{index}]:{name}"] - value) / np.abs(single.fields[name]).max())
    return worst


def run(elements, combinations, side, path, first_alone):
    """Solve, in a process of its own, all combinations as a table, or only the first one with all its results."""
    from signorini import Model, solve

    data = tables(elements, combinations, side)
    if first_alone:
        data = separately(data, "c0")
    results = solve(Model(**data), table=path)
    if results.model.tabulated:
        print(results.combined.alone, max(results.combined.certificate.values()))


def process(*arguments):
    begun = time.perf_counter()
    done = subprocess.run([sys.executable, __file__, *map(str, arguments)], check=True, capture_output=True, text=True)
    return time.perf_counter() - begun, done.stdout


def compare(elements, combinations, side, path, pick):
    """Largest relative difference between rows of the table and separate solves of ``pick`` combinations."""
    import pyarrow.parquet as pq

    from signorini import Model, contact_problem
    from signorini.analysis.single import solve_one
    from signorini.results.quantities import LINEAR

    rows = pq.read_table(path).to_pylist()
    problem = contact_problem(Model(**tables(elements, combinations, side)))
    every = problem.discretisation.model.effective_combinations
    worst, opened = 0.0, set()
    for number in np.random.default_rng(7).choice(combinations, pick, replace=False).tolist():
        single = solve_one(problem, every[number])
        row = rows[number]
        assert row["combination"] == single.name and row["status"] == single.status
        if single.status != "solved":
            continue
        (support,) = single.supports
        opened.add(tuple(np.flatnonzero(~support.closed)))
        forces = np.array([row[f"reaction_at:points[{i + 1}]"] for i in range(side**2)])
        worst = max(worst, np.abs(forces - support.reactions).max() / support.reactions.max())
        for index, probe in enumerate(single.probes, start=1):
            values = (probe.deflection, *probe.rotation, *probe.moment, *probe.shear)
            for name, value in zip(LINEAR, values, strict=True):
                worst = max(worst, abs(row[f"probe[{index}]:{name}"] - value) / np.abs(single.fields[name]).max())
    return worst, len(opened)


def measure(elements, combinations, side, repeat, pick):
    with tempfile.TemporaryDirectory() as place:
        path = Path(place, "combinations.parquet")
        seconds = {way: [] for way in ("first", "all")}
        for _ in range(repeat):
            for way in seconds:
                given = ("--elements", elements, "--combinations", combinations, "--side", side)
                spent, said = process("--run", way, *given, path)
                seconds[way].append(spent)
        first, every = (statistics.median(seconds[way]) for way in ("first", "all"))
        worst, states = compare(elements, combinations, side, path, pick)
    alone, certificate = said.split()
    kind = f"slab B, {elements}x{elements}, {side**2} points, {CASES} load cases"
    print(f"{kind}, median of {repeat} processes of each kind in turn")
    print(f"first alone {first:.2f} s, all {combinations} {every:.2f} s: {every / first:.2f} times")
    print(f"solved by themselves: {alone}; worst certificate figure {float(certificate):.1e}")
    print(f"{pick} picked at random, {states} contact states: largest relative difference {worst:.1e}")
    return worst


def pynite(elements, count):
    """Solve ten combinations with PyNite: rectangular Mindlin elements on 16 springs that only push."""
    from Pynite import FEModel3D

    from signorini import Model, solve

    data = tables(elements, count)
    (table,) = data["combination"]
    loads = {load["case"]: load for load in data["load"]}
    begun = time.perf_counter()
    results = solve(Model(**data | {"output": {"combinations": "each"}}))
    ours = time.perf_counter() - begun

    begun = time.perf_counter()
    model = FEModel3D()
    model.add_material("concrete", 30e9, 30e9 / 2.4, 0.2, 0)
    model.add_rectangle_mesh("slab", 10 / elements, 10, 10, 0.3, "concrete", plane="XY", element_type="Quad")
    model.meshes["slab"].generate()
    nodes = {(round(node.X, 6), round(node.Y, 6)): name for name, node in model.nodes.items()}
    for name in model.nodes:
        # Displacements in the plane and rotations about z are held.
        model.def_support(name, True, True, False, False, False, True)
    for x, y in points(SIDE):
        model.def_support_spring(nodes[x, y], "DZ", SPRING, "-")
    for case, load in loads.items():
        if "pressure" in load:
            for quad in model.meshes["slab"].elements:
                model.add_quad_surface_pressure(quad, -load["pressure"], case=case)
        else:
            near = min(nodes, key=lambda at, p=load["at"]: (at[0] - p[0]) ** 2 + (at[1] - p[1]) ** 2)
            model.add_node_load(nodes[near], "FZ", -load["force"], case=case)
    for name, row in table["rows"].items():
        model.add_load_combo(name, dict(zip(table["columns"], row, strict=True)))
    model.analyze()
    theirs = time.perf_counter() - begun

    total = {case: load["pressure"] * 100 if "pressure" in load else load["force"] for case, load in loads.items()}
    errors = {"signorini": [], "PyNite, reactions it reports": [], "PyNite, its springs times its deflections": []}
    for name, row in table["rows"].items():
        applied = sum(factor * total[case] for case, factor in zip(table["columns"], row, strict=True))
        pushed = sum(model.nodes[nodes[x, y]].RxnFZ[name] for x, y in points(SIDE))
        springs = sum(-SPRING * min(model.nodes[nodes[x, y]].DZ[name], 0) for x, y in points(SIDE))
        for which, force in zip(list(errors)[1:], (pushed, springs), strict=True):
            errors[which].append(abs(force - applied) / abs(applied))
        errors["signorini"].append(abs(results[name].reactions["points"] - applied) / abs(applied))
    print(f"slab B, {elements}x{elements}, {count} combinations: signorini {ours:.2f} s ({ours / count:.3f} s each)")
    print(f"PyNite {theirs:.1f} s, {theirs / ours:.0f} times as long")
    for program, found in errors.items():
        print(f"{program}: reactions against loads, worst relative residual {max(found):.1e}")


def check():
    """Check that every row of a table on a coarse mesh equals a separate solve of its combination."""
    with tempfile.TemporaryDirectory() as place:
        path = Path(place, "combinations.parquet")
        run(20, 300, SIDE, path, first_alone=False)
        worst, states = compare(20, 300, SIDE, path, 100)
    print(f"100 of 300 combinations, {states} contact states: largest relative difference {worst:.1e}")
    of_soil, sets = soil(12, 60, 20)
    sys.exit(0 if max(worst, of_soil) <= 1e-9 and states > 5 and sets > 5 else 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int)
    parser.add_argument("--combinations", type=int, default=10000)
    parser.add_argument(
        "--side", type=int, default=SIDE, help="points along a side (default %(default)s; 20 makes 400)"
    )
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--pick", type=int, default=200)
    parser.add_argument("--pynite", action="store_true")
    parser.add_argument("--soil", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--run", choices=["first", "all"], help=argparse.SUPPRESS)
    parser.add_argument("path", nargs="?", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.run:
        run(given.elements, given.combinations, given.side, given.path, first_alone=given.run == "first")
    elif given.check:
        check()
    elif given.pynite:
        pynite(given.elements or 20, 10)
    elif given.soil:
        count = min(given.combinations, 200)
        if soil(given.elements or 40, count, min(given.pick, count))[0] > 1e-9:
            sys.exit(1)
    elif measure(given.elements or 80, given.combinations, given.side, given.repeat, given.pick) > 1e-9:
        sys.exit(1)


if __name__ == "__main__":
    main()
