"""Cases without a meshed plate: linear complementarity problems, elastic half-spaces, elements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi

import numpy as np

from signorini import _core
from signorini.contact.lcp import lemke
from signorini.discretise.zones import Rigidity
from signorini.validation.case import Case, Number

_LCP = "R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, 1992"


def cases() -> Iterator[Case]:
    """Yield the validation cases of this module."""
    yield from _problems()
    yield from _half_space()
    yield _elements()


def _lcp_case(
    name: str, title: str, problem: str, source: str, matrix: np.ndarray, q: np.ndarray, exact: Mapping[str, float]
) -> Case:
    """Case of an LCP; numbers are entries z1, z2, … of z, the sum of z, the pivots, and whether Lemke ends in a ray."""

    def solved(n: int) -> Mapping[str, float]:
        found = lemke(matrix, q)
        entries = {f"z{i}": float(value) for i, value in enumerate(found.z, 1)}
        return {**entries, "sum": float(found.z.sum()), "pivots": found.pivots, "ray": float(found.status == "ray")}

    size = max(1.0, *(abs(value) for value in exact.values()))
    numbers = tuple(Number(key, key, value, 1e-12, size=size) for key, value in exact.items())
    return Case(
        f"lcp-{name}",
        f"Linear complementarity problem, {title}",
        ("Lemke's algorithm",),
        f"w = Mz + q, w ≥ 0, z ≥ 0, zᵀw = 0, with {problem}.",
        source,
        "analytical",
        solved,
        (len(q),),
        numbers,
        direct=True,
    )


def _problems() -> Iterator[Case]:
    n = 8
    lower = np.eye(n) + 2 * np.tri(n, k=-1)
    q = 2.0 ** (n + 1 - np.arange(1, n + 1)) - 2.0 ** (n + 1)
    yield _lcp_case(
        "murty",
        "Murty",
        "M lower triangular, 1 on the diagonal and 2 below, q_i = −(2^(n+1) − 2^(n+1−i)), n = 8",
        "K. G. Murty, *Computational complexity of complementary pivot methods*, Math. Program. Study 7 (1978): "
        "z = (2ⁿ, 0, …), 2ⁿ pivots.",
        lower,
        q,
        {"z1": 2.0**n, "z2": 0.0, "pivots": 2.0**n},
    )
    yield _lcp_case(
        "fathi",
        "Fathi",
        "M = LLᵀ with Murty's L, q = −e, n = 8",
        "Y. Fathi, *Computational complexity of LCPs associated with positive definite symmetric matrices*, Math. "
        "Program. 17 (1979): z = e₁; 2ⁿ pivots of lexicographic Lemke.",
        lower @ lower.T,
        -np.ones(n),
        {"z1": 1.0, "z2": 0.0, "pivots": 2.0**n},
    )
    yield _lcp_case(
        "ben-gharbia",
        "Ben Gharbia and Gilbert",
        "M = [[1, 0, 2], [2, 1, 0], [0, 2, 1]], q = e",
        "I. Ben Gharbia, J. C. Gilbert, *Nonconvergence of the plain Newton-min algorithm*, Math. Program. 134 "
        "(2012): z = 0; a plain primal–dual active set cycles.",
        np.array([[1.0, 0, 2], [2, 1, 0], [0, 2, 1]]),
        np.ones(3),
        {"z1": 0.0, "z2": 0.0, "z3": 0.0},
    )
    yield _lcp_case(
        "three",
        "positive definite, n = 3",
        "M = [[60, 26, 37], [26, 36, 29], [37, 29, 30]], q = −e",
        "Exact arithmetic: z = (0, 1/239, 7/239).",
        np.array([[60.0, 26, 37], [26, 36, 29], [37, 29, 30]]),
        -np.ones(3),
        {"z1": 0.0, "z2": 1 / 239, "z3": 7 / 239},
    )
    yield _lcp_case(
        "degenerate",
        "degenerate quadratic program",
        "M = [[11, 0, 10, −1], [0, 11, 10, −1], [10, 10, 21, −1], [1, 1, 1, 0]], q = (50, 50, 23, −6)",
        "Exact arithmetic: z = (3, 3, 0, 83).",
        np.array([[11.0, 0, 10, -1], [0, 11, 10, -1], [10, 10, 21, -1], [1, 1, 1, 0]]),
        np.array([50.0, 50, 23, -6]),
        {"z1": 3.0, "z2": 3.0, "z3": 0.0, "z4": 83.0},
    )
    yield _lcp_case(
        "not-unique",
        "solution that is not unique",
        "M = [[1, 1], [1, 1]], q = −e",
        f"{_LCP}: every solution has z₁ + z₂ = 1.",
        np.ones((2, 2)),
        -np.ones(2),
        {"sum": 1.0},
    )
    yield _lcp_case(
        "ray",
        "no solution",
        "M = [[1, −1], [−1, 1]], q = −e",
        f"{_LCP}: Lemke's algorithm ends in a ray.",
        np.array([[1.0, -1], [-1, 1]]),
        -np.ones(2),
        {"ray": 1.0},
    )


def _love(x: np.ndarray, y: np.ndarray, side: float) -> np.ndarray:
    """Half-space: deflection times πE/(1 − ν²) at (x, y) by unit pressure on a square about the origin (Love 1929)."""
    result = np.zeros_like(x)
    for sign, a in ((1, x + side / 2), (-1, x - side / 2)):
        for other, b in ((1, y + side / 2), (-1, y - side / 2)):
            result += sign * other * (a * np.arcsinh(b / np.maximum(np.abs(a), 1e-300)))
            result += sign * other * (b * np.arcsinh(a / np.maximum(np.abs(b), 1e-300)))
    return result


def _pressed(n: int, depth: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Force and contact area of a punch pressed into a half-space with E/(1 − ν²) = 1, as an LCP of pressures."""
    side = 1 / n
    compliance = _love(x[:, None] - x, y[:, None] - y, side) / pi
    pressures = lemke(compliance, -depth).z
    return float(pressures.sum() * side**2), float((pressures > 0).sum() * side**2)


def _half_space() -> Iterator[Case]:
    """Yield cases of punches on an elastic half-space: pressures, constant on squares, by Lemke's algorithm."""

    def cells(n: int, extent: float) -> tuple[np.ndarray, np.ndarray]:
        at = (np.arange(-round(extent * n), round(extent * n)) + 0.5) / n
        x, y = (part.ravel() for part in np.meshgrid(at, at))
        inside = np.hypot(x, y) <= extent
        return x[inside], y[inside]

    def flat(n: int) -> Mapping[str, float]:
        x, y = cells(n, 1.0)
        return {"force": _pressed(n, np.ones_like(x), x, y)[0]}

    def sphere(n: int) -> Mapping[str, float]:
        x, y = cells(n, 1.3)
        force, area = _pressed(n, 1 - x**2 - y**2, x, y)
        return {"force": force, "area": area}

    where = "cells of side 1/n with constant pressure, influence coefficients by Love (1929), E/(1 − ν²) = 1"
    yield Case(
        "boussinesq-punch",
        "Rigid circular footing on an elastic half-space",
        ("Lemke's algorithm", "own compliance"),
        f"Rigid disc of radius a = 1 pressed by w = 1 into a half-space; {where}.",
        "J. Boussinesq (1885); S. Timoshenko, J. N. Goodier, *Theory of Elasticity*, 1951: w = P(1 − ν²)/2aE.",
        "analytical",
        flat,
        (4, 8, 14),
        (Number("force", "P/(E a w/(1 − ν²))", 2.0, 3e-2),),
        "The staircase of cells approximates the circle, and the pressure is infinite at the rim.",
        direct=True,
    )
    yield Case(
        "hertz",
        "Sphere on an elastic half-space (Hertz)",
        ("Lemke's algorithm", "own compliance", "lift-off"),
        f"Rigid paraboloid with the gap r², pressed into a half-space by δ = 1; {where}.",
        "H. Hertz (1881); K. L. Johnson, *Contact Mechanics*, 1985, chapter 4, with R = 1/2: contact radius "
        "a = √(Rδ), P = 4/3 E a³/(1 − ν²)R.",
        "analytical",
        sphere,
        (4, 8, 12),
        (Number("force", "P", 4 / 3 * 0.5**0.5 * 1.0**1.5, 1e-2), Number("area", "contact area", pi / 2, 5e-2)),
        direct=True,
    )


def _elements() -> Case:
    """Return the case that counts the zero-energy modes of free elements."""
    rigidity = Rigidity.isotropic(1.0, 0.3, 5 / 6).for_core
    corners = np.array([[0, 0], [1.1, 0.1], [0.9, 1.2], [-0.2, 0.8]])
    sides = (corners + np.roll(corners, -1, axis=0)) / 2
    quadrilateral = np.concatenate([corners, sides])
    triangle = np.concatenate([corners[:3], sides[:2], (corners[2:3] + corners[:1]) / 2])

    def modes(n: int) -> Mapping[str, float]:
        result = {}
        for name, points, nodes, element in (
            ("mitc9", quadrilateral, [0, 1, 2, 3, 4, 5, 6, 7], "mitc9"),
            ("q8r", quadrilateral, [0, 1, 2, 3, 4, 5, 6, 7], "q8r"),
            ("mitc7", triangle, [0, 1, 2, 2, 3, 4, 2, 5], "mitc9"),
        ):
            thickness = np.full((1, len(_core.section_points(element))), 0.1)
            plate = _core.Plate(points, np.array([nodes]), thickness, 1.0, rigidity, element)
            lower = np.zeros((24, 24))
            lower[np.tril_indices(24)] = plate.element_stiffness()[0]
            matrix = lower + np.tril(lower, -1).T
            dofs = (3 * np.array(nodes)[:, None] + np.arange(3)).ravel()
            full = np.zeros((3 * len(points), 3 * len(points)))
            np.add.at(full, (dofs[:, None], dofs), matrix)
            values = np.linalg.eigvalsh(full)
            result[name] = float((np.abs(values) < 1e-12 * values[-1]).sum())
        return result

    return Case(
        "zero-energy-modes",
        "Zero-energy modes of a free element",
        ("elements",),
        "Eigenvalues of the stiffness matrix of one distorted element, h = 0.1.",
        "T. J. R. Hughes, *The Finite Element Method*, 1987: three rigid motions; the reduced integration "
        "of q8r adds one mode.",
        "analytical",
        modes,
        (1,),
        (Number("mitc9", "mitc9", 3.0, 1e-12), Number("mitc7", "mitc7", 3.0, 1e-12), Number("q8r", "q8r", 4.0, 1e-12)),
        direct=True,
    )
