"""Coverage of half-widths: a random plate, compared with a mesh finer than those of its half-widths."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from random import Random

import numpy as np
import random_models

from signorini import Model, SignoriniError, contact_problem, estimate, solve, validate
from signorini.accuracy.comparison import Estimate
from signorini.accuracy.half_width import sizes_of
from signorini.analysis.single import solve_one
from signorini.discretise import discretise
from signorini.mesh import Mesh
from signorini.mesh.meshers import divided
from signorini.results.result import Result

_FINER = 3
"""Smallest ratio of element counts of the reference mesh and the finest mesh of the half-widths."""
_ROUNDING = 1e-7
"""Change that counts as rounding, relative to the largest number of its kind: fine meshes have more rounding."""


@dataclass(frozen=True)
class Judged:
    """A number, its half-width (None: no limit), and its true change on the reference mesh."""

    what: str
    kind: str
    width: float | None
    change: float
    rounding: float

    @property
    def covered(self) -> bool:
        """Whether the half-width covers the change."""
        return self.width is None or self.change <= self.width + self.rounding


def plate(seed: int, least: int = 8, most: int = 16) -> Model:
    """Draw a plate with a given number of elements along a side, and three probes."""
    rng, others = Random(seed), Random(-seed - 1)
    tables = random_models.model(rng)
    if "divisions" in tables["mesh"]:
        scale = others.choice([3, 4, 5])
        tables["mesh"]["divisions"] = [min(max(least, scale * n), most) for n in tables["mesh"]["divisions"]]
    else:
        tables["mesh"]["size"] = random_models.extent(tables["plate"]) / others.randint(least, most)
    drawn = (random_models.point(others, tables["plate"]) for _ in range(100))
    on = (at for at in drawn if random_models.on_plate(tables["plate"], at))
    tables["probe"] = [{"at": list(islice(on, 3))}]
    tables["output"] = {"combinations": "each"}
    # This is drawn last, so that it does not affect the other choices of the seed.
    if others.random() < 0.2:
        _overlap(others, tables)
    return validate(tables)


def _overlap(rng: Random, tables: random_models.Tables) -> None:
    """Load the plate on footprints that overlap."""
    (x, y), room = random_models.middle(rng, tables["plate"])
    a, b = (room * rng.choice([0.3, 0.8]) for _ in range(2))
    first = {**tables["load"][0]}
    force = abs(float(first.get("force", 0.0))) or _weight(tables)
    at = [[x, y], [x + 0.4 * a, y + rng.choice([0.0, 0.3]) * b]]
    case = {"case": first["case"]} if "case" in first else {}
    tables["load"].append(
        case | {"force": force, "at": at} | rng.choice([{"patch": [a, b]}, {"radius": 0.5 * min(a, b)}])
    )


def _weight(tables: random_models.Tables) -> float:
    """A force that bends the plate by a thousandth of its size."""
    size = random_models.extent(tables["plate"])
    given = tables["plate"].get("stiffness")
    thickness = float(str(tables["plate"]["thickness"]).split("*")[0].strip("()"))
    rigidity = given["Dx"] if given else tables["material"]["E"] * thickness**3 / 12
    return float(1e-3 * rigidity / size)


def judged(seed: int, least: int = 8, most: int = 16) -> list[Judged]:
    """Judge the numbers of up to two combinations; empty if the seed gives no plate with an answer."""
    try:
        model = plate(seed, least, most)
        # Without a load all numbers are zero but for rounding.
        acting = [one for one in model.effective_combinations if one.factors is None or any(one.factors.values())]
        names = [one.name for one in acting][:2]
        only = {"combination": tuple(one for one in model.effective_combinations if one.name in names)}
        model = model.model_copy(update=only)
        found = [one for one in estimate(solve(model)).values() if one.elements]
        if not found:
            return []
        finest = contact_problem(discretise(*_finer(model, max(one.elements[0] for one in found))))
        return [
            number
            for one in found
            if one.result.combination is not None
            for number in _compared(one, solve_one(finest, one.result.combination))
        ]
    except SignoriniError:
        return []


def _finer(model: Model, count: int) -> tuple[Model, Mesh]:
    """Model and mesh with a quarter or an eighth of the element size; if still too coarse, with elements divided."""
    for part in (0.25, 0.125):
        fine = model.model_copy(update={"mesh": model.plate.scaled(model.mesh, part, model.divisions)})
        mesh = discretise(fine).mesh
        if len(mesh.elements) >= _FINER * count:
            return fine, mesh
    return fine, divided(mesh)


def _compared(found: Estimate, truth: Result) -> Iterator[Judged]:
    if truth.status != "solved":
        return
    ours = found.result
    numbers, true = ours.catalogue.numbers, truth.catalogue.by_path
    largest = sizes_of(ours.numbers[:, None], numbers, ours.model, ours.mesh)
    for one, value, width in zip(numbers, ours.numbers.tolist(), found.widths.tolist(), strict=True):
        if one.path in true and one.estimated and one.quantity.kind != "count":
            kind, change = one.quantity.kind, abs(value - truth.numbers[true[one.path]])
            within = None if np.isnan(width) else width
            yield Judged(f"{ours.name}: {one.column}", kind, within, change, _ROUNDING * largest[kind].item())
