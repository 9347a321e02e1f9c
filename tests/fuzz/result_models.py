"""Random models with every kind of result: sections, strips, profiles, checks, groups, tables, moving loads, columns.

They are models of random_models.py with further tables. In a tenth of them no combination has an equilibrium.
"""

from __future__ import annotations

from random import Random
from typing import Any

import random_models

Tables = dict[str, Any]
_FIELDS = ["deflection", "mx", "my", "mxy", "qx", "m1", "von_mises", "mx_bottom", "my_top", "txz"]


def model(rng: Random) -> Tables:
    """Draw a model with further kinds of results; the door may refuse it."""
    tables = random_models.model(rng)
    plate = tables["plate"]
    for kind, part in (("section", 0.4), ("strip", 0.4), ("profile", 0.3)):
        if rng.random() < part:
            (x, y), most = random_models.middle(rng, plate)
            line = [[x - 0.5 * most, y], [x + 0.5 * most, y + rng.choice([0.0, 0.2]) * most]]
            of_strip = {"width": 0.3 * most, "stations": rng.choice([2, 5])} if kind == "strip" else {}
            tables[kind] = [{"name": f"the {kind}", "line": line, **of_strip}]
    if rng.random() < 0.3:
        tables["probe"] = [{"at": [random_models.point(rng, plate) for _ in range(2)]}]
    if tables["support"] and rng.random() < 0.2:
        _bolts(rng, tables)
    if "combination" not in tables:
        _combine(rng, tables)
    if rng.random() < 0.4:
        _check(rng, tables)
    if rng.random() < 0.2:
        tables["reinforcement"] = _reinforcement(rng, tables)
    if rng.random() < 0.25:
        tables["output"] = {
            "combinations": "table",
            "fields": rng.choice(["none", "governing", "all"]),
            "envelope": rng.choice([[], rng.sample(_FIELDS[:6], 2)]),
        }
    return tables


def _bolts(rng: Random, tables: Tables) -> None:
    """Give points with a stiffness a limit or a preload."""
    for support in tables["support"]:
        if "at" in support and isinstance(k := support.get("stiffness"), float) and "fix" not in support:
            support |= rng.choice([{"limit": 1e-3 * k}, {"preload": 1e-4 * k, "resists": "up"}])


def _combine(rng: Random, tables: Tables) -> None:
    """Add combinations, some in groups, some without equilibrium."""
    cases = sorted({load.get("case", "load") for load in tables["load"]})
    sign = rng.choice([1.0, 1.0, 1.0, -1.0])
    factors = rng.choice([[1.0, 1.35], [1.0, -1.0], [sign], [1.0] * rng.choice([2, 14])])
    grouped = rng.random() < 0.4
    tables["combination"] = [
        {"name": f"C{i}", "factors": dict.fromkeys(cases, factor), **({"group": f"g{i % 2}"} if grouped else {})}
        for i, factor in enumerate(factors)
    ]


def _check(rng: Random, tables: Tables) -> None:
    names = [one["name"] for one in tables["support"] if "name" in one]
    of = [rng.choice(_FIELDS), *(f"{name}.reaction" for name in names[:1])]
    tables["check"] = [
        {"name": f"check {i}", "of": one, "limit": 10.0 ** rng.uniform(-3, 6)} for i, one in enumerate(of)
    ]
    if rng.random() < 0.2:
        case = tables["load"][0].get("case", "load")
        tables["check"].append({"name": "stands", "of": "overturning", "grows": [case]})


def _reinforcement(rng: Random, tables: Tables) -> Tables:
    tables["units"] = {"length": "m", "force": "N"}
    thickness = random_models.thickness_of(tables["plate"])
    depth = [0.1 * thickness, 0.2 * thickness]
    return {"code": "EN 1992-1-1:2004", "fck": 30e6, "fyk": 500e6, "d_top": depth, "d_bottom": depth}
