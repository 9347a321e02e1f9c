"""Convergence on supports that only push: error over mesh size for every case of `tensionless.py`.

python benchmarks/convergence.py             writes docs/convergence.png and prints the table of docs/validation.md
python benchmarks/convergence.py --check     exits with 1 unless the third mesh of every case is within tolerance
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from tensionless import CASES, Case

from signorini import solve

PICTURE = Path(__file__).parents[1] / "docs" / "convergence.png"
TOLERANCE = 0.01
"""Largest allowed error of a quantity on the third mesh of a case."""
COLUMNS = 3


def errors(case: Case, n: int) -> dict[str, float]:
    result = solve(case.model(n))["all"]
    assert result.certificate.passed
    return case.errors(result)


def order(case: Case, name: str, found: np.ndarray) -> str:
    """Order of convergence: slope of the errors above the reference's precision; "–" with less than three."""
    telling = found > case.floor(name)
    if telling.sum() < 3:
        return "–"
    return f"{-np.polyfit(np.log(np.array(case.divisions)[telling]), np.log(found[telling]), 1)[0]:.1f}"


def draw(table: dict[str, dict[str, np.ndarray]]) -> None:
    import matplotlib.pyplot as plt

    rows = -(-len(CASES) // COLUMNS)
    figure, panels = plt.subplots(rows, COLUMNS, figsize=(13, 3.7 * rows), sharey=True, layout="constrained")
    for case, ax in zip(CASES, panels.flat, strict=True):
        n = np.array(case.divisions, dtype=float)
        for (name, found), mark in zip(table[case.title].items(), "os^", strict=False):
            telling = found > case.floor(name)
            (line,) = ax.loglog(n, found, marker=mark, mfc="white", label=f"{name}, order {order(case, name, found)}")
            ax.loglog(n[telling], found[telling], marker=mark, ls="", color=line.get_color())
        start = max(found[0] for found in table[case.title].values())
        for slope in (1, 2):
            ends = 2 * start * (n / n[0]) ** -slope
            ax.loglog(n, ends, color="0.7", lw=0.8, zorder=0)
            ax.annotate(f"1/n{'²' * (slope - 1)}", (n[-1], ends[-1]), (0, 3), textcoords="offset points", ha="right")
        ax.set_title(case.title, size=10)
        ax.set_xticks(n, [f"{k:g}" for k in n], minor=False)
        ax.minorticks_off()
        ax.legend(fontsize=7.5, loc="lower left")
        ax.grid(alpha=0.3)
    panels.flat[0].set_ylim(2e-7, 0.5)
    figure.supxlabel("elements along a side, n")
    figure.supylabel("relative error")
    figure.savefig(PICTURE, dpi=110)


def tabulate(table: dict[str, dict[str, np.ndarray]]) -> None:
    print("| case | reference | figure | value | n | error | finest n | error | order |")
    print("|---|---|---|---|---|---|---|---|---|")
    for case in CASES:
        for name, found in table[case.title].items():
            meshes = " | ".join(f"{case.divisions[i]} | {found[i]:.1e}" for i in (2, -1))
            known = f"{case.title} | {case.reference} | {name} | {case.exact[name]:.6g}"
            print(f"| {known} | {meshes} | {order(case, name, found)} |")


def check() -> None:
    worst = {case.title: max(errors(case, case.divisions[2]).values()) for case in CASES}
    for title, error in worst.items():
        print(f"{title}: largest error {error:.1e}")
    sys.exit(0 if max(worst.values()) < TOLERANCE else 1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    if parser.parse_args().check:
        check()
    table = {}
    for case in CASES:
        by_mesh = [errors(case, n) for n in case.divisions]
        table[case.title] = {name: np.array([found[name] for found in by_mesh]) for name in case.exact}
    draw(table)
    tabulate(table)


if __name__ == "__main__":
    main()
