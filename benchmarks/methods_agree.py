"""Agreement of Lemke's algorithm and the active set, condensed and as a saddle-point system, on random plates.

The plates are rectangles and discs with thickness over span from 0.003 to 0.3, in metres or millimetres, newtons or
meganewtons. They rest on rigid and elastic points, lines, edges, circles and soil, with gaps and settlements, and have
up to 400 contact points. A plate is determined by its number. Every answer must pass its certificate. Differences of
deflections are relative to the largest deflection, differences of reactions to the largest reaction. Reactions are
not compared if the closed rigid supports are dependent; deflections are not compared if the closed supports leave a
rigid motion.

    python benchmarks/methods_agree.py --plates 500           # worst differences and times
    python benchmarks/methods_agree.py --plates 40 --check    # exits with 1 unless all agree to 1e-8
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from signorini import InputError, Model, contact_problem
from signorini.contact.certificate import certify
from signorini.contact.factoring import Method
from signorini.contact.problem import ContactProblem, unfactored
from signorini.contact.selection import Answer
from signorini.discretise import discretise
from signorini.equilibrium.imbalance import imbalance

METHODS: tuple[Method, ...] = ("lemke", "active_set", "saddle")
TOLERANCE = 1e-8
MOST = 400
"""Largest number of contact points of a plate."""

Tables = dict[str, Any]


class Compared(NamedTuple):
    """One plate: by method the status, seconds, pivots and steps, and differences from the first certified answer."""

    plate: int
    points: int
    status: dict[str, str]
    seconds: dict[str, float]
    work: dict[str, tuple[int, int]]
    deflection: dict[str, float]
    reaction: dict[str, float]

    def agrees(self, method: str) -> bool:
        """Whether this method's answer is certified and equals the others, or no method finds an equilibrium."""
        if set(self.status.values()) == {"no_equilibrium"}:
            return True
        return self.status[method] == "certified" and max(self.deflection[method], self.reaction[method]) <= TOLERANCE


def tables(plate: int) -> Tables:
    """Input tables of the plate with this number, without the solver's method."""
    rng = np.random.default_rng([20, plate])
    while True:
        drawn = draw(rng)
        try:
            problem = contact_problem(Model(**drawn, solver={"method": "lemke"}))
        except InputError:
            continue
        load = problem.discretisation.cases["load"].nodal
        if 2 <= len(problem.gaps) <= MOST and imbalance(problem.discretisation, problem.freedom, load) is None:
            return drawn


def draw(rng: np.random.Generator) -> Tables:
    """Draw the input tables of a plate with one-sided supports of every kind and loads."""
    metre, newton = rng.choice([1.0, 1e3]), rng.choice([1.0, 1e-6])
    span = metre * 10 ** rng.uniform(-0.5, 1.5)
    thickness = span * 10 ** rng.uniform(np.log10(0.003), np.log10(0.3))
    young = 30e9 * newton / metre**2
    rigidity = young * thickness**3 / 12
    disc = rng.random() < 0.3
    sides = np.array([span, span * rng.uniform(0.4, 1.0)])
    plate = {"shape": "disc", "radius": span / 2} if disc else {"shape": "rectangle", "size": sides.tolist()}
    divisions = [int(rng.integers(1, 4)), 4 * int(rng.integers(1, 4))] if disc else rng.integers(2, 9, 2).tolist()

    def point(reach: float = 0.98) -> list[float]:
        if not disc:
            return [float(x) for x in sides * (0.5 + reach * rng.uniform(-0.5, 0.5, 2))]
        r, angle = 0.48 * span * reach * np.sqrt(rng.random()), rng.uniform(0, 2 * np.pi)
        return [float(r * np.cos(angle)), float(r * np.sin(angle))]

    force = 1e4 * newton * 10 ** rng.uniform(-1, 2)
    deflection = 0.02 * force * span**2 / rigidity
    edges = ["rim"] if disc else ["left", "right", "bottom", "top"]

    def support() -> Tables:
        kind = rng.choice(["at", "at", "line", "edge", "circle", "area"])
        reach, dimension = {
            "at": ({"at": [point() for _ in range(rng.integers(1, 7))]}, 0),
            "line": ({"line": [point(), point()]}, 1),
            "edge": ({"edge": str(rng.choice(edges))}, 1),
            "circle": (_circle(point(0.3), span * rng.uniform(0.03, 0.12)), 1),
            "area": ({"area": "all" if rng.random() < 0.6 else _circle(point(0.4), span / 6)}, 2),
        }[kind]
        out = {**reach, "resists": str(rng.choice(["down", "down", "up", "both"]))}
        if kind == "area":
            out["resists"] = "down"
        if kind == "area" or rng.random() < 0.5:
            out["stiffness"] = float(rigidity / span ** (2 + dimension) * 10 ** rng.uniform(0, 6))
        if out["resists"] == "both" or rng.random() < 0.5:
            least, wave = deflection * rng.uniform(0, 0.2), rng.uniform(1, 9) / span
            out["gap"] = f"{least:.17g}*(1 + 0.7*sin({wave:.17g}*x + 2*y/{span:.17g}))"
        if rng.random() < 0.2:
            out["settlement"] = float(deflection * rng.uniform(-0.1, 0.1))
        return out

    def load() -> Tables:
        if rng.random() < 0.4:
            return {"pressure": float(force / span**2 * rng.uniform(-0.5, 1.0))}
        return {"force": float(force * rng.uniform(-0.3, 1.0)), "at": point(0.8)}

    supports = [support() for _ in range(rng.integers(1, 5))]
    if rng.random() < 0.3:
        supports.append({"edge": edges[0], "fix": str(rng.choice(["simple", "clamped"]))})
    return {
        "material": {"E": young, "nu": float(rng.uniform(0, 0.4))},
        "plate": {**plate, "thickness": float(thickness)},
        "mesh": {"divisions": divisions},
        "support": supports,
        "load": [{"pressure": float(force / span**2)}, *(load() for _ in range(rng.integers(1, 5)))],
    }


def _circle(center: list[float], radius: float) -> Tables:
    return {"circle": {"center": center, "radius": float(radius)}}


def compare(plate: int) -> Compared:
    """Solve the plate with this number by every method."""
    drawn = tables(plate)
    status, seconds, work = {}, {}, {}
    deflection, reaction = dict.fromkeys(METHODS, 0.0), dict.fromkeys(METHODS, 0.0)
    reference = None
    for method in METHODS:
        begun = time.perf_counter()
        problem = unfactored(discretise(Model(**drawn))).by(method)
        load = problem.discretisation.cases["load"]
        answer = problem.solve(load)
        seconds[method] = time.perf_counter() - begun
        status[method], work[method] = answer.status, (answer.pivots, answer.iterations)
        if answer.status != "solved":
            continue
        w, r = answer.hi[::3] + answer.lo[::3], answer.reaction
        passed = certify(problem.discretisation, load, answer.hi, answer.lo, r).passed
        status[method] = "certified" if passed else "refused"
        if reference is None and passed:
            reference = w, r, *unique(problem, answer, np.abs(w).max())
        elif reference is not None:
            w0, r0, one_shape, one_reaction = reference
            deflection[method] = np.abs(w - w0).max() / np.abs(w0).max() if one_shape else 0.0
            reaction[method] = np.abs(r - r0).max() / (np.abs(r0).max() or 1.0) if one_reaction else 0.0
    return Compared(plate, len(problem.gaps), status, seconds, work, deflection, reaction)


def unique(problem: ContactProblem, answer: Answer, length: float) -> tuple[bool, bool]:
    """Whether deflections are unique, and whether reactions are unique.

    Deflections are unique if closed points leave no rigid motion, reactions if rows are independent.
    """
    found, reaction, gap = problem.discretisation, answer.reaction, answer.gap
    flat = found.contacts.flat_on(answer.piece)
    pressed = found.contacts.two_sided | (~flat & (np.abs(reaction) > 1e-7 * np.abs(reaction).max(initial=0.0)))
    moves = problem.freedom.moves[pressed]
    values = np.linalg.svd(moves, compute_uv=False) if len(moves) else np.zeros(0)
    fixed = problem.freedom.count == 0 or (len(moves) >= problem.freedom.count and values[-1] > 1e-6 * values[0])
    rigid = (problem.compliance == 0) & (found.contacts.two_sided | (~flat | (np.abs(gap) <= 1e-9 * length)))
    rows = problem.G.toarray()[rigid][:, ~found.held.dofs]
    norms = np.linalg.norm(rows, axis=1)
    if not len(rows):
        return fixed, True
    if len(rows) > rows.shape[1] or not norms.all():
        return fixed, False
    return fixed, bool(np.linalg.svd(rows / norms[:, None], compute_uv=False)[-1] > 1e-6)


def report(plates: Iterable[Compared]) -> bool:
    """Print status, times and differences of the methods; return whether all agree."""
    everything = list(plates)
    print(f"{len(everything)} plates, {sum(c.points for c in everything)} contact points, at most {MOST} a plate")
    print(f"{'':<16} {'largest difference':^21} {'not':>5} {'steps':>7} {'pivots':>7} {'with':>6} {'time':>9}")
    print(f"{'method':<16} {'deflection':>10} {'reaction':>10} {'alike':>5} {'':>7} {'':>7} {'pivots':>6} {'s':>9}")
    for method in METHODS:
        alike = [c for c in everything if c.agrees(method)]
        deflection = max((c.deflection[method] for c in alike), default=0.0)
        reaction = max((c.reaction[method] for c in alike), default=0.0)
        pivots, steps = (sum(c.work[method][k] for c in everything) for k in (0, 1))
        with_pivots = sum(c.work[method][0] > 0 for c in everything)
        seconds = sum(c.seconds[method] for c in everything)
        others = len(everything) - len(alike)
        apart = f"{deflection:>10.1e} {reaction:>10.1e}"
        print(f"{method:<16} {apart} {others:>5} {steps:>7} {pivots:>7} {with_pivots:>6} {seconds:>9.2f}")
    for method in METHODS:
        for c in (c for c in everything if not c.agrees(method)):
            apart = f"deflection {c.deflection[method]:.1e}, reaction {c.reaction[method]:.1e}"
            print(f"plate {c.plate} ({c.points} points), {method}: {c.status[method]}, {apart}")
    return all(c.agrees(method) for c in everything for method in METHODS)


def main() -> int:
    """Compare the methods on as many plates as asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plates", type=int, default=500, help="how many plates (default 500)")
    parser.add_argument("--first", type=int, default=0, help="number of the first plate (default 0)")
    parser.add_argument("--check", action="store_true", help="exit with 1 unless all methods agree")
    options = parser.parse_args()
    alike = report(map(compare, range(options.first, options.first + options.plates)))
    return 0 if alike or not options.check else 1


if __name__ == "__main__":
    sys.exit(main())
