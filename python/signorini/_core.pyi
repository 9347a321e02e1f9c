from collections.abc import Callable, Sequence
from typing import Literal, TypedDict, final

import numpy as np
import numpy.typing as npt

_Floats = npt.NDArray[np.float64]
_Ints = npt.NDArray[np.int64]
_Bools = npt.NDArray[np.bool_]
_Springs = tuple[_Ints, _Floats, _Ints, _Floats, _Floats]
_Laws = Sequence[tuple[Sequence[tuple[float, float]], tuple[float, float]]]
_Pieces = npt.NDArray[np.uint8]
_Form = Literal["dual", "stiffness"] | None

class _ContactPoints(TypedDict):
    elements: _Ints
    rows: _Floats
    further: _Ints
    distance: _Floats
    law: _Ints
    scale: _Floats
    unit: _Floats
    regularization: _Floats

__all__ = [
    "CombinedCases",
    "ContactProblem",
    "ContactSolution",
    "LcpSolution",
    "Plate",
    "Response",
    "__version__",
    "combine",
    "combined_cases",
    "envelop",
    "evaluate",
    "lemke",
    "load_responses",
    "map_points",
    "mesh_outline",
    "nodal_forces",
    "point_responses",
    "rest_response",
    "section_points",
    "serendipity",
    "shape_values",
    "solution_stresses",
    "solve_together",
    "superpose",
    "triangular",
]

__version__: str

def serendipity(xi: _Floats) -> tuple[_Floats, _Floats]: ...
def triangular(xi: _Floats) -> tuple[_Floats, _Floats]: ...
def shape_values(elements: _Ints, of: _Ints, xi: _Floats) -> _Floats: ...
def map_points(points: _Floats, elements: _Ints, of: _Ints, xi: _Floats) -> _Floats: ...
def nodal_forces(node_count: int, elements: _Ints, of: _Ints, xi: _Floats, forces: _Floats) -> _Floats: ...
def section_points(kind: str, triangle: bool = False) -> _Floats: ...
def lemke(
    matrix: _Floats,
    q: _Floats,
    covering: _Floats | None = None,
    max_pivots: int | None = None,
    start: _Bools | None = None,
) -> LcpSolution: ...
def mesh_outline(
    loops: list[tuple[_Floats, _Floats, list[str]]],
    size: float,
    refinements: _Floats,
    lines: _Floats,
    points: _Floats,
    most: int,
    axes: list[list[float]],
) -> tuple[_Floats, _Ints, _Ints, _Ints]: ...
def rest_response(problem: ContactProblem, held_value: _Floats) -> Response: ...
def load_responses(problem: ContactProblem, loads: _Floats) -> list[Response]: ...
def point_responses(problem: ContactProblem, first: int, end: int) -> list[Response]: ...
def combined_cases(
    problem: ContactProblem, rest: Response, cases: list[Response], points: list[Response]
) -> CombinedCases: ...
def combine(
    problem: ContactProblem, cases: CombinedCases, factors: _Floats
) -> tuple[_Ints, _Floats, _Floats, _Floats, _Bools, _Ints]: ...
def solve_together(
    problem: ContactProblem,
    start: ContactSolution | None,
    loads: _Floats,
    held_value: _Floats,
    progress: Callable[[], object] | None = None,
) -> list[ContactSolution]: ...
def solution_stresses(
    plate: Plate, solutions: list[ContactSolution], curvatures: _Floats, couples: _Floats
) -> _Floats: ...
def superpose(coefficients: _Floats, vectors: _Floats) -> _Floats: ...
def envelop(
    coefficients: _Floats,
    inputs: Sequence[_Floats],
    formulas: Sequence[str],
    wanted: Sequence[int],
    thickness: _Floats,
    bars: Sequence[float],
    who: _Ints,
    bounds: Sequence[tuple[_Floats, _Ints, _Floats, _Ints]],
    classes: _Ints,
    left_out: _Bools,
) -> tuple[_Floats, _Ints]: ...
def evaluate(name: str, inputs: _Floats, thickness: _Floats, bars: Sequence[float]) -> _Floats: ...

@final
class LcpSolution:
    @property
    def z(self) -> _Floats: ...
    @property
    def w(self) -> _Floats: ...
    @property
    def basis(self) -> _Bools: ...
    @property
    def status(self) -> Literal["solved", "ray", "pivot_limit"]: ...
    @property
    def pivots(self) -> int: ...
    @property
    def ray(self) -> _Floats | None: ...
    @property
    def message(self) -> str: ...

@final
class Plate:
    def __new__(
        cls,
        points: _Floats,
        elements: _Ints,
        thickness: float | _Floats,
        young: float,
        rigidities: _Floats,
        kind: str,
        frames: _Floats | None = None,
        layered: tuple[_Ints, _Floats] | None = None,
        others: tuple[_Ints, _Floats, _Floats] | None = None,
        stress_elements: _Ints | None = None,
        leaders: _Ints | None = None,
    ) -> Plate: ...
    @property
    def dof_count(self) -> int: ...
    def interpolation_rows(self, elements: _Ints, xi: _Floats, field: int) -> tuple[_Floats, _Floats]: ...
    def curvature_load(self, curvature: tuple[float, float, float]) -> tuple[_Floats, _Floats]: ...
    def residual(self, spring_arrays: _Springs, load: _Floats, hi: _Floats, lo: _Floats) -> _Floats: ...
    def openings(
        self, elements: _Ints, rows: _Floats, further: _Ints, distance: _Floats, hi: _Floats, lo: _Floats
    ) -> _Floats: ...
    def moved(
        self, hi: _Floats, lo: _Floats, center: tuple[float, float], motion: tuple[float, float, float]
    ) -> tuple[_Floats, _Floats]: ...
    def internal_magnitude(self, held: _Bools, hi: _Floats, lo: _Floats) -> float: ...
    def stresses(
        self, hi: _Floats, lo: _Floats, curvature: tuple[float, float, float], couples: _Floats
    ) -> tuple[_Floats, _Floats]: ...
    def element_forces(
        self, elements: _Ints, hi: _Floats, lo: _Floats, curvature: tuple[float, float, float], couples: _Floats
    ) -> tuple[_Floats, _Floats]: ...
    def strain_rows(self, elements: _Ints) -> _Floats: ...
    def stiffness_matrix(self, spring_arrays: _Springs) -> tuple[_Ints, _Ints, _Floats]: ...
    def element_stiffness(self) -> _Floats: ...

@final
class ContactProblem:
    def __new__(
        cls,
        plate: Plate,
        held: _Bools,
        spring_arrays: _Springs,
        points: _ContactPoints,
        laws: _Laws,
        free_motions: _Floats | None = None,
        method: Literal["lemke", "active_set", "saddle"] = "lemke",
        room: int | None = None,
        like: ContactProblem | None = None,
    ) -> ContactProblem: ...
    def with_distance(self, distance: _Floats) -> ContactProblem: ...
    def solve(
        self,
        load: _Floats,
        held_value: _Floats,
        form: _Form = None,
        start: ContactSolution | None = None,
        progress: Callable[[int, int, float], object] | None = None,
    ) -> ContactSolution: ...
    def solve_and_factor(
        self, load: _Floats, held_value: _Floats, progress: Callable[[int, int, float], object] | None = None
    ) -> ContactSolution | None: ...
    def solve_on(self, load: _Floats, held_value: _Floats, pieces: _Pieces) -> ContactSolution: ...
    def path(
        self,
        start: _Floats,
        add: _Floats,
        held_value: _Floats,
        end: float,
        visit: Callable[[float, _Ints, ContactSolution], object],
        progress: Callable[[int, int, float], object] | None = None,
    ) -> Literal["reached", "unbounded", "no_equilibrium", "too_many", "unsolved"]: ...
    def lcp(self, load: _Floats, held_value: _Floats, form: _Form = None) -> tuple[_Floats, _Floats, _Ints, _Bools]: ...
    def apply_inverse(self, load: _Floats) -> _Floats: ...
    @property
    def seconds(self) -> tuple[float, float, float]: ...
    @property
    def factor_entries(self) -> int: ...
    @property
    def factor_flops(self) -> float: ...

@final
class ContactSolution:
    @property
    def status(self) -> Literal["solved", "no_equilibrium", "unsolved"]: ...
    @property
    def hi(self) -> _Floats: ...
    @property
    def lo(self) -> _Floats: ...
    @property
    def reaction(self) -> _Floats: ...
    @property
    def gap(self) -> _Floats: ...
    @property
    def closed(self) -> _Bools: ...
    @property
    def piece(self) -> _Pieces: ...
    @property
    def pivots(self) -> int: ...
    @property
    def iterations(self) -> int: ...
    @property
    def gradients(self) -> int: ...
    @property
    def factorizations(self) -> int: ...
    @property
    def corrections(self) -> int: ...

@final
class Response:
    @property
    def hi(self) -> _Floats: ...
    @property
    def lo(self) -> _Floats: ...
    @property
    def reaction(self) -> _Floats: ...
    @property
    def moved(self) -> _Floats: ...
    def at_points(self) -> Response: ...

@final
class CombinedCases: ...
