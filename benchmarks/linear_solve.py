"""One linear solve of a plate against MKL PARDISO on the same matrix: ratios of time and memory in one run.

Time is that of ordering, analysis, factorization and one solve. Memory is the growth of the process's peak, from the
state before the matrix is made. Each solver runs in a process of its own, alternately. Signorini assembles the matrix
front by front and never stores it. PARDISO reads it from a file, and its memory includes the matrix.

The rate of the factorization is compared with that of NumPy's matrix product in the same process. Give both the same
number of threads (RAYON_NUM_THREADS, OPENBLAS_NUM_THREADS). Operations (Flop) are those of the pattern of L, without
stored zeros; the time includes the analysis.

Shares of the time of the numeric factorization, 160×160, one thread, a new process (0.80 s, 16.7 GFlop):

    36 %  matrix products of update matrices          11 %  adding the update matrices of children
    21 %  zeroing of pages by the system               9 %  assembly of the matrix
    18 %  elimination of the fronts' own columns       4 %  storing L

Large fronts run at 45 GFlop/s; faer's matrix product runs at 49. Three quarters of all fronts have at most 90 rows;
they take a fifth of the time at 2 to 3 GFlop/s. Ordering takes 0.015 s, analysis 0.035 s. Two threads are busy 90 % of
the time.

At 400×400 (319.3M entries, 272 GFlop) one thread touches 754,000 pages, 624,000 of them for L. In a virtual machine a
page costs 2 to 8 µs, so that all pages take 1.8 to 7.6 s. User time is about 10 s: matrix products 6.7, triangular
solves 0.6, assembly 0.4, update matrices 0.2, analysis 0.2, storing L 0.5.

On a core of 85 GFlop/s with AVX-512, fronts of more than 1000 rows run at two thirds of this rate. The rows of a tile
are first copied, because columns of L are pages apart. Copying takes 6 % of the time of these products at 400×400, 10 %
at 160×160. With tiles of 256 columns, 192 rows and 512 columns of L these fronts run at 70 GFlop/s, with tiles of 128
columns at 62; this saves 0.2 s of 4.7 s at 320×320. If all products ran at the library's best rate with the fewest
pages, 160×160 would take 0.57 s and 400×400 6.2 s, 0.34 and 0.51 of the rate of NumPy's product.

If elements are equal up to rounding, their matrices take 0.01 s. If all 25,600 elements differ, the matrices take
0.11 s on one thread, four at a time, and 0.15 s one at a time. The cost of a stored zero in the choice of fronts may be
3 to 12 without effect. One right-hand side reads L twice, at 18 to 20 GB/s on two threads; a sum over as many numbers
runs at 30 GB/s.

These changes brought no gain:

- fronts of up to 64 columns in registers: 0.03 s less, but an ill-conditioned plate failed;
- register tiles of three vectors by four columns (registers spilled), and of two by six;
- bending strains as arrays along each axis;
- diagonal blocks of update matrices as full squares, or in parts of 16 to 64 columns;
- pages requested in advance: 1.5 to 1.9 µs each in place of 1.7 to 2.3 µs;
- huge pages: 7 to 9 µs per 4 kB where the host must find them; 5.2 to 5.7 s of system time in place of 1.8 to 3.1 s;
- stacks and panels that each thread keeps: 735,000 pages in place of 754,000 at 400×400, but 95,000 in place of 84,000
  at 160×160.

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
    """Model of a clamped square plate with h/a = 0.01."""
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
    """Rate of NumPy's matrix product, the best of several runs [flop/s]."""
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
    """Check that this program's solution equals SuperLU's on a small plate."""
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
