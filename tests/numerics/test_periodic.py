"""Anderson's method: exact for linear maps in as many steps as dimensions, safe when something is not finite."""

import numpy as np
import pytest

from screwsim.numerics.anderson import Anderson


def iterate(accelerate, image_of, x, steps):
    """Return the residual after each step of the accelerated iteration."""
    residuals, images = [], []
    for _ in range(steps):
        image = image_of(x)
        residuals.append(np.linalg.norm(image - x))
        weights = accelerate.weights(x, image)
        images = [*images, image][-len(weights) :]
        x = weights @ np.array(images)
    return residuals


@pytest.mark.parametrize("k", [1, 2, 4])
def test_a_linear_map_is_solved_in_dimension_plus_two_steps(k):
    rng = np.random.default_rng(k)
    Q = np.linalg.qr(rng.normal(size=(k, k)))[0]
    M = Q @ np.diag(np.linspace(0.5, 0.95, k)) @ Q.T  # plain iteration would need hundreds of steps
    b = rng.normal(size=k)
    residuals = iterate(Anderson(depth=k), lambda x: M @ x + b, np.zeros(k), k + 3)
    assert residuals[-1] < 1e-6 * residuals[0]  # not to rounding: the normal equations are regularised by 1e-10


def test_weights_sum_to_one():
    rng = np.random.default_rng(0)
    accelerate = Anderson(depth=3)
    for _ in range(6):
        weights = accelerate.weights(rng.normal(size=5), rng.normal(size=5))
    assert weights.sum() == pytest.approx(1.0, abs=1e-12)


def test_no_more_weights_than_depth_plus_one():
    rng = np.random.default_rng(0)
    accelerate = Anderson(depth=2)
    lengths = [len(accelerate.weights(rng.normal(size=5), rng.normal(size=5))) for _ in range(5)]
    assert lengths == [1, 2, 3, 3, 3]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_residual_that_is_not_finite_leaves_only_the_newest_image(bad):
    accelerate = Anderson(depth=3)
    accelerate.weights(np.zeros(2), np.array([1.0, 2.0]))
    with np.errstate(invalid="ignore"):
        weights = accelerate.weights(np.zeros(2), np.array([1.0, bad]))
    np.testing.assert_array_equal(weights, [1.0])


def test_a_map_that_stands_still_leaves_only_the_newest_image():
    accelerate = Anderson(depth=3)
    accelerate.weights(np.zeros(2), np.ones(2))
    np.testing.assert_array_equal(accelerate.weights(np.zeros(2), np.ones(2)), [1.0])  # no step to learn from


def test_after_a_restart_the_past_is_forgotten():
    accelerate = Anderson(depth=3)
    accelerate.weights(np.zeros(2), np.ones(2))
    accelerate.restart()
    np.testing.assert_array_equal(accelerate.weights(np.zeros(2), np.array([3.0, 1.0])), [1.0])
