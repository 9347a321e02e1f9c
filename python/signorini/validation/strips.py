"""Plate strips that bend as beams: continuous beams, beams on elastic soil, strips that lift off."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import cos, cosh, exp, pi, sin, sinh, sqrt, tanh
from typing import Any

from signorini.validation.case import Case, Number, Tables

_HETENYI = "M. Hetényi, *Beams on Elastic Foundation*, 1946"
_STRENGTH = "S. Timoshenko, *Strength of Materials*, Part I, 3rd ed., 1955"
_BEAM = "ν = 0, so that the strip bends as a beam; EI = 1 per width, and the shear strain is negligible."
_H = 0.002
"""Thickness of all strips, at most 0.002 of a span, so that the shear strain is negligible."""
_NARROW = 0.125
"""Width of strips on a rigid floor: elements, one across the width, are then at most 4 times as wide as long."""


def _strip(
    length: float,
    n: int,
    support: Sequence[Mapping[str, Any]],
    load: Sequence[Mapping[str, Any]],
    probes: Sequence[float],
    begin: float = 0.0,
    width: float = 1.0,
) -> Tables:
    """Strip along x of EI = 1 per width and ν = 0 with n elements; probes on its axis."""
    return {
        "material": {"E": 12 / _H**3, "nu": 0},
        "plate": {"shape": "rectangle", "size": [length, width], "origin": [begin, 0], "thickness": _H},
        "mesh": {"divisions": [n, 2 if width == 1.0 else 1]},
        "support": support,
        "load": load,
        "probe": [{"at": [[x, width / 2] for x in probes]}],
    }


def _line(x: float, width: float = 1.0, **more: Any) -> dict[str, Any]:
    return {"line": [[x, 0], [x, width]], **more}


def _case(
    name: str,
    title: str,
    features: tuple[str, ...],
    problem: str,
    source: str,
    tables: Callable[[int], Tables],
    numbers: Sequence[Number],
    meshes: tuple[int, ...] = (20, 40, 80),
    remark: str = "",
) -> Case:
    return Case(
        name,
        title,
        ("strip", *features),
        problem,
        source,
        "analytical",
        tables,
        meshes,
        tuple(numbers),
        f"{_BEAM} {remark}".strip(),
    )


def _w(probe: int, label: str, value: float, tolerance: float = 1e-3, factor: float = 1.0) -> Number:
    return Number(f"probe[{probe}].deflection", label, value, tolerance, factor, 1e-5 * abs(value))


def _m(probe: int, label: str, value: float, tolerance: float = 1e-2, factor: float = 1.0) -> Number:
    return Number(f"probe[{probe}].mx", label, value, tolerance, factor, 1e-5 * abs(value))


def cases() -> Iterator[Case]:
    """Yield the validation cases of this module."""
    yield from _continuous()
    yield from _on_soil()
    yield from _tensionless()
    yield from _lifted()


def _continuous() -> Iterator[Case]:
    """Yield cases of beams of several spans, and of a span whose ends rotational springs hold."""
    spans = [{"name": f"s{i}", **_line(float(i), fix="simple")} for i in range(4)]
    yield _case(
        "beam-three-spans",
        "Continuous beam of three spans",
        ("lines of support", "uniform pressure"),
        "Three spans of 1 under q = 1, on lines that hold w.",
        f"{_STRENGTH} (Clapeyron's equation of three moments): reactions 0.4, 1.1, 1.1, 0.4 qL, M = −qL²/10.",
        lambda n: _strip(3, n, spans, [{"pressure": 1.0}], [0.5, 1.0]),
        [
            Number("s0.reaction", "end reaction/qL", 0.4, 1e-3, uncertainty=1e-5),
            Number("s1.reaction", "inner reaction/qL", 1.1, 1e-3, uncertainty=1e-5),
            _m(2, "M/qL² at the inner support", -0.1),
        ],
        (12, 24, 48),
    )
    push = [{"name": f"s{i}", **_line(float(i), resists="down")} for i in range(3)]
    yield _case(
        "beam-lifts",
        "Two spans, one loaded: the far support lifts",
        ("lines of support", "one-sided lines", "lift-off"),
        "Two spans of 1 on lines that only push; q = 1 on the first span.",
        f"{_STRENGTH}: lines that hold in both directions would have the far reaction −qL/16. Without tension the "
        "loaded span is simply supported: 5qL⁴/384EI in its middle, uplift qL⁴/24EI at the far end.",
        lambda n: _strip(2, n, push, [{"pressure": 1.0, "area": {"rectangle": [0, 0, 1, 1]}}], [0.5, 2.0]),
        [
            Number("s0.reaction", "end reaction/qL", 0.5, 1e-6),
            Number("s2.reaction", "far reaction/qL", 0.0, 1e-9, size=1.0),
            _w(1, "w EI/qL⁴, middle of the span", 5 / 384),
            _w(2, "uplift −w EI/qL⁴ at the far end", 1 / 24, factor=-1),
        ],
        (16, 32, 64),
    )
    sheared = 1 + 3 * _H**2 / 5
    sunk = [_line(0.0, fix="simple"), _line(1.0, fix="simple", name="s1", settlement=0.01), _line(2.0, fix="simple")]
    yield _case(
        "beam-settlement",
        "Two spans whose middle support settles",
        ("lines of support", "settlement"),
        "Two spans of 1; the middle line settles by 0.01; no load.",
        f"{_STRENGTH}: M = 3EIδ/L², R = −6EIδ/L³, both divided by 1 + 3EI/κGhL².",
        lambda n: _strip(2, n, sunk, [{"pressure": 0.0}], [1.0]),
        [
            Number("s1.reaction", "R L³/EIδ", -6 / sheared, 1e-3, 100.0),
            Number("probe[1].mx", "M L²/EIδ", 3 / sheared, 1e-2, 100.0),
        ],
        (8, 16, 32),
    )
    k = 3.0
    ends = [{"edge": ["left", "right"], "fix": "simple", "rotational_stiffness": k}]
    moment = 1 / 12 / (1 + 2 / k)
    yield _case(
        "beam-turning-ends",
        "Span with ends that turn on springs",
        ("rotational stiffness", "uniform pressure"),
        "Span of 1 under q = 1; each end has the rotational stiffness k = 3 EI/L.",
        f"{_STRENGTH}: end moment qL²/12(1 + 2EI/kL).",
        lambda n: _strip(1, n, ends, [{"pressure": 1.0}], [0.0, 0.5]),
        [
            _m(1, "end moment/qL²", -moment),
            _m(2, "M/qL², middle", 1 / 8 - moment),
            _w(2, "w EI/qL⁴, middle", 5 / 384 - moment / 8),
        ],
        (8, 16, 32),
    )


def _on_soil() -> Iterator[Case]:
    """Yield cases of beams on a bilateral Winkler bed of stiffness k = 4, so that λ = (k/4EI)^¼ = 1."""
    soil = {"name": "soil", "area": "all", "resists": "both", "stiffness": 4.0}
    both = [{"name": "soil", "area": "all", "resists": "both", "stiffness": 4.0}]
    k = 4.0
    far = 12.0
    yield _case(
        "hetenyi-infinite",
        "Infinite beam under a force",
        ("soil", "line load"),
        f"Strip of length {2 * far:g} on soil of k = 4 (λ = 1) under a line load P = 1 in the middle.",
        f"{_HETENYI}, infinite beam: y = Pλ/2k, M = P/4λ.",
        lambda n: _strip(2 * far, n, both, [{"line_load": 1.0, **_line(0.0)}], [0.0], -far),
        [_w(1, "w k/Pλ", 0.5, factor=k), _m(1, "M λ/P", 0.25, 2e-2)],
        (48, 96, 192),
    )
    yield _case(
        "hetenyi-end-force",
        "Semi-infinite beam under an end force",
        ("soil", "line load"),
        "Strip of length 12 on soil of k = 4 (λ = 1) under a line load P = 1 on its end.",
        f"{_HETENYI}, semi-infinite beam: y = 2Pλ/k at the end, M = −0.3224 P/λ at x = π/4λ.",
        lambda n: _strip(far, n, both, [{"line_load": 1.0, "edge": "left"}], [0.0, pi / 4]),
        [_w(1, "w k/Pλ at the end", 2.0, factor=k), _m(2, "M λ/P at π/4λ", -exp(-pi / 4) * sin(pi / 4), 2e-2)],
        (48, 96, 192),
    )
    length = 3.0
    total, twice = length, sinh(length) + sin(length)
    half = length / 2
    yield _case(
        "hetenyi-free-centre",
        "Free beam of finite length under a force in its middle",
        ("soil", "line load"),
        "Strip of length 3 on soil of k = 4 (λl = 3) with free ends, line load P = 1 in the middle.",
        f"{_HETENYI}, beams of finite length, free ends.",
        lambda n: _strip(length, n, both, [{"line_load": 1.0, **_line(half)}], [half, 0.0]),
        [
            _w(1, "w k/Pλ, middle", (cosh(total) + cos(total) + 2) / (2 * twice), factor=k),
            _w(2, "w k/Pλ, end", 2 * cosh(half) * cos(half) / twice, factor=k),
            _m(1, "M λ/P, middle", (cosh(total) - cos(total)) / (4 * twice), 2e-2),
        ],
        (12, 24, 48),
    )
    simple: list[Mapping[str, Any]] = [soil, {"edge": ["left", "right"], "fix": "simple"}]
    down = cosh(total) + cos(total)
    yield _case(
        "hetenyi-hinged",
        "Hinged beam on soil under pressure",
        ("soil", "uniform pressure"),
        "Strip of length 3 on soil of k = 4 (λl = 3) with simply supported ends, q = 1.",
        f"{_HETENYI}, beams of finite length, hinged ends.",
        lambda n: _strip(length, n, simple, [{"pressure": 1.0}], [half]),
        [
            _w(1, "w k/q, middle", 1 - 2 * cosh(half) * cos(half) / down, factor=k),
            _m(1, "M λ²/q, middle", sinh(half) * sin(half) / down),
        ],
        (12, 24, 48),
    )
    fixed: list[Mapping[str, Any]] = [soil, {"edge": ["left", "right"], "fix": "clamped"}]
    yield _case(
        "hetenyi-fixed",
        "Clamped beam on soil under pressure",
        ("soil", "uniform pressure", "clamped edges"),
        "Strip of length 3 on soil of k = 4 (λl = 3) with clamped ends, q = 1.",
        f"{_HETENYI}, beams of finite length, fixed ends.",
        lambda n: _strip(length, n, fixed, [{"pressure": 1.0}], [half, 0.0]),
        [
            _w(1, "w k/q, middle", 1 - 2 * (sinh(half) * cos(half) + cosh(half) * sin(half)) / twice, factor=k),
            _m(2, "end moment M λ²/q", -(sinh(total) - sin(total)) / (2 * twice)),
        ],
        (12, 24, 48),
    )
    part = 1.5
    yield _case(
        "hetenyi-partial",
        "Infinite beam under pressure on a part",
        ("soil", "uniform pressure"),
        f"Strip of length {2 * far:g} on soil of k = 4 (λ = 1), q = 1 on a length of 3 in the middle.",
        f"{_HETENYI}, infinite beam: w = q(1 − e^(−λa) cos λa)/k and M = q e^(−λa) sin λa/2λ², with half-length a.",
        lambda n: _strip(
            2 * far, n, both, [{"pressure": 1.0, "area": {"rectangle": [-part, 0, part, 1]}}], [0.0], -far
        ),
        [_w(1, "w k/q", 1 - exp(-part) * cos(part), factor=k), _m(1, "M λ²/q", exp(-part) * sin(part) / 2, 2e-2)],
        (48, 96, 192),
    )


def _tensionless() -> Iterator[Case]:
    """Yield the case of a long strip on soil that only pushes."""
    peak, lam = 1 / tanh(pi / 2), 1 / sqrt(2)
    soil = [{"name": "soil", "area": "all", "resists": "down", "stiffness": 1.0}]
    yield _case(
        "strip-tensionless",
        "Long strip on soil that only pushes, line load",
        ("tensionless soil", "line load", "lift-off"),
        "Weightless strip of length 12 ℓ with EI = k = 1 (ℓ = 1) on soil that only pushes, line load P = 1 in the "
        "middle.",
        "N. C. Tsai, R. A. Westmann, *Beam on tensionless foundation*, J. Eng. Mech. Div. ASCE 93 (1967): contact "
        "for |x| ≤ π/2λ; w = coth(π/2) Pλ/2k and M = coth(π/2) P/4λ.",
        lambda n: _strip(12, n, soil, [{"line_load": 1.0, **_line(0.0)}], [0.0], -6),
        [
            Number("soil.contact_area", "contact half-length/ℓ", pi * lam, 5e-3, 0.5),
            _w(1, "w k ℓ/P", peak * lam / 2, 5e-3),
            _m(1, "M/Pℓ", peak / (4 * lam), 5e-3),
        ],
        (40, 80, 160),
    )


def _lifted() -> Iterator[Case]:
    """Yield cases of heavy strips (p = 1) on a rigid floor, lifted or curled."""
    floor = [{"name": "floor", "area": "all", "resists": "down"}]
    weight = {"pressure": 1.0}
    force = 0.5
    s = 2 * force
    yield _case(
        "strip-lifted-end",
        "Heavy strip lifted at its end",
        ("rigid floor", "lift-off", "line load"),
        "Strip of length 2, p = 1, on a rigid floor; the end is pulled up by F = 0.5.",
        "Beam statics: lifted length s = 2F/p, w = −ps⁴/24EI.",
        lambda n: _strip(2, n, floor, [weight, {"line_load": -force, "edge": "right"}], [2.0], width=_NARROW),
        [
            _w(1, "uplift −w EI/ps⁴", s**4 / 24, 2e-2, -1),
            Number("floor.contact_area", "contact length", 2 - s, 6e-2, 1 / _NARROW),
        ],
        (16, 32, 64),
    )
    s = 0.75
    yield _case(
        "strip-lifted-middle",
        "Heavy strip lifted at its middle",
        ("rigid floor", "lift-off", "line load"),
        "Strip of length 4, p = 1, on a rigid floor; the middle is pulled up by F = 1.",
        "Beam statics: moment, slope and deflection are 0 where the lifted part ends, the slope is 0 in its middle; "
        "lifted half-length s = 3F/4p, w = −ps⁴/72EI.",
        lambda n: _strip(4, n, floor, [weight, {"line_load": -1.0, **_line(2.0, _NARROW)}], [2.0], width=_NARROW),
        [
            _w(1, "uplift −w EI", s**4 / 72, 3e-2, -1),
            Number("floor.contact_area", "contact length", 4 - 2 * s, 6e-2, 1 / _NARROW),
        ],
        (16, 32, 64),
    )
    a = 0.5
    table = [{"name": "floor", "area": {"rectangle": [0, 0, 2, _NARROW]}, "resists": "down"}]
    moment = a**2 / 2
    s = a * sqrt(2)
    yield _case(
        "strip-overhang",
        "Heavy strip that overhangs a table",
        ("rigid floor", "lift-off"),
        "Strip of length 2.5, p = 1, on a rigid table from x = 0 to 2; the rest overhangs by a = 0.5.",
        "Beam statics: beside the edge of the table the strip lifts over s = a√2, and M = −pa²/2 at the edge; "
        "the end sinks by p a⁴/8EI plus the slope ps³/24EI at the edge times a.",
        lambda n: _strip(2.5, n, table, [weight], [2.0, 2.5], width=_NARROW),
        [_m(1, "M/p at the edge", -moment, 2e-2), _w(2, "w EI/p, end", a**4 / 8 + a * s**3 / 24, 3e-2)],
        (20, 40, 80),
    )
    s, kappa = 0.8, 0.32
    curl = {"curvature": [-kappa, 0, 0]}
    yield _case(
        "strip-curled",
        "Heavy slab strip that curls",
        ("rigid floor", "lift-off", "curvature"),
        "Strip of length 4, p = 1, on a rigid floor, with the stress-free curvature κ = 0.32 of a slab that is cooler "
        "on top.",
        "H. M. Westergaard, *Analysis of stresses in concrete pavements due to variations of temperature*, Proc. HRB 6 "
        "(1926); statics on a rigid floor: the flat part has M = EIκ, each end lifts over s = √(2EIκ/p) by ps⁴/8EI.",
        lambda n: _strip(4, n, floor, [weight, curl], [4.0, 2.0], width=_NARROW),
        [_w(1, "uplift −w EI/p, end", s**4 / 8, 2e-2, -1), Number("probe[2].mx", "M/EI, middle", -kappa, 1e-2)],
        (10, 20, 40),
    )
