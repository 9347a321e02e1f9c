"""One linear solve of a plate against MKL PARDISO on the same matrix: time and memory, as ratios in one run.

Time is order + analyse + factor + one solve; memory is the growth of the process's peak from before the matrix is
there. Each solver runs in a process of its own, the two taking turns. Ours sums the matrix itself, front by front, and
never has all of it; PARDISO reads it from a file, and its memory counts from before that.

Beside the factor's rate stands that of NumPy's matrix product in the same process: give both the same threads
(RAYON_NUM_THREADS, OPENBLAS_NUM_THREADS). Its flops are those that the pattern needs; zeros stored for speed are not
counted, the analysis is part of its time.

Where the time goes, at 160×160 on one thread, of the numeric factor in a process just started (0.80 s of the
processor, 16.7 GFlop): 36% in products that form what fronts leave, 18% in eliminating their own columns, 21% in the
system's zeroing of pages on first touch (1.9 µs a page of 4 kB, 89,000 pages), 11% in adding what children leave, 9% in
summing the matrix, 4% in storing L. Large fronts leave their products at 45 GFlop/s where faer's own product makes 49;
fronts of up to 90 rows, three quarters of all, take a fifth of the time at 2 to 3 GFlop/s, spread evenly over these
parts. The order takes 0.015 s, the analysis 0.035. On two threads the parts of the tree keep both busy 90% of the time.

At 400×400 (319.3M entries, 272 GFlop) one thread touches 754,000 pages, of which L itself is 624,000. In a virtual
machine one costs 2 µs if its host still has it, up to 8 if it must find it: 1.8 to 7.6 s of the processor for one and
the same factor within an hour, a sixth to two fifths of it. Of some 10 s in this library 6.7 are matrix products, 0.6
the triangular solves beneath the pivots, 0.4 summing the matrix, 0.2 each adding what children leave and the analysis;
storing L takes 0.5 more, and is bound by memory.

On a core of 85 GFlop/s, with AVX-512, fronts of more than 1000 rows run at two thirds of that. Products lose where
columns of L are pages apart; so a tile's own rows are copied one after the other (6% of these products at 400×400, 10%
at 160×160). A product of 2400 rows, 1200 deep, runs at 65 to 70 GFlop/s for 128 columns and 69 to 75 for 256; NumPy's
own at 62 and 69. In fronts of more than 1000 rows tiles of 256 columns, 192 rows at a time and 512 columns of L deep,
run at 70 instead of 62: 0.2 s of 4.7 at 320×320, and none at 160×160, where triangles on the diagonal take back what
tiles gain.

So half the matrix product's rate is not to be had at 160×160, nor 0.6 of it at 400×400. With every product at the
library's best, 16.7 GFlop take 0.22 s of the processor and 272 take 3.6; L's own pages 0.15 more and 1.3 to 4.5; K,
what children leave and storing L 0.2 and 1.3: 0.57 and 6.2 at the least, or 0.34 and 0.51 of the product's rate.

Element matrices: 0.01 s where elements are alike but for rounding of their places, as here; 0.11 s on one thread
where all 25,600 differ, of which 0.04 are pages, 0.01 finding that they differ, and 0.03 arithmetic, four elements at a
time. One at a time took 0.15.

The charge for zeros in the tree's cost may be anything from 3 to 12, or those beside it double: 39.0 to 41.4 million
entries take the same time within its noise, at 40×40 too. There the analysis, order and solve are 0.005 s of 0.033, and
0.008 are pages.

Tried and dropped: fronts of up to 64 columns eliminated in registers (0.03 s less, but a plate that rounding makes hard
was lost, and others came near); tiles of three vectors by four columns in registers (the compiler spills them), and of
two by six; bending by arrays along each axis; the diagonal blocks of what fronts leave as whole squares, or by 16 to 64
columns (at most 3% of that part).

Pages are not to be had for less: the system fills them ahead at 1.5 to 1.9 µs each instead of 1.7 to 2.3, and huge
ones cost a virtual machine 7 to 9 µs per 4 kB when its host must find them first. A host that takes free huge pages
back always must: with L and all large buffers in them 400×400 had a fifth of the page faults, and took 5.2 to 5.7 s of
the system instead of 1.8 to 3.1. Stacks and panels kept by each thread at the largest size that any part needs, and
what parts leave in buffers kept as long as the estimate has room, touch 735,000 pages at 400×400 instead of 754,000,
and at 160×160 95,000 instead of 84,000: the allocator does as well.

One right-hand side reads L twice at 18-20 GB/s on two threads; a sum over as many numbers runs at 30.

    python benchmarks/linear_solve.py [--elements 160] [--repeat 5]     needs pypardiso
    python benchmarks/linear_solve.py --alone [--elements 160]          without it
    python benchmarks/linear_solve.py --check                           correctness only, against SuperLU
"""

import argparse
import json
import statistics
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from processes import peak_mb, run


def clamped_plate(elements):
    """Clamped square, h/a = 0.01."""
    from signorini import Model
    from signorini.discretise import discretise

    return discretise(
        Model(
            material={"E": 30e9, "nu": 0.2},
            plate={"shape": "rectangle", "size": [1, 1], "thickness": 0.01},
            mesh={"divisions": [elements, elements]},
            support=[{"edge": ["left", "right", "bottom", "top"], "fix": "clamped"}],
            load=[{"pressure": 1e3}],
        )
    )


def ours(elements, folder):
    from signorini import contact_problem

    plate = clamped_plate(elements)
    load = plate.cases["load"].nodal
    before = peak_mb()
    problem = contact_problem(plate)
    begun = time.perf_counter()
    solution = problem.core.apply_inverse(load)
    solve = time.perf_counter() - begun
    memory = peak_mb() - before
    np.save(Path(folder, "ours.npy"), solution[~plate.held.dofs])
    part = problem.seconds
    return {
        "seconds": part["order"] + part["factor"] + solve,
        "memory": memory,
        "entries": problem.core.factor_entries,
        "factor": part["factor"],
        "flops": problem.core.factor_flops,
        "product": product_rate(),
        "dofs": plate.dof_count,
    }


def product_rate(order=2000, repeat=5):
    """Flops a second of NumPy's matrix product, the best of several."""
    matrix = np.random.default_rng(0).random((order, order))
    seconds = []
    for _ in range(repeat):
        begun = time.perf_counter()
        matrix @ matrix
        seconds.append(time.perf_counter() - begun)
    return 2 * order**3 / min(seconds)


def pardiso(elements, folder):
    import pypardiso

    before = peak_mb()
    upper = sp.csr_matrix(sp.load_npz(Path(folder, "upper.npz")))
    load = np.load(Path(folder, "load.npy"))
    solver = pypardiso.PyPardisoSolver(mtype=2)
    begun = time.perf_counter()
    solver.factorize(upper)
    solution = solver.solve(upper, load)
    seconds = time.perf_counter() - begun
    memory = peak_mb() - before
    np.save(Path(folder, "pardiso.npy"), solution)
    return {"seconds": seconds, "memory": memory, "entries": int(solver.get_iparm(18))}


def write_matrix(elements, folder):
    from signorini import contact_problem

    problem = contact_problem(clamped_plate(elements))
    plate = problem.discretisation
    free = ~plate.held.dofs
    matrix = sp.csr_matrix(problem.K[free][:, free])
    upper = sp.triu(matrix, format="csr")
    upper.sort_indices()
    sp.save_npz(Path(folder, "upper.npz"), upper, compressed=False)
    np.save(Path(folder, "load.npy"), plate.cases["load"].nodal[free])
    return {}


def check():
    """Ours equals SuperLU on a small plate."""
    from scipy.sparse.linalg import spsolve

    from signorini import contact_problem

    problem = contact_problem(clamped_plate(20))
    plate = problem.discretisation
    free = ~plate.held.dofs
    load = plate.cases["load"].nodal
    expected = spsolve(sp.csc_matrix(problem.K[free][:, free]), load[free])
    error = np.abs(problem.core.apply_inverse(load)[free] - expected).max() / np.abs(expected).max()
    print(f"largest difference from SuperLU, relative: {error:.1e}")
    sys.exit(0 if error < 1e-7 else 1)


def print_rate(mine):
    rate = mine["flops"] / mine["factor"]
    print(
        f"factor   {mine['factor']:.3f} s  {mine['entries'] / 1e6:.1f}M entries  {mine['flops'] / 1e9:.1f} GFlop  "
        f"{rate / 1e9:.1f} GFlop/s, matrix product {mine['product'] / 1e9:.1f}, ratio {rate / mine['product']:.2f}"
    )


def alone(elements, repeat):
    with tempfile.TemporaryDirectory() as folder:
        found = [run(__file__, "--run", "ours", "--elements", elements, "--folder", folder) for _ in range(repeat)]
    mine = {key: statistics.median(row[key] for row in found) for key in found[0]}
    print(f"{elements}x{elements} mitc9, {mine['dofs']} dofs, median of {repeat}")
    print(f"solve    {mine['seconds']:.3f} s  {mine['memory']:.0f} MB")
    print_rate(mine)


def compare(elements, repeat):
    with tempfile.TemporaryDirectory() as folder:
        given = ("--elements", elements, "--folder", folder)
        run(__file__, "--run", "write_matrix", *given)
        rows = {"ours": [], "pardiso": []}
        for _ in range(repeat):
            for name, found in rows.items():
                found.append(run(__file__, "--run", name, *given))
        a, b = (np.load(Path(folder, f"{name}.npy")) for name in rows)
    best = {
        name: {key: statistics.median(row[key] for row in found) for key in found[0]} for name, found in rows.items()
    }
    mine, theirs = best["ours"], best["pardiso"]
    print(f"{elements}x{elements} mitc9, {mine['dofs']} dofs, median of {repeat}")
    print(f"ours     {mine['seconds']:.3f} s  {mine['memory']:.0f} MB  {mine['entries'] / 1e6:.1f}M entries")
    print_rate(mine)
    print(f"PARDISO  {theirs['seconds']:.3f} s  {theirs['memory']:.0f} MB  {theirs['entries'] / 1e6:.1f}M entries")
    print(f"ratio of time {mine['seconds'] / theirs['seconds']:.2f}, of memory {mine['memory'] / theirs['memory']:.2f}")
    print(f"largest difference, relative {np.abs(a - b).max() / np.abs(b).max():.1e}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, default=160)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--alone", action="store_true", help="without PARDISO")
    parser.add_argument("--run", choices=["ours", "pardiso", "write_matrix"], help=argparse.SUPPRESS)
    parser.add_argument("--folder", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.check:
        check()
    elif given.run:
        print(
            json.dumps(
                {"ours": ours, "pardiso": pardiso, "write_matrix": write_matrix}[given.run](
                    given.elements, given.folder
                )
            )
        )
    elif given.alone:
        alone(given.elements, given.repeat)
    else:
        compare(given.elements, given.repeat)


if __name__ == "__main__":
    main()
