"""The domain of validity (docs/domain.md): what lies outside is refused before anything is assembled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from signorini.discretise.frames import Held
from signorini.discretise.nearness import Near, too_near
from signorini.discretise.rows import Floats, Ints
from signorini.discretise.supports import ContactPoints, Springs
from signorini.discretise.thickness import Thickness
from signorini.discretise.zones import Zones
from signorini.errors import InputError, Problems, point
from signorini.mesh import Mesh
from signorini.model import Model
from signorini.model.plate import SLIMMEST
from signorini.shapes.extent import Tolerances

LONGEST = 1000.0
"""Long side of an element over its short side, or over its thickness if that is more: bending across is stiffer than
along by the fourth power of the ratio, and of sixteen digits four are left."""
THICKEST = 10.0
"""Thickness over a plate's width: of a wall on its edge bending across is rounding beside shear."""
FLOATING = 1e-10
"""Least stiffness λL⁴/D of elastic supports that alone hold the plate: its rigid motions are then free of strain."""
THIN = 1e-19
"""The same over (L/h)²·L²/A: beside the plate's stiffness in shear, which rounds what strains it. Found by trial."""
TURNING = 1e-6
"""The same where rigid supports hold the plate against some motions: rounding strains the plate in the others."""
SOFTEST = 1e-14
"""Least stiffness KL⁴/(AD) of an elastic support in all beside rigid ones that hold the plate: what a softer one
carries is rounding of what they do."""
RIGID = 1e12
"""Stiffness KL⁴/(AD) of a support in all from which on it counts as rigid."""
_ROUNDING = 1e-9
"""Part by which a limit may be exceeded: coordinates and formulas are rounded."""
_RANK = 1e-9
"""Part of the largest singular value of rows below which they do not hold a motion."""


class _Hold(NamedTuple):
    """What supports do in the rigid motions w = 1, (x − x₀)/L, (y − y₀)/L."""

    rigid: Floats
    elastic: Floats
    stiffness: Floats
    support: Ints


def require_domain(
    model: Model,
    mesh: Mesh,
    zones: Zones,
    thickness: Thickness,
    held: Held,
    springs: Springs,
    contacts: ContactPoints,
    problems: Problems,
) -> None:
    """Put among the problems what of a model lies outside the domain of validity.

    The thickness itself is judged where it is evaluated.

    Examples
    --------
    >>> from signorini import Model
    >>> from signorini.discretise import discretise
    >>> discretise(
    ...     Model(
    ...         material={"E": 30e9, "nu": 0.2},
    ...         plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
    ...         support=[{"name": "posts", "at": [[2, 5], [2.01, 5], [8, 5]], "fix": "clamped"}],
    ...         load=[{"pressure": 5e3}],
    ...     )
    ... )
    Traceback (most recent call last):
    signorini.errors.InputError: support[1].at[1]: posts holds the plate rigidly at [2, 5], 0.01 from the point \
[2.01, 5] of posts, support[1].at[2]. Rigid supports must be at one place, or at least a tenth of the thickness apart, \
here 0.03. Join them by mesh.snap = 0.02, move one, or give one a stiffness.
    """
    with problems.collected():
        _require_wide(mesh, thickness)
    with problems.collected():
        _require_short_elements(mesh, thickness)
    unit = np.array([rigidity.in_waves for rigidity in zones.rigidities])[zones.of_elements.rigidity]
    bending = float((unit * np.broadcast_to(thickness.at_points.mean(axis=1), len(unit)) ** 3).max())
    hold = _hold(mesh, held, springs, contacts)
    free = _free(hold.rigid)
    if free.shape[1]:
        with problems.collected():
            _require_stiff_enough(model, mesh, bending, thickness.min(), hold, free)
    # Over the plate's stiffness step by step, since the fourth power of a length may leave all numbers.
    per_bed = mesh.size / float(mesh.element_area.sum()) * mesh.size * (mesh.size * mesh.size / bending)
    total = np.asarray(np.bincount(hold.support, hold.stiffness, len(model.support)) * per_bed, np.float64)
    if not free.shape[1]:
        with problems.collected():
            _require_no_softer(model, total)
    rigid = {i for i, one in enumerate(model.support) if one.is_rigid}
    rigid |= set(contacts.support[(contacts.compliance == 0) & ~contacts.slope].tolist())
    rigid |= set(np.flatnonzero(total > RIGID).tolist())
    for one in too_near(model, mesh, sorted(rigid), _least(mesh, thickness)):
        with problems.collected():
            raise _in_words(model, one)


def _least(mesh: Mesh, thickness: Thickness) -> Floats:
    """Least distance (ne,) of rigid supports in each element."""
    nominal = np.broadcast_to(thickness.nominal.min(axis=1), len(mesh.elements))
    return np.asarray((1.0 - _ROUNDING) * Tolerances(mesh.diameter, nominal).apart)


def _in_words(model: Model, near: Near) -> InputError:
    snap = "a larger mesh.snap" if model.mesh.snap else f"mesh.snap = {2.0 * near.distance:.1g}"
    return InputError(
        f"{model.support[near.support].name} holds the plate rigidly at {point(near.at.tolist())}, "
        f"{near.distance:.3g} from {near.other}. Rigid supports must be at one place, or at least a tenth of the "
        f"thickness apart, here {near.least:.3g}. Join them by {snap}, move one, or give one a stiffness.",
        place=near.place,
    )


def _require_wide(mesh: Mesh, thickness: Thickness) -> None:
    width, thickest = float(mesh.element_area.sum()) / mesh.size, float(thickness.nominal.max())
    if mesh.size > (1.0 + _ROUNDING) * SLIMMEST * width:
        raise InputError(
            f"The plate is {mesh.size:.6g} long and {width:.3g} wide, its area over its length; at most {SLIMMEST:g} "
            "to 1 is in the domain. Calculate a beam.",
            place=("plate",),
        )
    if thickest > (1.0 + _ROUNDING) * THICKEST * width:
        raise InputError(
            f"Found the thickness {thickest:.6g} of a plate {width:.3g} wide, its area over its length; at most "
            f"{THICKEST:g} times that is in the domain. Calculate a beam.",
            place=("plate", "thickness"),
        )


def _require_short_elements(mesh: Mesh, thickness: Thickness) -> None:
    corners = mesh.points[mesh.elements[:, :4]]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    lengths = np.linalg.norm(middles[:, [1, 2]] - middles[:, [3, 0]], axis=2)
    of = mesh.triangles
    longest = np.linalg.norm(corners[of] - np.roll(corners[of], -1, axis=1), axis=2).max(axis=1)
    lengths[of] = np.column_stack([longest, 2.0 * mesh.element_area[of] / longest])
    nominal = np.broadcast_to(thickness.nominal.min(axis=1), len(mesh.elements))
    ratio = lengths.max(axis=1) / np.maximum(lengths.min(axis=1), nominal)
    worst = int(ratio.argmax())
    if ratio[worst] <= (1.0 + _ROUNDING) * LONGEST:
        return
    long, short = lengths[worst].max(), max(lengths[worst].min(), nominal[worst])
    times = math.ceil((1.0 - _ROUNDING) * ratio[worst] / LONGEST)
    raise InputError(
        f"The element at {point(corners[worst].mean(axis=0))} is {long:.6g} long and {short:.6g} wide or thick, "
        f"{ratio[worst]:.6g} to 1; at most {LONGEST:g} to 1 are in the domain. Take {times} times as many along their "
        "longer sides, or fewer across; or calculate a beam.",
        place=("mesh",),
    )


def _hold(mesh: Mesh, held: Held, springs: Springs, contacts: ContactPoints) -> _Hold:
    size = np.array([1.0, mesh.size, mesh.size])
    at_nodes = held.rigid_motions(mesh.points, mesh.middle)[held.dofs] / size
    # A slope is compared with deflections over the plate.
    at_nodes *= np.tile(size, mesh.node_count)[held.dofs, None]

    def motions(positions: Floats) -> Floats:
        return np.column_stack([np.ones(len(positions)), (positions - mesh.middle) / mesh.size])

    slopes = contacts.pick(contacts.slope)
    of_slopes = slopes.rows.matrix(mesh.elements, 3 * mesh.node_count) @ held.rigid_motions(mesh.points, mesh.middle)
    soft = contacts.compliance > 0
    rigid = np.concatenate([at_nodes, of_slopes, motions(contacts.positions[~soft & ~contacts.slope])])
    return _Hold(
        rigid,
        motions(np.concatenate([springs.positions, contacts.positions[soft]])),
        np.concatenate([springs.stiffness, 1.0 / contacts.compliance[soft]]),
        np.concatenate([springs.support, contacts.support[soft]]),
    )


def _require_no_softer(model: Model, total: Floats) -> None:
    """Refuse elastic supports that carry nothing, by their KL⁴/(AD)."""
    for i in np.flatnonzero((total > 0.0) & (total < (1.0 - _ROUNDING) * SOFTEST)).tolist():
        raise InputError(
            f"{model.support[i].name} is as soft as a bed under all of the plate with kL⁴/D = {total[i]:.2g}; it must "
            f"be {SOFTEST:g} or more. Leave it out, since it carries nothing, or give {SOFTEST / total[i]:.2g} times "
            "the stiffness.",
            place=("support", i, "stiffness"),
        )


def _require_stiff_enough(model: Model, mesh: Mesh, bending: float, thinnest: float, hold: _Hold, free: Floats) -> None:
    """Refuse elastic supports that the plate would float on, by the least λ of motions (3, d) that they alone hold."""
    # What nothing holds is a mechanism, and told as one.
    if _free(np.concatenate([hold.rigid, hold.elastic])).shape[1]:
        return
    # λ = Σ k w² / ∫ w² is the modulus of a bed under the whole plate that would hold the motion w as firmly.
    corners = mesh.points[mesh.elements[:, :4]]
    # By Simpson's rule in effect: exact for moments of inertia of rectangles.
    at = (np.concatenate([corners.mean(axis=1)[:, None], corners], axis=1) - mesh.middle) / mesh.size
    weight = (mesh.element_area / mesh.element_area.sum())[:, None] * np.array([8.0, 1.0, 1.0, 1.0, 1.0]) / 12.0
    over = np.concatenate([np.ones((*weight.shape, 1)), at], axis=2).reshape(-1, 3) @ free
    mean = _triangle(np.sqrt(weight.reshape(-1, 1)) * over)
    # Roots keep the least λ beside others 1e30 times as large.
    scaled = np.sqrt(hold.stiffness / hold.stiffness.max())[:, None] * (hold.elastic @ free)
    roots = np.linalg.svd(np.linalg.solve(mean.T, _triangle(scaled).T), compute_uv=False)
    largest = hold.stiffness.max() / float(mesh.element_area.sum()) * mesh.size * mesh.size
    result = float(roots.min()) ** 2 * largest * (mesh.size * mesh.size / bending)
    floats = free.shape[1] == 3
    slender = (mesh.size / thinnest) ** 2 * mesh.size / float(mesh.element_area.sum()) * mesh.size
    least = max(FLOATING if floats else TURNING, THIN * slender)
    if result >= (1.0 - _ROUNDING) * least:
        return
    which = np.unique(hold.support).tolist()
    names = " and ".join(model.support[i].name for i in which)
    what = "the plate" if floats else "the plate against a motion that rigid supports leave free"
    raise InputError(
        f"The stiffness of {names} alone holds {what}, as firmly as a bed under all of it with kL⁴/D = {result:.2g}; "
        f"it must be {least:g} or more. Give {least / result:.2g} times the stiffness, or hold the plate rigidly.",
        place=("support", which[0], "stiffness"),
    )


def _free(rows: Floats) -> Floats:
    """Motions (3, d) on which rows (n, 3) are zero."""
    if not len(rows):
        return np.eye(3)
    _, values, basis = np.linalg.svd(_triangle(rows))
    return np.asarray(basis[int((values > _RANK * max(1.0, values[0])).sum()) :].T)


def _triangle(rows: Floats) -> Floats:
    """The triangle R (3, d) of rows (n, d), which has their products RᵀR and keeps small singular values."""
    return np.asarray(np.linalg.qr(rows, mode="r"))
