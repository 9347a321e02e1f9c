"""Rigid plates on soil and bolts: footings, base plates, preloaded joints, against statics."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import pi, sqrt
from typing import Any

import numpy as np
from scipy.optimize import brentq, fsolve

from signorini.validation.case import Case, Number, Tables, given

_ASTER = "Code_Aster validation manual V6.02.130, SSNL130"
_PRESSURE = "pressures of a rigid plate are linear in x and y where they are positive"
_MOFFITT = "C. J. Moffitt, *Footing soil pressure from biaxial loading*, Civil Eng. J. 5 (2019), no. 11"


def cases() -> Iterator[Case]:
    """Yield the validation cases of this module."""
    yield from _ssnl130()
    yield from _footings()
    yield from _discs()
    yield _base_plate()
    yield from _joints()
    yield _crushing()
    yield _prying()
    yield from _flange()


def _ssnl130() -> Iterator[Case]:
    """Yield Code_Aster's case SSNL130 in both load steps: on a continuous bed, and on springs along 17 lines."""

    def tables(along: int, n: int, support: Sequence[Mapping[str, Any]], young: float) -> Tables:
        return {
            "material": {"E": young, "nu": 0.3},
            "plate": {"shape": "rectangle", "size": [1, 2], "thickness": 0.3},
            "mesh": {"divisions": [along, n]},
            "support": support,
            "load": [{"pressure": "5*(y-2)**2"}],
            "probe": [{"at": [[0.5, 0], [0.5, 2]]}],
        }

    stiffness = [1e4 / 16 / (2 if i in (0, 16) else 1) for i in range(17)]
    for step, moved in ((1, 0.0), (2, -5e-3)):
        soil = [{"name": "soil", "area": "all", "resists": "down", "stiffness": 5e3, "settlement": moved}]
        lines = [
            {"name": f"l{i}", "line": [[0, i / 8], [1, i / 8]], "resists": "down", "stiffness": k, "settlement": moved}
            for i, k in enumerate(stiffness)
        ]
        what = "" if step == 1 else "; the lower ends of the springs move up by 5 mm"
        yield Case(
            f"ssnl130-bed-{step}",
            f"SSNL130, continuous bed, step {step}",
            ("rectangle", "tensionless soil", "lift-off", "settlement", "pressure by a formula"),
            "Near-rigid plate 1 m × 2 m × 0.3 m, E = 2e11 Pa, on soil of total stiffness 1e4 N/m that only pushes, "
            f"p = 5(y − 2)²{what}.",
            f"{_ASTER}: w(0) = 4/1125 m, w(2) = −4/3375 m, contact 1.5 m.",
            "analytical",
            given(lambda n, soil: tables(max(1, n // 2), n, soil, 2e11), soil),
            (10, 21, 42),
            (
                Number("probe[1].deflection", "w at y = 0 [m]", 4 / 1125 + moved, 1e-2, uncertainty=1e-9),
                Number("probe[2].deflection", "w at y = 2 [m]", -4 / 3375 + moved, 1e-2, uncertainty=1e-9),
                Number("soil.contact_area", "contact area [m²]", 1.5, 1e-2, uncertainty=1e-6),
                Number("soil.reaction", "reaction [N]", 40 / 3, 1e-6, uncertainty=1e-9),
            ),
            "The bending of the plate is 1e-7 of its deflection, so that it acts as rigid.",
        )
        yield Case(
            f"ssnl130-lines-{step}",
            f"SSNL130, springs on 17 lines, step {step}",
            ("rectangle", "one-sided lines", "lift-off", "settlement", "pressure by a formula"),
            f"SSNL130 with springs on 17 lines y = i/8 as soil, the first and last half as stiff; E = 2e13 Pa{what}.",
            f"{_ASTER}: lines 0 to 12 touch, w(0) = 208/58875 m, w(2) = −176/153075 m.",
            "analytical",
            given(lambda n, lines: tables(n, 16 * n, lines, 2e13), lines),
            (1, 2, 4),
            (
                Number("probe[1].deflection", "w at y = 0 [m]", 208 / 58875 + moved, 1e-6, uncertainty=1e-11),
                Number("probe[2].deflection", "w at y = 2 [m]", -176 / 153075 + moved, 1e-6, uncertainty=1e-11),
                Number("l13.reaction", "reaction of line 13 [N]", 0.0, 1e-9, size=1.0),
            ),
            "E is 100 times that of the plate on a bed: with 2e11 Pa the bending would be 1.3e-7 of the deflection.",
        )


def _rigid(
    size: Sequence[float], n: int, at: Sequence[float], soil: Mapping[str, Any], load: float = 1.0, **more: Any
) -> Tables:
    """Near-rigid rectangle on soil that only pushes, under a force."""
    return {
        "material": {"E": 1e12, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": size, "thickness": 1},
        "mesh": {"divisions": [n, max(1, round(n * size[1] / size[0]))]},
        "support": [{"name": "soil", "area": "all", "resists": "down", "stiffness": 1e6, **soil}],
        "load": [{"force": load, "at": at}],
        **more,
    }


def _biaxial(ex: float, ey: float) -> tuple[float, float]:
    """Largest pressure and contact area of a rigid unit square on soil; a unit force acts (ex, ey) off its middle."""
    x = (np.arange(2000) + 0.5) / 2000 - 0.5
    y = x[:, None]

    def pressure(plane: np.ndarray) -> np.ndarray:
        return np.asarray(np.maximum(plane[0] + plane[1] * x + plane[2] * y, 0.0))

    def imbalance(plane: np.ndarray) -> list[float]:
        p = pressure(plane) / 2000**2
        return [p.sum() - 1, (p * x).sum() - ex, (p * y).sum() - ey]

    plane = fsolve(imbalance, [1.0, 12 * ex, 12 * ey], xtol=1e-13)
    return float(plane[0] + (plane[1] + plane[2]) / 2), float((pressure(plane) > 0).mean())


def _footings() -> Iterator[Case]:
    """Yield cases of rigid square footings of side 2 under an eccentric force."""
    sixth = 1 / 12
    corner = 3 / (8 * 0.2 * 0.2)
    both = _biaxial(0.15, 0.15)
    for name, e, peak, area, source in (
        ("kern", (sixth, 0.0), 1.5, 1.0, "within the kern, largest p = P/A (1 + 6e/B)"),
        ("quarter", (0.25, 0.0), 8 / 3, 0.75, "contact on a length of 3(B/2 − e), largest p = 8/3 P/A"),
        ("kern-two-way", (1 / 24, 1 / 24), 1.5, 1.0, "within the kern, largest p = P/A (1 + 6eₓ/B + 6e_y/L)"),
        (
            "two-way",
            (0.15, 0.15),
            *both,
            "linear pressure solved numerically; K. Hülsdünker, *Maximale Bodenpressung unter rechteckigen "
            "Fundamenten*, Bautechnik 41 (1964), tabulates this problem",
        ),
        (
            "corner",
            (0.3, 0.3),
            corner,
            0.32,
            f"{_MOFFITT}: tetrahedron of pressure on a triangle with legs 4(B/2 − eₓ) and 4(L/2 − e_y), "
            "p = 3P/(8(B/2 − eₓ)(L/2 − e_y))",
        ),
    ):
        numeric = name == "two-way"
        own = 5e-5 if numeric else 1e-5
        yield Case(
            f"footing-{name}",
            f"Rigid square footing, e/B = {e[0]:.3g}, {e[1]:.3g}",
            ("rectangle", "tensionless soil", "point load", *(("lift-off",) if area < 1 else ())),
            f"Rigid footing 2 × 2 on soil that only pushes, force P = 1 at ({e[0]:.4g}, {e[1]:.4g}) B.",
            f"Statics, {_PRESSURE}: {source}.",
            "analytical",
            given(lambda n, e: _rigid((2, 2), n, [1 + 2 * e[0], 1 + 2 * e[1]], {}), e),
            (6, 12, 24),
            (
                Number("soil.max_pressure", "largest pressure/(P/A)", peak, 1e-3, 4.0, own * peak),
                Number("soil.contact_area", "contact/A", area, 1e-3, 0.25, 1e-3 if numeric else 1e-5),
            ),
            "The thickness is half of the side and E/k is large, so that bending is about 1e-5 of the settlement.",
        )


def _discs() -> Iterator[Case]:
    """Yield cases of rigid circular footings under an eccentric force."""

    def segment(c: float) -> tuple[float, float]:
        """Return e/R and the largest pressure over P/A of a disc of radius R = 1 with pressure ∝ x − c for x > c."""
        x = np.linspace(c, 1.0, 200001)
        chord, rise = 2 * np.sqrt(np.maximum(1 - x**2, 0.0)), x - c
        force = np.trapezoid(chord * rise, x)
        return float(np.trapezoid(chord * rise * x, x) / force), float((1 - c) * pi / force)

    c = brentq(lambda c: segment(c)[0] - 0.5, -0.99, 0.9)
    area = float(np.arccos(c) - c * sqrt(1 - c**2)) / pi
    for name, e, peak, part, source in (
        ("kern", 0.125, 1.5, 1.0, "within the kern R/4, largest p = P/A (1 + 4e/R)"),
        ("half", 0.5, segment(c)[1], area, "pressure on a segment of the disc; K. Pohl (1918) tabulates this problem"),
    ):
        yield Case(
            f"disc-footing-{name}",
            f"Rigid circular footing, e/R = {e:g}",
            ("disc", "tensionless soil", "point load", *(("lift-off",) if part < 1 else ())),
            f"Rigid disc of radius 1 on soil that only pushes, force P = 1 at e = {e:g} R.",
            f"Statics, {_PRESSURE}: {source}.",
            "analytical",
            given(
                lambda n, e: {
                    **_rigid((2, 2), n, [e, 0], {}),
                    "plate": {"shape": "disc", "radius": 1, "thickness": 1},
                    "mesh": {"divisions": [n, 4 * n]},
                },
                e,
            ),
            (4, 8, 16),
            (
                Number("soil.max_pressure", "largest pressure/(P/A)", peak, 1e-3, pi, 2e-5 * peak),
                Number("soil.contact_area", "contact/A", part, 1e-3, 1 / pi, 2e-5),
            ),
        )


def _base_plate() -> Case:
    """Return the case of a base plate with two anchors in tension."""
    return Case(
        "base-plate",
        "Rigid base plate on grout with anchors",
        ("rectangle", "tensionless soil", "bolts", "lift-off"),
        "Rigid plate 0.6 m × 0.4 m on a bed of 1e10 N/m³ without tension; two anchors, 4e8 N/m together, 0.25 m from "
        "the middle; P = 500 kN at e = 0.35 m.",
        "Equilibrium of a linear pressure and the anchors: compressed length 0.362679 m, anchors 199.126 kN, p = 9.638 "
        "MPa.",
        "analytical",
        lambda n: {
            "material": {"E": 2e16, "nu": 0.3},
            "plate": {"shape": "rectangle", "size": [0.6, 0.4], "origin": [-0.3, -0.2], "thickness": 0.1},
            "mesh": {"divisions": [n, 2 * n // 3]},
            "support": [
                {"name": "grout", "area": "all", "resists": "down", "stiffness": 1e10},
                {"name": "anchors", "at": [[-0.25, -0.1], [-0.25, 0.1]], "resists": "up", "stiffness": 2e8},
            ],
            "load": [{"force": 500e3, "at": [0.3, 0]}, {"moment": [25e3, 0], "at": [0, 0]}],
        },
        (12, 24, 48),
        (
            Number("grout.contact_area", "compressed length [m]", 0.362679, 1e-3, 2.5, 5e-7),
            Number("anchors.reaction", "anchors [kN]", 199.126, 1e-3, -1e-3, 5e-4),
            Number("grout.max_pressure", "largest pressure [MPa]", 9.638, 1e-3, 1e-6, 5e-4),
        ),
    )


def _joints() -> Iterator[Case]:
    """Yield cases of a preloaded joint before and after separation."""
    bed, bolt, force, n_bolts = 2e9, 2e8, 50e3, 4
    separates = n_bolts * force * (n_bolts * bolt + bed) / bed
    for name, pull in (("before", 0.8 * separates), ("after", 1.2 * separates)):
        each = force + bolt * pull / (n_bolts * bolt + bed) if pull < separates else pull / n_bolts
        clamped = max(n_bolts * each - pull, 0.0)
        yield Case(
            f"joint-{name}",
            f"Preloaded joint, {name} separation",
            ("rectangle", "bolts", "preload", "rigid zones", *(("lift-off",) if pull > separates else ())),
            f"Rigid block 1 m × 1 m on a bed of 2e9 N/m, four bolts of 2e8 N/m tightened to 50 kN, pull "
            f"{pull / 1e3:.0f} kN.",
            "VDI 2230 Part 1 (2015), joint diagram of n bolts (preload F, stiffness k_b) and bed K: bolt force "
            "F + k_b P/(n k_b + K) up to the pull P = nF(n k_b + K)/K, at which the joint separates, then P/n.",
            "analytical",
            given(
                lambda n, pull: {
                    "material": {"E": 210e9, "nu": 0.3},
                    "plate": {"shape": "rectangle", "size": [1, 1], "thickness": 0.1},
                    "mesh": {"divisions": [n, n]},
                    "zone": [{"area": {"rectangle": [0, 0, 1, 1]}, "rigid": True}],
                    "support": [
                        {"name": "bed", "area": "all", "resists": "down", "stiffness": bed},
                        {
                            "name": "bolts",
                            "at": [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]],
                            "resists": "up",
                            "stiffness": bolt,
                            "preload": force,
                        },
                    ],
                    "load": [{"pressure": -pull}],
                },
                pull,
            ),
            (4, 8, 16),
            (
                Number("bolts[1].reaction", "bolt [kN]", each / 1e3, 1e-6, -1e-3),
                Number("bed.reaction", "force between the parts [kN]", clamped / 1e3, 1e-6, 1e-3, size=force / 1e3),
            ),
        )


def _crushing() -> Case:
    """Return the case of a rigid block on soil that crushes."""
    width, limit, eccentricity, stiffness = 2.0, 200e3, 0.3, 1e8
    force = 0.95 * limit * width * (width - 2 * eccentricity)
    mean, arm = force / width / limit, width / 2 - eccentricity
    falling = sqrt(24 * (mean * arm - mean**2 / 2))
    return Case(
        "block-crushing",
        "Rigid block on soil that crushes",
        ("rectangle", "tensionless soil", "limit", "lift-off"),
        "Rigid block 2 m × 2 m on soil of 1e8 N/m³ that crushes at p_u = 200 kPa; N = 0.95 p_u B(B − 2e) at e = 0.3 m.",
        "Statics: the pressure is p_u on a length a and falls linearly to 0 on a length c, with a + c/2 = N/p_u B and "
        "the resultant at N. The largest possible N is p_u B(B − 2e).",
        "analytical",
        lambda n: {
            **_rigid((width, width), n, [width / 2 + eccentricity, 1], {"stiffness": stiffness, "limit": limit}, force),
            "material": {"E": 30e12, "nu": 0.2},
        },
        (10, 20, 40),
        (
            Number("soil.yielded_area", "yielded area [m²]", (mean - falling / 2) * width, 1e-3, uncertainty=2e-3),
            Number("soil.contact_area", "contact area [m²]", (mean + falling / 2) * width, 1e-3, uncertainty=1e-3),
            Number("soil.max_pressure", "largest pressure [kPa]", 200.0, 1e-9, 1e-3),
        ),
    )


def _prying() -> Case:
    """Return the case of prying: half of a T-stub, modelled as a strip."""
    m, length = 1.0, 0.8
    prying = 3 * m**2 / (2 * length * (length + 3 * m))
    h = 0.005
    return Case(
        "t-stub",
        "Prying force of a T-stub",
        ("strip", "bolts", "one-sided lines", "symmetry"),
        "Half of a T-stub: strip with EI = 1 per width, pulled up by F = 1 at its web, where the slope is 0; rigid "
        "bolts as a line at m = 1, and the tip on a rigid line at n = 0.8 beyond the bolts.",
        "R. T. Douty, W. McGuire, *High strength bolted moment connections*, J. Struct. Div. ASCE 91 (1965), "
        "for rigid bolts: prying force Q = F · 3m²/2n(n + 3m).",
        "analytical",
        lambda n: {
            "material": {"E": 12 / h**3, "nu": 0},
            "plate": {"shape": "rectangle", "size": [m + length, 0.2], "thickness": h},
            "mesh": {"divisions": [9 * n, 1]},
            "support": [
                {"edge": "left", "fix": "symmetry"},
                {"name": "bolts", "line": [[m, 0], [m, 0.2]], "resists": "up"},
                {"name": "tip", "edge": "right", "resists": "down"},
            ],
            "load": [{"line_load": -1.0, "edge": "left"}],
            "probe": [{"at": [[0.0, 0.1]]}],
        },
        (1, 2, 4),
        (
            Number("tip.reaction", "Q/F", prying, 1e-3, 5.0, 5e-5),
            Number("bolts.reaction", "bolt force/F", 1 + prying, 1e-3, -5.0, 5e-5),
            Number("probe[1].mx", "moment at the web/Fm", prying * length - m, 1e-2, uncertainty=5e-5),
        ),
    )


def _flange() -> Iterator[Case]:
    """Yield cases of a segment of an L-flange, compared with the bolt force by Schmidt and Neuper."""
    young, t, a, b, c, force = 210e3, 120.0, 75.0, 70.0, 100.0, 1e6
    bolt, clamped = young * 1473 / (2 * t + 10), young * pi / 4 * ((74 + 24) ** 2 - 48**2) / (2 * t)
    p, q = bolt / (bolt + clamped), clamped / (bolt + clamped)
    steep, first = (0.7 * a + b) / (0.7 * a), (a - b / 2) / (a + b)
    for name, part, bolt_force, tolerance in (
        ("closed", 0.2, 1 + 0.2 * p, 3e-2),
        ("open", 0.7, 0.7 * steep, 1e-1),
    ):
        assert (part < first) if name == "closed" else (part > 1 / steep / q)
        yield Case(
            f"l-flange-{name}",
            f"L-flange of a wind tower, {name} joint",
            ("rectangle", "bolts", "preload", "tensionless soil", "symmetry", *(("lift-off",) if part > 0.5 else ())),
            "Segment of an L-flange as a plate in N and mm: width 100, bolt at b = 70 from the shell and a = 75 from "
            f"the inner edge, thickness 120, bolt M48 tightened to F_V = 1 MN, pull Z = {part:g} F_V on the edge at "
            "the shell. The joint is a tensionless bed E/t, t = 120, down to its plane of symmetry.",
            "H. Schmidt, M. Neuper, *Zum elastostatischen Tragverhalten exzentrisch gezogener L-Stöße*, Stahlbau 66 "
            "(1997), as in IEC 61400-6:2020: F = F_V + pZ up to Z = F_V(a − b/2)/(a + b), with the bolt's share "
            "p of the joint's stiffness; once the joint has opened F = Z(0.7a + b)/0.7a.",
            "analytical",
            given(
                lambda n, part: {
                    "material": {"E": young, "nu": 0.3},
                    "plate": {"shape": "rectangle", "size": [a + b, c], "thickness": t},
                    "mesh": {"divisions": [n, round(n * c / (a + b))]},
                    "support": [
                        {"name": "joint", "area": "all", "resists": "down", "stiffness": young / t},
                        {
                            "name": "bolt",
                            "at": [[b, c / 2]],
                            "radius": 37,
                            "resists": "up",
                            "stiffness": 2 * bolt,
                            "preload": force,
                        },
                        {"edge": ["top", "bottom"], "fix": "symmetry"},
                    ],
                    "load": [{"line_load": -part * force / c, "edge": "left"}],
                },
                part,
            ),
            (6, 12, 24),
            (Number("bolt[1].reaction", "bolt F/F_V", bolt_force, tolerance, -1 / force, tolerance * bolt_force),),
            "The reference assumes where the joint is compressed, the plate model computes it. The tolerance covers "
            "this difference of the two models.",
        )
