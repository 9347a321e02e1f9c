"""Plates on soil, with and without tension, and over an obstacle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import log, pi, sqrt
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import kelvin

from signorini.validation.case import Case, Number, Tables, given
from signorini.validation.theory import TIMOSHENKO, rigidity, shear_factor

_NU = 0.3
_SOIL = {"name": "soil", "area": "all", "resists": "down"}
_KELVIN = "Closed form of the thin plate in Kelvin functions"
_WESTERGAARD = (
    "H. M. Westergaard, *Stresses in concrete pavements computed by theoretical analysis*, Public Roads 7 (1926)"
)
_OTHERS = "GetFEM (MITC4, 160 × 160 elements), CalculiX and OpenSees"


def cases() -> Iterator[Case]:
    """Yield the validation cases of this module."""
    yield from _discs()
    yield from _infinite()
    yield from _panels()
    yield _obstacle()
    yield _slab_a()
    yield _slab_b()


def lifted_disc(radius: float) -> tuple[float, float, float]:
    """Contact radius, w of the middle and w of the rim of a free thin disc on tensionless soil under P = 1; D = k = 1.

    Within the contact radius c, w = A ber r + B bei r − kei r/2π; beyond, the plate is free of load, so that V = 0, and
    slope and moment at c are those of a ring that is free at its outer edge.
    """

    def state(c: float) -> tuple[float, float, float, np.ndarray]:
        be, ke, slope_be, slope_ke = kelvin(c)
        w = np.array([be.real, be.imag, -ke.imag / 2 / pi])
        slope = np.array([slope_be.real, slope_be.imag, -slope_ke.imag / 2 / pi])
        bent = np.array([-be.imag, be.real, -ke.real / 2 / pi])
        force = np.array([-slope_be.imag, slope_be.real, -slope_ke.real / 2 / pi])
        a = np.append(np.linalg.solve([w[:2], force[:2]], [-w[2], -force[2]]), 1.0)
        return float(slope @ a), -float((bent - (1 - _NU) * slope / c) @ a), float(w @ a), a

    def jump(c: float) -> float:
        slope, moment, _, _ = state(c)
        return moment * (c + (1 + _NU) * radius**2 / (1 - _NU) / c) - slope * (1 + _NU) * (radius**2 / c**2 - 1)

    c = float(brentq(jump, 2.0, 2.95))
    slope, _, _, a = state(c)
    b = slope / (c + (1 + _NU) * radius**2 / (1 - _NU) / c) / 2
    rim = b * (radius**2 - c**2) + 2 * b * (1 + _NU) / (1 - _NU) * radius**2 * log(radius / c)
    return c, float(a[0]) + 1 / 8, rim


def _discs() -> Iterator[Case]:
    """Yield cases of free discs on tensionless soil under a central force."""
    h = 0.01
    for radius in (3, 5):
        contact, centre, rim = lifted_disc(radius)

        def tables(n: int, radius: int = radius) -> Tables:
            return {
                "material": {"E": 1 / rigidity(1.0, h, _NU), "nu": _NU},
                "plate": {"shape": "disc", "radius": radius, "thickness": h},
                "mesh": {"divisions": [n, 4 * n]},
                "support": [{**_SOIL, "stiffness": 1.0}],
                "load": [{"force": 1.0, "at": [0, 0]}],
                "probe": [{"at": [[0, 0], [radius, 0]]}],
            }

        yield Case(
            f"disc-tensionless-{radius}",
            f"Disc of radius {radius} ℓ on tensionless soil",
            ("disc", "tensionless soil", "point load", "lift-off"),
            f"Free disc of radius {radius} ℓ (ℓ = 1), D = k = 1, h = 0.01, ν = 0.3, force P = 1 in the middle.",
            f"{_KELVIN}: contact radius {contact:.6f} ℓ.",
            "analytical",
            tables,
            (6, 12, 24),
            (
                Number("soil.contact_area", "contact area/ℓ²", pi * contact**2, 1e-2, uncertainty=5e-5),
                Number("probe[1].deflection", "w kℓ²/P, middle", centre, 1e-2, uncertainty=2e-3 * centre),
                Number("probe[2].deflection", "uplift of the rim −w kℓ²/P", -rim, 1e-2, -1.0, 1e-6),
            ),
            "Under a force at a point the deflection of a plate with shear strain grows with log n (n elements); "
            "at h = ℓ/100 this growth is below 2e-3 of the deflection.",
        )


def _infinite() -> Iterator[Case]:
    """Yield cases of an infinite plate on soil, modelled as a disc of large radius."""

    def plate(radius: float, fine: float, size: float, resists: str, load: Mapping[str, Any], h: float) -> Tables:
        arcs = [{"through": [0, radius], "to": [-radius, 0]}, {"through": [0, -radius], "to": [radius, 0]}]
        near = {"area": {"circle": {"center": [0, 0], "radius": fine}}, "size": size}
        return {
            "material": {"E": 1 / rigidity(1.0, h, _NU), "nu": _NU},
            "plate": {"shape": "polygon", "points": [[radius, 0], *arcs], "thickness": h},
            "mesh": {"size": radius / 5, "refine": [near]},
            "support": [{**_SOIL, "resists": resists, "stiffness": 1.0}],
            "load": [load],
            "probe": [{"at": [[0, 0]]}],
        }

    contact, centre, _ = lifted_disc(20.0)
    yield Case(
        "weitsman",
        "Force on an infinite plate on tensionless soil (Weitsman)",
        ("polygon with arcs", "tensionless soil", "point load", "lift-off", "mesh refinement"),
        "Weightless plate of radius 20 ℓ (ℓ = 1), D = k = 1, h = 0.01, ν = 0.3, force P = 1 in the middle.",
        "Y. Weitsman, *On foundations that react in compression only*, J. Appl. Mech. 37 (1970): infinite "
        f"plate, contact radius 2.848918 ℓ, w = 0.1311657 P/kℓ². {_KELVIN} for 20 ℓ: {contact:.6f} ℓ, {centre:.6f}.",
        "analytical",
        lambda n: plate(20.0, 3.5, 1 / n, "down", {"force": 1.0, "at": [0, 0]}, 0.01),
        (2, 3, 4),
        (
            Number("soil.contact_area", "contact area/ℓ²", pi * contact**2, 1e-2, 1.0, 5e-5),
            Number("probe[1].deflection", "w kℓ²/P", centre, 1e-2, 1.0, 2e-3 * centre),
        ),
        "Shear strain under the point force adds less than 2e-3 of the deflection.",
    )
    a = 0.5
    _, _, _, slope = kelvin(a)
    w, moment = float(1 + a * slope.real), float((1 + _NU) * a / 2 * slope.imag)
    pressure = 1 / (pi * a**2)
    westergaard = (1 + _NU) / (4 * pi) * (log(2 / a) + 0.5 - 0.5772156649) + (1 + _NU) / (4 * pi) * pi / 32 * a**2
    yield Case(
        "westergaard-interior",
        "Wheel load inside a pavement (Westergaard)",
        ("polygon with arcs", "soil", "mesh refinement", "patch load"),
        "Plate of radius 12 ℓ (ℓ = 1), D = k = 1, h = 0.02, ν = 0.3, on soil; force P = 1 as pressure on a circle of "
        "radius a = 0.5 ℓ.",
        f"Exact Kelvin functions ({TIMOSHENKO}, chapter 8): w = q(1 + (a/ℓ) ker′(a/ℓ))/k, "
        f"m = (1 + ν) q a ℓ kei′(a/ℓ)/2. {_WESTERGAARD}: interior formula, with its term of a²/ℓ².",
        "analytical",
        lambda n: plate(12.0, 1.0, 0.5 / n, "both", {"pressure": pressure, "area": {"circle": {"radius": a}}}, 0.02),
        (2, 4, 8),
        (
            Number("probe[1].deflection", "w kℓ²/P", w * pressure, 2e-3, 1.0, 2e-4 * w * pressure),
            Number("probe[1].mx", "m/P", moment * pressure, 1e-2),
            Number("probe[1].mx", "m/P by Westergaard's formula", westergaard, 2e-2, 1.0, 5e-3 * westergaard),
        ),
    )
    # Ioannides, Thompson and Barenberg (1985) restate the formulas of Westergaard (1926, 1948).
    h, radius, half = 0.02, 0.2, 8.0
    side = radius * sqrt(pi)
    young = 1 / rigidity(1.0, h, 0.15)
    edge = sqrt(2 + 1.2 * 0.15) / sqrt(young * h**3) * (1 - (0.76 + 0.4 * 0.15) * radius)
    corner = 1.205 - 0.69 * side

    def slab(n: int, box: list[float]) -> Tables:
        lower = [0.0, 0.0] if box[0] == 0 else [-half, 0.0]
        size = [2 * half, half] if box[0] else [half, half]
        return {
            "material": {"E": young, "nu": 0.15},
            "plate": {"shape": "rectangle", "size": size, "origin": lower, "thickness": h},
            "mesh": {"size": 1.0, "refine": [{"area": {"rectangle": box}, "size": side / n}]},
            "support": [{**_SOIL, "resists": "both", "stiffness": 1.0}],
            "load": [{"pressure": 1 / side**2, "area": {"rectangle": box}}],
            "probe": [{"at": [[0, 0]]}],
        }

    for name, title, box, value, tolerance in (
        ("edge", "at the edge", [-side / 2, 0.0, side / 2, side], edge, 5e-2),
        ("corner", "at the corner", [0.0, 0.0, side, side], corner, 5e-2),
    ):
        yield Case(
            f"westergaard-{name}",
            f"Wheel load {title} of a pavement (Westergaard)",
            ("rectangle", "soil", "mesh refinement", "patch load"),
            f"Slab that extends 8 ℓ from the load, D = k = 1, h = 0.02, ν = 0.15, force P = 1 on a square of side "
            f"{side:.3f} ℓ {title}.",
            f"{_WESTERGAARD}, in the form of A. M. Ioannides, M. R. Thompson, E. J. Barenberg, *Westergaard solutions "
            "reconsidered*, Transp. Res. Rec. 1043 (1985): edge w = P√(2 + 1.2ν)/√(Eh³k) (1 − (0.76 + 0.4ν)a/ℓ); "
            "corner w = P(1.205 − 0.69c/ℓ)/kℓ².",
            "numerical",
            given(lambda n, box: slab(n, box), box),
            (1, 2, 4),
            (Number("probe[1].deflection", f"w kℓ²/P {title}", value, tolerance, 1.0, 3e-2 * value),),
            "Westergaard's formula is a fit to his series, Ioannides' formula a fit to finite elements. The error of "
            "both is taken as 3 %. The square has the area of the circle that the formulas are for.",
        )


def _panel(u: float, h: float, bed: float, terms: int = 400) -> tuple[float, float, float, float]:
    """Square panel of side 1 and D = 1, ν = 0.2, of an infinite plate with columns u × u at its corners.

    Return w and m at the column's centre, m at the panel's middle, and w at the panel's middle minus the mean w of the
    column's area.
    Without soil, q = 1 and the columns push up; on soil of stiffness ``bed`` each column pushes down with force 1.
    """
    m, n = np.arange(terms)[:, None], np.arange(terms)[None, :]
    shape = np.sinc(m * u) * np.sinc(n * u)
    square = (2 * pi) ** 2 * np.maximum(m**2 + n**2, 1e-9)
    softer = 1 + shear_factor(h, 0.2) * square
    curved = np.where(m > 0, 2.0, 1.0) * np.where(n > 0, 2.0, 1.0) * shape / (square**2 + bed * softer)
    curved = np.where((m + n > 0) | (bed > 0), curved, 0.0) * (1.0 if bed else -1.0)
    w, moment, middle = curved * softer, curved * (2 * pi) ** 2 * (m**2 + 0.2 * n**2), (-1.0) ** (m + n)
    return float(w.sum()), float(moment.sum()), float((moment * middle).sum()), float((w * (middle - shape)).sum())


def _panels() -> Iterator[Case]:
    """Yield cases of infinite flat slabs; the model is a quarter of a panel with symmetry on all sides."""
    u, h = 0.1, 0.005

    def tables(n: int, support: Sequence[Mapping[str, Any]], load: Sequence[Mapping[str, Any]]) -> Tables:
        edges = {"edge": ["left", "right", "bottom", "top"], "fix": "symmetry"}
        return {
            "material": {"E": 1 / rigidity(1.0, h, 0.2), "nu": 0.2},
            "plate": {"shape": "rectangle", "size": [0.5, 0.5], "thickness": h},
            "mesh": {"divisions": [n, n]},
            "support": [edges, *support],
            "load": load,
            "probe": [{"at": [[0, 0], [0.5, 0.5]]}],
        }

    _, peak, m, w = _panel(u, h, 0.0)
    column = [{"name": "column", "at": [[0, 0]], "patch": [u, u], "fix": "simple"}]
    yield Case(
        "flat-slab-panel",
        "Interior panel of a flat slab (SAFE example 5)",
        ("rectangle", "symmetry", "footprints", "uniform pressure"),
        "Infinite plate on columns u × u at the distance a, u/a = 0.1, h/a = 0.005, D = 1, ν = 0.2, q = 1; a column's "
        "reaction is a uniform pressure on its section.",
        f"{TIMOSHENKO}, art. 54; double cosine series with shear strain. SAFE Software Verification, example 5.",
        "analytical",
        lambda n: tables(n, column, [{"pressure": 1.0}]),
        (10, 20, 40),
        (
            Number("probe[2].deflection", "w D/qa⁴, middle of the panel minus mean over the column", w, 2e-3),
            Number("probe[2].mx", "m/qa², middle", m, 1e-2),
            Number("probe[1].mx", "m/qa² over the column", peak, 2e-2),
            Number("column.reaction", "reaction of a quarter column/qa²", 0.25, 1e-6),
        ),
    )
    k = 400.0
    w, peak, m, _ = _panel(u, h, k)
    soil = [{**_SOIL, "resists": "both", "stiffness": k}]
    load = {"pressure": 1 / u**2, "area": {"rectangle": [0, 0, u / 2, u / 2]}}
    yield Case(
        "raft-panel",
        "Interior panel of a raft on soil (SAFE example 6)",
        ("rectangle", "symmetry", "soil", "patch load"),
        "Infinite plate on soil of k = 400 D/a⁴ under columns u × u at the distance a, u/a = 0.1, each with P = 1; "
        "h/a = 0.005, ν = 0.2.",
        f"{TIMOSHENKO}, chapter 8; double cosine series with shear strain. SAFE Software Verification, example 6.",
        "analytical",
        lambda n: tables(n, soil, [load]),
        (10, 20, 40),
        (
            Number("probe[1].deflection", "w D/Pa², column", w, 1e-3),
            Number("probe[1].mx", "m/P, column", peak, 1e-2),
            Number("probe[2].mx", "m/P, middle", m, 1e-2),
        ),
    )


def _obstacle() -> Case:
    """Return the case of a clamped disc over an obstacle."""

    def free(r: float) -> float:
        return 0.5250406303 * r * r * log(r) - 0.6286090479 * r * r + 0.01726640079 * log(r) + 1.046746304

    return Case(
        "obstacle",
        "Clamped disc over a curved obstacle",
        ("disc", "rigid floor", "settlement", "clamped edges"),
        "Disc of radius 2, h = 0.01, clamped rim, no load, over the rigid obstacle 1 − r².",
        "S. C. Brenner, L. Sung, Y. Zhang, *Finite element methods for the displacement obstacle problem of clamped "
        "plates*, Math. Comp. 81 (2012): the plate touches up to r = 0.18134453, beyond u = C₁r² ln r + C₂r² + "
        "C₃ ln r + C₄.",
        "analytical",
        lambda n: {
            "material": {"E": 1.0, "nu": _NU},
            "plate": {"shape": "disc", "radius": 2, "thickness": 0.01},
            "mesh": {"divisions": [n, 2 * n]},
            "support": [
                {"area": "all", "resists": "down", "settlement": "x**2 + y**2 - 1"},
                {"edge": ["rim"], "fix": "clamped"},
            ],
            "load": [{"pressure": 0.0}],
            "probe": [{"at": [[0.5, 0], [1, 0], [1.5, 0]]}],
        },
        (8, 16, 24),
        tuple(
            Number(f"probe[{i}].deflection", f"−w, r = {r:g}", free(r), 5e-3, -1.0, 2e-5)
            for i, r in ((1, 0.5), (2, 1.0), (3, 1.5))
        ),
        "The modelled plate has the thickness 0.01; its shear strain changes the deflection by about 1e-5.",
    )


def _slab(n: int, support: Mapping[str, Any]) -> Tables:
    """Concrete slab of 10 m × 10 m × 0.3 m with 2 kPa and 500 kN on a patch near a corner."""
    return {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        "mesh": {"divisions": [n, n]},
        "support": [support],
        "load": [{"pressure": 2e3}, {"pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}}],
    }


_SLAB = "Slab 10 m × 10 m × 0.3 m, E = 30 GPa, ν = 0.2, 2 kPa everywhere and 500 kN on 1 m × 1 m centred at (1, 1)"


def _slab_a() -> Case:
    return Case(
        "slab-a",
        "Slab A on tensionless soil, against other programs",
        ("rectangle", "tensionless soil", "patch load", "lift-off"),
        f"{_SLAB}; soil of 30 MN/m³ that only pushes.",
        f"{_OTHERS}: settlement 4.229 mm, pressure 126.86 kPa, contact 0.915 to 0.917 of the area; "
        "uplift 0.0145 to 0.015 mm.",
        "numerical",
        lambda n: _slab(n, {**_SOIL, "stiffness": 30e6}),
        (10, 20, 40),
        (
            Number("deflection.max", "settlement [mm]", 4.229, 2e-3, 1e3, 5e-4),
            Number("deflection.min", "uplift −w [mm]", 0.01475, 5e-2, -1e3, 2.5e-4),
            Number("soil.contact_area", "contact/area", 0.916, 3e-3, 1e-2, 1e-3),
            Number("soil.max_pressure", "largest pressure [kPa]", 126.86, 2e-3, 1e-3, 5e-3),
        ),
    )


def _slab_b() -> Case:
    rows = [333.96, 93.67, 0, 5.85, 93.67, 71.92, 7.92, 14.01, 0, 7.92, 21.46, 11.79, 5.85, 14.01, 11.79, 6.17]
    points = [[x, y] for y in (0.5, 3.5, 6.5, 9.5) for x in (0.5, 3.5, 6.5, 9.5)]
    return Case(
        "slab-b",
        "Slab B on 16 points that only push, against another program",
        ("rectangle", "one-sided points", "patch load", "lift-off"),
        f"{_SLAB}; 16 rigid points at x, y ∈ {{0.5, 3.5, 6.5, 9.5}} that only push.",
        "Another program with MITC4 elements, 160 × 160: exactly two points lift, (6.5, 0.5) and (0.5, 6.5).",
        "numerical",
        lambda n: _slab(n, {"name": "points", "at": points, "resists": "down"}),
        (10, 20, 40),
        tuple(
            Number(f"points[{i}].reaction", f"reaction {i} [kN]", value, 1e-3, 1e-3, 5e-3, size=333.96)
            for i, value in enumerate(rows, 1)
        ),
        "Deflections at supports without footprint grow with log n, so that reactions depend on the mesh (n × n). "
        "Errors are relative to the largest reaction.",
    )
