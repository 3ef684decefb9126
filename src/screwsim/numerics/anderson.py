"""Acceleration of a fixed-point iteration by Anderson's method (type II, Walker & Ni 2011), for states of any kind."""

import numpy as np

Array = np.ndarray
REGULARISATION = 1e-10  # of the least squares


class Anderson:
    """Mixing of the images of a fixed-point map, from the last `depth` + 1 pairs (point, image)."""

    def __init__(self, depth: int) -> None:
        self.depth = depth
        self.residuals: list[Array] = []
        self.images: list[Array] = []

    def restart(self) -> None:
        """Forget all pairs."""
        self.residuals.clear()
        self.images.clear()

    def mix(self, point: Array, image: Array) -> tuple[Array, Array]:
        """Return the weights after `point` was mapped to `image`, and the weighted sum of the stored images."""
        weights = self.weights(point, image)
        self.images = [*self.images, image][-len(weights) :]
        return weights, weights @ np.array(self.images)

    def weights(self, point: Array, image: Array) -> Array:
        """Return the weights (sum 1, newest last) of the stored images that minimise the linear residual."""
        self.residuals.append(image - point)
        if len(self.residuals) > self.depth + 1:
            self.residuals.pop(0)
        if len(self.residuals) == 1:
            return np.ones(1)
        kept = np.array(self.residuals)
        steps = kept[1:] - kept[:-1]
        gram = steps @ steps.T
        gram.flat[:: len(gram) + 1] *= 1.0 + REGULARISATION
        try:
            share = np.linalg.solve(gram, steps @ kept[-1])
        except np.linalg.LinAlgError:
            return self._only_newest()
        if not np.abs(share).max() <= 1e3:  # also where they are not finite
            return self._only_newest()
        weights = np.append(share, 1.0)
        weights[1:] -= share
        return weights

    def _only_newest(self) -> Array:
        self.residuals = self.residuals[-1:]
        return np.ones(1)
