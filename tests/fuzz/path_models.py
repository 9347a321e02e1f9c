"""Random models for load paths, with a constant and a growing load case.

They are models of random_models.py with two cases. A tenth of them also have a stop far away. Some are round plates
that touch a ring or a bed all around at nearly one t, in any unit of force. Half of them are extreme: a load without a
resultant, factors up to 1e8, supports that only an absurdly large load reaches, or a plate that rests on a rigid area
under its weight.
"""

from __future__ import annotations

from random import Random
from typing import Any

import random_models

Tables = dict[str, Any]
Question = tuple[Tables, str | None, str, float | None, bool]
"""A model, the names of its constant and its growing load, the largest t, and whether it is extreme."""


def drawn(seed: int) -> Question:
    """Draw a model with a constant and a growing load case, the largest t, and whether the model is extreme."""
    if (own := Random(f"round {seed}")).random() < 0.05:
        return _round(own), own.choice(["G", None]), "Q", None, False
    rng = Random(seed)
    tables = random_models.model(rng)
    loads = tables["load"]
    if len(loads) == 1:
        loads.append(dict(loads[0]))
    for i, load in enumerate(loads):
        load["case"] = "Q" if i == len(loads) - 1 else "G"
    if _unlike(loads[-1]) == _unlike(loads[0]) or rng.random() < 0.4:
        _shift(rng, tables)
    tables["combination"] = [
        {"name": "less", "factors": {"Q": -1.0}},
        {"name": "both", "factors": {"G": 1.0, "Q": 1.0}},
    ]
    tables["solver"] = {"method": rng.choice(["auto", "auto", "lemke", "active_set"])}
    start = rng.choice(["G", "G", "G", None, "both"])
    add, until = rng.choice(["Q", "Q", "less", "both"]), rng.choice([None, None, 3.0])
    if rng.random() < 0.5:
        if rng.random() < 0.2:
            tables["support"].append(_far_stop(rng, tables["plate"]))
        return tables, start, add, until, False
    tables.pop("output", None)
    _extreme(rng, tables)
    return tables, start, add, rng.choice([until, None, 10.0 ** rng.uniform(-6, 15)]), True


def _unlike(load: Tables) -> Tables:
    return {key: value for key, value in load.items() if key != "case"}


def _round(rng: Random) -> Tables:
    """A round plate held at its rim above a ring or a bed, which it touches all around at nearly one t."""
    gap, thickness = 10.0 ** rng.uniform(-5, -2), 10.0 ** rng.uniform(-2.5, -0.5)
    # The pressure closes the gap at about one t, which is random.
    pressure = 30e9 * thickness**3 * gap * 10.0 ** rng.uniform(-18, 9)
    sector = rng.choice([90, 180, 360])
    place = rng.choice([{"circle": {"radius": rng.uniform(0.1, 0.8)}}, {"area": "all"}])
    stiffness = {} if rng.random() < 0.3 else {"stiffness": 10.0 ** rng.uniform(5, 9)}
    return {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "disc", "radius": 1.0, "sector": sector, "thickness": thickness},
        "mesh": {"size": rng.uniform(0.16, 0.4), "error": False},
        "support": [
            *([{"edge": ["start", "end"], "fix": "symmetry"}] if sector < 360 else []),
            rng.choice([{"edge": "rim", "resists": "down"}, {"edge": "rim", "fix": "clamped"}]),
            {**place, **stiffness, "resists": "down", "gap": gap},
        ],
        "load": [{"case": "G", "pressure": pressure * 10.0 ** rng.uniform(-9, 0)}, {"case": "Q", "pressure": pressure}],
        "solver": {"method": rng.choice(["auto", "lemke", "active_set"])},
    }


def _far_stop(rng: Random, plate: Tables) -> Tables:
    """A support that the plate never reaches; the events of others must still be found."""
    gap = random_models.extent(plate) * 10.0 ** rng.uniform(3, 9)
    return {"at": random_models.point(rng, plate), "resists": rng.choice(["up", "down"]), "gap": gap}


def _rigidity(tables: Tables) -> float:
    """Return E h³; without E, for a plate given by its stiffness, E is that of a stiff material."""
    return tables["material"].get("E", 1e10) * random_models.thickness_of(tables["plate"]) ** 3


def _shift(rng: Random, tables: Tables) -> None:
    """Replace the growing load by a force or couple at one point."""
    last = tables["load"][-1]
    size = random_models.extent(tables["plate"])
    at = random_models.point(rng, tables["plate"])
    force = 1e-4 * _rigidity(tables) / size
    last.clear()
    last |= {"case": "Q", "at": at} | ({"force": force} if rng.random() < 0.7 else {"moment": [force * size, 0.0]})


def _extreme(rng: Random, tables: Tables) -> None:
    """Add extremes: loads without a resultant, any factor, and supports that are far away."""
    plate, size = tables["plate"], random_models.extent(tables["plate"])
    factor = 10.0 ** rng.uniform(-8, 8) if rng.random() < 0.3 else 1.0
    kind = rng.choice(["curvature", "curvature", "forces", "any"])
    grows = [load for load in tables["load"] if load["case"] == "Q"]
    if kind == "curvature":
        parts = rng.choice([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [0.0, -2.0, 1.0], [0.0, 0.0, 1.0]])
        grows = [{"case": "Q", "curvature": [factor * 1e-3 / size * part for part in parts]}]
    elif kind == "forces" and plate["shape"] == "rectangle":
        a, b = (random_models.point(rng, plate) for _ in range(2))
        middle = [0.5 * (x + y) for x, y in zip(a, b, strict=True)]
        force = factor * 1e-4 * rng.choice([1.0, -1.0]) * _rigidity(tables) / size
        grows = [{"case": "Q", "at": at, "force": f * force} for at, f in ((a, 1.0), (middle, -2.0), (b, 1.0))]
    tables["load"] = [load for load in tables["load"] if load["case"] != "Q"] + grows
    if rng.random() < 0.3:
        tables["support"] = [{"area": "all", "resists": "down"}]
    for support in tables["support"]:
        if "fix" not in support and rng.random() < 0.2:
            support["gap"] = size * 10.0 ** rng.uniform(-3, 12)
