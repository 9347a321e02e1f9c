"""Small models drawn from a seeded generator, as the nested tables of an input file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random
from typing import Any

Tables = dict[str, Any]


@dataclass(frozen=True)
class _Scale:
    """Reference length, force and point stiffness of a plate: the force bends it by a thousandth of its span."""

    length: float
    force: float
    stiffness: float


def model(rng: Random) -> Tables:
    """Draw a valid model; it may be a mechanism, or its load may have no equilibrium."""
    plate, mesh = _plate(rng)
    young, size = rng.choice([30e9, 1000.0, 2.1e5]), extent(plate)
    thickness = float(str(plate["thickness"]).partition("*")[0])
    stiffness = young * thickness**3 / 12 / size**2
    scale = _Scale(size, 1e-3 * size * stiffness, stiffness)
    loads = [_load(rng, plate, scale) for _ in range(rng.choice([1, 1, 2, 3]))]
    tables: Tables = {
        "material": {"E": young, "nu": rng.choice([0.0, 0.2, 0.3, 0.49, -0.3])},
        "plate": plate,
        "mesh": mesh,
        "support": [_support(rng, plate, scale) for _ in range(rng.choice([0, 1, 1, 2, 2, 3, 4]))],
        "load": loads,
    }
    if any("self_weight" in load for load in loads):
        tables["material"]["unit_weight"] = scale.force / thickness / size**2
    if rng.random() < 0.3:
        cases = sorted({load.get("case", "load") for load in loads})
        tables["combination"] = [
            {"name": f"C{i}", "factors": {case: rng.choice([1.0, 1.35, -1.0, 0.0]) for case in cases}}
            for i in range(rng.choice([1, 2, 3]))
        ]
    if rng.random() < 0.15:
        _generate(rng, tables, scale)
    if rng.random() < 0.2:
        tables["probe"] = [{"at": point(rng, plate)}]
    if rng.random() < 0.2:
        tables["solver"] = {"method": rng.choice(["auto", "lemke", "active_set"])}
    if rng.random() < 0.1:
        tables |= {"title": "Größe [m]", "units": {"length": "m", "force": "kN"}}
    if tables["support"] and rng.random() < 0.12:
        _repeat(rng, tables["support"])
    if "combination" not in tables and rng.random() < 0.06:
        _balance(rng, tables, scale)
    # This is drawn last, so that it does not affect the other choices of the seed.
    if rng.random() < 0.2:
        _step(rng, tables)
    if rng.random() < 0.5:
        _turn(rng, tables["support"], size)
    if rng.random() < 0.25:
        _reshape(rng, tables)
    if rng.random() < 0.5:
        _spread(rng, tables, size)
    if rng.random() < 0.3:
        _other_areas(rng, tables, size)
    if rng.random() < 0.1:
        _sectioned(rng, tables)
    if rng.random() < 0.3:
        _zones(rng, tables, size)
    if rng.random() < 0.3:
        cut(rng, tables)
    if rng.random() < 0.2:
        _refine(rng, tables, size)
    for support in tables["support"]:
        if support.get("edge") == ["hole 1"] and "rectangle" in tables["plate"]["holes"][0]:
            support["edge"] = rng.choice([["hole 1"], ["hole 1 left"], ["hole 1 top", "hole 1 right"]])
    if rng.random() < 0.1:
        _touch(rng, tables)
    return tables


def _other_areas(rng: Random, tables: Tables, size: float) -> None:
    """Replace areas by ones with holes, arcs or two circles, and rotate patches."""
    for item in (*tables["support"], *tables["load"]):
        if isinstance(item.get("area"), dict):
            item["area"] = any_area(rng, tables["plate"], size)
        if "patch" in item:
            item["angle"] = rng.choice([30.0, -45.0, 90.0, rng.uniform(-180.0, 180.0)])


def any_area(rng: Random, plate: Tables, size: float) -> Tables:
    """Draw an area of any kind."""
    if rng.random() < 0.1:
        return area(rng, plate, size)
    (x, y), most = middle(rng, plate)
    # Much smaller areas and holes would take most of the elements.
    r = most * rng.choice([0.9, 0.7, 0.5])
    circle = {"center": [x, y], "radius": r}
    a, b = 0.7 * r, 0.7 * r * rng.choice([1.0, 0.6])
    ring = {"center": [x, y], "inner": r * rng.choice([0.4, 0.6, 0.8]), "outer": r}
    bit = {"circle": {"center": [x, y + 0.5 * (r + ring["inner"])], "radius": 0.08 * r}}
    box, hole = {"rectangle": [x - a, y - b, x + a, y + b]}, {"circle": {"center": [x, y], "radius": 0.5 * b}}
    arched = [[x - a, y - b], [x + a, y - b], {"through": [x, y + b], "to": [x - a, y - b]}]
    inner = {"rectangle": [x - 0.4 * b, y - 0.3 * b, x + 0.5 * b, y + 0.3 * b]}
    beside = {"polygon": [[x - 0.1 * b, y + 0.4 * b], [x + 0.2 * b, y + 0.4 * b], [x, y + 0.6 * b]]}
    return rng.choice(
        [
            {"annulus": ring},
            {"annulus": ring, "holes": [bit]},
            {**box, "holes": [hole]},
            {**box, "holes": [inner, beside]},
            {"circle": circle, "holes": [inner]},
            {"polygon": arched},
            {"polygon": arched, "holes": [{"circle": {"center": [x, y - 0.3 * b], "radius": 0.2 * b}}]},
        ]
    )


def _sectioned(rng: Random, tables: Tables) -> None:
    """Describe the plate by the stiffness of its section: ribbed, hollow, sandwich."""
    plate, material = tables["plate"], tables["material"]
    plate["thickness"] = thickness_of(plate)
    plate["stiffness"] = _stiffness(rng, material, plate["thickness"])
    if rng.random() < 0.5:
        tables["material"] = {key: value for key, value in material.items() if key == "unit_weight"}


def thickness_of(plate: Tables) -> float:
    """Thickness of a plate; for a formula the number at its beginning."""
    return float(str(plate["thickness"]).partition("*")[0].strip("()"))


def _stiffness(rng: Random, material: Tables, thickness: float) -> Tables:
    rigid = material["E"] * thickness**3 / 12
    shear = material["E"] * thickness / 2.4
    of = {"Dx": rigid, "Dy": rigid * rng.choice([1.0, 0.2, 0.01]), "D1": 0.0}
    of |= {"Dxy": rigid * rng.choice([0.4, 0.05]), "Sx": shear, "Sy": shear * rng.choice([1.0, 0.1])}
    if rng.random() < 0.3:
        of["D1"] = 0.2 * of["Dy"]
    if rng.random() < 0.5:
        of["angle"] = rng.choice([90.0, 30.0, -17.0])
    return of


def _zones(rng: Random, tables: Tables, size: float) -> None:
    """Add zones with another thickness or material; they may overlap."""
    plate, material = tables["plate"], tables["material"]
    thickness, zones = thickness_of(plate), []
    for _ in range(rng.choice([1, 1, 2, 3])):
        own: Tables = {"area": any_area(rng, plate, size)}
        match rng.choice(["thickness", "thickness", "modifiers", "material", "stiffness"]):
            case "modifiers":
                own["modifiers"] = rng.choice([{"bending": 0.3}, {"bending": 0.5, "twist": 0.1, "shear": 2.0}])
            case "material" if "E" in material:
                own["material"] = {**material, "E": material["E"] * rng.choice([0.3, 7.0])}
            case "stiffness" if "E" in material:
                own |= {"thickness": thickness, "stiffness": _stiffness(rng, material, thickness)}
            case _ if "E" in material:
                own["thickness"] = thickness * rng.choice([0.5, 2.0, 3.0])
            case _:
                own["modifiers"] = {"twist": 0.1}
        zones.append(own)
    tables["zone"] = zones


def cut(rng: Random, tables: Tables) -> None:
    """Add strips, and sections from edge to edge, between two points or around a point."""
    plate = tables["plate"]
    (x, y), room = middle(rng, plate)
    turn = rng.choice([0.0, math.pi / 2, rng.uniform(0.0, math.pi)])
    along, across = [math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]
    at = [x + i * 0.3 * room * u for i, u in ((-1, along[0]), (1, along[0]))]
    ends = [[u, y + i * 0.3 * room * along[1]] for u, i in zip(at, (-1, 1), strict=True)]
    around = [[x + room * (i * along[k] + j * across[k]) / 3 for k in (0, 1)] for i, j in ((-1, -1), (1, -1), (1, 1))]
    lines = [ends, [*around, around[0]]]
    if plate["shape"] == "rectangle" and not plate.get("holes"):
        (left, low), (a, b) = plate.get("origin", [0.0, 0.0]), plate["size"]
        lines.append([[x, low], [left + a * rng.choice([0.5, rng.random()]), low + b]])
    if rng.random() < 0.3:
        lines.append(_points(rng, plate, 3))
    if rng.random() < 0.2:
        lines.append(_points(rng, plate, 4))
    if rng.random() < 0.3:
        lines[1][-1] = [u + rng.choice([1e-16, 1e-10, 1e-7]) * room for u in around[0]]
    for item in (*tables["support"], *tables["load"]):
        if isinstance(item.get("at"), list) and isinstance(item["at"][0], list) and rng.random() < 0.3:
            # A section through the point or footprint of a load or support.
            u, v = item["at"][0]
            lines.append([[u - i * 0.3 * room * along[0], v - i * 0.3 * room * along[1]] for i in (1, -1)])
    chosen = rng.sample(lines, rng.randint(1, len(lines)))
    ended = [line for line in chosen if len(line) > 1 and on_plate(plate, line[0]) and on_plate(plate, line[-1])]
    if ended or rng.random() < 0.1:
        tables["section"] = [{"line": line} for line in ended or chosen]
    if rng.random() < 0.6:
        tables["strip"] = [{"line": ends, "width": room * rng.choice([0.1, 0.5, 0.9]), "stations": rng.choice([2, 5])}]


def _touch(rng: Random, tables: Tables) -> None:
    """Add rigid circles that touch, or nearly touch, an edge or each other; the mesh does not move them."""
    plate = tables["plate"]
    if plate["shape"] != "rectangle":
        return
    plate.pop("element", None)
    tables["mesh"] = {key: value for key, value in tables["mesh"].items() if key != "divisions"}
    (x, y), radius = middle(rng, plate)
    radius *= rng.choice([1.0, 1.0, 0.999, 0.9])
    tables["mesh"]["size"] = radius * rng.choice([0.4, 0.25])
    centers = rng.choice([[[x, y]], [[x - 0.5 * radius, y], [x + 0.5 * radius, y]]])
    for center in centers:
        circle = {"center": center, "radius": radius / len(centers)}
        tables["support"].append({"circle": circle, "resists": rng.choice(["down", "up", "both"])})


def _refine(rng: Random, tables: Tables, size: float) -> None:
    """Refine the mesh at a place."""
    plate, mesh = tables["plate"], tables["mesh"]
    where = rng.choice(
        [
            {"at": point(rng, plate)},
            {"edge": rng.sample(_edges(plate), 1)},
            {"line": _points(rng, plate, 2)},
            {"circle": _circle(rng, plate, size)},
            {"area": any_area(rng, plate, size)},
        ]
    )
    if len(where.get("line", [0, 1])) < 2:
        return
    if plate["shape"] != "rectangle" or plate.get("holes"):
        # The refined mesh has triangles, which q8r does not support.
        plate.pop("element", None)
        mesh = {"size": mesh.get("size", 0.3 * size)}
    tables["mesh"] = {**mesh, "refine": [where | {"size": size * rng.choice([0.1, 0.05])}]}


def _step(rng: Random, tables: Tables) -> None:
    """Let a value of the plate, a load or a support jump along a line or a circle."""
    plate = tables["plate"]
    items = [(plate, "thickness")] * 2
    items += [(load, key) for load in tables["load"] for key in ("pressure", "line_load") if key in load]
    items += [(s, key) for s in tables["support"] for key in ("stiffness", "gap", "settlement") if key in s]
    (x, y), radius = middle(rng, plate)
    where = rng.choice(
        [f"x < {x}", f"y >= {y}", f"x - {x} > 0.3*(y - {y})", f"(x - {x})**2 + (y - {y})**2 < {0.7 * radius}**2"]
    )
    item, key = rng.choice(items)
    item[key] = f"({item[key]})*where({where}, {rng.choice([0.1, 0.5, 2.0, 5.0])}, 1)"


def _turn(rng: Random, supports: list[Tables], size: float) -> None:
    """Prescribe slopes of the supports that hold them, seldom different ones: a tilted wall, a bent rim."""
    slopes = [[1e-4, -2e-4], [1e-3, 0.0], [f"1e-4*x/{size}", f"1e-4*y/{size}"]]
    turned = rng.choice(slopes)
    for support in supports:
        if support.get("fix", "simple") != "simple" and rng.random() < 0.8:
            support["rotation"] = turned if rng.random() < 0.9 else rng.choice(slopes)


def _reshape(rng: Random, tables: Tables) -> None:
    """Cut a hole into the plate, or a corner off a rectangle; edges of the new outline replace the old ones."""
    plate = tables["plate"]
    if plate["shape"] == "rectangle" and rng.random() < 0.5:
        (x, y), (a, b) = plate.pop("origin", [0.0, 0.0]), plate.pop("size")
        corner: list[Any] = rng.choice(
            [
                [[x + a, y + 0.5 * b], [x + 0.6 * a, y + 0.5 * b], [x + 0.6 * a, y + b]],
                [[x + a, y + 0.4 * b], [x + 0.7 * a, y + b]],
                [[x + a, y + 0.5 * b], {"through": [x + 0.9 * a, y + 0.9 * b], "to": [x + 0.5 * a, y + b]}],
            ]
        )
        plate |= {"shape": "polygon", "points": [[x, y], [x + a, y], *corner, [x, y + b]]}
        for item in (*tables["support"], *tables["load"]):
            if "edge" in item:
                item["edge"] = rng.sample(_edges(plate), min(len(item["edge"]), 2))
    else:
        (x, y), most = middle(rng, plate)
        r = most * rng.choice([0.5, 0.25])
        plate["holes"] = [
            rng.choice(
                [{"circle": {"center": [x, y], "radius": r}}, {"rectangle": [x - r, y - 0.6 * r, x + r, y + 0.6 * r]}]
            )
        ]
        if rng.random() < 0.2:
            tables["support"].append({"edge": ["hole 1"], "resists": rng.choice(["down", "both"])})
    # The mesh may have triangles, which q8r does not support, and points may now be off the plate.
    plate.pop("element", None)
    tables["mesh"] = {"size": extent(plate) * rng.choice([0.3, 0.2, 0.12])}
    for item in (*tables["support"], *tables["load"]):
        if "at" in item:
            many = isinstance(item["at"][0], list)
            moved = [_onto(rng, plate, at) for at in (item["at"] if many else [item["at"]])]
            item["at"] = moved if many else moved[0]


def _onto(rng: Random, plate: Tables, at: list[float]) -> list[float]:
    """Return a point, or a random point on the plate if it is off the plate."""
    while not on_plate(plate, at):
        at = point(rng, plate)
    return at


def _spread(rng: Random, tables: Tables, size: float) -> None:
    """Give point forces and supports footprints, slightly further inside; give couples about both axes."""
    plate = tables["plate"]
    (x, y), _ = middle(rng, plate)
    for item in (*tables["support"], *tables["load"]):
        if "at" not in item or item.get("fix", "simple") != "simple" or rng.random() < 0.2:
            continue
        a, b = (size * rng.choice([0.02, 0.05, 0.12]) for _ in range(2))
        given = item["at"] if isinstance(item["at"][0], list) else [item["at"]]
        inside = [[x + 0.8 * (u - x), y + 0.8 * (v - y)] for u, v in given]
        if all(on_plate(plate, [u + i * a, v + j * b]) for u, v in inside for i in (-0.5, 0.5) for j in (-0.5, 0.5)):
            item["at"] = inside
            item |= rng.choice([{"patch": [a, b]}, {"radius": 0.5 * min(a, b)}])
        if "moment" in item and rng.random() < 0.5:
            mx, my = item.pop("moment")
            item["couple_about"] = {"x": my, "y": -mx}


def on_plate(plate: Tables, at: list[float]) -> bool:
    """Whether a point is on the plate and not in a hole; arcs count as their chords."""
    (u, v), inside = at, True
    if plate["shape"] == "rectangle":
        (x, y), (a, b) = plate.get("origin", [0.0, 0.0]), plate["size"]
        inside = x <= u <= x + a and y <= v <= y + b
    elif plate["shape"] == "polygon":
        inside = _within(_corners(plate), at)
    else:
        x, y = plate.get("center", [0.0, 0.0])
        angle = math.degrees(math.atan2(v - y, u - x)) % 360
        inside = plate.get("inner", 0.0) <= math.hypot(u - x, v - y) <= extent(plate) and angle <= plate["sector"]
    for hole in plate.get("holes", []):
        if "circle" in hole:
            (x, y), r = hole["circle"]["center"], hole["circle"]["radius"]
            inside &= math.hypot(u - x, v - y) >= r
        else:
            x, y, x1, y1 = hole["rectangle"]
            inside &= not (x < u < x1 and y < v < y1)
    return inside


def _corners(plate: Tables) -> list[list[float]]:
    return [at for one in plate["points"] for at in ([one["through"], one["to"]] if isinstance(one, dict) else [one])]


def _within(corners: list[list[float]], at: list[float]) -> bool:
    crossings = 0
    for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1], strict=True):
        if (b > at[1]) != (d > at[1]):
            crossings += at[0] < a + (at[1] - b) / (d - b) * (c - a)
    return crossings % 2 == 1


def _plate(rng: Random) -> tuple[Tables, Tables]:
    shape = rng.choice(["rectangle", "rectangle", "rectangle", "disc", "annulus"])
    size = rng.choice([1.0, 4.0, 10.0, 5000.0])
    plate: Tables = {"shape": shape}
    if shape == "rectangle":
        plate["size"] = [size, size * rng.choice([1.0, 0.5, 0.13])]
        if rng.random() < 0.2:
            plate["origin"] = [rng.choice([-1.0, 3.7]) * size, 0.0]
        divisions = [rng.randint(1, 6), rng.randint(1, 6)]
    elif shape == "disc":
        plate |= {"radius": size, "sector": rng.choice([90, 180, 360])}
        divisions = [rng.randint(1, 3), 4 * rng.randint(1, 3)]
    else:
        plate |= {"inner": 0.4 * size, "outer": size, "sector": rng.choice([60, 180, 360])}
        divisions = [rng.randint(1, 3), rng.randint(4, 8)]
    if shape != "rectangle" and rng.random() < 0.2:
        plate["center"] = [rng.uniform(-size, size), 0.0]
    thickness = size * rng.choice([0.2, 0.1, 0.03, 0.001])
    plate["thickness"] = thickness if rng.random() < 0.8 else f"{thickness}*(1 + (x/{size})**2)"
    if rng.random() < 0.2:
        plate["element"] = rng.choice(["mitc9", "q8r"])
    if rng.random() < 0.1:
        return plate, {"size": 0.4 * size}
    return plate, {"divisions": divisions}


def extent(plate: Tables) -> float:
    if plate["shape"] == "polygon":
        return float(plate["points"][1][0] - plate["points"][0][0])
    return float(plate["size"][0] if plate["shape"] == "rectangle" else plate.get("outer", plate.get("radius")))


def point(rng: Random, plate: Tables) -> list[float]:
    """Draw a point of the plate, often a node or on its outline."""
    if plate["shape"] == "rectangle":
        origin = plate.get("origin", [0.0, 0.0])
        return [o + s * _part(rng) for o, s in zip(origin, plate["size"], strict=True)]
    if plate["shape"] == "polygon":
        return [lower + _part(rng) * (upper - lower) for lower, upper in _bounds(plate)]
    inner, outer = plate.get("inner", 0.0), extent(plate)
    radius = inner + (outer - inner) * (0.02 + 0.96 * _part(rng))
    angle = math.radians(plate["sector"]) * (0.001 + 0.998 * _part(rng))
    x, y = plate.get("center", [0.0, 0.0])
    return [x + radius * math.cos(angle), y + radius * math.sin(angle)]


def _bounds(plate: Tables) -> list[tuple[float, float]]:
    return [(min(axis), max(axis)) for axis in zip(*_corners(plate), strict=True)]


def _part(rng: Random) -> float:
    return rng.choice([0.0, 0.25, 0.5, 0.75, 1.0]) if rng.random() < 0.4 else rng.random()


def _edges(plate: Tables) -> list[str]:
    if plate["shape"] == "polygon":
        return [f"edge {number}" for number in range(1, len(plate["points"]) + 1)]
    if plate["shape"] == "rectangle":
        return ["left", "right", "bottom", "top"]
    outline = ["rim"] if plate["shape"] == "disc" else ["inner", "outer"]
    return outline if plate["sector"] == 360 else [*outline, "start", "end"]


def _points(rng: Random, plate: Tables, count: int) -> list[list[float]]:
    return [list(at) for at in dict.fromkeys(tuple(point(rng, plate)) for _ in range(count))]


def _place(rng: Random, plate: Tables, size: float, kinds: list[str]) -> Tables:
    match rng.choice(kinds):
        case "at":
            count = rng.choice([1, 2, 3, 4, 4, 9])
            return {"at": _points(rng, plate, count)}
        case "edge":
            edges = _edges(plate)
            return {"edge": rng.sample(edges, rng.randint(1, len(edges)))}
        case "line":
            ends = _points(rng, plate, 2)
            return {"line": ends} if len(ends) == 2 else {"at": ends}
        case "circle":
            inside = plate["shape"] != "rectangle" and rng.random() < 0.7
            return {"circle": _concentric(rng, plate) if inside else _circle(rng, plate, size)}
        case _:
            return {"area": rng.choice(["all", area(rng, plate, size)])}


def _concentric(rng: Random, plate: Tables) -> Tables:
    inner, outer = plate.get("inner", 0.0), extent(plate)
    return {"center": plate.get("center", [0.0, 0.0]), "radius": inner + (outer - inner) * rng.choice([0.5, 0.7, 1.0])}


def middle(rng: Random, plate: Tables) -> tuple[list[float], float]:
    """Draw a point well inside the plate; return it and a lower bound of its distance from the outline."""
    if plate["shape"] == "polygon":
        (x, x1), (y, y1) = _bounds(plate)
        return [0.7 * x + 0.3 * x1, 0.7 * y + 0.3 * y1], 0.2 * min(x1 - x, y1 - y)
    if plate["shape"] == "rectangle":
        parts = [rng.choice([0.5, rng.uniform(0.3, 0.7)]) for _ in range(2)]
        origin = plate.get("origin", [0.0, 0.0])
        at = [o + s * t for o, s, t in zip(origin, plate["size"], parts, strict=True)]
        return at, min(s * min(t, 1 - t) for s, t in zip(plate["size"], parts, strict=True))
    inner, outer = plate.get("inner", 0.0), extent(plate)
    angle = math.radians(min(plate["sector"], 90)) / 2
    radius = 0.5 * (inner + outer)
    x, y = plate.get("center", [0.0, 0.0])
    return [x + radius * math.cos(angle), y + radius * math.sin(angle)], 0.5 * min(outer - inner, radius * angle)


def _circle(rng: Random, plate: Tables, size: float) -> Tables:
    if rng.random() < 0.1:
        return {"center": point(rng, plate), "radius": size * rng.choice([0.1, 0.25, 0.5])}
    center, most = middle(rng, plate)
    return {"center": center, "radius": most * rng.choice([0.9, 0.5, 0.1])}


def area(rng: Random, plate: Tables, size: float) -> Tables:
    """Draw an area that is usually well inside the plate."""
    circle = _circle(rng, plate, size)
    (x, y), r = circle["center"], circle["radius"]
    a, b = 0.7 * r * rng.choice([1.0, rng.random()]), 0.7 * r
    return rng.choice(
        [
            {"rectangle": [x - a, y - b, x + a, y + b]},
            {"circle": circle},
            {"polygon": [[x - a, y], [x + a, y - b], [x, y + b]]},
        ]
    )


def _support(rng: Random, plate: Tables, scale: _Scale) -> Tables:
    size, stiffness = scale.length, scale.stiffness
    place = _place(rng, plate, size, ["at", "at", "at", "edge", "line", "circle", "area"])
    if "area" not in place and rng.random() < 0.25:
        fixes: list[Any] = ["simple", "clamped"]
        fixes += [] if "at" in place else ["hard", "symmetry", ["slope", "w"]]
        return {**place, "fix": rng.choice(fixes)}
    # Stiffness of a point, per length or per area.
    per = stiffness / size ** (0 if "at" in place else 2 if "area" in place else 1)
    support = {**place, "resists": rng.choice(["down", "down", "down", "up", "both"])}
    for key, values in (
        ("gap", [1e-4 * size, 0.01 * size, "1e-4*abs(x)"]),
        ("stiffness", [per, 100 * per, 1e6 * per, f"{per}*(1 + (x/{size})**2)"]),
        ("settlement", [1e-4 * size, -1e-3 * size, "1e-4*y"]),
    ):
        if rng.random() < 0.25:
            support[key] = rng.choice(values)
    return support


def _load(rng: Random, plate: Tables, scale: _Scale) -> Tables:
    size, force = scale.length, scale.force
    case: Tables = {"case": rng.choice(["G", "Q"])} if rng.random() < 0.4 else {}
    match rng.choice(["pressure"] * 3 + ["force", "force", "line_load", "moment", "self_weight", "curvature"]):
        case "pressure":
            where = {"area": area(rng, plate, size)} if rng.random() < 0.4 else {}
            p = force / size**2
            return case | {"pressure": rng.choice([p, 3 * p, -0.5 * p, f"{p}*(x/{size} - 0.1)"])} | where
        case "force":
            return case | {"force": force * rng.choice([1.0, 0.1, 20.0, -0.5]), "at": point(rng, plate)}
        case "line_load":
            q = rng.choice([force / size, f"{force / size}*(x/{size} - 0.1)"])
            return case | {"line_load": q} | _place(rng, plate, size, ["edge", "circle"])
        case "moment":
            return case | {
                "moment": [force * size * rng.choice([-0.1, 0.0, 0.2]), 0.1 * force * size],
                "at": point(rng, plate),
            }
        case "self_weight":
            return case | {"self_weight": True}
        case _:
            return case | {"curvature": [c * 1e-3 / size for c in rng.choice([[1.0, 0.0, 0.0], [0.0, -2.0, 1.0]])]}


def _repeat(rng: Random, supports: list[Tables]) -> None:
    """Add a copy of a support, or of one of its points, on the same or the other side of the plate."""
    twin = dict(rng.choice(supports))
    if len(twin.get("at", [])) > 1 and rng.random() < 0.5:
        twin["at"] = [rng.choice(twin["at"])]
    if "resists" in twin and rng.random() < 0.3:
        twin["resists"] = rng.choice(["down", "up", "both"])
    for _ in range(rng.choice([1, 1, 2])):
        supports.insert(rng.randint(0, len(supports)), dict(twin))


def _balance(rng: Random, tables: Tables, scale: _Scale) -> None:
    """Load the plate by two opposite couples, between stops that it may not reach."""
    couple = scale.force * scale.length * rng.choice([0.01, 0.2])
    at, other = point(rng, tables["plate"]), point(rng, tables["plate"])
    tables["load"] = [{"moment": [couple, 0.0], "at": at}, {"moment": [-couple, 0.0], "at": other}]
    tables["material"].pop("unit_weight", None)
    for support in tables["support"]:
        if "resists" in support and rng.random() < 0.7:
            support["gap"] = scale.length * rng.choice([1e-6, 1e-3])


def _generate(rng: Random, tables: Tables, scale: _Scale) -> None:
    """Replace the combinations by one table: rows, choices of cases, or positions of a moving load."""
    cases = sorted({load.get("case", "load") for load in tables["load"]})
    tables["combination"] = []
    if rng.random() < 0.5:
        line = [point(rng, tables["plate"]) for _ in range(rng.choice([2, 2, 3]))]
        truck: Tables = {"case": "truck", "line": line, "step": scale.length * rng.choice([0.3, 0.07])}
        truck["axles"] = rng.choice([[[0, scale.force]], [[0, scale.force], [0.1 * scale.length, 0.5 * scale.force]]])
        if rng.random() < 0.3:
            truck["gauge"] = 0.1 * scale.length
        if rng.random() < 0.3:
            truck["patch"] = [0.05 * scale.length, 0.02 * scale.length]
        tables["moving"] = [truck]
        factors = dict.fromkeys([*cases, "truck"], rng.choice([1.0, 1.35]))
        tables["combination"].append({"name": "traffic", "generate": "positions", "factors": factors})
    if rng.random() < 0.5:
        patterns: Tables = {"name": "ULS", "generate": "patterns"}
        patterns["variable"] = {cases[0]: rng.choice([1.5, [-1.0, 1.5]])}
        if cases[1:]:
            patterns["permanent"] = {case: [1.0, 1.35] for case in cases[1:]}
        tables["combination"].append(patterns)
    if rng.random() < 0.5 or not tables["combination"]:
        rows = {f"row {i}": [rng.choice([1.0, -1.0, 0.0, 1.35]) for _ in cases] for i in range(rng.choice([1, 3, 20]))}
        tables["combination"].append({"name": "wind", "generate": "table", "columns": cases, "rows": rows})
    if rng.random() < 0.5:
        tables["output"] = rng.choice(
            [
                {"combinations": "table"},
                {"combinations": "each"},
                {"combinations": "table", "fields": rng.choice(["all", "none", "governing", ["row 0"]])},
                {"combinations": "table", "envelope": rng.choice([[], ["deflection"], ["mx", "qy"]])},
            ]
        )
