"""A hull reaches as far as its points in every direction, however rounding orders those of one side."""

import numpy as np
import pytest

from signorini.shapes.hull import hull

_DIRECTIONS = np.column_stack([np.cos(turn := np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)), np.sin(turn)])


def assert_reaches(points):
    corners = points[hull(points)]
    missing = (points @ _DIRECTIONS.T).max(axis=0) - (corners @ _DIRECTIONS.T).max(axis=0)
    assert missing.max() <= 1e-12 * np.ptp(points, axis=0).max()


def assert_convex(corners):
    side = np.roll(corners, -1, axis=0) - corners
    ahead = np.roll(side, -1, axis=0)
    assert (side[:, 0] * ahead[:, 1] > side[:, 1] * ahead[:, 0]).all()


@pytest.mark.parametrize("seed", range(200))
def test_points_along_the_sides_of_a_quadrilateral_each_off_by_rounding(seed):
    rng = np.random.default_rng(seed)
    corners = np.array([[1.3, 2.0], [8.1, 2.0], [8.1, 9.0], [1.3, 9.0]])
    if seed % 2:
        corners += rng.uniform(-0.5, 0.5, (4, 2))
    if seed % 3:
        turn = rng.choice([rng.uniform(0.0, 2.0 * np.pi), 1.0, 0.5 * np.pi])
        corners = corners @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    begin, end = np.stack([corners, np.roll(corners, -1, axis=0)])[:, rng.integers(0, 4, rng.integers(8, 200))]
    along = rng.random((len(begin), 1))
    points = np.vstack([begin + along * (end - begin), corners])
    points += 2e-16 * rng.integers(-2, 3, points.shape) * abs(points)
    points = points[rng.permutation(len(points))]
    assert_reaches(points)
    assert_convex(points[hull(points)])


@pytest.mark.parametrize("seed", range(50))
def test_clouds_grids_and_circles(seed):
    rng = np.random.default_rng(seed)
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    points = [
        rng.normal(size=(rng.integers(3, 400), 2)),
        np.stack(np.meshgrid(np.linspace(0.0, 6.8, 34) + 1.3, np.linspace(0.0, 7.0, 36)), axis=-1).reshape(-1, 2) / 3.0,
        np.column_stack([np.cos(turn), np.sin(turn)]) * rng.uniform(0.1, 1e3) + rng.uniform(-1e3, 1e3, 2),
    ][seed % 3]
    assert_reaches(points)
    assert_convex(points[hull(points)])
