"""Interpolation: through its nodes, with continuous gradients, of fourth order, without surprises between nodes."""

import itertools

import numpy as np
import pytest

from screwsim.export.hermite import evaluate, grid_of


def smooth(x, y):
    return np.exp(0.4 * x) * np.cos(y) + 0.2 * x * y


def made(count: int, function=smooth, sound=None):
    nodes = [np.linspace(0.0, 2.0, count), np.linspace(-1.0, 1.0, count + 1) ** 3]
    mesh = np.meshgrid(*nodes, indexing="ij")
    values = np.stack([function(*mesh), -mesh[0]], axis=-1)
    return grid_of(nodes, values, np.ones(values.shape[:2], bool) if sound is None else sound), values


def points(seed=1, count=400):
    return np.random.default_rng(seed).uniform([0.0, -1.0], [2.0, 1.0], (count, 2))


def test_nodes_are_met():
    grid, values = made(6)
    found, inside = evaluate(grid, np.array(list(itertools.product(*grid.nodes))))
    assert inside.all()
    np.testing.assert_allclose(found, values.reshape(-1, 2), atol=1e-13)


def test_a_line_is_itself():
    grid, _ = made(5)
    found, _ = evaluate(grid, points())
    np.testing.assert_allclose(found[:, 1], -points()[:, 0], atol=1e-12)


def test_the_error_is_of_fourth_order():
    errors = []
    for count in (9, 17, 33):
        nodes = [np.linspace(0.0, 2.0, count)] * 2
        values = np.exp(nodes[0])[:, None, None] * np.sin(1.0 + nodes[1])[None, :, None]
        x = points() * [1.0, 0.5] + [0.0, 0.5]
        found, _ = evaluate(grid_of(nodes, values, np.ones(values.shape[:2], bool)), x)
        # beside the maximum along y, where slopes are limited, the order is lower; a third of the points are there
        errors.append(np.median(np.abs(found[:, 0] - np.exp(x[:, 0]) * np.sin(1.0 + x[:, 1]))))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 3.5)


@pytest.mark.parametrize("axis", [0, 1])
def test_gradients_meet_at_the_faces_of_cells(axis):
    rough = np.random.default_rng(3)
    nodes = [np.array([0.0, 0.3, 1.0, 1.1, 2.0]), np.array([-1.0, -0.2, 0.5, 1.0])]
    sound = np.ones((5, 4), bool)
    sound[2, 1] = False
    grid = grid_of(nodes, rough.normal(size=(5, 4, 1)), sound)
    face = nodes[axis][2]
    step, h = 1e-6, 1e-4
    for other in np.linspace(nodes[1 - axis][0], nodes[1 - axis][-1], 23):
        at = np.empty((6, 2))
        at[:, 1 - axis] = other
        at[:, axis] = face + np.array([-2 * step, -step, step, 2 * step, 0.0, 0.0])
        f = evaluate(grid, at)[0][:, 0]
        left, right = (f[1] - f[0]) / step, (f[3] - f[2]) / step
        assert left == pytest.approx(right, abs=1e-3)  # curvatures of the order of 100 over 2e-6
        across = at.copy()
        across[:, 1 - axis] += h
        g = evaluate(grid, across)[0][:, 0]
        assert (g[1] - f[1]) / h == pytest.approx((g[2] - f[2]) / h, abs=1e-2)


def test_along_lines_it_is_monotone_where_nodes_are_and_oversteps_little():
    random = np.random.default_rng(7)
    for _ in range(50):
        x = np.cumsum(random.uniform(0.1, 1.0, 7))
        values = random.normal(size=(7, 1))
        grid = grid_of([x], values, np.ones(7, bool))
        for i in range(6):
            f = evaluate(grid, np.linspace(x[i], x[i + 1], 101)[:, None])[0][:, 0]
            low, high = sorted((f[0], f[-1]))
            beyond = max(f.max() - high, low - f.min())
            assert beyond <= (np.sqrt(2.0) - 1.0) * (high - low) * (1 + 1e-9)
        rising = grid_of([x], np.cumsum(random.exponential(size=(7, 1)), axis=0), np.ones(7, bool))
        f = evaluate(rising, np.linspace(x[0], x[-1], 997)[:, None])[0][:, 0]
        assert np.all(np.diff(f) > -1e-12)


def test_unsound_nodes_do_not_reach_sound_cells():
    sound = np.ones((7, 8), bool)
    sound[5:, 6:] = False
    nodes, values = made(7)[0].nodes, made(7)[1]
    one, two = values.copy(), values.copy()
    one[~sound], two[~sound] = np.nan, 1e9
    a, inside = evaluate(grid_of(nodes, one, sound), points())
    b, _ = evaluate(grid_of(nodes, two, sound), points())
    assert 0 < (~inside).sum() < len(inside)
    np.testing.assert_array_equal(a, b)
    assert np.isfinite(a).all()


def test_beyond_the_box_it_is_held_and_flagged():
    grid, _ = made(5)
    found, inside = evaluate(grid, [[3.0, 0.5], [2.0, 0.5], [1.0, -7.0]])
    assert inside.tolist() == [False, True, False]
    np.testing.assert_allclose(found[0], found[1])
