"""Random small plates with limits, laws and gaps, against a quadratic program.

The plates are those of methods_agree.py, with limits, laws, tables of stiffness, springs on slopes and preloads. One or
two more plates lie on half of them, in contact, tied or bolted. Bolts must have their preloads after tightening.
Straight laws must give the same deflections as stiffnesses. The program refuses rigid areas opposed by rigid supports.

The quadratic program, the judge, uses K, G, f and the laws of the program, and no other code. It minimises the
potential energy over all dofs and all pieces of the laws by Clarabel (Goulart & Chen 2024), and refines on the pieces
that it finds. Deflections, and unique reactions, must agree to 1e-8 of the largest; both must find an equilibrium, or
none. If a plate moves much farther than it bends, rounding of K alone changes the judge's solution. Plates with a
change of 1e-9 or more are counted separately.

    python benchmarks/random_laws.py [--count 1000] [--first 0] [--seconds 600] [--processes 2]
    python benchmarks/random_laws.py --show SEED
    python benchmarks/random_laws.py --check        a few plates, to test the script
"""

from __future__ import annotations

import json
import sys
import warnings
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

import clarabel
import numpy as np
from scipy.sparse import block_array, csc_array, diags_array, eye_array, triu
from scipy.sparse.linalg import splu

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fuzz"))
import campaign
import methods_agree

from signorini import InputError, Model, NoEquilibriumError, contact_problem, tightened
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import Answer
from signorini.contact.strategy import answered
from signorini.equilibrium.imbalance import imbalance

warnings.simplefilter("error", RuntimeWarning)
TOLERANCE = 1e-8
_BALANCED = 1e-9
"""Largest imbalance of a solution, relative to the largest force; if it is larger, there is no equilibrium."""
_STEADY = 1e-9
"""Largest relative effect of the rounding of K on the judge's solution: a tenth of the tolerance."""
_PROVEN = 1e-12
"""Tolerance of Clarabel's proof of infeasibility. It is tight, since plates that move far have small residuals too."""
_SHARPER = 30
"""Largest number of combinations of law pieces on which a solution is refined."""
Tables = dict[str, Any]


def tables(seed: int) -> Tables:
    """Draw the model of a seed; return the tables of an input file."""
    rng = np.random.default_rng([26, seed])
    drawn = methods_agree.draw(rng)
    pressure = drawn["load"][0]["pressure"]
    size = np.array(drawn["plate"].get("size", 2 * [2 * drawn["plate"].get("radius", 0.0)]))
    span, rigidity = size.max(), drawn["material"]["E"] * drawn["plate"]["thickness"] ** 3 / 12
    sag = 0.02 * pressure * span**4 / rigidity
    for support in drawn["support"]:
        if "fix" in support:
            continue
        if "at" in support and rng.random() < 0.2:
            support["rotational_stiffness"] = float(rigidity * 10 ** rng.uniform(-2, 2))
        dimension = 0 if "at" in support else 2 if "area" in support else 1
        force = pressure * span ** (2 - dimension) * 10 ** rng.uniform(-2, 0.5)
        if support["resists"] == "both" and rng.random() < 0.5:
            support.pop("gap")
        match rng.choice(["law", "limit", "limit", "none"]):
            case "law":
                support.pop("stiffness", None)
                support["law"] = _law(rng, sag * 10 ** rng.uniform(-2, 0.5), force)
                if support["resists"] == "both" and "gap" not in support and rng.random() < 0.5:
                    other = _law(rng, sag * 10 ** rng.uniform(-2, 0.5), force)
                    support["law"] = [[-t, -f] for t, f in reversed(other[1:])] + support["law"]
            case "limit":
                support["limit"] = float(force)
        if dimension and "stiffness" in support and rng.random() < 0.3:
            low = -0.5 * size if drawn["plate"]["shape"] == "disc" else 0.0 * size
            corners = [low + size * at for at in ((0, 0), (1, 0), (1, 1), (0, 1), (0.4, 0.3))]
            values = (support["stiffness"] * 10 ** rng.uniform(-1, 0, len(corners))).tolist()
            support["stiffness"] = [[*at.tolist(), value] for at, value in zip(corners, values, strict=True)]
    for support in list(drawn["support"]):
        if "area" in support and rng.random() < 0.15:
            # The program refuses a rigid area if a rigid support on it holds the plate down.
            support.pop("stiffness", None)
            continue
        if "area" in support and rng.random() < 0.2:
            support["resists"] = "both"
        if support.get("resists") == "both" and "stiffness" in support and rng.random() < 0.5:
            support.pop("gap", None)
            support.pop("limit", None)
            drawn["support"] += _straight(rng, support, sag)
    if rng.random() < 0.5:
        _stack(rng, drawn, sag, pressure)
    for support in drawn["support"]:
        holds = support.get("resists") in ("up", "both") and "at" in support and "fix" not in support
        if holds and rng.random() < 0.3:
            most = support.get("limit") or (support["law"][-1][1] if "law" in support else np.inf)
            support["preload"] = float(min(0.9 * most, pressure * span**2 * 10 ** rng.uniform(-2, 0)))
            support["order"] = int(rng.integers(1, 3))
            # A preload excludes a gap, and a settlement beside it acts after tightening.
            support.pop("gap", None)
            support.pop("settlement", None)
    return drawn


def _stack(rng: np.random.Generator, drawn: Tables, sag: float, pressure: float) -> None:
    """Lay one or two plates on the drawn plate, and move some of its loads onto them."""
    plate, mesh = drawn.pop("plate"), drawn.pop("mesh")
    young, disc = drawn["material"]["E"], plate["shape"] == "disc"
    size = np.array(2 * [2 * plate["radius"]] if disc else plate["size"])
    low, span = (-0.5 if disc else 0.0) * size, size.max()
    drawn["plates"] = {"p0": {**plate, "mesh": mesh}}
    drawn["contact"] = []
    for table in (*drawn["support"], *drawn["load"]):
        table["plate"] = "p0"
    for number in range(1, 2 + int(rng.random() < 0.3)):
        name, below = f"p{number}", f"p{number - 1}"
        part, thickness = rng.uniform(0.3, 0.6), plate["thickness"] * 10 ** rng.uniform(-0.5, 0.3)
        # Rectangles near the middle also fit on a disc.
        at = low + size * (0.5 - 0.5 * part + 0.1 * rng.uniform(-1, 1, 2))
        rigidity = young * thickness**3 / 12
        drawn["plates"][name] = {
            **{"shape": "rectangle", "size": (part * size).tolist(), "origin": at.tolist()},
            **{"thickness": float(thickness), "mesh": {"divisions": rng.integers(1, 6, 2).tolist()}},
        }

        def inside(reach: float = 0.4, at: np.ndarray = at, part: float = part) -> list[float]:
            return [float(x) for x in at + part * size * (0.5 + reach * rng.uniform(-1, 1, 2))]

        kind = rng.choice(["area", "area", "at", "line"])
        dimension = {"area": 2, "at": 0, "line": 1}[kind]
        where = {"area": "all", "at": [inside() for _ in range(rng.integers(1, 5))], "line": [inside(), inside()]}[kind]
        contact: Tables = {"between": [name, below], kind: where}
        if rng.random() < 0.7:
            contact["stiffness"] = float(rigidity / span ** (2 + dimension) * 10 ** rng.uniform(1, 6))
        if rng.random() < 0.3:
            contact["gap"] = float(sag * 10 ** rng.uniform(-2, 0))
        if rng.random() < 0.2:
            contact["limit"] = float(pressure * span ** (2 - dimension) * 10 ** rng.uniform(-0.5, 1))
        drawn["contact"].append(contact)
        if rng.random() < 0.6:
            tie: Tables = {"between": [name, below], "at": [inside() for _ in range(rng.integers(1, 4))]}
            if rng.random() < 0.2:
                tie = {"between": [name, below], "line": [inside(), inside()]}
            tie["resists"] = str(rng.choice(["up", "up", "both"]))
            if rng.random() < 0.7:
                tie["stiffness"] = float(rigidity / span ** (3 if "line" in tie else 2) * 10 ** rng.uniform(0, 5))
            drawn["support"].append(tie)
            if tie["resists"] == "both" and "stiffness" in tie and rng.random() < 0.5:
                drawn["support"] += _straight(rng, tie, sag)
        drawn["load"].append({"plate": name, "pressure": float(pressure * rng.uniform(-0.2, 1.0))})
        drawn["load"].append(
            {"plate": name, "force": float(pressure * span**2 * rng.uniform(-0.1, 0.5)), "at": inside()}
        )


def _straight(rng: np.random.Generator, support: Tables, travel: float) -> list[Tables]:
    """Replace a support's stiffness by a straight law; half of the time divide it between two supports."""
    stiffness, others = support.pop("stiffness"), []
    if not isinstance(stiffness, float):
        support["stiffness"] = stiffness
        return []
    if rng.random() < 0.5:
        share = rng.random()
        others, stiffness = [{**support, "stiffness": float(stiffness * (1.0 - share))}], stiffness * share
    support["law"] = [[0.0, 0.0], [float(travel), float(stiffness * travel)]]
    return others


def with_stiffness(tables: Tables) -> Tables:
    """Replace two-sided straight laws by stiffnesses."""

    def written(support: Tables) -> Tables:
        law = support.get("law", [])
        if len(law) != 2 or support["resists"] != "both" or law[1][0] == 0.0:
            return support
        rest = {key: value for key, value in support.items() if key != "law"}
        return {**rest, "stiffness": law[1][1] / law[1][0]}

    return {**tables, "support": [written(support) for support in tables["support"]]}


def _law(rng: np.random.Generator, travel: float, force: float) -> list[list[float]]:
    """Draw a law of a few pieces: it may begin rigid, have plateaus, and yield at the end."""
    points = [[0.0, 0.0]]
    for piece in range(int(rng.integers(1, 5))):
        run, rise = (rng.random() >= 0.3, 1.0) if not piece else (1.0, rng.random() >= 0.3)
        points.append([points[-1][0] + run * travel * rng.random(), points[-1][1] + rise * force * rng.random()])
    return [[float(t), float(f)] for t, f in points]


class Solution(NamedTuple):
    """Displacements (3n,), reactions (m,), and their relative change if K is rounded differently.

    The change is infinite if the solution is not on the assumed pieces of the laws.
    """

    displacement: np.ndarray
    reaction: np.ndarray
    rounding: float

    @property
    def is_exact(self) -> bool:
        """Whether the solution is accurate enough to judge other solutions."""
        return self.rounding <= _STEADY


class Program:
    """Minimise the potential energy of a problem under a load (3n,), scaled by its stiffness and load.

    min ½ uᵀKu − fᵀu + Σ (F y + k y²/2) subject to Gu − g = t₀ + Σ y. Each y is the travel on a piece of a law, within
    the length of the piece. F is the force at the start of the piece, k its slope, t₀ the travel at the first vertex.
    The multipliers are the reactions.
    """

    def __init__(self, problem: ContactProblem, load: np.ndarray) -> None:
        found, held = problem.discretisation, problem.held
        self.problem, self.laws, self.free = problem, found.contacts, np.flatnonzero(~held)
        load = load + found.spring_rows.T @ (found.springs.stiffness * found.springs.distance)
        K, G, values = problem.K.tocsr(), problem.G.tocsr(), np.where(held, problem.held_values, 0.0)
        self.dof = 1.0 / np.sqrt(K.diagonal()[self.free])
        right = self.dof * (load - K @ values)[self.free]
        rows = (G[:, self.free] @ diags_array(self.dof)).tocsr()
        size = np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel())
        # Points on held dofs only cannot act on the plate.
        self.size = np.where(size > 0.0, size, 1.0)
        gaps = (self.laws.distance - G @ values) / self.size
        self.force = np.abs(right).max() or np.abs(gaps).max(initial=0.0) or 1.0
        self.K = csc_array(diags_array(self.dof) @ K[self.free][:, self.free] @ diags_array(self.dof))
        self.G = csc_array(diags_array(1.0 / self.size) @ rows)
        self.right, self.gap = right / self.force, gaps / self.force

    def vertices(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Vertices (v, 2) of a point's law as travel and force; slopes (v + 1,) before, between and after them."""
        law, unit, scale = self.laws.laws[self.laws.law[i]], self.laws.unit[i], self.laws.scale[i]
        travel, force = unit / (self.force * self.size[i]), scale * self.size[i] / self.force
        slopes = np.array([law.ends[0], *law.slopes[1:-1], law.ends[1]]) if not law.straight else np.array(law.ends)
        return np.array(law.vertices) * [travel, force], slopes * force / travel

    def solve(self) -> Solution | None:
        """Solve the quadratic program; None if no reactions balance the load."""
        n, m = self.K.shape[0], len(self.gap)
        columns, squares, linear, lengths, right = [], [], [], [], self.gap.copy()
        for i in range(m):
            at, slopes = self.vertices(i)
            right[i] += at[0, 0]
            pieces = [(-1.0, at[0, 1], slopes[0], np.inf), (1.0, at[-1, 1], slopes[-1], np.inf)]
            inner = zip(at[:-1], at[1:], slopes[1:-1], strict=True)
            pieces += [(1.0, one[1], slope, other[0] - one[0]) for one, other, slope in inner]
            for way, force, slope, length in pieces:
                if np.isfinite(slope) and length > 0.0:
                    unit = 1.0 / np.sqrt(slope or 1.0)
                    columns.append((i, -way * unit))
                    squares.append(slope * unit**2)
                    linear.append(way * force * unit)
                    lengths.append(length / unit)
        k, lengths = len(columns), np.array(lengths)
        row, value = np.array(columns).reshape(-1, 2).T
        Y = csc_array((value, (row.astype(np.int64), np.arange(k))), shape=(m, k))
        (ends,) = np.nonzero(np.isfinite(lengths))
        longest = csc_array((np.ones(len(ends)), (np.arange(len(ends)), ends)), shape=(len(ends), k))
        A = block_array([[self.G, Y], [None, -eye_array(k)], [csc_array((len(ends), n)), longest]], format="csc")
        b = np.concatenate([right, np.zeros(k), lengths[ends]])
        P = block_array([[self.K, None], [None, diags_array(np.array(squares))]], format="csc")
        cones = [clarabel.ZeroConeT(m), clarabel.NonnegativeConeT(k + len(ends))]
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.tol_infeas_abs = settings.tol_infeas_rel = _PROVEN
        q = np.concatenate([-self.right, np.array(linear)])
        end = clarabel.DefaultSolver(triu(P, format="csc"), q, A, b, cones, settings).solve()
        if "Infeasible" in str(end.status):
            return None
        displacement = np.zeros(len(self.problem.held))
        displacement[self.free] = self.force * self.dof * np.array(end.x[:n])
        return self.sharpened(displacement, self.force * np.array(end.z[:m]) / self.size)

    def sharpened(self, displacement: np.ndarray, reaction: np.ndarray) -> Solution:
        """Solve the linear equations on the law pieces of a solution, until the new solution is on the same pieces."""
        u, r = displacement[self.free] / (self.force * self.dof), reaction * self.size / self.force
        every, before, rounding = [self.vertices(i) for i in range(len(r))], None, np.inf
        matrix, right, x = self.K, self.right, u
        for _ in range(_SHARPER):
            travel = self.G @ u - self.gap
            stretch = travel + r
            pieces = [int((at.sum(axis=1) < s).sum()) for (at, _), s in zip(every, stretch, strict=True)]
            if pieces == before:
                size = max(1.0, np.abs(r).max(initial=0.0))
                left = np.abs(self.K @ u + self.G.T @ r - self.right).max() / size
                # Imbalance that the rounding of displacements causes.
                lost = np.finfo(float).eps * (abs(self.K) @ np.abs(u)).max() / size
                if left <= max(_BALANCED, lost):
                    rounding = max(left, self._rounding(matrix, right, x, len(u)))
                break
            before = pieces
            at = np.array([law[max(piece - 1, 0)] for (law, _), piece in zip(every, pieces, strict=True)]).reshape(
                -1, 2
            )
            slope = np.array([slopes[piece] for (_, slopes), piece in zip(every, pieces, strict=True)])
            holds, flat = np.flatnonzero(slope > 0.0), slope == 0.0
            known = np.where(flat, at[:, 1], 0.0)
            G, compliance = self.G[holds], 1.0 / slope[holds]
            matrix = block_array([[self.K, G.T], [G, -diags_array(compliance)]], format="csc")
            right = np.concatenate(
                [self.right - self.G.T @ known, self.gap[holds] + at[holds, 0] - compliance * at[holds, 1]]
            )
            try:
                factor = splu(matrix)
            except RuntimeError:
                break
            x = factor.solve(right)
            x += factor.solve(right - matrix @ x)
            u, r = x[: len(u)], known
            r[holds] = x[len(u) :]
        displacement = self.problem.held_values.copy()
        displacement[self.free] = self.force * self.dof * u
        return Solution(displacement, self.force * r / self.size, rounding)

    def _rounding(self, matrix: csc_array, right: np.ndarray, x: np.ndarray, n: int) -> float:
        """Relative change of the solution x (n dofs, then reactions) if K is rounded differently.

        K is scaled to a unit diagonal; its entries are sums of element entries of that size.
        """
        noise = self.K.copy()
        noise.data = np.finfo(float).eps * np.random.default_rng(n).choice([-1.0, 1.0], len(noise.data))
        noise.resize(matrix.shape)
        other = csc_array(matrix + noise)
        apart = np.abs(splu(other).solve(right) - x)
        u, moved = self.dof * x[:n], self.dof * apart[:n]
        return float(
            max(
                moved.max() / (np.abs(u).max() or 1.0),
                apart[n:].max(initial=0.0) / (np.abs(x[n:]).max(initial=0.0) or 1.0),
            )
        )


def _loosely(problem: ContactProblem) -> list[str]:
    """Compare the preloads of bolts with their forces in the quadratic program before other loads act."""
    bolts = problem.discretisation.contacts.preload
    program = Program(problem, np.zeros(len(problem.held)))
    solution = program.solve()
    if solution is None or not solution.is_exact:
        return []
    (tight,) = np.nonzero([one.preload is not None for one in problem.discretisation.model.support])
    own = np.isin(problem.discretisation.contacts.support, tight)
    apart = np.abs(solution.reaction - bolts)[own].max() / np.abs(bolts).max()
    return [f"preloads differ by {apart:.1e}"] if apart > TOLERANCE else []


def _otherwise(given: Tables, answer: Answer) -> list[str]:
    """Solve with stiffnesses in place of straight laws; return an error if the deflections differ."""
    other = with_stiffness(given)
    if other == given or answer.not_unique:
        return []
    problem = contact_problem(Model(**other))
    problem = tightened(problem, "all")
    tried = answered(problem, problem.discretisation.cases["load"])
    if not tried.passed:
        return ["not certified by stiffnesses"]
    w, others = (answer.hi + answer.lo)[::3], (tried.answer.hi + tried.answer.lo)[::3]
    apart = np.abs(w - others).max() / (np.abs(w).max() or 1.0)
    return [f"laws and stiffnesses differ by {apart:.1e}"] if apart > TOLERANCE else []


def draw(seed: int) -> tuple[Counter[str], list[str]]:
    """Solve the plate of a seed by `signorini.solve`'s methods and by the quadratic program.

    Return counts of outcomes, and errors.
    """
    given = tables(seed)
    try:
        problem = contact_problem(Model(**given))
    except InputError:
        return Counter({"refused": 1}), []
    load = problem.discretisation.cases["load"]
    try:
        problem = tightened(problem, "all")
    except (InputError, NoEquilibriumError):
        return Counter({"cannot be tightened": 1}), []
    if problem.discretisation.tightening and (wrong := _loosely(problem)):
        return Counter({"solved": 1}), wrong
    program = Program(problem, load.nodal)
    solution = program.solve()
    none = Counter({"no equilibrium": 1, "so the program": int(solution is None)})
    found = ["the program finds one"] if solution is not None and solution.is_exact else []
    try:
        if imbalance(problem.discretisation, problem.freedom, load.weighing) is not None:
            return none, found
    except InputError:
        return Counter({"refused": 1}), found
    tried = answered(problem, load)
    if tried.contradiction:
        return none, found
    if not tried.passed:
        return Counter({"not certified": 1}), [f"{tried.answer.status}, not certified"]
    answer, outcome = tried.answer, Counter({"solved": 1, "by another method": int(len(tried.methods) > 1)})
    wrong = _otherwise(given, answer)
    if solution is None:
        # If the quadratic program found no equilibrium, a solution of all equations refutes it.
        outcome["refuted"] = 1
        solution = program.sharpened(answer.hi + answer.lo, answer.reaction)
        if solution.rounding == np.inf:
            return outcome, ["the program finds no equilibrium"]
    if not solution.is_exact:
        return outcome + Counter({"beyond the judge": 1}), wrong
    w, others = (answer.hi + answer.lo)[::3], solution.displacement[::3]
    for what, is_one, mine, theirs in zip(
        ("deflections", "reactions"),
        methods_agree.unique(problem, answer, np.abs(w).max()),
        (w, answer.reaction),
        (others, solution.reaction),
        strict=True,
    ):
        apart = np.abs(mine - theirs).max(initial=0.0) / (np.abs(mine).max(initial=0.0) or 1.0)
        outcome[what] = int(is_one)
        if is_one and not apart <= TOLERANCE:
            wrong.append(f"{what} differ by {apart:.1e}")
    return outcome, wrong


def show(seed: int) -> None:
    """Print the input of a seed's model."""
    print(json.dumps(tables(seed), indent=1))


if __name__ == "__main__":
    sys.exit(campaign.main(__doc__, draw, show, count=1000, check=40))
