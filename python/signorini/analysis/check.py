"""Check of a model before it is solved: number of elements, resultants of loads, equilibrium, and a picture."""

from __future__ import annotations

import os
import sys
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self

import numpy as np

from signorini.analysis.checks import require_checks
from signorini.analysis.tightening import loosened
from signorini.base.files import require_unread
from signorini.base.linear_program import minimise
from signorini.base.provenance import PROGRAM
from signorini.base.regular import open_regular
from signorini.discretise import Discretisation, discretise
from signorini.discretise.rows import Floats
from signorini.equilibrium.balance import NO_FORCE, RigidFreedom, rigid_freedom, work_of
from signorini.equilibrium.imbalance import WORK, Imbalance, explain, imbalance_of, nearest_limit, on_the_brink
from signorini.errors import InputError
from signorini.mesh.isoparametric import are_degenerate
from signorini.mesh.mesh import Mesh
from signorini.model import Combination, Model
from signorini.results import marks
from signorini.results.warnings import idle_cases, model_warnings, no_resultant
from signorini.singularities.named import singularities
from signorini.singularities.singularity import Singularity

if TYPE_CHECKING:
    from signorini.plot.pictures import Figure


@dataclass(frozen=True)
class Quality:
    """Smallest angle of an element in degrees, its corner (x, y), and the share of area in quadrilaterals."""

    angle: float
    corner: tuple[float, float]
    quadrilaterals: float

    def __str__(self) -> str:
        """Return the smallest angle and the share of quadrilaterals as a sentence."""
        return f"smallest angle {self.angle:.3g}°, {100 * self.quadrilaterals:.4g} % of the area in quadrilaterals"

    @classmethod
    def of(cls, mesh: Mesh) -> Self:
        """Measure the angles of a mesh, in degrees, between straight lines from corner to corner of an element."""
        at = mesh.nodes[:, :4]
        onward, back = np.roll(at, -1, axis=1) - at, np.roll(at, 1, axis=1) - at
        # A triangle is stored with its third corner twice, a degenerate quadrilateral with its first corner twice.
        # At a repeated corner the side of length zero is replaced by the next side, so that the angle is defined.
        third, first = mesh.triangles, are_degenerate(mesh.elements)
        onward[third, 2], back[third, 3] = onward[third, 3], back[third, 2]
        onward[first, 0], back[first, 1] = onward[first, 1], back[first, 0]
        area = onward[..., 0] * back[..., 1] - onward[..., 1] * back[..., 0]
        angle = np.degrees(np.arctan2(area, (onward * back).sum(axis=-1))) % 360.0
        # Equal right angles differ by rounding. After rounding to nine digits `argmin` takes the first of equal angles.
        element, corner = np.unravel_index(np.argmin(angle.round(9)), angle.shape)
        x, y = at[element, corner].tolist()
        share = float(mesh.element_area[~third].sum() / mesh.element_area.sum())
        return cls(float(angle.round(9)[element, corner]), (x, y), share)


_FORMATS = (".png", ".svg", ".pdf")
_HEAD = 1000
"""Number of bytes at the beginning of a picture's file that contain its metadata."""

ASKED = 20
"""Number of rows of a table for which the limit of equilibrium is computed; it takes a linear program for each load
case.
"""


@dataclass(frozen=True)
class Resultant:
    """Resultant of the load of one combination, and whether reactions can balance this load."""

    name: str
    force: float
    """Sum of the vertical forces of the load, positive down."""
    at: tuple[float, float] | None
    """Point (x, y) at which ``force`` alone has the same moments as the load; None if the forces sum to zero."""
    couple: tuple[float, float]
    """Moments Σ F (x − x₀) and Σ F (y − y₀) of the load, couples included, about the middle (x₀, y₀) of the plate."""
    message: str
    """Reason why no reactions balance the load; empty if reactions can balance it."""
    brink: bool
    """Whether equilibrium is marginal: an arbitrarily small change of the load can end it. For rows of a table, this is
    computed for the first twenty. The limit is also computed for rows without equilibrium."""
    limit: tuple[str, float] | None
    """Nearest limit of equilibrium: a load case, and the number by which its factor is multiplied to reach the limit,
    with the other cases unchanged.
    """
    axis: tuple[tuple[float, float], tuple[float, float]] | None
    """End points of a segment of the axis about which the plate tips; None if it does not tip."""


@dataclass(frozen=True, eq=False)
class Check:
    """A model with its mesh, supports and resultants, before the solution."""

    discretisation: Discretisation
    resultants: tuple[Resultant, ...]

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about questionable input and about resultants of loads."""
        discretisation, model = self.discretisation, self.discretisation.model
        loads = () if model.tabulated else map(discretisation.load, model.effective_combinations)
        said = [*model_warnings(discretisation, self._acting), *idle_cases(model)]
        said += [sentence for load in loads for sentence in no_resultant(discretisation, load)]
        return tuple(dict.fromkeys(said))

    @property
    def singular(self) -> tuple[Singularity, ...]:
        """Singularities under the load cases in use, at which results grow without limit as the mesh is refined."""
        return singularities(self.discretisation, self._acting)

    @property
    def _acting(self) -> Collection[str]:
        """Names of the load cases that occur in at least one combination."""
        model = self.discretisation.model
        combinations = model.effective_combinations
        if model.tabulated:
            return combinations.cases
        return {case for one in combinations for case in one.acting}

    @property
    def quality(self) -> str:
        """Sentence with the smallest angle of an element, and the share of the plate's area in quadrilaterals."""
        return str(Quality.of(self.discretisation.mesh))

    @property
    def balanced(self) -> bool:
        """Whether reactions can balance every combination."""
        return not any(resultant.message for resultant in self.resultants)

    def save_picture(self, path: str | os.PathLike[str], numbers: bool = False) -> list[Path]:
        """Draw mesh, supports, loads, resultants and tipping axes to a file, and return the paths of the files.

        The suffix of ``path`` gives the format. With ``numbers`` nodes are numbered from 1, as in ``reactions.csv``. If
        there are several plates, each has its own file, see `pictures_of`.
        """
        # This import loads matplotlib, which is needed for pictures only.
        from signorini.plot.files import save

        require_picture(path, self.discretisation.model)
        files = pictures_of(self.discretisation.model, path)
        try:
            for file, plate in zip(files, self.discretisation.each, strict=True):
                save(self._picture(plate, numbers), file, plate.model.provenance.metadata)
        except FileNotFoundError:
            raise InputError(f"there is no directory {Path(path).parent} to write the picture to.", str(path)) from None
        except OSError as error:
            raise InputError(f"the picture cannot be written: {error.strerror or error}.", str(path)) from None
        return files

    def _picture(self, discretisation: Discretisation, numbers: bool) -> Figure:
        """Draw the picture of one plate."""
        from signorini.plot.picture import BalanceMark
        from signorini.plot.pictures import check_picture
        from signorini.plot.plan import Plan

        alone = discretisation is self.discretisation
        named = singularities(discretisation, self._acting)
        return check_picture(
            Plan(discretisation.mesh.points, discretisation.mesh.elements),
            bedding=marks.bedding_panel(discretisation),
            zones=marks.zone_marks(discretisation),
            supports=marks.unsolved_marks(discretisation),
            loads=marks.load_marks(discretisation),
            cuts=marks.cut_marks(discretisation.model),
            totals=marks.case_totals(discretisation),
            edges=marks.edge_marks(discretisation.mesh),
            singular=marks.singular_marks(named),
            poorest=(Quality.of(discretisation.mesh).corner, str(Quality.of(discretisation.mesh))),
            balance=[BalanceMark(r.name, r.at, r.force < 0, bool(r.message), r.axis) for r in self.resultants if alone],
            title=discretisation.model.title,
            length=discretisation.model.units.length,
            numbers=numbers,
        )


def pictures_of(model: Model, path: str | os.PathLike[str]) -> list[Path]:
    """Paths of a model's pictures: ``path`` or, for several plates, one path each, which ends with the plate's name."""
    file = Path(path)
    return [file.with_name(f"{file.stem}-{name}{file.suffix}") for name in model.plates] or [file]


def require_picture(path: str | os.PathLike[str], model: Model) -> None:
    """Raise `InputError` if a file's suffix is not that of a picture format, or the model is read from the file."""
    suffix = Path(path).suffix.lower()
    if suffix not in _FORMATS:
        raise InputError(f'found the suffix "{suffix}"; a picture ends in {", ".join(_FORMATS)}.', str(path))
    for file in pictures_of(model, path):
        try:
            require_unread(file, model.provenance.read)
        except OSError as error:
            why = f"the picture cannot be written: {error.strerror}. Name another file."
            raise InputError(why, str(file)) from None


def require_free(path: str | os.PathLike[str]) -> None:
    """Raise `InputError` if a file exists and its metadata do not say that signorini drew it."""
    if not os.path.lexists(path):
        return
    try:
        with open_regular(path, sys.maxsize) as file:
            ours = PROGRAM.encode() in file.read(_HEAD)
    except OSError:
        ours = False
    if not ours:
        raise InputError(
            "this file exists, and signorini did not draw it. Move it, or name another file with -o.",
            str(path),
        )


def check(model: Model) -> Check:
    """Mesh a model, place its supports and loads, and find out whether reactions can balance each combination.

    Examples
    --------
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     support=[{"at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}],
    ...     load=[{"force": 20e3, "at": [2, 1.5]}],
    ... )
    >>> result = check(model)
    >>> result.balanced, round(result.resultants[0].force, 6), result.resultants[0].at
    (True, 20000.0, (2.0, 1.5))
    """
    discretisation = discretise(model)
    require_checks(discretisation)
    freedom = rigid_freedom(discretisation)
    if model.tabulated:
        return Check(discretisation, tuple(_resultants(discretisation, freedom)))
    return Check(discretisation, tuple(_resultant(discretisation, freedom, c) for c in model.effective_combinations))


def _resultants(discretisation: Discretisation, freedom: RigidFreedom) -> Iterator[Resultant]:
    """Yield the resultants of many combinations, as sums of the resultants of load cases."""
    combinations = discretisation.model.effective_combinations
    used = combinations.cases
    weighing = {case: discretisation.cases[case].weighing for case in discretisation.cases if case in used}
    of_case = {case: _sums(discretisation, load) for case, load in weighing.items()}
    size = {case: float(np.abs(load[::3]).sum()) for case, load in weighing.items()}
    unbalanced = _unbalanced(discretisation, freedom, weighing)
    for number, combination in enumerate(combinations):
        if number < ASKED:
            yield _resultant(discretisation, freedom, combination)
            continue
        factors = combination.factors or {}
        resultant = _superposed(of_case, factors, np.zeros(3))
        total = sum(abs(factor) * size[case] for case, factor in factors.items())
        why = unbalanced.get(number)
        yield _of(discretisation, combination, resultant, total, why, limit=None if why is None else why.limit)


def _unbalanced(
    discretisation: Discretisation, freedom: RigidFreedom, weighing: Mapping[str, Floats]
) -> dict[int, Imbalance]:
    """Reasons why reactions cannot balance combinations after the first `ASKED`, by row number of the combination.

    Loads that reactions can balance are a convex set. The work of each load on the free rigid motions is known. A
    linear program over all points is solved only if this work is outside the convex hull of the work of loads known to
    be balanced.
    """
    of_case = {case: work_of(discretisation, freedom, load) for case, load in weighing.items()}
    combinations, nothing = discretisation.model.effective_combinations, np.zeros(freedom.count)
    works = {
        number: _superposed(of_case, combination.factors or {}, nothing)
        for number, combination in enumerate(combinations)
        if number >= ASKED
    }
    largest = max((float(np.abs(work).max(initial=0.0)) for work in works.values()), default=0.0) or 1.0
    hull, result = [np.append(np.zeros(freedom.count), 1.0)], dict[int, Imbalance]()
    for number in sorted(works, key=lambda number: -np.abs(works[number]).max(initial=0.0)):
        vertex = np.append(works[number] / largest, 1.0)
        if minimise(np.zeros(len(hull)), np.array(hull).T, (vertex, vertex), (0.0, np.inf), WORK) is not None:
            continue
        why = imbalance_of(discretisation, freedom, combinations[number])
        if why is None:
            hull.append(vertex)
        else:
            result[number] = why
    return result


def _superposed(of_case: Mapping[str, Floats], factors: Mapping[str, float], zero: Floats) -> Floats:
    """Sum of the load cases' vectors times their ``factors``; ``zero`` if ``factors`` is empty."""
    return sum((factor * of_case[case] for case, factor in factors.items()), zero)


def _sums(discretisation: Discretisation, nodal: Floats) -> Floats:
    """Resultant (force, mx, my) of a nodal load (3n,) about the middle of the mesh, summed over all plates."""
    return np.asarray((discretisation.rigid_motions.T @ nodal).reshape(-1, 3).sum(axis=0))


def _resultant(discretisation: Discretisation, freedom: RigidFreedom, combination: Combination) -> Resultant:
    weighing = discretisation.load(combination).weighing
    why = imbalance_of(discretisation, freedom, combination)
    brink = why is None and on_the_brink(discretisation, freedom, weighing)
    limit = nearest_limit(discretisation, freedom, combination) if why is None else why.limit
    total = float(np.abs(weighing[::3]).sum())
    return _of(discretisation, combination, _sums(discretisation, weighing), total, why, brink, limit)


def _of(
    discretisation: Discretisation,
    combination: Combination,
    resultant: Floats,
    total: float,
    why: Imbalance | None,
    brink: bool = False,
    limit: tuple[str, float] | None = None,
) -> Resultant:
    least = NO_FORCE * total * np.array([1.0, discretisation.mesh.size, discretisation.mesh.size])
    force, mx, my = (float(part) for part in np.where(np.abs(resultant) > least, resultant, 0.0))
    at = None
    if force:
        size = discretisation.mesh.size
        x, y = ((discretisation.middle + np.array([mx, my]) / force) / size).round(12) * size + 0.0
        at = (float(x), float(y))
    axis = None
    if why is not None and why.axis is not None:
        (ax, ay), (bx, by) = why.axis.ends(discretisation.middle, discretisation.mesh.size).tolist()
        axis = (ax, ay), (bx, by)
    tightening = discretisation.model.round_factors(combination.factors or {})
    message = explain(discretisation, why) or loosened(discretisation, tightening)
    return Resultant(combination.name, force, at, (mx, my), message, brink, limit, axis)
