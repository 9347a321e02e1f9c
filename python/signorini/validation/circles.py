"""Circular and annular plates against the closed form of axisymmetric bending with shear strain."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import pi
from typing import Any

from signorini.validation.case import Case, Number, Tables
from signorini.validation.theory import KAPPA, TIMOSHENKO, Ring, Rings, rigidity

_NU = 0.3
_ROARK = "W. C. Young, R. G. Budynas, *Roark's Formulas for Stress and Strain*"
_ASTER = "Code_Aster validation manual V3.03.101 (SSLS101) and V3.03.100 (SSLS100)"
_SHEAR = "The closed form includes the shear strain Q/κGh, so that thin and thick plates have an exact reference."
_W, _MR, _MT = "probe[1].deflection", "probe[1].mx", "probe[1].my"


def _ring(inner: float, outer: float, h: float, pressure: float = 0.0, line_load: float = 0.0) -> Ring:
    """Ring of thickness h with E = 1."""
    return Ring(inner, outer, rigidity(1.0, h, _NU), KAPPA * h / 2 / (1 + _NU), pressure, line_load)


def _disc(
    plate: Mapping[str, Any], supports: Sequence[Mapping[str, Any]], load: Mapping[str, Any], at: float, n: int
) -> Tables:
    """Disc or annulus with E = 1 and n elements along the radius; the probe is on the x axis."""
    around = 16 if n <= 4 else 4 * n
    return {
        "material": {"E": 1.0, "nu": _NU},
        "plate": plate,
        "mesh": {"divisions": [n, around]},
        "support": supports,
        "load": [load],
        "probe": [{"at": [[at, 0]]}],
    }


def _case(
    name: str,
    title: str,
    problem: str,
    source: str,
    exact: Rings,
    plate: Mapping[str, Any],
    fixed: Mapping[str, str],
    load: Mapping[str, Any],
    at: float,
    moments: tuple[float, float] = (1e-2, 1e-2),
    meshes: tuple[int, ...] = (4, 8, 16),
) -> Case:
    """Return a case that compares w, mr and mt at radius ``at``; ``moments``: tolerances of mr and mt, 0 to omit."""
    w, radial, tangential = exact.at(at)
    where = "middle" if at == 0 else f"r = {at:g}"
    numbers = [Number(_W, f"w, {where}", w, 1e-3)]
    for key, label, value, tolerance in ((_MR, "mr", radial, moments[0]), (_MT, "mt", tangential, moments[1])):
        if tolerance:
            numbers.append(Number(key, f"{label}, {where}", value, tolerance))
    supports = [{"edge": edge, "fix": fix} for edge, fix in fixed.items()]
    features = ("disc" if plate["shape"] == "disc" else "annulus", *(f"{fix} edges" for fix in set(fixed.values())))
    more = ("line load on a circle",) if "line_load" in load else ("uniform pressure",)
    return Case(
        name,
        title,
        (*features, *more),
        problem,
        source,
        "analytical",
        lambda n: _disc(plate, supports, load, at, n),
        meshes,
        tuple(numbers),
        _SHEAR,
    )


def cases() -> Iterator[Case]:
    """Yield the validation cases of this module."""
    for fix, aster, h in (
        ("simple", "SSLS101", 0.1),
        ("clamped", "SSLS100", 0.1),
        *((fix, "thin", 1e-3) for fix in ("simple", "clamped")),
    ):
        yield _case(
            f"disc-{fix}-{1 / h:.0f}",
            f"Disc, {'simply supported' if fix == 'simple' else fix}, h/R = {h:g}"
            + (f" ({aster})" if aster != "thin" else ""),
            f"Disc of radius 1 and thickness {h:g}, E = 1, ν = 0.3, uniform pressure 1, rim {fix}.",
            f"{_ASTER}; {TIMOSHENKO}, chapter 3: w = qR⁴(5 + ν)/64D(1 + ν) (simple) or qR⁴/64D (clamped), plus the "
            "shear deflection qR²/4κGh.",
            Rings([_ring(0, 1, h, 1.0)], _NU, "centre", fix),
            {"shape": "disc", "radius": 1, "thickness": h},
            {"rim": fix},
            {"pressure": 1.0},
            0.0,
            (1e-2, 0.0),
        )
    h = 0.05
    disc = {"shape": "disc", "radius": 1, "thickness": h}
    annulus = {"shape": "annulus", "inner": 0.4, "outer": 1, "thickness": h}
    yield _case(
        "disc-patch",
        "Clamped disc under pressure on its middle",
        "Disc of radius 1, h = 0.05, E = 1, ν = 0.3, clamped rim, pressure 1 within r = 0.5.",
        f"{TIMOSHENKO}, chapter 3; {_ROARK}.",
        Rings([_ring(0, 0.5, h, 1.0), _ring(0.5, 1, h)], _NU, "centre", "clamped"),
        disc,
        {"rim": "clamped"},
        {"pressure": 1.0, "area": {"circle": {"radius": 0.5}}},
        0.0,
        (1e-2, 0.0),
    )
    yield _case(
        "disc-ring-load",
        "Simply supported disc under a ring load",
        "Disc of radius 1, h = 0.05, E = 1, ν = 0.3, simply supported rim, line load 1 on the circle r = 0.5.",
        f"{TIMOSHENKO}, chapter 3; {_ROARK}.",
        Rings([_ring(0, 0.5, h), _ring(0.5, 1, h, line_load=1.0)], _NU, "centre", "simple"),
        disc,
        {"rim": "simple"},
        {"line_load": 1.0, "circle": {"radius": 0.5}},
        0.0,
        (1e-2, 0.0),
    )
    for name, title, inner, outer, load, at, moments in (
        ("outer-simple", "simply supported outside, free inside, pressure", "free", "simple", 0, 0.4, (0, 1e-2)),
        ("outer-clamped", "clamped outside, free inside, pressure", "free", "clamped", 0, 1.0, (2e-2, 0)),
        ("inner-clamped", "clamped inside, free outside, pressure", "clamped", "free", 0, 1.0, (0, 1e-2)),
        ("both-clamped", "clamped inside and outside, pressure", "clamped", "clamped", 0, 0.7, (1e-2, 3e-2)),
        ("edge-load", "simply supported outside, line load inside", "free", "simple", 1, 0.4, (0, 1e-2)),
    ):
        fixed = {edge: fix for edge, fix in (("inner", inner), ("outer", outer)) if fix != "free"}
        probe = 0.4 if name == "outer-clamped" else at
        yield _case(
            f"annulus-{name}",
            f"Annulus, {title}",
            f"Annulus of radii 0.4 and 1, h = 0.05, E = 1, ν = 0.3, {title} 1.",
            f"{TIMOSHENKO}, chapter 3; {_ROARK}.",
            Rings([_ring(0.4, 1, h, 1.0 - load, float(load))], _NU, inner, outer),
            annulus,
            fixed,
            {"line_load": 1.0, "edge": "inner"} if load else {"pressure": 1.0},
            probe,
            (0.0, 1e-2) if name == "outer-clamped" else moments,
        )
    yield _stepped()
    yield _arcs()


def _stepped() -> Case:
    """Return the case of a disc that is twice as thick within half of its radius."""
    exact = Rings([_ring(0, 0.5, 0.1, 1.0), _ring(0.5, 1, 0.05, 1.0)], _NU, "centre", "simple")
    w, moment, _ = exact.at(0.0)
    return Case(
        "disc-stepped",
        "Disc of two thicknesses",
        ("disc", "zones", "uniform pressure", "simple edges"),
        "Disc of radius 1, h = 0.1 within r = 0.5 and 0.05 outside, E = 1, ν = 0.3, uniform pressure 1, simply "
        "supported rim.",
        f"{TIMOSHENKO}, chapter 3, with continuous deflection, slope, moment and shear at the step.",
        "analytical",
        lambda n: {
            **_disc(
                {"shape": "disc", "radius": 1, "thickness": 0.05},
                [{"edge": "rim", "fix": "simple"}],
                {"pressure": 1.0},
                0.0,
                n,
            ),
            "zone": [{"area": {"circle": {"radius": 0.5}}, "thickness": 0.1}],
        },
        (4, 8, 16),
        (Number(_W, "w, middle", w, 1e-3), Number(_MR, "m, middle", moment, 1e-2)),
        _SHEAR,
    )


def _arcs() -> Case:
    """Return Code_Aster's case SSLS101, a disc, with the outline given as two arcs."""
    w, moment, _ = Rings([_ring(0, 1, 0.1, 1.0)], _NU, "centre", "simple").at(0.0)
    halves = [{"through": [0, 1], "to": [-1, 0]}, {"through": [0, -1], "to": [1, 0]}]
    return Case(
        "disc-of-arcs",
        "Disc as a polygon of two arcs (SSLS101)",
        ("polygon with arcs", "simple edges", "uniform pressure"),
        "The disc of SSLS101, radius 1, h = 0.1, E = 1, ν = 0.3, pressure 1, as an outline of two arcs.",
        f"{_ASTER}; {TIMOSHENKO}, chapter 3, plus the shear deflection qR²/4κGh.",
        "analytical",
        lambda n: {
            "material": {"E": 1.0, "nu": _NU},
            "plate": {"shape": "polygon", "points": [[1, 0], *halves], "thickness": 0.1},
            "mesh": {"size": 1 / n},
            "support": [{"name": "rim", "edge": ["edge 1", "edge 2"], "fix": "simple"}],
            "load": [{"pressure": 1.0}],
            "probe": [{"at": [[0, 0]]}],
        },
        (4, 8, 16),
        (
            Number(_W, "w, middle", w, 1e-3),
            Number(_MR, "m, middle", moment, 1e-2),
            Number("rim.reaction", "reaction of the rim", pi, 1e-3),
        ),
    )
