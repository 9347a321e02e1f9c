"""Common code of the property tests: random models, and dense linear algebra that judges their answers."""

from dataclasses import dataclass
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st
from scipy.linalg import null_space
from scipy.optimize import linprog

settings.register_profile(
    "reproducible",
    derandomize=True,
    deadline=None,
    database=None,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.load_profile("reproducible")


def numbers(low, high):
    """Round numbers and any others."""
    eighths, any_others = st.integers(0, 8).map(lambda i: i / 8), st.integers(0, 9973).map(lambda i: i / 9973)
    return st.one_of(eighths, any_others).map(lambda t: low + (high - low) * t)


@st.composite
def plates(draw, shapes=("rectangle", "disc", "annulus")):
    """A small plate and its mesh, with E = 1000."""
    shape = draw(st.sampled_from(shapes))
    common = {
        "shape": shape,
        "thickness": draw(st.sampled_from([0.2, 0.4, "0.3 + 0.02*x"])),
        "element": draw(st.sampled_from(["mitc9", "mitc9", "q8r"])),
    }
    if shape == "rectangle":
        plate = {"size": [4.0, draw(st.sampled_from([2.0, 4.0]))]}
        least = 2 if common["element"] == "q8r" else 1
        divisions = [draw(st.integers(least, 3)), draw(st.integers(least, 3))]
    elif shape == "disc":
        plate = {"radius": 2.0, "sector": draw(st.sampled_from([90, 180, 360]))}
        divisions = [1, 4]
    else:
        plate = {"inner": 0.8, "outer": 2.0, "sector": draw(st.sampled_from([90, 180, 360]))}
        divisions = [1, draw(st.integers(4, 6))]
    return {**common, **plate}, {"divisions": divisions}


@st.composite
def points(draw, plate):
    """A point of the plate, often a node or on its outline."""
    if plate["shape"] == "rectangle":
        a, b = plate["size"]
        return [draw(numbers(0.0, a)), draw(numbers(0.0, b))]
    inner, outer = (0.0, plate["radius"]) if plate["shape"] == "disc" else (plate["inner"], plate["outer"])
    # Parabolas stay a little inside of the circle, or outside.
    r = draw(numbers(inner + 0.03, outer - 0.03))
    angle = np.radians(draw(numbers(0.0, plate["sector"])))
    x, y = float(r * np.cos(angle)), float(r * np.sin(angle))
    return [x, max(0.0, y) if plate["sector"] <= 180 else y]


def edges(plate):
    match plate["shape"]:
        case "rectangle":
            return ["left", "right", "bottom", "top"]
        case "disc":
            return ["rim"] if plate["sector"] == 360 else ["rim", "start", "end"]
        case _:
            return ["inner", "outer"] if plate["sector"] == 360 else ["inner", "outer", "start", "end"]


@st.composite
def places(draw, plate, kinds=("at", "edge", "line", "circle", "area")):
    match draw(st.sampled_from(kinds)):
        case "at":
            return {"at": draw(st.lists(points(plate), min_size=1, max_size=4, unique_by=tuple))}
        case "edge":
            return {"edge": draw(st.sampled_from(edges(plate)))}
        case "line" if plate["shape"] == "rectangle":
            ends = draw(st.lists(points(plate), min_size=2, max_size=2, unique_by=tuple))
            return {"line": ends}
        case "line":
            return {"line": [[0.9, 0.1], [1.3, 0.3]]}
        case "circle":
            return {"circle": {"center": [1.2, 0.8], "radius": draw(st.sampled_from([0.3, 0.45]))}}
        case _:
            return {"area": draw(st.sampled_from(["all", {"rectangle": [0.8, 0.4, 1.3, 0.9]}]))}


@st.composite
def supports(draw, plate, kinds=("at", "at", "edge", "line", "circle", "area"), both=True):
    place = draw(places(plate, kinds))
    fixes = ["simple", "clamped"] if "at" in place else ["simple", "clamped", "hard", "symmetry", ["slope", "w"]]
    if both and "area" not in place and draw(st.integers(0, 3)) == 0:
        support = {**place, "fix": draw(st.sampled_from(fixes))}
        if support["fix"] != "symmetry" and draw(st.booleans()):
            support["settlement"] = draw(st.sampled_from([0.01, -0.02, "0.01*x"]))
        if support["fix"] != "simple" and draw(st.booleans()):
            support["rotation"] = draw(st.sampled_from([[0.01, 0.0], [0.005, -0.01], ["0.01*x", "0.01*y"]]))
        return support
    support = {**place, "resists": draw(st.sampled_from(["down", "down", "up", "both"] if both else ["down", "up"]))}
    for key, values in (
        ("gap", [0.01, 0.1, "0.01*x"]),
        ("stiffness", [50.0, 1e4, "10 + x"]),
        ("settlement", [0.02, -0.03, "0.01*y"]),
    ):
        if draw(st.integers(0, 2)) == 0:
            support[key] = draw(st.sampled_from(values))
    return support


@st.composite
def loads(draw, plate):
    kind = draw(st.sampled_from(["pressure", "force", "line_load", "moment", "self_weight", "curvature"]))
    match kind:
        case "pressure":
            area = draw(st.sampled_from([{}, {"area": {"rectangle": [0.8, 0.4, 1.3, 0.9]}}]))
            return {"pressure": draw(st.sampled_from([1.0, -1.0, "x - 1", "3 - y**2"])), **area}
        case "force":
            return {"force": draw(st.sampled_from([1.0, 5.0, -3.0])), "at": draw(points(plate))}
        case "line_load":
            return {
                "line_load": draw(st.sampled_from([1.0, "x - 1"])),
                **draw(places(plate, ("edge", "line", "circle"))),
            }
        case "moment":
            return {"moment": [draw(st.sampled_from([-1.0, 0.0, 2.0])), 1.0], "at": draw(points(plate))}
        case "self_weight":
            return {"self_weight": True}
        case _:
            return {"curvature": draw(st.sampled_from([[0.01, 0.0, 0.0], [0.0, -0.02, 0.01]]))}


@st.composite
def models(draw, shapes=("rectangle", "disc", "annulus"), **options):
    """A model as the nested tables of an input file; about half of them have an equilibrium."""
    plate, mesh = draw(plates(shapes))
    return {
        "material": {"E": 1000.0, "nu": 0.3, "unit_weight": 2.0},
        "plate": plate,
        "mesh": mesh,
        "support": draw(st.lists(supports(plate, **options), min_size=1, max_size=4)),
        "load": draw(st.lists(loads(plate), min_size=1, max_size=3)),
    }


@dataclass(frozen=True)
class Dense:
    """min ½uᵀKu − fᵀu with Gu + gap − C·reaction = distance, dense and over the free dofs."""

    K: np.ndarray
    f: np.ndarray
    G: np.ndarray
    distance: np.ndarray
    compliance: np.ndarray
    two_sided: np.ndarray
    free: np.ndarray
    whole: float
    """Largest nodal force, those on held dofs included."""

    @classmethod
    def of(cls, problem, load):
        """From the arrays a researcher sees; springs' bases and held values go to the right-hand sides."""
        found = problem.discretisation
        held, values = found.held.dofs, found.held.values
        K, G = problem.K.toarray(), problem.G.toarray()
        springs = found.springs
        f = load + found.spring_rows.T @ (springs.stiffness * springs.distance)
        free = ~held
        return cls(
            K[np.ix_(free, free)],
            (f - K[:, held] @ values[held])[free],
            G[:, free],
            problem.gaps - G[:, held] @ values[held],
            problem.compliance,
            found.contacts.two_sided,
            free,
            np.abs(f).max(initial=0),
        )

    def length(self, u):
        """Reference length: where supports leave no deflection, a part of F L²/D."""
        soft = 1e-6 * np.abs(self.f).sum() / np.diag(self.K).min(initial=np.inf)
        return max(np.abs(u).max(initial=0), np.abs(self.distance).max(initial=0), soft, 1e-300)

    def violations(self, u, reaction):
        """Equilibrium, penetration, tension and complementarity, each relative to its own size."""
        gap = self.distance - self.G @ u + self.compliance * reaction
        one = ~self.two_sided
        length = self.length(u)
        # Lengths are rounded to 1e-16 and forces judged to 1e-8: where loads cancel to the last bit, no force is less.
        least = 1e-8 * np.diag(self.K).max(initial=0) * length
        force = max(self.whole, np.abs(reaction).max(initial=0), least, 1e-300)
        penetration = max(-gap[one].min(initial=0), np.abs(gap[~one]).max(initial=0))
        # The rounding of K·u is relative to the terms that cancel.
        magnitude = (np.abs(self.K) @ np.abs(u)).max(initial=0)
        out = np.abs(self.K @ u + self.G.T @ reaction - self.f).max(initial=0)
        return {
            "equilibrium": out / max(force, 1e-5 * magnitude),
            "penetration": penetration / length,
            "tension": -reaction[one].min(initial=0) / force,
            "complementarity": np.abs(gap[one] * reaction[one]).max(initial=0) / force / length,
        }

    @property
    def redundant(self):
        """Whether rigid points hold the same thing twice, so that their reactions are not unique."""
        scale = 1 / np.sqrt(np.diag(self.K).clip(1e-12))
        rigid = self.G[self.compliance == 0] * scale
        norms = np.linalg.norm(rigid, axis=1)
        if not len(rigid) or not norms.all():
            return bool(len(rigid))
        values = np.linalg.svd(rigid / norms[:, None], compute_uv=False)
        return len(rigid) > rigid.shape[1] or values[-1] < 1e-6

    def states(self):
        """Every contact state whose equations are regular and whose signs hold: displacements, reactions, condition."""
        n, one = len(self.f), np.flatnonzero(~self.two_sided)
        scale = 1 / np.sqrt(np.diag(self.K).clip(1e-12))
        for chosen in product([False, True], repeat=len(one)):
            closed = self.two_sided.copy()
            closed[one] = chosen
            G = self.G[closed]
            k = len(G)
            kkt = np.block([[self.K, G.T], [G, -np.diag(self.compliance[closed])]])
            weight = np.concatenate([scale, np.ones(k)])
            if k:
                weight[n:] = 1 / np.sqrt((G * scale) ** 2 @ np.ones(n)).clip(1e-12)
            kkt = weight[:, None] * kkt * weight
            right = weight * np.concatenate([self.f, self.distance[closed]])
            values = np.linalg.svd(kkt, compute_uv=False)
            if len(values) and values[-1] < 1e-11 * values[0]:
                continue
            solution = np.linalg.solve(kkt, right)
            rest = (right - kkt.astype(np.longdouble) @ solution).astype(float)
            solution = weight * (solution + np.linalg.solve(kkt, rest))
            u, reaction = solution[:n], np.zeros(len(self.G))
            reaction[closed] = solution[n:]
            if max(v for name, v in self.violations(u, reaction).items() if name != "equilibrium") < 1e-9:
                yield u, reaction, values[0] / values[-1] if len(values) else 1.0

    def pins(self, reaction):
        """Whether pressed points and stiffness leave no rigid motion: then the displacements are unique."""
        load = max(np.abs(reaction).max(initial=0), np.abs(self.f).max(initial=0))
        pressed = self.two_sided | (reaction > 1e-7 * load)
        scale = 1 / np.sqrt(np.diag(self.K).clip(1e-12))
        rows = np.vstack([scale[:, None] * self.K * scale, self.G[pressed] * scale])
        values = np.linalg.svd(rows, compute_uv=False)
        return values[-1] > 1e-8 * values[0] if len(values) else True


def balanced(problem, load):
    """Whether reactions of the right sign balance the load, by a linear program over every support there is.

    Held dofs, springs and two-sided points may push and pull.
    """
    found = problem.discretisation
    size = found.mesh.size
    motions = found.rigid_motions / np.array([1.0, size, size])
    one = ~found.contacts.two_sided
    G = problem.G.toarray()
    rows, elements = found.springs.rows, found.mesh.elements
    springs = np.zeros((len(rows), found.dof_count))
    np.add.at(springs, (np.arange(len(rows))[:, None], rows.dofs(elements)), rows.coefficients)
    held = np.eye(found.dof_count)[found.held.dofs]
    both = np.vstack([held, G[~one], springs]) @ motions
    free = null_space(both, rcond=1e-9) if len(both) else np.eye(3)
    if not free.size:
        return True
    target = motions.T @ load @ free
    total = np.abs(load[::3]).sum() + np.abs(load.reshape(-1, 3)[:, 1:]).sum() / size
    if total == 0:
        return True
    answer = (
        linprog(
            np.zeros(one.sum()), A_eq=(G[one] @ motions @ free).T, b_eq=target / total, bounds=(0, None), method="highs"
        )
        if one.any()
        else None
    )
    if answer is None:
        return bool(np.abs(target).max() < 1e-9 * total)
    return answer.status == 0


@pytest.fixture(scope="session")
def drawing():
    return SimpleNamespace(models=models, plates=plates, points=points, supports=supports, loads=loads, numbers=numbers)


@pytest.fixture(scope="session")
def dense():
    return Dense


@pytest.fixture(scope="session")
def equilibrium_exists():
    return balanced
