"""Random plates with two equivalent descriptions, which have the same answer.

The pairs are: a section and its reverse; a strip and its halves; an area with holes and the holes, and the whole area;
a solid section and its stiffness; a plate, and the same plate rotated, mirrored and moved, with every shape as a
polygon; a wall on an edge, and one that almost ends there. Both have one mesh, so that their answers differ by rounding
only.
"""

from __future__ import annotations

import math
import re
from random import Random
from typing import Any

import numpy as np
import random_models
from extreme_models import Extreme, Tables, close, deflections

from signorini import NoEquilibriumError, Result, validate
from signorini.analysis.single import solve_one
from signorini.contact.problem import contact_problem
from signorini.discretise import Discretisation, discretise
from signorini.mesh import Mesh
from signorini.shapes.outlines import Contour, along_side

_ROUNDING = 1e-6
"""Tolerance for the difference of the two answers, relative to the largest deflection or force."""
_CURVED = 1e-4
"""Tolerance if parts of lines and areas end inside elements other than parallelograms, where integration is inexact."""
_HARDLY = 1e-4
"""Smallest reference deflection, relative to F L²/D of the load."""
_CUT = 5e-3
"""Tolerance if borders, jumps or springs cut coarse elements, where the integration rules differ."""
_LAMINATED = 3e-2
"""Tolerance if borders of orthotropic zones cut elements, which are then laminates."""


def twofold(rng: Random) -> Extreme:
    """Draw a model, with a judge that describes it differently."""
    tables = random_models.model(rng)
    for key in ("combination", "moving", "output", "solver"):
        tables.pop(key, None)
    for load in tables["load"]:
        load.pop("case", None)
    tables["mesh"]["error"] = False
    spots = (random_models.point(rng, tables["plate"]) for _ in range(20))
    tables["probe"] = [{"at": [at for at in spots if random_models.on_plate(tables["plate"], at)][:6]}]
    kind = rng.choice([both_sides, hollow, solid, turned, turned, rounded])
    return kind(rng, tables)


def answer(tables: Tables, mesh: Mesh | None = None) -> Result | None:
    """Solve a model, on a given mesh or its own; None if it has no equilibrium."""
    model = validate(tables)
    (combination,) = model.effective_combinations
    try:
        return solve_one(contact_problem(discretise(model, mesh)), combination)
    except NoEquilibriumError:
        return None


def _compared(
    result: Result | None, tables: Tables, other: Tables, mesh: Mesh | None = None, part: float = _ROUNDING
) -> list[str]:
    """Compare deflections at probes and reactions with those of an equivalent model ``other``."""
    twin = answer(other, mesh)
    solved, same = (one if one is not None and one.status == "solved" else None for one in (result, twin))
    if solved is None or same is None:
        return [] if solved is same else [f"an equilibrium said {'one way' if solved else 'the other way'} alone"]
    # If a support under the load prevents deflection, integration errors of its parts deflect the plate.
    found = discretise(validate(tables), solved.mesh)
    force = _force(found, solved)
    loaded = force * found.mesh.size**2 / (found.model.young * float(found.thickness.max()) ** 3 / 12)
    least = max(float(np.abs(solved.deflection).max()), 1e-9 * solved.mesh.size, _HARDLY * loaded)
    elsewhere = any(free.what == "deflection" for one in (solved, same) for free in one.not_unique)
    wrong = [] if elsewhere else deflections(solved, [probe.deflection for probe in same.probes], part, least)
    of_ours, of_twin = ([support.reaction for support in one.supports] for one in (solved, same))
    if len(of_ours) == len(of_twin):
        apart = np.abs(np.subtract(of_ours, of_twin)).max(initial=0.0)
        if apart > part * force:
            wrong.append(f"reactions {of_ours} and {of_twin}")
    return wrong


def _force(found: Discretisation, result: Result) -> float:
    """Reference force: the sum of loads and reactions."""
    loads = found.load(found.model.effective_combinations[0]).nodal.reshape(-1, 3)
    of_loads = float(np.abs(loads[:, 0]).sum() + np.abs(loads[:, 1:]).sum() / result.mesh.size)
    return of_loads + sum(float(np.abs(support.reactions).sum()) for support in result.supports)


def both_sides(rng: Random, tables: Tables) -> Extreme:
    """Check that reversed sections have the same moment and the opposite shear, and that halves of strips add up."""
    tables.pop("strip", None)
    while "strip" not in tables or "section" not in tables:
        random_models.cut(rng, tables)
    sections, (strip,) = tables["section"], tables["strip"]
    a, b = strip["line"]
    length, width = math.dist(a, b), strip["width"]
    aside = [0.25 * width * (a[1] - b[1]) / length, 0.25 * width * (b[0] - a[0]) / length]
    halves = [
        {**strip, "line": [[x + i * aside[0], y + i * aside[1]] for x, y in (a, b)], "width": 0.5 * width}
        for i in (1, -1)
    ]
    more = {"section": [*sections, *({"line": one["line"][::-1]} for one in sections)], "strip": [strip, *halves]}

    def judge(result: Result | None) -> list[str]:
        if result is None or result.status != "solved":
            return []
        wrong, force, arm = [], _force(discretise(validate(tables), result.mesh), result), result.mesh.size
        count, curved = len(sections), _CUT if tables.get("zone") else _CURVED
        for given, there, back in zip(sections, result.sections[:count], result.sections[count:], strict=True):
            line = given["line"]
            # Other sections, and corners, agree only in the limit of mesh refinement.
            through = len(line) == 2 and all(_on_outline(tables["plate"], end) for end in line)
            if through or line[0] == line[-1]:
                wrong += close(f"shear of {there.name} back", back.shear, -there.shear, _ROUNDING * force)
            if through:
                wrong += close(f"moment of {there.name} back", back.moment, there.moment, _ROUNDING * force * arm)
        for whole, *parts in zip(*(one.stations for one in result.strips), strict=True):
            for key, size in (("moment", force * arm), ("twist", force * arm), ("shear", force)):
                total = sum(getattr(part, key) * part.width for part in parts)
                wrong += close(f"{key} of halves", total, getattr(whole, key) * whole.width, curved * size)
        return wrong

    return Extreme("both sides", tables | more, judge, may_be_refused=True)


def _on_outline(plate: Tables, at: list[float]) -> bool:
    """Whether a point is on the lower or upper side of a rectangle."""
    if plate["shape"] != "rectangle":
        return False
    low = plate.get("origin", [0.0, 0.0])[1]
    return at[1] in (low, low + plate["size"][1])


def hollow(rng: Random, tables: Tables) -> Extreme:
    """Check that loads and beds on an area with holes and on the holes together equal those on the whole area."""
    plate, size = tables["plate"], random_models.extent(tables["plate"])
    area: Tables = {}
    while not area.get("holes") and "annulus" not in area:
        area = random_models.any_area(rng, plate, size)
    parts = [area, *area.get("holes", [])]
    whole = {key: value for key, value in area.items() if key != "holes"}
    if "annulus" in area:
        center, inner, outer = (area["annulus"][key] for key in ("center", "inner", "outer"))
        whole, inside = ({"circle": {"center": center, "radius": radius}} for radius in (outer, inner))
        parts.append(inside)
    pressure = {"pressure": 1e-3 * tables["material"].get("E", 1e10) * (random_models.thickness_of(plate) / size) ** 3}
    soft = {"resists": "both", "stiffness": pressure["pressure"] / size}

    def said(areas: list[Tables]) -> Tables:
        more = {"load": [{**pressure, "area": one} for one in areas]}
        if bedded:
            more["support"] = [{**soft, "area": one} for one in areas]
        return {key: [*value, *more.get(key, [])] if key in more else value for key, value in tables.items()}

    bedded = rng.random() < 0.5
    return Extreme(
        "hollow",
        said(parts),
        lambda result: _compared(
            result, said(parts), said([whole]), result and result.mesh, _CUT if bedded else _CURVED
        ),
        may_be_refused=True,
    )


def solid(rng: Random, tables: Tables) -> Extreme:
    """Check that an isotropic plate equals one with its stiffness given, along any axes."""
    plate, material = tables["plate"], tables["material"]
    thickness = plate["thickness"] = random_models.thickness_of(plate)
    plate.pop("stiffness", None)
    nu = material.setdefault("nu", 0.2)
    young = material.setdefault("E", 30e9)
    rigid, shear = young * thickness**3 / 12 / (1 - nu**2), 5 / 6 * young / 2 / (1 + nu) * thickness
    of = {"Dx": rigid, "Dy": rigid, "D1": nu * rigid, "Dxy": 0.5 * (1 - nu) * rigid, "Sx": shear, "Sy": shear}
    if not any("modifiers" in one for one in (plate, *tables.get("zone", []))):
        of["angle"] = rng.uniform(-180.0, 180.0)
    other = {**tables, "plate": {**plate, "stiffness": of}}
    return Extreme("solid", tables, lambda result: _compared(result, tables, other), may_be_refused=True)


def turned(rng: Random, tables: Tables) -> Extreme:
    """Check that a plate that is rotated, mirrored and moved, some by surveyors' coordinates, bends as before.

    Every rotated shape is a polygon.
    """
    tables["support"] = [support for support in tables["support"] if not _goes_by_frame(support)]
    quarter = any("modifiers" in one for one in (tables["plate"], *tables.get("zone", [])))
    motion = Motion(
        rng.choice([90.0, 180.0, 270.0] if quarter else [90.0, 45.0, rng.uniform(0.0, 360.0)]),
        rng.choice([1.0, -1.0]),
        [
            rng.choice([1.0, 1.0, 1e4]) * rng.uniform(-1.0, 1.0) * random_models.extent(tables["plate"])
            for _ in range(2)
        ],
    )

    def judge(result: Result | None) -> list[str]:
        mesh = discretise(validate(tables)).mesh if result is None else result.mesh
        contours = validate(tables).plate.contours
        other = motion.of_model(tables, contours)
        items = [*tables["support"], *tables["load"]]
        parts = any(key in item for item in items for key in ("area", "patch", "radius"))
        part = _CUT if "zone" in tables or "where(" in repr(tables) else _CURVED if parts else _ROUNDING
        if any("stiffness" in zone for zone in tables.get("zone", [])):
            part = _LAMINATED
        return _compared(result, tables, other, motion.of_mesh(mesh, contours), part)

    return Extreme("turned", tables, judge, may_be_refused=True)


def rounded(rng: Random, tables: Tables) -> Extreme:
    """Check that a rigid wall that nearly ends on an edge is snapped onto it, and a rigid point onto the wall."""
    plate = tables["plate"]
    if plate["shape"] != "rectangle" or "nodes" in repr(tables["support"]):
        return turned(rng, tables)
    (x0, y0), (a, b) = plate.get("origin", [0.0, 0.0]), plate["size"]
    begin = [x0 + rng.uniform(0.1, 0.9) * a, y0]
    end = [x0 + rng.uniform(0.1, 0.9) * a, y0 + rng.uniform(0.3, 0.9) * b]
    along = np.subtract(end, begin) / math.dist(begin, end)
    way = rng.choice([{"fix": "simple"}, {"resists": "both"}, {"resists": "down"}])
    off = rng.choice([1.0, -1.0]) * random_models.extent(plate) * 10.0 ** rng.uniform(-9.0, -3.8)
    on = [float(c) for c in np.array(begin) + rng.uniform(0.2, 0.8) * math.dist(begin, end) * along]
    beside = [on[0] - off * float(along[1]), on[1] + off * float(along[0])]
    mesh = {**tables["mesh"], "snap": 2e-4 * random_models.extent(plate)}

    def said(start: list[float], at: list[float]) -> Tables:
        wall, point = {"line": [start, end], **way}, {"at": at, "resists": "both"}
        return tables | {"mesh": mesh, "support": [*tables["support"], wall, point]}

    def judge(result: Result | None) -> list[str]:
        return _compared(result, said(begin, on), said([begin[0], begin[1] + off], beside))

    return Extreme("rounded", said(begin, on), judge, may_be_refused=True)


def _goes_by_frame(support: Tables) -> bool:
    """Whether the points of a support depend on mesh and axes: on circles, and in parts of cut elements."""
    lets_go = support.get("resists") != "both" or "gap" in support
    return "circle" in support or ("area" in support and (lets_go or "stiffness" not in support))


class Motion:
    """A motion of the plane: mirror y (``mirror`` = -1), rotate by degrees, shift."""

    def __init__(self, degrees: float, mirror: float, shift: list[float]) -> None:
        """Store rotation, mirror and shift."""
        turn = math.radians(degrees)
        self.cos, self.sin = (round(f(turn), 15) for f in (math.cos, math.sin))
        self.degrees, self.mirror, self.shift = degrees, mirror, shift

    def direction(self, v: Any) -> list[Any]:
        """Rotate and mirror a vector of numbers or formulas."""
        x, y = v
        if isinstance(x, str) or isinstance(y, str):
            x, y = (f"({self.formula(part)})" for part in (x, y))
            return [
                f"{self.cos!r}*{x} - {self.sin * self.mirror!r}*{y}",
                f"{self.sin!r}*{x} + {self.cos * self.mirror!r}*{y}",
            ]
        return [self.cos * x - self.sin * self.mirror * y, self.sin * x + self.cos * self.mirror * y]

    def point(self, p: Any) -> list[float]:
        """Move a point."""
        return [a + b for a, b in zip(self.direction(p), self.shift, strict=True)]

    def points(self, given: Any) -> Any:
        """Move a point, or a list of them, and arcs among them."""
        if isinstance(given, dict):
            return {key: self.point(p) for key, p in given.items()}
        return self.point(given) if not isinstance(given[0], list) else [self.points(one) for one in given]

    def formula(self, given: Any) -> Any:
        """Rewrite a number or formula in the coordinates after the motion."""
        if not isinstance(given, str):
            return given
        (a, b), (c, s), m = self.shift, (self.cos, self.sin), self.mirror
        x, y = f"({c!r}*(x - {a!r}) + {s!r}*(y - {b!r}))", f"({m}*({c!r}*(y - {b!r}) - {s!r}*(x - {a!r})))"
        return re.sub(r"\b[xy]\b", lambda found: x if found[0] == "x" else y, given)

    def angle(self, degrees: float) -> float:
        """Angle after the motion."""
        return self.degrees + self.mirror * degrees

    def contour(self, drawn: Contour) -> list[Any]:
        """Move an outline, as the points of a polygon."""
        ends = (*drawn.corners[1:], drawn.corners[0])
        sides = list(zip(drawn.through, ends, strict=True))
        found = [list(drawn.corners[0])]
        found += [list(b) if m is None else {"through": list(m), "to": list(b)} for m, b in sides]
        return [self.points(one) for one in (found if drawn.through[-1] is not None else found[:-1])]

    def area(self, given: Any) -> Any:
        """Move an area, as a polygon where it is a rectangle."""
        if given == "all":
            return given
        moved = {}
        for key, value in given.items():
            match key:
                case "rectangle":
                    x, y, u, v = value
                    moved["polygon"] = self.points([[x, y], [u, y], [u, v], [x, v]])
                case "polygon":
                    moved[key] = [self.points(one) for one in value]
                case "holes":
                    moved[key] = [self.area(one) for one in value]
                case _:
                    moved[key] = {**value, "center": self.point(value.get("center", [0.0, 0.0]))}
        return moved

    def of_item(self, item: Tables, names: dict[str, list[str]]) -> Tables:
        """Move a support, load, zone, section, strip or probe."""
        moved = dict(item)
        for key, value in item.items():
            match key:
                case "at":
                    moved[key] = self.points(value)
                case "line":
                    moved[key] = [self.point(p) for p in value]
                case "circle":
                    moved[key] = {**value, "center": self.point(value["center"])}
                case "area":
                    moved[key] = self.area(value)
                case "edge":
                    given = value if isinstance(value, list) else [value]
                    moved[key] = [new for name in given for new in names.get(name, [name])]
                case "patch":
                    moved["angle"] = self.angle(item.get("angle", 0.0))
                case "moment" | "rotation":
                    moved[key] = self.direction(value)
                case "couple_about":
                    del moved[key]
                    moved["moment"] = self.direction([-value.get("y", 0.0), value.get("x", 0.0)])
                case "curvature":
                    kx, ky, kxy = value
                    columns = np.array([self.direction(p) for p in ([1.0, 0.0], [0.0, 1.0])]).T
                    tensor = columns @ np.array([[kx, kxy], [kxy, ky]]) @ columns.T
                    moved[key] = [*np.diag(tensor).tolist(), float(tensor[0, 1])]
                case "stiffness" if isinstance(value, dict):
                    moved[key] = {**value, "angle": self.angle(value.get("angle", 0.0))}
                case "thickness" | "gap" | "stiffness" | "settlement" | "pressure" | "line_load":
                    moved[key] = self.formula(value)
        return moved

    def of_model(self, tables: Tables, contours: tuple[Contour, ...]) -> Tables:
        """Move a model; its plate becomes a polygon."""
        outline, *holes = contours
        names: dict[str, list[str]] = {}
        for number, name in enumerate(outline.names, 1):
            names.setdefault(name, []).append(f"edge {number}")
        for number, hole in enumerate(holes, 1):
            # The hole of an annulus has its own name.
            names |= {name: [f"hole {number}"] for name in hole.edges}
            names |= {side: [f"hole {number} edge {i}"] for i, side in enumerate(hole.names, 1) if hole.whole}
        kept = ("thickness", "element", "modifiers", "stiffness")
        plate = self.of_item({key: value for key, value in tables["plate"].items() if key in kept}, names)
        plate |= {"shape": "polygon", "points": self.contour(outline)}
        plate |= {"holes": [{"polygon": self.contour(hole)} for hole in holes]}
        moved = {**tables, "plate": plate, "mesh": {"size": random_models.extent(tables["plate"]), "error": False}}
        for key in ("support", "load", "zone", "section", "strip", "probe"):
            moved[key] = [self.of_item(item, names) for item in tables.get(key, [])]
        return moved

    def of_mesh(self, mesh: Mesh, contours: tuple[Contour, ...]) -> Mesh:
        """Move a mesh, whose edges are named by the polygon's sides."""
        outline, *holes = contours
        edges = {f"hole {number}": mesh.edges[next(iter(hole.edges))] for number, hole in enumerate(holes, 1)}
        for number, hole in enumerate(holes, 1):
            sides = enumerate(hole.names, 1) if hole.whole else ()
            edges |= {f"hole {number} edge {i}": mesh.edges[side] for i, side in sides}
        ends = (*outline.corners[1:], outline.corners[0])
        sides = [
            np.vstack([along_side(a, m, b), b]) for a, m, b in zip(outline.corners, outline.through, ends, strict=True)
        ]
        for name in dict.fromkeys(outline.names):
            own = [number for number, other in enumerate(outline.names) if other == name]
            middles = mesh.points[mesh.edges[name][:, 1]]
            off = np.stack([np.hypot(*(middles[:, None] - sides[number]).T).min(axis=0) for number in own])
            for number, at in enumerate(own):
                edges[f"edge {at + 1}"] = mesh.edges[name][off.argmin(axis=0) == number]
        points = np.column_stack(self.direction(mesh.points.T)) + self.shift
        elements = mesh.elements
        if self.mirror < 0.0:
            edges = {name: triples[:, ::-1] for name, triples in edges.items()}
            mirrored = elements[:, [0, 3, 2, 1, 7, 6, 5, 4]]
            # A triangle repeats its third corner.
            of_triangles = elements[:, [0, 2, 1, 1, 7, 5, 1, 4]]
            of_triangles[:, 6] = of_triangles[:, 3]
            mirrored[mesh.triangles] = of_triangles[mesh.triangles]
            elements = mirrored
        return Mesh(points, elements, edges)
