"""Beds up to their outlines, and from soft to rigid, against statics and against one another."""

import itertools

import numpy as np
import pytest
from models import rectangular

import signorini
from signorini import Model, contact_problem
from signorini.analysis.check import check
from signorini.discretise import discretise
from signorini.errors import InputError, NoEquilibriumError


def square(side: float, thickness: float) -> dict:
    return {"shape": "rectangle", "size": [side, side], "thickness": thickness}


POLYGON = [[0.3, 0.2], [9.1, 0.7], [9.4, 8.8], [4.2, 9.9], [0.4, 7.0]]
STIFF = (None, 3e7, 1e18)
RIGID_AND_SOFT = (None, 3e7)


def bed(n: int, load: dict, area: object = "all", stiffness: float | None = None, **plate: object) -> Model:
    return Model(
        material={"E": 30e9, "nu": 0.2},
        plate=plate or square(10, thickness=0.3),
        mesh={"divisions": [n, n]},
        support=[
            {"name": "bed", "area": area, "resists": "down"} | ({} if stiffness is None else {"stiffness": stiffness})
        ],
        load=[load] if isinstance(load, dict) else load,
    )


@pytest.mark.parametrize("stiffness", STIFF)
@pytest.mark.parametrize("n", [4, 10])
@pytest.mark.parametrize("at", [(0.3, 5), (0.01, 5), (0, 5), (0.02, 0.02), (0.7, 3.1), (9.99, 6.7), (9.99, 9.98)])
def test_a_force_anywhere_on_a_bed_is_balanced(at: tuple[float, float], n: int, stiffness: float | None) -> None:
    result = signorini.solve(bed(n, {"force": 1e5, "at": at}, stiffness=stiffness))["all"]
    assert result.certificate.passed
    assert result.reactions["bed"] == pytest.approx(1e5, rel=1e-9)


TIPPING = {
    "a round bed": (17, {"circle": {"center": [5, 5], "radius": 2.5}}, (7.5, 5)),
    "a corner": (10, "all", (0, 0)),
    "an edge": (10, "all", (0, 4.25)),
    "a polygon's corner": (17, {"polygon": POLYGON}, (9.4, 8.8)),
    "a polygon's side": (17, {"polygon": POLYGON}, (0.3 + 0.3 * 8.8, 0.2 + 0.3 * 0.5)),
}


@pytest.mark.parametrize("inside", [0, 1e-9, 1e-5])
@pytest.mark.parametrize("stiffness", [2e5, 1e9, 1e13])
@pytest.mark.parametrize("where", TIPPING)
def test_on_the_verge_of_tipping_an_active_set_settles_by_itself(where: str, stiffness: float, inside: float) -> None:
    n, area, outline = TIPPING[where]
    at = [x + inside * (5 - x) for x in outline]
    asked = bed(n, {"force": 1e5, "at": at}, area, stiffness).model_dump(exclude_unset=True)
    result = signorini.solve(Model(**asked | {"solver": {"method": "active_set"}}))["all"]
    assert result.unsettled == () and result.certificate.passed
    assert result.reactions["bed"] == pytest.approx(1e5, rel=1e-9)


@pytest.mark.parametrize(("n", "at"), [(24, [0.01, 5]), (9, [10, 10])])
def test_a_force_near_the_edge_of_a_rigid_bed_or_in_its_corner_is_balanced(n: int, at: list[float]) -> None:
    result = signorini.solve(bed(n, {"force": 1e5, "at": at}))["all"]
    assert result.reactions["bed"] == pytest.approx(1e5, rel=1e-9)


@pytest.mark.parametrize("stiffness", STIFF)
@pytest.mark.parametrize("n", [4, 9])
def test_beside_a_bed_whose_outline_cuts_elements_the_plate_tips_about_its_side(
    n: int, stiffness: float | None
) -> None:
    begin, side = np.array([0.4, 7.0]), np.array([-0.1, -6.8])
    inward = np.array([-side[1], side[0]]) / np.hypot(*side)
    for off in (1e-3, 0.1):
        at = begin + 0.4 * side + off * inward
        result = signorini.solve(bed(n, {"force": 1e5, "at": at.tolist()}, {"polygon": POLYGON}, stiffness))["all"]
        assert result.reactions["bed"] == pytest.approx(1e5, rel=1e-9)
    with pytest.raises(NoEquilibriumError, match=r"through \[0.3, 0.2\], \[0.4, 7\] of bed, short by a moment of 100"):
        signorini.solve(
            bed(n, {"force": 1e5, "at": (begin + 0.4 * side - 1e-3 * inward).tolist()}, {"polygon": POLYGON})
        )


@pytest.mark.parametrize("stiffness", RIGID_AND_SOFT)
@pytest.mark.parametrize("n", [6, 11])
def test_a_tip_of_a_bed_within_an_element_carries_what_stands_on_it(n: int, stiffness: float | None) -> None:
    tip = {"polygon": [[1.0, 5.1], [8.7, 2.3], [8.9, 7.9]]}
    for at in ([1.001, 5.1], [1.3, 5.1]):
        result = signorini.solve(bed(n, {"force": 1e5, "at": at}, tip, stiffness))["all"]
        assert result.reactions["bed"] == pytest.approx(1e5, rel=1e-9)
    (soil,) = result.supports
    assert soil.weights.sum() == pytest.approx(0.5 * abs(7.7 * 2.8 + 2.8 * 7.9), rel=1e-9)


@pytest.mark.parametrize("stiffness", RIGID_AND_SOFT)
def test_round_beds_carry_a_load_up_to_their_outline_or_say_that_the_mesh_does_not(stiffness: float | None) -> None:
    disc, ring = {"circle": {"center": [5, 5], "radius": 4.3}}, {"shape": "annulus", "inner": 1, "outer": 3}
    plates = {
        "disc that cuts elements": lambda r: bed(9, {"force": 1e5, "at": [5 + 0.6 * r, 5 - 0.8 * r]}, disc, stiffness),
        "annulus": lambda r: bed(6, {"force": 1e5, "at": [0.6 * r, 0.8 * r]}, "all", stiffness, **ring, thickness=0.3),
    }
    for plate, radius in zip(plates.values(), (4.3, 3.0), strict=True):
        result = signorini.solve(plate(0.95 * radius))["all"]
        assert result.reactions["bed"] == pytest.approx(1e5, rel=1e-9)
    with pytest.raises(NoEquilibriumError, match="tips about the line"):
        signorini.solve(plates["disc that cuts elements"](4.301))


def test_a_load_that_only_the_true_outline_carries_asks_for_a_finer_mesh() -> None:
    turn = np.radians(13.0)
    at = [5 + 4.2999 * np.cos(turn), 5 + 4.2999 * np.sin(turn)]
    with pytest.raises(InputError, match="finer mesh"):
        signorini.solve(bed(4, {"force": 1e5, "at": at}, {"circle": {"center": [5, 5], "radius": 4.3}}))


def test_a_line_that_only_pushes_reaches_its_ends() -> None:
    for stiffness in RIGID_AND_SOFT:
        for line in ([[1.3, 0.4], [2.7, 9.6]], [[0, 0], [0, 10]]):
            wall = {"name": "wall", "line": line, "resists": "down"}
            keys = {} if stiffness is None else {"stiffness": stiffness}
            post = {"name": "post", "at": [9, 5], "resists": "down"}
            model = Model(
                material={"E": 30e9, "nu": 0.2},
                plate=square(10, thickness=0.3),
                mesh={"divisions": [5, 5]},
                support=[wall | keys, post],
                load=[{"force": 1e5, "at": np.add(line[0], [1e-3, 2e-3]).tolist()}],
            )
            assert sum(signorini.solve(model)["all"].reactions.values()) == pytest.approx(1e5, rel=1e-9)


@pytest.mark.parametrize("stiffness", RIGID_AND_SOFT)
def test_the_limit_of_tipping_is_that_of_statics_on_every_mesh(stiffness: float | None) -> None:
    """100 kN at 5 and Q · 10 kN at 9.5 about the bed's side at 8: 100 · 3 = Q · 10 · 1.5."""
    loads = [{"case": "G", "force": 1e5, "at": [5, 5]}, {"case": "Q", "force": 1e4, "at": [9.5, 5]}]
    for n in (3, 7, 10):
        (found,) = check(bed(n, loads, {"rectangle": [1, 1, 8, 9]}, stiffness)).resultants
        assert found.limit in (("Q", pytest.approx(20.0, rel=1e-9)), ("G", pytest.approx(0.05, rel=1e-9)))
        grown = signorini.path(bed(n, loads, {"rectangle": [1, 1, 8, 9]}, stiffness), start="G", add="Q")
        assert grown.ending == "no_equilibrium"
        assert (grown.limit, grown.end) == (pytest.approx(20.0, rel=1e-9), pytest.approx(20.0, rel=2e-6))


def patch(n: int, stiffness: float | None) -> signorini.Result:
    loads = [{"pressure": 2e3}, {"pressure": 5e5, "area": {"rectangle": [4.5, 4.5, 5.5, 5.5]}}]
    return signorini.solve(bed(n, loads, stiffness=stiffness))["all"]


def test_a_bed_from_soft_to_rigid_changes_steadily() -> None:
    results = [patch(12, k) for k in (*10.0 ** np.arange(8, 31, 2), None)]
    deepest = [result.deflection.max() for result in results]
    assert all(a > b for a, b in itertools.pairwise(deepest[:7]))
    beds = [result.supports[0] for result in results]
    rigid = beds[-1]
    assert all(soft.max_pressure < 1.2 * rigid.max_pressure for soft in beds[:4])
    for stiff in beds[4:]:
        assert stiff.max_pressure == pytest.approx(rigid.max_pressure, rel=1e-3)
        assert stiff.contact_area == pytest.approx(rigid.contact_area, rel=1e-9)
        assert stiff.reaction == pytest.approx(2e5 + 5e5, rel=1e-9)


def test_the_pressure_of_a_stiff_bed_is_no_more_than_at_the_points_where_it_acts() -> None:
    for stiffness in (1e12, 1e13, 1e14, 1e16):
        (soil,) = signorini.solve(bed(10, {"force": 5e5, "at": [3.3, 4.1]}, stiffness=stiffness))["all"].supports
        assert soil.max_pressure == pytest.approx((soil.reactions / soil.weights).max(), rel=1e-12)
        assert soil.area is not None and soil.area.largest[0] <= soil.max_pressure


def test_a_very_stiff_bed_takes_the_steps_of_a_rigid_one() -> None:
    """Points within elements, of which there are more than can answer, took minutes."""
    stiff, rigid = patch(24, 1e16), patch(24, None)
    assert stiff.iterations < 2 * rigid.iterations
    assert np.abs(stiff.deflection - rigid.deflection).max() < 1e-9
    assert stiff.supports[0].max_pressure == pytest.approx(rigid.supports[0].max_pressure, rel=1e-3)


@pytest.mark.parametrize("resists", ["down", "both"])
@pytest.mark.parametrize(
    "where", [{"at": [[1, 1], [9, 1], [4, 4.3]]}, {"edge": "left"}, {"area": {"rectangle": [2, 2, 4, 4]}}]
)
def test_springs_of_any_stiffness_are_certified_and_end_rigid(where: dict, resists: str) -> None:
    legs = {"name": "legs", "at": [[0.5, 0.5], [9.5, 0.5], [5, 9.5]], "resists": "both", "stiffness": 1e7}
    reactions = [
        signorini.solve(
            Model(
                material={"E": 30e9, "nu": 0.2},
                plate=square(10, thickness=0.3),
                mesh={"divisions": [5, 5]},
                support=[{"name": "spring", **where, "resists": resists, "stiffness": stiffness}, legs],
                load=[{"pressure": 2e3}, {"force": 5e5, "at": [2.2, 3.1]}],
            )
        )["all"].reactions["spring"]
        for stiffness in 10.0 ** np.array([-3, 3, 9, 18, 21, 30])
    ]
    assert reactions[:3] == sorted(reactions[:3])
    assert reactions[4:] == pytest.approx([reactions[3]] * 2, rel=1e-7)


@pytest.mark.parametrize(
    "where",
    [
        [{"line": [[2.3, y], [3.6, y]]} for y in (0.5, 3.5)],
        [{"area": {"rectangle": [2.3, y, 3.6, y + 0.5]}} for y in (0.4, 3.1)],
    ],
    ids=["lines", "areas"],
)
@pytest.mark.parametrize("less", ["<", "<="])
def test_a_stiffness_that_steps_at_a_mesh_line_steps_there_for_points_on_it(where: list[dict], less: str) -> None:
    """Statics of a rigid plate on two stiffnesses along x: forces k·w and k·w·x balance 10 kN at 2.75."""
    resists = {"resists": "down", "stiffness": f"1e5*where(x {less} 3, 1, 0.01)"}
    model = rectangular(
        material={"E": 30e14, "nu": 0.2},
        size=[5, 4],
        thickness=1,
        divisions=[5, 4],
        support=[{**place, **resists} for place in where],
        load=[{"force": 1e4, "at": [2.75, 2]}],
    )
    width = 0.5 if "area" in where[0] else 1.0
    parts = [(2 * width * 1e5 * k, a, b) for k, a, b in ((1.0, 2.3, 3.0), (0.01, 3.0, 3.6))]
    zeroth, first, second = (sum(k * (b**n - a**n) / n for k, a, b in parts) for n in (1, 2, 3))
    w, slope = np.linalg.solve([[zeroth, first], [first, second]], [1e4, 2.75e4])
    found = signorini.solve(model)["all"].probe([(x, 2) for x in (0, 3, 5)])
    assert [probe.deflection for probe in found] == pytest.approx([w + slope * x for x in (0, 3, 5)], rel=1e-4)


def test_a_rigid_area_an_element_wide_holds_the_plate_against_turning() -> None:
    """As a pair that pushes and pulls does. At the edge of such a support a Mindlin strip turns by Mλ/D, λ² = D/S."""
    deflections = []
    for resists, n in ((["both"], 1), (["down", "up"], 1), (["both"], 4)):
        model = rectangular(
            material={"E": 30e9, "nu": 0.0},
            size=[4, 3],
            thickness=0.3,
            divisions=[4 * n, 3 * n],
            support=[{"area": {"rectangle": [0, 0, 1, 3]}, "resists": way} for way in resists],
            load=[{"pressure": 1e3}],
        )
        deflections.append(signorini.solve(model)["all"].probe([(4, 1.5)])[0].deflection)
    one, pair, fine = deflections
    assert one == pytest.approx(pair, rel=1e-6)
    rigidity, shear, q, length = 30e9 * 0.3**3 / 12, 5 / 12 * 30e9 * 0.3, 1e3, 3.0
    turned = q * length**2 / 2 / rigidity * (rigidity / shear) ** 0.5
    expected = q * length**4 / (8 * rigidity) + q * length**2 / (2 * shear) + turned * length
    assert fine == pytest.approx(expected, rel=0.03)


def test_points_on_the_outline_leave_pressures_as_well_answered_as_means_alone() -> None:
    """Inf-sup: the least part of the work of pressures, on a mesh four times finer, that the mesh itself answers."""
    from scipy.linalg import eigh
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import splu

    from signorini.discretise.quadrature import area_quadrature

    def flexibility(n: int, coarse: int, outline: bool) -> np.ndarray:
        found = discretise(
            Model(
                material={"E": 30e9, "nu": 0.2},
                plate=square(10, thickness=3.0),
                mesh={"divisions": [n, n]},
                support=[{"area": "all", "resists": "both", "stiffness": 1e3}],
                load=[{"pressure": 1.0}],
            )
        )
        over, side = area_quadrature(found.mesh), 10.0 / coarse
        cells = np.minimum((over.positions // side).astype(int), coarse - 1) @ [coarse, 1]
        ring = np.array([[x, y] for x in range(coarse + 1) for y in range(coarse + 1) if {x, y} & {0, coarse}]) * side
        at = found.mesh.locate(ring)
        elements, xi, rows, weights = over.elements, over.xi, cells, over.weights / side**2
        if outline:
            elements, xi = np.append(elements, at.elements), np.vstack([xi, at.xi])
            rows, weights = np.append(rows, coarse**2 + np.arange(len(ring))), np.append(weights, np.ones(len(ring)))
        coefficients, _ = found.plate.interpolation_rows(elements, xi, 0)
        dofs = (3 * found.mesh.elements[elements][:, :, None] + np.arange(3)).reshape(len(elements), 24)
        shape = (coarse**2 + outline * len(ring), found.dof_count)
        values = (weights[:, None] * coefficients).ravel()
        G = csr_array((values, (np.repeat(rows, 24), dofs.ravel())), shape=shape)
        return np.asarray(G @ splu(contact_problem(found).K.tocsc()).solve(G.T.toarray()))

    for n in (4, 6):
        answered = [eigh(flexibility(n, n, o), flexibility(4 * n, n, o), eigvals_only=True)[0] for o in (False, True)]
        assert answered[0] > 0.2 and answered[1] > 0.9 * answered[0]
